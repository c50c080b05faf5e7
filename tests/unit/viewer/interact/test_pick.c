/* Tests picking: in blended volumes, extremes, slices, and meshes. */
#include "support/pictures.h"
#include "support/rays.h"
#include "support/views.h"

#include "viewer/cpu/reference_volume.h"

#include <math.h>
#include <string.h>

enum { WIDTH = 40, HEIGHT = 30 };

static const double spacing[3] = {1, 1.5, 0.8};

static cw_scene scene_of(cw_mode mode, const cw_volume *volume, const cw_transfer *transfer,
                         bool flat)
{
    return (cw_scene){.mode = mode,
                      .volume = volume,
                      .transfer = transfer,
                      .camera = test_view(35, 20, flat ? 0 : 40, 50),
                      .width = WIDTH,
                      .height = HEIGHT};
}

static cw_picked pick(const cw_scene *scene, double x, double y)
{
    cw_error err = {0};
    cw_picked p;
    assert_ok(cw_pick(scene, (const double[2]){x, y}, &p, &err), err);
    if (p.kind != CW_PICK_NOTHING) {
        double pixel[2], depth;
        assert_true(cw_camera_project(&scene->camera, WIDTH, HEIGHT, p.point, pixel, &depth));
        assert_near(pixel[0], x, 1e-6);
        assert_near(pixel[1], y, 1e-6);
        assert_near(p.depth_mm, depth, 1e-8);
    }
    return p;
}

/* At a point that the camera sees. */
static cw_picked pick_at(const cw_scene *scene, const double point[3])
{
    double pixel[2];
    assert_true(cw_camera_project(&scene->camera, WIDTH, HEIGHT, point, pixel, NULL));
    return pick(scene, pixel[0], pixel[1]);
}

static double distance(const double a[3], const double b[3])
{
    return hypot(hypot(a[0] - b[0], a[1] - b[1]), a[2] - b[2]);
}

/* Checks that the reference's ray has covered a half up to the picked point. */
static void assert_half_is_before(const cw_scene *scene, double x, double y, const cw_picked *p)
{
    const cwi_frame frame = test_frame(scene);
    cwi_reference reference;
    double out[4];
    const double samples = frame.scene.samples;
    cwi_reference_make(&frame, NULL, &reference);
    cwi_reference_ray(&reference, NULL, samples * x, samples * y, p->depth_mm / frame.unit_mm,
                      out);
    assert_near(out[3], 0.5, 2e-3);
    assert_near(p->value, cw_volume_sample(scene->volume, p->point), 1e-6);
}

static double whole_opacity(const cw_scene *scene, double x, double y)
{
    const cwi_frame frame = test_frame(scene);
    cwi_reference reference;
    double out[4];
    const double samples = frame.scene.samples;
    cwi_reference_make(&frame, NULL, &reference);
    cwi_reference_ray(&reference, NULL, samples * x, samples * y, INFINITY, out);
    return out[3];
}

/* A ray's first point may be rounded to beyond the face that it enters by; its value is still
 * there. Up to the picture's edges something is met. */
static void what_stands_on_a_face_has_a_value(void **state)
{
    (void)state;
    cw_volume box = {0};
    const cw_transfer flat = test_flat_transfer();
    test_field(&box, 24, 33, 20, (const double[3]){0.7, 1.1, 0.9}, test_constant);
    const double value = cw_volume_value(&box, 0, 0, 0);
    for (int mode = 0; mode < 2; mode++) {
        cw_scene scene = scene_of(mode ? CW_MODE_SLICES : CW_MODE_MIP, &box, &flat, mode == 0);
        scene.camera.height_mm = 6;
        scene.camera.fov_deg = mode ? 6 : 0;
        for (int y = 0; y <= 2 * HEIGHT; y++)
            for (int x = 0; x <= 2 * WIDTH; x++) {
                const cw_picked p = pick(&scene, x / 2.0, y / 2.0);
                assert_int_equal(p.kind, mode ? CW_PICK_SLICE : CW_PICK_VOLUME);
                assert_near(p.value, value, 1e-6);
            }
    }
    cw_volume_free(&box);
}

