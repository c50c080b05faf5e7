/* Counts the closed curves that the surface draws on the sides of the volume's box.
 *
 * The box's surface is a sphere of squares, on which the inside samples, joined along the edges
 * of squares, and across a diagonal where the surface joins it, make patches. A patch with b
 * curves around it has Euler number 2 - b; so with V samples, E joins and F squares inside,
 *     curves = 2 patches - (V - E + F).
 * V, E and F are counts of bits; patches are found by joining runs of bits.
 *
 * Slices come from the bottom to the top. Each gives the box a ring of samples, and the first and
 * the last one all of their rows. A ring is a line of bits that ends with its first sample once
 * more. A patch counts when it is first seen, so sets are only needed of the last two lines. */
#include "extract/dense/border_loops.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/union_find.h"
#include "extract/dense/ambiguous_cells.h"

#include <assert.h>
#include <string.h>

/* A line of samples: a ring, or a row of the bottom or top. */
typedef struct sample_line {
    const uint64_t *bits; /* with one word more, which is 0 */
    size_t words, length;
    size_t base;  /* the number of its first sample in the sets */
    size_t layer; /* in the grid */
    bool is_ring;
    size_t y; /* of a row */
} sample_line;

/* --- places on a ring ------------------------------------------------------------------------ */

static size_t ring_length(const size_t dim[3])
{
    return 2 * (dim[0] + dim[1]) - 4;
}

/* Returns the number of a sample on its ring: along y = 0, up the last x, back, and down. */
static size_t find_on_ring(const size_t dim[3], size_t x, size_t y)
{
    const size_t right = dim[0] - 1, back = dim[1] - 1;
    if (y == 0)
        return x;
    if (x == right)
        return right + y;
    return y == back ? 2 * right + back - x : 2 * (right + back) - y;
}

static void find_ring_position(const size_t dim[3], size_t n, size_t *x, size_t *y)
{
    const size_t right = dim[0] - 1, back = dim[1] - 1;
    if (n <= right) {
        *x = n;
        *y = 0;
    } else if (n <= right + back) {
        *x = right;
        *y = n - right;
    } else if (n <= 2 * right + back) {
        *x = 2 * right + back - n;
        *y = back;
    } else {
        *x = 0;
        *y = 2 * (right + back) - n;
    }
}

/* --- bits of lines --------------------------------------------------------------------------- */

static bool has_bit(const uint64_t *bits, size_t n)
{
    return bits[n / 64] >> n % 64 & 1;
}

static void set_bit(uint64_t *bits, size_t n)
{
    bits[n / 64] |= UINT64_C(1) << n % 64;
}

/* Returns word w of a row of samples; bricks that are not wanted have nothing inside at the
 * border. */
static inline uint64_t word_at(const cwi_bit_grid *g, size_t j, size_t k, size_t w)
{
    if (!g->all_classified) {
        const cwi_brick_rows around = cwi_rows_around(g, j, k);
        if (w >= g->words || !(cwi_active_samples(g, &around, w / 64) >> w % 64 & 1))
            return 0;
    }
    return cwi_grid_row(g, k * g->rows_y + j)[w];
}

/* Loads the bits of a row of a slice, from its first voxel on. */
static void load_row(const cwi_bit_grid *g, size_t y, size_t layer, uint64_t *bits)
{
    for (size_t w = 0; 64 * w < g->volume.dim[0]; w++)
        bits[w] = word_at(g, y + 1, layer, w) >> 1 | word_at(g, y + 1, layer, w + 1) << 63;
}

/* Returns whether the first and the last sample of a row are inside: CWI_FIRST_INSIDE and
 * CWI_LAST_INSIDE. */
static unsigned find_ends(const cwi_bit_grid *g, size_t y, size_t layer)
{
    const size_t last = g->volume.dim[0];
    if (g->all_classified)
        return g->filled[layer * g->rows_y + y + 1];
    return (word_at(g, y + 1, layer, 0) & 2 ? CWI_FIRST_INSIDE : 0) |
           (word_at(g, y + 1, layer, last / 64) >> last % 64 & 1 ? CWI_LAST_INSIDE : 0);
}

