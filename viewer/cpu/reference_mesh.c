/* Draws a mesh by a z-buffer in double precision. Vertices are projected once; then bands of
 * rows are drawn independently, each by one thread: first the nearest triangle of every sample,
 * then its shade. */
#include "core/mesh/mesh_triangle.h"
#include "viewer/raster/facet.h"
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

/* The nearest surface of a sample. */
typedef struct hit {
    double z;
    size_t triangle;
} hit;

static const size_t NO_TRIANGLE = SIZE_MAX;

typedef struct scene {
    const cw_mesh *mesh;
    const cw_render_mesh_desc *d;
    cwi_screen screen;
    double fill_light[3];     /* unit, towards the light */
    double color[3];          /* linear */
    cwi_screen_point *points; /* vertex_count */
    cwi_sample_span *spans;   /* triangle_count */
} scene;

/* A triangle ready to be drawn and shaded. */
typedef struct facet {
    size_t triangle;
    cwi_screen_facet on_screen;
    double normal[3]; /* for shading */
} facet;

static double to_linear(uint8_t srgb)
{
    return cwi_srgb_to_linear(srgb / 255.0);
}

static uint8_t to_srgb(double linear)
{
    return (uint8_t)lround(255 * cwi_linear_to_srgb(linear));
}

static cwi_screen_point project_vertex(const scene *s, size_t v)
{
    double d[3];
    for (size_t a = 0; a < 3; a++)
        d[a] = s->mesh->origin[a] - s->screen.eye[a] + (double)s->mesh->positions[3 * v + a];
    return cwi_screen_project(&s->screen, d);
}

static void corners_of(const scene *s, size_t t, cwi_screen_point p[3])
{
    for (size_t c = 0; c < 3; c++)
        p[c] = s->points[s->mesh->triangles[3 * t + c]];
}

static cwi_sample_span rows_of(const scene *s, size_t t)
{
    cwi_screen_point p[3];
    corners_of(s, t, p);
    return cwi_screen_rows(&s->screen, p, 0);
}

static void draw_row(const scene *s, const facet *f, cwi_sample_span columns, int y, hit *row)
{
    const cwi_screen_facet *on_screen = &f->on_screen;
    for (int x = columns.first; x <= columns.last; x++) {
        double e[3], weights[3];
        cwi_facet_edges(on_screen, x + 0.5, y + 0.5, e);
        if (!cwi_facet_is_inside(on_screen, e))
            continue;
        cwi_facet_weights(on_screen, e, weights);
        const double z = cwi_dot(weights, on_screen->z);
        if (z >= s->screen.near_mm && z < row[x].z)
            row[x] = (hit){z, f->triangle};
    }
}

/* Finds the nearest triangle of every sample in rows first to last; of two at the same depth
 * the first in the mesh wins. */
static void draw_band(const scene *s, int first, int last, hit *hits)
{
    for (size_t i = 0; i < (size_t)(last - first + 1) * (size_t)s->screen.width; i++)
        hits[i] = (hit){INFINITY, NO_TRIANGLE};
    for (size_t t = 0; t < s->mesh->triangle_count; t++) {
        const cwi_sample_span rows = s->spans[t];
        if (rows.first > last || rows.last < first || rows.last < rows.first)
            continue;
        cwi_screen_point p[3];
        facet f = {.triangle = t};
        corners_of(s, t, p);
        if (!cwi_facet_set_up(&s->screen, p, &f.on_screen))
            continue;
        const cwi_sample_span columns = cwi_screen_columns(&s->screen, p, 0);
        const int end = rows.last < last ? rows.last : last;
        for (int y = rows.first > first ? rows.first : first; y <= end; y++)
            draw_row(s, &f, columns, y, hits + (size_t)(y - first) * (size_t)s->screen.width);
    }
}

/* Computes the triangle's own normal, on the visible side. */
static void facet_normal(const cw_mesh *mesh, facet *f)
{
    cwi_facet_normal(cwi_mesh_point(mesh, f->triangle, 0),
                     cwi_mesh_point(mesh, f->triangle, f->on_screen.is_back ? 2 : 1),
                     cwi_mesh_point(mesh, f->triangle, f->on_screen.is_back ? 1 : 2),
                     f->normal);
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
    const bool is_red = f->on_screen.is_back && !s->d->same_inside;
    for (size_t a = 0; a < 3; a++) {
        double sum = 0;
        for (size_t c = 0; c < 3 && mesh->colors; c++)
            sum +=
                weights[c] *
                to_linear(mesh->colors[4 * (size_t)mesh->triangles[3 * f->triangle + c] + a]);
        rgb[a] = (mesh->colors ? sum : s->color[a]) * (is_red ? inside[a] : 1);
    }
}

/* Shades a sample: diffuse light from the eye and, softer, from above its left shoulder; a
 * little from everywhere, more from above; a faint highlight [Blinn1977]. The README gives the
 * formula. */
static void shade_sample(const scene *s, const facet *f, double x, double y, double rgb[3])
{
    double e[3], weights[3], n[3], v[3], h[3];
    cwi_facet_edges(&f->on_screen, x, y, e);
    cwi_facet_weights(&f->on_screen, e, weights);
    surface_normal(s->mesh, f, weights, n);
    surface_color(s, f, weights, rgb);
    cwi_screen_to_eye(&s->screen, x, y, v);
    for (int a = 0; a < 3; a++)
        h[a] = v[a] + s->fill_light[a];
    cwi_to_unit(h);
    const double head = fmax(cwi_dot(n, v), 0), fill = fmax(cwi_dot(n, s->fill_light), 0);
    double gloss = fmax(cwi_dot(n, h), 0);
    for (int i = 0; i < 5; i++)
        gloss *= gloss; /* to the 32nd */
    const double light = 0.09 + 0.05 * cwi_dot(n, s->screen.up) + 0.56 * head + 0.44 * fill;
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
        const size_t t = hits[(size_t)row * (size_t)s->screen.width + (size_t)x].triangle;
        if (t == NO_TRIANGLE)
            continue;
        if (t != f->triangle) {
            cwi_screen_point p[3];
            corners_of(s, t, p);
            f->triangle = t;
            cwi_facet_set_up(&s->screen, p, &f->on_screen);
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
        const hit *line = hits + row * (size_t)n * (size_t)s->screen.width;
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
    *s = (scene){.mesh = mesh, .d = d};
    cw_status st = cwi_screen_set_up(&d->camera, (int)d->width * d->samples,
                                     (int)d->height * d->samples, &s->screen, err);
    if (st != CW_OK)
        return st;
    const cwi_screen *screen = &s->screen;
    for (int a = 0; a < 3; a++) {
        s->fill_light[a] =
            -0.55 * screen->right[a] + 0.65 * screen->up[a] - 0.52 * screen->forward[a];
        s->color[a] = to_linear(d->color[a]);
    }
    cwi_to_unit(s->fill_light);
    s->points = cwi_alloc_array(mesh->vertex_count, sizeof *s->points);
    s->spans = cwi_alloc_array(mesh->triangle_count, sizeof *s->spans);
    if (!s->points || !s->spans)
        return cwi_fail_memory(err);
    return CW_OK;
}

static cw_status draw_scene(scene *s, cw_image *image, cw_error *err)
{
    const size_t n = (size_t)s->d->samples, band_hits = BAND_ROWS * n * (size_t)s->screen.width;
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
