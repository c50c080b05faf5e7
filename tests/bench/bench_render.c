/* Volume rendering beside VTK's: processor time of a picture (all threads), the first and those
 * after it, as ratios of one run.
 *
 * bench_render [--size 256] [--picture 512] [--frames 7] [--case NAME]
 *
 * VTK needs an X server: xvfb-run bench_render. Every measurement is made in a process of its
 * own; ours and VTK's alternate. Prints a JSON line a case on stdout, a table on stderr. */
#define _GNU_SOURCE /* MAP_ANONYMOUS */
#include "bench.h"
#include "render_vtk.h"
#include "support/pictures.h"

#include <cubewright/cubewright.h>

#include <math.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

enum { MAX_FRAMES = 101 };

typedef struct settings {
    size_t size, picture;
    int frames;
    const char *only; /* the case of this name; NULL: all */
} settings;

/* Result that a child process hands back. */
typedef struct result {
    bool is_there;
    bench_vtk_times times;
} result;

typedef enum drawer { OURS, VTK_GPU, VTK_FIXED } drawer;

static void render_ours(const cw_scene *scene, int frames, result *out)
{
    cw_error err = {0};
    cw_renderer *renderer;
    cw_picture picture;
    double all[MAX_FRAMES];
    /* contexts are opened before, as VTK's is */
    bench_check(
        cw_renderer_new(scene->mode == CW_MODE_VBUFFER ? CW_BACKEND_CPU : CW_BACKEND_EGL,
                        &renderer, &err),
        &err);
    for (int n = 0; n <= frames; n++) {
        const double start = bench_cpu_ms();
        bench_check(cw_render(renderer, scene, &picture, &err), &err);
        all[n] = bench_cpu_ms() - start;
        cw_picture_free(&picture);
    }
    out->times.first_ms = all[0];
    out->times.next_ms = bench_median(all + 1, frames);
    out->is_there = true;
    cw_renderer_free(renderer);
}

