/* Gathers light along beams. The V-buffer [Upson1988] projects a pixel's area on the cell; where
 * the cell is smaller, it takes the mean over the cell, weighted by the ratio of areas. Here a
 * pixel is cut into 4 x 4 beams, which take samples at different positions of steps that are a part
 * of the pixel's width: the samples are spread over the area and along it. A beam that is much
 * wider than a cell meets mean cells, with the transfer function averaged over their values,
 * taken as evenly spread about the mean by the variance. Where a plane of the volume's box or a
 * clip crosses a beam, only a part of its area is filled. */
#include "viewer/cpu/pixel_beam.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/vec3.h"
#include "core/volume/volume.h"

#include <math.h>
#include <string.h>

typedef cwi_lanes lanes;

/* Beams along each side of a pixel that covers more than a cell. */
enum { SIDES = 4 };

/* The width of the mean cells that a beam takes, over its own: interpolation between them widens
 * them, and means make silhouettes of opaque things wider. */
static const double CELL_WIDTH = 0.25;

/* The length of a beam's steps, over the pixel's width. Beams of a pixel take samples at
 * different positions of their steps. */
static const double STEP = 0.3;

/* The optical depth of a step above which it is halved, and the shortest part of a step. */
static const double MAX_DEPTH = 0.5, MIN_PART = 0.25;

/* --- preparation --------------------------------------------------------------------------- */

/* Adds up the colours times opacity, and the opacity, that rows of the table have over a length
 * of the ray: each row counts for half a row around it. */
static cw_status make_integrals(const cwi_table *t, double length, double (**out)[4],
                                cw_error *err)
{
    double(*sum)[4] = cwi_alloc_zeroed(t->count + 1, sizeof *sum);
    *out = sum;
    if (!sum)
        return cwi_fail_memory(err);
    for (size_t n = 0; n < t->count; n++) {
        const float *row = t->rows + 4 * n;
        const double opacity = -expm1(-(double)row[3] * length);
        for (int c = 0; c < 3; c++)
            sum[n + 1][c] = sum[n][c] + opacity * (double)row[c];
        sum[n + 1][3] = sum[n][3] + opacity;
    }
    return CW_OK;
}

static void find_planes(cwi_beams *b)
{
    const cwi_frame *f = b->frame;
    for (size_t a = 0; a < 3; a++) {
        const double *m = f->index_from_eye + 4 * a;
        const double length = cwi_length(m);
        for (int side = 0; side < 2; side++) {
            double *p = b->planes[b->plane_count++];
            for (int c = 0; c < 3; c++)
                p[c] = (side ? -m[c] : m[c]) / length;
            p[3] = (side ? m[3] - f->high[a] : f->low[a] - m[3]) / length;
        }
    }
    for (size_t n = 0; n < f->scene.clip_count; n++)
        memcpy(b->planes[b->plane_count++], f->clips[n], sizeof f->clips[n]);
}

/* Returns the width of a pixel: at any depth, or in perspective per depth. */
static double pixel_width(const cwi_frame *f)
{
    return 2 * f->half[1] / (double)f->scene.height;
}

bool cwi_beams_need_means(const cwi_frame *f)
{
    return pixel_width(f) * (f->perspective ? f->far : 1) * CELL_WIDTH > SIDES;
}

bool cwi_beams_are_wide(const cwi_frame *f)
{
    return pixel_width(f) * (f->perspective ? f->far : 1) > 1;
}

cw_status cwi_beams_make(const cwi_frame *f, const cwi_ranges *ranges, const uint8_t *distances,
                         const cwi_cell_corners *corners, const cwi_mean_cells *cells,
                         const cwi_table *table, cwi_beams *b, cw_error *err)
{
    cw_status st = CW_OK;
    *b = (cwi_beams){.frame = f,
                     .ranges = ranges,
                     .distances = distances,
                     .corners = corners,
                     .cells = cells};
    b->sides = cwi_beams_are_wide(f) ? SIDES : 1;
    b->width[f->perspective] = pixel_width(f) / (double)b->sides;
    b->step = STEP * (double)b->sides;
    b->table = table;
    b->start = f->perspective ? 1 / pixel_width(f) : -INFINITY;
    cwi_frame_gradient_matrix(f, b->to_eye);
    const double scale = (double)(table->count - 1) / (table->high - table->low);
    b->row_scale = cells ? (float)(cells->scale * scale) : 1;
    b->row_bias = cells ? (float)((cells->origin - table->low) * scale) : 0;
    b->value_scale = 1 / scale;
    b->has_gradients = cwi_frame_needs_gradients(f);
    cwi_cell_corners_make(&f->gradient_volume, table, &b->gradient_corners);
    find_planes(b);
    for (; cells && b->level_count < cells->level_count && st == CW_OK; b->level_count++)
        st = make_integrals(table, (double)((uint64_t)1 << b->level_count),
                            &b->integrals[b->level_count], err);
    if (st != CW_OK)
        cwi_beams_free(b);
    return st;
}

