#define _GNU_SOURCE /* strverscmp, scandir */
/* What can be done, by name: the one way in for keys, menus, widgets, the mouse and scripts. */
#include "cli/view/view.h"

#include "cli/quantity.h"
#include "cli/template.h"
#include "core/status.h"
#include "core/text.h"
#include "viewer/transfer_edit.h"

#include <dirent.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* Numbers out of words. */
static cw_status take(const char *verb, char **args, int count, double *numbers, cw_error *err)
{
    for (int n = 0; n < count; n++) {
        const char *text = args[n];
        if (!cwi_parse_double(&text, &numbers[n]) || *text || !isfinite(numbers[n]))
            return cw_fail(err, CW_ERR_ARGUMENT, "%s '%s': a number was expected", verb,
                           args[n]);
    }
    return CW_OK;
}

static cw_status need_open(const view *v, cw_error *err)
{
    return v->path ? CW_OK : cw_fail(err, CW_ERR_ARGUMENT, "nothing is open");
}

static cw_status need_volume(const view *v, cw_error *err)
{
    return v->has_volume ? CW_OK
                         : cw_fail(err, CW_ERR_ARGUMENT, "no volume on an even grid is open");
}

/* files and steps */

static cw_status run_open(view *v, int count, char **args, cw_error *err)
{
    (void)count;
    return view_open(v, args[0], err);
}

static cw_status run_quit(view *v, int count, char **args, cw_error *err)
{
    (void)count, (void)args, (void)err;
    v->quits = true;
    return CW_OK;
}

static int by_version(const struct dirent **a, const struct dirent **b)
{
    return strverscmp((*a)->d_name, (*b)->d_name);
}

static int is_plain(const struct dirent *e)
{
    return e->d_name[0] != '.';
}

/* What can be opened is next, in natural order and round and round. */
static cw_status open_near(view *v, int by, cw_error *err)
{
    struct dirent **list = NULL;
    const char *slash = v->path ? strrchr(v->path, '/') : NULL;
    char folder[4096] = ".", path[8192];
    cw_status st = need_open(v, err);
    if (st != CW_OK)
        return st;
    if (slash)
        snprintf(folder, sizeof folder, "%.*s", (int)(slash - v->path + 1), v->path);
    const char *own = slash ? slash + 1 : v->path;
    const int count = scandir(folder, &list, is_plain, by_version);
    int at = 0;
    while (at < count && strcmp(list[at]->d_name, own) != 0)
        at++;
    st = cw_fail(err, CW_ERR_ARGUMENT, "%s: nothing else to open beside it", v->path);
    for (int n = 1; n < count && at < count && st != CW_OK; n++) {
        struct stat info;
        cw_volume shape = {0};
        const char *name = list[((at + by * n) % count + count) % count]->d_name;
        snprintf(path, sizeof path, slash ? "%s%s" : "%.0s%s", folder, name);
        const bool readable =
            stat(path, &info) == 0 &&
            (cw_mesh_format(path, NULL) ||
             cli_read_shape(path, &v->state.args.input, &shape, NULL) == CW_OK);
        cw_volume_free(&shape);
        if (readable)
            st = view_open(v, path, err);
    }
    for (int n = 0; n < count; n++)
        free(list[n]);
    free(list);
    return st;
}

static cw_status run_next(view *v, int count, char **args, cw_error *err)
{
    (void)count, (void)args;
    return open_near(v, 1, err);
}

static cw_status run_previous(view *v, int count, char **args, cw_error *err)
{
    (void)count, (void)args;
    return open_near(v, -1, err);
}

static cw_status run_step(view *v, int count, char **args, cw_error *err)
{
    const size_t steps = v->source.series.count;
    double n = 0;
    (void)count;
    cw_status st = need_open(v, err);
    if (st != CW_OK || steps < 2)
        return st == CW_OK ? cw_fail(err, CW_ERR_ARGUMENT, "%s has no other steps", v->path)
                           : st;
    if (strcmp(args[0], "next") == 0)
        n = (double)((v->state.step + 1) % steps);
    else if (strcmp(args[0], "previous") == 0)
        n = (double)((v->state.step + steps - 1) % steps);
    else
        st = take("step", args, 1, &n, err);
    if (st == CW_OK && (n < 0 || n != floor(n)))
        return cw_fail(err, CW_ERR_ARGUMENT, "step '%s': a whole number was expected", args[0]);
    return st == CW_OK ? view_go_to_step(v, (size_t)n, err) : st;
}

/* how it is drawn */

/* The modes that what is open can be drawn in. */
static bool fits(const view *v, cw_mode mode)
{
    return mode == CW_MODE_MESH || v->has_volume;
}

static cw_status change_mode(view *v, int by, cw_error *err)
{
    int m = (int)v->mode;
    if (v->mode == CW_MODE_MESH)
        v->state.iso_is_ours = true; /* the volume comes without the surface */
    do
        m = (m + by + CW_MODE_COUNT) % CW_MODE_COUNT;
    while (!fits(v, (cw_mode)m));
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
    double share;
    char text[32];
    (void)count;
    cw_status st = need_open(v, err);
    if (st == CW_OK && v->source.is_mesh)
        st = cw_fail(err, CW_ERR_ARGUMENT, "a mesh has no isovalue");
    if (st == CW_OK)
        st = take("iso-by", args, 1, &share, err);
    if (st != CW_OK)
        return st;
    const cw_statistics *s = &v->statistics;
    const cli_number *iso = &v->state.args.iso;
    const double from = iso->given ? iso->value : view_suggest_iso(v);
    snprintf(text, sizeof text, "%.17g",
             fmin(fmax(from + share * (s->max - s->min), s->min), s->max));
    return view_set(v, "iso", text, err);
}

