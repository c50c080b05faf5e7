/* Draws a mesh by a z-buffer in double precision. Vertices are projected once; then bands of
 * rows are drawn independently, each by one thread: first the nearest triangle of every sample,
 * then its shade.
 *
 * Coordinates are rounded to 1/256 of a sample, as GPUs do. Within a range of 2^17 samples the
 * edge functions of such points are exact in double, and with the top-left rule every sample of
 * a surface belongs to exactly one of its triangles: no cracks, no double hits. */
#include "core/mesh/mesh_triangle.h"
#include "viewer/scene/srgb.h"
#include <cubewright/render.h>

#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/base/thread_pool.h"
#include "core/geometry/vec3.h"

#include <math.h>
#include <stdatomic.h>
#include <string.h>

enum { BAND_ROWS = 16, MAX_SIZE = 16384, MAX_SAMPLES = 4 };

/* A projected vertex: sample coordinates (y down) and depth along the line of sight. Behind the
 * near plane, where nothing can be divided by depth, x and y are still multiplied by it. */
typedef struct point {
    double x, y, z;
} point;

/* The sample rows a triangle may cover; none when last < first. */
typedef struct span {
    int32_t first, last;
} span;

/* The nearest surface of a sample. */
typedef struct hit {
    double z;
    size_t triangle;
} hit;

static const size_t NO_TRIANGLE = SIZE_MAX;

typedef struct scene {
    const cw_mesh *mesh;
    const cw_render_mesh_desc *d;
    double right[3], up[3], forward[3];
    double fill_light[3]; /* unit, towards the light */
    bool perspective;
    double scale;      /* samples per mm, or per unit of slope in perspective */
    double near_mm;    /* surfaces nearer than this are not drawn */
    int width, height; /* in samples */
    double color[3];   /* linear */
    point *points;     /* vertex_count */
    span *spans;       /* triangle_count */
} scene;

/* A triangle ready to be drawn: edge i is opposite corner i, and its function
 * edge[i] . (x, y, 1) is positive inside. Weighted, the three are barycentric coordinates up to
 * a common factor, right in perspective. */
typedef struct facet {
    size_t triangle;
    double edge[3][3], weight[3], z[3];
    bool owns[3]; /* the top-left rule: samples on this edge are ours */
    bool is_back;
    double normal[3]; /* for shading */
} facet;

static double snap_to_grid(double x)
{
    return nearbyint(x * 256) / 256;
}

static double to_linear(uint8_t srgb)
{
    return cwi_srgb_to_linear(srgb / 255.0);
}

static uint8_t to_srgb(double linear)
{
    return (uint8_t)lround(255 * cwi_linear_to_srgb(linear));
}

static bool is_behind(const scene *s, const point *p)
{
    return s->perspective && p->z < s->near_mm;
}

static point project_vertex(const scene *s, size_t v)
{
    double d[3];
    for (size_t a = 0; a < 3; a++)
        d[a] = s->mesh->origin[a] - s->d->camera.eye[a] + (double)s->mesh->positions[3 * v + a];
    point p = {.z = cwi_dot(d, s->forward)};
    const double w = s->perspective ? p.z : 1;
    p.x = s->width / 2.0 * w + s->scale * cwi_dot(d, s->right);
    p.y = s->height / 2.0 * w - s->scale * cwi_dot(d, s->up);
    if (!is_behind(s, &p)) {
        p.x = snap_to_grid(p.x / w);
        p.y = snap_to_grid(p.y / w);
    }
    return p;
}

static void corners_of(const scene *s, size_t t, point p[3])
{
    for (size_t c = 0; c < 3; c++)
        p[c] = s->points[s->mesh->triangles[3 * t + c]];
}

static int behind_count(const scene *s, const point p[3])
{
    return is_behind(s, &p[0]) + is_behind(s, &p[1]) + is_behind(s, &p[2]);
}

/* Returns the samples whose middles lie between two coordinates, within a picture of that
 * size. */
static span sample_span(double low, double high, int size)
{
    return (span){(int32_t)fmin(fmax(ceil(low - 0.5), 0), size),
                  (int32_t)fmax(fmin(floor(high - 0.5), size - 1), -1)};
}

static double min_of_three(double a, double b, double c)
{
    return fmin(fmin(a, b), c);
}

static double max_of_three(double a, double b, double c)
{
    return fmax(fmax(a, b), c);
}

