/* TIFF read: orders of pages, descriptions of tifffile, several images of OME, numbers of 64 and 16 bits,
 * and values of no data. */
#include "formats/bytes/stored_numbers.h"
#include "support/files/tiff_cases.h"

#include <math.h>

/* --- orders of pages ---------------------------------------------------------------------- */

/* ImageJ names the axes of pages, the fastest first. */
static void imagej_may_state_another_order(void **state)
{
    (void)state;
    static const char *const orders[] = {"zct", "ztc", "czt", "ctz", "tcz", "tzc"};
    static const size_t sizes[128] = {['c'] = 2, ['z'] = 3, ['t'] = 2};
    for (size_t n = 0; n < 12; n++) {
        const char *order = orders[n % 6];
        char text[160];
        cw_volume v;
        snprintf(text, sizeof text,
                 "ImageJ=1.53t\nimages=12\nchannels=2\nslices=3\nframes=2\norder=%s%s\n",
                 n < 6 ? "" : "XY", order);
        save_described("a.tif", text, 12);
        read_good("a.tif", &v);
        assert_true(v.dim[2] == 3 && v.components == 2 && v.steps == 2);
        for (size_t p = 0; p < 12; p++) {
            size_t at[128] = {0}, rest = p;
            for (const char *axis = order; *axis; axis++) {
                at[(size_t)*axis] = rest % sizes[(size_t)*axis];
                rest /= sizes[(size_t)*axis];
            }
            assert_true(value_at(&v, (const size_t[3]){0, 0, at['z']}, at['c'], at['t']) ==
                        10 * (double)p);
        }
        cw_volume_free(&v);
    }
}

static void tifffile_states_the_shape_of_all_pages(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        size_t slices, components, steps;
        const char *note; /* NULL: none */
    } cases[] = {
        {"{\"shape\": [12, 3, 4]}", 12, 1, 1, NULL},
        {"{\"shape\": [2, 6, 3, 4]}", 6, 1, 2, "taken as 2 steps of 6 slices"},
        {"{\"shape\": [1, 2, 1, 6, 3, 4]}", 6, 1, 2, "taken as 2 steps of 6 slices"},
        {"{\"shape\": [2, 2, 3, 3, 4, 1]}", 3, 1, 4, "taken as 4 steps of 3 slices"},
        {"{\"shape\": [2, 2, 3, 3, 4], \"axes\": \"TCZYX\"}", 3, 2, 2,
         "taken as 2 steps of 2 components of 3 slices"},
        {"{\"axes\": \"ZCYX\", \"shape\": [6, 2, 3, 4]}", 6, 2, 1,
         "taken as 2 components of 6 slices"},
        {"{\"shape\": [5, 3, 4]}", 5, 1, 1, "left out: 7 pages"},
        {"{\"shape\": [12, 4, 3]}", 12, 1, 1, "is not that of the 12 pages"},
        {"{\"shape\": [3, 5, 3, 4]}", 12, 1, 1, "is not that of the 12 pages"},
    };
    for (size_t n = 0; n < sizeof cases / sizeof *cases; n++) {
        cw_volume v;
        save_described("a.tif", cases[n].text, 12);
        read_good("a.tif", &v);
        if (v.dim[2] != cases[n].slices || v.components != cases[n].components ||
            v.steps != cases[n].steps)
            fail_msg("case %zu: %zu slices, %zu components, %zu steps", n, v.dim[2],
                     v.components, v.steps);
        assert_true(strstr(notes, cases[n].note ? cases[n].note : "") != NULL);
        assert_true(cases[n].note || !strstr(notes, "shape"));
        for (size_t p = 0; n < 4 && p < 12; p++)
            assert_true(value_at(&v, (const size_t[3]){0, 0, p % v.dim[2]}, 0, p / v.dim[2]) ==
                        10 * (double)p);
        cw_volume_free(&v);
    }
    save_described("a.tif", "{\"axes\": \"ZCYX\", \"shape\": [6, 2, 3, 4]}", 12);
    cw_volume v;
    read_good("a.tif", &v);
    for (size_t p = 0; p < 12; p++)
        assert_true(value_at(&v, (const size_t[3]){0, 0, p / 2}, p % 2, 0) == 10 * (double)p);
    cw_volume_free(&v);
    save_described("a.tif", "{\"shape\": [2, many]}", 2);
    check_told("a.tif", 0, "the 'shape' of tifffile was expected");
    save_described("a.tif", "{\"shape\": 7}", 2);
    check_told("a.tif", 1, "the 'shape' of tifffile was expected");
}

