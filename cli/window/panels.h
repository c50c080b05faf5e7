/* Declares what the files of the window share. Panels show a session and ask for its commands. */
#ifndef CLI_WINDOW_PANELS_H
#define CLI_WINDOW_PANELS_H

#include "cli/session/view.h"

#include <time.h>

/* The command (cmd_view.c). */
extern const cli_command cli_view;

/* Thumbnails of the presets of the transfer function: how many are drawn. */
enum { VIEW_THUMBS = 40 };

/* Times of view_loop.c and cmd_view.c, in ui seconds but for start. */
typedef struct view_clock {
    double start;          /* of the program, in cli_seconds() */
    bool is_printed;       /* the time to the first picture has been printed */
    double progress_shown; /* the last time */
    double next_step;      /* of a series that plays */
} view_clock;

/* A drag on a picture, by view_mouse.c. */
typedef struct view_drag {
    int drag, part;
    double from[2]; /* what it is measured from */
} view_drag;

/* A drag in the curve editor. */
typedef struct view_curve_drag {
    int drag, point;
    bool drags_color;
    size_t color; /* the one that was chosen */
    double at[2], color_at;
} view_curve_drag;

/* A file or folder to open. */
typedef struct view_entry {
    char *name;
    bool is_folder, is_known; /* its extension is that of a format */
    double bytes;
    time_t time; /* of its last change */
} view_entry;

/* The folder that the file browser shows. */
typedef struct view_browser {
    char folder[VIEW_PATH]; /* "": not looked at yet */
    view_entry *entries;
    size_t count;
    char typed[VIEW_PATH], filter[256], chosen[VIEW_PATH]; /* chosen: a name */
    bool shows_all;
} view_browser;

/* Fields of the dialogs that save. */
typedef struct view_saving {
    char mesh_name[VIEW_PATH], picture_name[VIEW_PATH];
    size_t part; /* index of its choice */
    double picture_size[2];
    size_t layout, background;
} view_saving;

/* Fields of the section of pieces. */
typedef struct view_cutting {
    char planes[256], plate[64];
    double pegs;
    bool dowels;
} view_cutting;

/* Keeps what each file of the window needs from frame to frame. */
struct view_widgets {
    view_clock clock;
    view_drag mouse;
    view_curve_drag curve;
    view_browser browser;
    view_saving saving;
    view_cutting cutting;
};

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

/* mode_list.c */
enum { VIEW_MODE_NAMES = CW_MODE_COUNT + 8 };
/* Lists the modes that draw what is open, by groups with headings: how many names. */
size_t view_list_modes(const view *v, bool with_mesh, const char **names);

/* side_panel.c */
void view_show_side(view *v);

/* Sections of the side panel: curve_editor.c, the curve and its points in numbers;
 * compare_panel.c; measure_panel.c; pieces_panel.c; views_panel.c */
void view_curve(view *v);
void view_show_point(view *v);
void view_show_compare(view *v);
void view_show_measure_section(view *v);
void view_show_pieces_section(view *v);
void view_show_views(view *v);

/* compare_panel.c: badges on the halves of a comparison. */
void view_show_badges(view *v);

/* views_panel.c: the gallery of presets. */
void view_show_gallery(view *v);
void view_draw_gallery(view *v);        /* one thumbnail more, if it is shown */
bool view_gallery_waits(const view *v); /* for thumbnails */

#endif
