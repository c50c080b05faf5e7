/* The one table of keys and menus: what they do are commands, which scripts say as well. The
 * cheat sheet, the help and the README's table are made of it. */
#include "cli/view/view.h"

#include <stdio.h>
#include <string.h>

const view_key view_keys[] = {
    {"toggle help", "H", "Help/Keys", "this list"},
    {"toggle help", "?", NULL, NULL},
    {"toggle about", NULL, "Help/About", "what draws, and whose work it follows"},
    {"toggle files", "O", "File/Open", "choose a file"},
    {"screenshot", "F12", "File/Save the picture", "write the picture as cubewright-NNN.png"},
    {"background none; screenshot; background default", "Ctrl+F12",
     "File/Save it without background", "the same without its background"},
    {"turntable 36 'turn-{turn:02d}.png'", NULL, "File/Save a turntable", NULL},
    {"save-state", "Ctrl+S", "File/Save the session",
     "write the session as cubewright-state.txt"},
    {"copy-command", "Ctrl+C", "File/Copy as a command line",
     "copy the session as a command line"},
    {"next", "PageDown", "File/Next in the folder", "open the next file of the folder"},
    {"previous", "PageUp", "File/Previous in the folder", "open the one before"},
    {"quit", "Ctrl+Q", "File/Quit", "close the window"},
    {"undo", "Ctrl+Z", "Edit/Undo", "take back the last change"},
    {"redo", "Ctrl+Y", "Edit/Redo", "and make it after all"},
    {"redo", "Ctrl+Shift+Z", NULL, NULL},
    {"camera front", "1", "View/Front", "look from the front"},
    {"camera back", "Ctrl+1", "View/Back", "from the back"},
    {"camera right", "3", "View/Right", "from the patient's right"},
    {"camera left", "Ctrl+3", "View/Left", "from the left"},
    {"camera top", "7", "View/Top", "from above"},
    {"camera bottom", "Ctrl+7", "View/Bottom", "from below"},
    {"camera iso", "9", "View/From a corner", "from a corner"},
    {"toggle ortho", "5", "View/Orthographic", "parallel lines stay parallel"},
    {"reset", "Enter", "View/See all", "see all of it again"},
    {"orbit -5", "Left", NULL, "orbit by 5 degrees"},
    {"orbit 5", "Right", NULL, NULL},
    {"orbit 0 5", "Up", NULL, NULL},
    {"orbit 0 -5", "Down", NULL, NULL},
    {"dolly 1.1", "+", "View/Nearer", "come nearer"},
    {"dolly 0.909", "-", "View/Farther", "go away"},
    {"toggle quad", "Q", "View/Slices beside it",
     "axial, coronal and sagittal slices beside it"},
    {"toggle cross", "K", "View/Cross-hair", "show the cross-hair"},
    {"toggle axes", "A", "View/Axes", "the edges of the box, and L, P, S"},
    {"toggle scale-bar", "R", "View/Scale bar", "a length in mm"},
    {"toggle letters", "T", "View/Letters", "where the edges lead: R L A P S I"},
    {"toggle color-bar", "G", "View/Colour bar", "the colours of values"},
    {"toggle panels", "Tab", "View/Panels", "show or hide all panels"},
    {"next-mode", "M", "Scene/Next mode", "draw in the next mode"},
    {"previous-mode", "Shift+M", "Scene/Previous mode", "and in the one before"},
    {"next-preset", "P", "Scene/Next preset", "the next transfer function"},
    {"toggle lit", "L", "Scene/Light", "shade volumes by their gradient"},
    {"iso-by -0.01", "[", "Scene/Lower isovalue", "lower the isovalue"},
    {"iso-by 0.01", "]", "Scene/Higher isovalue", "raise it"},
    {"iso off", "Backspace", "Scene/No surface", "no surface any more"},
    {"toggle wireframe", "W", "Scene/Wireframe", "the edges of triangles, too"},
    {"toggle handles", "B", "Scene/Clip box", "a box to cut with: drag its faces"},
    {"wheel-cuts x", "X", NULL, "the wheel cuts along x, y, z (again: it does not)"},
    {"wheel-cuts y", "Y", NULL, NULL},
    {"wheel-cuts z", "Z", NULL, NULL},
    {"toggle cap", "C", "Scene/Fill cuts", "fill the cut through a closed mesh"},
    {"clip-box off", "Shift+B", "Scene/Cut nothing", "nothing is cut any more"},
    {"toggle playing", "Space", "Time/Play", "play the steps of a time series"},
    {"step next", ".", "Time/Next step", "the next step"},
    {"step previous", ",", "Time/Previous step", "the step before"},
};
const size_t view_key_count = sizeof view_keys / sizeof *view_keys;

bool *view_shown_flag(view *v, const char *name)
{
    const struct {
        const char *name;
        bool *on;
    } flags[] = {{"panels", &v->shown.panels}, {"files", &v->shown.files},
                 {"help", &v->shown.help},     {"handles", &v->shown.handles},
                 {"cross", &v->shown.cross},   {"playing", &v->shown.playing},
                 {"about", &v->shown.about}};
    for (size_t n = 0; n < sizeof flags / sizeof *flags; n++)
        if (strcmp(flags[n].name, name) == 0)
            return flags[n].on;
    return NULL;
}

bool view_find_flag(const view *v, const char *name, bool *on)
{
    const bool *shown = view_shown_flag((view *)v, name);
    const cli_option *o = view_find_option(v, name);
    if (strcmp(name, "quad") == 0) {
        *on = v->state.args.marks.layout == CLI_LAYOUT_QUAD;
        return true;
    }
    if (shown)
        *on = *shown;
    else if (o && o->kind == CLI_FLAG)
        *on = *(const bool *)((const char *)&v->state.args + o->offset);
    return shown || (o && o->kind == CLI_FLAG);
}

bool view_key_names(size_t n, char *names, size_t size)
{
    size_t used = 0;
    if (!view_keys[n].key || !view_keys[n].about)
        return false;
    for (size_t m = n; m == n || (m < view_key_count && !view_keys[m].about); m++)
        if (view_keys[m].key && used < size)
            used += (size_t)snprintf(names + used, size - used, "%s%s", m == n ? "" : " ",
                                     view_keys[m].key);
    return true;
}

void view_print_keys(void)
{
    char names[64];
    for (size_t n = 0; n < view_key_count; n++)
        if (view_key_names(n, names, sizeof names))
            printf("  %-22s%s\n", names, view_keys[n].about);
}
