/* Quality of a mesh: closedness, manifoldness, orientation, self-intersections, size and shapes
 * of triangles. */
#ifndef CUBEWRIGHT_QUALITY_H
#define CUBEWRIGHT_QUALITY_H

#include <cubewright/mesh.h>
#include <cubewright/stream.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The rule by which vertices count as one. */
typedef enum cw_weld {
    CW_WELD_NONE,  /* those with the same index */
    CW_WELD_WORLD, /* those with equal single-precision world points, as readers of STL see */
    CW_WELD_LOCAL, /* those with equal positions */
} cw_weld;

/* Defects of a triangle; bits of cw_quality_desc.defects. */
typedef enum cw_defect {
    CW_DEFECT_OPEN = 1 << 0,         /* has an open edge */
    CW_DEFECT_NONMANIFOLD = 1 << 1,  /* at a non-manifold edge or vertex */
    CW_DEFECT_MISORIENTED = 1 << 2,  /* at a misoriented edge */
    CW_DEFECT_DUPLICATE = 1 << 3,    /* the same vertices as another one */
    CW_DEFECT_DEGENERATE = 1 << 4,   /* no area */
    CW_DEFECT_SLIVER = 1 << 5,       /* a needle or a cap */
    CW_DEFECT_INSIDE_OUT = 1 << 6,   /* of a shell that faces the wrong way */
    CW_DEFECT_INTERSECTING = 1 << 7, /* meets a triangle that is no neighbour */
} cw_defect;

/* Thresholds: a needle's longest side is more than 20 times its shortest. A cap has an angle
 * above 160 degrees; it is not also counted as a needle. */
#define CW_NEEDLE_RATIO  20.0
#define CW_CAP_ANGLE_DEG 160.0

/* Numbers of bins of cw_shapes. */
enum { CW_ANGLE_BINS = 18, CW_ASPECT_BINS = 9, CW_LENGTH_BINS = 20 };

/* The shapes of triangles with an area. The aspect ratio is the circumradius over twice the
 * radius of the inscribed circle: 1 for equal sides. */
typedef struct cw_shapes {
    double min_angle_deg, max_angle_deg, max_aspect; /* extremes of all triangles */
    double min_edge_mm, max_edge_mm;                 /* the shortest and the longest edge */
    size_t angles[CW_ANGLE_BINS];   /* all three of each triangle, 10 degrees per bin */
    size_t smallest[CW_ANGLE_BINS]; /* the smallest of each triangle, 60 / 18 degrees per bin */
    size_t aspects[CW_ASPECT_BINS]; /* up to cw_aspect_ends, and beyond */
    size_t lengths[CW_LENGTH_BINS]; /* of edges: equal steps of the logarithm from min to max */
} cw_shapes;

/* The ends of the bins of aspects; the last bin has no end. */
extern CW_API const double cw_aspect_ends[CW_ASPECT_BINS - 1];

/* Facts on one mesh, counted from its triangles as indexed, unless welded. Edges are unordered
 * vertex pairs of triangles; triangles that name a vertex twice have no edges. */
typedef struct cw_quality {
    size_t vertices, triangles, edges; /* all vertices, also unused ones; triangles; edges */
    size_t components;                 /* sets of triangles joined by vertices */
    size_t unused_vertices;            /* in no triangle, as indexed */
    size_t merged_vertices;            /* in a triangle, but welded to another vertex */
    size_t open_edges;                 /* in one triangle */
    size_t border_loops;               /* closed chains of open edges */
    size_t nonmanifold_edges;          /* in more than two triangles */
    size_t contact_edges; /* of these, those that as many triangles run through one way as the
                                          other: where surfaces touch */
    size_t misoriented_edges;    /* in two triangles that run through it the same way */
    size_t nonmanifold_vertices; /* their triangles form more than one fan */
    size_t contact_vertices; /* of these, those whose edges are in two triangles, or contacts */
    size_t duplicates;       /* triangles with the same vertices as an earlier one */
    size_t degenerate;       /* triangles of zero area in double precision */
    size_t needles, caps;    /* triangles: see above */
    size_t cavities;         /* closed, oriented components facing inward, inside one solid */
    size_t inside_out;  /* closed, oriented components facing inward, other than cavities */
    size_t nested;      /* closed, oriented components facing outward, inside another one */
    size_t open_inward; /* open, oriented components that seem to face inward */
    size_t one_sided;  /* components whose triangles cannot agree, as in a Moebius strip: joined
                              along edges of two triangles */
    size_t to_turn;    /* components that cw_mesh_orient() would turn round */
    int64_t euler;     /* used vertices - edges + triangles */
    int64_t genus;     /* handles of all components; -1 unless an oriented manifold */
    double area_mm2;   /* of all triangles */
    double volume_mm3; /* of closed meshes; signed, positive when triangles wind outward */
    double min[3], max[3]; /* world box, mm */
    cw_shapes shapes;      /* shapes of triangles */
} cw_quality;

