/* Every file of the fuzzers' corpora, sound or damaged, is the same from memory as it is alone in a folder: the
 * same arrays, or the same error. */
#include "support/files/reading.h"

#include <dirent.h>

/* A file in both forms. */
typedef struct pair {
    const char *reader; /* name of it; NULL: by content */
    const char *path;
    cw_stored_file *stored;
    bool no_sandbox;
} pair;

/* Counts of what was compared. */
typedef struct tally {
    size_t read, refused, missing, unsupported; /* unsupported: of those refused */
} tally;

/* Checks that an error is the same, or that only the file in memory lacks another one. Returns true if
 * both were read. */
static bool compare_errors(const pair *p, cw_status by_path, const cw_error *a,
                           cw_status by_memory, const cw_error *b, tally *t)
{
    const bool is_missing = by_memory == CW_ERR_UNSUPPORTED && strstr(b->message, "missing");
    const bool is_stricter = is_missing && strstr(b->message, "one image of a DICOM series");
    if (is_missing && by_path == CW_OK && !is_stricter)
        fail_msg("%s: read by its path; in memory: %s", p->path, b->message);
    t->missing += is_missing;
    if (is_missing)
        return false;
    if (by_path != by_memory)
        fail_msg("%s: %d (%s) by its path, %d (%s) in memory", p->path, (int)by_path,
                 a->message, (int)by_memory, b->message);
    if (by_path != CW_OK && strcmp(a->message, b->message) != 0)
        fail_msg("%s: by its path: %s; in memory: %s", p->path, a->message, b->message);
    t->refused += by_path != CW_OK;
    t->unsupported += by_path == CW_ERR_UNSUPPORTED;
    t->read += by_path == CW_OK;
    return by_path == CW_OK;
}

static void compare_cells(const cw_cells *a, const cw_cells *b, size_t points)
{
    assert_int_equal(a->count, b->count);
    assert_memory_equal(a->points, b->points, points * 3 * sizeof *a->points);
    assert_memory_equal(a->shapes, b->shapes, a->count);
}

static void compare_volumes(const cw_volume *a, const cw_volume *b)
{
    const size_t bytes =
        a->dim[0] * a->dim[1] * a->dim[2] * a->components * a->steps * cw_type_size(a->type);
    assert_memory_equal(a->dim, b->dim, sizeof a->dim);
    assert_int_equal(a->type, b->type);
    assert_int_equal(a->components, b->components);
    assert_int_equal(a->steps, b->steps);
    assert_memory_equal(a->affine, b->affine, sizeof a->affine);
    assert_true(!a->cells == !b->cells && !a->sparse == !b->sparse);
    if (a->cells)
        compare_cells(a->cells, b->cells, a->dim[0]);
    if (a->data)
        assert_memory_equal(a->data, b->data, bytes);
}

static void compare_as_volume(const pair *p, tally *t)
{
    cw_volume a, b;
    cw_error x = {0}, y = {0};
    cw_read_desc desc = {
        .reader = p->reader, .max_bytes = 64 << 20, .no_sandbox = p->no_sandbox};
    const cw_status by_path = cw_volume_read(p->path, &desc, &a, NULL, &x);
    desc.stored = p->stored;
    const cw_status by_memory = cw_volume_read(NULL, &desc, &b, NULL, &y);
    if (compare_errors(p, by_path, &x, by_memory, &y, t))
        compare_volumes(&a, &b);
    cw_volume_free(&a);
    cw_volume_free(&b);
}

static void compare_as_mesh(const pair *p, tally *t)
{
    cw_mesh a, b;
    cw_error x = {0}, y = {0};
    cw_mesh_read_desc desc = {
        .reader = p->reader, .max_bytes = 64 << 20, .no_sandbox = p->no_sandbox};
    const cw_status by_path = cw_mesh_read(p->path, &desc, &a, NULL, &x);
    desc.stored = p->stored;
    const cw_status by_memory = cw_mesh_read(NULL, &desc, &b, NULL, &y);
    if (compare_errors(p, by_path, &x, by_memory, &y, t)) {
        assert_int_equal(a.vertex_count, b.vertex_count);
        assert_int_equal(a.triangle_count, b.triangle_count);
        if (a.vertex_count)
            assert_memory_equal(a.positions, b.positions, a.vertex_count * 12);
        if (a.triangle_count)
            assert_memory_equal(a.triangles, b.triangles, a.triangle_count * 12);
    }
    cw_mesh_free(&a);
    cw_mesh_free(&b);
}

