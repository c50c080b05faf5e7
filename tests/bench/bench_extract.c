/* Times cw_extract() beside vtkFlyingEdges3D: runs of ours and theirs alternate; medians.
 *
 * bench_extract [--sizes 256,512] [--threads 1,2] [--runs 5] [--cases sphere,noise]
 *               [--data FOLDER]
 *
 * Prints a JSON line a case on stdout, a table on stderr. next_ms is another isovalue of the
 * same volume through a cw_extractor; next_ratio sets it beside theirs at that isovalue;
 * recycled_ms and its ratio are the same again, in the memory of the surface before.
 * limit_ms is a plain pass that reads the volume once and writes as many fresh bytes as the
 * mesh has, with the same threads. Of the scans in FOLDER those that are there are measured,
 * too. */
#define _DEFAULT_SOURCE /* madvise, clock_gettime */
#include <cubewright/cubewright.h>

#include "core/base/parallel.h"
#include "vtk_wrap.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <time.h>

enum { MAX_RUNS = 99 };

typedef struct bench_case {
    const char *name;
    cw_type type;
    double isovalue, next;                                       /* levels, in stored numbers */
    float (*value)(const double p[3], size_t n, uint64_t voxel); /* p in -1..1 */
    double scale, offset;                                        /* to stored numbers */
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
    {"sphere", CW_F32, 0, 0.002, sphere, 1, 0},
    {"gyroid", CW_F32, 0, 0.01, gyroid, 1, 0},
    {"marschner-lobb", CW_F32, 0.5, 0.51, marschner_lobb, 1, 0},
    {"smooth-noise", CW_F32, 0.5, 0.505, smooth_noise, 1, 0},
    {"noise", CW_U8, 249, 248, white_noise, 1, 0},
    {"sparse", CW_U16, 2000, 2050, sparse, 1, 0},
    {"sphere-u8", CW_U8, 128, 129, sphere, 70, 128},
    {"sphere-u16", CW_U16, 30000, 30040, sphere, 20000, 30000},
    {"gyroid-u8", CW_U8, 128, 129, gyroid, 70, 128},
    {"gyroid-u16", CW_U16, 30000, 30100, gyroid, 9000, 30000},
};

/* Scans that may be at hand, and two levels of each. */
static const struct {
    const char *path;
    double isovalue, next;
} scans[] = {
    {"ch2-mri/ch2.nii.gz", 50, 100},         {"bonsai-ct/bonsai.nii.gz", 60, 40},
    {"phantom-ct/phantom_head.mha", 300, 0}, {"ct-example/ct_example.nii.gz", 300, -300},
    {"headsq-ct/headsq.mha", 1150, 500},     {"flair-mri/FLAIR.nrrd", 40, 120},
};

typedef struct filling {
    const bench_case *c;
    size_t n;
    void *voxels;
} filling;

static void fill_slice(void *context, size_t k)
{
    const filling *f = context;
    const bench_case *c = f->c;
    for (size_t j = 0; j < f->n; j++)
        for (size_t i = 0; i < f->n; i++) {
            const size_t at[3] = {i, j, k}, voxel = (k * f->n + j) * f->n + i;
            double p[3];
            for (int a = 0; a < 3; a++)
                p[a] = 2 * (double)at[a] / (double)(f->n - 1) - 1;
            const double x = c->scale * (double)c->value(p, f->n, voxel) + c->offset;
            if (c->type == CW_U8)
                ((uint8_t *)f->voxels)[voxel] = (uint8_t)x;
            else if (c->type == CW_U16)
                ((uint16_t *)f->voxels)[voxel] = (uint16_t)x;
            else
                ((float *)f->voxels)[voxel] = (float)x;
        }
}

static cw_volume make(const bench_case *c, size_t n)
{
    cw_volume v;
    cw_error err = {0};
    if (cw_volume_alloc(&v, c->type, (size_t[3]){n, n, n}, 1, 1, &err) != CW_OK) {
        fprintf(stderr, "%s\n", err.message);
        exit(1);
    }
    filling f = {c, n, cw_volume_voxels(&v)};
    cwi_parallel_for_all(n, n * n, 0, fill_slice, &f);
    return v;
}

static double now_ms(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec * 1e3 + (double)t.tv_nsec * 1e-6;
}

enum { LINE = 8, AHEAD = 64 * LINE, HUGE_PAGE = 2 << 20, BLOCK = HUGE_PAGE / 8 }; /* words */

typedef struct memory_work {
    const uint64_t *in;
    uint64_t *to, sum;
    size_t words;
} memory_work;

static void read_block(void *context, size_t block)
{
    memory_work *w = context;
    uint64_t sum = 0;
    for (size_t n = block * BLOCK; n < (block + 1) * BLOCK && n < w->words; n += LINE) {
        __builtin_prefetch(w->in + n + AHEAD);
        for (size_t m = n; m < n + LINE && m < w->words; m++)
            sum += w->in[m];
    }
    __atomic_fetch_add(&w->sum, sum, __ATOMIC_RELAXED);
}