static cw_status run_toggle(view *v, int count, char **args, cw_error *err)
{
    bool on;
    bool *shown = view_shown_flag(v, args[0]);
    if (!view_find_flag(v, args[0], &on))
        return cw_fail(err, CW_ERR_ARGUMENT, "toggle '%s': nothing that is on or off", args[0]);
    if (count == 2 && strcmp(args[1], "on") != 0 && strcmp(args[1], "off") != 0)
        return cw_fail(err, CW_ERR_ARGUMENT, "toggle '%s': on or off was expected", args[1]);
    const bool wanted = count == 2 ? strcmp(args[1], "on") == 0 : !on;
    if (strcmp(args[0], "quad") == 0)
        return view_set(v, "layout", wanted ? "quad" : "single", err);
    if (!shown)
        return view_set(v, args[0], wanted ? "on" : "off", err);
    *shown = wanted;
    return CW_OK;
}

/* the camera */

static cw_status need_camera(view *v, cw_error *err)
{
    cw_status st = need_open(v, err);
    if (st == CW_OK && !v->state.is_placed)
        st = view_place_camera(v, NULL, err);
    view_touch(v, 1 << VIEW_SPACE);
    return st;
}

static cw_status run_orbit(view *v, int count, char **args, cw_error *err)
{
    double n[2] = {0};
    cw_status st = take("orbit", args, count, n, err);
    if (st == CW_OK)
        st = need_camera(v, err);
    return st == CW_OK ? cw_camera_orbit(&v->state.camera, n[0], n[1], err) : st;
}

static cw_status run_pan(view *v, int count, char **args, cw_error *err)
{
    double n[2];
    cw_status st = take("pan", args, count, n, err);
    if (st == CW_OK)
        st = need_camera(v, err);
    const size_t height = (size_t)fmax(1, v->parts[VIEW_SPACE].rect.height);
    return st == CW_OK ? cw_camera_pan(&v->state.camera, height, n[0], n[1], err) : st;
}

static cw_status run_dolly(view *v, int count, char **args, cw_error *err)
{
    double n;
    cw_status st = take("dolly", args, count, &n, err);
    if (st == CW_OK)
        st = need_camera(v, err);
    return st == CW_OK ? cw_camera_dolly(&v->state.camera, n, err) : st;
}

static cw_status run_roll(view *v, int count, char **args, cw_error *err)
{
    double n;
    cw_status st = take("roll", args, count, &n, err);
    if (st == CW_OK)
        st = need_camera(v, err);
    return st == CW_OK ? cw_camera_roll(&v->state.camera, n, err) : st;
}

static cw_status run_reset(view *v, int count, char **args, cw_error *err)
{
    (void)count, (void)args;
    v->state.slice_zoom = 1;
    view_touch(v, VIEW_ALL);
    cw_status st = view_set(v, "zoom", "default", err);
    return st == CW_OK ? view_set(v, "camera", "default", err) : st;
}

/* cuts, the cross-hair, slices */

static void start_box(view *v)
{
    cli_ranges *box = &v->state.args.scene.clip_box;
    if (box->given && box->world)
        return;
    *box = (cli_ranges){.given = true, .world = true};
    memcpy(box->low, v->box[0], sizeof box->low);
    memcpy(box->high, v->box[1], sizeof box->high);
}

static cw_status run_face(view *v, int count, char **args, cw_error *err)
{
    double n[2];
    cw_status st = take("clip-face", args, count, n, err);
    if (st == CW_OK)
        st = need_open(v, err);
    if (st != CW_OK)
        return st;
    if (!(n[0] >= 0 && n[0] <= 5 && n[0] == floor(n[0])))
        return cw_fail(err, CW_ERR_ARGUMENT, "clip-face '%s': 0 to 5 was expected", args[0]);
    start_box(v);
    cli_ranges *box = &v->state.args.scene.clip_box;
    const int axis = (int)n[0] / 2;
    const double thin = 1e-3 * (v->box[1][axis] - v->box[0][axis]);
    const double at = fmin(fmax(n[1], v->box[0][axis]), v->box[1][axis]);
    if ((int)n[0] % 2)
        box->high[axis] = fmax(at, box->low[axis] + thin);
    else
        box->low[axis] = fmin(at, box->high[axis] - thin);
    view_touch(v, 1 << VIEW_SPACE);
    return CW_OK;
}

/* 1, 2, 3 for x, y, z; else 0 */
static int axis_of(const char *word)
{
    return word[0] && !word[1] && word[0] >= 'x' && word[0] <= 'z' ? 1 + word[0] - 'x' : 0;
}

/* How far a voxel is along an axis of the world, about. */
static double voxel_mm(const view *v)
{
    double spacing[3];
    if (v->source.is_mesh)
        return (v->box[1][0] - v->box[0][0]) / 256;
    cw_volume_spacing(&v->source.volume.view, spacing);
    return fmin(fmin(spacing[0], spacing[1]), spacing[2]);
}

