/* VTK's XML image data, between the file that finds the elements and the one that reads them.
 */
#ifndef FORMATS_VTI_H
#define FORMATS_VTI_H

#include "formats/vtk_xml.h"

/* How well an array will do as the volume: the one that PointData names as its scalars goes
 * before others of one value, and those before arrays of several. */
typedef enum cwi_vti_rank {
    CWI_VTI_NONE,
    CWI_VTI_SEVERAL,
    CWI_VTI_ONE,
    CWI_VTI_SCALARS
} cwi_vti_rank;

/* A DataArray of PointData. */
typedef struct cwi_vti_array {
    cwi_vtk_array data;
    cwi_vti_rank rank;
} cwi_vti_array;

/* What the elements say, as far as they have been seen. */
typedef struct cwi_vti {
    cwi_vtk_xml file;
    int64_t extent[6]; /* of the piece: first and last index along x, y, z */
    double origin[3], spacing[3], direction[9];
    size_t pieces, cell_arrays;
    char scalars[CWI_WORD_BYTES]; /* the name in PointData */
    cwi_vti_array best;
    char others[160]; /* names and types of arrays that are not read, for messages */
} cwi_vti;

/* The elements that mean something, each filling in what its attributes say. */
cw_status cwi_vti_image(cwi_vti *v, cwi_attributes a, cw_error *err);
cw_status cwi_vti_piece(cwi_vti *v, cwi_attributes a, cw_error *err);
cw_status cwi_vti_point_data(cwi_vti *v, cwi_attributes a, cw_error *err);

/* One array; *kept when it is the best so far, and is now v->best. */
cw_status cwi_vti_data_array(cwi_vti *v, cwi_attributes a, bool *kept, cw_error *err);

#endif
