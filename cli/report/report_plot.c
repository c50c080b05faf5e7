/* Plots as SVG: cost to the right, error upwards, both by their logarithm; and bars. */
#include "cli/framework/quantity.h"
#include "cli/report/study.h"

#include <math.h>
#include <string.h>

enum {
    WIDTH = 720,
    HEIGHT = 400,
    LEFT = 74,
    RIGHT = 20,
    TOP = 16,
    BOTTOM = 52,
    MAX_GROUPS = 8
};

typedef struct scale {
    double low, high; /* logarithms */
    double from, to;  /* where those are */
} scale;

typedef struct dot {
    const cli_point *point;
    double x, y;
} dot;

static double place_value(const scale *s, double value)
{
    return s->from + (log10(value) - s->low) / (s->high - s->low) * (s->to - s->from);
}

/* Room for all values, and a third of a decade at least. */
static scale fit_scale(const double *values, size_t count, double from, double to)
{
    double low = INFINITY, high = -INFINITY;
    for (size_t n = 0; n < count; n++) {
        low = fmin(low, log10(values[n]));
        high = fmax(high, log10(values[n]));
    }
    const double margin = fmax(0.06 * (high - low), high - low < 0.3 ? 0.2 : 0);
    return (scale){low - margin, high + margin, from, to};
}

/* Replaces zeros, which have no logarithm, by a tenth of the smallest positive value. */
static void lift_zeros(double *values, size_t count)
{
    double least = INFINITY;
    for (size_t n = 0; n < count; n++)
        if (values[n] > 0)
            least = fmin(least, values[n]);
    for (size_t n = 0; n < count; n++)
        if (!(values[n] > 0))
            values[n] = isfinite(least) ? least / 10 : 1;
}

static const char *tick_text(double value, const char *unit)
{
    static char text[32];
    static const char letters[] = " kMG";
    int letter = 0;
    if (strcmp(unit, "bytes") == 0 || *unit == '\0')
        for (; value >= 1000 && letter < 3; letter++)
            value /= 1000;
    snprintf(text, sizeof text, "%.6g%.*s", value, letter > 0, letters + letter);
    return text;
}

static void put_tick(FILE *out, const scale *s, bool upright, double value, const char *unit)
{
    const double at = place_value(s, value);
    if (upright)
        fprintf(out,
                "<line class=\"grid\" x1=\"%d\" x2=\"%d\" y1=\"%.1f\" y2=\"%.1f\"/>"
                "<text class=\"tick\" x=\"%d\" y=\"%.1f\" text-anchor=\"end\">%s</text>",
                LEFT, WIDTH - RIGHT, at, at, LEFT - 8, at + 4, tick_text(value, unit));
    else
        fprintf(out,
                "<line class=\"grid\" x1=\"%.1f\" x2=\"%.1f\" y1=\"%d\" y2=\"%d\"/>"
                "<text class=\"tick\" x=\"%.1f\" y=\"%d\" text-anchor=\"middle\">%s</text>",
                at, at, TOP, HEIGHT - BOTTOM, at, HEIGHT - BOTTOM + 18, tick_text(value, unit));
}

/* 1, 2 and 5 of each decade; over many decades the ones alone. */
static void put_ticks(FILE *out, const scale *s, bool upright, const char *unit)
{
    static const double parts[] = {1, 2, 5};
    const bool all = s->high - s->low < 2.5;
    for (int decade = (int)floor(s->low); decade <= (int)ceil(s->high); decade++)
        for (size_t n = 0; n < (all ? 3 : 1); n++) {
            const double value = parts[n] * pow(10, decade), at = log10(value);
            if (at >= s->low && at <= s->high)
                put_tick(out, s, upright, value, unit);
        }
}

