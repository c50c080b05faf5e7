/* Picks the point of a volume along a ray: where half of the light is absorbed, where a
 * projection's value occurs, or on a slice. */
#include "viewer/interact/pick_volume.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/affine.h"
#include "core/geometry/cubic.h"
#include "core/geometry/vec3.h"
#include "viewer/cpu/intensity_projection.h"
#include "viewer/rays/ray_spans.h"
#include "viewer/rays/ray_traversal.h"
#include "viewer/scene/transfer_segments.h"

#include <math.h>
#include <string.h>

enum { STEPS = 8 }; /* of a piece of the ray between breakpoints */

/* State of a ray after the cells it has passed. */
typedef struct passage {
    const cwi_frame *frame;
    cwi_knots knots;
    double to_eye[3][3]; /* gradients */
    double light, half;  /* fraction of it that is left; where that became a half, or
                             INFINITY */
    double max_light,
        max_light_depth; /* the most light that a cell took, and that cell's middle */
    double half_value, max_light_value; /* of the field there */
} passage;

/* Computes the gradient's cubics in a cell, in eye space. */
static void find_gradients(const passage *p, const cwi_walk *w, double gradient[3][4])
{
    double g[3][8], cubic[3][4];
    cwi_walk_gradients(w, g);
    for (int a = 0; a < 3; a++)
        cwi_walk_cubic(w, g[a], cubic[a]);
    for (int a = 0; a < 3; a++)
        for (int n = 0; n < 4; n++)
            gradient[a][n] = p->to_eye[a][0] * cubic[0][n] + p->to_eye[a][1] * cubic[1][n] +
                             p->to_eye[a][2] * cubic[2][n];
}

static double extinction_at(const passage *p, const cwi_linear *l, const double value[4],
                            const double gradient[3][4], double x)
{
    const cwi_frame *f = p->frame;
    const double v = fmin(fmax(cwi_cubic_at(value, x), l->low), l->high) - l->origin;
    const double opacity = fmin(fmax(l->opacity + v * l->opacity_slope, 0), 1);
    const double extinction = cwi_frame_extinction(f, opacity);
    if (f->transfer.gradient_count == 0)
        return extinction;
    const double g = hypot(hypot(cwi_cubic_at(gradient[0], x), cwi_cubic_at(gradient[1], x)),
                           cwi_cubic_at(gradient[2], x));
    return extinction * cwi_frame_gradient_factor(f, g);
}

/* Passes a step of the ray, in eye space: light falls by the optical depth. */
static void pass_segment(passage *p, double from, double length, double depth)
{
    const double after = p->light * exp(-depth);
    if (p->half == INFINITY && after <= 0.5)
        p->half = from + length * fmin(log(2 * p->light) / depth, 1);
    p->light = after;
}

static void pass_piece(passage *p, const cwi_span *span, const cwi_transfer_segment *piece)
{
    const double whole = span->to - span->from, width = (piece->to - piece->from) / STEPS;
    for (int n = 0; n < STEPS && p->half == INFINITY; n++) {
        const double x = piece->from + n * width;
        const double extinction =
            extinction_at(p, piece->linear, span->value, span->gradient, x + width / 2);
        pass_segment(p, span->from + x * whole, width * whole, extinction * width * whole);
    }
    if (p->half < INFINITY)
        p->half_value = cwi_cubic_at(span->value, (p->half - span->from) / whole);
}

static void pass_span(passage *p, const cwi_span *span)
{
    cwi_transfer_segment pieces[CWI_PIECES];
    const double before = p->light;
    const size_t count = cwi_knots_cut(&p->knots, span->value, pieces);
    for (size_t n = 0; n < count && p->half == INFINITY; n++)
        if (pieces[n].linear->is_visible)
            pass_piece(p, span, &pieces[n]);
    if (before - p->light > p->max_light) {
        p->max_light = before - p->light;
        p->max_light_depth = (span->from + span->to) / 2;
        p->max_light_value = cwi_cubic_at(span->value, 0.5);
    }
}

