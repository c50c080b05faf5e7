/* Closes the small handles of a mesh: rounds of loops that are found, chosen, planned and cut, until none is
 * left. */
#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/geometry/closest_point.h"
#include "core/geometry/vec3.h"
#include "core/mesh/attribute_transfer.h"
#include "core/mesh/mesh.h"
#include "simplify/handles/handle_state.h"

#include <math.h>
#include <string.h>

/* Rounds at most, and those in a row that cut nothing. First rounds close the shortest loops, so that later ones search less: the longest loop
 * is 1/FIRST_PART of length_mm, then twice that, and so on. */
enum { MAX_ROUNDS = 24, MAX_IDLE_ROUNDS = 3, FIRST_PART = 4 };

/* A round: loops whose cuts have nothing to do with each other. */
typedef struct cut_round {
    const cwi_handles *h;
    cwi_loops loops;
    float (*boxes)[6];
    cwi_boxes changed; /* of triangles that are not as in the input */
    uint32_t *ids;     /* of its items */
    cwi_handle_cut *cuts;
    bool *keep;
    bool is_memory_out;
    size_t made, failed;
} cut_round;

static void free_round(cut_round *r)
{
    for (size_t n = 0; n < r->loops.count && r->cuts; n++)
        cwi_handle_cut_free(&r->cuts[n]);
    cwi_loops_free(&r->loops);
    cwi_boxes_free(&r->changed);
    cwi_free(r->boxes);
    cwi_free(r->ids);
    cwi_free(r->cuts);
    cwi_free(r->keep);
}

static cw_status sort_changed(cut_round *r, cw_error *err)
{
    const cwi_handles *h = r->h;
    size_t count = 0;
    for (size_t t = 0; t < h->triangle_count; t++)
        count += h->changed[t];
    float(*boxes)[6] = cwi_alloc_array(count, sizeof *boxes);
    r->ids = cwi_alloc_array(count, sizeof *r->ids);
    cw_status st = boxes && r->ids ? CW_OK : cwi_fail_memory(err);
    count = 0;
    for (uint32_t t = 0; t < h->triangle_count && st == CW_OK; t++)
        if (h->changed[t]) {
            cwi_boxes_triangle(h->positions, h->triangles + 3 * (size_t)t, boxes[count]);
            r->ids[count++] = t;
        }
    if (st == CW_OK)
        st = cwi_boxes_build(&r->changed, (const float(*)[6])boxes, count, err);
    cwi_free(boxes);
    return st;
}

static void plan_cut(void *context, size_t n)
{
    cut_round *r = context;
    if (!cwi_handles_plan(r->h, &r->loops, &r->loops.items[n], &r->changed, r->ids, r->boxes[n],
                          &r->cuts[n]))
        cwi_set_flag(&r->is_memory_out);
}

/* Plans the cuts of all loops. keep: of those that are possible, and separate nothing together */
static cw_status plan_cuts(cut_round *r, const cw_progress *progress, cw_error *err)
{
    const size_t count = r->loops.count;
    r->cuts = cwi_alloc_zeroed(count, sizeof *r->cuts);
    r->keep = cwi_alloc_zeroed(count, sizeof *r->keep);
    cw_status st = r->cuts && r->keep ? sort_changed(r, err) : cwi_fail_memory(err);
    if (st == CW_OK)
        st = cwi_parallel_for(count, 1 << 16, r->h->desc.threads, progress, "handles", plan_cut,
                              r, err);
    if (st == CW_OK && r->is_memory_out)
        st = cwi_fail_memory(err);
    for (size_t n = 0; n < count && st == CW_OK; n++)
        r->keep[n] = r->cuts[n].is_possible;
    return st == CW_OK ? cwi_handles_keep_joined(r->h, &r->loops, r->keep, err) : st;
}

/* Marks the sides of a loop whose cut is not possible, so that later rounds find another one. */
static void avoid_loop(cwi_handles *h, const cwi_loops *loops, const cwi_loop *loop)
{
    for (size_t n = loop->first; n < loop->first + loop->count; n++)
        h->avoided[loops->sides[n]] = h->avoided[h->twin[loops->sides[n]]] = 1;
}

