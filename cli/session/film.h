/* A film of the session: key frames, and the session at a moment between them. */
#ifndef CLI_SESSION_FILM_H
#define CLI_SESSION_FILM_H

#include "cli/session/view.h"

enum { VIEW_KEY_FRAMES = 1000 };

typedef struct view_key_frame {
    double time;
    view_state state;
} view_key_frame;

typedef struct view_key_frames {
    view_key_frame *keys;
    double *times; /* those of the keys */
    size_t count;
} view_key_frames;

/* A film that plays in the window. */
struct view_preview {
    view_key_frames film;
    view_state before;
    double start; /* in ui seconds */
};

/* Sets the session to a moment. Settings without numbers are those of the key before. */
CW_NODISCARD cw_status view_show_moment(view *v, const view_key_frames *film, double time,
                                        cw_error *err);

/* Brings the session back to what it was before a film. */
CW_NODISCARD cw_status view_restore(view *v, const view_state *before, cw_error *err);

void view_free_key_frames(view_key_frames *film);

#endif
