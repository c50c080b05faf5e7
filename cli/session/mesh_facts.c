/* Makes the mesh that a session saves, and measures what people want to know of it before. */
#include "cli/session/view.h"

#include "cli/framework/quantity.h"
#include "cli/inputs/extract_surface.h"
#include "core/base/status.h"

#include <cubewright/distance.h>
#include <cubewright/quality.h>
#include <cubewright/simplify.h>

#include <stdio.h>

/* Makes the surface that `extract --simplify` makes; of a mesh that was read or drawn, a simplified one. */
static cw_status reduce_surface(const view *v, const cw_mesh *full,
                                const cw_simplify_desc *desc, cw_mesh *mesh, cw_error *err)
{
    const render_args *args = &v->state.args;
    const cw_pipeline_desc pipeline = {
        .extract = {.isovalue = args->iso.value,
                    .inside_is_low =
                        cli_inside_is_low(args->inside, &v->document.source.volume.whole),
                    .threads = desc->threads},
        .simplify = desc};
    if (v->document.source.is_mesh || !args->iso.given || view_shows_surfaces(v))
        return cw_simplify(full, desc, mesh, NULL, err);
    return cli_make_surface(&v->document.source.volume, NULL, &pipeline, mesh, NULL, err);
}

static cw_status simplify_surface(const view *v, const cw_mesh *full, size_t triangles,
                                  cw_mesh *mesh, view_mesh_facts *facts, cw_error *err)
{
    const cw_simplify_desc desc = {.triangles = triangles,
                                   .threads = (int)v->state.args.input.threads};
    cw_mesh_comparison c = {0};
    cw_status st = reduce_surface(v, full, &desc, mesh, err);
    if (st == CW_OK)
        st = cw_mesh_compare(mesh, full, &(cw_mesh_distance_desc){.threads = desc.threads}, &c,
                             err);
    facts->has_error = st == CW_OK;
    facts->error_from = "the full surface";
    facts->max_mm = cw_mesh_comparison_max(&c);
    facts->rms_mm = cw_mesh_comparison_rms(&c);
    return st;
}

/* Measures how far a mesh is from the field, on even grids. */
static void measure_from_field(const view *v, const cw_mesh *mesh, view_mesh_facts *facts)
{
    const render_args *args = &v->state.args;
    const cw_field_distance_desc desc = {
        .isovalue = args->iso.value,
        .inside_is_low = cli_inside_is_low(args->inside, &v->document.source.volume.whole),
        .threads = (int)args->input.threads};
    cw_distance d;
    if (v->document.source.is_mesh || !args->iso.given || view_shows_surfaces(v))
        return;
    facts->has_error = cw_distance_to_field(mesh, &v->document.source.volume.view, &desc, &d,
                                            NULL, NULL) == CW_OK;
    facts->error_from = "the field";
    facts->max_mm = d.max_mm;
    facts->rms_mm = d.rms_mm;
}

static cw_status measure_topology(const view *v, const cw_mesh *mesh, view_mesh_facts *facts,
                                  cw_error *err)
{
    const cw_quality_desc desc = {.threads = (int)v->state.args.input.threads};
    cw_quality q;
    cw_status st = cw_quality_measure(mesh, &desc, &q, err);
    if (st != CW_OK)
        return st;
    facts->triangles = q.triangles;
    facts->vertices = q.vertices;
    facts->open_edges = q.open_edges;
    facts->is_closed = cw_quality_is_closed_manifold(&q);
    return CW_OK;
}

cw_status view_need_whole(view *v, cw_error *err)
{
    if (!view_has_mesh(v))
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "no surface is shown: choose an isovalue, such as 'iso %.5g'",
                        view_suggest_iso(v));
    cw_status st = view_need_surface(v, VIEW_FINAL, err);
    if (st == CW_OK && view_whole_mesh(v)->triangle_count == 0)
        st = cwi_fail(err, CW_ERR_ARGUMENT, "the surface has no triangles");
    return st;
}

cw_status view_make_mesh(view *v, size_t triangles, cw_mesh *simplified, const cw_mesh **mesh,
                         view_mesh_facts *facts, cw_error *err)
{
    *facts = (view_mesh_facts){0};
    *simplified = (cw_mesh){0};
    *mesh = NULL;
    if (!v->document.path)
        return cwi_fail(err, CW_ERR_ARGUMENT, "no file is open");
    cw_status st = view_need_whole(v, err);
    if (st != CW_OK)
        return st;
    const cw_mesh *whole = view_whole_mesh(v);
    *mesh = whole;
    if (triangles && triangles < whole->triangle_count) {
        st = simplify_surface(v, whole, triangles, simplified, facts, err);
        *mesh = simplified;
    } else {
        measure_from_field(v, *mesh, facts);
    }
    if (st == CW_OK)
        st = measure_topology(v, *mesh, facts, err);
    if (st != CW_OK)
        cw_mesh_free(simplified);
    return st;
}

void view_describe_mesh(const view_mesh_facts *f, char *text, size_t size)
{
    int used = snprintf(text, size, "%s triangles, %s", cli_count(f->triangles),
                        f->is_closed ? "closed" : "not a closed solid");
    if (f->open_edges)
        used += snprintf(text + used, size - (size_t)used, " (%zu open edges)", f->open_edges);
    if (f->has_error)
        snprintf(text + used, size - (size_t)used, "; at most %.3g mm from %s (rms %.2g mm)",
                 f->max_mm, f->error_from, f->rms_mm);
}
