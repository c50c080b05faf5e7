/* Tests the reader of raw voxels: layouts from text, offsets, sizes, and slices in files of
 * their own. */
#include "support/files/reading.h"
#include "support/files/regions.h"

#include <math.h>

#include <stdio.h>
#include <sys/stat.h>

static void a_layout_is_read_from_text(void **state)
{
    (void)state;
    cw_raw_layout l;
    cw_error err = {0};
    assert_ok(cw_raw_layout_parse("dims=512x256x3,type=u16be,offset=62,spacing=0.5x0.25x1mm,"
                                  "components=2,steps=4",
                                  &l, &err),
              err);
    assert_int_equal(l.dim[0], 512);
    assert_int_equal(l.dim[2], 3);
    assert_int_equal(l.type, CW_U16);
    assert_true(l.big_endian);
    assert_int_equal(l.offset, 62);
    assert_true(l.spacing[1] == 0.25);
    assert_int_equal(l.components, 2);
    assert_int_equal(l.steps, 4);
}

/* Sizes and lengths by 'x' or by commas. */
static void triples_are_parted_by_either(void **state)
{
    (void)state;
    static const char *const texts[] = {"dims=4x5x6,type=u8,spacing=0.5x0.25x1mm",
                                        "dims=4,5,6,type=u8,spacing=0.5,0.25,1mm",
                                        "spacing=0.5,0.25,1mm,dims=4x5x6,type=u8,"};
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        cw_raw_layout l;
        cw_error err = {0};
        assert_ok(cw_raw_layout_parse(texts[i], &l, &err), err);
        assert_true(l.dim[0] == 4 && l.dim[1] == 5 && l.dim[2] == 6 && l.type == CW_U8);
        assert_true(l.spacing[0] == 0.5 && l.spacing[1] == 0.25 && l.spacing[2] == 1);
    }
}

static void every_type_is_known_by_name(void **state)
{
    (void)state;
    for (int type = 0; type < CW_TYPE_COUNT; type++)
        for (int order = 0; order < 3; order++) {
            char text[64] = "type=";
            cw_raw_layout l;
            cw_error err = {0};
            strcat(text, cw_type_name((cw_type)type));
            strcat(text, (const char *const[]){"", "le", "be"}[order]);
            strcat(text, ",dims=1x1x1");
            assert_ok(cw_raw_layout_parse(text, &l, &err), err);
            assert_int_equal(l.type, type);
            assert_int_equal(l.big_endian, order == 2);
        }
}

static void wrong_keys_are_named(void **state)
{
    (void)state;
    const struct {
        const char *text, *words;
    } cases[] = {
        {"", "'dims' is missing"},
        {"dims=1x1x1", "'type' is missing"},
        {"dims=1x1,type=u8", "'dims' is '1x1'"},
        {"dims=1,1,type=u8", "'dims' is '1,1'"},
        {"dims=1x1,1,type=u8", "'dims' is '1x1,1'"},
        {"dims=0x10x10,type=u8", "'dims' is '0x10x10'"},
        {"dims=1,1,1,type=u8,spacing=1,1,1,1mm", "'spacing' is '1,1,1,1mm'"},
        {"dims=1x1x1,type=u8,offset", "'offset' needs a value"},
        {"dims=1x1x0,type=u8", "'dims' is '1x1x0'"},
        {"dims=1x1x1x1,type=u8", "'dims' is '1x1x1x1'"},
        {"dims=1x1x2147483648,type=u8", "'dims' is '1x1x2147483648'"},
        {"dims=1x1x1,type=u128", "'type' is u128; the types that are read are u8"},
        {"dims=1x1x1,type=u8x", "'type' is u8x"},
        {"dims=1x1x1,type=u8,offset=-1", "'offset' is '-1'"},
        {"dims=1x1x1,type=u8,spacing=1x0x1mm", "'spacing' is '1x0x1mm'"},
        {"dims=1x1x1,type=u8,spacing=1xnanx1mm", "'spacing' is '1xnanx1mm'"},
        {"dims=1x1x1,type=u8,components=17", "'components' is '17'"},
        {"dims=1x1x1,type=u8,steps=0", "'steps' is '0'"},
        {"dims=1x1x1,type=u8,size=3", "'size' is not a key of a layout"},
        {"dims=1x1x1,dims=1x1x1", "'dims' is given twice"},
        {"dims", "'dims' needs a value"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        cw_raw_layout l = {.steps = 77};
        cw_error err = {0};
        assert_fails(cw_raw_layout_parse(cases[i].text, &l, &err), CW_ERR_ARGUMENT,
                     cases[i].words, err);
        assert_int_equal(l.steps, 77);
    }
}

static void bytes_behind_an_offset_become_voxels(void **state)
{
    (void)state;
    const cw_raw_layout layout = {.dim = {2, 1, 1},
                                  .type = CW_U16,
                                  .big_endian = true,
                                  .offset = 3,
                                  .spacing = {2, 3, 4}};
    const cw_read_desc desc = {.raw = &layout};
    cw_volume v;
    cw_error err = {0};
    const char *format = NULL;
    put_file("a.bin", "abc", "\1\2\3\4", 4);
    assert_ok(cw_volume_read(test_path("a.bin"), &desc, &v, &format, &err), err);
    assert_string_equal(format, "raw");
    assert_true(cw_volume_value(&v, 0, 0, 0) == 0x0102);
    assert_true(cw_volume_value(&v, 1, 0, 0) == 0x0304);
    assert_int_equal(v.known, CW_KNOWN_UNIT);
    check_affine(&v, (const double[12]){2, 0, 0, 0, 0, 3, 0, 0, 0, 0, 4, 0});
    check_regions("a.bin", &desc);
    cw_volume_free(&v);
}

static void spacings_must_be_lengths(void **state)
{
    (void)state;
    static const struct {
        double spacing;
        const char *words;
    } cases[] = {{0, "'spacing' gives axis 1 no length"},
                 {NAN, "'spacing' has numbers that are not finite"},
                 {INFINITY, "'spacing' has numbers that are not finite"}};
    put_file("a.bin", "", "12", 2);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const cw_raw_layout layout = {.dim = {2, 1, 1}, .spacing = {1, cases[i].spacing, 1}};
        const cw_read_desc desc = {.raw = &layout};
        cw_volume v;
        cw_error err = {0};
        assert_fails(cw_volume_read(test_path("a.bin"), &desc, &v, NULL, &err), CW_ERR_FORMAT,
                     cases[i].words, err);
    }
}

