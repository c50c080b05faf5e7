/* Computes gradients at the samples of an irregular grid, by least squares over its cells'
 * edges. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/vec3.h"
#include "extract/irregular/cell_surface.h"

#include <math.h>

/* Sums over the edges at a sample. The slope s in direction u along each should be g . u,
 * weighed by the inverse square of its length, so that u u^T g = s u. */
typedef struct normal_equations {
    double a[6]; /* xx, xy, xz, yy, yz, zz */
    double b[3];
} normal_equations;

typedef struct fitting {
    const cwi_cells *g;
    double value_scale, length_scale; /* keep products within the range of doubles */
    const uint32_t *rows;
    normal_equations *equations;
} fitting;

static void add_edge(fitting *f, uint32_t sample, uint32_t other)
{
    const double from = cwi_stored_at(f->g, sample), to = cwi_stored_at(f->g, other);
    double p[3], q[3];
    if (f->rows[sample] == UINT32_MAX || sample == other || !isfinite(from) || !isfinite(to))
        return;
    normal_equations *n = &f->equations[f->rows[sample]];
    cwi_place_of(f->g, sample, p);
    cwi_place_of(f->g, other, q);
    for (int a = 0; a < 3; a++)
        q[a] = (q[a] - p[a]) * f->length_scale;
    const double length = sqrt(cwi_dot(q, q));
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

/* Adds a cell's edges, if all its corners have values and one of them is wanted. */
static void add_cell(fitting *f, uint8_t shape, const uint32_t *corners)
{
    const cwi_shape *s = &cwi_shapes[shape];
    bool wanted = false;
    uint8_t sides = 0;
    for (int c = 0; c < s->corner_count; c++) {
        wanted = wanted || f->rows[corners[c]] != UINT32_MAX;
        sides |= f->g->sides[corners[c]];
    }
    if (!wanted || sides & CWI_ABSENT)
        return;
    for (int e = 0; e < s->edge_count; e++) {
        const uint32_t a = corners[cwi_listed_corner(shape, s->edges[e][0])],
                       b = corners[cwi_listed_corner(shape, s->edges[e][1])];
        add_edge(f, a, b);
        add_edge(f, b, a);
    }
}

/* Numbers the corners of crossed elements. */
static size_t number_rows(const cwi_cells *g, uint32_t *rows)
{
    uint32_t count = 0;
    for (size_t s = 0; s < g->volume.dim[0]; s++)
        rows[s] = UINT32_MAX;
    for (size_t n = 0; n < g->count; n++) {
        const cwi_element *e = &g->elements[n];
        for (int c = 0; c < cwi_shape_of(e)->corner_count && e->crossed; c++)
            if (rows[e->corners[c]] == UINT32_MAX)
                rows[e->corners[c]] = count++;
    }
    return count;
}

static double power_of_two(double x)
{
    int exponent = 0;
    if (x > 0)
        frexp(x, &exponent);
    return ldexp(1, exponent < -1000 ? 1000 : -exponent);
}

static void fit_gradients(fitting *f)
{
    const cw_cells *cells = f->g->volume.cells;
    const uint32_t *corners = cells->corners;
    for (size_t n = 0; n < cells->count; n++) {
        add_cell(f, cells->shapes[n], corners);
        corners += cwi_shapes[cells->shapes[n]].corner_count;
    }
}

cw_status cwi_cells_gradients(const cwi_cells *g, cwi_gradients *out, cw_error *err)
{
    double far = 0;
    *out = (cwi_gradients){.rows = cwi_alloc_array(g->volume.dim[0], sizeof *out->rows)};
    const size_t count = out->rows ? number_rows(g, out->rows) : 0;
    fitting f = {.g = g, .rows = out->rows};
    out->at = cwi_alloc_array(count, sizeof *out->at);
    f.equations = cwi_alloc_zeroed(count, sizeof *f.equations);
    const bool enough = out->rows && out->at && f.equations;
    for (int i = 0; i < 9; i++)
        far = fmax(far, fabs(g->volume.affine[i / 3][i % 3]) * g->reach);
    f.value_scale = power_of_two(g->largest);
    f.length_scale = power_of_two(far);
    if (enough)
        fit_gradients(&f);
    for (size_t n = 0; n < count && enough; n++)
        solve_equations(&f.equations[n], out->at[n]);
    cwi_free(f.equations);
    return enough ? CW_OK
                  : cwi_fail(err, CW_ERR_NO_MEMORY, "no memory for %zu gradients", count);
}

void cwi_gradients_free(cwi_gradients *gradients)
{
    cwi_free(gradients->rows);
    cwi_free(gradients->at);
    *gradients = (cwi_gradients){0};
}
