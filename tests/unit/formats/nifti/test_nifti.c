/* Tests the reader of NIfTI: versions, sform and qform, units, scaling, pairs of files, and
 * damage. */
#define _GNU_SOURCE /* symlink */
#include "formats/nifti/nifti.h"
#include "support/files/reading.h"
#include "support/files/regions.h"

#include <math.h>
#include <stdio.h>
#include <unistd.h>

/* A NIfTI file in memory: header, four zero bytes, voxels. */
typedef struct nifti_file {
    const cwi_nifti_layout *layout;
    unsigned char bytes[544 + 64];
    size_t size;
} nifti_file;

static void put(nifti_file *f, cwi_nifti_field field, int index, double value)
{
    cwi_nifti_put(f->layout, f->bytes, field, index, value);
}

/* 2 x 3 x 2 int16 voxels 0 to 11, 1 mm apart, sform the identity in RAS. */
static nifti_file make_nifti(int version)
{
    nifti_file f = {.layout = &cwi_nifti_layouts[version - 1]};
    const double dim[8] = {3, 2, 3, 2, 1, 1, 1, 1};
    put(&f, CWI_NIFTI_SIZEOF_HDR, 0, (double)f.layout->bytes);
    put(&f, CWI_NIFTI_VOX_OFFSET, 0, (double)f.layout->voxels);
    memcpy(f.bytes + f.layout->magic, f.layout->one_file, f.layout->magic_bytes);
    put(&f, CWI_NIFTI_DATATYPE, 0, 4);
    put(&f, CWI_NIFTI_BITPIX, 0, 16);
    for (int i = 0; i < 8; i++) {
        put(&f, CWI_NIFTI_DIM, i, dim[i]);
        put(&f, CWI_NIFTI_PIXDIM, i, 1);
    }
    put(&f, CWI_NIFTI_SFORM_CODE, 0, 1);
    for (int r = 0; r < 3; r++)
        put(&f, CWI_NIFTI_SROW, 5 * r, 1);
    put(&f, CWI_NIFTI_XYZT_UNITS, 0, 2);
    for (int16_t i = 0; i < 12; i++)
        memcpy(f.bytes + f.layout->voxels + 2 * i, &i, 2);
    f.size = f.layout->voxels + 24;
    return f;
}

static void save(const nifti_file *f, const char *name)
{
    put_file(name, "", f->bytes, f->size);
}

static void save_gzipped(const nifti_file *f, const char *name)
{
    size_t size;
    unsigned char *packed = pack_bytes(f->bytes, f->size, true, &size);
    put_file(name, "", packed, size);
    free(packed);
}

static void reverse(unsigned char *p, size_t count, size_t size)
{
    for (size_t i = 0; i < count; i++, p += size)
        for (size_t b = 0; b < size / 2; b++) {
            const unsigned char kept = p[b];
            p[b] = p[size - 1 - b];
            p[size - 1 - b] = kept;
        }
}

/* The same file as the other kind of machine would write it. */
static void turn_bytes(nifti_file *f)
{
    static const size_t counts[CWI_NIFTI_FIELD_COUNT] = {
        [CWI_NIFTI_SIZEOF_HDR] = 1, [CWI_NIFTI_DATATYPE] = 1,   [CWI_NIFTI_BITPIX] = 1,
        [CWI_NIFTI_DIM] = 8,        [CWI_NIFTI_PIXDIM] = 8,     [CWI_NIFTI_VOX_OFFSET] = 1,
        [CWI_NIFTI_SCL_SLOPE] = 1,  [CWI_NIFTI_SCL_INTER] = 1,  [CWI_NIFTI_QFORM_CODE] = 1,
        [CWI_NIFTI_SFORM_CODE] = 1, [CWI_NIFTI_QUATERN] = 3,    [CWI_NIFTI_QOFFSET] = 3,
        [CWI_NIFTI_SROW] = 12,      [CWI_NIFTI_XYZT_UNITS] = 1, [CWI_NIFTI_INTENT_CODE] = 1,
    };
    for (int field = 0; field < CWI_NIFTI_FIELD_COUNT; field++) {
        const char kind = f->layout->field[field].kind;
        const size_t size = kind == 'b'                  ? 1
                            : kind == 'h'                ? 2
                            : kind == 'i' || kind == 'f' ? 4
                                                         : 8;
        reverse(f->bytes + f->layout->field[field].offset, counts[field], size);
    }
    reverse(f->bytes + f->layout->voxels, 12, 2);
}

