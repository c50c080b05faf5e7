/* Tests the base: statuses, errors, progress, memory limits, number texts, UTF-8 and the
 * welder. */
#include "support/support.h"

#include "core/base/memory.h"
#include "core/base/module.h"
#include "core/base/sandbox.h"
#include "core/base/status.h"
#include "core/base/text.h"
#include "core/mesh/weld.h"

#include <locale.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

static void every_status_has_its_row(void **state)
{
    (void)state;
    for (int s = 0; s < CW_STATUS_COUNT; s++) {
        assert_true(strlen(cw_status_name((cw_status)s)) > 0);
        assert_true(strlen(cw_status_text((cw_status)s)) > 0);
    }
    assert_int_equal(cw_status_exit_code(CW_OK), 0);
    assert_int_equal(cw_status_exit_code(CW_ERR_EMPTY), 9);
    assert_int_equal(cw_status_exit_code(CW_ERR_CANCELLED), 130);
    assert_string_equal(cw_status_name((cw_status)999), cw_status_name(CW_ERR_BACKEND));
}

static void failing_fills_the_error_and_prefixes_add_up(void **state)
{
    (void)state;
    cw_error err = {0};
    assert_int_equal(cwi_fail(&err, CW_ERR_FORMAT, "'%s' is %d", "dim", 7), CW_ERR_FORMAT);
    assert_int_equal(cwi_fail_in(&err, CW_ERR_FORMAT, "a.nrrd"), CW_ERR_FORMAT);
    assert_string_equal(err.message, "a.nrrd: 'dim' is 7");
    assert_int_equal(err.status, CW_ERR_FORMAT);
    assert_int_equal(cwi_fail(NULL, CW_ERR_IO, "nobody listens"), CW_ERR_IO);
}

static void a_long_message_is_cut_not_overrun(void **state)
{
    (void)state;
    cw_error err = {0};
    char text[2000];
    memset(text, 'x', sizeof text - 1);
    text[sizeof text - 1] = '\0';
    cwi_fail(&err, CW_ERR_IO, "%s", text);
    assert_int_equal(strlen(err.message), sizeof err.message - 1);
    cwi_fail_in(&err, CW_ERR_IO, text);
    assert_int_equal(strlen(err.message), sizeof err.message - 1);
}

static bool refuse(void *user, const char *step, double done)
{
    (void)step, (void)done;
    return --*(int *)user > 0;
}

static void refused_progress_cancels(void **state)
{
    (void)state;
    int calls = 2;
    cw_error err = {0};
    const cw_progress progress = {refuse, &calls};
    assert_int_equal(cwi_progress(&progress, "reading", 0, &err), CW_OK);
    assert_fails(cwi_progress(&progress, "reading", 0.5, &err), CW_ERR_CANCELLED, "reading",
                 err);
    assert_int_equal(cwi_progress(&(cw_progress){0}, "reading", 0, &err), CW_OK);
}

static void sizes_that_overflow_are_refused(void **state)
{
    (void)state;
    size_t n = 7;
    assert_true(cwi_size_mul(1u << 20, 1u << 20, &n));
    assert_true(n == (size_t)1 << 40);
    assert_false(cwi_size_mul(SIZE_MAX / 2, 3, &n));
    assert_false(cwi_size_add(SIZE_MAX, 1, &n));
    assert_true(n == (size_t)1 << 40);
    assert_null(cwi_alloc_array(SIZE_MAX / 4, 8));
    assert_null(cwi_alloc_zeroed((size_t)PTRDIFF_MAX + 1, 1));
    void *nothing = cwi_alloc_array(0, 8);
    assert_non_null(nothing);
    cwi_free(nothing);
}

static void the_nth_allocation_can_be_made_to_fail(void **state)
{
    (void)state;
    cwi_alloc_fail_after(1);
    void *first = cwi_alloc_array(1, 1), *second = cwi_alloc_array(1, 1);
    assert_non_null(first);
    assert_null(second);
    assert_true(cwi_alloc_fail_after(-1));
    assert_false(cwi_alloc_fail_after(-1));
    cwi_free(first);
}

