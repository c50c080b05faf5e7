/* Files without a path: what their sources may give, and what they may not. */
#include "support/files/reading.h"

static const char small_nrrd[] = "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 2 2 2\n"
                                 "encoding: raw\n\n12345678";
enum { SMALL = sizeof small_nrrd - 1 };

/* A source that gives its bytes in pieces. */
typedef struct giver {
    const char *bytes;
    size_t size, piece, given;
    size_t fails_at; /* number of bytes before it fails; 0: never */
    const char *message;
} giver;

static cw_status give(void *user, void *to, size_t capacity, size_t *got, cw_error *err)
{
    giver *g = user;
    size_t count = g->size - g->given;
    if (g->fails_at && g->given >= g->fails_at) {
        if (g->message)
            snprintf(err->message, sizeof err->message, "%s", g->message);
        return CW_ERR_CANCELLED;
    }
    count = count < g->piece ? count : g->piece;
    count = count < capacity ? count : capacity;
    memcpy(to, g->bytes + g->given, count);
    g->given += count;
    *got = count;
    return CW_OK;
}

static cw_status read_given(giver *g, cw_byte_source source, cw_volume *volume, cw_error *err)
{
    source.read = give;
    source.user = g;
    return cw_volume_read_memory(&source, NULL, volume, NULL, err);
}

static void any_pieces_make_the_same_volume(void **state)
{
    (void)state;
    for (size_t piece = 1; piece <= SMALL + 1; piece += 7)
        for (uint64_t size = 0; size <= SMALL; size += SMALL) {
            giver g = {.bytes = small_nrrd, .size = SMALL, .piece = piece};
            cw_volume v;
            cw_error err = {0};
            assert_ok(read_given(&g, (cw_byte_source){.size = size}, &v, &err), err);
            assert_memory_equal(v.data, "12345678", 8);
            cw_volume_free(&v);
        }
}

static void a_size_that_does_not_come_true_names_both_numbers(void **state)
{
    (void)state;
    giver few = {.bytes = small_nrrd, .size = SMALL, .piece = 10}, many = few;
    char words[80];
    cw_volume v;
    cw_error err = {0};
    snprintf(words, sizeof words, "scan.nrrd: its source gave %d bytes; source->size is 5000",
             SMALL);
    assert_fails(
        read_given(&few, (cw_byte_source){.size = 5000, .name = "scan.nrrd"}, &v, &err),
        CW_ERR_IO, words, err);
    assert_fails(read_given(&many, (cw_byte_source){.size = 20}, &v, &err), CW_ERR_IO,
                 "(stream): its source gave at least 21 bytes; source->size is 20", err);
    assert_null(v.data);
}

static void a_failing_source_is_the_error(void **state)
{
    (void)state;
    giver told = {.bytes = small_nrrd,
                  .size = SMALL,
                  .piece = 8,
                  .fails_at = 16,
                  .message = "the connection is gone"},
          untold = {.bytes = small_nrrd, .size = SMALL, .piece = 8, .fails_at = 16};
    cw_volume v;
    cw_error err = {0};
    assert_fails(read_given(&told, (cw_byte_source){0}, &v, &err), CW_ERR_CANCELLED,
                 "(stream): the connection is gone", err);
    assert_fails(read_given(&untold, (cw_byte_source){0}, &v, &err), CW_ERR_CANCELLED,
                 "(stream): its source failed", err);
}

static cw_status overstate(void *user, void *to, size_t capacity, size_t *got, cw_error *err)
{
    (void)user, (void)to, (void)err;
    *got = capacity + 1;
    return CW_OK;
}

static void sources_that_break_the_rules_are_refused(void **state)
{
    (void)state;
    cw_stored_file *file;
    cw_error err = {0};
    assert_fails(cw_stored_file_open(&(cw_byte_source){.read = overstate}, &file, &err),
                 CW_ERR_ARGUMENT, "there is room for 1048576", err);
    assert_null(file);
    assert_fails(cw_stored_file_open(&(cw_byte_source){0}, &file, &err), CW_ERR_ARGUMENT,
                 "neither is set", err);
    assert_fails(
        cw_stored_file_open(&(cw_byte_source){.bytes = "a", .size = 1, .read = overstate},
                            &file, &err),
        CW_ERR_ARGUMENT, "both are set", err);
    assert_fails(cw_stored_file_open(&(cw_byte_source){.bytes = "a"}, &file, &err), CW_ERR_IO,
                 "(memory): the file is empty", err);
    assert_fails(cw_stored_file_open(&(cw_byte_source){.bytes = "a", .size = 1, .version = 9},
                                     &file, &err),
                 CW_ERR_ARGUMENT, "source->version is 9", err);
    assert_fails(
        cw_stored_file_open(&(cw_byte_source){.bytes = "a", .size = 1, .folder = "/none/there"},
                            &file, &err),
        CW_ERR_OUTPUT, "no temporary file in '/none/there'", err);
    assert_int_equal(cw_stored_file_size(NULL), 0);
    cw_stored_file_close(NULL);
}

