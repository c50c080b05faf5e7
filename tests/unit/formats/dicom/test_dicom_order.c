/* DICOM read: the order of frames that vectors count, their places, and images that are no slices. */
#include "support/files/dicom_multiframe.h"

enum {
    ENERGY_WINDOW = 0x00540010,
    DETECTOR = 0x00540020,
    PHASE = 0x00540030,
    ROTATION = 0x00540050,
    RR_INTERVAL = 0x00540060,
    TIME_SLOT = 0x00540070,
    SLICE = 0x00540080,
    VIEW = 0x00540090,
    TIME_SLICE = 0x00540100,
    FRAME_TIME = 0x00181063,
    FRAME_TIME_VECTOR = 0x00181065,
    OFFSETS = 0x3004000c
};

static const char UPRIGHT[] = "1\\0\\0\\0\\1\\0", OBLIQUE[] = "0\\0.6\\-0.8\\1\\0\\0";

static test_counted reconstructed(const char *between, int frames)
{
    return (test_counted){.sop_class = NUCLEAR,
                          .modality = "NM",
                          .type = "ORIGINAL\\PRIMARY\\RECON TOMO\\EMISSION",
                          .between = between,
                          .position = "10\\20\\30",
                          .orientation = UPRIGHT,
                          .by_detector = true,
                          .frames = frames,
                          .pointers = {SLICE}};
}

/* --- places -------------------------------------------------------------------------------- */

/* PS3.3 C.8.4.15: a negative distance stacks the slices in front of the first. */
static void slices_of_nuclear_medicine_stack_both_ways(void **state)
{
    (void)state;
    static const struct {
        const char *between, *orientation;
        uint16_t slices[4];
        int frames[4];
        double z, step; /* of the lowest slice, upright */
    } rows[] = {
        {"4", UPRIGHT, {1, 2, 3, 4}, {0, 1, 2, 3}, 30, 4},
        {"-4", UPRIGHT, {1, 2, 3, 4}, {3, 2, 1, 0}, 18, 4},
        {"-2.5", UPRIGHT, {4, 3, 2, 1}, {0, 1, 2, 3}, 22.5, 2.5},
        {"2.5", UPRIGHT, {2, 1, 4, 3}, {1, 0, 3, 2}, 30, 2.5},
        {"-4", OBLIQUE, {1, 2, 3, 4}, {3, 2, 1, 0}, 0, 0},
    };
    for (size_t n = 0; n < sizeof rows / sizeof *rows; n++) {
        test_counted c = reconstructed(rows[n].between, 4);
        c.vectors[0].tag = SLICE;
        c.orientation = rows[n].orientation;
        memcpy(c.vectors[0].numbers, rows[n].slices, sizeof rows[n].slices);
        write_counted("nm.dcm", &c);
        cw_volume v = read_all(NULL);
        assert_frames(&v, 4, 1, rows[n].frames);
        if (rows[n].step != 0) {
            assert_column(&v, 2, 0, 0, rows[n].step);
            assert_column(&v, 3, 10, 20, rows[n].z);
        } else { /* the normal is 0, -0.8, -0.6 */
            assert_column(&v, 2, 0, -3.2, -2.4);
            assert_column(&v, 3, 10, 20 + 9.6, 30 + 7.2);
        }
        cw_volume_free(&v);
    }
}

/* Directions of the first slice stay where a spacing is stated, and its place. */
static void a_stated_spacing_keeps_the_side(void **state)
{
    (void)state;
    test_counted c = reconstructed("-4", 3);
    c.vectors[0] = (test_vector){SLICE, {1, 2, 3}};
    write_counted("nm.dcm", &c);
    cw_volume v = read_all(&(cw_read_desc){.spacing_mm = {2, 3, 5}});
    assert_frames(&v, 3, 1, (const int[]){2, 1, 0});
    assert_column(&v, 2, 0, 0, 5);
    assert_column(&v, 3, 10, 20, 20);
    cw_volume_free(&v);
    c.between = NULL;
    write_counted("nm.dcm", &c);
    assert_refused(NULL, CW_ERR_UNSAFE, "'SpacingBetweenSlices' is missing");
    v = read_all(&(cw_read_desc){.spacing_mm = {2, 3, 5}});
    assert_frames(&v, 3, 1, (const int[]){0, 1, 2});
    assert_column(&v, 3, 10, 20, 30);
    cw_volume_free(&v);
    c.thickness = "6";
    write_counted("nm.dcm", &c);
    v = read_all(NULL);
    assert_column(&v, 2, 0, 0, 6);
    cw_volume_free(&v);
}