/* Returns the rows of a triangle. A triangle that crosses the near plane may be anywhere. */
static span rows_of(const scene *s, size_t t)
{
    point p[3];
    corners_of(s, t, p);
    const int behind = behind_count(s, p);
    if (behind == 3)
        return (span){0, -1};
    if (behind > 0)
        return (span){0, s->height - 1};
    return sample_span(min_of_three(p[0].y, p[1].y, p[2].y),
                       max_of_three(p[0].y, p[1].y, p[2].y), s->height);
}

static span columns_of(const scene *s, const point p[3])
{
    if (behind_count(s, p) > 0)
        return (span){0, s->width - 1};
    return sample_span(min_of_three(p[0].x, p[1].x, p[2].x),
                       max_of_three(p[0].x, p[1].x, p[2].x), s->width);
}

/* Corners as homogeneous vectors (x, y, w). In front of the near plane w is 1 and depth comes
 * in by the weights, which keeps the edges exact; across it w is the depth, and the
 * determinants below still hold without cutting the triangle [Olano1997]. */
static void make_homogeneous(const scene *s, const point p[3], facet *f, double v[3][3])
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

/* Sets up a facet; returns false for a triangle seen edge-on. */
static bool set_up_facet(const scene *s, size_t t, const point p[3], facet *f)
{
    double v[3][3];
    f->triangle = t;
    make_homogeneous(s, p, f, v);
    for (int c = 0; c < 3; c++)
        cwi_cross(v[(c + 1) % 3], v[(c + 2) % 3], f->edge[c]);
    const double twice_area = cwi_dot(v[0], f->edge[0]);
    f->is_back = twice_area > 0; /* y points down, so the front is clockwise here */
    for (int c = 0; c < 3; c++) {
        for (int a = 0; a < 3 && !f->is_back; a++)
            f->edge[c][a] = -f->edge[c][a];
        f->owns[c] = f->edge[c][0] > 0 || (f->edge[c][0] == 0 && f->edge[c][1] > 0);
    }
    return twice_area != 0;
}

static void edge_values(const facet *f, double x, double y, double e[3])
{
    for (int c = 0; c < 3; c++)
        e[c] = f->edge[c][0] * x + (f->edge[c][1] * y + f->edge[c][2]);
}

static bool is_inside(const facet *f, const double e[3])
{
    for (int c = 0; c < 3; c++)
        if (!(e[c] > 0 || (e[c] == 0 && f->owns[c])))
            return false;
    return true;
}

/* Converts edge functions at a sample to weights of the corners, which sum to 1. */
static void find_weights(const facet *f, const double e[3], double weights[3])
{
    const double b[3] = {e[0] * f->weight[0], e[1] * f->weight[1], e[2] * f->weight[2]};
    for (int c = 0; c < 3; c++)
        weights[c] = b[c] / (b[0] + b[1] + b[2]);
}

static void draw_row(const scene *s, const facet *f, span columns, int y, hit *row)
{
    for (int x = columns.first; x <= columns.last; x++) {
        double e[3], weights[3];
        edge_values(f, x + 0.5, y + 0.5, e);
        if (!is_inside(f, e))
            continue;
        find_weights(f, e, weights);
        const double z = cwi_dot(weights, f->z);
        if (z >= s->near_mm && z < row[x].z)
            row[x] = (hit){z, f->triangle};
    }
}

/* Finds the nearest triangle of every sample in rows first to last; of two at the same depth
 * the first in the mesh wins. */
static void draw_band(const scene *s, int first, int last, hit *hits)
{
    for (size_t i = 0; i < (size_t)(last - first + 1) * (size_t)s->width; i++)
        hits[i] = (hit){INFINITY, NO_TRIANGLE};
    for (size_t t = 0; t < s->mesh->triangle_count; t++) {
        const span rows = s->spans[t];
        if (rows.first > last || rows.last < first || rows.last < rows.first)
            continue;
        point p[3];
        facet f;
        corners_of(s, t, p);
        if (!set_up_facet(s, t, p, &f))
            continue;
        const span columns = columns_of(s, p);
        const int end = rows.last < last ? rows.last : last;
        for (int y = rows.first > first ? rows.first : first; y <= end; y++)
            draw_row(s, &f, columns, y, hits + (size_t)(y - first) * (size_t)s->width);
    }
}

/* Computes the triangle's own normal, on the visible side. */
static void facet_normal(const cw_mesh *mesh, facet *f)
{
    cwi_facet_normal(cwi_mesh_point(mesh, f->triangle, 0),
                     cwi_mesh_point(mesh, f->triangle, f->is_back ? 2 : 1),
                     cwi_mesh_point(mesh, f->triangle, f->is_back ? 1 : 2), f->normal);
    cwi_to_unit(f->normal);
}

