/* Rendering: modes and how finely they sample, each against the exact picture of its kind. */
#include "cli/framework/console.h"
#include "cli/inputs/scene_source.h"
#include "cli/render/camera_options.h"
#include "cli/render/render_run.h"
#include "cli/study/study.h"
#include "core/base/status.h"
#include "core/volume/volume.h"

#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

static const double SLOW_SECONDS = 0.5, /* a second frame is timed alone */
    VERY_SLOW_SECONDS = 4;              /* the first one is */

/* A setting to try; what is 0 is as by default. */
typedef struct setting {
    int rank;
    cw_mode mode;
    double step, tree_error;
    size_t slices;
    cw_target target;
} setting;

static const setting unlit[] = {
    {.rank = 1, .mode = CW_MODE_COMPOSITE, .step = 1},
    {.rank = 1, .mode = CW_MODE_COMPOSITE, .step = 0.5},
    {.rank = 1, .mode = CW_MODE_VBUFFER},
    {.rank = 2, .mode = CW_MODE_TEXTURE, .step = 1},
    {.rank = 2, .mode = CW_MODE_COMPOSITE, .step = 2},
    {.rank = 5, .mode = CW_MODE_SPLAT_TREE, .tree_error = 0.1},
    {.rank = 3, .mode = CW_MODE_COMPOSITE, .step = 0.25},
    {.rank = 3, .mode = CW_MODE_TEXTURE, .step = 0.5},
    {.rank = 3, .mode = CW_MODE_TEXTURE, .step = 2},
    {.rank = 3, .mode = CW_MODE_TEXTURE, .slices = 64},
    {.rank = 3, .mode = CW_MODE_TEXTURE, .step = 1, .target = CW_TARGET_8},
    {.rank = 5, .mode = CW_MODE_TEXTURE, .step = 1, .target = CW_TARGET_16F},
    {.rank = 6, .mode = CW_MODE_SPLAT_TREE, .tree_error = 0.02},
    {.rank = 6, .mode = CW_MODE_SPLAT_TREE, .tree_error = 0.05},
    {.rank = 6, .mode = CW_MODE_PROJECTION},
    {.rank = 5, .mode = CW_MODE_TEXTURE, .step = 0.25},
    {.rank = 6, .mode = CW_MODE_SPLAT},
    {.rank = 7, .mode = CW_MODE_SPLAT_TREE, .tree_error = 0.005},
};

static const setting lit[] = {
    {.rank = 1, .mode = CW_MODE_COMPOSITE, .step = 0.25},
    {.rank = 2, .mode = CW_MODE_COMPOSITE, .step = 1},
    {.rank = 3, .mode = CW_MODE_COMPOSITE, .step = 0.5},
    {.rank = 3, .mode = CW_MODE_TEXTURE, .step = 1},
    {.rank = 3, .mode = CW_MODE_SHADED_TEXTURE, .step = 1},
    {.rank = 4, .mode = CW_MODE_TEXTURE, .step = 1, .target = CW_TARGET_8},
    {.rank = 4, .mode = CW_MODE_COMPOSITE, .step = 2},
    {.rank = 5, .mode = CW_MODE_VBUFFER},
    {.rank = 6, .mode = CW_MODE_SHADED_TEXTURE, .step = 0.5},
};

static const setting projected[] = {
    {.rank = 2, .mode = CW_MODE_MIP, .step = 1},
    {.rank = 4, .mode = CW_MODE_AVERAGE, .step = 1},
    {.rank = 4, .mode = CW_MODE_LOCAL_MIP, .step = 1},
    {.rank = 4, .mode = CW_MODE_MINIP, .step = 1},
    {.rank = 5, .mode = CW_MODE_MIP, .step = 0.25},
    {.rank = 6, .mode = CW_MODE_AVERAGE, .step = 0.25},
    {.rank = 6, .mode = CW_MODE_LOCAL_MIP, .step = 0.25},
    {.rank = 6, .mode = CW_MODE_MINIP, .step = 0.25},
};

/* Which projection a reference is of; the first two are of none. */
static const cw_mode kinds[CLI_REFERENCES] = {CW_MODE_REFERENCE, CW_MODE_REFERENCE,
                                              CW_MODE_MIP,       CW_MODE_MINIP,
                                              CW_MODE_AVERAGE,   CW_MODE_LOCAL_MIP};

static size_t find_reference(cli_family family, cw_mode mode)
{
    size_t n = 2;
    if (family != CLI_PROJECTIONS)
        return family == CLI_SHADING;
    while (n + 1 < CLI_REFERENCES && kinds[n] != mode)
        n++;
    return n;
}

static void add_name(cli_point *p, const char *format, ...) CW_PRINTF(2, 3);
static void add_name(cli_point *p, const char *format, ...)
{
    const size_t end = strlen(p->name);
    va_list args;
    va_start(args, format);
    vsnprintf(p->name + end, sizeof p->name - end, format, args);
    va_end(args);
}

