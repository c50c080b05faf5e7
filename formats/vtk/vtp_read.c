/* Reads VTK's XML PolyData: polygons and strips with the data of their points. The elements are
 * read first; then each needed array, one after another, by the reader of voxels. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "formats/cells/grid_arrays.h"
#include "formats/mesh/face_colors.h"
#include "formats/vtk/vtk_formats.h"
#include "formats/vtk/vtk_xml.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

enum { MAX_ELEMENTS = 10000 };

/* The arrays that are read. */
typedef enum role {
    POINTS,
    POLYGONS,     /* corners of polygons, one after another */
    POLYGON_ENDS, /* and the end of each polygon among them */
    STRIPS,
    STRIP_ENDS,
    NORMALS,
    COLORS,
    SCALARS,
    LABELS,
    CELL_COLORS, /* of CellData: vertices, lines, polygons, strips */
    ROLE_COUNT
} role;

typedef struct vtp {
    cwi_mesh_input *in;
    cw_mesh *mesh;
    cw_mesh_file *metadata;
    cwi_vtk_xml file;
    cwi_vtk_array arrays[ROLE_COUNT];
    bool has[ROLE_COUNT];
    cwi_vtk_array *open;                       /* the next tag ends its text; NULL: none */
    int64_t points, polygons, strips, skipped; /* skipped: vertices and lines */
    size_t pieces;
    char normals[CWI_WORD_BYTES], scalars[CWI_WORD_BYTES]; /* names stated by PointData */
    char cell_scalars[CWI_WORD_BYTES];                     /* name stated by CellData */
    bool ours;
    cwi_mesh_build build;
    cwi_tuples cell_colors; /* of all cells; empty: none */
    cwi_face_colors faces;
} vtp;

bool cwi_vtp_sniff(const unsigned char *head, size_t size, uint64_t file_size)
{
    (void)file_size;
    return cwi_vtk_xml_sniff(head, size, "PolyData");
}

/* --- elements ---------------------------------------------------------------------------- */

static cw_status start_file(void *user, cwi_xml *x, cwi_attributes a, cw_error *err)
{
    static const char *const kind[2] = {"PolyData", "a surface"};
    (void)x;
    return cwi_vtk_xml_file(&((vtp *)user)->file, a, kind, err);
}

static cw_status start_piece(void *user, cwi_xml *x, cwi_attributes a, cw_error *err)
{
    vtp *v = user;
    int64_t skipped[2] = {0};
    (void)x;
    if (v->pieces++)
        return cwi_fail(err, CW_ERR_FORMAT,
                        "the file has several Piece elements; files of one are read");
    const struct {
        const char *name;
        int64_t *count;
    } counts[] = {{"NumberOfPoints", &v->points},
                  {"NumberOfPolys", &v->polygons},
                  {"NumberOfStrips", &v->strips},
                  {"NumberOfVerts", &skipped[0]},
                  {"NumberOfLines", &skipped[1]}};
    cw_status st = CW_OK;
    for (size_t i = 0; i < sizeof counts / sizeof *counts && st == CW_OK; i++)
        st = cwi_vtk_xml_integer(a, counts[i].name, 0, INT64_MAX / 4, counts[i].count, err);
    v->skipped = skipped[0] + skipped[1];
    v->metadata->skipped = (size_t)v->skipped;
    return st;
}

static cw_status start_point_data(void *user, cwi_xml *x, cwi_attributes a, cw_error *err)
{
    vtp *v = user;
    const char *normals = cwi_attribute(a, "Normals"), *scalars = cwi_attribute(a, "Scalars");
    (void)x, (void)err;
    snprintf(v->normals, sizeof v->normals, "%s", normals ? normals : "");
    snprintf(v->scalars, sizeof v->scalars, "%s", scalars ? scalars : "");
    return CW_OK;
}

