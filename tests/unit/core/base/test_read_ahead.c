/* Tests bytes that a thread produces ahead: all arrive, up to the end or a failure. */
#include "support/support.h"

#include "core/base/memory.h"
#include "core/base/read_ahead.h"
#include "core/base/status.h"

#include <stdatomic.h>

typedef struct source {
    size_t size, given;
    bool fails; /* behind its last byte */
    atomic_int calls;
} source;

static unsigned char byte_at(size_t at)
{
    return (unsigned char)(at * 2654435761u >> 13);
}

static cw_status produce(void *context, void *to, size_t size, size_t *got, cw_error *err)
{
    source *s = context;
    const size_t left = s->size - s->given;
    *got = left < size ? left : size;
    for (size_t n = 0; n < *got; n++)
        ((unsigned char *)to)[n] = byte_at(s->given + n);
    s->given += *got;
    atomic_fetch_add(&s->calls, 1);
    return s->fails && *got < size ? cwi_fail(err, CW_ERR_FORMAT, "broken off") : CW_OK;
}

/* Takes bytes in portions; returns how many were right. */
static size_t take_all(cwi_ahead *a, size_t portion, cw_status *st, cw_error *err)
{
    static unsigned char bytes[1 << 21];
    size_t right = 0, got = portion;
    while (got == portion && (*st = cwi_ahead_take(a, bytes, portion, &got, err)) == CW_OK)
        for (size_t n = 0; n < got; n++, right++)
            if (bytes[n] != byte_at(right))
                return right;
    return right + (*st == CW_OK ? 0 : got);
}

static void all_bytes_arrive_in_any_portions(void **state)
{
    (void)state;
    static const size_t sizes[] = {0, 1, 262143, 262144, 262145, 1048576, 3000000};
    static const size_t portions[] = {7000, 262144, 700000, 1 << 21};
    for (size_t n = 0; n < sizeof sizes / sizeof *sizes; n++)
        for (size_t p = 0; p < sizeof portions / sizeof *portions; p++) {
            source s = {.size = sizes[n]};
            cw_error err;
            cw_status st = CW_OK;
            cwi_ahead *a = cwi_ahead_start(produce, &s);
            assert_non_null(a);
            assert_int_equal(take_all(a, portions[p], &st, &err), sizes[n]);
            assert_ok(st, err);
            cwi_ahead_stop(a);
        }
}

static void a_failure_comes_after_the_bytes_before_it(void **state)
{
    (void)state;
    source s = {.size = 700000, .fails = true};
    cw_error err;
    cw_status st = CW_OK;
    cwi_ahead *a = cwi_ahead_start(produce, &s);
    assert_non_null(a);
    assert_int_equal(take_all(a, 50000, &st, &err), 700000);
    assert_fails(st, CW_ERR_FORMAT, "broken off", err);
    cwi_ahead_stop(a);
}

static void it_is_only_some_buffers_ahead_and_stops_early(void **state)
{
    (void)state;
    source s = {.size = (size_t)1 << 40};
    cw_error err;
    unsigned char bytes[10];
    size_t got;
    cwi_ahead *a = cwi_ahead_start(produce, &s);
    assert_non_null(a);
    assert_ok(cwi_ahead_take(a, bytes, sizeof bytes, &got, &err), err);
    assert_int_equal(got, sizeof bytes);
    cwi_ahead_stop(a);
    assert_in_range(atomic_load(&s.calls), 1, 5);
    cwi_ahead_stop(NULL);
}

static void without_memory_there_is_none(void **state)
{
    (void)state;
    for (long n = 0; n < 2; n++) {
        source s = {.size = 10};
        cwi_alloc_fail_after(n);
        cwi_ahead *a = cwi_ahead_start(produce, &s);
        cwi_alloc_fail_after(-1);
        assert_null(a);
        assert_int_equal(s.given, 0);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(all_bytes_arrive_in_any_portions),
        cmocka_unit_test(a_failure_comes_after_the_bytes_before_it),
        cmocka_unit_test(it_is_only_some_buffers_ahead_and_stops_early),
        cmocka_unit_test(without_memory_there_is_none),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
