/* Builds a tree of boxes with eight children per node, sorted along a Hilbert curve, and visits
 * overlaps. */
#include "core/geometry/bvh.h"

#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/geometry/vec3.h"

#include <float.h>
#include <stdlib.h>
#include <string.h>

typedef struct keyed {
    uint64_t key;
    uint32_t item;
} keyed;

/* Bits of a key: of each coordinate, those below the bucket, and of a digit of those. */
enum { KEY_BITS = 16, BUCKET_BITS = 8, LOW_BITS = 3 * KEY_BITS - BUCKET_BITS, DIGIT_BITS = 10 };
enum { BUCKETS = 1 << BUCKET_BITS, DIGITS = 1 << DIGIT_BITS, PASSES = LOW_BITS / DIGIT_BITS };
_Static_assert(
    PASSES *DIGIT_BITS == LOW_BITS && PASSES % 2 == 0,
    "digits are all of the lower bits, and the last pass ends where the first began");

/* Boxes that one thread handles at a time. */
enum { CHUNK = 1 << 16 };

static unsigned rotate_left(unsigned octant, unsigned by)
{
    return (octant << by | octant >> (3 - by)) & 7;
}

static unsigned gray_code(unsigned rank)
{
    return rank ^ rank >> 1;
}

static unsigned gray_rank(unsigned code)
{
    return code ^ code >> 1 ^ code >> 2;
}

/* Returns the corner of an octant's own cube where the curve begins, if the octant comes at a
 * rank. */
static unsigned entry_corner(unsigned rank)
{
    return rank ? gray_code((rank - 1) & ~1u) : 0;
}

/* Returns the axis along which the curve in an octant leads from its begin to its end. */
static unsigned exit_axis(unsigned rank)
{
    const unsigned next = rank & 1 ? rank : rank ? rank - 1 : 0;
    return next & 1 ? (next & 2 ? (next & 4 ? 0 : 2) : 1) : 0;
}

/* Hilbert's curve visits the octants of a cube in the order of a Gray code. In each octant the
 * curve is the same, but mirrored (entry, 0 to 7) and turned (axis, 0 to 2), so that it begins
 * beside the end of the one before [Hamilton2006]. A cube is known by 8 axis + entry. */
typedef struct octant_step {
    uint8_t rank, cube; /* the octant's rank, and how it is mirrored and turned */
} octant_step;

static octant_step find_octant(unsigned cube, unsigned octant)
{
    const unsigned entry = cube % 8, axis = cube / 8, turn = (axis + 1) % 3;
    const unsigned rank = gray_rank(rotate_left(octant ^ entry, (3 - turn) % 3));
    const unsigned inner = entry ^ rotate_left(entry_corner(rank), turn);
    return (octant_step){(uint8_t)rank, (uint8_t)(8 * ((turn + exit_axis(rank)) % 3) + inner)};
}

/* Two steps at a time, by cube and by two bits of x, of y and of z. */
typedef struct hilbert {
    octant_step steps[24][64];
} hilbert;

static void make_curve(hilbert *h)
{
    for (unsigned cube = 0; cube < 24; cube++)
        for (unsigned bits = 0; bits < 64; bits++) {
            const octant_step outer = find_octant(cube, (bits >> 1 & 1) | (bits >> 2 & 2) |
                                                            (bits >> 3 & 4)),
                              inner = find_octant(outer.cube, (bits & 1) | (bits >> 1 & 2) |
                                                                  (bits >> 2 & 4));
            h->steps[cube][bits] =
                (octant_step){(uint8_t)(outer.rank << 3 | inner.rank), inner.cube};
        }
}

static uint64_t find_rank(const hilbert *h, const uint32_t cell[3])
{
    unsigned cube = 0;
    uint64_t rank = 0;
    for (int bit = KEY_BITS - 2; bit >= 0; bit -= 2) {
        const unsigned bits =
            (cell[0] >> bit & 3) | (cell[1] >> bit & 3) << 2 | (cell[2] >> bit & 3) << 4;
        const octant_step step = h->steps[cube][bits];
        rank = rank << 6 | step.rank;
        cube = step.cube;
    }
    return rank;
}

/* Returns twice the middle of a box along an axis; of a box that is endless, of its part within all numbers. */
static double find_middle(const float box[6], int a)
{
    const float low = box[a] > -FLT_MAX ? box[a] : -FLT_MAX,
                high = box[a + 3] < FLT_MAX ? box[a + 3] : FLT_MAX;
    return (double)low + (double)high;
}

/* Boxes on their way into a tree; threads take chunks of them. */
typedef struct building {
    cwi_boxes *tree;
    const float (*boxes)[6];
    size_t count, chunks;
    int threads;
    hilbert curve;
    double low[3], scale; /* of the cube of 2^16 cells an edge */
    keyed *keys, *sorted;
    uint32_t (*starts)[BUCKETS]; /* chunks: where its keys of each bucket go */
} building;

