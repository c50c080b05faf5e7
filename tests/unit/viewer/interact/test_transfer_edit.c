/* Tests edits of transfer functions: points, moves, opacities, colours, and random edits. */
#include "support/support.h"

#include "viewer/interact/transfer_edit.h"

#include <math.h>
#include <string.h>

static const cw_transfer start = {.color_count = 3,
                                  .colors = {{0, {0, 0, 0}}, {50, {1, 0, 0}}, {150, {1, 1, 0}}},
                                  .opacity_count = 4,
                                  .opacities = {{10, 0}, {20, 0.5f}, {20, 0.1f}, {110, 1}},
                                  .gradient_count = 1,
                                  .gradients = {{3, 0.5f}},
                                  .unit_mm = 2};

static const double near_by[2] = {2, 0.05};

static void points_are_found_by_their_neighbourhood(void **state)
{
    (void)state;
    const struct {
        double value, opacity;
        size_t opacity_point, color_point, segment;
    } rows[] = {
        {11, 0.02, 0, CWI_TRANSFER_NONE, 1},
        {20, 0.5, 1, CWI_TRANSFER_NONE, 2},
        {20, 0.1, 2, CWI_TRANSFER_NONE, 3},
        {21, 0.3, CWI_TRANSFER_NONE, CWI_TRANSFER_NONE, 2},
        {65, 0.56, CWI_TRANSFER_NONE, CWI_TRANSFER_NONE, 3},
        {51, 0.4, CWI_TRANSFER_NONE, 1, 3},
        {51, 0.9, CWI_TRANSFER_NONE, 1, CWI_TRANSFER_NONE},
        {-1e9, 0.01, CWI_TRANSFER_NONE, CWI_TRANSFER_NONE, 0},
        {1e9, 0.99, CWI_TRANSFER_NONE, CWI_TRANSFER_NONE, 4},
        {1e9, 0.9, CWI_TRANSFER_NONE, CWI_TRANSFER_NONE, CWI_TRANSFER_NONE},
    };
    for (size_t n = 0; n < sizeof rows / sizeof *rows; n++) {
        const double v = rows[n].value, o = rows[n].opacity;
        assert_int_equal(cwi_transfer_near_opacity(&start, v, o, near_by),
                         rows[n].opacity_point);
        assert_int_equal(cwi_transfer_near_color(&start, v, 2), rows[n].color_point);
        assert_int_equal(cwi_transfer_near_segment(&start, v, o, near_by), rows[n].segment);
    }
    assert_int_equal(cwi_transfer_near_segment(&(cw_transfer){0}, 7, 0.01, near_by), 0);
    assert_int_equal(cwi_transfer_near_segment(&start, NAN, 0, near_by), CWI_TRANSFER_NONE);
}

static void points_stay_between_their_neighbours(void **state)
{
    (void)state;
    cw_transfer t = start;
    cwi_transfer_move_opacity(&t, 1, 5, 0.7);
    assert_true(t.opacities[1].value == 10 && t.opacities[1].opacity == 0.7f);
    cwi_transfer_move_opacity(&t, 1, 500, 7);
    assert_true(t.opacities[1].value == 20 && t.opacities[1].opacity == 1);
    cwi_transfer_move_opacity(&t, 0, -500, -7);
    assert_true(t.opacities[0].value == -500 && t.opacities[0].opacity == 0);
    cwi_transfer_move_opacity(&t, 3, 5000, 0.5);
    assert_true(t.opacities[3].value == 5000);
    cwi_transfer_move_opacity(&t, 3, NAN, 0.5);
    assert_true(t.opacities[3].value == 5000);
    cwi_transfer_move_color(&t, 1, 151);
    assert_true(t.colors[1].value == 150);
    cwi_transfer_move_color(&t, 2, 151);
    assert_true(t.colors[2].value == 151);
    cwi_transfer_move_color(&t, 0, INFINITY);
    assert_true(t.colors[0].value == 0);
}

/* A point put where the line is, colour or opacity, changes no value's look; taken out again,
 * nothing has happened. */
