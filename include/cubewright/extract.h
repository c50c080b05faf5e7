/* Volume to mesh: the surface where a volume's trilinear field equals an isovalue. */
#ifndef CUBEWRIGHT_EXTRACT_H
#define CUBEWRIGHT_EXTRACT_H

#include <cubewright/mesh.h>
#include <cubewright/volume.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Maximum of cw_extract_desc.snap. Beyond it, a crossing is closer to the other sample. */
#define CW_EXTRACT_MAX_SNAP 0.5

/* Options of an extraction. Zero-initialise the struct and set what you need. A zero field
 * means the default named beside it. */
typedef struct cw_extract_desc {
    uint32_t version;     /* 0: the first version of this struct */
    double isovalue;      /* in the unit of the values (HU for CT); 0 means 0 */
    bool inside_is_low;   /* default: values at or above the isovalue are inside */
    bool leave_open;      /* default: cap the surface where it meets the end of the data */
    bool simple_topology; /* default: every cell has the topology of the trilinear field; simple
                             uses one table, with one rule for ambiguous faces */
    bool
        cubic_placement; /* default: linear interpolation along edges; cubic: cubic interpolation
                             through four samples along the edge */
    bool no_normals;     /* default: one normal per vertex from the field's gradient */
    double snap;         /* up to 0.5: merge crossings within this share of an edge from one
                             sample, as below; 0.3 is usual; default: none */
    int threads;         /* default: one per processor */
    size_t max_triangles; /* fail with CW_ERR_LIMIT before allocating more; default: no limit */
    size_t max_bytes;     /* the same for mesh and working memory; default: no limit */
    size_t extra_bytes;   /* per triangle: the caller's own needs, counted against max_bytes */
    cw_progress progress; /* default: none */
} cw_extract_desc;

/* The effect of snapping and its cost, in the world (mm) and in index space (voxels). */
typedef struct cw_snap_counts {
    size_t vertices;                         /* merged with others */
    double max_moved_mm, max_moved_voxels;   /* the farthest move of one vertex; no point of the
                                                plain surface or of this one is farther from the
                                                other surface. At most twice the share */
    double max_error_mm, max_error_voxels;   /* distances of merged vertices from their */
    double mean_error_mm, mean_error_voxels; /* old places to the snapped surface */
} cw_snap_counts;

/* The size of an extraction's result, known in advance; with snapping the maximum. */
typedef struct cw_extract_counts {
    size_t vertices;     /* of the mesh */
    size_t triangles;    /* of the mesh */
    size_t border_loops; /* loops along which the surface meets the volume's border */
    size_t bytes;        /* of the mesh and the working memory, together */
    cw_snap_counts snap; /* known after extraction; before it, and without snapping, zero */
} cw_extract_counts;

/* Extracts the surface { p : f(p) = isovalue } of the trilinear field f by marching cubes. On
 * an irregular grid it marches the cells, see below.
 *
 * Vertices are in the volume's world frame (LPS, millimetres) and shared by the triangles
 * around them. Each vertex lies on a grid edge, kept 1/1024 of the edge away from its ends. So
 * samples equal to the isovalue give no zero-area triangle and no pinched vertex. A few
 * ambiguous cells also have vertices inside. In every cell the surface has the topology of f:
 * its components, handles and tunnels. It is a manifold, does not cross itself, and winds
 * counter-clockwise seen from outside. Normals are central differences of the values, one-sided
 * at the border, interpolated. NaN and no-data voxels are outside the domain; infinite ones are
 * beyond every isovalue. Where the domain ends, the surface is closed by a cap 1/1024 of a
 * voxel beyond the last sample, or left open there. A volume without a crossing gives an empty
 * mesh and CW_OK.
 *
 * With snap, crossings near one sample that sides of triangles join become one vertex. It
 * stands on the field's surface in their middle, or at one of them. The needles between them
 * disappear. All statements above stay true, except that vertices lie on grid edges.
 * Components, handles and border loops stay the same. Crossings are left as they were in four
 * cases: where one of these properties is not certain; where the smallest angle around them
 * would shrink; where one of them would be left farther from the surface than a quarter of the
 * share (in voxels); and along open borders.
 *
 * On a sparse grid, leaves and tiles are read only near the surface. The surface is that of the
 * dense grid, in another order. It has no border; regions without a value (NaN, no-data) are
 * capped.
 *
 * On an irregular grid f is linear in tetrahedra, linear along edges, and trilinear in
 * hexahedra. In other cells the surface is bounded by its curves on their faces. All statements
 * above hold, with two exceptions. Distorted cells may make the surface cross itself. Caps lie
 * in the border's faces (those that no other cell has) and have vertices at samples. Cells are
 * neighbours when they have a face with all its corners in common, in whichever order a file
 * lists them. In each set of neighbours the volumes add up to a positive one. Three kinds of
 * faces are borders: a face of three cells or more, one that would turn a cell against itself,
 * and those of cells that lie in each other. Three kinds of cells are left out: those with a
 * NaN or no-data sample, those whose repeated corners leave none of the four shapes, and
 * hexahedra with some edges of length zero. Vertices of the border in one place are moved
 * apart, 1/1024 of the way into their cells. Two cells should share no more than one face, edge
 * or corner; otherwise they may share a triangle's side. Normals are least squares over the
 * edges at a sample, exact where the field is linear.
 *
 * volume   borrowed; at least 2 voxels along each axis; first component and step are used
 * desc     borrowed; NULL means all defaults
 * mesh     zeroed, or filled by an earlier call, whose arrays are then written over or freed.
 *          Filled on success, emptied on failure; free it with cw_mesh_free()
 * counts   what was made; may be NULL
 * err      may be NULL
 *
 * Returns  CW_ERR_ARGUMENT  isovalue is not finite, volume too thin, voxels too small or large
 *                           for single precision (1e-38, 1e38 mm), snap out of range, an
 *                           invalid shape or corner of a cell, a point that is not finite, a
 *                           leaf or tile beyond the volume or in another one, or as
 *                           cw_volume_resolve()
 *          CW_ERR_UNSUPPORTED  snap on a grid that is not even, cubic_placement on a
 *                           rectilinear or irregular one
 *          CW_ERR_LIMIT     more than 2^32 - 1 vertices, or a limit of desc
 *          CW_ERR_NO_MEMORY; CW_ERR_CANCELLED
 * Cost     two passes over the voxels' sign bits after one over the voxels; on an irregular
 *          grid half a microsecond for a cell with a corner inside, a tenth of that for others;
 *          snapping takes some five microseconds for each vertex that it makes, far more than
 *          the rest; in noise five times that
 * Threads  reentrant; the mesh is the same to the bit for any number of threads
 * Source   [Lorensen1987]; faces [Nielson1991]; tunnels after [Chernyaev1995]; simple_topology
 *          [Montani1994]; tetrahedra [Doi1991]; snapping after [Moore1992]; ranks instead of
 *          maps as in extract/dense-grids.md */
