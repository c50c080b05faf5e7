/* Replaces the numbers of labels that no voxel can have: of volumes in memory, and of slices. */
#include "formats/label_numbers.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/volume/label_ids.h"
#include "core/volume/volume.h"
#include "formats/bytes/input_file.h"

#include <string.h>

enum { PIECE = 1024, SLICE_BYTES = 1 << 22 };

static bool is_unsigned(const cw_volume *v)
{
    return (int)v->type == CWI_U64;
}

/* Reports a voxel that is no label. */
static cw_status fail_voxel(const cw_volume *v, const char *at, const size_t place[3],
                            const char *why, cw_error *err)
{
    if (cwi_id_is_wide(v->type))
        return cwi_fail(err, CW_ERR_ARGUMENT, "voxel %zu, %zu, %zu is no label: %s", place[0],
                        place[1], place[2], why);
    return cwi_fail(
        err, CW_ERR_ARGUMENT, "voxel %zu, %zu, %zu is %.10g: %s", place[0], place[1], place[2],
        (v->slope != 0 ? v->slope : 1) * cwi_voxel_at(v->type, at) + v->intercept, why);
}

static const char no_whole[] =
    "labels are whole numbers; desc->round_labels takes the nearest; "
    "cw_extract_label_scores() is for probabilities";

/* --- volumes ----------------------------------------------------------------------------- */

/* The rows of a volume in memory, of all its components and steps. */
typedef struct rows {
    const cw_volume *v;
    size_t components, steps;
} rows;

static size_t count_rows(const rows *r)
{
    return r->v->dim[1] * r->v->dim[2] * r->components * r->steps;
}

/* Returns the offset in bytes of a row. place: set to its y and z */
static ptrdiff_t find_row(const rows *r, size_t n, size_t place[3])
{
    const cw_volume *v = r->v;
    place[0] = 0;
    place[1] = n % v->dim[1];
    place[2] = n / v->dim[1] % v->dim[2];
    const size_t rest = n / v->dim[1] / v->dim[2];
    return (ptrdiff_t)place[1] * v->stride[1] + (ptrdiff_t)place[2] * v->stride[2] +
           (ptrdiff_t)(rest % r->components) * v->component_stride +
           (ptrdiff_t)(rest / r->components) * v->step_stride;
}

/* Loads a piece of a row as numbers. Returns false for a voxel that is no whole number, and sets place[0]
 * to it. */
static bool load_piece(const rows *r, ptrdiff_t row, size_t x, cwi_id_census *census,
                       int64_t piece[PIECE], size_t *count, size_t place[3])
{
    const cw_volume *v = r->v;
    const char *from = (const char *)v->data + row + (ptrdiff_t)x * v->stride[0];
    *count = v->dim[0] - x < PIECE ? v->dim[0] - x : PIECE;
    const size_t good = cwi_id_load(v, from, v->stride[0], *count, census, piece);
    place[0] = x + good;
    return good == *count;
}

/* Adds the numbers of all voxels to a census. */
static cw_status take_census(const rows *r, cwi_id_census *census, cw_error *err)
{
    const cw_volume *v = r->v;
    int64_t piece[PIECE];
    size_t place[3], count = 0;
    cw_status st = CW_OK;
    for (size_t n = 0; n < count_rows(r) && st == CW_OK; n++) {
        const ptrdiff_t row = find_row(r, n, place);
        for (size_t x = 0; x < v->dim[0] && st == CW_OK; x += count) {
            const bool is_whole = load_piece(r, row, x, census, piece, &count, place);
            const char *at = (const char *)v->data + row + (ptrdiff_t)place[0] * v->stride[0];
            st = is_whole ? cwi_id_add(census, piece, count, err)
                          : fail_voxel(v, at, place, no_whole, err);
        }
    }
    return st;
}

/* Writes the values of all voxels, packed in the order of rows. */
static void write_values(const rows *r, cwi_id_census *census, const cwi_key_counts *places,
                         uint32_t *to)
{
    cwi_id_census again = {.rounds = census->rounds};
    int64_t piece[PIECE];
    size_t place[3], count = 0;
    for (size_t n = 0; n < count_rows(r); n++) {
        const ptrdiff_t row = find_row(r, n, place);
        for (size_t x = 0; x < r->v->dim[0]; x += count, to += count) {
            load_piece(r, row, x, &again, piece, &count, place);
            cwi_id_replace(places, piece, count, to);
        }
    }
}

