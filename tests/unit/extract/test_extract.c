/* Surfaces whose truth is known on paper, and properties that hold on any input. */
#include "support/surface.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static void world_point(const cw_mesh *mesh, size_t v, double p[3])
{
    for (size_t a = 0; a < 3; a++)
        p[a] = mesh->origin[a] + (double)mesh->positions[3 * v + a];
}

/* The outward normal of the field at a point, where the inside is high. */
static void true_normal(cw_field field, const double at[3], double n[3])
{
    double length = 0;
    for (int a = 0; a < 3; a++) {
        double p[3] = {at[0], at[1], at[2]};
        p[a] = at[a] - 1e-4;
        n[a] = cw_field_value(field, p);
        p[a] = at[a] + 1e-4;
        n[a] -= cw_field_value(field, p);
        length += n[a] * n[a];
    }
    for (int a = 0; a < 3; a++)
        n[a] /= sqrt(length);
}

/* Largest distance of a vertex from the surface of a field that is a distance, and largest
 * angle (radians) of its normal to the truth. */
static void largest_errors(cw_field field, const cw_mesh *mesh, double *distance, double *angle)
{
    *distance = *angle = 0;
    for (size_t v = 0; v < mesh->vertex_count; v++) {
        const float *n = mesh->normals + 3 * v;
        double p[3], t[3];
        world_point(mesh, v, p);
        true_normal(field, p, t);
        const double d = hypot(hypot(t[0] - n[0], t[1] - n[1]), t[2] - n[2]);
        *distance = fmax(*distance, fabs(cw_field_value(field, p)));
        *angle = fmax(*angle, 2 * asin(d / 2));
    }
}

static void sphere_is_closed_round_and_full(void **state)
{
    (void)state;
    cw_volume v = test_sample(CW_FIELD_SPHERE, 64, CW_F32);
    cw_extract_counts counts;
    cw_mesh mesh = test_extract(&v, NULL, &counts);
    const cw_quality q = test_check_promise(&mesh, false);
    double distance, angle;
    assert_int_equal(q.euler, 2);
    assert_int_equal(q.components, 1);
    assert_int_equal(counts.border_loops, 0);
    assert_within(q.volume_mm3, 4.0 / 3 * PI * 30 * 30 * 30, 0.002);
    assert_within(q.area_mm2, 4 * PI * 30 * 30, 0.002);
    largest_errors(CW_FIELD_SPHERE, &mesh, &distance, &angle);
    assert_true(distance < 0.0075); /* mm; a voxel is 1.27 */
    assert_true(angle < 0.05 * PI / 180);
    cw_mesh_free(&mesh);
    cw_volume_free(&v);
}

/* Half the spacing, a quarter of the error: the order is the logarithm of their ratio. */
static void positions_and_normals_converge_with_second_order(void **state)
{
    (void)state;
    static const struct {
        cw_field field;
        double volume_mm3;
    } rows[] = {{CW_FIELD_SPHERE, 4.0 / 3 * PI * 27000}, {CW_FIELD_TORUS, 2 * PI * PI * 2600}};
    for (size_t r = 0; r < sizeof rows / sizeof *rows; r++) {
        double distance[3], angle[3], missing[3];
        for (int n = 0; n < 3; n++) {
            cw_volume v = test_sample(rows[r].field, (size_t)32 << n, CW_F64);
            cw_mesh mesh = test_extract(&v, NULL, NULL);
            largest_errors(rows[r].field, &mesh, &distance[n], &angle[n]);
            missing[n] = fabs(rows[r].volume_mm3 - test_check_promise(&mesh, false).volume_mm3);
            cw_mesh_free(&mesh);
            cw_volume_free(&v);
        }
        for (int n = 0; n < 2; n++) {
            assert_true(log2(distance[n] / distance[n + 1]) > 1.9);
            assert_true(log2(angle[n] / angle[n + 1]) > 1.9);
            assert_true(log2(missing[n] / missing[n + 1]) > 1.9);
        }
    }
}

/* Mean distance of the vertices from the surface of a field that is a distance, and mean angle
 * of their normals to the truth. */
