/* Attributes of a result: each triangle is part of one of an input, and has what that one has there. */
#include "simplify/boolean/boolean_state.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/mesh/mesh_attributes.h"
#include "core/mesh/mesh_triangle.h"

#include <math.h>
#include <string.h>

static const char INPUT_NAME[] = "input";

/* The inputs with one table of attributes: each has a row for what any has. */
typedef struct sources {
    const cw_mesh *const *meshes;
    size_t count;
    cw_mesh *tables; /* copies of the structs, with positions in the frame of the result */
    size_t *first;   /* count + 1: the number of the first triangle of each */
    bool has_normals;
} sources;

/* The fixed arrays come first in the table, in this order. */
static void set_fixed(cw_mesh *mesh, size_t n, void *data)
{
    if (n == 1)
        mesh->scalars = data;
    else if (n == 2)
        mesh->colors = data;
    else if (n == 3)
        mesh->labels = data;
}

/* Returns the mesh's own values for a row of the table, or NULL. */
static void *find_values(const cw_mesh *mesh, const cw_attribute *row)
{
    const cw_attribute *own = cw_mesh_attribute_find(mesh, row->name);
    return own && own->on == row->on && own->type == row->type &&
                   own->components == row->components
               ? own->data
               : NULL;
}

/* Allocates values that a mesh lacks: 0, or white where they are colours. */
static void *make_values(const cw_mesh *mesh, const cw_attribute *row)
{
    const size_t bytes = cwi_attribute_bytes(row),
                 count = cwi_attribute_elements(mesh, row->on);
    void *data = cwi_alloc_zeroed(count ? count : 1, bytes);
    if (data && row->interpolation == CW_INTERPOLATE_COLOR && row->type == CW_U8)
        memset(data, 255, count * bytes);
    return data;
}

/* Copies a mesh's values, or makes those that it lacks. */
static void *take_values(const cw_mesh *mesh, const cw_attribute *row, const void *own)
{
    void *data = make_values(mesh, row);
    if (data && own)
        memcpy(data, own, cwi_attribute_bytes(row) * cwi_attribute_elements(mesh, row->on));
    return data;
}

/* Adds the fixed arrays that any mesh has to the table of mesh n. */
static bool add_fixed(sources *s, size_t n)
{
    const size_t fixed = cwi_attribute_count(s->meshes[n]) - s->meshes[n]->attribute_count;
    for (size_t i = 1; i < fixed; i++) { /* normals are computed in the end */
        bool wanted = false;
        for (size_t m = 0; m < s->count; m++)
            wanted |= cwi_attribute_at(s->meshes[m], i).data != NULL;
        const cw_attribute row = cwi_attribute_at(s->meshes[n], i);
        void *data = wanted ? take_values(s->meshes[n], &row, row.data) : NULL;
        if (wanted && !data)
            return false;
        set_fixed(&s->tables[n], i, data);
    }
    return true;
}

/* Adds the further attributes of all meshes, in their order, to the table of mesh n. */
static cw_status add_rows(sources *s, size_t n, cw_error *err)
{
    cw_mesh *table = &s->tables[n];
    for (size_t m = 0; m < s->count; m++)
        for (size_t i = 0; i < s->meshes[m]->attribute_count; i++) {
            const cw_attribute *row = &s->meshes[m]->attributes[i];
            if (strcmp(row->name, INPUT_NAME) == 0 || cw_mesh_attribute_find(table, row->name))
                continue;
            cw_attribute *out;
            const cw_status st = cw_mesh_attribute_add(table, row, &out, err);
            if (st != CW_OK)
                return st;
            const void *own = find_values(s->meshes[n], row);
            void *data = take_values(s->meshes[n], row, own);
            if (!data)
                return cwi_fail_memory(err);
            cwi_free(out->data);
            out->data = data;
        }
    return CW_OK;
}

static bool add_positions(sources *s, size_t n)
{
    const cw_mesh *mesh = s->meshes[n];
    float *positions = cwi_alloc_array(mesh->vertex_count, 3 * sizeof *positions);
    s->tables[n].positions = positions;
    for (size_t i = 0; i < 3 * mesh->vertex_count && positions; i++) {
        const double shift = mesh->origin[i % 3] - s->meshes[0]->origin[i % 3];
        positions[i] = (float)((double)mesh->positions[i] + shift);
    }
    return positions;
}

static cw_status make_tables(sources *s, cw_error *err)
{
    s->tables = cwi_alloc_zeroed(s->count, sizeof *s->tables);
    s->first = cwi_alloc_array(s->count + 1, sizeof *s->first);
    if (!s->tables || !s->first)
        return cwi_fail_memory(err);
    s->first[0] = 0;
    for (size_t n = 0; n < s->count; n++) {
        const cw_mesh *mesh = s->meshes[n];
        cw_mesh *table = &s->tables[n];
        s->first[n + 1] = s->first[n] + mesh->triangle_count;
        s->has_normals |= mesh->normals != NULL;
        memcpy(table->origin, s->meshes[0]->origin, sizeof table->origin);
        table->vertex_count = mesh->vertex_count;
        table->triangle_count = mesh->triangle_count;
        table->triangles = mesh->triangles; /* borrowed */
        if (!add_positions(s, n) || !add_fixed(s, n))
            return cwi_fail_memory(err);
        const cw_status st = add_rows(s, n, err);
        if (st != CW_OK)
            return st;
    }
    return CW_OK;
}

