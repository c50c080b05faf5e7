/* Reads the segments of 3D Slicer's .seg.nrrd files: keys such as Segment0_Name. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/base/text.h"
#include "core/volume/label_table.h"
#include "formats/nrrd/nrrd.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The keys that are read; others are ignored. */
enum { KEY_ID, KEY_NAME, KEY_COLOR, KEY_VALUE, KEY_LAYER, KEY_TAGS, KEY_COUNT };
static const char *const key_names[KEY_COUNT] = {"ID",         "Name",  "Color",
                                                 "LabelValue", "Layer", "Tags"};

/* A key of a segment: Segment<number>_<name>:=<value>. */
struct cwi_nrrd_segment_key {
    uint32_t number;
    int key;
    size_t line;
    char *value; /* in the lines of the header */
};

/* --- keys -------------------------------------------------------------------------------- */

/* Reads a whole number up to 4294967295 and moves *text behind it. */
static bool read_number(const char **text, uint32_t *number)
{
    int64_t value;
    if (**text < '0' || **text > '9' || !cwi_parse_int(text, &value) || value > UINT32_MAX)
        return false;
    *number = (uint32_t)value;
    return true;
}

static int find_key(const char *name, size_t length)
{
    for (int k = 0; k < KEY_COUNT; k++)
        if (strlen(key_names[k]) == length && memcmp(key_names[k], name, length) == 0)
            return k;
    return -1;
}

static cw_status add_key(cwi_nrrd *n, const cwi_nrrd_segment_key *key, cw_error *err)
{
    const size_t count = n->segment_key_count;
    if (!(count & (count - 1))) { /* capacities are powers of two */
        cwi_nrrd_segment_key *keys =
            cwi_realloc_array(n->segment_keys, count ? 2 * count : 1, sizeof *keys);
        if (!keys)
            return cwi_fail_memory(err);
        n->segment_keys = keys;
    }
    n->segment_keys[n->segment_key_count++] = *key;
    return CW_OK;
}

cw_status cwi_nrrd_keep_segment(cwi_nrrd *n, char *line, char *value, cw_error *err)
{
    static const char prefix[] = "Segment";
    const char *s = line + sizeof prefix - 1;
    cwi_nrrd_segment_key key = {.line = n->lines.number, .value = value};
    if (strncmp(line, prefix, sizeof prefix - 1) != 0 || *s < '0' || *s > '9')
        return CW_OK;
    n->has_segments = true;
    if (!n->wants_segments)
        return CW_OK;
    if (!read_number(&s, &key.number))
        return cwi_fail(err, CW_ERR_FORMAT,
                        "line %zu: '%.40s' has a number of a segment that is more than "
                        "4294967295",
                        n->lines.number, line);
    key.key = *s == '_' ? find_key(s + 1, strcspn(s + 1, ":")) : -1;
    return key.key < 0 ? CW_OK : add_key(n, &key, err);
}

static int compare_keys(const void *a, const void *b)
{
    const cwi_nrrd_segment_key *p = a, *q = b;
    return p->number != q->number ? (p->number > q->number) - (p->number < q->number)
                                  : (p->line > q->line) - (p->line < q->line);
}

/* --- values ------------------------------------------------------------------------------ */

/* Resolves the escapes of NRRD in place; a line feed becomes a blank. */
static void resolve_escapes(char *text)
{
    char *to = text;
    for (const char *s = text; *s; s++) {
        const bool is_escape = *s == '\\' && (s[1] == 'n' || s[1] == '\\');
        *to++ = is_escape && s[1] == 'n' ? ' ' : *s;
        s += is_escape;
    }
    *to = '\0';
}

static cw_status fail_value(const cwi_nrrd_segment_key *key, const char *expected,
                            cw_error *err)
{
    return cwi_fail(err, CW_ERR_FORMAT, "line %zu: 'Segment%u_%s' is '%.40s'; %s expected",
                    key->line, key->number, key_names[key->key], key->value, expected);
}

static cw_status read_whole(const cwi_nrrd_segment_key *key, uint32_t *value, cw_error *err)
{
    const char *s = key->value + strspn(key->value, " \t");
    if (read_number(&s, value) && !*s)
        return CW_OK;
    return fail_value(key, "a whole number from 0 to 4294967295 was", err);
}

static cw_status read_color(const cwi_nrrd_segment_key *key, cw_label *label, cw_error *err)
{
    const char *s = key->value;
    double value;
    for (int c = 0; c < 3; c++) {
        if (!cwi_parse_double(&s, &value) || !(value >= 0 && value <= 1))
            return fail_value(key, "three numbers from 0 to 1 were", err);
        label->color[c] = (uint8_t)lround(255 * value);
    }
    label->color[3] = 255;
    label->has_color = true;
    return s[strspn(s, " \t")] ? fail_value(key, "three numbers from 0 to 1 were", err) : CW_OK;
}

