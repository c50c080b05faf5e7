/* Divides the window's picture among its parts: the scene alone, or beside three slices. */
#include "cli/session/view.h"

#include <math.h>
#include <string.h>

bool view_is_quad(const view *v)
{
    return v->state.args.marks.layout == CLI_LAYOUT_QUAD && v->document.has_volume &&
           view_fits_mode(v, CW_MODE_SLICES);
}

/* Places the parts: the scene alone, or in the lower right of four. */
void view_place_parts(view *v, const cwi_ui_rect *area, bool is_quad)
{
    const double w = floor(area->width / 2), h = floor(area->height / 2);
    for (int p = 0; p < VIEW_PARTS; p++) {
        view_part *part = &v->picture.parts[p];
        const cwi_ui_rect before = part->rect;
        const int at = p == VIEW_SPACE ? 3 : p - 1; /* of four */
        const double x = at % 2 ? w + 1 : 0, y = at / 2 ? h + 1 : 0;
        part->is_shown = p == VIEW_SPACE || is_quad;
        part->rect =
            is_quad ? (cwi_ui_rect){area->x + x, area->y + y, at % 2 ? area->width - w - 1 : w,
                                    at / 2 ? area->height - h - 1 : h}
                    : *area;
        part->rect.width = fmax(part->rect.width, 1);
        part->rect.height = fmax(part->rect.height, 1);
        if (memcmp(&before, &part->rect, sizeof before) != 0)
            part->level = VIEW_STALE;
    }
}

cwi_ui_rect view_picture_area(const view *v)
{
    return (cwi_ui_rect){
        0, v->layout.bar_height, fmax(1, (double)v->layout.width - v->layout.panel_width),
        fmax(1, (double)v->layout.height - v->layout.bar_height - v->layout.strip_height)};
}

void view_lay_out(view *v)
{
    const cwi_ui_rect area = view_picture_area(v);
    view_place_parts(v, &area, view_is_quad(v));
}
