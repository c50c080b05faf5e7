/* Builds the tree of an irregular grid's cells: their kinds and boxes in parallel, then the
 * hierarchy. */
#include "viewer/rays/cell_tree.h"

#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/geometry/vec3.h"
#include "core/volume/cell_shapes.h"
#include "core/volume/sample_gradients.h"
#include "core/volume/volume.h"
#include "viewer/rays/cell_map.h"

#include <math.h>
#include <string.h>

enum { CHUNK = 8192 };

typedef struct job {
    const cw_cells *cells;
    cwi_cell_tree *tree;
    const size_t *chunk_starts;
    float (*boxes)[6];
    const cwi_boxes_segment *only; /* cells that it cannot meet count as empty */
} job;

/* Computes the box around a cell from its points, relative to the tree's centre; rounded
 * outward by more than rounding to floats. */
static void box_cell(const cwi_mapped_cell *cell, double scale, float box[6])
{
    for (int a = 0; a < 3; a++) {
        double low = INFINITY, high = -INFINITY;
        for (int c = 0; c < cell->count; c++) {
            low = cwi_lesser(low, cell->points[c][a]);
            high = cwi_greater(high, cell->points[c][a]);
        }
        box[a] = (float)(low / scale) - 0x1p-23f;
        box[a + 3] = (float)(high / scale) + 0x1p-23f;
    }
}

/* Returns true if a segment may meet a box. */
static bool meets_box(const cwi_boxes_segment *segment, const float box[6])
{
    cwi_boxes_node node;
    cwi_boxes_clear(&node);
    cwi_boxes_put(&node, 0, box);
    return cwi_boxes_crossed(&node, segment) & 1;
}

static void look_at_chunk(void *context, size_t chunk)
{
    const job *work = context;
    const cw_cells *cells = work->cells;
    cwi_cell_tree *t = work->tree;
    size_t at = work->chunk_starts[chunk];
    for (size_t n = chunk * CHUNK; n < (chunk + 1) * CHUNK && n < cells->count; n++) {
        cwi_mapped_cell cell;
        cwi_cell_load(cells, cells->shapes[n], cells->corners + at, t->centre, &cell);
        t->starts[n] = at;
        box_cell(&cell, t->scale, work->boxes[n]);
        t->kinds[n] = CWI_MAP_EMPTY;
        if (!work->only || meets_box(work->only, work->boxes[n]))
            t->kinds[n] = (uint8_t)cwi_cell_map_of(&cell);
        at += (size_t)cell.count;
    }
}

/* Moves the boxes of cells that are not empty together, and lists these cells. */
static size_t pack_boxes(const job *work, uint32_t *items)
{
    size_t count = 0;
    for (size_t n = 0; n < work->cells->count; n++) {
        if (work->tree->kinds[n] == CWI_MAP_EMPTY)
            continue;
        memmove(work->boxes[count], work->boxes[n], sizeof work->boxes[n]);
        items[count++] = (uint32_t)n;
    }
    return count;
}

static cw_status build_boxes(const job *work, cw_error *err)
{
    cwi_boxes *b = &work->tree->boxes;
    uint32_t *items = cwi_alloc_array(work->cells->count, sizeof *items);
    if (!items)
        return cwi_fail_memory(err);
    const size_t count = pack_boxes(work, items);
    cw_status st = cwi_boxes_build(b, (const float(*)[6])work->boxes, count, err);
    for (size_t s = 0; s < count && st == CW_OK; s++)
        b->order[s] = items[b->order[s]];
    cwi_free(items);
    return st;
}

static cw_status fill_tree(job *work, const cwi_frame *f, cw_error *err)
{
    size_t *starts = NULL;
    const size_t count = work->cells->count, chunks = (count + CHUNK - 1) / CHUNK;
    cw_status st = cwi_cell_chunks(work->cells, CHUNK, &starts, err);
    work->chunk_starts = starts;
    if (st == CW_OK)
        st = cwi_parallel_for(chunks, (size_t)CHUNK * 32, f->scene.threads, &f->scene.progress,
                              "cells", look_at_chunk, work, err);
    cwi_free(starts);
    return st == CW_OK ? build_boxes(work, err) : st;
}