void cwi_beams_free(cwi_beams *b)
{
    for (size_t n = 0; n < CWI_MEAN_LEVELS; n++)
        cwi_free(b->integrals[n]);
    *b = (cwi_beams){0};
}

/* --- the area that is filled --------------------------------------------------------------- */

/* A plane along a beam: the distance of its middle from the plane, and half the reach of its
 * area towards it along both axes of the picture, each with their rise along the ray. */
typedef struct plane_cut {
    double at, slope, reach[2], reach_slope[2];
} plane_cut;

/* A beam under way. The area not yet met, that met and left again, and that in the volume each
 * have the light that goes through them. */
typedef struct beam {
    const cwi_beams *b;
    const cwi_ray *ray;
    double width[2]; /* along the ray */
    plane_cut cuts[CWI_BEAM_PLANES];
    double whole[2]; /* the part of the ray on which the area is all in the volume */
    double area, waiting, left;
    double light, waiting_light, left_light;
} beam;

/* Finds the cuts, and the part of the ray on which some of the area may be filled. */
static void cut_beam(beam *m, double t[2])
{
    const cwi_beams *b = m->b;
    const bool cuts_away = b->frame->scene.cut_away;
    for (size_t n = 0; n < b->plane_count; n++) {
        const double *p = b->planes[n];
        plane_cut *c = &m->cuts[n];
        c->at = cwi_dot(p, m->ray->origin) - p[3];
        c->slope = cwi_dot(p, m->ray->direction);
        for (int a = 0; a < 2; a++) {
            c->reach[a] = fabs(p[a]) / 2 * m->width[0];
            c->reach_slope[a] = fabs(p[a]) / 2 * m->width[1];
        }
        const double reach = c->reach[0] + c->reach[1],
                     rise = c->reach_slope[0] + c->reach_slope[1];
        if (n < 6 || !cuts_away)
            cwi_cut_interval(c->at + reach, c->slope + rise, t);
        cwi_cut_interval(c->at - reach, c->slope - rise, m->whole);
    }
    if (cuts_away && b->plane_count > 6)
        m->whole[1] = -INFINITY;
}

/* Returns the share of a step of the beam that is on a plane's inner side. The step is a box;
 * of its three reaches towards the plane, the two shorter ones are taken as one. */
static double fraction_inside(const plane_cut *c, double t, double step)
{
    double reach[3], all = 0, max = 0;
    for (int a = 0; a < 2; a++)
        reach[a] = c->reach[a] + t * c->reach_slope[a];
    reach[2] = fabs(c->slope) * step / 2;
    for (int a = 0; a < 3; a++) {
        all += reach[a];
        max = fmax(max, reach[a]);
    }
    const double d = c->at + t * c->slope, rest = all - max;
    const double big = fmax(max, rest), small = fmin(max, rest);
    if (fabs(d) >= all)
        return d > 0;
    if (fabs(d) <= big - small)
        return 0.5 + d / (2 * big);
    const double corner = (all - fabs(d)) * (all - fabs(d)) / (8 * big * small);
    return d > 0 ? 1 - corner : corner;
}

/* Returns the share of the area that is filled. */
static double filled_area(const beam *m, double t, double step)
{
    double box = 1, clips = 1;
    if (t - step / 2 >= m->whole[0] && t + step / 2 <= m->whole[1])
        return 1;
    for (size_t n = 0; n < m->b->plane_count; n++)
        *(n < 6 ? &box : &clips) *= fraction_inside(&m->cuts[n], t, step);
    return m->b->frame->scene.cut_away && m->b->plane_count > 6 ? box * (1 - clips)
                                                                : box * clips;
}

