/* Tests the reader of NumPy's arrays: shapes, orders, types, versions and damaged headers. */
#include "support/files/reading.h"
#include "support/files/regions.h"

#include <stdio.h>

static const uint8_t counting[24] = {0,  1,  2,  3,  4,  5,  6,  7,  8,  9,  10, 11,
                                     12, 13, 14, 15, 16, 17, 18, 19, 20, 21, 22, 23};

/* Writes a file of a version, with a dictionary and numbers. */
static void save(const char *name, int version, const char *dictionary, const void *numbers,
                 size_t size)
{
    char head[512];
    const size_t start = version == 1 ? 10 : 12, length = strlen(dictionary);
    memset(head, 0, sizeof head);
    memcpy(head, "\x93NUMPY", 6);
    head[6] = (char)version;
    head[8] = (char)length;
    memcpy(head + start, dictionary, length);
    memcpy(head + start + length, numbers, size);
    test_file_write(test_path(name), head, start + length + size);
}

static cw_volume read_array(const char *dictionary)
{
    cw_volume v;
    cw_error err = {0};
    save("a.npy", 1, dictionary, counting, sizeof counting);
    assert_ok(read_back("a.npy", &v, &err), err);
    return v;
}

static void axes_are_z_y_x(void **state)
{
    (void)state;
    cw_volume v =
        read_array("{'descr': '|u1', 'fortran_order': False, 'shape': (2, 3, 4), }\n");
    assert_true(v.dim[0] == 4 && v.dim[1] == 3 && v.dim[2] == 2 && v.known == 0);
    assert_true(cw_volume_value(&v, 1, 2, 1) == 12 + 8 + 1);
    check_affine(&v, (const double[12]){1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0});
    cw_volume_free(&v);
    v = read_array("{'descr': '|u1', 'fortran_order': True, 'shape': (2, 3, 4), }\n");
    assert_true(v.dim[0] == 4 && v.dim[2] == 2);
    assert_true(cw_volume_value(&v, 1, 2, 1) == 1 + 2 * 2 + 6 * 1);
    cw_volume_free(&v);
    v = read_array("{\"shape\":(6,4),\"fortran_order\":False,\"descr\":\"|b1\"}");
    assert_true(v.dim[0] == 4 && v.dim[1] == 6 && v.dim[2] == 1 && v.type == CW_U8);
    cw_volume_free(&v);
}

static void four_axes_are_values_or_steps(void **state)
{
    (void)state;
    cw_volume v =
        read_array("{'descr': '|u1', 'fortran_order': False, 'shape': (2, 2, 2, 3), }");
    assert_true(v.components == 3 && v.steps == 1 && v.dim[0] == 2);
    cw_volume_free(&v);
    v = read_array("{'descr': '|i1', 'fortran_order': False, 'shape': (2, 1, 2, 6), }");
    assert_true(v.components == 1 && v.steps == 2 && v.dim[0] == 6 && v.dim[1] == 2);
    cw_volume_free(&v);
}

static void types_and_versions_are_told_apart(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        cw_type type;
        const char *bytes;
        double value;
    } cases[] = {{"|i1", CW_I8, "\xfe", -2},
                 {"<u2", CW_U16, "\xfe\xff", 65534},
                 {">i2", CW_I16, "\xff\xfe", -2},
                 {"<u4", CW_U32, "\0\1\0\0", 256},
                 {">i4", CW_I32, "\xff\xff\xff\xfe", -2},
                 {"<f4", CW_F32, "\0\0\xc0\x3f", 1.5},
                 {">f8", CW_F64, "\x3f\xf8\0\0\0\0\0\0", 1.5}};
    for (size_t n = 0; n < sizeof cases / sizeof *cases; n++) {
        char text[120];
        cw_volume v;
        cw_error err = {0};
        snprintf(text, sizeof text,
                 "{'descr': '%s', 'fortran_order': False, 'shape': (1, 1, 1)}", cases[n].name);
        save("a.npy", 1 + (int)n % 3, text, cases[n].bytes, cw_type_size(cases[n].type));
        assert_ok(read_back("a.npy", &v, &err), err);
        assert_int_equal(v.type, cases[n].type);
        assert_true(cw_volume_value(&v, 0, 0, 0) == cases[n].value);
        cw_volume_free(&v);
    }
}

static void damaged_headers_are_told_key_by_key(void **state)
{
    (void)state;
    static const struct {
        const char *dictionary, *words;
    } cases[] = {
        {"{}", "'descr' is missing"},
        {"{'descr': [('a', '<f4')], 'fortran_order': False, 'shape': (1,1)}", "a structure"},
        {"{'descr': '<c8', 'fortran_order': False, 'shape': (1,1)}", "'descr' is <c8"},
        {"{'descr': '|u1', 'fortran_order': 0, 'shape': (1,1)}", "'fortran_order' is neither"},
        {"{'descr': '|u1', 'fortran_order': False}", "'shape' is no tuple"},
        {"{'descr': '|u1', 'fortran_order': False, 'shape': (2, x)}", "sizes were expected"},
        {"{'descr': '|u1', 'fortran_order': False, 'shape': (2, 3", "it does not end"},
        {"{'descr': '|u1', 'fortran_order': False, 'shape': (24,)}", "'shape' has 1 sizes"},
        {"{'descr': '|u1', 'fortran_order': False, 'shape': (1,1,1,2,12)}", "has 5 sizes"},
        {"{'descr': '|u1', 'fortran_order': False, 'shape': (2, 0, 3)}", "the array is empty"},
        {"{'descr': '|u1', 'fortran_order': False, 'shape': (2, -1, 3)}",
         "sizes were expected"},
        {"{'descr': '|u1', 'fortran_order': False, 'shape': (99999999999, 9, 9)}", "shape"},
    };
    for (size_t n = 0; n < sizeof cases / sizeof *cases; n++) {
        cw_volume v;
        cw_error err = {0};
        save("a.npy", 1, cases[n].dictionary, counting, sizeof counting);
        const cw_status st = read_back("a.npy", &v, &err);
        if (st == CW_OK || !strstr(err.message, cases[n].words))
            fail_msg("%s: %s", cases[n].dictionary, st == CW_OK ? "it was read" : err.message);
    }
    static const char lying[] = "\x93NUMPY\2\0\xff\xff\xff\x7f{'descr'";
    cw_volume v;
    cw_error err = {0};
    test_file_write(test_path("b.npy"), lying, sizeof lying - 1);
    assert_fails(read_back("b.npy", &v, &err), CW_ERR_FORMAT, "is said to have 2147483647",
                 err);
    static const char future[] = "\x93NUMPY\7\0\1\0{}";
    test_file_write(test_path("c.npy"), future, sizeof future - 1);
    assert_fails(read_back("c.npy", &v, &err), CW_ERR_FORMAT, "it has version 7", err);
}

static void a_cut_is_never_a_volume(void **state)
{
    (void)state;
    save("a.npy", 1, "{'descr': '<u2', 'fortran_order': False, 'shape': (2, 3, 2), }\n",
         counting, sizeof counting);
    check_every_cut("a.npy");
    check_regions("a.npy", NULL);
}

int main(void)
{
#define TEST(name) cmocka_unit_test_setup_teardown(name, test_folder_make, test_folder_remove)
    const struct CMUnitTest tests[] = {
        TEST(axes_are_z_y_x),
        TEST(four_axes_are_values_or_steps),
        TEST(types_and_versions_are_told_apart),
        TEST(damaged_headers_are_told_key_by_key),
        TEST(a_cut_is_never_a_volume),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
