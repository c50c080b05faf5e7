/* Adds a lattice to a level set: walls of a given thickness along triply periodic minimal surfaces,
 * by exact distances from them. */
#include "extract/level_set/infill.h"

#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/geometry/vec3.h"
#include "core/volume/volume.h"

#include <math.h>
#include <string.h>

/* The largest gradient of all three functions, in radians. */
static const double STEEPEST = 1.7320508075688772;

/* Steps to the nearest point, and Newton's steps to the surface for each. */
enum { FOOT_STEPS = 12, NEWTON_STEPS = 8 };

/* A step to the nearest point that moves it less than this ends the search, radians. The distance
 * changes by the square of it. */
static const double SHORT_STEP = 1e-4;

/* By kind: its name; thickest wall of a cell that leaves both channels open; area of the surface in
 * a cell. Channels close at 0.42, 0.48 and 0.32 cells; a quarter or more of that is left open. */
static const struct {
    const char *name;
    double thickest, area;
} kinds[CW_INFILL_COUNT] = {
    {"gyroid", 1.0 / 3, 3.1}, {"schwarz-p", 1.0 / 3, 2.35}, {"diamond", 0.24, 3.84}};

const char *cw_infill_name(cw_infill_kind kind)
{
    return (unsigned)kind < CW_INFILL_COUNT ? kinds[kind].name : NULL;
}

/* --- the surfaces ------------------------------------------------------------------------- */

/* Evaluates the nodal approximation of a minimal surface, and its gradient, at a point in radians.
 * The surface is at 0. */
static double evaluate(cw_infill_kind kind, const double u[3], double g[3])
{
    double s[3], c[3];
    for (int a = 0; a < 3; a++) {
        s[a] = sin(u[a]);
        c[a] = cos(u[a]);
    }
    if (kind == CW_INFILL_SCHWARZ_P) {
        for (int a = 0; a < 3; a++)
            g[a] = -s[a];
        return c[0] + c[1] + c[2];
    }
    if (kind == CW_INFILL_DIAMOND) {
        /* the sine of the sum of the angles, and twice the product of their sines */
        const double cosine =
            c[0] * c[1] * c[2] - c[0] * s[1] * s[2] - s[0] * c[1] * s[2] - s[0] * s[1] * c[2];
        for (int a = 0; a < 3; a++)
            g[a] = cosine + 2 * c[a] * s[(a + 1) % 3] * s[(a + 2) % 3];
        return s[0] * s[1] * s[2] + s[0] * c[1] * c[2] + c[0] * s[1] * c[2] +
               c[0] * c[1] * s[2];
    }
    for (int a = 0; a < 3; a++) {
        const int next = (a + 1) % 3, last = (a + 2) % 3;
        g[a] = c[a] * c[next] - s[last] * s[a];
    }
    return s[0] * c[1] + s[1] * c[2] + s[2] * c[0];
}

/* Moves a point along the gradient to the surface, and leaves the gradient there. Returns false where
 * it does not get there. */
static bool walk_to_surface(cw_infill_kind kind, double u[3], double g[3])
{
    static const double LONGEST = 0.7; /* of a step, radians: no step skips a channel */
    double length = INFINITY;
    for (int n = 0; n < NEWTON_STEPS && length > 1e-9; n++) {
        const double value = evaluate(kind, u, g), gradient_sq = cwi_dot(g, g);
        if (!(gradient_sq > 1e-12))
            return false;
        length = fabs(value) / sqrt(gradient_sq);
        cwi_add_scaled(u, -value / gradient_sq * cwi_lesser(1, LONGEST / length), g, u);
    }
    return length < SHORT_STEP;
}

/* Returns the distance from the surface in radians. From a point of the surface it goes to the foot in
 * the tangent plane there, and back to the surface [Hartmann1999]; the nearest point on the way counts. */