/* Interpolates the vertices' normals, turned to the visible side. Both sides are lit, and
 * neither a wrong winding nor wrong normals make a surface black. */
static void surface_normal(const cw_mesh *mesh, const facet *f, const double weights[3],
                           double n[3])
{
    const uint32_t *corner = mesh->triangles + 3 * f->triangle;
    memset(n, 0, 3 * sizeof *n);
    for (size_t c = 0; c < 3 && mesh->normals; c++)
        for (size_t a = 0; a < 3; a++)
            n[a] += weights[c] * (double)mesh->normals[3 * (size_t)corner[c] + a];
    const double side = cwi_dot(n, f->normal);
    if (side == 0)
        memcpy(n, f->normal, 3 * sizeof *n);
    for (int a = 0; a < 3 && side < 0; a++)
        n[a] = -n[a];
    cwi_to_unit(n);
}

/* Computes the linear colour of the surface itself; its inside is redder and darker, unless
 * same_inside. */
static void surface_color(const scene *s, const facet *f, const double weights[3],
                          double rgb[3])
{
    static const double inside[3] = {0.75, 0.22, 0.17};
    const cw_mesh *mesh = s->mesh;
    const bool is_red = f->is_back && !s->d->same_inside;
    for (size_t a = 0; a < 3; a++) {
        double sum = 0;
        for (size_t c = 0; c < 3 && mesh->colors; c++)
            sum +=
                weights[c] *
                to_linear(mesh->colors[4 * (size_t)mesh->triangles[3 * f->triangle + c] + a]);
        rgb[a] = (mesh->colors ? sum : s->color[a]) * (is_red ? inside[a] : 1);
    }
}

/* Computes the direction from the surface to the eye. */
static void to_eye(const scene *s, double x, double y, double v[3])
{
    const double u = (x - s->width / 2.0) / s->scale, w = (s->height / 2.0 - y) / s->scale;
    for (int a = 0; a < 3; a++)
        v[a] = -s->forward[a] - (s->perspective ? u * s->right[a] + w * s->up[a] : 0);
    cwi_to_unit(v);
}

/* Shades a sample: diffuse light from the eye and, softer, from above its left shoulder; a
 * little from everywhere, more from above; a faint highlight [Blinn1977]. The README gives the
 * formula. */
static void shade_sample(const scene *s, const facet *f, double x, double y, double rgb[3])
{
    double e[3], weights[3], n[3], v[3], h[3];
    edge_values(f, x, y, e);
    find_weights(f, e, weights);
    surface_normal(s->mesh, f, weights, n);
    surface_color(s, f, weights, rgb);
    to_eye(s, x, y, v);
    for (int a = 0; a < 3; a++)
        h[a] = v[a] + s->fill_light[a];
    cwi_to_unit(h);
    const double head = fmax(cwi_dot(n, v), 0), fill = fmax(cwi_dot(n, s->fill_light), 0);
    double gloss = fmax(cwi_dot(n, h), 0);
    for (int i = 0; i < 5; i++)
        gloss *= gloss; /* to the 32nd */
    const double light = 0.09 + 0.05 * cwi_dot(n, s->up) + 0.56 * head + 0.44 * fill;
    for (int a = 0; a < 3; a++)
        rgb[a] = fmin(rgb[a] * light + 0.08 * gloss, 1);
}

static void background_at(const scene *s, size_t row, uint8_t rgba[4])
{
    const double t = ((double)row + 0.5) / (double)s->d->height;
    for (int a = 0; a < 4; a++)
        rgba[a] =
            (uint8_t)lround((1 - t) * s->d->background[0][a] + t * s->d->background[1][a]);
}

/* Sums the surface's samples of a pixel, in linear light; returns their number. The facet is
 * kept from call to call: neighbouring samples mostly lie on one triangle. */
static int sum_samples(const scene *s, const hit *hits, int x0, int y0, facet *f, double sum[3])
{
    const int n = s->d->samples;
    int covered = 0;
    for (int i = 0; i < n * n; i++) {
        const int x = x0 + i % n, row = i / n;
        const size_t t = hits[(size_t)row * (size_t)s->width + (size_t)x].triangle;
        if (t == NO_TRIANGLE)
            continue;
        if (t != f->triangle) {
            point p[3];
            corners_of(s, t, p);
            set_up_facet(s, t, p, f);
            facet_normal(s->mesh, f);
        }
        double rgb[3];
        shade_sample(s, f, x + 0.5, y0 + row + 0.5, rgb);
        for (int a = 0; a < 3; a++)
            sum[a] += rgb[a];
        covered++;
    }
    return covered;
}

