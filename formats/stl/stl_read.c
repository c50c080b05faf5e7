/* Reads STL, binary and text. Facets share nothing, so corners at one place become one
 * vertex. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/base/text.h"
#include "core/mesh/weld.h"
#include "formats/bytes/little_endian.h"
#include "formats/mesh/mesh_axes.h"
#include "formats/stl/stl_colors.h"
#include "formats/stl/stl_format.h"

#include <float.h>
#include <math.h>
#include <string.h>
#include <strings.h>

enum { HEADER = CWI_STL_HEADER, START = 84, FACET = 50, BATCH = 64 };

/* Returns true if the size is that of a binary file, since binary files may also begin with
 * "solid". Some are longer than their facets; they are accepted later, if they cannot be
 * text. */
static bool is_binary(const unsigned char *head, size_t size, uint64_t file_size)
{
    return size >= START && file_size == START + (uint64_t)FACET * cwi_get_u32(head + HEADER);
}

static bool is_text(const unsigned char *head, size_t size)
{
    size_t i = size >= 3 && memcmp(head, "\xef\xbb\xbf", 3) == 0 ? 3 : 0; /* byte order mark */
    while (i < size && (head[i] == ' ' || (head[i] >= '\t' && head[i] <= '\r')))
        i++;
    /* a binary file that is cut off has another size than it should; its count of facets has a zero */
    return size - i >= 5 && !memchr(head, 0, size < START ? size : START) &&
           strncasecmp((const char *)head + i, "solid", 5) == 0;
}

bool cwi_stl_sniff(const unsigned char *head, size_t size, uint64_t file_size)
{
    return is_binary(head, size, file_size) || is_text(head, size);
}

/* The mesh while it grows: the welder's points, and three of them for each facet. */
typedef struct facets {
    cwi_mesh_input *in;
    cwi_welder welder;
    uint32_t *triangles;
    size_t count, capacity;
    cwi_stl_colors colors; /* of a binary file */
} facets;

/* Counts the welder's memory when it has grown: its points and its table. */
static cw_status limit_memory(const facets *f, cw_error *err)
{
    const uint64_t limit = f->in->desc.max_bytes;
    const uint64_t welder = 12 * (uint64_t)f->welder.capacity + 4 * (uint64_t)f->welder.slots;
    if (!limit || f->in->bytes + welder <= limit)
        return CW_OK;
    char text[CWI_MEMORY_TEXT];
    cwi_print_memory(limit, text);
    return cwi_fail(err, CW_ERR_LIMIT,
                    "the mesh needs more memory than the %s allowed (desc->max_bytes)", text);
}

static cw_status check_corners(const facets *f, const float *corners, size_t count,
                               cw_error *err)
{
    for (size_t i = 0; i < 9 * count; i++)
        if (!isfinite(corners[i]))
            return cwi_fail(err, CW_ERR_FORMAT,
                            "'%c' of corner %zu of facet %zu is %g; it must be finite",
                            "xyz"[i % 3], i / 3 % 3, f->count + i / 9, (double)corners[i]);
    return CW_OK;
}

/* Adds facets of nine coordinates each; there is room for them. */
static cw_status add_facets(facets *f, const float *corners, size_t count, cw_error *err)
{
    const size_t capacity = f->welder.capacity;
    cw_status st = check_corners(f, corners, count, err);
    if (st != CW_OK)
        return st;
    if (!cwi_welder_add(&f->welder, corners, 3 * count, f->triangles + 3 * f->count))
        return cwi_fail(err, f->welder.count < UINT32_MAX - 1 ? CW_ERR_NO_MEMORY : CW_ERR_LIMIT,
                        "no memory or number for vertex %zu", f->welder.count);
    f->count += count;
    return f->welder.capacity == capacity ? CW_OK : limit_memory(f, err);
}

static cw_status ensure_capacity(facets *f, uint64_t count, cw_error *err)
{
    cw_status st = cwi_mesh_limit_triangles(f->in, count, err);
    if (st == CW_OK)
        st = cwi_mesh_grow(f->in, &f->triangles, &f->capacity, (size_t)count,
                           3 * sizeof *f->triangles, err);
    return st;
}

/* Reads the words of our writer, "cubewright, LPS, mm from 1 2 3": frame and unit, and the
 * origin of a local file. */
