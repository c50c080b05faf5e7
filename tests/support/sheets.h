/* Meshes with known pictures: squares that face the camera, and balls. */
#ifndef TESTS_SHEETS_H
#define TESTS_SHEETS_H

#include "support/pictures.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A camera before the middle of the world, at y = -500. */
static inline cw_camera straight(double height_mm)
{
    return (cw_camera){.eye = {0, -500, 0}, .up = {0, 0, 1}, .height_mm = height_mm};
}

static inline void make_arrays(cw_mesh *mesh, size_t vertices, size_t triangles)
{
    *mesh = (cw_mesh){.vertex_count = vertices, .triangle_count = triangles};
    mesh->positions = calloc(vertices, 12);
    mesh->triangles = calloc(triangles, 12);
    mesh->colors = calloc(vertices, 4);
    assert_true(mesh->positions && mesh->triangles && mesh->colors);
}

/* A square in front of the camera, at some y, that reaches from -half to half; facing it. */
static inline void put_sheet(cw_mesh *mesh, size_t n, float y, float half,
                             const uint8_t color[4])
{
    static const uint32_t corners[6] = {0, 1, 2, 0, 2, 3};
    static const float x[4] = {-1, 1, 1, -1}, z[4] = {-1, -1, 1, 1};
    for (size_t v = 0; v < 4; v++) {
        const float p[3] = {half * x[v], y, half * z[v]};
        memcpy(mesh->positions + 3 * (4 * n + v), p, sizeof p);
        memcpy(mesh->colors + 4 * (4 * n + v), color, 4);
    }
    for (size_t c = 0; c < 6; c++)
        mesh->triangles[6 * n + c] = (uint32_t)(4 * n) + corners[c];
}

/* A sphere by longitude and latitude around a point, with normals. */
static inline void make_ball(cw_mesh *mesh, double radius, const double middle[3])
{
    enum { N = 96, M = 48 };
    size_t t = 0;
    make_arrays(mesh, (N + 1) * (M + 1), 2 * N * M);
    free(mesh->colors);
    mesh->colors = NULL;
    mesh->normals = calloc(mesh->vertex_count, 12);
    assert_non_null(mesh->normals);
    memcpy(mesh->origin, middle, sizeof mesh->origin);
    for (size_t v = 0; v < mesh->vertex_count; v++) {
        const double a = 2 * PI * (double)(v % (N + 1) % N) / N,
                     b = PI * (double)(v / (N + 1)) / M;
        const double n[3] = {sin(b) * cos(a), sin(b) * sin(a), -cos(b)};
        for (size_t c = 0; c < 3; c++) {
            mesh->normals[3 * v + c] = (float)n[c];
            mesh->positions[3 * v + c] = (float)(radius * n[c]);
        }
    }
    for (uint32_t j = 0; j < M; j++)
        for (uint32_t i = 0; i < N; i++, t++) {
            const uint32_t a = j * (N + 1) + i, c = a + N + 1;
            memcpy(mesh->triangles + 6 * t, (const uint32_t[6]){a, a + 1, c + 1, a, c + 1, c},
                   24);
        }
}

/* Lit by nothing but ambient light, a surface has its own colour. */
static const cw_material flat = {1, 0, 0, 1};

static inline const float *pixel(const cw_picture *p, size_t x, size_t y)
{
    return p->pixels + 4 * (y * p->width + x);
}

#endif