static void put_labels(FILE *out, const cli_axis *axis)
{
    fprintf(out, "<text class=\"label\" x=\"%d\" y=\"%d\" text-anchor=\"middle\">%s%s%s</text>",
            (LEFT + WIDTH - RIGHT) / 2, HEIGHT - 10, axis->cost, *axis->cost_unit ? ", " : "",
            axis->cost_unit);
    fprintf(out,
            "<text class=\"label\" transform=\"translate(16 %d) rotate(-90)\" "
            "text-anchor=\"middle\">%s, %s</text>",
            (TOP + HEIGHT - BOTTOM) / 2, axis->error, axis->error_unit);
}

size_t cli_family_groups(const cli_study *s, cli_family family, const char **groups,
                         size_t most)
{
    size_t count = 0;
    for (size_t n = 0; n < s->point_count; n++) {
        const cli_point *p = &s->points[n];
        bool known = p->family != family || !p->done;
        for (size_t g = 0; g < count && !known; g++)
            known = strcmp(groups[g], p->group) == 0;
        if (!known && count < most)
            groups[count++] = p->group;
    }
    return count;
}

static size_t group_of(const char *const *groups, size_t count, const char *group)
{
    size_t n = 0;
    while (n + 1 < count && strcmp(groups[n], group) != 0)
        n++;
    return n;
}

size_t cli_point_number(const cli_study *s, const cli_point *point)
{
    size_t number = 1;
    for (const cli_point *p = s->points; p < point; p++)
        number += p->family == point->family;
    return number;
}

static void put_front(FILE *out, dot *dots, size_t count)
{
    bool drawn[CLI_MAX_POINTS] = {false};
    const char *separator = "";
    fputs("<polyline class=\"front\" points=\"", out);
    for (size_t turn = 0; turn < count; turn++) {
        size_t next = count;
        for (size_t n = 0; n < count; n++)
            if (dots[n].point->front && !drawn[n] &&
                (next == count || dots[n].x < dots[next].x))
                next = n;
        if (next == count)
            break;
        drawn[next] = true;
        fprintf(out, "%s%.1f,%.1f", separator, dots[next].x, dots[next].y);
        separator = " ";
    }
    fputs("\"/>", out);
}

static void put_dot(FILE *out, const cli_study *s, const dot *d, const cli_axis *axis,
                    size_t group)
{
    const cli_point *p = d->point;
    fprintf(out,
            "<g class=\"dot%s g%zu\" tabindex=\"0\"><circle cx=\"%.1f\" cy=\"%.1f\" r=\"%g\"/>"
            "<text x=\"%.1f\" y=\"%.1f\">%zu</text><title>",
            p->front ? " best" : "", group, d->x, d->y, p->front ? 6.0 : 5.0, d->x + 9,
            d->y - 6, cli_point_number(s, p));
    cli_put_html(out, p->name);
    fprintf(out, "\n%s: %.4g %s\n%s: %.4g %s%s</title></g>", axis->cost, cli_point_cost(p),
            axis->cost_unit, axis->error, cli_point_error(s, p), axis->error_unit,
            p->front ? "\non the front: nothing is both cheaper and closer" : "");
}

static size_t collect_dots(const cli_study *s, cli_family family, dot *dots, double *cost,
                           double *error)
{
    size_t count = 0;
    for (size_t n = 0; n < s->point_count; n++) {
        const cli_point *p = &s->points[n];
        if (p->family != family || !p->done || p->aside || !isfinite(cli_point_error(s, p)))
            continue;
        dots[count].point = p;
        cost[count] = cli_point_cost(p);
        error[count++] = cli_point_error(s, p);
    }
    return count;
}

