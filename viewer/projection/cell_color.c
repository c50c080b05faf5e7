/* Computes the light that a cell adds to a ray, by tables of the transfer function. */
#include "viewer/projection/cell_color.h"

#include "viewer/scene/lighting.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/vec3.h"

#include <math.h>

/* The maximum opacity in a pre-integrated table: an optical depth of 16. */
static const double MAX_OPACITY = 0.9999999;

/* The colour that a part of a ray adds: premultiplied, and its optical depth. */
typedef struct glow {
    cwi_lanes color;
    float depth;
} glow;

/* Turns opacities into optical depths, which are in proportion to lengths, and are interpolated
 * more exactly. Colours are times depth in place of opacity. */
static void turn_to_depths(float *segments, size_t count)
{
    for (size_t n = 0; n < count; n++) {
        float *s = segments + 4 * n;
        const double opacity = fmin((double)s[3], MAX_OPACITY), depth = -log1p(-opacity);
        const double scale = s[3] > 0 ? depth / (double)s[3] : 0;
        for (int c = 0; c < 3; c++)
            s[c] = (float)((double)s[c] * scale);
        s[3] = (float)depth;
    }
}

static cw_status make_segments(cwi_cell_tables *t, const cwi_frame *f, cw_error *err)
{
    t->segment_rows = cwi_table_segment_rows(&t->table, &f->transfer);
    const size_t count = t->segment_rows * t->segment_rows;
    t->segments = cwi_alloc_array(count, 4 * sizeof *t->segments);
    if (!t->segments)
        return cwi_fail_memory(err);
    cw_status st =
        cwi_table_preintegrate(&t->table, f->scene.sampling.step_vox, t->segment_rows,
                               f->scene.threads, &f->scene.progress, t->segments, err);
    if (st == CW_OK)
        turn_to_depths(t->segments, count);
    return st;
}

cw_status cwi_cell_tables_take(cwi_cell_tables *t, const cwi_frame *f, cw_error *err)
{
    const cw_scene *s = &f->scene;
    const double length = s->sampling.no_preintegration || s->projection.linear_opacity
                              ? 0
                              : s->sampling.step_vox;
    if (t->is_made && memcmp(&t->key, &f->transfer, sizeof t->key) == 0 &&
        t->opacity_units == f->opacity_units && (length == 0 || t->length == length))
        return CW_OK;
    cwi_cell_tables_free(t);
    memcpy(&t->key, &f->transfer, sizeof t->key);
    t->opacity_units = f->opacity_units;
    t->length = length;
    cw_status st = cwi_table_make(f, &t->table, err);
    if (st == CW_OK)
        st = cwi_visible_make(&t->table, &t->visible, err);
    if (st == CW_OK && length > 0)
        st = make_segments(t, f, err);
    t->is_made = st == CW_OK;
    if (st != CW_OK)
        cwi_cell_tables_free(t);
    return st;
}

void cwi_cell_tables_free(cwi_cell_tables *t)
{
    cwi_table_free(&t->table);
    cwi_visible_free(&t->visible);
    cwi_free(t->segments);
    *t = (cwi_cell_tables){0};
}

/* Adds a face that a clip plane cuts, in eye space. */
static void add_face(cwi_cell_model *m, const double plane[4])
{
    const size_t n = m->face_count++;
    m->face_start[n] = (float)-plane[3];
    for (int r = 0; r < 3; r++) {
        const double *row = m->frame->eye_from_index + (size_t)4 * (size_t)r;
        m->face_normal[n][r] = (float)(m->frame->scene.cut_away ? -plane[r] : plane[r]);
        for (int a = 0; a < 3; a++)
            m->face_slope[n][a] += (float)(plane[r] * row[a]);
        m->face_start[n] += (float)(plane[r] * row[3]);
    }
}

