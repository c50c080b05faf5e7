/* Copies vertices on borders between textures. */
#include "core/texture/separate_textures.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/mesh/mesh.h"
#include "core/mesh/mesh_attributes.h"

#include <string.h>

static const uint32_t NONE = UINT32_MAX;

/* Vertices that have a texture already, and copies for others: those of vertex v are a list from
 * next[v] on. */
typedef struct separation {
    uint32_t *textures, *next, *vertex; /* of old vertices and copies */
    size_t count;
} separation;

/* Finds the vertex, or copy of it, for a texture. */
static uint32_t find_copy(separation *s, uint32_t v, uint32_t textures)
{
    if (s->textures[v] == NONE)
        s->textures[v] = textures;
    while (s->textures[v] != textures && s->next[v] != NONE)
        v = s->next[v];
    if (s->textures[v] == textures)
        return v;
    const uint32_t copy = (uint32_t)s->count++;
    s->textures[copy] = textures;
    s->next[copy] = NONE;
    s->vertex[copy] = s->vertex[v];
    s->next[v] = copy;
    return copy;
}

/* Makes the mesh with the copies. corners: 3 for each triangle */
static cw_status copy_vertices(const separation *s, const uint32_t *corners, cw_mesh *mesh,
                               cw_error *err)
{
    cw_mesh copy = {0};
    cw_status st = cwi_mesh_alloc(&copy, s->count, mesh->triangle_count, false, err);
    if (st == CW_OK)
        st = cwi_attributes_alloc(mesh, &copy, err);
    if (st != CW_OK)
        return st;
    memcpy(copy.origin, mesh->origin, sizeof copy.origin);
    memcpy(copy.affine, mesh->affine, sizeof copy.affine);
    memcpy(copy.triangles, corners, 3 * mesh->triangle_count * sizeof *corners);
    for (size_t v = 0; v < s->count; v++) {
        memcpy(copy.positions + 3 * v, mesh->positions + 3 * (size_t)s->vertex[v],
               3 * sizeof *copy.positions);
        cwi_attributes_put(mesh, s->vertex[v], &copy, v);
    }
    for (size_t t = 0; t < mesh->triangle_count; t++)
        cwi_attributes_put_triangle(mesh, t, mesh->triangles + 3 * t, &copy, t);
    cw_mesh_free(mesh);
    *mesh = copy;
    return CW_OK;
}

cw_status cwi_separate_textures(cw_mesh *mesh, const uint32_t *textures, cw_error *err)
{
    const size_t corners = 3 * mesh->triangle_count, max = mesh->vertex_count + corners;
    if (max > UINT32_MAX)
        return cwi_fail(err, CW_ERR_LIMIT,
                        "a mesh of that many triangles has several textures");
    separation s = {.textures = cwi_alloc_array(max, sizeof *s.textures),
                    .next = cwi_alloc_array(max, sizeof *s.next),
                    .vertex = cwi_alloc_array(max, sizeof *s.vertex),
                    .count = mesh->vertex_count};
    uint32_t *moved = cwi_alloc_array(corners, sizeof *moved);
    cw_status st = s.textures && s.next && s.vertex && moved ? CW_OK : cwi_fail_memory(err);
    for (size_t v = 0; v < mesh->vertex_count && st == CW_OK; v++) {
        s.textures[v] = s.next[v] = NONE;
        s.vertex[v] = (uint32_t)v;
    }
    for (size_t c = 0; c < corners && st == CW_OK; c++)
        moved[c] = find_copy(&s, mesh->triangles[c], textures[c / 3]);
    if (st == CW_OK && s.count > mesh->vertex_count)
        st = copy_vertices(&s, moved, mesh, err);
    cwi_free(s.textures);
    cwi_free(s.next);
    cwi_free(s.vertex);
    cwi_free(moved);
    return st;
}
