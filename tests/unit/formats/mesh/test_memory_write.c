/* Meshes and volumes written to memory and to functions: the bytes of files. */
#include "support/files/reading.h"

/* A receiver that counts, and may fail. */
typedef struct receiver {
    uint64_t announced;
    size_t size, calls, largest;
    size_t fails_at; /* call of write that fails, from 1; 0: none */
    bool fails_first;
} receiver;

static cw_status announce(void *user, uint64_t size, cw_error *err)
{
    receiver *r = user;
    (void)err;
    r->announced = size;
    return r->fails_first ? CW_ERR_CANCELLED : CW_OK;
}

static cw_status receive(void *user, const void *bytes, size_t size, cw_error *err)
{
    receiver *r = user;
    assert_non_null(bytes);
    if (++r->calls == r->fails_at) {
        snprintf(err->message, sizeof err->message, "the client is gone");
        return CW_ERR_OUTPUT;
    }
    r->size += size;
    r->largest = size > r->largest ? size : r->largest;
    return CW_OK;
}

static void compare_bytes(const char *name, const uint8_t *bytes, size_t size)
{
    size_t on_disk;
    char *file = test_file_read(test_path(name), &on_disk);
    if (size != on_disk || memcmp(file, bytes, size) != 0)
        fail_msg("%s: %zu bytes in memory, %zu in the file, or others", name, size, on_disk);
    free(file);
}

static void meshes_in_memory_are_those_of_files(void **state)
{
    (void)state;
    static const char *const names[] = {"m.stl", "m.ply", "m.obj", "m.off",  "m.3mf",
                                        "m.vtp", "m.gii", "m.glb", "m.gltf", "m.drc"};
    cw_mesh mesh;
    test_make_cube(&mesh);
    for (size_t n = 0; n < sizeof names / sizeof *names; n++) {
        cw_error err = {0};
        uint8_t *bytes;
        size_t size;
        cw_mesh again;
        const cw_status st = cw_mesh_write(test_path(names[n]), &mesh, NULL, &err);
        if (st == CW_ERR_UNSUPPORTED)
            continue; /* not in this build */
        assert_ok(st, err);
        assert_ok(cw_mesh_write_memory(names[n], &mesh, NULL, &bytes, &size, &err), err);
        compare_bytes(names[n], bytes, size);
        assert_ok(cw_mesh_read_memory(
                      &(cw_byte_source){.bytes = bytes, .size = size, .name = names[n]}, NULL,
                      &again, NULL, &err),
                  err);
        assert_int_equal(again.triangle_count, 12);
        cw_mesh_free(&again);
        cw_bytes_free(bytes);
    }
    cw_mesh_free(&mesh);
}

static void volumes_in_memory_are_those_of_files(void **state)
{
    (void)state;
    static const char *const names[] = {"v.nrrd", "v.nii", "v.nii.gz", "v.mha"};
    cw_volume v;
    cw_error err = {0};
    assert_ok(cw_volume_alloc(&v, CW_I16, (const size_t[3]){70, 60, 50}, 1, 1, &err), err);
    int16_t *voxels = cw_volume_voxels(&v);
    for (int i = 0; i < 70 * 60 * 50; i++)
        voxels[i] = (int16_t)(i * 7919 % 1000);
    for (size_t n = 0; n < sizeof names / sizeof *names; n++) {
        uint8_t *bytes;
        size_t size;
        cw_volume again;
        const char *format;
        assert_ok(cw_volume_write(test_path(names[n]), &v, NULL, &err), err);
        assert_ok(cw_volume_write_memory(names[n], &v, NULL, &bytes, &size, &err), err);
        compare_bytes(names[n], bytes, size);
        assert_ok(cw_volume_read_memory(&(cw_byte_source){.bytes = bytes, .size = size}, NULL,
                                        &again, &format, &err),
                  err);
        assert_non_null(format);
        assert_memory_equal(again.data, v.data, 70 * 60 * 50 * 2);
        cw_volume_free(&again);
        cw_bytes_free(bytes);
    }
    cw_volume_free(&v);
}

