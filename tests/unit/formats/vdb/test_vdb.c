/* OpenVDB files: every kind of grid, and files that are damaged. */
#include "support/surface.h"
#include "vdb/vdbs.h"

#include "core/base/sandbox.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#if !CW_TEST_OPENVDB

static void test_refused(void **state)
{
    static const unsigned char head[64] = " BDV";
    cw_error err = {0};
    cw_volume v;
    (void)state;
    test_file_write(test_path("a.vdb"), head, sizeof head);
    assert_fails(cw_volume_read(test_path("a.vdb"), NULL, &v, NULL, &err), CW_ERR_UNSUPPORTED,
                 "libopenvdb-dev", err);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_refused, test_folder_make, test_folder_remove)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}

#else

static const char *write_kind(const char *kind)
{
    const char *path = test_path("a.vdb");
    assert_true(test_vdb_write(kind, path));
    return path;
}

static cw_volume read_kind(const char *kind, const cw_read_desc *desc)
{
    cw_error err = {0};
    cw_volume v;
    const char *format;
    assert_ok(cw_volume_read(write_kind(kind), desc, &v, &format, &err), err);
    assert_string_equal(format, "vdb");
    return v;
}

/* The farthest vertex of a level set from the sphere of radius 20 around a centre. */
static double farthest(const cw_volume *v, const double centre[3])
{
    double most = 0;
    cw_mesh m = test_extract(v, &(cw_extract_desc){.inside_is_low = true}, NULL);
    const cw_quality q = test_check_promise(&m, false);
    assert_int_equal(q.euler, 2);
    for (size_t n = 0; n < m.vertex_count; n++) {
        double square = 0;
        for (size_t a = 0; a < 3; a++)
            square += pow(m.origin[a] + (double)m.positions[3 * n + a] - centre[a], 2);
        most = fmax(most, fabs(sqrt(square) - 20));
    }
    assert_true(m.vertex_count > 10000);
    cw_mesh_free(&m);
    return most;
}

static void test_level_sets(void **state)
{
    static const char *const kinds[] = {"sphere", "stream", "half"};
    (void)state;
    for (size_t n = 0; n < 3; n++) {
        cw_volume v = read_kind(kinds[n], NULL);
        double spacing[3];
        cw_volume_spacing(&v, spacing);
        assert_near(spacing[1], 0.5, 1e-12);
        assert_int_equal(v.known, CW_KNOWN_LEVEL_SET);
        assert_int_equal(v.type, CW_F32);
        assert_near(v.sparse->background, 1.5, n == 2 ? 1e-3 : 1e-6);
        assert_true(v.sparse->leaf_count > 500);
        assert_true(v.sparse->tile_count > 0);
        assert_true(farthest(&v, (double[3]){3, -5, 200000}) < (n == 2 ? 3e-3 : 2e-3));
        cw_volume_free(&v);
    }
}

/* The transform is that of the file: a voxel's place is as OpenVDB has it. */
static void test_transform(void **state)
{
    const double m[3][4] = {{0.5, 0, 0.2, 7}, {0.1, -0.25, 0, 8}, {0, 0, 1, 9}};
    (void)state;
    cw_volume v = read_kind("sheared", NULL);
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++)
            assert_near(v.affine[r][c], m[r][c], 1e-12);
    cw_mesh mesh = test_extract(&v, &(cw_extract_desc){.inside_is_low = true}, NULL);
    const cw_quality q = test_check_promise(&mesh, false);
    double low[3], high[3];
    cw_mesh_bounds(&mesh, low, high);
    for (int a = 0; a < 3; a++)
        assert_near(0.5 * (low[a] + high[a]), m[a][3], 0.02);
    assert_within(q.volume_mm3, 4 / 3. * PI * 8000 * 0.125, 0.01); /* the determinant */
    cw_mesh_free(&mesh);
    cw_volume_free(&v);
}

