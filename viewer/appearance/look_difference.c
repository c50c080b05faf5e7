/* Compares pictures pixel by pixel: squares of differences, and CIEDE2000. */
#include "viewer/appearance/look_difference.h"

#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "viewer/image/color_difference.h"

#include <math.h>

typedef struct comparing {
    const cwi_look_greys *greys;
    const uint8_t *a, *b;
    uint32_t size;
    cwi_look_sums *rows;
} comparing;

static void lab_of(const uint8_t rgb[3], double lab[3])
{
    const double srgb[3] = {rgb[0] / 255.0, rgb[1] / 255.0, rgb[2] / 255.0};
    cwi_lab_of(srgb, lab);
}

void cwi_look_greys_make(cwi_look_greys *greys)
{
    double lab[256][3];
    for (int n = 0; n < 256; n++)
        lab_of((const uint8_t[3]){(uint8_t)n, (uint8_t)n, (uint8_t)n}, lab[n]);
    for (int n = 0; n < 256; n++)
        for (int k = 0; k <= n; k++)
            greys->delta_e[n][k] = greys->delta_e[k][n] = (float)cwi_delta_e(lab[n], lab[k]);
}

static bool is_grey(const uint8_t rgb[3])
{
    return rgb[0] == rgb[1] && rgb[1] == rgb[2];
}

static double difference_of(const cwi_look_greys *greys, const uint8_t a[3], const uint8_t b[3])
{
    double lab[2][3];
    if (is_grey(a) && is_grey(b))
        return (double)greys->delta_e[a[0]][b[0]];
    lab_of(a, lab[0]);
    lab_of(b, lab[1]);
    return cwi_delta_e(lab[0], lab[1]);
}

static void compare_row(void *context, size_t y)
{
    const comparing *c = context;
    cwi_look_sums *sums = &c->rows[y];
    for (size_t n = y * c->size; n < (y + 1) * c->size; n++) {
        const uint8_t *a = c->a + 4 * n, *b = c->b + 4 * n;
        uint64_t square = 0;
        if (!a[3] && !b[3])
            continue;
        for (int k = 0; k < 3; k++)
            square += (uint64_t)((a[k] - b[k]) * (a[k] - b[k]));
        const double delta = square ? difference_of(c->greys, a, b) : 0;
        const bool alone = !a[3] != !b[3];
        sums->pixels++;
        sums->square += square;
        sums->delta += delta;
        sums->alone += alone;
        sums->square_alone += alone ? square : 0;
        sums->delta_alone += alone ? delta : 0;
    }
}

cw_status cwi_look_compare(const cwi_look_greys *greys, const uint8_t *a, const uint8_t *b,
                           uint32_t size, int threads, cwi_look_sums *sums, cw_error *err)
{
    comparing c = {greys, a, b, size, cwi_alloc_zeroed(size, sizeof *c.rows)};
    *sums = (cwi_look_sums){0};
    if (!c.rows)
        return cwi_fail_memory(err);
    cwi_parallel_for_all(size, size, threads, compare_row, &c);
    for (uint32_t y = 0; y < size; y++)
        cwi_look_sums_add(sums, &c.rows[y]);
    cwi_free(c.rows);
    return CW_OK;
}

void cwi_look_sums_add(cwi_look_sums *to, const cwi_look_sums *from)
{
    to->pixels += from->pixels;
    to->alone += from->alone;
    to->square += from->square;
    to->square_alone += from->square_alone;
    to->delta += from->delta;
    to->delta_alone += from->delta_alone;
}

static void put_rmse(uint64_t square, size_t pixels, double *rmse, double *psnr_db)
{
    *rmse = pixels ? sqrt((double)square / (3 * (double)pixels)) : 0;
    *psnr_db = pixels ? 20 * log10(255 / *rmse) : 0;
}

void cwi_look_figures(const cwi_look_sums *s, cw_look_difference *f)
{
    const size_t both = s->pixels - s->alone;
    *f = (cw_look_difference){.pixels = s->pixels, .shown_by_one = s->alone};
    put_rmse(s->square, s->pixels, &f->rmse, &f->psnr_db);
    put_rmse(s->square - s->square_alone, both, &f->rmse_both, &f->psnr_both_db);
    f->delta_e = s->pixels ? s->delta / (double)s->pixels : 0;
    f->delta_e_both = both ? (s->delta - s->delta_alone) / (double)both : 0;
}