/* All ways to take memory count, and what is given back may be taken again. */
static void memory_has_a_limit(void **state)
{
    (void)state;
    enum { MIB = 1 << 20 };
    const size_t before = cw_memory_used();
    size_t left;
    cw_memory_limit(before + 8 * (size_t)MIB);
    assert_int_equal(cwi_memory_refused(&left), 0);
    char *a = cwi_alloc_array(3, MIB), *b = cwi_alloc_zeroed(2, MIB);
    assert_non_null(a);
    assert_non_null(b);
    assert_true(cw_memory_used() >= before + 5 * (size_t)MIB);
    assert_null(cwi_alloc_array(4, MIB));
    assert_null(cwi_alloc_zeroed(4, MIB));
    assert_null(cwi_alloc_large(4, MIB));
    assert_null(cwi_realloc_array(a, 7, MIB));
    assert_null(cwi_renew_large(NULL, 4, MIB));
    assert_int_equal(cwi_memory_refused(&left), 4 * MIB);
    assert_true(left <= 3 * MIB && left == cwi_memory_left());
    cw_error err = {0};
    assert_int_equal(cwi_fail_memory(&err), CW_ERR_NO_MEMORY);
    assert_non_null(strstr(err.message,
                           "no memory: 4 MiB were needed, and cw_memory_limit() leaves 3 MiB"));
    assert_int_equal(cwi_fail_memory(&err), CW_ERR_NO_MEMORY);
    assert_string_equal(err.message, "no memory");
    assert_false(cwi_memory_take(4 * (size_t)MIB));
    assert_true(cwi_memory_take(2 * (size_t)MIB));
    assert_null(cwi_alloc_array(2, MIB));
    cwi_memory_give(2 * (size_t)MIB);
    a = cwi_realloc_array(a, 5, MIB);
    assert_non_null(a);
    cwi_free(b);
    a = cwi_renew_large(a, 2, MIB); /* a smaller one takes its place */
    assert_non_null(a);
    cwi_free(a);
    assert_int_equal(cw_memory_used(), before);
    cw_memory_limit(0);
    assert_int_equal(cwi_memory_left(), SIZE_MAX);
    a = cwi_alloc_array(9, MIB);
    assert_non_null(a);
    cwi_free(a);
}

static void numbers_have_points_in_every_locale(void **state)
{
    (void)state;
    const char *before = setlocale(LC_NUMERIC, "de_DE.UTF-8"); /* when there is one */
    const char *text = " 2.5e1,7", *words = "x";
    double value = 0;
    int64_t whole = 0;
    char out[16];
    assert_true(cwi_parse_double(&text, &value));
    assert_true(value == 25);
    assert_int_equal(*text, ',');
    assert_false(cwi_parse_double(&words, &value));
    text = "-12 ";
    assert_true(cwi_parse_int(&text, &whole));
    assert_int_equal(whole, -12);
    text = "99999999999999999999";
    assert_false(cwi_parse_int(&text, &whole));
    void *locale = cwi_locale_c();
    snprintf(out, sizeof out, "%g", 0.5);
    cwi_locale_restore(locale);
    assert_string_equal(out, "0.5");
    if (before)
        setlocale(LC_NUMERIC, "C");
}

static void only_utf8_is_utf8(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        size_t length;
    } rows[] = {
        {"a", 1},    {"\xc3\xa9", 2},         {"\xe2\x82\xac", 3}, {"\xf0\x9f\x99\x82", 4},
        {"\x80", 0}, {"\xc0\x80", 0},         {"\xe0\x80\xaf", 0}, {"\xed\xa0\x80", 0},
        {"\xc3", 0}, {"\xf4\x90\x80\x80", 0}, {"\xff", 0},         {"\xe2\x82", 0},
    };
    for (size_t n = 0; n < sizeof rows / sizeof *rows; n++)
        assert_int_equal(cwi_utf8_length(rows[n].text), rows[n].length);
}

/* Ends with 0 when text that outgrows the memory is not given out: not even its start. */
_Noreturn static void outgrow_memory(void)
{
    static const struct rlimit space = {(rlim_t)1 << 26, (rlim_t)1 << 26};
    static const char line[] = "some words, many times over, that all go into memory\n";
    char *text;
    size_t size;
    FILE *out = cwi_text_open(&text, &size);
    if (!out || setrlimit(RLIMIT_AS, &space) != 0)
        _exit(1);
    for (int n = 0; n < 1 << 22 && fputs(line, out) >= 0; n++) {
    }
    _exit(cwi_text_close(out, &text) || text ? 2 : 0);
}

static void text_is_whole_or_not_there(void **state)
{
    (void)state;
    char *text;
    size_t size;
    int how = 0;
    FILE *out = cwi_text_open(&text, &size);
    assert_non_null(out);
    fprintf(out, "%d words", 2);
    assert_true(cwi_text_close(out, &text));
    assert_string_equal(text, "2 words");
    assert_int_equal(size, 7);
    free(text);
    text = NULL;
    assert_false(cwi_text_close(NULL, &text));
    if (CWI_SANITIZED)
        return;
    const pid_t child = fork();
    if (child == 0)
        outgrow_memory();
    assert_int_equal(waitpid(child, &how, 0), child);
    assert_true(WIFEXITED(how));
    assert_int_equal(WEXITSTATUS(how), 0);
}

static void a_module_that_nobody_knows_is_named(void **state)
{
    (void)state;
    cw_error err = {0};
    const void *functions;
    assert_false(cwi_module_present("nosuch"));
    assert_fails(cwi_module_load("nosuch", &functions, &err), CW_ERR_UNSUPPORTED,
                 "there is no module 'nosuch'", err);
}

