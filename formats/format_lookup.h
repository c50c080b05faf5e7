/* Finding the reader of a volume or a mesh. */
#ifndef FORMATS_FORMAT_LOOKUP_H
#define FORMATS_FORMAT_LOOKUP_H

#include "formats/format_registry.h"

/* Find the reader of this name. Return CW_ERR_ARGUMENT, with the names that there are. */
CW_NODISCARD cw_status cwi_volume_reader_by_name(const char *name,
                                                 const cwi_format_driver **found,
                                                 cw_error *err);
CW_NODISCARD cw_status cwi_mesh_reader_by_name(const char *name,
                                               const cwi_format_driver **found, cw_error *err);

/* Find the reader of an open file by its content, then by its extension. Return CW_ERR_FORMAT if
 * there is none, and name the format of a file of the other kind. */
CW_NODISCARD cw_status cwi_volume_reader_of(const cwi_input *in,
                                            const cwi_format_driver **found, cw_error *err);
CW_NODISCARD cw_status cwi_mesh_reader_of(const cwi_input *in, const cwi_format_driver **found,
                                          cw_error *err);

/* Returns the format of the mesh at a path, by its content; NULL: it is no mesh. */
const char *cwi_mesh_format_of(const char *path);

#endif
