/* Tests the readers of names and colours of labels: each format, damaged lines, repeated values,
 * large tables, and the search beside a volume. */
#define _GNU_SOURCE /* symlink */
#include "support/files/reading.h"

#include <cubewright/formats.h>

#include <sys/stat.h>
#include <unistd.h>

/* A label that a file should give, as text. */
typedef struct expected {
    uint32_t value;
    const char *name;  /* NULL: none */
    const char *color; /* "#rrggbbaa"; NULL: none */
    bool hidden;
    const char *code; /* "category/type", as "scheme:value:meaning"; NULL: not tested */
} expected;

static cw_status read_text(const char *name, const char *text, cw_label_table *table,
                           const char **format, cw_error *err)
{
    test_file_write(test_path(name), text, strlen(text));
    return cw_label_table_read(test_path(name), table, format, err);
}

static void print_code(const cw_code *code, char text[100])
{
    if (code->scheme || code->value || code->meaning)
        snprintf(text, 100, "%s:%s:%s", code->scheme ? code->scheme : "",
                 code->value ? code->value : "", code->meaning ? code->meaning : "");
    else
        text[0] = '\0';
}

static void check_label(const cw_label *label, const expected *e)
{
    char color[16], category[100], type[100], code[201];
    assert_int_equal(label->value, e->value);
    assert_int_equal(label->layer, 0);
    if (e->name)
        assert_string_equal(label->name, e->name);
    else
        assert_null(label->name);
    assert_int_equal(label->has_color, e->color != NULL);
    snprintf(color, sizeof color, "#%02x%02x%02x%02x", label->color[0], label->color[1],
             label->color[2], label->color[3]);
    if (e->color)
        assert_string_equal(color, e->color);
    assert_int_equal(label->hidden, e->hidden);
    print_code(&label->category, category);
    print_code(&label->type, type);
    snprintf(code, sizeof code, "%s/%s", category, type);
    if (e->code)
        assert_string_equal(code, e->code);
}

