/* Undoes moves that made triangles meet or lose their area. A vertex that is put back stays there,
 * so the rounds come to an end: at the latest where all are back. */
#include "simplify/smoothing/mesh_smooth.h"

#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/geometry/bvh.h"
#include "core/geometry/triangle_intersect.h"

#include <cubewright/quality.h>

#include <string.h>

/* Rounds that put back the triangles that meet alone; later ones put back those around them, too. */
enum { NARROW_ROUNDS = 4 };

enum { CHUNK = 8192 }; /* triangles that a thread looks at at a time */

typedef enum vertex_state { MOVED, BACK, JUST_BACK, GOES_BACK } vertex_state;

typedef struct undo_state {
    cwi_smoother *s;
    uint8_t *states; /* of each vertex; JUST_BACK: since the last search */
    size_t back;     /* vertices that are back */
} undo_state;

/* Triangles that a search looks at. A zeroed struct is valid and empty. */
typedef struct selection {
    uint32_t *ids;       /* numbers in the mesh; NULL: all of them */
    uint32_t *triangles; /* count x 3 vertices */
    size_t count;
} selection;

static void free_selection(selection *chosen)
{
    cwi_free(chosen->ids);
    cwi_free(chosen->triangles);
    *chosen = (selection){0};
}

static void put_back(undo_state *u, uint32_t v)
{
    if (u->states[v] != MOVED)
        return;
    u->states[v] = JUST_BACK;
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
static bool has_size(const float *positions, const uint32_t *corners)
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

static bool has_lost_size(const cwi_smoother *s, size_t t)
{
    const uint32_t *corners = s->mesh->triangles + 3 * t;
    return !has_size(s->rounded, corners) && has_size(s->mesh->positions, corners);
}

static size_t count_chunks(const cw_mesh *mesh)
{
    return (mesh->triangle_count + CHUNK - 1) / CHUNK;
}

static size_t chunk_end(const cw_mesh *mesh, size_t chunk)
{
    const size_t end = (chunk + 1) * CHUNK;
    return end < mesh->triangle_count ? end : mesh->triangle_count;
}

typedef struct flat_search {
    const cwi_smoother *s;
    bool found;
} flat_search;

static void find_flat(void *context, size_t chunk)
{
    flat_search *f = context;
    for (size_t t = chunk * CHUNK; t < chunk_end(f->s->mesh, chunk); t++)
        if (has_lost_size(f->s, t)) {
            cwi_set_flag(&f->found);
            return;
        }
}

/* Puts back the triangles that lost their area, which may flatten those beside them. Few meshes
 * have any: all threads look for one first. */
static void put_flat_triangles_back(undo_state *u)
{
    const cw_mesh *mesh = u->s->mesh;
    flat_search f = {.s = u->s};
    size_t back;
    cwi_parallel_for_all(count_chunks(mesh), CHUNK, u->s->desc.threads, find_flat, &f);
    if (!f.found)
        return;
    do {
        back = u->back;
        for (size_t t = 0; t < mesh->triangle_count; t++)
            if (has_lost_size(u->s, t))
                put_triangle_back(u, t);
    } while (u->back != back);
}

static bool has_changed(const undo_state *u, size_t t)
{
    const uint32_t *v = u->s->mesh->triangles + 3 * t;
    return u->states[v[0]] == JUST_BACK || u->states[v[1]] == JUST_BACK ||
           u->states[v[2]] == JUST_BACK;
}

/* Puts back the triangles around vertices that were put back since the last search. */
static void put_surroundings_back(undo_state *u)
{
    const cw_mesh *mesh = u->s->mesh;
    for (size_t t = 0; t < mesh->triangle_count; t++)
        for (size_t c = 0; c < 3 && has_changed(u, t); c++) {
            const uint32_t v = mesh->triangles[3 * t + c];
            if (u->states[v] == MOVED)
                u->states[v] = GOES_BACK;
        }
    for (uint32_t v = 0; v < mesh->vertex_count; v++)
        if (u->states[v] == GOES_BACK) {
            u->states[v] = MOVED;
            put_back(u, v);
        }
}

/* Sorts the boxes of triangles with a vertex that was put back since the last search. */
static cw_status sort_changed(const undo_state *u, cwi_boxes *tree, cw_error *err)
{
    const cw_mesh *mesh = u->s->mesh;
    size_t count = 0, n = 0;
    for (size_t t = 0; t < mesh->triangle_count; t++)
        count += has_changed(u, t);
    float(*boxes)[6] = cwi_alloc_array(count, sizeof *boxes);
    if (!boxes)
        return cwi_fail_memory(err);
    for (size_t t = 0; t < mesh->triangle_count; t++)
        if (has_changed(u, t))
            cwi_boxes_triangle(u->s->rounded, mesh->triangles + 3 * t, boxes[n++]);
    cw_status st = cwi_boxes_build(tree, (const float(*)[6])boxes, count, err);
    cwi_free(boxes);
    return st;
}

typedef struct overlap {
    const cwi_boxes *tree;
    float box[6];
    bool found;
} overlap;

static bool visit_node(void *context, size_t node)
{
    overlap *o = context;
    o->found = cwi_boxes_meeting(&o->tree->nodes[node], o->box) != 0;
    return !o->found;
}

typedef struct near_search {
    const undo_state *u;
    const cwi_boxes *tree; /* of triangles that changed */
    uint32_t *ids;         /* the triangles near them, from the first of each chunk on */
    size_t *counts;        /* of each chunk */
} near_search;

static void find_near(void *context, size_t chunk)
{
    const near_search *f = context;
    const cw_mesh *mesh = f->u->s->mesh;
    overlap o = {.tree = f->tree};
    size_t count = 0;
    for (size_t t = chunk * CHUNK; t < chunk_end(mesh, chunk); t++) {
        cwi_boxes_triangle(f->u->s->rounded, mesh->triangles + 3 * t, o.box);
        o.found = false;
        cwi_boxes_visit(f->tree, o.box, 0, visit_node, &o);
        if (o.found)
            f->ids[chunk * CHUNK + count++] = (uint32_t)t;
    }
    f->counts[chunk] = count;
}

/* Fills the selection with the triangles near those of a tree. */
static cw_status select_near(const undo_state *u, const cwi_boxes *tree, selection *chosen,
                             cw_error *err)
{
    const cw_mesh *mesh = u->s->mesh;
    const size_t chunks = count_chunks(mesh);
    near_search f = {.u = u, .tree = tree};
    f.ids = chosen->ids = cwi_alloc_array(mesh->triangle_count, sizeof *f.ids);
    f.counts = cwi_alloc_array(chunks, sizeof *f.counts);
    if (f.ids && f.counts) {
        cwi_parallel_for_all(chunks, CHUNK, u->s->desc.threads, find_near, &f);
        for (size_t chunk = 0; chunk < chunks; chunk++) {
            memmove(f.ids + chosen->count, f.ids + chunk * CHUNK,
                    f.counts[chunk] * sizeof *f.ids);
            chosen->count += f.counts[chunk];
        }
        chosen->triangles = cwi_alloc_array(chosen->count, 3 * sizeof *chosen->triangles);
    }
    cwi_free(f.counts);
    if (!chosen->triangles)
        return cwi_fail_memory(err);
    for (size_t n = 0; n < chosen->count; n++)
        memcpy(chosen->triangles + 3 * n, mesh->triangles + 3 * (size_t)chosen->ids[n],
               3 * sizeof *chosen->triangles);
    return CW_OK;
}

/* Selects the triangles that changed, and those whose boxes meet theirs: all pairs of which one
 * triangle changed are among them. */
static cw_status select_near_changed(const undo_state *u, selection *chosen, cw_error *err)
{
    cwi_boxes tree = {0};
    cw_status st = sort_changed(u, &tree, err);
    if (st == CW_OK)
        st = select_near(u, &tree, chosen, err);
    cwi_boxes_free(&tree);
    return st;
}

/* Returns true if two triangles of the mesh met before anything moved. */
static bool met_before(const cw_mesh *mesh, uint32_t a, uint32_t b)
{
    const uint32_t *v = mesh->triangles + 3 * (size_t)a, *w = mesh->triangles + 3 * (size_t)b;
    return cwi_has_area(mesh->positions, v) && cwi_has_area(mesh->positions, w) &&
           cwi_triangles_meet(mesh->positions, v, w);
}

/* Puts back the triangles of pairs that did not meet before. */
static void put_pairs_back(undo_state *u, const cw_crossings *found, const selection *chosen)
{
    for (size_t n = 0; n < found->count; n++) {
        uint32_t a = found->pairs[2 * n], b = found->pairs[2 * n + 1];
        if (chosen->ids) {
            a = chosen->ids[a];
            b = chosen->ids[b];
        }
        if (met_before(u->s->mesh, a, b))
            continue;
        put_triangle_back(u, a);
        put_triangle_back(u, b);
    }
}

/* Looks for triangles that meet, and puts them back. The first search looks at all triangles,
 * later ones near those that changed. */
static cw_status undo_round(undo_state *u, bool is_first, const cw_progress *progress,
                            cw_smooth_facts *facts, cw_error *err)
{
    const cw_crossings_desc desc = {.threads = u->s->desc.threads, .progress = *progress};
    selection chosen = {0};
    cw_crossings found = {0};
    cw_mesh moved = {.vertex_count = u->s->mesh->vertex_count,
                     .triangle_count = u->s->mesh->triangle_count,
                     .positions = u->s->rounded,
                     .triangles = u->s->mesh->triangles};
    cw_status st = is_first ? CW_OK : select_near_changed(u, &chosen, err);
    if (st == CW_OK && !is_first) {
        moved.triangle_count = chosen.count;
        moved.triangles = chosen.triangles;
    }
    for (size_t v = 0; v < moved.vertex_count; v++)
        u->states[v] = u->states[v] == MOVED ? MOVED : BACK;
    if (st == CW_OK)
        st = cw_self_intersections(&moved, &desc, &found, err);
    facts->undecided = facts->undecided || found.undecided;
    if (st == CW_OK)
        put_pairs_back(u, &found, &chosen);
    cw_crossings_free(&found);
    free_selection(&chosen);
    return st;
}

cw_status cwi_smooth_undo_crossings(cwi_smoother *s, cw_smooth_facts *facts,
                                    const cw_progress *progress, cw_error *err)
{
    undo_state u = {.s = s};
    u.states = cwi_alloc_zeroed(s->mesh->vertex_count, sizeof *u.states);
    cw_status st = u.states ? CW_OK : cwi_fail_memory(err);
    bool is_done = false;
    double fraction = 0.5; /* of each round: half of the rest */
    for (int round = 0; st == CW_OK && !is_done; round++) {
        const cwi_part_progress part = {progress, 1 - 2 * fraction, fraction};
        const cw_progress part_progress = cwi_progress_part(&part);
        put_flat_triangles_back(&u);
        const size_t back = u.back;
        st = undo_round(&u, round == 0, &part_progress, facts, err);
        is_done = u.back == back;
        if (st == CW_OK && !is_done && round >= NARROW_ROUNDS)
            put_surroundings_back(&u);
        fraction /= 2;
    }
    facts->put_back = u.back;
    cwi_free(u.states);
    return st;
}