CW_NODISCARD CW_API cw_status cw_extract(const cw_volume *volume, const cw_extract_desc *desc,
                                         cw_mesh *mesh, cw_extract_counts *counts,
                                         cw_error *err);

/* Extracts the same surface one slab at a time, so that it is never in memory as a whole. The
 * sink has to deal with one slab before the next is made. Vertices are those of cw_extract(),
 * without normals. Where slabs end depends only on the surface and on `triangles`. On an
 * irregular or a sparse grid the whole surface is one slab.
 *
 * desc       as in cw_extract(), but without snap
 * triangles  minimum of a slab, if there are enough: slabs are whole layers of cells, at least
 *            16 of them
 * sink       called on the calling thread; not at all for a volume without a crossing
 * counts     what was made; bytes are those of the largest slab and the working memory
 *
 * Returns    as cw_extract(); CW_ERR_ARGUMENT also for snap; or what the sink returned */
CW_NODISCARD CW_API cw_status cw_extract_slabs(const cw_volume *volume,
                                               const cw_extract_desc *desc, size_t triangles,
                                               cw_slab_sink sink, cw_extract_counts *counts,
                                               cw_error *err);

/* Counts what cw_extract() would make, without making it. The counts are exact, but
 * with snap the maximum.
 * Returns  as cw_extract() */
CW_NODISCARD CW_API cw_status cw_extract_predict(const cw_volume *volume,
                                                 const cw_extract_desc *desc,
                                                 cw_extract_counts *counts, cw_error *err);

/* An extractor for several surfaces of one volume, at several isovalues or while the volume
 * changes. On dense grids the first extraction reads all voxels and builds an octree of the minimum
 * and maximum value in each brick of 8 x 8 x 8 cells. Later extractions read only the bricks that
 * their isovalue passes through. Meshes are the same to the bit as those of cw_extract().
 *
 * For an irregular grid nothing is kept: each surface is extracted from the start.
 *
 * The extractor holds planes of bits and the tree: at most 1/8 of the bytes of a volume of
 * floats. It runs one extraction at a time; several extractors may share a volume.
 * Source  [Wilhelms1992] */
typedef struct cw_extractor cw_extractor;

/* Prepares to extract from a volume, which is borrowed until the extractor is freed. Each change of
 * its voxels meanwhile has to be told by cw_extractor_update(). Nothing else of it may change.
 * out      set to the extractor; free it with cw_extractor_free()
 * Returns  as cw_extract() */
CW_NODISCARD CW_API cw_status cw_extractor_new(const cw_volume *volume, cw_extractor **out,
                                               cw_error *err);

/* Frees an extractor, and the meshes that it took back. Harmless on NULL. */
CW_API void cw_extractor_free(cw_extractor *extractor);

/* Tells that voxels have changed, before the next extraction and after they were written. The
 * octree is brought up to date for the bricks around a box. If all voxels have changed, or more
 * than an eighth of them, the next extraction reads all, without building the octree; one more
 * without a change in between builds it again. Several boxes take several calls.
 *
 * box      the voxels that may have changed; NULL: all
 * Returns  CW_ERR_ARGUMENT  the box is empty or leaves the volume;
 *          CW_ERR_UNSUPPORTED  a box of an irregular grid
 * Cost     reads the bricks around the box, and whole rows of voxels through it where voxels may
 *          lack a value (floats, no-data) */
