/* Compares cw_simplify() with other programs' simplifiers: time, memory, and the result.
 *
 * bench_simplify [--inputs sphere,gyroid,head,bone] [--targets 50,10,2] [--peers
 * cubewright,...]
 *                [--threads N] [--repeat 1] [--triangles 1000000] [--data FOLDER] [--csv FILE]
 *
 * Prints a JSON line a case on stdout, a table on stderr; --csv writes the same once more.
 * Targets are percents of the triangles; --threads is for ours, the others have one;
 * --triangles is about how many the made inputs have. Scans are measured where FOLDER has them.
 *
 * Times are medians, the programs taking turns; they contain the copy into a program's own data
 * structure (build_s) and the copy of the result. peak_mb is what the process grew by.
 * Distances are those of both sides: rms is the root of the mean of both squares, in percent of
 * the diagonal of the input's box. `_to_ours` and `_to_meshopt` are ratios to those programs in
 * the same case: above 1 it is slower, or farther from the input. 0: not known.
 *
 * Every step runs in a process of its own, for the memory's sake. This one only waits for them:
 * OpenMP's threads do not survive a fork, so it must never start any. */
#define _GNU_SOURCE /* memfd_create */
#include <cubewright/cubewright.h>

#include "simplify_peers.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

enum { MAX_RUNS = 99, MAX_PATH = 4096 };

/* ---- programs and inputs ----------------------------------------------------------------- */

static int our_threads;

/* Without normals, as the others. */
static bool ask_ours(const cw_mesh *in, const cw_simplify_desc *desc, cw_mesh *out)
{
    cw_mesh bare = *in;
    cw_error err = {0};
    bare.normals = NULL;
    const cw_status st = cw_simplify(&bare, desc, out, NULL, &err);
    if (st != CW_OK)
        fprintf(stderr, "%s\n", err.message);
    return st == CW_OK;
}

static bool ours(const cw_mesh *in, size_t triangles, cw_mesh *out, double *build_s)
{
    *build_s = 0;
    return ask_ours(in, &(cw_simplify_desc){.triangles = triangles, .threads = our_threads},
                    out);
}

static bool ours_crossing(const cw_mesh *in, size_t triangles, cw_mesh *out, double *build_s)
{
    const cw_simplify_desc desc = {
        .triangles = triangles, .threads = our_threads, .allow_crossings = true};
    *build_s = 0;
    return ask_ours(in, &desc, out);
}
enum { OURS, OURS_CROSSING, MESHOPT, VTK, OPENMESH, CGAL, PROGRAMS };

static const struct {
    const char *name;
    bench_simplifier *simplify;
} programs[PROGRAMS] = {
    [OURS] = {"cubewright", ours},
    [OURS_CROSSING] = {"cubewright-crossing", ours_crossing}, /* allow_crossings */
    [MESHOPT] = {"meshoptimizer", bench_meshopt},
    [VTK] = {"vtk", bench_vtk},
    [OPENMESH] = {"openmesh", bench_openmesh},
    [CGAL] = {"cgal", bench_cgal},
};

static bool is_here(int program)
{
    const bool ours_is = cw_simplify_available();
    const bool here[PROGRAMS] = {
        ours_is, ours_is, bench_has_meshopt, bench_has_vtk, bench_has_openmesh, bench_has_cgal};
    return here[program];
}

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

/* ---------------------------------------------------------------- processes and
 * their results */

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

