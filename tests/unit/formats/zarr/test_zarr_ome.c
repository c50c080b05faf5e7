/* Tests images of OME-Zarr: axes, units, frames, levels, groups of arrays, and labels. */
#include "support/files/reading.h"
#include "support/files/zarr_store.h"

#include <math.h>

/* Writes an array of bytes in version 2 or 3. */
static void put_array(const char *name, int version, size_t rank, const size_t *shape)
{
    zarr_made m = {.name = name,
                   .version = version,
                   .kind = "u1",
                   .rank = rank,
                   .separator = '/',
                   .value = zarr_mixed};
    for (size_t d = 0; d < rank; d++) {
        m.shape[d] = m.chunk[d] = shape[d];
        m.order[d] = d;
    }
    zarr_write(&m);
}

/* Writes the metadata of a group whose attributes are `ome` in version 0.4 or 0.5. */
static void put_group(const char *name, int version, const char *ome)
{
    char path[256], text[4096];
    if (version == 2) {
        snprintf(path, sizeof path, "%s/.zgroup", name);
        zarr_put_text(path, "{\"zarr_format\": 2}");
        snprintf(path, sizeof path, "%s/.zattrs", name);
        zarr_put_text(path, ome);
        return;
    }
    snprintf(path, sizeof path, "%s/zarr.json", name);
    snprintf(text, sizeof text,
             "{\"zarr_format\": 3, \"node_type\": \"group\", \"attributes\": {\"ome\": %s}}",
             ome);
    zarr_put_text(path, text);
}

static const char image[] =
    "{\"version\": \"0.5\", \"multiscales\": [{\"name\": \"a\", \"axes\": ["
    "{\"name\": \"t\", \"type\": \"time\", \"unit\": \"millisecond\"},"
    "{\"name\": \"c\", \"type\": \"channel\"},"
    "{\"name\": \"z\", \"type\": \"space\", \"unit\": \"micrometer\"},"
    "{\"name\": \"y\", \"type\": \"space\", \"unit\": \"nanometer\"},"
    "{\"name\": \"x\", \"type\": \"space\", \"unit\": \"millimeter\"}],"
    "\"datasets\": [{\"path\": \"0\", \"coordinateTransformations\": ["
    "{\"type\": \"scale\", \"scale\": [1, 1, 2, 3, 0.25]}]},"
    "{\"path\": \"small/1\", \"coordinateTransformations\": ["
    "{\"type\": \"scale\", \"scale\": [1, 1, 4, 6, 0.5]},"
    "{\"type\": \"translation\", \"translation\": [0, 0, 1, 1.5, 0.125]}]}],"
    "\"coordinateTransformations\": [{\"type\": \"scale\", \"scale\": [500, 1, 10, 10, 10]}]}]}";

static void put_image(int version)
{
    put_group("image", version, image);
    put_array("image/0", version, 5, (const size_t[5]){2, 3, 4, 6, 8});
    put_array("image/small/1", version, 5, (const size_t[5]){2, 3, 2, 3, 4});
}

