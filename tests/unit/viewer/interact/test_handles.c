/* Tests the handles of a box: projection, choice, dragging, and the edges that are drawn. */
#include "support/support.h"

#include "viewer/interact/clip_box_handles.h"

#include <math.h>
#include <string.h>

static const cwi_world_box box = {{-10, -20, -30}, {30, 20, 10}};
static const cwi_world_box bounds = {{-15, -40, -60}, {60, 70, 80}};

static const cwi_handle_view views[] = {
    {{{150, -190, 130}, {1, 2, 3}, {0, 0, 1}, .fov_deg = 30}, 300, 200},
    {{{-120, 170, -155}, {0, 0, 0}, {0.3, -0.2, 1}, .fov_deg = 70}, 200, 300},
    {{{140, -90, 130}, {1, 2, 3}, {0, 0, 2}, .height_mm = 150}, 300, 200},
};

enum { VIEWS = sizeof views / sizeof *views };

static void find_middle(const cwi_world_box *b, int handle, double middle[3])
{
    for (int a = 0; a < 3; a++)
        middle[a] = (b->low[a] + b->high[a]) / 2;
    middle[handle / 2] = handle % 2 ? b->high[handle / 2] : b->low[handle / 2];
}

static double face_of(const cwi_world_box *b, int handle)
{
    return handle % 2 ? b->high[handle / 2] : b->low[handle / 2];
}

static void a_face_goes_to_the_point_under_the_mouse(void **state)
{
    (void)state;
    for (size_t v = 0; v < VIEWS; v++)
        for (int n = 0; n < CWI_HANDLES; n++) {
            cwi_world_box b = box, expected = box;
            double point[3], pixel[2];
            find_middle(&box, n, point);
            point[n / 2] += n % 2 ? 7.25 : 5.5;
            assert_true(cw_camera_project(&views[v].camera, views[v].width, views[v].height,
                                          point, pixel, NULL));
            assert_true(cwi_handles_drag(&views[v], &bounds, 1, n, pixel, &b));
            assert_near(face_of(&b, n), point[n / 2], 1e-9);
            *(n % 2 ? &expected.high[n / 2] : &expected.low[n / 2]) = face_of(&b, n);
            assert_memory_equal(&b, &expected, sizeof b);
        }
}

static void handles_are_where_they_are_projected(void **state)
{
    (void)state;
    for (size_t v = 0; v < VIEWS; v++) {
        cwi_handle handles[CWI_HANDLES];
        cwi_handles_place(&views[v], &box, handles);
        for (int n = 0; n < CWI_HANDLES; n++) {
            const cwi_handle_view *view = &views[v];
            double point[3], pixel[2], depth;
            cwi_world_box b = box;
            find_middle(&box, n, point);
            assert_true(cw_camera_project(&view->camera, view->width, view->height, point,
                                          pixel, &depth));
            assert_true(handles[n].shown && handles[n].depth_mm == depth);
            assert_memory_equal(handles[n].pixel, pixel, sizeof pixel);
            assert_int_equal(cwi_handles_hit(handles, pixel, 0.5), n);
            assert_true(cwi_handles_drag(view, &bounds, 1, n, pixel, &b));
            assert_near(face_of(&b, n), face_of(&box, n), 1e-9);
        }
        assert_int_equal(handles[0].faces_away, views[v].camera.eye[0] > 0);
        assert_int_equal(handles[3].faces_away, views[v].camera.eye[1] < 0);
        assert_int_equal(
            cwi_handles_hit(handles, (const double[2]){handles[0].pixel[0] + 1e4, 0}, 99),
            CWI_HANDLE_NONE);
    }
}

/* Straight on, the handles of front and back lie upon each other. */
static void the_nearer_of_two_handles_is_taken(void **state)
{
    (void)state;
    cwi_handle_view v = {{{10, -500, -10}, {10, 0, -10}, {0, 0, 1}, .fov_deg = 20}, 100, 100};
    for (int side = 0; side < 2; side++) {
        cwi_handle handles[CWI_HANDLES];
        v.camera.eye[1] = side ? 500 : -500;
        cwi_handles_place(&v, &box, handles);
        assert_int_equal(cwi_handles_hit(handles, (const double[2]){51, 50}, 6), 2 + side);
    }
}

/* An axis that points at the eye cannot be followed; near it nothing jumps either. */
static void an_axis_at_the_eye_stands_still(void **state)
{
    (void)state;
    for (int flat = 0; flat < 2; flat++) {
        const cwi_handle_view v = {{{10, -500, -10},
                                    {10, 0, -10},
                                    {0, 0, 1},
                                    .fov_deg = flat ? 0 : 20,
                                    .height_mm = flat ? 100 : 0},
                                   100,
                                   100};
        for (int x = 45; x < 55; x++) {
            cwi_world_box b = box;
            assert_false(
                cwi_handles_drag(&v, &bounds, 1, 2, (const double[2]){x + 0.3, 50}, &b));
            assert_memory_equal(&b, &box, sizeof b);
        }
    }
}

