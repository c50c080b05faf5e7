/* Draws surfaces: projects their vertices, sorts their triangles by bands of rows, and draws each band by
 * itself, on one thread: first the nearest triangle of every sample, then its shade. */
#include "viewer/appearance/look_draw.h"

#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/base/thread_pool.h"
#include "core/geometry/triangle.h"
#include "viewer/appearance/look_shade.h"

#include <math.h>
#include <string.h>

enum { BAND_ROWS = 16, SAMPLES = 4, CHUNK = 1 << 14, WORK = 8 };

/* Samples from the pixel's middle, y down: one in each row and in each column of a grid of 4 x 4, as
 * Direct3D and Vulkan place them. Pictures of OpenGL are upside down in memory: so is this. */
static const double SAMPLE_AT[SAMPLES][2] = {
    {-0.125, 0.375}, {0.375, 0.125}, {-0.375, -0.125}, {0.125, -0.375}};

static const double SAMPLE_REACH = 0.375;

static const uint32_t NO_TRIANGLE = UINT32_MAX;

/* The nearest surface of a sample. */
typedef struct hit {
    float closeness; /* 1 / depth */
    uint32_t triangle;
} hit;

typedef struct drawing {
    const cwi_look_model *model;
    const cwi_look_picture *picture;
    cwi_screen screen;
    cwi_look_light light;
    cwi_screen_point *points; /* of vertices */
    cwi_sample_span *spans;   /* of triangles: rows of pixels */
    size_t *band_start;       /* bands + 1, into band_triangles */
    uint32_t *band_triangles;
    size_t bands;
    hit *hits; /* of a band, for each thread */
    uint8_t *rgba;
} drawing;

/* A triangle ready to be shaded. What varies over it, times its closeness, is a function of x, y and 1: so
 * are, up to a common factor, normals and texture coordinates. */
typedef struct facet {
    uint32_t triangle;
    cwi_screen_facet on_screen;
    const cwi_look_part *part;
    double own_normal[3];
    double closeness[3], normal[3][3], uv[2][3];
} facet;

static double value_at(const double function[3], double x, double y)
{
    return function[0] * x + (function[1] * y + function[2]);
}

/* --- projection --------------------------------------------------------------------------- */

static void project_chunk(void *context, size_t chunk)
{
    const drawing *d = context;
    const cwi_look_model *m = d->model;
    const size_t end = (chunk + 1) * CHUNK, count = m->vertex_count;
    double shift[3];
    cwi_sub(m->origin, d->screen.eye, shift);
    for (size_t v = chunk * CHUNK; v < (end < count ? end : count); v++) {
        double from_eye[3];
        for (int a = 0; a < 3; a++)
            from_eye[a] = shift[a] + (double)m->positions[v][a];
        d->points[v] = cwi_screen_project(&d->screen, from_eye);
    }
}

static void corners_of(const drawing *d, size_t t, cwi_screen_point p[3])
{
    for (int c = 0; c < 3; c++)
        p[c] = d->points[d->model->triangles[t][c]];
}

/* Returns twice the area of a triangle on the screen; it is negative for one seen from its front. */
static double area_of(const cwi_screen_point p[3])
{
    return (p[1].x - p[0].x) * (p[2].y - p[0].y) - (p[2].x - p[0].x) * (p[1].y - p[0].y);
}

/* Returns the rows of pixels that a triangle may cover; none for one that shows its back. */
static cwi_sample_span rows_of(const drawing *d, size_t t)
{
    const double near_mm = d->screen.near_mm;
    cwi_screen_point p[3];
    corners_of(d, t, p);
    const bool crosses = p[0].z < near_mm || p[1].z < near_mm || p[2].z < near_mm;
    const cwi_sample_span columns = cwi_screen_columns(&d->screen, p, SAMPLE_REACH);
    return (crosses || area_of(p) < 0) && columns.first <= columns.last
               ? cwi_screen_rows(&d->screen, p, SAMPLE_REACH)
               : (cwi_sample_span){0, -1};
}

static void span_chunk(void *context, size_t chunk)
{
    const drawing *d = context;
    const size_t end = (chunk + 1) * CHUNK, count = d->model->triangle_count;
    for (size_t t = chunk * CHUNK; t < (end < count ? end : count); t++)
        d->spans[t] = rows_of(d, t);
}

