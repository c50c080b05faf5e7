/* Tests that crossings are found where vertices are tangled on purpose: the result is that of a
 * search among all triangles. */
#include "support/support.h"

#include "core/geometry/affine.h"
#include "core/volume/volume.h"
#include "extract/labels/extract_labels.h"
#include "extract/labels/label_cubes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The places of tangled vertices, and the fraction of vertices to tangle. */
static float *tangled;
static double fraction;

/* Moves vertices to anywhere in their cubes. */
static cw_status tangle_vertices(void *context, cwi_label_net *net, const float *originals,
                                 float *spare, cw_label_surfaces *surfaces,
                                 const cw_labels_desc *desc, const size_t dim[3], cw_error *err)
{
    (void)context, (void)spare, (void)desc, (void)dim, (void)err;
    const size_t count = surfaces->mesh.vertex_count;
    tangled = malloc((3 * count + 1) * sizeof *tangled);
    assert_non_null(tangled);
    for (size_t n = 0; n < 3 * count; n++) {
        const bool stays = net->kinds[n / 3] & CWI_NET_FIXED;
        const double by = 0.998 * (rand() / (double)RAND_MAX - 0.5);
        const bool moves = rand() < fraction * RAND_MAX;
        tangled[n] = originals[n] + (float)(stays || !moves ? 0 : by);
        surfaces->mesh.positions[n] = tangled[n];
    }
    return CW_OK;
}

static const cwi_label_smoother tangler = {tangle_vertices, NULL};

/* Puts tangled places into the world, and all vertices of triangles that cross back to where they
 * are without smoothing, until none cross. Returns the number that were put back. */
static size_t untangle_all(cw_mesh *mesh, const cw_volume *v)
{
    size_t back = 0;
    cw_crossings crossings = {0};
    cw_error err = {0};
    float *originals = malloc(mesh->vertex_count * 3 * sizeof *originals);
    assert_non_null(originals);
    memcpy(originals, mesh->positions, mesh->vertex_count * 3 * sizeof *originals);
    for (size_t n = 0; n < mesh->vertex_count; n++) {
        const float *p = tangled + 3 * n;
        double at[3], world[3];
        for (int a = 0; a < 3; a++) {
            const double low = floor((double)p[a]);
            at[a] = cwi_grid_coordinate(v, a, (ptrdiff_t)low, (double)p[a] - low);
        }
        cwi_affine_apply(v->affine[0], at, world);
        for (int a = 0; a < 3; a++)
            mesh->positions[3 * n + (size_t)a] = (float)(world[a] - mesh->origin[a]);
    }
    do {
        cw_crossings_free(&crossings);
        assert_ok(
            cw_self_intersections(mesh, &(cw_crossings_desc){.threads = 1}, &crossings, &err),
            err);
        for (size_t n = 0; n < 6 * crossings.count; n++) {
            const size_t at =
                3 * (size_t)mesh->triangles[3 * (size_t)crossings.pairs[n / 3] + n % 3];
            back += memcmp(mesh->positions + at, originals + at, 12) != 0;
            memcpy(mesh->positions + at, originals + at, 12);
        }
    } while (crossings.count > 0);
    cw_crossings_free(&crossings);
    free(originals);
    return back;
}

/* Fills a map with labels that run along rows, or with noise. */
static void fill_map(uint32_t *to, const size_t dim[3], int n)
{
    const uint32_t labels = (uint32_t[]){2, 3, 5, 50}[n % 4];
    const size_t plane = dim[0] * dim[1];
    for (size_t i = 0; i < plane * dim[2]; i++) {
        const size_t steps[3] = {1, dim[0], plane}, step = steps[rand() % 3];
        const bool follows = n % 5 && i >= step && rand() % 16;
        to[i] = follows ? to[i - step] : (uint32_t)rand() % labels;
    }
}

