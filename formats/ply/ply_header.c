/* Parses the header of a PLY file and checks its counts against the file's size. */
#include "formats/ply/ply.h"

#include "core/base/status.h"
#include "core/base/text.h"
#include "formats/mesh/mesh_axes.h"
#include "formats/text/text_header.h"

#include <stdio.h>
#include <string.h>

static const struct {
    const char *name, *other;
    size_t size;
} types[CWI_PLY_TYPE_COUNT] = {
    [CWI_PLY_I8] = {"char", "int8", 1},      [CWI_PLY_U8] = {"uchar", "uint8", 1},
    [CWI_PLY_I16] = {"short", "int16", 2},   [CWI_PLY_U16] = {"ushort", "uint16", 2},
    [CWI_PLY_I32] = {"int", "int32", 4},     [CWI_PLY_U32] = {"uint", "uint32", 4},
    [CWI_PLY_F32] = {"float", "float32", 4}, [CWI_PLY_F64] = {"double", "float64", 8},
};

/* The known properties. Types of colours are those with a known maximum. */
static const struct {
    const char *element, *name;
    cwi_ply_role role;
    bool is_list;
} roles[] = {
    {"vertex", "x", CWI_PLY_X, false},
    {"vertex", "y", CWI_PLY_Y, false},
    {"vertex", "z", CWI_PLY_Z, false},
    {"vertex", "nx", CWI_PLY_NX, false},
    {"vertex", "ny", CWI_PLY_NY, false},
    {"vertex", "nz", CWI_PLY_NZ, false},
    {"vertex", "red", CWI_PLY_RED, false},
    {"vertex", "green", CWI_PLY_GREEN, false},
    {"vertex", "blue", CWI_PLY_BLUE, false},
    {"vertex", "alpha", CWI_PLY_ALPHA, false},
    {"vertex", "r", CWI_PLY_RED, false},
    {"vertex", "g", CWI_PLY_GREEN, false},
    {"vertex", "b", CWI_PLY_BLUE, false},
    {"vertex", "diffuse_red", CWI_PLY_RED, false},
    {"vertex", "diffuse_green", CWI_PLY_GREEN, false},
    {"vertex", "diffuse_blue", CWI_PLY_BLUE, false},
    {"vertex", "scalar", CWI_PLY_SCALAR, false},
    {"vertex", "label", CWI_PLY_LABEL, false},
    {"face", "vertex_indices", CWI_PLY_INDICES, true},
    {"face", "vertex_index", CWI_PLY_INDICES, true},
    {"face", "red", CWI_PLY_FACE_RED, false},
    {"face", "green", CWI_PLY_FACE_GREEN, false},
    {"face", "blue", CWI_PLY_FACE_BLUE, false},
    {"face", "alpha", CWI_PLY_FACE_ALPHA, false},
    {"face", "diffuse_red", CWI_PLY_FACE_RED, false},
    {"face", "diffuse_green", CWI_PLY_FACE_GREEN, false},
    {"face", "diffuse_blue", CWI_PLY_FACE_BLUE, false},
};

size_t cwi_ply_type_size(cwi_ply_type type)
{
    return types[type].size;
}

static cw_status parse_type(const char **rest, const char *line, cwi_ply_type *type,
                            cw_error *err)
{
    char word[CWI_WORD_BYTES] = "";
    cwi_next_text_word(rest, word);
    for (int t = 0; t < CWI_PLY_TYPE_COUNT; t++)
        if (strcmp(word, types[t].name) == 0 || strcmp(word, types[t].other) == 0) {
            *type = (cwi_ply_type)t;
            return CW_OK;
        }
    return cwi_fail(err, CW_ERR_FORMAT,
                    "'%.60s' has a property of type '%.20s'; the types are char, uchar, short, "
                    "ushort, int, uint, float, double",
                    line, word);
}

static cw_status parse_format(cwi_ply_header *h, const char *rest, cw_error *err)
{
    char word[CWI_WORD_BYTES] = "";
    cwi_next_text_word(&rest, word);
    h->text = strcmp(word, "ascii") == 0;
    h->big_endian = strcmp(word, "binary_big_endian") == 0;
    if (h->text || h->big_endian || strcmp(word, "binary_little_endian") == 0)
        return CW_OK;
    return cwi_fail(err, CW_ERR_FORMAT,
                    "'format' is '%.30s'; there are ascii, binary_little_endian and "
                    "binary_big_endian",
                    word);
}

