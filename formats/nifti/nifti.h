/* The places of the fields in both NIfTI headers, which the reader and the writer share; and the
 * search for labels behind a header. */
#ifndef FORMATS_NIFTI_NIFTI_H
#define FORMATS_NIFTI_NIFTI_H

#include "formats/volume/voxel_source.h"

#include <cubewright/label_table.h>
#include <cubewright/volume.h>

enum { CWI_NIFTI_MAX_HEADER = 540 };

/* The fields that are used; the rest of a header is zero, or ignored. */
typedef enum cwi_nifti_field {
    CWI_NIFTI_SIZEOF_HDR,
    CWI_NIFTI_DATATYPE,
    CWI_NIFTI_BITPIX,
    CWI_NIFTI_DIM,    /* 8 numbers: the count of dimensions, then sizes */
    CWI_NIFTI_PIXDIM, /* 8 numbers: qfac, then spacings */
    CWI_NIFTI_VOX_OFFSET,
    CWI_NIFTI_SCL_SLOPE,
    CWI_NIFTI_SCL_INTER,
    CWI_NIFTI_QFORM_CODE,
    CWI_NIFTI_SFORM_CODE,
    CWI_NIFTI_QUATERN, /* b, c, d */
    CWI_NIFTI_QOFFSET, /* x, y, z */
    CWI_NIFTI_SROW,    /* x, y, z: 4 numbers each */
    CWI_NIFTI_XYZT_UNITS,
    CWI_NIFTI_INTENT_CODE,
    CWI_NIFTI_FIELD_COUNT
} cwi_nifti_field;

/* A version of the header. */
typedef struct cwi_nifti_layout {
    size_t bytes;                /* of the header, as in sizeof_hdr */
    size_t voxels;               /* minimum offset of the voxels */
    size_t magic, magic_bytes;   /* offset and length */
    const char *one_file, *pair; /* the two magics */
    size_t descrip;              /* offset of 80 bytes of text */
    struct {
        unsigned short offset;
        char kind; /* b, h, i, l: integers of 1, 2, 4, 8 bytes; f, d: floats of 4, 8 */
    } field[CWI_NIFTI_FIELD_COUNT];
} cwi_nifti_layout;

/* NIfTI-1, NIfTI-2. */
extern const cwi_nifti_layout cwi_nifti_layouts[2];

/* Returns a number of a field, in either byte order. All numbers fit a double, for sizes that
 * can be read at all. */
double cwi_nifti_get(const cwi_nifti_layout *layout, const unsigned char *header, bool swapped,
                     cwi_nifti_field field, int index);
void cwi_nifti_put(const cwi_nifti_layout *layout, unsigned char *header, cwi_nifti_field field,
                   int index, double value);

/* Returns NIfTI's number of a voxel type. */
int cwi_nifti_datatype(cw_type type);

/* The bytes of a file, inflated if it is a gzip file, in which extensions may be. */
typedef struct cwi_nifti_span {
    uint64_t start, end; /* behind the header, and where the voxels start or the file ends */
    bool gzipped, swapped;
} cwi_nifti_span;

/* Fills a zeroed table from the first extension that is XML with labels. A table that cannot be
 * read is left out, with a note. Returns CW_ERR_IO, CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_nifti_labels(const cwi_input *in, const cwi_nifti_span *span,
                                        cw_label_table *table, char note[200], cw_error *err);

/* Parses a header. image: name of the file of voxels, if that was the one that was named; else NULL */
CW_NODISCARD cw_status cwi_nifti_parse_header(const cwi_input *in, const char *image,
                                              cwi_source *src, cw_error *err);

#endif