static const struct {
    const char *file, *text, *format;
    size_t count;
    expected labels[4];
} cases[] = {
    {"lut.txt",
     "# a comment\n#No. Label Name: R G B A\n\n0  Unknown   0 0 0 0\r\n"
     "17\tLeft-Hippo_1 \t 220 216 20 0   # behind\n14175 far 1 2 3 55\n",
     "freesurfer",
     3,
     {{0, "Unknown", "#000000ff", false, NULL},
      {17, "Left-Hippo_1", "#dcd814ff", false, NULL},
      {14175, "far", "#010203c8", false, NULL}}},
    {"short.ctab",
     "4 a 1 2 3\n5 b 4 5 6 0 3\n",
     "freesurfer",
     2,
     {{4, "a", "#010203ff", false, NULL}, {5, "b", "#040506ff", false, NULL}}},
    {"slicer.txt",
     "0 background 0 0 0 0\n4 left_lateral_ventricle 88 106 215 255\n7 7 1 2 3 128\n",
     "slicer",
     3,
     {{0, "background", "#00000000", false, NULL},
      {4, "left lateral ventricle", "#586ad7ff", false, NULL},
      {7, "7", "#01020380", false, NULL}}},
    {"clear.ctbl",
     "# Color table file x.ctbl\n# 1 values\n1 a_b 1 2 3 0\n",
     "slicer",
     1,
     {{1, "a b", "#01020300", false, NULL}}},
    {"itk.label",
     "\xef\xbb\xbf################\n# IDX   -R-  -G-  -B-  -A--  VIS MSH  LABEL\n"
     "    0     0    0    0        0  0  0    \"Clear Label\"\n"
     "   12   255    8  186        1  1  1    \"corpus \"callosum\"\"\n"
     "   13   255    8  186     0.50  1  0    \"\"\n"
     "   14     1    2    3        1  1  1    \"x\"\n",
     "itk-snap",
     4,
     {{0, "Clear Label", "#00000000", true, NULL},
      {12, "corpus \"callosum\"", "#ff08baff", false, NULL},
      {13, NULL, "#ff08ba80", true, NULL},
      {14, "x", "#010203ff", false, NULL}}},
    {"a.csv",
     "Name,Color_G,LabelValue,Color_R,Color_B,Type_CodingScheme,Type_CodeValue,"
     "Type_CodeMeaning,Category_CodeMeaning,Region_CodeValue\n"
     "\"left, \"\"big\"\" kidney\",2,5,1,3,SCT,64033007,Kidney,Organ,9\n"
     "right,,6,,,,,,,\n",
     "slicer-csv",
     2,
     {{5, "left, \"big\" kidney", "#010203ff", false, "::Organ/SCT:64033007:Kidney"},
      {6, "right", NULL, false, "/"}}},
    {"alpha.csv",
     "labelvalue, Color_A ,Color_R,Color_G,Color_B\r\n3,4,1,2,3\r\n",
     "slicer-csv",
     1,
     {{3, NULL, "#01020304", false, NULL}}},
    {"a_dseg.tsv",
     "index\tname\tabbreviation\tcolor\n1\tGray Matter\tGM\t#ff53bb\n"
     "2\tn/a\tWM\t#2F8bbe80\n3\tc\t\tn/a\n",
     "bids",
     3,
     {{1, "Gray Matter", "#ff53bbff", false, NULL},
      {2, NULL, "#2f8bbe80", false, NULL},
      {3, "c", NULL, false, NULL}}},
    {"niivue.json",
     "{\"R\": [0, 1], \"G\": [0, 2], \"B\": [0, 3.0], \"labels\": [\"\", \"bone\"]}",
     "niivue",
     2,
     {{0, NULL, "#000000ff", false, NULL}, {1, "bone", "#010203ff", false, NULL}}},
    {"index.json",
     "{\"R\": [9, 1], \"G\": [9, 2], \"B\": [9, 3], \"A\": [0, 64], \"I\": [700, 3],\n"
     " \"labels\": [\"x\", \"bone\"]}",
     "niivue",
     2,
     {{3, "bone", "#01020340", false, NULL}, {700, "x", "#09090900", false, NULL}}},
    {"semicolons.csv",
     "LabelValue;Name;Color_R;Color_G;Color_B\r\n5;\"left; big\";1;2;3\r\n6;right;;;\r\n",
     "slicer-csv",
     2,
     {{5, "left; big", "#010203ff", false, "/"}, {6, "right", NULL, false, "/"}}},
    {"dataset.json",
     "{\"channel_names\": {\"0\": \"CT\"}, \"labels\": {\"background\": 0, \"liver\": 3, "
     "\"organs\": [1, 3], \"spleen\": 1}}",
     "nnunet",
     3,
     {{0, "background", NULL, false, NULL},
      {1, "spleen", NULL, false, NULL},
      {3, "liver", NULL, false, NULL}}},
    {"decathlon.json",
     "{\"labels\": {\"0\": \"background\", \"2\": \"tumour\"}}",
     "nnunet",
     2,
     {{0, "background", NULL, false, NULL}, {2, "tumour", NULL, false, NULL}}},
    {"plain.nii.txt",
     "2 Precentral_R 2002\r\n1 Left big thing 4\r\n3\tLeft  cortex \t77\n",
     "text",
     3,
     {{1, "Left big thing 4", NULL, false, "/"},
      {2, "Precentral_R", NULL, false, "/:2002:"},
      {3, "Left  cortex", NULL, false, "/:77:"}}},
    {"semicolon.txt",
     "1;ALIC;Anterior limb of the capsule\n2; BCC\n",
     "text",
     2,
     {{1, "Anterior limb of the capsule", NULL, false, "/:ALIC:"},
      {2, "BCC", NULL, false, "/"}}},
    {"table.xml",
     "<LabelTable><Label Key=\"5\" Red=\"1\" Green=\"0.5\" Blue=\"0\" Alpha=\"0.25\">"
     "<![CDATA[ liver <1> ]]></Label><Label Key=\"4294967295\">last</Label></LabelTable>",
     "workbench",
     2,
     {{5, "liver <1>", "#ff800040", false, NULL}, {4294967295, "last", NULL, false, NULL}}},
    {"caret.xml",
     "<?xml version=\"1.0\"?>\n<CaretExtension><Date>today</Date><VolumeInformation "
     "Index=\"0\"><LabelTable><Label Key=\"0\" Red=\"0\" Green=\"0\" Blue=\"0\" "
     "Alpha=\"0\">Unknown</Label></LabelTable></VolumeInformation><VolumeInformation Index=\"1\">"
     "<LabelTable><Label Key=\"9\">other</Label></LabelTable></VolumeInformation>"
     "</CaretExtension>",
     "workbench",
     1,
     {{0, "Unknown", "#00000000", false, NULL}}},
    {".zattrs",
     "{\"image-label\": {\"version\": \"0.4\", \"colors\": [{\"label-value\": 4, "
     "\"rgba\": [1, 2, 3, 4]}, {\"label-value\": 1}],\n \"properties\": [{\"label-value\": 7, "
     "\"class\": \"cell\"}, {\"label-value\": 4, \"name\": \"nucleus\", \"area\": 3}]}}",
     "ome-zarr",
     3,
     {{1, NULL, NULL, false, NULL},
      {4, "nucleus", "#01020304", false, NULL},
      {7, "cell", NULL, false, NULL}}},
    {"zarr.json",
     "{\"zarr_format\": 3, \"attributes\": {\"ome\": {\"image-label\": {\"colors\": "
     "[{\"label-value\": 0, \"rgba\": [9, 9, 9, 255]}]}}}}",
     "ome-zarr",
     1,
     {{0, NULL, "#090909ff", false, NULL}}},
};