/* Memory that a child's answers can be read from. */
static void *shared_new(size_t bytes)
{
    void *p = mmap(NULL, bytes, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (p == MAP_FAILED) {
        perror("bench_simplify");
        exit(1);
    }
    return p;
}

/* Whether work came to its end, and said so. */
static bool in_child(bool (*work)(void *task), void *task)
{
    int status = 1;
    fflush(NULL);
    const pid_t child = fork();
    if (child == 0) {
        const bool done = work(task);
        fflush(NULL);
        _exit(done ? 0 : 1);
    }
    return child > 0 && waitpid(child, &status, 0) == child && status == 0;
}

/* Meshes go from process to process in files without names: this, positions, triangles. */
typedef struct mesh_head {
    double origin[3];
    uint64_t vertices, triangles;
} mesh_head;

static bool put(int file, const void *data, size_t bytes)
{
    for (const char *p = data; bytes > 0;) {
        const ssize_t n = write(file, p, bytes);
        if (n <= 0)
            return false;
        p += n;
        bytes -= (size_t)n;
    }
    return true;
}

static bool put_mesh(int file, const cw_mesh *mesh)
{
    mesh_head head = {.vertices = mesh->vertex_count, .triangles = mesh->triangle_count};
    memcpy(head.origin, mesh->origin, sizeof head.origin);
    return put(file, &head, sizeof head) &&
           put(file, mesh->positions, 12 * mesh->vertex_count) &&
           put(file, mesh->triangles, 12 * mesh->triangle_count);
}

/* A mesh that stands in such a file. */
typedef struct seen_mesh {
    cw_mesh mesh;
    void *map;
    size_t bytes;
} seen_mesh;

static seen_mesh see_mesh(int file)
{
    struct stat st;
    seen_mesh m = {0};
    if (fstat(file, &st) != 0 || (size_t)st.st_size < sizeof(mesh_head))
        return m;
    m.bytes = (size_t)st.st_size;
    m.map = mmap(NULL, m.bytes, PROT_READ, MAP_SHARED, file, 0);
    if (m.map == MAP_FAILED)
        return (seen_mesh){0};
    const mesh_head *head = m.map;
    memcpy(m.mesh.origin, head->origin, sizeof head->origin);
    m.mesh.vertex_count = head->vertices;
    m.mesh.triangle_count = head->triangles;
    m.mesh.positions = (float *)(head + 1);
    m.mesh.triangles = (uint32_t *)(m.mesh.positions + 3 * head->vertices);
    return m;
}

static void unsee_mesh(seen_mesh *m)
{
    if (m->map)
        munmap(m->map, m->bytes);
    *m = (seen_mesh){0};
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
    return st == CW_OK && put_mesh(m->file, &mesh);
}

/* ---- one run of one program -------------------------------------------------------------- */

typedef struct running {
    const cw_mesh *in;
    int program, file;
    size_t triangles;
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
    const bool done = programs[r->program].simplify(r->in, r->triangles, &out, &r->build_s);
    r->wall_s = bench_now_s() - begin;
    getrusage(RUSAGE_SELF, &after);
    r->cpu_s = seconds(after.ru_utime) + seconds(after.ru_stime) - seconds(before.ru_utime) -
               seconds(before.ru_stime);
    r->peak_mb = (double)(after.ru_maxrss - before.ru_maxrss) / 1024;
    if (!done)
        return false;
    memcpy(out.origin, r->in->origin, sizeof out.origin);
    return put_mesh(r->file, &out);
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
    fputs("input,input_triangles,percent,program,threads", csv);
#define HEAD(name, format, value) fputs("," name, csv);
    FIELDS(HEAD)
#undef HEAD
    fputc('\n', csv);
}

static void print_table_head(void)
{
    fprintf(
        stderr, "%-7s %5s %-19s %8s %8s %7s %7s %9s %9s %8s %6s %9s %6s %8s %7s %7s %7s %7s\n",
        "input", "%", "program", "s", "cpu s", "build s", "MB", "triangles", "rms %", "max mm",
        "n-m", "crossing", "parts", "euler", "t/our", "t/mopt", "rms/our", "rms/mop");
}

static void print_table(const char *input, double percent, int program, const row *r,
                        const row *own, const row *meshopt)
{
    const judging *j = &r->found;
    fprintf(stderr,
            "%-7s %5g %-19s %8.3f %8.3f %7.3f %7.0f %9zu %9.5f %8.4f %6zu %9zu %6zu %8lld "
            "%7.2f %7.2f %7.2f %7.2f\n",
            input, percent, programs[program].name, r->wall_s, r->cpu_s, r->build_s, r->peak_mb,
            j->quality.triangles, j->rms_percent, j->max_mm, j->quality.nonmanifold_edges,
            j->crossings, j->quality.components, (long long)j->quality.euler,
            over(r->wall_s, own->wall_s), over(r->wall_s, meshopt->wall_s),
            over(j->rms_percent, own->found.rms_percent),
            over(j->rms_percent, meshopt->found.rms_percent));
}

static void print_row(const char *input, size_t triangles, double percent, int program,
                      const row *rows, FILE *csv)
{
    const row *r = &rows[program], *own = &rows[OURS], *meshopt = &rows[MESHOPT];
    const int threads = program == OURS || program == OURS_CROSSING ? our_threads : 1;
    printf("{\"input\": \"%s\", \"input_triangles\": %zu, \"percent\": %g, "
           "\"program\": \"%s\", \"threads\": %d",
           input, triangles, percent, programs[program].name, threads);
#define JSON(name, format, value) printf(", \"" name "\": " format, value);
    FIELDS(JSON)
#undef JSON
    printf("}\n");
    fflush(stdout);
    if (csv) {
        fprintf(csv, "%s,%zu,%g,%s,%d", input, triangles, percent, programs[program].name,
                threads);
#define CSV(name, format, value) fprintf(csv, "," format, value);
        FIELDS(CSV)
#undef CSV
        fputc('\n', csv);
        fflush(csv);
    }
    print_table(input, percent, program, r, own, meshopt);
}

/* ---- cases ------------------------------------------------------------------------------- */

typedef struct settings {
    const char *inputs, *targets, *peers, *data;
    size_t triangles;
    int repeat;
    FILE *csv;
} settings;

/* One more run of a program; the mesh of the first is judged. */
static bool run_once(const cw_mesh *in, int program, size_t triangles, row *r)
{
    running *task = shared_new(sizeof *task);
    *task = (running){.in = in,
                      .program = program,
                      .file = memfd_create("result", 0),
                      .triangles = triangles};
    in_child(warm, task);
    bool done = task->file >= 0 && in_child(run_program, task);
    if (done) {
        r->walls[r->runs] = task->wall_s;
        r->cpus[r->runs] = task->cpu_s;
        r->builds[r->runs++] = task->build_s;
        r->peak_mb = fmax(r->peak_mb, task->peak_mb);
    }
    if (done && r->runs == 1) {
        seen_mesh out = see_mesh(task->file);
        judging *j = shared_new(sizeof *j);
        *j = (judging){.in = in, .out = &out.mesh};
        done = out.map && in_child(judge, j);
        r->found = *j;
        munmap(j, sizeof *j);
        unsee_mesh(&out);
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

static void measure(const char *input, const cw_mesh *in, double percent, const settings *s)
{
    static row rows[PROGRAMS];
    const size_t triangles = (size_t)((double)in->triangle_count * percent / 100);
    memset(rows, 0, sizeof rows);
    for (int n = 0; n < s->repeat; n++)
        for (int p = 0; p < PROGRAMS; p++) {
            row *r = &rows[p];
            r->asked = is_here(p) && listed(s->peers, programs[p].name);
            if (r->asked && !r->failed)
                r->failed = !run_once(in, p, triangles, r);
        }
    for (int p = 0; p < PROGRAMS; p++) {
        row *r = &rows[p];
        r->wall_s = median(r->walls, r->runs);
        r->cpu_s = median(r->cpus, r->runs);
        r->build_s = median(r->builds, r->runs);
    }
    for (int p = 0; p < PROGRAMS; p++)
        if (rows[p].failed)
            fprintf(stderr, "%-7s %5g %-19s failed\n", input, percent, programs[p].name);
        else if (rows[p].asked)
            print_row(input, in->triangle_count, percent, p, rows, s->csv);
}

static void tell_input(const char *name, const cw_mesh *in)
{
    judging *j = shared_new(sizeof *j);
    *j = (judging){.out = in};
    if (in_child(judge, j))
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
    making *task = shared_new(sizeof *task);
    *task =
        (making){.input = input, .file = memfd_create("input", 0), .triangles = s->triangles};
    snprintf(task->folder, sizeof task->folder, "%s", s->data ? s->data : "");
    seen_mesh in = {0};
    if (in_child(make_input, task))
        in = see_mesh(task->file);
    if (in.map) {
        tell_input(inputs[input].name, &in.mesh);
        const char *next = s->targets;
        for (char *end; *next; next = *end ? end + 1 : end) {
            const double percent = strtod(next, &end);
            if (end == next || !(percent > 0 && percent < 100))
                break;
            measure(inputs[input].name, &in.mesh, percent, s);
        }
    }
    const bool had = in.map;
    unsee_mesh(&in);
    close(task->file);
    munmap(task, sizeof *task);
    return had;
}

int main(int argc, char **argv)
{
    settings s = {.inputs = "", .targets = "50,10,2", .peers = ""};
    const char *threads = "0", *repeat = "1", *triangles = "1000000", *csv = NULL;
    const struct {
        const char *name, **value;
    } options[] = {{"--inputs", &s.inputs}, {"--targets", &s.targets},  {"--peers", &s.peers},
                   {"--data", &s.data},     {"--threads", &threads},    {"--repeat", &repeat},
                   {"--csv", &csv},         {"--triangles", &triangles}};
    enum { OPTIONS = sizeof options / sizeof *options };
    for (int a = 1; a < argc; a += 2) {
        int o = 0;
        while (o < OPTIONS && strcmp(argv[a], options[o].name) != 0)
            o++;
        if (o == OPTIONS || a + 1 == argc)
            return fprintf(stderr, "unknown option, or no value: %s\n", argv[a]), 2;
        *options[o].value = argv[a + 1];
    }
    our_threads = atoi(threads);
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
