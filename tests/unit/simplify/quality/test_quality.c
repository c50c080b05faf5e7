/* Meshes with one planted fault each, and what the checks must say of them. */
#include "support/surface.h"

#include "core/base/memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static cw_quality measure(const cw_mesh *mesh, bool weld)
{
    cw_quality q;
    cw_error err = {0};
    assert_ok(cw_quality_measure(mesh, &(cw_quality_desc){.weld = weld}, &q, &err), err);
    return q;
}

static void a_cube_is_all_it_should_be(void **state)
{
    (void)state;
    cw_mesh mesh;
    test_make_cube(&mesh);
    mesh.origin[0] = 1e6;
    const cw_quality q = measure(&mesh, false);
    assert_true(cw_quality_is_closed_manifold(&q));
    assert_int_equal(q.edges, 18);
    assert_int_equal(q.euler, 2);
    assert_int_equal(q.components, 1);
    assert_near(q.area_mm2, 6, 1e-12);
    assert_near(q.volume_mm3, 1, 1e-12);
    assert_true(q.min[0] == 1e6 && q.max[0] == 1e6 + 1);
    cw_mesh_free(&mesh);
}

static void a_missing_triangle_opens_three_edges(void **state)
{
    (void)state;
    cw_mesh mesh;
    test_make_cube(&mesh);
    mesh.triangle_count--;
    const cw_quality q = measure(&mesh, false);
    assert_int_equal(q.open_edges, 3);
    assert_int_equal(q.euler, 1);
    assert_false(cw_quality_is_closed_manifold(&q));
    cw_mesh_free(&mesh);
}

static void a_flipped_triangle_misorients_three_edges(void **state)
{
    (void)state;
    cw_mesh mesh;
    test_make_tetrahedron(&mesh);
    const uint32_t t = mesh.triangles[0];
    mesh.triangles[0] = mesh.triangles[1];
    mesh.triangles[1] = t;
    const cw_quality q = measure(&mesh, false);
    assert_int_equal(q.misoriented_edges, 3);
    assert_int_equal(q.open_edges, 0);
    cw_mesh_free(&mesh);
}

static void a_repeated_triangle_makes_edges_nonmanifold(void **state)
{
    (void)state;
    cw_mesh mesh;
    test_make_tetrahedron(&mesh);
    uint32_t *more = realloc(mesh.triangles, 15 * sizeof *more);
    assert_non_null(more);
    memcpy(more + 12, more, 3 * sizeof *more);
    mesh.triangles = more;
    mesh.triangle_count = 5;
    assert_int_equal(measure(&mesh, false).nonmanifold_edges, 3);
    cw_mesh_free(&mesh);
}

static void inside_out_has_a_negative_volume(void **state)
{
    (void)state;
    cw_mesh mesh;
    test_make_cube(&mesh);
    for (size_t t = 0; t < mesh.triangle_count; t++) {
        const uint32_t swap = mesh.triangles[3 * t];
        mesh.triangles[3 * t] = mesh.triangles[3 * t + 1];
        mesh.triangles[3 * t + 1] = swap;
    }
    const cw_quality q = measure(&mesh, false);
    assert_true(cw_quality_is_closed_manifold(&q));
    assert_near(q.volume_mm3, -1, 1e-12);
    cw_mesh_free(&mesh);
}

/* The same triangle twice, and nothing else: no edge has more than two. */
static void a_triangle_alone_may_be_there_twice(void **state)
{
    (void)state;
    float points[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 5, 5, 5}; /* the last is in none */
    uint32_t corners[] = {0, 1, 2, 2, 0, 1};
    const cw_mesh mesh = {
        .vertex_count = 4, .triangle_count = 2, .positions = points, .triangles = corners};
    const cw_quality q = measure(&mesh, true);
    assert_int_equal(q.duplicates, 1);
    assert_int_equal(q.nonmanifold_edges, 0);
    assert_int_equal(q.unused_vertices, 1);
    assert_int_equal(q.merged_vertices, 0);
}

