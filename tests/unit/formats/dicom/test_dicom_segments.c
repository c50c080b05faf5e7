/* Names and colours of the segments of DICOM segmentations. */
#include "support/files/dicom_cases.h"

#include "formats/dicom/dicom_segments.h"

static void segments_have_names_colours_and_codes(void **state)
{
    (void)state;
    const frame frames[] = {{"0\\0\\0", NULL, 1}, {"0\\0\\2", NULL, 3}};
    uint8_t pixels[2 * PIXELS] = {0xff, 0xff, 0xff};
    for (int map = 0; map < 2; map++) {
        cw_volume v;
        cw_label_table table = {0};
        cw_error err = {0};
        const cw_read_desc desc = {.labels = &table};
        write_frames("seg.dcm", map ? LABEL_MAP : SEGMENTATION, frames, 2, pixels,
                     map ? sizeof pixels : 2 * PIXELS / 8 + 1);
        for (int header = 1; header >= 0; header--) {
            cw_read_desc how = desc;
            how.header_only = header;
            assert_ok(cw_volume_read(test_path("seg.dcm"), &how, &v, NULL, &err), err);
            assert_true(v.known & CW_KNOWN_LABELS);
            assert_int_equal(table.count, 2);
            const cw_label *label = cw_label_find(&table, 0, 1);
            assert_string_equal(label->name, "left_lung");
            assert_true(label->has_color);
            assert_memory_equal(label->color, ((uint8_t[]){255, 0, 0, 255}), 4);
            assert_string_equal(label->category.meaning, "Tissue");
            assert_string_equal(label->type.scheme, "SCT");
            assert_string_equal(label->type.value, "10200004");
            label = cw_label_find(&table, 0, 3);
            assert_string_equal(label->name, "rest");
            assert_false(label->has_color);
            assert_null(label->type.value);
            cw_volume_free(&v);
        }
        cw_label_table_free(&table);
        unlink(test_path("seg.dcm"));
    }
}

static double lab_curve(double t)
{
    return t > 216.0 / 24389 ? cbrt(t) : (24389.0 / 27 * t + 16) / 116;
}

/* Encodes a colour as writers of segmentations do. */
static void srgb_to_lab(const uint8_t srgb[3], uint16_t lab[3])
{
    static const double to_xyz[3][3] = {{0.4360747, 0.3850649, 0.1430804},
                                        {0.2225045, 0.7168786, 0.0606169},
                                        {0.0139322, 0.0971045, 0.7141733}};
    static const double white[3] = {0.96422, 1, 0.82521};
    double f[3];
    for (int r = 0; r < 3; r++) {
        double sum = 0;
        for (int c = 0; c < 3; c++) {
            const double v = srgb[c] / 255.0;
            sum += to_xyz[r][c] * (v <= 0.04045 ? v / 12.92 : pow((v + 0.055) / 1.055, 2.4));
        }
        f[r] = lab_curve(sum / white[r]);
    }
    lab[0] = (uint16_t)lround((116 * f[1] - 16) / 100 * 65535);
    lab[1] = (uint16_t)lround((500 * (f[0] - f[1]) + 128) / 255 * 65535);
    lab[2] = (uint16_t)lround((200 * (f[1] - f[2]) + 128) / 255 * 65535);
}

static void colours_come_back_to_the_byte(void **state)
{
    (void)state;
    for (int n = 0; n < 17 * 17 * 17; n++) {
        const uint8_t srgb[3] = {(uint8_t)(n % 17 * 255 / 16),
                                 (uint8_t)(n / 17 % 17 * 255 / 16),
                                 (uint8_t)(n / 289 * 255 / 16)};
        uint16_t lab[3];
        uint8_t back[3];
        srgb_to_lab(srgb, lab);
        cwi_dicom_lab_to_srgb(lab, back);
        assert_memory_equal(srgb, back, 3);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(segments_have_names_colours_and_codes, test_folder_make,
                                        test_folder_remove),
        cmocka_unit_test(colours_come_back_to_the_byte),
    };
    if (!cwi_module_present("dicom")) {
        print_message("this build reads no DICOM\n");
        return 0;
    }
    return cmocka_run_group_tests(tests, NULL, NULL);
}
