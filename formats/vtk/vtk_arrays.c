/* Finds the arrays of a legacy VTK file, each behind a line that describes it. The numbers of
 * an array are skipped to find the next one: bytes by their count, text number by number. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "formats/volume/named_arrays.h"
#include "formats/vtk/vtk.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MAX_LINES = 10000, MAX_COMPONENTS = 1 << 16 };

/* The types, with the bits of a number in binary files, where those are the same everywhere.
 * `type` is -1 for types that are not read. */
typedef struct vtk_type {
    const char *names;
    int type;
    size_t bits;
    cwi_stored stored;
} vtk_type;

static const vtk_type types[] = {
    {"unsigned_char", CW_U8, 8, 0},
    {"char|signed_char", CW_I8, 8, 0},
    {"unsigned_short", CW_U16, 16, 0},
    {"short", CW_I16, 16, 0},
    {"unsigned_int", CW_U32, 32, 0},
    {"int|vtkidtype", CW_I32, 32, 0},
    {"float", CW_F32, 32, 0},
    {"double", CW_F64, 64, 0},
    {"bit", -1, 1, 0},
    {"long|vtktypeint64", CW_I32, 64, CWI_STORED_I64},
    {"unsigned_long|vtktypeuint64", CW_U32, 64, CWI_STORED_U64},
};

/* The lines of attributes: the keyword, the words behind the name (c: count of components,
 * t: type, C: an optional count), and the components where no word states them. */
static const struct {
    const char *names, *words;
    size_t components;
    cwi_vtk_rank rank;
} attributes[] = {
    {"scalars", "tC", 1, CWI_VTK_SCALARS},
    {"color_scalars", "c", 0, CWI_VTK_ONE},
    {"vectors|normals", "t", 3, CWI_VTK_ONE},
    {"texture_coordinates", "ct", 0, CWI_VTK_ONE},
    {"tensors", "t", 9, CWI_VTK_ONE},
    {"tensors6", "t", 6, CWI_VTK_ONE},
    {"global_ids|pedigree_ids|edge_flags", "t", 1, CWI_VTK_ONE},
};
enum { ATTRIBUTE_COUNT = sizeof attributes / sizeof *attributes };

/* --- lines ------------------------------------------------------------------------------- */

cw_status cwi_vtk_line(cwi_vtk *v, bool *more, cw_error *err)
{
    size_t got;
    cw_status st = cwi_input_read_at(v->in->fd, v->offset, v->line, sizeof v->line, &got, err);
    if (st != CW_OK)
        return st;
    const char *end = memchr(v->line, '\n', got);
    size_t length = end ? (size_t)(end - v->line) : got;
    *more = got > 0;
    v->number++;
    if (length == sizeof v->line)
        return cwi_fail(err, CW_ERR_FORMAT, "line %zu is longer than %d bytes", v->number,
                        CWI_VTK_LINE_BYTES - 1);
    if (v->number > MAX_LINES)
        return cwi_fail(err, CW_ERR_FORMAT, "the file has more than %d lines beside its arrays",
                        MAX_LINES);
    if (memchr(v->line, '\0', length))
        return cwi_fail(err, CW_ERR_FORMAT, "line %zu holds a zero byte; it must be text",
                        v->number);
    v->offset += length + (end ? 1 : 0);
    while (length > 0 && isspace((unsigned char)v->line[length - 1]))
        length--;
    v->line[length] = '\0';
    return CW_OK;
}

cw_status cwi_vtk_full_line(cwi_vtk *v, bool *more, cw_error *err)
{
    cw_status st;
    do
        st = cwi_vtk_line(v, more, err);
    while (st == CW_OK && *more && !*v->line);
    return st;
}

const char *cwi_vtk_value(const cwi_vtk *v)
{
    const char *behind = v->line + strcspn(v->line, " \t");
    return behind + strspn(behind, " \t");
}

static bool is_keyword(const char *line, const char *names)
{
    return cwi_field_find(&names, 1, line, strcspn(line, " \t")) == 0;
}

/* Skips lines up to an empty one: metadata of the array before them, which are not needed. */
static cw_status skip_metadata(cwi_vtk *v, cw_error *err)
{
    bool more;
    cw_status st;
    do
        st = cwi_vtk_line(v, &more, err);
    while (st == CW_OK && more && *v->line);
    return st;
}

/* --- skipping of numbers ----------------------------------------------------------------- */

