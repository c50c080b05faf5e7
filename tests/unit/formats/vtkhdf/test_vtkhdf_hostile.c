/* VTKHDF files that lie, lead elsewhere, or are damaged: each is an error that names what is wrong. */
#include "core/base/module.h"
#include "support/files/hdf5_file.h"
#include "support/files/reading.h"

#if CW_TEST_HDF5

enum { SIDE = 4, VOXELS = SIDE * SIDE * SIDE };

static const hdf5_layout plain = {0};
static const long long extent[6] = {0, SIDE - 1, 0, SIDE - 1, 0, SIDE - 1};
static double numbers[4096];

static cw_status read_file(const char *name, cw_error *err)
{
    cw_volume v;
    const cw_status st = cw_volume_read(test_path(name), NULL, &v, NULL, err);
    cw_volume_free(&v);
    return st;
}

/* Ends the file and checks how reading fails. */
static void check_refused(hdf5_file *f, cw_status expected, const char *words)
{
    cw_error err = {0};
    hdf5_end(f);
    assert_fails(read_file("a.vtkhdf", &err), expected, words, err);
}

static void start_image(hdf5_file *f)
{
    hdf5_start(f, "a.vtkhdf", "ImageData");
    hdf5_put_wholes(f->group, "WholeExtent", extent, 6);
    hdf5_add_group(f, "PointData");
}

static void put_cube(hdf5_file *f, const char *name, hdf5_layout layout)
{
    hdf5_put(f, name, H5T_STD_I16LE, 3, (hsize_t[]){SIDE, SIDE, SIDE}, numbers, layout);
}

/* --- types and attributes ----------------------------------------------------------------- */

static void other_types_are_refused_by_name(void **state)
{
    (void)state;
    static const char *const types[] = {"OverlappingAMR", "MultiBlockDataSet", "HyperTreeGrid",
                                        "PartitionedDataSetCollection"};
    for (size_t n = 0; n < sizeof types / sizeof *types; n++) {
        char words[100];
        hdf5_file f;
        hdf5_start(&f, "a.vtkhdf", types[n]);
        snprintf(words, sizeof words, "its 'Type' is '%s', which is not read", types[n]);
        check_refused(&f, CW_ERR_FORMAT, words);
    }
}

static void wrong_attributes_are_named(void **state)
{
    (void)state;
    static const long long falling[6] = {0, 3, 5, 2, 0, 3},
                           wide[6] = {0, 1LL << 40, 0, 3, 0, 3}, version[2] = {3, 0};
    static const double real[6] = {0, 3, 0, 3, 0, 3};
    const struct {
        const char *words;
        int kind;
    } cases[] = {
        {"has no attribute 'WholeExtent'", 0},
        {"the attribute 'WholeExtent' has 4 whole numbers; 6 whole numbers were expected", 1},
        {"the attribute 'WholeExtent' has 6 floating-point numbers; 6 whole", 2},
        {"the attribute 'WholeExtent' has 1 texts", 3},
        {"'WholeExtent' goes from 5 to 2 along y", 4},
        {"'WholeExtent' goes from 0 to 1099511627776 along x", 5},
        {"has no attribute 'Type'", 6},
        {"the attribute 'Type' has 2 whole numbers; one text was expected", 7},
        {"its 'Version' is 3.0", 8},
        {"the attribute 'Spacing' has 2 floating-point numbers; 3 numbers", 9},
    };
    for (size_t n = 0; n < sizeof cases / sizeof *cases; n++) {
        const int kind = cases[n].kind;
        hdf5_file f;
        hdf5_start(&f, "a.vtkhdf", kind < 6 || kind == 9 ? "ImageData" : NULL);
        hdf5_add_group(&f, "PointData");
        if (kind == 1 || kind == 9)
            hdf5_put_wholes(f.group, "WholeExtent", extent, kind == 1 ? 4 : 6);
        if (kind == 2)
            hdf5_put_reals(f.group, "WholeExtent", real, 6);
        if (kind == 3)
            hdf5_put_text(f.group, "WholeExtent", "0 3 0 3 0 3", true);
        if (kind == 4 || kind == 5)
            hdf5_put_wholes(f.group, "WholeExtent", kind == 4 ? falling : wide, 6);
        if (kind == 7)
            hdf5_put_wholes(f.group, "Type", extent, 2);
        if (kind == 8)
            hdf5_put_wholes(f.group, "Version", version, 2);
        if (kind == 9)
            hdf5_put_reals(f.group, "Spacing", real, 2);
        put_cube(&f, "PointData/p", plain);
        check_refused(&f, CW_ERR_FORMAT, cases[n].words);
    }
}

