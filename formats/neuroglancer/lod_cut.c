/* Cuts the triangles of a level at the planes of its octree. All positions are integers, so that a
 * cut of an edge depends on the edge alone, and the parts of a closed mesh close again. */
#include "formats/neuroglancer/lod_grid.h"

#include "core/base/memory.h"
#include "core/base/status.h"

#include <math.h>
#include <string.h>

enum { POLYGON = 8, NODE_BITS = 8, RADIX_BITS = 8, RADIX = 1 << RADIX_BITS };

typedef struct cutter {
    const cwi_lod_grid *grid;
    size_t level;      /* of detail */
    uint32_t cells[3]; /* along each axis: nodes, or halves of them above level 0 */
    cwi_lod_level *out;
} cutter;

void cwi_lod_free(cwi_lod_level *level)
{
    cwi_free(level->positions);
    cwi_free(level->pieces);
    *level = (cwi_lod_level){0};
}

/* --- nodes ------------------------------------------------------------------------------- */

static uint32_t interleave_bits(const uint32_t node[3])
{
    uint32_t code = 0;
    for (int b = 0; b < NODE_BITS; b++)
        for (int a = 0; a < 3; a++)
            code |= (node[a] >> b & 1) << (3 * b + a);
    return code;
}

void cwi_lod_node(uint32_t code, uint32_t node[3])
{
    for (int a = 0; a < 3; a++)
        node[a] = 0;
    for (int b = 0; b < NODE_BITS; b++)
        for (int a = 0; a < 3; a++)
            node[a] |= (code >> (3 * b + a) & 1) << b;
}

/* Returns the lower plane of a cell. */
static uint32_t find_plane(const cutter *c, uint32_t cell)
{
    const uint32_t steps = cwi_lod_steps(c->grid);
    return c->level == 0 ? cell * steps
                         : cell / 2 * steps + (cell % 2 ? cwi_lod_middle(c->grid) : 0);
}

/* Returns the cell that a position is in; on a plane, the one above it. */
static uint32_t find_cell(const cutter *c, uint32_t coordinate)
{
    const uint32_t steps = cwi_lod_steps(c->grid), node = coordinate / steps;
    return c->level == 0 ? node : 2 * node + (coordinate % steps >= cwi_lod_middle(c->grid));
}

/* Finds the cells that a range of positions has more than a border in. */
static void find_cells(const cutter *c, int axis, uint32_t low, uint32_t high, uint32_t *first,
                       uint32_t *last)
{
    const uint32_t end = c->cells[axis] - 1;
    uint32_t top = find_cell(c, high);
    *first = find_cell(c, low);
    if (top > *first && find_plane(c, top) == high)
        top--;
    *first = *first < end ? *first : end;
    *last = top < end ? top : end;
}

/* --- growing ----------------------------------------------------------------------------- */

static cw_status add_vertex(cutter *c, const uint32_t at[3], uint32_t *vertex, cw_error *err)
{
    cwi_lod_level *l = c->out;
    if (l->vertex_count >= UINT32_MAX)
        return cwi_fail(err, CW_ERR_LIMIT, "cutting makes more than 4294967295 vertices");
    if (l->vertex_count == l->vertex_capacity) {
        const size_t capacity = l->vertex_capacity + l->vertex_capacity / 2 + 64;
        uint32_t *positions = cwi_realloc_array(l->positions, capacity, 3 * sizeof *positions);
        if (!positions)
            return cwi_fail_memory(err);
        l->positions = positions;
        l->vertex_capacity = capacity;
    }
    memcpy(l->positions + 3 * l->vertex_count, at, 3 * sizeof *at);
    *vertex = (uint32_t)l->vertex_count++;
    return CW_OK;
}

static cw_status add_piece(cutter *c, const uint32_t vertex[3], const uint32_t cell[3],
                           cw_error *err)
{
    cwi_lod_level *l = c->out;
    uint32_t node[3];
    if (l->piece_count >= UINT32_MAX)
        return cwi_fail(err, CW_ERR_LIMIT, "cutting makes more than 4294967295 triangles");
    if (l->piece_count == l->piece_capacity) {
        const size_t capacity = l->piece_capacity + l->piece_capacity / 2 + 64;
        cwi_lod_piece *pieces = cwi_realloc_array(l->pieces, capacity, sizeof *pieces);
        if (!pieces)
            return cwi_fail_memory(err);
        l->pieces = pieces;
        l->piece_capacity = capacity;
    }
    for (int a = 0; a < 3; a++)
        node[a] = c->level == 0 ? cell[a] : cell[a] / 2;
    l->pieces[l->piece_count++] = (cwi_lod_piece){.vertex = {vertex[0], vertex[1], vertex[2]},
                                                  .node = interleave_bits(node)};
    return CW_OK;
}

