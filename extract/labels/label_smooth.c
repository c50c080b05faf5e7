/* Smooths the interfaces of a label map: rounds of averages with the cubes beside, in a box around
 * each vertex [Gibson1998]. */
#include "extract/labels/label_smooth.h"

#include "extract/labels/label_pressures.h"

#include "core/base/parallel.h"
#include "core/base/status.h"

#include <math.h>
#include <string.h>

/* After some pairs of rounds labels get their volumes: if they shrank on and on, more vertices would
 * meet the bounds of their moves, and those that do not would make steps beside them. */
enum { ROUND_PAIRS = 6, PAIRS_BETWEEN = 2, PART = 1 << 14 };

/* The fraction of the way to the neighbours' mean in the first and the second round of a pair. The first
 * takes broad steps out, the second what changes from vertex to vertex. Six pairs smooth as much as 19
 * rounds of a half. */
static const float MEAN_WEIGHTS[2] = {1, 0.6f};

typedef float lanes __attribute__((vector_size(16)));
typedef int32_t mask __attribute__((vector_size(16)));

typedef struct averager {
    const cwi_label_net *net;
    const float *originals;
    float bound;
    const cw_labels_desc *desc;
    const size_t *dim;
    size_t count;                   /* of vertices */
    float weight;                   /* of the neighbours' mean in this round */
    cwi_label_pressures *pressures; /* NULL: volumes are not kept */
    /* (count + CWI_SPARE_POSITIONS) x 3. The one behind the last is 0: it replaces missing
     * neighbours */
    float *from, *to;
} averager;

static lanes select_lanes(mask where, lanes yes, lanes no)
{
    return (lanes)(((mask)yes & where) | ((mask)no & ~where));
}

/* Loads a position; the fourth number is the next position's first. */
static lanes load_position(const float *positions, size_t v)
{
    lanes position;
    memcpy(&position, positions + 3 * v, sizeof position);
    return position;
}

/* Returns the neighbour with which a vertex is averaged, or the last position, which is 0. A vertex
 * on a curve where labels meet has those on the curve; one that stays has none. */
static uint32_t choose_neighbour(const averager *s, size_t v, int n)
{
    const uint8_t kind = s->net->kinds[v];
    const uint32_t neighbour = s->net->neighbours[v][n];
    const bool is_none =
        neighbour == UINT32_MAX || (kind && !(kind >> n & 1)) || (kind & CWI_NET_FIXED);
    return is_none ? (uint32_t)s->count : neighbour;
}

/* Chooses the neighbours of a part's vertices. */
static void choose_part(void *context, size_t n)
{
    const averager *s = context;
    for (size_t v = n * PART; v < (n + 1) * PART && v < s->count; v++)
        for (int i = 0; i < 6; i++)
            s->net->neighbours[v][i] = choose_neighbour(s, v, i);
}

/* Averages a vertex with its neighbours, in the box around its first position. */
static lanes average_vertex(const averager *s, size_t v)
{
    const uint32_t *neighbours = s->net->neighbours[v];
    const lanes here = load_position(s->from, v), original = load_position(s->originals, v);
    const lanes low = original - s->bound, high = original + s->bound;
    lanes sum = {0};
    int count = 0;
    for (int n = 0; n < 6; n++) {
        sum += load_position(s->from, neighbours[n]);
        count += neighbours[n] != (uint32_t)s->count;
    }
    if (count < 2)
        return here;
    lanes to = here + s->weight * (sum / (float)count - here);
    to = select_lanes(to < low, low, to);
    to = select_lanes(to > high, high, to);
    /* The surface that closes a label at the volume's border stays in its plane, and an open border
     * stays where it is. */
    const lanes last = {(float)s->dim[0] - 1, (float)s->dim[1] - 1, (float)s->dim[2] - 1,
                        INFINITY};
    return select_lanes((original < 0) | (original > last), original, to);
}

static void average_part(void *context, size_t n)
{
    const averager *s = context;
    for (size_t v = n * PART; v < (n + 1) * PART && v < s->count; v++) {
        const lanes position = average_vertex(s, v);
        memcpy(s->to + 3 * v, &position, 3 * sizeof *s->to);
    }
}

static cw_status run_parts(averager *s, void (*work)(void *, size_t), cw_error *err)
{
    return cwi_parallel_for((s->count + PART - 1) / PART, 8 * PART, s->desc->threads,
                            &s->desc->progress, "smoothing", work, s, err);
}

/* Averages in rounds; after an even number positions are where they were. */
static cw_status average_all(averager *s, cw_error *err)
{
    const size_t spare = 3 * CWI_SPARE_POSITIONS * sizeof *s->from;
    memset(s->from + 3 * s->count, 0, spare);
    memset(s->to + 3 * s->count, 0, spare);
    cw_status st = run_parts(s, choose_part, err);
    for (int round = 0; round < 2 * ROUND_PAIRS && st == CW_OK; round++) {
        if (s->pressures && round > 0 && round % (2 * PAIRS_BETWEEN) == 0)
            st = cwi_label_pressures_set(s->pressures, s->desc, err);
        if (st != CW_OK)
            break;
        float *before = s->from;
        s->weight = MEAN_WEIGHTS[round % 2];
        st = run_parts(s, average_part, err);
        s->from = s->to;
        s->to = before;
    }
    return st;
}

cw_status cwi_labels_smooth(void *context, cwi_label_net *net, const float *originals,
                            float *spare, cw_label_surfaces *surfaces,
                            const cw_labels_desc *desc, const size_t dim[3], cw_error *err)
{
    averager s = {.net = net,
                  .originals = originals,
                  .bound = (float)desc->max_move,
                  .desc = desc,
                  .dim = dim,
                  .count = surfaces->mesh.vertex_count,
                  .from = surfaces->mesh.positions,
                  .to = spare,
                  .pressures = context};
    return average_all(&s, err);
}
