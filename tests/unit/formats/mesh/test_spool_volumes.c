/* Components that enclose little leave a spool as they leave a mesh in memory, to the bit. */
#define _GNU_SOURCE /* mkdtemp */
#include "support/surface.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/mesh/mesh.h"

#include <cubewright/spool.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static char folder[] = "/tmp/cubewright-drop-XXXXXX";

static int make_folder(void **state)
{
    (void)state;
    return mkdtemp(folder) ? 0 : -1;
}

static int remove_folder(void **state)
{
    (void)state;
    return rmdir(folder);
}

static uint64_t seed = 11;

static size_t draw_number(size_t below)
{
    seed = seed * 6364136223846793005u + 1442695040888963407u;
    return (size_t)(seed >> 33) % below;
}

static cw_mesh_spool *fill_spool(const cw_mesh *mesh)
{
    cw_mesh_spool *spool;
    cw_error err = {0};
    char path[64];
    strcat(strcpy(path, folder), "/any");
    assert_ok(cw_mesh_spool_new(path, &spool, &err), err);
    const cw_chunk_sink sink = cw_mesh_spool_sink(spool);
    assert_ok(sink.take(sink.user, &(cw_mesh_chunk){.mesh = *mesh}, &err), err);
    return spool;
}

/* A mesh that chunks are appended to. It has room for all. */
typedef struct gathered {
    cw_mesh mesh;
    size_t chunks, left; /* chunks that are still welcome */
} gathered;

static cw_status gather_chunk(void *user, const cw_mesh_chunk *chunk, cw_error *err)
{
    gathered *g = user;
    cw_mesh *all = &g->mesh;
    const cw_mesh *m = &chunk->mesh;
    if (g->left-- == 0)
        return cwi_fail(err, CW_ERR_OUTPUT, "no more chunks");
    assert_int_equal(chunk->first_vertex, all->vertex_count);
    assert_int_equal(chunk->first_triangle, all->triangle_count);
    assert_true(m->vertex_count || m->triangle_count);
    for (size_t n = 0; n < 3 * m->triangle_count; n++)
        assert_true(m->triangles[n] >= chunk->first_vertex);
    assert_true(!m->normals == !all->normals);
    assert_memory_equal(all->origin, m->origin, sizeof all->origin);
    assert_memory_equal(all->affine, m->affine, sizeof all->affine);
    memcpy(all->positions + 3 * all->vertex_count, m->positions, 12 * m->vertex_count);
    if (m->normals)
        memcpy(all->normals + 3 * all->vertex_count, m->normals, 12 * m->vertex_count);
    memcpy(all->triangles + 3 * all->triangle_count, m->triangles, 12 * m->triangle_count);
    all->vertex_count += m->vertex_count;
    all->triangle_count += m->triangle_count;
    g->chunks++;
    return CW_OK;
}

static gathered make_gathered(const cw_mesh *mesh)
{
    gathered g = {.left = SIZE_MAX};
    cw_error err = {0};
    assert_ok(cwi_mesh_alloc(&g.mesh, mesh->vertex_count, mesh->triangle_count,
                             mesh->normals != NULL, &err),
              err);
    g.mesh.vertex_count = g.mesh.triangle_count = 0;
    memcpy(g.mesh.origin, mesh->origin, sizeof mesh->origin);
    memcpy(g.mesh.affine, mesh->affine, sizeof mesh->affine);
    return g;
}

/* Drops components both ways. Returns the counts; the mesh loses what is dropped. */
static cw_drop_counts assert_dropped(cw_mesh *mesh, double least)
{
    cw_mesh_spool *spool = fill_spool(mesh);
    gathered g = make_gathered(mesh);
    cw_drop_counts in_memory, streamed;
    cw_error err = {0};
    assert_ok(cw_mesh_spool_drop_volumes(spool, &(cw_spool_drop_desc){.least_mm3 = least},
                                         (cw_chunk_sink){gather_chunk, &g}, &streamed, &err),
              err);
    assert_ok(cw_mesh_drop_volumes(mesh, least, &in_memory, &err), err);
    test_assert_same_mesh(mesh, &g.mesh);
    if (memcmp(&in_memory, &streamed, sizeof streamed) != 0)
        fail_msg("%zu dropped of %.17g mm3, %zu kept; streamed %zu of %.17g mm3, %zu",
                 in_memory.dropped, in_memory.dropped_mm3, in_memory.kept, streamed.dropped,
                 streamed.dropped_mm3, streamed.kept);
    cw_mesh_free(&g.mesh);
    cw_mesh_spool_free(spool);
    return in_memory;
}

