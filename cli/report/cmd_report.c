/* The command report: its options, its input (a file or a field), and the page, JSON and CSV
 * that it writes about a study. */
#include "cli/framework/batch.h"
#include "cli/framework/commands.h"
#include "cli/framework/console.h"
#include "cli/framework/field_names.h"
#include "cli/framework/quantity.h"
#include "cli/inputs/extract_surface.h"
#include "cli/inputs/level_choice.h"
#include "cli/inputs/synthetic_input.h"
#include "cli/report/page.h"
#include "cli/report/report_run.h"
#include "cli/results/output_names.h"
#include "cli/results/run_report.h"
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/base/text.h"
#include "core/volume/volume.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <unistd.h>

enum { DEFAULT_DIMS = 96, MAX_DIMS = 1024 };

/* Of more voxels meshes are studied on every other one, or fewer. */
static const double MAX_VOXELS = 33554432;

static const cli_report_args defaults = {.budget = "60s"};

static const cli_option options[] = {
    {"output", 'o', CLI_TEXT, "FILE",
     "Page to write, a .html file; may hold {stem} and {parent}",
     offsetof(cli_report_args, output), CLI_VALUES_HTML},
    {"iso", 'i', CLI_LEVEL, "V",
     "Isovalue: a number, or a name as for 'extract' (otsu; of a field its own)",
     offsetof(cli_report_args, iso)},
    {"inside", 0, CLI_CHOICE, CLI_INSIDE_CHOICES,
     "Which values are inside the solid (auto: above; in level sets below)",
     offsetof(cli_report_args, inside)},
    {"budget", 0, CLI_TEXT, "TIME",
     "Time after which no more settings are tried, such as 90s or 5min (60s)",
     offsetof(cli_report_args, budget)},
    {"dims", 'd', CLI_SIZES, "N|XxYxZ", "Samples along the axes, of a field (96)",
     offsetof(cli_report_args, dims)},
    {"coarsen", 0, CLI_COUNT, "N",
     "Use every N-th voxel along each axis for meshes (1; larger above 32M voxels)",
     CLI_INPUT_ROW(cli_report_args, coarsen)},
    {"steps", 0, CLI_STEPS, "A:B:S/N,.../all",
     "Time steps to report, counted from 0, a row each; several files are a series, too",
     offsetof(cli_report_args, steps)},
    CLI_HEADED("Mesh"),
    {"source", 's', CLI_TEXT, "VOLUME",
     "The input is a mesh, and this the volume that it is of: report where it comes from",
     offsetof(cli_report_args, source), CLI_VALUES_VOLUME},
    {"mesh-reader", 0, CLI_TEXT, "NAME",
     "Read the mesh as this format; names as in 'formats' (by content)",
     offsetof(cli_report_args, mesh_reader), CLI_VALUES_MESH_READER},
    CLI_CLAIM_OPTIONS("source", "the source", CLI_INPUT_ROW(cli_report_args, source_claim)),
    CLI_HEADED("Label map"),
    {"labels", 'l', CLI_TEXT, "LIST|all",
     "Report these labels, as 'extract' takes them (all, where the values look like labels)",
     offsetof(cli_report_args, labels)},
    {"names", 0, CLI_TEXT, "FILE",
     "Table of the labels' names and colours (in the volume, else in a file beside it)",
     offsetof(cli_report_args, names), CLI_VALUES_FILE},
    CLI_HEADED("Output files"),
    {"title", 0, CLI_TEXT, "TEXT", "Title of the page (the input's name)",
     offsetof(cli_report_args, title)},
    {"json", 0, CLI_TEXT, "FILE", "Write the same facts as JSON; - is the standard output",
     offsetof(cli_report_args, json), CLI_VALUES_JSON},
    {"csv", 0, CLI_TEXT, "FILE",
     "Write a table with a row for each setting; - is the standard output",
     offsetof(cli_report_args, csv), CLI_VALUES_CSV},
    CLI_BATCH_OPTIONS(cli_report_args),
    CLI_INPUT_OPTIONS(cli_report_args),
    CLI_PROGRESS_OPTION(cli_report_args),
};

