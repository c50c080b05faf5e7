/* Closing handles: bridges are cut and tunnels filled where a loop is short, and nothing else changes. */
#include "support/solids.h"
#include "support/surface.h"

#include "core/base/memory.h"
#include "core/mesh/mesh.h"
#include "core/mesh/mesh_attributes.h"
#include "core/synthetic/random_fill.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Edge of the volumes in mm, around 0; voxels of 1 mm unless a test says so. */
enum { EDGE = 56 };

/* The distance of a point from a solid, about: negative inside. */
typedef double distance_function(const double p[3]);

static cw_mesh extract_solid(distance_function *distance, double voxel_mm, bool open)
{
    cw_volume v;
    cw_error err = {0};
    const size_t n = (size_t)(EDGE / voxel_mm) + 1, dim[3] = {n, n, n};
    assert_ok(cw_volume_alloc(&v, CW_F32, dim, 1, 1, &err), err);
    float *to = cw_volume_voxels(&v);
    for (size_t i = 0; i < n * n * n; i++) {
        const double p[3] = {(double)(i % n) * voxel_mm - EDGE / 2.0,
                             (double)(i / n % n) * voxel_mm - EDGE / 2.0,
                             (double)(i / n / n) * voxel_mm - EDGE / 2.0};
        to[i] = (float)distance(p);
    }
    for (int a = 0; a < 3; a++) {
        v.affine[a][a] = voxel_mm;
        v.affine[a][3] = -EDGE / 2.0;
    }
    cw_mesh m =
        test_extract(&v, &(cw_extract_desc){.inside_is_low = true, .leave_open = open}, NULL);
    cw_volume_free(&v);
    return m;
}

static double sphere(const double p[3], double radius)
{
    return hypot(hypot(p[0], p[1]), p[2]) - radius;
}

/* A torus around the axis z, or y, through (x, y, z). */
static double ring(const double p[3], const double at[3], int axis, double major, double minor)
{
    const int u = (axis + 1) % 3, w = (axis + 2) % 3;
    return hypot(hypot(p[u] - at[u], p[w] - at[w]) - major, p[axis] - at[axis]) - minor;
}

static double rod(const double p[3], double x, double y, double radius)
{
    return hypot(p[0] - x, p[1] - y) - radius;
}

static double bridged_1(const double p[3])
{
    return fmin(sphere(p, 18), ring(p, (double[3]){18, 0, 0}, 1, 6, 1.2));
}

static double bridged_3(const double p[3])
{
    const double two = fmin(bridged_1(p), ring(p, (double[3]){-18, 0.3, 0}, 1, 6, 1.4));
    return fmin(two, ring(p, (double[3]){0, 18, 0.2}, 0, 6, 1.3));
}

static double drilled_1(const double p[3])
{
    return fmax(sphere(p, 18), -rod(p, 0, 0, 1.4));
}

static double drilled_3(const double p[3])
{
    return fmax(fmax(drilled_1(p), -rod(p, 8, 1, 1.3)), -rod(p, -5, 7, 1.2));
}

static double mixed(const double p[3])
{
    return fmax(fmax(bridged_3(p), -rod(p, 0, 0, 1.4)),
                fmax(-rod(p, 8, 1, 1.3), -rod(p, -5, 7, 1.2)));
}

static double torus(const double p[3])
{
    return ring(p, (double[3]){0}, 2, 17, 5);
}

/* Two tori that meet: one is thin, and the other is not. */
static double double_torus(const double p[3])
{
    return fmin(ring(p, (double[3]){-12, 0, 0}, 2, 10, 1.4),
                ring(p, (double[3]){12, 0, 0}, 2, 10.5, 4));
}

/* A hollow ball, with a pillar in its cavity and a ring in a second ball there. */
static double nested(const double p[3])
{
    const double wall = fmax(sphere(p, 24), -sphere(p, 18));
    const double inner = fmin(sphere(p, 6), ring(p, (double[3]){6, 0, 0}, 1, 4, 1.2));
    return fmin(fmin(wall, inner), fmax(rod(p, 11, 0, 1.3), sphere(p, 20)));
}

