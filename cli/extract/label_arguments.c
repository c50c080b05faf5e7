/* Checks the arguments of `extract --labels` before the label map is read. */
#include "cli/extract/label_run.h"

#include "core/base/status.h"

#include <cubewright/simplify.h>

#include <string.h>

/* Returns true if the output's format has labels on both sides of triangles, or parts that need
 * not be solids. An unknown format is refused later. */
static bool holds_interfaces(const cli_extract_args *args)
{
    const cw_format *f = cw_mesh_format(args->output, args->format);
    return !f || strcmp(f->name, "vtp") == 0 || strcmp(f->name, "ply") == 0 ||
           strcmp(f->name, "obj") == 0 || strcmp(f->name, "glb") == 0 ||
           strcmp(f->name, "gltf") == 0;
}

/* Checks the levels of detail: they have targets of their own, and a file each. */
static cw_status check_lod(const cli_extract_args *args, cw_error *err)
{
    if (args->lod.count && cli_has_file_a_label(args->output))
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "--lod writes all labels into a file a level; the output holds {label} "
                        "or {name}");
    return cli_check_lod(&args->lod, err);
}

static cw_status check_resample(const cli_resample *resample, cw_error *err)
{
    if (resample->given && resample->has_kernel && !resample->of_labels)
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "--resample %s: linear, cubic and lanczos make means of values; labels "
                        "take majority (the default) or nearest",
                        cli_resample_text(resample));
    return CW_OK;
}

cw_status cli_check_label_args(const cli_extract_args *args, cw_error *err)
{
    if (!args->output)
        return cwi_fail(err, CW_ERR_ARGUMENT, "extract needs an output: -o FILE");
    cw_label_scores scores;
    if (args->common.input_count > 1 && !args->probabilities)
        return cwi_fail(
            err, CW_ERR_ARGUMENT,
            "--labels takes one volume; there are %zu. With --probabilities each is the "
            "field of a label",
            args->common.input_count);
    if (args->probabilities &&
        cli_parse_probabilities(args->probabilities, &scores, err) != CW_OK)
        return CW_ERR_ARGUMENT;
    cli_extract_args surface =
        *args; /* without the stages that clean voxels of labels instead */
    surface.least = (cli_amount){0};
    surface.largest = 0;
    surface.fill_voids = false;
    cw_status st = check_resample(&args->input.resample, err);
    if (st == CW_OK)
        st = cli_check_stages(&surface, CW_SOURCE_LABELS, err);
    if (st == CW_OK)
        st = check_lod(args, err);
    if (st != CW_OK)
        return st;
    if (args->stream == CLI_STREAM_ALWAYS && cli_cleans_labels(args))
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "--stream always cannot be combined with --min-volume, --largest and "
                        "--fill-voids: voxels of labels are cleaned in memory");
    if (args->stream == CLI_STREAM_ALWAYS && args->input.resample.given)
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "--stream always cannot be combined with --resample: voxels of labels "
                        "are sampled in memory");
    if (args->per_label && !cw_simplify_available())
        return cwi_fail(err, CW_ERR_UNSUPPORTED,
                        "--per-label needs OpenMesh, which this build lacks: install "
                        "libopenmesh-dev and build again");
    if (args->shared_faces && !holds_interfaces(args))
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "--shared-faces is for vtp, ply, glb, gltf and obj: other formats hold "
                        "no interfaces of two labels");
    if (args->shared_faces && cli_has_file_a_label(args->output))
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "--shared-faces writes all interfaces into one file; the output holds "
                        "{label} or {name}");
    return cli_check_compress(&args->compress, err);
}