/* Every transfer function, with and without a factor of gradients, clipped and not. */
static void what_blends_is_where_half_is_covered(void **state)
{
    (void)state;
    cw_volume v;
    size_t met = 0, thin = 0, missed = 0;
    test_field(&v, 24, 20, 28, spacing, test_blobs);
    for (int setting = 0; setting < 12; setting++) {
        cw_transfer t = setting % 3 == 0   ? test_soft_transfer()
                        : setting % 3 == 1 ? test_tent_transfer()
                                           : test_flat_transfer();
        cw_scene scene = scene_of(CW_MODE_COMPOSITE, &v, &t, false);
        t.unit_mm = 0.3;
        scene.camera = test_view(35, 20, setting & 1 ? 0 : 40, 32);
        if (setting >= 6) {
            t.gradient_count = 2;
            t.gradients[1] = (cw_opacity_point){0.2, 1};
        }
        scene.samples = setting % 4 == 3 ? 2 : 1;
        scene.clip_count = setting % 5 == 1;
        scene.clips[0] = (cw_clip){{1, -0.5, 0.2}, 1};
        for (int k = 0; k < 60; k++) {
            const double x = k * 7 % WIDTH + 0.3, y = k * 11 % HEIGHT + 0.6;
            const cw_picked p = pick(&scene, x, y);
            const double opacity = whole_opacity(&scene, x, y);
            if (opacity >= 0.502) {
                assert_int_equal(p.kind, CW_PICK_VOLUME);
                assert_half_is_before(&scene, x, y, &p);
                met++;
            } else if (opacity < 0.0019) {
                assert_int_equal(p.kind, CW_PICK_NOTHING);
                missed++;
            } else if (opacity > 0.002) {
                assert_int_equal(p.kind, CW_PICK_VOLUME);
                thin++;
            }
        }
    }
    assert_true(met > 50 && thin > 50 && missed > 50);
    cw_volume_free(&v);
}

/* Of a haze with a shell that never covers half, the shell is picked. */
static void the_most_of_little_is_found(void **state)
{
    (void)state;
    cw_volume v;
    test_field(&v, 32, 8, 8, (const double[3]){1, 1, 1}, test_ramp);
    const cw_transfer t = {.opacity_count = 6,
                           .opacities = {{0, 0.001f},
                                         {0.58, 0.001f},
                                         {0.59, 0.2f},
                                         {0.61, 0.2f},
                                         {0.62, 0.001f},
                                         {1, 0.001f}}};
    cw_scene scene = scene_of(CW_MODE_REFERENCE, &v, &t, false);
    scene.camera = (cw_camera){{-100, 1, 2}, {0, 1, 2}, {0, 0, 1}, .fov_deg = 20};
    const cw_picked p = pick(&scene, 20, 15);
    assert_int_equal(p.kind, CW_PICK_VOLUME);
    assert_near(p.value, 0.6, 0.025);
    cw_volume_free(&v);
}

static cw_volume with_points(double low, double at_front, double at_back)
{
    cw_volume v;
    test_field(&v, 11, 15, 11, spacing, test_constant);
    float *voxels = cw_volume_voxels(&v);
    for (size_t n = 0; n < 11 * 15 * 11; n++)
        voxels[n] = (float)low;
    voxels[(5 * 15 + 3) * 11 + 5] = (float)at_front;
    voxels[(5 * 15 + 11) * 11 + 5] = (float)at_back;
    return v;
}

/* Two voxels on one line of sight, from the front: 10 is nearer than 20. */
static void extremes_are_where_they_are(void **state)
{
    (void)state;
    const cw_transfer grey = test_flat_transfer();
    double points[2][3];
    for (int flat = 0; flat < 2; flat++) {
        cw_volume v = with_points(1, 10, 20);
        cw_volume_to_world(&v, (const double[3]){5, 3, 5}, points[0]);
        cw_volume_to_world(&v, (const double[3]){5, 11, 5}, points[1]);
        cw_scene scene = scene_of(CW_MODE_MIP, &v, &grey, flat);
        scene.camera.eye[0] = scene.camera.eye[2] = 0;
        cw_picked p = pick_at(&scene, points[1]);
        assert_true(p.kind == CW_PICK_VOLUME && distance(p.point, points[1]) < 1e-6);
        assert_near(p.value, 20, 1e-5);
        scene.mode = CW_MODE_AVERAGE;
        p = pick_at(&scene, points[1]);
        assert_true(distance(p.point, points[1]) < 1e-6);
        scene.mode = CW_MODE_LOCAL_MIP;
        scene.intensity.threshold = 5;
        p = pick_at(&scene, points[1]);
        assert_true(distance(p.point, points[0]) < 1e-6);
        assert_near(p.value, 10, 1e-5);
        scene.intensity.threshold = 15;
        p = pick_at(&scene, points[1]);
        assert_true(distance(p.point, points[1]) < 1e-6);
        cw_volume_free(&v);
        v = with_points(1, 0.5, 0.25);
        scene.mode = CW_MODE_MINIP;
        p = pick_at(&scene, points[1]);
        assert_true(distance(p.point, points[1]) < 1e-6);
        scene.clip_count = 1;
        scene.clips[0] = (cw_clip){{0, -1, 0}, 0};
        p = pick_at(&scene, points[1]);
        assert_true(distance(p.point, points[0]) < 1e-6);
        assert_int_equal(pick(&scene, 1, 1).kind, CW_PICK_NOTHING);
        cw_volume_free(&v);
    }
}

