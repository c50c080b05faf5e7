/* Gives each vertex one texture coordinate and one normal. */
#include "core/texture/split_seams.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/mesh/corner_table.h"
#include "core/mesh/mesh.h"
#include "core/mesh/mesh_attributes.h"

#include <cubewright/atlas.h>

#include <stdlib.h>
#include <string.h>

enum { KEYS = 5 };

/* A corner at a vertex, by the bits of its texture coordinate and its normal. */
typedef struct placed_corner {
    uint32_t key[KEYS];
    uint32_t corner;
} placed_corner;

/* Values that corners have, or the vertices that they are at. */
typedef struct corner_values {
    const cw_mesh *mesh;
    const cw_attribute *uv, *normals; /* NULL: none */
} corner_values;

static corner_values values_of(const cw_mesh *mesh)
{
    return (corner_values){mesh, cwi_texture_of(mesh), cwi_corner_normals_of(mesh)};
}

/* Returns the values of a corner. */
static const float *value_at(const corner_values *v, const cw_attribute *row, uint32_t corner)
{
    return (const float *)row->data +
           (size_t)row->components *
               (row->on == CW_ON_CORNERS ? corner : v->mesh->triangles[corner]);
}

static placed_corner place_corner(const corner_values *v, uint32_t corner)
{
    placed_corner placed = {.corner = corner};
    float key[KEYS] = {0};
    if (v->uv)
        memcpy(key, value_at(v, v->uv, corner), 2 * sizeof *key);
    if (v->normals)
        memcpy(key + 2, value_at(v, v->normals, corner), 3 * sizeof *key);
    for (int n = 0; n < KEYS; n++)
        key[n] += 0.0F; /* -0 and 0 are one place */
    memcpy(placed.key, key, sizeof key);
    return placed;
}

static int compare_keys(const placed_corner *m, const placed_corner *n)
{
    int k = 0;
    while (k < KEYS && m->key[k] == n->key[k])
        k++;
    return k == KEYS ? 0 : m->key[k] < n->key[k] ? -1 : 1;
}

static int compare_corners(const void *a, const void *b)
{
    const placed_corner *m = a, *n = b;
    const int order = compare_keys(m, n);
    return order ? order : (m->corner > n->corner) - (m->corner < n->corner);
}

/* Numbers the places of a vertex; the one that comes first has the vertex's number. */
static void number_places(cwi_texture_seams *s, uint32_t v, placed_corner *corners,
                          size_t count)
{
    bool differ = false;
    for (size_t n = 1; n < count && !differ; n++)
        differ = compare_keys(&corners[n], corners) != 0;
    if (differ)
        qsort(corners, count, sizeof *corners, compare_corners);
    uint32_t at = v;
    s->corner[v] = count ? corners[0].corner : CWI_NO_CORNER;
    for (size_t n = 0; n < count; n++) {
        if (n > 0 && compare_keys(&corners[n], &corners[n - 1]) != 0) {
            at = (uint32_t)s->count++;
            s->vertex[at] = v;
            s->corner[at] = corners[n].corner;
        }
        s->number[corners[n].corner] = at;
    }
}

/* Sets the numbers of all corners. Returns false when memory is out. */
static bool number_corners(cwi_texture_seams *s, const cw_mesh *m)
{
    const corner_values values = values_of(m);
    const size_t corners = 3 * m->triangle_count;
    uint32_t *first = cwi_alloc_array(m->vertex_count + 2, sizeof *first);
    uint32_t *around = cwi_alloc_array(corners, sizeof *around);
    placed_corner *placed = cwi_alloc_array(corners, sizeof *placed);
    const bool ok = first && around && placed;
    if (ok)
        cwi_fans_sort(m->triangles, m->triangle_count, m->vertex_count, first, around);
    for (uint32_t v = 0; v < m->vertex_count; v++)
        s->vertex[v] = v;
    s->count = m->vertex_count;
    for (uint32_t v = 0; ok && v < m->vertex_count; v++) {
        size_t count = 0;
        for (uint32_t n = first[v]; n < first[v + 1]; n++)
            for (uint32_t c = 3 * around[n]; c < 3 * around[n] + 3; c++)
                if (m->triangles[c] == v && (count == 0 || placed[count - 1].corner < c))
                    placed[count++] = place_corner(&values, c);
        number_places(s, v, placed, count);
    }
    cwi_free(first);
    cwi_free(around);
    cwi_free(placed);
    return ok;
}

const cw_attribute *cwi_texture_of(const cw_mesh *mesh)
{
    const cw_attribute *uv = cw_mesh_attribute_find(mesh, CW_TEXTURE_COORDINATES);
    return uv && (uv->on == CW_ON_CORNERS || uv->on == CW_ON_VERTICES) && uv->type == CW_F32 &&
                   uv->components == 2
               ? uv
               : NULL;
}

const cw_attribute *cwi_corner_normals_of(const cw_mesh *mesh)
{
    const cw_attribute *row = cw_mesh_attribute_find(mesh, CW_CORNER_NORMALS);
    return row && row->on == CW_ON_CORNERS && row->type == CW_F32 && row->components == 3
               ? row
               : NULL;
}

bool cwi_has_seams(const cw_mesh *mesh)
{
    const cw_attribute *uv = cwi_texture_of(mesh);
    return (uv && uv->on == CW_ON_CORNERS) || cwi_corner_normals_of(mesh);
}

