/* Makes the shape of a volume from a Zarr array and the frame of its axes. */
#include "core/base/status.h"
#include "formats/zarr/zarr_handle.h"
#include "formats/zarr/zarr_image.h"

#include <stdio.h>
#include <string.h>

/* Sets the affine from the rows of the axes of space. Those that an array lacks get a unit
 * vector. Returns CW_ERR_FORMAT where places depend on a component or step. */
static cw_status set_affine(cwi_zarr *z, const cwi_zarr_frame *frame, cw_error *err)
{
    cw_volume *v = &z->shape;
    for (int r = 0; r < 3; r++) {
        const int row = z->dimensions[r];
        v->affine[r][r] = row < 0 ? 1 : 0;
        if (row < 0)
            continue;
        const double unit = frame->axes[row].unit;
        for (int c = 0; c < 3; c++)
            if (z->dimensions[c] >= 0)
                v->affine[r][c] = unit * frame->matrix[row][z->dimensions[c]];
        v->affine[r][3] = unit * frame->matrix[row][frame->rank];
        for (size_t d = 0; d < frame->rank; d++)
            if (frame->axes[d].role > CWI_AXIS_Z && frame->matrix[row][d] != 0)
                return cwi_fail(
                    err, CW_ERR_FORMAT, "'%s' place '%s' by '%s'; they must keep space apart",
                    z->array.words->frame, frame->axes[row].name, frame->axes[d].name);
    }
    return CW_OK;
}

static void set_units(cwi_zarr *z, const cwi_zarr_frame *frame)
{
    const int step = z->dimensions[CWI_AXIS_STEP], x = z->dimensions[CWI_AXIS_X];
    bool known = x >= 0;
    for (int r = 0; r < 3; r++)
        known = known && (z->dimensions[r] < 0 || frame->axes[z->dimensions[r]].has_unit);
    if (known) {
        z->shape.known |= CW_KNOWN_UNIT;
        z->shape.said_unit_mm = frame->axes[x].unit;
    }
    if (step >= 0 && frame->axes[step].has_unit && frame->matrix[step][step] > 0)
        z->shape.step_seconds = frame->matrix[step][step] * frame->axes[step].unit;
}

static void list_axes(cwi_zarr *z, const cwi_zarr_frame *frame)
{
    size_t used = 0;
    for (size_t d = 0; d < frame->rank; d++)
        used += (size_t)snprintf(z->axes + used, sizeof z->axes - used, "%s%s", d ? " " : "",
                                 frame->axes[d].name);
}

cw_status cwi_zarr_set_frame(cwi_zarr *z, const cwi_zarr_frame *frame, cw_error *err)
{
    cwi_source source = {.shape = z->shape, .size_field = z->array.words->shape};
    cwi_axis axes[CWI_ROLE_COUNT];
    for (int r = 0; r < CWI_ROLE_COUNT; r++) {
        z->dimensions[r] = -1;
        for (size_t d = 0; d < frame->rank; d++)
            if ((int)frame->axes[d].role == r)
                z->dimensions[r] = (int)d;
        z->sizes[r] = z->dimensions[r] < 0 ? 1 : z->array.shape[z->dimensions[r]];
        axes[r] = (cwi_axis){.role = (cwi_role)r, .size = z->sizes[r]};
    }
    source.shape.type = z->array.type;
    source.shape.slope = 1;
    for (size_t d = 0; d < frame->rank; d++)
        if (frame->axes[d].role == CWI_ROLE_COUNT && z->array.shape[d] > 1)
            return cwi_fail(err, CW_ERR_FORMAT,
                            "'%s' has %zu entries along dimension %zu of %zu; at most five "
                            "dimensions are read",
                            z->array.words->shape, z->array.shape[d], d, frame->rank);
    cw_status st = cwi_source_set_axes(&source, axes, CWI_ROLE_COUNT, err);
    if (st != CW_OK)
        return st;
    z->shape = source.shape;
    list_axes(z, frame);
    set_units(z, frame);
    st = set_affine(z, frame, err);
    return st == CW_OK ? cwi_check_frame(&z->shape, z->array.words->frame, err) : st;
}
