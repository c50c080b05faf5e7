/* Counts the closed curves that the surface draws on the sides of the volume's box.
 *
 * The box's surface is a sphere of squares, on which the inside samples, joined along the edges
 * of squares, and across a diagonal where the surface joins it, make patches. A patch with b
 * curves around it has Euler number 2 - b; so with V samples, E joins and F squares inside,
 *     curves = 2 patches - (V - E + F).
 * V, E and F are counts of bits; patches are found by joining runs of bits. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "extract/dense/ambiguous_cells.h"

#include <string.h>

typedef struct box {
    const cwi_bit_grid *grid;
    size_t n[3];
    uint32_t
        *parent;     /* union-find over the samples of the six sides, from 1; 0: not yet seen */
    uint64_t *lines; /* two lines of bits, each with one word more, which is 0 */
    size_t words;    /* in a line */
    size_t patches;
    ptrdiff_t euler;
} box;

/* A side of the box as lines of samples: `axis` is constant at `at`. */
typedef struct side {
    int axis, along, across;
    size_t at;
} side;

/* Returns the number of a sample on the box's surface: the bottom layer, a ring for every
 * layer, the top. */
static size_t surface_index(const size_t n[3], const size_t p[3])
{
    const size_t layer = n[0] * n[1], ring = 2 * (n[0] + n[1]) - 4;
    if (p[2] == 0)
        return p[1] * n[0] + p[0];
    const size_t begin = layer + (p[2] - 1) * ring;
    if (p[2] == n[2] - 1)
        return begin + p[1] * n[0] + p[0];
    if (p[1] == 0)
        return begin + p[0];
    if (p[1] == n[1] - 1)
        return begin + n[0] + p[0];
    return begin + 2 * n[0] + 2 * (p[1] - 1) + (p[0] != 0);
}

/* Returns word w of a row of samples; bricks that are not wanted have nothing inside at the
 * border. */
static inline uint64_t word_at(const cwi_bit_grid *g, size_t j, size_t k, size_t w)
{
    if (!g->everything) {
        const cwi_brick_rows around = cwi_rows_around(g, j, k);
        if (w >= g->words || !(cwi_wanted_samples(g, &around, w / 64) >> w % 64 & 1))
            return 0;
    }
    return cwi_grid_row(g, k * g->rows_y + j)[w];
}

static bool is_inside(const box *b, const size_t p[3])
{
    return word_at(b->grid, p[1] + 1, p[2] + 1, (p[0] + 1) / 64) >> (p[0] + 1) % 64 & 1;
}

static uint32_t find_root(uint32_t *parent, uint32_t x)
{
    while (parent[x] != x + 1)
        x = (parent[x] = parent[parent[x] - 1]) - 1;
    return x;
}

/* Returns the number of sample x of line n of a side; makes it a patch of its own when it is
 * first seen. */
static uint32_t number_sample(box *b, const side *s, size_t n, size_t x)
{
    size_t p[3];
    p[s->axis] = s->at;
    p[s->along] = x;
    p[s->across] = n;
    const uint32_t index = (uint32_t)surface_index(b->n, p);
    if (!b->parent[index]) {
        b->parent[index] = index + 1;
        b->patches++;
    }
    return index;
}

static void join_samples(box *b, uint32_t x, uint32_t y)
{
    x = find_root(b->parent, x);
    y = find_root(b->parent, y);
    if (x != y) {
        b->parent[x > y ? x : y] = (x > y ? y : x) + 1;
        b->patches--;
    }
}

/* Loads the bits of line n of a side. */
static void load_line(const box *b, const side *s, size_t n, uint64_t *line)
{
    size_t p[3];
    p[s->axis] = s->at;
    p[s->across] = n;
    memset(line, 0, b->words * sizeof *line);
    if (s->along == 0) {
        for (size_t w = 0; 64 * w < b->n[0]; w++)
            line[w] = word_at(b->grid, p[1] + 1, p[2] + 1, w) >> 1 |
                      word_at(b->grid, p[1] + 1, p[2] + 1, w + 1) << 63;
        return;
    }
    const cwi_bit_grid *g = b->grid;
    const unsigned end = p[0] ? CWI_LAST_INSIDE : CWI_FIRST_INSIDE;
    for (p[1] = 0; p[1] < b->n[1]; p[1]++) {
        const size_t row = (p[2] + 1) * g->rows_y + p[1] + 1;
        const bool in = g->everything ? g->filled[row] & end : is_inside(b, p);
        line[p[1] / 64] |= (uint64_t)in << p[1] % 64;
    }
}

/* Returns the first sample of the run of bits, within one word, that sample x of a line belongs
 * to. */
static size_t run_start(const uint64_t *line, size_t x)
{
    const uint64_t gaps = ~line[x / 64] & ((UINT64_C(1) << x % 64) - 1);
    return x / 64 * 64 + (gaps ? 64 - (size_t)__builtin_clzll(gaps) : 0);
}

/* Joins the runs of one line: those across words, and each with its samples that another side
 * already has. */
static void join_line(box *b, const side *s, size_t n, const uint64_t *line)
{
    const size_t length = b->n[s->along];
    const bool seam = s->axis == 0 && (n == 0 || n + 1 == b->n[2]);
    for (size_t w = 0; w < b->words; w++) {
        const uint64_t starts = line[w] & ~(line[w] << 1);
        for (uint64_t left = starts; left; left &= left - 1)
            number_sample(b, s, n, 64 * w + (size_t)__builtin_ctzll(left));
        if (w && line[w] & 1 && line[w - 1] >> 63)
            join_samples(b, number_sample(b, s, n, 64 * w),
                         number_sample(b, s, n, run_start(line, 64 * w - 1)));
        for (uint64_t left = seam ? line[w] : 0; left; left &= left - 1) {
            const size_t x = 64 * w + (size_t)__builtin_ctzll(left);
            join_samples(b, number_sample(b, s, n, x),
                         number_sample(b, s, n, run_start(line, x)));
        }
    }
    for (size_t x = 0; x < length; x += length - 1)
        if (line[x / 64] >> x % 64 & 1)
            join_samples(b, number_sample(b, s, n, x),
                         number_sample(b, s, n, run_start(line, x)));
}

