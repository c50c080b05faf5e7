/* Closes the seams of a surface that was read in pieces. */
#include "formats/mesh/join_pieces.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/mesh/corner_table.h"
#include "core/mesh/mesh_attributes.h"

#include <stdlib.h>
#include <string.h>

/* A vertex that may be on a seam. */
typedef struct seam_vertex {
    int64_t id;
    float place[3];
    uint32_t group, piece, vertex;
} seam_vertex;

/* --- the vertices on seams ---------------------------------------------------------------- */

/* Marks the ends of edges that one triangle alone has. */
static bool mark_open_edges(const cw_mesh *mesh, uint8_t *marked)
{
    const size_t count = 3 * mesh->triangle_count;
    uint64_t *keys = count ? cwi_edge_keys(mesh->triangles, count) : NULL;
    if (count && !keys)
        return false;
    for (size_t n = 0, end; n < count; n = end) {
        for (end = n + 1; end < count && keys[end] == keys[n];)
            end++;
        if (end == n + 1) {
            marked[keys[n] >> 32] = 1;
            marked[keys[n] & UINT32_MAX] = 1;
        }
    }
    cwi_free(keys);
    return true;
}

static void mark_ids(const int64_t *ids, size_t count, uint8_t *marked)
{
    for (size_t v = 0; v < count; v++)
        marked[v] = ids[v] >= 0;
}

static size_t list_marked(const cwi_mesh_pieces *p, const cw_mesh *mesh, const uint8_t *marked,
                          seam_vertex *to)
{
    size_t count = 0;
    for (size_t n = 0; n < p->count; n++)
        for (size_t v = p->first[n]; v < p->first[n + 1]; v++)
            if (marked[v]) {
                seam_vertex *s = &to[count++];
                *s = (seam_vertex){.id = p->ids ? p->ids[v] : 0,
                                   .group = p->group[n],
                                   .piece = (uint32_t)n,
                                   .vertex = (uint32_t)v};
                for (size_t a = 0; a < 3;
                     a++) /* no negative zeros: equal places have equal bits */
                    s->place[a] = mesh->positions[3 * v + a] + 0.0f;
            }
    return count;
}

/* --- places ------------------------------------------------------------------------------- */

static int compare_places(const seam_vertex *s, const seam_vertex *t)
{
    if (s->group != t->group)
        return s->group < t->group ? -1 : 1;
    if (s->id != t->id)
        return s->id < t->id ? -1 : 1;
    return memcmp(s->place, t->place, sizeof s->place);
}

static int compare_vertices(const void *a, const void *b)
{
    const seam_vertex *s = a, *t = b;
    const int order = compare_places(s, t);
    return order ? order : (s->vertex > t->vertex) - (s->vertex < t->vertex);
}

/* Maps the vertices of one place to the first of them, but for those of pieces that have two there.
 * Returns the number of vertices that are mapped to another. */
static size_t map_place(const seam_vertex *s, size_t count, uint32_t *map)
{
    const seam_vertex *first = NULL;
    size_t mapped = 0;
    for (size_t n = 0; n < count; n++) {
        const bool twice = (n > 0 && s[n - 1].piece == s[n].piece) ||
                           (n + 1 < count && s[n + 1].piece == s[n].piece);
        if (twice)
            continue;
        mapped += first != NULL;
        first = first ? first : &s[n];
        map[s[n].vertex] = first->vertex;
    }
    return mapped;
}

static size_t map_places(seam_vertex *s, size_t count, uint32_t *map)
{
    size_t merged = 0;
    qsort(s, count, sizeof *s, compare_vertices);
    for (size_t n = 0, end; n < count; n = end) {
        for (end = n + 1; end < count && compare_places(&s[n], &s[end]) == 0;)
            end++;
        merged += map_place(s + n, end - n, map);
    }
    return merged;
}

/* --- all of it ---------------------------------------------------------------------------- */

/* Gives triangles the vertices that stay, and drops the others. */
static void merge_vertices(cw_mesh *mesh, uint32_t *map, uint8_t *named)
{
    uint32_t count = 0;
    memset(named, 0, mesh->vertex_count);
    for (size_t i = 0; i < 3 * mesh->triangle_count; i++) {
        mesh->triangles[i] = map[mesh->triangles[i]];
        named[mesh->triangles[i]] = 1;
    }
    for (size_t v = 0; v < mesh->vertex_count; v++)
        map[v] = named[v] ? count++ : UINT32_MAX;
    for (size_t i = 0; i < 3 * mesh->triangle_count; i++)
        mesh->triangles[i] = map[mesh->triangles[i]];
    cwi_mesh_move_vertices(mesh, map, count);
}

cw_status cwi_join_pieces(cwi_mesh_input *in, const cwi_mesh_pieces *pieces, cw_mesh *mesh,
                          size_t *merged, cw_error *err)
{
    const size_t vertices = mesh->vertex_count;
    if (mesh->triangle_count > UINT32_MAX / 3)
        return cwi_fail(err, CW_ERR_LIMIT, "pieces of more than %u triangles are not joined",
                        UINT32_MAX / 3);
    const uint64_t bytes = vertices * (sizeof(seam_vertex) + sizeof(uint32_t) + 1) +
                           3 * mesh->triangle_count * sizeof(uint64_t);
    cw_status st = cwi_mesh_take_bytes(in, bytes, err);
    if (st != CW_OK)
        return st;
    uint8_t *marked = cwi_alloc_zeroed(vertices, 1);
    uint32_t *map = cwi_alloc_array(vertices, sizeof *map);
    seam_vertex *seam = cwi_alloc_array(vertices, sizeof *seam);
    if (!marked || !map || !seam || (!pieces->ids && !mark_open_edges(mesh, marked)))
        st = cwi_fail_memory(err);
    if (st == CW_OK) {
        if (pieces->ids)
            mark_ids(pieces->ids, vertices, marked);
        for (size_t v = 0; v < vertices; v++)
            map[v] = (uint32_t)v;
        *merged = map_places(seam, list_marked(pieces, mesh, marked, seam), map);
        merge_vertices(mesh, map, marked);
    }
    cwi_free(marked);
    cwi_free(map);
    cwi_free(seam);
    in->bytes -= bytes;
    return st == CW_OK ? cwi_mesh_shrink(mesh, err) : st;
}
