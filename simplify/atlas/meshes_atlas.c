/* Texture coordinates of several meshes in one square. */
#include "core/base/status.h"
#include "core/mesh/mesh.h"
#include "core/texture/gather_meshes.h"
#include "core/texture/split_seams.h"

#include <cubewright/atlas.h>

#include <math.h>
#include <string.h>

/* Gives each mesh its share of the coordinates of all. */
static cw_status share_coordinates(cw_mesh *const *meshes, size_t count, const cw_mesh *all,
                                   cw_error *err)
{
    const float *from = cwi_texture_of(all)->data;
    cw_status st = CW_OK;
    for (size_t n = 0; n < count && st == CW_OK; n++) {
        const size_t corners = 3 * meshes[n]->triangle_count;
        float(*uv)[2];
        st = cwi_texture_add(meshes[n], CW_ON_CORNERS, &uv, err);
        if (st == CW_OK && corners)
            memcpy(uv, from, corners * sizeof *uv);
        from += 2 * corners;
    }
    return st;
}

static cw_status check_meshes(cw_mesh *const *meshes, const double *scales, size_t count,
                              cw_error *err)
{
    cw_status st =
        count ? CW_OK : cwi_fail(err, CW_ERR_ARGUMENT, "count is 0: expected meshes");
    for (size_t n = 0; n < count && st == CW_OK; n++) {
        if (scales && (!(scales[n] > 0) || isinf(scales[n])))
            return cwi_fail(err, CW_ERR_ARGUMENT,
                            "scales[%zu] is %g: expected a positive, finite number", n,
                            scales[n]);
        st = cw_mesh_check(meshes[n], err);
    }
    return st;
}

cw_status cw_meshes_atlas(cw_mesh *const *meshes, const double *scales, size_t count,
                          const cw_atlas_desc *desc, cw_atlas_facts *facts, cw_error *err)
{
    CWI_REQUIRE(err, meshes);
    CWI_REQUIRE_VERSION(err, desc, 0);
    cw_mesh all = {0};
    cw_status st = check_meshes(meshes, scales, count, err);
    if (st == CW_OK)
        st = cwi_gather_meshes((const cw_mesh *const *)meshes, scales, count, false, false,
                               &all, err);
    if (st == CW_OK)
        st = cw_mesh_atlas(&all, desc, facts, err);
    if (st == CW_OK)
        st = share_coordinates(meshes, count, &all, err);
    cw_mesh_free(&all);
    return st;
}
