/* Sets up slices through a volume, their colours, and cameras that face them as radiologists
 * do. */
#include "viewer/scene/slice.h"

#include "core/base/status.h"
#include "core/geometry/affine.h"
#include "core/geometry/vec3.h"

#include <math.h>
#include <string.h>

/* The directions in which radiologists look at slices across each axis of LPS. Sagittal: from
 * the left side, the nose to the picture's left; coronal: from the front; axial: from the
 * feet. */
static const struct {
    double forward[3], up[3], color[3];
} habits[] = {{{-1, 0, 0}, {0, 0, 1}, {0.95, 0.80, 0.25}},
              {{0, 1, 0}, {0, 0, 1}, {0.35, 0.80, 0.40}},
              {{0, 0, 1}, {0, -1, 0}, {0.95, 0.35, 0.30}}};

static const double oblique[3] = {0.70, 0.50, 0.95};

static cw_status make_unit(cw_slice *s, cw_error *err)
{
    const double length = cwi_length(s->normal);
    if (!isnormal(length) || !isfinite(s->distance_mm))
        return cwi_fail(err, CW_ERR_ARGUMENT, "a slice has no direction or place");
    for (int a = 0; a < 3; a++)
        s->normal[a] /= length;
    s->distance_mm /= length;
    return CW_OK;
}

static void find_middle(const cw_volume *v, double world[3])
{
    double index[3];
    for (int a = 0; a < 3; a++)
        index[a] = ((double)v->dim[a] - 1) / 2;
    cw_volume_to_world(v, index, world);
}

cw_status cwi_slices_of(const cw_scene *scene, const cw_volume *volume,
                        cw_slice slices[CW_MAX_SLICES], size_t *count, cw_error *err)
{
    double middle[3];
    cw_status st = CW_OK;
    *count = scene->slice_count > 0 ? scene->slice_count : 3;
    find_middle(volume, middle);
    for (size_t n = 0; n < *count && st == CW_OK; n++) {
        slices[n] = scene->slices[n];
        if (scene->slice_count == 0) {
            slices[n] = (cw_slice){.distance_mm = middle[2 - n]};
            slices[n].normal[2 - n] = 1;
        }
        st = make_unit(&slices[n], err);
    }
    return st;
}

static int main_axis(const double n[3])
{
    const double x = fabs(n[0]), y = fabs(n[1]), z = fabs(n[2]);
    return z >= x && z >= y ? 2 : y >= x ? 1 : 0;
}

void cwi_slice_color(const cw_slice *slice, double srgb[3])
{
    const int axis = main_axis(slice->normal);
    const bool along = fabs(slice->normal[axis]) > 0.9999;
    memcpy(srgb, along ? habits[axis].color : oblique, 3 * sizeof *srgb);
}

/* Finds where the plane meets the edges of the volume's box, in the picture's directions: low
 * and high of right and up. Returns false when it does not. */
static bool find_extent(const cw_volume *v, const cw_slice *s, const double axes[2][3],
                        double extent[2][2])
{
    bool any = false;
    for (int edge = 0; edge < 12; edge++) {
        const int axis = edge / 4, b = (axis + 1) % 3, c = (axis + 2) % 3;
        double ends[2][3], side[2];
        for (int e = 0; e < 2; e++) {
            double index[3];
            const int up[3] = {e, edge & 1, edge >> 1 & 1};
            const int of[3] = {axis, b, c};
            for (int a = 0; a < 3; a++) {
                const double last = (double)v->dim[of[a]] - 1;
                index[of[a]] = v->dim[of[a]] == 1 ? up[a] - 0.5 : up[a] * last;
            }
            cw_volume_to_world(v, index, ends[e]);
            side[e] = cwi_dot(s->normal, ends[e]) - s->distance_mm;
        }
        if ((side[0] > 0) == (side[1] > 0) && side[0] != 0 && side[1] != 0)
            continue;
        const double fraction = side[0] == side[1] ? 0 : side[0] / (side[0] - side[1]);
        for (int d = 0; d < 2; d++) {
            const double at = (1 - fraction) * cwi_dot(axes[d], ends[0]) +
                              fraction * cwi_dot(axes[d], ends[1]);
            extent[d][0] = any ? fmin(extent[d][0], at) : at;
            extent[d][1] = any ? fmax(extent[d][1], at) : at;
        }
        any = true;
    }
    return any;
}

