/* Measures the area, volume, angles and sides of the triangles of a mesh, on threads, with
 * histograms. */
#include "simplify/quality/triangle_shapes.h"

#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/geometry/vec3.h"
#include "simplify/quality/surface_sampling.h"

#include <math.h>
#include <string.h>

enum { CHUNK = CWI_SHAPE_CHUNK };

const double cw_aspect_ends[CW_ASPECT_BINS - 1] = {1.25, 1.5, 2, 3, 5, 10, 30, 100};

/* A triangle by its sides; side[n] runs from corner n to the next. */
typedef struct sides {
    double from[3][3]; /* the corners */
    double side[3][3];
    double length[3];
    double twice_area;
    double normal[3]; /* as long as twice the area */
} sides;

typedef struct work {
    const cwi_welded *welded;
    uint8_t *defects;
    cwi_shape_sum *parts;
    double bins_per_octave, shortest; /* of the histogram of lengths */
} work;

/* Finds the sides and the normal from the corners. */
static void find_sides(sides *s)
{
    for (int n = 0; n < 3; n++)
        for (int a = 0; a < 3; a++)
            s->side[n][a] = s->from[(n + 1) % 3][a] - s->from[n][a];
    cwi_cross(s->side[0], s->side[1], s->normal);
}

static void load_sides(const cw_mesh *mesh, size_t triangle, sides *s)
{
    cwi_corners(mesh, triangle, s->from);
    find_sides(s);
}

void cwi_add_triangle(const cw_mesh *mesh, size_t triangle, uint32_t vertex, double *volume,
                      double *area)
{
    sides s;
    load_sides(mesh, triangle, &s);
    for (size_t a = 0; a < 3; a++)
        s.from[0][a] -= (double)mesh->positions[3 * (size_t)vertex + a];
    *volume += cwi_dot(s.normal, s.from[0]) / 6;
    *area += sqrt(cwi_dot(s.normal, s.normal)) / 2;
}

static size_t bin_of(double value, double step)
{
    const double bin = value / step;
    return bin < CW_ANGLE_BINS ? (size_t)bin : CW_ANGLE_BINS - 1;
}

static void count_angles(const sides *s, cwi_shape_sum *p, double *largest)
{
    const double degrees = 180 / acos(-1.0);
    double least = 180, most = 0;
    for (int n = 0; n < 3; n++) {
        const double cosine = -cwi_dot(s->side[n], s->side[(n + 2) % 3]);
        const double angle = degrees * atan2(s->twice_area, cosine);
        p->shapes.angles[bin_of(angle, 180.0 / CW_ANGLE_BINS)]++;
        least = cwi_lesser(least, angle);
        most = cwi_greater(most, angle);
    }
    p->shapes.smallest[bin_of(least, 60.0 / CW_ANGLE_BINS)]++;
    p->shapes.min_angle_deg = cwi_lesser(p->shapes.min_angle_deg, least);
    p->shapes.max_angle_deg = cwi_greater(p->shapes.max_angle_deg, most);
    *largest = most;
}