/* The file is in RAS mm: a caller may say otherwise, if the rule lets him. */
static void claims_are_held_against_the_file(void **state)
{
    (void)state;
    const struct {
        cw_claim claim;
        double affine[12];
        const char *words;
    } cases[] = {
        {{.has_unit = true, .axes.unit = CW_UNIT_MM},
         {-1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1, 0},
         NULL},
        {{.has_unit = true, .axes.unit = CW_UNIT_M}, {0}, "its unit is mm, and not m"},
        {{.has_frame = true}, {0}, "its frame is ras, and not lps"},
        {{.has_up = true, .axes.y_up = true}, {0}, "z is up, and not y"},
        {{.has_unit = true, .axes.unit = CW_UNIT_M, .rule = CW_CLAIM_FILL},
         {-1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1, 0},
         NULL},
        {{.has_unit = true, .axes.unit = CW_UNIT_CM, .rule = CW_CLAIM_OVERRIDE},
         {-10, 0, 0, 0, 0, -10, 0, 0, 0, 0, 10, 0},
         NULL},
        {{.has_frame = true, .has_up = true, .axes.y_up = true, .rule = CW_CLAIM_OVERRIDE},
         {1, 0, 0, 0, 0, 0, -1, 0, 0, 1, 0, 0},
         NULL},
    };
    const nifti_file f = make_nifti(1);
    save(&f, "a.nii");
    for (size_t n = 0; n < sizeof cases / sizeof *cases; n++) {
        const cw_read_desc desc = {.claim = cases[n].claim};
        cw_volume v;
        cw_error err = {0};
        const cw_status st = cw_volume_read(test_path("a.nii"), &desc, &v, NULL, &err);
        if (cases[n].words) {
            assert_fails(st, CW_ERR_ARGUMENT, cases[n].words, err);
            assert_null(v.data);
            continue;
        }
        assert_ok(st, err);
        check_affine(&v, cases[n].affine);
        cw_volume_free(&v);
    }
}

static void the_intent_tells_labels(void **state)
{
    (void)state;
    for (int version = 1; version <= 2; version++) {
        nifti_file f = make_nifti(version);
        cw_volume v;
        cw_error err = {0};
        put(&f, CWI_NIFTI_INTENT_CODE, 0, 1002);
        save(&f, "a.nii");
        assert_ok(cw_volume_read(test_path("a.nii"), NULL, &v, NULL, &err), err);
        assert_true(v.known & CW_KNOWN_LABELS);
        cw_volume_free(&v);
    }
}

static void both_versions_byte_orders_and_packings_are_the_same(void **state)
{
    (void)state;
    for (int way = 0; way < 8; way++) {
        nifti_file f = make_nifti(1 + way % 2);
        const char *name = way & 4 ? "a.nii.gz" : "a.nii", *format = NULL;
        cw_volume v;
        cw_error err = {0};
        if (way & 2)
            turn_bytes(&f);
        way & 4 ? save_gzipped(&f, name) : save(&f, name);
        assert_ok(cw_volume_read(test_path(name), NULL, &v, &format, &err), err);
        assert_string_equal(format, "nifti");
        assert_int_equal(v.type, CW_I16);
        assert_int_equal(v.known, CW_KNOWN_FRAME | CW_KNOWN_UNIT);
        check_affine(&v, (const double[12]){-1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1, 0});
        for (size_t i = 0; i < 12; i++)
            assert_true(cw_volume_value(&v, i % 2, i / 2 % 3, i / 6) == (double)i);
        check_regions(name, NULL);
        cw_volume_free(&v);
    }
}