static void each_format_gives_its_labels(void **state)
{
    (void)state;
    cw_label_table table = {0};
    cw_error err = {0};
    for (size_t n = 0; n < sizeof cases / sizeof *cases; n++) {
        const char *format = NULL;
        print_message("%s\n", cases[n].file);
        assert_ok(read_text(cases[n].file, cases[n].text, &table, &format, &err), err);
        assert_string_equal(format, cases[n].format);
        assert_int_equal(table.count, cases[n].count);
        for (size_t i = 0; i < table.count; i++)
            check_label(&table.labels[i], &cases[n].labels[i]);
    }
    cw_label_table_free(&table);
}

static void errors_name_the_line_and_the_field(void **state)
{
    (void)state;
    static const struct {
        const char *file, *text, *message;
    } bad[] = {
        {"a.txt", "1 a 1 2 3 0\n2 b 1 256 3 0\n", "line 2: 'G' is '256'"},
        {"a.txt", "1 a 1 2 3 0\n\n#\n18446744073709551616 b 1 2 3 0\n",
         "line 4: 'number' is '18446744"},
        {"a.txt", "1 a 1 2 3 0\n-x b 1 2 3 0\n", "line 2: 'number' is '-x'"},
        {"a.txt", "1 a 1 2 3 0\n2 b 1 2\n", "line 2 has 4 words"},
        {"a.txt", "1 a 1 2 3 0\n2 b 1 2 3 0.5\n", "line 2: 'A' is '0.5'"},
        {"a.label", "1 1 2 3 1 1 1 \"a\"\n2 1 2 3 1.5 1 1 \"a\"\n", "line 2: 'A' is '1.5'"},
        {"a.label", "1 1 2 3 1 1 1 \"a\"\n2 1 2 3 1 1 2 \"a\"\n", "line 2: 'MSH' is '2'"},
        {"a.label", "1 1 2 3 1 1 1 \"a\"\n2 1 2 3 1 1 1 a\n", "line 2: a name in double"},
        {"a.label", "1 1 2 3 1 1 1 \"a\"\n2 1 2 3 1 1 \"a\"\n", "line 2 has 6 words in front"},
        {"a.csv", "Name,Color_R,Color_G,Color_B\na,1,2,3\n", "line 1: the column 'LabelValue'"},
        {"a.csv", "LabelValue,Name,Color_R,Color_B\n1,a,1,2\n", "line 1: the column 'Color_G'"},
        {"a.csv", "LabelValue,Name,Name\n1,a,1\n", "line 1: the column 'Name' appears twice"},
        {"a.csv", "LabelValue,Name\n1,a\nx,b\n", "line 3: 'LabelValue' is 'x'"},
        {"a.csv", "LabelValue,Name\n1,a\n2,b,c\n", "line 3 has 3 values; the header has 2"},
        {"a.csv", "LabelValue,Name\n1,\"a\n", "line 2: a quote is not closed"},
        {"a.csv", "LabelValue,Name,Color_R,Color_G,Color_B\n1,a,1,,3\n", "'Color_G' is ''"},
        {"a.csv", "some,thing\n1,2\n", "line 1: the column 'LabelValue' is missing"},
        {"a.tsv", "index\tname\tcolor\n1\ta\t#12345\n", "line 2: 'color' is '#12345'"},
        {"a.tsv", "index\tname\nn/a\ta\n", "line 2: 'index' is ''"},
        {"a.txt", "1 a\n2\n", "line 2: a name was expected behind 2"},
        {"a.txt", "1;a\n2; ; \n", "line 2: a name was expected behind 2"},
        {"a.txt", "1 a\nb 2\n", "line 2: 'number' is 'b'"},
        {"a.json", "{\"R\":[1],\"G\":[2,3],\"B\":[3],\"labels\":[\"a\"]}", "'G' has 2 entries"},
        {"a.json", "{\"R\":[1],\"B\":[3],\"labels\":[\"a\"]}", "'G' is missing"},
        {"a.json", "{\"R\":[1],\"G\":[-2],\"B\":[3],\"labels\":[\"a\"]}", "'G[0]': a whole"},
        {"a.json", "{\"R\":[1],\"G\":[2],\"B\":[3],\"labels\":[7]}", "'labels[0]': a text"},
        {"a.json", "{\n\"R\": [1,]}", "line 2"},
        {"a.json",
         "{\"image-label\": {\"colors\": [{\"label-value\": 1},{\"label-value\": 1}]}}",
         "colors: label 1 is described twice"},
        {"a.json", "{\"image-label\": {\"colors\": [{\"rgba\": 1}]}}", "colors[0].label-value"},
        {"a.json", "{\"image-label\": {\"colors\": [{\"label-value\": 1, \"rgba\": [1,2]}]}}",
         "'colors[0].rgba': four numbers"},
        {"a.json", "{\"image-label\": {\"properties\": 5}}", "'properties': an array"},
        {"a.json", "{\"some\": 1}", "not a label table"},
        {"a.xml", "<LabelTable>\n<Label Key=\"x\"/></LabelTable>", "line 2: 'Key' is 'x'"},
        {"a.xml", "<LabelTable>\n<Label Key=\"1\" Red=\"2\"/></LabelTable>", "'Red' is '2'"},
        {"a.xml", "<LabelTable>\n<Label Key=\"1\">", "line 2 is not XML"},
        {"a.xml", "<a><LabelTable/></a>", "the first element is not LabelTable"},
        {"a.xml", "<html></html>", "not a label table"},
        {"a.ctbl", "# Color procedural file a\n1 2 3\n", "a procedural colour file"},
        {"a.ctbl", "1 2\n", "line 1 has 2 words"},
        {"a.dat", "some text\n", "not a label table"},
        {"a.txt", "\n\n", "not a label table"},
    };
    cw_label_table table = {0};
    cw_error err = {0};
    for (size_t n = 0; n < sizeof bad / sizeof *bad; n++) {
        const char *format = "";
        if (read_text(bad[n].file, bad[n].text, &table, &format, &err) != CW_ERR_FORMAT)
            fail_msg("%s was read", bad[n].text);
        if (!strstr(err.message, bad[n].message))
            fail_msg("'%s' does not hold '%s'", err.message, bad[n].message);
        assert_non_null(strstr(err.message, bad[n].file));
        assert_null(format);
        assert_null(table.labels);
        assert_int_equal(table.count, 0);
    }
    assert_int_equal(read_text("a.xml", "<!DOCTYPE a><LabelTable/>", &table, NULL, &err),
                     CW_ERR_UNSAFE);
    test_file_write(test_path("a.txt"), "1 a\n2 \0b\n", 9);
    assert_int_equal(cw_label_table_read(test_path("a.txt"), &table, NULL, &err),
                     CW_ERR_FORMAT);
    assert_non_null(strstr(err.message, "line 2 holds a zero byte"));
    assert_int_equal(cw_label_table_read(test_path("none.txt"), &table, NULL, &err), CW_ERR_IO);
}

