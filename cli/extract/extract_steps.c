/* Extracts, simplifies, measures and proves one surface of the command extract. */
#include "cli/extract/extract_run.h"

#include "cli/extract/extract_proof.h"
#include "cli/framework/console.h"
#include "cli/inputs/cut_options.h"
#include "cli/inputs/extract_surface.h"
#include "cli/inputs/place_options.h"
#include "cli/letters/engraved_text.h"
#include "cli/results/detail_levels.h"
#include "cli/results/mesh_comparison.h"
#include "cli/results/stage_facts.h"
#include "core/base/status.h"
#include "core/volume/volume.h"

#include <stdio.h>
#include <stdlib.h>

/* The share of pixels that may differ where nothing was to: places of a part of the volume are
 * rounded about another origin. */
static const double SAME_PICTURE = 1e-4;

/* The largest full surface that --simplify is compared with, in triangles, and what one of them
 * takes then: a few seconds, and a quarter of a gigabyte. */
enum { MAX_COMPARED = 1000000, COMPARED_BYTES = 256 };

static size_t voxel_count(const cw_volume *v)
{
    return v->dim[0] * v->dim[1] * v->dim[2];
}

/* That dropping components takes a triangle, if each has 8 triangles or more. */
enum { DROP_BYTES = 10 };

static cw_status find_error(const cli_extract_run *s, double *error, cw_error *err)
{
    const cli_extract_args *args = s->args;
    *error = args->simplify.error.given ? cli_extract_error_mm(s) : 0;
    if (args->pixel.most.given)
        *error = cli_extract_length_mm(s, &args->pixel.most);
    else if (args->pixel.pixels.given)
        return cli_widest_error(&s->input.volume, s->plan.views, s->plan.view_count,
                                args->pixel.pixels.value, error, err);
    return CW_OK;
}

/* error_mm  of the surface as it is extracted; with cameras: out of their sight */
static cw_simplify_desc simplify_desc(const cli_extract_run *s, double error)
{
    const bool seen = s->args->pixel.pixels.given;
    return (cw_simplify_desc){
        .error_mm = error,
        .triangles = s->args->simplify.triangles,
        .views = s->plan.views,
        .view_count = s->plan.view_count,
        .pixel_error = seen ? s->args->pixel.pixels.value : 0,
        .normal_deg =
            seen && cli_extract_shading(s->args) < 180 ? cli_extract_shading(s->args) : 0,
        .threads = (int)s->args->input.threads,
    };
}

/* Unless it is said otherwise, the normals of caps part where triangles are large, and the file has a place for
 * them. */
static bool parts_caps(const cli_extract_args *args)
{
    const cw_format *format = cw_mesh_format(args->output, args->format);
    return !args->crease.given && !args->open && !args->labels &&
           (args->lod.count || cli_extract_is_simplified(args)) && format &&
           format->keeps & CW_KEEPS_CREASES;
}

void cli_extract_describe_stages(const cli_extract_args *args, const cli_volume *volume,
                                 cli_surface_settings *set)
{
    set->handles = cli_extract_handles(args, volume);
    set->smooth = cli_extract_smoothing(args, volume);
    set->cut = cli_cut_desc(&args->cut);
    set->atlas = cli_atlas_desc(&args->texture);
    set->bake = cli_bake_desc(&args->texture, 0);
    set->desc = (cw_pipeline_desc){
        .min_volume_mm3 = cli_extract_least_mm3(args, volume),
        .largest = cli_extract_largest(args),
        .fill_voids = args->fill_voids,
        .close_handles = args->handles.given ? &set->handles : NULL,
        .smooth = args->smooth.given ? &set->smooth : NULL,
        .cut = args->cut.given ? &set->cut : NULL,
        .engrave = args->engrave ? &set->engrave : NULL,
        .cull = args->pixel.cull,
        .atlas = args->texture.uv ? &set->atlas : NULL,
        .bake = cli_find_maps(&args->texture) ? &set->bake : NULL,
        .crease_degrees = cli_crease_degrees(&args->crease),
        .crease_caps = parts_caps(args),
        .lod = args->lod.n,
        .lod_count = args->lod.count,
    };
}

/* Fills in the text that is engraved. */
static cw_status describe_text(const cli_extract_run *s, cli_surface_settings *set,
                               cw_error *err)
{
    char *text = NULL;
    const cw_status st =
        cli_fill_engraved_text(s->args->engrave, s->input.volume.path, NULL, NULL, &text, err);
    if (st != CW_OK)
        return cwi_fail_in(err, st, "--engrave");
    snprintf(set->text, sizeof set->text, "%s", text);
    set->engrave = (cw_engrave_desc){.text = set->text};
    free(text);
    return CW_OK;
}

