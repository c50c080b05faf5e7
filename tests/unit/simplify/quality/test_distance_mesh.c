/* Distances from one mesh to another, and the tree of boxes that finds what is near. */
#include "support/surface.h"

#include "core/base/memory.h"
#include "core/geometry/bvh.h"
#include "simplify/quality/mesh_within.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static double uniform(double low, double high)
{
    return low + (high - low) * rand() / RAND_MAX;
}

static cw_mesh make_mesh(size_t vertices, size_t triangles)
{
    cw_mesh mesh = {.vertex_count = vertices, .triangle_count = triangles};
    mesh.positions = calloc(3 * vertices + 1, sizeof *mesh.positions);
    mesh.triangles = calloc(3 * triangles + 1, sizeof *mesh.triangles);
    assert_true(mesh.positions && mesh.triangles);
    return mesh;
}

/* Loose triangles in a cube of 10 mm; some are needles, lines or points. */
static cw_mesh make_soup(size_t count, double size)
{
    cw_mesh mesh = make_mesh(3 * count, count);
    for (size_t t = 0; t < count; t++)
        for (size_t c = 0; c < 3; c++) {
            mesh.triangles[3 * t + c] = (uint32_t)(3 * t + c);
            for (size_t a = 0; a < 3; a++) {
                float *p = mesh.positions + 9 * t;
                p[3 * c + a] =
                    c == 0 ? (float)uniform(0, 10) : p[a] + (float)uniform(-size, size);
                if (c == 2 && t % 7 == 0)
                    p[6 + a] = p[a] + (p[3 + a] - p[a]) * (t % 2 ? 0.25f : 3); /* a line */
                if (c > 0 && t % 31 == 0)
                    p[3 * c + a] = p[a]; /* a point */
            }
        }
    return mesh;
}

/* The nearest point of a triangle by what it means: a pattern search over weights
 * that shrinks. */
static double slow_distance(const float *a, const float *b, const float *c, const double p[3])
{
    double best = INFINITY, u = 1 / 3.0, v = 1 / 3.0;
    for (double step = 0.5; step > 1e-7; step /= 2)
        for (bool better = true; better;) {
            const double from_u = u, from_v = v;
            better = false;
            for (int n = 0; n < 16; n++) {
                const double turn = 2 * PI * n / 16;
                double x = fmax(from_u + step * cos(turn), 0),
                       y = fmax(from_v + step * sin(turn), 0);
                const double over = fmax(x + y, 1);
                double square = 0;
                x /= over;
                y /= over;
                for (int k = 0; k < 3; k++) {
                    const double d =
                        (double)a[k] * (1 - x - y) + x * (double)b[k] + y * (double)c[k] - p[k];
                    square += d * d;
                }
                if (square < best * (1 - 1e-12)) {
                    best = square;
                    u = x;
                    v = y;
                    better = true;
                }
            }
        }
    return sqrt(best);
}

static double slow_mesh_distance(const cw_mesh *m, const double world[3])
{
    double best = INFINITY;
    const double p[3] = {world[0] - m->origin[0], world[1] - m->origin[1],
                         world[2] - m->origin[2]};
    for (size_t t = 0; t < m->triangle_count; t++) {
        const float *a = m->positions + 3 * (size_t)m->triangles[3 * t],
                    *b = m->positions + 3 * (size_t)m->triangles[3 * t + 1],
                    *c = m->positions + 3 * (size_t)m->triangles[3 * t + 2];
        best = fmin(best, slow_distance(a, b, c, p));
    }
    return best;
}

static void vertices_are_as_far_as_a_slow_search_finds(void **state)
{
    (void)state;
    test_seed(3);
    for (int round = 0; round < 3; round++) {
        cw_mesh reference = make_soup(round ? 100 : 3, round == 2 ? 0.2 : 4),
                mesh = make_soup(8, 5);
        cw_distance out;
        cw_error err = {0};
        float found[24];
        mesh.origin[0] = 1e6 - 2; /* each mesh with a zero of its own */
        reference.origin[0] = 1e6;
        assert_ok(cw_distance_to_mesh(&mesh, &reference, NULL, &out, found, &err), err);
        for (size_t v = 0; v < 24; v++) {
            const float *x = mesh.positions + 3 * v;
            const double p[3] = {mesh.origin[0] + (double)x[0], (double)x[1], (double)x[2]};
            assert_near((double)found[v], slow_mesh_distance(&reference, p), 1e-4);
        }
        cw_mesh_free(&mesh);
        cw_mesh_free(&reference);
    }
}

