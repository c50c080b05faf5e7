/* Checks the arguments and outputs of the command extract before the input is read. */
#include "cli/extract/extract_run.h"

#include "cli/extract/label_run.h"
#include "cli/extract/pvd_list.h"
#include "cli/results/detail_levels.h"
#include "core/base/status.h"

cw_write_desc cli_extract_write_desc(const cli_extract_args *args)
{
    return (cw_write_desc){.format = args->format,
                           .name = args->name,
                           .no_clobber = args->no_clobber,
                           .local = args->local,
                           .animated = args->animate,
                           .compression = (cw_compression)args->compress.kind,
                           .bits = (int)args->compress.bits};
}

const cli_asset *cli_extract_asset(const cli_extract_args *args)
{
    return cli_find_asset(args->profile - CLI_PROFILE_ASSETS);
}

void cli_extract_fill_profile(cli_extract_args *args)
{
    const cli_asset *asset = cli_extract_asset(args);
    if (args->compress.kind < 0) /* none was given */
        args->compress.kind = asset ? asset->compression : CW_COMPRESS_NONE;
    if (!asset)
        return;
    args->fills_levels = !args->lod.count && !cli_extract_is_simplified(args);
    if (args->fills_levels)
        cli_fill_levels(asset, &args->lod);
    cli_fill_texture(asset, &args->texture, &args->handles);
    args->fill_voids = true;
}

/* The report is an output too: none is written when it is an input or a mesh. */
static cw_status check_report(cli_extract_run *s, const char *const *inputs, size_t count,
                              cw_error *err)
{
    const char *json = s->args->json;
    s->output.report.path = NULL;
    cw_status st = json ? cli_check_output(json, inputs, count, err) : CW_OK;
    for (size_t n = 0; n < s->output.files.count && json && st == CW_OK; n++)
        st = cli_check_apart(json, s->output.files.path[n], err);
    s->output.report.path = st == CW_OK ? json : NULL;
    return st;
}

static cw_status check_pvd(const cli_extract_run *s, const char *const *inputs, size_t count,
                           cw_error *err)
{
    const cli_extract_args *args = s->args;
    const cw_write_desc desc = cli_extract_write_desc(args);
    cw_status st = CW_OK;
    if (!args->pvd)
        return CW_OK;
    if (!s->input.series.given)
        return cwi_fail(err, CW_ERR_ARGUMENT, "--pvd is for the steps of a series: --steps");
    if (args->json)
        st = cli_check_apart(args->pvd, args->json, err);
    return st == CW_OK ? cli_check_pvd(args->pvd, &s->output.files, inputs, count, &desc, err)
                       : st;
}

cw_status cli_extract_check_outputs(cli_extract_run *s, cw_error *err)
{
    const cli_extract_args *args = s->args;
    const cw_write_desc desc = cli_extract_write_desc(args);
    const size_t files = s->input.series.files.count, count = files ? files : 1;
    const char *const *inputs =
        files ? (const char *const *)s->input.series.files.path : args->common.inputs;
    cli_series named = s->input.series;
    named.count = args->animate ? 1 : named.count;
    cw_status st =
        args->lod.count
            ? cli_name_detail_levels(&s->output.files, args->output, args->format,
                                     args->common.inputs[0], &args->lod,
                                     cli_extract_asset(args), err)
            : cli_name_outputs(&s->output.files, args->output, &named, &args->iso, err);
    if (st == CW_OK)
        st = check_report(s, inputs, count, err);
    if (st == CW_OK)
        st = cli_check_outputs(&s->output.files, inputs, count, &desc, err);
    return st == CW_OK ? check_pvd(s, inputs, count, err) : st;
}

static cw_status check_animation(const cli_extract_args *args, cw_error *err)
{
    if (args->fps.given && !(args->fps.value > 0))
        return cwi_fail(err, CW_ERR_ARGUMENT, "--fps %g: it must be above 0", args->fps.value);
    if (args->animate && args->iso.count > 1)
        return cwi_fail(err, CW_ERR_ARGUMENT, "--animate shows one level; --iso lists %zu",
                        args->iso.count);
    return CW_OK;
}

/* Returns the name of the option that asks for fewer triangles. */
static const char *name_reducer(const cli_extract_args *args)
{
    return args->lod.count          ? "--lod"
           : args->pixel.camera     ? "--camera"
           : args->pixel.most.given ? "--max-error"
                                    : "--simplify";
}

static cw_status check_lod(const cli_extract_args *args, cw_error *err)
{
    if (args->lod.count && args->iso.count > 1)
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "--lod makes levels of detail of one surface; --iso lists %zu",
                        args->iso.count);
    return cli_check_lod(&args->lod, err);
}

cw_status cli_extract_check_lod_steps(const cli_extract_run *s, cw_error *err)
{
    if (s->args->lod.count && s->input.series.count > 1)
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "--lod makes levels of detail of one surface; there are %zu time steps",
                        s->input.series.count);
    return CW_OK;
}

cw_status cli_extract_check_args(cli_extract_run *s, cw_error *err)
{
    const cli_extract_args *args = s->args;
    const char *const *input = args->common.inputs;
    cw_status st = check_report(s, input, args->common.input_count, err);
    if (st == CW_OK)
        st = cli_check_compress(&args->compress, err);
    if (st != CW_OK)
        return st;
    if (!args->output)
        return cwi_fail(err, CW_ERR_ARGUMENT, "extract needs an output: -o FILE");
    if (!args->iso.count)
        return cwi_fail(
            err, CW_ERR_ARGUMENT,
            "extract needs an isovalue: --iso V; 'cubewright info %s' suggests some", input[0]);
    if (!(args->snap.value >= 0 && args->snap.value <= CW_EXTRACT_MAX_SNAP))
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "--snap is a fraction of an edge from 0 to %g, not %g",
                        CW_EXTRACT_MAX_SNAP, args->snap.value);
    const char *unstreamed = cli_find_unstreamed(args, CW_SOURCE_SLICES);
    if (args->stream == CLI_STREAM_ALWAYS && unstreamed)
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "--stream always cannot be combined with %s, which needs all in memory",
                        unstreamed);
    st = cli_check_stages(args, CW_SOURCE_MEMORY, err);
    if (st == CW_OK)
        st = cli_check_color(&args->color, err);
    if (st == CW_OK)
        st = cli_check_printer(&args->printer, err);
    if (st == CW_OK)
        st = cli_check_texture(&args->texture, args->output, args->format, err);
    if (st == CW_OK)
        st = cli_check_crease(&args->crease, err);
    if (st == CW_OK)
        st = cli_check_orient(&args->orient_print, err);
    if (st == CW_OK)
        st = check_lod(args, err);
    if (st == CW_OK)
        st = cli_read_views(&args->pixel, s->plan.views, &s->plan.view_count, err);
    if (st != CW_OK)
        return st;
    if ((cli_extract_is_simplified(args) || args->lod.count) && !cw_simplify_available())
        return cwi_fail(
            err, CW_ERR_UNSUPPORTED,
            "%s needs OpenMesh, which this build lacks: install libopenmesh-dev and "
            "build again",
            name_reducer(args));
    return check_animation(args, err);
}