/* Air of 0 before and behind a slab, with a hollow in it: minip inside picks the hollow, and in
 * a solid slab the place where the ray reaches the threshold. */
static void minimum_inside_is_picked_inside(void **state)
{
    (void)state;
    const cw_transfer grey = test_flat_transfer();
    cw_volume v;
    test_field(&v, 11, 21, 11, (const double[3]){1, 1, 1}, test_constant);
    float *voxels = cw_volume_voxels(&v);
    for (size_t n = 0; n < 11 * 21 * 11; n++)
        voxels[n] = n / 11 % 21 < 5 || n / 11 % 21 > 15 ? 0 : n / 11 % 21 == 9 ? 0.25f : 1;
    for (int hollow = 1; hollow >= 0; hollow--) {
        cw_scene scene = scene_of(CW_MODE_MINIP, &v, &grey, true);
        scene.camera = test_view(0, 0, 0, 50);
        scene.intensity.minip_inside = true;
        scene.intensity.threshold = 0.5;
        for (size_t n = 0; n < 11 * 21 * 11 && !hollow; n++)
            voxels[n] = voxels[n] > 0 ? 1 : 0;
        const double middle[3] = {0.3, 0, 0.4};
        const cw_picked p = pick_at(&scene, middle);
        assert_int_equal(p.kind, CW_PICK_VOLUME);
        assert_near(p.value, hollow ? 0.25 : 0.5, 1e-6);
        assert_near(fabs(p.point[1]), hollow ? 1 : 5.5, 1e-6);
        scene.intensity.threshold = 1.5;
        double pixel[2];
        assert_true(cw_camera_project(&scene.camera, WIDTH, HEIGHT, middle, pixel, NULL));
        assert_int_equal(pick(&scene, pixel[0], pixel[1]).kind, CW_PICK_NOTHING);
    }
    cw_volume_free(&v);
}

static void slices_are_hit_nearest_first(void **state)
{
    (void)state;
    cw_volume v;
    const cw_transfer grey = test_flat_transfer();
    test_field(&v, 21, 21, 21, (const double[3]){1, 1, 1}, test_ramp);
    for (int flat = 0; flat < 2; flat++) {
        cw_scene scene = scene_of(CW_MODE_SLICES, &v, &grey, flat);
        scene.slice_count = 3;
        scene.slices[0] = (cw_slice){{0, 4, 0}, 20};  /* y = 5 */
        scene.slices[1] = (cw_slice){{0, -1, 0}, 5};  /* y = -5 */
        scene.slices[2] = (cw_slice){{0, 1, 0}, -10}; /* the volume's face */
        const double point[3] = {3, -5, 2};
        cw_picked p = pick_at(&scene, point);
        assert_int_equal(p.kind, CW_PICK_SLICE);
        assert_int_equal(p.number, 2);
        assert_near(p.point[1], -10, 1e-9);
        assert_near(p.value, (p.point[0] + 10) / 20, 1e-6);
        scene.clip_count = 1;
        scene.clips[0] = (cw_clip){{0, 1, 0}, -5}; /* in the slice, which is still drawn */
        p = pick_at(&scene, point);
        assert_int_equal(p.number, 1);
        assert_true(distance(p.point, point) < 1e-9);
        scene.clips[0].distance_mm = -4;
        p = pick_at(&scene, point);
        assert_int_equal(p.number, 0);
        assert_near(p.point[1], 5, 1e-9);
        scene.cut_away = true;
        scene.clips[0].distance_mm = -7;
        assert_int_equal(pick_at(&scene, point).number, 2);
        scene.slice_count = 1;
        assert_int_equal(pick_at(&scene, point).kind, CW_PICK_NOTHING);
        scene.slice_count = 0; /* axial, coronal, sagittal */
        scene.clip_count = 0;
        p = pick_at(&scene, (const double[3]){6, -4, 0});
        assert_int_equal(p.kind, CW_PICK_SLICE);
    }
    cw_volume_free(&v);
}

