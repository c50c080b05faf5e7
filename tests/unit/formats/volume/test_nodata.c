/* Voxels without a value, as the caller states them. */
#include "support/files/reading.h"

#include "core/volume/volume.h"

#include <math.h>

/* Five voxels from -1 to 3, stored as such. */
static void write_row(const char *name, cw_type type, double slope, double intercept)
{
    cw_volume v;
    cw_error err = {0};
    assert_ok(cw_volume_alloc(&v, type, (const size_t[3]){5, 2, 2}, 1, 1, &err), err);
    for (size_t i = 0; i < 20; i++)
        cwi_voxel_put(type, (char *)cw_volume_voxels(&v) + i * cw_type_size(type),
                      (double)(i % 5) - (type == CW_U8 ? 0 : 1));
    v.slope = slope;
    v.intercept = intercept;
    assert_ok(cw_volume_write(test_path(name), &v, NULL, &err), err);
    cw_volume_free(&v);
}

static size_t count_without_value(const char *name, cw_nodata nodata, double value)
{
    const cw_read_desc desc = {.nodata = nodata, .nodata_value = value};
    cw_volume v;
    cw_error err = {0};
    cw_statistics s;
    assert_ok(cw_volume_read(test_path(name), &desc, &v, NULL, &err), err);
    assert_ok(cw_volume_statistics(&v, 0, 1, &s, &err), err);
    const size_t count = s.nodata;
    cw_statistics_free(&s);
    cw_volume_free(&v);
    return count;
}

static void values_are_those_of_the_volume(void **state)
{
    (void)state;
    write_row("whole.nii", CW_I16, 1, 0);
    write_row("scaled.nii", CW_U8, 0.25, -100);
    write_row("real.nrrd", CW_F32, 1, 0);
    assert_int_equal(count_without_value("whole.nii", CW_NODATA_VALUE, -1), 4);
    assert_int_equal(count_without_value("whole.nii", CW_NODATA_VALUE, 30000), 0);
    assert_int_equal(count_without_value("whole.nii", CW_NODATA_FILE, 1), 0);
    assert_int_equal(count_without_value("whole.nii", CW_NODATA_NONE, 1), 0);
    assert_int_equal(count_without_value("scaled.nii", CW_NODATA_VALUE, -99.75), 4);
    assert_int_equal(count_without_value("real.nrrd", CW_NODATA_VALUE, 3), 4);
    assert_int_equal(count_without_value("real.nrrd", CW_NODATA_VALUE, 1e30), 0);
}

static void values_that_no_voxel_can_have_are_refused(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        double value;
    } cases[] = {{"whole.nii", 40000},  {"whole.nii", 0.5}, {"whole.nii", NAN},
                 {"scaled.nii", -99.9}, {"scaled.nii", 0},  {"real.nrrd", INFINITY}};
    write_row("whole.nii", CW_I16, 1, 0);
    write_row("scaled.nii", CW_U8, 0.25, -100);
    write_row("real.nrrd", CW_F32, 1, 0);
    for (size_t n = 0; n < sizeof cases / sizeof *cases; n++) {
        const cw_read_desc desc = {.nodata = CW_NODATA_VALUE, .nodata_value = cases[n].value};
        cw_volume v;
        cw_error err = {0};
        assert_int_equal(cw_volume_read(test_path(cases[n].name), &desc, &v, NULL, &err),
                         CW_ERR_ARGUMENT);
        assert_non_null(strstr(err.message, "desc->nodata"));
        assert_null(v.data);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(values_are_those_of_the_volume),
        cmocka_unit_test(values_that_no_voxel_can_have_are_refused),
    };
    return cmocka_run_group_tests(tests, test_folder_make, test_folder_remove);
}