static void points_put_on_the_line_do_not_show(void **state)
{
    (void)state;
    for (double value = -10; value <= 200; value += 5) {
        cw_transfer t = start;
        double color[2][3], opacity[2];
        cw_transfer_at(&start, value, color[0], &opacity[0]);
        const size_t o = cwi_transfer_insert_opacity(&t, value, opacity[0]),
                     c = cwi_transfer_insert_color(&t, value);
        assert_true(t.opacities[o].value == value && t.colors[c].value == value);
        for (double at = -15; at < 205; at += 3.5) {
            cw_transfer_at(&start, at, color[0], &opacity[0]);
            cw_transfer_at(&t, at, color[1], &opacity[1]);
            assert_near(opacity[1], opacity[0], 1e-7);
            for (int n = 0; n < 3; n++)
                assert_near(color[1][n], color[0][n], 1e-7);
        }
        cwi_transfer_remove_opacity(&t, o);
        cwi_transfer_remove_color(&t, c);
        assert_int_equal(t.opacity_count, start.opacity_count);
        assert_memory_equal(t.opacities, start.opacities, 4 * sizeof *t.opacities);
        assert_memory_equal(t.colors, start.colors, 3 * sizeof *t.colors);
    }
    cw_transfer none = {0};
    assert_int_equal(cwi_transfer_insert_color(&none, 3), 0);
    assert_true(none.colors[0].color[1] == 1);
    assert_int_equal(cwi_transfer_insert_opacity(&none, NAN, 0), CWI_TRANSFER_NONE);
}

static void there_are_only_so_many_points(void **state)
{
    (void)state;
    cw_transfer t = {0};
    for (int n = 0; n < CW_TRANSFER_POINTS; n++) {
        assert_true(cwi_transfer_insert_opacity(&t, n * 7 % 64, 0.5) != CWI_TRANSFER_NONE);
        assert_true(cwi_transfer_insert_color(&t, n * 7 % 64) != CWI_TRANSFER_NONE);
    }
    for (int n = 0; n < CW_TRANSFER_POINTS; n++)
        assert_true(t.opacities[n].value == n && t.colors[n].value == n);
    assert_int_equal(cwi_transfer_insert_opacity(&t, 3, 0.5), CWI_TRANSFER_NONE);
    assert_int_equal(cwi_transfer_insert_color(&t, 3), CWI_TRANSFER_NONE);
    assert_int_equal(t.opacity_count, CW_TRANSFER_POINTS);
}

static void wholes_are_moved_and_stretched(void **state)
{
    (void)state;
    cw_transfer t;
    assert_true(cwi_transfer_shift(&start, -15, &t));
    assert_true(t.opacities[0].value == -5 && t.opacities[3].value == 95);
    assert_true(t.colors[0].value == -15 && t.unit_mm == 2 && t.gradients[0].value == 3);
    assert_true(cwi_transfer_scale(&start, 60, 2, &t));
    assert_true(t.opacities[0].value == -40 && t.opacities[3].value == 160);
    assert_true(t.colors[2].value == 240);
    assert_true(cwi_transfer_window(&start, 0, 1, &t));
    assert_true(t.opacities[0].value == 0 && t.opacities[3].value == 1);
    assert_near(t.opacities[1].value, 0.1, 1e-15);
    assert_near(t.colors[2].value, 1.4, 1e-15);
    cw_transfer one = {.opacity_count = 1, .opacities = {{30, 1}}};
    assert_true(cwi_transfer_window(&one, 4, 8, &one));
    assert_true(one.opacities[0].value == 6);
    cw_transfer colors = start;
    colors.opacity_count = 0;
    assert_true(cwi_transfer_window(&colors, 0, 1, &colors));
    assert_true(colors.colors[0].value == 0 && colors.colors[2].value == 1);
}

static void opacities_come_back_from_a_slider(void **state)
{
    (void)state;
    cw_transfer t;
    assert_true(cwi_transfer_fade(&start, 3, &t));
    assert_true(t.opacities[1].opacity == 1 && t.opacities[3].opacity == 1);
    assert_near((double)t.opacities[2].opacity, 0.3, 1e-6);
    assert_true(cwi_transfer_fade(&start, 0, &t));
    assert_true(t.opacities[3].opacity == 0);
    assert_true(cwi_transfer_fade(&start, 1, &t));
    assert_memory_equal(&t, &start, sizeof t);
}

