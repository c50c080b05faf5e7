/* The judge is judged: fields and cells whose topology is known on paper. */
#include "core/base/parallel.h"
#include "support/support.h"
#include "support/truth.h"

#include <math.h>
#include <stdlib.h>

enum { SIDE = 14 };

static double distance(const double p[3], double x, double y, double z)
{
    return sqrt((p[0] - x) * (p[0] - x) + (p[1] - y) * (p[1] - y) + (p[2] - z) * (p[2] - z));
}

static double sphere(const double p[3])
{
    return 4.3 - distance(p, 6.4, 6.6, 6.5);
}

static double torus(const double p[3])
{
    return 1.9 - hypot(hypot(p[0] - 6.4, p[1] - 6.6) - 4, p[2] - 6.5);
}

static double two_blobs(const double p[3])
{
    return 2.7 - fmin(distance(p, 3.2, 3.4, 3.3), distance(p, 9.6, 9.3, 9.5));
}

/* A cavity: two surfaces, one inside the other. */
static double shell(const double p[3])
{
    return 1.2 - fabs(4 - distance(p, 6.4, 6.6, 6.5));
}

/* A ball cut by the border is closed there. */
static double half_ball(const double p[3])
{
    return 4.3 - distance(p, 0.2, 6.6, 6.5);
}

static double everything(const double p[3])
{
    return 1 + 0 * p[0];
}

static double nothing(const double p[3])
{
    return -1 + 0 * p[0];
}

static double gyroid(const double p[3])
{
    const double s = 0.55;
    return sin(s * p[0]) * cos(s * p[1]) + sin(s * p[1]) * cos(s * p[2]) +
           sin(s * p[2]) * cos(s * p[0]) + 0.013;
}

static void sample(double (*field)(const double p[3]), float *voxels)
{
    for (size_t n = 0; n < SIDE * SIDE * SIDE; n++) {
        const double p[3] = {(double)(n % SIDE), (double)(n / SIDE % SIDE),
                             (double)(n / SIDE / SIDE)};
        voxels[n] = (float)field(p);
    }
}

static void check(const test_truth *t, const char *what, size_t components, long euler)
{
    if (!t->decidable || t->components != components || t->euler != euler)
        fail_msg("%s: %s, %zu components, Euler number %ld", what,
                 t->decidable ? "decidable" : "undecided", t->components, t->euler);
}

static void fields_known_on_paper_come_out_so(void **state)
{
    (void)state;
    static const struct {
        const char *what;
        double (*field)(const double p[3]);
        size_t components;
        long euler;
    } rows[] = {{"sphere", sphere, 1, 2},         {"torus", torus, 1, 0},
                {"two blobs", two_blobs, 2, 4},   {"shell", shell, 2, 4},
                {"half a ball", half_ball, 1, 2}, {"everything", everything, 1, 2},
                {"nothing", nothing, 0, 0}};
    static float voxels[SIDE * SIDE * SIDE];
    const size_t dim[3] = {SIDE, SIDE, SIDE};
    for (size_t r = 0; r < sizeof rows / sizeof *rows; r++) {
        sample(rows[r].field, voxels);
        const test_truth t = test_topology_of(voxels, dim, 0);
        check(&t, rows[r].what, rows[r].components, rows[r].euler);
    }
}

/* Its Euler number depends on where the box cuts it; both ways must see the same. */
static void a_piece_of_gyroid_has_many_handles(void **state)
{
    (void)state;
    static float voxels[SIDE * SIDE * SIDE];
    const size_t dim[3] = {SIDE, SIDE, SIDE};
    sample(gyroid, voxels);
    const test_truth t = test_topology_of(voxels, dim, 0);
    assert_true(t.decidable);
    assert_int_equal(t.components, 1);
    assert_true(t.euler <= -4);
}

/* Corners x fastest. The numbers are cases of [Chernyaev1995]. */
static void single_cells_have_their_tunnels(void **state)
{
    (void)state;
    static const struct {
        const char *what;
        float v[8];
        size_t components;
        long euler;
    } rows[] = {
        {"4: two corners apart", {1, -1, -1, -1, -1, -1, -1, 1}, 2, 4},
        {"4: joined by a tunnel", {1, -.1f, -.12f, -.1f, -.11f, -.1f, -.1f, 1}, 1, 2},
        {"4: both outside, joined", {-1, .1f, .12f, .1f, .11f, .1f, .1f, -1}, 1, 0},
        {"3: faces keep them apart", {1, -2, -2, 1, -3, -3, -3, -3}, 2, 4},
        {"3: a face joins them", {2, -1, -1, 2, -3, -3, -3, -3}, 1, 2},
        {"10: joined at both ends, apart between",
         {.4f, .4f, -1, -.1f, -.1f, -1, .4f, .4f},
         1,
         0},
        {"10: apart at both ends, joined between",
         {1, .1f, -.4f, -.4f, -.4f, -.4f, .1f, 1},
         1,
         2},
        {"10: joined at one end", {2, .1f, -.4f, -.4f, -.4f, -.4f, 2, .1f}, 1, 2},
        {"10: apart", {.1f, .12f, -.4f, -.4f, -.4f, -.4f, .11f, .1f}, 2, 4},
        {"13: all faces join", {1, -.1f, -.1f, 1, -.1f, 1, 1, -.12f}, 1, 2},
        {"13: all faces part", {.1f, -1, -1, .1f, -1, .1f, .12f, -1}, 4, 8},
    };
    for (size_t r = 0; r < sizeof rows / sizeof *rows; r++) {
        const test_truth t = test_topology_of(rows[r].v, (const size_t[3]){2, 2, 2}, 0);
        check(&t, rows[r].what, rows[r].components, rows[r].euler);
    }
}

typedef struct grid_round {
    float voxels[125];
    bool decidable;
} grid_round;

static void decide_round(void *context, size_t n)
{
    grid_round *r = (grid_round *)context + n;
    r->decidable = test_topology_of(r->voxels, (const size_t[3]){5, 5, 5}, 0).decidable;
}

/* Topology counted on grids without order is seen in pictures; where it cannot be counted,
 * features are thinner than the finest picture. */
static void both_ways_agree_on_nearly_all_random_grids(void **state)
{
    (void)state;
    enum { ROUNDS = 200 };
    static grid_round rounds[ROUNDS];
    int decidable = 0;
    test_seed(11);
    for (int n = 0; n < ROUNDS * 125; n++)
        rounds[n / 125].voxels[n % 125] = 2 * (float)rand() / (float)RAND_MAX - 1;
    cwi_parallel_for_all(ROUNDS, 1 << 20, 0, decide_round, rounds);
    for (int r = 0; r < ROUNDS; r++)
        decidable += rounds[r].decidable;
    assert_true(decidable >= ROUNDS * 97 / 100);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(fields_known_on_paper_come_out_so),
        cmocka_unit_test(a_piece_of_gyroid_has_many_handles),
        cmocka_unit_test(single_cells_have_their_tunnels),
        cmocka_unit_test(both_ways_agree_on_nearly_all_random_grids),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
