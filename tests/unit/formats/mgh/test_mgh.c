/* Tests the reader of MGH: types, frames, gzip with what FreeSurfer puts behind the voxels, damage. */
#include "support/files/reading.h"
#include "support/files/regions.h"

#include <stdio.h>

enum { HEADER = 284, MAX_BYTES = 1024 };

typedef struct mgh_file {
    unsigned char bytes[MAX_BYTES];
    size_t size;
} mgh_file;

static void put_integer(mgh_file *f, size_t at, uint32_t value)
{
    for (size_t n = 0; n < 4; n++)
        f->bytes[at + n] = (unsigned char)(value >> (24 - 8 * n));
}

static void put_float(mgh_file *f, size_t at, float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    put_integer(f, at, bits);
}

static void put_floats(mgh_file *f, size_t at, const float *values, size_t count)
{
    for (size_t n = 0; n < count; n++)
        put_float(f, at + 4 * n, values[n]);
}

/* 2 x 3 x 2 bytes that count up, and the frame of FreeSurfer's own volumes: left, inferior, anterior. */
static mgh_file make_mgh(void)
{
    static const uint32_t head[] = {1, 2, 3, 2, 1, 0, 0};
    static const float frame[] = {1, 1, 1, -1, 0, 0, 0, 0, -1, 0, 1, 0, 5, 6, 7};
    mgh_file f = {.size = HEADER + 12};
    for (size_t n = 0; n < 7; n++)
        put_integer(&f, 4 * n, head[n]);
    f.bytes[29] = 1;
    put_floats(&f, 30, frame, 15);
    for (size_t n = 0; n < 12; n++)
        f.bytes[HEADER + n] = (unsigned char)n;
    return f;
}

static void save(const mgh_file *f, const char *name)
{
    test_file_write(test_path(name), f->bytes, f->size);
}

static void save_gzipped(const mgh_file *f, const char *name)
{
    size_t size;
    unsigned char *packed = pack_bytes(f->bytes, f->size, true, &size);
    test_file_write(test_path(name), packed, size);
    free(packed);
}

static void the_centre_is_half_way(void **state)
{
    (void)state;
    const mgh_file f = make_mgh();
    cw_volume v;
    cw_error err = {0};
    const char *format;
    save(&f, "a.bin");
    assert_ok(cw_volume_read(test_path("a.bin"), NULL, &v, &format, &err), err);
    assert_string_equal(format, "mgh");
    assert_int_equal(v.known, CW_KNOWN_UNIT | CW_KNOWN_FRAME);
    assert_memory_equal(v.data, f.bytes + HEADER, 12);
    assert_place(&v, 1, 1.5, 1, -5, -6, 7); /* RAS 5 6 7 */
    assert_place(&v, 0, 1.5, 1, -6, -6, 7); /* x runs to the left: LPS grows */
    assert_place(&v, 1, 0.5, 1, -5, -6, 8); /* y to the feet */
    assert_place(&v, 1, 1.5, 2, -5, -7, 7); /* z to the front */
    cw_volume_free(&v);
}

static void oblique_frames_keep_their_spacing(void **state)
{
    (void)state;
    static const float frame[] = {2, 3, 4, 0.6f, 0.8f, 0, -0.8f, 0.6f, 0, 0, 0, 1, 0, 0, 0};
    mgh_file f = make_mgh();
    cw_volume v;
    cw_error err = {0};
    double spacing[3];
    put_floats(&f, 30, frame, 15);
    save_gzipped(&f, "a.mgz");
    assert_ok(read_back("a.mgz", &v, &err), err);
    cw_volume_spacing(&v, spacing);
    for (int a = 0; a < 3; a++)
        assert_near(spacing[a], 2 + a, 1e-6);
    assert_near(v.affine[0][0], -1.2, 1e-6);
    assert_near(v.affine[1][1], -1.8, 1e-6);
    cw_volume_free(&v);
}

static void without_a_frame_it_is_coronal(void **state)
{
    (void)state;
    mgh_file f = make_mgh();
    cw_volume v;
    cw_error err = {0};
    f.bytes[29] = 0;
    memset(f.bytes + 30, 0xff, 60); /* NaN: not looked at */
    save(&f, "a.mgh");
    assert_ok(read_back("a.mgh", &v, &err), err);
    assert_place(&v, 1, 1.5, 1, 0, 0, 0);
    assert_place(&v, 2, 1.5, 1, 1, 0, 0);
    assert_place(&v, 1, 1.5, 2, 0, -1, 0);
    cw_volume_free(&v);
}