/* Returns true if rows follow each other in memory, as wide as their values or wider. */
static bool is_packed(const rows *r, const cw_volume *v)
{
    const ptrdiff_t size = (ptrdiff_t)cw_type_size(v->type), x = (ptrdiff_t)v->dim[0];
    const ptrdiff_t slices = size * x * (ptrdiff_t)v->dim[1] * (ptrdiff_t)v->dim[2];
    return size >= (ptrdiff_t)sizeof(uint32_t) && v->data == v->owned && v->stride[0] == size &&
           v->stride[1] == size * x && v->stride[2] == v->stride[1] * (ptrdiff_t)v->dim[1] &&
           (r->components == 1 || v->component_stride == slices) &&
           (r->steps == 1 || v->step_stride == slices * (ptrdiff_t)r->components);
}

/* Replaces the voxels by values of 32 bits: components and steps one after the other. Where they are so
 * already, it is done in place. */
static cw_status replace_voxels(const rows *r, cwi_id_census *census,
                                const cwi_key_counts *places, cw_volume *volume, cw_error *err)
{
    const cw_volume *v = r->v;
    const ptrdiff_t size = (ptrdiff_t)sizeof(uint32_t), x = (ptrdiff_t)v->dim[0],
                    y = (ptrdiff_t)v->dim[1], z = (ptrdiff_t)v->dim[2];
    const bool in_place = is_packed(r, v);
    uint32_t *values =
        in_place ? v->owned : cwi_alloc_large(count_rows(r) * v->dim[0], sizeof *values);
    if (!values)
        return cwi_fail_memory(err);
    write_values(r, census, places, values);
    if (!in_place)
        cwi_free(volume->owned);
    volume->data = volume->owned = values;
    volume->type = CW_U32;
    volume->stride[0] = size;
    volume->stride[1] = size * x;
    volume->stride[2] = size * x * y;
    volume->component_stride = size * x * y * z;
    volume->step_stride = volume->component_stride * (ptrdiff_t)r->components;
    volume->slope = 1;
    volume->intercept = volume->nodata = 0;
    volume->has_nodata = false;
    return CW_OK;
}

/* Gives the shape of a header the type that voxels may have. */
static void renumber_shape(cw_volume *v)
{
    if (!cwi_id_is_wide(v->type))
        return;
    for (int a = 0; a < 3; a++)
        v->stride[a] /= 2;
    v->component_stride /= 2;
    v->step_stride /= 2;
    v->type = CW_U32;
}

cw_status cwi_renumber_volume(const cw_read_desc *desc, cw_volume *volume, cw_error *err)
{
    const cw_volume before = *volume;
    const rows r = {&before, before.components ? before.components : 1,
                    before.steps ? before.steps : 1};
    cwi_id_census census = {.is_unsigned = is_unsigned(volume), .rounds = desc->round_labels};
    if (volume->cells || volume->sparse || !cwi_id_may_replace(volume))
        return CW_OK;
    if (!volume->data) {
        renumber_shape(volume);
        return CW_OK;
    }
    cw_status st = take_census(&r, &census, err);
    const bool is_needed =
        census.has_outside || census.rounded > 0 || cwi_id_is_wide(volume->type);
    if (st == CW_OK && is_needed)
        st = cwi_id_list(&census, desc->ids, err);
    if (st == CW_OK && is_needed)
        st = replace_voxels(&r, &census, &census.places, volume, err);
    cwi_key_counts_free(&census.places);
    if (st != CW_OK) {
        cw_volume_free(volume);
        cw_label_ids_free(desc->ids);
    }
    return st;
}

/* --- slices ------------------------------------------------------------------------------ */

/* Slices of numbers that are replaced as they are read. */
typedef struct replaced_slices {
    const cw_slice_source *from;
    cw_volume shape; /* of the source, complete */
    cwi_key_counts places;
    cwi_id_census census; /* rounds */
    char *slice;
} replaced_slices;

/* Reads a slice as numbers, row by row. to: gets their places; NULL: they are counted */
static cw_status read_slice(replaced_slices *s, size_t k, uint32_t *to, cw_error *err)
{
    const cw_volume *v = &s->shape;
    int64_t piece[PIECE];
    cw_status st = s->from->read(s->from->user, k, 1, s->slice, err);
    for (size_t j = 0; j < v->dim[1] && st == CW_OK; j++)
        for (size_t x = 0, count; x < v->dim[0] && st == CW_OK; x += count) {
            const char *at =
                s->slice + (ptrdiff_t)j * v->stride[1] + (ptrdiff_t)x * v->stride[0];
            count = v->dim[0] - x < PIECE ? v->dim[0] - x : PIECE;
            size_t good = cwi_id_load(v, at, v->stride[0], count, &s->census, piece);
            const char *why = no_whole;
            if (good == count && !to) {
                st = cwi_id_add(&s->census, piece, count, err);
            } else if (good == count) {
                good = cwi_id_replace(&s->places, piece, count, to + j * v->dim[0] + x);
                why = "it was another number when the labels were listed";
            }
            if (st == CW_OK && good < count)
                st = fail_voxel(v, at + (ptrdiff_t)good * v->stride[0],
                                (const size_t[3]){x + good, j, k}, why, err);
        }
    return st;
}