static void read_made(const nifti_file *f, cw_volume *v)
{
    cw_error err = {0};
    save(f, "a.nii");
    assert_ok(read_back("a.nii", v, &err), err);
}

/* Index (1, 2, 1) in RAS on paper, turned to LPS. */
static void sform_goes_before_qform(void **state)
{
    (void)state;
    const double rows[12] = {-2, 0.5, 0, 10, 0.25, 3, 0, 20, 0, 0, 4, 30};
    nifti_file f = make_nifti(1);
    cw_volume v;
    for (int i = 0; i < 12; i++)
        put(&f, CWI_NIFTI_SROW, i, rows[i]);
    put(&f, CWI_NIFTI_QFORM_CODE, 0, 1);
    read_made(&f, &v);
    check_affine(&v, (const double[12]){2, -0.5, 0, -10, -0.25, -3, 0, -20, 0, 0, 4, 30});
    cw_volume_free(&v);
}

static void qform_is_a_rotation_an_offset_and_a_mirror(void **state)
{
    (void)state;
    const double half = sqrt(0.5);
    const struct {
        double quaternion[3], qfac, lps[12];
    } cases[] = {
        {{0, 0, 0}, 1, {-2, 0, 0, -5, 0, -3, 0, -6, 0, 0, 4, 7}},
        {{0, 0, 0}, 0, {-2, 0, 0, -5, 0, -3, 0, -6, 0, 0, 4, 7}},
        {{0, 0, 0}, -1, {-2, 0, 0, -5, 0, -3, 0, -6, 0, 0, -4, 7}},
        {{0, 0, 1}, 1, {2, 0, 0, -5, 0, 3, 0, -6, 0, 0, 4, 7}},       /* half turn about z */
        {{0, 0, half}, 1, {0, 3, 0, -5, -2, 0, 0, -6, 0, 0, 4, 7}},   /* quarter: x to y */
        {{half, 0, 0}, -1, {-2, 0, 0, -5, 0, 0, -4, -6, 0, 3, 0, 7}}, /* quarter: y to z */
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        nifti_file f = make_nifti(2);
        cw_volume v;
        put(&f, CWI_NIFTI_SFORM_CODE, 0, 0);
        put(&f, CWI_NIFTI_QFORM_CODE, 0, 1);
        put(&f, CWI_NIFTI_PIXDIM, 0, cases[i].qfac);
        for (int a = 0; a < 3; a++) {
            put(&f, CWI_NIFTI_QUATERN, a, cases[i].quaternion[a]);
            put(&f, CWI_NIFTI_PIXDIM, a + 1, 2 + a);
            put(&f, CWI_NIFTI_QOFFSET, a, 5 + a);
        }
        read_made(&f, &v);
        for (int k = 0; k < 12; k++)
            assert_near(v.affine[k / 4][k % 4], cases[i].lps[k], 1e-12);
        assert_int_equal(v.known, CW_KNOWN_FRAME | CW_KNOWN_UNIT);
        cw_volume_free(&v);
    }
}

static void without_either_only_spacing_is_known(void **state)
{
    (void)state;
    nifti_file f = make_nifti(1);
    cw_volume v;
    put(&f, CWI_NIFTI_SFORM_CODE, 0, 0);
    put(&f, CWI_NIFTI_PIXDIM, 2, 2.5);
    read_made(&f, &v);
    check_affine(&v, (const double[12]){1, 0, 0, 0, 0, 2.5, 0, 0, 0, 0, 1, 0});
    assert_int_equal(v.known, CW_KNOWN_UNIT);
    cw_volume_free(&v);
}

