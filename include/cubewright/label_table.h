/* Names and colours of the labels of a label map. */
#ifndef CUBEWRIGHT_LABEL_TABLE_H
#define CUBEWRIGHT_LABEL_TABLE_H

#include <cubewright/core.h>

#ifdef __cplusplus
extern "C" {
#endif

/* A word of a coding scheme, such as SNOMED CT. The strings are UTF-8, NULL where unknown. */
typedef struct cw_code {
    char *scheme;  /* "SCT" */
    char *value;   /* "10200004" */
    char *meaning; /* "Liver" */
} cw_code;

/* A label, with what its file says about it. */
typedef struct cw_label {
    uint32_t value;   /* of its voxels */
    uint32_t layer;   /* component of the volume that its voxels are in. Segments that overlap
                         are in several; default: 0 */
    char *name;       /* UTF-8, printable; NULL: none */
    uint8_t color[4]; /* sRGB and opacity */
    bool has_color;   /* false: color is not stated */
    bool hidden;      /* the file leaves it out of pictures in 3D */
    cw_code category, type; /* kind of structure, and the structure itself */
} cw_label;

/* Labels in rising order of layers, then of values; each value once in a layer. A zeroed table
 * is valid and empty. */
typedef struct cw_label_table {
    size_t count;     /* number of labels */
    cw_label *labels; /* owned */
} cw_label_table;

/* Frees the labels and zeroes the table. Harmless on a zeroed or already freed table. */
CW_API void cw_label_table_free(cw_label_table *table);

/* Finds a label by its layer and value. Returns NULL if the table does not have it.
 * layer  of the label */
CW_API const cw_label *cw_label_find(const cw_label_table *table, uint32_t layer,
                                     uint32_t value);

/* Finds a label by its name; lower and upper case are alike. Returns NULL if no label, or more
 * than one, has that name. */
CW_API const cw_label *cw_label_find_name(const cw_label_table *table, const char *name);

/* Adds a copy of a label, or replaces the one of its layer and value. Bytes of names that are not
 * printable UTF-8 become '_'.
 * table    unchanged on failure
 * label    copied
 * Returns  CW_ERR_NO_MEMORY
 * Cost     constant in rising order, else in proportion to the table */
CW_NODISCARD CW_API cw_status cw_label_table_add(cw_label_table *table, const cw_label *label,
                                                 cw_error *err);

/* Returns a colour for a label without one, opaque. Values that follow each other differ
 * clearly.
 * color  set to sRGB and opacity */
CW_API void cw_label_color(uint32_t value, uint8_t color[4]);

#ifdef __cplusplus
}
#endif

#endif
