/* Types and functions that the files of the window module share. A frame's way: the screen
 * (ui_glfw_window.c) puts input from outside into the queue, as feed() does. ui_events.c takes
 * a frame's share of it. ui_imgui.cpp shows that to Dear ImGui, whose widgets are
 * ui_widgets.cpp. ui_framebuffer.c has the framebuffer that they draw into. */
#ifndef VIEWER_WINDOW_UI_INTERNAL_H
#define VIEWER_WINDOW_UI_INTERNAL_H

#include "viewer/window/ui.h"

#include "core/base/memory.h"
#include "core/base/status.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { CWI_UI_GONE = 1 << 16 }; /* a panel that ImGui did not begin, beside its flags */
enum { CWI_UI_NAME_SIZE = 64, CWI_UI_DEPTH = 8, CWI_UI_LARGEST = 16384 };

/* Events that wait to be taken; text is the queue's. */
typedef struct cwi_ui_queue {
    cwi_ui_event *items;
    double *times; /* when they came, in seconds */
    size_t first, count, capacity;
} cwi_ui_queue;

/* The rectangle of a widget. */
typedef struct cwi_ui_widget_rect {
    char panel[CWI_UI_NAME_SIZE], label[CWI_UI_NAME_SIZE];
    cwi_ui_rect rect;
} cwi_ui_widget_rect;

typedef struct cwi_ui_widget_rects {
    cwi_ui_widget_rect *items;
    size_t count, capacity;
} cwi_ui_widget_rects;

/* A framebuffer to draw into: a window's own framebuffer does not keep what it showed. */
typedef struct cwi_ui_target {
    unsigned framebuffer, color;
    size_t width, height; /* 0: none yet */
} cwi_ui_target;

typedef struct cwi_ui_picture {
    unsigned texture; /* 0: none */
    size_t width, height;
} cwi_ui_picture;

typedef struct cwi_ui_screen cwi_ui_screen; /* a window, or what stands for one */
struct ImGuiContext;

struct cwi_ui {
    cwi_ui_screen *screen;
    cwi_ui_target target;
    cwi_ui_picture pictures[CWI_UI_SLOTS];
    struct ImGuiContext *imgui;
    double scale;
    char name[256];

    cwi_ui_queue queue;
    cwi_ui_input input;
    char **drops;     /* input.drops */
    size_t drop_room; /* of which */
    int key;          /* that went down in this frame: cwi_ui_key_number(); 0: none */
    unsigned key_modifiers;
    unsigned held;       /* modifiers */
    bool has_mouse;      /* it was somewhere before */
    int settle;          /* frames that do not wait: layouts follow input by a frame or two */
    double wake;         /* a frame is wanted after this many seconds; 0: only by input */
    double before, time; /* of the frame before and of this one, in seconds */
    struct {
        double time, x, y;
    } press[CWI_UI_BUTTONS]; /* the last; time 0: none that a second one could follow */

    cwi_ui_widget_rects now, last; /* of this frame and of the one before */
    char panel[CWI_UI_DEPTH][CWI_UI_NAME_SIZE];
    unsigned panel_flags[CWI_UI_DEPTH];
    bool in_section[CWI_UI_DEPTH];
    int depth;     /* of panel[] */
    bool has_bar;  /* bar_begin() opened one */
    bool is_ended; /* a change of the widget before has come to its end */
    int cursor;
    cwi_ui_theme theme;
    bool by_keyboard; /* keys walk through the widgets of a panel: */
    char walked[CWI_UI_NAME_SIZE];
    bool begins_walk; /* the next frame asks for its first widget */
};

/* Keys (ui_keys.c). A number below 512: of ASCII what it is, of named keys 256 and more; other
 * characters have 1. 0: no key has this name. Of "Ctrl+S" too; *modifiers may be NULL. */
int cwi_ui_key_number(const char *name, unsigned *modifiers);
/* "Ctrl+", "Alt+", "Shift+" and the key. */
void cwi_ui_key_name(char name[CWI_UI_KEY_SIZE], unsigned modifiers, const char *key);

/* The queue (ui_queue.c, ui_events.c) */
CW_NODISCARD cw_status cwi_ui_feed(cwi_ui *ui, const cwi_ui_event *event, cw_error *err);
/* Queues a checked event, as feed(); an event that does not fit into memory is lost. A key that
 * repeats is lost while it still waits to be taken: frames may be slower than fingers. */
bool cwi_ui_queue_put(cwi_ui *ui, const cwi_ui_event *event, double seconds, bool repeats);
void cwi_ui_queue_take(cwi_ui *ui); /* a frame's share, into ui->input and Dear ImGui */
void cwi_ui_queue_free(cwi_ui *ui);

