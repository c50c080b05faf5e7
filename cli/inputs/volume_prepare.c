/* Resamples and denoises the voxels of a volume that was read. */
#include "cli/inputs/volume_prepare.h"

#include "cli/framework/console.h"
#include "cli/framework/quantity.h"
#include "cli/inputs/level_choice.h"
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/volume/named_level.h"

#include <cubewright/filter.h>
#include <cubewright/slice_filter.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const char *cli_find_preparation(const cli_input *input)
{
    return input->resample.given     ? "--resample"
           : input->denoise.given    ? "--denoise"
           : input->remove_table     ? "--remove-table"
           : input->mask             ? "--mask"
           : input->mask_open.given  ? "--mask-open"
           : input->mask_close.given ? "--mask-close"
           : input->crop.is_auto     ? "--crop auto"
                                     : NULL;
}

cw_type cli_denoised_type(const cli_input *input, const cw_volume *volume)
{
    const bool makes_means = input->denoise.given && input->denoise.filter != CLI_MEDIAN;
    return makes_means ? cw_filter_type(volume) : volume->type;
}

const char *cli_find_unstreamed_preparation(const cli_input *input)
{
    cli_input rest = *input;
    const cli_filter filter = input->denoise.filter;
    rest.denoise.given = input->denoise.given && filter != CLI_GAUSS && filter != CLI_MEDIAN;
    return cli_find_preparation(&rest);
}

cw_status cli_fail_whole(cw_status st, const char *option, cw_error *err)
{
    static const struct {
        const char *option, *way;
    } ways[] = {{"--denoise", "gauss:L and median:N go slice by slice"},
                {"--resample", "larger distances or --coarsen N take less"},
                {"--crop auto", "--crop with numbers goes slice by slice"}};
    const cw_error why = *err;
    const char *way = "--crop with numbers reads a part of them";
    for (size_t n = 0; n < sizeof ways / sizeof *ways && option; n++)
        way = strcmp(option, ways[n].option) == 0 ? ways[n].way : way;
    return cwi_fail(err, st, "%s; %s needs all voxels in memory; %s", why.message,
                    option ? option : "this command", way);
}

cw_filter_desc cli_describe_filter(const cli_input *input, const cli_volume *volume)
{
    const size_t *n = volume->view.dim;
    return (cw_filter_desc){
        .threads = (int)input->threads,
        .max_bytes = volume->memory_left,
        .progress = cli_progress((double)n[0] * (double)n[1] * (double)n[2] / 1e6, "Mvoxel")};
}

void cli_take_filtered(cli_volume *volume, cw_volume *made)
{
    const size_t bytes = made->dim[0] * made->dim[1] * made->dim[2] * cw_type_size(made->type);
    const cw_volume *old = &volume->prepared;
    if (old->data)
        volume->memory_left +=
            old->dim[0] * old->dim[1] * old->dim[2] * cw_type_size(old->type);
    volume->memory_left = volume->memory_left > bytes ? volume->memory_left - bytes : 1;
    cw_volume_free(&volume->prepared);
    volume->prepared = *made;
    volume->view = *made;
    volume->view.owned = volume->view.owned_grid = NULL;
}

/* Returns ", as f32" where means of the view's values have another type than these. */
static const char *told_type(const cli_volume *volume)
{
    static char text[32];
    const cw_type made = cw_filter_type(&volume->view);
    snprintf(text, sizeof text, ", as %s", cw_type_name(made));
    return made == volume->view.type ? "" : text;
}

void cli_resample_spacing(const cli_resample *r, const cw_volume *v, double old[3],
                          double mm[3])
{
    cw_volume_spacing(v, old);
    for (int a = 0; a < 3; a++)
        mm[a] = r->iso ? fmin(fmin(old[0], old[1]), old[2]) : r->mm[a];
}