static cw_mesh extract_noise(size_t n, unsigned values, bool open)
{
    cw_volume v;
    cw_error err = {0};
    assert_ok(cw_volume_alloc(&v, CW_U8, (const size_t[3]){n, n + 3, n + 5}, 1, 1, &err), err);
    uint8_t *voxels = cw_volume_voxels(&v);
    for (size_t i = 0; i < n * (n + 3) * (n + 5); i++)
        voxels[i] = (uint8_t)draw_number(values);
    v.affine[0][3] = 1000.25;
    v.affine[1][0] = 0.1;
    cw_mesh mesh = test_extract(
        &v, &(cw_extract_desc){.isovalue = 0.75 * values - 0.5, .leave_open = open}, NULL);
    cw_volume_free(&v);
    return mesh;
}

static void components_of_noise_are_dropped(void **state)
{
    (void)state;
    static const unsigned values[] = {2, 5, 200};
    static const double least[] = {0, 0.01, 0.2, 0.8, 30, 1e9};
    for (size_t n = 0; n < 3; n++)
        for (int open = 0; open < 2; open++)
            for (size_t k = 0; k < 6; k++) {
                cw_mesh mesh = extract_noise(8 + 20 * n, values[n], open);
                const size_t before = mesh.vertex_count;
                const cw_drop_counts c = assert_dropped(&mesh, least[k]);
                assert_true(c.dropped + c.kept > 1);
                if (k == 0)
                    assert_int_equal(mesh.vertex_count, before);
                cw_mesh_free(&mesh);
            }
}

/* Fields whose components are nested, or meet at the end alone. */
static double compute_shells(double x, double y, double z)
{
    return cos(sqrt(x * x + y * y + z * z));
}

static double compute_comb(double x, double y, double z)
{
    return z > 19 - (fabs(x) < 3 ? 4 : 0) ? 1 : sin(1.3 * x) * sin(1.1 * y) - 0.4;
}

static double compute_cavities(double x, double y, double z)
{
    const double ball = 17.3 - sqrt(x * x + y * y + z * z);
    return fmin(ball, 0.6 - sin(x) * sin(y) * sin(z));
}

static void nested_and_late_components_are_dropped(void **state)
{
    (void)state;
    double (*const fields[])(double, double, double) = {compute_shells, compute_comb,
                                                        compute_cavities};
    static const double least[] = {1, 5, 60, 900, 9000};
    const size_t n = 48;
    for (size_t f = 0; f < 3; f++)
        for (size_t k = 0; k < 10; k++) {
            cw_volume v;
            cw_error err = {0};
            assert_ok(cw_volume_alloc(&v, CW_F32, (const size_t[3]){n, n, n}, 1, 1, &err), err);
            float *voxels = cw_volume_voxels(&v);
            for (size_t i = 0; i < n * n * n; i++)
                voxels[i] = (float)fields[f]((double)(i % n) - 23.3, (double)(i / n % n) - 22.7,
                                             (double)(i / n / n) - 23.1);
            cw_mesh mesh = test_extract(
                &v, &(cw_extract_desc){.isovalue = 0.01, .leave_open = k >= 5}, NULL);
            assert_dropped(&mesh, least[k % 5]);
            cw_mesh_free(&mesh);
            cw_volume_free(&v);
        }
}

/* Triangles in any order, some of them twice, without area or missing; so that vertices at both
 * ends and in between are in no triangle. */
static void components_of_any_mesh_are_dropped(void **state)
{
    (void)state;
    for (int round = 0; round < 12; round++) {
        cw_mesh mesh = extract_noise(14 + 4 * (size_t)(round % 5), 9, round % 2);
        const size_t reach = round % 3 ? 1 + draw_number(4000) : mesh.triangle_count;
        for (size_t t = 0; t < mesh.triangle_count; t++) {
            uint32_t *one = mesh.triangles + 3 * t, swap[3];
            const size_t left = mesh.triangle_count - t;
            uint32_t *other = one + 3 * draw_number(reach < left ? reach : left);
            memcpy(swap, one, sizeof swap);
            memcpy(one, other, sizeof swap);
            memcpy(other, swap, sizeof swap);
        }
        for (size_t t = 0; t < mesh.triangle_count; t += 1 + draw_number(40)) {
            uint32_t *c = mesh.triangles + 3 * t;
            if (draw_number(2))
                c[draw_number(3)] = c[draw_number(3)];
            else
                memcpy(c, mesh.triangles + 3 * draw_number(mesh.triangle_count), 3 * sizeof *c);
        }
        const size_t cut = draw_number(mesh.triangle_count / 2);
        mesh.triangle_count -= cut;
        memmove(mesh.triangles, mesh.triangles + 3 * draw_number(cut + 1),
                12 * mesh.triangle_count);
        assert_dropped(&mesh, 0.3);
        cw_mesh_free(&mesh);
    }
}

