/* Tests the names of labels in NIfTI files: extensions with a LabelTable. */
#include "formats/nifti/nifti.h"
#include "support/files/reading.h"

#include <stdio.h>

#define LIVER                                                                                  \
    "<LabelTable><Label Key=\"5\" Red=\"1\" Green=\"0.5\" Blue=\"0\">liver</Label></LabelTable>"
#define CARET                                                                                  \
    "<?xml version=\"1.0\"?><CaretExtension><VolumeInformation Index=\"0\">" LIVER             \
    "</VolumeInformation></CaretExtension>"

/* A NIfTI file in memory: a header, extensions and 12 voxels of 8 bits. */
typedef struct label_file {
    unsigned char bytes[4096];
    size_t size;
    const cwi_nifti_layout *layout;
    bool swapped;
} label_file;

static void put_int(label_file *f, size_t at, int32_t value)
{
    uint32_t bits = (uint32_t)value;
    if (f->swapped)
        bits = __builtin_bswap32(bits);
    memcpy(f->bytes + at, &bits, sizeof bits);
}

static void put_field(label_file *f, cwi_nifti_field field, int index, double value)
{
    cwi_nifti_put(f->layout, f->bytes, field, index, value);
}

static void start_file(label_file *f, int version)
{
    *f = (label_file){.layout = &cwi_nifti_layouts[version - 1]};
    const double dim[8] = {3, 2, 3, 2, 1, 1, 1, 1};
    put_field(f, CWI_NIFTI_SIZEOF_HDR, 0, (double)f->layout->bytes);
    put_field(f, CWI_NIFTI_DATATYPE, 0, 2);
    put_field(f, CWI_NIFTI_BITPIX, 0, 8);
    for (int i = 0; i < 8; i++) {
        put_field(f, CWI_NIFTI_DIM, i, dim[i]);
        put_field(f, CWI_NIFTI_PIXDIM, i, 1);
    }
    memcpy(f->bytes + f->layout->magic, f->layout->one_file, f->layout->magic_bytes);
    f->size = f->layout->voxels;
}

/* Adds an extension; its size is stated as `size`, or, for 0, as it is. */
static void add_extension(label_file *f, int32_t size, int32_t code, const char *text)
{
    const size_t bytes = (8 + strlen(text) + 15) / 16 * 16;
    f->bytes[f->layout->bytes] = 1;
    put_int(f, f->size, size ? size : (int32_t)bytes);
    put_int(f, f->size + 4, code);
    memcpy(f->bytes + f->size + 8, text, strlen(text));
    f->size += bytes;
}

static void end_file(label_file *f)
{
    put_field(f, CWI_NIFTI_VOX_OFFSET, 0, (double)f->size);
    memset(f->bytes + f->size, 5, 12);
    f->size += 12;
}

static void save_file(const label_file *f, const char *name)
{
    size_t size;
    if (!strstr(name, ".gz")) {
        put_file(name, "", f->bytes, f->size);
        return;
    }
    unsigned char *packed = pack_bytes(f->bytes, f->size, true, &size);
    put_file(name, "", packed, size);
    free(packed);
}

static void keep_note(void *user, const char *text)
{
    snprintf(user, 256, "%s", text);
}

static void expect_liver(const char *name, bool header_only)
{
    cw_label_table table = {0};
    cw_volume v;
    cw_error err = {0};
    const cw_read_desc desc = {.labels = &table, .header_only = header_only};
    for (int again = 0; again < 2; again++) { /* the table is emptied first */
        assert_ok(cw_volume_read(test_path(name), &desc, &v, NULL, &err), err);
        assert_true(v.known & CW_KNOWN_LABELS);
        assert_int_equal(table.count, 1);
        assert_int_equal(table.labels[0].value, 5);
        assert_string_equal(table.labels[0].name, "liver");
        assert_memory_equal(table.labels[0].color, ((uint8_t[4]){255, 128, 0, 255}), 4);
        cw_volume_free(&v);
    }
    cw_label_table_free(&table);
    assert_ok(cw_volume_read(test_path(name), NULL, &v, NULL, &err), err);
    assert_true(v.known & CW_KNOWN_LABELS);
    cw_volume_free(&v);
}

