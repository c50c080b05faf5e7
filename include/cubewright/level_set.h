/* Level sets of meshes, and surfaces made from them: offset surfaces and hollow solids. */
#ifndef CUBEWRIGHT_LEVEL_SET_H
#define CUBEWRIGHT_LEVEL_SET_H

#include <cubewright/mesh.h>
#include <cubewright/volume.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Requirements on meshes here: a mesh must enclose something. It has no open edges, no edges of
 * more than two triangles, and no edges that two triangles run through in the same way. It
 * faces outward as a whole. Vertices at equal positions count as different ones: weld them
 * first. Shells may be inside others, facing inward around a cavity, and may cross. A point is
 * inside when the mesh winds around it at least once. */

/* Returns true if this build has OpenVDB, which all functions here need. */
CW_API bool cw_level_set_available(void);

/* Options of a level set of a mesh. Zero fields mean the default named beside them. */
typedef struct cw_level_set_desc {
    uint32_t version;             /* 0: the first version of this struct */
    double voxel_mm;              /* required */
    double inside_mm, outside_mm; /* distances are kept up to this far from the surface; beyond,
                                     values are exactly these; default, and minimum: 3 voxels */
    int threads;                  /* default: all */
    size_t max_bytes; /* fail with CW_ERR_LIMIT when more would be needed; default: no limit */
    cw_progress progress; /* default: none */
} cw_level_set_desc;

/* Makes a sparse grid of the distances (f32, mm, negative inside) from a mesh, along the axes
 * of the world.
 *
 * Distances are to the closest point of the triangles, exact but for rounding (near the surface
 * by a 16-millionth of the grid's length). Signs are exact in the same sense. A surface
 * extracted at 0, with low values inside, is within half a voxel of the mesh. The mesh is
 * within half a voxel of it where the mesh is smooth at the scale of voxels. Edges of 90
 * degrees lose up to 0.71 voxels and corners 1.16, sharper ones more (cw_mesh_offset() restores
 * them). Parts thinner than a voxel may be lost.
 *
 * mesh     borrowed
 * desc     borrowed
 * volume   filled on success, zeroed on failure; free it with cw_volume_free()
 * err      may be NULL
 *
 * Returns  CW_ERR_ARGUMENT     no voxel_mm; a length is negative or not finite; the mesh does
 *                              not meet the requirements above, or as cw_mesh_check()
 *          CW_ERR_UNSUPPORTED  this build has no OpenVDB
 *          CW_ERR_LIMIT        max_bytes, or more than 65535 voxels along an axis: the message
 *                              names the voxels that would do
 *          CW_ERR_NO_MEMORY; CW_ERR_CANCELLED
 * Cost     some three microseconds of one processor for a voxel that is kept; 9 bytes for each
 *          within the larger of the two distances, and for those around them
 * Threads  reentrant; the same to the bit for any number of threads
 * Source   distances by OpenVDB [Museth2013]; signs as in extract/level-sets.md */
CW_NODISCARD CW_API cw_status cw_level_set_from_mesh(const cw_mesh *mesh,
                                                     const cw_level_set_desc *desc,
                                                     cw_volume *volume, cw_error *err);

/* Options of an offset surface. Zero fields mean the default named beside them. */
typedef struct cw_offset_desc {
    uint32_t version;     /* 0: the first version of this struct */
    double offset_mm;     /* outward; negative: inward; 0: the mesh's surface, rebuilt */
    double voxel_mm;      /* default: the finer of 1/256 of the box's diagonal and 1/4 of the
                             offset, but at least 1/512 of the diagonal; with max_bytes, as
                             coarse as the limit requires */
    bool no_sharpen;      /* default: edges and corners that the voxels cut off are restored */
    bool no_refine;       /* default: for offset 0, smaller voxels or divided voxels are used if
                             half a voxel is not kept */
    int threads;          /* default: all */
    size_t max_bytes;     /* default: no limit */
    cw_progress progress; /* default: none */
} cw_offset_desc;

/* Facts on a finished offset. */
typedef struct cw_offset_facts {
    double voxel_mm; /* size of the voxels that were used */
    double asked_mm; /* size of the first voxels: as requested, or chosen */
    double least_mm; /* smallest parts into which voxels were divided; 0: none were */
    bool is_astray;  /* for offset 0: the result is not within half of the first voxels */
    size_t more_components, more_handles; /* for offset 0: more than the mesh has */
} cw_offset_facts;

