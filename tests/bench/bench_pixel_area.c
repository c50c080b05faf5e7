/* Pixels wider than a cell: time and error of one sample a pixel, of the pixel's area
 * (`pixel_area`), and of more samples, in the mode vbuffer.
 *
 * bench_pixel_area [--size 80] [SCAN PRESET]...
 *
 * Without scans a made field with fine structure is drawn. Prints a JSON line a picture:
 * processor time of all threads, the median of five after the first, and of the first; error as
 * RMSE in 1/255 against the mean of 16 x 16 samples a pixel. */
#include "bench.h"
#include "support/pictures.h"

#include <cubewright/formats.h>

#include <math.h>
#include <string.h>

enum { FRAMES = 5, FIELD = 192, MORE = 4 };

static cw_picture draw(cw_backend backend, const cw_scene *scene, double *first, double *median)
{
    cw_error err = {0};
    cw_picture picture = {0};
    cw_renderer *r;
    double all[FRAMES + 1];
    bench_check(cw_renderer_new(backend, &r, &err), &err);
    for (int n = 0; n <= FRAMES; n++) {
        const double start = bench_cpu_ms();
        cw_picture_free(&picture);
        bench_check(cw_render(r, scene, &picture, &err), &err);
        all[n] = bench_cpu_ms() - start;
    }
    *first = all[0];
    *median = bench_median(all + 1, FRAMES);
    cw_renderer_free(r);
    return picture;
}

/* Draws 16 x 16 samples a pixel: a picture of MORE times the size, each pixel of 4 x 4. */
static cw_picture draw_truth(cw_scene scene)
{
    cw_error err = {0};
    cw_picture fine = {0}, truth = {0};
    cw_renderer *r;
    const size_t width = scene.width, height = scene.height;
    bench_check(cw_renderer_new(CW_BACKEND_CPU, &r, &err), &err);
    bench_check(cw_picture_alloc(&truth, width, height, &err), &err);
    scene.samples = 4;
    scene.width *= MORE;
    scene.height *= MORE;
    bench_check(cw_render(r, &scene, &fine, &err), &err);
    for (size_t y = 0; y < fine.height; y++)
        for (size_t x = 0; x < fine.width; x++)
            for (size_t c = 0; c < 4; c++)
                truth.pixels[4 * (y / MORE * width + x / MORE) + c] +=
                    fine.pixels[4 * (y * fine.width + x) + c] / (float)(MORE * MORE);
    cw_picture_free(&fine);
    cw_renderer_free(r);
    return truth;
}

static void run_scene(const char *name, cw_scene scene)
{
    static const char *const ways[] = {"1 sample", "pixel area", "2 x 2", "3 x 3", "4 x 4"};
    static const float black[2][3];
    cw_picture truth = draw_truth(scene);
    for (int n = 0; n < 5; n++) {
        cw_error err = {0};
        cw_comparison gap;
        double first, median;
        scene.samples = n > 1 ? n : 1;
        scene.pixel_area = n == 1;
        cw_picture drawn = draw(CW_BACKEND_CPU, &scene, &first, &median);
        bench_check(cw_picture_compare(&drawn, &truth, black, &gap, &err), &err);
        printf("{\"scene\":\"%s\",\"lit\":%d,\"perspective\":%d,\"way\":\"%s\",\"ms\":%.2f,"
               "\"first_ms\":%.1f,\"rmse\":%.3f,\"bias\":%.3f}\n",
               name, scene.lit, scene.camera.fov_deg > 0, ways[n], median, first, gap.rmse,
               gap.bias);
        fflush(stdout);
        cw_picture_free(&drawn);
    }
    cw_picture_free(&truth);
}

/* Draws lit and unlit, in perspective and without. */
static void run_volume(const char *name, const cw_volume *v, const cw_transfer *transfer,
                       size_t size)
{
    cw_error err = {0};
    cw_volume resolved;
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    bench_check(cw_volume_resolve(v, &resolved, &err), &err);
    for (int n = 0; n < 8; n++) {
        double index[3], p[3];
        for (int a = 0; a < 3; a++)
            index[a] = n >> a & 1 ? (double)resolved.dim[a] - 1 : 0;
        cw_volume_to_world(&resolved, index, p);
        for (int a = 0; a < 3; a++) {
            low[a] = fmin(low[a], p[a]);
            high[a] = fmax(high[a], p[a]);
        }
    }
    cw_scene scene = {.mode = CW_MODE_VBUFFER,
                      .volume = v,
                      .transfer = transfer,
                      .width = size,
                      .height = size};
    for (int n = 0; n < 4; n++) {
        cw_fit_desc fit = {
            .aspect = 1, .fov_deg = n & 2 ? 30 : 0, .margin = 0.04, .view = "iso"};
        memcpy(fit.min, low, sizeof low);
        memcpy(fit.max, high, sizeof high);
        bench_check(cw_camera_fit(&fit, &scene.camera, &err), &err);
        scene.lit = n & 1;
        run_scene(name, scene);
    }
}

/* Shells of a gyroid, 12 cells apart, in a ball. */
static double gyroid(const double p[3], const double q[3])
{
    static const double k = 6.2831853 / 12;
    const double g = sin(k * p[0]) * cos(k * p[1]) + sin(k * p[1]) * cos(k * p[2]) +
                     sin(k * p[2]) * cos(k * p[0]);
    const double ball = 3 * (0.85 - sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2]));
    return fmin(fmax(0.5 + g, 0), fmin(fmax(0.5 + 4 * ball, 0), 1));
}

int main(int argc, char **argv)
{
    cw_error err = {0};
    size_t size = 80;
    int n = 1;
    if (argc > 2 && strcmp(argv[1], "--size") == 0) {
        size = (size_t)atoi(argv[2]);
        n = 3;
    }
    if ((argc - n) % 2 != 0) {
        fprintf(stderr, "bench_pixel_area [--size 80] [SCAN PRESET]...\n");
        return 2;
    }
    if (n == argc) {
        cw_volume v = {0};
        const cw_transfer soft = test_soft_transfer();
        test_field(&v, FIELD, FIELD, FIELD, (const double[3]){1, 1, 1}, gyroid);
        run_volume("gyroid", &v, &soft, size);
        cw_volume_free(&v);
    }
    for (; n < argc; n += 2) {
        cw_volume v;
        cw_statistics statistics;
        cw_transfer transfer;
        const char *slash = strrchr(argv[n], '/');
        bench_check(cw_volume_read(argv[n], NULL, &v, NULL, &err), &err);
        bench_check(cw_volume_statistics(&v, 1024, 0, &statistics, &err), &err);
        bench_check(cw_transfer_preset(argv[n + 1], &statistics, &transfer, &err), &err);
        run_volume(slash ? slash + 1 : argv[n], &v, &transfer, size);
        cw_statistics_free(&statistics);
        cw_volume_free(&v);
    }
    return 0;
}
