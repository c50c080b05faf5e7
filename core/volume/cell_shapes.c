/* Tables of the shapes of cells, and the places at which cells begin in a list of corners. */
#include "core/volume/cell_shapes.h"

#include "core/base/memory.h"
#include "core/base/status.h"

const cwi_cell_shape cwi_cell_shapes[CW_SHAPE_COUNT] = {
    [CW_TETRAHEDRON] = {4,
                        6,
                        4,
                        {{0, 2}, {1, 2}, {0, 1}, {1, 3}, {0, 3}, {2, 3}},
                        {3, 3, 3, 3},
                        {{0, 2, 1, 0}, {0, 1, 3, 0}, {1, 2, 3, 1}, {2, 0, 3, 2}}},
    [CW_PYRAMID] = {5,
                    8,
                    5,
                    {{0, 3}, {2, 3}, {1, 2}, {0, 1}, {1, 4}, {0, 4}, {2, 4}, {3, 4}},
                    {4, 3, 3, 3, 3},
                    {{0, 3, 2, 1}, {0, 1, 4, 0}, {1, 2, 4, 1}, {2, 3, 4, 2}, {3, 0, 4, 3}}},
    [CW_WEDGE] = {6,
                  9,
                  5,
                  {{0, 2}, {1, 2}, {0, 1}, {3, 4}, {4, 5}, {3, 5}, {1, 4}, {0, 3}, {2, 5}},
                  {3, 3, 4, 4, 4},
                  {{0, 2, 1, 0}, {3, 4, 5, 3}, {0, 1, 4, 3}, {1, 2, 5, 4}, {2, 0, 3, 5}}},
    [CW_HEXAHEDRON] =
        {8,
         12,
         6,
         {{0, 1},
          {3, 2},
          {4, 5},
          {7, 6},
          {0, 3},
          {1, 2},
          {4, 7},
          {5, 6},
          {0, 4},
          {1, 5},
          {3, 7},
          {2, 6}},
         {4, 4, 4, 4, 4, 4},
         {{0, 4, 7, 3}, {1, 2, 6, 5}, {0, 1, 5, 4}, {3, 7, 6, 2}, {0, 3, 2, 1}, {4, 5, 6, 7}}},
};

cw_status cwi_cell_chunks(const cw_cells *cells, size_t chunk, size_t **starts, cw_error *err)
{
    size_t corner = 0;
    const size_t chunks = (cells->count + chunk - 1) / chunk;
    *starts = cwi_alloc_array(chunks, sizeof **starts);
    if (!*starts)
        return cwi_fail_memory(err);
    for (size_t n = 0; n < cells->count; n++) {
        if (n % chunk == 0)
            (*starts)[n / chunk] = corner;
        if (cells->shapes[n] >= CW_SHAPE_COUNT) {
            cwi_free(*starts);
            *starts = NULL;
            return cwi_fail(err, CW_ERR_ARGUMENT, "cell %zu has shape %u; the last is %d", n,
                            cells->shapes[n], CW_SHAPE_COUNT - 1);
        }
        corner += cwi_cell_shapes[cells->shapes[n]].corner_count;
    }
    return CW_OK;
}