static void free_tables(sources *s)
{
    for (size_t n = 0; n < s->count && s->tables; n++) {
        s->tables[n].triangles = NULL;
        cw_mesh_free(&s->tables[n]);
    }
    cwi_free(s->tables);
    cwi_free(s->first);
}

/* --- elements ----------------------------------------------------------------------------- */

static size_t find_input(const sources *s, size_t triangle)
{
    size_t low = 0, high = s->count;
    while (low + 1 < high) {
        const size_t middle = (low + high) / 2;
        if (s->first[middle] <= triangle)
            low = middle;
        else
            high = middle;
    }
    return low;
}

/* Finds the corners of a triangle's source that its own corners are; UINT32_MAX: none. */
static void find_same(const cw_mesh *from, size_t source, const cw_mesh *to, size_t t,
                      uint32_t same[3])
{
    for (size_t k = 0; k < 3; k++) {
        const float *p = to->positions + 3 * (size_t)to->triangles[3 * t + k];
        same[k] = UINT32_MAX;
        for (size_t i = 0; i < 3 && same[k] == UINT32_MAX; i++) {
            const uint32_t v = from->triangles[3 * source + i];
            const float *q = from->positions + 3 * (size_t)v;
            if (p[0] == q[0] && p[1] == q[1] && p[2] == q[2])
                same[k] = v;
        }
    }
}

/* Gives a vertex what the source has there: `weights` of its corners are areas over its own. */
static void put_vertex(const cw_mesh *from, size_t source, uint32_t same, cw_mesh *to,
                       uint32_t v)
{
    if (same != UINT32_MAX) {
        cwi_attributes_put(from, same, to, v);
        return;
    }
    double p[3], corner[3][3], whole[3], weights[3], sum = 0;
    for (size_t k = 0; k < 3; k++) {
        p[k] = (double)to->positions[3 * (size_t)v + k];
        cwi_mesh_corner(from, source, (int)k, corner[k]);
    }
    cwi_triangle_normal(corner[0], corner[1], corner[2], whole);
    for (int k = 0; k < 3; k++) {
        double part[3];
        cwi_triangle_normal(p, corner[(k + 1) % 3], corner[(k + 2) % 3], part);
        weights[k] = fmax(cwi_dot(part, whole), 0);
        sum += weights[k];
    }
    for (int k = 0; k < 3; k++)
        weights[k] = sum > 0 ? weights[k] / sum : 1.0 / 3;
    cwi_attributes_mix(from, from->triangles + 3 * source, weights, 3, to, v);
}

static void put_elements(const sources *s, const cwi_sheets *sheets, cw_mesh *out, bool *seen)
{
    cw_attribute *input = cw_mesh_attribute_find(out, INPUT_NAME);
    for (size_t t = 0; t < out->triangle_count; t++) {
        const size_t n = find_input(s, sheets->sources[t]);
        const size_t source = sheets->sources[t] - s->first[n];
        uint32_t same[3];
        find_same(&s->tables[n], source, out, t, same);
        cwi_attributes_put_triangle(&s->tables[n], source, same, out, t);
        for (size_t k = 0; k < 3; k++) {
            const uint32_t v = out->triangles[3 * t + k];
            if (!seen[v])
                put_vertex(&s->tables[n], source, same[k], out, v);
            seen[v] = true;
        }
        if (input)
            ((uint32_t *)input->data)[t] = (uint32_t)n;
    }
}

cw_status cwi_carry_attributes(const cw_mesh *const *meshes, size_t count,
                               const cwi_sheets *sheets, cw_mesh *out, cw_error *err)
{
    sources s = {.meshes = meshes, .count = count};
    const cw_attribute input = {"input", CW_ON_TRIANGLES,        CW_U32,
                                1,       CW_INTERPOLATE_NEAREST, NULL};
    bool *seen = NULL;
    cw_status st = make_tables(&s, err);
    if (st == CW_OK)
        st = cwi_attributes_alloc(&s.tables[0], out, err);
    if (st == CW_OK && count > 1)
        st = cw_mesh_attribute_add(out, &input, NULL, err);
    if (st == CW_OK) {
        seen = cwi_alloc_zeroed(out->vertex_count, sizeof *seen);
        st = seen ? CW_OK : cwi_fail_memory(err);
    }
    if (st == CW_OK)
        put_elements(&s, sheets, out, seen);
    if (st == CW_OK && s.has_normals)
        st = cw_mesh_normals(out, err);
    cwi_free(seen);
    free_tables(&s);
    return st;
}