static void tangles_are_found_as_among_all(void **state)
{
    (void)state;
    size_t back = 0, moved = 0;
    test_seed(11);
    for (int n = 0; n < test_some(400); n++) {
        cw_volume v = {0};
        cw_label_surfaces s, plain;
        cw_error err = {0};
        size_t dim[3];
        for (int a = 0; a < 3; a++)
            dim[a] = 3 + (size_t)(rand() % 14);
        assert_ok(cw_volume_alloc(&v, CW_U32, dim, 1, 1, &err), err);
        for (int a = 0; a < 9; a++) /* from mirrored to sheared */
            v.affine[a / 3][a % 3] = (a % 4   ? 0.4
                                      : n % 2 ? 1
                                              : -2) *
                                     (0.2 + rand() / (double)RAND_MAX);
        double uneven[3][17];
        for (int a = 0; a < 3 && n % 3 == 1; a++) {
            for (size_t i = 0; i < dim[a]; i++)
                uneven[a][i] = (i > 0 ? uneven[a][i - 1] : 0) + 0.1 + rand() / (double)RAND_MAX;
            v.coordinates[a] = uneven[a];
        }
        fill_map(cw_volume_voxels(&v), dim, n);
        fraction = (double[]){0.02, 0.1, 0.4, 1}[(n + n / 4) % 4];
        const cw_labels_desc desc = {.threads = 1 + n % 2, .leave_open = n % 3 == 0};
        assert_ok(cwi_extract_labels_with(&v, &desc, &tangler, &s, &err), err);
        assert_ok(cw_extract_labels(
                      &v, &(cw_labels_desc){.no_smoothing = true, .leave_open = n % 3 == 0},
                      &plain, &err),
                  err);
        assert_int_equal(s.mesh.vertex_count, plain.mesh.vertex_count);
        for (size_t i = 0; i < 3 * plain.mesh.vertex_count; i++)
            moved += s.mesh.positions[i] != plain.mesh.positions[i];
        memcpy(plain.mesh.triangles, s.mesh.triangles, 12 * s.mesh.triangle_count);
        back += untangle_all(&plain.mesh, &v);
        assert_memory_equal(s.mesh.positions, plain.mesh.positions, 12 * s.mesh.vertex_count);
        free(tangled);
        tangled = NULL;
        cw_label_surfaces_free(&s);
        cw_label_surfaces_free(&plain);
        memset(v.coordinates, 0, sizeof v.coordinates);
        cw_volume_free(&v);
    }
    assert_true(back > (size_t)test_some(100) && moved > (size_t)test_some(100));
    print_message("%zu vertices were put back, %zu numbers stay moved\n", back, moved);
}

/* Counts changes of labels around a face of a cube. */
static int count_changes(const uint32_t labels[8], int axis, int side)
{
    const int u = 1 << (axis + 1) % 3, v = 1 << (axis + 2) % 3, low = side << axis;
    const int ring[4] = {low, low | u, low | u | v, low | v};
    int changes = 0;
    for (int n = 0; n < 4; n++)
        changes += labels[ring[n]] != labels[ring[(n + 1) % 4]];
    return changes;
}

/* Checks all ways to label 8 voxels: a cube with one vertex has two labels, or a face on which
 * three meet. Returns the number of cubes with one vertex. */
static size_t check_cubes(const cwi_label_rules *rules, uint32_t labels[8], int n,
                          uint32_t count)
{
    size_t simple = 0;
    bool is_curve = false;
    for (uint32_t label = 0; label <= count && n < 8; label++) {
        labels[n] = label;
        simple += check_cubes(rules, labels, n + 1, label == count ? count + 1 : count);
    }
    if (n < 8 || cwi_label_cube(rules, labels) != CWI_CUBE_SIMPLE)
        return simple;
    for (int face = 0; face < 6; face++)
        is_curve = is_curve || count_changes(labels, face / 2, face % 2) > 2;
    assert_true(is_curve == (count > 2));
    return 1;
}

/* Threads add to the directions of vertices that are in one patch. */
static void vertices_off_curves_are_in_one_patch(void **state)
{
    (void)state;
    cwi_label_rules rules;
    uint32_t labels[8];
    cwi_label_rules_make(&rules);
    assert_int_equal(check_cubes(&rules, labels, 0, 0), 893);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(tangles_are_found_as_among_all),
                                       cmocka_unit_test(vertices_off_curves_are_in_one_patch)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
