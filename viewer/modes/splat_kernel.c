/* Describes the kernels of splatting, and makes their tables and triangles. */
#include "viewer/modes/splat_kernel.h"

#include "core/geometry/vec3.h"

#include <math.h>
#include <string.h>

enum { FOOTPRINT_ROWS = 256, SECTORS = 8, RECTANGLE = 2 };

/* The Gaussian's table ends where it has fallen to 0.3 %. The polygon's corners, a middle and
 * two rings of eight, are in the shader. */
static const cwi_splat_kernel kernels[CW_SPLAT_COUNT] = {
    [CW_SPLAT_GAUSSIAN] = {"", false, 1, 3.4, 4, RECTANGLE},
    [CW_SPLAT_POLYGON] = {"#define POLYGON\n", false, 1, 3.3, 1 + 2 * SECTORS, 3 * SECTORS},
    [CW_SPLAT_TENT] = {"#define IN_PLANE\n#define TENT\n", true, CWI_TENT_WIDTH,
                       1 / CWI_TENT_WIDTH, 4, RECTANGLE},
    [CW_SPLAT_B_SPLINE] = {"#define IN_PLANE\n", true, CWI_B_SPLINE_WIDTH,
                           2 / CWI_B_SPLINE_WIDTH, 4, RECTANGLE},
};

const cwi_splat_kernel *cwi_splat_kernel_of(const cw_scene *scene)
{
    return &kernels[scene->splat.kernel];
}

/* A Gaussian, lowered to reach 0 at the end, over its integral. */
GLuint cwi_splat_footprint(const cwi_splat_kernel *kernel, int unit)
{
    float rows[FOOTPRINT_ROWS];
    const double end = kernel->reach * kernel->reach / 2, rest = exp(-end);
    const double integral = 2 * CWI_PI * (1 - rest - end * rest);
    for (int n = 0; n < FOOTPRINT_ROWS; n++)
        rows[n] = (float)((exp(-end * n / (FOOTPRINT_ROWS - 1)) - rest) / integral);
    const GLuint texture = cwi_gl_texture(GL_TEXTURE_2D, unit, true);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_R32F, FOOTPRINT_ROWS, 1, 0, GL_RED, GL_FLOAT, rows);
    return texture;
}

/* Fills in the triangles of one polygon: a fan, and a strip around it. */
static void polygon_indices(uint32_t first, uint32_t *to)
{
    for (uint32_t n = 0; n < SECTORS; n++) {
        const uint32_t inner = first + 1 + n, next = first + 1 + (n + 1) % SECTORS;
        const uint32_t corners[9] = {first, inner,           next,
                                     inner, inner + SECTORS, next,
                                     next,  inner + SECTORS, next + SECTORS};
        memcpy(to + 9 * n, corners, sizeof corners);
    }
}

void cwi_splat_indices(const cwi_splat_kernel *of, size_t count, uint32_t *indices)
{
    static const uint32_t corners[6] = {0, 1, 2, 2, 1, 3};
    const bool is_polygon = of && of->triangles > RECTANGLE;
    for (uint32_t n = 0; n < count; n++)
        if (is_polygon)
            polygon_indices(n * (uint32_t)of->corners, indices + 3 * n * of->triangles);
        else
            for (uint32_t c = 0; c < 6; c++)
                indices[6 * n + c] = 4 * n + corners[c];
}

void cwi_splat_kernel_set(const cwi_splat_kernel *kernel, const cw_scene *scene, GLuint program)
{
    cwi_gl_set(program, "sigma", (float)scene->splat.width);
    cwi_gl_set(program, "radius", (float)kernel->reach);
    cwi_gl_set(program, "steps", (float)(scene->splat.width / kernel->unit));
}
