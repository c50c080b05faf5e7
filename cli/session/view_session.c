/* Opens and closes the file of a session, goes to its steps, and chooses mode, isovalue,
 * camera and transfer function for it. */
#define _GNU_SOURCE /* strdup */
#include "cli/inputs/level_choice.h"
#include "cli/session/view.h"

#include "cli/framework/console.h"
#include "cli/inputs/extract_surface.h"
#include "cli/inputs/mesh_input.h"
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/vec3.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void view_touch(view *v, unsigned parts)
{
    for (int p = 0; p < VIEW_PARTS; p++)
        if (parts >> p & 1)
            v->picture.parts[p].level = VIEW_STALE;
}

void view_clip_box(const view *v, double box[2][3])
{
    const cli_ranges *c = &v->state.args.scene.clip_box;
    const bool is_set = c->given && c->world;
    memcpy(box[0], is_set ? c->low : v->document.box[0], sizeof box[0]);
    memcpy(box[1], is_set ? c->high : v->document.box[1], sizeof box[1]);
}

void view_grey_range(const view *v, double range[2])
{
    const double *w = v->state.window;
    cw_transfer greys;
    range[0] = w[0];
    range[1] = w[1];
    if (w[0] == 0 && w[1] == 0 &&
        cw_transfer_preset("window", &v->document.statistics, &greys, NULL) == CW_OK) {
        range[0] = greys.colors[0].value;
        range[1] = greys.colors[greys.color_count - 1].value;
    }
}

bool view_draws_volume(const view *v)
{
    return v->document.has_volume && v->picture.mode != CW_MODE_MESH;
}

bool view_fits_mode(const view *v, cw_mode mode)
{
    return mode == CW_MODE_MESH ||
           (v->document.has_volume && cw_mode_draws(mode, cli_drawn(&v->document.source)));
}

bool view_has_mesh(const view *v)
{
    const render_args *args = &v->state.args;
    return v->document.path && args->scene.hide != CLI_HIDE_MESH &&
           (v->document.source.is_mesh || args->iso.given || args->mesh ||
            (view_shows_surfaces(v) && v->picture.mode == CW_MODE_MESH));
}

static void drop_surface(view *v)
{
    view_surface *surface = &v->document.surface;
    view_hide_pieces(v);
    cw_extractor_free(surface->extractor);
    cw_extractor_free(surface->coarse);
    v->document.labels.has_scene = v->document.labels.has_mesh = false;
    cw_volume_free(&surface->thinned);
    surface->extractor = surface->coarse = NULL;
    surface->level = 0;
    surface->is_live = surface->refuses_live = false;
}

void view_close(view *v)
{
    drop_surface(v);
    view_forget_labels(v);
    v->document.labels.note[0] = '\0';
    cw_mesh_free(&v->document.surface.old_mesh);
    cw_statistics_free(&v->document.statistics);
    cli_close_source(&v->document.source);
    if (v->picture.renderer)
        cw_renderer_forget(v->picture.renderer);
    for (size_t n = 0; n < v->document.file_count; n++)
        free(v->document.files[n]);
    free(v->document.files);
    v->document.files = NULL;
    v->document.path = NULL;
    v->state.measure_count = v->measuring.tool_count = 0;
    v->document.file_count = 0;
    v->document.has_volume = false;
}

/* Suggests an isovalue: between the two classes of values; for a level set 0. */
double view_suggest_iso(const view *v)
{
    return v->document.source.is_level_set ? 0 : v->document.level;
}

