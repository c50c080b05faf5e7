/* Signs that say where points of an arrangement are. Filters in doubles come first; their bounds follow from
 * exact differences of vertices, and from the error of other points. */
#include "simplify/boolean/exact_points.h"

#include <math.h>

/* Coordinates of points that are no vertices, and differences of those, are this close. */
static const double POINT_ERROR = 0x1p-4;
static const double EPS = 0x1p-53;

static cwi_wide to_wide(double x)
{
    return (cwi_wide)(int64_t)x;
}

static void subtract_vertices(const cwi_soup *s, uint32_t a, uint32_t b, int64_t out[3])
{
    for (int k = 0; k < 3; k++)
        out[k] = (int64_t)s->vertices[a][k] - (int64_t)s->vertices[b][k];
}

void cwi_soup_normal(const cwi_soup *s, uint32_t t, cwi_wide normal[3])
{
    const uint32_t *v = s->triangles[t];
    int64_t a[3], b[3];
    subtract_vertices(s, v[1], v[0], a);
    subtract_vertices(s, v[2], v[0], b);
    for (int k = 0; k < 3; k++) {
        const int i = (k + 1) % 3, j = (k + 2) % 3;
        normal[k] = (cwi_wide)a[i] * b[j] - (cwi_wide)a[j] * b[i];
    }
}

int cwi_soup_axis(const cwi_soup *s, uint32_t t)
{
    cwi_wide n[3];
    int axis = 0;
    cwi_soup_normal(s, t, n);
    for (int k = 0; k < 3; k++)
        n[k] = n[k] < 0 ? -n[k] : n[k];
    for (int k = 1; k < 3; k++)
        if (n[k] > n[axis])
            axis = k;
    return axis;
}

/* Computes n . x of wide integers. */
static void dot_wide(const cwi_wide n[3], const cwi_wide x[3], cwi_big *out)
{
    cwi_big a, b, product;
    cwi_big_set(out, 0);
    for (int k = 0; k < 3; k++) {
        cwi_big_set(&a, n[k]);
        cwi_big_set(&b, x[k]);
        cwi_big_mul(&a, &b, &product);
        cwi_big_add(out, &product, out);
    }
}

int cwi_wide_dot_sign(const cwi_wide a[3], const cwi_wide b[3])
{
    cwi_big sum;
    dot_wide(a, b, &sum);
    return cwi_big_sign(&sum);
}

static void widen_vector(const int64_t from[3], cwi_wide to[3])
{
    for (int k = 0; k < 3; k++)
        to[k] = from[k];
}

int cwi_soup_side(const cwi_soup *s, uint32_t t, uint32_t v)
{
    const uint32_t *c = s->triangles[t];
    const double *o = s->vertices[c[0]];
    double a[3], b[3], d[3], sum = 0, size = 0;
    for (int k = 0; k < 3; k++) {
        a[k] = s->vertices[c[1]][k] - o[k];
        b[k] = s->vertices[c[2]][k] - o[k];
        d[k] = s->vertices[v][k] - o[k];
    }
    for (int k = 0; k < 3; k++) {
        const int i = (k + 1) % 3, j = (k + 2) % 3;
        const double p = a[i] * b[j], q = a[j] * b[i];
        sum += (p - q) * d[k];
        size += (fabs(p) + fabs(q)) * fabs(d[k]);
    }
    if (fabs(sum) > 8 * EPS * size)
        return sum > 0 ? 1 : -1;
    if (size == 0)
        return 0;
    cwi_wide n[3], x[3];
    int64_t difference[3];
    cwi_soup_normal(s, t, n);
    subtract_vertices(s, v, c[0], difference);
    widen_vector(difference, x);
    return cwi_wide_dot_sign(n, x);
}

/* --- coordinates -------------------------------------------------------------------------- */

/* The point at which a line through two vertices meets the plane n . (x - r) = 0. */
static void meet_line(const cwi_soup *s, uint32_t v0, uint32_t v1, const cwi_wide n[3],
                      uint32_t r, cwi_homogeneous *out)
{
    int64_t along[3], to_plane[3];
    cwi_wide d[3], e[3];
    cwi_big reach, factor, product;
    subtract_vertices(s, v1, v0, along);
    subtract_vertices(s, r, v0, to_plane);
    widen_vector(along, d);
    widen_vector(to_plane, e);
    dot_wide(n, d, &out->w);
    dot_wide(n, e, &reach);
    for (int k = 0; k < 3; k++) {
        cwi_big_set(&factor, to_wide(s->vertices[v0][k]));
        cwi_big_mul(&factor, &out->w, &out->x[k]);
        cwi_big_set(&factor, d[k]);
        cwi_big_mul(&factor, &reach, &product);
        cwi_big_add(&out->x[k], &product, &out->x[k]);
    }
}

