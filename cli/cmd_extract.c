#include "cli/commands.h"
#include "cli/compare.h"
#include "cli/console.h"
#include "cli/deliver.h"
#include "cli/frames.h"
#include "cli/output.h"
#include "cli/pixels.h"
#include "cli/proof.h"
#include "cli/pvd.h"
#include "cli/quantity.h"
#include "cli/surface.h"
#include "core/status.h"
#include "core/volume.h"

#ifdef __GLIBC__
#include <malloc.h>
#endif
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

typedef struct extract_args {
    cli_common common;
    cli_input input;
    cli_compress compress;
    const char *output, *name, *format, *json, *pvd;
    cli_numbers iso;
    cli_steps steps;
    cli_number snap, fps;
    cli_reduction simplify;
    cli_amount least;
    cli_pixel_args pixel;
    int inside, normals, progress, topology, placement, accel;
    bool open, no_clobber, local, check, animate, prove_crop;
    size_t max_triangles;
} extract_args;

enum { PROVENANCE_LINES = 5, DEFAULT_FPS = 10 };

/* Degrees: of a head in 1280 x 720 pixels 1 in 200 then looks different, of 2 degrees 1 in 100.
 */
static const double SHADING = 1.5;

/* The share of pixels that may differ where nothing was to: places of a part of the volume are
 * rounded about another origin. */
static const double SAME_PICTURE = 1e-4;

static const extract_args defaults = {.check = true};

static const cli_option options[] = {
    {"output", 'o', CLI_TEXT, "FILE",
     "the mesh, in the format of its extension; may hold {level}, {step} and {stem}",
     offsetof(extract_args, output)},
    {"iso", 'i', CLI_NUMBERS, "V[,V...]",
     "the isovalue, or some, in the unit of the values (required; of level sets 0)",
     offsetof(extract_args, iso)},
    {"steps", 0, CLI_STEPS, "A:B:S/N,.../all",
     "steps of a time series, from 0, a mesh each (of one file: --step; of files: all)",
     offsetof(extract_args, steps)},
    {"animate", 0, CLI_FLAG, NULL, "one glTF file that shows the steps one after another",
     offsetof(extract_args, animate)},
    {"pvd", 0, CLI_TEXT, "FILE",
     "list the .vtp files of the steps, with their times, for ParaView",
     offsetof(extract_args, pvd)},
    {"fps", 0, CLI_NUMBER, "N", "steps a second of --animate (as the file times them, else 10)",
     offsetof(extract_args, fps)},
    {"inside", 0, CLI_CHOICE, CLI_INSIDE_CHOICES,
     "which values are inside the solid (auto: above, of level sets below)",
     offsetof(extract_args, inside)},
    {"open", 0, CLI_FLAG, NULL, "leave the surface open where the volume ends (closed)",
     offsetof(extract_args, open)},
    {"topology", 0, CLI_CHOICE, "field/simple",
     "in ambiguous cells: the trilinear field's, or one table's (field)",
     offsetof(extract_args, topology)},
    {"placement", 0, CLI_CHOICE, "linear/cubic",
     "crossings on the line or the cubic through the samples along an edge (linear)",
     offsetof(extract_args, placement)},
    {"snap", 0, CLI_NUMBER, "SHARE",
     "merge crossings within this share of an edge from one sample, to 0.5; try 0.3 (off)",
     offsetof(extract_args, snap)},
    {"simplify", 0, CLI_REDUCTION, "L|N",
     "while extracting, as far as an error allows (0.1mm, 0.05%, 0.5vox) or to so many "
     "triangles (50k) (off)",
     offsetof(extract_args, simplify)},
    {"min-volume", 0, CLI_VOLUME, "V",
     "leave out components that enclose less, with what is in them: 500mm3, 0.5ml, 30vox "
     "(none)",
     offsetof(extract_args, least)},
    {"camera", 0, CLI_TEXT, "FILE[,FILE...]",
     "keep only what the pictures of these cameras need; .json files of render, or the text of "
     "one; with --pixel-error",
     offsetof(extract_args, pixel.camera)},
    {"pixel-error", 0, CLI_NUMBER, "N",
     "so many pixels of --camera the surface may be off, where it is seen",
     offsetof(extract_args, pixel.pixels)},
    {"cull", 0, CLI_FLAG, NULL,
     "leave out what no --camera sees, beside its picture or behind the surface (off)",
     offsetof(extract_args, pixel.cull)},
    {"size", 0, CLI_SIZES, "WxH", "of those pictures, in pixels (1280x720)",
     offsetof(extract_args, pixel.size)},
    {"shading", 0, CLI_NUMBER, "DEG",
     "what --camera sees is joined where normals agree within this; 180 is anywhere (1.5)",
     offsetof(extract_args, pixel.shading)},
    {"max-error", 0, CLI_LENGTH, "L",
     "as --simplify, no farther from the full surface than this (0.2mm, 0.05%, 0.5vox), and "
     "measured, both ways; with --camera out of sight (off)",
     offsetof(extract_args, pixel.most)},
    {"normals", 0, CLI_CHOICE, "field/none", "normals from the field's gradient (field)",
     offsetof(extract_args, normals)},
    {"accel", 0, CLI_CHOICE, "octree/none",
     "whether isovalues share one pass over the voxels; same bytes (octree)",
     offsetof(extract_args, accel)},
    {"name", 0, CLI_TEXT, "TEXT", "of the object inside the file (the output's stem)",
     offsetof(extract_args, name)},
    {"format", 0, CLI_TEXT, "NAME", "write this format of 'formats' (by extension)",
     offsetof(extract_args, format)},
    {"no-clobber", 0, CLI_FLAG, NULL, "fail when the output exists (replace it)",
     offsetof(extract_args, no_clobber)},
    {"local", 0, CLI_FLAG, NULL,
     "coordinates relative to the mesh's origin, which is printed (the world's)",
     offsetof(extract_args, local)},
    {"check", 0, CLI_FLAG, NULL, "measure the mesh: closed, manifold, size (on; --no-check)",
     offsetof(extract_args, check)},
    {"prove-crop", 0, CLI_FLAG, NULL,
     "extract the whole volume, too: its surface is the same there, and what --crop saved "
     "(off)",
     offsetof(extract_args, prove_crop)},
    {"max-triangles", 0, CLI_COUNT, "N", "stop before making more, e.g. 100M (no limit)",
     offsetof(extract_args, max_triangles)},
    {"json", 0, CLI_TEXT, "FILE", "write a report; - is the standard output",
     offsetof(extract_args, json)},
    {"progress", 0, CLI_CHOICE, "auto/plain/json/none", "how to show it, on stderr (auto)",
     offsetof(extract_args, progress)},
    {"preview", 0, CLI_FLAG, NULL, "a quick look: every 4th voxel along each axis (all)",
     CLI_INPUT_ROW(extract_args, preview)},
    {"coarsen", 0, CLI_COUNT, "N", "a preview of every N-th voxel (4 with --preview, else 1)",
     CLI_INPUT_ROW(extract_args, coarsen)},
    CLI_COMPRESS_OPTIONS(extract_args),
    CLI_INPUT_OPTIONS(extract_args),
};

