/* Declares what the files of the window share. Panels show a session and ask for its commands. */
#ifndef CLI_WINDOW_PANELS_H
#define CLI_WINDOW_PANELS_H

#include "cli/session/view.h"

/* view_loop.c */
/* Shows one frame: takes input, runs what it asks for, and draws what is stale. */
CW_NODISCARD cw_status view_show_frame(view *v, double wait_s, cw_error *err);
CW_NODISCARD cw_status view_loop(view *v, cw_error *err);

/* view_mouse.c */
void view_mouse(view *v, const cwi_ui_input *in);
void view_show_parts(view *v, const cwi_ui_input *in);

/* panels.c: all panels and menus of a frame. */
void view_panels(view *v);

/* start_page.c */
void view_show_start(view *v);
void view_show_recent(view *v); /* an item for each recent file, in the panel at hand */

/* file_browser.c */
void view_browse(view *v);
void view_close_browser(view *v);

/* save_panels.c: dialogs that save a mesh or a picture. */
void view_show_save_mesh(view *v);
void view_show_save_picture(view *v);

/* side_panel.c */
enum { VIEW_MODE_NAMES = CW_MODE_COUNT + 8 };
/* Lists the modes that draw what is open, by groups with headings: how many names. */
size_t view_list_modes(const view *v, bool with_mesh, const char **names);
void view_show_side(view *v);

/* Sections of the side panel: curve_editor.c, the curve and its points in numbers;
 * compare_panel.c; measure_panel.c; views_panel.c */
void view_curve(view *v);
void view_show_point(view *v);
void view_show_compare(view *v);
void view_show_measure_section(view *v);
void view_show_views(view *v);

/* compare_panel.c: badges on the halves of a comparison. */
void view_show_badges(view *v);

/* views_panel.c: the gallery of presets. */
void view_show_gallery(view *v);
void view_draw_gallery(view *v);        /* one thumbnail more, if it is shown */
bool view_gallery_waits(const view *v); /* for thumbnails */

#endif