static cw_volume gap(void)
{
    cw_volume v;
    test_field(&v, 21, 21, 21, (const double[3]){1, 1, 1}, test_ramp);
    float *voxels = cw_volume_voxels(&v);
    voxels[(10 * 21 + 10) * 21 + 10] = NAN;
    return v;
}

static void slices_have_holes_where_there_is_no_value(void **state)
{
    (void)state;
    cw_volume v = gap();
    const cw_transfer grey = test_flat_transfer();
    cw_scene scene = scene_of(CW_MODE_SLICES, &v, &grey, false);
    scene.slice_count = 2;
    scene.slices[0] = (cw_slice){{0, 1, 0}, 0.5};
    scene.slices[1] = (cw_slice){{0, 1, 0}, 4.5};
    assert_int_equal(pick_at(&scene, (const double[3]){0.3, 0.5, 0.4}).number, 1);
    assert_int_equal(pick_at(&scene, (const double[3]){1.3, 0.5, 0.4}).number, 0);
    cw_volume_free(&v);
}

static void make_sphere(cw_mesh *mesh, float radius)
{
    cw_error err = {0};
    const cw_field_desc desc = {.field = CW_FIELD_SPHERE, .dim = {41, 41, 41}, .type = CW_F32};
    cw_volume v;
    assert_ok(cw_field_sample(&desc, &v, &err), err);
    const double size = (double)radius / 30;
    for (int a = 0; a < 3; a++)
        for (int b = 0; b < 4; b++)
            v.affine[a][b] *= size;
    *mesh = (cw_mesh){0};
    assert_ok(cw_extract(&v, NULL, mesh, NULL, &err), err);
    cw_volume_free(&v);
}

/* Where a line meets a sphere around 0, near and far; false: it passes. */
static bool meet_sphere(const cw_camera *c, double x, double y, double radius, double t[2],
                        double line[2][3])
{
    cw_error err = {0};
    double along = 0, square = -radius * radius;
    assert_ok(cw_camera_ray(c, WIDTH, HEIGHT, (const double[2]){x, y}, line[0], line[1], &err),
              err);
    for (int a = 0; a < 3; a++) {
        along += line[0][a] * line[1][a];
        square += line[0][a] * line[0][a];
    }
    const double root = along * along - square;
    t[0] = -along - sqrt(root);
    t[1] = -along + sqrt(root);
    return root >= 0;
}

/* Of a sphere and of one that is cut open: its inside, or what fills the cut. */
static void meshes_are_hit_nearest_first(void **state)
{
    (void)state;
    cw_mesh mesh = {0};
    const int step = test_is_short() ? 5 : 1;
    int hits = 0, cuts = 0;
    make_sphere(&mesh, 15);
    for (int way = 0; way < 8; way++) {
        cw_scene scene = scene_of(CW_MODE_MESH, NULL, NULL, way & 1);
        scene.mesh = &mesh;
        scene.clip_count = way >= 2;
        scene.clips[0] = (cw_clip){{-1, 2, 0}, 4};
        scene.mesh_look.cap = way >= 4;
        scene.cut_away = way >= 6;
        if (way >= 6)
            scene.clips[0] = (cw_clip){{1, -2, 0}, -4};
        for (int y = 0; y < HEIGHT; y += step)
            for (int x = y % 2; x < WIDTH; x += 2) {
                double t[2], line[2][3], at[2] = {0}, want[3];
                const bool met = meet_sphere(&scene.camera, x + 0.5, y + 0.5, 15, t, line);
                const cw_picked p = pick(&scene, x + 0.5, y + 0.5);
                if (met && t[1] - t[0] < 4)
                    continue; /* triangles are not quite a sphere */
                for (int a = 0; a < 2; a++) {
                    at[0] += (a ? 2 : -1) * line[0][a];
                    at[1] += (a ? 2 : -1) * line[1][a];
                }
                const double cut = (4 - at[0]) / at[1];
                const bool enters = way >= 2 && cut > t[0];
                const bool is_cap = enters && way >= 4;
                if (!met || (enters && cut > t[1])) {
                    assert_int_equal(p.kind, CW_PICK_NOTHING);
                    continue;
                }
                if (way >= 2 && (fabs(cut - t[0]) < 0.3 || fabs(cut - t[1]) < 0.3))
                    continue;
                for (int a = 0; a < 3; a++)
                    want[a] = line[0][a] + (is_cap ? cut : enters ? t[1] : t[0]) * line[1][a];
                assert_int_equal(p.kind, CW_PICK_MESH);
                assert_true(distance(p.point, want) < (is_cap ? 1e-9 : 0.2));
                assert_int_equal(p.number == SIZE_MAX, is_cap);
                hits += !is_cap;
                cuts += is_cap;
            }
    }
    assert_true(hits * step > 300 && cuts * step > 300);
    cw_mesh_free(&mesh);
}

