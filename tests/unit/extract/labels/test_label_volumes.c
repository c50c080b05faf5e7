/* Tests that smoothing gives labels the volumes of their voxels: cells, sheets that fold, and small labels
 * among others. */
#include "support/support.h"

#include "extract/pipeline/label_copier.h"

#include <cubewright/field.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { SIDE = 40 };

/* The fraction of its volume that smoothing may take from a label. */
static const double PROMISE = 0.005;

/* Makes cells of some 60 voxels each. */
static void make_cells(cw_volume *v)
{
    cw_error err = {0};
    const cw_label_field_desc desc = {
        .field = CW_LABEL_CELLS, .dim = {SIDE, SIDE, SIDE}, .type = CW_U32, .labels = 500};
    assert_ok(cw_label_field_sample(&desc, v, &err), err);
}

/* Makes a sheet of three voxels that folds, cut to pieces; or a ball of two labels, with blocks of 1 to
 * 27 voxels in both. */
static void make_map(cw_volume *v, bool is_sheet)
{
    cw_error err = {0};
    assert_ok(cw_volume_alloc(v, CW_U32, (size_t[]){SIDE, SIDE, SIDE}, 1, 1, &err), err);
    uint32_t *to = cw_volume_voxels(v);
    for (size_t n = 0; n < (size_t)SIDE * SIDE * SIDE; n++) {
        const size_t x = n % SIDE, y = n / SIDE % SIDE, z = n / SIDE / SIDE;
        const double fold = 20 + 6 * sin((double)x / 4) * cos((double)y / 5) + 0.3 * (double)x,
                     r = hypot(hypot((double)x - 19.5, (double)y - 19.5), (double)z - 19.5);
        const size_t size = 1 + (x / 8 + y / 8 + z / 8) % 3;
        const bool is_block = x % 8 < size && y % 8 < size && z % 8 < size;
        if (is_sheet)
            to[n] = fabs((double)z - fold) < 1.6 ? 1 + (uint32_t)(x / 7 + 6 * (y / 6)) : 0;
        else
            to[n] = r > 17     ? 0
                    : is_block ? 10 + (uint32_t)(x / 8 + 5 * (y / 8) + 25 * (z / 8))
                               : 1 + (x + y > 40);
    }
}

static void volumes_are_kept(void **state)
{
    (void)state;
    for (int kind = 0; kind < 3; kind++) {
        cw_volume v;
        cw_label_surfaces s;
        cw_error err = {0};
        size_t off = 0;
        if (kind == 0)
            make_cells(&v);
        else
            make_map(&v, kind == 1);
        v.affine[0][0] = -2; /* mirrored, 1.5 mm3 a voxel */
        v.affine[1][1] = 0.75;
        assert_ok(cw_extract_labels(&v, NULL, &s, &err), err);
        double *volumes = calloc(s.label_count, sizeof *volumes);
        assert_non_null(volumes);
        cw_label_volumes(&s, volumes);
        for (size_t n = 0; n < s.label_count; n++) {
            const double voxels = (double)s.labels[n].voxels,
                         error = fabs(volumes[n] / (1.5 * voxels) - 1);
            off += error > PROMISE;
            if (error > PROMISE && voxels > 8)
                fail_msg("map %d: label %u of %zu voxels is off by %.2f %%", kind,
                         s.labels[n].label, s.labels[n].voxels, 100 * error);
        }
        assert_true(50 * off <= s.label_count);
        free(volumes);
        cw_label_surfaces_free(&s);
        cw_volume_free(&v);
    }
}

/* The volumes of labels are those of their meshes, and meshes that are copied one after the other are those
 * that are copied alone. */
static void volumes_are_those_of_meshes(void **state)
{
    (void)state;
    cw_volume v;
    cw_label_surfaces s;
    cwi_label_copier copier;
    cw_error err = {0};
    double volumes[600];
    make_cells(&v);
    assert_ok(cw_extract_labels(&v, NULL, &s, &err), err);
    assert_true(s.label_count <= 600);
    assert_true(cwi_label_copier_init(&copier, &s));
    cw_label_volumes(&s, volumes);
    for (size_t n = 0; n < s.label_count; n++) {
        cw_mesh mesh, copy;
        cw_quality q;
        assert_ok(cw_label_mesh(&s, s.labels[n].label, &mesh, &err), err);
        assert_ok(cw_quality_measure(&mesh, NULL, &q, &err), err);
        assert_near(volumes[n], q.volume_mm3, 1e-4 * q.volume_mm3);
        assert_ok(cwi_label_copier_copy(&copier, n, &copy, &err), err);
        assert_int_equal(copy.vertex_count, mesh.vertex_count);
        assert_int_equal(copy.triangle_count, mesh.triangle_count);
        assert_memory_equal(copy.positions, mesh.positions, 12 * mesh.vertex_count);
        assert_memory_equal(copy.triangles, mesh.triangles, 12 * mesh.triangle_count);
        cw_mesh_free(&copy);
        cw_mesh_free(&mesh);
    }
    cwi_label_copier_free(&copier);
    cw_label_surfaces_free(&s);
    cw_volume_free(&v);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(volumes_are_kept),
                                       cmocka_unit_test(volumes_are_those_of_meshes)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