static const cli_rule rules[] = {
    {NULL, CLI_NEEDS, "output"},
    {"source", CLI_EXCLUDES, "budget dims csv labels names steps"},
    {"mesh-reader source-unit source-up source-frame source-override", CLI_NEEDS, "source"},
    {"steps", CLI_EXCLUDES, "budget dims csv labels names"},
    {"names", CLI_NEEDS, "labels"},
    {"labels", CLI_EXCLUDES, "budget dims csv iso inside coarsen"},
};

static cw_status parse_budget(const char *text, double *seconds, cw_error *err)
{
    const char *at = text;
    const bool number = cwi_parse_double(&at, seconds);
    const double unit = strcmp(at, "min") == 0 || strcmp(at, "m") == 0 ? 60
                        : strcmp(at, "s") == 0 || *at == '\0'          ? 1
                                                                       : 0;
    *seconds *= unit;
    if (!number || unit == 0 || !(*seconds > 0) || !isfinite(*seconds))
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "--budget '%s': a time above 0 was expected, such as 60s or 5min",
                        text);
    return CW_OK;
}

static cw_status check_dims(cli_report_args *args, cw_error *err)
{
    size_t *n = args->dims.n;
    if (args->dims.count == 2)
        return cwi_fail(err, CW_ERR_ARGUMENT, "--dims takes one number or three, not two");
    if (args->dims.count == 0)
        n[0] = DEFAULT_DIMS;
    if (args->dims.count < 2)
        n[1] = n[2] = n[0];
    for (int a = 0; a < 3; a++)
        if (n[a] < 8 || n[a] > MAX_DIMS)
            return cwi_fail(err, CW_ERR_ARGUMENT,
                            "--dims: 8 to %d samples were expected, not %zu", MAX_DIMS, n[a]);
    return CW_OK;
}

/* Fails for names of another kind of file, such as .pdf. */
static cw_status check_page_name(const char *path, cw_error *err)
{
    const char *slash = strrchr(path, '/'), *dot = strrchr(slash ? slash : path, '.');
    if (!dot || strcasecmp(dot, ".html") == 0 || strcasecmp(dot, ".htm") == 0)
        return CW_OK;
    return cwi_fail(err, CW_ERR_ARGUMENT,
                    "%s: a report is a page of HTML: give it a name that ends in .html", path);
}

static cw_status check_outputs(const cli_report_args *args, cw_error *err)
{
    const char *const files[] = {args->output, args->json, args->csv};
    cw_status st = CW_OK;
    for (size_t n = 0; n < 3 && st == CW_OK; n++) {
        if (!files[n] || strcmp(files[n], "-") == 0)
            continue;
        st = cli_check_output(files[n], args->common.inputs, args->common.input_count, err);
        if (st == CW_OK && args->source)
            st = cli_check_output(files[n], (const char *const *)&args->source, 1, err);
        for (size_t before = 0; before < n && st == CW_OK; before++)
            if (files[before] && strcmp(files[before], "-") != 0)
                st = cli_check_apart(files[before], files[n], err);
    }
    if (st == CW_OK)
        st = check_page_name(args->output, err);
    if (st == CW_OK && args->json && args->csv && strcmp(args->json, "-") == 0 &&
        strcmp(args->csv, "-") == 0)
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "--json and --csv: only one of them can use the standard output");
    return st;
}

static bool is_given(const cli_report_args *args, const char *name)
{
    size_t n = 0;
    while (strcmp(options[n].name, name) != 0)
        n++;
    return args->common.given[n];
}

