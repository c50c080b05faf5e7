/* Simplifies a mesh with meshoptimizer, and removes unused vertices from its result. */
#include "simplify_peers.h"

#include <meshoptimizer.h>

#include <stdlib.h>
#include <string.h>

const bool bench_has_meshopt = true;

/* Its result has the input's vertices: those that no triangle uses any more are taken out. */
static bool compact(const cw_mesh *in, const uint32_t *triangles, size_t corners, cw_mesh *out)
{
    unsigned *remap = malloc(in->vertex_count * sizeof *remap);
    if (!remap)
        return false;
    const size_t vertices =
        meshopt_optimizeVertexFetchRemap(remap, triangles, corners, in->vertex_count);
    const bool done = bench_mesh_alloc(out, vertices, corners / 3);
    if (done) {
        meshopt_remapIndexBuffer(out->triangles, triangles, corners, remap);
        meshopt_remapVertexBuffer(out->positions, in->positions, in->vertex_count,
                                  3 * sizeof(float), remap);
    }
    free(remap);
    return done;
}

static bool simplify_to(const cw_mesh *in, size_t triangles, float error, cw_mesh *out)
{
    const size_t corners = 3 * in->triangle_count;
    uint32_t *left = malloc(corners * sizeof *left);
    if (!left)
        return false;
    const size_t count =
        meshopt_simplify(left, in->triangles, corners, in->positions, in->vertex_count,
                         3 * sizeof(float), 3 * triangles, error, 0, NULL);
    const bool done = compact(in, left, count, out);
    free(left);
    return done;
}

bool bench_meshopt(const cw_mesh *in, size_t triangles, cw_mesh *out, double *build_s)
{
    const float no_limit = 1e10f;
    *build_s = 0;
    return simplify_to(in, triangles, no_limit, out);
}

/* Its errors are fractions of the mesh's extent. */
bool bench_meshopt_error(const cw_mesh *in, double error_mm, cw_mesh *out)
{
    const float extent =
        meshopt_simplifyScale(in->positions, in->vertex_count, 3 * sizeof(float));
    return simplify_to(in, 0, (float)error_mm / extent, out);
}
