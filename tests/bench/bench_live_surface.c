/* Times of surfaces that OpenGL's compute shaders extract, on the GPU itself.
 *
 * bench_live_surface [--size 512] [--runs 21] [--field gyroid] [--type u16] [--noise 0]
 *                    [--periods 0] [--cpu]
 * bench_live_surface --frames [--size 128] [--runs 21] [--periods 4] [--box 64]
 *
 * The isovalue moves from run to run by a fraction of the field's range, as if it were dragged.
 * --periods N samples a gyroid of N periods along each axis in place of the field. --noise adds
 * Gaussian noise, in the field's unit. Prints the renderer's name and, as medians over the runs,
 * the milliseconds of classifying (with lists and ambiguous cells), of the prefix sums, of vertices
 * and triangles, of all on the GPU, and of the whole call; with --cpu, those of cw_extractor.
 *
 * --frames needs no GPU: a gyroid of floats moves from frame to frame, and an extractor follows it on
 * one thread. Prints medians of processor time: of a frame from scratch and with the extractor, and,
 * where only a box changes, of the changed bricks and of the whole surface. */
#include "core/base/clock.h"
#include "core/base/module.h"
#include "core/base/parallel.h"
#include "core/base/thread_pool.h"
#include "core/synthetic/random_fill.h"
#include "viewer/gl/gl.h"

#include <cubewright/cubewright.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { MAX_RUNS = 1001 };

typedef struct settings {
    size_t size;
    int runs;
    cw_field field;
    cw_type type;
    double noise, periods;
    bool cpu, frames;
    size_t box; /* voxels along its edges */
} settings;

static int usage(void)
{
    fputs(
        "bench_live_surface [--size 512] [--runs 21] [--field gyroid] [--type u16] [--noise 0] "
        "[--periods 0] [--cpu]\n"
        "bench_live_surface --frames [--size 128] [--runs 21] [--periods 4] [--box 64]\n",
        stderr);
    return 2;
}

static bool find_type(const char *name, cw_type *type)
{
    for (int t = 0; t < CW_TYPE_COUNT; t++)
        if (strcmp(cw_type_name((cw_type)t), name) == 0) {
            *type = (cw_type)t;
            return true;
        }
    return false;
}

static bool parse(int count, char **args, settings *s)
{
    *s = (settings){.size = 512, .runs = 21, .type = CW_U16, .box = 64};
    if (count > 1 && strcmp(args[1], "--frames") == 0)
        *s = (settings){
            .size = 128, .runs = 21, .type = CW_F32, .box = 64, .periods = 4, .frames = true};
    bool good = cw_field_find("gyroid", &s->field);
    for (int n = 1 + s->frames; n < count && good; n++) {
        const char *value = n + 1 < count ? args[n + 1] : "";
        if (strcmp(args[n], "--cpu") == 0) {
            s->cpu = true;
            continue;
        }
        if (strcmp(args[n], "--box") == 0)
            s->box = (size_t)strtoul(value, NULL, 10);
        else if (strcmp(args[n], "--size") == 0)
            s->size = (size_t)strtoul(value, NULL, 10);
        else if (strcmp(args[n], "--runs") == 0)
            s->runs = (int)strtol(value, NULL, 10);
        else if (strcmp(args[n], "--noise") == 0)
            s->noise = strtod(value, NULL);
        else if (strcmp(args[n], "--periods") == 0)
            s->periods = strtod(value, NULL);
        else if (strcmp(args[n], "--field") == 0)
            good = cw_field_find(value, &s->field);
        else if (strcmp(args[n], "--type") == 0)
            good = find_type(value, &s->type);
        else
            good = false;
        n++;
    }
    return good && s->size >= 2 && s->size <= 4096 && s->runs >= 1 && s->runs <= MAX_RUNS &&
           (!s->frames || (s->type == CW_F32 && s->box >= 1 && s->box <= s->size));
}

typedef struct filling {
    const settings *s;
    char *voxels;
} filling;

static void fill_slice(void *context, size_t k)
{
    const filling *f = context;
    const size_t n = f->s->size;
    const double w = 2 * 3.14159265358979323846 * f->s->periods / (double)n;
    for (size_t at = k * n * n; at < (k + 1) * n * n; at++) {
        const double x = w * (double)(at % n), y = w * (double)(at / n % n), z = w * (double)k;
        const double value = sin(x) * cos(y) + sin(y) * cos(z) + sin(z) * cos(x);
        double low, high;
        const bool whole = cwi_fill_range(f->s->type, &low, &high);
        cwi_fill(f->s->type, f->voxels, at,
                 whole ? low + (value + 1.5) / 3 * (high - low) : value);
    }
}

