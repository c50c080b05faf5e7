/* DICOM read: enhanced objects, whose frames have dimensions, stacks, and places in a volume of their own. */
#include "support/files/dicom_multiframe.h"

enum {
    STACK_ID = 0x00209056,
    IN_STACK = 0x00209057,
    TEMPORAL = 0x00209128,
    CARDIAC_PHASE = 0x00209241,
    B_VALUE = 0x00189087,
    MAX_DIMENSIONS = 3
};

/* A frame of an enhanced object; what is NULL, NaN or 0 is left out. */
typedef struct enhanced_frame {
    double z;
    uint32_t indices[MAX_DIMENSIONS];
    const char *stack;
    double phase, trigger, b_value; /* 0: left out */
    uint32_t temporal;
} enhanced_frame;

typedef struct enhanced {
    const char *sop_class;
    bool in_volume; /* places are those of an ultrasound volume */
    const double *orientation;
    uint32_t dimensions[MAX_DIMENSIONS];
    enhanced_frame frames[MAX_FRAMES];
    int count;
} enhanced;

static const double UPRIGHT[6] = {1, 0, 0, 0, 1, 0}, OBLIQUE[6] = {0, 0.6, -0.8, 1, 0, 0};

static void open_group(test_dicom *d, uint32_t tag)
{
    test_dicom_open_sequence(d, tag);
    test_dicom_open_item(d);
}

static void close_group(test_dicom *d)
{
    test_dicom_close_item(d);
    test_dicom_close_sequence(d);
}

static void put_numbers(test_dicom *d, uint32_t tag, const double *numbers, int count)
{
    char text[160] = "";
    for (int n = 0; n < count; n++)
        snprintf(text + strlen(text), sizeof text - strlen(text), "%s%.10g", n ? "\\" : "",
                 numbers[n]);
    test_dicom_text(d, tag, "DS", text);
}

static void put_dimensions(test_dicom *d, const enhanced *e)
{
    if (!e->dimensions[0])
        return;
    test_dicom_open_sequence(d, 0x00209222);
    for (int n = 0; n < MAX_DIMENSIONS && e->dimensions[n]; n++) {
        test_dicom_open_item(d);
        put_tags(d, 0x00209165, (const uint32_t[MAX_VECTORS]){e->dimensions[n]});
        test_dicom_close_item(d);
    }
    test_dicom_close_sequence(d);
}

static void put_content(test_dicom *d, const enhanced *e, const enhanced_frame *f)
{
    int count = 0;
    open_group(d, 0x00209111);
    if (f->stack)
        test_dicom_text(d, STACK_ID, "SH", f->stack);
    if (f->temporal)
        test_dicom_bytes(d, TEMPORAL, "UL", &f->temporal, 4);
    while (count < MAX_DIMENSIONS && e->dimensions[count])
        count++;
    if (count)
        test_dicom_bytes(d, 0x00209157, "UL", f->indices, (size_t)count * 4);
    close_group(d);
}

static void put_enhanced_frame(test_dicom *d, const enhanced *e, const enhanced_frame *f)
{
    const double place[3] = {10, 20, f->z};
    test_dicom_open_item(d);
    if (f->b_value != 0) {
        open_group(d, 0x00189117);
        put_doubles(d, B_VALUE, &f->b_value, 1);
        close_group(d);
    }
    if (f->phase != 0 || f->trigger != 0) {
        open_group(d, 0x00189118);
        if (f->trigger != 0)
            put_doubles(d, 0x00209153, &f->trigger, 1);
        if (f->phase != 0)
            put_doubles(d, CARDIAC_PHASE, &f->phase, 1);
        close_group(d);
    }
    put_content(d, e, f);
    open_group(d, e->in_volume ? 0x0020930e : 0x00209113);
    if (e->in_volume)
        put_doubles(d, 0x00209301, place, 3);
    else
        put_numbers(d, 0x00200032, place, 3);
    close_group(d);
    test_dicom_close_item(d);
}

