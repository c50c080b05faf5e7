/* Prints the verdicts, shapes and errors of the command check as text, and writes them as
 * JSON. */
#include "cli/results/check_verdicts.h"

#include "cli/framework/console.h"
#include "cli/framework/field_names.h"
#include "cli/framework/quantity.h"
#include "core/base/status.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

void cli_print_verdicts(const cw_verdict *verdicts, size_t count)
{
    for (const cw_verdict *v = verdicts; v < verdicts + count; v++) {
        const char *grade = v->grade == CW_GRADE_FAIL ? "FAIL" : cw_grade_name(v->grade);
        cli_result("  %-8s%-19s%s\n", grade, v->name,
                   cli_name_options(v->text, (char[CLI_MESSAGE]){0}));
        if (v->advice && v->grade < CW_GRADE_OK)
            cli_result("  %-8s%-19s-> %s\n", "", "",
                       cli_name_options(v->advice, (char[CLI_MESSAGE]){0}));
    }
}

cw_status cli_check_verdicts(const char *name, const char *profile, const cw_verdict *verdicts,
                             size_t count, cw_error *err)
{
    char names[256] = "";
    if (cw_check_holds(verdicts, count))
        return CW_OK;
    for (const cw_verdict *v = verdicts; v < verdicts + count; v++)
        if (v->grade == CW_GRADE_FAIL || v->grade == CW_GRADE_UNKNOWN) {
            const size_t used = strlen(names);
            snprintf(names + used, sizeof names - used, "%s%s", used ? ", " : "", v->name);
        }
    return cwi_fail(err, CW_ERR_CHECK, "%s: does not meet profile %s: %s", name, profile,
                    names);
}

static void print_bar(const char *label, size_t count, size_t total)
{
    enum { WIDTH = 40 };
    static const char bar[WIDTH + 1] = "########################################";
    const double fraction = total ? (double)count / (double)total : 0;
    cli_result("    %-20s%5.1f %%  %.*s\n", label, 100 * fraction, (int)ceil(WIDTH * fraction),
               bar);
}

static size_t sum_bins(const size_t *bins, size_t count)
{
    size_t total = 0;
    for (size_t n = 0; n < count; n++)
        total += bins[n];
    return total;
}

static double length_at(const cw_shapes *s, size_t bin)
{
    return s->min_edge_mm * pow(s->max_edge_mm / s->min_edge_mm, (double)bin / CW_LENGTH_BINS);
}

void cli_print_shapes(const cw_shapes *s)
{
    char label[64];
    cli_result("  angles, degrees\n");
    for (size_t n = 0; n < CW_ANGLE_BINS; n++) {
        snprintf(label, sizeof label, "%zu to %zu", 10 * n, 10 * n + 10);
        print_bar(label, s->angles[n], sum_bins(s->angles, CW_ANGLE_BINS));
    }
    cli_result("  aspect ratio\n");
    for (size_t n = 0; n < CW_ASPECT_BINS; n++) {
        snprintf(label, sizeof label, n + 1 < CW_ASPECT_BINS ? "up to %g" : "beyond %g",
                 cw_aspect_ends[n + 1 < CW_ASPECT_BINS ? n : n - 1]);
        print_bar(label, s->aspects[n], sum_bins(s->aspects, CW_ASPECT_BINS));
    }
    cli_result("  edges, mm\n");
    for (size_t n = 0; n < CW_LENGTH_BINS; n++) {
        snprintf(label, sizeof label, "%.3g to %.3g", length_at(s, n), length_at(s, n + 1));
        print_bar(label, s->lengths[n], sum_bins(s->lengths, CW_LENGTH_BINS));
    }
}

void cli_json_verdicts(cli_json *j, const cw_verdict *verdicts, size_t count)
{
    cli_json_open(j, "verdicts", '[');
    for (const cw_verdict *v = verdicts; v < verdicts + count; v++) {
        cli_json_open(j, NULL, '{');
        cli_json_text(j, "name", v->name);
        cli_json_text(j, "grade", cw_grade_name(v->grade));
        cli_json_number(j, "number", v->number);
        cli_json_text(j, "text", v->text);
        if (v->advice)
            cli_json_message(j, "advice", v->advice);
        cli_json_close(j, '}');
    }
    cli_json_close(j, ']');
}

static void put_bins(cli_json *j, const char *key, const size_t *bins, size_t count)
{
    cli_json_open(j, key, '[');
    for (size_t n = 0; n < count; n++)
        cli_json_count(j, NULL, bins[n]);
    cli_json_close(j, ']');
}

void cli_json_shapes(cli_json *j, const cw_shapes *s)
{
    cli_json_open(j, "quality", '{');
    cli_json_number(j, "min_angle", s->min_angle_deg);
    cli_json_number(j, "max_angle", s->max_angle_deg);
    cli_json_number(j, "max_aspect", s->max_aspect);
    cli_json_number(j, "min_edge", s->min_edge_mm);
    cli_json_number(j, "max_edge", s->max_edge_mm);
    put_bins(j, "angle_histogram", s->angles, CW_ANGLE_BINS);
    put_bins(j, "min_angle_histogram", s->smallest, CW_ANGLE_BINS);
    cli_json_numbers(j, "aspect_ends", cw_aspect_ends, CW_ASPECT_BINS - 1);
    put_bins(j, "aspect_histogram", s->aspects, CW_ASPECT_BINS);
    put_bins(j, "edge_histogram", s->lengths, CW_LENGTH_BINS);
    cli_json_close(j, '}');
}

static void put_distance(cli_json *j, const cw_distance *d)
{
    cli_json_number(j, "max", d->max_mm);
    cli_json_number(j, "rms", d->rms_mm);
    cli_json_number(j, "mean", d->mean_mm);
    cli_json_number(j, "p99", d->p99_mm);
    cli_json_number(j, "bias", d->bias_mm);
    cli_json_number(j, "bound", d->bound_mm);
    cli_json_numbers(j, "where", d->where, 3);
    cli_json_count(j, "samples", d->samples);
    cli_json_count(j, "missed", d->missed);
    cli_json_text(j, "unit", "mm");
}

static void put_error(cli_json *j, const char *to, const cw_distance *there,
                      const cw_distance *back)
{
    if (!there)
        return;
    cli_json_open(j, NULL, '{');
    cli_json_text(j, "to", to);
    put_distance(j, there);
    cli_json_count(j, "triangle", there->triangle);
    if (back) {
        cli_json_open(j, "back", '{');
        put_distance(j, back);
        cli_json_close(j, '}');
    }
    cli_json_close(j, '}');
}

void cli_json_errors(cli_json *j, const cw_findings *f)
{
    cli_json_open(j, "error", '[');
    put_error(j, "field", f->to_field, f->from_field);
    put_error(j, "mesh", f->to_reference, f->from_reference);
    cli_json_close(j, ']');
}
