/* The command info: prints the facts of a volume or a series, such as its grid, range of
 * values and suggested isovalues. */
#include "cli/info/cmd_info.h"
#include "cli/framework/batch.h"
#include "cli/framework/console.h"
#include "cli/framework/field_names.h"
#include "cli/framework/quantity.h"
#include "cli/framework/run_config.h"
#include "cli/info/info_facts.h"
#include "cli/inputs/time_series.h"
#include "cli/inputs/volume_input.h"
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/volume/named_level.h"
#include "core/volume/volume.h"

#include <cubewright/extract.h>

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct info_args {
    cli_common common;
    cli_input input;
    cli_numbers iso;
    size_t histogram;
    const char *names, *labels, *within;
    bool json, levels, deep;
} info_args;

static const cli_option options[] = {
    {"histogram", 0, CLI_COUNT, "N", "Print a histogram of the values with N bins (0)",
     offsetof(info_args, histogram)},
    {"iso", 'i', CLI_LEVELS, "V[,V...]",
     "Predict the mesh, file sizes, memory and time of 'extract' at isovalues; reads all voxels (none)",
     offsetof(info_args, iso)},
    {"labels", 'l', CLI_TEXT, "all/LIST",
     "Predict the meshes, memory and time of 'extract --labels'; reads all voxels (none)",
     offsetof(info_args, labels)},
    {"names", 0, CLI_TEXT, "FILE",
     "Table of the labels' names and colours (in the volume, else in a file beside it)",
     offsetof(info_args, names), CLI_VALUES_FILE},
    {"within", 0, CLI_TEXT, "MESH",
     "Measure the values inside of a closed mesh, by its parts; reads all voxels (none)",
     offsetof(info_args, within), CLI_VALUES_MESH},
    {"levels", 0, CLI_FLAG, NULL,
     "Predict the number of triangles at each suggested isovalue, and the size of an STL file (off)",
     offsetof(info_args, levels)},
    {"deep", 0, CLI_FLAG, NULL,
     "Read all voxels (off: above 256 MiB a part of the rows, unless --levels needs all)",
     offsetof(info_args, deep)},
    {"json", 0, CLI_FLAG, NULL, "Print one JSON object (off)", offsetof(info_args, json)},
    CLI_BATCH_OPTIONS(info_args),
    CLI_INPUT_OPTIONS(info_args),
};

/* Adds the isovalues of a CT that are in the range of its values. */
static void add_tissues(cli_info_facts *f, const cw_statistics *s)
{
    if (!cwi_is_hounsfield(&f->volume.whole, s))
        return;
    for (cli_level n = CLI_LEVEL_BONE; n <= CLI_LEVEL_METAL; n++) {
        const char *name = cli_level_text(n, 0);
        double value;
        if (cwi_hounsfield_level(name, &value) && s->min < value && s->max >= value)
            f->levels[f->level_count++] = (cli_info_level){.name = name, .value = value};
    }
}

/* otsu parts two classes; dark, medium and bright part four [Otsu1979, Liao2001]. */
static cw_status find_levels(cli_info_facts *f, int threads, cw_error *err)
{
    static const char *const names[] = {"otsu", "dark", "medium", "bright"};
    cw_statistics s;
    double values[CLI_INFO_LEVELS + 1];
    cw_status st = cw_volume_statistics(&f->volume.view, CWI_LEVEL_BINS, threads, &s, err);
    if (st != CW_OK)
        return st;
    int count = cw_statistics_otsu(&s, 1, values) ? 1 : 0;
    if (count && cw_statistics_otsu(&s, CLI_INFO_LEVELS, values + 1))
        count += CLI_INFO_LEVELS;
    if (f->volume.whole.known & CW_KNOWN_LEVEL_SET)
        f->levels[f->level_count++] = (cli_info_level){.name = "zero", .value = 0};
    for (int n = 0; n < count; n++)
        f->levels[f->level_count++] =
            (cli_info_level){.name = names[n], .value = cwi_round_level(values[n])};
    if (count)
        add_tissues(f, &s);
    cw_statistics_free(&s);
    return CW_OK;
}

