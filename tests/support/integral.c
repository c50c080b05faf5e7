/* Integrates emission and absorption along the rays of a picture, step by step in double
 * precision. */
#include "support/integral.h"

#include "viewer/scene/frame_setup.h"

#include "core/base/parallel.h"
#include "core/geometry/affine.h"

#include <math.h>
#include <string.h>

/* The eight voxels around a point and their shares. */
typedef struct corners {
    double value[8], share[8];
} corners;

static corners corners_at(const cw_volume *v, const double at[3])
{
    corners c;
    double s[3];
    size_t low[3];
    for (int a = 0; a < 3; a++) {
        const double last = (double)v->dim[a] - 1, p = fmin(fmax(at[a], 0), last);
        low[a] = (size_t)fmin(floor(p), fmax(last - 1, 0));
        s[a] = p - (double)low[a];
    }
    for (size_t n = 0; n < 8; n++) {
        size_t i[3];
        c.share[n] = 1;
        for (size_t a = 0; a < 3; a++) {
            const size_t up = n >> a & 1;
            i[a] = low[a] + up < v->dim[a] ? low[a] + up : low[a];
            c.share[n] *= up ? s[a] : 1 - s[a];
        }
        c.value[n] =
            (double)((const float *)v->data)[(i[2] * v->dim[1] + i[1]) * v->dim[0] + i[0]];
    }
    return c;
}

/* Emission and extinction. */
static void stuff_of(const cwi_frame *f, double value, double out[4])
{
    double opacity;
    cw_transfer_at(&f->transfer, value, out, &opacity);
    out[3] = cwi_frame_extinction(f, opacity);
    for (int c = 0; c < 3; c++)
        out[c] *= out[3];
}

static void stuff_at(const cwi_frame *f, const double eye[3], double out[4])
{
    double index[3], value = 0, one[4];
    cwi_affine_apply(f->index_from_eye, eye, index);
    const corners c = corners_at(&f->volume, index);
    if (!f->scene.texture.colors_first) {
        for (int n = 0; n < 8; n++)
            value += c.share[n] * c.value[n];
        stuff_of(f, value, out);
        return;
    }
    memset(out, 0, 4 * sizeof *out);
    for (int n = 0; n < 8; n++) {
        stuff_of(f, c.value[n], one);
        for (int k = 0; k < 4; k++)
            out[k] += c.share[n] * one[k];
    }
}

static void along(const cwi_frame *f, const double origin[3], const double direction[3],
                  const double interval[2], double step, double sum[4])
{
    const double length = interval[1] - interval[0], count = ceil(length / step);
    const double h = length / count;
    for (double n = 0; n < count; n++) {
        double eye[3], stuff[4];
        for (int a = 0; a < 3; a++)
            eye[a] = origin[a] + (interval[0] + (n + 0.5) * h) * direction[a];
        stuff_at(f, eye, stuff);
        if (!(stuff[3] > 0))
            continue;
        const double opacity = -expm1(-stuff[3] * h), light = (1 - sum[3]) * opacity;
        for (int c = 0; c < 3; c++)
            sum[c] += light * stuff[c] / stuff[3];
        sum[3] += light;
    }
}

typedef struct drawing {
    const cwi_frame *f;
    double step_vox;
    cw_picture picture;
} drawing;

static void draw_row(void *context, size_t y)
{
    const drawing *d = context;
    for (size_t x = 0; x < d->picture.width; x++) {
        double origin[3], direction[3], intervals[2][2], sum[4] = {0};
        cwi_frame_ray(d->f, (double)x + 0.5, (double)y + 0.5, origin, direction);
        const int count = cwi_frame_clip(d->f, origin, direction, intervals);
        for (int n = 0; n < count; n++)
            along(d->f, origin, direction, intervals[n], d->step_vox, sum);
        for (size_t c = 0; c < 4; c++)
            d->picture.pixels[4 * (y * d->picture.width + x) + c] = (float)sum[c];
    }
}

cw_picture test_integral(const cw_scene *scene, double step_vox)
{
    cw_error err = {0};
    cwi_frame f;
    cw_picture picture;
    assert_ok(cwi_frame_init(&f, scene, &err), err);
    assert_int_equal(f.volume.type, CW_F32);
    assert_ok(cw_picture_alloc(&picture, f.scene.width, f.scene.height, &err), err);
    drawing d = {&f, step_vox, picture};
    cwi_parallel_for_all(picture.height, picture.width << 20, 0, draw_row, &d);
    return picture;
}
