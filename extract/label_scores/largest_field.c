/* Checks fields of labels, and finds the largest at each voxel. Fields are read as they are stored, a
 * row at a time. */
#include "extract/label_scores/largest_field.h"

#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/geometry/vec3.h"
#include "core/volume/volume.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double DEFAULT_VALUE = 0.5;

/* How far corners of fields' grids may be apart, in the smallest distance of voxels. */
static const double SAME_PLACE = 0.01;

enum { NAME = 160 };

/* Returns the words for a field in messages. */
static const char *name_field(const cw_label_scores *fields, size_t n, char text[NAME])
{
    if (fields->names && fields->names[n])
        snprintf(text, NAME, "%s", fields->names[n]);
    else
        snprintf(text, NAME, "field %zu", n);
    return text;
}

/* Returns the largest distance of a grid's corners from those of another one, mm. */
static double find_distance(const cw_volume *a, const cw_volume *b)
{
    double p[8][3], q[8][3], max = 0;
    cw_volume_corners(a, p);
    cw_volume_corners(b, q);
    for (int n = 0; n < 8; n++)
        max = fmax(max, sqrt(cwi_distance_sq(p[n], q[n])));
    return max;
}

/* Returns true if coordinates of two rectilinear grids are the same, or both are even. */
static bool have_same_planes(const cw_volume *a, const cw_volume *b)
{
    for (int n = 0; n < 3; n++)
        if (!a->coordinates[n] != !b->coordinates[n] ||
            (a->coordinates[n] &&
             memcmp(a->coordinates[n], b->coordinates[n], a->dim[n] * sizeof(double)) != 0))
            return false;
    return true;
}

static cw_status expect_same_grid(const cw_label_scores *fields, const cw_volume *first,
                                  const cw_volume *v, size_t n, cw_error *err)
{
    char name[NAME], other[NAME];
    double spacing[3];
    name_field(fields, n, name);
    name_field(fields, 0, other);
    if (memcmp(v->dim, first->dim, sizeof v->dim) != 0)
        return cwi_fail(
            err, CW_ERR_ARGUMENT,
            "%s has %zu x %zu x %zu voxels, and %s %zu x %zu x %zu: fields of labels "
            "need one grid",
            name, v->dim[0], v->dim[1], v->dim[2], other, first->dim[0], first->dim[1],
            first->dim[2]);
    cw_volume_spacing(first, spacing);
    const double apart = find_distance(first, v);
    if (!(apart <= SAME_PLACE * fmin(fmin(spacing[0], spacing[1]), spacing[2])) ||
        !have_same_planes(first, v))
        return cwi_fail(
            err, CW_ERR_ARGUMENT,
            "%s lies elsewhere than %s, by up to %.4g mm: fields of labels need one "
            "grid",
            name, other, apart);
    return CW_OK;
}

static int compare_channels(const void *a, const void *b)
{
    const cwi_label_channel *x = a, *y = b;
    return (x->label > y->label) - (x->label < y->label);
}

/* Lists the labels of fields, and refuses those that are there twice or not at all. */
static cw_status list_labels(cwi_label_scores *f, const cw_label_scores *fields, cw_error *err)
{
    const bool has_field = f->rule == CW_BACKGROUND_FIELD;
    bool is_found = false;
    char name[NAME], other[NAME];
    for (size_t n = 0; n < f->count; n++) {
        f->labels[n] = fields->labels ? fields->labels[n] : (uint32_t)(n + !has_field);
        f->by_label[n] = (cwi_label_channel){f->labels[n], (uint32_t)n};
        is_found = is_found || f->labels[n] == f->background;
        if (!has_field && f->labels[n] == f->background)
            return cwi_fail(err, CW_ERR_ARGUMENT,
                            "%s has label %u, which is the background's: a field of it needs "
                            "CW_BACKGROUND_FIELD",
                            name_field(fields, n, name), f->background);
    }
    qsort(f->by_label, f->count, sizeof *f->by_label, compare_channels);
    for (size_t n = 1; n < f->count; n++)
        if (f->by_label[n].label == f->by_label[n - 1].label)
            return cwi_fail(err, CW_ERR_ARGUMENT, "%s and %s both have label %u",
                            name_field(fields, f->by_label[n - 1].field, name),
                            name_field(fields, f->by_label[n].field, other),
                            f->by_label[n].label);
    return is_found || !has_field
               ? CW_OK
               : cwi_fail(err, CW_ERR_ARGUMENT,
                          "none of the %zu fields is that of the background, %u", f->count,
                          f->background);
}

