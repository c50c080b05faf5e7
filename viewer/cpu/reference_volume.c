/* Integrates the light along a ray: dC = tau c T ds, dT = -tau T ds [Max1995], tau the
 * extinction and c the colour of the value there. A ray is cut at the faces of cells and where
 * the value meets a breakpoint of the transfer function; between cuts all functions are smooth.
 * There it uses Gauss's points: optical depth and light are the integrals of the polynomials
 * through the integrands. That is the collocation method of order 8 of [Kuntzmann1961] and
 * [Butcher1964]. A piece that differs too much from its halves is replaced by them, and so
 * on. */
#include "viewer/cpu/reference_volume.h"

#include "core/geometry/vec3.h"
#include "viewer/rays/ray_traversal.h"
#include "viewer/scene/lighting.h"

#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/geometry/cubic.h"
#include "core/volume/volume.h"

#include <math.h>
#include <string.h>

/* Tolerances of a whole ray, and of a piece, whatever its length: at a jump in the gradients'
 * factor the estimate falls only as fast as pieces get shorter. */
static const double RAY_TOLERANCE = 1e-8, PIECE_TOLERANCE = 1e-13;

/* The light at which a ray ends. */
static const double MIN_LIGHT = 1e-10;

enum { MAX_HALVINGS = 40 };

/* Returns the integral, up to x, of the polynomial that is 1 at one point and 0 at the
 * others. */
static double inner_weight(const double at[CWI_NODES], int node, double x)
{
    double p[CWI_NODES + 1] = {1}, sum = 0;
    for (int m = 0, degree = 0; m < CWI_NODES; m++) {
        if (m == node)
            continue;
        const double scale = 1 / (at[node] - at[m]);
        degree++;
        for (int n = degree; n >= 0; n--)
            p[n] = ((n > 0 ? p[n - 1] : 0) - at[m] * p[n]) * scale;
    }
    for (int n = CWI_NODES - 1; n >= 0; n--)
        sum = (sum + p[n] / (n + 1)) * x;
    return sum;
}

/* Makes the rule from the roots of Legendre's polynomial of degree 4, 35 x^4 - 30 x^2 + 3. */
static void make_rule(cwi_rule *r)
{
    const double inside = sqrt((30 - sqrt(480)) / 70), outside = sqrt((30 + sqrt(480)) / 70);
    const double roots[CWI_NODES] = {-outside, -inside, inside, outside};
    for (int n = 0; n < CWI_NODES; n++)
        r->at[n] = (1 + roots[n]) / 2;
    for (int n = 0; n < CWI_NODES; n++) {
        r->weight[n] = inner_weight(r->at, n, 1);
        for (int i = 0; i < CWI_NODES; i++)
            r->inner[i][n] = inner_weight(r->at, n, r->at[i]);
    }
}

void cwi_reference_make(const cwi_frame *frame, const cwi_cell_tree *tree, cwi_reference *r)
{
    *r = (cwi_reference){.frame = frame};
    cwi_knots_make(&frame->transfer, &r->knots);
    make_rule(&r->rule);
    cwi_frame_gradient_matrix(frame, r->to_eye);
    r->has_gradients = cwi_frame_needs_gradients(frame);
    cwi_field_make(frame, tree, &r->knots, true, &r->field);
}

/* The medium that a ray meets in a cell; x goes from 0 to 1. */
typedef struct medium {
    const cwi_reference *reference;
    const cwi_lighting *lighting;
    const double *background;
    double value[4], gradient[3][4], shadow[4]; /* cubics; gradients in eye space */
    double classes[4][4]; /* colors_first: cubics of colour times extinction, and extinction */
    double from, length, depth, depth_rise;
    const cwi_linear *linear; /* the piece's part of the transfer function */
} medium;

/* Light that came through a piece, and light that the piece adds. */
typedef struct passage {
    double color[3], depth; /* optical */
} passage;

typedef struct sum {
    double color[3], light, error;
    double tolerance; /* per length */
} sum;

static double clamp_number(double x, double low, double high)
{
    return x < low ? low : x > high ? high : x;
}

