/* Reads GIfTI surfaces: points and triangles, with scalars, labels and colours of the vertices that
 * are in the same file. */
#include "formats/gifti/gifti.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "formats/cells/grid_arrays.h"
#include "formats/gifti/gifti_format.h"
#include "formats/mesh/scanner_frame.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

bool cwi_gifti_sniff(const unsigned char *head, size_t size, uint64_t file_size)
{
    char text[CWI_SNIFF_BYTES + 1];
    (void)file_size;
    memcpy(text, head, size);
    text[size] = '\0';
    return text[strspn(text, " \t\r\n\xef\xbb\xbf")] == '<' &&
           (strstr(text, "<GIFTI") || strstr(text, "<!DOCTYPE GIFTI"));
}

typedef struct reading {
    cwi_mesh_input *in;
    cwi_gifti *g;
    cwi_mesh_build build;
    cw_mesh *mesh;
} reading;

/* --- numbers ----------------------------------------------------------------------------- */

/* Checks an array's sizes before memory is taken. */
static cw_status check_sizes(const cwi_gifti_array *a, size_t count, size_t low, size_t high,
                             cw_error *err)
{
    if (a->components < low || a->components > high)
        return cwi_fail(err, CW_ERR_FORMAT, "'Dim1' of %s is %zu; %zu was expected", a->intent,
                        a->components, high);
    if (count != SIZE_MAX && a->count != count)
        return cwi_fail(err, CW_ERR_FORMAT, "'Dim0' of %s is %zu; there are %zu vertices",
                        a->intent, a->count, count);
    return CW_OK;
}

static cw_status describe(const cwi_gifti_array *a, cwi_source *src, cw_error *err)
{
    const cwi_axis rows[] = {{CWI_AXIS_COMPONENT, a->components}, {CWI_AXIS_X, a->count}};
    const cwi_axis columns[] = {{CWI_AXIS_X, a->count}, {CWI_AXIS_COMPONENT, a->components}};
    *src = (cwi_source){.size_field = "Dim0, Dim1",
                        .noun = "numbers",
                        .shape = {.slope = 1, .type = a->type},
                        .stored = a->ascii ? CWI_STORED_PLAIN : a->stored,
                        .encoding = a->ascii      ? CWI_ASCII
                                    : a->deflated ? CWI_DEFLATED
                                                  : CWI_RAW,
                        .base64 = a->base64,
                        .big_endian = a->big_endian,
                        .offset = *a->file ? a->offset : a->start,
                        .span = *a->file ? 0 : a->end - a->start};
    cw_status st = cwi_source_set_axes(src, a->columns ? columns : rows, 2, err);
    return st == CW_OK && *a->file ? cwi_names_add(&src->files, a->file, err) : st;
}

/* Reads an array. An empty one has no numbers in the file. */
static cw_status load_array(reading *r, cwi_gifti_role role, cwi_tuples *t, cw_error *err)
{
    const cwi_gifti_array *a = &r->g->arrays[role];
    const cw_read_desc desc = {.progress = r->in->desc.progress};
    cwi_source src;
    *t = (cwi_tuples){.count = 0};
    if (a->count == 0)
        return CW_OK;
    if (!*a->file && a->start == a->end)
        return cwi_fail(err, CW_ERR_FORMAT, "the array %s has no Data", a->intent);
    cw_status st = describe(a, &src, err);
    if (st == CW_OK)
        st = cwi_mesh_take_bytes(r->in, src.bytes, err);
    if (st == CW_OK)
        st = cwi_tuples_load(&src, &r->in->file, &desc, false, t, err);
    cwi_source_free(&src);
    return st == CW_OK ? st : cwi_fail_in(err, st, a->intent);
}

static void drop_array(reading *r, cwi_tuples *t)
{
    r->in->bytes -= t->bytes;
    cwi_tuples_free(t);
}

/* --- surface ----------------------------------------------------------------------------- */

static cw_status read_points(reading *r, cw_error *err)
{
    cwi_tuples t = {0};
    cw_status st = check_sizes(&r->g->arrays[CWI_GIFTI_POINTS], SIZE_MAX, 3, 3, err);
    if (st == CW_OK)
        st = load_array(r, CWI_GIFTI_POINTS, &t, err);
    if (st == CW_OK)
        st = cwi_build_reserve(&r->build, t.count, 0, err);
    for (size_t i = 0; i < t.count && st == CW_OK; i++) {
        double point[3];
        for (size_t a = 0; a < 3; a++)
            point[a] = cwi_tuples_real(&t, i, a);
        st = cwi_build_point(&r->build, point, err);
    }
    drop_array(r, &t);
    return st;
}

