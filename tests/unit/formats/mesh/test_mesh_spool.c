/* Surfaces in temporary files: the writers make of them the bytes that they make of a mesh. */
#define _GNU_SOURCE /* mkdtemp */
#include "support/surface.h"

#include "core/base/memory.h"
#include "core/base/module.h"
#include "core/base/status.h"

#include <cubewright/formats.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static char folder[] = "/tmp/cubewright-spool-XXXXXX";

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

static const char *path_of(const char *name)
{
    static char path[2][256];
    static int n;
    n = !n;
    snprintf(path[n], sizeof path[n], "%s/%s", folder, name);
    return path[n];
}

/* Fills a spool with a mesh, in chunks of these sizes. */
static cw_mesh_spool *fill_spool(const cw_mesh *m, size_t vertices, size_t triangles)
{
    cw_mesh_spool *spool;
    cw_error err = {0};
    assert_ok(cw_mesh_spool_new(path_of("any"), &spool, &err), err);
    const cw_chunk_sink sink = cw_mesh_spool_sink(spool);
    for (size_t v = 0, t = 0; v < m->vertex_count || t < m->triangle_count;) {
        cw_mesh_chunk chunk = {.mesh = *m, .first_vertex = v, .first_triangle = t};
        const size_t here = m->vertex_count - v, corners = m->triangle_count - t;
        chunk.mesh.vertex_count = here < vertices ? here : vertices;
        chunk.mesh.triangle_count = corners < triangles ? corners : triangles;
        chunk.mesh.positions += 3 * v;
        if (m->normals)
            chunk.mesh.normals += 3 * v;
        chunk.mesh.triangles += 3 * t;
        assert_ok(sink.take(sink.user, &chunk, &err), err);
        v += chunk.mesh.vertex_count;
        t += chunk.mesh.triangle_count;
    }
    return spool;
}

static void assert_same_file(const cw_mesh *mesh, const cw_mesh_spool *spool, const char *name,
                             const cw_write_desc *desc)
{
    const char *path = path_of(name);
    size_t size[2];
    char *bytes[2];
    cw_error err = {0};
    for (int n = 0; n < 2; n++) {
        const cw_part part = {.mesh = n ? cw_mesh_spool_frame(spool) : mesh,
                              .spool = n ? spool : NULL};
        assert_ok(cw_parts_write(path, &part, 1, desc, &err), err);
        bytes[n] = test_file_read(path, &size[n]);
        unlink(path);
    }
    assert_int_equal(size[0], size[1]);
    assert_memory_equal(bytes[0], bytes[1], size[0]);
    free(bytes[0]);
    free(bytes[1]);
}

static cw_mesh make_mesh(bool normals)
{
    const cw_field_desc desc = {
        .field = CW_FIELD_GYROID, .dim = {60, 50, 40}, .type = CW_F32, .noise = 0.2};
    cw_volume v;
    cw_error err = {0};
    assert_ok(cw_field_sample(&desc, &v, &err), err);
    v.affine[0][3] = 1000.25;
    v.affine[1][0] = 0.1;
    cw_mesh mesh = test_extract(&v, &(cw_extract_desc){.no_normals = !normals}, NULL);
    cw_volume_free(&v);
    assert_in_range(mesh.vertex_count, 20000, 100000);
    return mesh;
}

static void every_format_is_the_same_from_a_spool(void **state)
{
    (void)state;
    static const char *const names[] = {"a.ply", "a.stl", "a.obj",  "a.off",
                                        "a.vtp", "a.glb", "a.gltf", "a.3mf"};
    static const double far[3] = {4e5, -3e5, 1e3};
    for (int n = 0; n < 4; n += test_is_short() ? 3 : 1) {
        cw_mesh mesh = make_mesh(n % 2 == 0);
        if (n >= 2)
            memcpy(mesh.origin, far, sizeof far);
        cw_mesh_spool *spool = fill_spool(&mesh, n ? 1000 : SIZE_MAX, n ? 777 : SIZE_MAX);
        for (size_t f = 0; f < sizeof names / sizeof *names; f++) {
            const bool has_text = f < 4, gltf = f == 5 || f == 6;
            if (gltf && !cwi_module_present("gltf"))
                continue;
            assert_same_file(&mesh, spool, names[f], NULL);
            assert_same_file(&mesh, spool, names[f], &(cw_write_desc){.local = true});
            if (has_text)
                assert_same_file(&mesh, spool, names[f], &(cw_write_desc){.text = true});
            if (!gltf)
                assert_same_file(&mesh, spool, names[f],
                                 &(cw_write_desc){.axes = {.unit = CW_UNIT_CM, .ras = true}});
        }
        cw_mesh_spool_free(spool);
        cw_mesh_free(&mesh);
    }
}

