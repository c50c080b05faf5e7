/* Plots as SVG: cost to the right, error upwards, both by their logarithm. */
#include "cli/framework/quantity.h"
#include "cli/report/page.h"

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
    bool best;             /* on the front of this cost */
    double text_x, text_y; /* the middle of its number */
} dot;

typedef struct plot {
    const cli_study *study;
    cli_family family;
    cli_cost cost;
    cli_axis axis;
    dot dots[CLI_MAX_POINTS];
    size_t count;
} plot;

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
    double min = INFINITY;
    for (size_t n = 0; n < count; n++)
        if (values[n] > 0)
            min = fmin(min, values[n]);
    for (size_t n = 0; n < count; n++)
        if (!(values[n] > 0))
            values[n] = isfinite(min) ? min / 10 : 1;
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

/* Parts of a decade that may have ticks, from few to many. */
static const struct {
    size_t count;
    double parts[10];
} divisions[] = {{1, {1}},
                 {2, {1, 3}},
                 {3, {1, 2, 5}},
                 {6, {1, 1.5, 2, 3, 5, 7}},
                 {10, {1, 1.2, 1.5, 2, 2.5, 3, 4, 5, 6, 8}}};

static size_t count_ticks(const scale *s, size_t division)
{
    size_t count = 0;
    for (int decade = (int)floor(s->low); decade <= (int)ceil(s->high); decade++)
        for (size_t n = 0; n < divisions[division].count; n++) {
            const double at = log10(divisions[division].parts[n]) + decade;
            count += at >= s->low && at <= s->high;
        }
    return count;
}