/* a b c (a + b + c) / (4 K)^2, where K is the area. */
static void count_aspect(const sides *s, cwi_shape_sum *p)
{
    const double *l = s->length, quarter = 2 * s->twice_area;
    const double aspect = (l[0] / quarter) * (l[1] / quarter) * l[2] * (l[0] + l[1] + l[2]);
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

static unsigned add_shape(sides *s, bool collapsed, cwi_shape_sum *p)
{
    double largest, low, high;
    s->twice_area = sqrt(cwi_dot(s->normal, s->normal));
    for (int n = 0; n < 3; n++)
        s->length[n] = sqrt(cwi_dot(s->side[n], s->side[n]));
    low = cwi_lesser(s->length[0], cwi_lesser(s->length[1], s->length[2]));
    high = cwi_greater(s->length[0], cwi_greater(s->length[1], s->length[2]));
    p->area += s->twice_area / 2;
    p->volume += cwi_dot(s->normal, s->from[0]) / 6;
    if (!(s->twice_area > 0) || collapsed) {
        p->degenerate++;
        return CW_DEFECT_DEGENERATE;
    }
    p->shapes.min_edge_mm = cwi_lesser(p->shapes.min_edge_mm, low);
    p->shapes.max_edge_mm = cwi_greater(p->shapes.max_edge_mm, high);
    count_angles(s, p, &largest);
    count_aspect(s, p);
    const bool cap = largest > CW_CAP_ANGLE_DEG, needle = high > CW_NEEDLE_RATIO * low;
    p->caps += cap;
    p->needles += needle && !cap;
    return cap || needle ? CW_DEFECT_SLIVER : 0;
}

void cwi_shape_sum_add(cwi_shape_sum *p, const double corners[3][3], bool collapsed)
{
    sides s;
    memcpy(s.from, corners, sizeof s.from);
    find_sides(&s);
    add_shape(&s, collapsed, p);
}

static void measure_triangle(const work *w, size_t t, cwi_shape_sum *p)
{
    sides s;
    load_sides(w->welded->mesh, t, &s);
    const unsigned defects = add_shape(&s, cwi_is_collapsed(w->welded, t), p);
    if (w->defects)
        w->defects[t] |= (uint8_t)defects;
}

static size_t end_of(const work *w, size_t k)
{
    const size_t count = w->welded->mesh->triangle_count, end = (k + 1) * CHUNK;
    return end < count ? end : count;
}

static void measure_chunk(void *context, size_t k)
{
    const work *w = context;
    cwi_shape_sum *p = &w->parts[k];
    cwi_shape_sum_init(p);
    for (size_t t = k * CHUNK; t < end_of(w, k); t++)
        measure_triangle(w, t, p);
}

static void count_lengths(void *context, size_t k)
{
    const work *w = context;
    for (size_t t = k * CHUNK; t < end_of(w, k); t++) {
        sides s;
        load_sides(w->welded->mesh, t, &s);
        if (!(cwi_dot(s.normal, s.normal) > 0) || cwi_is_collapsed(w->welded, t))
            continue;
        for (int n = 0; n < 3; n++) {
            const double length = sqrt(cwi_dot(s.side[n], s.side[n]));
            const double bin = w->bins_per_octave * log2(length / w->shortest);
            w->parts[k]
                .shapes.lengths[bin < CW_LENGTH_BINS ? (size_t)bin : CW_LENGTH_BINS - 1]++;
        }
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

/* False when the call was cancelled. */
static bool share_out(work *w, size_t chunks, const cw_quality_desc *desc,
                      void (*run)(void *, size_t))
{
    return cwi_each_layer(chunks, CHUNK * 64, desc->threads, &desc->progress, "checking", run,
                          w, NULL) == CW_OK;
}

bool cwi_measure_shapes(const cwi_welded *welded, const cw_quality_desc *desc, cw_quality *q)
{
    const size_t count = welded->mesh->triangle_count, chunks = (count + CHUNK - 1) / CHUNK;
    work w = {.welded = welded, .defects = desc->defects};
    w.parts = cwi_alloc_zeroed(chunks, sizeof *w.parts);
    if (!w.parts)
        return false;
    bool done = share_out(&w, chunks, desc, measure_chunk);
    cw_shapes *s = &q->shapes;
    s->min_angle_deg = 180;
    s->min_edge_mm = INFINITY;
    for (size_t k = 0; k < chunks; k++)
        cwi_shape_sum_join(&w.parts[k], q);
    w.shortest = s->min_edge_mm;
    w.bins_per_octave = s->max_edge_mm > s->min_edge_mm
                            ? CW_LENGTH_BINS / log2(s->max_edge_mm / s->min_edge_mm)
                            : 0;
    done = done && share_out(&w, chunks, desc, count_lengths);
    for (size_t k = 0; k < chunks; k++)
        add_bins(s->lengths, w.parts[k].shapes.lengths, CW_LENGTH_BINS);
    if (q->degenerate == count)
        s->min_angle_deg = s->min_edge_mm = 0;
    cwi_free(w.parts);
    return done;
}
