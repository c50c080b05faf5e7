/* Tests label maps: every label a closed manifold, neighbours with the same triangles, of all
 * neighbourhoods, random maps, spheres, and voxels of any type. */
#include "support/label_surfaces.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/volume/volume.h"
#include "extract/labels/extract_labels.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Makes a volume of labels, with the first voxel at the world's zero. */
static uint32_t *make_map(cw_volume *v, size_t nx, size_t ny, size_t nz)
{
    cw_error err = {0};
    assert_ok(cw_volume_alloc(v, CW_U32, (size_t[]){nx, ny, nz}, 1, 1, &err), err);
    return cw_volume_voxels(v);
}

/* Extracts a map with and without smoothing, and checks all of it. */
static void check_map(const cw_volume *v, const cw_labels_desc *desc)
{
    for (int smooth = 0; smooth < 2; smooth++) {
        cw_labels_desc how = desc ? *desc : (cw_labels_desc){0};
        cw_label_surfaces s;
        cw_error err = {0};
        how.no_smoothing = !smooth;
        assert_ok(cw_extract_labels(v, &how, &s, &err), err);
        test_check_label_surfaces(&s);
        cw_label_surfaces_free(&s);
    }
}

/* Goes through all ways to label 8 voxels, with 0 as background, up to other names: the number
 * of a label is at most one above those before. Returns the number of ways. Under sanitizers an
 * eighth of them is checked. */
static size_t each_labelling(uint32_t labels[8], int n, uint32_t most, cw_volume *v)
{
    if (n == 8) {
        uint32_t *to = cw_volume_voxels(v);
        memcpy(to, labels, 8 * sizeof *to);
        if (most > 0 && (!test_is_short() || (7 * most + 3 * labels[6] + labels[7]) % 16 == 0))
            check_map(v, NULL);
        return 1;
    }
    size_t count = 0;
    for (uint32_t label = 0; label <= most + 1; label++) {
        labels[n] = label;
        count += each_labelling(labels, n + 1, label > most ? label : most, v);
    }
    return count;
}

static void every_neighbourhood_is_right(void **state)
{
    (void)state;
    cw_volume v = {0};
    uint32_t labels[8];
    make_map(&v, 2, 2, 2);
    assert_int_equal(each_labelling(labels, 0, 0, &v), 21147);
    cw_volume_free(&v);
}

static void random_maps_are_right(void **state)
{
    (void)state;
    test_seed(7);
    for (int n = 0; n < (test_is_short() ? 40 : 300); n++) {
        static const uint32_t counts[] = {2, 3, 5, 50};
        cw_volume v = {0};
        size_t dim[3];
        for (int a = 0; a < 3; a++)
            dim[a] = 4 + (size_t)(rand() % 9);
        uint32_t *to = make_map(&v, dim[0], dim[1], dim[2]);
        const uint32_t labels = counts[rand() % 4];
        for (size_t i = 0; i < dim[0] * dim[1] * dim[2]; i++)
            to[i] = (uint32_t)rand() % labels;
        check_map(&v, NULL);
        cw_volume_free(&v);
    }
}

/* Spheres that come closer until all eight meet in the middle. */
static void spheres_that_meet_are_right(void **state)
{
    (void)state;
    enum { SIDE = 32 };
    cw_volume v = {0};
    uint32_t *to = make_map(&v, SIDE, SIDE, SIDE);
    for (int step = 0; step < 6; step++) {
        for (size_t n = 0; n < SIDE * SIDE * SIDE; n++) {
            const double p[3] = {(double)(n % SIDE), (double)(n / SIDE % SIDE),
                                 (double)(n / SIDE / SIDE)};
            double square = 0;
            uint32_t label = 1;
            for (int a = 0; a < 3; a++) {
                const double middle = (SIDE - 1) / 2.0, away = fabs(p[a] - middle);
                square += (away - 9) * (away - 9);
                label += (p[a] > middle) << a;
            }
            to[n] = sqrt(square) < 5 + 2.2 * step ? label : 0;
        }
        check_map(&v, NULL);
    }
    cw_volume_free(&v);
}