static cw_status parse_element(cwi_ply_header *h, const char *rest, cw_error *err)
{
    char word[CWI_WORD_BYTES] = "";
    int64_t count;
    cwi_next_text_word(&rest, word);
    if (h->element_count == CWI_PLY_ELEMENTS)
        return cwi_fail(err, CW_ERR_FORMAT, "the header has more than %d elements",
                        CWI_PLY_ELEMENTS);
    cwi_ply_element *e = &h->elements[h->element_count++];
    *e = (cwi_ply_element){.first = h->property_count, .end = h->property_count};
    snprintf(e->name, sizeof e->name, "%.*s", CWI_PLY_NAME - 1, word);
    snprintf(e->what, sizeof e->what, "element '%.*s'", CWI_PLY_NAME - 1, word);
    for (size_t i = 0; i + 1 < h->element_count; i++)
        if (strcmp(h->elements[i].name, e->name) == 0)
            return cwi_fail(err, CW_ERR_FORMAT, "the header has two elements '%s'", e->name);
    cw_status st = cwi_field_integer("element", rest, 0, INT64_MAX, &count, err);
    e->count = st == CW_OK ? (uint64_t)count : 0;
    if (strcmp(word, "tristrips") == 0)
        return cwi_fail(err, CW_ERR_FORMAT, "element 'tristrips' is not read, only 'face'");
    return st;
}

static cwi_ply_role find_role(const cwi_ply_element *e, const char *name, bool is_list)
{
    for (size_t i = 0; i < sizeof roles / sizeof *roles; i++)
        if (roles[i].is_list == is_list && strcmp(roles[i].element, e->name) == 0 &&
            strcmp(roles[i].name, name) == 0)
            return roles[i].role;
    return CWI_PLY_NOTHING;
}

/* Parses "TYPE NAME" or "list TYPE TYPE NAME". */
static cw_status parse_property(cwi_ply_header *h, const char *rest, const char *line,
                                cw_error *err)
{
    char word[CWI_WORD_BYTES] = "";
    const char *behind = rest;
    if (h->element_count == 0)
        return cwi_fail(err, CW_ERR_FORMAT, "'%.60s' stands before any element", line);
    if (h->property_count == CWI_PLY_PROPERTIES)
        return cwi_fail(err, CW_ERR_FORMAT, "the header has more than %d properties",
                        CWI_PLY_PROPERTIES);
    cwi_ply_element *e = &h->elements[h->element_count - 1];
    cwi_ply_property *p = &h->properties[h->property_count++];
    e->end = h->property_count;
    *p = (cwi_ply_property){0};
    cwi_next_text_word(&behind, word);
    p->is_list = strcmp(word, "list") == 0;
    cw_status st = CW_OK;
    if (p->is_list) {
        rest = behind;
        st = parse_type(&rest, line, &p->count_type, err);
    }
    if (st == CW_OK)
        st = parse_type(&rest, line, &p->type, err);
    if (st == CW_OK && p->is_list && p->count_type >= CWI_PLY_F32)
        return cwi_fail(err, CW_ERR_FORMAT, "'%.60s' counts with a type that is not whole",
                        line);
    word[0] = '\0';
    cwi_next_text_word(&rest, word);
    p->role = find_role(e, word, p->is_list);
    return st;
}

/* Parses a comment of our writer: unit, frame, up and origin. Up and origin are only accepted
 * from our own files, as they may mean something else in others. */
static void parse_comment(cwi_ply_header *h, const char *rest, bool *ours,
                          cw_mesh_file *metadata)
{
    char word[CWI_WORD_BYTES] = "", value[CWI_WORD_BYTES] = "";
    cwi_next_text_word(&rest, word);
    const char *numbers = rest, *name = value;
    cwi_next_text_word(&rest, value);
    if (strcmp(word, "cubewright") == 0)
        *ours = true;
    else if (strcmp(word, "unit") == 0)
        cwi_parse_unit(&name, metadata);
    else if (strcmp(word, "frame") == 0)
        cwi_parse_frame(&name, metadata);
    else if (strcmp(word, "up") == 0 && *ours)
        metadata->axes.y_up = strcmp(value, "Y") == 0;
    else if (strcmp(word, "origin") == 0 && *ours)
        metadata->local = cwi_parse_origin(numbers, h->origin);
}

