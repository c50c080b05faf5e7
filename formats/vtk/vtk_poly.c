/* Reads surfaces of legacy VTK files: DATASET POLYDATA, with polygons and strips, and the scalars of
 * points. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "formats/cells/grid_arrays.h"
#include "formats/vtk/vtk.h"
#include "formats/vtk/vtk_formats.h"

#include <float.h>
#include <math.h>
#include <string.h>
#include <strings.h>

enum { POLYGONS, STRIPS, LINES, VERTICES, FACE_KINDS };

static const char *const face_names[FACE_KINDS] = {"polygons", "triangle_strips", "lines",
                                                   "vertices"};

typedef struct surface {
    cwi_vtk file;
    cwi_mesh_input *in;
    cwi_mesh_build build;
    cw_mesh *mesh;
    cw_mesh_file *metadata;
    cwi_vtk_row points;
    cwi_vtk_cells faces[FACE_KINDS];
} surface;

/* Finds "DATASET POLYDATA" at the start of a line. */
bool cwi_vtk_poly_sniff(const unsigned char *head, size_t size, uint64_t file_size)
{
    static const char keyword[] = "dataset", kind[] = "polydata";
    (void)file_size;
    if (!cwi_vtk_sniff(head, size))
        return false;
    for (size_t i = 0; i + sizeof keyword + sizeof kind - 1 < size; i++) {
        const char *text = (const char *)head + i;
        if (text[0] != '\n' || strncasecmp(text + 1, keyword, sizeof keyword - 1) != 0)
            continue;
        text += sizeof keyword;
        while (text < (const char *)head + size && (*text == ' ' || *text == '\t'))
            text++;
        return (size_t)((const char *)head + size - text) >= sizeof kind - 1 &&
               strncasecmp(text, kind, sizeof kind - 1) == 0;
    }
    return false;
}

/* --- sections ----------------------------------------------------------------------------- */

static bool is_keyword(const cwi_vtk *v, const char *name)
{
    const size_t length = strcspn(v->line, " \t");
    return strlen(name) == length && strncasecmp(v->line, name, length) == 0;
}

static cw_status read_dataset(const cwi_vtk *v, cw_error *err)
{
    if (strcasecmp(cwi_vtk_value(v), "POLYDATA") == 0)
        return CW_OK;
    return cwi_fail(
        err, CW_ERR_FORMAT,
        "'DATASET' is %.40s, a volume (vtk), not a mesh; 'extract' makes a mesh of it",
        cwi_vtk_value(v));
}

/* Reads "POINT_DATA n" or "CELL_DATA n": the places of the arrays that follow. */
static cw_status start_data(surface *s, cw_error *err)
{
    cwi_vtk *v = &s->file;
    const bool points = is_keyword(v, "point_data");
    const char *field = points ? "POINT_DATA" : "CELL_DATA";
    int64_t count = 0;
    size_t expected = points ? s->points.count : 0;
    for (int k = 0; k < FACE_KINDS && !points; k++)
        expected += s->faces[k].count;
    cw_status st = cwi_field_integer(field, cwi_vtk_value(v), 0, INT64_MAX, &count, err);
    v->best = points ? &v->points : &v->cells;
    v->count = (size_t)count;
    return st == CW_OK && v->count != expected
               ? cwi_fail(err, CW_ERR_FORMAT, "'%s' is %zu; the surface has %zu", field,
                          v->count, expected)
               : st;
}

static cw_status read_section(surface *s, cw_error *err)
{
    cwi_vtk *v = &s->file;
    bool known;
    for (int k = 0; k < FACE_KINDS; k++)
        if (is_keyword(v, face_names[k])) {
            cw_status st = cwi_vtk_cell_corners(v, err);
            s->faces[k] = v->grid;
            return st;
        }
    if (is_keyword(v, "points")) {
        cw_status st = cwi_vtk_points(v, err);
        s->points = v->grid.points;
        return st;
    }
    if (is_keyword(v, "point_data") || is_keyword(v, "cell_data"))
        return start_data(s, err);
    cw_status st = cwi_vtk_section(v, &known, err);
    return st == CW_OK && !known
               ? cwi_fail(err, CW_ERR_FORMAT, "line %zu, '%.40s', starts nothing that is known",
                          v->number, v->line)
               : st;
}

