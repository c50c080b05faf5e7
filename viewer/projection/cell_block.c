/* Draws a block of cells in a tile of the picture. Faces are not cut into polygons: a sample is
 * in a cell's piece where its ray enters by one of the front faces and leaves by one of the back
 * faces, which six products tell. */
#include "viewer/projection/cell_block.h"

#include <math.h>

enum { SIDE = CWI_BLOCK_SIDE, WIDE = CWI_BLOCK_WIDE, EDGE = CWI_RANGE_EDGE };

/* Rounding of projected positions stays below this, in samples. */
static const float MARGIN = 1 / 32.0f;

/* A block that is being drawn. Corner (x, y, z) is number (z * SIDE + y) * SIDE + x. */
typedef struct block {
    cwi_tile *tile;
    cwi_linear_cell *linear; /* NULL: depth is linear over polygons, not opacity */
    size_t first[3];
    int cells[3];  /* along each axis */
    double low[3]; /* its corner in index space */
    float values[CWI_BLOCK_CORNERS];
    cwi_lanes gradients[CWI_BLOCK_CORNERS];
    cwi_lanes projected[CWI_BLOCK_CORNERS]; /* homogeneous; if not cut: x, y, -x, -y */
    bool is_cut;                            /* by the near plane */
    float ranges[2][CWI_BLOCK_CELLS];       /* lowest and highest value of each cell */
    uint64_t is_visible;                    /* a bit for each cell */
} block;

/* A node: cells from `first` to first + count of the block. */
typedef struct node {
    int first[3], count[3], edge;
} node;

static int clamp_whole(float x, int high)
{
    const float limited = x < -2 ? -2 : x > (float)high ? (float)high : x;
    return (int)(limited + 2) - 2; /* rounds down */
}

/* Finds the samples between two corners of a rectangle, given as -x, -y, x, y. */
static cwi_tile_box box_of_bounds(const cwi_tile *t, cwi_lanes max)
{
    cwi_tile_box box;
    const int size[2] = {t->width, t->height};
    for (int a = 0; a < 2; a++) {
        const int low = clamp_whole(-max[a] - MARGIN - 0.5f, size[a]) + 1;
        const int high = clamp_whole(max[a + 2] + MARGIN - 0.5f, size[a]);
        box.low[a] = low > 0 ? low : 0;
        box.high[a] = high < size[a] ? high : size[a] - 1;
    }
    return box;
}

static cwi_lanes divide_depth(cwi_lanes p)
{
    const float x = p[0] / p[2], y = p[1] / p[2];
    return (cwi_lanes){-x, -y, x, y};
}

/* Finds the samples that eight homogeneous positions may cover, some of which are behind the near
 * plane: none if all are beyond one side of the tile, else all. */
static cwi_tile_box box_of_cut(const cwi_tile *t, const cwi_lanes projected[8])
{
    bool out[5] = {true, true, true, true, true};
    const float near_depth = (float)t->near_depth;
    for (int n = 0; n < 8; n++) {
        const cwi_lanes p = projected[n];
        out[0] = out[0] && p[0] < -MARGIN * fabsf(p[2]);
        out[1] = out[1] && p[1] < -MARGIN * fabsf(p[2]);
        out[2] = out[2] && p[0] - (float)t->width * p[2] > MARGIN * fabsf(p[2]);
        out[3] = out[3] && p[1] - (float)t->height * p[2] > MARGIN * fabsf(p[2]);
        out[4] = out[4] && p[2] < near_depth;
    }
    const bool is_out = out[0] || out[1] || out[2] || out[3] || out[4];
    return is_out ? (cwi_tile_box){{0, 0}, {-1, -1}}
                  : (cwi_tile_box){{0, 0}, {t->width - 1, t->height - 1}};
}