/* The window, or what stands for one (ui_glfw_window.c) */
CW_NODISCARD cw_status cwi_ui_screen_open(cwi_ui *ui, const cwi_ui_desc *desc, cw_error *err);
void cwi_ui_screen_close(cwi_ui *ui);
bool cwi_ui_screen_enter(cwi_ui *ui); /* its context is current until leave() */
void cwi_ui_screen_leave(cwi_ui *ui);
double cwi_ui_screen_seconds(const cwi_ui *ui);
double cwi_ui_screen_frame_time(const cwi_ui *ui); /* as the frame at hand sees it */
void cwi_ui_screen_size(const cwi_ui *ui, size_t size[2]);
void cwi_ui_screen_resize(cwi_ui *ui, size_t width, size_t height);
void cwi_ui_screen_wait(cwi_ui *ui, double seconds); /* for input, 0: only asks for it */
void cwi_ui_screen_show(cwi_ui *ui);                 /* what the target has */
void cwi_ui_screen_title(cwi_ui *ui, const char *title);
void cwi_ui_screen_copy(cwi_ui *ui, const char *text);
const char *cwi_ui_screen_paste(cwi_ui *ui);
/* The four of set_cursor(), 4 for text, 5 up-down */
void cwi_ui_screen_cursor(cwi_ui *ui, int shape);

/* GL (ui_framebuffer.c); all within enter() and leave() */
void cwi_ui_target_begin(cwi_ui *ui); /* of the size that the input says; cleared */
void cwi_ui_target_free(cwi_ui *ui);  /* and the pictures */
CW_NODISCARD cw_status cwi_ui_target_check(cw_error *err);
CW_NODISCARD cw_status cwi_ui_target_grab(cwi_ui *ui, cw_image *image, cw_error *err);
CW_NODISCARD cw_status cwi_ui_target_keep(cwi_ui *ui, int slot, const cw_image *image,
                                          cw_error *err);

/* Places (ui_widget_rects.c). Labels end before ##. */
void cwi_ui_label(char out[CWI_UI_NAME_SIZE], const char *label);
void cwi_ui_widget_rects_add(cwi_ui *ui, const char *label, const cwi_ui_rect *rect);
void cwi_ui_widget_rects_turn(cwi_ui *ui); /* this frame's rectangles become the last frame's */
bool cwi_ui_widget_rects_find(const cwi_ui *ui, const char *label, cwi_ui_rect *rect);
void cwi_ui_panel_enter(cwi_ui *ui, const char *title, unsigned flags); /* labels are in it */
void cwi_ui_panel_leave(cwi_ui *ui);
int cwi_ui_panel_at(const cwi_ui *ui); /* index of the one at hand; -1: none */

/* Dear ImGui (ui_imgui.cpp) */
CW_NODISCARD cw_status cwi_ui_imgui_open(cwi_ui *ui,
                                         cw_error *err); /* within enter() and leave() */
void cwi_ui_imgui_close(cwi_ui *ui);                     /* within enter() and leave(), too */
void cwi_ui_imgui_choose(cwi_ui *ui);                    /* of several windows, this one */
void cwi_ui_imgui_write(const char *text);
void cwi_ui_imgui_begin(cwi_ui *ui);
void cwi_ui_imgui_layout(cwi_ui *ui); /* ends widgets; the drawing is then known */
void cwi_ui_imgui_draw(void);         /* into the framebuffer that is bound */
int cwi_ui_imgui_cursor(const cwi_ui *ui);
void cwi_ui_imgui_theme(cwi_ui *ui, cwi_ui_theme theme);
void cwi_ui_imgui_focus(cwi_ui *ui, const char *panel);
bool cwi_ui_imgui_focused(const cwi_ui *ui);

/* A frame (ui_frame.c) */
CW_NODISCARD cw_status cwi_ui_open(const cwi_ui_desc *desc, cwi_ui **ui, cw_error *err);
void cwi_ui_close(cwi_ui *ui);
bool cwi_ui_pending(cwi_ui *ui);
const cwi_ui_input *cwi_ui_begin(cwi_ui *ui, double wait_s);
CW_NODISCARD cw_status cwi_ui_end(cwi_ui *ui, cw_error *err);
CW_NODISCARD cw_status cwi_ui_grab(cwi_ui *ui, cw_image *image, cw_error *err);
CW_NODISCARD cw_status cwi_ui_keep(cwi_ui *ui, int slot, const cw_image *image, cw_error *err);
const char *cwi_ui_name(const cwi_ui *ui);
double cwi_ui_scale(const cwi_ui *ui);
void cwi_ui_set_cursor(cwi_ui *ui, int shape);

#ifdef __cplusplus
}
#endif

#endif
