/* Checks the arguments of `extract --labels` before the label map is read. */
#include "cli/extract/label_run.h"

#include "cli/inputs/volume_prepare.h"
#include "core/base/status.h"

#include <cubewright/simplify.h>

#include <string.h>

static cw_status fail_without(const char *option, cw_error *err)
{
    return cwi_fail(err, CW_ERR_ARGUMENT, "%s is for --labels", option);
}

/* Returns true if the output's format has labels on both sides of triangles, or parts that need
 * not be solids. An unknown format is refused later. */
static bool holds_interfaces(const cli_extract_args *args)
{
    const cw_format *f = cw_mesh_format(args->output, args->format);
    return !f || strcmp(f->name, "vtp") == 0 || strcmp(f->name, "ply") == 0 ||
           strcmp(f->name, "obj") == 0 || strcmp(f->name, "glb") == 0 ||
           strcmp(f->name, "gltf") == 0;
}

static bool is_simplified(const cli_extract_args *args)
{
    return args->simplify.error.given || args->simplify.triangles > 0;
}

/* Checks the levels of detail: they have targets of their own, and a file each. */
static cw_status check_lod(const cli_extract_args *args, cw_error *err)
{
    const cli_counts *lod = &args->lod;
    if (lod->count && (is_simplified(args) || args->shared_faces))
        return cwi_fail(err, CW_ERR_ARGUMENT, "--lod cannot be combined with %s",
                        args->shared_faces ? "--shared-faces" : "--simplify");
    if (lod->count && cli_has_file_a_label(args->output))
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "--lod writes all labels into a file a level; the output holds {label} "
                        "or {name}");
    return cli_check_lod(lod, err);
}

cw_status cli_check_label_args(const cli_extract_args *args, cw_error *err)
{
    const struct {
        bool is_given;
        const char *option;
    } refused[] = {
        {args->iso.count > 0, "--iso"},
        {args->inside != CLI_INSIDE_AUTO, "--inside"},
        {args->topology, "--topology"},
        {args->placement, "--placement"},
        {args->snap.given, "--snap"},
        {args->least.given, "--min-volume"},
        {args->largest > 0, "--largest"},
        {args->fill_voids, "--fill-voids"},
        {args->profile == CLI_PROFILE_PRINT, "--profile print"},
        {args->color.by != NULL, "--color-by (labels have their own colours)"},
        {args->cut.given, "--cut-plane"},
        {args->smooth.given, "--smooth (labels have --smooth-labels)"},
        {args->pixel.most.given, "--max-error"},
        {args->pixel.camera != NULL, "--camera"},
        {args->pixel.pixels.given, "--pixel-error"},
        {args->pixel.cull, "--cull"},
        {args->pixel.shading.given, "--shading"},
        {args->pixel.size.count > 0, "--size"},
        {!args->measure, "--no-measure"},
        {args->fps.given, "--fps"},
        {args->steps.given, "--steps"},
        {args->animate, "--animate"},
        {args->pvd != NULL, "--pvd"},
        {args->prove_crop, "--prove-crop"},
        {args->input.component.magnitude, "--component mag"},
        {cli_find_preparation(&args->input) != NULL, cli_find_preparation(&args->input)},
    };
    if (!args->labels)
        return args->names            ? fail_without("--names", err)
               : args->smooth_labels  ? fail_without("--smooth-labels", err)
               : args->table          ? fail_without("--table", err)
               : args->shared_faces   ? fail_without("--shared-faces", err)
               : args->per_label      ? fail_without("--per-label", err)
               : args->require_labels ? fail_without("--require-labels", err)
                                      : CW_OK;
    for (size_t n = 0; n < sizeof refused / sizeof *refused; n++)
        if (refused[n].is_given)
            return cwi_fail(err, CW_ERR_ARGUMENT, "--labels cannot be combined with %s",
                            refused[n].option);
    if (!args->output)
        return cwi_fail(err, CW_ERR_ARGUMENT, "extract needs an output: -o FILE");
    if (args->common.input_count > 1)
        return cwi_fail(err, CW_ERR_ARGUMENT, "--labels takes one volume; there are %zu",
                        args->common.input_count);
    cw_status st = check_lod(args, err);
    if (st != CW_OK)
        return st;
    if (args->per_label && !is_simplified(args))
        return cwi_fail(err, CW_ERR_ARGUMENT, "--per-label is for --simplify");
    if (args->per_label && args->shared_faces)
        return cwi_fail(
            err, CW_ERR_ARGUMENT,
            "--per-label lets interfaces part, and --shared-faces writes them once");
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
    return cli_check_compress(&args->compress, true, err);
}
