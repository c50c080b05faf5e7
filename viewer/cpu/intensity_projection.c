/* Draws intensity projections: walks each ray through the cells, and keeps the highest, lowest,
 * mean or first local maximum of the value. */
#include "viewer/cpu/intensity_projection.h"

#include "viewer/rays/ray_traversal.h"

#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/geometry/cubic.h"
#include "core/volume/volume.h"

#include <math.h>

/* State of a ray's value so far. */
typedef struct tally {
    bool has_value;
    double extreme;
    double integral, length;

    double threshold; /* of local-mip, and of minip inside an object */

    /* minip inside an object: the lowest value since the ray last reached the threshold; it
     * counts if the ray reaches the threshold again */
    double pending;

    /* local-mip */
    bool is_under_way, is_found; /* a stretch of values without a gap; the maximum */
    double last;                 /* the highest value since it last fell */
} tally;

/* Computes values where they turn, from 0 to 1, and at the ends; returns their number. */
static int turning_values(const double c[4], double values[4])
{
    double turns[2];
    int count = 0;
    const int turn_count = cwi_cubic_turns(c, turns);
    values[count++] = c[0];
    for (int n = 0; n < turn_count; n++)
        values[count++] = cwi_cubic_at(c, turns[n]);
    values[count++] = cwi_cubic_at(c, 1);
    return count;
}

static bool lies_within(const double v[8], double low, double high)
{
    for (int n = 0; n < 8; n++)
        if (!(v[n] >= low && v[n] <= high))
            return false;
    return true;
}

static void add_highest(const cwi_walk *w, const double v[8], tally *t)
{
    double c[4], values[4];
    if (t->has_value && lies_within(v, -INFINITY, t->extreme))
        return;
    cwi_walk_cubic(w, v, c);
    for (int n = turning_values(c, values) - 1; n >= 0; n--) {
        t->extreme = t->has_value ? fmax(t->extreme, values[n]) : values[n];
        t->has_value = true;
    }
}

static void add_lowest(const cwi_walk *w, const double v[8], tally *t)
{
    double c[4], values[4];
    if (t->has_value && lies_within(v, t->extreme, INFINITY))
        return;
    cwi_walk_cubic(w, v, c);
    for (int n = turning_values(c, values) - 1; n >= 0; n--) {
        t->extreme = t->has_value ? fmin(t->extreme, values[n]) : values[n];
        t->has_value = true;
    }
}

/* Adds a value of a ray to the minimum between its first and its last value that reaches the
 * threshold. */
static void add_inside_value(double value, tally *t)
{
    if (value >= t->threshold) {
        t->extreme = t->has_value ? fmin(fmin(t->extreme, t->pending), value) : value;
        t->has_value = true;
        t->pending = INFINITY;
    } else if (t->has_value) {
        t->pending = fmin(t->pending, value);
    }
}

/* Adds a cubic, with the threshold itself wherever values cross it. */
static void add_inside_cubic(const double c[4], tally *t)
{
    double values[4];
    const int count = turning_values(c, values);
    for (int n = 0; n < count; n++) {
        if (n > 0 && (values[n - 1] < t->threshold) != (values[n] < t->threshold))
            add_inside_value(t->threshold, t);
        add_inside_value(values[n], t);
    }
}

static void add_inside(const cwi_walk *w, const double v[8], tally *t)
{
    double c[4];
    cwi_walk_cubic(w, v, c);
    add_inside_cubic(c, t);
}

static void add_mean_cubic(const double c[4], double length, tally *t)
{
    t->integral += length * (c[0] + c[1] / 2 + c[2] / 3 + c[3] / 4);
    t->length += length;
    t->has_value = true;
}

static void add_mean(const cwi_walk *w, const double v[8], tally *t)
{
    double c[4];
    cwi_walk_cubic(w, v, c);
    add_mean_cubic(c, w->to - w->from, t);
}

/* Ends a stretch: its end is a maximum too, if values rise towards it. */
static void end_stretch(tally *t)
{
    if (t->is_under_way && t->last >= t->threshold)
        t->is_found = true;
    t->is_under_way = false;
}

