/* Measures patches, and moves vertices along normals, which are found once. */
#include "extract/labels/label_moves.h"

#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/geometry/affine.h"
#include "core/geometry/triangle.h"
#include "core/geometry/vec3.h"

#include <math.h>
#include <string.h>

enum {
    PART = 1 << 14,
    CURVE_PART = 1 << 10,
    FEW = 8,      /* patches with at most this part of all triangles are listed */
    LISTED = 0x80 /* beside the bits of a vertex that is held */
};

/* Trims memory in sweeps over listed vertices, of patches that may be small and far from each other. */
static void trim_few(size_t n)
{
    if (n % 128 == 0)
        cwi_memory_trim();
}

/* Computes a triangle's normal on the outside, as long as twice its area. Returns a corner. */
static inline const float *find_normal(const cwi_label_moves *m, size_t t, double normal[3])
{
    const uint32_t *v = m->surfaces->mesh.triangles + 3 * t;
    const float *p = m->places + 3 * (size_t)v[0];
    cwi_facet_normal(p, m->places + 3 * (size_t)v[1], m->places + 3 * (size_t)v[2], normal);
    for (int a = 0; a < 3; a++)
        normal[a] *= m->side;
    return p;
}

/* Adds a triangle to the directions of its vertices that are in one patch. */
static void add_directions(const cwi_label_moves *m, size_t t, size_t patch,
                           const double normal[3], double area)
{
    for (size_t c = 0; c < 3; c++) {
        const uint32_t v = m->surfaces->mesh.triangles[3 * t + c];
        cwi_label_direction *to = &m->directions[v];
        if (m->net->kinds[v])
            continue;
        for (int a = 0; a < 3; a++)
            to->normal[a] += (float)normal[a];
        to->area += (float)area;
        to->patch = (uint32_t)patch;
    }
}

static void measure_patch(void *context, size_t n)
{
    const cwi_label_moves *m = context;
    const cw_label_patch *patch = &m->surfaces->patches[n];
    const double middle[3] = {0.5 * (double)m->dim[0], 0.5 * (double)m->dim[1],
                              0.5 * (double)m->dim[2]};
    double volume = 0, areas = 0;
    if (!m->patches[n].is_changed)
        return;
    for (size_t t = patch->first; t < patch->first + patch->count; t++) {
        double normal[3];
        const float *p = find_normal(m, t, normal);
        volume += ((double)p[0] - middle[0]) * normal[0] +
                  ((double)p[1] - middle[1]) * normal[1] +
                  ((double)p[2] - middle[2]) * normal[2];
        const double area = cwi_length(normal);
        areas += area;
        if (m->is_first)
            add_directions(m, t, n, normal, area);
        cwi_label_trim(t);
    }
    m->patches[n].volume = volume / 6;
    m->patches[n].area = areas / 2;
    m->patches[n].is_changed = false;
}

/* Returns true if a vertex closes a label at the volume's border: it stays in that plane. */
static bool is_in_cap(const cwi_label_moves *m, size_t v, int axis)
{
    const float original = m->originals[3 * v + (size_t)axis];
    return original < 0 || original > (float)m->dim[axis] - 1;
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
static size_t find_curve_shares(const cwi_label_moves *m, uint32_t vertex,
                                cwi_label_direction *shares)
{
    const cwi_label_net *net = m->net;
    const cw_label_surfaces *f = m->surfaces;
    size_t patch_end = 0, count = 0;
    if (vertex % 64 == 0) /* each looks at places far from each other */
        cwi_memory_trim();
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
            find_normal(m, t, normal);
            for (int a = 0; a < 3; a++)
                shares[count - 1].normal[a] += (float)normal[a];
            shares[0].area += (float)cwi_length(normal);
        }
    }
    return count;
}

static void count_curve_part(void *context, size_t n)
{
    const cwi_label_moves *m = context;
    for (size_t i = n * CURVE_PART; i < (n + 1) * CURVE_PART && i < m->curve_count; i++)
        m->curve_firsts[i + 1] = find_curve_shares(m, m->curve[i], NULL);
}