/* SplitMix64. */
static uint64_t next_random(uint64_t *state)
{
    uint64_t z = *state += 0x9E3779B97F4A7C15u;
    z = (z ^ z >> 30) * 0xBF58476D1CE4E5B9u;
    z = (z ^ z >> 27) * 0x94D049BB133111EBu;
    return z ^ z >> 31;
}

static void check_as_strtod(const char *number)
{
    const char *text = number;
    char *end;
    double value = -7;
    const double expected = strtod(number, &end);
    const bool found = cwi_parse_double(&text, &value);
    if (found != (end != number) || text != end ||
        (found && memcmp(&value, &expected, sizeof value) != 0))
        fail_msg("'%s' is read as %.17g up to '%s', not %.17g", number, value, text, expected);
}

/* Short numbers go a way of their own; the C library is the judge of it. */
static void numbers_are_those_of_strtod(void **state)
{
    (void)state;
    static const char *const odd[] = {
        "0",
        "-0",
        "+.5",
        "5.",
        ".",
        "-.",
        "",
        "e5",
        "1e",
        "1e+",
        "1e5",
        "1E-5",
        "1e22",
        "1e23",
        "1e-22",
        "1e-23",
        "0x1p3",
        "0X10",
        "1.5x",
        "1..2",
        "1.2.3",
        "--1",
        "+-1",
        "1e5e5",
        "inf",
        "-NaN",
        "1e400",
        "1e-400",
        "1,5",
        " \t\n7",
        "7 8",
        "1e0005",
        "9007199254740992",
        "9007199254740993",
        "9007199254740993e1",
        "1e1.5",
        "12345678901234567890",
        "0.00000000000000000000001",
        "123456789012345678.9e-3",
    };
    uint64_t random = 1;
    for (size_t i = 0; i < sizeof odd / sizeof *odd; i++)
        check_as_strtod(odd[i]);
    for (int i = 0; i < 200000; i++) {
        char text[64];
        const double size = ldexp(1, (int)(next_random(&random) % 100) - 50);
        const double value = ((double)(next_random(&random) >> 11) * 0x1p-52 - 1) * size;
        const int digits = (int)(next_random(&random) % 18);
        if (i % 3 == 0)
            snprintf(text, sizeof text, "%.*g", digits, value);
        else
            snprintf(text, sizeof text, i % 3 == 1 ? " %+.*e" : "%.*f", digits, value);
        check_as_strtod(text);
    }
}

/* Points on a small lattice meet often, and -0 is 0. */
static void a_welder_numbers_places_as_they_come(void **state)
{
    (void)state;
    enum { COUNT = 20000 };
    float *points = malloc(COUNT * 3 * sizeof *points);
    uint32_t *map = malloc(COUNT * sizeof *map), *indices = malloc(COUNT * sizeof *indices);
    cwi_welder welder = {0};
    uint64_t random = 2;
    assert_true(points && map && indices);
    for (size_t i = 0; i < (size_t)3 * COUNT; i++) {
        points[i] = (float)((int)(next_random(&random) % 33) - 16) * 0.1f;
        points[i] = points[i] == 0 && random & 64 ? -0.0f : points[i];
    }
    assert_true(cwi_weld(points, COUNT, map));
    assert_true(cwi_welder_add(&welder, points, 1, indices));
    assert_true(cwi_welder_add(&welder, points + 3, COUNT - 1, indices + 1));
    size_t distinct = 0;
    for (size_t i = 0; i < COUNT; i++) {
        const uint32_t first = map[i];
        assert_int_equal(indices[i], first == i ? distinct : indices[first]);
        distinct += first == i;
        assert_memory_equal(welder.points + 3 * (size_t)indices[i], points + 3 * (size_t)first,
                            3 * sizeof *points);
    }
    assert_int_equal(welder.count, distinct);
    cwi_welder_free(&welder);
    free(points);
    free(map);
    free(indices);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_status_has_its_row),
        cmocka_unit_test(failing_fills_the_error_and_prefixes_add_up),
        cmocka_unit_test(a_long_message_is_cut_not_overrun),
        cmocka_unit_test(refused_progress_cancels),
        cmocka_unit_test(sizes_that_overflow_are_refused),
        cmocka_unit_test(the_nth_allocation_can_be_made_to_fail),
        cmocka_unit_test(memory_has_a_limit),
        cmocka_unit_test(numbers_have_points_in_every_locale),
        cmocka_unit_test(numbers_are_those_of_strtod),
        cmocka_unit_test(a_welder_numbers_places_as_they_come),
        cmocka_unit_test(only_utf8_is_utf8),
        cmocka_unit_test(text_is_whole_or_not_there),
        cmocka_unit_test(a_module_that_nobody_knows_is_named),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
