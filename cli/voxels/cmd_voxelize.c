/* The command voxelize: reads meshes and the grid of a scan, fills it with labels or partial volumes, and
 * writes that. */
#include "cli/voxels/cmd_voxelize.h"
#include "cli/framework/console.h"
#include "cli/framework/quantity.h"
#include "cli/framework/standard_streams.h"
#include "cli/results/output_names.h"
#include "cli/results/run_report.h"
#include "cli/voxels/solid_input.h"
#include "core/base/status.h"

#include <stdio.h>
#include <string.h>

typedef struct voxelize_args {
    cli_common common;
    cli_input input; /* how meshes and the scan are read */
    const char *output, *format, *like, *json;
    cli_lengths spacing;
    cli_ranges box;
    bool partial, no_clobber;
    int progress;
} voxelize_args;

static const cli_option options[] = {
    {"output", 'o', CLI_TEXT, "FILE",
     "Volume to write: .nrrd, .nii, .nii.gz or .mha; - is the standard output (with --format); may hold {stem}",
     offsetof(voxelize_args, output), CLI_VALUES_VOLUME_OUTPUT},
    {"partial", 0, CLI_FLAG, NULL,
     "Write the fraction of each voxel that is inside, 0 to 1 (off: a label for each part)",
     offsetof(voxelize_args, partial)},
    {"format", 0, CLI_TEXT, "NAME", "Format to write; names as in 'formats' (by extension)",
     offsetof(voxelize_args, format)},
    {"no-clobber", 0, CLI_FLAG, NULL, "Fail if the output exists (off: replace it)",
     offsetof(voxelize_args, no_clobber)},
    CLI_JSON_OPTION(voxelize_args),
    CLI_HEADED("Grid"),
    {"like", 'l', CLI_TEXT, "SCAN", "Volume whose grid and frame are taken; needs no --spacing",
     offsetof(voxelize_args, like), CLI_VALUES_VOLUME},
    {"spacing", 0, CLI_LENGTHS, "X[,Y,Z]",
     "Distance between voxels of a new grid: 0.5mm, 1x1x2mm", offsetof(voxelize_args, spacing)},
    {"box", 0, CLI_RANGES, "X:X,Y:Y,Z:Z",
     "Box of the new grid in LPS: 0mm:80mm,-10mm:90mm,0mm:50mm (that of the meshes, a voxel wider)",
     offsetof(voxelize_args, box)},
    CLI_HEADED("Reading the scan"),
    CLI_CLAIM_OPTIONS("source", "the scan", CLI_INPUT_ROW(voxelize_args, source_claim)),
    {"series", 0, CLI_TEXT, "N",
     "DICOM series of a folder: its number in 'info', or its UID (the only one)",
     CLI_INPUT_ROW(voxelize_args, series)},
    {"array", 0, CLI_ARRAY, "NAME",
     "Array of the scan, of files with several grids (the file's choice)",
     CLI_INPUT_ROW(voxelize_args, array)},
    {"level", 0, CLI_COUNT, "N",
     "Level of a scan in several sizes (OME-Zarr, N5, Neuroglancer), counted from the finest (0)",
     CLI_INPUT_ROW(voxelize_args, level)},
    {"gaps", 0, CLI_CHOICE, "stop/interpolate/allow",
     "What to do where slices are missing or uneven (stop)",
     CLI_INPUT_ROW(voxelize_args, gaps)},
    {"tilt", 0, CLI_CHOICE, "correct/keep",
     "Place slices of a tilted gantry where they were, or straight above each other (correct)",
     CLI_INPUT_ROW(voxelize_args, tilt)},
    CLI_MESH_INPUT_OPTIONS(voxelize_args),
    CLI_PROGRESS_OPTION(voxelize_args),
};

static const cli_rule rules[] = {
    {NULL, CLI_NEEDS, "output"},
    {NULL, CLI_NEEDS, "like spacing"},
    {"like", CLI_EXCLUDES, "spacing box"},
};

typedef struct voxelize_run {
    const voxelize_args *args;
    cli_outputs outputs;
    cli_volume scan; /* its header; zeroed without --like */
    cli_solids solids;
    cw_volume volume;
    double seconds;
} voxelize_run;

