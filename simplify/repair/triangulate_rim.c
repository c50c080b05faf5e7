/* Triangulates the rim of a hole: by dynamic programming [Barequet1995] with the weights of
 * [Liepa2003], after ears were cut off a long rim. */
#include "core/base/memory.h"
#include "core/geometry/triangle.h"
#include "core/geometry/vec3.h"
#include "core/mesh/corner_table.h"
#include "simplify/repair/hole_patch.h"

#include <math.h>
#include <string.h>

/* Vertices of a rim that is triangulated at best; it takes a sixth of the cube of this number of
 * steps. */
enum { MAX_EXACT = 160 };

/* Angles that differ by less are equal: then the area counts. In 1 - cos. */
static const double EQUAL_ANGLE = 1e-9;

void cwi_patch_free(cwi_hole_patch *p)
{
    cwi_free(p->points);
    cwi_free(p->sizes);
    cwi_free(p->triangles);
    cwi_free(p->neighbours);
    *p = (cwi_hole_patch){0};
}

bool cwi_patch_add_triangle(cwi_hole_patch *p, uint32_t a, uint32_t b, uint32_t c)
{
    if (p->triangle_count == p->triangle_capacity) {
        const size_t capacity = 2 * p->triangle_capacity + 64;
        void *triangles = cwi_realloc_array(p->triangles, capacity, sizeof *p->triangles);
        p->triangles = triangles ? triangles : p->triangles;
        void *neighbours = cwi_realloc_array(p->neighbours, capacity, sizeof *p->neighbours);
        p->neighbours = neighbours ? neighbours : p->neighbours;
        if (!triangles || !neighbours)
            return false;
        p->triangle_capacity = capacity;
    }
    const uint32_t corners[3] = {a, b, c};
    memset(p->neighbours[p->triangle_count], 0xff, sizeof *p->neighbours);
    memcpy(p->triangles[p->triangle_count++], corners, sizeof corners);
    return true;
}

bool cwi_patch_add_point(cwi_hole_patch *p, const double point[3])
{
    if (p->count == p->capacity) {
        const size_t capacity = 2 * p->capacity + 64;
        void *points = cwi_realloc_array(p->points, capacity, sizeof *p->points);
        p->points = points ? points : p->points;
        void *sizes = cwi_realloc_array(p->sizes, capacity, sizeof *p->sizes);
        p->sizes = sizes ? sizes : p->sizes;
        if (!points || !sizes)
            return false;
        p->capacity = capacity;
    }
    p->sizes[p->count] = 0;
    memcpy(p->points[p->count++], point, sizeof *p->points);
    return true;
}

/* A polygon inside the rim that is left to triangulate: `size` vertices of the rim. */
typedef struct polygon_cells {
    const cwi_hole_patch *patch;
    const uint32_t *vertex;     /* numbers in the rim, rising */
    const double (*outside)[3]; /* normal beyond the edge to the next vertex; 0: none */
    const bool *is_taken; /* size x size: an edge of the mesh; NULL: nothing is looked at */
    size_t size;
    double *angle, *area; /* size x size: of the best triangulation of the part from i to j */
    double (*normal)[3];  /* of its triangle at the edge from i to j */
    uint32_t *middle;     /* third vertex of that triangle */
} polygon_cells;

static double measure_triangle(const double a[3], const double b[3], const double c[3],
                               double normal[3])
{
    cwi_triangle_normal(a, b, c, normal);
    const double area = cwi_length(normal) / 2;
    if (!cwi_normalise(normal))
        memset(normal, 0, 3 * sizeof *normal);
    return area;
}

/* Returns 1 - cos of the angle between two normals; 2 if one is unknown, for then it is a triangle
 * without area. */
static double measure_angle(const double a[3], const double b[3])
{
    return cwi_dot(b, b) > 0.5 && cwi_dot(a, a) > 0.5 ? 1 - cwi_dot(a, b) : 2;
}

static const double *normal_beyond(const polygon_cells *p, size_t i, size_t j)
{
    return j == i + 1 ? p->outside[i] : p->normal[i * p->size + j];
}

static bool is_better(double angle, double area, double best_angle, double best_area)
{
    if (fabs(angle - best_angle) > EQUAL_ANGLE)
        return angle < best_angle;
    return area < best_area;
}

static bool is_edge_free(const polygon_cells *p, size_t i, size_t j)
{
    const bool is_side = j == i + 1 || (i == 0 && j + 1 == p->size);
    return is_side || !p->is_taken || !p->is_taken[i * p->size + j];
}

