/* Rendering: modes and how finely they sample, against the rendering integral itself. */
#include "cli/framework/console.h"
#include "cli/inputs/scene_source.h"
#include "cli/render/camera_options.h"
#include "cli/report/study.h"
#include "core/base/status.h"
#include "core/volume/volume.h"

#include <stdlib.h>
#include <string.h>

enum { FRAMES = 3 };

static const double SLOW_SECONDS = 0.5, /* a second frame is timed alone */
    VERY_SLOW_SECONDS = 4;              /* the first one is */

void cli_plan_rendering(cli_study *s)
{
    static const struct {
        int rank;
        cw_mode mode;
        double step, tree_error;
        size_t slices;
    } rows[] = {
        {1, CW_MODE_COMPOSITE, 1, 0, 0},     {1, CW_MODE_COMPOSITE, 0.5, 0, 0},
        {1, CW_MODE_VBUFFER, 0, 0, 0},       {2, CW_MODE_TEXTURE, 1, 0, 0},
        {2, CW_MODE_COMPOSITE, 2, 0, 0},     {5, CW_MODE_SPLAT_TREE, 0, 0.1, 0},
        {3, CW_MODE_COMPOSITE, 0.25, 0, 0},  {3, CW_MODE_TEXTURE, 0.5, 0, 0},
        {3, CW_MODE_TEXTURE, 2, 0, 0},       {3, CW_MODE_TEXTURE, 0, 0, 64},
        {6, CW_MODE_SPLAT_TREE, 0, 0.02, 0}, {6, CW_MODE_SPLAT_TREE, 0, 0.05, 0},
        {6, CW_MODE_PROJECTION, 0, 0, 0},    {5, CW_MODE_TEXTURE, 0.25, 0, 0},
        {6, CW_MODE_SPLAT, 0, 0, 0},         {7, CW_MODE_SPLAT_TREE, 0, 0.005, 0},
    };
    for (size_t n = 0; n < sizeof rows / sizeof *rows; n++) {
        const char *mode = cw_mode_name(rows[n].mode);
        cli_point *p = cli_add_point(s, CLI_RENDERING, rows[n].rank, mode, "%s", mode);
        cli_scene *scene = &p->tried.scene;
        p->tried.mode = rows[n].mode;
        *scene = (cli_scene){.camera = "front", .preintegration = true, .skipping = true};
        scene->step = (cli_number){rows[n].step > 0, rows[n].step};
        scene->tree_error = (cli_number){rows[n].tree_error > 0, rows[n].tree_error};
        scene->slices = rows[n].slices;
        const size_t end = strlen(p->name);
        if (scene->step.given)
            snprintf(p->name + end, sizeof p->name - end, ", step %g", rows[n].step);
        if (scene->tree_error.given)
            snprintf(p->name + end, sizeof p->name - end, ", error %g", rows[n].tree_error);
        if (scene->slices)
            snprintf(p->name + end, sizeof p->name - end, ", %zu slices", scene->slices);
    }
}

static cw_status make_scene(cli_study *s, const cli_scene *args, cw_mode mode, cw_scene *scene,
                            cw_error *err)
{
    const cli_turns turns = {0};
    const cli_subject subject = {
        .volume = &s->drawn, .whole = &s->volume->whole, .threads = s->threads};
    double box[2][3];
    *scene = (cw_scene){.width = CLI_STUDY_WIDTH, .height = CLI_STUDY_HEIGHT, .samples = 1};
    scene->progress = cli_progress(1, "picture");
    cli_find_box(&s->drawn, NULL, box);
    cw_status st =
        cli_find_camera(args, &turns, 0, (const double(*)[3])box,
                        (double)CLI_STUDY_WIDTH / CLI_STUDY_HEIGHT, &scene->camera, err);
    return st == CW_OK ? cli_make_scene(args, &subject, mode, &s->transfer, scene, err) : st;
}

/* The picture that all others are compared with, and the transfer function of all. */
static cw_status need_reference(cli_study *s, const cli_scene *args, cw_error *err)
{
    cw_scene scene;
    cw_status st = CW_OK;
    if (s->reference.pixels)
        return CW_OK;
    const char *kind = cwi_volume_kind(&s->drawn);
    if (kind)
        return cwi_fail(err, CW_ERR_UNSUPPORTED, "%s is not drawn", kind);
    if (!s->cpu)
        st = cw_renderer_new(CW_BACKEND_CPU, &s->cpu, err);
    if (st == CW_OK)
        st = cli_make_transfer(args, &s->drawn, CW_MODE_COMPOSITE, s->threads, &s->transfer,
                               err);
    cli_scene plain = *args;
    plain.step.given = plain.tree_error.given = false;
    plain.slices = 0;
    if (st == CW_OK)
        st = make_scene(s, &plain, CW_MODE_REFERENCE, &scene, err);
    const double start = cli_seconds();
    if (st == CW_OK)
        st = cw_render(s->cpu, &scene, &s->reference, err);
    s->reference_seconds = st == CW_OK ? cli_seconds() - start : 0;
    return st;
}

static int by_size(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* The first picture takes what the volume takes to get there; the median of the next, unless
 * that would take too long. */
static cw_status draw_scene(cw_renderer *renderer, const cw_scene *scene, cw_picture *picture,
                            double *seconds, cw_error *err)
{
    double all[FRAMES];
    int frames = 0;
    const double begin = cli_seconds();
    cw_status st = cw_render(renderer, scene, picture, err);
    all[0] = cli_seconds() - begin;
    if (all[0] > VERY_SLOW_SECONDS)
        frames = FRAMES;
    for (int n = 1; n < frames; n++)
        all[n] = all[0];
    while (st == CW_OK && frames < FRAMES && (frames == 0 || all[0] < SLOW_SECONDS)) {
        const double start = cli_seconds();
        cw_picture_free(picture);
        st = cw_render(renderer, scene, picture, err);
        all[frames++] = cli_seconds() - start;
    }
    if (st != CW_OK)
        return st;
    qsort(all, (size_t)frames, sizeof *all, by_size);
    *seconds = all[frames / 2];
    return CW_OK;
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

cw_status cli_try_rendering(cli_study *s, cli_point *p, cw_error *err)
{
    static const float black[2][3];
    cw_scene scene;
    cw_renderer *renderer;
    cw_picture picture = {0};
    cw_status st = need_reference(s, &p->tried.scene, err);
    if (st == CW_OK)
        st = need_renderer(s, p->tried.mode, &renderer, err);
    if (st == CW_OK)
        st = make_scene(s, &p->tried.scene, p->tried.mode, &scene, err);
    if (st == CW_OK)
        st = draw_scene(renderer, &scene, &picture, &p->seconds, err);
    if (st == CW_OK)
        st = cw_picture_compare(&picture, &s->reference, black, &p->picture, err);
    cw_picture_free(&picture);
    return st;
}
