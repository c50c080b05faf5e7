/* Extracts the surface of sparse grids, block by block; nothing is made dense. */
#ifndef EXTRACT_SPARSE_SPARSE_EXTRACT_H
#define EXTRACT_SPARSE_SPARSE_EXTRACT_H

#include "extract/dense/isa_dispatch.h"

/* Does the same as cw_extract(), for a sparse volume from cw_volume_select(); with mesh NULL
 * the same as cw_extract_predict(). */
CW_NODISCARD cw_status cwi_extract_sparse(const cwi_engine *engine, const cw_volume *volume,
                                          const cw_extract_desc *desc, cw_mesh *mesh,
                                          cw_extract_counts *counts, cw_error *err);

#endif