/* Classifies the field at a point: finds the colour, and returns the extinction. */
static double classify_value(const medium *m, double x, double color[3])
{
    const cwi_linear *l = m->linear;
    const double value = clamp_number(cwi_cubic_at(m->value, x), l->low, l->high) - l->origin;
    const double opacity = clamp_number(l->opacity + value * l->opacity_slope, 0, 1);
    cwi_add_scaled(l->color, value, l->color_slope, color);
    return cwi_frame_extinction(m->reference->frame, opacity);
}

/* Interpolates classified voxels at a point, as classify_value(). */
static double mix_classes(const medium *m, double x, double color[3])
{
    const double extinction = fmax(cwi_cubic_at(m->classes[3], x), 0);
    for (int c = 0; c < 3; c++)
        color[c] = extinction > 0 ? cwi_cubic_at(m->classes[c], x) / extinction : 0;
    return extinction;
}

/* Computes extinction and colour at a point. */
static double emitted_color(const medium *m, double x, double color[3])
{
    const cwi_frame *f = m->reference->frame;
    double gradient[3];
    double extinction =
        f->scene.texture.colors_first ? mix_classes(m, x, color) : classify_value(m, x, color);
    for (int a = 0; a < 3 && m->reference->has_gradients; a++)
        gradient[a] = cwi_cubic_at(m->gradient[a], x);
    if (f->transfer.gradient_count > 0)
        extinction *=
            cwi_frame_gradient_factor(f, hypot(hypot(gradient[0], gradient[1]), gradient[2]));
    if (f->scene.lit)
        cwi_lighting_shade(m->lighting, m->from + x * m->length, gradient,
                           cwi_cubic_at(m->shadow, x), color);
    const double cue = cwi_frame_cue(f, m->depth + x * m->depth_rise);
    for (int c = 0; c < 3; c++)
        color[c] = cue * color[c] + (1 - cue) * m->background[c];
    return extinction;
}

static passage pass_medium(const medium *m, double from, double to)
{
    const cwi_rule *r = &m->reference->rule;
    const double length = (to - from) * m->length;
    double extinction[CWI_NODES], color[CWI_NODES][3];
    passage p = {0};
    for (int n = 0; n < CWI_NODES; n++) {
        extinction[n] = length * emitted_color(m, from + r->at[n] * (to - from), color[n]);
        p.depth += r->weight[n] * extinction[n];
    }
    for (int n = 0; n < CWI_NODES && p.depth > 0; n++) {
        double before = 0;
        for (int i = 0; i < CWI_NODES; i++)
            before += r->inner[n][i] * extinction[i];
        const double emitted = r->weight[n] * extinction[n] * exp(-before);
        for (int c = 0; c < 3; c++)
            p.color[c] += emitted * color[n][c];
    }
    return p;
}

static passage join_passages(const passage *front, const passage *back)
{
    const double light = exp(-front->depth);
    passage p = {.depth = front->depth + back->depth};
    cwi_add_scaled(front->color, light, back->color, p.color);
    return p;
}

static double passage_difference(const passage *a, const passage *b)
{
    double max = fabs(exp(-a->depth) - exp(-b->depth));
    for (int c = 0; c < 3; c++)
        max = fmax(max, fabs(a->color[c] - b->color[c]));
    return max;
}

static void add_passage(const medium *m, double from, double to, const passage *whole,
                        int halvings, sum *s)
{
    const double middle = (from + to) / 2;
    const passage front = pass_medium(m, from, middle), back = pass_medium(m, middle, to);
    const passage both = join_passages(&front, &back);
    const double error = s->light * passage_difference(whole, &both);
    if (error > fmax(s->tolerance * (to - from) * m->length, PIECE_TOLERANCE) &&
        halvings < MAX_HALVINGS) {
        add_passage(m, from, middle, &front, halvings + 1, s);
        add_passage(m, middle, to, &back, halvings + 1, s);
        return;
    }
    for (int c = 0; c < 3; c++)
        s->color[c] += s->light * both.color[c];
    s->light *= exp(-both.depth);
    s->error += error;
}

