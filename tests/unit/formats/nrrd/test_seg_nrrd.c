/* Tests the segments of .seg.nrrd files: names, colours, codes, and layers that overlap. */
#include "support/files/reading.h"

#include <stdio.h>

#define FLAT "NRRD0004\ntype: uint8\nencoding: raw\ndimension: 3\nsizes: 2 3 2\n"
#define LAYERED                                                                                \
    "NRRD0004\ntype: uint8\nencoding: raw\ndimension: 4\nsizes: 2 2 1 1\n"                     \
    "kinds: list domain domain domain\nspace: LPS\n"                                           \
    "space directions: none (1,0,0) (0,1,0) (0,0,1)\n"

static const uint8_t voxels[12] = {1, 2, 1, 0};

static cw_status read_segments(const char *header, const char *keys, cw_label_table *table,
                               cw_volume *v, cw_error *err)
{
    char text[4096];
    snprintf(text, sizeof text, "%s%s\n", header, keys);
    put_file("a.seg.nrrd", text, voxels, strstr(header, "list") ? 4 : 12);
    const cw_read_desc desc = {.labels = table, .header_only = true};
    cw_volume shape;
    cw_status st = cw_volume_read(test_path("a.seg.nrrd"), &desc, &shape, NULL, err);
    if (st != CW_OK)
        return st;
    const size_t count = table->count;
    cw_volume_free(&shape);
    st =
        cw_volume_read(test_path("a.seg.nrrd"), &(cw_read_desc){.labels = table}, v, NULL, err);
    assert_int_equal(table->count, count);
    return st;
}

static void segments_have_names_colours_and_codes(void **state)
{
    (void)state;
    cw_label_table table = {0};
    cw_volume v;
    cw_error err = {0};
    assert_ok(
        read_segments(FLAT,
                      "Segment10_Name:=late\nSegment10_LabelValue:=3\n"
                      "Segmentation_MasterRepresentation:=Binary labelmap\nSegment5Name:=x\n"
                      "Segment0_Color:=0.5 0 1\nSegment0_ID:=Segment_1\n"
                      "Segment0_LabelValue:=4\nSegment0_Layer:=0\n"
                      "Segment0_Name:=left\\nkid\\\\ney\nSegment0_Extent:=0 1 0 1 0 1\n"
                      "Segment0_Tags:=Segmentation.Status:done|TerminologyEntry:Some list"
                      "~SCT^123037004^Anatomical Structure~SCT^64033007^Kidney"
                      "~SCT^7771000^Left~Other~^^~^^|\n"
                      "Segment2_ID:=Segment_3\nSegment2_Name:=\nSegment2_LabelValue:=9\n"
                      "Segment2_Tags:=|a|TerminologyEntry:x~^^~\n",
                      &table, &v, &err),
        err);
    assert_int_equal(v.known, CW_KNOWN_LABELS);
    assert_int_equal(table.count, 3);
    const cw_label *late = cw_label_find(&table, 0, 3), *kidney = cw_label_find(&table, 0, 4);
    assert_string_equal(late->name, "late");
    assert_false(late->has_color);
    assert_null(late->type.value);
    assert_string_equal(kidney->name, "left kid\\ney");
    assert_memory_equal(kidney->color, ((uint8_t[4]){128, 0, 255, 255}), 4);
    assert_string_equal(kidney->category.scheme, "SCT");
    assert_string_equal(kidney->category.meaning, "Anatomical Structure");
    assert_string_equal(kidney->type.value, "64033007");
    assert_string_equal(kidney->type.meaning, "Kidney");
    assert_string_equal(cw_label_find(&table, 0, 9)->name, "Segment_3");
    assert_null(cw_label_find(&table, 0, 9)->category.scheme);
    cw_volume_free(&v);
    cw_label_table_free(&table);
}

