/* The stage that lets normals part at creases, and where caps close a surface at the end of its volume. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/affine.h"
#include "core/mesh/mesh_triangle.h"
#include "core/volume/volume.h"
#include "extract/pipeline/stages.h"

/* Voxels between a simplified cap and the last samples, at most, and the least cosine between its triangles and the
 * direction outward: 20 degrees. Slivers along the edges of the volume lean further. */
#define NEAR_CAP   2.0
#define CAP_COSINE 0.94

/* Returns the volume that a surface came from; NULL: there is none. */
static const cw_volume *volume_of(const cwi_pipeline *p)
{
    return p->volume ? p->volume : p->slices ? &p->slices->shape : NULL;
}

/* Returns the number of the cap that a triangle belongs to, from 1 to 6; 0: it is of none. */
static uint8_t find_cap(const cw_volume *v, double (*inverse)[3], const cw_mesh *mesh, size_t t)
{
    double corner[3][3], middle[3], normal[3];
    cwi_mesh_corners(mesh, t, corner);
    cwi_triangle_centroid(corner[0], corner[1], corner[2], middle);
    cwi_mesh_normal(mesh, t, normal);
    cwi_normalise(normal);
    for (int r = 0; r < 3; r++)
        middle[r] += mesh->origin[r] - v->affine[r][3];
    for (int a = 0; a < 3; a++) {
        const double at = cwi_coordinate_index(v, a, cwi_dot(inverse[a], middle));
        const double cosine = cwi_dot(inverse[a], normal) / cwi_length(inverse[a]);
        if (cosine < -CAP_COSINE && at < NEAR_CAP)
            return (uint8_t)(2 * a + 1);
        if (cosine > CAP_COSINE && at > (double)(v->dim[a] - 1) - NEAR_CAP)
            return (uint8_t)(2 * a + 2);
    }
    return 0;
}

static cw_status find_caps(const cw_volume *v, const cw_mesh *mesh, uint8_t **caps,
                           cw_error *err)
{
    double inverse[3][3];
    cwi_affine_invert(v->affine[0], inverse);
    *caps = cwi_alloc_array(mesh->triangle_count, 1);
    if (!*caps)
        return cwi_fail_memory(err);
    for (size_t t = 0; t < mesh->triangle_count; t++)
        (*caps)[t] = find_cap(v, inverse, mesh, t);
    return CW_OK;
}

cw_status cwi_part_normals(cwi_pipeline *p, cw_mesh *mesh, cw_error *err)
{
    const cw_pipeline_desc *d = p->desc;
    const cw_volume *volume = volume_of(p);
    uint8_t *caps = NULL;
    cw_status st = CW_OK;
    if (!mesh->triangle_count)
        return CW_OK;
    if (d->crease_caps && volume && !d->extract.leave_open)
        st = find_caps(volume, mesh, &caps, err);
    if (st == CW_OK)
        st = cw_mesh_crease_normals(mesh, d->crease_degrees > 0 ? d->crease_degrees : 180, caps,
                                    &p->facts.creases, err);
    cwi_free(caps);
    return st == CW_OK ? CW_OK : cwi_fail_in(err, st, "creases");
}
