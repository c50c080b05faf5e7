/* Repairs a mesh: the order of the steps, and the attributes of the result. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/closest_point.h"
#include "core/mesh/attribute_transfer.h"
#include "core/mesh/mesh.h"
#include "simplify/repair/repair_state.h"

#include <cubewright/quality.h>

#include <math.h>
#include <string.h>

/* Rounds that remove crossings, and rounds that fill the holes after each. After FLAT_ROUNDS of the first
 * patches are plain. */
enum { CROSSING_ROUNDS = 12, FILL_ROUNDS = 6, FLAT_ROUNDS = 7 };

static cw_status check_length(double length, const char *name, cw_error *err)
{
    return length >= 0 && isfinite(length)
               ? CW_OK
               : cwi_fail(err, CW_ERR_ARGUMENT, "%s is %g; it must be finite, and 0 or more",
                          name, length);
}

static cw_status check_input(const cw_mesh *mesh, const cw_repair_desc *d, cw_error *err)
{
    cw_status st = check_length(d->weld_mm, "weld_mm", err);
    if (st == CW_OK)
        st = check_length(d->max_hole_mm, "max_hole_mm", err);
    if (st == CW_OK)
        st = check_length(d->wrap_mm, "wrap_mm", err);
    if (st == CW_OK)
        st = check_length(d->max_move_mm, "max_move_mm", err);
    if (st == CW_OK)
        st = cwi_mesh_check_size(mesh, "repaired", err);
    if (st == CW_OK && !mesh->triangle_count)
        st = cwi_fail(err, CW_ERR_EMPTY, "the mesh has no triangles to repair");
    return st;
}

/* Begins a step that ends when this fraction of the repair is done. */
static cw_status begin_step(cwi_repair *r, double until, cw_error *err)
{
    r->done = r->until;
    r->until = until;
    return cwi_progress(&r->desc.progress, "repair", r->done, err);
}

/* Copies and welds the mesh. The copy of the repair has the numbers of its vertices in place of
 * labels, and those of its triangles as an attribute. */
static cw_status copy_input(cwi_repair *r, const cw_mesh *mesh, cw_mesh *input, cw_error *err)
{
    const cw_attribute source = {.name = "source",
                                 .on = CW_ON_TRIANGLES,
                                 .type = CW_U32,
                                 .components = 1,
                                 .interpolation = CW_INTERPOLATE_NEAREST};
    const size_t triangles = mesh->triangle_count;
    cw_status st = cwi_mesh_copy(mesh, input, err);
    if (st == CW_OK)
        st = cw_mesh_weld(input, &r->facts.welded, err);
    if (st == CW_OK && r->desc.weld_mm > 0)
        st = cwi_weld_near(input, r->desc.weld_mm, &r->facts.welded, err);
    if (st != CW_OK)
        return st;
    r->facts.degenerate = triangles - input->triangle_count;
    r->input = input;
    st = cw_mesh_attribute_add(&r->mesh, &source, NULL, err);
    if (st == CW_OK)
        st = cwi_repair_append(r, input->positions, input->vertex_count, input->triangles,
                               input->triangle_count, err);
    for (uint32_t v = 0; v < r->mesh.vertex_count && st == CW_OK; v++)
        r->mesh.labels[v] = v;
    for (uint32_t t = 0; t < r->mesh.triangle_count && st == CW_OK; t++)
        ((uint32_t *)r->mesh.attributes->data)[t] = t;
    return st;
}

/* --- the steps ---------------------------------------------------------------------------- */

/* Drops what belongs to no surface, and joins the rest. */
static cw_status clean_mesh(cwi_repair *r, cw_error *err)
{
    cw_repair_facts *f = &r->facts;
    cw_status st = r->desc.keep_cracks ? CW_OK : cwi_stitch_borders(r, err);
    if (st == CW_OK)
        st = cwi_drop_duplicates(r, false, &f->duplicates, err);
    if (st == CW_OK)
        st = cwi_repair_link(r, true, err);
    if (st == CW_OK)
        st = cwi_drop_one_sided(r, err);
    if (st == CW_OK)
        st = cwi_drop_degenerate(r, &f->degenerate, err);
    return st == CW_OK ? cwi_drop_sheets(r, &f->sheets, &f->sheet_triangles, err) : st;
}

/* Fills holes until none is left that can be filled. Triangles that face each other go: they are what
 * is left of sheets. */