enum { SLAB = 9 }; /* the label of the slab */

/* Fills a map with a ball in eight parts, and a slab of one voxel. */
static void fill_solids(uint32_t *to, size_t side)
{
    for (size_t n = 0; n < side * side * side; n++) {
        const double x = (double)(n % side), y = (double)(n / side % side),
                     z = (double)(n / side / side);
        const double r = hypot(hypot(x - 20, y - 20), z - 20);
        const uint32_t part = 1u + (x > 20) + 2u * (y > 18) + 4u * (z > 21);
        to[n] = r < 16 ? part : z == 38 ? SLAB : 0;
    }
}

/* Smoothing keeps volumes to a thousandth, moves no vertex farther than its bound, and makes
 * surfaces smaller, which were stairs. */
static void smoothing_keeps_volumes_and_bounds(void **state)
{
    (void)state;
    enum { SIDE = 40 };
    cw_volume v = {0};
    cw_label_surfaces plain, smooth;
    cw_error err = {0};
    fill_solids(make_map(&v, SIDE, SIDE, SIDE), SIDE);
    assert_ok(cw_extract_labels(&v, &(cw_labels_desc){.no_smoothing = true}, &plain, &err),
              err);
    for (int n = 0; n < 3; n++) {
        const double bound = (double[]){0, 0.25, 0.5}[n];
        double most = 0;
        assert_ok(cw_extract_labels(&v, &(cw_labels_desc){.max_move = bound}, &smooth, &err),
                  err);
        assert_int_equal(smooth.mesh.vertex_count, plain.mesh.vertex_count);
        for (size_t i = 0; i < 3 * plain.mesh.vertex_count; i++)
            most = fmax(
                most, fabs((double)smooth.mesh.positions[i] - (double)plain.mesh.positions[i]));
        assert_true(most <= (n == 1 ? 0.25 : 0.5) && most > 0.2);
        for (size_t i = 0; i < smooth.label_count; i++) {
            cw_mesh mesh, stairs;
            cw_quality q, before;
            assert_ok(cw_label_mesh(&smooth, smooth.labels[i].label, &mesh, &err), err);
            assert_ok(cw_label_mesh(&plain, smooth.labels[i].label, &stairs, &err), err);
            assert_ok(cw_quality_measure(&mesh, NULL, &q, &err), err);
            assert_ok(cw_quality_measure(&stairs, NULL, &before, &err), err);
            if (n != 1) /* a tight bound cannot keep all of it */
                assert_near(q.volume_mm3, (double)smooth.labels[i].voxels,
                            1e-3 * (double)smooth.labels[i].voxels);
            if (smooth.labels[i].label != SLAB) /* it fills the volume's width: flat already */
                assert_true(q.area_mm2 < before.area_mm2);
            else
                assert_near(q.area_mm2, before.area_mm2, 1e-6 * before.area_mm2);
            cw_mesh_free(&mesh);
            cw_mesh_free(&stairs);
        }
        cw_label_surfaces_free(&smooth);
    }
    cw_label_surfaces_free(&plain);
    cw_volume_free(&v);
}

