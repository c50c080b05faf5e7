/* Reads the cameras of extract, draws depths for them, drops triangles that no view sees,
 * and compares pictures with those of the full surface. */
#include "cli/extract/pixel_proof.h"

#include "cli/extract/extract_proof.h"
#include "cli/framework/console.h"
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/volume/volume.h"

#include <cubewright/render.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MAX_SIDE = 16384, MAX_PATH = 4096, SHOWN = 2 }; /* SHOWN: a difference in 1/255 */

/* --- cameras ------------------------------------------------------------------------------ */

static cw_status check_arguments(const cli_pixel_args *a, cw_error *err)
{
    const size_t *n = a->size.n;
    if (a->camera && !a->pixels.given && a->most.given)
        return cwi_fail(err, CW_ERR_ARGUMENT, "--camera and --max-error need --pixel-error");
    if (a->pixels.given && !(isfinite(a->pixels.value) && a->pixels.value > 0))
        return cwi_fail(err, CW_ERR_ARGUMENT, "--pixel-error %g: it must be above 0",
                        a->pixels.value);
    if (a->shading.given && !(a->shading.value > 0 && a->shading.value <= 180))
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "--shading %g: above 0 and up to 180 degrees were expected",
                        a->shading.value);
    if (a->size.count && (a->size.count != 2 || n[0] > MAX_SIDE || n[1] > MAX_SIDE))
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "--size takes two numbers up to %d, such as 1280x720", MAX_SIDE);
    return CW_OK;
}

static cw_status read_files(const char *list, cw_simplify_view *views, size_t *count,
                            cw_error *err)
{
    char path[MAX_PATH];
    cw_status st = CW_OK;
    for (const char *p = list; st == CW_OK && p; (*count)++) {
        const size_t length = strcspn(p, ",");
        if (length == 0 || length >= sizeof path)
            return cwi_fail(err, CW_ERR_ARGUMENT,
                            "--camera '%s': .json files by comma were expected", list);
        if (*count == CLI_MAX_VIEWS)
            return cwi_fail(err, CW_ERR_ARGUMENT, "--camera takes up to %d files",
                            CLI_MAX_VIEWS);
        memcpy(path, p, length);
        path[length] = '\0';
        st = cw_camera_read(path, &views[*count].camera, err);
        p = p[length] ? p + length + 1 : NULL;
    }
    return st;
}

cw_status cli_read_views(const cli_pixel_args *args, cw_simplify_view *views, size_t *count,
                         cw_error *err)
{
    *count = 0;
    cw_status st = check_arguments(args, err);
    if (st != CW_OK || !args->camera)
        return st;
    if (*args->camera == '{') {
        st = cw_camera_parse(args->camera, &views[0].camera, err);
        *count = 1;
        st = st == CW_OK ? st : cwi_fail_in(err, st, "--camera");
    } else {
        st = read_files(args->camera, views, count, err);
    }
    for (size_t n = 0; n < *count; n++) {
        views[n].width = args->size.count ? args->size.n[0] : 1280;
        views[n].height = args->size.count ? args->size.n[1] : 720;
    }
    return st;
}

/* --- before the surface is made ----------------------------------------------------------- */

cw_status cli_widest_error(const cli_volume *volume, const cw_simplify_view *views,
                           size_t count, double pixels, double *error_mm, cw_error *err)
{
    double corners[8][3];
    cw_volume_corners(&volume->view, corners);
    return cw_simplify_views_error(views, count, pixels, corners[0], 8, error_mm, err);
}

/* --- the proof ---------------------------------------------------------------------------- */

static cw_status measure_distance(const cw_mesh *from, const cw_mesh *to,
                                  const cw_simplify_desc *d, cli_proof *proof, double *most_mm,
                                  cw_error *err)
{
    cw_distance distance;
    float *worst = cwi_alloc_zeroed(from->vertex_count + 1, sizeof *worst);
    const cw_mesh_distance_desc how = {
        .worst = worst, .threads = d->threads, .tolerance_mm = d->error_mm};
    cw_status st = worst ? cw_distance_to_mesh(from, to, &how, &distance, NULL, err)
                         : cwi_fail_memory(err);
    for (size_t n = 0; n < d->view_count && st == CW_OK; n++) {
        double pixels;
        st = cw_simplify_view_distance(d->views + n, from, worst, &pixels, err);
        proof->views[n].pixels = fmax(proof->views[n].pixels, pixels);
    }
    if (st == CW_OK)
        *most_mm = fmax(*most_mm, distance.max_mm);
    cwi_free(worst);
    return st;
}

static cw_status draw_picture(const cw_simplify_view *view, const cw_mesh *mesh, int threads,
                              cw_image *image, cw_error *err)
{
    static const uint8_t white[2][4] = {{255, 255, 255, 255}, {255, 255, 255, 255}};
    const cw_scene scene = {.mode = CW_MODE_MESH,
                            .mesh = mesh,
                            .camera = view->camera,
                            .width = view->width,
                            .height = view->height,
                            .threads = threads};
    cw_renderer *renderer = NULL;
    cw_picture picture = {0};
    cw_status st = cw_renderer_new(CW_BACKEND_CPU, &renderer, err);
    if (st == CW_OK)
        st = cw_render(renderer, &scene, &picture, err);
    if (st == CW_OK)
        st = cw_picture_show(&picture, white, image, err);
    cw_picture_free(&picture);
    cw_renderer_free(renderer);
    return st;
}

static cw_status compare_pictures(const cw_simplify_view *view, const cw_mesh *full,
                                  const cw_mesh *mesh, int threads, cli_view_proof *proof,
                                  cw_error *err)
{
    cw_image a = {0}, b = {0};
    cw_status st = draw_picture(view, full, threads, &a, err);
    if (st == CW_OK)
        st = draw_picture(view, mesh, threads, &b, err);
    size_t differ = 0;
    if (st == CW_OK)
        st = cw_image_compare(&a, &b, SHOWN, &differ, err);
    if (st == CW_OK)
        proof->apart = (double)differ / (double)(a.width * a.height);
    cw_image_free(&a);
    cw_image_free(&b);
    return st;
}

cw_status cli_prove_views(const cli_volume *volume, const cli_surface_settings *settings,
                          const cw_mesh *mesh, cli_proof *proof, cw_error *err)
{
    const cw_simplify_desc *simplify = &settings->simplify;
    cw_mesh full = {0};
    cw_status st = cli_extract_full(volume, settings, proof, &full, err);
    if (st != CW_OK)
        return st;
    proof->count = simplify->view_count;
    proof->promised_pixels = simplify->pixel_error;
    proof->promised_mm = simplify->error_mm;
    if (simplify->pixel_error > 0) {
        double beside = 0, *back = proof->culled ? &beside : &proof->mm;
        st = measure_distance(mesh, &full, simplify, proof, &proof->mm, err);
        if (st == CW_OK)
            st = measure_distance(&full, mesh, simplify, proof, back, err);
    }
    for (size_t n = 0; n < simplify->view_count && st == CW_OK; n++)
        st = compare_pictures(simplify->views + n, &full, mesh, simplify->threads,
                              proof->views + n, err);
    cw_mesh_free(&full);
    return st == CW_OK ? st : cwi_fail_in(err, st, volume->path);
}
