/* Plans cuts of a mesh that is larger than the plate. */
#include "core/base/memory.h"
#include "core/base/status.h"

#include <cubewright/pieces.h>

#include <math.h>

/* Parts may be longer than the plate by this fraction, for rounding. */
static const double SLACK = 1e-6;

/* Returns how many equal parts a length is cut to; 0: far too many. */
static size_t count_parts(double length, double plate, double reserve)
{
    if (length <= plate * (1 + SLACK))
        return 1;
    const double parts = ceil(length / (plate - reserve) * (1 - SLACK));
    return parts <= CW_MAX_CUT_PLANES + 1 ? (size_t)fmax(parts, 2) : 0;
}

cw_status cw_plate_planes(const cw_mesh *mesh, const cw_plate_desc *desc, cw_cut_desc **planes,
                          size_t *count, cw_error *err)
{
    CWI_REQUIRE(err, mesh, desc, planes, count);
    CWI_REQUIRE_VERSION(err, desc, 0);
    const double *plate_mm = desc->plate_mm, reserve_mm = desc->reserve_mm;
    double low[3], high[3];
    size_t parts[3], total = 0;
    *planes = NULL;
    *count = 0;
    const cw_status st = cw_mesh_check(mesh, err);
    if (st != CW_OK)
        return st;
    if (!(reserve_mm >= 0))
        return cwi_fail(err, CW_ERR_ARGUMENT, "reserve_mm is %g; it must be 0 or more",
                        reserve_mm);
    cw_mesh_bounds(mesh, low, high);
    for (int a = 0; a < 3; a++) {
        if (!(plate_mm[a] > reserve_mm) || !isfinite(plate_mm[a]))
            return cwi_fail(err, CW_ERR_ARGUMENT,
                            "plate_mm[%d] is %g; it must be finite and above 0%s", a,
                            plate_mm[a], reserve_mm > 0 ? ", and longer than a peg" : "");
        parts[a] = count_parts(high[a] - low[a], plate_mm[a], reserve_mm);
        total += parts[a] - 1;
        if (!parts[a] || total > CW_MAX_CUT_PLANES)
            return cwi_fail(
                err, CW_ERR_LIMIT,
                "%.6g mm along %c on a plate of %.6g mm: that takes more than %d cuts",
                high[a] - low[a], 'x' + a, plate_mm[a], CW_MAX_CUT_PLANES);
    }
    *planes = total ? cwi_alloc_zeroed(total, sizeof **planes) : NULL;
    if (total && !*planes)
        return cwi_fail_memory(err);
    for (int a = 0; a < 3; a++)
        for (size_t n = 1; n < parts[a]; n++) {
            cw_cut_desc *plane = &(*planes)[(*count)++];
            plane->normal[a] = 1;
            plane->point[a] = low[a] + (high[a] - low[a]) * (double)n / (double)parts[a];
        }
    return CW_OK;
}

void cw_planes_free(cw_cut_desc *planes)
{
    cwi_free(planes);
}