/* Computes the homogeneous position of a point of index space. */
static cwi_lanes project_point(const cwi_tile *t, const double p[3])
{
    cwi_lanes projected = {0};
    for (int r = 0; r < 3; r++) {
        const double *m = t->pixel_from_index[r];
        projected[r] = (float)(m[0] * p[0] + m[1] * p[1] + m[2] * p[2] + m[3]);
    }
    return projected;
}

cwi_tile_box cwi_tile_project(const cwi_tile *t, const double low[3], const double high[3])
{
    cwi_lanes projected[8], max = cwi_lanes_spread(-INFINITY);
    bool is_cut = false;
    for (int n = 0; n < 8; n++) {
        const double p[3] = {n & 1 ? high[0] : low[0], n & 2 ? high[1] : low[1],
                             n & 4 ? high[2] : low[2]};
        projected[n] = project_point(t, p);
        is_cut = is_cut || !(projected[n][2] >= (float)t->near_depth);
    }
    if (is_cut)
        return box_of_cut(t, projected);
    for (int n = 0; n < 8; n++)
        max = cwi_lanes_max(max, divide_depth(projected[n]));
    return box_of_bounds(t, max);
}

static uint32_t row_bits(const cwi_tile_box *box)
{
    return UINT32_MAX << box->low[0] & UINT32_MAX >> (CWI_TILE_EDGE - 1 - box->high[0]);
}

bool cwi_tile_is_live(const cwi_tile *t, const cwi_tile_box *box)
{
    uint32_t any = 0;
    if (box->high[0] < box->low[0])
        return false;
    for (int y = box->low[1]; y <= box->high[1]; y++)
        any |= t->live[y];
    return any & row_bits(box);
}

/* Loads the samples of the block from the frame's volume or from that of its gradients, and
 * those around it: beyond the volume's border its last ones are repeated.
 * ends  the first and last number along each axis that are samples of the volume */
static void load_samples(const block *b, const cw_volume *v, float samples[WIDE * WIDE * WIDE],
                         int ends[3][2])
{
    const cwi_cell_model *m = b->tile->model;
    const int around = m->needs_gradients ? 1 : 0;
    float read[WIDE * WIDE * WIDE];
    size_t first[3], count[3];
    for (int a = 0; a < 3; a++) {
        const size_t from = b->first[a], left = v->dim[a] - from;
        const int before = around && from > 0 ? 1 : 0;
        const size_t after = (size_t)(SIDE + around);
        ends[a][0] = 1 - before;
        ends[a][1] = (int)(left < after ? left : after);
        first[a] = from - (size_t)before;
        count[a] = (size_t)(ends[a][1] - ends[a][0] + 1);
    }
    cwi_lattice_load(v, &m->tables->table, first, count, read);
    for (int z = 0; z < WIDE; z++)
        for (int y = 0; y < WIDE; y++) {
            const int at[2] = {y, z};
            size_t row = 0;
            for (int a = 2; a > 0; a--) {
                const int n = at[a - 1] < ends[a][0]   ? ends[a][0]
                              : at[a - 1] > ends[a][1] ? ends[a][1]
                                                       : at[a - 1];
                row = row * count[a] + (size_t)(n - ends[a][0]);
            }
            float *to = samples + (z * WIDE + y) * WIDE;
            const float *from = read + row * count[0];
            memcpy(to + ends[0][0], from, count[0] * sizeof *to);
            for (int x = 0; x < ends[0][0]; x++)
                to[x] = from[0];
            for (int x = ends[0][1] + 1; x < WIDE; x++)
                to[x] = from[count[0] - 1];
        }
}

/* Computes gradients at the corners: central differences, one-sided at the volume's border, 0
 * where a sample has no value. */