cw_status cli_extract_describe(const cli_extract_run *s, double iso, cli_surface_settings *set,
                               cw_error *err)
{
    const cli_extract_args *args = s->args;
    cw_pipeline_desc *d = &set->desc;
    double error;
    cw_status st = find_error(s, &error, err);
    if (st != CW_OK)
        return st;
    cli_extract_describe_stages(args, &s->input.volume, set);
    if (args->engrave)
        st = describe_text(s, set, err);
    if (st != CW_OK)
        return st;
    d->extract =
        (cw_extract_desc){.isovalue = iso,
                          .inside_is_low = cli_extract_is_low(s),
                          .leave_open = args->open,
                          .simple_topology = args->topology,
                          .cubic_placement = args->placement,
                          .snap = args->snap.value,
                          .no_normals = args->normals,
                          .threads = (int)args->input.threads,
                          .max_triangles = args->max_triangles,
                          .extra_bytes = args->check || args->fill_voids ? cli_check_bytes()
                                         : d->min_volume_mm3 > 0 || d->largest ? DROP_BYTES
                                                                               : 0};
    set->simplify = simplify_desc(s, error);
    d->simplify = cli_extract_is_simplified(args) ? &set->simplify : NULL;
    d->views = (cw_simplify_view *)(uintptr_t)s->plan.views;
    d->view_count = s->plan.view_count;
    d->layers = args->slab;
    return CW_OK;
}

/* --- a run of the pipeline ------------------------------------------------------------------ */

void cli_extract_tell_stages(cli_extract_run *s, cli_made *made)
{
    cli_tell_stages(&(cli_staged){.subject = s->input.volume.path,
                                  .facts = &made->facts,
                                  .least_mm3 = made->least_mm3,
                                  .smooth = &s->args->smooth,
                                  .cut = &s->args->cut,
                                  .coloring = &s->coloring,
                                  .report = &s->output.report});
}

/* A run, and what its callbacks need. */
typedef struct making {
    cli_extract_run *run;
    const cli_moment *moment; /* of a series; NULL: the only step */
    bool has_levels;          /* of detail: they and all behind them are one step */
} making;

/* Each stage is a step. */
static void end_stage(void *user, cw_stage stage, size_t before, size_t after)
{
    making *m = user;
    cli_report *report = &m->run->output.report;
    m->has_levels = m->has_levels || stage == CW_STAGE_LOD;
    if (m->has_levels)
        return; /* texture coordinates and maps, too */
    cli_report_end(report, stage == CW_STAGE_COLOR ? "color" : cw_stage_name(stage),
                   stage == CW_STAGE_EXTRACT ? voxel_count(&m->run->input.volume.view) : before,
                   after);
    cli_report_begin(report);
}

static cw_status open_colors(void *user, const cw_volume **volume, cw_error *err)
{
    making *m = user;
    cli_extract_run *s = m->run;
    const cli_input *input = &s->args->input;
    return cli_open_coloring(&s->coloring, s->input.volume.path, input,
                             m->moment ? m->moment->step : input->step, volume, err);
}

cw_status cli_extract_run_pipeline(cli_extract_run *s, const cli_moment *moment, cli_made *made,
                                   cw_pipeline_sink sink, cw_error *err)
{
    cli_surface_settings set;
    making m = {.run = s, .moment = moment};
    cw_status st = cli_extract_describe(s, made->iso, &set, err);
    if (st != CW_OK)
        return st;
    cw_pipeline_color color = {0};
    if (s->args->color.by)
        color = cli_describe_coloring(&s->coloring);
    color.open = open_colors;
    color.user = &m;
    set.desc.color = s->args->color.by ? &color : NULL;
    set.desc.watch = (cw_pipeline_watch){cli_stage_progress, end_stage, &m};
    cli_report_begin(&s->output.report);
    st = cli_run_pipeline(&s->input.volume, s->plan.view_count ? NULL : s->input.extractor,
                          &set.desc, sink, &made->facts, err);
    if (st != CW_OK)
        return st;
    made->least_mm3 = set.desc.min_volume_mm3;
    cli_extract_tell_stages(s, made);
    return CW_OK;
}

cw_status cli_extract_take_maps(cli_extract_run *s, const cw_pipeline_surface *surface,
                                cw_error *err)
{
    return surface->maps && surface->level == 0
               ? cli_encode_maps(surface->maps, &s->output.maps, err)
               : CW_OK;
}

/* A surface on its way out of the pipeline. */
typedef struct taking {
    cli_extract_run *run;
    cw_mesh *mesh;
} taking;

