/* TIFF read: the descriptions of ImageJ and OME. */
#include "support/files/tiff_cases.h"

static void imagej_says_which_page_is_what(void **state)
{
    (void)state;
    cw_volume v;
    save_described("a.tif",
                   "ImageJ=1.53t\nimages=12\nchannels=2\nslices=3\nframes=2\nhyperstack=true\n"
                   "unit=micron\nspacing=1.5\nfinterval=0.5\nloop=false\n",
                   12);
    read_good("a.tif", &v);
    assert_int_equal(v.dim[2], 3);
    assert_int_equal(v.components, 2);
    assert_int_equal(v.steps, 2);
    assert_true(v.step_seconds == 0.5);
    assert_int_equal(v.known, CW_KNOWN_UNIT);
    check_affine(
        &v, (const double[12]){0.2 * 1e-3, 0, 0, 0, 0, 0.25 * 1e-3, 0, 0, 0, 0, 1.5 * 1e-3, 0});
    for (size_t p = 0; p < 12; p++)
        assert_true(value_at(&v, (const size_t[3]){1, 2, p / 2 % 3}, p % 2, p / 6) ==
                    10 * (double)p + 9);
    cw_volume_free(&v);
}

static void imagej_names_units(void **state)
{
    (void)state;
    const struct {
        const char *unit;
        double mm;
    } cases[] = {
        {"um", 1e-3},          {"\\u00B5m", 1e-3}, {"\xc2\xb5m", 1e-3}, {"\xb5m", 1e-3},
        {"micron", 1e-3},      {"mm", 1},          {"cm", 10},          {"nm", 1e-6},
        {"inch", 25.4},        {"m", 1000},        {"pixel", 0},        {"", 0},
        {"furlong", 0},        {"\xc3\x85", 1e-7}, {"Angstrom", 1e-7},  {"angstroms", 1e-7},
        {"\\u00C5", 1e-7},     {"pm", 1e-9},       {"Microns", 1e-3},   {"inches", 25.4},
        {"Micrometers", 1e-3}, {"METRE", 1000}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[128];
        cw_volume v;
        snprintf(text, sizeof text, "ImageJ=1.53t\nimages=2\nunit=%s\nspacing=-3\n",
                 cases[i].unit);
        save_described("a.tif", text, 2);
        read_good("a.tif", &v);
        const double mm = cases[i].mm > 0 ? cases[i].mm : 1;
        assert_int_equal(v.known, cases[i].mm > 0 ? CW_KNOWN_UNIT : 0);
        assert_true((strstr(notes, "the unit 'furlong' is not known") != NULL) ==
                    (strcmp(cases[i].unit, "furlong") == 0));
        assert_near(v.affine[0][0], 0.2 * mm, 1e-12 * mm);
        assert_near(v.affine[1][1], 0.25 * mm, 1e-12 * mm);
        assert_near(v.affine[2][2], 3 * mm, 1e-12 * mm);
        cw_volume_free(&v);
    }
}

static void imagej_calibrates_values(void **state)
{
    (void)state;
    cw_volume v;
    save_described("a.tif", "ImageJ=1.53t\nimages=2\ncf=0\nc0=-32768.0\nc1=2.0\n", 2);
    read_good("a.tif", &v);
    assert_true(cw_volume_value(&v, 1, 0, 1) == 2.0 * 11 - 32768);
    cw_volume_free(&v);
    save_described("a.tif", "ImageJ=1.53t\nimages=2\ncf=0\nc0=-32768.0\nc1=1.0\n", 2);
    read_good("a.tif", &v); /* signed numbers, which ImageJ stores without a sign */
    assert_true(cw_volume_value(&v, 1, 0, 1) == 11 - 32768);
    cw_volume_free(&v);
    save_described("a.tif", "ImageJ=1.53t\nimages=2\ncf=3\nc0=1\nc1=2\n", 2);
    read_good("a.tif", &v);
    assert_non_null(strstr(notes, "calibration by function 3 is left out"));
    assert_true(cw_volume_value(&v, 1, 0, 1) == 11);
    cw_volume_free(&v);
}

