/* Lists the numbers of labels that do not fit 32 bits, and replaces them by their places. */
#include "core/volume/label_ids.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/volume/label_table.h"
#include "core/volume/volume.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* --- places ------------------------------------------------------------------------------ */

/* Adds a number other than 0 at a place; one that is there keeps its own. */
static cw_status put_place(cwi_key_counts *t, int64_t id, uint32_t place, cw_error *err)
{
    if (t->used == UINT32_MAX - 2)
        return cwi_fail(err, CW_ERR_LIMIT, "it has more than %u labels", UINT32_MAX - 2);
    cwi_key_count *entry = cwi_key_counts_need(t, (uint64_t)id);
    if (!entry)
        return cwi_fail_memory(err);
    entry->count = entry->count ? entry->count : place;
    return CW_OK;
}

cw_status cwi_id_places_fill(cwi_key_counts *places, const cw_label_ids *ids, cw_error *err)
{
    cw_status st = CW_OK;
    for (size_t n = 1; n < ids->count && st == CW_OK; n++)
        st = put_place(places, ids->ids[n], (uint32_t)n, err);
    return st;
}

size_t cwi_id_replace(const cwi_key_counts *places, const int64_t *ids, size_t count,
                      uint32_t *to)
{
    int64_t last = 0;
    uint32_t place = 0;
    if (places->size == 0) {
        for (size_t n = 0; n < count; n++)
            to[n] = (uint32_t)ids[n];
        return count;
    }
    for (size_t n = 0; n < count; n++) {
        if (ids[n] != last) {
            last = ids[n];
            const cwi_key_count *entry =
                last ? cwi_key_counts_find(places, (uint64_t)last) : NULL;
            if (last && !entry)
                return n;
            place = entry ? (uint32_t)entry->count : 0;
        }
        to[n] = place;
    }
    return count;
}

/* --- voxels ------------------------------------------------------------------------------ */

static bool is_plain(const cw_volume *v)
{
    return (v->slope == 1 || v->slope == 0) && v->intercept == 0;
}

bool cwi_id_is_wide(cw_type type)
{
    return (int)type == CWI_I64 || (int)type == CWI_U64;
}

bool cwi_id_may_replace(const cw_volume *volume)
{
    const bool has_sign =
        volume->type == CW_I8 || volume->type == CW_I16 || volume->type == CW_I32;
    const bool is_real = volume->type == CW_F32 || volume->type == CW_F64;
    return has_sign || is_real || cwi_id_is_wide(volume->type) || !is_plain(volume);
}

/* Copies integers of 64 bits. */
static size_t load_wide(const char *from, ptrdiff_t stride, size_t count, int64_t *to)
{
    if (stride == (ptrdiff_t)sizeof *to)
        memcpy(to, from, count * sizeof *to);
    else
        for (size_t n = 0; n < count; n++)
            memcpy(&to[n], from + (ptrdiff_t)n * stride, sizeof *to);
    return count;
}

/* Returns the stored number at an address; of integers of 64 bits those up to 2^53 are exact. */
static double stored_at(const cw_volume *v, const char *from)
{
    int64_t wide;
    if (!cwi_id_is_wide(v->type))
        return cwi_voxel_at(v->type, from);
    memcpy(&wide, from, sizeof wide);
    return (int)v->type == CWI_U64 ? (double)(uint64_t)wide : (double)wide;
}

size_t cwi_id_load(const cw_volume *volume, const char *from, ptrdiff_t stride, size_t count,
                   cwi_id_census *census, int64_t *to)
{
    const double slope = volume->slope != 0 ? volume->slope : 1, limit = 0x1p53;
    if (cwi_id_is_wide(volume->type) && is_plain(volume) && !volume->has_nodata)
        return load_wide(from, stride, count, to);
    for (size_t n = 0; n < count; n++, from += stride) {
        const double stored = stored_at(volume, from);
        const double value = slope * stored + volume->intercept;
        double whole = cwi_whole_value(value);
        to[n] = 0;
        if ((volume->has_nodata && stored == volume->nodata) || isnan(value))
            continue;
        if (census->rounds && whole != floor(whole)) {
            whole = rint(value);
            census->rounded++;
            census->largest_rounding = fmax(census->largest_rounding, fabs(whole - value));
        }
        if (!(fabs(whole) <= limit) || whole != floor(whole))
            return n;
        to[n] = (int64_t)whole;
    }
    return count;
}