/* --- arrays of images --------------------------------------------------------------------- */

static void arrays_that_cannot_be_read_say_why(void **state)
{
    (void)state;
    hdf5_file f;
    const hid_t compound = H5Tcreate(H5T_COMPOUND, 8);
    H5Tinsert(compound, "a", 0, H5T_STD_I32LE);
    start_image(&f);
    hdf5_put(&f, "PointData/p", H5T_STD_I16LE, 3, (hsize_t[]){SIDE, SIDE, SIDE + 1}, numbers,
             plain);
    check_refused(&f, CW_ERR_FORMAT, "its shape is not 4 x 4 x 4, as 'WholeExtent' states");
    start_image(&f);
    hdf5_put(&f, "PointData/p", compound, 3, (hsize_t[]){SIDE, SIDE, SIDE}, NULL, plain);
    check_refused(&f, CW_ERR_FORMAT, "its values are no numbers of up to 64 bits");
    start_image(&f);
    hdf5_put(&f, "PointData/p", H5T_STD_I8LE, 6, (hsize_t[]){1, 1, 1, SIDE, SIDE, SIDE}, NULL,
             plain);
    check_refused(&f, CW_ERR_FORMAT, "it has 6 dimensions; 1 to 5 are read");
    start_image(&f);
    put_cube(&f, "PointData/p", (hdf5_layout){.chunk = {2, 2, 2}, .filter = 32001});
    check_refused(&f, CW_ERR_FORMAT, "its filter 32001 is not read: 'h5repack -f NONE'");
    start_image(&f);
    check_refused(&f, CW_ERR_FORMAT, "PointData and CellData hold no array that is read");
    H5Tclose(compound);
}

/* Sizes of a header that no bytes of the file stand for: nothing of that size is allocated. */
static void huge_sizes_are_refused(void **state)
{
    (void)state;
    static const long long wide[6] = {0, (1 << 20) - 1, 0, (1 << 20) - 1, 0, (1 << 19) - 1};
    const hdf5_layout layouts[] = {{.chunk = {4, 4, 4}, .deflate = true},
                                   {.chunk = {1, 1024, 1024}, .shuffle = true},
                                   {.chunk = {1, 1 << 14, 1 << 14}}};
    static const char *const words[] = {"its shape asks for", "its shape asks for",
                                        "its chunks take 2147483648 bytes"};
    for (int n = 0; n < 3; n++) {
        const hid_t types[] = {H5T_STD_I16LE, H5T_STD_U8LE, H5T_STD_I64LE};
        hdf5_file f;
        hdf5_start(&f, "a.vtkhdf", "ImageData");
        hdf5_put_wholes(f.group, "WholeExtent", wide, 6);
        hdf5_add_group(&f, "PointData");
        hdf5_put(&f, "PointData/p", types[n], 3, (hsize_t[]){1 << 19, 1 << 20, 1 << 20}, NULL,
                 layouts[n]);
        check_refused(&f, CW_ERR_FORMAT, words[n]);
    }
}