/* Fills a volume with a gyroid of some periods, 0 to 1 around the surface at a half. */
static void fill_periods(const settings *s, cw_volume *v)
{
    filling f = {s, cw_volume_voxels(v)};
    cwi_parallel_for_all(s->size, 8 * s->size * s->size, 0, fill_slice, &f);
}

static cw_status make_volume(const settings *s, cw_volume *v, double range[2], cw_error *err)
{
    const cw_field_desc desc = {.field = s->field,
                                .dim = {s->size, s->size, s->size},
                                .type = s->type,
                                .noise = s->noise};
    const double iso = s->periods > 0 ? 0 : cw_field_isovalue(s->field);
    cw_field gyroid;
    if (!cw_field_find("gyroid", &gyroid))
        return CW_ERR_ARGUMENT;
    range[0] = cw_field_stored(s->periods > 0 ? gyroid : s->field, s->type, iso);
    range[1] = cw_field_stored(s->periods > 0 ? gyroid : s->field, s->type,
                               iso + 0.1 * fmax(fabs(iso), 1));
    if (s->periods <= 0)
        return cw_field_sample(&desc, v, err);
    cw_status st = cw_volume_alloc(v, s->type, desc.dim, 1, 1, err);
    if (st == CW_OK)
        fill_periods(s, v);
    return st;
}

