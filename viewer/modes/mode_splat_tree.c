/* Draws a volume by hierarchical splatting. Nodes of an octree whose values are near enough to
 * their mean are one splat in each sheet they are in. */
#include "viewer/modes/splat_sheets.h"
#include "viewer/proxy/value_octree.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/vec3.h"
#include "viewer/modes/gl_draw.h"

#include <math.h>
#include <string.h>

/* State kept between pictures of a volume. It includes the last error that was fitted, since
 * fitting walks through the whole tree. */
typedef struct tree {
    cwi_pyramid pyramid;
    size_t budget; /* that it was fitted to; 0: none was */
    int axis;
    cw_transfer transfer;
    double error;
} tree;

typedef struct walk {
    cwi_splats splats;
    const cwi_pyramid *pyramid;
    cwi_pyramid_view view;
    float error;
    size_t sheet; /* that is being drawn */
} walk;

/* Finds the voxels of a node along an axis: the first, and the one after the last. */
static void find_voxels(const walk *w, int axis, size_t level, size_t n, size_t at[2])
{
    const size_t dim = w->splats.frame->volume.dim[axis], end = (n + 1) << (level + 1);
    at[0] = n << (level + 1);
    at[1] = end < dim ? end : dim;
}

/* Returns true if a clip plane goes through a node. */
static bool is_clipped(const cwi_splats *s, const double eye[3], const float size[3])
{
    const double *m = s->frame->eye_from_index;
    for (size_t n = 0; n < s->frame->scene.clip_count; n++) {
        const double *plane = s->frame->clips[n];
        double reach = 0;
        for (int a = 0; a < 3; a++)
            reach += (double)size[a] / 2 *
                     fabs(plane[0] * m[a] + plane[1] * m[4 + a] + plane[2] * m[8 + a]);
        if (fabs(cwi_dot(plane, eye) - plane[3]) < reach)
            return true;
    }
    return false;
}

static bool is_too_near(const cwi_splats *s, const double eye[3], const float size[3])
{
    const float max = fmaxf(fmaxf(size[0], size[1]), size[2]);
    return s->frame->perspective && -eye[2] <= s->radius * (1 + (double)max);
}

/* Returns the slope of the means of the nodes on both sides, or of their indices, in the unit of
 * gradients, per voxel. */
static float slope_at(const walk *w, size_t level, const size_t node[3], int axis)
{
    size_t low[3], high[3];
    const size_t *dim = w->pyramid->levels[level].dim;
    const cwi_pyramid_node *nodes = w->pyramid->levels[level].nodes;
    for (int a = 0; a < 3; a++)
        low[a] = high[a] = node[a];
    low[axis] -= low[axis] > 0;
    high[axis] += high[axis] + 1 < dim[axis];
    const cwi_pyramid_node *x = &nodes[(low[2] * dim[1] + low[1]) * dim[0] + low[0]],
                           *y = &nodes[(high[2] * dim[1] + high[1]) * dim[0] + high[0]];
    if (low[axis] == high[axis] || !(x->mass > 0) || !(y->mass > 0))
        return 0;
    const size_t away = (high[axis] - low[axis]) << (level + 1);
    const cw_transfer *t = &w->splats.frame->transfer;
    const double rise =
        cw_transfer_index(t, (double)y->mean) - cw_transfer_index(t, (double)x->mean);
    return (float)(rise / (double)away / w->splats.gl->volume.gradient_unit);
}

/* Finds a node's box; it ends half a voxel beyond its voxels, or at the volume's border. */
static void find_box(const walk *w, const size_t at[3][2], double low[3], double high[3])
{
    const cwi_frame *f = w->splats.frame;
    for (int a = 0; a < 3; a++) {
        low[a] = fmax((double)at[a][0] - 0.5, f->low[a]);
        high[a] = fmin((double)at[a][1] - 0.5, f->high[a]);
    }
}

/* Splats the part of a node that is in the current sheet. */
static void splat_node(walk *w, size_t level, const size_t node[3], const double low[3],
                       const double high[3], const double eye[3])
{
    const int axis = w->splats.axis;
    const double from = fmax((double)w->sheet - 0.5, low[axis]);
    const double to = fmin((double)w->sheet + 0.5, high[axis]);
    const cwi_pyramid_node *n = cwi_pyramid_node_at(w->pyramid, level, node);
    cwi_splat splat = {.value = cwi_pyramid_look_at(&w->view, n).mean, .is_node = 1};
    double volume = 1;
    for (int a = 0; a < 3; a++) {
        splat.at[a] = (float)((low[a] + high[a]) / 2);
        splat.size[a] = (float)(high[a] - low[a]);
        volume *= high[a] - low[a];
        if (w->splats.needs_gradients)
            splat.gradient[a] = slope_at(w, level, node, a);
    }
    splat.at[axis] = (float)w->sheet;
    splat.mass = (float)((double)n->mass / volume * (to - from));
    cwi_splats_add(&w->splats, &splat, eye);
}

static void visit_node(walk *w, size_t level, const size_t node[3]);

