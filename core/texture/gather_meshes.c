/* Joins meshes that share a texture. */
#include "core/texture/gather_meshes.h"

#include "core/base/status.h"
#include "core/mesh/mesh.h"
#include "core/mesh/mesh_attributes.h"
#include "core/texture/split_seams.h"

/* Multiplies places, relative to the mesh's origin. */
static void scale_places(cw_mesh *mesh, double scale)
{
    for (size_t n = 0; n < 3 * mesh->vertex_count; n++)
        mesh->positions[n] = (float)(scale * (double)mesh->positions[n]);
}

cw_status cwi_gather_meshes(const cw_mesh *const *meshes, const double *scales, size_t count,
                            bool normals, bool texture, cw_mesh *all, cw_error *err)
{
    cw_status st = CW_OK;
    *all = (cw_mesh){0};
    for (size_t n = 0; n < count && st == CW_OK; n++) {
        cw_mesh split = {0}, copy = {0};
        const bool parts = texture && normals && cwi_has_seams(meshes[n]);
        st = parts ? cwi_split_seams(meshes[n], &split, err) : CW_OK;
        cw_mesh bare = parts ? split : *meshes[n];
        const cw_attribute *coordinates = texture ? cwi_texture_of(&bare) : NULL;
        bare.normals = normals ? bare.normals : NULL;
        bare.scalars = NULL;
        bare.colors = NULL;
        bare.labels = NULL;
        bare.attributes = (cw_attribute *)(uintptr_t)coordinates;
        bare.attribute_count = coordinates ? 1 : 0;
        if (st == CW_OK)
            st = cwi_mesh_copy(&bare, &copy, err);
        cw_mesh_free(&split);
        if (st == CW_OK && scales)
            scale_places(&copy, scales[n]);
        if (st == CW_OK && n == 0) {
            *all = copy;
            continue;
        }
        if (st == CW_OK)
            st = cwi_mesh_append(all, &copy, err);
        cw_mesh_free(&copy);
    }
    if (st != CW_OK)
        cw_mesh_free(all);
    return st;
}