static void find_gradients(block *b, const float samples[WIDE * WIDE * WIDE], int ends[3][2])
{
    static const int step[3] = {1, WIDE, WIDE * WIDE};
    float scale[3][SIDE];
    for (int a = 0; a < 3; a++)
        for (int n = 0; n < SIDE; n++) {
            const int apart = (n + 1 > ends[a][0]) + (n + 1 < ends[a][1]);
            scale[a][n] = apart > 0 ? 1 / (float)apart : 0;
        }
    for (int n = 0; n < CWI_BLOCK_CORNERS; n++) {
        const int at[3] = {n % SIDE, n / SIDE % SIDE, n / SIDE / SIDE};
        const float *p = samples + ((at[2] + 1) * WIDE + at[1] + 1) * WIDE + at[0] + 1;
        cwi_lanes g = {(p[step[0]] - p[-step[0]]) * scale[0][at[0]],
                       (p[step[1]] - p[-step[1]]) * scale[1][at[1]],
                       (p[step[2]] - p[-step[2]]) * scale[2][at[2]], 0};
        for (int a = 0; a < 3 && b->tile->has_gaps; a++)
            g[a] = isfinite(g[a]) ? g[a] : 0;
        b->gradients[n] = g;
    }
}

static void load_values(block *b)
{
    float samples[WIDE * WIDE * WIDE];
    int ends[3][2];
    const cwi_frame *f = b->tile->model->frame;
    load_samples(b, &f->volume, samples, ends);
    for (int n = 0; n < SIDE * SIDE; n++)
        memcpy(b->values + n * SIDE,
               samples + ((n / SIDE + 1) * WIDE + n % SIDE + 1) * WIDE + 1,
               SIDE * sizeof *b->values);
    if (b->tile->model->needs_gradients && f->gradient_version)
        load_samples(b, &f->gradient_volume, samples, ends);
    if (b->tile->model->needs_gradients)
        find_gradients(b, samples, ends);
}

/* Projects the corners. */
static void place_corners(block *b)
{
    const cwi_tile *t = b->tile;
    const cwi_lanes base = project_point(t, b->low);
    cwi_lanes along[3];
    for (int a = 0; a < 3; a++)
        along[a] =
            (cwi_lanes){(float)t->pixel_from_index[0][a], (float)t->pixel_from_index[1][a],
                        (float)t->pixel_from_index[2][a], 0};
    b->is_cut = false;
    for (int n = 0; n < CWI_BLOCK_CORNERS; n++) {
        b->projected[n] = base + (float)(n % SIDE) * along[0] +
                          (float)(n / SIDE % SIDE) * along[1] +
                          (float)(n / SIDE / SIDE) * along[2];
        b->is_cut = b->is_cut || !(b->projected[n][2] >= (float)t->near_depth);
    }
    for (int n = 0; n < CWI_BLOCK_CORNERS && !b->is_cut; n++)
        b->projected[n] = divide_depth(b->projected[n]);
}

static float lesser(float a, float b)
{
    return a < b ? a : b;
}

static float greater(float a, float b)
{
    return a > b ? a : b;
}

/* Finds the range of each cell, axis by axis, and which cells show something. A cell with a
 * corner without a value is empty. */
static void find_ranges(block *b)
{
    const cwi_visible *visible = &b->tile->model->tables->visible;
    float x[2][EDGE * SIDE * SIDE], y[2][EDGE * EDGE * SIDE];
    const float *v = b->values;
    for (int n = 0; n < SIDE * SIDE; n++)
        for (int i = 0; i < EDGE; i++) {
            x[0][n * EDGE + i] = lesser(v[n * SIDE + i], v[n * SIDE + i + 1]);
            x[1][n * EDGE + i] = greater(v[n * SIDE + i], v[n * SIDE + i + 1]);
        }
    for (int k = 0; k < SIDE; k++)
        for (int i = 0; i < EDGE * EDGE; i++) {
            const int from = k * SIDE * EDGE + i, to = k * EDGE * EDGE + i;
            y[0][to] = lesser(x[0][from], x[0][from + EDGE]);
            y[1][to] = greater(x[1][from], x[1][from + EDGE]);
        }
    b->is_visible = 0;
    for (int n = 0; n < CWI_BLOCK_CELLS; n++) {
        const int at[3] = {n % EDGE, n / EDGE % EDGE, n / EDGE / EDGE};
        b->ranges[0][n] = lesser(y[0][n], y[0][n + EDGE * EDGE]);
        b->ranges[1][n] = greater(y[1][n], y[1][n + EDGE * EDGE]);
        const bool is_there = at[0] < b->cells[0] && at[1] < b->cells[1] && at[2] < b->cells[2];
        if (is_there && cwi_visible_any(visible, b->ranges[0][n], b->ranges[1][n]))
            b->is_visible |= (uint64_t)1 << n;
    }
}

