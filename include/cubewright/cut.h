/* Cuts of meshes by a plane, closed flat: a base for a print. */
#ifndef CUBEWRIGHT_CUT_H
#define CUBEWRIGHT_CUT_H

#include <cubewright/mesh.h>

#ifdef __cplusplus
extern "C" {
#endif

/* A plane to cut by. Zero-initialise the struct and set what you need; a zero field means the
 * default named beside it. */
typedef struct cw_cut_desc {
    uint32_t version; /* 0: the first version of this struct */
    double point[3];  /* a world point of the plane, LPS millimetres; 0, 0, 0 is the origin */
    double normal[3]; /* of any length above 0; what lies on the side it points to is kept */
    bool
        point_is_percent; /* along each axis that the normal has, point is a percentage of the way
                              from the low to the high end of the mesh's box; default: world */
    bool leave_open;      /* default: the section is closed by flat triangles */
    cw_progress progress; /* default: none */
} cw_cut_desc;

/* Facts on a cut. */
typedef struct cw_cut_facts {
    size_t cut_triangles;     /* triangles that the plane parted */
    size_t dropped_triangles; /* triangles left out, on the other side or in the plane */
    size_t cap_triangles;     /* triangles that close the section */
    size_t loops_closed;      /* closed loops of the section that were filled */
    size_t loops_open;        /* chains of the section that end at open edges of the mesh, or
                                 loops, with leave_open */
    double area_mm2; /* of the section: the area inside its closed loops, holes left out */
    double moved_mm; /* the farthest that a vertex near the plane moved into it */
} cw_cut_facts;

/* Cuts a mesh by a plane, keeps one side, and closes it flat. A closed, oriented manifold stays one.
 *
 * Vertices within 4e-7 of the largest coordinate move into the plane, and count as on the other
 * side. So do those within 1.5e-5 of it and 1/512 of their longest edge, and neighbours of the section as
 * near as that merge, so that the cut makes no slivers; unless the volume would change by more than 1e-6
 * of it, or the surface would cross itself: then as near as a sixteenth of that, or none. Triangles in the
 * plane go, and the section is filled again. Edges that cross the plane get one vertex, which both
 * triangles share. All vertices of the section lie in the plane as exactly as single precision allows:
 * exactly, if the plane is normal to an axis. Where surfaces touch at a
 * vertex in the plane, it becomes one vertex for each. Where rounding would make the surface cross
 * itself, vertices of the section move by up to 1.2e-6 of the largest coordinate, and 3e-7 from the
 * plane. Crossings of the mesh itself stay.
 *
 * The loops of the section are filled by triangles, each of its edges once. A loop that runs the
 * other way is a hole of the loop around it, or filled by itself if there is none. Chains of open
 * meshes stay open.
 *
 * Vertices that stay keep their attributes. New ones take them from the ends of their edge,
 * interpolated, and the label of the nearer end. Normals at the section are halfway between those
 * of the surface and of the section. Parts of triangles keep what is on triangles, and their new corners
 * interpolate what is on corners. Both are 0 in the triangles that fill the section.
 *
 * mesh     borrowed
 * desc     borrowed
 * out      filled on success, emptied on failure; free it with cw_mesh_free(). Equal to the mesh if
 *          nothing is below the plane
 * facts    may be NULL
 *
 * Returns  CW_ERR_ARGUMENT  normal is 0; normal or point is not finite; or as cw_mesh_check()
 *          CW_ERR_EMPTY     nothing of the mesh is above the plane
 *          CW_ERR_LIMIT     beyond 2^32 / 3 triangles or vertices
 *          CW_ERR_NO_MEMORY; CW_ERR_CANCELLED
 * Cost     about 60 ns for each triangle, and 6 us for each edge of the section; 500 bytes for each
 *          of these edges, and 2 for each vertex, besides the result
 * Threads  reentrant; works on the calling thread
 * Source   ears [Meisters1975]; holes joined to the loops around them [Eberly2008] */
CW_NODISCARD CW_API cw_status cw_mesh_cut(const cw_mesh *mesh, const cw_cut_desc *desc,
                                          cw_mesh *out, cw_cut_facts *facts, cw_error *err);

#ifdef __cplusplus
}
#endif

#endif
