/* Finds the nearest thing seen at a pixel: a mesh, a slice, or a volume as its mode shows
 * it. */
#include "core/geometry/vec3.h"
#include "viewer/interact/pick_mesh.h"
#include "viewer/interact/pick_volume.h"
#include "viewer/scene/gradient_volume.h"
#include "viewer/scene/slice.h"

#include "core/base/status.h"
#include "core/volume/volume.h"

#include <math.h>
#include <string.h>

/* A point of the picture, in samples, and the ray through it in eye space. */
typedef struct pixel_ray {
    const cwi_frame *frame;
    double x, y, origin[3], direction[3];
} pixel_ray;

/* Takes the point at t along the ray. */
static void take_point(const pixel_ray *at, cw_pick_kind kind, double t, cw_picked *out)
{
    double eye[3];
    cwi_add_scaled(at->origin, t, at->direction, eye);
    *out = (cw_picked){.kind = kind, .depth_mm = -eye[2] * at->frame->unit_mm};
    cwi_frame_to_world(at->frame, eye, out->point);
}

static void take_mesh(const pixel_ray *at, const cwi_mesh_hit *hit, cw_picked *out)
{
    const cw_mesh *m = at->frame->scene.mesh;
    take_point(at, CW_PICK_MESH, hit->t, out);
    out->number = hit->triangle;
    out->value = NAN;
    if (!m->scalars || hit->triangle == SIZE_MAX)
        return;
    out->value = 0;
    for (size_t n = 0; n < 3; n++)
        out->value += hit->weights[n] * (double)m->scalars[m->triangles[3 * hit->triangle + n]];
}

/* Returns the field at the ray's point; rounding may have put that beyond the volume's face. */
static double value_of(const cwi_frame *f, const double point[3])
{
    double index[3], inside[3];
    if (cw_volume_to_index(&f->volume, point, index, NULL) != CW_OK)
        return NAN;
    for (int a = 0; a < 3; a++)
        index[a] = fmin(fmax(index[a], f->low[a]), f->high[a]);
    cw_volume_to_world(&f->volume, index, inside);
    return cw_volume_sample(&f->volume, inside);
}

static cw_status take_slice(const pixel_ray *at, double mesh_t, cw_picked *out, cw_error *err)
{
    cw_slice slices[CW_MAX_SLICES];
    size_t count, number = 0;
    const cwi_frame *f = at->frame;
    cw_status st = cwi_slices_of(&f->scene, &f->volume, slices, &count, err);
    if (st != CW_OK)
        return st;
    const double t = cwi_slice_hit(f, slices, count, at->origin, at->direction, &number);
    if (t == INFINITY || t > mesh_t)
        return CW_OK;
    take_point(at, CW_PICK_SLICE, t, out);
    out->number = number;
    out->value = value_of(f, out->point);
    return CW_OK;
}

/* Takes the volume's point, if it is in front of the mesh, which `out` has if it is met. */
static cw_status take_volume(const pixel_ray *at, double mesh_t, cw_picked *out, cw_error *err)
{
    const cwi_frame *f = at->frame;
    const double depth = mesh_t < INFINITY ? out->depth_mm / f->unit_mm : INFINITY;
    cwi_volume_hit hit;
    cw_status st = CW_OK;
    if (cwi_volume_kind(&f->volume))
        st = cwi_pick_uneven(f, at->x, at->y, depth, &hit, err);
    else if (cw_mode_is_intensity(f->scene.mode))
        hit = cwi_pick_intensity(f, at->x, at->y, depth);
    else
        hit = cwi_pick_blended(f, at->x, at->y, depth);
    if (st != CW_OK || hit.t == INFINITY || (mesh_t < INFINITY && hit.opacity < 0.5))
        return st;
    take_point(at, CW_PICK_VOLUME, hit.t, out);
    out->value = isnan(hit.value) ? value_of(f, out->point) : hit.value;
    return CW_OK;
}

static cw_status pick_nearest(const pixel_ray *at, cw_picked *out, cw_error *err)
{
    const cwi_frame *f = at->frame;
    cwi_mesh_hit hit = {.t = INFINITY};
    if (f->scene.mesh)
        hit = cwi_pick_mesh(f, at->origin, at->direction);
    if (hit.t < INFINITY)
        take_mesh(at, &hit, out);
    if (f->scene.mode == CW_MODE_SLICES)
        return take_slice(at, hit.t, out, err);
    return f->volume.data ? take_volume(at, hit.t, out, err) : CW_OK;
}

cw_status cw_pick(const cw_scene *scene, const double pixel[2], cw_picked *picked,
                  cw_error *err)
{
    CWI_REQUIRE(err, scene, pixel, picked);
    cwi_frame f;
    cwi_gradient_volume gradients = {0};
    memset(picked, 0, sizeof *picked);
    cw_status st = cwi_frame_init(&f, scene, err);
    if (st == CW_OK && !(isfinite(pixel[0]) && isfinite(pixel[1])))
        st = cwi_fail(err, CW_ERR_ARGUMENT, "there is no pixel %g, %g", pixel[0], pixel[1]);
    if (st != CW_OK)
        return st;
    pixel_ray at = {&f, pixel[0] * f.scene.samples, pixel[1] * f.scene.samples, {0}, {0}};
    if (!(at.x >= 0 && at.x <= (double)f.scene.width && at.y >= 0 &&
          at.y <= (double)f.scene.height))
        return CW_OK;
    cwi_frame_ray(&f, at.x, at.y, at.origin, at.direction);
    /* light does not count; the factor of gradients does */
    f.scene.lit = false;
    st = cwi_gradient_volume_take(&gradients, &f, err);
    if (st == CW_OK)
        st = pick_nearest(&at, picked, err);
    cwi_gradient_volume_free(&gradients);
    return st;
}
