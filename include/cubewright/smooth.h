/* Smoothing of noisy meshes: every vertex moves, within a stated distance. */
#ifndef CUBEWRIGHT_SMOOTH_H
#define CUBEWRIGHT_SMOOTH_H

#include <cubewright/mesh.h>

#ifdef __cplusplus
extern "C" {
#endif

/* How vertices move. */
typedef enum cw_smooth_method {
    CW_SMOOTH_TAUBIN, /* toward the mean of the neighbours, then away from it by slightly more:
                           keeps large shapes, and makes triangles regular [Taubin1995] */
    CW_SMOOTH_HC, /* toward the mean of the neighbours, then back by the mean of what neighbours
                         moved: keeps a little more detail [Vollmer1999] */
    CW_SMOOTH_FAIR, /* implicit fairing by cotangents: waves fade by their length in mm, however
                         the triangles are, and vertices hardly move along the surface
                         [Desbrun1999] */
    CW_SMOOTH_METHOD_COUNT
} cw_smooth_method;

/* Returns the name of a method, such as "taubin"; static. NULL for an unknown one.
 * method  any number */
CW_API const char *cw_smooth_method_name(cw_smooth_method method);

/* Settings of a smoothing. Zero-initialise the struct and set what you need; a zero field means
 * the default named beside it. */
typedef struct cw_smooth_desc {
    uint32_t version;     /* 0: the first version of this struct */
    size_t iterations;    /* at most CW_SMOOTH_MAX_ITERATIONS; default: 10. More remove longer
                             waves of noise, and more detail. Of CW_SMOOTH_FAIR the steps, default
                             3: more fade waves shorter than width_mm alone */
    double max_move_mm;   /* how far a vertex may move from its first place; default: half the
                             mean length of the edges */
    bool move_border;     /* default: vertices at open edges, and at junctions of three or more
                             surfaces, stay to the bit. Else they move along these edges, and
                             neither the volume nor the border is kept */
    bool allow_crossings; /* default: no triangles meet that did not meet before */
    int threads;          /* default: one per processor */
    cw_progress progress; /* default: none */
    cw_smooth_method method; /* default: CW_SMOOTH_TAUBIN */
    double width_mm; /* of CW_SMOOTH_FAIR alone: waves of this length keep half their height,
                          shorter ones less, longer ones more; default: 6 mean edges */
} cw_smooth_desc;

/* Maximum of cw_smooth_desc.iterations. */
#define CW_SMOOTH_MAX_ITERATIONS ((size_t)1000)

/* Facts on a finished smoothing. */
typedef struct cw_smooth_facts {
    double limit_mm;          /* max_move_mm, or its default for this mesh */
    double width_mm;          /* of CW_SMOOTH_FAIR, the same; else 0 */
    size_t iterations;        /* those that were made */
    double max_mm, mean_mm;   /* how far vertices moved, those that stayed included */
    double volume_before_mm3; /* signed sums over closed parts; of open parts the volume between
                                 the surface and a vertex of the part */
    double volume_after_mm3;  /* the same, of the smoothed mesh */
    size_t flipped;  /* triangles whose direction changed by 90 degrees or more, or that lost
                            their area */
    size_t border;   /* vertices at open edges; they stay by default */
    size_t junction; /* other vertices at edges of three or more triangles; they stay, too */
    size_t put_back; /* vertices that stayed because their triangles would meet others or lose
                            their area */
    bool undecided;  /* too many triangles are in one place to look for all that meet: see
                            cw_crossings */
} cw_smooth_facts;

/* Smooths a mesh: removes noise from the positions of its vertices. Triangles, scalars, colours and
 * labels stay as they are. Normals are computed again by cw_mesh_normals() if there are any.
 *
 * Smoothing moves the surface. It is meant for meshes without a source: noise and fine detail are the
 * same to it. No vertex is farther than max_move_mm from its first place, in double and in single
 * precision. So no point of either surface is farther than that from the other.
 *
 * By CW_SMOOTH_TAUBIN and CW_SMOOTH_HC vertices also move along the surface: triangles become more
 * regular, and attributes move with their vertices. Afterwards moves are cut to max_move_mm, first
 * their part along the surface. Each closed component moves along its normals until it has its
 * first volume again, as far as max_move_mm allows. Components with a fixed border keep the volume
 * on one side in the same way. Those with junctions have no sides, and no volume to keep.
 *
 * The result does not depend on the unit. 1e-4 mm is as good as 1e4 mm.
 *
 * mesh     in place: its arrays stay where they are; unchanged on failure. Vertices at equal
 *          positions count as different ones, and their edges as open: weld them first
 * desc     borrowed; NULL means all defaults
 * facts    may be NULL
 *
 * Returns  CW_ERR_ARGUMENT  an unknown method; too many iterations; max_move_mm or width_mm is
 *                           negative or not finite; width_mm without CW_SMOOTH_FAIR; or as
 *                           cw_mesh_check()
 *          CW_ERR_LIMIT     beyond 2^32 / 3 triangles or vertices
 *          CW_ERR_NO_MEMORY; CW_ERR_CANCELLED
 * Cost     about 0.4 us for each triangle, and 0.01 us more for each iteration; CW_SMOOTH_FAIR 0.5
 *          us more for each step. Then as cw_self_intersections(). About 80 bytes for each
 *          triangle, CW_SMOOTH_FAIR 250
 * Threads  reentrant; the same to the bit for any number of threads
 * Source   as at each method, with equal weights for the first two; see simplify/smoothing.md */
CW_NODISCARD CW_API cw_status cw_mesh_smooth(cw_mesh *mesh, const cw_smooth_desc *desc,
                                             cw_smooth_facts *facts, cw_error *err);

#ifdef __cplusplus
}
#endif

#endif