CW_NODISCARD CW_API cw_status cw_extractor_update(cw_extractor *extractor, const cw_box *box,
                                                  cw_error *err);

/* Extracts and predicts as cw_extract() and cw_extract_predict().
 * mesh     zeroed, or filled by an earlier call: a mesh that is given again for each frame is
 *          written to the same arrays. Filled on success, emptied on failure; free it with
 *          cw_mesh_free()
 * Returns  as cw_extract() */
CW_NODISCARD CW_API cw_status cw_extractor_extract(cw_extractor *extractor,
                                                   const cw_extract_desc *desc, cw_mesh *mesh,
                                                   cw_extract_counts *counts, cw_error *err);
CW_NODISCARD CW_API cw_status cw_extractor_predict(cw_extractor *extractor,
                                                   const cw_extract_desc *desc,
                                                   cw_extract_counts *counts, cw_error *err);

/* The edge, in cells, of the bricks of cw_extractor_extract_changed(). */
#define CW_EXTRACT_BRICK 16

/* The part of a surface in one brick of cells. Brick (i, j, k) has the 16 x 16 x 16 cells from
 * voxel 16 i - 1 to voxel 16 i + 15 along x, and so on; voxels -1 and dim are beyond the border,
 * where the caps stand. */
typedef struct cw_brick {
    const cw_mesh *mesh; /* its triangles, with vertices of its own; without any: the surface no
                            longer passes through the brick. All bricks have the same origin */
    size_t at[3];        /* its place among the bricks along x, y and z */
    size_t count[3];     /* bricks of the volume along x, y and z */
    size_t index;        /* at[0] + count[0] * (at[1] + count[1] * at[2]) */
} cw_brick;

/* A receiver of bricks, one after the other. A status other than CW_OK stops the maker, which then
 * returns it. The brick belongs to the maker and is invalid after the call. */
typedef struct cw_brick_sink {
    /* Takes one brick, on the calling thread. It may not call the extractor. */
    cw_status (*take)(void *user, const cw_brick *brick, cw_error *err);
    void *user; /* passed to take */
} cw_brick_sink;

/* Extracts the bricks of the surface that may differ from what was given before: the first time,
 * and with another isovalue or other options, all that have a surface; then those around voxels
 * that cw_extractor_update() told of. A renderer keeps one set of buffers for each brick, and
 * replaces those of the bricks that it is given. Together its buffers are then the surface of
 * cw_extract(): the same triangles and positions and normals to the bit, so that bricks fit
 * together without gaps. Vertices on the faces between bricks are in each of them. A brick that
 * was not taken, as the sink failed or the call was cancelled, is given again next time.
 *
 * With leave_open, where voxels have no value, any change gives all bricks: which cells are left
 * out there may depend on voxels far away.
 *
 * desc     as in cw_extract(), but without snap. max_triangles and extra_bytes are for the bricks
 *          of one call, max_bytes also for the memory of up to 64 bricks at a time. Limits are
 *          checked when bricks are made, before they are given
 * sink     called on the calling thread, by rising index; not at all if nothing differs
 * Returns  as cw_extract(); CW_ERR_ARGUMENT also for snap; CW_ERR_UNSUPPORTED for sparse and
 *          irregular grids; or what the sink returned
 * Cost     in proportion to the bricks that changed: some 30 microseconds for one that is crossed
 * Threads  the bricks, and their order, are the same to the bit for any number of threads */
CW_NODISCARD CW_API cw_status cw_extractor_extract_changed(cw_extractor *extractor,
                                                           const cw_extract_desc *desc,
                                                           cw_brick_sink sink, cw_error *err);

/* Takes back a mesh of this extractor or any other, instead of cw_mesh_free(). The next
 * surface is written to its memory, so the system need not clear and hand out new pages. This
 * saves a fifth to an eighth of an extraction's time where surfaces are large. The memory is
 * held until then, or until the extractor is freed.
 * mesh  emptied; its memory belongs to the extractor */
CW_API void cw_extractor_recycle(cw_extractor *extractor, cw_mesh *mesh);

/* Options for taking normals from a field. Zero fields mean the default named beside them. */
typedef struct cw_normals_desc {
    uint32_t version;     /* 0: the first version of this struct */
    bool inside_is_low;   /* default: high values are inside */
    int threads;          /* default: one per processor */
    cw_progress progress; /* default: none */
} cw_normals_desc;

/* Gives the vertices of a mesh the normals of the field around them, so that a simplified
 * surface is shaded like the full one. They are central differences of the values, one-sided at
 * the border, interpolated trilinearly. At vertices of cw_extract() these are its own normals,
 * up to rounding; cubic placement has better ones.
 *
 * Vertices outside the domain (such as those of caps), and vertices where the gradient
 * vanishes, keep the normal that they had. Without one they get the normal of the triangles
 * around them.
 *
 * volume   borrowed; at least 2 voxels along each axis; first component and step are used
 * desc     borrowed; NULL means all defaults
 * mesh     its normals are replaced, or added; unchanged on failure
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
