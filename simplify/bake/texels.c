/* Draws triangles into texels, and spreads colours beyond the borders of charts. */
#include "simplify/bake/texels.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/texture/split_seams.h"

#include <math.h>
#include <string.h>

enum { FILLED = 0, UNKNOWN = 255 };

static double cross_2d(const float *a, const float *b, double x, double y)
{
    return ((double)b[0] - (double)a[0]) * (y - (double)a[1]) -
           ((double)b[1] - (double)a[1]) * (x - (double)a[0]);
}

void cwi_texel_weights(const float *uv, const uint32_t v[3], uint32_t size, uint32_t x,
                       uint32_t y, double weights[3])
{
    const double u = (x + 0.5) / size, w = (y + 0.5) / size;
    double sum = 0;
    for (int k = 0; k < 3; k++) {
        weights[k] =
            cross_2d(uv + 2 * (size_t)v[(k + 1) % 3], uv + 2 * (size_t)v[(k + 2) % 3], u, w);
        sum += weights[k];
    }
    for (int k = 0; k < 3; k++)
        weights[k] = sum != 0 ? weights[k] / sum : 1.0 / 3;
}

/* Returns the texels that a range of coordinates meets, cut to those that there are. */
static void find_range(const float *uv, const uint32_t v[3], size_t axis, uint32_t size,
                       uint32_t range[2])
{
    const double a = (double)uv[2 * (size_t)v[0] + axis],
                 b = (double)uv[2 * (size_t)v[1] + axis],
                 c = (double)uv[2 * (size_t)v[2] + axis];
    const double low = floor(fmin(a, fmin(b, c)) * size),
                 high = ceil(fmax(a, fmax(b, c)) * size);
    range[0] = low > 0 ? (uint32_t)fmin(low, size) : 0;
    range[1] = high > 0 ? (uint32_t)fmin(high, size) : 0;
}

void cwi_texels_find(const cw_mesh *mesh, uint32_t size, uint32_t *triangle)
{
    const float *uv = cwi_texture_of(mesh)->data;
    memset(triangle, 0xff, (size_t)size * size * sizeof *triangle);
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        const uint32_t *v = mesh->triangles + 3 * (size_t)t;
        uint32_t columns[2], rows[2];
        const float *c = uv + 2 * (size_t)v[2];
        if (cross_2d(uv + 2 * (size_t)v[0], uv + 2 * (size_t)v[1], (double)c[0],
                     (double)c[1]) == 0)
            continue;
        find_range(uv, v, 0, size, columns);
        find_range(uv, v, 1, size, rows);
        for (uint32_t y = rows[0]; y < rows[1]; y++)
            for (uint32_t x = columns[0]; x < columns[1]; x++) {
                double weights[3];
                uint32_t *at = &triangle[(size_t)y * size + x];
                cwi_texel_weights(uv, v, size, x, y, weights);
                if (*at == CWI_NO_TEXEL && weights[0] >= 0 && weights[1] >= 0 &&
                    weights[2] >= 0)
                    *at = t;
            }
    }
}

/* Gives a texel the mean of those around it that an earlier step filled; false where there are none. */
static bool fill_texel(const uint8_t *step, uint32_t size, uint32_t x, uint32_t y, uint8_t now,
                       const uint16_t *from, uint16_t *to)
{
    unsigned sum[3] = {0}, count = 0;
    for (uint32_t j = y ? y - 1 : 0; j <= y + 1 && j < size; j++)
        for (uint32_t i = x ? x - 1 : 0; i <= x + 1 && i < size; i++) {
            const size_t at = (size_t)j * size + i;
            for (size_t k = 0; step[at] < now && k < 3; k++)
                sum[k] += from[3 * at + k];
            count += step[at] < now;
        }
    for (size_t k = 0; count && k < 3; k++)
        to[3 * ((size_t)y * size + x) + k] = (uint16_t)((sum[k] + count / 2) / count);
    return count;
}

/* Marks the texels of triangles as filled. Returns NULL without memory. */
static uint8_t *mark_filled(const uint32_t *triangle, uint32_t size)
{
    const size_t count = (size_t)size * size;
    uint8_t *step = cwi_alloc_array(count, 1);
    for (size_t n = 0; n < count && step; n++)
        step[n] = triangle[n] == CWI_NO_TEXEL ? UNKNOWN : FILLED;
    return step;
}

cw_status cwi_texels_spread(const uint32_t *triangle, uint32_t size, uint32_t steps,
                            uint16_t *texels, cw_error *err)
{
    uint8_t *step = mark_filled(triangle, size); /* in which a texel was filled */
    if (!step)
        return cwi_fail_memory(err);
    for (uint32_t now = 1; now <= steps; now++)
        for (uint32_t y = 0; y < size; y++)
            for (uint32_t x = 0; x < size; x++)
                if (step[(size_t)y * size + x] == UNKNOWN &&
                    fill_texel(step, size, x, y, (uint8_t)now, texels, texels))
                    step[(size_t)y * size + x] = (uint8_t)now;
    cwi_free(step);
    return CW_OK;
}

cw_status cwi_texels_smooth(const uint32_t *triangle, uint32_t size, uint16_t *texels,
                            cw_error *err)
{
    const size_t count = (size_t)size * size;
    uint8_t *step = mark_filled(triangle, size);
    uint16_t *before = cwi_alloc_array(count, 3 * sizeof *before);
    const bool has_memory = step && before;
    if (has_memory)
        memcpy(before, texels, 3 * count * sizeof *before);
    for (uint32_t y = 0; y < size && has_memory; y++)
        for (uint32_t x = 0; x < size; x++)
            if (step[(size_t)y * size + x] == FILLED)
                fill_texel(step, size, x, y, 1, before, texels);
    cwi_free(step);
    cwi_free(before);
    return has_memory ? CW_OK : cwi_fail_memory(err);
}
