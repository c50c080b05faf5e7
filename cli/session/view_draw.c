/* Pictures of the parts, roughly while things move and better when they rest. */
#include "cli/session/view_measure.h"

#include "cli/framework/console.h"
#include "cli/inputs/extract_surface.h"
#include "cli/render/compare_options.h"
#include "cli/render/slice_caption.h"
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/vec3.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    THIN_FROM = 96,
    ROUGH_MS = 70,
    ROUGH_SPLATS = 20000,
    FEW_TRIANGLES = 200000,
    LETTER_PX = 9
};

/* Stops a picture that nobody will look at. */
static bool go_on(void *user, const char *step, double done)
{
    view *v = user;
    (void)step;
    (void)done;
    return !v->ui->pending(v->window) && !cli_interrupted();
}

/* A coarser extractor beside the full one, for surfaces that move. */
static cw_status need_extractor(view *v, bool coarse, cw_error *err)
{
    view_surface *surface = &v->document.surface;
    const cw_volume *whole = &v->document.source.volume.view;
    cw_extractor **e = coarse ? &surface->coarse : &surface->extractor;
    if (*e)
        return CW_OK;
    if (coarse) {
        const size_t two[3] = {2, 2, 2};
        cw_volume_free(&surface->thinned);
        cw_status st = cw_volume_coarsen(whole, two, &surface->thinned, err);
        if (st != CW_OK)
            return st;
    }
    return cw_extractor_new(coarse ? &surface->thinned : whole, e, err);
}

static bool can_thin(const view *v)
{
    const cw_volume *w = &v->document.source.volume.view;
    return !w->sparse && !w->cells && !w->coordinates[0] && w->dim[0] >= THIN_FROM &&
           w->dim[1] >= THIN_FROM && w->dim[2] >= THIN_FROM;
}

/* The surface at the isovalue: of many triangles another one, a quarter of them, is made faster
 * than they are drawn. Empty where it crosses nothing. */
cw_status view_need_surface(view *v, view_level level, cw_error *err)
{
    view_surface *surface = &v->document.surface;
    const render_args *args = &v->state.args;
    const bool coarse = level == VIEW_ROUGH && v->state.is_placed && can_thin(v);
    cw_mesh mesh = {0};
    if (view_shows_surfaces(v) && v->picture.mode == CW_MODE_MESH) {
        view_hide_pieces(v);
        return view_need_label_mesh(v, err);
    }
    const bool is_there =
        surface->iso == args->iso.value &&
        (surface->level == (coarse ? 1 : 2) ||
         (surface->level == 2 && v->document.source.mesh.triangle_count <= FEW_TRIANGLES));
    if (v->document.source.is_mesh || !args->iso.given || is_there ||
        (v->document.pieces.are_shown && surface->iso == args->iso.value))
        return CW_OK;
    view_hide_pieces(v);
    const cw_extract_desc desc = {
        .isovalue = args->iso.value,
        .inside_is_low = cli_inside_is_low(args->inside, &v->document.source.volume.whole),
        .threads = (int)args->input.threads,
        .max_bytes = v->document.source.volume.memory_left};
    cw_status st = need_extractor(v, coarse, err);
    if (st != CW_OK)
        return st;
    cw_extractor *extractor = coarse ? surface->coarse : surface->extractor;
    if (surface->is_drawn)
        cw_extractor_recycle(extractor, &surface->old_mesh);
    st = cw_extractor_extract(extractor, &desc, &mesh, NULL, err);
    if (st != CW_OK)
        return st;
    if (surface->is_drawn)
        surface->old_mesh = v->document.source.mesh;
    else
        cw_mesh_free(&v->document.source.mesh);
    surface->is_drawn = false;
    v->document.source.mesh = mesh;
    surface->iso = args->iso.value;
    surface->level = coarse ? 1 : 2;
    v->document.labels.has_mesh = false;
    return CW_OK;
}

enum { LIVE_AUTO, LIVE_CPU, LIVE_GPU }; /* as --live-surface names them */

/* Returns true if the GPU is to extract the surface of this picture: while the isovalue moves. One
 * that is there in full is drawn as it is. */