static cw_status take_surface(void *user, cw_pipeline_surface *surface,
                              const cw_pipeline_facts *facts, cw_error *err)
{
    taking *t = user;
    (void)facts;
    *t->mesh = *surface->mesh;
    *surface->mesh = (cw_mesh){0};
    return cli_extract_take_maps(t->run, surface, err);
}

cw_status cli_extract_make(cli_extract_run *s, const cli_moment *moment, cli_made *made,
                           cw_mesh *mesh, cw_error *err)
{
    taking t = {s, mesh};
    *mesh = (cw_mesh){0};
    return cli_extract_run_pipeline(s, moment, made, (cw_pipeline_sink){take_surface, &t}, err);
}

/* The distance from the field would not tell of cubic crossings. */
static cw_status measure_from_field(cli_extract_run *s, cli_made *made, const cw_mesh *mesh,
                                    cw_error *err)
{
    if (s->args->placement)
        return CW_OK;
    if (cwi_volume_kind(&s->input.volume.view)) {
        cli_say("%s: %s: the distance to its field is not measured", s->input.volume.path,
                cwi_volume_kind(&s->input.volume.view));
        return CW_OK;
    }
    cli_report_begin(&s->output.report);
    cw_status st =
        cli_compare_with_field(mesh, &s->input.volume, made->iso, cli_extract_is_low(s),
                               (int)s->args->input.threads, &made->compared, err);
    if (st != CW_OK)
        return cwi_fail_in(err, st, s->input.volume.path);
    cli_report_end(&s->output.report, "measure", mesh->triangle_count, mesh->triangle_count);
    return CW_OK;
}

/* The full surface is extracted for that, which --simplify is there to do without: only one of
 * a size that costs little memory and time. */
static cw_status measure_from_full(cli_extract_run *s, cli_made *made, const cw_mesh *mesh,
                                   cw_error *err)
{
    const cw_extract_counts *counts = &made->facts.extracted;
    const bool fits = counts->triangles <= MAX_COMPARED &&
                      counts->triangles < s->input.volume.memory_left / COMPARED_BYTES;
    cli_surface_settings set;
    if (!fits) {
        cli_say("%s: the full surface has %s triangles: the distance to it is not measured "
                "(--max-error does)",
                s->input.volume.path, cli_count(counts->triangles));
        return CW_OK;
    }
    cli_report_begin(&s->output.report);
    cw_status st = cli_extract_describe(s, made->iso, &set, err);
    made->proof.bytes = counts->bytes;
    if (st == CW_OK)
        st = cli_prove_error(&s->input.volume, &set, mesh, &made->proof, &made->compared, err);
    if (st == CW_OK)
        cli_report_end(&s->output.report, "prove", made->proof.full_triangles,
                       mesh->triangle_count);
    return st;
}

/* Returns the handles of a surface that keeps too many triangles. */
static cli_handles_left find_handles(const cli_extract_run *s, const cli_made *made,
                                     const cw_mesh *mesh)
{
    cw_quality q;
    const cw_quality_desc desc = {.threads = (int)s->args->input.threads};
    const bool is_known = cw_quality_measure(mesh, &desc, &q, NULL) == CW_OK && q.genus > 0;
    return (cli_handles_left){is_known ? (size_t)q.genus : 0, made->facts.handles.length_mm};
}

cw_status cli_extract_judge(cli_extract_run *s, cli_made *made, const cw_mesh *mesh,
                            cw_error *err)
{
    const cw_extract_counts *counts = &made->facts.extracted;
    const cli_extract_args *args = s->args;
    const bool is_simplified = cli_extract_is_simplified(args);
    if (is_simplified)
        cli_say("%s: %s triangles were extracted, and simplified to %s", s->input.volume.path,
                cli_count(counts->triangles), cli_count(mesh->triangle_count));
    if (args->simplify.triangles && mesh->triangle_count > args->simplify.triangles)
        cli_report_left(&s->output.report, args->simplify.triangles, mesh->triangle_count,
                        find_handles(s, made, mesh), false);
    if (!args->check || !args->measure)
        return CW_OK;
    if (s->input.volume.streams) {
        cli_say(
            "%s: slice by slice, the distances to the field and to the full surface are not "
            "measured",
            s->input.volume.path);
        return CW_OK;
    }
    /* sections and letters are far from the isosurface, as they should be */
    cw_status st =
        args->cut.given || args->engrave ? CW_OK : measure_from_field(s, made, mesh, err);
    return st == CW_OK && is_simplified && !s->plan.view_count && !args->pixel.most.given
               ? measure_from_full(s, made, mesh, err)
               : st;
}

