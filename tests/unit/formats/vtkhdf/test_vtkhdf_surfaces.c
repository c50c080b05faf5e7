/* VTKHDF: surfaces of polygons and strips in partitions, in HDF5 files that the library itself writes. */
#include "core/base/module.h"
#include "support/files/hdf5_file.h"
#include "support/support.h"

#include <stdio.h>
#include <string.h>

#if CW_TEST_HDF5

#include <math.h>

enum { MAX_PARTS = 4, CORNERS = 4 * 5 * MAX_PARTS, POINTS = 8 * MAX_PARTS };

/* Boxes in a row along x, one for each partition: the first has its end as a strip of 4 corners, the
 * last as a polygon; others are open. */
typedef struct row_of_boxes {
    size_t parts, corner_count, end_count;
    double points[3 * POINTS], colors[3 * POINTS], corners[CORNERS], ends[6 * MAX_PARTS];
    double counts[MAX_PARTS], corner_counts[MAX_PARTS], point_counts[MAX_PARTS];
} row_of_boxes;

static void make_boxes(row_of_boxes *b, size_t parts)
{
    static const double faces[5][4] = {
        {0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {2, 3, 7, 6}, {1, 2, 6, 5}};
    *b = (row_of_boxes){.parts = parts};
    for (size_t p = 0; p < parts; p++) {
        const size_t count = p + 1 == parts ? 5 : 4;
        for (size_t n = 0; n < 8; n++) {
            double *point = b->points + 3 * (8 * p + n);
            point[0] = (double)p + (n % 4 == 1 || n % 4 == 2);
            point[1] = n % 4 > 1;
            point[2] = n > 3;
        }
        b->ends[b->end_count++] = 0;
        for (size_t n = 0; n < count; n++) {
            memcpy(b->corners + b->corner_count, faces[n], sizeof faces[n]);
            b->corner_count += 4;
            b->ends[b->end_count++] = 4.0 * (double)(n + 1);
        }
        b->counts[p] = (double)count;
        b->corner_counts[p] = 4.0 * (double)count;
        b->point_counts[p] = 8;
    }
    for (size_t n = 0; n < 3 * 8 * parts; n++)
        b->colors[n] = (double)(n % 250);
}

static void put_row(hdf5_file *f, const char *group, const char *name, size_t count,
                    const double *numbers)
{
    char path[80];
    snprintf(path, sizeof path, "%s%s", group, name);
    hdf5_put(f, path, H5T_STD_I64LE, 1, (hsize_t[]){count}, numbers, (hdf5_layout){0});
}

static void put_surface(const char *name, const row_of_boxes *b, hdf5_layout layout,
                        hdf5_file *f)
{
    static const char *const others[2] = {"Vertices", "Lines"};
    static const double none[MAX_PARTS + 1] = {0}, one[MAX_PARTS] = {1}, four[MAX_PARTS] = {4},
                                         strip[4] = {0, 4, 3, 7},
                                         strip_ends[MAX_PARTS + 1] = {0, 4};
    const hdf5_layout rows = {.chunk = {layout.chunk[0], 3}, .deflate = layout.deflate};
    hdf5_start(f, name, "PolyData");
    put_row(f, "", "NumberOfPoints", b->parts, b->point_counts);
    hdf5_put(f, "Points", H5T_IEEE_F32LE, 2, (hsize_t[]){8 * b->parts, 3}, b->points, rows);
    for (int k = 0; k < 2; k++) {
        hdf5_add_group(f, others[k]);
        put_row(f, others[k], "/NumberOfCells", b->parts, none);
        put_row(f, others[k], "/NumberOfConnectivityIds", b->parts, none);
    }
    hdf5_add_group(f, "Polygons");
    put_row(f, "Polygons", "/NumberOfCells", b->parts, b->counts);
    put_row(f, "Polygons", "/NumberOfConnectivityIds", b->parts, b->corner_counts);
    put_row(f, "Polygons", "/Connectivity", b->corner_count, b->corners);
    put_row(f, "Polygons", "/Offsets", b->end_count, b->ends);
    hdf5_add_group(f, "Strips");
    put_row(f, "Strips", "/NumberOfCells", b->parts, one);
    put_row(f, "Strips", "/NumberOfConnectivityIds", b->parts, four);
    put_row(f, "Strips", "/Connectivity", 4, strip);
    put_row(f, "Strips", "/Offsets", b->parts + 1, strip_ends);
    hdf5_add_group(f, "PointData");
    hdf5_put(f, "PointData/rgb", H5T_STD_U8LE, 2, (hsize_t[]){8 * b->parts, 3}, b->colors,
             rows);
    hdf5_put(f, "PointData/h", H5T_IEEE_F32LE, 1, (hsize_t[]){8 * b->parts}, b->points, layout);
}

/* Volume by tetrahedra to the origin: that of a closed surface which is oriented alike everywhere. */
static double volume_of(const cw_mesh *mesh)
{
    double sum = 0;
    for (size_t n = 0; n < mesh->triangle_count; n++) {
        const float *a = mesh->positions + 3 * (size_t)mesh->triangles[3 * n],
                    *b = mesh->positions + 3 * (size_t)mesh->triangles[3 * n + 1],
                    *c = mesh->positions + 3 * (size_t)mesh->triangles[3 * n + 2];
        sum +=
            (double)(a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) +
                     a[2] * (b[0] * c[1] - b[1] * c[0]));
    }
    return sum / 6;
}

