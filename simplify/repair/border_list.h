/* Open edges, the pairs of them that lie along each other, and vertices that become one. */
#ifndef SIMPLIFY_REPAIR_BORDER_LIST_H
#define SIMPLIFY_REPAIR_BORDER_LIST_H

#include "simplify/repair/repair_state.h"

/* An open edge. */
typedef struct cwi_open_edge {
    uint32_t corner; /* where it begins */
    double length;
    double nearest; /* distance from the nearest edge that lies along it; infinite: none does */
} cwi_open_edge;

typedef struct cwi_border_pair {
    uint32_t edges[2]; /* the longer one first */
} cwi_border_pair;

typedef struct cwi_border_list {
    const cw_mesh *mesh;
    double share; /* of the length that both have in common: they are not farther apart */
    cwi_open_edge *edges;
    size_t count;
    cwi_border_pair *pairs;
    size_t pair_count, pair_capacity;
} cwi_border_list;

/* One end of what two edges have in common: two vertices meet there, or a vertex is on the edge at a corner. */
typedef struct cwi_overlap {
    bool is_split;
    uint32_t vertex, other; /* other: unless is_split */
    uint32_t corner;        /* of the edge that is split */
    double at;              /* where along it: 0 to 1 */
} cwi_overlap;

/* Lists open edges, and pairs. All sides at an open edge are there: equal triangles have one each. Free the list
 * with cwi_borders_free(), also on failure. */
CW_NODISCARD cw_status cwi_borders_list(const cwi_repair *r, cwi_border_list *list,
                                        cw_error *err);
void cwi_borders_free(cwi_border_list *list);

/* Finds the ends of what two edges have in common; returns false when they are farther apart than the reach. */
bool cwi_borders_overlap(const cwi_border_list *list, const uint32_t edges[2], double reach_mm,
                         cwi_overlap ends[2]);

/* Makes each set of vertices one: the lowest stays, and moves to where the planes of their triangles meet.
 * root     of a vertex: union-find
 * most_mm  the farthest that it moves from the middle of the set
 * welded   is increased by the vertices that no triangle names then
 * Returns  false when memory is out */
bool cwi_join_vertices(cw_mesh *m, uint32_t *root, double most_mm, size_t *welded);

#endif
