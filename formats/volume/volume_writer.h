/* The common parts of the writers of volumes. */
#ifndef FORMATS_VOLUME_VOLUME_WRITER_H
#define FORMATS_VOLUME_VOLUME_WRITER_H

#include "formats/bytes/deflate_file.h"

#include <cubewright/formats.h>

/* A volume to be written to one file. */
typedef struct cwi_save {
    const cw_volume *volume; /* resolved */
    cwi_outfile *file;
    const char *name; /* one line of text */
    bool gzip;        /* the path ends in .gz */
    const cw_progress *progress;
    const cw_label_table *labels; /* of a label map; NULL: none */
} cwi_save;

typedef cw_status cwi_volume_saver(const cwi_save *save, cw_error *err);

/* Passes the voxels to the sink and finishes it. Order: x fastest, then y, z, time; the
 * components interleaved in front of x, or one whole series after another. */
CW_NODISCARD cw_status cwi_save_voxels(const cwi_save *save, bool components_last,
                                       cwi_sink *sink, cw_error *err);

#endif
