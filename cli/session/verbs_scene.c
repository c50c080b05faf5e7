/* Commands that change what is seen, and from where. */
#include "cli/session/verbs.h"

#include "core/base/status.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Commands that set how the scene is drawn. */

static cw_status change_mode(view *v, int by, cw_error *err)
{
    int m = (int)v->picture.mode;
    if (v->picture.mode == CW_MODE_MESH)
        v->state.iso_is_ours = true; /* the volume comes without the surface */
    do
        m = (m + by + CW_MODE_COUNT) % CW_MODE_COUNT;
    while (!view_fits_mode(v, (cw_mode)m));
    return view_set(v, "mode", cw_mode_name((cw_mode)m), err);
}

static cw_status run_next_mode(view *v, int count, char **args, cw_error *err)
{
    (void)count, (void)args;
    return change_mode(v, 1, err);
}

static cw_status run_previous_mode(view *v, int count, char **args, cw_error *err)
{
    (void)count, (void)args;
    return change_mode(v, -1, err);
}

static cw_status run_next_preset(view *v, int count, char **args, cw_error *err)
{
    size_t n = 0;
    const char *now = v->state.args.scene.transfer;
    (void)count, (void)args;
    while (now && cw_transfer_preset_name(n) && strcmp(cw_transfer_preset_name(n), now) != 0)
        n++;
    n = now && cw_transfer_preset_name(n) ? n + 1 : 0;
    const char *name = cw_transfer_preset_name(n);
    return view_set(v, "tf", name ? name : cw_transfer_preset_name(0), err);
}

static cw_status run_iso_by(view *v, int count, char **args, cw_error *err)
{
    double fraction;
    char text[32];
    (void)count;
    cw_status st = view_need_open(v, err);
    if (st == CW_OK && v->document.source.is_mesh)
        st = cwi_fail(err, CW_ERR_ARGUMENT, "a mesh has no isovalue");
    if (st == CW_OK)
        st = view_take("iso-by", args, 1, &fraction, err);
    if (st != CW_OK)
        return st;
    const cw_statistics *s = &v->document.statistics;
    const cli_number *iso = &v->state.args.iso;
    const double from = iso->given ? iso->value : view_suggest_iso(v);
    snprintf(text, sizeof text, "%.17g",
             fmin(fmax(from + fraction * (s->max - s->min), s->min), s->max));
    return view_set(v, "iso", text, err);
}

static cw_status run_toggle(view *v, int count, char **args, cw_error *err)
{
    bool on;
    bool *shown = view_shown_flag(v, args[0]);
    if (!view_find_flag(v, args[0], &on))
        return cwi_fail(err, CW_ERR_ARGUMENT, "toggle '%s': not a setting that is on or off",
                        args[0]);
    if (count == 2 && strcmp(args[1], "on") != 0 && strcmp(args[1], "off") != 0)
        return cwi_fail(err, CW_ERR_ARGUMENT, "toggle '%s': on or off was expected", args[1]);
    const bool turn_on = count == 2 ? strcmp(args[1], "on") == 0 : !on;
    if (strcmp(args[0], "quad") == 0)
        return view_set(v, "layout", turn_on ? "quad" : "single", err);
    if (!shown)
        return view_set(v, args[0], turn_on ? "on" : "off", err);
    *shown = turn_on;
    return CW_OK;
}

/* The panels that are shown, those in front first. */
static size_t list_panels(const view *v, const char *titles[8])
{
    const struct {
        bool on;
        const char *title;
    } panels[] = {{v->message.text[0] && v->message.is_error, "Error"},
                  {v->shown.save_mesh, "Save mesh"},
                  {v->shown.save_picture, "Save picture"},
                  {v->shown.gallery, "Presets"},
                  {v->shown.files, "Open"},
                  {v->shown.help, "Keys"},
                  {!v->document.path, "Start"},
                  {v->shown.panels, "Settings"}};
    size_t count = 0;
    for (size_t n = 0; n < sizeof panels / sizeof *panels; n++)
        if (panels[n].on)
            titles[count++] = panels[n].title;
    return count;
}

static cw_status run_focus(view *v, int count, char **args, cw_error *err)
{
    const char *titles[8];
    const size_t panels = list_panels(v, titles);
    (void)count;
    if (strcmp(args[0], "off") == 0) {
        v->ui->focus(v->window, NULL);
    } else if (strcmp(args[0], "menus") == 0 && v->shown.panels) {
        v->ui->focus(v->window, "");
    } else if (strcmp(args[0], "next") == 0 && panels) {
        v->input.focus_at = v->ui->focused(v->window) ? v->input.focus_at + 1 : 0;
        v->ui->focus(v->window, titles[v->input.focus_at % panels]);
    } else if (strcmp(args[0], "next") != 0 && strcmp(args[0], "menus") != 0) {
        return cwi_fail(err, CW_ERR_ARGUMENT, "focus '%s': next, menus or off was expected",
                        args[0]);
    }
    return v->script.is_queued ? CW_OK
                               : view_take_in(v, err); /* a script's keys come at once */
}