/* Adds a cubic for local-mip. Neighbouring cells agree on the value between them except for
 * rounding, which is not a fall. */
static void add_local_cubic(const double c[4], double rounding, tally *t)
{
    double values[4];
    const int count = turning_values(c, values);
    for (int n = 0; n < count && !t->is_found; n++) {
        const bool falls = t->is_under_way && values[n] < t->last - rounding;
        t->extreme = t->has_value ? fmax(t->extreme, values[n]) : values[n];
        t->has_value = true;
        if (falls && t->last >= t->threshold)
            t->is_found = true;
        else
            t->last = values[n];
        t->is_under_way = true;
    }
}

static void add_local(const cwi_walk *w, const double v[8], tally *t)
{
    double c[4], rounding = 0;
    cwi_walk_cubic(w, v, c);
    for (int n = 0; n < 8; n++)
        rounding = fmax(rounding, 1e-12 * fabs(v[n]));
    add_local_cubic(c, rounding, t);
}

static void add_cell(const cw_scene *s, const cwi_walk *w, tally *t)
{
    double v[8];
    const cw_mode mode = s->mode;
    if (!cwi_walk_values(w, v))
        end_stretch(t);
    else if (mode == CW_MODE_MIP)
        add_highest(w, v, t);
    else if (mode == CW_MODE_MINIP && s->intensity.minip_inside)
        add_inside(w, v, t);
    else if (mode == CW_MODE_MINIP)
        add_lowest(w, v, t);
    else if (mode == CW_MODE_AVERAGE)
        add_mean(w, v, t);
    else
        add_local(w, v, t);
}

/* Returns true if a block of cells can be skipped: it has no values, or none that would change
 * the result. A stretch of values continues behind it, below the threshold as its end was, as
 * if it began there. */
static bool is_passed_over(const cw_scene *s, const float range[2], tally *t)
{
    const cw_mode mode = s->mode;
    const double low = (double)range[0], high = (double)range[1];
    if (low > high) {
        end_stretch(t);
        return true;
    }
    if (mode == CW_MODE_MINIP && s->intensity.minip_inside) {
        const bool is_below = high < t->threshold;
        return t->has_value ? low >= t->extreme && (is_below || t->pending >= t->extreme)
                            : is_below;
    }
    if (mode == CW_MODE_AVERAGE || !t->has_value ||
        !(mode == CW_MODE_MINIP ? low >= t->extreme : high <= t->extreme) ||
        (mode == CW_MODE_LOCAL_MIP && high >= t->threshold))
        return false;
    t->is_under_way = false;
    return true;
}

static void add_part(const cwi_frame *frame, const cwi_ranges *ranges, const cwi_ray *ray,
                     int part, tally *t)
{
    cwi_walk walk;
    const cw_scene *s = &frame->scene;
    bool is_new_block = ranges != NULL;
    cwi_walk_start(&walk, frame, ray, part);
    while (!t->is_found && walk.t < walk.stop) {
        if (is_new_block &&
            is_passed_over(s, ranges->blocks[cwi_walk_block(&walk, ranges->dim)], t)) {
            cwi_walk_leap(&walk, CWI_RANGE_EDGE, 1);
            continue;
        }
        if (!cwi_walk_next(&walk))
            break;
        is_new_block = ranges && cwi_walk_changes_block(&walk);
        add_cell(s, &walk, t);
    }
    if (!t->is_found)
        end_stretch(t);
}

static double result_of(cw_mode mode, const tally *t)
{
    if (!t->has_value)
        return NAN;
    if (mode == CW_MODE_AVERAGE)
        return t->integral / t->length;
    return t->is_found ? t->last : t->extreme;
}

