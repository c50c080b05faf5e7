/* The files with the voxels of a source, one after the other: opening, checking, decoding. */
#ifndef FORMATS_VOLUME_VOXEL_PARTS_H
#define FORMATS_VOLUME_VOXEL_PARTS_H

#include "formats/text/ascii_voxels.h"
#include "formats/volume/region_runs.h"

/* An open file with voxels. */
typedef struct cwi_part_file {
    int fd;
    uint64_t size;  /* of the file; less where the voxels end earlier */
    uint64_t start; /* of the (encoded) voxels in it */
    uint64_t left;  /* bytes behind the voxels, where none belong there */
    bool own;       /* fd is closed together with the part */
} cwi_part_file;

/* The state of reading all parts, and of the open one. */
typedef struct cwi_part_reading {
    const cwi_source *src;
    const cw_progress *progress;
    cwi_runs runs;     /* the wanted bytes */
    uint64_t at;       /* offset among the bytes of all voxels */
    unsigned char *to; /* destination of the next wanted bytes */
    cwi_stream stream;
    cwi_packed_blocks blocks;
    cwi_numbers numbers;
    uint64_t left;  /* decoded bytes behind the voxels, where none belong there */
    bool needs_u32; /* reading failed at an integer that fits CW_U32, but not CW_I32 */
} cwi_part_reading;

/* Reports bytes behind the voxels. */
void cwi_part_note_left(const cwi_source *src, uint64_t left, const cw_read_desc *desc);

/* Returns the name of what is stored, for messages. */
const char *cwi_source_noun(const cwi_source *src);

/* Returns the bytes of voxels in each file. */
size_t cwi_source_part_bytes(const cwi_source *src);

/* Returns the name of a file; NULL: the header's own. */
const char *cwi_part_name(const cwi_source *src, size_t index);

/* Opens a file, and checks that it can hold its share of the voxels. */
CW_NODISCARD cw_status cwi_part_open(const cwi_source *src, const cwi_input *in, size_t index,
                                     cwi_part_file *part, cw_error *err);
void cwi_part_close(cwi_part_file *part);

/* Opens a stream over the encoded voxels of a file, and the table of their blocks, if any. Close
 * both in any case. */
CW_NODISCARD cw_status cwi_part_open_stream(const cwi_source *src, const cwi_part_file *part,
                                            cwi_stream *stream, cwi_packed_blocks *blocks,
                                            cw_error *err);

/* Reads the wanted bytes of a file that ends at this offset of all. */
CW_NODISCARD cw_status cwi_part_read_runs(cwi_part_reading *reading, uint64_t end,
                                          cw_error *err);

/* Checks if compressed data end later than the header states. */
CW_NODISCARD cw_status cwi_part_check_packed(const cwi_part_reading *reading, uint64_t start,
                                             cw_error *err);

#endif