/* PS3.3 C.8.8.3.2: relative where the first is 0, the z of the patient where it is that of the place. */
static void offsets_of_dose_are_relative_or_absolute(void **state)
{
    (void)state;
    static const struct {
        const char *position, *orientation, *offsets;
        double from[3], step[3];
        bool reversed;
    } rows[] = {
        {"10\\20\\30", UPRIGHT, "0\\3\\6", {10, 20, 30}, {0, 0, 3}, false},
        {"10\\20\\30", UPRIGHT, "0\\-3\\-6", {10, 20, 24}, {0, 0, 3}, true},
        {"10\\20\\30", UPRIGHT, "30\\33.5\\37", {10, 20, 30}, {0, 0, 3.5}, false},
        {"10\\20\\30", UPRIGHT, "30\\27\\24", {10, 20, 24}, {0, 0, 3}, true},
        {"10\\20\\-30", UPRIGHT, "-30.0\\-28\\-26", {10, 20, -30}, {0, 0, 2}, false},
        {"10\\20\\0", UPRIGHT, "0\\-2\\-4", {10, 20, -4}, {0, 0, 2}, true},
        {"10\\20\\30", OBLIQUE, "0\\5\\10", {10, 20, 30}, {0, -4, -3}, false},
        {"10\\20\\30", OBLIQUE, "0\\-5\\-10", {10, 28, 36}, {0, -4, -3}, true},
    };
    for (size_t n = 0; n < sizeof rows / sizeof *rows; n++) {
        write_counted("dose.dcm", &(test_counted){.sop_class = DOSE,
                                                  .modality = "RTDOSE",
                                                  .position = rows[n].position,
                                                  .orientation = rows[n].orientation,
                                                  .frames = 3,
                                                  .pointers = {OFFSETS},
                                                  .offsets = rows[n].offsets});
        cw_volume v = read_all(NULL);
        const int up[] = {0, 1, 2}, down[] = {2, 1, 0};
        assert_frames(&v, 3, 1, rows[n].reversed ? down : up);
        assert_column(&v, 3, rows[n].from[0], rows[n].from[1], rows[n].from[2]);
        assert_column(&v, 2, rows[n].step[0], rows[n].step[1], rows[n].step[2]);
        cw_volume_free(&v);
    }
}

static void offsets_that_mean_nothing_are_refused(void **state)
{
    (void)state;
    static const struct {
        const char *orientation, *offsets, *words;
    } rows[] = {
        {UPRIGHT, "5\\8\\11", "GridFrameOffsetVector begins with 5, where 0 or"},
        {OBLIQUE, "30\\33\\36", "GridFrameOffsetVector begins with 30"},
        {UPRIGHT, "0\\3", "GridFrameOffsetVector, which lists 2 numbers for 3 frames"},
        {UPRIGHT, "0\\x\\3", "GridFrameOffsetVector, which lists 0 numbers for 3 frames"},
    };
    for (size_t n = 0; n < sizeof rows / sizeof *rows; n++) {
        write_counted("dose.dcm", &(test_counted){.sop_class = DOSE,
                                                  .position = "10\\20\\30",
                                                  .orientation = rows[n].orientation,
                                                  .frames = 3,
                                                  .pointers = {OFFSETS},
                                                  .offsets = rows[n].offsets});
        assert_refused(NULL, CW_ERR_FORMAT, rows[n].words);
    }
}

/* --- steps --------------------------------------------------------------------------------- */

