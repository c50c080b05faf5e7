/* Coherent projection [Wilhelms1991] of rectilinear and irregular cells. Cells are sorted
 * roughly, from the nearest to the farthest, and each is projected once in a band of rows: it
 * covers the samples where rays enter by a front face before they leave by a back face. So each
 * sample gets the parts of its ray, nearly sorted, with the values at entry and exit. They are
 * sorted exactly, sample by sample, whatever the shape of the grid, and blended by running
 * integrals of the transfer function [Engel2001]. */
#include "viewer/projection/uneven_projection.h"

#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/geometry/vec3.h"
#include "viewer/projection/projected_solids.h"
#include "viewer/projection/running_integrals.h"
#include "viewer/rays/ray_traversal.h"
#include "viewer/scene/lighting.h"
#include "viewer/scene/transfer_segments.h"

#include <math.h>
#include <string.h>

enum { BAND = 4, CHUNK = 4096, SLOTS = 4096 };

/* The rows of a cell on the picture, and its slot in the rough order; 0: it shows nothing,
 * others count from 1. */
typedef struct cover {
    uint16_t first_band, last_band, slot;
} cover;

typedef struct projection {
    const cwi_frame *frame;
    const double *depths;
    cw_picture *picture;
    cwi_solids solids;
    cwi_integrals integrals;
    cwi_knots knots;
    cover *covers;       /* of the cells */
    uint32_t *cells;     /* of each band, one band after another, nearest first */
    size_t *band_starts; /* bands + 1 */
    size_t band_count;
    bool is_starved;
} projection;

/* A part of a sample's ray in one cell, by depths. */
typedef struct fragment {
    double near, far;
    float values[2], gradient[3]; /* at both ends; in the middle, in eye space */
    uint32_t next;                /* of the same sample; UINT32_MAX: none */
} fragment;

/* Fragments of a band, listed by sample. */
typedef struct band {
    const projection *p;
    size_t first_row, rows;
    fragment *all;
    uint32_t count, capacity;
    uint32_t *last;   /* of each sample's fragments, the one found last */
    uint32_t *sorted; /* scratch */
    size_t sorted_capacity;
    bool is_starved;
} band;

/* --- cells to bands ------------------------------------------------------------------------ */

static void cover_chunk(void *context, size_t chunk)
{
    projection *p = context;
    const cwi_frame *f = p->frame;
    const double size[2] = {(double)f->scene.width, (double)f->scene.height};
    for (size_t n = chunk * CHUNK; n < (chunk + 1) * CHUNK && n < p->solids.count; n++) {
        double range[2], low[2], high[2], depth;
        p->covers[n] = (cover){0};
        if (!cwi_solids_measure(&p->solids, n, range, low, high, &depth) ||
            !cwi_knots_is_visible(&p->knots, range[0], range[1]) || !(high[0] >= 0) ||
            !(high[1] >= 0) || !(low[0] <= size[0]) || !(low[1] <= size[1]))
            continue;
        const double fraction = (depth - f->near) / (f->far - f->near);
        const double first = fmax(floor(low[1] / BAND), 0),
                     last = fmin(floor(high[1] / BAND), (double)p->band_count - 1);
        p->covers[n] = (cover){(uint16_t)first, (uint16_t)last,
                               (uint16_t)(1 + fmin(fmax(fraction, 0), 1) * (SLOTS - 1))};
    }
}

/* Sorts the visible cells by slot, by counting; those of one slot stay in their order. Returns
 * NULL when memory is out. */
static uint32_t *sort_cells(const projection *p, size_t *count)
{
    size_t starts[SLOTS + 2] = {0};
    for (size_t n = 0; n < p->solids.count; n++)
        starts[p->covers[n].slot + 1]++;
    *count = p->solids.count - starts[1];
    starts[1] = 0;
    for (size_t s = 1; s < SLOTS + 2; s++)
        starts[s] += starts[s - 1];
    uint32_t *order = cwi_alloc_array(*count, sizeof *order);
    for (size_t n = 0; n < p->solids.count && order; n++)
        if (p->covers[n].slot)
            order[starts[p->covers[n].slot]++] = (uint32_t)n;
    return order;
}

