/* Reads FreeSurfer's surfaces, of triangles or of quadrangles: a magic number, counts, places and corners,
 * all big-endian; then, as text, how the volume lies that the surface is of.
 * [FreeSurferWiki: surfer.nmr.mgh.harvard.edu/fswiki/FreeSurferWiki, "SurfaceFiles"] */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/base/text.h"
#include "formats/cells/grid_arrays.h"
#include "formats/freesurfer/freesurfer_format.h"
#include "formats/mesh/scanner_frame.h"

#include <stdio.h>
#include <string.h>

/* Magic numbers of three bytes. Files of curvature begin as those of quadrangles. */
enum { QUADRANGLES = 0xFFFFFF, TRIANGLES = 0xFFFFFE, REAL_QUADRANGLES = 0xFFFFFD };

enum { HEAD_BYTES = 4096, GEOMETRY_BYTES = 8192, USES_SCANNER = 2, GEOMETRY = 20 };

/* Sizes of a file, and where its numbers are. */
typedef struct surface {
    uint32_t magic;
    uint64_t points, faces;
    uint64_t points_at, faces_at, end; /* end: of the corners */
} surface;

static uint32_t get_number(const unsigned char *at, size_t bytes)
{
    uint32_t number = 0;
    for (size_t n = 0; n < bytes; n++)
        number = number << 8 | at[n];
    return number;
}

/* Finds the counts behind the lines of text. Returns false where the head has no room for them. */
static bool find_triangle_counts(const unsigned char *head, size_t size, surface *s)
{
    const unsigned char *end = size > 3 ? memchr(head + 3, '\n', size - 3) : NULL;
    if (!end)
        return false;
    size_t at = (size_t)(end - head) + 1;
    at += at < size && head[at] == '\n';
    if (size < at + 8)
        return false;
    s->points = get_number(head + at, 4);
    s->faces = get_number(head + at + 4, 4);
    s->points_at = at + 8;
    s->faces_at = s->points_at + 12 * s->points;
    s->end = s->faces_at + 12 * s->faces;
    return true;
}

/* Reads the sizes from the start of a file. Returns false for other files. */
static bool find_sizes(const unsigned char *head, size_t size, surface *s)
{
    *s = (surface){.magic = size >= 9 ? get_number(head, 3) : 0};
    if (s->magic == TRIANGLES)
        return find_triangle_counts(head, size, s);
    if (s->magic != QUADRANGLES && s->magic != REAL_QUADRANGLES)
        return false;
    s->points = get_number(head + 3, 3);
    s->faces = get_number(head + 6, 3);
    s->points_at = 9;
    s->faces_at = 9 + (s->magic == QUADRANGLES ? 6 : 12) * s->points;
    s->end = s->faces_at + 12 * s->faces;
    return true;
}

/* Returns true for the curvature of vertices: their number, that of faces, 1, and singles. */
static bool is_curvature(const unsigned char *head, size_t size, uint64_t file_size)
{
    return size >= 15 && get_number(head, 3) == QUADRANGLES && get_number(head + 11, 4) == 1 &&
           file_size == 15 + 4 * (uint64_t)get_number(head + 3, 4);
}

bool cwi_freesurfer_sniff(const unsigned char *head, size_t size, uint64_t file_size)
{
    surface s;
    if (is_curvature(head, size, file_size))
        return true;
    return find_sizes(head, size, &s) && (s.magic == TRIANGLES || s.end <= file_size);
}

static cw_status read_sizes(const cwi_input *in, surface *s, cw_error *err)
{
    unsigned char head[HEAD_BYTES];
    size_t size = 0;
    cw_status st = cwi_input_read_at(in->fd, 0, head, sizeof head, &size, err);
    if (st != CW_OK)
        return st;
    if (is_curvature(head, size, in->size))
        return cwi_fail(err, CW_ERR_FORMAT,
                        "the file holds the curvature of %u vertices, and no surface",
                        get_number(head + 3, 4));
    if (!find_sizes(head, size, s))
        return cwi_fail(
            err, CW_ERR_FORMAT,
            "the file does not begin as a surface of FreeSurfer: bytes 0xFFFFFE, two "
            "lines of text and the counts of vertices and triangles were expected");
    if (s->points > INT32_MAX || s->faces > INT32_MAX || s->end > in->size)
        return cwi_fail(
            err, CW_ERR_FORMAT,
            "the header counts %llu vertices and %llu faces; the file has %llu bytes, "
            "they take %llu",
            (unsigned long long)s->points, (unsigned long long)s->faces,
            (unsigned long long)in->size, (unsigned long long)s->end);
    return CW_OK;
}