typedef struct run_state {
    const extract_args *args;
    cli_series series;
    cli_volume first; /* of a series of files, without voxels: what the report shows */
    cli_volume volume;
    cw_extractor *extractor; /* NULL: every surface by itself */
    cli_frames frames;       /* of --animate */
    double fps;              /* of those; 0: as the file times them */
    size_t memory;           /* left when the voxels were read */
    cw_simplify_view views[CLI_MOST_VIEWS];
    size_t view_count;
    cli_outputs outputs;
    cli_report report;
    double start; /* of the surface at hand */
} run_state;

static size_t voxel_count(const cw_volume *v)
{
    return v->dim[0] * v->dim[1] * v->dim[2];
}

static double voxel_mm(const run_state *s)
{
    const double *spacing = s->volume.spacing;
    return cbrt(spacing[0] * spacing[1] * spacing[2]);
}

/* Shares are of the diagonal of the volume's box. */
static double length_mm(const run_state *s, const cli_length *length)
{
    double square = 0;
    for (int a = 0; a < 3; a++) {
        const cli_grid *g = &s->volume.grid;
        const double side = s->volume.view.cells
                                ? g->high[a] - g->low[a]
                                : s->volume.spacing[a] * (double)(s->volume.view.dim[a] - 1);
        square += side * side;
    }
    return cli_length_mm(length, sqrt(square), voxel_mm(s));
}

static double error_mm(const run_state *s)
{
    return length_mm(s, &s->args->simplify.error);
}

/* What components have to enclose; 0: nothing. */
static double least_mm3(const run_state *s)
{
    const cli_amount *least = &s->args->least;
    const double voxel = voxel_mm(s);
    return !least->given   ? 0
           : least->voxels ? least->value * voxel * voxel * voxel
                           : least->value;
}

static bool is_low(const run_state *s)
{
    return cli_inside_is_low(s->args->inside, &s->volume.whole);
}

static bool is_simplified(const extract_args *args)
{
    return args->simplify.error.given || args->simplify.triangles || args->pixel.pixels.given ||
           args->pixel.most.given;
}

static double shading(const extract_args *args)
{
    return args->pixel.shading.given ? args->pixel.shading.value : SHADING;
}

static void put_pixels(cli_json *j, const run_state *s)
{
    const cli_pixel_args *a = &s->args->pixel;
    if (a->most.given)
        cli_json_number(j, "max_error_mm", length_mm(s, &a->most));
    if (!a->camera)
        return;
    cli_json_count(j, "cameras", s->view_count);
    cli_json_bool(j, "cull", a->cull);
    cli_json_count(j, "width", s->views[0].width);
    cli_json_count(j, "height", s->views[0].height);
    if (!a->pixels.given)
        return;
    cli_json_number(j, "pixel_error", a->pixels.value);
    cli_json_number(j, "shading_deg", shading(s->args));
}

static void put_params(cli_json *j, const void *p, const cli_made *made)
{
    const run_state *s = p;
    const extract_args *args = s->args;
    const size_t *step = s->volume.coarsen;
    cli_json_number(j, "iso", made->iso);
    cli_json_text(j, "inside", is_low(s) ? "below" : "above");
    cli_json_bool(j, "open", args->open);
    cli_json_text(j, "topology", args->topology ? "simple" : "field");
    cli_json_text(j, "placement", args->placement ? "cubic" : "linear");
    cli_json_number(j, "snap", args->snap.value);
    if (args->simplify.error.given)
        cli_json_number(j, "simplify_error_mm", error_mm(s));
    else if (args->simplify.triangles)
        cli_json_count(j, "simplify_triangles", args->simplify.triangles);
    if (args->least.given)
        cli_json_number(j, "min_volume_mm3", least_mm3(s));
    put_pixels(j, s);
    cli_json_text(j, "normals", args->normals ? "none" : "field");
    if (args->iso.count > 1)
        cli_json_text(j, "accel", args->accel ? "none" : "octree");
    cli_json_count(j, "component", args->input.component);
    cli_json_count(j, "step", made->moment ? made->moment->number : args->input.step);
    if (cli_is_preview(&s->volume))
        cli_json_numbers(j, "coarsen",
                         (double[3]){(double)step[0], (double)step[1], (double)step[2]}, 3);
}

