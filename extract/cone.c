/* Where a cluster goes, and whether it may: the cone over the rim of its star. */
#include "extract/ambiguous.h"
#include "extract/apart.h"
#include "extract/cluster.h"

#include <math.h>
#include <string.h>

/* A vertex stays as close to its sample as crossings are that it is made of, and keeps off the
 * middle between two samples: voxels. */
#define FARTHEST 0.49
#define ROUNDING 1e-4

/* A vertex that is merged is left at most so far from the surface: voxels, times the share. */
#define MOST_ERROR 0.25

/* ---- where a cluster goes --------------------------------------------------------------- */

/* The trilinear field and its gradient; NaN where it has none. */
static double field(const cwi_grid *g, const double x[3], double gradient[3])
{
    size_t at[3];
    double t[3], value = 0;
    for (int a = 0; a < 3; a++) {
        at[a] = (size_t)x[a];
        t[a] = x[a] - (double)at[a];
        gradient[a] = 0;
    }
    for (size_t c = 0; c < 8; c++) {
        const double f =
            cwi_value_at(g, at[0] + (c & 1), at[1] + (c >> 1 & 1), at[2] + (c >> 2));
        double weight[3];
        for (int a = 0; a < 3; a++)
            weight[a] = c >> a & 1 ? t[a] : 1 - t[a];
        value += f * weight[0] * weight[1] * weight[2];
        for (int a = 0; a < 3; a++)
            gradient[a] += (c >> a & 1 ? f : -f) * weight[(a + 1) % 3] * weight[(a + 2) % 3];
    }
    return value;
}

/* One step of Newton's along the gradient, the locked axes kept, towards a value. */
static bool approach(const cwi_grid *g, double target, const bool locked[3], double x[3])
{
    double gradient[3], largest = 0, square = 0;
    const double miss = field(g, x, gradient) - target;
    for (int a = 0; a < 3; a++) {
        gradient[a] = locked[a] ? 0 : gradient[a];
        largest = fmax(largest, fabs(gradient[a]));
    }
    for (int a = 0; a < 3; a++) {
        gradient[a] /= largest;
        square += gradient[a] * gradient[a];
    }
    for (int a = 0; a < 3; a++)
        x[a] -= miss / largest / square * gradient[a];
    return isfinite(x[0]) && isfinite(x[1]) && isfinite(x[2]);
}

/* The middle of some vertices, and the mean of the field there. */
static double find_middle(const cwi_snapping *s, const uint32_t *vertex, int count,
                          double middle[3])
{
    double value = 0, x[3], unused[3];
    middle[0] = middle[1] = middle[2] = 0;
    for (int n = 0; n < count; n++) {
        cwi_to_index(s, cwi_position(s, vertex[n]), x);
        value += field(s->grid, x, unused) / count;
        for (int a = 0; a < 3; a++)
            middle[a] += x[a] / count;
    }
    return value;
}

/* From the middle to where the field is what it was at the vertices (the isovalue, where these
 * were placed by the trilinear field); not far. */
static bool find_place(const cwi_snapping *s, double target, const double middle[3],
                       const bool locked[3], double place[3])
{
    memcpy(place, middle, 3 * sizeof *place);
    for (int step = 0; step < 3; step++) {
        if (!approach(s->grid, target, locked, place))
            return false;
        for (int a = 0; a < 3; a++)
            if (fabs(place[a] - middle[a]) > 0.5 * s->share)
                return false;
    }
    return true;
}

/* Where the volume ends the surface has a crease. Caps are flat: their vertices have no say
 * where there are others in the same plane, and they alone where there are none. */
static int find_voters(const cwi_snapping *s, const cwi_cluster *c, uint32_t *vertex,
                       bool locked[3])
{
    const size_t *dim = s->grid->volume.dim;
    double x[CWI_MEMBERS][3];
    int count = 0;
    locked[0] = locked[1] = locked[2] = false;
    for (int m = 0; m < c->count; m++) {
        cwi_to_index(s, cwi_position(s, c->member[m]), x[m]);
        for (int a = 0; a < 3; a++)
            locked[a] = locked[a] || x[m][a] < 1 || x[m][a] > (double)dim[a];
    }
    for (int pass = 0; pass < 2 && count == 0; pass++)
        for (int m = 0; m < c->count; m++) {
            bool chosen = true;
            for (int a = 0; a < 3; a++)
                chosen = chosen && (!locked[a] || fabs(x[m][a] - (double)c->at[a]) <
                                                      (pass ? 2.0 / 1024 : 0.5 / 1024));
            if (chosen)
                vertex[count++] = c->member[m];
        }
    return count;
}

/* ---- whether it may go there ------------------------------------------------------------ */

typedef struct shape {
    double normal[3]; /* times twice the area */
    double cosine;    /* of the smallest angle */
} shape;

