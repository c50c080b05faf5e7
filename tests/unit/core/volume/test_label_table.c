/* Tables of the names and colours of labels. */
#include "support/support.h"

#include "core/base/memory.h"

#include <cubewright/label_table.h>

#include <stdlib.h>
#include <string.h>

static void add_label(cw_label_table *table, uint32_t value, const char *name)
{
    cw_error err = {0};
    const cw_label label = {.value = value, .name = (char *)name};
    assert_ok(cw_label_table_add(table, &label, &err), err);
}

static void labels_are_found_by_value_and_name(void **state)
{
    (void)state;
    cw_error err = {0};
    cw_label_table table = {0};
    for (uint32_t n = 0; n < 1000; n++) /* in an order of its own: 7 has no divisor with 1000 */
        add_label(&table, n * 7 % 1000 * 4000000u, "some");
    add_label(&table, 5, "Left Lung");
    add_label(&table, UINT32_MAX, "last");
    add_label(&table, 5, "left lung"); /* replaces */
    assert_int_equal(table.count, 1002);
    for (size_t n = 1; n < table.count; n++)
        assert_true(table.labels[n - 1].value < table.labels[n].value);
    assert_string_equal(cw_label_find(&table, 0, 5)->name, "left lung");
    assert_string_equal(cw_label_find(&table, 0, UINT32_MAX)->name, "last");
    assert_null(cw_label_find(&table, 0, 6));
    assert_null(cw_label_find(&table, 1, 5));
    assert_ok(cw_label_table_add(&table, &(cw_label){.layer = 1, .value = 5}, &err), err);
    assert_null(cw_label_find(&table, 1, 5)->name);
    assert_ptr_equal(cw_label_find(&table, 1, 5), &table.labels[1002]);
    assert_int_equal(cw_label_find_name(&table, "LEFT Lung")->value, 5);
    assert_null(cw_label_find_name(&table, "some")); /* many have it */
    assert_null(cw_label_find_name(&table, "right lung"));
    cw_label_table_free(&table);
    cw_label_table_free(&table);
    assert_null(cw_label_find(&table, 0, 5));
}

static void texts_are_copied_and_made_printable(void **state)
{
    (void)state;
    cw_error err = {0};
    cw_label_table table = {0};
    const cw_label label = {.value = 3,
                            .name = "a\tb\xff\xc3\xa4",
                            .type = {.scheme = "SCT", .value = "10200004", .meaning = "Liver"},
                            .color = {1, 2, 3, 4},
                            .has_color = true};
    assert_ok(cw_label_table_add(&table, &label, &err), err);
    const cw_label *found = cw_label_find(&table, 0, 3);
    assert_string_equal(found->name, "a_b_\xc3\xa4");
    assert_string_equal(found->type.meaning, "Liver");
    assert_null(found->category.meaning);
    assert_ptr_not_equal(found->type.meaning, label.type.meaning);
    cw_label_table_free(&table);
}

static void colors_of_neighbouring_values_differ(void **state)
{
    (void)state;
    uint8_t color[4], before[4] = {0};
    for (uint32_t value = 0; value < 10000; value++) {
        cw_label_color(value, color);
        int apart = 0;
        for (int c = 0; c < 3; c++)
            apart += abs(color[c] - before[c]);
        assert_true(apart > 100);
        assert_int_equal(color[3], 255);
        memcpy(before, color, 4);
    }
}

static void without_memory_a_table_stays_as_it_was(void **state)
{
    (void)state;
    cw_label_table table = {0};
    add_label(&table, 1, "one");
    bool failed = true;
    for (long n = 0; failed; n++) {
        cw_error err = {0};
        const cw_label label = {.value = 2, .name = "two", .type = {.value = "x"}};
        cwi_alloc_fail_after(n);
        const cw_status st = cw_label_table_add(&table, &label, &err);
        failed = cwi_alloc_fail_after(-1);
        assert_int_equal(st, failed ? CW_ERR_NO_MEMORY : CW_OK);
        assert_int_equal(table.count, failed ? 1 : 2);
    }
    cw_label_table_free(&table);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(labels_are_found_by_value_and_name),
        cmocka_unit_test(texts_are_copied_and_made_printable),
        cmocka_unit_test(colors_of_neighbouring_values_differ),
        cmocka_unit_test(without_memory_a_table_stays_as_it_was),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