cwi_boxes_segment cwi_cell_tree_segment(const cwi_cell_tree *tree, const cwi_ray *ray)
{
    static const float ROUNDING = 1e-6f; /* of a fraction of the segment */
    const double begin = ray->parts[0][0], end = ray->parts[ray->part_count - 1][1];
    double from[3], vector[3];
    for (int a = 0; a < 3; a++) {
        from[a] = (ray->index[a] + begin * ray->slope[a] - tree->centre[a]) / tree->scale;
        vector[a] = (end - begin) * ray->slope[a] / tree->scale;
    }
    return cwi_boxes_segment_of(from, vector, ROUNDING);
}

cw_status cwi_cell_tree_make(const cwi_frame *f, const cwi_ray *only, cwi_cell_tree *tree,
                             cw_error *err)
{
    const cw_cells *cells = f->volume.cells;
    *tree = (cwi_cell_tree){0};
    if (cells->count >= UINT32_MAX)
        return cwi_fail(err, CW_ERR_LIMIT, "%zu cells: fewer than 2^32 can be drawn",
                        cells->count);
    for (int a = 0; a < 3; a++) {
        tree->centre[a] = 0.5 * f->low[a] + 0.5 * f->high[a];
        tree->scale = fmax(tree->scale, f->high[a] - f->low[a]);
    }
    if (!(tree->scale > 0))
        tree->scale = 1;
    tree->kinds = cwi_alloc_array(cells->count, sizeof *tree->kinds);
    tree->starts = cwi_alloc_array(cells->count, sizeof *tree->starts);
    cwi_boxes_segment segment = {0};
    if (only)
        segment = cwi_cell_tree_segment(tree, only);
    job work = {cells, tree, NULL, cwi_alloc_array(cells->count, sizeof *work.boxes),
                only ? &segment : NULL};
    cw_status st = tree->kinds && tree->starts && work.boxes ? fill_tree(&work, f, err)
                                                             : cwi_fail_memory(err);
    cwi_free(work.boxes);
    if (st != CW_OK)
        cwi_cell_tree_free(tree);
    return st;
}

/* Returns the largest finite absolute number among the samples, as stored. */
static double find_largest(const cw_volume *v)
{
    double largest = 0;
    for (size_t n = 0; n < v->dim[0]; n++) {
        const double x = fabs(cwi_voxel_at(v->type, cwi_voxel_address(v, n, 0, 0)));
        if (x <= 1.7e308 && x > largest)
            largest = x;
    }
    return largest;
}

cw_status cwi_cell_tree_need_gradients(const cwi_frame *f, cwi_cell_tree *tree, cw_error *err)
{
    const cw_volume *v = &f->gradient_volume;
    double factor;
    if (tree->gradients)
        return CW_OK;
    cwi_gradient_fit fit = {.volume = v, .largest = find_largest(v), .reach = tree->scale};
    memcpy(fit.centre, tree->centre, sizeof fit.centre);
    double(*fitted)[3] = cwi_alloc_array(v->dim[0], sizeof *fitted);
    float(*kept)[3] = cwi_alloc_array(v->dim[0], sizeof *kept);
    cw_status st = fitted && kept ? cwi_gradients_fit(&fit, v->dim[0], fitted, &factor, err)
                                  : cwi_fail_memory(err);
    for (size_t n = 0; n < v->dim[0] && st == CW_OK; n++)
        for (int a = 0; a < 3; a++) {
            const float g = (float)(fitted[n][a] / factor * v->slope);
            kept[n][a] = isfinite(g) ? g : 0;
        }
    cwi_free(fitted);
    if (st == CW_OK)
        tree->gradients = kept;
    else
        cwi_free(kept);
    return st;
}

void cwi_cell_tree_drop_gradients(cwi_cell_tree *tree)
{
    cwi_free(tree->gradients);
    tree->gradients = NULL;
}

void cwi_cell_tree_free(cwi_cell_tree *tree)
{
    cwi_boxes_free(&tree->boxes);
    cwi_free(tree->kinds);
    cwi_free(tree->starts);
    cwi_free(tree->gradients);
    *tree = (cwi_cell_tree){0};
}