static cw_status run_cut(view *v, int count, char **args, cw_error *err)
{
    double voxels;
    char face[16], mm[32], *words[] = {face, mm};
    const int axis = axis_of(args[0]) - 1;
    (void)count;
    if (axis < 0)
        return cw_fail(err, CW_ERR_ARGUMENT, "cut '%s': x, y or z was expected", args[0]);
    cw_status st = take("cut", args + 1, 1, &voxels, err);
    if (st == CW_OK)
        st = need_open(v, err);
    if (st != CW_OK)
        return st;
    const cli_ranges *box = &v->state.args.scene.clip_box;
    const double from = box->given && box->world ? box->low[axis] : v->box[0][axis];
    snprintf(face, sizeof face, "%d", 2 * axis);
    snprintf(mm, sizeof mm, "%.17g", from + voxels * voxel_mm(v));
    return run_face(v, 2, words, err);
}

/* The wheel cuts along an axis, until the same is said again. */
static cw_status run_wheel_cuts(view *v, int count, char **args, cw_error *err)
{
    const int axis = axis_of(args[0]);
    (void)count;
    if (!axis)
        return cw_fail(err, CW_ERR_ARGUMENT, "wheel-cuts '%s': x, y or z was expected",
                       args[0]);
    v->shown.cut = v->shown.cut == axis ? 0 : axis;
    return CW_OK;
}

static void put_cross(view *v, const double point[3])
{
    for (int a = 0; a < 3; a++)
        v->state.cross[a] = fmin(fmax(point[a], v->box[0][a]), v->box[1][a]);
    view_touch(v, v->mode == CW_MODE_SLICES ? VIEW_ALL : VIEW_SLICES);
}

static cw_status run_cross(view *v, int count, char **args, cw_error *err)
{
    double point[3];
    cw_status st = take("cross", args, count, point, err);
    if (st == CW_OK)
        st = need_open(v, err);
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
        return cw_fail(err, CW_ERR_ARGUMENT, "cross-by '%s': x, y or z was expected", args[0]);
    cw_status st = take("cross-by", args + 1, 1, &voxels, err);
    if (st == CW_OK)
        st = need_open(v, err);
    if (st != CW_OK)
        return st;
    memcpy(point, v->state.cross, sizeof point);
    point[axis] += voxels * voxel_mm(v);
    put_cross(v, point);
    return CW_OK;
}

/* To what the mouse is on, in pixels of the 3D part. */
static cw_status run_pick(view *v, int count, char **args, cw_error *err)
{
    double pixel[2];
    cw_picked picked = {0};
    view_part *part = &v->parts[VIEW_SPACE];
    cw_status st = take("pick", args, count, pixel, err);
    if (st == CW_OK)
        st = need_open(v, err);
    if (st == CW_OK && (part->level == VIEW_STALE || v->state.args.compare))
        return CW_OK; /* nothing to be seen yet, or two things */
    if (st == CW_OK) {
        const double scale = (double)part->scene.width / fmax(part->rect.width, 1);
        const double at[2] = {pixel[0] * scale, pixel[1] * scale};
        st = cw_pick(&part->scene, at, &picked, err);
    }
    if (st == CW_OK && picked.kind != CW_PICK_NOTHING)
        put_cross(v, picked.point);
    return st;
}

static cw_status run_window(view *v, int count, char **args, cw_error *err)
{
    double n[2];
    cw_status st = take("window", args, count, n, err);
    if (st == CW_OK && !(n[0] < n[1]))
        st = cw_fail(err, CW_ERR_ARGUMENT, "window %s %s: rising values were expected", args[0],
                     args[1]);
    if (st == CW_OK)
        memcpy(v->state.window, n, sizeof n);
    view_touch(v, VIEW_SLICES);
    return st;
}

static cw_status run_zoom_slices(view *v, int count, char **args, cw_error *err)
{
    double n;
    (void)count;
    cw_status st = take("zoom-slices", args, 1, &n, err);
    if (st == CW_OK && !(n > 0))
        st = cw_fail(err, CW_ERR_ARGUMENT, "zoom-slices %s: above 0 was expected", args[0]);
    if (st == CW_OK)
        v->state.slice_zoom = fmin(fmax(n, 0.1), 100);
    view_touch(v, VIEW_SLICES);
    return st;
}

static cw_status run_split(view *v, int count, char **args, cw_error *err)
{
    double n;
    (void)count;
    cw_status st = take("split", args, 1, &n, err);
    if (st == CW_OK && !(n >= 0 && n <= 1))
        st = cw_fail(err, CW_ERR_ARGUMENT, "split %s: 0 to 1 was expected", args[0]);
    if (st == CW_OK)
        v->state.share = n;
    if (st == CW_OK && v->state.args.compare)
        view_touch(v, 1 << VIEW_SPACE);
    return st;
}

/* the transfer function */

/* What is drawn becomes the curve that is edited. */
static cw_status start_edit(view *v, cw_error *err)
{
    cli_scene *s = &v->state.args.scene;
    cw_status st = need_volume(v, err);
    if (st == CW_OK)
        st = view_need_transfer(v, err);
    if (st != CW_OK)
        return st;
    v->state.curve = v->transfer;
    v->state.is_edited = true;
    s->shift = s->opacity = (cli_number){0};
    v->transfer_is_old = true;
    view_touch(v, 1 << VIEW_SPACE);
    return CW_OK;
}

static cw_status need_point(const char *verb, double n, size_t count, cw_error *err)
{
    return n >= 0 && n < (double)count && n == floor(n)
               ? CW_OK
               : cw_fail(err, CW_ERR_ARGUMENT, "%s %g: there are points 0 to %zu", verb, n,
                         count ? count - 1 : 0);
}

