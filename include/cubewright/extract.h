/* Volume to mesh: the surface where a volume's trilinear field equals an isovalue. */
#ifndef CUBEWRIGHT_EXTRACT_H
#define CUBEWRIGHT_EXTRACT_H

#include <cubewright/mesh.h>
#include <cubewright/volume.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The most that cw_extract_desc.snap may be: beyond, a crossing is close to the
 * other sample. */
#define CW_EXTRACT_MAX_SNAP 0.5

/* How to take a surface out of a volume. Zero-initialise it and set what you need;
 * a zero field means the default named beside it. */
typedef struct cw_extract_desc {
    double isovalue;      /* in the unit of the values (HU for CT); 0 means 0 */
    bool inside_is_low;   /* default: values at or above the isovalue are inside */
    bool leave_open;      /* default: cap the surface where it meets the end of the data */
    bool simple_topology; /* default: in every cell the topology of the trilinear field; simple
                             is one table, with one rule for ambiguous faces */
    bool cubic_placement; /* default: vertices where the field, linear along edges, is the
                             isovalue; cubic: where the cubic through four samples along the
                             edge is */
    bool no_normals;      /* default: one normal per vertex from the field's gradient */
    double snap;          /* up to 0.5: merge crossings within this share of an edge from one
                             sample, as below; 0.3 is usual; default: none */
    int threads;          /* default: all that OpenMP offers */
    size_t max_triangles; /* fail with CW_ERR_LIMIT before allocating more; default: no limit */
    size_t max_bytes;     /* likewise for mesh and working memory; default: no limit */
    size_t
        extra_bytes; /* a triangle: what the caller needs besides, counted against max_bytes */
    cw_progress progress; /* default: none */
} cw_extract_desc;

/* What snapping did, and what it cost: in the world, and in voxels, that is in index space. */
typedef struct cw_snap_counts {
    size_t vertices;                         /* that were merged with others */
    double max_moved_mm, max_moved_voxels;   /* the farthest that one was moved; no point of
                                                the plain surface or of this one is farther
                                                from the other. At most twice the share */
    double max_error_mm, max_error_voxels;   /* distances of vertices that were merged, from */
    double mean_error_mm, mean_error_voxels; /* where they were to the snapped surface */
} cw_snap_counts;

/* What an extraction makes, known before it is made; with snapping the most it can be. */
typedef struct cw_extract_counts {
    size_t vertices;
    size_t triangles;
    size_t border_loops; /* loops along which the surface meets the volume's border */
    size_t bytes;        /* of the mesh and the working memory, together */
    cw_snap_counts snap; /* known when it is made; before, and without snapping, zero */
} cw_extract_counts;

