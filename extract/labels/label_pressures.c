/* Gives labels the volumes of their voxels. Directions of vertices are computed once.
 * Source  conjugate gradients [Hestenes1952], on a graph of labels whose edges are interfaces */
#include "extract/labels/label_pressures.h"

#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/geometry/affine.h"
#include "core/geometry/vec3.h"
#include "core/mesh/mesh_triangle.h"

#include <math.h>
#include <string.h>

enum {
    ROUNDS = 8,
    SMALL = 64 /* voxels */,
    SOLVER_ROUNDS = 300,
    PART = 1 << 14,
    CURVE_PART = 1 << 10
};

/* The fraction of its volume that a label may lack. */
static const double MAX_DEFICIT = 5e-6;

/* The most that a label asks for, by what it lacks. */
static const double MAX_STEP_SCALE = 8;

/* The fraction that ends the smoothing of a small one. */
static const double MAX_SMALL_DEFICIT = 0.01;

/* The least part of a pressure's effect that is reckoned with. */
static const double MIN_ALIGNMENT = 0.2;

/* The sum of the triangles' area vectors around a vertex in one patch. */
typedef struct direction {
    float normal[3], area;
    uint32_t patch;
} direction;

typedef struct volume_solver {
    cwi_label_net *net;
    cw_label_surfaces *surfaces;
    const float *originals;
    float bound;
    double side; /* on which triangles have their normals in the grid: -1 if the world is a
                    mirror image of it */
    const size_t *dim;
    size_t labels;
    double (
        *requests)[2]; /* of labels: the volume that lacked in the round before, and by how many
                                times it was asked for */
    size_t *patch_counts;    /* of labels, and the background */
    double *volumes, *areas; /* of patches: inside labels[0], signed; and of triangles */
    double (*alignments)
        [2]; /* of patches: their vertices' normals, and areas to hold them against */
    uint32_t (*sides)[2];  /* numbers of a patch's labels; `labels`: the background */
    double *pressures;     /* 4 x (labels + 1) numbers to solve with; these come first */
    direction *directions; /* of vertices */
    size_t curve_count;
    uint32_t *curve;         /* vertices on curves */
    size_t *curve_firsts;    /* curve_count + 1: where a vertex's part of `shares` begins */
    direction *curve_shares; /* of a vertex on a curve in each of its patches */
    bool is_first;           /* round */
} volume_solver;

/* Computes a triangle's normal on the outside, as long as twice its area. */
static inline void find_normal(const volume_solver *s, size_t t, double normal[3])
{
    cwi_mesh_normal(&s->surfaces->mesh, t, normal);
    for (int a = 0; a < 3; a++)
        normal[a] *= s->side;
}

/* Adds a triangle to the directions of its vertices that are in one patch. */
static void add_directions(const volume_solver *s, size_t t, size_t patch,
                           const double normal[3], double area)
{
    for (size_t c = 0; c < 3; c++) {
        const uint32_t v = s->surfaces->mesh.triangles[3 * t + c];
        direction *to = &s->directions[v];
        if (s->net->kinds[v])
            continue;
        for (int a = 0; a < 3; a++)
            to->normal[a] += (float)normal[a];
        to->area += (float)area;
        to->patch = (uint32_t)patch;
    }
}

/* Measures a patch: the volume between it and the middle, and its area. A label that smoothing
 * has shrunk to almost nothing has a fair area after the first round only. */
static void measure_patch(void *context, size_t n)
{
    const volume_solver *s = context;
    const cw_label_patch *patch = &s->surfaces->patches[n];
    const double middle[3] = {0.5 * (double)s->dim[0], 0.5 * (double)s->dim[1],
                              0.5 * (double)s->dim[2]};
    double volume = 0, areas = 0;
    for (size_t t = patch->first; t < patch->first + patch->count; t++) {
        double normal[3], from[3];
        find_normal(s, t, normal);
        cwi_mesh_corner(&s->surfaces->mesh, t, 0, from);
        cwi_sub(from, middle, from);
        volume += cwi_dot(from, normal);
        const double area = cwi_length(normal);
        areas += area;
        if (s->is_first)
            add_directions(s, t, n, normal, area);
    }
    s->volumes[n] = volume / 6;
    s->areas[n] = areas / 2;
}

