/* Undoes moves that made triangles meet or lose their area. A vertex that is put back stays there,
 * so the rounds come to an end: at the latest where all are back. */
#include "simplify/smoothing/mesh_smooth.h"

#include "core/base/memory.h"
#include "core/base/status.h"

#include <cubewright/quality.h>

#include <string.h>

/* Rounds that put back the triangles that meet alone; later ones put back those around them, too. */
enum { NARROW_ROUNDS = 4 };

typedef struct undo_state {
    cwi_smoother *s;
    cw_mesh moved;       /* the mesh at the new places; borrowed */
    cw_crossings before; /* of the mesh as it was */
    bool has_before;
    bool *is_back; /* of each vertex */
    size_t back;   /* vertices that are back */
} undo_state;

static void put_back(undo_state *u, uint32_t v)
{
    if (u->is_back[v])
        return;
    u->is_back[v] = true;
    u->back++;
    memcpy(u->s->rounded + 3 * (size_t)v, u->s->mesh->positions + 3 * (size_t)v,
           3 * sizeof *u->s->rounded);
}

static void put_triangle_back(undo_state *u, size_t t)
{
    for (size_t c = 0; c < 3; c++)
        put_back(u, u->s->mesh->triangles[3 * t + c]);
}

/* Returns true if the area of a triangle is not 0 in double precision. */
static bool has_area(const float *positions, const uint32_t *corners)
{
    double edges[2][3];
    for (size_t c = 0; c < 2; c++)
        for (size_t a = 0; a < 3; a++)
            edges[c][a] = (double)positions[3 * (size_t)corners[c + 1] + a] -
                          (double)positions[3 * (size_t)corners[0] + a];
    for (int a = 0; a < 3; a++) {
        const int b = (a + 1) % 3;
        if (edges[0][a] * edges[1][b] - edges[0][b] * edges[1][a] != 0)
            return true;
    }
    return false;
}

static void put_flat_triangles_back(undo_state *u)
{
    const cw_mesh *mesh = u->s->mesh;
    for (size_t t = 0; t < mesh->triangle_count; t++) {
        const uint32_t *corners = mesh->triangles + 3 * t;
        if (!has_area(u->s->rounded, corners) && has_area(mesh->positions, corners))
            put_triangle_back(u, t);
    }
}

static int compare_pairs(const uint32_t *a, const uint32_t *b)
{
    const int i = a[0] == b[0];
    return a[i] < b[i] ? -1 : a[i] > b[i];
}

/* Puts back the triangles of pairs that did not meet before. Pairs are in rising order. */
static void put_pairs_back(undo_state *u, const cw_crossings *now)
{
    size_t old = 0;
    for (size_t n = 0; n < now->count; n++) {
        const uint32_t *pair = now->pairs + 2 * n;
        while (old < u->before.count && compare_pairs(u->before.pairs + 2 * old, pair) < 0)
            old++;
        if (old < u->before.count && compare_pairs(u->before.pairs + 2 * old, pair) == 0)
            continue;
        put_triangle_back(u, pair[0]);
        put_triangle_back(u, pair[1]);
    }
}

/* Puts back the triangles around all vertices that are back. */
static cw_status put_surroundings_back(undo_state *u, cw_error *err)
{
    const cw_mesh *mesh = u->s->mesh;
    bool *touched = cwi_alloc_zeroed(mesh->triangle_count, sizeof *touched);
    if (!touched)
        return cwi_fail(err, CW_ERR_NO_MEMORY, "no memory to mark %zu triangles",
                        mesh->triangle_count);
    for (size_t n = 0; n < 3 * mesh->triangle_count; n++)
        touched[n / 3] = touched[n / 3] || u->is_back[mesh->triangles[n]];
    for (size_t t = 0; t < mesh->triangle_count; t++)
        if (touched[t])
            put_triangle_back(u, t);
    cwi_free(touched);
    return CW_OK;
}

static cw_status find_crossings(undo_state *u, const cw_mesh *mesh, const cw_progress *progress,
                                cw_smooth_facts *facts, cw_crossings *out, cw_error *err)
{
    const cw_crossings_desc desc = {.threads = u->s->desc.threads, .progress = *progress};
    cw_status st = cw_self_intersections(mesh, &desc, out, err);
    facts->undecided = facts->undecided || out->undecided;
    return st;
}

/* Looks for triangles that meet, and puts them back. The mesh before is looked at when first
 * needed. */
static cw_status undo_round(undo_state *u, const cw_progress *progress, cw_smooth_facts *facts,
                            cw_error *err)
{
    cw_crossings now = {0};
    cw_status st = find_crossings(u, &u->moved, progress, facts, &now, err);
    if (st == CW_OK && now.count && !u->has_before) {
        st = find_crossings(u, u->s->mesh, progress, facts, &u->before, err);
        u->has_before = true;
    }
    if (st == CW_OK)
        put_pairs_back(u, &now);
    cw_crossings_free(&now);
    return st;
}

cw_status cwi_smooth_undo_crossings(cwi_smoother *s, cw_smooth_facts *facts,
                                    const cw_progress *progress, cw_error *err)
{
    undo_state u = {.s = s, .moved = *s->mesh};
    u.moved.positions = s->rounded;
    u.is_back = cwi_alloc_zeroed(s->mesh->vertex_count, sizeof *u.is_back);
    cw_status st = u.is_back ? CW_OK
                             : cwi_fail(err, CW_ERR_NO_MEMORY, "no memory to mark %zu vertices",
                                        s->mesh->vertex_count);
    bool is_done = false;
    double share = 0.5; /* of each round: half of the rest */
    for (int round = 0; st == CW_OK && !is_done; round++) {
        const cwi_part_progress part = {progress, 1 - 2 * share, share};
        const cw_progress part_progress = cwi_progress_part(&part);
        const size_t back = u.back;
        put_flat_triangles_back(&u);
        st = undo_round(&u, &part_progress, facts, err);
        is_done = u.back == back;
        if (st == CW_OK && !is_done && round >= NARROW_ROUNDS)
            st = put_surroundings_back(&u, err);
        share /= 2;
    }
    facts->put_back = u.back;
    cw_crossings_free(&u.before);
    cwi_free(u.is_back);
    return st;
}
