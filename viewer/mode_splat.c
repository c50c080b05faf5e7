/* Splatting: every voxel's footprint, sheet by sheet. */
#include "viewer/splats.h"

#include "core/memory.h"
#include "core/status.h"

/* What is kept from picture to picture of a volume: whether samples have no value. */
static cw_status make_state(const cwi_frame *f, bool **out, cw_error *err)
{
    *out = cwi_alloc_zeroed(1, sizeof **out);
    if (!*out)
        return cw_fail(err, CW_ERR_NO_MEMORY, "no memory for splatting");
    **out = cwi_lattice_has_gaps(&f->volume, f->scene.threads);
    return CW_OK;
}

static void drop(void *state)
{
    cwi_free(state);
}

static cw_status draw(cwi_gl *gl, void **state, cw_error *err)
{
    cwi_splats s = {0};
    cw_status st = *state ? CW_OK : make_state(gl->frame, (bool **)state, err);
    if (st == CW_OK)
        st = cwi_splats_open(&s, gl, *(const bool *)*state, false, err);
    if (st == CW_OK)
        st = cwi_splats_flat(&s, err);
    cwi_splats_close(&s);
    return st;
}

const cwi_gl_mode cwi_gl_splat = {CW_MODE_SPLAT, false, draw, drop};
