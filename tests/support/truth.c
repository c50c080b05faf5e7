/* Topology from a fine picture of the field, and the agreement of two ways to find it.
 *
 * The picture is a lattice of points, each inside or outside. Lattices need a rule for which
 * points touch. Cubes of 6 neighbours for one side and 26 for the other favour one side at
 * every saddle, by a width that shrinks with the lattice but never goes. We take the tetrahedra
 * of Freudenthal: every cube of the lattice is cut in six along one diagonal, a point touches
 * 14, and the rule is the same for both sides: what one side leaves, the other joins. Its
 * errors are those of a piecewise linear field, of second order in the lattice's step. */
#include "support/truth.h"

#include <assert.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

void test_sets_start(size_t *sets, size_t count)
{
    for (size_t n = 0; n < count; n++)
        sets[n] = n;
}

size_t test_sets_find(size_t *sets, size_t n)
{
    while (sets[n] != n)
        n = sets[n] = sets[sets[n]];
    return n;
}

bool test_sets_join(size_t *sets, size_t a, size_t b)
{
    a = test_sets_find(sets, a);
    b = test_sets_find(sets, b);
    if (a == b)
        return false;
    sets[a > b ? a : b] = a > b ? b : a;
    return true;
}

enum { WORDS = 17, LONGEST = 16 * 64 + 3 }; /* bits of a row: 16 samples of 64 points, padded */

/* Points with a layer of outside around them; bit x of row (y, z), and zeros after the last. */
typedef struct picture {
    size_t dim[3], words;
    uint64_t *bits;
} picture;

static uint64_t *picture_row(const picture *p, size_t y, size_t z)
{
    return p->bits + (z * p->dim[1] + y) * p->words;
}

/* The sample below point n, and how far the point is from it; the last point has a sample of
 * its own, so the one below is that before it. */
static size_t cell_of(size_t n, size_t points, size_t dim, double *t)
{
    size_t cell = n / points;
    if (cell + 1 == dim)
        cell--;
    *t = (double)(n - cell * points) / (double)points;
    return cell;
}

/* Exact when t is 0 or 1, so that points on samples have the sample's own side. */
static double mix(double a, double b, double t)
{
    return (1 - t) * a + t * b;
}

/* The points from one sample to before the next; between alike ends all are alike. */
static uint64_t paint_cell(double from, double to, size_t points, double iso)
{
    if ((from >= iso) == (to >= iso))
        return from >= iso ? ~UINT64_C(0) >> (64 - points) : 0;
    uint64_t bits = 0;
    const double step = (to - from) / (double)points;
    for (size_t n = 0; n < points; n++)
        bits |= (uint64_t)(from + (double)n * step >= iso) << n;
    return bits;
}

static void paint_row(uint64_t *row, const double *samples, size_t dim, size_t points,
                      double iso)
{
    for (size_t c = 0; c < dim; c++) {
        const size_t x = 1 + c * points;
        const uint64_t bits = c + 1 < dim ? paint_cell(samples[c], samples[c + 1], points, iso)
                                          : samples[c] >= iso;
        row[x / 64] |= bits << x % 64;
        if (x % 64 + points > 64 && c + 1 < dim)
            row[x / 64 + 1] |= bits >> (64 - x % 64);
    }
}

static picture paint(const float *voxels, const size_t dim[3], float iso, size_t points)
{
    picture p = {.words = ((dim[0] - 1) * points + 3 + 63) / 64};
    for (int a = 0; a < 3; a++)
        p.dim[a] = (dim[a] - 1) * points + 3;
    p.bits = calloc(p.dim[1] * p.dim[2] * p.words, sizeof *p.bits);
    assert(p.bits);
    for (size_t z = 0; z + 2 < p.dim[2]; z++)
        for (size_t y = 0; y + 2 < p.dim[1]; y++) {
            double samples[16], ty, tz;
            const size_t j = cell_of(y, points, dim[1], &ty);
            const size_t k = cell_of(z, points, dim[2], &tz);
            const float *low = voxels + (k * dim[1] + j) * dim[0];
            const float *high = low + dim[1] * dim[0];
            for (size_t i = 0; i < dim[0]; i++)
                samples[i] = mix(mix((double)low[i], (double)low[i + dim[0]], ty),
                                 mix((double)high[i], (double)high[i + dim[0]], ty), tz);
            paint_row(picture_row(&p, y + 1, z + 1), samples, dim[0], points, (double)iso);
        }
    return p;
}

/* Simplices with all corners inside, with the sign of their dimension. Those that begin at a
 * point are the chains of its cube's corners 0 < a < b < 7, corners as sets of axes. */
static long count_simplices(const uint64_t at[8])
{
    long sum = __builtin_popcountll(at[0]);
    for (unsigned a = 1; a < 8; a++) {
        const uint64_t edge = at[0] & at[a];
        sum -= __builtin_popcountll(edge);
        for (unsigned b = a + 1; b < 8; b++)
            if ((a & b) == a) {
                const uint64_t face = edge & at[b];
                sum += __builtin_popcountll(face);
                if (b < 7 && a != 7)
                    sum -= __builtin_popcountll(face & at[7]);
            }
    }
    return sum;
}

