/* The fields and axes of NRRD, shared by the parser of the header and the code that places the
 * axes. */
#ifndef FORMATS_NRRD_NRRD_H
#define FORMATS_NRRD_NRRD_H

#include "formats/text/text_header.h"
#include "formats/volume/voxel_source.h"

enum { CWI_NRRD_MAX_AXES = 16, CWI_NRRD_MAX_VALUES = 16 /* of a voxel */ };

/* The fields that are used, and one for all others that NRRD defines. */
typedef enum cwi_nrrd_field {
    CWI_NRRD_TYPE,
    CWI_NRRD_DIMENSION,
    CWI_NRRD_SIZES,
    CWI_NRRD_ENCODING,
    CWI_NRRD_ENDIAN,
    CWI_NRRD_SPACE,
    CWI_NRRD_SPACE_DIMENSION,
    CWI_NRRD_SPACE_DIRECTIONS,
    CWI_NRRD_SPACE_ORIGIN,
    CWI_NRRD_SPACE_UNITS,
    CWI_NRRD_SPACINGS,
    CWI_NRRD_AXIS_MINS,
    CWI_NRRD_AXIS_MAXS,
    CWI_NRRD_CENTERS,
    CWI_NRRD_KINDS,
    CWI_NRRD_UNITS,
    CWI_NRRD_DATA_FILE,
    CWI_NRRD_LINE_SKIP,
    CWI_NRRD_BYTE_SKIP,
    CWI_NRRD_IGNORED,
    CWI_NRRD_FIELD_COUNT
} cwi_nrrd_field;

/* The kind of an axis: of space, of time, or of values that belong to one voxel. */
typedef enum cwi_nrrd_kind {
    CWI_NRRD_KIND_UNKNOWN,
    CWI_NRRD_KIND_SPACE,
    CWI_NRRD_KIND_TIME,
    CWI_NRRD_KIND_LIST,
    CWI_NRRD_KIND_VALUES
} cwi_nrrd_kind;

/* An axis as the header describes it. */
typedef struct cwi_nrrd_axis {
    size_t size;
    cwi_nrrd_kind kind;
    bool has_vector;
    double vector[4];   /* in the space's own coordinates */
    bool is_cell;       /* samples are in the middle of cells */
    double mm, seconds; /* per unit; 0: not stated */
} cwi_nrrd_axis;

/* A key of a segment (nrrd_segments.c). */
typedef struct cwi_nrrd_segment_key cwi_nrrd_segment_key;

/* The parts of a header read so far. */
typedef struct cwi_nrrd {
    cwi_lines lines;
    const char *value[CWI_NRRD_FIELD_COUNT]; /* as written; NULL: the field is missing */
    bool has_segments;                       /* keys describe segments: values are labels */
    bool wants_segments;                     /* the keys are kept */
    cwi_nrrd_segment_key *segment_keys;
    size_t segment_key_count;
    size_t dimension;
    cwi_nrrd_axis axis[CWI_NRRD_MAX_AXES];
    double spacing[CWI_NRRD_MAX_AXES], min[CWI_NRRD_MAX_AXES],
        max[CWI_NRRD_MAX_AXES]; /* NaN: not stated */
    int space;                  /* the row in a table of named worlds, or -1 */
    size_t space_dimension;     /* 0: no world is described */
    double origin[4];
    double world_mm[4];   /* per unit of each world coordinate; 0: not stated */
    double world_seconds; /* per unit of the fourth */
} cwi_nrrd;

/* Reads the axes and their world from the header, and sets the source's sizes, strides and
 * frame. Needs the type and the plain sizes. */
CW_NODISCARD cw_status cwi_nrrd_describe(cwi_nrrd *n, cwi_source *src, cw_error *err);

/* Keeps a line "key:=value" that describes a segment; others are ignored. The value stays in
 * the line. Returns CW_ERR_FORMAT, CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_nrrd_keep_segment(cwi_nrrd *n, char *line, char *value,
                                             cw_error *err);

/* Fills a zeroed table from the kept keys. Needs the number of components. Returns
 * CW_ERR_FORMAT, which names line and key; CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_nrrd_read_segments(cwi_nrrd *n, cwi_source *src,
                                              cw_label_table *table, cw_error *err);

#endif