/* Chooses the mode, by the input where none was requested, and an isovalue for meshes. */
cw_status view_choose_mode(view *v, cw_error *err)
{
    render_args *args = &v->state.args;
    const int requested = args->scene.mode;
    view_choose_labels(v);
    v->picture.mode = requested                ? (cw_mode)(requested - 1)
                      : view_shows_surfaces(v) ? CW_MODE_MESH
                      : v->document.has_volume && !v->document.source.is_level_set &&
                              (!args->iso.given || v->state.iso_is_ours)
                          ? cli_default_mode(&v->document.source)
                          : CW_MODE_MESH;
    if (args->scene.hide == CLI_HIDE_VOLUME)
        v->picture.mode = CW_MODE_MESH;
    if (v->document.path && !view_fits_mode(v, v->picture.mode))
        return cwi_fail(err, CW_ERR_ARGUMENT, "the mode %s draws volumes on even grids; %s",
                        cw_mode_name(v->picture.mode),
                        v->document.source.is_mesh ? "this is a mesh"
                        : v->document.has_volume   ? "vbuffer draws this one"
                                                   : "this grid is shown as surfaces");
    if ((v->picture.mode != CW_MODE_MESH || view_shows_surfaces(v)) && v->state.iso_is_ours) {
        args->iso = (cli_number){0};
        v->state.iso_is_ours = false;
    }
    if (view_shows_surfaces(v))
        return CW_OK;
    if (v->document.path && v->picture.mode == CW_MODE_MESH && !v->document.source.is_mesh &&
        !args->mesh && !args->iso.given) {
        args->iso = (cli_number){.given = true, .value = view_suggest_iso(v)};
        v->state.iso_is_ours = true;
    }
    return CW_OK;
}

/* Volumes that cannot be drawn still have surfaces. */
static cw_status read_step(view *v, size_t step, cw_error *err)
{
    cli_source *s = &v->document.source;
    cw_error why = {0};
    drop_surface(v);
    v->document.has_volume = false;
    if (s->is_mesh)
        return CW_OK;
    cw_status st = cli_read_step(s, &v->state.args.input, step, err);
    if (st == CW_OK && !v->document.statistics.bins) {
        st = cli_find_statistics(s, &v->state.args.input, step, CLI_TRANSFER_BINS,
                                 &v->document.statistics, err);
        v->document.level = cli_class_level(&v->document.statistics);
        if (st == CW_OK)
            st = view_look_for_labels(v, err);
    }
    if (st == CW_OK)
        st = cli_choose_level(&s->volume, &v->state.args.input, &v->state.args.iso, err);
    if (st != CW_OK)
        return st;
    v->document.has_volume = cli_need_drawable(s, &v->state.args.input, &why) == CW_OK;
    if (!v->document.has_volume)
        cli_say("shown as a surface: %s", why.message);
    v->picture.values_come = v->picture.transfer_is_old = true;
    v->picture.thumbs = 0;
    for (int m = 0; m < CW_MODE_COUNT; m++)
        v->picture.mode_error[m] = -1;
    return CW_OK;
}

static cw_status read_beside(view *v, cw_error *err)
{
    cli_mesh file;
    const char *path = v->state.args.mesh;
    if (!path || v->document.source.is_mesh)
        return CW_OK;
    cw_status st = cli_read_reference(path, NULL, &v->state.args.input, &file, err);
    v->document.source.mesh = file.mesh;
    return st;
}

/* Steps of a file are a series without being asked for. */
static cw_status open_as(view *v, const char **paths, size_t count, cw_error *err)
{
    const cli_common common = {.inputs = paths, .input_count = count};
    const cli_input *input = &v->state.args.input;
    cli_steps steps = v->state.args.steps;
    cw_volume shape;
    if (!steps.given && input->step == 0 && count == 1 &&
        cli_read_shape(paths[0], input, &shape, NULL) == CW_OK) {
        steps.given = steps.all = shape.steps > 1;
        cw_volume_free(&shape);
    }
    return cli_open_source(&v->document.source, &common, input, &steps, true, err);
}

/* Of several series in one folder that with the most images, unless one was asked for. */
static void choose_series(view *v)
{
    char text[256];
    cw_series *list = NULL;
    size_t count = 0, max_count = 0;
    const cw_read_desc desc = cli_read_desc(v->document.path, &v->state.args.input);
    if (desc.series || cw_series_list(v->document.path, &desc, &list, &count, NULL) != CW_OK)
        return;
    for (size_t n = 0; n < count; n++)
        max_count = list[n].images > list[max_count].images ? n : max_count;
    if (count > 1) {
        v->state.args.input.series = view_keep_text(v, list[max_count].label);
        snprintf(text, sizeof text, "one of %zu series: %s, of %zu images; --series chooses",
                 count, list[max_count].label, list[max_count].images);
        view_say(v, false, text);
    }
    cw_series_free(list);
}