static cw_status read_sections(surface *s, cw_error *err)
{
    cwi_vtk *v = &s->file;
    bool more = true, has_dataset = false;
    cw_status st = cwi_vtk_start(v, err);
    while (st == CW_OK) {
        st = cwi_vtk_full_line(v, &more, err);
        if (st != CW_OK || !more)
            break;
        if (has_dataset) {
            st = read_section(s, err);
        } else if (is_keyword(v, "dataset")) {
            st = read_dataset(v, err);
            has_dataset = true;
        } else {
            st = cwi_vtk_section(v, &more, err);
        }
    }
    return st == CW_OK && !has_dataset ? cwi_fail(err, CW_ERR_FORMAT, "'DATASET' is missing")
                                       : st;
}

/* --- numbers ------------------------------------------------------------------------------ */

static void drop_tuples(surface *s, cwi_tuples *t)
{
    s->in->bytes -= t->bytes;
    cwi_tuples_free(t);
}

static cw_status load_row(surface *s, const cwi_vtk_row *row, const char *field,
                          size_t components, size_t count, cwi_tuples *t, cw_error *err)
{
    const cw_read_desc desc = {.progress = s->in->desc.progress};
    cwi_source src = {0};
    bool wide;
    *t = (cwi_tuples){.count = 0};
    if (count == 0)
        return CW_OK;
    cw_status st = cwi_vtk_describe(&s->file, row, field, components, count, &src, &wide, err);
    if (st == CW_OK)
        st = cwi_mesh_take_bytes(s->in, src.bytes, err);
    return st == CW_OK ? cwi_tuples_load(&src, &s->in->file, &desc, wide, t, err) : st;
}

static cw_status read_points(surface *s, cw_error *err)
{
    cwi_tuples n;
    cw_status st = load_row(s, &s->points, "POINTS", 3, s->points.count, &n, err);
    if (st == CW_OK)
        st = cwi_build_reserve(&s->build, n.count, 0, err);
    for (size_t i = 0; i < n.count && st == CW_OK; i++) {
        double point[3];
        for (size_t a = 0; a < 3; a++)
            point[a] = cwi_tuples_real(&n, i, a);
        st = cwi_build_point(&s->build, point, err);
    }
    drop_tuples(s, &n);
    return st;
}

/* Reads the best array of points as scalars, if it has one value each. */
static cw_status read_scalars(surface *s, cw_error *err)
{
    const cwi_legacy_array *array = &s->file.points;
    const cwi_vtk_row row = {
        .type = array->type, .count = s->points.count, .offset = array->offset};
    cwi_tuples n;
    size_t capacity = 0;
    if (array->rank == CWI_VTK_NONE || array->components != 1 || s->points.count == 0)
        return CW_OK;
    cw_status st = load_row(s, &row, array->name, 1, s->points.count, &n, err);
    if (st == CW_OK)
        st = cwi_mesh_grow(s->in, &s->mesh->scalars, &capacity, n.count, sizeof(float), err);
    for (size_t i = 0; i < n.count && st == CW_OK; i++) {
        const double number = cwi_tuples_real(&n, i, 0);
        s->mesh->scalars[i] = fabs(number) <= (double)FLT_MAX ? (float)number : NAN;
    }
    drop_tuples(s, &n);
    return st;
}

