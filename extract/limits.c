#include "extract/limits.h"

#include "core/status.h"

size_t cwi_extract_mesh_bytes(const cw_extract_counts *c, bool normals)
{
    return c->vertices * 3 * sizeof(float) * (normals ? 2 : 1) +
           c->triangles * 3 * sizeof(uint32_t);
}

cw_status cwi_extract_check_limits(const cw_extract_desc *d, const cw_extract_counts *c,
                                   cw_error *err)
{
    if (d->max_triangles && c->triangles > d->max_triangles)
        return cw_fail(err, CW_ERR_LIMIT,
                       "the surface has %zu triangles; the limit is %zu (--max-triangles)",
                       c->triangles, d->max_triangles);
    if (d->max_bytes && c->bytes > d->max_bytes)
        return cw_fail(
            err, CW_ERR_LIMIT,
            "extraction of %zu triangles needs %zu bytes; the limit is %zu (--memory)",
            c->triangles, c->bytes, d->max_bytes);
    return CW_OK;
}
