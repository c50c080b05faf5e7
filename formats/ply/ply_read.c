/* Reads PLY: text or binary of either byte order, elements and properties in any order. */
#include "formats/ply/ply.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "formats/mesh/face_colors.h"
#include "formats/ply/ply_format.h"

#include <float.h>
#include <math.h>
#include <string.h>

typedef struct ply {
    cwi_ply_header header;
    cwi_mesh_build build;
    cwi_face_colors faces;
    bool has[CWI_PLY_NOTHING + 1]; /* roles of the properties of 'vertex' that exist */
} ply;

bool cwi_ply_sniff(const unsigned char *head, size_t size, uint64_t file_size)
{
    (void)file_size;
    return size > 4 && (memcmp(head, "ply\n", 4) == 0 || memcmp(head, "ply\r", 4) == 0);
}

/* --- numbers ----------------------------------------------------------------------------- */

static double decode_number(const unsigned char *b, cwi_ply_type type, bool big_endian)
{
    const size_t size = cwi_ply_type_size(type);
    uint64_t bits = 0;
    for (size_t i = 0; i < size; i++)
        bits = bits << 8 | b[big_endian ? i : size - 1 - i];
    const uint32_t bits32 = (uint32_t)bits;
    float single;
    double number;
    switch (type) {
    case CWI_PLY_I8:
        return (int8_t)bits;
    case CWI_PLY_I16:
        return (int16_t)bits;
    case CWI_PLY_I32:
        return (int32_t)bits;
    case CWI_PLY_F32:
        memcpy(&single, &bits32, sizeof single);
        return (double)single;
    case CWI_PLY_F64:
        memcpy(&number, &bits, sizeof number);
        return number;
    default:
        return (double)bits;
    }
}

static cw_status read_number(const ply *p, cwi_scan *s, const cwi_ply_element *e,
                             cwi_ply_type type, double *number, cw_error *err)
{
    const unsigned char *bytes;
    if (p->header.text)
        return cwi_scan_double(s, e->what, number, err);
    cw_status st = cwi_scan_take(s, cwi_ply_type_size(type), e->what, &bytes, err);
    if (st == CW_OK)
        *number = decode_number(bytes, type, p->header.big_endian);
    return st;
}

/* Reads a whole number; text may contain 2.5 where the header states int. */
static cw_status read_whole(const ply *p, cwi_scan *s, const cwi_ply_element *e,
                            cwi_ply_type type, int64_t *whole, cw_error *err)
{
    double number = 0;
    cw_status st = read_number(p, s, e, type, &number, err);
    if (st == CW_OK && (!(fabs(number) < 1e15) || number != floor(number)))
        return cwi_fail(err, CW_ERR_FORMAT,
                        "element '%s' holds %g where a whole number belongs", e->name, number);
    if (st == CW_OK)
        *whole = (int64_t)number;
    return st;
}

/* --- elements ---------------------------------------------------------------------------- */

/* Reads a list of corners, or a list whose numbers are ignored. */
static cw_status read_list(ply *p, cwi_scan *s, const cwi_ply_element *e,
                           const cwi_ply_property *property, cw_mesh_file *metadata,
                           cw_error *err)
{
    int64_t count = 0, corner = 0;
    double number;
    const bool is_face = property->role == CWI_PLY_INDICES;
    cw_status st = read_whole(p, s, e, property->count_type, &count, err);
    if (st == CW_OK && count < 0)
        return cwi_fail(err, CW_ERR_FORMAT, "element '%s' has a list of %lld numbers", e->name,
                        (long long)count);
    for (int64_t i = 0; st == CW_OK && i < count; i++) {
        if (!is_face) {
            st = read_number(p, s, e, property->type, &number, err);
            continue;
        }
        st = read_whole(p, s, e, property->type, &corner, err);
        if (st == CW_OK)
            st = cwi_build_corner(&p->build, corner, err);
    }
    if (st == CW_OK && is_face)
        st = cwi_build_end_face(&p->build, metadata, err);
    return st;
}

/* Converts a number to a colour: whole numbers are fractions of their type's maximum, others of
 * 1. */
static uint8_t to_color(double number, cwi_ply_type type)
{
    const double largest[CWI_PLY_TYPE_COUNT] = {127,        255,        32767, 65535,
                                                2147483647, 4294967295, 1,     1};
    const double value = number * (255 / largest[type]);
    return value > 0 ? (uint8_t)lround(fmin(value, 255)) : 0;
}