static void units_become_millimetres_and_seconds(void **state)
{
    (void)state;
    const struct {
        int units;
        double mm, seconds;
        unsigned known;
    } cases[] = {
        {0, 1, 0, CW_KNOWN_FRAME},
        {2 | 8, 1, 3, CW_KNOWN_FRAME | CW_KNOWN_UNIT},
        {1 | 16, 1000, 3e-3, CW_KNOWN_FRAME | CW_KNOWN_UNIT},
        {3 | 24, 1e-3, 3e-6, CW_KNOWN_FRAME | CW_KNOWN_UNIT},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        nifti_file f = make_nifti(1);
        cw_volume v;
        put(&f, CWI_NIFTI_DIM, 0, 4);
        put(&f, CWI_NIFTI_DIM, 3, 1);
        put(&f, CWI_NIFTI_DIM, 4, 2);
        put(&f, CWI_NIFTI_PIXDIM, 4, 3);
        put(&f, CWI_NIFTI_XYZT_UNITS, 0, cases[i].units);
        read_made(&f, &v);
        assert_int_equal(v.steps, 2);
        assert_near(v.step_seconds, cases[i].seconds, 1e-15);
        assert_near(v.affine[2][2], cases[i].mm, 1e-15);
        assert_int_equal(v.known, cases[i].known);
        cw_volume_free(&v);
    }
}

/* pixdim[4] of a file that has no fourth axis is left over from whatever wrote it. */
static void only_steps_have_a_length(void **state)
{
    (void)state;
    nifti_file f = make_nifti(1);
    cw_volume v;
    put(&f, CWI_NIFTI_PIXDIM, 4, 3);
    put(&f, CWI_NIFTI_XYZT_UNITS, 0, 2 | 8);
    read_made(&f, &v);
    assert_true(v.step_seconds == 0);
    cw_volume_free(&v);
}

static void scaling_is_kept_beside_the_voxels(void **state)
{
    (void)state;
    const struct {
        double slope, intercept, value_of_11;
    } cases[] = {{0, 5, 11},        {NAN, 5, 11},      {2, NAN, 11},
                 {2, -1024, -1002}, {1, -1024, -1013}, {-1, 0, -11}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        nifti_file f = make_nifti(1);
        cw_volume v;
        put(&f, CWI_NIFTI_SCL_SLOPE, 0, cases[i].slope);
        put(&f, CWI_NIFTI_SCL_INTER, 0, cases[i].intercept);
        read_made(&f, &v);
        assert_true(cw_volume_value(&v, 1, 2, 1) == cases[i].value_of_11);
        cw_volume_free(&v);
    }
}

/* The fifth dimension is the slowest: component 1 starts behind all of component 0. */
static void the_fifth_dimension_holds_components(void **state)
{
    (void)state;
    nifti_file f = make_nifti(1);
    cw_volume v, second;
    cw_error err = {0};
    put(&f, CWI_NIFTI_DIM, 0, 5);
    put(&f, CWI_NIFTI_DIM, 3, 1);
    put(&f, CWI_NIFTI_DIM, 5, 2);
    read_made(&f, &v);
    assert_int_equal(v.components, 2);
    assert_ok(cw_volume_select(&v, 1, 0, &second, &err), err);
    assert_true(cw_volume_value(&second, 1, 0, 0) == 7);
    cw_volume_free(&v);
}

static void colours_are_components_side_by_side(void **state)
{
    (void)state;
    nifti_file f = make_nifti(1);
    cw_volume v, green;
    cw_error err = {0};
    put(&f, CWI_NIFTI_DATATYPE, 0, 128);
    put(&f, CWI_NIFTI_BITPIX, 0, 24);
    put(&f, CWI_NIFTI_DIM, 3, 1);
    f.bytes[352 + 4] = 99;
    read_made(&f, &v);
    assert_int_equal(v.type, CW_U8);
    assert_int_equal(v.components, 3);
    assert_ok(cw_volume_select(&v, 1, 0, &green, &err), err);
    assert_true(cw_volume_value(&green, 1, 0, 0) == 99);
    cw_volume_free(&v);
}