/* The list axis is the fastest, so two components are side by side. */
static void layers_are_components(void **state)
{
    (void)state;
    cw_label_table table = {0};
    cw_volume v, layer;
    cw_error err = {0};
    assert_ok(read_segments(LAYERED,
                            "Segment0_Name:=a\nSegment0_LabelValue:=1\nSegment0_Layer:=1\n"
                            "Segment1_Name:=b\nSegment1_LabelValue:=1\nSegment1_Layer:=0\n"
                            "Segment2_Name:=c\nSegment2_LabelValue:=2\nSegment2_Layer:=1\n",
                            &table, &v, &err),
              err);
    assert_int_equal(v.components, 2);
    assert_true(v.known & CW_KNOWN_LABELS);
    assert_ok(cw_volume_select(&v, 1, 0, &layer, &err), err);
    assert_true(cw_volume_value(&layer, 0, 0, 0) == 2);
    assert_true(cw_volume_value(&layer, 1, 0, 0) == 0);
    assert_int_equal(table.count, 3);
    assert_string_equal(cw_label_find(&table, 0, 1)->name, "b");
    assert_string_equal(cw_label_find(&table, 1, 1)->name, "a");
    assert_string_equal(cw_label_find(&table, 1, 2)->name, "c");
    cw_volume_free(&v);
    cw_label_table_free(&table);
}

static void without_layers_each_segment_has_its_own(void **state)
{
    (void)state;
    cw_label_table table = {0};
    cw_volume v;
    cw_error err = {0};
    assert_ok(read_segments(LAYERED, "Segment0_Name:=a\nSegment1_Name:=b\n", &table, &v, &err),
              err);
    assert_int_equal(table.count, 2);
    assert_string_equal(cw_label_find(&table, 0, 1)->name, "a");
    assert_string_equal(cw_label_find(&table, 1, 1)->name, "b");
    cw_volume_free(&v);
    assert_ok(read_segments(FLAT, "Segment4_Name:=a\n", &table, &v, &err), err);
    assert_int_equal(table.count, 1);
    assert_string_equal(cw_label_find(&table, 0, 1)->name, "a");
    cw_volume_free(&v);
    cw_label_table_free(&table);
}

static void keep_note(void *user, const char *text)
{
    snprintf(user, 256, "%s", text);
}

/* A voxel may have 16 values: longer lists are steps. */
static void too_many_layers_have_no_names(void **state)
{
    (void)state;
    char note[256] = "";
    cw_label_table table = {0};
    cw_volume v;
    cw_error err = {0};
    const cw_read_desc desc = {.labels = &table, .note = keep_note, .note_user = note};
    put_file("a.seg.nrrd",
             "NRRD0004\ntype: uint8\nencoding: raw\ndimension: 4\nsizes: 17 1 1 1\n"
             "kinds: list domain domain domain\nSegment0_Name:=a\nSegment0_Layer:=3\n\n",
             "12345678901234567", 17);
    assert_ok(cw_volume_read(test_path("a.seg.nrrd"), &desc, &v, NULL, &err), err);
    assert_int_equal(v.steps, 17);
    assert_int_equal(table.count, 0);
    assert_non_null(strstr(note, "in 17 layers"));
    cw_volume_free(&v);
}

static void damaged_keys_are_named(void **state)
{
    (void)state;
    static const struct {
        const char *keys, *words;
    } cases[] = {
        {"Segment0_Color:=0 0\n", "line 6: 'Segment0_Color' is '0 0'; three numbers"},
        {"Segment0_Color:=0 0 1.5\n", "'Segment0_Color' is '0 0 1.5'"},
        {"Segment0_Color:=0 0 nan\n", "'Segment0_Color' is '0 0 nan'"},
        {"Segment0_Color:=0 0 1 1\n", "'Segment0_Color' is '0 0 1 1'"},
        {"Segment7_LabelValue:=-1\n", "'Segment7_LabelValue' is '-1'; a whole number"},
        {"Segment7_LabelValue:=4294967296\n", "'Segment7_LabelValue' is '4294967296'"},
        {"Segment7_Layer:=\n", "'Segment7_Layer' is ''"},
        {"# a\nSegment7_Layer:=1\n", "line 7: segment 7 is in layer 1; 'sizes' gives"},
        {"Segment99999999999_Name:=a\n", "'Segment99999999999_Name:=a' has a number"},
    };
    cw_label_table table = {0};
    cw_volume v;
    cw_error err = {0};
    for (size_t n = 0; n < sizeof cases / sizeof *cases; n++) {
        assert_fails(read_segments(FLAT, cases[n].keys, &table, &v, &err), CW_ERR_FORMAT,
                     cases[n].words, err);
        assert_null(table.labels);
        assert_ok(read_back("a.seg.nrrd", &v, &err), err); /* without the names */
        cw_volume_free(&v);
    }
}