cw_status cw_slice_camera(const cw_volume *volume, const cw_slice *slice, double aspect,
                          cw_camera *camera, cw_error *err)
{
    CWI_REQUIRE(err, volume, slice, camera);
    static const double VIEW_MARGIN = 0.02; /* of the height, above and below */
    cw_volume v;
    cw_slice s = *slice;
    double axes[3][3], extent[2][2];
    cw_status st = cw_volume_resolve(volume, &v, err);
    if (st == CW_OK)
        st = make_unit(&s, err);
    if (st == CW_OK && !(aspect > 0 && isfinite(aspect)))
        st = cwi_fail(err, CW_ERR_ARGUMENT, "a picture %g times as wide as high", aspect);
    if (st != CW_OK)
        return st;
    const int axis = main_axis(s.normal);
    const double side = cwi_dot(s.normal, habits[axis].forward) < 0 ? -1 : 1;
    cw_camera c = {.height_mm = 1};
    memcpy(c.up, habits[axis].up, sizeof c.up);
    for (int a = 0; a < 3; a++)
        c.target[a] = side * s.normal[a];
    st = cw_camera_axes(&c, axes[0], axes[1], axes[2], err);
    if (st != CW_OK)
        return st;
    if (!find_extent(&v, &s, (const double(*)[3])axes, extent))
        return cwi_fail(err, CW_ERR_ARGUMENT, "the slice misses the volume");
    const double wide = extent[0][1] - extent[0][0], tall = extent[1][1] - extent[1][0];
    c.height_mm = fmax(fmax(tall, wide / aspect), 1e-6) / (1 - 2 * VIEW_MARGIN);
    for (int a = 0; a < 3; a++) {
        c.target[a] = s.distance_mm * s.normal[a] +
                      (extent[0][0] + extent[0][1]) / 2 * axes[0][a] +
                      (extent[1][0] + extent[1][1]) / 2 * axes[1][a];
        c.eye[a] = c.target[a] - c.height_mm * axes[2][a];
    }
    *camera = c;
    return CW_OK;
}

/* Returns true if a point of a slice has a value. Slices in a face of the volume, or in a clip
 * plane, are drawn: they get some tolerance. */
static bool has_value(const cwi_frame *f, const double p[3])
{
    static const double ROUNDING = 1e-3; /* voxels, or units of eye space */
    double index[3], world[3];
    bool kept = true;
    cwi_affine_apply(f->index_from_eye, p, index);
    for (int a = 0; a < 3; a++) {
        if (!(index[a] >= f->low[a] - ROUNDING && index[a] <= f->high[a] + ROUNDING))
            return false;
        index[a] = fmin(fmax(index[a], f->low[a]), f->high[a]);
    }
    for (size_t n = 0; n < f->scene.clip_count; n++)
        kept = kept && cwi_dot(f->clips[n], p) >=
                           f->clips[n][3] + (f->scene.cut_away ? ROUNDING : -ROUNDING);
    if (f->scene.clip_count > 0 && kept == f->scene.cut_away)
        return false;
    cw_volume_to_world(&f->volume, index, world);
    return !isnan(cw_volume_sample(&f->volume, world));
}

double cwi_slice_hit(const cwi_frame *f, const cw_slice *slices, size_t count,
                     const double origin[3], const double direction[3], size_t *number)
{
    double nearest = INFINITY;
    for (size_t n = 0; n < count; n++) {
        double normal[3], p[3];
        for (int a = 0; a < 3; a++)
            normal[a] = cwi_dot(f->axes[a], slices[n].normal);
        const double distance =
            (slices[n].distance_mm - cwi_dot(slices[n].normal, f->eye_mm)) / f->unit_mm;
        const double slope = cwi_dot(normal, direction);
        const double t = (distance - cwi_dot(normal, origin)) / slope;
        cwi_add_scaled(origin, t, direction, p);
        if (!(fabs(slope) >= 1e-6 && t < nearest && -p[2] >= f->near) || !has_value(f, p))
            continue;
        nearest = t;
        *number = n;
    }
    return nearest;
}