/* Largest distance over a lattice of every triangle: never above the truth, and
 * hardly below. */
static double slow_largest(const cw_mesh *mesh, const cw_mesh *reference, int lattice)
{
    double largest = 0;
    for (size_t t = 0; t < mesh->triangle_count; t++)
        for (int i = 0; i <= lattice; i++)
            for (int j = 0; i + j <= lattice; j++) {
                double p[3];
                for (size_t k = 0; k < 3; k++) {
                    double x[3];
                    for (size_t c = 0; c < 3; c++)
                        x[c] =
                            (double)mesh->positions[3 * (size_t)mesh->triangles[3 * t + c] + k];
                    p[k] = mesh->origin[k] +
                           (x[0] * i + x[1] * j + x[2] * (lattice - i - j)) / lattice;
                }
                largest = fmax(largest, slow_mesh_distance(reference, p));
            }
    return largest;
}

static void the_largest_distance_is_between_its_bounds(void **state)
{
    (void)state;
    test_seed(5);
    for (int round = 0; round < 4; round++) {
        cw_mesh reference = make_soup(12, 3), mesh = make_soup(2, 9);
        cw_distance out;
        cw_error err = {0};
        if (round % 2)
            mesh.origin[1] = reference.origin[1] = 64;
        const cw_mesh_distance_desc desc = {.tolerance_mm = 1e-3, .step_mm = 100};
        assert_ok(cw_distance_to_mesh(&mesh, &reference, &desc, &out, NULL, &err), err);
        const double truth = slow_largest(&mesh, &reference, 20);
        assert_true(out.bound_mm >= out.max_mm && out.bound_mm <= out.max_mm + 1e-3);
        assert_true(truth <= out.bound_mm + 1e-5);
        assert_near(truth, out.max_mm, 0.3);
        assert_near(slow_mesh_distance(&reference, out.where), out.max_mm, 1e-5);
        cw_mesh_free(&mesh);
        cw_mesh_free(&reference);
    }
}

/* Compares the verdict on each triangle of a mesh with the bounds of its largest distance when
 * it is alone. Counts the triangles beyond the limit. */
static size_t verdicts_agree(const cw_mesh *mesh, const cw_mesh *reference, double limit)
{
    const cw_mesh_distance_desc how = {.tolerance_mm = 2e-3 * limit, .step_mm = 100};
    const cw_progress none = {0};
    uint8_t *beyond = calloc(mesh->triangle_count, 1);
    size_t count = 0;
    cw_error err = {0};
    assert_non_null(beyond);
    assert_ok(cwi_mesh_within(mesh, reference, limit, NULL, 1, &none, beyond, &err), err);
    for (size_t t = 0; t < mesh->triangle_count; t++) {
        float positions[9];
        uint32_t corners[3] = {0, 1, 2};
        cw_mesh alone = {.vertex_count = 3, .triangle_count = 1};
        cw_distance d;
        for (size_t k = 0; k < 3; k++)
            memcpy(positions + 3 * k, mesh->positions + 3 * (size_t)mesh->triangles[3 * t + k],
                   3 * sizeof *positions);
        memcpy(alone.origin, mesh->origin, sizeof alone.origin);
        alone.positions = positions;
        alone.triangles = corners;
        assert_ok(cw_distance_to_mesh(&alone, reference, &how, &d, NULL, &err), err);
        if (beyond[t] ? d.bound_mm < limit : d.max_mm > limit)
            fail_msg("triangle %zu: %g to %g mm, but it is %s %g mm", t, d.max_mm, d.bound_mm,
                     beyond[t] ? "beyond" : "within", limit);
        count += beyond[t];
    }
    free(beyond);
    return count;
}

