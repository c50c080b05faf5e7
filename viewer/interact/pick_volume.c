/* Picks the point of a volume along a ray: where half of the light is absorbed, where a
 * projection's value occurs, or on a slice. */
#include "viewer/interact/pick_volume.h"

#include "core/geometry/affine.h"
#include "core/geometry/cubic.h"
#include "core/geometry/vec3.h"
#include "viewer/cpu/intensity_projection.h"
#include "viewer/cpu/ray_traversal.h"
#include "viewer/scene/transfer_segments.h"

#include <math.h>
#include <string.h>

enum { STEPS = 8 }; /* of a piece of the ray between breakpoints */

/* State of a ray after the cells it has passed. */
typedef struct passage {
    const cwi_frame *frame;
    cwi_knots knots;
    double to_eye[3][3];  /* gradients */
    double light, half;   /* fraction of it that is left; where that became a half, or
                             INFINITY */
    double most, most_at; /* the most light that a cell took, and that cell's middle */
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
    return extinction * cw_transfer_gradient_factor(&f->transfer, g / f->unit_mm);
}

/* Passes a step of the ray, in eye space: light falls by the optical depth. */
static void pass_segment(passage *p, double from, double length, double depth)
{
    const double after = p->light * exp(-depth);
    if (p->half == INFINITY && after <= 0.5)
        p->half = from + length * fmin(log(2 * p->light) / depth, 1);
    p->light = after;
}

static void pass_piece(passage *p, const cwi_walk *w, const cwi_transfer_segment *piece,
                       const double value[4], const double gradient[3][4])
{
    const double whole = w->to - w->from, width = (piece->to - piece->from) / STEPS;
    for (int n = 0; n < STEPS && p->half == INFINITY; n++) {
        const double x = piece->from + n * width;
        const double extinction =
            extinction_at(p, piece->linear, value, gradient, x + width / 2);
        pass_segment(p, w->from + x * whole, width * whole, extinction * width * whole);
    }
}

static void pass_cell(passage *p, const cwi_walk *w)
{
    double v[8], value[4], gradient[3][4] = {{0}}; /* read for factors of gradients alone */
    cwi_transfer_segment pieces[CWI_PIECES];
    const double before = p->light;
    if (!cwi_walk_values(w, v))
        return;
    cwi_walk_cubic(w, v, value);
    if (p->frame->transfer.gradient_count > 0)
        find_gradients(p, w, gradient);
    const size_t count = cwi_knots_cut(&p->knots, value, pieces);
    for (size_t n = 0; n < count; n++)
        if (pieces[n].linear->is_visible)
            pass_piece(p, w, &pieces[n], value, (const double(*)[4])gradient);
    if (before - p->light > p->most) {
        p->most = before - p->light;
        p->most_at = (w->from + w->to) / 2;
    }
}

cwi_volume_hit cwi_pick_blended(const cwi_frame *frame, double x, double y, double depth)
{
    static const double seen = 1.0 / 512; /* half a step of what is displayed */
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
    const double opacity = 1 - p.light;
    return (cwi_volume_hit){p.half < INFINITY ? p.half
                            : opacity >= seen ? p.most_at
                                              : INFINITY,
                            opacity};
}

/* Finds where the field first has a value in a cell, at an end or where it turns. It compares
 * the same numbers, to the bit, from which the value was found. */
static double find_value(const cwi_walk *w, double value)
{
    double v[8], c[4], places[4] = {0};
    if (!cwi_walk_values(w, v))
        return INFINITY;
    cwi_walk_cubic(w, v, c);
    const int turns = cwi_cubic_turns(c, places + 1);
    places[turns + 1] = 1;
    for (int n = 0; n <= turns + 1; n++)
        if ((places[n] == 0 ? c[0] : cwi_cubic_at(c, places[n])) == value)
            return w->from + places[n] * (w->to - w->from);
    return INFINITY;
}

cwi_volume_hit cwi_pick_intensity(const cwi_frame *frame, double x, double y, double depth)
{
    cwi_frame f = *frame;
    cwi_ray ray;
    cwi_walk walk;
    double t = INFINITY;
    if (f.scene.mode == CW_MODE_AVERAGE)
        f.scene.mode = CW_MODE_MIP;
    const double value = cwi_intensity_ray(&f, NULL, x, y, depth);
    cwi_ray_make(&f, x, y, depth, &ray);
    for (int n = 0; n < ray.part_count && !isnan(value); n++) {
        cwi_walk_start(&walk, &f, &ray, n);
        while (t == INFINITY && cwi_walk_next(&walk))
            t = find_value(&walk, value);
    }
    return (cwi_volume_hit){t, t < INFINITY};
}

/* Returns true if a point of a slice has a value. Slices in a face of the volume, or in a clip
 * plane, are drawn: they get some tolerance. */
static bool has_value(const cwi_frame *f, const double p[3])
{
    static const double slack = 1e-3;
    double index[3], world[3];
    bool kept = true;
    cwi_affine_apply(f->index_from_eye, p, index);
    for (int a = 0; a < 3; a++) {
        if (!(index[a] >= f->low[a] - slack && index[a] <= f->high[a] + slack))
            return false;
        index[a] = fmin(fmax(index[a], f->low[a]), f->high[a]);
    }
    for (size_t n = 0; n < f->scene.clip_count; n++)
        kept = kept &&
               cwi_dot(f->clips[n], p) >= f->clips[n][3] + (f->scene.cut_away ? slack : -slack);
    if (f->scene.clip_count > 0 && kept == f->scene.cut_away)
        return false;
    cw_volume_to_world(&f->volume, index, world);
    return !isnan(cw_volume_sample(&f->volume, world));
}

double cwi_pick_slice(const cwi_frame *f, const cw_slice *slices, size_t count,
                      const double origin[3], const double direction[3], size_t *number)
{
    double nearest = INFINITY;
    for (size_t n = 0; n < count; n++) {
        double normal[3], p[3];
        for (int a = 0; a < 3; a++)
            normal[a] = cwi_dot(f->axes[a], slices[n].normal);
        const double distance =
            (slices[n].distance_mm - cwi_dot(slices[n].normal, f->eye_mm)) / f->unit_mm;
        const double slope = cwi_dot(normal, direction);
        const double t = (distance - cwi_dot(normal, origin)) / slope;
        for (int a = 0; a < 3; a++)
            p[a] = origin[a] + t * direction[a];
        if (!(fabs(slope) >= 1e-6 && t < nearest && -p[2] >= f->near) || !has_value(f, p))
            continue;
        nearest = t;
        *number = n;
    }
    return nearest;
}
