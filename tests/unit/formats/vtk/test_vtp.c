/* VTP and PVD written: what stands where, found by reading the file the simple way. */
#include "support/support.h"

#include "formats/mesh/mesh_writer.h"
#include "formats/vtk/vtk_formats.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <zlib.h>

/* A file, and where its appended data start. */
typedef struct vtp {
    char *bytes;
    size_t size;
    const char *appended;
} vtp;

static vtp read_file(const char *path)
{
    vtp f;
    f.bytes = test_file_read(path, &f.size);
    f.appended = strstr(f.bytes, "<AppendedData encoding=\"raw\">\n_");
    assert_non_null(f.appended);
    f.appended += strlen("<AppendedData encoding=\"raw\">\n_");
    static const char end[] = "\n</AppendedData>\n</VTKFile>\n";
    assert_memory_equal(f.bytes + f.size - strlen(end), end, strlen(end));
    return f;
}

static uint64_t word(const char *at, size_t index)
{
    uint64_t value;
    memcpy(&value, at + 8 * index, sizeof value);
    return value;
}

/* The bytes of an array, which must be of a type; free them. */
static char *take_array(const vtp *f, const char *type, const char *name, size_t expected)
{
    char tag[200];
    snprintf(tag, sizeof tag, "<DataArray type=\"%s\" Name=\"%s\" ", type, name);
    const char *at = strstr(f->bytes, tag);
    if (!at)
        fail_msg("no %s", tag);
    at = f->appended + strtoull(strstr(at, "offset=\"") + 8, NULL, 10);
    const size_t count = word(at, 0), block = word(at, 1), last = word(at, 2);
    char *bytes = malloc(expected + 1);
    assert_true(bytes && count > 0);
    assert_int_equal((last ? count - 1 : count) * block + last, expected);
    const char *packed = at + 8 * (3 + count);
    for (size_t i = 0; i < count; packed += word(at, 3 + i), i++) {
        uLongf size = last && i + 1 == count ? last : block;
        assert_int_equal(uncompress((Bytef *)bytes + i * block, &size, (const Bytef *)packed,
                                    word(at, 3 + i)),
                         Z_OK);
    }
    return bytes;
}

static void check_array(const vtp *f, const char *type, const char *name, const void *expected,
                        size_t size)
{
    char *bytes = take_array(f, type, name, size);
    assert_memory_equal(bytes, expected, size);
    free(bytes);
}

static void every_array_stands_where_it_is_said_to_be(void **state)
{
    (void)state;
    static uint8_t colors[32] = {1, 2, 3, 4, [31] = 9};
    static float scalars[8] = {0.5f, [7] = -1};
    static uint32_t labels[8] = {7, [7] = 4000000000u};
    int32_t ends[12];
    cw_mesh mesh = {0};
    cw_error err = {0};
    test_make_cube(&mesh);
    mesh.colors = colors;
    mesh.scalars = scalars;
    mesh.labels = labels;
    for (int i = 0; i < 12; i++)
        ends[i] = 3 * (i + 1);
    assert_ok(cw_mesh_write(test_path("a.vtp"), &mesh, NULL, &err), err);
    vtp f = read_file(test_path("a.vtp"));
    check_array(&f, "Float32", "Points", mesh.positions, 96);
    check_array(&f, "Float32", "Normals", mesh.normals, 96);
    check_array(&f, "UInt8", "RGBA", colors, 32);
    check_array(&f, "Float32", "scalar", scalars, 32);
    check_array(&f, "UInt32", "label", labels, 32);
    check_array(&f, "Int32", "connectivity", mesh.triangles, 144);
    check_array(&f, "Int32", "offsets", ends, sizeof ends);
    assert_non_null(strstr(f.bytes, "<PointData Normals=\"Normals\" Scalars=\"scalar\">"));
    assert_non_null(strstr(f.bytes, "NumberOfPoints=\"8\""));
    assert_non_null(strstr(f.bytes, "NumberOfPolys=\"12\""));
    free(f.bytes);
    mesh.colors = NULL;
    mesh.scalars = NULL;
    mesh.labels = NULL;
    cw_mesh_free(&mesh);
}

/* More than one block of 256 KiB, the last of them smaller. */
static void large_arrays_are_cut_into_blocks(void **state)
{
    (void)state;
    const cw_field_desc desc = {.field = CW_FIELD_GYROID, .dim = {64, 64, 64}, .type = CW_F32};
    cw_volume v;
    cw_mesh mesh = {0};
    cw_error err = {0};
    assert_ok(cw_field_sample(&desc, &v, &err), err);
    assert_ok(cw_extract(&v, NULL, &mesh, NULL, &err), err);
    assert_true(12 * mesh.vertex_count > 2 * (256 << 10));
    assert_ok(cw_mesh_write(test_path("a.vtp"), &mesh, &(cw_write_desc){.local = true}, &err),
              err);
    vtp f = read_file(test_path("a.vtp"));
    check_array(&f, "Float32", "Points", mesh.positions, 12 * mesh.vertex_count);
    check_array(&f, "Int32", "connectivity", mesh.triangles, 12 * mesh.triangle_count);
    assert_non_null(strstr(f.bytes, "LPS, mm -->\n<!-- origin "));
    free(f.bytes);
    cw_mesh_free(&mesh);
    cw_volume_free(&v);
}