static void the_last_of_repeated_values_stays(void **state)
{
    (void)state;
    cw_label_table table = {0};
    cw_error err = {0};
    assert_ok(read_text("a.txt", "9 i\n3 a\n9 j\n3 b\n1 c\n3 d\n", &table, NULL, &err), err);
    assert_int_equal(table.count, 3);
    assert_string_equal(cw_label_find(&table, 0, 1)->name, "c");
    assert_string_equal(cw_label_find(&table, 0, 3)->name, "d");
    assert_string_equal(cw_label_find(&table, 0, 9)->name, "j");
    assert_ok(cw_label_table_add(&table, &(cw_label){.value = 4}, &err), err);
    assert_ok(cw_label_table_add(&table, &(cw_label){.value = 5}, &err), err);
    assert_int_equal(table.count, 5);
    cw_label_table_free(&table);
}

/* Falling order is the worst for a sorted table. */
static void a_million_lines_are_read_and_too_many_bytes_refused(void **state)
{
    (void)state;
    enum { COUNT = 1000000 };
    const char *path = test_path("big.txt");
    FILE *file = fopen(path, "w");
    cw_label_table table = {0};
    cw_error err = {0};
    assert_non_null(file);
    for (uint32_t n = COUNT; n > 0; n--)
        fprintf(file, "%u label-%u %u 2 3 0\n", 3 * n, n, n % 256);
    assert_int_equal(fclose(file), 0);
    assert_ok(cw_label_table_read(path, &table, NULL, &err), err);
    assert_int_equal(table.count, COUNT);
    for (uint32_t n = 0; n < COUNT; n += 997)
        assert_int_equal(table.labels[n].value, 3 * (n + 1));
    assert_string_equal(cw_label_find(&table, 0, 3 * 77777)->name, "label-77777");
    assert_int_equal(truncate(path, ((off_t)64 << 20) + 1), 0);
    assert_int_equal(cw_label_table_read(path, &table, NULL, &err), CW_ERR_LIMIT);
    assert_null(table.labels);
    assert_int_equal(unlink(path), 0);
}

