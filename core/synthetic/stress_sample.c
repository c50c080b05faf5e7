/* Samples the hard cases into volumes, and finds them by name. */
#include "core/synthetic/stress_fields.h"

#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/synthetic/random_fill.h"

#include <math.h>
#include <string.h>

const cw_hard *cw_hard_at(size_t n)
{
    const cwi_hard_row *row = cwi_hard_row_at(n);
    return row ? &row->hard : NULL;
}

bool cw_hard_find(const char *name, size_t *n)
{
    if (!name || !n)
        return false;
    const cw_hard *hard;
    for (*n = 0; (hard = cw_hard_at(*n)) != NULL; ++*n)
        if (strcmp(hard->name, name) == 0)
            return true;
    return false;
}

/* Scales the value, but does not spread it over the range as cw_field_stored() does: whole or
 * equal values stay so. */
double cw_hard_stored(size_t n, cw_type type, double value)
{
    double low, high;
    const cw_hard *hard = cw_hard_at(n);
    if (!hard || !cwi_fill_range(type, &low, &high))
        return value;
    return value * hard->scale + (low == 0 ? 128 : 0);
}

typedef struct sampling {
    const cwi_hard_row *row;
    const cw_hard_desc *desc;
    const cw_volume *volume;
} sampling;

static void sample_layer(void *context, size_t k)
{
    const sampling *w = context;
    const cw_hard_desc *d = w->desc;
    const cw_volume *v = w->volume;
    cwi_hard_sample s = {.at = {0, 0, k},
                         .dim = {v->dim[0], v->dim[1], v->dim[2]},
                         .type = d->type,
                         .seed = d->seed,
                         .parameter = w->row->parameter};
    for (s.at[1] = 0; s.at[1] < v->dim[1]; s.at[1]++)
        for (s.at[0] = 0; s.at[0] < v->dim[0]; s.at[0]++) {
            const size_t n = (k * v->dim[1] + s.at[1]) * v->dim[0] + s.at[0];
            double value = w->row->value(&s);
            if (d->noise > 0) /* a stream of its own, different from noisy cases */
                value += d->noise * cwi_gaussian(~d->seed, n);
            cwi_fill(d->type, v->owned, n, cw_hard_stored(d->number, d->type, value));
        }
}

static void place_samples(const cw_hard *hard, cw_volume *volume)
{
    for (int a = 0; a < 3; a++) {
        const double middle = 0.5 * hard->spacing_mm * (double)(volume->dim[a] - 1);
        volume->affine[a][a] = hard->spacing_mm;
        volume->affine[a][3] = hard->first_mm > 0 ? hard->first_mm : -middle;
    }
    volume->known = CW_KNOWN_UNIT | CW_KNOWN_FRAME;
}

static cw_status check_desc(const cw_hard_desc *d, cw_error *err)
{
    const cw_hard *hard = cw_hard_at(d->number);
    double low, high;
    if (!hard)
        return cwi_fail(err, CW_ERR_ARGUMENT, "there is no hard case %zu", d->number);
    if (!(d->noise >= 0) || !isfinite(d->noise))
        return cwi_fail(err, CW_ERR_ARGUMENT, "noise %g must be 0 or more", d->noise);
    if (hard->scale == 0 && (unsigned)d->type < CW_TYPE_COUNT &&
        cwi_fill_range(d->type, &low, &high))
        return cwi_fail(err, CW_ERR_ARGUMENT, "%s is made of floats, f32 or f64, not %s",
                        hard->name, cw_type_name(d->type));
    return CW_OK;
}

cw_status cw_hard_sample(const cw_hard_desc *desc, cw_volume *volume, cw_error *err)
{
    CWI_REQUIRE(err, desc, volume);
    CWI_REQUIRE_VERSION(err, desc, 0);
    cw_hard_desc d = *desc;
    *volume = (cw_volume){0};
    cw_status st = check_desc(&d, err);
    if (st != CW_OK)
        return st;
    for (int a = 0; a < 3; a++)
        d.dim[a] = d.dim[a] ? d.dim[a] : 64;
    st = cw_volume_alloc(volume, d.type, d.dim, 1, 1, err);
    if (st != CW_OK)
        return st;
    const cwi_hard_row *row = cwi_hard_row_at(d.number);
    place_samples(&row->hard, volume);
    st = cwi_parallel_for(d.dim[2], d.dim[0] * d.dim[1], d.threads, &d.progress, "sampling",
                          sample_layer, &(sampling){row, &d, volume}, err);
    if (st != CW_OK)
        cw_volume_free(volume);
    return st;
}
