/* Surfaces whose truth is known on paper, and properties that hold on any input. */
#include "support/support.h"

#include "core/memory.h"
#include "extract/engine.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static cw_volume make(cw_field field, size_t n, cw_type type)
{
    const cw_field_desc desc = {.field = field, .dim = {n, n, n}, .type = type};
    cw_volume v;
    cw_error err = {0};
    assert_ok(cw_field_sample(&desc, &v, &err), err);
    return v;
}

static cw_mesh extract(const cw_volume *v, const cw_extract_desc *desc,
                       cw_extract_counts *counts)
{
    cw_mesh mesh;
    cw_error err = {0};
    assert_ok(cw_extract(v, desc, &mesh, counts, &err), err);
    return mesh;
}

/* The promise on any input: a manifold without zero-area triangles, indexed and welded, unit
 * normals, and no edge of it open unless open is asked for. */
static cw_quality check_promise(const cw_mesh *mesh, bool open)
{
    cw_quality q[2];
    cw_error err = {0};
    for (int weld = 0; weld < 2; weld++) {
        assert_ok(cw_quality_measure(mesh, &(cw_quality_desc){.weld = weld}, &q[weld], &err),
                  err);
        assert_int_equal(q[weld].nonmanifold_edges, 0);
        assert_int_equal(q[weld].misoriented_edges, 0);
        assert_int_equal(q[weld].nonmanifold_vertices, 0);
        assert_int_equal(q[weld].degenerate, 0);
        if (!open)
            assert_int_equal(q[weld].open_edges, 0);
    }
    assert_int_equal(q[0].unused_vertices, 0);
    assert_int_equal(q[0].euler, q[1].euler);
    assert_int_equal(q[0].components, q[1].components);
    for (size_t v = 0; v < mesh->vertex_count && mesh->normals; v++) {
        const float *n = mesh->normals + 3 * v;
        assert_near((double)n[0] * n[0] + (double)n[1] * n[1] + (double)n[2] * n[2], 1, 1e-5);
    }
    return q[0];
}

static void world_point(const cw_mesh *mesh, size_t v, double p[3])
{
    for (size_t a = 0; a < 3; a++)
        p[a] = mesh->origin[a] + (double)mesh->positions[3 * v + a];
}

/* Largest distance of a vertex from the sphere, and angle (radians) of its normal to the truth.
 */
static void sphere_errors(const cw_mesh *mesh, double *distance, double *angle)
{
    *distance = *angle = 0;
    for (size_t v = 0; v < mesh->vertex_count; v++) {
        const float *n = mesh->normals + 3 * v;
        double p[3];
        world_point(mesh, v, p);
        const double r = sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
        const double d = hypot(hypot(p[0] / r - n[0], p[1] / r - n[1]), p[2] / r - n[2]);
        *distance = fmax(*distance, fabs(r - 30));
        *angle = fmax(*angle, 2 * asin(d / 2));
    }
}

static void sphere_is_closed_round_and_full(void **state)
{
    (void)state;
    cw_volume v = make(CW_FIELD_SPHERE, 64, CW_F32);
    cw_extract_counts counts;
    cw_mesh mesh = extract(&v, NULL, &counts);
    const cw_quality q = check_promise(&mesh, false);
    double distance, angle;
    assert_int_equal(q.euler, 2);
    assert_int_equal(q.components, 1);
    assert_int_equal(counts.border_loops, 0);
    assert_within(q.volume_mm3, 4.0 / 3 * PI * 30 * 30 * 30, 0.002);
    assert_within(q.area_mm2, 4 * PI * 30 * 30, 0.002);
    sphere_errors(&mesh, &distance, &angle);
    assert_true(distance < 0.0075); /* mm; a voxel is 1.27 */
    assert_true(angle < 0.05 * PI / 180);
    cw_mesh_free(&mesh);
    cw_volume_free(&v);
}

