/* Lessens how charts are stretched: the symmetric Dirichlet energy [Smith2015] goes down along its gradient,
 * preconditioned by the Laplacian of the surface as in [Kovalsky2016]. */
#include "simplify/atlas/chart_plane.h"

#include "core/base/memory.h"
#include "core/geometry/vec3.h"

#include <string.h>

/* Steps, and rounds of conjugate gradients in each. */
enum { MAX_STEPS = 40, MAX_ROUNDS = 60, MAX_HALVINGS = 12 };

/* Steps end where the mean energy has less than this above that of no stretch, 4, or falls by less than
 * the second share of what is above. */
static const double ENOUGH = 0.01, LEAST_GAIN = 0.01;

/* The share of the way to the first triangle turned over that a step takes. */
static const double MAX_WAY = 0.8;

/* The rest of the linear equations that is small enough. */
static const double REST_SQ = 1e-4;

typedef struct relaxing {
    cwi_chart *chart;
    double (*weight)[3]; /* triangles: of the edge across from each corner */
    double *diagonal;    /* vertices */
    double (*gradient)[2], (*step)[2], (*rest)[2], (*search)[2], (*image)[2], (*next)[2];
} relaxing;

/* --- energy ------------------------------------------------------------------------------- */

/* Returns the mean energy; INFINITY where a triangle is turned over. */
static double measure_energy(const relaxing *r, const double (*uv)[2])
{
    const cwi_chart *chart = r->chart;
    double sum = 0;
    for (size_t t = 0; t < chart->triangles; t++) {
        double j[4];
        if (!(chart->area[t] > 0))
            continue;
        cwi_chart_jacobian(chart, uv, t, j);
        const double det = cwi_chart_det(j);
        if (!(det > 0))
            return INFINITY;
        sum += chart->area[t] * cwi_chart_norm_sq(j) * (1 + 1 / (det * det));
    }
    return sum / chart->surface;
}

static void compute_gradient(const relaxing *r)
{
    const cwi_chart *chart = r->chart;
    memset(r->gradient, 0, chart->vertices * sizeof *r->gradient);
    for (size_t t = 0; t < chart->triangles; t++) {
        double j[4], slope[4];
        if (!(chart->area[t] > 0))
            continue;
        cwi_chart_jacobian(chart, (const double(*)[2])chart->uv, t, j);
        const double det = cwi_chart_det(j), square = cwi_chart_norm_sq(j),
                     along = 2 * (1 + 1 / (det * det)),
                     across = -2 * square / (det * det * det);
        slope[0] = along * j[0] + across * j[3];
        slope[1] = along * j[1] - across * j[2];
        slope[2] = along * j[2] - across * j[1];
        slope[3] = along * j[3] + across * j[0];
        const double *rest = chart->rest[t], scale = chart->area[t] / chart->surface;
        const uint32_t *c = chart->corners + 3 * t;
        for (int k = 0; k < 2; k++) {
            const double first = scale * (slope[2 * k] * rest[0] + slope[2 * k + 1] * rest[1]),
                         second = scale * (slope[2 * k] * rest[2] + slope[2 * k + 1] * rest[3]);
            r->gradient[c[1]][k] += first;
            r->gradient[c[2]][k] += second;
            r->gradient[c[0]][k] -= first + second;
        }
    }
}

/* --- linear equations --------------------------------------------------------------------- */

/* Sets weights by cotangents, none below a small one: then equations have one solution. */
static void set_weights(const relaxing *r)
{
    const cwi_chart *chart = r->chart;
    memset(r->diagonal, 0, chart->vertices * sizeof *r->diagonal);
    for (size_t t = 0; t < chart->triangles; t++) {
        const double *m = chart->rest[t];
        double cotangent[3] = {0.1, 0.1, 0.1};
        if (chart->area[t] > 0) {
            /* Corners (0, 0), (x1, 0), (x2, y2) from the inverse of the sides. */
            const double x1 = 1 / m[0], y2 = 1 / m[3], x2 = -m[1] * x1 * y2;
            cotangent[0] = x2 / y2;
            cotangent[1] = (x1 - x2) / y2;
            cotangent[2] = (y2 * y2 - x2 * (x1 - x2)) / (x1 * y2);
        }
        for (int k = 0; k < 3; k++)
            r->weight[t][k] = fmin(fmax(cotangent[k], 0.02), 50) / chart->surface;
        for (int k = 0; k < 3; k++)
            r->diagonal[chart->corners[3 * t + (size_t)k]] +=
                r->weight[t][(k + 1) % 3] + r->weight[t][(k + 2) % 3];
    }
}

static void apply_laplacian(const relaxing *r, const double (*x)[2], double (*out)[2])
{
    const cwi_chart *chart = r->chart;
    memset(out, 0, chart->vertices * sizeof *out);
    for (size_t t = 0; t < chart->triangles; t++)
        for (size_t k = 0; k < 3; k++) {
            const uint32_t a = chart->corners[3 * t + (k + 1) % 3],
                           b = chart->corners[3 * t + (k + 2) % 3];
            for (int i = 0; i < 2; i++) {
                const double flow = r->weight[t][k] * (x[a][i] - x[b][i]);
                out[a][i] += flow;
                out[b][i] -= flow;
            }
        }
}

static double dot(size_t count, const double (*x)[2], const double (*y)[2])
{
    double sum = 0;
    for (size_t v = 0; v < count; v++)
        sum += x[v][0] * y[v][0] + x[v][1] * y[v][1];
    return sum;
}

