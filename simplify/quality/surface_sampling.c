/* Points on a mesh, and sums over them.
 *
 * A triangle is divided into n^2 equal ones. In each, a rule of seven points (corners 1/20,
 * middles of sides 2/15, centroid 9/20) integrates cubics exactly [Zienkiewicz2013]; corners
 * and middles together are the lattice of order 2n. */
#include "simplify/quality/surface_sampling.h"

#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/base/thread_pool.h"
#include "core/geometry/vec3.h"

#include <math.h>
#include <string.h>

enum {
    CHUNK = 4096,        /* points that one thread measures in a row, or a large triangle's */
    BINS = 1 << 16,      /* of distances, by the leading 16 bits of a positive float */
    WORTH = 512 * CHUNK, /* a chunk's work, in samples of a volume compared */
    KEPT = 2048          /* sides of small triangles whose middles are remembered */
};

/* Distance measured in the middle of a side: the other triangle at the side mostly comes
 * soon. */
typedef struct side {
    uint32_t low, high; /* vertices; equal: none */
    bool missed;
    double distance;
} side;

/* Sums and maxima of a chunk of triangles, before they are joined with those of the others. */
typedef struct tally {
    size_t first; /* triangle; those of the next chunk follow */
    double sum, mean_sq, balance;
    double max, where[3];
    double here; /* the largest of the triangle at hand */
    size_t triangle, samples, missed;
} tally;

typedef struct work {
    const cwi_sampling *s;
    double scale; /* of the steps: 1, or less where there would be too many points */
    double area;
    size_t chunks;
    tally *tallies;      /* chunks + 1 */
    float *vertex;       /* vertex_count distances */
    uint8_t *missed;     /* vertex_count */
    float *here;         /* triangle_count: the largest distance of each; or NULL */
    uint64_t *histogram; /* threads x BINS: area, in 2^-60 of the whole */
} work;

/* Into how many parts the sides of a triangle are divided. */
static uint32_t parts_of(const work *w, const double p[3][3])
{
    double longest = 0;
    for (int c = 0; c < 3; c++) {
        double steps = 0;
        for (int r = 0; r < 3; r++) {
            double x = 0;
            for (int k = 0; k < 3; k++)
                x += w->s->step[r][k] * (p[(c + 1) % 3][k] - p[c][k]);
            steps += x * x;
        }
        longest = cwi_greater(longest, steps);
    }
    const double parts = ceil(w->scale * sqrt(longest) / 2);
    return parts < 1 ? 1 : parts < 2048 ? (uint32_t)parts : 2048;
}

/* Points inside and on the sides; the corners are measured by themselves. */
static size_t points_of(uint32_t parts)
{
    const size_t n = parts;
    return (2 * n + 1) * (n + 1) - 3 + n * n;
}

static size_t count_points(work *w)
{
    size_t count = 0;
    w->area = 0;
    for (size_t t = 0; t < w->s->mesh->triangle_count; t++) {
        double p[3][3];
        cwi_mesh_corners(w->s->mesh, t, p);
        w->area += cwi_triangle_area(p[0], p[1], p[2]);
        count += points_of(parts_of(w, (const double(*)[3])p));
    }
    return count;
}

/* Cuts the triangles into chunks of about equal work; counts them when there are no tallies. */
static size_t cut_chunks(work *w)
{
    size_t chunks = 0, points = CHUNK, t = 0;
    for (; t < w->s->mesh->triangle_count; t++) {
        if (points >= CHUNK) {
            if (w->tallies)
                w->tallies[chunks].first = t;
            chunks++;
            points = 0;
        }
        double p[3][3];
        cwi_mesh_corners(w->s->mesh, t, p);
        points += points_of(parts_of(w, (const double(*)[3])p));
    }
    if (w->tallies)
        w->tallies[chunks].first = t;
    return chunks;
}

