/* Computes lengths and settings of the command extract, and writes them into its report and
 * into the records of its files. */
#include "cli/extract/extract_run.h"

#include "cli/inputs/volume_prepare.h"
#include "cli/results/detail_levels.h"
#include "core/volume/volume.h"

#include <math.h>
#include <stdio.h>

/* Degrees: of a head in 1280 x 720 pixels 1 in 200 then looks different, of 2 degrees 1
 * in 100. */
static const double SHADING = 1.5;

/* How far smoothing may move a vertex, in voxels, unless --max-move says it. */
static const double DEFAULT_MOVE = 0.5;

double cli_volume_voxel_mm(const cli_volume *volume)
{
    const double *spacing = volume->spacing;
    return cbrt(spacing[0] * spacing[1] * spacing[2]);
}

static double diagonal_mm(const cli_volume *volume)
{
    const cli_grid *g = &volume->grid;
    double square = 0;
    for (int a = 0; a < 3; a++) {
        const double side = volume->view.cells
                                ? g->high[a] - g->low[a]
                                : volume->spacing[a] * (double)(volume->view.dim[a] - 1);
        square += side * side;
    }
    return sqrt(square);
}

double cli_volume_length_mm(const cli_volume *volume, const cli_length *length)
{
    return cli_length_mm(length, diagonal_mm(volume), cli_volume_voxel_mm(volume));
}

cw_status cli_extract_check_error(const cli_extract_args *args, const cli_volume *volume,
                                  cw_error *err)
{
    const bool is_most = args->pixel.most.given && !args->pixel.pixels.given;
    const cli_length *error = is_most ? &args->pixel.most : &args->simplify.error;
    if (!error->given || args->common.force)
        return CW_OK;
    return cli_check_error_limit(is_most ? "--max-error" : "--simplify",
                                 cli_volume_length_mm(volume, error), diagonal_mm(volume), NULL,
                                 err);
}

double cli_extract_voxel_mm(const cli_extract_run *s)
{
    return cli_volume_voxel_mm(&s->input.volume);
}

double cli_extract_length_mm(const cli_extract_run *s, const cli_length *length)
{
    return cli_volume_length_mm(&s->input.volume, length);
}

double cli_extract_error_mm(const cli_extract_run *s)
{
    return cli_extract_length_mm(s, &s->args->simplify.error);
}

double cli_extract_least_mm3(const cli_extract_args *args, const cli_volume *volume)
{
    const cli_amount *least = &args->least;
    const double voxel = cli_volume_voxel_mm(volume);
    return !least->given   ? 0
           : least->voxels ? least->value * voxel * voxel * voxel
                           : least->value;
}

bool cli_extract_is_low(const cli_extract_run *s)
{
    return cli_inside_is_low(s->args->inside, &s->input.volume.whole);
}

bool cli_extract_shades_levels(const cli_extract_run *s)
{
    return cwi_volume_expect_dense(&s->input.volume.view, "normals", NULL) == CW_OK;
}

double cli_extract_shading(const cli_extract_args *args)
{
    return args->pixel.shading.given ? args->pixel.shading.value : SHADING;
}

size_t cli_extract_largest(const cli_extract_args *args)
{
    const bool chooses = args->largest || args->least.given;
    return args->profile != CLI_PROFILE_NONE && !chooses ? 1 : args->largest;
}

cw_close_handles_desc cli_extract_handles(const cli_extract_args *args,
                                          const cli_volume *volume)
{
    const cli_length *length = &args->handles;
    return (cw_close_handles_desc){.length_mm = length->is_word || !length->given
                                                    ? 0
                                                    : cli_volume_length_mm(volume, length)};
}

cw_smooth_desc cli_extract_smoothing(const cli_extract_args *args, const cli_volume *volume)
{
    const cli_smoothing *smooth = &args->smooth;
    const cli_length *most = &args->max_move;
    return (cw_smooth_desc){
        .method = (cw_smooth_method)smooth->method,
        .iterations = smooth->iterations,
        .width_mm = smooth->width.given ? cli_volume_length_mm(volume, &smooth->width) : 0,
        .max_move_mm = most->given ? cli_volume_length_mm(volume, most)
                                   : DEFAULT_MOVE * cli_volume_voxel_mm(volume),
    };
}

static void put_pixels(cli_json *j, const cli_extract_run *s)
{
    const cli_pixel_args *a = &s->args->pixel;
    if (a->most.given)
        cli_json_number(j, "max_error_mm", cli_extract_length_mm(s, &a->most));
    if (!a->camera)
        return;
    cli_json_count(j, "cameras", s->plan.view_count);
    cli_json_bool(j, "cull", a->cull);
    cli_json_count(j, "width", s->plan.views[0].width);
    cli_json_count(j, "height", s->plan.views[0].height);
    if (!a->pixels.given)
        return;
    cli_json_number(j, "pixel_error", a->pixels.value);
    cli_json_number(j, "shading_deg", cli_extract_shading(s->args));
}