static void take_words(const char *text, cw_mesh *mesh, cw_mesh_file *metadata)
{
    static const char ours[] = "cubewright, ", from[] = " from ";
    const char *rest = text + strlen(ours);
    if (strncmp(text, ours, strlen(ours)) != 0 || !cwi_parse_axes(&rest, metadata))
        return;
    metadata->local = strncmp(rest, from, strlen(from)) == 0;
    if (metadata->local && !cwi_parse_origin(rest + strlen(from), mesh->origin))
        metadata->known = CW_KNOWN_UNIT;
}

/* --- binary ------------------------------------------------------------------------------ */

/* The facets behind the header, and the bytes that follow each. */
typedef struct layout {
    size_t count;
    uint64_t attribute_bytes; /* of all facets */
    bool has_attributes;      /* facets are followed by as many bytes as they state */
} layout;

/* Walks over facets that are followed by as many bytes as they state. Returns true if they end with the
 * file. */
static bool has_attributes(const facets *f, layout *l, cw_error *err)
{
    cwi_scan s = {0};
    uint64_t bytes = 0;
    size_t n = 0;
    cw_status st = cwi_scan_open(&s, &f->in->file, START, &(cw_progress){0}, err);
    for (const unsigned char *b; n < l->count && st == CW_OK; n++) {
        st = cwi_scan_take(&s, FACET, "a facet", &b, err);
        const size_t more = st == CW_OK ? b[48] | (size_t)b[49] << 8 : 0;
        if (st == CW_OK && more)
            st = cwi_scan_take(&s, more, "its attributes", &b, err);
        bytes += more;
    }
    l->has_attributes = st == CW_OK && bytes && cwi_scan_left(&s) == 0;
    l->attribute_bytes = l->has_attributes ? bytes : 0;
    cwi_scan_close(&s);
    return l->has_attributes;
}

/* Returns true if the first facet behind those that the header counts looks like one. */
static bool goes_on(const facets *f, size_t count)
{
    unsigned char b[FACET];
    size_t got;
    bool is_facet = cwi_input_read_at(f->in->file.fd, START + FACET * (uint64_t)count, b, FACET,
                                      &got, NULL) == CW_OK &&
                    got == FACET;
    for (size_t i = 3; i < 12 && is_facet; i++) { /* the normal may be anything */
        const uint32_t bits = cwi_get_u32(b + 4 * i);
        float x;
        memcpy(&x, &bits, sizeof x);
        is_facet = isfinite(x) && (x == 0 || (fabsf(x) > 1e-30f && fabsf(x) < 1e30f));
    }
    return is_facet;
}

/* Finds the number of facets. The header's is right where it fits the file's size, with or without the
 * bytes that facets may have behind them. Else the size decides, if it is that of whole facets. */
static cw_status find_layout(const facets *f, uint64_t bytes, layout *l, cw_mesh_file *metadata,
                             cw_error *err)
{
    const uint64_t held = bytes / FACET, count = l->count;
    const bool is_whole = bytes % FACET == 0 && held > 0;
    if (count == held && is_whole)
        return CW_OK;
    if (count && count < held + 1 && has_attributes(f, l, NULL)) {
        metadata->attribute_bytes = l->attribute_bytes;
        return CW_OK;
    }
    if (is_whole && (count > held ? !f->in->desc.truncated : goes_on(f, l->count))) {
        metadata->miscounted = true;
        metadata->expected_triangles = l->count;
        l->count = (size_t)held;
        return CW_OK;
    }
    if (count <= held)
        return CW_OK;
    if (!f->in->desc.truncated || !held)
        return cwi_fail(err, CW_ERR_FORMAT,
                        "the header counts %zu facets; the file has room for %llu%s", l->count,
                        (unsigned long long)held, held ? "; desc->truncated takes those" : "");
    metadata->truncated = true;
    metadata->expected_triangles = l->count;
    l->count = (size_t)held;
    return CW_OK;
}

