/* The search for triangles that meet: what its parts share. */
#ifndef SIMPLIFY_INTERSECTIONS_PAIR_SEARCH_H
#define SIMPLIFY_INTERSECTIONS_PAIR_SEARCH_H

#include "core/geometry/bvh.h"
#include "core/mesh/wide_fans.h"
#include "simplify/intersections/triangle_packs.h"
#include "simplify/quality/welded_mesh.h"

/* Two triangles that meet; a < b. */
typedef struct cwi_meeting_pair {
    uint32_t a, b;
} cwi_meeting_pair;

/* Pairs that a part of the search has found, and how much work it has done and may do: a pair of boxes
 * that meet is 1. */
typedef struct cwi_pair_list {
    size_t count, capacity;
    cwi_meeting_pair *pairs;
    size_t work, max_work;
    bool cut, failed; /* the work was too much; memory was out */
} cwi_pair_list;

typedef struct cwi_pair_search {
    cwi_welded welded;
    cwi_wide_fans fans;
    cwi_boxes tree;           /* of the triangles of no fan */
    cwi_triangle_pack *packs; /* of the tree's nodes */
    cwi_pair_list *lists;     /* of chunks of nodes, and then one for each fan */
    size_t list_count, node_chunks;
    float (*around)[6]; /* the box of each fan */
    float underflow;    /* cwi_plane_underflow() */
} cwi_pair_search;

/* Tests a pair of triangles, and keeps it if they meet. */
void cwi_test_pair(const cwi_pair_search *search, cwi_pair_list *list, uint32_t a, uint32_t b);

/* Finds the wide fans, and the box around each. Returns false when memory is out. */
bool cwi_find_fans(cwi_pair_search *search);

/* Finds the pairs of a fan: with triangles of no fan, its own, and those of later fans. */
void cwi_search_fan(const cwi_pair_search *search, uint32_t fan, cwi_pair_list *list);

#endif
