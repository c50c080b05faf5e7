/* Does to a window what xdotool cannot:
 *   xdnd drop WINDOW X Y PATH...   drops files on it, as a file manager would (XDND 5)
 *   xdnd close WINDOW              asks it to close, as a window manager would */
#include <X11/Xatom.h>
#include <X11/Xlib.h>

#include <poll.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LIMIT_MS = 300000, VERSION = 5 };

/* Ends what hangs; no machine is so slow. */
static int limit_ms(void)
{
    const char *slow = getenv("CUBEWRIGHT_TEST_SLOW");
    return LIMIT_MS * (slow && atoi(slow) > 0 ? atoi(slow) : 1);
}

static Atom atom(Display *x, const char *name)
{
    return XInternAtom(x, name, False);
}

static void send(Display *x, Window to, const char *type, const long data[5])
{
    XEvent e = {
        .xclient = {
            .type = ClientMessage, .window = to, .message_type = atom(x, type), .format = 32}};
    memcpy(e.xclient.data.l, data, sizeof e.xclient.data.l);
    XSendEvent(x, to, False, NoEventMask, &e);
    XFlush(x);
}

/* Returns false if none comes. */
static bool wait_for_event(Display *x, XEvent *e)
{
    struct pollfd fd = {.fd = ConnectionNumber(x), .events = POLLIN};
    if (!XPending(x) && poll(&fd, 1, limit_ms()) <= 0)
        return false;
    XNextEvent(x, e);
    return true;
}

/* "/a b" as "file:///a%20b" and so on, a line each. */
static char *uri_list(char **paths, int count)
{
    size_t size = 1;
    for (int n = 0; n < count; n++)
        size += 3 * strlen(paths[n]) + 10;
    char *text = malloc(size), *out = text;
    for (int n = 0; n < count && out; n++) {
        out += sprintf(out, "file://");
        for (const char *c = paths[n]; *c; c++)
            out += strchr(" %#?", *c) || (unsigned char)*c >= 128
                       ? sprintf(out, "%%%02X", (unsigned char)*c)
                       : sprintf(out, "%c", *c);
        out += sprintf(out, "\r\n");
    }
    return text;
}

static void answer(Display *x, const XSelectionRequestEvent *asked, const char *list)
{
    XEvent e = {.xselection = {.type = SelectionNotify,
                               .requestor = asked->requestor,
                               .selection = asked->selection,
                               .target = asked->target,
                               .property = asked->property,
                               .time = asked->time}};
    XChangeProperty(x, asked->requestor, asked->property, asked->target, 8, PropModeReplace,
                    (const unsigned char *)list, (int)strlen(list));
    XSendEvent(x, asked->requestor, False, NoEventMask, &e);
    XFlush(x);
}

/* Enter, move, and what the window answers: it is dropped when the window would take it. */
static bool drop(Display *x, Window to, const long position, const char *list)
{
    const Window own = XCreateSimpleWindow(x, DefaultRootWindow(x), 0, 0, 1, 1, 0, 0, 0);
    const Atom copy = atom(x, "XdndActionCopy");
    XEvent e;
    XSetSelectionOwner(x, atom(x, "XdndSelection"), own, CurrentTime);
    send(x, to, "XdndEnter",
         (const long[5]){(long)own, VERSION << 24, (long)atom(x, "text/uri-list")});
    send(x, to, "XdndPosition",
         (const long[5]){(long)own, 0, position, CurrentTime, (long)copy});
    while (wait_for_event(x, &e)) {
        if (e.type == SelectionRequest)
            answer(x, &e.xselectionrequest, list);
        if (e.type != ClientMessage)
            continue;
        if (e.xclient.message_type == atom(x, "XdndFinished"))
            return true;
        if (e.xclient.message_type == atom(x, "XdndStatus") && !(e.xclient.data.l[1] & 1))
            return false;
        if (e.xclient.message_type == atom(x, "XdndStatus"))
            send(x, to, "XdndDrop", (const long[5]){(long)own, 0, CurrentTime});
    }
    return false;
}

int main(int argc, char **argv)
{
    Display *x = XOpenDisplay(NULL);
    if (!x || argc < 3)
        return 2;
    const Window to = strtoul(argv[2], NULL, 0);
    bool done = true;
    if (strcmp(argv[1], "close") == 0) {
        send(x, to, "WM_PROTOCOLS", (const long[5]){(long)atom(x, "WM_DELETE_WINDOW")});
    } else if (argc > 5) {
        int left, top;
        Window child;
        char *list = uri_list(argv + 5, argc - 5);
        XTranslateCoordinates(x, to, DefaultRootWindow(x), atoi(argv[3]), atoi(argv[4]), &left,
                              &top, &child);
        done = list && drop(x, to, (long)left << 16 | top, list);
        free(list);
    }
    XCloseDisplay(x);
    return done ? 0 : 1;
}
