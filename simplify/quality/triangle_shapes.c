/* Measures the area, volume, angles and sides of the triangles of a mesh, on threads, with
 * histograms. */
#include "simplify/quality/triangle_shapes.h"

#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/geometry/vec3.h"
#include "simplify/quality/surface_sampling.h"

#include <float.h>
#include <math.h>
#include <string.h>

enum { CHUNK = CWI_SHAPE_CHUNK };

const double cw_aspect_ends[CW_ASPECT_BINS - 1] = {1.25, 1.5, 2, 3, 5, 10, 30, 100};

/* A triangle by its sides; side[n] runs from corner n to the next. */
typedef struct sides {
    double from[3][3]; /* the corners */
    double side[3][3];
    double normal[3]; /* as long as twice the area */
} sides;

/* Figures of the triangles of a block. */
typedef struct figures {
    double length[3][CWI_SHAPE_BLOCK];
    double cosine[3][CWI_SHAPE_BLOCK]; /* of the angle at each corner, times the two sides */
    double min_angle[CWI_SHAPE_BLOCK], max_angle[CWI_SHAPE_BLOCK]; /* angles, within NEAR_DEG */
    int bin[4][CWI_SHAPE_BLOCK]; /* of the angles, and of the least one */
    double
        off_centre[CWI_SHAPE_BLOCK]; /* the farthest of them from its bin's centre, in bins */
    double aspect[CWI_SHAPE_BLOCK], twice_area[CWI_SHAPE_BLOCK], volume[CWI_SHAPE_BLOCK];
} figures;

/* Bins of lengths by the leading bits of the square of a length: eight of its fraction. */
typedef struct length_bins {
    uint8_t *bin; /* or UNSURE, where bins meet */
    uint64_t first;
} length_bins;

enum { UNSURE = 255, DROPPED_BITS = 52 - 8 };

typedef struct work {
    const cwi_welded *welded;
    uint8_t *defects;
    cwi_shape_sum *parts;
    double bins_per_octave, shortest; /* of the histogram of lengths */
    length_bins lengths;
} work;

/* The angles of figures are off by at most 2.5e-5 degrees. Any nearer than this to the end of a
 * bin, or to an extreme, is computed by atan2(). */
static const double NEAR_DEG = 1e-4;

static void load_sides(const cw_mesh *mesh, size_t triangle, sides *s)
{
    cwi_mesh_corners(mesh, triangle, s->from);
    for (int n = 0; n < 3; n++)
        for (int a = 0; a < 3; a++)
            s->side[n][a] = s->from[(n + 1) % 3][a] - s->from[n][a];
    cwi_cross(s->side[0], s->side[1], s->normal);
}

void cwi_add_triangle(const cw_mesh *mesh, size_t triangle, uint32_t vertex, double *volume,
                      double *area)
{
    sides s;
    load_sides(mesh, triangle, &s);
    for (size_t a = 0; a < 3; a++)
        s.from[0][a] -= (double)mesh->positions[3 * (size_t)vertex + a];
    *volume += cwi_dot(s.normal, s.from[0]) / 6;
    *area += cwi_length(s.normal) / 2;
}

/* --- one block ---------------------------------------------------------------------------- */

/* Finds lengths, areas, volumes and cosines from the corners. */
static void find_sides(const cwi_shape_block *b, figures *f)
{
    for (size_t i = 0; i < b->count; i++) {
        const double x = b->corner[0][0][i], y = b->corner[0][1][i], z = b->corner[0][2][i];
        const double u[3] = {b->corner[1][0][i] - x, b->corner[1][1][i] - y,
                             b->corner[1][2][i] - z};
        const double v[3] = {b->corner[2][0][i] - b->corner[1][0][i],
                             b->corner[2][1][i] - b->corner[1][1][i],
                             b->corner[2][2][i] - b->corner[1][2][i]};
        const double w[3] = {x - b->corner[2][0][i], y - b->corner[2][1][i],
                             z - b->corner[2][2][i]};
        const double normal[3] = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2],
                                  u[0] * v[1] - u[1] * v[0]};
        f->length[0][i] = sqrt(u[0] * u[0] + u[1] * u[1] + u[2] * u[2]);
        f->length[1][i] = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
        f->length[2][i] = sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2]);
        f->cosine[0][i] = -(u[0] * w[0] + u[1] * w[1] + u[2] * w[2]);
        f->cosine[1][i] = -(v[0] * u[0] + v[1] * u[1] + v[2] * u[2]);
        f->cosine[2][i] = -(w[0] * v[0] + w[1] * v[1] + w[2] * v[2]);
        f->twice_area[i] =
            sqrt(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]);
        f->volume[i] = (normal[0] * x + normal[1] * y + normal[2] * z) / 6;
    }
}

