/* Unions and wraps by CGAL: from a module, loaded when it is needed. */
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

cw_status cwi_unite_shells(cwi_repair *r, const uint32_t *shell, uint32_t shells,
                           const bool *marked, bool *is_done, cw_error *err)
{
    const cwi_wrap_functions *functions;
    cw_mesh united = {0};
    cw_status st = load_wrap(&functions, err);
    *is_done = false;
    if (st == CW_OK)
        st = functions->unite(&r->mesh, shell, shells, marked, &united, is_done, err);
    if (st == CW_ERR_BACKEND) { /* triangles are dropped instead */
        if (err)
            *err = (cw_error){0};
        st = CW_OK;
        *is_done = false;
    }
    if (st == CW_OK && *is_done) {
        st = cwi_mesh_drop_marked(&r->mesh, marked, err);
        for (size_t c = 0; c < 3 * united.triangle_count && st == CW_OK; c++)
            united.triangles[c] += (uint32_t)r->mesh.vertex_count;
        if (st == CW_OK)
            st = cwi_repair_append(r, united.positions, united.vertex_count, united.triangles,
                                   united.triangle_count, err);
    }
    cw_mesh_free(&united);
    return st;
}

static double measure_area(const cw_mesh *m)
{
    double sum = 0;
    for (size_t t = 0; t < m->triangle_count; t++)
        sum += cwi_mesh_area(m, t);
    return sum;
}

/* A wrap of an open surface has two sides. */
static cw_status check_radius(const cwi_repair *r, cw_error *err)
{
    const double area = 2 * measure_area(r->input),
                 smallest = sqrt(DENSITY * area / MAX_TRIANGLES);
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
    cw_mesh wrapped = {0};
    cw_status st = check_radius(r, err);
    if (st == CW_OK)
        st = load_wrap(&functions, err);
    if (st == CW_OK)
        st =
            functions->wrap(r->input, r->desc.wrap_mm, OFFSET * r->desc.wrap_mm, &wrapped, err);
    if (st == CW_OK) {
        r->mesh.vertex_count = r->mesh.triangle_count = 0;
        st = cwi_repair_append(r, wrapped.positions, wrapped.vertex_count, wrapped.triangles,
                               wrapped.triangle_count, err);
    }
    r->facts.is_wrapped = st == CW_OK;
    cw_mesh_free(&wrapped);
    return st;
}
