/* The command make: samples an analytic field or a hard case and writes the volume. */
#include "cli/commands/command_rows.h"
#include "cli/framework/console.h"
#include "cli/framework/standard_streams.h"
#include "cli/inputs/synthetic_input.h"
#include "core/base/status.h"

#include <cubewright/formats.h>
#include <cubewright/hard.h>

#include <stdio.h>
#include <string.h>

typedef struct make_args {
    cli_common common;
    const char *output, *format;
    cli_sizes dims;
    int type;
    cli_number noise;
    size_t seed, labels, threads;
    bool no_clobber, list;
} make_args;

#define TYPE_NAMES "u8/i8/u16/i16/u32/i32/f32/f64" /* in the order of cw_type */

static const make_args defaults = {.type = CW_F32, .dims = {.count = 3, .n = {64, 64, 64}}};

static const cli_option options[] = {
    {"output", 'o', CLI_TEXT, "FILE",
     "Volume to write: .nrrd, .nii, .nii.gz or .mha; - is the standard output (with --format)",
     offsetof(make_args, output), CLI_VALUES_VOLUME_OUTPUT},
    {"list", 'l', CLI_FLAG, NULL, "List the fields and their isovalues",
     offsetof(make_args, list)},
    {"format", 0, CLI_TEXT, "NAME", "Format to write; names as in 'formats' (by extension)",
     offsetof(make_args, format)},
    {"no-clobber", 0, CLI_FLAG, NULL, "Fail if the output exists (off: replace it)",
     offsetof(make_args, no_clobber)},
    CLI_HEADED("Samples"),
    {"dims", 'd', CLI_SIZES, "N|XxYxZ", "Voxels along the axes (64)",
     offsetof(make_args, dims)},
    {"type", 0, CLI_CHOICE, TYPE_NAMES, "Type of the voxels (f32)", offsetof(make_args, type)},
    {"noise", 0, CLI_NUMBER, "SIGMA",
     "Standard deviation of Gaussian noise, in the unit of the field (0)",
     offsetof(make_args, noise)},
    {"seed", 0, CLI_COUNT, "N", "Seed of the noise, and of the points of labels (0)",
     offsetof(make_args, seed)},
    {"labels", 0, CLI_COUNT, "N", "Number of labels of label maps (100)",
     offsetof(make_args, labels)},
    CLI_HEADED("Limits and messages"),
    {"threads", 't', CLI_COUNT, "N", "Number of threads; results do not depend on it (0: all)",
     offsetof(make_args, threads)},
};

static const cli_rule rules[] = {
    {NULL, CLI_NEEDS, "output list"},
};

static cw_status list_subjects(void)
{
    cli_made_field s;
    for (size_t n = 0; cli_made_field_at(n, &s); n++)
        if (s.is_label_map)
            printf("%-28s--labels  %s\n", s.name, s.about);
        else
            printf("%-28s--iso %-5.10g %s%s\n", s.name, s.isovalue, s.about,
                   s.hard && cw_hard_at(s.number)->scale == 0 ? " (f32, f64)" : "");
    return CW_OK;
}

static bool find_subject(const char *name, cli_made_field *s)
{
    for (size_t n = 0; cli_made_field_at(n, s); n++)
        if (strcmp(s->name, name) == 0)
            return true;
    return false;
}

enum { MAX_SUBJECTS = 256 };

static cw_status unknown_subject(const char *name, cw_error *err)
{
    const char *names[MAX_SUBJECTS + 1] = {0};
    cli_made_field s;
    for (size_t n = 0; n < MAX_SUBJECTS && cli_made_field_at(n, &s); n++)
        names[n] = s.name;
    const char *nearest = cli_nearest(name, names);
    if (nearest)
        return cwi_fail(err, CW_ERR_ARGUMENT, "'%s' is not a field; did you mean '%s'?", name,
                        nearest);
    return cwi_fail(err, CW_ERR_ARGUMENT,
                    "'%s' is not a field; 'cubewright make --list' lists them", name);
}

static double mega_voxels(const make_args *args)
{
    const size_t *n = args->dims.n;
    return 1e-6 * (double)n[0] * (double)n[1] * (double)n[2];
}

static cw_status sample_field(const make_args *args, cw_field field, cw_volume *volume,
                              cw_error *err)
{
    const cw_field_desc desc = {
        .field = field,
        .dim = {args->dims.n[0], args->dims.n[1], args->dims.n[2]},
        .type = (cw_type)args->type,
        .noise = args->noise.value,
        .seed = args->seed,
        .threads = (int)args->threads,
        .progress = cli_progress(mega_voxels(args), "Mvoxel"),
    };
    return cw_field_sample(&desc, volume, err);
}