static int corner_number(const int at[3])
{
    return (at[2] * SIDE + at[1]) * SIDE + at[0];
}

/* Makes the cells of empty corners invisible, and marks their ranges. */
static void leave_out_gaps(block *b)
{
    for (int n = 0; n < CWI_BLOCK_CELLS; n++) {
        const int at[3] = {n % EDGE, n / EDGE % EDGE, n / EDGE / EDGE};
        float sum = 0;
        for (int c = 0; c < 8; c++)
            sum += b->values[corner_number(
                (int[]){at[0] + (c & 1), at[1] + (c >> 1 & 1), at[2] + (c >> 2)})];
        if (isfinite(sum))
            continue;
        b->is_visible &= ~((uint64_t)1 << n);
        b->ranges[0][n] = b->ranges[1][n] = NAN;
    }
}

/* Makes a node a cell; its corners are those of its first and last cells. */
static void make_cell(const block *b, const node *n, int corners[8], cwi_projected_cell *c)
{
    float v[8];
    for (int i = 0; i < 8; i++) {
        int at[3];
        for (int a = 0; a < 3; a++)
            at[a] = n->first[a] + (i >> a & 1 ? n->count[a] : 0);
        corners[i] = corner_number(at);
        v[i] = b->values[corners[i]];
    }
    for (int i = 0; i < 8 && b->tile->model->needs_gradients; i++)
        c->gradient[i] = b->gradients[corners[i]];
    c->even = (cwi_lanes){v[0], v[2], v[4], v[6]};
    c->odd = (cwi_lanes){v[1], v[3], v[5], v[7]};
    c->low = (cwi_lanes){(float)(b->low[0] + n->first[0]), (float)(b->low[1] + n->first[1]),
                         (float)(b->low[2] + n->first[2]), 0};
    c->size = (cwi_lanes){(float)n->count[0], (float)n->count[1], (float)n->count[2], 1};
    c->inverse = 1 / c->size;
}

static cwi_tile_box find_box(const block *b, const int corners[8])
{
    cwi_lanes projected[8], max;
    for (int n = 0; n < 8; n++)
        projected[n] = b->projected[corners[n]];
    if (b->is_cut)
        return box_of_cut(b->tile, projected);
    max = cwi_lanes_max(projected[0], projected[1]);
    for (int n = 2; n < 8; n++)
        max = cwi_lanes_max(max, projected[n]);
    return box_of_bounds(b->tile, max);
}

/* Draws a node over the live samples of a rectangle. */
static void fill_node(const block *b, const cwi_projected_cell *c, const cwi_tile_box *box)
{
    cwi_tile *tile = b->tile;
    const uint32_t bits = row_bits(box);
    for (int y = box->low[1]; y <= box->high[1]; y++)
        for (uint32_t left = tile->live[y] & bits; left; left &= left - 1) {
            const int x = __builtin_ctz(left);
            cwi_cell_ray *ray = &tile->rays[y * CWI_TILE_EDGE + x];
            cwi_lanes linear;
            float t[2];
            if (!cwi_cell_meets(c, ray, t))
                continue;
            if (b->linear)
                linear = cwi_linear_at(b->linear, (float)x + 0.5f, (float)y + 0.5f);
            cwi_cell_pass(tile->model, c, t, b->linear ? &linear : NULL, ray);
            if (ray->light < tile->min_light)
                tile->live[y] &= ~((uint32_t)1 << x);
        }
}