static cw_status skip_bytes(cwi_vtk *v, const char *name, size_t count, size_t bits,
                            cw_error *err)
{
    const uint64_t there = v->in->size > v->offset ? v->in->size - v->offset : 0;
    size_t bytes;
    if (cwi_size_mul(count, bits, &bytes) && (bytes = bytes / 8 + (bytes % 8 != 0)) <= there) {
        v->offset += bytes;
        return CW_OK;
    }
    return cwi_fail(err, CW_ERR_FORMAT,
                    "the array '%s' has %zu numbers of %zu bits; the file holds %llu bytes",
                    name, count, bits, (unsigned long long)there);
}

static cw_status skip_text(cwi_vtk *v, const char *name, size_t count, cw_error *err)
{
    char text[4096];
    size_t seen = 0, got = 0, i = 0;
    bool inside = false;
    while (seen < count) {
        cw_status st = cwi_input_read_at(v->in->fd, v->offset, text, sizeof text, &got, err);
        if (st != CW_OK)
            return st;
        for (i = 0; i < got && seen < count; i++) {
            const bool blank = isspace((unsigned char)text[i]);
            seen += inside && blank;
            inside = !blank;
        }
        v->offset += i;
        if (got == 0)
            break;
    }
    seen += seen < count && inside;
    if (seen == count)
        return CW_OK;
    return cwi_fail(err, CW_ERR_FORMAT,
                    "the array '%s' has %zu numbers; the file ends after %zu", name, count,
                    seen);
}

/* --- arrays ------------------------------------------------------------------------------ */

static const vtk_type *find_type(const char *name)
{
    for (size_t i = 0; i < sizeof types / sizeof *types; i++)
        if (cwi_field_find(&types[i].names, 1, name, strlen(name)) == 0)
            return &types[i];
    return NULL;
}

static void note_other(cwi_vtk *v, const char *name, const char *type)
{
    const size_t used = strlen(v->others);
    snprintf(v->others + used, sizeof v->others - used, "%s'%s' (%s)", used ? ", " : "", name,
             type);
}

static cwi_vtk_rank rank_of(const cwi_vtk *v, const cwi_legacy_array *declared,
                            const vtk_type *type)
{
    if (type->type < 0 || declared->components < 1 || declared->components > 16)
        return CWI_VTK_NONE;
    if (v->expected)
        return strcmp(declared->name, v->expected) == 0 ? CWI_VTK_REQUESTED : CWI_VTK_NONE;
    if (strcmp(declared->name, "vtkGhostType") == 0)
        return CWI_VTK_NONE;
    if (declared->rank == CWI_VTK_SCALARS)
        return CWI_VTK_SCALARS;
    return type->stored                ? CWI_VTK_WIDE
           : declared->components == 1 ? declared->rank
                                       : CWI_VTK_SEVERAL;
}

/* Keeps an array that starts here when it is better than those before. */
static void consider_array(cwi_vtk *v, const cwi_legacy_array *declared, const vtk_type *type,
                           const char *type_name)
{
    const cwi_vtk_rank rank = rank_of(v, declared, type);
    if (strcmp(declared->name, "vtkGhostType") != 0)
        cwi_array_list_add(v->in->arrays, declared->name, type_name, declared->components,
                           v->best == &v->cells,
                           type->type >= 0 && declared->components >= 1 &&
                               declared->components <= 16);
    if (rank == CWI_VTK_NONE)
        note_other(v, declared->name, type_name);
    if (rank <= v->best->rank)
        return;
    *v->best = *declared;
    v->best->type = (cw_type)type->type;
    v->best->stored = type->stored;
    v->best->rank = rank;
    v->best->offset = v->offset;
}

static cw_status pass_numbers(cwi_vtk *v, const char *name, size_t count, size_t bits,
                              cw_error *err)
{
    return v->binary ? skip_bytes(v, name, count, bits, err) : skip_text(v, name, count, err);
}

/* Keeps marks, which tell the hidden points or cells. */
static void keep_marks(cwi_vtk *v, const cwi_legacy_array *declared, const vtk_type *type)
{
    if (strcmp(declared->name, "vtkGhostType") == 0 && declared->components == 1 &&
        type->type >= 0 && !type->stored)
        v->grid.marks[v->best == &v->cells] =
            (cwi_vtk_row){.type = (cw_type)type->type, .count = v->count, .offset = v->offset};
}

/* Handles an array that starts here: keeps it if it is better, and skips it if reading goes
 * on. */
