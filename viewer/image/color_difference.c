/* Compares pictures: colour differences by CIEDE2000 [Sharma2005], and the structural
 * similarity of luma. */
#include "viewer/image/color_difference.h"
#include "viewer/scene/srgb.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/vec3.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Opacity above which the reference shows something. */
static const float MIN_OPACITY = 1e-4f;

enum { WINDOW = 5 };                    /* pixels on each side of the middle */
static const double WINDOW_SIGMA = 1.5; /* pixels [Wang2004] */

/* Returns the cube root, continued by a line near 0: CIE 15. */
static double lightness_of(double fraction)
{
    const double LAB_KNEE = 6.0 / 29;
    return fraction > LAB_KNEE * LAB_KNEE * LAB_KNEE
               ? cbrt(fraction)
               : fraction / (3 * LAB_KNEE * LAB_KNEE) + 4.0 / 29;
}

/* Converts by IEC 61966-2-1. White is the matrix's result for (1, 1, 1). */
void cwi_lab_of(const double srgb[3], double lab[3])
{
    static const double xyz_of[3][3] = {{0.4124564, 0.3575761, 0.1804375},
                                        {0.2126729, 0.7151522, 0.0721750},
                                        {0.0193339, 0.1191920, 0.9503041}};
    double f[3];
    for (int r = 0; r < 3; r++) {
        double sum = 0, white = 0;
        for (int c = 0; c < 3; c++) {
            sum += xyz_of[r][c] * cwi_srgb_to_linear(srgb[c]);
            white += xyz_of[r][c];
        }
        f[r] = lightness_of(sum / white);
    }
    lab[0] = 116 * f[1] - 16;
    lab[1] = 500 * (f[0] - f[1]);
    lab[2] = 200 * (f[1] - f[2]);
}

static double hue_of(double a, double b)
{
    const double degrees = a == 0 && b == 0 ? 0 : atan2(b, a) * 180 / CWI_PI;
    return degrees < 0 ? degrees + 360 : degrees;
}

static double cos_deg(double degrees)
{
    return cos(degrees * CWI_PI / 180);
}

static double seventh_power(double x)
{
    const double cube = x * x * x;
    return cube * cube * x;
}

/* Returns the root of c^7 / (c^7 + 25^7), for a chroma c. */
static double chroma_fraction(double chroma)
{
    return sqrt(seventh_power(chroma) / (seventh_power(chroma) + seventh_power(25)));
}

/* Computes chroma and hue; a is stretched where colours are close to grey. */
static void chroma_and_hue(const double lab[3], double stretch, double out[2])
{
    const double a = (1 + stretch) * lab[1];
    out[0] = sqrt(a * a + lab[2] * lab[2]);
    out[1] = hue_of(a, lab[2]);
}

/* Computes the difference of two hues, and their mean, both the short way round. */
static void compare_hues(const double p[2], const double q[2], double *difference, double *mean)
{
    *difference = q[1] - p[1];
    *mean = (p[1] + q[1]) / 2;
    if (p[0] * q[0] == 0) {
        *difference = 0;
        *mean = p[1] + q[1];
    } else if (fabs(q[1] - p[1]) > 180) {
        *difference += *difference > 0 ? -360 : 360;
        *mean += p[1] + q[1] < 360 ? 180 : -180;
    }
}

double cwi_delta_e(const double a[3], const double b[3])
{
    double p[2], q[2], turn, hue;
    const double chroma = (hypot(a[1], a[2]) + hypot(b[1], b[2])) / 2;
    const double stretch = 0.5 * (1 - chroma_fraction(chroma));
    chroma_and_hue(a, stretch, p);
    chroma_and_hue(b, stretch, q);
    compare_hues(p, q, &turn, &hue);
    const double light = (a[0] + b[0]) / 2 - 50, mean = (p[0] + q[0]) / 2;
    const double t = 1 - 0.17 * cos_deg(hue - 30) + 0.24 * cos_deg(2 * hue) +
                     0.32 * cos_deg(3 * hue + 6) - 0.20 * cos_deg(4 * hue - 63);
    const double blue = 30 * exp(-(hue - 275) / 25 * ((hue - 275) / 25));
    const double rotation = -sin(2 * blue * CWI_PI / 180) * 2 * chroma_fraction(mean);
    const double dl = (b[0] - a[0]) / (1 + 0.015 * light * light / sqrt(20 + light * light));
    const double dc = (q[0] - p[0]) / (1 + 0.045 * mean);
    const double dh =
        2 * sqrt(p[0] * q[0]) * sin(turn / 2 * CWI_PI / 180) / (1 + 0.015 * mean * t);
    return sqrt(fmax(dl * dl + dc * dc + dh * dh + rotation * dc * dh, 0));
}