static void a_pair_of_files_is_one_volume(void **state)
{
    (void)state;
    nifti_file f = make_nifti(1);
    cw_volume v;
    cw_error err = {0};
    memcpy(f.bytes + f.layout->magic, f.layout->pair, 4);
    put(&f, CWI_NIFTI_VOX_OFFSET, 0, 0);
    put_file("head.hdr", "", f.bytes, 348);
    put_file("head.img", "", f.bytes + 352, 24);
    assert_ok(read_back("head.hdr", &v, &err), err);
    assert_true(cw_volume_value(&v, 1, 2, 1) == 11);
    cw_volume_free(&v);
    assert_ok(read_back("head.img", &v, &err), err);
    assert_true(cw_volume_value(&v, 1, 2, 1) == 11);
    cw_volume_free(&v);
    check_regions("head.img", NULL);
    put_file("alone.img", "", f.bytes + 352, 24);
    assert_fails(read_back("alone.img", &v, &err), CW_ERR_FORMAT,
                 "has its header beside it, and 'alone.hdr' is not there", err);
    put_file("alone.hdr", "short", NULL, 0);
    assert_fails(read_back("alone.img", &v, &err), CW_ERR_FORMAT, "alone.hdr: 'sizeof_hdr' is",
                 err);
    put_file("head.hdr.hdr", "", f.bytes, 348); /* the last one is the extension */
    put_file("head.hdr.img", "", f.bytes + 352, 24);
    assert_ok(read_back("head.hdr.hdr", &v, &err), err);
    cw_volume_free(&v);
    check_cuts("head.hdr", "head.img", 0);
    assert_int_equal(rename(test_path("head.img"), test_path("other.img")), 0);
    assert_fails(read_back("head.hdr", &v, &err), CW_ERR_IO, "head.img: cannot be opened", err);
    assert_int_equal(symlink("other.img", test_path("head.img")), 0);
    assert_fails(read_back("head.hdr", &v, &err), CW_ERR_UNSAFE, "a symbolic link", err);
    put_file("head.nii", "", f.bytes, 348);
    assert_fails(read_back("head.nii", &v, &err), CW_ERR_FORMAT, "must be named .hdr", err);
}

