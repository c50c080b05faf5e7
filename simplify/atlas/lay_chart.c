/* Makes a chart of triangles, if they lie flat well enough. */
#include "simplify/atlas/atlas_state.h"

#include "core/base/memory.h"

#include <string.h>

/* Steps back, the last one all the way, of charts that lie on themselves. */
enum { MOVES_BACK = 4 };

/* Shares of the surface that a large chart has, and of its box that one fills at least. */
static const double LARGE = 0.01, SPARSE = 0.45;

static bool is_usable(const cwi_chart *chart, double max_stretch, bool *no_memory)
{
    return chart->stretch <= max_stretch && !cwi_chart_overlaps(chart, no_memory);
}

/* Moves a chart that lies on itself back towards where it was before it was relaxed. Returns false where
 * that does not help. */
static bool move_back(cwi_chart *chart, const double (*before)[2], double max_stretch,
                      bool *no_memory)
{
    for (int n = 0; n < MOVES_BACK; n++) {
        const double rest = n + 1 < MOVES_BACK ? 0.5 : 0;
        for (size_t v = 0; v < chart->vertices; v++)
            for (int k = 0; k < 2; k++)
                chart->uv[v][k] = rest * chart->uv[v][k] + (1 - rest) * before[v][k];
        if (cwi_chart_is_folded(chart))
            continue;
        cwi_chart_measure(chart);
        if (is_usable(chart, max_stretch, no_memory))
            return true;
    }
    return false;
}

/* Lays a chart flat; returns false if it has to be cut. */
static bool lay_flat(cwi_chart *chart, const cwi_sheet *sheet, double max_stretch,
                     bool *no_memory)
{
    if (!cwi_chart_flatten(chart, sheet, no_memory))
        return false;
    double(*before)[2] = cwi_alloc_array(chart->vertices, sizeof *before);
    *no_memory = !before;
    bool good = before;
    if (good) {
        memcpy(before, chart->uv, chart->vertices * sizeof *before);
        *no_memory = !cwi_chart_relax(chart);
        good = !*no_memory && chart->stretch <= max_stretch &&
               (is_usable(chart, max_stretch, no_memory) ||
                move_back(chart, (const double(*)[2])before, max_stretch, no_memory));
    }
    cwi_free(before);
    return good && !*no_memory;
}

/* Returns true if a large chart leaves most of its box free, and packs badly. */
static bool is_sparse(const cwi_chart *chart, const cwi_sheet *sheet)
{
    return chart->surface > LARGE * sheet->area &&
           chart->surface < SPARSE * chart->box[0] * chart->box[1];
}

bool cwi_chart_make(cwi_chart *chart, const cwi_sheet *sheet, const uint32_t *triangles,
                    size_t count, double max_stretch, uint32_t *index, bool *no_memory)
{
    *no_memory = !cwi_chart_init(chart, sheet, triangles, count, index);
    bool good = !*no_memory && (lay_flat(chart, sheet, max_stretch, no_memory) || count == 1);
    if (good && !*no_memory) {
        cwi_chart_find_box(chart);
        good = count == 1 || !is_sparse(chart, sheet);
    }
    if (!good || *no_memory)
        cwi_chart_free(chart);
    return good && !*no_memory;
}
