/* A surface that comes in chunks is measured as the whole mesh is, whatever is wrong with it. */
#include "support/planted.h"
#include "support/surface.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/mesh/weld.h"

#include <cubewright/stream.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

static uint64_t seed = 7;

static size_t draw_number(size_t below)
{
    seed = seed * 6364136223846793005u + 1442695040888963407u;
    return (size_t)(seed >> 33) % below;
}

static uint32_t lowest(const uint32_t *c)
{
    const uint32_t low = c[0] < c[1] ? c[0] : c[1];
    return low < c[2] ? low : c[2];
}

static int compare_lowest(const void *a, const void *b)
{
    const uint32_t s = lowest(a), t = lowest(b);
    return s < t ? -1 : s > t;
}

/* Gives a mesh away in chunks of random sizes, of up to `most` triangles. A chunk's vertices end
 * anywhere before the lowest one that later triangles name. */
static cw_status feed(const cw_mesh *mesh, size_t most, cw_chunk_sink sink, cw_error *err)
{
    const size_t vertices = mesh->vertex_count, triangles = mesh->triangle_count;
    uint32_t *low =
        malloc((triangles + 1) * sizeof *low); /* of a triangle and all later ones */
    cw_status st = CW_OK;
    assert_non_null(low);
    low[triangles] = (uint32_t)vertices;
    for (size_t t = triangles; t-- > 0;) {
        const uint32_t own = lowest(mesh->triangles + 3 * t);
        low[t] = own < low[t + 1] ? own : low[t + 1];
    }
    size_t v = 0;
    for (size_t t = 0; st == CW_OK && (t < triangles || v < vertices);) {
        const size_t left = triangles - t, wanted = draw_number(most + 1);
        const size_t count = wanted < left ? wanted : left, end = t + count;
        const size_t final = low[end] - v;
        const size_t named =
            end == triangles || draw_number(3) ? final : draw_number(final + 1);
        cw_mesh_chunk chunk = {.mesh = *mesh, .first_vertex = v, .first_triangle = t};
        chunk.mesh.positions += 3 * v;
        chunk.mesh.triangles += 3 * t;
        chunk.mesh.vertex_count = named;
        chunk.mesh.triangle_count = count;
        st = sink.take(sink.user, &chunk, err);
        v += named;
        t = end;
    }
    free(low);
    return st;
}

static cw_quality measure_stream(const cw_mesh *mesh, size_t most, int threads)
{
    cw_quality_stream *stream;
    cw_quality q;
    cw_error err = {0};
    const cw_quality_stream_desc desc = {.threads = threads};
    assert_ok(cw_quality_stream_new(&desc, &stream, &err), err);
    assert_ok(feed(mesh, most, cw_quality_stream_sink(stream), &err), err);
    assert_ok(cw_quality_stream_finish(stream, &q, &err), err);
    cw_quality_stream_free(stream);
    return q;
}

