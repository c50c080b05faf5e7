/* Atlases: charts that lie flat, apart, and as large as the surface. */
#include "support/solids.h"
#include "support/texture.h"

#include <cubewright/atlas.h>

#include "core/texture/gather_meshes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Makes an atlas and checks all that is promised of one. */
static cw_atlas_facts check_atlas(cw_mesh *mesh, const cw_atlas_desc *desc)
{
    cw_atlas_facts facts;
    cw_error err = {0};
    size_t covered;
    assert_ok(cw_mesh_atlas(mesh, desc, &facts, &err), err);
    const float(*uv)[2] = test_coordinates(mesh);
    double sum = 0, space = 0;
    for (size_t t = 0; t < mesh->triangle_count; t++) {
        const double area = test_texture_area(uv + 3 * t);
        assert_true(area >= 0);
        sum += area;
        for (int k = 0; k < 6; k++)
            assert_true(uv[3 * t + (size_t)k / 2][k % 2] >= 0 &&
                        uv[3 * t + (size_t)k / 2][k % 2] <= 1);
    }
    const cw_quality q = test_measure(mesh);
    space = q.area_mm2 * facts.texels_per_mm * facts.texels_per_mm / facts.size / facts.size;
    assert_near(sum, space, 1e-3 * space);
    assert_near(facts.coverage, sum, 1e-4 * sum);
    assert_int_equal(test_count_overlaps(mesh, &covered), 0);
    assert_near((double)covered / TEST_PICTURE / TEST_PICTURE, facts.coverage, 0.05);
    assert_true(facts.stretch >= 1 - 1e-6 && facts.stretch < 1.3);
    assert_int_equal(facts.flipped, 0);
    assert_true(facts.charts >= 1 && facts.charts <= mesh->triangle_count);
    return facts;
}

static void ordinary_surfaces_lie_flat(void **state)
{
    (void)state;
    static const struct {
        cw_field field;
        size_t most;  /* charts */
        double least; /* coverage */
    } cases[] = {
        {CW_FIELD_SPHERE, 12, 0.5}, {CW_FIELD_TORUS, 40, 0.45}, {CW_FIELD_GYROID, 400, 0.45}};
    for (size_t n = 0; n < sizeof cases / sizeof *cases; n++) {
        cw_mesh mesh = test_extract_field(cases[n].field, 40);
        const cw_atlas_facts facts = check_atlas(&mesh, NULL);
        assert_true(facts.charts <= cases[n].most);
        assert_true(facts.coverage >= cases[n].least);
        cw_mesh_free(&mesh);
    }
}

static void a_cube_has_at_most_a_chart_for_each_side(void **state)
{
    (void)state;
    cw_mesh cube = test_make_boxes(1);
    test_add_box(&cube, (double[3]){0, 0, 0}, (double[3]){1, 2, 3}, false);
    const cw_atlas_facts facts = check_atlas(&cube, NULL);
    assert_true(facts.charts <= 6);
    assert_near(facts.stretch, 1, 0.2);
    cw_mesh_free(&cube);
}

static void any_unit_gives_the_same(void **state)
{
    (void)state;
    cw_mesh first = test_extract_field(CW_FIELD_TORUS, 32);
    const cw_atlas_facts expected = check_atlas(&first, NULL);
    for (int n = 0; n < 2; n++) {
        cw_mesh mesh = test_extract_field(CW_FIELD_TORUS, 32);
        const float scale = n ? 0x1p14F : 0x1p-14F;
        for (size_t i = 0; i < 3 * mesh.vertex_count; i++)
            mesh.positions[i] *= scale;
        const cw_atlas_facts facts = check_atlas(&mesh, NULL);
        assert_int_equal(facts.charts, expected.charts);
        assert_memory_equal(test_coordinates(&mesh), test_coordinates(&first),
                            3 * mesh.triangle_count * sizeof(float[2]));
        cw_mesh_free(&mesh);
    }
    cw_mesh_free(&first);
}

