/* The table of optional features: what holds in every build. */
#include "core/base/features.h"
#include "core/base/module.h"
#include "support/support.h"

#include <cubewright/formats.h>

#include <string.h>

static void every_feature_is_there_or_says_why_not(void **state)
{
    (void)state;
    size_t count;
    const cw_feature *features = cw_features(&count);
    assert_int_equal(count, cwi_feature_row_count);
    assert_true(count > 10);
    for (size_t i = 0; i < count; i++) {
        assert_true(*features[i].name && *features[i].about);
        assert_int_equal(features[i].available, !*features[i].reason);
        assert_ptr_equal(cwi_find_feature(features[i].name), &features[i]);
    }
    assert_null(cwi_find_feature("nosuch"));
}

static void a_feature_of_a_module_is_there_with_its_file(void **state)
{
    (void)state;
    for (size_t i = 0; i < cwi_feature_row_count; i++) {
        const cwi_feature_row *row = &cwi_feature_rows[i];
        assert_true(*row->option && *row->packages);
        if (*row->module && !*row->reason)
            assert_int_equal(cwi_find_feature(row->name)->available,
                             cwi_module_present(row->module));
    }
}

static void formats_say_why_they_are_not_there(void **state)
{
    (void)state;
    size_t count;
    const cw_format *formats = cw_formats(&count);
    for (size_t i = 0; i < count; i++)
        assert_int_equal(formats[i].in_this_build, !*formats[i].reason);
    const cw_format *glb = cw_mesh_format("a.glb", NULL);
    assert_string_equal(glb->reason, cwi_find_feature("gltf")->reason);
}

static void a_missing_module_names_reason_option_and_packages(void **state)
{
    (void)state;
    for (size_t i = 0; i < cwi_feature_row_count; i++) {
        const cwi_feature_row *row = &cwi_feature_rows[i];
        const void *functions;
        cw_error err = {0};
        if (!*row->module || !*row->reason || cwi_module_present(row->module))
            continue;
        row = cwi_find_module_row(row->module); /* several features may share a module */
        assert_int_equal(cwi_module_load(row->module, &functions, &err), CW_ERR_UNSUPPORTED);
        assert_non_null(strstr(err.message, row->reason));
        assert_non_null(strstr(err.message, row->option));
        assert_non_null(strstr(err.message, row->packages));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_feature_is_there_or_says_why_not),
        cmocka_unit_test(a_feature_of_a_module_is_there_with_its_file),
        cmocka_unit_test(formats_say_why_they_are_not_there),
        cmocka_unit_test(a_missing_module_names_reason_option_and_packages),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