/* Options of a measurement. Zero fields mean the default named beside them. */
typedef struct cw_quality_desc {
    uint32_t version; /* 0: the first version of this struct */
    cw_weld weld;     /* default: as indexed */
    bool shells;      /* also count the fields from cavities to to_turn; default: 0 */
    int threads;      /* default: all */
    uint8_t *defects; /* triangle_count: bits of cw_defect are set in it; default: none kept */
    cw_progress progress; /* default: none */
    uint8_t *turn; /* triangle_count, with shells: 1 where cw_mesh_orient() turns the shell
                      round, else 0; default: none kept */
} cw_quality_desc;

/* Measures a mesh in time proportional to its triangles.
 * Returns  CW_ERR_ARGUMENT as cw_mesh_check(); CW_ERR_LIMIT beyond 2^32 / 3 triangles;
 *          CW_ERR_NO_MEMORY; CW_ERR_CANCELLED */
CW_NODISCARD CW_API cw_status cw_quality_measure(const cw_mesh *mesh,
                                                 const cw_quality_desc *desc, cw_quality *out,
                                                 cw_error *err);

/* Returns the bytes that measuring takes besides the mesh. One with open edges takes 12 more for
 * each triangle, one with shells and misoriented edges 59, and a vertex with more than 24 triangles 52 for each of them.
 * vertices, triangles  counts of the mesh */
CW_API size_t cw_quality_bytes(size_t vertices, size_t triangles);

/* A measurement of a surface that comes in chunks, such as those of cw_extract_stream(). It holds
 * the front of the surface only: vertices that may still get triangles, and the triangles that
 * name them or wait for their positions. */
typedef struct cw_quality_stream cw_quality_stream;

/* Options of cw_quality_stream_new(). Zero fields mean the default named beside them. */
typedef struct cw_quality_stream_desc {
    uint32_t version; /* 0: the first version of this struct */
    int threads;      /* default: all */
    size_t max_bytes; /* limit of the memory for the front; default: none */
} cw_quality_stream_desc;

/* Begins a measurement; free it with cw_quality_stream_free(). desc: NULL means all defaults.
 * out      set to the measurement
 * Returns  CW_ERR_NO_MEMORY */
CW_NODISCARD CW_API cw_status cw_quality_stream_new(const cw_quality_stream_desc *desc,
                                                    cw_quality_stream **out, cw_error *err);

/* Returns the sink that takes the chunks. It returns
 *          CW_ERR_ARGUMENT  a chunk does not follow the last one, or has another origin; a
 *                           triangle names a vertex before its chunk; a position is not finite
 *          CW_ERR_LIMIT     the front takes more than max_bytes; more than 2^32 - 1 vertices
 *          CW_ERR_NO_MEMORY
 * Cost     time as cw_quality_measure(); up to 18 bytes for each triangle of the front, and 24
 *          for each number between its first vertex and the highest one that was named */
CW_API cw_chunk_sink cw_quality_stream_sink(cw_quality_stream *stream);

/* Ends the measurement, once. The result is that of cw_quality_measure() of the whole mesh as
 * indexed, to the bit, for any chunks and threads. Three things are not known, and 0:
 * shapes.lengths; merged_vertices; the fields from cavities to to_turn.
 * Returns CW_ERR_ARGUMENT  a triangle names a vertex that did not come; it was finished before
 *         or what the sink returned, if it failed */
CW_NODISCARD CW_API cw_status cw_quality_stream_finish(cw_quality_stream *stream,
                                                       cw_quality *out, cw_error *err);

/* Returns the bytes of the arrays that a measurement holds at present.
 * stream  borrowed */
CW_API size_t cw_quality_stream_bytes(const cw_quality_stream *stream);

/* Frees a measurement. Harmless on NULL. */
CW_API void cw_quality_stream_free(cw_quality_stream *stream);

/* Counts of cw_mesh_orient(). */
typedef struct cw_orient_counts {
    size_t turned;    /* shells, i.e. components, that were turned */
    size_t triangles; /* number of their triangles */
} cw_orient_counts;

/* Turns shells that face the wrong way. Outer shells should face outward. Shells inside an odd
 * number of closed others are cavities and should face inward. Two kinds of shells are left as
 * they are: open ones, since a bowl may face either way, and those that are no manifold or
 * whose triangles do not agree with each other. Vertices at equal positions count as one.
 * Normals are turned with their shell where they agreed with its triangles.
 *
 * mesh     in place: the corners of triangles change places; unchanged on failure
 * counts   may be NULL
 * Returns  as cw_quality_measure() */
CW_NODISCARD CW_API cw_status cw_mesh_orient(cw_mesh *mesh, int threads,
                                             cw_orient_counts *counts, cw_error *err);

