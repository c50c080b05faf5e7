/* Runs the command render: opens the steps, makes the scene of each turn, draws it on OpenGL
 * or the CPU, and writes the pictures. */
#include "cli/render/render_run.h"
#include "cli/inputs/level_choice.h"

#include "cli/framework/console.h"
#include "cli/framework/name_template.h"
#include "cli/framework/quantity.h"
#include "cli/framework/standard_streams.h"
#include "cli/inputs/extract_surface.h"
#include "cli/inputs/mesh_input.h"
#include "cli/render/compare_options.h"
#include "cli/render/label_pictures.h"
#include "cli/results/output_names.h"
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/volume/volume.h"
#include <cubewright/render.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MESH_SAMPLES = 2 };

static cw_status check_side_output(const char *path, const render_args *args, cw_error *err)
{
    if (!path)
        return CW_OK;
    cw_status st = cli_check_output(path, args->common.inputs, args->common.input_count, err);
    return st == CW_OK ? cli_check_apart(path, args->output, err) : st;
}

/* Isolines are drawn on slices that no mesh stands before. */
static cw_status check_isolines(const render_args *args, cw_error *err)
{
    const bool is_slices = args->scene.mode == 1 + CW_MODE_SLICES;
    return args->marks.isolines && is_slices && args->scene.hide != CLI_HIDE_MESH
               ? cwi_fail(err, CW_ERR_ARGUMENT,
                          "--isolines in the mode slices is for slices without the surface "
                          "before them: --hide mesh")
               : CW_OK;
}

cw_status cli_check_pictures(const render_args *args, cw_error *err)
{
    const char *dot = args->output ? strrchr(args->output, '.') : NULL;
    if (!cli_is_standard(args->output) && (!dot || strcmp(dot, ".png") != 0))
        return cwi_fail(err, CW_ERR_ARGUMENT, "%s: render writes .png", args->output);
    if (args->size.count != 2)
        return cwi_fail(err, CW_ERR_ARGUMENT, "--size takes two numbers, such as 1280x720");
    if (args->samples > 4)
        return cwi_fail(err, CW_ERR_ARGUMENT, "--samples %zu: expected 1 to 4", args->samples);
    if (args->difference.given && cli_has_marks(&args->marks))
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "--difference cannot be combined with marks on the picture");
    if (args->marks.layout == CLI_LAYOUT_QUAD && (args->size.n[0] < 2 || args->size.n[1] < 2))
        return cwi_fail(err, CW_ERR_ARGUMENT, "--layout quad needs 2 x 2 pixels");
    if (args->difference.given && !(args->difference.value > 0))
        return cwi_fail(err, CW_ERR_ARGUMENT, "--difference %g: above 0 was expected",
                        args->difference.value);
    cw_status st = check_isolines(args, err);
    if (st == CW_OK)
        st = cli_check_color(&args->color, err);
    if (st == CW_OK)
        st = cli_check_camera(&args->scene, &args->turns, err);
    if (st == CW_OK)
        st = cli_check_label_look(args, err);
    if (st == CW_OK)
        st = check_side_output(args->json, args, err);
    if (st == CW_OK)
        st = check_side_output(args->save_transfer, args, err);
    if (st == CW_OK)
        st = check_side_output(args->save_camera, args, err);
    return st;
}

/* The input, and how to draw it. */
static cw_status look_at_input(cli_pictures *p, cw_error *err)
{
    const render_args *args = p->args;
    cli_source *s = &p->source;
    cw_status st =
        cli_open_source(s, &args->common, &args->input, &args->steps, !args->iso.given, err);
    const bool by_default = s->is_mesh || args->iso.given || (s->is_level_set && !args->mesh);
    p->mode = args->scene.mode ? (cw_mode)(args->scene.mode - 1)
              : by_default     ? CW_MODE_MESH
                               : cli_default_mode(s);
    return st;
}

static bool has_mesh(const cli_pictures *p)
{
    const render_args *args = p->args;
    return args->scene.hide != CLI_HIDE_MESH &&
           (p->source.is_mesh || args->iso.given || args->mesh || p->mode == CW_MODE_MESH);
}

