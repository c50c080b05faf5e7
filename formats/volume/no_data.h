/* The value of voxels that have none, as the caller states it. */
#ifndef FORMATS_VOLUME_NO_DATA_H
#define FORMATS_VOLUME_NO_DATA_H

#include <cubewright/formats.h>

/* Sets nodata of a volume, or of its header, as desc->nodata says. Voxels stay as they are. */
CW_NODISCARD cw_status cwi_set_nodata(const cw_read_desc *desc, cw_volume *volume,
                                      cw_error *err);

#endif
