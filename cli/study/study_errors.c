/* Meshes in the colours of their error: pictures, drawn on the CPU so that every build has
 * them, and the mesh for the view of three dimensions. */
#include "cli/framework/console.h"
#include "cli/inputs/scene_source.h"
#include "cli/render/camera_options.h"
#include "cli/study/study.h"
#include "core/base/memory.h"
#include "core/base/status.h"

#include <cubewright/simplify.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { WIDTH = 400, HEIGHT = 400, SAMPLES = 2 };

/* From a tenth of a percent of a voxel to a whole one. */
static const double DECADES = 3;

void cli_error_color(double fraction, uint8_t rgb[3])
{
    static const uint8_t stops[][3] = {{24, 52, 110},  {30, 120, 160}, {70, 180, 140},
                                       {220, 210, 90}, {240, 140, 50}, {190, 30, 45}};
    enum { LAST = sizeof stops / sizeof *stops - 1 };
    const double at = fmin(fmax(fraction, 0), 1) * LAST;
    const int n = at < LAST ? (int)at : LAST - 1;
    for (int c = 0; c < 3; c++)
        rgb[c] = (uint8_t)(stops[n][c] + (at - n) * (stops[n + 1][c] - stops[n][c]) + 0.5);
}

double cli_error_share(double mm, double voxel_mm)
{
    return 1 + log10(fmax(fabs(mm) / voxel_mm, 1e-9)) / DECADES;
}

static cw_status draw_mesh(cli_study *s, const cw_mesh *around, const cw_mesh *mesh,
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

static cw_status load_file(const char *path, cli_png *png, cw_error *err)
{
    FILE *f = fopen(path, "rb");
    long length = 0;
    *png = (cli_png){0};
    if (f && fseek(f, 0, SEEK_END) == 0 && (length = ftell(f)) > 0 &&
        fseek(f, 0, SEEK_SET) == 0)
        png->bytes = malloc((size_t)length);
    png->size = png->bytes ? fread(png->bytes, 1, (size_t)length, f) : 0;
    if (f)
        fclose(f);
    return png->size && png->size == (size_t)length
               ? CW_OK
               : cwi_fail(err, CW_ERR_OUTPUT, "%s cannot be read back", path);
}

cw_status cli_make_png(const cli_study *s, const cw_image *image, cli_png *png, cw_error *err)
{
    char path[4096];
    snprintf(path, sizeof path, "%s/picture.png", s->folder);
    free(png->bytes);
    *png = (cli_png){0};
    cw_status st = cw_image_write(path, image, err);
    if (st == CW_OK)
        st = load_file(path, png, err);
    remove(path);
    return st;
}

static void color_errors(const cli_study *s, const cw_mesh *mesh, const float *mm,
                         uint8_t *colors)
{
    for (size_t v = 0; v < mesh->vertex_count; v++) {
        cli_error_color(cli_error_share((double)mm[v], s->voxel_mm), colors + 4 * v);
        colors[4 * v + 3] = 255;
    }
}

cw_status cli_draw_mesh(cli_study *s, const cw_mesh *around, const cw_mesh *mesh,
                        const float *mm, cli_png *png, cw_error *err)
{
    static const uint8_t clear[2][4];
    cw_mesh colored = *mesh; /* borrowed but for the colours */
    cw_picture picture = {0};
    cw_image image = {0};
    uint8_t *colors = mm ? cwi_alloc_array(mesh->vertex_count, 4) : NULL;
    if (mm && !colors)
        return cwi_fail_memory(err);
    if (mm) {
        color_errors(s, mesh, mm, colors);
        colored.colors = colors;
    }
    cw_status st = draw_mesh(s, around, &colored, &picture, err);
    if (st == CW_OK)
        st = cw_picture_show(&picture, clear, &image, err);
    if (st == CW_OK)
        st = cli_make_png(s, &image, png, err);
    cw_picture_free(&picture);
    cw_image_free(&image);
    cwi_free(colors);
    return st;
}

static cw_status pack_colored(const cli_study *s, const cw_mesh *mesh, const float *mm,
                              cli_packed *packed, cw_error *err)
{
    uint8_t *bytes = mm ? cwi_alloc_array(mesh->vertex_count, 1) : NULL;
    if (mm && !bytes)
        return cwi_fail_memory(err);
    for (size_t v = 0; v < mesh->vertex_count && mm; v++) {
        const double fraction = cli_error_share((double)mm[v], s->voxel_mm);
        bytes[v] = (uint8_t)(255 * fmin(fmax(fraction, 0), 1) + 0.5);
    }
    cw_status st = cli_pack_mesh(mesh, bytes, packed, err);
    cwi_free(bytes);
    return st;
}

/* Share of the budget that may go into simplifying one mesh for the page. */
static const double PAGE_SHARE = 0.25;

/* The simplified mesh has the errors of the full one, each vertex that of its closest point. */
static cw_status simplify_and_pack(cli_study *s, const cw_mesh *mesh, const float *mm,
                                   cli_packed *packed, cw_error *err)
{
    const cw_simplify_desc desc = {
        .triangles = CLI_PACKED_TRIANGLES,
        .threads = s->threads,
        .progress = cli_progress((double)mesh->triangle_count / 1e6, "Mtriangle")};
    cw_mesh full = *mesh; /* borrowed but for the scalars */
    cw_mesh small = {0};
    full.colors = NULL;
    full.normals = NULL;
    full.labels = NULL;
    full.scalars = mm ? cwi_alloc_array(mesh->vertex_count, sizeof *mm) : NULL;
    if (mm && !full.scalars)
        return cwi_fail_memory(err);
    if (mm)
        memcpy(full.scalars, mm, mesh->vertex_count * sizeof *mm);
    s->extra_deadline = cli_seconds() + PAGE_SHARE * s->budget_s;
    cw_status st = cw_simplify(&full, &desc, &small, NULL, err);
    s->extra_deadline = 0;
    cwi_free(full.scalars);
    if (st == CW_OK && small.triangle_count > 2 * CLI_PACKED_TRIANGLES)
        snprintf(packed->why, sizeof packed->why,
                 "%zu triangles are left when it is simplified", small.triangle_count);
    else if (st == CW_OK)
        st = pack_colored(s, &small, small.scalars, packed, err);
    packed->made_of = mesh->triangle_count;
    cw_mesh_free(&small);
    return st;
}

cw_status cli_pack_errors(cli_study *s, const cw_mesh *mesh, const float *mm,
                          cli_packed *packed, cw_error *err)
{
    cw_error why = {0};
    if (mesh->triangle_count <= CLI_PACKED_TRIANGLES)
        return pack_colored(s, mesh, mm, packed, err);
    *packed = (cli_packed){0};
    cw_status st = cli_time_is_up(s) || !cw_simplify_available()
                       ? CW_ERR_CANCELLED
                       : simplify_and_pack(s, mesh, mm, packed, &why);
    if (st == CW_OK)
        return CW_OK;
    if (cli_interrupted()) {
        *err = why;
        return st;
    }
    snprintf(packed->why, sizeof packed->why,
             "it has %zu triangles, and was not simplified for the page%s",
             mesh->triangle_count,
             cw_simplify_available() ? " in the time there was" : ": this build cannot");
    return CW_OK;
}