void cwi_cell_model_make(const cwi_frame *f, const cwi_cell_tables *tables, cwi_cell_model *m)
{
    const cw_scene *s = &f->scene;
    double matrix[3][3];
    *m = (cwi_cell_model){.frame = f, .tables = tables};
    m->needs_gradients = cwi_frame_needs_gradients(f);
    cwi_frame_gradient_matrix(f, matrix);
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++)
            m->to_eye[c][r] = (float)(matrix[r][c] * (tables->table.high - tables->table.low));
    for (size_t n = 0; n < s->clip_count; n++)
        if (f->faces >> n & 1)
            add_face(m, f->clips[n]);
    for (size_t n = 0; n < s->light_count; n++) {
        double direction[3];
        memcpy(direction, s->lights[n].direction, sizeof direction);
        cwi_to_unit(direction);
        for (int a = 0; a < 3; a++) {
            m->light_direction[n][a] = (float)direction[a];
            m->light_color[n][a] = s->lights[n].color[a];
        }
    }
}

void cwi_cell_halfway(const cwi_cell_model *m, const double direction[3],
                      cwi_lanes halfway[CW_MAX_LIGHTS])
{
    for (size_t n = 0; n < m->frame->scene.light_count; n++) {
        double h[3];
        for (int a = 0; a < 3; a++)
            h[a] = (double)m->light_direction[n][a] - direction[a];
        cwi_to_unit(h);
        halfway[n] = (cwi_lanes){(float)h[0], (float)h[1], (float)h[2], 0};
    }
}

static inline float dot_lanes(cwi_lanes a, cwi_lanes b)
{
    const cwi_lanes p = a * b;
    return p[0] + p[1] + p[2];
}

cwi_lanes cwi_cell_classify(const cwi_cell_tables *t, float x)
{
    const float at = (x > 0 ? x < 1 ? x : 1 : 0) * (CWI_TABLE_ROWS - 1);
    int32_t n = (int32_t)at;
    n = n > CWI_TABLE_ROWS - 2 ? CWI_TABLE_ROWS - 2 : n;
    const cwi_lanes low = cwi_lanes_load(t->table.rows + 4 * n),
                    high = cwi_lanes_load(t->table.rows + 4 * n + 4);
    return low + (at - (float)n) * (high - low);
}

/* Finds the row before a coordinate, and the fraction of the way to the next row. */
static inline size_t find_row(float x, size_t rows, float *fraction)
{
    const float at = (x > 0 ? x < 1 ? x : 1 : 0) * (float)(rows - 1);
    size_t n = (size_t)(int32_t)at;
    n = n > rows - 2 ? rows - 2 : n;
    *fraction = at - (float)n;
    return n;
}

static inline glow opaque_glow(cwi_lanes color, float depth)
{
    const float opacity = 1 - cwi_lanes_fade(cwi_lanes_spread(depth))[0];
    return (glow){opacity * color, depth};
}

/* Computes a segment within the table's range. */
static inline glow glow_of_segment(const cwi_cell_tables *t, float front, float back,
                                   float extent)
{
    float x, y;
    const size_t rows = t->segment_rows;
    const size_t i = find_row(front, rows, &x), j = find_row(back, rows, &y);
    const float *p = t->segments + 4 * (j * rows + i);
    const cwi_lanes a = cwi_lanes_load(p), b = cwi_lanes_load(p + 4),
                    c = cwi_lanes_load(p + 4 * rows), d = cwi_lanes_load(p + 4 * rows + 4);
    const cwi_lanes low = a + x * (b - a), high = c + x * (d - c);
    const cwi_lanes s = low + y * (high - low);
    if (!(s[3] > 0) || !(extent > 0))
        return (glow){{0}, 0};
    return opaque_glow(s / s[3], s[3] * extent / (float)t->length);
}

static inline glow put_over(glow front, glow back)
{
    const float through = 1 - front.color[3];
    return (glow){front.color + through * back.color, front.depth + back.depth};
}

/* Computes a segment that goes beyond the table's ends, where its last value continues: those
 * parts have one value each. */
