/* Tests cell projection against formulas and ray casting: pieces of cells, degenerate views,
 * and bricks. */
#include "support/views.h"

#include "viewer/proxy/projected_cells.h"

#include <math.h>

enum { EDGE = 32, SIZE = 48 };

static const double cube[3] = {1, 1, 1};

static cw_scene scene_of(const cw_volume *volume, const cw_transfer *transfer, cw_camera camera)
{
    return (cw_scene){.mode = CW_MODE_PROJECTION,
                      .volume = volume,
                      .transfer = transfer,
                      .camera = camera,
                      .width = SIZE,
                      .height = SIZE};
}

/* Views along axes, along edges, along a diagonal, and any. */
static const double views[][2] = {{0, 0}, {90, 0}, {0, 89.9}, {45, 0}, {30, 25}, {45, 35.2644}};
enum { VIEWS = sizeof views / sizeof *views };

/* In parallel light the lengths of all rays through a box add up to its volume, and its pieces
 * are one, three, or at most seven. */
static void pieces_fill_the_cell(void **state)
{
    (void)state;
    static const size_t most[VIEWS] = {1, 1, 3, 3, 7, 7};
    cw_volume box = {0};
    const cw_transfer flat = test_flat_transfer();
    test_field(&box, 4, 4, 4, (double[]){1, 2, 3}, test_constant);
    for (int n = 0; n < VIEWS; n++) {
        const cw_scene scene = scene_of(&box, &flat, test_view(views[n][0], views[n][1], 0, 9));
        cw_error err = {0};
        cwi_frame frame;
        cwi_pieces p;
        double sum = 0;
        assert_ok(cwi_frame_init(&frame, &scene, &err), err);
        cwi_pieces_make(&frame, (double[]){1, 0, 2}, (double[]){2, 1, 3}, &p);
        for (size_t i = 0; i < p.index_count; i += 3) {
            const cwi_piece_vertex *a = &p.vertices[p.indices[i]],
                                   *b = &p.vertices[p.indices[i + 1]],
                                   *c = &p.vertices[p.indices[i + 2]];
            const double area = fabs((b->at[0] - a->at[0]) * (c->at[1] - a->at[1]) -
                                     (b->at[1] - a->at[1]) * (c->at[0] - a->at[0])) /
                                2;
            sum += area * (a->back - a->front + b->back - b->front + c->back - c->front) / 3;
        }
        assert_true(p.polygon_count >= 1 && p.polygon_count <= most[n]);
        assert_true(fabs(sum - 6) < 1e-6);
    }
    cw_volume_free(&box);
}

/* Against ray casting in steps of a tenth: constant and linear fields are exact but for
 * rounding and the tables; a cubic one shows what is linear between the faces of a cell. */
static void pass_lines_hold(void **state)
{
    (void)state;
    cw_renderer *r = test_renderer();
    const struct {
        double (*field)(const double p[3], const double q[3]);
        cw_transfer transfer;
        double most; /* rmse in 1/255 */
    } cases[] = {
        {test_constant, test_flat_transfer(), 0.05},
        {test_ramp, test_soft_transfer(), 0.05},
        {test_ramp, test_tent_transfer(), 0.2}, /* most of it that of the truth's steps */
        {test_blobs, test_soft_transfer(), 0.3},
    };
    for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
        cw_volume volume = {0};
        test_field(&volume, EDGE, EDGE, EDGE, cube, cases[c].field);
        cw_renderer_forget(r); /* it may stand where the last one stood */
        for (size_t n = 0; n < VIEWS; n++) {
            const double *view = views[n];
            cw_scene scene = scene_of(&volume, &cases[c].transfer,
                                      test_view(view[0], view[1], (n + c) % 2 ? 30 : 0, 50));
            scene.sampling.no_preintegration =
                c == 0; /* of one value there is nothing to be in a table */
            const test_gap gap = test_error(r, &scene);
            if (gap.rmse > cases[c].most)
                fail_msg("case %zu, view %zu: rmse %g, max %g", c, n, gap.rmse, gap.max);
        }
        cw_volume_free(&volume);
    }
}