static void any_number_of_threads_gives_the_same(void **state)
{
    (void)state;
    cw_mesh first = test_extract_field(CW_FIELD_GYROID, 40);
    check_atlas(&first, &(cw_atlas_desc){.threads = 1});
    for (int threads = 2; threads < 6; threads += 3) {
        cw_mesh mesh = test_extract_field(CW_FIELD_GYROID, 40);
        check_atlas(&mesh, &(cw_atlas_desc){.threads = threads});
        assert_memory_equal(test_coordinates(&mesh), test_coordinates(&first),
                            3 * mesh.triangle_count * sizeof(float[2]));
        cw_mesh_free(&mesh);
    }
    cw_mesh_free(&first);
}

/* Adds triangles that no chart likes: without area, doubled, and two more along one edge. */
static cw_mesh make_faulty(void)
{
    static const float points[8][3] = {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {2, 2, 3},
                                       {2, 0, 0}, {1, 1, 1}, {4, 4, 0}, {0, 0, 4}};
    static const uint32_t corners[8][3] = {{0, 1, 2}, {0, 1, 3}, {1, 0, 3}, {0, 4, 1},
                                           {5, 5, 6}, {1, 6, 2}, {0, 1, 7}, {0, 1, 2}};
    cw_mesh mesh = {.vertex_count = 8, .triangle_count = 8};
    mesh.positions = malloc(sizeof points);
    mesh.triangles = malloc(sizeof corners);
    assert_true(mesh.positions && mesh.triangles);
    memcpy(mesh.positions, points, sizeof points);
    memcpy(mesh.triangles, corners, sizeof corners);
    return mesh;
}

static void free_own(cw_mesh *mesh)
{
    free(mesh->positions);
    free(mesh->triangles);
    mesh->positions = NULL;
    mesh->triangles = NULL;
    cw_mesh_free(mesh);
}

static void faulty_meshes_end(void **state)
{
    (void)state;
    cw_mesh mesh = make_faulty();
    check_atlas(&mesh, NULL);
    free_own(&mesh);
}

/* A wheel of needles around one vertex, which is bent so that it does not lie flat as one. */
static void a_wide_fan_ends(void **state)
{
    (void)state;
    const uint32_t count = 20000;
    cw_mesh mesh = {.vertex_count = count + 1, .triangle_count = count};
    mesh.positions = calloc(count + 1, 12);
    mesh.triangles = calloc(count, 12);
    assert_true(mesh.positions && mesh.triangles);
    for (uint32_t n = 0; n < count; n++) {
        const double angle = 2 * PI * n / count;
        float *p = mesh.positions + 3 * (size_t)(n + 1);
        p[0] = (float)cos(angle);
        p[1] = (float)sin(angle);
        p[2] = (float)(n % 2 ? 0.001 : 2);
        mesh.triangles[3 * (size_t)n + 1] = n + 1;
        mesh.triangles[3 * (size_t)n + 2] = (n + 1) % count + 1;
    }
    cw_atlas_facts facts;
    cw_error err = {0};
    assert_ok(cw_mesh_atlas(&mesh, NULL, &facts, &err), err);
    assert_int_equal(facts.flipped, 0);
    free_own(&mesh);
}

/* Texels between charts, by looking around each border of one for others. */
static void charts_have_margins(void **state)
{
    (void)state;
    enum { SIZE = 256, MARGIN = 5 };
    cw_mesh cube = test_make_boxes(3);
    for (int n = 0; n < 3; n++)
        test_add_box(&cube, (double[3]){3 * n, 0, 0}, (double[3]){3 * n + 1, 2, 3}, false);
    check_atlas(&cube, &(cw_atlas_desc){.size = SIZE, .margin = MARGIN});
    const float(*uv)[2] = test_coordinates(&cube);
    const size_t corners = 3 * cube.triangle_count;
    uint32_t *chart = malloc(corners * sizeof *chart);
    assert_non_null(chart);
    for (uint32_t t = 0; t < cube.triangle_count; t++)
        chart[t] = t;
    for (int again = 1;
         again;) { /* triangles that share two points of the texture are of one chart */
        again = 0;
        for (size_t a = 0; a < cube.triangle_count; a++)
            for (size_t b = 0; b < cube.triangle_count; b++) {
                int shared = 0;
                for (int k = 0; k < 9; k++)
                    shared +=
                        memcmp(uv[3 * a + (size_t)k / 3], uv[3 * b + (size_t)k % 3], 8) == 0;
                if (shared >= 2 && chart[a] > chart[b]) {
                    chart[a] = chart[b];
                    again = 1;
                }
            }
    }
    for (size_t a = 0; a < corners; a++)
        for (size_t b = 0; b < corners; b++) {
            if (chart[a / 3] == chart[b / 3])
                continue;
            const double x = fabs((double)uv[a][0] - (double)uv[b][0]) * SIZE,
                         y = fabs((double)uv[a][1] - (double)uv[b][1]) * SIZE;
            assert_true(fmax(x, y) >= MARGIN - 1e-3);
        }
    free(chart);
    cw_mesh_free(&cube);
}

