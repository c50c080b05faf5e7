/* Closed curves that the surface draws on the sides of the volume's box, counted slice by slice. */
#ifndef EXTRACT_DENSE_BORDER_LOOPS_H
#define EXTRACT_DENSE_BORDER_LOOPS_H

#include "extract/dense/bit_planes.h"

/* A count of curves, up to some slice. Its memory is that of the border of two slices. */
typedef struct cwi_border_loops {
    size_t dim[3];     /* of the volume */
    size_t next;       /* the voxel slice that is added next */
    size_t ring_words; /* of the samples around a slice, the first of them also at the end */
    size_t row_words;
    uint64_t *bits;    /* the memory of the next four */
    uint64_t *ring[2]; /* bits of the samples around a slice, and around the slice below */
    uint64_t *row[2];  /* bits of a row of the bottom or top, and of the row before */
    uint32_t *sets;    /* union-find over ring[0], then either ring[1] or row[0] and row[1] */
    size_t patches;    /* connected parts of what is inside on the box */
    ptrdiff_t euler;   /* samples - joins + squares of all of them */
} cwi_border_loops;

/* Returns the memory of a count. */
size_t cwi_border_loops_bytes(const size_t dim[3]);

/* Begins a count. Free it with cwi_border_loops_free(), also after an error. */
CW_NODISCARD cw_status cwi_border_loops_init(cwi_border_loops *loops, const size_t dim[3],
                                             cw_error *err);
void cwi_border_loops_free(cwi_border_loops *loops);

/* Adds the next voxel slice, which is padded layer `layer` of a classified grid. The slice below
 * it has to be in the grid too. */
void cwi_border_loops_add(cwi_border_loops *loops, const cwi_bit_grid *grid, size_t layer);

/* Returns the number of curves. All slices were added. */
size_t cwi_border_loops_count(const cwi_border_loops *loops);

/* Counts the curves of a grid that holds all slices. */
CW_NODISCARD cw_status cwi_grid_border_loops(const cwi_bit_grid *grid, size_t *count,
                                             cw_error *err);

#endif
