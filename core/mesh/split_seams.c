/* Gives each vertex one texture coordinate. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/mesh/corner_table.h"
#include "core/mesh/mesh.h"
#include "core/mesh/mesh_attributes.h"

#include <cubewright/atlas.h>

#include <stdlib.h>
#include <string.h>

/* A corner at a vertex, by the bits of its texture coordinate. */
typedef struct placed_corner {
    uint64_t uv;
    uint32_t corner;
} placed_corner;

typedef struct seam_split {
    const cw_mesh *mesh;
    const float (*uv)[2]; /* corners */
    uint32_t *vertex;     /* corners: their new vertices, set */
    uint32_t *source;     /* new vertices: the old one; set */
    uint32_t *corner;     /* new vertices: one of their corners; CWI_NO_CORNER: none; set */
    size_t vertices;
} seam_split;

static uint64_t bits_of(const float uv[2])
{
    uint32_t bits[2];
    const float positive[2] = {uv[0] + 0.0F, uv[1] + 0.0F}; /* -0 and 0 are one place */
    memcpy(bits, positive, sizeof bits);
    return (uint64_t)bits[0] << 32 | bits[1];
}

static int compare_corners(const void *a, const void *b)
{
    const placed_corner *m = a, *n = b;
    if (m->uv != n->uv)
        return m->uv < n->uv ? -1 : 1;
    return m->corner < n->corner ? -1 : m->corner > n->corner;
}

/* Numbers the places of a vertex; the one that comes first keeps its number. */
static void number_places(seam_split *s, uint32_t v, placed_corner *corners, size_t count)
{
    bool differ = false;
    for (size_t n = 1; n < count && !differ; n++)
        differ = corners[n].uv != corners[0].uv;
    if (differ)
        qsort(corners, count, sizeof *corners, compare_corners);
    uint32_t at = v;
    s->corner[v] = count ? corners[0].corner : CWI_NO_CORNER;
    for (size_t n = 0; n < count; n++) {
        if (n > 0 && corners[n].uv != corners[n - 1].uv) {
            at = (uint32_t)s->vertices++;
            s->source[at] = v;
            s->corner[at] = corners[n].corner;
        }
        s->vertex[corners[n].corner] = at;
    }
}

/* Sets the new vertices of all corners. Returns false when memory is out. */
static bool find_vertices(seam_split *s)
{
    const cw_mesh *m = s->mesh;
    const size_t corners = 3 * m->triangle_count;
    uint32_t *first = cwi_alloc_array(m->vertex_count + 2, sizeof *first);
    uint32_t *around = cwi_alloc_array(corners, sizeof *around);
    placed_corner *placed = cwi_alloc_array(corners, sizeof *placed);
    const bool ok = first && around && placed;
    if (ok)
        cwi_fans_sort(m->triangles, m->triangle_count, m->vertex_count, first, around);
    for (uint32_t v = 0; v < m->vertex_count; v++)
        s->source[v] = v;
    s->vertices = m->vertex_count;
    for (uint32_t v = 0; ok && v < m->vertex_count; v++) {
        size_t count = 0;
        for (uint32_t n = first[v]; n < first[v + 1]; n++)
            for (uint32_t c = 3 * around[n]; c < 3 * around[n] + 3; c++)
                if (m->triangles[c] == v && (count == 0 || placed[count - 1].corner < c))
                    placed[count++] = (placed_corner){bits_of(s->uv[c]), c};
        number_places(s, v, placed, count);
    }
    cwi_free(first);
    cwi_free(around);
    cwi_free(placed);
    return ok;
}

/* Makes the mesh of the new vertices, without texture coordinates. like: a mesh without them */
static cw_status make_split(const seam_split *s, const cw_mesh *like, cw_mesh *out,
                            cw_error *err)
{
    const cw_mesh *m = s->mesh;
    cw_status st = cwi_mesh_alloc(out, s->vertices, m->triangle_count, false, err);
    if (st == CW_OK)
        st = cwi_attributes_alloc(like, out, err);
    if (st != CW_OK)
        return st;
    memcpy(out->origin, m->origin, sizeof out->origin);
    memcpy(out->affine, m->affine, sizeof out->affine);
    memcpy(out->triangles, s->vertex, 3 * m->triangle_count * sizeof *out->triangles);
    for (size_t v = 0; v < s->vertices; v++) {
        memcpy(out->positions + 3 * v, m->positions + 3 * (size_t)s->source[v],
               3 * sizeof *out->positions);
        cwi_attributes_put(like, s->source[v], out, v);
    }
    for (size_t t = 0; t < m->triangle_count; t++)
        cwi_attributes_put_triangle(like, t, m->triangles + 3 * t, out, t);
    return CW_OK;
}

static cw_status add_coordinates(const seam_split *s, cw_mesh *out, cw_error *err)
{
    const cw_attribute like = {.name = CW_TEXTURE_COORDINATES,
                               .on = CW_ON_VERTICES,
                               .type = CW_F32,
                               .components = 2,
                               .interpolation = CW_INTERPOLATE_LINEAR};
    cw_attribute *added;
    cw_status st = cw_mesh_attribute_add(out, &like, &added, err);
    for (size_t v = 0; st == CW_OK && v < s->vertices; v++)
        if (s->corner[v] != CWI_NO_CORNER)
            memcpy((float *)added->data + 2 * v, s->uv[s->corner[v]], sizeof *s->uv);
    return st;
}

static cw_status split(seam_split *s, const cw_mesh *like, cw_mesh *out, cw_error *err)
{
    const size_t corners = 3 * s->mesh->triangle_count, most = s->mesh->vertex_count + corners;
    s->vertex = cwi_alloc_array(corners, sizeof *s->vertex);
    s->source = cwi_alloc_array(most, sizeof *s->source);
    s->corner = cwi_alloc_array(most, sizeof *s->corner);
    cw_status st =
        s->vertex && s->source && s->corner && find_vertices(s) ? CW_OK : cwi_fail_memory(err);
    if (st == CW_OK)
        st = make_split(s, like, out, err);
    if (st == CW_OK)
        st = add_coordinates(s, out, err);
    cwi_free(s->vertex);
    cwi_free(s->source);
    cwi_free(s->corner);
    return st;
}

cw_status cw_mesh_split_seams(cw_mesh *mesh, cw_error *err)
{
    CWI_REQUIRE(err, mesh);
    cw_status st = cwi_mesh_check_size(mesh, "split along its seams", err);
    const cw_attribute *uv = cw_mesh_attribute_find(mesh, CW_TEXTURE_COORDINATES);
    if (st != CW_OK || !uv || uv->on != CW_ON_CORNERS || uv->type != CW_F32 ||
        uv->components != 2)
        return st;
    cw_mesh like = *mesh, out = {0}; /* like: the same arrays, but for texture coordinates */
    like.attributes = cwi_alloc_array(mesh->attribute_count, sizeof *like.attributes);
    if (!like.attributes)
        return cwi_fail_memory(err);
    like.attribute_count = 0;
    for (size_t n = 0; n < mesh->attribute_count; n++)
        if (&mesh->attributes[n] != uv)
            like.attributes[like.attribute_count++] = mesh->attributes[n];
    seam_split s = {.mesh = mesh, .uv = uv->data};
    st = split(&s, &like, &out, err);
    cwi_free(like.attributes);
    if (st != CW_OK) {
        cw_mesh_free(&out);
        return st;
    }
    cw_mesh_free(mesh);
    *mesh = out;
    return CW_OK;
}