static double find_foot(cw_infill_kind kind, const double u[3], double foot[3],
                        double normal[3])
{
    double y[3] = {u[0], u[1], u[2]}, g[3], nearest = INFINITY;
    for (int n = 0; n < FOOT_STEPS && walk_to_surface(kind, y, g); n++) {
        double to[3], flat[3];
        cwi_normalise(g);
        cwi_sub(u, y, to);
        const double length = cwi_length(to);
        if (length < nearest) {
            nearest = length;
            memcpy(foot, y, sizeof y);
            memcpy(normal, g, sizeof g);
        }
        cwi_add_scaled(u, -cwi_dot(to, g), g, flat);
        if (cwi_distance(flat, y) < SHORT_STEP)
            break;
        memcpy(y, flat, sizeof y);
    }
    return nearest;
}

double cwi_infill_distance(const cwi_infill *f, const double world[3], double foot[3],
                           double normal[3])
{
    double u[3];
    for (int a = 0; a < 3; a++)
        u[a] = (world[a] - f->center[a]) * f->per_mm;
    const double distance = find_foot(f->desc->kind, u, foot, normal);
    for (int a = 0; a < 3 && distance < INFINITY; a++)
        foot[a] = f->center[a] + foot[a] / f->per_mm;
    return distance / f->per_mm;
}

/* Returns a lower bound of that distance, which costs much less. */
static double bound_distance(const cwi_infill *f, const double world[3])
{
    double u[3], g[3];
    for (int a = 0; a < 3; a++)
        u[a] = (world[a] - f->center[a]) * f->per_mm;
    return fabs(evaluate(f->desc->kind, u, g)) / STEEPEST / f->per_mm;
}

/* --- parameters --------------------------------------------------------------------------- */

static bool is_graded(const cw_infill_desc *d)
{
    return d->end_wall_mm > 0;
}

double cwi_infill_thinnest(const cw_infill_desc *d)
{
    return is_graded(d) ? fmin(d->wall_mm, d->end_wall_mm) : d->wall_mm;
}

static double find_thickest(const cw_infill_desc *d)
{
    return fmax(d->wall_mm, d->end_wall_mm);
}

cw_status cwi_infill_check(const cw_infill_desc *d, double voxel_mm, cw_error *err)
{
    CWI_REQUIRE_VERSION(err, d, 0);
    if ((unsigned)d->kind >= CW_INFILL_COUNT)
        return cwi_fail(err, CW_ERR_ARGUMENT, "%d is not a kind of lattice (0 to %d)",
                        (int)d->kind, CW_INFILL_COUNT - 1);
    if (!(d->cell_mm > 0 && d->wall_mm > 0 && d->end_wall_mm >= 0 && d->depth_mm >= 0 &&
          isfinite(d->cell_mm) && isfinite(d->wall_mm) && isfinite(d->end_wall_mm) &&
          isfinite(d->depth_mm)))
        return cwi_fail(
            err, CW_ERR_ARGUMENT,
            "a lattice with cells of %g mm, walls of %g to %g mm, a depth of %g mm: "
            "cells and walls above 0 were expected, the others not below",
            d->cell_mm, d->wall_mm, d->end_wall_mm, d->depth_mm);
    if (is_graded(d) != (d->depth_mm > 0 || d->by) || (d->depth_mm > 0 && d->by))
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "a lattice changes from one wall to another by a depth or by a volume: "
                        "both walls and one of these were expected, or one wall and neither");
    const double most = kinds[d->kind].thickest, thickest = find_thickest(d);
    if (thickest > most * d->cell_mm)
        return cwi_fail(
            err, CW_ERR_ARGUMENT,
            "walls of %.4g mm leave no open channels in %s cells of %.4g mm: walls of "
            "at most %.4g mm were expected, or cells of at least %.4g mm",
            thickest, kinds[d->kind].name, d->cell_mm, most * d->cell_mm, thickest / most);
    const double thinnest = cwi_infill_thinnest(d);
    if (voxel_mm * CWI_INFILL_VOXELS > thinnest * (1 + 1e-9))
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "voxels of %g mm are too large for lattice walls of %g mm: at most a "
                        "quarter of that, %g mm",
                        voxel_mm, thinnest, thinnest / CWI_INFILL_VOXELS);
    return CW_OK;
}

