/* Mesh to level set, and what is made from that: surfaces at a distance, and hollow ones. */
#ifndef CUBEWRIGHT_LEVEL_SET_H
#define CUBEWRIGHT_LEVEL_SET_H

#include <cubewright/mesh.h>
#include <cubewright/volume.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Meshes are taken here that enclose something: without open edges, without edges of more than
 * two triangles or of two that run through it the same way, and facing outward as a whole.
 * Vertices at equal positions count as different ones: weld them first. Shells may be inside
 * others, facing inward around a cavity, and may cross: inside is what the mesh winds around at
 * least once. */

/* Whether this build can: whether it has OpenVDB. */
CW_API bool cw_level_set_available(void);

/* What a level set of a mesh keeps. Zero fields mean the default named beside them. */
typedef struct cw_level_set_desc {
    double voxel_mm;              /* required */
    double inside_mm, outside_mm; /* up to so far from the surface distances are kept; beyond,
                                     values are just that; default, and least: 3 voxels */
    int threads;                  /* default: all */
    size_t max_bytes; /* fail with CW_ERR_LIMIT when more would be needed; default: no limit */
    cw_progress progress; /* default: none */
} cw_level_set_desc;

/* Makes a sparse grid of the distances (f32, mm, negative inside) from a mesh, along the axes
 * of the world.
 *
 * Distances are to the closest point of the triangles, exact but for rounding (near the surface
 * by a 16-millionth of the grid's length); so are signs. A surface that is extracted at 0, with
 * low values inside, is within half a voxel of the mesh, and the mesh of it, where the mesh is
 * smooth as far as voxels can tell. Edges of 90 degrees lose up to 0.71 voxels and
 * corners 1.16, sharper ones more (cw_mesh_offset() puts them back); what is thinner than a
 * voxel may be lost.
 *
 * mesh     borrowed
 * desc     borrowed
 * volume   filled on success, zeroed on failure; free it with cw_volume_free()
 * err      may be NULL
 *
 * Returns  CW_ERR_ARGUMENT     no voxel_mm; a length is negative or not finite; the mesh is not
 *                              one of those named above, or as cw_mesh_check()
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

/* A surface at a distance. Zero fields mean the default named beside them. */
typedef struct cw_offset_desc {
    double offset_mm;     /* outward; negative: inward; 0: the mesh's surface, made anew */
    double voxel_mm;      /* default: the finer of 1/256 of the box's diagonal and 1/4 of the
                             offset, but 1/512 of the diagonal at the least, and, with max_bytes,
                             as coarse as it takes */
    bool no_sharpen;      /* default: edges and corners that the voxels cut off are put back */
    bool no_refine;       /* default: by 0, smaller voxels, or parts of some, if half of one is
                             not kept */
    int threads;          /* default: all */
    size_t max_bytes;     /* default: no limit */
    cw_progress progress; /* default: none */
} cw_offset_desc;

/* What an offset made. */
typedef struct cw_offset_facts {
    double voxel_mm; /* those that were taken */
    double asked_mm; /* those it began with: as asked for, or chosen */
    double least_mm; /* the smallest parts that some were divided into; 0: none were */
    bool is_astray;  /* by 0: it is not within half of those it began with */
    size_t more_components, more_handles; /* by 0: than the mesh has */
} cw_offset_facts;