/* A ring whose hole another solid passes. */
static double skewered(const double p[3])
{
    return fmin(ring(p, (double[3]){0}, 2, 8, 5.5), fmax(rod(p, 0, 0, 0.9), fabs(p[2]) - 15));
}

/* Half of a ball with a bridge: the volume's border cuts it open, and another bridge through. */
static double half(const double p[3])
{
    const double q[3] = {p[0], p[1], p[2] + EDGE / 2.0};
    return fmin(bridged_1(q), ring(q, (double[3]){0, 0, 19}, 1, 5, 1.3));
}

/* Noise that three box filters made smooth, in a ball. */
static cw_mesh extract_noise(unsigned seed, size_t n, bool open)
{
    cw_volume v;
    cw_error err = {0};
    const size_t dim[3] = {n, n, n}, count = n * n * n;
    assert_ok(cw_volume_alloc(&v, CW_F32, dim, 1, 1, &err), err);
    float *x = cw_volume_voxels(&v);
    for (size_t i = 0; i < count; i++)
        x[i] = (float)cwi_gaussian(seed, i);
    for (int pass = 0; pass < 2; pass++)
        for (size_t step = 1; step < count; step *= n)
            for (size_t i = 0; i + 2 * step < count; i++)
                x[i] = (x[i] + x[i + step] + x[i + 2 * step]) / 3;
    cw_mesh m =
        test_extract(&v, &(cw_extract_desc){.leave_open = open, .isovalue = 0.02F}, NULL);
    cw_volume_free(&v);
    return m;
}

static void assert_same_mesh(const cw_mesh *a, const cw_mesh *b)
{
    assert_int_equal(a->vertex_count, b->vertex_count);
    assert_int_equal(a->triangle_count, b->triangle_count);
    assert_memory_equal(a->positions, b->positions, 3 * a->vertex_count * sizeof(float));
    assert_memory_equal(a->triangles, b->triangles, 3 * a->triangle_count * sizeof(uint32_t));
    assert_int_equal(!a->normals, !b->normals);
    if (a->normals)
        assert_memory_equal(a->normals, b->normals, 3 * a->vertex_count * sizeof(float));
}

static cw_mesh copy_mesh(const cw_mesh *m)
{
    cw_mesh copy = {0};
    cw_error err = {0};
    assert_ok(cwi_mesh_copy(m, &copy, &err), err);
    return copy;
}

static cw_quality measure(const cw_mesh *m)
{
    cw_quality q;
    cw_error err = {0};
    assert_ok(cw_quality_measure(m, NULL, &q, &err), err);
    return q;
}

/* Closes the handles in place. */
static cw_status close_in_place(cw_mesh *m, const cw_close_handles_desc *desc,
                                cw_close_handles_facts *facts, cw_error *err)
{
    cw_mesh out;
    const cw_status st = cw_mesh_close_handles(m, desc, &out, facts, err);
    if (st != CW_OK) {
        assert_null(out.positions);
        return st;
    }
    cw_mesh_free(m);
    *m = out;
    return CW_OK;
}

/* Closes the handles, and holds the facts against the meshes. */
static cw_close_handles_facts close_handles(cw_mesh *m, double length_mm)
{
    cw_close_handles_facts facts;
    cw_error err = {0};
    const cw_quality before = measure(m);
    assert_ok(close_in_place(m, &(cw_close_handles_desc){.length_mm = length_mm}, &facts, &err),
              err);
    const cw_quality after = measure(m);
    assert_int_equal(facts.genus_before, before.genus);
    assert_int_equal(facts.genus_after, after.genus);
    assert_int_equal(facts.genus_before - facts.genus_after, facts.cut + facts.filled);
    assert_int_equal(facts.left_long + facts.left_crossing, facts.genus_after);
    assert_int_equal(facts.triangles_before, before.triangles);
    assert_int_equal(facts.triangles_after, after.triangles);
    assert_int_equal(facts.components_before, before.components);
    assert_int_equal(facts.components_after, after.components);
    assert_int_equal(after.components, before.components);
    assert_int_equal(after.open_edges, before.open_edges);
    assert_int_equal(after.border_loops, before.border_loops);
    assert_int_equal(after.unused_vertices, 0);
    if (!before.open_edges)
        test_check_solid(m);
    return facts;
}

