/* Bricks of a volume that changes: those that were given last are together the surface. */
#include "support/changing.h"
#include "support/surface.h"

#include "core/base/memory.h"
#include "extract/extract_internal.h"

#include <stdlib.h>
#include <string.h>

/* Keeps the latest version of each brick, as a renderer does. */
typedef struct keeper {
    cw_mesh *bricks;
    size_t count, given, last;
    const cw_box *box; /* no brick that is given is farther than this from it */
    int left;          /* bricks that are taken before it fails; -1: all */
} keeper;

static void copy_array(void *to, const void *from, size_t size)
{
    void *copy = cwi_alloc_array(size, 1);
    assert_non_null(copy);
    memcpy(copy, from, size);
    memcpy(to, &copy, sizeof copy);
}

static void check_place(const keeper *k, const cw_brick *brick)
{
    for (int a = 0; a < 3 && k->box; a++) {
        const long first = 16 * (long)brick->at[a] - 1, last = first + 16,
                   low = (long)k->box->first[a], high = low + (long)k->box->count[a] - 1;
        assert_true(first <= high + 2 && last >= low - 2);
    }
}

static cw_status take_brick(void *user, const cw_brick *b, cw_error *err)
{
    keeper *k = user;
    (void)err;
    if (k->left == 0)
        return CW_ERR_IO;
    k->left -= k->left > 0;
    if (!k->bricks) {
        k->count = b->count[0] * b->count[1] * b->count[2];
        k->bricks = calloc(k->count, sizeof *k->bricks);
        assert_non_null(k->bricks);
    }
    assert_int_equal(b->index, b->at[0] + b->count[0] * (b->at[1] + b->count[1] * b->at[2]));
    assert_true(b->index < k->count && (k->given == 0 || b->index > k->last));
    check_place(k, b);
    cw_mesh *kept = &k->bricks[b->index];
    const size_t v = b->mesh->vertex_count, t = b->mesh->triangle_count;
    assert_true(t || kept->triangle_count); /* an empty one replaces something */
    cw_mesh_free(kept);
    *kept = *b->mesh;
    if (t) {
        copy_array(&kept->positions, b->mesh->positions, 12 * v);
        copy_array(&kept->triangles, b->mesh->triangles, 12 * t);
        if (kept->normals)
            copy_array(&kept->normals, b->mesh->normals, 12 * v);
    }
    k->given++;
    k->last = b->index;
    return CW_OK;
}

static void free_keeper(keeper *k)
{
    for (size_t n = 0; n < k->count; n++)
        cw_mesh_free(&k->bricks[n]);
    free(k->bricks);
    *k = (keeper){.left = -1};
}

/* Joins all bricks into one mesh, whose vertices are not shared between them. */
static cw_mesh join_bricks(const keeper *k, bool normals)
{
    cw_mesh all = {0};
    size_t v = 0, t = 0;
    for (size_t n = 0; n < k->count; n++) {
        v += k->bricks[n].vertex_count;
        t += k->bricks[n].triangle_count;
    }
    all.positions = cwi_alloc_array(v, 12);
    all.normals = normals ? cwi_alloc_array(v, 12) : NULL;
    all.triangles = cwi_alloc_array(t, 12);
    for (size_t n = 0; n < k->count; n++) {
        const cw_mesh *b = &k->bricks[n];
        if (!b->triangle_count)
            continue;
        memcpy(all.positions + 3 * all.vertex_count, b->positions, 12 * b->vertex_count);
        if (normals)
            memcpy(all.normals + 3 * all.vertex_count, b->normals, 12 * b->vertex_count);
        for (size_t c = 0; c < 3 * b->triangle_count; c++)
            all.triangles[3 * all.triangle_count + c] =
                b->triangles[c] + (uint32_t)all.vertex_count;
        memcpy(all.origin, b->origin, sizeof all.origin);
        memcpy(all.affine, b->affine, sizeof all.affine);
        all.vertex_count += b->vertex_count;
        all.triangle_count += b->triangle_count;
    }
    return all;
}

/* Takes the changed bricks; then those that were taken until now are the whole surface. */
static void follow(cw_extractor *e, const cwi_engine *engine, const cw_volume *v,
                   const cw_extract_desc *d, keeper *k)
{
    cw_mesh whole = {0};
    cw_error err = {0};
    k->given = 0;
    assert_ok(cw_extractor_extract_changed(e, d, (cw_brick_sink){take_brick, k}, &err), err);
    assert_ok(cwi_extract_with(engine, v, d, &whole, NULL, &err), err);
    cw_mesh joined = join_bricks(k, !d->no_normals);
    assert_true(joined.vertex_count >= whole.vertex_count); /* on faces between bricks twice */
    joined.vertex_count = whole.vertex_count;
    if (!whole.triangle_count) /* an empty mesh stands nowhere */
        joined = (cw_mesh){.positions = joined.positions,
                           .normals = joined.normals,
                           .triangles = joined.triangles,
                           .triangle_count = joined.triangle_count};
    test_assert_same_triangles(&whole, &joined);
    cw_mesh_free(&joined);
    cw_mesh_free(&whole);
}