/* Makes the surface of all that is nearer to the inside of a mesh than offset_mm, or, inward,
 * that is so far from its outside: closed, a manifold, free of crossings. Convex corners come
 * out round, as the distance from them is.
 *
 * Edges and corners that voxels cut off are put back: sides of triangles across them get
 * vertices where the tangent planes at both ends meet, unless that would fold, flatten or cross
 * something. Of right angles most are then exact and the others within some half a voxel;
 * sharper ones may lose more than a voxel in places, but for an offset of 0.
 *
 * By 0 the result is within half a voxel of the mesh and the mesh within half a voxel of it,
 * and it has neither more components nor more handles. That is looked at; if it is not so, all
 * is made again from the same samples, those next to sharp edges, tips, and walls and gaps
 * thinner than a voxel moved to these; and if that does not do either, with voxels of half the
 * size, and of half that (half of the first is still what is kept), unless max_bytes forbids or
 * it would be many for a surface that is more than a voxel off. In all that takes twice the
 * time, or with smaller voxels eight and thirty times.
 *
 * What is thin all over, as bone in a scan, needs another way: voxels are divided where half of
 * one is not kept, down to an eighth, and samples between those stand in what is thinner still.
 * So the result is within half a voxel there too (is_astray is set should it not be, or should
 * max_bytes forbid it), but may be in more pieces and have more handles, which are counted;
 * edges that are kept to half a voxel are not put back; and it has more triangles there. It
 * takes one to three times the time again. Of a mesh that crosses itself or has solids inside
 * solids only the distance of the result from it is looked at. All that is left out with
 * no_sharpen; smaller voxels and parts of them with no_refine.
 *
 * out       filled on success, with normals; emptied on failure; free it with cw_mesh_free()
 * facts     may be NULL
 *
 * Returns  CW_ERR_EMPTY for an offset inward that leaves nothing; else as
 *          cw_level_set_from_mesh(), cw_extract(), cw_self_intersections()
 * Threads  the same to the bit for any number
 * Source   edges after [Kobbelt2001], [Attene2005]; parts of voxels after [Frisken2000] */
CW_NODISCARD CW_API cw_status cw_mesh_offset(const cw_mesh *mesh, const cw_offset_desc *desc,
                                             cw_mesh *out, cw_offset_facts *facts,
                                             cw_error *err);

/* A round hole from the largest cavity to the outside. It starts at the cavity's farthest point
 * in a direction (on a flat floor in its middle) with a ball, and goes straight on through all
 * that is in its way. */
typedef struct cw_drain {
    double diameter_mm;  /* at least 2 voxels */
    double direction[3]; /* in the world; of any length but 0 */
} cw_drain;

/* How to hollow a mesh. Zero fields mean the default named beside them. */
typedef struct cw_hollow_desc {
    double wall_mm;         /* required; at least 2 voxels */
    const cw_drain *drains; /* drain_count of them */
    size_t drain_count;     /* default: none, the cavities are shut in */
    double voxel_mm;        /* default: 1/4 of the wall or of the narrowest drain, and, with
                               max_bytes, as much coarser as it takes, up to 1/2 */
    bool no_measure;        /* default: the wall is measured */
    int threads;            /* default: all */
    size_t max_bytes;       /* default: no limit */
    cw_progress progress;   /* default: none */
} cw_hollow_desc;

/* What hollowing made. */
typedef struct cw_hollow_facts {
    double voxel_mm;
    size_t cavities, sealed;         /* made; of them those that no drain opens */
    double removed_mm3;              /* what the result is less than the mesh */
    double wall_min_mm, wall_max_mm; /* of points of the cavities' surfaces, the smallest and
                                        largest distance from the outer one; 0: not measured.
                                        Where drains begin, the wall before they were made */
} cw_hollow_facts;

/* Leaves of a solid a wall.
 *
 * Without drains the mesh stays as it is, vertex for vertex and triangle for triangle, with its
 * normals, if any; behind them are the surfaces of the cavities, at wall_mm from it, facing
 * inward. With drains all is made anew from the level set: edges and details lose what
 * cw_level_set_from_mesh() says. They are not put back, as cw_mesh_offset() does:
 * that goes by the mesh's own planes, which beside drains and around cavities are not those of
 * the result. Scalars, colours and labels are not kept.
 *
 * out      filled on success, emptied on failure; free it with cw_mesh_free()
 * facts    may be NULL
 *
 * Returns  CW_ERR_ARGUMENT  no wall, or one, or a drain, thinner than 2 voxels; a direction of
 *                           length 0; or as cw_level_set_from_mesh()
 *          CW_ERR_EMPTY     no point is so deep that the wall leaves a cavity
 *          else as cw_level_set_from_mesh(), cw_extract(), cw_distance_to_mesh() */
CW_NODISCARD CW_API cw_status cw_mesh_hollow(const cw_mesh *mesh, const cw_hollow_desc *desc,
                                             cw_mesh *out, cw_hollow_facts *facts,
                                             cw_error *err);

#ifdef __cplusplus
}
#endif

#endif
