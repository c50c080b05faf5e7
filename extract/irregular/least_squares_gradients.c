/* Computes gradients at the corners of the cells that the surface of an irregular grid
 * crosses. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/volume/sample_gradients.h"
#include "extract/irregular/cell_surface.h"

#include <string.h>

/* Numbers the corners of crossed elements. */
static size_t number_rows(const cwi_cells *g, uint32_t *rows)
{
    uint32_t count = 0;
    for (size_t s = 0; s < g->volume.dim[0]; s++)
        rows[s] = UINT32_MAX;
    for (size_t n = 0; n < g->count; n++) {
        const cwi_element *e = &g->elements[n];
        for (int c = 0; c < cwi_shape_of(e)->corner_count && e->crossed; c++)
            if (rows[e->corners[c]] == UINT32_MAX)
                rows[e->corners[c]] = count++;
    }
    return count;
}

cw_status cwi_cells_gradients(const cwi_cells *g, cwi_gradients *out, cw_error *err)
{
    double factor;
    *out = (cwi_gradients){.rows = cwi_alloc_array(g->volume.dim[0], sizeof *out->rows)};
    const size_t count = out->rows ? number_rows(g, out->rows) : 0;
    cwi_gradient_fit fit = {
        .volume = &g->volume, .largest = g->largest, .reach = g->reach, .rows = out->rows};
    memcpy(fit.centre, g->centre, sizeof fit.centre);
    out->at = cwi_alloc_array(count, sizeof *out->at);
    return out->rows && out->at ? cwi_gradients_fit(&fit, count, out->at, &factor, err)
                                : cwi_fail_memory(err);
}

void cwi_gradients_free(cwi_gradients *gradients)
{
    cwi_free(gradients->rows);
    cwi_free(gradients->at);
    *gradients = (cwi_gradients){0};
}