/* --- cutting ----------------------------------------------------------------------------- */

static const uint32_t *place_of(const cutter *c, uint32_t vertex)
{
    return c->out->positions + 3 * (size_t)vertex;
}

static bool is_collapsed(const cutter *c, const uint32_t vertex[3])
{
    enum { BYTES = 3 * sizeof(uint32_t) };
    const uint32_t *p = place_of(c, vertex[0]), *q = place_of(c, vertex[1]),
                   *r = place_of(c, vertex[2]);
    return memcmp(p, q, BYTES) == 0 || memcmp(q, r, BYTES) == 0 || memcmp(r, p, BYTES) == 0;
}

/* Adds the vertex at which an edge crosses a plane, rounded. It starts at the lower end, so it
 * is the same for both directions of the edge. */
static cw_status cross_edge(cutter *c, uint32_t from, uint32_t to, int axis, uint32_t plane,
                            uint32_t *vertex, cw_error *err)
{
    uint32_t at[3];
    const bool is_rising = place_of(c, from)[axis] < place_of(c, to)[axis];
    const uint32_t *low = place_of(c, is_rising ? from : to),
                   *high = place_of(c, is_rising ? to : from);
    const int64_t length = (int64_t)high[axis] - low[axis], part = (int64_t)plane - low[axis];
    for (int a = 0; a < 3; a++) {
        /* rounding takes the absolute value: division rounds towards zero */
        const int64_t across = (int64_t)high[a] - low[a], size = across < 0 ? -across : across;
        const int64_t moved = (2 * size * part + length) / (2 * length);
        at[a] = (uint32_t)((int64_t)low[a] + (across < 0 ? -moved : moved));
    }
    return add_vertex(c, at, vertex, err);
}

/* Adds to a polygon the crossing of an edge with a plane, if there is one inside of the edge. */
static cw_status add_crossing(cutter *c, uint32_t from, uint32_t to, int axis, uint32_t plane,
                              uint32_t polygon[POLYGON], int *count, cw_error *err)
{
    const uint32_t a = place_of(c, from)[axis], b = place_of(c, to)[axis];
    if (!((a < plane && plane < b) || (b < plane && plane < a)))
        return CW_OK;
    return cross_edge(c, from, to, axis, plane, &polygon[(*count)++], err);
}

/* Clips a triangle to a cell along an axis; a convex polygon is left. */
static cw_status clip_to_cell(cutter *c, const uint32_t vertex[3], int axis, uint32_t cell,
                              uint32_t polygon[POLYGON], int *count, cw_error *err)
{
    const uint32_t low = find_plane(c, cell), high = find_plane(c, cell + 1);
    cw_status st = CW_OK;
    *count = 0;
    for (int k = 0; k < 3 && st == CW_OK; k++) {
        const uint32_t from = vertex[k], to = vertex[(k + 1) % 3];
        const uint32_t at = place_of(c, from)[axis];
        const bool is_rising = at < place_of(c, to)[axis];
        if (at >= low && at <= high)
            polygon[(*count)++] = from;
        st = add_crossing(c, from, to, axis, is_rising ? low : high, polygon, count, err);
        if (st == CW_OK)
            st = add_crossing(c, from, to, axis, is_rising ? high : low, polygon, count, err);
    }
    return st;
}

/* Cuts a triangle along an axis and those after it. cell: found along the axes before it */
static cw_status cut_along(cutter *c, const uint32_t vertex[3], int axis, uint32_t cell[3],
                           cw_error *err)
{
    uint32_t low = UINT32_MAX, high = 0, first, last, polygon[POLYGON];
    cw_status st = CW_OK;
    if (is_collapsed(c, vertex))
        return CW_OK;
    if (axis == 3)
        return add_piece(c, vertex, cell, err);
    for (int k = 0; k < 3; k++) {
        const uint32_t at = place_of(c, vertex[k])[axis];
        low = at < low ? at : low;
        high = at > high ? at : high;
    }
    find_cells(c, axis, low, high, &first, &last);
    cell[axis] = first;
    if (first == last)
        return cut_along(c, vertex, axis + 1, cell, err);
    c->out->is_cut = true;
    for (uint32_t n = first; n <= last && st == CW_OK; n++) {
        int count;
        st = clip_to_cell(c, vertex, axis, n, polygon, &count, err);
        for (int k = 2; k < count && st == CW_OK; k++) {
            const uint32_t fan[3] = {polygon[0], polygon[k - 1], polygon[k]};
            cell[axis] = n;
            st = cut_along(c, fan, axis + 1, cell, err);
        }
    }
    return st;
}