static cw_status parse_line(cwi_ply_header *h, const char *line, bool *ours, bool *done,
                            cw_mesh_file *metadata, cw_error *err)
{
    char word[CWI_WORD_BYTES] = "";
    const char *rest = line;
    cwi_next_text_word(&rest, word);
    if (strcmp(word, "element") == 0)
        return parse_element(h, rest, err);
    if (strcmp(word, "property") == 0)
        return parse_property(h, rest, line, err);
    if (strcmp(word, "comment") == 0)
        parse_comment(h, rest, ours, metadata);
    else if (strcmp(word, "end_header") == 0)
        *done = true;
    else if (*word && strcmp(word, "obj_info") != 0)
        return cwi_fail(err, CW_ERR_FORMAT,
                        "the header holds '%.40s', which is not a keyword of PLY", line);
    return CW_OK;
}

static cw_status parse_lines(cwi_ply_header *h, cwi_lines *lines, cw_mesh_file *metadata,
                             cw_error *err)
{
    char *line;
    bool ours = false, done = false;
    cw_status st = cwi_lines_next(lines, &line, err);
    if (st == CW_OK && (!line || strcmp(line, "ply") != 0))
        return cwi_fail(err, CW_ERR_FORMAT, "the first line is not 'ply'");
    if (st == CW_OK)
        st = cwi_lines_next(lines, &line, err);
    if (st == CW_OK && (!line || strncmp(line, "format ", 7) != 0))
        return cwi_fail(err, CW_ERR_FORMAT, "the second line is not 'format ...'");
    if (st == CW_OK)
        st = parse_format(h, line + 7, err);
    while (st == CW_OK && !done) {
        st = cwi_lines_next(lines, &line, err);
        if (st == CW_OK && !line)
            return cwi_fail(err, CW_ERR_FORMAT, "the header has no 'end_header'");
        if (st == CW_OK)
            st = parse_line(h, line, &ours, &done, metadata, err);
    }
    h->body = lines->next;
    h->lines = lines->number;
    return st;
}

/* Returns the minimum bytes of one element: of text, a digit and a blank each. */
static uint64_t min_bytes(const cwi_ply_header *h, const cwi_ply_element *e)
{
    uint64_t bytes = 0;
    for (size_t i = e->first; i < e->end; i++) {
        const cwi_ply_property *p = &h->properties[i];
        bytes += h->text ? 2 : types[p->is_list ? p->count_type : p->type].size;
    }
    return bytes;
}

static cw_status check_counts(const cwi_ply_header *h, uint64_t left, cw_error *err)
{
    left += h->text; /* the last line may have no line end */
    for (size_t i = 0; i < h->element_count; i++) {
        const cwi_ply_element *e = &h->elements[i];
        const uint64_t bytes = min_bytes(h, e);
        if (e->count && !bytes)
            return cwi_fail(err, CW_ERR_FORMAT, "element '%s' has no properties", e->name);
        if (e->count && e->count > left / bytes)
            return cwi_fail(err, CW_ERR_FORMAT,
                            "element '%s' is there %llu times; the file has only %llu bytes "
                            "for it",
                            e->name, (unsigned long long)e->count, (unsigned long long)left);
        left -= e->count * bytes;
    }
    return CW_OK;
}

cw_status cwi_ply_parse(const cwi_input *in, cwi_ply_header *h, cw_mesh_file *metadata,
                        cw_error *err)
{
    cwi_lines lines = {0};
    cw_status st = cwi_lines_open(&lines, in, err);
    if (st == CW_OK)
        st = parse_lines(h, &lines, metadata, err);
    cwi_lines_close(&lines);
    return st == CW_OK ? check_counts(h, in->size - h->body, err) : st;
}
