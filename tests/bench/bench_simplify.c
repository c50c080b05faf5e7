/* Compares cw_simplify() with other programs' simplifiers: time, memory, and the result.
 *
 * bench_simplify [--inputs sphere,gyroid,head,bone] [--targets 50,10,2] [--error 0.1,0.2mm]
 *                [--peers cubewright,...] [--threads N] [--repeat 1] [--triangles 1000000]
 *                [--data FOLDER] [--csv FILE]
 *
 * Prints a JSON line a case on stdout, a table on stderr; --csv writes the same once more.
 * Targets are percents of the triangles; --threads is for ours, the others have one;
 * --triangles is about how many the made inputs have. Scans are measured where FOLDER has them.
 *
 * --error lists limits in millimetres, and replaces the default targets. For each,
 * `cubewright-error` simplifies within the limit, and the other programs to as many triangles. Of
 * the peers two take an error: `meshoptimizer-error` is no bound. `cgal-envelope` is a bound one
 * way; it takes minutes for a hundred thousand triangles, and runs if --peers names it.
 *
 * Times are medians, the programs taking turns; they contain the copy into a program's own data
 * structure (build_s) and the copy of the result. peak_mb is what the process grew by.
 * Distances are those of both sides: rms is the root of the mean of both squares, in percent of
 * the diagonal of the input's box. `_to_ours` and `_to_meshopt` are ratios to those programs in
 * the same case: above 1 it is slower, or farther from the input. 0: not known.
 *
 * Every step runs in a process of its own, for the memory's sake. This one only waits for them. */
#define _GNU_SOURCE /* memfd_create */
#include <cubewright/cubewright.h>

#include "bench_process.h"
#include "simplify_programs.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <time.h>
#include <unistd.h>

enum { MAX_RUNS = 99, MAX_PATH = 4096 };

/* ---- inputs ------------------------------------------------------------------------------ */

/* Made inputs have about a million triangles at the number of voxels along each axis given
 * here, and others in proportion to its square. */
static const struct {
    const char *name;
    cw_field_desc field;
    size_t voxels;
    const char *path; /* of a scan, in its place */
    double isovalue;
} inputs[] = {
    {"sphere", {.field = CW_FIELD_SPHERE}, 433, NULL, 0},
    {"gyroid", {.field = CW_FIELD_GYROID, .noise = 0.05}, 168, NULL, 0},
    {"head", {0}, 0, "ch2-mri/ch2.nii.gz", 50},            /* skin, 2320 pieces */
    {"bone", {0}, 0, "ct-example/ct_example.nii.gz", 300}, /* of thick slices */
};

enum { INPUTS = sizeof inputs / sizeof *inputs };

/* ---- what peers share -------------------------------------------------------------------- */