/* Fills the voids of solids: leaves out closed components that face inward, then those inside
 * others, which were islands in the voids, and vertices that no triangle names. Open and
 * non-manifold components stay. Triangles are joined by the vertices that they name.
 * mesh     in place, as in cw_mesh_weld(); its closed components face the right way
 * threads  0 means all
 * counts   of components; dropped_mm3 is what the solids gain, largest_mm3 the largest component
 *          that was left out, least_kept_mm3 is not set. May be NULL
 * Returns  as cw_quality_measure() */
CW_NODISCARD CW_API cw_status cw_mesh_fill_voids(cw_mesh *mesh, int threads,
                                                 cw_drop_counts *counts, cw_error *err);

/* Returns true if there are no open, non-manifold or misoriented edges and no non-manifold
 * vertices.
 * quality  from cw_quality_measure() */
CW_API bool cw_quality_is_closed_manifold(const cw_quality *quality);

/* Holds a mesh to the topology of the one that it was made from: as many components and border
 * loops, the same Euler number, and no more non-manifold edges, non-manifold vertices and
 * triangles without area. Both must be measured with the same weld.
 * before, after  borrowed
 * Returns        CW_ERR_CHECK, naming the first that differs and both counts */
CW_NODISCARD CW_API cw_status cw_quality_compare(const cw_quality *before,
                                                 const cw_quality *after, cw_error *err);

/* Options of cw_self_intersections(). Zero fields mean the default named beside them. */
typedef struct cw_crossings_desc {
    uint32_t version; /* 0: the first version of this struct */
    cw_weld weld;     /* the rule that makes triangles neighbours; default: as indexed */
    int threads;      /* default: all */
    uint8_t *defects; /* triangle_count: CW_DEFECT_INTERSECTING is set; default: none kept */
    cw_progress progress; /* default: none */
} cw_crossings_desc;

/* Pairs of triangles that meet. A zeroed struct is valid and empty. */
typedef struct cw_crossings {
    size_t count;    /* number of pairs */
    uint32_t *pairs; /* count x 2 triangles, the lower first, in rising order */
    bool undecided;  /* too many triangles are in one place: some pairs were not checked */
} cw_crossings;

/* Finds every pair of triangles that have a point in common other than the vertex or edge they
 * share: crossing, touching, overlapping or equal. Exact, by signs of determinants;
 * triangles without area are left out (cw_quality counts them).
 *
 * out      filled on success; free it with cw_crossings_free()
 * Returns  as cw_quality_measure(); CW_ERR_CANCELLED
 * Cost     about 1 us a triangle and thread for a surface; bounded where boxes of more than
 *          hundreds of triangles overlap everywhere: undecided is then set
 * Threads  the same pairs for any number
 * Source   [Guigue2003], signs by [Shewchuk1997] */
CW_NODISCARD CW_API cw_status cw_self_intersections(const cw_mesh *mesh,
                                                    const cw_crossings_desc *desc,
                                                    cw_crossings *out, cw_error *err);

/* Frees the pairs and zeroes the struct. Harmless on a zeroed or already freed one. */
CW_API void cw_crossings_free(cw_crossings *crossings);

/* The same facts, computed by CGAL. Self-intersections are those of cw_self_intersections(). */
typedef struct cw_cgal_facts {
    bool is_polygon_mesh; /* an oriented 2-manifold, maybe open; if not, all else is 0 */
    bool closed;          /* no open edges */
    bool bounds_volume;   /* closed, and no shell inside out, nested or meeting another */
    bool outward;         /* bounds_volume, and the outermost shells face outward */
    size_t components;    /* joined by edges */
    size_t border_loops, self_intersections, degenerate, needles, caps; /* as in cw_quality */
    double area_mm2, volume_mm3; /* area; volume of closed meshes */
} cw_cgal_facts;

/* Returns true if this build has the module with CGAL. That module is under the GPL. */
CW_API bool cw_quality_has_cgal(void);

/* Asks CGAL's Polygon Mesh Processing; takes ten times as long as our own checks.
 * weld     the rule by which vertices count as one
 * out      filled on success
 * Returns  as cw_quality_measure(); CW_ERR_UNSUPPORTED without the module; CW_ERR_BACKEND with
 *          CGAL's message when it fails */
CW_NODISCARD CW_API cw_status cw_quality_ask_cgal(const cw_mesh *mesh, cw_weld weld,
                                                  cw_cgal_facts *out, cw_error *err);

/* Computes the one-sided Hausdorff distance from a mesh to a reference by CGAL, within the
 * tolerance.
 * reference     borrowed
 * tolerance_mm  above 0
 * out_mm        set to the distance
 * Returns       as cw_quality_ask_cgal(); CW_ERR_BACKEND for a mesh that is no oriented
 *               manifold */
CW_NODISCARD CW_API cw_status cw_distance_by_cgal(const cw_mesh *mesh, const cw_mesh *reference,
                                                  double tolerance_mm, double *out_mm,
                                                  cw_error *err);

#ifdef __cplusplus
}
#endif

#endif
