/* Paints over a picture of slices, sample by sample. */
#include "viewer/image/slice_paint.h"

#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/geometry/box.h"
#include "core/geometry/vec3.h"
#include "core/volume/volume.h"
#include "viewer/scene/slice.h"

#include <math.h>

/* A picture that is painted on. */
typedef struct painting {
    const cwi_slice_paint *paint;
    cwi_frame frame;
    cw_slice slices[CW_MAX_SLICES];
    size_t slice_count;
    cw_picture *picture;
} painting;

/* Adds what a sample shows: its colour times its opacity, and that. */
static void add_sample(const painting *p, double x, double y, double sum[4])
{
    const cwi_frame *f = &p->frame;
    double origin[3], direction[3], eye[3], world[3], rgba[4];
    size_t number;
    cwi_frame_ray(f, x, y, origin, direction);
    const double t = cwi_slice_hit(f, p->slices, p->slice_count, origin, direction, &number);
    if (t == INFINITY)
        return;
    cwi_add_scaled(origin, t, direction, eye);
    cwi_frame_to_world(f, eye, world);
    if (!p->paint->color(p->paint->context, world, rgba))
        return;
    const double opacity = p->paint->opacity * rgba[3];
    const double light = f->scene.depth_cue > 0 ? cwi_frame_cue(f, -eye[2]) : 1;
    const double fraction = y / (double)f->scene.height; /* of the background's lower colour */
    for (int c = 0; c < 3; c++) {
        const double behind = (1 - fraction) * (double)f->scene.background[0][c] +
                              fraction * (double)f->scene.background[1][c];
        sum[c] += opacity * (light * rgba[c] + (1 - light) * behind);
    }
    sum[3] += opacity;
}

/* Blends the colours of a row of pixels. */
static void paint_row(void *context, size_t row)
{
    const painting *p = context;
    const int n = p->frame.scene.samples, all = n * n;
    for (size_t column = 0; column < p->picture->width; column++) {
        double sum[4] = {0};
        float *pixel = p->picture->pixels + 4 * (row * p->picture->width + column);
        for (int s = 0; s < all; s++)
            add_sample(p, (double)column * n + s % n + 0.5, (double)row * n + s / n + 0.5, sum);
        for (int c = 0; c < 4 && sum[3] > 0; c++)
            pixel[c] = (float)((double)pixel[c] * (1 - sum[3] / all) + sum[c] / all);
    }
}

/* Returns true if the box of b's voxels, in voxels of a, lies beyond a's voxels along an axis. */
static bool is_beyond(const cw_volume *a, const cw_volume *b)
{
    double low[3], high[3];
    cwi_box_clear(low, high);
    for (int n = 0; n < 8; n++) {
        double corner[3], world[3], index[3];
        for (int c = 0; c < 3; c++)
            corner[c] = n >> c & 1 ? (double)b->dim[c] - 0.5 : -0.5;
        cw_volume_to_world(b, corner, world);
        if (cw_volume_to_index(a, world, index, NULL) != CW_OK)
            return false;
        cwi_box_add(low, high, index);
    }
    for (int c = 0; c < 3; c++)
        if (high[c] < -0.5 || low[c] > (double)a->dim[c] - 0.5)
            return true;
    return false;
}

static cw_status check_picture(const painting *p, const cw_scene *scene, cw_error *err)
{
    const cwi_frame *f = &p->frame;
    const size_t n = (size_t)f->scene.samples;
    if (scene->mode != CW_MODE_SLICES)
        return cwi_fail(err, CW_ERR_ARGUMENT, "%s are drawn over slices, not in the mode %s",
                        p->paint->what, cw_mode_name(scene->mode));
    if (scene->mesh)
        return cwi_fail(err, CW_ERR_UNSUPPORTED,
                        "%s are not drawn over slices with a mesh before them", p->paint->what);
    if (!p->picture->pixels || p->picture->width * n != f->scene.width ||
        p->picture->height * n != f->scene.height)
        return cwi_fail(err, CW_ERR_ARGUMENT, "a picture of %zu x %zu is not one of this scene",
                        p->picture->width, p->picture->height);
    if (!(p->paint->opacity >= 0 && p->paint->opacity <= 1))
        return cwi_fail(err, CW_ERR_ARGUMENT, "an opacity of %g: 0 to 1 was expected",
                        p->paint->opacity);
    if (is_beyond(&f->volume, p->paint->volume) || is_beyond(p->paint->volume, &f->volume))
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "the %s do not overlap the volume anywhere in the world",
                        p->paint->what);
    return CW_OK;
}

cw_status cwi_slice_paint_draw(const cwi_slice_paint *paint, const cw_scene *scene,
                               cw_picture *picture, cw_error *err)
{
    painting p = {.paint = paint, .picture = picture};
    cw_status st = cwi_frame_init(&p.frame, scene, err);
    if (st == CW_OK)
        st = check_picture(&p, scene, err);
    if (st == CW_OK)
        st = cwi_slices_of(&p.frame.scene, &p.frame.volume, p.slices, &p.slice_count, err);
    return st == CW_OK ? cwi_parallel_for(picture->height, picture->width,
                                          p.frame.scene.threads, &p.frame.scene.progress,
                                          "drawing over slices", paint_row, &p, err)
                       : st;
}
