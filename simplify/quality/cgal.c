/* CGAL's answers: from a module, loaded when one is asked for. */
#include "simplify/quality/cgal_wrap.h"

#include "core/base/module.h"
#include "core/base/status.h"

static cw_status load_cgal(const cwi_cgal_functions **functions, cw_error *err)
{
    const void *module;
    cw_status st = cwi_module_load("cgal", &module, err);
    if (st == CW_OK)
        *functions = module;
    return st;
}

bool cw_quality_has_cgal(void)
{
    return cwi_module_present("cgal");
}

cw_status cw_quality_ask_cgal(const cw_mesh *mesh, cw_weld weld, cw_cgal_facts *out,
                              cw_error *err)
{
    CWI_REQUIRE(err, mesh, out);
    const cwi_cgal_functions *functions;
    cwi_welded welded = {0};
    *out = (cw_cgal_facts){0};
    cw_status st = load_cgal(&functions, err);
    if (st == CW_OK)
        st = cwi_welded_init(&welded, mesh, weld, err);
    if (st == CW_OK)
        st = functions->judge(&welded, out, err);
    cwi_welded_free(&welded);
    return st;
}

cw_status cw_distance_by_cgal(const cw_mesh *mesh, const cw_mesh *reference,
                              double tolerance_mm, double *out_mm, cw_error *err)
{
    CWI_REQUIRE(err, mesh, reference, out_mm);
    const cwi_cgal_functions *functions;
    *out_mm = 0;
    cw_status st = cw_mesh_check(mesh, err);
    if (st == CW_OK)
        st = cw_mesh_check(reference, err);
    if (st == CW_OK && !(tolerance_mm > 0))
        st = cwi_fail(err, CW_ERR_ARGUMENT, "the tolerance is %g mm; it must be above 0",
                      tolerance_mm);
    if (st == CW_OK)
        st = load_cgal(&functions, err);
    return st == CW_OK ? functions->hausdorff(mesh, reference, tolerance_mm, out_mm, err) : st;
}
