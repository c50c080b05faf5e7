/* Pictures of meshes in the colours of their error: drawn on the CPU, so that every build has
 * them. */
#include "cli/inputs/scene_source.h"
#include "cli/render/camera_options.h"
#include "cli/report/study.h"
#include "core/base/memory.h"
#include "core/base/status.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { WIDTH = 480, HEIGHT = 480, SAMPLES = 2 };

/* From a tenth of a percent of a voxel to a whole one. */
static const double DECADES = 3;

void cli_error_color(double share, uint8_t rgb[3])
{
    static const uint8_t stops[][3] = {{24, 52, 110},  {30, 120, 160}, {70, 180, 140},
                                       {220, 210, 90}, {240, 140, 50}, {190, 30, 45}};
    enum { LAST = sizeof stops / sizeof *stops - 1 };
    const double at = fmin(fmax(share, 0), 1) * LAST;
    const int n = at < LAST ? (int)at : LAST - 1;
    for (int c = 0; c < 3; c++)
        rgb[c] = (uint8_t)(stops[n][c] + (at - n) * (stops[n + 1][c] - stops[n][c]) + 0.5);
}

static double share_of(double mm, double voxel_mm)
{
    return 1 + log10(fmax(fabs(mm) / voxel_mm, 1e-9)) / DECADES;
}

static cw_status draw_errors(cli_study *s, const cw_mesh *around, const cw_mesh *mesh,
                             cw_picture *picture, cw_error *err)
{
    const cli_scene look = {.camera = "front"};
    const cli_turns turns = {0};
    cw_scene scene = {.mode = CW_MODE_MESH,
                      .mesh = mesh,
                      .width = WIDTH,
                      .height = HEIGHT,
                      .samples = SAMPLES,
                      .threads = s->threads};
    double box[2][3];
    cw_status st = CW_OK;
    cli_find_box(NULL, around, box);
    if (!s->cpu)
        st = cw_renderer_new(CW_BACKEND_CPU, &s->cpu, err);
    if (st == CW_OK)
        st = cli_find_camera(&look, &turns, 0, (const double(*)[3])box, 1, &scene.camera, err);
    if (st == CW_OK)
        cw_renderer_forget(s->cpu);
    return st == CW_OK ? cw_render(s->cpu, &scene, picture, err) : st;
}

static cw_status load_file(const char *path, char **bytes, size_t *size, cw_error *err)
{
    FILE *f = fopen(path, "rb");
    long length = 0;
    *bytes = NULL;
    if (f && fseek(f, 0, SEEK_END) == 0 && (length = ftell(f)) > 0 &&
        fseek(f, 0, SEEK_SET) == 0)
        *bytes = malloc((size_t)length);
    *size = *bytes ? fread(*bytes, 1, (size_t)length, f) : 0;
    if (f)
        fclose(f);
    return *size && *size == (size_t)length
               ? CW_OK
               : cwi_fail(err, CW_ERR_OUTPUT, "%s cannot be read back", path);
}

static cw_status save_and_load(cli_study *s, const cw_image *image, char **png, size_t *size,
                               cw_error *err)
{
    char path[4096];
    snprintf(path, sizeof path, "%s/errors.png", s->folder);
    cw_status st = cw_image_write(path, image, err);
    if (st == CW_OK)
        st = load_file(path, png, size, err);
    remove(path);
    return st;
}

cw_status cli_draw_errors(cli_study *s, const cw_mesh *around, const cw_mesh *mesh,
                          const float *mm, char **png, size_t *size, cw_error *err)
{
    static const uint8_t clear[2][4];
    cw_mesh colored = *mesh; /* borrowed but for the colours */
    cw_picture picture = {0};
    cw_image image = {0};
    colored.colors = cwi_alloc_array(mesh->vertex_count, 4);
    if (!colored.colors)
        return cwi_fail(err, CW_ERR_NO_MEMORY, "no memory for a picture");
    for (size_t v = 0; v < mesh->vertex_count; v++) {
        cli_error_color(share_of((double)mm[v], s->voxel_mm), colored.colors + 4 * v);
        colored.colors[4 * v + 3] = 255;
    }
    cw_status st = draw_errors(s, around, &colored, &picture, err);
    if (st == CW_OK)
        st = cw_picture_show(&picture, clear, &image, err);
    if (st == CW_OK)
        st = save_and_load(s, &image, png, size, err);
    cw_picture_free(&picture);
    cw_image_free(&image);
    cwi_free(colored.colors);
    return st;
}
