/* The one table of keys and menus: what they do are commands, which scripts say as well. The
 * cheat sheet, the help and the README's table are made of it. */
#include "cli/session/view.h"

#include <stdio.h>
#include <string.h>

const view_key view_keys[] = {
    {"toggle help", "H", "Help/Keys", "Show or hide this list"},
    {"toggle help", "?", NULL, NULL},
    {"toggle about", NULL, "Help/About",
     "Show what draws the scene, and the papers it follows"},
    {"toggle files", "O", "File/Open", "Choose a file"},
    {"toggle save-mesh", "Ctrl+M", "File/Save mesh...",
     "Save the surface as a mesh, of any format and size"},
    {"toggle save-picture", "Ctrl+P", "File/Save picture...",
     "Save the picture in any size and layout"},
    {"screenshot", "F12", "File/Save picture at once",
     "Save the picture as cubewright-NNN.png"},
    {"background none; screenshot; background default", "Ctrl+F12",
     "File/Save without background", "Save the picture without its background"},
    {"turntable 36 'turn-{turn:02d}.png'", NULL, "File/Save a turntable", NULL},
    {"save-state", "Ctrl+S", "File/Save the session",
     "Save the session as cubewright-state.txt"},
    {"copy-command", "Ctrl+C", "File/Copy as a command line",
     "Copy the session as a command line"},
    {"next", "PageDown", "File/Next in the folder", "Open the next file of the folder"},
    {"previous", "PageUp", "File/Previous in the folder",
     "Open the previous file of the folder"},
    {"quit", "Ctrl+Q", "File/Quit", "Close the window"},
    {"undo", "Ctrl+Z", "Edit/Undo", "Undo the last change"},
    {"redo", "Ctrl+Y", "Edit/Redo", "Redo the last undone change"},
    {"redo", "Ctrl+Shift+Z", NULL, NULL},
    {"camera front", "1", "View/Front", "Look from the front"},
    {"camera back", "Ctrl+1", "View/Back", "Look from the back"},
    {"camera right", "3", "View/Right", "Look from the patient's right"},
    {"camera left", "Ctrl+3", "View/Left", "Look from the patient's left"},
    {"camera top", "7", "View/Top", "Look from above"},
    {"camera bottom", "Ctrl+7", "View/Bottom", "Look from below"},
    {"camera iso", "9", "View/From a corner", "Look from a corner"},
    {"toggle ortho", "5", "View/Orthographic",
     "Switch between parallel projection and perspective"},
    {"reset", "Enter", "View/See all", "Show the whole scene again"},
    {"camera-back", "Alt+Left", "View/Earlier view",
     "Go back to the view before the last movement"},
    {"camera-forward", "Alt+Right", "View/Later view", "Go forward to the view after it"},
    {"bookmark", "Ctrl+B", "View/Keep this view", "Keep the view as a bookmark"},
    {"orbit -5", "Left", NULL, "Orbit by 5 degrees"},
    {"orbit 5", "Right", NULL, NULL},
    {"orbit 0 5", "Up", NULL, NULL},
    {"orbit 0 -5", "Down", NULL, NULL},
    {"dolly 1.1", "+", "View/Nearer", "Move the camera nearer"},
    {"dolly 0.909", "-", "View/Farther", "Move the camera away"},
    {"toggle quad", "Q", "View/Slices beside the scene",
     "Show or hide axial, coronal and sagittal slices"},
    {"toggle cross", "K", "View/Cross-hair", "Show or hide the cross-hair"},
    {"toggle axes", "A", "View/Axes", "Show or hide the edges of the box, with L, P and S"},
    {"toggle scale-bar", "R", "View/Scale bar", "Show or hide a scale bar in mm"},
    {"toggle letters", "T", "View/Letters", "Show or hide the directions R L A P S I"},
    {"toggle color-bar", "G", "View/Colour bar", "Show or hide the colours of the values"},
    {"toggle light-theme", NULL, "View/Light panels", NULL},
    {"focus next", "F6", "View/Keys to the panels",
     "Walk through a panel by arrows, Space and Enter; again: the next panel"},
    {"focus menus", "F10", NULL, "Walk through the menus by arrows and Enter"},
    {"toggle panels", "Tab", "View/Panels", "Show or hide all panels"},
    {"next-mode", "M", "Scene/Next mode", "Draw in the next mode"},
    {"previous-mode", "Shift+M", "Scene/Previous mode", "Draw in the previous mode"},
    {"toggle gallery", "Shift+P", "Scene/Presets...", "Show or hide pictures of all presets"},
    {"next-preset", "P", "Scene/Next preset", "Use the next transfer function"},
    {"toggle lit", "L", "Scene/Light", "Switch the shading of volumes on or off"},
    {"iso-by -0.01", "[", "Scene/Lower isovalue", "Lower the isovalue"},
    {"iso-by 0.01", "]", "Scene/Higher isovalue", "Raise the isovalue"},
    {"iso off", "Backspace", "Scene/No surface", "Remove the surface"},
    {"toggle wireframe", "W", "Scene/Wireframe", "Show or hide the edges of triangles"},
    {"toggle handles", "B", "Scene/Clip box",
     "Show or hide a clip box, whose faces can be dragged"},
    {"wheel-cuts x", "X", NULL, "Cut along x, y or z with the wheel; press again to stop"},
    {"wheel-cuts y", "Y", NULL, NULL},
    {"wheel-cuts z", "Z", NULL, NULL},
    {"toggle cap", "C", "Scene/Fill cuts", "Fill the cut through a closed mesh"},
    {"clip-box off", "Shift+B", "Scene/Remove all cuts", "Remove all cuts"},
    {"measure-tool distance", "D", "Measure/Measure distance",
     "Measure a distance by two clicks; press again to stop"},
    {"measure-tool angle", "Shift+D", "Measure/Measure angle",
     "Measure an angle by three clicks, the corner second"},
    {"measure-tool area", "Ctrl+D", "Measure/Measure area",
     "Measure an area by clicks around it; Enter or a double click ends it"},
    {"copy-measurements", NULL, "Measure/Copy all values", NULL},
    {"measure off", NULL, "Measure/Remove all", NULL},
    {"toggle playing", "Space", "Time/Play", "Play or pause a time series"},
    {"step next", ".", "Time/Next step", "Go to the next time step"},
    {"step previous", ",", "Time/Previous step", "Go to the previous time step"},
};
const size_t view_key_count = sizeof view_keys / sizeof *view_keys;

bool *view_shown_flag(view *v, const char *name)
{
    const struct {
        const char *name;
        bool *on;
    } flags[] = {{"panels", &v->shown.panels},
                 {"files", &v->shown.files},
                 {"help", &v->shown.help},
                 {"handles", &v->shown.handles},
                 {"cross", &v->shown.cross},
                 {"playing", &v->shown.playing},
                 {"about", &v->shown.about},
                 {"save-mesh", &v->shown.save_mesh},
                 {"save-picture", &v->shown.save_picture},
                 {"gallery", &v->shown.gallery}};
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

void view_print_keys(FILE *out)
{
    char names[64];
    for (size_t n = 0; n < view_key_count; n++)
        if (view_key_names(n, names, sizeof names))
            fprintf(out, "  %-22s%s\n", names, view_keys[n].about);
}