static void expect_beside(const char *volume, const char *expected_name)
{
    char *found = NULL;
    cw_error err = {0};
    assert_ok(cw_label_table_beside(test_path(volume), &found, &err), err);
    if (expected_name) {
        assert_non_null(found);
        assert_string_equal(found, test_path(expected_name));
    } else if (found) {
        fail_msg("%s was found", found);
    }
    free(found);
}

static void put_text(const char *name, const char *text)
{
    test_file_write(test_path(name), text, strlen(text));
}

static void a_table_of_the_same_stem_is_found(void **state)
{
    (void)state;
    static const struct {
        const char *volume, *name, *text;
    } found[] = {
        {"b1.nii.gz", "b1.nii.txt", "1 a\n"},
        {"b2.nii.gz", "b2.txt", "1 a\n"},
        {"b3.nii", "b3_semicolon.txt", "1;a\n"},
        {"b4_dseg.nii.gz", "b4_dseg.tsv", "index\tname\n1\ta\n"},
        {"b5.nii.gz", "b5_dseg.tsv", "index\tname\n1\ta\n"},
        {"b6.seg.nrrd", "b6.ctbl", "1 a 1 2 3 255\n"},
        {"b7.mhd", "b7.label", "1 1 2 3 1 1 1 \"a\"\n"},
        {"b8.mhd", "b8.csv", "LabelValue,Name\nwrong,a\n"}, /* its reader will say so */
        {"b9.mhd", "b9.json", "{\"R\":[1],\"G\":[2],\"B\":[3],\"labels\":[\"a\"]}"},
    };
    static const struct {
        const char *volume, *name, *text;
    } passed[] = {
        {"c1.nii.gz", "c1.json", "{\"Manufacturer\": \"x\"}"},
        {"c2.nii.gz", "c2.json", "not JSON"},
        {"c3.nii.gz", "c3.txt", "1 0 0 0\n0 1 0 0\n"},
        {"c4.nii.gz", "c4.txt", "3 scans were averaged\nThe last one is noisy.\n"},
        {"c5.nii.gz", "c5.tsv", "onset\tduration\n1\t2\n"},
        {"c6.nii.gz", "c60.txt", "1 a\n"},
        {"c7.txt", "c7.txt", "1 a\n"}, /* the volume itself */
    };
    for (size_t n = 0; n < sizeof found / sizeof *found; n++) {
        expect_beside(found[n].volume, NULL);
        put_text(found[n].name, found[n].text);
        expect_beside(found[n].volume, found[n].name);
    }
    for (size_t n = 0; n < sizeof passed / sizeof *passed; n++) {
        put_text(passed[n].name, passed[n].text);
        expect_beside(passed[n].volume, NULL);
    }
    assert_int_equal(symlink("b1.nii.txt", test_path("c8.txt")), 0);
    expect_beside("c8.nii", NULL);
    assert_int_equal(mkdir(test_path("c9.txt"), 0700), 0);
    expect_beside("c9.nii", NULL);
    expect_beside("no-such-folder/a.nii", NULL);
    expect_beside("", NULL);
}

