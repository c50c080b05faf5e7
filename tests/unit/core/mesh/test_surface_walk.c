/* Walks over a surface lead to the triangle that is nearest to a point. */
#include "support/surface.h"

#include "core/base/memory.h"
#include "core/mesh/surface_walk.h"

#include <math.h>
#include <stdlib.h>

typedef struct walked {
    cw_mesh mesh;
    uint32_t *first, *around;
    cwi_fans fans;
} walked;

static walked walk_on(const cw_mesh *mesh)
{
    walked w = {.mesh = *mesh,
                .first = cwi_alloc_array(mesh->vertex_count + 2, sizeof *w.first),
                .around = cwi_alloc_array(3 * mesh->triangle_count, sizeof *w.around)};
    cwi_fans_sort(mesh->triangles, mesh->triangle_count, mesh->vertex_count, w.first, w.around);
    w.fans = (cwi_fans){mesh->positions, mesh->triangles, w.first, w.around};
    return w;
}

static void end_walks(walked *w)
{
    cwi_free(w->first);
    cwi_free(w->around);
    cw_mesh_free(&w->mesh);
}

static double random_share(void)
{
    return rand() / (RAND_MAX + 1.0);
}

static double find_least(const walked *w, const double p[3])
{
    const cwi_surface_walk all = {.fans = &w->fans};
    double least = INFINITY;
    for (size_t t = 0; t < w->mesh.triangle_count; t++)
        least = fmin(least, cwi_walk_square(&all, (uint32_t)t, p));
    return least;
}

static void fans_list_every_corner_once(void **state)
{
    (void)state;
    cw_volume v = test_sample(CW_FIELD_SPHERE, 12, CW_F32);
    cw_mesh mesh = test_extract(&v, NULL, NULL);
    walked w = walk_on(&mesh);
    assert_int_equal(w.first[0], 0);
    assert_int_equal(w.first[mesh.vertex_count], 3 * mesh.triangle_count);
    for (size_t x = 0; x < mesh.vertex_count; x++)
        for (uint32_t n = w.first[x]; n < w.first[x + 1]; n++) {
            const uint32_t *c = mesh.triangles + 3 * (size_t)w.around[n];
            assert_true(c[0] == x || c[1] == x || c[2] == x);
            assert_true(n == w.first[x] || w.around[n] > w.around[n - 1]);
        }
    end_walks(&w);
    cw_volume_free(&v);
}

/* On a sphere every step leads nearer. Where walks end on other surfaces may be farther than need
 * be, but is where they say. */
static void walks_find_what_is_near(void **state)
{
    (void)state;
    test_seed(5);
    for (int kind = 0; kind < 2; kind++) {
        cw_volume v = test_sample(kind ? CW_FIELD_GYROID : CW_FIELD_SPHERE, 16, CW_F32);
        cw_mesh mesh = test_extract(&v, NULL, NULL);
        walked w = walk_on(&mesh);
        for (int n = 0; n < 300; n++) {
            const float *x =
                mesh.positions + 3 * (size_t)(random_share() * (double)mesh.vertex_count);
            cwi_surface_walk walk = {
                .fans = &w.fans,
                .at = (uint32_t)(random_share() * (double)mesh.triangle_count)};
            double p[3];
            for (int k = 0; k < 3; k++)
                p[k] = (double)x[k] + 0.2 * (random_share() - 0.5);
            const double square = cwi_walk_to(&walk, p), least = find_least(&w, p);
            assert_true(square == cwi_walk_square(&walk, walk.at, p));
            if (kind == 0 && square > least)
                fail_msg("a walk ended at %g, and %g is nearest", sqrt(square), sqrt(least));
            assert_true(square >= least);
        }
        end_walks(&w);
        cw_volume_free(&v);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(fans_list_every_corner_once),
        cmocka_unit_test(walks_find_what_is_near),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