/* --- numbers ----------------------------------------------------------------------------- */

static cw_status load_numbers(cwi_mesh_input *in, uint64_t at, cw_type type, size_t components,
                              uint64_t count, cwi_tuples *t, cw_error *err)
{
    const cw_read_desc desc = {.progress = in->desc.progress};
    cwi_source src;
    *t = (cwi_tuples){.count = 0};
    if (count == 0)
        return CW_OK;
    cw_status st = cwi_tuples_describe(&src, "vertices, faces", type, false, components,
                                       (size_t)count, err);
    src.big_endian = true;
    src.offset = at;
    if (st == CW_OK)
        st = cwi_mesh_take_bytes(in, src.bytes, err);
    return st == CW_OK ? cwi_tuples_load(&src, &in->file, &desc, false, t, err) : st;
}

static void drop_numbers(cwi_mesh_input *in, cwi_tuples *t)
{
    in->bytes -= t->bytes;
    cwi_tuples_free(t);
}

static cw_status read_points(const surface *s, cwi_mesh_build *b, cw_error *err)
{
    const bool hundredths = s->magic == QUADRANGLES; /* of a millimetre */
    cwi_tuples t;
    cw_status st =
        load_numbers(b->in, s->points_at, hundredths ? CW_I16 : CW_F32, 3, s->points, &t, err);
    if (st == CW_OK)
        st = cwi_build_reserve(b, t.count, 0, err);
    for (size_t i = 0; i < t.count && st == CW_OK; i++) {
        double point[3];
        for (size_t a = 0; a < 3; a++)
            point[a] = cwi_tuples_real(&t, i, a) / (hundredths ? 100 : 1);
        st = cwi_build_point(b, point, err);
    }
    drop_numbers(b->in, &t);
    return st;
}

static cw_status add_triangle(cwi_mesh_build *b, const uint32_t corners[3],
                              cw_mesh_file *metadata, cw_error *err)
{
    cw_status st = CW_OK;
    for (int c = 0; c < 3 && st == CW_OK; c++) {
        if (corners[c] >= b->point_count)
            return cwi_fail(err, CW_ERR_FORMAT, "triangle %zu names vertex %lld of %zu",
                            b->triangle_count, (long long)(int32_t)corners[c], b->point_count);
        st = cwi_build_corner(b, corners[c], err);
    }
    return st == CW_OK ? cwi_build_end_face(b, metadata, err) : st;
}

/* Cuts a quadrangle as FreeSurfer does: the number of its first vertex decides along which diagonal. */
static cw_status add_quadrangle(cwi_mesh_build *b, const cwi_tuples *t, size_t face,
                                cw_mesh_file *metadata, cw_error *err)
{
    static const size_t order[2][6] = {{0, 1, 3, 2, 3, 1}, {0, 1, 2, 0, 2, 3}};
    uint32_t corners[4], triangle[6];
    for (size_t c = 0; c < 4; c++) {
        corners[c] = 0;
        for (size_t n = 0; n < 3; n++)
            corners[c] = corners[c] << 8 | (uint32_t)cwi_tuples_real(t, face, 3 * c + n);
    }
    for (size_t c = 0; c < 6; c++)
        triangle[c] = corners[order[corners[0] % 2][c]];
    metadata->polygons++;
    cw_status st = add_triangle(b, triangle, metadata, err);
    return st == CW_OK ? add_triangle(b, triangle + 3, metadata, err) : st;
}

static cw_status read_faces(const surface *s, cwi_mesh_build *b, cw_mesh_file *metadata,
                            cw_error *err)
{
    const bool quads = s->magic != TRIANGLES;
    const uint64_t triangles = s->faces * (quads ? 2 : 1);
    cwi_tuples t = {0};
    cw_status st = cwi_mesh_limit_triangles(b->in, triangles, err);
    if (st == CW_OK)
        st = load_numbers(b->in, s->faces_at, quads ? CW_U8 : CW_U32, quads ? 12 : 3, s->faces,
                          &t, err);
    if (st == CW_OK)
        st = cwi_build_reserve(b, 0, triangles, err);
    for (size_t i = 0; i < t.count && st == CW_OK; i++) {
        uint32_t corners[3];
        for (size_t c = 0; c < 3 && !quads; c++)
            corners[c] = (uint32_t)cwi_tuples_real(&t, i, c);
        st = quads ? add_quadrangle(b, &t, i, metadata, err)
                   : add_triangle(b, corners, metadata, err);
    }
    drop_numbers(b->in, &t);
    return st;
}