/* --- several images ----------------------------------------------------------------------- */

/* Two pages of 4 x 3, then three of 2 x 5. */
static void save_images(const char *xml)
{
    static const unsigned char small[10] = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10};
    test_tiff t = {0};
    add_bytes(&t, (test_page){.description = xml}, 100);
    add_bytes(&t, (test_page){0}, 200);
    for (int p = 0; p < 3; p++) {
        const test_page page = {.columns = 2, .rows = 5, .pixels = small};
        test_tiff_add(&t, &page);
    }
    save(&t, "a.ome.tif");
}

#define FIRST                                                                                  \
    "<OME><Image ID=\"Image:0\" Name=\"large\"><Pixels DimensionOrder=\"XYZCT\" SizeX=\"4\" "  \
    "SizeY=\"3\" SizeZ=\"2\" SizeC=\"1\" SizeT=\"1\"><TiffData IFD=\"0\" "                     \
    "PlaneCount=\"2\"/></Pixels></Image>"
#define SECOND(ifd)                                                                            \
    "<Image ID=\"Image:1\" Name=\"small\"><Pixels DimensionOrder=\"XYZCT\" SizeX=\"2\" "       \
    "SizeY=\"5\" SizeZ=\"3\" SizeC=\"1\" SizeT=\"1\" PhysicalSizeX=\"2\" PhysicalSizeY=\"3\" " \
    "PhysicalSizeZ=\"4\" PhysicalSizeXUnit=\"mm\" PhysicalSizeYUnit=\"mm\" "                   \
    "PhysicalSizeZUnit=\"mm\"><TiffData IFD=\"" ifd                                            \
    "\" PlaneCount=\"3\"/></Pixels></Image></OME>"

static void ome_may_have_several_images(void **state)
{
    (void)state;
    static const char *const seconds[] = {"small", "2"};
    cw_volume v;
    cw_error err = {0};
    cw_array *arrays;
    size_t count;
    save_images(FIRST SECOND("2"));
    read_good("a.ome.tif", &v);
    assert_true(v.dim[0] == 4 && v.dim[2] == 2 && cw_volume_value(&v, 0, 0, 1) == 200);
    assert_string_equal(notes, "the array 'large' is taken; desc->array takes 'small'\n");
    cw_volume_free(&v);
    for (int n = 0; n < 2; n++) {
        assert_ok(read_with("a.ome.tif", (cw_read_desc){.array = seconds[n]}, &v, &err), err);
        assert_true(v.dim[0] == 2 && v.dim[1] == 5 && v.dim[2] == 3);
        assert_true(cw_volume_value(&v, 1, 4, 2) == 10 && v.known == CW_KNOWN_UNIT);
        check_affine(&v, (const double[12]){2, 0, 0, 0, 0, 3, 0, 0, 0, 0, 4, 0});
        cw_volume_free(&v);
    }
    check_regions("a.ome.tif", &(cw_read_desc){.array = "small"});
    assert_fails(read_with("a.ome.tif", (cw_read_desc){.array = "none"}, &v, &err),
                 CW_ERR_ARGUMENT, "there is no image 'none'; the file has 2: 'large', 'small'",
                 err);
    assert_ok(cw_arrays_list(test_path("a.ome.tif"), NULL, &arrays, &count, &err), err);
    assert_int_equal(count, 2);
    assert_true(arrays[0].is_default && strcmp(arrays[1].name, "small") == 0);
    cw_arrays_free(arrays);
    save_images(FIRST SECOND("1")); /* its first page is one of the other's */
    assert_fails(read_with("a.ome.tif", (cw_read_desc){.array = "small"}, &v, &err),
                 CW_ERR_FORMAT, "are 2 x 5; the first page is 4 x 3", err);
    save_images(FIRST SECOND("7"));
    assert_fails(read_with("a.ome.tif", (cw_read_desc){.array = "small"}, &v, &err),
                 CW_ERR_FORMAT, "OME-XML", err);
    save_images("<OME><Image ID=\"Image:0\"><Pixels DimensionOrder=\"XYZCT\" SizeX=\"4\" "
                "SizeY=\"3\" SizeZ=\"2\" SizeC=\"1\" SizeT=\"1\"><TiffData IFD=\"0\" "
                "PlaneCount=\"2\"/></Pixels></Image><Image ID=\"Image:1\" Name=\"\"/></OME>");
    read_good("a.ome.tif", &v);
    assert_string_equal(notes, "the array 'image 1' is taken; desc->array takes 'image 2'\n");
    cw_volume_free(&v);
    save_slice("plain.tif", 1);
    assert_fails(read_with("plain.tif", (cw_read_desc){.array = "a"}, &v, &err),
                 CW_ERR_ARGUMENT, "there is no image 'a'; the file has 0", err);
}

