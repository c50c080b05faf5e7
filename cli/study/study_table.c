/* The points as rows of numbers, and as JSON. */
#include "cli/framework/console.h"
#include "cli/framework/run_config.h"
#include "cli/results/check_verdicts.h"
#include "cli/study/study.h"

#include "core/base/text.h"

#include <math.h>
#include <string.h>

static void put_cell(FILE *out, const char *text)
{
    fputc('"', out);
    for (; *text; text++) {
        if (*text == '"')
            fputc('"', out);
        fputc(*text == '\n' || *text == '\r' ? ' ' : *text, out);
    }
    fputc('"', out);
}

static void put_number(FILE *out, bool known, double value)
{
    fputc(',', out);
    if (known && isfinite(value))
        fprintf(out, "%.17g", value);
}

static void put_gap(FILE *out, const cli_gap *gap)
{
    put_number(out, gap->known, gap->max_mm);
    put_number(out, gap->known, gap->rms_mm);
    put_number(out, gap->known, gap->p99_mm);
}

/* Never with the first letter of somebody else's words: spreadsheets take some for formulas. */
static void put_note(FILE *out, const cli_point *p)
{
    char note[sizeof p->why + 16];
    snprintf(note, sizeof note, "left out: %s", p->why);
    put_cell(out, !p->done ? note : p->aside ? p->aside : "");
}

static void put_row(FILE *out, const cli_study *s, const cli_point *p)
{
    const bool drawn = p->done && cli_is_drawn(p->family), mesh = p->done && !drawn;
    fprintf(out, "%s,", cli_family_names[p->family]);
    put_cell(out, p->name);
    fprintf(out, ",%s,%s", p->done ? "yes" : "no", p->front ? "yes" : "no");
    put_number(out, p->done, p->done ? cli_point_cost(p) : 0);
    put_number(out, p->done, cli_point_error(s, p));
    put_number(out, p->done, p->seconds);
    put_number(out, p->peak_bytes > 0, (double)p->peak_bytes);
    put_number(out, mesh, (double)p->triangles);
    put_number(out, mesh, (double)p->file_bytes);
    put_gap(out, &p->to_field);
    put_gap(out, &p->back);
    put_gap(out, &p->truth);
    put_number(out, drawn, p->picture.rmse);
    put_number(out, drawn, p->picture.max);
    put_number(out, drawn, p->picture.delta_e_mean);
    put_number(out, drawn, p->picture.delta_e_p99);
    fputc(',', out);
    put_note(out, p);
    fputc(',', out);
    put_cell(out, p->command);
    fputc(',', out);
    put_cell(out, p->group);
    put_number(out, p->done, (double)p->runs);
    fputs("\r\n", out);
}

void cli_put_study_csv(FILE *out, const void *study)
{
    const cli_study *s = study;
    fputs("family,setting,done,front,cost,error,seconds,peak_bytes,triangles,file_bytes,"
          "field_max_mm,field_rms_mm,field_p99_mm,back_max_mm,back_rms_mm,back_p99_mm,"
          "truth_max_mm,truth_rms_mm,truth_p99_mm,picture_rmse,picture_max,delta_e_mean,"
          "delta_e_p99,note,command,group,runs\r\n",
          out);
    for (size_t n = 0; n < s->point_count; n++)
        put_row(out, s, &s->points[n]);
}

static void json_gap(cli_json *j, const char *key, const cli_gap *gap)
{
    if (!gap->known)
        return;
    cli_json_open(j, key, '{');
    cli_json_number(j, "max_mm", gap->max_mm);
    cli_json_number(j, "rms_mm", gap->rms_mm);
    cli_json_number(j, "p99_mm", gap->p99_mm);
    cli_json_close(j, '}');
}

static void json_counts(cli_json *j, const char *key, const size_t *counts, size_t count)
{
    cli_json_open(j, key, '[');
    for (size_t n = 0; n < count; n++)
        cli_json_count(j, NULL, counts[n]);
    cli_json_close(j, ']');
}

static void json_mesh(cli_json *j, const cli_point *p)
{
    cli_json_count(j, "triangles", p->triangles);
    cli_json_count(j, "file_bytes", p->file_bytes);
    cli_json_count(j, "measured_one_of", p->measured_one_of);
    json_gap(j, "to_field", &p->to_field);
    json_gap(j, "back", &p->back);
    json_gap(j, "truth", &p->truth);
    if (!p->shown)
        return;
    cli_json_open(j, "shapes", '{');
    cli_json_number(j, "min_angle_deg", p->shapes.min_angle_deg);
    cli_json_number(j, "max_angle_deg", p->shapes.max_angle_deg);
    cli_json_number(j, "max_aspect", p->shapes.max_aspect);
    json_counts(j, "smallest_angles", p->shapes.smallest, CW_ANGLE_BINS);
    json_counts(j, "aspects", p->shapes.aspects, CW_ASPECT_BINS);
    cli_json_close(j, '}');
}