static void fill_curve_part(void *context, size_t n)
{
    const cwi_label_moves *m = context;
    for (size_t i = n * CURVE_PART; i < (n + 1) * CURVE_PART && i < m->curve_count; i++)
        find_curve_shares(m, m->curve[i], m->curve_shares + m->curve_firsts[i]);
}

static cw_status run_curves(cwi_label_moves *m, void (*work)(void *, size_t),
                            const cw_labels_desc *desc, cw_error *err)
{
    return cwi_parallel_for((m->curve_count + CURVE_PART - 1) / CURVE_PART, 32 * CURVE_PART,
                            desc->threads, &desc->progress, "keeping volumes", work, m, err);
}

/* Finds the shares of all vertices on curves. */
static cw_status measure_curves(cwi_label_moves *m, const cw_labels_desc *desc, cw_error *err)
{
    m->curve_firsts[0] = 0;
    cw_status st = run_curves(m, count_curve_part, desc, err);
    if (st != CW_OK)
        return st;
    for (size_t i = 0; i < m->curve_count; i++) {
        m->curve_firsts[i + 1] += m->curve_firsts[i];
        cwi_memory_trim_at(i);
    }
    m->curve_shares =
        cwi_alloc_zeroed(m->curve_firsts[m->curve_count], sizeof *m->curve_shares);
    return m->curve_shares ? run_curves(m, fill_curve_part, desc, err) : cwi_fail_memory(err);
}

/* Adds a vertex to its patch: by how much it moves the patch, whose volume grows with its square. A
 * vertex in a corner of three faces moves each by a third of its own way. Normals lose what would lead
 * out of the plane of a cap. */
static void add_effect(const cwi_label_moves *m, size_t v, cwi_label_direction *d, float area)
{
    double normal_sq = 0;
    for (int a = 0; a < 3; a++) {
        if (is_in_cap(m, v, a))
            d->normal[a] = 0;
        normal_sq += (double)d->normal[a] * (double)d->normal[a];
    }
    if (!(area > 0))
        return;
    m->patches[d->patch].effect += normal_sq / (double)area;
    m->patches[d->patch].extent += d == &m->directions[v] ? (double)area : sqrt(normal_sq);
}

static void measure_effects(const cwi_label_moves *m)
{
    for (size_t v = 0; v < m->surfaces->mesh.vertex_count; v++) {
        if (m->directions[v].area > 0)
            add_effect(m, v, &m->directions[v], m->directions[v].area);
        cwi_memory_trim_at(v);
    }
    for (size_t i = 0; i < m->curve_count; i++) {
        for (size_t k = m->curve_firsts[i]; k < m->curve_firsts[i + 1]; k++)
            add_effect(m, m->curve[i], &m->curve_shares[k],
                       m->curve_shares[m->curve_firsts[i]].area);
        cwi_memory_trim_at(i);
    }
}

cw_status cwi_label_moves_measure(cwi_label_moves *m, const cw_labels_desc *desc, cw_error *err)
{
    const size_t patches = m->surfaces->patch_count;
    const size_t triangles = m->surfaces->mesh.triangle_count / (patches + 1);
    cw_status st = cwi_parallel_for(patches, 8 * triangles, desc->threads, &desc->progress,
                                    "keeping volumes", measure_patch, m, err);
    if (st == CW_OK && m->is_first)
        st = measure_curves(m, desc, err);
    if (st == CW_OK && m->is_first)
        measure_effects(m);
    m->is_first = false;
    return st;
}

/* Moves a vertex in the box around its first place, and notes along which axes the box holds it. */
static void move_vertex(const cwi_label_moves *m, size_t v, const float move[3])
{
    float *p = m->places + 3 * v;
    const float *o = m->originals + 3 * v;
    uint8_t held = 0;
    bool is_moved = false;
    for (int a = 0; a < 3; a++) {
        const float from = p[a], low = o[a] - m->bound, high = o[a] + m->bound,
                    to = from + move[a];
        if (is_in_cap(m, v, a))
            continue;
        p[a] = to < low ? low : to > high ? high : to;
        held |= (uint8_t)((to < low || to > high) << a);
        is_moved = is_moved || p[a] != from;
    }
    m->held[v] = held;
    if (m->moved && is_moved)
        m->moved[v] = 1;
}