static bool wants_live(const view *v, view_level level)
{
    const view_surface *surface = &v->document.surface;
    const render_args *args = &v->state.args;
    const bool is_there = surface->level == 2 && surface->iso == args->iso.value;
    return level == VIEW_ROUGH && args->live_surface != LIVE_CPU && !surface->refuses_live &&
           v->state.is_placed && args->iso.given && !is_there && !v->document.source.is_mesh &&
           !args->mesh && !args->compare && args->scene.hide != CLI_HIDE_MESH &&
           !args->scene.wireframe && args->scene.tint == CW_TINT_COLORS &&
           !(view_shows_surfaces(v) && v->picture.mode == CW_MODE_MESH);
}

static void describe_live(view *v)
{
    const render_args *args = &v->state.args;
    v->document.surface.live = (cw_live_surface){
        .volume = &v->document.source.volume.view,
        .isovalue = args->iso.value,
        .inside_is_low = cli_inside_is_low(args->inside, &v->document.source.volume.whole),
        .on_software = args->live_surface == LIVE_GPU};
}

/* Returns true if the GPU draws without a wait. Else what it needs is begun, and the CPU extracts
 * meanwhile. Where the GPU was asked for, pictures wait for it. */
static bool is_live_ready(view *v)
{
    cw_error ignored;
    bool ready = false;
    describe_live(v);
    if (v->state.args.live_surface == LIVE_GPU)
        return true;
    if (!v->picture.renderer ||
        cw_renderer_prepare(v->picture.renderer, &v->document.surface.live, &ready, &ignored) ==
            CW_OK)
        return ready;
    v->document.surface.refuses_live = true;
    return false;
}

/* Puts the live surface in the mesh's place. */
static void put_live(view *v, cw_scene *scene)
{
    describe_live(v);
    scene->mesh = NULL;
    scene->mesh_look.live = &v->document.surface.live;
}

const char *view_name_surface(const view *v)
{
    const view_surface *surface = &v->document.surface;
    if (surface->is_live)
        return "gpu";
    return surface->level == 0 || !v->state.args.iso.given ? "none"
           : surface->level == 1                           ? "cpu, coarse"
                                                           : "cpu";
}

/* Meshes have no volume to be around. */
static void need_box(view *v)
{
    double box[2][3];
    if (v->document.box[0][0] < v->document.box[1][0] ||
        v->document.source.mesh.triangle_count == 0)
        return;
    cli_find_box(NULL, &v->document.source.mesh, box);
    memcpy(v->document.box, box, sizeof box);
    cwi_midpoint(v->document.box[0], v->document.box[1], v->state.cross);
}

static bool is_slow(cw_mode mode)
{
    return mode == CW_MODE_VBUFFER || mode == CW_MODE_REFERENCE || mode == CW_MODE_PROJECTION;
}

/* Slow modes are stood in for while things move. */
static void make_rough(cw_scene *s)
{
    if (is_slow(s->mode))
        s->mode = s->reference_of ? s->reference_of
                  : s->volume && !cw_mode_draws(CW_MODE_COMPOSITE, s->volume)
                      ? CW_MODE_VBUFFER
                      : CW_MODE_COMPOSITE;
    if (s->mode == CW_MODE_SPLAT)
        s->mode = CW_MODE_SPLAT_TREE;
    if (s->mode == CW_MODE_SPLAT_TREE)
        s->splat.budget = ROUGH_SPLATS;
    const bool is_coarse = s->mode == CW_MODE_TEXTURE || s->mode == CW_MODE_SHADED_TEXTURE ||
                           s->mode == CW_MODE_AVERAGE;
    s->sampling.step_vox = fmax(s->sampling.step_vox, is_coarse ? 4 : 2);
    s->samples = 1;
    s->sampling.jitter = s->sampling.exact_filter = s->sampling.cell_steps = false;
    s->sampling.no_preintegration = true; /* its table is made again for every curve and step */
}

