/* Lists the names of the render modes, the papers that they follow, and the grids they draw. */
#include <cubewright/render.h>

#include "core/volume/volume.h"

static const struct {
    const char *name, *about, *source;
} modes[CW_MODE_COUNT] = {
#define ROW(name, text, about, source) {text, about, source},
    CW_MODE_TABLE(ROW)
#undef ROW
};

const char *cw_mode_name(cw_mode mode)
{
    return (unsigned)mode < CW_MODE_COUNT ? modes[mode].name : "unknown";
}

const char *cw_mode_about(cw_mode mode)
{
    return (unsigned)mode < CW_MODE_COUNT ? modes[mode].about : "";
}

const char *cw_mode_source(cw_mode mode)
{
    return (unsigned)mode < CW_MODE_COUNT ? modes[mode].source : "";
}

bool cw_mode_draws(cw_mode mode, const cw_volume *volume)
{
    if (!volume)
        return false;
    const bool is_uneven = volume->cells || cwi_is_rectilinear(volume);
    if (mode == CW_MODE_MESH)
        return true;
    if (!is_uneven)
        return !volume->sparse;
    return mode == CW_MODE_VBUFFER || mode == CW_MODE_REFERENCE || mode == CW_MODE_PROJECTION ||
           cw_mode_is_intensity(mode);
}

bool cw_mode_is_intensity(cw_mode mode)
{
    return mode == CW_MODE_MIP || mode == CW_MODE_MINIP || mode == CW_MODE_AVERAGE ||
           mode == CW_MODE_LOCAL_MIP;
}