/* A triangle with two slivers' faults is a cap only. */
static void a_sliver_is_a_cap_or_a_needle(void **state)
{
    (void)state;
    static const struct {
        float x, y; /* of the third corner, above a side of 100 mm */
        size_t needles, caps;
    } rows[] = {{50, 80, 0, 0}, {50, 1, 0, 1}, {0, 1, 1, 0}, {99, 0.01f, 0, 1}};
    for (size_t n = 0; n < sizeof rows / sizeof *rows; n++) {
        float points[] = {0, 0, 0, 100, 0, 0, rows[n].x, rows[n].y, 0};
        uint32_t corners[] = {0, 1, 2};
        const cw_mesh mesh = {
            .vertex_count = 3, .triangle_count = 1, .positions = points, .triangles = corners};
        const cw_quality q = measure(&mesh, false);
        assert_int_equal(q.needles, rows[n].needles);
        assert_int_equal(q.caps, rows[n].caps);
    }
}

/* A pyramid without its base, wound inward: only a high one is nearly a solid. */
static void an_open_shell_must_be_nearly_closed_to_face_inward(void **state)
{
    (void)state;
    static const struct {
        float height;
        size_t inward;
    } rows[] = {{0.03f, 0}, {0.05f, 0}, {0.07f, 1}, {1, 1}, {-1, 0}};
    for (size_t n = 0; n < sizeof rows / sizeof *rows; n++) {
        float points[] = {-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0, 0, 0, rows[n].height};
        uint32_t corners[] = {1, 0, 4, 2, 1, 4, 3, 2, 4, 0, 3, 4};
        const cw_mesh mesh = {
            .vertex_count = 5, .triangle_count = 4, .positions = points, .triangles = corners};
        cw_quality q;
        cw_error err = {0};
        assert_ok(cw_quality_measure(&mesh, &(cw_quality_desc){.shells = true}, &q, &err), err);
        assert_int_equal(q.open_inward, rows[n].inward);
    }
}

/* Two tetrahedra that touch in vertex 0: a bow tie. As indexed or as welded, not both. */
static void a_bow_tie_is_found_by_index_or_by_place(void **state)
{
    (void)state;
    for (int shared = 0; shared < 2; shared++) {
        cw_mesh mesh;
        test_make_tetrahedron(&mesh);
        float *p = realloc(mesh.positions, 24 * sizeof *p);
        uint32_t *t = realloc(mesh.triangles, 24 * sizeof *t);
        assert_true(p && t);
        for (int n = 0; n < 12; n++) {
            p[12 + n] = -p[n];
            t[12 + n] = 4 + t[3 * (n / 3) + 2 - n % 3]; /* mirrored: wound the other way */
            if (shared && t[12 + n] == 4)
                t[12 + n] = 0;
        }
        mesh.positions = p;
        mesh.triangles = t;
        mesh.vertex_count = mesh.triangle_count = 8;
        const cw_quality q = measure(&mesh, false), w = measure(&mesh, true);
        assert_int_equal(q.nonmanifold_vertices, shared);
        assert_int_equal(q.components, shared ? 1 : 2);
        assert_int_equal(q.unused_vertices, shared);
        assert_int_equal(w.nonmanifold_vertices, 1);
        assert_int_equal(w.components, 1);
        assert_int_equal(w.open_edges, 0);
        assert_near(q.volume_mm3, 2.0 / 6, 1e-7);
        cw_mesh_free(&mesh);
    }
}

static void zero_area_is_counted_whatever_its_cause(void **state)
{
    (void)state;
    cw_mesh mesh;
    test_make_tetrahedron(&mesh);
    mesh.positions[3] = mesh.positions[4] = mesh.positions[5] = 0; /* vertex 1 onto vertex 0 */
    assert_int_equal(measure(&mesh, false).degenerate, 2);
    assert_int_equal(measure(&mesh, true).degenerate, 2);
    mesh.triangles[1] = mesh.triangles[0]; /* and one that names a vertex twice */
    assert_int_equal(measure(&mesh, false).degenerate, 3 - 1 + 0);
    cw_mesh_free(&mesh);
}

static void hostile_meshes_are_refused_by_name(void **state)
{
    (void)state;
    cw_mesh mesh;
    cw_quality q;
    cw_error err = {0};
    test_make_cube(&mesh);
    mesh.triangles[7] = 8;
    assert_fails(cw_quality_measure(&mesh, NULL, &q, &err), CW_ERR_ARGUMENT,
                 "triangle 2 names vertex 8 of 8", err);
    mesh.triangles[7] = 0;
    mesh.positions[10] = NAN;
    assert_fails(cw_quality_measure(&mesh, NULL, &q, &err), CW_ERR_ARGUMENT, "vertex 3", err);
    mesh.origin[2] = INFINITY;
    assert_fails(cw_quality_measure(&mesh, NULL, &q, &err), CW_ERR_ARGUMENT, "origin", err);
    cw_mesh_free(&mesh);
    assert_ok(cw_quality_measure(&mesh, NULL, &q, &err), err);
    assert_int_equal(q.triangles, 0);
}