static cw_status close_holes(cwi_repair *r, cwi_patch_kind kind, cw_error *err)
{
    cw_status st = CW_OK;
    bool is_open = true;
    for (int n = 0; n < FILL_ROUNDS && is_open && st == CW_OK; n++) {
        const size_t added = r->facts.added_triangles;
        size_t flat = 0, facing = 0;
        r->done += n > 0 ? (r->until - r->done) / 2 : 0;
        st = cwi_fill_holes(r, kind, err);
        is_open = r->facts.added_triangles != added;
        if (st == CW_OK && is_open)
            st = cwi_drop_duplicates(r, true, &facing, err);
        if (st == CW_OK && is_open)
            st = cwi_repair_link(r, false, err);
        if (st == CW_OK && is_open)
            st = cwi_drop_degenerate(r, &flat, err);
        r->is_later = true;
    }
    return st;
}

/* Closes the mesh, and gives all fans their vertices, which may be at one place. */
static cw_status close_mesh(cwi_repair *r, cwi_patch_kind kind, cw_error *err)
{
    const bool is_later = r->is_later;
    cw_status st = close_holes(r, kind, err);
    r->is_later = is_later;
    if (st == CW_OK)
        st = cwi_repair_split(r, err);
    r->is_later = true;
    size_t sheets = 0, triangles = 0;
    if (st == CW_OK)
        st = cwi_drop_sheets(r, &sheets, &triangles, err);
    r->facts.sheets += is_later ? 0 : sheets; /* later ones are what crossings left */
    r->facts.sheet_triangles += is_later ? 0 : triangles;
    return st;
}

/* Removes crossings and fills the holes that this leaves, round by round. Solids that touch in edges and points
 * stay where they are; sheets at one place that repair made move apart. */
static cw_status remove_crossings(cwi_repair *r, bool is_clear, cw_error *err)
{
    cw_status st = CW_OK;
    bool changed = !(is_clear && !r->facts.holes_filled && !r->facts.twisted_edges);
    for (int round = 0; st == CW_OK && changed && r->mesh.triangle_count; round++) {
        bool moved;
        st = begin_step(r, 0.2 + 0.6 * (round + 2) / (CROSSING_ROUNDS + 2), err);
        if (st == CW_OK && round > 0)
            st = close_mesh(r, round >= FLAT_ROUNDS ? CWI_PATCH_PLAIN : CWI_PATCH_FLAT, err);
        if (st == CW_OK)
            st = cwi_part_vertices(r, &moved, err);
        if (st != CW_OK || round == CROSSING_ROUNDS || !r->mesh.triangle_count ||
            (is_clear && !moved))
            break;
        st = cwi_remove_crossings(r, round, round == CROSSING_ROUNDS - 1, &changed, err);
        if (st == CW_OK && changed)
            st = cwi_repair_link(r, false, err);
        is_clear = false;
    }
    return st;
}

/* Orients shells. With outer_only those inside of others go. */
static cw_status orient_shells(cwi_repair *r, cw_error *err)
{
    cw_orient_counts turned;
    cw_drop_counts inner = {0};
    cw_status st = cw_mesh_orient(&r->mesh, r->desc.threads, &turned, err);
    if (st == CW_OK && r->desc.outer_only)
        st = cw_mesh_fill_voids(&r->mesh, r->desc.threads, &inner, err);
    r->facts.flipped_shells = turned.turned;
    r->facts.inner_shells = inner.dropped;
    r->facts.inner_mm3 = inner.dropped_mm3;
    return st;
}

static cw_status mend_mesh(cwi_repair *r, cw_error *err)
{
    bool is_clear = true, is_united = false;
    cw_status st = clean_mesh(r, err);
    if (st == CW_OK)
        st = begin_step(r, 0.2 + 0.6 / (CROSSING_ROUNDS + 2), err);
    if (st == CW_OK && r->mesh.triangle_count)
        st = close_mesh(r, r->desc.flat_holes ? CWI_PATCH_FLAT : CWI_PATCH_FAIR, err);
    if (st == CW_OK && r->mesh.triangle_count)
        st = cwi_unite_crossing(r, &is_clear, &is_united, err);
    if (st == CW_OK && is_united)
        st = cwi_repair_link(r, false, err);
    if (st == CW_OK)
        st = remove_crossings(r, is_clear, err);
    return st == CW_OK ? orient_shells(r, err) : st;
}

/* --- the result --------------------------------------------------------------------------- */

/* Judges the mesh under repair. */
static cw_status judge_mesh(cwi_repair *r, cw_error *err)
{
    const cw_quality_desc desc = {.threads = r->desc.threads, .shells = true};
    const cw_crossings_desc crossings_desc = {.weld = CW_WELD_LOCAL,
                                              .threads = r->desc.threads};
    cw_quality q = {0};
    cw_crossings found = {0};
    cw_status st = cw_quality_measure(&r->mesh, &desc, &q, err);
    if (st == CW_OK)
        st = cw_self_intersections(&r->mesh, &crossings_desc, &found, err);
    r->facts.crossings_after = found.count;
    r->facts.is_undecided = r->facts.is_undecided || found.undecided;
    r->facts.volume_after_mm3 = fabs(q.volume_mm3);
    r->facts.is_sound = st == CW_OK && r->mesh.triangle_count && !found.count &&
                        !found.undecided && !q.degenerate && !q.inside_out &&
                        cw_quality_is_closed_manifold(&q);
    cw_crossings_free(&found);
    return st;
}

