/* The driver of NumPy's files, and what it calls. */
#ifndef FORMATS_NPY_NPY_FORMAT_H
#define FORMATS_NPY_NPY_FORMAT_H

#include "formats/driver/format_driver.h"

/* Bytes at the start of a file in which its header must be. */
enum { CWI_NPY_HEADER = 1 << 16 };

extern const cwi_format_driver cwi_format_npy, cwi_format_npz;

cwi_volume_sniffer cwi_npy_sniff, cwi_npz_sniff;
cwi_header_parser cwi_npy_parse, cwi_npz_parse;

/* Describes an array by the first bytes of its file.
 * head     changed; it has room for one byte more
 * Returns  CW_ERR_FORMAT, CW_ERR_UNSUPPORTED, CW_ERR_LIMIT */
CW_NODISCARD cw_status cwi_npy_describe(char *head, size_t size, cwi_source *src,
                                        cw_error *err);

#endif
