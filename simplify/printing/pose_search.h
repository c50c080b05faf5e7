/* The search for the orientation of a print: what its parts share. */
#ifndef SIMPLIFY_PRINTING_POSE_SEARCH_H
#define SIMPLIFY_PRINTING_POSE_SEARCH_H

#include "simplify/printing/rest_pose.h"

#include <cubewright/print.h>

/* Triangles whose normals are in one cell of a cube around the origin. */
typedef struct cwi_normal_bin {
    double area, normal[3];
} cwi_normal_bin;

/* A direction that may point down. */
typedef struct cwi_pose {
    double down[3], overhang; /* estimated */
    cw_print_stand stand;     /* measured */
    bool fits;
} cwi_pose;

typedef struct cwi_pose_search {
    const cw_mesh *mesh;
    cw_print_desc limits;
    cwi_rest_body body; /* vertices that triangles name, and the centre of mass */
    double steep, area, diagonal;
    cwi_normal_bin *bins;
    size_t bin_count;
    cwi_pose *directions, *poses;
    size_t pose_count;
    bool no_memory;
} cwi_pose_search;

/* Measures all poses exactly. Sets no_memory where memory was out. */
void cwi_measure_poses(cwi_pose_search *search);

#endif
