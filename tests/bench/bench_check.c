/* Times the checks of a mesh, and CGAL's self-intersections beside ours: interleaved, medians.
 *
 * bench_check [SIZE [RUNS]]
 *
 * Times are those of the processor on one thread, and of the clock on two.
 * Prints a JSON line a mesh and number of threads: spheres and gyroids of SIZE^3 voxels (256),
 * extracted; noise as well, at half the size. */
#define _DEFAULT_SOURCE /* clock_gettime */
#include <cubewright/cubewright.h>

#include "bench.h"
#include "cgal_bench.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

enum { MAX_RUNS = 99 };

typedef struct times {
    int count;
    double ms[MAX_RUNS];
} times;

static double now_ms(int threads)
{
    struct timespec t;
    if (threads == 1)
        return bench_cpu_ms();
    clock_gettime(CLOCK_MONOTONIC, &t);
    return 1e3 * (double)t.tv_sec + 1e-6 * (double)t.tv_nsec;
}

static int compare(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double median(times *t)
{
    qsort(t->ms, (size_t)t->count, sizeof *t->ms, compare);
    return t->count ? t->ms[t->count / 2] : -1;
}

static void stop_on(cw_status st, const cw_error *err)
{
    if (st == CW_OK)
        return;
    fprintf(stderr, "%s\n", err->message);
    exit(1);
}

typedef struct results {
    times measure, crossings, cgal, field, mesh;
    size_t pairs, cgal_pairs;
    cw_distance distance;
} results;

static void run_once(const cw_mesh *mesh, const cw_volume *volume, int threads, results *r)
{
    cw_error err = {0};
    cw_quality quality;
    cw_crossings x;
    double t = now_ms(threads);
    stop_on(cw_quality_measure(mesh, &(cw_quality_desc){.threads = threads, .shells = true},
                               &quality, &err),
            &err);
    r->measure.ms[r->measure.count++] = now_ms(threads) - t;
    t = now_ms(threads);
    stop_on(cw_self_intersections(mesh, &(cw_crossings_desc){.threads = threads}, &x, &err),
            &err);
    r->crossings.ms[r->crossings.count++] = now_ms(threads) - t;
    r->pairs = x.count;
    cw_crossings_free(&x);
    const double cgal = bench_cgal_intersections(mesh, threads, &r->cgal_pairs);
    if (cgal >= 0)
        r->cgal.ms[r->cgal.count++] = cgal;
    t = now_ms(threads);
    stop_on(cw_distance_to_field(mesh, volume, &(cw_field_distance_desc){.threads = threads},
                                 &r->distance, NULL, &err),
            &err);
    r->field.ms[r->field.count++] = now_ms(threads) - t;
    t = now_ms(threads);
    cw_distance self;
    stop_on(cw_distance_to_mesh(mesh, mesh, &(cw_mesh_distance_desc){.threads = threads}, &self,
                                NULL, &err),
            &err);
    r->mesh.ms[r->mesh.count++] = now_ms(threads) - t;
}

static void bench(const char *name, const cw_field_desc *field, int runs)
{
    cw_volume volume = {0};
    cw_mesh mesh = {0};
    cw_error err = {0};
    stop_on(cw_field_sample(field, &volume, &err), &err);
    stop_on(cw_extract(&volume, &(cw_extract_desc){.no_normals = true}, &mesh, NULL, &err),
            &err);
    for (int threads = 1; threads <= 2; threads++) {
        results r = {0};
        for (int n = 0; n < runs; n++)
            run_once(&mesh, &volume, threads, &r);
        const double ours = median(&r.crossings), theirs = median(&r.cgal);
        printf(
            "{\"mesh\": \"%s\", \"size\": %zu, \"triangles\": %zu, \"threads\": %d, "
            "\"measure_ms\": %.1f, \"self_intersections_ms\": %.1f, \"cgal_ms\": %.1f, "
            "\"ratio\": %.2f, \"pairs\": %zu, \"cgal_pairs\": %zu, \"to_field_ms\": %.1f, "
            "\"to_itself_ms\": %.1f, \"samples\": %zu, \"max_mm\": %.6g, \"rms_mm\": %.6g}\n",
            name, volume.dim[0], mesh.triangle_count, threads, median(&r.measure), ours, theirs,
            theirs > 0 ? theirs / ours : 0, r.pairs, r.cgal_pairs, median(&r.field),
            median(&r.mesh), r.distance.samples, r.distance.max_mm, r.distance.rms_mm);
        fflush(stdout);
    }
    cw_mesh_free(&mesh);
    cw_volume_free(&volume);
}

int main(int count, char **words)
{
    const size_t size = count > 1 ? strtoul(words[1], NULL, 10) : 256;
    const int runs = count > 2 ? atoi(words[2]) : 3;
    if (size < 8 || runs < 1 || runs > MAX_RUNS) {
        fprintf(stderr, "usage: bench_check [SIZE [RUNS]]\n");
        return 2;
    }
    bench("sphere",
          &(cw_field_desc){.field = CW_FIELD_SPHERE, .type = CW_F32, .dim = {size, size, size}},
          runs);
    bench("gyroid",
          &(cw_field_desc){.field = CW_FIELD_GYROID, .type = CW_F32, .dim = {size, size, size}},
          runs);
    bench("noisy gyroid",
          &(cw_field_desc){.field = CW_FIELD_GYROID,
                           .type = CW_F32,
                           .dim = {size / 2, size / 2, size / 2},
                           .noise = 0.3},
          runs);
    return 0;
}