static cw_status predict_surface(cli_info_facts *f, int threads, cw_error *err)
{
    cw_extractor *extractor;
    cw_status st = cw_extractor_new(&f->volume.view, &extractor, err);
    for (int n = 0; n < f->level_count && st == CW_OK; n++) {
        const cw_extract_desc desc = {.isovalue = f->levels[n].value,
                                      .inside_is_low =
                                          cli_inside_is_low(CLI_INSIDE_AUTO, &f->volume.whole),
                                      .threads = threads};
        cw_extract_counts counts = {0};
        st = cw_extractor_predict(extractor, &desc, &counts, err);
        f->levels[n].triangles = counts.triangles;
    }
    cw_extractor_free(extractor);
    return st;
}

/* Returns true if an array is too large to be read for its range alone, unless --deep asks for
 * that. */
static bool is_large(const info_args *args, const cw_read_desc *desc)
{
    const double limit = (double)(256 << 20); /* bytes, as of the volume itself */
    cw_read_desc header = *desc;
    cw_volume v;
    header.header_only = true;
    header.note = NULL;
    header.max_bytes = 0;
    header.max_voxels = UINT64_MAX;
    if (args->deep || cw_volume_read(args->common.inputs[0], &header, &v, NULL, NULL) != CW_OK)
        return false;
    const bool is_dense = !v.sparse && !v.cells;
    const double bytes = (double)(v.dim[0] * v.components * cw_type_size(v.type)) *
                         (double)v.dim[1] * (double)v.dim[2] * (double)v.steps;
    cw_volume_free(&v);
    return is_dense && bytes > limit;
}

/* Of every component, at the chosen step. Those of a large array are not finite. */
static cw_status find_ranges(const info_args *args, const char *name, double (*ranges)[2],
                             cw_error *err)
{
    cw_read_desc desc = cli_read_desc(args->common.inputs[0], &args->input);
    cw_volume all, one;
    desc.array = name;
    if (is_large(args, &desc)) {
        ranges[0][0] = ranges[0][1] = (double)NAN;
        return CW_OK;
    }
    cw_status st = cw_volume_read(args->common.inputs[0], &desc, &all, NULL, err);
    if (st != CW_OK)
        return st;
    for (size_t c = 0; c < all.components && c < CLI_INFO_COMPONENTS && st == CW_OK; c++) {
        cw_statistics s = {0};
        st = cw_volume_select(&all, c, 0, &one, err);
        if (st == CW_OK)
            st = cw_volume_statistics(&one, 0, (int)args->input.threads, &s, err);
        ranges[c][0] = s.min;
        ranges[c][1] = s.max;
    }
    cw_volume_free(&all);
    return st;
}

static cw_status find_arrays(const info_args *args, cli_info_facts *f, cw_error *err)
{
    const cw_read_desc desc = cli_read_desc(args->common.inputs[0], &args->input);
    if (args->input.raw)
        return CW_OK;
    cw_status st =
        cw_arrays_list(args->common.inputs[0], &desc, &f->arrays, &f->array_count, err);
    if (st != CW_OK || f->array_count < 2) {
        cw_arrays_free(f->arrays);
        f->arrays = NULL;
        f->array_count = 0;
        return st;
    }
    f->ranges = calloc(f->array_count * CLI_INFO_COMPONENTS, sizeof *f->ranges);
    if (!f->ranges)
        return cwi_fail_memory(err);
    for (size_t n = 0; n < f->array_count && st == CW_OK; n++)
        if (cli_info_is_reached(f, n))
            st = find_ranges(args, f->arrays[n].name, f->ranges + n * CLI_INFO_COMPONENTS, err);
    return st;
}

/* Predicts what `extract` takes. It comes last, as it may free the voxels. */
static cw_status predict_extract(const info_args *args, size_t program_bytes, cli_info_facts *f,
                                 cw_error *err)
{
    cli_numbers iso = args->iso;
    cw_status st = cli_choose_levels(&f->volume, &args->input, &iso, err);
    const cli_predict_desc desc = {.iso = &iso,
                                   .input = &args->input,
                                   .program_bytes = program_bytes,
                                   .read_seconds = f->read_seconds};
    return st == CW_OK && iso.count ? cli_predict(&desc, &f->volume, &f->predictions, err) : st;
}

/* Predicts the time and memory of `extract --labels`. It comes last, too. */
static cw_status predict_labels(const info_args *args, size_t program_bytes, cli_info_facts *f,
                                cw_error *err)
{
    const cli_label_predict_desc desc = {.list = args->labels,
                                         .input = &args->input,
                                         .table = &f->labels.names.table,
                                         .program_bytes = program_bytes,
                                         .read_seconds = f->read_seconds};
    if (!args->labels)
        return CW_OK;
    if (!f->labels.is_label_map)
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "%s: --labels is for label maps, and neither the file nor its values "
                        "say that this is one; --names FILE does, --iso V predicts a surface",
                        f->volume.path);
    return cli_predict_labels(&desc, &f->volume, &f->label_prediction, err);
}