/* Commands for cuts, the cross-hair and slices. */

static void start_box(view *v)
{
    cli_ranges *box = &v->state.args.scene.clip_box;
    double corners[2][3];
    view_clip_box(v, corners);
    *box = (cli_ranges){.given = true, .world = true};
    memcpy(box->low, corners[0], sizeof box->low);
    memcpy(box->high, corners[1], sizeof box->high);
}

static cw_status run_face(view *v, int count, char **args, cw_error *err)
{
    double n[2];
    cw_status st = view_take("clip-face", args, count, n, err);
    if (st == CW_OK)
        st = view_need_open(v, err);
    if (st != CW_OK)
        return st;
    if (!(n[0] >= 0 && n[0] <= 5 && n[0] == floor(n[0])))
        return cwi_fail(err, CW_ERR_ARGUMENT, "clip-face '%s': 0 to 5 was expected", args[0]);
    start_box(v);
    cli_ranges *box = &v->state.args.scene.clip_box;
    const int axis = (int)n[0] / 2;
    const double thin = 1e-3 * (v->document.box[1][axis] - v->document.box[0][axis]);
    const double at = fmin(fmax(n[1], v->document.box[0][axis]), v->document.box[1][axis]);
    if ((int)n[0] % 2)
        box->high[axis] = fmax(at, box->low[axis] + thin);
    else
        box->low[axis] = fmin(at, box->high[axis] - thin);
    view_touch(v, 1 << VIEW_SPACE);
    return CW_OK;
}

/* Returns 1, 2, 3 for x, y, z; else 0. */
static int axis_of(const char *word)
{
    return word[0] && !word[1] && word[0] >= 'x' && word[0] <= 'z' ? 1 + word[0] - 'x' : 0;
}

/* Returns about the length of a voxel along an axis of the world. */
static double voxel_mm(const view *v)
{
    double spacing[3];
    if (v->document.source.is_mesh)
        return (v->document.box[1][0] - v->document.box[0][0]) / 256;
    cw_volume_spacing(&v->document.source.volume.view, spacing);
    return fmin(fmin(spacing[0], spacing[1]), spacing[2]);
}

static cw_status run_cut(view *v, int count, char **args, cw_error *err)
{
    double voxels;
    char face[16], mm[32], *words[] = {face, mm};
    const int axis = axis_of(args[0]) - 1;
    (void)count;
    if (axis < 0)
        return cwi_fail(err, CW_ERR_ARGUMENT, "cut '%s': x, y or z was expected", args[0]);
    cw_status st = view_take("cut", args + 1, 1, &voxels, err);
    if (st == CW_OK)
        st = view_need_open(v, err);
    if (st != CW_OK)
        return st;
    double box[2][3];
    view_clip_box(v, box);
    snprintf(face, sizeof face, "%d", 2 * axis);
    snprintf(mm, sizeof mm, "%.17g", box[0][axis] + voxels * voxel_mm(v));
    return run_face(v, 2, words, err);
}

/* The wheel cuts along an axis, until the same is said again. */
static cw_status run_wheel_cuts(view *v, int count, char **args, cw_error *err)
{
    const int axis = axis_of(args[0]);
    (void)count;
    if (!axis)
        return cwi_fail(err, CW_ERR_ARGUMENT, "wheel-cuts '%s': x, y or z was expected",
                        args[0]);
    v->shown.cut = v->shown.cut == axis ? 0 : axis;
    return CW_OK;
}

static void put_cross(view *v, const double point[3])
{
    for (int a = 0; a < 3; a++)
        v->state.cross[a] = fmin(fmax(point[a], v->document.box[0][a]), v->document.box[1][a]);
    view_touch(v, v->picture.mode == CW_MODE_SLICES ? VIEW_ALL : VIEW_SLICES);
}

static cw_status run_cross(view *v, int count, char **args, cw_error *err)
{
    double point[3];
    cw_status st = view_take("cross", args, count, point, err);
    if (st == CW_OK)
        st = view_need_open(v, err);
    if (st == CW_OK)
        put_cross(v, point);
    return st;
}

static cw_status run_cross_by(view *v, int count, char **args, cw_error *err)
{
    double voxels, point[3];
    const int axis = axis_of(args[0]) - 1;
    (void)count;
    if (axis < 0)
        return cwi_fail(err, CW_ERR_ARGUMENT, "cross-by '%s': x, y or z was expected", args[0]);
    cw_status st = view_take("cross-by", args + 1, 1, &voxels, err);
    if (st == CW_OK)
        st = view_need_open(v, err);
    if (st != CW_OK)
        return st;
    memcpy(point, v->state.cross, sizeof point);
    point[axis] += voxels * voxel_mm(v);
    put_cross(v, point);
    return CW_OK;
}