/* Lists the cells of each band, nearest first. */
static cw_status list_bands(projection *p, cw_error *err)
{
    size_t count;
    uint32_t *order = sort_cells(p, &count);
    p->band_starts = cwi_alloc_zeroed(p->band_count + 2, sizeof *p->band_starts);
    if (order && p->band_starts) {
        size_t *starts = p->band_starts;
        for (size_t n = 0; n < count; n++)
            for (size_t b = p->covers[order[n]].first_band; b <= p->covers[order[n]].last_band;
                 b++)
                starts[b + 2]++;
        for (size_t b = 2; b < p->band_count + 2; b++)
            starts[b] += starts[b - 1];
        p->cells = cwi_alloc_array(starts[p->band_count + 1], sizeof *p->cells);
        for (size_t n = 0; n < count && p->cells; n++)
            for (size_t b = p->covers[order[n]].first_band; b <= p->covers[order[n]].last_band;
                 b++)
                p->cells[starts[b + 1]++] = order[n];
    }
    cwi_free(order);
    return p->cells ? CW_OK : cwi_fail_memory(err);
}

/* --- cells to fragments -------------------------------------------------------------------- */

/* A ray as origin + depth * direction, and shifted by little, so that none runs in the faces
 * between two cells. */
static void ray_by_depth(const cwi_frame *f, size_t x, size_t y, double origin[3],
                         double direction[3])
{
    static const double shift[3] = {0.531e-11, 0.733e-11, 0.426e-11};
    const double scale = fabs(f->far);
    cwi_frame_ray(f, (double)x + 0.5, (double)y + 0.5, origin, direction);
    for (int a = 0; a < 3; a++) {
        origin[a] += shift[a] * scale;
        direction[a] = a < 2 ? direction[a] / -direction[2] : direction[a];
    }
    direction[2] = -1;
}

static bool has_capacity(band *b)
{
    if (b->count < b->capacity)
        return true;
    const size_t more = 2 * (size_t)b->capacity + 4096;
    fragment *all = more < UINT32_MAX ? cwi_realloc_array(b->all, more, sizeof *all) : NULL;
    if (!all) {
        b->is_starved = true;
        return false;
    }
    b->all = all;
    b->capacity = (uint32_t)more;
    return true;
}

static void point_on(const double origin[3], const double direction[3], double depth,
                     double p[3])
{
    cwi_add_scaled(origin, depth, direction, p);
}

/* Adds a part of a ray. In a box both values are shifted by two thirds of what the value in the
 * middle is above their mean: the mean is then that of a parabola. */
static void add_fragment(band *b, const cwi_solid *s, size_t sample, const double origin[3],
                         const double direction[3], double near, double far)
{
    double p[3], gradient[3], values[3];
    if (!has_capacity(b))
        return;
    fragment *f = &b->all[b->count];
    *f = (fragment){.near = near, .far = far, .next = b->last[sample]};
    for (int n = 0; n < 3; n++) {
        point_on(origin, direction, n == 2 ? (near + far) / 2 : n ? far : near, p);
        if (n < 2 || s->is_box || b->p->solids.has_gradients)
            values[n] = cwi_solid_sample(s, p, n == 2 ? gradient : NULL);
    }
    const double bend = s->is_box ? (values[2] - (values[0] + values[1]) / 2) * 2 / 3 : 0;
    for (int n = 0; n < 2; n++)
        f->values[n] = (float)(values[n] + bend);
    for (int a = 0; a < 3 && b->p->solids.has_gradients; a++)
        f->gradient[a] = (float)gradient[a];
    b->last[sample] = b->count++;
}

/* Projects a solid: in each sample that it may cover, the entry is the last of the front faces,
 * and the exit the first of the back faces. */
static void project_solid(band *b, const cwi_solid *s)
{
    const cwi_frame *f = b->p->frame;
    const double width = (double)f->scene.width, end = (double)(b->first_row + b->rows);
    const size_t x0 = (size_t)fmin(fmax(floor(s->low[0]), 0), width),
                 x1 = (size_t)fmin(fmax(ceil(s->high[0]), 0), width);
    const size_t y0 = (size_t)fmin(fmax(floor(s->low[1]), (double)b->first_row), end),
                 y1 = (size_t)fmin(fmax(ceil(s->high[1]), (double)b->first_row), end);
    for (size_t y = y0; y < y1; y++)
        for (size_t x = x0; x < x1; x++) {
            double origin[3], direction[3];
            double near = f->perspective ? f->near : -INFINITY, far = INFINITY;
            ray_by_depth(f, x, y, origin, direction);
            for (int n = 0; n < s->plane_count; n++) {
                const double *plane = s->planes[n];
                const double at = cwi_dot(plane, origin) + plane[3],
                             slope = cwi_dot(plane, direction);
                if (slope > 0)
                    near = cwi_greater(near, -at / slope);
                else if (slope < 0)
                    far = cwi_lesser(far, -at / slope);
                else if (at < 0)
                    far = -INFINITY;
            }
            if (far > near && far < INFINITY && near > -INFINITY)
                add_fragment(b, s, (y - b->first_row) * f->scene.width + x, origin, direction,
                             near, far);
        }
}

