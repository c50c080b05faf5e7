/* Numbers that triangles leave in rows of voxels, sorted by row. */
#include "extract/voxelize/voxelize_state.h"

#include "core/base/memory.h"

#include <string.h>

void *cwi_row_events_add(cwi_row_events *events, size_t size)
{
    void *items = cwi_grow_array(events->items, events->count, &events->capacity, size);
    if (!items) {
        events->failed = true;
        return NULL;
    }
    events->items = items;
    return (char *)items + size * events->count++;
}

/* Sorts events into the order of their rows. Returns NULL when memory is out. */
static void *sort_events(const cwi_row_events *events, size_t size, size_t rows, size_t *first)
{
    char *sorted = cwi_alloc_array(events->count, size);
    const char *items = events->items;
    memset(first, 0, (rows + 1) * sizeof *first);
    if (!sorted)
        return NULL;
    uint32_t row;
    for (size_t n = 0; n < events->count; n++) {
        memcpy(&row, items + n * size, sizeof row);
        first[row + 1]++;
    }
    for (size_t r = 0; r < rows; r++)
        first[r + 1] += first[r];
    for (size_t n = 0; n < events->count; n++) {
        memcpy(&row, items + n * size, sizeof row);
        memcpy(sorted + size * first[row]++, items + n * size, size);
    }
    memmove(first + 1, first, rows * sizeof *first); /* each is now the end of its row */
    first[0] = 0;
    return sorted;
}

bool cwi_block_rows_fill(cwi_block_rows *r, const cwi_voxelize *v, size_t block, size_t size,
                         void (*leave)(cwi_block_rows *rows, size_t triangle, size_t mesh))
{
    const size_t *dim = v->volume->dim, low = block * CWI_VOXELIZE_LAYERS,
                 high = low + CWI_VOXELIZE_LAYERS < dim[2] ? low + CWI_VOXELIZE_LAYERS : dim[2];
    size_t mesh = 0;
    *r = (cwi_block_rows){.v = v, .low = low, .high = high, .count = (high - low) * dim[1]};
    for (size_t n = v->first[block]; n < v->first[block + 1]; n++) {
        mesh = cwi_voxelize_mesh(v, v->list[n], mesh);
        leave(r, v->list[n], mesh);
    }
    r->first = cwi_alloc_array(r->count + 1, sizeof *r->first);
    if (r->first && !r->events.failed)
        r->sorted = sort_events(&r->events, size, r->count, r->first);
    return r->sorted;
}

void cwi_block_rows_free(cwi_block_rows *r)
{
    cwi_free(r->sorted);
    cwi_free(r->first);
    cwi_free(r->events.items);
}
