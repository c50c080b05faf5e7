/* Finds the triangles that parts of a mesh share: interfaces of labels have each triangle twice. */
#include <cubewright/check.h>

#include "core/base/memory.h"
#include "core/base/status.h"
#include "simplify/quality/welded_mesh.h"

#include <stdlib.h>
#include <string.h>

/* A triangle as its corners in rising order, and which way it faces. */
typedef struct facet {
    uint32_t corners[3];
    uint32_t part, triangle;
    bool is_turned; /* its corners run down */
} facet;

static int compare_facets(const void *a, const void *b)
{
    const facet *x = a, *y = b;
    for (int c = 0; c < 3; c++)
        if (x->corners[c] != y->corners[c])
            return x->corners[c] < y->corners[c] ? -1 : 1;
    if (x->is_turned != y->is_turned)
        return x->is_turned ? 1 : -1;
    if (x->part != y->part)
        return x->part < y->part ? -1 : 1;
    return x->triangle < y->triangle ? -1 : x->triangle > y->triangle;
}

static void swap_corners(facet *f, int a, int b)
{
    const uint32_t kept = f->corners[a];
    if (kept <= f->corners[b])
        return;
    f->corners[a] = f->corners[b];
    f->corners[b] = kept;
    f->is_turned = !f->is_turned;
}

static facet make_facet(const cwi_welded *w, uint32_t triangle, uint32_t part)
{
    const uint32_t *v = w->vertex + 3 * (size_t)triangle;
    facet f = {{v[0], v[1], v[2]}, part, triangle, false};
    swap_corners(&f, 0, 1);
    swap_corners(&f, 1, 2);
    swap_corners(&f, 0, 1);
    return f;
}

static bool is_same_place(const facet *a, const facet *b)
{
    return memcmp(a->corners, b->corners, sizeof a->corners) == 0;
}

/* A pair of parts as a number. */
static int compare_pairs(const void *a, const void *b)
{
    const uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return x < y ? -1 : x > y;
}

/* Counts the places of facets in order. Pairs of parts are listed at first; first[n] is set for the
 * triangle that stands for a place. */
static size_t count_places(const facet *facets, size_t count, cw_contacts *c, uint64_t *pairs,
                           bool *first)
{
    size_t pair_count = 0;
    for (size_t n = 0, end; n < count; n = end) {
        size_t turned = 0;
        for (end = n; end < count && is_same_place(&facets[n], &facets[end]); end++)
            turned += facets[end].is_turned;
        first[facets[n].triangle] = true;
        c->overlapping += turned > 1 || end - n - turned > 1;
        if (end - n != 2 || turned != 1 || facets[n].part == facets[n + 1].part)
            continue;
        const uint32_t a = facets[n].part, b = facets[n + 1].part;
        c->shared++;
        pairs[pair_count++] = a < b ? (uint64_t)a << 32 | b : (uint64_t)b << 32 | a;
    }
    return pair_count;
}

static size_t count_different(uint64_t *pairs, size_t count)
{
    size_t different = 0;
    if (count)
        qsort(pairs, count, sizeof *pairs, compare_pairs);
    for (size_t n = 0; n < count; n++)
        different += n == 0 || pairs[n] != pairs[n - 1];
    return different;
}

/* Copies the triangles that stand for their places, with corners welded. */
static cw_status copy_places(const cwi_welded *w, const bool *first, cw_mesh *once,
                             cw_error *err)
{
    const cw_mesh *mesh = w->mesh;
    *once = (cw_mesh){.vertex_count = mesh->vertex_count};
    once->positions = cwi_alloc_array(mesh->vertex_count, 3 * sizeof(float));
    once->triangles = cwi_alloc_array(mesh->triangle_count, 3 * sizeof(uint32_t));
    if (!once->positions || !once->triangles) {
        cw_mesh_free(once);
        return cwi_fail_memory(err);
    }
    memcpy(once->positions, mesh->positions, 3 * mesh->vertex_count * sizeof(float));
    memcpy(once->origin, mesh->origin, sizeof once->origin);
    memcpy(once->affine, mesh->affine, sizeof once->affine);
    for (size_t t = 0; t < mesh->triangle_count; t++)
        if (first[t])
            memcpy(once->triangles + 3 * once->triangle_count++, w->vertex + 3 * t,
                   3 * sizeof(uint32_t));
    return CW_OK;
}

static cw_status find_contacts(const cwi_welded *w, const uint32_t *part_of,
                               cw_contacts *contacts, cw_mesh *once, cw_error *err)
{
    const size_t count = w->mesh->triangle_count;
    facet *facets = cwi_alloc_array(count, sizeof *facets);
    uint64_t *pairs = cwi_alloc_array(count, sizeof *pairs);
    bool *first = cwi_alloc_zeroed(count, 1);
    cw_status st = facets && pairs && first ? CW_OK : cwi_fail_memory(err);
    if (st == CW_OK) {
        *contacts = (cw_contacts){.triangles = count};
        for (size_t t = 0; t < count; t++)
            facets[t] = make_facet(w, (uint32_t)t, part_of[t]);
        qsort(facets, count, sizeof *facets, compare_facets);
        contacts->neighbours =
            count_different(pairs, count_places(facets, count, contacts, pairs, first));
        st = once ? copy_places(w, first, once, err) : CW_OK;
    }
    cwi_free(facets);
    cwi_free(pairs);
    cwi_free(first);
    return st;
}

cw_status cw_contacts_find(const cw_mesh *mesh, const uint32_t *part_of, cw_contacts *contacts,
                           cw_mesh *once, cw_error *err)
{
    CWI_REQUIRE(err, mesh, contacts);
    cwi_welded w = {0};
    if (once)
        *once = (cw_mesh){0};
    *contacts = (cw_contacts){0};
    if (mesh->triangle_count == 0)
        return CW_OK;
    CWI_REQUIRE(err, part_of);
    cw_status st = cwi_welded_init(&w, mesh, CW_WELD_LOCAL, err);
    if (st == CW_OK)
        st = find_contacts(&w, part_of, contacts, once, err);
    cwi_welded_free(&w);
    return st;
}
