/* Casts rays cell by cell; the V-buffer [Upson1988] went through the picture cell by cell. In a
 * cell it takes Gauss's two points, four values at a time: the trilinear field at both ends of
 * the cell and at both points. If these show that the transfer function has a breakpoint
 * between them, or that the cell takes much of the light, the cell is cut, as in the reference.
 * Other cells are passed in batches of four. Blocks of cells that the transfer function leaves
 * empty are skipped. Grids that are not evenly spaced are always cut as in the reference, and
 * take two points of each piece. */
#include "viewer/cpu/vbuffer.h"

#include "viewer/cpu/cell_batch.h"
#include "viewer/cpu/pixel_beam.h"
#include "viewer/rays/cell_corners.h"
#include "viewer/rays/lanes.h"
#include "viewer/rays/ray_spans.h"
#include "viewer/rays/ray_traversal.h"
#include "viewer/scene/lighting.h"
#include "viewer/scene/transfer_segments.h"
#include "viewer/scene/transfer_table.h"

#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/geometry/cubic.h"
#include "core/geometry/vec3.h"
#include "core/volume/volume.h"

#include <math.h>
#include <string.h>

typedef cwi_lanes lanes;

/* The way to a point takes this fraction of the value at the other point:
 * 1/4 -+ sqrt(3) / 6. */
static const float TO_FIRST = -0.038675134594812866f, TO_SECOND = 0.53867513459481287f;

/* Maximum optical depth for which two points are enough. */
static const float MAX_DEPTH = 0.5f;

/* The maximum difference of the extinction at two points of a piece, times the piece's
 * length. */
static const float MAX_STEEPNESS = 0.1f;

/* The maximum difference of the two points, where gradients count. */
static const float MAX_TURN = 2e-3f;

typedef struct vbuffer vbuffer;

/* For each row of the table, and the values below the first and above the last, the lowest and
 * the highest part of the transfer function that its values have. */
typedef struct row_parts {
    uint8_t low, high;
} row_parts;

struct vbuffer {
    const cwi_frame *frame;
    const cwi_ranges *ranges;
    const double *depths;
    cw_picture *picture;
    cwi_table table;
    cwi_knots knots;
    row_parts parts[CWI_TABLE_ROWS + 1];
    uint8_t *distances; /* of blocks to visible ones */
    cwi_cell_corners corners;
    double per_opacity_unit; /* 1 / the length that opacities refer to */
    double to_eye[3][3];
    cwi_cell_corners gradient_corners; /* of the frame's gradient volume */
    double row_value;                  /* difference of the values of two rows */
    float rows_to_eye[3][3];           /* to_eye, in single precision */
    bool has_gradients;
    bool is_even;
    cwi_field field; /* of a grid that is not even */
    cwi_beams beams;
    bool has_beams;
    bool is_starved;
};

/* One ray under way. */
typedef struct state {
    const vbuffer *b;
    const cwi_lighting *lighting;
    cwi_ray ray;
    cwi_walk walk;
    float slope[3]; /* the ray's, in index space */
    cwi_batch_scene scene;
    cwi_cell_batch batch;
    lanes colors[3]; /* sent by cells of batches, a sum in each lane */
    lanes color;
    float light;
    float background[3];
    bool has_gradient;     /* of a cell in pieces: */
    double gradient[3][4]; /* cubics, eye space */
    double shadow[4];      /* cubic; the constant 1 without shadows */
} state;

/* Returns the distance along the ray of a position in the cell, 0 to 1. */
static inline double distance_at(const state *s, double x)
{
    return s->walk.from + x * (s->walk.to - s->walk.from);
}

static void change_by_gradient(const state *s, double x, const double gradient[3], lanes *glow)
{
    const cwi_frame *f = s->b->frame;
    double color[3] = {(double)(*glow)[0], (double)(*glow)[1], (double)(*glow)[2]};
    if (f->transfer.gradient_count > 0)
        (*glow)[3] *= (float)cwi_frame_gradient_factor(f, cwi_length(gradient));
    if (f->scene.lit) {
        cwi_lighting_shade(s->lighting, distance_at(s, x), gradient, cwi_cubic_at(s->shadow, x),
                           color);
        for (int a = 0; a < 3; a++)
            (*glow)[a] = (float)color[a];
    }
}