cw_status cwi_texture_add(cw_mesh *mesh, cw_on on, float (**uv)[2], cw_error *err)
{
    const cw_attribute like = {.name = CW_TEXTURE_COORDINATES,
                               .on = on,
                               .type = CW_F32,
                               .components = 2,
                               .interpolation = CW_INTERPOLATE_LINEAR};
    cw_attribute *added;
    cw_mesh_attribute_remove(mesh, CW_TEXTURE_COORDINATES);
    cw_status st = cw_mesh_attribute_add(mesh, &like, &added, err);
    if (st == CW_OK)
        *uv = added->data;
    return st;
}

/* Makes a view of a mesh without two of its attributes. */
static cw_status hide_rows(const cw_mesh *mesh, const cw_attribute *first,
                           const cw_attribute *second, cw_mesh *view, cw_error *err)
{
    *view = *mesh;
    view->attribute_count = 0;
    view->attributes = cwi_alloc_array(mesh->attribute_count, sizeof *view->attributes);
    if (!view->attributes)
        return cwi_fail_memory(err);
    for (size_t n = 0; n < mesh->attribute_count; n++)
        if (&mesh->attributes[n] != first && &mesh->attributes[n] != second)
            view->attributes[view->attribute_count++] = mesh->attributes[n];
    return CW_OK;
}

cw_status cwi_texture_hide(const cw_mesh *mesh, cw_mesh *view, cw_error *err)
{
    return hide_rows(mesh, cwi_texture_of(mesh), NULL, view, err);
}

cw_status cwi_seams_find(const cw_mesh *mesh, cwi_texture_seams *seams, cw_error *err)
{
    const size_t corners = 3 * mesh->triangle_count, most = mesh->vertex_count + corners;
    *seams = (cwi_texture_seams){.number = cwi_alloc_array(corners, sizeof *seams->number),
                                 .vertex = cwi_alloc_array(most, sizeof *seams->vertex),
                                 .corner = cwi_alloc_array(most, sizeof *seams->corner)};
    return seams->number && seams->vertex && seams->corner && number_corners(seams, mesh)
               ? CW_OK
               : cwi_fail_memory(err);
}

void cwi_seams_free(cwi_texture_seams *seams)
{
    cwi_free(seams->number);
    cwi_free(seams->vertex);
    cwi_free(seams->corner);
    *seams = (cwi_texture_seams){0};
}

/* --- copies with one of each a vertex --------------------------------------------------------- */

/* Copies all but what corners have. like: the mesh without that */
static cw_status copy_mesh(const cwi_texture_seams *s, const cw_mesh *like, cw_mesh *copy,
                           cw_error *err)
{
    cw_status st = cwi_mesh_alloc(copy, s->count, like->triangle_count, false, err);
    if (st == CW_OK)
        st = cwi_attributes_alloc(like, copy, err);
    if (st != CW_OK)
        return st;
    memcpy(copy->origin, like->origin, sizeof copy->origin);
    memcpy(copy->affine, like->affine, sizeof copy->affine);
    memcpy(copy->triangles, s->number, 3 * like->triangle_count * sizeof *copy->triangles);
    for (size_t v = 0; v < s->count; v++) {
        memcpy(copy->positions + 3 * v, like->positions + 3 * (size_t)s->vertex[v],
               3 * sizeof *copy->positions);
        cwi_attributes_put(like, s->vertex[v], copy, v);
    }
    for (size_t t = 0; t < like->triangle_count; t++)
        cwi_attributes_put_triangle(like, t, like->triangles + 3 * t, copy, t);
    return CW_OK;
}

/* Gives vertices of a copy the values of their corners. */
static cw_status copy_values(const cwi_texture_seams *s, const corner_values *values,
                             cw_mesh *copy, cw_error *err)
{
    float(*uv)[2] = NULL;
    cw_status st = values->uv ? cwi_texture_add(copy, CW_ON_VERTICES, &uv, err) : CW_OK;
    for (size_t v = 0; st == CW_OK && v < s->count; v++) {
        const uint32_t corner = s->corner[v];
        if (uv && corner != CWI_NO_CORNER)
            memcpy(uv[v], value_at(values, values->uv, corner), sizeof *uv);
        if (copy->normals && values->normals && corner != CWI_NO_CORNER)
            memcpy(copy->normals + 3 * v, value_at(values, values->normals, corner),
                   3 * sizeof *copy->normals);
    }
    return st;
}

cw_status cwi_split_seams(const cw_mesh *mesh, cw_mesh *copy, cw_error *err)
{
    const corner_values values = values_of(mesh);
    cwi_texture_seams seams;
    cw_mesh like = {0};
    *copy = (cw_mesh){0};
    cw_status st = cwi_seams_find(mesh, &seams, err);
    if (st == CW_OK)
        st = hide_rows(mesh, values.uv, values.normals, &like, err);
    if (st == CW_OK)
        st = copy_mesh(&seams, &like, copy, err);
    if (st == CW_OK)
        st = copy_values(&seams, &values, copy, err);
    cwi_free(like.attributes);
    cwi_seams_free(&seams);
    return st;
}

cw_status cw_mesh_split_seams(cw_mesh *mesh, cw_error *err)
{
    cw_mesh copy = {0};
    CWI_REQUIRE(err, mesh);
    cw_status st = cwi_mesh_check_size(mesh, "split along its seams", err);
    if (st != CW_OK || !cwi_has_seams(mesh))
        return st;
    st = cwi_split_seams(mesh, &copy, err);
    if (st == CW_OK) {
        cw_mesh_free(mesh);
        *mesh = copy;
    } else {
        cw_mesh_free(&copy);
    }
    return st;
}
