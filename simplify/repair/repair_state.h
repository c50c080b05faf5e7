/* The mesh under repair, and the steps that work on it. */
#ifndef SIMPLIFY_REPAIR_REPAIR_STATE_H
#define SIMPLIFY_REPAIR_REPAIR_STATE_H

#include "core/base/status.h"
#include "core/mesh/corner_table.h"
#include "core/mesh/mesh_triangle.h"

#include <cubewright/quality.h>
#include <cubewright/repair.h>

#define CWI_NEW UINT32_MAX /* the source of what the input does not have */

/* Smoothness of patches: later rounds take plainer ones, which cross less. */
typedef enum cwi_patch_kind { CWI_PATCH_FAIR, CWI_PATCH_FLAT, CWI_PATCH_PLAIN } cwi_patch_kind;

/* An edge that was cut open: a triangle at it, and where the edge begins. */
typedef struct cwi_twist {
    uint32_t triangle, vertex;
} cwi_twist;

typedef struct cwi_repair {
    cw_mesh mesh; /* positions and triangles. labels: the vertex of the input, or CWI_NEW.
                             attributes[0]: the triangle of the input, or CWI_NEW.
                             colors: 1 in the first byte at rims of holes that stay open */
    const cw_mesh *input; /* welded, with its attributes */
    uint32_t *twin;  /* of each corner: the corner whose edge lies along that from this corner
                             to the next; or CWI_NO_CORNER */
    cwi_twist *seam; /* edges at which the last link cut one-sided surfaces open */
    size_t seam_count, seam_capacity;
    uint32_t *
        unjudged; /* of triangles of the input: CWI_NEW if one-sided, which the guard leaves out; or NULL */
    cw_repair_desc desc;
    cw_repair_facts facts;
    bool is_later;      /* the holes of the input were seen */
    double done, until; /* of the progress: now, and when the step at hand has ended */
} cwi_repair;

/* Reports progress: a fraction of the step at hand. */
CW_NODISCARD static inline cw_status cwi_repair_progress(cwi_repair *r, const char *step,
                                                         double fraction, cw_error *err)
{
    const double done = r->done + fraction * (r->until - r->done);
    return cwi_progress(&r->desc.progress, step, done, err);
}

/* Welds vertices within a distance: each joins the nearest of those before it that stay.
 * welded  is increased by their number */
CW_NODISCARD cw_status cwi_weld_near(cw_mesh *mesh, double distance_mm, size_t *welded,
                                     cw_error *err);

/* Stitches borders: open edges that lie along each other become one, and vertices on them split them. */
CW_NODISCARD cw_status cwi_stitch_borders(cwi_repair *r, cw_error *err);

/* Appends vertices and triangles. Triangles name the vertices of the mesh, then the new ones. */
CW_NODISCARD cw_status cwi_repair_append(cwi_repair *r, const float *positions, size_t vertices,
                                         const uint32_t *triangles, size_t triangle_count,
                                         cw_error *err);

/* Finds the twins of all edges: at most two triangles are joined along an edge, and run through it
 * in opposite directions. Flips triangles for that.
 * is_first  adds to the facts */
CW_NODISCARD cw_status cwi_repair_link(cwi_repair *r, bool is_first, cw_error *err);

/* Gives each fan of triangles around a vertex a vertex of its own, and each pair of triangles an edge
 * of its own. Twins are set, before and after. */
CW_NODISCARD cw_status cwi_repair_split(cwi_repair *r, cw_error *err);

/* Moves vertices apart that are at one place.
 * moved  set to true if there are any */
CW_NODISCARD cw_status cwi_part_vertices(cwi_repair *r, bool *moved, cw_error *err);

/* Drops triangles with the same vertices as an earlier one. With cancel both go where they face each
 * other. Walls that closed solids share stay. */
CW_NODISCARD cw_status cwi_drop_duplicates(cwi_repair *r, bool cancel, size_t *dropped,
                                           cw_error *err);

/* Flips the longest edges of triangles without area, and drops what cannot be flipped. Twins are set,
 * before and after. */
CW_NODISCARD cw_status cwi_drop_degenerate(cwi_repair *r, size_t *dropped, cw_error *err);

/* Drops open components that would enclose next to nothing if they were closed. Twins are set, before
 * and after. */
CW_NODISCARD cw_status cwi_drop_sheets(cwi_repair *r, size_t *sheets, size_t *triangles,
                                       cw_error *err);

/* Drops one-sided components, such as Moebius strips, right after they were cut open. Those that damage made
 * one-sided in a small place stay. Twins are set, before and after. */
CW_NODISCARD cw_status cwi_drop_one_sided(cwi_repair *r, cw_error *err);

/* Fills the holes. Twins are set before, and not after. */
CW_NODISCARD cw_status cwi_fill_holes(cwi_repair *r, cwi_patch_kind kind, cw_error *err);

/* Unites solids that cross or touch each other, or cross themselves. Twins are set before, and after unless
 * changed.
 * is_clear  set to true when nothing crosses or touches, but in common vertices and edges */
CW_NODISCARD cw_status cwi_unite_crossing(cwi_repair *r, bool *is_clear, bool *changed,
                                          cw_error *err);

/* Unites closed components of these pairs of triangles; none if rounding finds no result.
 * all      also those that cross themselves and have patches, which may be what is wrong
 * changed  set to true if any became one */
CW_NODISCARD cw_status cwi_unite_solids(cwi_repair *r, const cw_crossings *found, bool all,
                                        bool *changed, cw_error *err);

/* Removes what crosses: moves touching vertices apart, or drops triangles; then there are holes. Unites all
 * solids in the end, or if too much would go. Twins are set before, and not after.
 * round     how often it was called before: later rounds drop more
 * changed   set to false when nothing crosses */
CW_NODISCARD cw_status cwi_remove_crossings(cwi_repair *r, int round, bool is_last,
                                            bool *changed, cw_error *err);

/* Replaces the mesh by a wrap around it; around the input where it is not sound, or lost sheets. */
CW_NODISCARD cw_status cwi_wrap_mesh(cwi_repair *r, cw_error *err);

/* Measures what a repair changed in volume and place, and whether that is more than it may.
 * mesh  the input, before anything was done */
CW_NODISCARD cw_status cwi_guard_repair(cwi_repair *r, const cw_mesh *mesh, cw_error *err);

#endif
