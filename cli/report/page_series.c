/* The page of a series: a row and a picture for each step, and a plot of what changes. */
#include "cli/framework/quantity.h"
#include "cli/report/page.h"
#include "cli/study/series_study.h"

#include <math.h>
#include <string.h>

enum { WIDTH = 720, HEIGHT = 260, LEFT = 74, RIGHT = 20, TOP = 16, BOTTOM = 46 };

/* Volume where all surfaces are closed, else area. */
static bool has_volumes(const cli_series_study *q)
{
    for (size_t n = 0; n < q->source.series.count; n++)
        if (!*q->rows[n].why && !q->rows[n].closed)
            return false;
    return true;
}

static double value_of(const cli_series_study *q, size_t n, bool volumes)
{
    const cli_series_row *row = &q->rows[n];
    return *row->why ? NAN : volumes ? row->volume_mm3 / 1000 : row->area_mm2 / 100;
}

static void put_intro(FILE *out, const cli_series_study *q)
{
    size_t empty = 0;
    const size_t count = q->source.series.count;
    for (size_t n = 0; n < count; n++)
        empty += *q->rows[n].why != '\0';
    fputs("<h1>", out);
    cli_put_html(out, q->study.title);
    fprintf(out,
            "</h1>\n<p>A series of %zu steps, the surface of each at the level %s (%s%s). ",
            count, cli_number_text(q->study.iso), q->study.level,
            strcmp(q->study.level, "as asked for") == 0 ? "" : ", of the first step");
    if (empty)
        fprintf(out, "%zu have no surface. ", empty);
    fprintf(
        out,
        "%s for all, reading included. Pictures are from the front, all from one place.</p>\n",
        cli_seconds_text(q->study.seconds));
}

static double round_step(double range)
{
    const double power = pow(10, floor(log10(range > 0 ? range : 1))), parts = range / power;
    return power * (parts > 5 ? 2 : parts > 2 ? 1 : 0.5);
}

/* From zero, linear: a series is read by its ratios. */
static void put_plot(FILE *out, const cli_series_study *q)
{
    const size_t count = q->source.series.count;
    const bool volumes = has_volumes(q);
    const char *name = volumes ? "volume, cm\xc2\xb3" : "area, cm\xc2\xb2";
    double highest = 0;
    for (size_t n = 0; n < count; n++)
        highest =
            fmax(highest, isfinite(value_of(q, n, volumes)) ? value_of(q, n, volumes) : 0);
    highest = highest > 0 ? 1.08 * highest : 1;
    fprintf(out,
            "<svg class=\"plot\" viewBox=\"0 0 %d %d\" role=\"group\" aria-label=\"%s of each "
            "step\">",
            WIDTH, HEIGHT, name);
    for (double v = 0; v <= highest; v += round_step(highest)) {
        const double y = HEIGHT - BOTTOM - v / highest * (HEIGHT - BOTTOM - TOP);
        fprintf(out,
                "<line class=\"grid\" x1=\"%d\" x2=\"%d\" y1=\"%.1f\" y2=\"%.1f\"/><text "
                "class=\"tick\" "
                "x=\"%d\" y=\"%.1f\" text-anchor=\"end\">%.4g</text>",
                LEFT, WIDTH - RIGHT, y, y, LEFT - 8, y + 4, v);
    }
    fprintf(out,
            "<text class=\"label\" x=\"%d\" y=\"%d\" text-anchor=\"middle\">step</text><text "
            "class=\"label\" transform=\"translate(16 %d) rotate(-90)\" "
            "text-anchor=\"middle\">%s</text>",
            (LEFT + WIDTH - RIGHT) / 2, HEIGHT - 10, (TOP + HEIGHT - BOTTOM) / 2, name);
    const size_t every = count / 12 + 1;
    for (size_t n = 0; n < count; n++) {
        const double v = value_of(q, n, volumes),
                     x = LEFT + 14 +
                         (count > 1 ? (double)n / (double)(count - 1) : 0.5) *
                             (WIDTH - RIGHT - LEFT - 28);
        const size_t number = q->source.series.moments[n].number;
        if (n % every == 0)
            fprintf(
                out,
                "<text class=\"tick\" x=\"%.1f\" y=\"%d\" text-anchor=\"middle\">%zu</text>", x,
                HEIGHT - BOTTOM + 18, number);
        if (isfinite(v))
            fprintf(out,
                    "<g class=\"dot best g0\" tabindex=\"0\" role=\"img\" "
                    "data-point=\"step-%zu\"><circle cx=\"%.1f\" "
                    "cy=\"%.1f\" r=\"5\"/><title>step %zu: %.5g, %s</title></g>",
                    n, x, HEIGHT - BOTTOM - v / highest * (HEIGHT - BOTTOM - TOP), number, v,
                    name);
    }
    fputs("</svg>\n", out);
}

