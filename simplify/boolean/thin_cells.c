/* Cells between sheets of surface that are closer than floats can tell apart: each goes to what most of its
 * surface borders on, and the sheets around it vanish. */
#include "simplify/boolean/boolean_state.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/point_triangle.h"
#include "core/geometry/triangle.h"

#include <math.h>
#include <string.h>

typedef struct search {
    const cwi_grid_solids *solids;
    const cwi_triangle_parts *parts;
    const cwi_facets *f;
    const cwi_space_cells *cells;
    double thickness;
    size_t *first;   /* cells + 1: where the sides of each cell begin */
    uint32_t *sides; /* 2 f and 2 f + 1 for facet f, by cell */
} search;

/* A facet of a cell; seen from the cell's first corner, so that thin cells keep their digits. */
typedef struct wall {
    double corners[3][3], normal[3]; /* outward, as long as twice the area */
} wall;

/* The walls of a cell, and a place that must have one close by that faces the other way. */
typedef struct wall_search {
    double thickness;
    const wall *walls;
    cwi_boxes tree;
    size_t wall;
    double middle[3];
    float box[6];
    bool found;
    double distance_sq; /* the largest of those found */
} wall_search;

static bool list_sides(search *w)
{
    const size_t count = 2 * w->f->count;
    w->first = cwi_alloc_zeroed(w->cells->count + 2, sizeof *w->first);
    w->sides = cwi_alloc_array(count, sizeof *w->sides);
    if (!w->first || !w->sides)
        return false;
    for (size_t n = 0; n < count; n++)
        w->first[w->cells->sides[n] + 2]++;
    for (size_t n = 0; n < w->cells->count; n++)
        w->first[n + 2] += w->first[n + 1];
    for (uint32_t n = 0; n < count; n++)
        w->sides[w->first[w->cells->sides[n] + 1]++] = n;
    return true;
}

static void find_wall(const search *w, uint32_t side, const double origin[3], wall *out)
{
    for (int k = 0; k < 3; k++) {
        const int corner = side % 2 || k == 0 ? k : 3 - k; /* a facet faces the cell in front */
        const cwi_exact_point p =
            cwi_point_at(&w->solids->soup, w->parts, w->f->corners[side / 2][corner]);
        cwi_sub(p.x, origin, out->corners[k]);
    }
    cwi_triangle_normal(out->corners[0], out->corners[1], out->corners[2], out->normal);
}

static void find_origin(const search *w, size_t cell, double origin[3])
{
    const uint32_t corner = w->f->corners[w->sides[w->first[cell]] / 2][0];
    const cwi_exact_point p = cwi_point_at(&w->solids->soup, w->parts, corner);
    memcpy(origin, p.x, sizeof p.x);
}

/* Returns true if a cell is bounded by something that moved, and thin on average. */
static bool may_be_thin(const search *w, size_t cell)
{
    double origin[3], volume = 0, area = 0;
    bool moved = !w->solids->moved;
    if (w->first[cell] == w->first[cell + 1])
        return false;
    find_origin(w, cell, origin);
    for (size_t n = w->first[cell]; n < w->first[cell + 1]; n++) {
        wall at;
        moved = moved || w->solids->moved[w->f->sources[w->sides[n] / 2]];
        find_wall(w, w->sides[n], origin, &at);
        area += cwi_length(at.normal) / 2;
        volume += cwi_dot(at.corners[0], at.normal) / 6;
    }
    return moved && volume >= 0 && 2 * volume < w->thickness * area;
}

static double distance_sq(const double p[3], const wall *w)
{
    double nearest = INFINITY, from[3];
    bool inside = true;
    for (int k = 0; k < 3; k++) {
        double edge[3], across[3];
        cwi_sub(w->corners[(k + 1) % 3], w->corners[k], edge);
        cwi_sub(p, w->corners[k], from);
        cwi_cross(edge, from, across);
        inside &= cwi_dot(across, w->normal) >= 0;
        nearest = fmin(nearest, cwi_segment_square(from, edge));
    }
    const double height = cwi_dot(from, w->normal), size_sq = cwi_dot(w->normal, w->normal);
    return inside && size_sq > 0 ? height * height / size_sq : nearest;
}