static cw_write_desc write_desc(const extract_args *args)
{
    return (cw_write_desc){.format = args->format,
                           .name = args->name,
                           .no_clobber = args->no_clobber,
                           .local = args->local,
                           .animated = args->animate,
                           .compression = (cw_compression)args->compress.kind,
                           .bits = (int)args->compress.bits};
}

/* The report is an output too: none is written when it is an input or a mesh. */
static cw_status check_report(run_state *s, const char *const *inputs, size_t count,
                              cw_error *err)
{
    const char *json = s->args->json;
    s->report.path = NULL;
    cw_status st = json ? cli_check_output(json, inputs, count, err) : CW_OK;
    for (size_t n = 0; n < s->outputs.count && json && st == CW_OK; n++)
        st = cli_check_apart(json, s->outputs.path[n], err);
    s->report.path = st == CW_OK ? json : NULL;
    return st;
}

static cw_status check_pvd(const run_state *s, const char *const *inputs, size_t count,
                           cw_error *err)
{
    const extract_args *args = s->args;
    const cw_write_desc desc = write_desc(args);
    cw_status st = CW_OK;
    if (!args->pvd)
        return CW_OK;
    if (!s->series.given)
        return cw_fail(err, CW_ERR_ARGUMENT, "--pvd is for the steps of a series: --steps");
    if (args->json)
        st = cli_check_apart(args->pvd, args->json, err);
    return st == CW_OK ? cli_check_pvd(args->pvd, &s->outputs, inputs, count, &desc, err) : st;
}

/* Names and checks the outputs, once it is known of which steps there will be one. */
static cw_status check_outputs(run_state *s, cw_error *err)
{
    const extract_args *args = s->args;
    const cw_write_desc desc = write_desc(args);
    const size_t files = s->series.files.count, count = files ? files : 1;
    const char *const *inputs =
        files ? (const char *const *)s->series.files.path : args->common.inputs;
    cli_series named = s->series;
    named.count = args->animate ? 1 : named.count;
    cw_status st = cli_name_outputs(&s->outputs, args->output, &named, &args->iso, err);
    if (st == CW_OK)
        st = check_report(s, inputs, count, err);
    if (st == CW_OK)
        st = cli_check_outputs(&s->outputs, inputs, count, &desc, err);
    return st == CW_OK ? check_pvd(s, inputs, count, err) : st;
}

static cw_status check_animation(const extract_args *args, cw_error *err)
{
    if (args->pvd && args->animate)
        return cw_fail(err, CW_ERR_ARGUMENT,
                       "--pvd lists files, and --animate writes only one");
    if (args->fps.given && !args->animate)
        return cw_fail(err, CW_ERR_ARGUMENT, "--fps is for --animate");
    if (args->fps.given && !(args->fps.value > 0))
        return cw_fail(err, CW_ERR_ARGUMENT, "--fps %g: it must be above 0", args->fps.value);
    if (args->animate && args->iso.count > 1)
        return cw_fail(err, CW_ERR_ARGUMENT, "--animate shows one level; --iso lists %zu",
                       args->iso.count);
    return CW_OK;
}

/* What asks for fewer triangles. */
static const char *reducer(const extract_args *args)
{
    return args->pixel.camera       ? "--camera"
           : args->pixel.most.given ? "--max-error"
                                    : "--simplify";
}

static cw_status check_pixels(run_state *s, cw_error *err)
{
    const extract_args *args = s->args;
    cw_status st = cli_read_views(&args->pixel, s->views, &s->view_count, err);
    if (st != CW_OK)
        return st;
    if ((args->pixel.camera || args->pixel.most.given) &&
        (args->simplify.error.given || args->simplify.triangles))
        return cw_fail(err, CW_ERR_ARGUMENT, "%s or --simplify, not both", reducer(args));
    return CW_OK;
}

static cw_status check_crop(const extract_args *args, cw_error *err)
{
    const cli_input *input = &args->input;
    if (!args->prove_crop)
        return CW_OK;
    if (!input->crop.given)
        return cw_fail(err, CW_ERR_ARGUMENT, "--prove-crop is for what --crop leaves");
    if (input->preview || input->coarsen || args->snap.value > 0)
        return cw_fail(
            err, CW_ERR_ARGUMENT,
            "--prove-crop is for all voxels and their crossings: it cannot be with %s",
            args->snap.value > 0 ? "--snap" : "a preview");
    return CW_OK;
}

/* Everything about the arguments that can be refused before the input is touched. */
static cw_status check_args(run_state *s, cw_error *err)
{
    const extract_args *args = s->args;
    const char *const *input = args->common.inputs;
    cw_status st = check_report(s, input, args->common.input_count, err);
    if (st == CW_OK)
        st = cli_check_compress(&args->compress, true, err);
    if (st != CW_OK)
        return st;
    if (!args->output)
        return cw_fail(err, CW_ERR_ARGUMENT, "extract needs an output: -o FILE");
    if (!args->iso.count)
        return cw_fail(err, CW_ERR_ARGUMENT,
                       "extract needs a level: --iso V; 'cubewright info %s' suggests some",
                       input[0]);
    if (!(args->snap.value >= 0 && args->snap.value <= CW_EXTRACT_MAX_SNAP))
        return cw_fail(err, CW_ERR_ARGUMENT,
                       "--snap is a share of an edge, 0 to %g, and not %g", CW_EXTRACT_MAX_SNAP,
                       args->snap.value);
    st = check_pixels(s, err);
    if (st == CW_OK)
        st = check_crop(args, err);
    if (st != CW_OK)
        return st;
    if (args->pixel.cull && args->snap.value > 0)
        return cw_fail(err, CW_ERR_ARGUMENT,
                       "--cull needs the plain surface: it cannot be with --snap");
    if (is_simplified(args) && args->snap.value > 0)
        return cw_fail(err, CW_ERR_ARGUMENT,
                       "--snap and %s both remove needles: give one of them", reducer(args));
    if (is_simplified(args) && !cw_simplify_available())
        return cw_fail(err, CW_ERR_UNSUPPORTED,
                       "%s needs OpenMesh, which this build is without: install "
                       "libopenmesh-dev and build again",
                       reducer(args));
    return check_animation(args, err);
}