static void volumes_are_those_of_voxels(void **state)
{
    (void)state;
    cw_volume v = {0};
    cw_label_surfaces s;
    cw_mesh mesh;
    cw_quality q;
    cw_error err = {0};
    uint32_t *to = make_map(&v, 20, 20, 20);
    for (size_t n = 0; n < 8000; n++)
        to[n] = n % 20 < 10 ? 4294967295u : n / 20 % 20 < 7 ? 3 : 70000;
    for (int a = 0; a < 3; a++)
        v.affine[a][a] = (double[]){-0.5, 2, 1e-3}[a]; /* mirrored */
    assert_ok(cw_extract_labels(&v, NULL, &s, &err), err);
    assert_int_equal(s.label_count, 3);
    assert_int_equal(s.labels[0].voxels, 10 * 7 * 20);
    assert_int_equal(s.labels[2].label, 4294967295u);
    for (int n = 0; n < 3; n++) {
        assert_ok(cw_label_mesh(&s, s.labels[n].label, &mesh, &err), err);
        assert_ok(cw_quality_measure(&mesh, NULL, &q, &err), err);
        assert_near(q.volume_mm3, 1e-3 * (double)s.labels[n].voxels,
                    1e-6 * (double)s.labels[n].voxels);
        cw_mesh_free(&mesh);
    }
    assert_int_equal(s.patch_count, 6);
    cw_label_surfaces_free(&s);
    cw_volume_free(&v);
}

/* Smoothing shrinks small solids to almost nothing; they get their volumes back. */
static void small_solids_keep_their_volumes(void **state)
{
    (void)state;
    static const size_t sizes[][3] = {{1, 1, 1}, {1, 1, 2}, {2, 2, 1},
                                      {2, 2, 2}, {3, 1, 2}, {3, 3, 3}};
    for (size_t n = 0; n < sizeof sizes / sizeof *sizes; n++) {
        cw_volume v = {0};
        cw_label_surfaces s;
        cw_mesh mesh;
        cw_quality q;
        cw_error err = {0};
        uint32_t *to = make_map(&v, 12, 12, 12);
        double voxels = 1;
        for (int a = 0; a < 3; a++)
            voxels *= (double)sizes[n][a];
        memset(to, 0, 12 * 12 * 12 * sizeof *to);
        for (size_t z = 0; z < sizes[n][2]; z++)
            for (size_t y = 0; y < sizes[n][1]; y++)
                for (size_t x = 0; x < sizes[n][0]; x++)
                    to[((z + 5) * 12 + y + 4) * 12 + x + 3] = 9;
        assert_ok(cw_extract_labels(&v, NULL, &s, &err), err);
        assert_ok(cw_label_mesh(&s, 9, &mesh, &err), err);
        assert_ok(cw_quality_measure(&mesh, NULL, &q, &err), err);
        assert_near(q.volume_mm3, voxels, 0.01 * voxels);
        cw_mesh_free(&mesh);
        cw_label_surfaces_free(&s);
        cw_volume_free(&v);
    }
}

/* The same bytes for any number of threads, and from any type that holds the labels. */
static void types_and_threads_change_nothing(void **state)
{
    (void)state;
    static const cw_type types[] = {CW_U8,  CW_I8,  CW_U16, CW_I16,
                                    CW_U32, CW_I32, CW_F32, CW_F64};
    cw_volume v = {0};
    cw_label_surfaces first, s;
    cw_error err = {0};
    test_seed(3);
    const size_t height = test_is_short() ? 20 : 70;
    uint32_t *to = make_map(&v, 30, 20, height);
    for (size_t n = 0; n < 30 * 20 * height; n++)
        to[n] = n > 0 && rand() % 4 ? to[n - 1] : (uint32_t)rand() % 100;
    assert_ok(cw_extract_labels(&v, &(cw_labels_desc){.threads = 1}, &first, &err), err);
    for (size_t n = 0; n < sizeof types / sizeof *types; n++) {
        cw_volume other = {0};
        assert_ok(cw_volume_alloc(&other, types[n], v.dim, 1, 1, &err), err);
        char *voxels = cw_volume_voxels(&other);
        for (size_t i = 0; i < 30 * 20 * height; i++)
            cwi_voxel_put(types[n], voxels + i * cw_type_size(types[n]), (double)to[i]);
        assert_ok(cw_extract_labels(&other, &(cw_labels_desc){.threads = 3}, &s, &err), err);
        assert_int_equal(s.mesh.triangle_count, first.mesh.triangle_count);
        assert_int_equal(s.mesh.vertex_count, first.mesh.vertex_count);
        assert_memory_equal(s.mesh.triangles, first.mesh.triangles, 12 * s.mesh.triangle_count);
        assert_memory_equal(s.mesh.positions, first.mesh.positions, 12 * s.mesh.vertex_count);
        cw_label_surfaces_free(&s);
        cw_volume_free(&other);
    }
    cw_label_surfaces_free(&first);
    cw_volume_free(&v);
}