static void colors_turn_round(void **state)
{
    (void)state;
    cw_transfer t;
    assert_true(cwi_transfer_mirror(&start, &t));
    assert_true(t.colors[0].value == 0 && t.colors[1].value == 100 && t.colors[2].value == 150);
    assert_true(t.colors[0].color[1] == 1 && t.colors[2].color[0] == 0);
    assert_true(cwi_transfer_mirror(&t, &t));
    assert_memory_equal(t.colors, start.colors, sizeof t.colors);
    assert_false(cwi_transfer_mirror(&(cw_transfer){0}, &t));
}

static void numbers_that_make_none_leave_the_original(void **state)
{
    (void)state;
    const cw_transfer none = {0};
    cw_transfer t;
    assert_false(cwi_transfer_shift(&start, NAN, &t));
    assert_memory_equal(&t, &start, sizeof t);
    assert_false(cwi_transfer_scale(&start, 0, 0, &t));
    assert_false(cwi_transfer_scale(&start, 0, -1, &t));
    assert_false(cwi_transfer_window(&start, 5, 5, &t));
    assert_false(cwi_transfer_window(&none, 4, 5, &t));
    assert_false(cwi_transfer_fade(&start, -1, &t));
    assert_false(cwi_transfer_fade(&start, INFINITY, &t));
}

/* A generator of one's own gives the same numbers everywhere. */
static uint32_t roll(uint32_t *seed)
{
    *seed = *seed * 1664525u + 1013904223u;
    return *seed >> 8;
}

/* Mostly plain numbers, now and then one at the ends of what there is. */
static double roll_value(uint32_t *seed)
{
    static const double odd[] = {NAN, INFINITY, -INFINITY, 1.7e308, -1.7e308, 5e-324, -0.0};
    const uint32_t die = roll(seed);
    return die % 16 < 7 && die % 5 == 0 ? odd[die % 16 % 7] : (double)roll(seed) / 1e4 - 800;
}

static void edit(cw_transfer *t, uint32_t *seed)
{
    const double a = roll_value(seed), b = roll_value(seed), share = b / 100;
    const uint32_t n = roll(seed);
    cw_transfer before = *t;
    switch (roll(seed) % 11) {
    case 0:
    case 1:
        cwi_transfer_insert_opacity(t, a, share);
        break;
    case 2:
    case 3:
        cwi_transfer_insert_color(t, a);
        break;
    case 4:
        if (t->opacity_count)
            cwi_transfer_remove_opacity(t, n % t->opacity_count);
        break;
    case 5:
        if (t->color_count)
            cwi_transfer_remove_color(t, n % t->color_count);
        break;
    case 6:
        if (t->opacity_count)
            cwi_transfer_move_opacity(t, n % t->opacity_count, a, share);
        if (t->color_count)
            cwi_transfer_move_color(t, n % t->color_count, b);
        break;
    case 7:
        cwi_transfer_shift(&before, a, t);
        break;
    case 8:
        cwi_transfer_scale(t, a, fabs(share), t);
        break;
    case 9:
        cwi_transfer_window(&before, fmin(a, b), fmax(a, b), t);
        break;
    default:
        cwi_transfer_fade(t, share, t);
        cwi_transfer_mirror(t, t);
    }
}

static void all_that_comes_of_edits_is_usable(void **state)
{
    (void)state;
    cw_error err = {0};
    uint32_t seed = 7;
    size_t most = 0, checked = 0;
    for (int run = 0; run < 100; run++) {
        cw_transfer t = run % 2 ? start : (cw_transfer){0};
        for (int n = 0; n < 400; n++, checked++) {
            edit(&t, &seed);
            assert_ok(cw_transfer_check(&t, &err), err);
            const double value = roll_value(&seed);
            const size_t near = cwi_transfer_near_segment(&t, value, 0.5, near_by);
            assert_true(near == CWI_TRANSFER_NONE || near <= t.opacity_count);
            most = t.opacity_count > most ? t.opacity_count : most;
        }
    }
    assert_int_equal(checked, 40000);
    assert_true(most >= 32);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(points_are_found_by_their_neighbourhood),
        cmocka_unit_test(points_stay_between_their_neighbours),
        cmocka_unit_test(points_put_on_the_line_do_not_show),
        cmocka_unit_test(there_are_only_so_many_points),
        cmocka_unit_test(wholes_are_moved_and_stretched),
        cmocka_unit_test(opacities_come_back_from_a_slider),
        cmocka_unit_test(colors_turn_round),
        cmocka_unit_test(numbers_that_make_none_leave_the_original),
        cmocka_unit_test(all_that_comes_of_edits_is_usable),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