static void write_block(void *context, size_t block)
{
    const memory_work *w = context;
    for (size_t n = block * BLOCK; n < (block + 1) * BLOCK; n++)
        w->to[n] = n;
}

/* Reads every voxel once, fetched as far ahead as pays, and writes `out` fresh bytes once. */
static double limit_ms(const cw_volume *v, size_t out, int threads)
{
    const size_t bytes = (out + HUGE_PAGE - 1) / HUGE_PAGE * HUGE_PAGE;
    memory_work w = {.in = v->data,
                     .words = v->dim[0] * v->dim[1] * v->dim[2] * cw_type_size(v->type) / 8};
    const double begin = now_ms();
    w.to = aligned_alloc(HUGE_PAGE, bytes);
    madvise(w.to, bytes, MADV_HUGEPAGE);
    cwi_parallel_for_all((w.words + BLOCK - 1) / BLOCK, BLOCK, threads, read_block, &w);
    cwi_parallel_for_all(bytes / HUGE_PAGE, BLOCK, threads, write_block, &w);
    const double end = now_ms();
    free(w.to);
    return end - begin + (w.sum == 42 ? 1e-9 : 0);
}

/* Touches and frees memory, so that a virtual machine's host has it at hand for who comes next:
 * else whoever grows first pays for it, by seconds. More than is needed, as what was freed last
 * is not what is handed out first. */
