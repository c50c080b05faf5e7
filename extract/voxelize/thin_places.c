/* Finds where a mesh is thinner than a voxel: points of its surface around which all voxels are on one side. */
#include "extract/voxelize/voxelize_state.h"

#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/geometry/affine.h"
#include "core/geometry/union_find.h"
#include "core/geometry/vec3.h"
#include "core/volume/volume.h"

#include <math.h>
#include <string.h>

enum { CHUNK = 1 << 12 };

typedef struct search {
    const cwi_voxelize *v;
    size_t mesh;
    float *thin, *outside; /* fractions of each triangle */
} search;

/* The sides on which voxels are: bits. Voxels of other meshes count as both. */
enum { IS_OUT = 1, IS_IN = 2 };

static unsigned side_at(const cwi_voxelize *v, size_t mesh, int64_t i, int64_t j, int64_t k)
{
    const size_t *dim = v->volume->dim;
    if (i < 0 || j < 0 || k < 0 || (size_t)i >= dim[0] || (size_t)j >= dim[1] ||
        (size_t)k >= dim[2])
        return IS_OUT;
    const size_t at = ((size_t)k * dim[1] + (size_t)j) * dim[0] + (size_t)i;
    switch (v->volume->type) {
    case CW_F32:
        return ((const float *)v->volume->data)[at] >= 0.5f ? IS_IN : IS_OUT;
    case CW_U8:
    case CW_U16:
    case CW_U32: {
        const size_t size = cw_type_size(v->volume->type);
        const double value =
            cwi_voxel_at(v->volume->type, (const char *)v->volume->data + at * size);
        return value == 0 ? IS_OUT : value == (double)v->label[mesh] ? IS_IN : IS_OUT | IS_IN;
    }
    default:
        return IS_OUT | IS_IN;
    }
}

/* Returns true if the voxels in a box around a point are on both sides, or inside of another mesh, which
 * fractions do not tell apart. reach: voxels beyond the eight around it */
static bool sees_border(const cwi_voxelize *v, size_t mesh, const double p[3], int reach)
{
    const int64_t low[3] = {(int64_t)floor(p[0]) - reach, (int64_t)floor(p[1]) - reach,
                            (int64_t)floor(p[2]) - reach};
    const int side = 2 + 2 * reach;
    unsigned sides = 0;
    for (int k = 0; k < side; k++)
        for (int j = 0; j < side; j++)
            for (int i = 0; i < side; i++) {
                sides |= side_at(v, mesh, low[0] + i, low[1] + j, low[2] + k);
                if (sides == (IS_OUT | IS_IN))
                    return true;
            }
    return sides == IS_IN && v->desc->partial && v->count > 1;
}

static bool is_outside(const cwi_voxelize *v, const double p[3])
{
    for (int a = 0; a < 3; a++)
        if (!(p[a] >= -0.5 && p[a] <= (double)v->volume->dim[a] - 0.5))
            return true;
    return false;
}

/* Samples the middles of the n x n equal parts of a triangle, about two voxels apart. */
static void sample_triangle(search *s, size_t triangle, size_t slot)
{
    enum { MAX_PARTS = 64 };
    const double *c[3];
    double longest = 0;
    size_t thin = 0, outside = 0;
    cwi_voxelize_corners(s->v, triangle, s->mesh, c);
    for (int k = 0; k < 3; k++)
        longest = fmax(longest, cwi_distance(c[k], c[(k + 1) % 3]));
    const int n = (int)fmin(fmax(ceil(longest / 2), 1), MAX_PARTS);
    for (int i = 0; i < n; i++)
        for (int j = 0; j < 2 * (n - i) - 1; j++) {
            /* even parts point like the triangle, odd ones against it */
            const double u = (i + (j % 2 ? 2 : 1) / 3.0) / n,
                         w = (j / 2 + (j % 2 ? 2 : 1) / 3.0) / n;
            double p[3];
            for (int a = 0; a < 3; a++)
                p[a] = c[0][a] + u * (c[1][a] - c[0][a]) + w * (c[2][a] - c[0][a]);
            if (is_outside(s->v, p))
                outside++;
            else if (!sees_border(s->v, s->mesh, p, 0) && !sees_border(s->v, s->mesh, p, 1))
                thin++;
        }
    s->thin[slot] = (float)thin / (float)(n * n);
    s->outside[slot] = (float)outside / (float)(n * n);
}

