/* Draws the cells of a volume in tiles of the picture, one thread a tile. A tile goes through an
 * octree of blocks from front to back. It leaves out nodes that the transfer function makes
 * empty, that are beside the tile, or that are behind samples which are opaque already. */
#include "viewer/projection/cell_projection.h"

#include "viewer/projection/cell_block.h"
#include "viewer/rays/ray_traversal.h"

#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/geometry/affine.h"
#include "core/geometry/vec3.h"

#include <math.h>
#include <string.h>

enum { MAX_LEVELS = 32 };

typedef struct projection {
    const cwi_frame *frame;
    const double *depths;
    cw_picture *picture;
    cwi_cell_model model;
    size_t level_count;
    cwi_ranges levels[MAX_LEVELS]; /* the first is borrowed */
    double pixel_from_index[3][4]; /* homogeneous */
    double eye[3];                 /* in index space */
    size_t tiles[2];
    bool has_failed;
} projection;

/* Finds the matrix from index space to homogeneous places in the picture, in samples. */
static void find_matrix(const cwi_frame *f, double m[3][4])
{
    const double *eye = f->eye_from_index;
    const double half[2] = {(double)f->scene.width / 2, (double)f->scene.height / 2};
    for (int c = 0; c < 4; c++) {
        m[2][c] = f->perspective ? -eye[8 + c] : c == 3;
        m[0][c] = half[0] * (m[2][c] + eye[c] / f->half[0]);
        m[1][c] = half[1] * (m[2][c] - eye[4 + c] / f->half[1]);
    }
}

static cw_status make_levels(projection *p, const cwi_ranges *ranges, cw_error *err)
{
    p->levels[0] = *ranges;
    p->level_count = 1;
    for (size_t n = 1; n < MAX_LEVELS; n++) {
        const cwi_ranges *fine = &p->levels[n - 1];
        if (fine->dim[0] * fine->dim[1] * fine->dim[2] == 1)
            break;
        const cw_status st = cwi_ranges_halve(fine, &p->levels[n], err);
        if (st != CW_OK)
            return st;
        p->level_count++;
    }
    return CW_OK;
}

static void free_levels(projection *p)
{
    for (size_t n = 1; n < p->level_count; n++)
        cwi_ranges_free(&p->levels[n]);
}

/* Starts a ray where it enters the volume. Along an axis it hardly moves along, its steps are
 * limited, so that a ray in a plane of voxels is in one of both cells. */
static void start_ray(const cwi_frame *f, const cwi_ray *from, cwi_cell_ray *ray)
{
    const double start = from->parts[0][0];
    *ray = (cwi_cell_ray){.light = 1, .part_count = from->part_count};
    for (int a = 0; a < 3; a++) {
        const float slope = (float)from->slope[a];
        const float steep = fabsf(slope) < 1e-20f ? copysignf(1e-20f, slope) : slope;
        const float end = nextafterf((float)f->high[a], (float)f->low[a]);
        ray->origin[a] = (float)(from->index[a] + start * from->slope[a]);
        if (steep != slope && ray->origin[a] > end)
            ray->origin[a] = end;
        ray->slope[a] = slope;
        ray->inverse[a] = 1 / steep;
        ray->falls[a] = steep < 0;
    }
    for (int n = 0; n < from->part_count; n++)
        for (int end = 0; end < 2; end++)
            ray->parts[n][end] = (float)(from->parts[n][end] - start);
    ray->depth[0] = (float)(-start * from->direction[2] - from->origin[2]);
    ray->depth[1] = (float)-from->direction[2];
}