static cw_status run_point(view *v, int count, char **args, cw_error *err)
{
    double n[3];
    cw_status st = take("point", args, count, n, err);
    if (st == CW_OK)
        st = need_volume(v, err);
    if (st == CW_OK)
        st = view_need_transfer(v, err);
    if (st == CW_OK)
        st = need_point("point", n[0], v->transfer.opacity_count, err);
    if (st == CW_OK)
        st = start_edit(v, err);
    if (st == CW_OK)
        cwi_transfer_move_opacity(&v->state.curve, (size_t)n[0], n[1], n[2]);
    return st;
}

static cw_status run_add_point(view *v, int count, char **args, cw_error *err)
{
    double n[2];
    cw_status st = take("add-point", args, count, n, err);
    if (st == CW_OK)
        st = start_edit(v, err);
    if (st == CW_OK &&
        cwi_transfer_insert_opacity(&v->state.curve, n[0], n[1]) == CWI_TRANSFER_NONE)
        st = cw_fail(err, CW_ERR_LIMIT, "a transfer function has %d points at most",
                     CW_TRANSFER_POINTS);
    return st;
}

static cw_status run_remove_point(view *v, int count, char **args, cw_error *err)
{
    double n;
    cw_status st = take("remove-point", args, count, &n, err);
    if (st == CW_OK)
        st = start_edit(v, err);
    if (st == CW_OK)
        st = need_point("remove-point", n, v->state.curve.opacity_count, err);
    if (st == CW_OK)
        cwi_transfer_remove_opacity(&v->state.curve, (size_t)n);
    return st;
}

static cw_status take_color(const char *text, float out[3], cw_error *err)
{
    uint8_t rgba[4];
    if (!cli_parse_color(text, rgba))
        return cw_fail(err, CW_ERR_ARGUMENT, "'%s': a colour such as #ffeedd was expected",
                       text);
    for (int c = 0; c < 3; c++)
        out[c] = (float)rgba[c] / 255;
    return CW_OK;
}

static cw_status run_color_point(view *v, int count, char **args, cw_error *err)
{
    double n;
    float color[3];
    (void)count;
    cw_status st = take("color-point", args, 1, &n, err);
    if (st == CW_OK)
        st = take_color(args[1], color, err);
    if (st == CW_OK)
        st = start_edit(v, err);
    if (st == CW_OK)
        st = need_point("color-point", n, v->state.curve.color_count, err);
    if (st == CW_OK)
        memcpy(v->state.curve.colors[(size_t)n].color, color, sizeof color);
    return st;
}

static cw_status run_move_color(view *v, int count, char **args, cw_error *err)
{
    double n[2];
    cw_status st = take("move-color", args, count, n, err);
    if (st == CW_OK)
        st = start_edit(v, err);
    if (st == CW_OK)
        st = need_point("move-color", n[0], v->state.curve.color_count, err);
    if (st == CW_OK)
        cwi_transfer_move_color(&v->state.curve, (size_t)n[0], n[1]);
    return st;
}

static cw_status run_add_color(view *v, int count, char **args, cw_error *err)
{
    double n;
    float color[3];
    (void)count;
    cw_status st = take("add-color", args, 1, &n, err);
    if (st == CW_OK)
        st = take_color(args[1], color, err);
    if (st == CW_OK)
        st = start_edit(v, err);
    if (st != CW_OK)
        return st;
    const size_t at = cwi_transfer_insert_color(&v->state.curve, n);
    if (at == CWI_TRANSFER_NONE)
        return cw_fail(err, CW_ERR_LIMIT, "a transfer function has %d points at most",
                       CW_TRANSFER_POINTS);
    memcpy(v->state.curve.colors[at].color, color, sizeof color);
    return CW_OK;
}

static cw_status run_remove_color(view *v, int count, char **args, cw_error *err)
{
    double n;
    cw_status st = take("remove-color", args, count, &n, err);
    if (st == CW_OK)
        st = start_edit(v, err);
    if (st == CW_OK)
        st = need_point("remove-color", n, v->state.curve.color_count, err);
    if (st == CW_OK)
        cwi_transfer_remove_color(&v->state.curve, (size_t)n);
    return st;
}

/* undo, saving */

static cw_status go_back(view *v, int by, cw_error *err)
{
    if (!view_undo(v, by))
        return cw_fail(err, CW_ERR_ARGUMENT, by < 0 ? "nothing to undo" : "nothing to redo");
    v->transfer_is_old = true;
    view_touch(v, VIEW_ALL);
    return view_choose_mode(v, err);
}

static cw_status run_undo(view *v, int count, char **args, cw_error *err)
{
    (void)count, (void)args;
    return go_back(v, -1, err);
}

static cw_status run_redo(view *v, int count, char **args, cw_error *err)
{
    (void)count, (void)args;
    return go_back(v, 1, err);
}

/* The first cubewright-001.png that is not there. */
static void free_name(char *name, size_t size)
{
    for (int n = 1; n < 10000; n++) {
        snprintf(name, size, "cubewright-%03d.png", n);
        if (access(name, F_OK) != 0)
            return;
    }
}

static cw_status tell_written(view *v, cw_status st, const char *path)
{
    char text[512];
    snprintf(text, sizeof text, "%.400s written", path);
    if (st == CW_OK)
        view_say(v, false, text);
    return st;
}

static cw_status need_png(const char *path, cw_error *err)
{
    const char *dot = strrchr(path, '.');
    return dot && strcmp(dot, ".png") == 0
               ? CW_OK
               : cw_fail(err, CW_ERR_ARGUMENT, "%s: pictures are written as .png", path);
}