static void measure_vertices(void *context, size_t chunk)
{
    const work *w = context;
    uint32_t hint = UINT32_MAX;
    for (size_t v = CHUNK * chunk; v < CHUNK * (chunk + 1) && v < w->s->mesh->vertex_count;
         v++) {
        const float *x = w->s->mesh->positions + 3 * v;
        const double p[3] = {(double)x[0], (double)x[1], (double)x[2]};
        bool missed = false;
        w->vertex[v] = (float)w->s->measure(w->s->context, p, &hint, &missed);
        w->missed[v] = missed;
        if (w->s->hints)
            w->s->hints[v] = hint;
    }
}

/* The leading bits of a float's place in the order of floats: bins a 256th of a binade wide. */
static size_t bin_of(double distance)
{
    const float f = (float)distance;
    uint32_t bits;
    memcpy(&bits, &f, sizeof bits);
    return bits >> 15;
}

static double value_of(size_t bin)
{
    const uint32_t bits = (uint32_t)bin << 15 | 1u << 14;
    float f;
    memcpy(&f, &bits, sizeof f);
    return (double)f;
}

/* Takes a distance that stands for a share of the mesh's area. */
static void take_distance(const work *w, tally *y, double distance, double weight,
                          const double p[3], size_t t)
{
    const double d = fabs(distance);
    y->sum += weight * d;
    y->mean_sq += weight * d * d;
    y->balance += weight * distance;
    y->here = cwi_greater(y->here, d);
    if (d > y->max) {
        y->max = d;
        y->triangle = t;
        memcpy(y->where, p, sizeof y->where);
    }
    w->histogram[(size_t)cwi_thread_number() * BINS + bin_of(d)] += (uint64_t)(weight * 0x1p60);
}

static void measure_point(const work *w, tally *y, const double p[3], double weight, size_t t,
                          uint32_t *hint)
{
    bool missed = false;
    const double d = w->s->measure(w->s->context, p, hint, &missed);
    take_distance(w, y, d, weight, p, t);
    y->samples++;
    y->missed += missed;
}

static void interpolate_point(const double p[3][3], double a, double b, double c, double x[3])
{
    for (int k = 0; k < 3; k++)
        x[k] = a * p[0][k] + b * p[1][k] + c * p[2][k];
}

/* How many small triangles meet in point i, j, k of the lattice of order i + j + k, and with
 * which weight: corners of small triangles have even numbers only. */
static double weight_of(uint32_t i, uint32_t j, uint32_t k)
{
    const int walls = (i == 0) + (j == 0) + (k == 0);
    if ((i | j | k) & 1)
        return walls ? 2 / 15.0 : 4 / 15.0;
    return walls == 2 ? 1 / 20.0 : walls ? 3 / 20.0 : 6 / 20.0;
}

/* The middle of an undivided triangle's side, measured once for both triangles. */
static void measure_side(const work *w, tally *y, const double p[3][3], size_t t, int c,
                         double weight, side *sides, uint32_t *hint)
{
    const uint32_t *v = w->s->mesh->triangles + 3 * t, a = v[c], b = v[(c + 1) % 3];
    const uint32_t low = a < b ? a : b, high = a < b ? b : a;
    side *s = sides + (low * 7 + high) % KEPT;
    double x[3];
    for (int k = 0; k < 3; k++)
        x[k] = (p[c][k] + p[(c + 1) % 3][k]) / 2;
    if (s->low != low || s->high != high || low == high) {
        *s = (side){.low = low, .high = high};
        s->distance = w->s->measure(w->s->context, x, hint, &s->missed);
        y->samples++;
        y->missed += s->missed;
    }
    take_distance(w, y, s->distance, weight * 2 / 15, x, t);
}

/* Most triangles of a mesh that was extracted: corners, middles of sides, centroid. */
static void measure_small(const work *w, tally *y, const double p[3][3], size_t t,
                          double weight, side *sides, uint32_t *hint)
{
    double x[3];
    for (int c = 0; c < 3; c++)
        measure_side(w, y, p, t, c, weight, sides, hint);
    interpolate_point(p, 1 / 3.0, 1 / 3.0, 1 / 3.0, x);
    measure_point(w, y, x, weight * 9 / 20, t, hint);
}

