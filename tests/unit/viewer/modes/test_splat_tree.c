/* Tests splatting of a tree of nodes: errors, mass of the levels, and budgets of splats. */
#include "support/views.h"

#include "viewer/proxy/value_octree.h"

#include <math.h>
#include <string.h>

enum { EDGE = 45, SIZE = 64 }; /* an edge that no power of two divides */

static const double cube[3] = {1, 1, 1};

static cw_scene scene_of(const cw_volume *volume, const cw_transfer *transfer, cw_camera camera)
{
    return (cw_scene){.mode = CW_MODE_SPLAT_TREE,
                      .volume = volume,
                      .transfer = transfer,
                      .camera = camera,
                      .width = SIZE,
                      .height = SIZE};
}

static void make_blobs(cw_volume *blobs)
{
    *blobs = (cw_volume){0};
    test_field(blobs, EDGE, EDGE, EDGE, cube, test_blobs);
    if (test_renderer())
        cw_renderer_forget(test_renderer());
}

/* Without an error allowed it is flat splatting, to the bit. */
static void no_error_is_flat_splatting(void **state)
{
    (void)state;
    cw_renderer *r = test_renderer();
    const cw_transfer soft = test_soft_transfer();
    cw_volume blobs;
    make_blobs(&blobs);
    cw_scene scene = scene_of(&blobs, &soft, test_view(30, 25, 30, 66));
    cw_picture tree = test_draw(r, &scene);
    scene.mode = CW_MODE_SPLAT;
    cw_picture flat = test_draw(r, &scene);
    assert_memory_equal(tree.pixels, flat.pixels, SIZE * SIZE * 4 * sizeof *flat.pixels);
    cw_picture_free(&tree);
    cw_picture_free(&flat);
    cw_volume_free(&blobs);
}

/* A tree with a larger allowed error differs more, and the difference starts near nothing. */
static void error_rises_with_the_threshold(void **state)
{
    (void)state;
    cw_renderer *r = test_renderer();
    const cw_transfer soft = test_soft_transfer();
    const double errors[] = {0.01, 0.04, 0.1, 0.2, 0.4, 1};
    cw_volume blobs;
    make_blobs(&blobs);
    for (int view = 0; view < 3; view++) {
        cw_scene scene =
            scene_of(&blobs, &soft, test_view(40 * view, 25 * view, view % 2 ? 0 : 30, 66));
        scene.lit = view == 2;
        cw_picture flat = test_draw(r, &scene);
        double before = 0;
        for (size_t n = 0; n < sizeof errors / sizeof *errors; n++) {
            scene.splat.tree_error = errors[n];
            cw_picture tree = test_draw(r, &scene);
            const double rmse = test_compare(&tree, &flat).rmse;
            if (!(rmse >= before) || (n == 0 && !view && rmse > 0.2))
                fail_msg("view %d, error %g: rmse %g after %g", view, errors[n], rmse, before);
            before = rmse;
            cw_picture_free(&tree);
        }
        assert_true(before > 1);
        cw_picture_free(&flat);
    }
    cw_volume_free(&blobs);
}

/* A box of one value is one node, and looks as its voxels do. */
static void constant_box_is_one_node(void **state)
{
    (void)state;
    cw_renderer *r = test_renderer();
    const cw_transfer flat = test_flat_transfer();
    cw_volume box = {0};
    test_field(&box, EDGE, EDGE, EDGE, (double[]){1, 1.5, 2}, test_constant);
    cw_renderer_forget(r);
    for (int n = 0; n < 4; n++) {
        cw_scene scene = scene_of(&box, &flat, test_view(15 * n, 10 * n, n % 2 ? 0 : 30, 110));
        cw_picture all = test_draw(r, &scene);
        scene.splat.tree_error = 0.01;
        cw_picture one = test_draw(r, &scene);
        const size_t middle = 4 * (SIZE / 2 * SIZE + SIZE / 2) + 3;
        assert_true(test_compare(&one, &all).rmse < 1.5); /* at the border: half voxels */
        assert_true(fabs((double)(one.pixels[middle] - all.pixels[middle])) < 0.05 / 255);
        scene.splat.budget = EDGE;
        cw_picture few = test_draw(r, &scene);
        assert_true(test_compare(&one, &few).max == 0);
        cw_picture_free(&all);
        cw_picture_free(&one);
        cw_picture_free(&few);
    }
    cw_volume_free(&box);
}

/* Each level sums up the one below it: mass is that of all cells, and means lie within. */
static void pyramid_keeps_the_mass(void **state)
{
    (void)state;
    cw_error err = {0};
    cw_volume blobs = {0};
    test_field(&blobs, EDGE, 7, 1, cube, test_blobs);
    for (int gaps = 0; gaps < 2; gaps++) {
        cwi_pyramid one, many;
        double truth = (EDGE - 1) * 6.0;
        if (gaps) { /* the cells around a voxel in the middle are gone */
            ((float *)cw_volume_voxels(&blobs))[3 * EDGE + 20] = NAN;
            truth -= 4;
        }
        assert_ok(cwi_pyramid_make(&blobs, gaps, 1, &(cw_progress){0}, &one, &err), err);
        assert_ok(cwi_pyramid_make(&blobs, gaps, 4, &(cw_progress){0}, &many, &err), err);
        assert_int_equal(one.level_count, many.level_count);
        for (size_t level = 0; level < one.level_count; level++) {
            const size_t *dim = one.levels[level].dim;
            const size_t count = dim[0] * dim[1] * dim[2];
            double mass = 0;
            for (size_t n = 0; n < count; n++) {
                const cwi_pyramid_node *node = &one.levels[level].nodes[n];
                mass += (double)node->mass;
                assert_true(!(node->mass > 0) ||
                            (node->low <= node->mean && node->mean <= node->high));
            }
            assert_true(fabs(mass - truth) < 1e-3);
            assert_memory_equal(one.levels[level].nodes, many.levels[level].nodes,
                                count * sizeof *one.levels[level].nodes);
        }
        cwi_pyramid_free(&one);
        cwi_pyramid_free(&many);
    }
    cw_volume_free(&blobs);
}

