/* A section as rings of nodes in a plane, which become triangles. */
#ifndef SIMPLIFY_CUT_SECTION_H
#define SIMPLIFY_CUT_SECTION_H

#include "core/mesh/clip_ears.h"
#include "simplify/cut/cut_state.h"

/* loop: the number of the node's loop */
typedef cwi_ring_node cwi_section_node;

/* A closed loop of the section. */
typedef struct cwi_section_loop {
    uint32_t begin, end; /* its nodes */
    uint32_t leftmost;   /* the node with the least u, and of these with the least v */
    double area;         /* in u and v; negative: it is a hole */
    bool is_joined;      /* a hole that is now part of another loop's ring */
    bool is_free;        /* a hole that nothing is around: it is filled by itself */
} cwi_section_loop;

typedef struct cwi_section {
    cwi_cut *cut;
    int u,
        v; /* axes of the plane's coordinates: loops that are no holes run against the clock */
    int direction; /* 1 or -1: what makes cwi_orient2d() positive there */
    cwi_section_node *nodes;
    size_t node_count; /* room is for two more for each loop */
    cwi_section_loop *loops;
    size_t loop_count;
} cwi_section;

static inline const float *cwi_section_point(const cwi_section *s, uint32_t node)
{
    return s->cut->positions + 3 * (size_t)s->nodes[node].vertex;
}

/* Returns 1 when three vertices turn against the clock, -1 with it, 0 when they are on one line. */
static inline int cwi_section_turn_vertices(const cwi_section *s, uint32_t a, uint32_t b,
                                            uint32_t c)
{
    const float *p = s->cut->positions;
    return s->direction *
           cwi_orient2d(p + 3 * (size_t)a, p + 3 * (size_t)b, p + 3 * (size_t)c, s->cut->axis);
}

/* Returns the same of three nodes. */
static inline int cwi_section_turn(const cwi_section *s, uint32_t a, uint32_t b, uint32_t c)
{
    const cwi_section_node *n = s->nodes;
    return cwi_section_turn_vertices(s, n[a].vertex, n[b].vertex, n[c].vertex);
}

/* Joins each hole to the loop around it by a bridge: two edges along one line.
 * Returns  CW_ERR_NO_MEMORY; CW_ERR_CANCELLED */
CW_NODISCARD cw_status cwi_section_join_holes(cwi_section *s, cw_error *err);

/* Cuts ears from the ring of a loop until nothing is left. Each edge of the ring is then an edge of
 * one triangle, even if the ring crosses itself.
 * Returns  CW_ERR_NO_MEMORY; CW_ERR_CANCELLED */
CW_NODISCARD cw_status cwi_section_clip_ears(cwi_section *s, const cwi_section_loop *loop,
                                             cw_error *err);

/* Flips edges between the triangles from `first` on, until they are Delaunay.
 * Returns  CW_ERR_NO_MEMORY; CW_ERR_CANCELLED */
CW_NODISCARD cw_status cwi_section_flip(const cwi_section *s, size_t first, cw_error *err);

#endif
