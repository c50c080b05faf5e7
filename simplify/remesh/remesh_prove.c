/* Proves a result: the distance both ways, and no triangles that meet. Where that fails, less is allowed
 * for the next attempt. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/vec3.h"
#include "simplify/quality/mesh_within.h"
#include "simplify/remesh/remesh_state.h"

#include <cubewright/quality.h>

/* Reach around a triangle that is not as it should be, in wanted lengths. */
static const double REACH = 2;

/* Attempts after which half of the distance is allowed for the next one. */
enum { HALVINGS = 3 };

typedef struct tightening {
    cwi_remesh *r;
    const cwi_boxes *tree;
    float box[6];
    uint8_t *marks; /* of the input's triangles */
} tightening;

static bool mark_node(void *context, size_t node)
{
    const tightening *x = context;
    unsigned meeting = cwi_boxes_meeting(&x->tree->nodes[node], x->box);
    for (; meeting; meeting &= meeting - 1)
        x->marks[x->tree->order[node * CWI_WIDTH + (size_t)__builtin_ctz(meeting)]] = 1;
    return true;
}

/* Marks the triangles of the input around a triangle. */
static void mark_around(tightening *x, const cw_mesh *mesh, size_t t)
{
    const float reach = (float)(REACH * x->r->desc.edge_mm);
    cwi_boxes_triangle(mesh->positions, mesh->triangles + 3 * t, x->box);
    for (int k = 0; k < 3; k++) {
        x->box[k] -= reach;
        x->box[k + 3] += reach;
    }
    cwi_boxes_visit(x->tree, x->box, 0, mark_node, x);
}

/* Allows half of the distance at all marked triangles, or, when that was tried often enough, none: there the
 * surface stays as it is. */
static void tighten_marked(cwi_remesh *r, const uint8_t *marks, size_t attempts)
{
    const double kept = attempts < HALVINGS ? 0.5 : 0;
    for (size_t t = 0; t < r->input->triangle_count; t++) {
        if (!marks[t])
            continue;
        r->surface.limits[t] =
            (float)cwi_greater(r->rounding_mm, kept * (double)r->surface.limits[t]);
        for (size_t k = 0; k < 3; k++) {
            float *limit = &r->sample_limits[r->input->triangles[3 * t + k]];
            *limit = *limit < r->surface.limits[t] ? *limit : r->surface.limits[t];
        }
    }
    for (size_t e = 0; e < r->curves.mesh.triangle_count; e++) {
        const uint32_t *v = r->curves.mesh.triangles + 3 * e;
        const float a = r->sample_limits[v[0]], b = r->sample_limits[v[1]];
        r->curves.limits[e] = a < b ? a : b;
    }
}

/* Marks what is around triangles that may be too far from the other mesh. */
static cw_status prove_distance(tightening *x, const cw_mesh *mesh, const cw_mesh *reference,
                                size_t *count, cw_error *err)
{
    cwi_remesh *r = x->r;
    const cw_progress none = {0};
    uint8_t *beyond = cwi_alloc_array(mesh->triangle_count, 1);
    if (!beyond)
        return cwi_fail_memory(err);
    cw_status st =
        cwi_mesh_within(mesh, reference, cwi_greater(r->desc.error_mm, r->rounding_mm), NULL,
                        r->desc.threads, &none, beyond, err);
    for (size_t t = 0; t < mesh->triangle_count && st == CW_OK; t++)
        if (beyond[t]) {
            ++*count;
            mark_around(x, mesh, t);
        }
    cwi_free(beyond);
    return st;
}

/* Looks for triangles of the result that meet, if they are more than those of the input. */
static cw_status prove_apart(tightening *x, const cw_mesh *out, cw_remesh_facts *facts,
                             bool *is_worse, cw_error *err)
{
    const cw_crossings_desc desc = {.threads = x->r->desc.threads};
    cw_crossings found = {0};
    cw_status st = cw_self_intersections(out, &desc, &found, err);
    facts->crossings_after = found.count;
    facts->is_undecided = facts->is_undecided || found.undecided;
    *is_worse = found.count > facts->crossings_before;
    uint8_t *meets = *is_worse ? cwi_alloc_zeroed(out->triangle_count, 1) : NULL;
    if (*is_worse && !meets && st == CW_OK)
        st = cwi_fail_memory(err);
    for (size_t n = 0; n < 2 * found.count && meets; n++) /* of many pairs each */
        meets[found.pairs[n]] = 1;
    for (size_t t = 0; t < out->triangle_count && meets; t++)
        if (meets[t])
            mark_around(x, out, t);
    cwi_free(meets);
    cw_crossings_free(&found);
    return st;
}

cw_status cwi_remesh_prove(cwi_remesh *r, const cw_mesh *out, cw_remesh_facts *facts,
                           bool *is_good, cw_error *err)
{
    tightening x = {.r = r, .tree = &r->surface.tree};
    x.marks = cwi_alloc_zeroed(r->input->triangle_count, 1);
    bool is_worse = false;
    cw_status st = x.marks ? CW_OK : cwi_fail_memory(err);
    facts->beyond = 0;
    if (st == CW_OK)
        st = prove_apart(&x, out, facts, &is_worse, err);
    if (st == CW_OK)
        st = prove_distance(&x, out, r->input, &facts->beyond, err);
    if (st == CW_OK)
        st = prove_distance(&x, r->input, out, &facts->beyond, err);
    *is_good = !is_worse && !facts->beyond;
    if (st == CW_OK && !*is_good)
        tighten_marked(r, x.marks, facts->attempts);
    cwi_free(x.marks);
    return st;
}