/* Makes the surface of all points nearer to the inside of a mesh than offset_mm. An inward
 * offset takes the points at least that far from the outside. The surface is closed, a
 * manifold, and free of crossings. Convex corners come out round, as the distance from them is.
 *
 * Edges and corners that voxels cut off are restored. Sides of triangles across them get
 * vertices where the tangent planes at both ends meet, unless that would fold, flatten or cross
 * something. Most right angles are then exact, the others within about half a voxel. Sharper
 * angles may lose more than a voxel in places, except for an offset of 0.
 *
 * With an offset of 0 the result is within half a voxel of the mesh and the mesh within half a
 * voxel of it. The result has neither more components nor more handles. This is checked. If it
 * does not hold, everything is made again from the same samples, some of which are moved: those
 * next to sharp edges, tips, and walls and gaps thinner than a voxel move to these. If that
 * does not help either, voxels of half the size are used, and then of a quarter; half of the
 * first voxel is still the limit. Smaller voxels are not used if max_bytes forbids them, or if
 * there would be many for a surface that is more than a voxel off. All this takes twice the
 * time, or with smaller voxels eight and thirty times.
 *
 * A mesh that is thin all over, such as bone in a scan, needs another way. Voxels are divided
 * where half of one is not kept, down to an eighth; samples between those stand in still
 * thinner parts. So the result is within half a voxel there too; is_astray is set if it is not,
 * or if max_bytes forbids it. But it may be in more pieces and have more handles, which are
 * counted. Edges that are kept to half a voxel are not restored, and there are more triangles
 * there. This takes one to three times the time again. For a mesh that crosses itself or has
 * solids inside solids, only the distance of the result from it is checked. no_sharpen leaves
 * out all of this; no_refine leaves out smaller and divided voxels. Attributes are not kept.
 *
 * out       filled on success, with normals; emptied on failure; free it with cw_mesh_free()
 * facts     may be NULL
 *
 * Returns  CW_ERR_EMPTY for an offset inward that leaves nothing; CW_ERR_CHECK: rounding makes the
 *          result cross itself, and other voxels help; else as cw_level_set_from_mesh(),
 *          cw_extract(), cw_self_intersections()
 * Threads  the same to the bit for any number
 * Source   edges after [Kobbelt2001], [Attene2005]; parts of voxels after [Frisken2000] */
CW_NODISCARD CW_API cw_status cw_mesh_offset(const cw_mesh *mesh, const cw_offset_desc *desc,
                                             cw_mesh *out, cw_offset_facts *facts,
                                             cw_error *err);

/* A round hole from the largest cavity to the outside: a circle with 64 corners. It starts with half a
 * ball at the cavity's farthest point in a direction; on a flat floor, in the middle of the floor. It
 * goes straight on through everything in its way. */
typedef struct cw_drain {
    double diameter_mm;  /* at least 2 voxels */
    double direction[3]; /* in the world; of any length but 0 */
} cw_drain;

/* Lattices: walls along triply periodic minimal surfaces, which part the space into two channels of the
 * same kind, without a support or a corner. */
typedef enum cw_infill_kind {
    CW_INFILL_GYROID,    /* Schoen's */
    CW_INFILL_SCHWARZ_P, /* channels along the axes, through cubes */
    CW_INFILL_DIAMOND, /* Schwarz D: channels as bonds of a diamond; the most wall of the three */
    CW_INFILL_COUNT
} cw_infill_kind;

/* Returns a lattice's name: gyroid, schwarz-p, diamond.
 * kind     of lattice; of any other number NULL is returned */
CW_API const char *cw_infill_name(cw_infill_kind kind);

/* Options of a lattice. Walls have one thickness, or change from wall_mm to end_wall_mm by a depth or
 * by a volume. Both are at most 1/3 of a cell, of diamond 0.24: else channels close. */
typedef struct cw_infill_desc {
    uint32_t version;    /* 0: the first version of this struct */
    cw_infill_kind kind; /* default: gyroid */
    double cell_mm;      /* required: edge of a cell, the period of the lattice */
    double wall_mm;      /* required: thickness of the walls */
    double end_wall_mm;  /* thickness where the depth or the value ends; default: as wall_mm */
    double depth_mm;     /* walls are end_wall_mm thick this far below the cavity's surface, and
                            wall_mm at it; default: not by depth */
    const cw_volume *by; /* walls are wall_mm thick at its least value and outside of it, and
                            end_wall_mm at its greatest; dense; default: not by a volume */
} cw_infill_desc;