/* Reads the next `count` facets. */
static cw_status read_binary_facets(facets *f, cwi_scan *s, size_t count, const layout *l,
                                    cw_error *err)
{
    float corners[9 * BATCH];
    cw_status st = CW_OK;
    for (size_t t = 0; t < count && st == CW_OK; t++) {
        const unsigned char *b;
        st = cwi_scan_take(s, FACET, "a facet", &b, err);
        for (size_t i = 0; i < 9 && st == CW_OK; i++) {
            const uint32_t bits = cwi_get_u32(b + 12 + 4 * i);
            memcpy(&corners[9 * t + i], &bits, sizeof bits);
        }
        const uint16_t word = st == CW_OK ? (uint16_t)(b[48] | b[49] << 8) : 0;
        if (st == CW_OK && !l->has_attributes)
            st = cwi_stl_keep_word(&f->colors, f->count + t, l->count, word, err);
        else if (word)
            st = cwi_scan_take(s, word, "its attributes", &b, err);
    }
    return st == CW_OK ? add_facets(f, corners, count, err) : st;
}

static cw_status read_binary(facets *f, cwi_scan *s, cw_mesh *mesh, cw_mesh_file *metadata,
                             cw_error *err)
{
    const unsigned char *head;
    cw_status st = cwi_scan_take(s, START, "the header", &head, err);
    if (st != CW_OK)
        return st;
    char text[HEADER + 1] = "";
    layout l = {.count = cwi_get_u32(head + HEADER)};
    memcpy(text, head, HEADER);
    take_words(text, mesh, metadata);
    cwi_stl_find_object_color(&f->colors, head);
    st = find_layout(f, cwi_scan_left(s), &l, metadata, err);
    if (st == CW_OK)
        st = ensure_capacity(f, l.count, err);
    while (st == CW_OK && f->count < l.count) {
        const size_t left = l.count - f->count;
        st = read_binary_facets(f, s, left < BATCH ? left : BATCH, &l, err);
    }
    return st;
}

/* --- text -------------------------------------------------------------------------------- */

/* Returns true if a word is a keyword, in any letter case. */
static bool is_keyword(const cwi_word *word, const char *keyword)
{
    size_t i = 0;
    while (i < word->size && keyword[i] && (word->text[i] | 32) == keyword[i])
        i++;
    return i == word->size && !keyword[i];
}

static cw_status expect_keyword(cwi_scan *s, const char *keyword, cw_error *err)
{
    cwi_word word;
    cw_status st = cwi_scan_word(s, &word, err);
    if (st == CW_OK && !is_keyword(&word, keyword))
        return cwi_scan_fail(s, &word, "the next word", keyword, err);
    return st;
}

static cw_status read_text_corner(cwi_scan *s, float point[3], cw_error *err)
{
    cw_status st = expect_keyword(s, "vertex", err);
    for (int a = 0; a < 3 && st == CW_OK; a++) {
        double number = 0;
        st = cwi_scan_double(s, "a coordinate", &number, err);
        if (fabs(number) > (double)FLT_MAX)
            number = copysign((double)INFINITY, number);
        point[a] = (float)number;
    }
    return st;
}

/* Reads a facet behind the word "facet". The normal may be anything, even "nan". */
static cw_status read_text_facet(facets *f, cwi_scan *s, cw_error *err)
{
    cwi_word word;
    float corners[9];
    cw_status st = ensure_capacity(f, (uint64_t)f->count + 1, err);
    if (st == CW_OK)
        st = expect_keyword(s, "normal", err);
    for (int a = 0; a < 3 && st == CW_OK; a++)
        st = cwi_scan_word(s, &word, err);
    if (st == CW_OK)
        st = expect_keyword(s, "outer", err);
    if (st == CW_OK)
        st = expect_keyword(s, "loop", err);
    for (int c = 0; c < 3 && st == CW_OK; c++)
        st = read_text_corner(s, corners + 3 * c, err);
    if (st == CW_OK)
        st = expect_keyword(s, "endloop", err);
    if (st == CW_OK)
        st = expect_keyword(s, "endfacet", err);
    return st == CW_OK ? add_facets(f, corners, 1, err) : st;
}

/* Removes our words from the end of a solid's name. */
static void take_name(char *name, cw_mesh *mesh, cw_mesh_file *metadata)
{
    static const char ours[] = "cubewright, ";
    char *at = name + strlen(name);
    while (at > name && strncmp(at, ours, strlen(ours)) != 0)
        at--;
    take_words(at, mesh, metadata);
    while (metadata->known && at > name && at[-1] == ' ')
        at--;
    if (metadata->known)
        *at = '\0';
}