/* Extracts the surface { p : f(p) = isovalue } of the trilinear field f by marching cubes; on
 * an irregular grid by marching its cells, see below.
 *
 * Vertices are in the volume's world frame (LPS, millimetres) and shared by the triangles
 * around them; each lies on a grid edge, kept 1/1024 of the edge away from its ends, so that
 * samples equal to the isovalue give no zero-area triangle and no pinched vertex; a few
 * ambiguous cells have vertices inside. In every cell the surface has the topology of f: its
 * components, handles and tunnels. It is a manifold, does not cross itself, and winds
 * counter-clockwise seen from outside. Normals are central differences of the values, one-sided
 * at the border, interpolated. NaN and no-data voxels are outside the domain and infinite ones
 * beyond every isovalue. Where the domain ends the surface is closed by a cap 1/1024 of a voxel
 * beyond the last sample, or left open there. A volume without a crossing gives an empty mesh
 * and CW_OK.
 *
 * With snap, crossings near one sample that sides of triangles join become one vertex, on the
 * field's surface in their middle or where one of them was, and the needles between them go.
 * All that is said above stays true, but that vertices lie on grid edges; components, handles
 * and border loops are the same ones. Crossings are left as they were where anything of that is
 * not certain, where the smallest angle around them would shrink, where one of them would be
 * left farther from the surface than a quarter of the share (in voxels), and along open
 * borders.
 *
 * Of a sparse grid leaves and tiles are read near the surface only, and the surface is that of
 * the dense grid, in another order; it has no border, and what has no value (NaN, no-data) is
 * capped.
 *
 * On an irregular grid f is linear in tetrahedra, along edges, and trilinear in hexahedra; the
 * surface in other cells is bounded by what it is on their faces. All that is said above holds
 * but for two things: distorted cells may make it cross itself, and caps lie in the border's
 * faces, those that no other cell has, and have vertices at samples. Cells are neighbours when
 * they have a face with all its corners in common, whichever way round a file has them: in each
 * set of neighbours volumes add up to a positive one. A face of three cells or more, one that
 * would turn a cell against itself, and those of cells that lie in each other are borders.
 * Cells with a NaN or no-data sample are not there, nor are those whose repeated corners leave
 * none of the four shapes, nor a hexahedron with some edges of no length. Vertices of the
 * border in one place are moved apart, 1/1024 of the way into their cells. Two cells should
 * have no more in common than one face, edge or corner: else they may share a triangle's side.
 * Normals are least squares over the edges at a sample, exact where the field is linear.
 *
 * volume   borrowed; at least 2 voxels along each axis; first component and step are used
 * desc     borrowed; NULL means all defaults
 * mesh     filled on success, emptied on failure; free it with cw_mesh_free()
 * counts   what was made; may be NULL
 * err      may be NULL
 *
 * Returns  CW_ERR_ARGUMENT  isovalue is not finite, volume too thin, voxels too small or large
 *                           for single precision (1e-38, 1e38 mm), snap out of range, a cell's
 *                           shape or corner that is none, a point that is not finite, a
 *                           leaf or tile beyond the volume or in another, or as
 *                           cw_volume_resolve()
 *          CW_ERR_UNSUPPORTED  snap on a grid that is not even, cubic_placement on a
 *                           rectilinear or irregular one
 *          CW_ERR_LIMIT     more than 2^32 - 1 vertices, or a limit of desc
 *          CW_ERR_NO_MEMORY; CW_ERR_CANCELLED
 * Cost     two passes over the voxels' sign bits after one over the voxels; on an irregular
 *          grid half a microsecond a cell with a corner inside, a tenth of that for others;
 *          snapping takes some five microseconds for each vertex that it makes, far more than
 *          the rest; in noise five times that
 * Threads  reentrant; the mesh is the same to the bit for any number of threads
 * Source   [Lorensen1987]; faces [Nielson1991]; tunnels after [Chernyaev1995]; simple_topology
 *          [Montani1994]; tetrahedra [Doi1991]; snapping after [Moore1992]; ranks in place of
 *          maps as in extract/dense-grids.md */
CW_NODISCARD CW_API cw_status cw_extract(const cw_volume *volume, const cw_extract_desc *desc,
                                         cw_mesh *mesh, cw_extract_counts *counts,
                                         cw_error *err);

/* The same surface a slab at a time, so that all of it never is in memory: what is left of one
 * slab is the sink's business before the next is made. Vertices are those of cw_extract(),
 * without normals; where slabs end depends on the surface and on `triangles` only. On an
 * irregular grid all of it is one slab.
 *
 * desc       as in cw_extract(), but without snap
 * triangles  of a slab, at least, where there are so many: slabs are whole layers of cells,
 *            and 16 of them at least
 * sink       called on the calling thread; not at all for a volume without a crossing
 * counts     what was made; bytes are those of the largest slab and the working memory
 *
 * A sparse grid's surface comes as one slab.
 * Returns    as cw_extract(); CW_ERR_ARGUMENT also for snap; or what the sink returned */
