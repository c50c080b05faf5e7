/* Numbers the corners, edges and faces of a cube.
 *
 * Corner c stands at x = c & 1, y = c >> 1 & 1, z = c >> 2. An edge runs along one axis between
 * the two corners that differ in it: 0..3 along x, 4..7 along y, 8..11 along z; within an axis
 * they count the other two coordinates, the lower axis first. A case is 8 bits, one a corner,
 * set where the sample is inside. */
#ifndef CORE_CASES_CUBE_NUMBERING_H
#define CORE_CASES_CUBE_NUMBERING_H

#include <stdbool.h>

/* Low-coordinate corner of an edge; the other end is 1 << axis away. */
static inline int cwi_edge_axis(int edge)
{
    return edge >> 2;
}

static inline int cwi_edge_corner(int edge)
{
    const int low = edge & 1, high = edge >> 1 & 1;
    switch (cwi_edge_axis(edge)) {
    case 0:
        return low << 1 | high << 2;
    case 1:
        return low | high << 2;
    default:
        return low | high << 1;
    }
}

/* The edges of a row of cubes lie in eight rows, four along x and two along each of y and z.
 * Those at i + 1 are those at i of the next cube. cwi_row_edge() returns the edge of a cube
 * that is in row n at i. */
enum { CWI_EDGE_ROWS = 8 };

static inline int cwi_row_edge(int n)
{
    return n < 4 ? n : 2 * n - 4;
}

/* Returns true if an edge joins corners on different sides. */
static inline bool cwi_edge_is_crossed(unsigned cube_case, int edge)
{
    const int low = cwi_edge_corner(edge), high = low | 1 << cwi_edge_axis(edge);
    return (cube_case >> low ^ cube_case >> high) & 1;
}

/* Returns corner number n, 0 to 3, around a face, counter-clockwise seen from outside the cube.
 * Face 2 * axis has that coordinate 0, face 2 * axis + 1 has it 1. */
static inline int cwi_face_corner(int face, int n)
{
    const int axis = face >> 1, side = face & 1;
    const int u = 1 << (axis + 1) % 3, v = 1 << (axis + 2) % 3;
    const int turn = side ? n : 3 - n; /* u then v runs counter-clockwise seen from +axis */
    return (side << axis) | (turn == 1 || turn == 2 ? u : 0) | (turn >= 2 ? v : 0);
}

/* Returns the edge between two corners that differ along one axis. */
static inline int cwi_edge_between(int a, int b)
{
    const int low = a & b;
    switch (a ^ b) {
    case 1:
        return low >> 1;
    case 2:
        return 4 + ((low & 1) | (low >> 1 & 2));
    default:
        return 8 + (low & 3);
    }
}

/* Returns true if the corners of a face are alternately inside and outside. */
static inline bool cwi_face_is_ambiguous(int cube_case, int face)
{
    const int a = cube_case >> cwi_face_corner(face, 0) & 1;
    const int b = cube_case >> cwi_face_corner(face, 1) & 1;
    return a != b && (cube_case >> cwi_face_corner(face, 2) & 1) == a &&
           (cube_case >> cwi_face_corner(face, 3) & 1) == b;
}

#endif
