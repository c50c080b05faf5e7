/* Extracts surfaces for tests, compares them, and looks for faults in them. */
#include "support/surface.h"

#include "core/base/memory.h"
#include "core/geometry/vec3.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

cw_volume test_sample(cw_field field, size_t n, cw_type type)
{
    const cw_field_desc desc = {.field = field, .dim = {n, n, n}, .type = type};
    cw_volume v;
    cw_error err = {0};
    assert_ok(cw_field_sample(&desc, &v, &err), err);
    return v;
}

cw_mesh test_extract(const cw_volume *volume, const cw_extract_desc *desc,
                     cw_extract_counts *counts)
{
    cw_mesh mesh = {0};
    cw_error err = {0};
    assert_ok(cw_extract(volume, desc, &mesh, counts, &err), err);
    return mesh;
}

static const char *quality_fault(const cw_quality *q, bool open)
{
    return q->nonmanifold_edges      ? "an edge of more than two triangles"
           : q->misoriented_edges    ? "an edge that two triangles run through the same way"
           : q->nonmanifold_vertices ? "a vertex with two fans of triangles"
           : q->degenerate           ? "a triangle without area"
           : q->unused_vertices      ? "a vertex in no triangle"
           : q->merged_vertices      ? "a vertex at the place of another"
           : q->open_edges && !open  ? "an open edge"
                                     : NULL;
}

static int compare_triangles(const void *a, const void *b)
{
    const uint32_t *s = a, *t = b;
    for (int c = 0; c < 3; c++)
        if (s[c] != t[c])
            return s[c] < t[c] ? -1 : 1;
    return 0;
}

static void sort_corners(const uint32_t *triangle, uint32_t sorted[3])
{
    const uint32_t a = triangle[0], b = triangle[1], c = triangle[2];
    const uint32_t low = a < b ? a : b, high = a < b ? b : a;
    sorted[0] = c < low ? c : low;
    sorted[2] = c > high ? c : high;
    sorted[1] = a ^ b ^ c ^ sorted[0] ^ sorted[2];
}

/* Two back to back would pass for a closed manifold. */
static bool has_equal_triangles(const cw_mesh *mesh)
{
    bool equal = false;
    uint32_t(*sorted)[3] = malloc(mesh->triangle_count * sizeof *sorted + 1);
    assert_non_null(sorted);
    for (size_t t = 0; t < mesh->triangle_count; t++)
        sort_corners(mesh->triangles + 3 * t, sorted[t]);
    qsort(sorted, mesh->triangle_count, sizeof *sorted, compare_triangles);
    for (size_t t = 1; t < mesh->triangle_count; t++)
        equal = equal || compare_triangles(sorted[t - 1], sorted[t]) == 0;
    free(sorted);
    return equal;
}

static bool has_unit_normals(const cw_mesh *mesh)
{
    for (size_t v = 0; v < mesh->vertex_count && mesh->normals; v++) {
        const float *n = mesh->normals + 3 * v;
        const double square = (double)n[0] * n[0] + (double)n[1] * n[1] + (double)n[2] * n[2];
        if (!(fabs(square - 1) < 1e-5))
            return false;
    }
    return true;
}

const char *test_mesh_fault(const cw_mesh *mesh, bool open, cw_quality *quality)
{
    cw_quality q[2];
    for (int weld = 0; weld < 2; weld++) {
        const cw_quality_desc desc = {.weld = weld};
        if (cw_quality_measure(mesh, &desc, &q[weld], NULL) != CW_OK)
            return "a position that is not finite, or an index that is none";
        if (quality_fault(&q[weld], open))
            return quality_fault(&q[weld], open);
    }
    if (quality)
        *quality = q[0];
    return !has_unit_normals(mesh)     ? "a normal that is not of unit length"
           : has_equal_triangles(mesh) ? "two triangles of the same corners"
                                       : NULL;
}

cw_quality test_check_promise(const cw_mesh *mesh, bool open)
{
    cw_quality quality;
    const char *fault = test_mesh_fault(mesh, open, &quality);
    if (fault)
        fail_msg("the mesh has %s", fault);
    return quality;
}

/* The largest coordinate in magnitude. */
static double largest_coordinate(const cw_mesh *mesh)
{
    double largest = 0;
    for (size_t n = 0; n < 3 * mesh->vertex_count; n++)
        largest = fmax(largest, fabs((double)mesh->positions[n]));
    return largest;
}

bool test_normals_agree(const cw_mesh *mesh)
{
    return test_normals_agree_but(mesh, 0);
}

bool test_normals_agree_but(const cw_mesh *mesh, double share)
{
    const double thin = share * largest_coordinate(mesh);
    for (size_t c = 0; c < 3 * mesh->triangle_count; c++) {
        const size_t first = c - c % 3;
        const float *p[3], *n = mesh->normals + 3 * (size_t)mesh->triangles[c];
        double u[3], w[3], normal[3], dot = 0, longest = 0;
        for (size_t k = 0; k < 3; k++)
            p[k] = mesh->positions + 3 * (size_t)mesh->triangles[first + k];
        for (int a = 0; a < 3; a++) {
            u[a] = (double)p[1][a] - (double)p[0][a];
            w[a] = (double)p[2][a] - (double)p[0][a];
            longest = fmax(longest, fmax(fabs(u[a]), fabs(w[a])));
        }
        cwi_cross(u, w, normal);
        for (int a = 0; a < 3; a++)
            dot += (double)n[a] * normal[a];
        if (!(dot > 0) && !(sqrt(cwi_dot(normal, normal)) < thin * longest))
            return false;
    }
    return true;
}