static void names_inside_are_those_asked_for(void **state)
{
    (void)state;
    const cw_write_desc stl = {.format = "stl", .text = true}, named = {.name = "bone"};
    cw_mesh mesh;
    cw_error err = {0};
    uint8_t *bytes;
    size_t size;
    test_make_tetrahedron(&mesh);
    assert_ok(cw_mesh_write_memory(NULL, &mesh, &stl, &bytes, &size, &err), err);
    assert_memory_equal(bytes, "solid mesh ", 11);
    cw_bytes_free(bytes);
    assert_ok(cw_mesh_write_memory("up/bone.obj", &mesh, NULL, &bytes, &size, &err), err);
    bytes[size - 1] = 0;
    assert_non_null(strstr((const char *)bytes, "o bone\n"));
    cw_bytes_free(bytes);
    assert_fails(cw_mesh_write_memory(NULL, &mesh, &named, &bytes, &size, &err),
                 CW_ERR_ARGUMENT, "(memory): its extension is of no mesh format", err);
    assert_null(bytes);
    assert_fails(cw_mesh_write_memory("a.exe", &mesh, NULL, &bytes, &size, &err),
                 CW_ERR_ARGUMENT, "a.exe: its extension is of no mesh format", err);
    cw_mesh_free(&mesh);
}

static void what_needs_more_files_is_refused(void **state)
{
    (void)state;
    cw_mesh mesh;
    cw_error err = {0};
    uint8_t *bytes;
    size_t size;
    test_make_cube(&mesh);
    receiver r = {0};
    const cw_byte_sink sink = {.write = receive, .user = &r};
    const cw_label red = {.value = 1, .has_color = true, .color = {255, 0, 0, 255}};
    const cw_part part = {.mesh = &mesh, .label = &red};
    const cw_write_desc desc = {.sink = &sink};
    assert_fails(cw_parts_write("m.obj", &part, 1, &desc, &err), CW_ERR_UNSUPPORTED,
                 "OBJ keeps materials and pictures in files of their own", err);
    assert_int_equal(r.calls, 0);
    assert_fails(cw_mesh_write_memory(NULL, &mesh, &(cw_write_desc){.format = "neuroglancer"},
                                      &bytes, &size, &err),
                 CW_ERR_UNSUPPORTED,
                 cw_mesh_format(NULL, "neuroglancer")->in_this_build ? "a folder of many files"
                                                                     : "not in this build",
                 err);
    assert_null(bytes);
    assert_int_equal(test_folder_entries(), 0);
    cw_mesh_free(&mesh);
}

/* A grid of n x n squares. */
static void make_grid(cw_mesh *mesh, uint32_t n)
{
    cw_error err = {0};
    *mesh = (cw_mesh){0};
    float *p = cwi_alloc_zeroed((size_t)n * n * 3, sizeof *p);
    uint32_t *t = cwi_alloc_array((size_t)(n - 1) * (n - 1) * 6, sizeof *t);
    assert_true(p && t);
    mesh->positions = p;
    mesh->triangles = t;
    mesh->vertex_count = (size_t)n * n;
    mesh->triangle_count = (size_t)(n - 1) * (n - 1) * 2;
    for (uint32_t y = 0; y < n; y++)
        for (uint32_t x = 0; x < n; x++) {
            *p++ = (float)x;
            *p++ = (float)y;
            *p++ = 0;
        }
    for (uint32_t y = 0; y + 1 < n; y++)
        for (uint32_t x = 0; x + 1 < n; x++, t += 6) {
            const uint32_t a = y * n + x, b = a + 1, c = a + n, d = c + 1;
            memcpy(t, (const uint32_t[6]){a, b, c, b, d, c}, sizeof(uint32_t[6]));
        }
    assert_ok(cw_mesh_check(mesh, &err), err);
}