/* --- numbers ------------------------------------------------------------------------------ */

static void numbers_of_64_and_16_bits_are_read(void **state)
{
    (void)state;
    for (int way = 0; way < 12; way++) { /* the byte order, planes apart, the form */
        const cwi_stored stored = way / 4 == 0   ? CWI_STORED_I64
                                  : way / 4 == 1 ? CWI_STORED_U64
                                                 : CWI_STORED_F16;
        const double first = stored == CWI_STORED_U64 ? 4294967295.0 - 23 : -12;
        int64_t wide[2 * PIXELS];
        uint16_t half[2 * PIXELS];
        test_tiff t = {.high_first = way & 1};
        cw_volume v;
        for (int i = 0; i < 2 * PIXELS; i++) {
            wide[i] = (int64_t)first + i;
            half[i] = cwi_stored_half(first + i);
        }
        const test_page page = {.columns = COLUMNS,
                                .rows = ROWS,
                                .samples = 2,
                                .separate = way & 2,
                                .bits = stored == CWI_STORED_F16 ? 16 : 64,
                                .format = stored == CWI_STORED_F16   ? 3
                                          : stored == CWI_STORED_I64 ? 2
                                                                     : 1,
                                .pixels = stored == CWI_STORED_F16 ? (const void *)half : wide};
        test_tiff_add(&t, &page);
        save(&t, "a.tif");
        read_good("a.tif", &v);
        assert_int_equal(v.type, cwi_stored_type(stored));
        for (size_t i = 0; i < 2 * PIXELS; i++)
            assert_true(value_at(&v, (const size_t[3]){i / 2 % COLUMNS, i / 2 / COLUMNS, 0},
                                 i % 2, 0) == first + (double)i);
        cw_volume_free(&v);
    }
    int64_t wide[PIXELS] = {[7] = 1LL << 40};
    const test_page page = {
        .columns = COLUMNS, .rows = ROWS, .bits = 64, .format = 2, .pixels = wide};
    test_tiff t = {0};
    test_tiff_add(&t, &page);
    save(&t, "a.tif");
    check_told("a.tif", 0, "a number is 1099511627776 (int64)");
}

/* As GDAL states it. A value that no pixel can have is left out. */
static void a_value_of_no_data_is_stated(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        uint16_t photometric;
        double nodata; /* below 0: none */
    } cases[] = {{"7", 0, 7},    {"3 ", 0, 3},   {"4.0", 0, 4},   {"-9999", 0, -1},
                 {"2.5", 0, -1}, {"nan", 0, -1}, {"none", 0, -1}, {"5", 100, 250}};
    for (size_t n = 0; n < sizeof cases / sizeof *cases; n++) {
        test_tiff t = {0};
        cw_volume v;
        add_bytes(&t,
                  (test_page){
                      .photometric = cases[n].photometric,
                      .tags = {{42113, 2, (uint32_t)strlen(cases[n].text) + 1, cases[n].text}}},
                  1);
        save(&t, "a.tif");
        read_good("a.tif", &v);
        assert_int_equal(v.has_nodata, cases[n].nodata >= 0);
        assert_true(!v.has_nodata || v.nodata == cases[n].nodata);
        cw_volume_free(&v);
    }
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, test_folder_make, test_folder_remove)

int main(void)
{
    static const struct CMUnitTest tests[] = {
        TEST(imagej_may_state_another_order), TEST(tifffile_states_the_shape_of_all_pages),
        TEST(ome_may_have_several_images),    TEST(numbers_of_64_and_16_bits_are_read),
        TEST(a_value_of_no_data_is_stated),
    };
    if (!cwi_module_present("tiff")) {
        puts("this build reads no TIFF");
        return 0;
    }
    return cmocka_run_group_tests(tests, NULL, NULL);
}
