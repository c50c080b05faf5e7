/* Snap rounding of triangles that cross after their vertices were rounded: what its steps share. */
#ifndef SIMPLIFY_BOOLEAN_SNAPPING_H
#define SIMPLIFY_BOOLEAN_SNAPPING_H

#include "simplify/boolean/boolean_state.h"

/* Vertices that others are moved onto, by cells as large as the radius. */
typedef struct cwi_anchors {
    const cwi_soup *soup;
    double radius;
    uint32_t *heads, *next; /* lists of vertices: 1 + a vertex; 0: the end */
    size_t mask, capacity;  /* capacity: of `next` */
} cwi_anchors;

CW_NODISCARD bool cwi_anchors_init(cwi_anchors *a, const cwi_soup *soup, double radius);
CW_NODISCARD bool cwi_anchors_add(cwi_anchors *a, uint32_t v);
void cwi_anchors_free(cwi_anchors *a);

/* Returns the closest anchor within the radius, the first of equally close ones; CWI_NOTHING: none. */
uint32_t cwi_anchors_find(const cwi_anchors *a, const double x[3]);

/* A vertex that an edge or a facet is to get. */
typedef struct cwi_insertion {
    uint32_t a, b;   /* the ends of the edge, a < b; or the triangle, twice */
    uint32_t vertex; /* to insert; no corner of the edge or triangle */
    double order;    /* the one with the lowest is inserted: that nearest to the middle */
    double distance;
} cwi_insertion;

typedef struct cwi_insertions {
    size_t count, capacity;
    cwi_insertion *rows;
} cwi_insertions;

/* The state of passes that insert vertices. */
typedef struct cwi_inserter {
    cwi_grid_solids *solids;
    cwi_anchors *anchors;
    bool *
        hot; /* of each triangle, those without area included: its surroundings are looked at */
    bool *close; /* of each vertex: one of a hot triangle */
    double radius;
    size_t vertex_capacity;
    uint32_t *list; /* the hot triangles */
    size_t list_count;
    cwi_insertions edges, facets;
    bool edges_meet; /* edges that pass each other are still to be looked at, once */
    bool failed;     /* memory is short */
} cwi_inserter;

void cwi_insertion_add(cwi_inserter *w, cwi_insertions *to, cwi_insertion row);

/* Looks for edges of hot triangles that pass each other within the radius, and makes vertices there. */
CW_NODISCARD cw_status cwi_find_close_edges(cwi_inserter *w, cw_error *err);

/* Makes vertices close to edges and facets of hot triangles part of these, and edges that pass each other meet, if
 * edges_meet: splits the triangles there. `hot` grows with them.
 * Returns  CW_ERR_LIMIT, CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_insert_vertices(cwi_grid_solids *solids, cwi_anchors *anchors,
                                           bool **hot, bool edges_meet, double *moved_mm,
                                           cw_error *err);

#endif