/* A ball of ones: as many voxels as there are, in leaves and tiles. */
static void check_ball(const char *kind, cw_type type, double inside)
{
    size_t count = 0, expected = 0;
    for (int k = -20; k <= 20; k++)
        for (int j = -20; j <= 20; j++)
            for (int i = -20; i <= 20; i++)
                expected += i * i + j * j + k * k <= 400;
    cw_volume v = read_kind(kind, NULL);
    assert_int_equal(v.type, type);
    assert_int_equal(v.known, 0);
    const cw_sparse *s = v.sparse;
    for (size_t n = 0; n < 512 * s->leaf_count; n++) {
        const cw_volume flat = {.data = v.data, .type = type, .dim = {512, s->leaf_count, 1}};
        const double x = cw_volume_value(&flat, n % 512, n / 512, 0);
        assert_true(x == inside || x == 0);
        count += x == inside;
    }
    for (size_t n = 0; n < s->tile_count; n++) {
        const uint32_t *size = s->tiles[n].size;
        assert_true(s->tiles[n].value == inside);
        count += (size_t)size[0] * size[1] * size[2] * 512;
    }
    assert_int_equal(count, expected);
    assert_true(s->tile_count > 0);
    cw_mesh m = test_extract(
        &v, &(cw_extract_desc){.isovalue = inside / 2, .inside_is_low = inside < 0}, NULL);
    double low[3], high[3];
    cw_mesh_bounds(&m, low, high);
    const double from[3] = {-10.5, -20.5, -30.5};
    for (int a = 0; a < 3; a++) {
        assert_near(low[a], from[a], 1e-4);
        assert_near(high[a], from[a] + 41, 1e-4);
    }
    test_check_promise(&m, false);
    cw_mesh_free(&m);
    cw_volume_free(&v);
}

static void test_types(void **state)
{
    (void)state;
    check_ball("double", CW_F64, 1);
    check_ball("int32", CW_I32, -7);
    check_ball("bool", CW_U8, 1);
    check_ball("mask", CW_U8, 1);
}

static void take_note(void *user, const char *text)
{
    char *all = user;
    strncat(all, text, 4095 - strlen(all));
}

static void test_several_grids(void **state)
{
    char notes[4096] = "";
    cw_error err = {0};
    (void)state;
    cw_volume v = read_kind("several", &(cw_read_desc){.note = take_note, .note_user = notes});
    assert_int_equal(v.known, CW_KNOWN_LEVEL_SET);
    assert_non_null(strstr(notes, "grid 'surface', level set"));
    assert_non_null(strstr(notes, "4 grids: 'v', 'density', 'surface', 'copy'"));
    cw_volume_free(&v);
    cw_array *grids;
    size_t count;
    assert_ok(cw_arrays_list(test_path("a.vdb"), NULL, &grids, &count, &err), err);
    assert_int_equal(count, 4);
    assert_true(!grids[0].is_read && grids[1].is_read && !grids[1].is_default);
    assert_true(grids[2].is_default);
    cw_arrays_free(grids);
    v = read_kind("several", &(cw_read_desc){.array = "density"});
    assert_int_equal(v.known, 0);
    cw_volume_free(&v);
    const char *path = test_path("a.vdb");
    assert_fails(cw_volume_read(path, &(cw_read_desc){.array = "v"}, &v, NULL, &err),
                 CW_ERR_UNSUPPORTED, "grid 'v': its values are of type vec3s", err);
    assert_fails(cw_volume_read(path, &(cw_read_desc){.array = "copy"}, &v, NULL, &err),
                 CW_ERR_UNSUPPORTED, "it shares the voxels of grid 'surface'", err);
    assert_fails(cw_volume_read(path, &(cw_read_desc){.array = "x"}, &v, NULL, &err),
                 CW_ERR_ARGUMENT, "there is no grid 'x'; there are 'v', 'density'", err);
}

static void test_refusals(void **state)
{
    cw_error err = {0};
    cw_volume v;
    (void)state;
    assert_fails(cw_volume_read(write_kind("vec3"), NULL, &v, NULL, &err), CW_ERR_UNSUPPORTED,
                 "one number a voxel was expected", err);
    assert_fails(cw_volume_read(write_kind("frustum"), NULL, &v, NULL, &err),
                 CW_ERR_UNSUPPORTED, "its transform is not linear", err);
    assert_fails(cw_volume_read(write_kind("none"), NULL, &v, NULL, &err), CW_ERR_FORMAT,
                 "it has none", err);
    const char *path = write_kind("sphere");
    assert_fails(cw_volume_read(path, &(cw_read_desc){.max_voxels = 1000}, &v, NULL, &err),
                 CW_ERR_LIMIT, "voxels; the limit is 1000", err);
    const cw_box box = {{0, 0, 0}, {8, 8, 8}};
    assert_fails(cw_volume_read(path, &(cw_read_desc){.region = &box}, &v, NULL, &err),
                 CW_ERR_UNSUPPORTED, "a crop on a sparse grid", err);
}