/* By the names of the standard, and short ones that programs write. */
static void each_unit_has_its_length(void **state)
{
    (void)state;
    static const struct {
        const char *unit;
        double mm;
    } cases[] = {{"angstrom", 1e-7},  {"femtometer", 1e-12},
                 {"picometer", 1e-9}, {"nanometer", 1e-6},
                 {"nm", 1e-6},        {"micrometer", 1e-3},
                 {"micron", 1e-3},    {"um", 1e-3},
                 {"\xc2\xb5m", 1e-3}, {"\xce\xbcm", 1e-3},
                 {"millimeter", 1},   {"mm", 1},
                 {"centimeter", 10},  {"cm", 10},
                 {"decimeter", 100},  {"meter", 1e3},
                 {"m", 1e3},          {"decameter", 1e4},
                 {"hectometer", 1e5}, {"kilometer", 1e6},
                 {"inch", 25.4},      {"foot", 12 * 25.4},
                 {"yard", 36 * 25.4}, {"mile", 1760 * 36 * 25.4}};
    static const double scales[3] = {5, 3, 2}; /* along x, y, z */
    put_array("image/0", 3, 3, (const size_t[3]){2, 2, 2});
    for (size_t n = 0; n < sizeof cases / sizeof *cases; n++) {
        char text[512];
        cw_volume v;
        cw_error err = {0};
        snprintf(text, sizeof text,
                 "{\"version\": \"0.5\", \"multiscales\": [{\"axes\": ["
                 "{\"name\": \"z\", \"type\": \"space\", \"unit\": \"%s\"},"
                 "{\"name\": \"y\", \"type\": \"space\", \"unit\": \"%s\"},"
                 "{\"name\": \"x\", \"type\": \"space\", \"unit\": \"%s\"}],"
                 "\"datasets\": [{\"path\": \"0\", \"coordinateTransformations\": ["
                 "{\"type\": \"scale\", \"scale\": [2, 3, 5]}]}]}]}",
                 cases[n].unit, cases[n].unit, cases[n].unit);
        put_group("image", 3, text);
        assert_ok(cw_volume_read(test_path("image"), NULL, &v, NULL, &err), err);
        for (int a = 0; a < 3; a++)
            assert_within(v.affine[a][a], scales[a] * cases[n].mm, 1e-12);
        cw_volume_free(&v);
    }
}

static void a_level_has_its_size_and_frame(void **state)
{
    (void)state;
    for (int version = 2; version <= 3; version++) {
        cw_read_desc desc = {0};
        cw_volume v;
        cw_error err = {0};
        put_image(version);
        assert_ok(cw_volume_read(test_path("image"), &desc, &v, NULL, &err), err);
        assert_int_equal(v.dim[0], 8);
        assert_int_equal(v.dim[2], 4);
        assert_int_equal(v.components, 3);
        assert_int_equal(v.steps, 2);
        assert_int_equal(v.known, CW_KNOWN_UNIT);
        assert_near(v.step_seconds, 0.5, 1e-12);
        assert_place(&v, 0, 0, 0, 0, 0, 0);
        assert_place(&v, 1, 1, 1, 2.5, 3e-5, 0.02);
        cw_volume_free(&v);
        desc.level = 1;
        assert_ok(cw_volume_read(test_path("image"), &desc, &v, NULL, &err), err);
        assert_int_equal(v.dim[0], 4);
        assert_place(&v, 0, 0, 0, 1.25, 1.5e-5, 0.01);
        assert_place(&v, 1, 1, 1, 6.25, 7.5e-5, 0.05);
        cw_volume_free(&v);
        desc = (cw_read_desc){.array = "small/1"};
        assert_ok(cw_volume_read(test_path("image"), &desc, &v, NULL, &err), err);
        assert_place(&v, 0, 0, 0, 1.25, 1.5e-5, 0.01);
        cw_volume_free(&v);
        desc = (cw_read_desc){.level = 2};
        assert_fails(cw_volume_read(test_path("image"), &desc, &v, NULL, &err), CW_ERR_ARGUMENT,
                     "level 2 was asked for; there are 2, from 0", err);
        test_folder_remove(NULL);
        test_folder_make(NULL);
    }
}