/* One field set to one number, and words of the message. */
static void impossible_fields_are_named(void **state)
{
    (void)state;
    const struct {
        cwi_nifti_field field;
        int index;
        double value;
        const char *words;
    } cases[] = {
        {CWI_NIFTI_DIM, 0, 0, "'dim[0]' is 0; it must be 1 to 7"},
        {CWI_NIFTI_DIM, 0, 8, "'dim[0]' is 8"},
        {CWI_NIFTI_DIM, 2, 0, "'dim[2]' is 0"},
        {CWI_NIFTI_DIM, 2, -3, "'dim[2]' is -3"},
        {CWI_NIFTI_DIM, 3, 32767, "'dim' asks for 393204 bytes"},
        {CWI_NIFTI_DATATYPE, 0, 1536,
         "'datatype' is 1536 (float128); the types that are read are u8"},
        {CWI_NIFTI_DATATYPE, 0, 1792, "1792 (complex128)"},
        {CWI_NIFTI_DATATYPE, 0, 77, "'datatype' is 77"},
        {CWI_NIFTI_BITPIX, 0, 8, "'bitpix' is 8; 'datatype' 4 (int16) has 16"},
        {CWI_NIFTI_VOX_OFFSET, 0, 12,
         "'vox_offset' is 12; it must be a whole number of at least 352"},
        {CWI_NIFTI_VOX_OFFSET, 0, NAN, "'vox_offset' is"},
        {CWI_NIFTI_VOX_OFFSET, 0, 352.5, "'vox_offset' is 352.5"},
        {CWI_NIFTI_VOX_OFFSET, 0, 1e15, "'dim' asks for 24 bytes"},
        {CWI_NIFTI_SROW, 0, 0, "'srow' gives axis 0 no length"},
        {CWI_NIFTI_SROW, 0, NAN, "'srow' has numbers that are not finite"},
        {CWI_NIFTI_SROW, 3, INFINITY, "'srow' has numbers that are not finite"},
        {CWI_NIFTI_SIZEOF_HDR, 0, 347,
         "'sizeof_hdr' is 347; a header of NIfTI or Analyze starts with 348 or 540"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        nifti_file f = make_nifti(1);
        cw_volume v;
        cw_error err = {0};
        put(&f, cases[i].field, cases[i].index, cases[i].value);
        save(&f, "a.nii");
        assert_fails(read_back("a.nii", &v, &err), CW_ERR_FORMAT, cases[i].words, err);
    }
}

static void directions_in_one_plane_are_refused(void **state)
{
    (void)state;
    nifti_file f = make_nifti(1);
    put(&f, CWI_NIFTI_SROW, 1, 1); /* y runs as x does */
    put(&f, CWI_NIFTI_SROW, 5, 0);
    save(&f, "a.nii");
    check_told("a.nii", 0, "'srow' gives directions that lie in one plane");
}

/* NIfTI-2 counts in 64 bits. */
static void sizes_beyond_memory_are_refused(void **state)
{
    (void)state;
    nifti_file f = make_nifti(2);
    for (int d = 1; d < 4; d++)
        put(&f, CWI_NIFTI_DIM, d, 2147483647);
    save(&f, "a.nii");
    check_told("a.nii", 0, "'dim' asks for more voxels than an address space holds");
    put(&f, CWI_NIFTI_DIM, 3, 1);
    save(&f, "a.nii");
    check_told("a.nii", 1,
               "'dim' asks for 9223372028264841218 bytes of voxels; the file holds");
    put(&f, CWI_NIFTI_DIM, 1, 2147483648);
    save(&f, "a.nii");
    check_told("a.nii", 2, "'dim[1]' is 2147483648");
}

static void impossible_spacings_and_quaternions_are_named(void **state)
{
    (void)state;
    nifti_file f = make_nifti(1);
    cw_volume v;
    cw_error err = {0};
    put(&f, CWI_NIFTI_SFORM_CODE, 0, 0);
    put(&f, CWI_NIFTI_PIXDIM, 3, 0);
    save(&f, "a.nii");
    assert_fails(read_back("a.nii", &v, &err), CW_ERR_FORMAT, "'pixdim[3]' is 0", err);
    put(&f, CWI_NIFTI_QFORM_CODE, 0, 1);
    put(&f, CWI_NIFTI_QUATERN, 1, NAN);
    save(&f, "a.nii");
    assert_fails(read_back("a.nii", &v, &err), CW_ERR_FORMAT, "'quatern_b'", err);
}

/* Fields in the places of NIfTI's codes mean something else in Analyze, and are not looked at. */
static void analyze_has_spacings_and_no_sides(void **state)
{
    (void)state;
    for (int swapped = 0; swapped < 2; swapped++) {
        nifti_file f = make_nifti(1);
        cw_volume v;
        cw_error err = {0};
        put(&f, CWI_NIFTI_PIXDIM, 3, 4);
        put(&f, CWI_NIFTI_QFORM_CODE, 0, 1);
        put(&f, CWI_NIFTI_INTENT_CODE, 0, 1002);
        put(&f, CWI_NIFTI_VOX_OFFSET, 0, 0);
        if (swapped)
            turn_bytes(&f);
        memset(f.bytes + f.layout->magic, 0, 4);
        memcpy(f.bytes + 56, "mm\0", 4);
        put_file("a.img", "", f.bytes + f.layout->voxels, 24);
        f.size = 348;
        save(&f, "a.hdr");
        assert_ok(read_back("a.hdr", &v, &err), err);
        assert_int_equal(v.known, CW_KNOWN_UNIT);
        assert_true(v.affine[0][0] == 1 && v.affine[2][2] == 4);
        assert_true(cw_volume_value(&v, 1, 0, 0) == 1);
        cw_volume_free(&v);
    }
}

static void what_only_looks_like_nifti_is_told_apart(void **state)
{
    (void)state;
    nifti_file f = make_nifti(1);
    cw_volume v;
    cw_error err = {0};
    put_file("text.nii", "This is no NIfTI file.", NULL, 0);
    assert_fails(read_back("text.nii", &v, &err), CW_ERR_FORMAT, "'sizeof_hdr' is", err);
    memset(f.bytes + f.layout->magic, 0, 4);
    save(&f, "analyze.nii");
    assert_fails(read_back("analyze.nii", &v, &err), CW_ERR_FORMAT, "Analyze 7.5", err);
    save_gzipped(&f, "a.nii.gz");
    assert_fails(read_back("a.nii.gz", &v, &err), CW_ERR_FORMAT,
                 "inside the gzip file, 'magic'", err);
    f.size = 100;
    save(&f, "short.nii");
    assert_fails(read_back("short.nii", &v, &err), CW_ERR_FORMAT, "ends after 100 of 348", err);
}

static void a_cut_is_never_a_volume(void **state)
{
    (void)state;
    for (int version = 1; version < 3; version++) {
        const nifti_file f = make_nifti(version);
        save(&f, "a.nii");
        check_every_cut("a.nii");
        save_gzipped(&f, "a.nii.gz");
        check_every_cut("a.nii.gz");
    }
}

static void broken_gzip_is_an_error(void **state)
{
    (void)state;
    const nifti_file f = make_nifti(1);
    cw_volume v;
    cw_error err = {0};
    size_t size;
    unsigned char *packed = pack_bytes(f.bytes, f.size, true, &size);
    put_file("a.nii.gz", "", packed, size);
    check_tail("a.nii.gz", "a.nii.gz");
    put_file("cut.nii.gz", "", packed, size - 1);
    assert_fails(read_back("cut.nii.gz", &v, &err), CW_ERR_FORMAT, "before their checksum",
                 err);
    packed[size > 6 ? size - 6 : 0] ^= 1; /* in the checksum */
    put_file("bad.nii.gz", "", packed, size);
    assert_fails(read_back("bad.nii.gz", &v, &err), CW_ERR_FORMAT, "incorrect data check", err);
    free(packed);
}

/* A small gzip file cannot hold many voxels, whatever its header says. */
static void bombs_are_refused_before_any_allocation(void **state)
{
    (void)state;
    nifti_file f = make_nifti(1);
    cw_volume v;
    cw_error err = {0};
    for (int d = 1; d < 4; d++)
        put(&f, CWI_NIFTI_DIM, d, 32767);
    save_gzipped(&f, "a.nii.gz");
    assert_fails(read_back("a.nii.gz", &v, &err), CW_ERR_FORMAT, "'dim' asks for 70362301",
                 err);
}

static void memory_may_run_out_anywhere(void **state)
{
    (void)state;
    const nifti_file f = make_nifti(1);
    save_gzipped(&f, "a.nii.gz");
    check_starved_reads("a.nii.gz");
}

int main(void)
{
#define TEST(name) cmocka_unit_test_setup_teardown(name, test_folder_make, test_folder_remove)
    const struct CMUnitTest tests[] = {
        TEST(claims_are_held_against_the_file),
        TEST(the_intent_tells_labels),
        TEST(both_versions_byte_orders_and_packings_are_the_same),
        TEST(sform_goes_before_qform),
        TEST(qform_is_a_rotation_an_offset_and_a_mirror),
        TEST(without_either_only_spacing_is_known),
        TEST(units_become_millimetres_and_seconds),
        TEST(only_steps_have_a_length),
        TEST(scaling_is_kept_beside_the_voxels),
        TEST(the_fifth_dimension_holds_components),
        TEST(colours_are_components_side_by_side),
        TEST(a_pair_of_files_is_one_volume),
        TEST(impossible_fields_are_named),
        TEST(directions_in_one_plane_are_refused),
        TEST(sizes_beyond_memory_are_refused),
        TEST(impossible_spacings_and_quaternions_are_named),
        TEST(analyze_has_spacings_and_no_sides),
        TEST(what_only_looks_like_nifti_is_told_apart),
        TEST(a_cut_is_never_a_volume),
        TEST(broken_gzip_is_an_error),
        TEST(bombs_are_refused_before_any_allocation),
        TEST(memory_may_run_out_anywhere),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