static glow glow_beyond(const cwi_cell_tables *t, float front, float back, float extent)
{
    const float span = back - front;
    float inside[2] = {0, 0};
    if (fabsf(span) >= 1e-9f)
        for (int n = 0; n < 2; n++) {
            const float at = ((span > 0 ? (float)n : (float)(1 - n)) - front) / span;
            inside[n] = at > 0 ? at < 1 ? at : 1 : 0;
        }
    glow g = glow_of_segment(t, front, back, (inside[1] - inside[0]) * extent);
    if (inside[0] > 0)
        g = put_over(glow_of_segment(t, front, front, inside[0] * extent), g);
    if (inside[1] < 1)
        g = put_over(g, glow_of_segment(t, back, back, (1 - inside[1]) * extent));
    return g;
}

/* Computes the glow of a part of a ray over which the value is linear. */
static inline glow glow_between(const cwi_cell_model *m, float front, float back, float extent)
{
    const cwi_cell_tables *t = m->tables;
    if (m->frame->scene.sampling.no_preintegration) {
        cwi_lanes row = cwi_cell_classify(t, 0.5f * (front + back));
        const float depth = row[3] * extent;
        row[3] = 1;
        return opaque_glow(row, depth);
    }
    const float low = front < back ? front : back, high = front < back ? back : front;
    return low < 0 || high > 1 ? glow_beyond(t, front, back, extent)
                               : glow_of_segment(t, front, back, extent);
}

/* Returns x^power: whole powers, as most are, by squaring. */
static inline float raise_power(float x, float power)
{
    float result = 1;
    if (power != floorf(power) || power > 1024 || power < 0)
        return (float)pow((double)x, (double)power);
    for (unsigned n = (unsigned)power; n > 0; n /= 2, x *= x)
        if (n & 1)
            result *= x;
    return result;
}

/* Returns the light that a surface with a normal of unit length reflects of a premultiplied
 * colour. */
static inline cwi_lanes reflect_light(const cwi_cell_model *m, const cwi_cell_ray *r,
                                      cwi_lanes normal, bool is_glossy, cwi_lanes color)
{
    const cw_scene *s = &m->frame->scene;
    cwi_lanes light = {0};
    for (size_t n = 0; n < s->light_count; n++) {
        const float facing = -dot_lanes(normal, m->light_direction[n]);
        if (s->one_sided && !(facing > 0))
            continue;
        const float diffuse = s->material.diffuse * fabsf(facing);
        const float gloss = fabsf(dot_lanes(normal, r->halfway[n]));
        const float specular =
            is_glossy ? s->material.specular * color[3] *
                            raise_power(gloss < 1 ? gloss : 1, s->material.shininess)
                      : 0;
        light += m->light_color[n] * (diffuse * color + specular);
    }
    return light;
}

/* Lights a premultiplied colour at a distance along the ray, as cwi_lighting_shade(). */
static inline cwi_lanes shade_color(const cwi_cell_model *m, const cwi_cell_ray *r, float t,
                                    cwi_lanes gradient, cwi_lanes color)
{
    const cw_scene *s = &m->frame->scene;
    const cwi_lanes at = r->origin + t * r->slope;
    const float size = sqrtf(dot_lanes(gradient, gradient));
    const float strength = (float)cwi_frame_surface_strength(m->frame, (double)size);
    cwi_lanes light = s->material.ambient * color, face = {0};
    float nearest = INFINITY;
    for (size_t n = 0; n < m->face_count; n++) {
        const float distance = dot_lanes(m->face_slope[n], at) + m->face_start[n];
        face = distance < nearest ? m->face_normal[n] : face;
        nearest = distance < nearest ? distance : nearest;
    }
    const float mix = (float)cwi_lighting_face_fraction((double)nearest);
    if (mix < 1 && size > 0)
        light += (1 - mix) * strength * reflect_light(m, r, gradient / size, true, color);
    if (mix > 0)
        light += mix * reflect_light(m, r, face, false, color);
    light[3] = color[3];
    return light;
}