/* Makes the rays of a tile; those that miss the volume are dead from the start. */
static void start_rays(const projection *p, cwi_tile *t)
{
    const cw_scene *s = &p->frame->scene;
    for (int y = 0; y < t->height; y++) {
        const size_t row = t->y + (size_t)y;
        const float fraction = ((float)row + 0.5f) / (float)s->height;
        t->live[y] = 0;
        for (int x = 0; x < t->width; x++) {
            const size_t column = t->x + (size_t)x;
            const int n = y * CWI_TILE_EDGE + x;
            cwi_ray ray;
            cwi_ray_make(p->frame, (double)column + 0.5, (double)row + 0.5,
                         p->depths ? p->depths[row * s->width + column] : INFINITY, &ray);
            if (ray.part_count == 0)
                continue;
            t->live[y] |= (uint32_t)1 << x;
            start_ray(p->frame, &ray, &t->rays[n]);
            for (int c = 0; c < 3; c++)
                t->rays[n].background[c] =
                    (1 - fraction) * s->background[0][c] + fraction * s->background[1][c];
            if (s->lit)
                cwi_cell_halfway(&p->model, ray.direction, t->halfway[n]);
            t->rays[n].halfway = t->halfway[n];
        }
    }
}

static void start_tile(const projection *p, size_t n, cwi_tile *t)
{
    const cw_scene *s = &p->frame->scene;
    t->model = &p->model;
    t->x = n % p->tiles[0] * CWI_TILE_EDGE;
    t->y = n / p->tiles[0] * CWI_TILE_EDGE;
    t->width = (int)fmin(CWI_TILE_EDGE, (double)(s->width - t->x));
    t->height = (int)fmin(CWI_TILE_EDGE, (double)(s->height - t->y));
    for (int c = 0; c < 4; c++) {
        const double weight = p->pixel_from_index[2][c];
        t->pixel_from_index[0][c] = p->pixel_from_index[0][c] - (double)t->x * weight;
        t->pixel_from_index[1][c] = p->pixel_from_index[1][c] - (double)t->y * weight;
        t->pixel_from_index[2][c] = weight;
    }
    t->near_depth = p->frame->perspective ? p->frame->near : 0;
    memcpy(t->eye, p->eye, sizeof t->eye);
    t->tolerance = p->model.needs_gradients ? -1 : (float)s->projection.tree_error;
    t->min_light = 1 - s->sampling.stop_opacity;
    t->has_gaps = p->levels[0].has_gaps;
    start_rays(p, t);
}

/* Returns true if a node of blocks shows something, in samples that still take light.
 * low, high  its box in index space */
static bool is_needed(const projection *p, const cwi_tile *t, size_t level, const size_t at[3],
                      double low[3], double high[3])
{
    const cwi_ranges *r = &p->levels[level];
    const cwi_table *table = &p->model.tables->table;
    const float *range = r->blocks[(at[2] * r->dim[1] + at[1]) * r->dim[0] + at[0]];
    const double scale = 1 / (table->high - table->low);
    if (!cwi_visible_any(&p->model.tables->visible,
                         (float)(((double)range[0] - table->low) * scale),
                         (float)(((double)range[1] - table->low) * scale)))
        return false;
    for (int a = 0; a < 3; a++) {
        const double edge = (double)((size_t)CWI_RANGE_EDGE << level);
        low[a] = p->frame->low[a] + edge * (double)at[a];
        high[a] = cwi_lesser(low[a] + edge, p->frame->high[a]);
    }
    const cwi_tile_box box = cwi_tile_project(t, low, high);
    return cwi_tile_is_live(t, &box);
}