cw_status cwi_infill_init(cwi_infill *f, const cw_infill_desc *d, const cw_quality *q,
                          int threads, cw_error *err)
{
    *f = (cwi_infill){.desc = d, .per_mm = 2 * CWI_PI / d->cell_mm};
    f->thinnest = cwi_infill_thinnest(d);
    f->thickest = find_thickest(d);
    for (int a = 0; a < 3; a++)
        f->center[a] = (q->min[a] + q->max[a]) / 2;
    if (!d->by)
        return CW_OK;
    cw_statistics range = {0};
    cw_status st = cw_volume_resolve(d->by, &f->by, err);
    if (st == CW_OK)
        st = cwi_volume_expect_dense(&f->by, "grading a lattice", err);
    if (st == CW_OK)
        st = cw_volume_statistics(&f->by, 0, threads, &range, err);
    f->low = range.min;
    f->high = range.max;
    cw_statistics_free(&range);
    if (st == CW_OK && !(f->high > f->low))
        st = cwi_fail(err, CW_ERR_EMPTY,
                      "the volume that a lattice is graded by has no range of values: all are "
                      "%g",
                      f->low);
    return st;
}

/* Takes 1.3 times the voxels for leaves that are partly inside, twice while tiles become leaves. Both
 * sides of the walls have 2.4 triangles a voxel's square, with 250 bytes each while they are proved free
 * of crossings, and 450 while drains are subtracted. */
double cwi_infill_bytes(const cw_infill_desc *d, const cw_quality *q, double voxel_mm,
                        bool drains)
{
    const double voxels = q->volume_mm3 / (voxel_mm * voxel_mm * voxel_mm),
                 area = q->area_mm2 + 2 * kinds[d->kind].area * q->volume_mm3 / d->cell_mm;
    return 2 * 1.3 * sizeof(float) * voxels +
           (drains ? 450 : 250) * 2.4 * area / (voxel_mm * voxel_mm);
}

double cwi_infill_wall(const cwi_infill *f, const double world[3], double depth_mm)
{
    const cw_infill_desc *d = f->desc;
    double fraction = 0;
    if (d->by)
        fraction = (cw_volume_sample(&f->by, world) - f->low) / (f->high - f->low);
    else if (d->depth_mm > 0)
        fraction = depth_mm / d->depth_mm;
    if (!is_graded(d) || !(fraction > 0)) /* NaN: outside of the volume */
        return d->wall_mm;
    return d->wall_mm + fmin(fraction, 1) * (d->end_wall_mm - d->wall_mm);
}

/* --- the level set ------------------------------------------------------------------------ */

typedef struct filling {
    const cwi_infill *infill;
    double wall_mm, voxel_mm;
    const cw_volume *volume;
    uint32_t (*leaves)[3];
    float *voxels;
} filling;

/* Returns the level set of the channels at a voxel. Values that are no neighbours of the surface need
 * no exact distance.
 * cavity_mm  the level set of the cavity there */
static double value_at(const filling *f, const double world[3], double cavity_mm)
{
    const cwi_infill *infill = f->infill;
    double foot[3], normal[3];
    if (cavity_mm > 2 * f->voxel_mm)
        return cavity_mm;
    const double bound = bound_distance(infill, world);
    if (bound > infill->thickest / 2 + 2 * f->voxel_mm)
        return fmax(cavity_mm, infill->thickest / 2 - bound);
    const double wall = cwi_infill_wall(infill, world, -cavity_mm),
                 distance = cwi_infill_distance(infill, world, foot, normal);
    return fmax(cavity_mm, wall / 2 - fmin(distance, infill->desc->cell_mm));
}