static void mean_errors(cw_field field, size_t n, bool cubic, double *distance, double *angle)
{
    cw_volume v = test_sample(field, n, CW_F64);
    cw_mesh mesh = test_extract(&v, &(cw_extract_desc){.cubic_placement = cubic}, NULL);
    test_check_promise(&mesh, false);
    *distance = *angle = 0;
    for (size_t i = 0; i < mesh.vertex_count; i++) {
        const float *normal = mesh.normals + 3 * i;
        double p[3], t[3];
        world_point(&mesh, i, p);
        true_normal(field, p, t);
        *distance += fabs(cw_field_value(field, p)) / (double)mesh.vertex_count;
        *angle += hypot(hypot(t[0] - normal[0], t[1] - normal[1]), t[2] - normal[2]) /
                  (double)mesh.vertex_count;
    }
    cw_mesh_free(&mesh);
    cw_volume_free(&v);
}

/* Positions of fourth order, down to what floats and the nudge can tell. */
static void cubics_are_far_closer_and_of_higher_order(void **state)
{
    (void)state;
    static const cw_field fields[] = {CW_FIELD_SPHERE, CW_FIELD_TORUS};
    for (size_t f = 0; f < 2; f++) {
        double distance[2], angle[2], linear_distance, linear_angle;
        for (int n = 0; n < 2; n++)
            mean_errors(fields[f], (size_t)32 << n, true, &distance[n], &angle[n]);
        mean_errors(fields[f], 64, false, &linear_distance, &linear_angle);
        assert_true(distance[1] < linear_distance / 100);
        assert_true(angle[1] < linear_angle / 10);
        assert_true(log2(distance[0] / distance[1]) > 3.5);
        assert_true(log2(angle[0] / angle[1]) > 3);
    }
}

/* Every fourth sample along each axis: a sphere still, as near as a grid four times as wide
 * makes it. */
static void a_coarse_sphere_is_near_the_sphere(void **state)
{
    (void)state;
    const size_t step[3] = {4, 4, 4};
    cw_volume v = test_sample(CW_FIELD_SPHERE, 65, CW_F32), coarse;
    cw_error err = {0};
    double distance, angle, spacing[3];
    assert_ok(cw_volume_coarsen(&v, step, &coarse, &err), err);
    cw_volume_spacing(&coarse, spacing);
    cw_mesh mesh = test_extract(&coarse, NULL, NULL);
    const cw_quality q = test_check_promise(&mesh, false);
    assert_int_equal(q.euler, 2);
    assert_within(q.volume_mm3, 4.0 / 3 * PI * 30 * 30 * 30, 0.05);
    largest_errors(CW_FIELD_SPHERE, &mesh, &distance, &angle);
    assert_near(spacing[0], 5, 1e-9);
    assert_true(distance < spacing[0] * spacing[0] / (4 * 30)); /* curvature is 1 / 30 mm */
    cw_mesh_free(&mesh);
    cw_volume_free(&v);
}

/* Voxels that stand apart give the bytes of the same voxels side by side, for every type. */
static void a_coarse_view_is_as_good_as_its_copy(void **state)
{
    (void)state;
    const size_t step[3] = {2, 4, 3};
    for (int type = 0; type < CW_TYPE_COUNT; type++) {
        cw_volume v = test_sample(CW_FIELD_GYROID, 70, (cw_type)type), coarse, copy;
        const cw_extract_desc desc = {.isovalue =
                                          cw_field_stored(CW_FIELD_GYROID, (cw_type)type, 0)};
        cw_error err = {0};
        test_turn(&v, type);
        assert_ok(cw_volume_coarsen(&v, step, &coarse, &err), err);
        assert_ok(cw_volume_alloc(&copy, v.type, coarse.dim, 1, 1, &err), err);
        memcpy(copy.affine, coarse.affine, sizeof copy.affine);
        for (size_t n = 0; n < copy.dim[0] * copy.dim[1] * copy.dim[2]; n++) {
            const size_t i = n % copy.dim[0], j = n / copy.dim[0] % copy.dim[1];
            const size_t k = n / copy.dim[0] / copy.dim[1], size = cw_type_size(v.type);
            memcpy((char *)cw_volume_voxels(&copy) + n * size,
                   (const char *)v.data + ((3 * k * 70 + 4 * j) * 70 + 2 * i) * size, size);
        }
        cw_mesh apart = test_extract(&coarse, &desc, NULL);
        cw_mesh packed = test_extract(&copy, &desc, NULL);
        assert_true(apart.triangle_count > 0);
        test_assert_same_mesh(&apart, &packed);
        cw_mesh_free(&apart);
        cw_mesh_free(&packed);
        cw_volume_free(&copy);
        cw_volume_free(&v);
    }
}