double bench_now_s(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

bool bench_mesh_alloc(cw_mesh *mesh, size_t vertices, size_t triangles)
{
    mesh->vertex_count = vertices;
    mesh->triangle_count = triangles;
    mesh->positions = malloc((3 * vertices + 1) * sizeof(float));
    mesh->triangles = malloc((3 * triangles + 1) * sizeof(uint32_t));
    return mesh->positions && mesh->triangles;
}

/* ---- making an input --------------------------------------------------------------------- */

typedef struct making {
    int input, file;
    size_t triangles;
    char folder[MAX_PATH];
} making;

static cw_status make_volume(const making *m, cw_volume *volume, cw_error *err)
{
    if (inputs[m->input].path) {
        char path[2 * MAX_PATH];
        snprintf(path, sizeof path, "%s/%s", m->folder, inputs[m->input].path);
        return cw_volume_read(path, NULL, volume, NULL, err);
    }
    cw_field_desc field = inputs[m->input].field;
    const double share = sqrt((double)m->triangles / 1e6);
    field.type = CW_F32;
    for (int a = 0; a < 3; a++)
        field.dim[a] = (size_t)fmax(8, rint((double)inputs[m->input].voxels * share));
    return cw_field_sample(&field, volume, err);
}

static bool make_input(void *task)
{
    const making *m = task;
    const cw_extract_desc desc = {.isovalue = inputs[m->input].isovalue, .no_normals = true};
    cw_volume volume = {0};
    cw_mesh mesh = {0};
    cw_error err = {0};
    cw_status st = make_volume(m, &volume, &err);
    if (st == CW_OK)
        st = cw_extract(&volume, &desc, &mesh, NULL, &err);
    if (st != CW_OK)
        fprintf(stderr, "%s\n", err.message);
    return st == CW_OK && bench_put_mesh(m->file, &mesh);
}

/* ---- one run of one program -------------------------------------------------------------- */

/* A target of a case. */
typedef struct aim {
    size_t triangles;
    double percent;  /* of the input's triangles */
    double error_mm; /* 0: the triangles alone */
} aim;

typedef struct running {
    const cw_mesh *in;
    int program, file;
    aim target;
    double wall_s, cpu_s, build_s, peak_mb;
} running;

/* Touches and frees memory, so that a virtual machine's host has it at hand for who comes next:
 * else whoever grows first pays for it, by seconds. */
static bool warm(void *task)
{
    const running *r = task;
    const size_t bytes = 800 * r->in->triangle_count;
    volatile char *p = malloc(bytes);
    for (size_t n = 0; p && n < bytes; n += 4096)
        p[n] = 1;
    return p != NULL;
}

/* Sums the input: its pages then belong to the process before it is measured. */
static double touch(const cw_mesh *mesh)
{
    double sum = 0;
    for (size_t n = 0; n < 3 * mesh->vertex_count; n++)
        sum += (double)mesh->positions[n];
    for (size_t n = 0; n < 3 * mesh->triangle_count; n++)
        sum += mesh->triangles[n];
    return sum;
}

static double seconds(struct timeval t)
{
    return (double)t.tv_sec + 1e-6 * (double)t.tv_usec;
}

static bool run_program(void *task)
{
    running *r = task;
    struct rusage before, after;
    cw_mesh out = {0};
    if (!isfinite(touch(r->in)))
        return false;
    getrusage(RUSAGE_SELF, &before);
    const double begin = bench_now_s();
    const bool done = bench_programs[r->program].within
                          ? bench_programs[r->program].within(r->in, r->target.error_mm, &out)
                          : bench_programs[r->program].simplify(r->in, r->target.triangles,
                                                                &out, &r->build_s);
    r->wall_s = bench_now_s() - begin;
    getrusage(RUSAGE_SELF, &after);
    r->cpu_s = seconds(after.ru_utime) + seconds(after.ru_stime) - seconds(before.ru_utime) -
               seconds(before.ru_stime);
    r->peak_mb = (double)(after.ru_maxrss - before.ru_maxrss) / 1024;
    if (!done)
        return false;
    memcpy(out.origin, r->in->origin, sizeof out.origin);
    return bench_put_mesh(r->file, &out);
}

/* ---- what became of the mesh ------------------------------------------------------------- */

typedef struct judging {
    const cw_mesh *in, *out; /* in NULL: no distances */
    double rms_percent, max_mm, bound_mm;
    cw_quality quality;
    size_t crossings;
    bool undecided;
} judging;

static double diagonal_mm(const cw_mesh *mesh)
{
    double low[3], high[3], square = 0;
    cw_mesh_bounds(mesh, low, high);
    for (int a = 0; a < 3; a++)
        square += (high[a] - low[a]) * (high[a] - low[a]);
    return sqrt(square);
}

static cw_status judge_distance(judging *j, cw_error *err)
{
    cw_distance there, back;
    cw_status st = cw_distance_to_mesh(j->out, j->in, NULL, &there, NULL, err);
    if (st == CW_OK)
        st = cw_distance_to_mesh(j->in, j->out, NULL, &back, NULL, err);
    if (st != CW_OK)
        return st;
    const double square = (there.rms_mm * there.rms_mm + back.rms_mm * back.rms_mm) / 2;
    j->rms_percent = 100 * sqrt(square) / diagonal_mm(j->in);
    j->max_mm = fmax(there.max_mm, back.max_mm);
    j->bound_mm = fmax(there.bound_mm, back.bound_mm);
    return CW_OK;
}

static bool judge(void *task)
{
    judging *j = task;
    cw_error err = {0};
    cw_crossings crossings = {0};
    cw_status st = cw_quality_measure(j->out, NULL, &j->quality, &err);
    if (st == CW_OK)
        st = cw_self_intersections(j->out, NULL, &crossings, &err);
    j->crossings = crossings.count;
    j->undecided = crossings.undecided;
    if (st == CW_OK && j->in && j->out->triangle_count > 0)
        st = judge_distance(j, &err);
    if (st != CW_OK)
        fprintf(stderr, "%s\n", err.message);
    return st == CW_OK;
}

/* ---- reports ----------------------------------------------------------------------------- */

typedef struct row {
    bool asked, failed;
    int runs;
    double walls[MAX_RUNS], cpus[MAX_RUNS], builds[MAX_RUNS];
    double wall_s, cpu_s, build_s, peak_mb;
    judging found;
} row;

static double over(double a, double b)
{
    return b > 0 ? a / b : 0;
}

/* Name, format and value of what is reported of row r, with rows `ours` and `meshopt`. */
#define FIELDS(X)                                                                              \
    X("seconds", "%.4f", r->wall_s)                                                            \
    X("cpu_s", "%.4f", r->cpu_s)                                                               \
    X("build_s", "%.4f", r->build_s)                                                           \
    X("peak_mb", "%.1f", r->peak_mb)                                                           \
    X("triangles", "%zu", r->found.quality.triangles)                                          \
    X("rms_percent", "%.6f", r->found.rms_percent)                                             \
    X("max_mm", "%.5f", r->found.max_mm)                                                       \
    X("bound_mm", "%.5f", r->found.bound_mm)                                                   \
    X("nonmanifold_edges", "%zu", r->found.quality.nonmanifold_edges)                          \
    X("nonmanifold_vertices", "%zu", r->found.quality.nonmanifold_vertices)                    \
    X("open_edges", "%zu", r->found.quality.open_edges)                                        \
    X("degenerate", "%zu", r->found.quality.degenerate)                                        \
    X("crossings", "%zu", r->found.crossings)                                                  \
    X("undecided", "%d", r->found.undecided)                                                   \
    X("components", "%zu", r->found.quality.components)                                        \
    X("euler", "%lld", (long long)r->found.quality.euler)                                      \
    X("time_to_ours", "%.3f", over(r->wall_s, own->wall_s))                                    \
    X("time_to_meshopt", "%.3f", over(r->wall_s, meshopt->wall_s))                             \
    X("cpu_to_ours", "%.3f", over(r->cpu_s, own->cpu_s))                                       \
    X("cpu_to_meshopt", "%.3f", over(r->cpu_s, meshopt->cpu_s))                                \
    X("rms_to_ours", "%.3f", over(r->found.rms_percent, own->found.rms_percent))               \
    X("rms_to_meshopt", "%.3f", over(r->found.rms_percent, meshopt->found.rms_percent))

static void print_csv_head(FILE *csv)
{
    fputs("input,input_triangles,error_mm,percent,program,threads", csv);
#define HEAD(name, format, value) fputs("," name, csv);
    FIELDS(HEAD)
#undef HEAD
    fputc('\n', csv);
}

static void print_table_head(void)
{
    fprintf(stderr,
            "%-7s %5s %5s %-19s %8s %8s %7s %7s %9s %9s %8s %6s %9s %6s %8s %7s %7s %7s %7s\n",
            "input", "mm", "%", "program", "s", "cpu s", "build s", "MB", "triangles", "rms %",
            "max mm", "n-m", "crossing", "parts", "euler", "t/our", "t/mopt", "rms/our",
            "rms/mop");
}

static void print_table(const char *input, const aim *target, int program, const row *r,
                        const row *own, const row *meshopt)
{
    const judging *j = &r->found;
    fprintf(
        stderr,
        "%-7s %5g %5.3g %-19s %8.3f %8.3f %7.3f %7.0f %9zu %9.5f %8.4f %6zu %9zu %6zu %8lld "
        "%7.2f %7.2f %7.2f %7.2f\n",
        input, target->error_mm, target->percent, bench_programs[program].name, r->wall_s,
        r->cpu_s, r->build_s, r->peak_mb, j->quality.triangles, j->rms_percent, j->max_mm,
        j->quality.nonmanifold_edges, j->crossings, j->quality.components,
        (long long)j->quality.euler, over(r->wall_s, own->wall_s),
        over(r->wall_s, meshopt->wall_s), over(j->rms_percent, own->found.rms_percent),
        over(j->rms_percent, meshopt->found.rms_percent));
}

static void print_row(const char *input, size_t triangles, const aim *target, int program,
                      const row *rows, FILE *csv)
{
    const row *r = &rows[program], *own = &rows[OURS], *meshopt = &rows[MESHOPT];
    const int threads = program <= OURS_CROSSING ? bench_our_threads : 1;
    printf("{\"input\": \"%s\", \"input_triangles\": %zu, \"error_mm\": %g, "
           "\"percent\": %.4g, \"program\": \"%s\", \"threads\": %d",
           input, triangles, target->error_mm, target->percent, bench_programs[program].name,
           threads);
#define JSON(name, format, value) printf(", \"" name "\": " format, value);
    FIELDS(JSON)
#undef JSON
    printf("}\n");
    fflush(stdout);
    if (csv) {
        fprintf(csv, "%s,%zu,%g,%.4g,%s,%d", input, triangles, target->error_mm,
                target->percent, bench_programs[program].name, threads);
#define CSV(name, format, value) fprintf(csv, "," format, value);
        FIELDS(CSV)
#undef CSV
        fputc('\n', csv);
        fflush(csv);
    }
    print_table(input, target, program, r, own, meshopt);
}

/* ---- cases ------------------------------------------------------------------------------- */

typedef struct settings {
    const char *inputs, *targets, *errors, *peers, *data;
    size_t triangles;
    int repeat;
    FILE *csv;
} settings;

/* One more run of a program; the mesh of the first is judged. */
static bool run_once(const cw_mesh *in, int program, const aim *target, row *r)
{
    running *task = bench_shared_new(sizeof *task);
    *task = (running){
        .in = in, .program = program, .file = memfd_create("result", 0), .target = *target};
    bench_in_child(warm, task);
    bool done = task->file >= 0 && bench_in_child(run_program, task);
    if (done) {
        r->walls[r->runs] = task->wall_s;
        r->cpus[r->runs] = task->cpu_s;
        r->builds[r->runs++] = task->build_s;
        r->peak_mb = fmax(r->peak_mb, task->peak_mb);
    }
    if (done && r->runs == 1) {
        bench_seen_mesh out = bench_see_mesh(task->file);
        judging *j = bench_shared_new(sizeof *j);
        *j = (judging){.in = in, .out = &out.mesh};
        done = out.map && bench_in_child(judge, j);
        r->found = *j;
        munmap(j, sizeof *j);
        bench_unsee_mesh(&out);
    }
    close(task->file);
    munmap(task, sizeof *task);
    return done;
}

static int compare(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double median(double *values, int count)
{
    qsort(values, (size_t)count, sizeof *values, compare);
    return count ? values[count / 2] : 0;
}

static bool listed(const char *list, const char *name)
{
    const size_t n = strlen(name);
    for (const char *p = list; (p = strstr(p, name)); p += n)
        if ((p == list || p[-1] == ',') && (p[n] == ',' || !p[n]))
            return true;
    return !*list;
}

/* Returns true if a program takes part in a case: those that take an error need one, and ours
 * leads then. CGAL's envelope takes minutes, and has to be named. */
static bool takes_part(int program, const aim *target, const settings *s)
{
    if (!bench_is_here(program) || (bench_programs[program].within && target->error_mm == 0))
        return false;
    if (program == CGAL_ENVELOPE && !*s->peers)
        return false;
    return program == OURS_ERROR || listed(s->peers, bench_programs[program].name);
}

static void measure(const char *input, const cw_mesh *in, aim target, const settings *s)
{
    static row rows[PROGRAMS];
    memset(rows, 0, sizeof rows);
    for (int n = 0; n < s->repeat; n++)
        for (int p = 0; p < PROGRAMS; p++) {
            row *r = &rows[p];
            r->asked = takes_part(p, &target, s);
            if (r->asked && !r->failed)
                r->failed = !run_once(in, p, &target, r);
            if (p == OURS_ERROR && r->asked) {
                target.triangles = r->found.quality.triangles;
                target.percent = 100 * (double)target.triangles / (double)in->triangle_count;
            }
        }
    for (int p = 0; p < PROGRAMS; p++) {
        row *r = &rows[p];
        r->wall_s = median(r->walls, r->runs);
        r->cpu_s = median(r->cpus, r->runs);
        r->build_s = median(r->builds, r->runs);
    }
    for (int p = 0; p < PROGRAMS; p++)
        if (rows[p].failed)
            fprintf(stderr, "%-7s %5g %-19s failed\n", input, target.error_mm,
                    bench_programs[p].name);
        else if (rows[p].asked)
            print_row(input, in->triangle_count, &target, p, rows, s->csv);
}

/* Reads the next number of a list, and what follows it up to a comma. Returns false at the end. */
static bool read_next(const char **list, double *value)
{
    char *end;
    *value = strtod(*list, &end);
    if (end == *list)
        return false;
    *list = end + strcspn(end, ",");
    *list += **list == ',';
    return true;
}

static void measure_targets(const char *input, const cw_mesh *in, const settings *s)
{
    const char *percents = s->targets, *errors = s->errors;
    double value;
    while (read_next(&percents, &value) && value > 0 && value < 100) {
        const double triangles = (double)in->triangle_count * value / 100;
        measure(input, in, (aim){.triangles = (size_t)triangles, .percent = value}, s);
    }
    while (read_next(&errors, &value) && value > 0)
        measure(input, in, (aim){.error_mm = value}, s);
}

static void tell_input(const char *name, const cw_mesh *in)
{
    judging *j = bench_shared_new(sizeof *j);
    *j = (judging){.out = in};
    if (bench_in_child(judge, j))
        fprintf(stderr,
                "%s: %zu triangles, diagonal %.2f mm, %zu parts, euler %lld, %zu crossings, "
                "%zu non-manifold edges\n",
                name, in->triangle_count, diagonal_mm(in), j->quality.components,
                (long long)j->quality.euler, j->crossings, j->quality.nonmanifold_edges);
    munmap(j, sizeof *j);
}

/* False: the input cannot be had. */
static bool measure_input(int input, const settings *s)
{
    making *task = bench_shared_new(sizeof *task);
    *task =
        (making){.input = input, .file = memfd_create("input", 0), .triangles = s->triangles};
    snprintf(task->folder, sizeof task->folder, "%s", s->data ? s->data : "");
    bench_seen_mesh in = {0};
    if (bench_in_child(make_input, task))
        in = bench_see_mesh(task->file);
    if (in.map) {
        tell_input(inputs[input].name, &in.mesh);
        measure_targets(inputs[input].name, &in.mesh, s);
    }
    const bool had = in.map;
    bench_unsee_mesh(&in);
    close(task->file);
    munmap(task, sizeof *task);
    return had;
}

int main(int argc, char **argv)
{
    settings s = {.inputs = "", .peers = ""};
    const char *threads = "0", *repeat = "1", *triangles = "1000000", *csv = NULL;
    const struct {
        const char *name, **value;
    } options[] = {
        {"--inputs", &s.inputs}, {"--targets", &s.targets}, {"--error", &s.errors},
        {"--peers", &s.peers},   {"--data", &s.data},       {"--threads", &threads},
        {"--repeat", &repeat},   {"--csv", &csv},           {"--triangles", &triangles}};
    enum { OPTIONS = sizeof options / sizeof *options };
    for (int a = 1; a < argc; a += 2) {
        int o = 0;
        while (o < OPTIONS && strcmp(argv[a], options[o].name) != 0)
            o++;
        if (o == OPTIONS || a + 1 == argc)
            return fprintf(stderr, "unknown option, or no value: %s\n", argv[a]), 2;
        *options[o].value = argv[a + 1];
    }
    s.targets = s.targets ? s.targets : s.errors ? "" : "50,10,2";
    s.errors = s.errors ? s.errors : "";
    bench_our_threads = atoi(threads);
    s.triangles = strtoul(triangles, NULL, 10);
    s.repeat = atoi(repeat) < 1 ? 1 : atoi(repeat) > MAX_RUNS ? MAX_RUNS : atoi(repeat);
    if (csv && !(s.csv = fopen(csv, "w")))
        return perror(csv), 1;
    if (s.csv)
        print_csv_head(s.csv);
    print_table_head();
    for (int n = 0; n < INPUTS; n++)
        if (listed(s.inputs, inputs[n].name) && (s.data || !inputs[n].path) &&
            !measure_input(n, &s))
            fprintf(stderr, "%s: not measured\n", inputs[n].name);
    return s.csv && fclose(s.csv) != 0 ? (perror(csv), 1) : 0;
}