static void change_by_depth(const state *s, double x, lanes *glow)
{
    const double t = distance_at(s, x);
    const float cue = (float)cwi_frame_cue(s->b->frame, -t * s->ray.direction[2]);
    for (int c = 0; c < 3; c++)
        (*glow)[c] = cue * (*glow)[c] + (1 - cue) * s->background[c];
}

/* Changes the glow of a point, as the transfer function gave it, by gradient and depth. x: its
 * position in the cell, 0 to 1; gradient: in eye space, if it is needed */
static inline lanes finish_cell(const state *s, double x, const double gradient[3], lanes glow)
{
    if (s->b->has_gradients)
        change_by_gradient(s, x, gradient, &glow);
    if (s->b->frame->scene.depth_cue > 0)
        change_by_depth(s, x, &glow);
    return glow;
}

/* Interpolates the shadows at a distance along the ray. */
static double shadow_at(state *s, double at)
{
    double shadows[8], cubic[4];
    cwi_walk *w = &s->walk;
    const cw_volume *v = &s->b->frame->volume;
    w->volume = v;
    w->shadows = s->b->frame->shadows;
    for (int a = 0; a < 3; a++) {
        const double position = s->ray.index[a] + at * s->ray.slope[a];
        w->index[a] = s->ray.index[a];
        w->slope[a] = s->ray.slope[a];
        w->at[a] = (ptrdiff_t)fmin(fmax(position, 0), fmax((double)v->dim[a] - 2, 0));
    }
    cwi_walk_shadows(w, shadows);
    cwi_walk_cubic(w, shadows, cubic);
    return fmin(fmax(cubic[0], 0), 1);
}

/* Shades a sample of a beam, at a distance along the ray. */
static void shade_beam(void *context, double at, const double gradient[3], lanes *glow)
{
    state *s = context;
    s->walk.from = s->walk.to = at;
    if (s->b->frame->shadows)
        s->shadow[0] = shadow_at(s, at);
    *glow = finish_cell(s, 0, gradient, *glow);
}

/* Passes a segment of a length by the values at its two points. Its opacity is that of its
 * optical depth, which is more exact than the sum over the points alone; the points give the
 * colour. */
static inline void pass_segment(state *s, lanes first, lanes second, float length)
{
    const float a = first[3] * length, b = second[3] * length;
    const lanes depths = {0.25f * a + TO_FIRST * b, TO_SECOND * a + 0.25f * b, 0.5f * (a + b),
                          0};
    const lanes left = cwi_lanes_fade(depths);
    const float p = a * left[0], q = b * left[1];
    if (!(p + q > 0))
        return;
    s->color += s->light * (1 - left[2]) / (p + q) * (p * first + q * second);
    s->light *= left[2];
}

/* Computes the extinction coefficient of an opacity as cwi_frame_extinction(), to a relative
 * error of 1e-8. The logarithm of what is let through is that of its power of two, and
 * 2 atanh((m - 1) / (m + 1)) of the rest m, from sqrt(1/2) to sqrt(2). */
static inline double extinction_of(const vbuffer *b, double opacity)
{
    const double left = 1 - (opacity < CWI_MAX_OPACITY ? opacity : CWI_MAX_OPACITY);
    const uint64_t one = 0x3ff0000000000000, root_of_half = 0x3fe6a09e667f3bcd;
    uint64_t bits;
    double m;
    memcpy(&bits, &left, sizeof bits);
    const int64_t power = (int64_t)((bits + (one - root_of_half)) >> 52) - 1023;
    bits -= (uint64_t)power << 52;
    memcpy(&m, &bits, sizeof m);
    const double s = (m - 1) / (m + 1), z = s * s;
    const double series = 1 + z * (1.0 / 3 + z * (1.0 / 5 + z * (1.0 / 7 + z * (1.0 / 9))));
    return -(0.69314718055994531 * (double)power + 2 * s * series) * b->per_opacity_unit;
}

/* Computes the glow at a point of a piece, by the transfer function itself. */
static lanes glow_of_piece(const state *s, const cwi_linear *l, const double value[4], double x)
{
    double v = cwi_cubic_at(value, x);
    v = (v < l->low ? l->low : v > l->high ? l->high : v) - l->origin;
    const double opacity = fmin(fmax(l->opacity + v * l->opacity_slope, 0), 1);
    lanes glow;
    for (int c = 0; c < 3; c++)
        glow[c] = (float)(l->color[c] + v * l->color_slope[c]);
    glow[3] = (float)extinction_of(s->b, opacity);
    double gradient[3] = {0};
    for (int a = 0; a < 3 && s->has_gradient; a++)
        gradient[a] = cwi_cubic_at(s->gradient[a], x);
    return finish_cell(s, x, gradient, glow);
}