static shape shape_of(const float *p, const float *q, const float *r)
{
    const float *corner[3] = {p, q, r};
    double side[3][3], length[3];
    shape out = {.cosine = -1};
    for (int n = 0; n < 3; n++) {
        double square = 0;
        for (int a = 0; a < 3; a++) {
            side[n][a] = (double)corner[(n + 1) % 3][a] - (double)corner[n][a];
            square += side[n][a] * side[n][a];
        }
        length[n] = sqrt(square);
    }
    for (int n = 0; n < 3; n++) {
        const double *u = side[n], *v = side[(n + 2) % 3];
        const double cosine =
            -(u[0] * v[0] + u[1] * v[1] + u[2] * v[2]) / (length[n] * length[(n + 2) % 3]);
        out.cosine = cosine <= out.cosine ? out.cosine : cosine; /* NaN is the worst */
        out.normal[n] = side[0][(n + 1) % 3] * side[1][(n + 2) % 3] -
                        side[0][(n + 2) % 3] * side[1][(n + 1) % 3];
    }
    return out;
}

static shape shape_at(const cwi_snapping *s, size_t triangle)
{
    const uint32_t *t = s->mesh->triangles + 3 * triangle;
    return shape_of(cwi_position(s, t[0]), cwi_position(s, t[1]), cwi_position(s, t[2]));
}

static uint32_t rim_vertex(const cwi_cluster *c, int n)
{
    return c->rim[n < c->rim_count ? n : 0];
}

/* In the world, where angles matter: none is turned over, none has a smaller angle than all had
 * before. */
static bool looks_good(const cwi_snapping *s, const cwi_cluster *c, const float p[3])
{
    double worst = -1;
    for (int n = 0; n < c->star_count; n++)
        worst = fmax(worst, shape_at(s, c->star[n]).cosine);
    for (int n = 0; n < c->rim_count; n++) {
        const shape was = shape_at(s, c->owner[n]);
        const shape is =
            shape_of(p, cwi_position(s, c->rim[n]), cwi_position(s, rim_vertex(c, n + 1)));
        const double turn = was.normal[0] * is.normal[0] + was.normal[1] * is.normal[1] +
                            was.normal[2] * is.normal[2];
        if (!(turn > 0) || !(is.cosine <= worst))
            return false;
    }
    return true;
}

static cwi_triangle new_triangle(const cwi_cluster *c, int n, const double x[3])
{
    cwi_triangle t;
    memcpy(t.p[0], x, sizeof t.p[0]);
    memcpy(t.p[1], c->rim_x[n], sizeof t.p[1]);
    memcpy(t.p[2], c->rim_x[n + 1 < c->rim_count ? n + 1 : 0], sizeof t.p[2]);
    return t;
}

static void swap(double a[3], double b[3])
{
    double c[3];
    memcpy(c, a, sizeof c);
    memcpy(a, b, sizeof c);
    memcpy(b, c, sizeof c);
}

/* New triangles among themselves: neighbours share a side, others the new vertex. */
static bool cone_is_apart(const cwi_cluster *c, const double x[3])
{
    for (int n = 1; n < c->rim_count; n++)
        for (int m = 0; m < n; m++) {
            const bool after = n == m + 1, before = m == 0 && n + 1 == c->rim_count;
            cwi_triangle s = new_triangle(c, m, x), t = new_triangle(c, n, x);
            if (after)
                swap(s.p[1], s.p[2]);
            else if (before)
                swap(t.p[1], t.p[2]);
            if (!cwi_triangles_apart(&s, &t, after || before ? 2 : 1))
                return false;
        }
    return true;
}

typedef struct box {
    double low[3], high[3];
} box;

static box box_of(const cwi_triangle *t)
{
    box b;
    for (int a = 0; a < 3; a++) {
        const double x = t->p[0][a], y = t->p[1][a], z = t->p[2][a];
        const double low = x < y ? x : y, high = x < y ? y : x;
        b.low[a] = low < z ? low : z;
        b.high[a] = high > z ? high : z;
    }
    return b;
}

static void grow(box *b, const box *by)
{
    for (int a = 0; a < 3; a++) {
        b->low[a] = by->low[a] < b->low[a] ? by->low[a] : b->low[a];
        b->high[a] = by->high[a] > b->high[a] ? by->high[a] : b->high[a];
    }
}

static bool boxes_apart(const box *s, const box *t)
{
    bool apart = false;
    for (int a = 0; a < 3; a++)
        apart =
            apart || s->low[a] > t->high[a] + CWI_APART || t->low[a] > s->high[a] + CWI_APART;
    return apart;
}

/* Turns a triangle until corner n comes first. */
static cwi_triangle turned(const cwi_triangle *t, int n)
{
    cwi_triangle out;
    for (int c = 0; c < 3; c++)
        memcpy(out.p[c], t->p[(n + c) % 3], sizeof out.p[c]);
    return out;
}

/* A triangle outside the star against the new one from the rim's vertex n to the next. on: of
 * its corners, which vertex of the rim each is, or -1. */