static void what_is_within_is_so_everywhere(void **state)
{
    (void)state;
    const size_t dim = test_is_short() ? 5 : 7;
    test_seed(9);
    cw_mesh soup = make_soup(60, 3), other = make_soup(40, 2);
    soup.origin[1] = 1e6 - 1; /* each mesh with a zero of its own */
    other.origin[1] = 1e6;
    size_t beyond = 0, asked = 0;
    for (double limit = 0.5; limit < 5; limit *= test_is_short() ? 4 : 1.5) {
        beyond += verdicts_agree(&other, &soup, limit);
        asked += other.triangle_count;
    }
    assert_true(beyond > 0 && beyond < asked);
    const cw_field_desc field = {
        .field = CW_FIELD_GYROID, .dim = {dim, dim, dim}, .type = CW_F32, .noise = 0.3};
    cw_volume v;
    cw_error err = {0};
    assert_ok(cw_field_sample(&field, &v, &err), err);
    cw_mesh rough = test_extract(&v, NULL, NULL),
            level = test_extract(&v, &(cw_extract_desc){.isovalue = 0.1f}, NULL);
    for (double limit = test_is_short() ? 1.2 : 0.4; limit < 5; limit *= 3)
        verdicts_agree(&rough, &level, limit);
    cw_mesh_free(&level);
    cw_mesh_free(&rough);
    cw_mesh_free(&other);
    cw_mesh_free(&soup);
    cw_volume_free(&v);
}

static void a_mesh_is_where_itself_is(void **state)
{
    (void)state;
    cw_volume v = test_sample(CW_FIELD_GYROID, 24, CW_F32);
    cw_mesh mesh = test_extract(&v, NULL, NULL);
    cw_distance out;
    cw_error err = {0};
    assert_ok(cw_distance_to_mesh(&mesh, &mesh, NULL, &out, NULL, &err), err);
    assert_true(out.max_mm < 1e-6 && out.p99_mm < 1e-6);
    assert_int_equal(out.triangles, mesh.triangle_count);
    cw_mesh_free(&mesh);
    cw_volume_free(&v);
}

/* Levels of a field of distances are shells around each other. */
static void shells_are_as_far_apart_as_their_levels(void **state)
{
    (void)state;
    cw_volume v = test_sample(CW_FIELD_SPHERE, 40, CW_F32);
    cw_mesh inner = test_extract(&v, &(cw_extract_desc){.isovalue = 1}, NULL),
            outer = test_extract(&v, NULL, NULL);
    cw_error err = {0};
    cw_distance one, two;
    for (int side = 0; side < 2; side++) {
        const cw_mesh *from = side ? &inner : &outer, *to = side ? &outer : &inner;
        assert_ok(cw_distance_to_mesh(from, to, &(cw_mesh_distance_desc){.threads = 1}, &one,
                                      NULL, &err),
                  err);
        assert_near(one.mean_mm, 1, 0.01);
        assert_near(one.rms_mm, 1, 0.01);
        assert_near(one.p99_mm, 1, 0.04);
        assert_near(one.max_mm, 1, 0.05);
        assert_true(one.bound_mm <= one.max_mm * 1.05 + 0.03);
        assert_ok(cw_distance_to_mesh(from, to, &(cw_mesh_distance_desc){.threads = 5}, &two,
                                      NULL, &err),
                  err);
        assert_memory_equal(&one, &two, sizeof one);
    }
    cw_mesh_free(&inner);
    cw_mesh_free(&outer);
    cw_volume_free(&v);
}

static void what_cannot_be_measured_is_refused_by_name(void **state)
{
    (void)state;
    cw_mesh cube, none = {0};
    cw_distance out;
    cw_error err = {0};
    test_make_cube(&cube);
    assert_fails(cw_distance_to_mesh(&cube, &none, NULL, &out, NULL, &err), CW_ERR_ARGUMENT,
                 "the reference has no triangles", err);
    assert_fails(cw_distance_to_mesh(&cube, &cube, &(cw_mesh_distance_desc){.tolerance_mm = -1},
                                     &out, NULL, &err),
                 CW_ERR_ARGUMENT, "tolerance_mm is -1", err);
    assert_fails(cw_distance_to_mesh(&cube, &cube, &(cw_mesh_distance_desc){.step_mm = NAN},
                                     &out, NULL, &err),
                 CW_ERR_ARGUMENT, "step_mm", err);
    assert_ok(cw_distance_to_mesh(&none, &cube, NULL, &out, NULL, &err), err);
    assert_true(out.max_mm == 0 && out.triangles == 0);
    int polls = 0;
    const cw_mesh_distance_desc stop = {.progress = {test_stop_after, &polls}};
    assert_fails(cw_distance_to_mesh(&cube, &cube, &stop, &out, NULL, &err), CW_ERR_CANCELLED,
                 "", err);
    cube.triangles[7] = 8;
    assert_fails(cw_distance_to_mesh(&none, &cube, NULL, &out, NULL, &err), CW_ERR_ARGUMENT,
                 "reference: triangle 2 names vertex 8 of 8", err);
    cw_mesh_free(&cube);
}

