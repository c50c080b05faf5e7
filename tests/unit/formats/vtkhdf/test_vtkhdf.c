/* VTKHDF: images and grids in HDF5 files that the library itself writes. */
#include "core/base/module.h"
#include "support/files/hdf5_file.h"
#include "support/files/reading.h"
#include "support/files/regions.h"

#if CW_TEST_HDF5

enum { NX = 7, NY = 5, NZ = 6, VOXELS = NX * NY * NZ, NOTES = 2000 };

static char notes[NOTES];

static void take_note(void *user, const char *text)
{
    (void)user;
    strncat(notes, text, NOTES - strlen(notes) - 2);
    strcat(notes, "\n");
}

static cw_status read_with(const char *name, cw_read_desc desc, cw_volume *v, cw_error *err)
{
    notes[0] = '\0';
    desc.note = take_note;
    return cw_volume_read(test_path(name), &desc, v, NULL, err);
}

static void read_good(const char *name, cw_read_desc desc, cw_volume *v)
{
    cw_error err = {0};
    assert_ok(read_with(name, desc, v, &err), err);
}

/* --- images ------------------------------------------------------------------------------- */

static double field_at(size_t x, size_t y, size_t z)
{
    return (double)(x * x) + 2.0 * (double)(y * y) + 3.0 * (double)(z * z);
}

static void fill_field(double numbers[VOXELS])
{
    for (size_t n = 0; n < VOXELS; n++)
        numbers[n] = field_at(n % NX, n / NX % NY, n / NX / NY);
}

/* The head of an image of NX x NY x NZ points, whose indices do not start at 0. */
static void start_image(hdf5_file *f, const char *name)
{
    static const double origin[3] = {10, 20, 30}, spacing[3] = {0.5, 2, 3},
                        direction[9] = {0, -1, 0, 1, 0, 0, 0, 0, 1};
    static const long long extent[6] = {2, 2 + NX - 1, 0, NY - 1, -1, NZ - 2};
    hdf5_start(f, name, "ImageData");
    hdf5_put_wholes(f->group, "WholeExtent", extent, 6);
    hdf5_put_reals(f->group, "Origin", origin, 3);
    hdf5_put_reals(f->group, "Spacing", spacing, 3);
    hdf5_put_reals(f->group, "Direction", direction, 9);
    hdf5_add_group(f, "PointData");
    hdf5_add_group(f, "CellData");
}

static void put_field(hdf5_file *f, const char *name, hid_t type, hdf5_layout layout)
{
    double numbers[VOXELS];
    fill_field(numbers);
    hdf5_put(f, name, type, 3, (hsize_t[]){NZ, NY, NX}, numbers, layout);
}

static void check_field(const cw_volume *v)
{
    assert_int_equal(v->dim[0], NX);
    assert_int_equal(v->dim[1], NY);
    assert_int_equal(v->dim[2], NZ);
    for (size_t n = 0; n < VOXELS; n++) {
        const size_t x = n % NX, y = n / NX % NY, z = n / NX / NY;
        assert_true(cw_volume_value(v, x, y, z) == field_at(x, y, z));
    }
}

/* Contiguous or in chunks, in either order of bytes, of every kind of numbers: the same field. */
static void numbers_of_every_kind_and_layout_are_read(void **state)
{
    (void)state;
    const struct {
        hid_t type;
        hdf5_layout layout;
        cw_type expected;
    } cases[] = {
        {H5T_IEEE_F32LE, {0}, CW_F32},
        {H5T_IEEE_F64BE, {0}, CW_F64},
        {H5T_STD_I16BE, {0}, CW_I16},
        {H5T_STD_U8LE, {.compact = true}, CW_U8},
        {H5T_STD_U16LE, {.chunk = {2, 3, 4}, .deflate = true}, CW_U16},
        {H5T_IEEE_F64LE, {.chunk = {4, 2, 7}, .deflate = true, .shuffle = true}, CW_F64},
        {H5T_STD_I32BE, {.chunk = {6, 5, 7}, .checksum = true}, CW_I32},
        {H5T_STD_I64LE, {.chunk = {1, 1, 1}, .shuffle = true}, CW_I32},
        {H5T_STD_U64BE, {0}, CW_U32},
        {H5T_STD_U32LE, {.chunk = {64, 64, 64}, .deflate = true}, CW_U32},
    };
    for (size_t n = 0; n < sizeof cases / sizeof *cases; n++)
        for (int inside = 0; inside < 2; inside++) {
            hdf5_file f;
            cw_volume v;
            start_image(&f, "a.vtkhdf");
            put_field(&f, "PointData/p", cases[n].type, cases[n].layout);
            hdf5_end(&f);
            read_good("a.vtkhdf", (cw_read_desc){.no_sandbox = inside}, &v);
            assert_int_equal(v.type, cases[n].expected);
            check_field(&v);
            assert_place(&v, 0, 0, 0, 10, 21, 27);
            assert_place(&v, 1, 1, 1, 8, 21.5, 30);
            cw_volume_free(&v);
        }
}