/* Beyond 4 GiB ImageJ writes one directory, and all images behind its first. */
static void imagej_may_leave_directories_out(void **state)
{
    (void)state;
    for (int way = 0; way < 4; way++) {
        test_tiff t = {.high_first = way & 1};
        uint16_t pixels[5 * PIXELS];
        cw_volume v;
        for (size_t i = 0; i < 5 * PIXELS; i++)
            pixels[i] = (uint16_t)(1000 * i);
        const test_page page = {.columns = COLUMNS,
                                .rows = ROWS,
                                .bits = 16,
                                .rows_per_strip = way & 2 ? 1 : 0,
                                .description = "ImageJ=1.53t\nimages=5\n",
                                .pixels = pixels};
        test_tiff_add(&t, &page);
        /* its pixels once more, where others follow */
        const size_t at = test_tiff_put(&t, pixels, 5 * PIXELS, 2);
        if (way & 2) {
            const uint32_t strips[ROWS] = {(uint32_t)at, (uint32_t)at + 2 * COLUMNS,
                                           (uint32_t)at + 4 * COLUMNS};
            const size_t list = test_tiff_put(&t, strips, ROWS, 4);
            test_tiff_poke(&t, 273, TEST_TAG_VALUE, list);
        } else {
            test_tiff_poke(&t, 273, TEST_TAG_VALUE, at);
        }
        save(&t, "a.tif");
        read_good("a.tif", &v);
        assert_int_equal(v.dim[2], 5);
        for (size_t i = 0; i < 5 * PIXELS; i++)
            assert_true(cw_volume_value(&v, i % COLUMNS, i / COLUMNS % ROWS, i / PIXELS) ==
                        pixels[i]);
        cw_volume_free(&v);
    }
}