static void torus_has_one_handle(void **state)
{
    (void)state;
    cw_volume v = test_sample(CW_FIELD_TORUS, 64, CW_F32);
    cw_mesh mesh = test_extract(&v, NULL, NULL);
    const cw_quality q = test_check_promise(&mesh, false);
    assert_int_equal(q.euler, 0);
    assert_int_equal(q.components, 1);
    assert_within(q.volume_mm3, 2 * PI * PI * 26 * 100, 0.005);
    cw_mesh_free(&mesh);
    cw_volume_free(&v);
}

/* A linear field is its own trilinear interpolant: vertices on the plane, normals its own. */
static void plane_is_exact(void **state)
{
    (void)state;
    cw_volume v = test_sample(CW_FIELD_PLANE, 33, CW_F64);
    cw_extract_counts counts;
    cw_mesh mesh =
        test_extract(&v, &(cw_extract_desc){.isovalue = 1.7, .leave_open = true}, &counts);
    const cw_quality q = test_check_promise(&mesh, true);
    assert_true(q.open_edges > 0);
    assert_int_equal(q.euler, 1); /* a disc */
    assert_int_equal(counts.border_loops, 1);
    for (size_t i = 0; i < mesh.vertex_count; i++) {
        double p[3];
        world_point(&mesh, i, p);
        /* as far as an edge's ends are kept free: 1/1024 voxel of 2.5 mm */
        assert_near(cw_field_value(CW_FIELD_PLANE, p), 1.7, 2.5 / 1024);
        for (size_t a = 0; a < 3; a++) /* inside is high: outward is down the gradient */
            assert_near(mesh.normals[3 * i + a], -(double)(a + 1) / sqrt(14), 1e-6);
    }
    cw_mesh_free(&mesh);
    mesh = test_extract(&v, &(cw_extract_desc){.isovalue = 1.7}, &counts);
    assert_int_equal(test_check_promise(&mesh, false).euler, 2); /* half the box, capped */
    assert_int_equal(counts.border_loops, 1);
    cw_mesh_free(&mesh);
    cw_volume_free(&v);
}

/* The gyroid splits space in two halves alike, so inside and outside fill half the box each. */
static void gyroid_parts_the_box_in_half(void **state)
{
    (void)state;
    cw_volume v = test_sample(CW_FIELD_GYROID, 81, CW_F32);
    cw_mesh above = test_extract(&v, NULL, NULL);
    cw_mesh below = test_extract(&v, &(cw_extract_desc){.inside_is_low = true}, NULL);
    const cw_quality a = test_check_promise(&above, false),
                     b = test_check_promise(&below, false);
    assert_true(a.euler < -80);
    assert_within(a.volume_mm3 + b.volume_mm3, 512000, 0.001);
    assert_within(a.volume_mm3, 256000, 0.01);
    cw_mesh_free(&above);
    cw_mesh_free(&below);
    cw_volume_free(&v);
}

static void all_eight_types_give_the_sphere(void **state)
{
    (void)state;
    for (int type = 0; type < CW_TYPE_COUNT; type++) {
        cw_volume v = test_sample(CW_FIELD_SPHERE, 48, (cw_type)type);
        const cw_extract_desc d = {.isovalue =
                                       cw_field_stored(CW_FIELD_SPHERE, (cw_type)type, 0)};
        cw_mesh mesh = test_extract(&v, &d, NULL);
        const cw_quality q = test_check_promise(&mesh, false);
        assert_int_equal(q.euler, 2);
        assert_within(q.volume_mm3, 4.0 / 3 * PI * 27000, 0.005);
        cw_mesh_free(&mesh);
        cw_volume_free(&v);
    }
}

