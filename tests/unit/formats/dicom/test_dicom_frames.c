/* DICOM read: objects of several frames, and mosaics. */
#include "support/files/dicom_cases.h"

/* --- objects of several frames ----------------------------------------------------------- */

static void frames_have_a_place_each(void **state)
{
    (void)state;
    const frame frames[] = {{"0\\0\\6", "2", 0}, {"0\\0\\2", "2", 0}, {"0\\0\\4", "2", 0}};
    uint8_t pixels[3 * PIXELS];
    for (int n = 0; n < 3 * PIXELS; n++)
        pixels[n] = (uint8_t)n;
    write_frames("frames.dcm", ENHANCED_CT, frames, 3, pixels, sizeof pixels);
    cw_volume v = read_all(NULL);
    static const int order[] = {1, 2, 0};
    assert_true(v.dim[2] == 3 && v.type == CW_U8 && v.slope == 2 && v.intercept == 1);
    check_affine(&v, (const double[]){0.25, 0, 0, 0, 0, 0.5, 0, 0, 0, 0, 2, 2});
    for (size_t k = 0; k < 3; k++)
        assert_near(cw_volume_value(&v, 1, 0, k), 2 * (order[k] * PIXELS + 1) + 1, 0);
    cw_volume_free(&v);
}

/* Bits follow each other without a gap: 12 a frame. Two segments, one slice between
 * left out. */
static void segments_become_labels(void **state)
{
    (void)state;
    const frame frames[] = {
        {"0\\0\\0", NULL, 3}, {"0\\0\\6", NULL, 3}, {"0\\0\\0", NULL, 1}, {"0\\0\\2", NULL, 1}};
    const uint8_t bits[6] = {0x0f, 0xf0, 0xff, 0xff, 0x01, 0x00};
    write_frames("seg.dcm", APART, frames, 4, bits, sizeof bits);
    cw_volume v = read_all(NULL);
    assert_true(v.dim[2] == 4 && v.type == CW_U8 && v.components == 1);
    for (size_t k = 0; k < 4; k++)
        for (size_t n = 0; n < PIXELS; n++) {
            int label = 0;
            for (int f = 0; f < 4; f++) { /* the higher one stays */
                const size_t bit = (size_t)f * PIXELS + n;
                const int z = frames[f].position[4] - '0';
                if (z == 2 * (int)k && bits[bit / 8] >> bit % 8 & 1 &&
                    frames[f].segment > label)
                    label = frames[f].segment;
            }
            assert_near(cw_volume_value(&v, n % COLUMNS, n / COLUMNS, k), label, 0);
        }
    cw_volume_free(&v);
}

/* Segments that overlap are in layers, the first in which they fit. */
static void segments_that_overlap_are_in_layers(void **state)
{
    (void)state;
    /* 4 overlaps 2 in the second slice, 5 overlaps none, 9 overlaps 2 and 4 */
    const frame frames[] = {{"0\\0\\0", NULL, 2},
                            {"0\\0\\2", NULL, 2},
                            {"0\\0\\2", NULL, 4},
                            {"0\\0\\0", NULL, 5},
                            {"0\\0\\2", NULL, 9}};
    static const uint16_t masks[5] = {0x00f, 0x0ff, 0x0c0, 0xf00, 0x0e0};
    static const size_t layers[5] = {0, 0, 1, 0, 2};
    uint8_t bits[5 * PIXELS / 8 + 1] = {0};
    for (size_t f = 0; f < 5; f++)
        for (size_t n = 0; n < PIXELS; n++)
            if (masks[f] >> n & 1)
                bits[(f * PIXELS + n) / 8] |= (uint8_t)(1 << (f * PIXELS + n) % 8);
    write_frames("seg.dcm", SEGMENTATION, frames, 5, bits, sizeof bits);
    cw_volume v = read_all(NULL);
    assert_true(v.dim[2] == 2 && v.components == 3);
    for (size_t c = 0; c < 3; c++) {
        cw_volume layer;
        assert_int_equal(cw_volume_select(&v, c, 0, &layer, NULL), CW_OK);
        for (size_t k = 0; k < 2; k++)
            for (size_t n = 0; n < PIXELS; n++) {
                int label = 0;
                for (size_t f = 0; f < 5; f++)
                    if (layers[f] == c && frames[f].position[4] - '0' == 2 * (int)k &&
                        masks[f] >> n & 1)
                        label = frames[f].segment;
                assert_near(cw_volume_value(&layer, n % COLUMNS, n / COLUMNS, k), label, 0);
            }
    }
    cw_volume_free(&v);
}