/* Vectors count slices, and moments at each; frames come in any order. */
static void moments_of_slices_are_steps(void **state)
{
    (void)state;
    static const struct {
        uint32_t pointers[MAX_VECTORS];
        test_vector vectors[MAX_VECTORS];
        size_t slices, steps;
        int frames[8];
        const char *words;
    } rows[] = {
        {{RR_INTERVAL, TIME_SLOT, SLICE},
         {{RR_INTERVAL, {1, 1, 1, 1, 1, 1}},
          {TIME_SLOT, {1, 1, 1, 2, 2, 2}},
          {SLICE, {1, 2, 3, 1, 2, 3}}},
         3,
         2,
         {0, 1, 2, 3, 4, 5},
         "taken as 2 steps, in the order of TimeSlotVector"},
        {{SLICE, TIME_SLOT}, /* slice by slice, the later moment first */
         {{TIME_SLOT, {2, 1, 2, 1, 2, 1}}, {SLICE, {1, 1, 2, 2, 3, 3}}},
         3,
         2,
         {1, 3, 5, 0, 2, 4},
         "taken as 2 steps, in the order of TimeSlotVector"},
        {{ENERGY_WINDOW, SLICE},
         {{ENERGY_WINDOW, {1, 1, 2, 2, 3, 3}}, {SLICE, {1, 2, 1, 2, 1, 2}}},
         2,
         3,
         {0, 1, 2, 3, 4, 5},
         "taken as 3 steps, in the order of EnergyWindowVector"},
        {{PHASE, TIME_SLICE, SLICE},
         {{PHASE, {1, 1, 1, 1, 2, 2, 2, 2}},
          {SLICE, {1, 2, 1, 2, 1, 2, 1, 2}},
          {TIME_SLICE, {1, 1, 2, 2, 1, 1, 2, 2}}},
         2,
         4,
         {0, 1, 2, 3, 4, 5, 6, 7},
         "in the order of PhaseVector, TimeSliceVector"},
        {{RR_INTERVAL, TIME_SLOT, SLICE}, /* the first pointer counts slowest */
         {{RR_INTERVAL, {1, 2, 1, 2, 1, 2, 1, 2}},
          {TIME_SLOT, {1, 1, 2, 2, 1, 1, 2, 2}},
          {SLICE, {1, 1, 1, 1, 2, 2, 2, 2}}},
         2,
         4,
         {0, 4, 2, 6, 1, 5, 3, 7},
         "RRIntervalVector, TimeSlotVector"},
    };
    for (size_t n = 0; n < sizeof rows / sizeof *rows; n++) {
        char notes[512] = "";
        const cw_read_desc desc = {.note = notes_keep, .note_user = notes};
        test_counted c = reconstructed("4", (int)(rows[n].slices * rows[n].steps));
        c.type = "ORIGINAL\\PRIMARY\\RECON GATED TOMO\\EMISSION";
        memcpy(c.pointers, rows[n].pointers, sizeof c.pointers);
        memcpy(c.vectors, rows[n].vectors, sizeof c.vectors);
        write_counted("gated.dcm", &c);
        cw_volume v = read_all(&desc);
        assert_frames(&v, rows[n].slices, rows[n].steps, rows[n].frames);
        assert_column(&v, 2, 0, 0, 4);
        assert_non_null(strstr(notes, rows[n].words));
        cw_volume_free(&v);
        check_regions("", NULL);
    }
}

/* Vectors of more than 64 kB have to be stored without their representation. */
static void vectors_of_unknown_representation_are_read(void **state)
{
    (void)state;
    test_counted c = reconstructed("4", 4);
    c.is_unknown = true;
    c.pointers[1] = TIME_SLOT;
    c.vectors[0] = (test_vector){TIME_SLOT, {1, 2, 1, 2}};
    c.vectors[1] = (test_vector){SLICE, {300, 300, 301, 301}};
    write_counted("nm.dcm", &c);
    cw_volume v = read_all(NULL);
    assert_frames(&v, 2, 2, (const int[]){0, 2, 1, 3});
    cw_volume_free(&v);
    write_counted("nm.dcm", &(test_counted){.sop_class = DOSE,
                                            .position = "10\\20\\30",
                                            .orientation = UPRIGHT,
                                            .frames = 3,
                                            .is_unknown = true,
                                            .pointers = {OFFSETS},
                                            .offsets = "0\\ -2.5 \\-5"});
    v = read_all(NULL);
    assert_frames(&v, 3, 1, (const int[]){2, 1, 0});
    assert_column(&v, 2, 0, 0, 2.5);
    cw_volume_free(&v);
}

/* Without a place there are still slices and moments. */
static void numbered_slices_need_a_spacing_alone(void **state)
{
    (void)state;
    const cw_read_desc stated = {.spacing_mm = {2, 3, 5}};
    test_counted c = reconstructed("-4", 4);
    c.position = c.orientation = NULL;
    c.pointers[0] = TIME_SLOT;
    c.pointers[1] = SLICE;
    c.vectors[0] = (test_vector){TIME_SLOT, {1, 1, 2, 2}};
    c.vectors[1] = (test_vector){SLICE, {1, 2, 1, 2}};
    write_counted("nm.dcm", &c);
    assert_refused(NULL, CW_ERR_UNSAFE, "4 of 4 images have no 'ImagePositionPatient'");
    cw_volume v = read_all(&stated);
    assert_frames(&v, 2, 2, (const int[]){1, 0, 3, 2});
    assert_int_equal(v.known, CW_KNOWN_UNIT);
    cw_volume_free(&v);
}