/* Two squares and a mesh of half opacity between them: what is not drawn is not hit. */
static void clear_triangles_are_looked_through(void **state)
{
    (void)state;
    static float points[36];
    static uint32_t triangles[18];
    static uint8_t colors[48];
    for (uint32_t n = 0; n < 12; n++) {
        points[3 * n] = n % 2 ? 4 : -4;
        points[3 * n + 1] = (float)(2 * (n / 4)); /* away from the camera */
        points[3 * n + 2] = n / 2 % 2 ? 4 : -4;
    }
    for (uint32_t n = 0; n < 18; n++) {
        static const uint32_t corners[6] = {0, 1, 2, 1, 3, 2};
        triangles[n] = n / 6 * 4 + corners[n % 6];
    }
    const cw_mesh squares = {.vertex_count = 12,
                             .triangle_count = 6,
                             .positions = points,
                             .triangles = triangles,
                             .colors = colors};
    cw_scene scene = scene_of(CW_MODE_MESH, NULL, NULL, true);
    scene.mesh = &squares;
    scene.camera = (cw_camera){{0, -50, 0}, {0, 0, 0}, {0, 0, 1}, .height_mm = 30};
    for (int clear = 0; clear <= 3; clear++) { /* of the squares, from the front */
        for (int n = 0; n < 12; n++)
            colors[4 * n + 3] = n / 4 < clear ? 0 : 128;
        const cw_picked p = pick(&scene, 19, 14);
        assert_int_equal(p.kind, clear < 3 ? CW_PICK_MESH : CW_PICK_NOTHING);
        if (clear < 3)
            assert_near(p.point[1], 2 * clear, 1e-9);
    }
    colors[3] = 1; /* a corner of the first: it fades to 0 along the diagonal */
    assert_near(pick(&scene, 19, 16).point[1], 0, 1e-9);
    assert_int_equal(pick(&scene, 21, 14).kind, CW_PICK_NOTHING);
    scene.mesh_look.tint = CW_TINT_QUALITY; /* the mesh's colours are not used */
    assert_int_equal(pick(&scene, 21, 14).kind, CW_PICK_MESH);
    scene.mesh_look.color[0] = 1; /* without opacity */
    assert_int_equal(pick(&scene, 21, 14).kind, CW_PICK_NOTHING);
}

/* A cube from straight on: rays through edges, corners and diagonals meet it, and of its inside
 * there is no doubt either. */
static void edges_have_no_cracks(void **state)
{
    (void)state;
    static float points[24] = {-4, -4, -4, 4, -4, -4, -4, 4, -4, 4, 4, -4,
                               -4, -4, 4,  4, -4, 4,  -4, 4, 4,  4, 4, 4};
    static uint32_t triangles[36] = {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                                     2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};
    float scalars[8];
    const cw_mesh cube = {.vertex_count = 8,
                          .triangle_count = 12,
                          .positions = points,
                          .triangles = triangles,
                          .scalars = scalars};
    for (int n = 0; n < 8; n++)
        scalars[n] = points[3 * n] + 10;
    cw_scene scene = scene_of(CW_MODE_MESH, NULL, NULL, true);
    scene.mesh = &cube;
    scene.camera = (cw_camera){{0, -50, 0}, {0, 0, 0}, {0, 0, 1}, .height_mm = 30};
    for (int cut = 0; cut < 2; cut++) {
        scene.clip_count = (size_t)cut;
        scene.mesh_look.cap = true;
        scene.clips[0] = (cw_clip){{0, 1, 0}, 1};
        for (double y = 11.5; y <= 18.5; y += 0.5)
            for (double x = 16.5; x <= 23.5; x += 0.5) {
                const cw_picked p = pick(&scene, x, y);
                assert_int_equal(p.kind, CW_PICK_MESH);
                assert_near(p.point[1], cut ? 1 : -4, 1e-9);
                if (cut)
                    assert_true(isnan(p.value));
                else
                    assert_near(p.value, x - 20 + 10, 1e-6);
            }
        assert_int_equal(pick(&scene, 25, 15).kind, CW_PICK_NOTHING);
    }
}