static void indices_may_have_64_bits(void **state)
{
    (void)state;
    cwi_part part = {.digits = 9, .turn = {{0, 1, 2}, {1, 1, 1}, 1, 1}};
    cw_error err = {0};
    cw_axes axes = {0};
    int64_t corners[12], ends[4];
    test_make_tetrahedron(&part.mesh);
    const cwi_parts parts = {.items = &part, .count = 1, .vertices = 4, .triangles = 4};
    const cw_progress none = {0};
    cwi_mesh_output out = {.axes = &axes, .name = "a", .progress = &none};
    assert_ok(cwi_outfile_open(&out.file, test_path("a.vtp"), false, &err), err);
    assert_ok(cwi_vtp_write_wide(&parts, &out, &err), err);
    assert_ok(cwi_outfile_commit(&out.file, &err), err);
    for (int i = 0; i < 12; i++)
        corners[i] = part.mesh.triangles[i];
    for (int i = 0; i < 4; i++)
        ends[i] = 3 * (i + 1);
    vtp f = read_file(test_path("a.vtp"));
    check_array(&f, "Int64", "connectivity", corners, sizeof corners);
    check_array(&f, "Int64", "offsets", ends, sizeof ends);
    free(f.bytes);
    cw_mesh_free(&part.mesh);
}

/* --- .pvd -------------------------------------------------------------------------------- */

static void a_series_lists_its_files_from_its_own_folder(void **state)
{
    (void)state;
    static const struct {
        const char *pvd, *file, *listed;
    } rows[] = {
        {"a.pvd", "a.vtp", "a.vtp"},
        {"a.pvd", "sub/a & b.vtp", "sub/a &amp; b.vtp"},
        {"sub/a.pvd", "sub/a.vtp", "a.vtp"},
        {"sub/a.pvd", "a.vtp", "../a.vtp"},
        {"sub/deep/a.pvd", "subway/a.vtp", "../../subway/a.vtp"},
        {"sub/../a.pvd", "./sub//deep/../deep/a.vtp", "sub/deep/a.vtp"},
    };
    assert_int_equal(mkdir(test_path("sub"), 0700), 0);
    assert_int_equal(mkdir(test_path("sub/deep"), 0700), 0);
    assert_int_equal(mkdir(test_path("subway"), 0700), 0);
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        char file[300], expected[400];
        cw_error err = {0};
        size_t size;
        snprintf(file, sizeof file, "%s", test_path(rows[i].file));
        const cw_pvd_entry entries[] = {{file, 0.1}};
        assert_ok(cw_pvd_write(test_path(rows[i].pvd), entries, 1, NULL, &err), err);
        char *text = test_file_read(test_path(rows[i].pvd), &size);
        snprintf(expected, sizeof expected,
                 "\n<DataSet timestep=\"0.1\" group=\"\" part=\"0\" file=\"%s\"/>\n",
                 rows[i].listed);
        if (!strstr(text, expected))
            fail_msg("row %zu: %s", i, text);
        free(text);
    }
}

static void files_of_one_time_are_parts(void **state)
{
    (void)state;
    char a[300];
    cw_error err = {0};
    size_t size;
    snprintf(a, sizeof a, "%s", test_path("a.vtp"));
    const cw_pvd_entry entries[] = {{a, 0}, {a, 0}, {a, 1.5}, {a, 1e-7}};
    assert_ok(cw_pvd_write(test_path("a.pvd"), entries, 4, NULL, &err), err);
    char *text = test_file_read(test_path("a.pvd"), &size);
    assert_non_null(strstr(text, "\"0\" group=\"\" part=\"1\""));
    assert_non_null(strstr(text, "\"1.5\" group=\"\" part=\"0\""));
    assert_non_null(strstr(text, "\"1e-07\" group=\"\" part=\"0\""));
    free(text);
}

static void what_is_no_series_is_refused(void **state)
{
    (void)state;
    char lost[300], a[300];
    cw_error err = {0};
    snprintf(lost, sizeof lost, "%s", test_path("nowhere/a.vtp"));
    snprintf(a, sizeof a, "%s", test_path("a.vtp"));
    const cw_pvd_entry away = {lost, 0}, timeless = {a, INFINITY}, good = {a, 0};
    const cw_write_desc kept = {.no_clobber = true};
    assert_fails(cw_pvd_write(test_path("a.pvd"), NULL, 0, NULL, &err), CW_ERR_ARGUMENT,
                 "a.pvd: the series has no files", err);
    assert_fails(cw_pvd_write(test_path("a.pvd"), &away, 1, NULL, &err), CW_ERR_ARGUMENT,
                 "the folder of", err);
    assert_fails(cw_pvd_write(test_path("a.pvd"), &timeless, 1, NULL, &err), CW_ERR_ARGUMENT,
                 "is not finite", err);
    assert_fails(cw_pvd_write(test_path("x/a.pvd"), &good, 1, NULL, &err), CW_ERR_OUTPUT,
                 "x' does not exist", err);
    assert_int_equal(test_folder_entries(), 0);
    assert_ok(cw_pvd_write(test_path("a.pvd"), &good, 1, &kept, &err), err);
    assert_fails(cw_pvd_write(test_path("a.pvd"), &good, 1, &kept, &err), CW_ERR_OUTPUT,
                 "it exists", err);
}

int main(void)
{
#define TEST(name) cmocka_unit_test_setup_teardown(name, test_folder_make, test_folder_remove)
    const struct CMUnitTest tests[] = {
        TEST(every_array_stands_where_it_is_said_to_be),
        TEST(large_arrays_are_cut_into_blocks),
        TEST(indices_may_have_64_bits),
        TEST(a_series_lists_its_files_from_its_own_folder),
        TEST(files_of_one_time_are_parts),
        TEST(what_is_no_series_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
