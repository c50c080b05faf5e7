/* Saves pictures of the session: in the layout and size of the window, or in others. */
#include "cli/session/view.h"

#include "core/base/status.h"
#include <cubewright/overlay.h>

#include <string.h>

/* Draws all parts that are shown and puts them together. */
static cw_status draw_sheet(view *v, size_t width, size_t height, cw_image *sheet,
                            cw_error *err)
{
    static const uint8_t gap[4] = {40, 44, 52, 255};
    cw_status st = cw_image_alloc(sheet, width, height, err);
    for (size_t n = 0; n < width * height && st == CW_OK; n++)
        memcpy(sheet->pixels + 4 * n, gap, sizeof gap);
    for (int p = 0; p < VIEW_PARTS && st == CW_OK; p++) {
        const view_part *part = &v->picture.parts[p];
        cw_image image = {0};
        if (!part->is_shown)
            continue;
        st = view_draw_part(v, p, VIEW_FINAL, false, &image, err);
        if (st == CW_OK)
            cw_image_place(sheet, &image, (ptrdiff_t)part->rect.x, (ptrdiff_t)part->rect.y);
        cw_image_free(&image);
    }
    return st;
}

cw_status view_write_picture(view *v, const view_sheet *sheet, const char *path, cw_error *err)
{
    cw_image picture = {0};
    view_part before[VIEW_PARTS];
    if (!v->document.path)
        return cwi_fail(err, CW_ERR_ARGUMENT, "no file is open to draw");
    const cwi_ui_rect area = view_picture_area(v);
    const size_t width = sheet->width ? sheet->width : (size_t)area.width;
    const size_t height = sheet->height ? sheet->height : (size_t)area.height;
    const bool is_quad = sheet->layout == VIEW_LAYOUT_SHOWN ? view_is_quad(v)
                                                            : sheet->layout == VIEW_LAYOUT_QUAD;
    if (is_quad && !(v->document.has_volume && view_fits_mode(v, CW_MODE_SLICES)))
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "the layout quad shows slices of a volume on an even grid, and this is "
                        "none");
    if (is_quad && (width < 4 || height < 4))
        return cwi_fail(err, CW_ERR_ARGUMENT, "the layout quad needs 4 x 4 pixels");
    memcpy(before, v->picture.parts, sizeof before);
    view_place_parts(v, &(cwi_ui_rect){0, 0, (double)width, (double)height}, is_quad);
    v->picture.is_saving = true;
    cw_status st = draw_sheet(v, width, height, &picture, err);
    v->picture.is_saving = false;
    for (int p = 0; p < VIEW_PARTS; p++) { /* pictures of the window are those it had */
        before[p].level =
            v->picture.parts[p].level == VIEW_STALE ? VIEW_STALE : before[p].level;
        v->picture.parts[p] = before[p];
    }
    if (st == CW_OK)
        st = cw_image_write(path, &picture, err);
    cw_image_free(&picture);
    return st;
}