static void test_header_and_spacing(void **state)
{
    (void)state;
    cw_volume v =
        read_kind("sphere", &(cw_read_desc){.header_only = true, .spacing_mm = {1, 2, 3}});
    double spacing[3];
    assert_null(v.data);
    assert_null(v.sparse->leaves);
    assert_true(v.sparse->leaf_count > 500);
    assert_int_equal(v.dim[0] % 8, 0);
    cw_volume_spacing(&v, spacing);
    assert_near(spacing[2], 3, 1e-12);
    cw_volume_free(&v);
    v = read_kind("empty", NULL);
    cw_mesh m = test_extract(&v, &(cw_extract_desc){.isovalue = 1}, NULL);
    assert_int_equal(m.triangle_count, 0);
    cw_mesh_free(&m);
    cw_volume_free(&v);
}

/* Cut short and scribbled over: an error, or a volume that can be used; never more. */
static void test_damage(void **state)
{
    size_t size, failed = 0, rounds = 0;
    (void)state;
    char *bytes = test_file_read(write_kind("several"), &size);
    const char *path = test_path("b.vdb");
    uint32_t random = 1;
    for (int round = 0; round < 120; round += test_is_short() ? 7 : 1, rounds++) {
        cw_error err = {0};
        cw_volume v;
        cw_mesh m = {0};
        char *copy = malloc(size);
        memcpy(copy, bytes, size);
        size_t length = size;
        for (int n = 0; n < 1 + round % 4; n++) {
            random = random * 1664525 + 1013904223;
            const size_t at = (random >> 4) % (round % 3 ? 3000 : size);
            if (round % 5 == 0)
                length = at;
            else
                copy[at] = (char)(random >> 24);
        }
        test_file_write(path, copy, length);
        free(copy);
        const cw_read_desc desc = {.max_bytes = (size_t)1 << 28, .timeout_s = test_limit_s()};
        if (cw_volume_read(path, &desc, &v, NULL, &err) != CW_OK) {
            assert_true(err.message[0]);
            failed++;
            continue;
        }
        const cw_extract_desc d = {
            .inside_is_low = true, .max_bytes = (size_t)1 << 28, .max_triangles = 10000000};
        if (cw_extract(&v, &d, &m, NULL, &err) == CW_OK)
            cw_mesh_free(&m);
        cw_volume_free(&v);
    }
    free(bytes);
    assert_true(failed > rounds / 6);
    assert_true(failed < rounds);
}

/* Writes a level set with one number of its head replaced. */
static const char *write_patched(size_t at, uint32_t number)
{
    const char *path = write_kind("sphere");
    const unsigned char b[4] = {(unsigned char)number, (unsigned char)(number >> 8),
                                (unsigned char)(number >> 16), (unsigned char)(number >> 24)};
    size_t size;
    char *bytes = test_file_read(path, &size);
    memcpy(bytes + at, b, sizeof b);
    test_file_write(path, bytes, size);
    free(bytes);
    return path;
}

static void test_versions(void **state)
{
    enum { VERSION_AT = 8 };
    static const uint32_t unknown[] = {0, 212, 9999};
    cw_error err = {0};
    cw_volume v;
    (void)state;
    for (size_t n = 0; n < sizeof unknown / sizeof *unknown; n++)
        assert_fails(
            cw_volume_read(write_patched(VERSION_AT, unknown[n]), NULL, &v, NULL, &err),
            CW_ERR_FORMAT, " are read", err);
}

/* The name of a grid claims 1.5 GB: that is not taken for a file of half a MB. */
static void test_memory(void **state)
{
    enum { NAME_LENGTH_AT = 65 };
    cw_error err = {0};
    cw_volume v;
    (void)state;
    if (!CWI_SANITIZED)
        assert_fails(
            cw_volume_read(write_patched(NAME_LENGTH_AT, 0x60000000), NULL, &v, NULL, &err),
            CW_ERR_FORMAT, "MB of memory, which no file of ", err);
}

int main(void)
{
#define IN_FOLDER(test)                                                                        \
    cmocka_unit_test_setup_teardown(test, test_folder_make, test_folder_remove)
    const struct CMUnitTest tests[] = {
        IN_FOLDER(test_level_sets), IN_FOLDER(test_transform),
        IN_FOLDER(test_types),      IN_FOLDER(test_several_grids),
        IN_FOLDER(test_refusals),   IN_FOLDER(test_header_and_spacing),
        IN_FOLDER(test_damage),     IN_FOLDER(test_versions),
        IN_FOLDER(test_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

#endif