/* More error, fewer splats; the error that fits a budget is the least of those told. */
static void budgets_are_kept(void **state)
{
    (void)state;
    static size_t counts[CWI_PYRAMID_STEPS + 1];
    const cw_transfer soft = test_soft_transfer();
    cw_volume blobs = {0};
    cw_error err = {0};
    cwi_frame frame;
    cwi_table table;
    cwi_visible visible;
    cwi_pyramid pyramid;
    test_field(&blobs, EDGE, EDGE, EDGE, cube, test_blobs);
    const cw_scene scene = scene_of(&blobs, &soft, test_view(0, 0, 30, 66));
    assert_ok(cwi_frame_init(&frame, &scene, &err), err);
    assert_ok(cwi_table_make(&frame, &table, &err), err);
    assert_ok(cwi_visible_make(&table, &visible, &err), err);
    assert_ok(cwi_pyramid_make(&frame.volume, false, 0, &(cw_progress){0}, &pyramid, &err),
              err);
    const cwi_pyramid_view view = {&frame, &table, &visible, 1};
    cwi_pyramid_counts(&pyramid, &view, counts);
    for (int n = 0; n < 4; n++) {
        double error;
        const size_t budget = counts[0] / (size_t[]){1, 2, 5, 20}[n];
        assert_ok(cwi_pyramid_fit(&pyramid, &view, budget, &error, &err), err);
        const size_t step = (size_t)lrint(error * CWI_PYRAMID_STEPS);
        assert_true(counts[step] <= budget);
        assert_true(step == 0 ? n == 0 : counts[step - 1] > budget);
    }
    assert_true(counts[CWI_PYRAMID_STEPS / 10] < counts[CWI_PYRAMID_STEPS / 100]);
    cwi_pyramid_free(&pyramid);
    cwi_visible_free(&visible);
    cwi_table_free(&table);
    cw_volume_free(&blobs);
}

/* The picture of a budget is near that of all splats, and the nearer the more there are. */
static void budgets_refine(void **state)
{
    (void)state;
    cw_renderer *r = test_renderer();
    const cw_transfer soft = test_soft_transfer();
    cw_volume blobs;
    make_blobs(&blobs);
    cw_scene scene = scene_of(&blobs, &soft, test_view(30, 25, 30, 66));
    cw_picture flat = test_draw(r, &scene);
    double before = INFINITY;
    for (int n = 0; n < 5; n++) {
        scene.splat.budget = (size_t[]){300, 1000, 3000, 10000, 1000000}[n];
        cw_picture tree = test_draw(r, &scene);
        const double rmse = test_compare(&tree, &flat).rmse;
        assert_true(rmse <= before);
        before = rmse;
        cw_picture_free(&tree);
    }
    assert_true(before == 0);
    cw_picture_free(&flat);
    cw_volume_free(&blobs);
}

/* A plane that clips cuts nodes down to voxels: large nodes are cut where voxels are. */
static void clips_cut_nodes(void **state)
{
    (void)state;
    cw_renderer *r = test_renderer();
    const cw_transfer flat = test_flat_transfer();
    cw_volume box = {0};
    test_field(&box, EDGE, EDGE, EDGE, cube, test_constant);
    cw_renderer_forget(r);
    cw_scene scene = scene_of(&box, &flat, test_view(30, 25, 30, 70));
    scene.clip_count = 1;
    scene.clips[0] = (cw_clip){{1, 0.4, 0.2}, 2.3};
    for (int n = 0; n < 2; n++) {
        scene.cut_away = n;
        scene.splat.tree_error = 0;
        cw_picture all = test_draw(r, &scene);
        scene.splat.tree_error = 0.01;
        cw_picture nodes = test_draw(r, &scene);
        assert_true(test_compare(&nodes, &all).rmse < 0.6);
        cw_picture_free(&all);
        cw_picture_free(&nodes);
    }
    cw_volume_free(&box);
}

static void errors_out_of_range_are_refused(void **state)
{
    (void)state;
    const cw_transfer soft = test_soft_transfer();
    cw_volume blobs = {0};
    cw_error err = {0};
    cwi_frame frame;
    test_field(&blobs, 4, 4, 4, cube, test_blobs);
    cw_scene scene = scene_of(&blobs, &soft, test_view(0, 0, 30, 10));
    for (int n = 0; n < 3; n++) {
        scene.splat.tree_error = (double[]){-0.1, 1.5, NAN}[n];
        assert_int_equal(cwi_frame_init(&frame, &scene, &err), CW_ERR_ARGUMENT);
        assert_non_null(strstr(err.message, "splat.tree_error"));
    }
    cw_volume_free(&blobs);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(no_error_is_flat_splatting),
        cmocka_unit_test(error_rises_with_the_threshold),
        cmocka_unit_test(constant_box_is_one_node),
        cmocka_unit_test(pyramid_keeps_the_mass),
        cmocka_unit_test(budgets_are_kept),
        cmocka_unit_test(budgets_refine),
        cmocka_unit_test(clips_cut_nodes),
        cmocka_unit_test(errors_out_of_range_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, test_renderer_close);
}