static void visit_parts(walk *w, size_t level, const size_t node[3])
{
    const int axis = w->splats.axis;
    const size_t *dim =
        level > 0 ? w->pyramid->levels[level - 1].dim : w->splats.frame->volume.dim;
    for (size_t c = 0; c < 8; c++) {
        const size_t at[3] = {2 * node[0] + (c & 1), 2 * node[1] + (c >> 1 & 1),
                              2 * node[2] + (c >> 2)};
        if (at[0] >= dim[0] || at[1] >= dim[1] || at[2] >= dim[2])
            continue;
        if (level > 0)
            visit_node(w, level - 1, at);
        else if (at[axis] == w->sheet)
            cwi_splats_voxel(&w->splats, at);
    }
}

/* Visits a node, and goes down to the nodes drawn in the sheet. */
static void visit_node(walk *w, size_t level, const size_t node[3])
{
    size_t at[3][2];
    double low[3], high[3], middle[3], eye[3];
    float size[3];
    for (int a = 0; a < 3; a++)
        find_voxels(w, a, level, node[a], at[a]);
    const size_t *sheets = at[w->splats.axis];
    if (w->splats.status != CW_OK)
        return;
    if (w->sheet < sheets[0] || w->sheet >= sheets[1])
        return;
    const cwi_pyramid_look look =
        cwi_pyramid_look_at(&w->view, cwi_pyramid_node_at(w->pyramid, level, node));
    if (!look.shows_any)
        return;
    find_box(w, (const size_t(*)[2])at, low, high);
    for (int a = 0; a < 3; a++) {
        middle[a] = (low[a] + high[a]) / 2;
        size[a] = (float)(high[a] - low[a]);
    }
    const bool is_kept = cwi_splats_keep(&w->splats, middle, eye);
    if (look.error > w->error || is_clipped(&w->splats, eye, size) ||
        is_too_near(&w->splats, eye, size))
        visit_parts(w, level, node);
    else if (is_kept && look.shows_mean)
        splat_node(w, level, node, low, high, eye);
}

static cw_status draw_sheets(walk *w, cw_error *err)
{
    static const size_t root[3] = {0};
    cwi_splats *s = &w->splats;
    cw_status st = CW_OK;
    size_t *order = cwi_splats_order(s, err);
    if (!order)
        return CW_ERR_NO_MEMORY;
    for (size_t n = 0; n < s->frame->volume.dim[s->axis] && st == CW_OK; n++) {
        w->sheet = order[n];
        cwi_gl_part(s->gl, n, s->frame->volume.dim[s->axis]);
        visit_node(w, w->pyramid->level_count - 1, root);
        st = cwi_splats_end_sheet(s, n, err);
    }
    cwi_free(order);
    return st;
}

static void drop_splat_tree(void *state)
{
    tree *t = state;
    cwi_pyramid_free(&t->pyramid);
    cwi_free(t);
}

static cw_status make_tree(const cwi_gl *gl, void **out, cw_error *err)
{
    const cwi_frame *f = gl->frame;
    tree *t = cwi_alloc_zeroed(1, sizeof *t);
    if (!t)
        return cwi_fail_memory(err);
    cw_status st = cwi_pyramid_make(&f->volume, gl->volume.ranges.has_gaps, f->scene.threads,
                                    &gl->watch.progress, &t->pyramid, err);
    if (st == CW_OK)
        *out = t;
    else
        drop_splat_tree(t);
    return st;
}

static bool is_fitted(const tree *t, const walk *w)
{
    const cwi_frame *f = w->splats.frame;
    return t->budget == f->scene.splat.budget && t->axis == w->splats.axis &&
           memcmp(&t->transfer, &f->transfer, sizeof t->transfer) == 0;
}

static cw_status fit_error(tree *t, const walk *w, cw_error *err)
{
    const cwi_frame *f = w->splats.frame;
    cw_status st =
        cwi_pyramid_fit(&t->pyramid, &w->view, f->scene.splat.budget, &t->error, err);
    t->budget = st == CW_OK ? f->scene.splat.budget : 0;
    t->axis = w->splats.axis;
    memcpy(&t->transfer, &f->transfer, sizeof t->transfer);
    return st;
}

static cw_status choose_error(tree *t, walk *w, cw_error *err)
{
    const cw_scene *s = &w->splats.frame->scene;
    const bool has_budget = s->splat.budget > 0;
    cw_status st = has_budget && !is_fitted(t, w) ? fit_error(t, w, err) : CW_OK;
    w->error = (float)fmax(has_budget ? t->error : 0, s->splat.tree_error);
    return st;
}

static cw_status draw_splat_tree(cwi_gl *gl, void **state, cw_error *err)
{
    walk w = {0};
    cw_status st = *state ? CW_OK : make_tree(gl, state, err);
    if (st != CW_OK)
        return st;
    tree *t = *state;
    w.pyramid = &t->pyramid;
    st = cwi_splats_open(
        &w.splats, gl,
        gl->frame->scene.splat.tree_error > 0 || gl->frame->scene.splat.budget > 0, err);
    w.view =
        (cwi_pyramid_view){gl->frame, &gl->transfer.table, &w.splats.visible, w.splats.axis};
    if (st == CW_OK)
        st = choose_error(t, &w, err);
    if (st == CW_OK)
        st = w.error > 0 ? draw_sheets(&w, err) : cwi_splats_flat(&w.splats, err);
    cwi_splats_close(&w.splats);
    return st;
}

const cwi_gl_mode cwi_gl_splat_tree = {CW_MODE_SPLAT_TREE, false, draw_splat_tree,
                                       drop_splat_tree, false};
