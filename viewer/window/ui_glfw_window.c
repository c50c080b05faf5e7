/* Opens the window by GLFW or, if it is hidden, a context by EGL alone. */
#define _POSIX_C_SOURCE 200809L /* clock_gettime */
#include "core/base/memory.h"
#include "viewer/gl/gl_context.h"
#include "viewer/window/ui_internal.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

enum { CURSORS = 6 };

struct cwi_ui_screen {
    GLFWwindow *window; /* NULL: hidden */
    GLFWcursor *cursors[CURSORS];
    int cursor;
    bool repeats; /* the key that is down now */
    double start;

    /* hidden */
    cwi_gl_context context;
    size_t width, height;
    char *clipboard;
    size_t frames;
};

static double clock_seconds(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* ---- what comes from outside ---- */

static unsigned held_modifiers(GLFWwindow *w)
{
    static const struct {
        int left, right;
        unsigned flag;
    } keys[] = {{GLFW_KEY_LEFT_SHIFT, GLFW_KEY_RIGHT_SHIFT, CWI_UI_SHIFT},
                {GLFW_KEY_LEFT_CONTROL, GLFW_KEY_RIGHT_CONTROL, CWI_UI_CTRL},
                {GLFW_KEY_LEFT_ALT, GLFW_KEY_RIGHT_ALT, CWI_UI_ALT}};
    unsigned flags = 0;
    for (int n = 0; n < 3; n++)
        if (glfwGetKey(w, keys[n].left) == GLFW_PRESS ||
            glfwGetKey(w, keys[n].right) == GLFW_PRESS)
            flags |= keys[n].flag;
    return flags;
}

static void put_event(GLFWwindow *w, cwi_ui_event event)
{
    cwi_ui *ui = glfwGetWindowUserPointer(w);
    event.modifiers = held_modifiers(w);
    cwi_ui_queue_put(ui, &event, cwi_ui_screen_seconds(ui), ui->screen->repeats);
}

/* Reports a move. The window's own units may be larger than the framebuffer's pixels. */
static void on_move(GLFWwindow *w, double x, double y)
{
    int window[2], pixels[2];
    glfwGetWindowSize(w, &window[0], &window[1]);
    glfwGetFramebufferSize(w, &pixels[0], &pixels[1]);
    put_event(w, (cwi_ui_event){.kind = CWI_UI_MOVE,
                                .x = window[0] > 0 ? x * pixels[0] / window[0] : x,
                                .y = window[1] > 0 ? y * pixels[1] / window[1] : y});
}

static void on_enter(GLFWwindow *w, int entered)
{
    if (!entered)
        put_event(w, (cwi_ui_event){.kind = CWI_UI_MOVE, .x = -1, .y = -1});
}

static void on_button(GLFWwindow *w, int button, int action, int modifiers)
{
    (void)modifiers;
    if (button >= 0 && button < CWI_UI_BUTTONS) /* GLFW counts as we do */
        put_event(w, (cwi_ui_event){.kind = action == GLFW_PRESS ? CWI_UI_PRESS : CWI_UI_LIFT,
                                    .button = button});
}

static void on_wheel(GLFWwindow *w, double x, double y)
{
    (void)x;
    put_event(w, (cwi_ui_event){.kind = CWI_UI_WHEEL, .y = y});
}

static const struct {
    int key;
    const char *name;
} named[] = {{GLFW_KEY_SPACE, "Space"},    {GLFW_KEY_ENTER, "Enter"},
             {GLFW_KEY_KP_ENTER, "Enter"}, {GLFW_KEY_TAB, "Tab"},
             {GLFW_KEY_ESCAPE, "Escape"},  {GLFW_KEY_BACKSPACE, "Backspace"},
             {GLFW_KEY_DELETE, "Delete"},  {GLFW_KEY_INSERT, "Insert"},
             {GLFW_KEY_HOME, "Home"},      {GLFW_KEY_END, "End"},
             {GLFW_KEY_PAGE_UP, "PageUp"}, {GLFW_KEY_PAGE_DOWN, "PageDown"},
             {GLFW_KEY_LEFT, "Left"},      {GLFW_KEY_RIGHT, "Right"},
             {GLFW_KEY_UP, "Up"},          {GLFW_KEY_DOWN, "Down"},
             {GLFW_KEY_F1, "F1"},          {GLFW_KEY_F2, "F2"},
             {GLFW_KEY_F3, "F3"},          {GLFW_KEY_F4, "F4"},
             {GLFW_KEY_F5, "F5"},          {GLFW_KEY_F6, "F6"},
             {GLFW_KEY_F7, "F7"},          {GLFW_KEY_F8, "F8"},
             {GLFW_KEY_F9, "F9"},          {GLFW_KEY_F10, "F10"},
             {GLFW_KEY_F11, "F11"},        {GLFW_KEY_F12, "F12"}};

static void put_key(GLFWwindow *w, unsigned modifiers, const char *key)
{
    char name[CWI_UI_KEY_SIZE];
    cwi_ui_key_name(name, modifiers, key);
    put_event(w, (cwi_ui_event){.kind = CWI_UI_KEY, .text = name});
}

static const char *name_of(int key)
{
    for (size_t n = 0; n < sizeof named / sizeof *named; n++)
        if (named[n].key == key)
            return named[n].name;
    return NULL;
}

static void capitalize_name(char text[8])
{
    if (text[0] >= 'a' && text[0] <= 'z')
        text[0] = (char)(text[0] - 'a' + 'A');
}

/* Queues a shortcut. With Ctrl or Alt a key writes nothing: its name is the layout's character
 * or, if that is of another script, an American layout's. */
static void put_shortcut(GLFWwindow *w, unsigned modifiers, int key, int code)
{
    const char *name = glfwGetKeyName(key, code);
    const bool ascii = name && (unsigned char)name[0] < 0x80 && name[1] == '\0';
    char text[8] = {0};
    if (!name || (!ascii && (key <= ' ' || key > '`')))
        return;
    text[0] = ascii ? name[0] : (char)key;
    capitalize_name(text);
    if (cwi_ui_key_number(text, NULL) > 0)
        put_key(w, modifiers, text);
}

/* Queues a key that only modifies as a move to the mouse's place. */
static void put_modifier(GLFWwindow *w)
{
    double x, y;
    glfwGetCursorPos(w, &x, &y);
    on_move(w, x, y);
}

static void on_key(GLFWwindow *w, int key, int code, int action, int modifiers)
{
    cwi_ui *ui = glfwGetWindowUserPointer(w);
    const unsigned held = held_modifiers(w);
    (void)modifiers;
    ui->screen->repeats = action == GLFW_REPEAT;
    if (key >= GLFW_KEY_LEFT_SHIFT && key <= GLFW_KEY_RIGHT_SUPER)
        put_modifier(w);
    else if (action != GLFW_RELEASE && name_of(key))
        put_key(w, held, name_of(key));
    else if (action != GLFW_RELEASE && (held & (CWI_UI_CTRL | CWI_UI_ALT)))
        put_shortcut(w, held, key, code);
}

static size_t encode_utf8(unsigned c, char out[8])
{
    static const struct {
        unsigned below, first;
    } lengths[] = {{0x80, 0}, {0x800, 0xc0}, {0x10000, 0xe0}, {0x110000, 0xf0}};
    size_t more = 0;
    while (more < 3 && c >= lengths[more].below)
        more++;
    for (size_t n = more; n > 0; n--, c >>= 6)
        out[n] = (char)(0x80 | (c & 0x3f));
    out[0] = (char)(lengths[more].first | c);
    out[more + 1] = '\0';
    return more + 1;
}

static bool is_letter_or_digit(unsigned c)
{
    return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

/* Queues a character; it is a key too, by the name it has on this keyboard. */
static void on_character(GLFWwindow *w, unsigned character)
{
    char text[8], key[8];
    encode_utf8(character, text);
    memcpy(key, text, sizeof key);
    capitalize_name(key);
    if (cwi_ui_key_number(key, NULL) > 0)
        put_key(w, is_letter_or_digit(character) ? held_modifiers(w) & CWI_UI_SHIFT : 0, key);
    put_event(w, (cwi_ui_event){.kind = CWI_UI_WRITE, .text = text});
}

static void on_drop(GLFWwindow *w, int count, const char **paths)
{
    for (int n = 0; n < count; n++)
        put_event(w, (cwi_ui_event){.kind = CWI_UI_DROP, .text = paths[n]});
}

static void on_close(GLFWwindow *w)
{
    glfwSetWindowShouldClose(w, GLFW_FALSE); /* the drawing code decides */
    put_event(w, (cwi_ui_event){.kind = CWI_UI_CLOSE});
}

static void listen_to_window(cwi_ui *ui, GLFWwindow *w)
{
    glfwSetWindowUserPointer(w, ui);
    glfwSetCursorPosCallback(w, on_move);
    glfwSetCursorEnterCallback(w, on_enter);
    glfwSetMouseButtonCallback(w, on_button);
    glfwSetScrollCallback(w, on_wheel);
    glfwSetKeyCallback(w, on_key);
    glfwSetCharCallback(w, on_character);
    glfwSetDropCallback(w, on_drop);
    glfwSetWindowCloseCallback(w, on_close);
}

/* ---- opening ---- */

static const char *glfw_words(void)
{
    const char *words = NULL;
    glfwGetError(&words);
    return words ? words : "GLFW does not say why";
}

/* Makes a window by the system's own API first: without a GPU, X receives pictures in half the
 * time of EGL. It reports lost contexts where that is supported. */
static GLFWwindow *make_window(const cwi_ui_desc *desc)
{
    static const int attempts[][2] = {{GLFW_NATIVE_CONTEXT_API, GLFW_LOSE_CONTEXT_ON_RESET},
                                      {GLFW_NATIVE_CONTEXT_API, GLFW_NO_ROBUSTNESS},
                                      {GLFW_EGL_CONTEXT_API, GLFW_LOSE_CONTEXT_ON_RESET},
                                      {GLFW_EGL_CONTEXT_API, GLFW_NO_ROBUSTNESS}};
    GLFWwindow *window = NULL;
    glfwDefaultWindowHints();
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    for (int n = 0; n < 4 && !window; n++) {
        glfwWindowHint(GLFW_CONTEXT_CREATION_API, attempts[n][0]);
        glfwWindowHint(GLFW_CONTEXT_ROBUSTNESS, attempts[n][1]);
        window = glfwCreateWindow((int)desc->width, (int)desc->height, desc->title, NULL, NULL);
    }
    return window;
}

/* Fails with the reason why there is no window, and the OpenGL that exists. */
static cw_status fail_window(const char *words, cw_error *err)
{
    char found[128] = "none";
    glfwDefaultWindowHints();
    glfwWindowHint(GLFW_VISIBLE, GLFW_FALSE);
    GLFWwindow *any = glfwCreateWindow(16, 16, "", NULL, NULL);
    if (any) {
        glfwMakeContextCurrent(any);
        snprintf(found, sizeof found, "%s", (const char *)glGetString(GL_VERSION));
        glfwDestroyWindow(any);
    }
    return cwi_fail(err, CW_ERR_UNSUPPORTED,
                    "a window needs OpenGL 3.3; found here: %s (%.160s): apt-get install "
                    "libgl1-mesa-dri, or draw without one by `cubewright render`",
                    found, words);
}

static void set_scale(cwi_ui *ui, const cwi_ui_desc *desc, GLFWwindow *w)
{
    float x = 1, y = 1;
    if (w)
        glfwGetWindowContentScale(w, &x, &y);
    ui->scale = desc->scale > 0 ? desc->scale : fmin(fmax((double)x, 0.5), 4);
}

static cw_status open_window(cwi_ui *ui, const cwi_ui_desc *desc, cw_error *err)
{
    cw_status st = cwi_gl_is_there(err);
    if (st != CW_OK)
        return st;
    if (!glfwInit())
        return cwi_fail(err, CW_ERR_UNSUPPORTED,
                        "no display (%.160s): set DISPLAY to one, or draw without a window by "
                        "`cubewright render`",
                        glfw_words());
    GLFWwindow *w = make_window(desc);
    if (!w) {
        st = fail_window(glfw_words(), err);
        glfwTerminate();
        return st;
    }
    ui->screen->window = w;
    set_scale(ui, desc, w);
    listen_to_window(ui, w);
    glfwMakeContextCurrent(w);
    glfwSwapInterval(1);
    cwi_gl_describe(ui->name, sizeof ui->name);
    glfwMakeContextCurrent(NULL);
    return CW_OK;
}

static cw_status open_hidden(cwi_ui *ui, const cwi_ui_desc *desc, cw_error *err)
{
    cwi_ui_screen *s = ui->screen;
    cw_status st = cwi_gl_context_open(&s->context, err);
    if (st != CW_OK)
        return st;
    s->width = desc->width;
    s->height = desc->height;
    set_scale(ui, desc, NULL);
    cwi_gl_describe(ui->name, sizeof ui->name);
    cwi_gl_context_leave(&s->context);
    return CW_OK;
}

cw_status cwi_ui_screen_open(cwi_ui *ui, const cwi_ui_desc *desc, cw_error *err)
{
    cwi_ui_screen *s = cwi_alloc_zeroed(1, sizeof *s);
    if (!s)
        return cwi_fail_memory(err);
    s->start = clock_seconds();
    ui->screen = s;
    const cw_status st = desc->hidden ? open_hidden(ui, desc, err) : open_window(ui, desc, err);
    if (st != CW_OK) {
        cwi_free(s);
        ui->screen = NULL;
    }
    return st;
}

void cwi_ui_screen_close(cwi_ui *ui)
{
    cwi_ui_screen *s = ui->screen;
    if (!s)
        return;
    if (s->window)
        glfwTerminate(); /* its cursors too */
    else
        cwi_gl_context_close(&s->context);
    cwi_free(s->clipboard);
    cwi_free(s);
    ui->screen = NULL;
}

/* ---- calls of the other files ---- */

/* Makes the window's context current, until leave(): contexts of EGL and of others do not work
 * together on one thread. */
bool cwi_ui_screen_enter(cwi_ui *ui)
{
    cwi_ui_screen *s = ui->screen;
    if (!s->window)
        return cwi_gl_context_enter(&s->context);
    glfwGetError(NULL); /* of before, such as a clipboard's without text */
    glfwMakeContextCurrent(s->window);
    return glfwGetError(NULL) == GLFW_NO_ERROR;
}

void cwi_ui_screen_leave(cwi_ui *ui)
{
    if (ui->screen->window)
        glfwMakeContextCurrent(NULL);
    else
        cwi_gl_context_leave(&ui->screen->context);
}

/* Hidden frames all take the same time: what is drawn, printed and double-clicked is the same every
 * time, and on any machine. */
double cwi_ui_screen_seconds(const cwi_ui *ui)
{
    const cwi_ui_screen *s = ui->screen;
    return s->window ? clock_seconds() - s->start : (double)s->frames / 60;
}

double cwi_ui_screen_frame_time(const cwi_ui *ui)
{
    ui->screen->frames++;
    return cwi_ui_screen_seconds(ui);
}

/* Finds the window's size. A minimised window has no pixels; the last size stays then. */
void cwi_ui_screen_size(const cwi_ui *ui, size_t size[2])
{
    cwi_ui_screen *s = ui->screen;
    int width, height;
    if (s->window) {
        glfwGetFramebufferSize(s->window, &width, &height);
        s->width = width > 0 ? (size_t)width : s->width > 0 ? s->width : 1;
        s->height = height > 0 ? (size_t)height : s->height > 0 ? s->height : 1;
    }
    size[0] = s->width;
    size[1] = s->height;
}

void cwi_ui_screen_resize(cwi_ui *ui, size_t width, size_t height)
{
    cwi_ui_screen *s = ui->screen;
    int window[2], pixels[2];
    if (!s->window) {
        s->width = width;
        s->height = height;
        return;
    }
    glfwGetWindowSize(s->window, &window[0], &window[1]);
    glfwGetFramebufferSize(s->window, &pixels[0], &pixels[1]);
    if (pixels[0] > 0 && pixels[1] > 0)
        glfwSetWindowSize(s->window, (int)lround((double)width * window[0] / pixels[0]),
                          (int)lround((double)height * window[1] / pixels[1]));
}

void cwi_ui_screen_wait(cwi_ui *ui, double seconds)
{
    if (!ui->screen->window)
        return; /* nothing can come while the caller waits */
    glfwPollEvents();
    if (seconds > 0 && ui->queue.first == ui->queue.count)
        glfwWaitEventsTimeout(seconds);
}

/* Shows the picture. Mesa without a GPU leaves it with XCB, and waiting for events does not
 * send it: a request to the server does. */
void cwi_ui_screen_show(cwi_ui *ui)
{
    const cwi_ui_target *t = &ui->target;
    const GLint width = (GLint)t->width, height = (GLint)t->height;
    int size[2];
    if (!ui->screen->window)
        return;
    glBindFramebuffer(GL_READ_FRAMEBUFFER, t->framebuffer);
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, 0);
    glBlitFramebuffer(0, 0, width, height, 0, 0, width, height, GL_COLOR_BUFFER_BIT,
                      GL_NEAREST);
    glfwSwapBuffers(ui->screen->window);
    glfwGetWindowSize(ui->screen->window, &size[0], &size[1]);
}

void cwi_ui_screen_title(cwi_ui *ui, const char *title)
{
    if (ui->screen->window)
        glfwSetWindowTitle(ui->screen->window, title);
}

void cwi_ui_screen_copy(cwi_ui *ui, const char *text)
{
    cwi_ui_screen *s = ui->screen;
    if (s->window) {
        glfwSetClipboardString(s->window, text);
        return;
    }
    cwi_free(s->clipboard);
    s->clipboard = cwi_strdup(text);
}

const char *cwi_ui_screen_paste(cwi_ui *ui)
{
    cwi_ui_screen *s = ui->screen;
    const char *text = s->window ? glfwGetClipboardString(s->window) : s->clipboard;
    return text ? text : "";
}

void cwi_ui_screen_cursor(cwi_ui *ui, int shape)
{
    static const int shapes[CURSORS] = {GLFW_ARROW_CURSOR, GLFW_CROSSHAIR_CURSOR,
                                        GLFW_HAND_CURSOR,  GLFW_HRESIZE_CURSOR,
                                        GLFW_IBEAM_CURSOR, GLFW_VRESIZE_CURSOR};
    cwi_ui_screen *s = ui->screen;
    if (!s->window || shape == s->cursor || shape < 0 || shape >= CURSORS)
        return;
    if (!s->cursors[shape])
        s->cursors[shape] = glfwCreateStandardCursor(shapes[shape]);
    glfwSetCursor(s->window, s->cursors[shape]);
    s->cursor = shape;
}
