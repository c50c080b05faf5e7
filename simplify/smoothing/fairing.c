/* Implicit fairing [Desbrun1999]: the surface diffuses by its cotangents for a given time, in steps of
 * backward Euler. Each step is a linear system, (M + t S) x = M x_before, with the areas M around
 * vertices and the stiffness S; conjugate gradients solve it. Rims that may move are solved first,
 * as curves, and are fixed for the surface. */
#include "simplify/smoothing/mesh_smooth.h"

#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/geometry/vec3.h"

#include <string.h>

/* The fraction of the first residual that ends conjugate gradients, and the most steps of them. */
static const double TOLERANCE = 1e-7;
enum { MAX_STEPS = 500 };

/* The least area that a triangle counts with, as a fraction of the sum of its squared sides: thin
 * ones would be too stiff for the rest. */
static const double MIN_AREA = 0.01;

/* A linear system over the free vertices, for three coordinates at once. */
typedef struct fair_system {
    const cwi_smoother *s;
    bool of_borders;  /* rims are free, in place of the rest */
    double time;      /* of a step, mm2 */
    double *weights;  /* of the edges to neighbours, as rings.neighbours lists them */
    double *mass;     /* of each vertex */
    double *diagonal; /* of each vertex; 0: it is fixed */
    double *residual, *direction, *product; /* vertices x 3 */
    double (*sums)[3];                      /* of each part */
    size_t parts;
} fair_system;

/* --- assembly ----------------------------------------------------------------------------- */

/* Adds to the weight of the edge from v to w, if the list of v has it: lists rise. */
static void add_weight(fair_system *f, uint32_t v, uint32_t w, double weight)
{
    const cwi_rings *r = &f->s->rings;
    const uint32_t *list = r->neighbours + r->begin[v];
    uint32_t low = 0, high = r->count[v];
    while (low < high) {
        const uint32_t middle = low + (high - low) / 2;
        if (list[middle] < w)
            low = middle + 1;
        else
            high = middle;
    }
    if (low < r->count[v] && list[low] == w)
        f->weights[r->begin[v] + low] += weight;
}

/* Adds a triangle: half the cotangent of each corner to the side opposite. */
static void add_triangle(fair_system *f, const uint32_t *corners)
{
    double side[3][3], area[3], sides_sq = 0;
    for (size_t c = 0; c < 3; c++) {
        const double *p = f->s->from + 3 * (size_t)corners[(c + 1) % 3],
                     *q = f->s->from + 3 * (size_t)corners[(c + 2) % 3];
        cwi_sub(q, p, side[c]);
        sides_sq += cwi_dot(side[c], side[c]);
    }
    cwi_cross(side[0], side[1], area);
    const double twice = cwi_length(area), counted = cwi_greater(twice, MIN_AREA * sides_sq);
    for (size_t c = 0; c < 3 && counted > 0; c++) {
        const uint32_t v = corners[(c + 1) % 3], w = corners[(c + 2) % 3];
        const double half_cotangent =
            -cwi_dot(side[(c + 1) % 3], side[(c + 2) % 3]) / (2 * counted);
        add_weight(f, v, w, half_cotangent);
        add_weight(f, w, v, half_cotangent);
        f->mass[corners[c]] += twice / 6;
    }
}

static void assemble_surface(fair_system *f)
{
    const cw_mesh *mesh = f->s->mesh;
    for (size_t t = 0; t < mesh->triangle_count; t++)
        add_triangle(f, mesh->triangles + 3 * t);
}

/* Rims as curves: an edge weighs one by its length, and each end has half of the length. */
static void assemble_borders(fair_system *f)
{
    const cwi_rings *r = &f->s->rings;
    for (size_t v = 0; v < r->vertices; v++)
        for (uint32_t i = 0; i < r->count[v] && r->border[v] != CWI_BORDER_NONE; i++) {
            const double *p = f->s->from + 3 * v,
                         *q = f->s->from + 3 * (size_t)r->neighbours[r->begin[v] + i];
            const double length = cwi_distance(p, q);
            f->weights[r->begin[v] + i] = length > 0 ? 1 / length : 0;
            f->mass[v] += length / 2;
        }
}

static bool is_free(const fair_system *f, size_t v)
{
    return !cwi_smooth_is_fixed(f->s, v) &&
           f->of_borders == (f->s->rings.border[v] != CWI_BORDER_NONE);
}