/* Half the spacing, a quarter of the error. */
static void positions_and_normals_converge_with_second_order(void **state)
{
    (void)state;
    double distance[2], angle[2], missing[2];
    for (int n = 0; n < 2; n++) {
        cw_volume v = make(CW_FIELD_SPHERE, n ? 97 : 49, CW_F64);
        cw_mesh mesh = extract(&v, NULL, NULL);
        cw_quality q = check_promise(&mesh, false);
        sphere_errors(&mesh, &distance[n], &angle[n]);
        missing[n] = fabs(4.0 / 3 * PI * 27000 - q.volume_mm3);
        cw_mesh_free(&mesh);
        cw_volume_free(&v);
    }
    assert_true(distance[0] / distance[1] > 3.4);
    assert_true(angle[0] / angle[1] > 3.4);
    assert_true(missing[0] / missing[1] > 3.6);
}

static void torus_has_one_handle(void **state)
{
    (void)state;
    cw_volume v = make(CW_FIELD_TORUS, 64, CW_F32);
    cw_mesh mesh = extract(&v, NULL, NULL);
    const cw_quality q = check_promise(&mesh, false);
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
    cw_volume v = make(CW_FIELD_PLANE, 33, CW_F64);
    cw_extract_counts counts;
    cw_mesh mesh =
        extract(&v, &(cw_extract_desc){.isovalue = 1.7, .leave_open = true}, &counts);
    const cw_quality q = check_promise(&mesh, true);
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
    mesh = extract(&v, &(cw_extract_desc){.isovalue = 1.7}, &counts);
    assert_int_equal(check_promise(&mesh, false).euler, 2); /* half the box, capped */
    assert_int_equal(counts.border_loops, 1);
    cw_mesh_free(&mesh);
    cw_volume_free(&v);
}

/* The gyroid splits space in two halves alike, so inside and outside fill half the box each. */
static void gyroid_parts_the_box_in_half(void **state)
{
    (void)state;
    cw_volume v = make(CW_FIELD_GYROID, 81, CW_F32);
    cw_mesh above = extract(&v, NULL, NULL);
    cw_mesh below = extract(&v, &(cw_extract_desc){.inside_is_low = true}, NULL);
    const cw_quality a = check_promise(&above, false), b = check_promise(&below, false);
    assert_true(a.euler < -80);
    assert_within(a.volume_mm3 + b.volume_mm3, 512000, 0.001);
    assert_within(a.volume_mm3, 256000, 0.01);
    cw_mesh_free(&above);
    cw_mesh_free(&below);
    cw_volume_free(&v);
}

static void assert_same_mesh(const cw_mesh *a, const cw_mesh *b)
{
    assert_int_equal(a->vertex_count, b->vertex_count);
    assert_int_equal(a->triangle_count, b->triangle_count);
    assert_memory_equal(a->origin, b->origin, sizeof a->origin);
    assert_memory_equal(a->positions, b->positions, 12 * a->vertex_count);
    assert_memory_equal(a->normals, b->normals, 12 * a->vertex_count);
    assert_memory_equal(a->triangles, b->triangles, 12 * a->triangle_count);
}

static void any_number_of_threads_gives_the_same_bytes(void **state)
{
    (void)state;
    static const int threads[] = {2, 3, 8};
    const cw_field_desc desc = {
        .field = CW_FIELD_GYROID, .dim = {70, 41, 57}, .type = CW_I16, .noise = 1};
    cw_volume v;
    cw_error err = {0};
    assert_ok(cw_field_sample(&desc, &v, &err), err);
    for (int open = 0; open < 2; open++) {
        cw_extract_desc d = {.isovalue = 3, .threads = 1, .leave_open = open};
        cw_mesh one = extract(&v, &d, NULL);
        for (int n = 0; n < 3; n++) {
            d.threads = threads[n];
            cw_mesh many = extract(&v, &d, NULL);
            assert_same_mesh(&one, &many);
            cw_mesh_free(&many);
        }
        cw_mesh_free(&one);
    }
    cw_volume_free(&v);
}