/* Each segment is a component of values from 0 to 1. */
static void fractions_are_components(void **state)
{
    (void)state;
    const frame frames[] = {{"0\\0\\0", NULL, 3}, {"0\\0\\2", NULL, 3}, {"0\\0\\2", NULL, 1}};
    uint8_t pixels[3 * PIXELS];
    for (int n = 0; n < 3 * PIXELS; n++)
        pixels[n] = (uint8_t)(5 * n);
    write_frames("seg.dcm", FRACTIONS, frames, 3, pixels, sizeof pixels);
    cw_volume v = read_all(NULL);
    assert_true(v.components == 2 && v.dim[2] == 2 && !(v.known & CW_KNOWN_LABELS));
    for (size_t c = 0; c < 2; c++) {
        cw_volume one;
        assert_int_equal(cw_volume_select(&v, c, 0, &one, NULL), CW_OK);
        for (size_t k = 0; k < 2; k++)
            for (size_t n = 0; n < PIXELS; n++) {
                const bool is_empty = c == 0 && k == 0;
                const size_t from = c == 0 ? 2 : k;
                assert_near(cw_volume_value(&one, n % COLUMNS, n / COLUMNS, k),
                            is_empty ? 0 : pixels[from * PIXELS + n] / 200.0, 1e-12);
            }
    }
    cw_volume_free(&v);
}

/* Pixels are numbers of segments, whatever colours a palette has for them; the slice between is
 * left out, and padding. */
static void label_maps_have_their_slices(void **state)
{
    (void)state;
    const frame frames[] = {{"0\\0\\4", NULL, 0}, {"0\\0\\0", NULL, 0}};
    uint8_t pixels[2 * PIXELS];
    for (int n = 0; n < 2 * PIXELS; n++)
        pixels[n] = (uint8_t)(n % 5);
    write_frames("map.dcm", LABEL_MAP, frames, 2, pixels, sizeof pixels);
    cw_volume v = read_all(NULL);
    assert_true(v.dim[2] == 3 && v.type == CW_U8);
    check_affine(&v, (const double[]){0.25, 0, 0, 0, 0, 0.5, 0, 0, 0, 0, 2, 0});
    assert_true(v.has_nodata && v.nodata == 7);
    for (size_t k = 0; k < 3; k++)
        for (size_t n = 0; n < PIXELS; n++)
            assert_int_equal(((const uint8_t *)v.data)[k * PIXELS + n],
                             k == 1 ? 7 : pixels[n + (k == 0) * PIXELS]);
    cw_volume_free(&v);

    const frame twice[] = {{"0\\0\\0", NULL, 0}, {"0\\0\\0", NULL, 0}};
    write_frames("map.dcm", LABEL_MAP, twice, 2, pixels, sizeof pixels);
    assert_refused(NULL, CW_ERR_UNSAFE, "two frames of the label map stand at 0 mm");
}

/* Twelve bits a frame, packed into two bytes, and those as run lengths. */
static void runs_of_bits_are_read(void **state)
{
    (void)state;
    const frame frames[] = {{"0\\0\\0", NULL, 1}, {"0\\0\\2", NULL, 2}};
    const uint8_t bits[2][2] = {{0xa5, 0x09}, {0x3c, 0x3c}};
    for (int short_by = 0; short_by < 2; short_by++) {
        test_dicom d;
        uint8_t rle[64 + 4] = {1, 0, 0, 0, 64};
        begin_frames(&d, TEST_DICOM_RLE, SEGMENTATION, frames, 2);
        test_dicom_open_fragments(&d);
        rle[64] = 1; /* two bytes as they are */
        memcpy(rle + 65, bits[0], 2);
        test_dicom_fragment(&d, rle, sizeof rle);
        rle[64] = 257 - 2; /* one of them twice */
        rle[65] = bits[1][0];
        test_dicom_fragment(&d, rle, sizeof rle - 2 - 2 * (size_t)short_by);
        test_dicom_close_sequence(&d);
        test_file_write(test_path("rle.dcm"), d.bytes, d.size);
        test_dicom_free(&d);
        if (short_by) {
            assert_refused(NULL, CW_ERR_FORMAT, "its run lengths end early");
            continue;
        }
        cw_volume v = read_all(NULL);
        assert_int_equal(v.dim[2], 2);
        for (size_t k = 0; k < 2; k++)
            for (size_t n = 0; n < PIXELS; n++)
                assert_near(cw_volume_value(&v, n % COLUMNS, n / COLUMNS, k),
                            (bits[k][n / 8] >> n % 8 & 1) * (int)(k + 1), 0);
        cw_volume_free(&v);
    }
}

