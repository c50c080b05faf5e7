/* Packs charts as bitmaps, from the largest to the smallest, each as low as there is room. */
#include "simplify/atlas/pack_charts.h"

#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/geometry/vec3.h"
#include "simplify/atlas/chart_bits.h"
#include "simplify/atlas/chart_plane.h"

#include <stdlib.h>
#include <string.h>

/* Each chart is tried in MAX_TURNS directions, from FEW_CHARTS on in a fourth of them, from SOME_CHARTS
 * on in an eighth. The density is found by GOOD_TRIES packings, or up to MAX_TRIES until one fits;
 * HALF_TRIES are for the square of half the size, from HALVED_FROM texels on. A chart below SMALL texels
 * starts LOOK_BELOW rows below where the last one of its class of sizes found room. */
enum {
    MAX_TURNS = 32,
    FEW_CHARTS = 64,
    SOME_CHARTS = 512,
    MAX_TRIES = 12,
    GOOD_TRIES = 3,
    HALF_TRIES = 5,
    HALVED_FROM = 512,
    SMALL = 48,
    CLASSES = 12,
    LOOK_BELOW = 32
};

/* The share of the square that the first packing expects to fill, and how full is enough. */
static const double FIRST_GUESS = 0.75, FULL_ENOUGH = 0.985;

/* The density that half the square loses to coarser margins. */
static const double HALF_LOSS = 1.02;

/* The square, with as much room again above it. */
typedef struct square {
    uint32_t size, rows, used; /* used: rows up to the highest texel taken */
    size_t stride;
    uint64_t *taken; /* rows x stride */
    uint16_t
        *free; /* rows x (stride + 1): how long the longest run of free texels is that begins
                        in these 64 texels of a row; 0 in the last column */
} square;

/* A chart in one direction, and the lowest place that was found. */
typedef struct candidate {
    cwi_chart_bits bits;
    double turn[2];
    uint32_t x, y;
    bool fits, no_memory;
    uint32_t lowest[CLASSES]; /* rows in which small charts of a size found room last */
} candidate;

typedef struct sized_chart {
    double size;
    uint32_t chart;
} sized_chart;

typedef struct packer {
    const cwi_atlas_packing *packing;
    const cwi_chart *charts;
    size_t count;
    uint32_t margin;
    double density;
    cwi_chart_place *places;
    sized_chart *order; /* the largest first */
    square square;
    candidate candidates[MAX_TURNS];
    int turns;              /* candidates in use */
    const cwi_chart *chart; /* whose candidates are looked at */
} packer;

static int compare_sizes(const void *a, const void *b)
{
    const sized_chart *m = a, *n = b;
    if (m->size != n->size)
        return m->size > n->size ? -1 : 1;
    return m->chart < n->chart ? -1 : m->chart > n->chart;
}

static void sort_by_size(packer *p)
{
    for (size_t n = 0; n < p->count; n++)
        p->order[n] =
            (sized_chart){fmax(p->charts[n].box[0], p->charts[n].box[1]), (uint32_t)n};
    qsort(p->order, p->count, sizeof *p->order, compare_sizes);
}

/* --- places ------------------------------------------------------------------------------- */

/* Returns 64 texels of a row from x on; beyond its end they are free. */
static uint64_t texels_at(const square *s, const uint64_t *row, uint32_t x)
{
    const uint32_t word = x / 64, shift = x % 64;
    const uint64_t low = word < s->stride ? row[word] : 0,
                   high = word + 1 < s->stride ? row[word + 1] : 0;
    return low >> shift | high << 1 << (63 - shift);
}

/* Returns bit n where `length` texels from x + n on are not all free; length up to 64. */
static uint64_t short_run_meets(const square *s, const uint64_t *row, uint32_t x,
                                uint32_t length)
{
    uint64_t low = texels_at(s, row, x), high = texels_at(s, row, x + 64);
    for (uint32_t done = 1; done < length;) {
        const uint32_t by = 2 * done <= length ? done : length - done;
        low |= low >> by | high << (64 - by);
        high |= high >> by;
        done += by;
    }
    return low;
}