static cli_wanted wanted(const run_state *s, double iso)
{
    return (cli_wanted){
        .extract = {.isovalue = iso,
                    .inside_is_low = is_low(s),
                    .leave_open = s->args->open,
                    .simple_topology = s->args->topology,
                    .cubic_placement = s->args->placement,
                    .snap = s->args->snap.value,
                    .no_normals = s->args->normals,
                    .threads = (int)s->args->input.threads,
                    .max_triangles = s->args->max_triangles},
        .least_mm3 = least_mm3(s),
    };
}

/* error_mm  of the surface as it is extracted; with cameras: out of their sight */
static cw_simplify_desc simplify_desc(const run_state *s, double error)
{
    const bool seen = s->args->pixel.pixels.given;
    return (cw_simplify_desc){
        .error_mm = error,
        .triangles = s->args->simplify.triangles,
        .views = s->views,
        .view_count = s->view_count,
        .pixel_error = seen ? s->args->pixel.pixels.value : 0,
        .normal_deg = seen && shading(s->args) < 180 ? shading(s->args) : 0,
        .threads = (int)s->args->input.threads,
    };
}

static cw_status find_error(const run_state *s, double *error, cw_error *err)
{
    const extract_args *args = s->args;
    *error = args->simplify.error.given ? error_mm(s) : 0;
    if (args->pixel.most.given)
        *error = length_mm(s, &args->pixel.most);
    else if (args->pixel.pixels.given)
        return cli_widest_error(&s->volume, s->views, s->view_count, args->pixel.pixels.value,
                                error, err);
    return CW_OK;
}

/* What there is besides the picture's, so that nothing of it is missed by rounding. */
static double pixels_around(const run_state *s)
{
    return 1 + (s->args->pixel.pixels.given ? s->args->pixel.pixels.value : 0);
}

/* Depths of the surface first, then what they leave of it. To be culled, it is extracted where
 * it may be seen only, unless all of a component counts. */
static cw_status extract_for_views(run_state *s, const cli_wanted *w,
                                   const cw_simplify_desc *simplify, cli_made *made,
                                   cw_mesh *mesh, cw_extract_counts *counts, cw_error *err)
{
    const bool cull = s->args->pixel.cull;
    cli_proof *p = &made->proof;
    cli_volume part = s->volume;
    cw_status st = CW_OK;
    for (size_t n = 0; n < s->view_count; n++)
        cw_simplify_view_free(s->views + n);
    if (cull && !(w->least_mm3 > 0))
        st = cli_seen_part(&s->volume, s->views, s->view_count, &part, err);
    if (st == CW_OK)
        st = cli_draw_views(&part, w, s->views, s->view_count, err);
    if (st == CW_OK)
        st = is_simplified(s->args)
                 ? cli_extract_simplified(&part, w, simplify, mesh, counts, &made->components,
                                          err)
                 : cli_extract_wanted(&part, NULL, w, mesh, counts, &made->components, err);
    if (st != CW_OK || !cull)
        return st;
    p->voxels = voxel_count(&s->volume.view);
    p->seen_voxels = voxel_count(&part.view);
    return cli_cull(&s->volume, s->views, s->view_count, pixels_around(s), simplify->error_mm,
                    mesh, &p->culled, err);
}

static void tell_components(const run_state *s, const cli_made *made)
{
    const cw_drop_counts *c = &made->components;
    cli_say(
        "%s: %s component%s kept, of %.6g mm3 or more; %s dropped (< %.6g mm3), of %.6g mm3 "
        "or less: %s triangles fewer",
        s->volume.path, cli_count(c->kept), c->kept == 1 ? "" : "s", c->least_kept_mm3,
        cli_count(c->dropped), made->least_mm3, c->largest_mm3, cli_count(c->triangles));
}

static cw_status extract(run_state *s, cli_made *made, cw_mesh *mesh, cw_extract_counts *counts,
                         cw_error *err)
{
    const cli_wanted w = wanted(s, made->iso);
    cw_drop_counts *dropped = &made->components;
    double error;
    cw_status st = find_error(s, &error, err);
    if (st != CW_OK)
        return st;
    const cw_simplify_desc simplify = simplify_desc(s, error);
    cli_report_begin(&s->report);
    if (s->view_count)
        st = extract_for_views(s, &w, &simplify, made, mesh, counts, err);
    else if (is_simplified(s->args))
        st = cli_extract_simplified(&s->volume, &w, &simplify, mesh, counts, dropped, err);
    else
        st = cli_extract_wanted(&s->volume, s->extractor, &w, mesh, counts, dropped, err);
    if (st != CW_OK)
        return st;
    cli_report_end(&s->report, "extract", voxel_count(&s->volume.view), mesh->triangle_count);
    made->least_mm3 = w.least_mm3;
    if (w.least_mm3 > 0)
        tell_components(s, made);
    if (s->args->pixel.cull)
        cli_say(
            "%s: %.3g %% of the voxels are in bricks that cameras see; %s triangles of these "
            "that none does are left out",
            s->volume.path, 100 * (double)made->proof.seen_voxels / (double)made->proof.voxels,
            cli_count(made->proof.culled));
    return CW_OK;
}