void cli_put_plot(FILE *out, const cli_study *s, cli_family family)
{
    dot dots[CLI_MAX_POINTS];
    double cost[CLI_MAX_POINTS], error[CLI_MAX_POINTS];
    const char *groups[MAX_GROUPS];
    const cli_axis axis = cli_study_axis(s, family);
    const size_t count = collect_dots(s, family, dots, cost, error),
                 group_count = cli_family_groups(s, family, groups, MAX_GROUPS);
    if (!count) {
        fputs("<p class=\"quiet\">Nothing was measured that could be drawn.</p>", out);
        return;
    }
    lift_zeros(cost, count);
    lift_zeros(error, count);
    const scale x = fit_scale(cost, count, LEFT, WIDTH - RIGHT),
                y = fit_scale(error, count, HEIGHT - BOTTOM, TOP);
    fprintf(out, "<svg class=\"plot\" viewBox=\"0 0 %d %d\" role=\"img\"><title>", WIDTH,
            HEIGHT);
    fprintf(out, "%s: %s against %s</title>", cli_family_names[family], axis.error, axis.cost);
    put_ticks(out, &x, false, axis.cost_unit);
    put_ticks(out, &y, true, axis.error_unit);
    put_labels(out, &axis);
    for (size_t n = 0; n < count; n++) {
        dots[n].x = place_value(&x, cost[n]);
        dots[n].y = place_value(&y, error[n]);
    }
    put_front(out, dots, count);
    for (int best = 0; best < 2; best++) /* those of the front above all others */
        for (size_t n = 0; n < count; n++)
            if (dots[n].point->front == best)
                put_dot(out, s, &dots[n], &axis,
                        group_of(groups, group_count, dots[n].point->group));
    fputs("</svg>\n", out);
}

/* Bars of shares; the axis below says where bins begin and end. */
static void put_bars(FILE *out, const char *title, const size_t *counts, size_t bins,
                     const char *const *ends)
{
    enum { W = 300, H = 120, BASE = 92 };
    size_t sum = 0, most = 1;
    for (size_t n = 0; n < bins; n++) {
        sum += counts[n];
        most = counts[n] > most ? counts[n] : most;
    }
    const double width = (double)W / (double)bins;
    fprintf(out, "<svg class=\"bars\" viewBox=\"0 0 %d %d\" role=\"img\"><title>%s</title>", W,
            H, title);
    for (size_t n = 0; n < bins; n++) {
        const double height = (double)(BASE - 4) * (double)counts[n] / (double)most;
        fprintf(out,
                "<rect x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\"><title>%s to %s: "
                "%.2f %% (%s)</title></rect>",
                (double)n * width + 1, BASE - height, width - 2, height, ends[n], ends[n + 1],
                sum ? 100 * (double)counts[n] / (double)sum : 0, cli_count(counts[n]));
    }
    fprintf(out, "<line class=\"base\" x1=\"0\" x2=\"%d\" y1=\"%d\" y2=\"%d\"/>", W, BASE,
            BASE);
    for (size_t n = 0; n <= bins; n += bins > 10 ? 6 : 1)
        fprintf(out, "<text class=\"tick\" x=\"%.1f\" y=\"%d\" text-anchor=\"%s\">%s</text>",
                (double)n * width, BASE + 15,
                n == 0      ? "start"
                : n == bins ? "end"
                            : "middle",
                ends[n]);
    fprintf(out, "<text class=\"label\" x=\"0\" y=\"%d\">%s</text></svg>", H - 1, title);
}

void cli_put_shapes(FILE *out, const cw_shapes *shapes)
{
    char text[2][CW_ANGLE_BINS + 1][16];
    const char *angles[CW_ANGLE_BINS + 1], *aspects[CW_ASPECT_BINS + 1];
    for (int n = 0; n <= CW_ANGLE_BINS; n++) {
        snprintf(text[0][n], sizeof text[0][n], "%.3g", n * 60.0 / CW_ANGLE_BINS);
        angles[n] = text[0][n];
    }
    for (int n = 0; n <= CW_ASPECT_BINS; n++) {
        if (n == 0 || n == CW_ASPECT_BINS)
            snprintf(text[1][n], sizeof text[1][n], "%s", n ? "\xe2\x88\x9e" : "1");
        else
            snprintf(text[1][n], sizeof text[1][n], "%g", cw_aspect_ends[n - 1]);
        aspects[n] = text[1][n];
    }
    put_bars(out, "smallest angle of each triangle, degrees", shapes->smallest, CW_ANGLE_BINS,
             angles);
    put_bars(out, "aspect ratio (1: equal sides)", shapes->aspects, CW_ASPECT_BINS, aspects);
}
