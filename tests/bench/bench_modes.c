/* Every mode of drawing at several settings: processor time of a picture (all threads, the
 * median after the first) against its error, to the rendering integral, or to the exact
 * projection.
 *
 * bench_modes [--size 64] [--picture 256] [--frames 3] [SCAN PRESET]...
 *
 * Fields with a gentle and a narrow transfer function, then the scans. Errors are RMSE and
 * maximum in 1/255, and CIEDE2000. Prints a JSON line a picture on stdout, a table
 * on stderr. */
#include "bench.h"
#include "support/pictures.h"

#include <cubewright/formats.h>

#include <string.h>

enum { MAX_FRAMES = 31 };

typedef struct settings {
    size_t size, picture;
    int frames;
} settings;

typedef struct setting {
    const char *name;
    cw_scene scene; /* what it sets */
    bool lit_reference;
} setting;

static const setting list[] = {
    {"composite, step 4", {.mode = CW_MODE_COMPOSITE, .step_vox = 4}, false},
    {"composite, step 2", {.mode = CW_MODE_COMPOSITE, .step_vox = 2}, false},
    {"composite, step 1", {.mode = CW_MODE_COMPOSITE, .step_vox = 1}, false},
    {"composite, step 1/2", {.mode = CW_MODE_COMPOSITE, .step_vox = 0.5}, false},
    {"composite, cells", {.mode = CW_MODE_COMPOSITE, .cell_steps = true}, false},
    {"composite, midpoint 1", {.mode = CW_MODE_COMPOSITE, .no_preintegration = true}, false},
    {"composite, midpoint 1/2",
     {.mode = CW_MODE_COMPOSITE, .no_preintegration = true, .step_vox = 0.5},
     false},
    {"composite, lit", {.mode = CW_MODE_COMPOSITE, .lit = true}, true},
    {"composite, lit 1/2", {.mode = CW_MODE_COMPOSITE, .lit = true, .step_vox = 0.5}, true},
    {"vbuffer", {.mode = CW_MODE_VBUFFER}, false},
    {"vbuffer, lit", {.mode = CW_MODE_VBUFFER, .lit = true}, true},
    {"texture, step 4", {.mode = CW_MODE_TEXTURE, .step_vox = 4}, false},
    {"texture, step 1", {.mode = CW_MODE_TEXTURE}, false},
    {"texture, step 1/2", {.mode = CW_MODE_TEXTURE, .step_vox = 0.5}, false},
    {"texture, 16 bits", {.mode = CW_MODE_TEXTURE, .target = CW_TARGET_16}, false},
    {"texture, 16 bits float", {.mode = CW_MODE_TEXTURE, .target = CW_TARGET_16F}, false},
    {"texture, 8 bits", {.mode = CW_MODE_TEXTURE, .target = CW_TARGET_8}, false},
    {"texture, colours first", {.mode = CW_MODE_TEXTURE, .colors_first = true}, false},
    {"texture, lit", {.mode = CW_MODE_TEXTURE, .lit = true}, true},
    {"shaded texture, 64", {.mode = CW_MODE_SHADED_TEXTURE, .lit = true, .normals = 64}, true},
    {"shaded texture, 1024", {.mode = CW_MODE_SHADED_TEXTURE, .lit = true}, true},
    {"shaded texture, 4096",
     {.mode = CW_MODE_SHADED_TEXTURE, .lit = true, .normals = 4096},
     true},
    {"projection", {.mode = CW_MODE_PROJECTION}, false},
    {"projection, linear", {.mode = CW_MODE_PROJECTION, .linear_opacity = true}, false},
    {"splat", {.mode = CW_MODE_SPLAT}, false},
    {"splat, tent", {.mode = CW_MODE_SPLAT, .splat_kernel = CW_SPLAT_TENT}, false},
    {"splat, b-spline", {.mode = CW_MODE_SPLAT, .splat_kernel = CW_SPLAT_B_SPLINE}, false},
    {"splat tree, 0.01", {.mode = CW_MODE_SPLAT_TREE, .tree_error = 0.01}, false},
    {"splat tree, 0.05", {.mode = CW_MODE_SPLAT_TREE, .tree_error = 0.05}, false},
    {"mip, step 2", {.mode = CW_MODE_MIP, .step_vox = 2}, false},
    {"mip, step 1", {.mode = CW_MODE_MIP}, false},
    {"mip, step 1/2", {.mode = CW_MODE_MIP, .step_vox = 0.5}, false},
    {"mip, cells", {.mode = CW_MODE_MIP, .cell_steps = true}, false},
    {"minip, step 1", {.mode = CW_MODE_MINIP}, false},
    {"average, step 1", {.mode = CW_MODE_AVERAGE}, false},
    {"average, cells", {.mode = CW_MODE_AVERAGE, .cell_steps = true}, false},
};

static bool is_intensity(cw_mode mode)
{
    return mode == CW_MODE_MIP || mode == CW_MODE_MINIP || mode == CW_MODE_AVERAGE ||
           mode == CW_MODE_LOCAL_MIP;
}

/* The exact picture of what a setting draws. */
static void draw_truth(cw_renderer *cpu, const cw_scene *scene, cw_picture *truth)
{
    cw_error err = {0};
    cw_scene s = *scene;
    if (!is_intensity(s.mode))
        s.mode = CW_MODE_REFERENCE;
    bench_check(cw_render(cpu, &s, truth, &err), &err);
}

