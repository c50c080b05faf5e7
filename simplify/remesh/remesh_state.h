/* The mesh under remeshing, the input beside it, and the steps that work on them. */
#ifndef SIMPLIFY_REMESH_REMESH_STATE_H
#define SIMPLIFY_REMESH_REMESH_STATE_H

#include "core/geometry/bvh.h"
#include "core/geometry/vec3.h"
#include "core/mesh/mesh_triangle.h"

#include <cubewright/remesh.h>

#define CWI_NONE UINT32_MAX /* no corner, no vertex, no sample */

/* Maximum of triangles around a vertex that is moved or collapsed. */
enum { CWI_MAX_ONE_RING = 96 };

/* Bits of a triangle: its edge k is sharp (a feature or a border); it is dead. */
enum { CWI_SHARP = 1, CWI_DEAD = 8 };

typedef enum cwi_freedom {
    CWI_FREE,  /* moves on the surface */
    CWI_CURVE, /* moves along sharp edges */
    CWI_FIXED  /* ends, bends and meetings of sharp edges */
} cwi_freedom;

/* A surface that triangles must stay near. Edges are kept as triangles without area. */
typedef struct cwi_target {
    cw_mesh mesh; /* borrows positions */
    cwi_boxes tree;
    float *normals; /* unit vectors of triangles; or NULL: any direction will do */
    float *limits;  /* distance allowed from each triangle */
} cwi_target;

/* Triangles that take the place of others. All have a common first corner, the pivot. */
typedef struct cwi_replacement {
    uint32_t old[CWI_MAX_ONE_RING]; /* triangles that go */
    size_t old_count;
    uint32_t fresh[CWI_MAX_ONE_RING][3]; /* corners of those that come */
    uint32_t ids[CWI_MAX_ONE_RING];      /* triangles that become them */
    uint8_t sharp[CWI_MAX_ONE_RING];     /* bits of their edges */
    size_t count;
    uint32_t moved; /* a vertex with another position; or CWI_NONE */
    float position[3];
    size_t samples; /* of the old triangles: the first ones of the scratch arrays */
} cwi_replacement;

typedef struct cwi_remesh {
    cw_remesh_desc desc; /* resolved */
    const cw_mesh *input;
    cwi_target surface, curves;
    float *target_sizes;  /* at each vertex of the input; or NULL: edge_mm everywhere */
    uint32_t *input_twin; /* twins, bits and freedom as the work begins */
    uint8_t *input_bits, *input_freedom;
    float *sample_limits; /* how far the result may be from each vertex of the input */
    double limit_mm;      /* the largest of all limits */
    double rounding_mm;   /* what positions in single precision are off by */
    double done;          /* of the progress */

    /* The mesh at work. A corner 3t + k stands for the edge to the next corner, too. */
    float *positions, *sizes;
    uint32_t *corner; /* one at each vertex; CWI_NONE: the vertex is gone */
    uint8_t *freedom;
    size_t vertex_count, vertex_capacity;
    uint32_t *triangles, *twin; /* twin: the corner of the same edge beyond; or CWI_NONE */
    uint32_t *first_sample;     /* of each triangle */
    uint8_t *bits;
    size_t triangle_count, triangle_capacity;

    /* Samples are the vertices of the input. Each belongs to the triangle that is near it. */
    uint32_t *next_sample, *scratch, *scratch_ends;
    uint8_t *scratch_to; /* number of the fresh triangle */
    cwi_replacement patch;
} cwi_remesh;

static inline bool cwi_is_sharp(const cwi_remesh *r, uint32_t corner)
{
    return r->bits[corner / 3] >> corner % 3 & CWI_SHARP;
}

static inline bool cwi_is_dead(const cwi_remesh *r, size_t triangle)
{
    return r->bits[triangle] & CWI_DEAD;
}

/* Returns the length of an edge, in units of the length wanted there. */
static inline double cwi_relative_length(const cwi_remesh *r, uint32_t a, uint32_t b)
{
    const double target_length = ((double)r->sizes[a] + (double)r->sizes[b]) / 2;
    return sqrt(cwi_point_distance_sq(r->positions + 3 * (size_t)a,
                                      r->positions + 3 * (size_t)b)) /
           target_length;
}

/* Returns the largest cosine of a triangle's angles, which is that of the smallest one; 2 without
 * area. normal: its direction, with the length of twice its area; or NULL */
double cwi_largest_cosine(const float *a, const float *b, const float *c, double normal[3]);

/* --- the input ---------------------------------------------------------------------------- */