void cli_extract_put_params(cli_json *j, const void *p, const cli_made *made)
{
    const cli_extract_run *s = p;
    const cli_extract_args *args = s->args;
    const size_t *step = s->input.volume.coarsen;
    cli_json_number(j, "iso", made->iso);
    cli_json_preparation(j, &args->input);
    cli_json_text(j, "inside", cli_extract_is_low(s) ? "below" : "above");
    cli_json_bool(j, "open", args->open);
    cli_json_text(j, "topology", args->topology ? "simple" : "field");
    cli_json_text(j, "placement", args->placement ? "cubic" : "linear");
    cli_json_number(j, "snap", args->snap.value);
    if (args->simplify.error.given)
        cli_json_number(j, "simplify_error_mm", cli_extract_error_mm(s));
    else if (args->simplify.triangles)
        cli_json_count(j, "simplify_triangles", args->simplify.triangles);
    if (args->lod.count)
        cli_json_lod(j, &args->lod);
    if (args->least.given)
        cli_json_number(j, "min_volume_mm3", cli_extract_least_mm3(args, &s->input.volume));
    if (cli_extract_largest(args))
        cli_json_count(j, "largest", cli_extract_largest(args));
    if (args->profile)
        cli_json_text(j, "profile",
                      cli_extract_asset(args) ? cli_extract_asset(args)->name : "print");
    if (made->print.count)
        cli_json_printer(j, &made->print.facts.limits);
    cli_json_texture(j, &args->texture);
    cli_json_pivot(j, args->pivot);
    if (args->fill_voids)
        cli_json_bool(j, "fill_voids", true);
    if (cli_crease_degrees(&args->crease) > 0)
        cli_json_number(j, "crease_angle", args->crease.value);
    if (args->handles.given)
        cli_json_number(j, "close_handles_mm", made->facts.handles.length_mm);
    if (args->cut.given)
        cli_json_text(j, "cut_plane", cli_plane_text(&args->cut));
    if (args->engrave)
        cli_json_text(j, "engrave", args->engrave);
    if (args->smooth.given) {
        cli_json_text(j, "smooth", cli_smoothing_text(&args->smooth));
        cli_json_number(j, "max_move_mm",
                        cli_extract_smoothing(args, &s->input.volume).max_move_mm);
    }
    put_pixels(j, s);
    cli_json_color(j, &s->coloring);
    cli_json_text(j, "normals", args->normals ? "none" : "field");
    if (args->iso.count > 1)
        cli_json_text(j, "accel", args->accel ? "none" : "octree");
    if (args->input.array.component.magnitude)
        cli_json_text(j, "component", "mag");
    else
        cli_json_count(j, "component", args->input.array.component.number);
    cli_json_count(j, "step", made->moment ? made->moment->number : args->input.step);
    if (cli_is_preview(&s->input.volume))
        cli_json_numbers(j, "coarsen",
                         (double[3]){(double)step[0], (double)step[1], (double)step[2]}, 3);
}

void cli_extract_put_series(cli_json *j, const void *p)
{
    const cli_extract_run *s = p;
    if (!s->input.series.files.count)
        return;
    cli_json_open(j, "files", '[');
    for (size_t n = 0; n < s->input.series.files.count; n++)
        cli_json_text(j, NULL, cli_shown_path(s->input.series.files.path[n]));
    cli_json_close(j, ']');
}

size_t cli_extract_provenance(const cli_extract_run *s, size_t n, cli_making *making,
                              cw_provenance lines[CLI_EXTRACT_PROVENANCE])
{
    const cli_extract_args *args = s->args;
    char *simplify = making->simplify;
    size_t count = 0;
    snprintf(making->level, sizeof making->level, "%.9g", args->iso.value[n]);
    lines[count++] = (cw_provenance){"isovalue", making->level};
    lines[count++] = (cw_provenance){"inside", cli_extract_is_low(s) ? "below" : "above"};
    lines[count++] = (cw_provenance){"topology", args->topology ? "simple" : "field"};
    lines[count++] = (cw_provenance){"placement", args->placement ? "cubic" : "linear"};
    if (args->handles.given) {
        const double length_mm = cli_extract_handles(args, &s->input.volume).length_mm;
        snprintf(making->handles, sizeof making->handles,
                 length_mm > 0 ? "loops up to %.9g mm" : "auto", length_mm);
        lines[count++] = (cw_provenance){"closed handles", making->handles};
    }
    if (args->smooth.given) {
        snprintf(making->smooth, sizeof making->smooth, "by %s, %.9g mm at most",
                 cli_smoothing_text(&args->smooth),
                 cli_extract_smoothing(args, &s->input.volume).max_move_mm);
        lines[count++] = (cw_provenance){"smoothed", making->smooth};
    }
    if (args->cut.given)
        lines[count++] = (cw_provenance){"cut", cli_plane_text(&args->cut)};
    if (args->engrave)
        lines[count++] = (cw_provenance){"engraved", args->engrave};
    if (args->pixel.pixels.given)
        snprintf(simplify, sizeof making->simplify, "to %.9g pixels of %zu cameras",
                 args->pixel.pixels.value, s->plan.view_count);
    else if (args->pixel.most.given)
        snprintf(simplify, sizeof making->simplify, "to %.9g mm",
                 cli_extract_length_mm(s, &args->pixel.most));
    else if (args->simplify.error.given)
        snprintf(simplify, sizeof making->simplify, "to %.9g mm", cli_extract_error_mm(s));
    else
        snprintf(simplify, sizeof making->simplify, "to %zu triangles",
                 args->simplify.triangles);
    if (cli_extract_is_simplified(args))
        lines[count++] = (cw_provenance){"simplified", simplify};
    return count;
}

cli_delivery cli_extract_describe_delivery(const cli_extract_run *s)
{
    return (cli_delivery){.input = s->input.volume.path,
                          .write = cli_extract_write_desc(s->args),
                          .compress = &s->args->compress,
                          .voxel_mm = cli_extract_voxel_mm(s),
                          .unchecked = !s->args->check,
                          .open = s->args->open,
                          .unpromised = s->args->pixel.cull,
                          .preview = cli_is_preview(&s->input.volume)};
}