static void plan_settings(cli_study *s, cli_family family, const setting *rows, size_t count)
{
    static const cli_scene usual = CLI_SCENE_DEFAULTS;
    for (size_t n = 0; n < count; n++) {
        const setting *row = &rows[n];
        const char *mode = cw_mode_name(row->mode);
        cli_point *p = cli_add_point(s, family, row->rank, mode, "%s", mode);
        cli_scene *scene = &p->tried.scene;
        p->tried.mode = row->mode;
        p->tried.reference = find_reference(family, row->mode);
        *scene = usual;
        scene->camera = "front";
        scene->lit = family == CLI_SHADING;
        scene->step = (cli_number){.given = row->step > 0, .value = row->step};
        scene->tree_error =
            (cli_number){.given = row->tree_error > 0, .value = row->tree_error};
        scene->slices = row->slices;
        scene->target = row->target;
        if (scene->step.given)
            add_name(p, ", step %g", row->step);
        if (scene->tree_error.given)
            add_name(p, ", error %g", row->tree_error);
        if (scene->slices)
            add_name(p, ", %zu slices", scene->slices);
        if (scene->target)
            add_name(p, ", %s", row->target == CW_TARGET_8 ? "8 bits" : "half floats");
    }
}

void cli_plan_rendering(cli_study *s)
{
    plan_settings(s, CLI_RENDERING, unlit, sizeof unlit / sizeof *unlit);
    plan_settings(s, CLI_SHADING, lit, sizeof lit / sizeof *lit);
    plan_settings(s, CLI_PROJECTIONS, projected, sizeof projected / sizeof *projected);
}

/* With the camera of the command: around what is seen. */
static cw_status make_scene(cli_study *s, const cli_scene *args, cw_mode mode,
                            const cli_reference *of, cw_scene *scene, cw_error *err)
{
    const cli_turns turns = {0};
    const cli_subject subject = {.volume = &s->drawn,
                                 .whole = &s->volume->whole,
                                 .level = s->drawn_level,
                                 .threads = s->threads};
    *scene = (cw_scene){.width = CLI_STUDY_WIDTH, .height = CLI_STUDY_HEIGHT, .samples = 1};
    scene->progress = cli_progress(1, "picture");
    cw_status st =
        cli_find_camera(args, &turns, 0, of->box, (double)CLI_STUDY_WIDTH / CLI_STUDY_HEIGHT,
                        &scene->camera, err);
    return st == CW_OK ? cli_make_scene(args, &subject, mode, &of->transfer, scene, err) : st;
}

static cw_status fit_transfer(cli_study *s, const cli_scene *args, cw_mode mode,
                              cli_reference *r, cw_error *err)
{
    cw_statistics values;
    bool found;
    cw_status st = cw_volume_statistics(&s->drawn, CLI_TRANSFER_BINS, s->threads, &values, err);
    if (st == CW_OK) {
        s->drawn_level = cli_class_level(&values);
        st = cli_fit_transfer(args, &s->drawn, mode, &values, &r->transfer, err);
    }
    cw_statistics_free(&values);
    return st == CW_OK ? cli_find_seen_box(&s->drawn, NULL, mode, &r->transfer, s->threads,
                                           r->box, &found, err)
                       : st;
}

/* How a picture is made small: one pixel of four. */
typedef enum thumbnail { FULL_SIZE, MEAN_OF_FOUR, LARGEST_OF_FOUR } thumbnail;

static uint8_t join_four(const cw_image *from, size_t x, size_t y, size_t channel, bool mean)
{
    int sum = 0, largest = 0;
    for (size_t n = 0; n < 4; n++) {
        const size_t at = (2 * y + n / 2) * from->width + 2 * x + n % 2;
        const int value = from->pixels[4 * at + channel];
        sum += value;
        largest = value > largest ? value : largest;
    }
    return (uint8_t)(mean ? (sum + 2) / 4 : largest);
}

static cw_status shrink_image(cw_image *image, bool mean, cw_error *err)
{
    cw_image small = {0};
    cw_status st = cw_image_alloc(&small, image->width / 2, image->height / 2, err);
    if (st != CW_OK)
        return st;
    for (size_t y = 0; y < small.height; y++)
        for (size_t x = 0; x < small.width; x++)
            for (size_t c = 0; c < 4; c++)
                small.pixels[4 * (y * small.width + x) + c] = join_four(image, x, y, c, mean);
    cw_image_free(image);
    *image = small;
    return CW_OK;
}