static cw_status start_cell_data(void *user, cwi_xml *x, cwi_attributes a, cw_error *err)
{
    vtp *v = user;
    const char *scalars = cwi_attribute(a, "Scalars");
    (void)x, (void)err;
    snprintf(v->cell_scalars, sizeof v->cell_scalars, "%s", scalars ? scalars : "");
    return CW_OK;
}

/* Keeps the first array of a role; of arrays in PointData the named one. */
static cw_status keep_array(vtp *v, cwi_xml *x, role r, const cwi_vtk_array *array, bool named)
{
    if (v->has[r] && !named)
        return CW_OK;
    v->has[r] = true;
    v->arrays[r] = *array;
    v->arrays[r].start = v->arrays[r].end = cwi_xml_tag_end(x);
    v->open = &v->arrays[r];
    return CW_OK;
}

/* Keeps an array of Points, Polys or Strips. */
static cw_status keep_structure(vtp *v, cwi_xml *x, cwi_attributes a, role first, role ends,
                                cw_error *err)
{
    cwi_vtk_array array;
    cw_status st = cwi_vtk_xml_array(&array, a, err);
    const bool is_end = first != POINTS && strcmp(array.name, "offsets") == 0;
    const size_t expected = first == POINTS ? 3 : 1;
    if (st != CW_OK || (first != POINTS && !is_end && strcmp(array.name, "connectivity") != 0))
        return st;
    if (!array.is_known || array.components != expected ||
        (first != POINTS && (array.type == CW_F32 || array.type == CW_F64)))
        return cwi_fail(err, CW_ERR_FORMAT,
                        "the array '%s' has %zu numbers of type '%s'; %zu %s expected",
                        array.name, array.components, array.type_name, expected,
                        first == POINTS ? "were" : "whole one was");
    return keep_array(v, x, is_end ? ends : first, &array, false);
}

static cw_status start_points(void *user, cwi_xml *x, cwi_attributes a, cw_error *err)
{
    return keep_structure(user, x, a, POINTS, POINTS, err);
}

static cw_status start_polygons(void *user, cwi_xml *x, cwi_attributes a, cw_error *err)
{
    return keep_structure(user, x, a, POLYGONS, POLYGON_ENDS, err);
}

static cw_status start_strips(void *user, cwi_xml *x, cwi_attributes a, cw_error *err)
{
    return keep_structure(user, x, a, STRIPS, STRIP_ENDS, err);
}

/* Returns the role of an array of PointData; ROLE_COUNT: none. */
static role role_of(const cwi_vtk_array *array)
{
    const bool real = array->type == CW_F32 || array->type == CW_F64;
    if (!array->is_known)
        return ROLE_COUNT;
    if (array->type == CW_U8 && (array->components == 3 || array->components == 4))
        return COLORS;
    if (array->components == 3 && real)
        return NORMALS;
    if (array->components == 1 && !real && strcmp(array->name, "label") == 0)
        return LABELS;
    return array->components == 1 ? SCALARS : ROLE_COUNT;
}

static cw_status start_point_array(void *user, cwi_xml *x, cwi_attributes a, cw_error *err)
{
    vtp *v = user;
    cwi_vtk_array array;
    cw_status st = cwi_vtk_xml_array(&array, a, err);
    if (st != CW_OK)
        return st;
    const role r = role_of(&array);
    const char *expected = r == NORMALS ? v->normals : v->scalars;
    const bool named = *expected && strcmp(array.name, expected) == 0;
    if (r == ROLE_COUNT || (r == NORMALS && !named && strcmp(array.name, "Normals") != 0))
        return CW_OK;
    return keep_array(v, x, r, &array, named);
}

static cw_status start_cell_array(void *user, cwi_xml *x, cwi_attributes a, cw_error *err)
{
    vtp *v = user;
    cwi_vtk_array array;
    cw_status st = cwi_vtk_xml_array(&array, a, err);
    if (st != CW_OK || role_of(&array) != COLORS)
        return st;
    const bool named = *v->cell_scalars && strcmp(array.name, v->cell_scalars) == 0;
    return keep_array(v, x, CELL_COLORS, &array, named);
}

