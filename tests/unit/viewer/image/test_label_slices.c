/* Tests labels over slices: the nearest voxel's, blended, on grids that lie askew. */
#include "support/pictures.h"

#include <cubewright/overlay.h>

#include <math.h>
#include <string.h>

enum { WIDTH = 60, HEIGHT = 40 };

/* A grey scan with an axial slice, and labels on a coarse grid that is turned and shifted. */
typedef struct fixture {
    float grey[20 * 16 * 8];
    uint32_t numbers[7 * 6 * 5];
    cw_volume scan, map;
    cw_transfer transfer;
    cw_scene scene;
    cw_label_table table;
} fixture;

static void add_label(cw_label_table *table, uint32_t value, const uint8_t color[4])
{
    cw_error err = {0};
    cw_label label = {.value = value, .layer = 2, .has_color = true};
    memcpy(label.color, color, 4);
    assert_ok(cw_label_table_add(table, &label, &err), err);
}

static void make_fixture(fixture *f)
{
    cw_error err = {0};
    memset(f, 0, sizeof *f);
    f->scan = (cw_volume){.data = f->grey, .type = CW_F32, .dim = {20, 16, 8}};
    f->map = (cw_volume){.data = f->numbers, .type = CW_U32, .dim = {7, 6, 5}};
    const double turned[3][4] = {{1.6, -1.2, 0, 9}, {1.2, 1.6, 0, -2}, {0, 0, 1.7, 1}};
    memcpy(f->map.affine, turned, sizeof turned);
    for (size_t n = 0; n < 7 * 6 * 5; n++)
        f->numbers[n] = n % 4 == 0 ? 0 : n % 4 == 3 ? 77 : 4294967290u + (uint32_t)(n % 4);
    add_label(&f->table, 4294967291u, (const uint8_t[4]){255, 0, 0, 255});
    add_label(&f->table, 4294967292u, (const uint8_t[4]){0, 255, 51, 128});
    f->transfer = (cw_transfer){.color_count = 1,
                                .colors = {{0, {0, 0, 0}}},
                                .opacity_count = 1,
                                .opacities = {{0, 1}}};
    f->scene = (cw_scene){.mode = CW_MODE_SLICES,
                          .volume = &f->scan,
                          .transfer = &f->transfer,
                          .width = WIDTH,
                          .height = HEIGHT,
                          .slice_count = 1,
                          .slices = {{{0, 0, 1}, 4.3}}};
    assert_ok(cw_slice_camera(&f->scan, &f->scene.slices[0], (double)WIDTH / HEIGHT,
                              &f->scene.camera, &err),
              err);
}

/* Draws on a picture of one grey. */
static cw_picture paint_slice(const fixture *f, float opacity)
{
    cw_picture picture;
    cw_error err = {0};
    const cw_label_slices labels = {&f->map, &f->table, 2, opacity};
    assert_ok(cw_picture_alloc(&picture, WIDTH, HEIGHT, &err), err);
    for (size_t n = 0; n < 4 * (size_t)WIDTH * HEIGHT; n++)
        picture.pixels[n] = n % 4 == 3 ? 1 : 0.5f;
    assert_ok(cw_label_slices_draw(&labels, &f->scene, &picture, &err), err);
    return picture;
}

/* Finds the label whose voxel's cell a point of the world is in, by a search over all. Returns
 * false where none is, or where the point is so close to a wall that rounding decides. */
static bool find_label(const fixture *f, const double world[3], uint32_t *label)
{
    *label = 0;
    for (size_t n = 0; n < 7 * 6 * 5; n++) {
        const double index[3] = {(double)(n % 7), (double)(n / 7 % 6), (double)(n / 42)};
        double middle[3], far = 0;
        cw_volume_to_world(&f->map, index, middle);
        for (int a = 0; a < 3; a++) { /* the grid's axes are orthogonal */
            double along = 0, square = 0;
            for (int r = 0; r < 3; r++) {
                along += (world[r] - middle[r]) * f->map.affine[r][a];
                square += f->map.affine[r][a] * f->map.affine[r][a];
            }
            far = fmax(far, fabs(along / square));
        }
        if (fabs(far - 0.5) < 1e-6)
            return false;
        if (far < 0.5)
            *label = f->numbers[n];
    }
    return true;
}