static cw_status resample_view(const cli_input *input, cli_volume *volume, cw_error *err)
{
    const cli_resample *r = &input->resample;
    const cw_filter_desc desc = cli_describe_filter(input, volume);
    double old[3], mm[3];
    cw_volume made;
    cli_resample_spacing(r, &volume->view, old, mm);
    cw_status st =
        cw_volume_resample(&volume->view, mm, (cw_kernel)r->kernel, &desc, &made, err);
    if (st != CW_OK)
        return cwi_fail_in(err, st, "--resample");
    cli_note_volume(volume,
                    "resampled from %g x %g x %g mm to %g x %g x %g mm, %zu x %zu x %zu "
                    "voxels, %s%s",
                    old[0], old[1], old[2], mm[0], mm[1], mm[2], made.dim[0], made.dim[1],
                    made.dim[2], cw_kernel_name((cw_kernel)r->kernel), told_type(volume));
    cli_take_filtered(volume, &made);
    return CW_OK;
}

void cli_width_in_voxels(const cli_length *width, const cw_volume *v, double sigma[3])
{
    double mm[3];
    cw_volume_spacing(v, mm);
    for (int a = 0; a < 3; a++)
        sigma[a] = width->unit == CLI_VOXELS ? width->value
                   : mm[a] > 0               ? width->value / mm[a]
                                             : 0;
}

/* A value of a filter: the one that was given, or in proportion to the noise of the volume. */
typedef struct filter_value {
    double value;
    char source[96]; /* for the note */
} filter_value;

static cw_status find_value(const cli_input *input, const cli_volume *volume, double factor,
                            filter_value *out, cw_error *err)
{
    double noise;
    *out = (filter_value){.value = input->denoise.value};
    if (out->value > 0)
        return CW_OK;
    cw_status st = cw_volume_noise(&volume->view, (int)input->threads, &noise, err);
    out->value = factor * noise;
    if (!(noise > 0))
        snprintf(out->source, sizeof out->source, ": no noise was found");
    else if (factor == 1)
        snprintf(out->source, sizeof out->source, " (estimated)");
    else
        snprintf(out->source, sizeof out->source, " (%g times the noise of %.4g)", factor,
                 noise);
    return st;
}

void cli_print_slice_filter(const cli_input *input, cli_volume *volume)
{
    const size_t side = 2 * input->denoise.count + 1;
    double sigma[3];
    cli_width_in_voxels(&input->denoise.width, &volume->view, sigma);
    if (input->denoise.given && input->denoise.filter == CLI_GAUSS)
        cli_note_volume(volume, "denoised by a Gaussian of %.3g x %.3g x %.3g voxels%s",
                        sigma[0], sigma[1], sigma[2], told_type(volume));
    if (input->denoise.given && input->denoise.filter == CLI_MEDIAN)
        cli_note_volume(volume, "denoised by the median of %zu x %zu x %zu voxels", side, side,
                        side);
}

static cw_status smooth_view(const cli_input *input, cli_volume *volume, cw_volume *made,
                             cw_error *err)
{
    const cw_filter_desc desc = cli_describe_filter(input, volume);
    double sigma[3];
    cli_width_in_voxels(&input->denoise.width, &volume->view, sigma);
    cw_status st = cw_volume_gauss(&volume->view, sigma, &desc, made, err);
    if (st == CW_OK)
        cli_print_slice_filter(input, volume);
    return st;
}

static cw_status sort_view(const cli_input *input, cli_volume *volume, cw_volume *made,
                           cw_error *err)
{
    const cw_filter_desc desc = cli_describe_filter(input, volume);
    cw_status st = cw_volume_median(&volume->view, input->denoise.count, &desc, made, err);
    if (st == CW_OK)
        cli_print_slice_filter(input, volume);
    return st;
}

enum { MOST_SLICES = 64 }; /* filtered together, where memory is short */

/* A visitor of filtered slices. */
typedef struct filtered_visit {
    const cli_input *input;
    const cw_slice_visitor *visitor;
} filtered_visit;

/* Filters the first slices at once: what that takes then counts to the memory of the program. */
static cw_status take_first_slice(const cw_slice_source *source, cw_error *err)
{
    const size_t *dim = source->shape.dim;
    void *slice = malloc(dim[0] * dim[1] * cw_type_size(source->shape.type));
    cw_status st = slice ? source->read(source->user, 0, 1, slice, err) : cwi_fail_memory(err);
    free(slice);
    return st;
}