static void warm(size_t bytes)
{
    const size_t huge = (size_t)2 << 20;
    bytes = (4 * bytes / huge + 1) * huge;
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

/* Measurements of a volume, each a median in milliseconds. */
typedef struct timing {
    double ours, next, recycled, theirs, theirs_next, limit, peak_mb;
    size_t triangles, vtk_triangles;
} timing;

static cw_mesh must(cw_status st, cw_mesh mesh, const cw_error *err)
{
    if (st != CW_OK) {
        fprintf(stderr, "%s\n", err->message);
        exit(1);
    }
    return mesh;
}

static double ours_ms(const cw_volume *v, const cw_extract_desc *d, timing *t)
{
    cw_mesh mesh = {0};
    cw_error err = {0};
    reset_peak();
    const double before = memory_kb("VmRSS:"), begin = now_ms();
    const cw_status st = cw_extract(v, d, &mesh, NULL, &err);
    const double end = now_ms();
    mesh = must(st, mesh, &err);
    t->peak_mb = fmax(t->peak_mb, (memory_kb("VmHWM:") - before) / 1024);
    t->triangles = mesh.triangle_count;
    cw_mesh_free(&mesh);
    return end - begin;
}

/* recycle: the next surface is written to this one's memory. */
static double next_ms(cw_extractor *extractor, const cw_extract_desc *d, bool recycle)
{
    cw_mesh mesh = {0};
    cw_error err = {0};
    const double begin = now_ms();
    const cw_status st = cw_extractor_extract(extractor, d, &mesh, NULL, &err);
    const double end = now_ms();
    mesh = must(st, mesh, &err);
    if (recycle)
        cw_extractor_recycle(extractor, &mesh);
    cw_mesh_free(&mesh);
    return end - begin;
}

static timing measure(const cw_volume *v, double isovalue, double next, int threads, int runs)
{
    double ours[MAX_RUNS], later[MAX_RUNS], theirs[MAX_RUNS], limit[MAX_RUNS];
    double theirs_later[MAX_RUNS], recycled[MAX_RUNS];
    timing t = {0};
    const cw_extract_desc d = {.isovalue = isovalue, .threads = threads},
                          e = {.isovalue = next, .threads = threads};
    cw_extract_counts counts;
    cw_extractor *extractor;
    size_t ignored;
    if (cw_extract_predict(v, &d, &counts, NULL) != CW_OK ||
        cw_extractor_new(v, &extractor, NULL) != CW_OK)
        exit(1);
    next_ms(extractor, &d, false); /* builds the octree */
    for (int r = 0; r < runs; r++) {
        warm(2 * counts.bytes);
        ours[r] = ours_ms(v, &d, &t);
        warm(2 * counts.bytes);
        next_ms(extractor, &d, false);
        warm(2 * counts.bytes);
        later[r] = next_ms(extractor, &e, false);
        warm(2 * counts.bytes);
        next_ms(extractor, &d, true);
        next_ms(extractor, &e, true); /* may be larger, and then gets new memory */
        next_ms(extractor, &d, true);
        recycled[r] = next_ms(extractor, &e, true);
        warm(3 * counts.bytes);
        theirs[r] = bench_vtk(v, isovalue, threads, &t.vtk_triangles);
        warm(3 * counts.bytes);
        theirs_later[r] = bench_vtk(v, next, threads, &ignored);
        warm(2 * counts.bytes);
        limit[r] = limit_ms(v, 24 * counts.vertices + 12 * counts.triangles, threads);
    }
    cw_extractor_free(extractor);
    t.ours = median(ours, runs);
    t.next = median(later, runs);
    t.recycled = median(recycled, runs);
    t.theirs = median(theirs, runs);
    t.theirs_next = median(theirs_later, runs);
    t.limit = median(limit, runs);
    return t;
}

static void report(const char *name, const cw_volume *v, int threads, const timing *t)
{
    printf("{\"case\": \"%s\", \"dims\": [%zu, %zu, %zu], \"type\": \"%s\", \"threads\": %d, "
           "\"ours_ms\": %.2f, \"vtk_ms\": %.2f, \"ratio\": %.3f, \"next_ms\": %.2f, "
           "\"next_ratio\": %.3f, \"recycled_ms\": %.2f, \"recycled_ratio\": %.3f, "
           "\"limit_ms\": %.2f, \"triangles\": %zu, "
           "\"vtk_triangles\": %zu, \"peak_mb\": %.1f}\n",
           name, v->dim[0], v->dim[1], v->dim[2], cw_type_name(v->type), threads, t->ours,
           t->theirs, t->theirs / t->ours, t->next, t->theirs_next / t->next, t->recycled,
           t->theirs_next / t->recycled, t->limit, t->triangles, t->vtk_triangles, t->peak_mb);
    fflush(stdout);
    fprintf(stderr,
            "%-28s %5zu %3s %3d %9.1f %9.1f %7.2f %9.1f %7.2f %9.1f %7.2f %9.1f %12zu "
            "%8.0f\n",
            name, v->dim[0], cw_type_name(v->type), threads, t->ours, t->theirs,
            t->theirs / t->ours, t->next, t->theirs_next / t->next, t->recycled,
            t->theirs_next / t->recycled, t->limit, t->triangles, t->peak_mb);
}

/* The next number of a comma-separated list; 0 at its end. */
static size_t next_number(const char **list)
{
    char *end;
    const size_t n = strtoul(*list, &end, 10);
    *list = *end == ',' ? end + 1 : end;
    return n;
}

static void measure_all(const char *name, const cw_volume *v, double isovalue, double next,
                        const char *threads, int runs)
{
    for (size_t n; (n = next_number(&threads)) > 0;) {
        const timing t = measure(v, isovalue, next, (int)n, runs);
        report(name, v, (int)n, &t);
    }
}

static bool listed(const char *list, const char *name)
{
    const size_t n = strlen(name);
    for (const char *p = list; (p = strstr(p, name)); p += n)
        if ((p == list || p[-1] == ',') && (p[n] == ',' || !p[n]))
            return true;
    return !*list;
}

static void measure_scans(const char *folder, const char *names, const char *threads, int runs)
{
    for (size_t n = 0; n < sizeof scans / sizeof *scans; n++) {
        char path[4096];
        cw_volume v;
        snprintf(path, sizeof path, "%s/%s", folder, scans[n].path);
        if (!listed(names, scans[n].path) ||
            cw_volume_read(path, NULL, &v, NULL, NULL) != CW_OK)
            continue;
        measure_all(scans[n].path, &v, scans[n].isovalue, scans[n].next, threads, runs);
        cw_volume_free(&v);
    }
}

int main(int argc, char **argv)
{
    const char *sizes = "512", *threads = "1,2", *names = "", *data = NULL, *run_count = "5";
    const struct {
        const char *name, **value;
    } options[] = {{"--sizes", &sizes},
                   {"--threads", &threads},
                   {"--cases", &names},
                   {"--data", &data},
                   {"--runs", &run_count}};
    for (int a = 1; a < argc; a += 2) {
        size_t o = 0;
        while (o < 5 && strcmp(argv[a], options[o].name) != 0)
            o++;
        if (o == 5 || a + 1 == argc)
            return fprintf(stderr, "unknown option, or no value: %s\n", argv[a]), 2;
        *options[o].value = argv[a + 1];
    }
    const int asked = atoi(run_count), runs = asked < 1          ? 1
                                              : asked > MAX_RUNS ? MAX_RUNS
                                                                 : asked;
    fprintf(stderr, "%-28s %5s %3s %3s %9s %9s %7s %9s %7s %9s %7s %9s %12s %8s\n", "case",
            "size", "", "thr", "ours ms", "vtk ms", "vtk/our", "next ms", "vtk/nxt", "recycled",
            "vtk/rec", "limit ms", "triangles", "peak MB");
    for (size_t n; (n = next_number(&sizes)) > 1;)
        for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
            if (!listed(names, cases[c].name))
                continue;
            cw_volume v = make(&cases[c], n);
            measure_all(cases[c].name, &v, cases[c].isovalue, cases[c].next, threads, runs);
            cw_volume_free(&v);
        }
    if (data)
        measure_scans(data, names, threads, runs);
    return 0;
}