static void draw_node(const block *b, const node *n)
{
    int corners[8];
    cwi_projected_cell cell;
    make_cell(b, n, corners, &cell);
    const cwi_tile_box box = find_box(b, corners);
    if (!cwi_tile_is_live(b->tile, &box))
        return;
    if (b->linear)
        cwi_linear_make(b->linear, &cell);
    fill_node(b, &cell, &box);
}

/* Finds the range of a node's cells; returns false if some have no value. */
static bool find_range(const block *b, const node *n, float range[2])
{
    range[0] = INFINITY;
    range[1] = -INFINITY;
    bool is_whole = true;
    for (int z = n->first[2]; z < n->first[2] + n->count[2]; z++)
        for (int y = n->first[1]; y < n->first[1] + n->count[1]; y++)
            for (int x = n->first[0]; x < n->first[0] + n->count[0]; x++) {
                const int c = (z * EDGE + y) * EDGE + x;
                is_whole = is_whole && b->ranges[0][c] == b->ranges[0][c];
                range[0] = lesser(b->ranges[0][c], range[0]);
                range[1] = greater(b->ranges[1][c], range[1]);
            }
    return is_whole;
}

static float clamp_unit(float x)
{
    return x < 0 ? 0 : x > 1 ? 1 : x;
}

/* Returns true if a node can be drawn as one cell: its values are similar, and all there. */
static bool is_alike(const block *b, const node *n)
{
    float range[2];
    return b->tile->tolerance >= 0 && find_range(b, n, range) &&
           clamp_unit(range[1]) - clamp_unit(range[0]) <= 2 * b->tile->tolerance;
}

static uint64_t node_bits(const node *n)
{
    static const uint64_t rows[EDGE + 1] = {0, 0x1, 0x3, 0x7, 0xf};
    uint64_t bits = 0;
    for (int z = n->first[2]; z < n->first[2] + n->count[2]; z++)
        for (int y = n->first[1]; y < n->first[1] + n->count[1]; y++)
            bits |= rows[n->count[0]] << ((z * EDGE + y) * EDGE + n->first[0]);
    return bits;
}

/* Visits a node's parts, the nearest first: a plane between two parts has the eye on one
 * side. */
static void visit_node(const block *b, const node *n)
{
    const int half = n->edge / 2;
    bool high_first[3];
    if (!(b->is_visible & node_bits(n)))
        return;
    if (n->edge == 1 || is_alike(b, n)) {
        draw_node(b, n);
        return;
    }
    for (int a = 0; a < 3; a++)
        high_first[a] = b->tile->eye[a] > b->low[a] + n->first[a] + half;
    for (int p = 0; p < 8; p++) {
        node part = {.edge = half};
        bool is_there = true;
        for (int a = 0; a < 3; a++) {
            const int skip = (p >> a & 1) != high_first[a] ? half : 0;
            const int left = n->count[a] - skip;
            part.first[a] = n->first[a] + skip;
            part.count[a] = left < half ? left : half;
            is_there = is_there && left > 0;
        }
        if (is_there)
            visit_node(b, &part);
    }
}

void cwi_block_draw(cwi_tile *tile, cwi_linear_cell *linear, const size_t first[3])
{
    const cwi_frame *f = tile->model->frame;
    block b;
    node whole = {.edge = EDGE};
    b.tile = tile;
    b.linear = linear;
    for (int a = 0; a < 3; a++) {
        const size_t cells = f->volume.dim[a] > 1 ? f->volume.dim[a] - 1 : 1;
        const size_t left = cells - first[a];
        b.first[a] = first[a];
        b.low[a] = f->low[a] + (double)first[a];
        b.cells[a] = whole.count[a] = (int)(left < EDGE ? left : EDGE);
    }
    load_values(&b);
    find_ranges(&b);
    if (tile->has_gaps)
        leave_out_gaps(&b);
    if (!b.is_visible)
        return;
    place_corners(&b);
    visit_node(&b, &whole);
}