static void regions_and_slices_are_those_of_the_whole(void **state)
{
    (void)state;
    const hdf5_layout layouts[] = {{0}, {.chunk = {2, 3, 4}, .deflate = true}};
    for (int n = 0; n < 2; n++) {
        hdf5_file f;
        cw_volume v;
        const cw_box box = {{1, 2, 3}, {4, 2, 3}};
        start_image(&f, "a.hdf");
        put_field(&f, "PointData/p", H5T_IEEE_F32BE, layouts[n]);
        hdf5_end(&f);
        read_good("a.hdf", (cw_read_desc){.region = &box}, &v);
        assert_int_equal(v.dim[0], 4);
        assert_true(cw_volume_value(&v, 3, 1, 2) == field_at(4, 3, 5));
        cw_volume_free(&v);
        read_good("a.hdf", (cw_read_desc){.header_only = true}, &v);
        assert_null(v.data);
        assert_int_equal(v.dim[2], NZ);
        cw_volume_free(&v);
        check_regions("a.hdf", NULL);
    }
}

/* The array that is asked for, else the Scalars, else the first of one value; also of cells, and of
 * several components. */
static void arrays_are_chosen_by_name(void **state)
{
    (void)state;
    hdf5_file f;
    cw_volume v;
    cw_error err = {0};
    double several[3 * VOXELS], cells[(NX - 1) * (NY - 1) * (NZ - 1)];
    for (size_t n = 0; n < 3 * VOXELS; n++)
        several[n] = (double)n;
    for (size_t n = 0; n < sizeof cells / sizeof *cells; n++)
        cells[n] = (double)n;
    start_image(&f, "a.vtkhdf");
    hdf5_put(&f, "PointData/a", H5T_STD_I32LE, 4, (hsize_t[]){NZ, NY, NX, 3}, several,
             (hdf5_layout){0});
    put_field(&f, "PointData/b<&\">", H5T_STD_I16LE, (hdf5_layout){0});
    hdf5_put(&f, "CellData/c", H5T_IEEE_F64LE, 3, (hsize_t[]){NZ - 1, NY - 1, NX - 1}, cells,
             (hdf5_layout){.chunk = {1, 2, 3}, .deflate = true});
    hdf5_end(&f);
    read_good("a.vtkhdf", (cw_read_desc){0}, &v);
    check_field(&v);
    assert_non_null(strstr(notes, "'b<&\">'"));
    cw_volume_free(&v);
    read_good("a.vtkhdf", (cw_read_desc){.array = "a"}, &v);
    assert_int_equal(v.components, 3);
    cw_volume one;
    assert_ok(cw_volume_select(&v, 2, 0, &one, &err), err);
    assert_true(cw_volume_value(&one, 1, 0, 0) == 5);
    cw_volume_free(&v);
    read_good("a.vtkhdf", (cw_read_desc){.array = "c"}, &v);
    assert_int_equal(v.dim[0], NX - 1);
    assert_true(cw_volume_value(&v, 1, 1, 0) == NX);
    assert_place(&v, 0, 0, 0, 10 - 2 * 0.5, 20 + 2.5 * 0.5, 30 - 0.5 * 3);
    cw_volume_free(&v);
    assert_fails(read_with("a.vtkhdf", (cw_read_desc){.array = "d"}, &v, &err), CW_ERR_ARGUMENT,
                 "there is no array 'd'", err);
}

static void stated_scalars_go_first(void **state)
{
    (void)state;
    hdf5_file f;
    cw_volume v;
    start_image(&f, "a.vtkhdf");
    hdf5_put_text(hdf5_group_of(&f, "PointData"), "Scalars", "z", false);
    put_field(&f, "PointData/a", H5T_STD_U8LE, (hdf5_layout){0});
    put_field(&f, "PointData/z", H5T_STD_I16LE, (hdf5_layout){0});
    hdf5_end(&f);
    read_good("a.vtkhdf", (cw_read_desc){0}, &v);
    assert_int_equal(v.type, CW_I16);
    cw_volume_free(&v);
}

