/* Declares what the files of view's commands share: checks, and rows of tables. */
#ifndef CLI_SESSION_VERBS_H
#define CLI_SESSION_VERBS_H

#include "cli/session/view.h"

/* Parses words as numbers. Returns CW_ERR_ARGUMENT, naming the verb and the word */
CW_NODISCARD cw_status view_take(const char *verb, char **args, int count, double *numbers,
                                 cw_error *err);

/* Return CW_ERR_ARGUMENT when nothing is open, or no volume that can be drawn. The last one also
 * places a camera. */
CW_NODISCARD cw_status view_need_open(const view *v, cw_error *err);
CW_NODISCARD cw_status view_need_volume(const view *v, cw_error *err);
CW_NODISCARD cw_status view_need_camera(view *v, cw_error *err);

/* Rows of tables of commands. EDIT: undo reverts the command. */
typedef struct view_verbs {
    const view_verb *rows;
    size_t count;
} view_verbs;
extern const view_verbs view_files_verbs, view_scene_verbs, view_camera_verbs, view_curve_verbs,
    view_save_verbs, view_script_verbs, view_measure_verbs, view_window_verbs,
    view_pieces_verbs;

#define VERB(name, takes, about, min_count, max_count, run)                                    \
    {                                                                                          \
        name, takes, about, min_count, max_count, false, run                                   \
    }
#define EDIT(name, takes, about, min_count, max_count, run)                                    \
    {                                                                                          \
        name, takes, about, min_count, max_count, true, run                                    \
    }

#endif