cw_status cwi_id_add(cwi_id_census *census, const int64_t *ids, size_t count, cw_error *err)
{
    int64_t last = 0;
    cw_status st = CW_OK;
    for (size_t n = 0; n < count && st == CW_OK; n++) {
        if (ids[n] == last)
            continue;
        last = ids[n];
        census->has_outside = census->has_outside || last < 0 || last > (int64_t)UINT32_MAX;
        if (last)
            st = put_place(&census->places, last, 1, err);
    }
    return st;
}

/* --- the list ---------------------------------------------------------------------------- */

static int compare_signed(const void *a, const void *b)
{
    const int64_t x = *(const int64_t *)a, y = *(const int64_t *)b;
    return (x > y) - (x < y);
}

static int compare_unsigned(const void *a, const void *b)
{
    const uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return (x > y) - (x < y);
}

cw_status cwi_id_list(cwi_id_census *census, cw_label_ids *ids, cw_error *err)
{
    cwi_key_counts *t = &census->places;
    ids->rounded = census->rounded;
    ids->largest_rounding = census->largest_rounding;
    ids->is_unsigned = census->is_unsigned;
    if (!census->has_outside) {
        cwi_key_counts_free(t);
        return CW_OK;
    }
    int64_t *all = cwi_alloc_array(t->used + 1, sizeof *all);
    if (!all)
        return cwi_fail_memory(err);
    size_t count = 0;
    all[count++] = 0;
    for (size_t n = 0; n < t->size; n++)
        if (t->entries[n].key)
            all[count++] = (int64_t)t->entries[n].key;
    qsort(all + 1, count - 1, sizeof *all,
          census->is_unsigned ? compare_unsigned : compare_signed);
    ids->ids = all;
    ids->count = count;
    for (size_t n = 1; n < count; n++)
        cwi_key_counts_need(t, (uint64_t)all[n])->count = n;
    return CW_OK;
}

void cw_label_ids_free(cw_label_ids *ids)
{
    if (!ids)
        return;
    cwi_free((void *)ids->ids);
    *ids = (cw_label_ids){0};
}

cw_status cw_labels_renumber(const int64_t *values, bool is_unsigned, size_t count,
                             uint32_t *numbers, cw_label_ids *ids, cw_error *err)
{
    CWI_REQUIRE(err, ids);
    cw_label_ids_free(ids);
    if (count == 0)
        return CW_OK;
    CWI_REQUIRE(err, values, numbers);
    cwi_id_census census = {.is_unsigned = is_unsigned};
    cw_status st = cwi_id_add(&census, values, count, err);
    if (st == CW_OK)
        st = cwi_id_list(&census, ids, err);
    if (st == CW_OK)
        cwi_id_replace(&census.places, values, count, numbers);
    cwi_key_counts_free(&census.places);
    return st;
}

/* --- labels ------------------------------------------------------------------------------ */

const char *cw_label_number(const cw_label *label, char text[CW_LABEL_NUMBER])
{
    if (!text)
        return NULL;
    if (!label)
        *text = '\0';
    else if (label->id)
        snprintf(text, CW_LABEL_NUMBER, "%s%llu", label->is_negative ? "-" : "",
                 (unsigned long long)label->id);
    else
        snprintf(text, CW_LABEL_NUMBER, "%u", label->value);
    return text;
}

bool cw_label_parse(const char *text, cw_label *label)
{
    if (!text || !label)
        return false;
    const bool is_negative = *text == '-';
    const char *digit = text + (*text == '-' || *text == '+');
    uint64_t size = 0;
    if (!*digit)
        return false;
    for (; *digit; digit++) {
        if (*digit < '0' || *digit > '9' || __builtin_mul_overflow(size, (uint64_t)10, &size) ||
            __builtin_add_overflow(size, (uint64_t)(*digit - '0'), &size))
            return false;
    }
    if (is_negative && size > (uint64_t)1 << 63)
        return false;
    const bool fits = size <= UINT32_MAX && (!is_negative || size == 0);
    label->value = fits ? (uint32_t)size : 0;
    label->id = fits ? 0 : size;
    label->is_negative = !fits && is_negative;
    return true;
}

