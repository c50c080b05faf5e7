/* Tests arrays that overflow into temporary files: their numbers stay whatever is trimmed, a full disk is
 * an error, and nothing is left behind. */
#include "support/support.h"

#include "core/base/memory.h"
#include "core/base/parallel.h"

#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

enum { MB = 1 << 20, NUMBERS = 2 * MB /* of 4 bytes each in an array */, ARRAYS = 5 };

/* Limits the arrays of this process, and lets more overflow into the test's folder. */
static void begin_overflow(size_t limit)
{
    cw_error err = {0};
    const cw_overflow_desc desc = {.path = test_path("output.ply")};
    cw_memory_limit(cw_memory_used() + limit);
    assert_ok(cw_memory_overflow(&desc, &err), err);
}

static void end_overflow(void)
{
    assert_int_equal(cw_memory_overflowed(), 0);
    assert_int_equal(test_folder_entries(), 0);
    assert_int_equal(cw_memory_overflow(NULL, NULL), CW_OK);
    cw_memory_limit(0);
}

static void fill_array(uint32_t *array, size_t count, uint32_t seed)
{
    for (size_t n = 0; n < count; n++)
        array[n] = seed + 2654435761u * (uint32_t)n;
}

static bool is_filled(const uint32_t *array, size_t count, uint32_t seed)
{
    for (size_t n = 0; n < count; n++)
        if (array[n] != seed + 2654435761u * (uint32_t)n)
            return false;
    return true;
}

static void numbers_stay_when_pages_are_dropped(void **state)
{
    (void)state;
    uint32_t *arrays[ARRAYS];
    begin_overflow(10 * MB);
    for (uint32_t n = 0; n < ARRAYS; n++) {
        arrays[n] = n % 2 ? cwi_alloc_zeroed(NUMBERS, 4) : cwi_alloc_large(NUMBERS, 4);
        assert_non_null(arrays[n]);
        assert_true(cwi_memory_is_in_file(arrays[n]) == (n > 0));
        for (size_t i = 0; i < NUMBERS && n % 2; i++)
            assert_int_equal(arrays[n][i], 0);
        fill_array(arrays[n], NUMBERS, n);
        cwi_memory_trim();
    }
    assert_int_equal(cw_memory_overflowed(), (ARRAYS - 1) * 4 * (size_t)NUMBERS);
    for (uint32_t n = ARRAYS; n-- > 0;)
        assert_true(is_filled(arrays[n], NUMBERS, n));
    cwi_copy_large(arrays[0], arrays[4], 4 * (size_t)NUMBERS);
    assert_true(is_filled(arrays[0], NUMBERS, 4));
    for (uint32_t n = 0; n < ARRAYS; n++)
        cwi_free(arrays[n]);
    end_overflow();
}

static void arrays_grow_and_shrink(void **state)
{
    (void)state;
    begin_overflow(4 * MB);
    uint32_t *a = cwi_alloc_array(NUMBERS / 4, 4); /* in memory */
    assert_false(cwi_memory_is_in_file(a));
    fill_array(a, NUMBERS / 4, 7);
    a = cwi_realloc_array(a, NUMBERS, 4);
    assert_true(cwi_memory_is_in_file(a));
    assert_true(is_filled(a, NUMBERS / 4, 7));
    fill_array(a, NUMBERS, 8);
    a = cwi_realloc_array(a, NUMBERS - 100, 4); /* stays where it is */
    a = cwi_realloc_array(a, 2 * NUMBERS, 4);
    assert_true(is_filled(a, NUMBERS - 100, 8));
    assert_int_equal(cw_memory_overflowed(), 8 * (size_t)NUMBERS);
    a = cwi_realloc_array(a, 1000, 4); /* back to memory */
    assert_false(cwi_memory_is_in_file(a));
    assert_true(is_filled(a, 1000, 8));
    a = cwi_renew_large(a, NUMBERS, 4);
    assert_true(cwi_memory_is_in_file(a));
    assert_true(cwi_renew_large(a, NUMBERS - 5, 4) == a);
    cwi_free(a);
    end_overflow();
}