static void measure_divided(const work *w, tally *y, const double q[3][3], size_t t,
                            double weight, uint32_t n, uint32_t *hint)
{
    const uint32_t m = 2 * n;
    double x[3];
    for (uint32_t i = 0; i <= m; i++)
        for (uint32_t j = 0; i + j <= m; j++) {
            const uint32_t k = m - i - j;
            if (i == m || j == m || k == m)
                continue;
            interpolate_point(q, (double)i / m, (double)j / m, (double)k / m, x);
            measure_point(w, y, x, weight * weight_of(i, j, k), t, hint);
        }
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t j = 0; i + j < n; j++)
            for (int down = 0; down <= (i + j + 1 < n); down++) {
                const double a = (i + (1 + down) / 3.0) / n, b = (j + (1 + down) / 3.0) / n;
                interpolate_point(q, a, b, 1 - a - b, x);
                measure_point(w, y, x, weight * 9 / 20, t, hint);
            }
}

static void measure_triangle(const work *w, tally *y, size_t t, side *sides, uint32_t *hint)
{
    double p[3][3];
    cwi_mesh_corners(w->s->mesh, t, p);
    const double(*q)[3] = (const double(*)[3])p;
    const uint32_t n = parts_of(w, q);
    const double weight =
        w->area > 0 ? cwi_triangle_area(q[0], q[1], q[2]) / w->area / ((double)n * n) : 0;
    for (int c = 0; c < 3; c++)
        take_distance(w, y, (double)w->vertex[w->s->mesh->triangles[3 * t + (size_t)c]],
                      weight / 20, p[c], t);
    if (n == 1)
        measure_small(w, y, q, t, weight, sides, hint);
    else
        measure_divided(w, y, q, t, weight, n, hint);
}

static void measure_chunk(void *context, size_t chunk)
{
    const work *w = context;
    tally *y = w->tallies + chunk;
    uint32_t hint = UINT32_MAX;
    side sides[KEPT] = {{0}};
    y->max = -1;
    for (size_t t = y[0].first; t < y[1].first; t++) {
        y->here = 0;
        measure_triangle(w, y, t, sides, &hint);
        if (w->here)
            w->here[t] = (float)y->here;
    }
}

/* Every vertex counts the same. */
static void tally_vertices(const work *w)
{
    const cw_mesh *mesh = w->s->mesh;
    tally *y = w->tallies;
    y->max = -1;
    for (size_t v = 0; v < mesh->vertex_count; v++) {
        const float *x = mesh->positions + 3 * v;
        const double p[3] = {(double)x[0], (double)x[1], (double)x[2]};
        take_distance(w, y, (double)w->vertex[v], 1 / (double)mesh->vertex_count, p, 0);
    }
}

/* From triangles to their corners. */
static void spread_worst(const work *w)
{
    const cw_mesh *mesh = w->s->mesh;
    float *worst = w->s->worst;
    for (size_t v = 0; v < mesh->vertex_count; v++)
        worst[v] = fabsf(w->vertex[v]);
    for (size_t c = 0; c < 3 * mesh->triangle_count && w->here; c++) {
        float *at = &worst[mesh->triangles[c]];
        *at = *at > w->here[c / 3] ? *at : w->here[c / 3];
    }
}

/* The distance below which 99 % of the area lies. */
static double find_percentile(const work *w, int threads)
{
    uint64_t all = 0, below = 0;
    for (size_t b = 0; b < BINS; b++) {
        for (size_t k = 1; k < (size_t)threads; k++)
            w->histogram[b] += w->histogram[k * BINS + b];
        all += w->histogram[b];
    }
    for (size_t b = 0; b < BINS && all; b++) {
        below += w->histogram[b];
        if (below >= all - all / 100)
            return b ? value_of(b) : 0;
    }
    return 0;
}

