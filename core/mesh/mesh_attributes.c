/* The table of a mesh's attributes: allocates, copies, moves and mixes their elements. */
#include "core/mesh/mesh_attributes.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/point_triangle.h"
#include "core/mesh/mesh.h"
#include "core/mesh/mesh_triangle.h"

#include <string.h>

/* Rows of the arrays that each mesh has a pointer for. */
enum { NORMALS, SCALARS, COLORS, LABELS, FIXED };

static const cw_attribute fixed_rows[FIXED] = {
    {"normals", CW_ON_VERTICES, CW_F32, 3, CW_INTERPOLATE_DIRECTION, NULL},
    {"scalars", CW_ON_VERTICES, CW_F32, 1, CW_INTERPOLATE_LINEAR, NULL},
    {"colors", CW_ON_VERTICES, CW_U8, 4, CW_INTERPOLATE_COLOR, NULL},
    {"labels", CW_ON_VERTICES, CW_U32, 1, CW_INTERPOLATE_NEAREST, NULL},
};

enum { MAX_COMPONENTS = 16 };

size_t cwi_attribute_count(const cw_mesh *mesh)
{
    return FIXED + mesh->attribute_count;
}

cw_attribute cwi_attribute_at(const cw_mesh *mesh, size_t n)
{
    if (n >= FIXED)
        return mesh->attributes[n - FIXED];
    cw_attribute row = fixed_rows[n];
    row.data = n == NORMALS   ? (void *)mesh->normals
               : n == SCALARS ? (void *)mesh->scalars
               : n == COLORS  ? (void *)mesh->colors
                              : (void *)mesh->labels;
    return row;
}

static void set_data(cw_mesh *mesh, size_t n, void *data)
{
    if (n >= FIXED)
        mesh->attributes[n - FIXED].data = data;
    else if (n == NORMALS)
        mesh->normals = data;
    else if (n == SCALARS)
        mesh->scalars = data;
    else if (n == COLORS)
        mesh->colors = data;
    else
        mesh->labels = data;
}

static size_t type_bytes(cw_type type)
{
#define TYPE_SIZE(name, ctype, text) sizeof(ctype),
    static const size_t sizes[CW_TYPE_COUNT] = {CW_TYPE_TABLE(TYPE_SIZE)};
#undef TYPE_SIZE
    return sizes[type];
}

size_t cwi_attribute_bytes(const cw_attribute *attribute)
{
    return attribute->components * type_bytes(attribute->type);
}

size_t cwi_attribute_elements(const cw_mesh *mesh, cw_on on)
{
    return on == CW_ON_VERTICES    ? mesh->vertex_count
           : on == CW_ON_TRIANGLES ? mesh->triangle_count
           : on == CW_ON_CORNERS   ? 3 * mesh->triangle_count
                                   : 1;
}

bool cwi_mesh_one_color(const cw_mesh *mesh, uint8_t color[4])
{
    const uint8_t *colors = mesh->colors;
    if (!colors || !mesh->vertex_count)
        return false;
    /* every colour is that before it */
    if (mesh->vertex_count > 1 && memcmp(colors, colors + 4, 4 * (mesh->vertex_count - 1)) != 0)
        return false;
    memcpy(color, colors, 4);
    return true;
}

bool cwi_attributes_any(const cw_mesh *mesh, unsigned on)
{
    for (size_t n = 0; n < cwi_attribute_count(mesh); n++) {
        const cw_attribute row = cwi_attribute_at(mesh, n);
        if (row.data && on >> row.on & 1)
            return true;
    }
    return false;
}

/* --- arrays of a mesh --------------------------------------------------------------------- */

/* Makes the arrays that another mesh has. */
static bool make_arrays(const cw_mesh *like, cw_mesh *mesh, void *(*alloc)(size_t, size_t))
{
    bool ok = true;
    if (like->attribute_count) {
        mesh->attributes = cwi_alloc_array(like->attribute_count, sizeof *mesh->attributes);
        if (!mesh->attributes)
            return false;
        mesh->attribute_count = like->attribute_count;
        memcpy(mesh->attributes, like->attributes,
               like->attribute_count * sizeof *mesh->attributes);
    }
    for (size_t n = 0; n < cwi_attribute_count(like); n++) {
        const cw_attribute row = cwi_attribute_at(like, n);
        void *data =
            row.data ? alloc(cwi_attribute_elements(mesh, row.on), cwi_attribute_bytes(&row))
                     : NULL;
        if (data && row.on == CW_ON_PARTS)
            memcpy(data, row.data, cwi_attribute_bytes(&row));
        set_data(mesh, n, data);
        ok = ok && !data == !row.data;
    }
    return ok;
}