static cw_status expect_same_size(const cw_picture *a, const cw_picture *b, cw_error *err)
{
    if (!a->pixels || !b->pixels)
        return cwi_fail(err, CW_ERR_ARGUMENT, "an empty picture cannot be compared");
    if (a->width != b->width || a->height != b->height)
        return cwi_fail(err, CW_ERR_ARGUMENT, "a picture of %zu x %zu beside one of %zu x %zu",
                        a->width, a->height, b->width, b->height);
    return CW_OK;
}

/* Composites a pixel over the background. */
static void show_pixel(const cw_picture *p, size_t n, const float background[2][3],
                       double rgb[3])
{
    const double fraction = ((double)(n / p->width) + 0.5) / (double)p->height;
    const double through = 1 - (double)p->pixels[4 * n + 3];
    for (size_t c = 0; c < 3; c++)
        rgb[c] = (double)p->pixels[4 * n + c] +
                 through * ((1 - fraction) * (double)background[0][c] +
                            fraction * (double)background[1][c]);
}

static void limit_color(double rgb[3])
{
    for (int c = 0; c < 3; c++)
        rgb[c] = fmin(fmax(rgb[c], 0), 1);
}

/* Measures the colours of the displayed pixels. delta: of each pixel compared, in order */
static void measure_colors(const cw_picture *picture, const cw_picture *reference,
                           const float background[2][3], float *delta, cw_comparison *out)
{
    for (size_t n = 0; n < reference->width * reference->height; n++) {
        double a[3], b[3], lab[2][3];
        if (!(reference->pixels[4 * n + 3] > MIN_OPACITY))
            continue;
        show_pixel(picture, n, background, a);
        show_pixel(reference, n, background, b);
        for (int c = 0; c < 3; c++) {
            const double d = 255 * (a[c] - b[c]);
            out->rmse += d * d;
            out->bias += d;
            out->max = fmax(out->max, fabs(d));
        }
        limit_color(a);
        limit_color(b);
        cwi_lab_of(a, lab[0]);
        cwi_lab_of(b, lab[1]);
        delta[out->pixels] = (float)cwi_delta_e(lab[0], lab[1]);
        out->delta_e_mean += (double)delta[out->pixels++];
    }
}

