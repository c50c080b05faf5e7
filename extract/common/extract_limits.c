/* Compares the triangles and the memory of an extraction with the limits of its descriptor. */
#include "extract/common/extract_limits.h"

#include "core/base/status.h"
#include "core/base/text.h"

size_t cwi_extract_mesh_bytes(const cw_extract_counts *c, bool normals)
{
    return c->vertices * 3 * sizeof(float) * (normals ? 2 : 1) +
           c->triangles * 3 * sizeof(uint32_t);
}

cw_status cwi_extract_check_limits(const cw_extract_desc *d, const cw_extract_counts *c,
                                   cw_error *err)
{
    if (d->max_triangles && c->triangles > d->max_triangles)
        return cwi_fail(err, CW_ERR_LIMIT,
                        "the surface has %zu triangles; the limit is %zu (desc->max_triangles)",
                        c->triangles, d->max_triangles);
    const size_t bytes = c->bytes + d->extra_bytes * c->triangles;
    if (d->max_bytes && bytes > d->max_bytes) {
        char needed[CWI_MEMORY_TEXT], left[CWI_MEMORY_TEXT];
        cwi_print_memory(bytes, needed);
        cwi_print_memory(d->max_bytes, left);
        return cwi_fail(err, CW_ERR_LIMIT,
                        "extraction of %zu triangles needs %s%s; %s are left (desc->max_bytes)",
                        c->triangles, needed, d->extra_bytes ? ", checks included" : "", left);
    }
    return CW_OK;
}
