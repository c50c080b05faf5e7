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
    uint32_t version;   /* 0: the first version of this struct */
    double weld_mm;     /* vertices this near to each other become one; default: those at equal
                            positions, and borders are stitched within a distance that is found */
    double max_hole_mm; /* the largest hole to fill: diagonal of the box around its rim;
                            default: all are filled */
    double wrap_mm; /* after the repair, wrap the mesh by a surface that no ball of this radius
                            passes; needs CGAL; default: none */
    double
        max_move_mm; /* how far the surface may lie from the input, patches of holes left out;
                            default: 1 % of the diagonal of the mesh's box. 2 % of the volume may
                            change for each 1 % of the diagonal. See is_refused */
    bool
        flat_holes; /* patches have the least area; default: they go on smoothly from the surface around, but
                            where a large rim lies in a plane or at the box: there it was cut off */
    bool keep_crossings; /* default: triangles around crossings are replaced */
    bool keep_cracks;    /* default: open edges that lie along each other become one */
    bool outer_only; /* drop all shells inside of others: inner walls, cavities, parts; default:
                            cavities stay, and solids inside of solids become cavities */
    int threads;     /* default: one per processor */
    cw_progress progress; /* default: none */
} cw_repair_desc;

/* Facts on a repair: counts of each kind of defect, and of what was done about it. */
typedef struct cw_repair_facts {
    size_t welded; /* vertices that became one with another */
    size_t
        split_edges; /* open edges that were split at vertices of others that lie along them */
    double
        weld_mm; /* the distance within which vertices became one; 0: at equal positions alone */
    size_t duplicates; /* triangles with the vertices of another one; dropped */
    size_t degenerate; /* triangles without area; dropped, or their longest edge flipped */
    size_t flipped_triangles; /* triangles flipped to agree with their neighbours */
    size_t flipped_shells;    /* components flipped: outer ones outward, cavities inward */
    size_t nonmanifold_edges; /* edges of more than two triangles; parted */
    size_t twisted_edges;     /* edges at which a one-sided surface was cut open */
    size_t
        one_sided; /* one-sided components, such as Moebius strips; dropped, unless damage made
                            them so in a small place: that is cut open */
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
    size_t
        united_shells; /* closed components of a union: they crossed or touched others, or crossed
                                 themselves */
    size_t removed_triangles; /* triangles replaced around crossings */
    size_t inner_shells;      /* shells inside of others; dropped with outer_only */
    double inner_mm3; /* the volume that the solid gains by that: negative where solids were
                             dropped that stood in larger cavities */
    bool is_wrapped;  /* the result is a wrap */
    bool is_union_lacking; /* components that cross were not united: rounding found no union */
    bool is_undecided;     /* see cw_crossings */
    double volume_before_mm3; /* inside of the mesh, about 1 % exact: along 6,912 lines, without
                                 those that leave the mesh more or less often than they enter
                                 it; 0: none is left, or nothing was to repair. Of a sound mesh that is
                                 wrapped: before the wrap */
    double volume_after_mm3;  /* inside of the result; exact */
    double volume_changed; /* what is inside of one of both alone, as a fraction of the volume
                                 before, along lines that meet no patch */
    double moved_mm;       /* the largest movement of a vertex of the input */
    double beyond_mm;      /* how far new vertices lie outside of the input's box */
    double max_move_mm;    /* the bound that was taken */
    bool changes_volume;   /* by more than the bound allows */
    bool moves_far;        /* a vertex moves, or lies beyond the box, by more than the bound */
    bool is_refused;       /* one of the two: this is no repair, and there is no result */
    bool is_needed;        /* the mesh was no closed, oriented manifold without crossings */
    bool is_sound;         /* the result is one */
} cw_repair_facts;

/* Returns true if this build can wrap meshes, which needs CGAL. That module is under the GPL. */
CW_API bool cw_repair_has_cgal(void);

/* Repairs a mesh: makes it a closed, oriented manifold without crossings, as far as it can. A
 * sound mesh stays as it is.
 *
 * Vertices are welded. Open edges that lie along each other become one, and vertices on open edges split them:
 * within weld_mm, or a distance found where those of edges from their nearest partners leap. They are never farther
 * apart than a tenth of the length that both have in common. Repeated triangles and those without area are dropped. Triangles are
 * flipped to agree with their neighbours. Components that no orientation fits, such as Moebius strips, are dropped. Edges of more than two triangles are parted, and
 * vertices of several fans. Open components without volume, such as single triangles, are dropped. Holes
 * are filled by smooth patches with triangles as large as those around. Closed components that
 * cross or touch each other are united as by cw_mesh_boolean(), and those that cross themselves, unless they have
 * patches. Those that enclose a negative volume and are no cavities are turned first. Solids that touch in edges and
 * points alone stay so. Where holes were filled or something crossed, vertices that are still at one place move
 * one thousandth of their shortest edge from each other. Around other crossings
 * triangles are removed, and the holes are filled by patches of least area, up to 12 times. At last
 * shells are flipped as by cw_mesh_orient().
 *
 * With outer_only all closed components face outward before they are united, and then all that lies inside of another
 * goes: the result is the outer boundary of the solid. Walls whose outer and inner side a rim joins stay.
 *
 * Vertices and triangles that stay keep their attributes. New vertices take theirs from the closest
 * point of the mesh, interpolated, and the label of the nearest corner there; new triangles those of
 * the triangle closest to their middle. Normals are computed again by cw_mesh_normals() if there are any.
 *
 * What is left is in the facts: is_sound says if the result is sound. With wrap_mm the result is then wrapped, a sound
 * one as well. Where the repair leaves defects, or drops sheets or one-sided components, the input is wrapped as it is. The
 * wrap is a closed manifold without crossings around everything: gaps narrower than about wrap_mm are closed, and the
 * surface is up to wrap_mm / 30 outside. Open surfaces become thin solids. max_move_mm does not hold for it.
 *
 * mesh     borrowed
 * desc     borrowed; NULL means all defaults
 * out      filled on success, emptied on failure; free it with cw_mesh_free(). NULL: only the facts
 *          are set
 * facts    may be NULL; also set with CW_ERR_EMPTY, and where is_refused
 *
 * Returns  CW_ERR_ARGUMENT     a length is negative or not finite, or as cw_mesh_check()
 *          CW_ERR_EMPTY        nothing is left: the mesh encloses no volume
 *          CW_ERR_CHECK        the repair is refused: its result would have another volume, or lie
 *                              elsewhere; see max_move_mm
 *          CW_ERR_UNSUPPORTED  wrap_mm is set, and this build has no CGAL
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
