/* Samples label maps of cells and of spheres around points that are spread over a lattice. */
#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/synthetic/random_fill.h"

#include <cubewright/field.h>

#include <math.h>
#include <stdint.h>

enum { DEFAULT_DIM = 64, DEFAULT_LABELS = 100 };

/* Half the side of the cube in a lattice cell that holds its point, in cells. The nearest point
 * is then in the cells beside: the own one is within sqrt(3) (0.5 + JITTER) = 1.22, those two
 * cells away are not within 1.5 - JITTER = 1.3. */
static const double JITTER = 0.2;

/* Radii of spheres, in lattice cells. Two of the largest touch where their points are near. */
static const double MIN_RADIUS = 0.2, MAX_RADIUS = 0.4;

/* The part of the volume that the ball of cells takes. */
static const double BALL = 0.95;

typedef struct sampling {
    const cw_label_field_desc *desc;
    const cw_volume *volume;
    size_t side;         /* of the lattice, in cells */
    double (*points)[4]; /* of all cells: position in cells, and radius */
} sampling;

/* Finds the nearest point of the cells around a position, and its distance squared. */
static size_t find_nearest(const sampling *s, const double position[3], double *distance_sq)
{
    size_t low[3], high[3], nearest = 0;
    *distance_sq = INFINITY;
    for (int a = 0; a < 3; a++) {
        const size_t cell = (size_t)position[a];
        low[a] = cell > 0 ? cell - 1 : 0;
        high[a] = cell + 1 < s->side ? cell + 1 : s->side - 1;
    }
    for (size_t z = low[2]; z <= high[2]; z++)
        for (size_t y = low[1]; y <= high[1]; y++)
            for (size_t x = low[0]; x <= high[0]; x++) {
                const size_t n = (z * s->side + y) * s->side + x;
                const double dx = s->points[n][0] - position[0],
                             dy = s->points[n][1] - position[1],
                             dz = s->points[n][2] - position[2];
                const double d = dx * dx + dy * dy + dz * dz;
                if (d < *distance_sq) {
                    *distance_sq = d;
                    nearest = n;
                }
            }
    return nearest;
}

static uint32_t label_at(const sampling *s, const double position[3])
{
    const double middle = 0.5 * (double)s->side;
    double distance_sq, from_middle = 0;
    const size_t n = find_nearest(s, position, &distance_sq);
    for (int a = 0; a < 3; a++)
        from_middle += (position[a] - middle) * (position[a] - middle);
    const bool is_inside = s->desc->field == CW_LABEL_CELLS
                               ? from_middle < BALL * BALL * middle * middle
                               : distance_sq < s->points[n][3] * s->points[n][3];
    return is_inside && n < s->desc->labels ? (uint32_t)n + 1 : 0;
}

static void store_label(cw_type type, void *voxels, size_t n, uint32_t label)
{
    switch (type) {
#define CASE(name, ctype, text)                                                                \
    case name:                                                                                 \
        ((ctype *)voxels)[n] = (ctype)label;                                                   \
        break;
        CW_TYPE_TABLE(CASE)
#undef CASE
    default:
        break;
    }
}

static void sample_layer(void *context, size_t k)
{
    const sampling *s = context;
    const cw_volume *v = s->volume;
    for (size_t j = 0; j < v->dim[1]; j++)
        for (size_t i = 0; i < v->dim[0]; i++) {
            const size_t index[3] = {i, j, k};
            double position[3];
            for (int a = 0; a < 3; a++)
                position[a] = (double)s->side * ((double)index[a] + 0.5) / (double)v->dim[a];
            store_label(v->type, v->owned, (k * v->dim[1] + j) * v->dim[0] + i,
                        label_at(s, position));
        }
}

/* Places the points of all cells of the lattice. */
static void place_points(sampling *s)
{
    const size_t side = s->side;
    const uint64_t seed = s->desc->seed;
    for (size_t n = 0; n < side * side * side; n++) {
        const size_t cell[3] = {n % side, n / side % side, n / side / side};
        for (size_t a = 0; a < 3; a++)
            s->points[n][a] =
                (double)cell[a] + 0.5 + JITTER * (2 * cwi_chance(seed, 4 * n + a) - 1);
        s->points[n][3] = MIN_RADIUS + (MAX_RADIUS - MIN_RADIUS) * cwi_chance(seed, 4 * n + 3);
    }
}

/* Returns the largest whole number up to which a type holds all. */
static double max_label(cw_type type)
{
    static const double max[] = {
        [CW_U8] = UINT8_MAX,  [CW_I8] = INT8_MAX,    [CW_U16] = UINT16_MAX,
        [CW_I16] = INT16_MAX, [CW_U32] = UINT32_MAX, [CW_I32] = INT32_MAX,
        [CW_F32] = 1 << 24,   [CW_F64] = UINT32_MAX};
    return max[type];
}

cw_status cw_label_field_sample(const cw_label_field_desc *desc, cw_volume *volume,
                                cw_error *err)
{
    CWI_REQUIRE(err, desc, volume);
    CWI_REQUIRE_VERSION(err, desc, 0);
    cw_label_field_desc d = *desc;
    sampling s = {.desc = &d, .volume = volume, .side = 1};
    if (d.field != CW_LABEL_CELLS && d.field != CW_LABEL_SPHERES)
        return cwi_fail(err, CW_ERR_ARGUMENT, "%d is no form of labels", (int)d.field);
    d.labels = d.labels ? d.labels : DEFAULT_LABELS;
    for (int a = 0; a < 3; a++)
        d.dim[a] = d.dim[a] ? d.dim[a] : DEFAULT_DIM;
    cw_status st = cw_volume_alloc(volume, d.type, d.dim, 1, 1, err);
    if (st == CW_OK && (double)d.labels > max_label(d.type))
        st =
            cwi_fail(err, CW_ERR_ARGUMENT, "%zu labels are more than a voxel of %s holds, %.0f",
                     d.labels, cw_type_name(d.type), max_label(d.type));
    while (st == CW_OK && s.side * s.side * s.side < d.labels)
        s.side++;
    if (st == CW_OK) {
        s.points = cwi_alloc_array(s.side * s.side * s.side, sizeof *s.points);
        st = s.points ? CW_OK : cwi_fail_memory(err);
    }
    if (st == CW_OK) {
        place_points(&s);
        for (int a = 0; a < 3; a++)
            volume->affine[a][3] = -0.5 * (double)(d.dim[a] - 1);
        volume->known = CW_KNOWN_UNIT | CW_KNOWN_FRAME;
        st = cwi_parallel_for(d.dim[2], d.dim[0] * d.dim[1], d.threads, &d.progress, "sampling",
                              sample_layer, &s, err);
    }
    cwi_free(s.points);
    if (st != CW_OK)
        cw_volume_free(volume);
    return st;
}