/* Arrays of flat images have two dimensions, or three of which one is 1. */
static void flat_images_are_read(void **state)
{
    (void)state;
    for (int rank = 2; rank < 4; rank++) {
        static const long long extent[6] = {0, NX - 1, 0, NY - 1, 0, 0};
        double numbers[VOXELS];
        hdf5_file f;
        cw_volume v;
        fill_field(numbers);
        hdf5_start(&f, "a.vtkhdf", "ImageData");
        hdf5_put_wholes(f.group, "WholeExtent", extent, 6);
        hdf5_add_group(&f, "PointData");
        hdf5_put(&f, "PointData/p", H5T_IEEE_F32LE, rank,
                 rank == 2 ? (hsize_t[]){NY, NX, 0} : (hsize_t[]){1, NY, NX}, numbers,
                 (hdf5_layout){0});
        hdf5_end(&f);
        read_good("a.vtkhdf", (cw_read_desc){0}, &v);
        assert_int_equal(v.dim[2], 1);
        assert_true(cw_volume_value(&v, 2, 3, 0) == field_at(2, 3, 0));
        cw_volume_free(&v);
    }
}

/* Of several steps the first is read, from where its offset says. */
static void the_first_step_of_an_image_is_read(void **state)
{
    (void)state;
    static const long long steps = 2;
    for (int chunks = 0; chunks < 2; chunks++) {
        double numbers[2 * VOXELS];
        hdf5_file f;
        cw_volume v;
        for (size_t n = 0; n < VOXELS; n++)
            numbers[n] = -1;
        fill_field(numbers + VOXELS);
        start_image(&f, "a.vtkhdf");
        hdf5_put(&f, "PointData/p", H5T_IEEE_F32LE, 4, (hsize_t[]){2, NZ, NY, NX}, numbers,
                 (hdf5_layout){.chunk = {chunks, 2, 2, 2}, .deflate = chunks});
        hdf5_add_group(&f, "Steps");
        hdf5_put_wholes(hdf5_group_of(&f, "Steps"), "NSteps", &steps, 1);
        hdf5_add_group(&f, "Steps/PointDataOffsets");
        hdf5_put(&f, "Steps/PointDataOffsets/p", H5T_STD_I64LE, 1, (hsize_t[]){2},
                 (double[]){1, 0}, (hdf5_layout){0});
        hdf5_end(&f);
        read_good("a.vtkhdf", (cw_read_desc){0}, &v);
        check_field(&v);
        assert_non_null(strstr(notes, "it has 2 time steps: the first is read"));
        cw_volume_free(&v);
    }
}

/* --- grids -------------------------------------------------------------------------------- */

enum { SIDE = 4, SIDE_CELLS = SIDE - 1 };

/* Numbers of a grid that grows partition by partition. */
typedef struct grid {
    double points[3000], corners[3000], ends[600], types[600], values[1000], at_cells[600],
        marks[600];
    double point_counts[4], cell_counts[4], corner_counts[4];
    size_t parts, point_count, cell_count, corner_count, end_count;
} grid;

/* Adds a block of SIDE^3 points, moved along x; `count` of its cells, 0: it is empty. */
static void add_block(grid *g, double x, bool empty)
{
    const size_t p = g->parts++;
    const size_t points = empty ? 0 : SIDE * SIDE * SIDE;
    g->ends[g->end_count++] = 0;
    for (size_t n = 0; n < points; n++) {
        const double at[3] = {x + (double)(n % SIDE), (double)(n / SIDE % SIDE),
                              (double)(n / SIDE / SIDE)};
        for (int a = 0; a < 3; a++)
            g->points[3 * g->point_count + (size_t)a] = at[a];
        g->values[g->point_count++] = at[0] + 10 * at[1] + 100 * at[2];
    }
    for (size_t n = 0; n < SIDE_CELLS * SIDE_CELLS * SIDE_CELLS && !empty; n++) {
        static const size_t corner[8] = {0, 1, 1 + SIDE, SIDE, 16, 17, 17 + SIDE, 16 + SIDE};
        const size_t first = n % SIDE_CELLS + SIDE * (n / SIDE_CELLS % SIDE_CELLS) +
                             SIDE * SIDE * (n / SIDE_CELLS / SIDE_CELLS);
        for (int c = 0; c < 8; c++)
            g->corners[g->corner_count++] = (double)(first + corner[c]);
        g->ends[g->end_count++] = 8.0 * (double)(n + 1);
        g->types[g->cell_count] = 12;
        g->marks[g->cell_count] = 0;
        g->at_cells[g->cell_count++] = 7;
    }
    const double cells = empty ? 0 : SIDE_CELLS * SIDE_CELLS * SIDE_CELLS;
    g->point_counts[p] = (double)points;
    g->cell_counts[p] = cells;
    g->corner_counts[p] = 8 * cells;
}

