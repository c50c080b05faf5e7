/* Draws the mode mesh on the CPU: turns the tint into colours of vertices, and calls
 * cw_render_mesh(). */
#include "viewer/cpu/cpu_mesh.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "viewer/scene/mesh_tint.h"
#include <cubewright/render.h>

#include <math.h>
#include <string.h>

static bool is_clear(const cw_scene *s)
{
    if (s->mesh_look.tint != CW_TINT_COLORS || !s->mesh->colors)
        return s->mesh_look.color[3] < 1;
    for (size_t v = 0; v < s->mesh->vertex_count; v++)
        if (s->mesh->colors[4 * v + 3] < 255)
            return true;
    return false;
}

const char *cwi_cpu_mesh_refusal(const cwi_frame *f)
{
    const cw_scene *s = &f->scene;
    return is_clear(s)              ? "translucent"
           : s->clip_count > 0      ? "cut open"
           : s->mesh_look.wireframe ? "with edges"
           : s->depth_cue > 0       ? "with a depth cue"
           : s->one_sided           ? "lit on one side"
           : !f->studio_light       ? "with lights or a material of their own"
                                    : NULL;
}

/* Refuses settings that the CPU does not draw, so that none is ignored silently. */
static cw_status check_frame(const cwi_frame *f, cw_error *err)
{
    const char *more = cwi_cpu_mesh_refusal(f);
    return more ? cwi_fail(err, CW_ERR_UNSUPPORTED, "the CPU draws no meshes %s: use OpenGL",
                           more)
                : CW_OK;
}

static void put_color(double value, const double range[2], uint8_t color[4])
{
    double srgb[3] = {0.507, 0.507, 0.507}; /* no value, as in mesh.glsl */
    if (!isnan(value))
        cwi_ramp_color((value - range[0]) / (range[1] - range[0]), srgb);
    for (int c = 0; c < 3; c++)
        color[c] = (uint8_t)lround(255 * srgb[c]);
    color[3] = 255;
}

/* Colours each vertex by its scalar. */
static void tint_vertices(const double range[2], cw_mesh *m)
{
    for (size_t v = 0; v < m->vertex_count; v++)
        put_color((double)m->scalars[v], range, m->colors + 4 * v);
}

/* Colours each triangle, with corners of its own, by its shape. */
static void tint_triangles(const cw_mesh *mesh, const double range[2], cw_mesh *m)
{
    for (size_t n = 0; n < m->vertex_count; n++) {
        const size_t v = mesh->triangles[n];
        put_color(cwi_triangle_shape(mesh, n / 3), range, m->colors + 4 * n);
        memcpy(m->positions + 3 * n, mesh->positions + 3 * v, 3 * sizeof *m->positions);
        if (mesh->normals)
            memcpy(m->normals + 3 * n, mesh->normals + 3 * v, 3 * sizeof *m->normals);
        m->triangles[n] = (uint32_t)n;
    }
}

/* Makes a view of the mesh with its own arrays for the tint's colours; drop_tinted() frees
 * those. */
static cw_status make_tinted(const cw_scene *s, const double range[2], cw_mesh *m,
                             cw_error *err)
{
    const cw_mesh *mesh = s->mesh;
    const bool apart = s->mesh_look.tint == CW_TINT_QUALITY;
    *m = *mesh;
    if (s->mesh_look.tint == CW_TINT_COLORS)
        return CW_OK;
    if (apart) {
        m->vertex_count = 3 * mesh->triangle_count;
        m->positions = cwi_alloc_array(m->vertex_count, 3 * sizeof *m->positions);
        m->triangles = cwi_alloc_array(m->vertex_count, sizeof *m->triangles);
        m->normals =
            mesh->normals ? cwi_alloc_array(m->vertex_count, 3 * sizeof *m->normals) : NULL;
    }
    m->colors = cwi_alloc_array(m->vertex_count, 4);
    if (!m->colors || !m->positions || !m->triangles || (mesh->normals && !m->normals))
        return cwi_fail_memory(err);
    if (apart)
        tint_triangles(mesh, range, m);
    else
        tint_vertices(range, m);
    return CW_OK;
}

static void drop_tinted(const cw_scene *s, cw_mesh *m)
{
    if (s->mesh_look.tint == CW_TINT_QUALITY) {
        cwi_free(m->positions);
        cwi_free(m->normals);
        cwi_free(m->triangles);
    }
    if (s->mesh_look.tint != CW_TINT_COLORS)
        cwi_free(m->colors);
}

static cw_status draw_tinted(const cwi_frame *f, const cw_mesh *mesh, double *depth_mm,
                             cw_picture *picture, cw_error *err)
{
    cw_image image;
    cw_render_mesh_desc d = {.camera = f->scene.camera,
                             .width = f->scene.width,
                             .height = f->scene.height,
                             .samples = 1,
                             .background = {{255, 255, 255, 0}, {255, 255, 255, 0}},
                             .depth_mm = depth_mm,
                             .same_inside = f->scene.mesh_look.same_inside,
                             .threads = f->scene.threads,
                             .progress = f->scene.progress};
    for (int c = 0; c < 4; c++)
        d.color[c] = (uint8_t)lroundf(255 * f->scene.mesh_look.color[c]);
    cw_status st = cw_render_mesh(mesh, &d, &image, err);
    for (size_t p = 0; st == CW_OK && p < image.width * image.height; p++)
        for (int c = 0; c < 4 && image.pixels[4 * p + 3] > 0; c++)
            picture->pixels[4 * p + (size_t)c] = (float)image.pixels[4 * p + (size_t)c] / 255;
    cw_image_free(&image);
    return st;
}

cw_status cwi_cpu_draw_mesh(const cwi_frame *frame, double *depth_mm, cw_picture *picture,
                            cw_error *err)
{
    const cw_scene *s = &frame->scene;
    double range[2];
    cw_mesh tinted;
    cw_status st = cwi_tint_range(s, range, err);
    if (st == CW_OK)
        st = check_frame(frame, err);
    if (st != CW_OK)
        return st;
    st = make_tinted(s, range, &tinted, err);
    if (st == CW_OK)
        st = draw_tinted(frame, &tinted, depth_mm, picture, err);
    drop_tinted(s, &tinted);
    return st;
}