/* A surface of many components in which each is small: the front is, too. */
static void memory_is_that_of_the_front(void **state)
{
    (void)state;
    cw_mesh mesh = extract_noise(60, 200, false);
    cw_mesh_spool *spool = fill_spool(&mesh);
    cw_error err = {0};
    gathered g = make_gathered(&mesh);
    cw_spool_drop_desc desc = {.least_mm3 = 0.5, .max_bytes = 2 << 20};
    assert_true(mesh.vertex_count > 100000);
    assert_ok(
        cw_mesh_spool_drop_volumes(spool, &desc, (cw_chunk_sink){gather_chunk, &g}, NULL, &err),
        err);
    assert_true(g.chunks > 10);
    for (desc.max_bytes = 1 << 10; desc.max_bytes < 600 << 10; desc.max_bytes *= 4) {
        g.chunks = 0;
        assert_fails(cw_mesh_spool_drop_volumes(spool, &desc, (cw_chunk_sink){gather_chunk, &g},
                                                NULL, &err),
                     CW_ERR_LIMIT, "the limit is", err);
        assert_int_equal(g.chunks, 0);
    }
    cw_mesh_free(&g.mesh);
    cw_mesh_spool_free(spool);
    cw_mesh_free(&mesh);
}

static bool cancel_late(void *user, const char *step, double done)
{
    (void)step;
    return done <= *(double *)user;
}

static void failures_are_told(void **state)
{
    (void)state;
    cw_mesh mesh = extract_noise(30, 200, false);
    cw_mesh_spool *spool = fill_spool(&mesh);
    cw_error err = {0};
    cw_drop_counts counts;
    gathered g = make_gathered(&mesh);
    const cw_chunk_sink sink = {gather_chunk, &g};
    cw_spool_drop_desc desc = {.least_mm3 = 0.5};
    cw_status st = CW_ERR_NO_MEMORY;
    for (long n = 0; st == CW_ERR_NO_MEMORY; n++) {
        g.mesh.vertex_count = g.mesh.triangle_count = 0;
        cwi_alloc_fail_after(n);
        st = cw_mesh_spool_drop_volumes(spool, &desc, sink, &counts, &err);
        cwi_alloc_fail_after(-1);
        assert_true(st == CW_OK || (!counts.kept && !counts.dropped));
        assert_true(st != CW_OK || n > 10);
    }
    assert_ok(st, err);
    for (double until = 0; until < 1; until += 0.3) {
        g.mesh.vertex_count = g.mesh.triangle_count = 0;
        desc.progress = (cw_progress){.report = cancel_late, .user = &until};
        assert_int_equal(cw_mesh_spool_drop_volumes(spool, &desc, sink, NULL, &err),
                         CW_ERR_CANCELLED);
    }
    g.mesh.vertex_count = g.mesh.triangle_count = 0;
    g.left = 1;
    assert_fails(cw_mesh_spool_drop_volumes(spool, NULL, sink, NULL, &err), CW_ERR_OUTPUT,
                 "no more chunks", err);
    desc = (cw_spool_drop_desc){.least_mm3 = NAN};
    assert_fails(cw_mesh_spool_drop_volumes(spool, &desc, sink, NULL, &err), CW_ERR_ARGUMENT,
                 "least_mm3 is", err);
    cw_mesh_spool_free(spool);
    mesh.triangles[700] = (uint32_t)mesh.vertex_count;
    spool = fill_spool(&mesh);
    assert_fails(cw_mesh_spool_drop_volumes(spool, NULL, sink, NULL, &err), CW_ERR_FORMAT,
                 "triangle 233 names vertex", err);
    cw_mesh_spool_free(spool);
    mesh.triangles[700] = 0;
    mesh.positions[30] = INFINITY;
    spool = fill_spool(&mesh);
    assert_fails(cw_mesh_spool_drop_volumes(spool, NULL, sink, NULL, &err), CW_ERR_ARGUMENT,
                 "position of vertex 10", err);
    cw_mesh_spool_free(spool);
    cw_mesh_free(&g.mesh);
    cw_mesh_free(&mesh);
}

static void an_empty_spool_stays_empty(void **state)
{
    (void)state;
    cw_mesh empty = {0};
    const cw_drop_counts c = assert_dropped(&empty, 1);
    assert_int_equal(c.kept + c.dropped, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(components_of_noise_are_dropped),
        cmocka_unit_test(nested_and_late_components_are_dropped),
        cmocka_unit_test(components_of_any_mesh_are_dropped),
        cmocka_unit_test(memory_is_that_of_the_front),
        cmocka_unit_test(failures_are_told),
        cmocka_unit_test(an_empty_spool_stays_empty),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