void test_assert_same_mesh(const cw_mesh *a, const cw_mesh *b)
{
    assert_int_equal(a->vertex_count, b->vertex_count);
    assert_int_equal(a->triangle_count, b->triangle_count);
    assert_memory_equal(a->origin, b->origin, sizeof a->origin);
    assert_memory_equal(a->positions, b->positions, 12 * a->vertex_count);
    assert_int_equal(!a->normals, !b->normals);
    if (a->normals)
        assert_memory_equal(a->normals, b->normals, 12 * a->vertex_count);
    assert_memory_equal(a->triangles, b->triangles, 12 * a->triangle_count);
}

/* A triangle's corners with their normals, from the corner with the lowest place on. */
typedef struct corners {
    float x[3][6];
} corners;

static int compare_corners(const void *a, const void *b)
{
    return memcmp(a, b, sizeof(corners));
}

static corners *sorted_corners(const cw_mesh *m)
{
    corners *all = calloc(m->triangle_count + 1, sizeof *all);
    assert_non_null(all);
    for (size_t t = 0; t < m->triangle_count; t++) {
        const uint32_t *v = m->triangles + 3 * t;
        size_t first = 0;
        for (size_t c = 1; c < 3; c++)
            if (memcmp(m->positions + 3 * (size_t)v[c], m->positions + 3 * (size_t)v[first],
                       3 * sizeof(float)) < 0)
                first = c;
        for (size_t c = 0; c < 3; c++) {
            const size_t vertex = v[(first + c) % 3];
            memcpy(all[t].x[c], m->positions + 3 * vertex, 3 * sizeof(float));
            if (m->normals)
                memcpy(all[t].x[c] + 3, m->normals + 3 * vertex, 3 * sizeof(float));
        }
    }
    qsort(all, m->triangle_count, sizeof *all, compare_corners);
    return all;
}

void test_assert_same_triangles(const cw_mesh *a, const cw_mesh *b)
{
    assert_int_equal(a->vertex_count, b->vertex_count);
    assert_int_equal(a->triangle_count, b->triangle_count);
    assert_memory_equal(a->origin, b->origin, sizeof a->origin);
    assert_memory_equal(a->affine, b->affine, sizeof a->affine);
    corners *p = sorted_corners(a), *q = sorted_corners(b);
    assert_memory_equal(p, q, a->triangle_count * sizeof *p);
    free(p);
    free(q);
}

void test_turn(cw_volume *volume, int round)
{
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++)
            volume->affine[r][c] = (r == c ? 2.0 : 0) + (double)rand() / RAND_MAX - 0.5;
    if (round % 3 == 0)
        for (int r = 0; r < 3; r++)
            volume->affine[r][0] *= -1;
}

size_t test_count_crossings(const cw_mesh *mesh)
{
    cw_crossings crossings = {0};
    cw_error err = {0};
    assert_ok(cw_self_intersections(mesh, NULL, &crossings, &err), err);
    assert_false(crossings.undecided);
    const size_t count = crossings.count;
    cw_crossings_free(&crossings);
    return count;
}

cw_quality test_measure(const cw_mesh *mesh)
{
    cw_quality quality;
    cw_error err = {0};
    assert_ok(cw_quality_measure(mesh, NULL, &quality, &err), err);
    return quality;
}

const char *test_reduced_fault(const cw_mesh *before, const cw_mesh *after)
{
    const cw_quality a = test_measure(before), b = test_measure(after);
    if (b.triangles > a.triangles)
        return "has more triangles";
    if (a.components != b.components)
        return "has not as many components";
    if (a.euler != b.euler)
        return "has another Euler number";
    if (a.border_loops != b.border_loops)
        return "has not as many border loops";
    if (b.nonmanifold_edges || b.nonmanifold_vertices || b.misoriented_edges || b.duplicates)
        return "is no manifold";
    if (b.degenerate)
        return "has triangles without area";
    if (b.unused_vertices)
        return "has vertices in no triangle";
    return test_count_crossings(after) ? "crosses itself" : NULL;
}

void test_assert_sound(const cw_mesh *before, const cw_mesh *after)
{
    const char *fault = test_reduced_fault(before, after);
    if (fault)
        fail_msg("the result %s", fault);
}

void test_repair_without_memory(const cw_mesh *mesh, const cw_repair_desc *desc, long least)
{
    cw_mesh out = {0};
    cw_error err = {0};
    for (long n = 0;; n++) {
        cwi_alloc_fail_after(n);
        const cw_status st = cw_mesh_repair(mesh, desc, &out, NULL, &err);
        if (!cwi_alloc_fail_after(-1)) {
            assert_ok(st, err);
            assert_true(n > least);
            break;
        }
        assert_int_equal(st, CW_ERR_NO_MEMORY);
        assert_true(!out.positions && !out.triangles);
    }
    cw_mesh_free(&out);
}

void test_bound_is_measured(const cw_mesh *a, const cw_mesh *b, double error)
{
    const cw_mesh_distance_desc how = {.tolerance_mm = 0.01 * error};
    cw_distance distance;
    cw_error err = {0};
    assert_ok(cw_distance_to_mesh(a, b, &how, &distance, NULL, &err), err);
    if (distance.max_mm > error)
        fail_msg("%g mm where %g are promised", distance.max_mm, error);
}

void test_bound_is_kept(const cw_mesh *a, const cw_mesh *b, double error)
{
    cw_error err = {0};
    test_bound_is_measured(a, b, error);
    if (cw_quality_has_cgal()) {
        double by_cgal;
        assert_ok(cw_distance_by_cgal(a, b, 0.05 * error, &by_cgal, &err), err);
        if (by_cgal > 1.05 * error)
            fail_msg("%g mm by CGAL where %g are promised", by_cgal, error);
    }
}