static cw_status start_appended(void *user, cwi_xml *x, cwi_attributes a, cw_error *err)
{
    vtp *v = user;
    v->file.appended = cwi_xml_tag_end(x);
    cwi_xml_stop(x);
    return cwi_vtk_xml_appended(&v->file, a, err);
}

static cw_status end_text(void *user, cwi_xml *x, cw_error *err)
{
    vtp *v = user;
    (void)err;
    if (v->open && cwi_xml_tag_start(x) > v->open->start)
        v->open->end = cwi_xml_tag_start(x);
    v->open = NULL;
    return CW_OK;
}

static cw_status take_comment(void *user, const char *text, cw_error *err)
{
    vtp *v = user;
    (void)err;
    cwi_take_comment(text + strspn(text, " "), &v->ours, v->mesh, v->metadata);
    return CW_OK;
}

typedef enum element {
    E_FILE,
    E_DATA,
    E_PIECE,
    E_POINT_DATA,
    E_POINT_ARRAY,
    E_CELL_DATA,
    E_CELL_ARRAY,
    E_POINTS,
    E_POINTS_ARRAY,
    E_POLYS,
    E_POLYS_ARRAY,
    E_STRIPS,
    E_STRIPS_ARRAY,
    E_APPENDED,
    ELEMENT_COUNT
} element;

static const cwi_xml_element elements[ELEMENT_COUNT] = {
    [E_FILE] = {"VTKFile", CWI_XML_ROOT, start_file, NULL},
    [E_DATA] = {"PolyData", E_FILE, NULL, NULL},
    [E_PIECE] = {"Piece", E_DATA, start_piece, NULL},
    [E_POINT_DATA] = {"PointData", E_PIECE, start_point_data, NULL},
    [E_POINT_ARRAY] = {"DataArray", E_POINT_DATA, start_point_array, NULL},
    [E_CELL_DATA] = {"CellData", E_PIECE, start_cell_data, NULL},
    [E_CELL_ARRAY] = {"DataArray", E_CELL_DATA, start_cell_array, NULL},
    [E_POINTS] = {"Points", E_PIECE, NULL, NULL},
    [E_POINTS_ARRAY] = {"DataArray", E_POINTS, start_points, NULL},
    [E_POLYS] = {"Polys", E_PIECE, NULL, NULL},
    [E_POLYS_ARRAY] = {"DataArray", E_POLYS, start_polygons, NULL},
    [E_STRIPS] = {"Strips", E_PIECE, NULL, NULL},
    [E_STRIPS_ARRAY] = {"DataArray", E_STRIPS, start_strips, NULL},
    [E_APPENDED] = {"AppendedData", E_FILE, start_appended, NULL},
};

static const cwi_xml_rules rules = {.elements = elements,
                                    .element_count = ELEMENT_COUNT,
                                    .max_elements = MAX_ELEMENTS,
                                    .tag = end_text,
                                    .comment = take_comment};

/* --- numbers ----------------------------------------------------------------------------- */

static void drop_tuples(vtp *v, cwi_tuples *t)
{
    v->in->bytes -= t->bytes;
    cwi_tuples_free(t);
}

/* Reads an array of `count` tuples; field: name of the count in the file. */
static cw_status load_tuples(vtp *v, role r, const char *field, uint64_t count, cwi_tuples *t,
                             cw_error *err)
{
    const cwi_input *file = &v->in->file;
    const cw_read_desc desc = {.progress = v->in->desc.progress};
    cwi_source src;
    bool wide;
    *t = (cwi_tuples){.count = 0};
    if (count == 0)
        return CW_OK;
    cw_status st = cwi_vtk_xml_tuples(&v->file, v->has[r] ? &v->arrays[r] : NULL, field,
                                      (size_t)count, file, &src, &wide, err);
    if (st == CW_OK)
        st = cwi_mesh_take_bytes(v->in, src.bytes, err);
    return st == CW_OK ? cwi_tuples_load(&src, file, &desc, wide, t, err) : st;
}