static bool is_back(const cwi_label_moves *m, size_t v)
{
    return m->net->kinds[v] & CWI_NET_BACK;
}

static void move_curve_part(void *context, size_t n)
{
    const cwi_label_moves *m = context;
    for (size_t i = n * CURVE_PART; i < (n + 1) * CURVE_PART && i < m->curve_count; i++) {
        const cwi_label_direction *shares = m->curve_shares + m->curve_firsts[i];
        const size_t count = m->curve_firsts[i + 1] - m->curve_firsts[i];
        float move[3] = {0};
        bool is_moved = false;
        for (size_t k = 0; k < count && shares[0].area > 0; k++) {
            const double difference = m->patches[shares[k].patch].difference;
            const float by = (float)difference / shares[0].area;
            is_moved = is_moved || difference != 0;
            for (int a = 0; a < 3; a++)
                move[a] += by * shares[k].normal[a];
        }
        if (!is_moved || is_back(m, m->curve[i]))
            continue;
        move_vertex(m, m->curve[i], move);
        for (size_t k = 0; k < count; k++)
            cwi_set_flag(&m->patches[shares[k].patch].is_changed);
    }
}

/* Moves a vertex that is in one patch. */
static void move_inner(const cwi_label_moves *m, size_t v)
{
    const cwi_label_direction *d = &m->directions[v];
    if (!(d->area > 0) || m->patches[d->patch].difference == 0 || is_back(m, v))
        return;
    const float by = (float)m->patches[d->patch].difference / d->area;
    move_vertex(m, v, (float[3]){by * d->normal[0], by * d->normal[1], by * d->normal[2]});
}

static void move_part(void *context, size_t n)
{
    const cwi_label_moves *m = context;
    const size_t count = m->few ? m->few_count : m->surfaces->mesh.vertex_count;
    for (size_t i = n * PART; i < (n + 1) * PART && i < count; i++) {
        move_inner(m, m->few ? m->few[i] : i);
        trim_few(i);
    }
}

static void add_held(const cwi_label_moves *m, size_t v, const cwi_label_direction *d,
                     float area)
{
    for (int a = 0; a < 3; a++)
        if (m->patches[d->patch].difference != 0 && (is_back(m, v) || m->held[v] >> a & 1))
            m->patches[d->patch].held +=
                (double)d->normal[a] * (double)d->normal[a] / (double)area;
}

/* Sums up the part of vertices that bounds hold, or that were put back, of patches that move. */
static void find_held(const cwi_label_moves *m)
{
    const size_t count = m->few ? m->few_count : m->surfaces->mesh.vertex_count;
    for (size_t n = 0; n < m->surfaces->patch_count; n++)
        if (m->patches[n].difference != 0)
            m->patches[n].held = 0;
    for (size_t i = 0; i < count; i++) {
        const size_t v = m->few ? m->few[i] : i;
        if ((m->held[v] || is_back(m, v)) && m->directions[v].area > 0)
            add_held(m, v, &m->directions[v], m->directions[v].area);
        trim_few(i);
    }
    for (size_t i = 0; i < m->curve_count; i++) {
        cwi_memory_trim_at(i);
        const cwi_label_direction *shares = m->curve_shares + m->curve_firsts[i];
        const size_t shared = m->curve_firsts[i + 1] - m->curve_firsts[i];
        if (!m->held[m->curve[i]] && !is_back(m, m->curve[i]))
            continue;
        for (size_t k = 0; k < shared && shares[0].area > 0; k++)
            add_held(m, m->curve[i], &shares[k], shares[0].area);
    }
}

/* Lists the vertices in one patch of the patches that move, if those are few. Returns false when memory
 * is out. */