/* Return the bands of rows; the last is before the first for no rows. */
static int first_band(cwi_sample_span rows)
{
    return rows.first / BAND_ROWS;
}

static int last_band(cwi_sample_span rows)
{
    return rows.first <= rows.last ? rows.last / BAND_ROWS : -1;
}

/* Lists the triangles of each band, in their order in the model. */
static cw_status sort_by_bands(drawing *d, cw_error *err)
{
    const size_t count = d->model->triangle_count;
    memset(d->band_start, 0, (d->bands + 1) * sizeof *d->band_start);
    for (size_t t = 0; t < count; t++)
        for (int b = first_band(d->spans[t]); b <= last_band(d->spans[t]); b++)
            d->band_start[b + 1]++;
    for (size_t b = 0; b < d->bands; b++)
        d->band_start[b + 1] += d->band_start[b];
    d->band_triangles = cwi_alloc_array(d->band_start[d->bands], sizeof *d->band_triangles);
    if (!d->band_triangles)
        return cwi_fail_memory(err);
    for (size_t t = 0; t < count; t++)
        for (int b = first_band(d->spans[t]); b <= last_band(d->spans[t]); b++)
            d->band_triangles[d->band_start[b]++] = (uint32_t)t;
    memmove(d->band_start + 1, d->band_start, d->bands * sizeof *d->band_start);
    d->band_start[0] = 0;
    return CW_OK;
}

/* --- samples ------------------------------------------------------------------------------ */

/* A facet's functions of x, y and 1: its edges and its closeness, and their differences from the middle of
 * a pixel to its samples. */
typedef struct sampler {
    cwi_screen_facet facet;
    double closeness[3];
    double edge_to[3][SAMPLES], closeness_to[SAMPLES];
    double edge_reach[3]; /* the most that an edge function grows to a sample */
} sampler;

static void set_up_sampler(sampler *s)
{
    const cwi_screen_facet *f = &s->facet;
    for (int a = 0; a < 3; a++)
        s->closeness[a] = (f->edge[0][a] * f->weight[0] + f->edge[1][a] * f->weight[1] +
                           f->edge[2][a] * f->weight[2]) /
                          fabs(f->determinant);
    for (int c = 0; c < 3; c++)
        s->edge_reach[c] = SAMPLE_REACH * (fabs(f->edge[c][0]) + fabs(f->edge[c][1]));
    for (int n = 0; n < SAMPLES; n++) {
        const double *to = SAMPLE_AT[n];
        for (int c = 0; c < 3; c++)
            s->edge_to[c][n] = f->edge[c][0] * to[0] + f->edge[c][1] * to[1];
        s->closeness_to[n] = s->closeness[0] * to[0] + s->closeness[1] * to[1];
    }
}

static void draw_pixel(const drawing *d, const sampler *s, double x, double y,
                       uint32_t triangle, hit *pixel)
{
    double middle[3];
    cwi_facet_edges(&s->facet, x, y, middle);
    for (int c = 0; c < 3; c++)
        if (middle[c] + s->edge_reach[c] < 0)
            return;
    const double close = s->closeness[0] * x + (s->closeness[1] * y + s->closeness[2]);
    for (int n = 0; n < SAMPLES; n++) {
        const double e[3] = {middle[0] + s->edge_to[0][n], middle[1] + s->edge_to[1][n],
                             middle[2] + s->edge_to[2][n]};
        if (!cwi_facet_is_inside(&s->facet, e))
            continue;
        const double here = close + s->closeness_to[n];
        if (here * d->screen.near_mm <= 1 && (float)here >= pixel[n].closeness)
            pixel[n] = (hit){(float)here, triangle};
    }
}

static void draw_triangle(const drawing *d, uint32_t t, int first, int last, hit *hits)
{
    cwi_screen_point p[3];
    sampler s;
    corners_of(d, t, p);
    if (!cwi_facet_set_up(&d->screen, p, &s.facet) || s.facet.is_back)
        return;
    set_up_sampler(&s);
    const cwi_sample_span columns = cwi_screen_columns(&d->screen, p, SAMPLE_REACH),
                          rows = d->spans[t];
    const int from = rows.first > first ? rows.first : first,
              to = rows.last < last ? rows.last : last;
    for (int y = from; y <= to; y++) {
        hit *row = hits + (size_t)(y - first) * (size_t)d->screen.width * SAMPLES;
        for (int x = columns.first; x <= columns.last; x++)
            draw_pixel(d, &s, x + 0.5, y + 0.5, t, row + (size_t)x * SAMPLES);
    }
}

