/* The arrangement of triangles: where they meet, each is split, until they meet in vertices and edges alone.
 * Steps of cwi_boolean_run(), each in a file of its name. */
#ifndef SIMPLIFY_BOOLEAN_ARRANGEMENT_H
#define SIMPLIFY_BOOLEAN_ARRANGEMENT_H

#include "core/geometry/bvh.h"
#include "simplify/boolean/exact_points.h"

#define CWI_NOTHING UINT32_MAX /* no point, triangle, facet or line */

/* Two triangles that meet in more than a vertex or an edge that both have. */
typedef struct cwi_meeting {
    uint32_t a, b; /* a < b */
    bool coplanar; /* in one plane */
    bool overlap;  /* in an area of it */
} cwi_meeting;

typedef struct cwi_meetings {
    size_t count;
    cwi_meeting *pairs; /* ordered by a, then b */
    cwi_boxes tree;     /* of all triangles; empty if only some were looked at */
} cwi_meetings;

void cwi_meetings_free(cwi_meetings *meetings);

/* A line from p to q in a triangle, or a point of it when p and q are equal: part of the plane of triangle
 * `on[0]` if on[1] is CWI_NOTHING, of the edge between vertices on[0] and on[1] otherwise. */
typedef struct cwi_triangle_seam {
    uint32_t triangle;
    uint32_t p, q; /* numbers of points */
    uint32_t on[2];
} cwi_triangle_seam;

/* Where each triangle meets others. Points below vertex_count are vertices; the others follow. */
typedef struct cwi_seams {
    size_t point_count, count;
    cwi_exact_point *points;  /* point_count: those that are no vertices */
    cwi_triangle_seam *seams; /* ordered by triangle */
} cwi_seams;

/* Builds the tree of the boxes of `count` triangles: of a list, or of all, where list is NULL. */
CW_NODISCARD cw_status cwi_soup_tree(const cwi_soup *s, const uint32_t *list, size_t count,
                                     cwi_boxes *tree, cw_error *err);

/* Finds all pairs of triangles that meet.
 * moved    of each triangle: only pairs with one that moved are looked for; NULL: all
 * Returns  CW_ERR_NO_MEMORY, CW_ERR_CANCELLED */
CW_NODISCARD cw_status cwi_find_meetings(const cwi_soup *s, const bool *moved, int threads,
                                         const cw_progress *progress, cwi_meetings *out,
                                         cw_error *err);

/* Finds the lines and points in which the pairs meet. */
CW_NODISCARD cw_status cwi_find_seams(const cwi_soup *s, const cwi_meetings *meetings,
                                      int threads, const cw_progress *progress, cwi_seams *out,
                                      cw_error *err);

/* A triangle's parts: small triangles whose corners are points, in the triangle's own orientation. */
typedef struct cwi_triangle_part {
    uint32_t corners[3]; /* points */
    uint32_t source;     /* a triangle of the soup */
    uint8_t
        seams; /* bit k: the edge from corner k is part of a seam or of the triangle's edge */
} cwi_triangle_part;

typedef struct cwi_triangle_parts {
    size_t count, point_count;
    cwi_triangle_part *parts; /* of split triangles alone, ordered by source */
    cwi_exact_point *points;  /* those of the seams, then those where seams cross */
} cwi_triangle_parts;

/* Splits the triangles that have seams. Takes the points of the seams over. */
CW_NODISCARD cw_status cwi_split_triangles(const cwi_soup *s, cwi_seams *seams, int threads,
                                           const cw_progress *progress, cwi_triangle_parts *out,
                                           cw_error *err);

/* Gives points at one place one number: corners of parts are renumbered. */
CW_NODISCARD cw_status cwi_merge_points(const cwi_soup *s, cwi_triangle_parts *parts,
                                        cw_error *err);

#endif