static void free_attributes(cw_mesh *mesh)
{
    for (size_t n = 0; n < cwi_attribute_count(mesh); n++) {
        cwi_free(cwi_attribute_at(mesh, n).data);
        set_data(mesh, n, NULL);
    }
    cwi_free(mesh->attributes);
    mesh->attributes = NULL;
    mesh->attribute_count = 0;
}

void cw_mesh_free(cw_mesh *mesh)
{
    if (!mesh)
        return;
    cwi_free(mesh->positions);
    cwi_free(mesh->triangles);
    free_attributes(mesh);
    memset(mesh, 0, sizeof *mesh);
}

cw_status cwi_attributes_alloc(const cw_mesh *like, cw_mesh *mesh, cw_error *err)
{
    if (make_arrays(like, mesh, cwi_alloc_zeroed))
        return CW_OK;
    cw_status st = cwi_fail_memory(err);
    cw_mesh_free(mesh);
    return st;
}

cw_status cwi_attributes_copy(const cw_mesh *from, cw_mesh *to, cw_error *err)
{
    if (!make_arrays(from, to, cwi_alloc_large)) {
        cw_status st = cwi_fail_memory(err);
        cw_mesh_free(to);
        return st;
    }
    for (size_t n = 0; n < cwi_attribute_count(from); n++) {
        const cw_attribute row = cwi_attribute_at(from, n), copy = cwi_attribute_at(to, n);
        const size_t bytes = cwi_attribute_elements(from, row.on) * cwi_attribute_bytes(&row);
        if (row.data && bytes)
            memcpy(copy.data, row.data, bytes);
    }
    return CW_OK;
}

/* --- elements ----------------------------------------------------------------------------- */

static void *element_at(const cw_attribute *row, size_t n)
{
    return (char *)row->data + n * cwi_attribute_bytes(row);
}

static void copy_element(const cw_attribute *from, size_t n, const cw_attribute *to, size_t m)
{
    memcpy(element_at(to, m), element_at(from, n), cwi_attribute_bytes(to));
}

static double load_number(const cw_attribute *row, size_t at)
{
    switch (row->type) {
#define LOAD(name, ctype, text)                                                                \
    case name:                                                                                 \
        return (double)((const ctype *)row->data)[at];
        CW_TYPE_TABLE(LOAD)
#undef LOAD
    default:
        return 0;
    }
}

/* Stores a number: rounded, and within the range of whole types. */
static void store_number(const cw_attribute *row, size_t at, double x)
{
    static const double limits[CW_TYPE_COUNT][2] = {
        [CW_U8] = {0, UINT8_MAX},         [CW_I8] = {INT8_MIN, INT8_MAX},
        [CW_U16] = {0, UINT16_MAX},       [CW_I16] = {INT16_MIN, INT16_MAX},
        [CW_U32] = {0, UINT32_MAX},       [CW_I32] = {INT32_MIN, INT32_MAX},
        [CW_F32] = {-INFINITY, INFINITY}, [CW_F64] = {-INFINITY, INFINITY},
    };
    if (row->type != CW_F32 && row->type != CW_F64)
        x = cwi_lesser(cwi_greater(floor(x + 0.5), limits[row->type][0]), limits[row->type][1]);
    switch (row->type) {
#define STORE(name, ctype, text)                                                               \
    case name:                                                                                 \
        ((ctype *)row->data)[at] = (ctype)x;                                                   \
        break;
        CW_TYPE_TABLE(STORE)
#undef STORE
    default:
        break;
    }
}

/* Returns the element with the largest weight; of equal ones the first. */
static size_t find_nearest(const size_t *elements, const double *weights, size_t count)
{
    size_t nearest = 0;
    for (size_t k = 1; k < count; k++)
        nearest = weights[k] > weights[nearest] ? k : nearest;
    return elements[nearest];
}

