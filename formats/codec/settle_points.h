/* Places on a grid for points that rounding would put onto each other. */
#ifndef FORMATS_CODEC_SETTLE_POINTS_H
#define FORMATS_CODEC_SETTLE_POINTS_H

#include "formats/codec/quantization_grid.h"

/* The points of all parts: those at equal positions are one, so that parts stay together. */
typedef struct cwi_settler {
    float *points;       /* of all parts, one after the other: count x 3 */
    uint32_t *map;       /* count: the first point at the same position */
    uint32_t *corners;   /* triangles x 3, of those points */
    uint32_t *first;     /* the triangles around points, as of cwi_fans_sort() */
    uint32_t *around;    /* the same */
    uint32_t (*cell)[3]; /* count: places on the grid, of first points */
    uint32_t *table;     /* of the points in cells, by a hash */
    size_t count, triangles, slots;
} cwi_settler;

/* Gathers the points of parts. Returns CW_ERR_NO_MEMORY, CW_ERR_LIMIT; free it in any case. */
CW_NODISCARD cw_status cwi_settler_init(cwi_settler *s, const cwi_parts *parts, cw_error *err);
void cwi_settler_free(cwi_settler *s);

/* Rounds all points to a grid. One whose place is taken goes to a free place beside it, and so does a corner of a
 * triangle that would lose its area, where the triangles around it keep their areas and, if they can, their sides.
 * most_mm  the largest move
 * moved    set to the number of points that are not where rounding puts them
 * Returns  false if a point or a triangle is left without a place */
bool cwi_settle_points(cwi_settler *s, const cwi_quantization_grid *grid, double most_mm,
                       size_t *moved);

/* Moves the points that are not where rounding puts them to places that round to theirs.
 * error_mm  the largest move of all, to where a decoder puts them */
void cwi_settler_move(cwi_settler *s, const cwi_quantization_grid *grid, double *error_mm);

#endif