/* What became of all the triangles, and how far from the field the result is: from a field of
 * cubic crossings that would not tell. */
static cw_status judge_simplified(run_state *s, cli_made *made, const cw_mesh *mesh,
                                  const cw_extract_counts *counts, cw_error *err)
{
    const extract_args *args = s->args;
    cli_say("%s: %s triangles were extracted, and simplified to %s", s->volume.path,
            cli_count(counts->triangles), cli_count(mesh->triangle_count));
    if (args->simplify.triangles && mesh->triangle_count > args->simplify.triangles)
        cli_report_warn(&s->report,
                        "%s triangles were asked for, %s are left: where more would go, the "
                        "surface would tear, turn over or meet itself",
                        cli_count(args->simplify.triangles), cli_count(mesh->triangle_count));
    if (!args->check || args->placement)
        return CW_OK;
    if (cwi_volume_kind(&s->volume.view)) {
        cli_say("%s: %s: the distance to its field is not measured", s->volume.path,
                cwi_volume_kind(&s->volume.view));
        return CW_OK;
    }
    cli_report_begin(&s->report);
    cw_status st = cli_compare_with_field(mesh, &s->volume, made->iso, is_low(s),
                                          (int)args->input.threads, &made->compared, err);
    if (st != CW_OK)
        return cwi_fail_in(err, st, s->volume.path);
    cli_report_end(&s->report, "measure", mesh->triangle_count, mesh->triangle_count);
    return CW_OK;
}

static cw_status hold_to_pixels(const run_state *s, const cli_proof *p, cw_error *err)
{
    for (size_t n = 0; n < p->count; n++)
        cli_say("%s: camera %zu: at most %.3g pixels off, %.3g promised; %.3g %% of its pixels "
                "differ by more than 2/255",
                s->volume.path, n + 1, p->views[n].pixels, p->promised_pixels,
                100 * p->views[n].apart);
    for (size_t n = 0; n < p->count; n++)
        if (p->views[n].pixels > 1.01 * p->promised_pixels)
            return cw_fail(err, CW_ERR_CHECK,
                           "%s: not as promised: %.4g pixels off for camera %zu",
                           s->volume.path, p->views[n].pixels, n + 1);
        else if (p->promised_pixels == 0 && p->views[n].apart > SAME_PICTURE)
            return cw_fail(
                err, CW_ERR_CHECK,
                "%s: not as promised: without what is left out %.3g %% of the pixels "
                "of camera %zu differ",
                s->volume.path, 100 * p->views[n].apart, n + 1);
    return CW_OK;
}

/* The promise was kept by bounds, all over; here it is seen from outside. */
static cw_status prove(run_state *s, cli_made *made, const cw_mesh *mesh, size_t bytes,
                       cw_error *err)
{
    const cli_wanted w = wanted(s, made->iso);
    cli_proof *p = &made->proof;
    double error;
    if (!s->args->check || !(s->view_count || s->args->pixel.most.given))
        return CW_OK;
    cli_report_begin(&s->report);
    cw_status st = find_error(s, &error, err);
    const cw_simplify_desc simplify = simplify_desc(s, error);
    if (st == CW_OK)
        st = s->view_count
                 ? cli_prove_views(&s->volume, &w, &simplify, mesh, p, err)
                 : cli_prove_error(&s->volume, &w, &simplify, mesh, p, &made->compared, err);
    if (st != CW_OK)
        return st;
    p->bytes = bytes;
    cli_report_end(&s->report, "prove", p->full_triangles, mesh->triangle_count);
    return hold_to_pixels(s, p, err);
}

static cw_status prove_crop(run_state *s, const cli_moment *moment, cli_made *made,
                            cw_error *err)
{
    const cli_wanted w = wanted(s, made->iso);
    const cli_crop_proof *p = &made->crop;
    cli_input input = s->args->input;
    if (!s->args->prove_crop)
        return CW_OK;
    input.step = moment->step;
    cli_report_begin(&s->report);
    cw_status st = cli_prove_crop(&s->volume, &input, &w, &made->crop, err);
    if (st != CW_OK)
        return st;
    cli_report_end(&s->report, "prove crop", p->whole_triangles, p->triangles);
    cli_say("%s: %s triangles, as the whole surface has them there: %.3g %% of its %s, of "
            "%.3g %% of the voxels; %s and %.3g s in place of %s and %.3g s",
            s->volume.path, cli_count(p->triangles),
            100 * (double)p->triangles / (double)p->whole_triangles,
            cli_count(p->whole_triangles), 100 * (double)p->voxels / (double)p->whole_voxels,
            cli_bytes((double)p->bytes), p->seconds, cli_bytes((double)p->whole_bytes),
            p->whole_seconds);
    return CW_OK;
}

/* How a surface was made, for the file's own record. Not of what: names of files may be names
 * of patients. */