static void other_files_are_not_opened(void **state)
{
    (void)state;
    hdf5_file f;
    start_image(&f);
    put_cube(&f, "PointData/p", (hdf5_layout){.external = test_path("numbers.raw")});
    check_refused(&f, CW_ERR_FORMAT, "its values are in other files, which are not opened");

    start_image(&f);
    assert_true(H5Lcreate_external("other.vtkhdf", "/x", f.group, "PointData/p", H5P_DEFAULT,
                                   H5P_DEFAULT) >= 0);
    check_refused(&f, CW_ERR_FORMAT, "it is a link to another file, which is not followed");

    start_image(&f);
    assert_true(H5Lcreate_soft("/VTKHDF/p", f.group, "PointData/p", H5P_DEFAULT, H5P_DEFAULT) >=
                0);
    put_cube(&f, "p", plain);
    check_refused(&f, CW_ERR_FORMAT, "it is a link, which is not followed");

    start_image(&f);
    const hsize_t dim[3] = {SIDE, SIDE, SIDE};
    const hid_t list = H5Pcreate(H5P_DATASET_CREATE), space = H5Screate_simple(3, dim, NULL);
    assert_true(H5Pset_virtual(list, space, "other.h5", "/x", space) >= 0);
    const hid_t set = H5Dcreate2(f.group, "PointData/p", H5T_STD_I16LE, space, H5P_DEFAULT,
                                 list, H5P_DEFAULT);
    assert_true(set >= 0);
    H5Dclose(set);
    H5Sclose(space);
    H5Pclose(list);
    check_refused(&f, CW_ERR_FORMAT, "its values are in other files, which are not opened");
}

/* Groups that hold themselves are read like others. */
static void circles_end(void **state)
{
    (void)state;
    static const char *const names[] = {"PointData/PointData", "Steps", "CellData",
                                        "PointData/loop"};
    for (size_t n = 0; n < sizeof names / sizeof *names; n++) {
        hdf5_file f;
        cw_error err = {0};
        start_image(&f);
        put_cube(&f, "PointData/p", plain);
        assert_true(H5Lcreate_hard(f.file, "/VTKHDF", f.group, names[n], H5P_DEFAULT,
                                   H5P_DEFAULT) >= 0);
        hdf5_end(&f);
        assert_ok(read_file("a.vtkhdf", &err), err);
    }
    hdf5_file f;
    hdf5_start(&f, "a.vtkhdf", "ImageData");
    assert_true(H5Lmove(f.file, "VTKHDF", f.file, "X", H5P_DEFAULT, H5P_DEFAULT) >= 0);
    assert_true(H5Lcreate_soft("/VTKHDF", f.file, "VTKHDF", H5P_DEFAULT, H5P_DEFAULT) >= 0);
    check_refused(&f, CW_ERR_FORMAT, "it has no group VTKHDF, or this is a link");
}

static void too_many_arrays_are_refused(void **state)
{
    (void)state;
    hdf5_file f;
    start_image(&f);
    for (int n = 0; n < 600; n++) {
        char name[40];
        snprintf(name, sizeof name, "PointData/p%d", n);
        hdf5_put(&f, name, H5T_STD_U8LE, 1, (hsize_t[]){1}, numbers, plain);
    }
    check_refused(&f, CW_ERR_LIMIT, "the group VTKHDF has more than 512 arrays");
}

/* --- grids -------------------------------------------------------------------------------- */

/* One tetrahedron, with one of its arrays replaced. */
static void put_tetrahedron(hdf5_file *f, const char *other, hid_t type, int rank, hsize_t rows,
                            hsize_t columns, const double *values)
{
    static const double points[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1},
                        corners[4] = {0, 1, 2, 3}, ends[2] = {0, 4}, types[1] = {10},
                        four[1] = {4}, one[1] = {1};
    const struct {
        const char *name;
        hid_t type;
        int rank;
        hsize_t rows, columns;
        const double *values;
    } arrays[] = {
        {"NumberOfPoints", H5T_STD_I64LE, 1, 1, 1, four},
        {"NumberOfCells", H5T_STD_I64LE, 1, 1, 1, one},
        {"NumberOfConnectivityIds", H5T_STD_I64LE, 1, 1, 1, four},
        {"Points", H5T_IEEE_F32LE, 2, 4, 3, points},
        {"Connectivity", H5T_STD_I64LE, 1, 4, 1, corners},
        {"Offsets", H5T_STD_I64LE, 1, 2, 1, ends},
        {"Types", H5T_STD_U8LE, 1, 1, 1, types},
        {"PointData/p", H5T_IEEE_F64LE, 1, 4, 1, points},
    };
    hdf5_start(f, "a.vtkhdf", "UnstructuredGrid");
    hdf5_add_group(f, "PointData");
    for (size_t n = 0; n < sizeof arrays / sizeof *arrays; n++)
        if (!other || strcmp(arrays[n].name, other) != 0)
            hdf5_put(f, arrays[n].name, arrays[n].type, arrays[n].rank,
                     (hsize_t[]){arrays[n].rows, arrays[n].columns}, arrays[n].values, plain);
    if (rank)
        hdf5_put(f, other, type, rank, (hsize_t[]){rows, columns}, values, plain);
}

