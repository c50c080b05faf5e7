/* Remembers states and cameras of a session, and undoes changes. */
#include "cli/session/view.h"

#include <stdio.h>
#include <string.h>

/* Changes of one kind in one go, such as a slider's, are undone in one go; so are all of a
 * drag. */
void view_remember(view *v, const char *verb)
{
    view_history *h = &v->history;
    const bool goes_on = h->count && h->gesture == v->input.gesture &&
                         (strcmp(h->verb, verb) == 0 || (h->is_drag && v->input.is_dragging));
    if (!goes_on && h->count) {
        if (h->at + 1 == VIEW_UNDO)
            memmove(h->states, h->states + 1, --h->at * sizeof *h->states);
        h->at++;
    }
    h->states[h->at] = v->state;
    h->count = h->at + 1;
    h->gesture = v->input.gesture;
    h->is_drag = v->input.is_dragging;
    snprintf(h->verb, sizeof h->verb, "%s", verb);
}

/* It is not moving about that is undone: the camera, the cross-hair, the step and such stay. */
bool view_undo(view *v, int by)
{
    view_history *h = &v->history;
    if (by < 0 ? h->at == 0 : h->at + 1 >= h->count)
        return false;
    h->at = by < 0 ? h->at - 1 : h->at + 1;
    view_state now = v->state;
    v->state = h->states[h->at];
    v->state.is_placed = now.is_placed;
    v->state.camera = now.camera;
    v->state.step = now.step;
    v->state.slice_zoom = now.slice_zoom;
    v->state.left_fraction = now.left_fraction;
    memcpy(v->state.cross, now.cross, sizeof now.cross);
    h->verb[0] = '\0';
    return true;
}

/* Movements of one kind in one go are one view, as for view_remember(). */
void view_note_camera(view *v, const char *verb)
{
    view_cameras *c = &v->cameras;
    if (!v->state.is_placed ||
        (c->count && memcmp(&c->cameras[c->at], &v->state.camera, sizeof(cw_camera)) == 0))
        return;
    const bool goes_on =
        c->count && c->at && c->gesture == v->input.gesture && strcmp(c->verb, verb) == 0;
    if (!goes_on && c->count) {
        if (c->at + 1 == VIEW_UNDO)
            memmove(c->cameras, c->cameras + 1, --c->at * sizeof *c->cameras);
        c->at++;
    }
    c->cameras[c->at] = v->state.camera;
    c->count = c->at + 1;
    c->gesture = v->input.gesture;
    snprintf(c->verb, sizeof c->verb, "%s", verb);
}
