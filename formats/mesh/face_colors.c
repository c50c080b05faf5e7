/* Keeps the colours of triangles that a file states, by triangle or by vertex. */
#include "formats/mesh/face_colors.h"

#include "core/base/memory.h"
#include "core/base/status.h"

#include <string.h>

static const uint8_t white[4] = {255, 255, 255, 255};

cw_status cwi_color_faces(cwi_face_colors *f, size_t end, const uint8_t color[4], cw_error *err)
{
    if (end <= f->count)
        return CW_OK;
    if (!color && !f->colors) {
        f->count = end;
        return CW_OK;
    }
    const bool is_first = !f->colors;
    cw_status st = cwi_mesh_grow(f->in, &f->colors, &f->capacity, end, 4, err);
    if (st != CW_OK)
        return st;
    if (is_first)
        memset(f->colors, 255, 4 * f->count);
    for (; f->count < end; f->count++)
        memcpy(f->colors + 4 * f->count, color ? color : white, 4);
    return CW_OK;
}

/* Copies the colours to the vertices, unless one gets two: then the mesh stays without. */
static cw_status color_vertices(const cwi_face_colors *f, cw_mesh *mesh, cw_error *err)
{
    bool *seen = cwi_alloc_zeroed(mesh->vertex_count, sizeof *seen), alike = true;
    uint8_t *colors = cwi_alloc_array(mesh->vertex_count, 4);
    const bool has_memory = seen && colors;
    if (has_memory)
        memset(colors, 255, 4 * mesh->vertex_count);
    for (size_t i = 0; i < 3 * mesh->triangle_count && has_memory && alike; i++) {
        const size_t v = mesh->triangles[i];
        const uint8_t *color = f->colors + 4 * (i / 3);
        alike = !seen[v] || memcmp(colors + 4 * v, color, 4) == 0;
        memcpy(colors + 4 * v, color, 4);
        seen[v] = true;
    }
    cwi_free(seen);
    if (has_memory && alike)
        mesh->colors = colors;
    else
        cwi_free(colors);
    return has_memory ? CW_OK : cwi_fail_memory(err);
}

cw_status cwi_color_mesh(cwi_face_colors *f, bool spread, cw_mesh *mesh, cw_error *err)
{
    static const cw_attribute like = {.name = CW_FACE_COLORS,
                                      .on = CW_ON_TRIANGLES,
                                      .type = CW_U8,
                                      .components = 4,
                                      .interpolation = CW_INTERPOLATE_COLOR};
    cw_attribute *row;
    if (!f->colors || !mesh->triangle_count)
        return CW_OK;
    cw_status st = cwi_color_faces(f, mesh->triangle_count, white, err);
    const bool tries = st == CW_OK && spread && !mesh->colors;
    if (tries)
        st = color_vertices(f, mesh, err);
    if (st != CW_OK || (tries && mesh->colors))
        return st;
    st = cw_mesh_attribute_add(mesh, &like, &row, err);
    if (st == CW_OK)
        memcpy(row->data, f->colors, 4 * mesh->triangle_count);
    return st;
}

void cwi_face_colors_free(cwi_face_colors *f)
{
    cwi_free(f->colors);
    *f = (cwi_face_colors){0};
}