/* Draws nothing but the mesh, or nothing but the volume. */
static cw_status check_hidden(cli_pictures *p, cw_error *err)
{
    const render_args *args = p->args;
    if (args->scene.hide == CLI_HIDE_VOLUME &&
        (args->iso.given || args->mesh || p->source.is_mesh))
        p->mode = CW_MODE_MESH;
    else if (args->scene.hide == CLI_HIDE_VOLUME)
        return cwi_fail(err, CW_ERR_ARGUMENT, "--hide volume leaves nothing to draw");
    if (args->scene.hide == CLI_HIDE_MESH && p->mode == CW_MODE_MESH)
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "--hide mesh leaves nothing to draw in the mode mesh");
    return CW_OK;
}

/* Whether the picture is that of cw_render_mesh(). */
static bool draws_on_cpu(const cli_pictures *p)
{
    return p->mode == CW_MODE_MESH && p->args->backend != CW_BACKEND_EGL &&
           !cli_needs_gl(p->command, &p->args->common, &p->args->scene) &&
           (p->args->overlay || !cli_labels_need_gl(&p->labels));
}

/* Parses --compare. The input is read for the left side; both sides draw the volume. */
static cw_status plan_split(cli_pictures *p, cw_error *err)
{
    const render_args *args = p->args;
    if (p->source.is_mesh || args->scene.hide == CLI_HIDE_VOLUME)
        return cwi_fail(err, CW_ERR_ARGUMENT, "--compare is for the modes of volumes");
    p->split = calloc(1, sizeof *p->split);
    if (!p->split)
        return cwi_fail_memory(err);
    cw_status st = cli_parse_split(p->command, args, p->split, err);
    p->mode = p->split->sides[0].mode;
    if (st == CW_OK && !cli_compares_alike(p->split))
        cli_say("warning: %s and %s show different things: their difference is not an error",
                cw_mode_name(p->mode), cw_mode_name(p->split->sides[1].mode));
    return st;
}

static cw_status check_mode(cli_pictures *p, cw_error *err)
{
    const render_args *args = p->args;
    const char *gl = cli_needs_gl(p->command, &args->common, &args->scene);
    cw_status st = check_hidden(p, err);
    if (st != CW_OK)
        return st;
    if (args->compare)
        return plan_split(p, err);
    if (p->source.is_mesh && p->mode != CW_MODE_MESH)
        return cwi_fail(err, CW_ERR_ARGUMENT, "%s is a mesh; the mode %s draws volumes",
                        args->common.inputs[0], cw_mode_name(p->mode));
    if (args->marks.layout == CLI_LAYOUT_QUAD && p->source.is_mesh)
        return cwi_fail(err, CW_ERR_ARGUMENT, "%s is a mesh; --layout quad is for volumes",
                        args->common.inputs[0]);
    if (p->source.is_mesh && (args->mesh || args->scene.hide))
        return cwi_fail(err, CW_ERR_ARGUMENT, "%s is a mesh; --%s is for volumes",
                        args->common.inputs[0], args->mesh ? "mesh" : "hide");
    if (p->mode == CW_MODE_MESH && !p->source.is_mesh && !args->mesh && !args->iso.given &&
        !p->source.is_level_set && !(p->look.labels && !args->overlay))
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "the surface of a volume needs an isovalue: --iso V; 'cubewright info "
                        "%s' suggests some",
                        args->common.inputs[0]);
    if (p->mode == CW_MODE_MESH && args->backend == CW_BACKEND_CPU && gl)
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "--%s is drawn by OpenGL alone: --backend auto or egl", gl);
    if (args->color.by && (!has_mesh(p) || (p->look.labels && !args->overlay)))
        return cwi_fail(
            err, CW_ERR_ARGUMENT,
            "--color-by colours a surface, and none is drawn: --iso V, --mesh FILE or "
            "a mesh as the input makes one");
    return cli_check_scene(p->command, &args->common, p->mode, has_mesh(p), err);
}

static cw_status fill_name(const cli_pictures *p, const cli_moment *moment, size_t turn,
                           char **name, cw_error *err)
{
    char numbers[2][24];
    char *stem = cli_stem(moment->path), *parent = cli_parent(moment->path);
    snprintf(numbers[0], sizeof numbers[0], "%zu", moment->number);
    snprintf(numbers[1], sizeof numbers[1], "%zu", turn);
    cli_part parts[] = {{"step", numbers[0], true, false},
                        {"turn", numbers[1], true, false},
                        {"stem", stem, false, false},
                        {"parent", parent, false, false}};
    cw_status st = stem && parent ? cli_fill_template(p->args->output, parts, 4, name, err)
                                  : cwi_fail_memory(err);
    free(parent);
    free(stem);
    if (st == CW_OK && p->args->turns.count > 1 && !parts[1].used)
        return cwi_fail(
            err, CW_ERR_ARGUMENT,
            "--turntable: the output must hold {turn}, as in 'turn-{turn:03d}.png'");
    if (st == CW_OK && p->source.series.count > 1 && !parts[0].used &&
        !(p->source.series.files.count && parts[2].used))
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "several steps: the output must hold {step}, as in '{step:04d}.png'");
    return st;
}