static float to_single(double number)
{
    return fabs(number) <= (double)FLT_MAX ? (float)number
                                           : (float)copysign((double)INFINITY, number);
}

/* Stores one property of vertex v; requested ones have an array. */
static void store_property(cw_mesh *mesh, size_t v, double point[3],
                           const cwi_ply_property *property, double number)
{
    const int role = (int)property->role;
    if (role <= CWI_PLY_Z)
        point[role] = number;
    else if (role <= CWI_PLY_NZ && mesh->normals)
        mesh->normals[3 * v + (size_t)(role - CWI_PLY_NX)] = to_single(number);
    else if (role >= CWI_PLY_RED && role <= CWI_PLY_ALPHA && mesh->colors)
        mesh->colors[4 * v + (size_t)(role - CWI_PLY_RED)] = to_color(number, property->type);
    else if (role == CWI_PLY_SCALAR)
        mesh->scalars[v] = isnan(number) ? NAN : to_single(number);
    else if (role == CWI_PLY_LABEL)
        mesh->labels[v] = number > 0 ? (uint32_t)fmin(number, UINT32_MAX) : 0;
}

static bool has_face_colors(const ply *p)
{
    return p->has[CWI_PLY_FACE_RED] && p->has[CWI_PLY_FACE_GREEN] && p->has[CWI_PLY_FACE_BLUE];
}

static cw_status read_element(ply *p, cwi_scan *s, const cwi_ply_element *e, bool is_vertex,
                              cw_mesh *mesh, cw_mesh_file *metadata, cw_error *err)
{
    const size_t v = p->build.point_count;
    double point[3] = {0}, number = 0;
    uint8_t color[4] = {255, 255, 255, 255}; /* of a face */
    cw_status st = CW_OK;
    for (size_t i = e->first; st == CW_OK && i < e->end; i++) {
        const cwi_ply_property *property = &p->header.properties[i];
        if (property->is_list) {
            st = read_list(p, s, e, property, metadata, err);
            continue;
        }
        st = read_number(p, s, e, property->type, &number, err);
        if (st == CW_OK && is_vertex)
            store_property(mesh, v, point, property, number);
        else if (property->role >= CWI_PLY_FACE_RED && property->role <= CWI_PLY_FACE_ALPHA)
            color[property->role - CWI_PLY_FACE_RED] = to_color(number, property->type);
    }
    if (st == CW_OK && has_face_colors(p)) /* of the triangles that this element adds */
        st = cwi_color_faces(&p->faces, p->build.triangle_count, color, err);
    return st == CW_OK && is_vertex ? cwi_build_point(&p->build, point, err) : st;
}

static cw_status read_elements(ply *p, cwi_scan *s, cw_mesh *mesh, cw_mesh_file *metadata,
                               cw_error *err)
{
    cw_status st = CW_OK;
    for (size_t i = 0; i < p->header.element_count; i++) {
        const cwi_ply_element *e = &p->header.elements[i];
        const bool is_vertex = strcmp(e->name, "vertex") == 0;
        for (uint64_t n = 0; st == CW_OK && n < e->count; n++)
            st = read_element(p, s, e, is_vertex, mesh, metadata, err);
    }
    return st;
}

/* --- room -------------------------------------------------------------------------------- */

static const cwi_ply_element *find_element(const cwi_ply_header *h, const char *name)
{
    for (size_t i = 0; i < h->element_count; i++)
        if (strcmp(h->elements[i].name, name) == 0)
            return &h->elements[i];
    return NULL;
}

static bool is_color(cwi_ply_role role)
{
    return (role >= CWI_PLY_RED && role <= CWI_PLY_ALPHA) ||
           (role >= CWI_PLY_FACE_RED && role <= CWI_PLY_FACE_ALPHA);
}

