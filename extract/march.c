#include "extract/march.h"

#include "core/affine.h"
#include "core/status.h"
#include "extract/ambiguous.h"
#include "extract/cases.h"
#include "extract/cube.h"
#include "extract/typed.h"

#include <math.h>

static inline int popcount(uint64_t x)
{
    return __builtin_popcountll(x);
}

/* Live cells of word w in row (j, k) of cells; none outside the grid. */
static uint64_t live_cells(const cwi_grid *g, size_t j, size_t k, size_t w)
{
    if (j >= g->rows_y - 1 || k >= g->rows_z - 1) /* true for the row before the first, too */
        return 0;
    return g->live[(k * g->rows_y + j) * g->words + w];
}

/* With open borders an edge has a vertex only if one of the four cells around it is live. */
static uint64_t live_edges(const cwi_grid *g, int axis, size_t j, size_t k, size_t w)
{
    if (axis == 0)
        return live_cells(g, j, k, w) | live_cells(g, j - 1, k, w) |
               live_cells(g, j, k - 1, w) | live_cells(g, j - 1, k - 1, w);
    const size_t dj = axis == 2, dk = axis == 1;
    const uint64_t here = live_cells(g, j, k, w) | live_cells(g, j - dj, k - dk, w);
    const uint64_t before =
        w ? live_cells(g, j, k, w - 1) | live_cells(g, j - dj, k - dk, w - 1) : 0;
    return here | here << 1 | before >> 63;
}

/* Bit i: there is a vertex on the edge along axis from sample i of row (j, k). */
static inline uint64_t edge_vertices(const cwi_grid *g, int axis, size_t j, size_t k, size_t w)
{
    const uint64_t crossed = cwi_grid_crossed(g, axis, j, k, w);
    return g->live ? crossed & live_edges(g, axis, j, k, w) : crossed;
}

/* The four rows of samples around a row of cells, one word of them. */
typedef struct cell_word {
    uint64_t here[4], next[4]; /* row y + 2 z: samples i, and samples i + 1 */
    uint64_t active;           /* cells whose corners are not all alike */
} cell_word;

static inline cell_word load_cells(const cwi_grid *g, size_t j, size_t k, size_t w)
{
    cell_word c;
    uint64_t any = 0, all = ~UINT64_C(0);
    for (size_t n = 0; n < 4; n++) {
        const uint64_t *row = cwi_grid_row(g, (k + (n >> 1)) * g->rows_y + j + (n & 1));
        c.here[n] = row[w];
        c.next[n] = cwi_next_samples(row, w, g->words);
        any |= c.here[n] | c.next[n];
        all &= c.here[n] & c.next[n];
    }
    c.active = any & ~all;
    if (g->live)
        c.active &= live_cells(g, j, k, w);
    return c;
}

static inline unsigned cell_case(const cell_word *c, int i)
{
    unsigned cube = 0;
    for (int n = 0; n < 4; n++)
        cube |= (unsigned)(c->here[n] >> i & 1) << 2 * n | (unsigned)(c->next[n] >> i & 1)
                                                               << (2 * n + 1);
    return cube;
}

static void count_ambiguous(const cwi_grid *g, const size_t at[3], unsigned cube, cwi_row *row)
{
    cwi_ambiguous cell;
    cwi_ambiguous_load(g, at, cube, &cell);
    row->triangle += (size_t)cell.plan.triangle_count;
    row->first[3] += (uint32_t)cell.plan.vertex_count;
}

/* Leaves counts, not yet first numbers, in the row. */
static void count_row(const cwi_grid *g, size_t j, size_t k, cwi_row *row)
{
    for (int axis = 0; axis < 3; axis++) {
        unsigned count = 0;
        for (size_t w = 0; w < g->words; w++)
            count += (unsigned)popcount(edge_vertices(g, axis, j, k, w));
        row->first[axis] = count;
    }
    row->triangle = row->first[3] = 0;
    if (j + 1 == g->rows_y || k + 1 == g->rows_z)
        return;
    for (size_t w = 0; w < g->words; w++) {
        const cell_word c = load_cells(g, j, k, w);
        for (uint64_t left = c.active; left; left &= left - 1) {
            const int i = __builtin_ctzll(left);
            const unsigned cube = cell_case(&c, i);
            if (cwi_case_is_ambiguous[cube] && !g->simple)
                count_ambiguous(g, (const size_t[3]){64 * w + (size_t)i, j, k}, cube, row);
            else
                row->triangle += cwi_case_count[cube];
        }
    }
}

