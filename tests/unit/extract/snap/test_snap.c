/* Snapping: the needles go, and nothing else does. Topology, the promise and the distance from
 * the surface without it are compared with what is reported. cgal/ looks at snapped surfaces,
 * too. */
#include "support/hostile.h"
#include "support/surface.h"

#include "core/base/memory.h"
#include "extract/dense/isa_dispatch.h"
#include "extract/extract_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Two surfaces of one volume: as extracted, and snapped. */
typedef struct pair {
    cw_mesh plain, snapped;
    cw_extract_counts before, after;
} pair;

static pair extract_pair(const cw_volume *v, cw_extract_desc d, double snap)
{
    pair p;
    d.snap = 0;
    p.plain = test_extract(v, &d, &p.before);
    d.snap = snap;
    p.snapped = test_extract(v, &d, &p.after);
    return p;
}

static void free_pair(pair *p)
{
    cw_mesh_free(&p->plain);
    cw_mesh_free(&p->snapped);
}

static void corners(const cw_mesh *mesh, size_t t, double p[3][3])
{
    for (size_t c = 0; c < 3; c++)
        for (size_t a = 0; a < 3; a++)
            p[c][a] = (double)mesh->positions[3 * (size_t)mesh->triangles[3 * t + c] + a];
}

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Degrees. */
static double smallest_angle(double p[3][3])
{
    double smallest = 180;
    for (int c = 0; c < 3; c++) {
        double u[3], v[3];
        for (int a = 0; a < 3; a++) {
            u[a] = p[(c + 1) % 3][a] - p[c][a];
            v[a] = p[(c + 2) % 3][a] - p[c][a];
        }
        smallest = fmin(smallest, acos(dot(u, v) / sqrt(dot(u, u) * dot(v, v))) * 180 / PI);
    }
    return smallest;
}

/* Returns the share of triangles with an angle below `degrees`; and the smallest angle. */
static double share_below(const cw_mesh *mesh, double degrees, double *smallest)
{
    size_t count = 0;
    *smallest = 180;
    for (size_t t = 0; t < mesh->triangle_count; t++) {
        double p[3][3];
        corners(mesh, t, p);
        const double angle = smallest_angle(p);
        count += angle < degrees;
        *smallest = fmin(*smallest, angle);
    }
    return (double)count / (double)mesh->triangle_count;
}

static double clamp(double x)
{
    return x < 0 ? 0 : x > 1 ? 1 : x;
}

/* Square of the distance of a point from a triangle: by halving, with no geometry shared with
 * the library. f(s, t) = |p0 + s u + t v - point|^2 is convex; so is its least over t. */
static double distance_to(double p[3][3], const double point[3])
{
    double u[3], v[3], w[3], low = 0, high = 1, least = INFINITY;
    for (int a = 0; a < 3; a++) {
        u[a] = p[1][a] - p[0][a];
        v[a] = p[2][a] - p[0][a];
        w[a] = p[0][a] - point[a];
    }
    for (int step = 0; step < 40; step++) {
        double f[2];
        const double s[2] = {low + (high - low) * 0.49, low + (high - low) * 0.51};
        for (int n = 0; n < 2; n++) {
            double d[3], t = -(dot(w, v) + s[n] * dot(u, v)) / dot(v, v);
            t = (1 - s[n]) * clamp(s[n] < 1 ? t / (1 - s[n]) : 0);
            for (int a = 0; a < 3; a++)
                d[a] = w[a] + s[n] * u[a] + t * v[a];
            f[n] = dot(d, d);
            least = fmin(least, f[n]);
        }
        if (f[0] < f[1])
            high = s[1];
        else
            low = s[0];
    }
    return least;
}

/* Whether a box around a triangle is within a distance of a point. */
static bool may_be_nearer(double p[3][3], const double point[3], double distance)
{
    for (int a = 0; a < 3; a++)
        if (fmin(fmin(p[0][a], p[1][a]), p[2][a]) > point[a] + distance ||
            fmax(fmax(p[0][a], p[1][a]), p[2][a]) < point[a] - distance)
            return false;
    return true;
}

