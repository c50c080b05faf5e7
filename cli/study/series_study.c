/* Studies a series: extracts the surface of each step, twice. Once to measure it and to find
 * the box of all, once to draw it, so that pictures have one place and one scale and no more
 * than a step is in memory. */
#include "cli/study/series_study.h"

#include "cli/framework/console.h"
#include "cli/framework/run_config.h"
#include "cli/framework/temp_folder.h"
#include "cli/inputs/extract_surface.h"
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/box.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static cw_status extract_step(cli_series_study *q, const cli_input *input, size_t step,
                              cw_mesh *mesh, double *seconds, cw_error *err)
{
    const cw_extract_desc desc = {.isovalue = q->study.iso,
                                  .inside_is_low = q->study.inside_is_low,
                                  .threads = q->study.threads};
    cw_extract_counts counts;
    cw_status st = cli_read_step(&q->source, input, step, err);
    const double start = cli_seconds();
    if (st == CW_OK)
        st = cli_extract_surface(&q->source.volume, &desc, mesh, &counts, err);
    *seconds = cli_seconds() - start;
    return st;
}

static void grow_box(cli_series_study *q, const cw_quality *quality)
{
    if (!q->has_box)
        cwi_box_clear(q->box[0], q->box[1]);
    cwi_box_join(q->box[0], q->box[1], quality->min, quality->max);
    q->has_box = true;
}

static cw_status measure_step(cli_series_study *q, const cli_input *input, size_t step,
                              cw_error *err)
{
    cli_series_row *row = &q->rows[step];
    const cw_quality_desc desc = {.threads = q->study.threads};
    cw_mesh mesh = {0};
    cw_quality quality;
    cw_error why = {0};
    cw_status st = extract_step(q, input, step, &mesh, &row->seconds, &why);
    if (st == CW_ERR_EMPTY) {
        snprintf(row->why, sizeof row->why, "%s", why.message);
        return CW_OK;
    }
    if (st == CW_OK)
        st = cw_quality_measure(&mesh, &desc, &quality, &why);
    cw_mesh_free(&mesh);
    if (st != CW_OK) {
        *err = why;
        return st;
    }
    row->triangles = quality.triangles;
    row->components = quality.components;
    row->closed = cw_quality_is_closed_manifold(&quality);
    row->volume_mm3 = quality.volume_mm3;
    row->area_mm2 = quality.area_mm2;
    grow_box(q, &quality);
    return CW_OK;
}

/* The corners of the box of all steps as a mesh that the camera is placed around. */
static cw_mesh make_frame(const cli_series_study *q, float positions[6])
{
    for (size_t n = 0; n < 6; n++)
        positions[n] = (float)q->box[n / 3][n % 3];
    return (cw_mesh){.vertex_count = 2, .positions = positions};
}

static cw_status draw_step(cli_series_study *q, const cli_input *input, size_t step,
                           cw_error *err)
{
    cli_series_row *row = &q->rows[step];
    float corners[6];
    const cw_mesh frame = make_frame(q, corners);
    cw_mesh mesh = {0};
    double seconds;
    if (*row->why)
        return CW_OK;
    cw_status st = extract_step(q, input, step, &mesh, &seconds, err);
    if (st == CW_OK)
        st = cli_draw_mesh(&q->study, &frame, &mesh, NULL, &row->drawn, err);
    cw_mesh_free(&mesh);
    return st;
}

cw_status cli_study_series(cli_series_study *q, const cli_input *input, cw_error *err)
{
    cli_study *s = &q->study;
    const size_t count = q->source.series.count,
                 every = (count + CLI_SERIES_PICTURES - 1) / CLI_SERIES_PICTURES;
    s->start = cli_seconds();
    s->deadline = INFINITY;
    q->rows = calloc(count + 1, sizeof *q->rows);
    cw_status st = q->rows ? cli_scratch_make(&s->folder, err) : cwi_fail_memory(err);
    for (size_t n = 0; n < count && st == CW_OK; n++)
        st = measure_step(q, input, n, err);
    if (st == CW_OK && !q->has_box)
        st = cwi_fail(err, CW_ERR_EMPTY, "no step has a surface at isovalue %g: the first: %s",
                      s->iso, q->rows[0].why);
    cli_input again = *input;
    again.is_quiet = true; /* what there is to say of the files was said */
    for (size_t n = 0; n < count && st == CW_OK; n += every)
        st = draw_step(q, &again, n, err);
    s->seconds = cli_seconds() - s->start;
    return st;
}

void cli_free_series_study(cli_series_study *q)
{
    for (size_t n = 0; n < q->source.series.count && q->rows; n++)
        free(q->rows[n].drawn.bytes);
    free(q->rows);
    cli_study_free(&q->study);
    cli_close_source(&q->source);
}

static void json_row(cli_json *j, const cli_series_study *q, size_t n)
{
    const cli_series_row *row = &q->rows[n];
    const cli_moment *moment = &q->source.series.moments[n];
    cli_json_open(j, NULL, '{');
    cli_json_count(j, "step", moment->number);
    cli_json_text(j, "input", cli_shown_path(moment->path));
    if (q->source.series.timed)
        cli_json_number(j, "time", moment->time_s);
    if (*row->why) {
        cli_json_text(j, "left_out", row->why);
        cli_json_close(j, '}');
        return;
    }
    cli_json_count(j, "triangles", row->triangles);
    cli_json_count(j, "components", row->components);
    cli_json_bool(j, "closed", row->closed);
    if (row->closed)
        cli_json_number(j, "volume_mm3", row->volume_mm3);
    cli_json_number(j, "area_mm2", row->area_mm2);
    cli_json_number(j, "seconds", row->seconds);
    cli_json_close(j, '}');
}

void cli_put_series_json(FILE *out, const void *study)
{
    const cli_series_study *q = study;
    cli_json j = {.out = out};
    cli_json_begin(&j, "cubewright-surfaces-1");
    cli_json_number(&j, "iso", q->study.iso);
    cli_json_text(&j, "level", q->study.level);
    cli_json_text(&j, "inside", q->study.inside_is_low ? "below" : "above");
    cli_json_number(&j, "seconds", q->study.seconds);
    cli_json_open(&j, "steps", '[');
    for (size_t n = 0; n < q->source.series.count; n++)
        json_row(&j, q, n);
    cli_json_close(&j, ']');
    cli_json_close(&j, '}');
}