static void sample_chunk(void *context, size_t chunk)
{
    search *s = context;
    const size_t first = s->v->first_triangle[s->mesh],
                 count = s->v->first_triangle[s->mesh + 1] - first, begin = chunk * CHUNK,
                 end = begin + CHUNK < count ? begin + CHUNK : count;
    for (size_t t = begin; t < end; t++)
        sample_triangle(s, first + t, t);
}

static void sum_areas(const search *s, cw_voxelize_part *part)
{
    const cw_mesh *mesh = s->v->meshes[s->mesh];
    for (size_t t = 0; t < mesh->triangle_count; t++) {
        const uint32_t *c = mesh->triangles + 3 * t;
        double a[3], b[3], cross[3];
        cwi_sub_points(mesh->positions + 3 * (size_t)c[1], mesh->positions + 3 * (size_t)c[0],
                       a);
        cwi_sub_points(mesh->positions + 3 * (size_t)c[2], mesh->positions + 3 * (size_t)c[0],
                       b);
        cwi_cross(a, b, cross);
        const double area = 0.5 * cwi_length(cross);
        part->area_mm2 += area;
        part->thin_mm2 += area * (double)s->thin[t];
        part->outside_mm2 += area * (double)s->outside[t];
    }
}

/* Counts sets of triangles joined by vertices: those with a thin part, or all. */
static void join_sets(const search *s, uint32_t *sets, bool thin)
{
    const cw_mesh *mesh = s->v->meshes[s->mesh];
    for (size_t n = 0; n < mesh->vertex_count; n++)
        sets[n] = (uint32_t)n;
    for (size_t t = 0; t < mesh->triangle_count; t++) {
        const uint32_t *c = mesh->triangles + 3 * t;
        if (thin && !(s->thin[t] > 0))
            continue;
        cwi_sets_join(sets, c[0], c[1]);
        cwi_sets_join(sets, c[0], c[2]);
    }
}

enum { IS_SEEN = 1, HAS_VOXELS = 2 };

static void count_sets(const search *s, uint32_t *sets, uint8_t *marks, cw_voxelize_part *part)
{
    const cw_mesh *mesh = s->v->meshes[s->mesh];
    join_sets(s, sets, true);
    for (size_t t = 0; t < mesh->triangle_count; t++) {
        uint8_t *mark = &marks[cwi_sets_find(sets, mesh->triangles[3 * t])];
        part->thin_places += s->thin[t] > 0 && !*mark;
        *mark |= s->thin[t] > 0;
    }
    memset(marks, 0, mesh->vertex_count);
    join_sets(s, sets, false);
    for (size_t t = 0; t < mesh->triangle_count; t++)
        marks[cwi_sets_find(sets, mesh->triangles[3 * t])] |=
            (uint8_t)(s->thin[t] < 1 ? IS_SEEN | HAS_VOXELS : IS_SEEN);
    for (size_t n = 0; n < mesh->vertex_count; n++) {
        part->solids += (marks[n] & IS_SEEN) != 0;
        part->lost += marks[n] == IS_SEEN;
    }
}

cw_status cwi_find_thin_places(const cwi_voxelize *v, size_t mesh, cw_voxelize_part *part,
                               cw_error *err)
{
    const cw_mesh *m = v->meshes[mesh];
    search s = {.v = v,
                .mesh = mesh,
                .thin = cwi_alloc_zeroed(m->triangle_count, sizeof *s.thin),
                .outside = cwi_alloc_zeroed(m->triangle_count, sizeof *s.outside)};
    uint32_t *sets = cwi_sets_alloc(m->vertex_count);
    uint8_t *marks = cwi_alloc_zeroed(m->vertex_count, 1);
    const bool ok = s.thin && s.outside && sets && marks;
    if (ok) {
        cwi_parallel_for_all((m->triangle_count + CHUNK - 1) / CHUNK, CHUNK, v->desc->threads,
                             sample_chunk, &s);
        sum_areas(&s, part);
        count_sets(&s, sets, marks, part);
    }
    cwi_free(s.thin);
    cwi_free(s.outside);
    cwi_free(sets);
    cwi_free(marks);
    return ok ? CW_OK : cwi_fail_memory(err);
}