/* Returns true if two points represent a segment well enough. Light may turn within a cell. */
static inline bool is_told(const state *s, lanes first, lanes second, float length)
{
    const float depth = (first[3] + second[3]) * 0.5f * length;
    if (depth > MAX_DEPTH)
        return false;
    if (!s->b->has_gradients)
        return true;
    float max = fabsf(first[3] - second[3]) * length;
    for (int c = 0; c < 3; c++)
        max = fmaxf(max, depth * fabsf(first[c] - second[c]));
    return s->light * max < MAX_TURN;
}

/* Passes a piece, in parts where two points do not represent it. */
static void pass_piece(state *s, const cwi_transfer_segment *piece, const double value[4])
{
    const float length = (float)(s->walk.to - s->walk.from);
    double width = piece->to - piece->from;
    for (int n = 0, parts = 1; n < parts; n++) {
        const double from = piece->from + n * width;
        const lanes first =
            glow_of_piece(s, piece->linear, value, from + CWI_FIRST_POINT * width);
        const lanes second =
            glow_of_piece(s, piece->linear, value, from + CWI_SECOND_POINT * width);
        const float steepness = fabsf(first[3] - second[3]) * (float)width * length;
        if (parts == 1 &&
            (steepness > MAX_STEEPNESS || !is_told(s, first, second, (float)width * length))) {
            const float depth = (first[3] + second[3]) * 0.5f * (float)width * length;
            parts = (int)fminf(4 + 2 * depth / MAX_DEPTH, 32);
            width /= parts;
            n = -1;
            continue;
        }
        pass_segment(s, first, second, (float)width * length);
    }
}

/* Fetches gradients at the cell's corners. Returns false if a cell beside it is missing, or has
 * no value. */
static bool fetch_gradients(const vbuffer *b, const cwi_walk *w, lanes g[3][2])
{
    const cw_volume *v = b->gradient_corners.volume;
    const char *p = v->data;
    for (int a = 0; a < 3; a++) {
        if (w->at[a] < 1 || w->at[a] + 2 >= (ptrdiff_t)v->dim[a])
            return false;
        p += w->at[a] * v->stride[a];
    }
    return b->gradient_corners.gradients(&b->gradient_corners, p, g);
}

static void put_corners(const double corners[8], double scale, lanes out[2])
{
    float rows[2][4];
    for (int n = 0; n < 8; n++)
        rows[n & 1][n >> 1] = (float)(scale * corners[n]);
    out[0] = cwi_lanes_load(rows[0]);
    out[1] = cwi_lanes_load(rows[1]);
}

/* Finds gradients at the cell's corners, per voxel and in rows. */
static void find_corner_gradients(const vbuffer *b, const cwi_walk *w, lanes g[3][2])
{
    double exact[3][8];
    if (fetch_gradients(b, w, g))
        return;
    cwi_walk_gradients(w, exact);
    for (int a = 0; a < 3; a++)
        put_corners(exact[a], 1 / b->row_value, g[a]);
}

/* Finds the gradient, and shadows, along a cell that is cut. */
static void find_gradients(state *s)
{
    lanes g[3][2];
    double corners[8], cubic[3][4];
    s->has_gradient = true;
    if (s->b->frame->shadows) {
        cwi_walk_shadows(&s->walk, corners);
        cwi_walk_cubic(&s->walk, corners, s->shadow);
    }
    find_corner_gradients(s->b, &s->walk, g);
    for (int a = 0; a < 3; a++) {
        for (int n = 0; n < 8; n++)
            corners[n] = s->b->row_value * (double)g[a][n & 1][n >> 1];
        cwi_walk_cubic(&s->walk, corners, cubic[a]);
    }
    for (int a = 0; a < 3; a++)
        for (int n = 0; n < 4; n++)
            s->gradient[a][n] = s->b->to_eye[a][0] * cubic[0][n] +
                                s->b->to_eye[a][1] * cubic[1][n] +
                                s->b->to_eye[a][2] * cubic[2][n];
}

/* Passes a part of the ray on which the value is a cubic, and the gradient is known. */
static void pass_cubic(state *s, const double value[4])
{
    cwi_transfer_segment pieces[CWI_PIECES];
    const size_t count = cwi_knots_cut(&s->b->knots, value, pieces);
    for (size_t n = 0; n < count; n++)
        if (pieces[n].linear->is_visible)
            pass_piece(s, &pieces[n], value);
}