static bool is_repair_needed(const cw_repair_facts *f)
{
    return f->weld_mm > 0 || f->duplicates || f->degenerate || f->flipped_triangles ||
           f->flipped_shells || f->nonmanifold_edges || f->twisted_edges ||
           f->nonmanifold_vertices || f->sheets || f->holes_filled || f->holes_left ||
           f->crossings_before || f->inner_shells || f->is_undecided;
}

static cw_status make_result(cwi_repair *r, const cw_mesh *mesh, cw_mesh *out, cw_error *err)
{
    cw_status st =
        cwi_mesh_alloc(out, r->mesh.vertex_count, r->mesh.triangle_count, false, err);
    if (st != CW_OK)
        return st;
    memcpy(out->origin, mesh->origin, sizeof out->origin);
    memcpy(out->affine, mesh->affine, sizeof out->affine);
    memcpy(out->positions, r->mesh.positions, 3 * out->vertex_count * sizeof *out->positions);
    memcpy(out->triangles, r->mesh.triangles, 3 * out->triangle_count * sizeof *out->triangles);
    cw_mesh from = *r->input;
    from.normals = NULL;
    const cwi_sources sources = {r->mesh.labels, r->mesh.attributes->data};
    const cw_progress none = {0};
    st = cwi_carry(&from, &sources, r->desc.threads, &none, out, err);
    return st == CW_OK && mesh->normals ? cw_mesh_normals(out, err) : st;
}

/* Repairs the copy, and wraps it if that is asked for. */
static cw_status run_repair(cwi_repair *r, const cw_mesh *mesh, cw_mesh *input, cw_error *err)
{
    cw_status st = begin_step(r, 0.1, err);
    if (st == CW_OK)
        st = copy_input(r, mesh, input, err);
    if (st == CW_OK)
        st = begin_step(r, 0.2, err);
    if (st == CW_OK)
        st = mend_mesh(r, err);
    if (st == CW_OK)
        st = begin_step(r, 0.9, err);
    if (st == CW_OK)
        st = judge_mesh(r, err);
    r->facts.is_needed = is_repair_needed(&r->facts);
    if (st == CW_OK && r->desc.wrap_mm > 0 && input->triangle_count) {
        r->facts.volume_before_mm3 = r->facts.is_sound ? r->facts.volume_after_mm3 : 0;
        st = cwi_wrap_mesh(r, err);
        if (st == CW_OK)
            st = cw_mesh_orient(&r->mesh, r->desc.threads, NULL, err);
        if (st == CW_OK)
            st = judge_mesh(r, err);
    }
    if (st == CW_OK && !r->mesh.triangle_count)
        st = cwi_fail(err, CW_ERR_EMPTY, "the mesh %s: nothing is left of its %zu triangles",
                      r->facts.one_sided
                          ? "is one-sided (like a Moebius strip), and encloses no volume"
                          : "encloses no volume",
                      mesh->triangle_count);
    if (st == CW_OK && r->facts.is_needed && !r->facts.is_wrapped)
        st = cwi_guard_repair(r, mesh, err);
    return st;
}

cw_status cw_mesh_repair(const cw_mesh *mesh, const cw_repair_desc *desc, cw_mesh *out,
                         cw_repair_facts *facts, cw_error *err)
{
    CWI_REQUIRE(err, mesh);
    CWI_REQUIRE_VERSION(err, desc, 0);
    cwi_repair r = {.desc = desc ? *desc : (cw_repair_desc){0}};
    cw_mesh input = {0}, own = {0}, *made = out ? out : &own;
    *made = (cw_mesh){0};
    if (facts)
        *facts = (cw_repair_facts){0};
    cw_status st = check_input(mesh, &r.desc, err);
    if (st == CW_OK)
        st = run_repair(&r, mesh, &input, err);
    const bool differs =
        r.facts.is_needed || r.facts.is_wrapped || input.vertex_count != mesh->vertex_count;
    if (st == CW_OK && out)
        st = differs ? make_result(&r, mesh, made, err) : cwi_mesh_copy(mesh, made, err);
    if (st == CW_OK)
        st = cwi_progress(&r.desc.progress, "repair", 1, err);
    if (facts && (st == CW_OK || st == CW_ERR_EMPTY || r.facts.is_refused))
        *facts = r.facts;
    if (st != CW_OK)
        cw_mesh_free(made);
    cw_mesh_free(&r.mesh);
    cw_mesh_free(&input);
    cwi_free(r.twin);
    cwi_free(r.seam);
    cwi_free(r.unjudged);
    return st;
}