static void pass_cell(passage *p, const cwi_walk *w)
{
    cwi_span span = {.from = w->from, .to = w->to};
    double v[8];
    if (!cwi_walk_values(w, v))
        return;
    cwi_walk_cubic(w, v, span.value);
    if (p->frame->transfer.gradient_count > 0)
        find_gradients(p, w, span.gradient);
    pass_span(p, &span);
}

/* Returns the point that is seen after a whole ray. */
static cwi_volume_hit find_hit(const passage *p)
{
    static const double MIN_SEEN = 1.0 / 512; /* half a step of what is displayed */
    const double opacity = 1 - p->light;
    const bool is_half = p->half < INFINITY;
    return (cwi_volume_hit){is_half               ? p->half
                            : opacity >= MIN_SEEN ? p->max_light_depth
                                                  : INFINITY,
                            opacity, is_half ? p->half_value : p->max_light_value};
}

cwi_volume_hit cwi_pick_blended(const cwi_frame *frame, double x, double y, double depth)
{
    passage p = {.frame = frame, .light = 1, .half = INFINITY};
    cwi_ray ray;
    cwi_walk walk;
    cwi_knots_make(&frame->transfer, &p.knots);
    cwi_frame_gradient_matrix(frame, p.to_eye);
    cwi_ray_make(frame, x, y, depth, &ray);
    for (int n = 0; n < ray.part_count; n++) {
        cwi_walk_start(&walk, frame, &ray, n);
        while (p.half == INFINITY && cwi_walk_next(&walk))
            pass_cell(&p, &walk);
    }
    cwi_volume_hit hit = find_hit(&p);
    hit.value = NAN;
    return hit;
}

/* Finds where a cubic first has a value, at an end or where it turns: the place, from 0 to 1.
 * It compares the same numbers, to the bit, from which the value was found. */
static double find_value(const double c[4], double value)
{
    double breaks[4] = {0};
    const int turns = cwi_cubic_turns(c, breaks + 1);
    breaks[turns + 1] = 1;
    for (int n = 0; n <= turns + 1; n++)
        if ((breaks[n] == 0 ? c[0] : cwi_cubic_at(c, breaks[n])) == value)
            return breaks[n];
    return INFINITY;
}

/* Finds where a cubic, which rises or falls from a to b, crosses a level, by bisection. */
static double find_crossing(const double c[4], double a, double b, double level)
{
    const bool starts_below = cwi_cubic_at(c, a) < level;
    for (int n = 0; n < 50; n++) {
        const double middle = (a + b) / 2;
        if ((cwi_cubic_at(c, middle) < level) == starts_below)
            a = middle;
        else
            b = middle;
    }
    return b;
}

/* Finds where a cubic first has a value, for a ray that counts from where it first reaches the
 * scene's threshold; is_inside: it has. */
static double find_value_inside(const cw_scene *s, const double c[4], double value,
                                bool *is_inside)
{
    double breaks[4] = {0}, before = c[0];
    const int turns = cwi_cubic_turns(c, breaks + 1);
    breaks[turns + 1] = 1;
    for (int n = 0; n <= turns + 1; n++) {
        const double now = n == 0 ? c[0] : cwi_cubic_at(c, breaks[n]);
        const bool crosses =
            (before < s->intensity.threshold) != (now < s->intensity.threshold);
        *is_inside = *is_inside || crosses || now >= s->intensity.threshold;
        if (crosses && value == s->intensity.threshold)
            return find_crossing(c, breaks[n - 1], breaks[n], value);
        if (*is_inside && now == value)
            return breaks[n];
        before = now;
    }
    return INFINITY;
}

/* Finds where a cubic of a ray shows the projection's value. */
static double find_shown(const cw_scene *s, const double c[4], double value, bool *is_inside)
{
    return s->mode == CW_MODE_MINIP && s->intensity.minip_inside
               ? find_value_inside(s, c, value, is_inside)
               : find_value(c, value);
}

