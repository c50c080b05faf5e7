/* Copies meshes out of the interfaces: the closed one of a label, or that of a patch. */
#include "extract/labels/find_label.h"
#include "extract/labels/label_net.h"

#include "core/mesh/mesh_triangle.h"
#include "core/volume/key_counts.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/vec3.h"

#include <string.h>

/* Returns the side of a patch that a label is on: 0, 1, or -1. */
static int side_of(const cw_label_patch *patch, uint32_t label)
{
    return patch->labels[0] == label ? 0 : patch->labels[1] == label ? 1 : -1;
}

/* Copies a patch's triangles, with vertices numbered as they are met. Returns false when memory
 * is out. */
static bool copy_patch(const cw_label_surfaces *s, const cw_label_patch *patch, int side,
                       cwi_key_counts *numbers, cw_mesh *mesh)
{
    const uint32_t *from = s->mesh.triangles + 3 * patch->first;
    for (size_t n = 0; n < 3 * patch->count; n++) {
        /* seen from the other side, the last two corners change places */
        const size_t turned = n % 3 && side == 1 ? n - n % 3 + 3 - n % 3 : n;
        cwi_key_count *e = cwi_key_counts_need(numbers, (uint64_t)from[turned] + 1);
        if (!e)
            return false;
        if (e->count == 0) {
            memcpy(mesh->positions + 3 * mesh->vertex_count,
                   s->mesh.positions + 3 * (size_t)from[turned], 3 * sizeof(float));
            e->count = ++mesh->vertex_count;
        }
        mesh->triangles[3 * mesh->triangle_count + n] = (uint32_t)(e->count - 1);
        cwi_label_trim(n);
    }
    mesh->triangle_count += patch->count;
    return true;
}

/* Makes arrays for copies of triangles. One brings at most three vertices. */
static bool ensure_capacity(const cw_label_surfaces *s, size_t triangles, cw_mesh *mesh)
{
    memset(mesh, 0, sizeof *mesh);
    memcpy(mesh->origin, s->mesh.origin, sizeof mesh->origin);
    memcpy(mesh->affine, s->mesh.affine, sizeof mesh->affine);
    if (triangles == 0)
        return true;
    mesh->triangles = cwi_alloc_array(triangles, 3 * sizeof *mesh->triangles);
    mesh->positions = cwi_alloc_array(3 * triangles, 3 * sizeof *mesh->positions);
    return mesh->triangles && mesh->positions;
}

/* Returns the memory of vertices that were not needed. The mesh is emptied on failure. */
static cw_status fit_vertices(cw_mesh *mesh, bool is_whole, cw_error *err)
{
    float *fitted = NULL;
    if (is_whole && mesh->vertex_count == 0)
        return CW_OK;
    if (is_whole)
        fitted = cwi_realloc_array(mesh->positions, 3 * mesh->vertex_count, sizeof *fitted);
    if (fitted) {
        mesh->positions = fitted;
        return CW_OK;
    }
    cw_mesh_free(mesh);
    return cwi_fail_memory(err);
}

cw_status cw_label_mesh(const cw_label_surfaces *s, uint32_t label, cw_mesh *mesh,
                        cw_error *err)
{
    CWI_REQUIRE(err, s, mesh);
    cwi_key_counts numbers = {0};
    size_t triangles = 0;
    for (size_t p = 0; p < s->patch_count; p++)
        triangles += side_of(&s->patches[p], label) >= 0 ? s->patches[p].count : 0;
    bool is_whole = ensure_capacity(s, triangles, mesh);
    for (size_t p = 0; p < s->patch_count && is_whole; p++) {
        const int side = side_of(&s->patches[p], label);
        is_whole = side < 0 || copy_patch(s, &s->patches[p], side, &numbers, mesh);
    }
    cwi_key_counts_free(&numbers);
    return fit_vertices(mesh, is_whole, err);
}

cw_status cw_label_patch_mesh(const cw_label_surfaces *s, const cw_label_patch *patch,
                              cw_mesh *mesh, cw_error *err)
{
    CWI_REQUIRE(err, s, patch, mesh);
    cwi_key_counts numbers = {0};
    const bool is_whole =
        ensure_capacity(s, patch->count, mesh) && copy_patch(s, patch, 0, &numbers, mesh);
    cwi_key_counts_free(&numbers);
    return fit_vertices(mesh, is_whole, err);
}

double cw_label_patch_area(const cw_label_surfaces *s, const cw_label_patch *patch)
{
    double area = 0;
    for (size_t t = patch->first; t < patch->first + patch->count; t++) {
        area += cwi_mesh_area(&s->mesh, t);
        cwi_label_trim(t);
    }
    return area;
}

void cw_label_volumes(const cw_label_surfaces *s, double *volumes)
{
    for (size_t n = 0; n < s->label_count; n++)
        volumes[n] = 0;
    for (size_t p = 0; p < s->patch_count; p++) {
        double sum = 0;
        for (size_t t = s->patches[p].first; t < s->patches[p].first + s->patches[p].count;
             t++) {
            double corner[3], normal[3];
            cwi_mesh_corner(&s->mesh, t, 0, corner);
            cwi_mesh_normal(&s->mesh, t, normal);
            sum += cwi_dot(corner, normal) / 6;
            cwi_label_trim(t);
        }
        for (int side = 0; side < 2; side++) {
            const size_t n = cwi_find_label(s, s->patches[p].labels[side]);
            if (n < s->label_count)
                volumes[n] += side == 0 ? sum : -sum;
        }
    }
}