static void grids_that_lie_are_refused(void **state)
{
    (void)state;
    const struct {
        const char *name;
        hid_t type;
        int rank;
        hsize_t rows, columns;
        double values[6];
        const char *words;
    } cases[] = {
        {"Points", 0, 0, 0, 0, {0}, "has no array 'Points', which is needed"},
        {"Points", H5T_IEEE_F32LE, 2, 4, 2, {0}, "'Points' has 2 real numbers in each row; 3"},
        {"Points", H5T_IEEE_F32LE, 2, 3, 3, {0}, "'Points' has 3 rows; rows 0 to 4 were"},
        {"Points", H5T_STD_I32LE, 2, 4, 3, {0}, "'Points' has 3 whole numbers in each row"},
        {"Types", H5T_STD_U8LE, 1, 0, 1, {0}, "'Types' has 0 rows; rows 0 to 1 were"},
        {"Types", H5T_STD_U8LE, 1, 1, 1, {200}, "cell 0 is of type 200, which is not known"},
        {"Types", H5T_IEEE_F32LE, 1, 1, 1, {10}, "'Types' has 1 real numbers"},
        {"Connectivity", H5T_STD_I64LE, 1, 3, 1, {0, 1, 2}, "'Connectivity' has 3 rows"},
        {"Connectivity", H5T_STD_I64LE, 1, 4, 1, {0, 1, 2, 9}, "9"},
        {"Connectivity", H5T_STD_I64LE, 1, 4, 1, {0, 1, 2, -1}, "-1"},
        {"Offsets", H5T_STD_I64LE, 1, 1, 1, {0}, "'Offsets' has 1 rows; rows 1 to 2 were"},
        {"Offsets", H5T_STD_I64LE, 1, 2, 1, {0, 3}, "3"},
        {"Offsets", H5T_STD_I64LE, 1, 2, 1, {0, -4}, "-4"},
        {"NumberOfPoints",
         H5T_STD_I64LE,
         1,
         1,
         1,
         {-4},
         "number 0 of the array 'NumberOfPoints'"},
        {"NumberOfPoints",
         H5T_STD_U64LE,
         1,
         1,
         1,
         {9e18},
         "number 0 of the array 'NumberOfPoints'"},
        {"NumberOfPoints", H5T_STD_I64LE, 1, 1, 1, {1e15}, "'Points' has 4 rows"},
        {"NumberOfPoints", H5T_STD_I64LE, 1, 0, 1, {0}, "'NumberOfPoints' lists no partition"},
        {"NumberOfPoints", H5T_IEEE_F32LE, 1, 1, 1, {4}, "'NumberOfPoints' has 1 real numbers"},
        {"NumberOfCells", H5T_STD_I64LE, 1, 1, 1, {2}, "rows 1 to 3 were expected"},
        {"NumberOfConnectivityIds", H5T_STD_I64LE, 1, 0, 1, {0}, "0 x 1 whole numbers"},
        {"PointData/p", H5T_IEEE_F64LE, 1, 3, 1, {0}, "'PointData/p' has 3 rows; rows 0 to 4"},
        {"PointData/p", H5T_C_S1, 1, 4, 1, {0}, "its values are no numbers"},
    };
    hdf5_file f;
    cw_error good = {0};
    put_tetrahedron(&f, NULL, 0, 0, 0, 0, NULL);
    hdf5_end(&f);
    assert_ok(read_file("a.vtkhdf", &good), good);
    for (size_t n = 0; n < sizeof cases / sizeof *cases; n++) {
        put_tetrahedron(&f, cases[n].name, cases[n].type, cases[n].rank, cases[n].rows,
                        cases[n].columns, cases[n].type == H5T_C_S1 ? NULL : cases[n].values);
        check_refused(&f, CW_ERR_FORMAT, cases[n].words);
    }
}