/* Returns true if a vertex closes a label at the volume's border: it stays in that plane. */
static bool is_held(const volume_solver *s, size_t v, int axis)
{
    const float original = s->originals[3 * v + (size_t)axis];
    return original < 0 || original > (float)s->dim[axis] - 1;
}

/* Sums up how far apart the normals around vertices are: a vertex in a corner of three faces moves
 * each by a third of its own way. Normals lose what would lead out of the border's plane. */
static void measure_alignments(const volume_solver *s)
{
    for (size_t v = 0; v < s->surfaces->mesh.vertex_count; v++) {
        direction *d = &s->directions[v];
        if (s->net->kinds[v] || !(d->area > 0))
            continue;
        double normal_sq = 0;
        for (int a = 0; a < 3; a++) {
            if (is_held(s, v, a))
                d->normal[a] = 0;
            normal_sq += (double)d->normal[a] * (double)d->normal[a];
        }
        s->alignments[d->patch][0] += normal_sq / (double)d->area;
        s->alignments[d->patch][1] += (double)d->area;
    }
}

/* Scales the areas of patches: the weights of the graph Laplacian of labels. */
static void scale_areas(const volume_solver *s)
{
    for (size_t n = 0; n < s->surfaces->patch_count; n++) {
        const double *alignment = s->alignments[n],
                     weight = alignment[1] > 0 ? alignment[0] / alignment[1] : 1;
        s->areas[n] *= weight > MIN_ALIGNMENT ? weight : MIN_ALIGNMENT;
    }
}

/* Multiplies by the graph Laplacian of labels, whose edges are patches weighted by area: how volumes
 * change with pressures. */
static void apply_laplacian(const volume_solver *s, const double *x, double *y)
{
    memset(y, 0, (s->labels + 1) * sizeof *y);
    for (size_t n = 0; n < s->surfaces->patch_count; n++) {
        const uint32_t *side = s->sides[n];
        const double flow = s->areas[n] * (x[side[0]] - x[side[1]]);
        y[side[0]] += flow;
        y[side[1]] -= flow;
    }
    y[s->labels] = 0; /* the background has none */
}

static double dot_all(const double *x, const double *y, size_t count)
{
    double sum = 0;
    for (size_t n = 0; n < count; n++)
        sum += x[n] * y[n];
    return sum;
}

/* Solves for the pressures that add the missing volumes, by conjugate gradients. */
static void solve_pressures(const volume_solver *s)
{
    const size_t count = s->labels + 1;
    double *x = s->pressures, *r = x + count, *p = r + count, *q = p + count;
    memset(x, 0, count * sizeof *x);
    memcpy(p, r, count * sizeof *p);
    double residual_sq = dot_all(r, r, count);
    const double end = 1e-12 * residual_sq;
    for (int n = 0; n < SOLVER_ROUNDS && residual_sq > end; n++) {
        apply_laplacian(s, p, q);
        const double curvature = dot_all(p, q, count);
        if (!(curvature > 0))
            return;
        const double step = residual_sq / curvature;
        for (size_t i = 0; i < count; i++) {
            x[i] += step * p[i];
            r[i] -= step * q[i];
        }
        const double next_sq = dot_all(r, r, count);
        for (size_t i = 0; i < count; i++)
            p[i] = r[i] + next_sq / residual_sq * p[i];
        residual_sq = next_sq;
    }
}

/* Returns the difference of pressures across a patch. */
static double pressure_difference(const volume_solver *s, size_t patch)
{
    return s->pressures[s->sides[patch][0]] - s->pressures[s->sides[patch][1]];
}

/* Finds the patch of a triangle. */
static size_t find_patch(const cw_label_surfaces *f, size_t triangle)
{
    size_t low = 0, high = f->patch_count;
    while (high - low > 1) {
        const size_t middle = low + (high - low) / 2;
        if (f->patches[middle].first <= triangle)
            low = middle;
        else
            high = middle;
    }
    return low;
}

/* Finds the patches of a vertex on a curve, which rise. Returns their number; the shares of the
 * vertex in them are summed up where `shares` is not NULL, and zeroed. */