/* The same for more than 64 texels: all of them share those between their ends. */
static uint64_t long_run_meets(const square *s, const uint64_t *row, uint32_t x,
                               uint32_t length)
{
    for (uint32_t at = x + 63; at < x + length; at += 64) {
        uint64_t shared = texels_at(s, row, at);
        if (x + length - at < 64)
            shared &= (UINT64_C(1) << (x + length - at)) - 1;
        if (shared)
            return ~UINT64_C(0);
    }
    const uint64_t before = texels_at(s, row, x) & ~UINT64_C(0) >> 1,
                   after = texels_at(s, row, x + length) & ~UINT64_C(0) >> 1;
    uint64_t meets = 0;
    if (before) /* up to the last one taken */
        meets |= ~UINT64_C(0) >> __builtin_clzll(before);
    if (after) /* from the first one on: it is reached one place later */
        meets |= ~UINT64_C(0) << __builtin_ctzll(after) << 1;
    return meets;
}

/* Returns bit n where a run of a chart at x + n meets taken texels. */
static uint64_t run_meets(const square *s, const cwi_texel_run *run, uint32_t x, uint32_t y)
{
    const uint32_t from = x + run->first, word = from / 64, length = run->last - run->first + 1;
    const size_t row = y + run->row;
    const uint16_t *free = s->free + row * (s->stride + 1) + word;
    if (free[0] < length && free[1] < length)
        return ~UINT64_C(0);
    const uint64_t *taken = s->taken + row * s->stride;
    return length <= 64 ? short_run_meets(s, taken, from, length)
                        : long_run_meets(s, taken, from, length);
}

/* Looks for a place in rows from y on; sets x to the leftmost one. */
static bool find_place_in_rows(const square *s, candidate *c, uint32_t y)
{
    const cwi_chart_bits *bits = &c->bits;
    const uint32_t last = s->size - bits->width;
    for (uint32_t x = 0; x <= last; x += 64) {
        uint64_t places = last - x >= 63 ? ~UINT64_C(0) : (UINT64_C(2) << (last - x)) - 1;
        for (size_t n = 0; n < bits->run_count && places; n++)
            places &= ~run_meets(s, &bits->runs[n], x, y);
        if (places) {
            c->x = x + (uint32_t)__builtin_ctzll(places);
            return true;
        }
    }
    return false;
}

/* Sorts runs so that the longest comes first, and then such as are far from each other: they find what is
 * in the way soon. */
static void sort_runs(cwi_chart_bits *bits)
{
    size_t longest = 0;
    for (size_t n = 1; n < bits->run_count; n++)
        if (bits->runs[n].last - bits->runs[n].first >
            bits->runs[longest].last - bits->runs[longest].first)
            longest = n;
    const cwi_texel_run first = bits->runs[longest];
    bits->runs[longest] = bits->runs[0];
    bits->runs[0] = first;
    for (size_t n = 1, left = bits->run_count; n + 1 < bits->run_count; n++) {
        const size_t other = n + (left * 5 / 8 + n * 7919) % (bits->run_count - n);
        const cwi_texel_run run = bits->runs[other];
        bits->runs[other] = bits->runs[n];
        bits->runs[n] = run;
    }
}

/* Returns the class of a small chart's size; NULL for larger ones. */
static uint32_t *find_lowest(candidate *c)
{
    const uint32_t width = c->bits.width, height = c->bits.height,
                   size = width > height ? width : height;
    return size < SMALL ? &c->lowest[size / (SMALL / CLASSES)] : NULL;
}

static void find_place(void *context, size_t n)
{
    packer *p = context;
    candidate *c = &p->candidates[n];
    const square *s = &p->square;
    c->fits = false;
    c->no_memory = !cwi_chart_bits_make(&c->bits, p->chart, p->density, c->turn, p->margin);
    if (c->no_memory || c->bits.width > s->size || c->bits.height > s->rows)
        return;
    sort_runs(&c->bits);
    uint32_t *lowest = find_lowest(c);
    for (c->y = lowest && *lowest > LOOK_BELOW ? *lowest - LOOK_BELOW : 0;
         c->y + c->bits.height <= s->rows && !c->fits; c->y += !c->fits)
        c->fits = find_place_in_rows(s, c, c->y);
    if (lowest && c->fits)
        *lowest = c->y;
}