/* A hundred thousand slivers around one edge: found, and in no quadratic time. */
static void a_hub_is_not_quadratic(void **state)
{
    (void)state;
    enum { COUNT = 100000 };
    cw_mesh mesh = {.vertex_count = COUNT + 2, .triangle_count = COUNT};
    mesh.positions = calloc(3 * (COUNT + 2), sizeof(float));
    mesh.triangles = calloc(3 * COUNT, sizeof(uint32_t));
    assert_true(mesh.positions && mesh.triangles);
    for (uint32_t t = 0; t < COUNT; t++) {
        mesh.triangles[3 * t + 1] = 1;
        mesh.triangles[3 * t + 2] = COUNT + 1 - t;
    }
    const cw_quality q = measure(&mesh, false);
    assert_int_equal(q.nonmanifold_edges, 1);
    assert_int_equal(q.open_edges, 2 * COUNT);
    assert_int_equal(q.degenerate, COUNT);
    cw_mesh_free(&mesh);
}

static size_t sum(const size_t *bins, size_t count)
{
    size_t total = 0;
    for (size_t n = 0; n < count; n++)
        total += bins[n];
    return total;
}

/* A regular tetrahedron, and a right triangle with sides of 3, 4 and 5. */
static void shapes_are_those_of_school(void **state)
{
    (void)state;
    cw_mesh mesh;
    test_make_tetrahedron(&mesh);
    const float regular[12] = {0, 0, 0, 1, 1, 0, 1, 0, 1, 0, 1, 1};
    memcpy(mesh.positions, regular, sizeof regular);
    const cw_shapes a = measure(&mesh, false).shapes;
    assert_near(a.min_angle_deg, 60, 1e-9);
    assert_near(a.max_angle_deg, 60, 1e-9);
    assert_near(a.max_aspect, 1, 1e-12);
    assert_near(a.min_edge_mm, sqrt(2), 1e-12);
    assert_int_equal(a.aspects[0], 4);
    assert_int_equal(sum(a.angles, CW_ANGLE_BINS), 12);
    assert_int_equal(a.smallest[CW_ANGLE_BINS - 1] + a.smallest[CW_ANGLE_BINS - 2], 4);

    const float right[9] = {0, 0, 0, 3, 0, 0, 0, 4, 0};
    memcpy(mesh.positions, right, sizeof right);
    for (uint32_t n = 0; n < 3; n++)
        mesh.triangles[n] = n;
    mesh.triangle_count = 1;
    const cw_shapes b = measure(&mesh, false).shapes;
    assert_near(b.min_angle_deg, 180 / PI * atan2(3, 4), 1e-9);
    assert_near(b.max_angle_deg, 90, 1e-9);
    assert_near(b.max_aspect, 2.5 / 2, 1e-12); /* circumradius 5/2, inradius 1 */
    assert_int_equal(b.angles[3] + b.angles[5] + b.angles[8] + b.angles[9], 3);
    assert_int_equal(b.lengths[0], 1);
    assert_int_equal(b.lengths[CW_LENGTH_BINS - 1], 1);
    assert_int_equal(sum(b.lengths, CW_LENGTH_BINS), 3);
    assert_near(b.min_edge_mm, 3, 1e-12);
    assert_near(b.max_edge_mm, 5, 1e-12);
    cw_mesh_free(&mesh);
}

/* Sums of 20 000 triangles and the marks on them, for one thread and for three. */
static void threads_change_no_bit(void **state)
{
    (void)state;
    cw_volume volume = test_sample(CW_FIELD_GYROID, 30, CW_F32);
    cw_mesh mesh = test_extract(&volume, &(cw_extract_desc){.leave_open = true}, NULL);
    cw_quality q[2];
    uint8_t *marks[2];
    cw_error err = {0};
    assert_true(mesh.triangle_count > 9000);
    for (int n = 0; n < 2; n++) {
        marks[n] = calloc(mesh.triangle_count, 1);
        const cw_quality_desc desc = {
            .shells = true, .threads = n ? 3 : 1, .defects = marks[n]};
        assert_ok(cw_quality_measure(&mesh, &desc, &q[n], &err), err);
    }
    assert_true(q[0].area_mm2 == q[1].area_mm2 && q[0].volume_mm3 == q[1].volume_mm3);
    assert_memory_equal(&q[0].shapes, &q[1].shapes, sizeof q[0].shapes);
    assert_memory_equal(marks[0], marks[1], mesh.triangle_count);
    assert_true(q[0].border_loops > 0 && q[0].open_edges > 0);
    free(marks[0]);
    free(marks[1]);
    cw_mesh_free(&mesh);
    cw_volume_free(&volume);
}