/* --- frames that are no slices ------------------------------------------------------------ */

static void frames_that_are_no_slices_are_refused(void **state)
{
    (void)state;
    static const struct {
        const char *sop_class, *modality, *type;
        uint32_t pointers[MAX_VECTORS];
        test_vector vectors[MAX_VECTORS];
        int length;
        const char *words;
    } rows[] = {
        {NUCLEAR,
         "NM",
         "ORIGINAL\\PRIMARY\\WHOLE BODY\\EMISSION",
         {ENERGY_WINDOW, DETECTOR},
         {{ENERGY_WINDOW, {1, 1, 1, 1}}, {DETECTOR, {1, 2, 1, 2}}},
         0,
         "planar views of a gamma camera"},
        {NUCLEAR,
         "NM",
         NULL,
         {ENERGY_WINDOW, DETECTOR},
         {{ENERGY_WINDOW, {1, 1, 1, 1}}, {DETECTOR, {1, 2, 1, 2}}},
         0,
         "views of 2 detectors (DetectorVector)"},
        {NUCLEAR,
         "NM",
         "ORIGINAL\\PRIMARY\\TOMO\\EMISSION",
         {ROTATION, VIEW},
         {{ROTATION, {1, 1, 1, 1}}, {VIEW, {1, 2, 3, 4}}},
         0,
         "projections of a gamma camera (ImageType TOMO)"},
        {NUCLEAR,
         "NM",
         "DERIVED\\SECONDARY",
         {ROTATION, VIEW},
         {{ROTATION, {1, 1, 1, 1}}, {VIEW, {1, 2, 3, 4}}},
         0,
         "views of 4 angular views (AngularViewVector)"},
        {NUCLEAR,
         "NM",
         "DERIVED\\SECONDARY",
         {ROTATION, SLICE},
         {{ROTATION, {1, 1, 2, 2}}, {SLICE, {1, 2, 1, 2}}},
         0,
         "views of 2 rotations (RotationVector)"},
        {NUCLEAR,
         "NM",
         "ORIGINAL\\PRIMARY\\DYNAMIC\\EMISSION",
         {PHASE, TIME_SLICE},
         {{PHASE, {1, 1, 1, 1}}, {TIME_SLICE, {1, 2, 3, 4}}},
         0,
         "ImageType DYNAMIC"},
        {NUCLEAR,
         "NM",
         "ORIGINAL\\PRIMARY\\RECON TOMO\\EMISSION",
         {SLICE},
         {{SLICE, {1, 2, 3, 4}}},
         3,
         "SliceVector, which lists 3 numbers for 4 frames"},
        {SOP "3.1", "US", NULL, {0}, {{0}}, 0, "film of ultrasound"},
        {SOP "7.2", "OT", NULL, {FRAME_TIME}, {{0}}, 0, "moments of a film (FrameTime)"},
        {SOP "2",
         "CT",
         NULL,
         {FRAME_TIME_VECTOR},
         {{0}},
         0,
         "moments of a film (FrameTimeVector)"},
        {SOP "7.3",
         "OT",
         NULL,
         {0x00182001},
         {{0}},
         0,
         "names (0018,2001), an order that is not read"},
        {SOP "12.1", "XA", NULL, {FRAME_TIME}, {{0}}, 0, "angiograms (XA)"},
        {SOP "77.1.6", "SM", NULL, {0}, {{0}}, 0, "tiles of a slide"},
    };
    const cw_read_desc stated = {.spacing_mm = {1, 1, 1}};
    for (size_t n = 0; n < sizeof rows / sizeof *rows; n++) {
        test_counted c = {.sop_class = rows[n].sop_class,
                          .modality = rows[n].modality,
                          .type = rows[n].type,
                          .between = "4",
                          .position = "10\\20\\30",
                          .orientation = UPRIGHT,
                          .frames = 4,
                          .vector_length = rows[n].length,
                          .frame_time = "40"};
        memcpy(c.pointers, rows[n].pointers, sizeof c.pointers);
        memcpy(c.vectors, rows[n].vectors, sizeof c.vectors);
        write_counted("frames.dcm", &c);
        assert_refused(NULL, CW_ERR_FORMAT, rows[n].words);
        assert_refused(NULL, CW_ERR_FORMAT, "its 4 images make no volume");
        assert_refused(&stated, CW_ERR_FORMAT, rows[n].words); /* never stacked */
    }
}