/* Median time; false when this build does not draw it. */
static bool draw(cw_renderer *r, const cw_scene *scene, int frames, double *ms,
                 cw_picture *picture)
{
    cw_error err = {0};
    double all[MAX_FRAMES];
    for (int n = 0; n <= frames; n++) {
        const double start = bench_cpu_ms();
        cw_picture_free(picture);
        const cw_status st = cw_render(r, scene, picture, &err);
        if (st == CW_ERR_UNSUPPORTED)
            return false;
        bench_check(st, &err);
        all[n] = bench_cpu_ms() - start;
    }
    *ms = bench_median(all + 1, frames);
    return true;
}

static void run(cw_renderer *r, cw_renderer *cpu, const char *name, const cw_volume *volume,
                const cw_transfer *transfer, const settings *s)
{
    static const float black[2][3];
    cw_picture truth[3] = {{0}}; /* of the integral, lit, and of the last projection */
    fprintf(stderr, "%s\n", name);
    cw_renderer_forget(r); /* a new volume may stand where another was */
    for (size_t n = 0; n < sizeof list / sizeof *list; n++) {
        cw_error err = {0};
        cw_comparison gap;
        cw_picture picture = {0};
        double ms;
        cw_scene scene = list[n].scene;
        scene.volume = volume;
        scene.transfer = transfer;
        scene.width = scene.height = s->picture;
        cw_picture *exact = &truth[is_intensity(scene.mode) ? 2 : list[n].lit_reference];
        if (is_intensity(scene.mode))
            cw_picture_free(exact);
        if (!exact->pixels)
            draw_truth(cpu, &scene, exact);
        if (!draw(r, &scene, s->frames, &ms, &picture))
            continue;
        bench_check(cw_picture_compare(&picture, exact, black, &gap, &err), &err);
        fprintf(stderr, "  %-24s %8.1f ms   rmse %8.4f  max %8.3f   dE %7.3f  p99 %7.3f\n",
                list[n].name, ms, gap.rmse, gap.max, gap.delta_e_mean, gap.delta_e_p99);
        printf("{\"scene\":\"%s\",\"setting\":\"%s\",\"ms\":%.2f,\"rmse\":%.5f,\"max\":%.4f,"
               "\"delta_e_mean\":%.4f,\"delta_e_p99\":%.4f,\"ssim\":%.6f}\n",
               name, list[n].name, ms, gap.rmse, gap.max, gap.delta_e_mean, gap.delta_e_p99,
               gap.ssim);
        cw_picture_free(&picture);
    }
    for (int n = 0; n < 3; n++)
        cw_picture_free(&truth[n]);
}

static void run_field(cw_renderer *r, cw_renderer *cpu, const char *name,
                      double (*value)(const double p[3], const double q[3]),
                      const cw_transfer *transfer, const settings *s)
{
    cw_volume v = {0};
    test_field(&v, s->size, s->size, s->size, (const double[3]){1, 1, 1}, value);
    run(r, cpu, name, &v, transfer, s);
    cw_volume_free(&v);
}

static void run_scan(cw_renderer *r, cw_renderer *cpu, const char *path, const char *preset,
                     const settings *s)
{
    cw_error err = {0};
    cw_volume v;
    cw_statistics statistics;
    cw_transfer transfer;
    const char *slash = strrchr(path, '/');
    if (cw_volume_read(path, NULL, &v, NULL, &err) != CW_OK) {
        fprintf(stderr, "%s: left out\n", path);
        return;
    }
    bench_check(cw_volume_statistics(&v, 256, 0, &statistics, &err), &err);
    bench_check(cw_transfer_preset(preset, &statistics, &transfer, &err), &err);
    run(r, cpu, slash ? slash + 1 : path, &v, &transfer, s);
    cw_statistics_free(&statistics);
    cw_volume_free(&v);
}

/* The number of the first argument that is no option. */
static int parse(int argc, char **argv, settings *s)
{
    int n = 1;
    for (; n + 1 < argc && strncmp(argv[n], "--", 2) == 0; n += 2) {
        const long value = atol(argv[n + 1]);
        if (strcmp(argv[n], "--size") == 0)
            s->size = (size_t)value;
        else if (strcmp(argv[n], "--picture") == 0)
            s->picture = (size_t)value;
        else if (strcmp(argv[n], "--frames") == 0)
            s->frames = value < MAX_FRAMES ? (int)value : MAX_FRAMES - 1;
    }
    return n;
}

int main(int argc, char **argv)
{
    settings s = {64, 256, 3};
    cw_error err = {0};
    cw_renderer *r, *cpu;
    const cw_transfer flat = test_flat_transfer(), soft = test_soft_transfer(),
                      tent = test_tent_transfer();
    const int first = parse(argc, argv, &s);
    bench_check(cw_renderer_new(CW_BACKEND_AUTO, &r, &err), &err);
    bench_check(cw_renderer_new(CW_BACKEND_CPU, &cpu, &err), &err);
    run_field(r, cpu, "constant", test_constant, &flat, &s);
    run_field(r, cpu, "ramp", test_ramp, &soft, &s);
    run_field(r, cpu, "blobs", test_blobs, &soft, &s);
    run_field(r, cpu, "blobs, tent", test_blobs, &tent, &s);
    for (int n = first; n + 1 < argc; n += 2)
        run_scan(r, cpu, argv[n], argv[n + 1], &s);
    cw_renderer_free(cpu);
    cw_renderer_free(r);
    return 0;
}