/* A row: what is closed of a solid, with loops of what length. */
typedef struct closed_row {
    const char *name;
    distance_function *distance;
    double length_mm;
    size_t before, cut, filled, crossing;
} closed_row;

static const closed_row rows[] = {
    {"one bridge", bridged_1, 11, 1, 1, 0, 0},
    {"three bridges", bridged_3, 12, 3, 3, 0, 0},
    {"one tunnel", drilled_1, 12, 1, 0, 1, 0},
    {"three tunnels", drilled_3, 12, 3, 0, 3, 0},
    {"bridges and tunnels", mixed, 12, 6, 3, 3, 0},
    {"bridges, too long", bridged_3, 5, 3, 0, 0, 0},
    {"a torus, too thick", torus, 5, 1, 0, 0, 0},
    {"a torus", torus, 40, 1, 1, 0, 0},
    {"a thin and a thick torus", double_torus, 12, 2, 1, 0, 0},
    {"both tori", double_torus, 35, 2, 2, 0, 0},
    {"nested shells", nested, 11, 2, 2, 0, 0},
    {"a ring around a rod", skewered, 22, 1, 0, 0, 1},
};

static void short_handles_are_closed_and_long_ones_stay(void **state)
{
    (void)state;
    for (size_t n = 0; n < sizeof rows / sizeof *rows; n++) {
        const closed_row *r = &rows[n];
        cw_mesh m = extract_solid(r->distance, 1, false), first = copy_mesh(&m);
        const cw_close_handles_facts f = close_handles(&m, r->length_mm);
        if (f.genus_before != r->before || f.cut != r->cut || f.filled != r->filled ||
            f.left_crossing != r->crossing)
            fail_msg("%s: %zu handles, %zu cut, %zu filled, %zu left that cross", r->name,
                     f.genus_before, f.cut, f.filled, f.left_crossing);
        if (f.cut + f.filled == 0)
            assert_same_mesh(&m, &first);
        else
            assert_true(f.change_mm > 0 && f.change_mm < r->length_mm / 4);
        cw_mesh_free(&m);
        cw_mesh_free(&first);
    }
}

static void what_is_far_from_a_cut_stays_to_the_bit(void **state)
{
    (void)state;
    cw_mesh m = extract_solid(bridged_3, 1, false), first = copy_mesh(&m);
    close_handles(&m, 12);
    size_t moved = 0, changed = 0, turned = 0;
    for (size_t v = 0; v < first.vertex_count; v++)
        turned += memcmp(m.normals + 3 * v, first.normals + 3 * v, 3 * sizeof(float)) != 0;
    assert_true(turned > 10 && turned < 300);
    for (size_t v = 0; v < first.vertex_count; v++)
        moved += memcmp(m.positions + 3 * v, first.positions + 3 * v, 3 * sizeof(float)) != 0;
    for (size_t t = 0; t < first.triangle_count; t++)
        changed +=
            memcmp(m.triangles + 3 * t, first.triangles + 3 * t, 3 * sizeof(uint32_t)) != 0;
    assert_true(moved > 10 && moved < 100);
    assert_true(changed > 10 && changed < 300);
    cw_mesh_free(&m);
    cw_mesh_free(&first);
}

/* The default length is a fraction of the box: thin handles go, and the torus itself stays. */
static void the_default_length_is_small(void **state)
{
    (void)state;
    cw_mesh thick = extract_solid(torus, 1, false), ball = extract_solid(bridged_3, 1, false);
    const cw_close_handles_facts t = close_handles(&thick, 0), b = close_handles(&ball, 0);
    assert_int_equal(t.genus_after, 1);
    assert_int_equal(b.genus_after, 3);
    assert_within(t.length_mm, CW_HANDLE_FRACTION * sqrt(44.0 * 44 * 2 + 100), 0.01);
    cw_mesh_free(&thick);
    cw_mesh_free(&ball);
}