/* Writes a pixel; the part without samples is background, weighted by its alpha. */
static void put_pixel(const scene *s, const double sum[3], int covered, const uint8_t back[4],
                      uint8_t *pixel)
{
    const int all = s->d->samples * s->d->samples;
    const double open = (all - covered) * (back[3] / 255.0), alpha = covered + open;
    for (int a = 0; a < 3; a++)
        pixel[a] = to_srgb((sum[a] + open * to_linear(back[a])) / alpha);
    pixel[3] = (uint8_t)lround(255 * alpha / all);
}

static void shade_band(const scene *s, size_t first_row, size_t row_count, const hit *hits,
                       cw_image *image)
{
    const int n = s->d->samples;
    facet f = {.triangle = NO_TRIANGLE};
    for (size_t row = 0; row < row_count; row++) {
        const hit *line = hits + row * (size_t)n * (size_t)s->width;
        uint8_t *pixel = image->pixels + 4 * image->width * (first_row + row);
        uint8_t back[4];
        background_at(s, first_row + row, back);
        for (size_t x = 0; x < image->width; x++, pixel += 4) {
            double sum[3] = {0};
            const int covered =
                sum_samples(s, line, (int)x * n, (int)(first_row + row) * n, &f, sum);
            if (covered)
                put_pixel(s, sum, covered, back, pixel);
            else
                memcpy(pixel, back, 4);
        }
    }
}

enum { CHUNK = 1 << 14, WORK = 8 }; /* WORK: of a vertex, in samples that are read */

static void project_chunk(void *context, size_t chunk)
{
    const scene *s = context;
    const size_t end = (chunk + 1) * CHUNK, count = s->mesh->vertex_count;
    for (size_t v = chunk * CHUNK; v < (end < count ? end : count); v++)
        s->points[v] = project_vertex(s, v);
}

static void span_chunk(void *context, size_t chunk)
{
    const scene *s = context;
    const size_t end = (chunk + 1) * CHUNK, count = s->mesh->triangle_count;
    for (size_t t = chunk * CHUNK; t < (end < count ? end : count); t++)
        s->spans[t] = rows_of(s, t);
}

static void project_all(scene *s)
{
    cwi_parallel_for_all((s->mesh->vertex_count + CHUNK - 1) / CHUNK, WORK * CHUNK,
                         s->d->threads, project_chunk, s);
    cwi_parallel_for_all((s->mesh->triangle_count + CHUNK - 1) / CHUNK, WORK * CHUNK,
                         s->d->threads, span_chunk, s);
}

/* A picture that is drawn in bands. */
typedef struct banding {
    const scene *s;
    hit *hits;        /* of each thread */
    size_t band_hits; /* of one */
    cw_image *image;
} banding;

static void draw_one_band(void *context, size_t band)
{
    const banding *b = context;
    const scene *s = b->s;
    hit *hits = b->hits + (size_t)cwi_thread_number() * b->band_hits;
    const size_t first = band * BAND_ROWS, left = b->image->height - first;
    const size_t rows = left < BAND_ROWS ? left : BAND_ROWS;
    const int n = s->d->samples;
    draw_band(s, (int)first * n, (int)(first + rows) * n - 1, hits);
    for (size_t i = 0; i < rows * b->image->width && s->d->depth_mm; i++)
        s->d->depth_mm[first * b->image->width + i] = hits[i].z;
    shade_band(s, first, rows, hits, b->image);
}

static cw_status draw_bands(const scene *s, hit *hits, size_t band_hits, cw_image *image,
                            cw_error *err)
{
    banding b = {s, hits, band_hits, image};
    cw_status st =
        cwi_parallel_for((image->height + BAND_ROWS - 1) / BAND_ROWS, band_hits, s->d->threads,
                         &s->d->progress, "drawing", draw_one_band, &b, err);
    return st == CW_OK ? cwi_progress(&s->d->progress, "drawing", 1, err) : st;
}

static cw_status check_sizes(const cw_render_mesh_desc *d, cw_error *err)
{
    if (d->width > MAX_SIZE || d->height > MAX_SIZE)
        return cwi_fail(err, CW_ERR_ARGUMENT, "a picture of %zu x %zu; the most is %d a side",
                        d->width, d->height, MAX_SIZE);
    if (d->samples < 1 || d->samples > MAX_SAMPLES)
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "%d samples a side of a pixel; 1 to %d was expected", d->samples,
                        MAX_SAMPLES);
    if (d->depth_mm && d->samples != 1)
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "depths are of one sample a pixel, not of %d x %d", d->samples,
                        d->samples);
    return CW_OK;
}

