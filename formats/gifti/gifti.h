/* The elements of a GIfTI file: its arrays of data, with the places of their numbers, and its labels.
 * [GIFTI: "Geometry format under the NIfTI", version 1.0, www.nitrc.org/projects/gifti] */
#ifndef FORMATS_GIFTI_GIFTI_H
#define FORMATS_GIFTI_GIFTI_H

#include "formats/text/text_header.h"
#include "formats/volume/voxel_source.h"

/* The arrays that are read. */
typedef enum cwi_gifti_role {
    CWI_GIFTI_POINTS,
    CWI_GIFTI_TRIANGLES,
    CWI_GIFTI_SCALARS, /* NIFTI_INTENT_SHAPE: one number a vertex */
    CWI_GIFTI_LABELS,  /* NIFTI_INTENT_LABEL: keys of the LabelTable */
    CWI_GIFTI_COLORS,  /* NIFTI_INTENT_RGB_VECTOR, NIFTI_INTENT_RGBA_VECTOR */
    CWI_GIFTI_ROLE_COUNT
} cwi_gifti_role;

typedef struct cwi_gifti_array {
    char intent[CWI_WORD_BYTES];
    cw_type type;
    cwi_stored stored;
    size_t count, components;
    bool columns; /* the numbers of a column follow each other, not those of a row */
    bool ascii, base64, deflated, big_endian;
    char file[256];      /* name of the file that holds the numbers; "": this one */
    uint64_t offset;     /* in that file */
    uint64_t start, end; /* of the text in this file */
} cwi_gifti_array;

typedef struct cwi_gifti {
    cwi_gifti_array arrays[CWI_GIFTI_ROLE_COUNT];
    bool has[CWI_GIFTI_ROLE_COUNT];
    size_t count, more; /* DataArrays of the file; points and triangles behind the first */
    size_t others;      /* arrays that have no role */
    char first[CWI_WORD_BYTES]; /* intent of the first one; of the first without a role: */
    char other[CWI_WORD_BYTES];
    bool has_matrix; /* from coordinates that are not those of the scanner to those: */
    double matrix[3][4];
    bool has_centre;       /* VolGeomC_R, A, S are not all 0 */
    cw_label_table labels; /* without names; those below 0 left out */
} cwi_gifti;

/* Reads the elements of a file. Free it, also after failure.
 * Returns  CW_ERR_FORMAT, CW_ERR_UNSAFE a document type that states more than its name */
CW_NODISCARD cw_status cwi_gifti_parse(cwi_gifti *g, const cwi_input *in, cw_error *err);
void cwi_gifti_free(cwi_gifti *g);

#endif