/* Fails for an option of a list that was given. */
static cw_status refuse_options(const cli_report_args *args, const char *const *names,
                                const char *why, cw_error *err)
{
    for (; *names; names++)
        if (is_given(args, *names))
            return cwi_fail(err, CW_ERR_ARGUMENT, "--%s %s", *names, why);
    return CW_OK;
}

/* Fails for options of settings, of labels and of names with the files of a series. */
static cw_status check_mode(const cli_report_args *args, cw_error *err)
{
    static const char *const names[] = {"budget", "dims", "csv", "labels", "names", NULL};
    return cli_report_is_series(args)
               ? refuse_options(args, names, "cannot be combined with several files", err)
               : CW_OK;
}

/* Fails for a name that is no file and nearly a field's name. For other names, the reader's own
 * message is better. */
static cw_status check_name(const char *name, cw_error *err)
{
    const char *nearest = cli_nearest_field(name);
    return nearest ? cwi_fail(err, CW_ERR_ARGUMENT,
                              "'%s' is neither a file nor a field; did you mean '%s'?", name,
                              nearest)
                   : CW_OK;
}

static cw_status check_args(cli_report_run *s, cw_error *err)
{
    cli_report_args *args = s->args;
    cw_status st = parse_budget(args->budget, &s->study.budget_s, err);
    if (st == CW_OK)
        st = check_mode(args, err);
    if (st == CW_OK && !s->study.is_field)
        st = cli_report_check_kind(args, err);
    if (st != CW_OK)
        return st;
    if (!s->study.is_field && !cli_report_is_series(args) &&
        access(args->common.inputs[0], F_OK) != 0)
        st = check_name(args->common.inputs[0], err);
    if (st != CW_OK)
        return st;
    if (strcmp(args->output, "-") == 0 && args->json && strcmp(args->json, "-") == 0)
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "-o and --json: only one of them can use the standard output");
    if (s->study.is_field && args->input.coarsen)
        return cwi_fail(err, CW_ERR_ARGUMENT, "--coarsen is for files; --dims samples fewer");
    if (!s->study.is_field && !cli_report_is_series(args) && args->dims.count)
        return cwi_fail(err, CW_ERR_ARGUMENT, "--dims is for fields, and %s is a file",
                        args->common.inputs[0]);
    st = s->study.is_field ? check_dims(args, err) : CW_OK;
    return st == CW_OK ? check_outputs(args, err) : st;
}

/* Repeats the given options of reading in the printed commands: the rows from --reader on,
 * and of a mesh those of its source. */
static void put_reading(FILE *out, const cli_report_args *args)
{
    bool reading = false;
    for (size_t n = 0; n < sizeof options / sizeof *options; n++) {
        char text[4096];
        const cli_option *o = &options[n];
        reading = reading || strcmp(o->name, "reader") == 0;
        const bool of_mesh =
            strncmp(o->name, "source-", 7) == 0 || strcmp(o->name, "mesh-reader") == 0;
        if (!(reading || of_mesh) || !args->common.given[n])
            continue;
        if (o->kind == CLI_FLAG) {
            fprintf(out, " --%s%s",
                    *(const bool *)((const char *)args + o->offset) ? "" : "no-", o->name);
        } else if (cli_option_text(o, args, text, sizeof text)) {
            fprintf(out, " --%s ", o->name);
            cli_put_word(out, text);
        }
    }
}

/* Keeps the words of commands that name a file and how it was read. A name that begins with a dash
 * would be taken for an option. */
static cw_status tell_input(cli_report_run *s, const char *path, cw_error *err)
{
    size_t size;
    char *text;
    FILE *out = cwi_text_open(&text, &size);
    char *word = malloc(strlen(path) + 3);
    if (out && word) {
        sprintf(word, "%s%s", *path == '-' ? "./" : "", path);
        cli_put_word(out, word);
        put_reading(out, s->args);
    }
    const bool good = cwi_text_close(out, &text) && word;
    free(word);
    s->input_words = text;
    return good ? CW_OK : cwi_fail_memory(err);
}

