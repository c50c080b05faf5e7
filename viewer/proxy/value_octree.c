/* Builds an octree of a volume's mean values [Laur1991], and finds the error at which the
 * splats drawn fit a budget. */
#include "viewer/proxy/value_octree.h"

#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/volume/volume.h"

#include <math.h>

static const cwi_pyramid_node nothing = {0, INFINITY, -INFINITY, 0};

/* Sums over the parts of a node, added in a fixed order. */
typedef struct sum {
    double mass, value;
    float low, high;
} sum;

static void add_to_sum(sum *s, double mean, double mass, float low, float high)
{
    s->mass += mass;
    s->value += mass * mean;
    s->low = low < s->low ? low : s->low;
    s->high = high > s->high ? high : s->high;
}

static cwi_pyramid_node node_of(const sum *s)
{
    if (!(s->mass > 0))
        return nothing;
    return (cwi_pyramid_node){(float)(s->value / s->mass), s->low, s->high, (float)s->mass};
}

static cwi_pyramid_node sum_voxels(const cw_volume *v, bool has_gaps, const size_t node[3])
{
    sum s = {.low = INFINITY, .high = -INFINITY};
    for (size_t n = 0; n < 8; n++) {
        const size_t at[3] = {2 * node[0] + (n & 1), 2 * node[1] + (n >> 1 & 1),
                              2 * node[2] + (n >> 2)};
        if (at[0] >= v->dim[0] || at[1] >= v->dim[1] || at[2] >= v->dim[2])
            continue;
        const double mass = cwi_lattice_mass(v, at, has_gaps);
        const double value =
            v->slope * cwi_voxel_at(v->type, cwi_voxel_address(v, at[0], at[1], at[2])) +
            v->intercept;
        if (mass > 0) /* whose value then is one */
            add_to_sum(&s, value, mass, (float)value, (float)value);
    }
    return node_of(&s);
}

const cwi_pyramid_node *cwi_pyramid_node_at(const cwi_pyramid *pyramid, size_t level,
                                            const size_t node[3])
{
    const size_t *dim = pyramid->levels[level].dim;
    return &pyramid->levels[level].nodes[(node[2] * dim[1] + node[1]) * dim[0] + node[0]];
}

static cwi_pyramid_node sum_nodes(const cwi_pyramid *p, size_t level, const size_t node[3])
{
    sum s = {.low = INFINITY, .high = -INFINITY};
    const size_t *dim = p->levels[level].dim;
    for (size_t n = 0; n < 8; n++) {
        const size_t at[3] = {2 * node[0] + (n & 1), 2 * node[1] + (n >> 1 & 1),
                              2 * node[2] + (n >> 2)};
        if (at[0] >= dim[0] || at[1] >= dim[1] || at[2] >= dim[2])
            continue;
        const cwi_pyramid_node *c = cwi_pyramid_node_at(p, level, at);
        if (c->mass > 0)
            add_to_sum(&s, (double)c->mean, (double)c->mass, c->low, c->high);
    }
    return node_of(&s);
}

typedef struct filling {
    cwi_pyramid *pyramid;
    size_t level;
    const cw_volume *v;
    bool has_gaps;
} filling;

static void fill_layer(void *context, size_t k)
{
    const filling *f = context;
    const size_t *dim = f->pyramid->levels[f->level].dim;
    for (size_t j = 0; j < dim[1]; j++)
        for (size_t i = 0; i < dim[0]; i++) {
            const size_t at[3] = {i, j, k};
            f->pyramid->levels[f->level].nodes[(k * dim[1] + j) * dim[0] + i] =
                f->level == 0 ? sum_voxels(f->v, f->has_gaps, at)
                              : sum_nodes(f->pyramid, f->level - 1, at);
        }
}

cw_status cwi_pyramid_make(const cw_volume *volume, bool has_gaps, int threads,
                           const cw_progress *progress, cwi_pyramid *pyramid, cw_error *err)
{
    const size_t *below = volume->dim;
    size_t count = 0;
    cw_status st = CW_OK;
    *pyramid = (cwi_pyramid){0};
    do {
        size_t *dim = pyramid->levels[pyramid->level_count].dim;
        count = 1;
        for (int a = 0; a < 3; a++) {
            dim[a] = (below[a] + 1) / 2;
            count *= dim[a];
        }
        below = dim;
        cwi_pyramid_node *nodes = cwi_alloc_array(count, sizeof *nodes);
        pyramid->levels[pyramid->level_count].nodes = nodes;
        if (!nodes) {
            cwi_pyramid_free(pyramid);
            return cwi_fail_memory(err);
        }
        filling work = {pyramid, pyramid->level_count++, volume, has_gaps};
        st = cwi_parallel_for(dim[2], 8 * dim[0] * dim[1], threads, progress, "averaging",
                              fill_layer, &work, err);
    } while (count > 1 && st == CW_OK);
    if (st != CW_OK)
        cwi_pyramid_free(pyramid);
    return st;
}