/* --- mosaics ----------------------------------------------------------------------------- */

typedef struct csa {
    unsigned char bytes[1024];
    size_t size;
    bool newer;
} csa;

static void put_csa(csa *c, const void *bytes, size_t size)
{
    assert_true(c->size + size <= sizeof c->bytes);
    memcpy(c->bytes + c->size, bytes, size);
    c->size += size;
}

static void put_csa_number(csa *c, uint32_t n)
{
    const unsigned char b[4] = {(unsigned char)n, (unsigned char)(n >> 8),
                                (unsigned char)(n >> 16), (unsigned char)(n >> 24)};
    put_csa(c, b, sizeof b);
}

/* Six items, as scanners write them; those behind the first `count` are empty. */
static void put_csa_tag(csa *c, const char *name, const char *const *texts, uint32_t count)
{
    enum { ITEMS = 6 };
    char field[64] = {0};
    snprintf(field, sizeof field, "%s", name);
    put_csa(c, field, sizeof field);
    put_csa_number(c, count);
    put_csa(c, "FD\0", 4);
    put_csa_number(c, 4);
    put_csa_number(c, ITEMS);
    put_csa_number(c, 77);
    for (uint32_t n = 0; n < ITEMS; n++) {
        const uint32_t size = n < count ? (uint32_t)strlen(texts[n]) + 1 : 0;
        put_csa_number(c, c->newer ? size : size + ITEMS);
        put_csa_number(c, size);
        put_csa_number(c, 77);
        put_csa_number(c, size);
        if (size)
            put_csa(c, texts[n], size);
        put_csa(c, "\0\0\0", (4 - size % 4) % 4);
    }
}

static csa make_csa(bool newer, const char *slices, const char *const normal[3])
{
    csa c = {.newer = newer};
    if (newer)
        put_csa(&c, "SV10\4\3\2\1", 8);
    put_csa_number(&c, 3);
    put_csa_number(&c, 77);
    put_csa_tag(&c, "EchoLinePosition", (const char *const[]){"64"}, 1);
    put_csa_tag(&c, "NumberOfImagesInMosaic", &slices, 1);
    put_csa_tag(&c, "SliceNormalVector", normal, 3);
    return c;
}

/* Three slices, 2.5 mm apart, in a mosaic of two by two, whose pixels are the
 * field's values. */
static void write_mosaic(const char *name, int instance, const csa *header, double up)
{
    enum { ACROSS = 2, SLICES = 3, WIDE = ACROSS * COLUMNS, HIGH = ACROSS * ROWS };
    const slice_frame *f = &oblique; /* its normal is 0, -0.8, -0.6 */
    const double normal[3] = {0, -0.8 * up, -0.6 * up}, corner[3] = {7, -3, 11};
    int16_t pixels[WIDE * HIGH] = {0};
    char position[80];
    double p[3];
    for (int n = 0; n < SLICES * PIXELS; n++) {
        const int k = n / PIXELS, i = n % COLUMNS, j = n / COLUMNS % ROWS;
        for (int r = 0; r < 3; r++)
            p[r] = corner[r] + i * f->spacing[0] * f->x[r] + j * f->spacing[1] * f->y[r] +
                   2.5 * k * normal[r];
        pixels[(k / ACROSS * ROWS + j) * WIDE + k % ACROSS * COLUMNS + i] =
            (int16_t)lrint(10 * field_at(p));
    }
    for (int r = 0; r < 3; r++)
        p[r] = corner[r] - (WIDE - COLUMNS) / 2.0 * f->spacing[0] * f->x[r] -
               (HIGH - ROWS) / 2.0 * f->spacing[1] * f->y[r];
    snprintf(position, sizeof position, "%.10g\\%.10g\\%.10g", p[0], p[1], p[2]);
    test_image_write(&(test_image){.instance = instance,
                                   .columns = WIDE,
                                   .rows = HIGH,
                                   .type = "ORIGINAL\\PRIMARY\\M\\MOSAIC",
                                   .between = "2.5",
                                   .csa = header ? header->bytes : NULL,
                                   .csa_bytes = header ? header->size : 0,
                                   .position = position,
                                   .orientation = "0\\0.6\\-0.8\\1\\0\\0",
                                   .spacing = "3\\2",
                                   .is_signed = true,
                                   .slope = "0.1",
                                   .pixels = pixels},
                     name);
}

