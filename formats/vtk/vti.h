/* VTK's XML image data and rectilinear grids: the elements, shared by the file that finds them
 * and the one that parses their attributes. */
#ifndef FORMATS_VTK_VTI_H
#define FORMATS_VTK_VTI_H

#include "formats/volume/named_arrays.h"
#include "formats/vtk/vtk_xml.h"

/* The preference of an array as the volume: first the requested array, then the one that
 * PointData or CellData names as its scalars, then others of one value, then arrays of several
 * values. Integers of 64 bits, which are mostly the numbers of points or cells, come last. */
typedef enum cwi_vti_rank {
    CWI_VTI_NONE,
    CWI_VTI_WIDE,
    CWI_VTI_SEVERAL,
    CWI_VTI_ONE,
    CWI_VTI_SCALARS,
    CWI_VTI_REQUESTED
} cwi_vti_rank;

/* A DataArray of PointData or CellData. */
typedef struct cwi_vti_array {
    cwi_vtk_array data;
    cwi_vti_rank rank;
} cwi_vti_array;

/* Arrays for the same places. */
typedef struct cwi_vti_data {
    char scalars[CWI_WORD_BYTES]; /* the name that the element states */
    bool of_cells;
    cwi_vti_array best;
} cwi_vti_data;

/* The choice among the arrays. */
typedef struct cwi_vti_choice {
    const char *expected; /* the name of the requested array; NULL: none */
    cwi_array_list *list; /* list that receives the arrays; NULL: not needed */
    char others[400];     /* names and types of arrays that are not read, for messages */
} cwi_vti_choice;

/* The content of a piece, as far as its elements were read. */
typedef struct cwi_vti {
    cwi_vtk_xml file;
    int64_t extent[6]; /* of the piece: first and last index along x, y, z */
    double origin[3], spacing[3], direction[9];
    bool rectilinear;
    cwi_vtk_array coordinates[3];
    size_t coordinate_arrays;
    cwi_vti_data points, cells;
} cwi_vti;

/* A file of one piece or several, or one that lists the files of pieces. Zeroed but for the choice, it
 * is closed. */
typedef struct cwi_vti_file {
    cwi_vti_choice choice;
    cwi_vti common;    /* what all pieces have in common */
    int64_t extent[6]; /* of the whole; has_extent: it was stated */
    bool has_extent;
    cwi_vti *pieces; /* count of them */
    size_t count, capacity;
    bool is_list; /* it lists files: */
    cwi_names sources;
} cwi_vti_file;

/* Returns true for a list of files, and where the first piece is a part of the whole. Reads no further. */
bool cwi_vti_may_have_pieces(const cwi_input *in);

/* Reads the elements of a file. Close it, also after failure, with cwi_vti_close(). */
CW_NODISCARD cw_status cwi_vti_open(const cwi_input *in, cwi_vti_file *file, cw_error *err);
void cwi_vti_close(cwi_vti_file *file);

/* Describes the voxels of a piece. */
CW_NODISCARD cw_status cwi_vti_describe(const cwi_vti *v, const cwi_vti_choice *choice,
                                        const cwi_input *in, cwi_source *src, cw_error *err);

/* Reads the coordinates of a piece of a rectilinear grid, as they are in the file; the caller frees them
 * also on failure. */
CW_NODISCARD cw_status cwi_vti_coordinates_load(const cwi_vti *v, const cwi_input *in,
                                                cw_volume numbers[3], cw_error *err);

/* Returns the array that is the volume. of_cells: set to whether it has values of cells */
const cwi_vti_array *cwi_vti_chosen(const cwi_vti *v, bool *of_cells);

/* Returns true if the best array of points goes before that of cells, which may be missing. */
static inline bool cwi_vti_is_of_points(const cwi_vti_data *points, const cwi_vti_data *cells)
{
    return points->best.rank > CWI_VTI_WIDE ||
           (points->best.rank == CWI_VTI_WIDE && cells->best.rank <= CWI_VTI_WIDE);
}

/* Parses the attributes of one element each. */
CW_NODISCARD cw_status cwi_vti_image(cwi_vti *v, cwi_attributes a, cw_error *err);
CW_NODISCARD cw_status cwi_vti_extent(cwi_attributes a, const char *name, int64_t extent[6],
                                      cw_error *err);
CW_NODISCARD cw_status cwi_vti_piece(cwi_vti_file *file, cwi_attributes a, cw_error *err);
void cwi_vti_data_start(cwi_vti_data *data, bool of_cells, cwi_attributes a);

/* Handles one array; *kept when it is the best so far, and is now data->best. */
CW_NODISCARD cw_status cwi_vti_data_array(cwi_vti_choice *choice, cwi_vti_data *data,
                                          cwi_attributes a, bool *kept, cw_error *err);

/* Reports that none of the arrays can be used. */
CW_NODISCARD cw_status cwi_vti_fail_choice(const cwi_vti_choice *choice, cw_error *err);

/* Refuses several time steps in one file. */
CW_NODISCARD cw_status cwi_vti_check_times(cwi_attributes a, cw_error *err);

/* Parses one array of coordinates, v->coordinates[*n]. */
CW_NODISCARD cw_status cwi_vti_coordinates(cwi_vti *v, cwi_attributes a, size_t *n,
                                           cw_error *err);

#endif
