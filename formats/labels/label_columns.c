/* Reads tables of labels with a header of columns: the CSV of 3D Slicer and the TSV of BIDS. */
#include "core/base/status.h"
#include "core/volume/label_table.h"
#include "formats/labels/label_file.h"

#include <string.h>
#include <strings.h>

enum { MAX_COLUMNS = 256 };

typedef enum column {
    COLUMN_VALUE,
    COLUMN_NAME,
    COLUMN_RED,
    COLUMN_GREEN,
    COLUMN_BLUE,
    COLUMN_ALPHA,
    COLUMN_HEX,
    COLUMN_CATEGORY_SCHEME,
    COLUMN_CATEGORY_VALUE,
    COLUMN_CATEGORY_MEANING,
    COLUMN_TYPE_SCHEME,
    COLUMN_TYPE_VALUE,
    COLUMN_TYPE_MEANING,
    COLUMN_COUNT
} column;

/* A format of columns. */
typedef struct column_rules {
    char separator;
    bool has_quotes;
    const char *absent;              /* the text of a missing value, besides "" */
    const char *names[COLUMN_COUNT]; /* NULL: the format has no such column */
} column_rules;

/* The columns of 3D Slicer. Spreadsheets part them by semicolons where the comma is for decimals. */
#define CSV_NAMES                                                                              \
    {                                                                                          \
        [COLUMN_VALUE] = "LabelValue", [COLUMN_NAME] = "Name", [COLUMN_RED] = "Color_R",       \
        [COLUMN_GREEN] = "Color_G", [COLUMN_BLUE] = "Color_B", [COLUMN_ALPHA] = "Color_A",     \
        [COLUMN_CATEGORY_SCHEME] = "Category_CodingScheme",                                    \
        [COLUMN_CATEGORY_VALUE] = "Category_CodeValue",                                        \
        [COLUMN_CATEGORY_MEANING] = "Category_CodeMeaning",                                    \
        [COLUMN_TYPE_SCHEME] = "Type_CodingScheme", [COLUMN_TYPE_VALUE] = "Type_CodeValue",    \
        [COLUMN_TYPE_MEANING] = "Type_CodeMeaning"                                             \
    }
static const column_rules csv_rules = {',', true, "", CSV_NAMES};
static const column_rules semicolon_rules = {';', true, "", CSV_NAMES};

static const column_rules bids_rules = {
    '\t',
    false,
    "n/a",
    {[COLUMN_VALUE] = "index", [COLUMN_NAME] = "name", [COLUMN_HEX] = "color"}};

/* --- rows -------------------------------------------------------------------------------- */

/* Ends a text in quotes at the closing one, in place, where two quotes stand for one. Returns
 * the place behind it; NULL when it is missing. */
static char *close_quotes(char *text)
{
    char *to = text;
    for (char *s = text; *s; s++) {
        if (*s == '"' && s[1] != '"') {
            *to = '\0';
            return s + 1;
        }
        s += *s == '"';
        *to++ = *s;
    }
    return NULL;
}

/* Cuts blanks off both ends of a text. */
static char *trim_text(char *text, char *end)
{
    while (end > text && end[-1] == ' ')
        end--;
    *end = '\0';
    return text + strspn(text, " ");
}

/* Splits a line into its fields, in place; SIZE_MAX for quotes that do not end. Fields behind
 * the capacity are left out. */
static size_t split_fields(char *line, const column_rules *rules, char *fields[MAX_COLUMNS])
{
    const char separators[] = {rules->separator, '\0'};
    size_t count = 0;
    while (count < MAX_COLUMNS) {
        const bool is_quoted = rules->has_quotes && *line == '"';
        char *text = line + is_quoted, *end = is_quoted ? close_quotes(text) : line;
        if (!end)
            return SIZE_MAX;
        end += strcspn(end, separators);
        const bool is_last = *end == '\0';
        fields[count++] = is_quoted ? text : trim_text(text, end);
        if (is_last)
            break;
        line = end + 1;
    }
    return count;
}