/* However a level is named, the image above it says where it lies; an array that no image lists has no frame. */
static void a_path_to_a_level_has_its_frame(void **state)
{
    (void)state;
    static const struct {
        const char *path, *array;
        double x; /* of voxel 1, 1, 1 */
    } cases[] = {{"top/image/small/1", NULL, 6.25}, {"top/image/small/1/", NULL, 6.25},
                 {"top/image/0", NULL, 2.5},        {"top/image/small", "1", 1},
                 {"top/image", "small", 6.25},      {"top", "image/small/1", 6.25},
                 {"top", "image/0", 2.5},           {"top/image", "loose", 1},
                 {"top/image/loose", NULL, 1}};
    for (int version = 2; version <= 3; version++) {
        put_group("top", version, "{}");
        put_group("top/image", version, image);
        put_group("top/image/small", version, "{}");
        put_array("top/image/0", version, 5, (const size_t[5]){2, 3, 4, 6, 8});
        put_array("top/image/small/1", version, 5, (const size_t[5]){2, 3, 2, 3, 4});
        put_array("top/image/loose", version, 3, (const size_t[3]){2, 2, 2});
        for (size_t n = 0; n < sizeof cases / sizeof *cases; n++) {
            const cw_read_desc desc = {.array = cases[n].array};
            cw_volume v;
            cw_error err = {0};
            assert_ok(cw_volume_read(test_path(cases[n].path), &desc, &v, NULL, &err), err);
            const double x = v.affine[0][0] + v.affine[0][3];
            if (fabs(x - cases[n].x) > 1e-12)
                fail_msg("%s %s: x is %g, not %g", cases[n].path,
                         cases[n].array ? cases[n].array : "", x, cases[n].x);
            cw_volume_free(&v);
        }
        cw_volume v;
        cw_error err = {0};
        assert_fails(cw_volume_read(test_path("top/image/small/1"), &(cw_read_desc){.level = 1},
                                    &v, NULL, &err),
                     CW_ERR_ARGUMENT, "level 1 was asked for; the array '.' has no levels",
                     err);
        test_folder_remove(NULL);
        test_folder_make(NULL);
    }
}

static void levels_are_listed(void **state)
{
    (void)state;
    cw_level *levels;
    size_t count;
    cw_error err = {0};
    put_image(3);
    assert_ok(cw_levels_list(test_path("image"), NULL, &levels, &count, &err), err);
    assert_int_equal(count, 2);
    assert_string_equal(levels[1].name, "small/1");
    assert_string_equal(levels[1].axes, "t c z y x");
    assert_int_equal(levels[0].shape.dim[1], 6);
    assert_int_equal(levels[1].shape.dim[1], 3);
    cw_levels_free(levels);
    put_array("alone", 2, 3, (const size_t[3]){2, 3, 4});
    assert_ok(cw_levels_list(test_path("alone"), NULL, &levels, &count, &err), err);
    assert_int_equal(count, 0);
    assert_null(levels);
    cw_levels_free(levels);
}

static void other_formats_have_no_levels(void **state)
{
    (void)state;
    static const char mha[] = "ObjectType = Image\nNDims = 3\nDimSize = 2 2 2\n"
                              "ElementType = MET_UCHAR\nElementDataFile = LOCAL\n";
    const cw_read_desc desc = {.level = 1};
    cw_volume v;
    cw_error err = {0};
    put_file("a.mha", mha, "12345678", 8);
    put_array("alone", 2, 3, (const size_t[3]){2, 3, 4});
    assert_fails(cw_volume_read(test_path("a.mha"), &desc, &v, NULL, &err), CW_ERR_ARGUMENT,
                 "files of this format have no levels", err);
    assert_fails(cw_volume_read(test_path("alone"), &desc, &v, NULL, &err), CW_ERR_ARGUMENT,
                 "the array '.' has no levels", err);
}

/* --- transformations ---------------------------------------------------------------------- */

static const struct {
    const char *steps;
    double origin[3], ahead[3]; /* places of (0, 0, 0) and (1, 1, 1) */
} moves[] = {
    {"", {0, 0, 0}, {1, 1, 1}},
    {"{\"type\": \"identity\"}", {0, 0, 0}, {1, 1, 1}},
    {"{\"type\": \"translation\", \"translation\": [3, 2, 1]}", {1, 2, 3}, {2, 3, 4}},
    {"{\"type\": \"scale\", \"scale\": [4, 3, 2]}", {0, 0, 0}, {2, 3, 4}},
    {"{\"type\": \"sequence\", \"transformations\": [{\"type\": \"scale\", \"scale\": [4, 3, "
     "2]}, {\"type\": \"translation\", \"translation\": [32, 21, 10]}]}",
     {10, 21, 32},
     {12, 24, 36}},
    {"{\"type\": \"affine\", \"affine\": [[4, 0, 0, 32], [0, 3, 1, 21], [0, 0, 2, 10]]}",
     {10, 21, 32},
     {12, 25, 36}},
    {"{\"type\": \"rotation\", \"rotation\": [[1, 0, 0], [0, 0, -1], [0, 1, 0]]}",
     {0, 0, 0},
     {1, -1, 1}},
    {"{\"type\": \"mapAxis\", \"mapAxis\": [1, 2, 0]}, {\"type\": \"translation\", "
     "\"translation\": [3, 2, 1]}",
     {1, 2, 3},
     {2, 3, 4}},
};