static int by_size(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double median(double *values, int count)
{
    qsort(values, (size_t)count, sizeof *values, by_size);
    return values[count / 2];
}

static double isovalue_of(const settings *s, const double range[2], int run)
{
    return range[0] + (range[1] - range[0]) * run / s->runs;
}

static cw_status time_gpu(const settings *s, const cw_volume *v, const double range[2],
                          cw_error *err)
{
    static double parts[5][MAX_RUNS];
    const void *module;
    cwi_gl *gl = NULL;
    size_t size[2] = {0, 0};
    cw_status st = cwi_module_load("gl", &module, err);
    const cwi_gl_functions *f = module;
    if (st == CW_OK)
        st = f->open(&gl, err);
    if (st != CW_OK)
        return st;
    cw_live_surface live = {.volume = v, .isovalue = range[0], .on_software = true};
    cwi_live_times t;
    const double start = cwi_now_s();
    st = f->extract(gl, &live, NULL, &t, size, NULL, err); /* uploads and compiles */
    const double first = 1000 * (cwi_now_s() - start);
    for (int n = 0; n < s->runs && st == CW_OK; n++) {
        live.isovalue = isovalue_of(s, range, n);
        const double before = cwi_now_s();
        st = f->extract(gl, &live, NULL, &t, size, NULL, err);
        parts[4][n] = 1000 * (cwi_now_s() - before);
        parts[0][n] = t.classify_ms;
        parts[1][n] = t.scan_ms;
        parts[2][n] = t.emit_ms;
        parts[3][n] = t.classify_ms + t.scan_ms + t.emit_ms;
    }
    if (st == CW_OK) {
        printf("%s\n%zu^3 %s, %zu vertices, %zu triangles, %d runs\n", f->name(gl), s->size,
               cw_type_name(s->type), size[0], size[1], s->runs);
        printf("first call %.0f ms\nclassify %.3f ms\nscan %.3f ms\nemit %.3f ms\n", first,
               median(parts[0], s->runs), median(parts[1], s->runs), median(parts[2], s->runs));
        printf("GPU in all %.3f ms\ncall %.3f ms\n", median(parts[3], s->runs),
               median(parts[4], s->runs));
    }
    f->close(gl);
    return st;
}

static cw_status time_cpu(const settings *s, const cw_volume *v, const double range[2],
                          cw_error *err)
{
    static double times[MAX_RUNS];
    cw_extractor *e;
    cw_mesh mesh = {0};
    cw_status st = cw_extractor_new(v, &e, err);
    for (int n = -1; n < s->runs && st == CW_OK; n++) {
        const cw_extract_desc desc = {.isovalue = isovalue_of(s, range, n < 0 ? 0 : n)};
        const double before = cwi_now_s();
        st = cw_extractor_extract(e, &desc, &mesh, NULL, err);
        times[n < 0 ? 0 : n] = 1000 * (cwi_now_s() - before);
        cw_extractor_recycle(e, &mesh);
    }
    cw_extractor_free(e);
    if (st == CW_OK)
        printf("CPU, %d threads %.3f ms\n", cwi_threads(0), median(times, s->runs));
    return st;
}

/* --- frames ------------------------------------------------------------------------------- */

static double processor_ms(void)
{
    return 1e3 * (double)clock() / CLOCKS_PER_SEC;
}

/* Writes a gyroid into a box of floats; it moves along x with the frames. */
static void write_gyroid(const settings *s, const cw_box *box, int frame, float *voxels)
{
    const size_t n = s->size;
    const double w = 2 * 3.14159265358979323846 * s->periods / (double)n;
    for (size_t k = box->first[2]; k < box->first[2] + box->count[2]; k++)
        for (size_t j = box->first[1]; j < box->first[1] + box->count[1]; j++)
            for (size_t i = box->first[0]; i < box->first[0] + box->count[0]; i++) {
                const double x = w * (double)i + 0.1 * frame, y = w * (double)j,
                             z = w * (double)k;
                voxels[(k * n + j) * n + i] =
                    (float)(sin(x) * cos(y) + sin(y) * cos(z) + sin(z) * cos(x));
            }
}

/* The ways to make a frame. */
typedef enum frame_kind { FROM_SCRATCH, WHOLE, BOX_BRICKS, BOX_WHOLE, FRAME_KINDS } frame_kind;

static cw_status count_brick(void *user, const cw_brick *brick, cw_error *err)
{
    size_t *counts = user;
    (void)err;
    counts[0]++;
    counts[1] += brick->mesh->triangle_count;
    return CW_OK;
}

static cw_status make_frame(frame_kind kind, const cw_volume *v, const cw_box *box,
                            cw_extractor *e, cw_mesh *mesh, size_t counts[2], cw_error *err)
{
    const cw_extract_desc desc = {.threads = 1};
    if (kind == FROM_SCRATCH) {
        cw_mesh_free(mesh);
        return cw_extract(v, &desc, mesh, NULL, err);
    }
    cw_status st = cw_extractor_update(e, kind == WHOLE ? NULL : box, err);
    if (st == CW_OK && kind == BOX_BRICKS)
        return cw_extractor_extract_changed(e, &desc, (cw_brick_sink){count_brick, counts},
                                            err);
    return st == CW_OK ? cw_extractor_extract(e, &desc, mesh, NULL, err) : st;
}

static cw_status time_frames(const settings *s, cw_volume *v, frame_kind kind, cw_error *err)
{
    static const char *names[FRAME_KINDS] = {"from scratch", "all changed", "box, its bricks",
                                             "box, whole surface"};
    static double times[MAX_RUNS];
    const size_t n = s->size, first = (n - s->box) / 2;
    const cw_box all = {{0, 0, 0}, {n, n, n}},
                 box = {{first, first, first}, {s->box, s->box, s->box}};
    float *voxels = cw_volume_voxels(v);
    size_t counts[2] = {0, 0};
    cw_extractor *e;
    cw_mesh mesh = {0};
    write_gyroid(s, &all, 0, voxels);
    cw_status st = cw_extractor_new(v, &e, err);
    for (int run = -2; run < s->runs && st == CW_OK; run++) { /* two to warm up */
        write_gyroid(s, kind < BOX_BRICKS ? &all : &box, run, voxels);
        counts[0] = counts[1] = 0;
        const double before = processor_ms();
        st = make_frame(kind, v, &box, e, &mesh, counts, err);
        times[run < 0 ? 0 : run] = processor_ms() - before;
    }
    if (st == CW_OK && kind == BOX_BRICKS)
        printf("%s: %.2f ms, %zu bricks, %zu triangles\n", names[kind], median(times, s->runs),
               counts[0], counts[1]);
    else if (st == CW_OK)
        printf("%s: %.2f ms, %zu triangles\n", names[kind], median(times, s->runs),
               mesh.triangle_count);
    cw_mesh_free(&mesh);
    cw_extractor_free(e);
    return st;
}

static cw_status time_all_frames(const settings *s, cw_error *err)
{
    cw_volume v;
    cw_status st =
        cw_volume_alloc(&v, CW_F32, (size_t[3]){s->size, s->size, s->size}, 1, 1, err);
    for (frame_kind kind = 0; kind < FRAME_KINDS && st == CW_OK; kind++)
        st = time_frames(s, &v, kind, err);
    cw_volume_free(&v);
    return st;
}

int main(int count, char **args)
{
    settings s;
    cw_volume v;
    cw_error err = {0};
    double range[2];
    if (!parse(count, args, &s))
        return usage();
    if (s.frames) {
        const cw_status framed = time_all_frames(&s, &err);
        if (framed != CW_OK)
            fprintf(stderr, "bench_live_surface: %s\n", err.message);
        return framed == CW_OK ? 0 : 1;
    }
    cw_status st = make_volume(&s, &v, range, &err);
    if (st == CW_OK)
        st = time_gpu(&s, &v, range, &err);
    if (st == CW_OK && s.cpu)
        st = time_cpu(&s, &v, range, &err);
    if (st != CW_OK)
        fprintf(stderr, "bench_live_surface: %s\n", err.message);
    cw_volume_free(&v);
    return st == CW_OK ? 0 : 1;
}
