/* Undoes moves that made triangles meet or lose their area. A vertex that is put back stays there,
 * so the rounds come to an end: at the latest where all are back. */
#include "simplify/smoothing/mesh_smooth.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/bvh.h"
#include "core/geometry/triangle_intersect.h"

#include <cubewright/quality.h>

#include <string.h>

/* Rounds that put back the triangles that meet alone; later ones put back those around them, too. */
enum { NARROW_ROUNDS = 4 };

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

/* Puts back the triangles that lost their area, which may flatten those beside them. */
static void put_flat_triangles_back(undo_state *u)
{
    const cw_mesh *mesh = u->s->mesh;
    size_t back;
    do {
        back = u->back;
        for (size_t t = 0; t < mesh->triangle_count; t++) {
            const uint32_t *corners = mesh->triangles + 3 * t;
            if (!has_size(u->s->rounded, corners) && has_size(mesh->positions, corners))
                put_triangle_back(u, t);
        }
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

/* Selects the triangles that changed, and those whose boxes meet theirs: all pairs of which one
 * triangle changed are among them. */
static cw_status select_near_changed(const undo_state *u, selection *chosen, cw_error *err)
{
    const cw_mesh *mesh = u->s->mesh;
    cwi_boxes tree = {0};
    cw_status st = sort_changed(u, &tree, err);
    overlap o = {.tree = &tree};
    chosen->ids = cwi_alloc_array(mesh->triangle_count, sizeof *chosen->ids);
    for (size_t t = 0; t < mesh->triangle_count && chosen->ids && st == CW_OK; t++) {
        cwi_boxes_triangle(u->s->rounded, mesh->triangles + 3 * t, o.box);
        o.found = false;
        cwi_boxes_visit(&tree, o.box, 0, visit_node, &o);
        if (o.found)
            chosen->ids[chosen->count++] = (uint32_t)t;
    }
    chosen->triangles = cwi_alloc_array(chosen->count, 3 * sizeof *chosen->triangles);
    if (st == CW_OK && (!chosen->ids || !chosen->triangles))
        st = cwi_fail_memory(err);
    for (size_t n = 0; n < chosen->count && st == CW_OK; n++)
        memcpy(chosen->triangles + 3 * n, mesh->triangles + 3 * (size_t)chosen->ids[n],
               3 * sizeof *chosen->triangles);
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