static size_t find_curve_shares(const volume_solver *s, uint32_t vertex, direction *shares)
{
    const cwi_label_net *net = s->net;
    const cw_label_surfaces *f = s->surfaces;
    size_t patch_end = 0, count = 0;
    for (uint32_t k = net->firsts[vertex]; k < net->firsts[vertex + 1]; k++) {
        if (net->around[k] >= patch_end) { /* they rise */
            const size_t patch = find_patch(f, net->around[k]);
            patch_end = f->patches[patch].first + f->patches[patch].count;
            count++;
            if (shares)
                shares[count - 1].patch = (uint32_t)patch;
        }
        if (!shares)
            continue;
        const size_t end = cwi_polygon_end(net, &f->mesh, net->around[k]);
        for (size_t t = net->around[k]; t < end; t++) {
            const uint32_t *v = f->mesh.triangles + 3 * t;
            double normal[3];
            if (v[0] != vertex && v[1] != vertex && v[2] != vertex)
                continue;
            find_normal(s, t, normal);
            for (int a = 0; a < 3; a++)
                shares[count - 1].normal[a] += (float)normal[a];
            shares[0].area += (float)cwi_length(normal);
        }
    }
    return count;
}

static void count_curve_part(void *context, size_t n)
{
    const volume_solver *s = context;
    for (size_t i = n * CURVE_PART; i < (n + 1) * CURVE_PART && i < s->curve_count; i++)
        s->curve_firsts[i + 1] = find_curve_shares(s, s->curve[i], NULL);
}

static void fill_curve_part(void *context, size_t n)
{
    const volume_solver *s = context;
    for (size_t i = n * CURVE_PART; i < (n + 1) * CURVE_PART && i < s->curve_count; i++)
        find_curve_shares(s, s->curve[i], s->curve_shares + s->curve_firsts[i]);
}

static cw_status run_curves(volume_solver *s, void (*work)(void *, size_t),
                            const cw_labels_desc *desc, cw_error *err)
{
    return cwi_parallel_for((s->curve_count + CURVE_PART - 1) / CURVE_PART, 32 * CURVE_PART,
                            desc->threads, &desc->progress, "keeping volumes", work, s, err);
}

/* Finds the shares of all vertices on curves, once: the first holds the area of all. */
static cw_status measure_curves(volume_solver *s, const cw_labels_desc *desc, cw_error *err)
{
    s->curve_firsts[0] = 0;
    cw_status st = run_curves(s, count_curve_part, desc, err);
    if (st != CW_OK)
        return st;
    for (size_t i = 0; i < s->curve_count; i++)
        s->curve_firsts[i + 1] += s->curve_firsts[i];
    s->curve_shares =
        cwi_alloc_zeroed(s->curve_firsts[s->curve_count], sizeof *s->curve_shares);
    return s->curve_shares ? run_curves(s, fill_curve_part, desc, err) : cwi_fail_memory(err);
}

static void move_vertex(const volume_solver *s, size_t v, const float move[3])
{
    float *p = s->surfaces->mesh.positions + 3 * v;
    const float *o = s->originals + 3 * v;
    for (int a = 0; a < 3; a++) {
        const float low = o[a] - s->bound, high = o[a] + s->bound, to = p[a] + move[a];
        if (!is_held(s, v, a))
            p[a] = to < low ? low : to > high ? high : to;
    }
}

static void move_curve_part(void *context, size_t n)
{
    const volume_solver *s = context;
    for (size_t i = n * CURVE_PART; i < (n + 1) * CURVE_PART && i < s->curve_count; i++) {
        const direction *shares = s->curve_shares + s->curve_firsts[i];
        const size_t count = s->curve_firsts[i + 1] - s->curve_firsts[i];
        float move[3] = {0};
        if (count == 0 || !(shares[0].area > 0))
            continue;
        for (size_t k = 0; k < count; k++) {
            const float by = (float)pressure_difference(s, shares[k].patch) / shares[0].area;
            for (int a = 0; a < 3; a++)
                move[a] += by * shares[k].normal[a];
        }
        move_vertex(s, s->curve[i], move);
    }
}

static void move_part(void *context, size_t n)
{
    const volume_solver *s = context;
    const size_t count = s->surfaces->mesh.vertex_count;
    for (size_t v = n * PART; v < (n + 1) * PART && v < count; v++) {
        const direction *d = &s->directions[v];
        if (s->net->kinds[v] || !(d->area > 0))
            continue;
        const float by = (float)pressure_difference(s, d->patch) / d->area;
        move_vertex(s, v, (float[3]){by * d->normal[0], by * d->normal[1], by * d->normal[2]});
    }
}

