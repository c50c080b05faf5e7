/* Builds a tree of boxes with eight children per node, sorted along a Hilbert curve, and visits
 * overlaps. */
#include "core/geometry/bvh.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/vec3.h"

#include <float.h>
#include <stdlib.h>
#include <string.h>

typedef struct keyed {
    uint64_t key;
    uint32_t item;
} keyed;

enum { KEY_BITS = 16 }; /* of each coordinate */

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

/* Sets each key: the rank of the box's middle on the curve through a cube of 2^16 cells an
 * edge. */
static void set_keys(const float (*boxes)[6], size_t count, keyed *keys)
{
    double low[3] = {INFINITY, INFINITY, INFINITY}, high = 0;
    hilbert curve;
    make_curve(&curve);
    for (size_t n = 0; n < count; n++)
        for (int a = 0; a < 3; a++)
            low[a] = cwi_lesser(low[a], find_middle(boxes[n], a));
    for (size_t n = 0; n < count; n++)
        for (int a = 0; a < 3; a++)
            high = cwi_greater(high, find_middle(boxes[n], a) - low[a]);
    const double scale = high > 0 ? ((1 << KEY_BITS) - 1) / high : 0;
    for (size_t n = 0; n < count; n++) {
        uint32_t cell[3];
        for (int a = 0; a < 3; a++) {
            cell[a] = (uint32_t)((find_middle(boxes[n], a) - low[a]) * scale);
        }
        keys[n] = (keyed){find_rank(&curve, cell), (uint32_t)n};
    }
}

static int compare_keyed(const void *x, const void *y)
{
    const keyed *a = x, *b = y;
    return a->key != b->key ? (a->key > b->key) - (a->key < b->key)
                            : (a->item > b->item) - (a->item < b->item);
}

enum { DIGIT_BITS = 12, DIGITS = 1 << DIGIT_BITS, PASSES = 3 * KEY_BITS / DIGIT_BITS };

static unsigned get_digit(const keyed *k, int pass)
{
    return (unsigned)(k->key >> pass * DIGIT_BITS) & (DIGITS - 1);
}

/* Sets where the keys of each digit begin, for every pass. */
static void find_starts(const keyed *keys, size_t count, uint32_t (*starts)[DIGITS])
{
    memset(starts, 0, PASSES * sizeof *starts);
    for (size_t n = 0; n < count; n++)
        for (int pass = 0; pass < PASSES; pass++)
            starts[pass][get_digit(&keys[n], pass)]++;
    for (int pass = 0; pass < PASSES; pass++)
        for (uint32_t d = 0, sum = 0; d < DIGITS; d++) {
            const uint32_t here = starts[pass][d];
            starts[pass][d] = sum;
            sum += here;
        }
}

/* Radix-sorts by 12 bits of the key at a time; the order of equal keys is kept. Returns false
 * when memory is out. */
static bool radix_sort_keys(keyed **keys, size_t count)
{
    keyed *other = cwi_alloc_array(count, sizeof *other);
    uint32_t(*starts)[DIGITS] = cwi_alloc_array(PASSES, sizeof *starts);
    const bool ok = other && starts;
    if (ok)
        find_starts(*keys, count, starts);
    for (int pass = 0; pass < PASSES && ok; pass++) {
        for (size_t n = 0; n < count; n++)
            other[starts[pass][get_digit(&(*keys)[n], pass)]++] = (*keys)[n];
        keyed *sorted = other;
        other = *keys;
        *keys = sorted;
    }
    cwi_free(other);
    cwi_free(starts);
    return ok;
}

/* Few keys are compared with each other, as the digits of a radix sort would outnumber them. The
 * order is the same. Returns false when memory is out. */
static bool sort_keys(keyed **keys, size_t count)
{
    enum { FEW = 1 << 12 };
    if (count > FEW)
        return radix_sort_keys(keys, count);
    qsort(*keys, count, sizeof **keys, compare_keyed);
    return true;
}

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

static void fill_level(cwi_boxes *t, const float (*boxes)[6], int level, size_t children)
{
    const float empty[6] = {INFINITY, INFINITY, INFINITY, -INFINITY, -INFINITY, -INFINITY};
    cwi_boxes_node *nodes = t->nodes + t->first[level];
    float box[6];
    size_t c = 0;
    for (; c < children; c++)
        if (level == 0) {
            cwi_boxes_put(nodes, c, boxes[t->order[c]]);
        } else {
            cwi_boxes_around(t->nodes + t->first[level - 1] + c, box);
            cwi_boxes_put(nodes, c, box);
        }
    for (; c % CWI_WIDTH; c++)
        cwi_boxes_put(nodes, c, empty);
}

static void fill_boxes(cwi_boxes *t, const float (*boxes)[6])
{
    size_t children = t->count;
    for (int level = 0; level < t->levels; level++) {
        fill_level(t, boxes, level, children);
        children = (children + CWI_WIDTH - 1) / CWI_WIDTH;
    }
    for (size_t n = 0; n < t->count; n++)
        for (int a = 0; a < 6; a++) {
            const float magnitude = fabsf(boxes[n][a]);
            t->max = magnitude > t->max ? magnitude : t->max;
        }
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

cw_status cwi_boxes_build(cwi_boxes *tree, const float (*boxes)[6], size_t count, cw_error *err)
{
    *tree = (cwi_boxes){.count = count};
    if (!count)
        return CW_OK;
    tree->nodes = cwi_alloc_array(plan_levels(tree), sizeof *tree->nodes);
    tree->order = cwi_alloc_array(count, sizeof *tree->order);
    keyed *keys = cwi_alloc_array(count, sizeof *keys);
    bool ok = tree->nodes && tree->order && keys;
    if (ok)
        set_keys(boxes, count, keys);
    ok = ok && sort_keys(&keys, count);
    for (size_t n = 0; n < count && ok; n++)
        tree->order[n] = keys[n].item;
    if (ok)
        fill_boxes(tree, boxes);
    cwi_free(keys);
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