static void a_density_is_kept_or_refused(void **state)
{
    (void)state;
    cw_error err = {0};
    cw_mesh mesh = test_extract_field(CW_FIELD_SPHERE, 32);
    cw_atlas_facts facts = check_atlas(&mesh, NULL);
    const double most = facts.texels_per_mm;
    facts = check_atlas(&mesh, &(cw_atlas_desc){.texels_per_mm = most / 2});
    assert_near(facts.texels_per_mm, most / 2, 1e-12 * most);
    const cw_atlas_desc more = {.texels_per_mm = 2 * most};
    assert_fails(cw_mesh_atlas(&mesh, &more, NULL, &err), CW_ERR_ARGUMENT,
                 "do not fit into 2048 x 2048 texels at this density", err);
    test_coordinates(&mesh); /* those of before */
    const cw_atlas_desc tiny = {.size = 64, .margin = 64};
    assert_fails(cw_mesh_atlas(&mesh, &tiny, NULL, &err), CW_ERR_ARGUMENT, "do not fit", err);
    cw_mesh_free(&mesh);
}

static void wrong_settings_are_named(void **state)
{
    (void)state;
    cw_error err = {0};
    cw_mesh cube = test_make_boxes(1);
    test_add_box(&cube, (double[3]){0, 0, 0}, (double[3]){1, 1, 1}, false);
    static const struct {
        cw_atlas_desc desc;
        const char *words;
    } cases[] = {
        {{.size = 63}, "desc->size 63: expected 64 to 16384"},
        {{.size = 16385}, "desc->size 16385"},
        {{.margin = 65}, "desc->margin 65: expected 1 to 64"},
        {{.texels_per_mm = -1}, "desc->texels_per_mm -1"},
        {{.texels_per_mm = INFINITY}, "desc->texels_per_mm inf"},
        {{.max_stretch = 0.5}, "desc->max_stretch 0.5: expected more than 1"},
        {{.max_stretch = NAN}, "desc->max_stretch"},
    };
    for (size_t n = 0; n < sizeof cases / sizeof *cases; n++)
        assert_fails(cw_mesh_atlas(&cube, &cases[n].desc, NULL, &err), CW_ERR_ARGUMENT,
                     cases[n].words, err);
    assert_fails(cw_mesh_atlas(NULL, NULL, NULL, &err), CW_ERR_ARGUMENT, "mesh", err);
    memset(cube.positions, 0, 3 * cube.vertex_count * sizeof *cube.positions);
    assert_fails(cw_mesh_atlas(&cube, NULL, NULL, &err), CW_ERR_ARGUMENT,
                 "no triangle with an area", err);
    assert_null(cw_mesh_attribute_find(&cube, CW_TEXTURE_COORDINATES));
    cw_mesh_free(&cube);
}