static cw_slice_filter_desc describe_slice_filter(const cli_input *input, const cw_volume *v)
{
    const cli_denoise *denoise = &input->denoise;
    cw_slice_filter_desc desc = {.kind = denoise->filter == CLI_MEDIAN ? CW_SLICE_MEDIAN
                                                                       : CW_SLICE_GAUSS,
                                 .radius = denoise->count,
                                 .threads = (int)input->threads};
    cli_width_in_voxels(&denoise->width, v, desc.sigma_voxels);
    return desc;
}

size_t cli_slice_filter_bytes(const cli_input *input, const cw_volume *source)
{
    cw_slice_filter_desc desc = describe_slice_filter(input, source);
    desc.slices = 1;
    return input->denoise.given ? cw_slice_filter_bytes(source, &desc) : 0;
}

static cw_status visit_filtered(void *user, const cw_slice_source *source, cw_error *err)
{
    const filtered_visit *v = user;
    cw_slice_filter_desc desc = describe_slice_filter(v->input, &source->shape);
    cw_slice_filter *filter;
    const size_t share = cwi_memory_left() / 4; /* the rest is for the surface */
    if (cw_slice_filter_bytes(&source->shape, &desc) > share)
        for (desc.slices = MOST_SLICES;
             desc.slices > 1 && cw_slice_filter_bytes(&source->shape, &desc) > share;)
            desc.slices /= 2;
    cw_status st = cw_slice_filter_new(source, &desc, &filter, err);
    if (st != CW_OK)
        return cwi_fail_in(err, st, "--denoise");
    const cw_slice_source filtered = cw_slice_filter_source(filter);
    st = take_first_slice(&filtered, err);
    if (st == CW_OK)
        st = v->visitor->visit(v->visitor->user, &filtered, err);
    cw_slice_filter_free(filter);
    return st;
}

cw_status cli_visit_filtered(const cli_input *input, const cw_slice_visitor *visitor,
                             cli_visit_all *visit, const void *user, cw_error *err)
{
    filtered_visit v = {.input = input, .visitor = visitor};
    return visit(user, input->denoise.given ? &(cw_slice_visitor){visit_filtered, &v} : visitor,
                 err);
}

static cw_status join_similar(const cli_input *input, cli_volume *volume, cw_volume *made,
                              cw_error *err)
{
    const cw_filter_desc desc = cli_describe_filter(input, volume);
    filter_value v;
    double sigma[3];
    cli_width_in_voxels(&input->denoise.width, &volume->view, sigma);
    cw_status st = find_value(input, volume, 2.5, &v, err);
    if (st == CW_OK)
        st = cw_volume_bilateral(&volume->view, sigma, v.value, &desc, made, err);
    if (st == CW_OK)
        cli_note_volume(volume,
                        "denoised by a bilateral filter of %.3g x %.3g x %.3g voxels, values "
                        "within %.4g%s%s",
                        sigma[0], sigma[1], sigma[2], v.value, v.source, told_type(volume));
    return st;
}

static cw_status diffuse_view(const cli_input *input, cli_volume *volume, cw_volume *made,
                              cw_error *err)
{
    const cw_filter_desc desc = cli_describe_filter(input, volume);
    const size_t steps = input->denoise.count;
    filter_value v;
    cw_status st = find_value(input, volume, 0.5, &v, err);
    if (st == CW_OK)
        st = cw_volume_aniso(&volume->view, steps, v.value, &desc, made, err);
    if (st == CW_OK)
        cli_note_volume(volume,
                        "denoised by %zu steps of diffusion along edges, contrast %.4g%s%s",
                        steps, v.value, v.source, told_type(volume));
    return st;
}

static cw_status join_alike(const cli_input *input, cli_volume *volume, cw_volume *made,
                            cw_error *err)
{
    const cw_filter_desc desc = cli_describe_filter(input, volume);
    filter_value v;
    cw_status st = find_value(input, volume, 1, &v, err);
    if (st == CW_OK)
        st = cw_volume_nlm(&volume->view, v.value, 0, &desc, made, err);
    if (st == CW_OK)
        cli_note_volume(volume, "denoised by non-local means, noise %.4g%s%s", v.value,
                        v.source, told_type(volume));
    return st;
}

