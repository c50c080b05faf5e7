/* Converts divided cells to an irregular grid. */
#include "extract/level_set/adaptive_field.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/volume/volume.h"
#include "extract/level_set/level_set.h"

#include <math.h>
#include <string.h>

/* A cell that is not divided into smaller ones. It has 27 points, x fastest: corners, middles
 * of edges and of faces, and its own middle. Points exist that its neighbours have too, and
 * those that these need. */
typedef struct leaf {
    int size;
    uint32_t at[3];
    bool has[27];
    bool matters; /* its own point is needed, even if all others are on one side */
    bool cut[6];  /* faces beyond which there are smaller cells: 2 * axis + side */
} leaf;

/* The cells of the grid that is made; its samples are the points, all of them. */
typedef struct build {
    cwi_adaptive *a;
    cwi_lattice_map whole; /* voxels that may be crossed, not divided */
    uint8_t *shapes;
    uint32_t *corners;
    size_t count, capacity, corner_count, corner_capacity;
    bool out_of_memory;
} build;

enum { CENTRE = 13 };

static const int steps[3] = {1, 3, 9}; /* from point to point along the axes */

/* ---- leaves ------------------------------------------------------------------------------ */

static int lattice_coordinate(int n, int axis)
{
    return n / steps[axis] % 3;
}

static bool is_divided_beside(const build *b, const leaf *l, const int direction[3])
{
    uint32_t at[3];
    for (int a = 0; a < 3; a++)
        at[a] = l->at[a] + (uint32_t)direction[a];
    return cwi_adaptive_is_divided(b->a, l->size, at);
}

/* Returns true if one of the other three cells around an edge is divided. */
static bool is_edge_cut(const build *b, const leaf *l, const int direction[3])
{
    bool cut = is_divided_beside(b, l, direction);
    for (int a = 0; a < 3 && !cut; a++) {
        int beside[3] = {0, 0, 0};
        beside[a] = direction[a];
        cut = direction[a] && is_divided_beside(b, l, beside);
    }
    return cut;
}

static int middle_of_face(int face)
{
    return CENTRE + (face % 2 ? 1 : -1) * steps[face / 2];
}

/* Returns point n of the eight around a face, counter-clockwise seen from inside, from a corner
 * on. */
static int around_face(int face, int n)
{
    static const int direction[8][2] = {{-1, -1}, {0, -1}, {1, -1}, {1, 0},
                                        {1, 1},   {0, 1},  {-1, 1}, {-1, 0}};
    const int *w = direction[face % 2 ? 7 - (n + 7) % 8 : n % 8];
    return middle_of_face(face) + w[0] * steps[(face / 2 + 1) % 3] +
           w[1] * steps[(face / 2 + 2) % 3];
}

static void look_around_leaf(const build *b, leaf *l)
{
    l->matters = cwi_adaptive_is_divided(b->a, l->size, l->at);
    for (int n = 0; n < 27; n++) {
        const int direction[3] = {lattice_coordinate(n, 0) - 1, lattice_coordinate(n, 1) - 1,
                                  lattice_coordinate(n, 2) - 1};
        const int along = !direction[0] + !direction[1] + !direction[2];
        l->has[n] = along == 0 || l->matters || (along == 1 && is_edge_cut(b, l, direction));
    }
    for (int f = 0; f < 6; f++) {
        int direction[3] = {0, 0, 0};
        direction[f / 2] = f % 2 ? 1 : -1;
        l->cut[f] = l->size < CWI_DIVISIONS && is_divided_beside(b, l, direction);
        for (int n = 1; n < 8; n += 2)
            l->has[middle_of_face(f)] |= l->has[around_face(f, n)];
        l->has[CENTRE] |= l->has[middle_of_face(f)];
    }
}

static uint32_t find_point(build *b, const leaf *l, int n)
{
    uint32_t at[3];
    for (int a = 0; a < 3; a++)
        at[a] =
            ((2 * l->at[a] + (uint32_t)lattice_coordinate(n, a)) << (CWI_DIVISIONS - l->size));
    const uint32_t p = cwi_lattice_add(&b->a->points, cwi_lattice_key(at));
    b->out_of_memory |= p == CWI_NO_LATTICE_POINT;
    return p;
}

/* Visits a cell, and calls `work` for it, if it is not divided into smaller ones. */
static void visit_leaf(build *b, leaf *l, void (*work)(build *b, const leaf *l))
{
    if (l->size < CWI_DIVISIONS && cwi_adaptive_is_divided(b->a, l->size, l->at))
        return;
    look_around_leaf(b, l);
    work(b, l);
}