/* Finds the longest runs of free texels in a row, from its end on. */
static void find_free(square *s, uint32_t y)
{
    const uint64_t *row = s->taken + y * s->stride;
    uint16_t *free = s->free + y * (s->stride + 1);
    uint32_t after = 0; /* free texels that follow a word */
    free[s->stride] = 0;
    for (size_t w = s->stride; w-- > 0;) {
        const uint32_t width = w + 1 < s->stride ? 64 : s->size - (uint32_t)w * 64;
        uint32_t longest = 0;
        uint64_t taken = row[w] | (width < 64 ? ~UINT64_C(0) << width : 0);
        if (!taken) {
            after += 64;
            free[w] = (uint16_t)after;
            continue;
        }
        uint32_t end = 64;
        while (taken) { /* the free texels above each one that is taken, from the top */
            const uint32_t top = 63 - (uint32_t)__builtin_clzll(taken);
            const uint32_t run = end - top - 1 + (end == 64 ? after : 0);
            longest = run > longest && end - top > 1 ? run : longest;
            end = top;
            taken &= ~(UINT64_C(1) << top);
        }
        longest = end > longest ? end : longest;
        after = end;
        free[w] = (uint16_t)longest;
    }
}

/* Takes the texels of a chart: its own, without the margin. */
static bool take_texels(packer *p, candidate *c, cwi_chart_place *place)
{
    square *s = &p->square;
    const uint32_t margin = p->margin;
    if (!cwi_chart_bits_make(&c->bits, p->chart, p->density, c->turn, 0))
        return false;
    for (size_t n = 0; n < c->bits.run_count; n++) {
        const cwi_texel_run *run = &c->bits.runs[n];
        const uint32_t row = c->y + margin + run->row;
        uint64_t *words = s->taken + row * s->stride;
        for (uint32_t x = c->x + margin + run->first; x <= c->x + margin + run->last; x++)
            words[x / 64] |= UINT64_C(1) << x % 64;
        s->used = row + margin + 1 > s->used ? row + margin + 1 : s->used;
    }
    for (uint32_t row = c->y + margin; row < c->y + margin + c->bits.height; row++)
        find_free(s, row);
    memcpy(place->turn, c->turn, sizeof place->turn);
    place->shift[0] = c->x + margin - c->bits.least[0];
    place->shift[1] = c->y + margin - c->bits.least[1];
    return true;
}

/* Places a chart; sets *fits. */
static bool place_chart(packer *p, size_t chart, bool *fits)
{
    const double *turn = p->charts[chart].turn;
    p->chart = &p->charts[chart];
    for (int n = 0; n < p->turns; n++) {
        static const double quarters[4][2] = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}};
        const double *q = quarters[n % 4];
        double by[2], chart_turn[2];
        cwi_chart_turn((double)(n / 4) / (p->turns / 4), by);
        cwi_chart_multiply(turn, by, chart_turn);
        cwi_chart_multiply(chart_turn, q, p->candidates[n].turn);
    }
    cwi_parallel_for_all((size_t)p->turns, (size_t)1 << 20, p->packing->threads, find_place, p);
    candidate *best = NULL;
    for (int n = 0; n < p->turns; n++) {
        candidate *c = &p->candidates[n];
        if (c->no_memory)
            return false;
        if (!c->fits)
            continue;
        if (!best || c->y + c->bits.height < best->y + best->bits.height)
            best = c;
    }
    *fits = best;
    return !best || take_texels(p, best, &p->places[chart]);
}

/* --- the density -------------------------------------------------------------------------- */

/* Packs all charts at the density of now; square.used tells how high they are, UINT32_MAX if they do
 * not fit at all. */
static cw_status pack_all(packer *p, const cw_progress *progress, cw_error *err)
{
    square *s = &p->square;
    cw_status st = CW_OK;
    bool fits = true;
    memset(s->taken, 0, s->rows * s->stride * sizeof *s->taken);
    for (uint32_t row = 0; row < s->rows; row++)
        find_free(s, row);
    s->used = 0;
    for (int n = 0; n < MAX_TURNS; n++)
        memset(p->candidates[n].lowest, 0, sizeof p->candidates[n].lowest);
    for (size_t n = 0; n < p->count && fits && st == CW_OK; n++) {
        if (!place_chart(p, p->order[n].chart, &fits))
            return cwi_fail_memory(err);
        st = cwi_progress(progress, "packing charts", (double)n / (double)p->count, err);
    }
    if (!fits)
        s->used = UINT32_MAX;
    return st;
}

static double sum_area(const packer *p)
{
    double area = 0;
    for (size_t n = 0; n < p->count; n++)
        for (size_t t = 0; t < p->charts[n].triangles; t++)
            area += p->charts[n].area[t];
    return area;
}

