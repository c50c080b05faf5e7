/* Surfaces of a volume that changes: the whole one as from scratch, and its bricks, which together
 * are the whole one. */
#include "support/cells.h"
#include "support/hostile.h"
#include "support/surface.h"

#include "core/base/memory.h"
#include "extract/dense/isa_dispatch.h"
#include "extract/extract_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static double random_number(double limit)
{
    return limit * rand() / ((double)RAND_MAX + 1);
}

static cw_box random_box(const cw_volume *v)
{
    cw_box box;
    for (int a = 0; a < 3; a++) {
        box.first[a] = (size_t)rand() % v->dim[a];
        box.count[a] = (size_t)rand() % (v->dim[a] - box.first[a]) + 1;
        if (rand() % 2 && box.count[a] > 12)
            box.count[a] = 12;
    }
    return box;
}

/* Patterns that boxes are painted with. */
typedef enum paint_kind { CONSTANT, WAVES, NOISE, SPOTS, NOTHING, PAINTS } paint_kind;

static double paint_value(paint_kind kind, const size_t at[3], double base)
{
    switch (kind) {
    case WAVES:
        return 50 + 40 * sin(0.4 * (double)at[0] + base) * cos(0.3 * (double)at[1]) +
               10 * sin(0.5 * (double)at[2]);
    case NOISE:
        return random_number(100);
    case SPOTS: /* gradients vanish beside them */
        return at[0] % 4 == 1 && at[1] % 4 == 1 && at[2] % 4 != 3 ? 90 : 10;
    case NOTHING:
        return rand() % 3 ? base : NAN;
    default:
        return base;
    }
}

/* Paints a box of the volume; 7 stands for no value where numbers cannot be NaN. */
static void paint(cw_volume *v, const cw_box *box, paint_kind kind)
{
    const bool has_nan = v->type == CW_F32 || v->type == CW_F64;
    const double base = floor(random_number(100));
    for (size_t k = box->first[2]; k < box->first[2] + box->count[2]; k++)
        for (size_t j = box->first[1]; j < box->first[1] + box->count[1]; j++)
            for (size_t i = box->first[0]; i < box->first[0] + box->count[0]; i++) {
                const double x = paint_value(kind, (size_t[3]){i, j, k}, base);
                test_store(v->type, cw_volume_voxels(v), (k * v->dim[1] + j) * v->dim[0] + i,
                           isnan(x) && !has_nan ? 7 : x);
            }
}

static void paint_all(cw_volume *v, paint_kind kind)
{
    const cw_box all = {{0, 0, 0}, {v->dim[0], v->dim[1], v->dim[2]}};
    paint(v, &all, kind);
}

static cw_volume make_volume(cw_type type, const size_t dim[3])
{
    cw_volume v;
    cw_error err = {0};
    assert_ok(cw_volume_alloc(&v, type, dim, 1, 1, &err), err);
    paint_all(&v, rand() % PAINTS);
    v.slope = rand() % 4 ? 1 : -1;
    v.has_nodata = rand() % 3 == 0;
    v.nodata = 7;
    return v;
}

static cw_extract_desc random_settings(const cw_volume *v)
{
    return (cw_extract_desc){.isovalue = (rand() % 3 ? 50.3 : floor(random_number(100))) *
                                         (v->slope ? v->slope : 1),
                             .inside_is_low = rand() % 2,
                             .leave_open = rand() % 3 == 0,
                             .simple_topology = rand() % 4 == 0,
                             .cubic_placement = rand() % 4 == 0,
                             .no_normals = rand() % 5 == 0,
                             .threads = 1 + rand() % 2};
}

/* Changes the volume, or parts of it, and tells the extractor. */
static void change(cw_volume *v, cw_extractor *e)
{
    cw_error err = {0};
    const int boxes = rand() % 4;
    if (rand() % 6 == 0) {
        paint_all(v, rand() % PAINTS);
        assert_ok(cw_extractor_update(e, NULL, &err), err);
    }
    for (int n = 0; n < boxes; n++) {
        const cw_box box = random_box(v);
        paint(v, &box, rand() % PAINTS);
        assert_ok(cw_extractor_update(e, &box, &err), err);
    }
}

static const cwi_engine *some_engine(int round)
{
    size_t engines = 0;
    while (cwi_engine_at(engines))
        engines++;
    return cwi_engine_at((size_t)round % engines);
}

static const size_t sizes[][3] = {{2, 2, 2},    {7, 8, 9},    {15, 16, 17}, {33, 40, 24},
                                  {64, 31, 20}, {80, 33, 31}, {130, 9, 20}, {70, 5, 71}};