static cw_status find_facts(const info_args *args, cli_info_facts *f, cw_error *err)
{
    const int threads = (int)args->input.threads;
    const size_t program_bytes = cli_peak_bytes();
    const double start = cli_seconds();
    cli_input input = args->input;
    input.sample = !args->deep && !args->levels && !args->within;
    cw_status st = cli_read_any_volume(args->common.inputs[0], &input, &f->volume, err);
    f->read_seconds = cli_seconds() - start;
    if (st != CW_OK)
        return st;
    double step = start;
    cli_end_step("read", &step);
    st = cw_volume_statistics(&f->volume.view, args->histogram, threads, &f->range, err);
    if (st == CW_OK)
        st = cli_find_label_facts(args->names, &f->volume, &f->labels, err);
    if (st == CW_OK && !f->labels.is_label_map)
        st = find_levels(f, threads, err);
    if (st == CW_OK)
        st = find_arrays(args, f, err);
    if (st == CW_OK) {
        const cw_read_desc desc = cli_read_desc(args->common.inputs[0], &args->input);
        st = args->input.raw ? CW_OK
                             : cli_find_scales(args->common.inputs[0], &desc, &f->scales, err);
    }
    if (st == CW_OK && f->labels.is_label_map)
        st = cli_tell_labels(&f->volume, NULL, 0, false, err);
    if (st == CW_OK && args->levels && f->level_count)
        st = predict_surface(f, threads, err);
    cli_end_step("count", &step);
    if (st != CW_OK)
        return cwi_fail_in(err, st, f->volume.path);
    if (args->within)
        st = cli_find_within(args->within, &args->input, &f->volume, &f->within, err);
    if (st != CW_OK)
        return st;
    st = predict_extract(args, program_bytes, f, err);
    if (st == CW_OK)
        st = predict_labels(args, program_bytes, f, err);
    cli_end_step("predict", &step);
    return st;
}

/* --- time series of files ----------------------------------------------------------------- */

/* A step: what is in its file, and the range of its values. */
typedef struct step_facts {
    cli_volume volume;
    cw_statistics range;
} step_facts;

static cw_status read_step(const info_args *args, const char *path, step_facts *step,
                           cw_error *err)
{
    const int threads = (int)args->input.threads;
    cw_status st = cli_read_volume(path, &args->input, false, &step->volume, err);
    if (st != CW_OK)
        return st;
    st = cw_volume_statistics(&step->volume.view, 0, threads, &step->range, err);
    cw_volume_free(&step->volume.voxels);
    return st == CW_OK ? st : cwi_fail_in(err, st, path);
}

static void print_step(size_t n, const step_facts *step)
{
    printf("  step %-4zu%s  %s, values %.10g to %.10g\n", n, step->volume.path,
           cli_describe(&step->volume), step->range.min, step->range.max);
}

static void json_step(cli_json *j, const step_facts *step)
{
    cli_json_open(j, NULL, '{');
    cli_json_input(j, "input", &step->volume);
    cli_json_numbers(j, "range", (const double[2]){step->range.min, step->range.max}, 2);
    cli_json_close(j, '}');
}

/* Reads every file, also behind one that does not agree: the first such is the finding. */
static cw_status list_files(const info_args *args, char *const *files, size_t count,
                            cli_json *j, cw_error *finding, cw_error *err)
{
    cw_volume first = {0};
    bool agrees = true; /* else the finding says in what they do not */
    for (size_t n = 0; n < count; n++) {
        step_facts step = {0};
        cw_status st = read_step(args, files[n], &step, err);
        if (st != CW_OK) {
            cli_free_volume(&step.volume);
            return st;
        }
        first = n ? first : step.volume.whole; /* whose coordinates soon are gone */
        agrees = agrees &&
                 cli_agree(&first, files[0], &step.volume.whole, files[n], finding) == CW_OK;
        if (args->json)
            json_step(j, &step);
        else
            print_step(n, &step);
        cli_free_volume(&step.volume);
    }
    return CW_OK;
}

static void open_list(const info_args *args, size_t count, cli_json *j)
{
    if (!args->json) {
        printf("%zu files, a time step each\n", count);
        return;
    }
    cli_json_begin(j, "cubewright-steps-1");
    cli_json_open(j, "steps", '[');
}