static void join_tallies(const work *w, int threads, cw_distance *out)
{
    const cw_mesh *mesh = w->s->mesh;
    double sum = 0, mean_sq = 0, balance = 0;
    size_t samples = mesh->vertex_count, missed = 0;
    for (size_t v = 0; v < mesh->vertex_count; v++)
        missed += w->missed[v];
    double max_distance = -1;
    for (size_t c = 0; c < w->chunks; c++) {
        const tally *y = w->tallies + c;
        sum += y->sum;
        mean_sq += y->mean_sq;
        balance += y->balance;
        samples += y->samples;
        missed += y->missed;
        if (y->max > max_distance) {
            out->max_mm = max_distance = y->max;
            out->triangle = y->triangle;
            for (int k = 0; k < 3; k++)
                out->where[k] = mesh->origin[k] + y->where[k];
        }
    }
    out->mean_mm = sum;
    out->rms_mm = sqrt(mean_sq);
    out->bias_mm = w->s->is_signed ? balance : 0;
    out->p99_mm = cwi_lesser(find_percentile(w, threads), out->max_mm);
    out->triangles = mesh->triangle_count;
    out->samples = samples;
    out->missed = missed;
}

/* Into chunks of triangles, or one for the vertices. */
static void plan_chunks(work *w)
{
    w->scale = w->chunks = 1;
    if (w->s->vertices_only)
        return;
    while (count_points(w) > CWI_MAX_SAMPLES && w->scale > 1e-6)
        w->scale *= 0.75;
    w->chunks = cut_chunks(w);
}

static bool prepare_tallies(work *w, int threads, float *per_vertex)
{
    const size_t vertices = w->s->mesh->vertex_count;
    const bool triangles = w->s->worst && !w->s->vertices_only;
    plan_chunks(w);
    w->tallies = cwi_alloc_zeroed(w->chunks + 1, sizeof *w->tallies);
    w->missed = cwi_alloc_zeroed(vertices, sizeof *w->missed);
    w->histogram = cwi_alloc_zeroed((size_t)threads * BINS, sizeof *w->histogram);
    w->vertex = per_vertex ? per_vertex : cwi_alloc_array(vertices, sizeof *w->vertex);
    if (triangles)
        w->here = cwi_alloc_array(w->s->mesh->triangle_count, sizeof *w->here);
    if (!w->tallies || !w->missed || !w->histogram || !w->vertex || (triangles && !w->here))
        return false;
    if (!w->s->vertices_only)
        cut_chunks(w);
    return true;
}

cw_status cwi_sample_mesh(const cwi_sampling *sampling, cw_distance *out, float *per_vertex,
                          cw_error *err)
{
    work w = {.s = sampling};
    const int threads = cwi_threads(sampling->threads);
    const size_t vertices = sampling->mesh->vertex_count;
    cw_status st = CW_OK;
    if (!prepare_tallies(&w, threads, per_vertex))
        st = cwi_fail_memory(err);
    if (st == CW_OK)
        st = cwi_parallel_for((vertices + CHUNK - 1) / CHUNK, WORTH, sampling->threads,
                              sampling->progress, sampling->name, measure_vertices, &w, err);
    if (st == CW_OK && sampling->vertices_only)
        tally_vertices(&w);
    else if (st == CW_OK)
        st = cwi_parallel_for(w.chunks, WORTH, sampling->threads, sampling->progress,
                              sampling->name, measure_chunk, &w, err);
    if (st == CW_OK)
        join_tallies(&w, threads, out);
    if (st == CW_OK && sampling->worst)
        spread_worst(&w);
    if (!per_vertex)
        cwi_free(w.vertex);
    cwi_free(w.tallies);
    cwi_free(w.missed);
    cwi_free(w.here);
    cwi_free(w.histogram);
    return st;
}