/* Of a vertex of one mesh from the surface of another. */
static double distance_from(const cw_mesh *mesh, const float *vertex)
{
    const double point[3] = {(double)vertex[0], (double)vertex[1], (double)vertex[2]};
    double distance = INFINITY, p[3][3];
    for (size_t v = 0; v < mesh->vertex_count && distance > 0; v++) {
        const float *q = mesh->positions + 3 * v;
        const double d[3] = {(double)q[0] - point[0], (double)q[1] - point[1],
                             (double)q[2] - point[2]};
        distance = fmin(distance, sqrt(dot(d, d)));
    }
    for (size_t t = 0; t < mesh->triangle_count && distance > 0; t++) {
        corners(mesh, t, p);
        if (may_be_nearer(p, point, distance))
            distance = fmin(distance, sqrt(distance_to(p, point)));
    }
    return distance;
}

/* Everything but the shape is as it was. */
static const char *change(const pair *p, bool open)
{
    cw_quality q[2];
    if (cw_quality_measure(&p->plain, NULL, &q[0], NULL) != CW_OK)
        return "the plain surface cannot be measured";
    const char *fault = test_mesh_fault(&p->snapped, open, &q[1]);
    return fault                                             ? fault
           : q[0].components != q[1].components              ? "other components"
           : q[0].euler != q[1].euler                        ? "another Euler number"
           : q[0].open_edges != q[1].open_edges              ? "another border"
           : p->before.border_loops != p->after.border_loops ? "other border loops"
           : p->after.triangles != p->snapped.triangle_count ? "a wrong count of triangles"
           : p->after.vertices != p->snapped.vertex_count    ? "a wrong count of vertices"
                                                             : NULL;
}

/* ---- smooth fields ---------------------------------------------------------------------- */

static const struct {
    cw_field field;
    bool open, cubic;
} smooth[] = {{CW_FIELD_SPHERE, false, false},        {CW_FIELD_TORUS, false, false},
              {CW_FIELD_GYROID, false, false},        {CW_FIELD_GYROID, true, false},
              {CW_FIELD_MARSCHNER_LOBB, true, false}, {CW_FIELD_CT_HEAD, false, false},
              {CW_FIELD_TORUS, false, true},          {CW_FIELD_GYROID, true, true}};

enum { SMOOTH = sizeof smooth / sizeof *smooth };

static pair extract_smooth(int n, size_t size, double snap)
{
    const cw_field field = smooth[n].field;
    cw_volume v = test_sample(field, size, CW_F32);
    const cw_extract_desc d = {.isovalue = cw_field_isovalue(field),
                               .leave_open = smooth[n].open,
                               .cubic_placement = smooth[n].cubic};
    pair p = extract_pair(&v, d, snap);
    cw_volume_free(&v);
    return p;
}

static void needles_go_and_topology_stays(void **state)
{
    (void)state;
    for (int n = 0; n < SMOOTH; n++) {
        pair p = extract_smooth(n, 48, 0.4);
        double smallest[2];
        const double before = share_below(&p.plain, 10, &smallest[0]),
                     after = share_below(&p.snapped, 10, &smallest[1]);
        if (change(&p, smooth[n].open))
            fail_msg("%s: %s", cw_field_name(smooth[n].field), change(&p, smooth[n].open));
        assert_true(before > 0.05);
        assert_true(after < 0.2 * before);
        assert_true(smallest[1] >= smallest[0]);
        assert_true((double)p.after.triangles < 0.8 * (double)p.before.triangles);
        free_pair(&p);
    }
}

