/* Bit planes: one bit per sample, set where the sample is inside. They decide which cells and
 * edges the surface crosses, 64 at a time, and number its vertices.
 *
 * The samples are padded by one layer on every side, outside the solid, so that the solid is
 * closed where the volume ends; padded sample (i, j, k) is voxel (i-1, j-1, k-1). Row r =
 * k * rows_y + j holds `words` words; bit i % 64 of word i / 64 is sample i. Cell (i, j, k)
 * lies between samples i and i+1, j and j+1, k and k+1. */
#ifndef EXTRACT_DENSE_BIT_PLANES_H
#define EXTRACT_DENSE_BIT_PLANES_H

#include <cubewright/extract.h>

/* The sides of the isovalue on which samples are. */
enum { CWI_OUTSIDE = 1, CWI_INSIDE = 2, CWI_BOTH = CWI_OUTSIDE | CWI_INSIDE };

/* The edge, in cells, of the bricks in which the surface is sought: 8 x 8 x 8 cells. */
enum { CWI_BRICK = 8 };

/* The eight leaves in a word, bit b for leaf b: those that the octree cannot rule out and, of
 * the others, those that are inside. */
typedef struct cwi_leaf_bits {
    uint8_t active, solid;
} cwi_leaf_bits;

/* Counts of a layer, and the plans of its ambiguous cells. */
typedef struct cwi_layer {
    size_t vertices, triangles;
    bool at_border;  /* the solid meets the volume's border here */
    uint32_t *plans; /* how its ambiguous cells resolve, in their order */
    size_t plan_count, plan_capacity;
    bool plans_lost; /* there was no memory */
} cwi_layer;

/* The isovalue as a stored number, and the side of it that is inside. */
typedef struct cwi_level {
    double at;
    bool strict; /* crossed upward above, not at, the level: values fall as numbers rise */
    bool invert; /* inside is where the comparison fails */
} cwi_level;

CW_NODISCARD cw_status cwi_level_find(const cw_volume *volume, const cw_extract_desc *desc,
                                      cwi_level *level, cw_error *err);

typedef struct cwi_octree cwi_octree;
typedef struct cwi_engine cwi_engine;

/* Facts about a row: some sample is inside, the first one is, the last one is, some has no
 * value. */
enum { CWI_ANY_INSIDE = 1, CWI_FIRST_INSIDE = 2, CWI_LAST_INSIDE = 4, CWI_GAP = 8 };

typedef struct cwi_bit_grid {
    cw_volume volume; /* resolved: one component, one step */
    double level;     /* the isovalue in stored numbers */
    bool strict;      /* crossed upward above, not at, the level: values fall as numbers rise */
    bool invert;      /* inside is where the comparison fails */
    size_t words;     /* of 64 samples in a padded row */
    size_t rows_y, rows_z, rows;
    uint64_t *inside; /* rows x words */
    uint8_t *filled;  /* rows: what their samples are; known where everything is wanted */
    uint64_t *has;    /* rows x words: which samples have values; NULL: not known, or all but
                         the padding */
    uint64_t *live;   /* rows x words: cells all of whose samples have values, but pinched ones;
                         see cwi_live_layer(); NULL: all cells */
    uint64_t *window; /* of a block, whose rows are one word: four planes, of cells that are
                         live or beside a live one, and of edges of live cells along x, y and z.
                         NULL: to be found out from `live` */
    bool reads_whole_words; /* wherever a row of voxels begins, 64 may be read */
    size_t masks;           /* words of a mask that has a bit for every word of a row */
    uint64_t
        *mixed_words; /* rows x masks, found when a row is counted: bit w is set where a cell of
                         word w has corners on both sides. No other word holds crossings */
    cwi_layer *layers; /* rows_z */
    size_t max_plans; /* that a layer keeps: if it has more, they are made twice. 0: no limit */
    uint32_t *row_plans; /* rows: number of plans of the layer up to the row, where a row has
                            ambiguous cells; filled when a layer is counted. NULL: not wanted */
    size_t bricks_y, bricks_z;
    uint64_t
        *active; /* bricks_z x bricks_y x masks: words with cells the octree cannot rule out */
    cwi_leaf_bits
        *leaves;      /* bricks_z x bricks_y x words: of wanted words, and those after them */
    bool gaps_known;  /* everything was wanted once, so has_gaps is known */
    bool has_gaps;    /* some voxel has no value */
    bool live_is_box; /* the live cells are all but those of padding */
    bool find_values; /* `has` is filled while samples are compared */
    bool all_classified; /* all words are wanted; else the others mean nothing in the planes */
    bool cubic;   /* crossings stand on the cubic through four samples where there is one */
    bool simple;  /* one rule for ambiguous faces, in place of the field's topology */
    bool crossed; /* some samples with values are inside and some are not */
} cwi_bit_grid;