/* The cubics of the gradient, in eye space, and of shadows. */
static void find_gradients(medium *m, const cwi_walk *w)
{
    double g[3][8], cubic[3][4], shadows[8];
    cwi_walk_shadows(w, shadows);
    cwi_walk_cubic(w, shadows, m->shadow);
    cwi_walk_gradients(w, g);
    for (int a = 0; a < 3; a++)
        cwi_walk_cubic(w, g[a], cubic[a]);
    for (int a = 0; a < 3; a++)
        for (int n = 0; n < 4; n++) {
            m->gradient[a][n] = 0;
            for (int b = 0; b < 3; b++)
                m->gradient[a][n] += m->reference->to_eye[a][b] * cubic[b][n];
        }
}

static bool is_visible(const cwi_knots *k, const double v[8])
{
    double low = v[0], high = v[0];
    for (int n = 1; n < 8; n++) {
        low = v[n] < low ? v[n] : low;
        high = v[n] > high ? v[n] : high;
    }
    return cwi_knots_is_visible(k, low, high);
}

/* Sets length and depths of a part of the ray. */
static void place_part(medium *m, double from, double to, const cwi_ray *ray)
{
    m->from = from;
    m->length = to - from;
    m->depth = -from * ray->direction[2];
    m->depth_rise = -m->length * ray->direction[2];
}

/* Adds a part of the ray on which the value is a cubic. walk: computes the gradients when they
 * are needed; NULL: they are there. */
static void add_part(medium *m, double from, double to, const cwi_ray *ray,
                     const cwi_walk *walk, sum *s)
{
    const cwi_knots *knots = &m->reference->knots;
    cwi_transfer_segment pieces[CWI_PIECES];
    bool has_gradients = !m->reference->has_gradients || !walk;
    place_part(m, from, to, ray);
    const size_t count = cwi_knots_cut(knots, m->value, pieces);
    for (size_t n = 0; n < count; n++) {
        if (!pieces[n].linear->is_visible)
            continue;
        if (!has_gradients)
            find_gradients(m, walk);
        has_gradients = true;
        m->linear = pieces[n].linear;
        const passage whole = pass_medium(m, pieces[n].from, pieces[n].to);
        add_passage(m, pieces[n].from, pieces[n].to, &whole, 0, s);
    }
}

/* Adds a cell in which the colours and extinctions of its corners are interpolated. */
static void add_classes(medium *m, const cwi_walk *w, const double v[8], const cwi_ray *ray,
                        sum *s)
{
    const cwi_frame *f = m->reference->frame;
    double corners[4][8], max = 0;
    for (int n = 0; n < 8; n++) {
        double color[3], opacity;
        cw_transfer_at(&f->transfer, v[n], color, &opacity);
        corners[3][n] = cwi_frame_extinction(f, opacity);
        for (int c = 0; c < 3; c++)
            corners[c][n] = color[c] * corners[3][n];
        max = fmax(max, corners[3][n]);
    }
    if (!(max > 0))
        return;
    for (int c = 0; c < 4; c++)
        cwi_walk_cubic(w, corners[c], m->classes[c]);
    if (m->reference->has_gradients)
        find_gradients(m, w);
    place_part(m, w->from, w->to, ray);
    const passage whole = pass_medium(m, 0, 1);
    add_passage(m, 0, 1, &whole, 0, s);
}

static void add_cell(medium *m, const cwi_walk *w, const cwi_ray *ray, sum *s)
{
    double v[8];
    if (!cwi_walk_values(w, v))
        return;
    if (m->reference->frame->scene.texture.colors_first) {
        add_classes(m, w, v, ray, s);
        return;
    }
    if (!is_visible(&m->reference->knots, v))
        return;
    cwi_walk_cubic(w, v, m->value);
    add_part(m, w->from, w->to, ray, w, s);
}