static void a_spool_has_the_frame_and_the_box_of_its_mesh(void **state)
{
    (void)state;
    cw_mesh mesh = make_mesh(true);
    cw_mesh_spool *spool = fill_spool(&mesh, 500, 900);
    const cw_mesh *frame = cw_mesh_spool_frame(spool);
    double min[2][3], max[2][3];
    assert_int_equal(frame->vertex_count, mesh.vertex_count);
    assert_int_equal(frame->triangle_count, mesh.triangle_count);
    assert_null(frame->positions);
    assert_memory_equal(frame->origin, mesh.origin, sizeof mesh.origin);
    assert_true(cw_mesh_bounds(&mesh, min[0], max[0]));
    assert_true(cw_mesh_spool_bounds(spool, min[1], max[1]));
    assert_memory_equal(min[0], min[1], sizeof *min);
    assert_memory_equal(max[0], max[1], sizeof *max);
    cw_mesh_spool_free(spool);
    cw_mesh_free(&mesh);
}

/* The mesh that is read back, and the chunk before. */
typedef struct read_back {
    const cw_mesh *mesh;
    size_t vertices, triangles, chunks;
} read_back;

static cw_status compare_chunk(void *user, const cw_mesh_chunk *chunk, cw_error *err)
{
    (void)err;
    read_back *b = user;
    const cw_mesh *m = &chunk->mesh, *all = b->mesh;
    assert_int_equal(chunk->first_vertex, b->vertices);
    assert_int_equal(chunk->first_triangle, b->triangles);
    assert_memory_equal(m->positions, all->positions + 3 * b->vertices,
                        3 * m->vertex_count * sizeof(float));
    assert_memory_equal(m->normals, all->normals + 3 * b->vertices,
                        3 * m->vertex_count * sizeof(float));
    assert_memory_equal(m->triangles, all->triangles + 3 * b->triangles,
                        3 * m->triangle_count * sizeof(uint32_t));
    for (size_t c = 0; c < 3 * m->triangle_count; c++)
        assert_true(m->triangles[c] >= b->vertices); /* those before are final */
    b->vertices += m->vertex_count;
    b->triangles += m->triangle_count;
    b->chunks++;
    return CW_OK;
}

static void a_spool_is_read_back_in_chunks(void **state)
{
    (void)state;
    cw_mesh mesh = make_mesh(true);
    cw_mesh_spool *spool = fill_spool(&mesh, 700, 1100);
    read_back back = {.mesh = &mesh};
    cw_error err = {0};
    cw_status st = CW_ERR_NO_MEMORY;
    assert_ok(cw_mesh_spool_read(spool, (cw_chunk_sink){compare_chunk, &back}, &err), err);
    assert_int_equal(back.vertices, mesh.vertex_count);
    assert_int_equal(back.triangles, mesh.triangle_count);
    assert_true(back.chunks > 2);
    for (long n = 0; st == CW_ERR_NO_MEMORY; n++) {
        back = (read_back){.mesh = &mesh};
        cwi_alloc_fail_after(n);
        st = cw_mesh_spool_read(spool, (cw_chunk_sink){compare_chunk, &back}, &err);
        cwi_alloc_fail_after(-1);
    }
    assert_ok(st, err);
    cw_mesh_spool_free(spool);
    cw_mesh_free(&mesh);
}

static void what_a_spool_cannot_do_is_refused(void **state)
{
    (void)state;
    cw_mesh mesh = make_mesh(true);
    cw_mesh_spool *spool = fill_spool(&mesh, SIZE_MAX, SIZE_MAX), *none;
    const cw_part part = {.mesh = cw_mesh_spool_frame(spool), .spool = spool};
    cw_error err = {0};
    const cw_chunk_sink sink = cw_mesh_spool_sink(spool);
    const cw_mesh_chunk again = {.mesh = mesh};
    assert_int_equal(sink.take(sink.user, &again, &err), CW_ERR_ARGUMENT);
    assert_int_equal(cw_mesh_spool_new("/no/such/folder/a.ply", &none, &err), CW_ERR_OUTPUT);
    assert_null(none);
    assert_non_null(strstr(err.message, "/no/such/folder"));
    const cw_write_desc packed = {.compression = CW_COMPRESS_DRACO};
    if (cw_parts_write(path_of("a.drc"), &part, 1, NULL, &err) != CW_ERR_UNSUPPORTED ||
        cw_parts_write(path_of("a.glb"), &part, 1, &packed, &err) != CW_ERR_UNSUPPORTED)
        fail();
    cw_status st = CW_ERR_NO_MEMORY;
    for (long n = 0; st == CW_ERR_NO_MEMORY; n++) {
        cwi_alloc_fail_after(n);
        st = cw_parts_write(path_of("a.stl"), &part, 1, NULL, &err);
        cwi_alloc_fail_after(-1);
    }
    assert_ok(st, err);
    unlink(path_of("a.stl"));
    cw_mesh_spool_free(spool);
    cw_mesh_spool_free(NULL);
    cw_mesh_free(&mesh);
}