static void faces_stay_in_bounds_and_apart(void **state)
{
    (void)state;
    for (size_t v = 0; v < VIEWS; v++)
        for (int n = 0; n < CWI_HANDLES; n++)
            for (int k = 0; k < 60; k++) {
                cwi_world_box b = box;
                const double pixel[2] = {(double)k * 37 - 900, 1000 - (double)k * 41};
                const int a = n / 2;
                cwi_handles_drag(&views[v], &bounds, 3, n, pixel, &b);
                assert_true(b.low[a] >= bounds.low[a] && b.high[a] <= bounds.high[a]);
                assert_true(b.high[a] - b.low[a] >= 3);
            }
    const cwi_handle_view *v = &views[2];
    double point[3], pixel[2];
    cwi_world_box b = box;
    find_middle(&box, 1, point);
    point[0] = -12;
    cw_camera_project(&v->camera, v->width, v->height, point, pixel, NULL);
    assert_true(cwi_handles_drag(v, &bounds, 3, 1, pixel, &b));
    assert_true(b.high[0] == -7);
    point[0] = 99;
    cw_camera_project(&v->camera, v->width, v->height, point, pixel, NULL);
    assert_true(cwi_handles_drag(v, &bounds, 3, 1, pixel, &b));
    assert_true(b.high[0] == 60);
    assert_true(cwi_handles_drag(v, &bounds, 1000, 1, pixel, &b)); /* more than there is */
    assert_true(b.high[0] == 60);
    assert_false(cwi_handles_drag(v, &bounds, 3, 6, pixel, &b));
    assert_false(cwi_handles_drag(v, &bounds, 3, CWI_HANDLE_NONE, pixel, &b));
}

static bool is_end(const double pixel[2], const cwi_handle_view *v, int corner)
{
    double point[3], at[2];
    for (int a = 0; a < 3; a++)
        point[a] = corner >> a & 1 ? box.high[a] : box.low[a];
    assert_true(cw_camera_project(&v->camera, v->width, v->height, point, at, NULL));
    return hypot(at[0] - pixel[0], at[1] - pixel[1]) < 1e-9;
}

/* Each corner ends three edges; of a box seen from a corner three edges are behind it. */
static void twelve_edges_join_eight_corners(void **state)
{
    (void)state;
    for (size_t v = 0; v < VIEWS; v++) {
        cwi_box_edge edges[CWI_BOX_EDGES];
        int behind = 0, ends[8] = {0};
        cwi_handles_edges(&views[v], &box, edges);
        for (int n = 0; n < CWI_BOX_EDGES; n++) {
            assert_true(edges[n].shown);
            behind += edges[n].is_behind;
            for (int e = 0; e < 2; e++)
                for (int corner = 0; corner < 8; corner++)
                    ends[corner] += is_end(edges[n].pixels[e], &views[v], corner);
        }
        assert_int_equal(behind, 3);
        for (int corner = 0; corner < 8; corner++)
            assert_int_equal(ends[corner], 3);
    }
}

/* With the eye in the box, what is behind the eye is not drawn, and all of it faces away. */
static void an_eye_in_the_box_sees_what_is_before_it(void **state)
{
    (void)state;
    const cwi_handle_view v = {{{0, 0, 0}, {0, 10, 0}, {0, 0, 1}, .fov_deg = 60}, 100, 100};
    cwi_handle handles[CWI_HANDLES];
    cwi_box_edge edges[CWI_BOX_EDGES];
    int shown = 0;
    cwi_handles_place(&v, &box, handles);
    cwi_handles_edges(&v, &box, edges);
    assert_false(handles[2].shown);
    assert_true(handles[3].shown && handles[3].faces_away);
    for (int n = 0; n < CWI_BOX_EDGES; n++) {
        shown += edges[n].shown;
        assert_true(edges[n].is_behind);
        for (int e = 0; e < 2; e++)
            assert_true(isfinite(edges[n].pixels[e][0]) && isfinite(edges[n].pixels[e][1]));
    }
    assert_int_equal(shown, 8);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_face_goes_to_the_point_under_the_mouse),
        cmocka_unit_test(handles_are_where_they_are_projected),
        cmocka_unit_test(the_nearer_of_two_handles_is_taken),
        cmocka_unit_test(an_axis_at_the_eye_stands_still),
        cmocka_unit_test(faces_stay_in_bounds_and_apart),
        cmocka_unit_test(twelve_edges_join_eight_corners),
        cmocka_unit_test(an_eye_in_the_box_sees_what_is_before_it),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