/* Options of hollowing a mesh. Zero fields mean the default named beside them. */
typedef struct cw_hollow_desc {
    uint32_t version;             /* 0: the first version of this struct */
    double wall_mm;               /* required; at least 2 voxels */
    const cw_drain *drains;       /* drain_count of them */
    size_t drain_count;           /* default: none, the cavities stay closed */
    double voxel_mm;              /* default: 1/4 of the wall or of the narrowest drain; with
                               max_bytes, as coarse as the limit requires, up to 1/2 */
    bool no_measure;              /* default: the wall is measured */
    int threads;                  /* default: all */
    size_t max_bytes;             /* default: no limit */
    cw_progress progress;         /* default: none */
    const cw_infill_desc *infill; /* lattice in the cavities; default: none. Voxels are at most
                                     1/4 of its walls, whatever max_bytes is */
} cw_hollow_desc;

/* Facts on a finished hollowing. */
typedef struct cw_hollow_facts {
    double voxel_mm;                 /* size of the voxels that were used */
    size_t cavities, sealed;         /* closed cavities before drains are made, and after: as
                                        cw_quality_measure() counts them with shells, with those
                                        of the mesh */
    size_t filled;                   /* cavities smaller than a ball as wide as the wall is
                                        thick, and with a lattice those that no drain meets: they
                                        are not made */
    double filled_mm3;               /* volume of all of them together */
    double removed_mm3;              /* volume of the mesh minus volume of the result */
    double wall_min_mm, wall_max_mm; /* the smallest and largest distance of points of the
                                        cavities' surfaces from the outer surface; 0: not
                                        measured. Where drains begin, the wall before they were
                                        made */
    size_t drains;                   /* made: with a lattice one for each channel */
    size_t loose;            /* pieces of a lattice that drains cut off: they are left out */
    size_t infill_samples;   /* points at which walls of the lattice were measured */
    double infill_min_mm;    /* thickness along normals of the middle, the thinnest; 0: not
                                measured */
    double infill_median_mm; /* the median of them */
    double infill_max_mm;    /* the thickest */
} cw_hollow_facts;

/* Hollows a solid and leaves a wall.
 *
 * Without drains the mesh stays as it is, vertex for vertex and triangle for triangle, with its
 * normals, if any. After its arrays come the surfaces of the cavities, at wall_mm from it,
 * facing inward. Drains are subtracted from that as by cw_mesh_boolean(): vertices outside of
 * them keep their place, and triangles that they do not meet stay whole. Shells that cross are united then, and
 * normals, if any, are computed again by cw_mesh_normals(). Other attributes are not kept.
 *
 * A lattice stands in the cavities, and is one with the wall around it. Its cells are counted from the
 * middle of the mesh's box. Distances from its middle are exact, so its walls are as thick as asked
 * within the error of voxels. It parts each cavity into two channels. Drains are made for each channel
 * of at least a quarter of the largest one's volume that no drain in that direction meets yet. Channels
 * that no drain meets are filled then: none stays closed. Without drains the channels stay closed.
 *
 * out      filled on success, emptied on failure; free it with cw_mesh_free()
 * facts    may be NULL
 *
 * Returns  CW_ERR_ARGUMENT  no wall; a wall or a drain thinner than 2 voxels; a direction of
 *                           length 0; cells without open channels; or as cw_level_set_from_mesh()
 *          CW_ERR_EMPTY     no point is deep enough for a cavity inside the wall
 *          CW_ERR_CHECK     rounding finds no surface without crossings around the drains, or
 *                           makes those of the cavities cross themselves
 *          else as cw_level_set_from_mesh(), cw_extract(), cw_distance_to_mesh()
 * Threads  the same to the bit for any number
 * Source   lattices by their nodal approximations [Wohlgemuth2001], nearest points [Hartmann1999] */
CW_NODISCARD CW_API cw_status cw_mesh_hollow(const cw_mesh *mesh, const cw_hollow_desc *desc,
                                             cw_mesh *out, cw_hollow_facts *facts,
                                             cw_error *err);

#ifdef __cplusplus
}
#endif

#endif