static cw_status check_names(const cli_pictures *p, cw_error *err)
{
    const size_t files = p->source.series.files.count;
    const char *const *inputs = files ? (const char *const *)p->source.series.files.path
                                      : (const char *const *)p->args->common.inputs;
    cw_status st = CW_OK;
    for (size_t n = 0; n < p->shot_count && st == CW_OK; n++) {
        st = cli_check_output(p->shots[n].path, inputs, files ? files : 1, err);
        if (st == CW_OK && n)
            st = cli_check_apart(p->shots[n - 1].path, p->shots[n].path, err);
    }
    return st;
}

/* One picture a turn, of each step. */
static cw_status plan_pictures(cli_pictures *p, cw_error *err)
{
    const size_t turns = p->args->turns.count > 1 ? p->args->turns.count : 1;
    p->shots = calloc(p->source.series.count * turns, sizeof *p->shots);
    if (!p->shots)
        return cwi_fail_memory(err);
    cw_status st = CW_OK;
    for (size_t s = 0; s < p->source.series.count; s++)
        for (size_t n = 0; n < turns && st == CW_OK; n++) {
            cli_shot *shot = &p->shots[p->shot_count++];
            shot->step = p->source.series.moments[s].number;
            shot->turn_deg = cli_turn_angle(&p->args->turns, n);
            st = fill_name(p, &p->source.series.moments[s], n, &shot->path, err);
        }
    return st == CW_OK ? check_names(p, err) : st;
}

static bool draws_volume(const cli_pictures *p)
{
    return p->mode != CW_MODE_MESH;
}

/* Finds the number of an isovalue that is named, in the first step. */
static cw_status choose_iso(cli_pictures *p, cw_error *err)
{
    if (!p->iso.given)
        p->iso = p->args->iso;
    return cli_choose_level(&p->source.volume, &p->args->input, &p->iso, err);
}

static cw_status extract_shown(cli_pictures *p, cw_error *err)
{
    const render_args *args = p->args;
    cw_mesh_free(&p->source.mesh);
    cw_status st = choose_iso(p, err);
    const cw_extract_desc desc = {.isovalue = p->iso.value,
                                  .inside_is_low =
                                      cli_inside_is_low(args->inside, &p->source.volume.whole),
                                  .threads = (int)args->input.threads};
    return st == CW_OK
               ? cli_extract_surface(&p->source.volume, &desc, &p->source.mesh, NULL, err)
               : st;
}

static cw_status read_beside(cli_pictures *p, cw_error *err)
{
    cli_mesh file;
    if (p->source.mesh.triangle_count)
        return CW_OK;
    cw_status st = cli_read_reference(p->args->mesh, NULL, &p->args->input, &file, err);
    p->source.mesh = file.mesh;
    return st;
}

/* Fits the transfer function to all steps, once. */
static cw_status make_transfer(cli_pictures *p, size_t step, cw_error *err)
{
    const render_args *args = p->args;
    cw_statistics statistics;
    cw_status st = cli_find_statistics(&p->source, &args->input, step, CLI_TRANSFER_BINS,
                                       &statistics, err);
    if (st != CW_OK)
        return st;
    for (int n = 0; n < 2 && p->split && st == CW_OK; n++)
        st = cli_fit_transfer(&p->split->sides[n].args.scene, &p->source.volume.view,
                              p->split->sides[n].mode, &statistics,
                              &p->split->sides[n].transfer, err);
    if (p->split)
        p->transfer = p->split->sides[0].transfer;
    else
        st = cli_fit_transfer(&args->scene, &p->source.volume.view, p->mode, &statistics,
                              &p->transfer, err);
    p->level = cli_class_level(&statistics);
    cw_statistics_free(&statistics);
    p->has_transfer = st == CW_OK;
    if (st == CW_OK && args->save_transfer)
        st = cw_transfer_write(args->save_transfer, &p->transfer, err);
    return st;
}