static void write_enhanced(const char *name, const enhanced *e)
{
    test_dicom d;
    char frames[16];
    snprintf(frames, sizeof frames, "%d", e->count);
    test_dicom_begin(&d, TEST_DICOM_EXPLICIT);
    test_dicom_text(&d, 0x00080016, "UI", e->sop_class);
    test_dicom_text(&d, 0x00080018, "UI", "1.2.3.9");
    test_dicom_text(&d, 0x0020000e, "UI", "1.2.3");
    test_dicom_text(&d, 0x00200011, "IS", "5");
    put_dimensions(&d, e);
    put_sizes(&d, frames, (const uint32_t[MAX_VECTORS]){0}, NULL);
    open_group(&d, 0x52009229);
    open_group(&d, e->in_volume ? 0x0020930f : 0x00209116);
    if (e->in_volume)
        put_doubles(&d, 0x00209302, e->orientation, 6);
    else
        put_numbers(&d, 0x00200037, e->orientation, 6);
    close_group(&d);
    open_group(&d, 0x00289110);
    test_dicom_text(&d, 0x00280030, "DS", "3\\2");
    close_group(&d);
    close_group(&d);
    test_dicom_open_sequence(&d, 0x52009230);
    for (int n = 0; n < e->count; n++)
        put_enhanced_frame(&d, e, &e->frames[n]);
    test_dicom_close_sequence(&d);
    put_numbered_pixels(&d, e->count);
    test_file_write(test_path(name), d.bytes, d.size);
    test_dicom_free(&d);
}

static void check_steps(const enhanced *e, size_t slices, size_t steps, const int *frames,
                        const char *words)
{
    char notes[512] = "";
    const cw_read_desc desc = {.note = notes_keep, .note_user = notes};
    write_enhanced("e.dcm", e);
    cw_volume v = read_all(&desc);
    assert_frames(&v, slices, steps, frames);
    if (!strstr(notes, words))
        fail_msg("'%s' is not in '%s'", words, notes);
    cw_volume_free(&v);
}

/* --- dimensions ---------------------------------------------------------------------------- */

/* Dimensions that count no places are steps, the first of them slowest. */
static void dimensions_other_than_places_are_steps(void **state)
{
    (void)state;
    enhanced e = {.sop_class = ENHANCED_MR,
                  .orientation = UPRIGHT,
                  .count = 4,
                  .dimensions = {STACK_ID, IN_STACK, TEMPORAL}};
    const enhanced_frame in_time[] = {{.z = 0, .stack = "1", .indices = {1, 1, 2}},
                                      {.z = 0, .stack = "1", .indices = {1, 1, 1}},
                                      {.z = 3, .stack = "1", .indices = {1, 2, 2}},
                                      {.z = 3, .stack = "1", .indices = {1, 2, 1}}};
    memcpy(e.frames, in_time, sizeof in_time);
    check_steps(&e, 2, 2, (const int[]){1, 3, 0, 2}, "in the order of TemporalPositionIndex");

    enhanced b = {.sop_class = ENHANCED_MR,
                  .orientation = UPRIGHT,
                  .count = 8,
                  .dimensions = {B_VALUE, 0x00189089, 0x00200032}};
    for (int n = 0; n < 8; n++) { /* b-values and directions, at two places */
        b.frames[n].z = n % 2 * 3;
        b.frames[n].indices[0] = (uint32_t)(2 - n / 4);
        b.frames[n].indices[1] = (uint32_t)(1 + n / 2 % 2);
        b.frames[n].indices[2] = (uint32_t)(1 + n % 2);
    }
    check_steps(&b, 2, 4, (const int[]){4, 5, 6, 7, 0, 1, 2, 3},
                "taken as 4 steps, in the order of Diffusion");

    enhanced c = {.sop_class = SOP "2.1",
                  .orientation = OBLIQUE,
                  .count = 6,
                  .dimensions = {CARDIAC_PHASE, 0x00200032}};
    for (int n = 0; n < 6; n++) {
        c.frames[n].z = 30 - 3 * (n / 3); /* the normal looks down */
        c.frames[n].indices[0] = (uint32_t)(1 + n % 3);
        c.frames[n].indices[1] = (uint32_t)(1 + n / 3);
    }
    write_enhanced("e.dcm", &c);
    cw_volume v = read_all(&(cw_read_desc){.tilt = CW_TILT_KEEP});
    assert_frames(&v, 2, 3, (const int[]){0, 3, 1, 4, 2, 5});
    cw_volume_free(&v);
}