static void limits_hold(void **state)
{
    (void)state;
    static const char bytes[3 << 20];
    giver g = {.bytes = bytes, .size = sizeof bytes, .piece = sizeof bytes};
    cw_stored_file *file;
    cw_error err = {0};
    assert_fails(
        cw_stored_file_open(&(cw_byte_source){.read = give, .user = &g, .max_bytes = 1000},
                            &file, &err),
        CW_ERR_LIMIT, "more than 1000 bytes (source->max_bytes)", err);
    const size_t used = cw_memory_used();
    cw_memory_limit(used + (2 << 20));
    assert_fails(cw_stored_file_open(&(cw_byte_source){.bytes = bytes, .size = sizeof bytes},
                                     &file, &err),
                 CW_ERR_NO_MEMORY, "(memory): ", err);
    const cw_byte_source on_disk = {
        .bytes = bytes, .size = sizeof bytes, .folder = test_path("")};
    assert_ok(cw_stored_file_open(&on_disk, &file, &err), err);
    cw_memory_limit(0);
    assert_int_equal(cw_stored_file_size(file), sizeof bytes);
    assert_int_equal(test_folder_entries(), 0);
    cw_stored_file_close(file);
    assert_int_equal(cw_memory_used(), used);
}

static cw_status count_slices(void *user, const cw_slice_source *source, cw_error *err)
{
    char slice[4];
    cw_status st = source->read(source->user, 1, 1, slice, err);
    *(size_t *)user = source->shape.dim[2];
    return st == CW_OK && memcmp(slice, "5678", 4) == 0 ? CW_OK : CW_ERR_IO;
}

static void stored_files_are_read_again_and_again(void **state)
{
    (void)state;
    const cw_byte_source source = {.bytes = small_nrrd, .size = SMALL, .folder = test_path("")};
    const cw_read_desc none = {0};
    cw_stored_file *file;
    cw_error err = {0};
    assert_ok(cw_stored_file_open(&source, &file, &err), err);
    const cw_read_desc desc = {.stored = file};
    for (int n = 0; n < 3; n++) {
        cw_volume v;
        cw_array *arrays;
        cw_level *levels;
        cw_series *series;
        char **steps;
        size_t count;
        assert_ok(cw_volume_read(n ? NULL : "scan", &desc, &v, NULL, &err), err);
        cw_volume_free(&v);
        assert_ok(cw_arrays_list(NULL, &desc, &arrays, &count, &err), err);
        assert_int_equal(count, 0);
        assert_ok(cw_levels_list(NULL, &desc, &levels, &count, &err), err);
        assert_int_equal(count, 0);
        assert_ok(cw_series_list(NULL, &desc, &series, &count, &err), err);
        assert_int_equal(count, 0);
        assert_ok(cw_steps_list((const char *[]){"x*"}, 1, &desc, &steps, &count, &err), err);
        assert_int_equal(count, 0);
    }
    cw_stored_file_close(file);
    cw_volume v;
    assert_fails(cw_volume_read(NULL, &none, &v, NULL, &err), CW_ERR_ARGUMENT, "'path' is NULL",
                 err);
}

static void files_that_are_missing_are_named(void **state)
{
    (void)state;
    static const struct {
        const char *name, *text, *words;
    } cases[] = {
        {NULL,
         "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 2 2 2\nencoding: raw\n"
         "data file: head.raw\n\n",
         "(memory): head.raw: this file is missing: data without a path"},
        {"head.mhd",
         "NDims = 3\nDimSize = 2 2 2\nElementType = MET_UCHAR\nElementDataFile = head.raw\n",
         "head.mhd: head.raw: this file is missing"},
        {"store/.zarray", "{\"zarr_format\": 2}",
         "store/.zarray: this is one of the many files of a folder "
         "(zarr): the others are missing"},
        {"run.pvd",
         "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\"><Collection>"
         "<DataSet timestep=\"0\" file=\"a.vti\"/></Collection></VTKFile>",
         "run.pvd: this is a list of the files of a time series (pvd)"},
        {"m.gltf", "{}", "m.gltf: this is a mesh (gltf), not a volume"},
        {"m.exe", "nothing that is known", "m.exe: neither content nor extension"},
    };
    for (size_t n = 0; n < sizeof cases / sizeof *cases; n++) {
        cw_volume v;
        cw_error err = {0};
        const cw_byte_source source = {
            .name = cases[n].name, .bytes = cases[n].text, .size = strlen(cases[n].text)};
        const cw_status st = cw_volume_read_memory(&source, NULL, &v, NULL, &err);
        if (st == CW_OK || !strstr(err.message, cases[n].words))
            fail_msg("case %zu: %s; not: %s", n, err.message, cases[n].words);
        assert_true(st ==
                    (strstr(cases[n].words, "missing") ? CW_ERR_UNSUPPORTED : CW_ERR_FORMAT));
    }
}

