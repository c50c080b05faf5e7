/* Meshes parted into solids, each with its cavities. */
#include "support/solids.h"
#include "support/surface.h"

#include "core/base/memory.h"
#include "core/mesh/mesh.h"

#include <string.h>

static void add_cube(cw_mesh *mesh, double at, double half, bool inward)
{
    const double low[3] = {at - half, -half, -half}, high[3] = {at + half, half, half};
    test_add_box(mesh, low, high, inward);
}

static cw_quality measure(const cw_mesh *mesh)
{
    cw_quality q;
    cw_error err = {0};
    assert_ok(cw_quality_measure(mesh, NULL, &q, &err), err);
    return q;
}

/* The order of the file decides nothing. */
static void cavities_go_with_the_solid_around_them(void **state)
{
    (void)state;
    cw_mesh mesh = test_make_boxes(8), *solids;
    cw_error err = {0};
    size_t count;
    add_cube(&mesh, 3, 1, true);  /* in the island */
    add_cube(&mesh, 20, 2, true); /* of the second solid, two of them */
    add_cube(&mesh, 24.5, 1, true);
    add_cube(&mesh, 0, 5, false); /* an island in the cavity of the first */
    add_cube(&mesh, 0, 8, true);
    add_cube(&mesh, 0, 10, false);
    add_cube(&mesh, 20, 6, false);
    add_cube(&mesh, 40, 1, true); /* around which there is nothing */
    assert_ok(cw_mesh_split(&mesh, &solids, &count, &err), err);
    assert_int_equal(count, 4);
    static const double volumes[] = {8000 - 4096, 1728 - 64 - 8, 1000 - 8, -8};
    static const size_t triangles[] = {24, 36, 24, 12};
    for (size_t n = 0; n < count; n++) {
        assert_int_equal(solids[n].triangle_count, triangles[n]);
        assert_near(measure(&solids[n]).volume_mm3, volumes[n], 1e-9);
    }
    cw_meshes_free(solids, count);
    cw_mesh_free(&mesh);
}

/* Cavities exactly in the middle: rays from them meet edges and corners. */
static void rays_through_edges_find_the_solid(void **state)
{
    (void)state;
    cw_mesh mesh = test_make_boxes(8), *solids;
    cw_error err = {0};
    size_t count;
    for (int n = 1; n < 6; n++)
        add_cube(&mesh, 0, n, n % 2 == 0);
    assert_ok(cw_mesh_split(&mesh, &solids, &count, &err), err);
    assert_int_equal(count, 3);
    assert_near(measure(&solids[0]).volume_mm3, 1000 - 512, 1e-9);
    assert_near(measure(&solids[1]).volume_mm3, 216 - 64, 1e-9);
    assert_near(measure(&solids[2]).volume_mm3, 8, 1e-9);
    cw_meshes_free(solids, count);
    cw_mesh_free(&mesh);
}

/* Triangles whose corners are apart, as in files with normals of facets, and open pieces. */
static void equal_places_join_and_attributes_stay(void **state)
{
    (void)state;
    cw_mesh cube, soup, *solids;
    cw_error err = {0};
    size_t count;
    test_make_cube(&cube);
    const size_t corners = 3 * cube.triangle_count;
    assert_ok(cwi_mesh_alloc(&soup, 2 * corners + 3, 2 * cube.triangle_count + 1, false, &err),
              err);
    soup.scalars = cwi_alloc_zeroed(soup.vertex_count, sizeof *soup.scalars);
    for (size_t c = 0; c < 2 * corners; c++) {
        const uint32_t v = cube.triangles[c % corners];
        for (size_t a = 0; a < 3; a++)
            soup.positions[3 * c + a] =
                cube.positions[3 * (size_t)v + a] * (c < corners ? 1 : 2) +
                (c < corners ? 0 : 9);
        soup.scalars[c] = (float)c;
    }
    const float flat[9] = {50, 0, 0, 60, 0, 0, 50, 10, 0};
    memcpy(soup.positions + 6 * corners, flat, sizeof flat);
    for (size_t c = 0; c < soup.vertex_count; c++)
        soup.triangles[c] = (uint32_t)c;
    soup.origin[2] = 7;
    cw_attribute *row;
    const cw_attribute like = {"piece", CW_ON_TRIANGLES,        CW_U8,
                               1,       CW_INTERPOLATE_NEAREST, NULL};
    assert_ok(cw_mesh_attribute_add(&soup, &like, &row, &err), err);
    for (size_t t = 0; t < soup.triangle_count; t++)
        ((uint8_t *)row->data)[t] = (uint8_t)(t / cube.triangle_count);
    assert_ok(cw_mesh_split(&soup, &solids, &count, &err), err);
    assert_int_equal(count, 3);
    static const uint8_t piece[] = {1, 0, 2};
    static const float first[] = {36, 0, 0};
    for (size_t n = 0; n < 3; n++) {
        row = cw_mesh_attribute_find(&solids[n], "piece");
        assert_int_equal(((uint8_t *)row->data)[0], piece[n]);
        assert_true(solids[n].scalars[0] == first[n] && solids[n].origin[2] == 7);
        assert_int_equal(solids[n].vertex_count, 3 * solids[n].triangle_count);
    }
    cw_meshes_free(solids, count);
    cw_mesh_free(&soup);
    cw_mesh_free(&cube);
}

static void nothing_is_left_behind_when_memory_is_out(void **state)
{
    (void)state;
    cw_mesh mesh = test_make_boxes(8), *solids = NULL;
    cw_error err = {0};
    size_t count;
    add_cube(&mesh, 0, 2, false);
    add_cube(&mesh, 0, 1, true);
    add_cube(&mesh, 9, 1, false);
    for (long n = 0;; n++) {
        cwi_alloc_fail_after(n);
        const cw_status st = cw_mesh_split(&mesh, &solids, &count, &err);
        if (!cwi_alloc_fail_after(-1))
            break;
        assert_int_equal(st, CW_ERR_NO_MEMORY);
        assert_true(!solids && count == 0 && n < 60);
    }
    assert_int_equal(count, 2);
    cw_meshes_free(solids, count);
    cw_mesh_free(&mesh);
    assert_ok(cw_mesh_split(&mesh, &solids, &count, &err), err);
    assert_int_equal(count, 0);
    cw_meshes_free(solids, count);
    assert_int_equal(cw_mesh_split(NULL, &solids, &count, &err), CW_ERR_ARGUMENT);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(cavities_go_with_the_solid_around_them),
        cmocka_unit_test(rays_through_edges_find_the_solid),
        cmocka_unit_test(equal_places_join_and_attributes_stay),
        cmocka_unit_test(nothing_is_left_behind_when_memory_is_out),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