static void extensions_hold_names(void **state)
{
    (void)state;
    for (int way = 0; way < 8; way++) {
        const char *name = way & 2 ? "a.nii.gz" : "a.nii";
        label_file f;
        start_file(&f, 1 + way % 2);
        add_extension(&f, 0, 6, "a comment");
        add_extension(&f, 0, 4, "<AFNI_attributes/>");
        add_extension(&f, 0, way & 4 ? 30 : 0, way & 4 ? CARET : LIVER);
        add_extension(&f, 0, 0, "<LabelTable><Label Key=\"6\">other</Label></LabelTable>");
        end_file(&f);
        save_file(&f, name);
        expect_liver(name, false);
        expect_liver(name, true);
    }
}

/* The sizes of extensions have the byte order of the header. */
static void the_other_byte_order_is_read(void **state)
{
    (void)state;
    static const struct {
        size_t at, size;
    } fields[] = {{0, 4},  {40, 2}, {42, 2}, {44, 2},  {46, 2},  {48, 2}, {50, 2},
                  {52, 2}, {54, 2}, {70, 2}, {72, 2},  {76, 4},  {80, 4}, {84, 4},
                  {88, 4}, {92, 4}, {96, 4}, {100, 4}, {104, 4}, {108, 4}};
    label_file f;
    start_file(&f, 1);
    f.swapped = true;
    add_extension(&f, 0, 30, CARET);
    end_file(&f);
    for (size_t n = 0; n < sizeof fields / sizeof *fields; n++)
        for (size_t b = 0; b < fields[n].size / 2; b++) {
            unsigned char *p = f.bytes + fields[n].at, kept = p[b];
            p[b] = p[fields[n].size - 1 - b];
            p[fields[n].size - 1 - b] = kept;
        }
    save_file(&f, "a.nii");
    expect_liver("a.nii", false);
}

static void a_pair_has_them_in_its_header(void **state)
{
    (void)state;
    label_file f;
    start_file(&f, 1);
    add_extension(&f, 0, 0, LIVER);
    memcpy(f.bytes + f.layout->magic, f.layout->pair, f.layout->magic_bytes);
    put_file("a.img", "123456789012", NULL, 0);
    put_file("a.hdr", "", f.bytes, f.size);
    expect_liver("a.hdr", false);
}

/* Reads a file whose extension is of no use: the volume is read all the same. */
static void expect_nothing(const label_file *f, const char *words)
{
    static const char *const names[] = {"a.nii", "a.nii.gz"};
    for (int n = 0; n < 2; n++) {
        char note[256] = "";
        cw_label_table table = {0};
        cw_volume v;
        cw_error err = {0};
        const cw_read_desc desc = {.labels = &table, .note = keep_note, .note_user = note};
        save_file(f, names[n]);
        assert_ok(cw_volume_read(test_path(names[n]), &desc, &v, NULL, &err), err);
        assert_false(v.known & CW_KNOWN_LABELS);
        assert_int_equal(table.count, 0);
        if (words && !strstr(note, words))
            fail_msg("'%s' does not hold '%s'", note, words);
        assert_true(words || !strstr(note, "left out"));
        cw_volume_free(&v);
    }
}

static void damaged_extensions_do_no_harm(void **state)
{
    (void)state;
    static const struct {
        int32_t size, code;
        const char *text, *note;
    } cases[] = {
        {0, 0, "<LabelTable><Label Key=\"-5\"/></LabelTable>", "line 1: 'Key' is '-5'"},
        {0, 30, "<LabelTable><Label Key=\"5\">", "is not XML"},
        {0, 0, "<!DOCTYPE a><LabelTable/>", "a document type"},
        {0, 0, "<LabelTable/>", NULL},
        {0, 0, "<other/>", NULL},
        {0, 6, LIVER, NULL},
        {0, 0, "text <LabelTable>", NULL},
        {-16, 0, LIVER, NULL},
        {8, 0, LIVER, NULL},
        {1000000, 0, LIVER, NULL},
        {INT32_MAX, 30, LIVER, NULL},
    };
    label_file f;
    for (size_t n = 0; n < sizeof cases / sizeof *cases; n++) {
        start_file(&f, 1 + (int)n % 2);
        add_extension(&f, cases[n].size, cases[n].code, cases[n].text);
        end_file(&f);
        expect_nothing(&f, cases[n].note);
    }
    start_file(&f, 1);
    add_extension(&f, 0, 0, LIVER);
    f.bytes[348] = 0; /* says that there are none */
    end_file(&f);
    expect_nothing(&f, NULL);
}

