/* The window and its widgets: GLFW and Dear ImGui behind C functions. A module, loaded when
 * first needed; without a display the same window is a hidden framebuffer.
 *
 * One thread. A frame is begin(), widgets and drawing, end(). Lengths and places are pixels of
 * the framebuffer, from its upper left corner, y down. All text is UTF-8. There may be many
 * hidden windows, but only one visible window. */
#ifndef VIEWER_WINDOW_UI_H
#define VIEWER_WINDOW_UI_H

#include <cubewright/picture.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct cwi_ui cwi_ui;

typedef struct cwi_ui_desc {
    const char *title;
    size_t width, height; /* of the framebuffer */
    bool hidden;          /* no window: a framebuffer by EGL, fed by feed() alone */
    double scale;         /* of letters and widgets; 0: the monitor's (hidden: 1) */
} cwi_ui_desc;

/* Input from outside, as the window has it and as feed() takes it. */
typedef enum cwi_ui_kind {
    CWI_UI_MOVE,   /* the mouse to x, y */
    CWI_UI_PRESS,  /* button */
    CWI_UI_LIFT,   /* button */
    CWI_UI_WHEEL,  /* y lines up */
    CWI_UI_KEY,    /* text: a key that goes down and up: "H", "Ctrl+S", "Shift+Left" */
    CWI_UI_WRITE,  /* text: characters typed */
    CWI_UI_DROP,   /* text: a path dropped on the window */
    CWI_UI_RESIZE, /* to x, y pixels */
    CWI_UI_CLOSE
} cwi_ui_kind;

enum { CWI_UI_LEFT, CWI_UI_RIGHT, CWI_UI_MIDDLE, CWI_UI_BUTTONS };
enum { CWI_UI_SHIFT = 1, CWI_UI_CTRL = 2, CWI_UI_ALT = 4 };
enum { CWI_UI_KEY_SIZE = 32, CWI_UI_KEYS = 8, CWI_UI_SLOTS = 48 };

typedef struct cwi_ui_event {
    cwi_ui_kind kind;
    double x, y;
    int button;
    unsigned modifiers; /* MOVE, PRESS, LIFT, WHEEL: keys held meanwhile */
    const char *text;   /* copied by feed() */
} cwi_ui_event;

/* Input of a frame. Names of keys: letters and digits as "A" and "1"; "Space", "Enter", "Tab",
 * "Escape", "Backspace", "Delete", "Insert", "Home", "End", "PageUp", "PageDown", "Left",
 * "Right", "Up", "Down", "F1" to "F12", and characters such as "[", "?" and "+" as they are
 * typed; before them "Ctrl+", "Alt+", "Shift+" in that order, Shift not before characters that
 * need it anyway. (With Ctrl or Alt nothing is typed: "Ctrl+Shift+=".) */
typedef struct cwi_ui_input {
    size_t width, height; /* of the framebuffer */
    double x, y;          /* the mouse; -1, -1: outside */
    double dx, dy;        /* since the frame before; none in the frame of a press */
    double wheel;         /* lines up */
    unsigned modifiers;
    bool down[CWI_UI_BUTTONS];                            /* held now */
    bool pressed[CWI_UI_BUTTONS], lifted[CWI_UI_BUTTONS]; /* in this frame */
    bool twice[CWI_UI_BUTTONS]; /* pressed, the second time in a row */
    bool over_widget;           /* the mouse is on a panel, or an action that began there
                                   continues */
    bool typing;                /* keys go into a widget; keys[] has none */
    size_t key_count;
    char keys[CWI_UI_KEYS][CWI_UI_KEY_SIZE]; /* that went down */
    size_t drop_count;
    char *const *drops; /* paths; until the next begin() */
    bool close;         /* somebody wants the window shut */
} cwi_ui_input;

/* A place on the window. */
typedef struct cwi_ui_rect {
    double x, y, width, height;
} cwi_ui_rect;

/* An area for a custom widget, and the mouse's actions on it. */
typedef struct cwi_ui_area {
    cwi_ui_rect rect;
    bool over;                          /* the mouse is on it */
    bool is_down;                       /* left button went down on it and still is */
    bool pressed, lifted, twice, right; /* in this frame; right: a right click */
    double x, y;                        /* the mouse, from rect's corner */
} cwi_ui_area;

