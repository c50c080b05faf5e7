/* Checks the weights of attributes, and scales the attributes to lengths: a weight of 1 is 1 %
 * of the diagonal. */
#include "simplify/attribute_weights.h"

#include "core/base/status.h"
#include "core/geometry/box.h"
#include "simplify/collapse/openmesh_wrap.h"

#include <math.h>

enum { NORMAL = 3, COLOR = 4, SCALAR = 1 };
_Static_assert(NORMAL + COLOR + SCALAR + CWI_TEXTURE_ATTRIBUTES <= CWI_MAX_ATTRIBUTES,
               "room for all of them");

size_t cwi_attributes_count(const cw_simplify_desc *d)
{
    return (size_t)((d->normal_weight > 0) * NORMAL + (d->color_weight > 0) * COLOR +
                    (d->scalar_weight > 0) * SCALAR);
}

cw_status cwi_attributes_check(const cw_mesh *mesh, const cw_simplify_desc *d, cw_error *err)
{
    const struct {
        const char *name;
        float weight;
        const void *array;
    } rows[] = {{"normal", d->normal_weight, mesh->normals},
                {"color", d->color_weight, mesh->colors},
                {"scalar", d->scalar_weight, mesh->scalars}};
    for (size_t n = 0; n < sizeof rows / sizeof *rows; n++) {
        if (!(rows[n].weight >= 0) || !isfinite(rows[n].weight))
            return cwi_fail(err, CW_ERR_ARGUMENT, "%s_weight is %g; it must be 0 or more",
                            rows[n].name, (double)rows[n].weight);
        if (rows[n].weight > 0 && mesh->vertex_count && !rows[n].array)
            return cwi_fail(err, CW_ERR_ARGUMENT, "%s_weight is %g; the mesh has no %ss",
                            rows[n].name, (double)rows[n].weight, rows[n].name);
    }
    return CW_OK;
}

/* A weight of 1 is 1 % of the diagonal. */
static double unit_of(const cw_mesh *mesh)
{
    double low[3], high[3];
    cw_mesh_bounds(mesh, low, high);
    return 0.01 * cwi_box_diagonal(low, high);
}

static double range_of(const float *numbers, size_t count)
{
    float low = INFINITY, high = -INFINITY;
    for (size_t n = 0; n < count; n++) {
        low = fminf(low, numbers[n]);
        high = fmaxf(high, numbers[n]);
    }
    return high > low ? (double)high - (double)low : 1;
}

void cwi_attributes_weigh(const cw_mesh *m, const cw_simplify_desc *d, float *values)
{
    const double unit = unit_of(m), normal = (double)d->normal_weight * unit,
                 color = (double)d->color_weight * unit / 255,
                 range = d->scalar_weight > 0 ? range_of(m->scalars, m->vertex_count) : 1,
                 scalar = (double)d->scalar_weight * unit / range;
    for (size_t v = 0; v < m->vertex_count; v++) {
        for (size_t k = 0; k < NORMAL && normal > 0; k++)
            *values++ = (float)(normal * (double)m->normals[NORMAL * v + k]);
        for (size_t k = 0; k < COLOR && color > 0; k++)
            *values++ = (float)(color * (double)m->colors[COLOR * v + k]);
        if (scalar > 0)
            *values++ = (float)(scalar * (double)m->scalars[v]);
    }
}
