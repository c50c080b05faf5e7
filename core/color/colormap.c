/* Colours of matplotlib's maps "viridis" and "inferno" (CC0) and of Moreland's "cool to warm"
 * (public domain): perceptual, for fields that have no natural colours. */
#include "core/color/colormap.h"

#include <math.h>

static const unsigned viridis[] = {0x440154, 0x482878, 0x3e4a89, 0x31688e, 0x26828e,
                                   0x1f9e89, 0x35b779, 0x6ece58, 0xb5de2b, 0xfde725};
static const unsigned inferno[] = {0x000004, 0x1b0c41, 0x4a0c6b, 0x781c6d, 0xa52c60,
                                   0xcf4446, 0xed6925, 0xfb9b06, 0xf7d13d, 0xfcffa4};
static const unsigned cool_warm[] = {0x3b4cc0, 0x6f92f3, 0xaac7fd, 0xdddcdc,
                                     0xf7b89c, 0xe7745b, 0xb40426};
static const unsigned gray[] = {0x000000, 0xffffff};

#define ROW(name, map)                                                                         \
    {                                                                                          \
        name, map, sizeof map / sizeof *map                                                    \
    }

static const cwi_colormap maps[CW_COLORMAP_COUNT] = {
    ROW("viridis", viridis), ROW("inferno", inferno), ROW("cool-warm", cool_warm),
    ROW("gray", gray)};

const cwi_colormap *cwi_colormap_of(cw_colormap map)
{
    return &maps[map];
}

const char *cw_colormap_name(cw_colormap map)
{
    return (size_t)map < CW_COLORMAP_COUNT ? maps[map].name : NULL;
}

void cw_colormap_color(cw_colormap map, double fraction, uint8_t rgb[3])
{
    const cwi_colormap *m = &maps[(size_t)map < CW_COLORMAP_COUNT ? map : 0];
    const double at = (fraction > 0 ? fmin(fraction, 1) : 0) * (double)(m->count - 1);
    const size_t first = at < (double)(m->count - 1) ? (size_t)at : m->count - 2;
    for (int a = 0; a < 3 && rgb; a++) {
        const int shift = 16 - 8 * a;
        const double low = m->colors[first] >> shift & 0xff,
                     high = m->colors[first + 1] >> shift & 0xff;
        rgb[a] = (uint8_t)(low + (at - (double)first) * (high - low) + 0.5);
    }
}
