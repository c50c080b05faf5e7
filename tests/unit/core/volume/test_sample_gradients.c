/* Tests the least-squares gradients at the samples of irregular grids: linear fields on paper,
 * central differences on even boxes, samples without a value. */
#include "support/cells.h"

#include "core/base/memory.h"
#include "core/volume/cell_shapes.h"
#include "core/volume/sample_gradients.h"

#include <math.h>
#include <stdlib.h>

static double plane(const double p[3])
{
    return 3 + 2 * p[0] - 0.5 * p[1] + 0.25 * p[2];
}

static double parabola(const double p[3])
{
    return p[0] * p[0] - 2 * p[1] * p[2];
}

/* Gradients of all samples, free of the factor; free them with free(). */
static double (*fit(const test_grid *g, double reach))[3]
{
    cw_error err = {0};
    double factor, (*out)[3] = malloc(g->samples * sizeof *out);
    cw_volume v;
    assert_non_null(out);
    assert_ok(cw_volume_resolve(&g->volume, &v, &err), err);
    const cwi_gradient_fit f = {.volume = &v, .largest = 8, .reach = reach};
    assert_ok(cwi_gradients_fit(&f, g->samples, out, &factor, &err), err);
    for (size_t n = 0; n < g->samples; n++)
        for (int a = 0; a < 3; a++)
            out[n][a] /= factor;
    return out;
}

static void linear_fields_are_exact_in_any_cells(void **state)
{
    (void)state;
    for (int cut = 0; cut < TEST_CUT_COUNT; cut++) {
        test_grid g;
        test_grid_make(&g, (test_cut)cut, 5, 0.2);
        test_grid_fill(&g, plane);
        double(*out)[3] = fit(&g, 2);
        for (size_t n = 0; n < g.samples; n++) {
            assert_near(out[n][0], 2, 1e-11);
            assert_near(out[n][1], -0.5, 1e-11);
            assert_near(out[n][2], 0.25, 1e-11);
        }
        free(out);
        test_grid_free(&g);
    }
}

/* Inner samples of boxes have central differences, whatever the unit. */
static void even_boxes_have_central_differences(void **state)
{
    (void)state;
    for (int n = 0; n < 3; n++) {
        const double unit = (double[]){1, 1e-4, 1e4}[n];
        test_grid g;
        test_grid_make(&g, TEST_HEXAHEDRA, 4, 0);
        test_grid_fill(&g, parabola);
        for (size_t i = 0; i < 3 * g.samples; i++)
            g.points[i] *= unit;
        double(*out)[3] = fit(&g, 2 * unit);
        const size_t middle = (2 * 5 + 2) * 5 + 3, border = (2 * 5 + 2) * 5;
        assert_near(out[middle][0] * unit, 1, 1e-11);
        assert_near(out[middle][1] * unit, 0, 1e-11);
        assert_near(out[border][0] * unit, -1.5, 1e-11); /* one-sided */
        free(out);
        test_grid_free(&g);
    }
}

static void samples_without_value_are_left_out(void **state)
{
    (void)state;
    test_grid g;
    test_grid_make(&g, TEST_HEXAHEDRA, 4, 0);
    test_grid_fill(&g, plane);
    g.values[0] = NAN;
    g.values[124] = -1e9;
    g.volume.has_nodata = true;
    g.volume.nodata = -1e9;
    double(*out)[3] = fit(&g, 2);
    assert_true(out[0][0] == 0 && out[124][1] == 0);
    assert_near(out[1][0], 2, 1e-11); /* by the cells on its other side */
    assert_near(out[62][2], 0.25, 1e-11);
    free(out);
    test_grid_free(&g);
}

static void memory_and_shapes_are_checked(void **state)
{
    (void)state;
    test_grid g;
    cw_error err = {0};
    double out[8][3], factor;
    size_t *starts;
    test_grid_make(&g, TEST_HEXAHEDRA, 1, 0);
    const cwi_gradient_fit f = {.volume = &g.volume, .largest = 1, .reach = 2};
    cwi_alloc_fail_after(0);
    const cw_status fitted = cwi_gradients_fit(&f, 8, out, &factor, &err);
    const cw_status found = cwi_cell_chunks(&g.cells, 16, &starts, &err);
    cwi_alloc_fail_after(-1);
    assert_int_equal(fitted, CW_ERR_NO_MEMORY);
    assert_int_equal(found, CW_ERR_NO_MEMORY);
    g.shapes[0] = 9;
    assert_fails(cwi_cell_chunks(&g.cells, 16, &starts, &err), CW_ERR_ARGUMENT,
                 "cell 0 has shape 9; the last is 3", err);
    test_grid_free(&g);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(linear_fields_are_exact_in_any_cells),
        cmocka_unit_test(even_boxes_have_central_differences),
        cmocka_unit_test(samples_without_value_are_left_out),
        cmocka_unit_test(memory_and_shapes_are_checked),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
