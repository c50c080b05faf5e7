/* Times cw_extract_labels() beside VTK's discrete flying edges and marching cubes: runs of ours and
 * theirs alternate; medians.
 *
 * bench_labels [--threads 2] [--runs 5] [--large] [FILE...]
 *
 * Made volumes of cells and of spheres (--large: 512^3 with 1000 labels), then the files. Prints a
 * JSON line a volume on stdout, a table on stderr. VTK's meshes are unsmoothed, and neighbours
 * have a surface each; ours share theirs. */
#define _GNU_SOURCE /* CLOCK_MONOTONIC */
#include "bench.h"
#include "vtk_wrap.h"

#include <cubewright/field.h>
#include <cubewright/formats.h>
#include <cubewright/labels.h>

#include <stdbool.h>
#include <string.h>

enum { MAX_RUNS = 99 };

typedef enum work { PLAIN, SMOOTHED, FLYING_EDGES, MARCHING_CUBES, WORKS } work;
static const char *const work_names[WORKS] = {"unsmoothed", "smoothed", "vtk flying edges",
                                              "vtk marching cubes"};

static int threads = 2, runs = 5;

static double now_ms(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return 1e3 * (double)t.tv_sec + 1e-6 * (double)t.tv_nsec;
}

static double time_ours(const cw_volume *v, bool smooth, size_t *triangles)
{
    cw_label_surfaces surfaces;
    cw_error err = {0};
    const cw_labels_desc desc = {.no_smoothing = !smooth, .threads = threads};
    const double start = now_ms();
    bench_check(cw_extract_labels(v, &desc, &surfaces, &err), &err);
    const double ms = now_ms() - start;
    *triangles = surfaces.mesh.triangle_count;
    cw_label_surfaces_free(&surfaces);
    return ms;
}

/* Returns the largest label, up to which VTK looks for all. */
static size_t max_label(const cw_volume *v)
{
    cw_label_count *counts;
    size_t count;
    cw_error err = {0};
    bench_check(cw_label_counts(v, 0, &counts, &count, &err), &err);
    const size_t max = count ? counts[count - 1].label : 0;
    cw_label_counts_free(counts);
    return max;
}

static void measure_volume(const char *name, const cw_volume *v)
{
    double times[WORKS][MAX_RUNS], medians[WORKS];
    size_t triangles[WORKS] = {0};
    const size_t labels = max_label(v);
    for (int run = 0; run < runs; run++)
        for (int w = 0; w < WORKS; w++)
            times[w][run] = w <= SMOOTHED ? time_ours(v, w == SMOOTHED, &triangles[w])
                                          : bench_vtk_labels(v, labels, w == MARCHING_CUBES,
                                                             threads, &triangles[w]);
    printf("{\"volume\": \"%s\", \"voxels\": %zu, \"labels\": %zu, \"threads\": %d", name,
           v->dim[0] * v->dim[1] * v->dim[2], labels, threads);
    fprintf(stderr, "%s, %zu labels\n", name, labels);
    for (int w = 0; w < WORKS; w++)
        medians[w] = bench_median(times[w], runs);
    for (int w = 0; w < WORKS; w++) {
        printf(", \"%s\": {\"ms\": %.2f, \"triangles\": %zu}", work_names[w], medians[w],
               triangles[w]);
        if (medians[w] >= 0)
            fprintf(stderr, "  %-20s %9.1f ms %10zu triangles, %.2f of flying edges\n",
                    work_names[w], medians[w], triangles[w],
                    medians[w] / medians[FLYING_EDGES]);
    }
    puts("}");
}

static void measure_made(const char *name, cw_label_field field, size_t side, size_t labels)
{
    cw_volume v;
    cw_error err = {0};
    const cw_label_field_desc desc = {
        .field = field, .dim = {side, side, side}, .type = CW_U16, .labels = labels};
    bench_check(cw_label_field_sample(&desc, &v, &err), &err);
    measure_volume(name, &v);
    cw_volume_free(&v);
}

int main(int argc, char **argv)
{
    bool large = false;
    int first = 1;
    for (; first < argc && strncmp(argv[first], "--", 2) == 0; first++)
        if (strcmp(argv[first], "--large") == 0)
            large = true;
        else if (strcmp(argv[first], "--threads") == 0 && first + 1 < argc)
            threads = atoi(argv[++first]);
        else if (strcmp(argv[first], "--runs") == 0 && first + 1 < argc)
            runs = atoi(argv[++first]);
    runs = runs < 1 ? 1 : runs > MAX_RUNS ? MAX_RUNS : runs;
    measure_made("cells 128", CW_LABEL_CELLS, 128, 100);
    measure_made("spheres 256", CW_LABEL_SPHERES, 256, 1000);
    if (large)
        measure_made("cells 512", CW_LABEL_CELLS, 512, 1000);
    for (int n = first; n < argc; n++) {
        cw_volume v;
        cw_error err = {0};
        bench_check(cw_volume_read(argv[n], NULL, &v, NULL, &err), &err);
        measure_volume(argv[n], &v);
        cw_volume_free(&v);
    }
    return 0;
}
