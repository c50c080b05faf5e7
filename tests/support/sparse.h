/* Sparse grids under test, made from dense ones. */
#ifndef TESTS_SPARSE_H
#define TESTS_SPARSE_H

#include "support/support.h"

/* The same voxels as a sparse grid: leaves with one value are tiles, those with the
 * background's value are left out. Sizes must be multiples of 8. Free it. */
cw_volume test_sparse_of(const cw_volume *dense, double background);

#endif
