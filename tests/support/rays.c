/* Computes the colour and the values along one ray, with trilinear samples, gradients and
 * light, in many steps. */
#include "support/rays.h"

#include "support/support.h"

#include <math.h>

cwi_frame test_frame(const cw_scene *scene)
{
    cwi_frame frame;
    cw_error err = {0};
    assert_ok(cwi_frame_init(&frame, scene, &err), err);
    return frame;
}

static double voxel(const cw_volume *v, const size_t at[3])
{
    return (double)((const float *)v->data)[(at[2] * v->dim[1] + at[1]) * v->dim[0] + at[0]];
}

static double difference(const cw_volume *v, const size_t at[3], int axis)
{
    size_t low[3] = {at[0], at[1], at[2]}, high[3] = {at[0], at[1], at[2]};
    low[axis] -= at[axis] > 0;
    high[axis] += at[axis] + 1 < v->dim[axis];
    return low[axis] == high[axis]
               ? 0
               : (voxel(v, high) - voxel(v, low)) / (double)(high[axis] - low[axis]);
}

/* Of the eight samples around a point, the number-th and its weight. */
static double corner(const cw_volume *v, const double index[3], int number, size_t at[3])
{
    double weight = 1;
    for (int a = 0; a < 3; a++) {
        const double low = fmin(fmax(floor(index[a]), 0), fmax((double)v->dim[a] - 2, 0));
        const double share = v->dim[a] > 1 ? index[a] - low : 0;
        at[a] = (size_t)low + (v->dim[a] > 1 && (number >> a & 1));
        weight *= number >> a & 1 ? share : 1 - share;
    }
    return weight;
}

double test_field_at(const cw_volume *v, const double index[3])
{
    double sum = 0;
    for (int n = 0; n < 8; n++) {
        size_t at[3];
        const double weight = corner(v, index, n, at);
        sum += weight * voxel(v, at);
    }
    return sum;
}

void test_gradient_at(const cw_volume *v, const double index[3], double gradient[3])
{
    gradient[0] = gradient[1] = gradient[2] = 0;
    for (int n = 0; n < 8; n++) {
        size_t at[3];
        const double weight = corner(v, index, n, at);
        for (int a = 0; a < 3; a++)
            gradient[a] += weight * difference(v, at, a);
    }
}

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* I = ambient C + sum of (diffuse |n.l| C + specular |n.h|^shininess) I_l */
static void light(const cwi_frame *f, const double g[3], const double direction[3],
                  double color[3])
{
    const cw_material *m = &f->scene.material;
    const double size = sqrt(dot(g, g));
    double sum[3];
    for (int c = 0; c < 3; c++)
        sum[c] = (double)m->ambient * color[c];
    for (size_t n = 0; n < f->scene.light_count && size > 0; n++) {
        const cw_light *l = &f->scene.lights[n];
        double h[3], to[3];
        for (int a = 0; a < 3; a++) {
            to[a] = l->direction[a] / sqrt(dot(l->direction, l->direction));
            h[a] = to[a] - direction[a];
        }
        if (f->scene.one_sided && dot(g, to) >= 0)
            continue;
        const double diffuse = fabs(dot(g, to)) / size,
                     gloss =
                         pow(fabs(dot(g, h)) / size / sqrt(dot(h, h)), (double)m->shininess);
        for (int c = 0; c < 3; c++)
            sum[c] += (double)l->color[c] *
                      ((double)m->diffuse * diffuse * color[c] + (double)m->specular * gloss);
    }
    for (int c = 0; c < 3; c++)
        color[c] = sum[c];
}

static void index_at(const cwi_frame *f, const double o[3], const double d[3], double t,
                     double index[3])
{
    for (int r = 0; r < 3; r++) {
        const double *m = f->index_from_eye + 4 * r;
        index[r] = m[3];
        for (int c = 0; c < 3; c++)
            index[r] += m[c] * (o[c] + t * d[c]);
    }
}

/* Fog from the start of the depth cue on, linear or of one density. */
static double background_share(const cwi_frame *f, double depth)
{
    const double *range = f->scene.cue_range, most = (double)f->scene.depth_cue;
    const double at =
        ((depth - f->near) / (f->far - f->near) - range[0]) / (range[1] - range[0]);
    if (at <= 0)
        return 0;
    return f->scene.cue_form == CW_CUE_EXPONENTIAL ? 1 - pow(1 - most, at) : most * fmin(at, 1);
}

void test_ray(const cwi_frame *f, double x, double y, size_t steps, double out[4])
{
    double o[3], d[3], parts[2][2], index[3], g[3], m[3][3], color[3], opacity, left = 1;
    cwi_frame_ray(f, x, y, o, d);
    cwi_frame_gradient_matrix(f, m);
    const int count = cwi_frame_clip(f, o, d, parts);
    const double share = y / (double)f->scene.height;
    out[0] = out[1] = out[2] = 0;
    for (size_t n = 0; n < (size_t)count * steps; n++) {
        const double *part = parts[n / steps];
        const double h = (part[1] - part[0]) / (double)steps;
        const double t = part[0] + ((double)(n % steps) + 0.5) * h;
        index_at(f, o, d, t, index);
        cw_transfer_at(&f->transfer, test_field_at(&f->volume, index), color, &opacity);
        double depth = -log(1 - fmin(opacity, 1 - 1e-6)) / f->opacity_units * h;
        if (f->scene.lit || f->transfer.gradient_count) {
            test_gradient_at(&f->volume, index, g);
            const double e[3] = {dot(m[0], g), dot(m[1], g), dot(m[2], g)};
            depth *= cw_transfer_gradient_factor(&f->transfer, sqrt(dot(e, e)) / f->unit_mm);
            if (f->scene.lit)
                light(f, e, d, color);
        }
        const double far = background_share(f, -t * d[2]);
        for (int c = 0; c < 3; c++) {
            const double back = (1 - share) * (double)f->scene.background[0][c] +
                                share * (double)f->scene.background[1][c];
            out[c] += left * (1 - exp(-depth)) * ((1 - far) * color[c] + far * back);
        }
        left *= exp(-depth);
    }
    out[3] = 1 - left;
}

void test_ray_values(const cwi_frame *f, double x, double y, size_t steps, double out[3])
{
    double o[3], d[3], parts[2][2], index[3];
    cwi_frame_ray(f, x, y, o, d);
    out[0] = INFINITY;
    out[1] = -INFINITY;
    out[2] = 0;
    if (cwi_frame_clip(f, o, d, parts) != 1)
        fail_msg("the ray through %g, %g does not meet the volume once", x, y);
    for (size_t n = 0; n < steps; n++) {
        const double share = ((double)n + 0.5) / (double)steps;
        index_at(f, o, d, parts[0][0] + share * (parts[0][1] - parts[0][0]), index);
        const double value = test_field_at(&f->volume, index);
        out[0] = fmin(out[0], value);
        out[1] = fmax(out[1], value);
        out[2] += value / (double)steps;
    }
}