/* Euler number of the inside. The padding is empty, so the last rows need no looking at. */
static long picture_euler(const picture *p)
{
    long sum = 0;
    for (size_t z = 0; z + 1 < p->dim[2]; z++)
        for (size_t y = 0; y + 1 < p->dim[1]; y++)
            for (size_t w = 0; w < p->words; w++) {
                uint64_t at[8];
                for (unsigned n = 0; n < 4; n++) {
                    const uint64_t *row = picture_row(p, y + (n & 1), z + (n >> 1));
                    at[2 * n] = row[w];
                    at[2 * n + 1] = row[w] >> 1 | (w + 1 < p->words ? row[w + 1] << 63 : 0);
                }
                if (at[0])
                    sum += count_simplices(at);
            }
    return sum;
}

/* Points of one side without a gap between them, in a row. */
typedef struct run {
    size_t first, last;
} run;

typedef struct run_list {
    run *items;
    size_t *sets;
    size_t *row_begin; /* of row r: items row_begin[r] to row_begin[r + 1] */
    size_t sets_left;
} run_list;

/* Where a run begins or ends: at points that differ from the one before. */
static size_t find_runs(const uint64_t *row, size_t length, uint64_t invert, run *out)
{
    size_t count = 0;
    bool inside = false;
    for (size_t w = 0; 64 * w < length; w++) {
        uint64_t changes = (row[w] ^ invert) ^ ((row[w] ^ invert) << 1 | (uint64_t)inside);
        if (length < 64 * w + 64)
            changes &= (UINT64_C(1) << length % 64) - 1;
        for (; changes; changes &= changes - 1) {
            const size_t x = 64 * w + (size_t)__builtin_ctzll(changes);
            if (inside)
                out[count++].last = x - 1;
            else
                out[count].first = x;
            inside = !inside;
        }
    }
    if (inside)
        out[count++].last = length - 1;
    return count;
}

/* A point at x touches those at x and x - 1 in each of the three rows before its own. */
static void join_rows(run_list *l, size_t row, size_t other)
{
    size_t b = l->row_begin[other];
    const size_t end = l->row_begin[other + 1];
    for (size_t a = l->row_begin[row]; a < l->row_begin[row + 1]; a++) {
        while (b < end && l->items[b].last + 1 < l->items[a].first)
            b++;
        for (size_t n = b; n < end && l->items[n].first <= l->items[a].last; n++)
            l->sets_left -= test_sets_join(l->sets, a, n);
    }
}

/* Components of the inside, or (inverted) of the outside with all that is around the grid. */
static size_t picture_components(const picture *p, uint64_t invert)
{
    const size_t rows = p->dim[1] * p->dim[2];
    size_t count = 0, room = 4 * rows + LONGEST;
    run_list l = {.items = malloc(room * sizeof *l.items),
                  .row_begin = malloc((rows + 1) * sizeof *l.row_begin)};
    for (size_t r = 0; r < rows; r++) {
        l.row_begin[r] = count;
        if (count + LONGEST > room)
            l.items = realloc(l.items, (room = 2 * room) * sizeof *l.items);
        assert(l.items && l.row_begin);
        count += find_runs(p->bits + r * p->words, p->dim[0], invert, l.items + count);
    }
    l.row_begin[rows] = l.sets_left = count;
    l.sets = malloc((count + 1) * sizeof *l.sets);
    assert(l.sets);
    test_sets_start(l.sets, count);
    for (size_t z = 0; z < p->dim[2]; z++)
        for (size_t y = 0; y < p->dim[1]; y++) {
            const size_t r = z * p->dim[1] + y;
            if (y > 0)
                join_rows(&l, r, r - 1);
            if (z > 0)
                join_rows(&l, r, r - p->dim[1]);
            if (y > 0 && z > 0)
                join_rows(&l, r, r - p->dim[1] - 1);
        }
    free(l.items);
    free(l.row_begin);
    free(l.sets);
    return l.sets_left;
}

test_truth test_topology_pictured(const float *voxels, const size_t dim[3], float iso,
                                  size_t points)
{
    assert(points >= 2 && points <= 64 && dim[0] <= 16 && dim[1] <= 16 && dim[2] <= 16);
    const picture p = paint(voxels, dim, iso, points);
    const test_truth t = {.decidable = true,
                          .euler = 2 * picture_euler(&p),
                          .components = picture_components(&p, 0) +
                                        picture_components(&p, ~UINT64_C(0)) - 1};
    free(p.bits);
    return t;
}

static bool same(const test_truth *a, const test_truth *b)
{
    return a->components == b->components && a->euler == b->euler;
}

test_truth test_topology_of(const float *voxels, const size_t dim[3], float iso)
{
    test_truth truth = test_topology_counted(voxels, dim, iso);
    int agreed = 0;
    for (size_t points = 8; truth.decidable && agreed < 2; points *= 2) {
        if (points > 64) {
            truth.decidable = false;
            break;
        }
        const test_truth seen = test_topology_pictured(voxels, dim, iso, points);
        agreed = same(&seen, &truth) ? agreed + 1 : 0;
    }
    return truth;
}

test_truth test_topology_tied(const float *voxels, const size_t dim[3], float iso, float step)
{
    const test_truth at = test_topology_counted(voxels, dim, iso);
    test_truth below = test_topology_of(voxels, dim, iso - step);
    below.decidable = below.decidable && at.decidable && same(&at, &below);
    return below;
}
