/* Histograms as SVG: shapes of triangles, and values of a volume. */
#include "cli/framework/quantity.h"
#include "cli/report/page.h"

#include <math.h>
#include <stdio.h>

enum { WIDTH = 300, HEIGHT = 120, BASE = 92 };

/* Bars of shares; the axis below says where bins begin and end. */
static void put_bars(FILE *out, const char *title, const size_t *counts, size_t bins,
                     const char *const *ends)
{
    size_t sum = 0, max = 1;
    for (size_t n = 0; n < bins; n++) {
        sum += counts[n];
        max = counts[n] > max ? counts[n] : max;
    }
    const double width = (double)WIDTH / (double)bins;
    fprintf(out, "<svg class=\"bars\" viewBox=\"0 0 %d %d\" role=\"img\"><title>%s</title>",
            WIDTH, HEIGHT, title);
    for (size_t n = 0; n < bins; n++) {
        const double height = (double)(BASE - 4) * (double)counts[n] / (double)max;
        fprintf(out,
                "<rect x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\"><title>%s to %s: "
                "%.2f %% (%s)</title></rect>",
                (double)n * width + 1, BASE - height, width - 2, height, ends[n], ends[n + 1],
                sum ? 100 * (double)counts[n] / (double)sum : 0, cli_count(counts[n]));
    }
    fprintf(out, "<line class=\"base\" x1=\"0\" x2=\"%d\" y1=\"%d\" y2=\"%d\"/>", WIDTH, BASE,
            BASE);
    for (size_t n = 0; n <= bins; n += bins > 10 ? 6 : 1)
        fprintf(out, "<text class=\"tick\" x=\"%.1f\" y=\"%d\" text-anchor=\"%s\">%s</text>",
                (double)n * width, BASE + 15,
                n == 0      ? "start"
                : n == bins ? "end"
                            : "middle",
                ends[n]);
    fprintf(out, "<text class=\"label\" x=\"0\" y=\"%d\">%s</text></svg>", HEIGHT - 1, title);
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

static double height_of(uint64_t count, uint64_t max)
{
    return count ? (BASE - 14) * fmax(log1p((double)count) / log1p((double)max), 0.02) : 0;
}

void cli_put_histogram(FILE *out, const cw_statistics *v, double level)
{
    uint64_t max = 1;
    const double range = v->max > v->min ? v->max - v->min : 1,
                 width = (double)WIDTH / (double)v->bin_count,
                 at = fmin(fmax((level - v->min) / range, 0), 1) * WIDTH;
    for (size_t n = 0; n < v->bin_count; n++)
        max = v->bins[n] > max ? v->bins[n] : max;
    fprintf(
        out,
        "<svg class=\"bars\" viewBox=\"0 0 %d %d\" role=\"img\"><title>Histogram of the values "
        "from %.6g to %.6g, by the logarithm of their number, with the level at %.6g</title>",
        WIDTH, HEIGHT - 10, v->min, v->max, level);
    for (size_t n = 0; n < v->bin_count; n++) {
        const double height = height_of(v->bins[n], max);
        fprintf(out, "<rect%s x=\"%.2f\" y=\"%.2f\" width=\"%.2f\" height=\"%.2f\"/>",
                ((double)n + 0.5) * width < at ? " class=\"low\"" : "", (double)n * width,
                BASE - height, width * 0.92, height);
    }
    fprintf(
        out,
        "<line class=\"base\" x1=\"0\" x2=\"%d\" y1=\"%d\" y2=\"%d\"/><line class=\"level\" "
        "x1=\"%.1f\" x2=\"%.1f\" y1=\"12\" y2=\"%d\"/>",
        WIDTH, BASE, BASE, at, at, BASE);
    fprintf(out,
            "<text class=\"tick said\" x=\"%.1f\" y=\"9\" text-anchor=\"%s\">%.6g</text>"
            "<text class=\"tick\" x=\"0\" y=\"%d\">%.6g</text>"
            "<text class=\"tick\" x=\"%d\" y=\"%d\" text-anchor=\"end\">%.6g</text></svg>",
            at,
            at < 0.15 * WIDTH   ? "start"
            : at > 0.85 * WIDTH ? "end"
                                : "middle",
            level, BASE + 14, v->min, WIDTH, BASE + 14, v->max);
}
