/* Allocates, frees and checks meshes, and computes their bounds. */
#include "core/mesh/mesh.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/box.h"
#include "core/mesh/mesh_attributes.h"

#include <math.h>
#include <string.h>

cw_status cwi_mesh_renew(cw_mesh *mesh, size_t vertices, size_t triangles, bool normals,
                         cw_error *err)
{
    cw_mesh made = {.vertex_count = vertices, .triangle_count = triangles};
    made.positions = cwi_renew_large(mesh->positions, vertices, 3 * sizeof *made.positions);
    made.triangles = cwi_renew_large(mesh->triangles, triangles, 3 * sizeof *made.triangles);
    mesh->positions = NULL;
    mesh->triangles = NULL;
    if (normals) {
        made.normals = cwi_renew_large(mesh->normals, vertices, 3 * sizeof *made.normals);
        mesh->normals = NULL;
    }
    cw_mesh_free(mesh);
    if (!made.positions || !made.triangles || (normals && !made.normals)) {
        cw_mesh_free(&made);
        return cwi_fail_memory(err);
    }
    *mesh = made;
    return CW_OK;
}

cw_status cwi_mesh_alloc(cw_mesh *mesh, size_t vertices, size_t triangles, bool normals,
                         cw_error *err)
{
    *mesh = (cw_mesh){0};
    return cwi_mesh_renew(mesh, vertices, triangles, normals, err);
}

cw_status cwi_mesh_copy(const cw_mesh *mesh, cw_mesh *copy, cw_error *err)
{
    const size_t vertices = mesh->vertex_count, triangles = mesh->triangle_count;
    cw_status st = cwi_mesh_alloc(copy, vertices, triangles, false, err);
    if (st != CW_OK)
        return st;
    memcpy(copy->origin, mesh->origin, sizeof copy->origin);
    memcpy(copy->affine, mesh->affine, sizeof copy->affine);
    if (vertices)
        memcpy(copy->positions, mesh->positions, 3 * vertices * sizeof *copy->positions);
    if (triangles)
        memcpy(copy->triangles, mesh->triangles, 3 * triangles * sizeof *copy->triangles);
    return cwi_attributes_copy(mesh, copy, err);
}

void cw_label_surfaces_free(cw_label_surfaces *s)
{
    if (!s)
        return;
    cw_mesh_free(&s->mesh);
    cwi_free(s->patches);
    cwi_free(s->labels);
    memset(s, 0, sizeof *s);
}

/* Elements of a long array that are looked at before memory is trimmed. */
enum { BLOCK = 3 << 16 };

static size_t block_end(size_t first, size_t count)
{
    return count - first < BLOCK ? count : first + BLOCK;
}

/* Whether all numbers are finite. There is no early exit from a block, so that the compiler can look at
 * several at a time. */
static bool are_finite(const float *numbers, size_t count)
{
    const uint32_t EXPONENT_BITS = 0x7f800000; /* all of its bits: infinite or not a number */
    uint32_t bad = 0;
    for (size_t first = 0; first < count && !bad; first += BLOCK) {
        const size_t end = block_end(first, count);
        for (size_t i = first; i < end; i++) {
            uint32_t bits;
            memcpy(&bits, &numbers[i], sizeof bits);
            bad |= (bits & EXPONENT_BITS) == EXPONENT_BITS;
        }
        cwi_memory_trim();
    }
    return !bad;
}

static bool are_below(const uint32_t *numbers, size_t count, size_t limit)
{
    uint32_t max_index = 0;
    for (size_t first = 0; first < count; first += BLOCK) {
        const size_t end = block_end(first, count);
        for (size_t i = first; i < end; i++)
            max_index = numbers[i] > max_index ? numbers[i] : max_index;
        cwi_memory_trim();
    }
    return !count || max_index < limit;
}

cw_status cw_mesh_check(const cw_mesh *mesh, cw_error *err)
{
    CWI_REQUIRE(err, mesh);
    CWI_REQUIRE_VERSION(err, mesh, 0);
    if ((mesh->vertex_count && !mesh->positions) || (mesh->triangle_count && !mesh->triangles))
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "a mesh with elements needs positions and triangles");
    for (int a = 0; a < 3; a++)
        if (!isfinite(mesh->origin[a]))
            return cwi_fail(err, CW_ERR_ARGUMENT, "the mesh's origin is not finite");
    const bool finite = are_finite(mesh->positions, 3 * mesh->vertex_count);
    for (size_t i = 0; i < 3 * mesh->vertex_count && !finite; i++)
        if (!isfinite(mesh->positions[i]))
            return cwi_fail(err, CW_ERR_ARGUMENT, "the position of vertex %zu is not finite",
                            i / 3);
    const bool below = are_below(mesh->triangles, 3 * mesh->triangle_count, mesh->vertex_count);
    for (size_t i = 0; i < 3 * mesh->triangle_count && !below; i++)
        if (mesh->triangles[i] >= mesh->vertex_count)
            return cwi_fail(err, CW_ERR_ARGUMENT, "triangle %zu names vertex %u of %zu", i / 3,
                            mesh->triangles[i], mesh->vertex_count);
    return CW_OK;
}

cw_status cwi_mesh_check_size(const cw_mesh *mesh, const char *done, cw_error *err)
{
    cw_status st = cw_mesh_check(mesh, err);
    if (st == CW_OK &&
        (mesh->triangle_count > CWI_MAX_TRIANGLES || mesh->vertex_count > CWI_MAX_TRIANGLES))
        st = cwi_fail(err, CW_ERR_LIMIT,
                      "%zu triangles and %zu vertices; at most %zu of each are %s",
                      mesh->triangle_count, mesh->vertex_count, CWI_MAX_TRIANGLES, done);
    return st;
}

bool cw_mesh_bounds(const cw_mesh *mesh, double min[3], double max[3])
{
    if (!mesh || !min || !max)
        return false;
    double low[3], high[3];
    cwi_box_clear(low, high);
    for (size_t v = 0; v < mesh->vertex_count; v += BLOCK) {
        cwi_box_add_points(low, high, mesh->positions + 3 * v,
                           block_end(v, mesh->vertex_count) - v);
        cwi_memory_trim();
    }
    for (int a = 0; a < 3; a++) {
        min[a] = mesh->vertex_count ? mesh->origin[a] + low[a] : 0;
        max[a] = mesh->vertex_count ? mesh->origin[a] + high[a] : 0;
    }
    return mesh->vertex_count > 0;
}