static void noise_of_many_handles_closes(void **state)
{
    (void)state;
    for (unsigned seed = 1; seed < 4; seed++) {
        cw_mesh m = extract_noise(seed, 24 + 4 * seed, false);
        const cw_close_handles_facts f = close_handles(&m, 14);
        assert_true(f.genus_before > 20 && f.cut > 5 && f.filled > 5);
        assert_true(f.genus_after < f.genus_before / 3);
        cw_mesh again = copy_mesh(&m); /* what is left is too long, or crosses */
        const cw_close_handles_facts g = close_handles(&again, 14);
        assert_true(g.genus_before - g.genus_after <= f.left_crossing);
        cw_mesh_free(&m);
        cw_mesh_free(&again);
    }
}

static void a_surface_without_handles_stays_to_the_bit(void **state)
{
    (void)state;
    cw_mesh solids[] = {test_extract_field(CW_FIELD_SPHERE, 24), {0}, {0}, {0}};
    test_make_cube(&solids[1]);
    test_make_tetrahedron(&solids[2]);
    for (size_t n = 0; n < 4; n++) { /* the last one is empty */
        cw_mesh first = copy_mesh(&solids[n]);
        cw_close_handles_facts facts;
        cw_error err = {0};
        assert_ok(close_in_place(&solids[n], &(cw_close_handles_desc){.length_mm = 1000},
                                 &facts, &err),
                  err);
        assert_int_equal(facts.genus_before, 0);
        if (n < 3)
            assert_same_mesh(&solids[n], &first);
        cw_mesh_free(&solids[n]);
        cw_mesh_free(&first);
    }
}

static void open_edges_stay_where_they_are(void **state)
{
    (void)state;
    for (int n = 0; n < 3; n++) {
        cw_mesh m =
            n < 1 ? extract_solid(half, 1, true) : extract_noise(6 + (unsigned)n, 24, true);
        cw_mesh first = copy_mesh(&m);
        const cw_close_handles_facts f = close_handles(&m, 12);
        assert_true(n < 1 ? f.genus_before == 1 && f.genus_after == 0
                          : f.cut + f.filled > 5 && f.genus_after < f.genus_before);
        uint8_t *defects = cwi_alloc_zeroed(m.triangle_count, 1);
        cw_quality q;
        cw_error err = {0};
        assert_ok(cw_quality_measure(&m, &(cw_quality_desc){.defects = defects}, &q, &err),
                  err);
        assert_true(q.open_edges > 20);
        for (size_t t = 0; t < m.triangle_count; t++)
            if (defects[t] & CW_DEFECT_OPEN)
                assert_true(t < first.triangle_count);
        cwi_free(defects);
        cw_mesh_free(&m);
        cw_mesh_free(&first);
    }
}

/* A fin on a bridged ball: an edge of three triangles, which no loop may pass. */
static void what_is_no_manifold_is_left_alone(void **state)
{
    (void)state;
    cw_mesh m = extract_solid(bridged_3, 1, false);
    const size_t triangles = m.triangle_count, vertices = m.vertex_count;
    cw_error err = {0};
    cw_mesh fin = {0};
    assert_ok(cwi_mesh_alloc(&fin, vertices + 1, triangles + 2, false, &err), err);
    memcpy(fin.positions, m.positions, 3 * vertices * sizeof(float));
    memcpy(fin.triangles, m.triangles, 3 * triangles * sizeof(uint32_t));
    for (int a = 0; a < 3; a++)
        fin.positions[3 * vertices + (size_t)a] = 1;
    memcpy(fin.triangles + 3 * triangles,
           (uint32_t[6]){m.triangles[0], m.triangles[1], (uint32_t)vertices, m.triangles[1],
                         m.triangles[1], m.triangles[2]},
           6 * sizeof(uint32_t));
    cw_close_handles_facts f;
    assert_ok(close_in_place(&fin, &(cw_close_handles_desc){.length_mm = 12}, &f, &err), err);
    assert_int_equal(f.cut, 3);
    assert_int_equal(f.genus_after, 0);
    const cw_quality q = measure(&fin);
    assert_int_equal(q.nonmanifold_edges, 1);
    assert_int_equal(q.open_edges, 2);
    cw_mesh_free(&m);
    cw_mesh_free(&fin);
}