/* The midpoint rule and the form of 1991 are coarser, and not by much. */
static void simple_forms_are_near(void **state)
{
    (void)state;
    cw_renderer *r = test_renderer();
    cw_transfer soft = test_soft_transfer();
    cw_volume blobs = {0};
    soft.gradients[1] = (cw_opacity_point){0.02, 1}; /* not counted at first */
    test_field(&blobs, EDGE, EDGE, EDGE, cube, test_blobs);
    cw_renderer_forget(r);
    cw_scene scene = scene_of(&blobs, &soft, test_view(30, 25, 30, 50));
    const double best = test_error(r, &scene).rmse;
    scene.sampling.no_preintegration = true;
    const double middle = test_error(r, &scene).rmse;
    scene.projection.linear_opacity = true;
    const double linear = test_error(r, &scene).rmse;
    assert_true(best < middle && middle < 0.5);
    assert_true(best < linear && linear < 2);
    for (int n = 0; n < 12; n++) { /* every shader there is does compile, and draws */
        soft.gradient_count = n / 8 * 2;
        scene.sampling.no_preintegration = n & 1 || n >= 8;
        scene.projection.linear_opacity = n & 2;
        scene.lit = n & 4 || n & 1;
        assert_true(test_error(r, &scene).rmse < 4);
    }
    cw_volume_free(&blobs);
}

/* Around a view along an axis, and one along edges, a small turn changes little. */
static void no_jump_in_degenerate_views(void **state)
{
    (void)state;
    cw_renderer *r = test_renderer();
    const cw_transfer soft = test_soft_transfer();
    cw_volume blobs = {0};
    test_field(&blobs, EDGE, EDGE, EDGE, cube, test_blobs);
    cw_renderer_forget(r);
    for (int n = 0; n < 2; n++) {
        cw_picture before = {0};
        double worst[2] = {0};
        for (int step = -8; step <= 8; step++) {
            const double turn = 45 * n + 1e-4 * step;
            cw_scene scene = scene_of(&blobs, &soft, test_view(turn, 0, 0, 50));
            scene.sampling.no_preintegration = true;
            cw_picture now = test_draw(r, &scene);
            if (before.pixels) {
                const double gap = test_compare(&now, &before).max;
                const int is_near = step == 0 || step == 1;
                worst[is_near] = fmax(worst[is_near], gap);
            }
            cw_picture_free(&before);
            before = now;
        }
        cw_picture_free(&before);
        assert_true(worst[1] < 0.05 + 2 * worst[0]);
        assert_true(worst[0] < 1);
    }
    cw_volume_free(&blobs);
}

/* Worlds of any scale, spacing and handedness, light, gradients, fog, planes: as
 * ray casting. */
static void settings_agree_with_ray_casting(void **state)
{
    (void)state;
    cw_renderer *r = test_renderer();
    const double spacings[][3] = {{1, 1, 1}, {1e-3, 1e-3, 1e-3}, {1e3, 1e3, 1e3}, {1, 2, 0.5}};
    for (int n = 0; n < 12; n++) {
        const double *spacing = spacings[n < 4 ? n : n == 11 ? 3 : 0];
        const double scale = n == 1 ? 1e-3 : n == 2 ? 1e3 : 1;
        cw_transfer soft = test_soft_transfer();
        cw_volume blobs = {0};
        test_field(&blobs, EDGE, EDGE, n == 5 ? 1 : EDGE, spacing, test_blobs);
        cw_renderer_forget(r);
        cw_scene scene = scene_of(&blobs, &soft, test_view(30, 25, n % 2 ? 0 : 30, 60 * scale));
        scene.sampling.no_preintegration = true; /* its table takes longer than the picture */
        if (n == 3)
            soft.unit_mm = 1;
        if (n == 4 || n == 11)
            test_shear(&blobs);
        if (n == 6 || n == 7)
            scene.lit = true;
        if (n == 8) {
            soft.gradient_count = 2;
            soft.gradients[1] = (cw_opacity_point){0.05, 1};
        }
        if (n == 9) {
            scene.depth_cue = 0.8f;
            scene.background[0][0] = 1;
        }
        if (n == 10 || n == 7) {
            scene.clip_count = 2;
            scene.clips[0] = (cw_clip){{1, 0.3, -0.2}, -3.3};
            scene.clips[1] = (cw_clip){{0, -1, 0.1}, -7.1};
            scene.cut_away = n == 7;
        }
        const test_gap gap = test_error(r, &scene);
        const double most = scene.lit || n == 8 ? 1 : 0.5;
        if (gap.rmse > most)
            fail_msg("setting %d: rmse %g, max %g", n, gap.rmse, gap.max);
        cw_volume_free(&blobs);
    }
}

/* The eye may be inside: cells are cut off at the near plane. */
static void eye_inside_sees_what_is_in_front(void **state)
{
    (void)state;
    cw_renderer *r = test_renderer();
    const cw_transfer soft = test_soft_transfer();
    cw_volume blobs = {0};
    test_field(&blobs, EDGE, EDGE, EDGE, cube, test_blobs);
    cw_renderer_forget(r);
    cw_scene scene = scene_of(&blobs, &soft, test_view(30, 25, 90, 8));
    scene.sampling.no_preintegration = true;
    assert_true(test_error(r, &scene).rmse < 0.5);
    cw_volume_free(&blobs);
}

