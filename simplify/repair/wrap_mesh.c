/* Wraps by CGAL: from a module, loaded when it is needed. */
#include "core/base/memory.h"
#include "core/base/module.h"
#include "core/base/status.h"
#include "core/geometry/vec3.h"
#include "core/mesh/mesh.h"
#include "simplify/repair/repair_state.h"
#include "simplify/repair/repair_wrap.h"

#include <math.h>
#include <string.h>

/* The offset of a wrap, as a fraction of its radius, and triangles that it may have by an estimate. */
static const double OFFSET = 1.0 / 30, MAX_TRIANGLES = 2e7;

/* Triangles of a wrap for an area of radius^2: of a flat sheet it had 8.6. */
static const double DENSITY = 10;

static cw_status load_wrap(const cwi_wrap_functions **functions, cw_error *err)
{
    const void *module;
    cw_status st = cwi_module_load("wrap", &module, err);
    if (st == CW_OK)
        *functions = module;
    return st;
}

bool cw_repair_has_cgal(void)
{
    return cwi_module_present("wrap");
}

static double measure_area(const cw_mesh *m)
{
    double sum = 0;
    for (size_t t = 0; t < m->triangle_count; t++)
        sum += cwi_mesh_area(m, t);
    return sum;
}

/* A wrap of an open surface has two sides. */
static cw_status check_radius(const cwi_repair *r, const cw_mesh *from, cw_error *err)
{
    const double area = 2 * measure_area(from), smallest = sqrt(DENSITY * area / MAX_TRIANGLES);
    return r->desc.wrap_mm >= smallest
               ? CW_OK
               : cwi_fail(err, CW_ERR_LIMIT,
                          "wrap_mm is %g: the wrap would have more than %g triangles; at least "
                          "%.3g would do",
                          r->desc.wrap_mm, MAX_TRIANGLES, smallest);
}

cw_status cwi_wrap_mesh(cwi_repair *r, cw_error *err)
{
    const cwi_wrap_functions *functions;
    const cw_repair_facts *f = &r->facts;
    const cw_mesh *from = f->is_sound && !f->sheets && !f->one_sided ? &r->mesh : r->input;
    cw_mesh wrapped = {0};
    cw_status st = check_radius(r, from, err);
    if (st == CW_OK)
        st = load_wrap(&functions, err);
    if (st == CW_OK)
        st = functions->wrap(from, r->desc.wrap_mm, OFFSET * r->desc.wrap_mm, &wrapped, err);
    if (st == CW_OK) {
        r->mesh.vertex_count = r->mesh.triangle_count = 0;
        st = cwi_repair_append(r, wrapped.positions, wrapped.vertex_count, wrapped.triangles,
                               wrapped.triangle_count, err);
    }
    r->facts.is_wrapped = st == CW_OK;
    cw_mesh_free(&wrapped);
    return st;
}