/* A random affine with shear; every third one a mirror. */
static void turn(cw_volume *v, int round)
{
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++)
            v->affine[r][c] = (r == c ? 2.0 : 0) + (double)rand() / RAND_MAX - 0.5;
    if (round % 3 == 0)
        for (int r = 0; r < 3; r++)
            v->affine[r][0] *= -1;
}

/* Noise, with NaN and infinities in float types, in any type. */
static void fill(void *voxels, cw_type type, size_t count)
{
    for (size_t n = 0; n < count; n++) {
        const int r = rand() % 97, kind = rand() % 20;
        const double special = kind == 0   ? NAN
                               : kind == 1 ? INFINITY
                               : kind == 2 ? -(double)FLT_MAX
                                           : r - 48.25;
        switch (type) {
#define CASE(name, ctype, text)                                                                \
    case name:                                                                                 \
        ((ctype *)voxels)[n] = name == CW_F32 || name == CW_F64 ? (ctype)special : (ctype)r;   \
        break;
            CW_TYPE_TABLE(CASE)
#undef CASE
        default:
            break;
        }
    }
}

/* Every engine this machine can use against the plain one: rows of any length, that start
 * anywhere, of every type; no two with the same way to compare. */
static void every_engine_gives_the_same_bytes(void **state)
{
    (void)state;
    double *memory = malloc(sizeof *memory * (4 * 5 * 200 + 8));
    srand(23);
    for (size_t width = 2; width <= 200; width++)
        for (int type = 0; type < CW_TYPE_COUNT; type++) {
            const size_t bytes = cw_type_size((cw_type)type), shift = (size_t)rand() % 8;
            char *voxels = (char *)memory + shift * bytes;
            fill(voxels, (cw_type)type, width * 20);
            const cw_volume v = {.data = voxels,
                                 .type = (cw_type)type,
                                 .dim = {width, 4, 5},
                                 .slope = rand() % 4 ? 1 : -1,
                                 .has_nodata = rand() % 8 == 0,
                                 .nodata = 7};
            const cw_extract_desc d = {.isovalue = rand() % 60 * v.slope,
                                       .inside_is_low = rand() % 2,
                                       .leave_open = rand() % 4 == 0,
                                       .threads = 1};
            cw_mesh plain, other;
            cw_error err = {0};
            assert_ok(cwi_extract_with(cwi_engine_at(0), &v, &d, &plain, NULL, &err), err);
            for (size_t e = 1; cwi_engine_at(e); e++) {
                assert_ok(cwi_extract_with(cwi_engine_at(e), &v, &d, &other, NULL, &err), err);
                assert_same_mesh(&plain, &other);
                cw_mesh_free(&other);
            }
            cw_mesh_free(&plain);
        }
    free(memory);
}

/* No-data that no voxel has sends every vertex through the code for one at a time: positions
 * are the same to the bit, normals to rounding, on the border as inside. */
static void many_vertices_at_a_time_are_as_good_as_one(void **state)
{
    (void)state;
    for (int type = 0; type < CW_TYPE_COUNT; type++) {
        const cw_field_desc desc = {
            .field = CW_FIELD_GYROID, .dim = {37, 30, 41}, .type = (cw_type)type, .noise = 0.1};
        cw_volume v;
        cw_error err = {0};
        assert_ok(cw_field_sample(&desc, &v, &err), err);
        const cw_extract_desc d = {.isovalue =
                                       cw_field_stored(CW_FIELD_GYROID, (cw_type)type, 0.1)};
        turn(&v, type);
        cw_mesh many = extract(&v, &d, NULL);
        v.has_nodata = true;
        v.nodata = 0.123;
        cw_mesh one = extract(&v, &d, NULL);
        assert_int_equal(many.vertex_count, one.vertex_count);
        assert_memory_equal(many.positions, one.positions, 12 * one.vertex_count);
        for (size_t n = 0; n < 3 * one.vertex_count; n++)
            assert_near(many.normals[n], one.normals[n], 1e-5);
        cw_mesh_free(&many);
        cw_mesh_free(&one);
        cw_volume_free(&v);
    }
}