/* Several files are steps; so are those in a folder that is no volume itself, if they agree. */
static cw_status open_source(view *v, cw_error *err)
{
    char pattern[4096];
    const char *all[] = {pattern};
    cw_status st = open_as(v, (const char **)v->document.files, v->document.file_count, err);
    if (st != CW_OK || v->document.file_count > 1 || !cli_is_folder(v->document.path))
        return st;
    cw_volume shape = {0};
    st = cli_read_shape(v->document.path, &v->state.args.input, &shape, err);
    cw_volume_free(&shape);
    if (st == CW_OK)
        return CW_OK;
    snprintf(pattern, sizeof pattern, "%.4000s/*", v->document.path);
    cli_close_source(&v->document.source);
    return open_as(v, all, 1, NULL) == CW_OK ? CW_OK : st;
}

static void fresh_look(view *v)
{
    double(*box)[3] = v->document.box;
    if (!cli_find_box(v->document.has_volume ? cli_drawn(&v->document.source) : NULL,
                      v->document.source.mesh.triangle_count ? &v->document.source.mesh : NULL,
                      box))
        memset(box, 0, sizeof v->document.box);
    cwi_midpoint(box[0], box[1], v->state.cross);
    v->state.is_placed = false;
    view_touch(v, VIEW_ALL);
}

static cw_status open_path(view *v, cw_error *err)
{
    v->document.opening = v->document.path;
    const char *series = v->state.args.input.series;
    choose_series(v);
    cw_status st = open_source(v, err);
    v->document.source.of_labels = v->document.source.is_label_map || v->state.args.look.labels;
    if (st == CW_OK)
        st = read_step(v, v->state.step, err);
    v->document.opening = NULL;
    v->state.args.input.series = series; /* which is not for what is opened next */
    if (st == CW_OK)
        st = read_beside(v, err);
    if (st == CW_OK)
        st = view_choose_mode(v, err);
    if (st == CW_OK && view_shows_surfaces(v) && !v->state.args.look.labels)
        cli_say("%s: %s: its labels are drawn; --mode composite draws its numbers",
                v->document.path, v->document.labels.note);
    return st == CW_OK ? view_need_labels(v, err) : st;
}

/* Resets the settings that suited another file only: its levels and positions. */
static void forget_look(view *v)
{
    view_state *s = &v->state;
    if (!v->history.count)
        return; /* the first file: what the command line says is for it */
    s->args.iso = (cli_number){0};
    s->args.scene.clip_box = (cli_ranges){0};
    s->args.scene.clips = s->args.scene.planes = NULL;
    s->args.scene.shift = (cli_number){0};
    s->args.look = (cli_label_look){0};
    s->args.overlay = NULL;
    s->args.values = (cli_value_look){0};
    s->args.overlay_opacity = (cli_number){0};
    s->args.scene.tint_range = (cli_numbers){0};
    s->is_edited = false;
    s->window[0] = s->window[1] = 0;
    s->step = 0;
    if (s->args.scene.mode == 1 + CW_MODE_MESH)
        s->args.scene.mode = 0;
}

/* Fails for a file that cannot be read, so that the file that is open stays open. */
static cw_status expect_readable(const view *v, const char *path, cw_error *err)
{
    cw_volume shape = {0};
    if (!v->document.path || cli_is_folder(path) || cw_mesh_format(path, NULL))
        return CW_OK;
    cw_status st = cli_read_shape(path, &v->state.args.input, &shape, err);
    cw_volume_free(&shape);
    return st;
}

/* Sets the title of the window, such as "head.nii.gz - cubewright". */
static void name_window(view *v)
{
    char title[256];
    snprintf(title, sizeof title, "%.200s%scubewright",
             v->document.path ? cli_shown_path(v->document.path) : "",
             v->document.path ? " - " : "");
    v->ui->set_title(v->window, title);
}

/* Copies the paths: they may be of what is closed. */
static cw_status copy_paths(const char *const *paths, size_t count, char ***copies,
                            cw_error *err)
{
    char **all = calloc(count, sizeof *all);
    bool is_whole = all;
    for (size_t n = 0; n < count && is_whole; n++)
        is_whole = (all[n] = strdup(paths[n]));
    *copies = all;
    if (is_whole)
        return CW_OK;
    for (size_t n = 0; n < count && all; n++)
        free(all[n]);
    free(all);
    return cwi_fail_memory(err);
}

