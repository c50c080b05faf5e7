/* The reports that compare no settings: of a mesh and its source, of labels, of a series. */
#include "cli/framework/console.h"
#include "cli/framework/field_names.h"
#include "cli/framework/quantity.h"
#include "cli/inputs/level_choice.h"
#include "cli/report/page.h"
#include "cli/report/report_run.h"
#include "cli/results/run_report.h"
#include "core/base/status.h"

bool cli_report_is_series(const cli_report_args *args)
{
    return args->steps.given || args->common.input_count > 1;
}

/* A mesh alone has nothing that it could be held against. */
cw_status cli_report_check_kind(const cli_report_args *args, cw_error *err)
{
    const char *path = args->common.inputs[0];
    const cw_format *volume = cw_volume_format(path, NULL), *mesh = cw_mesh_format(path, NULL);
    return !args->source && mesh && !volume
               ? cwi_fail(err, CW_ERR_ARGUMENT,
                          "%s is a mesh by its name: name the volume that it is of by --source "
                          "VOLUME",
                          path)
               : CW_OK;
}

/* Reads both; the mesh moves into the study. */
static cw_status open_mesh(cli_report_run *s, cw_error *err)
{
    const cli_report_args *args = s->args;
    cli_mesh_study *m = &s->mesh;
    cli_input source = cli_source_input(&args->input);
    cli_number level = args->iso;
    cw_status st =
        cli_read_mesh(args->common.inputs[0], args->mesh_reader, &args->input, &m->mesh, err);
    if (st != CW_OK)
        return st;
    m->input = &args->input;
    m->reader = args->mesh_reader;
    m->study.full = m->mesh.mesh;
    m->mesh.mesh = (cw_mesh){0};
    st = cli_read_volume(args->source, &source, false, &s->volume, err);
    if (st != CW_OK)
        return st;
    m->study.is_of_mesh = true;
    m->study.volume = &s->volume;
    m->study.threads = (int)args->input.threads;
    m->study.coarsen = 1;
    m->study.inside_is_low = cli_inside_is_low(args->inside, &s->volume.whole);
    m->study.input_words = s->input_words;
    m->study.title = args->title ? args->title : cli_shown_path(m->mesh.path);
    if (!level.given)
        return cli_fit_level(m, err);
    st = cli_choose_level(&s->volume, &source, &level, err);
    m->study.iso = level.value;
    m->study.level = "as asked for";
    return st;
}

cw_status cli_report_mesh(cli_report_run *s, cw_error *err)
{
    const cli_report_args *args = s->args;
    const cli_mesh_study *m = &s->mesh;
    cw_status st = open_mesh(s, err);
    if (st == CW_OK)
        st = cli_study_mesh(&s->mesh, err);
    if (st == CW_OK)
        st = cli_report_make(args->json, cli_put_mesh_json, m, err);
    if (st == CW_OK)
        st = cli_report_make(args->output, cli_put_mesh_page, m, err);
    if (st == CW_OK)
        cli_result("%s: %s against %s at %s%s: 99 %% within %.3g mm; %.1f s\n", args->output,
                   m->mesh.path, s->volume.path, cli_number_text(m->study.iso),
                   m->is_unsure   ? " (fitted, unsure)"
                   : m->is_fitted ? " (fitted)"
                                  : "",
                   m->to_field.p99_mm, m->study.seconds);
    return st;
}

cw_status cli_report_find_labels(cli_report_run *s, const char **labels, cw_error *err)
{
    const cli_report_args *args = s->args;
    char what[CLI_LABELS_TEXT];
    *labels = args->labels;
    if (args->labels || args->iso.given || s->study.is_field || s->volume.streams)
        return CW_OK;
    cw_status st = cli_looks_like_labels(&s->volume, what, err);
    if (st == CW_OK && *what) {
        cli_note_volume(&s->volume, "%s", what);
        *labels = "all";
    }
    return st;
}

cw_status cli_report_labels(cli_report_run *s, const char *labels, cw_error *err)
{
    const cli_report_args *args = s->args;
    cli_label_study *l = &s->labels;
    const cli_label_look look = {.labels = labels, .names = args->names};
    l->input = &args->input;
    l->step = args->input.step;
    l->study.volume = &s->volume;
    l->study.threads = (int)args->input.threads;
    l->study.title = args->title ? args->title : cli_shown_path(s->volume.path);
    cw_status st = cli_study_labels(l, &look, &s->volume, err);
    if (st == CW_OK)
        st = cli_report_make(args->json, cli_put_label_json, l, err);
    if (st == CW_OK)
        st = cli_report_make(args->output, cli_put_label_page, l, err);
    if (st == CW_OK)
        cli_result("%s: %zu label%s, %s triangles; %.1f s\n", args->output,
                   l->scene.shown.count, l->scene.shown.count == 1 ? "" : "s",
                   cli_count(l->triangles), l->study.seconds);
    return st;
}

/* The level of all steps is that of the first, unless it was stated. */
static cw_status find_series_level(cli_report_run *s, cw_error *err)
{
    const cli_report_args *args = s->args;
    cli_series_study *q = &s->series;
    cli_number level = args->iso;
    cw_status st = cli_read_step(&q->source, &args->input, 0, err);
    if (st != CW_OK)
        return st;
    q->study.inside_is_low = cli_inside_is_low(args->inside, &q->source.volume.whole);
    if (!level.given)
        return cli_find_level(&q->source.volume, &args->input, &q->study.iso, &q->study.level,
                              err);
    st = cli_choose_level(&q->source.volume, &args->input, &level, err);
    q->study.iso = level.value;
    q->study.level = "as asked for";
    return st;
}

cw_status cli_report_series(cli_report_run *s, cw_error *err)
{
    const cli_report_args *args = s->args;
    cli_series_study *q = &s->series;
    const char *first = args->common.inputs[0];
    cw_status st =
        cli_open_source(&q->source, &args->common, &args->input, &args->steps, false, err);
    if (st == CW_OK)
        st = find_series_level(s, err);
    if (st != CW_OK)
        return st;
    q->study.threads = (int)args->input.threads;
    q->study.volume = &q->source.volume;
    if (args->common.input_count > 1)
        snprintf(s->title, sizeof s->title, "%s to %s", cli_shown_path(first),
                 cli_shown_path(args->common.inputs[args->common.input_count - 1]));
    else
        snprintf(s->title, sizeof s->title, "%s", cli_shown_path(first));
    q->study.title = args->title ? args->title : s->title;
    st = cli_study_series(q, &args->input, err);
    if (st == CW_OK)
        st = cli_report_make(args->json, cli_put_series_json, q, err);
    if (st == CW_OK)
        st = cli_report_make(args->output, cli_put_series_page, q, err);
    if (st == CW_OK)
        cli_result("%s: %zu steps; %.1f s\n", args->output, q->source.series.count,
                   q->study.seconds);
    return st;
}
