/* A section as a grid of cells in its plane: its regions, how far each cell is from where holes must not come,
 * and the surfaces below and above it. */
#ifndef SIMPLIFY_PIECES_SECTION_MAP_H
#define SIMPLIFY_PIECES_SECTION_MAP_H

#include "simplify/pieces/pieces_state.h"

enum { CWI_SECTION_CELLS = 384 }; /* along the longer side of the section's box */

/* A triangle beside a section, in the frame of its plane: the third coordinate is its height, away from the
 * plane. */
typedef struct cwi_near_triangle {
    double p[3][3];
    double low; /* the least height */
} cwi_near_triangle;

typedef struct cwi_section_map {
    const cwi_cut_plane *plane;
    double corner[2], cell; /* of the grid; length of a cell's side */
    size_t nx, ny;
    uint32_t *region; /* nx x ny: of the cell's middle, from 1; 0: outside */
    size_t region_count;
    double (*border)
        [4]; /* edges of the section: from and to; those of a region follow each other */
    size_t *border_start;       /* region_count + 1 */
    cwi_near_triangle *near[2]; /* below and above the plane */
    size_t near_count[2];
    double *distance_sq; /* nx x ny: to the nearest blocked cell, in cells */
} cwi_section_map;

/* Makes the grid of a section. Free it, also after failure, with cwi_section_map_free().
 * Returns  CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_section_map_make(const cwi_cutter *c,
                                            const cw_piece_section *section,
                                            cwi_section_map *map, cw_error *err);
void cwi_section_map_free(cwi_section_map *map);

/* Lists the surfaces lower than `depth` on both sides of a section. CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_section_map_add_surfaces(const cwi_cutter *c,
                                                    const cw_piece_section *section,
                                                    const double depth[2], cwi_section_map *map,
                                                    cw_error *err);

/* Finds the distance of each cell to the nearest one that is outside of the section, or where the material
 * below or above is thinner than `depth`. CW_ERR_NO_MEMORY
 * Source  [Felzenszwalb2012] */
CW_NODISCARD cw_status cwi_section_map_measure(cwi_section_map *map, const double depth[2],
                                               cw_error *err);

/* Returns the distance of a point to the border of its region. */
double cwi_border_distance(const cwi_section_map *map, uint32_t region, const double p[2]);

/* Moves a point of a region away from the border, as far as some steps of less than a cell lead. Returns its
 * distance to the border. */
double cwi_leave_border(const cwi_section_map *map, uint32_t region, double p[2]);

/* Returns the depth of the material around a point: the least height of a surface within the radius.
 * side  0: below, 1: above */
double cwi_section_depth(const cwi_section_map *map, int side, const double p[2],
                         double radius);

/* Computes the middle of a cell. */
static inline void cwi_cell_middle(const cwi_section_map *map, size_t cell, double p[2])
{
    p[0] = map->corner[0] + map->cell * ((double)(cell % map->nx) + 0.5);
    p[1] = map->corner[1] + map->cell * ((double)(cell / map->nx) + 0.5);
}

#endif