/* The point at which three planes meet, by Cramer's rule. */
static void meet_planes(const cwi_soup *s, const uint32_t t[3], cwi_homogeneous *out)
{
    cwi_big n[3][3], c[3], product;
    for (int i = 0; i < 3; i++) {
        cwi_wide normal[3], corner[3];
        cwi_soup_normal(s, t[i], normal);
        for (int k = 0; k < 3; k++) {
            cwi_big_set(&n[i][k], normal[k]);
            corner[k] = to_wide(s->vertices[s->triangles[t[i]][0]][k]);
        }
        dot_wide(normal, corner, &c[i]);
    }
    cwi_big_set(&out->w, 0);
    for (int k = 0; k < 3; k++)
        cwi_big_set(&out->x[k], 0);
    for (int i = 0; i < 3; i++) { /* row i times the cross product of the rows behind it */
        const int j = (i + 1) % 3, l = (i + 2) % 3;
        for (int k = 0; k < 3; k++) {
            const int p = (k + 1) % 3, q = (k + 2) % 3;
            cwi_big minor;
            cwi_big_cross(&n[j][p], &n[l][q], &n[j][q], &n[l][p], &minor);
            cwi_big_mul(&c[i], &minor, &product);
            cwi_big_add(&out->x[k], &product, &out->x[k]);
            if (i == 0) {
                cwi_big_mul(&n[0][k], &minor, &product);
                cwi_big_add(&out->w, &product, &out->w);
            }
        }
    }
}

/* The normal of the plane through the line of two vertices that is parallel to an axis. */
static void upright_normal(const cwi_soup *s, uint32_t v0, uint32_t v1, int axis, cwi_wide n[3])
{
    int64_t d[3];
    subtract_vertices(s, v1, v0, d);
    n[axis] = 0;
    n[(axis + 1) % 3] = d[(axis + 2) % 3];
    n[(axis + 2) % 3] = -(cwi_wide)d[(axis + 1) % 3];
}

void cwi_point_exact(const cwi_soup *s, const cwi_exact_point *p, cwi_homogeneous *out)
{
    cwi_wide n[3];
    if (p->kind == CWI_VERTEX) {
        for (int k = 0; k < 3; k++)
            cwi_big_set(&out->x[k], to_wide(p->x[k]));
        cwi_big_set(&out->w, 1);
    } else if (p->kind == CWI_LINE_PLANE) {
        cwi_soup_normal(s, p->ref[2], n);
        meet_line(s, p->ref[0], p->ref[1], n, s->triangles[p->ref[2]][0], out);
    } else if (p->kind == CWI_PLANES)
        meet_planes(s, p->ref, out);
    else {
        upright_normal(s, p->ref[2], p->ref[3], (int)(p->kind - CWI_LINE_LINE), n);
        meet_line(s, p->ref[0], p->ref[1], n, p->ref[2], out);
    }
    if (out->w.negative) {
        cwi_big_negate(&out->w);
        for (int k = 0; k < 3; k++)
            cwi_big_negate(&out->x[k]);
    }
}

static cwi_exact_point finish_point(const cwi_soup *s, cwi_exact_point p)
{
    cwi_homogeneous h;
    cwi_point_exact(s, &p, &h);
    for (int k = 0; k < 3; k++)
        p.x[k] = cwi_big_ratio(&h.x[k], &h.w);
    return p;
}

cwi_exact_point cwi_point_vertex(const cwi_soup *s, uint32_t v)
{
    const double *x = s->vertices[v];
    return (cwi_exact_point){{x[0], x[1], x[2]}, CWI_VERTEX, {v}};
}

cwi_exact_point cwi_point_line_plane(const cwi_soup *s, uint32_t v0, uint32_t v1,
                                     uint32_t triangle)
{
    const uint32_t low = v0 < v1 ? v0 : v1;
    return finish_point(s,
                        (cwi_exact_point){{0}, CWI_LINE_PLANE, {low, v0 + v1 - low, triangle}});
}