static cw_status sample_labels(const make_args *args, size_t number, cw_volume *volume,
                               cw_error *err)
{
    const cw_label_field_desc desc = {
        .field = (cw_label_field)number,
        .dim = {args->dims.n[0], args->dims.n[1], args->dims.n[2]},
        .type = (cw_type)args->type,
        .labels = args->labels,
        .seed = args->seed,
        .threads = (int)args->threads,
        .progress = cli_progress(mega_voxels(args), "Mvoxel"),
    };
    if (args->noise.given)
        return cwi_fail(err, CW_ERR_ARGUMENT, "--noise is not for label maps");
    return cw_label_field_sample(&desc, volume, err);
}

static cw_status sample_hard(const make_args *args, size_t number, cw_volume *volume,
                             cw_error *err)
{
    const cw_hard_desc desc = {
        .number = number,
        .dim = {args->dims.n[0], args->dims.n[1], args->dims.n[2]},
        .type = (cw_type)args->type,
        .noise = args->noise.value,
        .seed = args->seed,
        .threads = (int)args->threads,
        .progress = cli_progress(mega_voxels(args), "Mvoxel"),
    };
    return cw_hard_sample(&desc, volume, err);
}

/* Returns the isovalue as voxels of that type store it. */
static double stored_level(const cli_made_field *s, cw_type type)
{
    return s->hard ? cw_hard_stored(s->number, type, s->isovalue)
                   : cw_field_stored((cw_field)s->number, type, s->isovalue);
}

static cw_status make_field(const make_args *args, const cli_made_field *s, cw_error *err)
{
    cw_volume volume;
    double start = cli_seconds();
    if (args->labels && !s->is_label_map)
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "--labels is for label maps: labels/cells and "
                        "labels/spheres");
    cw_status st = s->hard           ? sample_hard(args, s->number, &volume, err)
                   : s->is_label_map ? sample_labels(args, s->number, &volume, err)
                                     : sample_field(args, (cw_field)s->number, &volume, err);
    if (st != CW_OK)
        return st;
    cli_end_step("make", &start);
    const cw_write_desc write = {.format = args->format,
                                 .no_clobber = args->no_clobber,
                                 .name = cli_is_standard(args->output) ? s->name : NULL,
                                 .sink = cli_output_sink(args->output),
                                 .progress = cli_progress(mega_voxels(args), "Mvoxel")};
    st = cw_volume_write(args->output, &volume, &write, err);
    if (st == CW_OK)
        cli_end_step("write", &start);
    if (st == CW_OK && s->is_label_map)
        cli_result("%s: %s, %zu x %zu x %zu %s; its surfaces: --labels all\n", args->output,
                   s->name, volume.dim[0], volume.dim[1], volume.dim[2],
                   cw_type_name(volume.type));
    else if (st == CW_OK)
        cli_result("%s: %s, %zu x %zu x %zu %s; its surface: --iso %.10g\n", args->output,
                   s->name, volume.dim[0], volume.dim[1], volume.dim[2],
                   cw_type_name(volume.type), stored_level(s, volume.type));
    cw_volume_free(&volume);
    return st;
}

static cw_status run_make(void *p, cw_error *err)
{
    make_args *args = p;
    cli_made_field s;
    if (args->list)
        return list_subjects();
    if (args->common.input_count == 0)
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "make needs a field; 'cubewright make --list' lists them");
    if (!find_subject(args->common.inputs[0], &s))
        return unknown_subject(args->common.inputs[0], err);
    if (args->dims.count == 2)
        return cwi_fail(err, CW_ERR_ARGUMENT, "--dims takes one number or three, not two");
    if (args->dims.count == 1)
        args->dims.n[1] = args->dims.n[2] = args->dims.n[0];
    return make_field(args, &s, err);
}

const cli_command cli_make = {
    .name = "make",
    .usage = "FIELD -o VOLUME [options]",
    .about = "Make a test volume whose surface is known exactly",
    .page = cli_page_make,
    .options = options,
    .option_count = sizeof options / sizeof *options,
    .rules = rules,
    .rule_count = sizeof rules / sizeof *rules,
    .max_inputs = 1,
    .inputs = CLI_VALUES_MADE_FIELD,
    .size = sizeof(make_args),
    .defaults = &defaults,
    .run = run_make,
};