static void each_leaf(build *b, void (*work)(build *b, const leaf *l))
{
    leaf l = {.size = 0};
    for (size_t n = 0; n < b->whole.count && !b->out_of_memory; n++) {
        cwi_lattice_point(b->whole.keys[n], l.at);
        visit_leaf(b, &l, work);
    }
    for (l.size = 1; l.size <= CWI_DIVISIONS; l.size++) {
        const cwi_lattice_map *divided = &b->a->divided[l.size - 1];
        for (size_t n = 0; n < 8 * divided->count && !b->out_of_memory; n++) {
            uint32_t whole[3];
            cwi_lattice_point(divided->keys[n / 8], whole);
            for (int a = 0; a < 3; a++)
                l.at[a] = 2 * whole[a] + (n >> a & 1);
            visit_leaf(b, &l, work);
        }
    }
}

/* ---- voxels ------------------------------------------------------------------------------ */

static void add_whole(build *b, const uint32_t at[3])
{
    b->out_of_memory |= cwi_lattice_add(&b->whole, cwi_lattice_key(at)) == CWI_NO_LATTICE_POINT;
}

/* Adds the voxels around a sample that may be crossed. A distance changes by no more than the
 * length of the way. */
static void add_crossed(build *b, const uint32_t at[3], float value)
{
    bool low = value <= 0, high = value >= 0;
    if (fabs((double)value) > 1.8 * b->a->voxel)
        return;
    for (int n = 1; n < 8; n++) {
        const uint32_t corner[3] = {at[0] + (n & 1), at[1] + (n >> 1 & 1), at[2] + (n >> 2)};
        const float *v = cwi_level_set_voxel(b->a->volume, &b->a->leaves, corner);
        low |= v && *v <= 0;
        high |= v && *v >= 0;
    }
    if (low && high)
        add_whole(b, at);
}

/* Finds the voxels that the surface crosses, and those that touch divided cells. */
static void find_whole(build *b)
{
    const cw_volume *v = b->a->volume;
    const cwi_lattice_map *divided = &b->a->divided[0];
    uint32_t at[3], beside[3];
    for (size_t n = 0; n < v->sparse->leaf_count * CWI_LEAF_VOXELS; n++) {
        const uint32_t *first = v->sparse->leaves[n / CWI_LEAF_VOXELS];
        const uint32_t in = n % CWI_LEAF_VOXELS;
        at[0] = CWI_LEAF * first[0] + in % CWI_LEAF;
        at[1] = CWI_LEAF * first[1] + in / CWI_LEAF % CWI_LEAF;
        at[2] = CWI_LEAF * first[2] + in / (CWI_LEAF * CWI_LEAF);
        add_crossed(b, at, ((const float *)v->data)[n]);
    }
    for (size_t n = 0; n < 27 * divided->count; n++) {
        cwi_lattice_point(divided->keys[n / 27], at);
        for (int a = 0; a < 3; a++)
            beside[a] = at[a] + (uint32_t)lattice_coordinate((int)(n % 27), a) - 1;
        add_whole(b, beside);
    }
}

/* ---- cells ------------------------------------------------------------------------------- */

static bool ensure_capacity(build *b)
{
    if (b->count == b->capacity) {
        const size_t capacity = 2 * b->capacity + 1024;
        uint8_t *more = cwi_realloc_array(b->shapes, capacity, sizeof *more);
        b->shapes = more ? more : b->shapes;
        b->capacity = more ? capacity : b->capacity;
    }
    if (b->corner_count + 8 > b->corner_capacity) {
        const size_t capacity = 2 * b->corner_capacity + 8192;
        uint32_t *more = cwi_realloc_array(b->corners, capacity, sizeof *more);
        b->corners = more ? more : b->corners;
        b->corner_capacity = more ? capacity : b->corner_capacity;
    }
    return b->count < b->capacity && b->corner_count + 8 <= b->corner_capacity;
}

/* Adds a cell to the grid. points: of the leaf's 27 */
static void add_cell(build *b, const leaf *l, cw_shape shape, const int *points, int count)
{
    if (!ensure_capacity(b)) {
        b->out_of_memory = true;
        return;
    }
    b->shapes[b->count++] = (uint8_t)shape;
    for (int n = 0; n < count; n++)
        b->corners[b->corner_count++] = find_point(b, l, points[n]);
}

/* Adds the cells between a face and the cell's middle. */
static void add_face(build *b, const leaf *l, int face)
{
    const int middle = middle_of_face(face);
    int ring[9], count = 0;
    for (int n = 0; n < 8; n++)
        if (l->has[around_face(face, n)])
            ring[count++] = around_face(face, n);
    ring[count] = ring[0];
    if (!l->has[middle])
        add_cell(b, l, CW_PYRAMID, (int[]){ring[0], ring[1], ring[2], ring[3], CENTRE}, 5);
    for (int n = 0; n < 8 && l->cut[face]; n += 2)
        add_cell(b, l, CW_PYRAMID,
                 (int[]){around_face(face, n), around_face(face, n + 1), middle,
                         around_face(face, n + 7), CENTRE},
                 5);
    for (int n = 0; n < count && l->has[middle] && !l->cut[face]; n++)
        add_cell(b, l, CW_TETRAHEDRON, (int[]){ring[n], ring[n + 1], middle, CENTRE}, 4);
}