/* Samples on the isovalue are normal: whole numbers from -2 to 2, half of the grids closed. */
static void integer_noise_stays_manifold(void **state)
{
    (void)state;
    test_seed(7);
    for (int round = 0; round < 400; round++) {
        int8_t voxels[6 * 5 * 7];
        for (size_t n = 0; n < sizeof voxels; n++)
            voxels[n] = (int8_t)(rand() % 5 - 2);
        const cw_volume v = {.data = voxels, .type = CW_I8, .dim = {6, 5, 7}};
        const cw_extract_desc d = {.leave_open = round & 1, .inside_is_low = round & 2};
        cw_mesh mesh = test_extract(&v, &d, NULL);
        test_check_promise(&mesh, d.leave_open);
        cw_mesh_free(&mesh);
    }
}

/* Rows of every length around a word of bits, with every cell crossed. */
static void checkerboards_of_any_width_stay_manifold(void **state)
{
    (void)state;
    for (size_t n = 2; n <= 131; n += n < 60 ? 7 : 1) {
        uint8_t *voxels = malloc(n * 4);
        const cw_volume v = {.data = voxels, .dim = {n, 2, 2}};
        for (size_t i = 0; i < 4 * n; i++)
            voxels[i] = (i % n + i / n % 2 + i / n / 2) % 2 ? 9 : 0;
        for (int open = 0; open < 2; open++) {
            cw_mesh mesh =
                test_extract(&v, &(cw_extract_desc){.isovalue = 5, .leave_open = open}, NULL);
            const cw_quality q = test_check_promise(&mesh, open);
            assert_int_equal(q.vertices, open ? n * 4 + (n - 1) * 4 : q.vertices);
            cw_mesh_free(&mesh);
        }
        free(voxels);
    }
}

static double determinant(const cw_volume *v)
{
    double d = 0;
    for (int c = 0; c < 3; c++)
        d += v->affine[0][c] * (v->affine[1][(c + 1) % 3] * v->affine[2][(c + 2) % 3] -
                                v->affine[1][(c + 2) % 3] * v->affine[2][(c + 1) % 3]);
    return d;
}

/* Sheared and mirrored frames keep the solid outside in: the volume is the determinant's, and
 * normals agree with the triangles. */
static void any_affine_keeps_the_outside_out(void **state)
{
    (void)state;
    test_seed(3);
    for (int round = 0; round < 12; round++) {
        cw_volume v = test_sample(CW_FIELD_SPHERE, 40, CW_F32);
        const double voxel = v.affine[0][0];
        test_turn(&v, round);
        cw_mesh mesh = test_extract(&v, NULL, NULL);
        const cw_quality q = test_check_promise(&mesh, false);
        assert_within(q.volume_mm3,
                      4.0 / 3 * PI * 27000 * fabs(determinant(&v)) / pow(voxel, 3), 0.01);
        assert_true(test_normals_agree(&mesh));
        cw_mesh_free(&mesh);
        cw_volume_free(&v);
    }
}

/* value = slope * voxel + intercept: applied to the isovalue, the same surface comes out. */
static void scaling_moves_the_level_not_the_surface(void **state)
{
    (void)state;
    cw_volume v = test_sample(CW_FIELD_SPHERE, 40, CW_F32);
    cw_mesh plain = test_extract(&v, &(cw_extract_desc){.isovalue = 4}, NULL);
    v.slope = 8;
    v.intercept = 100;
    cw_mesh scaled = test_extract(&v, &(cw_extract_desc){.isovalue = 132}, NULL);
    test_assert_same_mesh(&plain, &scaled);
    cw_mesh_free(&scaled);
    v.slope = -8; /* values fall as numbers rise: below is inside then */
    scaled = test_extract(&v, &(cw_extract_desc){.isovalue = 68, .inside_is_low = true}, NULL);
    assert_int_equal(scaled.vertex_count, plain.vertex_count);
    assert_near(test_check_promise(&scaled, false).volume_mm3,
                test_check_promise(&plain, false).volume_mm3, 1e-3);
    cw_mesh_free(&scaled);
    cw_mesh_free(&plain);
    cw_volume_free(&v);
}