/* Numbers of a row: its first vertex on x-, y- and z-edges and inside cells, and its cells'
 * first triangle. */
typedef struct cwi_row {
    uint32_t first[4];
    size_t triangle;
} cwi_row;

/* Sets up a grid for a volume, and allocates its planes. Free with cwi_grid_free(), also after
 * an error. */
CW_NODISCARD cw_status cwi_grid_init(cwi_bit_grid *grid, const cw_volume *volume,
                                     cw_error *err);
void cwi_grid_free(cwi_bit_grid *grid);

/* Compares the samples with the isovalue: all of them, or only those that a tree marks as
 * wanted. A tree that is not grown yet is grown on the way; tree may be NULL. */
CW_NODISCARD cw_status cwi_grid_classify(cwi_bit_grid *grid, const cwi_engine *engine,
                                         cwi_octree *tree, const cw_extract_desc *desc,
                                         cw_error *err);
size_t cwi_grid_bytes(const cwi_bit_grid *grid);

/* Takes note that all voxels have changed. nodata: voxels may have no value, as the volume was
 * given */
void cwi_grid_forget(cwi_bit_grid *grid, bool nodata);

/* Takes note that the voxels in a box have changed, and finds those without value. nodata: as above */
void cwi_grid_update(cwi_bit_grid *grid, const cwi_engine *engine, const cw_box *box,
                     bool nodata);

/* Sets the isovalue, as a stored number, and its inside: these are the same for every
 * sample. */
CW_NODISCARD cw_status cwi_grid_set_level(cwi_bit_grid *grid, const cw_extract_desc *desc,
                                          cw_error *err);

/* Finds the live cells. Where the surface stays open, cells at the end of the domain are
 * dropped. */
CW_NODISCARD cw_status cwi_grid_set_live(cwi_bit_grid *grid, bool leave_open, cw_error *err);

/* Finds the cells of a layer all of whose samples have values. */
void cwi_find_live_layer(const cwi_bit_grid *grid, size_t layer);

/* Finds the four planes of g->window from the live cells. The grid's rows are one word.
 * window  4 x rows words */
void cwi_find_window(const cwi_bit_grid *grid, uint64_t *window);

/* Drops the cells of a layer, 1 or above, and of the one below it that share nothing but a crossed
 * edge: two live ones, diagonal, while the other two are dead. Both would put triangles at its
 * vertex, in two fans. A sweep over all layers may leave others so. Returns true if any was
 * dropped. */
bool cwi_drop_pinched_layer(const cwi_bit_grid *grid, size_t layer);

/* Checks that positions can distinguish the voxels and can reach all of them. */
CW_NODISCARD cw_status cwi_extract_check_range(const cw_volume *volume, cw_error *err);

/* Allocates a plane of bits for the grid, not cleared; NULL without memory. */
uint64_t *cwi_grid_plane(const cwi_bit_grid *grid);

