/* Chooses the lattice of a multi-resolution mesh from its box, its levels and the tolerance. */
#include "formats/neuroglancer/lod_grid.h"

#include "core/base/status.h"
#include "core/geometry/box.h"

#include <math.h>

enum { DEFAULT_BITS = 16, MAX_COARSER = 8 };
static const double DIAGONALS = 20000; /* the default tolerance is the diagonal divided by
                                          this */

static void find_box(const cwi_parts *parts, double low[3], double high[3])
{
    cwi_box_clear(low, high);
    for (size_t p = 0; p < parts->count; p++) {
        double from[3], to[3];
        cwi_part_bounds(&parts->items[p], from, to);
        cwi_box_join(low, high, from, to);
    }
}

/* Returns the exponent of the largest step that the levels and the tolerance allow. */
static int choose_exponent(double longest, double tolerance, uint32_t steps, size_t levels)
{
    const int coarser = levels > MAX_COARSER ? MAX_COARSER : (int)levels - 1;
    /* the origin is rounded down, which takes one more step */
    int exponent = (int)ceil(log2(longest / (steps - 1))) - coarser;
    const int finest = (int)floor(log2(tolerance / CWI_LOD_ERROR_STEPS));
    return finest < exponent ? finest : exponent;
}

cw_status cwi_lod_choose(cwi_lod_grid *grid, const cwi_parts *parts, size_t level_count,
                         const cw_write_desc *desc, cw_error *err)
{
    double low[3], high[3], longest = 0, diagonal_sq = 0;
    *grid = (cwi_lod_grid){.bits = desc->bits ? desc->bits : DEFAULT_BITS};
    const uint32_t steps = cwi_lod_steps(grid);
    find_box(parts, low, high);
    for (int a = 0; a < 3; a++) {
        longest = fmax(longest, high[a] - low[a]);
        diagonal_sq += (high[a] - low[a]) * (high[a] - low[a]);
    }
    if (!(longest > 0))
        return cwi_fail(err, CW_ERR_CHECK, "all vertices are at one place");
    if (!(longest > 1e-30) || !(longest < 1e30))
        return cwi_fail(err, CW_ERR_LIMIT, "a box of %.3g mm cannot be divided into steps",
                        longest);
    const double tolerance =
        desc->tolerance_mm > 0 ? desc->tolerance_mm : sqrt(diagonal_sq) / DIAGONALS;
    if (!(tolerance > 1e-33))
        return cwi_fail(err, CW_ERR_ARGUMENT, "a tolerance of %.3g mm is too small", tolerance);
    grid->step_mm = ldexp(1, choose_exponent(longest, tolerance, steps, level_count));
    for (int a = 0; a < 3; a++) {
        grid->origin[a] = floor(low[a] / grid->step_mm) * grid->step_mm;
        const double nodes = ceil(ceil((high[a] - grid->origin[a]) / grid->step_mm) / steps);
        if (nodes > CWI_LOD_NODES)
            return cwi_fail(err, CW_ERR_ARGUMENT,
                            "a tolerance of %.3g mm needs %.0f nodes along a box of %.3g mm; "
                            "there can be %d, for %.3g mm",
                            tolerance, nodes, longest, CWI_LOD_NODES,
                            2 * CWI_LOD_ERROR_STEPS * longest /
                                ((double)steps * CWI_LOD_NODES));
        grid->nodes[a] = nodes > 1 ? (uint32_t)nodes : 1;
    }
    return CW_OK;
}
