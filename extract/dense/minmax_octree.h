/* A branch-on-need octree of the lowest and highest number in each brick of cells
 * [Wilhelms1992].
 *
 * Cells are those of the padded grid (extract/dense/bit_planes.h). A leaf is a brick of 8 x 8 x
 * 8 cells, and its range is over the 9 x 9 x 9 samples around them. Each level above halves the
 * bricks along every axis, rounding up: no level is padded to a power of two. */
#ifndef EXTRACT_DENSE_MINMAX_OCTREE_H
#define EXTRACT_DENSE_MINMAX_OCTREE_H

#include "extract/dense/bit_planes.h"

enum { CWI_OCTREE_LEVELS = 64, CWI_LEAF_BYTES = 20 /* measured */ };

/* Range of the numbers in a brick; from infinity to -infinity when there are none. */
typedef struct cwi_range {
    double low, high;
    bool gap; /* some samples are padding or have no value */
} cwi_range;

struct cwi_octree {
    bool grown; /* the nodes hold ranges */
    bool waits; /* the next surface does not grow it: the voxels may change again first */
    size_t leaf_bytes; /* time to read a leaf by itself, in bytes a sample of reading whole
                          rows; when the wanted leaves cost more than all samples, all samples
                          are read */
    int levels;
    size_t dim[CWI_OCTREE_LEVELS][3]; /* bricks along each axis; level 0 has the leaves */
    cwi_range *level[CWI_OCTREE_LEVELS];
};

/* Allocates the leaf level for a grid; freeing an empty or already freed tree is harmless. */
CW_NODISCARD cw_status cwi_octree_init(cwi_octree *tree, const cwi_bit_grid *grid,
                                       cw_error *err);
void cwi_octree_free(cwi_octree *tree);
size_t cwi_octree_bytes(const cwi_octree *tree);

/* Makes the levels above the leaves, whose ranges are known. */
void cwi_octree_grow(cwi_octree *tree);

/* A box of leaves: those from first[] to end[] - 1 along each axis. */
typedef struct cwi_leaf_box {
    size_t first[3], end[3];
} cwi_leaf_box;

/* Makes the nodes above some leaves again, whose ranges have changed. */
void cwi_octree_update(cwi_octree *tree, const cwi_leaf_box *leaves);

/* Returns the sides on which numbers in some leaves are: CWI_OUTSIDE and CWI_INSIDE. straddles: set
 * if a surface may pass through one of them */
unsigned cwi_octree_sides(const cwi_octree *tree, const cwi_bit_grid *grid,
                          const cwi_leaf_box *leaves, bool *straddles);

/* Returns true if some numbers are inside and some are not. */
bool cwi_octree_crossed(const cwi_octree *tree, const cwi_bit_grid *grid);

/* Marks, in the grid, the words of cells in which straddling leaves lie. Returns the number of
 * these leaves. */
size_t cwi_octree_mark(const cwi_octree *tree, cwi_bit_grid *grid);
size_t cwi_octree_leaves(const cwi_octree *tree);

#endif
