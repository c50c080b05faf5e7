/* Distances to the surface of small random grids, held against a slow look at all of it. */
#include "support/surface.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { EDGE = 5, POINTS = 24, LINES = 12 };

/* A grid, and the nearest point of its surface seen so far. */
typedef struct truth {
    const cw_volume *volume;
    double f[EDGE][EDGE][EDGE]; /* values less the level, z first */
    bool open;
    double p[3], best, nearest[3]; /* world; mm; index */
} truth;

static double uniform(double low, double high)
{
    return low + (high - low) * rand() / RAND_MAX;
}

static void load(truth *t, double level)
{
    for (size_t k = 0; k < EDGE; k++)
        for (size_t j = 0; j < EDGE; j++)
            for (size_t i = 0; i < EDGE; i++)
                t->f[k][j][i] = cw_volume_value(t->volume, i, j, k) - level;
}

static double trilinear(const truth *t, const size_t at[3], const double x[3])
{
    double sum = 0;
    for (size_t n = 0; n < 8; n++) {
        const double w =
            (n & 1 ? x[0] : 1 - x[0]) * (n & 2 ? x[1] : 1 - x[1]) * (n & 4 ? x[2] : 1 - x[2]);
        sum += w * t->f[at[2] + (n >> 2)][at[1] + (n >> 1 & 1)][at[0] + (n & 1)];
    }
    return sum;
}

static void see(truth *t, const size_t at[3], const double x[3])
{
    double world[3], square = 0;
    const double index[3] = {(double)at[0] + x[0], (double)at[1] + x[1], (double)at[2] + x[2]};
    cw_volume_to_world(t->volume, index, world);
    for (int a = 0; a < 3; a++)
        square += (world[a] - t->p[a]) * (world[a] - t->p[a]);
    if (square < t->best * t->best) {
        t->best = sqrt(square);
        memcpy(t->nearest, index, sizeof index);
    }
}

/* The field is linear along lines parallel to the axes: where it vanishes there is exact. Lines
 * are those of a lattice between low and high, coordinates within the cell. */
static void look_along(truth *t, const size_t at[3], int axis, const double low[3],
                       const double high[3], int lines)
{
    const int b = (axis + 1) % 3, c = (axis + 2) % 3;
    for (int n = 0; n <= lines; n++)
        for (int m = 0; m <= lines; m++) {
            double x[3];
            x[b] = low[b] + (high[b] - low[b]) * n / lines;
            x[c] = low[c] + (high[c] - low[c]) * m / lines;
            x[axis] = 0;
            const double f0 = trilinear(t, at, x);
            x[axis] = 1;
            const double f1 = trilinear(t, at, x);
            if ((f0 >= 0) == (f1 >= 0))
                continue;
            x[axis] = f0 / (f0 - f1);
            see(t, at, x);
        }
}

/* Points of a wall of the grid where the field is inside. */
static void look_at_wall(truth *t, const size_t at[3], int axis, double wall,
                         const double low[3], const double high[3], int lines)
{
    const int b = (axis + 1) % 3, c = (axis + 2) % 3;
    for (int n = 0; n <= lines; n++)
        for (int m = 0; m <= lines; m++) {
            double x[3];
            x[axis] = wall;
            x[b] = low[b] + (high[b] - low[b]) * n / lines;
            x[c] = low[c] + (high[c] - low[c]) * m / lines;
            if (trilinear(t, at, x) >= 0)
                see(t, at, x);
        }
}

/* All that a cell has of the surface, within a part of it; false when the cell is not whole. */
static void look_into(truth *t, const size_t at[3], const double low[3], const double high[3],
                      int lines)
{
    const double middle[3] = {0.5, 0.5, 0.5};
    if (isnan(trilinear(t, at, middle)))
        return;
    for (int axis = 0; axis < 3; axis++) {
        look_along(t, at, axis, low, high, lines);
        if (!t->open && at[axis] == 0)
            look_at_wall(t, at, axis, 0, low, high, lines);
        if (!t->open && at[axis] == EDGE - 2)
            look_at_wall(t, at, axis, 1, low, high, lines);
    }
}

static void look_everywhere(truth *t)
{
    const double low[3] = {0, 0, 0}, high[3] = {1, 1, 1};
    size_t at[3];
    for (at[2] = 0; at[2] + 1 < EDGE; at[2]++)
        for (at[1] = 0; at[1] + 1 < EDGE; at[1]++)
            for (at[0] = 0; at[0] + 1 < EDGE; at[0]++)
                look_into(t, at, low, high, LINES);
}

