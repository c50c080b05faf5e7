/* Files that others write and that are not read here: what they are, and the way on. */
#ifndef FORMATS_FOREIGN_FILES_H
#define FORMATS_FOREIGN_FILES_H

#include "formats/bytes/input_file.h"

/* Refuses a file whose content is known and not read: a zip archive that is no 3MF, HDF5
 * that is no VTKHDF, text in UTF-16.
 * head  the first bytes, size of them */
CW_NODISCARD cw_status cwi_refuse_content(const cwi_input *in, const unsigned char *head,
                                          size_t size, cw_error *err);

/* Names a file of another program, by content or extension, and what converts it; NULL: it is not known.
 * Static text. */
const char *cwi_name_foreign(const char *path, const unsigned char *head, size_t size);

#endif