static void finish_diagonal(fair_system *f)
{
    const cwi_rings *r = &f->s->rings;
    for (size_t v = 0; v < r->vertices; v++) {
        double sum = 0;
        for (uint32_t i = 0; i < r->count[v]; i++)
            sum += f->weights[r->begin[v] + i];
        f->diagonal[v] = is_free(f, v) ? f->mass[v] + f->time * sum : 0;
        if (!(f->diagonal[v] > 0) || !isfinite(f->diagonal[v]))
            f->diagonal[v] = 0;
    }
}

static void assemble_system(fair_system *f)
{
    const cwi_rings *r = &f->s->rings;
    memset(f->weights, 0, r->begin[r->vertices] * sizeof *f->weights);
    memset(f->mass, 0, r->vertices * sizeof *f->mass);
    if (f->of_borders)
        assemble_borders(f);
    else
        assemble_surface(f);
    finish_diagonal(f);
}

/* --- conjugate gradients ------------------------------------------------------------------ */

/* Multiplies a free row with vectors: of fixed vertices, too. */
static void multiply_row(const fair_system *f, size_t v, const double *vectors, double out[3])
{
    const cwi_rings *r = &f->s->rings;
    const uint32_t *list = r->neighbours + r->begin[v];
    const double *weights = f->weights + r->begin[v];
    double sum[3] = {0};
    for (uint32_t i = 0; i < r->count[v]; i++)
        for (size_t a = 0; a < 3; a++)
            sum[a] += weights[i] * vectors[3 * (size_t)list[i] + a];
    for (size_t a = 0; a < 3; a++)
        out[a] = f->diagonal[v] * vectors[3 * v + a] - f->time * sum[a];
}

/* Returns the end of a part of the vertices. */
static size_t end_part(const fair_system *f, size_t k)
{
    const size_t end = (k + 1) * CWI_RING_PART, all = f->s->rings.vertices;
    return end < all ? end : all;
}

/* The residual of the places so far, which start where they are; its preconditioned direction. */
static void start_part(void *context, size_t k)
{
    fair_system *f = context;
    double *sum = f->sums[k];
    memset(sum, 0, sizeof f->sums[k]);
    for (size_t v = k * CWI_RING_PART; v < end_part(f, k); v++) {
        double *residual = f->residual + 3 * v, *direction = f->direction + 3 * v, row[3];
        memset(residual, 0, 3 * sizeof *residual);
        memset(direction, 0, 3 * sizeof *direction);
        if (f->diagonal[v] == 0)
            continue;
        multiply_row(f, v, f->s->from, row);
        for (size_t a = 0; a < 3; a++) {
            residual[a] = f->mass[v] * f->s->from[3 * v + a] - row[a];
            direction[a] = residual[a] / f->diagonal[v];
            sum[a] += residual[a] * direction[a];
        }
    }
}

static void multiply_part(void *context, size_t k)
{
    fair_system *f = context;
    double *sum = f->sums[k];
    memset(sum, 0, sizeof f->sums[k]);
    for (size_t v = k * CWI_RING_PART; v < end_part(f, k); v++) {
        double *product = f->product + 3 * v;
        if (f->diagonal[v] == 0)
            continue;
        multiply_row(f, v, f->direction, product);
        for (size_t a = 0; a < 3; a++)
            sum[a] += product[a] * f->direction[3 * v + a];
    }
}

/* Sums of the parts in their order, so that threads do not matter. */
static void add_parts(const fair_system *f, double sums[3])
{
    memset(sums, 0, 3 * sizeof *sums);
    for (size_t k = 0; k < f->parts; k++)
        for (int a = 0; a < 3; a++)
            sums[a] += f->sums[k][a];
}

typedef struct step_lengths {
    fair_system *f;
    double by[3]; /* how far along the direction; then how much of it is kept */
} step_lengths;

/* Moves along the directions, and measures what is left. */
static void advance_part(void *context, size_t k)
{
    const step_lengths *step = context;
    fair_system *f = step->f;
    double *sum = f->sums[k];
    memset(sum, 0, sizeof f->sums[k]);
    for (size_t v = k * CWI_RING_PART; v < end_part(f, k); v++)
        for (size_t a = 0; a < 3 && f->diagonal[v] != 0; a++) {
            const size_t n = 3 * v + a;
            f->s->from[n] += step->by[a] * f->direction[n];
            f->residual[n] -= step->by[a] * f->product[n];
            sum[a] += f->residual[n] * f->residual[n] / f->diagonal[v];
        }
}

static void turn_part(void *context, size_t k)
{
    const step_lengths *step = context;
    const fair_system *f = step->f;
    for (size_t v = k * CWI_RING_PART; v < end_part(f, k); v++)
        for (size_t a = 0; a < 3 && f->diagonal[v] != 0; a++) {
            const size_t n = 3 * v + a;
            f->direction[n] = f->residual[n] / f->diagonal[v] + step->by[a] * f->direction[n];
        }
}