/* The arc tangent between 0 and 1 as an odd polynomial: an interpolation at Chebyshev nodes, off
 * by at most 4.2e-7. */
static inline double short_atan(double r)
{
    const double s = r * r;
    return r * (0.9999992256 +
                s * (-0.3332567804 +
                     s * (0.1987204027 +
                          s * (-0.1344786406 +
                               s * (0.083126453 + s * (-0.0363604309 + s * 0.0076483539))))));
}

/* Selects without a branch, so that loops become vector instructions; off by rounding. */
static inline double near_lesser(double a, double b)
{
    return 0.5 * (a + b - fabs(a - b));
}

static inline double near_greater(double a, double b)
{
    return 0.5 * (a + b + fabs(a - b));
}

/* Nearly atan2(y, x) for y >= 0, in degrees; finite, too, where both are 0. */
static inline double near_angle(double y, double x)
{
    const double flat = fabs(x);
    const double turned =
        CWI_PI / 4 - short_atan(near_lesser(flat, y) / (near_greater(flat, y) + DBL_MIN));
    const double acute = CWI_PI / 4 + copysign(turned, y - flat);
    return 180 / CWI_PI * (CWI_PI / 2 - copysign(CWI_PI / 2 - acute, x));
}

/* Finds the bin of an angle; returns the distance from its centre, in bins. */
static inline double find_bin(double angle, double bins_per_degree, int *bin)
{
    const double at = bins_per_degree * angle;
    *bin = (int)at;
    return fabs(at - (double)*bin - 0.5);
}

/* Finds angles nearly, and aspects: a b c (a + b + c) / (4 K)^2, where K is the area. */
static void find_shapes(const cwi_shape_block *block, figures *f)
{
    const double per_degree = CW_ANGLE_BINS / 180.0, of_smallest = CW_ANGLE_BINS / 60.0;
    for (size_t i = 0; i < block->count; i++) {
        const double y = f->twice_area[i];
        const double a = near_angle(y, f->cosine[0][i]), b = near_angle(y, f->cosine[1][i]),
                     c = near_angle(y, f->cosine[2][i]);
        f->min_angle[i] = near_lesser(a, near_lesser(b, c));
        f->max_angle[i] = near_greater(a, near_greater(b, c));
        const double of_a = find_bin(a, per_degree, &f->bin[0][i]),
                     of_b = find_bin(b, per_degree, &f->bin[1][i]),
                     of_c = find_bin(c, per_degree, &f->bin[2][i]),
                     of_min = find_bin(f->min_angle[i], of_smallest, &f->bin[3][i]);
        f->off_centre[i] = near_greater(near_greater(of_a, of_b), near_greater(of_c, of_min));
    }
    for (size_t i = 0; i < block->count; i++) {
        const double l0 = f->length[0][i], l1 = f->length[1][i], l2 = f->length[2][i];
        const double quarter = 2 * f->twice_area[i];
        f->aspect[i] = (l0 / quarter) * (l1 / quarter) * l2 * (l0 + l1 + l2);
    }
}

static size_t bin_of(double value, double step)
{
    const double bin = value / step;
    return bin < CW_ANGLE_BINS ? (size_t)bin : CW_ANGLE_BINS - 1;
}

static void count_exact_angles(const figures *f, size_t i, cwi_shape_sum *p, double *largest)
{
    const double degrees = 180 / CWI_PI;
    double min_angle = 180, max_angle = 0;
    for (int n = 0; n < 3; n++) {
        const double angle = degrees * atan2(f->twice_area[i], f->cosine[n][i]);
        p->shapes.angles[bin_of(angle, 180.0 / CW_ANGLE_BINS)]++;
        min_angle = cwi_lesser(min_angle, angle);
        max_angle = cwi_greater(max_angle, angle);
    }
    p->shapes.smallest[bin_of(min_angle, 60.0 / CW_ANGLE_BINS)]++;
    p->shapes.min_angle_deg = cwi_lesser(p->shapes.min_angle_deg, min_angle);
    p->shapes.max_angle_deg = cwi_greater(p->shapes.max_angle_deg, max_angle);
    *largest = max_angle;
}

/* Counts the angles of a triangle. Almost all are far from the end of a bin: there the nearly
 * correct angles tell enough. largest: on the right side of CW_CAP_ANGLE_DEG, a bin's end */