static cw_status move_all(volume_solver *s, const cw_labels_desc *desc, cw_error *err)
{
    const size_t vertices = s->surfaces->mesh.vertex_count;
    cw_status st = run_curves(s, move_curve_part, desc, err);
    if (st == CW_OK)
        st = cwi_parallel_for((vertices + PART - 1) / PART, PART, desc->threads,
                              &desc->progress, "keeping volumes", move_part, s, err);
    return st;
}

/* Finds a label's number; the background's is the count of labels. */
static uint32_t number_of(const cw_label_surfaces *s, uint32_t label)
{
    size_t low = 0, high = s->label_count;
    while (low < high) {
        const size_t middle = low + (high - low) / 2;
        if (s->labels[middle].label < label)
            low = middle + 1;
        else
            high = middle;
    }
    return (uint32_t)(label == s->background ? s->label_count : low);
}

/* Computes the volumes that labels lack. Returns true if they are as good as none. */
static bool find_volume_deficits(const volume_solver *s)
{
    const cw_label_surfaces *f = s->surfaces;
    double *deficit = s->pressures + s->labels + 1;
    bool is_full = true;
    for (size_t n = 0; n < s->labels; n++)
        deficit[n] = (double)f->labels[n].voxels;
    deficit[s->labels] = 0;
    for (size_t n = 0; n < f->patch_count; n++) {
        deficit[s->sides[n][0]] -= s->volumes[n];
        deficit[s->sides[n][1]] += s->volumes[n];
    }
    deficit[s->labels] = 0;
    for (size_t n = 0; n < s->labels && is_full; n++)
        is_full = fabs(deficit[n]) <= MAX_DEFICIT * (double)f->labels[n].voxels;
    return is_full;
}

/* Asks for more of labels that got less than they lacked in the round before: the bound holds some
 * of their vertices. */
static void scale_deficits(const volume_solver *s)
{
    double *deficit = s->pressures + s->labels + 1;
    for (size_t n = 0; n < s->labels; n++) {
        double *last = s->requests[n];
        const double gained = last[0] != 0 ? 1 - deficit[n] / last[0] : 1;
        const double step_scale = last[1] > 0 ? last[1] : 1;
        last[1] = gained > 0.1 && gained < 0.9 ? fmin(step_scale / gained, MAX_STEP_SCALE)
                  : gained >= 1.1              ? 1
                                               : step_scale;
        last[0] = deficit[n];
        deficit[n] *= last[1];
    }
}

/* Puts a vertex back to where it was if its patch is around a label of a few voxels that lies in one
 * other label, and still lacks too much: there it has its volume. Smoothing had made it flat. */
static void restore_vertex(const volume_solver *s, size_t v, size_t patch)
{
    const cw_label_surfaces *f = s->surfaces;
    const double *deficit = s->pressures + s->labels + 1;
    for (int side = 0; side < 2; side++) {
        const uint32_t label = s->sides[patch][side];
        if (label < s->labels && s->patch_counts[label] == 1 &&
            f->labels[label].voxels <= SMALL &&
            fabs(deficit[label]) > MAX_SMALL_DEFICIT * (double)f->labels[label].voxels)
            memcpy(f->mesh.positions + 3 * v, s->originals + 3 * v, 3 * sizeof(float));
    }
}

static void restore_small(const volume_solver *s)
{
    const cw_label_surfaces *f = s->surfaces;
    for (size_t n = 0; n < f->patch_count; n++)
        for (int side = 0; side < 2; side++)
            s->patch_counts[s->sides[n][side]]++;
    for (size_t v = 0; v < f->mesh.vertex_count; v++)
        if (!s->net->kinds[v] && s->directions[v].area > 0)
            restore_vertex(s, v, s->directions[v].patch);
    for (size_t i = 0; i < s->curve_count && s->curve_shares; i++)
        if (s->curve_firsts[i + 1] - s->curve_firsts[i] == 1) /* the edge of a cap */
            restore_vertex(s, s->curve[i], s->curve_shares[s->curve_firsts[i]].patch);
}