static cw_status space_scene(view *v, const render_args *args, cw_mode mode,
                             const cw_transfer *transfer, cw_scene *scene, cw_error *err)
{
    const cli_subject subject = {
        .volume = v->document.has_volume && mode != CW_MODE_MESH
                      ? cli_drawn(&v->document.source)
                      : NULL,
        .whole = v->document.source.is_mesh ? NULL : &v->document.source.volume.whole,
        .mesh = view_has_mesh(v) && v->document.source.mesh.triangle_count
                    ? &v->document.source.mesh
                    : NULL,
        .level = v->document.level,
        .threads = (int)args->input.threads};
    scene->camera = v->state.camera;
    scene->mesh_look.same_inside = view_shows_surfaces(v) || v->document.pieces.are_shown;
    scene->sampling.lean = !v->picture.is_saving;
    scene->samples = args->samples ? (int)args->samples : mode == CW_MODE_MESH ? 2 : 1;
    cw_status st = cli_make_scene(&args->scene, &subject, mode, transfer, scene, err);
    if (mode == CW_MODE_SLICES && scene->slice_count == 0)
        for (int a = 0; a < 3; a++) {
            scene->slices[scene->slice_count].normal[a] = 1;
            scene->slices[scene->slice_count++].distance_mm = v->state.cross[a];
        }
    return st;
}

static void make_greys(view *v)
{
    double w[2];
    view_grey_range(v, w);
    v->picture.greys =
        (cw_transfer){.color_count = 2,
                      .colors = {{w[0], {0, 0, 0}}, {fmax(w[1], w[0]), {1, 1, 1}}},
                      .opacity_count = 1,
                      .opacities = {{w[0], 1}}};
}

/* Axial, coronal and sagittal slices are across z, y and x, through the cross-hair. */
static cw_status slice_scene(view *v, int part, cw_scene *scene, cw_error *err)
{
    const int axis = 3 - part;
    *scene = (cw_scene){.mode = CW_MODE_SLICES,
                        .volume = cli_drawn(&v->document.source),
                        .transfer = &v->picture.greys,
                        .slice_count = 1,
                        .width = scene->width,
                        .height = scene->height,
                        .samples = 1};
    scene->slices[0].normal[axis] = 1;
    scene->slices[0].distance_mm = v->state.cross[axis];
    cw_status st =
        cw_slice_camera(scene->volume, &scene->slices[0],
                        (double)scene->width / (double)scene->height, &scene->camera, err);
    if (st == CW_OK && v->state.slice_zoom > 0)
        scene->camera.height_mm /= v->state.slice_zoom;
    return st;
}

static cw_status draw_scene(view *v, const cw_scene *scene, cw_picture *picture, cw_error *err)
{
    const cw_transfer black = cli_black_transfer();
    cw_scene s = *scene;
    cw_status st = scene->mode == CW_MODE_SLICES ? view_need_labels(v, err) : CW_OK;
    const cli_slice_labels labels = view_slice_labels(v);
    if (scene->mode == CW_MODE_SLICES && labels.is_base)
        s.transfer = &black;
    if (st == CW_OK && !v->picture.renderer)
        st = cw_renderer_new(CW_BACKEND_AUTO, &v->picture.renderer, err);
    if (st == CW_OK && v->picture.values_come)
        cw_renderer_forget(v->picture.renderer);
    v->picture.values_come = v->picture.values_come && st != CW_OK;
    if (st == CW_OK)
        st = cw_render(v->picture.renderer, &s, picture, err);
    if (st == CW_OK && scene->mode == CW_MODE_SLICES && !scene->mesh)
        st = cli_draw_slice_labels(&labels, scene, picture, err);
    v->document.surface.is_drawn = v->document.surface.is_drawn || (st == CW_OK && scene->mesh);
    return st;
}

/* Of slow modes a small picture comes before that in full size. */
static void size_for(const view *v, const view_part *part, view_level level, cw_scene *scene)
{
    const bool slow = part == &v->picture.parts[VIEW_SPACE] &&
                      (is_slow(v->picture.mode) ||
                       (v->state.args.compare && strstr(v->state.args.compare, "reference")));
    const double scale = level == VIEW_ROUGH          ? part->scale
                         : level == VIEW_FAIR && slow ? 0.25
                                                      : 1;
    scene->width = (size_t)fmax(1, round(part->rect.width * scale));
    scene->height = (size_t)fmax(1, round(part->rect.height * scale));
}