void cwi_pyramid_free(cwi_pyramid *pyramid)
{
    for (size_t n = 0; n < pyramid->level_count; n++)
        cwi_free(pyramid->levels[n].nodes);
    *pyramid = (cwi_pyramid){0};
}

static float coordinate_of(const cwi_table *t, float value)
{
    const double at = ((double)value - t->low) / (t->high - t->low);
    return (float)fmin(fmax(at, 0), 1);
}

cwi_pyramid_look cwi_pyramid_look_at(const cwi_pyramid_view *view, const cwi_pyramid_node *node)
{
    if (!(node->mass > 0))
        return (cwi_pyramid_look){0};
    const float mean = coordinate_of(view->table, node->mean);
    const float low = coordinate_of(view->table, node->low);
    const float high = coordinate_of(view->table, node->high);
    return (cwi_pyramid_look){.mean = mean,
                              .error = fmaxf(high - mean, mean - low),
                              .shows_any = cwi_visible_any(view->visible, low, high),
                              .shows_mean = cwi_visible_any(view->visible, mean, mean)};
}

typedef struct tally {
    const cwi_pyramid *pyramid;
    const cwi_pyramid_view *view;
    ptrdiff_t *change; /* of the count, at each step of the error */
    size_t voxels;
} tally;

/* Counts `count` splats that are drawn with errors `from` or more, and less than `to`. */
static void draw_between(tally *t, size_t count, float from, float to)
{
    const double steps = CWI_PYRAMID_STEPS;
    if (!(from < to))
        return;
    t->change[(size_t)ceil((double)from * steps)] += (ptrdiff_t)count;
    if (to <= 1)
        t->change[(size_t)ceil((double)to * steps)] -= (ptrdiff_t)count;
}

static void tally_voxels(tally *t, const size_t node[3], float end)
{
    const cw_volume *v = &t->view->frame->volume;
    for (size_t n = 0; n < 8; n++) {
        const size_t at[3] = {2 * node[0] + (n & 1), 2 * node[1] + (n >> 1 & 1),
                              2 * node[2] + (n >> 2)};
        float value;
        if (at[0] >= v->dim[0] || at[1] >= v->dim[1] || at[2] >= v->dim[2])
            continue;
        cwi_lattice_load(&t->view->frame->volume, t->view->table, at, (size_t[]){1, 1, 1},
                         &value);
        if (!cwi_visible_any(t->view->visible, value, value))
            continue;
        t->voxels++;
        draw_between(t, 1, 0, end);
    }
}

/* end: the least error of the nodes above, from which on one of them is drawn instead */
static void tally_node(tally *t, size_t level, const size_t node[3], float end)
{
    const cwi_pyramid_node *n = cwi_pyramid_node_at(t->pyramid, level, node);
    const cwi_pyramid_look look = cwi_pyramid_look_at(t->view, n);
    if (!look.shows_any)
        return;
    const int a = t->view->axis;
    const size_t first = node[a] << (level + 1), left = t->view->frame->volume.dim[a] - first;
    const size_t edge = (size_t)2 << level;
    if (look.shows_mean)
        draw_between(t, left < edge ? left : edge, look.error, end);
    const float rest = fminf(end, look.error);
    if (level == 0) {
        tally_voxels(t, node, rest);
        return;
    }
    const size_t *dim = t->pyramid->levels[level - 1].dim;
    for (size_t c = 0; c < 8; c++) {
        const size_t at[3] = {2 * node[0] + (c & 1), 2 * node[1] + (c >> 1 & 1),
                              2 * node[2] + (c >> 2)};
        if (at[0] < dim[0] && at[1] < dim[1] && at[2] < dim[2])
            tally_node(t, level - 1, at, rest);
    }
}

/* Counts splats for all errors in one walk through the tree: each node is drawn for errors from
 * its own up to the least above it. */
void cwi_pyramid_counts(const cwi_pyramid *pyramid, const cwi_pyramid_view *view,
                        size_t *counts)
{
    ptrdiff_t change[CWI_PYRAMID_STEPS + 1] = {0}, drawn = 0;
    tally t = {pyramid, view, change, 0};
    tally_node(&t, pyramid->level_count - 1, (size_t[]){0, 0, 0}, INFINITY);
    for (size_t n = 0; n <= CWI_PYRAMID_STEPS; n++) {
        drawn += change[n];
        counts[n] = (size_t)drawn;
    }
    counts[0] = t.voxels;
}

cw_status cwi_pyramid_fit(const cwi_pyramid *pyramid, const cwi_pyramid_view *view,
                          size_t budget, double *error, cw_error *err)
{
    size_t n = 0;
    size_t *counts = cwi_alloc_array(CWI_PYRAMID_STEPS + 1, sizeof *counts);
    if (!counts)
        return cwi_fail_memory(err);
    cwi_pyramid_counts(pyramid, view, counts);
    while (n < CWI_PYRAMID_STEPS && counts[n] > budget)
        n++;
    *error = (double)n / CWI_PYRAMID_STEPS;
    cwi_free(counts);
    return CW_OK;
}
