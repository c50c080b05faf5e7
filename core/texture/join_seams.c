/* Joins vertices that were split at the seams of a texture. */
#include "core/texture/join_seams.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/mesh/mesh_attributes.h"
#include "core/texture/split_seams.h"

#include <stdlib.h>
#include <string.h>

enum { MAX_ROWS = 16 };

/* The arrays that vertices are compared by. */
typedef struct comparison {
    const cw_mesh *mesh;
    const uint32_t *groups;
    const char *arrays[MAX_ROWS];
    size_t bytes[MAX_ROWS], count;
} comparison;

/* A vertex, with a hash of its place. */
typedef struct hashed_vertex {
    const comparison *c;
    uint64_t hash;
    uint32_t vertex;
} hashed_vertex;

static int compare_attributes(const comparison *c, size_t v, size_t w)
{
    if (c->groups[v] != c->groups[w])
        return c->groups[v] < c->groups[w] ? -1 : 1;
    int order =
        memcmp(c->mesh->positions + 3 * v, c->mesh->positions + 3 * w, 3 * sizeof(float));
    for (size_t n = 0; n < c->count && order == 0; n++)
        order =
            memcmp(c->arrays[n] + c->bytes[n] * v, c->arrays[n] + c->bytes[n] * w, c->bytes[n]);
    return order;
}

static int compare_vertices(const void *a, const void *b)
{
    const hashed_vertex *v = a, *w = b;
    if (v->hash != w->hash)
        return v->hash < w->hash ? -1 : 1;
    const int order = compare_attributes(v->c, v->vertex, w->vertex);
    return order ? order : (v->vertex > w->vertex) - (v->vertex < w->vertex);
}

static uint64_t hash_place(const float *p)
{
    uint64_t hash = 0;
    for (int a = 0; a < 3; a++) {
        uint32_t bits;
        memcpy(&bits, p + a, sizeof bits);
        hash = (hash ^ bits) * 0x9e3779b97f4a7c15u;
        hash ^= hash >> 29;
    }
    return hash;
}

/* Lists the arrays of vertices but texture coordinates. Returns false where there are too many. */
static bool list_arrays(comparison *c)
{
    const cw_attribute *uv = cwi_texture_of(c->mesh);
    for (size_t n = 0; n < cwi_attribute_count(c->mesh); n++) {
        const cw_attribute row = cwi_attribute_at(c->mesh, n);
        if (!row.data || row.on != CW_ON_VERTICES || row.data == uv->data)
            continue;
        if (c->count == MAX_ROWS)
            return false;
        c->arrays[c->count] = row.data;
        c->bytes[c->count++] = cwi_attribute_bytes(&row);
    }
    return true;
}

/* Maps each vertex to the first of those that are like it. Returns how many are mapped to others. */
static size_t map_vertices(hashed_vertex *list, size_t count, uint32_t *map)
{
    size_t joined = 0;
    qsort(list, count, sizeof *list, compare_vertices);
    for (size_t n = 0; n < count; n++) {
        const bool is_like =
            n > 0 && list[n].hash == list[n - 1].hash &&
            compare_attributes(list[n].c, list[n].vertex, list[n - 1].vertex) == 0;
        map[list[n].vertex] = is_like ? map[list[n - 1].vertex] : list[n].vertex;
        joined += is_like;
    }
    return joined;
}

/* Gives triangles the vertices that stay, and drops the others. */
static void drop_joined(cw_mesh *mesh, uint32_t *map)
{
    const size_t corners = 3 * mesh->triangle_count;
    uint32_t count = 0;
    for (size_t i = 0; i < corners; i++)
        mesh->triangles[i] = map[mesh->triangles[i]];
    memset(map, 0xff, mesh->vertex_count * sizeof *map);
    for (size_t i = 0; i < corners; i++)
        map[mesh->triangles[i]] = 0;
    for (size_t v = 0; v < mesh->vertex_count; v++)
        if (map[v] == 0)
            map[v] = count++;
    for (size_t i = 0; i < corners; i++)
        mesh->triangles[i] = map[mesh->triangles[i]];
    cwi_mesh_move_vertices(mesh, map, count);
}

cw_status cwi_texture_to_corners(cw_mesh *mesh, cw_error *err)
{
    const cw_attribute *uv = cwi_texture_of(mesh);
    if (!uv || uv->on != CW_ON_VERTICES)
        return CW_OK;
    cw_attribute *row = cw_mesh_attribute_find(mesh, uv->name);
    float *moved = cwi_alloc_array(6 * mesh->triangle_count, sizeof *moved);
    if (!moved)
        return cwi_fail_memory(err);
    for (size_t c = 0; c < 3 * mesh->triangle_count; c++)
        memcpy(moved + 2 * c, (const float *)row->data + 2 * (size_t)mesh->triangles[c],
               2 * sizeof *moved);
    cwi_free(row->data);
    row->data = moved;
    row->on = CW_ON_CORNERS;
    return CW_OK;
}

cw_status cwi_join_seams(cw_mesh *mesh, const uint32_t *groups, cw_error *err)
{
    comparison c = {.mesh = mesh, .groups = groups};
    const bool is_listed = list_arrays(&c);
    cw_status st = cwi_texture_to_corners(mesh, err);
    if (st != CW_OK || !is_listed)
        return st;
    hashed_vertex *list = cwi_alloc_array(mesh->vertex_count, sizeof *list);
    uint32_t *map = cwi_alloc_array(mesh->vertex_count, sizeof *map);
    if (!list || !map)
        st = cwi_fail_memory(err);
    for (size_t v = 0; v < mesh->vertex_count && st == CW_OK; v++)
        list[v] = (hashed_vertex){&c, hash_place(mesh->positions + 3 * v), (uint32_t)v};
    if (st == CW_OK && map_vertices(list, mesh->vertex_count, map) > 0)
        drop_joined(mesh, map);
    cwi_free(list);
    cwi_free(map);
    return st;
}