static void suit_level(view_level level, cw_scene *scene)
{
    if (level == VIEW_ROUGH)
        make_rough(scene);
    if (level == VIEW_FAIR) {
        scene->samples = 1;
        scene->sampling.step_vox = fmax(scene->sampling.step_vox, 1);
    }
}

/* Remembers how far a mode is from its exact picture. */
static void keep_error(view *v, const cli_split *split)
{
    for (int n = 0; n < 2; n++)
        if (v->picture.is_alike && split->sides[1 - n].mode == CW_MODE_REFERENCE)
            v->picture.mode_error[split->sides[n].mode] = v->picture.measured.rmse;
}

/* Both sides of a comparison, and how far they are apart when both are final. */
static cw_status draw_split(view *v, view_level level, const cw_progress *progress,
                            cw_scene *scene, cw_picture *out, cw_error *err)
{
    cli_split split = {0};
    cw_picture sides[2] = {{0}, {0}};
    const render_args *args = &v->state.args;
    cw_status st = view_parse_split(v, &split, err);
    for (int n = 1; n >= 0 && st == CW_OK; n--) {
        cli_side *side = &split.sides[n];
        st = cli_fit_transfer(&side->args.scene, cli_drawn(&v->document.source), side->mode,
                              &v->document.statistics, &side->transfer, err);
        if (v->state.is_edited && !side->args.scene.transfer)
            side->transfer = v->state.curve;
        size_for(v, &v->picture.parts[VIEW_SPACE], level, scene);
        if (st == CW_OK)
            st = space_scene(v, &side->args, side->mode, &side->transfer, scene, err);
        suit_level(level, scene);
        scene->progress = *progress;
        if (st == CW_OK)
            st = draw_scene(v, scene, &sides[n], err);
    }
    if (st == CW_OK && args->difference.given)
        st = cw_picture_difference(&sides[0], &sides[1], args->difference.value, out, err);
    else if (st == CW_OK)
        st = cw_picture_split(&sides[0], &sides[1], v->state.left_fraction, out, err);
    v->picture.is_measured = false;
    if (st == CW_OK && level > VIEW_ROUGH) {
        st = cw_picture_compare(&sides[0], &sides[1], (const float(*)[3])scene->background,
                                &v->picture.measured, err);
        v->picture.is_measured = st == CW_OK;
        v->picture.is_preliminary = level < VIEW_FINAL;
        v->picture.is_alike = cli_compares_alike(&split);
        if (v->picture.is_measured && !v->picture.is_preliminary)
            keep_error(v, &split);
    }
    cw_picture_free(&sides[0]);
    cw_picture_free(&sides[1]);
    cli_free_split(&split);
    scene->transfer = &v->picture.transfer;
    return st;
}

/* Returns true if another way may draw what a live surface did not: unless it was asked for, or
 * nobody waits for it any more. */
static bool may_replace_live(const view *v, cw_status st)
{
    return st != CW_OK && st != CW_ERR_CANCELLED && v->state.args.live_surface == LIVE_AUTO;
}

static cw_status draw_space(view *v, view_level level, const cw_progress *progress,
                            cw_scene *scene, cw_picture *picture, cw_error *err)
{
    view_surface *surface = &v->document.surface;
    const cw_scene plain = *scene;
    surface->is_live = wants_live(v, level) && is_live_ready(v);
    cw_status st = surface->is_live ? CW_OK : view_need_surface(v, level, err);
    need_box(v);
    if (st == CW_OK && !v->state.is_placed)
        st = view_place_camera(v, NULL, err);
    if (st == CW_OK)
        st = view_need_transfer(v, err);
    if (st != CW_OK)
        return st;
    if (v->state.args.compare && view_draws_volume(v))
        return draw_split(v, level, progress, scene, picture, err);
    size_for(v, &v->picture.parts[VIEW_SPACE], level, scene);
    st = space_scene(v, &v->state.args, v->picture.mode, &v->picture.transfer, scene, err);
    suit_level(level, scene);
    scene->progress = *progress;
    if (st == CW_OK && surface->is_live)
        put_live(v, scene);
    if (st == CW_OK && v->picture.mode == CW_MODE_MESH && !scene->mesh &&
        !surface->is_live) /* empty */
        return cw_picture_alloc(picture, scene->width, scene->height, err);
    if (st == CW_OK)
        st = draw_scene(v, scene, picture, err);
    if (surface->is_live && may_replace_live(v, st)) {
        surface->refuses_live = true;
        *scene = plain;
        return draw_space(v, level, progress, scene, picture, err);
    }
    if (st == CW_OK || !surface->is_live)
        return st;
    surface->is_live = false;
    return st == CW_ERR_CANCELLED ? st : cwi_fail_in(err, st, "--live-surface gpu");
}