static void all_eight_types_give_the_sphere(void **state)
{
    (void)state;
    for (int type = 0; type < CW_TYPE_COUNT; type++) {
        cw_volume v = make(CW_FIELD_SPHERE, 48, (cw_type)type);
        const cw_extract_desc d = {.isovalue =
                                       cw_field_stored(CW_FIELD_SPHERE, (cw_type)type, 0)};
        cw_mesh mesh = extract(&v, &d, NULL);
        const cw_quality q = check_promise(&mesh, false);
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
    srand(7);
    for (int round = 0; round < 400; round++) {
        int8_t voxels[6 * 5 * 7];
        for (size_t n = 0; n < sizeof voxels; n++)
            voxels[n] = (int8_t)(rand() % 5 - 2);
        const cw_volume v = {.data = voxels, .type = CW_I8, .dim = {6, 5, 7}};
        const cw_extract_desc d = {.leave_open = round & 1, .inside_is_low = round & 2};
        cw_mesh mesh = extract(&v, &d, NULL);
        check_promise(&mesh, d.leave_open);
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
                extract(&v, &(cw_extract_desc){.isovalue = 5, .leave_open = open}, NULL);
            const cw_quality q = check_promise(&mesh, open);
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
    srand(3);
    for (int round = 0; round < 12; round++) {
        cw_volume v = make(CW_FIELD_SPHERE, 40, CW_F32);
        const double voxel = v.affine[0][0];
        turn(&v, round);
        cw_mesh mesh = extract(&v, NULL, NULL);
        const cw_quality q = check_promise(&mesh, false);
        assert_within(q.volume_mm3,
                      4.0 / 3 * PI * 27000 * fabs(determinant(&v)) / pow(voxel, 3), 0.01);
        for (size_t t = 0; t < mesh.triangle_count; t++) {
            const uint32_t *c = mesh.triangles + 3 * t;
            const float *p = mesh.positions, *n = mesh.normals + 3 * (size_t)c[0];
            double u[3], w[3], dot = 0;
            for (size_t a = 0; a < 3; a++) {
                u[a] = (double)p[3 * (size_t)c[1] + a] - (double)p[3 * (size_t)c[0] + a];
                w[a] = (double)p[3 * (size_t)c[2] + a] - (double)p[3 * (size_t)c[0] + a];
            }
            for (int a = 0; a < 3; a++)
                dot +=
                    n[a] * (u[(a + 1) % 3] * w[(a + 2) % 3] - u[(a + 2) % 3] * w[(a + 1) % 3]);
            assert_true(dot > 0);
        }
        cw_mesh_free(&mesh);
        cw_volume_free(&v);
    }
}

/* value = slope * voxel + intercept: applied to the isovalue, the same surface comes out. */
static void scaling_moves_the_level_not_the_surface(void **state)
{
    (void)state;
    cw_volume v = make(CW_FIELD_SPHERE, 40, CW_F32);
    cw_mesh plain = extract(&v, &(cw_extract_desc){.isovalue = 4}, NULL);
    v.slope = 8;
    v.intercept = 100;
    cw_mesh scaled = extract(&v, &(cw_extract_desc){.isovalue = 132}, NULL);
    assert_same_mesh(&plain, &scaled);
    cw_mesh_free(&scaled);
    v.slope = -8; /* values fall as numbers rise: below is inside then */
    scaled = extract(&v, &(cw_extract_desc){.isovalue = 68, .inside_is_low = true}, NULL);
    assert_int_equal(scaled.vertex_count, plain.vertex_count);
    assert_near(check_promise(&scaled, false).volume_mm3,
                check_promise(&plain, false).volume_mm3, 1e-3);
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
    cw_mesh mesh = extract(&v, &(cw_extract_desc){.isovalue = 120}, NULL);
    assert_int_equal(mesh.triangle_count, 8); /* an octahedron around the middle voxel */
    cw_mesh_free(&mesh);
    v.slope = -1;
    mesh = extract(&v, &(cw_extract_desc){.isovalue = -100}, NULL);
    assert_true(check_promise(&mesh, false).volume_mm3 > 1); /* all but the middle */
    assert_int_equal(check_promise(&mesh, false).components, 2);
    cw_mesh_free(&mesh);
    voxels[13] = 80;
    mesh = extract(&v, &(cw_extract_desc){.isovalue = -80}, NULL);
    assert_int_equal(mesh.triangle_count, 8);
    cw_mesh_free(&mesh);
}

/* NaN, infinite and no-data voxels: closed or open at them, finite, never degenerate. */
static void voxels_without_value_end_the_surface_cleanly(void **state)
{
    (void)state;
    srand(11);
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
        cw_mesh mesh = extract(&v, &d, NULL);
        cw_error err = {0};
        assert_ok(cw_mesh_check(&mesh, &err), err);
        check_promise(&mesh, d.leave_open);
        cw_mesh_free(&mesh);
    }
}

static void doubles_near_their_limits_are_placed_between_samples(void **state)
{
    (void)state;
    double voxels[8] = {DBL_MAX, -DBL_MAX, DBL_MAX, -DBL_MAX,
                        DBL_MAX, -DBL_MAX, DBL_MAX, -DBL_MAX};
    const cw_volume v = {.data = voxels, .type = CW_F64, .dim = {2, 2, 2}};
    cw_mesh mesh = extract(&v, &(cw_extract_desc){.leave_open = true}, NULL);
    assert_int_equal(mesh.vertex_count, 4);
    for (size_t i = 0; i < 4; i++) {
        assert_near(mesh.origin[0] + (double)mesh.positions[3 * i], 0.5, 1e-6);
        assert_near(mesh.normals[3 * i], 1, 1e-6);
    }
    cw_mesh_free(&mesh);
}

/* The same voxels through other strides: transposed, then flipped. */
static void strides_are_honoured(void **state)
{
    (void)state;
    const cw_field_desc desc = {
        .field = CW_FIELD_CT_HEAD, .dim = {30, 24, 36}, .type = CW_I16, .noise = 30};
    cw_volume v, copy;
    cw_error err = {0};
    assert_ok(cw_field_sample(&desc, &v, &err), err);
    assert_ok(cw_volume_alloc(&copy, CW_I16, (size_t[3]){36, 30, 24}, 1, 1, &err), err);
    memcpy(copy.affine, v.affine, sizeof v.affine);
    int16_t *to = cw_volume_voxels(&copy);
    for (size_t k = 0; k < 36; k++) /* z fastest and backwards, then x, then y */
        for (size_t j = 0; j < 24; j++)
            for (size_t i = 0; i < 30; i++)
                to[(35 - k) + 36 * (i + 30 * j)] = (int16_t)cw_volume_value(&v, i, j, k);
    cw_volume view = copy;
    memcpy(view.dim, v.dim, sizeof v.dim);
    view.stride[0] = 72;
    view.stride[1] = 72 * 30;
    view.stride[2] = -2;
    view.data = to + 35;
    const cw_extract_desc d = {.isovalue = 300};
    cw_mesh a = extract(&v, &d, NULL), b = extract(&view, &d, NULL);
    assert_same_mesh(&a, &b);
    cw_mesh_free(&a);
    cw_mesh_free(&b);
    cw_volume_free(&v);
    cw_volume_free(&copy);
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
        cw_mesh mesh = extract(&v, &(cw_extract_desc){.isovalue = levels[n]}, &counts);
        assert_int_equal(mesh.triangle_count, 0);
        assert_int_equal(counts.triangles, 0);
        assert_null(mesh.positions);
    }
    cw_mesh mesh = extract(&none, NULL, NULL);
    assert_int_equal(mesh.triangle_count, 0);
    mesh = extract(&v, &(cw_extract_desc){.isovalue = 7}, NULL);
    assert_int_equal(check_promise(&mesh, false).components, 1);
    cw_mesh_free(&mesh);
}

