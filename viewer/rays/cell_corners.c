/* Fetches the corners of cells, by functions for each type of voxel. */
#include "viewer/rays/cell_corners.h"

#include "core/volume/volume.h"

#include <math.h>

typedef cwi_lanes lanes;

#define FETCH(name, ctype, text)                                                               \
    static bool fetch_##name(const cwi_cell_corners *c, const char *p, lanes *even,            \
                             lanes *odd)                                                       \
    {                                                                                          \
        const cw_volume *v = c->volume;                                                        \
        bool is_whole = true;                                                                  \
        for (int n = 0; n < 8; n++) {                                                          \
            const double x =                                                                   \
                (double)*(const ctype *)(p + (n & 1) * c->side[0] +                            \
                                         (n >> 1 & 1) * c->side[1] + (n >> 2) * c->side[2]);   \
            const float row = (float)(x * c->row_scale + c->row_bias);                         \
            if (!isfinite(x) || (v->has_nodata && x == v->nodata))                             \
                is_whole = false;                                                              \
            if (n & 1)                                                                         \
                (*odd)[n >> 1] = row;                                                          \
            else                                                                               \
                (*even)[n >> 1] = row;                                                         \
        }                                                                                      \
        return is_whole;                                                                       \
    }
CW_TYPE_TABLE(FETCH)
#undef FETCH

/* Differences the corners of six cells and of the cell between them. */
static bool difference(const cwi_cell_corners *c, const char *p, lanes g[3][2])
{
    lanes corners[2], low[3][2], high[3][2];
    if (!c->fetch(c, p, &corners[0], &corners[1]))
        return false;
    for (int a = 0; a < 3; a++)
        if (!c->fetch(c, p - c->side[a], &low[a][0], &low[a][1]) ||
            !c->fetch(c, p + c->side[a], &high[a][0], &high[a][1]))
            return false;
    g[0][0] = 0.5f * (corners[1] - low[0][0]);
    g[0][1] = 0.5f * (high[0][1] - corners[0]);
    for (int n = 0; n < 2; n++) {
        const lanes e = corners[n];
        lanes l = low[1][n], h = high[1][n];
        g[1][n] = 0.5f * ((lanes){e[1], h[1], e[3], h[3]} - (lanes){l[0], e[0], l[2], e[2]});
        l = low[2][n], h = high[2][n];
        g[2][n] = 0.5f * ((lanes){e[2], e[3], h[2], h[3]} - (lanes){l[0], l[1], e[0], e[1]});
    }
    return true;
}

#define INTEGERS(a, b, c, d)                                                                   \
    __builtin_convertvector(                                                                   \
        ((cwi_int_lanes){(int32_t)(a), (int32_t)(b), (int32_t)(c), (int32_t)(d)}), lanes)
#define FLOATS(a, b, c, d) ((lanes){a, b, c, d})

/* Types of at most 24 significant bits, packed along x: four numbers at once. A cell lacks a
 * value where a number is not finite, or is nodata (NaN if there is none). */