static void without_memory_reading_fails_cleanly(void **state)
{
    (void)state;
    cw_error err = {0};
    const size_t before = cw_memory_used();
    for (size_t n = 0; n < sizeof cases / sizeof *cases; n++) {
        cw_label_table table = {0};
        cw_status st = CW_ERR_NO_MEMORY;
        put_text(cases[n].file, cases[n].text);
        for (long after = 0; st == CW_ERR_NO_MEMORY; after++) {
            cwi_alloc_fail_after(after);
            st = cw_label_table_read(test_path(cases[n].file), &table, NULL, &err);
            const bool failed = cwi_alloc_fail_after(-1);
            assert_int_equal(st, failed ? CW_ERR_NO_MEMORY : CW_OK);
            assert_true(st == CW_OK || !table.labels);
        }
        cw_label_table_free(&table);
    }
    assert_int_equal(cw_memory_used(), before);
}

int main(void)
{
#define TEST(name) cmocka_unit_test_setup_teardown(name, test_folder_make, test_folder_remove)
    const struct CMUnitTest tests[] = {
        TEST(each_format_gives_its_labels),
        TEST(errors_name_the_line_and_the_field),
        TEST(the_last_of_repeated_values_stays),
        TEST(a_million_lines_are_read_and_too_many_bytes_refused),
        TEST(a_table_of_the_same_stem_is_found),
        TEST(without_memory_reading_fails_cleanly),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
