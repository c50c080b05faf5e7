/* Lists the numbers of labels, and replaces them by their places. */
#ifndef CORE_VOLUME_LABEL_IDS_H
#define CORE_VOLUME_LABEL_IDS_H

#include <cubewright/label_table.h>
#include <cubewright/volume.h>

#include "core/volume/key_counts.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Types of voxels in files that no call takes but those that replace them. */
enum { CWI_I64 = CW_TYPE_COUNT + 8, CWI_U64 };

/* Returns the size of the number that a label has in its file, without its sign. */
static inline uint64_t cwi_label_size(const cw_label *label)
{
    return label->id ? label->id : label->value;
}

/* A list that is being gathered. A zeroed one is empty. */
typedef struct cwi_id_census {
    cwi_key_counts places; /* of numbers as keys; counts are places in the list, from 1 on */
    bool is_unsigned;      /* set before the first number is added */
    bool rounds;           /* values that are not whole are rounded; set before, too */
    bool has_outside;      /* a number is below 0, or beyond 32 bits */
    size_t rounded;        /* voxels */
    double largest_rounding;
} cwi_id_census;

/* Returns true if voxels of a type, or of a scale, can have numbers that are to be replaced. */
bool cwi_id_may_replace(const cw_volume *volume);

/* Returns true for the types of integers of 64 bits. */
bool cwi_id_is_wide(cw_type type);

/* Converts voxels of a row to numbers; those without a value become 0.
 * volume   its type, slope, intercept and no-data value
 * from     the first of them
 * Returns  the number of those converted: less than `count` where the next is no whole number */
size_t cwi_id_load(const cw_volume *volume, const char *from, ptrdiff_t stride, size_t count,
                   cwi_id_census *census, int64_t *to);

/* Adds numbers. Returns CW_ERR_NO_MEMORY; CW_ERR_LIMIT */
CW_NODISCARD cw_status cwi_id_add(cwi_id_census *census, const int64_t *ids, size_t count,
                                  cw_error *err);

/* Fills the list, if numbers are to be replaced, and gives places in it to the census' numbers.
 * Returns CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_id_list(cwi_id_census *census, cw_label_ids *ids, cw_error *err);

/* Makes the table of places of a list. Returns CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_id_places_fill(cwi_key_counts *places, const cw_label_ids *ids,
                                          cw_error *err);

/* Replaces numbers by places; without places they are kept. Returns the number of those replaced: less
 * than `count` where the next is not in the list. */
size_t cwi_id_replace(const cwi_key_counts *places, const int64_t *ids, size_t count,
                      uint32_t *to);

#ifdef __cplusplus
}
#endif

#endif
