/* Looks at textures triangle by triangle. */
#include "support/texture.h"

#include "core/geometry/union_find.h"
#include "core/mesh/corner_table.h"

#include <cubewright/atlas.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

const float (*test_coordinates(const cw_mesh *mesh))[2]
{
    const cw_attribute *uv = cw_mesh_attribute_find(mesh, CW_TEXTURE_COORDINATES);
    assert_non_null(uv);
    assert_int_equal(uv->on, CW_ON_CORNERS);
    assert_int_equal(uv->type, CW_F32);
    assert_int_equal(uv->components, 2);
    return uv->data;
}

double test_texture_area(const float (*uv)[2])
{
    return -((double)(uv[1][0] - uv[0][0]) * (double)(uv[2][1] - uv[0][1]) -
             (double)(uv[1][1] - uv[0][1]) * (double)(uv[2][0] - uv[0][0])) /
           2;
}

/* Distance of a point inside from the nearest side, negative outside. */
static double depth_in(const float (*uv)[2], double x, double y)
{
    const double sign = test_texture_area(uv) < 0 ? -1 : 1;
    double depth = INFINITY;
    for (int k = 0; k < 3; k++) {
        const float *a = uv[k], *b = uv[(k + 1) % 3];
        const double dx = (double)b[0] - (double)a[0], dy = (double)b[1] - (double)a[1];
        depth = fmin(depth, -sign * (dx * (y - (double)a[1]) - dy * (x - (double)a[0])) /
                                hypot(dx, dy));
    }
    return depth;
}

size_t test_count_overlaps(const cw_mesh *mesh, size_t *covered)
{
    const float(*uv)[2] = test_coordinates(mesh);
    unsigned char *seen = calloc(TEST_PICTURE, TEST_PICTURE);
    size_t overlaps = 0;
    assert_non_null(seen);
    *covered = 0;
    for (size_t t = 0; t < mesh->triangle_count; t++, uv += 3) {
        double low[2] = {1, 1}, high[2] = {0, 0};
        for (int k = 0; k < 6; k++) {
            low[k % 2] = fmin(low[k % 2], (double)uv[k / 2][k % 2]);
            high[k % 2] = fmax(high[k % 2], (double)uv[k / 2][k % 2]);
        }
        for (int y = (int)(low[1] * TEST_PICTURE);
             y < TEST_PICTURE && y <= high[1] * TEST_PICTURE; y++)
            for (int x = (int)(low[0] * TEST_PICTURE);
                 x < TEST_PICTURE && x <= high[0] * TEST_PICTURE; x++) {
                unsigned char *texel = &seen[(size_t)y * TEST_PICTURE + (size_t)x];
                if (!(depth_in(uv, (x + 0.5) / TEST_PICTURE, (y + 0.5) / TEST_PICTURE) > 1e-6))
                    continue;
                overlaps += *texel == 1;
                *covered += *texel == 0;
                *texel = 1;
            }
    }
    free(seen);
    return overlaps;
}

static size_t corner_of(const cw_mesh *mesh, size_t triangle, uint32_t vertex)
{
    const uint32_t *v = mesh->triangles + 3 * triangle;
    return 3 * triangle + (v[0] == vertex ? 0 : v[1] == vertex ? 1 : 2);
}

size_t test_count_charts(const cw_mesh *mesh)
{
    const float(*uv)[2] = test_coordinates(mesh);
    const size_t corners = 3 * mesh->triangle_count;
    cwi_side *sides = malloc(corners * sizeof *sides + 1);
    uint32_t *parent = malloc(mesh->triangle_count * sizeof *parent + 1);
    size_t charts = mesh->triangle_count;
    assert_true(sides && parent);
    for (uint32_t t = 0; t < mesh->triangle_count; t++)
        parent[t] = t;
    cwi_sides_list(mesh->triangles, corners, sides);
    for (size_t n = 1; n < corners; n++) {
        const size_t t = sides[n - 1].corner / 3, other = sides[n].corner / 3;
        if (sides[n].key != sides[n - 1].key)
            continue;
        const uint32_t ends[2] = {(uint32_t)(sides[n].key >> 32), (uint32_t)sides[n].key};
        bool joined = true;
        for (int k = 0; k < 2; k++)
            joined = joined && memcmp(uv[corner_of(mesh, t, ends[k])],
                                      uv[corner_of(mesh, other, ends[k])], sizeof *uv) == 0;
        if (!joined ||
            cwi_sets_find(parent, (uint32_t)t) == cwi_sets_find(parent, (uint32_t)other))
            continue;
        cwi_sets_join(parent, (uint32_t)t, (uint32_t)other);
        charts--;
    }
    free(sides);
    free(parent);
    return charts;
}