static size_t chunk_end(const building *b, size_t k)
{
    return k + 1 < b->chunks ? (k + 1) * CHUNK : b->count;
}

static unsigned get_bucket(const keyed *k)
{
    return (unsigned)(k->key >> LOW_BITS);
}

/* Sets the keys of a chunk: the ranks of the boxes' middles on the curve. Counts its buckets. */
static void set_keys(void *context, size_t k)
{
    building *b = context;
    memset(b->starts[k], 0, sizeof b->starts[k]);
    for (size_t n = k * CHUNK; n < chunk_end(b, k); n++) {
        uint32_t cell[3];
        for (int a = 0; a < 3; a++)
            cell[a] = (uint32_t)((find_middle(b->boxes[n], a) - b->low[a]) * b->scale);
        b->keys[n] = (keyed){find_rank(&b->curve, cell), (uint32_t)n};
        b->starts[k][get_bucket(&b->keys[n])]++;
    }
}

static void find_cube(building *b)
{
    double high = 0;
    for (int a = 0; a < 3; a++)
        b->low[a] = INFINITY;
    for (size_t n = 0; n < b->count; n++)
        for (int a = 0; a < 3; a++)
            b->low[a] = cwi_lesser(b->low[a], find_middle(b->boxes[n], a));
    for (size_t n = 0; n < b->count; n++)
        for (int a = 0; a < 3; a++)
            high = cwi_greater(high, find_middle(b->boxes[n], a) - b->low[a]);
    b->scale = high > 0 ? ((1 << KEY_BITS) - 1) / high : 0;
}

/* --- sorting ------------------------------------------------------------------------------ */

/* Turns the counts of each chunk into the places where its keys go. */
static void find_places(building *b)
{
    uint32_t sum = 0;
    for (size_t bucket = 0; bucket < BUCKETS; bucket++)
        for (size_t k = 0; k < b->chunks; k++) {
            const uint32_t here = b->starts[k][bucket];
            b->starts[k][bucket] = sum;
            sum += here;
        }
}

static void deal_out_keys(void *context, size_t k)
{
    building *b = context;
    for (size_t n = k * CHUNK; n < chunk_end(b, k); n++)
        b->sorted[b->starts[k][get_bucket(&b->keys[n])]++] = b->keys[n];
}

static int compare_keyed(const void *x, const void *y)
{
    const keyed *a = x, *b = y;
    return a->key != b->key ? (a->key > b->key) - (a->key < b->key)
                            : (a->item > b->item) - (a->item < b->item);
}

static unsigned get_digit(const keyed *k, int pass)
{
    return (unsigned)(k->key >> pass * DIGIT_BITS) & (DIGITS - 1);
}

/* Sorts keys by their lower bits, a digit at a time; the order of equal keys is kept.
 * other  as many */
static void radix_sort(keyed *keys, keyed *other, size_t count)
{
    uint32_t starts[PASSES][DIGITS] = {{0}};
    for (size_t n = 0; n < count; n++)
        for (int pass = 0; pass < PASSES; pass++)
            starts[pass][get_digit(&keys[n], pass)]++;
    for (int pass = 0; pass < PASSES; pass++) {
        for (uint32_t d = 0, sum = 0; d < DIGITS; d++) {
            const uint32_t here = starts[pass][d];
            starts[pass][d] = sum;
            sum += here;
        }
        for (size_t n = 0; n < count; n++)
            other[starts[pass][get_digit(&keys[n], pass)]++] = keys[n];
        keyed *sorted = other;
        other = keys;
        keys = sorted;
    }
}

/* Sorts a bucket, and writes its items. Few keys are compared with each other, as digits would outnumber
 * them; the order is the same. */
static void sort_bucket(void *context, size_t bucket)
{
    building *b = context;
    enum { FEW = 1 << 8 };
    const uint32_t *ends =
        b->starts[b->chunks - 1]; /* the last chunk's keys are the last ones */
    const size_t first = bucket ? ends[bucket - 1] : 0, count = ends[bucket] - first;
    if (count > FEW)
        radix_sort(b->sorted + first, b->keys + first, count);
    else
        qsort(b->sorted + first, count, sizeof *b->sorted, compare_keyed);
    for (size_t n = first; n < first + count; n++)
        b->tree->order[n] = b->sorted[n].item;
}

/* --- levels ------------------------------------------------------------------------------- */

void cwi_boxes_around(const cwi_boxes_node *n, float box[6])
{
    for (int a = 0; a < 3; a++) {
        box[a] = n->low[a][0];
        box[a + 3] = n->high[a][0];
        for (int c = 1; c < CWI_WIDTH; c++) {
            box[a] = n->low[a][c] < box[a] ? n->low[a][c] : box[a];
            box[a + 3] = n->high[a][c] > box[a + 3] ? n->high[a][c] : box[a + 3];
        }
    }
}

