/* Numbers of labels beyond 32 bits: they are listed, replaced, printed and parsed. */
#include <cubewright/label_table.h>

#include "support/support.h"

#include <stdlib.h>
#include <string.h>

static void numbers_are_replaced_by_places(void **state)
{
    static const int64_t some[] = {0, 720575940600000091, -5, INT64_MIN, INT64_MAX,
                                   7, 1ll << 32};
    enum { SOME = sizeof some / sizeof *some, COUNT = 5000 };
    (void)state;
    for (int is_unsigned = 0; is_unsigned < 2; is_unsigned++) {
        int64_t values[COUNT];
        uint32_t numbers[COUNT];
        cw_label_ids ids = {0};
        cw_error err = {0};
        srand(7);
        for (int n = 0; n < COUNT; n++)
            values[n] = some[(n / 3 + rand() % 2) % SOME];
        assert_ok(cw_labels_renumber(values, is_unsigned, COUNT, numbers, &ids, &err), err);
        assert_int_equal(ids.count, SOME);
        assert_int_equal(ids.ids[0], 0);
        for (size_t n = 2; n < ids.count; n++)
            assert_true(is_unsigned ? (uint64_t)ids.ids[n - 1] < (uint64_t)ids.ids[n]
                                    : ids.ids[n - 1] < ids.ids[n]);
        for (int n = 0; n < COUNT; n++) {
            char text[CW_LABEL_NUMBER];
            assert_true(ids.ids[numbers[n]] == values[n]);
            const cw_label label = cw_label_ids_label(&ids, numbers[n]);
            cw_label parsed = {0};
            assert_true(cw_label_parse(cw_label_number(&label, text), &parsed));
            assert_int_equal(cw_label_ids_find(&ids, &parsed), numbers[n]);
        }
        assert_int_equal(cw_label_ids_find(&ids, &(cw_label){.value = 8}), UINT32_MAX);
        cw_label_ids_free(&ids);
    }
}

static void values_of_32_bits_are_kept(void **state)
{
    const int64_t values[] = {3, 0, 4294967295, 1, 3};
    uint32_t numbers[5];
    cw_label_ids ids = {0};
    cw_error err = {0};
    (void)state;
    assert_ok(cw_labels_renumber(values, false, 5, numbers, &ids, &err), err);
    assert_int_equal(ids.count, 0);
    for (int n = 0; n < 5; n++)
        assert_int_equal(numbers[n], values[n]);
    assert_int_equal(cw_label_ids_find(&ids, &(cw_label){.value = 9}), 9);
}

static void numbers_are_texts(void **state)
{
    static const char *const good[] = {
        "0",  "7",           "4294967295",           "4294967296",
        "-1", "-2147483649", "18446744073709551615", "-9223372036854775808"};
    static const char *const bad[] = {
        "",     "-", "1.5", "0x7", " 7", "7 ", "18446744073709551616", "-9223372036854775809",
        "seven"};
    char text[CW_LABEL_NUMBER];
    (void)state;
    for (size_t n = 0; n < sizeof good / sizeof *good; n++) {
        cw_label label = {.name = NULL};
        assert_true(cw_label_parse(good[n], &label));
        assert_string_equal(cw_label_number(&label, text), good[n]);
    }
    for (size_t n = 0; n < sizeof bad / sizeof *bad; n++) {
        cw_label label = {.value = 5};
        assert_false(cw_label_parse(bad[n], &label));
        assert_int_equal(label.value, 5);
    }
}

static void names_follow_their_numbers(void **state)
{
    const int64_t values[] = {720575940600000091, 5, -3};
    uint32_t numbers[3];
    cw_label_ids ids = {0};
    cw_label_table table = {0};
    cw_error err = {0};
    static const char *const names[][2] = {{"720575940600000091", "axon"},
                                           {"99", "absent"},
                                           {"-3", "glia"},
                                           {"8000000000", "far"}};
    (void)state;
    assert_ok(cw_labels_renumber(values, false, 3, numbers, &ids, &err), err);
    for (size_t n = 0; n < 4; n++) {
        cw_label label = {.name = (char *)names[n][1]};
        assert_true(cw_label_parse(names[n][0], &label));
        assert_ok(cw_label_table_add(&table, &label, &err), err);
        assert_int_equal(table.count, n + 1);
    }
    assert_ok(cw_label_table_renumber(&table, &ids, &err), err);
    assert_int_equal(table.count, 5); /* with the label 5, which has no name */
    assert_string_equal(cw_label_find(&table, 0, numbers[0])->name, "axon");
    assert_null(cw_label_find(&table, 0, numbers[1])->name);
    assert_string_equal(cw_label_find(&table, 0, numbers[2])->name, "glia");
    for (size_t n = 0; n < table.count; n++) {
        char text[CW_LABEL_NUMBER];
        cw_label_number(&table.labels[n], text);
        for (size_t k = 0; k < 4; k++)
            if (strcmp(names[k][0], text) == 0)
                assert_string_equal(table.labels[n].name, names[k][1]);
    }
    cw_label_table_free(&table);
    cw_label_ids_free(&ids);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(numbers_are_replaced_by_places),
        cmocka_unit_test(values_of_32_bits_are_kept),
        cmocka_unit_test(numbers_are_texts),
        cmocka_unit_test(names_follow_their_numbers),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