/* Returns the number of a label as bits of the list; false: it cannot be in it. */
static bool find_bits(const cw_label_ids *ids, const cw_label *label, int64_t *bits)
{
    const uint64_t size = cwi_label_size(label);
    *bits = label->is_negative ? (int64_t)(0 - size) : (int64_t)size;
    return ids->is_unsigned ? !label->is_negative
                            : label->is_negative || size <= (uint64_t)INT64_MAX;
}

uint32_t cw_label_ids_find(const cw_label_ids *ids, const cw_label *label)
{
    int64_t bits;
    if (!ids || !label)
        return UINT32_MAX;
    size_t low = 1, high = ids->count;
    if (!ids->count)
        return label->id ? UINT32_MAX : label->value;
    if (!find_bits(ids, label, &bits))
        return UINT32_MAX;
    if (bits == 0)
        return 0;
    while (low < high) {
        const size_t middle = low + (high - low) / 2;
        const int order = ids->is_unsigned ? compare_unsigned(&ids->ids[middle], &bits)
                                           : compare_signed(&ids->ids[middle], &bits);
        if (order < 0)
            low = middle + 1;
        else
            high = middle;
    }
    return low < ids->count && ids->ids[low] == bits ? (uint32_t)low : UINT32_MAX;
}

cw_label cw_label_ids_label(const cw_label_ids *ids, uint32_t value)
{
    cw_label label = {.value = value};
    if (!ids || value >= ids->count)
        return label;
    label.is_negative = !ids->is_unsigned && ids->ids[value] < 0;
    label.id = label.is_negative ? 0 - (uint64_t)ids->ids[value] : (uint64_t)ids->ids[value];
    return label;
}

/* Adds the labels of the list that the table does not have. */
static cw_status add_rest(cw_label_table *table, const cw_label_ids *ids, const bool *known,
                          cw_error *err)
{
    cw_status st = CW_OK;
    for (size_t n = 1; n < ids->count && st == CW_OK; n++) {
        const cw_label label = cw_label_ids_label(ids, (uint32_t)n);
        if (!known[n])
            st = cwi_label_table_append(table, &label, err);
    }
    return st;
}

static cw_status renumber_labels(const cw_label_table *from, const cw_label_ids *ids,
                                 bool *known, cw_label_table *to, cw_error *err)
{
    size_t beyond = ids->count;
    cw_status st = CW_OK;
    for (size_t n = 0; n < from->count && st == CW_OK; n++) {
        cw_label label = from->labels[n];
        const uint32_t place = cw_label_ids_find(ids, &label);
        label.id = cwi_label_size(&label);
        if (place == UINT32_MAX && beyond == UINT32_MAX - 1)
            continue;
        label.value = place != UINT32_MAX ? place : (uint32_t)beyond++;
        if (place != UINT32_MAX && label.layer == 0)
            known[place] = true;
        st = cwi_label_table_append(to, &label, err);
    }
    return st == CW_OK ? add_rest(to, ids, known, err) : st;
}

cw_status cw_label_table_renumber(cw_label_table *table, const cw_label_ids *ids, cw_error *err)
{
    CWI_REQUIRE(err, table, ids);
    cw_label_table to = {0};
    if (!ids->count)
        return CW_OK;
    bool *known = cwi_alloc_zeroed(ids->count, sizeof *known);
    if (!known)
        return cwi_fail_memory(err);
    cw_status st = renumber_labels(table, ids, known, &to, err);
    if (st == CW_OK)
        st = cwi_label_table_sort(&to, false, err);
    cwi_free(known);
    cw_label_table_free(st == CW_OK ? table : &to);
    if (st == CW_OK)
        *table = to;
    return st;
}
