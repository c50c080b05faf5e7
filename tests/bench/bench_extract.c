/* cw_extract() beside vtkFlyingEdges3D: one run of ours, one of theirs, by turns, medians.
 *
 * bench_extract [--sizes 256,512] [--threads 1,2] [--runs 5] [--cases sphere,noise]
 *
 * Prints a JSON line a case on stdout, a table on stderr. limit_ms is a plain pass that reads
 * the volume once and writes as many fresh bytes as the mesh has, with the same threads. */
#define _DEFAULT_SOURCE /* madvise, clock_gettime */
#include <cubewright/cubewright.h>

#include "vtk_wrap.h"

#include <math.h>
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <time.h>

enum { MAX_RUNS = 99 };

typedef struct bench_case {
    const char *name;
    cw_type type;
    double isovalue;
    float (*value)(const double p[3], size_t n, uint64_t voxel); /* p in -1..1 */
} bench_case;

static uint64_t hash(uint64_t x)
{
    x = (x ^ x >> 30) * UINT64_C(0xbf58476d1ce4e5b9);
    x = (x ^ x >> 27) * UINT64_C(0x94d049bb133111eb);
    return x ^ x >> 31;
}

static float sphere(const double p[3], size_t n, uint64_t voxel)
{
    (void)n, (void)voxel;
    return (float)(0.8 - sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]));
}

/* Periods in proportion to the size: the share of crossed cells is the same for all sizes. */
static float gyroid(const double p[3], size_t n, uint64_t voxel)
{
    (void)voxel;
    const double k = 3.14159265358979 * (double)n / 68;
    return (float)(sin(k * p[0]) * cos(k * p[1]) + sin(k * p[1]) * cos(k * p[2]) +
                   sin(k * p[2]) * cos(k * p[0]));
}

static float marschner_lobb(const double p[3], size_t n, uint64_t voxel)
{
    (void)n, (void)voxel;
    return (float)cw_field_value(CW_FIELD_MARSCHNER_LOBB, p);
}

/* Random values on a lattice 8 voxels wide, trilinear between. */
static float smooth_noise(const double p[3], size_t n, uint64_t voxel)
{
    (void)voxel;
    double cell[3], t[3], sum = 0;
    for (int a = 0; a < 3; a++) {
        const double x = (p[a] + 1) / 2 * (double)n / 8;
        cell[a] = floor(x);
        t[a] = x - cell[a];
    }
    for (int c = 0; c < 8; c++) {
        uint64_t key = 0;
        double weight = 1;
        for (int a = 0; a < 3; a++) {
            key = key << 20 | (uint64_t)(cell[a] + (c >> a & 1));
            weight *= c >> a & 1 ? t[a] : 1 - t[a];
        }
        sum += weight * (double)(hash(key) >> 40);
    }
    return (float)(sum / (1 << 24));
}

static float white_noise(const double p[3], size_t n, uint64_t voxel)
{
    (void)p, (void)n;
    return (float)(hash(voxel) >> 56);
}

/* An object that fills a few percent of the volume, in air. */
static float sparse(const double p[3], size_t n, uint64_t voxel)
{
    (void)n, (void)voxel;
    const double r = sqrt(p[0] * p[0] + p[1] * p[1]) - 0.45;
    const double d = sqrt(r * r + p[2] * p[2]);
    return d < 0.25 ? (float)(20000 * (0.25 - d)) : 0;
}

static const bench_case cases[] = {
    {"sphere", CW_F32, 0, sphere},
    {"gyroid", CW_F32, 0, gyroid},
    {"marschner-lobb", CW_F32, 0.5, marschner_lobb},
    {"smooth-noise", CW_F32, 0.5, smooth_noise},
    {"noise", CW_U8, 249, white_noise},
    {"sparse", CW_U16, 2000, sparse},
};