static cw_status run_screenshot(view *v, int count, char **args, cw_error *err)
{
    char name[64];
    free_name(name, sizeof name);
    const char *path = count ? args[0] : name;
    cw_status st = need_png(path, err);
    if (st == CW_OK)
        st = view_frame(v, 0, err); /* lays out what came before */
    return st == CW_OK ? tell_written(v, view_picture(v, path, err), path) : st;
}

static cw_status run_capture(view *v, int count, char **args, cw_error *err)
{
    cw_image image = {0};
    (void)count;
    cw_status st = need_png(args[0], err);
    if (st == CW_OK)
        st = view_settle(v, err);
    if (st == CW_OK)
        st = v->ui->grab(v->window, &image, err);
    if (st == CW_OK)
        st = cw_image_write(args[0], &image, err);
    cw_image_free(&image);
    return st;
}

/* All round, and back to where it began. */
static cw_status run_turntable(view *v, int count, char **args, cw_error *err)
{
    double turns;
    char number[24], *path = NULL;
    (void)count;
    cw_status st = take("turntable", args, 1, &turns, err);
    if (st == CW_OK && !(turns >= 2 && turns <= 100000 && turns == floor(turns)))
        st = cw_fail(err, CW_ERR_ARGUMENT, "turntable %s: 2 to 100000 was expected", args[0]);
    if (st == CW_OK)
        st = need_png(args[1], err);
    if (st == CW_OK)
        st = view_frame(v, 0, err); /* lays out what came before */
    if (st == CW_OK)
        st = need_camera(v, err);
    if (st != CW_OK)
        return st;
    const cw_camera before = v->state.camera;
    for (size_t n = 0; n < (size_t)turns && st == CW_OK; n++) {
        snprintf(number, sizeof number, "%zu", n);
        cli_part part = {"turn", number, true, false};
        st = cli_fill_template(args[1], &part, 1, &path, err);
        if (st == CW_OK && !part.used)
            st = cw_fail(
                err, CW_ERR_ARGUMENT,
                "turntable '%s': the name must hold {turn}, as in 'turn-{turn:03d}.png'",
                args[1]);
        if (st == CW_OK)
            st = view_picture(v, path, err);
        free(path);
        path = NULL;
        if (st == CW_OK)
            st = cw_camera_orbit(&v->state.camera, 360 / turns, 0, err);
    }
    v->state.camera = before;
    view_touch(v, 1 << VIEW_SPACE);
    return tell_written(v, st, args[1]);
}

static cw_status run_save_state(view *v, int count, char **args, cw_error *err)
{
    const char *path = count ? args[0] : "cubewright-state.txt";
    return tell_written(v, view_write_state(v, path, err), path);
}

static cw_status run_save_tf(view *v, int count, char **args, cw_error *err)
{
    (void)count;
    cw_status st = need_volume(v, err);
    if (st == CW_OK)
        st = view_need_transfer(v, err);
    if (st == CW_OK)
        st = cw_transfer_write(args[0], &v->transfer, err);
    return tell_written(v, st, args[0]);
}

static cw_status run_save_camera(view *v, int count, char **args, cw_error *err)
{
    (void)count;
    cw_status st = need_camera(v, err);
    if (st == CW_OK)
        st = cw_camera_write(args[0], &v->state.camera, err);
    return tell_written(v, st, args[0]);
}

static cw_status run_run(view *v, int count, char **args, cw_error *err)
{
    (void)count; /* a file may run others, but not itself for ever */
    if (v->depth >= 8)
        return cw_fail(err, CW_ERR_LIMIT, "run %s: files that run files, 8 deep", args[0]);
    v->depth++;
    cw_status st = view_exec_file(v, args[0], err);
    v->depth--;
    return st;
}

static cw_status run_copy_command(view *v, int count, char **args, cw_error *err)
{
    char *line = view_command_line(v);
    (void)count, (void)args;
    if (!line)
        return cw_fail(err, CW_ERR_NO_MEMORY, "no memory for a command line");
    v->ui->set_clipboard(v->window, line);
    free(line);
    view_say(v, false, "the command line is in the clipboard");
    return CW_OK;
}

/* for scripts */

static void print_setting(const view *v, const char *name)
{
    char text[CW_TRANSFER_TEXT];
    bool on;
    const cli_option *o = view_find_option(v, name);
    if (view_find_flag(v, name, &on))
        printf("%s %s\n", name, on ? "on" : "off");
    else if (o)
        printf("%s %s\n", name,
               cli_option_text(o, &v->state.args, text, sizeof text) ? text : "default");
}