static void mosaics_are_unfolded(void **state)
{
    (void)state;
    static const char *const normals[2][3] = {{"0.0", " 0.80000000", "0.60000000"},
                                              {"0.0", "-0.80000000", "-0.60000000"}};
    for (int n = 0; n < 4; n++) {
        const csa header = make_csa(n / 2, "3", normals[n % 2]);
        write_mosaic("m.dcm", 1, &header, n % 2 ? 1 : -1);
        cw_volume v = read_all(NULL);
        double spacing[3];
        cw_volume_spacing(&v, spacing);
        assert_true(v.dim[0] == COLUMNS && v.dim[1] == ROWS && v.dim[2] == 3 && v.steps == 1);
        assert_near(spacing[2], 2.5, 1e-9);
        assert_is_field(&v);
        cw_volume_free(&v);
    }
    const csa header = make_csa(true, "3", normals[1]);
    write_mosaic("n.dcm", 2, &header, 1);
    cw_volume v = read_all(NULL); /* two moments */
    assert_true(v.dim[2] == 3 && v.steps == 2);
    assert_is_field(&v);
    cw_volume_free(&v);
    check_regions("", NULL);
}

static void mosaics_of_unknown_places_are_refused(void **state)
{
    (void)state;
    static const char *const normal[3] = {"0", "-0.8", "-0.6"}, *const other[3] = {"1", "0",
                                                                                   "0"};
    write_mosaic("m.dcm", 1, NULL, 1);
    assert_refused(NULL, CW_ERR_FORMAT, "mosaic of slices, and has no CSA header (0029,1010)");
    csa header = make_csa(true, "3", other);
    write_mosaic("m.dcm", 1, &header, 1);
    assert_refused(NULL, CW_ERR_FORMAT, "not normal to ImageOrientationPatient");
    header = make_csa(true, "70", normal);
    write_mosaic("m.dcm", 1, &header, 1);
    assert_refused(NULL, CW_ERR_FORMAT, "no multiples of a slice's");
    header = make_csa(true, "-1", normal);
    write_mosaic("m.dcm", 1, &header, 1);
    assert_refused(NULL, CW_ERR_FORMAT, "not from 1 to 4096");
    for (int newer = 0; newer < 2; newer++) {
        header = make_csa(newer, "3", normal);
        const size_t whole = header.size;
        for (size_t i = 0; i < whole / 4; i++) { /* a length or a count that lies */
            csa damaged = header;
            cw_volume v;
            memset(damaged.bytes + 4 * i, 0xff, 4);
            write_mosaic("m.dcm", 1, &damaged, 1);
            const cw_read_desc desc = {.no_sandbox = true};
            if (cw_volume_read(test_path("m.dcm"), &desc, &v, NULL, NULL) == CW_OK)
                cw_volume_free(&v);
        }
        for (header.size = 100; header.size < 600; header.size += 100) {
            write_mosaic("m.dcm", 1, &header, 1);
            assert_refused(NULL, CW_ERR_FORMAT, "CSA header (0029,1010) is damaged");
        }
    }
}

int main(void)
{
#define TEST(name) cmocka_unit_test_setup_teardown(name, test_folder_make, test_folder_remove)
    const struct CMUnitTest tests[] = {
        TEST(frames_have_a_place_each),
        TEST(segments_become_labels),
        TEST(segments_that_overlap_are_in_layers),
        TEST(fractions_are_components),
        TEST(label_maps_have_their_slices),
        TEST(runs_of_bits_are_read),
        TEST(mosaics_are_unfolded),
        TEST(mosaics_of_unknown_places_are_refused),
    };
    if (!cwi_module_present("dicom")) {
        print_message("this build reads no DICOM\n");
        return 0;
    }
    return cmocka_run_group_tests(tests, NULL, NULL);
}