/* Cuts the text up to a separator off *text, which moves behind it. Returns NULL for an empty
 * one. */
static char *cut_field(char **text, char separator)
{
    char *field = *text, *end = strchr(field, separator);
    if (end)
        *end = '\0';
    *text = end ? end + 1 : field + strlen(field);
    return *field ? field : NULL;
}

/* Reads "scheme^value^meaning". */
static void read_code(char *text, cw_code *code)
{
    if (!text)
        return;
    code->scheme = cut_field(&text, '^');
    code->value = cut_field(&text, '^');
    code->meaning = cut_field(&text, '^');
}

/* Reads the codes from tags: "key:value|TerminologyEntry:context~category~type~...|". */
static void read_tags(char *text, cw_label *label)
{
    static const char entry[] = "TerminologyEntry:";
    while (*text) {
        char *tag = cut_field(&text, '|');
        if (!tag || strncmp(tag, entry, sizeof entry - 1) != 0)
            continue;
        tag += sizeof entry - 1;
        cut_field(&tag, '~'); /* the name of the list of terms */
        read_code(cut_field(&tag, '~'), &label->category);
        read_code(cut_field(&tag, '~'), &label->type);
        return;
    }
}

static cw_status read_key(const cwi_nrrd_segment_key *key, cw_label *label, bool *has_layer,
                          cw_error *err)
{
    switch (key->key) {
    case KEY_ID:
        if (!label->name && *key->value)
            label->name = key->value;
        return CW_OK;
    case KEY_NAME:
        resolve_escapes(key->value);
        if (*key->value)
            label->name = key->value;
        return CW_OK;
    case KEY_COLOR:
        return read_color(key, label, err);
    case KEY_VALUE:
        return read_whole(key, &label->value, err);
    case KEY_LAYER:
        *has_layer = true;
        return read_whole(key, &label->layer, err);
    default:
        resolve_escapes(key->value);
        read_tags(key->value, label);
        return CW_OK;
    }
}

/* --- segments ---------------------------------------------------------------------------- */

/* Reads the keys of one segment. Files of older versions have a layer for each segment, in which
 * its voxels are 1. */
static cw_status read_segment(const cwi_nrrd_segment_key *keys, size_t count, size_t layers,
                              cw_label *label, cw_error *err)
{
    bool has_layer = false;
    cw_status st = CW_OK;
    *label = (cw_label){.value = 1};
    for (size_t n = 0; n < count && st == CW_OK; n++)
        st = read_key(&keys[n], label, &has_layer, err);
    if (!has_layer && layers > 1)
        label->layer = keys->number;
    return st;
}

/* Returns true if the layers are steps: there are more than a voxel may have values. */
static bool has_layers_as_steps(const cwi_nrrd *n, const cw_volume *shape)
{
    for (size_t a = 0; a < n->dimension; a++)
        if (n->axis[a].kind == CWI_NRRD_KIND_LIST && n->axis[a].size == shape->steps)
            return shape->steps > 1;
    return false;
}

cw_status cwi_nrrd_read_segments(cwi_nrrd *n, cwi_source *src, cw_label_table *table,
                                 cw_error *err)
{
    const size_t count = n->segment_key_count, layers = src->shape.components;
    cw_status st = CW_OK;
    if (count == 0)
        return CW_OK;
    if (has_layers_as_steps(n, &src->shape)) {
        cwi_source_note(
            src,
            "left out: the names of segments; their voxels are in %zu layers, and 16 "
            "are read as layers",
            src->shape.steps);
        return CW_OK;
    }
    qsort(n->segment_keys, count, sizeof *n->segment_keys, compare_keys);
    for (size_t first = 0, end = 0; first < count && st == CW_OK; first = end) {
        const uint32_t number = n->segment_keys[first].number;
        cw_label label;
        while (end < count && n->segment_keys[end].number == number)
            end++;
        st = read_segment(n->segment_keys + first, end - first, layers, &label, err);
        if (st == CW_OK && label.layer >= layers)
            st = cwi_fail(err, CW_ERR_FORMAT,
                          "line %zu: segment %u is in layer %u; 'sizes' gives the voxels %zu",
                          n->segment_keys[first].line, number, label.layer, layers);
        if (st == CW_OK)
            st = cwi_label_table_append(table, &label, err);
    }
    return st == CW_OK ? cwi_label_table_sort(table, false, err) : st;
}