/* --- the mesh ---------------------------------------------------------------------------- */

static cw_status read_points(vtp *v, cw_error *err)
{
    cwi_tuples n;
    cw_status st = load_tuples(v, POINTS, "NumberOfPoints", (uint64_t)v->points, &n, err);
    if (st == CW_OK)
        st = cwi_build_reserve(&v->build, n.count, 0, err);
    for (size_t i = 0; i < n.count && st == CW_OK; i++) {
        double point[3];
        for (size_t a = 0; a < 3; a++)
            point[a] = cwi_tuples_real(&n, i, a);
        st = cwi_build_point(&v->build, point, err);
    }
    drop_tuples(v, &n);
    return st;
}

static float to_single(double number)
{
    return fabs(number) <= (double)FLT_MAX ? (float)number : NAN;
}

/* Reads an array of PointData into one of the mesh, which has `size` elements per vertex. */
static cw_status read_attribute(vtp *v, role r, void *array, size_t size, cw_error *err)
{
    cwi_tuples n;
    size_t capacity = 0;
    void *to;
    if (!v->has[r] || v->points == 0)
        return CW_OK;
    cw_status st = load_tuples(v, r, "NumberOfPoints", (uint64_t)v->points, &n, err);
    if (st == CW_OK)
        st = cwi_mesh_grow(v->in, array, &capacity, n.count, size, err);
    memcpy(&to, array, sizeof to);
    const size_t given = v->arrays[r].components;
    for (size_t i = 0; i < n.count && st == CW_OK; i++)
        for (size_t c = 0; c < (r == NORMALS ? 3 : r == COLORS ? 4 : 1); c++) {
            const double number = r == COLORS && c >= given ? 255 : cwi_tuples_real(&n, i, c);
            if (r == COLORS)
                ((uint8_t *)to)[4 * i + c] = (uint8_t)number;
            else if (r == LABELS)
                ((uint32_t *)to)[i] = number > 0 ? (uint32_t)fmin(number, UINT32_MAX) : 0;
            else
                ((float *)to)[(r == NORMALS ? 3 * i : i) + c] = to_single(number);
        }
    drop_tuples(v, &n);
    return st;
}

/* Adds the corners of one polygon, or of one strip, whose triangles have alternating
 * winding. */
static cw_status add_corners(vtp *v, const cwi_tuples *corners, size_t from, size_t to,
                             bool strip, cw_error *err)
{
    cw_status st = CW_OK;
    if (!strip) {
        for (size_t i = from; i < to && st == CW_OK; i++)
            st = cwi_build_corner(&v->build, cwi_tuples_whole(corners, i), err);
        return st == CW_OK ? cwi_build_end_face(&v->build, v->metadata, err) : st;
    }
    for (size_t i = from; i + 2 < to && st == CW_OK; i++) {
        const size_t odd = (i - from) % 2;
        const size_t order[3] = {i, i + 1 + odd, i + 2 - odd};
        for (int c = 0; c < 3 && st == CW_OK; c++)
            st = cwi_build_corner(&v->build, cwi_tuples_whole(corners, order[c]), err);
        v->build.corners = 0;
    }
    return st;
}

/* Reads the colours of cells. */
static cw_status read_cell_colors(vtp *v, cw_error *err)
{
    const int64_t cells = v->skipped + v->polygons + v->strips;
    return v->has[CELL_COLORS]
               ? load_tuples(v, CELL_COLORS, "cells", (uint64_t)cells, &v->cell_colors, err)
               : CW_OK;
}

/* Gives the triangles of the last cell its colour. */
static cw_status color_cell(vtp *v, size_t cell, cw_error *err)
{
    uint8_t color[4] = {255, 255, 255, 255};
    if (!v->cell_colors.count)
        return CW_OK;
    for (size_t c = 0; c < v->arrays[CELL_COLORS].components; c++)
        color[c] = (uint8_t)cwi_tuples_real(&v->cell_colors, cell, c);
    return cwi_color_faces(&v->faces, v->build.triangle_count, color, err);
}