/* At or above is inside, exactly, whatever the sign of the slope. */
static void a_sample_on_the_isovalue_is_inside(void **state)
{
    (void)state;
    uint8_t voxels[27];
    memset(voxels, 100, sizeof voxels);
    voxels[13] = 120;
    cw_volume v = {.data = voxels, .dim = {3, 3, 3}};
    cw_mesh mesh = test_extract(&v, &(cw_extract_desc){.isovalue = 120}, NULL);
    assert_int_equal(mesh.triangle_count, 8); /* an octahedron around the middle voxel */
    cw_mesh_free(&mesh);
    v.slope = -1;
    mesh = test_extract(&v, &(cw_extract_desc){.isovalue = -100}, NULL);
    assert_true(test_check_promise(&mesh, false).volume_mm3 > 1); /* all but the middle */
    assert_int_equal(test_check_promise(&mesh, false).components, 2);
    cw_mesh_free(&mesh);
    voxels[13] = 80;
    mesh = test_extract(&v, &(cw_extract_desc){.isovalue = -80}, NULL);
    assert_int_equal(mesh.triangle_count, 8);
    cw_mesh_free(&mesh);
}

/* NaN, infinite and no-data voxels: closed or open at them, finite, never degenerate. */
static void voxels_without_value_end_the_surface_cleanly(void **state)
{
    (void)state;
    test_seed(11);
    for (int round = 0; round < 200; round++) {
        float voxels[6 * 6 * 6];
        for (int n = 0; n < 216; n++) {
            const int kind = rand() % 12;
            voxels[n] = kind == 0   ? NAN
                        : kind == 1 ? INFINITY
                        : kind == 2 ? -INFINITY
                        : kind == 3 ? FLT_MAX
                        : kind == 4 ? -FLT_MAX
                        : kind == 5 ? -99
                        : kind == 6 ? 1e-42f
                                    : (float)(rand() % 7 - 3);
        }
        const cw_volume v = {.data = voxels,
                             .type = CW_F32,
                             .dim = {6, 6, 6},
                             .has_nodata = round & 1,
                             .nodata = -99};
        const cw_extract_desc d = {.leave_open = round & 2, .inside_is_low = round & 4};
        cw_mesh mesh = test_extract(&v, &d, NULL);
        cw_error err = {0};
        assert_ok(cw_mesh_check(&mesh, &err), err);
        test_check_promise(&mesh, d.leave_open);
        cw_mesh_free(&mesh);
    }
}

static void doubles_near_their_limits_are_placed_between_samples(void **state)
{
    (void)state;
    double voxels[8] = {DBL_MAX, -DBL_MAX, DBL_MAX, -DBL_MAX,
                        DBL_MAX, -DBL_MAX, DBL_MAX, -DBL_MAX};
    const cw_volume v = {.data = voxels, .type = CW_F64, .dim = {2, 2, 2}};
    cw_mesh mesh = test_extract(&v, &(cw_extract_desc){.leave_open = true}, NULL);
    assert_int_equal(mesh.vertex_count, 4);
    for (size_t i = 0; i < 4; i++) {
        assert_near(mesh.origin[0] + (double)mesh.positions[3 * i], 0.5, 1e-6);
        assert_near(mesh.normals[3 * i], 1, 1e-6);
    }
    cw_mesh_free(&mesh);
}

static void far_and_thin_keeps_its_triangles(void **state)
{
    (void)state;
    cw_mesh mesh;
    cw_quality q;
    cw_error err = {0};
    test_make_far_sphere(&mesh);
    assert_ok(cw_quality_measure(&mesh, NULL, &q, &err), err);
    assert_true(cw_quality_is_closed_manifold(&q));
    assert_int_equal(q.degenerate, 0);
    assert_within(q.volume_mm3, 4.0 / 3 * PI * pow(24, 3) * 0.1 * 0.1 * 5, 0.005);
    assert_near((q.min[0] + q.max[0]) / 2, 1e6 + 3.2, 1e-3);
    cw_mesh_free(&mesh);
}

