/* The panel's section of views that were kept and films of them, and the gallery of presets. */
#include "cli/window/panels.h"

#include <cubewright/transfer.h>

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { COLUMNS = 3, THUMB_WIDTH = 112, THUMB_HEIGHT = 84, FIRST_SLOT = VIEW_PARTS };

static void show_bookmark(view *v, const view_bookmark *b)
{
    char label[64];
    snprintf(label, sizeof label, "%s##bookmark", b->name);
    if (v->ui->button(v->window, label) && !strchr(b->name, '\''))
        view_ask(v, "go-to '%s'", b->name);
    v->ui->tip(v->window, *b->look ? b->look : "The camera alone");
    v->ui->same_line(v->window);
    snprintf(label, sizeof label, "Forget##%s", b->name);
    if (v->ui->button(v->window, label) && !strchr(b->name, '\''))
        view_ask(v, "remove-bookmark '%s'", b->name);
}

void view_show_views(view *v)
{
    double seconds = v->film.seconds;
    if (!v->ui->section(v->window, "Views and film", v->film.bookmark_count > 0))
        return;
    if (v->ui->button(v->window, "Keep this view"))
        view_ask(v, "bookmark");
    v->ui->tip(v->window, "Keep the camera, the isovalue, the cut and the opacity");
    for (size_t n = 0; n < v->film.bookmark_count; n++)
        show_bookmark(v, &v->film.bookmarks[n]);
    if (v->film.bookmark_count < 2)
        return;
    if (v->ui->log_slider(v->window, "From view to view", &seconds, 0.1, 60, "%.1f s"))
        view_ask(v, "film-seconds %.3g", seconds);
    if (v->ui->button(v->window, v->film.preview ? "Stop" : "Play"))
        view_ask(v, "play-film");
    v->ui->same_line(v->window);
    if (v->ui->button(v->window, "Save pictures"))
        view_ask(v, "film bookmarks 'film-{frame:04d}.png' 25");
    v->ui->tip(v->window, "Save the film as film-0000.png and so on, 25 pictures a second");
    v->ui->same_line(v->window);
    if (v->ui->button(v->window, "Save script"))
        view_ask(v, "save-film film.txt");
    v->ui->tip(v->window, "Write film.txt, which can be edited: view FILE --film film.txt");
}

/* --- the gallery -------------------------------------------------------------------------- */

/* Draws one thumbnail a frame, so that the window stays quick. */
static void draw_next(view *v)
{
    size_t *drawn = &v->picture.thumbs;
    const char *name = cw_transfer_preset_name(*drawn);
    cw_image image = {0};
    if (!name || *drawn >= VIEW_THUMBS)
        return;
    if (view_draw_preset(v, name, THUMB_WIDTH, THUMB_HEIGHT, &image, NULL) == CW_OK)
        (void)!v->ui->keep(v->window, FIRST_SLOT + (int)*drawn, &image, NULL);
    cw_image_free(&image);
    ++*drawn;
}

void view_draw_gallery(view *v)
{
    if (v->shown.gallery && v->document.has_volume)
        draw_next(v);
}

bool view_gallery_waits(const view *v)
{
    return v->shown.gallery && v->document.has_volume && v->picture.thumbs < VIEW_THUMBS &&
           cw_transfer_preset_name(v->picture.thumbs);
}

static void show_thumb(view *v, size_t n, const char *name)
{
    static const cwi_ui_color frame = {0.5f, 0.76f, 1, 1}, white = {1, 1, 1, 1},
                              plate = {0.05f, 0.06f, 0.08f, 0.75f};
    const double scale = v->ui->scale(v->window);
    const char *now = v->state.args.scene.transfer;
    cwi_ui_area a;
    double size[2];
    v->ui->area(v->window, name, THUMB_WIDTH * scale, THUMB_HEIGHT * scale, &a);
    v->ui->tip(v->window, cw_transfer_preset_about(n));
    if (n < v->picture.thumbs)
        v->ui->show(v->window, FIRST_SLOT + (int)n, &a.rect);
    v->ui->text_size(v->window, name, size);
    const cwi_ui_rect under = {a.rect.x, a.rect.y + a.rect.height - size[1] - 4 * scale,
                               size[0] + 8 * scale, size[1] + 4 * scale};
    v->ui->box(v->window, CWI_UI_PANEL, &under, plate, true);
    v->ui->write(v->window, CWI_UI_PANEL, under.x + 4 * scale, under.y + 2 * scale, white,
                 name);
    if (a.over || (now && !v->state.is_edited && strcmp(now, name) == 0))
        v->ui->box(v->window, CWI_UI_PANEL, &a.rect, frame, false);
    if (a.lifted && a.over)
        view_ask(v, "tf %s; mode %s", name, cw_mode_name(view_preset_mode(v, name)));
}

void view_show_gallery(view *v)
{
    const double scale = v->ui->scale(v->window);
    const double width = COLUMNS * (THUMB_WIDTH + 8) * scale + 40 * scale;
    const cwi_ui_rect rect = {
        60 * scale, 60 * scale, width,
        fmin(560 * scale, fmax(160, (double)v->layout.height - 100 * scale))};
    if (v->ui->panel_begin(v->window, "Presets", &rect, 0, &v->shown.gallery)) {
        const char *name;
        for (size_t n = 0; n < VIEW_THUMBS && (name = cw_transfer_preset_name(n)); n++) {
            if (n % COLUMNS)
                v->ui->same_line(v->window);
            show_thumb(v, n, name);
        }
    }
    v->ui->panel_end(v->window);
}