static void mix_elements(const cw_attribute *from, const size_t *elements,
                         const double *weights, size_t count, const cw_attribute *to, size_t m)
{
    const size_t components = from->components;
    const size_t nearest = find_nearest(elements, weights, count);
    double sum[MAX_COMPONENTS] = {0};
    if (from->interpolation == CW_INTERPOLATE_NEAREST) {
        copy_element(from, nearest, to, m);
        return;
    }
    for (size_t k = 0; k < count; k++)
        for (size_t c = 0; c < components && weights[k] != 0; c++)
            sum[c] += weights[k] * load_number(from, components * elements[k] + c);
    if (from->interpolation == CW_INTERPOLATE_DIRECTION) {
        double length_sq = 0;
        for (size_t c = 0; c < components; c++)
            length_sq += sum[c] * sum[c];
        if (!(length_sq > 0)) {
            copy_element(from, nearest, to, m);
            return;
        }
        for (size_t c = 0; c < components; c++)
            sum[c] /= sqrt(length_sq);
    }
    for (size_t c = 0; c < components; c++)
        store_number(to, components * m + c, sum[c]);
}

void cwi_attributes_put(const cw_mesh *from, size_t v, cw_mesh *to, size_t n)
{
    for (size_t i = 0; i < cwi_attribute_count(from); i++) {
        const cw_attribute row = cwi_attribute_at(from, i), into = cwi_attribute_at(to, i);
        if (row.data && into.data && row.on == CW_ON_VERTICES)
            copy_element(&row, v, &into, n);
    }
}

void cwi_attributes_mix(const cw_mesh *from, const uint32_t *vertices, const double *weights,
                        size_t count, cw_mesh *to, size_t n)
{
    size_t elements[3] = {0};
    for (size_t k = 0; k < count && k < 3; k++)
        elements[k] = vertices[k];
    for (size_t i = 0; i < cwi_attribute_count(from); i++) {
        const cw_attribute row = cwi_attribute_at(from, i), into = cwi_attribute_at(to, i);
        if (row.data && into.data && row.on == CW_ON_VERTICES)
            mix_elements(&row, elements, weights, count, &into, n);
    }
}

/* Sets the weights of a triangle's corners for a vertex of another mesh: 1 for the one that is it. */
static void find_weights(const cw_mesh *from, size_t t, uint32_t same, const float *point,
                         double weights[3])
{
    const double p[3] = {(double)point[0], (double)point[1], (double)point[2]};
    bool is_found = false;
    for (size_t k = 0; k < 3; k++) {
        weights[k] = !is_found && from->triangles[3 * t + k] == same;
        is_found = is_found || weights[k] > 0;
    }
    if (!is_found)
        cwi_facet_nearest(cwi_mesh_point(from, t, 0), cwi_mesh_point(from, t, 1),
                          cwi_mesh_point(from, t, 2), p, weights);
}

void cwi_attributes_put_corner(const cw_mesh *from, size_t t, uint32_t same, cw_mesh *to,
                               size_t c)
{
    const size_t corners[3] = {3 * t, 3 * t + 1, 3 * t + 2};
    for (size_t i = FIXED; i < cwi_attribute_count(from); i++) {
        const cw_attribute row = cwi_attribute_at(from, i), into = cwi_attribute_at(to, i);
        double weights[3];
        if (row.on != CW_ON_CORNERS)
            continue;
        find_weights(from, t, same, cwi_mesh_point(to, c / 3, c % 3), weights);
        mix_elements(&row, corners, weights, 3, &into, c);
    }
}

void cwi_attributes_put_triangle(const cw_mesh *from, size_t t, const uint32_t same[3],
                                 cw_mesh *to, size_t n)
{
    for (size_t i = FIXED; i < cwi_attribute_count(from); i++) {
        const cw_attribute row = cwi_attribute_at(from, i), into = cwi_attribute_at(to, i);
        if (row.on == CW_ON_TRIANGLES)
            copy_element(&row, t, &into, n);
    }
    for (size_t k = 0; k < 3; k++)
        cwi_attributes_put_corner(from, t, same[k], to, 3 * n + k);
}

/* --- in place ----------------------------------------------------------------------------- */