static void count_angles(const figures *f, size_t i, cwi_shape_sum *p, double *largest)
{
    const double sure = 0.5 - NEAR_DEG * CW_ANGLE_BINS / 60.0;
    if (!(f->off_centre[i] < sure) || f->min_angle[i] - NEAR_DEG < p->shapes.min_angle_deg ||
        f->max_angle[i] + NEAR_DEG > p->shapes.max_angle_deg) {
        count_exact_angles(f, i, p, largest);
        return;
    }
    for (int n = 0; n < 3; n++)
        p->shapes.angles[f->bin[n][i]]++;
    p->shapes.smallest[f->bin[3][i]]++;
    *largest = f->max_angle[i];
}

static void count_aspect(double aspect, cwi_shape_sum *p)
{
    size_t bin = 0;
    while (bin < CW_ASPECT_BINS - 1 && aspect > cw_aspect_ends[bin])
        bin++;
    p->shapes.aspects[bin]++;
    p->shapes.max_aspect = cwi_greater(p->shapes.max_aspect, aspect);
}

void cwi_shape_sum_init(cwi_shape_sum *p)
{
    *p = (cwi_shape_sum){.shapes = {.min_angle_deg = 180, .min_edge_mm = INFINITY}};
}

/* Returns the defects of a triangle. */
static unsigned add_shape(const figures *f, size_t i, bool collapsed, cwi_shape_sum *p)
{
    const double l0 = f->length[0][i], l1 = f->length[1][i], l2 = f->length[2][i];
    const double low = cwi_lesser(l0, cwi_lesser(l1, l2));
    const double high = cwi_greater(l0, cwi_greater(l1, l2));
    double largest;
    p->area += f->twice_area[i] / 2;
    p->volume += f->volume[i];
    if (!(f->twice_area[i] > 0) || collapsed) {
        p->degenerate++;
        return CW_DEFECT_DEGENERATE;
    }
    p->shapes.min_edge_mm = cwi_lesser(p->shapes.min_edge_mm, low);
    p->shapes.max_edge_mm = cwi_greater(p->shapes.max_edge_mm, high);
    count_angles(f, i, p, &largest);
    count_aspect(f->aspect[i], p);
    const bool cap = largest > CW_CAP_ANGLE_DEG, needle = high > CW_NEEDLE_RATIO * low;
    p->caps += cap;
    p->needles += needle && !cap;
    return cap || needle ? CW_DEFECT_SLIVER : 0;
}

void cwi_shape_sum_add(cwi_shape_sum *p, cwi_shape_block *block)
{
    figures f;
    find_sides(block, &f);
    find_shapes(block, &f);
    for (size_t i = 0; i < block->count; i++)
        block->defects[i] = (uint8_t)add_shape(&f, i, block->collapsed[i], p);
    block->count = 0;
}

/* --- a mesh ------------------------------------------------------------------------------- */

static size_t end_of(const work *w, size_t k)
{
    const size_t count = w->welded->mesh->triangle_count, end = (k + 1) * CHUNK;
    return end < count ? end : count;
}

static void load_block(const cwi_welded *w, size_t first, size_t count, cwi_shape_block *b)
{
    b->count = count;
    for (size_t i = 0; i < count; i++) {
        const uint32_t *corner = w->mesh->triangles + 3 * (first + i);
        for (int n = 0; n < 3; n++) {
            const float *p = w->mesh->positions + 3 * (size_t)corner[n];
            b->corner[n][0][i] = (double)p[0];
            b->corner[n][1][i] = (double)p[1];
            b->corner[n][2][i] = (double)p[2];
        }
        b->collapsed[i] = cwi_is_collapsed(w, first + i);
    }
}

static void measure_chunk(void *context, size_t k)
{
    const work *w = context;
    cwi_shape_block block;
    cwi_shape_sum_init(&w->parts[k]);
    for (size_t t = k * CHUNK; t < end_of(w, k); t += CWI_SHAPE_BLOCK) {
        const size_t left = end_of(w, k) - t;
        const size_t count = left < CWI_SHAPE_BLOCK ? left : CWI_SHAPE_BLOCK;
        load_block(w->welded, t, count, &block);
        cwi_shape_sum_add(&w->parts[k], &block);
        for (size_t i = 0; i < count && w->defects; i++)
            w->defects[t + i] |= block.defects[i];
    }
}

/* --- lengths ------------------------------------------------------------------------------ */

static uint64_t key_of(double length_sq)
{
    uint64_t bits;
    memcpy(&bits, &length_sq, sizeof bits);
    return bits >> DROPPED_BITS;
}

/* Fills in which bin each key stands for. Keys at the end of a bin, as far as rounding may
 * reach, are UNSURE. */
