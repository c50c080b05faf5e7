/* Computes gradients at the samples of an irregular grid, by least squares over its cells'
 * edges. */
#include "core/volume/sample_gradients.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/vec3.h"
#include "core/volume/cell_shapes.h"
#include "core/volume/volume.h"

#include <math.h>

/* Sums over the edges at a sample. The slope s in direction u along each should be g . u,
 * weighed by the inverse square of its length, so that u u^T g = s u. */
typedef struct normal_equations {
    double a[6]; /* xx, xy, xz, yy, yz, zz */
    double b[3];
} normal_equations;

typedef struct fitting {
    const cwi_gradient_fit *fit;
    double value_scale, length_scale; /* keep products within the range of doubles */
    normal_equations *equations;
} fitting;

static size_t row_of(const fitting *f, uint32_t sample)
{
    return f->fit->rows ? f->fit->rows[sample] : sample;
}

static double stored_at(const fitting *f, uint32_t sample)
{
    const cw_volume *v = f->fit->volume;
    return cwi_voxel_at(v->type, cwi_voxel_address(v, sample, 0, 0));
}

/* Computes the place of a sample in the world, from the fit's origin. */
static void place_of(const fitting *f, uint32_t sample, double p[3])
{
    const double *x = f->fit->volume->cells->points + 3 * (size_t)sample, *o = f->fit->centre;
    for (int r = 0; r < 3; r++) {
        const double *a = f->fit->volume->affine[r];
        p[r] = a[0] * (x[0] - o[0]) + a[1] * (x[1] - o[1]) + a[2] * (x[2] - o[2]);
    }
}

static void add_edge(fitting *f, uint32_t sample, uint32_t other)
{
    const double from = stored_at(f, sample), to = stored_at(f, other);
    const size_t row = row_of(f, sample);
    double p[3], q[3];
    if (row == UINT32_MAX || sample == other || !isfinite(from) || !isfinite(to))
        return;
    normal_equations *n = &f->equations[row];
    place_of(f, sample, p);
    place_of(f, other, q);
    for (int a = 0; a < 3; a++)
        q[a] = (q[a] - p[a]) * f->length_scale;
    const double length = cwi_length(q);
    if (!(length > 0))
        return;
    for (int a = 0; a < 3; a++)
        q[a] /= length;
    const double slope = (to * f->value_scale - from * f->value_scale) / length;
    for (int a = 0, i = 0; a < 3; a++) {
        n->b[a] += slope * q[a];
        for (int b = a; b < 3; b++)
            n->a[i++] += q[a] * q[b];
    }
}

/* Solves by cofactors. The result is zero where the edges lie in a plane. */
static void solve_equations(const normal_equations *n, double g[3])
{
    const double *a = n->a;
    const double c[6] = {a[3] * a[5] - a[4] * a[4], a[2] * a[4] - a[1] * a[5],
                         a[1] * a[4] - a[2] * a[3], a[0] * a[5] - a[2] * a[2],
                         a[1] * a[2] - a[0] * a[4], a[0] * a[3] - a[1] * a[1]};
    const double determinant = a[0] * c[0] + a[1] * c[1] + a[2] * c[2];
    const double edges = a[0] + a[3] + a[5]; /* the number of edges */
    g[0] = (c[0] * n->b[0] + c[1] * n->b[1] + c[2] * n->b[2]) / determinant;
    g[1] = (c[1] * n->b[0] + c[3] * n->b[1] + c[4] * n->b[2]) / determinant;
    g[2] = (c[2] * n->b[0] + c[4] * n->b[1] + c[5] * n->b[2]) / determinant;
    if (!(determinant > 1e-12 * edges * edges * edges) || !isfinite(g[0] + g[1] + g[2]))
        g[0] = g[1] = g[2] = 0;
}

/* Adds a cell's edges, if all its corners have values and one of them is needed. */
static void add_cell(fitting *f, const cwi_cell_shape *s, const uint32_t *corners)
{
    const cw_volume *v = f->fit->volume;
    bool is_needed = false;
    for (int c = 0; c < s->corner_count; c++) {
        const double x = stored_at(f, corners[c]);
        is_needed = is_needed || row_of(f, corners[c]) != UINT32_MAX;
        if (isnan(x) || (v->has_nodata && x == v->nodata))
            return;
    }
    for (int e = 0; e < s->edge_count && is_needed; e++) {
        const uint32_t a = corners[s->edges[e][0]], b = corners[s->edges[e][1]];
        add_edge(f, a, b);
        add_edge(f, b, a);
    }
}

static double power_of_two(double x)
{
    int exponent = 0;
    if (x > 0)
        frexp(x, &exponent);
    return ldexp(1, exponent < -1000 ? 1000 : -exponent);
}

cw_status cwi_gradients_fit(const cwi_gradient_fit *fit, size_t row_count,
                            double (*gradients)[3], double *factor, cw_error *err)
{
    const cw_cells *cells = fit->volume->cells;
    const uint32_t *corners = cells->corners;
    double far = 0;
    fitting f = {.fit = fit, .equations = cwi_alloc_zeroed(row_count, sizeof *f.equations)};
    if (!f.equations)
        return cwi_fail_memory(err);
    for (int i = 0; i < 9; i++)
        far = fmax(far, fabs(fit->volume->affine[i / 3][i % 3]) * fit->reach);
    f.value_scale = power_of_two(fit->largest);
    f.length_scale = power_of_two(far);
    for (size_t n = 0; n < cells->count; n++) {
        const cwi_cell_shape *s = &cwi_cell_shapes[cells->shapes[n]];
        add_cell(&f, s, corners);
        corners += s->corner_count;
    }
    for (size_t n = 0; n < row_count; n++)
        solve_equations(&f.equations[n], gradients[n]);
    cwi_free(f.equations);
    *factor = f.value_scale / f.length_scale;
    return CW_OK;
}