#define ASSERT_SAME(field)                                                                     \
    if (a->field != b->field)                                                                  \
    fail_msg("%s: %s is %lld, not %lld", name, #field, (long long)b->field, (long long)a->field)

static void assert_same_quality(const char *name, const cw_quality *a, const cw_quality *b)
{
    cw_quality same = *a;
    ASSERT_SAME(vertices);
    ASSERT_SAME(triangles);
    ASSERT_SAME(edges);
    ASSERT_SAME(components);
    ASSERT_SAME(unused_vertices);
    ASSERT_SAME(open_edges);
    ASSERT_SAME(border_loops);
    ASSERT_SAME(nonmanifold_edges);
    ASSERT_SAME(misoriented_edges);
    ASSERT_SAME(nonmanifold_vertices);
    ASSERT_SAME(duplicates);
    ASSERT_SAME(degenerate);
    ASSERT_SAME(needles);
    ASSERT_SAME(caps);
    ASSERT_SAME(euler);
    ASSERT_SAME(genus);
    memset(same.shapes.lengths, 0, sizeof same.shapes.lengths);
    assert_memory_equal(&same, b, sizeof same); /* area, volume, box and shapes: to the bit */
}

/* The same for chunks of any size. */
static cw_quality assert_measured(const char *name, cw_mesh *mesh)
{
    const size_t sizes[] = {1, 3, 40, 700, mesh->triangle_count + 1};
    cw_quality whole;
    cw_error err = {0};
    assert_ok(cw_quality_measure(mesh, NULL, &whole, &err), err);
    for (size_t n = 0; n < sizeof sizes / sizeof *sizes; n++) {
        const cw_quality q = measure_stream(mesh, sizes[n], 1 + (int)(n % 2));
        assert_same_quality(name, &whole, &q);
    }
    return whole;
}

/* Triangles in an order in which vertices become final one by one. */
static void sort_triangles(cw_mesh *mesh)
{
    qsort(mesh->triangles, mesh->triangle_count, 3 * sizeof *mesh->triangles, compare_lowest);
}

static cw_volume make_noise(size_t n, unsigned values)
{
    cw_volume v;
    cw_error err = {0};
    assert_ok(cw_volume_alloc(&v, CW_U8, (const size_t[3]){n, n + 3, n + 5}, 1, 1, &err), err);
    uint8_t *voxels = cw_volume_voxels(&v);
    for (size_t i = 0; i < n * (n + 3) * (n + 5); i++)
        voxels[i] = (uint8_t)draw_number(values);
    return v;
}

static void surfaces_are_measured_in_chunks(void **state)
{
    (void)state;
    static const unsigned values[] = {2, 3, 9, 200};
    for (size_t n = 0; n < 4; n++)
        for (int open = 0; open < 2; open++) {
            cw_volume v = make_noise(9 + 5 * n, values[n]);
            cw_mesh mesh = test_extract(
                &v, &(cw_extract_desc){.isovalue = 0.6 * values[n] - 0.5, .leave_open = open},
                NULL);
            const cw_quality q = assert_measured("noise", &mesh);
            assert_true(q.components > 1 && q.degenerate == 0);
            assert_int_equal(q.border_loops > 0, open);
            cw_mesh_free(&mesh);
            cw_volume_free(&v);
        }
}

/* A ball inside a hollow ball, beside others: a function of the distance from three points. */
static void nested_shells_are_measured(void **state)
{
    (void)state;
    const size_t n = 40;
    cw_volume v;
    cw_error err = {0};
    assert_ok(cw_volume_alloc(&v, CW_F32, (const size_t[3]){n, n, n}, 1, 1, &err), err);
    float *voxels = cw_volume_voxels(&v);
    for (size_t i = 0; i < n * n * n; i++) {
        const double x = (double)(i % n) - 19.3, y = (double)(i / n % n) - 18.7,
                     z = (double)(i / n / n) - 19.1;
        const double r = sqrt(x * x + y * y + z * z);
        voxels[i] = (float)cos(r); /* shells at each odd multiple of pi / 2 */
    }
    cw_mesh mesh = test_extract(&v, &(cw_extract_desc){.isovalue = 0.01}, NULL);
    const cw_quality q = assert_measured("shells", &mesh);
    assert_true(q.components >= 5 && q.euler >= 10);
    assert_true(cw_quality_is_closed_manifold(&q));
    cw_mesh_free(&mesh);
    cw_volume_free(&v);
}

static void planted_faults_are_found(void **state)
{
    (void)state;
    for (size_t n = 0; n < test_planted_count; n++) {
        cw_mesh mesh = test_plant(&test_planted_meshes[n]);
        sort_triangles(&mesh);
        assert_measured(test_planted_meshes[n].name, &mesh);
        uint32_t *map = malloc((mesh.vertex_count + 1) * sizeof *map);
        assert_true(map && cwi_weld(mesh.positions, mesh.vertex_count, map));
        for (size_t i = 0; i < 3 * mesh.triangle_count; i++)
            mesh.triangles[i] = map[mesh.triangles[i]];
        sort_triangles(&mesh);
        assert_measured(test_planted_meshes[n].name, &mesh);
        free(map);
        cw_mesh_free(&mesh);
    }
}

/* Damages one triangle of many: turned, repeated, missing, at another vertex, without area. */
static void damage(cw_mesh *mesh, size_t faults)
{
    for (size_t n = 0; n < faults; n++) {
        uint32_t *c = mesh->triangles + 3 * draw_number(mesh->triangle_count), swap = c[0];
        const uint32_t *other = mesh->triangles + 3 * draw_number(mesh->triangle_count);
        switch (draw_number(6)) {
        case 0:
            c[0] = c[1];
            c[1] = swap;
            break;
        case 1:
            memcpy(c, other, 3 * sizeof *c);
            break;
        case 2:
            memcpy(c, mesh->triangles + 3 * --mesh->triangle_count, 3 * sizeof *c);
            break;
        case 3:
            c[draw_number(3)] = (uint32_t)draw_number(mesh->vertex_count);
            break;
        case 4:
            c[draw_number(3)] = other[draw_number(3)];
            break;
        default:
            c[0] = c[1];
            break;
        }
    }
}

static void damaged_surfaces_are_measured(void **state)
{
    (void)state;
    cw_quality sum = {0};
    for (size_t n = 0; n < 12; n++) {
        cw_volume v = make_noise(6 + n, 3 + (unsigned)n);
        cw_mesh mesh = test_extract(
            &v, &(cw_extract_desc){.isovalue = 2, .leave_open = n % 2, .no_normals = true},
            NULL);
        damage(&mesh, 1 + draw_number(mesh.triangle_count / (n % 3 ? 10 : 2)));
        sort_triangles(&mesh);
        const cw_quality q = assert_measured("damaged", &mesh);
        sum.unused_vertices += q.unused_vertices;
        sum.nonmanifold_edges += q.nonmanifold_edges;
        sum.misoriented_edges += q.misoriented_edges;
        sum.nonmanifold_vertices += q.nonmanifold_vertices;
        sum.duplicates += q.duplicates;
        sum.degenerate += q.degenerate;
        cw_mesh_free(&mesh);
        cw_volume_free(&v);
    }
    assert_true(sum.unused_vertices && sum.nonmanifold_edges && sum.misoriented_edges &&
                sum.nonmanifold_vertices && sum.duplicates && sum.degenerate);
}

/* A vertex with as many triangles as the mesh has, none of which is final before the end. */
static void a_hub_is_measured(void **state)
{
    (void)state;
    for (int last = 0; last < 2; last++) {
        enum { RIM = 3000 };
        float *positions = calloc(3 * (RIM + 1), sizeof *positions);
        uint32_t *triangles = calloc(3 * RIM, sizeof *triangles);
        assert_true(positions && triangles);
        const uint32_t hub = last ? RIM : 0;
        for (uint32_t i = 0; i < RIM; i++) {
            const uint32_t v = i + !last, next = (i + 1) % RIM + !last;
            positions[3 * v] = (float)cos(2e-3 * i);
            positions[3 * v + 1] = (float)sin(2e-3 * i);
            memcpy(triangles + 3 * i, (uint32_t[3]){hub, v, next}, 3 * sizeof *triangles);
        }
        cw_mesh mesh = {.positions = positions,
                        .triangles = triangles,
                        .vertex_count = RIM + 1,
                        .triangle_count = RIM};
        const cw_quality q = assert_measured("hub", &mesh);
        assert_int_equal(q.border_loops, 1);
        assert_int_equal(q.euler, 1);
        free(positions);
        free(triangles);
    }
}

/* A tall surface takes no more memory than a low one of the same width. */
static void memory_is_that_of_the_front(void **state)
{
    (void)state;
    size_t most[2] = {0, 0};
    for (int tall = 0; tall < 2; tall++) {
        const size_t length = tall ? 40000 : 4000, width = 50;
        cw_error err = {0};
        cw_quality_stream *stream;
        cw_quality q;
        assert_ok(cw_quality_stream_new(NULL, &stream, &err), err);
        const cw_chunk_sink sink = cw_quality_stream_sink(stream);
        for (size_t row = 0; row < length; row++) {
            float positions[3 * 50];
            uint32_t triangles[6 * 49];
            for (size_t i = 0; i < width; i++)
                memcpy(positions + 3 * i, (float[3]){(float)i, (float)row, 0},
                       3 * sizeof(float));
            for (uint32_t i = 0; i < 49; i++) {
                const uint32_t v = (uint32_t)(row * width) + i, up = v + (uint32_t)width;
                memcpy(triangles + 6 * i, (uint32_t[6]){v, v + 1, up, v + 1, up + 1, up},
                       6 * sizeof *triangles);
            }
            const bool end = row + 1 == length;
            const cw_mesh_chunk chunk = {.mesh = {.positions = positions,
                                                  .triangles = triangles,
                                                  .vertex_count = width,
                                                  .triangle_count = end ? 0 : 98},
                                         .first_vertex = row * width,
                                         .first_triangle = row * 98};
            assert_ok(sink.take(sink.user, &chunk, &err), err);
            const size_t bytes = cw_quality_stream_bytes(stream);
            most[tall] = bytes > most[tall] ? bytes : most[tall];
        }
        assert_ok(cw_quality_stream_finish(stream, &q, &err), err);
        assert_int_equal(q.border_loops, 1);
        assert_int_equal(q.components, 1);
        assert_int_equal(q.euler, 1);
        assert_near(q.area_mm2, 49.0 * (double)(length - 1), 1e-6);
        cw_quality_stream_free(stream);
    }
    assert_int_equal(most[0], most[1]);
    assert_true(most[0] < 400000);
}

/* More vertices become final at once than are measured in one step. */
static void a_large_front_is_settled_in_steps(void **state)
{
    (void)state;
    cw_volume v = make_noise(40, 200);
    cw_mesh mesh =
        test_extract(&v, &(cw_extract_desc){.isovalue = 99.5, .leave_open = true}, NULL);
    cw_quality whole;
    cw_error err = {0};
    assert_true(mesh.vertex_count > 100000);
    assert_ok(cw_quality_measure(&mesh, NULL, &whole, &err), err);
    for (int threads = 1; threads < 3; threads++) {
        const cw_quality one = measure_stream(&mesh, mesh.triangle_count, threads),
                         many = measure_stream(&mesh, 50000, threads);
        assert_same_quality("one chunk", &whole, &one);
        assert_same_quality("large chunks", &whole, &many);
    }
    cw_mesh_free(&mesh);
    cw_volume_free(&v);
}

static void expect_refused(const cw_mesh_chunk *chunk, const char *message)
{
    cw_quality_stream *stream;
    cw_quality q;
    cw_error err = {0};
    assert_ok(cw_quality_stream_new(NULL, &stream, &err), err);
    const cw_chunk_sink sink = cw_quality_stream_sink(stream);
    cw_status st = sink.take(sink.user, chunk, &err);
    if (st == CW_OK) /* what only the end tells */
        st = cw_quality_stream_finish(stream, &q, &err);
    else
        assert_int_equal(cw_quality_stream_finish(stream, &q, NULL), st);
    assert_int_equal(st, CW_ERR_ARGUMENT);
    if (!strstr(err.message, message))
        fail_msg("'%s' does not say '%s'", err.message, message);
    cw_quality_stream_free(stream);
}

static void chunks_that_do_not_follow_are_refused(void **state)
{
    (void)state;
    float positions[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    uint32_t triangle[3] = {0, 1, 2};
    const cw_mesh_chunk good = {.mesh = {.positions = positions,
                                         .triangles = triangle,
                                         .vertex_count = 3,
                                         .triangle_count = 1}};
    cw_mesh_chunk bad = good;
    bad.first_vertex = 1;
    expect_refused(&bad, "a chunk from vertex 1 and triangle 0 on, where 0 and 0 follow");
    bad = good;
    bad.mesh.vertex_count = 2;
    expect_refused(&bad, "triangle 0 names vertex 2 of 2");
    bad = good;
    bad.mesh.positions = NULL;
    expect_refused(&bad, "needs positions");
    positions[4] = NAN;
    expect_refused(&good, "the position of vertex 1 is not finite");
    positions[4] = 0;

    cw_quality_stream *stream;
    cw_quality q;
    cw_error err = {0};
    assert_ok(cw_quality_stream_new(NULL, &stream, &err), err);
    const cw_chunk_sink sink = cw_quality_stream_sink(stream);
    assert_ok(sink.take(sink.user, &good, &err), err);
    bad = good;
    bad.first_vertex = 3;
    bad.first_triangle = 1;
    assert_int_equal(sink.take(sink.user, &bad, &err), CW_ERR_ARGUMENT);
    assert_non_null(strstr(err.message, "triangle 1 names vertex 0; its chunk begins with"));
    assert_int_equal(sink.take(sink.user, &bad, &err), CW_ERR_ARGUMENT);
    assert_int_equal(cw_quality_stream_finish(stream, &q, &err), CW_ERR_ARGUMENT);
    cw_quality_stream_free(stream);
    cw_quality_stream_free(NULL);

    assert_ok(cw_quality_stream_new(NULL, &stream, &err), err);
    assert_ok(cw_quality_stream_finish(stream, &q, &err), err);
    const cw_mesh empty = {0};
    const cw_quality none = test_measure(&empty);
    assert_memory_equal(&q, &none, sizeof q);
    assert_int_equal(cw_quality_stream_finish(stream, &q, &err), CW_ERR_ARGUMENT);
    cw_quality_stream_free(stream);
}

static void a_front_above_its_limit_is_refused(void **state)
{
    (void)state;
    cw_volume v = make_noise(20, 9);
    cw_mesh mesh = test_extract(&v, &(cw_extract_desc){.isovalue = 4}, NULL);
    cw_quality_stream *stream;
    cw_error err = {0};
    assert_ok(
        cw_quality_stream_new(&(cw_quality_stream_desc){.max_bytes = 50000}, &stream, &err),
        err);
    assert_int_equal(feed(&mesh, 100, cw_quality_stream_sink(stream), &err), CW_ERR_LIMIT);
    assert_non_null(strstr(err.message, "checking the surface's front needs"));
    cw_quality_stream_free(stream);
    cw_mesh_free(&mesh);
    cw_volume_free(&v);
}

static void memory_running_out_is_an_error_at_every_allocation(void **state)
{
    (void)state;
    cw_volume v = make_noise(8, 3);
    cw_mesh mesh =
        test_extract(&v, &(cw_extract_desc){.isovalue = 1, .leave_open = true}, NULL);
    damage(&mesh, 20);
    for (int i = 0; i < 300; i++) /* a hub of its own memory */
        mesh.triangles[3 * draw_number(mesh.triangle_count)] = (uint32_t)mesh.vertex_count - 1;
    sort_triangles(&mesh);
    const cw_quality_stream_desc desc = {.threads = 1};
    for (long n = 0;; n++) {
        cw_quality_stream *stream;
        cw_quality q;
        cwi_alloc_fail_after(n);
        cw_status st = cw_quality_stream_new(&desc, &stream, NULL);
        if (st == CW_OK)
            st = feed(&mesh, 300, cw_quality_stream_sink(stream), NULL);
        if (st == CW_OK)
            st = cw_quality_stream_finish(stream, &q, NULL);
        const bool failed = cwi_alloc_fail_after(-1);
        cw_quality_stream_free(stream);
        assert_int_equal(st, failed ? CW_ERR_NO_MEMORY : CW_OK);
        if (!failed)
            break;
    }
    cw_mesh_free(&mesh);
    cw_volume_free(&v);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(surfaces_are_measured_in_chunks),
        cmocka_unit_test(nested_shells_are_measured),
        cmocka_unit_test(planted_faults_are_found),
        cmocka_unit_test(damaged_surfaces_are_measured),
        cmocka_unit_test(a_hub_is_measured),
        cmocka_unit_test(memory_is_that_of_the_front),
        cmocka_unit_test(a_large_front_is_settled_in_steps),
        cmocka_unit_test(chunks_that_do_not_follow_are_refused),
        cmocka_unit_test(a_front_above_its_limit_is_refused),
        cmocka_unit_test(memory_running_out_is_an_error_at_every_allocation),
    };
    seed = test_seed(7);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
