/* Volume rendering beside VTK's at equal error: processor time of a picture (all threads), the
 * first and those after it, as ratios of one run.
 *
 * bench_render [--scene blobs] [--size 256] [--picture 512] [--rmse 1] [--rounds 3]
 *              [--frames 3] [--case NAME]
 *
 * The scene blobs is smooth: six blobs and a ripple, of which 22 % of the voxels are visible. The
 * scene shells has detail of a few voxels at any size: shells of a gyroid, 12 voxels apart.
 * Every program gets the largest step of a ladder at which its picture is within --rmse (in
 * 1/255) of the exact picture of the same scene: our reference in double precision. A case whose
 * light VTK computes otherwise compares VTK with its own picture of fine steps. --rmse 0 searches
 * no steps, and times the equal steps that the cases list.
 *
 * VTK needs an X server: xvfb-run bench_render. Every measurement is made in a process of its
 * own; ours and VTK's alternate, and times are medians over the rounds. Prints JSON lines on
 * stdout, of each picture of the search and of each case, and a table on stderr. */
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

enum { MAX_FRAMES = 101, MAX_ROUNDS = 31 };

typedef struct settings {
    size_t size, picture;
    double rmse; /* at most this, in 1/255; 0: no search */
    int rounds, frames;
    const char *only;  /* the case of this name; NULL: all */
    const char *scene; /* blobs or shells */
} settings;

/* Result that a child process hands back. */
typedef struct result {
    bool is_there;
    bench_vtk_times times;
    double rmse;
} result;

typedef enum drawer { OURS, VTK_GPU, VTK_FIXED } drawer;

