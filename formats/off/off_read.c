/* Reads OFF as text: OFF, NOFF with normals, COFF with colours, STOFF with texture
 * coordinates. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "formats/mesh/face_colors.h"
#include "formats/off/off_format.h"

#include <math.h>
#include <string.h>

typedef struct off {
    cwi_mesh_build build;
    uint64_t vertices, faces;
    bool normals, colors;
    cwi_face_colors face_colors;
} off;

static bool skip_letters(const char **at, const char *letters)
{
    const size_t length = strlen(letters);
    const bool same = strncmp(*at, letters, length) == 0;
    *at += same ? length : 0;
    return same;
}

/* Parses "[ST][C][N][4][n]OFF" with nothing behind it. 4: homogeneous, n: of any dimension. */
static bool parse_keyword(const char *text, off *o, bool *odd)
{
    skip_letters(&text, "ST");
    o->colors = skip_letters(&text, "C");
    o->normals = skip_letters(&text, "N");
    *odd = skip_letters(&text, "4");
    *odd = skip_letters(&text, "n") || *odd;
    return skip_letters(&text, "OFF") && (!*text || strchr(" \t\r\n", *text));
}

bool cwi_off_sniff(const unsigned char *head, size_t size, uint64_t file_size)
{
    char text[16] = "";
    bool odd;
    off o;
    (void)file_size;
    memcpy(text, head, size < sizeof text - 1 ? size : sizeof text - 1);
    return parse_keyword(text, &o, &odd);
}

static cw_status read_keyword(off *o, cwi_scan *s, cw_error *err)
{
    char keyword[16] = "";
    cwi_word word;
    bool found, odd;
    cw_status st = cwi_scan_next_line(s, &found, err);
    if (st == CW_OK)
        st = cwi_scan_word(s, &word, err);
    if (st != CW_OK)
        return st;
    memcpy(keyword, word.text, word.size < sizeof keyword ? word.size : sizeof keyword - 1);
    if (!parse_keyword(keyword, o, &odd))
        return cwi_scan_fail(s, &word, "the first word", "OFF, COFF, NOFF or STOFF", err);
    if (odd)
        return cwi_fail(err, CW_ERR_FORMAT, "'%s' has points of another dimension than 3",
                        keyword);
    return CW_OK;
}

/* Checks the counts. A vertex has at least "0 0 0" and a line end, a face at least "0" and
 * one. */
static cw_status check_counts(const cwi_scan *s, int64_t vertices, int64_t faces, cw_error *err)
{
    const uint64_t capacity = cwi_scan_left(s) + 1;
    if (vertices < 0 || faces < 0)
        return cwi_fail(err, CW_ERR_FORMAT,
                        "line %zu: there cannot be %lld vertices and %lld faces", s->line,
                        (long long)vertices, (long long)faces);
    if ((uint64_t)vertices > capacity / 6 ||
        (uint64_t)faces > (capacity - 6 * (uint64_t)vertices) / 2)
        return cwi_fail(err, CW_ERR_FORMAT,
                        "line %zu counts %lld vertices and %lld faces; the file has only %llu "
                        "bytes for them",
                        s->line, (long long)vertices, (long long)faces,
                        (unsigned long long)(capacity - 1));
    return CW_OK;
}

/* Reads the first word that is no comment; comments of our writer are parsed. */
static cw_status first_word(cwi_scan *s, cwi_word *word, cw_mesh *mesh, cw_mesh_file *metadata,
                            cw_error *err)
{
    char text[CWI_REST_BYTES];
    bool found, ours = false;
    cw_status st = CW_OK;
    s->comments = false;
    while (st == CW_OK) {
        st = cwi_scan_next_line(s, &found, err);
        if (st == CW_OK)
            st = cwi_scan_word(s, word, err);
        if (st != CW_OK || !found || word->text[0] != '#')
            break;
        const bool alone = word->size == 1;
        st = cwi_scan_rest(s, text, err);
        if (st == CW_OK && alone)
            cwi_take_comment(text, &ours, mesh, metadata);
    }
    s->comments = true;
    return st;
}

/* Reads the counts of vertices, faces and edges (unused, sometimes missing), behind the keyword
 * or below. */
static cw_status read_counts(off *o, cwi_scan *s, cw_mesh *mesh, cw_mesh_file *metadata,
                             cw_error *err)
{
    int64_t vertices = 0, faces = 0;
    cwi_word word = {0};
    cw_status st = first_word(s, &word, mesh, metadata, err);
    if (st == CW_OK && cwi_word_is(&word, "BINARY"))
        return cwi_fail(err, CW_ERR_FORMAT, "binary OFF is not read, only its text form");
    if (st == CW_OK && !cwi_word_integer(&word, &vertices))
        return cwi_scan_fail(s, &word, "the number of vertices", "a whole number", err);
    if (st == CW_OK)
        st = cwi_scan_integer(s, "the number of faces", &faces, err);
    if (st == CW_OK)
        st = check_counts(s, vertices, faces, err);
    o->vertices = (uint64_t)vertices;
    o->faces = (uint64_t)faces;
    return st == CW_OK ? cwi_scan_end_line(s, err) : st;
}

static cw_status ensure_capacity(off *o, cw_mesh *mesh, cw_error *err)
{
    const size_t count = (size_t)o->vertices;
    size_t normals = 0, colors = 0;
    cw_status st = cwi_build_reserve(&o->build, o->vertices, 0, err);
    if (st == CW_OK && o->normals)
        st = cwi_mesh_grow(o->build.in, &mesh->normals, &normals, count,
                           3 * sizeof *mesh->normals, err);
    if (st == CW_OK && o->colors)
        st = cwi_mesh_grow(o->build.in, &mesh->colors, &colors, count, 4, err);
    return st;
}