static void failures_leave_an_empty_table(void **state)
{
    (void)state;
    cw_label_table table = {0};
    cw_volume v;
    cw_error err = {0};
    const cw_read_desc desc = {.labels = &table};
    label_file f;
    start_file(&f, 1);
    add_extension(&f, 0, 0, LIVER);
    end_file(&f);
    f.size -= 1;
    save_file(&f, "cut.nii");
    assert_int_equal(cw_volume_read(test_path("cut.nii"), &desc, &v, NULL, &err),
                     CW_ERR_FORMAT);
    assert_null(table.labels);
    f.size += 1;
    save_file(&f, "a.nii.gz");
    const size_t before = cw_memory_used();
    cw_status st = CW_ERR_NO_MEMORY;
    for (long after = 0; st == CW_ERR_NO_MEMORY; after++) {
        cwi_alloc_fail_after(after);
        st = cw_volume_read(test_path("a.nii.gz"), &desc, &v, NULL, &err);
        const bool failed = cwi_alloc_fail_after(-1);
        assert_int_equal(st, failed ? CW_ERR_NO_MEMORY : CW_OK);
        assert_int_equal(table.count, failed ? 0 : 1);
    }
    cw_volume_free(&v);
    cw_label_table_free(&table);
    assert_int_equal(cw_memory_used(), before);
}

/* Names that need escapes come back, plain and gzipped, and the voxels with them. */
static void names_are_written(void **state)
{
    (void)state;
    static const char *const files[] = {"w.nii", "w.nii.gz"};
    static const uint8_t voxels[4] = {0, 7, 300 % 256, 7};
    cw_label_table table = {0}, back = {0};
    cw_error err = {0};
    char odd[] = "<left> & \"right\"", plain[] = "liver";
    const cw_label labels[2] = {
        {.value = 7, .name = plain, .color = {255, 128, 0, 255}, .has_color = true},
        {.value = 44, .name = odd}};
    for (int n = 0; n < 2; n++)
        assert_ok(cw_label_table_add(&table, &labels[n], &err), err);
    const cw_volume v = {.data = voxels, .dim = {2, 2, 1}, .known = CW_KNOWN_LABELS};
    for (int n = 0; n < 2; n++) {
        cw_volume read;
        assert_ok(
            cw_volume_write(test_path(files[n]), &v, &(cw_write_desc){.labels = &table}, &err),
            err);
        assert_ok(cw_volume_read(test_path(files[n]), &(cw_read_desc){.labels = &back}, &read,
                                 NULL, &err),
                  err);
        assert_int_equal(back.count, 2);
        assert_string_equal(back.labels[0].name, plain);
        assert_string_equal(back.labels[1].name, odd);
        assert_memory_equal(back.labels[0].color, labels[0].color, 4);
        assert_memory_equal(read.data, voxels, 4);
        assert_true(read.known & CW_KNOWN_LABELS);
        cw_volume_free(&read);
    }
    cw_label_table_free(&back);
    cw_label_table_free(&table);
}

int main(void)
{
#define TEST(name) cmocka_unit_test_setup_teardown(name, test_folder_make, test_folder_remove)
    const struct CMUnitTest tests[] = {
        TEST(extensions_hold_names),         TEST(the_other_byte_order_is_read),
        TEST(a_pair_has_them_in_its_header), TEST(damaged_extensions_do_no_harm),
        TEST(failures_leave_an_empty_table), TEST(names_are_written),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
