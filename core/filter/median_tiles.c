/* Finds medians of cubes that slide along the rows of a tile.
 *
 * The values of a tile are sorted once, so that each voxel has a rank of its own. A window of voxels
 * then is a set of ranks: bits, with the number of ranks up to the end of each word. Windows grow out
 * of smaller ones, by one that leaves and one that joins [Weiss2006]: a line along z by a voxel, a
 * column of y and z by a line, a cube by a column. So a larger cube costs no more. */
#include "core/filter/median_tiles.h"

#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/volume/volume.h"

#include <math.h>
#include <string.h>

enum {
    WIDE = 8,
    HIGH = 6, /* voxels of a tile along x; along y and z */
    MAX_RADIUS = 3,
    MAX_WIDTH = WIDE + 2 * MAX_RADIUS,
    MAX_HEIGHT = HIGH + 2 * MAX_RADIUS,
    MAX_VALUES = MAX_WIDTH * MAX_HEIGHT * MAX_HEIGHT,
    BLOCK = 16, /* words that are handled together */
    MAX_WORDS = (MAX_VALUES / 64 + BLOCK) / BLOCK * BLOCK,
    NO_RANK = UINT16_MAX,
    DIGIT = 8, /* bits that a pass of sorting looks at */
    DIGITS = 1 << DIGIT
};

typedef struct work {
    const cw_volume *in;
    cw_volume *out;
    size_t radius, tiles_y;
    bool starved;
} work;

/* A value, as an integer of the same order, and where it is in the tile. */
typedef struct sorted_value {
    uint64_t key;
    uint32_t at;
} sorted_value;

/* The voxels of a window. */
typedef struct rank_set {
    uint64_t bits[MAX_WORDS];
    uint16_t up_to[MAX_WORDS]; /* ranks in the words up to each, and in it */
} rank_set;

/* A tile with the voxels around it, and the windows in it. */
typedef struct bench {
    double values[MAX_VALUES], valid[MAX_VALUES];
    sorted_value sorted[MAX_VALUES], swap[MAX_VALUES];
    uint16_t ranks[MAX_VALUES];
    uint16_t step[2 * MAX_WORDS]; /* 0 and then 1: added to counts from a rank's word on */
    rank_set lines[MAX_HEIGHT][MAX_WIDTH], columns[MAX_WIDTH], cube, empty;
    size_t row, slice, words; /* voxels from one to the next along y and z; words of a set */
    size_t word;              /* with the last median */
} bench;

/* Returns an integer in the order of numbers: negative ones have all bits flipped, others the sign. */
static uint64_t order_key(double value)
{
    uint64_t bits;
    value += 0.0; /* -0 is 0 */
    memcpy(&bits, &value, sizeof bits);
    return bits >> 63 ? ~bits : bits | (uint64_t)1 << 63;
}

/* Sorts by a digit of the keys, in the order in which they are. */
static void sort_digit(const sorted_value *from, size_t count, int shift, sorted_value *to)
{
    size_t first[DIGITS] = {0}, sum = 0;
    for (size_t n = 0; n < count; n++)
        first[from[n].key >> shift & (DIGITS - 1)]++;
    for (int d = 0; d < DIGITS; d++) {
        const size_t here = first[d];
        first[d] = sum;
        sum += here;
    }
    for (size_t n = 0; n < count; n++)
        to[first[from[n].key >> shift & (DIGITS - 1)]++] = from[n];
}

/* Returns the least value if all are integers, so that differences from it sort them; else NAN. */
static double find_origin(const bench *b, size_t all)
{
    const double limit = 4503599627370496.0; /* 2^52: differences are exact */
    double least = limit;
    for (size_t n = 0; n < all; n++) {
        const double value = b->values[n];
        if (!(value > -limit && value < limit) || value != (double)(int64_t)value)
            return NAN;
        if (b->valid[n] > 0 && value < least)
            least = value;
    }
    return least;
}