static cw_status run_print(view *v, int count, char **args, cw_error *err)
{
    char text[CW_TRANSFER_TEXT];
    const view_state *s = &v->state;
    const char *what = args[0];
    bool on;
    (void)count;
    if (strcmp(what, "mode") == 0)
        printf("mode %s\n", cw_mode_name(v->mode));
    else if (strcmp(what, "open") == 0)
        printf("open %s\n", v->path ? cli_shown_path(v->path) : "nothing");
    else if (strcmp(what, "cross") == 0)
        printf("cross %.6g %.6g %.6g\n", s->cross[0], s->cross[1], s->cross[2]);
    else if (strcmp(what, "probe") == 0)
        printf("probe %s\n", v->probe);
    else if (strcmp(what, "window") == 0)
        printf("window %.6g %.6g\n", s->window[0], s->window[1]);
    else if (strcmp(what, "split") == 0)
        printf("split %.6g\n", s->share);
    else if (strcmp(what, "step") == 0)
        printf("step %zu of %zu\n", s->step, v->source.series.count);
    else if (strcmp(what, "triangles") == 0)
        printf("triangles %zu\n", v->source.mesh.triangle_count);
    else if (strcmp(what, "time") == 0)
        printf("time %.1f ms, %zu x %zu\n", v->parts[VIEW_SPACE].ms,
               v->parts[VIEW_SPACE].scene.width, v->parts[VIEW_SPACE].scene.height);
    else if (strcmp(what, "message") == 0)
        printf("message %s\n", v->message);
    else if (strcmp(what, "compare") == 0 && s->args.compare && v->is_measured)
        printf("compare %s: rmse %.3g\n", s->args.compare, v->measured.rmse);
    else if (strcmp(what, "command") == 0) {
        char *line = view_command_line(v);
        puts(line ? line : "");
        free(line);
    } else if (strcmp(what, "camera") == 0 && s->is_placed &&
               cw_camera_format(&s->camera, text, err) == CW_OK)
        printf("%s\n", text);
    else if (strcmp(what, "tf") == 0 && v->has_volume && view_need_transfer(v, err) == CW_OK &&
             cw_transfer_format(&v->transfer, text, err) == CW_OK)
        printf("%s\n", text);
    else if (view_find_option(v, what) || view_find_flag(v, what, &on))
        print_setting(v, what);
    else
        return cw_fail(err, CW_ERR_ARGUMENT, "print '%s': nothing has that name", what);
    return CW_OK;
}

static cw_status run_wait(view *v, int count, char **args, cw_error *err)
{
    (void)count, (void)args;
    return view_settle(v, err);
}

static unsigned modifiers_of(const char *word)
{
    return (strstr(word, "shift") ? CWI_UI_SHIFT : 0u) |
           (strstr(word, "ctrl") ? CWI_UI_CTRL : 0u) | (strstr(word, "alt") ? CWI_UI_ALT : 0u);
}

static int button_of(int count, char **args)
{
    for (int n = 0; n < count; n++)
        if (strcmp(args[n], "right") == 0 || strcmp(args[n], "middle") == 0)
            return args[n][0] == 'r' ? CWI_UI_RIGHT : CWI_UI_MIDDLE;
    return CWI_UI_LEFT;
}

static cw_status feed(view *v, const cwi_ui_event *event, cw_error *err)
{
    cw_status st = v->ui->feed(v->window, event, err);
    return st == CW_OK ? view_take_in(v, err) : st;
}

/* As if from outside; words behind what is needed name keys that are held. */
static cw_status feed_words(view *v, cwi_ui_kind kind, int least, int count, char **args,
                            cw_error *err)
{
    double n[2] = {0};
    cwi_ui_event event = {.kind = kind, .button = button_of(count, args)};
    cw_status st = take("input", args, least, n, err);
    for (int i = least; i < count; i++)
        event.modifiers |= modifiers_of(args[i]);
    event.x = kind == CWI_UI_WHEEL ? 0 : n[0];
    event.y = kind == CWI_UI_WHEEL ? n[0] : n[1];
    return st == CW_OK ? feed(v, &event, err) : st;
}

static cw_status run_mouse(view *v, int count, char **args, cw_error *err)
{
    return feed_words(v, CWI_UI_MOVE, 2, count, args, err);
}

static cw_status run_press(view *v, int count, char **args, cw_error *err)
{
    return feed_words(v, CWI_UI_PRESS, 0, count, args, err);
}

static cw_status run_lift(view *v, int count, char **args, cw_error *err)
{
    return feed_words(v, CWI_UI_LIFT, 0, count, args, err);
}

/* All at once: frames between them may take longer than people do. */
static cw_status run_twice(view *v, int count, char **args, cw_error *err)
{
    cw_status st = CW_OK;
    (void)count, (void)args;
    for (int n = 0; n < 4 && st == CW_OK; n++)
        st = v->ui->feed(v->window, &(cwi_ui_event){.kind = n % 2 ? CWI_UI_LIFT : CWI_UI_PRESS},
                         err);
    return st == CW_OK ? view_take_in(v, err) : st;
}

static cw_status run_wheel(view *v, int count, char **args, cw_error *err)
{
    return feed_words(v, CWI_UI_WHEEL, 1, count, args, err);
}

static cw_status run_resize(view *v, int count, char **args, cw_error *err)
{
    double n[2];
    cw_status st = take("resize", args, count, n, err);
    if (st == CW_OK && !(n[0] >= 1 && n[1] >= 1 && n[0] <= 8192 && n[1] <= 8192))
        st = cw_fail(err, CW_ERR_ARGUMENT, "resize %s %s: 1 to 8192 was expected", args[0],
                     args[1]);
    return st == CW_OK
               ? feed(v, &(cwi_ui_event){.kind = CWI_UI_RESIZE, .x = n[0], .y = n[1]}, err)
               : st;
}

static cw_status run_key(view *v, int count, char **args, cw_error *err)
{
    (void)count;
    return feed(v, &(cwi_ui_event){.kind = CWI_UI_KEY, .text = args[0]}, err);
}

static cw_status run_write(view *v, int count, char **args, cw_error *err)
{
    (void)count;
    return feed(v, &(cwi_ui_event){.kind = CWI_UI_WRITE, .text = args[0]}, err);
}

static cw_status run_drop(view *v, int count, char **args, cw_error *err)
{
    (void)count;
    return feed(v, &(cwi_ui_event){.kind = CWI_UI_DROP, .text = args[0]}, err);
}