/* Without dimensions, attributes of the frames tell; two together, where neither does alone. */
static void attributes_of_frames_are_steps(void **state)
{
    (void)state;
    enhanced e = {.sop_class = SOP "2.1", .orientation = UPRIGHT, .count = 6};
    for (int n = 0; n < 6; n++) {
        e.frames[n].z = n % 3;
        e.frames[n].phase = n < 3 ? 75 : 35;
    }
    check_steps(&e, 3, 2, (const int[]){3, 4, 5, 0, 1, 2}, "NominalPercentageOfCardiacPhase");
    for (int n = 0; n < 6; n++) {
        e.frames[n].phase = 0;
        e.frames[n].trigger = n < 3 ? 400 : 0.5;
    }
    check_steps(&e, 3, 2, (const int[]){3, 4, 5, 0, 1, 2}, "TriggerTime");
    for (int n = 0; n < 6; n++) {
        e.frames[n].trigger = 0;
        e.frames[n].temporal = n < 3 ? 2 : 1;
    }
    check_steps(&e, 3, 2, (const int[]){3, 4, 5, 0, 1, 2}, "TemporalPosition");
    e.count = 8;
    for (int n = 0; n < 8; n++)
        e.frames[n] = (enhanced_frame){
            .z = n % 2, .temporal = (uint32_t)(2 - n / 4), .b_value = n / 2 % 2 ? 1000 : 500};
    check_steps(&e, 2, 4, (const int[]){4, 5, 6, 7, 0, 1, 2, 3}, "several attributes");
}

/* Stacks of one direction, at other places or the same, are series to choose from. */
static void stacks_are_series(void **state)
{
    (void)state;
    for (int far = 0; far < 3; far++) {
        enhanced e = {.sop_class = ENHANCED_MR,
                      .orientation = UPRIGHT,
                      .count = 6,
                      .dimensions = {STACK_ID, IN_STACK}};
        for (int n = 0; n < 6; n++)
            e.frames[n] =
                (enhanced_frame){.z = 2 * (n / 2) + 50 * far * (n % 2),
                                 .stack = n % 2 ? "B" : "A",
                                 .indices = {(uint32_t)(1 + n % 2), (uint32_t)(1 + n / 2)}};
        write_enhanced("e.dcm", &e);
        assert_refused(NULL, CW_ERR_UNSAFE,
                       "it holds 2 series: 5.1 (, 3 of 4 x 3), 5.2 (, 3 of 4 x 3)");
        cw_volume v = read_all(&(cw_read_desc){.series = "5.2"});
        assert_frames(&v, 3, 1, (const int[]){1, 3, 5});
        cw_volume_free(&v);
    }
}

/* --- volumes of ultrasound ------------------------------------------------------------------ */

static void volumes_of_ultrasound_have_places_of_their_own(void **state)
{
    (void)state;
    static const double *const orientations[] = {UPRIGHT, UPRIGHT, OBLIQUE};
    for (int way = 0; way < 3; way++) {
        char notes[512] = "";
        const cw_read_desc desc = {
            .note = notes_keep, .note_user = notes, .tilt = CW_TILT_KEEP};
        enhanced e = {.sop_class = ULTRASOUND_VOLUME,
                      .in_volume = true,
                      .orientation = orientations[way],
                      .count = 6,
                      .dimensions = {TEMPORAL, 0x00209301}};
        for (int n = 0; n < 6; n++)
            e.frames[n] =
                (enhanced_frame){.z = 30 + (way == 1 ? -4 : 4) * (n % 3),
                                 .indices = {(uint32_t)(1 + n / 3), (uint32_t)(1 + n % 3)}};
        write_enhanced("us.dcm", &e);
        cw_volume v = read_all(&desc);
        const int up[] = {0, 1, 2, 3, 4, 5}, down[] = {2, 1, 0, 5, 4, 3};
        assert_frames(&v, 3, 2, way ? down : up);
        if (way == 2)
            assert_column(&v, 2, 0, -0.8 * 2.4, -0.6 * 2.4);
        else
            assert_column(&v, 2, 0, 0, 4);
        assert_column(&v, 3, 10, 20, way == 0 ? 30 : way == 1 ? 22 : 38);
        assert_int_equal(v.known, CW_KNOWN_UNIT);
        assert_non_null(strstr(notes, "the frame of the ultrasound volume"));
        cw_volume_free(&v);
    }
}

int main(void)
{
#define TEST(name) cmocka_unit_test_setup_teardown(name, test_folder_make, test_folder_remove)
    const struct CMUnitTest tests[] = {
        TEST(dimensions_other_than_places_are_steps),
        TEST(attributes_of_frames_are_steps),
        TEST(stacks_are_series),
        TEST(volumes_of_ultrasound_have_places_of_their_own),
    };
    if (!cwi_module_present("dicom")) {
        print_message("this build reads no DICOM\n");
        return 0;
    }
    return cmocka_run_group_tests(tests, NULL, NULL);
}