static double find_in_cell(const cw_scene *s, const cwi_walk *w, double value, bool *is_inside)
{
    double v[8], c[4];
    if (!cwi_walk_values(w, v))
        return INFINITY;
    cwi_walk_cubic(w, v, c);
    return w->from + find_shown(s, c, value, is_inside) * (w->to - w->from);
}

cwi_volume_hit cwi_pick_intensity(const cwi_frame *frame, double x, double y, double depth)
{
    cwi_frame f = *frame;
    cwi_ray ray;
    cwi_walk walk;
    double t = INFINITY;
    bool is_inside = false;
    if (f.scene.mode == CW_MODE_AVERAGE)
        f.scene.mode = CW_MODE_MIP;
    const double value = cwi_intensity_ray(&f, NULL, x, y, depth);
    cwi_ray_make(&f, x, y, depth, &ray);
    for (int n = 0; n < ray.part_count && !isnan(value); n++) {
        cwi_walk_start(&walk, &f, &ray, n);
        while (t == INFINITY && cwi_walk_next(&walk))
            t = find_in_cell(&f.scene, &walk, value, &is_inside);
    }
    return (cwi_volume_hit){t, t < INFINITY, NAN};
}

/* Picks in a projection of values: the first place of its value. */
static cwi_volume_hit pick_value(cwi_field *field, cwi_spans *spans, const cwi_ray *ray,
                                 double x, double y, double depth)
{
    cwi_frame f = *field->frame;
    cwi_span span;
    double t = INFINITY;
    bool is_inside = false;
    if (f.scene.mode == CW_MODE_AVERAGE)
        f.scene.mode = CW_MODE_MIP;
    field->frame = &f;
    const double value = cwi_intensity_spans(field, spans, x, y, depth);
    bool is_under_way = !isnan(value) && cwi_spans_start(spans, field, ray);
    while (is_under_way && t == INFINITY && cwi_spans_next(spans, &span))
        t = span.from +
            find_shown(&f.scene, span.value, value, &is_inside) * (span.to - span.from);
    return (cwi_volume_hit){t, t < INFINITY, value};
}

static cwi_volume_hit pick_half(const cwi_field *field, cwi_spans *spans, const cwi_ray *ray)
{
    cwi_span span = {0};
    passage p = {.frame = field->frame, .light = 1, .half = INFINITY, .knots = *field->knots};
    const bool is_under_way = cwi_spans_start(spans, field, ray);
    while (is_under_way && p.half == INFINITY && cwi_spans_next(spans, &span))
        pass_span(&p, &span);
    return find_hit(&p);
}

cw_status cwi_pick_uneven(const cwi_frame *frame, double x, double y, double depth,
                          cwi_volume_hit *hit, cw_error *err)
{
    cwi_ray ray;
    cwi_cell_tree tree = {0};
    cwi_field field;
    cwi_knots knots;
    cwi_spans spans = {0};
    const cw_mode mode = frame->scene.mode;
    const bool is_blended =
        mode == CW_MODE_VBUFFER || mode == CW_MODE_REFERENCE || mode == CW_MODE_PROJECTION;
    *hit = (cwi_volume_hit){.t = INFINITY};
    cwi_ray_make(frame, x, y, depth, &ray);
    cw_status st = ray.part_count > 0 && frame->volume.cells
                       ? cwi_cell_tree_make(frame, &ray, &tree, err)
                       : CW_OK;
    if (st == CW_OK && tree.kinds && is_blended && frame->transfer.gradient_count > 0)
        st = cwi_cell_tree_need_gradients(frame, &tree, err);
    cwi_knots_make(&frame->transfer, &knots);
    cwi_field_make(frame, &tree, is_blended ? &knots : NULL, false, &field);
    field.has_gradients = is_blended && frame->transfer.gradient_count > 0;
    if (st == CW_OK && ray.part_count > 0)
        *hit = is_blended ? pick_half(&field, &spans, &ray)
                          : pick_value(&field, &spans, &ray, x, y, depth);
    if (st == CW_OK && spans.is_starved)
        st = cwi_fail_memory(err);
    cwi_spans_free(&spans);
    cwi_cell_tree_free(&tree);
    return st;
}