/* Finds the roles, each at most once: arrays have one place for each. */
static cw_status find_roles(ply *p, cw_error *err)
{
    cwi_ply_header *h = &p->header;
    for (size_t i = 0; i < h->property_count; i++) {
        cwi_ply_role role = h->properties[i].role;
        if (is_color(role) && p->has[role]) /* under another name: the first counts */
            role = h->properties[i].role = CWI_PLY_NOTHING;
        if (role != CWI_PLY_NOTHING && p->has[role])
            return cwi_fail(err, CW_ERR_FORMAT,
                            "an element or a property of it is there twice in the header");
        p->has[role] = true;
    }
    if (!(p->has[CWI_PLY_X] && p->has[CWI_PLY_Y] && p->has[CWI_PLY_Z]))
        return cwi_fail(err, CW_ERR_FORMAT, "element 'vertex' has no properties x, y and z");
    const cwi_ply_element *face = find_element(h, "face");
    if (face && face->count && !p->has[CWI_PLY_INDICES])
        return cwi_fail(err, CW_ERR_FORMAT, "element 'face' has no list 'vertex_indices'");
    return CW_OK;
}

static cw_status ensure_vertex_capacity(ply *p, cw_mesh *mesh, size_t count, cw_error *err)
{
    cwi_mesh_input *in = p->build.in;
    size_t normals = 0, colors = 0, scalars = 0, labels = 0;
    const bool *has = p->has;
    cw_status st = cwi_build_reserve(&p->build, count, 0, err);
    if (st == CW_OK && has[CWI_PLY_NX] && has[CWI_PLY_NY] && has[CWI_PLY_NZ])
        st = cwi_mesh_grow(in, &mesh->normals, &normals, count, 3 * sizeof(float), err);
    if (st == CW_OK && has[CWI_PLY_RED] && has[CWI_PLY_GREEN] && has[CWI_PLY_BLUE])
        st = cwi_mesh_grow(in, &mesh->colors, &colors, count, 4, err);
    if (st == CW_OK && mesh->colors)
        memset(mesh->colors, 255, 4 * count); /* alpha may be left out */
    if (st == CW_OK && has[CWI_PLY_SCALAR])
        st = cwi_mesh_grow(in, &mesh->scalars, &scalars, count, sizeof(float), err);
    if (st == CW_OK && has[CWI_PLY_LABEL])
        st = cwi_mesh_grow(in, &mesh->labels, &labels, count, sizeof(uint32_t), err);
    return st;
}

/* Reserves room for triangular faces with one-byte numbers, if the file is long enough for
 * them. Lists that are empty in truth must not have taken more memory than the file's size. */
static cw_status ensure_capacity(ply *p, cw_mesh *mesh, uint64_t file_size, cw_error *err)
{
    const cwi_ply_element *vertex = find_element(&p->header, "vertex");
    const cwi_ply_element *face = find_element(&p->header, "face");
    const uint64_t max = file_size / 4;
    cw_status st = ensure_vertex_capacity(p, mesh, (size_t)vertex->count, err);
    if (st == CW_OK && face)
        st = cwi_build_reserve(&p->build, 0, face->count < max ? face->count : max, err);
    return st;
}

static cw_status read_body(ply *p, cw_mesh *mesh, cw_mesh_file *metadata, cw_error *err)
{
    cwi_mesh_input *in = p->build.in;
    cwi_scan s = {0};
    cw_status st = ensure_capacity(p, mesh, in->file.size, err);
    if (st == CW_OK)
        st = p->header.text
                 ? cwi_scan_open_text(&s, &in->file, p->header.body, &in->desc.progress, err)
                 : cwi_scan_open(&s, &in->file, p->header.body, &in->desc.progress, err);
    s.line = p->header.lines + 1;
    if (st == CW_OK)
        st = read_elements(p, &s, mesh, metadata, err);
    if (st == CW_OK)
        st = cwi_build_finish(&p->build, mesh, metadata, err);
    if (st == CW_OK)
        st = cwi_color_mesh(&p->faces, false, mesh, err);
    cwi_scan_close(&s);
    return st;
}

cw_status cwi_ply_read(cwi_mesh_input *in, cw_mesh *mesh, cw_mesh_file *metadata, cw_error *err)
{
    ply *p = cwi_alloc_zeroed(1, sizeof *p);
    if (!p)
        return cwi_fail_memory(err);
    p->build.in = p->faces.in = in;
    cw_status st = cwi_ply_parse(&in->file, &p->header, metadata, err);
    if (st == CW_OK)
        st = find_roles(p, err);
    memcpy(mesh->origin, p->header.origin, sizeof mesh->origin);
    if (st == CW_OK)
        st = read_body(p, mesh, metadata, err);
    cwi_build_free(&p->build);
    cwi_face_colors_free(&p->faces);
    cwi_free(p);
    return st;
}