static cw_status read_triangles(reading *r, cw_mesh_file *metadata, cw_error *err)
{
    cwi_tuples t = {0};
    cw_status st = check_sizes(&r->g->arrays[CWI_GIFTI_TRIANGLES], SIZE_MAX, 3, 3, err);
    if (st == CW_OK)
        st = cwi_mesh_limit_triangles(r->in, r->g->arrays[CWI_GIFTI_TRIANGLES].count, err);
    if (st == CW_OK)
        st = load_array(r, CWI_GIFTI_TRIANGLES, &t, err);
    if (st == CW_OK)
        st = cwi_build_reserve(&r->build, 0, t.count, err);
    for (size_t i = 0; i < t.count && st == CW_OK; i++) {
        for (size_t c = 0; c < 3 && st == CW_OK; c++) {
            const double corner = cwi_tuples_real(&t, i, c);
            const bool whole = corner >= 0 && corner < (double)r->build.point_count;
            if (!whole || corner != floor(corner))
                st = cwi_fail(err, CW_ERR_FORMAT, "triangle %zu names vertex %g of %zu", i,
                              corner, r->build.point_count);
            else
                st = cwi_build_corner(&r->build, (int64_t)corner, err);
        }
        if (st == CW_OK)
            st = cwi_build_end_face(&r->build, metadata, err);
    }
    drop_array(r, &t);
    return st;
}

/* --- vertices ---------------------------------------------------------------------------- */

static float to_single(double number)
{
    return fabs(number) <= (double)FLT_MAX ? (float)number : NAN;
}

/* Gives a vertex the colour of its label; without one, or if that is invisible, white. */
static void put_label_color(const reading *r, uint32_t value, uint8_t to[4])
{
    const cw_label *label = cw_label_find(&r->g->labels, 0, value);
    const bool shown = label && label->has_color && label->color[3] > 0;
    memset(to, 255, 4);
    if (shown)
        memcpy(to, label->color, 4);
}

static void put_vertex(const reading *r, cwi_gifti_role role, const cwi_tuples *t, size_t v)
{
    cw_mesh *m = r->mesh;
    const double number = cwi_tuples_real(t, v, 0);
    if (role == CWI_GIFTI_SCALARS)
        m->scalars[v] = to_single(number);
    if (role == CWI_GIFTI_LABELS) {
        m->labels[v] = number > 0 ? (uint32_t)fmin(number, UINT32_MAX) : 0;
        if (m->colors && !r->g->has[CWI_GIFTI_COLORS])
            put_label_color(r, m->labels[v], m->colors + 4 * v);
    }
    if (role != CWI_GIFTI_COLORS)
        return;
    const double scale = r->g->arrays[role].type == CW_U8 ? 1 : 255;
    for (size_t c = 0; c < 4; c++) {
        const double part = c < t->components ? scale * cwi_tuples_real(t, v, c) : 255;
        m->colors[4 * v + c] = (uint8_t)lround(part > 0 ? fmin(part, 255) : 0);
    }
}

/* Takes memory for what an array tells of vertices. Labels are also colours. */
static cw_status grow_vertices(reading *r, cwi_gifti_role role, size_t count, cw_error *err)
{
    cw_mesh *m = r->mesh;
    size_t capacity = 0;
    if (role == CWI_GIFTI_SCALARS)
        return cwi_mesh_grow(r->in, &m->scalars, &capacity, count, sizeof *m->scalars, err);
    cw_status st = CW_OK;
    if (role == CWI_GIFTI_LABELS)
        st = cwi_mesh_grow(r->in, &m->labels, &capacity, count, sizeof *m->labels, err);
    capacity = 0;
    const bool colored = role == CWI_GIFTI_COLORS || r->g->labels.count > 0;
    return st == CW_OK && colored && !m->colors
               ? cwi_mesh_grow(r->in, &m->colors, &capacity, count, 4, err)
               : st;
}