/* Returns zeroed memory that children share. */
static void *share(size_t bytes)
{
    void *shared = mmap(NULL, bytes, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (shared == MAP_FAILED) {
        perror("mmap");
        exit(1);
    }
    return shared;
}

static size_t bytes_of(const cw_picture *p)
{
    return 4 * p->width * p->height * sizeof *p->pixels;
}

static bool is_on_cpu(cw_mode mode)
{
    return mode == CW_MODE_VBUFFER || mode == CW_MODE_REFERENCE;
}

/* Draws `frames` pictures after the first, and leaves the last in `picture`. */
static void render_ours(const cw_scene *scene, int frames, bench_vtk_times *times,
                        cw_picture *picture)
{
    cw_error err = {0};
    cw_renderer *renderer;
    double all[MAX_FRAMES];
    /* contexts are opened before, as VTK's is */
    bench_check(cw_renderer_new(is_on_cpu(scene->mode) ? CW_BACKEND_CPU : CW_BACKEND_EGL,
                                &renderer, &err),
                &err);
    for (int n = 0; n <= frames; n++) {
        cw_picture_free(picture);
        const double start = bench_cpu_ms();
        bench_check(cw_render(renderer, scene, picture, &err), &err);
        all[n] = bench_cpu_ms() - start;
    }
    times->first_ms = all[0];
    times->next_ms = frames > 0 ? bench_median(all + 1, frames) : all[0];
    cw_renderer_free(renderer);
}

/* Draws as above by VTK, whose rows of bytes go up. */
static bool render_vtk(const cw_scene *scene, bool gpu, int frames, bench_vtk_times *times,
                       cw_picture *picture)
{
    cw_error err = {0};
    const size_t row = 3 * scene->width;
    unsigned char *bytes = malloc(row * scene->height);
    const bool drawn = bytes && bench_vtk_render(scene, gpu, frames, times, bytes);
    if (drawn) {
        bench_check(cw_picture_alloc(picture, scene->width, scene->height, &err), &err);
        for (size_t n = 0; n < scene->width * scene->height; n++) {
            const size_t x = n % scene->width, y = scene->height - 1 - n / scene->width;
            for (size_t c = 0; c < 3; c++)
                picture->pixels[4 * n + c] = (float)bytes[y * row + 3 * x + c] / 255;
            picture->pixels[4 * n + 3] = 1;
        }
    }
    free(bytes);
    return drawn;
}

/* Draws and times a scene in a child: contexts of two GL libraries do not share a thread.
 * truth  what the last picture is compared with; NULL: nothing
 * keep   gets the last picture, in memory that children share; NULL: nobody */
static result measure(drawer who, const cw_scene *scene, int frames, const cw_picture *truth,
                      const cw_picture *keep)
{
    static const float black[2][3];
    result *shared = share(sizeof *shared);
    fflush(NULL);
    const pid_t child = fork();
    if (child == 0) {
        cw_error err = {0};
        cw_picture picture = {0};
        cw_comparison gap = {0};
        if (who == OURS)
            render_ours(scene, frames, &shared->times, &picture);
        else if (!render_vtk(scene, who == VTK_GPU, frames, &shared->times, &picture))
            _exit(1);
        if (truth)
            bench_check(cw_picture_compare(&picture, truth, black, &gap, &err), &err);
        if (keep)
            memcpy(keep->pixels, picture.pixels, bytes_of(&picture));
        shared->rmse = gap.rmse;
        shared->is_there = true;
        _exit(0);
    }
    int status = 0;
    waitpid(child, &status, 0);
    result r = *shared;
    r.is_there &= WIFEXITED(status) && WEXITSTATUS(status) == 0;
    munmap(shared, sizeof *shared);
    return r;
}

/* Shells of a gyroid, 12 voxels apart, in a ball. */
static double shells(const double p[3], const double q[3])
{
    static const double k = 6.2831853 / 12;
    const double g = sin(k * p[0]) * cos(k * p[1]) + sin(k * p[1]) * cos(k * p[2]) +
                     sin(k * p[2]) * cos(k * p[0]);
    const double x = q[0] - 0.5, y = q[1] - 0.5, z = q[2] - 0.5;
    const double ball = 6 * (0.45 - sqrt(x * x + y * y + z * z));
    return fmin(fmax(0.5 + g, 0), fmin(fmax(0.5 + ball, 0), 1));
}

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
    double step;          /* without a search */
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
     0.35},
    {"shaded", CW_MODE_COMPOSITE, true, false, false, 1, VTK_FIXED, true, CW_MODE_COMPOSITE, 0,
     0},
    {"mip", CW_MODE_MIP, false, false, false, 1, VTK_GPU, false, CW_MODE_MIP, 0.5, 0.35},
    {"mip", CW_MODE_MIP, false, false, false, 1, VTK_FIXED, false, CW_MODE_MIP, 0, 0},
    {"slices", CW_MODE_TEXTURE, false, false, false, SLICES, VTK_GPU, false, CW_MODE_COMPOSITE,
     0.5, 0.35},
    {"vbuffer", CW_MODE_VBUFFER, false, false, false, 1, VTK_FIXED, false, CW_MODE_COMPOSITE, 0,
     0},
    {"dragging", CW_MODE_COMPOSITE, false, true, false, 2, VTK_GPU, false, CW_MODE_COMPOSITE, 0,
     0.15},
    {"composite, lean", CW_MODE_COMPOSITE, false, false, true, 1, VTK_GPU, false,
     CW_MODE_COMPOSITE, 0.5, 0.35},
    {"shaded, lean", CW_MODE_COMPOSITE, true, false, true, 1, VTK_GPU, true, CW_MODE_COMPOSITE,
     0.5, 0.35},
    {"mip, lean", CW_MODE_MIP, false, false, true, 1, VTK_GPU, false, CW_MODE_MIP, 0.5, 0.35},
    {"dragging, lean", CW_MODE_COMPOSITE, false, true, true, 2, VTK_GPU, false,
     CW_MODE_COMPOSITE, 0, 0.15},
};

/* Step of a program at the wanted error, and its error. */
typedef struct search {
    double step, rmse;
    const char *truth; /* what the error is to; NULL: nothing was searched */
    bool reached;      /* else: the step of the least error */
} search;

static const char *name_of(drawer p)
{
    return p == OURS ? "ours" : p == VTK_GPU ? "VTK GPU" : "VTK fixed-point";
}

/* Returns the exact picture of a scene, drawn once; shared with children. */
static const cw_picture *truth_of(const cw_scene *scene)
{
    static cw_picture truths[3]; /* of the integral, of the lit integral, of mip */
    const bool is_mip = scene->mode == CW_MODE_MIP;
    cw_picture *truth = &truths[is_mip ? 2 : scene->lit];
    if (!truth->pixels) {
        cw_scene exact = *scene;
        exact.mode = CW_MODE_REFERENCE;
        exact.reference_of = is_mip ? CW_MODE_MIP : (cw_mode)0;
        truth->width = scene->width;
        truth->height = scene->height;
        truth->pixels = share(bytes_of(truth));
        if (!measure(OURS, &exact, 0, NULL, truth).is_there)
            exit(1);
    }
    return truth;
}