/* In a child: contexts of two GL libraries do not share a thread. */
static result measure(drawer who, const cw_scene *scene, int frames)
{
    result *shared =
        mmap(NULL, sizeof *shared, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (shared == MAP_FAILED)
        exit(1);
    fflush(NULL);
    const pid_t child = fork();
    if (child == 0) {
        if (who == OURS)
            render_ours(scene, frames, shared);
        else
            shared->is_there =
                bench_vtk_render(scene, who == VTK_GPU, frames, &shared->times, NULL);
        _exit(0);
    }
    int status = 0;
    waitpid(child, &status, 0);
    result r = *shared;
    r.is_there &= WIFEXITED(status) && WEXITSTATUS(status) == 0;
    munmap(shared, sizeof *shared);
    return r;
}

/* Of six blobs and a ripple 22 % of the voxels are visible. */
static const cw_transfer transfer = {
    .color_count = 3,
    .colors = {{0.1, {0.2f, 0.3f, 0.9f}}, {0.6, {0.9f, 0.7f, 0.2f}}, {1, {1, 0.2f, 0.1f}}},
    .opacity_count = 4,
    .opacities = {{0.135, 0}, {0.5, 0.02f}, {0.8, 0.05f}, {1, 0.3f}}};

/* Case of the bench: how ours draws, and the drawing of VTK that it is compared with. */
typedef struct bench_case {
    const char *name;
    cw_mode mode;
    bool lit, half, lean; /* lean: as the window draws */
    double step;
    drawer beside;
    bool beside_lit;
    cw_mode beside_mode;
    double first_wanted, wanted; /* ratios; 0: none */
} bench_case;

/* A step that makes 256 slices of the cube. */
enum { SLICES = 0 };

static const bench_case cases[] = {
    {"composite", CW_MODE_COMPOSITE, false, false, false, 1, VTK_GPU, false, CW_MODE_COMPOSITE,
     0.5, 0.35},
    {"composite", CW_MODE_COMPOSITE, false, false, false, 1, VTK_FIXED, false,
     CW_MODE_COMPOSITE, 0, 1},
    {"shaded", CW_MODE_COMPOSITE, true, false, false, 1, VTK_GPU, true, CW_MODE_COMPOSITE, 0.5,
     0.25},
    {"shaded", CW_MODE_COMPOSITE, true, false, false, 1, VTK_FIXED, true, CW_MODE_COMPOSITE, 0,
     0},
    {"mip", CW_MODE_MIP, false, false, false, 1, VTK_GPU, false, CW_MODE_MIP, 0.5, 0.5},
    {"mip", CW_MODE_MIP, false, false, false, 1, VTK_FIXED, false, CW_MODE_MIP, 0, 0},
    {"256 slices", CW_MODE_TEXTURE, false, false, false, SLICES, VTK_GPU, false,
     CW_MODE_COMPOSITE, 0.5, 0.5},
    {"vbuffer", CW_MODE_VBUFFER, false, false, false, 1, VTK_FIXED, false, CW_MODE_COMPOSITE, 0,
     0},
    {"dragging", CW_MODE_COMPOSITE, false, true, false, 2, VTK_GPU, false, CW_MODE_COMPOSITE, 0,
     0.15},
    {"composite, lean", CW_MODE_COMPOSITE, false, false, true, 1, VTK_GPU, false,
     CW_MODE_COMPOSITE, 0.5, 0},
    {"shaded, lean", CW_MODE_COMPOSITE, true, false, true, 1, VTK_GPU, true, CW_MODE_COMPOSITE,
     0.5, 0},
    {"mip, lean", CW_MODE_MIP, false, false, true, 1, VTK_GPU, false, CW_MODE_MIP, 0.5, 0},
    {"dragging, lean", CW_MODE_COMPOSITE, false, true, true, 2, VTK_GPU, false,
     CW_MODE_COMPOSITE, 0, 0.15},
};

static const char *name_of(drawer p)
{
    return p == VTK_GPU ? "VTK GPU" : "VTK fixed-point";
}

static void report(const bench_case *c, const settings *s, const result *ours,
                   const result *peer)
{
    const double first = peer->is_there ? ours->times.first_ms / peer->times.first_ms : NAN;
    const double next = peer->is_there ? ours->times.next_ms / peer->times.next_ms : NAN;
    fprintf(stderr, "%-15s %8.0f %8.0f   %-15s %8.0f %8.0f   %6.2f %6.2f  (%s %.2f, %.2f)\n",
            c->name, ours->times.first_ms, ours->times.next_ms, name_of(c->beside),
            peer->times.first_ms, peer->times.next_ms, first, next, "asked", c->first_wanted,
            c->wanted);
    printf("{\"case\":\"%s\",\"size\":%zu,\"picture\":%zu,\"first_ms\":%.1f,\"ms\":%.1f,"
           "\"peer\":\"%s\",\"peer_first_ms\":%.1f,\"peer_ms\":%.1f}\n",
           c->name, s->size, s->picture, ours->times.first_ms, ours->times.next_ms,
           name_of(c->beside), peer->times.first_ms, peer->times.next_ms);
}

/* Returns the depth along the line of sight of a cube with `size` voxels per axis. */
static double depth_of(const cw_scene *scene, size_t size)
{
    double axes[3][3];
    cw_error err = {0};
    bench_check(cw_camera_axes(&scene->camera, axes[0], axes[1], axes[2], &err), &err);
    return (double)(size - 1) * (fabs(axes[2][0]) + fabs(axes[2][1]) + fabs(axes[2][2]));
}

static void run_case(const bench_case *c, const settings *s, const cw_scene *base)
{
    cw_scene ours = *base, theirs = *base;
    ours.mode = c->mode;
    ours.lit = c->lit;
    ours.lean = c->lean;
    ours.step_vox = c->step == SLICES ? depth_of(base, s->size) / 256 : c->step;
    if (c->half) {
        ours.width /= 2;
        ours.height /= 2;
    }
    theirs.mode = c->beside_mode;
    theirs.lit = c->beside_lit;
    const result peer = measure(c->beside, &theirs, s->frames);
    const result own = measure(OURS, &ours, s->frames);
    report(c, s, &own, &peer);
}

static settings parse(int argc, char **argv)
{
    settings s = {256, 512, 7, NULL};
    for (int n = 1; n + 1 < argc; n += 2) {
        const long value = atol(argv[n + 1]);
        if (strcmp(argv[n], "--size") == 0)
            s.size = (size_t)value;
        else if (strcmp(argv[n], "--picture") == 0)
            s.picture = (size_t)value;
        else if (strcmp(argv[n], "--frames") == 0)
            s.frames = value < MAX_FRAMES ? (int)value : MAX_FRAMES - 1;
        else if (strcmp(argv[n], "--case") == 0)
            s.only = argv[n + 1];
    }
    return s;
}

int main(int argc, char **argv)
{
    const settings s = parse(argc, argv);
    cw_volume volume = {0};
    cw_error err = {0};
    /* on one thread: children can then have more */
    test_field(&volume, s.size, s.size, s.size, (const double[3]){1, 1, 1}, test_blobs);
    const double half = (double)s.size / 2;
    const cw_fit_desc fit = {
        .view = "iso", .min = {-half, -half, -half}, .max = {half, half, half}, .fov_deg = 30};
    cw_scene scene = {
        .volume = &volume, .transfer = &transfer, .width = s.picture, .height = s.picture};
    bench_check(cw_camera_fit(&fit, &scene.camera, &err), &err);
    fprintf(stderr,
            "%zu^3 floats, %zu x %zu pixels, ms of processor time: first, next; ratios\n",
            s.size, s.picture, s.picture);
    for (size_t n = 0; n < sizeof cases / sizeof *cases; n++)
        if (!s.only || strcmp(s.only, cases[n].name) == 0)
            run_case(&cases[n], &s, &scene);
    cw_volume_free(&volume);
    return 0;
}