cw_status view_open(view *v, const char *const *paths, size_t count, cw_error *err)
{
    char **copies;
    cw_status st = expect_readable(v, paths[0], err);
    if (st == CW_OK)
        st = copy_paths(paths, count, &copies, err);
    if (st != CW_OK)
        return st;
    v->message.text[0] = '\0'; /* it was of another file */
    view_close(v);
    forget_look(v);
    v->document.files = copies;
    v->document.file_count = count;
    v->document.path = copies[0];
    st = open_path(v, err);
    if (st != CW_OK && v->state.args.scene.mode && v->document.path &&
        !view_fits_mode(v, (cw_mode)(v->state.args.scene.mode - 1)) &&
        (v->document.source.is_mesh || v->document.source.volume.voxels.data)) {
        if (v->document.has_volume)
            cli_say("%s", err->message);
        v->state.args.scene.mode = 0; /* it was another file's */
        st = view_choose_mode(v, err);
    }
    if (st != CW_OK)
        view_close(v);
    fresh_look(v);
    name_window(v);
    v->history.count = v->cameras.count = 0;
    if (st != CW_OK)
        return st;
    view_remember(v, "open");
    view_remember_file(v);
    return CW_OK;
}

cw_status view_go_to_step(view *v, size_t step, cw_error *err)
{
    if (!v->document.path || step >= v->document.source.series.count)
        return cwi_fail(err, CW_ERR_ARGUMENT, "step %zu: there are 0 to %zu", step,
                        v->document.source.series.count ? v->document.source.series.count - 1
                                                        : 0);
    cw_status st = read_step(v, step, err);
    if (st == CW_OK)
        v->state.step = step;
    view_touch(v, VIEW_ALL);
    return st;
}

/* The transfer function of the scene, as edited or out of the settings. */
cw_status view_need_transfer(view *v, cw_error *err)
{
    cw_status st = CW_OK;
    if (!v->document.has_volume || !v->picture.transfer_is_old)
        return CW_OK;
    if (v->state.is_edited) {
        v->picture.transfer = v->state.curve;
        st = cli_change_transfer(&v->state.args.scene, &v->picture.transfer, err);
    } else {
        st = cli_fit_transfer(&v->state.args.scene, cli_drawn(&v->document.source),
                              v->picture.mode, &v->document.statistics, &v->picture.transfer,
                              err);
    }
    v->picture.transfer_is_old = st != CW_OK;
    return st;
}

cw_status view_place_camera(view *v, const char *name, cw_error *err)
{
    static const cli_turns one = {0};
    const view_part *space = &v->picture.parts[VIEW_SPACE];
    const double aspect = space->rect.height > 0 ? space->rect.width / space->rect.height : 1.6;
    cli_scene scene = v->state.args.scene;
    cw_camera camera;
    double box[2][3];
    bool found = false;
    const bool moves = v->document.source.series.count > 1;
    if (name)
        scene.camera = name;
    cw_status st = cli_check_camera(&scene, &one, err);
    if (st == CW_OK && view_draws_volume(v))
        st = view_need_transfer(v, err);
    if (st == CW_OK && !(moves && view_draws_volume(v)))
        st = cli_find_seen_box(view_draws_volume(v) ? cli_drawn(&v->document.source) : NULL,
                               view_has_mesh(v) ? &v->document.source.mesh : NULL,
                               v->picture.mode, &v->picture.transfer,
                               (int)v->state.args.input.threads, box, &found, err);
    if (!found)
        memcpy(box, v->document.box, sizeof box);
    if (st == CW_OK)
        st = cli_find_camera(&scene, &one, 0, (const double(*)[3])box, aspect, &camera, err);
    if (st != CW_OK)
        return st;
    v->state.camera = camera;
    v->state.is_placed = true;
    if (!v->film.is_running)
        view_note_camera(v, "place");
    view_touch(v, 1 << VIEW_SPACE);
    return CW_OK;
}