static void close_list(const info_args *args, const cw_error *finding, cli_json *j)
{
    if (!args->json)
        return;
    cli_json_close(j, ']');
    cli_json_bool(j, "agree", finding->status == CW_OK);
    cli_json_message(j, "finding", finding->message);
    cli_json_close(j, '}');
}

static cw_status print_files(const info_args *args, char *const *files, size_t count,
                             cw_error *err)
{
    cli_json j = {.out = stdout};
    cw_error finding = {0};
    if (args->histogram || args->levels || args->iso.count || args->labels || args->within)
        return cwi_fail(
            err, CW_ERR_ARGUMENT,
            "--histogram, --levels, --labels, --within and --iso need a single file; there are %zu",
            count);
    open_list(args, count, &j);
    cw_status st = list_files(args, files, count, &j, &finding, err);
    close_list(args, st == CW_OK ? &finding : err, &j);
    if (st == CW_OK && finding.status != CW_OK)
        *err = finding;
    return st == CW_OK ? finding.status : st;
}

static cw_status list_steps(const info_args *args, bool *listed, cw_error *err)
{
    const cw_raw_layout raw = {0}; /* only whether there is one counts here */
    cw_read_desc desc = cli_read_desc(args->common.inputs[0], &args->input);
    char **files;
    size_t count;
    desc.raw = args->input.raw ? &raw : NULL;
    cw_status st = cw_steps_list(args->common.inputs, args->common.input_count, &desc, &files,
                                 &count, err);
    *listed = count > 0;
    if (st == CW_OK && count)
        st = print_files(args, files, count, err);
    cw_steps_free(files, count);
    return st;
}

static bool is_named(const cw_series *s, const char *name)
{
    return name && strcmp(s->label, name) == 0;
}

/* Several series, or one that cannot be read as it is, are listed and nothing more. */
static cw_status list_series(const info_args *args, cli_info_facts *f, bool *listed,
                             cw_error *err)
{
    const char *path = args->common.inputs[0];
    cli_volume notes = {.path = path, .is_quiet = true};
    cw_read_desc desc = cli_read_desc(args->common.inputs[0], &args->input);
    cw_series *series;
    size_t count;
    if (args->input.raw)
        return CW_OK;
    desc.note = cli_take_note;
    desc.note_user = &notes;
    cw_status st = cw_series_list(path, &desc, &series, &count, err);
    for (size_t n = 0; n < count; n++)
        if (count == 1 || is_named(&series[n], args->input.series))
            f->series = series[n];
    if (args->input.series) {
        cw_series_free(series);
        return st;
    }
    *listed = count > 1 || (count == 1 && series[0].status != CW_OK);
    if (*listed && args->json)
        cli_json_all_series(&notes, series, count);
    else if (*listed)
        cli_print_series(&notes, series, count);
    cw_series_free(series);
    return st;
}

static cw_status run_info(void *p, cw_error *err)
{
    info_args *args = p;
    cli_info_facts f = {0};
    bool listed = false;
    cli_common silent = args->common;
    silent.quiet = true; /* the found line is part of the result here */
    cli_console_start(&silent, CLI_PROGRESS_AUTO);
    cw_status st = list_steps(args, &listed, err);
    if (st == CW_OK && !listed)
        st = list_series(args, &f, &listed, err);
    if (st != CW_OK || listed)
        return st;
    st = find_facts(args, &f, err);
    if (st == CW_OK && args->json)
        cli_json_info(&f, args->levels);
    else if (st == CW_OK)
        cli_print_info(&f, args->input.step, args->levels);
    if (st == CW_OK)
        st = cli_expect_surfaces(&f.volume, &f.predictions, err);
    cw_statistics_free(&f.range);
    cli_free_label_facts(&f.labels);
    cli_free_within(&f.within);
    cw_levels_free(f.scales.levels);
    cw_arrays_free(f.arrays);
    free(f.ranges);
    cli_free_volume(&f.volume);
    return st;
}

const cli_command cli_info = {
    .name = "info",
    .usage = "VOLUME... [options]",
    .about = "Describe a volume: size, type, frame, values, suggested isovalues",
    .page = cli_page_info,
    .options = options,
    .option_count = sizeof options / sizeof *options,
    .min_inputs = 1,
    .max_inputs = SIZE_MAX,
    .inputs = CLI_VALUES_VOLUME,
    .size = sizeof(info_args),
    .run = run_info,
};