static void put_row(FILE *out, const cli_series_study *q, size_t n)
{
    const cli_series_row *r = &q->rows[n];
    const cli_moment *moment = &q->source.series.moments[n];
    fprintf(out,
            "<tbody data-point=\"step-%zu\"><tr><td data-v=\"%zu\">%zu</td><td class=\"w\">", n,
            moment->number, moment->number);
    cli_put_html(out, cli_shown_path(moment->path));
    fputs("</td>", out);
    if (q->source.series.timed)
        fprintf(out, "<td data-v=\"%.9g\">%.4g</td>", moment->time_s, moment->time_s);
    if (*r->why) {
        fputs("<td class=\"w wrap\" colspan=\"6\" data-v=\"nan\">", out);
        cli_put_html(out, r->why);
        fputs("</td></tr></tbody>\n", out);
        return;
    }
    if (r->closed)
        fprintf(out, "<td data-v=\"%.9g\">%.5g</td>", r->volume_mm3, r->volume_mm3 / 1000);
    else
        fputs("<td data-v=\"nan\">\xe2\x80\x93</td>", out);
    fprintf(out, "<td data-v=\"%.9g\">%.5g</td><td data-v=\"%zu\">%s</td>", r->area_mm2,
            r->area_mm2 / 100, r->triangles, cli_count(r->triangles));
    fprintf(out,
            "<td data-v=\"%zu\">%s</td><td class=\"w\">%s</td><td "
            "data-v=\"%.9g\">%s</td></tr></tbody>\n",
            r->components, cli_count(r->components), r->closed ? "yes" : "no", r->seconds,
            cli_seconds_text(r->seconds));
}

static void put_rows(FILE *out, const cli_series_study *q)
{
    fputs("<h2>Steps</h2>\n<div class=\"wide\"><table><thead><tr><th>step</th>"
          "<th class=\"w\">file</th>",
          out);
    if (q->source.series.timed)
        fputs("<th>time, s</th>", out);
    fputs("<th>volume,<br/>cm\xc2\xb3</th><th>area,<br/>cm\xc2\xb2</th><th>triangles</th>"
          "<th>components</th><th class=\"w\">closed</th><th>extracted in<br/>(1 run)</th></tr>"
          "</thead>\n",
          out);
    for (size_t n = 0; n < q->source.series.count; n++)
        put_row(out, q, n);
    fputs("</table></div>\n", out);
}

static void put_drawn(FILE *out, const cli_series_study *q)
{
    fputs("<h2>Pictures</h2>\n<div class=\"pictures\">\n", out);
    for (size_t n = 0; n < q->source.series.count; n++) {
        char alt[96];
        const cli_series_row *r = &q->rows[n];
        const size_t number = q->source.series.moments[n].number;
        if (!r->drawn.bytes)
            continue;
        snprintf(alt, sizeof alt, "The surface of step %zu, from the front", number);
        fprintf(out, "<figure data-point=\"step-%zu\">", n);
        cli_put_image(out, &r->drawn, alt);
        fprintf(out,
                "<figcaption><strong>Step %zu</strong>level %s, %s "
                "triangles</figcaption></figure>\n",
                number, cli_number_text(q->study.iso), cli_count(r->triangles));
    }
    fputs("</div>\n", out);
}

void cli_put_series_page(FILE *out, const void *study)
{
    const cli_series_study *q = study;
    cli_put_page_begin(out, q->study.title);
    put_intro(out, q);
    put_plot(out, q);
    put_rows(out, q);
    put_drawn(out, q);
    cli_put_page_end(out);
}