static cw_status make_field(cli_report_run *s, cw_error *err)
{
    const cli_report_args *args = s->args;
    const size_t *n = args->dims.n;
    const cw_field field = s->study.field;
    cli_volume *v = &s->volume;
    cw_status st = cli_make_field(field, n, &args->input, v, err);
    if (st != CW_OK)
        return st;
    snprintf(s->field_path, sizeof s->field_path, "%s.nrrd", cw_field_name(field));
    v->path = s->field_path;
    s->make_words = malloc(256);
    if (!s->make_words)
        return cwi_fail_memory(err);
    snprintf(s->make_words, 256, "cubewright make %s --dims %zux%zux%zu -o %s",
             cw_field_name(field), n[0], n[1], n[2], s->field_path);
    return CW_OK;
}

/* Reads the file. Without --coarsen, chooses a step that leaves at most MAX_VOXELS. */
static cw_status read_file(cli_report_run *s, cw_error *err)
{
    cli_report_args *args = s->args;
    const char *path = args->common.inputs[0];
    cw_volume shape;
    cw_status st = CW_OK;
    args->input.coarsen_view = true;
    if (!args->input.coarsen) {
        st = cli_read_shape(path, &args->input, &shape, err);
        size_t step = 1;
        while (st == CW_OK && !shape.cells && !shape.sparse &&
               (double)(shape.dim[0] / step) * (double)(shape.dim[1] / step) *
                       (double)(shape.dim[2] / step) >
                   MAX_VOXELS)
            step++;
        args->input.coarsen = step > 1 ? step : 0;
    }
    return st == CW_OK ? cli_read_volume(path, &args->input, false, &s->volume, err) : st;
}

static cw_status find_level(cli_report_run *s, cw_error *err)
{
    cli_study *study = &s->study;
    if (!s->args->iso.given && !study->is_field)
        return cli_find_level(&s->volume, &s->args->input, &study->iso, &study->level, err);
    if (!s->args->iso.given) {
        study->level = "the field's own";
        study->iso = cw_field_isovalue(study->field);
        return CW_OK;
    }
    study->level = "as asked for";
    cw_status st = cli_choose_level(&s->volume, &s->args->input, &s->args->iso, err);
    study->iso = s->args->iso.value;
    return st;
}

/* The drawn volume is not the coarsened one: render reads all voxels. */
static cw_status open_input(cli_report_run *s, cw_error *err)
{
    cli_study *study = &s->study;
    const cli_input *input = &s->args->input;
    cw_status st = study->is_field ? make_field(s, err) : read_file(s, err);
    const cw_volume *all =
        input->array.component.magnitude ? &s->volume.magnitude : &s->volume.voxels;
    if (st == CW_OK)
        st = input->array.component.magnitude
                 ? cw_volume_select(all, 0, 0, &study->drawn, err)
                 : cw_volume_select(all, input->array.component.number, input->step,
                                    &study->drawn, err);
    if (st == CW_OK)
        st = tell_input(s, s->volume.path, err);
    if (st != CW_OK)
        return st;
    study->volume = &s->volume;
    study->threads = (int)input->threads;
    study->coarsen = s->volume.coarsen[0] ? s->volume.coarsen[0] : 1;
    study->is_cropped = input->crop.given;
    study->inside_is_low = cli_inside_is_low(s->args->inside, &s->volume.whole);
    study->input_words = s->input_words;
    study->make_words = s->make_words;
    study->title = s->args->title    ? s->args->title
                   : study->is_field ? cw_field_name(study->field)
                                     : cli_shown_path(s->volume.path);
    return CW_OK;
}

static void tell_result(const cli_study *study, const char *path)
{
    size_t done = 0;
    for (size_t n = 0; n < study->point_count; n++)
        done += study->points[n].done;
    cli_result("%s: %zu settings tried, %zu left out; %.1f s\n", path, done,
               study->point_count - done, study->seconds);
}