/* A label map that is read in slices, and the slice after those that were read. */
typedef struct slices {
    const cw_volume *volume;
    size_t next, fails_at;
} slices;

static cw_status read_slices(void *user, size_t first, size_t count, void *to, cw_error *err)
{
    slices *s = user;
    const size_t slice = s->volume->dim[0] * s->volume->dim[1] * cw_type_size(s->volume->type);
    assert_true(first == s->next || first == 0); /* none is read twice in a pass */
    s->next = first + count;
    if (s->fails_at && s->next > s->fails_at)
        return cwi_fail(err, CW_ERR_IO, "the disk is gone");
    memcpy(to, (const char *)s->volume->data + first * slice, count * slice);
    return CW_OK;
}

static cw_slice_source source_of(slices *s)
{
    cw_slice_source source = {.shape = *s->volume, .read = read_slices, .user = s};
    source.shape.data = NULL;
    source.shape.owned = NULL;
    return source;
}

/* Checks a prediction against the surfaces. They are small: patches, and not vertices, may be most of
 * the memory, so that bytes are only held against the mesh. */
static void check_prediction(const cw_label_prediction *p, const cw_label_surfaces *s)
{
    size_t own = 0;
    for (size_t n = 0; n < s->label_count; n++) {
        cw_mesh mesh;
        cw_error err = {0};
        assert_ok(cw_label_mesh(s, s->labels[n].label, &mesh, &err), err);
        own += mesh.triangle_count;
        cw_mesh_free(&mesh);
    }
    assert_int_equal(p->labels, s->label_count);
    assert_int_equal(p->patches, s->patch_count);
    assert_int_equal(p->vertices, s->mesh.vertex_count);
    assert_int_equal(p->triangles, s->mesh.triangle_count);
    assert_int_equal(p->own_triangles, own);
    assert_true(p->bytes >= 12 * (s->mesh.vertex_count + s->mesh.triangle_count));
}

static void slices_give_the_same_surfaces(void **state)
{
    (void)state;
    static const size_t heights[] = {1, 14, 15, 16, 17, 33, 70};
    static const uint32_t wanted[] = {3, 5, 8};
    cw_error err = {0};
    test_seed(11);
    for (size_t h = 0; h < sizeof heights / sizeof *heights; h += test_is_short() ? 2 : 1)
        for (int round = 0; round < 4; round++) {
            cw_volume v = {0};
            cw_label_surfaces whole;
            const cw_labels_desc desc = {.leave_open = round == 1,
                                         .no_smoothing = round == 2,
                                         .labels = round == 3 ? wanted : NULL,
                                         .label_count = round == 3 ? 3 : 0,
                                         .threads = 1 + round % 2};
            uint32_t *to = make_map(&v, 20, 13, heights[h]);
            for (size_t n = 0; n < 20 * 13 * heights[h]; n++)
                to[n] = n > 0 && rand() % 4 ? to[n - 1] : (uint32_t)rand() % 9;
            assert_ok(cw_extract_labels(&v, &desc, &whole, &err), err);
            cw_label_prediction predicted[2];
            slices first = {.volume = &v};
            const cw_slice_source source_once = source_of(&first);
            assert_ok(cw_extract_labels_predict(&v, &desc, &predicted[0], &err), err);
            assert_ok(
                cw_extract_labels_stream_predict(&source_once, &desc, &predicted[1], &err),
                err);
            check_prediction(&predicted[0], &whole);
            check_prediction(&predicted[1], &whole);
            for (size_t chunks = 0; chunks < 4; chunks += test_is_short() ? 3 : 1) {
                slices s = {.volume = &v};
                const cw_slice_source source = source_of(&s);
                cw_label_surfaces got;
                assert_ok(cwi_extract_labels_windowed(&source, chunks, &desc, &got, &err), err);
                test_assert_same_labels(&got, &whole);
                cw_label_surfaces_free(&got);
            }
            cw_label_surfaces_free(&whole);
            cw_volume_free(&v);
        }
}