static void memory_may_run_out_anywhere(void **state)
{
    (void)state;
    cw_label_table table = {0};
    cw_volume v;
    cw_error err = {0};
    const size_t before = cw_memory_used();
    cw_status st = CW_ERR_NO_MEMORY;
    put_file("a.seg.nrrd",
             FLAT "Segment1_Name:=b\nSegment1_LabelValue:=1\nSegment0_Name:=a\n"
                  "Segment0_LabelValue:=2\nSegment0_Tags:=TerminologyEntry:x~a^b^c~d^e^f\n\n",
             voxels, sizeof voxels);
    for (long after = 0; st == CW_ERR_NO_MEMORY; after++) {
        cwi_alloc_fail_after(after);
        st = cw_volume_read(test_path("a.seg.nrrd"), &(cw_read_desc){.labels = &table}, &v,
                            NULL, &err);
        const bool failed = cwi_alloc_fail_after(-1);
        assert_int_equal(st, failed ? CW_ERR_NO_MEMORY : CW_OK);
        assert_int_equal(table.count, failed ? 0 : 2);
    }
    cw_volume_free(&v);
    cw_label_table_free(&table);
    assert_int_equal(cw_memory_used(), before);
}

/* Names that need escapes, and colours, come back. */
static void segments_are_written(void **state)
{
    (void)state;
    static const uint8_t map[4] = {0, 7, 44, 7};
    cw_label_table table = {0}, back = {0};
    cw_error err = {0};
    cw_volume read;
    char odd[] = "left\\right := n", plain[] = "liver";
    const cw_label labels[2] = {
        {.value = 7, .name = plain, .color = {255, 128, 3, 255}, .has_color = true},
        {.value = 44, .name = odd}};
    for (int n = 0; n < 2; n++)
        assert_ok(cw_label_table_add(&table, &labels[n], &err), err);
    const cw_volume v = {.data = map, .dim = {2, 2, 1}, .known = CW_KNOWN_LABELS};
    assert_ok(
        cw_volume_write(test_path("w.seg.nrrd"), &v, &(cw_write_desc){.labels = &table}, &err),
        err);
    assert_ok(cw_volume_read(test_path("w.seg.nrrd"), &(cw_read_desc){.labels = &back}, &read,
                             NULL, &err),
              err);
    assert_int_equal(back.count, 2);
    assert_string_equal(back.labels[0].name, plain);
    assert_string_equal(back.labels[1].name, odd);
    assert_memory_equal(back.labels[0].color, labels[0].color, 4);
    assert_false(back.labels[1].has_color);
    assert_memory_equal(read.data, map, 4);
    assert_true(read.known & CW_KNOWN_LABELS);
    cw_volume_free(&read);
    cw_label_table_free(&back);
    cw_label_table_free(&table);
}

int main(void)
{
#define TEST(name) cmocka_unit_test_setup_teardown(name, test_folder_make, test_folder_remove)
    const struct CMUnitTest tests[] = {
        TEST(segments_have_names_colours_and_codes),
        TEST(layers_are_components),
        TEST(without_layers_each_segment_has_its_own),
        TEST(too_many_layers_have_no_names),
        TEST(damaged_keys_are_named),
        TEST(memory_may_run_out_anywhere),
        TEST(segments_are_written),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