cw_mode view_preset_mode(const view *v, const char *preset)
{
    static const char *const of_maxima[] = {"mip", "grey", "window"};
    const bool is_blended = v->picture.mode != CW_MODE_MESH &&
                            v->picture.mode != CW_MODE_SLICES &&
                            !cw_mode_is_intensity(v->picture.mode);
    if (strcmp(preset, "xray") == 0)
        return CW_MODE_AVERAGE;
    for (size_t n = 0; n < sizeof of_maxima / sizeof *of_maxima; n++)
        if (strcmp(preset, of_maxima[n]) == 0)
            return CW_MODE_MIP;
    return is_blended ? v->picture.mode : cli_default_mode(&v->document.source);
}

cw_status view_draw_preset(view *v, const char *preset, size_t width, size_t height,
                           cw_image *image, cw_error *err)
{
    static const uint8_t background[2][4] = {{8, 9, 12, 255}, {24, 28, 36, 255}};
    render_args *args = malloc(sizeof *args);
    const cw_mode mode = view_preset_mode(v, preset);
    cw_scene scene = {.width = width, .height = height};
    cw_picture picture = {0};
    cw_transfer transfer;
    if (!args)
        return cwi_fail_memory(err);
    *args = v->state.args;
    args->scene.transfer = preset;
    args->scene.shift = args->scene.opacity = (cli_number){0};
    args->iso = (cli_number){0};
    cw_status st = v->state.is_placed ? CW_OK : view_place_camera(v, NULL, err);
    if (st == CW_OK)
        st = cli_fit_transfer(&args->scene, cli_drawn(&v->document.source), mode,
                              &v->document.statistics, &transfer, err);
    if (st == CW_OK)
        st = space_scene(v, args, mode, &transfer, &scene, err);
    make_rough(&scene);
    scene.mesh = NULL;
    if (st == CW_OK)
        st = draw_scene(v, &scene, &picture, err);
    if (st == CW_OK)
        st = cw_picture_show(&picture, background, image, err);
    cw_picture_free(&picture);
    free(args);
    return st;
}

static cw_status draw_slice(view *v, int part, const cw_progress *progress, cw_scene *scene,
                            cw_picture *picture, cw_error *err)
{
    make_greys(v);
    size_for(v, &v->picture.parts[part], VIEW_FINAL, scene);
    cw_status st = slice_scene(v, part, scene, err);
    scene->progress = *progress;
    if (st == CW_OK)
        st = draw_scene(v, scene, picture, err);
    return st;
}

bool view_shows_isolines(const view *v)
{
    return v->state.args.marks.isolines && v->state.args.iso.given && !view_shows_surfaces(v);
}

