/* Extracts, simplifies, measures and proves one surface of the command extract. */
#include "cli/extract/extract_run.h"

#include "cli/extract/extract_proof.h"
#include "cli/extract/small_components.h"
#include "cli/framework/console.h"
#include "cli/inputs/extract_surface.h"
#include "cli/results/mesh_comparison.h"
#include "cli/results/smoothed.h"
#include "core/base/status.h"
#include "core/volume/volume.h"

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

cli_wanted cli_extract_wants(const cli_extract_run *s, double iso)
{
    const double least_mm3 = cli_extract_least_mm3(s);
    return (cli_wanted){
        .extract = {.isovalue = iso,
                    .inside_is_low = cli_extract_is_low(s),
                    .leave_open = s->args->open,
                    .simple_topology = s->args->topology,
                    .cubic_placement = s->args->placement,
                    .snap = s->args->snap.value,
                    .no_normals = s->args->normals ||
                                  (s->args->lod.count && cli_extract_shades_levels(s) &&
                                   !s->args->smooth.given && !s->args->cut.given),
                    .threads = (int)s->args->input.threads,
                    .max_triangles = s->args->max_triangles,
                    .extra_bytes = s->args->check || s->args->fill_voids ? cli_check_bytes()
                                   : least_mm3 > 0 || cli_extract_largest(s->args) ? DROP_BYTES
                                                                                   : 0},
        .least_mm3 = least_mm3,
        .largest = cli_extract_largest(s->args),
        .fill_voids = s->args->fill_voids,
        .cut = s->args->cut.given ? &s->args->cut : NULL,
        .smooths = s->args->smooth.given,
        .smooth = s->args->smooth.given ? cli_extract_smoothing(s) : (cw_smooth_desc){0},
    };
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

/* Returns the margin around a picture, in pixels, so that rounding loses no triangle of it. */
static double pixels_around(const cli_extract_run *s)
{
    return 1 + (s->args->pixel.pixels.given ? s->args->pixel.pixels.value : 0);
}

/* Depths of the surface first, then what they leave of it. To be culled, it is extracted where
 * it may be seen only, unless all of a component counts. */
static cw_status extract_for_views(cli_extract_run *s, const cli_wanted *w,
                                   const cw_simplify_desc *simplify, cli_made *made,
                                   cw_mesh *mesh, cw_extract_counts *counts, cw_error *err)
{
    const bool cull = s->args->pixel.cull;
    cli_proof *p = &made->proof;
    cli_volume part = s->input.volume;
    cw_status st = CW_OK;
    for (size_t n = 0; n < s->plan.view_count; n++)
        cw_simplify_view_free(s->plan.views + n);
    if (cull && !cli_wants_whole(w))
        st = cli_seen_part(&s->input.volume, s->plan.views, s->plan.view_count, &part, err);
    if (st == CW_OK)
        st = cli_draw_views(&part, w, s->plan.views, s->plan.view_count, err);
    if (st == CW_OK)
        st = cli_extract_is_simplified(s->args)
                 ? cli_extract_simplified(&part, w, simplify, mesh, counts, &made->components,
                                          err)
                 : cli_extract_wanted(&part, NULL, w, mesh, counts, &made->components, err);
    if (st != CW_OK || !cull)
        return st;
    p->voxels = voxel_count(&s->input.volume.view);
    p->seen_voxels = voxel_count(&part.view);
    return cli_cull(&s->input.volume, s->plan.views, s->plan.view_count, pixels_around(s),
                    simplify->error_mm, mesh, &p->culled, err);
}

static void tell_smoothing(cli_extract_run *s, const cli_made *made)
{
    const cw_smooth_facts *f = &made->smoothed;
    char text[CLI_SMOOTHED_TEXT];
    cli_smoothed_text(f, text);
    cli_say("%s: smoothed by %s: %s", s->input.volume.path,
            cli_smoothing_text(&s->args->smooth), text);
    if (f->undecided)
        cli_report_warn(&s->output.report, "too many triangles are in one place: new "
                                           "intersections there were not looked for");
}

cw_status cli_extract_make(cli_extract_run *s, cli_made *made, cw_mesh *mesh,
                           cw_extract_counts *counts, cw_error *err)
{
    cli_wanted w = cli_extract_wants(s, made->iso);
    cw_drop_counts smaller = {0};
    w.filled = &made->voids;
    w.smoothed = &made->smoothed;
    w.cut_facts = &made->cut;
    w.smaller = &smaller;
    cw_drop_counts *dropped = &made->components;
    double error;
    cw_status st = find_error(s, &error, err);
    if (st != CW_OK)
        return st;
    const cw_simplify_desc simplify = simplify_desc(s, error);
    cli_report_begin(&s->output.report);
    if (s->plan.view_count)
        st = extract_for_views(s, &w, &simplify, made, mesh, counts, err);
    else if (cli_extract_is_simplified(s->args))
        st =
            cli_extract_simplified(&s->input.volume, &w, &simplify, mesh, counts, dropped, err);
    else
        st = cli_extract_wanted(&s->input.volume, s->input.extractor, &w, mesh, counts, dropped,
                                err);
    if (st != CW_OK)
        return st;
    cli_report_end(&s->output.report, "extract", voxel_count(&s->input.volume.view),
                   mesh->triangle_count);
    made->least_mm3 = w.least_mm3;
    if (w.least_mm3 > 0)
        cli_tell_components(s->input.volume.path, w.least_mm3, dropped);
    if (w.largest)
        cli_say("%s: %s of %s components kept, of %.6g mm3 or more; the largest of the others "
                "has %.6g mm3",
                s->input.volume.path, cli_count(smaller.kept),
                cli_count(smaller.kept + smaller.dropped), smaller.least_kept_mm3,
                smaller.largest_mm3);
    made->fills_voids = w.fill_voids;
    if (w.fill_voids)
        cli_say("%s: %s void%s filled, %.6g mm3", s->input.volume.path,
                cli_count(made->voids.dropped), made->voids.dropped == 1 ? "" : "s",
                made->voids.dropped_mm3);
    made->is_smoothed = w.smooths;
    if (w.smooths)
        tell_smoothing(s, made);
    made->is_cut = w.cut != NULL;
    if (w.cut)
        cli_tell_cut(s->input.volume.path, w.cut, &made->cut);
    if (s->args->pixel.cull)
        cli_say("%s: %.3g %% of the voxels are in bricks that cameras see; %s triangles in "
                "them that no camera sees are left out",
                s->input.volume.path,
                100 * (double)made->proof.seen_voxels / (double)made->proof.voxels,
                cli_count(made->proof.culled));
    return CW_OK;
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
                                   const cw_extract_counts *counts, cw_error *err)
{
    const cli_wanted w = cli_extract_wants(s, made->iso);
    const bool fits = counts->triangles <= MAX_COMPARED &&
                      counts->triangles < s->input.volume.memory_left / COMPARED_BYTES;
    double error;
    if (!fits) {
        cli_say("%s: the full surface has %s triangles: the distance to it is not measured "
                "(--max-error does)",
                s->input.volume.path, cli_count(counts->triangles));
        return CW_OK;
    }
    cli_report_begin(&s->output.report);
    cw_status st = find_error(s, &error, err);
    const cw_simplify_desc simplify = simplify_desc(s, error);
    made->proof.bytes = counts->bytes;
    if (st == CW_OK)
        st = cli_prove_error(&s->input.volume, &w, &simplify, mesh, &made->proof,
                             &made->compared, err);
    if (st == CW_OK)
        cli_report_end(&s->output.report, "prove", made->proof.full_triangles,
                       mesh->triangle_count);
    return st;
}

cw_status cli_extract_judge(cli_extract_run *s, cli_made *made, const cw_mesh *mesh,
                            const cw_extract_counts *counts, cw_error *err)
{
    const cli_extract_args *args = s->args;
    const bool is_simplified = cli_extract_is_simplified(args);
    if (is_simplified)
        cli_say("%s: %s triangles were extracted, and simplified to %s", s->input.volume.path,
                cli_count(counts->triangles), cli_count(mesh->triangle_count));
    if (args->simplify.triangles && mesh->triangle_count > args->simplify.triangles)
        cli_report_warn(&s->output.report,
                        "%s triangles were requested, %s are left: removing more would tear "
                        "the surface, flip it or make it intersect itself",
                        cli_count(args->simplify.triangles), cli_count(mesh->triangle_count));
    if (!args->check || !args->measure)
        return CW_OK;
    if (s->input.volume.streams) {
        cli_say(
            "%s: slice by slice, the distances to the field and to the full surface are not "
            "measured",
            s->input.volume.path);
        return CW_OK;
    }
    /* a section is far from the isosurface, as it should be */
    cw_status st = args->cut.given ? CW_OK : measure_from_field(s, made, mesh, err);
    return st == CW_OK && is_simplified && !s->plan.view_count && !args->pixel.most.given
               ? measure_from_full(s, made, mesh, counts, err)
               : st;
}

cw_status cli_extract_color(cli_extract_run *s, const cli_moment *moment, cw_mesh *mesh,
                            cw_error *err)
{
    const cli_input *input = &s->args->input;
    cw_sample_facts facts;
    if (!s->args->color.by)
        return CW_OK;
    cli_report_begin(&s->output.report);
    cw_status st = cli_color_mesh(&s->coloring, s->input.volume.path, input,
                                  moment ? moment->step : input->step, mesh, &facts, err);
    if (st == CW_OK)
        cli_report_end(&s->output.report, "color", mesh->vertex_count, mesh->vertex_count);
    return st;
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
                "%s: not as promised: without what is left out %.3g %% of the pixels "
                "of camera %zu differ",
                s->input.volume.path, 100 * p->views[n].apart, n + 1);
    return CW_OK;
}