typedef struct listener {
    size_t calls, stop_at; /* 0: never */
} listener;

static bool listen(void *user, const char *step, double done)
{
    listener *l = user;
    assert_string_equal(step, "checking");
    assert_true(done >= 0 && done <= 1);
    return ++l->calls != l->stop_at;
}

static void it_stops_wherever_it_is_asked_to(void **state)
{
    (void)state;
    cw_volume v = test_sample(CW_FIELD_SPHERE, 64, CW_F32);
    cw_mesh mesh = test_extract(&v, NULL, NULL);
    cw_error err = {0};
    cw_quality q;
    listener l = {0};
    const cw_quality_desc desc = {.shells = true, .threads = 1, .progress = {listen, &l}};
    assert_ok(cw_quality_measure(&mesh, &desc, &q, &err), err);
    const size_t calls = l.calls;
    assert_true(calls > 8);
    for (size_t n = 1; n <= calls; n++) {
        l = (listener){.stop_at = n};
        assert_fails(cw_quality_measure(&mesh, &desc, &q, &err), CW_ERR_CANCELLED,
                     "interrupted while checking", err);
        assert_int_equal(l.calls, n);
        assert_int_equal(q.triangles, 0);
    }
    cw_mesh_free(&mesh);
    cw_volume_free(&v);
}

static void memory_running_out_is_an_error_at_every_allocation(void **state)
{
    (void)state;
    cw_mesh mesh;
    cw_quality q;
    cw_error err = {0};
    test_make_cube(&mesh);
    for (long n = 0;; n++) {
        cwi_alloc_fail_after(n);
        const cw_status st = cw_quality_measure(
            &mesh, &(cw_quality_desc){.weld = CW_WELD_WORLD, .shells = true}, &q, &err);
        if (!cwi_alloc_fail_after(-1)) {
            assert_int_equal(st, CW_OK);
            break;
        }
        assert_int_equal(st, CW_ERR_NO_MEMORY);
    }
    cw_mesh_free(&mesh);
}

/* A cube of a side, its corner at a place, wound outward or inward, added to a mesh. */
static void add_cube(cw_mesh *m, float at, float side, bool inward)
{
    static const uint32_t faces[12][3] = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6},
                                          {0, 1, 4}, {1, 5, 4}, {2, 6, 3}, {3, 6, 7},
                                          {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
    const uint32_t first = (uint32_t)m->vertex_count;
    for (uint32_t v = 0; v < 8; v++)
        for (uint32_t a = 0; a < 3; a++) {
            m->positions[3 * m->vertex_count + a] = at + (v >> a & 1 ? side : 0);
            m->normals[3 * m->vertex_count + a] =
                (inward ? -1.0f : 1.0f) * (v >> a & 1 ? 1 : -1) / sqrtf(3);
            m->vertex_count += a == 2;
        }
    for (size_t t = 0; t < 12; t++, m->triangle_count++)
        for (size_t c = 0; c < 3; c++)
            m->triangles[3 * m->triangle_count + c] = first + faces[t][c && inward ? 3 - c : c];
}

