/* Leaving small components out of surfaces that are in temporary files. */
#ifndef CLI_EXTRACT_SMALL_COMPONENTS_H
#define CLI_EXTRACT_SMALL_COMPONENTS_H

#include <cubewright/spool.h>

/* Gives a spool's surface without small components to a sink, as cw_mesh_spool_drop_volumes() does,
 * and tells how many there are.
 * name       of the volume, for messages
 * max_bytes  limit of the working memory
 * Returns    CW_ERR_EMPTY when no component is kept; CW_ERR_LIMIT, which names --memory; an error
 *            of the sink as it is; as cw_mesh_spool_drop_volumes() */
CW_NODISCARD cw_status cli_drop_small_components(const char *name, const cw_mesh_spool *spool,
                                                 double least_mm3, size_t max_bytes,
                                                 cw_chunk_sink kept, cw_drop_counts *counts,
                                                 cw_error *err);

#endif
