/* VTK's XML image data, between the file that finds the elements and the one that reads them.
 */
#ifndef FORMATS_VTI_H
#define FORMATS_VTI_H

#include "formats/header.h"
#include "formats/source.h"

/* How well an array will do as the volume: the one that PointData names as its scalars goes
 * before others of one value, and those before arrays of several. */
typedef enum cwi_vti_rank {
    CWI_VTI_NONE,
    CWI_VTI_SEVERAL,
    CWI_VTI_ONE,
    CWI_VTI_SCALARS
} cwi_vti_rank;

typedef enum cwi_vti_form { CWI_VTI_ASCII, CWI_VTI_BINARY, CWI_VTI_APPENDED } cwi_vti_form;

/* A DataArray of PointData. */
typedef struct cwi_vti_array {
    char name[CWI_WORD_BYTES];
    cw_type type;
    size_t components;
    cwi_vti_form form;
    uint64_t offset;     /* in the appended data */
    uint64_t start, end; /* of its text in the file */
    cwi_vti_rank rank;
} cwi_vti_array;

typedef enum cwi_vti_compressor { CWI_VTI_PLAIN, CWI_VTI_ZLIB, CWI_VTI_LZ4 } cwi_vti_compressor;

/* What the elements say, as far as they have been seen. */
typedef struct cwi_vti {
    bool has_order, big_endian;
    size_t word_bytes; /* of the sizes in front of binary data */
    cwi_vti_compressor compressor;
    int64_t extent[6]; /* of the piece: first and last index along x, y, z */
    double origin[3], spacing[3], direction[9];
    size_t pieces, cell_arrays;
    char scalars[CWI_WORD_BYTES]; /* the name in PointData */
    cwi_vti_array best;
    char others[160]; /* names and types of arrays that are not read, for messages */
    bool has_appended;
    bool base64;       /* the appended data are text */
    uint64_t appended; /* where they start: behind the underscore */
} cwi_vti;

/* Attributes of an element: names and values by turns, then NULL. */
typedef const char *const *cwi_attributes;

/* The elements that mean something, each filling in what its attributes say. */
cw_status cwi_vti_file(cwi_vti *v, cwi_attributes a, cw_error *err);
cw_status cwi_vti_image(cwi_vti *v, cwi_attributes a, cw_error *err);
cw_status cwi_vti_piece(cwi_vti *v, cwi_attributes a, cw_error *err);
cw_status cwi_vti_point_data(cwi_vti *v, cwi_attributes a, cw_error *err);
cw_status cwi_vti_appended(cwi_vti *v, cwi_attributes a, cw_error *err);

/* One array; *kept when it is the best so far, and is now v->best. */
cw_status cwi_vti_data_array(cwi_vti *v, cwi_attributes a, bool *kept, cw_error *err);

#endif