/* --- fragments to samples ------------------------------------------------------------------ */

typedef struct blending {
    const projection *p;
    cwi_lighting lighting;
    double background[3], color[3], light;
} blending;

/* Blends a segment whose value changes linearly, in pieces that each take little light. */
static void blend_segment(blending *b, const fragment *f, double near, double far, double along)
{
    enum { MAX_PIECES = 16 };
    static const double PIECES_PER_DEPTH = 4; /* per unit of optical depth */
    const projection *p = b->p;
    const cwi_frame *frame = p->frame;
    const double gradient[3] = {(double)f->gradient[0], (double)f->gradient[1],
                                (double)f->gradient[2]};
    double ends[2], whole[4], scale = along, base[3] = {0, 0, 0}, gain[3] = {1, 1, 1};
    for (int n = 0; n < 2; n++) {
        const double fraction = ((n ? far : near) - f->near) / (f->far - f->near);
        ends[n] = (double)f->values[0] + fraction * (double)(f->values[1] - f->values[0]);
    }
    cwi_integrals_mean(&p->integrals, ends[0], ends[1], whole);
    if (!(whole[3] > 0))
        return;
    if (frame->transfer.gradient_count > 0)
        scale *= cwi_frame_gradient_factor(frame, cwi_length(gradient));
    if (frame->scene.lit) {                             /* light is linear in the colour */
        const double middle = (near + far) / 2 * along; /* from depths to the way on the ray */
        cwi_lighting_shade(&b->lighting, middle, gradient, 1, base);
        cwi_lighting_shade(&b->lighting, middle, gradient, 1, gain);
    }
    const double length = (far - near) * scale;
    const int count =
        (int)fmin(fmax(ceil(PIECES_PER_DEPTH * whole[3] * length), 1), MAX_PIECES);
    for (int n = 0; n < count && b->light > 0; n++) {
        const double from = (double)n / count, to = (double)(n + 1) / count;
        double mean[4];
        cwi_integrals_mean(&p->integrals, ends[0] + from * (ends[1] - ends[0]),
                           ends[0] + to * (ends[1] - ends[0]), mean);
        const double depth = mean[3] * length / count, left = exp(-depth);
        if (!(depth > 0))
            continue;
        const double cue = cwi_frame_cue(frame, near + (from + to) / 2 * (far - near));
        for (int c = 0; c < 3; c++) {
            const double lit = base[c] + (gain[c] - base[c]) * mean[c] / mean[3];
            b->color[c] += b->light * (1 - left) * (cue * lit + (1 - cue) * b->background[c]);
        }
        b->light *= left;
    }
}

/* Lists a sample's fragments from the nearest to the farthest. They come nearly sorted, so that
 * inserting is quick; of equal ones the cell that comes first is first. Returns their number. */
static size_t sort_fragments(band *b, uint32_t last)
{
    size_t count = 0;
    for (uint32_t n = last; n != UINT32_MAX; n = b->all[n].next)
        count++;
    if (count > b->sorted_capacity) {
        uint32_t *sorted = cwi_realloc_array(b->sorted, 2 * count, sizeof *sorted);
        if (!sorted) {
            b->is_starved = true;
            return 0;
        }
        b->sorted = sorted;
        b->sorted_capacity = 2 * count;
    }
    size_t slot = count;
    for (uint32_t n = last; n != UINT32_MAX; n = b->all[n].next) { /* the last comes first */
        size_t at = --slot;
        for (; at + 1 < count && b->all[b->sorted[at + 1]].near < b->all[n].near; at++)
            b->sorted[at] = b->sorted[at + 1];
        b->sorted[at] = n;
    }
    return count;
}