/* Moves light between the area in the volume and those before and behind it. */
static void fill_area(beam *m, double area)
{
    if (area > m->area) {
        double more = area - m->area;
        const double fresh = fmin(more, m->waiting);
        if (fresh > 0) {
            const double moved = m->waiting_light * fresh / m->waiting;
            m->waiting -= fresh;
            m->waiting_light -= moved;
            m->light += moved;
            more -= fresh;
        }
        if (more > 0 && m->left > 0) {
            const double moved = m->left_light * fmin(more / m->left, 1);
            m->left -= fmin(more, m->left);
            m->left_light -= moved;
            m->light += moved;
        }
    } else if (area < m->area) {
        const double moved = m->light * (m->area - area) / m->area;
        m->left += m->area - area;
        m->left_light += moved;
        m->light -= moved;
    }
    m->area = area;
}

/* --- samples ------------------------------------------------------------------------------- */

/* A position among mean cells: the eight around it, and its weights between them. */
typedef struct cell_weights {
    size_t cell[8];
    float weight[8];
} cell_weights;

static void find_weights(const cwi_mean_level *l, const cw_volume *v, const double index[3],
                         cell_weights *p)
{
    size_t low[3], high[3];
    float at[3];
    const size_t stride[3] = {1, l->dim[0], l->dim[0] * l->dim[1]};
    for (int a = 0; a < 3; a++) {
        const double x = index[a] + (v->dim[a] > 1 ? 0 : 0.5);
        const double max = (double)(l->dim[a] - 1);
        double q = ldexp(x, -l->shift[a]) - 0.5;
        q = q > 0 ? q < max ? q : max : 0;
        const size_t n = (size_t)q;
        at[a] = (float)(q - (double)n);
        low[a] = n * stride[a];
        high[a] = (n + (n + 1 < l->dim[a])) * stride[a];
    }
    for (int n = 0; n < 8; n++) {
        p->cell[n] = (n & 1 ? high[0] : low[0]) + (n & 2 ? high[1] : low[1]) +
                     (n & 4 ? high[2] : low[2]);
        p->weight[n] = (n & 1 ? at[0] : 1 - at[0]) * (n & 2 ? at[1] : 1 - at[1]) *
                       (n & 4 ? at[2] : 1 - at[2]);
    }
}

static lanes interpolate(const float (*cells)[4], const cell_weights *p)
{
    lanes sum = {0};
    for (int n = 0; n < 8; n++)
        sum += p->weight[n] * cwi_lanes_load(cells[p->cell[n]]);
    return sum;
}

/* Interpolates the field at a position, as a row of the table. Returns false where it has no
 * value. */
static bool row_at(const cwi_cell_corners *corners, const double index[3], float *row)
{
    const cw_volume *v = corners->volume;
    const char *first = v->data;
    float at[3];
    lanes even, odd;
    for (int a = 0; a < 3; a++) {
        const double max = v->dim[a] > 1 ? (double)v->dim[a] - 2 : 0, x = index[a];
        const ptrdiff_t cell = (ptrdiff_t)(x > 0 ? x < max ? x : max : 0);
        const float inside = v->dim[a] > 1 ? (float)(x - (double)cell) : 0;
        first += cell * v->stride[a];
        at[a] = inside > 0 ? inside < 1 ? inside : 1 : 0;
    }
    if (!corners->fetch(corners, first, &even, &odd))
        return false;
    const lanes line = even + at[0] * (odd - even);
    const float low = line[0] + at[1] * (line[1] - line[0]),
                high = line[2] + at[1] * (line[3] - line[2]);
    *row = low + at[2] * (high - low);
    return true;
}

/* Takes the gradient of the field at a position, in rows per voxel: by the cells on both sides.
 * Linear interpolation of central differences is the same. */
static lanes gradient_at(const cwi_cell_corners *corners, const double index[3])
{
    lanes gradient = {0};
    for (int a = 0; a < 3; a++) {
        const double last = (double)corners->volume->dim[a] - 1;
        double p[3] = {index[0], index[1], index[2]};
        float low, high;
        const double from = fmax(index[a] - 1, 0), to = fmin(index[a] + 1, last);
        p[a] = from;
        bool is_whole = to > from && row_at(corners, p, &low);
        p[a] = to;
        is_whole = is_whole && row_at(corners, p, &high);
        gradient[a] = is_whole ? (high - low) / (float)(to - from) : 0;
    }
    return gradient;
}

/* Takes moments and gradient of the field itself. */
static void sample_field(const beam *m, const double index[3], lanes *moments, lanes *gradient)
{
    const float scale = 1 / m->b->row_scale;
    float row;
    *moments = *gradient = (lanes){0};
    if (!row_at(m->b->corners, index, &row))
        return;
    const float value = (row - m->b->row_bias) * scale;
    *moments = (lanes){1, value, value * value, 0};
    if (m->b->has_gradients)
        *gradient = scale * gradient_at(m->b->corners, index);
}

