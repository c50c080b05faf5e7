#include "cli/proof.h"

#include "cli/compare.h"
#include "cli/console.h"
#include "core/status.h"

#include <math.h>

cw_status cli_extract_full(const cli_volume *volume, const cli_wanted *wanted, cli_proof *proof,
                           cw_mesh *full, cw_error *err)
{
    cw_extract_counts counts;
    const double start = cli_seconds();
    cw_status st = cli_extract_wanted(volume, NULL, wanted, full, &counts, NULL, err);
    if (st != CW_OK)
        return st;
    proof->made = true;
    proof->full_seconds = cli_seconds() - start;
    proof->full_bytes = counts.bytes;
    proof->full_triangles = full->triangle_count;
    return CW_OK;
}

static double diagonal_of(const cw_mesh *mesh)
{
    double low[3], high[3];
    cw_mesh_bounds(mesh, low, high);
    return hypot(hypot(high[0] - low[0], high[1] - low[1]), high[2] - low[2]);
}

cw_status cli_prove_error(const cli_volume *volume, const cli_wanted *wanted,
                          const cw_simplify_desc *simplify, const cw_mesh *mesh,
                          cli_proof *proof, cli_comparison *compared, cw_error *err)
{
    const double promised = simplify->error_mm;
    double area[2] = {0, 0};
    cw_mesh full;
    cw_status st = cli_extract_full(volume, wanted, proof, &full, err);
    if (st != CW_OK)
        return st;
    compared->promised_mm = proof->promised_mm = promised;
    compared->diagonal_mm = diagonal_of(&full);
    compared->other = "the full surface";
    st = cli_compare(mesh, &full, promised / 20, simplify->threads, compared, area, err);
    cw_mesh_free(&full);
    if (st != CW_OK)
        return cwi_fail_in(err, st, volume->path);
    proof->mm = fmax(compared->to_input.max_mm, compared->from_input.max_mm);
    if (proof->mm <= promised)
        return CW_OK;
    return cw_fail(err, CW_ERR_CHECK,
                   "%s: not as promised: %.6g mm from the full surface, and not %.6g; nothing "
                   "is written",
                   volume->path, proof->mm, promised);
}