static cw_status each_part(const fair_system *f, void (*work)(void *, size_t), void *context,
                           const cw_progress *progress, cw_error *err)
{
    return cwi_parallel_for(f->parts, 16 * CWI_RING_PART, f->s->desc.threads, progress,
                            "smoothing", work, context, err);
}

/* Returns how far the worst coordinate has come to the tolerance: 1 when all are there. */
static double find_done(const double first[3], const double now[3])
{
    double done = 1;
    for (int a = 0; a < 3; a++)
        if (now[a] > TOLERANCE * TOLERANCE * first[a])
            done = cwi_lesser(done, log(now[a] / first[a]) / (2 * log(TOLERANCE)));
    return cwi_greater(0, done);
}

/* One step of conjugate gradients.
 * now  the square of the residual along each axis, before and after */
static cw_status step_on(fair_system *f, double now[3], const cw_progress *progress,
                         cw_error *err)
{
    step_lengths step = {.f = f};
    double energy[3], next[3];
    cw_status st = each_part(f, multiply_part, f, progress, err);
    if (st != CW_OK)
        return st;
    add_parts(f, energy);
    for (int a = 0; a < 3; a++)
        step.by[a] = energy[a] > 0 ? now[a] / energy[a] : 0;
    st = each_part(f, advance_part, &step, progress, err);
    if (st != CW_OK)
        return st;
    add_parts(f, next);
    for (int a = 0; a < 3; a++)
        step.by[a] = now[a] > 0 ? next[a] / now[a] : 0;
    memcpy(now, next, sizeof next);
    return each_part(f, turn_part, &step, progress, err);
}

static cw_status solve_system(fair_system *f, const cw_progress *progress, cw_error *err)
{
    const cw_progress none = {0};
    double first[3], now[3], done = 0;
    cw_status st = each_part(f, start_part, f, &none, err);
    add_parts(f, first);
    memcpy(now, first, sizeof now);
    for (int n = 0; n < MAX_STEPS && st == CW_OK && (done = find_done(first, now)) < 1; n++) {
        const cwi_part_progress here = {.whole = progress, .from = done};
        const cw_progress here_progress = cwi_progress_part(&here);
        st = step_on(f, now, &here_progress, err);
    }
    return st;
}

/* --- steps -------------------------------------------------------------------------------- */

static cw_status alloc_system(fair_system *f, cw_error *err)
{
    const cwi_rings *r = &f->s->rings;
    const size_t count = r->vertices;
    f->parts = (count + CWI_RING_PART - 1) / CWI_RING_PART;
    f->weights = cwi_alloc_large(r->begin[count], sizeof *f->weights);
    f->mass = cwi_alloc_large(count, sizeof *f->mass);
    f->diagonal = cwi_alloc_large(count, sizeof *f->diagonal);
    f->residual = cwi_alloc_large(3 * count, sizeof *f->residual);
    f->direction = cwi_alloc_large(3 * count, sizeof *f->direction);
    f->sums = cwi_alloc_zeroed(f->parts, sizeof *f->sums);
    f->product = f->s->to;
    if (f->weights && f->mass && f->diagonal && f->residual && f->direction && f->sums)
        return CW_OK;
    return cwi_fail_memory(err);
}

/* A wave of wavelength L fades by 1 / (1 + t (2 pi / L)^2) in each of the steps. Returns the time t
 * by which one of width_mm keeps half. */
static double find_time(const cw_smooth_desc *desc)
{
    const double wave = desc->width_mm / (2 * CWI_PI);
    return (pow(2, 1 / (double)desc->iterations) - 1) * wave * wave;
}

cw_status cwi_smooth_fair(cwi_smoother *s, const cw_progress *progress, cw_error *err)
{
    fair_system f = {.s = s, .time = find_time(&s->desc)};
    cw_status st = alloc_system(&f, err);
    for (size_t n = 0; n < 2 * s->desc.iterations && st == CW_OK; n++) {
        const cwi_part_progress part = {.whole = progress,
                                        .from = (double)n / (double)(2 * s->desc.iterations),
                                        .fraction = 1 / (double)(2 * s->desc.iterations)};
        const cw_progress part_progress = cwi_progress_part(&part);
        f.of_borders = n % 2 == 0;
        if (f.of_borders && !s->desc.move_border)
            continue;
        assemble_system(&f);
        st = solve_system(&f, &part_progress, err);
    }
    cwi_free(f.weights);
    cwi_free(f.mass);
    cwi_free(f.diagonal);
    cwi_free(f.residual);
    cwi_free(f.direction);
    cwi_free(f.sums);
    return st;
}