/* Fills nodes of a level with its children from `first` to `end`, and the last one with empty boxes. */
static void fill_nodes(const building *b, int level, size_t first, size_t end)
{
    const float empty[6] = {INFINITY, INFINITY, INFINITY, -INFINITY, -INFINITY, -INFINITY};
    cwi_boxes *t = b->tree;
    cwi_boxes_node *nodes = t->nodes + t->first[level];
    float box[6];
    size_t c = first;
    for (; c < end; c++)
        if (level == 0) {
            cwi_boxes_put(nodes, c, b->boxes[t->order[c]]);
        } else {
            cwi_boxes_around(t->nodes + t->first[level - 1] + c, box);
            cwi_boxes_put(nodes, c, box);
        }
    for (; c % CWI_WIDTH; c++)
        cwi_boxes_put(nodes, c, empty);
}

static void fill_items(void *context, size_t k)
{
    fill_nodes(context, 0, k * CHUNK, chunk_end(context, k));
}

static void fill_levels(building *b)
{
    cwi_boxes *t = b->tree;
    size_t children = t->count;
    cwi_parallel_for_all(b->chunks, CHUNK, b->threads, fill_items, b);
    for (int level = 1; level < t->levels; level++) {
        children = (children + CWI_WIDTH - 1) / CWI_WIDTH;
        fill_nodes(b, level, 0, children);
    }
    float around[6];
    cwi_boxes_around(t->nodes + t->first[t->levels - 1], around);
    for (int a = 0; a < 6; a++)
        t->max = fabsf(around[a]) > t->max ? fabsf(around[a]) : t->max;
}

/* Lays out the levels; returns the number of nodes. */
static size_t plan_levels(cwi_boxes *t)
{
    size_t nodes = 0, level = t->count;
    do {
        level = (level + CWI_WIDTH - 1) / CWI_WIDTH;
        t->first[t->levels++] = nodes;
        nodes += level;
    } while (level > 1);
    return nodes;
}

static void free_keys(building *b)
{
    cwi_free(b->keys);
    cwi_free(b->sorted);
    cwi_free(b->starts);
    b->keys = b->sorted = NULL;
    b->starts = NULL;
}

static bool alloc_building(building *b)
{
    cwi_boxes *t = b->tree;
    t->nodes = cwi_alloc_array(plan_levels(t), sizeof *t->nodes);
    t->order = cwi_alloc_array(t->count, sizeof *t->order);
    b->keys = cwi_alloc_array(t->count, sizeof *b->keys);
    b->sorted = cwi_alloc_array(t->count, sizeof *b->sorted);
    b->starts = cwi_alloc_array(b->chunks, sizeof *b->starts);
    return t->nodes && t->order && b->keys && b->sorted && b->starts;
}

cw_status cwi_boxes_build(cwi_boxes *tree, const float (*boxes)[6], size_t count, cw_error *err)
{
    return cwi_boxes_build_by(tree, boxes, count, 1, err);
}

cw_status cwi_boxes_build_by(cwi_boxes *tree, const float (*boxes)[6], size_t count,
                             int threads, cw_error *err)
{
    building b = {.tree = tree, .boxes = boxes, .count = count, .threads = threads};
    *tree = (cwi_boxes){.count = count};
    if (!count)
        return CW_OK;
    b.chunks = (count + CHUNK - 1) / CHUNK;
    const bool ok = alloc_building(&b);
    if (ok) {
        make_curve(&b.curve);
        find_cube(&b);
        cwi_parallel_for_all(b.chunks, CHUNK, threads, set_keys, &b);
        find_places(&b);
        cwi_parallel_for_all(b.chunks, CHUNK, threads, deal_out_keys, &b);
        cwi_parallel_for_all(BUCKETS, count / BUCKETS, threads, sort_bucket, &b);
        free_keys(&b); /* before memory of nodes is touched */
        fill_levels(&b);
    }
    free_keys(&b);
    if (ok)
        return CW_OK;
    cwi_boxes_free(tree);
    return cwi_fail_memory(err);
}

void cwi_boxes_free(cwi_boxes *tree)
{
    cwi_free(tree->nodes);
    cwi_free(tree->order);
    *tree = (cwi_boxes){0};
}

void cwi_boxes_visit(const cwi_boxes *tree, const float box[6], size_t first,
                     bool (*visit)(void *context, size_t node), void *context)
{
    struct {
        int level;
        size_t node;
    } stack[CWI_LEVELS * CWI_WIDTH] = {{tree->levels - 1, 0}};
    size_t depth = first < cwi_boxes_nodes(tree);
    while (depth) {
        const int level = stack[--depth].level;
        const size_t node = stack[depth].node;
        if (level == 0) {
            if (!visit(context, node))
                return;
            continue;
        }
        const unsigned meeting =
            cwi_boxes_meeting(tree->nodes + tree->first[level] + node, box);
        for (size_t c = CWI_WIDTH; c-- > 0;) {
            const size_t child = node * CWI_WIDTH + c;
            if (!(meeting >> c & 1) || child < first >> 3 * (level - 1)) /* ends before it */
                continue;
            stack[depth].level = level - 1;
            stack[depth++].node = child;
        }
    }
}