static size_t tell_provenance(const run_state *s, size_t n, char level[32], char simplify[64],
                              cw_provenance lines[PROVENANCE_LINES])
{
    const extract_args *args = s->args;
    snprintf(level, 32, "%.9g", args->iso.value[n]);
    lines[0] = (cw_provenance){"isovalue", level};
    lines[1] = (cw_provenance){"inside", is_low(s) ? "below" : "above"};
    lines[2] = (cw_provenance){"topology", args->topology ? "simple" : "field"};
    lines[3] = (cw_provenance){"placement", args->placement ? "cubic" : "linear"};
    if (args->pixel.pixels.given)
        snprintf(simplify, 64, "to %.9g pixels of %zu cameras", args->pixel.pixels.value,
                 s->view_count);
    else if (args->pixel.most.given)
        snprintf(simplify, 64, "to %.9g mm", length_mm(s, &args->pixel.most));
    else if (args->simplify.error.given)
        snprintf(simplify, 64, "to %.9g mm", error_mm(s));
    else
        snprintf(simplify, 64, "to %zu triangles", args->simplify.triangles);
    lines[4] = (cw_provenance){"simplified", simplify};
    return is_simplified(args) ? 5 : 4;
}

/* The next surface of the report; frames have no file of their own. */
static cli_made *begin_surface(run_state *s, const cli_moment *moment, size_t level)
{
    const size_t n = s->report.made_count;
    const char *path = s->args->animate ? NULL : s->outputs.path[n];
    cli_made *made = cli_report_next(&s->report, path, s->args->iso.value[level]);
    made->moment = s->series.given ? moment : NULL;
    made->timed = s->series.timed;
    return made;
}

/* An error of one step among several says of which. */
static void name_step(const run_state *s, const cli_moment *moment, cw_error *err)
{
    const cw_error why = *err;
    if (s->series.given)
        cw_fail(err, why.status, "step %zu: %s", moment->number, why.message);
}

static cli_delivery delivery(const run_state *s)
{
    return (cli_delivery){.input = s->volume.path,
                          .write = write_desc(s->args),
                          .compress = &s->args->compress,
                          .voxel_mm = voxel_mm(s),
                          .unchecked = !s->args->check,
                          .open = s->args->open,
                          .unpromised = s->args->pixel.cull,
                          .preview = cli_is_preview(&s->volume)};
}

/* Into its file, with the record of how it was made. */
static cw_status deliver(run_state *s, size_t level, const cw_part *parts, size_t count,
                         size_t border_loops, cw_error *err)
{
    char text[32], simplify[64];
    cw_provenance provenance[PROVENANCE_LINES];
    cli_delivery how = delivery(s);
    how.write.provenance = provenance;
    how.write.provenance_count = tell_provenance(s, level, text, simplify, provenance);
    how.unchecked = how.unchecked || how.write.animated; /* each was by itself */
    how.parts = how.write.animated ? "steps" : NULL;
    return cli_deliver(&s->report, &how, parts, count, border_loops, s->start, err);
}

static cw_status make_surface(run_state *s, const cli_moment *moment, size_t n, cw_error *err)
{
    cli_made *made = begin_surface(s, moment, n);
    const cli_delivery how = delivery(s);
    cw_mesh mesh = {0};
    cw_extract_counts counts = {0};
    cw_status st = extract(s, made, &mesh, &counts, err);
    made->snapped = st == CW_OK && s->args->snap.value > 0;
    made->snap = made->snapped ? counts.snap : (cw_snap_counts){0};
    if (st == CW_OK && is_simplified(s->args))
        st = judge_simplified(s, made, &mesh, &counts, err);
    if (st == CW_OK)
        st = prove(s, made, &mesh, counts.bytes, err);
    if (st == CW_OK)
        st = prove_crop(s, moment, made, err);
    if (st == CW_OK)
        st = s->args->animate
                 ? cli_deliver_step(&s->report, &how, &mesh, counts.border_loops, s->start, err)
                 : deliver(s, n, &(cw_part){.mesh = &mesh}, 1, counts.border_loops, err);
    if (s->args->animate && (st == CW_OK || st == CW_ERR_EMPTY))
        cli_frames_add(&s->frames, &mesh, moment, s->fps);
    cw_mesh_free(&mesh);
    s->start = cli_seconds();
    if (st == CW_OK)
        return CW_OK;
    name_step(s, moment, err);
    made->error = *err;
    return st;
}

/* The levels of a step. An empty surface among several is told and counted; any other failure
 * ends the run. */
static cw_status make_surfaces(run_state *s, const cli_moment *moment, size_t *empty,
                               cw_error *err)
{
    const size_t levels = s->args->iso.count;
    for (size_t n = 0; n < levels; n++) {
        cw_status st = make_surface(s, moment, n, err);
        if (st != CW_OK && (st != CW_ERR_EMPTY || levels * s->series.count == 1))
            return st;
        if (st == CW_ERR_EMPTY && s->args->animate)
            cli_report_warn(&s->report, "%s; nothing is shown in its time", err->message);
        else if (st == CW_ERR_EMPTY)
            cli_say_error(err->message);
        *empty += st == CW_ERR_EMPTY;
    }
    return CW_OK;
}

/* What a step took goes back to the system: left to itself glibc keeps blocks of this size, and
 * those of the next step do not quite fit between what else there is. */
static void free_step(run_state *s)
{
    cli_free_volume(&s->volume);
#ifdef __GLIBC__
    malloc_trim(0);
#endif
}

static cw_status read_volume(run_state *s, const cli_moment *moment, cw_error *err)
{
    cli_input input = s->args->input;
    input.step = moment->step;
    free_step(s);
    cli_report_begin(&s->report);
    cw_status st = cli_read_volume(moment->path, &input, false, &s->volume, err);
    if (st != CW_OK)
        return st;
    const cw_volume *v = &s->volume.view;
    if (!s->report.input)
        s->first = s->volume;
    s->report.input = &s->first;
    cli_report_end(&s->report, "read", 1, v->dim[0] * v->dim[1] * v->dim[2]);
    for (int r = 0; r < 3; r++)
        cli_say_vv("affine   %12.6g %12.6g %12.6g %12.6g", v->affine[r][0], v->affine[r][1],
                   v->affine[r][2], v->affine[r][3]);
    return CW_OK;
}

