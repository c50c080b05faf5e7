/* Joins surfaces into one list of vertices and triangles, with all that shading needs. */
#include "viewer/appearance/look_model.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/vec3.h"
#include "core/mesh/mesh.h"
#include "core/texture/split_seams.h"
#include "core/texture/tangents.h"
#include "viewer/scene/srgb.h"

#include <math.h>
#include <string.h>

/* --- checks ------------------------------------------------------------------------------- */

static bool has_maps(const cw_surface_look *s)
{
    return s->normal_map || s->color_map || s->occlusion_map;
}

static cw_status check_surface(const cw_surface_look *s, size_t n, cw_error *err)
{
    if (!s->mesh)
        return cwi_fail(err, CW_ERR_ARGUMENT, "surface %zu has no mesh", n);
    cw_status st = cw_mesh_check(s->mesh, err);
    if (st != CW_OK)
        return st;
    if (has_maps(s) && !cwi_texture_of(s->mesh))
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "surface %zu has maps; its mesh has no texture coordinates", n);
    if (s->normal_map && !s->mesh->normals)
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "surface %zu has a normal map; its mesh has no normals", n);
    return CW_OK;
}

static const cw_attribute *face_colors_of(const cw_mesh *mesh)
{
    const cw_attribute *a = cw_mesh_attribute_find(mesh, CW_FACE_COLORS);
    const bool is_known =
        a && a->on == CW_ON_TRIANGLES && a->type == CW_U8 && a->components == 4;
    return is_known ? a : NULL;
}

/* --- one surface -------------------------------------------------------------------------- */

/* Returns true if coordinates lie outside of the picture, which then repeats. */
static bool finds_repeats(const cw_mesh *mesh)
{
    const float *uv = cwi_texture_of(mesh)->data;
    for (size_t n = 0; n < 2 * mesh->vertex_count; n++)
        if (!(uv[n] >= -1e-4f && uv[n] <= 1.0001f))
            return true;
    return false;
}

/* Copies the vertices, from `first` on. */
static void put_vertices(const cw_mesh *mesh, size_t first, cwi_look_model *m)
{
    double shift[3];
    cwi_sub(mesh->origin, m->origin, shift);
    for (size_t v = 0; v < mesh->vertex_count; v++)
        for (size_t k = 0; k < 3; k++) {
            m->positions[first + v][k] = (float)(shift[k] + (double)mesh->positions[3 * v + k]);
            if (mesh->normals)
                m->normals[first + v][k] = mesh->normals[3 * v + k];
            if (m->colors)
                m->colors[first + v][k] =
                    mesh->colors ? (float)cwi_srgb_to_linear(mesh->colors[4 * v + k] / 255.0)
                                 : 1;
        }
}

/* Copies the triangles, from `first` on, whose vertices begin at `vertex`. */
static void put_triangles(const cw_mesh *mesh, size_t vertex, size_t first, cwi_look_model *m)
{
    const cw_attribute *colors = face_colors_of(mesh);
    for (size_t t = 0; t < mesh->triangle_count; t++)
        for (size_t k = 0; k < 3; k++) {
            m->triangles[first + t][k] = (uint32_t)(vertex + mesh->triangles[3 * t + k]);
            if (m->face_colors)
                m->face_colors[first + t][k] =
                    colors ? (float)cwi_srgb_to_linear(
                                 ((const uint8_t *)colors->data)[4 * t + k] / 255.0)
                           : 1;
        }
}

static cw_status put_maps(const cw_surface_look *s, const cw_mesh *mesh, size_t first,
                          cwi_look_model *m, cwi_look_part *part, cw_error *err)
{
    const bool repeats = finds_repeats(mesh);
    cw_status st = CW_OK;
    memcpy(m->uv[first], cwi_texture_of(mesh)->data, mesh->vertex_count * sizeof *m->uv);
    if (s->color_map)
        st = cwi_look_texture_make(s->color_map, true, repeats, &part->color_map, err);
    if (st == CW_OK && s->normal_map)
        st = cwi_look_texture_make(s->normal_map, false, repeats, &part->normal_map, err);
    if (st == CW_OK && s->occlusion_map)
        st = cwi_look_texture_make(s->occlusion_map, false, repeats, &part->occlusion_map, err);
    if (st == CW_OK && s->normal_map)
        st = cwi_tangents(mesh, m->tangents + first, err);
    return st;
}

/* --- all ---------------------------------------------------------------------------------- */

/* Splits the vertices of surfaces at seams and creases. split: count of them, empty for others */
static cw_status split_surfaces(const cw_surface_look *surface, size_t count, cw_mesh *split,
                                cw_error *err)
{
    cw_status st = CW_OK;
    for (size_t n = 0; n < count && st == CW_OK; n++) {
        st = check_surface(&surface[n], n, err);
        if (st == CW_OK && cwi_has_seams(surface[n].mesh))
            st = cwi_split_seams(surface[n].mesh, &split[n], err);
    }
    return st;
}

static const cw_mesh *mesh_of(const cw_surface_look *surface, const cw_mesh *split)
{
    return split->vertex_count ? split : surface->mesh;
}