static cw_volume make(const bench_case *c, size_t n)
{
    cw_volume v;
    cw_error err = {0};
    if (cw_volume_alloc(&v, c->type, (size_t[3]){n, n, n}, 1, 1, &err) != CW_OK) {
        fprintf(stderr, "%s\n", err.message);
        exit(1);
    }
    void *voxels = cw_volume_voxels(&v);
#pragma omp parallel for
    for (size_t k = 0; k < n; k++)
        for (size_t j = 0; j < n; j++)
            for (size_t i = 0; i < n; i++) {
                const size_t at[3] = {i, j, k}, voxel = (k * n + j) * n + i;
                double p[3];
                for (int a = 0; a < 3; a++)
                    p[a] = 2 * (double)at[a] / (double)(n - 1) - 1;
                const float x = c->value(p, n, voxel);
                if (c->type == CW_U8)
                    ((uint8_t *)voxels)[voxel] = (uint8_t)x;
                else if (c->type == CW_U16)
                    ((uint16_t *)voxels)[voxel] = (uint16_t)x;
                else
                    ((float *)voxels)[voxel] = x;
            }
    return v;
}

static double now_ms(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec * 1e3 + (double)t.tv_nsec * 1e-6;
}

/* Reads every voxel once and writes `out` fresh bytes once. */
static double limit_ms(const cw_volume *v, size_t out, int threads)
{
    const uint64_t *in = v->data;
    const size_t words = v->dim[0] * v->dim[1] * v->dim[2] * cw_type_size(v->type) / 8;
    const size_t huge = (size_t)2 << 20, block = huge / 8;
    const size_t bytes = (out + huge - 1) / huge * huge;
    uint64_t sum = 0;
    const double begin = now_ms();
    uint64_t *to = aligned_alloc(huge, bytes);
    madvise(to, bytes, MADV_HUGEPAGE);
#pragma omp parallel num_threads(threads) reduction(+ : sum)
    {
#pragma omp for schedule(dynamic) nowait
        for (size_t b = 0; b < words; b += block)
            for (size_t n = b; n < b + block && n < words; n++)
                sum += in[n];
#pragma omp for schedule(dynamic)
        for (size_t b = 0; b < bytes / 8; b += block)
            for (size_t n = b; n < b + block; n++)
                to[n] = n;
    }
    const double end = now_ms();
    free(to);
    return end - begin + (sum == 42 ? 1e-9 : 0);
}

/* Touches and frees memory, so that a virtual machine's host has it at hand for who comes next:
 * else whoever grows first pays for it, by seconds. */
static void warm(size_t bytes)
{
    const size_t huge = (size_t)2 << 20;
    bytes = (bytes / huge + 1) * huge;
    char *p = aligned_alloc(huge, bytes);
    if (!p)
        return;
    madvise(p, bytes, MADV_HUGEPAGE);
    for (size_t n = 0; n < bytes; n += 4096)
        ((volatile char *)p)[n] = 1;
    free(p);
}

/* Kilobytes of a line of /proc/self/status. */
static double memory_kb(const char *field)
{
    char line[256];
    double kb = 0;
    FILE *file = fopen("/proc/self/status", "r");
    while (file && fgets(line, sizeof line, file))
        if (strncmp(line, field, strlen(field)) == 0)
            kb = atof(line + strlen(field) + 1);
    if (file)
        fclose(file);
    return kb;
}

static void reset_peak(void)
{
    FILE *file = fopen("/proc/self/clear_refs", "w");
    if (file) {
        fputs("5", file);
        fclose(file);
    }
}

