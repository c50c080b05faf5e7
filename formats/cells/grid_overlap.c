/* Finds cells that several pieces of a curvilinear grid have: those at the same place of the whole. */
#include "formats/cells/grid_overlap.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "formats/cells/vtk_cell_types.h"

#include <string.h>

/* Pieces with this many times fewer cells than the box around them are not compared. */
static const double MAX_SPARSITY = 64;

/* The box around all pieces, in cells. */
typedef struct whole {
    int64_t low[3], high[3];
} whole;

static whole find_whole(const cwi_grid_piece *pieces, size_t count)
{
    whole w = {{INT64_MAX, INT64_MAX, INT64_MAX}, {INT64_MIN, INT64_MIN, INT64_MIN}};
    for (size_t n = 0; n < count; n++)
        for (int a = 0; a < 3; a++) {
            const int64_t low = pieces[n].low[a], high = low + (int64_t)pieces[n].along[a] - 1;
            w.low[a] = low < w.low[a] ? low : w.low[a];
            w.high[a] = high > w.high[a] ? high : w.high[a];
        }
    return w;
}

/* Goes through the cells of a piece; those that have their bit already are left out. */
static size_t pass_piece(const cwi_grid_piece *p, const whole *w, uint8_t *seen, uint8_t *types)
{
    const size_t nx = (size_t)(w->high[0] - w->low[0]), ny = (size_t)(w->high[1] - w->low[1]);
    size_t left_out = 0, n = 0;
    for (size_t k = 0; k + 1 < p->along[2]; k++)
        for (size_t j = 0; j + 1 < p->along[1]; j++) {
            const size_t z = (size_t)(p->low[2] - w->low[2]) + k;
            const size_t y = (size_t)(p->low[1] - w->low[1]) + j;
            size_t at = (z * ny + y) * nx + (size_t)(p->low[0] - w->low[0]);
            for (size_t i = 0; i + 1 < p->along[0]; i++, at++, n++) {
                const uint8_t bit = (uint8_t)(1u << at % 8);
                if (types[n] == CWI_VTK_EMPTY)
                    continue;
                left_out += (seen[at / 8] & bit) != 0;
                if (seen[at / 8] & bit)
                    types[n] = CWI_VTK_EMPTY;
                seen[at / 8] |= bit;
            }
        }
    return left_out;
}

cw_status cwi_grid_leave_out_repeated(const cwi_grid_piece *pieces, size_t count,
                                      uint8_t *types, size_t *left_out, cw_error *err)
{
    const whole w = find_whole(pieces, count);
    double cells = 1, held = 0;
    for (int a = 0; a < 3; a++)
        cells *= (double)w.high[a] - (double)w.low[a];
    for (size_t n = 0; n < count; n++)
        held += (double)pieces[n].cells;
    if (count < 2 || cells > MAX_SPARSITY * held)
        return CW_OK;
    uint8_t *seen = cwi_alloc_zeroed((size_t)(cells / 8) + 1, 1);
    if (!seen)
        return cwi_fail_memory(err);
    for (size_t n = 0; n < count; types += pieces[n++].cells)
        *left_out += pass_piece(&pieces[n], &w, seen, types);
    cwi_free(seen);
    return CW_OK;
}