/* Visits the blocks of a node from the nearest to the farthest. */
static void visit_blocks(const projection *p, cwi_tile *t, cwi_linear_cell *linear,
                         size_t level, const size_t at[3])
{
    double low[3], high[3];
    size_t near_half[3];
    if (!is_needed(p, t, level, at, low, high))
        return;
    if (level == 0) {
        cwi_block_draw(
            t, linear,
            (size_t[]){CWI_RANGE_EDGE * at[0], CWI_RANGE_EDGE * at[1], CWI_RANGE_EDGE * at[2]});
        return;
    }
    const double half = (double)((size_t)CWI_RANGE_EDGE << (level - 1));
    for (int a = 0; a < 3; a++)
        near_half[a] = p->eye[a] > low[a] + half;
    const size_t *dim = p->levels[level - 1].dim;
    for (size_t c = 0; c < 8; c++) {
        const size_t part[3] = {2 * at[0] + ((c & 1) ^ near_half[0]),
                                2 * at[1] + ((c >> 1 & 1) ^ near_half[1]),
                                2 * at[2] + ((c >> 2) ^ near_half[2])};
        if (part[0] < dim[0] && part[1] < dim[1] && part[2] < dim[2])
            visit_blocks(p, t, linear, level - 1, part);
    }
}

static void put_tile(const projection *p, const cwi_tile *t)
{
    for (int y = 0; y < t->height; y++)
        for (int x = 0; x < t->width; x++) {
            const cwi_cell_ray *ray = &t->rays[y * CWI_TILE_EDGE + x];
            float *pixel = p->picture->pixels +
                           4 * ((t->y + (size_t)y) * p->picture->width + t->x + (size_t)x);
            for (int c = 0; c < 3 && ray->part_count > 0; c++)
                pixel[c] = ray->color[c];
            pixel[3] = ray->part_count > 0 ? 1 - ray->light : 0;
        }
}

/* The memory of a tile: too large for a thread's stack. */
typedef struct workspace {
    cwi_tile tile;
    cwi_linear_cell linear;
} workspace;

static void draw_tile(void *context, size_t n)
{
    static const size_t root[3] = {0};
    projection *p = context;
    workspace *w = cwi_alloc_zeroed(1, sizeof *w);
    if (!w) {
        cwi_set_flag(&p->has_failed);
        return;
    }
    start_tile(p, n, &w->tile);
    w->linear.frame = p->frame;
    w->linear.tables = p->model.tables;
    w->linear.tile[0] = w->tile.x;
    w->linear.tile[1] = w->tile.y;
    visit_blocks(p, &w->tile, p->frame->scene.projection.linear_opacity ? &w->linear : NULL,
                 p->level_count - 1, root);
    put_tile(p, &w->tile);
    cwi_free(w);
}

static cw_status draw_tiles(projection *p, cw_error *err)
{
    /* a sample of the picture is as much work as this number of samples elsewhere */
    enum { WORK = CWI_RAY_SAMPLES * CWI_TILE_EDGE * CWI_TILE_EDGE };
    const cw_scene *s = &p->frame->scene;
    p->tiles[0] = (s->width + CWI_TILE_EDGE - 1) / CWI_TILE_EDGE;
    p->tiles[1] = (s->height + CWI_TILE_EDGE - 1) / CWI_TILE_EDGE;
    cw_status st = cwi_parallel_for(p->tiles[0] * p->tiles[1], WORK, s->threads, &s->progress,
                                    "cells", draw_tile, p, err);
    if (st == CW_OK && p->has_failed)
        st = cwi_fail_memory(err);
    return st;
}

cw_status cwi_projection_draw(const cwi_frame *frame, const cwi_ranges *ranges,
                              cwi_cell_tables *tables, const double *depths,
                              cw_picture *picture, cw_error *err)
{
    projection *p = cwi_alloc_zeroed(1, sizeof *p);
    if (!p)
        return cwi_fail_memory(err);
    p->frame = frame;
    p->depths = depths;
    p->picture = picture;
    find_matrix(frame, p->pixel_from_index);
    cwi_lattice_eye(frame, p->eye);
    cw_status st = cwi_cell_tables_take(tables, frame, err);
    if (st == CW_OK)
        st = make_levels(p, ranges, err);
    if (st == CW_OK) {
        cwi_cell_model_make(frame, tables, &p->model);
        st = draw_tiles(p, err);
    }
    free_levels(p);
    cwi_free(p);
    return st;
}