static void each_frame_is_as_from_scratch(void **state)
{
    (void)state;
    test_seed(17);
    for (int round = 0; round < 60; round += test_is_short() ? 4 : 1) {
        const cwi_engine *engine = some_engine(round);
        cw_volume v = make_volume((cw_type)(round % CW_TYPE_COUNT), sizes[rand() % 8]);
        cw_extractor *e;
        cw_mesh mesh = {0}, once = {0}; /* filled again and again */
        cw_error err = {0};
        const size_t leaf_bytes = round % 3 ? 0 : CWI_LEAF_BYTES;
        assert_ok(cwi_extractor_new_with(engine, leaf_bytes, &v, &e, &err), err);
        for (int frame = 0; frame < 10; frame++) {
            const cw_extract_desc d = random_settings(&v);
            cw_extract_counts counts[2] = {{0}, {0}};
            assert_ok(cwi_extract_with(engine, &v, &d, &once, &counts[0], &err), err);
            assert_ok(cw_extractor_extract(e, &d, &mesh, &counts[1], &err), err);
            test_assert_same_mesh(&once, &mesh);
            assert_int_equal(counts[0].border_loops, counts[1].border_loops);
            change(&v, e);
        }
        cw_mesh_free(&mesh);
        cw_mesh_free(&once);
        cw_extractor_free(e);
        cw_volume_free(&v);
    }
}