static void many_partitions_are_refused(void **state)
{
    (void)state;
    hdf5_file f;
    double *counts = calloc(200000, sizeof *counts);
    put_tetrahedron(&f, "NumberOfPoints", H5T_STD_U8LE, 1, 200000, 1, counts);
    check_refused(&f, CW_ERR_LIMIT, "it has 200000 partitions of 1 arrays, more than are read");
    free(counts);
}

/* --- damage ------------------------------------------------------------------------------- */

/* A file cut anywhere, or with bytes changed, is read or refused; a process that dies costs nothing. */
static void damaged_files_are_errors(void **state)
{
    (void)state;
    hdf5_file f;
    size_t size;
    start_image(&f);
    put_cube(&f, "PointData/p", (hdf5_layout){.chunk = {2, 3, 4}, .deflate = true});
    hdf5_end(&f);
    char *bytes = test_file_read(test_path("a.vtkhdf"), &size);
    const size_t step = size / (size_t)test_some(60) + 1;
    for (size_t cut = 1; cut < size; cut += step) {
        cw_error err = {0};
        test_file_write(test_path("a.vtkhdf"), bytes, cut);
        const cw_status st = read_file("a.vtkhdf", &err);
        if (st != CW_ERR_FORMAT)
            fail_msg("%zu of %zu bytes: status %d, %s", cut, size, (int)st, err.message);
    }
    for (size_t at = 8; at < size; at += step / 2 + 1) {
        cw_error err = {0};
        char *changed = malloc(size);
        memcpy(changed, bytes, size);
        changed[at] ^= 0x55;
        test_file_write(test_path("a.vtkhdf"), changed, size);
        const cw_status st = read_file("a.vtkhdf", &err);
        if (st != CW_OK && st != CW_ERR_FORMAT && st != CW_ERR_LIMIT &&
            st != CW_ERR_UNSUPPORTED && st != CW_ERR_BACKEND)
            fail_msg("byte %zu: status %d, %s", at, (int)st, err.message);
        free(changed);
    }
    free(bytes);
}

static void other_content_is_refused(void **state)
{
    (void)state;
    hdf5_file f;
    cw_error err = {0};
    test_file_write(test_path("text.vtkhdf"), "no HDF5", 7);
    assert_fails(read_file("text.vtkhdf", &err), CW_ERR_FORMAT, "it is no HDF5 file", err);
    hdf5_start(&f, "plain.h5", NULL);
    assert_true(H5Lmove(f.file, "VTKHDF", f.file, "data", H5P_DEFAULT, H5P_DEFAULT) >= 0);
    hdf5_end(&f);
    char *bytes;
    size_t size;
    bytes = test_file_read(test_path("plain.h5"), &size);
    for (size_t n = 0; n + 6 <= size; n++) /* the old name is left in the heap */
        if (memcmp(bytes + n, "VTKHDF", 6) == 0)
            bytes[n] = 'X';
    test_file_write(test_path("plain.h5"), bytes, size);
    free(bytes);
    assert_fails(read_file("plain.h5", &err), CW_ERR_UNSUPPORTED,
                 "this is an HDF5 file, which is not read: h5py", err);
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, test_folder_make, test_folder_remove)

int main(void)
{
    static const struct CMUnitTest tests[] = {
        TEST(other_types_are_refused_by_name),    TEST(wrong_attributes_are_named),
        TEST(arrays_that_cannot_be_read_say_why), TEST(huge_sizes_are_refused),
        TEST(other_files_are_not_opened),         TEST(circles_end),
        TEST(too_many_arrays_are_refused),        TEST(grids_that_lie_are_refused),
        TEST(many_partitions_are_refused),        TEST(damaged_files_are_errors),
        TEST(other_content_is_refused),
    };
    if (!cwi_module_present("hdf5")) {
        puts("this build reads no VTKHDF");
        return 0;
    }
    for (size_t n = 0; n < sizeof numbers / sizeof *numbers; n++)
        numbers[n] = (double)(n % 100);
    return cmocka_run_group_tests(tests, NULL, NULL);
}

#else

int main(void)
{
    puts("this build reads no VTKHDF");
    return 0;
}

#endif