static void put_row(hdf5_file *f, const char *name, hid_t type, size_t count,
                    const double *numbers, hdf5_layout layout)
{
    hdf5_put(f, name, type, 1, (hsize_t[]){count}, numbers, layout);
}

static void put_grid(const char *name, const grid *g, hdf5_layout layout, hdf5_file *f)
{
    const hdf5_layout plain = {0};
    hdf5_layout rows = layout;
    rows.chunk[1] = layout.chunk[0] ? 3 : 0;
    hdf5_start(f, name, "UnstructuredGrid");
    hdf5_add_group(f, "PointData");
    hdf5_add_group(f, "CellData");
    put_row(f, "NumberOfPoints", H5T_STD_I64LE, g->parts, g->point_counts, plain);
    put_row(f, "NumberOfCells", H5T_STD_I32BE, g->parts, g->cell_counts, plain);
    put_row(f, "NumberOfConnectivityIds", H5T_STD_U16LE, g->parts, g->corner_counts, plain);
    hdf5_put(f, "Points", H5T_IEEE_F32LE, 2, (hsize_t[]){g->point_count, 3}, g->points, rows);
    put_row(f, "Connectivity", H5T_STD_I64LE, g->corner_count, g->corners, layout);
    put_row(f, "Offsets", H5T_STD_I64LE, g->end_count, g->ends, layout);
    put_row(f, "Types", H5T_STD_U8LE, g->cell_count, g->types, layout);
    put_row(f, "PointData/p", H5T_IEEE_F64LE, g->point_count, g->values, layout);
    put_row(f, "CellData/c", H5T_IEEE_F32BE, g->cell_count, g->at_cells, layout);
}

/* Partitions become one grid; an empty one changes nothing. */
static void partitions_of_grids_are_joined(void **state)
{
    (void)state;
    const hdf5_layout layouts[] = {{0}, {.chunk = {13}, .deflate = true}};
    for (int n = 0; n < 2; n++) {
        grid g = {.parts = 0};
        hdf5_file f;
        cw_volume v;
        add_block(&g, 0, false);
        add_block(&g, 0, true);
        add_block(&g, SIDE_CELLS, false);
        put_grid("a.vtkhdf", &g, layouts[n], &f);
        hdf5_end(&f);
        read_good("a.vtkhdf", (cw_read_desc){0}, &v);
        assert_int_equal(v.dim[0], 2 * SIDE * SIDE * SIDE - SIDE * SIDE);
        assert_int_equal(v.cells->count, 54);
        for (size_t k = 0; k < v.dim[0]; k++) {
            const double *p = v.cells->points + 3 * k;
            assert_true(cw_volume_value(&v, k, 0, 0) == p[0] + 10 * p[1] + 100 * p[2]);
        }
        cw_volume_free(&v);
        read_good("a.vtkhdf", (cw_read_desc){.array = "c"}, &v);
        assert_true(cw_volume_value(&v, 5, 0, 0) == 7);
        cw_volume_free(&v);
        read_good("a.vtkhdf", (cw_read_desc){.header_only = true}, &v);
        assert_int_equal(v.cells->count, 54);
        cw_volume_free(&v);
    }
}

static void hidden_cells_are_left_out(void **state)
{
    (void)state;
    grid g = {.parts = 0};
    hdf5_file f;
    cw_volume v;
    add_block(&g, 0, false);
    g.marks[3] = 1;
    g.marks[20] = 32;
    put_grid("a.vtkhdf", &g, (hdf5_layout){0}, &f);
    put_row(&f, "CellData/vtkGhostType", H5T_STD_U8LE, g.cell_count, g.marks,
            (hdf5_layout){.chunk = {5}, .deflate = true});
    hdf5_end(&f);
    read_good("a.vtkhdf", (cw_read_desc){0}, &v);
    assert_int_equal(v.cells->count, 25);
    cw_volume_free(&v);
}