void cwi_mesh_move_vertices(cw_mesh *mesh, const uint32_t *number, size_t count)
{
    for (size_t v = 0; v < mesh->vertex_count; v++)
        if (number[v] != UINT32_MAX && number[v] != v)
            memcpy(mesh->positions + 3 * (size_t)number[v], mesh->positions + 3 * v,
                   3 * sizeof *mesh->positions);
    for (size_t n = 0; n < cwi_attribute_count(mesh); n++) {
        const cw_attribute row = cwi_attribute_at(mesh, n);
        for (size_t v = 0; v < mesh->vertex_count && row.data && row.on == CW_ON_VERTICES; v++)
            if (number[v] != UINT32_MAX && number[v] != v)
                copy_element(&row, v, &row, number[v]);
    }
    mesh->vertex_count = count;
}

void cwi_mesh_move_triangle(cw_mesh *mesh, size_t from, size_t to)
{
    if (from == to)
        return;
    memcpy(mesh->triangles + 3 * to, mesh->triangles + 3 * from, 3 * sizeof *mesh->triangles);
    for (size_t n = 0; n < mesh->attribute_count; n++) {
        const cw_attribute *row = &mesh->attributes[n];
        if (row->on == CW_ON_TRIANGLES)
            copy_element(row, from, row, to);
        for (size_t k = 0; k < 3 && row->on == CW_ON_CORNERS; k++)
            copy_element(row, 3 * from + k, row, 3 * to + k);
    }
}

void cwi_mesh_swap_corners(cw_mesh *mesh, size_t t, size_t i, size_t j)
{
    uint32_t *corners = mesh->triangles + 3 * t;
    const uint32_t vertex = corners[i];
    corners[i] = corners[j];
    corners[j] = vertex;
    for (size_t n = 0; n < mesh->attribute_count; n++) {
        const cw_attribute *row = &mesh->attributes[n];
        char kept[MAX_COMPONENTS * sizeof(double)];
        if (row->on != CW_ON_CORNERS)
            continue;
        memcpy(kept, element_at(row, 3 * t + i), cwi_attribute_bytes(row));
        copy_element(row, 3 * t + j, row, 3 * t + i);
        memcpy(element_at(row, 3 * t + j), kept, cwi_attribute_bytes(row));
    }
}

/* --- joined meshes ------------------------------------------------------------------------ */

static bool is_alike(const cw_attribute *a, const cw_attribute *b)
{
    return !strcmp(a->name, b->name) && a->on == b->on && a->type == b->type &&
           a->components == b->components && a->interpolation == b->interpolation;
}

/* Returns the row of a mesh with the name and type of another's; a row without data: it has none. */
static cw_attribute find_alike(const cw_mesh *mesh, const cw_attribute *like)
{
    for (size_t n = 0; n < cwi_attribute_count(mesh); n++) {
        const cw_attribute row = cwi_attribute_at(mesh, n);
        if (is_alike(&row, like))
            return row;
    }
    return (cw_attribute){.data = NULL};
}

static void drop_row(cw_mesh *mesh, size_t n)
{
    cwi_free(cwi_attribute_at(mesh, n).data);
    set_data(mesh, n, NULL);
    if (n < FIXED)
        return;
    mesh->attribute_count--;
    memmove(mesh->attributes + (n - FIXED), mesh->attributes + (n - FIXED) + 1,
            (mesh->attribute_count - (n - FIXED)) * sizeof *mesh->attributes);
}

/* Lengthens the rows by those of another mesh, and drops the others. */
static bool append_rows(cw_mesh *mesh, const cw_mesh *other)
{
    for (size_t n = cwi_attribute_count(mesh); n-- > 0;) {
        const cw_attribute row = cwi_attribute_at(mesh, n), more = find_alike(other, &row);
        const size_t size = cwi_attribute_bytes(&row),
                     before = cwi_attribute_elements(mesh, row.on),
                     added = cwi_attribute_elements(other, row.on);
        if (row.on == CW_ON_PARTS || !row.data)
            continue;
        if (!more.data) {
            drop_row(mesh, n);
            continue;
        }
        char *data = cwi_realloc_array(row.data, before + added, size);
        if (!data)
            return false;
        if (added)
            memcpy(data + before * size, more.data, added * size);
        set_data(mesh, n, data);
    }
    return true;
}