/* One image may be looked at; several are no volume, though each may state a place. Another series beside them
 * is read. */
static void projections_are_not_stacked(void **state)
{
    (void)state;
    static const struct {
        const char *sop_class, *modality, *type, *words;
    } rows[] = {
        {SOP "1", "CR", NULL, "radiographs (CR)"},
        {SOP "1.1", "DX", NULL, "radiographs (DX)"},
        {SOP "1.2.1", "MG", NULL, "mammograms (MG)"},
        {SOP "12.1", "XA", NULL, "angiograms (XA)"},
        {SOP "12.2", "RF", NULL, "fluoroscopic projections (RF)"},
        {NUCLEAR, "NM", "ORIGINAL\\PRIMARY\\STATIC\\EMISSION", "ImageType STATIC"},
        {SOP "2", "CT", "ORIGINAL\\PRIMARY\\LOCALIZER", "localizers"},
        {NULL, "CR", NULL, "radiographs (CR)"},
    };
    for (size_t n = 0; n < sizeof rows / sizeof *rows; n++) {
        for (int f = 0; f < 2; f++) {
            test_dicom d;
            char name[16], number[8], place[24];
            snprintf(name, sizeof name, "%d.dcm", f);
            snprintf(number, sizeof number, "%d", f + 1);
            snprintf(place, sizeof place, "0\\0\\%d", 2 * f);
            test_dicom_begin(&d, TEST_DICOM_EXPLICIT);
            put_optional(&d, 0x00080008, "CS", rows[n].type);
            put_optional(&d, 0x00080016, "UI", rows[n].sop_class);
            test_dicom_text(&d, 0x00080018, "UI", f ? "1.2.3.4.1" : "1.2.3.4.2");
            put_optional(&d, 0x00080060, "CS", rows[n].modality);
            test_dicom_text(&d, 0x0020000e, "UI", "1.2.3.4");
            test_dicom_text(&d, 0x00200011, "IS", "7");
            test_dicom_text(&d, 0x00200013, "IS", number);
            put_place(&d, place, UPRIGHT);
            put_sizes(&d, "1", (const uint32_t[MAX_VECTORS]){0}, "1\\1");
            put_numbered_pixels(&d, 1);
            test_file_write(test_path(name), d.bytes, d.size);
            test_dicom_free(&d);
            if (f == 0) {
                unlink(test_path("1.dcm"));
                cw_volume v = read_all(NULL);
                assert_int_equal(v.dim[2], 1);
                cw_volume_free(&v);
            }
        }
        assert_refused(NULL, CW_ERR_FORMAT, rows[n].words);
        assert_refused(&(cw_read_desc){.spacing_mm = {1, 1, 1}}, CW_ERR_FORMAT, rows[n].words);
    }
    for (int f = 0; f < 3; f++) {
        char name[16];
        snprintf(name, sizeof name, "ct%d.dcm", f);
        write_at(name, 8, f, 2.5 * f, "1.2.8");
    }
    cw_volume v = read_all(&(cw_read_desc){.series = "8"});
    assert_int_equal(v.dim[2], 3);
    cw_volume_free(&v);
    assert_refused(&(cw_read_desc){.series = "7"}, CW_ERR_FORMAT, "radiographs");
}

/* --- places that one image states, or all alike -------------------------------------------- */

