/* Stores the samples of a grid that were moved, and finds them by their place. */
#include "extract/level_set/feature_warp.h"

#include "core/base/memory.h"

#include <math.h>

double cwi_warp_corner(const double at[3], int n, uint32_t corner[3])
{
    double weight = 1;
    for (int a = 0; a < 3; a++) {
        const double base = floor(at[a]), in = at[a] - base;
        corner[a] = (uint32_t)base + (n >> a & 1);
        weight *= n >> a & 1 ? in : 1 - in;
    }
    return weight;
}

cwi_move *cwi_warp_find(const cwi_warp *w, const uint32_t at[3])
{
    const uint32_t n = cwi_lattice_find(&w->numbers, cwi_lattice_key(at));
    return n == CWI_NO_LATTICE_POINT ? NULL : w->moves + n;
}

bool cwi_warp_put(cwi_warp *w, const cwi_move *move)
{
    void *grown = cwi_grow_array(w->moves, w->count, &w->capacity, sizeof *w->moves);
    if (!grown)
        return false;
    w->moves = grown;
    const uint32_t n = cwi_lattice_add(&w->numbers, cwi_lattice_key(move->at));
    if (n == CWI_NO_LATTICE_POINT)
        return false;
    w->moves[n] = *move;
    w->count = w->numbers.count;
    return true;
}

void cwi_warp_free(cwi_warp *w)
{
    cwi_free(w->moves);
    cwi_lattice_free(&w->numbers);
    *w = (cwi_warp){0};
}