static void add_spans(medium *m, cwi_spans *spans, const cwi_ray *ray, sum *s)
{
    cwi_span span;
    if (!cwi_spans_start(spans, &m->reference->field, ray))
        return;
    while (s->light > MIN_LIGHT && cwi_spans_next(spans, &span)) {
        memcpy(m->value, span.value, sizeof m->value);
        memcpy(m->gradient, span.gradient, sizeof m->gradient);
        add_part(m, span.from, span.to, ray, NULL, s);
    }
}

/* Computes the background's colour. y is down; the background's first colour is on top. */
static void background_at(const cwi_frame *f, double y, double color[3])
{
    const double fraction = y / (double)f->scene.height;
    for (int c = 0; c < 3; c++)
        color[c] = (1 - fraction) * (double)f->scene.background[0][c] +
                   fraction * (double)f->scene.background[1][c];
}

double cwi_reference_ray(const cwi_reference *r, cwi_spans *spans, double x, double y,
                         double depth, double out[4])
{
    cwi_ray ray;
    cwi_walk walk;
    cwi_lighting lighting;
    double background[3], length = 0;
    medium m = {.reference = r, .lighting = &lighting, .background = background, .shadow = {1}};
    sum s = {.light = 1};
    cwi_ray_make(r->frame, x, y, depth, &ray);
    for (int n = 0; n < ray.part_count; n++)
        length += ray.parts[n][1] - ray.parts[n][0];
    s.tolerance = RAY_TOLERANCE / length;
    background_at(r->frame, y, background);
    cwi_lighting_make(r->frame, ray.origin, ray.direction, &lighting);
    if (cwi_volume_kind(&r->frame->volume))
        add_spans(&m, spans, &ray, &s);
    for (int n = 0; n < ray.part_count && !cwi_volume_kind(&r->frame->volume); n++) {
        cwi_walk_start(&walk, r->frame, &ray, n);
        while (s.light > MIN_LIGHT && cwi_walk_next(&walk))
            add_cell(&m, &walk, &ray, &s);
    }
    memcpy(out, s.color, sizeof s.color);
    out[3] = 1 - s.light;
    return s.error + (s.light < MIN_LIGHT ? MIN_LIGHT : 0);
}

typedef struct job {
    const cwi_reference *reference;
    const double *depths;
    cw_picture *picture;
    double *errors; /* of each row, the largest */
    bool is_starved;
} job;

static void draw_row(void *context, size_t y)
{
    job *work = context;
    const size_t width = work->picture->width;
    cwi_spans spans = {0};
    work->errors[y] = 0;
    for (size_t x = 0; x < width; x++) {
        double out[4];
        const double depth = work->depths ? work->depths[y * width + x] : INFINITY;
        const double error = cwi_reference_ray(work->reference, &spans, (double)x + 0.5,
                                               (double)y + 0.5, depth, out);
        work->errors[y] = fmax(work->errors[y], error);
        for (size_t c = 0; c < 4; c++)
            work->picture->pixels[4 * (y * width + x) + c] = (float)out[c];
        if (spans.is_starved)
            cwi_set_flag(&work->is_starved);
    }
    cwi_spans_free(&spans);
}

cw_status cwi_reference_draw(const cwi_frame *frame, const cwi_cell_tree *tree,
                             const double *depths, cw_picture *picture, double *estimate,
                             cw_error *err)
{
    cwi_reference reference;
    double *errors = cwi_alloc_zeroed(picture->height, sizeof *errors);
    if (!errors)
        return cwi_fail_memory(err);
    cwi_reference_make(frame, tree, &reference);
    job work = {&reference, depths, picture, errors, false};
    cw_status st = cwi_parallel_for(picture->height, picture->width * CWI_RAY_SAMPLES,
                                    frame->scene.threads, &frame->scene.progress, "drawing",
                                    draw_row, &work, err);
    if (st == CW_OK && work.is_starved)
        st = cwi_fail_memory(err);
    double max = 0;
    for (size_t y = 0; y < picture->height; y++)
        max = fmax(max, errors[y]);
    if (estimate)
        *estimate = max;
    cwi_free(errors);
    return st;
}