/* The context of threads that add to all numbers of an array. */
static void add_one(void *context, size_t n)
{
    uint32_t *array = context;
    for (size_t i = n * (NUMBERS / 64); i < (n + 1) * (NUMBERS / 64); i++)
        array[i]++;
}

static void threads_share_an_array(void **state)
{
    (void)state;
    begin_overflow(MB);
    uint32_t *a = cwi_alloc_large(NUMBERS, 4);
    assert_true(cwi_memory_is_in_file(a));
    fill_array(a, NUMBERS, 1);
    for (int round = 0; round < 8; round++)
        cwi_parallel_for_all(64, NUMBERS, 2, add_one, a);
    assert_true(is_filled(a, NUMBERS, 9));
    cwi_free(a);
    end_overflow();
}

static void a_full_disk_is_an_error(void **state)
{
    (void)state;
    cw_error err = {0};
    struct rlimit before, low = {4 * MB, 4 * MB};
    begin_overflow(MB);
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &before), 0);
    low.rlim_max = before.rlim_max;
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &low), 0);
    assert_null(cwi_alloc_array(NUMBERS, 4));
    assert_fails(cwi_fail_memory(&err), CW_ERR_NO_MEMORY, "8 MiB were needed", err);
    assert_non_null(strstr(err.message, "cannot hold them: File too large"));
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &before), 0);
    assert_fails(cwi_memory_expect(SIZE_MAX / 2, &err), CW_ERR_OUTPUT, "has room for", err);
    assert_ok(cwi_memory_expect(4 * (size_t)MB, &err), err);
    end_overflow();
}

static void small_arrays_stay_in_memory(void **state)
{
    (void)state;
    begin_overflow(2 * MB);
    void *small[64];
    size_t count = 0;
    while (count < 64 && (small[count] = cwi_alloc_array(MB / 16, 1)))
        count++;
    assert_in_range(count, 24, 32); /* the limit holds for them */
    assert_int_equal(cw_memory_overflowed(), 0);
    while (count-- > 0)
        cwi_free(small[count]);
    end_overflow();
}

static void count_reports(void *user, size_t bytes)
{
    *(size_t *)user += bytes > 0;
}

static void overflow_is_told_once(void **state)
{
    (void)state;
    cw_error err = {0};
    size_t reports = 0;
    const cw_overflow_desc desc = {
        .path = test_path("x"), .report = count_reports, .user = &reports};
    cw_memory_limit(cw_memory_used() + MB);
    assert_ok(cw_memory_overflow(&desc, &err), err);
    assert_ok(cwi_memory_expect(1000, &err), err);
    assert_int_equal(reports, 0);
    assert_ok(cwi_memory_expect(8 * (size_t)MB, &err), err);
    void *a = cwi_alloc_array(NUMBERS, 4);
    assert_int_equal(reports, 1);
    cwi_free(a);
    assert_fails(cw_memory_overflow(&(cw_overflow_desc){.path = test_path("no/such/x")}, &err),
                 CW_ERR_OUTPUT, "no/such", err);
    end_overflow();
}

static void forked_processes_make_no_files(void **state)
{
    (void)state;
    int status = 0;
    begin_overflow(MB);
    uint32_t *a = cwi_alloc_array(NUMBERS, 4);
    assert_true(cwi_memory_is_in_file(a));
    const pid_t child = fork();
    if (child == 0)
        _exit(cwi_alloc_array(NUMBERS, 4) ? 1 : 0);
    assert_true(waitpid(child, &status, 0) == child);
    assert_int_equal(status, 0);
    cwi_free(a);
    end_overflow();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
#define TEST(name) cmocka_unit_test_setup_teardown(name, test_folder_make, test_folder_remove)
        TEST(numbers_stay_when_pages_are_dropped),
        TEST(arrays_grow_and_shrink),
        TEST(threads_share_an_array),
        TEST(a_full_disk_is_an_error),
        TEST(small_arrays_stay_in_memory),
        TEST(overflow_is_told_once),
        TEST(forked_processes_make_no_files),
#undef TEST
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