/* --- pixels ------------------------------------------------------------------------------- */

/* Adds a value at a corner to a function of x, y and 1. */
static void add_corner(const cwi_screen_facet *f, int corner, double value, double function[3])
{
    for (int k = 0; k < 3; k++)
        function[k] += f->edge[corner][k] * f->weight[corner] * value;
}

static void set_up_facet(const drawing *d, uint32_t triangle, facet *f)
{
    const cwi_look_model *m = d->model;
    const uint32_t *v = m->triangles[triangle];
    cwi_screen_point p[3];
    corners_of(d, triangle, p);
    *f = (facet){.triangle = triangle, .part = cwi_look_part_of(m, triangle)};
    cwi_facet_set_up(&d->screen, p, &f->on_screen);
    cwi_facet_normal(m->positions[v[0]], m->positions[v[1]], m->positions[v[2]], f->own_normal);
    cwi_to_unit(f->own_normal);
    for (int c = 0; c < 3; c++) {
        add_corner(&f->on_screen, c, 1, f->closeness);
        for (int a = 0; a < 3 && !f->part->is_flat; a++)
            add_corner(&f->on_screen, c, (double)m->normals[v[c]][a], f->normal[a]);
        for (int a = 0; a < 2 && m->uv; a++)
            add_corner(&f->on_screen, c, (double)m->uv[v[c]][a], f->uv[a]);
    }
}

static void weights_at(const facet *f, double x, double y, double weights[3])
{
    double e[3];
    cwi_facet_edges(&f->on_screen, x, y, e);
    cwi_facet_weights(&f->on_screen, e, weights);
}

static void normal_at(const facet *f, double x, double y, double n[3])
{
    const double side = value_at(f->closeness, x, y) < 0 ? -1 : 1; /* beyond the horizon */
    for (int a = 0; a < 3; a++)
        n[a] = side * value_at(f->normal[a], x, y);
    if (!cwi_to_unit(n))
        memcpy(n, f->own_normal, 3 * sizeof *n);
}

static void uv_at(const facet *f, double x, double y, double uv[2])
{
    const double closeness = value_at(f->closeness, x, y);
    for (int a = 0; a < 2; a++)
        uv[a] = value_at(f->uv[a], x, y) / closeness;
}

/* Turns a normal by a texel of the normal map, in the frame that viewers have here: each direction
 * interpolated and of length 1, as cw_bake_normals() has it. */
static void turn_normal(const drawing *d, const facet *f, const double weights[3],
                        const double texel[3], double n[3])
{
    const uint32_t *v = d->model->triangles[f->triangle];
    double along[3] = {0}, across[3] = {0};
    for (int c = 0; c < 3; c++) {
        const float *from = d->model->normals[v[c]], *t = d->model->tangents[v[c]];
        const double normal[3] = {(double)from[0], (double)from[1], (double)from[2]},
                     tangent[3] = {(double)t[0], (double)t[1], (double)t[2]};
        double side[3];
        cwi_cross(normal, tangent, side);
        for (int a = 0; a < 3; a++) {
            along[a] += weights[c] * tangent[a];
            across[a] += weights[c] * (double)t[3] * side[a];
        }
    }
    cwi_normalise(along);
    cwi_normalise(across);
    double turned[3];
    for (int a = 0; a < 3; a++)
        turned[a] = (2 * texel[0] - 1) * along[a] + (2 * texel[1] - 1) * across[a] +
                    (2 * texel[2] - 1) * n[a];
    if (cwi_normalise(turned))
        memcpy(n, turned, sizeof turned);
}