static void slices_that_fail_are_errors(void **state)
{
    (void)state;
    cw_volume v = {0};
    cw_label_surfaces got;
    cw_error err = {0};
    assert_ok(cw_volume_alloc(&v, CW_F32, (size_t[]){5, 6, 60}, 1, 1, &err), err);
    float *to = cw_volume_voxels(&v);
    to[(50 * 6 + 3) * 5 + 2] = 0.25f;
    slices s = {.volume = &v};
    const cw_slice_source source = source_of(&s);
    assert_fails(cwi_extract_labels_windowed(&source, 1, NULL, &got, &err), CW_ERR_ARGUMENT,
                 "voxel 2, 3, 50 is 0.25", err);
    assert_null(got.mesh.triangles);
    cw_label_prediction predicted;
    assert_fails(cw_extract_labels_predict(&v, NULL, &predicted, &err), CW_ERR_ARGUMENT,
                 "voxel 2, 3, 50 is 0.25", err);
    to[(50 * 6 + 3) * 5 + 2] = 2;
    s = (slices){.volume = &v, .fails_at = 30};
    assert_fails(cwi_extract_labels_windowed(&source, 1, NULL, &got, &err), CW_ERR_IO,
                 "the disk is gone", err);
    s.fails_at = 0;
    bool failed = true;
    for (long n = 0; failed; n++) {
        cwi_alloc_fail_after(n);
        const cw_status st = cwi_extract_labels_windowed(
            &source, 2, &(cw_labels_desc){.threads = 1}, &got, &err);
        failed = cwi_alloc_fail_after(-1);
        assert_true(st == (failed ? CW_ERR_NO_MEMORY : CW_OK));
        cw_label_surfaces_free(&got);
    }
    cw_volume_free(&v);
}

static void wanted_labels_alone_are_extracted(void **state)
{
    (void)state;
    cw_volume v = {0};
    cw_label_surfaces s;
    cw_error err = {0};
    const uint32_t wanted[] = {9, 2, 77};
    uint32_t *to = make_map(&v, 12, 6, 6);
    for (size_t n = 0; n < 12 * 36; n++)
        to[n] = n % 12 < 4 ? 2 : n % 12 < 8 ? 5 : 9;
    assert_ok(
        cw_extract_labels(&v, &(cw_labels_desc){.labels = wanted, .label_count = 3}, &s, &err),
        err);
    assert_int_equal(s.label_count, 2);
    assert_int_equal(s.patch_count, 2);
    assert_true(s.labels[0].label == 2 && s.labels[1].label == 9);
    cw_label_surfaces_free(&s);
    check_map(&v, &(cw_labels_desc){.background = 5});
    cw_volume_free(&v);
}

/* Open borders are the ends of the volume, and all else is closed. */
static void open_borders_are_at_the_end(void **state)
{
    (void)state;
    cw_volume v = {0};
    cw_label_surfaces s;
    cw_quality q;
    cw_error err = {0};
    uint32_t *to = make_map(&v, 10, 10, 10);
    for (size_t n = 0; n < 1000; n++)
        to[n] = n / 100 < 5 ? 1 : 2;
    assert_ok(cw_extract_labels(&v, &(cw_labels_desc){.leave_open = true}, &s, &err), err);
    assert_int_equal(s.patch_count, 1);
    assert_ok(cw_quality_measure(&s.mesh, NULL, &q, &err), err);
    assert_int_equal(q.border_loops, 1);
    assert_near(q.area_mm2, 100, 1e-3);
    assert_near(q.min[2], 4.5, 1e-6);
    assert_near(q.min[0], -0.5, 1e-6);
    cw_label_surfaces_free(&s);
    cw_volume_free(&v);
}