/* Ranks the values of a tile. Afterwards sorted[rank] is a value. */
static void rank_values(bench *b, size_t all)
{
    size_t count = 0;
    uint64_t differ = 0;
    sorted_value *from = b->sorted, *to = b->swap;
    const double origin = find_origin(b, all);
    const bool by_difference = !isnan(origin);
    for (size_t n = 0; n < all; n++) {
        b->ranks[n] = NO_RANK;
        if (!(b->valid[n] > 0))
            continue;
        from[count] = (sorted_value){by_difference ? (uint64_t)(b->values[n] - origin)
                                                   : order_key(b->values[n]),
                                     (uint32_t)n};
        differ |= from[count].key ^ from->key;
        count++;
    }
    for (int shift = 0; shift < 64; shift += DIGIT)
        if (differ >> shift & (DIGITS - 1)) {
            sort_digit(from, count, shift, to);
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
    b->word = 0;
    b->words = (b->slice * (size[2] + 2 * r) / 64 + BLOCK) / BLOCK * BLOCK;
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

/* Takes the voxels of one window out of a set and adds those of another. */
static void exchange_windows(rank_set *restrict set, const rank_set *leaves,
                             const rank_set *joins, size_t words)
{
    for (size_t n = 0; n < words / BLOCK * BLOCK; n++)
        set->bits[n] ^= leaves->bits[n] ^ joins->bits[n];
    for (size_t n = 0; n < words / BLOCK * BLOCK; n++)
        set->up_to[n] = (uint16_t)(set->up_to[n] + joins->up_to[n] - leaves->up_to[n]);
}

static void flip_rank(const bench *b, rank_set *restrict set, uint16_t rank, uint16_t by)
{
    if (rank == NO_RANK)
        return;
    const size_t word = rank / 64;
    const uint16_t *step = b->step + MAX_WORDS - word;
    set->bits[word] ^= (uint64_t)1 << rank % 64;
    for (size_t n = 0; n < b->words / BLOCK * BLOCK; n++)
        set->up_to[n] = (uint16_t)(set->up_to[n] + by * step[n]);
}

/* Moves the lines of a tile to a slice, from the one below or from none. */
static void move_lines(bench *b, size_t z, size_t height, size_t side)
{
    for (size_t y = 0; y < height; y++)
        for (size_t x = 0; x < b->row; x++) {
            const uint16_t *rank = b->ranks + y * b->row + x;
            rank_set *line = &b->lines[y][x];
            if (z)
                flip_rank(b, line, rank[(z - 1) * b->slice], UINT16_MAX);
            else
                *line = b->empty;
            for (size_t k = z ? z + side - 1 : 0; k < z + side; k++)
                flip_rank(b, line, rank[k * b->slice], 1);
        }
}

/* Moves the columns of a slice to a row, from the one before or from none. */
static void move_columns(bench *b, size_t y, size_t side)
{
    for (size_t x = 0; x < b->row; x++) {
        rank_set *column = &b->columns[x];
        if (!y)
            *column = b->empty;
        for (size_t j = y ? y + side - 1 : 0; j < y + side; j++)
            exchange_windows(column, y ? &b->lines[y - 1][x] : &b->empty, &b->lines[j][x],
                             b->words);
    }
}

/* Returns the value in the middle of the cube; of an even number the lower one. */
static double find_median(bench *b)
{
    const rank_set *c = &b->cube;
    const size_t rank = (size_t)(c->up_to[b->words - 1] - 1) / 2;
    size_t word = b->word;
    while (word && c->up_to[word - 1] > rank)
        word--;
    while (c->up_to[word] <= rank)
        word++;
    b->word = word;
    uint64_t bits = c->bits[word];
    for (size_t n = word ? c->up_to[word - 1] : 0; n < rank; n++)
        bits &= bits - 1; /* clears the lowest */
    return b->values[b->sorted[word * 64 + (size_t)__builtin_ctzll(bits)].at];
}

/* Stores the medians of a row. middle: the voxel in the middle of its first cube */
static void store_row(const work *k, bench *b, size_t middle, size_t count, char *to)
{
    const size_t side = 2 * k->radius + 1, size = cw_type_size(k->out->type);
    b->cube = b->empty;
    for (size_t x = 0; x + 1 < side; x++)
        exchange_windows(&b->cube, &b->empty, &b->columns[x], b->words);
    for (size_t i = 0; i < count; i++, to += size) {
        exchange_windows(&b->cube, i ? &b->columns[i - 1] : &b->empty,
                         &b->columns[i + side - 1], b->words);
        if (b->valid[middle + i] > 0)
            cwi_voxel_put(k->out->type, to, find_median(b));
        else
            cwi_filter_store_gap(k->out, to);
    }
}

/* Stores the medians of a tile that was loaded. */
static void store_tile(const work *k, const size_t first[3], const size_t size[3], bench *b)
{
    const size_t r = k->radius, side = 2 * r + 1, *dim = k->in->dim;
    char *voxels = cw_volume_voxels(k->out);
    for (size_t z = 0; z < size[2]; z++) {
        move_lines(b, z, size[1] + 2 * r, side);
        for (size_t y = 0; y < size[1]; y++) {
            const size_t voxel = ((first[2] + z) * dim[1] + first[1] + y) * dim[0] + first[0];
            move_columns(b, y, side);
            store_row(k, b, (z + r) * b->slice + (y + r) * b->row + r, size[0],
                      voxels + voxel * cw_type_size(k->out->type));
        }
    }
}

/* Filters the tiles of a row along x. */
static void filter_tiles(void *context, size_t n)
{
    work *k = context;
    const size_t whole[3] = {WIDE, HIGH, HIGH}, *dim = k->in->dim;
    const size_t tile[3] = {0, n % k->tiles_y, n / k->tiles_y};
    size_t first[3], size[3];
    bench *b = cwi_alloc_zeroed(1, sizeof *b);
    if (!b) {
        cwi_set_flag(&k->starved);
        return;
    }
    for (size_t word = 0; word < MAX_WORDS; word++)
        b->step[MAX_WORDS + word] = 1;
    for (int a = 0; a < 3; a++) {
        first[a] = tile[a] * whole[a];
        size[a] = dim[a] - first[a] < whole[a] ? dim[a] - first[a] : whole[a];
    }
    for (; first[0] < dim[0]; first[0] += WIDE) {
        size[0] = dim[0] - first[0] < WIDE ? dim[0] - first[0] : WIDE;
        load_tile(k, first, size, b);
        store_tile(k, first, size, b);
    }
    cwi_free(b);
}

cw_status cwi_median_tiles(const cw_volume *in, size_t radius, const cw_filter_desc *desc,
                           cw_volume *out, cw_error *err)
{
    enum { COST = 50 }; /* simple operations a voxel */
    work k = {
        .in = in, .out = out, .radius = radius, .tiles_y = (in->dim[1] + HIGH - 1) / HIGH};
    cw_status st = cwi_parallel_for(k.tiles_y * ((in->dim[2] + HIGH - 1) / HIGH),
                                    COST * in->dim[0] * HIGH * HIGH, desc->threads,
                                    &desc->progress, "smoothing", filter_tiles, &k, err);
    if (st == CW_OK && k.starved)
        st = cwi_fail_memory(err);
    if (st != CW_OK)
        cw_volume_free(out);
    return st;
}