static void surfaces_in_partitions_are_one(void **state)
{
    (void)state;
    for (size_t parts = 1; parts < MAX_PARTS; parts++)
        for (int inside = 0; inside < 2; inside++) {
            const hdf5_layout packed = {.chunk = {5}, .deflate = true};
            row_of_boxes b;
            hdf5_file f;
            cw_mesh mesh;
            cw_mesh_file facts;
            cw_error err = {0};
            make_boxes(&b, parts);
            put_surface("a.vtkhdf", &b, parts == 2 ? packed : (hdf5_layout){0}, &f);
            hdf5_end(&f);
            const cw_mesh_read_desc desc = {.no_sandbox = inside};
            assert_ok(cw_mesh_read(test_path("a.vtkhdf"), &desc, &mesh, &facts, &err), err);
            assert_string_equal(facts.format, "vtkhdf");
            assert_int_equal(mesh.triangle_count, 8 * parts + 4);
            assert_int_equal(mesh.vertex_count, 4 * parts + 4);
            assert_near(fabs(volume_of(&mesh)), (double)parts, 1e-6);
            assert_non_null(mesh.colors);
            assert_int_equal(mesh.colors[4], 3);
            assert_non_null(mesh.scalars);
            cw_mesh_free(&mesh);
        }
}

/* The first step is the second partition: a box without its first end. */
static void the_first_step_of_a_surface_is_read(void **state)
{
    (void)state;
    static const long long steps = 3;
    static const double cells[12] = {0, 0, 4, 1}, corners[12] = {0, 0, 16, 4}, part[3] = {1},
                        one[3] = {1, 1, 1}, points[3] = {8};
    row_of_boxes b;
    hdf5_file f;
    cw_mesh mesh;
    cw_mesh_file facts;
    cw_error err = {0};
    make_boxes(&b, 2);
    memset(b.points, 0, 24 * sizeof *b.points); /* those of other steps are not looked at */
    put_surface("a.vtkhdf", &b, (hdf5_layout){0}, &f);
    hdf5_add_group(&f, "Steps");
    hdf5_add_group(&f, "Steps/PointDataOffsets");
    hdf5_put_wholes(hdf5_group_of(&f, "Steps"), "NSteps", &steps, 1);
    put_row(&f, "Steps", "/PartOffsets", 3, part);
    put_row(&f, "Steps", "/NumberOfParts", 3, one);
    put_row(&f, "Steps", "/PointOffsets", 3, points);
    put_row(&f, "Steps/PointDataOffsets", "/h", 3, points);
    hdf5_put(&f, "Steps/CellOffsets", H5T_STD_I64LE, 2, (hsize_t[]){3, 4}, cells,
             (hdf5_layout){0});
    hdf5_put(&f, "Steps/ConnectivityIdOffsets", H5T_STD_I64LE, 2, (hsize_t[]){3, 4}, corners,
             (hdf5_layout){0});
    hdf5_end(&f);
    assert_ok(cw_mesh_read(test_path("a.vtkhdf"), NULL, &mesh, &facts, &err), err);
    assert_int_equal(mesh.triangle_count, 10);
    assert_int_equal(mesh.vertex_count, 8);
    assert_true(mesh.scalars[3] == (float)b.points[8 + 3]);
    assert_non_null(strstr(facts.left_out, "time steps but the first"));
    cw_mesh_free(&mesh);
}

static void surfaces_are_no_volumes(void **state)
{
    (void)state;
    row_of_boxes b;
    hdf5_file f;
    cw_volume v;
    cw_mesh mesh;
    cw_error err = {0};
    make_boxes(&b, 1);
    put_surface("s.vtkhdf", &b, (hdf5_layout){0}, &f);
    hdf5_end(&f);
    assert_fails(cw_volume_read(test_path("s.vtkhdf"), NULL, &v, NULL, &err), CW_ERR_FORMAT,
                 "this is a mesh (vtkhdf), not a volume", err);
    hdf5_start(&f, "v.vtkhdf", "ImageData");
    hdf5_end(&f);
    assert_fails(cw_mesh_read(test_path("v.vtkhdf"), NULL, &mesh, NULL, &err), CW_ERR_FORMAT,
                 "its 'Type' is ImageData, a volume (vtkhdf), not a mesh", err);
}

static void surfaces_that_lie_are_refused(void **state)
{
    (void)state;
    static const char *const words[] = {"'Points' has 24 rows; rows 24 to 32 were expected",
                                        "'Polygons/Connectivity' has 52 rows",
                                        "'Polygons/Offsets' has 16 rows; rows 11 to 111 were",
                                        "triangle 0 names vertex 9 of 8"};
    for (size_t n = 0; n < sizeof words / sizeof *words; n++) {
        row_of_boxes b;
        hdf5_file f;
        cw_mesh mesh;
        cw_error err = {0};
        make_boxes(&b, 3);
        if (n == 0)
            b.point_counts[0] = 16;
        if (n == 1)
            b.corner_counts[1] = 40;
        if (n == 2) {
            b.counts[2] = 100;
            b.corner_counts[2] = 16;
        }
        if (n == 3)
            b.corners[2] = 9;
        put_surface("a.vtkhdf", &b, (hdf5_layout){0}, &f);
        hdf5_end(&f);
        assert_fails(cw_mesh_read(test_path("a.vtkhdf"), NULL, &mesh, NULL, &err),
                     CW_ERR_FORMAT, words[n], err);
    }
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, test_folder_make, test_folder_remove)

int main(void)
{
    static const struct CMUnitTest tests[] = {
        TEST(surfaces_in_partitions_are_one),
        TEST(the_first_step_of_a_surface_is_read),
        TEST(surfaces_are_no_volumes),
        TEST(surfaces_that_lie_are_refused),
    };
    if (!cwi_module_present("hdf5")) {
        puts("this build reads no VTKHDF");
        return 0;
    }
    return cmocka_run_group_tests(tests, NULL, NULL);
}

#else

int main(void)
{
    puts("this build reads no VTKHDF");
    return 0;
}

#endif