/* --- the volume's geometry ---------------------------------------------------------------- */

/* Returns the start of the next line; NULL behind the last one. */
static const char *next_line(const char *line)
{
    const char *end = strchr(line, '\n');
    return end ? end + 1 : NULL;
}

/* Parses the numbers of the line "NAME = X Y Z". Returns false if they are not there. */
static bool find_numbers(const char *text, const char *name, int count, double *numbers)
{
    const size_t length = strlen(name);
    for (const char *line = text; line; line = next_line(line)) {
        const char *at = line + length;
        if (strncmp(line, name, length) != 0 || at[strspn(at, " ")] != '=')
            continue;
        at += strspn(at, " ") + 1;
        for (int n = 0; n < count; n++)
            if (!cwi_parse_double(&at, &numbers[n]))
                return false;
        return true;
    }
    return false;
}

/* Reads the text behind the corners. Returns false if none is there, if it says that it is not valid, or
 * if the surface is in the scanner's frame already. */
static cw_status find_geometry(const cwi_input *in, uint64_t at, char text[GEOMETRY_BYTES],
                               bool *found, cw_error *err)
{
    unsigned char *bytes = (unsigned char *)text;
    size_t size = 0, start = 0;
    double valid = 0;
    cw_status st = cwi_input_read_at(in->fd, at, bytes, GEOMETRY_BYTES - 1, &size, err);
    *found = false;
    if (st != CW_OK)
        return st;
    if (size >= 8 && get_number(bytes, 4) == USES_SCANNER) {
        if (get_number(bytes + 4, 4) == 1)
            return CW_OK;
        start = 8;
    }
    if (size < start + 4 || get_number(bytes + start, 4) != GEOMETRY)
        return CW_OK;
    memmove(text, text + start + 4, size - start - 4);
    text[size - start - 4] = '\0';
    *found = find_numbers(text, "valid", 1, &valid) && valid == 1;
    return CW_OK;
}

/* Moves points from the frame of tkregister to that of the scanner. The first has its centre in the middle
 * of the volume, and axes against x, along z and against y of it; so voxels' sizes do not count. */
static cw_status place_in_scanner(const surface *s, cwi_mesh_build *b, cw_mesh *mesh,
                                  cw_mesh_file *metadata, cw_error *err)
{
    char text[GEOMETRY_BYTES];
    double x[3], y[3], z[3], centre[3], m[3][4];
    bool found;
    cw_status st = find_geometry(&b->in->file, s->end, text, &found, err);
    if (st != CW_OK || !found)
        return st;
    if (!find_numbers(text, "xras", 3, x) || !find_numbers(text, "yras", 3, y) ||
        !find_numbers(text, "zras", 3, z) || !find_numbers(text, "cras", 3, centre))
        return cwi_fail(
            err, CW_ERR_FORMAT,
            "the geometry of the volume is cut off: lines xras, yras, zras and cras of "
            "three numbers each were expected");
    for (int r = 0; r < 3; r++) {
        m[r][0] = -x[r];
        m[r][1] = z[r];
        m[r][2] = -y[r];
        m[r][3] = centre[r];
    }
    return cwi_place_in_scanner(m, "c_ras", b, mesh, metadata, err);
}

cw_status cwi_freesurfer_read(cwi_mesh_input *in, cw_mesh *mesh, cw_mesh_file *metadata,
                              cw_error *err)
{
    cwi_mesh_build b = {.in = in};
    surface s;
    metadata->axes = (cw_axes){.unit = CW_UNIT_MM, .ras = true};
    metadata->known = CW_KNOWN_UNIT | CW_KNOWN_FRAME;
    cw_status st = read_sizes(&in->file, &s, err);
    if (st == CW_OK)
        st = read_points(&s, &b, err);
    if (st == CW_OK)
        st = read_faces(&s, &b, metadata, err);
    if (st == CW_OK)
        st = place_in_scanner(&s, &b, mesh, metadata, err);
    if (st == CW_OK)
        st = cwi_build_finish(&b, mesh, metadata, err);
    cwi_build_free(&b);
    return st;
}