/* --- a level ----------------------------------------------------------------------------- */

/* Rounds the vertices to the lattice of the level. */
static cw_status round_vertices(cutter *c, const cwi_part *part, cw_error *err)
{
    cwi_lod_level *l = c->out;
    const double step = ldexp(c->grid->step_mm, (int)c->level);
    double worst = 0;
    l->vertex_capacity = part->mesh.vertex_count;
    l->positions = cwi_alloc_array(l->vertex_capacity, 3 * sizeof *l->positions);
    l->piece_capacity = part->mesh.triangle_count;
    l->pieces = cwi_alloc_array(l->piece_capacity, sizeof *l->pieces);
    if (!l->positions || !l->pieces)
        return cwi_fail_memory(err);
    for (size_t v = 0; v < part->mesh.vertex_count; v++) {
        double diagonal_sq = 0;
        for (int a = 0; a < 3; a++) {
            const double at = (cwi_file_coordinate(part, v, a) - c->grid->origin[a]) / step;
            const double rounded = floor(at + 0.5);
            l->positions[3 * v + (size_t)a] = rounded > 0 ? (uint32_t)rounded : 0;
            diagonal_sq += (rounded - at) * (rounded - at);
        }
        worst = diagonal_sq > worst ? diagonal_sq : worst;
    }
    l->vertex_count = part->mesh.vertex_count;
    l->move_mm = sqrt(worst) * step;
    return CW_OK;
}

/* Moves pieces in the order of some bits of their nodes; equal ones keep their order. */
static void sort_by_bits(const cwi_lod_piece *from, size_t count, int shift, cwi_lod_piece *to)
{
    size_t start[RADIX + 1] = {0};
    for (size_t i = 0; i < count; i++)
        start[(from[i].node >> shift) % RADIX + 1]++;
    for (int n = 0; n < RADIX; n++)
        start[n + 1] += start[n];
    for (size_t i = 0; i < count; i++)
        to[start[(from[i].node >> shift) % RADIX]++] = from[i];
}

static cw_status sort_pieces(cwi_lod_level *l, cw_error *err)
{
    uint32_t used = 0;
    for (size_t i = 0; i < l->piece_count; i++)
        used |= l->pieces[i].node;
    if (!used)
        return CW_OK;
    cwi_lod_piece *other = cwi_alloc_array(l->piece_count, sizeof *other);
    if (!other)
        return cwi_fail_memory(err);
    for (int shift = 0; shift < 3 * NODE_BITS && used >> shift; shift += RADIX_BITS) {
        cwi_lod_piece *from = l->pieces;
        sort_by_bits(from, l->piece_count, shift, other);
        l->pieces = other;
        other = from;
    }
    cwi_free(other);
    return CW_OK;
}

cw_status cwi_lod_cut(const cwi_lod_grid *grid, const cwi_part *part, cwi_lod_level *level,
                      cw_error *err)
{
    cutter c = {.grid = grid, .level = part->level, .out = level};
    *level = (cwi_lod_level){0};
    for (int a = 0; a < 3; a++) {
        const uint32_t times = part->level < 32 ? 1u << part->level : UINT32_MAX;
        const uint32_t nodes = (uint32_t)(((uint64_t)grid->nodes[a] + times - 1) / times);
        c.cells[a] = part->level == 0 ? nodes : 2 * nodes;
    }
    cw_status st = round_vertices(&c, part, err);
    for (size_t t = 0; t < part->mesh.triangle_count && st == CW_OK; t++) {
        const uint32_t *vertex = part->mesh.triangles + 3 * t;
        uint32_t cell[3];
        level->collapsed += is_collapsed(&c, vertex);
        st = cut_along(&c, vertex, 0, cell, err);
    }
    if (st == CW_OK)
        st = sort_pieces(level, err);
    if (st != CW_OK)
        cwi_lod_free(level);
    return st;
}