static void memory_running_out_is_an_error_at_every_allocation(void **state)
{
    (void)state;
    cw_mesh cube;
    cw_distance out;
    cw_error err = {0};
    test_make_cube(&cube);
    for (long n = 0;; n++) {
        cwi_alloc_fail_after(n);
        const cw_status st = cw_distance_to_mesh(&cube, &cube, NULL, &out, NULL, &err);
        if (!cwi_alloc_fail_after(-1)) {
            assert_int_equal(st, CW_OK);
            break;
        }
        assert_int_equal(st, CW_ERR_NO_MEMORY);
    }
    cw_mesh_free(&cube);
}

/* A hundred thousand triangles in one point have no order to go by. */
static void equal_triangles_do_not_break_the_tree(void **state)
{
    (void)state;
    enum { COUNT = 100000 };
    cw_mesh reference = make_mesh(1, COUNT), cube;
    cw_distance out;
    cw_error err = {0};
    float found[8];
    test_make_cube(&cube);
    assert_ok(cw_distance_to_mesh(&cube, &reference, NULL, &out, found, &err), err);
    for (size_t v = 0; v < 8; v++) {
        const float *p = cube.positions + 3 * v;
        assert_near((double)found[v], hypot(hypot((double)p[0], (double)p[1]), (double)p[2]),
                    1e-6);
    }
    cw_mesh_free(&cube);
    cw_mesh_free(&reference);
}

static void vertices_alone_and_the_worst_around_them_can_be_had(void **state)
{
    (void)state;
    cw_volume volume = test_sample(CW_FIELD_SPHERE, 20, CW_F32);
    cw_mesh mesh = test_extract(&volume, &(cw_extract_desc){.isovalue = 0}, NULL);
    cw_mesh other = test_extract(&volume, &(cw_extract_desc){.isovalue = 2}, NULL);
    cw_distance whole, vertices;
    cw_error err = {0};
    float *at = calloc(mesh.vertex_count, sizeof *at);
    float *worst = calloc(mesh.vertex_count, sizeof *worst);
    assert_true(at && worst);
    const cw_mesh_distance_desc alone = {.vertices_only = true}, all = {.worst = worst};
    assert_ok(cw_distance_to_mesh(&mesh, &other, &alone, &vertices, at, &err), err);
    assert_ok(cw_distance_to_mesh(&mesh, &other, &all, &whole, NULL, &err), err);
    double most = 0, sum = 0, most_around = 0;
    for (size_t v = 0; v < mesh.vertex_count; v++) {
        most = fmax(most, (double)at[v]);
        sum += (double)at[v];
        most_around = fmax(most_around, (double)worst[v]);
        assert_true(worst[v] >= at[v]);
    }
    assert_near(vertices.max_mm, most, 1e-6);
    assert_near(vertices.mean_mm, sum / (double)mesh.vertex_count, 1e-6);
    assert_true(vertices.bound_mm == 0 && vertices.samples == mesh.vertex_count);
    assert_true(most_around <= whole.max_mm + 1e-6 && most_around >= 0.99 * whole.max_mm);
    free(at);
    free(worst);
    cw_mesh_free(&mesh);
    cw_mesh_free(&other);
    cw_volume_free(&volume);
}