/* Where a widget is once it moves no more: what came just now may still be laid out. */
static cw_status find_widget(view *v, const char *label, cwi_ui_rect *r, cw_error *err)
{
    enum { MOST_FRAMES = 8 };
    cwi_ui_rect before = {0};
    bool is_there = false;
    for (int n = 0; n < MOST_FRAMES; n++) {
        cw_status st = view_frame(v, 0, err);
        if (st != CW_OK)
            return st;
        is_there = v->ui->find(v->window, label, r);
        if (is_there && memcmp(&before, r, sizeof before) == 0)
            return CW_OK;
        before = *r;
    }
    return is_there ? CW_OK : cw_fail(err, CW_ERR_ARGUMENT, "nothing is labelled '%s'", label);
}

static cw_status run_place(view *v, int count, char **args, cw_error *err)
{
    cwi_ui_rect r = {0};
    (void)count;
    cw_status st = find_widget(v, args[0], &r, err);
    if (st == CW_OK)
        printf("place %g %g %g %g\n", r.x, r.y, r.width, r.height);
    return st;
}

/* Goes to a place of a widget, told as shares of its size. */
static cw_status go_to(view *v, const char *label, double x, double y, cw_error *err)
{
    cwi_ui_rect r = {0};
    cw_status st = find_widget(v, label, &r, err);
    if (st != CW_OK)
        return st;
    return feed(
        v,
        &(cwi_ui_event){.kind = CWI_UI_MOVE, .x = r.x + x * r.width, .y = r.y + y * r.height},
        err);
}

static cw_status run_point_at(view *v, int count, char **args, cw_error *err)
{
    double n[2] = {0.5, 0.5};
    cw_status st = take("point-at", args + 1, count - 1, n, err);
    return st == CW_OK ? go_to(v, args[0], n[0], n[1], err) : st;
}

static cw_status run_click(view *v, int count, char **args, cw_error *err)
{
    cw_status st = run_point_at(v, count, args, err);
    if (st == CW_OK)
        st = run_press(v, 0, NULL, err);
    return st == CW_OK ? run_lift(v, 0, NULL, err) : st;
}

/* Something like a person without an aim: for finding what breaks. */
static cw_status run_monkey(view *v, int count, char **args, cw_error *err)
{
    double n[2] = {0};
    cw_status st = take("monkey", args, count, n, err);
    if (st == CW_OK && !(n[0] >= 0 && n[0] <= 1e15 && n[1] >= 0 && n[1] <= 1e9))
        st = cw_fail(err, CW_ERR_ARGUMENT, "monkey %s %s: a seed and a number were expected",
                     args[0], args[1]);
    uint64_t seed = st == CW_OK ? (uint64_t)n[0] : 0;
    v->is_monkey = true;
    for (size_t k = 0; st == CW_OK && k < (size_t)n[1] && !v->quits; k++)
        st = view_monkey(v, &seed, err);
    v->is_monkey = false;
    return st;
}

/* The monkey finds neither files to write nor others to open, nor the way out: not by keys, not
 * by menus. */
static bool may_run(const view *v, const char *name)
{
    static const char *const barred[] = {"screenshot", "save-state", "quit", "next",
                                         "previous"};
    for (size_t n = 0; v->is_monkey && n < sizeof barred / sizeof *barred; n++)
        if (strcmp(name, barred[n]) == 0)
            return false;
    return true;
}

#define VERB(name, takes, about, least, most, run)                                             \
    {                                                                                          \
        name, takes, about, least, most, false, run                                            \
    }
#define EDIT(name, takes, about, least, most, run)                                             \
    {                                                                                          \
        name, takes, about, least, most, true, run                                             \
    }