/* A solid, a cavity in it, an island in that, and a cube beside them: each either way. */
static void shells_are_turned_by_where_they_are(void **state)
{
    (void)state;
    for (unsigned inward = 0; inward < 16; inward++) {
        float positions[96], normals[96];
        uint32_t triangles[144];
        cw_mesh m = {.positions = positions, .normals = normals, .triangles = triangles};
        cw_orient_counts counts;
        cw_quality q;
        cw_error err = {0};
        add_cube(&m, 0, 10, inward & 1);
        add_cube(&m, 2, 6, inward & 2);
        add_cube(&m, 3, 4, inward & 4);
        add_cube(&m, 20, 1, inward & 8);
        const size_t wrong = (inward & 1) + !(inward & 2) + (inward >> 2 & 1) + (inward >> 3);
        const cw_quality_desc desc = {.shells = true};
        assert_ok(cw_quality_measure(&m, &desc, &q, &err), err);
        assert_int_equal(q.to_turn, wrong);
        assert_ok(cw_mesh_orient(&m, 1, &counts, &err), err);
        assert_int_equal(counts.turned, wrong);
        assert_int_equal(counts.triangles, 12 * wrong);
        assert_ok(cw_quality_measure(&m, &desc, &q, &err), err);
        assert_true(q.to_turn == 0 && q.cavities == 1);
        assert_near(q.volume_mm3, 1000 - 216 + 64 + 1, 1e-3);
        /* outward normals of the solid, and of the cavity into it */
        assert_true(m.normals[0] < 0 && m.normals[24] > 0);
    }
}

/* Adds a tetrahedron at a corner of the cube from 0 to 10: inside of it or outside, and wound as asked for. */
static void add_tip(cw_mesh *m, uint32_t corner, bool inside, bool inward)
{
    static const uint32_t faces[4][3] = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
    const uint32_t first = (uint32_t)m->vertex_count;
    bool mirrored = inward;
    for (uint32_t a = 0; a < 3; a++) {
        const bool high = corner >> a & 1;
        mirrored ^= high == inside;
        for (uint32_t v = 0; v < 4; v++)
            m->positions[3 * (first + v) + a] =
                (high ? 10.0f : 0) + (high == inside ? -1.0f : 1.0f) * (v == 0       ? 0
                                                                        : v == a + 1 ? 3
                                                                                     : 1);
    }
    m->vertex_count += 4;
    for (size_t t = 0; t < 4; t++, m->triangle_count++)
        for (size_t c = 0; c < 3; c++)
            m->triangles[3 * m->triangle_count + c] =
                first + faces[t][c && mirrored ? 3 - c : c];
}

/* A cube whose corners are also those of cavities in it, and of solids beside it. */
static void shells_that_touch_in_a_vertex_are_told_apart(void **state)
{
    (void)state;
    for (int wrong = 0; wrong < 2; wrong++) {
        float positions[3 * 72], normals[24];
        uint32_t triangles[3 * 76];
        cw_mesh m = {.positions = positions, .normals = normals, .triangles = triangles};
        cw_quality q;
        cw_error err = {0};
        add_cube(&m, 0, 10, wrong);
        m.normals = NULL;
        for (uint32_t corner = 0; corner < 8; corner++) {
            add_tip(&m, corner, true, !wrong);
            add_tip(&m, corner, false, wrong);
        }
        assert_ok(cw_quality_measure(&m, &(cw_quality_desc){.shells = true}, &q, &err), err);
        assert_true(wrong ? q.volume_mm3 < -1000 + 1e-3 : q.volume_mm3 > 1000 - 1e-3);
        assert_int_equal(q.to_turn, wrong ? 17 : 0);
        assert_int_equal(q.cavities, wrong ? 0 : 8);
        assert_int_equal(q.nested, wrong ? 8 : 0);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(shells_are_turned_by_where_they_are),
        cmocka_unit_test(shells_that_touch_in_a_vertex_are_told_apart),
        cmocka_unit_test(a_cube_is_all_it_should_be),
        cmocka_unit_test(a_missing_triangle_opens_three_edges),
        cmocka_unit_test(a_flipped_triangle_misorients_three_edges),
        cmocka_unit_test(a_repeated_triangle_makes_edges_nonmanifold),
        cmocka_unit_test(inside_out_has_a_negative_volume),
        cmocka_unit_test(a_triangle_alone_may_be_there_twice),
        cmocka_unit_test(a_sliver_is_a_cap_or_a_needle),
        cmocka_unit_test(an_open_shell_must_be_nearly_closed_to_face_inward),
        cmocka_unit_test(a_bow_tie_is_found_by_index_or_by_place),
        cmocka_unit_test(zero_area_is_counted_whatever_its_cause),
        cmocka_unit_test(hostile_meshes_are_refused_by_name),
        cmocka_unit_test(a_hub_is_not_quadratic),
        cmocka_unit_test(shapes_are_those_of_school),
        cmocka_unit_test(threads_change_no_bit),
        cmocka_unit_test(it_stops_wherever_it_is_asked_to),
        cmocka_unit_test(memory_running_out_is_an_error_at_every_allocation),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