static void unusable_arguments_are_refused_by_name(void **state)
{
    (void)state;
    static const uint8_t voxels[8];
    cw_volume v = {.data = voxels, .dim = {2, 2, 2}};
    cw_mesh mesh;
    cw_error err = {0};
    assert_fails(cw_extract(&v, &(cw_extract_desc){.isovalue = NAN}, &mesh, NULL, &err),
                 CW_ERR_ARGUMENT, "isovalue", err);
    v.dim[2] = 1;
    assert_fails(cw_extract(&v, NULL, &mesh, NULL, &err), CW_ERR_ARGUMENT, "along z", err);
    v.data = NULL;
    assert_fails(cw_extract(&v, NULL, &mesh, NULL, &err), CW_ERR_ARGUMENT, "no voxels", err);
}

static void limits_stop_before_the_mesh_is_made(void **state)
{
    (void)state;
    cw_volume v = make(CW_FIELD_SPHERE, 32, CW_F32);
    cw_mesh mesh;
    cw_error err = {0};
    cw_extract_counts counts, made;
    assert_ok(cw_extract_predict(&v, NULL, &counts, &err), err);
    mesh = extract(&v, NULL, &made);
    assert_int_equal(counts.triangles, mesh.triangle_count);
    assert_int_equal(counts.vertices, mesh.vertex_count);
    assert_int_equal(counts.bytes, made.bytes);
    cw_mesh_free(&mesh);
    cw_extract_desc d = {.max_triangles = counts.triangles};
    mesh = extract(&v, &d, NULL);
    cw_mesh_free(&mesh);
    d.max_triangles--;
    assert_fails(cw_extract(&v, &d, &mesh, NULL, &err), CW_ERR_LIMIT, "triangles", err);
    assert_null(mesh.positions);
    d = (cw_extract_desc){.max_bytes = counts.bytes - 1};
    assert_fails(cw_extract(&v, &d, &mesh, NULL, &err), CW_ERR_LIMIT, "bytes", err);
    cw_volume_free(&v);
}

