/* Repair of broken meshes: closed manifolds without crossings, and a report of what was wrong. */
#ifndef CUBEWRIGHT_REPAIR_H
#define CUBEWRIGHT_REPAIR_H

#include <cubewright/mesh.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Settings of a repair. Zero-initialise the struct and set what you need; a zero field means the
 * default named beside it. */
typedef struct cw_repair_desc {
    uint32_t version;    /* 0: the first version of this struct */
    double weld_mm;      /* vertices this near to each other become one; default: those at equal
                            positions */
    double max_hole_mm;  /* the largest hole to fill: diagonal of the box around its rim;
                            default: all are filled */
    double wrap_mm;      /* last resort: wrap the mesh by a surface that no ball of this radius
                            passes, if all else leaves defects; needs CGAL; default: none */
    bool flat_holes;     /* default: patches in holes go on smoothly from the surface around, so
                            that an open tube gets domes; else they have the least area */
    bool keep_crossings; /* default: triangles around crossings are replaced */
    int threads;         /* default: one per processor */
    cw_progress progress; /* default: none */
} cw_repair_desc;

/* Facts on a repair: counts of each kind of defect, and of what was done about it. */
typedef struct cw_repair_facts {
    size_t welded;     /* vertices that became one with another */
    size_t duplicates; /* triangles with the vertices of another one; dropped */
    size_t degenerate; /* triangles without area; dropped, or their longest edge flipped */
    size_t flipped_triangles;    /* triangles flipped to agree with their neighbours */
    size_t flipped_shells;       /* components flipped: outer ones outward, cavities inward */
    size_t nonmanifold_edges;    /* edges of more than two triangles; parted */
    size_t twisted_edges;        /* edges at which a one-sided surface was cut open */
    size_t nonmanifold_vertices; /* vertices of more than one fan; parted */
    double parted_mm;         /* the farthest that a vertex moved from another at its place */
    size_t sheets;            /* open components without a volume; dropped */
    size_t sheet_triangles;   /* number of their triangles */
    size_t holes_filled;      /* holes of the mesh that were filled */
    size_t holes_left;        /* holes larger than max_hole_mm */
    double largest_hole_mm;   /* diagonal of the largest hole's box */
    double largest_rim_mm;    /* length of that hole's rim */
    double largest_fill_mm2;  /* area of the triangles in it; 0: it is not filled */
    size_t added_triangles;   /* triangles in holes, those around crossings included */
    size_t crossings_before;  /* pairs of triangles that crossed, when all holes were filled */
    size_t crossings_after;   /* pairs of the result */
    size_t touching_vertices; /* vertices moved apart where surfaces only touched */
    size_t united_shells;     /* components that became one with others that they crossed */
    size_t removed_triangles; /* triangles replaced around crossings */
    bool is_wrapped;          /* the result is a wrap */
    bool lacks_cgal;   /* this build has no CGAL to unite components that cross: triangles
                                  around the crossings were replaced */
    bool is_undecided; /* see cw_crossings */
    bool is_needed;    /* the mesh was no closed, oriented manifold without crossings */
    bool is_sound;     /* the result is one */
} cw_repair_facts;

/* Returns true if this build can wrap meshes and unite components, which needs CGAL. That module
 * is under the GPL. */
CW_API bool cw_repair_has_cgal(void);

/* Repairs a mesh: makes it a closed, oriented manifold without crossings, as far as it can. A
 * sound mesh stays as it is.
 *
 * Vertices are welded. Repeated triangles and those without area are dropped. Triangles are
 * flipped to agree with their neighbours. Edges of more than two triangles are parted, and
 * vertices of several fans. Vertices that are parted move one hundredth of their shortest edge
 * from each other. Open components without volume, such as single triangles, are dropped. Holes
 * are filled by smooth patches with triangles as large as those around. Closed components that
 * cross each other are united by CGAL. Around other crossings triangles are removed, and the holes
 * are filled by patches of least area, up to 12 times. At last shells are flipped as by cw_mesh_orient().
 *
 * Vertices and triangles that stay keep their attributes. New vertices take theirs from the closest
 * point of the mesh, interpolated, and the label of the nearest corner there; new triangles those of
 * the triangle closest to their middle. Normals are computed again by cw_mesh_normals() if there are any.
 *
 * What is left is in the facts: is_sound says if the result is sound. With wrap_mm a mesh that is not
 * sound is wrapped instead. The wrap is a closed manifold without crossings around everything: gaps
 * narrower than about wrap_mm are closed, and the surface is up to wrap_mm / 30 outside. Open
 * surfaces become thin solids.
 *
 * mesh     borrowed
 * desc     borrowed; NULL means all defaults
 * out      filled on success, emptied on failure; free it with cw_mesh_free(). NULL: only the facts
 *          are set
 * facts    may be NULL; also set with CW_ERR_EMPTY
 *
 * Returns  CW_ERR_ARGUMENT     a length is negative or not finite, or as cw_mesh_check()
 *          CW_ERR_EMPTY        nothing is left: the mesh encloses no volume
 *          CW_ERR_UNSUPPORTED  wrap_mm is needed, and this build has no CGAL
 *          CW_ERR_LIMIT        beyond 2^32 / 3 triangles or vertices; wrap_mm is too small for the mesh
 *          CW_ERR_NO_MEMORY; CW_ERR_CANCELLED; CW_ERR_BACKEND with CGAL's message when it fails
 * Cost     about 5 us for each triangle, and 3 us for each round that removes crossings;
 *          large holes take longer
 * Threads  reentrant; the same to the bit for any number of threads
 * Source   patches [Barequet1995], [Liepa2003]; crossings [Attene2010]; wraps [Portaneri2022]; see
 *          simplify/repair.md */
CW_NODISCARD CW_API cw_status cw_mesh_repair(const cw_mesh *mesh, const cw_repair_desc *desc,
                                             cw_mesh *out, cw_repair_facts *facts,
                                             cw_error *err);

#ifdef __cplusplus
}
#endif

#endif