static cw_status check_args(voxelize_run *r, cw_error *err)
{
    const voxelize_args *args = r->args;
    const char *path;
    cw_status st = cli_name_output(&r->outputs, args->output, args->common.inputs[0], err);
    if (st != CW_OK)
        return st;
    path = r->outputs.path[0];
    if (!cw_volume_format(path, args->format) && args->format)
        return cwi_fail(err, CW_ERR_ARGUMENT, "--format %s: no volumes are written in it",
                        args->format);
    if (!cw_volume_format(path, args->format))
        return cwi_fail(
            err, CW_ERR_ARGUMENT,
            "%s: no writer of volumes has this extension; there are .nrrd, .nii, .nii.gz and .mha",
            path);
    if (args->box.given && !args->box.world)
        return cwi_fail(
            err, CW_ERR_ARGUMENT,
            "--box needs a unit, such as 0mm:80mm,0mm:80mm,0mm:50mm: there are no voxels yet");
    st = cli_check_output(path, args->common.inputs, args->common.input_count, err);
    if (st == CW_OK && args->like)
        st = cli_check_output(path, &args->like, 1, err);
    if (st == CW_OK && args->json)
        st = cli_check_apart(args->json, path, err);
    return st;
}

/* Reads the header of the scan; the options for meshes do not count. */
static cw_status read_scan(voxelize_run *r, cw_error *err)
{
    cli_input input = cli_source_input(&r->args->input);
    input.reader = NULL;
    return r->args->like ? cli_read_volume(r->args->like, &input, true, &r->scan, err) : CW_OK;
}

static cw_status fill_voxels(voxelize_run *r, cw_error *err)
{
    const voxelize_args *args = r->args;
    const double start = cli_seconds();
    cw_voxelize_desc d = {.like = args->like ? &r->scan.whole : NULL,
                          .labels = r->solids.labels,
                          .partial = args->partial,
                          .max_bytes = cli_memory_limit(&args->input),
                          .parts = r->solids.parts,
                          .threads = (int)args->input.threads,
                          .progress = cli_progress(1, "grid")};
    for (int a = 0; a < 3; a++) {
        d.spacing_mm[a] = args->spacing.mm[a];
        d.low[a] = args->box.given ? args->box.low[a] : 0;
        d.high[a] = args->box.given ? args->box.high[a] : 0;
    }
    cw_status st = cw_voxelize(r->solids.meshes, r->solids.count, &d, &r->volume, err);
    r->seconds = cli_seconds() - start;
    if (st != CW_OK)
        return cli_fail_solids(&r->solids, st, err);
    cli_tell_solids(&r->solids, args->partial);
    for (size_t n = 0; n < r->solids.count; n++)
        if (r->solids.parts[n].filled_mm3 > 0)
            return CW_OK;
    return cwi_fail(
        err, CW_ERR_EMPTY,
        "%s: no centre of a voxel is inside; a finer --spacing, or --partial, helps",
        args->common.inputs[0]);
}

/* Says which names a format has no place for. */
static void tell_lost_names(const voxelize_run *r, const cw_format *format)
{
    if (r->args->partial || r->solids.count < 2 || format->keeps & CW_KEEPS_LABELS)
        return;
    char text[400];
    size_t used = 0;
    for (size_t n = 0; n < r->solids.count && used < sizeof text; n++)
        used += (size_t)snprintf(text + used, sizeof text - used, "%s%u = %s", n ? ", " : "",
                                 (unsigned)r->solids.labels[n], r->solids.solid[n].name);
    cli_say("%s: %s has no place for names of labels: %s", r->outputs.path[0], format->name,
            text);
}

static cw_status write_volume(voxelize_run *r, cw_error *err)
{
    const char *path = r->outputs.path[0];
    cw_label_table table = {0};
    cw_status st = CW_OK;
    for (size_t n = 0; n < r->solids.count && st == CW_OK && !r->args->partial; n++)
        st = cw_label_table_add(&table, &r->solids.solid[n].label, err);
    const cw_write_desc desc = {.format = r->args->format,
                                .no_clobber = r->args->no_clobber,
                                .name = cli_is_standard(path) ? "labels" : NULL,
                                .sink = cli_output_sink(path),
                                .labels = r->args->partial ? NULL : &table,
                                .progress = cli_progress(1, "file")};
    if (st == CW_OK)
        st = cw_volume_write(path, &r->volume, &desc, err);
    if (st == CW_OK)
        tell_lost_names(r, cw_volume_format(path, r->args->format));
    cw_label_table_free(&table);
    return st;
}