#define FETCH_PACKED(name, ctype, LANES)                                                       \
    static bool fetch_packed_##name(const cwi_cell_corners *c, const char *p, lanes *even,     \
                                    lanes *odd)                                                \
    {                                                                                          \
        const ctype *r0 = (const ctype *)p, *r1 = (const ctype *)(p + c->side[1]),             \
                    *r2 = (const ctype *)(p + c->side[2]),                                     \
                    *r3 = (const ctype *)(p + c->side[1] + c->side[2]);                        \
        const lanes e = LANES(r0[0], r1[0], r2[0], r3[0]),                                     \
                    o = LANES(r0[1], r1[1], r2[1], r3[1]);                                     \
        *even = (e - c->origin) * c->scale + c->rest;                                          \
        *odd = (o - c->origin) * c->scale + c->rest;                                           \
        return cwi_lanes_all((e - e == 0) & (o - o == 0) & (e != c->nodata) &                  \
                             (o != c->nodata));                                                \
    }                                                                                          \
                                                                                               \
    static bool difference_packed_##name(const cwi_cell_corners *c, const char *p,             \
                                         lanes g[3][2])                                        \
    {                                                                                          \
        const ptrdiff_t y = c->side[1], z = c->side[2];                                        \
        const ctype *r0 = (const ctype *)p, *r1 = (const ctype *)(p + y),                      \
                    *r2 = (const ctype *)(p + z), *r3 = (const ctype *)(p + y + z),            \
                    *y0 = (const ctype *)(p - y), *y1 = (const ctype *)(p + 2 * y),            \
                    *y2 = (const ctype *)(p - y + z), *y3 = (const ctype *)(p + 2 * y + z),    \
                    *z0 = (const ctype *)(p - z), *z1 = (const ctype *)(p - z + y),            \
                    *z2 = (const ctype *)(p + 2 * z), *z3 = (const ctype *)(p + 2 * z + y);    \
        const lanes x[4] = {                                                                   \
            LANES(r0[-1], r1[-1], r2[-1], r3[-1]), LANES(r0[0], r1[0], r2[0], r3[0]),          \
            LANES(r0[1], r1[1], r2[1], r3[1]), LANES(r0[2], r1[2], r2[2], r3[2])};             \
        const float half = 0.5f * c->scale;                                                    \
        cwi_int_lanes is_there = (x[0] - x[0] == 0) & (x[3] - x[3] == 0) &                     \
                                 (x[0] != c->nodata) & (x[3] != c->nodata);                    \
        g[0][0] = half * (x[2] - x[0]);                                                        \
        g[0][1] = half * (x[3] - x[1]);                                                        \
        for (int n = 0; n < 2; n++) {                                                          \
            const lanes e = x[1 + n], q = LANES(y0[n], y1[n], y2[n], y3[n]),                   \
                        r = LANES(z0[n], z1[n], z2[n], z3[n]);                                 \
            is_there &= (e - e == 0) & (q - q == 0) & (r - r == 0) & (e != c->nodata) &        \
                        (q != c->nodata) & (r != c->nodata);                                   \
            g[1][n] = half * (__builtin_shufflevector(e, q, 1, 5, 3, 7) -                      \
                              __builtin_shufflevector(e, q, 4, 0, 6, 2));                      \
            g[2][n] = half * (__builtin_shufflevector(e, r, 2, 3, 6, 7) -                      \
                              __builtin_shufflevector(e, r, 4, 5, 0, 1));                      \
        }                                                                                      \
        return cwi_lanes_all(is_there);                                                        \
    }
FETCH_PACKED(CW_U8, uint8_t, INTEGERS)
FETCH_PACKED(CW_I8, int8_t, INTEGERS)
FETCH_PACKED(CW_U16, uint16_t, INTEGERS)
FETCH_PACKED(CW_I16, int16_t, INTEGERS)
FETCH_PACKED(CW_F32, float, FLOATS)
#undef FETCH_PACKED

static const struct {
    cwi_cell_corners_fetch *fetch, *fetch_packed;
    cwi_cell_corners_gradients *difference_packed;
} functions[CW_TYPE_COUNT] = {
#define ROW(name)                                                                              \
    {                                                                                          \
        fetch_##name, fetch_packed_##name, difference_packed_##name                            \
    }
    [CW_U8] = ROW(CW_U8),
    [CW_I8] = ROW(CW_I8),
    [CW_U16] = ROW(CW_U16),
    [CW_I16] = ROW(CW_I16),
    [CW_F32] = ROW(CW_F32),
#undef ROW
    [CW_U32] = {.fetch = fetch_CW_U32},
    [CW_I32] = {.fetch = fetch_CW_I32},
    [CW_F64] = {.fetch = fetch_CW_F64}};

void cwi_cell_corners_make(const cw_volume *v, const cwi_table *table, cwi_cell_corners *c)
{
    const double scale = (double)(table->count - 1) / (table->high - table->low);
    const bool is_packed = functions[v->type].fetch_packed && v->dim[0] > 1 &&
                           v->stride[0] == (ptrdiff_t)cw_type_size(v->type);
    *c = (cwi_cell_corners){.volume = v};
    c->fetch = is_packed ? functions[v->type].fetch_packed : functions[v->type].fetch;
    c->gradients = is_packed ? functions[v->type].difference_packed : difference;
    c->row_scale = v->slope * scale;
    c->row_bias = (v->intercept - table->low) * scale;
    c->scale = (float)c->row_scale;
    c->origin = (float)rint(-c->row_bias / c->row_scale);
    c->rest = (float)(c->row_bias + (double)c->origin * c->row_scale);
    c->nodata = v->has_nodata && (double)(float)v->nodata == v->nodata ? (float)v->nodata : NAN;
    for (int a = 0; a < 3; a++)
        c->side[a] = v->dim[a] > 1 ? v->stride[a] : 0;
}
