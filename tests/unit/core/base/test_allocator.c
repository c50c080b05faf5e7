/* Tests the caller's allocator: every array comes from it, aligned, and goes back to it. */
#include "support/support.h"

#include <cubewright/cubewright.h>

#include <pthread.h>
#include <stdlib.h>
#include <string.h>

enum { GUARD = 64 };

/* Memory of malloc() between guards; counts what is alive. */
typedef struct counting {
    pthread_mutex_t lock;
    size_t alive, calls, bytes, fails_after;
} counting;

static void *allocate_counted(void *user, size_t bytes)
{
    counting *c = user;
    pthread_mutex_lock(&c->lock);
    const bool fails = c->fails_after && c->calls >= c->fails_after;
    c->alive += !fails;
    c->calls++;
    c->bytes += fails ? 0 : bytes;
    pthread_mutex_unlock(&c->lock);
    if (fails)
        return NULL;
    char *memory = aligned_alloc(64, (bytes + (size_t)(3 * GUARD) - 1) / 64 * 64);
    assert_non_null(memory);
    memset(memory, 0x5a, GUARD);
    memset(memory + GUARD + bytes, 0x5a, GUARD);
    return memory + GUARD;
}

static void release_counted(void *user, void *memory, size_t bytes)
{
    counting *c = user;
    char *begin = (char *)memory - GUARD;
    for (size_t n = 0; n < GUARD; n++) {
        assert_int_equal(begin[n], 0x5a);
        assert_int_equal(begin[GUARD + bytes + n], 0x5a);
    }
    pthread_mutex_lock(&c->lock);
    c->alive--;
    c->bytes -= bytes;
    pthread_mutex_unlock(&c->lock);
    free(begin);
}

static counting counter = {.lock = PTHREAD_MUTEX_INITIALIZER};
static const cw_allocator allocator = {allocate_counted, release_counted, &counter};

static void start_counting(void)
{
    counter.alive = counter.calls = counter.bytes = counter.fails_after = 0;
    assert_int_equal(cw_allocator_set(&allocator, NULL), CW_OK);
}

static void stop_counting(void)
{
    assert_int_equal(counter.alive, 0);
    assert_int_equal(counter.bytes, 0);
    assert_int_equal(cw_memory_used(), 0);
    assert_int_equal(cw_allocator_set(NULL, NULL), CW_OK);
}

static void make_ball(cw_volume *volume)
{
    const cw_field_desc desc = {.field = CW_FIELD_SPHERE, .dim = {40, 40, 40}, .type = CW_F32};
    assert_int_equal(cw_field_sample(&desc, volume, NULL), CW_OK);
}

static void arrays_come_from_the_caller_and_go_back(void **state)
{
    (void)state;
    cw_error err = {0};
    cw_volume volume = {0};
    cw_mesh mesh = {0}, again = {0};
    start_counting();
    make_ball(&volume);
    assert_true(counter.bytes >= 40 * 40 * 40 * sizeof(float));
    assert_true(cw_memory_used() >= 40 * 40 * 40 * sizeof(float));
    assert_int_equal(cw_extract(&volume, NULL, &mesh, NULL, &err), CW_OK);
    assert_int_equal((uintptr_t)mesh.positions % 64, 0);

    const char *path = test_path("ball.ply");
    assert_int_equal(cw_mesh_write(path, &mesh, NULL, &err), CW_OK);
    assert_int_equal(cw_mesh_read(path, NULL, &again, NULL, &err), CW_OK);
    assert_int_equal(again.triangle_count, mesh.triangle_count);
    cw_quality quality;
    assert_int_equal(cw_quality_measure(&again, NULL, &quality, &err), CW_OK);
    assert_true(cw_quality_is_closed_manifold(&quality));
    cw_mesh_free(&again);
    if (cw_simplify_available()) {
        const cw_simplify_desc desc = {.ratio = 0.25};
        assert_int_equal(cw_simplify(&mesh, &desc, &again, NULL, &err), CW_OK);
        cw_mesh_free(&again);
    }
    cw_mesh_free(&mesh);
    cw_volume_free(&volume);
    stop_counting();
}

static void the_mesh_is_the_same(void **state)
{
    (void)state;
    cw_volume volume = {0};
    cw_mesh plain = {0}, own = {0};
    make_ball(&volume);
    assert_int_equal(cw_extract(&volume, NULL, &plain, NULL, NULL), CW_OK);
    const size_t size = 3 * plain.vertex_count * sizeof *plain.positions;
    float *kept = malloc(size);
    memcpy(kept, plain.positions, size);
    cw_mesh_free(&plain);
    cw_volume_free(&volume);

    start_counting();
    make_ball(&volume);
    assert_int_equal(cw_extract(&volume, NULL, &own, NULL, NULL), CW_OK);
    assert_memory_equal(own.positions, kept, size);
    cw_mesh_free(&own);
    cw_volume_free(&volume);
    stop_counting();
    free(kept);
}

static void an_allocator_without_memory_is_an_ordinary_error(void **state)
{
    (void)state;
    cw_error err = {0};
    cw_mesh mesh = {0};
    cw_volume volume = {0};
    start_counting();
    make_ball(&volume);
    counter.fails_after = counter.calls + 1;
    assert_int_equal(cw_extract(&volume, NULL, &mesh, NULL, &err), CW_ERR_NO_MEMORY);
    assert_null(mesh.positions);
    cw_volume_free(&volume);
    stop_counting();
}

static void it_is_refused_while_arrays_are_alive(void **state)
{
    (void)state;
    cw_error err = {0};
    cw_volume volume = {0};
    make_ball(&volume);
    assert_int_equal(cw_allocator_set(&allocator, &err), CW_ERR_ARGUMENT);
    assert_non_null(strstr(err.message, "are alive"));
    cw_volume_free(&volume);
    const cw_allocator half = {.allocate = allocate_counted};
    assert_int_equal(cw_allocator_set(&half, &err), CW_ERR_ARGUMENT);
    assert_non_null(strstr(err.message, "'release'"));
    assert_int_equal(cw_allocator_set(NULL, &err), CW_OK);
    assert_string_equal(err.message, "");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(arrays_come_from_the_caller_and_go_back),
        cmocka_unit_test(the_mesh_is_the_same),
        cmocka_unit_test(an_allocator_without_memory_is_an_ordinary_error),
        cmocka_unit_test(it_is_refused_while_arrays_are_alive),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