static void load_ring(const cwi_border_loops *b, const cwi_bit_grid *g, size_t layer)
{
    const size_t *dim = b->dim;
    uint64_t *bits = b->ring[0], *back = b->row[0];
    memset(bits, 0, b->ring_words * sizeof *bits);
    load_row(g, 0, layer, bits);
    load_row(g, dim[1] - 1, layer, back);
    for (size_t w = 0; w < b->row_words; w++)
        for (uint64_t left = back[w]; left; left &= left - 1) {
            const size_t x = 64 * w + (size_t)__builtin_ctzll(left);
            set_bit(bits, find_on_ring(dim, x, dim[1] - 1));
        }
    for (size_t y = 1; y + 1 < dim[1]; y++) {
        const unsigned ends = find_ends(g, y, layer);
        if (ends & CWI_FIRST_INSIDE)
            set_bit(bits, find_on_ring(dim, 0, y));
        if (ends & CWI_LAST_INSIDE)
            set_bit(bits, find_on_ring(dim, dim[0] - 1, y));
    }
    if (has_bit(bits, 0))
        set_bit(bits, ring_length(dim));
}

/* --- patches --------------------------------------------------------------------------------- */

static ptrdiff_t count_bits(uint64_t bits)
{
    return __builtin_popcountll(bits);
}

/* Returns the number of a sample's run in the sets: that of the first sample of the run, within
 * one word. */
static uint32_t find_run(const sample_line *line, size_t n)
{
    const uint64_t gaps = ~line->bits[n / 64] & ((UINT64_C(1) << n % 64) - 1);
    return (uint32_t)(line->base + n / 64 * 64 +
                      (gaps ? 64 - (size_t)__builtin_clzll(gaps) : 0));
}

static void join_runs(cwi_border_loops *b, uint32_t x, uint32_t y)
{
    b->patches -= cwi_sets_find(b->sets, x) != cwi_sets_find(b->sets, y);
    cwi_sets_join(b->sets, x, y);
}

/* Makes each run of a line a patch of its own, and joins those that go on in the next word. */
static void begin_runs(cwi_border_loops *b, const sample_line *line)
{
    for (size_t w = 0; w < line->words; w++) {
        for (uint64_t left = line->bits[w] & ~(line->bits[w] << 1); left; left &= left - 1) {
            const uint32_t run = find_run(line, 64 * w + (size_t)__builtin_ctzll(left));
            b->sets[run] = run;
            b->patches++;
        }
        if (w && line->bits[w] & 1 && line->bits[w - 1] >> 63)
            join_runs(b, find_run(line, 64 * w), find_run(line, 64 * w - 1));
    }
}

/* Counts a line's samples, and their joins along it. */
static void count_samples(cwi_border_loops *b, const sample_line *line)
{
    for (size_t w = 0; w < line->words; w++)
        b->euler += count_bits(line->bits[w]) -
                    count_bits(line->bits[w] & cwi_next_samples(line->bits, w));
}

static double find_value(const cwi_border_loops *b, const cwi_bit_grid *g,
                         const sample_line *line, size_t n)
{
    size_t x = n, y = line->y;
    if (line->is_ring)
        find_ring_position(b->dim, n, &x, &y);
    return cwi_value_at(g, x + 1, y + 1, line->layer);
}

/* Joins the inside corners of the square that begins with sample n of two lines, whose corners
 * alternate, where the surface joins them. */
static void join_diagonal(cwi_border_loops *b, const cwi_bit_grid *g, const sample_line *before,
                          const sample_line *line, size_t n)
{
    const size_t first = has_bit(before->bits, n) ? 0 : 1; /* that is inside, of `before` */
    const double inside[2] = {find_value(b, g, before, n + first),
                              find_value(b, g, line, n + 1 - first)},
                 outside[2] = {find_value(b, g, before, n + 1 - first),
                               find_value(b, g, line, n + first)};
    if (!cwi_face_joins(inside, outside, cwi_zero_is_inside(g)))
        return;
    join_runs(b, find_run(before, n + first), find_run(line, n + 1 - first));
    b->euler--;
}