static void buffers_that_are_missing_are_named(void **state)
{
    (void)state;
    static const char gltf[] =
        "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"byteLength\":36,\"uri\":\"m.bin\"}],"
        "\"bufferViews\":[{\"buffer\":0,\"byteLength\":36}],\"accessors\":[{\"bufferView\":0,"
        "\"componentType\":5126,\"count\":3,\"type\":\"VEC3\",\"min\":[0,0,0],\"max\":[1,1,1]}],"
        "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}],"
        "\"nodes\":[{\"mesh\":0}],\"scenes\":[{\"nodes\":[0]}],\"scene\":0}";
    static const char obj[] =
        "mtllib red.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl red\nf 1 2 3\n";
    cw_mesh mesh;
    cw_error err = {0};
    const bool reads_gltf = cw_mesh_format(NULL, "gltf")->in_this_build;
    assert_fails(cw_mesh_read_memory(&(cw_byte_source){.bytes = gltf, .size = sizeof gltf - 1},
                                     NULL, &mesh, NULL, &err),
                 CW_ERR_UNSUPPORTED,
                 reads_gltf ? "(memory): m.bin: this file is missing" : "(memory): ", err);
    assert_null(mesh.positions);
    cw_mesh_file file;
    assert_ok(cw_mesh_read_memory(
                  &(cw_byte_source){.bytes = obj, .size = sizeof obj - 1, .name = "m.obj"},
                  NULL, &mesh, &file, &err),
              err);
    assert_int_equal(mesh.triangle_count, 1);
    assert_string_equal(file.left_out, "materials of a missing or damaged file");
    cw_mesh_free(&mesh);
}

static void layouts_and_slices_work(void **state)
{
    (void)state;
    const cw_raw_layout layout = {.dim = {2, 2, 2}};
    const cw_byte_source source = {.bytes = "abcdefgh", .size = 8, .name = "scan*.raw"};
    const cw_read_desc raw = {.raw = &layout};
    cw_volume v;
    cw_stored_file *file;
    cw_label_ids ids = {0};
    cw_error err = {0};
    assert_ok(cw_volume_read_memory(&source, &raw, &v, NULL, &err), err);
    assert_memory_equal(v.data, "abcdefgh", 8);
    cw_volume_free(&v);
    assert_ok(
        cw_stored_file_open(&(cw_byte_source){.bytes = small_nrrd, .size = SMALL}, &file, &err),
        err);
    const cw_read_desc desc = {.stored = file};
    size_t slices = 0;
    assert_ok(cw_volume_visit(NULL, &desc, 0, 0,
                              &(cw_slice_visitor){.visit = count_slices, .user = &slices}, NULL,
                              &err),
              err);
    assert_int_equal(slices, 2);
    assert_ok(cw_label_ids_read(NULL, &desc, 0, &ids, &err), err);
    cw_label_ids_free(&ids);
    cw_stored_file_close(file);
}

static void failing_allocations_leave_nothing(void **state)
{
    (void)state;
    const size_t used = cw_memory_used();
    for (long n = 0;; n++) {
        giver g = {.bytes = small_nrrd, .size = SMALL, .piece = 100};
        cw_volume v;
        cw_error err = {0};
        cwi_alloc_fail_after(n);
        const cw_status st = read_given(&g, (cw_byte_source){0}, &v, &err);
        if (!cwi_alloc_fail_after(-1)) {
            assert_ok(st, err);
            cw_volume_free(&v);
            assert_true(n > 3);
            break;
        }
        assert_fails(st, CW_ERR_NO_MEMORY, "no memory", err);
    }
    assert_int_equal(cw_memory_used(), used);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(any_pieces_make_the_same_volume),
        cmocka_unit_test(a_size_that_does_not_come_true_names_both_numbers),
        cmocka_unit_test(a_failing_source_is_the_error),
        cmocka_unit_test(sources_that_break_the_rules_are_refused),
        cmocka_unit_test_setup_teardown(limits_hold, test_folder_make, test_folder_remove),
        cmocka_unit_test_setup_teardown(stored_files_are_read_again_and_again, test_folder_make,
                                        test_folder_remove),
        cmocka_unit_test(files_that_are_missing_are_named),
        cmocka_unit_test(buffers_that_are_missing_are_named),
        cmocka_unit_test(layouts_and_slices_work),
        cmocka_unit_test(failing_allocations_leave_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
