/* Finds medians of cubes that slide along the rows of a tile.
 *
 * The values of a tile are sorted once, so that each voxel has a rank of its own. A cube then is a set
 * of ranks: bits, of which a step along x sets and clears one in each row. The median is the bit in the
 * middle; it moves by few words from one voxel to the next. */
#include "core/filter/median_tiles.h"

#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/volume/volume.h"

#include <string.h>

enum {
    WIDE = 32,
    HIGH = 16, /* voxels of a tile along x; along y and z */
    MAX_RADIUS = 3,
    MAX_VALUES = (WIDE + 2 * MAX_RADIUS) * (HIGH + 2 * MAX_RADIUS) * (HIGH + 2 * MAX_RADIUS),
    WORDS = MAX_VALUES / 64 + 1,
    NO_RANK = UINT16_MAX,
    DIGIT = 8, /* bits that a pass of sorting looks at */
    DIGITS = 1 << DIGIT
};

typedef struct work {
    const cw_volume *in;
    cw_volume *out;
    size_t radius, tiles[3];
    bool starved;
} work;

/* A value, as an integer of the same order, and where it is in the tile. */
typedef struct sorted_value {
    uint64_t key;
    uint32_t at;
} sorted_value;

/* A tile with the voxels around it, and a cube in it. */
typedef struct bench {
    double values[MAX_VALUES], valid[MAX_VALUES];
    sorted_value sorted[MAX_VALUES], swap[MAX_VALUES];
    uint16_t ranks[MAX_VALUES];
    uint64_t set[WORDS];
    size_t row, slice;         /* voxels from one to the next along y and z */
    size_t count, word, below; /* of the cube: ranks; a word; ranks in the words before */
} bench;

/* Returns an integer in the order of numbers: negative ones have all bits flipped, others the sign. */
static uint64_t order_key(double value)
{
    uint64_t bits;
    value += 0.0; /* -0 is 0 */
    memcpy(&bits, &value, sizeof bits);
    return bits >> 63 ? ~bits : bits | (uint64_t)1 << 63;
}

/* Sorts by a digit of the keys, in the order in which they are. Returns false if all are equal. */
static bool sort_digit(const sorted_value *from, size_t count, int shift, sorted_value *to)
{
    size_t first[DIGITS] = {0}, sum = 0;
    for (size_t n = 0; n < count; n++)
        first[from[n].key >> shift & (DIGITS - 1)]++;
    if (count && first[from[0].key >> shift & (DIGITS - 1)] == count)
        return false;
    for (int d = 0; d < DIGITS; d++) {
        const size_t here = first[d];
        first[d] = sum;
        sum += here;
    }
    for (size_t n = 0; n < count; n++)
        to[first[from[n].key >> shift & (DIGITS - 1)]++] = from[n];
    return true;
}

/* Ranks the values of a tile. Afterwards sorted[rank] is a value. */
static void rank_values(bench *b, size_t all)
{
    size_t count = 0;
    sorted_value *from = b->sorted, *to = b->swap;
    for (size_t n = 0; n < all; n++) {
        b->ranks[n] = NO_RANK;
        if (b->valid[n] > 0)
            from[count++] = (sorted_value){order_key(b->values[n]), (uint32_t)n};
    }
    for (int shift = 0; shift < 64; shift += DIGIT)
        if (sort_digit(from, count, shift, to)) {
            sorted_value *swap = from;
            from = to;
            to = swap;
        }
    if (from != b->sorted)
        memcpy(b->sorted, from, count * sizeof *from);
    for (size_t n = 0; n < count; n++)
        b->ranks[b->sorted[n].at] = (uint16_t)n;
}

static size_t clamp_index(size_t at, size_t halo, size_t count)
{
    return at < halo ? 0 : at - halo < count ? at - halo : count - 1;
}

/* Loads a tile. Beyond the border values go on as they are there. */
static void load_tile(const work *k, const size_t first[3], const size_t size[3], bench *b)
{
    const size_t r = k->radius, *dim = k->in->dim, end = first[0] + size[0] + r;
    const size_t from = clamp_index(first[0], r, dim[0]), before = from + r - first[0],
                 count = (end < dim[0] ? end : dim[0]) - from, width = size[0] + 2 * r;
    b->row = width;
    b->slice = width * (size[1] + 2 * r);
    for (size_t z = 0; z < size[2] + 2 * r; z++)
        for (size_t y = 0; y < size[1] + 2 * r; y++) {
            double *values = b->values + z * b->slice + y * b->row,
                   *valid = b->valid + z * b->slice + y * b->row;
            cw_volume view = *k->in;
            view.data = cwi_voxel_address(k->in, from, clamp_index(first[1] + y, r, dim[1]),
                                          clamp_index(first[2] + z, r, dim[2]));
            view.dim[0] = count;
            cwi_filter_load(&view, 0, 0, values + before, valid + before);
            for (size_t i = 0; i < width; i++) {
                const size_t at = i < before           ? before
                                  : i < before + count ? i
                                                       : before + count - 1;
                values[i] = values[at];
                valid[i] = valid[at];
            }
        }
    rank_values(b, b->slice * (size[2] + 2 * r));
}