/* Says the label of the surface that was picked, or of the voxel there. */
static void tell_picked_label(view *v, const cw_scene *scene, const cw_picked *picked)
{
    char text[CLI_LABEL_NAME + 32];
    const cw_mesh *m = scene->mesh;
    if (!v->document.labels.look.labels)
        return;
    if (picked->kind == CW_PICK_MESH && m && m->labels && picked->number != SIZE_MAX)
        view_name_label(v, m->labels[m->triangles[3 * picked->number]], text, sizeof text);
    else
        view_label_at(v, picked->point, text, sizeof text);
    if (*text)
        view_say(v, false, text);
}

cw_status view_pick_point(view *v, const double pixel[2], cw_picked *picked, cw_error *err)
{
    const view_part *part = &v->picture.parts[VIEW_SPACE];
    *picked = (cw_picked){0};
    if (part->level == VIEW_STALE || part->scene.mesh_look.live || v->state.args.compare)
        return CW_OK; /* nothing to be seen yet, or two things */
    const double scale = (double)part->scene.width / fmax(part->rect.width, 1);
    return cw_pick(&part->scene, (const double[2]){pixel[0] * scale, pixel[1] * scale}, picked,
                   err);
}

/* Picks what is at a pixel of the 3D part, and puts the cross-hair there. */
static cw_status run_pick(view *v, int count, char **args, cw_error *err)
{
    double pixel[2];
    cw_picked picked = {0};
    const view_part *part = &v->picture.parts[VIEW_SPACE];
    cw_status st = view_take("pick", args, count, pixel, err);
    if (st == CW_OK)
        st = view_need_open(v, err);
    if (st == CW_OK)
        st = view_pick_point(v, pixel, &picked, err);
    if (st == CW_OK && picked.kind != CW_PICK_NOTHING) {
        put_cross(v, picked.point);
        tell_picked_label(v, &part->scene, &picked);
    }
    return st;
}

static cw_status run_zoom_slices(view *v, int count, char **args, cw_error *err)
{
    double n;
    (void)count;
    cw_status st = view_take("zoom-slices", args, 1, &n, err);
    if (st == CW_OK && !(n > 0))
        st = cwi_fail(err, CW_ERR_ARGUMENT, "zoom-slices %s: above 0 was expected", args[0]);
    if (st == CW_OK)
        v->state.slice_zoom = fmin(fmax(n, 0.1), 100);
    view_touch(v, VIEW_SLICES);
    return st;
}

static cw_status run_split(view *v, int count, char **args, cw_error *err)
{
    double n;
    (void)count;
    cw_status st = view_take("split", args, 1, &n, err);
    if (st == CW_OK && !(n >= 0 && n <= 1))
        st = cwi_fail(err, CW_ERR_ARGUMENT, "split %s: 0 to 1 was expected", args[0]);
    if (st == CW_OK)
        v->state.left_fraction = n;
    if (st == CW_OK && v->state.args.compare)
        view_touch(v, 1 << VIEW_SPACE);
    return st;
}

static const view_verb rows[] = {
    VERB("next-mode", "", "Draw in the next mode", 0, 0, run_next_mode),
    VERB("previous-mode", "", "Draw in the previous mode", 0, 0, run_previous_mode),
    EDIT("next-preset", "", "Use the next transfer function", 0, 0, run_next_preset),
    EDIT("iso-by", "F", "Move the isovalue by a fraction of the range of values", 1, 1,
         run_iso_by),
    EDIT("toggle", "NAME [on|off]",
         "Switch a setting on or off, or: panels, files, help, handles, cross, playing, about",
         1, 2, run_toggle),
    VERB("focus", "next|menus|off", "Let keys walk through the next panel, or the menus", 1, 1,
         run_focus),
    EDIT("cut", "x|y|z VOXELS", "Cut the low side of an axis farther by this amount", 2, 2,
         run_cut),
    EDIT("clip-face", "N MM", "Move a face of the clip box: 0 to 5 for x, x, y, y, z, z", 2, 2,
         run_face),
    VERB("wheel-cuts", "x|y|z", "Cut along an axis with the wheel", 1, 1, run_wheel_cuts),
    VERB("cross", "X Y Z", "Put the cross-hair at a point, in LPS mm", 3, 3, run_cross),
    VERB("cross-by", "x|y|z VOXELS", "Move the cross-hair", 2, 2, run_cross_by),
    VERB("pick", "X Y", "Put the cross-hair on what a pixel of the scene shows", 2, 2,
         run_pick),
    VERB("zoom-slices", "F", "Magnify slices by this factor", 1, 1, run_zoom_slices),
    VERB("split", "F", "Divide a comparison at this fraction of the width", 1, 1, run_split),
};
const view_verbs view_scene_verbs = {rows, sizeof rows / sizeof *rows};