static cw_status sum_rows(cwi_row *rows, size_t count, size_t *vertices, size_t *triangles,
                          cw_error *err)
{
    size_t v = 0, t = 0;
    for (size_t r = 0; r < count; r++) {
        const size_t triangles_here = rows[r].triangle;
        for (int kind = 0; kind < 4; kind++) {
            const uint32_t here = rows[r].first[kind];
            rows[r].first[kind] = (uint32_t)v;
            v += here;
        }
        rows[r].triangle = t;
        t += triangles_here;
    }
    *vertices = v;
    *triangles = t;
    if (v > UINT32_MAX)
        return cw_fail(err, CW_ERR_LIMIT, "the surface has %zu vertices; a mesh holds %u", v,
                       UINT32_MAX);
    return CW_OK;
}

static cwi_pace grid_pace(const cwi_grid *g, const cw_extract_desc *desc)
{
    return cwi_pace_of(g->rows_z, g->rows_y * g->words * 64, desc->threads);
}

cw_status cwi_march_count(const cwi_grid *g, const cw_extract_desc *desc, cwi_row *rows,
                          size_t *vertices, size_t *triangles, cw_error *err)
{
    const cwi_pace pace = grid_pace(g, desc);
    for (size_t begin = 0; begin < g->rows_z; begin += pace.layers) {
        const size_t end = begin + pace.layers < g->rows_z ? begin + pace.layers : g->rows_z;
        cw_status st =
            cwi_progress(&desc->progress, "counting", (double)begin / (double)g->rows_z, err);
        if (st != CW_OK)
            return st;
#pragma omp parallel for schedule(dynamic) num_threads(pace.threads)
        for (size_t k = begin; k < end; k++)
            for (size_t j = 0; j < g->rows_y; j++)
                count_row(g, j, k, &rows[k * g->rows_y + j]);
    }
    return sum_rows(rows, g->rows, vertices, triangles, err);
}

static void write_vertices(const cwi_grid *g, size_t j, size_t k, const cwi_row *row,
                           const cwi_vertex_sink *sink)
{
    const cwi_typed *typed = cwi_typed_of(g->volume.type);
    for (int axis = 0; axis < 3; axis++) {
        size_t v = row->first[axis];
        for (size_t w = 0; w < g->words; w++)
            for (uint64_t left = edge_vertices(g, axis, j, k, w); left; left &= left - 1) {
                const size_t at[3] = {64 * w + (size_t)__builtin_ctzll(left), j, k};
                typed->vertex(g, at, axis, sink, v++);
            }
    }
}

/* A row of edges beside a row of cells: its crossings in the current word, and the number of
 * the first vertex in that word. */
typedef struct edge_row {
    int axis;
    size_t j, k;
    uint64_t crossed;
    uint32_t first;
} edge_row;

/* The number of the vertex on the edge from sample i: how many crossings come before it. */
static inline uint32_t rank(const edge_row *e, int i)
{
    return e->first + (uint32_t)popcount(e->crossed & ((UINT64_C(1) << i) - 1));
}

/* The vertices on the 12 edges of cell i: where they would be numbered if crossed. */
static inline void cell_vertices(const edge_row e[8], int i, uint32_t vertex[12])
{
    for (int n = 0; n < 4; n++)
        vertex[n] = rank(&e[n], i);
    for (int n = 0; n < 2; n++) {
        const edge_row *y = &e[4 + n], *z = &e[6 + n];
        vertex[4 + 2 * n] = rank(y, i);
        vertex[5 + 2 * n] = vertex[4 + 2 * n] + (uint32_t)(y->crossed >> i & 1);
        vertex[8 + 2 * n] = rank(z, i);
        vertex[9 + 2 * n] = vertex[8 + 2 * n] + (uint32_t)(z->crossed >> i & 1);
    }
}

/* Puts one triangle; mirrored frames turn it round. */
static inline uint32_t *put_triangle(uint32_t *out, uint32_t a, uint32_t b, uint32_t c,
                                     bool flip)
{
    out[0] = a;
    out[1] = flip ? c : b;
    out[2] = flip ? b : c;
    return out + 3;
}

/* vertex: of the 12 edges, and room for the inner ones, which are numbered from *inner on. */
static uint32_t *write_ambiguous(const cwi_grid *g, const size_t at[3], unsigned cube,
                                 const cwi_vertex_sink *sink, bool flip, uint32_t *vertex,
                                 uint32_t *inner, uint32_t *out)
{
    cwi_ambiguous ambiguous;
    cwi_cell cell;
    cwi_ambiguous_load(g, at, cube, &ambiguous);
    cwi_ambiguous_build(g, &ambiguous, sink, *inner, &cell);
    for (int n = 0; n < ambiguous.plan.vertex_count; n++)
        vertex[CWI_CELL_INNER + n] = (*inner)++;
    const uint8_t *corner = cell.triangles;
    for (int t = 0; t < ambiguous.plan.triangle_count; t++, corner += 3)
        out = put_triangle(out, vertex[corner[0]], vertex[corner[1]], vertex[corner[2]], flip);
    return out;
}