/* Adds a rank to the cube, or takes it out of it. */
static inline void flip_rank(bench *b, size_t rank, bool adds)
{
    const size_t word = rank / 64;
    if (rank == NO_RANK)
        return;
    b->set[word] ^= (uint64_t)1 << rank % 64;
    b->count += adds ? 1 : (size_t)-1;
    if (word < b->word)
        b->below += adds ? 1 : (size_t)-1;
}

/* Adds a column of the cube, or takes it out: the voxels of all rows with the same x. */
static void flip_column(bench *b, size_t at, size_t side, bool adds)
{
    for (size_t z = 0; z < side; z++)
        for (size_t y = 0; y < side; y++)
            flip_rank(b, b->ranks[at + z * b->slice + y * b->row], adds);
}

/* Returns the value in the middle of the cube; of an even number the lower one. */
static double find_median(bench *b)
{
    const size_t rank = (b->count - 1) / 2;
    while (b->below > rank)
        b->below -= (size_t)__builtin_popcountll(b->set[--b->word]);
    for (;;) {
        const size_t here = (size_t)__builtin_popcountll(b->set[b->word]);
        if (b->below + here > rank)
            break;
        b->below += here;
        b->word++;
    }
    uint64_t bits = b->set[b->word];
    for (size_t n = b->below; n < rank; n++)
        bits &= bits - 1; /* clears the lowest */
    return b->values[b->sorted[b->word * 64 + (size_t)__builtin_ctzll(bits)].at];
}

/* Stores the medians of a row. at: the first voxel of its first cube */
static void store_row(const work *k, bench *b, size_t at, size_t count, char *to)
{
    const size_t side = 2 * k->radius + 1, size = cw_type_size(k->out->type);
    const size_t middle = k->radius * (b->slice + b->row + 1);
    memset(b->set, 0, sizeof b->set);
    b->count = b->word = b->below = 0;
    for (size_t x = 0; x + 1 < side; x++)
        flip_column(b, at + x, side, true);
    for (size_t i = 0; i < count; i++, to += size) {
        flip_column(b, at + i + side - 1, side, true);
        if (b->valid[at + i + middle] > 0)
            cwi_voxel_put(k->out->type, to, find_median(b));
        else
            cwi_filter_store_gap(k->out, to);
        flip_column(b, at + i, side, false);
    }
}

static void filter_tile(void *context, size_t n)
{
    work *k = context;
    const size_t whole[3] = {WIDE, HIGH, HIGH}, *dim = k->in->dim;
    const size_t tile_index[3] = {n % k->tiles[0], n / k->tiles[0] % k->tiles[1],
                                  n / k->tiles[0] / k->tiles[1]};
    size_t first[3], size[3];
    bench *b = cwi_alloc_array(1, sizeof *b);
    if (!b) {
        cwi_set_flag(&k->starved);
        return;
    }
    for (int a = 0; a < 3; a++) {
        first[a] = tile_index[a] * whole[a];
        size[a] = dim[a] - first[a] < whole[a] ? dim[a] - first[a] : whole[a];
    }
    load_tile(k, first, size, b);
    for (size_t z = 0; z < size[2]; z++)
        for (size_t y = 0; y < size[1]; y++)
            store_row(k, b, z * b->slice + y * b->row, size[0],
                      (char *)cw_volume_voxels(k->out) +
                          (((first[2] + z) * dim[1] + first[1] + y) * dim[0] + first[0]) *
                              cw_type_size(k->out->type));
    cwi_free(b);
}

cw_status cwi_median_tiles(const cw_volume *in, size_t radius, const cw_filter_desc *desc,
                           cw_volume *out, cw_error *err)
{
    enum { COST = 50 }; /* simple operations a voxel */
    work k = {.in = in,
              .out = out,
              .radius = radius,
              .tiles = {(in->dim[0] + WIDE - 1) / WIDE, (in->dim[1] + HIGH - 1) / HIGH,
                        (in->dim[2] + HIGH - 1) / HIGH}};
    cw_status st = cwi_parallel_for(k.tiles[0] * k.tiles[1] * k.tiles[2],
                                    (size_t)COST * WIDE * HIGH * HIGH, desc->threads,
                                    &desc->progress, "smoothing", filter_tile, &k, err);
    if (st == CW_OK && k.starved)
        st = cwi_fail_memory(err);
    if (st != CW_OK)
        cw_volume_free(out);
    return st;
}