/* The voxels of a step: those of one file are all in memory. */
static cw_status open_step(run_state *s, const cli_moment *moment, cw_error *err)
{
    const bool held = s->volume.voxels.data && s->volume.path == moment->path;
    cw_status st = held ? cli_choose_step(&s->args->input, moment->step, &s->volume, err)
                        : read_volume(s, moment, err);
    s->memory = held ? s->memory : s->volume.memory_left;
    s->volume.memory_left = s->memory > s->frames.bytes ? s->memory - s->frames.bytes : 1;
    cw_extractor_free(s->extractor);
    s->extractor = NULL;
    if (st != CW_OK || s->args->iso.count == 1 || s->args->accel || is_simplified(s->args))
        return st;
    st = cw_extractor_new(&s->volume.view, &s->extractor, err);
    return st == CW_OK ? st : cwi_fail_in(err, st, s->volume.path);
}

static cw_status fail_empty(const run_state *s, size_t empty, size_t count, cw_error *err)
{
    const char *what = s->series.count == 1      ? "levels"
                       : s->args->iso.count == 1 ? "steps"
                                                 : "surfaces";
    return cw_fail(err, CW_ERR_EMPTY, "%s: empty %s: %zu of %zu", s->args->common.inputs[0],
                   what, empty, count);
}

static cw_status make_steps(run_state *s, size_t *empty, cw_error *err)
{
    cw_status st = CW_OK;
    for (size_t n = 0; n < s->series.count && st == CW_OK; n++) {
        st = open_step(s, &s->series.moments[n], err);
        if (st == CW_OK)
            st = make_surfaces(s, &s->series.moments[n], empty, err);
    }
    return st;
}

/* An animation has a place for steps that are empty: only nothing but such is no result. */
static cw_status animate(run_state *s, cw_error *err)
{
    const cli_frames *f = &s->frames;
    if (f->empty == f->count)
        return fail_empty(s, f->empty, f->count, err);
    cli_made *made = cli_report_next(&s->report, s->outputs.path[0], 0);
    made->name = "all";
    cw_status st = deliver(s, 0, f->parts, f->count, 0, err);
    if (st != CW_OK)
        made->error = *err;
    return st;
}

static cw_status write_pvd(run_state *s, cw_error *err)
{
    const cw_write_desc desc = write_desc(s->args);
    return cli_write_pvd(&s->report, s->args->pvd, &desc, err);
}

/* A file that times its steps is believed unless --fps says otherwise. */
static cw_status plan_frames(run_state *s, cw_error *err)
{
    const extract_args *args = s->args;
    if (!args->animate)
        return CW_OK;
    if (s->series.count < 2)
        return cw_fail(err, CW_ERR_ARGUMENT, "%s: --animate shows several steps, and here is 1",
                       args->common.inputs[0]);
    s->fps = args->fps.given ? args->fps.value : s->series.timed ? 0 : DEFAULT_FPS;
    if (!args->fps.given && !s->series.timed)
        cli_say("%s: steps have no times: %d a second are shown (--fps)",
                args->common.inputs[0], DEFAULT_FPS);
    return cli_frames_reserve(&s->frames, s->series.count, err);
}

static cw_status plan_steps(run_state *s, cw_error *err)
{
    const extract_args *args = s->args;
    cli_steps steps = args->steps;
    steps.all = steps.all || (args->animate && !steps.given);
    steps.given = steps.given || args->animate;
    cw_status st = cli_find_series(&s->series, &args->common, &args->input, &steps, err);
    if (st == CW_OK)
        st = check_outputs(s, err);
    const size_t surfaces = s->series.count * args->iso.count;
    s->report.several = surfaces > 1 || s->series.given ? "surfaces" : NULL;
    if (st == CW_OK)
        st = cli_report_reserve(&s->report, surfaces + 1, err);
    return st == CW_OK ? plan_frames(s, err) : st;
}

static cw_status pipeline(run_state *s, cw_error *err)
{
    size_t empty = 0;
    cw_status st = check_args(s, err);
    if (st == CW_OK)
        st = plan_steps(s, err);
    if (st == CW_OK)
        st = make_steps(s, &empty, err);
    if (st == CW_OK && s->args->animate)
        return animate(s, err);
    if (st == CW_OK && s->args->pvd)
        st = write_pvd(s, err);
    return st == CW_OK && empty
               ? fail_empty(s, empty, s->series.count * s->args->iso.count, err)
               : st;
}

/* The files of a series; "input" is the first of them. */
static void put_series(cli_json *j, const void *p)
{
    const run_state *s = p;
    if (!s->series.files.count)
        return;
    cli_json_open(j, "files", '[');
    for (size_t n = 0; n < s->series.files.count; n++)
        cli_json_text(j, NULL, cli_shown_path(s->series.files.path[n]));
    cli_json_close(j, ']');
}

