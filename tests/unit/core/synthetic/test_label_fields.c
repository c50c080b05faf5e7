/* Made label maps: cells that fill a ball, and spheres. */
#include "support/support.h"

#include <cubewright/field.h>

#include <math.h>
#include <string.h>

/* Counts the labels that occur. */
static size_t count_labels(const cw_volume *v, uint32_t max)
{
    static bool occurs[70000];
    const uint32_t *p = v->data;
    size_t count = 0;
    memset(occurs, 0, sizeof occurs);
    for (size_t n = 0; n < v->dim[0] * v->dim[1] * v->dim[2]; n++) {
        assert_true(p[n] <= max);
        count += p[n] > 0 && !occurs[p[n]];
        occurs[p[n]] = true;
    }
    return count;
}

static void all_labels_occur_the_same_for_any_threads(void **state)
{
    (void)state;
    for (int field = 0; field < 2; field++) {
        cw_volume v, again;
        cw_error err = {0};
        cw_label_field_desc desc = {.field = (cw_label_field)field,
                                    .dim = {40, 44, 48},
                                    .type = CW_U32,
                                    .labels = 27,
                                    .threads = 1};
        assert_ok(cw_label_field_sample(&desc, &v, &err), err);
        assert_int_equal(count_labels(&v, 27), 27);
        assert_true(((const uint32_t *)v.data)[0] == 0);
        desc.threads = 2;
        assert_ok(cw_label_field_sample(&desc, &again, &err), err);
        assert_memory_equal(v.data, again.data, 40 * 44 * 48 * sizeof(uint32_t));
        cw_volume_free(&again);
        desc.seed = 1;
        assert_ok(cw_label_field_sample(&desc, &again, &err), err);
        assert_memory_not_equal(v.data, again.data, 40 * 44 * 48 * sizeof(uint32_t));
        cw_volume_free(&again);
        cw_volume_free(&v);
    }
}

/* Spheres have the volumes of their radii, and cells fill the ball. */
static void volumes_are_known(void **state)
{
    (void)state;
    cw_volume v;
    cw_error err = {0};
    const cw_label_field_desc desc = {.dim = {64, 64, 64}, .type = CW_U32, .labels = 64};
    assert_ok(cw_label_field_sample(&desc, &v, &err), err);
    size_t inside = 0;
    for (size_t n = 0; n < 64 * 64 * 64; n++)
        inside += ((const uint32_t *)v.data)[n] > 0;
    assert_within((double)inside, 4.0 / 3 * PI * pow(0.95 * 32, 3), 0.005);
    cw_volume_free(&v);
}

static void types_that_do_not_hold_labels_are_refused(void **state)
{
    (void)state;
    cw_volume v;
    cw_error err = {0};
    cw_label_field_desc desc = {.dim = {8, 8, 8}, .type = CW_I8, .labels = 128};
    assert_fails(cw_label_field_sample(&desc, &v, &err), CW_ERR_ARGUMENT,
                 "128 labels are more than a voxel of i8 holds, 127", err);
    assert_null(v.data);
    desc.labels = 127;
    assert_ok(cw_label_field_sample(&desc, &v, &err), err);
    cw_volume_free(&v);
    desc.field = (cw_label_field)2;
    assert_fails(cw_label_field_sample(&desc, &v, &err), CW_ERR_ARGUMENT, "2 is no form", err);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(all_labels_occur_the_same_for_any_threads),
        cmocka_unit_test(volumes_are_known),
        cmocka_unit_test(types_that_do_not_hold_labels_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
