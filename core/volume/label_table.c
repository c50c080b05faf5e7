/* Tables of the names and colours of labels. */
#include "core/volume/label_table.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/base/text.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

/* Compares two labels by layer, by value, and by what goes beyond values. */
static int compare_labels(const cw_label *a, const cw_label *b)
{
    if (a->layer != b->layer)
        return a->layer < b->layer ? -1 : 1;
    if (a->value != b->value)
        return a->value < b->value ? -1 : 1;
    if (a->is_negative != b->is_negative)
        return a->is_negative ? -1 : 1;
    return (a->id > b->id) - (a->id < b->id);
}

/* Returns the place of the first label that is not below another. */
static size_t find_place(const cw_label_table *table, const cw_label *label)
{
    size_t low = 0, high = table->count;
    while (low < high) {
        const size_t middle = low + (high - low) / 2;
        if (compare_labels(&table->labels[middle], label) < 0)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

const cw_label *cw_label_find(const cw_label_table *table, uint32_t layer, uint32_t value)
{
    const cw_label first = {.value = value, .layer = layer, .is_negative = true};
    if (!table)
        return NULL;
    const size_t at = find_place(table, &first);
    if (at == table->count)
        return NULL;
    const cw_label *label = &table->labels[at];
    return label->layer == layer && label->value == value ? label : NULL;
}

const cw_label *cw_label_find_name(const cw_label_table *table, const char *name)
{
    if (!table || !name)
        return NULL;
    const cw_label *found = NULL;
    for (size_t n = 0; n < table->count; n++) {
        const cw_label *label = &table->labels[n];
        if (!label->name || strcasecmp(label->name, name) != 0)
            continue;
        if (found)
            return NULL;
        found = label;
    }
    return found;
}

/* Copies a text and replaces bytes that are not printable UTF-8. Returns false when memory is
 * out. */
static bool copy_text(const char *from, char **to)
{
    *to = NULL;
    if (!from)
        return true;
    const size_t size = strlen(from) + 1;
    char *text = cwi_alloc_array(size, 1);
    if (!text)
        return false;
    memcpy(text, from, size);
    for (size_t n = 0; text[n];) {
        const size_t length = cwi_utf8_length(text + n);
        const unsigned char first = (unsigned char)text[n];
        if (length == 0 || first < 0x20 || first == 0x7f)
            text[n++] = '_';
        else
            n += length;
    }
    *to = text;
    return true;
}

static bool copy_code(const cw_code *from, cw_code *to)
{
    const bool has_scheme = copy_text(from->scheme, &to->scheme);
    const bool has_value = copy_text(from->value, &to->value);
    return copy_text(from->meaning, &to->meaning) && has_scheme && has_value;
}

static void free_code(cw_code *code)
{
    cwi_free(code->scheme);
    cwi_free(code->value);
    cwi_free(code->meaning);
}

static void free_label(cw_label *label)
{
    cwi_free(label->name);
    free_code(&label->category);
    free_code(&label->type);
}

/* Makes room for one more label: capacities are powers of two. */
static bool grow_table(cw_label_table *table)
{
    const size_t count = table->count;
    if (count & (count - 1))
        return true;
    cw_label *labels =
        cwi_realloc_array(table->labels, count ? 2 * count : 1, sizeof *table->labels);
    if (labels)
        table->labels = labels;
    return labels != NULL;
}

/* Copies a label with its texts; it takes a place of its own unless it replaces another. */
static cw_status copy_label(cw_label_table *table, const cw_label *label, bool replaces,
                            cw_label *copy, cw_error *err)
{
    *copy = *label;
    const bool has_name = copy_text(label->name, &copy->name);
    const bool has_category = copy_code(&label->category, &copy->category);
    const bool has_type = copy_code(&label->type, &copy->type);
    if (has_name && has_category && has_type && (replaces || grow_table(table)))
        return CW_OK;
    free_label(copy);
    return cwi_fail_memory(err);
}

cw_status cw_label_table_add(cw_label_table *table, const cw_label *label, cw_error *err)
{
    CWI_REQUIRE(err, table, label);
    cw_label copy;
    const size_t at = find_place(table, label);
    const bool replaces = at < table->count && compare_labels(&table->labels[at], label) == 0;
    cw_status st = copy_label(table, label, replaces, &copy, err);
    if (st != CW_OK)
        return st;
    if (replaces) {
        free_label(&table->labels[at]);
    } else {
        memmove(table->labels + at + 1, table->labels + at,
                (table->count - at) * sizeof *table->labels);
        table->count++;
    }
    table->labels[at] = copy;
    return CW_OK;
}

cw_status cwi_label_table_append(cw_label_table *table, const cw_label *label, cw_error *err)
{
    cw_label copy;
    cw_status st = copy_label(table, label, false, &copy, err);
    if (st == CW_OK)
        table->labels[table->count++] = copy;
    return st;
}

/* A label, and its index before sorting. */
typedef struct label_key {
    const cw_label *label;
    size_t index;
} label_key;

static int compare_keys(const void *a, const void *b)
{
    const label_key *p = a, *q = b;
    const int order = compare_labels(p->label, q->label);
    return order ? order : (p->index > q->index) - (p->index < q->index);
}

static bool is_rising(const cw_label_table *table)
{
    for (size_t n = 1; n < table->count; n++)
        if (compare_labels(&table->labels[n - 1], &table->labels[n]) >= 0)
            return false;
    return true;
}

static const cw_label *find_repeat(const cw_label_table *table, const label_key *keys)
{
    for (size_t n = 1; n < table->count; n++)
        if (compare_labels(keys[n].label, keys[n - 1].label) == 0)
            return &table->labels[keys[n].index];
    return NULL;
}

/* Moves the labels to a new array in the order of their keys, and frees those that a later
 * one replaces. */
static void move_labels(cw_label_table *table, const label_key *keys, cw_label *to)
{
    size_t count = 0;
    for (size_t n = 0; n < table->count; n++) {
        if (n > 0 && compare_labels(keys[n].label, keys[n - 1].label) == 0)
            free_label(&to[--count]);
        to[count++] = table->labels[keys[n].index];
    }
    cwi_free(table->labels);
    *table = (cw_label_table){count, to};
}

cw_status cwi_label_table_sort(cw_label_table *table, bool refuse_repeats, cw_error *err)
{
    size_t capacity = 1;
    if (is_rising(table))
        return CW_OK;
    while (capacity < table->count)
        capacity *= 2;
    label_key *keys = cwi_alloc_array(table->count, sizeof *keys);
    cw_label *labels = cwi_alloc_array(capacity, sizeof *labels);
    cw_status st = keys && labels ? CW_OK : cwi_fail_memory(err);
    for (size_t n = 0; st == CW_OK && n < table->count; n++)
        keys[n] = (label_key){&table->labels[n], n};
    if (st == CW_OK)
        qsort(keys, table->count, sizeof *keys, compare_keys);
    const cw_label *repeat = st == CW_OK && refuse_repeats ? find_repeat(table, keys) : NULL;
    if (repeat)
        st = cwi_fail(err, CW_ERR_FORMAT, "label %s is described twice",
                      cw_label_number(repeat, (char[CW_LABEL_NUMBER]){0}));
    if (st == CW_OK)
        move_labels(table, keys, labels);
    else
        cwi_free(labels);
    cwi_free(keys);
    return st;
}

void cw_label_table_free(cw_label_table *table)
{
    if (!table)
        return;
    for (size_t n = 0; n < table->count; n++)
        free_label(&table->labels[n]);
    cwi_free(table->labels);
    *table = (cw_label_table){0};
}

void cw_label_color(uint32_t value, uint8_t color[4])
{
    /* hues by the golden ratio: each falls into the largest gap that those before leave */
    static const double GOLDEN_RATIO = 0.61803398874989485;
    static const double brightness[] = {0.95, 0.75, 0.85}, saturation[] = {0.75, 0.55};
    const double hue = 6 * fmod(GOLDEN_RATIO * value, 1), v = brightness[value % 3];
    const double s = saturation[value % 2];
    for (int c = 0; c < 3; c++) {
        const double k = fmod((c == 0 ? 5 : c == 1 ? 3 : 1) + hue, 6);
        const double ramp = fmin(fmin(k, 4 - k), 1);
        color[c] = (uint8_t)lround(255 * v * (1 - s * fmax(ramp, 0)));
    }
    color[3] = 255;
}

void cwi_label_color(const cw_label *label, uint8_t color[4])
{
    if (label->has_color)
        memmove(color, label->color, sizeof label->color);
    else
        cw_label_color(label->value, color);
}
