/* Draws charts into bitmaps: each texel that they touch. */
#include "simplify/atlas/chart_bits.h"

#include "core/base/memory.h"

#include <math.h>
#include <string.h>

/* Sides of bitmaps that are made; larger charts do not fit into any square. */
enum { MAX_SIDE = 1 << 17 };

typedef struct drawing {
    const cwi_chart *chart;
    cwi_chart_bits *bits;
    double scale[2]; /* cosine and sine times density */
    size_t stride;   /* words of a row */
    uint32_t widen;
} drawing;

static void turn_point(const drawing *d, uint32_t vertex, double p[2])
{
    const double *uv = d->chart->uv[vertex];
    p[0] = d->scale[0] * uv[0] - d->scale[1] * uv[1] - d->bits->least[0];
    p[1] = d->scale[1] * uv[0] + d->scale[0] * uv[1] - d->bits->least[1];
}

static void set_bits(uint64_t *row, uint32_t first, uint32_t last)
{
    for (uint32_t word = first / 64; word <= last / 64; word++) {
        uint64_t bits = ~UINT64_C(0);
        if (word == first / 64)
            bits &= ~UINT64_C(0) << first % 64;
        if (word == last / 64)
            bits &= ~UINT64_C(0) >> (63 - last % 64);
        row[word] |= bits;
    }
}

/* Returns the part of a side within a band of height, as ends of x. */
static void cut_side(const double a[2], const double b[2], double low, double high,
                     double ends[2])
{
    const double *lower = a[1] <= b[1] ? a : b, *upper = a[1] <= b[1] ? b : a;
    if (lower[1] > high || upper[1] < low)
        return;
    const double rise = upper[1] - lower[1], run = upper[0] - lower[0];
    double x[2] = {lower[0], upper[0]};
    if (lower[1] < low)
        x[0] = lower[0] + run * ((low - lower[1]) / rise);
    if (upper[1] > high)
        x[1] = lower[0] + run * ((high - lower[1]) / rise);
    ends[0] = fmin(ends[0], fmin(x[0], x[1]));
    ends[1] = fmax(ends[1], fmax(x[0], x[1]));
}

/* Returns a coordinate's texel, of those that there are. */
static uint32_t texel_at(double x, uint32_t count)
{
    return x > 0 ? (uint32_t)fmin(x, count - 1) : 0;
}

/* Sets the texels that a side of the outline touches. In `inner`, a bit is turned over where the side
 * passes the middle of a row, at the first texel whose middle is behind it. */
static void draw_side(const drawing *d, const uint32_t side[2])
{
    double p[2][2];
    turn_point(d, side[0], p[0]);
    turn_point(d, side[1], p[1]);
    const uint32_t first = texel_at(fmin(p[0][1], p[1][1]), d->bits->height),
                   last = texel_at(fmax(p[0][1], p[1][1]), d->bits->height);
    for (uint32_t row = first; row <= last; row++) {
        double ends[2] = {INFINITY, -INFINITY};
        cut_side(p[0], p[1], row, row + 1, ends);
        if (ends[0] <= ends[1])
            set_bits(d->bits->words + row * d->stride, texel_at(ends[0], d->bits->width),
                     texel_at(ends[1], d->bits->width));
        const double middle = row + 0.5;
        if ((p[0][1] <= middle) == (p[1][1] <= middle))
            continue;
        const double share = (middle - p[0][1]) / (p[1][1] - p[0][1]),
                     x = p[0][0] + share * (p[1][0] - p[0][0]);
        const uint32_t behind = texel_at(x + 0.5, d->bits->width);
        d->bits->inner[row * d->stride + behind / 64] ^= UINT64_C(1) << behind % 64;
    }
}

/* Sets the texels whose middle is within the outline: those behind an odd number of sides. */
static void fill_outline(const drawing *d)
{
    for (size_t row = 0; row < d->bits->height; row++) {
        uint64_t *words = d->bits->words + row * d->stride, carried = 0;
        const uint64_t *inner = d->bits->inner + row * d->stride;
        for (size_t w = 0; w < d->stride; w++) {
            uint64_t odd = inner[w];
            for (int by = 1; by < 64; by *= 2)
                odd ^= odd << by;
            odd ^= carried;
            carried = odd >> 63 ? ~UINT64_C(0) : 0;
            words[w] |= odd;
        }
    }
}