/* The columns of a file. */
typedef struct column_header {
    const column_rules *rules;
    size_t count;
    int index[COLUMN_COUNT]; /* -1: the file has no such column */
} column_header;

static void find_columns(char *line, const column_rules *rules, column_header *header,
                         size_t *repeated)
{
    char *fields[MAX_COLUMNS];
    const size_t count = split_fields(line, rules, fields);
    *header = (column_header){.rules = rules, .count = count == SIZE_MAX ? 0 : count};
    *repeated = COLUMN_COUNT;
    for (size_t c = 0; c < COLUMN_COUNT; c++) {
        header->index[c] = -1;
        for (size_t n = 0; rules->names[c] && n < header->count; n++) {
            if (strcasecmp(fields[n], rules->names[c]) != 0)
                continue;
            if (header->index[c] >= 0)
                *repeated = c;
            header->index[c] = (int)n;
        }
    }
}

static cw_status check_header(const column_header *h, size_t repeated, size_t line,
                              cw_error *err)
{
    size_t missing = h->index[COLUMN_VALUE] < 0 ? COLUMN_VALUE : COLUMN_COUNT;
    const int colors = (h->index[COLUMN_RED] >= 0) + (h->index[COLUMN_GREEN] >= 0) +
                       (h->index[COLUMN_BLUE] >= 0);
    for (size_t c = COLUMN_RED; c <= COLUMN_BLUE && colors % 3; c++)
        if (h->index[c] < 0)
            missing = c;
    if (repeated < COLUMN_COUNT)
        return cwi_fail(err, CW_ERR_FORMAT, "line %zu: the column '%s' appears twice", line,
                        h->rules->names[repeated]);
    if (missing < COLUMN_COUNT)
        return cwi_fail(err, CW_ERR_FORMAT, "line %zu: the column '%s' is missing", line,
                        h->rules->names[missing]);
    return CW_OK;
}

/* Returns the field of a column; NULL where it is absent or empty. */
static char *find_field(const column_header *h, char *const *fields, size_t count, column c)
{
    char *text = h->index[c] >= 0 && (size_t)h->index[c] < count ? fields[h->index[c]] : NULL;
    return text && *text && strcasecmp(text, h->rules->absent) != 0 ? text : NULL;
}

static cw_status read_hex(const char *text, size_t line, cw_label *label, cw_error *err)
{
    const size_t digits = strspn(text + 1, "0123456789abcdefABCDEF");
    if (text[0] != '#' || text[1 + digits] || (digits != 6 && digits != 8))
        return cwi_fail(err, CW_ERR_FORMAT,
                        "line %zu: 'color' is '%.40s'; #RRGGBB was expected", line, text);
    label->color[3] = 255;
    for (size_t n = 0; n < digits; n++) {
        const char d = text[1 + n];
        const int value = d <= '9' ? d - '0' : (d | 0x20) - 'a' + 10;
        label->color[n / 2] = (uint8_t)(n % 2 ? label->color[n / 2] * 16 + value : value);
    }
    label->has_color = true;
    return CW_OK;
}

/* Reads red, green, blue, and the opacity where it is stated. A row may have no colour. */
static cw_status read_channels(const column_header *h, char *const *fields, size_t count,
                               size_t line, cw_label *label, cw_error *err)
{
    cw_status st = CW_OK;
    bool has_any = false;
    for (column c = COLUMN_RED; c <= COLUMN_BLUE; c++)
        has_any |= find_field(h, fields, count, c) != NULL;
    label->color[3] = 255;
    for (column c = COLUMN_RED; has_any && st == CW_OK && c <= COLUMN_ALPHA; c++) {
        const char *text = find_field(h, fields, count, c);
        uint32_t value = 255;
        if (text || c != COLUMN_ALPHA)
            st = cwi_label_whole(text ? text : "", 255, line, h->rules->names[c], &value, err);
        label->color[c - COLUMN_RED] = (uint8_t)value;
    }
    label->has_color = has_any;
    return st;
}