static void the_place_of_the_first_frame_stays(void **state)
{
    (void)state;
    static const struct {
        const char *position, *orientation;
        double from[3], step[3];
        unsigned known;
    } rows[] = {
        {"10\\20\\30", UPRIGHT, {10, 20, 30}, {0, 0, 5}, CW_KNOWN_UNIT | CW_KNOWN_FRAME},
        {"10\\20\\30", OBLIQUE, {10, 20, 30}, {0, -4, -3}, CW_KNOWN_UNIT | CW_KNOWN_FRAME},
        {NULL, OBLIQUE, {0, 0, 0}, {0, -4, -3}, CW_KNOWN_UNIT | CW_KNOWN_FRAME},
        {"10\\20\\30", NULL, {10, 20, 30}, {0, 0, 5}, CW_KNOWN_UNIT},
    };
    const cw_read_desc stated = {.spacing_mm = {2, 3, 5}};
    for (size_t n = 0; n < sizeof rows / sizeof *rows; n++) {
        write_counted("mf.dcm", &(test_counted){.sop_class = SOP "2",
                                                .modality = "CT",
                                                .between = "4",
                                                .position = rows[n].position,
                                                .orientation = rows[n].orientation,
                                                .frames = 3});
        assert_refused(NULL, CW_ERR_UNSAFE, "so where they lie is not known; desc->spacing_mm");
        cw_volume v = read_all(&stated);
        assert_frames(&v, 3, 1, (const int[]){0, 1, 2});
        assert_column(&v, 3, rows[n].from[0], rows[n].from[1], rows[n].from[2]);
        assert_column(&v, 2, rows[n].step[0], rows[n].step[1], rows[n].step[2]);
        assert_int_equal(v.known, rows[n].known);
        cw_volume_free(&v);
    }
}

/* Writes slices whose pixels are their number, at stated places. */
static void write_placed(const char *const *positions, const char *trigger_of_two, int count)
{
    for (int n = 0; n < count; n++) {
        char name[16];
        uint16_t pixels[PIXELS];
        for (int i = 0; i < PIXELS; i++)
            pixels[i] = (uint16_t)n;
        snprintf(name, sizeof name, "%d.dcm", n);
        test_image_write(&(test_image){.instance = n + 1,
                                       .position = positions[n],
                                       .trigger = n                ? trigger_of_two
                                                  : trigger_of_two ? "0"
                                                                   : NULL,
                                       .pixels = pixels},
                         name);
    }
}

static void files_of_one_place_follow_from_there(void **state)
{
    (void)state;
    const cw_read_desc stated = {.spacing_mm = {2, 3, 5}},
                       fine = {.spacing_mm = {2e-4, 2e-4, 1e-4}};
    const char *const same[] = {"10\\20\\30", "10\\20\\30", "10\\20\\30"};
    write_placed(same, NULL, 3);
    cw_volume v = read_all(&stated);
    assert_frames(&v, 3, 1, (const int[]){0, 1, 2});
    assert_column(&v, 3, 10, 20, 30);
    assert_column(&v, 2, 0, 0, 5);
    cw_volume_free(&v);
    v = read_all(&fine);
    assert_frames(&v, 3, 1, (const int[]){0, 1, 2});
    assert_column(&v, 2, 0, 0, 1e-4);
    cw_volume_free(&v);
    /* some places are missing; those that are stated run down */
    const char *const down[] = {"", "10\\20\\30", "10\\20\\26"};
    write_placed(down, NULL, 3);
    assert_refused(NULL, CW_ERR_UNSAFE, "1 of 3 images have no 'ImagePositionPatient'");
    v = read_all(&stated);
    assert_frames(&v, 3, 1, (const int[]){2, 1, 0});
    assert_column(&v, 3, 10, 20, 25);
    cw_volume_free(&v);
    /* moments of one slice stay moments */
    write_placed(same, "100", 2);
    unlink(test_path("2.dcm"));
    v = read_all(&stated);
    assert_frames(&v, 1, 2, (const int[]){0, 1});
    cw_volume_free(&v);
}

int main(void)
{
#define TEST(name) cmocka_unit_test_setup_teardown(name, test_folder_make, test_folder_remove)
    const struct CMUnitTest tests[] = {
        TEST(slices_of_nuclear_medicine_stack_both_ways),
        TEST(a_stated_spacing_keeps_the_side),
        TEST(offsets_of_dose_are_relative_or_absolute),
        TEST(offsets_that_mean_nothing_are_refused),
        TEST(moments_of_slices_are_steps),
        TEST(vectors_of_unknown_representation_are_read),
        TEST(numbered_slices_need_a_spacing_alone),
        TEST(frames_that_are_no_slices_are_refused),
        TEST(projections_are_not_stacked),
        TEST(the_place_of_the_first_frame_stays),
        TEST(files_of_one_place_follow_from_there),
    };
    if (!cwi_module_present("dicom")) {
        print_message("this build reads no DICOM\n");
        return 0;
    }
    return cmocka_run_group_tests(tests, NULL, NULL);
}