/* Cells around a voxel without a value are empty. */
static void nodata_is_left_out(void **state)
{
    (void)state;
    cw_renderer *r = test_renderer();
    const cw_transfer flat = test_flat_transfer();
    cw_volume box = {0};
    test_field(&box, EDGE, EDGE, EDGE, cube, test_constant);
    box.has_nodata = true;
    box.nodata = -7;
    cw_renderer_forget(r);
    float *voxels = cw_volume_voxels(&box);
    for (size_t n = 0; n < EDGE * EDGE * EDGE; n += 97)
        voxels[n] = -7;
    cw_scene scene = scene_of(&box, &flat, test_view(30, 25, 30, 50));
    scene.sampling.no_preintegration = true; /* whose table takes longer than the picture */
    assert_true(test_error(r, &scene).rmse < 0.2);
    cw_volume_free(&box);
}

/* Nodes drawn whole to a tolerance: the picture changes by less than the tolerance lets it. */
static void nodes_follow_the_tolerance(void **state)
{
    (void)state;
    cw_renderer *r = test_renderer();
    const cw_transfer soft = test_soft_transfer();
    cw_volume blobs = {0};
    test_field(&blobs, EDGE, EDGE, EDGE, cube, test_blobs);
    cw_renderer_forget(r);
    cw_scene scene = scene_of(&blobs, &soft, test_view(30, 25, 30, 50));
    scene.sampling.no_preintegration = true;
    cw_picture exact = test_draw(r, &scene);
    double before = 0;
    for (int n = 0; n < 4; n++) {
        scene.projection.tree_error = (double[]){0.01, 0.03, 0.1, 0.3}[n];
        cw_picture picture = test_draw(r, &scene);
        const double rmse = test_compare(&picture, &exact).rmse;
        assert_true(rmse >= before && rmse < 200 * scene.projection.tree_error);
        before = rmse;
        cw_picture_free(&picture);
    }
    assert_true(before > 0);
    cw_picture_free(&exact);
    cw_volume_free(&blobs);
}

/* In how many textures the volume lies does not show. */
static void bricks_leave_no_seams(void **state)
{
    (void)state;
    cw_renderer *r = test_renderer();
    const cw_transfer soft = test_soft_transfer();
    cw_volume blobs = {0};
    test_field(&blobs, EDGE, EDGE, EDGE, cube, test_blobs);
    cw_renderer_forget(r);
    cw_scene scene = scene_of(&blobs, &soft, test_view(30, 25, 30, 50));
    scene.sampling.no_preintegration = true;
    scene.lit = true;
    cw_picture whole = test_draw(r, &scene);
    scene.sampling.texture_edge = 13;
    cw_picture bricks = test_draw(r, &scene);
    assert_true(test_compare(&bricks, &whole).max < 0.05);
    cw_picture_free(&whole);
    cw_picture_free(&bricks);
    cw_volume_free(&blobs);
}

static bool stop(void *user, const char *step, double done)
{
    (void)step, (void)done;
    return --*(int *)user > 0;
}

static void drawing_can_be_cancelled(void **state)
{
    (void)state;
    cw_renderer *r = test_renderer();
    const cw_transfer flat = test_flat_transfer();
    cw_volume box = {0};
    cw_picture picture;
    test_field(&box, EDGE, EDGE, EDGE, cube, test_constant);
    cw_scene scene = scene_of(&box, &flat, test_view(30, 25, 30, 50));
    scene.sampling.no_preintegration = true;
    for (int n = 0; n < 3; n++) {
        int calls = 2;
        cw_error err = {0};
        scene.mode = (cw_mode[]){CW_MODE_PROJECTION, CW_MODE_SPLAT, CW_MODE_SPLAT_TREE}[n];
        scene.progress = (cw_progress){stop, &calls};
        assert_int_equal(cw_render(r, &scene, &picture, &err), CW_ERR_CANCELLED);
        assert_null(picture.pixels);
    }
    cw_volume_free(&box);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pieces_fill_the_cell),
        cmocka_unit_test(pass_lines_hold),
        cmocka_unit_test(simple_forms_are_near),
        cmocka_unit_test(no_jump_in_degenerate_views),
        cmocka_unit_test(settings_agree_with_ray_casting),
        cmocka_unit_test(eye_inside_sees_what_is_in_front),
        cmocka_unit_test(nodata_is_left_out),
        cmocka_unit_test(nodes_follow_the_tolerance),
        cmocka_unit_test(bricks_leave_no_seams),
        cmocka_unit_test(drawing_can_be_cancelled),
    };
    return cmocka_run_group_tests(tests, NULL, test_renderer_close);
}