/* Adds a polygon, or a strip, whose triangles have alternating winding. */
static cw_status add_face(surface *s, const cwi_tuples *corners, size_t from, size_t to,
                          bool is_strip, cw_error *err)
{
    cw_status st = CW_OK;
    for (size_t i = from; i < to && st == CW_OK && !is_strip; i++)
        st = cwi_build_corner(&s->build, cwi_tuples_whole(corners, i), err);
    if (st == CW_OK && !is_strip)
        return cwi_build_end_face(&s->build, s->metadata, err);
    for (size_t i = from; i + 2 < to && st == CW_OK; i++) {
        const size_t odd = (i - from) % 2;
        const size_t order[3] = {i, i + 1 + odd, i + 2 - odd};
        for (int c = 0; c < 3 && st == CW_OK; c++)
            st = cwi_build_corner(&s->build, cwi_tuples_whole(corners, order[c]), err);
        s->build.corners = 0;
    }
    return st;
}

/* Finds where a face ends: behind its count in a list, or by the ends. */
static cw_status find_end(const cwi_vtk_cells *g, const char *name, const cwi_tuples *corners,
                          const cwi_tuples *ends, size_t face, size_t *from, size_t *to,
                          cw_error *err)
{
    int64_t end = -1;
    if (g->listed && *from < corners->count) {
        const int64_t count = cwi_tuples_whole(corners, (*from)++);
        end = count >= 0 && count <= INT32_MAX ? (int64_t)*from + count : -1;
    } else if (!g->listed) {
        end = cwi_tuples_whole(ends, face);
    }
    if (end < (int64_t)*from || end > (int64_t)corners->count)
        return cwi_fail(err, CW_ERR_FORMAT,
                        "number %zu of '%s' ends beyond the %zu numbers of the section", face,
                        name, corners->count);
    *to = (size_t)end;
    return CW_OK;
}

static cw_status read_faces(surface *s, int kind, cw_error *err)
{
    const cwi_vtk_cells *g = &s->faces[kind];
    const char *name = kind == STRIPS ? "TRIANGLE_STRIPS" : "POLYGONS";
    cwi_tuples ends = {0}, corners = {0};
    size_t numbers = g->listed;
    cw_status st = CW_OK;
    if (!g->listed)
        st = load_row(s, &g->ends, "OFFSETS", 1, g->count, &ends, err);
    if (st == CW_OK && !g->listed && ends.count) {
        const int64_t last = cwi_tuples_whole(&ends, ends.count - 1);
        numbers = last > 0 ? (size_t)last : 0;
    }
    if (st == CW_OK)
        st = load_row(s, &g->corners, name, 1, numbers, &corners, err);
    for (size_t face = 0, from = 0, to; face < g->count && st == CW_OK; face++, from = to) {
        to = from;
        st = find_end(g, name, &corners, &ends, face, &from, &to, err);
        if (st == CW_OK)
            st = add_face(s, &corners, from, to, kind == STRIPS, err);
    }
    drop_tuples(s, &ends);
    drop_tuples(s, &corners);
    return st;
}

cw_status cwi_vtk_poly_read(cwi_mesh_input *in, cw_mesh *mesh, cw_mesh_file *metadata,
                            cw_error *err)
{
    surface *s = cwi_alloc_zeroed(1, sizeof *s);
    if (!s)
        return cwi_fail_memory(err);
    s->in = s->build.in = in;
    s->mesh = mesh;
    s->metadata = metadata;
    s->file.in = &in->file;
    s->file.to_end = true;
    cw_status st = read_sections(s, err);
    if (st == CW_OK)
        st = read_points(s, err);
    if (st == CW_OK)
        st = read_scalars(s, err);
    if (st == CW_OK)
        st = read_faces(s, POLYGONS, err);
    if (st == CW_OK)
        st = read_faces(s, STRIPS, err);
    metadata->skipped += s->faces[LINES].count + s->faces[VERTICES].count;
    if (st == CW_OK)
        st = cwi_build_finish(&s->build, mesh, metadata, err);
    cwi_build_free(&s->build);
    cwi_free(s);
    return st;
}
