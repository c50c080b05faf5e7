/* Finds isolines in pictures of slices: marching squares on the trilinear field between the
 * corners of pixels. */
#include "viewer/image/isolines.h"

#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/geometry/vec3.h"
#include "viewer/scene/slice.h"

#include <math.h>

enum { BISECTIONS = 6 }; /* to 1/64 pixel */

/* The value that a point of the picture shows, and on which slice. */
typedef struct sample {
    float value; /* NaN: no slice, or no value */
    uint8_t slice;
} sample;

typedef struct search {
    const cwi_frame *frame;
    cw_slice slices[CW_MAX_SLICES];
    size_t slice_count;
    double scale[2]; /* samples of the frame in a pixel */
    double isovalue;
    size_t columns; /* corners in a row */
    sample *samples;
} search;

static sample take_sample(const search *s, double x, double y)
{
    const cwi_frame *f = s->frame;
    double origin[3], direction[3], eye[3], world[3];
    size_t number = 0;
    cwi_frame_ray(f, x * s->scale[0], y * s->scale[1], origin, direction);
    const double t = cwi_slice_hit(f, s->slices, s->slice_count, origin, direction, &number);
    if (t == INFINITY)
        return (sample){NAN, 0};
    cwi_add_scaled(origin, t, direction, eye);
    cwi_frame_to_world(f, eye, world);
    return (sample){(float)cw_volume_sample(&f->volume, world), (uint8_t)number};
}

static void sample_row(void *context, size_t row)
{
    const search *s = context;
    for (size_t x = 0; x < s->columns; x++)
        s->samples[row * s->columns + x] = take_sample(s, (double)x, (double)row);
}

static bool is_above(const search *s, const sample *at)
{
    return (double)at->value >= s->isovalue;
}

/* Returns a bit for each corner that is above, in the order of a walk around the pixel; 0 where
 * a corner shows nothing, or another slice. */
static unsigned find_case(const search *s, size_t x, size_t y)
{
    const sample *first = &s->samples[y * s->columns + x];
    const sample *corners[4] = {first, first + 1, first + s->columns + 1, first + s->columns};
    unsigned bits = 0;
    for (int n = 0; n < 4; n++) {
        if (isnan(corners[n]->value) || corners[n]->slice != first->slice)
            return 0;
        bits |= (unsigned)is_above(s, corners[n]) << n;
    }
    return bits;
}

static size_t count_strokes(unsigned bits)
{
    return bits == 0 || bits == 15 ? 0 : bits == 5 || bits == 10 ? 2 : 1;
}

/* Finds the crossing on edge n of a pixel, from its corner n to the next. */
static void find_crossing(const search *s, size_t x, size_t y, int n, double out[2])
{
    static const int corners[5][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}, {0, 0}};
    double low = 0, high = 1;
    const int *from = corners[n], *to = corners[n + 1];
    const sample *first = &s->samples[(y + (size_t)from[1]) * s->columns + x + (size_t)from[0]];
    const bool starts_above = is_above(s, first);
    for (int k = 0; k < BISECTIONS; k++) {
        const double t = 0.5 * (low + high);
        const sample at = take_sample(s, (double)x + from[0] + t * (to[0] - from[0]),
                                      (double)y + from[1] + t * (to[1] - from[1]));
        if (is_above(s, &at) == starts_above)
            low = t;
        else
            high = t;
    }
    out[0] = (double)x + from[0] + 0.5 * (low + high) * (to[0] - from[0]);
    out[1] = (double)y + from[1] + 0.5 * (low + high) * (to[1] - from[1]);
}

/* Makes the strokes of a pixel. Where opposite corners are alike, its middle decides which of
 * them are joined. */
static size_t make_strokes(const search *s, size_t x, size_t y, cwi_stroke *out)
{
    const unsigned bits = find_case(s, x, y);
    int edges[4], count = 0;
    if (count_strokes(bits) == 0)
        return 0;
    for (int n = 0; n < 4; n++)
        if ((bits >> n & 1) != (bits >> (n + 1) % 4 & 1))
            edges[count++] = n;
    if (count == 4) {
        const sample middle = take_sample(s, (double)x + 0.5, (double)y + 0.5);
        if (is_above(s, &middle) != (bits & 1)) { /* lines cut off corners 0 and 2 */
            edges[0] = 3, edges[1] = 0;
            edges[2] = 1, edges[3] = 2;
        }
    }
    for (int n = 0; n < count; n++)
        find_crossing(s, x, y, edges[n], n % 2 ? out[n / 2].to : out[n / 2].from);
    return (size_t)count / 2;
}

static cw_status collect_strokes(const search *s, const cw_image *image, cwi_stroke **strokes,
                                 size_t *count, cw_error *err)
{
    size_t all = 0;
    for (size_t y = 0; y < image->height; y++)
        for (size_t x = 0; x < image->width; x++)
            all += count_strokes(find_case(s, x, y));
    *strokes = cwi_alloc_array(all + 1, sizeof **strokes);
    if (!*strokes)
        return cwi_fail_memory(err);
    for (size_t y = 0; y < image->height; y++)
        for (size_t x = 0; x < image->width; x++)
            *count += make_strokes(s, x, y, *strokes + *count);
    return CW_OK;
}

cw_status cwi_isolines_find(const cwi_frame *frame, const cw_image *image, double isovalue,
                            cwi_stroke **strokes, size_t *count, cw_error *err)
{
    search s = {.frame = frame,
                .isovalue = isovalue,
                .columns = image->width + 1,
                .scale = {(double)frame->scene.width / (double)image->width,
                          (double)frame->scene.height / (double)image->height}};
    *strokes = NULL;
    *count = 0;
    cw_status st = cwi_slices_of(&frame->scene, &frame->volume, s.slices, &s.slice_count, err);
    if (st != CW_OK)
        return st;
    s.samples = cwi_alloc_array(s.columns * (image->height + 1), sizeof *s.samples);
    if (!s.samples)
        return cwi_fail_memory(err);
    st = cwi_parallel_for(image->height + 1, s.columns, frame->scene.threads,
                          &frame->scene.progress, "drawing isolines", sample_row, &s, err);
    if (st == CW_OK)
        st = collect_strokes(&s, image, strokes, count, err);
    cwi_free(s.samples);
    return st;
}
