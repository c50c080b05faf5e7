/* Makes the smaller copies of pictures, and samples them. */
#include "viewer/appearance/look_texture.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "viewer/scene/srgb.h"

#include <math.h>

enum { MAX_SIZE = 16384, MAX_ANISOTROPY = 16 };

/* --- levels ------------------------------------------------------------------------------- */

static uint8_t to_texel(double value, bool is_color)
{
    return (uint8_t)floor(255 * (is_color ? cwi_linear_to_srgb(value) : value) + 0.5);
}

/* Finds the two texels around the middle of one of the level below, and the part of the second. */
static double find_pair(uint32_t n, uint32_t size, uint32_t above, uint32_t pair[2])
{
    const double at = (n + 0.5) * above / size - 0.5, first = floor(at);
    pair[0] = (uint32_t)fmax(first, 0);
    pair[1] = pair[0] + 1 < above ? pair[0] + 1 : above - 1;
    return at - first;
}

static void shrink_level(cwi_look_texture *t, int level, bool is_color)
{
    const uint32_t w = t->width[level], h = t->height[level], above = t->width[level - 1];
    const uint8_t *from = t->texels[level - 1];
    for (uint32_t y = 0; y < h; y++) {
        uint32_t rows[2], columns[2];
        const double down = find_pair(y, h, t->height[level - 1], rows);
        for (uint32_t x = 0; x < w; x++) {
            const double right = find_pair(x, w, above, columns);
            for (size_t c = 0; c < 3; c++) {
                double side[2];
                for (int r = 0; r < 2; r++) {
                    const uint8_t *row = from + 3 * (size_t)rows[r] * above;
                    side[r] = (1 - right) * (double)t->value[row[3 * (size_t)columns[0] + c]] +
                              right * (double)t->value[row[3 * (size_t)columns[1] + c]];
                }
                t->texels[level][3 * ((size_t)y * w + x) + c] =
                    to_texel((1 - down) * side[0] + down * side[1], is_color);
            }
        }
    }
}

static cw_status add_level(cwi_look_texture *t, uint32_t width, uint32_t height, cw_error *err)
{
    t->width[t->count] = width;
    t->height[t->count] = height;
    t->texels[t->count] = cwi_alloc_array((size_t)width * height, 3);
    return t->texels[t->count++] ? CW_OK : cwi_fail_memory(err);
}

cw_status cwi_look_texture_make(const cw_image *image, bool is_color, bool repeats,
                                cwi_look_texture *t, cw_error *err)
{
    *t = (cwi_look_texture){.repeats = repeats};
    if (!image->pixels || image->width < 1 || image->height < 1 || image->width > MAX_SIZE ||
        image->height > MAX_SIZE)
        return cwi_fail(err, CW_ERR_ARGUMENT, "a map of %zu x %zu texels; expected 1 to %d",
                        image->width, image->height, MAX_SIZE);
    for (int n = 0; n < 256; n++)
        t->value[n] = (float)(is_color ? cwi_srgb_to_linear(n / 255.0) : n / 255.0);
    cw_status st = add_level(t, (uint32_t)image->width, (uint32_t)image->height, err);
    for (size_t n = 0; st == CW_OK && n < image->width * image->height; n++)
        for (size_t c = 0; c < 3; c++)
            t->texels[0][3 * n + c] = image->pixels[4 * n + c];
    while (st == CW_OK && (t->width[t->count - 1] > 1 || t->height[t->count - 1] > 1)) {
        const uint32_t w = t->width[t->count - 1] / 2, h = t->height[t->count - 1] / 2;
        st = add_level(t, w ? w : 1, h ? h : 1, err);
        if (st == CW_OK)
            shrink_level(t, t->count - 1, is_color);
    }
    return st;
}

void cwi_look_texture_free(cwi_look_texture *t)
{
    for (int n = 0; n < CWI_LOOK_LEVELS; n++)
        cwi_free(t->texels[n]);
    *t = (cwi_look_texture){0};
}

/* --- sampling ----------------------------------------------------------------------------- */

/* Returns the number of a texel, which may lie outside of the picture. */
static size_t wrap_texel(double at, uint32_t size, bool repeats)
{
    if (repeats)
        at -= size * floor(at / size);
    return (size_t)fmin(fmax(at, 0), size - 1.0);
}

static void sample_level(const cwi_look_texture *t, int level, const double uv[2],
                         double weight, double rgb[3])
{
    const uint32_t w = t->width[level], h = t->height[level];
    const double u = uv[0] * w - 0.5, v = uv[1] * h - 0.5, left = floor(u), top = floor(v);
    const double part[2] = {u - left, v - top};
    size_t x[2], y[2];
    for (int n = 0; n < 2; n++) {
        x[n] = wrap_texel(left + n, w, t->repeats);
        y[n] = wrap_texel(top + n, h, t->repeats);
    }
    for (int n = 0; n < 4; n++) {
        const double share = (n & 1 ? part[0] : 1 - part[0]) * (n & 2 ? part[1] : 1 - part[1]);
        const uint8_t *texel = t->texels[level] + 3 * (y[n >> 1] * w + x[n & 1]);
        for (int c = 0; c < 3; c++)
            rgb[c] += weight * share * (double)t->value[texel[c]];
    }
}

/* Finds the longer side of the pixel's footprint, the number of samples along it, and the level. */
static double find_footprint(const cwi_look_texture *t, const cwi_look_place *p,
                             double along[2], int *samples)
{
    const double size[2] = {t->width[0], t->height[0]};
    double dx[2], dy[2];
    for (int k = 0; k < 2; k++) {
        dx[k] = p->dx[k] * size[k];
        dy[k] = p->dy[k] * size[k];
    }
    const double xx = dx[0] * dx[0] + dx[1] * dx[1], yy = dy[0] * dy[0] + dy[1] * dy[1];
    const double area = fabs(dx[0] * dy[1] - dx[1] * dy[0]), longer = fmax(xx, yy);
    for (int k = 0; k < 2; k++)
        along[k] = xx >= yy ? p->dx[k] : p->dy[k];
    const double ratio = area > 0 ? fmin(longer / area, MAX_ANISOTROPY) : MAX_ANISOTROPY;
    *samples = (int)ceil(fmax(ratio, 1) - 1e-3);
    const double level = 0.5 * log2(longer) - log2(ratio > 1 ? ratio : 1);
    return isfinite(level) ? fmin(fmax(level, 0), t->count - 1) : 0;
}

void cwi_look_texture_sample(const cwi_look_texture *t, const cwi_look_place *p, double rgb[3])
{
    double along[2];
    int samples;
    const double level = find_footprint(t, p, along, &samples);
    const int fine = (int)level, coarse = fine + 1 < t->count ? fine + 1 : fine;
    const double part = level - fine;
    rgb[0] = rgb[1] = rgb[2] = 0;
    for (int n = 0; n < samples; n++) {
        const double at = (n + 0.5) / samples - 0.5;
        const double uv[2] = {p->uv[0] + at * along[0], p->uv[1] + at * along[1]};
        sample_level(t, fine, uv, (1 - part) / samples, rgb);
        if (part > 0)
            sample_level(t, coarse, uv, part / samples, rgb);
    }
}
