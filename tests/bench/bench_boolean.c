/* Times booleans, and CGAL's corefinement beside ours: interleaved, medians.
 *
 * bench_boolean [RUNS [A B]]
 *
 * Prints a JSON line an operation and number of threads: of the meshes in two files, or of spheres and
 * gyroids of 10 thousand to 1 million triangles with themselves, moved by half a voxel. */
#define _DEFAULT_SOURCE /* clock_gettime */
#include "bench.h"
#include "cgal_bench.h"

#include <cubewright/cubewright.h>

enum { MAX_RUNS = 99, OPERATIONS = 3 };

static const char *const operations[OPERATIONS] = {"union", "difference", "intersection"};

static double wall_ms(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return 1e3 * (double)t.tv_sec + 1e-6 * (double)t.tv_nsec;
}

/* Times an operation with each number of threads, and CGAL's. */
static void bench(const char *name, const cw_mesh *a, const cw_mesh *b, int op, int runs)
{
    const cw_mesh *const meshes[2] = {a, b};
    double wall[2][MAX_RUNS], cpu[2][MAX_RUNS], cgal[MAX_RUNS], volume = 0;
    cw_boolean_facts facts = {0};
    cw_error err = {0};
    for (int n = 0; n < runs; n++) {
        for (int threads = 1; threads <= 2; threads++) {
            cw_mesh out = {0};
            const double from = wall_ms(), cpu_from = bench_cpu_ms();
            bench_check(
                cw_mesh_boolean(meshes, 2,
                                &(cw_boolean_desc){.op = (cw_boolean_op)op, .threads = threads},
                                &out, &facts, &err),
                &err);
            wall[threads - 1][n] = wall_ms() - from;
            cpu[threads - 1][n] = bench_cpu_ms() - cpu_from;
            cw_mesh_free(&out);
        }
        cgal[n] = bench_cgal_boolean(a, b, op, &volume);
    }
    const double theirs = bench_median(cgal, runs);
    for (int t = 0; t < 2; t++) {
        const double ours = bench_median(cpu[t], runs);
        printf("{\"meshes\": \"%s\", \"op\": \"%s\", \"triangles\": %zu, \"new_points\": %zu, "
               "\"threads\": %d, \"wall_ms\": %.1f, \"cpu_ms\": %.1f, \"cgal_cpu_ms\": %.1f, "
               "\"ratio\": %.2f, \"volume\": %.10g, \"cgal_volume\": %.10g}\n",
               name, operations[op], a->triangle_count + b->triangle_count, facts.new_points,
               t + 1, bench_median(wall[t], runs), ours, theirs, theirs > 0 ? theirs / ours : 0,
               facts.volume_mm3[0], volume);
        fflush(stdout);
    }
}

static void bench_files(const char *const paths[2], int runs)
{
    cw_mesh mesh[2] = {0};
    cw_error err = {0};
    for (int n = 0; n < 2; n++)
        bench_check(cw_mesh_read(paths[n], NULL, &mesh[n], NULL, &err), &err);
    for (int op = 0; op < OPERATIONS; op++)
        bench("files", &mesh[0], &mesh[1], op, runs);
    for (int n = 0; n < 2; n++)
        cw_mesh_free(&mesh[n]);
}

static void bench_field(const char *name, cw_field field, size_t size, int runs)
{
    const cw_field_desc desc = {.field = field, .type = CW_F32, .dim = {size, size, size}};
    cw_volume volume;
    cw_mesh mesh[2] = {0};
    cw_error err = {0};
    bench_check(cw_field_sample(&desc, &volume, &err), &err);
    for (int n = 0; n < 2; n++) {
        bench_check(cw_extract(&volume,
                               &(cw_extract_desc){.isovalue = (float)cw_field_isovalue(field),
                                                  .no_normals = true},
                               &mesh[n], NULL, &err),
                    &err);
        for (int k = 0; k < 3; k++)
            for (int c = 0; c < 3; c++) /* half a voxel along each axis */
                volume.affine[k][3] += volume.affine[k][c] / 2;
    }
    for (size_t i = 0; i < 3 * mesh[1].vertex_count; i++) /* CGAL knows no origin */
        mesh[1].positions[i] += (float)(mesh[1].origin[i % 3] - mesh[0].origin[i % 3]);
    for (int k = 0; k < 3; k++)
        mesh[1].origin[k] = mesh[0].origin[k];
    for (int op = 0; op < OPERATIONS; op++)
        bench(name, &mesh[0], &mesh[1], op, runs);
    for (int n = 0; n < 2; n++)
        cw_mesh_free(&mesh[n]);
    cw_volume_free(&volume);
}

int main(int count, char **words)
{
    const int runs = count > 1 ? atoi(words[1]) : 3;
    if (runs < 1 || runs > MAX_RUNS || count == 3 || count > 4) {
        fprintf(stderr, "usage: bench_boolean [RUNS [A B]]\n");
        return 2;
    }
    if (count == 4) {
        bench_files((const char *const[2]){words[2], words[3]}, runs);
        return 0;
    }
    bench_field("spheres", CW_FIELD_SPHERE, 40, runs);
    bench_field("spheres", CW_FIELD_SPHERE, 122, runs);
    bench_field("spheres", CW_FIELD_SPHERE, 384, runs);
    bench_field("gyroids", CW_FIELD_GYROID, 24, runs);
    bench_field("gyroids", CW_FIELD_GYROID, 72, runs);
    bench_field("gyroids", CW_FIELD_GYROID, 220, runs);
    return 0;
}