static int compare(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double median(double *values, int count)
{
    qsort(values, (size_t)count, sizeof *values, compare);
    return values[count / 2];
}

static void measure(const bench_case *c, const cw_volume *v, int threads, int runs)
{
    double ours[MAX_RUNS], theirs[MAX_RUNS], limit[MAX_RUNS], peak_mb = 0;
    size_t triangles = 0, vtk_triangles = 0, out = 0;
    const cw_extract_desc d = {.isovalue = c->isovalue, .threads = threads};
    cw_extract_counts counts;
    if (cw_extract_predict(v, &d, &counts, NULL) != CW_OK)
        exit(1);
    for (int r = 0; r < runs; r++) {
        cw_mesh mesh;
        cw_error err = {0};
        warm(2 * counts.bytes);
        reset_peak();
        const double before = memory_kb("VmRSS:"), begin = now_ms();
        if (cw_extract(v, &d, &mesh, NULL, &err) != CW_OK) {
            fprintf(stderr, "%s\n", err.message);
            exit(1);
        }
        ours[r] = now_ms() - begin;
        peak_mb = fmax(peak_mb, (memory_kb("VmHWM:") - before) / 1024);
        triangles = mesh.triangle_count;
        out = 24 * mesh.vertex_count + 12 * triangles;
        cw_mesh_free(&mesh);
        warm(3 * counts.bytes);
        theirs[r] = bench_vtk(v, c->isovalue, threads, &vtk_triangles);
        warm(2 * counts.bytes);
        limit[r] = limit_ms(v, out, threads);
    }
    const double o = median(ours, runs), t = median(theirs, runs), l = median(limit, runs);
    printf("{\"case\": \"%s\", \"size\": %zu, \"type\": \"%s\", \"threads\": %d, "
           "\"ours_ms\": %.2f, \"vtk_ms\": %.2f, \"ratio\": %.3f, \"limit_ms\": %.2f, "
           "\"triangles\": %zu, \"vtk_triangles\": %zu, \"peak_mb\": %.1f}\n",
           c->name, v->dim[0], cw_type_name(c->type), threads, o, t, t / o, l, triangles,
           vtk_triangles, peak_mb);
    fflush(stdout);
    fprintf(stderr, "%-15s %5zu %3d %9.1f %9.1f %7.2f %9.1f %12zu %8.0f\n", c->name, v->dim[0],
            threads, o, t, t / o, l, triangles, peak_mb);
}

/* The next number of a comma-separated list; 0 at its end. */
static size_t next_number(const char **list)
{
    char *end;
    const size_t n = strtoul(*list, &end, 10);
    *list = *end == ',' ? end + 1 : end;
    return n;
}

static bool listed(const char *list, const char *name)
{
    const size_t n = strlen(name);
    for (const char *p = list; (p = strstr(p, name)); p += n)
        if ((p == list || p[-1] == ',') && (p[n] == ',' || !p[n]))
            return true;
    return !*list;
}

int main(int argc, char **argv)
{
    const char *sizes = "512", *threads = "1,2", *names = "";
    int runs = 5;
    for (int a = 1; a + 1 < argc; a += 2) {
        if (strcmp(argv[a], "--sizes") == 0)
            sizes = argv[a + 1];
        else if (strcmp(argv[a], "--threads") == 0)
            threads = argv[a + 1];
        else if (strcmp(argv[a], "--cases") == 0)
            names = argv[a + 1];
        else if (strcmp(argv[a], "--runs") == 0)
            runs = atoi(argv[a + 1]);
        else
            return fprintf(stderr, "unknown option %s\n", argv[a]), 2;
    }
    runs = runs < 1 ? 1 : runs > MAX_RUNS ? MAX_RUNS : runs;
    fprintf(stderr, "%-15s %5s %3s %9s %9s %7s %9s %12s %8s\n", "case", "size", "thr",
            "ours ms", "vtk ms", "vtk/our", "limit ms", "triangles", "peak MB");
    for (size_t n; (n = next_number(&sizes)) > 1;)
        for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
            if (!listed(names, cases[c].name))
                continue;
            cw_volume v = make(&cases[c], n);
            const char *left = threads;
            for (size_t t; (t = next_number(&left)) > 0;)
                measure(&cases[c], &v, (int)t, runs);
            cw_volume_free(&v);
        }
    return 0;
}