/* Looks ever more closely around the nearest point, in all cells there. */
static void zoom(truth *t)
{
    for (double size = 1.5 / LINES; size > 2e-4; size /= 3) {
        const double around[3] = {t->nearest[0], t->nearest[1], t->nearest[2]};
        for (int n = 0; n < 8; n++) {
            size_t at[3];
            double low[3], high[3];
            bool there = true;
            for (int a = 0; a < 3; a++) {
                const double cell = floor(around[a] + (n >> a & 1 ? size : -size));
                there &= cell >= 0 && cell + 1 < EDGE;
                at[a] = there ? (size_t)cell : 0;
                low[a] = fmax(around[a] - size - cell, 0);
                high[a] = fmin(around[a] + size - cell, 1);
            }
            if (there)
                look_into(t, at, low, high, 10);
        }
    }
}

static cw_volume make_grid(int round)
{
    cw_volume v;
    cw_error err = {0};
    const size_t dim[3] = {EDGE, EDGE, EDGE};
    assert_ok(cw_volume_alloc(&v, CW_F32, dim, 0, 0, &err), err);
    float *x = cw_volume_voxels(&v);
    for (int n = 0; n < EDGE * EDGE * EDGE; n++)
        x[n] = (float)uniform(-1, 1.5);
    test_turn(&v, round);
    for (int r = 0; r < 3; r++) {
        v.affine[r][2] *= round % 2 ? 3 : 1;
        v.affine[r][3] = 100 * r;
    }
    return v;
}

/* Points in and around the grid, as vertices without triangles. */
static cw_mesh make_points(const cw_volume *v, double beyond)
{
    cw_mesh mesh = {.origin = {90, 110, 190}, .vertex_count = POINTS};
    mesh.positions = calloc(POINTS, 3 * sizeof *mesh.positions);
    assert_non_null(mesh.positions);
    for (size_t n = 0; n < POINTS; n++) {
        double index[3], world[3];
        for (int a = 0; a < 3; a++)
            index[a] =
                n % 4 == 0 ? floor(uniform(0, EDGE)) : uniform(-beyond, EDGE - 1 + beyond);
        cw_volume_to_world(v, index, world);
        for (size_t a = 0; a < 3; a++)
            mesh.positions[3 * n + a] = (float)(world[a] - mesh.origin[a]);
    }
    return mesh;
}

/* The slow look sees points of the surface only, so it is never nearer than the truth; and
 * mostly zooms in on the nearest one. */
static void compare(const cw_volume *v, const cw_mesh *mesh, bool open, double level)
{
    float found[POINTS];
    cw_distance out;
    cw_error err = {0};
    const cw_field_distance_desc desc = {
        .isovalue = level, .leave_open = open, .reach_mm = 1000};
    size_t apart = 0;
    truth t = {.volume = v, .open = open};
    load(&t, level);
    assert_ok(cw_distance_to_field(mesh, v, &desc, &out, found, &err), err);
    assert_int_equal(out.missed, 0);
    for (size_t n = 0; n < POINTS; n++) {
        t.best = 1000;
        for (size_t a = 0; a < 3; a++)
            t.p[a] = mesh->origin[a] + (double)mesh->positions[3 * n + a];
        look_everywhere(&t);
        zoom(&t);
        const double d = fabs((double)found[n]);
        if (d > t.best * 1.001 + 1e-5 || d < t.best - 0.1)
            fail_msg("point %zu: %g mm, but there is surface %g mm away", n, d, t.best);
        apart += d < t.best * 0.999 - 2e-3;
    }
    assert_in_range(apart, 0, POINTS / 10);
}

static void compare_random_grids(bool open, bool gaps)
{
    test_seed(18);
    for (int round = 0; round < test_some(12); round++) {
        cw_volume v = make_grid(round);
        float *x = cw_volume_voxels(&v);
        if (gaps)
            x[rand() % 125] = x[62] = (float)NAN;
        cw_mesh mesh = make_points(&v, 1.5);
        compare(&v, &mesh, open, 0.1);
        cw_mesh_free(&mesh);
        cw_volume_free(&v);
    }
}

static void the_nearest_point_of_a_random_surface_is_found(void **state)
{
    (void)state;
    compare_random_grids(true, false);
}

static void the_end_of_the_data_is_surface_where_it_is_inside(void **state)
{
    (void)state;
    compare_random_grids(false, false);
}

static void cells_with_a_missing_voxel_have_no_surface_when_open(void **state)
{
    (void)state;
    compare_random_grids(true, true);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_nearest_point_of_a_random_surface_is_found),
        cmocka_unit_test(the_end_of_the_data_is_surface_where_it_is_inside),
        cmocka_unit_test(cells_with_a_missing_voxel_have_no_surface_when_open),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