static void blend_sample(band *b, size_t x, size_t y)
{
    const projection *p = b->p;
    const cw_scene *s = &p->frame->scene;
    const size_t sample = y * s->width + x;
    const uint32_t last = b->last[sample - b->first_row * s->width];
    float *pixel = p->picture->pixels + 4 * sample;
    const double fraction = ((double)y + 0.5) / (double)s->height;
    blending l = {.p = p, .light = 1};
    cwi_ray ray;
    if (last == UINT32_MAX)
        return;
    cwi_ray_make(p->frame, (double)x + 0.5, (double)y + 0.5,
                 p->depths ? p->depths[sample] : INFINITY, &ray);
    for (int c = 0; c < 3; c++)
        l.background[c] = (1 - fraction) * (double)s->background[0][c] +
                          fraction * (double)s->background[1][c];
    if (s->lit)
        cwi_lighting_make(p->frame, ray.origin, ray.direction, &l.lighting);
    const size_t count = sort_fragments(b, last);
    const double slope = -ray.direction[2]; /* depth along the ray */
    for (int part = 0; part < ray.part_count; part++)
        for (size_t n = 0; n < count && l.light > 1 - (double)s->sampling.stop_opacity; n++) {
            const fragment *f = &b->all[b->sorted[n]];
            const double near = fmax(f->near, ray.parts[part][0] * slope),
                         far = fmin(f->far, ray.parts[part][1] * slope);
            if (far > near)
                blend_segment(&l, f, near, far, 1 / slope);
        }
    for (int c = 0; c < 3; c++)
        pixel[c] = (float)l.color[c];
    pixel[3] = (float)(1 - l.light);
}

static void fill_band(band *b, size_t number)
{
    const projection *p = b->p;
    const size_t samples = b->rows * p->frame->scene.width;
    for (size_t n = 0; n < samples; n++)
        b->last[n] = UINT32_MAX;
    for (size_t n = p->band_starts[number]; n < p->band_starts[number + 1]; n++) {
        cwi_solid solids[CWI_SOLIDS_OF_CELL];
        const int count = cwi_solids_of(&p->solids, p->cells[n], solids);
        for (int i = 0; i < count && !b->is_starved; i++)
            project_solid(b, &solids[i]);
    }
    for (size_t y = b->first_row; y < b->first_row + b->rows && !b->is_starved; y++)
        for (size_t x = 0; x < p->frame->scene.width; x++)
            blend_sample(b, x, y);
}

static void draw_band(void *context, size_t number)
{
    projection *p = context;
    const size_t height = p->frame->scene.height, first = number * BAND;
    band b = {.p = p, .first_row = first};
    b.rows = height - first < BAND ? height - first : BAND;
    b.last = cwi_alloc_array(b.rows * p->frame->scene.width, sizeof *b.last);
    if (b.last)
        fill_band(&b, number);
    if (!b.last || b.is_starved)
        cwi_set_flag(&p->is_starved);
    cwi_free(b.last);
    cwi_free(b.all);
    cwi_free(b.sorted);
}

/* ----------------------------------------------------------------------------------------- */

static cw_status draw_cells(projection *p, cw_error *err)
{
    const cw_scene *s = &p->frame->scene;
    p->covers = cwi_alloc_array(p->solids.count, sizeof *p->covers);
    if (!p->covers)
        return cwi_fail_memory(err);
    cw_status st = cwi_parallel_for((p->solids.count + CHUNK - 1) / CHUNK, (size_t)CHUNK * 32,
                                    s->threads, &s->progress, "cells", cover_chunk, p, err);
    if (st == CW_OK)
        st = list_bands(p, err);
    if (st == CW_OK)
        st = cwi_parallel_for(p->band_count, BAND * s->width * CWI_RAY_SAMPLES, s->threads,
                              &s->progress, "drawing", draw_band, p, err);
    if (st == CW_OK && p->is_starved)
        st = cwi_fail_memory(err);
    return st;
}

cw_status cwi_uneven_projection_draw(const cwi_frame *frame, const cwi_cell_tree *tree,
                                     const double *depths, cw_picture *picture, cw_error *err)
{
    if (frame->scene.projection.linear_opacity)
        return cwi_fail(err, CW_ERR_UNSUPPORTED,
                        "opacity that is linear over polygons is for evenly spaced volumes");
    projection *p = cwi_alloc_zeroed(1, sizeof *p);
    if (!p)
        return cwi_fail_memory(err);
    p->frame = frame;
    p->depths = depths;
    p->picture = picture;
    p->band_count = (frame->scene.height + BAND - 1) / BAND;
    cwi_knots_make(&frame->transfer, &p->knots);
    cwi_solids_init(&p->solids, frame, tree);
    cw_status st = p->solids.count < UINT32_MAX
                       ? cwi_integrals_make(frame, &p->integrals, err)
                       : cwi_fail(err, CW_ERR_LIMIT, "%zu cells: fewer than 2^32 can be drawn",
                                  p->solids.count);
    if (st == CW_OK)
        st = draw_cells(p, err);
    cwi_integrals_free(&p->integrals);
    cwi_free(p->covers);
    cwi_free(p->cells);
    cwi_free(p->band_starts);
    cwi_free(p);
    return st;
}
