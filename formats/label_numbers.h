/* Replaces the numbers of labels that no voxel can have, for those who read label maps. */
#ifndef FORMATS_LABEL_NUMBERS_H
#define FORMATS_LABEL_NUMBERS_H

#include <cubewright/formats.h>

/* Replaces the voxels of a volume that was read with desc->ids, and fills them. On failure the volume
 * is freed. Returns CW_ERR_NO_MEMORY; CW_ERR_LIMIT; CW_ERR_ARGUMENT: a voxel that is no whole
 * number */
CW_NODISCARD cw_status cwi_renumber_volume(const cw_read_desc *desc, cw_volume *volume,
                                           cw_error *err);

/* Visits slices whose voxels are replaced by places in desc->ids. Returns as the visitor;
 * CW_ERR_ARGUMENT: a voxel is no whole number, or not in the list */
CW_NODISCARD cw_status cwi_visit_renumbered(const cw_read_desc *desc,
                                            const cw_slice_source *source,
                                            const cw_slice_visitor *visitor, cw_error *err);

/* Visits slices as cw_volume_visit() does, but as they are in the file: voxels may be CWI_I64 or
 * CWI_U64 where desc->ids is set. Returns as cw_volume_visit() */
CW_NODISCARD cw_status cwi_visit_stored(const char *path, const cw_read_desc *desc,
                                        size_t component, size_t step,
                                        const cw_slice_visitor *visitor, cw_error *err);

#endif