/* Returns the largest change of the normal's components, in the camera's axes, from pixel to pixel. */
static double find_bend(const drawing *d, const double here[3], const double right[3],
                        const double above[3])
{
    const double *axis[3] = {d->screen.right, d->screen.up, d->screen.forward};
    double x[3], y[3], bend = 0;
    cwi_sub(right, here, x);
    cwi_sub(above, here, y);
    for (int a = 0; a < 3; a++)
        bend = fmax(bend, fmax(fabs(cwi_dot(x, axis[a])), fabs(cwi_dot(y, axis[a]))));
    return bend;
}

/* The lower left one of 2 x 2 pixels, from which GPUs find how values change. */
typedef struct quad {
    double x, y; /* its middle */
} quad;

static quad quad_of(const drawing *d, int x, int y)
{
    const int bottom = (d->screen.height - 1 - y) & ~1;
    return (quad){(x & ~1) + 0.5, d->screen.height - 1 - bottom + 0.5};
}

static bool has_maps(const cwi_look_part *part)
{
    return part->normal_map.count > 0 || part->color_map.count > 0 ||
           part->occlusion_map.count > 0;
}

/* Turns the normal, colours the point and darkens the light by the maps. */
static void apply_maps(const drawing *d, const facet *f, double x, double y, quad q,
                       cwi_look_point *p)
{
    cwi_look_place place;
    double start[2], weights[3], texel[3];
    weights_at(f, x, y, weights);
    uv_at(f, x, y, place.uv);
    uv_at(f, q.x, q.y, start);
    uv_at(f, q.x + 1, q.y, place.dx);
    uv_at(f, q.x, q.y - 1, place.dy);
    for (int a = 0; a < 2; a++) {
        place.dx[a] -= start[a];
        place.dy[a] -= start[a];
    }
    if (f->part->normal_map.count > 0) {
        cwi_look_texture_sample(&f->part->normal_map, &place, texel);
        turn_normal(d, f, weights, texel, p->normal);
    }
    if (f->part->color_map.count > 0) {
        cwi_look_texture_sample(&f->part->color_map, &place, texel);
        for (int a = 0; a < 3; a++)
            p->color[a] *= texel[a];
    }
    if (f->part->occlusion_map.count > 0) {
        cwi_look_texture_sample(&f->part->occlusion_map, &place, texel);
        p->open = texel[0];
    }
}

static void find_color(const drawing *d, const facet *f, double x, double y, double color[3])
{
    const cwi_look_model *m = d->model;
    const uint32_t *v = m->triangles[f->triangle];
    double weights[3];
    if (m->colors)
        weights_at(f, x, y, weights);
    for (int a = 0; a < 3; a++) {
        color[a] = m->face_colors ? (double)m->face_colors[f->triangle][a] : 1;
        if (m->colors)
            color[a] *= weights[0] * (double)m->colors[v[0]][a] +
                        weights[1] * (double)m->colors[v[1]][a] +
                        weights[2] * (double)m->colors[v[2]][a];
    }
}

static void shade_pixel(const drawing *d, const facet *f, int column, int row, uint8_t rgb[3])
{
    const double x = column + 0.5, y = row + 0.5;
    const quad q = quad_of(d, column, row);
    cwi_look_point p = {.open = 1};
    find_color(d, f, x, y, p.color);
    if (f->part->is_flat) {
        memcpy(p.normal, f->own_normal, sizeof p.normal);
    } else {
        double around[3][3];
        normal_at(f, x, y, p.normal);
        normal_at(f, q.x, q.y, around[0]);
        normal_at(f, q.x + 1, q.y, around[1]);
        normal_at(f, q.x, q.y - 1, around[2]);
        p.bend = find_bend(d, around[0], around[1], around[2]);
    }
    if (!d->picture->without_maps && has_maps(f->part))
        apply_maps(d, f, x, y, q, &p);
    cwi_screen_to_eye(&d->screen, x, y, p.to_eye);
    cwi_look_shade(&d->light, &p, rgb);
}

/* Adds up the samples of a pixel; each of its triangles is shaded once. f: kept from call to call, as
 * neighbours mostly lie on one triangle */