static void add_points(build *b, const leaf *l)
{
    for (int n = 0; n < 27; n++)
        if (l->has[n] && (n != CENTRE || l->matters))
            find_point(b, l, n);
}

static bool is_crossed(build *b, const leaf *l)
{
    bool low = false, high = false;
    for (int n = 0; n < 27; n++) {
        if (!l->has[n] || (n == CENTRE && !l->matters))
            continue;
        const float value = b->a->values[find_point(b, l, n)];
        low |= value <= 0;
        high |= value >= 0;
    }
    return low && high;
}

static void add_leaf(build *b, const leaf *l)
{
    if (!is_crossed(b, l))
        return;
    if (!l->has[CENTRE])
        add_cell(b, l, CW_HEXAHEDRON, (int[]){0, 2, 8, 6, 18, 20, 26, 24}, 8);
    for (int face = 0; face < 6 && l->has[CENTRE]; face++)
        add_face(b, l, face);
}

/* ---- the grid ---------------------------------------------------------------------------- */

static cw_status hand_over(const build *b, cw_volume *grid, cw_error *err)
{
    const cwi_adaptive *a = b->a;
    const size_t samples = a->points.count;
    char *memory = cwi_alloc_array(sizeof(cw_cells) + samples * 3 * sizeof(double) +
                                       b->corner_count * sizeof(uint32_t) + b->count,
                                   1);
    if (!memory)
        return cwi_fail_memory(err);
    double *points = (double *)(void *)(memory + sizeof(cw_cells));
    uint32_t *corners = (uint32_t *)(void *)(points + 3 * samples);
    uint8_t *shapes = (uint8_t *)(void *)(corners + b->corner_count);
    cw_cells *cells = (cw_cells *)(void *)memory;
    if (b->count) {
        memcpy(corners, b->corners, b->corner_count * sizeof *corners);
        memcpy(shapes, b->shapes, b->count);
    }
    memcpy(points, a->positions, samples * sizeof *a->positions);
    *cells = (cw_cells){points, b->count, shapes, corners};
    *grid = (cw_volume){.data = a->values,
                        .type = CW_F32,
                        .dim = {samples, 1, 1},
                        .cells = cells,
                        .known = a->volume->known,
                        .owned_grid = memory};
    memcpy(grid->affine, a->volume->affine, sizeof grid->affine);
    return CW_OK;
}

/* Compares the memory for points, in all and while their number grows, and for cells with the
 * limit. */
static cw_status check_fits(const build *b, cw_error *err)
{
    const cwi_adaptive *a = b->a;
    const double point = sizeof *a->points.keys + 2 * sizeof *a->points.table +
                         2 * sizeof *a->positions + sizeof *a->values;
    const double bytes = 1.5 * point * (double)a->points.count +
                         2 * sizeof *b->corners * (double)b->corner_count;
    if (!a->desc->max_bytes || bytes <= (double)a->desc->max_bytes)
        return CW_OK;
    return cwi_fail(err, CW_ERR_LIMIT, "finer cells would need %.0f MB; the limit is %.0f MB",
                    bytes / 1e6, (double)a->desc->max_bytes / 1e6);
}

static cw_status build_grid(build *b, cw_error *err)
{
    find_whole(b);
    each_leaf(b, add_points);
    cw_status st = b->out_of_memory ? CW_OK : check_fits(b, err);
    if (st == CW_OK && !b->out_of_memory)
        st = cwi_adaptive_measure(b->a, err);
    if (st == CW_OK && !b->out_of_memory)
        each_leaf(b, add_leaf);
    if (st == CW_OK && b->out_of_memory)
        st = cwi_fail_memory(err);
    if (st == CW_OK)
        st = check_fits(b, err);
    return st == CW_OK ? cwi_adaptive_measure(b->a, err) : st;
}

cw_status cwi_adaptive_grid(cwi_adaptive *a, cw_volume *grid, cw_error *err)
{
    build b = {.a = a};
    *grid = (cw_volume){0};
    cw_status st = build_grid(&b, err);
    if (st == CW_OK)
        st = hand_over(&b, grid, err);
    cwi_lattice_free(&b.whole);
    cwi_free(b.shapes);
    cwi_free(b.corners);
    return st;
}