/* Reads a colour: whole numbers up to 255, or numbers up to 1 with a point in them. Alpha is
 * optional. Fewer than three numbers (*is_there is false) give white. */
static cw_status read_color(cwi_scan *s, uint8_t color[4], bool *is_there, cw_error *err)
{
    double number[4] = {0};
    bool fraction = false;
    int count = 0;
    cwi_word word;
    cw_status st = cwi_scan_word(s, &word, err);
    while (st == CW_OK && count < 4 && cwi_word_double(&word, &number[count])) {
        fraction = fraction || memchr(word.text, '.', word.size);
        count++;
        st = cwi_scan_word(s, &word, err);
    }
    for (int c = 0; c < 4; c++) {
        const double value = number[c] * (fraction ? 255 : 1);
        const bool given = count >= 3 && c < count && isfinite(value);
        color[c] = given ? (uint8_t)lround(fmin(fmax(value, 0), 255)) : 255;
    }
    *is_there = count >= 3;
    return st;
}

static cw_status read_vertex(off *o, cwi_scan *s, cw_mesh *mesh, cw_error *err)
{
    const size_t v = o->build.point_count;
    double point[3] = {0}, normal[3] = {0};
    bool is_colored;
    cw_status st = CW_OK;
    for (int a = 0; a < 3 && st == CW_OK; a++)
        st = cwi_scan_double(s, "a coordinate", &point[a], err);
    for (int a = 0; a < 3 && st == CW_OK && o->normals; a++)
        st = cwi_scan_double(s, "a normal's coordinate", &normal[a], err);
    for (size_t a = 0; a < 3 && st == CW_OK && o->normals; a++) /* others are not normals */
        mesh->normals[3 * v + a] = fabs(normal[a]) < 1e30 ? (float)normal[a] : NAN;
    if (st == CW_OK && o->colors)
        st = read_color(s, mesh->colors + 4 * v, &is_colored, err);
    return st == CW_OK ? cwi_build_point(&o->build, point, err) : st;
}

static cw_status read_face(off *o, cwi_scan *s, cw_mesh_file *metadata, cw_error *err)
{
    int64_t corners, corner;
    uint8_t color[4];
    bool is_colored = false;
    cw_status st = cwi_scan_integer(s, "a face's number of corners", &corners, err);
    if (st == CW_OK && corners < 0)
        return cwi_fail(err, CW_ERR_FORMAT, "line %zu: a face has %lld corners", s->line,
                        (long long)corners);
    for (int64_t c = 0; st == CW_OK && c < corners; c++) {
        st = cwi_scan_integer(s, "a corner", &corner, err);
        if (st == CW_OK)
            st = cwi_build_corner(&o->build, corner, err);
    }
    if (st == CW_OK)
        st = cwi_build_end_face(&o->build, metadata, err);
    if (st == CW_OK)
        st = read_color(s, color, &is_colored, err);
    return st == CW_OK ? cwi_color_faces(&o->face_colors, o->build.triangle_count,
                                         is_colored ? color : NULL, err)
                       : st;
}

/* Goes to the line of element i. */
static cw_status go_to_line(cwi_scan *s, const char *what, uint64_t i, uint64_t count,
                            cw_error *err)
{
    bool found;
    cw_status st = cwi_scan_next_line(s, &found, err);
    if (st == CW_OK && !found)
        return cwi_fail(err, CW_ERR_FORMAT, "the file ends after %llu of %llu %s",
                        (unsigned long long)i, (unsigned long long)count, what);
    return st;
}

static cw_status read_lines(off *o, cwi_scan *s, cw_mesh *mesh, cw_mesh_file *metadata,
                            cw_error *err)
{
    cw_status st = CW_OK;
    for (uint64_t i = 0; st == CW_OK && i < o->vertices; i++) {
        st = go_to_line(s, "vertices", i, o->vertices, err);
        if (st == CW_OK)
            st = read_vertex(o, s, mesh, err);
        if (st == CW_OK)
            st = cwi_scan_end_line(s, err);
    }
    for (uint64_t i = 0; st == CW_OK && i < o->faces; i++) {
        st = go_to_line(s, "faces", i, o->faces, err);
        if (st == CW_OK)
            st = read_face(o, s, metadata, err);
        if (st == CW_OK)
            st = cwi_scan_end_line(s, err);
    }
    return st;
}

cw_status cwi_off_read(cwi_mesh_input *in, cw_mesh *mesh, cw_mesh_file *metadata, cw_error *err)
{
    off o = {.build = {.in = in}, .face_colors = {.in = in}};
    cwi_scan s = {0};
    cw_status st = cwi_scan_open_text(&s, &in->file, 0, &in->desc.progress, err);
    s.by_line = s.comments = true;
    if (st == CW_OK)
        st = read_keyword(&o, &s, err);
    if (st == CW_OK)
        st = read_counts(&o, &s, mesh, metadata, err);
    if (st == CW_OK)
        st = ensure_capacity(&o, mesh, err);
    if (st == CW_OK)
        st = read_lines(&o, &s, mesh, metadata, err);
    if (st == CW_OK)
        st = cwi_build_finish(&o.build, mesh, metadata, err);
    if (st == CW_OK)
        st = cwi_color_mesh(&o.face_colors, false, mesh, err);
    cwi_scan_close(&s);
    cwi_build_free(&o.build);
    cwi_face_colors_free(&o.face_colors);
    return st;
}