/* Makes or reads the mesh of a step, and colours it. */
static cw_status open_mesh(cli_pictures *p, size_t step, cw_error *err)
{
    const render_args *args = p->args;
    const cw_volume *colors;
    double start = cli_seconds();
    cw_status st = p->source.is_mesh ? CW_OK
                   : args->mesh      ? read_beside(p, err)
                                     : extract_shown(p, err);
    if (st == CW_OK && !p->source.is_mesh)
        cli_end_step(args->mesh ? "read mesh" : "extract", &start);
    if (st != CW_OK || !args->color.by)
        return st;
    st = cli_open_coloring(&p->coloring, p->source.series.moments[step].path, &args->input,
                           p->source.series.moments[step].step, &colors, err);
    if (st == CW_OK)
        st = cli_color_mesh(&p->coloring, &p->source.mesh, (int)args->input.threads, err);
    if (st == CW_OK)
        cli_end_step("color", &start);
    return st;
}

/* Everything that a step shows. */
static cw_status open_step(cli_pictures *p, size_t step, cw_error *err)
{
    const render_args *args = p->args;
    if (p->source.is_mesh)
        return open_mesh(p, step, err);
    double start = cli_seconds();
    cw_status st = cli_read_step(&p->source, &args->input, step, err);
    if (st == CW_OK)
        cli_end_step("read", &start);
    if (st == CW_OK && draws_volume(p) && !p->has_transfer)
        st = make_transfer(p, step, err);
    if (st == CW_OK && draws_volume(p))
        st = cli_need_drawable(&p->source, &args->input, err);
    if (st == CW_OK && p->look.labels)
        st = cli_open_labels(p, step, err);
    if (st == CW_OK && args->marks.isolines) {
        st = choose_iso(p, err);
        p->on_slices.isoline = p->iso;
    }
    if (st != CW_OK || (p->look.labels && !args->overlay))
        return st;
    return has_mesh(p) ? open_mesh(p, step, err) : CW_OK;
}

static cw_status make_scene(cli_pictures *p, size_t turn, cw_error *err)
{
    const render_args *args = p->args;
    const cli_subject subject = {
        .volume = draws_volume(p) ? cli_drawn(&p->source) : NULL,
        .whole = p->source.is_mesh ? NULL : &p->source.volume.whole,
        .mesh = has_mesh(p) ? &p->source.mesh : NULL,
        .level = p->level,
        .threads = (int)args->input.threads,
    };
    const double aspect = (double)args->size.n[0] / (double)args->size.n[1];
    const size_t part = args->marks.layout == CLI_LAYOUT_QUAD ? 2 : 1;
    p->scene = (cw_scene){.width = args->size.n[0] / part, .height = args->size.n[1] / part};
    p->scene.samples = args->samples ? (int)args->samples : draws_volume(p) ? 1 : MESH_SAMPLES;
    p->scene.progress = cli_progress((double)p->source.mesh.triangle_count / 1e6, "Mtriangle");
    p->scene.mesh_look.same_inside = p->look.labels && !args->overlay;
    cw_status st = CW_OK;
    if (!p->has_box && p->source.series.count > 1) /* what is visible moves */
        p->has_box = cli_find_box(subject.volume, subject.mesh, p->box);
    else if (!p->has_box)
        st = cli_find_seen_box(subject.volume, subject.mesh, p->mode, &p->transfer,
                               subject.threads, p->box, &p->has_box, err);
    if (st == CW_OK)
        st = cli_find_camera(&args->scene, &args->turns, turn, (const double(*)[3])p->box,
                             aspect, &p->scene.camera, err);
    return st == CW_OK
               ? cli_make_scene(&args->scene, &subject, p->mode, &p->transfer, &p->scene, err)
               : st;
}

/* As it was before there was OpenGL, and where there is none. */
static cw_status draw_mesh(cli_pictures *p, const uint8_t background[2][4], cw_image *image,
                           cw_error *err)
{
    const cw_scene *s = &p->scene;
    cw_render_mesh_desc desc = {.camera = s->camera,
                                .width = s->width,
                                .height = s->height,
                                .samples = s->samples,
                                .same_inside = s->mesh_look.same_inside,
                                .threads = s->threads,
                                .progress = s->progress};
    memcpy(desc.background, background, sizeof desc.background);
    if (p->args->scene.color)
        cli_parse_color(p->args->scene.color, desc.color);
    return cw_render_mesh(&p->source.mesh, &desc, image, err);
}

