/* Joins pieces at their common vertices to one mesh, smooths it, and hands its places back. Interfaces
 * of labels are in two pieces: their triangles count once, whichever way they face. */
#include "cli/commands/smooth_together.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/mesh/mesh.h"
#include "core/mesh/weld.h"

#include <stdlib.h>
#include <string.h>

/* The pieces one behind the other, and the mesh made of them. */
typedef struct joined {
    float *positions; /* count x 3 */
    uint32_t *map; /* of each vertex: the first one at its place, then its number in the mesh */
    size_t count;
    cw_mesh mesh; /* owned */
} joined;

static void free_joined(joined *j)
{
    cwi_free(j->positions);
    cwi_free(j->map);
    cw_mesh_free(&j->mesh);
}

static bool weld_pieces(const cli_pieces *p, joined *j)
{
    size_t done = 0;
    for (size_t n = 0; n < p->count; n++)
        j->count += p->piece[n].input.vertex_count;
    j->positions = cwi_alloc_array(j->count, 3 * sizeof *j->positions);
    j->map = cwi_alloc_array(j->count, sizeof *j->map);
    if (!j->positions || !j->map || j->count >= UINT32_MAX)
        return false;
    for (size_t n = 0; n < p->count; n++) {
        const cw_mesh *mesh = &p->piece[n].input;
        memcpy(j->positions + 3 * done, mesh->positions,
               3 * mesh->vertex_count * sizeof *j->positions);
        done += mesh->vertex_count;
    }
    return cwi_weld(j->positions, j->count, j->map);
}

static bool have_one_origin(const cli_pieces *p)
{
    for (size_t n = 1; n < p->count; n++)
        if (memcmp(p->piece[n].input.origin, p->piece->input.origin,
                   sizeof p->piece->input.origin) != 0)
            return false;
    return true;
}

bool cli_share_vertices(const cli_pieces *pieces)
{
    joined j = {0};
    bool shares = false;
    if (pieces->count > 1 && have_one_origin(pieces) && weld_pieces(pieces, &j))
        for (size_t v = 0; v < j.count && !shares; v++)
            shares = j.map[v] != v; /* each piece by itself is welded */
    free_joined(&j);
    return shares;
}

/* A triangle and its corners in rising order. */
typedef struct sorted_triangle {
    uint32_t corners[3];
    uint32_t number;
} sorted_triangle;

static int compare_triangles(const void *a, const void *b)
{
    const sorted_triangle *s = a, *t = b;
    for (int c = 0; c < 3; c++)
        if (s->corners[c] != t->corners[c])
            return s->corners[c] < t->corners[c] ? -1 : 1;
    return s->number < t->number ? -1 : s->number > t->number;
}

static int compare_numbers(const void *a, const void *b)
{
    const sorted_triangle *s = a, *t = b;
    return s->number < t->number ? -1 : s->number > t->number;
}

static void swap_falling(uint32_t *a, uint32_t *b)
{
    if (*a > *b) {
        const uint32_t larger = *a;
        *a = *b;
        *b = larger;
    }
}

static void sort_corners(const uint32_t *from, sorted_triangle *t)
{
    memcpy(t->corners, from, sizeof t->corners);
    swap_falling(&t->corners[0], &t->corners[1]);
    swap_falling(&t->corners[1], &t->corners[2]);
    swap_falling(&t->corners[0], &t->corners[1]);
}

/* Keeps the first of triangles that have the same corners. */
static cw_status keep_single(cw_mesh *mesh, cw_error *err)
{
    size_t kept = 0;
    sorted_triangle *sorted = cwi_alloc_array(mesh->triangle_count, sizeof *sorted);
    if (!sorted)
        return cwi_fail_memory(err);
    for (size_t t = 0; t < mesh->triangle_count; t++) {
        sort_corners(mesh->triangles + 3 * t, &sorted[t]);
        sorted[t].number = (uint32_t)t;
    }
    qsort(sorted, mesh->triangle_count, sizeof *sorted, compare_triangles);
    for (size_t t = 0; t < mesh->triangle_count; t++)
        if (!kept ||
            memcmp(sorted[kept - 1].corners, sorted[t].corners, sizeof sorted->corners) != 0)
            sorted[kept++] = sorted[t];
    qsort(sorted, kept, sizeof *sorted, compare_numbers);
    for (size_t t = 0; t < kept; t++)
        memmove(mesh->triangles + 3 * t, mesh->triangles + 3 * (size_t)sorted[t].number,
                3 * sizeof *mesh->triangles);
    mesh->triangle_count = kept;
    cwi_free(sorted);
    return CW_OK;
}

/* Makes the mesh, and numbers its vertices in the order in which they come. */
static cw_status join_pieces(const cli_pieces *p, joined *j, cw_error *err)
{
    size_t vertices = 0, begin = 0, done = 0, triangles = 0;
    if (!weld_pieces(p, j))
        return cwi_fail_memory(err);
    for (size_t v = 0; v < j->count; v++)
        vertices += j->map[v] == v;
    for (size_t n = 0; n < p->count; n++)
        triangles += p->piece[n].input.triangle_count;
    cw_status st = cwi_mesh_alloc(&j->mesh, vertices, triangles, false, err);
    if (st != CW_OK)
        return st;
    vertices = 0;
    for (size_t v = 0; v < j->count; v++) {
        const bool is_first = j->map[v] == v;
        if (is_first)
            memcpy(j->mesh.positions + 3 * vertices, j->positions + 3 * v,
                   3 * sizeof *j->positions);
        j->map[v] = is_first ? (uint32_t)vertices++ : j->map[j->map[v]];
    }
    for (size_t n = 0; n < p->count; n++) {
        const cw_mesh *mesh = &p->piece[n].input;
        for (size_t c = 0; c < 3 * mesh->triangle_count; c++)
            j->mesh.triangles[3 * done + c] = j->map[begin + mesh->triangles[c]];
        begin += mesh->vertex_count;
        done += mesh->triangle_count;
    }
    return keep_single(&j->mesh, err);
}

static cw_status copy_positions(cli_pieces *p, const joined *j, cw_error *err)
{
    size_t begin = 0;
    cw_status st = CW_OK;
    for (size_t n = 0; n < p->count && st == CW_OK; n++) {
        cw_mesh *out = &p->piece[n].out;
        for (size_t v = 0; v < out->vertex_count; v++)
            memcpy(out->positions + 3 * v, j->mesh.positions + 3 * (size_t)j->map[begin + v],
                   3 * sizeof *out->positions);
        begin += out->vertex_count;
        if (out->normals)
            st = cw_mesh_normals(out, err);
    }
    return st;
}

cw_status cli_smooth_together(cli_pieces *pieces, const cw_smooth_desc *desc,
                              cw_smooth_facts *facts, cw_error *err)
{
    joined j = {0};
    cw_status st = join_pieces(pieces, &j, err);
    if (st == CW_OK)
        st = cw_mesh_smooth(&j.mesh, desc, facts, err);
    if (st == CW_OK)
        st = copy_positions(pieces, &j, err);
    free_joined(&j);
    return st;
}