static void levels_that_cross_nothing_give_an_empty_mesh(void **state)
{
    (void)state;
    static const uint8_t voxels[8] = {5, 5, 5, 7, 5, 5, 5, 5};
    static const float nothing[8] = {NAN, NAN, NAN, NAN, NAN, NAN, NAN, NAN};
    const cw_volume v = {.data = voxels, .dim = {2, 2, 2}};
    const cw_volume none = {.data = nothing, .type = CW_F32, .dim = {2, 2, 2}};
    static const double levels[] = {5, 7.0001, -1e300, 1e300, 4.9};
    cw_extract_counts counts;
    for (int n = 0; n < 5; n++) {
        cw_mesh mesh = test_extract(&v, &(cw_extract_desc){.isovalue = levels[n]}, &counts);
        assert_int_equal(mesh.triangle_count, 0);
        assert_int_equal(counts.triangles, 0);
        assert_null(mesh.positions);
    }
    cw_mesh mesh = test_extract(&none, NULL, NULL);
    assert_int_equal(mesh.triangle_count, 0);
    mesh = test_extract(&v, &(cw_extract_desc){.isovalue = 7}, NULL);
    assert_int_equal(test_check_promise(&mesh, false).components, 1);
    cw_mesh_free(&mesh);
}

/* Balls cut by the box: one loop for every side they stick out of. */
static void border_loops_are_counted(void **state)
{
    (void)state;
    static const struct {
        double centre[3];
        size_t loops;
    } balls[] = {{{10, 10, 10}, 0}, {{0, 10, 10}, 1}, {{0, 0, 0}, 1}, {{20, 20, 10}, 1}};
    for (size_t b = 0; b < sizeof balls / sizeof *balls; b++) {
        cw_volume v;
        cw_error err = {0};
        cw_extract_counts counts;
        assert_ok(cw_volume_alloc(&v, CW_F32, (size_t[3]){21, 21, 21}, 1, 1, &err), err);
        float *voxels = cw_volume_voxels(&v);
        for (int n = 0; n < 21 * 21 * 21; n++)
            voxels[n] = (float)(6.3 - sqrt(pow(n % 21 - balls[b].centre[0], 2) +
                                           pow(n / 21 % 21 - balls[b].centre[1], 2) +
                                           pow(n / 441 - balls[b].centre[2], 2)));
        cw_mesh mesh = test_extract(&v, NULL, &counts);
        assert_int_equal(counts.border_loops, balls[b].loops);
        assert_int_equal(test_check_promise(&mesh, false).euler, 2);
        cw_mesh_free(&mesh);
        cw_volume_free(&v);
    }
    cw_volume rod =
        test_sample(CW_FIELD_SPHERE, 16, CW_F32); /* through the box along x: two loops */
    float *voxels = cw_volume_voxels(&rod);
    cw_extract_counts counts;
    for (int n = 0; n < 4096; n++)
        voxels[n] = (float)(4.2 - hypot(n / 16 % 16 - 7.5, n / 256 - 7.5));
    cw_mesh mesh = test_extract(&rod, NULL, &counts);
    assert_int_equal(counts.border_loops, 2);
    cw_mesh_free(&mesh);
    cw_volume_free(&rod);
}

/* The closed curves that a mesh's open edges form, by following them. */
static size_t count_open_curves(const cw_mesh *mesh)
{
    const size_t n = mesh->vertex_count;
    bool *side = calloc(n * n, sizeof *side), *seen = calloc(n, sizeof *seen);
    size_t *next = malloc(n * sizeof *next), curves = 0;
    assert_true(side && seen && next);
    for (size_t i = 0; i < 3 * mesh->triangle_count; i++)
        side[mesh->triangles[i] * n + mesh->triangles[i % 3 == 2 ? i - 2 : i + 1]] = true;
    for (size_t v = 0; v < n; v++) {
        next[v] = n;
        for (size_t w = 0; w < n; w++)
            if (side[v * n + w] && !side[w * n + v])
                next[v] = w;
    }
    for (size_t v = 0; v < n; v++) {
        curves += next[v] < n && !seen[v];
        for (size_t w = v; next[w] < n && !seen[w]; w = next[w])
            seen[w] = true;
    }
    free(side);
    free(seen);
    free(next);
    return curves;
}

