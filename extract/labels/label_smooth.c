/* Smooths the interfaces of a label map: rounds of averages with the cubes beside, in a box around
 * each vertex [Gibson1998]; then labels get their volumes back by pressures, which move each
 * interface along its normal by the difference of its two labels' pressures. */
#include "extract/labels/label_smooth.h"

#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/geometry/affine.h"
#include "core/geometry/vec3.h"

#include <math.h>
#include <string.h>

enum { ROUNDS = 16, VOLUME_ROUNDS = 5, SOLVER_ROUNDS = 300, PART = 1 << 14 };

/* The fraction of the way to the neighbours' mean. */
static const float pull = 0.5f;

/* Vertices stay this far inside of their cubes, in voxels: those of two cubes never meet. */
static const double margin = 1e-3;

typedef struct smoother {
    const cwi_label_net *net;
    cw_label_surfaces *surfaces;
    const float *originals;
    float *next;
    float bound;
    bool is_open;
    double side; /* on which triangles have their normals in the grid: -1 if the world is a
                    mirror image of it */
    const size_t *dim;
    size_t labels;
    double *volumes, *areas; /* of patches: inside labels[0], signed; and of triangles */
    uint32_t (*sides)[2];    /* numbers of a patch's labels; `labels`: the background */
} smoother;

/* Keeps a place in the box around the vertex's first place, and on an open border. */
static void keep_in_box(const smoother *s, size_t v, float p[3])
{
    const float *o = s->originals + 3 * v;
    for (int a = 0; a < 3; a++) {
        const float low = o[a] - s->bound, high = o[a] + s->bound;
        const bool is_border = s->is_open && (o[a] < 0 || o[a] > (float)s->dim[a] - 1);
        p[a] = is_border ? o[a] : p[a] < low ? low : p[a] > high ? high : p[a];
    }
}

/* Averages a vertex with its neighbours: one on a curve where labels meet, with those on the
 * curve. */
static void average_vertex(const smoother *s, size_t v)
{
    const float *from = s->surfaces->mesh.positions;
    const uint32_t *neighbours = s->net->neighbours[v];
    const uint8_t kind = s->net->kinds[v];
    float mean[3] = {0}, *to = s->next + 3 * v;
    int count = 0;
    for (int n = 0; n < 6; n++) {
        if (neighbours[n] == UINT32_MAX || (kind && !(kind >> n & 1)))
            continue;
        for (int a = 0; a < 3; a++)
            mean[a] += from[3 * (size_t)neighbours[n] + (size_t)a];
        count++;
    }
    const bool stays = kind == CWI_NET_FIXED || count < 2;
    for (int a = 0; a < 3; a++) {
        const float here = from[3 * v + (size_t)a];
        to[a] = stays ? here : here + pull * (mean[a] / (float)count - here);
    }
    if (!stays)
        keep_in_box(s, v, to);
}

static void average_part(void *context, size_t n)
{
    const smoother *s = context;
    const size_t count = s->surfaces->mesh.vertex_count;
    for (size_t v = n * PART; v < (n + 1) * PART && v < count; v++)
        average_vertex(s, v);
}

static size_t count_parts(const smoother *s)
{
    return (s->surfaces->mesh.vertex_count + PART - 1) / PART;
}

static cw_status average_all(smoother *s, const cw_labels_desc *desc, cw_error *err)
{
    cw_status st = CW_OK;
    for (int round = 0; round < ROUNDS && st == CW_OK; round++) {
        float *before = s->surfaces->mesh.positions;
        st = cwi_each_layer(count_parts(s), 8 * PART, desc->threads, &desc->progress,
                            "smoothing", average_part, s, err);
        s->surfaces->mesh.positions = s->next;
        s->next = before;
    }
    return st;
}

/* Computes twice the area vector of a triangle. */
static void find_normal(const smoother *s, size_t t, const float *p[3], double normal[3])
{
    const cw_mesh *mesh = &s->surfaces->mesh;
    double u[3], v[3];
    for (int c = 0; c < 3; c++)
        p[c] = mesh->positions + 3 * (size_t)mesh->triangles[3 * t + (size_t)c];
    for (int a = 0; a < 3; a++) {
        u[a] = (double)p[1][a] - (double)p[0][a];
        v[a] = (double)p[2][a] - (double)p[0][a];
    }
    cwi_cross(u, v, normal);
    for (int a = 0; a < 3; a++)
        normal[a] *= s->side;
}

/* Measures a patch: the volume between it and the middle, and its area. */
static void measure_patch(void *context, size_t n)
{
    const smoother *s = context;
    const cw_label_patch *patch = &s->surfaces->patches[n];
    double volume = 0, area = 0;
    for (size_t t = patch->first; t < patch->first + patch->count; t++) {
        const float *p[3];
        double normal[3], from[3];
        find_normal(s, t, p, normal);
        for (int a = 0; a < 3; a++)
            from[a] = (double)p[0][a] - 0.5 * (double)s->dim[a];
        volume += cwi_dot(from, normal) / 6;
        area += sqrt(cwi_dot(normal, normal)) / 2;
    }
    s->volumes[n] = volume;
    s->areas[n] = area;
}

/* Multiplies by the matrix of areas: how volumes change with pressures. */
static void apply_areas(const smoother *s, const double *x, double *y)
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

/* Solves for the pressures that add the missing volumes, by conjugate gradients.
 * work  room for 4 x (labels + 1); the first are the pressures, the second what is missing */