cw_status cwi_mesh_append(cw_mesh *mesh, const cw_mesh *other, cw_error *err)
{
    const size_t v = mesh->vertex_count, t = mesh->triangle_count,
                 vertices = v + other->vertex_count, triangles = t + other->triangle_count;
    if (vertices > UINT32_MAX)
        return cwi_fail(err, CW_ERR_LIMIT, "the result has %zu vertices; a mesh holds %u",
                        vertices, UINT32_MAX);
    float *points = cwi_realloc_array(mesh->positions, vertices, 3 * sizeof *points);
    mesh->positions = points ? points : mesh->positions;
    uint32_t *corners = cwi_realloc_array(mesh->triangles, triangles, 3 * sizeof *corners);
    mesh->triangles = corners ? corners : mesh->triangles;
    if (!points || !corners || !append_rows(mesh, other)) {
        cw_status st = cwi_fail_memory(err);
        cw_mesh_free(mesh);
        return st;
    }
    for (size_t n = 0; n < 3 * other->vertex_count; n++)
        points[3 * v + n] =
            (float)((double)other->positions[n] + (other->origin[n % 3] - mesh->origin[n % 3]));
    for (size_t n = 0; n < 3 * other->triangle_count; n++)
        corners[3 * t + n] = (uint32_t)v + other->triangles[n];
    mesh->vertex_count = vertices;
    mesh->triangle_count = triangles;
    return CW_OK;
}

/* --- public ------------------------------------------------------------------------------- */

static cw_status check_attribute(const cw_mesh *mesh, const cw_attribute *a, cw_error *err)
{
    if (!memchr(a->name, '\0', sizeof a->name) || !a->name[0])
        return cwi_fail(err, CW_ERR_ARGUMENT, "an attribute's name has 1 to %zu bytes",
                        sizeof a->name - 1);
    for (size_t n = 0; n < cwi_attribute_count(mesh); n++)
        if (!strcmp(cwi_attribute_at(mesh, n).name, a->name))
            return cwi_fail(err, CW_ERR_ARGUMENT, "attribute '%s': the name is in use",
                            a->name);
    if ((unsigned)a->on >= CW_ON_COUNT || (unsigned)a->type >= CW_TYPE_COUNT ||
        (unsigned)a->interpolation >= CW_INTERPOLATE_COUNT)
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "attribute '%s': on %d, type %d or interpolation %d does not exist",
                        a->name, (int)a->on, (int)a->type, (int)a->interpolation);
    if ((a->components < 1 || a->components > 4) && a->components != MAX_COMPONENTS)
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "attribute '%s' has %u components; 1 to 4 or %d were expected", a->name,
                        (unsigned)a->components, MAX_COMPONENTS);
    return CW_OK;
}

cw_status cw_mesh_attribute_add(cw_mesh *mesh, const cw_attribute *like, cw_attribute **out,
                                cw_error *err)
{
    CWI_REQUIRE(err, mesh, like);
    cw_status st = check_attribute(mesh, like, err);
    if (st != CW_OK)
        return st;
    cw_attribute made = *like;
    made.data =
        cwi_alloc_zeroed(cwi_attribute_elements(mesh, made.on), cwi_attribute_bytes(&made));
    cw_attribute *rows =
        cwi_realloc_array(mesh->attributes, mesh->attribute_count + 1, sizeof *rows);
    mesh->attributes = rows ? rows : mesh->attributes;
    if (!rows || !made.data) {
        cwi_free(made.data);
        return cwi_fail_memory(err);
    }
    rows[mesh->attribute_count++] = made;
    if (out)
        *out = &rows[mesh->attribute_count - 1];
    return CW_OK;
}

cw_attribute *cw_mesh_attribute_find(const cw_mesh *mesh, const char *name)
{
    for (size_t n = 0; mesh && name && n < mesh->attribute_count; n++)
        if (!strcmp(mesh->attributes[n].name, name))
            return &mesh->attributes[n];
    return NULL;
}

void cw_mesh_attribute_remove(cw_mesh *mesh, const char *name)
{
    const cw_attribute *found = cw_mesh_attribute_find(mesh, name);
    if (found)
        drop_row(mesh, FIXED + (size_t)(found - mesh->attributes));
}
