/* The volume inside of a mesh along a grid of lines, for meshes that are not closed everywhere, too. */
#ifndef SIMPLIFY_REPAIR_LINE_VOLUME_H
#define SIMPLIFY_REPAIR_LINE_VOLUME_H

#include <cubewright/mesh.h>

/* Where a line crosses the mesh: it enters by +1, and leaves by -1; 0 where it only passes a border. */
typedef struct cwi_line_crossing {
    uint32_t line;
    int16_t sign;
    bool is_patch; /* of a triangle that fills a hole, or at a border: the line does not tell */
    double at;
} cwi_line_crossing;

/* The crossings of lines along x, y and z through a box, ordered by line and place. */
typedef struct cwi_line_crossings {
    size_t count, capacity;
    cwi_line_crossing *rows;
    double low[3], high[3]; /* the box */
} cwi_line_crossings;

/* Facts from lines that leave a mesh as often as they enter it, and never leave first. */
typedef struct cwi_line_volumes {
    double volume_mm3, volume_after_mm3; /* of both meshes, as the lines along one axis tell */
    double inside_mm,
        changed_mm; /* lengths inside before, and inside of one of the two alone: of lines that meet
                                     no patch of a hole that was there before */
    size_t lines; /* of these, those that meet the mesh before */
} cwi_line_volumes;

/* Finds the crossings of lines through a box with a mesh.
 * sources    of each triangle: UINT32_MAX for one that fills a hole; NULL: none does
 * low, high  of the box, relative to the mesh's origin
 * Cost       near-linear; 24 bytes a crossing */
CW_NODISCARD cw_status cwi_find_line_crossings(const cw_mesh *mesh, const uint32_t *sources,
                                               const double low[3], const double high[3],
                                               cwi_line_crossings *out, cw_error *err);

/* Keeps lines that pass borders of the mesh from telling what is inside: they may slip through a gap.
 * reach_mm  as wide as gaps are
 * Returns   CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_hide_lines_at_borders(const cw_mesh *mesh, double reach_mm,
                                                 cwi_line_crossings *out, cw_error *err);

/* Keeps where each line first enters, and last leaves: what lies between does not matter then. */
void cwi_keep_outer_crossings(cwi_line_crossings *crossings);

void cwi_line_crossings_free(cwi_line_crossings *crossings);

/* Compares two meshes along the same lines.
 * near_mm  how far a surface may move and be the same */
cwi_line_volumes cwi_compare_lines(const cwi_line_crossings *before,
                                   const cwi_line_crossings *after, double near_mm);

#endif