static size_t count_crossings(const cw_mesh *m)
{
    cw_crossings found;
    cw_error err = {0};
    assert_ok(cw_self_intersections(m, NULL, &found, &err), err);
    const size_t count = found.count;
    cw_crossings_free(&found);
    return count;
}

/* Two bridged balls that cross: handles go, and the crossings are no more than before. */
static void crossings_of_the_input_stay(void **state)
{
    (void)state;
    for (int n = 0; n < 3; n++) {
        cw_mesh m = extract_solid(bridged_3, 1, false), other = copy_mesh(&m);
        cw_error err = {0};
        for (size_t v = 0; v < other.vertex_count; v++)
            other.positions[3 * v + 2] += (float)(6 + 9 * n); /* along z, where no bridge is */
        assert_ok(cwi_mesh_append(&m, &other, &err), err);
        const size_t before = count_crossings(&m);
        assert_true(before > 50);
        cw_close_handles_facts f;
        assert_ok(close_in_place(&m, &(cw_close_handles_desc){.length_mm = 12}, &f, &err), err);
        assert_int_equal(f.genus_before, 6);
        assert_true(f.cut + f.left_crossing == 6 && f.cut > 2);
        assert_true(count_crossings(&m) <= before);
        cw_mesh_free(&m);
        cw_mesh_free(&other);
    }
}

static void scale_mesh(cw_mesh *m, double scale)
{
    for (size_t n = 0; n < 3 * m->vertex_count; n++)
        m->positions[n] = (float)((double)m->positions[n] * scale);
    for (int a = 0; a < 3; a++)
        m->origin[a] *= scale;
}

static void any_unit_gives_the_same(void **state)
{
    (void)state;
    const double scales[] = {1, 0x1p-13, 0x1p13, 1e-4, 1e4};
    cw_mesh first = {0};
    for (size_t n = 0; n < 5; n++) {
        cw_mesh m = extract_solid(mixed, 1, false);
        scale_mesh(&m, scales[n]);
        const cw_close_handles_facts f = close_handles(&m, 12 * scales[n]);
        assert_int_equal(f.genus_before - f.genus_after, 6);
        if (n == 0) {
            first = copy_mesh(&m);
        } else if (n < 3) { /* powers of 2 change no digit */
            scale_mesh(&m, 1 / scales[n]);
            assert_same_mesh(&m, &first);
        }
        cw_mesh_free(&m);
    }
    cw_mesh_free(&first);
}

static void any_number_of_threads_gives_the_same(void **state)
{
    (void)state;
    const int threads[] = {1, 2, 5};
    cw_mesh made[3];
    for (int n = 0; n < 3; n++) {
        cw_error err = {0};
        const cw_close_handles_desc desc = {.length_mm = 14, .threads = threads[n]};
        made[n] = extract_noise(9, 40, false);
        assert_ok(close_in_place(&made[n], &desc, NULL, &err), err);
        assert_same_mesh(&made[n], &made[0]);
    }
    for (int n = 0; n < 3; n++)
        cw_mesh_free(&made[n]);
}

static void attributes_come_along(void **state)
{
    (void)state;
    cw_mesh m = extract_solid(mixed, 1, false);
    cw_error err = {0};
    const cw_attribute like = {
        .name = "part", .on = CW_ON_TRIANGLES, .type = CW_U8, .components = 1};
    cw_attribute *part;
    m.labels = cwi_alloc_array(m.vertex_count, sizeof *m.labels);
    assert_non_null(m.labels);
    for (size_t v = 0; v < m.vertex_count; v++)
        m.labels[v] = (uint32_t)v;
    assert_ok(cw_mesh_attribute_add(&m, &like, &part, &err), err);
    memset(part->data, 7, m.triangle_count);
    cw_mesh first = copy_mesh(&m);
    close_handles(&m, 12);
    assert_true(m.vertex_count > first.vertex_count);
    assert_non_null(m.normals);
    for (size_t v = 0; v < m.vertex_count; v++)
        assert_true(v < first.vertex_count ? m.labels[v] == v
                                           : m.labels[v] < first.vertex_count);
    part = cw_mesh_attribute_find(&m, "part");
    assert_non_null(part);
    for (size_t t = 0; t < m.triangle_count; t++)
        assert_int_equal(((const uint8_t *)part->data)[t], 7);
    cw_mesh_free(&m);
    cw_mesh_free(&first);
}