static cw_status make_cuts(cut_round *r, cwi_handles *h, cw_error *err)
{
    size_t vertices = 0, triangles = 0;
    for (size_t n = 0; n < r->loops.count; n++) {
        const cwi_handle_cut *cut = &r->cuts[n];
        vertices += r->keep[n] * (cut->count + cut->point_count[0] + cut->point_count[1]);
        triangles += r->keep[n] * (cut->cap_count[0] + cut->cap_count[1]);
    }
    cw_status st = cwi_handles_reserve(h, vertices, triangles, err);
    for (size_t n = 0; n < r->loops.count && st == CW_OK; n++) {
        const cwi_handle_cut *cut = &r->cuts[n];
        if (!cut->is_possible) {
            avoid_loop(h, &r->loops, &r->loops.items[n]);
            r->failed++;
        }
        if (!r->keep[n])
            continue;
        if (!cwi_handles_cut(h, &r->loops, &r->loops.items[n], cut))
            st = cwi_fail_memory(err);
        h->facts.cut += !cut->is_filling;
        h->facts.filled += cut->is_filling;
        h->facts.change_mm = cwi_greater(h->facts.change_mm, cut->change_mm);
        r->made++;
    }
    return st;
}

/* Cuts what can be cut at a time. most: length of the longest loop */
static cw_status run_round(cwi_handles *h, double most, const cw_progress *progress,
                           size_t *made, size_t *failed, cw_error *err)
{
    cut_round r = {.h = h};
    cw_status st = cwi_handles_search(h, most, progress, &r.loops, err);
    if (st == CW_OK)
        st = cwi_handles_choose(h, &r.loops, &r.boxes, err);
    if (st == CW_OK)
        st = plan_cuts(&r, progress, err);
    if (st == CW_OK)
        st = make_cuts(&r, h, err);
    *made = r.made;
    *failed = r.failed;
    free_round(&r);
    return st;
}

/* Counts handles that are left although a loop is short: the caps of each crossed something. */
static cw_status count_crossing(cwi_handles *h, cw_error *err)
{
    cwi_loops loops = {0};
    float(*boxes)[6] = NULL;
    bool *keep = NULL;
    const cw_progress none = {0};
    memset(h->avoided, 0, 3 * h->triangle_count);
    cw_status st = cwi_handles_search(h, h->facts.length_mm, &none, &loops, err);
    if (st == CW_OK)
        st = cwi_handles_choose(h, &loops, &boxes, err);
    if (st == CW_OK && !(keep = cwi_alloc_array(loops.count, sizeof *keep)))
        st = cwi_fail_memory(err);
    for (size_t n = 0; n < loops.count && st == CW_OK; n++)
        keep[n] = true;
    if (st == CW_OK)
        st = cwi_handles_keep_joined(h, &loops, keep, err);
    for (size_t n = 0; n < loops.count && st == CW_OK; n++)
        h->facts.left_crossing += keep[n];
    cwi_loops_free(&loops);
    cwi_free(boxes);
    cwi_free(keep);
    return st;
}

/* Runs rounds until a round neither cuts anything nor leaves another loop to try. */
static cw_status run_rounds(cwi_handles *h, cw_error *err)
{
    double most = h->facts.length_mm / FIRST_PART;
    cw_status st = cwi_handles_sign(h, err);
    h->facts.genus_before = h->genus;
    h->facts.components_before = h->components;
    for (int n = 0, idle = 0;
         n < MAX_ROUNDS && idle < MAX_IDLE_ROUNDS && h->genus && st == CW_OK; n++) {
        const cwi_part_progress part = {&h->desc.progress, 1 - pow(0.8, n), 0.2 * pow(0.8, n)};
        const cw_progress progress = cwi_progress_part(&part);
        size_t made, failed;
        st = run_round(h, most, &progress, &made, &failed, err);
        if (st == CW_OK && made)
            st = cwi_handles_sign(h, err);
        if (!made && !failed && most >= h->facts.length_mm)
            break;
        idle = made || most < h->facts.length_mm ? 0 : idle + 1;
        most = fmin(2 * most, h->facts.length_mm);
    }
    h->facts.genus_after = h->genus;
    h->facts.components_after = h->components;
    if (st == CW_OK && h->genus)
        st = count_crossing(h, err);
    h->facts.left_long = h->genus - h->facts.left_crossing;
    return st;
}

/* --- the result --------------------------------------------------------------------------- */