static cw_status pass_array(cwi_vtk *v, const cwi_legacy_array *declared, const char *type_name,
                            size_t tuples, cw_error *err)
{
    const vtk_type *type = find_type(type_name);
    size_t count;
    if (!type)
        return cwi_fail(err, CW_ERR_FORMAT,
                        "the array '%s' is of type '%s', which is not known", declared->name,
                        type_name);
    if (v->best && tuples == v->count) {
        keep_marks(v, declared, type);
        consider_array(v, declared, type, type_name);
    }
    if (cwi_vtk_is_settled(v))
        return CW_OK;
    if (!cwi_size_mul(tuples, declared->components, &count))
        return cwi_fail(err, CW_ERR_LIMIT, "the array '%s' is larger than an address space",
                        declared->name);
    return pass_numbers(v, declared->name, count, type->bits, err);
}

cw_status cwi_vtk_fail_cut_short(const cwi_vtk *v, cw_error *err)
{
    return cwi_fail(err, CW_ERR_FORMAT, "line %zu, '%.60s', is cut short", v->number, v->line);
}

cw_status cwi_vtk_row_pass(cwi_vtk *v, const char *field, const char *type_name, size_t skipped,
                           size_t count, cwi_vtk_row *row, cw_error *err)
{
    const vtk_type *type = find_type(type_name);
    if (!type || type->bits == 1)
        return cwi_fail(err, CW_ERR_FORMAT,
                        "'%s' is of type '%s'; whole or real numbers were expected", field,
                        type_name);
    cw_status st = pass_numbers(v, field, skipped, type->bits, err);
    row->wide = type->stored && v->binary; /* in text they are ordinary numbers */
    row->type = !type->stored ? (cw_type)type->type : v->binary ? CW_U32 : CW_F64;
    row->count = count;
    row->offset = v->offset;
    return st == CW_OK ? pass_numbers(v, field, count, type->bits, err) : st;
}

cw_status cwi_vtk_coordinates(cwi_vtk *v, int axis, cw_error *err)
{
    char field[] = "X_COORDINATES", word[CWI_WORD_BYTES], type_name[CWI_WORD_BYTES];
    const char *text = cwi_vtk_value(v);
    int64_t count;
    field[0] = "XYZ"[axis];
    if (!cwi_next_text_word(&text, word) || !cwi_next_text_word(&text, type_name))
        return cwi_vtk_fail_cut_short(v, err);
    cw_status st = cwi_field_integer(field, word, 1, INT32_MAX, &count, err);
    if (st != CW_OK)
        return st;
    const vtk_type *type = find_type(type_name);
    if (!type || type->type < 0 || type->stored)
        return cwi_fail(err, CW_ERR_FORMAT,
                        "'%s' is of type '%s'; numbers of up to 32 bits, or double, were "
                        "expected",
                        field, type_name);
    return cwi_vtk_row_pass(v, field, type_name, 0, (size_t)count, &v->coordinates[axis], err);
}

/* Decodes a byte such as "%20"; returns 0 if there is none. */
static char decode_name(const char *s)
{
    if (s[0] != '%' || !isxdigit((unsigned char)s[1]) || !isxdigit((unsigned char)s[2]))
        return 0;
    return (char)strtol((const char[]){s[1], s[2], '\0'}, NULL, 16);
}

/* Reads a name, in which blanks and other characters are written as %20 and so on. */
static bool next_name(const char **text, char name[CWI_WORD_BYTES])
{
    char word[CWI_WORD_BYTES];
    if (!cwi_next_text_word(text, word))
        return false;
    for (const char *s = word; *s; s += decode_name(s) ? 3 : 1)
        *name++ = decode_name(s) ? decode_name(s) : *s;
    *name = '\0';
    return true;
}

/* Skips "LOOKUP_TABLE name" behind SCALARS, which some writers leave out. */
static cw_status skip_lookup_name(cwi_vtk *v, cw_error *err)
{
    char kept[CWI_VTK_LINE_BYTES];
    const uint64_t offset = v->offset;
    size_t got;
    bool more;
    memcpy(kept, v->line, sizeof kept);
    cw_status st = cwi_input_read_at(v->in->fd, offset, v->line, 13, &got, err);
    v->line[st == CW_OK ? got : 0] = '\0';
    if (st == CW_OK && is_keyword(v->line, "lookup_table"))
        st = cwi_vtk_line(v, &more, err);
    memcpy(v->line, kept, sizeof kept);
    return st;
}

