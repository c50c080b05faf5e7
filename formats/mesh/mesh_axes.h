/* Units and frames of mesh files: conversion from LPS millimetres and back. */
#ifndef FORMATS_MESH_MESH_AXES_H
#define FORMATS_MESH_MESH_AXES_H

#include <cubewright/formats.h>

#ifdef __cplusplus
extern "C" {
#endif

/* A turn: coordinate a of the file is sign[a] * times / over of coordinate from[a] of the
 * world. times or over is 1, so that short decimals stay short. */
typedef struct cwi_turn {
    int from[3];
    double sign[3], times, over;
} cwi_turn;

cwi_turn cwi_turn_to(const cw_axes *axes);
/* Converts a coordinate. Adding 0.0 turns -0 into 0. */
static inline double cwi_turn_coordinate(const cwi_turn *turn, int axis, double world)
{
    return turn->sign[axis] * world * turn->times / turn->over + 0.0;
}

void cwi_turn_point(const cwi_turn *turn, const double world[3], double file[3]);

enum { CWI_AXES_BYTES = 32 };

/* Prints the axes as a line of our writers: "LPS, mm", "RAS, um, Y up". */
void cwi_print_axes(const cw_axes *axes, char text[CWI_AXES_BYTES]);

/* Reads this line back, or the name of a unit or frame alone, and moves *text behind it.
 * Returns false, with *metadata unchanged, for any other text. */
bool cwi_parse_axes(const char **text, cw_mesh_file *metadata);
bool cwi_parse_unit(const char **text, cw_mesh_file *metadata);
bool cwi_parse_frame(const char **text, cw_mesh_file *metadata);

/* Turns a mesh from the file's coordinates to LPS millimetres.
 * Returns CW_ERR_FORMAT for places that single precision then cannot hold. */
CW_NODISCARD cw_status cwi_turn_back(cw_mesh *mesh, const cw_axes *axes, cw_error *err);

#ifdef __cplusplus
}
#endif

#endif