/* The first step has the second partition, and the second half of the arrays. */
static void the_first_step_of_a_grid_is_read(void **state)
{
    (void)state;
    static const long long steps = 2;
    const hdf5_layout plain = {0};
    grid g = {.parts = 0};
    hdf5_file f;
    cw_volume v;
    add_block(&g, 50, false);
    add_block(&g, 0, false);
    put_grid("a.vtkhdf", &g, plain, &f);
    hdf5_add_group(&f, "Steps");
    hdf5_add_group(&f, "Steps/PointDataOffsets");
    hdf5_put_wholes(hdf5_group_of(&f, "Steps"), "NSteps", &steps, 1);
    put_row(&f, "Steps/PartOffsets", H5T_STD_I64LE, 2, (double[]){1, 0}, plain);
    put_row(&f, "Steps/NumberOfParts", H5T_STD_I64LE, 2, (double[]){1, 1}, plain);
    put_row(&f, "Steps/PointOffsets", H5T_STD_I64LE, 2, (double[]){64, 0}, plain);
    hdf5_put(&f, "Steps/CellOffsets", H5T_STD_I64LE, 2, (hsize_t[]){2, 1}, (double[]){27, 0},
             plain);
    hdf5_put(&f, "Steps/ConnectivityIdOffsets", H5T_STD_I64LE, 2, (hsize_t[]){2, 1},
             (double[]){216, 0}, plain);
    put_row(&f, "Steps/PointDataOffsets/p", H5T_STD_I64LE, 2, (double[]){64, 0}, plain);
    hdf5_end(&f);
    read_good("a.vtkhdf", (cw_read_desc){.array = "p"}, &v);
    assert_int_equal(v.cells->count, 27);
    assert_true(v.cells->points[3 * 5] == 1 && cw_volume_value(&v, 5, 0, 0) == 11);
    assert_non_null(strstr(notes, "2 time steps"));
    cw_volume_free(&v);
}

/* --- memory ------------------------------------------------------------------------------- */

static void running_out_of_memory_is_an_error(void **state)
{
    (void)state;
    grid g = {.parts = 0};
    hdf5_file f;
    start_image(&f, "a.vtkhdf");
    put_field(&f, "PointData/p", H5T_IEEE_F32LE, (hdf5_layout){.chunk = {2, 2, 2}});
    hdf5_end(&f);
    check_starved("a.vtkhdf", &(cw_read_desc){.no_sandbox = true});
    add_block(&g, 0, false);
    put_grid("a.vtkhdf", &g, (hdf5_layout){0}, &f);
    hdf5_end(&f);
    check_starved("a.vtkhdf", &(cw_read_desc){.no_sandbox = true});
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, test_folder_make, test_folder_remove)

int main(void)
{
    static const struct CMUnitTest tests[] = {
        TEST(numbers_of_every_kind_and_layout_are_read),
        TEST(regions_and_slices_are_those_of_the_whole),
        TEST(arrays_are_chosen_by_name),
        TEST(stated_scalars_go_first),
        TEST(flat_images_are_read),
        TEST(the_first_step_of_an_image_is_read),
        TEST(partitions_of_grids_are_joined),
        TEST(hidden_cells_are_left_out),
        TEST(the_first_step_of_a_grid_is_read),
        TEST(running_out_of_memory_is_an_error),
    };
    if (!cwi_module_present("hdf5")) {
        puts("this build reads no VTKHDF");
        return 0;
    }
    return cmocka_run_group_tests(tests, NULL, NULL);
}

#else

/* Without the library a file is refused by the name of its package. */
static void a_build_without_the_library_says_so(void **state)
{
    (void)state;
    static const char bytes[] = "\x89HDF\r\n\x1a\nVTKHDF";
    cw_volume v;
    cw_error err = {0};
    test_file_write(test_path("a.hdf"), bytes, sizeof bytes);
    assert_fails(cw_volume_read(test_path("a.hdf"), NULL, &v, NULL, &err), CW_ERR_UNSUPPORTED,
                 "libhdf5-dev", err);
}

int main(void)
{
    static const struct CMUnitTest tests[] = {cmocka_unit_test_setup_teardown(
        a_build_without_the_library_says_so, test_folder_make, test_folder_remove)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}

#endif
