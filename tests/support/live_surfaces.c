/* Compares surfaces of OpenGL's compute shaders with cw_extract()'s. */
#include "support/live_surfaces.h"

#include "core/base/module.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static cwi_gl *context;
static const cwi_gl_functions *functions;

const cwi_gl_functions *live_functions(cwi_gl **gl)
{
    cw_error err = {0};
    int version = 0, minor = 0;
    const void *module;
    if (!cwi_module_present("gl"))
        skip();
    if (!context) {
        assert_ok(cwi_module_load("gl", &module, &err), err);
        functions = module;
        assert_ok(functions->open(&context, &err), err);
    }
    sscanf(functions->name(context), "OpenGL %d.%d", &version, &minor);
    if (10 * version + minor < 43)
        skip();
    *gl = context;
    return functions;
}

int live_close(void **state)
{
    (void)state;
    if (context)
        functions->close(context);
    context = NULL;
    return 0;
}

/* A vertex and its number. */
typedef struct vertex {
    float position[3], normal[3];
    size_t number;
} vertex;

static int by_position(const void *a, const void *b)
{
    const vertex *p = a, *q = b;
    for (int c = 0; c < 3; c++)
        if (p->position[c] != q->position[c])
            return p->position[c] < q->position[c] ? -1 : 1;
    for (int c = 0; c < 3; c++)
        if (p->normal[c] != q->normal[c])
            return p->normal[c] < q->normal[c] ? -1 : 1;
    return 0;
}

static vertex *sort_vertices(const cw_mesh *mesh)
{
    vertex *vertices = malloc(mesh->vertex_count * sizeof *vertices);
    for (size_t v = 0; v < mesh->vertex_count; v++) {
        memcpy(vertices[v].position, mesh->positions + 3 * v, sizeof vertices[v].position);
        memcpy(vertices[v].normal, mesh->normals + 3 * v, sizeof vertices[v].normal);
        vertices[v].number = v;
    }
    qsort(vertices, mesh->vertex_count, sizeof *vertices, by_position);
    return vertices;
}

static int by_corners(const void *a, const void *b)
{
    const uint32_t *p = a, *q = b;
    for (int c = 0; c < 3; c++)
        if (p[c] != q[c])
            return p[c] < q[c] ? -1 : 1;
    return 0;
}

/* Triangles by the places of their vertices in order, the lowest first, sorted. */
static uint32_t (*sort_triangles(const cw_mesh *mesh, const vertex *vertices))[3]
{
    uint32_t(*sorted)[3] = malloc(mesh->triangle_count * sizeof *sorted);
    uint32_t *rank = malloc(mesh->vertex_count * sizeof *rank);
    for (size_t v = 0; v < mesh->vertex_count; v++)
        rank[vertices[v].number] = (uint32_t)v;
    for (size_t t = 0; t < mesh->triangle_count; t++) {
        const uint32_t *corner = mesh->triangles + 3 * t;
        size_t first = 0;
        for (size_t c = 0; c < 3; c++) {
            assert_true(corner[c] < mesh->vertex_count);
            if (rank[corner[c]] < rank[corner[first]])
                first = c;
        }
        for (size_t c = 0; c < 3; c++)
            sorted[t][c] = rank[corner[(first + c) % 3]];
    }
    qsort(sorted, mesh->triangle_count, sizeof *sorted, by_corners);
    free(rank);
    return sorted;
}

live_difference live_compare(const cw_mesh *gpu, const cw_mesh *cpu)
{
    live_difference d = {0};
    assert_int_equal(gpu->vertex_count, cpu->vertex_count);
    assert_int_equal(gpu->triangle_count, cpu->triangle_count);
    if (!gpu->vertex_count)
        return d;
    assert_memory_equal(gpu->origin, cpu->origin, sizeof gpu->origin);
    vertex *a = sort_vertices(gpu), *b = sort_vertices(cpu);
    uint32_t(*t)[3] = sort_triangles(gpu, a), (*u)[3] = sort_triangles(cpu, b);
    for (size_t v = 0; v < gpu->vertex_count; v++) {
        if (memcmp(a[v].position, b[v].position, sizeof a[v].position) != 0 && d.positions < 9)
            print_message("%.9g %.9g %.9g, not %.9g %.9g %.9g\n", a[v].position[0],
                          a[v].position[1], a[v].position[2], b[v].position[0],
                          b[v].position[1], b[v].position[2]);
        d.positions += memcmp(a[v].position, b[v].position, sizeof a[v].position) != 0;
        bool same = true;
        for (int c = 0; c < 3; c++)
            same = same && a[v].normal[c] == b[v].normal[c];
        d.normals += !same;
        for (int c = 0; c < 3; c++)
            d.normal = fmax(d.normal, fabs((double)a[v].normal[c] - (double)b[v].normal[c]));
    }
    if (d.positions)
        fail_msg("%zu of %zu positions differ", d.positions, gpu->vertex_count);
    if (memcmp(t, u, gpu->triangle_count * sizeof *t) != 0)
        fail_msg("triangles differ");
    free(a);
    free(b);
    free(t);
    free(u);
    return d;
}

size_t live_check(const cw_volume *volume, double isovalue, bool inside_is_low, double normal,
                  live_difference *sum)
{
    cwi_gl *gl;
    const cwi_gl_functions *f = live_functions(&gl);
    const cw_live_surface live = {volume, isovalue, inside_is_low, true};
    const cw_extract_desc desc = {.isovalue = isovalue, .inside_is_low = inside_is_low};
    cw_mesh gpu = {0}, cpu = {0};
    cw_error err = {0};
    size_t size[2];
    f->forget(gl); /* another volume may have stood at the same address */
    assert_ok(cw_extract(volume, &desc, &cpu, NULL, &err), err);
    assert_ok(f->extract(gl, &live, NULL, NULL, size, &gpu, &err), err);
    assert_int_equal(size[0], gpu.vertex_count);
    assert_int_equal(size[1], gpu.triangle_count);
    const live_difference d = live_compare(&gpu, &cpu);
    if (d.normal > normal)
        fail_msg("%zu of %zu normals differ, by up to %g", d.normals, gpu.vertex_count,
                 d.normal);
    sum->normals += d.normals;
    sum->normal = fmax(sum->normal, d.normal);
    cw_mesh_free(&gpu);
    cw_mesh_free(&cpu);
    return size[1];
}