static void the_nearest_voxel_counts(void **state)
{
    (void)state;
    static fixture f;
    cw_error err = {0};
    size_t colored = 0, plain = 0;
    make_fixture(&f);
    cw_picture picture = paint_slice(&f, 0.5f);
    for (size_t y = 0; y < HEIGHT; y++)
        for (size_t x = 0; x < WIDTH; x++) {
            const double pixel[2] = {(double)x + 0.5, (double)y + 0.5};
            double world[3], direction[3];
            uint32_t label;
            const float *found = picture.pixels + 4 * (y * WIDTH + x);
            float expected[3] = {0.5f, 0.5f, 0.5f};
            assert_ok(
                cw_camera_ray(&f.scene.camera, WIDTH, HEIGHT, pixel, world, direction, &err),
                err);
            world[2] = 4.3;
            if (!find_label(&f, world, &label))
                continue;
            if (world[0] < 0 || world[0] > 19 || world[1] < 0 || world[1] > 15)
                label = 0; /* the scan ends here */
            const double opacity = label == 4294967291u   ? 0.5
                                   : label == 4294967292u ? 64 / 255.0
                                                          : 0;
            const float colors[2][3] = {{1, 0, 0}, {0, 1, 0.2f}};
            for (int c = 0; c < 3 && opacity > 0; c++)
                expected[c] = (float)(0.5 * (1 - opacity)) +
                              (float)opacity * colors[label == 4294967292u][c];
            for (int c = 0; c < 3; c++)
                assert_near((double)found[c], (double)expected[c], 1e-5);
            assert_near((double)found[3], 1, 1e-6);
            colored += opacity > 0;
            plain += opacity == 0;
        }
    assert_true(colored > 300 && plain > 300);
    cw_picture_free(&picture);
    cw_label_table_free(&f.table);
}

/* With several samples a pixel has the mean of theirs, and threads change nothing. */
static void samples_are_averaged(void **state)
{
    (void)state;
    static fixture f;
    make_fixture(&f);
    cw_picture one = paint_slice(&f, 0);
    f.scene.samples = 3;
    f.scene.threads = 1;
    cw_picture fine = paint_slice(&f, 0);
    f.scene.threads = 3;
    cw_picture again = paint_slice(&f, 0);
    assert_memory_equal(fine.pixels, again.pixels, 16 * (size_t)WIDTH * HEIGHT);
    size_t mixed = 0;
    double sums[2] = {0};
    for (size_t n = 0; n < (size_t)WIDTH * HEIGHT; n++) {
        const float red = fine.pixels[4 * n];
        mixed += red > 0.55f && red < 0.95f;
        sums[0] += (double)one.pixels[4 * n];
        sums[1] += (double)red;
    }
    assert_true(mixed > 20); /* along the borders of cells */
    assert_near(sums[0] / sums[1], 1, 0.02);
    cw_picture_free(&one);
    cw_picture_free(&fine);
    cw_picture_free(&again);
    cw_label_table_free(&f.table);
}

static void what_cannot_be_drawn_is_refused(void **state)
{
    (void)state;
    static fixture f;
    cw_error err = {0};
    cw_picture picture, other;
    make_fixture(&f);
    assert_ok(cw_picture_alloc(&picture, WIDTH, HEIGHT, &err), err);
    assert_ok(cw_picture_alloc(&other, WIDTH, HEIGHT + 1, &err), err);
    cw_label_slices labels = {&f.map, &f.table, 0, 0};
    cw_scene scene = f.scene;
    assert_fails(cw_label_slices_draw(&labels, &scene, &other, &err), CW_ERR_ARGUMENT,
                 "a picture of 60 x 41 is not one of this scene", err);
    labels.opacity = 1.5f;
    assert_fails(cw_label_slices_draw(&labels, &scene, &picture, &err), CW_ERR_ARGUMENT,
                 "an opacity of 1.5", err);
    labels.opacity = 0;
    scene.mode = CW_MODE_MIP;
    assert_fails(cw_label_slices_draw(&labels, &scene, &picture, &err), CW_ERR_ARGUMENT,
                 "not in the mode mip", err);
    scene = f.scene;
    f.map.affine[2][3] = 40; /* above the scan */
    assert_fails(cw_label_slices_draw(&labels, &scene, &picture, &err), CW_ERR_ARGUMENT,
                 "the labels do not overlap the volume", err);
    cw_picture_free(&picture);
    cw_picture_free(&other);
    cw_label_table_free(&f.table);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_nearest_voxel_counts),
        cmocka_unit_test(samples_are_averaged),
        cmocka_unit_test(what_cannot_be_drawn_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