static cw_status draw_picture(cli_pictures *p, cw_picture *picture, cw_error *err)
{
    cw_status st = CW_OK;
    if (!p->renderer)
        st = cw_renderer_new((cw_backend)p->args->backend, &p->renderer, err);
    if (st == CW_OK)
        st = cw_render(p->renderer, &p->scene, picture, err);
    if (st == CW_OK && p->mode == CW_MODE_SLICES)
        st = cli_draw_slice_labels(&p->on_slices, &p->scene, picture, err);
    if (st == CW_ERR_UNSUPPORTED && draws_volume(p) && !p->source.is_uneven &&
        p->mode != CW_MODE_VBUFFER &&
        (!p->renderer || strcmp(cw_renderer_name(p->renderer), "CPU") == 0))
        cli_say("without OpenGL, use --mode projection, vbuffer or reference");
    return st == CW_ERR_UNSUPPORTED && p->source.is_uneven
               ? cwi_fail_in(err, st, p->source.volume.path)
               : st;
}

/* A side is drawn as if the run were about it alone. */
static cw_status draw_side(cli_pictures *p, size_t turn, cli_side *side, cw_picture *picture,
                           cw_error *err)
{
    const render_args *args = p->args;
    p->args = &side->args;
    p->mode = side->mode;
    p->transfer = side->transfer;
    cw_status st = make_scene(p, turn, err);
    if (st == CW_OK)
        st = draw_picture(p, picture, err);
    p->args = args;
    return st;
}

static cw_status draw_both(cli_pictures *p, size_t turn, cli_shot *shot,
                           const uint8_t background[2][4], cw_picture *out, cw_error *err)
{
    cw_picture sides[2] = {{0}, {0}};
    cw_status st = CW_OK;
    for (int n = 1; n >= 0 && st == CW_OK; n--)
        st = draw_side(p, turn, &p->split->sides[n], &sides[n], err);
    if (st == CW_OK)
        st = cli_draw_split(sides, p->args, background, &shot->measured, out, err);
    shot->compared = st == CW_OK;
    for (int n = 0; n < 2; n++)
        cw_picture_free(&sides[n]);
    return st;
}

static cw_status draw_scene(cli_pictures *p, size_t turn, cli_shot *shot,
                            const uint8_t background[2][4], cw_image *image, cw_error *err)
{
    cw_picture picture = {0};
    cw_status st = p->split ? draw_both(p, turn, shot, background, &picture, err)
                            : draw_picture(p, &picture, err);
    if (st == CW_OK)
        st = cw_picture_show(&picture, background, image, err);
    cw_picture_free(&picture);
    return st;
}

static void tell_picture(const cli_pictures *p, const cli_shot *shot)
{
    char what[256], labels[32] = "";
    const size_t triangles = has_mesh(p) ? p->source.mesh.triangle_count : 0;
    const size_t visible = cli_count_visible(&p->labels, p->mode == CW_MODE_MESH);
    if (p->labels.shown.count)
        snprintf(labels, sizeof labels, " of %zu label%s", visible, visible == 1 ? "" : "s");
    if (draws_volume(p))
        snprintf(what, sizeof what, "%s%s%s%s%s by %s", cw_mode_name(p->mode),
                 p->mode == CW_MODE_SLICES ? labels : "", triangles ? " and " : "",
                 triangles ? cli_count(triangles) : "", triangles ? " triangles" : "",
                 cw_renderer_name(p->renderer));
    else
        snprintf(what, sizeof what, "%s triangles%s", cli_count(triangles), labels);
    if (shot->compared)
        cli_result("%s: %s: rmse %.3g, max %.3g of 255; delta-E %.3g, 99 %% below %.3g\n",
                   shot->path, p->args->compare, shot->measured.rmse, shot->measured.max,
                   shot->measured.delta_e_mean, shot->measured.delta_e_p99);
    else
        cli_result("%s: %zu x %zu, %s seen from %s; %.2f s\n", shot->path, p->args->size.n[0],
                   p->args->size.n[1], what,
                   cli_camera_title(&p->args->scene, (const double(*)[3])p->box),
                   shot->seconds);
}