static void unusable_values_are_named(void **state)
{
    (void)state;
    static const double values[] = {-1, 0.5, 4294967296.0, INFINITY};
    cw_volume v = {0};
    cw_label_surfaces s;
    cw_error err = {0};
    assert_ok(cw_volume_alloc(&v, CW_F64, (size_t[]){5, 6, 40}, 1, 1, &err), err);
    double *to = cw_volume_voxels(&v);
    for (int n = 0; n < 4; n++) {
        memset(to, 0, 5 * 6 * 40 * sizeof *to);
        to[(37 * 6 + 1) * 5 + 1] = -7;
        to[(20 * 6 + 3) * 5 + 2] = values[n];
        assert_fails(cw_extract_labels(&v, NULL, &s, &err), CW_ERR_ARGUMENT,
                     "voxel 2, 3, 20 is ", err);
        assert_true(s.mesh.triangles == NULL);
    }
    memset(to, 0, 5 * 6 * 40 * sizeof *to);
    to[3] = NAN; /* no value: background */
    to[100] = 8;
    check_map(&v, NULL);
    assert_fails(cw_extract_labels(&v, &(cw_labels_desc){.max_triangles = 3}, &s, &err),
                 CW_ERR_LIMIT, "more than 3", err);
    assert_fails(cw_extract_labels(&v, &(cw_labels_desc){.label_count = 3}, &s, &err),
                 CW_ERR_ARGUMENT, "none are named", err);
    assert_fails(cw_extract_labels(&v, &(cw_labels_desc){.max_move = 0.6}, &s, &err),
                 CW_ERR_ARGUMENT, "0 to 0.5 was expected", err);
    cw_volume_free(&v);
}

/* Each allocation fails in turn: an error, and nothing left behind. */
static void memory_that_is_out_is_an_error(void **state)
{
    (void)state;
    cw_volume v = {0};
    cw_error err = {0};
    uint32_t *to = make_map(&v, 9, 8, 40);
    for (size_t n = 0; n < 9 * 8 * 40; n++)
        to[n] = (uint32_t)(n * n % 7);
    bool failed = true;
    for (long n = 0; failed; n++) {
        cw_label_surfaces s;
        cw_mesh mesh = {0};
        cwi_alloc_fail_after(n);
        cw_status st = cw_extract_labels(&v, &(cw_labels_desc){.threads = 1}, &s, &err);
        if (st == CW_OK)
            st = cw_label_mesh(&s, 3, &mesh, &err);
        failed = cwi_alloc_fail_after(-1);
        assert_true(st == (failed ? CW_ERR_NO_MEMORY : CW_OK));
        assert_true(!failed || mesh.triangles == NULL);
        cw_mesh_free(&mesh);
        cw_label_surfaces_free(&s);
    }
    cw_volume_free(&v);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(every_neighbourhood_is_right),
                                       cmocka_unit_test(random_maps_are_right),
                                       cmocka_unit_test(spheres_that_meet_are_right),
                                       cmocka_unit_test(smoothing_keeps_volumes_and_bounds),
                                       cmocka_unit_test(volumes_are_those_of_voxels),
                                       cmocka_unit_test(small_solids_keep_their_volumes),
                                       cmocka_unit_test(types_and_threads_change_nothing),
                                       cmocka_unit_test(slices_give_the_same_surfaces),
                                       cmocka_unit_test(slices_that_fail_are_errors),
                                       cmocka_unit_test(wanted_labels_alone_are_extracted),
                                       cmocka_unit_test(open_borders_are_at_the_end),
                                       cmocka_unit_test(unusable_values_are_named),
                                       cmocka_unit_test(memory_that_is_out_is_an_error)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
