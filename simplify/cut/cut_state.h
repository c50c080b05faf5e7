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
    double nearness;  /* factor of the distances in `near`; 0: no such distances */
    double *near;     /* vertex_count: as near as this they move into the plane; or NULL */
    int axis;         /* along which the normal is longest */
    int8_t *side;     /* vertex_count */

    cwi_cut_source *sources; /* of the vertices of the result */
    size_t vertex_count, vertex_capacity;
    float *positions; /* of the result, vertex_count x 3 */
    bool *is_section; /* vertex_count: it lies in the plane */
    double step;      /* by which vertices of the section move apart: of the last digit */
    bool has_unused;  /* vertices have merged: some are in no triangle */
    uint32_t *triangles;
    size_t triangle_count, triangle_capacity;
    uint32_t *parents; /* of triangles: that of the mesh it is a part of; UINT32_MAX: of none */
    size_t parent_capacity;
    uint32_t parent;     /* of triangles that are added now */
    cwi_cut_edge *edges; /* of the section */
    size_t edge_count, edge_capacity;

    uint32_t
        *loop_vertices; /* of the closed loops, one after the other; as the section's filling
                                runs through them */
    size_t *loop_ends;  /* loop_count: the end of each in loop_vertices */
    size_t loop_count;
    size_t crossings; /* that filling the section left */
    cw_cut_facts facts;
} cwi_cut;

/* Returns the signed distance of vertex v of the mesh to the plane. */
static inline double cwi_cut_distance(const cwi_cut *c, size_t v)
{
    double sum = -c->offset;
    for (size_t a = 0; a < 3; a++)
        sum += c->normal[a] * (double)c->mesh->positions[3 * v + a];
    return sum;
}

/* Adds a triangle to the result. Returns false when memory is out. */
bool cwi_cut_add_triangle(cwi_cut *c, uint32_t a, uint32_t b, uint32_t d);

/* Finds the sides of all vertices, and tells which of them triangles have. Returns false when memory is
 * out.
 * largest  coordinate of the mesh */
bool cwi_cut_find_sides(cwi_cut *c, double largest, bool has[3]);

/* Returns true if what is kept has the volume that the mesh has above the plane, but for a millionth. */
bool cwi_cut_keeps_volume(const cwi_cut *c);

/* Keeps what is above the plane: sets vertices, triangles, and edges of the section.
 * Returns  CW_ERR_NO_MEMORY; CW_ERR_CANCELLED; CW_ERR_LIMIT */
CW_NODISCARD cw_status cwi_cut_clip(cwi_cut *c, cw_error *err);

/* Places the vertices of the result, those of the section in the plane. Returns false when memory is
 * out. */
bool cwi_cut_place_vertices(cwi_cut *c);

/* Raises the fact of the farthest move to that of vertices of the mesh that are in the section. */
void cwi_cut_measure_moves(cwi_cut *c);

/* Places a vertex of the section, moved by multiples of the step: along the two axes after that of
 * the plane, and away from what is kept. It returns to the plane along its axis before that. */
void cwi_cut_place_apart(cwi_cut *c, size_t n, const double shift[2], int lowered);

/* Merges neighbours of the section at equal positions.
 * Returns  CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_cut_merge_equal(cwi_cut *c, cw_error *err);

/* Links the edges of the section to closed loops, and counts those that are open.
 * Returns  CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_cut_link(cwi_cut *c, cw_error *err);

/* Fills the closed loops with triangles.
 * Returns  CW_ERR_NO_MEMORY; CW_ERR_CANCELLED */
CW_NODISCARD cw_status cwi_cut_fill(cwi_cut *c, cw_error *err);

/* Marks of vertices of the section: move it within the plane; move it away from what is kept. */
enum { CWI_CUT_SHIFT = 1, CWI_CUT_LOWER = 2 };

/* Marks the ends of edges of the section that meet as the plane's axis shows them, beyond their common
 * ends, or are seen as a point.
 * marks    vertex_count; marks are added
 * count    the number of such edges and pairs
 * Returns  CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_cut_find_edge_crossings(const cwi_cut *c, uint8_t *marks,
                                                   size_t *count, cw_error *err);

/* Marks vertices of the section whose triangles meet others beyond their common vertices and edges,
 * or have no area; not where triangles of the mesh did already.
 * first_cap  triangles from here on fill the section
 * marks      vertex_count; marks are added
 * count      the number of such triangles and pairs
 * Returns    CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_cut_find_triangle_crossings(const cwi_cut *c, size_t first_cap,
                                                       uint8_t *marks, size_t *count,
                                                       cw_error *err);

/* Fills the section, and moves its vertices by some steps where rounding made edges or triangles cross.
 * Returns  CW_ERR_NO_MEMORY; CW_ERR_CANCELLED */
CW_NODISCARD cw_status cwi_cut_fill_apart(cwi_cut *c, cw_error *err);

#endif
