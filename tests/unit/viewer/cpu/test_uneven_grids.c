/* Tests the modes of the CPU on rectilinear and irregular grids: against the same field on an
 * even grid, against formulas, and on grids with holes, gaps and bad cells. */
#include "support/cells.h"
#include "support/pictures.h"
#include "support/rays.h"

#include "core/base/memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { SIDE = 40 };

static cw_renderer *cpu;

static int open_renderer(void **state)
{
    (void)state;
    cw_error err = {0};
    return cw_renderer_new(CW_BACKEND_CPU, &cpu, &err) == CW_OK ? 0 : 1;
}

static int close_renderer(void **state)
{
    (void)state;
    cw_renderer_free(cpu);
    return 0;
}

/* --- fields on the box from -1 to 1 -------------------------------------------------------- */

static double linear(const double p[3])
{
    return 0.5 + 0.22 * p[0] - 0.17 * p[1] + 0.08 * p[2];
}

static double waves(const double p[3])
{
    return 0.5 + 0.3 * sin(2.1 * p[0] + 0.4) * cos(1.7 * p[1]) + 0.2 * sin(1.3 * p[2] + p[0]);
}

static double one(const double p[3])
{
    (void)p;
    return 1;
}

/* An even grid of n cells a side on the box, in floats. */
static cw_volume even_box(size_t n, double (*field)(const double p[3]))
{
    cw_volume v = {0};
    cw_error err = {0};
    const size_t dim[3] = {n + 1, n + 1, n + 1};
    cw_renderer_forget(cpu); /* a freed volume may have been in the same place */
    assert_ok(cw_volume_alloc(&v, CW_F32, dim, 1, 1, &err), err);
    float *to = cw_volume_voxels(&v);
    for (size_t i = 0; i < (n + 1) * (n + 1) * (n + 1); i++) {
        const size_t at[3] = {i % (n + 1), i / (n + 1) % (n + 1), i / (n + 1) / (n + 1)};
        double p[3];
        for (int a = 0; a < 3; a++)
            p[a] = 2 * (double)at[a] / (double)n - 1;
        to[i] = (float)field(p);
    }
    for (int a = 0; a < 3; a++) {
        v.affine[a][a] = 2.0 / (double)n;
        v.affine[a][3] = -1;
    }
    return v;
}

/* The same as cells, whose samples have the same floats as values. */
static void make_cells(test_grid *g, test_cut cut, size_t n, double jitter,
                       double (*field)(const double p[3]))
{
    cw_renderer_forget(cpu); /* another grid may be in the same place */
    test_grid_make(g, cut, n, jitter);
    test_grid_fill(g, field);
    for (size_t i = 0; i < g->samples; i++)
        g->values[i] = (double)(float)g->values[i];
}

static cw_scene scene_of(const cw_volume *v, const cw_transfer *t, cw_mode mode)
{
    return (cw_scene){.mode = mode,
                      .volume = v,
                      .transfer = t,
                      .camera = {.eye = {2.6, -3.9, 2.2}, .up = {0.1, 0, 1}, .fov_deg = 34},
                      .width = SIDE,
                      .height = SIDE};
}

/* For a box of 2 mm: opacities are per 0.1 mm. */
static cw_transfer soft(void)
{
    cw_transfer t = test_soft_transfer();
    t.unit_mm = 0.1;
    return t;
}

static cw_transfer flat(void)
{
    cw_transfer t = test_flat_transfer();
    t.unit_mm = 0.1;
    return t;
}

/* Draws two volumes in the same scene and returns how much the pictures differ. */
static test_gap compare(cw_scene scene, const cw_volume *a, const cw_volume *b)
{
    scene.volume = a;
    cw_picture one_picture = test_draw(cpu, &scene);
    scene.volume = b;
    cw_picture other = test_draw(cpu, &scene);
    double most = 0;
    for (size_t n = 0; n < 4 * SIDE * SIDE; n++)
        most = fmax(most, (double)one_picture.pixels[n]);
    assert_true(most > 0.1);
    const test_gap gap = test_compare(&one_picture, &other);
    cw_picture_free(&one_picture);
    cw_picture_free(&other);
    return gap;
}