static void bricks_together_are_the_surface(void **state)
{
    (void)state;
    test_seed(18);
    for (int round = 0; round < 60; round += test_is_short() ? 4 : 1) {
        const cwi_engine *engine = test_some_engine(round);
        cw_volume v = test_some_changing_volume(round);
        cw_extractor *e;
        cw_error err = {0};
        cw_mesh mesh = {0}, once = {0};
        keeper k = {.left = -1};
        if (round % 2)
            test_turn(&v, round);
        cw_extract_desc d = test_random_settings(&v);
        assert_ok(cwi_extractor_new_with(engine, 0, &v, &e, &err), err);
        for (int frame = 0; frame < 10; frame++) {
            follow(e, engine, &v, &d, &k);
            test_change(&v, e);
            if (rand() % 4 == 0)
                d = test_random_settings(&v);
            if (rand() % 3 == 0) { /* the whole surface between them */
                assert_ok(cwi_extract_with(engine, &v, &d, &once, NULL, &err), err);
                assert_ok(cw_extractor_extract(e, &d, &mesh, NULL, &err), err);
                test_assert_same_mesh(&once, &mesh);
            }
        }
        free_keeper(&k);
        cw_mesh_free(&mesh);
        cw_mesh_free(&once);
        cw_extractor_free(e);
        cw_volume_free(&v);
    }
}

/* Where gradients vanish normals are those of triangles, also of triangles in other bricks. */
static void normals_from_triangles_are_the_same_across_bricks(void **state)
{
    (void)state;
    cw_extractor *e;
    cw_error err = {0};
    for (int round = 0; round < 4; round++) {
        cw_volume v = test_changing_volume(round % 2 ? CW_U8 : CW_F32, (size_t[3]){50, 40, 36});
        keeper k = {.left = -1};
        v.slope = 1;
        v.has_nodata = false;
        test_paint_all(&v, TEST_SPOTS);
        const cw_extract_desc d = {.isovalue = 50, .leave_open = round / 2};
        assert_ok(cw_extractor_new(&v, &e, &err), err);
        follow(e, cwi_engine_best(), &v, &d, &k);
        free_keeper(&k);
        cw_extractor_free(e);
        cw_volume_free(&v);
    }
}

static void bricks_of_a_rectilinear_grid(void **state)
{
    (void)state;
    static double places[3][48];
    test_seed(19);
    for (int round = 0; round < 6; round++) {
        cw_volume v =
            test_changing_volume(round % 2 ? CW_F32 : CW_I16, (size_t[3]){48, 35, 20});
        cw_extractor *e;
        cw_error err = {0};
        keeper k = {.left = -1};
        for (int a = 0; a < 3; a++) {
            for (int i = 1; i < 48; i++)
                places[a][i] = places[a][i - 1] + 0.5 + test_random_number(1);
            v.coordinates[a] = places[a];
        }
        cw_extract_desc d = test_random_settings(&v);
        d.cubic_placement = false;
        assert_ok(cw_extractor_new(&v, &e, &err), err);
        for (int frame = 0; frame < 5; frame++) {
            follow(e, cwi_engine_best(), &v, &d, &k);
            test_change(&v, e);
        }
        free_keeper(&k);
        cw_extractor_free(e);
        cw_volume_free(&v);
    }
}

static void only_bricks_around_a_change_are_given(void **state)
{
    (void)state;
    cw_volume v = test_sample(CW_FIELD_GYROID, 100, CW_F32);
    const cw_extract_desc d = {.isovalue = 0};
    const cw_box box = {{40, 20, 70}, {20, 10, 9}};
    cw_extractor *e;
    cw_error err = {0};
    keeper k = {.left = -1};
    assert_ok(cw_extractor_new(&v, &e, &err), err);
    follow(e, cwi_engine_best(), &v, &d, &k);
    assert_true(k.given > 200);
    follow(e, cwi_engine_best(), &v, &d, &k);
    assert_int_equal(k.given, 0); /* nothing has changed */
    test_paint(&v, &box, TEST_NOISE);
    assert_ok(cw_extractor_update(e, &box, &err), err);
    k.box = &box;
    follow(e, cwi_engine_best(), &v, &d, &k);
    assert_true(k.given > 0 && k.given <= 12); /* 3 x 2 x 2 */
    k.box = NULL;
    test_paint_all(&v,
                   TEST_CONSTANT); /* the surface is gone: every brick is replaced by nothing */
    assert_ok(cw_extractor_update(e, NULL, &err), err);
    const cw_extract_desc none = {.isovalue = 1000};
    follow(e, cwi_engine_best(), &v, &none, &k);
    assert_true(k.given > 200);
    follow(e, cwi_engine_best(), &v, &d, &k);
    free_keeper(&k);
    cw_extractor_free(e);
    cw_volume_free(&v);
}

