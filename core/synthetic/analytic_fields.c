/* Evaluates the analytic fields (sphere, torus, plane, gyroid, Marschner-Lobb, CT head) and
 * samples them into volumes. */
#include <cubewright/field.h>

#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/geometry/affine.h"
#include "core/geometry/vec3.h"
#include "core/synthetic/random_fill.h"

#include <math.h>
#include <string.h>

static const struct {
    const char *name;
    double isovalue, low, high, span_mm;
    const char *about;
} fields[CW_FIELD_COUNT] = {
#define ROW(name, text, iso, low, high, span, about) {text, iso, low, high, span, about},
    CW_FIELD_TABLE(ROW)
#undef ROW
};

static bool is_known_field(cw_field field)
{
    return (unsigned)field < CW_FIELD_COUNT;
}

const char *cw_field_name(cw_field field)
{
    return is_known_field(field) ? fields[field].name : "unknown";
}

const char *cw_field_about(cw_field field)
{
    return is_known_field(field) ? fields[field].about : "";
}

double cw_field_isovalue(cw_field field)
{
    return is_known_field(field) ? fields[field].isovalue : 0;
}

bool cw_field_find(const char *name, cw_field *field)
{
    if (!name || !field)
        return false;
    for (int f = 0; f < CW_FIELD_COUNT; f++)
        if (strcmp(name, fields[f].name) == 0) {
            *field = (cw_field)f;
            return true;
        }
    return false;
}

static double vector_length(double x, double y, double z)
{
    return sqrt(x * x + y * y + z * z);
}

static double evaluate_gyroid(const double p[3])
{
    const double k = 2 * CWI_PI * 2.5 / 80;
    return sin(k * p[0]) * cos(k * p[1]) + sin(k * p[1]) * cos(k * p[2]) +
           sin(k * p[2]) * cos(k * p[0]);
}

/* Evaluates equation 1 of [Marschner1994], f_M = 6, alpha = 0.25, on -1..1. */
static double marschner_lobb(const double p[3])
{
    const double alpha = 0.25, frequency = 6;
    const double r = sqrt(p[0] * p[0] + p[1] * p[1]);
    const double wave = cos(2 * CWI_PI * frequency * cos(CWI_PI * r / 2));
    return (1 - sin(CWI_PI * p[2] / 2) + alpha * (1 + wave)) / (2 * (1 + alpha));
}

/* Parts of the head, LPS millimetres: ellipsoids, each painted over those before it. */
static const struct {
    double centre[3], radius[3], hu;
} head[] = {
    {{0, 10, -95}, {42, 46, 55}, 40},                                       /* neck */
    {{0, 0, 10}, {72, 90, 100}, 40},                                        /* scalp and face */
    {{0, -26, -62}, {50, 54, 40}, 40},                                      /* lower face */
    {{0, -86, -20}, {11, 20, 20}, 40},                                      /* nose */
    {{71, 14, -8}, {8, 15, 25}, 40},                                        /* ears */
    {{-71, 14, -8}, {8, 15, 25}, 40},   {{0, -26, -70}, {40, 44, 22}, 900}, /* jaw */
    {{0, -14, -64}, {31, 44, 34}, 40},                                      /* mouth's floor */
    {{0, 4, 26}, {66, 82, 80}, 1000},                                       /* skull */
    {{0, 4, 26}, {60, 76, 74}, 35},                                         /* brain */
    {{29, -64, -4}, {15, 20, 13}, 20}, /* eyes in their sockets */
    {{-29, -64, -4}, {15, 20, 13}, 20}, {{0, -64, -30}, {9, 20, 15}, -950}, /* nasal cavity */
    {{11, 0, 34}, {7, 26, 12}, 5},                                          /* ventricles */
    {{-11, 0, 34}, {7, 26, 12}, 5},     {{0, 26, -92}, {15, 15, 58}, 700},  /* spine */
    {{0, 26, -92}, {8, 8, 58}, 30},
};

/* Evaluates the CT head. Edges are soft, about 2 mm wide, like the point spread of a scanner.
 * The distance to an ellipsoid is first order: the implicit function over the length of its
 * gradient. */