static void fill_leaf(void *context, size_t leaf)
{
    const filling *f = context;
    float *voxels = f->voxels + leaf * CWI_LEAF_VOXELS;
    for (size_t n = 0; n < CWI_LEAF_VOXELS; n++) {
        const size_t in[3] = {n % CWI_LEAF, n / CWI_LEAF % CWI_LEAF, n / (CWI_LEAF * CWI_LEAF)};
        double world[3];
        for (int a = 0; a < 3; a++)
            world[a] = f->volume->affine[a][3] +
                       f->voxel_mm * (double)(CWI_LEAF * (size_t)f->leaves[leaf][a] + in[a]);
        voxels[n] = (float)value_at(f, world, (double)voxels[n] + f->wall_mm);
    }
}

static size_t count_leaves(const cw_sparse *sparse)
{
    size_t count = sparse->leaf_count;
    for (size_t n = 0; n < sparse->tile_count; n++)
        count += (size_t)sparse->tiles[n].size[0] * sparse->tiles[n].size[1] *
                 sparse->tiles[n].size[2];
    return count;
}

/* Turns tiles into leaves: all tiles are inside of the mesh. */
static void split_tiles(const cw_sparse *sparse, uint32_t (*leaves)[3], float *voxels)
{
    size_t count = sparse->leaf_count;
    for (size_t n = 0; n < sparse->tile_count; n++) {
        const cw_tile *t = &sparse->tiles[n];
        for (uint32_t k = 0; k < t->size[2]; k++)
            for (uint32_t j = 0; j < t->size[1]; j++)
                for (uint32_t i = 0; i < t->size[0]; i++, count++) {
                    const uint32_t at[3] = {t->at[0] + i, t->at[1] + j, t->at[2] + k};
                    memcpy(leaves[count], at, sizeof at);
                    for (size_t v = 0; v < CWI_LEAF_VOXELS; v++)
                        voxels[count * CWI_LEAF_VOXELS + v] = (float)t->value;
                }
    }
}

cw_status cwi_infill_apply(const cwi_infill *infill, double wall_mm, int threads,
                           const cw_progress *progress, cw_volume *volume, cw_error *err)
{
    const cw_sparse *old = volume->sparse;
    const size_t count = count_leaves(old);
    char *memory = cwi_alloc_array(sizeof(cw_sparse) + count * 3 * sizeof(uint32_t), 1);
    float *voxels = cwi_alloc_large(count, CWI_LEAF_VOXELS * sizeof *voxels);
    if (!memory || !voxels) {
        cwi_free(memory);
        cwi_free(voxels);
        return cwi_fail_memory(err);
    }
    uint32_t(*leaves)[3] = (uint32_t(*)[3])(void *)(memory + sizeof(cw_sparse));
    memcpy(leaves, old->leaves, old->leaf_count * sizeof *leaves);
    memcpy(voxels, volume->data, old->leaf_count * CWI_LEAF_VOXELS * sizeof *voxels);
    split_tiles(old, leaves, voxels);
    cw_sparse *sparse = (cw_sparse *)(void *)memory;
    *sparse = (cw_sparse){.leaf_count = count,
                          .leaves = (const uint32_t(*)[3])leaves,
                          .background = old->background};
    cwi_free(volume->owned);
    cwi_free(volume->owned_grid);
    volume->data = volume->owned = voxels;
    volume->owned_grid = memory;
    volume->sparse = sparse;
    filling f = {.infill = infill,
                 .wall_mm = wall_mm,
                 .voxel_mm = volume->affine[0][0],
                 .volume = volume,
                 .leaves = leaves,
                 .voxels = voxels};
    return cwi_parallel_for(count, 1 << 16, threads, progress, "lattice", fill_leaf, &f, err);
}