static void add_span(const cw_scene *s, const cwi_span *span, tally *t)
{
    double values[4], rounding = 0;
    const cw_mode mode = s->mode;
    if (mode == CW_MODE_MINIP && s->intensity.minip_inside) {
        add_inside_cubic(span->value, t);
        return;
    }
    if (!span->follows)
        end_stretch(t);
    const int count = turning_values(span->value, values);
    for (int n = 0; n < count && (mode == CW_MODE_MIP || mode == CW_MODE_MINIP); n++) {
        const bool is_better =
            mode == CW_MODE_MIP ? values[n] > t->extreme : values[n] < t->extreme;
        if (!t->has_value || is_better)
            t->extreme = values[n];
        t->has_value = true;
    }
    for (int n = 0; n < count; n++)
        rounding = fmax(rounding, 1e-9 * fabs(values[n]));
    if (mode == CW_MODE_AVERAGE)
        add_mean_cubic(span->value, span->to - span->from, t);
    if (mode == CW_MODE_LOCAL_MIP && !t->is_found)
        add_local_cubic(span->value, rounding, t);
}

static tally start_tally(const cw_scene *s)
{
    const bool has_threshold =
        s->mode == CW_MODE_LOCAL_MIP || (s->mode == CW_MODE_MINIP && s->intensity.minip_inside);
    return (tally){.threshold = has_threshold ? s->intensity.threshold : INFINITY,
                   .pending = INFINITY};
}

double cwi_intensity_spans(const cwi_field *field, cwi_spans *spans, double x, double y,
                           double depth)
{
    cwi_ray ray;
    cwi_span span;
    const cw_mode mode = field->frame->scene.mode;
    tally t = start_tally(&field->frame->scene);
    cwi_ray_make(field->frame, x, y, depth, &ray);
    if (!cwi_spans_start(spans, field, &ray))
        return NAN;
    while (!t.is_found && cwi_spans_next(spans, &span))
        add_span(&field->frame->scene, &span, &t);
    if (!t.is_found)
        end_stretch(&t);
    return result_of(mode, &t);
}

double cwi_intensity_ray(const cwi_frame *frame, const cwi_ranges *ranges, double x, double y,
                         double depth)
{
    cwi_ray ray;
    const cw_mode mode = frame->scene.mode;
    tally t = start_tally(&frame->scene);
    cwi_ray_make(frame, x, y, depth, &ray);
    for (int n = 0; n < ray.part_count && !t.is_found; n++)
        add_part(frame, ranges, &ray, n, &t);
    return result_of(mode, &t);
}

typedef struct job {
    const cwi_frame *frame;
    const cwi_ranges *ranges;
    const double *depths;
    cw_picture *picture;
    cwi_field field;
    bool is_even, is_starved;
} job;

static void draw_row(void *context, size_t y)
{
    job *work = context;
    const size_t width = work->picture->width;
    cwi_spans spans = {0};
    for (size_t x = 0; x < width; x++) {
        float *pixel = work->picture->pixels + 4 * (y * width + x);
        const double depth = work->depths ? work->depths[y * width + x] : INFINITY;
        const double at[2] = {(double)x + 0.5, (double)y + 0.5};
        const double value =
            work->is_even ? cwi_intensity_ray(work->frame, work->ranges, at[0], at[1], depth)
                          : cwi_intensity_spans(&work->field, &spans, at[0], at[1], depth);
        double color[3], opacity;
        if (spans.is_starved)
            cwi_set_flag(&work->is_starved);
        if (isnan(value))
            continue;
        cw_transfer_at(&work->frame->transfer, value, color, &opacity);
        for (int c = 0; c < 3; c++)
            pixel[c] = (float)color[c];
        pixel[3] = 1;
    }
    cwi_spans_free(&spans);
}

cw_status cwi_intensity_draw(const cwi_frame *frame, const cwi_ranges *ranges,
                             const cwi_cell_tree *tree, const double *depths,
                             cw_picture *picture, cw_error *err)
{
    job work = {.frame = frame,
                .ranges = ranges,
                .depths = depths,
                .picture = picture,
                .is_even = !cwi_volume_kind(&frame->volume)};
    cwi_field_make(frame, tree, NULL, false, &work.field);
    work.field.has_gradients = false;
    cw_status st = cwi_parallel_for(picture->height, picture->width * CWI_RAY_SAMPLES,
                                    frame->scene.threads, &frame->scene.progress, "drawing",
                                    draw_row, &work, err);
    if (st == CW_OK && work.is_starved)
        st = cwi_fail_memory(err);
    return st;
}