static int in_order(const void *a, const void *b)
{
    const float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

static void finish_colors(float *delta, cw_comparison *out)
{
    const double count = (double)out->pixels;
    out->rmse = sqrt(out->rmse / (3 * count));
    out->bias /= 3 * count;
    out->delta_e_mean /= count;
    qsort(delta, out->pixels, sizeof *delta, in_order);
    out->delta_e_p99 = (double)delta[(size_t)ceil(0.99 * count) - 1];
    out->delta_e_max = (double)delta[out->pixels - 1];
}

/* Moments of luma in a window: means, of squares, and of the product. */
enum { MOMENTS = 5 };

static void moments_of(const cw_picture *picture, const cw_picture *reference, size_t n,
                       const float background[2][3], double m[MOMENTS])
{
    static const double luma[3] = {0.2126, 0.7152, 0.0722}; /* ITU-R BT.709 */
    double a[3], b[3], x = 0, y = 0;
    show_pixel(picture, n, background, a);
    show_pixel(reference, n, background, b);
    limit_color(a);
    limit_color(b);
    for (int c = 0; c < 3; c++) {
        x += luma[c] * a[c];
        y += luma[c] * b[c];
    }
    const double all[MOMENTS] = {x, y, x * x, y * y, x * y};
    memcpy(m, all, sizeof all);
}

/* Computes weighted means of neighbours along one axis, for `count` places `step` apart; at the
 * ends only of the neighbours that exist. */
static void blur_moments(const double (*in)[MOMENTS], size_t count, size_t step,
                         double (*out)[MOMENTS])
{
    for (size_t n = 0; n < count; n++) {
        double sum[MOMENTS] = {0}, total = 0;
        for (int i = -WINDOW; i <= WINDOW; i++) {
            const ptrdiff_t at = (ptrdiff_t)n + i;
            if (at < 0 || at >= (ptrdiff_t)count)
                continue;
            const double weight = exp(-i * i / (2 * WINDOW_SIGMA * WINDOW_SIGMA));
            total += weight;
            for (int m = 0; m < MOMENTS; m++)
                sum[m] += weight * in[(size_t)at * step][m];
        }
        for (int m = 0; m < MOMENTS; m++)
            out[n * step][m] = sum[m] / total;
    }
}

/* Returns the structural similarity of values from 0 to 1 [Wang2004]. */
static double structural_similarity(const double m[MOMENTS])
{
    const double C1 = 0.01 * 0.01, C2 = 0.03 * 0.03;
    const double xx = m[2] - m[0] * m[0], yy = m[3] - m[1] * m[1], xy = m[4] - m[0] * m[1];
    return (2 * m[0] * m[1] + C1) * (2 * xy + C2) /
           ((m[0] * m[0] + m[1] * m[1] + C1) * (xx + yy + C2));
}

static double mean_similarity(const cw_picture *picture, const cw_picture *reference,
                              const float background[2][3], double (*m)[MOMENTS],
                              double (*blurred)[MOMENTS])
{
    const size_t w = reference->width, h = reference->height;
    double sum = 0, count = 0;
    for (size_t n = 0; n < w * h; n++)
        moments_of(picture, reference, n, background, m[n]);
    for (size_t y = 0; y < h; y++)
        blur_moments((const double(*)[MOMENTS])m + y * w, w, 1, blurred + y * w);
    for (size_t x = 0; x < w; x++)
        blur_moments((const double(*)[MOMENTS])blurred + x, h, w, m + x);
    for (size_t n = 0; n < w * h; n++)
        if (reference->pixels[4 * n + 3] > MIN_OPACITY) {
            sum += structural_similarity(m[n]);
            count++;
        }
    return sum / count;
}

cw_status cw_picture_compare(const cw_picture *picture, const cw_picture *reference,
                             const float background[2][3], cw_comparison *out, cw_error *err)
{
    CWI_REQUIRE(err, picture, reference, background, out);
    *out = (cw_comparison){0};
    cw_status st = expect_same_size(picture, reference, err);
    if (st != CW_OK)
        return st;
    const size_t count = reference->width * reference->height;
    float *delta = cwi_alloc_array(count, sizeof *delta);
    double(*moments)[MOMENTS] = cwi_alloc_array(count, sizeof *moments);
    double(*blurred)[MOMENTS] = cwi_alloc_array(count, sizeof *blurred);
    if (!delta || !moments || !blurred)
        st = cwi_fail_memory(err);
    else
        measure_colors(picture, reference, background, delta, out);
    if (out->pixels > 0) {
        finish_colors(delta, out);
        out->ssim = mean_similarity(picture, reference, background, moments, blurred);
    }
    cwi_free(delta);
    cwi_free(moments);
    cwi_free(blurred);
    return st;
}

cw_status cw_picture_difference(const cw_picture *a, const cw_picture *b, double amplify,
                                cw_picture *difference, cw_error *err)
{
    CWI_REQUIRE(err, a, b, difference);
    *difference = (cw_picture){0};
    cw_status st = expect_same_size(a, b, err);
    if (st == CW_OK && !(amplify > 0 && isfinite(amplify)))
        st = cwi_fail(err, CW_ERR_ARGUMENT, "a difference times %g: expected more than 0",
                      amplify);
    if (st == CW_OK)
        st = cw_picture_alloc(difference, a->width, a->height, err);
    for (size_t n = 0; st == CW_OK && n < a->width * a->height; n++) {
        const float *p = a->pixels + 4 * n, *q = b->pixels + 4 * n;
        const double opacity = (double)p[3] - (double)q[3];
        for (int c = 0; c < 3; c++) {
            const double d = (double)p[c] - (double)q[c];
            difference->pixels[4 * n + (size_t)c] =
                (float)fmin(amplify * fmax(fabs(d), fabs(d - opacity)), 1);
        }
        difference->pixels[4 * n + 3] = 1;
    }
    return st;
}

cw_status cw_picture_split(const cw_picture *left, const cw_picture *right,
                           double left_fraction, cw_picture *both, cw_error *err)
{
    CWI_REQUIRE(err, left, right, both);
    *both = (cw_picture){0};
    cw_status st = expect_same_size(left, right, err);
    if (st == CW_OK && !(left_fraction >= 0 && left_fraction <= 1))
        st = cwi_fail(err, CW_ERR_ARGUMENT, "%g of a picture: expected 0 to 1", left_fraction);
    if (st == CW_OK)
        st = cw_picture_alloc(both, left->width, left->height, err);
    if (st != CW_OK)
        return st;
    const size_t w = left->width, line = 1 + w / 1024;
    const size_t end = (size_t)lround(left_fraction * (double)w);
    const size_t first = end > line / 2 ? end - line / 2 : 0;
    for (size_t n = 0; n < w * left->height; n++) {
        const size_t x = n % w;
        const bool is_line = end > 0 && end < w && x >= first && x < first + line;
        for (size_t c = 0; c < 4; c++)
            both->pixels[4 * n + c] = is_line   ? 1
                                      : x < end ? left->pixels[4 * n + c]
                                                : right->pixels[4 * n + c];
    }
    return CW_OK;
}