/* Checks the ends: they must not decrease; the last one is the number of corners. */
static cw_status check_ends(const cwi_tuples *ends, const char *field, cw_error *err)
{
    int64_t before = 0;
    for (size_t i = 0; i < ends->count; i++) {
        const int64_t end = cwi_tuples_whole(ends, i);
        if (end < before)
            return cwi_fail(err, CW_ERR_FORMAT,
                            "'offsets' says that number %zu of '%s' ends at %lld, behind %lld",
                            i, field, (long long)end, (long long)before);
        before = end;
    }
    return CW_OK;
}

static cw_status read_faces(vtp *v, role first, const char *field, int64_t count, cw_error *err)
{
    const bool strip = first == STRIPS;
    const size_t before = (size_t)(v->skipped + (strip ? v->polygons : 0)); /* cells */
    cwi_tuples ends = {0}, corners = {0};
    cw_status st = load_tuples(v, first + 1, field, (uint64_t)count, &ends, err);
    if (st == CW_OK)
        st = check_ends(&ends, field, err);
    if (st == CW_OK && ends.count)
        st = load_tuples(v, first, "offsets", (uint64_t)cwi_tuples_whole(&ends, ends.count - 1),
                         &corners, err);
    if (st == CW_OK && corners.count > 2 * ends.count)
        st = cwi_build_reserve(&v->build, 0,
                               v->build.triangle_count + corners.count - 2 * ends.count, err);
    for (size_t i = 0, from = 0; i < ends.count && st == CW_OK; i++) {
        const size_t to = (size_t)cwi_tuples_whole(&ends, i);
        st = add_corners(v, &corners, from, to, strip, err);
        if (st == CW_OK)
            st = color_cell(v, before + i, err);
        from = to;
    }
    drop_tuples(v, &ends);
    drop_tuples(v, &corners);
    return st;
}

static cw_status read_arrays(vtp *v, cw_error *err)
{
    cw_status st = read_points(v, err);
    if (st == CW_OK)
        st = read_attribute(v, NORMALS, &v->mesh->normals, 3 * sizeof(float), err);
    if (st == CW_OK)
        st = read_attribute(v, COLORS, &v->mesh->colors, 4, err);
    if (st == CW_OK)
        st = read_attribute(v, SCALARS, &v->mesh->scalars, sizeof(float), err);
    if (st == CW_OK)
        st = read_attribute(v, LABELS, &v->mesh->labels, sizeof(uint32_t), err);
    if (st == CW_OK)
        st = read_cell_colors(v, err);
    if (st == CW_OK)
        st = read_faces(v, POLYGONS, "NumberOfPolys", v->polygons, err);
    if (st == CW_OK)
        st = read_faces(v, STRIPS, "NumberOfStrips", v->strips, err);
    drop_tuples(v, &v->cell_colors);
    if (st == CW_OK)
        st = cwi_build_finish(&v->build, v->mesh, v->metadata, err);
    return st == CW_OK ? cwi_color_mesh(&v->faces, false, v->mesh, err) : st;
}

cw_status cwi_vtp_read(cwi_mesh_input *in, cw_mesh *mesh, cw_mesh_file *metadata, cw_error *err)
{
    vtp *v = cwi_alloc_zeroed(1, sizeof *v);
    if (!v)
        return cwi_fail_memory(err);
    v->in = v->build.in = v->faces.in = in;
    v->mesh = mesh;
    v->metadata = metadata;
    cw_status st = cwi_xml_read_file(&rules, v, &in->file, err);
    if (st == CW_OK)
        st = cwi_vtk_xml_find_appended(&in->file, &v->file, err);
    if (st == CW_OK && !v->pieces)
        st = cwi_fail(err, CW_ERR_FORMAT, "PolyData holds no Piece");
    if (st == CW_OK)
        st = read_arrays(v, err);
    cwi_build_free(&v->build);
    cwi_face_colors_free(&v->faces);
    cwi_free(v);
    return st;
}