/* With slices beside it. */
static cw_status add_slices(cli_pictures *p, cw_image *image, cw_error *err)
{
    cw_image sheet = {0};
    cw_scene whole = p->scene;
    whole.volume = cli_drawn(&p->source);
    whole.width = p->args->size.n[0];
    whole.height = p->args->size.n[1];
    cw_status st = cli_mark_quad(&whole, image, &p->on_slices, (cw_backend)p->args->backend,
                                 &p->renderer, &sheet, err);
    cw_image_free(image);
    *image = sheet;
    return st;
}

static cw_status write_picture(const char *path, const cw_image *image, cw_error *err)
{
    uint8_t *bytes;
    size_t size;
    if (!cli_is_standard(path))
        return cw_image_write(path, image, err);
    cw_status st = cw_image_encode(image, true, &bytes, &size, err);
    if (st == CW_OK)
        st = cli_write_standard(bytes, size, err);
    cw_bytes_free(bytes);
    return st;
}

static cw_status take_picture(cli_pictures *p, size_t turn, cli_shot *shot, cw_error *err)
{
    uint8_t background[2][4];
    cw_image image = {0};
    cli_marks marks = p->args->marks;
    const bool is_slices = p->mode == CW_MODE_SLICES;
    marks.isolines = marks.isolines && is_slices;
    marks.values = is_slices && p->on_slices.has_values ? &p->on_slices.values : NULL;
    marks.isovalue = p->iso.value;
    double start = cli_seconds();
    cw_status st = make_scene(p, turn, err);
    if (st == CW_OK)
        st = cli_background(&p->args->scene, background, err);
    if (st == CW_OK)
        st = draws_on_cpu(p)
                 ? draw_mesh(p, (const uint8_t(*)[4])background, &image, err)
                 : draw_scene(p, turn, shot, (const uint8_t(*)[4])background, &image, err);
    if (st == CW_OK)
        st = cli_mark(&marks, &p->labels, &p->scene, &image, err);
    if (st == CW_OK && p->args->marks.layout == CLI_LAYOUT_QUAD)
        st = add_slices(p, &image, err);
    if (st == CW_OK)
        cli_end_step("draw", &start);
    if (st == CW_OK)
        st = write_picture(shot->path, &image, err);
    cw_image_free(&image);
    if (st != CW_OK)
        return st;
    cli_end_step("write", &start);
    shot->camera = p->scene.camera;
    shot->seconds = cli_seconds() - p->start;
    shot->written = true;
    p->start = cli_seconds();
    tell_picture(p, shot);
    return CW_OK;
}

static cw_status take_pictures(cli_pictures *p, cw_error *err)
{
    const size_t turns = p->args->turns.count > 1 ? p->args->turns.count : 1;
    cw_status st = CW_OK;
    for (size_t s = 0; s < p->source.series.count && st == CW_OK; s++) {
        st = open_step(p, s, err);
        if (st == CW_OK && p->renderer)
            cw_renderer_forget(p->renderer);
        for (size_t n = 0; n < turns && st == CW_OK; n++)
            st = take_picture(p, n, &p->shots[s * turns + n], err);
    }
    if (st == CW_OK && p->args->save_camera)
        st = cw_camera_write(p->args->save_camera, &p->shots[0].camera, err);
    return st;
}

cw_status cli_make_pictures(cli_pictures *p, cw_error *err)
{
    cw_status st = look_at_input(p, err);
    if (st == CW_OK)
        st = plan_pictures(p, err);
    if (st == CW_OK)
        st = cli_decide_labels(p, err);
    if (st == CW_OK)
        st = check_mode(p, err);
    return st == CW_OK ? take_pictures(p, err) : st;
}

void cli_end_pictures(cli_pictures *p)
{
    cw_renderer_free(p->renderer);
    if (p->split)
        cli_free_split(p->split);
    free(p->split);
    for (size_t n = 0; n < p->shot_count; n++)
        free(p->shots[n].path);
    free(p->shots);
    cli_free_label_scene(&p->labels);
    cli_free_volume(&p->overlay);
    cli_free_coloring(&p->coloring);
    cli_close_source(&p->source);
}

cli_render_report cli_report_pictures(const cli_pictures *p)
{
    return (cli_render_report){
        .volume = p->source.volume.path ? &p->source.volume : NULL,
        .mode = p->mode,
        .backend = p->renderer ? cw_renderer_name(p->renderer) : "CPU",
        .scene = p->scene.width ? &p->scene : NULL,
        .transfer = &p->transfer,
        .labels = &p->labels,
        .shots = p->shots,
        .shot_count = p->shot_count,
        .triangles = p->source.mesh.triangle_count,
    };
}