static cw_status run_pipeline(cli_report_run *s, cw_error *err)
{
    static const char *const of_settings[] = {"budget", "dims",    "csv",
                                              "inside", "coarsen", NULL};
    const cli_report_args *args = s->args;
    cw_status st = check_args(s, err);
    if (st == CW_OK && args->source) {
        st = tell_input(s, args->source, err);
        return st == CW_OK ? cli_report_mesh(s, err) : st;
    }
    if (st == CW_OK && cli_report_is_series(args))
        return cli_report_series(s, err);
    const char *labels = NULL;
    double start = cli_seconds();
    if (st == CW_OK)
        st = open_input(s, err);
    if (st == CW_OK)
        cli_end_step("read", &start);
    if (st == CW_OK)
        st = cli_report_find_labels(s, &labels, err);
    if (st == CW_OK && labels) {
        st = refuse_options(
            args, of_settings,
            "does nothing for labels; with --iso a level of their numbers is studied", err);
        return st == CW_OK ? cli_report_labels(s, labels, err) : st;
    }
    if (st == CW_OK)
        st = find_level(s, err);
    if (st == CW_OK)
        st = cli_study_run(&s->study, err);
    if (st == CW_OK)
        cli_end_step("try", &start);
    if (st == CW_OK)
        st = cli_report_make(args->json, cli_put_study_json, &s->study, err);
    if (st == CW_OK)
        st = cli_report_make(args->csv, cli_put_study_csv, &s->study, err);
    if (st == CW_OK)
        st = cli_report_make(args->output, cli_put_page, &s->study, err);
    if (st == CW_OK)
        cli_end_step("write", &start);
    if (st == CW_OK)
        tell_result(&s->study, args->output);
    return st;
}

static cw_status run_report_command(void *p, cw_error *err)
{
    cli_report_args *args = p;
    if (args->common.input_count > 1 && args->source)
        return cwi_fail(
            err, CW_ERR_ARGUMENT,
            "a report with --source is about one mesh; there are %zu, for which --batch "
            "makes a report each",
            args->common.input_count);
    cli_report_run *s = calloc(1, sizeof *s);
    if (!s)
        return cwi_fail_memory(err);
    s->args = args;
    /* a file of that name is meant, if there is one */
    s->study.is_field = !args->source && !cli_report_is_series(args) &&
                        access(args->common.inputs[0], F_OK) != 0 &&
                        cw_field_find(args->common.inputs[0], &s->study.field);
    cli_console_start(&args->common, (cli_progress_mode)args->progress);
    cli_console_reserve_stdout(args->output);
    cli_console_reserve_stdout(args->json);
    cli_console_reserve_stdout(args->csv);
    cw_status st = args->output
                       ? cli_name_output(&s->files, args->output, args->common.inputs[0], err)
                       : CW_OK;
    args->output = s->files.count ? s->files.path[0] : args->output;
    if (st == CW_OK)
        st = run_pipeline(s, err);
    cli_free_outputs(&s->files);
    cli_study_free(&s->study);
    cli_free_mesh_study(&s->mesh);
    cli_free_label_study(&s->labels);
    cli_free_series_study(&s->series);
    cli_free_volume(&s->volume);
    free(s->input_words);
    free(s->make_words);
    free(s);
    return st;
}

const cli_command cli_report_command = {
    .name = "report",
    .usage = "VOLUME...|FIELD|MESH -o HTML [options]",
    .about = "Compare the cost and error of settings on your data, on one page",
    .page = cli_page_report,
    .options = options,
    .option_count = sizeof options / sizeof *options,
    .rules = rules,
    .rule_count = sizeof rules / sizeof *rules,
    .min_inputs = 1,
    .max_inputs = SIZE_MAX, /* of a batch or a series */
    .inputs = CLI_VALUES_STUDY,
    .size = sizeof(cli_report_args),
    .defaults = &defaults,
    .run = run_report_command,
};
