/* What grids of VTK's legacy and XML files have in common: coordinates of rectilinear ones, and
 * values of cells. */
#ifndef FORMATS_VTK_VTK_GRID_H
#define FORMATS_VTK_VTK_GRID_H

#include "formats/volume/voxel_source.h"

/* Describes count coordinates along an axis, but for where and how they are written. */
CW_NODISCARD cw_status cwi_vtk_grid_row(cwi_source *row, const char *size_field, cw_type type,
                                        size_t count, cw_error *err);

/* Reads coordinates along x, y and z, which all rise or all fall, and gives them to a shape
 * without an affine: rising, along an axis that points the other way where they fell; of_cells:
 * those of the cells' middles. On failure, too, the shape's owner frees them. */
CW_NODISCARD cw_status cwi_vtk_grid_place(const cwi_source rows[3], const cwi_input *in,
                                          bool of_cells, cw_volume *shape, cw_error *err);

/* Turns numbers of points to those of cells, for an array of values that they have, and notes
 * that these are taken as samples. */
CW_NODISCARD cw_status cwi_vtk_grid_to_cells(cwi_source *src, const char *array, size_t dim[3],
                                             cw_error *err);

#endif
