/* Makes volumes with known fields, transfer functions and a renderer, and compares pictures. */
#include "support/pictures.h"

#include "core/base/module.h"

#include <math.h>

static cw_renderer *renderer;

cw_renderer *test_renderer(void)
{
    cw_error err = {0};
    if (!cwi_module_present("gl"))
        skip();
    if (!renderer)
        assert_ok(cw_renderer_new(CW_BACKEND_EGL, &renderer, &err), err);
    return renderer;
}

int test_renderer_close(void **state)
{
    (void)state;
    cw_renderer_free(renderer);
    renderer = NULL;
    return 0;
}

void test_field(cw_volume *volume, size_t nx, size_t ny, size_t nz, const double spacing[3],
                double (*value)(const double p[3], const double q[3]))
{
    cw_error err = {0};
    const size_t dim[3] = {nx, ny, nz};
    assert_ok(cw_volume_alloc(volume, CW_F32, dim, 1, 1, &err), err);
    float *to = cw_volume_voxels(volume);
    for (size_t n = 0; n < nx * ny * nz; n++) {
        const double p[3] = {(double)(n % nx), (double)(n / nx % ny), (double)(n / nx / ny)};
        double q[3];
        for (int a = 0; a < 3; a++)
            q[a] = dim[a] > 1 ? p[a] / (double)(dim[a] - 1) : 0;
        to[n] = (float)value(p, q);
    }
    for (int a = 0; a < 3; a++) {
        volume->affine[a][a] = spacing[a];
        volume->affine[a][3] = -spacing[a] * (double)(dim[a] - 1) / 2;
    }
}

double test_constant(const double p[3], const double q[3])
{
    (void)p, (void)q;
    return 1;
}

double test_ramp(const double p[3], const double q[3])
{
    (void)p;
    return q[0];
}

double test_cubic(const double p[3], const double q[3])
{
    (void)p;
    return q[0] * q[1] * q[2];
}

double test_blobs(const double p[3], const double q[3])
{
    static const double blobs[6][4] = {{.3, .3, .3, .1},  {.7, .6, .4, .12},
                                       {.5, .7, .7, .1},  {.4, .4, .75, .08},
                                       {.65, .3, .6, .1}, {.5, .5, .45, .15}};
    double sum = 0.05 * sin(20 * q[0]) * sin(23 * q[1]) * sin(19 * q[2]);
    (void)p;
    for (int n = 0; n < 6; n++) {
        double d = 0;
        for (int a = 0; a < 3; a++)
            d += (q[a] - blobs[n][a]) * (q[a] - blobs[n][a]);
        sum += exp(-d / (2 * blobs[n][3] * blobs[n][3]));
    }
    return 0.8 * sum;
}

cw_transfer test_flat_transfer(void)
{
    return (cw_transfer){.color_count = 1,
                         .colors = {{0, {0.8f, 0.6f, 0.4f}}},
                         .opacity_count = 1,
                         .opacities = {{0, 0.05f}}};
}

cw_transfer test_soft_transfer(void)
{
    return (cw_transfer){
        .color_count = 3,
        .colors = {{0.3, {0.2f, 0.3f, 0.9f}}, {0.6, {0.9f, 0.7f, 0.2f}}, {1, {1, 0.2f, 0.1f}}},
        .opacity_count = 4,
        .opacities = {{0.35, 0}, {0.5, 0.02f}, {0.8, 0.05f}, {1, 0.3f}}};
}

cw_transfer test_tent_transfer(void)
{
    return (cw_transfer){.color_count = 2,
                         .colors = {{0.4, {1, 0.5f, 0.2f}}, {0.6, {0.3f, 0.8f, 1}}},
                         .opacity_count = 3,
                         .opacities = {{0.48, 0}, {0.5, 0.5f}, {0.52, 0}}};
}

cw_picture test_draw(cw_renderer *r, const cw_scene *scene)
{
    cw_error err = {0};
    cw_picture picture;
    assert_ok(cw_render(r, scene, &picture, &err), err);
    return picture;
}

void test_shear(cw_volume *v)
{
    v->affine[0][0] *= -1; /* mirrored */
    v->affine[0][3] *= -1;
    v->affine[0][1] = 0.4 * v->affine[1][1];
    v->affine[0][3] -= 0.4 * v->affine[1][1] * (double)(v->dim[1] - 1) / 2;
}

test_gap test_compare(const cw_picture *a, const cw_picture *b)
{
    test_gap gap = {0};
    const size_t count = 4 * a->width * a->height;
    assert_int_equal(a->width, b->width);
    assert_int_equal(a->height, b->height);
    for (size_t n = 0; n < count; n++) {
        const double d = 255 * fabs((double)a->pixels[n] - (double)b->pixels[n]);
        gap.rmse += d * d;
        gap.max = fmax(gap.max, d);
        assert_true(isfinite(d));
    }
    gap.rmse = sqrt(gap.rmse / (double)count);
    return gap;
}