#define assert_gap(gap, limit)                                                                 \
    do {                                                                                       \
        const test_gap g_ = (gap);                                                             \
        if (!(g_.max <= (limit)))                                                              \
            fail_msg("%s: max %g of 255, rmse %g; limit %g", #gap, g_.max, g_.rmse, (limit));  \
    } while (0)

/* --- rectilinear grids ------------------------------------------------------------------- */

typedef struct rectilinear {
    cw_volume volume;
    double at[3][40];
} rectilinear;

/* A view of an even volume with coordinates; bent: these are not evenly spaced. */
static void lay_out(rectilinear *r, const cw_volume *even, bool bent)
{
    r->volume = *even;
    for (int a = 0; a < 3; a++) {
        const size_t n = even->dim[a];
        for (size_t i = 0; i < n; i++) {
            const double q = n > 1 ? (double)i / (double)(n - 1) : 0;
            r->at[a][i] =
                bent ? 2 * (0.6 * q + 0.4 * q * q) - 1 : even->affine[a][a] * (double)i - 1;
        }
        r->volume.coordinates[a] = r->at[a];
        r->volume.affine[a][a] = 1;
        r->volume.affine[a][3] = 0;
    }
    r->volume.owned = NULL;
}

static void even_coordinates_are_an_even_grid(void **state)
{
    (void)state;
    const cw_transfer t = soft();
    cw_volume even = even_box(12, waves);
    rectilinear r;
    lay_out(&r, &even, false);
    static const cw_mode modes[] = {CW_MODE_REFERENCE, CW_MODE_VBUFFER, CW_MODE_MIP,
                                    CW_MODE_MINIP,     CW_MODE_AVERAGE, CW_MODE_LOCAL_MIP};
    for (size_t m = 0; m < sizeof modes / sizeof *modes; m++)
        for (int lit = 0; lit < 2; lit++) {
            cw_scene s = scene_of(&even, &t, modes[m]);
            s.lit = lit;
            s.depth_cue = 0.3f;
            s.intensity.threshold = 0.6;
            s.clip_count = 2;
            s.clips[0] = (cw_clip){{1, 0.2, 0}, -0.6};
            s.clips[1] = (cw_clip){{-1, 0.2, 0.3}, -0.7};
            s.cut_away = lit;
            assert_gap(compare(s, &even, &r.volume), modes[m] == CW_MODE_VBUFFER ? 0.2 : 1e-3);
        }
    cw_volume_free(&even);
}

/* Interpolation in boxes of any size reproduces linear fields. */
static void bent_coordinates_have_linear_fields(void **state)
{
    (void)state;
    const cw_transfer t = soft();
    cw_volume even = even_box(12, linear), bent = even_box(12, linear);
    rectilinear r;
    lay_out(&r, &bent, true);
    for (size_t i = 0; i < 13 * 13 * 13; i++) {
        const double p[3] = {r.at[0][i % 13], r.at[1][i / 13 % 13], r.at[2][i / 169]};
        ((float *)cw_volume_voxels(&bent))[i] = (float)linear(p);
    }
    for (int lit = 0; lit < 2; lit++) {
        cw_scene s = scene_of(&even, &t, CW_MODE_REFERENCE);
        s.lit = lit;
        assert_gap(compare(s, &even, &r.volume), 0.002);
        s.mode = CW_MODE_VBUFFER;
        assert_gap(compare(s, &even, &r.volume), 0.2);
    }
    cw_volume_free(&even);
    cw_volume_free(&bent);
}

/* Along an axis of one sample the grid reaches half a unit of its coordinates to both sides. */
static void flat_rectilinear_grids_are_slabs(void **state)
{
    (void)state;
    const cw_transfer t = flat();
    cw_volume slab = {0};
    double at[3][8] = {{-3, -1, 0, 3}, {5}, {-2, 0, 2, 4}};
    test_field(&slab, 4, 1, 4, (const double[3]){1, 1, 1}, test_constant);
    for (int a = 0; a < 3; a++) {
        slab.coordinates[a] = at[a];
        slab.affine[a][3] = 0;
    }
    cw_scene s = scene_of(&slab, &t, CW_MODE_REFERENCE);
    s.camera = (cw_camera){.eye = {0, -50, 0}, .up = {0, 0, 1}, .height_mm = 3};
    cw_picture p = test_draw(cpu, &s);
    assert_near((double)p.pixels[4 * (SIDE * SIDE / 2 + SIDE / 2) + 3],
                1 - pow(1 - (double)0.05f, 10), 1e-6);
    cw_picture_free(&p);
    cw_volume_free(&slab);
}

/* --- irregular grids against even ones --------------------------------------------------- */

/* The map of a box is linear: hexahedra are the even grid's cells. */
static void boxes_are_an_even_grid(void **state)
{
    (void)state;
    const cw_transfer t = soft();
    cw_volume even = even_box(9, waves);
    test_grid g;
    make_cells(&g, TEST_HEXAHEDRA, 9, 0, waves);
    static const cw_mode modes[] = {CW_MODE_REFERENCE, CW_MODE_VBUFFER, CW_MODE_MIP,
                                    CW_MODE_MINIP,     CW_MODE_AVERAGE, CW_MODE_LOCAL_MIP};
    for (size_t m = 0; m < sizeof modes / sizeof *modes; m++)
        for (int lit = 0; lit < 2; lit++) {
            cw_scene s = scene_of(&even, &t, modes[m]);
            s.lit = lit;
            s.depth_cue = 0.3f;
            s.intensity.threshold = 0.6;
            s.clip_count = 2;
            s.clips[0] = (cw_clip){{1, 0.2, 0}, -0.6};
            s.clips[1] = (cw_clip){{-1, 0.2, 0.3}, -0.7};
            s.cut_away = lit;
            assert_gap(compare(s, &even, &g.volume), modes[m] == CW_MODE_VBUFFER ? 0.2 : 2e-3);
        }
    cw_transfer edges = t;
    edges.gradient_count = 2;
    edges.gradients[0] = (cw_opacity_point){0.1, 0};
    edges.gradients[1] = (cw_opacity_point){0.8, 1};
    const cw_scene s = scene_of(&even, &edges, CW_MODE_REFERENCE);
    assert_gap(compare(s, &even, &g.volume), 2e-3);
    test_grid_free(&g);
    cw_volume_free(&even);
}

/* Every shape, warped or not, reproduces linear fields; their gradients are constant. */
static void linear_fields_are_exact_in_any_cells(void **state)
{
    (void)state;
    const cw_transfer t = soft();
    cw_volume even = even_box(6, linear);
    for (int cut = 0; cut < TEST_CUT_COUNT; cut++)
        for (int warped = 0; warped < 2; warped++)
            for (int lit = 0; lit < 2; lit++) {
                test_grid g;
                make_cells(&g, (test_cut)cut, 5, warped ? 0.25 : 0, linear);
                cw_scene s = scene_of(&even, &t, CW_MODE_REFERENCE);
                s.lit = lit;
                assert_gap(compare(s, &even, &g.volume), 3e-3);
                s.mode = CW_MODE_VBUFFER;
                assert_gap(compare(s, &even, &g.volume), 0.2);
                test_grid_free(&g);
            }
    cw_volume_free(&even);
}

/* Straight through the lattice, where rays run in faces and through edges and corners: none is
 * dropped, and none counts twice. */
static void no_ray_falls_between_cells(void **state)
{
    (void)state;
    const cw_transfer t = flat();
    const double truth = 1 - pow(1 - (double)0.05f, 20);
    for (int cut = 0; cut < TEST_CUT_COUNT; cut++)
        for (int warped = 0; warped < 2; warped++)
            for (int mode = 0; mode < 3; mode++) {
                static const cw_mode modes[] = {CW_MODE_REFERENCE, CW_MODE_VBUFFER,
                                                CW_MODE_PROJECTION};
                test_grid g;
                make_cells(&g, (test_cut)cut, 5, warped ? 0.2 : 0, one);
                cw_scene s = scene_of(&g.volume, &t, modes[mode]);
                s.camera = (cw_camera){.eye = {0, -9, 0}, .up = {0, 0, 1}, .height_mm = 1.6};
                s.width = s.height = 41; /* the middle is a plane of the lattice for none */
                for (int n = 0; n < 2; n++, s.width = s.height = 40) {
                    cw_picture p = test_draw(cpu, &s);
                    for (size_t i = 0; i < p.width * p.height; i++)
                        assert_near((double)p.pixels[4 * i + 3], truth, mode ? 1e-4 : 1e-6);
                    cw_picture_free(&p);
                }
                test_grid_free(&g);
            }
}

/* As warped cells get smaller, the picture gets to that of the field itself. */
static void warped_cells_converge(void **state)
{
    (void)state;
    const cw_transfer t = soft();
    cw_volume fine = even_box(64, waves);
    for (int cut = 0; cut < TEST_CUT_COUNT; cut++) {
        double before = INFINITY;
        srand(7);
        for (size_t n = 4; n <= 16; n *= 2) {
            test_grid g;
            make_cells(&g, (test_cut)cut, n, 0.2, waves);
            const cw_scene s = scene_of(&fine, &t, CW_MODE_VBUFFER);
            const double rmse = compare(s, &fine, &g.volume).rmse;
            if (!(rmse < before / 2.5))
                fail_msg("cut %d, %zu boxes a side: %g after %g of 255", cut, n, rmse, before);
            before = rmse;
            test_grid_free(&g);
        }
        assert_true(before < 0.6);
    }
    cw_volume_free(&fine);
}

/* The fast mode keeps to the reference, where cells are warped and the function has peaks. */
static void vbuffer_keeps_to_the_reference(void **state)
{
    (void)state;
    cw_transfer functions[2] = {soft(), test_tent_transfer()};
    functions[1].unit_mm = 0.1;
    for (int cut = 0; cut < TEST_CUT_COUNT; cut++)
        for (int n = 0; n < 4; n++) {
            test_grid g;
            make_cells(&g, (test_cut)cut, 6, 0.25, waves);
            cw_scene s = scene_of(&g.volume, &functions[n % 2], CW_MODE_REFERENCE);
            s.lit = n / 2;
            cw_picture truth = test_draw(cpu, &s);
            s.mode = CW_MODE_VBUFFER;
            cw_picture fast = test_draw(cpu, &s);
            assert_gap(test_compare(&truth, &fast), s.lit ? 1.5 : 0.3);
            cw_picture_free(&truth);
            cw_picture_free(&fast);
            test_grid_free(&g);
        }
}

/* --- projection --------------------------------------------------------------------------- */

/* Cells are cut into tetrahedra, in which linear fields are exact; light is that of the middle
 * of each. */
static void projection_is_exact_for_linear_fields(void **state)
{
    (void)state;
    cw_transfer t = soft();
    for (int cut = 0; cut < TEST_CUT_COUNT; cut++)
        for (int n = 0; n < 4; n++) {
            test_grid g;
            make_cells(&g, (test_cut)cut, 5, n % 2 ? 0.2 : 0, linear);
            cw_scene s = scene_of(&g.volume, &t, CW_MODE_REFERENCE);
            s.clip_count = 2;
            s.clips[0] = (cw_clip){{1, 0.2, 0}, -0.6};
            s.clips[1] = (cw_clip){{-1, 0.2, 0.3}, -0.7};
            s.cut_away = n / 2;
            if (n / 2)
                s.camera = (cw_camera){
                    .eye = {5, -8, 3}, .up = {0, 0, 1}, .height_mm = 4}; /* orthographic */
            cw_picture truth = test_draw(cpu, &s);
            s.mode = CW_MODE_PROJECTION;
            cw_picture p = test_draw(cpu, &s);
            assert_gap(test_compare(&truth, &p), 0.3);
            cw_picture_free(&truth);
            cw_picture_free(&p);
            test_grid_free(&g);
        }
}

/* The error falls with the square of the cells' size, and in boxes faster. */
static void projection_converges(void **state)
{
    (void)state;
    const cw_transfer t = soft();
    cw_volume fine = even_box(64, waves);
    rectilinear r;
    for (int cut = 0; cut <= TEST_CUT_COUNT; cut++) {
        double before = INFINITY;
        for (size_t n = 4; n <= 16; n *= 2) {
            test_grid g;
            cw_volume even = even_box(n, waves);
            lay_out(&r, &even, false);
            make_cells(&g, cut < TEST_CUT_COUNT ? (test_cut)cut : 0, n, 0.15, waves);
            const cw_volume *v = cut < TEST_CUT_COUNT ? &g.volume : &r.volume;
            cw_scene s = scene_of(&fine, &t, CW_MODE_REFERENCE);
            cw_picture truth = test_draw(cpu, &s);
            s.volume = v;
            s.mode = CW_MODE_PROJECTION;
            cw_picture p = test_draw(cpu, &s);
            const double rmse = test_compare(&truth, &p).rmse;
            if (!(rmse < before / 2.5))
                fail_msg("cut %d, %zu boxes a side: %g after %g of 255", cut, n, rmse, before);
            before = rmse;
            cw_picture_free(&truth);
            cw_picture_free(&p);
            test_grid_free(&g);
            cw_volume_free(&even);
        }
        assert_true(before < 0.8);
    }
    cw_volume_free(&fine);
}

/* Grids that are not convex, and cycles of cells that hide each other, are sorted exactly:
 * three bars, each over the next. */
static void projection_sorts_cycles(void **state)
{
    (void)state;
    const cw_transfer t = test_soft_transfer();
    test_grid g = {0};
    cw_renderer_forget(cpu);
    for (int bar = 0; bar < 3; bar++) {
        uint32_t c[8];
        const double angle = bar * 2 * PI / 3, x = cos(angle), y = sin(angle);
        for (int n = 0; n < 8; n++) {
            const int around = n % 4;
            const double along = around == 1 || around == 2 ? 1.6 : -1.0;
            const double side = (around > 1 ? 0.2 : -0.2) + 0.5,
                         up = 0.3 * along + (n < 4 ? -0.05 : 0.05);
            c[n] = test_grid_sample(&g, along * x - side * y, along * y + side * x, up);
        }
        test_grid_cell(&g, CW_HEXAHEDRON, c);
        for (int n = 0; n < 8; n++)
            g.values[c[n]] = 0.4 + 0.3 * bar;
    }
    cw_scene s = scene_of(&g.volume, &t, CW_MODE_REFERENCE);
    s.camera = (cw_camera){.eye = {0, 0, 9}, .up = {0, 1, 0}, .fov_deg = 25};
    cw_picture truth = test_draw(cpu, &s);
    s.mode = CW_MODE_PROJECTION;
    cw_picture p = test_draw(cpu, &s);
    assert_gap(test_compare(&truth, &p), 0.2);
    cw_picture_free(&truth);
    cw_picture_free(&p);
    test_grid_free(&g);
}

/* Light, the depth cue, a mesh and the factor of gradients are near those of the reference. */
static void projection_is_lit_and_cut_by_meshes(void **state)
{
    (void)state;
    cw_transfer t = soft();
    cw_volume even = even_box(24, waves);
    rectilinear r;
    test_grid g;
    cw_mesh m = {0};
    lay_out(&r, &even, true);
    make_cells(&g, TEST_MIXED, 20, 0.1, waves);
    test_make_cube(&m);
    for (size_t n = 0; n < 3 * m.vertex_count; n++)
        m.positions[n] = m.positions[n] * 0.8f - 0.3f;
    t.gradient_count = 2;
    t.gradients[0] = (cw_opacity_point){0.1, 0.2f};
    t.gradients[1] = (cw_opacity_point){0.8, 1};
    for (int n = 0; n < 4; n++) {
        cw_scene s = scene_of(n % 2 ? &g.volume : &r.volume, &t, CW_MODE_REFERENCE);
        s.mesh = n / 2 ? &m : NULL;
        s.lit = true;
        s.depth_cue = n / 2 ? 0 : 0.4f;
        s.background[0][2] = s.background[1][0] = 0.5f;
        cw_picture truth = test_draw(cpu, &s);
        s.mode = CW_MODE_PROJECTION;
        s.threads = 1;
        cw_picture p = test_draw(cpu, &s);
        s.threads = 3;
        cw_picture other = test_draw(cpu, &s);
        if (!(test_compare(&truth, &p).rmse < 0.5))
            fail_msg("grid %d: rmse %g, max %g", n, test_compare(&truth, &p).rmse,
                     test_compare(&truth, &p).max);
        assert_memory_equal(p.pixels, other.pixels, 16 * SIDE * SIDE);
        cw_picture_free(&truth);
        cw_picture_free(&p);
        cw_picture_free(&other);
    }
    cw_mesh_free(&m);
    test_grid_free(&g);
    cw_volume_free(&even);
}

/* --- threads, units, gaps ---------------------------------------------------------------- */

static void any_threads_draw_the_same(void **state)
{
    (void)state;
    const cw_transfer t = soft();
    test_grid g;
    make_cells(&g, TEST_MIXED, 10, 0.2, waves);
    cw_scene s = scene_of(&g.volume, &t, CW_MODE_VBUFFER);
    s.lit = true;
    s.threads = 1;
    cw_picture first = test_draw(cpu, &s);
    cw_renderer_forget(cpu);
    s.threads = 3;
    cw_picture second = test_draw(cpu, &s);
    assert_memory_equal(first.pixels, second.pixels, 16 * SIDE * SIDE);
    cw_picture_free(&first);
    cw_picture_free(&second);
    test_grid_free(&g);
}

static void any_unit_is_the_same(void **state)
{
    (void)state;
    static const double units[] = {1, 1e-4, 1e4};
    cw_picture pictures[3];
    for (int n = 0; n < 3; n++) {
        cw_transfer t = soft();
        test_grid g;
        srand(3);
        make_cells(&g, TEST_MIXED, 5, 0.2, waves);
        for (size_t i = 0; i < 3 * g.samples; i++)
            g.points[i] *= units[n];
        t.unit_mm *= units[n];
        cw_scene s = scene_of(&g.volume, &t, CW_MODE_VBUFFER);
        s.lit = true;
        for (int a = 0; a < 3; a++)
            s.camera.eye[a] *= units[n];
        pictures[n] = test_draw(cpu, &s);
        assert_gap(test_compare(&pictures[0], &pictures[n]), 0.05);
        test_grid_free(&g);
    }
    for (int n = 0; n < 3; n++)
        cw_picture_free(&pictures[n]);
}

/* A length of values that rays along y meet, of 2 mm in 4 cells: some of them are missing. */
static void expect_cells(test_grid *g, double cells)
{
    const cw_transfer t = flat();
    cw_scene s = scene_of(&g->volume, &t, CW_MODE_REFERENCE);
    s.camera = (cw_camera){.eye = {0, -9, 0}, .up = {0, 0, 1}, .height_mm = 0.3};
    for (int mode = 0; mode < 2; mode++, s.mode = CW_MODE_PROJECTION) {
        cw_picture p = test_draw(cpu, &s);
        for (size_t i = 0; i < SIDE * SIDE; i++)
            assert_near((double)p.pixels[4 * i + 3], 1 - pow(1 - (double)0.05f, 5 * cells),
                        1e-6);
        cw_picture_free(&p);
    }
}

static void holes_are_empty(void **state)
{
    (void)state;
    test_grid g;
    make_cells(&g, TEST_HEXAHEDRA, 4, 0, one);
    expect_cells(&g, 4);
    for (size_t cell = 0; cell < 64; cell++) /* a gap: rays leave and enter again */
        if (cell / 4 % 4 == 1)
            for (int c = 0; c < 8; c++)
                test_grid_corners(&g, cell)[c] = 0;
    cw_renderer_forget(cpu);
    expect_cells(&g, 3);
    for (size_t i = 0; i < g.samples; i++) /* the last layer of samples has no value */
        if (g.points[3 * i + 1] > 0.9)
            g.values[i] = i % 2 ? NAN : INFINITY;
    cw_renderer_forget(cpu);
    expect_cells(&g, 2);
    for (size_t i = 0; i < g.samples; i++)
        if (g.points[3 * i + 1] < -0.9)
            g.values[i] = -99;
    g.volume.has_nodata = true;
    g.volume.nodata = -99;
    expect_cells(&g, 1);
    test_grid_free(&g);
}

/* --- bad cells --------------------------------------------------------------------------- */

/* Files have wedges and tetrahedra of either order, and wedges as hexahedra. */
static void mirrored_and_collapsed_cells_are_whole(void **state)
{
    (void)state;
    for (int cut = 0; cut < TEST_CUT_COUNT; cut++) {
        test_grid g;
        make_cells(&g, (test_cut)cut, 4, 0, one);
        for (size_t cell = 0; cell < g.cells.count; cell += 1 + cell % 3)
            test_grid_mirror(&g, cell);
        cw_renderer_forget(cpu);
        expect_cells(&g, 4);
        test_grid_free(&g);
    }
    test_grid w, h;
    make_cells(&w, TEST_WEDGES, 4, 0, one);
    make_cells(&h, TEST_HEXAHEDRA, 4, 0, one);
    h.cells.count = 0;
    h.corner_count = 0;
    for (size_t cell = 0; cell < w.cells.count; cell++) {
        const uint32_t *c = test_grid_corners(&w, cell);
        test_grid_cell(&h, CW_HEXAHEDRON,
                       (uint32_t[8]){c[0], c[1], c[2], c[2], c[3], c[4], c[5], c[5]});
    }
    expect_cells(&h, 4);
    test_grid_free(&w);
    test_grid_free(&h);
}

/* Whatever corners and points a file has, there is a picture, and it is finite. */
static void bad_cells_do_no_harm(void **state)
{
    (void)state;
    const cw_transfer t = soft();
    srand(11);
    for (int round = 0; round < 24; round++) {
        test_grid g;
        make_cells(&g, (test_cut)(round % TEST_CUT_COUNT), 3, 0.2, waves);
        for (int n = 0; n < 20; n++) {
            const size_t cell = (size_t)rand() % g.cells.count;
            uint32_t *c = test_grid_corners(&g, cell);
            const uint32_t other = (uint32_t)((size_t)rand() % g.samples);
            switch (round % 4) {
            case 0: /* repeats a corner */
                c[rand() % 4] = c[0];
                break;
            case 1: /* is folded */
                c[0] = c[1], c[1] = other;
                break;
            case 2: /* is flat */
                c[0] = c[1] = c[2] = other;
                break;
            default: /* is nowhere */
                g.points[3 * other] = (double[]){NAN, INFINITY, 1e300, 1e-300}[n % 4];
            }
        }
        cw_scene s = scene_of(
            &g.volume, &t,
            (cw_mode[]){CW_MODE_REFERENCE, CW_MODE_VBUFFER, CW_MODE_PROJECTION}[round % 3]);
        s.lit = round / 3 % 2;
        s.width = s.height = 12;
        cw_picture p = test_draw(cpu, &s);
        for (size_t i = 0; i < 4 * 12 * 12; i++)
            assert_true(isfinite(p.pixels[i]) && p.pixels[i] > -1e-6f);
        cw_picture_free(&p);
        test_grid_free(&g);
    }
    test_grid g;
    make_cells(&g, TEST_TETRAHEDRA, 1, 0, one);
    g.cells.count = 0;
    cw_scene s = scene_of(&g.volume, &t, CW_MODE_VBUFFER);
    cw_picture p = test_draw(cpu, &s);
    assert_true(p.pixels[3] == 0);
    cw_picture_free(&p);
    test_grid_free(&g);
}

static void what_is_not_drawn_is_named(void **state)
{
    (void)state;
    const cw_transfer t = soft();
    cw_error err = {0};
    cw_picture p;
    test_grid g;
    make_cells(&g, TEST_HEXAHEDRA, 2, 0, one);
    cw_scene s = scene_of(&g.volume, &t, CW_MODE_SPLAT);
    assert_fails(
        cw_render(cpu, &s, &p, &err), CW_ERR_UNSUPPORTED,
        "the mode splat draws evenly spaced volumes; an irregular grid is drawn by mip", err);
    s.mode = CW_MODE_VBUFFER;
    g.corners[3] = 27;
    assert_fails(cw_render(cpu, &s, &p, &err), CW_ERR_ARGUMENT,
                 "cell 0 has a corner beyond the 27 samples", err);
    g.shapes[5] = 4;
    assert_fails(cw_render(cpu, &s, &p, &err), CW_ERR_ARGUMENT, "cell 5 has shape 4", err);
    test_grid_free(&g);
}

/* Wherever memory ends there is an error, and the next picture is whole. */
static void memory_may_end_anywhere(void **state)
{
    (void)state;
    const cw_transfer t = soft();
    cw_error err = {0};
    cw_picture p;
    test_grid g;
    make_cells(&g, TEST_MIXED, 3, 0.2, waves);
    cw_scene s = scene_of(&g.volume, &t, CW_MODE_VBUFFER);
    s.lit = true;
    s.threads = 1;
    s.width = s.height = 8;
    bool has_failed = true;
    for (long n = 0; n < 200 && (has_failed || s.mode == CW_MODE_VBUFFER); n++) {
        if (!has_failed) {
            s.mode = CW_MODE_PROJECTION;
            n = 0;
        }
        cw_renderer_forget(cpu);
        cwi_alloc_fail_after(n);
        const cw_status st = cw_render(cpu, &s, &p, &err);
        has_failed = cwi_alloc_fail_after(-1);
        assert_int_equal(st, has_failed ? CW_ERR_NO_MEMORY : CW_OK);
        cw_picture_free(&p);
    }
    assert_false(has_failed);
    test_grid_free(&g);
}

/* --- meshes and picking ------------------------------------------------------------------ */

static void meshes_are_in_the_volume(void **state)
{
    (void)state;
    const cw_transfer t = soft();
    cw_volume even = even_box(9, waves);
    test_grid g;
    cw_mesh m = {0};
    make_cells(&g, TEST_HEXAHEDRA, 9, 0, waves);
    test_make_cube(&m);
    for (size_t n = 0; n < 3 * m.vertex_count; n++)
        m.positions[n] = m.positions[n] * 0.8f - 0.3f;
    cw_scene s = scene_of(&even, &t, CW_MODE_REFERENCE);
    s.mesh = &m;
    assert_gap(compare(s, &even, &g.volume), 2e-3);
    cw_mesh_free(&m);
    test_grid_free(&g);
    cw_volume_free(&even);
}

static void picks_are_those_of_an_even_grid(void **state)
{
    (void)state;
    cw_transfer t = soft();
    cw_volume even = even_box(9, waves);
    test_grid g;
    rectilinear r;
    make_cells(&g, TEST_HEXAHEDRA, 9, 0, waves);
    lay_out(&r, &even, false);
    static const cw_mode modes[] = {CW_MODE_REFERENCE, CW_MODE_VBUFFER, CW_MODE_MIP,
                                    CW_MODE_MINIP,     CW_MODE_AVERAGE, CW_MODE_LOCAL_MIP};
    for (size_t m = 0; m < 2 * sizeof modes / sizeof *modes; m++)
        for (int n = 0; n < 9; n++) {
            cw_scene s = scene_of(&even, &t, modes[m / 2]);
            const double at[2] = {4 + 4.3 * (n % 3 * 3 + 1), 4 + 3.9 * (n / 3 * 3 + 1)};
            cw_error err = {0};
            cw_picked a, b;
            s.intensity.threshold = 0.6;
            t.gradient_count = m % 2 ? 2 : 0;
            t.gradients[0] = (cw_opacity_point){0.1, 0.3f};
            t.gradients[1] = (cw_opacity_point){0.8, 1};
            assert_ok(cw_pick(&s, at, &a, &err), err);
            for (int kind = 0; kind < 2; kind++) {
                s.volume = kind ? &g.volume : &r.volume;
                assert_ok(cw_pick(&s, at, &b, &err), err);
                assert_int_equal(a.kind, b.kind);
                for (int k = 0; k < 3; k++)
                    assert_near(b.point[k], a.point[k], 1e-4);
                assert_near(b.value, a.value, 1e-4);
                assert_near(b.depth_mm, a.depth_mm, 1e-4);
            }
        }
    test_grid_free(&g);
    cw_volume_free(&even);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(even_coordinates_are_an_even_grid),
        cmocka_unit_test(bent_coordinates_have_linear_fields),
        cmocka_unit_test(flat_rectilinear_grids_are_slabs),
        cmocka_unit_test(boxes_are_an_even_grid),
        cmocka_unit_test(linear_fields_are_exact_in_any_cells),
        cmocka_unit_test(no_ray_falls_between_cells),
        cmocka_unit_test(warped_cells_converge),
        cmocka_unit_test(vbuffer_keeps_to_the_reference),
        cmocka_unit_test(projection_is_exact_for_linear_fields),
        cmocka_unit_test(projection_converges),
        cmocka_unit_test(projection_sorts_cycles),
        cmocka_unit_test(projection_is_lit_and_cut_by_meshes),
        cmocka_unit_test(any_threads_draw_the_same),
        cmocka_unit_test(any_unit_is_the_same),
        cmocka_unit_test(holes_are_empty),
        cmocka_unit_test(mirrored_and_collapsed_cells_are_whole),
        cmocka_unit_test(bad_cells_do_no_harm),
        cmocka_unit_test(what_is_not_drawn_is_named),
        cmocka_unit_test(memory_may_end_anywhere),
        cmocka_unit_test(meshes_are_in_the_volume),
        cmocka_unit_test(picks_are_those_of_an_even_grid),
    };
    return cmocka_run_group_tests(tests, open_renderer, close_renderer);
}