static bool fill_length_bins(work *w, double longest)
{
    static const double BELOW = 1 - 1e-9, ABOVE = 1 + 1e-9;
    length_bins *l = &w->lengths;
    l->first = key_of(w->shortest * w->shortest * BELOW);
    const size_t keys = key_of(longest * longest * ABOVE) + 1 - l->first;
    l->bin = cwi_alloc_zeroed(keys, 1);
    for (int n = 1; n < CW_LENGTH_BINS && w->bins_per_octave > 0 && l->bin; n++) {
        const double end = w->shortest * exp2(n / w->bins_per_octave);
        const size_t low = key_of(end * end * BELOW) - l->first;
        const size_t high = key_of(end * end * ABOVE) - l->first;
        for (size_t key = low; key < keys; key++)
            l->bin[key] = key <= high || l->bin[key] == UNSURE ? UNSURE : (uint8_t)n;
    }
    return l->bin;
}

static size_t length_bin(const work *w, double length_sq)
{
    const uint8_t sure = w->lengths.bin[key_of(length_sq) - w->lengths.first];
    if (sure != UNSURE)
        return sure;
    const double bin = w->bins_per_octave * log2(sqrt(length_sq) / w->shortest);
    return bin < CW_LENGTH_BINS ? (size_t)bin : CW_LENGTH_BINS - 1;
}

static void count_lengths(void *context, size_t k)
{
    const work *w = context;
    size_t *bins = w->parts[k].shapes.lengths;
    for (size_t t = k * CHUNK; t < end_of(w, k); t++) {
        sides s;
        load_sides(w->welded->mesh, t, &s);
        if (!(cwi_dot(s.normal, s.normal) > 0) || cwi_is_collapsed(w->welded, t))
            continue;
        for (int n = 0; n < 3; n++)
            bins[length_bin(w, cwi_dot(s.side[n], s.side[n]))]++;
    }
}

static void add_bins(size_t *to, const size_t *from, size_t count)
{
    for (size_t n = 0; n < count; n++)
        to[n] += from[n];
}

void cwi_shape_sum_join(const cwi_shape_sum *p, cw_quality *q)
{
    cw_shapes *s = &q->shapes;
    q->area_mm2 += p->area;
    q->volume_mm3 += p->volume;
    q->degenerate += p->degenerate;
    q->needles += p->needles;
    q->caps += p->caps;
    s->min_angle_deg = cwi_lesser(s->min_angle_deg, p->shapes.min_angle_deg);
    s->max_angle_deg = cwi_greater(s->max_angle_deg, p->shapes.max_angle_deg);
    s->max_aspect = cwi_greater(s->max_aspect, p->shapes.max_aspect);
    s->min_edge_mm = cwi_lesser(s->min_edge_mm, p->shapes.min_edge_mm);
    s->max_edge_mm = cwi_greater(s->max_edge_mm, p->shapes.max_edge_mm);
    add_bins(s->angles, p->shapes.angles, CW_ANGLE_BINS);
    add_bins(s->smallest, p->shapes.smallest, CW_ANGLE_BINS);
    add_bins(s->aspects, p->shapes.aspects, CW_ASPECT_BINS);
}

/* Returns false when the call was cancelled. */
static bool split_bins(work *w, size_t chunks, const cw_quality_desc *desc,
                       void (*run)(void *, size_t))
{
    return cwi_parallel_for(chunks, CHUNK * 64, desc->threads, &desc->progress, "checking", run,
                            w, NULL) == CW_OK;
}

bool cwi_measure_shapes(const cwi_welded *welded, const cw_quality_desc *desc, cw_quality *q)
{
    const size_t count = welded->mesh->triangle_count, chunks = (count + CHUNK - 1) / CHUNK;
    work w = {.welded = welded, .defects = desc->defects};
    w.parts = cwi_alloc_zeroed(chunks, sizeof *w.parts);
    if (!w.parts)
        return false;
    bool done = split_bins(&w, chunks, desc, measure_chunk);
    cw_shapes *s = &q->shapes;
    s->min_angle_deg = 180;
    s->min_edge_mm = INFINITY;
    for (size_t k = 0; k < chunks; k++)
        cwi_shape_sum_join(&w.parts[k], q);
    w.shortest = s->min_edge_mm;
    w.bins_per_octave = s->max_edge_mm > s->min_edge_mm
                            ? CW_LENGTH_BINS / log2(s->max_edge_mm / s->min_edge_mm)
                            : 0;
    if (done && q->degenerate < count)
        done =
            fill_length_bins(&w, s->max_edge_mm) && split_bins(&w, chunks, desc, count_lengths);
    for (size_t k = 0; k < chunks; k++)
        add_bins(s->lengths, w.parts[k].shapes.lengths, CW_LENGTH_BINS);
    if (q->degenerate == count)
        s->min_angle_deg = s->min_edge_mm = 0;
    cwi_free(w.parts);
    cwi_free(w.lengths.bin);
    return done;
}