static cw_status read_attribute(cwi_vtk *v, int row, cw_error *err)
{
    cwi_legacy_array array = {.components = attributes[row].components,
                              .rank = attributes[row].rank};
    char type[CWI_WORD_BYTES] = "", word[CWI_WORD_BYTES];
    const char *text = cwi_vtk_value(v);
    int64_t components = (int64_t)array.components;
    cw_status st = CW_OK;
    bool whole = next_name(&text, array.name);
    for (const char *w = attributes[row].words; whole && st == CW_OK && *w; w++) {
        whole = cwi_next_text_word(&text, *w == 't' ? type : word);
        if (whole && *w != 't')
            st = cwi_field_integer(array.name, word, 1, MAX_COMPONENTS, &components, err);
        whole |= *w == 'C';
    }
    if (st == CW_OK && !whole)
        return cwi_vtk_fail_cut_short(v, err);
    if (st == CW_OK && row == 0)
        st = skip_lookup_name(v, err);
    if (st != CW_OK)
        return st;
    array.components = (size_t)components;
    if (!*type) /* colours are bytes, or text from 0 to 1 */
        strcpy(type, v->binary ? "unsigned_char" : "float");
    return pass_array(v, &array, type, v->count, err);
}

/* Moves *text behind the name before a count, and any blanks. */
static void skip_name(const char **text, char name[CWI_WORD_BYTES])
{
    name[0] = '\0';
    cwi_next_text_word(text, name);
    *text += strspn(*text, " \t");
}

/* Skips "LOOKUP_TABLE name size": colours, which are not used. */
static cw_status read_lookup_table(cwi_vtk *v, cw_error *err)
{
    char name[CWI_WORD_BYTES];
    const char *text = cwi_vtk_value(v);
    int64_t size = 0;
    skip_name(&text, name);
    cw_status st = cwi_field_integer("LOOKUP_TABLE", text, 0, INT32_MAX, &size, err);
    if (st != CW_OK)
        return st;
    return pass_numbers(v, name, 4 * (size_t)size, 8, err);
}

/* Reads an array of a field: "name components tuples type". */
static cw_status read_field_array(cwi_vtk *v, cw_error *err)
{
    cwi_legacy_array array = {.rank = CWI_VTK_ONE};
    char words[3][CWI_WORD_BYTES];
    const char *text = v->line;
    int64_t components, tuples;
    bool whole = next_name(&text, array.name);
    for (int i = 0; i < 3; i++)
        whole = whole && cwi_next_text_word(&text, words[i]);
    if (!whole)
        return cwi_fail(
            err, CW_ERR_FORMAT,
            "line %zu is '%.60s'; it must name an array of a FIELD, its components, "
            "tuples and type",
            v->number, v->line);
    cw_status st = cwi_field_integer(array.name, words[0], 0, MAX_COMPONENTS, &components, err);
    if (st == CW_OK)
        st = cwi_field_integer(array.name, words[1], 0, INT64_MAX, &tuples, err);
    if (st != CW_OK)
        return st;
    array.components = (size_t)components;
    return pass_array(v, &array, words[2], (size_t)tuples, err);
}

/* Reads "FIELD name count", then that number of arrays. */
static cw_status read_field(cwi_vtk *v, cw_error *err)
{
    char name[CWI_WORD_BYTES];
    const char *text = cwi_vtk_value(v);
    int64_t count = 0;
    bool more = true;
    skip_name(&text, name);
    cw_status st = cwi_field_integer("FIELD", text, 0, MAX_LINES, &count, err);
    while (st == CW_OK && count > 0 && !cwi_vtk_is_settled(v)) {
        st = cwi_vtk_full_line(v, &more, err);
        if (st == CW_OK && !more)
            return cwi_fail(err, CW_ERR_FORMAT,
                            "the file ends; %lld arrays of '%.40s' are to come",
                            (long long)count, name);
        if (st == CW_OK && is_keyword(v->line, "metadata")) {
            st = skip_metadata(v, err);
        } else if (st == CW_OK) {
            st = read_field_array(v, err);
            count--;
        }
    }
    return st;
}

cw_status cwi_vtk_section(cwi_vtk *v, bool *known, cw_error *err)
{
    *known = true;
    for (int row = 0; row < ATTRIBUTE_COUNT; row++)
        if (is_keyword(v->line, attributes[row].names))
            return read_attribute(v, row, err);
    if (is_keyword(v->line, "lookup_table"))
        return read_lookup_table(v, err);
    if (is_keyword(v->line, "field"))
        return read_field(v, err);
    if (is_keyword(v->line, "metadata"))
        return skip_metadata(v, err);
    *known = false;
    return CW_OK;
}