/* Takes moments and gradient at a position, between two levels. */
static void sample_levels(const beam *m, const double index[3], size_t level, float blend,
                          lanes *moments, lanes *gradient)
{
    const cwi_mean_cells *cells = m->b->cells;
    lanes found[2][2] = {0};
    for (size_t n = 0; n < 2; n++) {
        const cwi_mean_level *l = &cells->levels[level + n];
        cell_weights p;
        if ((n ? blend : 1 - blend) == 0)
            continue;
        if (level + n == 0) {
            sample_field(m, index, &found[n][0], &found[n][1]);
            continue;
        }
        find_weights(l, m->b->corners->volume, index, &p);
        found[n][0] = interpolate((const float(*)[4])l->moments, &p);
        if (l->gradients)
            found[n][1] = interpolate((const float(*)[4])l->gradients, &p);
    }
    *moments = found[0][0] + blend * (found[1][0] - found[0][0]);
    *gradient = found[0][1] + blend * (found[1][1] - found[0][1]);
}

static void integral_at(const double (*sum)[4], double row, double out[4])
{
    const double at = row + 0.5, max = CWI_TABLE_ROWS - 1;
    const size_t n = (size_t)(at > 0 ? at < max ? at : max : 0);
    for (int c = 0; c < 4; c++)
        out[c] = sum[n][c] + (at - (double)n) * (sum[n + 1][c] - sum[n][c]);
}

/* Averages the transfer function over values spread evenly about a mean: colours times
 * opacity, and opacity, over a step of a level. */
static lanes average_function(const cwi_beams *b, size_t level, lanes moments)
{
    const float mean = moments[1] / moments[0];
    const float variance = moments[2] / moments[0] - mean * mean;
    const double row = (double)(mean * b->row_scale + b->row_bias);
    const double half =
        fmax(sqrt(3 * (double)fmaxf(variance, 0)) * (double)fabsf(b->row_scale), 0.5);
    const double(*sum)[4] = (const double(*)[4])b->integrals[level];
    double low[4], high[4];
    integral_at(sum, row - half, low);
    integral_at(sum, row + half, high);
    lanes glow;
    for (int c = 0; c < 4; c++)
        glow[c] = (float)((high[c] - low[c]) / (2 * half));
    return glow;
}

/* A step of the beam, and the levels that its sample is taken from. */
typedef struct step {
    double at, length; /* its middle */
    size_t level;
    float blend;
} step;

/* A sample: its colours, its optical depth over the step, and the moments of mean cells. */
typedef struct found {
    double index[3];
    lanes color, gradient;
    double depth;
} found;

/* Takes a sample of the field itself. */
static void sample_point(const beam *m, const step *s, found *f)
{
    const cwi_beams *b = m->b;
    const float max = (float)(CWI_TABLE_ROWS - 1);
    float row;
    if (!row_at(b->corners, f->index, &row))
        return;
    row = row > 0 ? row < max ? row : max : 0;
    int32_t n = (int32_t)row;
    n = n > CWI_TABLE_ROWS - 2 ? CWI_TABLE_ROWS - 2 : n;
    const lanes low = cwi_lanes_load(b->table->rows + 4 * n),
                high = cwi_lanes_load(b->table->rows + 4 * n + 4);
    f->color = low + (row - (float)n) * (high - low);
    f->depth = (double)f->color[3] * s->length;
}

/* Takes a sample of mean cells, and its gradient. */
static void sample_means(const beam *m, const step *s, found *f)
{
    const cwi_beams *b = m->b;
    lanes moments;
    sample_levels(m, f->index, s->level, s->blend, &moments, &f->gradient);
    if (!(moments[0] > 0))
        return;
    f->color = average_function(b, s->level, moments);
    const float opacity = f->color[3];
    if (!(opacity > 1e-7f))
        return;
    f->color /= opacity;
    f->gradient *= b->row_scale / moments[0];
    f->depth = -log1p(-fmin((double)(opacity * fminf(moments[0], 1)), CWI_MAX_OPACITY)) *
               s->length / (double)((uint64_t)1 << s->level);
}

/* Takes the sample of a step. */
static void take_sample(const beam *m, const step *s, found *f)
{
    *f = (found){.depth = 0};
    cwi_add_scaled(m->ray->index, s->at, m->ray->slope, f->index);
    if (s->level == 0 && s->blend == 0)
        sample_point(m, s, f);
    else
        sample_means(m, s, f);
}