/* Ambiguous squares on the border included, in both topologies, ties and all. */
static void border_loops_are_the_open_surfaces_borders(void **state)
{
    (void)state;
    static const size_t dims[][3] = {{5, 4, 3}, {2, 2, 2}, {70, 2, 3}, {2, 67, 2}, {3, 63, 3}};
    test_seed(5);
    for (int round = 0; round < 100; round++) {
        const size_t *dim = dims[round % 5];
        float voxels[70 * 3 * 3];
        for (size_t n = 0; n < dim[0] * dim[1] * dim[2]; n++)
            voxels[n] =
                round % 3 ? (float)rand() / (float)RAND_MAX - 0.5f : (float)(rand() % 5 - 2);
        const cw_volume v = {.data = voxels, .type = CW_F32, .dim = {dim[0], dim[1], dim[2]}};
        const cw_extract_desc d = {
            .leave_open = true, .simple_topology = round & 1, .inside_is_low = round & 2};
        cw_extract_counts counts;
        cw_mesh mesh = test_extract(&v, &d, &counts);
        test_check_promise(&mesh, true);
        assert_int_equal(counts.border_loops, count_open_curves(&mesh));
        cw_mesh_free(&mesh);
    }
}

/* Where the gradient vanishes the triangles give the normal: a plateau beside a plateau. */
static void plateaus_have_normals_too(void **state)
{
    (void)state;
    uint8_t voxels[64];
    for (int n = 0; n < 64; n++)
        voxels[n] =
            (n % 4 == 1 || n % 4 == 2) ? 9 : 0; /* symmetric in x: no slope at samples */
    const cw_volume v = {.data = voxels, .dim = {4, 4, 4}};
    cw_mesh mesh = test_extract(&v, &(cw_extract_desc){.isovalue = 4.5}, NULL);
    test_check_promise(&mesh, false);
    cw_mesh_free(&mesh);
    uint8_t one[125] = {0};
    one[62] =
        2; /* a lone voxel: central differences vanish at its middle, not at its neighbours */
    const cw_volume dot = {.data = one, .dim = {5, 5, 5}};
    mesh = test_extract(&dot, &(cw_extract_desc){.isovalue = 2}, NULL);
    assert_int_equal(mesh.vertex_count, 6);
    test_check_promise(&mesh, false);
    cw_mesh_free(&mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sphere_is_closed_round_and_full),
        cmocka_unit_test(positions_and_normals_converge_with_second_order),
        cmocka_unit_test(cubics_are_far_closer_and_of_higher_order),
        cmocka_unit_test(a_coarse_sphere_is_near_the_sphere),
        cmocka_unit_test(a_coarse_view_is_as_good_as_its_copy),
        cmocka_unit_test(torus_has_one_handle),
        cmocka_unit_test(plane_is_exact),
        cmocka_unit_test(gyroid_parts_the_box_in_half),
        cmocka_unit_test(all_eight_types_give_the_sphere),
        cmocka_unit_test(integer_noise_stays_manifold),
        cmocka_unit_test(checkerboards_of_any_width_stay_manifold),
        cmocka_unit_test(any_affine_keeps_the_outside_out),
        cmocka_unit_test(scaling_moves_the_level_not_the_surface),
        cmocka_unit_test(a_sample_on_the_isovalue_is_inside),
        cmocka_unit_test(voxels_without_value_end_the_surface_cleanly),
        cmocka_unit_test(doubles_near_their_limits_are_placed_between_samples),
        cmocka_unit_test(far_and_thin_keeps_its_triangles),
        cmocka_unit_test(levels_that_cross_nothing_give_an_empty_mesh),
        cmocka_unit_test(border_loops_are_counted),
        cmocka_unit_test(border_loops_are_the_open_surfaces_borders),
        cmocka_unit_test(plateaus_have_normals_too),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
