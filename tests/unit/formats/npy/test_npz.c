/* Tests the reader of archives of NumPy's arrays: which array is taken, deflated and stored ones, and damage. */
#include "support/files/regions.h"
#include "support/files/zip.h"

enum { HEADER = 0x141, ARRAY = 10 + HEADER + 96 };

/* Makes an array of 8-bit numbers without a zero byte, as zip_make() takes text: of which the n-th is
 * first + n % 61. */
static void make_array(char text[ARRAY + 1], const char *shape, size_t count, int first)
{
    char header[HEADER + 1];
    memset(header, ' ', sizeof header);
    header[snprintf(header, sizeof header,
                    "{'descr': '|u1', 'fortran_order': False, 'shape': %s, }", shape)] = ' ';
    memcpy(text, "\x93NUMPY\1\1\x41\1", 10);
    memcpy(text + 10, header, HEADER);
    for (size_t n = 0; n < count; n++)
        text[10 + HEADER + n] = (char)(first + (int)n % 61);
    text[10 + HEADER + count] = '\0';
}

static void save(const zip *z, size_t size)
{
    test_file_write(test_path("a.npz"), z->bytes, size);
}

static void check_value(const char *array, size_t steps, double value)
{
    cw_volume v;
    cw_error err = {0};
    const char *format;
    const cw_read_desc desc = {.array = array};
    assert_ok(cw_volume_read(test_path("a.npz"), &desc, &v, &format, &err), err);
    assert_string_equal(format, "npz");
    assert_int_equal(v.steps, steps);
    assert_true(cw_volume_value(&v, 1, 1, 1) == value);
    cw_volume_free(&v);
}

static void arrays_of_networks_are_taken_first(void **state)
{
    (void)state;
    static zip z;
    char a[ARRAY + 1], b[ARRAY + 1], c[ARRAY + 1];
    make_array(a, "(2, 3, 4)", 24, 32);
    make_array(b, "(2, 2, 3, 8)", 96, 40);
    make_array(c, "(4, 2, 2, 6)", 96, 50);
    for (int deflated = 0; deflated < 2; deflated++) {
        const zip_entry entries[] = {{"x.npy", a, deflated},
                                     {"softmax.npy", b, deflated},
                                     {"note.txt", "text", false},
                                     {"probabilities.npy", c, deflated}};
        zip_make(&z, entries, 4);
        save(&z, z.size);
        check_value(NULL, 4, 50 + 12 + 6 + 1);
        check_value("x", 1, 32 + 12 + 4 + 1);
        check_value("softmax", 2, 40 + 24 + 8 + 1);
        cw_volume v;
        cw_error err = {0};
        assert_fails(
            cw_volume_read(test_path("a.npz"), &(cw_read_desc){.array = "y"}, &v, NULL, &err),
            CW_ERR_ARGUMENT,
            "there is no array 'y'; the archive has 3: 'x', 'softmax', "
            "'probabilities'",
            err);
        zip_make(&z, entries, 2);
        save(&z, z.size);
        check_value(NULL, 2, 40 + 24 + 8 + 1);
        check_regions("a.npz", NULL);
        zip_make(&z, entries, 1);
        save(&z, z.size);
        check_value(NULL, 1, 32 + 12 + 4 + 1);
    }
}

static void damage_is_told(void **state)
{
    (void)state;
    static zip z;
    char a[ARRAY + 1];
    cw_volume v;
    cw_error err = {0};
    make_array(a, "(2, 3, 4)", 24, 32);
    const zip_entry none[] = {{"a.txt", "text", false}};
    zip_make(&z, none, 1);
    save(&z, z.size);
    assert_fails(
        cw_volume_read(test_path("a.npz"), &(cw_read_desc){.reader = "npz"}, &v, NULL, &err),
        CW_ERR_FORMAT, "the archive holds no array", err);
    for (int deflated = 0; deflated < 2; deflated++) {
        const zip_entry entries[] = {{"x.npy", a, deflated}};
        zip_make(&z, entries, 1);
        for (size_t cut = 0; cut < z.size; cut += 7) {
            save(&z, cut);
            const cw_status st = cw_volume_read(test_path("a.npz"), NULL, &v, NULL, &err);
            assert_true(st == (cut ? CW_ERR_FORMAT : CW_ERR_IO));
            assert_null(v.data);
        }
    }
    zip_change(&z, z.local[0] + 14, 7, 4);
    zip_change(&z, z.central[0] + 16, 7, 4);
    save(&z, z.size);
    assert_fails(cw_volume_read(test_path("a.npz"), NULL, &v, NULL, &err), CW_ERR_FORMAT,
                 "checksum", err);
    make_array(a, "(200, 3, 4)", 24, 32);
    zip_make(&z, &(zip_entry){"x.npy", a, false}, 1);
    save(&z, z.size);
    assert_fails(cw_volume_read(test_path("a.npz"), NULL, &v, NULL, &err), CW_ERR_FORMAT,
                 "'shape' asks for 2400 bytes", err);
    make_array(a, "(2, 3", 24, 32);
    zip_make(&z, &(zip_entry){"x.npy", a, true}, 1);
    save(&z, z.size);
    assert_fails(cw_volume_read(test_path("a.npz"), NULL, &v, NULL, &err), CW_ERR_FORMAT,
                 "x.npy: 'shape' is", err);
}

static void memory_that_is_out_is_an_error(void **state)
{
    (void)state;
    static zip z;
    char a[ARRAY + 1];
    bool failed = true;
    make_array(a, "(2, 3, 4)", 24, 32);
    zip_make(&z, &(zip_entry){"x.npy", a, true}, 1);
    save(&z, z.size);
    for (long n = 0; failed; n++) {
        cw_volume v;
        cw_error err = {0};
        cwi_alloc_fail_after(n);
        const cw_status st = cw_volume_read(test_path("a.npz"), NULL, &v, NULL, &err);
        failed = cwi_alloc_fail_after(-1);
        assert_true(st == (failed ? CW_ERR_NO_MEMORY : CW_OK));
        cw_volume_free(&v);
    }
}

int main(void)
{
#define TEST(name) cmocka_unit_test_setup_teardown(name, test_folder_make, test_folder_remove)
    const struct CMUnitTest tests[] = {
        TEST(arrays_of_networks_are_taken_first),
        TEST(damage_is_told),
        TEST(memory_that_is_out_is_an_error),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