/* Allocates the arrays that some surface has something for. */
static cw_status allocate(const cw_surface_look *surface, size_t count, const cw_mesh *split,
                          cwi_look_model *m, cw_error *err)
{
    bool normals = false, colors = false, face_colors = false, tangents = false;
    for (size_t n = 0; n < count; n++) {
        const cw_mesh *mesh = mesh_of(&surface[n], &split[n]);
        m->vertex_count += mesh->vertex_count;
        m->triangle_count += mesh->triangle_count;
        normals = normals || mesh->normals;
        colors = colors || mesh->colors;
        face_colors = face_colors || face_colors_of(mesh);
        tangents = tangents || surface[n].normal_map;
        m->has_maps = m->has_maps || has_maps(&surface[n]);
    }
    if (m->vertex_count > UINT32_MAX)
        return cwi_fail(err, CW_ERR_LIMIT, "%zu vertices; at most %u are drawn",
                        m->vertex_count, UINT32_MAX);
    const size_t v = m->vertex_count, t = m->triangle_count;
    m->positions = cwi_alloc_array(v, sizeof *m->positions);
    m->triangles = cwi_alloc_array(t, sizeof *m->triangles);
    m->parts = cwi_alloc_zeroed(count, sizeof *m->parts);
    m->normals = normals ? cwi_alloc_zeroed(v, sizeof *m->normals) : NULL;
    m->colors = colors ? cwi_alloc_array(v, sizeof *m->colors) : NULL;
    m->face_colors = face_colors ? cwi_alloc_array(t, sizeof *m->face_colors) : NULL;
    m->uv = m->has_maps ? cwi_alloc_zeroed(v, sizeof *m->uv) : NULL;
    m->tangents = tangents ? cwi_alloc_zeroed(v, sizeof *m->tangents) : NULL;
    const bool has_all = m->positions && m->triangles && m->parts && (m->normals || !normals) &&
                         (m->colors || !colors) && (m->face_colors || !face_colors) &&
                         (m->uv || !m->has_maps) && (m->tangents || !tangents);
    return has_all ? CW_OK : cwi_fail_memory(err);
}

static cw_status join_surfaces(const cw_surface_look *surface, size_t count,
                               const cw_mesh *split, cwi_look_model *m, cw_error *err)
{
    size_t vertex = 0, triangle = 0;
    cw_status st = allocate(surface, count, split, m, err);
    if (count)
        memcpy(m->origin, surface[0].mesh->origin, sizeof m->origin);
    for (size_t n = 0; n < count && st == CW_OK; n++) {
        const cw_mesh *mesh = mesh_of(&surface[n], &split[n]);
        cwi_look_part *part = &m->parts[m->part_count++];
        part->first_triangle = triangle;
        part->is_flat = !mesh->normals;
        put_vertices(mesh, vertex, m);
        put_triangles(mesh, vertex, triangle, m);
        if (has_maps(&surface[n]) && mesh->vertex_count)
            st = put_maps(&surface[n], mesh, vertex, m, part, err);
        vertex += mesh->vertex_count;
        triangle += mesh->triangle_count;
    }
    return st;
}

cw_status cwi_look_model_make(const cw_surface_look *surface, size_t count, cwi_look_model *m,
                              cw_error *err)
{
    *m = (cwi_look_model){0};
    cw_mesh *split = cwi_alloc_zeroed(count, sizeof *split);
    cw_status st = split ? split_surfaces(surface, count, split, err) : cwi_fail_memory(err);
    if (st == CW_OK)
        st = join_surfaces(surface, count, split, m, err);
    for (size_t n = 0; split && n < count; n++)
        cw_mesh_free(&split[n]);
    cwi_free(split);
    return st;
}

void cwi_look_model_free(cwi_look_model *m)
{
    for (size_t n = 0; n < m->part_count; n++) {
        cwi_look_texture_free(&m->parts[n].normal_map);
        cwi_look_texture_free(&m->parts[n].color_map);
        cwi_look_texture_free(&m->parts[n].occlusion_map);
    }
    cwi_free(m->positions);
    cwi_free(m->normals);
    cwi_free(m->colors);
    cwi_free(m->face_colors);
    cwi_free(m->uv);
    cwi_free(m->tangents);
    cwi_free(m->triangles);
    cwi_free(m->parts);
    *m = (cwi_look_model){0};
}

bool cwi_look_model_extent(const cwi_look_model *m, double center[3], double *radius_mm)
{
    float low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    double middle[3], far_sq = 0;
    const uint32_t *corner = m->triangle_count ? m->triangles[0] : NULL;
    for (size_t n = 0; n < 3 * m->triangle_count; n++)
        for (size_t k = 0; k < 3; k++) {
            low[k] = fminf(low[k], m->positions[corner[n]][k]);
            high[k] = fmaxf(high[k], m->positions[corner[n]][k]);
        }
    if (!corner)
        return false;
    for (int k = 0; k < 3; k++) {
        middle[k] = ((double)low[k] + (double)high[k]) / 2;
        center[k] = m->origin[k] + middle[k];
    }
    for (size_t n = 0; n < 3 * m->triangle_count; n++) {
        double from[3];
        for (int k = 0; k < 3; k++)
            from[k] = (double)m->positions[corner[n]][k] - middle[k];
        far_sq = fmax(far_sq, cwi_dot(from, from));
    }
    *radius_mm = sqrt(far_sq);
    return far_sq > 0 && isfinite(far_sq);
}

const cwi_look_part *cwi_look_part_of(const cwi_look_model *m, size_t triangle)
{
    size_t first = 0, count = m->part_count;
    while (count > 1) { /* the last part that begins at or before the triangle */
        const size_t half = count / 2;
        if (m->parts[first + half].first_triangle <= triangle) {
            first += half;
            count -= half;
        } else {
            count = half;
        }
    }
    return &m->parts[first];
}
