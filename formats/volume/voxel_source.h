/* The description of voxels in files by a header parser, and the common reader that loads
 * them. */
#ifndef FORMATS_VOLUME_VOXEL_SOURCE_H
#define FORMATS_VOLUME_VOXEL_SOURCE_H

#include "formats/bytes/block_reader.h"
#include "formats/bytes/input_file.h"
#include "formats/bytes/stored_numbers.h"

/* The encoding of voxels in a file. */
typedef enum cwi_encoding {
    CWI_RAW,
    CWI_DEFLATED, /* gzip or zlib, distinguished by content */
    CWI_BARE,     /* deflated without header and checksum, as in zip archives */
    CWI_BZIP2,
    CWI_ASCII, /* decimal numbers with blanks between them */
    CWI_HEX,   /* two hexadecimal digits per byte; blanks between them are ignored */
    CWI_BLOCKS /* compressed block by block, behind a table */
} cwi_encoding;

/* The meaning of an axis of the file. */
typedef enum cwi_role {
    CWI_AXIS_X,
    CWI_AXIS_Y,
    CWI_AXIS_Z,
    CWI_AXIS_COMPONENT,
    CWI_AXIS_STEP,
    CWI_ROLE_COUNT
} cwi_role;

typedef struct cwi_axis {
    cwi_role role;
    size_t size;
} cwi_axis;

/* The description of voxels. A zeroed source describes nothing. Free it with
 * cwi_source_free(). */
typedef struct cwi_source {
    cw_volume shape;               /* everything but the voxels; strides as in the file */
    cwi_stored stored;             /* the form of numbers in the file, if not shape.type */
    size_t bytes;                  /* of all voxels in memory */
    cwi_axis axes[CWI_ROLE_COUNT]; /* the fastest first; each role occurs at most once */
    size_t axis_count;
    const char *size_field;  /* the header's name for the sizes, for messages */
    const char *frame_field; /* ... and for directions, spacing and origin */
    bool may_widen;          /* shape.type may become CW_U32 where CW_I32 is too small */
    const char *noun;        /* name of the stored items, in messages; NULL: voxels */

    cwi_names files; /* data files, each with an equal share; none: the header's own file */
    cwi_encoding encoding;
    cwi_block_form blocks; /* of CWI_BLOCKS */
    bool base64;           /* the encoded bytes are again encoded, as base64 text */
    bool big_endian;
    uint64_t offset; /* bytes at the start of each file before everything else */
    uint64_t span;   /* bytes of the file behind the offset, voxels among them; 0: all */
    uint64_t lines;  /* lines behind the offset to leave out */
    uint64_t skip;   /* decoded bytes in front of the first voxel */
    uint32_t crc;    /* of CWI_BARE: of the decoded bytes */
    uint64_t packed; /* compressed bytes, as stated by "CompressedDataSize"; 0: unknown */
    bool at_end;     /* raw: the voxels are the last bytes of the file instead */
    bool is_last;    /* the file ends with the voxels; a note reports bytes behind them */
    bool has_arrays; /* with names: it is the requested one, if any was requested */
    char note[400];  /* information for the user; empty: nothing */
} cwi_source;

/* Sets axes, sizes, strides and bytes from the file's axes, the fastest first; roles left out
 * have size 1. shape.type must be set.
 * Returns CW_ERR_FORMAT for more than 16 components, CW_ERR_LIMIT when the size overflows. */
CW_NODISCARD cw_status cwi_source_set_axes(cwi_source *src, const cwi_axis *axes, size_t count,
                                           cw_error *err);

/* Sets the type of voxels whose numbers have a form of their own in the file. */
void cwi_source_set_stored(cwi_source *src, cwi_stored stored);

/* Keeps integers of 64 bits as they are, for those who replace them; those in text stay refused where they
 * do not fit 32. Returns CW_ERR_LIMIT when the size overflows. */
CW_NODISCARD cw_status cwi_source_keep_wide(cwi_source *src, cw_error *err);

/* Adds to the source's note. */
void cwi_source_note(cwi_source *src, const char *format, ...) CW_PRINTF(2, 3);

/* Refuses a voxel type by its name in the file, and lists those that are read. */
cw_status cwi_fail_type(cw_error *err, const char *field, const char *name);

/* Turns a right-anterior-superior affine to LPS or back. */
void cwi_flip_ras(double affine[3][4]);

/* Fills columns that are all zero (2D data have no third axis) with a unit vector perpendicular
 * to the others. */
void cwi_fill_columns(double affine[3][4]);

/* Refuses an affine with columns that are not finite, have no length or lie in one plane. */
CW_NODISCARD cw_status cwi_check_frame(const cw_volume *shape, const char *field,
                                       cw_error *err);

/* Refuses more voxels, or bytes of them, than the description allows. */
CW_NODISCARD cw_status cwi_check_limits(const cw_volume *shape, size_t bytes, const char *field,
                                        const cw_read_desc *desc, cw_error *err);

/* Checks the source, except its frame, against its files and the limits. Then reads the voxels
 * (unless desc->header_only), all of them or desc->region. Nothing is allocated before every
 * size is known to be possible.
 *
 * volume   filled on success, else untouched
 * Returns  as cw_volume_read() */
CW_NODISCARD cw_status cwi_source_load(const cwi_source *src, const cwi_input *in,
                                       const cw_read_desc *desc, cw_volume *volume,
                                       cw_error *err);

/* Checks as cwi_source_load(), but for the limit of bytes, and gives the voxels to in->visit
 * slice by slice. */
CW_NODISCARD cw_status cwi_source_visit(const cwi_source *src, const cwi_input *in,
                                        const cw_read_desc *desc, cw_error *err);

void cwi_source_free(cwi_source *src);

#endif