static void transformations_follow_each_other(void **state)
{
    (void)state;
    put_array("moved/0", 3, 3, (const size_t[3]){2, 2, 2});
    for (size_t n = 0; n < sizeof moves / sizeof *moves; n++) {
        char text[2048];
        cw_volume v;
        cw_error err = {0};
        snprintf(text, sizeof text,
                 "{\"multiscales\": [{\"coordinateSystems\": [{\"axes\": [{\"name\": \"z\", "
                 "\"unit\": \"millimeter\"}, {\"name\": \"y\", \"unit\": \"millimeter\"}, "
                 "{\"name\": \"x\", \"unit\": \"millimeter\"}]}], \"datasets\": [{\"path\": "
                 "\"0\", \"coordinateTransformations\": [%s]}]}]}",
                 moves[n].steps);
        put_group("moved", 3, text);
        assert_ok(read_back("moved", &v, &err), err);
        assert_place(&v, 0, 0, 0, moves[n].origin[0], moves[n].origin[1], moves[n].origin[2]);
        assert_place(&v, 1, 1, 1, moves[n].ahead[0], moves[n].ahead[1], moves[n].ahead[2]);
        cw_volume_free(&v);
    }
}

/* --- groups ------------------------------------------------------------------------------- */

static void keep_note(void *user, const char *text)
{
    snprintf(user, 256, "%s", text);
}

static void the_first_solid_array_of_a_group_is_taken(void **state)
{
    (void)state;
    char note[256] = "";
    cw_read_desc desc = {.note = keep_note, .note_user = note};
    cw_array *arrays;
    size_t count;
    cw_volume v;
    cw_error err = {0};
    put_group("group", 2, "{}");
    put_array("group/a1", 2, 1, (const size_t[1]){5});
    put_array("group/a2/deep", 2, 3, (const size_t[3]){2, 3, 4});
    put_group("group/a2", 2, "{}");
    put_array("group/a10", 2, 3, (const size_t[3]){5, 6, 7});
    assert_ok(cw_volume_read(test_path("group"), &desc, &v, NULL, &err), err);
    assert_int_equal(v.dim[0], 4);
    assert_string_equal(note, "the array 'a2/deep' is taken; desc->array takes 'a1', 'a10'");
    cw_volume_free(&v);
    desc.array = "a10";
    assert_ok(cw_volume_read(test_path("group"), &desc, &v, NULL, &err), err);
    assert_int_equal(v.dim[0], 7);
    cw_volume_free(&v);
    assert_ok(cw_arrays_list(test_path("group"), NULL, &arrays, &count, &err), err);
    assert_int_equal(count, 3);
    assert_true(arrays[1].is_default);
    cw_arrays_free(arrays);
    desc.array = "a11";
    assert_fails(cw_volume_read(test_path("group"), &desc, &v, NULL, &err), CW_ERR_ARGUMENT,
                 "the store has no array 'a11'; there are 'a1', 'a2/deep', 'a10'", err);
    assert_ok(read_back("group/a10/.zarray", &v, &err), err);
    assert_int_equal(v.dim[0], 7);
    cw_volume_free(&v);
}

