/* Finds the tetrahedron around a point among those of the cells whose boxes hold it. A cell is divided
 * from its first corner to the faces opposite, and these into triangles. */
#include "core/color/cell_sample.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/box.h"
#include "core/geometry/vec3.h"
#include "core/volume/cell_shapes.h"
#include "core/volume/volume.h"

#include <math.h>

/* The most that the weight of a corner may be below 0. */
static const double OUTSIDE = 0.1;

static void load_point(const cwi_cell_sampler *s, uint32_t corner, double p[3])
{
    const double *from = s->volume->cells->points + 3 * (size_t)corner;
    cwi_sub(from, s->center, p);
}

static const cwi_cell_shape *shape_of(const cw_cells *cells, size_t cell)
{
    return &cwi_cell_shapes[cells->shapes[cell]];
}

/* Computes the box of a cell, wider by what may be outside. */
static void find_box(const cwi_cell_sampler *s, size_t cell, float box[6])
{
    const cw_cells *cells = s->volume->cells;
    double low[3], high[3];
    cwi_box_clear(low, high);
    for (size_t c = 0; c < shape_of(cells, cell)->corner_count; c++) {
        double p[3];
        load_point(s, cells->corners[s->begin[cell] + c], p);
        cwi_box_add(low, high, p);
    }
    for (int a = 0; a < 3; a++) {
        const double beside = OUTSIDE * (high[a] - low[a]);
        box[a] = (float)(low[a] - beside);
        box[a + 3] = (float)(high[a] + beside);
    }
}

/* Finds a point in the middle of all, so that single precision holds the boxes. */
static void find_center(cwi_cell_sampler *s, size_t samples)
{
    double low[3], high[3];
    cwi_box_clear(low, high);
    for (size_t n = 0; n < samples; n++)
        cwi_box_add(low, high, s->volume->cells->points + 3 * n);
    for (int a = 0; a < 3; a++)
        s->center[a] = low[a] <= high[a] ? (low[a] + high[a]) / 2 : 0;
}

cw_status cwi_cell_sampler_build(const cw_volume *volume, cwi_cell_sampler *s, cw_error *err)
{
    const cw_cells *cells = volume->cells;
    size_t corners = 0;
    *s = (cwi_cell_sampler){.volume = volume};
    if (cells->count >= UINT32_MAX / CWI_SHAPE_CORNERS)
        return cwi_fail(err, CW_ERR_LIMIT, "%zu cells; at most %u are sampled", cells->count,
                        UINT32_MAX / CWI_SHAPE_CORNERS);
    float(*boxes)[6] = cwi_alloc_array(cells->count, sizeof *boxes);
    s->begin = cwi_alloc_array(cells->count, sizeof *s->begin);
    cw_status st = boxes && s->begin ? CW_OK : cwi_fail_memory(err);
    if (st == CW_OK) {
        find_center(s, volume->dim[0] * volume->dim[1] * volume->dim[2]);
        for (size_t n = 0; n < cells->count; n++) {
            s->begin[n] = (uint32_t)corners;
            corners += shape_of(cells, n)->corner_count;
            find_box(s, n, boxes[n]);
        }
        st = cwi_boxes_build(&s->tree, (const float(*)[6])boxes, cells->count, err);
    }
    cwi_free(boxes);
    return st;
}

void cwi_cell_sampler_free(cwi_cell_sampler *s)
{
    cwi_boxes_free(&s->tree);
    cwi_free(s->begin);
    *s = (cwi_cell_sampler){0};
}

/* A point, and the tetrahedron so far that it is least outside of. */
typedef struct search {
    const cwi_cell_sampler *sampler;
    double point[3], min_weight; /* the lowest weight of a corner */
    double weights[4];
    uint32_t corners[4];
} search;

static double value_at(const cw_volume *v, uint32_t sample)
{
    const double x = cwi_voxel_at(v->type, cwi_voxel_address(v, sample, 0, 0));
    const bool has_value = isfinite(x) && !(v->has_nodata && x == v->nodata);
    return has_value ? v->slope * x + v->intercept : NAN;
}

/* Takes a tetrahedron if the point is farther inside than in the one before. */
static void try_corners(search *q, const uint32_t corners[4])
{
    double side[3][3], to[3], first[3], crossed[3][3], weights[4];
    load_point(q->sampler, corners[0], first);
    for (int n = 0; n < 3; n++) {
        double p[3];
        load_point(q->sampler, corners[n + 1], p);
        cwi_sub(p, first, side[n]);
    }
    cwi_sub(q->point, first, to);
    for (int n = 0; n < 3; n++)
        cwi_cross(side[(n + 1) % 3], side[(n + 2) % 3], crossed[n]);
    const double volume = cwi_dot(side[0], crossed[0]);
    if (volume == 0)
        return;
    double min_weight = 1;
    weights[0] = 1;
    for (int n = 0; n < 3; n++) {
        weights[n + 1] = cwi_dot(to, crossed[n]) / volume;
        weights[0] -= weights[n + 1];
    }
    for (int n = 0; n < 4; n++)
        min_weight = cwi_lesser(min_weight, weights[n]);
    if (!(min_weight > q->min_weight))
        return;
    q->min_weight = min_weight;
    for (int n = 0; n < 4; n++) {
        q->weights[n] = weights[n];
        q->corners[n] = corners[n];
    }
}

/* Divides a cell: from its first corner to the faces without it. */
static void try_cell(search *q, size_t cell)
{
    const cw_cells *cells = q->sampler->volume->cells;
    const cwi_cell_shape *shape = shape_of(cells, cell);
    const uint32_t *corners = cells->corners + q->sampler->begin[cell];
    for (size_t f = 0; f < shape->face_count; f++) {
        const uint8_t *face = shape->faces[f];
        bool has_first = false;
        for (size_t c = 0; c < shape->face_size[f]; c++)
            has_first = has_first || face[c] == 0;
        for (size_t c = 2; c < shape->face_size[f] && !has_first; c++)
            try_corners(q, (const uint32_t[4]){corners[0], corners[face[0]],
                                               corners[face[c - 1]], corners[face[c]]});
    }
}

static bool visit_node(void *context, size_t node)
{
    search *q = context;
    const cwi_boxes *tree = &q->sampler->tree;
    const float p[3] = {(float)q->point[0], (float)q->point[1], (float)q->point[2]},
                box[6] = {p[0], p[1], p[2], p[0], p[1], p[2]};
    unsigned meeting = cwi_boxes_meeting(&tree->nodes[node], box);
    for (; meeting; meeting &= meeting - 1) {
        const size_t slot = node * CWI_WIDTH + (size_t)__builtin_ctz(meeting);
        if (slot < tree->count)
            try_cell(q, tree->order[slot]);
    }
    return q->min_weight < 0; /* inside of one: that is it */
}

double cwi_cell_sample(const cwi_cell_sampler *s, const double world[3])
{
    search q = {.sampler = s, .min_weight = -INFINITY};
    double sum = 0, all = 0;
    cwi_sub(world, s->center, q.point);
    const float p[3] = {(float)q.point[0], (float)q.point[1], (float)q.point[2]},
                box[6] = {p[0], p[1], p[2], p[0], p[1], p[2]};
    if (s->tree.count)
        cwi_boxes_visit(&s->tree, box, 0, visit_node, &q);
    if (!(q.min_weight >= -OUTSIDE))
        return NAN;
    for (int n = 0; n < 4; n++) {
        const double weight = cwi_greater(0, q.weights[n]);
        if (weight > 0)
            sum += weight * value_at(s->volume, q.corners[n]);
        all += weight;
    }
    return sum / all;
}
