/* Pictures of the object of a study: the object itself, a slice with the contour of its
 * surface; and the histogram of its values. */
#include "cli/framework/console.h"
#include "cli/framework/field_names.h"
#include "cli/study/study.h"
#include "core/base/status.h"
#include "core/geometry/vec3.h"
#include "core/volume/volume.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { SLICE_EDGE = 480, MIN_EDGE = 60, BINS = 96 };

/* Fraction of the values that are darker than black, and brighter than white. */
static const double BEYOND = 0.005;

static const uint8_t CONTOUR[4] = {255, 128, 0, 255};

/* A slice of a volume as an image: its first two axes, as they lie in the world. */
typedef struct slice {
    const cw_volume *volume;
    size_t number; /* along the third axis */
    size_t width, height;
    bool flip[2]; /* columns and rows run against the axes of the volume */
    double black, white;
} slice;

/* To the right go left and back, down go back and the feet: as radiologists look at slices. */
static bool runs_against(const cw_volume *v, int axis)
{
    int main = 0;
    for (int a = 1; a < 3; a++)
        if (fabs(v->affine[a][axis]) > fabs(v->affine[main][axis]))
            main = a;
    const bool falls = v->affine[main][axis] < 0;
    return axis == 1 && main == 2 ? !falls : falls;
}

static double find_quantile(const cw_statistics *values, double fraction)
{
    double left = fraction * (double)values->finite;
    size_t n = 0;
    while (n + 1 < values->bin_count && left > (double)values->bins[n])
        left -= (double)values->bins[n++];
    return values->min + ((double)n + 0.5) * values->bin_width;
}

static size_t choose_edge(double mm, double longest_mm)
{
    return (size_t)fmax(MIN_EDGE, SLICE_EDGE * mm / longest_mm + 0.5);
}

/* Through the middle of the object. */
static bool choose_slice(const cli_study *s, slice *out)
{
    const cw_volume *v = &s->volume->view;
    double low[3], high[3], middle[3], index[3], spacing[3], mm[2];
    cw_volume whole;
    if (cw_volume_resolve(v, &whole, NULL) != CW_OK || !cw_mesh_bounds(&s->full, low, high))
        return false;
    cwi_midpoint(low, high, middle);
    if (cw_volume_to_index(v, middle, index, NULL) != CW_OK)
        return false;
    cw_volume_spacing(v, spacing);
    for (int a = 0; a < 2; a++) {
        mm[a] = spacing[a] * (double)(v->dim[a] - 1);
        out->flip[a] = runs_against(&whole, a);
    }
    out->volume = v;
    out->number = (size_t)fmin(fmax(index[2] + 0.5, 0), (double)(v->dim[2] - 1));
    out->width = choose_edge(mm[0], fmax(mm[0], mm[1]));
    out->height = choose_edge(mm[1], fmax(mm[0], mm[1]));
    out->black = find_quantile(&s->overview.values, BEYOND);
    out->white = find_quantile(&s->overview.values, 1 - BEYOND);
    return true;
}

/* Interpolates the value at a pixel linearly; NaN outside of the voxels. */
static double value_at(const slice *s, size_t x, size_t y)
{
    const size_t size[2] = {s->width, s->height}, pixel[2] = {x, y};
    size_t first[2];
    double t[2];
    for (int a = 0; a < 2; a++) {
        const size_t from = s->flip[a] ? size[a] - 1 - pixel[a] : pixel[a];
        const double at =
            (double)from / (double)(size[a] - 1) * (double)(s->volume->dim[a] - 1);
        first[a] = (size_t)fmin(floor(at), (double)(s->volume->dim[a] - 2));
        t[a] = at - (double)first[a];
    }
    const size_t i = first[0], j = first[1], k = s->number;
    const double low = cw_volume_value(s->volume, i, j, k) * (1 - t[0]) +
                       cw_volume_value(s->volume, i + 1, j, k) * t[0],
                 high = cw_volume_value(s->volume, i, j + 1, k) * (1 - t[0]) +
                        cw_volume_value(s->volume, i + 1, j + 1, k) * t[0];
    return low * (1 - t[1]) + high * t[1];
}

static void put_gray(const slice *s, double value, uint8_t pixel[4])
{
    const double fraction = (value - s->black) / fmax(s->white - s->black, 1e-30);
    memset(pixel, isfinite(value) ? (int)(255 * fmin(fmax(fraction, 0), 1) + 0.5) : 0, 3);
    pixel[3] = 255;
}

static void draw_slice(const slice *s, double iso, cw_image *image)
{
    for (size_t y = 0; y < s->height; y++)
        for (size_t x = 0; x < s->width; x++) {
            const double value = value_at(s, x, y);
            uint8_t *pixel = image->pixels + 4 * (y * s->width + x);
            put_gray(s, value, pixel);
            /* a line of two pixels, where any pixel beside is on the other side */
            for (size_t dy = 0; dy < 2; dy++)
                for (size_t dx = 0; dx < 2; dx++)
                    if (x + dx < s->width && y + dy < s->height &&
                        (value_at(s, x + dx, y + dy) >= iso) != (value >= iso))
                        memcpy(pixel, CONTOUR, 4);
        }
}

static cw_status study_slice(cli_study *s, cw_error *err)
{
    cli_overview *o = &s->overview;
    const cw_volume *v = &s->volume->view;
    cw_image image = {0};
    slice shown;
    const char *kind = cwi_volume_kind(v);
    if (kind || v->dim[0] < 2 || v->dim[1] < 2 || !choose_slice(s, &shown)) {
        snprintf(o->why, sizeof o->why, "no slice is drawn of %s",
                 kind ? kind : "so flat a grid");
        return CW_OK;
    }
    cw_status st = cw_image_alloc(&image, shown.width, shown.height, err);
    if (st != CW_OK)
        return st;
    draw_slice(&shown, s->iso, &image);
    snprintf(o->slice_words, sizeof o->slice_words, "slice %zu of %zu along the third axis",
             shown.number + 1, v->dim[2]);
    st = cli_make_png(s, &image, &o->slice, err);
    cw_image_free(&image);
    return st;
}

cw_status cli_study_overview(cli_study *s, cw_error *err)
{
    cli_overview *o = &s->overview;
    cw_error why = {0};
    if (cli_time_is_up(s)) {
        snprintf(o->why, sizeof o->why, "the budget was spent before it was drawn");
        return CW_OK;
    }
    cli_say_v("overview");
    cw_status st = cw_volume_statistics(&s->volume->view, BINS, s->threads, &o->values, &why);
    if (st == CW_OK)
        st = study_slice(s, &why);
    if (st == CW_OK)
        st = cli_draw_mesh(s, &s->full, &s->full, NULL, &o->object, &why);
    if (st != CW_OK && cli_interrupted()) {
        *err = why;
        return st;
    }
    if (st != CW_OK)
        snprintf(o->why, sizeof o->why, "%s",
                 st == CW_ERR_CANCELLED
                     ? "it was still being drawn when the budget was spent"
                     : cli_name_options(why.message, (char[CLI_MESSAGE]){0}));
    return CW_OK;
}