/* Draws with smaller and smaller steps until the picture is within the wanted error. */
static search search_ladder(const bench_case *c, const settings *s, drawer who, cw_scene scene,
                            const cw_picture *truth, const char *truth_name)
{
    static const double ladder[] = {32,  24, 16,   12,  8,    6,    4,     3,     2,
                                    1.5, 1,  0.75, 0.5, 0.35, 0.25, 0.175, 0.125, 0};
    search best = {.rmse = INFINITY, .truth = truth_name};
    const double *step = ladder;
    if (scene.mode == CW_MODE_VBUFFER) /* has no steps but its cells */
        step += sizeof ladder / sizeof *ladder - 1;
    for (; !best.reached; step++) {
        scene.step_vox = *step;
        const result r = measure(who, &scene, 0, truth, NULL);
        if (!r.is_there)
            break;
        printf("{\"scene\":\"%s\",\"case\":\"%s\",\"size\":%zu,\"picture\":%zu,"
               "\"program\":\"%s\",\"true_to\":\"%s\",\"step\":%g,\"rmse\":%.4f}\n",
               s->scene, c->name, s->size, s->picture, name_of(who), truth_name, *step, r.rmse);
        if (r.rmse < best.rmse) {
            best.step = *step;
            best.rmse = r.rmse;
        }
        best.reached = best.rmse <= s->rmse;
        if (step[0] == 0 || step[1] == 0)
            break;
    }
    return best;
}

/* Sets the scene's largest step whose picture is within the wanted error. Searches once for
 * what several cases draw. */
static search find_step(const bench_case *c, const settings *s, drawer who, cw_scene *scene,
                        const cw_picture *truth, const char *truth_name)
{
    static struct {
        drawer who;
        cw_mode mode;
        bool lit, lean;
        search found;
    } known[2 * sizeof cases / sizeof *cases];
    static size_t count;
    size_t n = 0;
    while (n < count && !(known[n].who == who && known[n].mode == scene->mode &&
                          known[n].lit == scene->lit && known[n].lean == scene->lean))
        n++;
    if (n == count) {
        known[n].who = who;
        known[n].mode = scene->mode;
        known[n].lit = scene->lit;
        known[n].lean = scene->lean;
        known[n].found = search_ladder(c, s, who, *scene, truth, truth_name);
        count++;
    }
    scene->step_vox = known[n].found.step;
    return known[n].found;
}

/* Finds VTK's step. The GPU mapper lights otherwise than we do, and converges to another picture.
 * So its lit pictures are compared with one of its own in steps of a sixteenth of a voxel, over
 * the same pixels as ours. */
static search find_peer_step(const bench_case *c, const settings *s, cw_scene *scene)
{
    static cw_picture own;
    const cw_picture *truth = truth_of(scene);
    if (!scene->lit || c->beside != VTK_GPU)
        return find_step(c, s, c->beside, scene, truth, "reference");
    if (!own.pixels) {
        cw_scene fine = *scene;
        fine.step_vox = 1.0 / 16;
        own.width = scene->width;
        own.height = scene->height;
        own.pixels = share(bytes_of(&own));
        measure(VTK_GPU, &fine, 0, NULL, &own);
        for (size_t n = 3; n < 4 * own.width * own.height; n += 4)
            own.pixels[n] = truth->pixels[n]; /* VTK's window has no opacity */
    }
    return find_step(c, s, c->beside, scene, &own, "its own finest");
}

/* Times both programs in turn, and takes medians over the rounds. */
static void time_both(const bench_case *c, const settings *s, const cw_scene *ours,
                      const cw_scene *theirs, result *own, result *peer)
{
    double first[2][MAX_ROUNDS], next[2][MAX_ROUNDS];
    for (int n = 0; n < s->rounds; n++) {
        *peer = measure(c->beside, theirs, s->frames, NULL, NULL);
        *own = measure(OURS, ours, s->frames, NULL, NULL);
        first[0][n] = own->times.first_ms;
        next[0][n] = own->times.next_ms;
        first[1][n] = peer->times.first_ms;
        next[1][n] = peer->times.next_ms;
    }
    own->times.first_ms = bench_median(first[0], s->rounds);
    own->times.next_ms = bench_median(next[0], s->rounds);
    peer->times.first_ms = bench_median(first[1], s->rounds);
    peer->times.next_ms = bench_median(next[1], s->rounds);
}

static void report_side(const char *prefix, const search *at, const bench_vtk_times *times)
{
    printf(",\"%sstep\":%g,\"%sfirst_ms\":%.1f,\"%sms\":%.1f", prefix, at->step, prefix,
           times->first_ms, prefix, times->next_ms);
    if (at->truth && isfinite(at->rmse))
        printf(",\"%strue_to\":\"%s\",\"%srmse\":%.4f,\"%sreached\":%s", prefix, at->truth,
               prefix, at->rmse, prefix, at->reached ? "true" : "false");
}