/* The promise was kept by bounds, all over; here it is seen from outside. */
cw_status cli_extract_prove(cli_extract_run *s, cli_made *made, const cw_mesh *mesh,
                            size_t bytes, cw_error *err)
{
    const cli_wanted w = cli_extract_wants(s, made->iso);
    cli_proof *p = &made->proof;
    double error;
    if (!s->args->check || !(s->plan.view_count || s->args->pixel.most.given))
        return CW_OK;
    cli_report_begin(&s->output.report);
    cw_status st = find_error(s, &error, err);
    const cw_simplify_desc simplify = simplify_desc(s, error);
    if (st == CW_OK)
        st = s->plan.view_count ? cli_prove_views(&s->input.volume, &w, &simplify, mesh, p, err)
                                : cli_prove_error(&s->input.volume, &w, &simplify, mesh, p,
                                                  &made->compared, err);
    if (st != CW_OK)
        return st;
    p->bytes = bytes;
    cli_report_end(&s->output.report, "prove", p->full_triangles, mesh->triangle_count);
    return hold_to_pixels(s, p, err);
}

cw_status cli_extract_prove_crop(cli_extract_run *s, const cli_moment *moment, cli_made *made,
                                 cw_error *err)
{
    const cli_wanted w = cli_extract_wants(s, made->iso);
    const cli_crop_proof *p = &made->crop;
    cli_input input = s->args->input;
    if (!s->args->prove_crop)
        return CW_OK;
    input.step = moment->step;
    cli_report_begin(&s->output.report);
    cw_status st = cli_prove_crop(&s->input.volume, &input, &w, &made->crop, err);
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
