/* The common parts of grids in VTK's legacy and XML files: rectilinear coordinates, and values
 * of cells. */
#ifndef FORMATS_VTK_VTK_GRID_H
#define FORMATS_VTK_VTK_GRID_H

#include "formats/volume/voxel_source.h"

/* Describes count coordinates along an axis, without their place and encoding. */
CW_NODISCARD cw_status cwi_vtk_grid_row(cwi_source *row, const char *size_field, cw_type type,
                                        size_t count, cw_error *err);

/* Reads coordinates along x, y and z into three volumes, which the caller frees also on failure. */
CW_NODISCARD cw_status cwi_vtk_grid_load(const cwi_source rows[3], const cwi_input *in,
                                         cw_volume numbers[3], cw_error *err);

/* Gives coordinates along x, y and z, which must all rise or all fall, to a shape without an affine.
 * Falling ones become rising, along an axis that points the other way. of_cells: makes them those of the
 * cells' middles. The shape's owner frees them, also on failure. */
CW_NODISCARD cw_status cwi_vtk_grid_give(const cw_volume numbers[3], bool of_cells,
                                         cw_volume *shape, cw_error *err);

/* Does both. */
CW_NODISCARD cw_status cwi_vtk_grid_place(const cwi_source rows[3], const cwi_input *in,
                                          bool of_cells, cw_volume *shape, cw_error *err);

/* Converts numbers of points to those of cells, for an array of values of cells, and notes that
 * these are taken as samples. */
CW_NODISCARD cw_status cwi_vtk_grid_to_cells(cwi_source *src, const char *array, size_t dim[3],
                                             cw_error *err);

#endif