static cw_status check_fields(cwi_label_scores *f, const cw_label_scores *fields, cw_error *err)
{
    cw_status st = CW_OK;
    if (fields->count == 0 || !fields->fields || fields->count >= UINT32_MAX)
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "there are %zu fields of labels: 1 or more are needed",
                        fields->fields ? fields->count : 0);
    if ((unsigned)fields->rule >= CW_BACKGROUND_RULE_COUNT)
        return cwi_fail(err, CW_ERR_ARGUMENT, "%d is no rule for the background: 0 to %d",
                        (int)fields->rule, CW_BACKGROUND_RULE_COUNT - 1);
    if (fields->has_value && !isfinite(fields->value))
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "the background's value is %g: a finite one is needed", fields->value);
    f->count = fields->count;
    f->rule = fields->rule;
    f->value = fields->has_value ? fields->value : DEFAULT_VALUE;
    f->volumes = cwi_alloc_array(f->count, sizeof *f->volumes);
    f->labels = cwi_alloc_array(f->count, sizeof *f->labels);
    f->by_label = cwi_alloc_array(f->count, sizeof *f->by_label);
    if (!f->volumes || !f->labels || !f->by_label)
        return cwi_fail_memory(err);
    for (size_t n = 0; n < f->count && st == CW_OK; n++) {
        char name[NAME];
        st = cw_volume_resolve(&fields->fields[n], &f->volumes[n], err);
        if (st == CW_OK)
            st = cwi_volume_expect_dense(&f->volumes[n], "extracting labels", err);
        if (st != CW_OK)
            return cwi_fail_in(err, st, name_field(fields, n, name));
        st = expect_same_grid(fields, &f->volumes[0], &f->volumes[n], n, err);
    }
    return st == CW_OK ? list_labels(f, fields, err) : st;
}

/* --- the map ------------------------------------------------------------------------------ */

/* A search for the largest fields. */
typedef struct search {
    cwi_label_scores *f;
    void *map;
    bool is_starved;
} search;

/* Rows of one row of voxels. */
typedef struct rows {
    double *value, *best, *sum, *field; /* field: its number from 1; 0: none */
} rows;

/* Loads a row of a field: NaN where it has no value. */
static void load_row(const cw_volume *v, size_t y, size_t z, double *out)
{
    const char *from = cwi_voxel_address(v, 0, y, z);
    const ptrdiff_t stride = v->stride[0];
    switch (v->type) {
#define CASE(name, ctype, text)                                                                \
    case name:                                                                                 \
        if (stride == (ptrdiff_t)sizeof(ctype))                                                \
            for (size_t i = 0; i < v->dim[0]; i++)                                             \
                out[i] = (double)((const ctype *)from)[i];                                     \
        else                                                                                   \
            for (size_t i = 0; i < v->dim[0]; i++)                                             \
                out[i] = (double)*(const ctype *)(from + (ptrdiff_t)i * stride);               \
        break;
        CW_TYPE_TABLE(CASE)
#undef CASE
    default:
        break;
    }
    for (size_t i = 0; i < v->dim[0] && v->has_nodata; i++)
        out[i] = out[i] == v->nodata ? NAN : out[i];
    for (size_t i = 0; i < v->dim[0] && (v->slope != 1 || v->intercept != 0); i++)
        out[i] = v->slope * out[i] + v->intercept;
}

/* Finds the largest field of each voxel of a row, and the sum of all. */
static void compare_fields(const cwi_label_scores *f, size_t y, size_t z, const rows *r)
{
    const size_t count = f->map.dim[0];
    for (size_t i = 0; i < count; i++) {
        r->best[i] = -INFINITY;
        r->sum[i] = 0;
        r->field[i] = 0;
    }
    for (size_t n = 0; n < f->count; n++) {
        double *restrict value = r->value, *restrict best = r->best, *restrict field = r->field;
        load_row(&f->volumes[n], y, z, value);
        for (size_t i = 0; i < count; i++) {
            field[i] = value[i] > best[i] ? (double)(n + 1) : field[i];
            best[i] = value[i] > best[i] ? value[i] : best[i];
        }
        for (size_t i = 0; i < count && f->rest; i++)
            r->sum[i] += r->value[i] == r->value[i] ? r->value[i] : 0;
    }
}