/* Solves for the step that the gradient asks for, by conjugate gradients with the diagonal. */
static void solve_step(const relaxing *r)
{
    const size_t count = r->chart->vertices;
    double product = 0;
    for (size_t v = 0; v < count; v++)
        for (int k = 0; k < 2; k++) {
            r->step[v][k] = 0;
            r->rest[v][k] = -r->gradient[v][k];
            r->search[v][k] = r->diagonal[v] > 0 ? r->rest[v][k] / r->diagonal[v] : 0;
            product += r->rest[v][k] * r->search[v][k];
        }
    const double first = product;
    for (int round = 0; round < MAX_ROUNDS && product > REST_SQ * first; round++) {
        apply_laplacian(r, (const double(*)[2])r->search, r->image);
        const double curve =
            dot(count, (const double(*)[2])r->search, (const double(*)[2])r->image);
        if (!(curve > 0))
            return;
        const double way = product / curve;
        double next = 0;
        for (size_t v = 0; v < count; v++)
            for (int k = 0; k < 2; k++) {
                r->step[v][k] += way * r->search[v][k];
                r->rest[v][k] -= way * r->image[v][k];
                next += r->diagonal[v] > 0 ? r->rest[v][k] * r->rest[v][k] / r->diagonal[v] : 0;
            }
        for (size_t v = 0; v < count; v++)
            for (int k = 0; k < 2; k++)
                r->search[v][k] = (r->diagonal[v] > 0 ? r->rest[v][k] / r->diagonal[v] : 0) +
                                  next / product * r->search[v][k];
        product = next;
    }
}

/* --- steps -------------------------------------------------------------------------------- */

/* Returns the way along the step to where the first triangle has no area: the smallest positive
 * root of a quadratic polynomial. */
static double find_way(const relaxing *r)
{
    const cwi_chart *chart = r->chart;
    double least = INFINITY;
    for (size_t t = 0; t < chart->triangles; t++) {
        double j[4], d[4];
        if (!(chart->area[t] > 0))
            continue;
        cwi_chart_jacobian(chart, (const double(*)[2])chart->uv, t, j);
        cwi_chart_jacobian(chart, (const double(*)[2])r->step, t, d);
        const double a = cwi_chart_det(d), c = cwi_chart_det(j),
                     b = j[0] * d[3] + d[0] * j[3] - j[1] * d[2] - d[1] * j[2],
                     under = b * b - 4 * a * c;
        if (under < 0)
            continue;
        const double q = -0.5 * (b + copysign(sqrt(under), b));
        const double roots[2] = {a != 0 ? q / a : INFINITY, q != 0 ? c / q : INFINITY};
        for (int k = 0; k < 2; k++)
            if (roots[k] > 0)
                least = fmin(least, roots[k]);
    }
    return least;
}

/* Takes the longest of ever shorter steps that lessens the energy enough; returns what it is then. */
static double take_step(const relaxing *r, double energy)
{
    cwi_chart *chart = r->chart;
    const double slope =
        dot(chart->vertices, (const double(*)[2])r->gradient, (const double(*)[2])r->step);
    double way = fmin(4, MAX_WAY * find_way(r)), best = energy;
    for (int n = 0; n < MAX_HALVINGS; n++, way *= 0.5) {
        for (size_t v = 0; v < chart->vertices; v++)
            for (int k = 0; k < 2; k++)
                r->next[v][k] = chart->uv[v][k] + way * r->step[v][k];
        best = measure_energy(r, (const double(*)[2])r->next);
        if (best < energy + 0.1 * way * slope) {
            memcpy(chart->uv, r->next, chart->vertices * sizeof *chart->uv);
            return best;
        }
    }
    return energy;
}

static bool alloc(relaxing *r)
{
    const size_t count = r->chart->vertices;
    double(**arrays[6])[2] = {&r->gradient, &r->step,  &r->rest,
                              &r->search,   &r->image, &r->next};
    bool ok = true;
    for (int k = 0; k < 6; k++) {
        *arrays[k] = cwi_alloc_array(count, sizeof **arrays[k]);
        ok = ok && *arrays[k];
    }
    r->weight = cwi_alloc_array(r->chart->triangles, sizeof *r->weight);
    r->diagonal = cwi_alloc_array(count, sizeof *r->diagonal);
    return ok && r->weight && r->diagonal;
}

bool cwi_chart_relax(cwi_chart *chart)
{
    relaxing r = {.chart = chart};
    const bool ok = alloc(&r);
    if (ok && chart->surface > 0) {
        double energy = measure_energy(&r, (const double(*)[2])chart->uv);
        if (energy > 4 + ENOUGH)
            set_weights(&r);
        for (int n = 0; n < MAX_STEPS && energy > 4 + ENOUGH; n++) {
            const double before = energy;
            compute_gradient(&r);
            solve_step(&r);
            energy = take_step(&r, energy);
            if (!(before - energy > LEAST_GAIN * (before - 4)))
                break;
        }
        cwi_chart_measure(chart);
    }
    cwi_free(r.weight);
    cwi_free(r.diagonal);
    cwi_free(r.gradient);
    cwi_free(r.step);
    cwi_free(r.rest);
    cwi_free(r.search);
    cwi_free(r.image);
    cwi_free(r.next);
    return ok;
}