static void a_sphere_and_a_torus_are_left_without_needles(void **state)
{
    (void)state;
    for (int n = 0; n < 2; n++) {
        pair p = extract_smooth(n, 64, 0.5);
        double smallest;
        assert_true(share_below(&p.snapped, 20, &smallest) < 0.01);
        assert_true(smallest > 10);
        assert_true(test_normals_agree(&p.snapped));
        free_pair(&p);
    }
}

/* Merged vertices are put on the field's surface: as far from a true sphere as others. */
static void a_snapped_sphere_is_as_round(void **state)
{
    (void)state;
    pair p = extract_smooth(0, 40, 0.3);
    double farthest[2] = {0, 0};
    const cw_mesh *meshes[2] = {&p.plain, &p.snapped};
    for (int m = 0; m < 2; m++)
        for (size_t v = 0; v < meshes[m]->vertex_count; v++) {
            double x[3];
            for (size_t a = 0; a < 3; a++)
                x[a] = (double)meshes[m]->positions[3 * v + a] + meshes[m]->origin[a];
            farthest[m] = fmax(farthest[m], fabs(sqrt(dot(x, x)) - 30));
        }
    assert_true(farthest[1] < 1.2 * farthest[0]);
    assert_within(test_check_promise(&p.snapped, false).volume_mm3, 4.0 / 3 * PI * 27000, 0.01);
    free_pair(&p);
}

/* The distances of all vertices there were from the surface there is now. */
static void the_error_reported_is_the_error(void **state)
{
    (void)state;
    for (int n = 0; n < SMOOTH; n++) {
        const double snap = 0.3;
        pair p = extract_smooth(n, test_is_short() ? 16 : 24, snap);
        const cw_snap_counts *r = &p.after.snap;
        double most = 0, sum = 0;
        for (size_t v = 0; v < p.plain.vertex_count; v++) {
            const double distance = distance_from(&p.snapped, p.plain.positions + 3 * v);
            most = fmax(most, distance);
            sum += distance;
        }
        const double voxel = p.plain.affine[0][0];
        assert_true(r->vertices > 0);
        assert_near(most, r->max_error_mm, 1e-4 * voxel);
        assert_near(sum / (double)r->vertices, r->mean_error_mm, 1e-4 * voxel);
        assert_within(r->max_error_mm / voxel, r->max_error_voxels, 1e-6);
        assert_within(r->mean_error_mm / voxel, r->mean_error_voxels, 1e-6);
        assert_true(r->max_error_voxels < 0.5 * snap);
        assert_true(r->max_error_mm <= r->max_moved_mm);
        assert_true(r->max_moved_voxels < 2 * snap);
        free_pair(&p);
    }
}

/* No point of either surface is farther from the other than a vertex was moved. */
static void nothing_is_farther_away_than_what_was_moved(void **state)
{
    (void)state;
    pair p = extract_smooth(4, 24, 0.5);
    double most = 0;
    for (size_t v = 0; v < p.snapped.vertex_count; v++)
        most = fmax(most, distance_from(&p.plain, p.snapped.positions + 3 * v));
    assert_true(most > 0 && most <= p.after.snap.max_moved_mm);
    free_pair(&p);
}

/* ---- any input -------------------------------------------------------------------------- */

static bool is_changed(const test_hostile *h, const test_frame *frame, unsigned setting)
{
    static const double shares[] = {0.3, 0.5, 0.02, 0.45};
    cw_volume v;
    cw_error err = {0};
    assert_ok(test_hostile_make(h, &v, &err), err);
    memcpy(v.affine, frame->affine, sizeof v.affine);
    const cw_extract_desc d = {.isovalue = h->isovalue,
                               .leave_open = setting & 1,
                               .inside_is_low = setting & 2,
                               .simple_topology = setting & 4,
                               .cubic_placement = setting & 8,
                               .threads = 1};
    const double share = shares[setting % 3 + (setting & 1)];
    pair p = extract_pair(&v, d, share);
    if (frame->far) /* the promise is about local positions there */
        memset(p.snapped.origin, 0, sizeof p.snapped.origin);
    const char *fault = change(&p, d.leave_open);
    const cw_snap_counts *r = &p.after.snap;
    if (!fault && !(r->max_moved_voxels <= 2 * share + 1e-3))
        fault = "gone too far";
    if (fault)
        print_message("%s, %s, setting %u: the snapped mesh has %s\n", h->name, frame->name,
                      setting, fault);
    free_pair(&p);
    cw_volume_free(&v);
    return fault != NULL;
}