/* Computes the CRC-32 that ends a fragment. */
static uint32_t sum_bytes(const unsigned char *bytes, size_t size)
{
    uint32_t sum = UINT32_MAX;
    for (size_t n = 0; n < size; n++) {
        sum ^= bytes[n];
        for (int bit = 0; bit < 8; bit++)
            sum = sum >> 1 ^ (sum & 1 ? 0xedb88320u : 0);
    }
    return ~sum;
}

/* Writes a fragment with some of its bytes replaced, and the checksum of what it is then. */
static void write_damaged(const char *path, const char *bytes, size_t size, size_t at,
                          const void *by, size_t by_size)
{
    char *copy = malloc(size);
    assert_true(copy && at + by_size < size);
    memcpy(copy, bytes, size);
    memcpy(copy + at, by, by_size);
    const uint32_t sum = sum_bytes((unsigned char *)copy, size - sizeof sum);
    memcpy(copy + size - sizeof sum, &sum, sizeof sum);
    test_file_write(path, copy, size);
    free(copy);
}

static void fragments_that_do_not_fit_are_refused(void **state)
{
    (void)state;
    enum { ORIGIN_AT = 56, AFFINE_AT = 80, ARRAYS_AT = 192 };
    cw_mesh mesh = make_mesh(true);
    cw_mesh_spool *spool = fill_spool(&mesh, SIZE_MAX, SIZE_MAX), *joined;
    const cw_fragment parts[] = {{.part = 0, .parts = 2}, {.part = 1, .parts = 2}};
    char good[256], bad[256];
    snprintf(good, sizeof good, "%s/a.cwpart", folder);
    snprintf(bad, sizeof bad, "%s/b.cwpart", folder);
    cw_error err = {0};
    size_t size;
    assert_ok(cw_fragment_write(bad, &parts[1], spool, &err), err);
    char *bytes = test_file_read(bad, &size);
    assert_ok(cw_fragment_write(good, &parts[0], spool, &err), err);
    const size_t corners_at = ARRAYS_AT + 2 * 12 * mesh.vertex_count;
    const double infinite = INFINITY, other = mesh.origin[0] + 1;
    const float nan = NAN;
    const uint32_t behind = (uint32_t)mesh.vertex_count, most = UINT32_MAX;
    const struct {
        size_t at;
        const void *by;
        size_t size;
        const char *why;
    } damage[] = {
        {ORIGIN_AT, &infinite, 8, "not finite"},
        {AFFINE_AT + 8 * 11, &infinite, 8, "not finite"},
        {ORIGIN_AT, &other, 8, "not that of the parts before"},
        {AFFINE_AT + 8 * 5, &other, 8, "not that of the parts before"},
        {ARRAYS_AT + 12 * 700 + 4, &nan, 4, "vertex 700 is not finite"},
        {corners_at + 12 * 20000, &behind, 4, "triangle 20000 names vertex"},
        {corners_at + 8, &most, 4, "triangle 0 names vertex 4294967295"},
    };
    for (size_t n = 0; n < sizeof damage / sizeof *damage; n++) {
        write_damaged(bad, bytes, size, damage[n].at, damage[n].by, damage[n].size);
        assert_ok(cw_mesh_spool_new(path_of("any"), &joined, &err), err);
        assert_ok(cw_fragment_append(good, joined, &err), err);
        assert_fails(cw_fragment_append(bad, joined, &err), CW_ERR_FORMAT, damage[n].why, err);
        cw_mesh_spool_free(joined);
    }
    /* A first part may name vertices of the next, which may lack them in the end. */
    const uint32_t far = 2 * behind;
    bytes[16] = 0; /* the number of the part */
    write_damaged(bad, bytes, size, corners_at, &far, sizeof far);
    assert_ok(cw_mesh_spool_new(path_of("any"), &joined, &err), err);
    assert_ok(cw_fragment_append(bad, joined, &err), err);
    assert_ok(cw_fragment_append(good, joined, &err), err);
    const cw_part part = {.mesh = cw_mesh_spool_frame(joined), .spool = joined};
    for (int n = 0; n < 2; n++)
        assert_fails(cw_parts_write(path_of(n ? "a.stl" : "a.ply"), &part, 1, NULL, &err),
                     CW_ERR_FORMAT, "triangle 0 names vertex", err);
    cw_mesh_spool_free(joined);
    cw_mesh_spool_free(spool);
    unlink(good);
    unlink(bad);
    free(bytes);
    cw_mesh_free(&mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_format_is_the_same_from_a_spool),
        cmocka_unit_test(a_spool_has_the_frame_and_the_box_of_its_mesh),
        cmocka_unit_test(a_spool_is_read_back_in_chunks),
        cmocka_unit_test(fragments_that_do_not_fit_are_refused),
        cmocka_unit_test(what_a_spool_cannot_do_is_refused),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
