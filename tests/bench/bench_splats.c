/* Splatting at every kernel and at several errors of the octree: processor time of a picture
 * (all threads, the median after the first), and its error, to the rendering integral and to
 * flat splatting.
 *
 * bench_splats [--frames 3] SCAN PRESET
 *
 * Pictures are unlit, 640 x 480. Prints a JSON line a picture, which splats.py plots. Errors are
 * RMSE in 1/255. */
#include "bench.h"
#include "support/pictures.h"

#include <cubewright/formats.h>

#include <string.h>

enum { MAX_FRAMES = 31, WIDTH = 640, HEIGHT = 480 };

static const char *const kernels[CW_SPLAT_COUNT] = {"gaussian", "polygon", "tent", "b-spline"};
static const double errors[] = {0, 0.01, 0.02, 0.04, 0.07, 0.1, 0.15, 0.2, 0.3};

/* Draws a scene; returns the median time. */
static double draw(cw_renderer *r, const cw_scene *scene, int frames, cw_picture *picture)
{
    cw_error err = {0};
    double all[MAX_FRAMES];
    for (int n = 0; n <= frames; n++) {
        const double start = bench_cpu_ms();
        cw_picture_free(picture);
        bench_check(cw_render(r, scene, picture, &err), &err);
        all[n] = bench_cpu_ms() - start;
    }
    return bench_median(all + 1, frames);
}

static double rmse_between(const cw_picture *a, const cw_picture *b)
{
    static const float black[2][3];
    cw_error err = {0};
    cw_comparison gap;
    bench_check(cw_picture_compare(a, b, black, &gap, &err), &err);
    return gap.rmse;
}

/* Draws flat, then with each error of the octree. */
static void run_kernel(cw_renderer *r, cw_scene scene, int kernel, int frames,
                       const cw_picture *truth)
{
    cw_picture flat = {0};
    scene.splat_kernel = (cw_splat_kernel)kernel;
    for (size_t n = 0; n < sizeof errors / sizeof *errors; n++) {
        cw_picture picture = {0};
        scene.mode = errors[n] > 0 ? CW_MODE_SPLAT_TREE : CW_MODE_SPLAT;
        scene.tree_error = errors[n];
        const double ms = draw(r, &scene, frames, &picture);
        if (!flat.pixels) {
            flat = picture;
            picture = (cw_picture){0};
        }
        const cw_picture *drawn = picture.pixels ? &picture : &flat;
        printf("{\"kernel\":\"%s\",\"tree_error\":%g,\"ms\":%.1f,\"rmse\":%.4f,"
               "\"from_flat\":%.4f}\n",
               kernels[kernel], errors[n], ms, rmse_between(drawn, truth),
               rmse_between(drawn, &flat));
        fflush(stdout);
        cw_picture_free(&picture);
    }
    cw_picture_free(&flat);
}

int main(int argc, char **argv)
{
    cw_error err = {0};
    cw_renderer *r, *cpu;
    cw_volume v;
    cw_statistics statistics;
    cw_transfer transfer;
    cw_picture truth = {0};
    int frames = 3, n = 1;
    if (argc > 2 && strcmp(argv[1], "--frames") == 0) {
        frames = atoi(argv[2]) < MAX_FRAMES ? atoi(argv[2]) : MAX_FRAMES - 1;
        n = 3;
    }
    if (argc - n != 2) {
        fprintf(stderr, "bench_splats [--frames 3] SCAN PRESET\n");
        return 2;
    }
    bench_check(cw_volume_read(argv[n], NULL, &v, NULL, &err), &err);
    bench_check(cw_volume_statistics(&v, 256, 0, &statistics, &err), &err);
    bench_check(cw_transfer_preset(argv[n + 1], &statistics, &transfer, &err), &err);
    bench_check(cw_renderer_new(CW_BACKEND_EGL, &r, &err), &err);
    bench_check(cw_renderer_new(CW_BACKEND_CPU, &cpu, &err), &err);
    cw_scene scene = {.mode = CW_MODE_REFERENCE,
                      .volume = &v,
                      .transfer = &transfer,
                      .width = WIDTH,
                      .height = HEIGHT};
    bench_check(cw_render(cpu, &scene, &truth, &err), &err);
    for (int kernel = 0; kernel < CW_SPLAT_COUNT; kernel++)
        run_kernel(r, scene, kernel, frames, &truth);
    cw_picture_free(&truth);
    cw_renderer_free(cpu);
    cw_renderer_free(r);
    cw_statistics_free(&statistics);
    cw_volume_free(&v);
    return 0;
}
