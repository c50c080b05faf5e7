/* The complex that an arrangement ends in: facets that meet in whole edges and corners alone, the cells of space between
 * them, and how often each input winds around each cell [Zhou2016]. */
#ifndef SIMPLIFY_BOOLEAN_COMPLEX_H
#define SIMPLIFY_BOOLEAN_COMPLEX_H

#include "simplify/boolean/arrangement.h"

/* Another triangle that a facet is part of: where triangles overlap in a plane, one facet stands for all. */
typedef struct cwi_facet_cover {
    uint32_t facet, triangle;
    int sign; /* -1: the triangle faces the other way */
} cwi_facet_cover;

typedef struct cwi_facets {
    size_t count;
    uint32_t (*corners)[3]; /* points; vertices come first */
    uint32_t *sources;      /* the triangle that each is part of, and faces as */
    size_t cover_count;
    cwi_facet_cover *covers; /* ordered by facet */
    uint32_t *
        facet_of; /* soup.triangle_count: a facet that is part of each triangle; CWI_NOTHING: all cancel out */
    uint32_t *
        of_part; /* the facet of each part; CWI_NOTHING: another triangle's stands for it, or it cancels out */
    size_t *first_part; /* soup.triangle_count + 1: the parts of each triangle */
} cwi_facets;

/* An edge in which more than two facets meet. */
typedef struct cwi_edge_ring {
    size_t first, count; /* in ring_corners */
} cwi_edge_ring;

/* Edges of facets, and cells. Corner 3 f + k is corner k of facet f, and edge k goes from there to the next. */
typedef struct cwi_space_cells {
    size_t count; /* of cells */
    uint32_t *
        sides; /* 2 x facets: the cell in front of facet f is sides[2 f], that behind it sides[2 f + 1] */
    uint32_t
        *twins; /* 3 x facets: the other corner at an edge of two facets; CWI_NOTHING: a ring */
    size_t ring_count;
    cwi_edge_ring *rings;
    uint32_t *
        ring_corners; /* around each edge counter-clockwise, seen against its direction from the lower
                               point to the higher */
} cwi_space_cells;

/* Collects unsplit triangles and parts; merges those that overlap, and drops what cancels out then.
 * inputs   of each triangle
 * Returns  CW_ERR_LIMIT: more than 2^31 / 3 facets; CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_find_facets(const cwi_soup *s, const cwi_meetings *meetings,
                                       const cwi_triangle_parts *parts, const uint32_t *inputs,
                                       cwi_facets *out, cw_error *err);
void cwi_facets_free(cwi_facets *facets);

/* Finds the edges of facets, their order around edges, and the cells.
 * Returns  CW_ERR_CHECK: an edge has one facet; CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_find_cells(const cwi_soup *s, const cwi_triangle_parts *parts,
                                      const cwi_facets *facets, cwi_space_cells *out,
                                      cw_error *err);
void cwi_space_cells_free(cwi_space_cells *cells);

/* Bit for a cell around which an input winds a negative number of times; results have the bits below. */
#define CWI_NEGATIVE 0x80u

/* Decides about a cell by how often each input winds around it: bit n is set if it is inside of result n.
 * positive, negative  inputs whose number is above 0, below 0 */
typedef uint8_t (*cwi_keep_cell)(const void *context, const int32_t *windings, size_t positive,
                                 size_t negative);

/* Finds the windings of each cell, and sets kept[cell] to what `keep` returns.
 * tree    of the boxes of all triangles; or of others, which is no use
 * inputs  of each triangle of the soup: below input_count */
CW_NODISCARD cw_status cwi_find_windings(const cwi_soup *s, const cwi_triangle_parts *parts,
                                         const cwi_facets *facets, const cwi_space_cells *cells,
                                         const cwi_boxes *tree, const uint32_t *inputs,
                                         size_t input_count, cwi_keep_cell keep,
                                         const void *context, uint8_t *kept, cw_error *err);

/* Lengthens an array, a pointer to which is given, to a capacity of `count` elements or more; returns false, with
 * the array untouched, when memory is out. */
bool cwi_make_room(void *array, size_t *capacity, size_t count, size_t size);

/* Returns a point by its number. */
static inline cwi_exact_point cwi_point_at(const cwi_soup *s, const cwi_triangle_parts *parts,
                                           uint32_t n)
{
    return n < s->vertex_count ? cwi_point_vertex(s, n) : parts->points[n - s->vertex_count];
}

#endif