/* Reads a solid behind the word "solid"; its name may be any words. */
static cw_status read_solid(facets *f, cwi_scan *s, cw_mesh *mesh, cw_mesh_file *metadata,
                            cw_error *err)
{
    char name[CWI_REST_BYTES];
    cwi_word word = {0};
    cw_status st = cwi_scan_rest(s, name, err);
    if (st == CW_OK && f->count == 0)
        take_name(name, mesh, metadata);
    if (st == CW_OK)
        st = cwi_mesh_begin_part(f->in, name, f->count, err);
    if (st == CW_OK)
        st = cwi_scan_end_line(s, err);
    while (st == CW_OK) {
        st = cwi_scan_word(s, &word, err);
        if (st == CW_OK && is_keyword(&word, "facet"))
            st = read_text_facet(f, s, err);
        else if (st == CW_OK && is_keyword(&word, "endsolid"))
            return cwi_scan_end_line(s, err);
        else if (st == CW_OK)
            return cwi_scan_fail(s, &word, "the next word", "facet or endsolid", err);
    }
    return st;
}

static cw_status read_text(facets *f, cwi_scan *s, cw_mesh *mesh, cw_mesh_file *metadata,
                           cw_error *err)
{
    cwi_word word;
    cw_status st = cwi_scan_word(s, &word, err);
    while (st == CW_OK && word.size) {
        if (!is_keyword(&word, "solid"))
            return cwi_scan_fail(s, &word, "the next word", "solid", err);
        st = read_solid(f, s, mesh, metadata, err);
        if (st == CW_OK)
            st = cwi_scan_word(s, &word, err);
    }
    return st;
}

/* Judges an error: where the file ends in the middle of a facet, those before may be taken. */
static cw_status judge_end(const facets *f, const cwi_scan *s, cw_status st,
                           cw_mesh_file *metadata, cw_error *err)
{
    enum { LINE_END = 2 };
    if (st != CW_ERR_FORMAT || cwi_scan_left(s) > LINE_END || !f->count)
        return st;
    metadata->truncated = f->in->desc.truncated;
    if (metadata->truncated) {
        if (err)
            *err = (cw_error){0};
        return CW_OK;
    }
    const cw_error cause = err ? *err : (cw_error){0};
    return cwi_fail(err, st, "%.400s; desc->truncated takes the %zu facet%s before that",
                    cause.message, f->count, f->count == 1 ? "" : "s");
}

/* --- either ------------------------------------------------------------------------------ */

static cw_status move_arrays(facets *f, cw_mesh *mesh, cw_error *err)
{
    mesh->positions = f->welder.points;
    mesh->vertex_count = f->welder.count;
    mesh->triangles = f->triangles;
    mesh->triangle_count = f->count;
    f->welder.points = NULL;
    f->triangles = NULL;
    return cwi_mesh_shrink(mesh, err);
}

cw_status cwi_stl_read(cwi_mesh_input *in, cw_mesh *mesh, cw_mesh_file *metadata, cw_error *err)
{
    unsigned char head[START];
    size_t size;
    facets f = {.in = in, .colors = {.in = in}};
    cwi_scan s = {0};
    cw_status st = cwi_input_read_at(in->file.fd, 0, head, sizeof head, &size, err);
    const bool text = is_text(head, size) && !is_binary(head, size, in->file.size);
    if (st == CW_OK)
        st = text ? cwi_scan_open_text(&s, &in->file, *head == 0xef ? 3 : 0, &in->desc.progress,
                                       err)
                  : cwi_scan_open(&s, &in->file, 0, &in->desc.progress, err);
    if (st == CW_OK)
        st = text ? read_text(&f, &s, mesh, metadata, err)
                  : read_binary(&f, &s, mesh, metadata, err);
    if (text)
        st = judge_end(&f, &s, st, metadata, err);
    if (st == CW_OK)
        st = move_arrays(&f, mesh, err);
    if (st == CW_OK && !text)
        st = cwi_stl_color_mesh(&f.colors, mesh, metadata, err);
    cwi_stl_colors_free(&f.colors);
    cwi_scan_close(&s);
    cwi_welder_free(&f.welder);
    cwi_free(f.triangles);
    return st;
}