static bool all_zero(const void *bytes, size_t size)
{
    const unsigned char *b = bytes;
    for (size_t i = 0; i < size; i++)
        if (b[i])
            return false;
    return true;
}

static cw_status resolve_desc(const cw_mesh *mesh, const cw_render_mesh_desc *desc,
                              cw_render_mesh_desc *d, cw_error *err)
{
    static const uint8_t bone[4] = {240, 229, 208, 255};
    static const uint8_t light[2][4] = {{248, 250, 252, 255}, {205, 213, 222, 255}};
    *d = desc ? *desc : (cw_render_mesh_desc){0};
    d->width = d->width ? d->width : 1280;
    d->height = d->height ? d->height : 720;
    d->samples = d->samples ? d->samples : 2;
    d->threads = cwi_threads(d->threads);
    if (all_zero(d->color, sizeof d->color))
        memcpy(d->color, bone, sizeof bone);
    if (all_zero(d->background, sizeof d->background))
        memcpy(d->background, light, sizeof light);
    cw_status st = check_sizes(d, err);
    if (st != CW_OK || d->camera.up[0] != 0 || d->camera.up[1] != 0 || d->camera.up[2] != 0)
        return st;
    cw_fit_desc fit = {
        .aspect = (double)d->width / (double)d->height, .fov_deg = 30, .margin = 0.05};
    cw_mesh_bounds(mesh, fit.min, fit.max);
    return cw_camera_fit(&fit, &d->camera, err);
}

static cw_status set_up_scene(const cw_mesh *mesh, const cw_render_mesh_desc *d, scene *s,
                              cw_error *err)
{
    const cw_camera *camera = &d->camera;
    double distance = 0;
    *s = (scene){.mesh = mesh, .d = d};
    cw_status st = cw_camera_axes(camera, s->right, s->up, s->forward, err);
    if (st != CW_OK)
        return st;
    s->width = (int)d->width * d->samples;
    s->height = (int)d->height * d->samples;
    s->perspective = camera->fov_deg > 0;
    for (int a = 0; a < 3; a++) {
        s->fill_light[a] = -0.55 * s->right[a] + 0.65 * s->up[a] - 0.52 * s->forward[a];
        s->color[a] = to_linear(d->color[a]);
        distance += (camera->target[a] - camera->eye[a]) * s->forward[a];
    }
    cwi_to_unit(s->fill_light);
    s->near_mm = s->perspective ? 1e-6 * distance : 0;
    s->scale = s->perspective ? s->height / 2.0 / tan(camera->fov_deg * CWI_PI / 360)
                              : s->height / camera->height_mm;
    s->points = cwi_alloc_array(mesh->vertex_count, sizeof *s->points);
    s->spans = cwi_alloc_array(mesh->triangle_count, sizeof *s->spans);
    if (!s->points || !s->spans)
        return cwi_fail_memory(err);
    return CW_OK;
}

static cw_status draw_scene(scene *s, cw_image *image, cw_error *err)
{
    const size_t n = (size_t)s->d->samples, band_hits = BAND_ROWS * n * (size_t)s->width;
    hit *hits = cwi_alloc_array((size_t)s->d->threads * band_hits, sizeof *hits);
    if (!hits)
        return cwi_fail_memory(err);
    project_all(s);
    cw_status st = draw_bands(s, hits, band_hits, image, err);
    cwi_free(hits);
    return st;
}

cw_status cw_render_mesh(const cw_mesh *mesh, const cw_render_mesh_desc *desc, cw_image *image,
                         cw_error *err)
{
    CWI_REQUIRE(err, mesh, image);
    CWI_REQUIRE_VERSION(err, desc, 0);
    cw_render_mesh_desc d;
    scene s = {0};
    *image = (cw_image){0};
    cw_status st = cw_mesh_check(mesh, err);
    if (st == CW_OK)
        st = resolve_desc(mesh, desc, &d, err);
    if (st == CW_OK)
        st = set_up_scene(mesh, &d, &s, err);
    if (st == CW_OK)
        st = cw_image_alloc(image, d.width, d.height, err);
    if (st == CW_OK)
        st = draw_scene(&s, image, err);

    cwi_free(s.points);
    cwi_free(s.spans);
    if (st != CW_OK)
        cw_image_free(image);
    return st;
}