/* After the split each vertex has the coordinate that its corners had, and everything else as before. */
static void seams_split_vertices(void **state)
{
    (void)state;
    cw_error err = {0};
    cw_mesh mesh = test_extract_field(CW_FIELD_TORUS, 32);
    assert_ok(cw_mesh_normals(&mesh, &err), err);
    const cw_atlas_facts facts = check_atlas(&mesh, NULL);
    const size_t corners = 3 * mesh.triangle_count;
    float(*uv)[2] = malloc(corners * sizeof *uv),
    (*places)[6] = malloc(corners * sizeof *places);
    assert_true(uv && places);
    memcpy(uv, test_coordinates(&mesh), corners * sizeof *uv);
    for (size_t c = 0; c < corners; c++) {
        memcpy(places[c], mesh.positions + 3 * (size_t)mesh.triangles[c], 12);
        memcpy(places[c] + 3, mesh.normals + 3 * (size_t)mesh.triangles[c], 12);
    }
    assert_ok(cw_mesh_split_seams(&mesh, &err), err);
    assert_int_equal(mesh.vertex_count, facts.vertices);
    const cw_attribute *split = cw_mesh_attribute_find(&mesh, CW_TEXTURE_COORDINATES);
    assert_true(split && split->on == CW_ON_VERTICES);
    for (size_t c = 0; c < corners; c++) {
        const size_t v = mesh.triangles[c];
        assert_memory_equal((const float *)split->data + 2 * v, uv[c], sizeof uv[c]);
        assert_memory_equal(mesh.positions + 3 * v, places[c], 12);
        assert_memory_equal(mesh.normals + 3 * v, places[c] + 3, 12);
    }
    assert_ok(cw_mesh_split_seams(&mesh, &err), err); /* nothing is left to be split */
    assert_int_equal(mesh.vertex_count, facts.vertices);
    free(uv);
    free(places);
    cw_mesh_free(&mesh);
}

static void it_can_be_cancelled(void **state)
{
    (void)state;
    cw_error err = {0};
    for (long polls = 1; polls < 8; polls += 2) {
        cw_mesh mesh = test_extract_field(CW_FIELD_TORUS, 32);
        long left = polls;
        const cw_atlas_desc desc = {.progress = {test_stop_after, &left}};
        assert_int_equal(cw_mesh_atlas(&mesh, &desc, NULL, &err), CW_ERR_CANCELLED);
        assert_null(cw_mesh_attribute_find(&mesh, CW_TEXTURE_COORDINATES));
        cw_mesh_free(&mesh);
    }
}

/* Returns the area of a mesh's triangles in the texture. */
static double sum_texture(const cw_mesh *mesh)
{
    const float(*uv)[2] = test_coordinates(mesh);
    double sum = 0;
    for (size_t t = 0; t < mesh->triangle_count; t++)
        sum += test_texture_area(uv + 3 * t);
    return sum;
}

static void meshes_share_a_square(void **state)
{
    (void)state;
    const double scales[2] = {1, 0.5}, wrong[2] = {1, 0};
    cw_mesh a = test_extract_field(CW_FIELD_TORUS, 24),
            b = test_extract_field(CW_FIELD_TORUS, 24), all = {0};
    cw_mesh *const list[2] = {&a, &b};
    cw_atlas_facts facts;
    cw_error err = {0};
    assert_fails(cw_meshes_atlas(list, wrong, 2, NULL, NULL, &err), CW_ERR_ARGUMENT,
                 "scales[1] is 0", err);
    assert_fails(cw_meshes_atlas(list, NULL, 0, NULL, NULL, &err), CW_ERR_ARGUMENT,
                 "count is 0", err);
    assert_ok(cw_meshes_atlas(list, scales, 2, &(cw_atlas_desc){.size = 512}, &facts, &err),
              err);
    const double large = sum_texture(&a), small = sum_texture(&b);
    assert_near(small, large / 4, 0.01 * large);
    const cw_quality q = test_measure(&a);
    assert_near(large, q.area_mm2 * pow(facts.texels_per_mm / 512, 2), 0.01 * large);
    const cw_mesh *const both[2] = {&a, &b};
    assert_ok(cwi_gather_meshes(both, NULL, 2, false, true, &all, &err), err);
    size_t covered;
    assert_int_equal(test_count_overlaps(&all, &covered), 0);
    cw_mesh_free(&all);
    cw_mesh_free(&a);
    cw_mesh_free(&b);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(ordinary_surfaces_lie_flat),
        cmocka_unit_test(a_cube_has_at_most_a_chart_for_each_side),
        cmocka_unit_test(any_unit_gives_the_same),
        cmocka_unit_test(any_number_of_threads_gives_the_same),
        cmocka_unit_test(faulty_meshes_end),
        cmocka_unit_test(a_wide_fan_ends),
        cmocka_unit_test(charts_have_margins),
        cmocka_unit_test(a_density_is_kept_or_refused),
        cmocka_unit_test(wrong_settings_are_named),
        cmocka_unit_test(seams_split_vertices),
        cmocka_unit_test(it_can_be_cancelled),
        cmocka_unit_test(meshes_share_a_square),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