CW_NODISCARD CW_API cw_status cw_extract_slabs(const cw_volume *volume,
                                               const cw_extract_desc *desc, size_t triangles,
                                               cw_slab_sink sink, cw_extract_counts *counts,
                                               cw_error *err);

/* Counts what cw_extract() would make, without making it; same arguments and errors. */
CW_NODISCARD CW_API cw_status cw_extract_predict(const cw_volume *volume,
                                                 const cw_extract_desc *desc,
                                                 cw_extract_counts *counts, cw_error *err);

/* A volume that is asked for several surfaces. Of dense grids the first extraction reads all
 * voxels, and on the way builds an octree of the lowest and highest value in each brick of 8 x
 * 8 x 8 cells; later ones read the bricks that their isovalue passes through, and no others.
 * Meshes are the same to the bit as those of cw_extract().
 *
 * Of an irregular grid nothing is kept: each surface is extracted anew.
 *
 * Holds planes of bits and the tree: at most 1/8 of the bytes of a volume of floats. One
 * extraction at a time; several extractors may share a volume.
 * Source  [Wilhelms1992] */
typedef struct cw_extractor cw_extractor;

/* Prepares to extract from a volume, which is borrowed: it has to stay, unchanged, until the
 * extractor is freed. Free with cw_extractor_free(). Errors as cw_extract(). */
CW_NODISCARD CW_API cw_status cw_extractor_new(const cw_volume *volume, cw_extractor **out,
                                               cw_error *err);
CW_API void cw_extractor_free(cw_extractor *extractor); /* harmless on NULL */

/* As cw_extract() and cw_extract_predict(). */
CW_NODISCARD CW_API cw_status cw_extractor_extract(cw_extractor *extractor,
                                                   const cw_extract_desc *desc, cw_mesh *mesh,
                                                   cw_extract_counts *counts, cw_error *err);
CW_NODISCARD CW_API cw_status cw_extractor_predict(cw_extractor *extractor,
                                                   const cw_extract_desc *desc,
                                                   cw_extract_counts *counts, cw_error *err);

/* In place of cw_mesh_free(), for a mesh of this extractor or any other: the next surface is
 * written to its memory, which the system then has not to clear and hand out again. A fifth to
 * an eighth of an extraction's time is saved where surfaces are large. The memory is held until
 * then, or until the extractor is freed. */
CW_API void cw_extractor_recycle(cw_extractor *extractor, cw_mesh *mesh);

/* How to take normals from a field. Zero fields mean the default named beside them. */
typedef struct cw_normals_desc {
    bool inside_is_low;   /* default: high values are inside */
    int threads;          /* default: all that OpenMP offers */
    cw_progress progress; /* default: none */
} cw_normals_desc;

/* Gives the vertices of a mesh the normals of the field around them, so that a simplified
 * surface is shaded as the full one is: central differences of the values, one-sided at the
 * border, interpolated trilinearly. At vertices of cw_extract() these are its own normals, to
 * rounding; cubic placement has better ones.
 *
 * Vertices outside the domain (those of caps are), and where the gradient vanishes, keep the
 * normal that they had; without one they get that of the triangles around them.
 *
 * volume   borrowed; at least 2 voxels along each axis; first component and step are used
 * desc     borrowed; NULL means all defaults
 * mesh     its normals are replaced, or added; as it was on failure
 * err      may be NULL
 *
 * Returns  CW_ERR_ARGUMENT  volume too thin, or as cw_volume_resolve(), cw_mesh_check();
 *          CW_ERR_UNSUPPORTED  the grid is irregular; CW_ERR_NO_MEMORY; CW_ERR_CANCELLED
 * Cost     half a microsecond a vertex
 * Threads  reentrant; the same to the bit for any number of threads */
CW_NODISCARD CW_API cw_status cw_extract_normals(const cw_volume *volume,
                                                 const cw_normals_desc *desc, cw_mesh *mesh,
                                                 cw_error *err);

#ifdef __cplusplus
}
#endif

#endif