cw_status cli_extract_judge_print(cli_extract_run *s, cli_made *made, const cw_mesh *mesh,
                                  cw_error *err)
{
    if (s->args->profile != CLI_PROFILE_PRINT)
        return CW_OK;
    cli_report_begin(&s->output.report);
    cw_status st = cli_judge_print(made->path, mesh, &s->args->printer,
                                   (int)s->args->input.threads, &made->print, err);
    if (st == CW_OK)
        cli_report_end(&s->output.report, "print", mesh->triangle_count, 0);
    return st;
}

static cw_status hold_to_pixels(const cli_extract_run *s, const cli_proof *p, cw_error *err)
{
    for (size_t n = 0; n < p->count; n++)
        cli_say("%s: camera %zu: at most %.3g pixels off, %.3g promised; %.3g %% of its pixels "
                "differ by more than 2/255",
                s->input.volume.path, n + 1, p->views[n].pixels, p->promised_pixels,
                100 * p->views[n].apart);
    for (size_t n = 0; n < p->count; n++)
        if (p->views[n].pixels > 1.01 * p->promised_pixels)
            return cwi_fail(err, CW_ERR_CHECK,
                            "%s: not as promised: %.4g pixels off for camera %zu",
                            s->input.volume.path, p->views[n].pixels, n + 1);
        else if (p->promised_pixels == 0 && p->views[n].apart > SAME_PICTURE)
            return cwi_fail(
                err, CW_ERR_CHECK,
                "%s: culling changed %.3g %% of the pixels of camera %zu; none may change",
                s->input.volume.path, 100 * p->views[n].apart, n + 1);
    return CW_OK;
}

/* The promise was kept by bounds, all over; here it is seen from outside. */
cw_status cli_extract_prove(cli_extract_run *s, cli_made *made, const cw_mesh *mesh,
                            cw_error *err)
{
    cli_surface_settings set;
    cli_proof *p = &made->proof;
    const bool culls = made->facts.ran >> CW_STAGE_CULL & 1;
    p->culled = made->facts.culled;
    p->voxels = culls ? made->facts.voxels : 0;
    p->seen_voxels = culls ? made->facts.seen_voxels : 0;
    if (!s->args->check || !(s->plan.view_count || s->args->pixel.most.given))
        return CW_OK;
    cli_report_begin(&s->output.report);
    cw_status st = cli_extract_describe(s, made->iso, &set, err);
    if (st == CW_OK)
        st = s->plan.view_count
                 ? cli_prove_views(&s->input.volume, &set, mesh, p, err)
                 : cli_prove_error(&s->input.volume, &set, mesh, p, &made->compared, err);
    if (st != CW_OK)
        return st;
    p->bytes = made->facts.extracted.bytes;
    cli_report_end(&s->output.report, "prove", p->full_triangles, mesh->triangle_count);
    return hold_to_pixels(s, p, err);
}

cw_status cli_extract_prove_crop(cli_extract_run *s, const cli_moment *moment, cli_made *made,
                                 cw_error *err)
{
    const cli_crop_proof *p = &made->crop;
    cli_surface_settings set;
    cli_input input = s->args->input;
    if (!s->args->prove_crop)
        return CW_OK;
    input.step = moment->step;
    cli_report_begin(&s->output.report);
    cw_status st = cli_extract_describe(s, made->iso, &set, err);
    if (st == CW_OK)
        st = cli_prove_crop(&s->input.volume, &input, &set.desc.extract, &made->crop, err);
    if (st != CW_OK)
        return st;
    cli_report_end(&s->output.report, "prove crop", p->whole_triangles, p->triangles);
    cli_say("%s: the same %s triangles as in the whole surface: %.3g %% of its %s, from %.3g "
            "%% of the voxels; %s and %.3g s in place of %s and %.3g s",
            s->input.volume.path, cli_count(p->triangles),
            100 * (double)p->triangles / (double)p->whole_triangles,
            cli_count(p->whole_triangles), 100 * (double)p->voxels / (double)p->whole_voxels,
            cli_bytes((double)p->bytes), p->seconds, cli_bytes((double)p->whole_bytes),
            p->whole_seconds);
    return CW_OK;
}

cw_status cli_extract_place(cli_extract_run *s, cli_made *made, cw_mesh *mesh, cw_error *err)
{
    const cli_number *angle = &s->args->orient_print;
    cli_mesh turned = {.path = s->input.volume.path, .mesh = *mesh};
    cw_status st = CW_OK;
    if (angle->given)
        st = cli_orient_for_print(angle, (int)s->args->input.threads, &turned, &made->orient,
                                  err);
    *mesh = turned.mesh;
    return st == CW_OK ? cli_move_to_pivot(s->args->pivot, mesh, 1, made->pivot, err) : st;
}