/* Finds the best triangle at the edge from i to j. */
static void solve_cell(polygon_cells *p, size_t i, size_t j)
{
    const size_t n = p->size, cell = i * n + j;
    p->angle[cell] = p->area[cell] = INFINITY;
    if (!is_edge_free(p, i, j))
        return;
    for (size_t m = i + 1; m < j; m++) {
        const size_t low = i * n + m, high = m * n + j;
        if (!isfinite(p->angle[low]) || !isfinite(p->angle[high]))
            continue;
        double normal[3], angle = fmax(p->angle[low], p->angle[high]);
        if (angle > p->angle[cell] + EQUAL_ANGLE)
            continue;
        const double area =
            p->area[low] + p->area[high] +
            measure_triangle(p->patch->points[p->vertex[i]], p->patch->points[p->vertex[m]],
                             p->patch->points[p->vertex[j]], normal);
        angle = fmax(angle, measure_angle(normal, normal_beyond(p, i, m)));
        angle = fmax(angle, measure_angle(normal, normal_beyond(p, m, j)));
        if (i == 0 && j + 1 == n)
            angle = fmax(angle, measure_angle(normal, p->outside[n - 1]));
        if (is_better(angle, area, p->angle[cell], p->area[cell])) {
            p->angle[cell] = angle;
            p->area[cell] = area;
            p->middle[cell] = (uint32_t)m;
            memcpy(p->normal[cell], normal, sizeof normal);
        }
    }
}

/* Adds the triangles of the best triangulation. */
static bool emit_triangles(const polygon_cells *p, cwi_hole_patch *patch, uint32_t *stack)
{
    size_t depth = 0;
    stack[depth++] = 0;
    stack[depth++] = (uint32_t)p->size - 1;
    while (depth) {
        const uint32_t j = stack[--depth], i = stack[--depth];
        if (j == i + 1)
            continue;
        const uint32_t m = p->middle[i * p->size + j];
        if (!cwi_patch_add_triangle(patch, p->vertex[i], p->vertex[m], p->vertex[j]))
            return false;
        stack[depth++] = i;
        stack[depth++] = m;
        stack[depth++] = m;
        stack[depth++] = j;
    }
    return true;
}

/* Adds a fan from a new point in the middle of the polygon. */
static bool emit_fan(const polygon_cells *p, cwi_hole_patch *patch)
{
    double middle[3] = {0};
    for (size_t n = 0; n < p->size; n++)
        for (int a = 0; a < 3; a++)
            middle[a] += patch->points[p->vertex[n]][a] / (double)p->size;
    const uint32_t tip = (uint32_t)patch->count;
    bool ok = cwi_patch_add_point(patch, middle);
    for (size_t n = 0; n < p->size && ok; n++)
        ok = cwi_patch_add_triangle(patch, p->vertex[n], p->vertex[(n + 1) % p->size], tip);
    return ok;
}

static bool triangulate_polygon(polygon_cells *p, cwi_hole_patch *patch)
{
    const size_t n = p->size, cells = n * n;
    uint32_t *stack = cwi_alloc_array(2 * n + 4, 2 * sizeof *stack);
    p->angle = cwi_alloc_zeroed(cells, sizeof *p->angle);
    p->area = cwi_alloc_zeroed(cells, sizeof *p->area);
    p->normal = cwi_alloc_zeroed(cells, sizeof *p->normal);
    p->middle = cwi_alloc_zeroed(cells, sizeof *p->middle);
    bool ok = stack && p->angle && p->area && p->normal && p->middle;
    for (size_t along = 2; along < n && ok; along++)
        for (size_t i = 0; i + along < n; i++)
            solve_cell(p, i, i + along);
    if (ok)
        ok = isfinite(p->angle[n - 1]) ? emit_triangles(p, patch, stack) : emit_fan(p, patch);
    cwi_free(stack);
    cwi_free(p->angle);
    cwi_free(p->area);
    cwi_free(p->normal);
    cwi_free(p->middle);
    return ok;
}

/* --- long rims ---------------------------------------------------------------------------- */

/* A ring of vertices from which ears are cut. */
typedef struct ear_ring {
    cwi_hole_patch *patch;
    const cwi_boundary_loop *loop;
    const cwi_hole_mesh *around;
    uint32_t *vertex;
    double (*outside)[3]; /* normal beyond the edge to the next vertex */
    size_t size;
    double facing[3]; /* of the whole rim */
} ear_ring;

/* Returns the cosine of the angle at an ear's tip; -2 for a reflex one. */
static double measure_ear(const ear_ring *e, uint32_t a, uint32_t b, uint32_t c)
{
    const double(*x)[3] = (const double(*)[3])e->patch->points;
    double u[3], v[3], normal[3];
    cwi_sub(x[a], x[b], u);
    cwi_sub(x[c], x[b], v);
    cwi_cross(v, u, normal);
    if (!(cwi_dot(normal, e->facing) > 0) || !cwi_normalise(u) || !cwi_normalise(v))
        return -2;
    return cwi_dot(u, v);
}