/* Computes the normals around the cuts; those of other vertices stay. */
static cw_status renew_normals(const cwi_handles *h, cw_mesh *out, cw_error *err)
{
    float *kept = out->normals;
    uint8_t *is_changed = cwi_alloc_zeroed(out->vertex_count, 1);
    out->normals = NULL;
    cw_status st = is_changed ? cw_mesh_normals(out, err) : cwi_fail_memory(err);
    for (size_t c = 0; c < 3 * out->triangle_count && st == CW_OK; c++)
        is_changed[out->triangles[c]] |= h->changed[c / 3];
    for (size_t v = 0; v < out->vertex_count && st == CW_OK; v++)
        if (!is_changed[v])
            memcpy(out->normals + 3 * v, kept + 3 * v, 3 * sizeof *kept);
    cwi_free(kept);
    cwi_free(is_changed);
    return st;
}

static cw_status make_result(const cwi_handles *h, cw_mesh *out, cw_error *err)
{
    const cw_mesh *mesh = h->mesh;
    uint32_t *triangles = cwi_alloc_array(h->triangle_count, sizeof *triangles);
    cw_status st = triangles
                       ? cwi_mesh_alloc(out, h->vertex_count, h->triangle_count, false, err)
                       : cwi_fail_memory(err);
    if (st == CW_OK) {
        memcpy(out->origin, mesh->origin, sizeof out->origin);
        memcpy(out->affine, mesh->affine, sizeof out->affine);
        memcpy(out->positions, h->positions, 3 * out->vertex_count * sizeof *out->positions);
        memcpy(out->triangles, h->triangles, 3 * out->triangle_count * sizeof *out->triangles);
        for (size_t t = 0; t < h->triangle_count; t++)
            triangles[t] = t < mesh->triangle_count ? (uint32_t)t : CWI_ADDED;
        const cwi_sources sources = {h->source, triangles};
        const cw_progress none = {0};
        st = cwi_carry(mesh, &sources, h->desc.threads, &none, out, err);
    }
    if (st == CW_OK && mesh->normals)
        st = renew_normals(h, out, err);
    cwi_free(triangles);
    return st;
}

static cw_status close_all(cwi_handles *h, cw_error *err)
{
    cw_status st = cwi_handles_link(h, err);
    if (st == CW_OK)
        st = cwi_progress(&h->desc.progress, "handles", 0, err);
    if (st == CW_OK)
        st = cwi_closest_build(h->mesh, &h->tree, err);
    if (st == CW_OK)
        st = run_rounds(h, err);
    if (st == CW_OK)
        st = cwi_progress(&h->desc.progress, "handles", 1, err);
    h->facts.triangles_before = h->mesh->triangle_count;
    h->facts.triangles_after = h->triangle_count;
    return st;
}

cw_status cw_mesh_close_handles(const cw_mesh *mesh, const cw_close_handles_desc *desc,
                                cw_mesh *out, cw_close_handles_facts *facts, cw_error *err)
{
    CWI_REQUIRE(err, mesh, out);
    CWI_REQUIRE_VERSION(err, desc, 0);
    cwi_handles h = {.mesh = mesh, .desc = desc ? *desc : (cw_close_handles_desc){0}};
    const double length = h.desc.length_mm;
    *out = (cw_mesh){0};
    cw_status st = cwi_mesh_check_size(mesh, "freed of handles", err);
    if (st == CW_OK && (!(length >= 0) || !isfinite(length)))
        st = cwi_fail(err, CW_ERR_ARGUMENT, "length_mm is %g; it must be finite, and 0 or more",
                      length);
    if (st == CW_OK && mesh->triangle_count) {
        double low[3], high[3];
        cw_mesh_bounds(mesh, low, high);
        h.facts.length_mm = length > 0 ? length : CW_HANDLE_FRACTION * cwi_distance(low, high);
        st = close_all(&h, err);
    }
    if (st == CW_OK)
        st = h.facts.cut + h.facts.filled ? make_result(&h, out, err)
                                          : cwi_mesh_copy(mesh, out, err);
    if (facts)
        *facts = st == CW_OK ? h.facts : (cw_close_handles_facts){0};
    if (st != CW_OK)
        cw_mesh_free(out);
    cwi_handles_free(&h);
    return st;
}
