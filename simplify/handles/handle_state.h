/* The surface whose handles are closed, and the steps that work on it.
 *
 * A side is a corner c and the edge from it to the next corner of its triangle. Surfaces are oriented,
 * so the two sides of an inner edge run in opposite directions. Borders count as filled: each is the
 * rim of a face that has no triangles. */
#ifndef SIMPLIFY_HANDLES_HANDLE_STATE_H
#define SIMPLIFY_HANDLES_HANDLE_STATE_H

#include "core/geometry/bvh.h"

#include <cubewright/handles.h>

#define CWI_ADDED                                                                              \
    UINT32_MAX /* the source of a vertex or triangle that the input does not have */

/* A loop of sides of the surface, each from the end of the one before it. */
typedef struct cwi_loop {
    double length;
    uint32_t seed;  /* the vertex that it was found from */
    uint32_t count; /* of its sides */
    size_t first;   /* of them, in a list of all loops */
} cwi_loop;

/* Loops, and their sides one after the other. A zeroed struct is valid and empty. */
typedef struct cwi_loops {
    cwi_loop *items;
    size_t count, capacity;
    uint32_t *sides;
    size_t side_count, side_capacity;
} cwi_loops;

typedef struct cwi_handles {
    const cw_mesh *mesh; /* the input */
    cw_close_handles_desc desc;
    cw_close_handles_facts facts;
    cwi_boxes tree; /* of the input's triangles */

    float *positions; /* vertices x 3 */
    uint32_t *source; /* of a vertex: one of the input, or CWI_ADDED */
    uint32_t *first;  /* of a vertex: a corner at it */
    uint8_t
        *fixed; /* of a vertex: no loop may pass it, as it is at a border or of several fans */
    size_t vertex_count, vertex_capacity;

    uint32_t *triangles; /* triangles x 3 */
    uint32_t *twin;      /* of a side: the other one of its edge, or CWI_NO_CORNER */
    uint8_t *avoided;    /* of a side: caps of a loop along it crossed the surface */
    uint8_t *changed;    /* of a triangle: it is not as in the input */
    size_t triangle_count, triangle_capacity;

    uint32_t *border;    /* open sides, one border after the other */
    size_t *border_end;  /* of each border, in open sides */
    uint32_t *border_of; /* of a triangle of the input x 3: the border of an open side */
    size_t border_count, open_count;
    double mean_edge; /* of the input: mean over triangles of the mean length of their sides */
    size_t
        fan_count; /* of the vertices: Euler's number counts vertices of several fans as often */

    uint64_t *signs; /* of a side, see cwi_handles_sign(); both of an edge have the same */
    size_t genus, components;
} cwi_handles;

/* A cut along a loop: the vertices of both rims, and the caps. Rim vertex n of either side is where side
 * n of the loop begins. The left rim has the triangles of the loop's sides, the right one those of their
 * twins. */
typedef struct cwi_handle_cut {
    bool is_possible;
    bool is_filling; /* of a tunnel; false: a handle is cut */
    double change_mm;
    uint32_t count;   /* of the loop's sides */
    float *rims[2];   /* count x 3: places of the vertices, left and right */
    float *points[2]; /* new vertices of the caps */
    size_t point_count[2];
    uint32_t *caps[2]; /* triangles x 3: vertices of the rim, then new ones */
    size_t cap_count[2];
} cwi_handle_cut;

void cwi_loops_free(cwi_loops *loops);
void cwi_handle_cut_free(cwi_handle_cut *cut);
void cwi_handles_free(cwi_handles *h);

/* Copies the surface, joins sides to twins, and finds borders and vertices that no loop may pass.
 * Returns  CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_handles_link(cwi_handles *h, cw_error *err);

/* Makes room for more vertices and triangles. Returns  CW_ERR_LIMIT; CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_handles_reserve(cwi_handles *h, size_t vertices, size_t triangles,
                                           cw_error *err);

/* Gives sides signs: the exclusive or of those along a loop is 0 if the loop separates the surface, or
 * with any other loops does. For other loops it is 0 by a chance of 2^-64. Also counts handles and
 * components.
 * Returns  CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_handles_sign(cwi_handles *h, cw_error *err);

/* Finds, for vertices that all loops around handles pass, the shortest of these loops through each.
 * most     length of the longest
 * out      zeroed before; in the order of their seeds
 * Returns  CW_ERR_NO_MEMORY; CW_ERR_CANCELLED */
CW_NODISCARD cw_status cwi_handles_search(const cwi_handles *h, double most,
                                          const cw_progress *progress, cwi_loops *out,
                                          cw_error *err);

/* Keeps loops that are shorter than all others near them: no two have a common triangle around them,
 * or boxes that meet.
 * loops    the kept ones come first, in rising order of length
 * boxes    set to what the cut of each kept loop may change: low, high; free it with cwi_free()
 * Returns  CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_handles_choose(const cwi_handles *h, cwi_loops *loops,
                                          float (**boxes)[6], cw_error *err);

/* Takes loops out that would separate the surface together with others: the longest of those.
 * keep     of each loop: set to false for these, and for nothing else
 * Returns  CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_handles_keep_joined(const cwi_handles *h, const cwi_loops *loops,
                                               bool *keep, cw_error *err);

/* Plans the cut along a loop. It is possible if no triangle meets another that it did not meet before.
 * changed  the tree of triangles that are not as in the input
 * ids      of the items of that tree
 * box      what may be changed
 * Returns false when memory is out */
bool cwi_handles_plan(const cwi_handles *h, const cwi_loops *loops, const cwi_loop *loop,
                      const cwi_boxes *changed, const uint32_t *ids, const float box[6],
                      cwi_handle_cut *cut);

/* Cuts the surface along a loop. There is room for that.
 * Returns false when memory is out, and nothing has changed */
bool cwi_handles_cut(cwi_handles *h, const cwi_loops *loops, const cwi_loop *loop,
                     const cwi_handle_cut *cut);

#endif