/* Cuts ears off that are sharper than a limit, no two beside each other. */
static bool cut_ears(ear_ring *e, double min_cosine, size_t *cut)
{
    size_t kept = 0;
    bool ok = true, was_cut = true; /* the first vertex stays */
    *cut = 0;
    for (size_t n = 0; n < e->size && ok; n++) {
        const uint32_t b = e->vertex[n];
        const bool is_open = !was_cut && n + 1 < e->size && e->size - *cut > MAX_EXACT;
        const uint32_t a = kept ? e->vertex[kept - 1] : 0, c = is_open ? e->vertex[n + 1] : 0;
        was_cut = is_open && measure_ear(e, a, b, c) >= min_cosine &&
                  !cwi_edge_exists(e->around->edges, e->around->edge_count,
                                   e->loop->vertices[a], e->loop->vertices[c]);
        if (!was_cut) {
            e->vertex[kept] = b;
            memcpy(e->outside[kept++], e->outside[n], sizeof *e->outside);
            continue;
        }
        ok = cwi_patch_add_triangle(e->patch, a, b, c);
        measure_triangle(e->patch->points[a], e->patch->points[b], e->patch->points[c],
                         e->outside[kept - 1]);
        (*cut)++;
    }
    e->size = kept;
    return ok;
}

static bool shorten_loop(ear_ring *e)
{
    static const double limits[] = {0, -0.5, -0.87, -1.5, -2.5};
    size_t level = 0, cut = 0;
    bool ok = true;
    for (size_t n = 0; n < e->size; n++) { /* Newell's normal */
        const double *p = e->patch->points[e->vertex[n]],
                     *q = e->patch->points[e->vertex[(n + 1) % e->size]];
        double area[3];
        cwi_cross(p, q, area);
        for (int a = 0; a < 3; a++)
            e->facing[a] += area[a];
    }
    while (e->size > MAX_EXACT && level < sizeof limits / sizeof *limits && ok) {
        ok = cut_ears(e, limits[level], &cut);
        level = cut ? 0 : level + 1;
    }
    return ok;
}

/* --- all rims ----------------------------------------------------------------------------- */

static void set_outside(const cwi_hole_patch *patch, const cwi_boundary_loop *loop,
                        const cw_mesh *m, double (*outside)[3])
{
    for (size_t n = 0; n < loop->size; n++) {
        double third[3];
        for (size_t a = 0; a < 3; a++)
            third[a] = (double)m->positions[3 * (size_t)loop->beside[n] + a];
        measure_triangle(patch->points[(n + 1) % loop->size], patch->points[n], third,
                         outside[n]);
    }
}

static void mark_taken(const ear_ring *e, bool *is_taken)
{
    for (size_t i = 0; i < e->size; i++)
        for (size_t j = i + 2; j < e->size; j++)
            is_taken[i * e->size + j] = cwi_edge_exists(e->around->edges, e->around->edge_count,
                                                        e->loop->vertices[e->vertex[i]],
                                                        e->loop->vertices[e->vertex[j]]);
}

bool cwi_patch_triangulate(cwi_hole_patch *patch, const cwi_boundary_loop *loop,
                           const cwi_hole_mesh *around)
{
    ear_ring e = {.patch = patch, .loop = loop, .around = around, .size = loop->size};
    bool *is_taken = NULL;
    e.vertex = cwi_alloc_array(loop->size, sizeof *e.vertex);
    e.outside = cwi_alloc_array(loop->size, sizeof *e.outside);
    bool ok = e.vertex && e.outside;
    for (uint32_t n = 0; n < loop->size && ok; n++)
        e.vertex[n] = n;
    if (ok) {
        set_outside(patch, loop, around->mesh, e.outside);
        ok = shorten_loop(&e);
    }
    polygon_cells p = {.patch = patch,
                       .vertex = e.vertex,
                       .outside = (const double(*)[3])e.outside,
                       .size = e.size};
    if (ok && e.size <= MAX_EXACT) {
        p.is_taken = is_taken = cwi_alloc_zeroed(e.size * e.size, sizeof *is_taken);
        ok = is_taken;
        if (ok)
            mark_taken(&e, is_taken);
        ok = ok && triangulate_polygon(&p, patch);
    } else if (ok) {
        ok = emit_fan(&p, patch);
    }
    cwi_free(e.vertex);
    cwi_free(e.outside);
    cwi_free(is_taken);
    return ok;
}
