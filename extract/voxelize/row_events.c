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

void *cwi_row_events_sort(const cwi_row_events *events, size_t size, size_t rows, size_t *first)
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