/* Interpolates the gradient at a place in a cell, in eye space. */
static inline cwi_lanes gradient_at(const cwi_cell_model *m, const cwi_projected_cell *c,
                                    cwi_lanes at)
{
    const cwi_lanes *g = c->gradient;
    const cwi_lanes e0 = g[0] + at[0] * (g[1] - g[0]), e1 = g[2] + at[0] * (g[3] - g[2]);
    const cwi_lanes e2 = g[4] + at[0] * (g[5] - g[4]), e3 = g[6] + at[0] * (g[7] - g[6]);
    const cwi_lanes low = e0 + at[1] * (e1 - e0), high = e2 + at[1] * (e3 - e2);
    const cwi_lanes index = low + at[2] * (high - low);
    return index[0] * m->to_eye[0] + index[1] * m->to_eye[1] + index[2] * m->to_eye[2];
}

/* Changes a glow by the gradient: more or less of it, and light on it. */
static inline glow apply_gradient(const cwi_cell_model *m, const cwi_cell_ray *r, float t,
                                  glow g, cwi_lanes gradient)
{
    const cwi_frame *f = m->frame;
    if (f->transfer.gradient_count > 0) {
        const double length = sqrt((double)dot_lanes(gradient, gradient));
        g = opaque_glow(g.color / g.color[3],
                        g.depth * (float)cwi_frame_gradient_factor(f, length));
    }
    if (f->scene.lit)
        g.color = shade_color(m, r, t, gradient, g.color);
    return g;
}

/* Replaces some of a premultiplied colour by the background's, by the depth. */
static inline cwi_lanes apply_depth(const cwi_cell_model *m, const cwi_cell_ray *r, float t,
                                    cwi_lanes color)
{
    const double depth = (double)(r->depth[0] + t * r->depth[1]);
    const float cue = (float)cwi_frame_cue(m->frame, depth);
    const cwi_lanes mixed = cue * color + (1 - cue) * color[3] * r->background;
    return (cwi_lanes){mixed[0], mixed[1], mixed[2], color[3]};
}

static inline void add_glow(const cwi_cell_model *m, const cwi_projected_cell *c, float middle,
                            glow g, cwi_cell_ray *r)
{
    if (!(g.color[3] > 0))
        return;
    if (m->needs_gradients && g.color[3] > 1e-6f)
        g = apply_gradient(m, r, middle, g, gradient_at(m, c, cwi_cell_place(c, r, middle)));
    if (m->frame->scene.depth_cue > 0)
        g.color = apply_depth(m, r, middle, g.color);
    r->color += r->light * g.color;
    r->light *= 1 - g.color[3];
}

/* Adds a part of the way through a cell, between two fractions of it. */
static inline void add_part(const cwi_cell_model *m, const cwi_projected_cell *c,
                            const float t[2], const float values[2], const float part[2],
                            const cwi_lanes *linear, cwi_cell_ray *r)
{
    const float length = t[1] - t[0], rise = values[1] - values[0];
    const float middle = t[0] + 0.5f * (part[0] + part[1]) * length;
    glow g = {{0}, 0};
    if (linear) {
        g.color = (part[1] - part[0]) * *linear;
        g.depth = (float)-log1p(-fmin((double)g.color[3], MAX_OPACITY));
    } else
        g = glow_between(m, values[0] + part[0] * rise, values[0] + part[1] * rise,
                         (part[1] - part[0]) * length);
    add_glow(m, c, middle, g, r);
}

void cwi_cell_pass(const cwi_cell_model *m, const cwi_projected_cell *c, const float t[2],
                   const cwi_lanes *linear, cwi_cell_ray *r)
{
    float values[2] = {0};
    if (t[1] <= r->parts[0][0] || t[0] >= r->parts[r->part_count - 1][1])
        return;
    for (int n = 0; n < 2 && !linear; n++)
        values[n] = cwi_cell_value(c, cwi_cell_place(c, r, t[n]));
    for (int n = 0; n < r->part_count; n++) {
        const float from = r->parts[n][0] > t[0] ? r->parts[n][0] : t[0];
        const float to = r->parts[n][1] < t[1] ? r->parts[n][1] : t[1];
        const float part[2] = {(from - t[0]) / (t[1] - t[0]), (to - t[0]) / (t[1] - t[0])};
        if (to > from)
            add_part(m, c, t, values, part, linear, r);
    }
}