/* Joins two lines of samples side by side, and counts the joins and squares between them. */
static void join_lines(cwi_border_loops *b, const cwi_bit_grid *g, const sample_line *before,
                       const sample_line *line)
{
    for (size_t w = 0; w < line->words; w++) {
        const uint64_t here = line->bits[w], other = before->bits[w], both = here & other;
        const uint64_t next = cwi_next_samples(line->bits, w),
                       other_next = cwi_next_samples(before->bits, w);
        b->euler += count_bits(both & next & other_next) - count_bits(both);
        for (uint64_t left = both & ~(both << 1); left; left &= left - 1) {
            const size_t n = 64 * w + (size_t)__builtin_ctzll(left);
            join_runs(b, find_run(line, n), find_run(before, n));
        }
        const uint64_t alternating = (here ^ other) & (here ^ next) & (other ^ other_next);
        for (uint64_t left = g->simple ? 0 : alternating; left; left &= left - 1) {
            const size_t n = 64 * w + (size_t)__builtin_ctzll(left);
            if (n + 1 < line->length)
                join_diagonal(b, g, before, line, n);
        }
    }
}

/* Moves the sets of a line to where the line before has its own. Parents below the line's base are
 * of the ring, and stay. */
static void move_sets(cwi_border_loops *b, const sample_line *line, size_t to)
{
    for (size_t w = 0; w < line->words; w++)
        for (uint64_t left = line->bits[w] & ~(line->bits[w] << 1); left; left &= left - 1) {
            const size_t n = 64 * w + (size_t)__builtin_ctzll(left);
            const size_t parent = b->sets[line->base + n];
            b->sets[to + n] =
                (uint32_t)(parent < line->base ? parent : parent - line->base + to);
        }
}

static void swap_bits(uint64_t *bits[2])
{
    uint64_t *first = bits[0];
    bits[0] = bits[1];
    bits[1] = first;
}

/* --- slices ---------------------------------------------------------------------------------- */

static sample_line ring_at(const cwi_border_loops *b, int n, size_t layer)
{
    const size_t length = ring_length(b->dim) + 1;
    return (sample_line){.bits = b->ring[n],
                         .words = b->ring_words,
                         .length = length,
                         .base = n ? length : 0,
                         .layer = n ? layer - 1 : layer,
                         .is_ring = true};
}

static sample_line row_at(const cwi_border_loops *b, int n, size_t y, size_t layer)
{
    return (sample_line){.bits = b->row[n],
                         .words = b->row_words,
                         .length = b->dim[0],
                         .base = ring_length(b->dim) + 1 + (n ? b->dim[0] : 0),
                         .layer = layer,
                         .y = n ? y - 1 : y};
}

/* Joins the runs of a row with those of the ring that have the same samples. */
static void join_with_ring(cwi_border_loops *b, const sample_line *row, const sample_line *ring)
{
    const size_t *dim = b->dim;
    const bool is_side = row->y == 0 || row->y + 1 == dim[1];
    for (size_t w = 0; w < row->words && is_side; w++)
        for (uint64_t left = row->bits[w] & ~(row->bits[w] << 1); left; left &= left - 1) {
            const size_t x = 64 * w + (size_t)__builtin_ctzll(left);
            join_runs(b, find_run(row, x), find_run(ring, find_on_ring(dim, x, row->y)));
        }
    for (size_t x = 0; x < dim[0] && !is_side; x += dim[0] - 1)
        if (has_bit(row->bits, x))
            join_runs(b, find_run(row, x), find_run(ring, find_on_ring(dim, x, row->y)));
}

/* Adds all samples of a slice, which is the bottom or the top. Its ring has sets already. */
static void add_plane(cwi_border_loops *b, const cwi_bit_grid *g, const sample_line *ring)
{
    for (size_t y = 0; y < b->dim[1]; y++) {
        const sample_line row = row_at(b, 0, y, ring->layer),
                          before = row_at(b, 1, y, ring->layer);
        load_row(g, y, ring->layer, b->row[0]);
        begin_runs(b, &row);
        join_with_ring(b, &row, ring);
        if (y)
            join_lines(b, g, &before, &row);
        count_samples(b, &row);
        move_sets(b, &row, before.base);
        swap_bits(b->row);
    }
}

