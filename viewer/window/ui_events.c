/* Checks input, and takes each frame's share of it from the queue. */
#include "core/base/memory.h"
#include "viewer/window/ui_internal.h"

#include <math.h>
#include <string.h>

/* A second press within this time and distance is one of a pair. */
static const double DOUBLE_CLICK_S = 0.35, DOUBLE_CLICK_PIXELS = 6;

/* Empties the queue when all of it was taken. */
static void rewind_when_empty(cwi_ui_queue *q)
{
    if (q->first == q->count)
        q->first = q->count = 0;
}

static cw_status check_position(const cwi_ui_event *e, cw_error *err)
{
    if (!isfinite(e->x) || !isfinite(e->y))
        return cwi_fail(err, CW_ERR_ARGUMENT, "an input has a position that is not a number");
    if (e->kind == CWI_UI_RESIZE &&
        !(e->x >= 1 && e->x <= CWI_UI_LARGEST && e->y >= 1 && e->y <= CWI_UI_LARGEST))
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "a window of %g x %g pixels; 1 x 1 to %d x %d was expected", e->x, e->y,
                        CWI_UI_LARGEST, CWI_UI_LARGEST);
    return CW_OK;
}

static cw_status check_text(const cwi_ui_event *e, cw_error *err)
{
    const bool has = e->kind == CWI_UI_KEY || e->kind == CWI_UI_WRITE || e->kind == CWI_UI_DROP;
    if (has && !e->text)
        return cwi_fail(err, CW_ERR_ARGUMENT, "input without the text that it is of");
    if (e->kind != CWI_UI_KEY ||
        (strlen(e->text) < CWI_UI_KEY_SIZE && cwi_ui_key_number(e->text, NULL) > 0))
        return CW_OK;
    return cwi_fail(err, CW_ERR_ARGUMENT,
                    "no key has the name '%.40s'; names are such as A, 1, ?, Space, F1, Left, "
                    "Shift+Left, Ctrl+S",
                    e->text);
}

cw_status cwi_ui_feed(cwi_ui *ui, const cwi_ui_event *event, cw_error *err)
{
    const bool pressed = event->kind == CWI_UI_PRESS || event->kind == CWI_UI_LIFT;
    if ((unsigned)event->kind > CWI_UI_CLOSE)
        return cwi_fail(err, CW_ERR_ARGUMENT, "%d is not a kind of input", (int)event->kind);
    if (pressed && (event->button < 0 || event->button >= CWI_UI_BUTTONS))
        return cwi_fail(err, CW_ERR_ARGUMENT, "a mouse has no button %d; there are 0 to %d",
                        event->button, CWI_UI_BUTTONS - 1);
    cw_status st = check_position(event, err);
    if (st == CW_OK)
        st = check_text(event, err);
    if (st == CW_OK && !cwi_ui_queue_put(ui, event, cwi_ui_screen_seconds(ui), false))
        st = cwi_fail_memory(err);
    return st;
}

/* Events that a frame has taken so far. */
typedef struct taken {
    bool any, moved, button[CWI_UI_BUTTONS], at_place, key, edit, wrote, alone;
} taken;

/* Returns true if an event belongs to the current frame too. Each change must be seen, with its
 * place and in its order. The way to where a button goes down is not a drag, and a dragged
 * thing must reach the place where it is released. A key that is down must come up before it
 * goes down again. */
static bool fits_frame(const cwi_ui *ui, const taken *t, const cwi_ui_event *e, int last_key)
{
    if (t->alone)
        return false;
    switch (e->kind) {
    case CWI_UI_MOVE:
        return !t->at_place || (e->x == ui->input.x && e->y == ui->input.y);
    case CWI_UI_PRESS:
    case CWI_UI_LIFT:
        return !t->moved && !t->button[e->button] && !t->wrote && !t->key;
    case CWI_UI_WHEEL:
        return true;
    case CWI_UI_KEY:
        return !t->key && !t->wrote && !t->at_place &&
               cwi_ui_key_number(e->text, NULL) != last_key;
    case CWI_UI_WRITE:
        return !t->edit && !t->at_place;
    case CWI_UI_RESIZE:
        return !t->any;
    default:
        return true;
    }
}

static void press_button(cwi_ui *ui, int button, double time)
{
    cwi_ui_input *in = &ui->input;
    const double dx = in->x - ui->press[button].x, dy = in->y - ui->press[button].y;
    in->down[button] = in->pressed[button] = true;
    in->twice[button] = ui->press[button].time > 0 &&
                        time - ui->press[button].time <= DOUBLE_CLICK_S &&
                        hypot(dx, dy) <= DOUBLE_CLICK_PIXELS;
    ui->press[button].time = in->twice[button] ? 0 : time;
    ui->press[button].x = in->x;
    ui->press[button].y = in->y;
}

