/* Printability: what a 3D printer makes hard of a mesh. */
#ifndef CUBEWRIGHT_PRINT_H
#define CUBEWRIGHT_PRINT_H

#include <cubewright/mesh.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Limits of a printer. Zero-initialise the struct and set what you need; a zero field means the
 * default named beside it. */
typedef struct cw_print_desc {
    uint32_t version; /* 0: the first version of this struct */
    double
        min_wall_mm; /* thinner walls count as thin; default: 0.8, two lines of most nozzles */
    double min_gap_mm; /* narrower gaps count as narrow; default: 0.4 */
    double
        overhang_deg; /* surfaces that lean more from the vertical need support; default: 45 */
    double layer_mm;  /* height of a layer; default: 0.2 */
    double
        plate_mm[3]; /* width, depth and height that can be printed; default: not looked at */
    float *wall;     /* vertex_count: set to the thinnest wall around each, mm; INFINITY where
                               there is none; default: not kept */
    float *gap;      /* the same of gaps, up to four times min_gap_mm */
    int threads;     /* default: all */
    cw_progress progress; /* default: none */
} cw_print_desc;

/* Measurements of a print. It stands on the plate as it is: z is up, the lowest point is on it.
 * Places are world points, mm. */
typedef struct cw_print_facts {
    cw_print_desc limits; /* with their defaults; wall and gap are NULL */
    double area_mm2;      /* of the surface */
    double wall_mm;       /* the thinnest wall; INFINITY: none */
    double wall_at[3];    /* a point of the surface at it */
    double thin_mm2;      /* area of the surface at walls below min_wall_mm */
    double gap_mm;        /* the narrowest gap; INFINITY: none up to four times min_gap_mm */
    double gap_at[3];     /* a point of the surface at it */
    double narrow_mm2;    /* area of the surface at gaps below min_gap_mm */
    double overhang_mm2; /* area that leans more than overhang_deg, without that on the plate */
    size_t islands; /* places where a part begins in the air, a layer or more before it meets
                                the rest */
    double island_at[3]; /* the one that stands alone over the greatest height */
    size_t trapped;      /* closed cavities, and solids inside them */
    double trapped_mm3;  /* their volume */
    double volume_mm3;   /* enclosed, cavities left out */
    double center[3];    /* of mass */
    double foot_mm2;     /* area on the plate: lower than a layer, and facing down */
    double margin_mm;    /* how far the centre of mass is inside of the outline of the foot;
                                negative: outside */
    double tip_deg;      /* tilt at which it tips over; 0: it does so by itself */
    bool fits;           /* into plate_mm, perhaps turned by 90 degrees; true without one */
} cw_print_facts;

/* Measures the printability of a closed mesh. Vertices at equal positions count as one.
 *
 * A wall is measured by a ray from a point of the surface into the solid, against the normal: the
 * distance to where it leaves, if the surface there is within 30 degrees of facing the ray. Sharp
 * edges are no walls. Where a wall is below four times the limit, six more rays around count, 5
 * degrees off, and the shortest is taken. Gaps are the same outside. Rays start at the middle of
 * triangles, and of parts of large ones: 200,000 points at least.
 *
 * mesh     borrowed; of open ones walls and volumes are not meaningful
 * desc     borrowed; NULL means all defaults
 * facts    filled
 * Returns  CW_ERR_ARGUMENT  a limit is negative or not finite; overhang_deg is 90 or more; a side
 *                           of plate_mm is 0 beside others; or as cw_mesh_check()
 *          CW_ERR_LIMIT     beyond 2^32 / 3 triangles or vertices
 *          CW_ERR_NO_MEMORY; CW_ERR_CANCELLED
 * Cost     about 10 us for each point; 130 bytes for each triangle
 * Threads  reentrant; the same to the bit for any number of threads
 * Source   rays in cones as [Shapira2008]; islands by the persistence of minima of the height
 *          [Edelsbrunner2002] */
CW_NODISCARD CW_API cw_status cw_print_measure(const cw_mesh *mesh, const cw_print_desc *desc,
                                               cw_print_facts *facts, cw_error *err);

/* A way to stand on the plate. */
typedef struct cw_print_stand {
    double up[3];        /* direction of the mesh that points up; of length 1 */
    double overhang_mm2; /* as in cw_print_facts */
    double height_mm;    /* of the print */
    double hull_mm2; /* area of the convex hull of what is on the plate: lower than a layer */
    double tip_deg;  /* tilt at which it tips over; 0: it does so by itself */
} cw_print_stand;

/* Facts on an orientation. */
typedef struct cw_orient_facts {
    cw_print_stand before, after; /* as the mesh stands; as it stands best */
    double matrix[12]; /* for cw_mesh_transform(): turns the mesh about the middle of its box */
    size_t directions; /* that were compared by the histogram of normals */
    size_t poses;      /* ways to rest on the plate that were measured exactly */
    size_t unstable;   /* of them, those that tip over too easily */
    bool is_stable;    /* `after` tips over at CW_MIN_TIP_DEG or more */
    bool is_kept;      /* none is better than the present one: the matrix turns nothing */
} cw_orient_facts;

/* The tilt, in degrees, that a print must stand without tipping over. So it stands on an area: not on a tip. */
#define CW_MIN_TIP_DEG 5.0

/* Finds how a mesh is printed with the least support: the smallest area of overhangs, then the smallest height,
 * then the largest hull on the plate. Areas and heights count as equal within a thousandth of the surface and of
 * the box's diagonal. What lies on the plate is no overhang.
 *
 * 10,000 directions are compared by a histogram of normals. From the best of them, and from the largest flat
 * parts, the mesh is let roll until it rests: its centre of mass is above the hull of what touches the plate.
 * Such poses are measured exactly. Those that tip over below CW_MIN_TIP_DEG are left out; if none is left,
 * the one that stands best is taken. The present pose stays where no other is better.
 *
 * mesh     borrowed; closed. Of open ones the centre of mass is that of the box
 * desc     borrowed: overhang_deg, layer_mm and plate_mm, as of cw_print_measure(); poses that the plate
 *          does not hold are left out, if others fit. NULL means all defaults
 * facts    filled
 * Returns  CW_ERR_ARGUMENT as cw_print_measure(); CW_ERR_EMPTY: no triangles; CW_ERR_LIMIT;
 *          CW_ERR_NO_MEMORY
 * Cost     in proportion to the triangles, about 1 us each and thread, and 20 ms
 * Threads  reentrant; the same to the bit for any number of threads */
CW_NODISCARD CW_API cw_status cw_orient_print(const cw_mesh *mesh, const cw_print_desc *desc,
                                              cw_orient_facts *facts, cw_error *err);

#ifdef __cplusplus
}
#endif

#endif
