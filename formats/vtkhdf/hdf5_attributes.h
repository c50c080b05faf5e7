/* Attributes of groups in HDF5 files, of numbers and of texts. */
#ifndef FORMATS_VTKHDF_HDF5_ATTRIBUTES_H
#define FORMATS_VTKHDF_HDF5_ATTRIBUTES_H

#include "formats/vtkhdf/hdf5_file.h"

/* Reads `count` numbers: int64_t if they must be whole, else double.
 * has      set to whether there is such an attribute; without one *to is unchanged
 * Returns  CW_ERR_FORMAT for values of another kind or another count */
CW_NODISCARD cw_status cwi_hdf5_numbers(hid_t group, const char *name, bool whole, size_t count,
                                        void *to, bool *has, cw_error *err);

/* Reads a text, cut off at the capacity; empty where there is no such attribute. */
CW_NODISCARD cw_status cwi_hdf5_text(hid_t group, const char *name, char *to, size_t capacity,
                                     cw_error *err);

#endif