static inline const uint64_t *cwi_grid_row(const cwi_bit_grid *g, size_t row)
{
    return g->inside + row * g->words;
}

static inline const uint64_t *cwi_grid_busy(const cwi_bit_grid *g, size_t row)
{
    return g->mixed_words + row * g->masks;
}

/* Returns the row of bricks that row (j, k) of cells lies in. */
static inline size_t cwi_grid_bricks(const cwi_bit_grid *g, size_t j, size_t k)
{
    return k / CWI_BRICK * g->bricks_y + j / CWI_BRICK;
}

/* Returns the wanted words of row (j, k) of cells. */
static inline const uint64_t *cwi_grid_active(const cwi_bit_grid *g, size_t j, size_t k)
{
    return g->active + cwi_grid_bricks(g, j, k) * g->masks;
}

/* The rows of bricks that touch row (j, k) of samples: one to four. */
typedef struct cwi_brick_rows {
    size_t count, row[4];
} cwi_brick_rows;

static inline cwi_brick_rows cwi_rows_around(const cwi_bit_grid *g, size_t j, size_t k)
{
    const size_t here = cwi_grid_bricks(g, j, k), below = here - g->bricks_y;
    cwi_brick_rows b = {1, {here, 0, 0, 0}};
    if (j % CWI_BRICK == 0)
        b.row[b.count++] = here - 1;
    if (k % CWI_BRICK == 0)
        b.row[b.count++] = below;
    if (j % CWI_BRICK == 0 && k % CWI_BRICK == 0)
        b.row[b.count++] = below - 1;
    return b;
}

/* Returns the words of the row that cells of wanted words read, in mask word m. */
static inline uint64_t cwi_active_samples(const cwi_bit_grid *g, const cwi_brick_rows *b,
                                          size_t m)
{
    uint64_t active = 0;
    for (size_t n = 0; n < b->count; n++)
        active |= g->active[b->row[n] * g->masks + m];
    return active;
}

static inline bool cwi_any_active(const cwi_bit_grid *g, const cwi_brick_rows *b)
{
    uint64_t any = 0;
    for (size_t m = 0; m < g->masks; m++)
        any |= cwi_active_samples(g, b, m);
    return any;
}

/* Spreads eight bits to the samples of eight leaves. */
static inline uint64_t cwi_spread_leaves(unsigned bits)
{
    const uint64_t apart =
        (bits * UINT64_C(0x8040201008040201) & UINT64_C(0x8080808080808080)) >> 7;
    return __builtin_bswap64(apart) * 255;
}

/* Returns the first word at or after w whose bit is set in a mask; `words` when there is
 * none. */
static inline size_t cwi_next_marked_word(const uint64_t *mask, size_t w, size_t words)
{
    for (; w < words; w = (w | 63) + 1) {
        const uint64_t left = mask[w / 64] >> w % 64;
        if (left)
            return w + (size_t)__builtin_ctzll(left);
    }
    return words;
}

/* Returns word w of a row moved down by one sample: bit i is sample i + 1. After a row's last
 * word comes the next row's first, whose lowest bit is padding, as the one beyond this row
 * would be. */
static inline uint64_t cwi_next_samples(const uint64_t *row, size_t w)
{
    return row[w] >> 1 | row[w + 1] << 63;
}

/* Returns the crossed edges; bit i: samples i and i + 1 along axis from row (j, k) are on
 * different sides. */
static inline uint64_t cwi_grid_crossed(const cwi_bit_grid *g, int axis, size_t j, size_t k,
                                        size_t w)
{
    const uint64_t *row = cwi_grid_row(g, k * g->rows_y + j);
    if (axis == 0)
        return row[w] ^ cwi_next_samples(row, w);
    if (axis == 1)
        return j + 1 < g->rows_y ? row[w] ^ row[g->words + w] : 0;
    return k + 1 < g->rows_z ? row[w] ^ row[g->rows_y * g->words + w] : 0;
}

#endif