static void json_picture(cli_json *j, const cw_comparison *c)
{
    cli_json_number(j, "rmse", c->rmse);
    cli_json_number(j, "max", c->max);
    cli_json_number(j, "delta_e_mean", c->delta_e_mean);
    cli_json_number(j, "delta_e_p99", c->delta_e_p99);
    cli_json_number(j, "ssim", c->ssim);
}

static void json_point(cli_json *j, const cli_study *s, const cli_point *p)
{
    cli_json_open(j, NULL, '{');
    cli_json_text(j, "setting", p->name);
    cli_json_text(j, "command", p->command);
    cli_json_bool(j, "done", p->done);
    if (!p->done) {
        cli_json_text(j, "left_out", p->why);
        cli_json_close(j, '}');
        return;
    }
    cli_json_bool(j, "front", p->front);
    if (p->aside)
        cli_json_text(j, "aside", p->aside);
    cli_json_number(j, "cost", cli_point_cost(p));
    cli_json_number(j, "error", cli_point_error(s, p));
    cli_json_number(j, "seconds", p->seconds);
    cli_json_numbers(j, "runs", p->times, p->runs);
    if (p->peak_bytes)
        cli_json_count(j, "peak_bytes", p->peak_bytes);
    if (cli_is_drawn(p->family))
        json_picture(j, &p->picture);
    else
        json_mesh(j, p);
    cli_json_close(j, '}');
}

static void json_family(cli_json *j, const cli_study *s, cli_family family)
{
    const cli_axis axis = cli_study_axis(s, family);
    cli_json_open(j, NULL, '{');
    cli_json_text(j, "family", cli_family_names[family]);
    cli_json_text(j, "cost", axis.cost);
    cli_json_text(j, "cost_unit", axis.cost_unit);
    cli_json_text(j, "error", axis.error);
    cli_json_text(j, "error_unit", axis.error_unit);
    cli_json_open(j, "points", '[');
    for (size_t n = 0; n < s->point_count; n++)
        if (s->points[n].family == family)
            json_point(j, s, &s->points[n]);
    cli_json_close(j, ']');
    cli_json_close(j, '}');
}

static void json_advice(cli_json *j, const cli_study *s)
{
    cli_advice advice[CLI_MAX_ADVICE];
    const size_t count = cli_find_advice(s, advice);
    cli_json_open(j, "advice", '[');
    for (size_t n = 0; n < count; n++) {
        cli_json_open(j, NULL, '{');
        cli_json_text(j, "purpose", advice[n].purpose);
        cli_json_text(j, "setting", advice[n].point->name);
        cli_json_text(j, "why", advice[n].why);
        cli_json_text(j, "command", advice[n].command ? advice[n].command : "");
        cli_json_close(j, '}');
    }
    cli_json_close(j, ']');
    cli_free_advice(advice, count);
}

void cli_put_study_json(FILE *out, const void *study)
{
    const cli_study *s = study;
    cli_json j = {.out = out};
    cli_json_begin(&j, "cubewright-study-1");
    cli_json_input(&j, "input", s->volume);
    if (s->is_field)
        cli_json_text(&j, "field", cw_field_name(s->field));
    if (s->make_words)
        cli_json_text(&j, "make", s->make_words);
    cli_json_number(&j, "iso", s->iso);
    cli_json_text(&j, "level", s->level);
    cli_json_text(&j, "inside", s->inside_is_low ? "below" : "above");
    cli_json_count(&j, "coarsen", s->coarsen);
    if (*s->part_words)
        cli_json_text(&j, "part", s->part_words + 1);
    cli_json_number(&j, "voxel_mm", s->voxel_mm);
    cli_json_text(&j, "backend", s->backend);
    cli_json_number(&j, "budget_seconds", s->budget_s);
    cli_json_number(&j, "seconds", s->seconds);
    if (s->references[0].seconds > 0)
        cli_json_number(&j, "reference_seconds", s->references[0].seconds);
    json_advice(&j, s);
    cli_json_open(&j, "families", '[');
    for (int f = 0; f < CLI_FAMILY_COUNT; f++)
        json_family(&j, s, (cli_family)f);
    cli_json_close(&j, ']');
    cli_json_open(&j, "as_print", '{');
    if (*s->print.why)
        cli_json_text(&j, "left_out", s->print.why);
    else
        cli_json_verdicts(&j, s->print.seen.verdicts, s->print.seen.count);
    if (s->print.seen.facts.area_mm2 > 0)
        cli_json_print(&j, &s->print.seen.facts);
    cli_json_close(&j, '}');
    cli_json_close(&j, '}');
}