static bool visit_node(void *context, size_t node)
{
    wall_search *f = context;
    for (unsigned n = cwi_boxes_meeting(&f->tree.nodes[node], f->box); n && !f->found;
         n &= n - 1) {
        const size_t other = f->tree.order[node * CWI_WIDTH + (size_t)__builtin_ctz(n)];
        const double square = distance_sq(f->middle, &f->walls[other]);
        f->found = cwi_dot(f->walls[f->wall].normal, f->walls[other].normal) < 0 &&
                   square < f->thickness * f->thickness;
        if (f->found)
            f->distance_sq = fmax(f->distance_sq, square);
    }
    return !f->found;
}

/* Finds the walls of a cell, and boxes around them. */
static void list_walls(const search *w, size_t cell, wall *walls, float (*boxes)[6])
{
    double origin[3];
    find_origin(w, cell, origin);
    for (size_t n = 0; n < w->first[cell + 1] - w->first[cell]; n++) {
        find_wall(w, w->sides[w->first[cell] + n], origin, &walls[n]);
        for (int k = 0; k < 3; k++) {
            const double x = walls[n].corners[0][k], y = walls[n].corners[1][k],
                         z = walls[n].corners[2][k];
            boxes[n][k] = (float)(fmin(fmin(x, y), z) - w->thickness);
            boxes[n][k + 3] = (float)(fmax(fmax(x, y), z) + w->thickness);
        }
    }
}

/* Finds out whether the middle of each wall is close to one that faces it, and how far from it at most. */
static cw_status find_if_thin(const search *w, size_t cell, bool *thin, double *distance,
                              cw_error *err)
{
    const size_t count = w->first[cell + 1] - w->first[cell];
    wall *walls = cwi_alloc_array(count, sizeof *walls);
    float(*boxes)[6] = cwi_alloc_array(count, sizeof *boxes);
    wall_search f = {.thickness = w->thickness, .walls = walls};
    cw_status st = CW_ERR_NO_MEMORY;
    *thin = false;
    if (walls && boxes) {
        list_walls(w, cell, walls, boxes);
        st = cwi_boxes_build(&f.tree, (const float(*)[6])boxes, count, err);
    } else
        st = cwi_fail_memory(err);
    f.found = st == CW_OK;
    for (f.wall = 0; f.wall < count && f.found; f.wall++) {
        const wall *at = &walls[f.wall];
        for (int k = 0; k < 3; k++) {
            f.middle[k] = (at->corners[0][k] + at->corners[1][k] + at->corners[2][k]) / 3;
            f.box[k] = (float)(f.middle[k] - w->thickness);
            f.box[k + 3] = (float)(f.middle[k] + w->thickness);
        }
        f.found = false;
        cwi_boxes_visit(&f.tree, f.box, 0, visit_node, &f);
    }
    *thin = f.found;
    *distance = sqrt(f.distance_sq);
    cwi_boxes_free(&f.tree);
    cwi_free(walls);
    cwi_free(boxes);
    return st;
}

/* Returns the results that most of a cell's surface borders on. */
static uint8_t find_surroundings(const search *w, size_t cell, const uint8_t *kept)
{
    double origin[3], inside[2] = {0}, area = 0;
    find_origin(w, cell, origin);
    for (size_t n = w->first[cell]; n < w->first[cell + 1]; n++) {
        wall at;
        find_wall(w, w->sides[n], origin, &at);
        const double size = cwi_length(at.normal);
        const uint8_t beyond = kept[w->cells->sides[w->sides[n] ^ 1]];
        area += size;
        for (int bit = 0; bit < 2; bit++)
            inside[bit] += beyond >> bit & 1 ? size : 0;
    }
    return (uint8_t)((2 * inside[0] > area) | (2 * inside[1] > area) << 1);
}

cw_status cwi_absorb_thin_cells(const cwi_grid_solids *solids, const cwi_triangle_parts *parts,
                                const cwi_facets *facets, const cwi_space_cells *cells,
                                double thickness, uint8_t *kept, double *moved_mm,
                                cw_error *err)
{
    search w = {
        .solids = solids, .parts = parts, .f = facets, .cells = cells, .thickness = thickness};
    cw_status st = list_sides(&w) ? CW_OK : cwi_fail_memory(err);
    for (size_t c = 0; c < cells->count && st == CW_OK; c++) {
        bool thin = may_be_thin(&w, c);
        double distance = 0;
        if (thin)
            st = find_if_thin(&w, c, &thin, &distance, err);
        const uint8_t around = thin ? find_surroundings(&w, c, kept) : kept[c];
        if (around != kept[c])
            *moved_mm = fmax(*moved_mm, distance / solids->scale);
        kept[c] = around;
    }
    cwi_free(w.first);
    cwi_free(w.sides);
    return st;
}