static void hostile_volumes_keep_their_topology(void **state)
{
    (void)state;
    int changed = 0;
    for (size_t n = 0; test_hostile_at(n); n++)
        for (unsigned s = 0; s < 16; s += test_is_short() ? 7 : 1)
            changed += is_changed(test_hostile_at(n), test_frame_at(0), s);
    assert_int_equal(changed, 0);
}

static void hostile_volumes_keep_their_topology_in_every_frame(void **state)
{
    (void)state;
    int changed = 0;
    for (size_t n = 0; test_hostile_at(n); n++)
        for (size_t f = test_is_short() ? 1 + n % 4 : 1; test_frame_at(f);
             f += test_is_short() ? 4 : 1)
            changed += is_changed(test_hostile_at(n), test_frame_at(f), (unsigned)(n + f) % 16);
    assert_int_equal(changed, 0);
}

/* Angles are the world's: in another frame, other triangles are bad ones. */
static void smooth_fields_are_snapped_in_every_frame(void **state)
{
    (void)state;
    cw_volume v = test_sample(CW_FIELD_TORUS, 32, CW_F32);
    for (size_t f = 0; test_frame_at(f); f++) {
        memcpy(v.affine, test_frame_at(f)->affine, sizeof v.affine);
        pair p = extract_pair(&v, (cw_extract_desc){0}, 0.4);
        double smallest[2];
        memset(p.snapped.origin, 0, sizeof p.snapped.origin);
        assert_null(change(&p, false));
        share_below(&p.plain, 10, &smallest[0]);
        share_below(&p.snapped, 10, &smallest[1]);
        assert_true(smallest[1] >= smallest[0]);
        assert_true((double)p.after.triangles < 0.7 * (double)p.before.triangles);
        assert_true(p.after.snap.max_error_voxels < 0.5 * 0.4);
        free_pair(&p);
    }
    cw_volume_free(&v);
}

/* ---- how it is computed ----------------------------------------------------------------- */

static cw_volume noise(void)
{
    const cw_field_desc desc = {
        .field = CW_FIELD_GYROID, .dim = {70, 21, 19}, .type = CW_I16, .noise = 1};
    cw_volume v;
    cw_error err = {0};
    assert_ok(cw_field_sample(&desc, &v, &err), err);
    return v;
}

static void check_threads_and_engines(cw_extract_desc d)
{
    cw_volume v = noise();
    cw_error err = {0};
    cw_extract_counts one_counts, counts;
    cw_mesh one = test_extract(&v, &d, &one_counts), other = {0};
    for (int n = 2; n < 9; n += 3) {
        d.threads = n;
        other = test_extract(&v, &d, &counts);
        test_assert_same_mesh(&one, &other);
        assert_memory_equal(&one_counts.snap, &counts.snap, sizeof counts.snap);
        cw_mesh_free(&other);
    }
    for (size_t e = 0; cwi_engine_at(e); e++) {
        assert_ok(cwi_extract_with(cwi_engine_at(e), &v, &d, &other, &counts, &err), err);
        test_assert_same_mesh(&one, &other);
        cw_mesh_free(&other);
    }
    cw_mesh_free(&one);
    cw_volume_free(&v);
}

static void threads_and_engines_give_the_same_bytes(void **state)
{
    (void)state;
    check_threads_and_engines((cw_extract_desc){.isovalue = 3, .snap = 0.35, .threads = 1});
    check_threads_and_engines((cw_extract_desc){
        .snap = 0.5, .threads = 1, .leave_open = true, .cubic_placement = true});
}