/* Reads a file of a corpus in both forms. */
static void compare_file(const char *from, const char *name, const char *reader, bool is_mesh,
                         tally *t)
{
    char path[800];
    size_t size;
    cw_error err = {0};
    snprintf(path, sizeof path, "%s/%s", from, name);
    char *bytes = test_file_read(path, &size);
    if (size > 0) {
        pair p = {.path = test_path(name),
                  .reader = reader,
                  .no_sandbox = !strstr(from, "fuzz_dicom")};
        const cw_byte_source source = {.bytes = bytes, .size = size, .name = p.path};
        test_file_write(p.path, bytes, size);
        assert_ok(cw_stored_file_open(&source, &p.stored, &err), err);
        if (is_mesh)
            compare_as_mesh(&p, t);
        else
            compare_as_volume(&p, t);
        cw_stored_file_close(p.stored);
        assert_int_equal(remove(p.path), 0);
    }
    free(bytes);
}

static tally compare_corpus(const char *corpus, const char *reader, bool is_mesh)
{
    char folder[500];
    tally t = {0};
    snprintf(folder, sizeof folder, TEST_CORPUS "/%s", corpus);
    DIR *files = opendir(folder);
    assert_non_null(files);
    for (const struct dirent *e; (e = readdir(files));)
        if (e->d_name[0] != '.')
            compare_file(folder, e->d_name, reader, is_mesh, &t);
    closedir(files);
    return t;
}

static void files_in_memory_are_those_on_the_disk(void **state)
{
    (void)state;
    static const struct {
        const char *corpus, *reader;
        bool is_mesh, needs_others; /* of the corpus no file is read by itself */
    } rows[] = {
        {"fuzz_nrrd", NULL, false, false},      {"fuzz_nifti", NULL, false, false},
        {"fuzz_metaimage", NULL, false, false}, {"fuzz_mrc", NULL, false, false},
        {"fuzz_mgh", NULL, false, false},       {"fuzz_inr", NULL, false, false},
        {"fuzz_npy", NULL, false, false},       {"fuzz_npz", NULL, false, false},
        {"fuzz_tiff", NULL, false, false},      {"fuzz_dicom", NULL, false, false},
        {"fuzz_vti", NULL, false, false},       {"fuzz_vtk", NULL, false, false},
        {"fuzz_vtu", NULL, false, false},       {"fuzz_vtkhdf", NULL, false, false},
        {"fuzz_vtm", NULL, false, true},        {"fuzz_picture", NULL, false, false},
        {"fuzz_mesh_stl", NULL, true, false},   {"fuzz_mesh_ply", NULL, true, false},
        {"fuzz_mesh_obj", "obj", true, false},  {"fuzz_mesh_off", NULL, true, false},
        {"fuzz_mesh_3mf", "3mf", true, false},  {"fuzz_mesh_gltf", NULL, true, false},
        {"fuzz_mesh_drc", NULL, true, false},   {"fuzz_mesh_gifti", NULL, true, false},
        {"fuzz_mesh_vtk", NULL, true, false},   {"fuzz_mesh_vtp", NULL, true, false},
        {"fuzz_mesh_vtm", NULL, true, true},    {"fuzz_mesh_freesurfer", NULL, true, false},
    };
    tally all = {0};
    for (size_t n = 0; n < sizeof rows / sizeof *rows; n++) {
        const tally t = compare_corpus(rows[n].corpus, rows[n].reader, rows[n].is_mesh);
        print_message("%s: %zu read, %zu refused, %zu in need of other files\n", rows[n].corpus,
                      t.read, t.refused, t.missing);
        assert_true(t.read > 0 || rows[n].needs_others || t.unsupported > 0);
        all.read += t.read;
        all.refused += t.refused;
        all.missing += t.missing;
    }
    print_message("all: %zu %zu %zu\n", all.read, all.refused, all.missing);
    assert_true(all.read > 90 && all.refused > 40 && all.missing > 4);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(files_in_memory_are_those_on_the_disk, test_folder_make,
                                        test_folder_remove),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