static bool list_few(cwi_label_moves *m)
{
    const cw_label_surfaces *f = m->surfaces;
    size_t triangles = 0;
    for (size_t n = 0; n < f->patch_count; n++)
        triangles += m->patches[n].difference != 0 ? f->patches[n].count : 0;
    if (FEW * triangles > f->mesh.triangle_count)
        return true;
    m->few = cwi_alloc_array(3 * triangles, sizeof *m->few);
    m->few_count = 0;
    for (size_t n = 0; n < f->patch_count && m->few; n++) {
        const uint32_t *corner = f->mesh.triangles + 3 * f->patches[n].first;
        if (m->patches[n].difference == 0)
            continue;
        for (size_t i = 0; i < 3 * f->patches[n].count; i++) {
            uint8_t *held = &m->held[corner[i]];
            trim_few(i);
            if (m->directions[corner[i]].area > 0 && !(*held & LISTED)) {
                *held |= LISTED;
                m->few[m->few_count++] = corner[i];
            }
        }
    }
    for (size_t i = 0; i < m->few_count; i++) {
        m->held[m->few[i]] &= (uint8_t)~LISTED;
        trim_few(i);
    }
    return m->few;
}

cw_status cwi_label_moves_apply(cwi_label_moves *m, const cw_labels_desc *desc, cw_error *err)
{
    for (size_t n = 0; n < m->surfaces->patch_count; n++)
        m->patches[n].is_changed = m->patches[n].is_changed || m->patches[n].difference != 0;
    cw_status st =
        list_few(m) ? run_curves(m, move_curve_part, desc, err) : cwi_fail_memory(err);
    const size_t count = m->few ? m->few_count : m->surfaces->mesh.vertex_count;
    if (st == CW_OK)
        st = cwi_parallel_for((count + PART - 1) / PART, PART, desc->threads, &desc->progress,
                              "keeping volumes", move_part, m, err);
    if (st == CW_OK)
        find_held(m);
    cwi_free(m->few);
    m->few = NULL;
    return st;
}

void cwi_label_moves_mark(cwi_label_moves *m, size_t vertex)
{
    if (m->directions[vertex].area > 0)
        m->patches[m->directions[vertex].patch].is_changed = true;
    else
        for (uint32_t k = m->net->firsts[vertex]; k < m->net->firsts[vertex + 1]; k++)
            m->patches[find_patch(m->surfaces, m->net->around[k])].is_changed = true;
}

static bool is_on_curve(const cwi_label_moves *m, size_t v)
{
    return m->net->kinds[v] != 0 && !(m->net->kinds[v] & CWI_NET_FIXED);
}

bool cwi_label_moves_init(cwi_label_moves *m)
{
    const cw_label_surfaces *f = m->surfaces;
    const size_t vertices = f->mesh.vertex_count;
    m->side = cwi_affine_determinant(f->mesh.affine[0]) < 0 ? -1 : 1;
    m->is_first = true;
    for (size_t v = 0; v < vertices; v++) {
        m->curve_count += is_on_curve(m, v);
        cwi_memory_trim_at(v);
    }
    m->directions = cwi_alloc_large(vertices, sizeof *m->directions);
    m->patches = cwi_alloc_zeroed(f->patch_count, sizeof *m->patches);
    m->curve = cwi_alloc_array(m->curve_count, sizeof *m->curve);
    m->curve_firsts = cwi_alloc_array(m->curve_count + 1, sizeof *m->curve_firsts);
    m->held = cwi_alloc_zeroed(vertices, 1);
    if (!m->directions || !m->patches || !m->curve || !m->curve_firsts || !m->held)
        return false;
    cwi_set_large(m->directions, 0, vertices * sizeof *m->directions);
    m->curve_count = 0;
    for (size_t v = 0; v < vertices; v++) {
        if (is_on_curve(m, v))
            m->curve[m->curve_count++] = (uint32_t)v;
        cwi_memory_trim_at(v);
    }
    for (size_t n = 0; n < f->patch_count; n++)
        m->patches[n].is_changed = true;
    return true;
}

void cwi_label_moves_free(cwi_label_moves *m)
{
    cwi_free(m->patches);
    cwi_free(m->directions);
    cwi_free(m->curve);
    cwi_free(m->curve_firsts);
    cwi_free(m->curve_shares);
    cwi_free(m->held);
    m->patches = NULL;
    m->directions = m->curve_shares = NULL;
    m->curve = NULL;
    m->curve_firsts = NULL;
    m->held = NULL;
}