typedef enum cwi_ui_layer { CWI_UI_BEHIND, CWI_UI_PANEL, CWI_UI_FRONT } cwi_ui_layer;

typedef enum cwi_ui_panel {
    CWI_UI_FIXED = 1, /* cannot be moved, sized or folded */
    CWI_UI_BARE = 2,  /* no title bar, as large as its content, hardly any background */
    CWI_UI_MODAL = 4, /* in the middle, and nothing else can be used */
    CWI_UI_DOCKED =
        8, /* at the right side of rect always; its left side can be dragged: see find() */
    CWI_UI_STRIP = 16 /* no title bar, at the lower side of rect, as high as its content */
} cwi_ui_panel;

typedef enum cwi_ui_theme { CWI_UI_DARK, CWI_UI_LIGHT } cwi_ui_theme;

/* A docked panel is at least CWI_UI_DOCKED_MIN pixels of a scale of 1 wide, and at most this part
 * of the window, which comes first. */
#define CWI_UI_DOCKED_MIN 180
#define CWI_UI_DOCKED_MAX 0.6

/* Begins a name of choice() that is a heading, not to be chosen. */
#define CWI_UI_HEADING "\n"

/* sRGB and opacity, 0 to 1 */
typedef float cwi_ui_color[4];

typedef struct cwi_ui_functions {
    /* Opens a window. Free with close().
     * Returns CW_ERR_UNSUPPORTED  no display, no OpenGL 3.3 (with what there is), no library:
     *                             the message says what to install or to set */
    cw_status (*open)(const cwi_ui_desc *desc, cwi_ui **ui, cw_error *err);
    void (*close)(cwi_ui *ui);
    const char *(*name)(const cwi_ui *ui); /* "OpenGL 4.5, llvmpipe ..." */
    double (*scale)(const cwi_ui *ui);     /* 1: letters of 13 pixels */
    double (*seconds)(const cwi_ui *ui);   /* since open() */

    /* Returns true if input waits that begin() would take; asks the system for it. Long work
     * calls this, and stops when there is some. */
    bool (*pending)(cwi_ui *ui);
    /* Queues input as if it came from outside. CW_ERR_ARGUMENT for a key of an unknown name */
    cw_status (*feed)(cwi_ui *ui, const cwi_ui_event *event, cw_error *err);

    /* Waits for input up to wait_s seconds, takes it, and starts a frame. At most one change of
     * each button and one key are taken, the rest by the next frames, so that nothing is lost;
     * moves have frames of their own beside presses and lifts. It returns at once where more
     * frames are needed to lay out what changed, and in time for tips and a caret
     * that blinks. */
    const cwi_ui_input *(*begin)(cwi_ui *ui, double wait_s);
    /* Shows the frame. CW_ERR_BACKEND: GL's error, or its context was lost */
    cw_status (*end)(cwi_ui *ui, cw_error *err);
    /* Copies the picture that the last frame showed. */
    cw_status (*grab)(cwi_ui *ui, cw_image *image, cw_error *err);

    void (*set_title)(cwi_ui *ui, const char *title);
    void (*set_clipboard)(cwi_ui *ui, const char *text);
    void (*set_cursor)(cwi_ui *ui, int shape); /* 0 arrow, 1 cross, 2 hand, 3 left-right */
    void (*set_theme)(cwi_ui *ui, cwi_ui_theme theme); /* of panels; dark at first */
    /* Lets keys walk through the widgets of a panel, or of the bar (""): arrows go from one to
     * the next, Space or Enter uses it, and Escape or F6 ends it. The widget at hand has a frame.
     * Meanwhile keys[] has none. NULL ends it. */
    void (*focus)(cwi_ui *ui, const char *panel);
    bool (*focused)(const cwi_ui *ui);

    /* Pictures, kept in slots below CWI_UI_SLOTS until replaced (NULL: dropped), drawn stretched: in the
     * panel at hand, outside of panels behind them all. */
    cw_status (*keep)(cwi_ui *ui, int slot, const cw_image *image, cw_error *err);
    void (*show)(cwi_ui *ui, int slot, const cwi_ui_rect *where);

    /* Drawing: behind all panels, in the panel at hand, or in front of everything. */
    void (*line)(cwi_ui *ui, cwi_ui_layer layer, double x0, double y0, double x1, double y1,
                 const cwi_ui_color color, double thickness);
    void (*box)(cwi_ui *ui, cwi_ui_layer layer, const cwi_ui_rect *rect,
                const cwi_ui_color color, bool filled);
    /* left to right, from one colour to the other */
    void (*blend)(cwi_ui *ui, cwi_ui_layer layer, const cwi_ui_rect *rect,
                  const cwi_ui_color left, const cwi_ui_color right);
    /* count x 2: convex if filled, else a line through them */
    void (*polygon)(cwi_ui *ui, cwi_ui_layer layer, const double *points, size_t count,
                    const cwi_ui_color color, bool filled);
    void (*disc)(cwi_ui *ui, cwi_ui_layer layer, double x, double y, double radius,
                 const cwi_ui_color color, bool filled);
    /* its upper left corner; text_size tells how large it will be */
    void (*write)(cwi_ui *ui, cwi_ui_layer layer, double x, double y, const cwi_ui_color color,
                  const char *text);
    void (*text_size)(cwi_ui *ui, const char *text, double size[2]);
    void (*clip_begin)(cwi_ui *ui, cwi_ui_layer layer, const cwi_ui_rect *rect);
    void (*clip_end)(cwi_ui *ui, cwi_ui_layer layer);

    /* Panels. rect: where it is at first (FIXED, BARE: always); width or height 0: as needed.
     * false: folded or clipped, skip the content; panel_end() in any case. *open: NULL, or
     * cleared by its closing button. */
    bool (*panel_begin)(cwi_ui *ui, const char *title, const cwi_ui_rect *rect, unsigned flags,
                        bool *open);
    void (*panel_end)(cwi_ui *ui);
    bool (*section)(cwi_ui *ui, const char *title, bool open_at_first); /* true: open */

    /* Widgets: true when used. A label's part after ## is not shown but tells widgets apart. */
    void (*text)(cwi_ui *ui, const char *text); /* wrapped */
    bool (*button)(cwi_ui *ui, const char *label);
    bool (*check)(cwi_ui *ui, const char *label, bool *on);
    bool (*choice)(cwi_ui *ui, const char *label, const char *const *names, size_t count,
                   size_t *chosen);
    bool (*slider)(cwi_ui *ui, const char *label, double *value, double low, double high,
                   const char *format); /* such as "%.3g" */
    /* logarithmic: 0 < low < high */
    bool (*log_slider)(cwi_ui *ui, const char *label, double *value, double low, double high,
                       const char *format);
    bool (*number)(cwi_ui *ui, const char *label, double *value, double per_pixel,
                   const char *format);
    bool (*color)(cwi_ui *ui, const char *label, float rgb[3]);
    /* text has each character at once; true: Enter */
    bool (*input)(cwi_ui *ui, const char *label, char *text, size_t size);
    void (*area)(cwi_ui *ui, const char *label, double width, double height,
                 cwi_ui_area *area); /* width 0: all there is */
    void (*progress)(cwi_ui *ui, double fraction, const char *text);
    void (*same_line)(cwi_ui *ui);
    void (*rule)(cwi_ui *ui);
    void (*width)(cwi_ui *ui, double width); /* of the next widget, without its label */
    void (*disable)(cwi_ui *ui, bool on);    /* of widgets from here; in pairs */
    /* of the widget before: */
    void (*tip)(cwi_ui *ui, const char *text);
    bool (*changed)(const cwi_ui *ui); /* a change that went on has come to its end */

    /* The bar on top; its height is returned. */
    double (*bar_begin)(cwi_ui *ui);
    void (*bar_end)(cwi_ui *ui);
    bool (*menu_begin)(cwi_ui *ui, const char *label); /* true: open; then menu_end() */
    void (*menu_end)(cwi_ui *ui);
    bool (*item)(cwi_ui *ui, const char *label, const char *key, bool checked, bool enabled);

    /* Finds the visible part of a widget in the last frame, without the label at its side: by
     * its label (without ##...) or, of several, by "panel/label". Also "panel", "panel/close",
     * "choice/name" and "menu/item" where they are open. false: it was not there. For scripts
     * that use it by name. */
    bool (*find)(const cwi_ui *ui, const char *label, cwi_ui_rect *rect);
} cwi_ui_functions;

#ifdef __cplusplus
}
#endif

#endif