static void put_pixel(const drawing *d, const hit *samples, int x, int y, facet *f,
                      uint8_t pixel[4])
{
    unsigned sum[3] = {0, 0, 0}, covered = 0;
    for (int n = 0; n < SAMPLES; n++) {
        const uint32_t triangle = samples[n].triangle;
        unsigned count = 0;
        bool is_done = triangle == NO_TRIANGLE;
        for (int k = 0; k < SAMPLES; k++) {
            is_done = is_done || (k < n && samples[k].triangle == triangle);
            count += samples[k].triangle == triangle;
        }
        if (is_done)
            continue;
        uint8_t rgb[3];
        if (f->triangle != triangle)
            set_up_facet(d, triangle, f);
        shade_pixel(d, f, x, y, rgb);
        for (int a = 0; a < 3; a++)
            sum[a] += count * rgb[a];
        covered += count;
    }
    for (int a = 0; a < 3; a++)
        pixel[a] = (uint8_t)((sum[a] + SAMPLES / 2) / SAMPLES);
    pixel[3] = (uint8_t)((255 * covered + SAMPLES / 2) / SAMPLES);
}

/* --- bands -------------------------------------------------------------------------------- */

static void draw_band(void *context, size_t band)
{
    const drawing *d = context;
    const int size = d->screen.width, first = (int)band * BAND_ROWS,
              rows = size - first < BAND_ROWS ? size - first : BAND_ROWS;
    const size_t row_hits = (size_t)size * SAMPLES;
    hit *hits = d->hits + (size_t)cwi_thread_number() * BAND_ROWS * row_hits;
    facet f = {.triangle = NO_TRIANGLE};
    for (size_t i = 0; i < (size_t)rows * row_hits; i++)
        hits[i] = (hit){0, NO_TRIANGLE};
    for (size_t n = d->band_start[band]; n < d->band_start[band + 1]; n++)
        draw_triangle(d, d->band_triangles[n], first, first + rows - 1, hits);
    for (int y = 0; y < rows; y++)
        for (int x = 0; x < size; x++)
            put_pixel(d, hits + (size_t)y * row_hits + (size_t)x * SAMPLES, x, first + y, &f,
                      d->rgba + 4 * ((size_t)(first + y) * (size_t)size + (size_t)x));
}

static cw_status allocate(drawing *d, int threads, cw_error *err)
{
    const size_t size = d->picture->size;
    d->bands = (size + BAND_ROWS - 1) / BAND_ROWS;
    d->points = cwi_alloc_array(d->model->vertex_count, sizeof *d->points);
    d->spans = cwi_alloc_array(d->model->triangle_count, sizeof *d->spans);
    d->band_start = cwi_alloc_array(d->bands + 1, sizeof *d->band_start);
    d->hits = cwi_alloc_array((size_t)threads * BAND_ROWS * size, SAMPLES * sizeof *d->hits);
    return d->points && d->spans && d->band_start && d->hits ? CW_OK : cwi_fail_memory(err);
}

static cw_status draw_bands(drawing *d, int threads, cw_error *err)
{
    const size_t vertices = d->model->vertex_count, triangles = d->model->triangle_count;
    cwi_parallel_for_all((vertices + CHUNK - 1) / CHUNK, WORK * CHUNK, threads, project_chunk,
                         d);
    cwi_parallel_for_all((triangles + CHUNK - 1) / CHUNK, WORK * CHUNK, threads, span_chunk, d);
    cw_status st = sort_by_bands(d, err);
    if (st == CW_OK)
        st = cwi_parallel_for(d->bands, (size_t)BAND_ROWS * d->picture->size * WORK, threads,
                              &d->picture->progress, "drawing", draw_band, d, err);
    return st;
}

cw_status cwi_look_draw(const cwi_look_model *model, const cwi_look_picture *picture,
                        uint8_t *rgba, cw_error *err)
{
    drawing d = {.model = model, .picture = picture, .rgba = rgba};
    const int threads = cwi_threads(picture->threads);
    cw_status st = cwi_screen_set_up(picture->camera, (int)picture->size, (int)picture->size,
                                     &d.screen, err);
    if (st == CW_OK)
        st = allocate(&d, threads, err);
    if (st == CW_OK) {
        cwi_look_light_make(&d.light);
        cwi_look_turn_light(&d.screen, &d.light);
        st = draw_bands(&d, threads, err);
    }
    cwi_free(d.points);
    cwi_free(d.spans);
    cwi_free(d.band_start);
    cwi_free(d.band_triangles);
    cwi_free(d.hits);
    return st;
}
