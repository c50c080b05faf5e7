/* Draws a volume by splatting every voxel's footprint, sheet by sheet. */
#include "viewer/modes/gl_draw.h"
#include "viewer/modes/splat_sheets.h"

static cw_status draw_splat_mode(cwi_gl *gl, void **state, cw_error *err)
{
    cwi_splats s = {0};
    (void)state;
    cw_status st = cwi_splats_open(&s, gl, false, err);
    if (st == CW_OK)
        st = cwi_splats_flat(&s, err);
    cwi_splats_close(&s);
    return st;
}

const cwi_gl_mode cwi_gl_splat = {CW_MODE_SPLAT, false, draw_splat_mode, NULL, false};
