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
    uint64_t id; /* its number in the file where that is no value of 32 bits, without its sign;
                         0: value is its number. See cw_label_ids */
    bool is_negative; /* id is below 0 */
} cw_label;

/* Labels in rising order of layers, then of values, then of ids; each number once in a layer. A zeroed table
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

/* Bytes of a label's number as text, with its end. */
enum { CW_LABEL_NUMBER = 24 };

/* Prints the number that a label has in its file.
 * label    borrowed
 * text     set to it
 * Returns  text */
CW_API const char *cw_label_number(const cw_label *label, char text[CW_LABEL_NUMBER]);

/* Reads the number of a label: decimal digits, and a sign in front.
 * text     all of it is the number
 * label    its value, id and is_negative are set
 * Returns  false, and leaves the label: the text is no whole number from -2^63 to 2^64 - 1 */
CW_API bool cw_label_parse(const char *text, cw_label *label);

/* The numbers of labels that are below 0, or beyond 32 bits: connectomes count them in 64. Voxels of
 * such a map are replaced by the places of their labels in this list. Place 0 is the background's, whose
 * number is 0. A zeroed list is valid: then voxels are the numbers of their labels. */
typedef struct cw_label_ids {
    size_t count;       /* of labels, with the background; 0: none was replaced */
    const int64_t *ids; /* owned; behind the first they rise */
    bool is_unsigned;   /* they are of uint64_t */
    size_t rounded;     /* number of voxels that were rounded to the nearest whole number */
    double largest_rounding; /* of those */
} cw_label_ids;

/* Frees the numbers and zeroes the list. Harmless on a zeroed or already freed list. */
CW_API void cw_label_ids_free(cw_label_ids *ids);

/* Finds the value that voxels of a label have: its place in the list, or without one its value.
 * ids      may be empty
 * label    its value, id and is_negative count
 * Returns UINT32_MAX if no voxel has that label. */
CW_API uint32_t cw_label_ids_find(const cw_label_ids *ids, const cw_label *label);

/* Returns the label that voxels of a value have: its number, without a name or a colour.
 * ids      may be empty
 * value    of voxels */
CW_API cw_label cw_label_ids_label(const cw_label_ids *ids, uint32_t value);

/* Replaces packed numbers of 64 bits by values of 32.
 * values       count of them; those of uint64_t where is_unsigned is set
 * is_unsigned  values have no sign
 * numbers      count: set to places in the list, or to the values themselves where all are from 0 to
 *              2^32 - 1
 * ids          freed first, then filled; count is 0 where values were kept
 * Returns      CW_ERR_NO_MEMORY; CW_ERR_LIMIT: 2^32 - 1 labels
 * Cost         in proportion to the values, and n log n labels */
CW_NODISCARD CW_API cw_status cw_labels_renumber(const int64_t *values, bool is_unsigned,
                                                 size_t count, uint32_t *numbers,
                                                 cw_label_ids *ids, cw_error *err);

/* Gives the labels of a table the values that voxels have after they were replaced, and adds those of
 * the list that the table does not have. Labels without voxels get values beyond the list.
 * table    unchanged on failure
 * ids      borrowed; nothing is done if it is empty
 * Returns  CW_ERR_NO_MEMORY */
CW_NODISCARD CW_API cw_status cw_label_table_renumber(cw_label_table *table,
                                                      const cw_label_ids *ids, cw_error *err);

#ifdef __cplusplus
}
#endif

#endif
