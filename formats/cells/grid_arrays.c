/* Loads arrays of tuples into memory, and returns their numbers as doubles or whole numbers. */
#include "formats/cells/grid_arrays.h"

#include "core/volume/volume.h"
#include "formats/bytes/byte_order.h"

#include <math.h>
#include <string.h>

cw_status cwi_tuples_describe(cwi_source *src, const char *field, cw_type type, bool wide,
                              size_t components, size_t count, cw_error *err)
{
    const cwi_axis axes[] = {{CWI_AXIS_COMPONENT, components * (wide ? 2 : 1)},
                             {CWI_AXIS_X, count}};
    *src = (cwi_source){
        .size_field = field, .noun = "numbers", .shape = {.slope = 1, .type = type}};
    return cwi_source_set_axes(src, axes, 2, err);
}

/* Joins the halves of 64-bit numbers. Each half was byte-swapped, but the order of halves is
 * still the file's. */
static void join_halves(cwi_tuples *t)
{
    uint32_t *half = t->data.owned;
    for (size_t i = 0; i < t->count * t->components; i++) {
        const uint32_t first = half[2 * i];
        half[2 * i] = half[2 * i + 1];
        half[2 * i + 1] = first;
    }
}

cw_status cwi_tuples_load(const cwi_source *src, const cwi_input *in, const cw_read_desc *desc,
                          bool wide, cwi_tuples *t, cw_error *err)
{
    const cw_read_desc whole = {.progress = desc->progress};
    *t = (cwi_tuples){.count = src->shape.dim[0],
                      .components = src->shape.components / (wide ? 2 : 1),
                      .wide = wide,
                      .bytes = src->bytes};
    cw_status st = cwi_source_load(src, in, &whole, &t->data, err);
    if (st == CW_OK && wide && src->big_endian != cwi_machine_is_big_endian())
        join_halves(t);
    return st;
}

void cwi_tuples_free(cwi_tuples *t)
{
    cw_volume_free(&t->data);
    *t = (cwi_tuples){.count = 0};
}

static int64_t join_words(const cwi_tuples *t, size_t n)
{
    int64_t number;
    memcpy(&number, (const char *)t->data.data + n * sizeof number, sizeof number);
    return number;
}

double cwi_tuples_real(const cwi_tuples *t, size_t i, size_t component)
{
    const cw_volume *v = &t->data;
    const ptrdiff_t at =
        (ptrdiff_t)i * v->stride[0] + (ptrdiff_t)component * v->component_stride;
    return t->wide ? (double)join_words(t, i * t->components + component)
                   : cwi_voxel_at(v->type, (const char *)v->data + at);
}

int64_t cwi_tuples_whole(const cwi_tuples *t, size_t i)
{
    if (t->wide)
        return join_words(t, i * t->components);
    const double value = cwi_tuples_real(t, i, 0);
    return fabs(value) < 0x1p53 ? (int64_t)value : -1;
}