static void types_are_big_endian_and_frames_are_steps(void **state)
{
    (void)state;
    static const struct {
        uint32_t code;
        cw_type type;
        const char *bytes;
        double value;
    } cases[] = {{0, CW_U8, "\xfe", 254},
                 {1, CW_I32, "\xff\xff\xff\xfe", -2},
                 {3, CW_F32, "\x3f\xc0\0\0", 1.5},
                 {4, CW_I16, "\xff\xfe", -2},
                 {10, CW_U16, "\xff\xfe", 65534}};
    for (size_t n = 0; n < sizeof cases / sizeof *cases; n++) {
        mgh_file f = make_mgh();
        cw_volume v, last;
        cw_error err = {0};
        const size_t size = cw_type_size(cases[n].type);
        put_integer(&f, 20, cases[n].code);
        put_integer(&f, 16, 2);
        f.size = HEADER + 24 * size;
        memcpy(f.bytes + f.size - size, cases[n].bytes, size);
        save(&f, "a.mgh");
        assert_ok(read_back("a.mgh", &v, &err), err);
        assert_true(v.type == cases[n].type && v.steps == 2);
        assert_ok(cw_volume_select(&v, 0, 1, &last, &err), err);
        assert_true(cw_volume_value(&last, 1, 2, 1) == cases[n].value);
        cw_volume_free(&v);
    }
}

/* FreeSurfer writes the times of the sequence and tags behind the voxels. */
static void what_is_behind_the_voxels_is_left_out(void **state)
{
    (void)state;
    mgh_file f = make_mgh();
    cw_volume v;
    cw_error err = {0};
    put_float(&f, f.size, 2300);
    put_integer(&f, f.size + 20, 3);
    f.size += 100;
    save(&f, "a.mgh");
    assert_ok(read_back("a.mgh", &v, &err), err);
    cw_volume_free(&v);
    save_gzipped(&f, "a.mgz");
    assert_ok(read_back("a.mgz", &v, &err), err);
    assert_memory_equal(v.data, f.bytes + HEADER, 12);
    cw_volume_free(&v);
    check_regions("a.mgz", NULL);
}

static void damaged_headers_are_told_field_by_field(void **state)
{
    (void)state;
    static const struct {
        size_t at;
        uint32_t value;
        cw_status status;
        const char *words;
    } cases[] = {
        {0, 2, CW_ERR_FORMAT, "'version' is 2; 1 was expected"},
        {4, 0, CW_ERR_FORMAT, "'width' is 0; it must be 1 or more"},
        {12, 0x80000000u, CW_ERR_FORMAT, "'depth' is -2147483648"},
        {16, 0, CW_ERR_FORMAT, "'nframes' is 0"},
        {20, 5, CW_ERR_FORMAT, "'type' is 5 (bitmap)"},
        {20, 99, CW_ERR_FORMAT, "'type' is 99"},
        {8, 0x7fffffff, CW_ERR_FORMAT, "width, height, depth, nframes"},
        {34, 0, CW_ERR_FORMAT, "delta, Mdc, Pxyz_c"},
        {42, 0x7fc00000, CW_ERR_FORMAT, "delta, Mdc, Pxyz_c"},
    };
    for (size_t n = 0; n < sizeof cases / sizeof *cases; n++) {
        mgh_file f = make_mgh();
        cw_volume v;
        cw_error err = {0};
        put_integer(&f, cases[n].at, cases[n].value);
        save(&f, "a.mgh");
        assert_fails(read_back("a.mgh", &v, &err), cases[n].status, cases[n].words, err);
    }
}

static void a_cut_is_never_a_volume(void **state)
{
    (void)state;
    const mgh_file f = make_mgh();
    save(&f, "a.mgh");
    check_every_cut("a.mgh");
    save_gzipped(&f, "a.mgz");
    check_every_cut("a.mgz");
}

int main(void)
{
#define TEST(name) cmocka_unit_test_setup_teardown(name, test_folder_make, test_folder_remove)
    const struct CMUnitTest tests[] = {
        TEST(the_centre_is_half_way),
        TEST(oblique_frames_keep_their_spacing),
        TEST(without_a_frame_it_is_coronal),
        TEST(types_are_big_endian_and_frames_are_steps),
        TEST(what_is_behind_the_voxels_is_left_out),
        TEST(damaged_headers_are_told_field_by_field),
        TEST(a_cut_is_never_a_volume),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