static void imagej_that_contradicts_the_file_is_not_believed(void **state)
{
    (void)state;
    const struct {
        const char *text;
        size_t pages;
        const char *words;
    } cases[] = {
        {"ImageJ=1\nimages=4\n", 3, "says images=4; the file holds 3 pages"},
        {"ImageJ=1\nimages=2\n", 3, "says images=2; the file holds 3 pages"},
        {"ImageJ=1\nimages=9\n", 1,
         "says images=9, which would be 108 bytes behind the first 8"},
        {"ImageJ=1\nimages=65536\n", 1, "says images=65536, which would be 786432 bytes"},
        {"ImageJ=1\nimages=0\n", 1, "says images=0; it must be 1 to 65536"},
        {"ImageJ=1\nimages=1e9\n", 1, "says images=1e+09; it must be"},
        {"ImageJ=1\nimages=3\nchannels=2\n", 3, "says 2 channels, 1 slices and 1 frames"},
        {"ImageJ=1\nimages=3\nslices=2\nframes=2\n", 3, "says 1 channels, 2 slices and 2"},
        {"ImageJ=1\nchannels=65536\nframes=65536\n", 1, "says 65536 channels, 0 slices"},
        {"ImageJ=1\nimages=3\norder=czz\n", 3, "says order=czz; c, z and t were expected"},
        {"ImageJ=1\nimages=3\norder=zctx\n", 3, "says order=zctx;"},
        {"ImageJ=1\nchannels=17\n", 17, "17 channels of 1 samples each; at most 16"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        save_described("a.tif", cases[i].text, cases[i].pages);
        check_told("a.tif", i, cases[i].words);
    }
}

static void resolution_alone_says_nothing_of_a_scan(void **state)
{
    (void)state;
    cw_volume v;
    cw_error err = {0};
    save_described("a.tif", "taken on a Tuesday", 2);
    read_good("a.tif", &v);
    assert_int_equal(v.known, 0);
    check_affine(&v, (const double[12]){1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0});
    assert_non_null(strstr(notes, "state pixels of 5.08 x 6.35 mm")); /* 5 and 4 per inch */
    cw_volume_free(&v);
    notes[0] = '\0';
    assert_ok(read_with("a.tif", (cw_read_desc){.spacing_mm = {0.5, 0.5, 2}}, &v, &err), err);
    assert_int_equal(v.known, CW_KNOWN_UNIT);
    check_affine(&v, (const double[12]){0.5, 0, 0, 0, 0, 0.5, 0, 0, 0, 0, 2, 0});
    assert_null(strstr(notes, "state pixels"));
    cw_volume_free(&v);
}

/* --- OME ---------------------------------------------------------------------------------- */

static void ome_says_which_page_is_what(void **state)
{
    (void)state;
    static const char *const orders[] = {"XYZCT", "XYZTC", "XYCZT", "XYCTZ", "XYTZC", "XYTCZ"};
    for (size_t n = 0; n < 6; n++) {
        char text[1024];
        cw_volume v;
        snprintf(text, sizeof text,
                 OME_HEAD "<Pixels DimensionOrder=\"%s\" SizeX=\"4\" SizeY=\"3\" SizeZ=\"3\" "
                          "SizeC=\"2\" SizeT=\"2\" PhysicalSizeX=\"0.5\" "
                          "PhysicalSizeY=\"400\" PhysicalSizeYUnit=\"nm\" PhysicalSizeZ=\"2\" "
                          "PhysicalSizeZUnit=\"\xc2\xb5m\" TimeIncrement=\"250\" "
                          "TimeIncrementUnit=\"ms\">%s" OME_TAIL,
                 orders[n], n % 2 ? "<TiffData/>" : "");
        save_described("a.tif", text, 12);
        read_good("a.tif", &v);
        assert_int_equal(v.dim[2], 3);
        assert_int_equal(v.components, 2);
        assert_int_equal(v.steps, 2);
        assert_true(v.step_seconds == 0.25);
        assert_int_equal(v.known, CW_KNOWN_UNIT);
        assert_near(v.affine[0][0], 0.5e-3, 1e-15);
        assert_near(v.affine[1][1], 0.4e-3, 1e-15);
        assert_near(v.affine[2][2], 2e-3, 1e-15);
        for (size_t p = 0; p < 12; p++) {
            size_t rest = p, at[128] = {0};
            for (const char *axis = orders[n] + 2; *axis; axis++) {
                const size_t size = *axis == 'Z' ? 3 : 2;
                at[(int)*axis] = rest % size;
                rest /= size;
            }
            assert_true(value_at(&v, (const size_t[3]){0, 0, at['Z']}, at['C'], at['T']) ==
                        10 * (double)p);
        }
        cw_volume_free(&v);
    }
}

/* Planes may stand in any order, and in fewer pages than there are. */
static void ome_places_pages_one_by_one(void **state)
{
    (void)state;
    cw_volume v;
    save_described("a.tif",
                   OME_HEAD "<Pixels DimensionOrder=\"XYCZT\" SizeX=\"4\" SizeY=\"3\" "
                            "SizeZ=\"3\" SizeC=\"1\" SizeT=\"1\">"
                            "<TiffData IFD=\"3\" FirstZ=\"0\"><UUID FileName=\"a.ome.tif\">u"
                            "</UUID></TiffData>"
                            "<TiffData IFD=\"1\" FirstZ=\"1\" PlaneCount=\"2\"><UUID "
                            "FileName=\"a.ome.tif\">u</UUID></TiffData>" OME_TAIL,
                   5);
    read_good("a.tif", &v);
    assert_int_equal(v.dim[2], 3);
    assert_true(cw_volume_value(&v, 0, 0, 0) == 30);
    assert_true(cw_volume_value(&v, 0, 0, 1) == 10);
    assert_true(cw_volume_value(&v, 0, 0, 2) == 20);
    assert_non_null(strstr(notes, "left out, as the OME-XML has no place for them: 2 pages"));
    assert_int_equal(v.known, 0);
    cw_volume_free(&v);
}

static void ome_without_all_sizes_has_no_unit(void **state)
{
    (void)state;
    cw_volume v;
    save_described("a.tif",
                   OME_HEAD "<Pixels DimensionOrder=\"XYCZT\" SizeX=\"4\" SizeY=\"3\" "
                            "SizeZ=\"3\" SizeC=\"1\" SizeT=\"1\" PhysicalSizeX=\"0.5\" "
                            "PhysicalSizeY=\"0.5\">" OME_TAIL,
                   3);
    read_good("a.tif", &v);
    assert_int_equal(v.known, 0);
    check_affine(&v, (const double[12]){0.5, 0, 0, 0, 0, 0.5, 0, 0, 0, 0, 1, 0});
    assert_non_null(strstr(notes, "does not say all sizes of a voxel"));
    cw_volume_free(&v);
}

/* A pixel of three samples is one channel of OME's three. */
static void ome_counts_samples_as_channels(void **state)
{
    (void)state;
    test_tiff t = {0};
    unsigned char pixels[3 * PIXELS];
    cw_volume v;
    for (size_t i = 0; i < sizeof pixels; i++)
        pixels[i] = (unsigned char)i;
    test_tiff_add(&t, &(test_page){.columns = COLUMNS,
                                   .rows = ROWS,
                                   .samples = 3,
                                   .photometric = 2,
                                   .description = OME_HEAD
                                   "<Pixels DimensionOrder=\"XYCZT\" SizeX=\"4\" SizeY=\"3\" "
                                   "SizeZ=\"1\" SizeC=\"3\" SizeT=\"1\">" OME_TAIL,
                                   .pixels = pixels});
    save(&t, "a.tif");
    read_good("a.tif", &v);
    assert_int_equal(v.components, 3);
    assert_true(value_at(&v, (const size_t[3]){1, 0, 0}, 2, 0) == 5);
    cw_volume_free(&v);
}

static void ome_that_contradicts_the_file_is_not_believed(void **state)
{
    (void)state;
    static char deep[8192] = OME_HEAD OME_SIZES ">";
    for (int i = 0; i < 100; i++)
        strcat(deep, "<a><!-- -->");
    const struct {
        const char *text, *words;
    } cases[] = {
        {OME_HEAD OME_SIZES ">", "of the OME-XML is not XML: no element found"},
        {OME_HEAD OME_SIZES "><b></a>", "is not XML: mismatched tag"},
        {"<OME>", "is not XML"},
        {"<OME></OME>", "the OME-XML describes no image"},
        {"<!DOCTYPE a [<!ENTITY b \"c\">]><OME></OME>", "document type (<!DOCTYPE>)"},
        {deep, "more than 1048576 elements, or 64 inside each other"},
        {"<OME><BinaryOnly MetadataFile=\"a\"/></OME>", "the OME-XML is in another file"},
        {OME_HEAD OME_SIZES "><TiffData><UUID FileName=\"a\"/></TiffData><TiffData>" OME_TAIL,
         "two pages for slice 0, channel 0, step 0"},
        {OME_HEAD OME_SIZES "><TiffData IFD=\"0\"><UUID FileName=\"a\"/></TiffData><TiffData "
                            "IFD=\"1\" FirstZ=\"1\"><UUID FileName=\"b\"/></TiffData>" OME_TAIL,
         "spreads its planes over several files"},
        {OME_HEAD OME_SIZES "><TiffData IFD=\"0\"/>" OME_TAIL,
         "names no page for slice 1, channel 0, step 0"},
        {OME_HEAD OME_SIZES "><TiffData IFD=\"11\" PlaneCount=\"2\"/>" OME_TAIL,
         "has a plane in directory 13; of the file's 12"},
        {OME_HEAD OME_SIZES "><TiffData IFD=\"0\" FirstT=\"2\"/>" OME_TAIL,
         "a plane for slice 0, channel 0, step 2, and sizes of 3, 2, 2"},
        {OME_HEAD OME_SIZES "><TiffData PlaneCount=\"2000000000\"/>" OME_TAIL,
         "a plane for slice 0, channel 0, step 2"},
        {OME_HEAD OME_SIZES "><TiffData IFD=\"-1\"/>" OME_TAIL, "'TiffData' of the OME-XML"},
        {OME_HEAD "<Pixels DimensionOrder=\"XYZZT\" SizeX=\"4\" SizeY=\"3\"/></Image></OME>",
         "'DimensionOrder' of the OME-XML is 'XYZZT'"},
        {OME_HEAD "<Pixels DimensionOrder=\"XYZCT\" SizeX=\"4\" SizeY=\"4\"/></Image></OME>",
         "'SizeX' and 'SizeY' of the OME-XML are 4 x 4; the first page is 4 x 3"},
        {OME_HEAD "<Pixels DimensionOrder=\"XYZCT\" SizeX=\"4\" SizeY=\"3\" SizeZ=\"65536\" "
                  "SizeC=\"65536\" SizeT=\"1\"/></Image></OME>",
         "are 65536, 65536 and 1, pages of 1 samples; at most 65536"},
        {OME_HEAD OME_SIZES "PhysicalSizeX=\"0\"/></Image></OME>",
         "'PhysicalSizeX' of the OME-XML is '0'"},
        {OME_HEAD OME_SIZES "PhysicalSizeX=\"inf\" PhysicalSizeY=\"1\"/></Image></OME>",
         "gives axis 0 a spacing of inf"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        save_described("a.tif", cases[i].text, 12);
        check_told("a.tif", i, cases[i].words);
    }
}

int main(void)
{
#define TEST(name) cmocka_unit_test_setup_teardown(name, test_folder_make, test_folder_remove)
    const struct CMUnitTest tests[] = {
        TEST(imagej_says_which_page_is_what),
        TEST(imagej_names_units),
        TEST(imagej_calibrates_values),
        TEST(imagej_may_leave_directories_out),
        TEST(imagej_that_contradicts_the_file_is_not_believed),
        TEST(resolution_alone_says_nothing_of_a_scan),
        TEST(ome_says_which_page_is_what),
        TEST(ome_places_pages_one_by_one),
        TEST(ome_without_all_sizes_has_no_unit),
        TEST(ome_counts_samples_as_channels),
        TEST(ome_that_contradicts_the_file_is_not_believed),
    };
    if (!cwi_module_present("tiff")) {
        puts("this build reads no TIFF");
        return 0;
    }
    return cmocka_run_group_tests(tests, NULL, NULL);
}
