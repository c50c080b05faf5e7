/* A triangle that is split by points and lines in it: a triangulation in which each line is made of edges. */
#ifndef SIMPLIFY_BOOLEAN_PLANAR_SPLIT_H
#define SIMPLIFY_BOOLEAN_PLANAR_SPLIT_H

#include "simplify/boolean/arrangement.h"

/* A triangle of the triangulation. Edge k is between corners k and k + 1. */
typedef struct cwi_split_face {
    uint32_t corners[3]; /* points of the split */
    uint32_t beside[3];  /* the face beyond edge k; CWI_NOTHING at the border */
    uint32_t line[3];    /* the line that edge k is part of; CWI_NOTHING: none */
} cwi_split_face;

/* The plane or edge that a line is part of: see cwi_triangle_seam. */
typedef struct cwi_split_line {
    uint32_t on[2];
} cwi_split_line;

/* Zeroed: empty. One is used for many triangles. */
typedef struct cwi_split {
    const cwi_soup *soup;
    uint32_t triangle;
    int axis, turn; /* the plane is seen along the axis; turn of the triangle from there */
    size_t point_count, face_count, line_count;
    size_t point_capacity, face_capacity, line_capacity, queue_capacity;
    cwi_exact_point *points;
    uint32_t *numbers; /* of points in the arrangement; CWI_NOTHING: found here */
    uint32_t *face_at; /* a face of each point */
    cwi_split_face *faces;
    cwi_split_line *lines;
    uint32_t (*queue)[2]; /* edges, by their points */
    bool no_memory;       /* why a function returned false */
    uint32_t last;        /* a face near the point that was added last */
} cwi_split;

/* Begins with a whole triangle. Points are numbered from 0: its corners. Functions return false when memory
 * is out, or when a line could not be added. */
CW_NODISCARD bool cwi_split_begin(cwi_split *s, const cwi_soup *soup, uint32_t triangle);

/* Adds a point of the triangle; *n becomes its number. One at the place of another gets that one's. */
CW_NODISCARD bool cwi_split_add_point(cwi_split *s, const cwi_exact_point *p, uint32_t number,
                                      uint32_t *n);

/* Adds the line between two points. It is split where it meets points and other lines. */
CW_NODISCARD bool cwi_split_add_line(cwi_split *s, uint32_t from, uint32_t to,
                                     cwi_split_line line);

void cwi_split_free(cwi_split *s);

#endif