/* One-sided, between surfaces of other levels and other samples, both ways. */
static void cgal_finds_the_same_hausdorff_distance(void **state)
{
    (void)state;
    const cw_field fields[] = {CW_FIELD_SPHERE, CW_FIELD_TORUS, CW_FIELD_GYROID};
    if (!cw_quality_has_cgal())
        skip();
    for (size_t f = 0; f < 3; f++) {
        cw_volume fine = test_sample(fields[f], 18, CW_F32),
                  coarse = test_sample(fields[f], 11, CW_F32);
        cw_mesh mesh[2] = {test_extract(&fine, &(cw_extract_desc){.isovalue = 0}, NULL),
                           test_extract(&coarse, &(cw_extract_desc){.isovalue = 0.1}, NULL)};
        for (int way = 0; way < 2; way++) {
            const double tolerance = 0.01;
            cw_distance ours;
            cw_error err = {0};
            double theirs;
            const cw_mesh_distance_desc desc = {.tolerance_mm = tolerance};
            assert_ok(cw_distance_to_mesh(&mesh[way], &mesh[!way], &desc, &ours, NULL, &err),
                      err);
            assert_ok(cw_distance_by_cgal(&mesh[way], &mesh[!way], tolerance, &theirs, &err),
                      err);
            assert_true(ours.bound_mm - ours.max_mm <= tolerance * (1 + 1e-9));
            assert_true(theirs >= ours.max_mm - tolerance - 1e-6);
            assert_true(theirs <= ours.bound_mm + tolerance + 1e-6);
        }
        for (int n = 0; n < 2; n++)
            cw_mesh_free(&mesh[n]);
        cw_volume_free(&fine);
        cw_volume_free(&coarse);
    }
}

/* State of a visit that marks the items that a box overlaps, by slot. */
typedef struct marking {
    const cwi_boxes *tree;
    const float *box;
    bool *marked;
    size_t nodes, first;
} marking;

static bool mark(void *context, size_t node)
{
    marking *m = context;
    const unsigned meeting = cwi_boxes_meeting(&m->tree->nodes[node], m->box);
    assert_true(node >= m->first);
    for (size_t c = 0; c < CWI_WIDTH; c++)
        if (meeting >> c & 1)
            m->marked[node * CWI_WIDTH + c] = true;
    m->nodes++;
    return true;
}

static bool stop(void *context, size_t node)
{
    (void)node;
    ++*(size_t *)context;
    return false;
}

static void a_box_overlaps_what_a_slow_look_finds(void **state)
{
    (void)state;
    enum { MAXIMUM = 3000 };
    static float boxes[MAXIMUM][6];
    static bool marked[MAXIMUM];
    test_seed(9);
    for (size_t count = 0; count < MAXIMUM; count = count * 3 + 1) {
        cwi_boxes tree;
        cw_error err = {0};
        for (size_t n = 0; n < count; n++)
            for (int a = 0; a < 3; a++) {
                boxes[n][a] = (float)(int)uniform(0, 20); /* whole: many touch */
                boxes[n][a + 3] = boxes[n][a] + (float)(int)uniform(0, 4);
            }
        assert_ok(cwi_boxes_build(&tree, (const float(*)[6])boxes, count, &err), err);
        for (size_t q = 0; q < count && q < 50; q++) {
            memset(marked, 0, sizeof marked);
            marking m = {&tree, boxes[q], marked, 0, q % (cwi_boxes_nodes(&tree) + 1)};
            size_t visits = 0;
            cwi_boxes_visit(&tree, boxes[q], m.first, mark, &m);
            cwi_boxes_visit(&tree, boxes[q], m.first, stop, &visits);
            assert_int_equal(visits, m.nodes > 0);
            for (size_t s = 0; s < count; s++) {
                const float *b = boxes[tree.order[s]];
                bool meet = true;
                for (int a = 0; a < 3; a++)
                    meet &= b[a] <= boxes[q][a + 3] && boxes[q][a] <= b[a + 3];
                assert_int_equal(marked[s], meet && s / CWI_WIDTH >= m.first);
            }
        }
        cwi_boxes_free(&tree);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(vertices_are_as_far_as_a_slow_search_finds),
        cmocka_unit_test(the_largest_distance_is_between_its_bounds),
        cmocka_unit_test(what_is_within_is_so_everywhere),
        cmocka_unit_test(a_mesh_is_where_itself_is),
        cmocka_unit_test(shells_are_as_far_apart_as_their_levels),
        cmocka_unit_test(what_cannot_be_measured_is_refused_by_name),
        cmocka_unit_test(memory_running_out_is_an_error_at_every_allocation),
        cmocka_unit_test(equal_triangles_do_not_break_the_tree),
        cmocka_unit_test(vertices_alone_and_the_worst_around_them_can_be_had),
        cmocka_unit_test(cgal_finds_the_same_hausdorff_distance),
        cmocka_unit_test(a_box_overlaps_what_a_slow_look_finds),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