/* Adds texels to the left and right, and above and below, of those that are set. */
static void widen_bits(const drawing *d)
{
    cwi_chart_bits *b = d->bits;
    for (uint32_t step = 0; step < d->widen; step++) {
        for (size_t row = 0; row < b->height; row++) {
            uint64_t *words = b->words + row * d->stride, before = 0;
            for (size_t w = 0; w < d->stride; w++) {
                const uint64_t here = words[w], after = w + 1 < d->stride ? words[w + 1] : 0;
                words[w] |= here << 1 | before >> 63 | here >> 1 | after << 63;
                before = here;
            }
        }
        for (size_t row = 0; row + 1 < b->height; row++)
            for (size_t w = 0; w < d->stride; w++)
                b->words[row * d->stride + w] |= b->words[(row + 1) * d->stride + w];
        for (size_t row = b->height; row-- > 1;)
            for (size_t w = 0; w < d->stride; w++)
                b->words[row * d->stride + w] |= b->words[(row - 1) * d->stride + w];
    }
}

static bool add_run(cwi_chart_bits *b, cwi_texel_run run)
{
    cwi_texel_run *grown = cwi_grow_array(b->runs, b->run_count, &b->run_room, sizeof *grown);
    if (!grown)
        return false;
    b->runs = grown;
    b->runs[b->run_count++] = run;
    return true;
}

static bool list_runs(const drawing *d)
{
    cwi_chart_bits *b = d->bits;
    b->run_count = 0;
    for (uint32_t row = 0; row < b->height; row++) {
        const uint64_t *words = b->words + row * d->stride;
        cwi_texel_run run = {row, 0, 0};
        bool is_in = false;
        for (uint32_t x = 0; x <= b->width; x++) {
            if (x % 64 == 0 && !is_in && x < b->width && !words[x / 64]) {
                x += 63;
                continue;
            }
            const bool is_set = x < b->width && words[x / 64] >> x % 64 & 1;
            if (is_set && !is_in)
                run.first = x;
            if (!is_set && is_in) {
                run.last = x - 1;
                if (!add_run(b, run))
                    return false;
            }
            is_in = is_set;
        }
    }
    return true;
}

static bool clear_words(cwi_chart_bits *b, size_t count)
{
    if (count > b->word_room) {
        cwi_free(b->words);
        cwi_free(b->inner);
        b->words = cwi_alloc_array(count, sizeof *b->words);
        b->inner = cwi_alloc_array(count, sizeof *b->inner);
        b->word_room = b->words && b->inner ? count : 0;
    }
    if (b->word_room < count)
        return false;
    memset(b->words, 0, count * sizeof *b->words);
    memset(b->inner, 0, count * sizeof *b->inner);
    return true;
}

bool cwi_chart_bits_make(cwi_chart_bits *bits, const cwi_chart *chart, double density,
                         const double turn[2], uint32_t widen)
{
    drawing d = {.chart = chart,
                 .bits = bits,
                 .scale = {density * turn[0], density * turn[1]},
                 .widen = widen};
    double most[2] = {-INFINITY, -INFINITY}, least[2] = {INFINITY, INFINITY};
    bits->least[0] = bits->least[1] = 0;
    for (size_t n = 0; n < chart->border_count; n++) {
        double p[2];
        turn_point(&d, chart->border[2 * n], p);
        for (int k = 0; k < 2; k++) {
            least[k] = fmin(least[k], p[k]);
            most[k] = fmax(most[k], p[k]);
        }
    }
    for (int k = 0; k < 2; k++)
        if (!(most[k] - least[k] < MAX_SIDE)) {
            bits->width = bits->height = UINT32_MAX;
            return true;
        }
    bits->width = (uint32_t)(most[0] - least[0]) + 1 + 2 * widen;
    bits->height = (uint32_t)(most[1] - least[1]) + 1 + 2 * widen;
    for (int k = 0; k < 2; k++)
        bits->least[k] = least[k] - widen;
    d.stride = bits->width / 64 + 1;
    if (!clear_words(bits, d.stride * bits->height))
        return false;
    for (size_t n = 0; n < chart->border_count; n++)
        draw_side(&d, chart->border + 2 * n);
    fill_outline(&d);
    widen_bits(&d);
    return list_runs(&d);
}

void cwi_chart_bits_free(cwi_chart_bits *bits)
{
    cwi_free(bits->runs);
    cwi_free(bits->words);
    cwi_free(bits->inner);
    *bits = (cwi_chart_bits){0};
}