/* A picture over black, as a PNG. */
static cw_status show_picture(const cli_study *s, const cw_picture *picture, thumbnail size,
                              cli_png *png, cw_error *err)
{
    static const uint8_t black[2][4] = {{0, 0, 0, 255}, {0, 0, 0, 255}};
    cw_image image = {0};
    cw_status st = cw_picture_show(picture, black, &image, err);
    if (st == CW_OK && size != FULL_SIZE)
        st = shrink_image(&image, size == MEAN_OF_FOUR, err);
    if (st == CW_OK)
        st = cli_make_png(s, &image, png, err);
    cw_image_free(&image);
    return st;
}

/* Draws what points of a kind are compared with. */
static cw_status need_reference(cli_study *s, const cli_point *p, cw_error *err)
{
    cli_reference *r = &s->references[p->tried.reference];
    const cw_mode of = kinds[p->tried.reference];
    cw_scene scene;
    cw_status st = CW_OK;
    if (r->picture.pixels)
        return CW_OK;
    const char *kind = cwi_volume_kind(&s->drawn);
    if (kind)
        return cwi_fail(err, CW_ERR_UNSUPPORTED, "%s is not drawn", kind);
    if (!s->cpu)
        st = cw_renderer_new(CW_BACKEND_CPU, &s->cpu, err);
    cli_scene plain = p->tried.scene;
    plain.step.given = plain.tree_error.given = false;
    plain.slices = 0;
    plain.target = 0;
    plain.reference_of = of == CW_MODE_REFERENCE ? (cw_mode)0 : of;
    if (st == CW_OK)
        st = fit_transfer(s, &plain, of == CW_MODE_REFERENCE ? CW_MODE_COMPOSITE : of, r, err);
    if (st == CW_OK)
        st = make_scene(s, &plain, CW_MODE_REFERENCE, r, &scene, err);
    const double start = cli_seconds();
    if (st == CW_OK)
        st = cw_render(s->cpu, &scene, &r->picture, err);
    r->seconds = cli_seconds() - start;
    if (st == CW_OK)
        st = show_picture(s, &r->picture, FULL_SIZE, &r->drawn, err);
    if (st != CW_OK)
        cw_picture_free(&r->picture);
    return st;
}

/* The first picture takes what the volume takes to get there, and does not count, unless it
 * takes so long that it has to be the only one. Of slow ones one more is timed, of others
 * three. */
static cw_status draw_scene(cw_renderer *renderer, const cw_scene *scene, cw_picture *picture,
                            cli_point *p, cw_error *err)
{
    const double begin = cli_seconds();
    cw_status st = cw_render(renderer, scene, picture, err);
    const double first = cli_seconds() - begin;
    if (first > VERY_SLOW_SECONDS)
        cli_add_run(p, first);
    while (st == CW_OK && p->runs < CLI_MAX_RUNS &&
           (p->runs == 0 || p->times[0] < SLOW_SECONDS)) {
        const double start = cli_seconds();
        cw_picture_free(picture);
        st = cw_render(renderer, scene, picture, err);
        cli_add_run(p, cli_seconds() - start);
    }
    return st;
}

static cw_status need_renderer(cli_study *s, cw_mode mode, cw_renderer **renderer,
                               cw_error *err)
{
    cw_status st = CW_OK;
    if (mode != CW_MODE_VBUFFER && !s->renderer) {
        st = cw_renderer_new(CW_BACKEND_EGL, &s->renderer, err);
        if (st == CW_OK)
            snprintf(s->backend, sizeof s->backend, "%s", cw_renderer_name(s->renderer));
    }
    *renderer = mode == CW_MODE_VBUFFER ? s->cpu : s->renderer;
    return st;
}

static cw_status show_difference(const cli_study *s, const cw_picture *picture,
                                 const cw_picture *reference, cli_point *p, cw_error *err)
{
    cw_picture difference = {0};
    cw_status st =
        cw_picture_difference(picture, reference, CLI_STUDY_AMPLIFY, &difference, err);
    if (st == CW_OK)
        st = show_picture(s, &difference, LARGEST_OF_FOUR, &p->difference, err);
    cw_picture_free(&difference);
    return st;
}

cw_status cli_try_rendering(cli_study *s, cli_point *p, cw_error *err)
{
    static const float black[2][3];
    const cli_reference *r = &s->references[p->tried.reference];
    cw_scene scene;
    cw_renderer *renderer;
    cw_picture picture = {0};
    cw_status st = need_reference(s, p, err);
    if (st == CW_OK)
        st = need_renderer(s, p->tried.mode, &renderer, err);
    if (st == CW_OK)
        st = make_scene(s, &p->tried.scene, p->tried.mode, r, &scene, err);
    if (st == CW_OK)
        st = draw_scene(renderer, &scene, &picture, p, err);
    if (st == CW_OK)
        st = cw_picture_compare(&picture, &r->picture, black, &p->picture, err);
    if (st == CW_OK)
        st = show_picture(s, &picture, MEAN_OF_FOUR, &p->drawn, err);
    if (st == CW_OK)
        st = show_difference(s, &picture, &r->picture, p, err);
    cw_picture_free(&picture);
    return st;
}
