/* Checks the options of compression, and sets the library's settings from them. */
#include "cli/results/compress_options.h"

#include "cli/framework/quantity.h"
#include "core/base/status.h"
#include "core/geometry/box.h"

#include <math.h>

const char *cli_compression_name(cw_compression kind)
{
    static const char *const names[] = {"none", "quantize", "draco", "meshopt"};
    return names[kind];
}

cw_status cli_check_compress(const cli_compress *c, cw_error *err)
{
    if (c->effort > 10)
        return cwi_fail(err, CW_ERR_ARGUMENT, "--effort %zu: 1 to 10 was expected", c->effort);
    if (c->bits > 30)
        return cwi_fail(err, CW_ERR_ARGUMENT, "--bits %zu: 1 to 30 was expected", c->bits);
    return CW_OK;
}

static double diagonal_of(const cw_part *parts, size_t count)
{
    double low[3], high[3];
    cwi_box_clear(low, high);
    for (size_t p = 0; p < count; p++) {
        double from[3], to[3];
        if (cw_mesh_bounds(parts[p].mesh, from, to))
            cwi_box_join(low, high, from, to);
    }
    return cwi_box_diagonal(low, high);
}

void cli_set_compress(const cli_compress *c, const cw_part *parts, size_t count,
                      double voxel_mm, cw_write_desc *desc)
{
    desc->compression = (cw_compression)c->kind;
    desc->bits = (int)c->bits;
    desc->level = (int)c->effort;
    if (c->tolerance.given)
        desc->tolerance_mm = cli_length_mm(&c->tolerance, diagonal_of(parts, count), voxel_mm);
}