/* Links the triangles of the input, finds its features, and builds the trees. Marks edges of the
 * mesh at work, which is a copy afterwards.
 * Returns  CW_ERR_FORMAT when the mesh is no oriented manifold; CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_remesh_begin(cwi_remesh *r, cw_error *err);

/* Marks sharp edges, and decides how vertices may move. Triangles are linked. */
void cwi_find_features(cwi_remesh *r);

/* Makes the mesh at work a copy of the input again. */
void cwi_remesh_restart(cwi_remesh *r);

/* Finds the wanted length of edges at each vertex of the input by its curvature. */
CW_NODISCARD cw_status cwi_remesh_size(cwi_remesh *r, cw_error *err);

/* Frees all but the description. */
void cwi_remesh_free(cwi_remesh *r);

/* Finds the point of a target closest to another point, and the wanted length of edges there.
 * size  of the surface only; or NULL */
void cwi_remesh_project(const cwi_remesh *r, const cwi_target *target, const double from[3],
                        float to[3], float *size);

/* --- patches ------------------------------------------------------------------------------ */

/* Lists the corners at a vertex counter-clockwise, and returns their number; 0 if there are more
 * than CWI_MAX_ONE_RING. At a border the first and the last corner have an open edge. */
size_t cwi_list_one_ring(const cwi_remesh *r, uint32_t vertex,
                         uint32_t corners[CWI_MAX_ONE_RING], bool *is_border);

/* Returns the largest cosine of the angles in the patch; 2 if a triangle has no area. */
double cwi_patch_cosine(const cwi_remesh *r, const cwi_replacement *patch);

/* Returns the largest cosine of the angles in the triangles that the patch replaces. */
double cwi_patch_cosine_before(const cwi_remesh *r, const cwi_replacement *patch);

/* Returns true if the patch may take its place: near the input, turned as it is, and with all
 * samples near it. Finds the new triangles of the samples. */
bool cwi_patch_fits(cwi_remesh *r, cwi_replacement *patch);

/* Finds the nearest new triangle of each sample, however far. */
void cwi_patch_assign(cwi_remesh *r, cwi_replacement *patch);

/* Gives the samples to the new triangles. The caller has put those in place. */
void cwi_patch_attach(cwi_remesh *r, const cwi_replacement *patch);

/* --- operations; each returns false, and changes nothing, where it is refused ----------------- */

/* Splits the edge of a corner in the middle.
 * Returns  CW_ERR_NO_MEMORY, or CW_ERR_LIMIT beyond 2^32 / 3 triangles */
CW_NODISCARD cw_status cwi_split_edge(cwi_remesh *r, uint32_t corner, bool *is_done,
                                      cw_error *err);

/* Moves a vertex to a neighbour, where both become one.
 * longest  of the new edges, in units of the wanted length
 * cosine   the largest that an angle may have; 2: any */
bool cwi_collapse_edge(cwi_remesh *r, uint32_t vertex, uint32_t to, double longest,
                       double cosine);

/* Flips the edge of a corner in the pair of triangles beside it.
 * by_angle  only if the smallest angle of both grows; else toward six neighbours, too */
bool cwi_flip_edge(cwi_remesh *r, uint32_t corner, bool by_angle);

/* Moves a vertex, if no angle around it becomes smaller than allowed.
 * size    wanted length of edges there
 * cosine  the largest that an angle may have; 2: any */
bool cwi_move_vertex(cwi_remesh *r, uint32_t vertex, const float position[3], float size,
                     double cosine);

/* --- passes over the whole mesh ------------------------------------------------------------ */

CW_NODISCARD cw_status cwi_split_long(cwi_remesh *r, cw_error *err);
CW_NODISCARD cw_status cwi_collapse_short(cwi_remesh *r, cw_error *err);
void cwi_flip_edges(cwi_remesh *r, bool by_angle);

/* Moves all vertices along the surface toward the centre of the triangles around them. */
CW_NODISCARD cw_status cwi_relax_vertices(cwi_remesh *r, cw_error *err);

/* Works on triangles with an angle below the wanted one. */
CW_NODISCARD cw_status cwi_improve_angles(cwi_remesh *r, cw_error *err);

/* Looks for triangles that meet or are too far from the other mesh. Around those the next attempt is
 * allowed half of the distance. */
CW_NODISCARD cw_status cwi_remesh_prove(cwi_remesh *r, const cw_mesh *out,
                                        cw_remesh_facts *facts, bool *is_good, cw_error *err);

#endif
