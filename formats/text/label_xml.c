/* Reads XML tables of labels: <Label Key="5" Red="0.5" ...>liver</Label>, colours from 0 to 1. */
#include "formats/text/label_xml.h"

#include "core/base/status.h"
#include "core/base/text.h"
#include "core/volume/label_table.h"

#include <ctype.h>
#include <math.h>
#include <string.h>

enum { NAME_BYTES = 1024 };

/* A table under construction, and its current label. */
typedef struct label_document {
    const char *next; /* bytes that are not yet parsed */
    size_t left;
    cw_label_table *table;
    cw_label label;
    char name[NAME_BYTES]; /* longer names are cut */
    size_t length;
} label_document;

bool cwi_label_xml_sniff(const char *text)
{
    return text[strspn(text, " \t\r\n")] == '<' && strstr(text, "<LabelTable");
}

static cw_status read_key(const cwi_xml *x, const char *text, uint32_t *value, cw_error *err)
{
    const char *s = text ? text : "";
    int64_t number;
    if (!cwi_parse_int(&s, &number) || s[strspn(s, " \t")] || number < 0 || number > UINT32_MAX)
        return cwi_fail(err, CW_ERR_FORMAT,
                        "line %lu: 'Key' is '%.40s'; a whole number from 0 to 4294967295 was "
                        "expected",
                        cwi_xml_line(x), text ? text : "");
    *value = (uint32_t)number;
    return CW_OK;
}

/* Reads the four attributes of a colour. A missing Alpha means opaque; without one of the
 * others there is no colour. */
static cw_status read_color(const cwi_xml *x, cwi_attributes a, cw_label *label, cw_error *err)
{
    static const char *const names[] = {"Red", "Green", "Blue", "Alpha"};
    label->has_color = true;
    for (int c = 0; c < 4; c++) {
        const char *text = cwi_attribute(a, names[c]), *s = text;
        double value = 1;
        if (!text && c < 3)
            label->has_color = false;
        if (text && (!cwi_parse_double(&s, &value) || s[strspn(s, " \t")] ||
                     !(value >= 0 && value <= 1)))
            return cwi_fail(err, CW_ERR_FORMAT,
                            "line %lu: '%s' is '%.40s'; a number from 0 to 1 was expected",
                            cwi_xml_line(x), names[c], text);
        label->color[c] = (uint8_t)lround(255 * value);
    }
    return CW_OK;
}

cw_status cwi_label_xml_label(const cwi_xml *x, cwi_attributes a, cw_label *label,
                              cw_error *err)
{
    *label = (cw_label){0};
    cw_status st = read_key(x, cwi_attribute(a, "Key"), &label->value, err);
    return st == CW_OK ? read_color(x, a, label, err) : st;
}

static cw_status start_label(void *user, cwi_xml *x, cwi_attributes a, cw_error *err)
{
    label_document *d = user;
    d->length = 0;
    return cwi_label_xml_label(x, a, &d->label, err);
}

static cw_status end_label(void *user, cwi_xml *x, cw_error *err)
{
    label_document *d = user;
    char *name = d->name;
    (void)x;
    while (d->length > 0 && isspace((unsigned char)d->name[d->length - 1]))
        d->length--;
    d->name[d->length] = '\0';
    name += strspn(name, " \t\r\n");
    d->label.name = *name ? name : NULL;
    return cwi_label_table_append(d->table, &d->label, err);
}

/* Ends the reading: further tables are of other maps or arrays. */
static cw_status end_table(void *user, cwi_xml *x, cw_error *err)
{
    (void)user, (void)err;
    cwi_xml_stop(x);
    return CW_OK;
}

enum {
    TABLE,
    LABEL,
    CARET,
    CARET_VOLUME,
    CARET_TABLE,
    CARET_LABEL,
    GIFTI,
    GIFTI_TABLE,
    GIFTI_LABEL,
    ELEMENT_COUNT
};

static const cwi_xml_element elements[ELEMENT_COUNT] = {
    [TABLE] = {"LabelTable", CWI_XML_ROOT, NULL, end_table},
    [LABEL] = {"Label", TABLE, start_label, end_label},
    [CARET] = {"CaretExtension", CWI_XML_ROOT, NULL, NULL},
    [CARET_VOLUME] = {"VolumeInformation", CARET, NULL, NULL},
    [CARET_TABLE] = {"LabelTable", CARET_VOLUME, NULL, end_table},
    [CARET_LABEL] = {"Label", CARET_TABLE, start_label, end_label},
    [GIFTI] = {"GIFTI", CWI_XML_ROOT, NULL, NULL},
    [GIFTI_TABLE] = {"LabelTable", GIFTI, NULL, end_table},
    [GIFTI_LABEL] = {"Label", GIFTI_TABLE, start_label, end_label},
};

static cw_status add_text(void *user, int row, const char *text, size_t size, cw_error *err)
{
    label_document *d = user;
    (void)err;
    if (row != LABEL && row != CARET_LABEL && row != GIFTI_LABEL)
        return CW_OK;
    const size_t left = NAME_BYTES - 1 - d->length, kept = size < left ? size : left;
    memcpy(d->name + d->length, text, kept);
    d->length += kept;
    return CW_OK;
}

static cw_status read_bytes(void *from, void *to, size_t size, size_t *got, cw_error *err)
{
    label_document *d = from;
    (void)err;
    *got = size < d->left ? size : d->left;
    memcpy(to, d->next, *got);
    d->next += *got;
    d->left -= *got;
    return CW_OK;
}

cw_status cwi_label_xml_read(const char *bytes, size_t size, cw_label_table *table,
                             cw_error *err)
{
    static const cwi_xml_rules rules = {.elements = elements,
                                        .element_count = ELEMENT_COUNT,
                                        .doctype = "GIFTI",
                                        .text = add_text};
    label_document d = {.next = bytes, .left = size, .table = table};
    cw_status st = cwi_xml_read(&rules, &d, read_bytes, &d, err);
    return st == CW_OK ? cwi_label_table_sort(table, false, err) : st;
}
