/* Projects points onto a screen, and sets up the edge functions of triangles. */
#include "viewer/raster/facet.h"

#include "core/geometry/vec3.h"

#include <math.h>

static double snap_to_grid(double x)
{
    return nearbyint(x * 256) / 256;
}

static bool is_behind(const cwi_screen *s, const cwi_screen_point *p)
{
    return s->perspective && p->z < s->near_mm;
}

static int behind_count(const cwi_screen *s, const cwi_screen_point p[3])
{
    return is_behind(s, &p[0]) + is_behind(s, &p[1]) + is_behind(s, &p[2]);
}

cw_status cwi_screen_set_up(const cw_camera *camera, int width, int height, cwi_screen *s,
                            cw_error *err)
{
    double distance = 0;
    *s = (cwi_screen){.width = width, .height = height, .perspective = camera->fov_deg > 0};
    cw_status st = cw_camera_axes(camera, s->right, s->up, s->forward, err);
    if (st != CW_OK)
        return st;
    for (int a = 0; a < 3; a++) {
        s->eye[a] = camera->eye[a];
        distance += (camera->target[a] - camera->eye[a]) * s->forward[a];
    }
    s->near_mm = s->perspective ? 1e-6 * distance : 0;
    s->scale = s->perspective ? height / 2.0 / tan(camera->fov_deg * CWI_PI / 360)
                              : height / camera->height_mm;
    return CW_OK;
}

cwi_screen_point cwi_screen_project(const cwi_screen *s, const double from_eye[3])
{
    cwi_screen_point p = {.z = cwi_dot(from_eye, s->forward)};
    const double w = s->perspective ? p.z : 1;
    p.x = s->width / 2.0 * w + s->scale * cwi_dot(from_eye, s->right);
    p.y = s->height / 2.0 * w - s->scale * cwi_dot(from_eye, s->up);
    if (!is_behind(s, &p)) {
        p.x = snap_to_grid(p.x / w);
        p.y = snap_to_grid(p.y / w);
    }
    return p;
}

/* Returns the samples whose middles, give or take their reach, lie between two coordinates, within a
 * picture of that size. */
static cwi_sample_span sample_span(double low, double high, double reach, int size)
{
    return (cwi_sample_span){(int32_t)fmin(fmax(ceil(low - 0.5 - reach), 0), size),
                             (int32_t)fmax(fmin(floor(high - 0.5 + reach), size - 1), -1)};
}

static double min_of_three(double a, double b, double c)
{
    return fmin(fmin(a, b), c);
}

static double max_of_three(double a, double b, double c)
{
    return fmax(fmax(a, b), c);
}

cwi_sample_span cwi_screen_rows(const cwi_screen *s, const cwi_screen_point p[3], double reach)
{
    const int behind = behind_count(s, p);
    if (behind == 3)
        return (cwi_sample_span){0, -1};
    if (behind > 0)
        return (cwi_sample_span){0, s->height - 1};
    return sample_span(min_of_three(p[0].y, p[1].y, p[2].y),
                       max_of_three(p[0].y, p[1].y, p[2].y), reach, s->height);
}

cwi_sample_span cwi_screen_columns(const cwi_screen *s, const cwi_screen_point p[3],
                                   double reach)
{
    if (behind_count(s, p) > 0)
        return (cwi_sample_span){0, s->width - 1};
    return sample_span(min_of_three(p[0].x, p[1].x, p[2].x),
                       max_of_three(p[0].x, p[1].x, p[2].x), reach, s->width);
}

/* Corners as homogeneous vectors (x, y, w). In front of the near plane w is 1 and depth comes
 * in by the weights, which keeps the edges exact; across it w is the depth, and the
 * determinants below still hold without cutting the triangle [Olano1997]. */
static void make_homogeneous(const cwi_screen *s, const cwi_screen_point p[3],
                             cwi_screen_facet *f, double v[3][3])
{
    const bool crosses = behind_count(s, p) > 0;
    for (int c = 0; c < 3; c++) {
        const double w = crosses ? p[c].z : 1;
        const bool divided = crosses && !is_behind(s, &p[c]);
        v[c][0] = divided ? p[c].x * w : p[c].x;
        v[c][1] = divided ? p[c].y * w : p[c].y;
        v[c][2] = w;
        f->weight[c] = s->perspective && !crosses ? 1 / p[c].z : 1;
        f->z[c] = p[c].z;
    }
}

bool cwi_facet_set_up(const cwi_screen *s, const cwi_screen_point p[3], cwi_screen_facet *f)
{
    double v[3][3];
    make_homogeneous(s, p, f, v);
    for (int c = 0; c < 3; c++)
        cwi_cross(v[(c + 1) % 3], v[(c + 2) % 3], f->edge[c]);
    f->determinant = cwi_dot(v[0], f->edge[0]);
    f->is_back = f->determinant > 0; /* y points down, so the front is clockwise here */
    for (int c = 0; c < 3; c++) {
        for (int a = 0; a < 3 && !f->is_back; a++)
            f->edge[c][a] = -f->edge[c][a];
        f->owns[c] = f->edge[c][0] > 0 || (f->edge[c][0] == 0 && f->edge[c][1] > 0);
    }
    return f->determinant != 0;
}

void cwi_screen_to_eye(const cwi_screen *s, double x, double y, double v[3])
{
    const double u = (x - s->width / 2.0) / s->scale, w = (s->height / 2.0 - y) / s->scale;
    for (int a = 0; a < 3; a++)
        v[a] = -s->forward[a] - (s->perspective ? u * s->right[a] + w * s->up[a] : 0);
    cwi_to_unit(v);
}
