/* Functions shared by the modes that draw a volume cell by cell or voxel by voxel. */
#ifndef VIEWER_SCENE_CELL_LATTICE_H
#define VIEWER_SCENE_CELL_LATTICE_H

#include "viewer/scene/transfer_table.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Finds the eye in index space; in orthographic views a point far away against the view. */
void cwi_lattice_eye(const cwi_frame *frame, double eye[3]);

/* Orders `count` things at first, first + step, ... from the farthest from a position to the
 * nearest. Orders along three axes, nested, make an order from back to front: a thing that
 * hides another is not farther along any axis. */
void cwi_lattice_order(size_t count, double first, double step, double position, size_t *order);

/* A table that shows, in constant time, if anything in a range of values is visible. */
typedef struct cwi_visible {
    size_t count;     /* rows of the table */
    uint32_t *before; /* count + 1: how many rows before one are not fully transparent */
} cwi_visible;

CW_NODISCARD cw_status cwi_visible_make(const cwi_table *table, cwi_visible *visible,
                                        cw_error *err);
void cwi_visible_free(cwi_visible *visible);

/* Returns true if anything from low to high is visible. These are coordinates in the table: 0
 * at its first value, 1 at its last. NaN: false. */
bool cwi_visible_any(const cwi_visible *visible, float low, float high);

/* Loads the coordinates in the table of the voxels of a box (x fastest); NaN: without a
 * value. */
void cwi_lattice_load(const cw_volume *volume, const cwi_table *table, const size_t first[3],
                      const size_t count[3], float *out);

/* Returns the cells that a voxel represents: of the eight eighths around it, those in cells of
 * the volume that have values at all corners. A volume of one layer has cells on both sides of
 * it. has_gaps: whether to look for samples without a value */
double cwi_lattice_mass(const cw_volume *v, const size_t at[3], bool has_gaps);

/* Computes the derivatives of the stored values per voxel, on a rectilinear grid per unit of
 * its coordinates: central inside, one-sided at the border; 0 where a sample has no value. */
void cwi_lattice_gradient(const cw_volume *v, const size_t at[3], double gradient[3]);

#ifdef __cplusplus
}
#endif

#endif