/* Joins the inside corners of square (x, n - 1), which alternate, where the surface joins
 * them. */
static void join_diagonal(box *b, const side *s, size_t n, size_t x, const uint64_t *before,
                          const uint64_t *line)
{
    double v[2][2]; /* the diagonal that begins at x in the line before, and the other */
    for (size_t c = 0; c < 4; c++) {
        size_t p[3];
        p[s->axis] = s->at;
        p[s->along] = x + (c & 1);
        p[s->across] = n - 1 + (c >> 1);
        v[(c & 1) ^ (c >> 1)][c >> 1] = cwi_value_at(b->grid, p[0] + 1, p[1] + 1, p[2] + 1);
    }
    const size_t first = before[x / 64] >> x % 64 & 1 ? 0 : 1; /* the inside diagonal */
    if (!cwi_face_joins(v[first], v[1 - first], cwi_zero_is_inside(b->grid)))
        return;
    join_samples(b, number_sample(b, s, n - 1, run_start(before, x + first)),
                 number_sample(b, s, n, run_start(line, x + 1 - first)));
    b->euler--;
}

static ptrdiff_t count_bits(uint64_t bits)
{
    return __builtin_popcountll(bits);
}

static void join_side(box *b, const side *s)
{
    uint64_t *line = b->lines, *before = b->lines + b->words + 1;
    memset(b->lines, 0, 2 * (b->words + 1) * sizeof *b->lines);
    for (size_t n = 0; n < b->n[s->across]; n++) {
        load_line(b, s, n, line);
        join_line(b, s, n, line);
        for (size_t w = 0; w < b->words; w++) {
            const uint64_t both = line[w] & before[w];
            const uint64_t next = line[w + 1] & before[w + 1];
            b->euler += count_bits(line[w]) - count_bits(line[w] & cwi_next_samples(line, w)) -
                        count_bits(both) + count_bits(both & (both >> 1 | next << 63));
            const uint64_t here = line[w] ^ before[w];
            const uint64_t turns = line[w] ^ cwi_next_samples(line, w);
            const uint64_t there = here & turns & (before[w] ^ cwi_next_samples(before, w));
            for (uint64_t left = n && !b->grid->simple ? there : 0; left; left &= left - 1) {
                const size_t x = 64 * w + (size_t)__builtin_ctzll(left);
                if (x + 1 < b->n[s->along])
                    join_diagonal(b, s, n, x, before, line);
            }
            for (uint64_t left = both & ~(both << 1); left; left &= left - 1) {
                const size_t x = 64 * w + (size_t)__builtin_ctzll(left);
                join_samples(b, number_sample(b, s, n, run_start(line, x)),
                             number_sample(b, s, n - 1, run_start(before, x)));
            }
        }
        uint64_t *swap = line;
        line = before;
        before = swap;
    }
}

/* Corrects the counts: samples and joins on the box's 12 edges were counted by two sides, its
 * corners by three. */
static void correct_edges(box *b)
{
    for (int axis = 0; axis < 3; axis++)
        for (int edge = 0; edge < 4; edge++) {
            const int u = (axis + 1) % 3, v = (axis + 2) % 3;
            size_t p[3];
            bool before = false;
            p[u] = edge & 1 ? b->n[u] - 1 : 0;
            p[v] = edge >> 1 ? b->n[v] - 1 : 0;
            for (p[axis] = 0; p[axis] < b->n[axis]; p[axis]++) {
                const bool in = is_inside(b, p);
                const bool corner = p[axis] == 0 || p[axis] + 1 == b->n[axis];
                b->euler -= in - (in && before);
                b->euler += axis == 0 && corner && in;
                before = in;
            }
        }
}

cw_status cwi_grid_border_loops(const cwi_bit_grid *grid, size_t *loops, cw_error *err)
{
    const size_t *n = grid->volume.dim;
    const size_t samples = 2 * n[0] * n[1] + (n[2] - 2) * (2 * (n[0] + n[1]) - 4);
    box b = {.grid = grid, .n = {n[0], n[1], n[2]}};
    bool any = false;
    for (size_t k = 0; k < grid->rows_z; k++)
        any = any || grid->layers[k].at_border;
    *loops = 0;
    if (!any)
        return CW_OK;
    if (samples >= UINT32_MAX)
        return cwi_fail(err, CW_ERR_LIMIT, "the volume's border has %zu voxels, more than %u",
                        samples, UINT32_MAX);
    b.words = (n[0] > n[1] ? n[0] : n[1]) / 64 + 1;
    b.lines = cwi_alloc_array(b.words + 1, 2 * sizeof *b.lines);
    b.parent = cwi_alloc_zeroed(samples, sizeof *b.parent);
    const bool room = b.lines && b.parent;
    for (int i = 0; i < 6 && room; i++) {
        const int axis = i / 2;
        const side s = {axis, axis == 0, axis == 2 ? 1 : 2, i % 2 ? n[axis] - 1 : 0};
        join_side(&b, &s);
    }
    if (room)
        correct_edges(&b);
    *loops = (size_t)(2 * (ptrdiff_t)b.patches - b.euler);
    cwi_free(b.lines);
    cwi_free(b.parent);
    return room ? CW_OK
                : cwi_fail(err, CW_ERR_NO_MEMORY, "no memory for %zu border voxels", samples);
}