/* Through the tree some words of bits are stale. */
static void an_extractor_snaps_the_same(void **state)
{
    (void)state;
    cw_volume v = noise();
    cw_extractor *e;
    cw_error err = {0};
    assert_ok(cw_extractor_new(&v, &e, &err), err);
    for (int iso = -8; iso <= 8; iso += test_is_short() ? 6 : 2) {
        const cw_extract_desc d = {.isovalue = iso, .snap = 0.4, .leave_open = iso % 4 == 0};
        cw_mesh once = test_extract(&v, &d, NULL), again = {0};
        assert_ok(cw_extractor_extract(e, &d, &again, NULL, &err), err);
        test_assert_same_mesh(&once, &again);
        cw_mesh_free(&once);
        cw_mesh_free(&again);
    }
    cw_extractor_free(e);
    cw_volume_free(&v);
}

static void normals_do_not_change_what_is_snapped(void **state)
{
    (void)state;
    cw_volume v = noise();
    cw_extract_desc d = {.isovalue = 3, .snap = 0.4};
    cw_mesh with = test_extract(&v, &d, NULL);
    d.no_normals = true;
    cw_mesh without = test_extract(&v, &d, NULL);
    assert_int_equal(with.vertex_count, without.vertex_count);
    assert_memory_equal(with.positions, without.positions, 12 * with.vertex_count);
    assert_memory_equal(with.triangles, without.triangles, 12 * with.triangle_count);
    cw_mesh_free(&with);
    cw_mesh_free(&without);
    cw_volume_free(&v);
}

static void shares_out_of_range_are_refused(void **state)
{
    (void)state;
    static const double shares[] = {-0.1, 0.51, NAN, INFINITY};
    cw_volume v = test_sample(CW_FIELD_SPHERE, 8, CW_F32);
    for (int n = 0; n < 4; n++) {
        cw_mesh mesh = {0};
        cw_error err = {0};
        const cw_extract_desc d = {.snap = shares[n]};
        assert_fails(cw_extract(&v, &d, &mesh, NULL, &err), CW_ERR_ARGUMENT, "snap", err);
    }
    cw_volume_free(&v);
}

static void running_out_of_memory_leaves_nothing(void **state)
{
    (void)state;
    cw_volume v = test_sample(CW_FIELD_SPHERE, 12, CW_F32);
    const cw_extract_desc d = {.snap = 0.3, .threads = 1};
    bool failed = true;
    for (long n = 0; failed; n++) {
        cw_mesh mesh = {0};
        cw_error err = {0};
        cwi_alloc_fail_after(n);
        const cw_status st = cw_extract(&v, &d, &mesh, NULL, &err);
        failed = cwi_alloc_fail_after(-1);
        assert_int_equal(st, failed ? CW_ERR_NO_MEMORY : CW_OK);
        assert_true(failed == (mesh.positions == NULL));
        cw_mesh_free(&mesh);
    }
    cw_volume_free(&v);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(needles_go_and_topology_stays),
        cmocka_unit_test(a_sphere_and_a_torus_are_left_without_needles),
        cmocka_unit_test(a_snapped_sphere_is_as_round),
        cmocka_unit_test(the_error_reported_is_the_error),
        cmocka_unit_test(nothing_is_farther_away_than_what_was_moved),
        cmocka_unit_test(hostile_volumes_keep_their_topology),
        cmocka_unit_test(hostile_volumes_keep_their_topology_in_every_frame),
        cmocka_unit_test(smooth_fields_are_snapped_in_every_frame),
        cmocka_unit_test(threads_and_engines_give_the_same_bytes),
        cmocka_unit_test(an_extractor_snaps_the_same),
        cmocka_unit_test(normals_do_not_change_what_is_snapped),
        cmocka_unit_test(shares_out_of_range_are_refused),
        cmocka_unit_test(running_out_of_memory_leaves_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