static cw_status fail_to_fit(const packer *p, cw_error *err)
{
    return cwi_fail(err, CW_ERR_ARGUMENT,
                    "%zu charts with margins of %u texels do not fit into %u x %u texels%s",
                    p->count, p->packing->margin, p->packing->size, p->packing->size,
                    p->packing->density > 0 ? " at this density" : "");
}

/* Packs at ever better densities, from that of the packer on, and keeps the best: places and density.
 * tries  packings if one of them is good */
static cw_status improve_density(packer *p, int tries, cwi_chart_place *best,
                                 const cw_progress *progress, cw_error *err)
{
    const double size = p->square.size;
    double best_density = 0;
    cw_status st = CW_OK;
    for (int n = 0; n < MAX_TRIES && st == CW_OK && (n < tries || best_density == 0); n++) {
        st = pack_all(p, progress, err);
        const double used = p->square.used == UINT32_MAX ? 2.5 * size : p->square.used;
        if (used <= size && p->density > best_density) {
            best_density = p->density;
            memcpy(best, p->places, p->count * sizeof *best);
            if (used > FULL_ENOUGH * size)
                break;
        }
        p->density *= sqrt(size / used) * (used > size ? 0.997 : 1);
        if (p->density <= best_density)
            p->density = best_density * 1.004;
    }
    p->density = best_density;
    return st == CW_OK && best_density == 0 ? fail_to_fit(p, err) : st;
}

static void set_size(packer *p, uint32_t size, uint32_t margin)
{
    p->square.size = size;
    p->square.rows = 2 * size;
    p->square.stride = (size + 63) / 64;
    p->margin = margin;
}

/* Finds the best density in a square of half the size, which takes an eighth of the time, and begins
 * there. */
static cw_status find_density(packer *p, const cw_progress *progress, cw_error *err)
{
    const cwi_atlas_packing *packing = p->packing;
    cwi_chart_place *best = cwi_alloc_array(p->count, sizeof *best);
    cw_status st = best ? CW_OK : cwi_fail_memory(err);
    p->density = sqrt(FIRST_GUESS / sum_area(p)) * packing->size;
    if (st == CW_OK && packing->size >= HALVED_FROM) {
        set_size(p, packing->size / 2, (packing->margin + 1) / 2);
        p->density /= 2;
        const cw_status found = improve_density(p, HALF_TRIES, best, progress, err);
        st = found == CW_ERR_ARGUMENT ? CW_OK : found;
        p->density = found == CW_OK ? 2 * HALF_LOSS * p->density
                                    : sqrt(FIRST_GUESS / sum_area(p)) * packing->size;
        set_size(p, packing->size, packing->margin);
    }
    if (st == CW_OK)
        st = improve_density(p, GOOD_TRIES, best, progress, err);
    if (st == CW_OK)
        memcpy(p->places, best, p->count * sizeof *best);
    cwi_free(best);
    return st;
}

/* --- the whole ---------------------------------------------------------------------------- */

static bool alloc(packer *p)
{
    square *s = &p->square;
    set_size(p, p->packing->size, p->packing->margin);
    p->places = p->packing->places;
    s->taken = cwi_alloc_array(s->rows, s->stride * sizeof *s->taken);
    s->free = cwi_alloc_array(s->rows, (s->stride + 1) * sizeof *s->free);
    p->order = cwi_alloc_array(p->count, sizeof *p->order);
    return s->taken && s->free && p->order;
}

static void free_all(packer *p)
{
    cwi_free(p->square.taken);
    cwi_free(p->square.free);
    cwi_free(p->order);
    for (int n = 0; n < MAX_TURNS; n++)
        cwi_chart_bits_free(&p->candidates[n].bits);
}

cw_status cwi_charts_pack(cwi_atlas_packing *packing, const cwi_chart *charts, size_t count,
                          const cw_progress *progress, cw_error *err)
{
    packer p = {.packing = packing, .charts = charts, .count = count};
    p.turns = count < FEW_CHARTS    ? MAX_TURNS
              : count < SOME_CHARTS ? MAX_TURNS / 4
                                    : MAX_TURNS / 8;
    cw_status st = alloc(&p) ? CW_OK : cwi_fail_memory(err);
    if (st == CW_OK) {
        sort_by_size(&p);
        p.density = packing->density;
        if (packing->density > 0) {
            st = pack_all(&p, progress, err);
            if (st == CW_OK && p.square.used > packing->size)
                st = fail_to_fit(&p, err);
        } else {
            st = find_density(&p, progress, err);
            packing->density = p.density;
        }
    }
    free_all(&p);
    return st;
}