static void print_result(const voxelize_run *r)
{
    const size_t *dim = r->volume.dim, count = r->solids.count;
    double filled = 0, volume = 0;
    for (size_t n = 0; n < count; n++) {
        filled += r->solids.parts[n].filled_mm3;
        volume += r->solids.parts[n].volume_mm3;
    }
    char what[64] = "partial volumes";
    if (!r->args->partial)
        snprintf(what, sizeof what, "%zu label%s", count, count == 1 ? "" : "s");
    cli_result("%s: %zu x %zu x %zu %s, %s; %.6g mm3 of voxels, the mesh%s %.6g mm3; %.2f s\n",
               r->outputs.path[0], dim[0], dim[1], dim[2], cw_type_name(r->volume.type), what,
               filled, count == 1 ? " has" : "es have", volume, r->seconds);
}

static void put_json(FILE *out, const void *run)
{
    const voxelize_run *r = run;
    cli_json j = {.out = out};
    cli_json_open(&j, NULL, '{');
    cli_json_text(&j, "schema", "cubewright-voxelize-1");
    cli_json_text(&j, "tool", "cubewright");
    cli_json_text(&j, "version", cw_version());
    cli_json_text(&j, "output", cli_shown_path(r->outputs.path[0]));
    cli_json_bool(&j, "partial", r->args->partial);
    cli_json_text(&j, "type", cw_type_name(r->volume.type));
    const double dim[3] = {(double)r->volume.dim[0], (double)r->volume.dim[1],
                           (double)r->volume.dim[2]};
    cli_json_numbers(&j, "dims", dim, 3);
    cli_json_open(&j, "parts", '[');
    for (size_t n = 0; n < r->solids.count; n++) {
        const cw_voxelize_part *p = &r->solids.parts[n];
        cli_json_open(&j, NULL, '{');
        cli_json_text(&j, "path", cli_shown_path(r->solids.solid[n].path));
        cli_json_text(&j, "name", r->solids.solid[n].name);
        if (!r->args->partial) {
            cli_json_count(&j, "label", r->solids.labels[n]);
            cli_json_count(&j, "voxels", p->voxels);
            cli_json_count(&j, "overlapped", p->overlapped);
            cli_json_count(&j, "repeated", p->repeated);
            cli_json_count(&j, "negative", p->negative);
        }
        cli_json_number(&j, "filled_mm3", p->filled_mm3);
        cli_json_number(&j, "volume_mm3", p->volume_mm3);
        cli_json_number(&j, "area_mm2", p->area_mm2);
        cli_json_number(&j, "outside_mm2", p->outside_mm2);
        cli_json_count(&j, "solids", p->solids);
        cli_json_count(&j, "lost", p->lost);
        cli_json_count(&j, "thin_places", p->thin_places);
        cli_json_number(&j, "thin_mm2", p->thin_mm2);
        cli_json_bool(&j, "turned", p->turned);
        cli_json_close(&j, '}');
    }
    cli_json_close(&j, ']');
    cli_json_number(&j, "seconds", r->seconds);
    cli_json_close(&j, '}');
}

static cw_status run_voxelize(void *p, cw_error *err)
{
    const voxelize_args *args = p;
    voxelize_run r = {.args = args};
    cli_console_start(&args->common, (cli_progress_mode)args->progress);
    cli_console_reserve_stdout(args->json);
    cw_status st = check_args(&r, err);
    if (st == CW_OK)
        st = read_scan(&r, err);
    if (st == CW_OK)
        st = cli_read_solids(args->common.inputs, args->common.input_count, args->input.reader,
                             &args->input, &r.solids, err);
    if (st == CW_OK)
        st = fill_voxels(&r, err);
    if (st == CW_OK)
        st = write_volume(&r, err);
    if (st == CW_OK)
        print_result(&r);
    if (st == CW_OK)
        st = cli_report_make(args->json, put_json, &r, err);
    cw_volume_free(&r.volume);
    cli_free_solids(&r.solids);
    cli_free_volume(&r.scan);
    cli_free_outputs(&r.outputs);
    return st;
}

const cli_command cli_voxelize = {
    .name = "voxelize",
    .usage = "MESH... -o VOLUME --like SCAN|--spacing L [--partial] [options]",
    .about = "Make voxels of closed meshes: labels or partial volumes, on the grid of a scan",
    .page = cli_page_voxelize,
    .options = options,
    .option_count = sizeof options / sizeof *options,
    .rules = rules,
    .rule_count = sizeof rules / sizeof *rules,
    .min_inputs = 1,
    .max_inputs = SIZE_MAX,
    .inputs = CLI_VALUES_MESH,
    .size = sizeof(voxelize_args),
    .run = run_voxelize,
};