static bool stop_at(void *user, const char *step, double done)
{
    (void)step, (void)done;
    return (*(int *)user)-- > 0;
}

static void it_can_be_cancelled_at_any_poll(void **state)
{
    (void)state;
    cw_volume v = make(CW_FIELD_SPHERE, 40, CW_F32);
    cw_mesh mesh;
    cw_error err = {0};
    for (int polls = 0;; polls++) {
        int left = polls;
        const cw_extract_desc d = {.progress = {stop_at, &left}};
        const cw_status st = cw_extract(&v, &d, &mesh, NULL, &err);
        if (st == CW_OK)
            break;
        assert_int_equal(st, CW_ERR_CANCELLED);
        assert_null(mesh.positions);
        assert_true(polls < 100);
    }
    cw_mesh_free(&mesh);
    cw_volume_free(&v);
}

static void memory_running_out_is_an_error_at_every_allocation(void **state)
{
    (void)state;
    static const float voxels[27] = {[13] = 1};
    const cw_volume v = {.data = voxels, .type = CW_F32, .dim = {3, 3, 3}};
    const cw_extract_desc d = {.isovalue = 0.5f, .leave_open = true};
    cw_mesh mesh;
    cw_error err = {0};
    for (long n = 0;; n++) {
        cwi_alloc_fail_after(n);
        const cw_status st = cw_extract(&v, &d, &mesh, NULL, &err);
        if (!cwi_alloc_fail_after(-1)) {
            assert_int_equal(st, CW_OK);
            assert_true(n >= 6);
            break;
        }
        assert_int_equal(st, CW_ERR_NO_MEMORY);
        assert_null(mesh.positions);
    }
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
        cw_mesh mesh = extract(&v, NULL, &counts);
        assert_int_equal(counts.border_loops, balls[b].loops);
        assert_int_equal(check_promise(&mesh, false).euler, 2);
        cw_mesh_free(&mesh);
        cw_volume_free(&v);
    }
    cw_volume rod = make(CW_FIELD_SPHERE, 16, CW_F32); /* through the box along x: two loops */
    float *voxels = cw_volume_voxels(&rod);
    cw_extract_counts counts;
    for (int n = 0; n < 4096; n++)
        voxels[n] = (float)(4.2 - hypot(n / 16 % 16 - 7.5, n / 256 - 7.5));
    cw_mesh mesh = extract(&rod, NULL, &counts);
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
    srand(5);
    for (int round = 0; round < 60; round++) {
        float voxels[5 * 4 * 3];
        for (int n = 0; n < 60; n++)
            voxels[n] =
                round % 3 ? (float)rand() / (float)RAND_MAX - 0.5f : (float)(rand() % 5 - 2);
        const cw_volume v = {.data = voxels, .type = CW_F32, .dim = {5, 4, 3}};
        const cw_extract_desc d = {
            .leave_open = true, .simple_topology = round & 1, .inside_is_low = round & 2};
        cw_extract_counts counts;
        cw_mesh mesh = extract(&v, &d, &counts);
        check_promise(&mesh, true);
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
    cw_mesh mesh = extract(&v, &(cw_extract_desc){.isovalue = 4.5}, NULL);
    check_promise(&mesh, false);
    cw_mesh_free(&mesh);
    uint8_t one[125] = {0};
    one[62] =
        2; /* a lone voxel: central differences vanish at its middle, not at its neighbours */
    const cw_volume dot = {.data = one, .dim = {5, 5, 5}};
    mesh = extract(&dot, &(cw_extract_desc){.isovalue = 2}, NULL);
    assert_int_equal(mesh.vertex_count, 6);
    check_promise(&mesh, false);
    cw_mesh_free(&mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sphere_is_closed_round_and_full),
        cmocka_unit_test(positions_and_normals_converge_with_second_order),
        cmocka_unit_test(torus_has_one_handle),
        cmocka_unit_test(plane_is_exact),
        cmocka_unit_test(gyroid_parts_the_box_in_half),
        cmocka_unit_test(any_number_of_threads_gives_the_same_bytes),
        cmocka_unit_test(every_engine_gives_the_same_bytes),
        cmocka_unit_test(many_vertices_at_a_time_are_as_good_as_one),
        cmocka_unit_test(all_eight_types_give_the_sphere),
        cmocka_unit_test(integer_noise_stays_manifold),
        cmocka_unit_test(checkerboards_of_any_width_stay_manifold),
        cmocka_unit_test(any_affine_keeps_the_outside_out),
        cmocka_unit_test(scaling_moves_the_level_not_the_surface),
        cmocka_unit_test(a_sample_on_the_isovalue_is_inside),
        cmocka_unit_test(voxels_without_value_end_the_surface_cleanly),
        cmocka_unit_test(doubles_near_their_limits_are_placed_between_samples),
        cmocka_unit_test(strides_are_honoured),
        cmocka_unit_test(far_and_thin_keeps_its_triangles),
        cmocka_unit_test(levels_that_cross_nothing_give_an_empty_mesh),
        cmocka_unit_test(unusable_arguments_are_refused_by_name),
        cmocka_unit_test(limits_stop_before_the_mesh_is_made),
        cmocka_unit_test(it_can_be_cancelled_at_any_poll),
        cmocka_unit_test(memory_running_out_is_an_error_at_every_allocation),
        cmocka_unit_test(border_loops_are_counted),
        cmocka_unit_test(border_loops_are_the_open_surfaces_borders),
        cmocka_unit_test(plateaus_have_normals_too),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