static cw_status denoise_view(const cli_input *input, cli_volume *volume, cw_error *err)
{
    cw_status (*const filters[])(const cli_input *, cli_volume *, cw_volume *,
                                 cw_error *) = {[CLI_GAUSS] = smooth_view,
                                                [CLI_MEDIAN] = sort_view,
                                                [CLI_BILATERAL] = join_similar,
                                                [CLI_ANISO] = diffuse_view,
                                                [CLI_NLM] = join_alike};
    cw_volume made;
    cw_status st = filters[input->denoise.filter](input, volume, &made, err);
    if (st != CW_OK)
        return cwi_fail_in(err, st, "--denoise");
    cli_take_filtered(volume, &made);
    return CW_OK;
}

static cw_status expect_hounsfield(const cli_input *input, const cli_volume *volume,
                                   cw_error *err)
{
    cw_statistics s = {0};
    cw_status st =
        cw_volume_statistics(&volume->view, CWI_LEVEL_BINS, (int)input->threads, &s, err);
    if (st == CW_OK && !cwi_is_hounsfield(&volume->whole, &s))
        st = cwi_fail(err, CW_ERR_ARGUMENT,
                      "it is for a CT in Hounsfield units, with air near -1000; these values "
                      "are %g to %g",
                      s.min, s.max);
    cw_statistics_free(&s);
    return st;
}

static cw_status remove_table(const cli_input *input, cli_volume *volume, cw_error *err)
{
    const cw_filter_desc desc = cli_describe_filter(input, volume);
    double removed_mm3 = 0;
    cw_volume made;
    cw_status st = expect_hounsfield(input, volume, err);
    if (st == CW_OK)
        st = cw_volume_remove_table(&volume->view, &desc, &made, &removed_mm3, err);
    if (st != CW_OK)
        return cwi_fail_in(err, st, "--remove-table");
    cli_note_volume(volume, "all but the body made air: %.4g ml above -300 HU removed",
                    removed_mm3 / 1000);
    cli_take_filtered(volume, &made);
    return CW_OK;
}

void cli_note_change(cli_volume *volume, const char *name, double start)
{
    if (volume->change_count < CLI_MAX_CHANGES)
        volume->changes[volume->change_count++] =
            (cli_change){.name = name, .seconds = cli_seconds() - start};
}

cw_status cli_prepare_volume(const cli_input *input, cli_volume *volume, cw_error *err)
{
    static const struct {
        const char *name;
        cw_status (*change)(const cli_input *input, cli_volume *volume, cw_error *err);
    } changes[] = {
        {"resample", resample_view}, {"denoise", denoise_view}, {"remove-table", remove_table}};
    const bool wanted[] = {input->resample.given, input->denoise.given, input->remove_table};
    cw_status st = CW_OK;
    volume->change_count = 0;
    for (int n = 0; n < 3 && st == CW_OK; n++) {
        const double start = cli_seconds();
        if (!wanted[n])
            continue;
        st = changes[n].change(input, volume, err);
        cli_note_change(volume, changes[n].name, start);
    }
    return st;
}

cw_status cli_check_preparation(const cli_input *input, cw_error *err)
{
    const char *option = input->mask               ? "--mask"
                         : input->mask_open.given  ? "--mask-open"
                         : input->mask_close.given ? "--mask-close"
                         : input->crop.is_auto     ? "--crop auto"
                                                   : NULL;
    if (option && !input->makes_surface)
        return cwi_fail(err, CW_ERR_ARGUMENT, "%s is for extract and check", option);
    if (input->resample.of_labels)
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "--resample %s: majority and nearest are for extract --labels; values "
                        "take linear, cubic or lanczos",
                        cli_resample_text(&input->resample));
    return CW_OK;
}

void cli_json_preparation(cli_json *j, const cli_input *input)
{
    if (input->resample.given)
        cli_json_text(j, "resample", cli_resample_text(&input->resample));
    if (input->denoise.given)
        cli_json_text(j, "denoise", cli_denoise_text(&input->denoise));
    if (input->remove_table)
        cli_json_bool(j, "remove_table", true);
    if (input->mask)
        cli_json_text(j, "mask", cli_shown_path(input->mask));
    if (input->mask_open.given)
        cli_json_text(j, "mask_open", cli_length_text(&input->mask_open));
    if (input->mask_close.given)
        cli_json_text(j, "mask_close", cli_length_text(&input->mask_close));
    if (input->crop.is_auto)
        cli_json_count(j, "crop_auto", input->crop.margin);
}