static void wrong_arguments_are_told(void **state)
{
    (void)state;
    cw_mesh m = test_extract_field(CW_FIELD_SPHERE, 8);
    cw_mesh out;
    cw_error err = {0};
    assert_fails(cw_mesh_close_handles(NULL, NULL, &out, NULL, &err), CW_ERR_ARGUMENT, "mesh",
                 err);
    assert_fails(cw_mesh_close_handles(&m, NULL, NULL, NULL, &err), CW_ERR_ARGUMENT, "out",
                 err);
    assert_fails(
        cw_mesh_close_handles(&m, &(cw_close_handles_desc){.length_mm = -1}, &out, NULL, &err),
        CW_ERR_ARGUMENT, "length_mm is -1; it must be finite, and 0 or more", err);
    assert_fails(cw_mesh_close_handles(&m, &(cw_close_handles_desc){.length_mm = (double)NAN},
                                       &out, NULL, &err),
                 CW_ERR_ARGUMENT, "length_mm", err);
    assert_fails(
        cw_mesh_close_handles(&m, &(cw_close_handles_desc){.version = 9}, &out, NULL, &err),
        CW_ERR_ARGUMENT, "version", err);
    m.triangles[4] = (uint32_t)m.vertex_count;
    assert_fails(cw_mesh_close_handles(&m, NULL, &out, NULL, &err), CW_ERR_ARGUMENT, "", err);
    cw_mesh_free(&m);
}

static void failures_and_cancelling_leave_the_mesh(void **state)
{
    (void)state;
    cw_mesh m = extract_noise(2, 14, false), first = copy_mesh(&m);
    cw_close_handles_desc desc = {.length_mm = 12, .threads = 1};
    cw_close_handles_facts facts;
    cw_error err = {0};
    cw_status st = CW_ERR_CANCELLED;
    int stops = 0;
    for (; st != CW_OK; stops++) {
        int polls = stops;
        desc.progress = (cw_progress){test_stop_after, &polls};
        st = close_in_place(&m, &desc, &facts, &err);
        if (st == CW_OK)
            break;
        assert_int_equal(st, CW_ERR_CANCELLED);
        assert_same_mesh(&m, &first);
        assert_int_equal(facts.genus_before, 0);
    }
    assert_true(stops > 5);
    cw_mesh_free(&m);
    m = copy_mesh(&first);
    desc.progress = (cw_progress){0};
    st = CW_ERR_NO_MEMORY;
    for (long n = 0; st != CW_OK; n += 1 + (test_is_short() ? n / 4 : n / 64)) {
        cwi_alloc_fail_after(n);
        st = close_in_place(&m, &desc, NULL, &err);
        if (!cwi_alloc_fail_after(-1)) {
            assert_ok(st, err);
            break;
        }
        assert_fails(st, CW_ERR_NO_MEMORY, "memory", err);
        assert_same_mesh(&m, &first);
    }
    cw_mesh_free(&m);
    cw_mesh_free(&first);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(short_handles_are_closed_and_long_ones_stay),
        cmocka_unit_test(what_is_far_from_a_cut_stays_to_the_bit),
        cmocka_unit_test(the_default_length_is_small),
        cmocka_unit_test(noise_of_many_handles_closes),
        cmocka_unit_test(a_surface_without_handles_stays_to_the_bit),
        cmocka_unit_test(open_edges_stay_where_they_are),
        cmocka_unit_test(what_is_no_manifold_is_left_alone),
        cmocka_unit_test(crossings_of_the_input_stay),
        cmocka_unit_test(any_unit_gives_the_same),
        cmocka_unit_test(any_number_of_threads_gives_the_same),
        cmocka_unit_test(attributes_come_along),
        cmocka_unit_test(wrong_arguments_are_told),
        cmocka_unit_test(failures_and_cancelling_leave_the_mesh),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