static void report(const bench_case *c, const settings *s, const search *at, const result *own,
                   const search *peer_at, const result *peer)
{
    const bench_vtk_times *a = &own->times, *b = &peer->times;
    const double first = peer->is_there ? a->first_ms / b->first_ms : NAN;
    const double next = peer->is_there ? a->next_ms / b->next_ms : NAN;
    fprintf(stderr,
            "%-15s %5.3g %6.3f %6.0f %6.0f   %-15s %5.3g %6.3f %6.0f %6.0f   %5.2f %5.2f  "
            "(asked %.2f, %.2f)%s\n",
            c->name, at->step, at->rmse, a->first_ms, a->next_ms, name_of(c->beside),
            peer_at->step, peer_at->rmse, b->first_ms, b->next_ms, first, next, c->first_wanted,
            c->wanted, at->truth && !(at->reached && peer_at->reached) ? " not reached" : "");
    printf("{\"scene\":\"%s\",\"case\":\"%s\",\"size\":%zu,\"picture\":%zu,\"wanted_rmse\":%g",
           s->scene, c->name, s->size, s->picture, s->rmse);
    report_side("", at, a);
    printf(",\"peer\":\"%s\"", name_of(c->beside));
    if (peer->is_there)
        report_side("peer_", peer_at, b);
    printf("}\n");
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
    result own = {0}, peer = {0};
    search at = {.rmse = NAN}, peer_at = {.step = 1, .rmse = NAN};
    ours.mode = c->mode;
    ours.lit = c->lit;
    ours.lean = c->lean;
    ours.step_vox = at.step = c->step == SLICES ? depth_of(base, s->size) / 256 : c->step;
    theirs.mode = c->beside_mode;
    theirs.lit = c->beside_lit;
    if (c->half) {
        ours.width /= 2;
        ours.height /= 2;
    }
    if (s->rmse > 0) {
        at = find_step(c, s, OURS, &ours, truth_of(&ours), "reference");
        peer_at = find_peer_step(c, s, &theirs);
    }
    time_both(c, s, &ours, &theirs, &own, &peer);
    report(c, s, &at, &own, &peer_at, &peer);
}

static int at_most(long value, int limit)
{
    return value < limit ? (int)value : limit;
}

static settings parse(int argc, char **argv)
{
    settings s = {256, 512, 1, 3, 3, NULL, "blobs"};
    for (int n = 1; n + 1 < argc; n += 2) {
        const long value = atol(argv[n + 1]);
        if (strcmp(argv[n], "--size") == 0)
            s.size = (size_t)value;
        else if (strcmp(argv[n], "--picture") == 0)
            s.picture = (size_t)value;
        else if (strcmp(argv[n], "--rmse") == 0)
            s.rmse = atof(argv[n + 1]);
        else if (strcmp(argv[n], "--rounds") == 0)
            s.rounds = at_most(value, MAX_ROUNDS);
        else if (strcmp(argv[n], "--frames") == 0)
            s.frames = at_most(value, MAX_FRAMES - 1);
        else if (strcmp(argv[n], "--case") == 0)
            s.only = argv[n + 1];
        else if (strcmp(argv[n], "--scene") == 0)
            s.scene = argv[n + 1];
    }
    return s;
}

int main(int argc, char **argv)
{
    const settings s = parse(argc, argv);
    cw_volume volume = {0};
    cw_error err = {0};
    /* on one thread: children can then have more */
    test_field(&volume, s.size, s.size, s.size, (const double[3]){1, 1, 1},
               strcmp(s.scene, "shells") == 0 ? shells : test_blobs);
    const double half = (double)s.size / 2;
    const cw_fit_desc fit = {
        .view = "iso", .min = {-half, -half, -half}, .max = {half, half, half}, .fov_deg = 30};
    cw_scene scene = {
        .volume = &volume, .transfer = &transfer, .width = s.picture, .height = s.picture};
    bench_check(cw_camera_fit(&fit, &scene.camera, &err), &err);
    fprintf(
        stderr,
        "%s, %zu^3 floats, %zu x %zu pixels; step, rmse, ms of processor time of the first and "
        "next pictures; ratios\n",
        s.scene, s.size, s.picture, s.picture);
    for (size_t n = 0; n < sizeof cases / sizeof *cases; n++) {
        if (s.only && strcmp(s.only, cases[n].name) != 0)
            continue;
        /* a picture of another size has no error; the fixed-point mapper's light is far off */
        if (s.rmse > 0 && (cases[n].half || (cases[n].lit && cases[n].beside == VTK_FIXED)))
            continue;
        run_case(&cases[n], &s, &scene);
    }
    cw_volume_free(&volume);
    return 0;
}
