/* Part of a mesh, for measures that would take longer of all of it than what is measured. */
#include "cli/study/triangle_sample.h"

#include "core/base/memory.h"
#include "core/base/status.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Triangles follow each other along the surface: every n-th would follow its rows. */
static bool is_taken(size_t triangle, size_t one_of)
{
    uint64_t x = (uint64_t)triangle + 0x9e3779b97f4a7c15u;
    x = (x ^ x >> 30) * 0xbf58476d1ce4e5b9u;
    x = (x ^ x >> 27) * 0x94d049bb133111ebu;
    return (x ^ x >> 31) % one_of == 0;
}

/* Vertices are numbered as they are met; UINT32_MAX: not yet. */
static uint32_t take_vertex(cli_sample *s, const cw_mesh *mesh, uint32_t *number, uint32_t v)
{
    if (number[v] == UINT32_MAX) {
        number[v] = (uint32_t)s->mesh.vertex_count++;
        memcpy(s->mesh.positions + 3 * (size_t)number[v], mesh->positions + 3 * (size_t)v,
               3 * sizeof(float));
    }
    return number[v];
}

static void take_triangles(cli_sample *s, const cw_mesh *mesh, uint32_t *number,
                           size_t capacity)
{
    memset(number, 0xff, mesh->vertex_count * sizeof *number);
    for (size_t t = 0; t < mesh->triangle_count && s->mesh.triangle_count < capacity; t++) {
        if (!is_taken(t, s->one_of))
            continue;
        uint32_t *corners = s->mesh.triangles + 3 * s->mesh.triangle_count++;
        for (size_t c = 0; c < 3; c++)
            corners[c] = take_vertex(s, mesh, number, mesh->triangles[3 * t + c]);
    }
}

static double area_of(const cw_mesh *m, size_t t)
{
    const uint32_t *c = m->triangles + 3 * t;
    double u[3], v[3];
    for (size_t a = 0; a < 3; a++) {
        const double p = (double)m->positions[3 * (size_t)c[0] + a];
        u[a] = (double)m->positions[3 * (size_t)c[1] + a] - p;
        v[a] = (double)m->positions[3 * (size_t)c[2] + a] - p;
    }
    return 0.5 * hypot(hypot(u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2]),
                       u[0] * v[1] - u[1] * v[0]);
}

/* Large triangles are measured at many points, and count as many. */
static size_t choose_triangles(const cw_mesh *mesh, size_t max_count, double voxel_mm)
{
    double area = 0;
    for (size_t t = 0; t < mesh->triangle_count; t++)
        area += area_of(mesh, t);
    const double voxels = area / (voxel_mm * voxel_mm),
                 triangles = (double)mesh->triangle_count;
    const double one_of = fmin(fmax(voxels, triangles) / (double)max_count, triangles / 1000);
    return one_of > 1 ? (size_t)ceil(one_of) : 1;
}

cw_status cli_take_sample(const cw_mesh *mesh, size_t max_count, double voxel_mm, cli_sample *s,
                          cw_error *err)
{
    *s = (cli_sample){.one_of = choose_triangles(mesh, max_count, voxel_mm)};
    memcpy(s->mesh.origin, mesh->origin, sizeof s->mesh.origin);
    if (s->one_of == 1)
        return CW_OK;
    const size_t capacity = 2 * (mesh->triangle_count / s->one_of) + 100;
    uint32_t *number = cwi_alloc_array(mesh->vertex_count, sizeof *number);
    s->mesh.triangles = cwi_alloc_array(3 * capacity, sizeof(uint32_t));
    s->mesh.positions = cwi_alloc_array(9 * capacity, sizeof(float));
    const bool good = number && s->mesh.triangles && s->mesh.positions;
    if (good)
        take_triangles(s, mesh, number, capacity);
    cwi_free(number);
    return good ? CW_OK : cwi_fail_memory(err);
}

void cli_free_sample(cli_sample *s)
{
    cw_mesh_free(&s->mesh);
    *s = (cli_sample){0};
}

const cw_mesh *cli_sampled(const cli_sample *s, const cw_mesh *mesh)
{
    return s->one_of > 1 ? &s->mesh : mesh;
}