static void labels_bring_names_and_colours(void **state)
{
    (void)state;
    static const char labels[] =
        "{\"image-label\": {\"colors\": [{\"label-value\": 1, \"rgba\": [255, 0, 0, 128]}], "
        "\"properties\": [{\"label-value\": 1, \"name\": \"liver\"}, {\"label-value\": 7, "
        "\"class\": \"bone\"}]}, \"multiscales\": [{\"axes\": [{\"name\": \"z\"}, {\"name\": "
        "\"y\"}, {\"name\": \"x\"}], \"datasets\": [{\"path\": \"0\"}]}]}";
    char note[256] = "";
    cw_label_table table = {0};
    cw_read_desc desc = {.labels = &table, .array = "labels/organs"};
    const zarr_made wide = {.name = "image/labels/organs/0",
                            .version = 3,
                            .kind = "i8",
                            .rank = 3,
                            .shape = {2, 2, 2},
                            .chunk = {2, 2, 2},
                            .order = {0, 1, 2},
                            .separator = '/',
                            .value = zarr_mixed};
    cw_volume v;
    cw_error err = {0};
    put_image(3);
    put_group("image/labels", 3, "{\"labels\": [\"organs\"]}");
    put_group("image/labels/organs", 3, labels);
    zarr_write(&wide);
    assert_ok(cw_volume_read(test_path("image"), &desc, &v, NULL, &err), err);
    assert_int_equal(v.known, CW_KNOWN_LABELS);
    assert_int_equal(v.type, CW_U32);
    assert_int_equal(table.count, 2);
    assert_string_equal(table.labels[0].name, "liver");
    assert_int_equal(table.labels[0].color[3], 128);
    assert_string_equal(table.labels[1].name, "bone");
    cw_label_table_free(&table);
    cw_volume_free(&v);
    desc = (cw_read_desc){.note = keep_note, .note_user = note};
    assert_ok(cw_volume_read(test_path("image"), &desc, &v, NULL, &err), err);
    assert_string_equal(note, "label maps of it, for desc->array: 'labels/organs'");
    cw_volume_free(&v);
}

static void running_out_of_memory_is_an_error(void **state)
{
    (void)state;
    bool failed = true;
    put_image(3);
    put_group("group", 2, "{}");
    put_array("group/a", 2, 3, (const size_t[3]){2, 3, 4});
    put_array("group/b", 2, 3, (const size_t[3]){2, 3, 4});
    for (long n = 0; failed; n++) {
        cw_level *levels = NULL;
        cw_array *arrays = NULL;
        size_t count;
        cw_volume v = {0};
        cw_error err = {0};
        cwi_alloc_fail_after(n);
        cw_status st = cw_levels_list(test_path("image"), NULL, &levels, &count, &err);
        if (st == CW_OK)
            st = read_back("image", &v, &err);
        if (st == CW_OK)
            st = cw_arrays_list(test_path("group"), NULL, &arrays, &count, &err);
        failed = cwi_alloc_fail_after(-1);
        if (st != (failed ? CW_ERR_NO_MEMORY : CW_OK))
            fail_msg("allocation %ld: %s", n, err.message);
        cw_levels_free(levels);
        cw_arrays_free(arrays);
        cw_volume_free(&v);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(a_level_has_its_size_and_frame, test_folder_make,
                                        test_folder_remove),
        cmocka_unit_test_setup_teardown(each_unit_has_its_length, test_folder_make,
                                        test_folder_remove),
        cmocka_unit_test_setup_teardown(a_path_to_a_level_has_its_frame, test_folder_make,
                                        test_folder_remove),
        cmocka_unit_test_setup_teardown(levels_are_listed, test_folder_make,
                                        test_folder_remove),
        cmocka_unit_test_setup_teardown(other_formats_have_no_levels, test_folder_make,
                                        test_folder_remove),
        cmocka_unit_test_setup_teardown(transformations_follow_each_other, test_folder_make,
                                        test_folder_remove),
        cmocka_unit_test_setup_teardown(the_first_solid_array_of_a_group_is_taken,
                                        test_folder_make, test_folder_remove),
        cmocka_unit_test_setup_teardown(labels_bring_names_and_colours, test_folder_make,
                                        test_folder_remove),
        cmocka_unit_test_setup_teardown(running_out_of_memory_is_an_error, test_folder_make,
                                        test_folder_remove),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
