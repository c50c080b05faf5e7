/* The type that filters give to values: the surface of denoised integers is that of the same data as
 * floats. */
#include "support/noise_volume.h"
#include "support/support.h"

#include "core/synthetic/random_fill.h"
#include "core/volume/volume.h"

#include <cubewright/extract.h>
#include <cubewright/filter.h>

#include <math.h>
#include <string.h>

enum { EDGE = 40, FILTERS = 5 };

/* A sphere at 3 grey levels above its surroundings, with noise of one grey level. */
static const double RADIUS = 13, BACKGROUND = 100, CONTRAST = 3;

static cw_volume make_faint_sphere(cw_type type)
{
    cw_volume v;
    cw_error err = {0};
    assert_ok(cw_volume_alloc(&v, type, (size_t[]){EDGE, EDGE, EDGE}, 1, 1, &err), err);
    char *p = cw_volume_voxels(&v);
    for (size_t n = 0; n < (size_t)EDGE * EDGE * EDGE; n++, p += cw_type_size(type)) {
        double r_sq = 0;
        for (size_t a = 0, at = n; a < 3; a++, at /= EDGE)
            r_sq += pow((double)(at % EDGE) - (EDGE - 1) / 2.0, 2);
        const double share = fmin(fmax((RADIUS - sqrt(r_sq)) / 1.5 + 0.5, 0), 1);
        cwi_voxel_put(type, p, rint(BACKGROUND + CONTRAST * share + cwi_gaussian(21, n)));
    }
    return v;
}

static cw_volume run_filter(int filter, const cw_volume *v, const cw_filter_desc *d)
{
    const double one[3] = {1, 1, 1}, finer[3] = {0.7, 0.7, 0.7};
    cw_volume out;
    cw_error err = {0};
    assert_ok(filter == 0   ? cw_volume_gauss(v, one, d, &out, &err)
              : filter == 1 ? cw_volume_bilateral(v, one, 0, d, &out, &err)
              : filter == 2 ? cw_volume_aniso(v, 10, 0, d, &out, &err)
              : filter == 3 ? cw_volume_nlm(v, 0, 1, d, &out, &err)
                            : cw_volume_resample(v, finer, CW_KERNEL_CUBIC, d, &out, &err),
              err);
    return out;
}

/* Returns the spread (rms) of the distances of vertices near the sphere from its middle. */
static double measure_roughness(const cw_volume *v)
{
    const cw_extract_desc desc = {.isovalue = BACKGROUND + CONTRAST / 2};
    cw_mesh mesh = {0};
    cw_error err = {0};
    double sum = 0, sum_sq = 0, count = 0;
    assert_ok(cw_extract(v, &desc, &mesh, NULL, &err), err);
    for (size_t n = 0; n < mesh.vertex_count; n++) {
        double r_sq = 0;
        for (int a = 0; a < 3; a++)
            r_sq += pow((double)mesh.positions[3 * n + (size_t)a] + mesh.origin[a] -
                            (EDGE - 1) / 2.0,
                        2);
        const double d = sqrt(r_sq) - RADIUS;
        if (fabs(d) > 4)
            continue;
        sum += d;
        sum_sq += d * d;
        count++;
    }
    cw_mesh_free(&mesh);
    assert_true(count > 1000);
    return sqrt(sum_sq / count - pow(sum / count, 2));
}

static void integers_are_as_smooth_as_floats(void **state)
{
    (void)state;
    for (int filter = 0; filter < FILTERS; filter++) {
        cw_volume exact = make_faint_sphere(CW_F64), smooth = run_filter(filter, &exact, NULL);
        const double right = measure_roughness(&smooth);
        for (int t = filter % 2; t < NOISE_TYPES; t += 2) { /* each type in half of them */
            cw_volume v = make_faint_sphere(noise_types[t]), out[2];
            for (int n = 0; n < 2; n++)
                out[n] = run_filter(filter, &v, &(cw_filter_desc){.threads = n ? 3 : 1});
            assert_int_equal(out[0].type,
                             cw_type_size(v.type) < 4 || v.type == CW_F32 ? CW_F32 : CW_F64);
            assert_true(fabs(measure_roughness(&out[0]) - right) < 1e-4);
            assert_memory_equal(out[0].data, out[1].data,
                                out[0].dim[0] * out[0].dim[1] * out[0].dim[2] *
                                    cw_type_size(out[0].type));
            cw_volume_free(&out[0]);
            cw_volume_free(&out[1]);
            cw_volume_free(&v);
        }
        cw_volume_free(&smooth);
        cw_volume_free(&exact);
    }
}

/* A median is one of the values, and means of labels are rounded to labels. */
static void medians_and_labels_keep_their_type(void **state)
{
    (void)state;
    for (int t = 0; t < NOISE_TYPES; t++) {
        cw_volume v = make_faint_sphere(noise_types[t]), out;
        cw_error err = {0};
        assert_ok(cw_volume_median(&v, 1, NULL, &out, &err), err);
        assert_int_equal(out.type, v.type);
        cw_volume_free(&out);
        v.known |= CW_KNOWN_LABELS;
        for (int filter = 0; filter < FILTERS; filter++) {
            out = run_filter(filter, &v, NULL);
            assert_int_equal(out.type, v.type);
            assert_true(out.known & CW_KNOWN_LABELS);
            cw_volume_free(&out);
        }
        cw_volume_free(&v);
    }
    assert_int_equal(cw_filter_type(NULL), CW_F32);
}

/* A value that floats round to no data stays a value. */
static void rounding_makes_no_gaps(void **state)
{
    (void)state;
    cw_volume v, out;
    cw_error err = {0};
    assert_ok(cw_volume_alloc(&v, CW_I16, (size_t[]){9, 9, 9}, 1, 1, &err), err);
    for (int n = 0; n < 729; n++)
        ((int16_t *)cw_volume_voxels(&v))[n] = (int16_t)(n % 2 ? 30001 : 29999);
    v.has_nodata = true;
    v.nodata = 30000;
    assert_ok(cw_volume_gauss(&v, (double[]){3, 3, 3}, NULL, &out, &err), err);
    for (size_t n = 0; n < 729; n++)
        assert_true(((const float *)out.data)[n] != 30000.0f);
    cw_volume_free(&out);
    cw_volume_free(&v);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(integers_are_as_smooth_as_floats),
        cmocka_unit_test(medians_and_labels_keep_their_type),
        cmocka_unit_test(rounding_makes_no_gaps),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
