/* Tests numbers printed as text: rounding, and floats that come back to the bit. */
#include "support/support.h"

#include "formats/text/number_format.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static const char *put(double value, int digits)
{
    static unsigned char text[32];
    *cwi_put_decimal(text, value, digits) = '\0';
    return (const char *)text;
}

static void numbers_look_as_printed(void **state)
{
    (void)state;
    static const double values[] = {
        0,       1,       -1,          10,         100,        123456789,   999999999,
        0.5,     0.1,     -0.25,       0.0001,     0.00012345, 1e-5,        -3e-30,
        1e9,     1e300,   3.14159265,  2.5e-4,     99.9999999, 1000.0625,   -1000003.2,
        1.0 / 3, 2.0 / 3, 0.999999999, 9.99999e-4, 1e8 + 0.5,  4294967296.0};
    for (size_t i = 0; i < sizeof values / sizeof *values; i++)
        for (int digits = 6; digits <= 17; digits++) {
            char expected[32];
            snprintf(expected, sizeof expected, "%.*g", digits, values[i]);
            assert_string_equal(put(values[i], digits), expected);
        }
    assert_string_equal(put(-0.0, 9), "0");
    assert_string_equal(put((double)NAN, 9), "nan");
}

/* Nines that round up carry over into a digit more. */
static void nines_carry(void **state)
{
    (void)state;
    assert_string_equal(put(9.9999999996, 9), "10");
    assert_string_equal(put(0.99999999996, 9), "1");
    assert_string_equal(put(99999.99999, 9), "100000");
    assert_string_equal(put(0.00099999999996, 9), "0.001");
}

static void floats_come_back_to_the_bit(void **state)
{
    (void)state;
    uint32_t bits = 1;
    for (int i = 0; i < 1000000; i++) {
        float value;
        bits = bits * 1664525 + 1013904223;
        memcpy(&value, &bits, sizeof value);
        if (!isfinite(value))
            continue;
        if (strtof(put((double)value, 9), NULL) != value)
            fail_msg("%.9g is put as %s", (double)value, put((double)value, 9));
    }
}

/* Fixed notation, where most numbers are: the last digit may differ from printf's in a tie. */
static void most_numbers_are_those_of_printf(void **state)
{
    (void)state;
    int others = 0;
    test_seed(5);
    for (int i = 0; i < 100000; i++) {
        const double value = ((double)rand() / RAND_MAX - 0.5) * pow(10, rand() % 12 - 3);
        char expected[32];
        snprintf(expected, sizeof expected, "%.10g", value);
        others += strcmp(put(value, 10), expected) != 0;
        assert_within(strtod(put(value, 10), NULL), value, 5.1e-10);
    }
    assert_true(others < 10);
}

static void whole_numbers_of_any_length(void **state)
{
    (void)state;
    static const uint64_t values[] = {0, 9, 10, 4294967295u, UINT64_MAX};
    for (size_t i = 0; i < sizeof values / sizeof *values; i++) {
        unsigned char text[32];
        char expected[32];
        snprintf(expected, sizeof expected, "%ju", (uintmax_t)values[i]);
        *cwi_put_integer(text, values[i]) = '\0';
        assert_string_equal((char *)text, expected);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(numbers_look_as_printed),
        cmocka_unit_test(nines_carry),
        cmocka_unit_test(floats_come_back_to_the_bit),
        cmocka_unit_test(most_numbers_are_those_of_printf),
        cmocka_unit_test(whole_numbers_of_any_length),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