/* Passes a step of the beam by its sample. */
static void pass_step(beam *m, const step *s, found *f, cwi_beam_shade *shade, void *context,
                      lanes *color)
{
    const cwi_beams *b = m->b;
    double g[3];
    /* mean cells have the gradients of the volume itself */
    if (b->has_gradients && (b->frame->gradient_version || (s->level == 0 && s->blend == 0)))
        f->gradient = gradient_at(&b->gradient_corners, f->index);
    for (int r = 0; r < 3; r++)
        g[r] = cwi_dot(b->to_eye[r], (double[3]){(double)f->gradient[0], (double)f->gradient[1],
                                                 (double)f->gradient[2]}) *
               b->value_scale;
    f->color[3] = (float)f->depth;
    shade(context, s->at, g, &f->color);
    const double left = (double)cwi_lanes_fade(cwi_lanes_spread(f->color[3]))[0];
    *color += (float)(m->light * (1 - left)) * f->color;
    m->light *= left;
}

/* Chooses the levels for a width of the beam. */
static void choose_level(const cwi_beams *b, double wide, step *s)
{
    if (b->level_count < 2 || wide * CELL_WIDTH <= 1)
        return;
    const double level = fmin(log2(wide * CELL_WIDTH), (double)(b->level_count - 1));
    s->level = (size_t)level;
    s->blend = (float)(level - (double)s->level);
}

/* Returns how far the beam may go from a position without meeting anything visible. level:
 * of the mean cells around it */
static double empty_length(const beam *m, double t, size_t level)
{
    const cwi_beams *b = m->b;
    const cw_volume *v = b->corners->volume;
    size_t block = 0;
    double shortest = INFINITY;
    int max = 0;
    for (int a = 2; a >= 0; a--) {
        const double last = v->dim[a] > 1 ? (double)v->dim[a] - 2 : 0;
        double cell = m->ray->index[a] + t * m->ray->slope[a];
        cell = cell > 0 ? cell < last ? cell : last : 0;
        block = block * b->ranges->dim[a] + (size_t)cell / CWI_RANGE_EDGE;
        const int reach = level > 0 ? (3 << b->cells->levels[level].shift[a]) / 2 + 1 : 0;
        max = reach > max ? reach : max;
    }
    const double free = (double)((int)b->distances[block] - 1) * CWI_RANGE_EDGE - max;
    for (int a = 0; a < 3 && free > 0; a++)
        if (m->ray->slope[a] != 0)
            shortest = fmin(shortest, free / fabs(m->ray->slope[a]));
    return free > 0 ? shortest : 0;
}

void cwi_beam_pass(const cwi_beams *b, const cwi_ray *ray, double depth, double offset,
                   cwi_beam_shade *shade, void *context, cwi_lanes *color, float *light)
{
    const cwi_frame *f = b->frame;
    const double forward = -ray->direction[2],
                 min_light = 1 - (double)f->scene.sampling.stop_opacity;
    double t[2] = {fmax(b->start, f->perspective ? f->near : -INFINITY) / forward,
                   depth / forward};
    beam m = {.b = b,
              .ray = ray,
              .width = {b->width[0], b->width[1] * forward},
              .whole = {-INFINITY, INFINITY},
              .waiting = 1,
              .waiting_light = (double)*light};
    cut_beam(&m, t);
    double part = 1, first = offset;
    bool is_visible = false;
    for (double at = t[0]; at < t[1] && m.light + m.waiting_light + m.left_light > min_light;) {
        const double wide = m.width[0] + at * m.width[1];
        step s = {0};
        choose_level(b, wide, &s);
        const double empty = is_visible ? 0 : empty_length(&m, at, s.level + (s.blend > 0));
        if (empty > 0) {
            at += empty;
            continue;
        }
        found sample;
        for (;; part /= 2) {
            s.length = fmin(first * part * b->step * wide, t[1] - at);
            s.at = at + s.length / 2;
            take_sample(&m, &s, &sample);
            if (sample.depth <= MAX_DEPTH || part <= MIN_PART)
                break;
        }
        first = 1;
        fill_area(&m, filled_area(&m, s.at, s.length));
        is_visible = sample.depth > 0;
        if (m.area > 0 && is_visible)
            pass_step(&m, &s, &sample, shade, context, color);
        if (part < 1 && sample.depth < MAX_DEPTH / 4)
            part *= 2;
        at += s.length;
    }
    *light = (float)(m.light + m.waiting_light + m.left_light);
}
