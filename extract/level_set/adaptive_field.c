/* Samples the signed distance from a mesh at the points of an adaptive grid [Frisken2000]. */
#include "extract/level_set/adaptive_field.h"

#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/geometry/closest_point.h"
#include "core/mesh/mesh_triangle.h"
#include "extract/level_set/level_set.h"

#include <math.h>

enum { CHUNK = 256 };

/* ---- values ------------------------------------------------------------------------------ */

static double distance_at(const cwi_adaptive *a, const double position[3])
{
    double p[3];
    cwi_adaptive_to_mesh(a, position, p);
    const cwi_closest c = cwi_closest_find(a->mesh, &a->tree, p);
    return cwi_distance(p, c.point);
}

static void measure_point(cwi_adaptive *a, size_t n)
{
    uint32_t at[3];
    cwi_lattice_point(a->points.keys[n], at);
    const bool is_whole = (at[0] | at[1] | at[2]) % CWI_PARTS == 0;
    const uint32_t voxel[3] = {at[0] / CWI_PARTS, at[1] / CWI_PARTS, at[2] / CWI_PARTS};
    const float *known = is_whole ? cwi_level_set_voxel(a->volume, &a->leaves, voxel) : NULL;
    double *position = a->positions[n];
    bool inside;
    if (!cwi_adaptive_position(a, at, position, &inside))
        inside = known ? *known < 0 : cwi_adaptive_is_inside(a, position);
    const double distance = known ? fabs((double)*known) : distance_at(a, position);
    a->values[n] = (float)((inside ? -1 : 1) * fmax(distance, CWI_THIN * a->voxel));
}

static void measure_chunk(void *context, size_t chunk)
{
    cwi_adaptive *a = context;
    const size_t begin = a->measured + CHUNK * chunk;
    for (size_t n = begin; n < begin + CHUNK && n < a->points.count; n++)
        measure_point(a, n);
}

cw_status cwi_adaptive_measure(cwi_adaptive *a, cw_error *err)
{
    const size_t count = a->points.count - a->measured;
    float *values = cwi_realloc_array(a->values, a->points.count, sizeof *values);
    a->values = values ? values : a->values;
    double(*positions)[3] = cwi_realloc_array(a->positions, a->points.count, sizeof *positions);
    a->positions = positions ? positions : a->positions;
    if (!values || !positions)
        return cwi_fail_memory(err);
    const cw_status st =
        cwi_parallel_for((count + CHUNK - 1) / CHUNK, CHUNK * CHUNK, a->desc->threads,
                         &a->desc->progress, "finer samples", measure_chunk, a, err);
    a->measured = a->points.count;
    return st;
}

/* ---- cells ------------------------------------------------------------------------------- */

/* Divides a cell. Cells that touch a divided one are as large as it, or smaller. Cells of the
 * next larger size are divided first, and so on: the recursion is as deep as there are
 * sizes. */
bool cwi_adaptive_put(cwi_adaptive *a, int size, const uint32_t at[3])
{
    const size_t before = a->divided[size].count;
    if (cwi_lattice_add(&a->divided[size], cwi_lattice_key(at)) == CWI_NO_LATTICE_POINT)
        return false;
    bool ok = true;
    if (a->divided[size].count == before || size == 0)
        return true;
    for (int n = 0; n < 27 && ok; n++) {
        const uint32_t whole[3] = {(at[0] + (uint32_t)(n % 3) - 1) / 2,
                                   (at[1] + (uint32_t)(n / 3 % 3) - 1) / 2,
                                   (at[2] + (uint32_t)(n / 9) - 1) / 2};
        ok = cwi_adaptive_put(a, size - 1, whole);
    }
    return ok;
}

double cwi_adaptive_min(const cwi_adaptive *a)
{
    int size = 0;
    while (size < CWI_DIVISIONS && a->divided[size].count)
        size++;
    return ldexp(a->voxel, -size);
}

/* ---- all of it --------------------------------------------------------------------------- */

static void find_normals(cwi_adaptive *a)
{
    const cw_mesh *m = a->mesh;
    for (size_t t = 0; t < m->triangle_count; t++)
        cwi_mesh_normal(m, t, a->normals[t]);
}

cw_status cwi_adaptive_init(cwi_adaptive *a, const cw_mesh *mesh, const cw_volume *volume,
                            const cw_offset_desc *desc, cw_error *err)
{
    *a = (cwi_adaptive){
        .mesh = mesh, .volume = volume, .desc = desc, .voxel = volume->affine[0][0]};
    for (int k = 0; k < 3; k++)
        a->corner[k] = volume->affine[k][3] - mesh->origin[k];
    cw_status st = cwi_closest_build(mesh, &a->tree, err);
    a->normals = cwi_alloc_array(mesh->triangle_count, sizeof *a->normals);
    if (st == CW_OK && (!a->normals || !cwi_level_set_leaves(volume, &a->leaves)))
        st = cwi_fail_memory(err);
    if (st == CW_OK)
        find_normals(a);
    return st;
}

void cwi_adaptive_free(cwi_adaptive *a)
{
    cwi_boxes_free(&a->tree);
    cwi_free(a->normals);
    cwi_lattice_free(&a->leaves);
    cwi_lattice_free(&a->points);
    for (int n = 0; n <= CWI_DIVISIONS; n++)
        cwi_lattice_free(&a->divided[n]);
    cwi_free(a->positions);
    cwi_free(a->values);
    *a = (cwi_adaptive){0};
}