/* Passes a cell with a breakpoint in it. */
static void pass_in_pieces(state *s)
{
    double v[8], value[4];
    if (!cwi_walk_values(&s->walk, v))
        return;
    cwi_walk_cubic(&s->walk, v, value);
    if (s->b->has_gradients)
        find_gradients(s);
    pass_cubic(s, value);
}

/* Adds the gradients and shadows at the two points of a cell to its position in the batch. */
static void add_gradients(state *s, const lanes at[3], int cell)
{
    lanes g[3][2], light[2] = {cwi_lanes_spread(1), cwi_lanes_spread(1)};
    find_corner_gradients(s->b, &s->walk, g);
    if (s->b->frame->shadows) {
        double shadows[8];
        cwi_walk_shadows(&s->walk, shadows);
        put_corners(shadows, 1, light);
    }
    s->batch.gradient_xy[cell] = cwi_cell_corners_pair(g[0], g[1], at);
    s->batch.gradient_z_shadow[cell] = cwi_cell_corners_pair(g[2], light, at);
}

static inline float lesser(float a, float b)
{
    return a < b ? a : b;
}

static inline float greater(float a, float b)
{
    return a > b ? a : b;
}

static inline const row_parts *parts_of(const vbuffer *b, float row)
{
    return &b->parts[(int32_t)greater(lesser(row + 1, (float)CWI_TABLE_ROWS), 0)];
}

/* Estimates the range of values of a cell along the ray. Where they turn, the cubic goes
 * farther than at the four positions. For a parabola that is half the difference, and little if it
 * turns close to an end; for a rough cubic it is more. */
static inline void range_of(lanes rows, float *low, float *high)
{
    const float start = rows[0], first = rows[1], second = rows[2], end = rows[3];
    const float ends[2] = {lesser(start, end), greater(start, end)};
    *low = lesser(ends[0], lesser(first, second));
    *high = greater(ends[1], greater(first, second));
    const bool is_monotone =
        *low >= ends[0] && *high <= ends[1] && (second - first) * (end - start) >= 0;
    const float beyond = (is_monotone ? 0.125f : 1.0f) * (*high - *low);
    *low -= beyond;
    *high += beyond;
}

/* Adds the cell that the walk has found to the batch, if something of it is visible. */
static inline void add_cell(state *s)
{
    const vbuffer *b = s->b;
    const cwi_walk *w = &s->walk;
    lanes even, odd, at[3];
    const cw_volume *v = &b->frame->volume;
    const char *p = (const char *)v->data + w->at[0] * v->stride[0] + w->at[1] * v->stride[1] +
                    w->at[2] * v->stride[2];
    if (!b->corners.fetch(&b->corners, p, &even, &odd))
        return;
    const lanes x = {0, (float)CWI_FIRST_POINT, (float)CWI_SECOND_POINT, 1};
    const lanes steps = x * (float)(w->to - w->from);
    for (int a = 0; a < 3; a++)
        at[a] = (float)(w->index[a] + w->from * w->slope[a] - (double)w->at[a]) +
                s->slope[a] * steps;
    const lanes rows = cwi_cell_corners_at(even, odd, at);
    float low, high;
    range_of(rows, &low, &high);
    const int first = parts_of(b, low)->low, last = parts_of(b, high)->high;
    if (first == last && !b->knots.linear[first].is_visible)
        return;
    const int n = s->batch.count++;
    s->batch.rows[n] = rows;
    s->batch.cells[n].from = w->from;
    s->batch.cells[n].to = w->to;
    s->batch.cells[n].is_cut = first != last;
    memcpy(s->batch.cells[n].at, w->at, sizeof w->at);
    if (b->has_gradients && first == last)
        add_gradients(s, at, n);
}

/* Passes the cells of the batch in their order, until too little light is left. */
static void pass_batch(state *s, float min_light)
{
    cwi_cell_batch *batch = &s->batch;
    const cwi_batch_light light = cwi_cell_batch_light(&s->scene, batch);
    lanes fraction = {0};
    for (int n = 0; n < batch->count && s->light > min_light; n++) {
        if (!batch->cells[n].is_cut && light.depth[n] <= MAX_DEPTH &&
            s->light * light.difference[n] < MAX_TURN) {
            fraction[n] = s->light;
            s->light *= light.left[n];
            continue;
        }
        memcpy(s->walk.at, batch->cells[n].at, sizeof s->walk.at);
        s->walk.from = batch->cells[n].from;
        s->walk.to = batch->cells[n].to;
        pass_in_pieces(s);
    }
    for (int c = 0; c < 3; c++)
        s->colors[c] += fraction * light.color[c];
    batch->count = 0;
}