static cw_status read_row(const column_header *h, char *text, size_t line, cw_label *label,
                          cw_error *err)
{
    char *fields[MAX_COLUMNS];
    const size_t count = split_fields(text, h->rules, fields);
    if (count == SIZE_MAX)
        return cwi_fail(err, CW_ERR_FORMAT, "line %zu: a quote is not closed", line);
    for (size_t n = h->count; n < count; n++)
        if (*fields[n])
            return cwi_fail(err, CW_ERR_FORMAT,
                            "line %zu has %zu values; the header has %zu columns", line, count,
                            h->count);
    const char *value = find_field(h, fields, count, COLUMN_VALUE);
    const char *hex = find_field(h, fields, count, COLUMN_HEX);
    cw_status st = cwi_label_read_number(value ? value : "", line,
                                         h->rules->names[COLUMN_VALUE], label, err);
    if (st == CW_OK)
        st = hex ? read_hex(hex, line, label, err)
                 : read_channels(h, fields, count, line, label, err);
    label->name = find_field(h, fields, count, COLUMN_NAME);
    label->category = (cw_code){find_field(h, fields, count, COLUMN_CATEGORY_SCHEME),
                                find_field(h, fields, count, COLUMN_CATEGORY_VALUE),
                                find_field(h, fields, count, COLUMN_CATEGORY_MEANING)};
    label->type = (cw_code){find_field(h, fields, count, COLUMN_TYPE_SCHEME),
                            find_field(h, fields, count, COLUMN_TYPE_VALUE),
                            find_field(h, fields, count, COLUMN_TYPE_MEANING)};
    return st;
}

static cw_status read_rows(cwi_label_file *file, const column_rules *rules,
                           cw_label_table *table, cw_error *err)
{
    cwi_label_lines lines = {.next = file->text};
    column_header header;
    size_t repeated;
    char *line = cwi_label_line(&lines);
    find_columns(line, rules, &header, &repeated);
    cw_status st = check_header(&header, repeated, lines.number, err);
    while (st == CW_OK && (line = cwi_label_line(&lines))) {
        cw_label label = {0};
        st = read_row(&header, line, lines.number, &label, err);
        if (st == CW_OK)
            st = cwi_label_table_append(table, &label, err);
    }
    return st == CW_OK ? cwi_label_table_sort(table, false, err) : st;
}

/* --- formats ----------------------------------------------------------------------------- */

/* Returns true if the first line has a column of labels, and one that describes them. Names
 * with colours are enough: the reader then reports that the labels are missing. */
static bool has_columns(const cwi_label_file *file, const column_rules *rules)
{
    char line[CWI_LABEL_LINE_BYTES];
    column_header h;
    size_t repeated;
    memcpy(line, file->first, sizeof line);
    find_columns(line, rules, &h, &repeated);
    const bool has_name = h.index[COLUMN_NAME] >= 0;
    const bool has_color = h.index[COLUMN_HEX] >= 0 || h.index[COLUMN_RED] >= 0;
    return h.index[COLUMN_VALUE] >= 0 ? has_name || has_color
                                      : has_name && h.index[COLUMN_RED] >= 0;
}

static bool is_csv(const cwi_label_file *file)
{
    return has_columns(file, &csv_rules) || has_columns(file, &semicolon_rules);
}

static cw_status read_csv(cwi_label_file *file, cw_label_table *table, cw_error *err)
{
    const bool is_plain = has_columns(file, &csv_rules);
    return read_rows(file, is_plain ? &csv_rules : &semicolon_rules, table, err);
}

static bool is_bids(const cwi_label_file *file)
{
    return has_columns(file, &bids_rules);
}

static cw_status read_bids(cwi_label_file *file, cw_label_table *table, cw_error *err)
{
    return read_rows(file, &bids_rules, table, err);
}

const cwi_label_format cwi_label_csv = {"slicer-csv", ".csv", is_csv, read_csv};
const cwi_label_format cwi_label_bids = {"bids", ".tsv", is_bids, read_bids};