static void bricks_that_were_not_taken_are_given_again(void **state)
{
    (void)state;
    cw_volume v = test_sample(CW_FIELD_GYROID, 60, CW_U16);
    const cw_extract_desc d = {.isovalue = cw_field_stored(CW_FIELD_GYROID, CW_U16, 0)};
    cw_extractor *e;
    cw_error err = {0};
    keeper k = {.left = 5};
    assert_ok(cw_extractor_new(&v, &e, &err), err);
    assert_int_equal(cw_extractor_extract_changed(e, &d, (cw_brick_sink){take_brick, &k}, &err),
                     CW_ERR_IO);
    assert_int_equal(k.given, 5);
    k.left = -1;
    for (int polls = 0; polls < 2; polls++) {
        int left = polls;
        cw_extract_desc stopped = d;
        stopped.progress = (cw_progress){test_stop_after, &left};
        k.given = 0;
        assert_int_equal(
            cw_extractor_extract_changed(e, &stopped, (cw_brick_sink){take_brick, &k}, &err),
            CW_ERR_CANCELLED);
    }
    follow(e, cwi_engine_best(), &v, &d, &k);
    free_keeper(&k);
    cw_extractor_free(e);
    cw_volume_free(&v);
}

static void limits_are_for_the_bricks_of_a_call(void **state)
{
    (void)state;
    cw_volume v = test_sample(CW_FIELD_GYROID, 60, CW_F32);
    cw_extract_desc d = {.max_triangles = 1000};
    cw_extractor *e;
    cw_error err = {0};
    keeper k = {.left = -1};
    const cw_brick_sink sink = {take_brick, &k};
    assert_ok(cw_extractor_new(&v, &e, &err), err);
    assert_fails(cw_extractor_extract_changed(e, &d, sink, &err), CW_ERR_LIMIT, "max_triangles",
                 err);
    d.max_triangles = 0;
    d.max_bytes = 10000;
    assert_fails(cw_extractor_extract_changed(e, &d, sink, &err), CW_ERR_LIMIT, "max_bytes",
                 err);
    assert_int_equal(k.given, 0);
    d.max_bytes = 0;
    follow(e, cwi_engine_best(), &v, &d, &k);
    free_keeper(&k);
    cw_extractor_free(e);
    cw_volume_free(&v);
}

static cw_status ignore_brick(void *user, const cw_brick *brick, cw_error *err)
{
    (void)user;
    (void)brick;
    (void)err;
    return CW_OK;
}

static void memory_running_out_while_bricks_are_made(void **state)
{
    (void)state;
    static float voxels[4 * 3 * 3];
    const cw_volume v = {.data = voxels, .type = CW_F32, .dim = {4, 3, 3}};
    const cw_box box = {{1, 1, 1}, {1, 1, 1}};
    bool failed = true;
    voxels[12 + 4 + 1] = voxels[12 + 4 + 2] = 1; /* gradients vanish beside them */
    for (long n = 0; failed; n++) {
        const cw_extract_desc d = {.isovalue = 0.5f, .leave_open = n % 2, .threads = 1};
        cw_extractor *e;
        cw_error err = {0};
        keeper k = {.left = -1};
        assert_ok(cw_extractor_new(&v, &e, &err), err);
        cwi_alloc_fail_after(n / 2);
        cw_status st =
            cw_extractor_extract_changed(e, &d, (cw_brick_sink){ignore_brick, NULL}, &err);
        failed = cwi_alloc_fail_after(-1);
        assert_int_equal(st, failed ? CW_ERR_NO_MEMORY : CW_OK);
        assert_ok(cw_extractor_update(e, &box, &err), err);
        follow(e, cwi_engine_best(), &v, &d, &k); /* it can be asked again */
        assert_true(k.given > 0);
        free_keeper(&k);
        cw_extractor_free(e);
        assert_true(failed || n > 20);
        assert_true(n < 200);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bricks_together_are_the_surface),
        cmocka_unit_test(normals_from_triangles_are_the_same_across_bricks),
        cmocka_unit_test(bricks_of_a_rectilinear_grid),
        cmocka_unit_test(only_bricks_around_a_change_are_given),
        cmocka_unit_test(bricks_that_were_not_taken_are_given_again),
        cmocka_unit_test(limits_are_for_the_bricks_of_a_call),
        cmocka_unit_test(memory_running_out_while_bricks_are_made),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