static void draw_part(state *s, int part, float min_light)
{
    cwi_walk *w = &s->walk;
    cwi_walk_start(w, s->b->frame, &s->ray, part);

    while (w->t < w->stop && s->light > min_light) {
        {
            const int distance = s->b->distances[cwi_walk_block(w, s->b->ranges->dim)];
            if (distance > 0) {
                cwi_walk_leap(w, CWI_RANGE_EDGE, distance);
                continue;
            }
        }
        if (!cwi_walk_next(w))
            break;

        add_cell(s);
        if (s->batch.count == CWI_BATCH_CELLS)
            pass_batch(s, min_light);
    }
    if (s->batch.count > 0)
        pass_batch(s, min_light);
}

/* Draws all parts of a ray through a grid that is not even. Returns false when memory is
 * out. */
static bool draw_spans(state *s, cwi_spans *spans, float min_light)
{
    cwi_span span;
    if (!cwi_spans_start(spans, &s->b->field, &s->ray))
        return false;
    s->has_gradient = s->b->has_gradients;
    while (s->light > min_light && cwi_spans_next(spans, &span)) {
        s->walk.from = span.from;
        s->walk.to = span.to;
        memcpy(s->gradient, span.gradient, sizeof s->gradient);
        pass_cubic(s, span.value);
    }
    return true;
}

/* Draws the ray through a point of the picture, which belongs to pixel n. Returns false when
 * memory is out. */
static bool draw_ray(const vbuffer *b, cwi_spans *spans, double x, double y, size_t n,
                     double offset, float pixel[4])
{
    const cw_scene *scene = &b->frame->scene;
    const double depth = b->depths ? b->depths[n] : INFINITY;
    cwi_lighting lighting;
    state s = {.b = b, .lighting = &lighting, .light = 1, .shadow = {1}};
    const float fraction = (float)(y / (double)scene->height);
    cwi_ray_make(b->frame, x, y, b->has_beams ? fmin(depth, b->beams.start) : depth, &s.ray);
    if (scene->lit)
        cwi_lighting_make(b->frame, s.ray.origin, s.ray.direction, &lighting);
    for (int c = 0; c < 3; c++)
        s.background[c] =
            (1 - fraction) * scene->background[0][c] + fraction * scene->background[1][c];
    for (int a = 0; a < 3; a++)
        s.slope[a] = (float)s.ray.slope[a];
    const float min_light = 1 - scene->sampling.stop_opacity;
    bool is_whole = true;
    s.scene = (cwi_batch_scene){.frame = b->frame,
                                .table = &b->table,
                                .lighting = &lighting,
                                .to_eye = b->rows_to_eye,
                                .unit = (float)b->row_value,
                                .background = s.background,
                                .deepening = -s.ray.direction[2],
                                .has_gradients = b->has_gradients};
    for (int part = 0; part < s.ray.part_count && b->is_even; part++)
        draw_part(&s, part, min_light);
    for (int c = 0; c < 3; c++)
        s.color[c] += s.colors[c][0] + s.colors[c][1] + s.colors[c][2] + s.colors[c][3];
    if (!b->is_even)
        is_whole = draw_spans(&s, spans, min_light);
    if (b->has_beams)
        cwi_beam_pass(&b->beams, &s.ray, depth, offset, shade_beam, &s, &s.color, &s.light);
    for (int c = 0; c < 3; c++)
        pixel[c] = s.color[c];
    pixel[3] = 1 - s.light;
    return is_whole;
}

/* Draws a pixel: the mean of its beams, if there are any, else one ray. */
static bool draw_pixel(const vbuffer *b, cwi_spans *spans, size_t x, size_t y)
{
    const size_t n = y * b->picture->width + x, sides = b->has_beams ? b->beams.sides : 1;
    float *pixel = b->picture->pixels + 4 * n, sum[4] = {0};
    bool is_whole = true;
    for (size_t i = 0; i < sides * sides; i++) {
        const double across = (double)x + ((double)(i % sides) + 0.5) / (double)sides,
                     down = (double)y + ((double)(i / sides) + 0.5) / (double)sides;
        float one[4];
        const double offset =
            ((double)(7 * i % (sides * sides)) + 0.5) / (double)(sides * sides);
        is_whole &= draw_ray(b, spans, across, down, n, offset, one);
        for (int c = 0; c < 4; c++)
            sum[c] += one[c];
    }
    for (int c = 0; c < 4; c++)
        pixel[c] = sum[c] / (float)(sides * sides);
    return is_whole;
}