static void a_layout_larger_than_the_file_fails(void **state)
{
    (void)state;
    cw_raw_layout layout = {.dim = {2, 1, 1}, .type = CW_U16, .offset = 3};
    const cw_read_desc desc = {.raw = &layout}, no_layout = {.reader = "raw"};
    cw_volume v;
    cw_error err = {0};
    put_file("a.bin", "abc", "\1\2\3", 3);
    assert_fails(cw_volume_read(test_path("a.bin"), &desc, &v, NULL, &err), CW_ERR_FORMAT,
                 "'dims' asks for 4 bytes of voxels; the file holds 3 bytes behind the first 3",
                 err);
    layout.offset = UINT64_MAX;
    assert_fails(cw_volume_read(test_path("a.bin"), &desc, &v, NULL, &err), CW_ERR_FORMAT,
                 "the file holds 0 bytes", err);
    layout.dim[0] = layout.dim[1] = layout.dim[2] = INT32_MAX;
    assert_fails(cw_volume_read(test_path("a.bin"), &desc, &v, NULL, &err), CW_ERR_LIMIT,
                 "'dims' asks for more voxels than an address space holds", err);
    layout.dim[0] = 0;
    assert_fails(cw_volume_read(test_path("a.bin"), &desc, &v, NULL, &err), CW_ERR_ARGUMENT,
                 "'dims' holds 0", err);
    assert_fails(cw_volume_read(test_path("a.bin"), &no_layout, &v, NULL, &err),
                 CW_ERR_ARGUMENT, "'raw' needs a layout", err);
}

/* Two pixels a slice: 10 n and 10 n + 1. */
static void save_slice(const char *folder, const char *ending, int number)
{
    char name[64];
    const unsigned char bytes[4] = {0, (unsigned char)(10 * number), 0,
                                    (unsigned char)(10 * number + 1)};
    snprintf(name, sizeof name, "%s/q.%d%s", folder, number, ending);
    put_file(name, "", bytes, sizeof bytes);
}

static cw_status read_layout(const char *path, const char *text, cw_volume *v, cw_error *err)
{
    cw_raw_layout l;
    assert_ok(cw_raw_layout_parse(text, &l, err), *err);
    const cw_read_desc desc = {.raw = &l};
    return cw_volume_read(test_path(path), &desc, v, NULL, err);
}

static void slices_may_have_files_of_their_own(void **state)
{
    (void)state;
    static const char *const paths[] = {"s", "s/q.*", "s/q.[0-9]*"};
    cw_volume v;
    cw_error err = {0};
    assert_int_equal(mkdir(test_path("s"), 0700), 0);
    for (int n = 8; n <= 12; n++)
        save_slice("s", "", n);
    for (int i = 0; i < 3; i++) {
        assert_ok(read_layout(paths[i], "dims=2x1x5,type=u16be", &v, &err), err);
        for (size_t z = 0; z < 5; z++)
            assert_true(cw_volume_value(&v, 1, 0, z) == 10 * (double)(z + 8) + 1);
        cw_volume_free(&v);
    }
    assert_ok(read_layout("s", "dims=2x1x1,type=u16be,steps=5", &v, &err), err);
    assert_int_equal(v.steps, 5);
    cw_volume_free(&v);
    assert_fails(read_layout("s", "dims=2x1x4,type=u16be", &v, &err), CW_ERR_FORMAT,
                 "'dims' asks for 4 slices; there are 5 files", err);
    assert_ok(read_layout("s", "dims=2x1x10,type=u8", &v, &err), err); /* two in each */
    assert_true(cw_volume_value(&v, 1, 0, 3) == 91);
    cw_volume_free(&v);
    assert_fails(read_layout("s", "dims=2x1x10,type=u16be", &v, &err), CW_ERR_FORMAT,
                 "q.8: 'dims' asks for 8 bytes of voxels in each file; the file holds 4", err);
    save_slice("s", "b", 9);
    assert_fails(read_layout("s", "dims=2x1x5,type=u16be", &v, &err), CW_ERR_FORMAT,
                 "'dims' asks for 5 slices; there are 6 files", err);
    assert_fails(read_layout("s/r*", "dims=2x1x5,type=u16be", &v, &err), CW_ERR_IO,
                 "no file matches", err);
}

int main(void)
{
#define TEST(name) cmocka_unit_test_setup_teardown(name, test_folder_make, test_folder_remove)
    const struct CMUnitTest tests[] = {
        TEST(a_layout_is_read_from_text),           TEST(triples_are_parted_by_either),
        TEST(every_type_is_known_by_name),          TEST(wrong_keys_are_named),
        TEST(bytes_behind_an_offset_become_voxels), TEST(spacings_must_be_lengths),
        TEST(a_layout_larger_than_the_file_fails),  TEST(slices_may_have_files_of_their_own),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
