/* Parts of a mesh on their way into a file: named, placed, stripped of what it cannot hold. */
#ifndef FORMATS_PARTS_H
#define FORMATS_PARTS_H

#include "formats/mesh_writers.h"

/* Fills in the parts with triangles, and the origin that all of them count from (zeros unless
 * desc->local). Unless each may have arrays of its own, those that one of them lacks are left
 * out. Free them with cwi_parts_free().
 * Returns CW_ERR_ARGUMENT as cw_mesh_check(), and when no part has triangles; CW_ERR_NO_MEMORY
 */
cw_status cwi_parts_place(const cw_part *parts, size_t count, const cw_write_desc *desc,
                          bool own_arrays, const char *name, cwi_parts *placed,
                          double origin[3], cw_error *err);
void cwi_parts_free(cwi_parts *parts);

/* The name that desc gives to all parts together, or that of the only one, or the path's last
 * part without its extension. */
void cwi_choose_name(const char *path, const cw_part *parts, size_t count,
                     const cw_write_desc *desc, char name[CWI_NAME_BYTES]);

#endif