static void move_pointer(cwi_ui *ui, const cwi_ui_event *e)
{
    cwi_ui_input *in = &ui->input;
    if (ui->has_mouse) {
        in->dx += e->x - in->x;
        in->dy += e->y - in->y;
    }
    in->x = e->x;
    in->y = e->y;
    ui->has_mouse = true;
}

static void take_key(cwi_ui *ui, const char *name)
{
    cwi_ui_input *in = &ui->input;
    ui->key = cwi_ui_key_number(name, &ui->key_modifiers);
    strncpy(in->keys[in->key_count++], name, CWI_UI_KEY_SIZE - 1);
}

/* Takes over the event's text. */
static void take_drop(cwi_ui *ui, cwi_ui_event *e)
{
    cwi_ui_input *in = &ui->input;
    if (in->drop_count == ui->drop_room) {
        const size_t capacity = 2 * ui->drop_room + 8;
        char **drops = cwi_realloc_array(ui->drops, capacity, sizeof *drops);
        if (!drops)
            return;
        ui->drops = drops;
        ui->drop_room = capacity;
    }
    ui->drops[in->drop_count++] = (char *)e->text;
    in->drops = ui->drops;
    e->text = NULL;
}

static void take_event(cwi_ui *ui, cwi_ui_event *e, double time)
{
    cwi_ui_input *in = &ui->input;
    if (e->kind <= CWI_UI_WHEEL)
        ui->held = e->modifiers;
    switch (e->kind) {
    case CWI_UI_MOVE:
        move_pointer(ui, e);
        break;
    case CWI_UI_PRESS:
        press_button(ui, e->button, time);
        break;
    case CWI_UI_LIFT:
        in->down[e->button] = false;
        in->lifted[e->button] = true;
        break;
    case CWI_UI_WHEEL:
        in->wheel += e->y;
        break;
    case CWI_UI_KEY:
        take_key(ui, e->text);
        break;
    case CWI_UI_WRITE:
        cwi_ui_imgui_write(e->text);
        break;
    case CWI_UI_DROP:
        take_drop(ui, e);
        break;
    case CWI_UI_RESIZE:
        cwi_ui_screen_resize(ui, (size_t)e->x, (size_t)e->y);
        break;
    case CWI_UI_CLOSE:
        in->close = true;
        break;
    }
}

/* Returns true for a key that edits text: it comes before text written after it. A key that
 * writes does not. */
static bool edits_text(const cwi_ui_event *e)
{
    unsigned modifiers;
    const int number = cwi_ui_key_number(e->text, &modifiers);
    return number >= 256 || (modifiers & (CWI_UI_CTRL | CWI_UI_ALT)) != 0;
}

static void note_event(taken *t, const cwi_ui_event *e)
{
    const bool change = e->kind == CWI_UI_PRESS || e->kind == CWI_UI_LIFT;
    t->any = true;
    t->moved |= e->kind == CWI_UI_MOVE;
    if (change)
        t->button[e->button] = true;
    t->at_place |= change || e->kind == CWI_UI_WHEEL;
    t->key |= e->kind == CWI_UI_KEY;
    t->edit |= e->kind == CWI_UI_KEY && edits_text(e);
    t->wrote |= e->kind == CWI_UI_WRITE;
    t->alone |= e->kind == CWI_UI_RESIZE;
}

static void forget_frame(cwi_ui *ui)
{
    cwi_ui_input *in = &ui->input;
    for (size_t n = 0; n < in->drop_count; n++)
        cwi_free(ui->drops[n]);
    for (int b = 0; b < CWI_UI_BUTTONS; b++)
        in->pressed[b] = in->lifted[b] = in->twice[b] = false;
    memset(in->keys, 0, sizeof in->keys);
    in->drop_count = in->key_count = 0;
    in->dx = in->dy = in->wheel = 0;
    in->close = false;
    ui->key = 0;
    ui->key_modifiers = 0;
}

void cwi_ui_queue_take(cwi_ui *ui)
{
    cwi_ui_queue *q = &ui->queue;
    const int last_key = ui->key ? ui->key : -1;
    taken t = {0};
    forget_frame(ui);
    while (q->first < q->count && fits_frame(ui, &t, &q->items[q->first], last_key)) {
        cwi_ui_event *e = &q->items[q->first];
        note_event(&t, e);
        take_event(ui, e, q->times[q->first++]);
        cwi_free((char *)e->text);
    }
    rewind_when_empty(q);
    ui->input.modifiers = ui->held | ui->key_modifiers;
    if (t.any)
        ui->settle = 3;
}

void cwi_ui_queue_free(cwi_ui *ui)
{
    forget_frame(ui);
    for (size_t n = ui->queue.first; n < ui->queue.count; n++)
        cwi_free((char *)ui->queue.items[n].text);
    cwi_free(ui->queue.items);
    cwi_free(ui->queue.times);
    cwi_free(ui->drops);
}