static void solve_pressures(const smoother *s, double *work)
{
    const size_t count = s->labels + 1;
    double *x = work, *r = work + count, *p = r + count, *q = p + count;
    memset(x, 0, count * sizeof *x);
    memcpy(p, r, count * sizeof *p);
    double rest = dot_all(r, r, count);
    const double enough = 1e-12 * rest;
    for (int n = 0; n < SOLVER_ROUNDS && rest > enough; n++) {
        apply_areas(s, p, q);
        const double along = dot_all(p, q, count);
        if (!(along > 0))
            return;
        const double step = rest / along;
        for (size_t i = 0; i < count; i++) {
            x[i] += step * p[i];
            r[i] -= step * q[i];
        }
        const double now = dot_all(r, r, count);
        for (size_t i = 0; i < count; i++)
            p[i] = r[i] + now / rest * p[i];
        rest = now;
    }
}

/* Moves vertices along the normals of their patches by differences of pressures. moves: room for
 * 4 numbers a vertex */
static void move_by_pressures(const smoother *s, const double *pressures, float (*moves)[4])
{
    cw_mesh *mesh = &s->surfaces->mesh;
    memset(moves, 0, mesh->vertex_count * sizeof *moves);
    for (size_t n = 0; n < s->surfaces->patch_count; n++) {
        const cw_label_patch *patch = &s->surfaces->patches[n];
        const double difference = pressures[s->sides[n][0]] - pressures[s->sides[n][1]];
        for (size_t t = patch->first; t < patch->first + patch->count; t++) {
            const float *p[3];
            double normal[3];
            find_normal(s, t, p, normal);
            const float area = (float)sqrt(cwi_dot(normal, normal));
            for (int c = 0; c < 3; c++) {
                float *m = moves[mesh->triangles[3 * t + (size_t)c]];
                for (int a = 0; a < 3; a++)
                    m[a] += (float)(difference * normal[a]);
                m[3] += area;
            }
        }
    }
    for (size_t v = 0; v < mesh->vertex_count; v++) {
        float *p = mesh->positions + 3 * v;
        if (s->net->kinds[v] == CWI_NET_FIXED || !(moves[v][3] > 0))
            continue;
        for (int a = 0; a < 3; a++)
            p[a] += moves[v][a] / moves[v][3];
        keep_in_box(s, v, p);
    }
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

/* Gives labels the volumes of their voxels. work: room for 4 x (labels + 1) */
static cw_status keep_volumes(smoother *s, const cw_labels_desc *desc, double *work,
                              float (*moves)[4], cw_error *err)
{
    const cw_label_surfaces *f = s->surfaces;
    cw_status st = CW_OK;
    for (size_t n = 0; n < f->patch_count; n++)
        for (int side = 0; side < 2; side++)
            s->sides[n][side] = number_of(f, f->patches[n].labels[side]);
    for (int round = 0; round < VOLUME_ROUNDS && st == CW_OK; round++) {
        double *missing = work + s->labels + 1;
        st = cwi_each_layer(f->patch_count, 8 * f->mesh.triangle_count / (f->patch_count + 1),
                            desc->threads, &desc->progress, "keeping volumes", measure_patch, s,
                            err);
        for (size_t n = 0; n < s->labels; n++)
            missing[n] = (double)f->labels[n].voxels;
        for (size_t n = 0; n < f->patch_count; n++) {
            missing[s->sides[n][0]] -= s->volumes[n];
            missing[s->sides[n][1]] += s->volumes[n];
        }
        missing[s->labels] = 0;
        solve_pressures(s, work);
        move_by_pressures(s, work, moves);
    }
    return st;
}

cw_status cwi_labels_smooth(const cwi_label_net *net, const float *originals,
                            cw_label_surfaces *surfaces, const cw_labels_desc *desc,
                            const size_t dim[3], cw_error *err)
{
    const size_t vertices = surfaces->mesh.vertex_count, patches = surfaces->patch_count;
    const double bound = desc->max_move > 0 ? desc->max_move : 0.5;
    smoother s = {.net = net,
                  .surfaces = surfaces,
                  .originals = originals,
                  .bound = (float)(bound - margin),
                  .is_open = desc->leave_open,
                  .side = cwi_affine_determinant(surfaces->mesh.affine[0]) < 0 ? -1 : 1,
                  .dim = dim,
                  .labels = surfaces->label_count};
    s.next = cwi_alloc_large(vertices, 3 * sizeof *s.next);
    s.volumes = cwi_alloc_array(patches, sizeof *s.volumes);
    s.areas = cwi_alloc_array(patches, sizeof *s.areas);
    s.sides = cwi_alloc_array(patches, sizeof *s.sides);
    double *work = cwi_alloc_zeroed(4 * (s.labels + 1), sizeof *work);
    cw_status st = s.next && s.volumes && s.areas && s.sides && work
                       ? average_all(&s, desc, err)
                       : cwi_fail(err, CW_ERR_NO_MEMORY, "no memory to smooth labels");
    cwi_free(s.next);
    float(*moves)[4] = st == CW_OK ? cwi_alloc_large(vertices, sizeof *moves) : NULL;
    if (st == CW_OK && !moves)
        st = cwi_fail(err, CW_ERR_NO_MEMORY, "no memory to smooth labels");
    if (st == CW_OK && !desc->leave_open)
        st = keep_volumes(&s, desc, work, moves, err);
    cwi_free(moves);
    cwi_free(s.volumes);
    cwi_free(s.areas);
    cwi_free(s.sides);
    cwi_free(work);
    return st;
}