/* As few as there can be, but four. Of many decades each second one, or fewer, has a tick. */
static void put_ticks(FILE *out, const scale *s, bool upright, const char *unit)
{
    enum { ENOUGH = 4, DIVISIONS = sizeof divisions / sizeof *divisions, MANY = 9 };
    size_t division = 0;
    while (division + 1 < DIVISIONS && count_ticks(s, division) < ENOUGH)
        division++;
    const int every = 1 + (int)count_ticks(s, 0) / MANY;
    for (int decade = (int)floor(s->low); decade <= (int)ceil(s->high); decade++)
        for (size_t n = 0; n < divisions[division].count; n++) {
            const double value = divisions[division].parts[n] * pow(10, decade),
                         at = log10(value);
            if (at >= s->low && at <= s->high && decade % every == 0)
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

size_t cli_family_groups(const cli_study *s, cli_family family, const char **groups, size_t max)
{
    size_t count = 0;
    for (size_t n = 0; n < s->point_count; n++) {
        const cli_point *p = &s->points[n];
        bool known = p->family != family || !p->done;
        for (size_t g = 0; g < count && !known; g++)
            known = strcmp(groups[g], p->group) == 0;
        if (!known && count < max)
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

/* Whether two boxes of a size overlap, by their middles. */
static bool labels_overlap(double x, double y, double other_x, double other_y, double width,
                           double height)
{
    return fabs(x - other_x) < width && fabs(y - other_y) < height;
}

/* How much a number at a place would hide, or be hidden by: numbers before it, dots, the
 * frame. */
static int count_collisions(const plot *p, size_t before, double x, double y)
{
    enum { TEXT_WIDTH = 17, TEXT_HEIGHT = 13, DOT_WIDTH = 15, DOT_HEIGHT = 13 };
    int count = 0;
    for (size_t n = 0; n < p->count; n++)
        count += labels_overlap(x, y, p->dots[n].x, p->dots[n].y, DOT_WIDTH, DOT_HEIGHT);
    for (size_t n = 0; n < before; n++)
        count += 2 * labels_overlap(x, y, p->dots[n].text_x, p->dots[n].text_y, TEXT_WIDTH,
                                    TEXT_HEIGHT);
    return count + 3 * (x < LEFT + 8 || x > WIDTH - RIGHT - 4 || y < TOP + 4 ||
                        y > HEIGHT - BOTTOM - 4);
}

/* Numbers stand around their dots, in the first of these places with the fewest collisions. */
static void place_numbers(plot *p)
{
    static const double offsets[][2] = {
        {13, -9},  {-13, -9},  {13, 10}, {-13, 10}, {0, -14},  {0, 15},    {17, 0},  {-17, 0},
        {24, -12}, {-24, -12}, {24, 14}, {-24, 14}, {10, -24}, {-10, -24}, {10, 25}, {-10, 25}};
    for (size_t n = 0; n < p->count; n++) {
        dot *d = &p->dots[n];
        int min = -1;
        for (size_t at = 0; at < sizeof offsets / sizeof *offsets; at++) {
            const double x = d->x + offsets[at][0], y = d->y + offsets[at][1];
            const int hits = count_collisions(p, n, x, y);
            if (min >= 0 && hits >= min)
                continue;
            min = hits;
            d->text_x = x;
            d->text_y = y;
        }
    }
}

/* A line through the dots of the front; projections have a front for each mode. */
static void put_front(FILE *out, const plot *p, size_t reference)
{
    bool drawn[CLI_MAX_POINTS] = {false};
    size_t count = 0;
    for (size_t turn = 0; turn < p->count; turn++) {
        size_t next = p->count;
        for (size_t n = 0; n < p->count; n++)
            if (p->dots[n].best && !drawn[n] &&
                p->dots[n].point->tried.reference == reference &&
                (next == p->count || p->dots[n].x < p->dots[next].x))
                next = n;
        if (next == p->count)
            break;
        drawn[next] = true;
        fprintf(out, "%s%.1f,%.1f", count++ ? " " : "<polyline class=\"front\" points=\"",
                p->dots[next].x, p->dots[next].y);
    }
    if (count)
        fputs("\"/>", out);
}

/* A line from a number to its dot, where it is not beside it. */
static void put_leader(FILE *out, const dot *d)
{
    if (hypot(d->text_x - d->x, d->text_y - d->y) > 20)
        fprintf(out, "<line class=\"grid\" x1=\"%.1f\" y1=\"%.1f\" x2=\"%.1f\" y2=\"%.1f\"/>",
                d->x, d->y, d->text_x, d->text_y);
}

static void put_dot(FILE *out, const plot *p, const dot *d, double cost, size_t group)
{
    const cli_point *point = d->point;
    const cli_axis *axis = &p->axis;
    put_leader(out, d);
    fprintf(
        out,
        "<g class=\"dot%s g%zu\" tabindex=\"0\" role=\"img\" data-point=\"%s-%zu\"><circle "
        "cx=\"%.1f\" "
        "cy=\"%.1f\" r=\"%g\"/><text x=\"%.1f\" y=\"%.1f\" text-anchor=\"middle\">%zu</text>"
        "<title>",
        d->best ? " best" : "", group, cli_family_names[p->family], point->number, d->x, d->y,
        d->best ? 6.0 : 5.0, d->text_x, d->text_y + 4, point->number);
    cli_put_html(out, point->name);
    fprintf(out, "\n%s: %.4g %s\n%s: %.4g %s%s</title></g>", axis->cost, cost, axis->cost_unit,
            axis->error, cli_point_error(p->study, point), axis->error_unit,
            d->best ? "\non the front: nothing is both cheaper and closer" : "");
}

/* Fronts of this cost, which may not be the main one. */
static void mark_best(plot *p, const double *cost, const double *error)
{
    for (size_t r = 0; r < CLI_REFERENCES; r++) {
        double costs[CLI_MAX_POINTS];
        bool front[CLI_MAX_POINTS];
        for (size_t n = 0; n < p->count; n++)
            costs[n] = p->dots[n].point->tried.reference == r ? cost[n] : NAN;
        cli_pareto(costs, error, p->count, front);
        for (size_t n = 0; n < p->count; n++)
            p->dots[n].best |= front[n];
    }
}

static void collect_dots(plot *p, double *cost, double *error)
{
    const cli_point *points[CLI_MAX_POINTS];
    const size_t count = cli_points_of(p->study, p->family, points);
    for (size_t n = 0; n < count; n++) {
        if (points[n]->aside || !isfinite(cli_point_error(p->study, points[n])) ||
            !isfinite(cli_cost_of(points[n], p->cost)))
            continue;
        p->dots[p->count].point = points[n];
        cost[p->count] = cli_cost_of(points[n], p->cost);
        error[p->count++] = cli_point_error(p->study, points[n]);
    }
}

static const struct {
    const char *name, *unit;
} costs[CLI_COST_COUNT] = {
    {"time", "s"}, {"triangles", ""}, {"size of the file", "bytes"}, {"memory", "bytes"}};

static void put_dots(FILE *out, const plot *p, const double *cost)
{
    const char *groups[MAX_GROUPS];
    const size_t count = cli_family_groups(p->study, p->family, groups, MAX_GROUPS);
    for (int best = 0; best < 2; best++) /* those of the front above all others */
        for (size_t n = 0; n < p->count; n++)
            if (p->dots[n].best == best)
                put_dot(out, p, &p->dots[n], cost[n],
                        group_of(groups, count, p->dots[n].point->group));
}

/* Returns whether anything was drawn. */
static bool put_plot(FILE *out, const cli_study *s, cli_family family, cli_cost kind,
                     bool hidden)
{
    double cost[CLI_MAX_POINTS], told[CLI_MAX_POINTS], error[CLI_MAX_POINTS];
    plot p = {.study = s, .family = family, .cost = kind, .axis = cli_study_axis(s, family)};
    collect_dots(&p, cost, error);
    if (!p.count)
        return false;
    if (!cli_is_drawn(family)) {
        p.axis.cost = costs[kind].name;
        p.axis.cost_unit = costs[kind].unit;
    }
    mark_best(&p, cost, error);
    memcpy(told, cost, sizeof told);
    lift_zeros(cost, p.count);
    lift_zeros(error, p.count);
    const scale x = fit_scale(cost, p.count, LEFT, WIDTH - RIGHT),
                y = fit_scale(error, p.count, HEIGHT - BOTTOM, TOP);
    fprintf(out,
            "<svg class=\"plot\" data-cost=\"%d\"%s viewBox=\"0 0 %d %d\" role=\"group\" "
            "aria-label=\"%s: %s against %s\">",
            (int)kind, hidden ? " hidden=\"\"" : "", WIDTH, HEIGHT, cli_family_names[family],
            p.axis.error, p.axis.cost);
    put_ticks(out, &x, false, p.axis.cost_unit);
    put_ticks(out, &y, true, p.axis.error_unit);
    put_labels(out, &p.axis);
    for (size_t n = 0; n < p.count; n++) {
        p.dots[n].x = place_value(&x, cost[n]);
        p.dots[n].y = place_value(&y, error[n]);
    }
    place_numbers(&p);
    for (size_t r = 0; r < CLI_REFERENCES; r++)
        put_front(out, &p, r);
    put_dots(out, &p, told);
    fputs("</svg>\n", out);
    return true;
}

/* All plots are in the page; the choice, which the script shows, is between them. */
void cli_put_plots(FILE *out, const cli_study *s, cli_family family)
{
    const cli_cost main = cli_main_cost(family);
    fputs("<div class=\"plots\">", out);
    if (!cli_is_drawn(family)) {
        fputs("<label hidden=\"\">Plot the error against <select>", out);
        for (int c = 0; c < CLI_COST_COUNT; c++)
            fprintf(out, "<option value=\"%d\"%s>%s</option>", c,
                    c == (int)main ? " selected=\"\"" : "", costs[c].name);
        fputs("</select></label>\n", out);
    }
    bool any = put_plot(out, s, family, main, false);
    for (int c = 0; c < CLI_COST_COUNT && !cli_is_drawn(family); c++)
        if (c != (int)main)
            any |= put_plot(out, s, family, (cli_cost)c, true);
    if (!any)
        fputs("<p class=\"quiet\">Nothing was measured that could be drawn.</p>", out);
    fputs("</div>\n", out);
}