static cw_status show_part(view *v, int part, cw_scene *scene, const cw_picture *picture,
                           cw_image *image, cw_error *err)
{
    static const uint8_t black[2][4] = {{0, 0, 0, 255}, {0, 0, 0, 255}};
    uint8_t background[2][4];
    const bool space = part == VIEW_SPACE;
    char caption[96] = "";
    cli_marks marks = {.scale_bar = true, .letters = true, .caption = caption};
    if (space)
        marks = v->state.args.marks;
    else if (scene->volume)
        cli_caption_slice(scene->volume, 3 - part, v->state.cross[3 - part], "\n", caption,
                          sizeof caption);
    marks.isolines = view_shows_isolines(v) && scene->mode == CW_MODE_SLICES && !scene->mesh;
    marks.isovalue = v->state.args.iso.value;
    const cli_slice_labels over = view_slice_labels(v);
    if (over.has_values && scene->mode == CW_MODE_SLICES && !scene->mesh &&
        (space || part == VIEW_AXIAL))
        marks.values = &over.values;
    if (!v->picture.is_saving) /* as large as the panels' letters, at least */
        marks.text_px =
            (double)picture->height * fmax(1.0 / 48, LETTER_PX * v->ui->scale(v->window) /
                                                         v->picture.parts[part].rect.height);
    cw_status st = cli_background(&v->state.args.scene, background, err);
    if (st == CW_OK)
        st = cw_picture_show(picture, space ? (const uint8_t(*)[4])background : black, image,
                             err);
    scene->progress = (cw_progress){0};
    if (st == CW_OK && (scene->volume || scene->mesh))
        st = cli_mark(&marks, v->document.labels.look.labels ? &v->document.labels.scene : NULL,
                      scene, image, err);
    if (st == CW_OK && v->picture.is_saving)
        st = view_mark_measures(v, part, scene, marks.text_px, image, err);
    return st;
}

/* Slower or faster than wanted: the next rough picture is smaller or larger. */
static void adapt_level(view_part *part, cw_mode mode, double ms)
{
    const double min_scale =
        mode == CW_MODE_VBUFFER ? 0.1 : 0.25; /* of a grid that GL does not draw */
    if (mode == CW_MODE_MESH)                 /* its cost is in its triangles */
        return;
    const double factor = sqrt(ROUGH_MS / fmax(ms, 1));
    if (factor < 0.8 || factor > 1.1)
        part->scale = fmin(fmax(part->scale * factor, min_scale), 0.5);
}

cw_status view_draw_part(view *v, int p, view_level level, bool may_stop, cw_image *image,
                         cw_error *err)
{
    view_part *part = &v->picture.parts[p];
    cw_scene scene = {0};
    cw_picture picture = {0};
    const cw_progress progress = {may_stop ? go_on : NULL, v};
    const double start = cli_seconds();
    cw_status st = p == VIEW_SPACE ? draw_space(v, level, &progress, &scene, &picture, err)
                                   : draw_slice(v, p, &progress, &scene, &picture, err);
    const double ms = 1000 * (cli_seconds() - start);
    if (st == CW_OK)
        st = show_part(v, p, &scene, &picture, image, err);
    cw_picture_free(&picture);
    if (st != CW_OK)
        return st;
    if (level == VIEW_ROUGH)
        adapt_level(part, scene.mode, ms);
    part->scene = scene;
    part->ms = ms;
    part->level = p == VIEW_SPACE ? level : VIEW_FINAL;
    return CW_OK;
}

static void drop_picture(view *v, int p)
{
    v->ui->keep(v->window, p, NULL, NULL);
    v->picture.parts[p].level = VIEW_FINAL;
}

cw_status view_draw(view *v, view_level level, bool may_stop, cw_error *err)
{
    for (int p = 0; p < VIEW_PARTS; p++) {
        cw_image image = {0};
        view_part *part = &v->picture.parts[p];
        if (!part->is_shown || part->level >= level)
            continue;
        if (!v->document.path || (p != VIEW_SPACE && !view_fits_mode(v, CW_MODE_SLICES))) {
            drop_picture(v, p);
            continue;
        }
        cw_status st = view_draw_part(v, p, level, may_stop, &image, err);
        if (st == CW_OK)
            st = v->ui->keep(v->window, p, &image, err);
        cw_image_free(&image);
        if (st == CW_ERR_CANCELLED && may_stop && !cli_interrupted())
            return CW_OK;
        if (st != CW_OK) {
            part->level = VIEW_FINAL; /* not again and again */
            return st;
        }
    }
    return CW_OK;
}

bool view_is_final(const view *v)
{
    for (int p = 0; p < VIEW_PARTS; p++)
        if (v->picture.parts[p].is_shown && v->picture.parts[p].level < VIEW_FINAL)
            return false;
    return true;
}
