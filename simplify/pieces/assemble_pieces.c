/* Puts pieces together again, and measures them beside the whole. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/mesh/mesh.h"
#include "core/texture/gather_meshes.h"
#include "simplify/pieces/measure_lines.h"

#include <cubewright/boolean.h>
#include <cubewright/distance.h>

#include <string.h>

/* Copies a piece, and moves it back to its place in the whole and to the origin of that. */
static cw_status move_back(const cw_piece *p, const double origin[3], cw_mesh *out,
                           cw_error *err)
{
    double back[12];
    const double *m = p->placed;
    for (int r = 0; r < 3; r++) {
        for (int k = 0; k < 3; k++)
            back[4 * r + k] = m[4 * k + r];
        back[4 * r + 3] = -(m[r] * m[3] + m[4 + r] * m[7] + m[8 + r] * m[11]);
    }
    cw_status st = cwi_mesh_copy(&p->mesh, out, err);
    if (st == CW_OK)
        st = cw_mesh_transform(out, back, err);
    for (size_t n = 0; n < 3 * out->vertex_count && st == CW_OK; n++)
        out->positions[n] =
            (float)((double)out->positions[n] + (out->origin[n % 3] - origin[n % 3]));
    memcpy(out->origin, origin, sizeof out->origin);
    return st;
}

/* Unites what overlaps in the whole: faces inside of it are no surface of the pieces. */
static cw_status unite_whole(const cw_mesh *whole, int threads, cw_mesh *out, cw_error *err)
{
    cw_mesh bare = *whole;
    const cw_mesh *list = &bare;
    const cw_boolean_desc desc = {.threads = threads};
    bare.normals = NULL;
    return cw_mesh_boolean(&list, 1, &desc, out, NULL, err);
}

/* Measures from the surface of the whole to those of all pieces. */
static cw_status measure_distance(const cw_mesh *meshes, size_t count,
                                  const cw_mesh_distance_desc *desc, cw_assembled *out,
                                  cw_error *err)
{
    cw_distance distance = {0};
    cw_mesh all = {0};
    const cw_mesh **list = cwi_alloc_array(count, sizeof *list);
    if (!list)
        return cwi_fail_memory(err);
    for (size_t n = 0; n < count; n++)
        list[n] = &meshes[n];
    cw_status st = cwi_gather_meshes(list + 1, NULL, count - 1, false, false, &all, err);
    if (st == CW_OK)
        st = cw_distance_to_mesh(&meshes[0], &all, desc, &distance, NULL, err);
    out->farthest_mm = distance.max_mm;
    cw_mesh_free(&all);
    cwi_free(list);
    return st;
}

cw_status cw_pieces_assemble(const cw_pieces *pieces, const cw_mesh *whole, int threads,
                             const cw_progress *progress, cw_assembled *out, cw_error *err)
{
    CWI_REQUIRE(err, pieces, whole, out);
    CWI_REQUIRE_VERSION(err, out, 0);
    const cw_progress none = {0};
    const cw_mesh_distance_desc measure = {.threads = threads,
                                           .progress = progress ? *progress : none};
    const size_t count = pieces->count + 1;
    cw_mesh *meshes = cwi_alloc_zeroed(count, sizeof *meshes);
    *out = (cw_assembled){0};
    if (!meshes)
        return cwi_fail_memory(err);
    cw_status st = unite_whole(whole, threads, &meshes[0], err);
    for (size_t n = 1; n < count && st == CW_OK; n++)
        st = move_back(&pieces->pieces[n - 1], whole->origin, &meshes[n], err);
    for (int axis = 0; axis < 3 && st == CW_OK; axis++)
        st = cwi_measure_lines(meshes, count, axis, out, err);
    if (st == CW_OK && count > 1)
        st = measure_distance(meshes, count, &measure, out, err);
    for (size_t n = 0; n < count; n++)
        cw_mesh_free(&meshes[n]);
    cwi_free(meshes);
    return st;
}