static bool is_clear(const cwi_cluster *c, int n, const cwi_triangle *new,
                     const cwi_triangle *old, const int on[3])
{
    const int next = n + 1 < c->rim_count ? n + 1 : 0;
    int first = -1, second = -1;
    for (int a = 0; a < 3; a++) {
        first = on[a] == n ? a : first;
        second = on[a] == next ? a : second;
    }
    if (first < 0 && second < 0)
        return cwi_triangles_apart(new, old, 0);
    cwi_triangle s = turned(new, first < 0 ? 2 : 1);
    cwi_triangle t = turned(old, first < 0 ? second : first);
    if (first < 0 || second < 0)
        return cwi_triangles_apart(&s, &t, 1);
    if (second != (first + 1) % 3)
        swap(t.p[1], t.p[2]);
    return cwi_triangles_apart(&s, &t, 2);
}

static bool is_in_star(const cwi_cluster *c, size_t triangle)
{
    for (int n = 0; n < c->star_count; n++)
        if (c->star[n] == triangle)
            return true;
    return false;
}

typedef struct cone {
    cwi_triangle triangle[CWI_STAR]; /* as many as the rim has vertices */
    box around[CWI_STAR], all;
} cone;

static void make_cone(const cwi_cluster *c, const double x[3], cone *new)
{
    new->all = (box){{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
    for (int n = 0; n < c->rim_count; n++) {
        new->triangle[n] = new_triangle(c, n, x);
        new->around[n] = box_of(&new->triangle[n]);
        grow(&new->all, &new->around[n]);
    }
}

/* A triangle near the star against all new ones. */
static bool is_clear_of_all(const cwi_snapping *s, const cwi_cluster *c, const cone *new,
                            size_t number)
{
    const uint32_t *triangle = s->mesh->triangles + 3 * number;
    cwi_triangle old;
    int on[3];
    for (int n = 0; n < 3; n++)
        cwi_to_index(s, cwi_position(s, triangle[n]), old.p[n]);
    const box b = box_of(&old);
    if (boxes_apart(&b, &new->all) || is_in_star(c, number))
        return true;
    for (int n = 0; n < 3; n++) {
        on[n] = c->rim_count - 1;
        while (on[n] >= 0 && c->rim[on[n]] != triangle[n])
            on[n]--;
    }
    for (int n = 0; n < c->rim_count; n++)
        if (!boxes_apart(&b, &new->around[n]) && !is_clear(c, n, &new->triangle[n], &old, on))
            return false;
    return true;
}

static double square(const double x[3])
{
    return x[0] * x[0] + x[1] * x[1] + x[2] * x[2];
}

/* No member is left far from the new triangles. */
static bool is_faithful(const cwi_snapping *s, const cwi_cluster *c, const double x[3])
{
    const double most = MOST_ERROR * s->share;
    for (int m = 0; m < c->count; m++) {
        double from[3], nearest[3];
        cwi_to_index(s, s->before + 3 * (size_t)c->member[m], from);
        for (int a = 0; a < 3; a++)
            nearest[a] = x[a] - from[a];
        for (int n = 0; n < c->rim_count && square(nearest) > most * most; n++) {
            cwi_triangle t = new_triangle(c, n, x);
            for (int a = 0; a < 9; a++)
                t.p[a / 3][a % 3] -= from[a % 3];
            cwi_nearest_of_triangle(&t, nearest);
        }
        if (square(nearest) > most * most)
            return false;
    }
    return true;
}

static bool meets_nothing(const cwi_snapping *s, const cwi_cluster *c, const double x[3])
{
    size_t near[CWI_NEAR];
    cone new;
    make_cone(c, x, &new);
    const int count = cwi_find_triangles(s, c->at, 2, near);
    for (int n = 0; n < count; n++)
        if (!is_clear_of_all(s, c, &new, near[n]))
            return false;
    return true;
}

static bool may_go(const cwi_snapping *s, const cwi_cluster *c, const double place[3],
                   float p[3])
{
    const double most = fmin(s->share + ROUNDING, FARTHEST);
    double x[3], from[3];
    cwi_to_position(s, place, p);
    cwi_to_index(s, p, x);
    for (int a = 0; a < 3; a++)
        from[a] = x[a] - (double)c->at[a];
    return square(from) < most * most && looks_good(s, c, p) && is_faithful(s, c, x) &&
           cone_is_apart(c, x) && meets_nothing(s, c, x);
}

bool cwi_cluster_place(const cwi_snapping *s, const cwi_cluster *c, float position[3])
{
    uint32_t vertex[CWI_MEMBERS];
    double middle[3], place[3];
    bool locked[3];
    const int count = find_voters(s, c, vertex, locked);
    if (count == 0)
        return false;
    const double target = find_middle(s, vertex, count, middle);
    if (!find_place(s, target, middle, locked, place))
        memcpy(place, middle, sizeof place);
    bool fits = may_go(s, c, place, position);
    for (int n = 0; n < count && !fits; n++) {
        cwi_to_index(s, cwi_position(s, vertex[n]), place);
        fits = may_go(s, c, place, position);
    }
    return fits;
}