static double ct_head(const double p[3])
{
    double hu = -1000;
    for (size_t n = 0; n < sizeof head / sizeof *head; n++) {
        double value = 0, slope = 0;
        for (int a = 0; a < 3; a++) {
            const double q = (p[a] - head[n].centre[a]) / head[n].radius[a];
            value += q * q;
            slope += q * q / (head[n].radius[a] * head[n].radius[a]);
        }
        const double root = sqrt(value);
        const double distance =
            slope > 0 ? (root - 1) * root / sqrt(slope) : -head[n].radius[0];
        const double fraction = 0.5 - 0.5 * tanh(distance);
        hu += fraction * (head[n].hu - hu);
    }
    return hu;
}

double cw_field_value(cw_field field, const double p[3])
{
    switch (field) {
    case CW_FIELD_SPHERE:
        return 30 - vector_length(p[0], p[1], p[2]);
    case CW_FIELD_TORUS:
        return 10 - vector_length(sqrt(p[0] * p[0] + p[1] * p[1]) - 26, p[2], 0);
    case CW_FIELD_PLANE:
        return (p[0] + 2 * p[1] + 3 * p[2]) / sqrt(14.0);
    case CW_FIELD_GYROID:
        return evaluate_gyroid(p);
    case CW_FIELD_MARSCHNER_LOBB:
        return marschner_lobb(p);
    case CW_FIELD_CT_HEAD:
        return ct_head(p);
    default:
        return NAN;
    }
}

double cw_field_stored(cw_field field, cw_type type, double value)
{
    double low, high;
    if (!is_known_field(field) || !cwi_fill_range(type, &low, &high))
        return value;
    if (field == CW_FIELD_CT_HEAD && cw_type_size(type) > 1)
        return value + (low == 0 ? 1024 : 0);
    const double fraction =
        (value - fields[field].low) / (fields[field].high - fields[field].low);
    return low + fraction * (high - low);
}

typedef struct sampling {
    const cw_field_desc *desc;
    const cw_volume *volume;
} sampling;

static void sample_layer(void *context, size_t k)
{
    const sampling *s = context;
    const cw_field_desc *d = s->desc;
    const cw_volume *v = s->volume;
    for (size_t j = 0; j < v->dim[1]; j++)
        for (size_t i = 0; i < v->dim[0]; i++) {
            const double index[3] = {(double)i, (double)j, (double)k};
            const size_t n = (k * v->dim[1] + j) * v->dim[0] + i;
            double world[3];
            cwi_affine_apply(v->affine[0], index, world);
            double value = cw_field_value(d->field, world);
            if (d->noise > 0)
                value += d->noise * cwi_gaussian(d->seed, n);
            cwi_fill(d->type, v->owned, n, cw_field_stored(d->field, d->type, value));
        }
}

cw_status cw_field_sample(const cw_field_desc *desc, cw_volume *volume, cw_error *err)
{
    CWI_REQUIRE(err, desc, volume);
    CWI_REQUIRE_VERSION(err, desc, 0);
    cw_field_desc d = *desc;
    size_t longest = 0;
    if (!is_known_field(d.field))
        return cwi_fail(err, CW_ERR_ARGUMENT, "%d is not a field", (int)d.field);
    if (!(d.noise >= 0) || !isfinite(d.noise))
        return cwi_fail(err, CW_ERR_ARGUMENT, "noise %g must be 0 or more", d.noise);
    for (int a = 0; a < 3; a++) {
        d.dim[a] = d.dim[a] ? d.dim[a] : 64;
        longest = d.dim[a] > longest ? d.dim[a] : longest;
    }
    cw_status st = cw_volume_alloc(volume, d.type, d.dim, 1, 1, err);
    if (st != CW_OK)
        return st;
    const double spacing = longest > 1 ? fields[d.field].span_mm / (double)(longest - 1) : 1;
    for (int a = 0; a < 3; a++) {
        volume->affine[a][a] = spacing;
        volume->affine[a][3] = -0.5 * spacing * (double)(d.dim[a] - 1);
    }
    volume->known = CW_KNOWN_UNIT | CW_KNOWN_FRAME;
    st = cwi_parallel_for(d.dim[2], d.dim[0] * d.dim[1], d.threads, &d.progress, "sampling",
                          sample_layer, &(sampling){&d, volume}, err);
    if (st != CW_OK)
        cw_volume_free(volume);
    return st;
}