void cwi_border_loops_add(cwi_border_loops *b, const cwi_bit_grid *g, size_t layer)
{
    const sample_line ring = ring_at(b, 0, layer), below = ring_at(b, 1, layer);
    const size_t end = ring_length(b->dim);
    assert(b->next < b->dim[2]);
    load_ring(b, g, layer);
    const bool closes = has_bit(ring.bits, end);
    begin_runs(b, &ring);
    if (closes)
        join_runs(b, find_run(&ring, end), 0);
    if (b->next) {
        join_lines(b, g, &below, &ring);
        b->euler += closes && has_bit(below.bits, end); /* that join was counted twice */
    }
    if (b->next == 0 || b->next + 1 == b->dim[2]) {
        add_plane(b, g, &ring);
    } else {
        count_samples(b, &ring);
        b->euler -= closes; /* and that sample */
    }
    move_sets(b, &ring, below.base);
    swap_bits(b->ring);
    b->next++;
}

/* --- the count ------------------------------------------------------------------------------- */

static size_t count_words(const size_t dim[3], size_t *ring_words, size_t *row_words)
{
    *ring_words = ring_length(dim) / 64 + 1;
    *row_words = (dim[0] + 63) / 64;
    return 2 * (*ring_words + 1) + 2 * (*row_words + 1);
}

size_t cwi_border_loops_bytes(const size_t dim[3])
{
    size_t ring_words, row_words;
    return count_words(dim, &ring_words, &row_words) * sizeof(uint64_t) +
           2 * (ring_length(dim) + 1) * sizeof(uint32_t);
}

cw_status cwi_border_loops_init(cwi_border_loops *b, const size_t dim[3], cw_error *err)
{
    *b = (cwi_border_loops){.dim = {dim[0], dim[1], dim[2]}};
    if (dim[0] >= UINT32_MAX / 8 || dim[1] >= UINT32_MAX / 8)
        return cwi_fail(err, CW_ERR_LIMIT,
                        "slices have %zu x %zu voxels; their border is counted up to %u",
                        dim[0], dim[1], UINT32_MAX / 8);
    const size_t words = count_words(dim, &b->ring_words, &b->row_words);
    b->bits = cwi_alloc_zeroed(words, sizeof *b->bits);
    b->sets = cwi_alloc_array(2 * (ring_length(dim) + 1), sizeof *b->sets);
    if (!b->bits || !b->sets)
        return cwi_fail_memory(err);
    b->ring[0] = b->bits;
    b->ring[1] = b->ring[0] + b->ring_words + 1;
    b->row[0] = b->ring[1] + b->ring_words + 1;
    b->row[1] = b->row[0] + b->row_words + 1;
    return CW_OK;
}

void cwi_border_loops_free(cwi_border_loops *b)
{
    cwi_free(b->bits);
    cwi_free(b->sets);
    *b = (cwi_border_loops){0};
}

size_t cwi_border_loops_count(const cwi_border_loops *b)
{
    return (size_t)(2 * (ptrdiff_t)b->patches - b->euler);
}

cw_status cwi_grid_border_loops(const cwi_bit_grid *grid, size_t *count, cw_error *err)
{
    cwi_border_loops b = {0};
    bool any = false;
    for (size_t k = 0; k < grid->rows_z; k++)
        any = any || grid->layers[k].at_border;
    *count = 0;
    if (!any)
        return CW_OK;
    const cw_status st = cwi_border_loops_init(&b, grid->volume.dim, err);
    for (size_t k = 1; k + 1 < grid->rows_z && st == CW_OK; k++)
        cwi_border_loops_add(&b, grid, k);
    if (st == CW_OK)
        *count = cwi_border_loops_count(&b);
    cwi_border_loops_free(&b);
    return st;
}