static void a_sink_gets_all_or_its_own_error(void **state)
{
    (void)state;
    cw_mesh mesh;
    cw_error err = {0};
    make_grid(&mesh, 200); /* as STL 3.9 MB */
    for (int n = 0; n < 2; n++) {
        receiver all = {0}, first = {.fails_first = true}, midway = {.fails_at = 2};
        cw_byte_sink sink = {.begin = announce,
                             .write = receive,
                             .user = &all,
                             .folder = n ? test_path("") : NULL};
        const cw_write_desc desc = {.sink = &sink};
        assert_ok(cw_mesh_write("grid.stl", &mesh, &desc, &err), err);
        assert_int_equal(all.size, 84 + 50 * mesh.triangle_count);
        assert_int_equal(all.announced, all.size);
        assert_true(all.calls == 4 && all.largest == 1 << 20);
        sink.user = &first;
        assert_fails(cw_mesh_write("grid.stl", &mesh, &desc, &err), CW_ERR_CANCELLED,
                     "grid.stl: its sink failed", err);
        assert_int_equal(first.calls, 0);
        sink.user = &midway;
        assert_fails(cw_mesh_write("grid.stl", &mesh, &desc, &err), CW_ERR_OUTPUT,
                     "grid.stl: the client is gone", err);
        assert_int_equal(midway.calls, 2);
        assert_int_equal(test_folder_entries(), 0);
    }
    cw_mesh_free(&mesh);
}

static void limits_and_failing_allocations_leave_nothing(void **state)
{
    (void)state;
    cw_mesh mesh;
    uint8_t *bytes;
    size_t size;
    cw_error err = {0};
    make_grid(&mesh, 200);
    const size_t used = cw_memory_used();
    cw_memory_limit(used + (2 << 20));
    assert_fails(cw_mesh_write_memory("grid.stl", &mesh, NULL, &bytes, &size, &err),
                 CW_ERR_NO_MEMORY, "memory", err);
    cw_memory_limit(0);
    assert_int_equal(cw_memory_used(), used);
    for (long n = 0;; n++) {
        cwi_alloc_fail_after(n);
        const cw_status st = cw_mesh_write_memory("grid.stl", &mesh, NULL, &bytes, &size, &err);
        if (!cwi_alloc_fail_after(-1)) {
            assert_ok(st, err);
            cw_bytes_free(bytes);
            assert_true(n > 3);
            break;
        }
        assert_fails(st, CW_ERR_NO_MEMORY, "no memory", err);
        assert_null(bytes);
    }
    assert_int_equal(cw_memory_used(), used);
    cw_mesh_free(&mesh);
}

static void sinks_without_a_function_are_refused(void **state)
{
    (void)state;
    cw_mesh mesh;
    cw_error err = {0};
    const cw_byte_sink none = {0}, later = {.version = 3, .write = receive};
    test_make_tetrahedron(&mesh);
    assert_fails(cw_mesh_write("a.stl", &mesh, &(cw_write_desc){.sink = &none}, &err),
                 CW_ERR_ARGUMENT, "a.stl: its sink has no function (sink->write)", err);
    assert_fails(cw_mesh_write("a.stl", &mesh, &(cw_write_desc){.sink = &later}, &err),
                 CW_ERR_ARGUMENT, "sink->version is 3", err);
    assert_fails(cw_mesh_write(NULL, &mesh, NULL, &err), CW_ERR_ARGUMENT, "NULL", err);
    cw_mesh_free(&mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(meshes_in_memory_are_those_of_files, test_folder_make,
                                        test_folder_remove),
        cmocka_unit_test_setup_teardown(volumes_in_memory_are_those_of_files, test_folder_make,
                                        test_folder_remove),
        cmocka_unit_test(names_inside_are_those_asked_for),
        cmocka_unit_test_setup_teardown(what_needs_more_files_is_refused, test_folder_make,
                                        test_folder_remove),
        cmocka_unit_test_setup_teardown(a_sink_gets_all_or_its_own_error, test_folder_make,
                                        test_folder_remove),
        cmocka_unit_test(limits_and_failing_allocations_leave_nothing),
        cmocka_unit_test(sinks_without_a_function_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