static void find_layer(void *context, size_t z)
{
    search *s = context;
    const cwi_label_scores *f = s->f;
    const cw_volume *map = &f->map;
    const size_t count = map->dim[0];
    double *memory = cwi_alloc_array(count, 4 * sizeof *memory);
    if (!memory) {
        cwi_set_flag(&s->is_starved);
        return;
    }
    const rows r = {memory, memory + count, memory + 2 * count, memory + 3 * count};
    for (size_t y = 0; y < map->dim[1]; y++) {
        const size_t first = (z * map->dim[1] + y) * count, size = cw_type_size(map->type);
        compare_fields(f, y, z, &r);
        for (size_t i = 0; i < count; i++) {
            double against = f->rule == CW_BACKGROUND_VALUE ? f->value : -INFINITY;
            if (f->rest)
                against = f->rest[first + i] = (float)(1 - r.sum[i]);
            const bool is_label = r.field[i] > 0 && r.best[i] > against;
            cwi_voxel_put(map->type, (char *)s->map + (first + i) * size,
                          is_label ? f->labels[(size_t)r.field[i] - 1] : f->background);
        }
    }
    cwi_free(memory);
}

/* Makes an empty map in the grid of the fields. */
static cw_status make_map(cwi_label_scores *f, cw_error *err)
{
    const cw_volume *first = &f->volumes[0];
    uint32_t largest = f->by_label[f->count - 1].label;
    largest = largest > f->background ? largest : f->background;
    const cw_type type = largest <= UINT8_MAX ? CW_U8 : largest <= UINT16_MAX ? CW_U16 : CW_U32;
    cw_status st = cw_volume_alloc(&f->map, type, first->dim, 1, 1, err);
    if (st != CW_OK)
        return st;
    memcpy(f->map.affine, first->affine, sizeof f->map.affine);
    memcpy(f->map.coordinates, first->coordinates, sizeof f->map.coordinates);
    f->map.said_unit_mm = first->said_unit_mm;
    f->map.said_ras = first->said_ras;
    f->map.known =
        (first->known & (CW_KNOWN_UNIT | CW_KNOWN_FRAME)) | (unsigned)CW_KNOWN_LABELS;
    if (f->rule == CW_BACKGROUND_REST) {
        f->rest =
            cwi_alloc_large(first->dim[0] * first->dim[1] * first->dim[2], sizeof *f->rest);
        st = f->rest ? CW_OK : cwi_fail_memory(err);
    }
    return st;
}

cw_status cwi_label_scores_open(cwi_label_scores *f, const cw_label_scores *fields,
                                uint32_t background, int threads, const cw_progress *progress,
                                cw_error *err)
{
    *f = (cwi_label_scores){.background = background};
    cw_status st = check_fields(f, fields, err);
    if (st == CW_OK)
        st = make_map(f, err);
    if (st != CW_OK)
        return st;
    search s = {.f = f, .map = cw_volume_voxels(&f->map)};
    st = cwi_parallel_for(f->map.dim[2], f->count * f->map.dim[0] * f->map.dim[1], threads,
                          progress, "comparing", find_layer, &s, err);
    if (st == CW_OK && s.is_starved)
        st = cwi_fail_memory(err);
    return st == CW_OK ? cw_volume_resolve(&f->map, &f->map, err) : st;
}

void cwi_label_scores_close(cwi_label_scores *f)
{
    cwi_free(f->volumes);
    cwi_free(f->labels);
    cwi_free(f->by_label);
    cwi_free(f->rest);
    cw_volume_free(&f->map);
    *f = (cwi_label_scores){0};
}

uint32_t cwi_label_score_of(const cwi_label_scores *f, uint32_t label)
{
    const cwi_label_channel key = {label, 0}, *found = NULL;
    if (label != f->background || f->rule == CW_BACKGROUND_FIELD)
        found = bsearch(&key, f->by_label, f->count, sizeof key, compare_channels);
    return found ? found->field : CWI_NO_FIELD;
}

uint32_t cwi_label_scores_label(const cwi_label_scores *f, const size_t at[3])
{
    return (uint32_t)cwi_voxel_at(f->map.type, cwi_voxel_address(&f->map, at[0], at[1], at[2]));
}

double cwi_label_score_value(const cwi_label_scores *f, uint32_t field, const size_t at[3])
{
    if (field == CWI_NO_FIELD && f->rest) {
        const size_t *dim = f->map.dim;
        return (double)f->rest[(at[2] * dim[1] + at[1]) * dim[0] + at[0]];
    }
    if (field == CWI_NO_FIELD)
        return f->value;
    const cw_volume *v = &f->volumes[field];
    const double stored = cwi_voxel_at(v->type, cwi_voxel_address(v, at[0], at[1], at[2]));
    return v->has_nodata && stored == v->nodata ? NAN : v->slope * stored + v->intercept;
}