static cw_status restore_volumes(volume_solver *s, const cw_labels_desc *desc, cw_error *err)
{
    const cw_label_surfaces *f = s->surfaces;
    const size_t triangles = f->mesh.triangle_count / (f->patch_count + 1);
    cw_status st = CW_OK;
    for (int round = 0; st == CW_OK; round++) {
        s->is_first = round == 0;
        st = cwi_parallel_for(f->patch_count, 8 * triangles, desc->threads, &desc->progress,
                              "keeping volumes", measure_patch, s, err);
        if (st != CW_OK || find_volume_deficits(s) || round == ROUNDS)
            break;
        if (s->is_first) {
            measure_alignments(s);
            st = measure_curves(s, desc, err);
            if (st != CW_OK)
                break;
        }
        scale_areas(s);
        scale_deficits(s);
        solve_pressures(s);
        st = move_all(s, desc, err);
    }
    if (st == CW_OK)
        restore_small(s);
    return st;
}

/* Lists vertices on curves, and numbers the labels of patches. */
static bool prepare_solver(volume_solver *s)
{
    const cw_label_surfaces *f = s->surfaces;
    const size_t vertices = f->mesh.vertex_count;
    const uint8_t *kinds = s->net->kinds;
    for (size_t v = 0; v < vertices; v++)
        s->curve_count += kinds[v] != 0 && !(kinds[v] & CWI_NET_FIXED);
    s->directions = cwi_renew_large(s->net->neighbours, vertices, sizeof *s->directions);
    s->net->neighbours = NULL;
    s->volumes = cwi_alloc_array(f->patch_count, sizeof *s->volumes);
    s->areas = cwi_alloc_array(f->patch_count, sizeof *s->areas);
    s->patch_counts = cwi_alloc_zeroed(s->labels + 1, sizeof *s->patch_counts);
    s->requests = cwi_alloc_zeroed(s->labels, sizeof *s->requests);
    s->alignments = cwi_alloc_zeroed(f->patch_count, sizeof *s->alignments);
    s->sides = cwi_alloc_array(f->patch_count, sizeof *s->sides);
    s->pressures = cwi_alloc_zeroed(4 * (s->labels + 1), sizeof *s->pressures);
    s->curve = cwi_alloc_array(s->curve_count, sizeof *s->curve);
    s->curve_firsts = cwi_alloc_array(s->curve_count + 1, sizeof *s->curve_firsts);
    if (!s->directions || !s->volumes || !s->areas || !s->alignments || !s->requests ||
        !s->patch_counts || !s->sides || !s->pressures || !s->curve || !s->curve_firsts)
        return false;
    memset(s->directions, 0, vertices * sizeof *s->directions);
    s->curve_count = 0;
    for (size_t v = 0; v < vertices; v++)
        if (kinds[v] != 0 && !(kinds[v] & CWI_NET_FIXED))
            s->curve[s->curve_count++] = (uint32_t)v;
    for (size_t n = 0; n < f->patch_count; n++)
        for (int side = 0; side < 2; side++)
            s->sides[n][side] = number_of(f, f->patches[n].labels[side]);
    return true;
}

cw_status cwi_labels_keep_volumes(cwi_label_net *net, const float *originals,
                                  cw_label_surfaces *surfaces, const cw_labels_desc *desc,
                                  const size_t dim[3], cw_error *err)
{
    volume_solver s = {.net = net,
                       .surfaces = surfaces,
                       .originals = originals,
                       .bound = (float)desc->max_move,
                       .side = cwi_affine_determinant(surfaces->mesh.affine[0]) < 0 ? -1 : 1,
                       .dim = dim,
                       .labels = surfaces->label_count};
    cw_status st = prepare_solver(&s) ? restore_volumes(&s, desc, err) : cwi_fail_memory(err);
    cwi_free(s.directions);
    cwi_free(s.volumes);
    cwi_free(s.areas);
    cwi_free(s.alignments);
    cwi_free(s.requests);
    cwi_free(s.patch_counts);
    cwi_free(s.sides);
    cwi_free(s.pressures);
    cwi_free(s.curve);
    cwi_free(s.curve_firsts);
    cwi_free(s.curve_shares);
    return st;
}
