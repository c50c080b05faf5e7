/* Checks of irregular grids that were read. */
#ifndef TESTS_GRIDS_H
#define TESTS_GRIDS_H

#include "formats/cells/vtk_cell_types.h"
#include "support/files/reading.h"

#include <math.h>

/* Samples stand at places, and cells have corners that there are. */
static inline void check_grid(const cw_volume *v)
{
    const cw_cells *c = v->cells;
    assert_non_null(c);
    assert_non_null(v->data);
    assert_int_equal(v->dim[1] * v->dim[2] * v->steps, 1);
    for (size_t n = 0; n < 3 * v->dim[0]; n++)
        assert_true(isfinite(c->points[n]));
    const uint32_t *corner = c->corners;
    for (size_t n = 0; n < c->count; n++) {
        assert_true(c->shapes[n] < CW_SHAPE_COUNT);
        for (size_t i = 0; i < cwi_shape_corners((cw_shape)c->shapes[n]); i++)
            assert_true(*corner++ < v->dim[0]);
    }
}

/* Cell n is of that shape, with these corners, of which first are those of cells in front. */
static inline void assert_cell(const cw_volume *v, size_t n, cw_shape shape, size_t first,
                               const uint32_t *corners)
{
    assert_true(n < v->cells->count);
    assert_int_equal(v->cells->shapes[n], shape);
    for (size_t i = 0; i < cwi_shape_corners(shape); i++)
        assert_int_equal(v->cells->corners[first + i], corners[i]);
}

static inline void assert_point(const cw_volume *v, size_t n, double x, double y, double z)
{
    assert_true(n < v->dim[0]);
    assert_true(v->cells->points[3 * n] == x);
    assert_true(v->cells->points[3 * n + 1] == y);
    assert_true(v->cells->points[3 * n + 2] == z);
}

static inline void assert_value(const cw_volume *v, size_t n, double value)
{
    const double got = cw_volume_value(v, n, 0, 0);
    if (!(got == value || (isnan(got) && isnan(value))))
        fail_msg("sample %zu is %g, not %g", n, got, value);
}

/* Notes, one behind the other. */
enum { NOTES = 2000 };

static inline void keep_notes(void *user, const char *text)
{
    const size_t used = strlen(user);
    snprintf((char *)user + used, NOTES - used, "%s\n", text);
}

static inline cw_status read_noted(const char *name, const char *array, char notes[NOTES],
                                   cw_volume *v, cw_error *err)
{
    const cw_read_desc desc = {.array = array, .note = keep_notes, .note_user = notes};
    notes[0] = '\0';
    return cw_volume_read(test_path(name), &desc, v, NULL, err);
}

#endif