cwi_exact_point cwi_point_line_line(const cwi_soup *s, const uint32_t v[4], int axis)
{
    return finish_point(
        s, (cwi_exact_point){{0}, CWI_LINE_LINE + (uint32_t)axis, {v[0], v[1], v[2], v[3]}});
}

cwi_exact_point cwi_point_planes(const cwi_soup *s, const uint32_t triangles[3])
{
    return finish_point(
        s, (cwi_exact_point){{0}, CWI_PLANES, {triangles[0], triangles[1], triangles[2]}});
}

/* --- comparisons -------------------------------------------------------------------------- */

static bool is_same_vertex(const cwi_exact_point *p, const cwi_exact_point *q)
{
    return p->kind == CWI_VERTEX && q->kind == CWI_VERTEX && p->ref[0] == q->ref[0];
}

static int sign_of(double x)
{
    return (x > 0) - (x < 0);
}

int cwi_point_compare(const cwi_soup *s, const cwi_exact_point *p, const cwi_exact_point *q,
                      int axis)
{
    const double d = p->x[axis] - q->x[axis];
    if ((p->kind == CWI_VERTEX && q->kind == CWI_VERTEX) || fabs(d) > 3 * POINT_ERROR)
        return sign_of(d);
    cwi_homogeneous a, b;
    cwi_big difference;
    cwi_point_exact(s, p, &a);
    cwi_point_exact(s, q, &b);
    cwi_big_cross(&a.x[axis], &b.w, &b.x[axis], &a.w, &difference);
    return cwi_big_sign(&difference);
}

int cwi_point_order(const cwi_soup *s, const cwi_exact_point *p, const cwi_exact_point *q)
{
    if (is_same_vertex(p, q))
        return 0;
    for (int k = 0; k < 3; k++) {
        const int order = cwi_point_compare(s, p, q, k);
        if (order)
            return order;
    }
    return 0;
}

static int exact_turn(const cwi_soup *s, const cwi_exact_point *p, const cwi_exact_point *q,
                      const cwi_exact_point *r, int u, int v)
{
    cwi_homogeneous a, b, c;
    cwi_big minor, product, sum;
    cwi_point_exact(s, p, &a);
    cwi_point_exact(s, q, &b);
    cwi_point_exact(s, r, &c);
    cwi_big_cross(&b.x[v], &c.w, &b.w, &c.x[v], &minor);
    cwi_big_mul(&a.x[u], &minor, &sum);
    cwi_big_cross(&b.w, &c.x[u], &b.x[u], &c.w, &minor);
    cwi_big_mul(&a.x[v], &minor, &product);
    cwi_big_add(&sum, &product, &sum);
    cwi_big_cross(&b.x[u], &c.x[v], &b.x[v], &c.x[u], &minor);
    cwi_big_mul(&a.w, &minor, &product);
    cwi_big_add(&sum, &product, &sum);
    return cwi_big_sign(&sum);
}

int cwi_point_turn(const cwi_soup *s, const cwi_exact_point *p, const cwi_exact_point *q,
                   const cwi_exact_point *r, int axis)
{
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    const bool are_vertices =
        p->kind == CWI_VERTEX && q->kind == CWI_VERTEX && r->kind == CWI_VERTEX;
    const double a = p->x[u] - r->x[u], b = p->x[v] - r->x[v];
    const double c = q->x[u] - r->x[u], d = q->x[v] - r->x[v];
    const double ad = a * d, bc = b * c, det = ad - bc;
    const double error = are_vertices ? 0 : 3 * POINT_ERROR; /* of a, b, c and d */
    const double bound = 4 * EPS * (fabs(ad) + fabs(bc)) +
                         error * (fabs(a) + fabs(b) + fabs(c) + fabs(d) + 2 * error);
    if (fabs(det) > bound)
        return sign_of(det);
    if (!are_vertices)
        return exact_turn(s, p, q, r, u, v);
    const cwi_wide exact = to_wide(a) * to_wide(d) - to_wide(b) * to_wide(c);
    return (exact > 0) - (exact < 0);
}

int cwi_soup_turn(const cwi_soup *s, uint32_t a, uint32_t b, uint32_t c, int axis)
{
    const cwi_exact_point p = cwi_point_vertex(s, a), q = cwi_point_vertex(s, b),
                          r = cwi_point_vertex(s, c);
    return cwi_point_turn(s, &p, &q, &r, axis);
}