/* --- bricks ------------------------------------------------------------------------------- */

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
        const cwi_engine *engine = some_engine(round);
        cw_volume v = make_volume((cw_type)(round % CW_TYPE_COUNT), sizes[rand() % 8]);
        cw_extractor *e;
        cw_error err = {0};
        cw_mesh mesh = {0}, once = {0};
        keeper k = {.left = -1};
        if (round % 2)
            test_turn(&v, round);
        cw_extract_desc d = random_settings(&v);
        assert_ok(cwi_extractor_new_with(engine, 0, &v, &e, &err), err);
        for (int frame = 0; frame < 10; frame++) {
            follow(e, engine, &v, &d, &k);
            change(&v, e);
            if (rand() % 4 == 0)
                d = random_settings(&v);
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
        cw_volume v = make_volume(round % 2 ? CW_U8 : CW_F32, (size_t[3]){50, 40, 36});
        keeper k = {.left = -1};
        v.slope = 1;
        v.has_nodata = false;
        paint_all(&v, SPOTS);
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
        cw_volume v = make_volume(round % 2 ? CW_F32 : CW_I16, (size_t[3]){48, 35, 20});
        cw_extractor *e;
        cw_error err = {0};
        keeper k = {.left = -1};
        for (int a = 0; a < 3; a++) {
            for (int i = 1; i < 48; i++)
                places[a][i] = places[a][i - 1] + 0.5 + random_number(1);
            v.coordinates[a] = places[a];
        }
        cw_extract_desc d = random_settings(&v);
        d.cubic_placement = false;
        assert_ok(cw_extractor_new(&v, &e, &err), err);
        for (int frame = 0; frame < 5; frame++) {
            follow(e, cwi_engine_best(), &v, &d, &k);
            change(&v, e);
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
    paint(&v, &box, NOISE);
    assert_ok(cw_extractor_update(e, &box, &err), err);
    k.box = &box;
    follow(e, cwi_engine_best(), &v, &d, &k);
    assert_true(k.given > 0 && k.given <= 12); /* 3 x 2 x 2 */
    k.box = NULL;
    paint_all(&v, CONSTANT); /* the surface is gone: every brick is replaced by nothing */
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

/* --- calls -------------------------------------------------------------------------------- */

static void a_filled_mesh_is_written_over_or_freed(void **state)
{
    (void)state;
    cw_volume v = test_sample(CW_FIELD_SPHERE, 60, CW_F32);
    const cw_extract_desc some = {.isovalue = 0}, none = {.isovalue = 1e6},
                          bad = {.isovalue = NAN};
    cw_extractor *e;
    cw_mesh mesh = {0}, copy = {0};
    cw_error err = {0};
    const size_t before = cw_memory_used();
    assert_ok(cw_extractor_new(&v, &e, &err), err);
    assert_ok(cw_extractor_extract(e, &some, &mesh, NULL, &err), err);
    const float *positions = mesh.positions;
    for (int frame = 0; frame < 3; frame++) {
        assert_ok(cw_extractor_update(e, NULL, &err), err);
        assert_ok(cw_extractor_extract(e, &some, &mesh, NULL, &err), err);
        assert_ptr_equal(mesh.positions, positions);
    }
    assert_ok(cw_extractor_extract(e, &none, &mesh, NULL, &err), err); /* keeps the arrays */
    assert_null(mesh.positions);
    assert_ok(cw_extractor_extract(e, &some, &mesh, NULL, &err), err);
    assert_ptr_equal(mesh.positions, positions);
    assert_fails(cw_extractor_extract(e, &bad, &mesh, NULL, &err), CW_ERR_ARGUMENT, "finite",
                 err);
    assert_null(mesh.positions);
    cw_extractor_free(e);

    assert_ok(cw_extract(&v, &some, &mesh, NULL, &err), err);
    mesh.colors = cwi_alloc_zeroed(mesh.vertex_count, 4); /* of the old surface: freed */
    assert_ok(cw_extract(&v, &some, &mesh, NULL, &err), err);
    assert_null(mesh.colors);
    assert_ok(cw_extract(&v, &some, &copy, NULL, &err), err);
    test_assert_same_mesh(&mesh, &copy);
    assert_ok(cw_extract(&v, &none, &mesh, NULL, &err), err);
    assert_null(mesh.positions);
    assert_fails(cw_extract(&v, &bad, &copy, NULL, &err), CW_ERR_ARGUMENT, "finite", err);
    assert_null(copy.positions);
    assert_int_equal(cw_memory_used(), before);
    cw_volume_free(&v);
}

static void wrong_boxes_and_grids_are_refused(void **state)
{
    (void)state;
    cw_volume v = test_sample(CW_FIELD_SPHERE, 20, CW_F32);
    cw_extractor *e;
    cw_error err = {0};
    keeper k = {.left = -1};
    const cw_brick_sink sink = {take_brick, &k};
    test_grid g;
    assert_ok(cw_extractor_new(&v, &e, &err), err);
    assert_fails(cw_extractor_update(NULL, NULL, &err), CW_ERR_ARGUMENT, "e", err);
    assert_fails(cw_extractor_update(e, &(cw_box){{0, 0, 0}, {20, 0, 20}}, &err),
                 CW_ERR_ARGUMENT, "box", err);
    assert_fails(cw_extractor_update(e, &(cw_box){{1, 0, 0}, {20, 1, 1}}, &err),
                 CW_ERR_ARGUMENT, "leaves", err);
    assert_fails(cw_extractor_update(e, &(cw_box){{1, 0, 0}, {SIZE_MAX, 1, 1}}, &err),
                 CW_ERR_ARGUMENT, "leaves", err);
    assert_fails(cw_extractor_extract_changed(e, &(cw_extract_desc){.snap = 0.3}, sink, &err),
                 CW_ERR_ARGUMENT, "snap", err);
    assert_fails(
        cw_extractor_extract_changed(e, &(cw_extract_desc){.isovalue = NAN}, sink, &err),
        CW_ERR_ARGUMENT, "finite", err);
    cw_extractor_free(e);
    cw_volume_free(&v);

    test_grid_make(&g, TEST_MIXED, 3, 0);
    assert_ok(cw_extractor_new(&g.volume, &e, &err), err);
    assert_ok(cw_extractor_update(e, NULL, &err), err);
    assert_fails(cw_extractor_update(e, &(cw_box){{0, 0, 0}, {1, 1, 1}}, &err),
                 CW_ERR_UNSUPPORTED, "irregular", err);
    assert_fails(cw_extractor_extract_changed(e, NULL, sink, &err), CW_ERR_UNSUPPORTED,
                 "irregular", err);
    cw_extractor_free(e);
    test_grid_free(&g);
    assert_int_equal(k.given, 0);
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
        cmocka_unit_test(each_frame_is_as_from_scratch),
        cmocka_unit_test(bricks_together_are_the_surface),
        cmocka_unit_test(normals_from_triangles_are_the_same_across_bricks),
        cmocka_unit_test(bricks_of_a_rectilinear_grid),
        cmocka_unit_test(only_bricks_around_a_change_are_given),
        cmocka_unit_test(bricks_that_were_not_taken_are_given_again),
        cmocka_unit_test(limits_are_for_the_bricks_of_a_call),
        cmocka_unit_test(a_filled_mesh_is_written_over_or_freed),
        cmocka_unit_test(wrong_boxes_and_grids_are_refused),
        cmocka_unit_test(memory_running_out_while_bricks_are_made),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