static cw_status read_vertices(reading *r, cwi_gifti_role role, cw_error *err)
{
    const size_t count = r->build.point_count;
    const size_t low = role == CWI_GIFTI_COLORS ? 3 : 1,
                 high = role == CWI_GIFTI_COLORS ? 4 : 1;
    cwi_tuples t = {0};
    if (!r->g->has[role] || count == 0)
        return CW_OK;
    cw_status st = check_sizes(&r->g->arrays[role], count, low, high, err);
    if (st == CW_OK)
        st = load_array(r, role, &t, err);
    if (st == CW_OK)
        st = grow_vertices(r, role, count, err);
    for (size_t v = 0; v < t.count && st == CW_OK; v++)
        put_vertex(r, role, &t, v);
    drop_array(r, &t);
    return st;
}

/* --- the file ----------------------------------------------------------------------------- */

/* Refuses files that are about a surface but hold none. */
static cw_status check_surface(const cwi_gifti *g, cw_error *err)
{
    static const struct {
        const char *intent, *what;
    } rows[] = {
        {"NIFTI_INTENT_LABEL", "labels of vertices, as in a .label.gii"},
        {"NIFTI_INTENT_SHAPE", "values of vertices, as in a .shape.gii"},
        {"NIFTI_INTENT_TIME_SERIES", "values over time, as in a .func.gii"},
        {"NIFTI_INTENT_NONE", "values of vertices, as in a .func.gii"},
    };
    const bool points = g->has[CWI_GIFTI_POINTS], triangles = g->has[CWI_GIFTI_TRIANGLES];
    const char *what = "not points and triangles";
    if (points && triangles)
        return CW_OK;
    if (points || triangles)
        return cwi_fail(err, CW_ERR_FORMAT,
                        "the file holds %s and no %s of a surface; a .surf.gii holds both",
                        points ? "NIFTI_INTENT_POINTSET" : "NIFTI_INTENT_TRIANGLE",
                        points ? "triangles (NIFTI_INTENT_TRIANGLE)"
                               : "points (NIFTI_INTENT_POINTSET)");
    if (g->count == 0)
        return cwi_fail(err, CW_ERR_FORMAT, "the file holds no DataArray");
    for (size_t n = 0; n < sizeof rows / sizeof *rows; n++)
        if (strcmp(rows[n].intent, g->first) == 0)
            what = rows[n].what;
    return cwi_fail(
        err, CW_ERR_FORMAT,
        "the file holds no surface: its first array is %.40s, %s; the surface is in a "
        ".surf.gii",
        g->first, what);
}

static void say_left_out(const cwi_gifti *g, cw_mesh_file *metadata)
{
    char text[100];
    snprintf(text, sizeof text, "arrays of the file: %zu, such as %.40s", g->others, g->other);
    cwi_say_left_out(metadata, g->others > 0, text);
    cwi_say_left_out(metadata, g->more > 0, "further surfaces");
    cwi_say_left_out(metadata, g->has[CWI_GIFTI_LABELS] && g->labels.count > 0,
                     "names of labels");
    cwi_say_left_out(metadata, g->has_centre && !g->has_matrix,
                     "the shift to the scanner (VolGeomC)");
}

static cw_status read_surface(reading *r, cw_mesh_file *metadata, cw_error *err)
{
    cw_status st = read_points(r, err);
    if (st == CW_OK)
        st = read_triangles(r, metadata, err);
    if (st == CW_OK)
        st = read_vertices(r, CWI_GIFTI_SCALARS, err);
    if (st == CW_OK)
        st = read_vertices(r, CWI_GIFTI_COLORS, err);
    if (st == CW_OK)
        st = read_vertices(r, CWI_GIFTI_LABELS, err);
    if (st == CW_OK && r->g->has_matrix)
        st =
            cwi_place_in_scanner(r->g->matrix, "MatrixData", &r->build, r->mesh, metadata, err);
    return st == CW_OK ? cwi_build_finish(&r->build, r->mesh, metadata, err) : st;
}

cw_status cwi_gifti_read(cwi_mesh_input *in, cw_mesh *mesh, cw_mesh_file *metadata,
                         cw_error *err)
{
    cwi_gifti g = {0};
    reading r = {.in = in, .g = &g, .mesh = mesh, .build = {.in = in}};
    metadata->axes = (cw_axes){.unit = CW_UNIT_MM, .ras = true};
    metadata->known = CW_KNOWN_UNIT | CW_KNOWN_FRAME;
    cw_status st = cwi_gifti_parse(&g, &in->file, err);
    if (st == CW_OK)
        st = check_surface(&g, err);
    if (st == CW_OK)
        st = read_surface(&r, metadata, err);
    if (st == CW_OK)
        say_left_out(&g, metadata);
    cwi_build_free(&r.build);
    cwi_gifti_free(&g);
    return st;
}