static void write_triangles(const cwi_grid *g, size_t j, size_t k, const cwi_row *rows,
                            const cwi_vertex_sink *sink, bool flip, uint32_t *out)
{
    /* the 8 rows of edges: x-edges of four rows, y-edges at z 0 and 1, z-edges at y 0 and 1 */
    edge_row e[8] = {{0, j, k, 0, 0},         {0, j + 1, k, 0, 0}, {0, j, k + 1, 0, 0},
                     {0, j + 1, k + 1, 0, 0}, {1, j, k, 0, 0},     {1, j, k + 1, 0, 0},
                     {2, j, k, 0, 0},         {2, j + 1, k, 0, 0}};
    uint32_t inner = rows[k * g->rows_y + j].first[3];
    for (int n = 0; n < 8; n++)
        e[n].first = rows[e[n].k * g->rows_y + e[n].j].first[e[n].axis];
    for (size_t w = 0; w < g->words; w++) {
        const cell_word c = load_cells(g, j, k, w);
        for (int n = 0; n < 8; n++)
            e[n].crossed = edge_vertices(g, e[n].axis, e[n].j, e[n].k, w);
        for (uint64_t left = c.active; left; left &= left - 1) {
            const int i = __builtin_ctzll(left);
            const unsigned cube = cell_case(&c, i);
            uint32_t vertex[12 + CWI_CELL_MAX_VERTICES];
            cell_vertices(e, i, vertex);
            if (cwi_case_is_ambiguous[cube] && !g->simple) {
                const size_t at[3] = {64 * w + (size_t)i, j, k};
                out = write_ambiguous(g, at, cube, sink, flip, vertex, &inner, out);
                continue;
            }
            const uint8_t *corner = cwi_case_triangles[cube];
            for (int t = 0; t < cwi_case_count[cube]; t++, corner += 3)
                out = put_triangle(out, vertex[corner[0]], vertex[corner[1]], vertex[corner[2]],
                                   flip);
        }
        for (int n = 0; n < 8; n++)
            e[n].first += (uint32_t)popcount(e[n].crossed);
    }
}

/* Index gradients become outward world normals through the inverse transpose of the affine,
 * here as its cofactors; the sign holds the determinant's and the side that is inside. */
static cwi_vertex_sink make_sink(const cwi_grid *g, cw_mesh *mesh)
{
    const cw_volume *v = &g->volume;
    const double sign = (cwi_affine_determinant(v->affine[0]) < 0) != g->invert ? 1 : -1;
    cwi_vertex_sink sink = {.positions = mesh->positions, .normals = mesh->normals};
    double largest = 0;
    cwi_affine_cofactor(v->affine[0], sink.cofactor);
    for (int i = 0; i < 9; i++)
        largest = fmax(largest, fabs(sink.cofactor[i / 3][i % 3]));
    for (int r = 0; r < 3; r++) {
        for (int c = 0; c < 3; c++) {
            sink.affine[r][c] = v->affine[r][c];
            sink.cofactor[r][c] *= sign / largest;
        }
        sink.centre[r] = 0.5 * (double)(v->dim[r] - 1);
    }
    cwi_affine_apply(v->affine[0], sink.centre, mesh->origin);
    return sink;
}

cw_status cwi_march_write(const cwi_grid *g, const cw_extract_desc *desc, const cwi_row *rows,
                          cw_mesh *mesh, cw_error *err)
{
    const cwi_vertex_sink sink = make_sink(g, mesh);
    const bool flip = cwi_affine_determinant(g->volume.affine[0]) < 0;
    const cwi_pace pace = grid_pace(g, desc);
    for (size_t begin = 0; begin < g->rows_z; begin += pace.layers) {
        const size_t end = begin + pace.layers < g->rows_z ? begin + pace.layers : g->rows_z;
        cw_status st =
            cwi_progress(&desc->progress, "marching", (double)begin / (double)g->rows_z, err);
        if (st != CW_OK)
            return st;
#pragma omp parallel for schedule(dynamic) num_threads(pace.threads)
        for (size_t k = begin; k < end; k++)
            for (size_t j = 0; j < g->rows_y; j++) {
                const size_t r = k * g->rows_y + j;
                write_vertices(g, j, k, &rows[r], &sink);
                if (j + 1 < g->rows_y && k + 1 < g->rows_z)
                    write_triangles(g, j, k, rows, &sink, flip,
                                    mesh->triangles + 3 * rows[r].triangle);
            }
    }
    return CW_OK;
}