static cw_status read_replaced(void *user, size_t first, size_t count, void *to, cw_error *err)
{
    replaced_slices *s = user;
    const size_t size = s->shape.dim[0] * s->shape.dim[1];
    cw_status st = CW_OK;
    for (size_t n = 0; n < count && st == CW_OK; n++)
        st = read_slice(s, first + n, (uint32_t *)to + n * size, err);
    return st;
}

/* Fills in the defaults of a shape whose type may be of 64 bits. */
static cw_status open_slices(replaced_slices *s, const cw_slice_source *source, cw_error *err)
{
    const cw_volume *v = &source->shape;
    const ptrdiff_t size = (ptrdiff_t)cw_type_size(v->type);
    s->from = source;
    s->shape = *v;
    if (!v->stride[0] && !v->stride[1] && !v->stride[2]) {
        s->shape.stride[0] = size;
        s->shape.stride[1] = size * (ptrdiff_t)v->dim[0];
        s->shape.stride[2] = s->shape.stride[1] * (ptrdiff_t)v->dim[1];
    }
    s->slice = cwi_alloc_array((size_t)s->shape.stride[2], 1);
    return s->slice ? CW_OK : cwi_fail_memory(err);
}

cw_status cwi_visit_renumbered(const cw_read_desc *desc, const cw_slice_source *source,
                               const cw_slice_visitor *visitor, cw_error *err)
{
    const bool is_needed =
        desc->ids->count > 0 || desc->ids->rounded > 0 || cwi_id_is_wide(source->shape.type);
    replaced_slices s = {.census.rounds = desc->round_labels};
    if (!is_needed)
        return visitor->visit(visitor->user, source, err);
    cw_slice_source replaced = {.shape = source->shape, .read = read_replaced, .user = &s};
    cw_volume *v = &replaced.shape;
    memset(v->stride, 0, sizeof v->stride);
    v->type = CW_U32;
    v->slope = 1;
    v->intercept = v->nodata = 0;
    v->has_nodata = false;
    cw_status st = open_slices(&s, source, err);
    if (st == CW_OK)
        st = cwi_id_places_fill(&s.places, desc->ids, err);
    if (st == CW_OK)
        st = visitor->visit(visitor->user, &replaced, err);
    cwi_key_counts_free(&s.places);
    cwi_free(s.slice);
    return st;
}

/* A census of slices. */
typedef struct slice_census {
    cwi_id_census census;
    bool is_done; /* the type needs none */
} slice_census;

static cw_status count_slices(void *user, const cw_slice_source *source, cw_error *err)
{
    slice_census *c = user;
    replaced_slices s = {.census = c->census};
    if (!cwi_id_may_replace(&source->shape)) {
        c->is_done = true;
        return CW_OK;
    }
    s.census.is_unsigned = is_unsigned(&source->shape);
    cw_status st = open_slices(&s, source, err);
    for (size_t k = 0; k < s.shape.dim[2] && st == CW_OK; k++)
        st = read_slice(&s, k, NULL, err);
    cwi_free(s.slice);
    c->census = s.census;
    return st;
}

cw_status cw_label_ids_read(const char *path, const cw_read_desc *desc, size_t step,
                            cw_label_ids *ids, cw_error *err)
{
    path = cwi_input_name(path, desc ? desc->stored : NULL);
    CWI_REQUIRE(err, path, ids);
    CWI_REQUIRE_VERSION(err, desc, 0);
    cw_read_desc d = desc ? *desc : (cw_read_desc){0};
    cw_label_ids none = {0};
    slice_census all = {.census.rounds = d.round_labels};
    const cw_slice_visitor visitor = {count_slices, &all};
    cw_volume shape = {0};
    cw_label_ids_free(ids);
    d.ids = &none;
    d.header_only = true;
    d.labels = NULL;
    d.note = NULL;
    cw_status st = cw_volume_read(path, &d, &shape, NULL, err);
    const size_t components = shape.components ? shape.components : 1;
    cw_volume_free(&shape);
    d.header_only = false;
    for (size_t c = 0; c < components && st == CW_OK && !all.is_done; c++)
        st = cwi_visit_stored(path, &d, c, step, &visitor, err);
    if (st == CW_OK && !all.is_done)
        st = cwi_id_list(&all.census, ids, err);
    cwi_key_counts_free(&all.census.places);
    return st;
}