/* A mesh in a haze: before it, behind what covers half, and behind a maximum. */
static void of_mesh_and_volume_the_nearer_is_seen(void **state)
{
    (void)state;
    cw_volume v;
    cw_mesh mesh = {0};
    cw_transfer haze = test_flat_transfer();
    make_sphere(&mesh, 4);
    test_field(&v, 21, 21, 21, (const double[3]){1, 1, 1}, test_ramp);
    cw_scene scene = scene_of(CW_MODE_COMPOSITE, &v, &haze, false);
    scene.mesh = &mesh;
    const double middle[3] = {0};
    cw_picked p = pick_at(&scene, middle);
    assert_int_equal(p.kind, CW_PICK_MESH);
    assert_near(distance(p.point, middle), 4, 0.1);
    haze.opacities[0].opacity = 0.4f;
    p = pick_at(&scene, middle);
    assert_int_equal(p.kind, CW_PICK_VOLUME);
    assert_true(distance(p.point, middle) > 8);
    haze.opacities[0].opacity = 0.05f;
    scene.mode = CW_MODE_MIP;
    p = pick_at(&scene, middle);
    assert_int_equal(p.kind, CW_PICK_VOLUME);
    assert_true(distance(p.point, middle) > 3.8);
    scene.mode = CW_MODE_SLICES;
    assert_int_equal(pick_at(&scene, middle).kind, CW_PICK_MESH);
    const double on_slice[3] = {6, 0, 6};
    assert_int_equal(pick_at(&scene, on_slice).kind, CW_PICK_SLICE);
    scene.mode = CW_MODE_COMPOSITE;
    memcpy(scene.mesh_look.color, (const float[4]){1, 1, 1, 0}, sizeof scene.mesh_look.color);
    assert_int_equal(pick_at(&scene, middle).kind, CW_PICK_VOLUME);
    cw_mesh_free(&mesh);
    cw_volume_free(&v);
}

static void impossible_places_are_refused(void **state)
{
    (void)state;
    cw_error err = {0};
    cw_volume v;
    cw_picked p;
    const cw_transfer flat = test_flat_transfer();
    test_field(&v, 5, 5, 5, spacing, test_ramp);
    cw_scene scene = scene_of(CW_MODE_COMPOSITE, &v, &flat, false);
    assert_fails(cw_pick(&scene, (const double[2]){NAN, 0}, &p, &err), CW_ERR_ARGUMENT, "nan",
                 err);
    assert_ok(cw_pick(&scene, (const double[2]){-1, 3}, &p, &err), err);
    assert_int_equal(p.kind, CW_PICK_NOTHING);
    assert_ok(cw_pick(&scene, (const double[2]){20, HEIGHT + 1}, &p, &err), err);
    assert_int_equal(p.kind, CW_PICK_NOTHING);
    scene.transfer = NULL;
    assert_fails(cw_pick(&scene, (const double[2]){1, 1}, &p, &err), CW_ERR_ARGUMENT,
                 "needs a volume and a transfer function", err);
    scene = scene_of(CW_MODE_SLICES, &v, &flat, false);
    scene.slice_count = 1;
    assert_fails(cw_pick(&scene, (const double[2]){1, 1}, &p, &err), CW_ERR_ARGUMENT,
                 "no direction", err);
    cw_volume_free(&v);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_stands_on_a_face_has_a_value),
        cmocka_unit_test(what_blends_is_where_half_is_covered),
        cmocka_unit_test(the_most_of_little_is_found),
        cmocka_unit_test(extremes_are_where_they_are),
        cmocka_unit_test(minimum_inside_is_picked_inside),
        cmocka_unit_test(slices_are_hit_nearest_first),
        cmocka_unit_test(slices_have_holes_where_there_is_no_value),
        cmocka_unit_test(meshes_are_hit_nearest_first),
        cmocka_unit_test(clear_triangles_are_looked_through),
        cmocka_unit_test(edges_have_no_cracks),
        cmocka_unit_test(of_mesh_and_volume_the_nearer_is_seen),
        cmocka_unit_test(impossible_places_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