static cw_status run(void *p, cw_error *err)
{
    extract_args *args = p;
    run_state s = {.args = args, .start = cli_seconds()};
    if (!args->iso.count && args->output &&
        cli_is_level_set(args->common.inputs[0], &args->input))
        args->iso.count = 1; /* 0 */
    s.report.command = "extract";
    s.report.several = args->iso.count > 1 ? "surfaces" : NULL;
    s.report.params = put_params;
    s.report.facts = put_series;
    s.report.args = &s;
    cli_console_start(&args->common, (cli_progress_mode)args->progress);
    if (args->json && strcmp(args->json, "-") == 0)
        cli_results_to_stderr();
    cw_status st = cli_report_reserve(&s.report, 1, err);
    if (st == CW_OK)
        st = pipeline(&s, err);
    st = cli_report_write(&s.report, st, err);
    for (size_t n = 0; n < s.view_count; n++)
        cw_simplify_view_free(s.views + n);
    cw_extractor_free(s.extractor);
    cli_frames_free(&s.frames);
    cli_free_volume(&s.volume);
    cli_free_outputs(&s.outputs);
    cli_free_series(&s.series);
    cli_report_free(&s.report);
    return st;
}

const cli_command cli_extract = {
    .name = "extract",
    .usage = "VOLUME... --iso V -o MESH [options]",
    .about = "a volume to a mesh: the surface where the values equal an isovalue",
    .more =
        "Reads a volume, extracts the surface of its trilinear field at the isovalue, checks "
        "that\n"
        "the surface is closed and a manifold, and writes it. Values at or above the isovalue "
        "are\n"
        "inside. Where the solid meets the volume's border it is closed by a flat cap.\n"
        "Unless --snap, --simplify or --preview say so, nothing is smoothed, reduced or "
        "dropped.\n"
        "The same bytes for any number of threads.\n\n"
        "--preview is for finding a level: of the part chosen by --crop it takes every 4th "
        "voxel\n"
        "along each axis, as it stands, and needs time for these only, once the file is read. "
        "It\n"
        "is in its place, up to 3 voxels short of the far ends, and says that it is a "
        "preview.\n\n"
        "With --snap crossings close to one sample become one vertex, and the needles between\n"
        "them go: 0.3 leaves few angles below 10 degrees, 0.5 few below 20. What is not proven "
        "to\n"
        "keep the topology and to cross nothing stays. The error is printed, and in the "
        "report.\n\n"
        "--simplify works slab by slab while extracting, so that the full surface never is in\n"
        "memory: no point of the result is farther from it than the error, nor the other way\n"
        "round, or about so many triangles are left. It keeps what the command simplify "
        "keeps.\n\n"
        "--camera keeps what its pictures need: what is seen is off by no more than\n"
        "--pixel-error and keeps its shading; out of sight the mesh is coarse, but closed. It "
        "is\n"
        "compared with the full one. --cull leaves out what none sees: it is then open.\n"
        "--max-error alone is --simplify, proven: measured against the full surface, both\n"
        "ways; exit code 1, and no file, if it should not hold.\n\n"
        "--min-volume counts a component with all that is in it, which goes with it, and so\n"
        "fills small cavities; an open one up to the middle of its box.\n\n"
        "STL, PLY and OBJ hold world coordinates; far from the world's zero single precision\n"
        "loses them, and extract warns. With --local they are relative to the mesh's origin:\n"
        "add it to get the world's. It is printed, and named in the report and in the file.\n"
        "In GLB and glTF, which lose nothing, --local leaves out the node's translation.\n\n"
        "Several isovalues make one file each, whose names tell them apart by {level}; {stem}\n"
        "is the input's name without its extension. Those after the first read only the parts\n"
        "of the volume that they cross (--accel octree). A level that crosses nothing is told\n"
        "and passed over, and the exit code is then 9; after any other failure the files that\n"
        "were finished stay. The report lists every level under 'surfaces', each with what\n"
        "'mesh' is for a single one; 'output' lists the files in either case.\n\n"
        "Of a volume with time steps --steps 0:20:2, --steps 0,3,7 or --steps all make a mesh "
        "of\n"
        "each, all at the same isovalue, in files whose names tell them apart by {step}, or "
        "with\n"
        "leading zeros {step:04d}. Several volumes, or a quoted pattern, are a series too: a "
        "file\n"
        "a step, in natural order (2 before 10), read one at a time. They must agree in the "
        "number\n"
        "of values a voxel and in whether they name a unit and a frame. Slices, which are "
        "DICOM\n"
        "images and TIFF files of one page, are no steps but one volume. A step that crosses\n"
        "nothing is told, has no file, and makes the exit code 9.\n\n"
        "--pvd FILE lists the .vtp files of the steps and their times, or numbers where the "
        "input\n"
        "names no times; ParaView opens it as a series.\n\n"
        "--animate writes one GLB or glTF of a node a step, of which an animation shows one at "
        "a\n"
        "time, as the file times its steps, or --fps of them a second; the last one as long as "
        "the\n"
        "one before it. Whether it begins again is the player's choice; without one the first\n"
        "surface is seen. A step that crosses nothing is told, and shows nothing in its "
        "time.\n\n"
        "Examples\n"
        "  cubewright extract head.nii.gz --iso 50 -o head.glb\n"
        "  cubewright extract ct.nrrd --iso 300 -o bone.stl --json report.json\n"
        "  cubewright extract ct.nrrd --iso 300 -o v.glb --camera cam.json --pixel-error 1\n"
        "  cubewright extract heart.nii.gz --iso 90 --steps all -o 'out/{step}.vtp' --pvd "
        "h.pvd\n"
        "  cubewright extract 'scan-*.nrrd' --iso 300 --animate --fps 4 -o scan.glb\n"
        "  cubewright extract slab.raw --raw dims=512x512x300,type=u16le --spacing 0.5mm \\\n"
        "      --iso 1200 -o part.ply\n",
    .options = options,
    .option_count = sizeof options / sizeof *options,
    .min_inputs = 1,
    .max_inputs = SIZE_MAX,
    .size = sizeof(extract_args),
    .defaults = &defaults,
    .run = run,
};
