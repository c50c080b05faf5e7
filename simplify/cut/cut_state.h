/* The state of a cut, which its steps share. */
#ifndef SIMPLIFY_CUT_CUT_STATE_H
#define SIMPLIFY_CUT_CUT_STATE_H

#include <cubewright/cut.h>

/* Sides of the plane on which a vertex lies. */
enum { CWI_CUT_BELOW = -1, CWI_CUT_ON = 0, CWI_CUT_ABOVE = 1 };

/* A vertex of the result: at fraction t from vertex a to b of the mesh; a == b: that vertex. When it
 * merged with another, a is UINT32_MAX, and b is that one. */
typedef struct cwi_cut_source {
    uint32_t a, b;
    double t;
} cwi_cut_source;

/* An edge of the section, as its kept triangle runs through it. */
typedef struct cwi_cut_edge {
    uint32_t start, end;
} cwi_cut_edge;

typedef struct cwi_cut {
    const cw_mesh *mesh;
    cw_cut_desc desc;
    double normal[3]; /* of length 1 */
    double offset;    /* positions x in the plane have normal . x = offset */
    double tolerance; /* vertices as near as this are in the plane */
    int axis;         /* along which the normal is longest */
    int8_t *side;     /* vertex_count */

    cwi_cut_source *sources; /* of the vertices of the result */
    size_t vertex_count, vertex_capacity;
    float *positions; /* of the result, vertex_count x 3 */
    bool *is_section; /* vertex_count: it lies in the plane */
    bool has_unused;  /* vertices have merged: some are in no triangle */
    uint32_t *triangles;
    size_t triangle_count, triangle_capacity;
    cwi_cut_edge *edges; /* of the section */
    size_t edge_count, edge_capacity;

    uint32_t
        *loop_vertices; /* of the closed loops, one after the other; as the section's filling
                                runs through them */
    size_t *loop_ends;  /* loop_count: the end of each in loop_vertices */
    size_t loop_count;
    cw_cut_facts facts;
} cwi_cut;

/* Makes room for one more element of an array. Returns NULL when memory is out. */
void *cwi_cut_reserve(void *array, size_t count, size_t *capacity, size_t size);

/* Returns the signed distance of vertex v of the mesh to the plane. */
double cwi_cut_distance(const cwi_cut *c, size_t v);

/* Adds a triangle to the result. Returns false when memory is out. */
bool cwi_cut_add_triangle(cwi_cut *c, uint32_t a, uint32_t b, uint32_t d);

/* Keeps what is above the plane: sets vertices, triangles, and edges of the section.
 * Returns  CW_ERR_NO_MEMORY; CW_ERR_CANCELLED; CW_ERR_LIMIT */
CW_NODISCARD cw_status cwi_cut_clip(cwi_cut *c, cw_error *err);

/* Merges neighbours of the section at equal positions.
 * Returns  CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_cut_merge_equal(cwi_cut *c, cw_error *err);

/* Links the edges of the section to closed loops, and counts those that are open.
 * Returns  CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_cut_link(cwi_cut *c, cw_error *err);

/* Fills the closed loops with triangles.
 * Returns  CW_ERR_NO_MEMORY; CW_ERR_CANCELLED */
CW_NODISCARD cw_status cwi_cut_fill(cwi_cut *c, cw_error *err);

#endif
