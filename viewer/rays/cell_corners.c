/* Fetches the corners of cells, by a function for each type of voxel. */
#include "viewer/rays/cell_corners.h"

#include "core/volume/volume.h"

#include <math.h>

#define FETCH(name, ctype, text)                                                               \
    static bool fetch_##name(const cwi_cell_corners *c, const char *p, cwi_lanes *even,        \
                             cwi_lanes *odd)                                                   \
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

/* Fetches floats packed along x, where every number that is not NaN counts. */
static bool fetch_floats(const cwi_cell_corners *c, const char *p, cwi_lanes *even,
                         cwi_lanes *odd)
{
    const float *r0 = (const float *)p, *r1 = (const float *)(p + c->side[1]),
                *r2 = (const float *)(p + c->side[2]),
                *r3 = (const float *)(p + c->side[1] + c->side[2]);
    const float scale = (float)c->row_scale, bias = (float)c->row_bias;
    const cwi_lanes e = {r0[0], r1[0], r2[0], r3[0]}, o = {r0[1], r1[1], r2[1], r3[1]};
    *even = e * scale + bias;
    *odd = o * scale + bias;
    const cwi_lanes none = (e - e) + (o - o); /* 0, or NaN */
    return none[0] + none[1] + none[2] + none[3] == 0;
}

static cwi_cell_corners_fetch *choose_fetch(const cw_volume *v)
{
    static cwi_cell_corners_fetch *const functions[CW_TYPE_COUNT] = {
#define ROW(name, ctype, text) fetch_##name,
        CW_TYPE_TABLE(ROW)
#undef ROW
    };
    if (v->type == CW_F32 && v->dim[0] > 1 && v->stride[0] == (ptrdiff_t)sizeof(float) &&
        !v->has_nodata)
        return fetch_floats;
    return functions[v->type];
}

void cwi_cell_corners_make(const cw_volume *v, const cwi_table *table, cwi_cell_corners *c)
{
    const double scale = (double)(table->count - 1) / (table->high - table->low);
    *c = (cwi_cell_corners){.volume = v, .fetch = choose_fetch(v)};
    c->row_scale = v->slope * scale;
    c->row_bias = (v->intercept - table->low) * scale;
    for (int a = 0; a < 3; a++)
        c->side[a] = v->dim[a] > 1 ? v->stride[a] : 0;
}