static void draw_row(void *context, size_t y)
{
    vbuffer *b = context;
    cwi_spans spans = {0};
    for (size_t x = 0; x < b->picture->width; x++)
        if (!draw_pixel(b, &spans, x, y))
            cwi_set_flag(&b->is_starved);
    cwi_spans_free(&spans);
}

/* Finds the parts of rows. Rows of the table stand at evenly spaced values; a part begins at
 * its breakpoint. */
static void find_parts(vbuffer *b)
{
    const double step = (b->table.high - b->table.low) / (CWI_TABLE_ROWS - 1);
    size_t before = 0; /* breakpoints below the row's end */
    for (size_t n = 0; n <= CWI_TABLE_ROWS; n++) {
        const double begin = b->table.low + ((double)n - 1) * step,
                     end = b->table.low + (double)n * step;
        const size_t low = n > 0 ? cwi_knots_below(&b->knots, begin) : 0;
        while (before < b->knots.count && (b->knots.at[before] < end || n == CWI_TABLE_ROWS))
            before++;
        b->parts[n].low = (uint8_t)low;
        b->parts[n].high = (uint8_t)before;
    }
    b->parts[CWI_TABLE_ROWS].low = b->parts[CWI_TABLE_ROWS].high;
}

static bool is_visible(const void *knots, double low, double high)
{
    return cwi_knots_is_visible(knots, low, high);
}

static cw_status set_up(vbuffer *b, const cwi_cell_tree *tree, const cwi_mean_cells *cells,
                        cw_error *err)
{
    const cw_volume *v = &b->frame->volume;
    cw_status st = cwi_table_make(b->frame, &b->table, err);
    if (st != CW_OK)
        return st;
    cwi_knots_make(&b->frame->transfer, &b->knots);
    find_parts(b);
    b->row_value = (b->table.high - b->table.low) / (CWI_TABLE_ROWS - 1);
    b->is_even = !cwi_volume_kind(v);
    b->per_opacity_unit = 1 / b->frame->opacity_units;
    cwi_cell_corners_make(v, &b->table, &b->corners);
    cwi_cell_corners_make(&b->frame->gradient_volume, &b->table, &b->gradient_corners);
    cwi_frame_gradient_matrix(b->frame, b->to_eye);
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++)
            b->rows_to_eye[r][c] = (float)b->to_eye[r][c];
    b->has_gradients = cwi_frame_needs_gradients(b->frame);
    cwi_field_make(b->frame, tree, &b->knots, false, &b->field);
    if (!b->is_even)
        return CW_OK;
    st = cwi_ranges_distances(b->ranges, is_visible, &b->knots, &b->distances, err);
    b->has_beams = b->frame->scene.vbuffer.pixel_area && cwi_beams_are_wide(b->frame);
    if (st == CW_OK && b->has_beams)
        st = cwi_beams_make(b->frame, b->ranges, b->distances, &b->corners, cells, &b->table,
                            &b->beams, err);
    return st;
}

cw_status cwi_vbuffer_draw(const cwi_frame *frame, const cwi_ranges *ranges,
                           const cwi_cell_tree *tree, const cwi_mean_cells *cells,
                           const double *depths, cw_picture *picture, cw_error *err)
{
    vbuffer *b = cwi_alloc_zeroed(1, sizeof *b);
    if (!b)
        return cwi_fail_memory(err);
    b->frame = frame;
    b->ranges = ranges;
    b->depths = depths;
    b->picture = picture;
    cw_status st = set_up(b, tree, cells, err);
    if (st == CW_OK)
        st = cwi_parallel_for(picture->height, picture->width * CWI_RAY_SAMPLES,
                              frame->scene.threads, &frame->scene.progress, "drawing", draw_row,
                              b, err);
    if (st == CW_OK && b->is_starved)
        st = cwi_fail_memory(err);
    cwi_beams_free(&b->beams);
    cwi_free(b->distances);
    cwi_table_free(&b->table);
    cwi_free(b);
    return st;
}