const view_verb view_verbs[] = {
    VERB("open", "PATH", "open a file or a folder", 1, 1, run_open),
    VERB("next", "", "the next file in the folder", 0, 0, run_next),
    VERB("previous", "", "the one before", 0, 0, run_previous),
    VERB("step", "N|next|previous", "a step of a time series", 1, 1, run_step),
    VERB("next-mode", "", "draw in the next mode", 0, 0, run_next_mode),
    VERB("previous-mode", "", "and in the one before", 0, 0, run_previous_mode),
    EDIT("next-preset", "", "the next transfer function", 0, 0, run_next_preset),
    EDIT("iso-by", "SHARE", "move the isovalue, by a share of all values", 1, 1, run_iso_by),
    EDIT("toggle", "NAME [on|off]",
         "switch a setting, or panels, files, help, handles, cross, playing, about", 1, 2,
         run_toggle),
    VERB("orbit", "RIGHT [UP]", "the eye goes round, in degrees", 1, 2, run_orbit),
    VERB("pan", "RIGHT DOWN", "what is seen moves, in pixels", 2, 2, run_pan),
    VERB("dolly", "F", "the eye comes nearer: so many times as large", 1, 1, run_dolly),
    VERB("roll", "DEG", "what is seen turns clockwise", 1, 1, run_roll),
    VERB("reset", "", "see all of it again", 0, 0, run_reset),
    EDIT("cut", "x|y|z VOXELS", "cut the low side of an axis, so much further", 2, 2, run_cut),
    EDIT("clip-face", "N MM", "move a face of the clip box: 0 to 5 for x, x, y, y, z, z", 2, 2,
         run_face),
    VERB("wheel-cuts", "x|y|z", "the wheel cuts along an axis", 1, 1, run_wheel_cuts),
    VERB("cross", "X Y Z", "put the cross-hair somewhere, in LPS mm", 3, 3, run_cross),
    VERB("cross-by", "x|y|z VOXELS", "move it", 2, 2, run_cross_by),
    VERB("pick", "X Y", "put it on what is seen at a pixel of the scene", 2, 2, run_pick),
    EDIT("window", "LOW HIGH", "what is black and what white in slices", 2, 2, run_window),
    VERB("zoom-slices", "F", "slices so many times as large", 1, 1, run_zoom_slices),
    VERB("split", "SHARE", "where a comparison is divided", 1, 1, run_split),
    EDIT("point", "N VALUE OPACITY", "move a point of the opacities", 3, 3, run_point),
    EDIT("add-point", "VALUE OPACITY", "put one in", 2, 2, run_add_point),
    EDIT("remove-point", "N", "take one out", 1, 1, run_remove_point),
    EDIT("color-point", "N COLOR", "change a colour", 2, 2, run_color_point),
    EDIT("move-color", "N VALUE", "move one", 2, 2, run_move_color),
    EDIT("add-color", "VALUE COLOR", "put one in", 2, 2, run_add_color),
    EDIT("remove-color", "N", "take one out", 1, 1, run_remove_color),
    VERB("undo", "", "take back the last change", 0, 0, run_undo),
    VERB("redo", "", "and make it after all", 0, 0, run_redo),
    VERB("screenshot", "[FILE]", "write the picture as a .png", 0, 1, run_screenshot),
    VERB("capture", "FILE", "write the whole window as a .png", 1, 1, run_capture),
    VERB("turntable", "N FILE", "write N pictures all round; FILE holds {turn}", 2, 2,
         run_turntable),
    VERB("save-state", "[FILE]", "write the session, as commands", 0, 1, run_save_state),
    VERB("save-tf", "FILE", "write the transfer function", 1, 1, run_save_tf),
    VERB("save-camera", "FILE", "write the camera", 1, 1, run_save_camera),
    VERB("run", "FILE", "do what is written in a file", 1, 1, run_run),
    VERB("copy-command", "", "copy the session as a command line", 0, 0, run_copy_command),
    VERB("quit", "", "close the window", 0, 0, run_quit),
    VERB("wait", "", "until the picture is as good as asked for", 0, 0, run_wait),
    VERB("print", "NAME", "print a setting, or mode, open, cross, probe, command, ...", 1, 1,
         run_print),
    VERB("mouse", "X Y [KEYS]", "as if the mouse went there; KEYS such as ctrl are held", 2, 3,
         run_mouse),
    VERB("press", "[BUTTON] [KEYS]", "a button goes down: left, right, middle", 0, 2,
         run_press),
    VERB("lift", "[BUTTON] [KEYS]", "and up", 0, 2, run_lift),
    VERB("twice", "", "a double click of the left one", 0, 0, run_twice),
    VERB("wheel", "LINES [KEYS]", "the wheel turns", 1, 2, run_wheel),
    VERB("key", "NAME", "a key, such as M, F12 or Ctrl+Z", 1, 1, run_key),
    VERB("write", "TEXT", "type into a widget", 1, 1, run_write),
    VERB("drop", "PATH", "a file is dropped on the window", 1, 1, run_drop),
    VERB("resize", "W H", "the window changes its size", 2, 2, run_resize),
    VERB("place", "LABEL", "print where a widget is: x, y, width, height", 1, 1, run_place),
    VERB("point-at", "LABEL [X Y]", "the mouse goes to a widget, X and Y are shares of it", 1,
         3, run_point_at),
    VERB("click", "LABEL [X Y]", "and clicks on it", 1, 3, run_click),
    VERB("monkey", "SEED N", "N random inputs", 2, 2, run_monkey),
};
const size_t view_verb_count = sizeof view_verbs / sizeof *view_verbs;

static const view_verb *find_verb(const char *name)
{
    for (size_t n = 0; n < view_verb_count; n++)
        if (strcmp(view_verbs[n].name, name) == 0)
            return &view_verbs[n];
    return NULL;
}

static cw_status fail_unknown(const view *v, const char *name, cw_error *err)
{
    const char *names[128] = {0};
    size_t count = 0;
    for (size_t n = 0; n < view_verb_count; n++)
        names[count++] = view_verbs[n].name;
    for (size_t n = 0; n < v->command->option_count && count < 127; n++)
        if (view_find_option(v, v->command->options[n].name))
            names[count++] = v->command->options[n].name;
    const char *nearest = cli_nearest(name, names);
    return nearest ? cw_fail(err, CW_ERR_ARGUMENT, "'%s' is no command; did you mean '%s'?",
                             name, nearest)
                   : cw_fail(err, CW_ERR_ARGUMENT,
                             "'%s' is no command; 'cubewright help view' lists them", name);
}

cw_status view_run(view *v, int count, char **words, cw_error *err)
{
    const view_verb *verb = find_verb(words[0]);
    const bool is_setting = !verb && view_find_option(v, words[0]);
    if (!verb && !is_setting)
        return fail_unknown(v, words[0], err);
    const int least = verb ? verb->least : 0, most = verb ? verb->most : 1;
    if (count - 1 < least || count - 1 > most)
        return cw_fail(err, CW_ERR_ARGUMENT, "%s takes %s, not %d words", words[0],
                       verb ? verb->takes : "one value", count - 1);
    if (!may_run(v, words[0]))
        return CW_OK;
    cw_status st = verb ? verb->run(v, count - 1, words + 1, err)
                        : view_set(v, words[0], count > 1 ? words[1] : NULL, err);
    if (st == CW_OK && v->path && (is_setting || verb->changes))
        view_remember(v, words[0]);
    return st;
}
