/* Lists the modes by what they show, for the widgets that choose one. */
#include "cli/window/panels.h"

static const struct {
    const char *heading;
    cw_mode modes[8];
    size_t count;
} mode_groups[] = {
    {CWI_UI_HEADING "Surface", {CW_MODE_MESH}, 1},
    {CWI_UI_HEADING "Integral of light along rays",
     {CW_MODE_COMPOSITE, CW_MODE_TEXTURE, CW_MODE_SHADED_TEXTURE, CW_MODE_SPLAT,
      CW_MODE_SPLAT_TREE, CW_MODE_PROJECTION},
     6},
    {CWI_UI_HEADING "One value of each ray",
     {CW_MODE_MIP, CW_MODE_LOCAL_MIP, CW_MODE_MINIP, CW_MODE_AVERAGE},
     4},
    {CWI_UI_HEADING "Slices", {CW_MODE_SLICES}, 1},
    {CWI_UI_HEADING "Exact, for study", {CW_MODE_VBUFFER, CW_MODE_REFERENCE}, 2},
};

size_t view_list_modes(const view *v, bool with_mesh, const char **names)
{
    size_t count = 0;
    for (size_t g = 0; g < sizeof mode_groups / sizeof *mode_groups; g++) {
        const size_t before = count;
        names[count++] = mode_groups[g].heading;
        for (size_t m = 0; m < mode_groups[g].count; m++) {
            const cw_mode mode = mode_groups[g].modes[m];
            if (view_fits_mode(v, mode) && (with_mesh || mode != CW_MODE_MESH))
                names[count++] = cw_mode_name(mode);
        }
        if (count == before + 1) /* a heading of nothing */
            count = before;
    }
    return count;
}
