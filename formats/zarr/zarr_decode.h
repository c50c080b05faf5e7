/* Decoding of chunks in memory: compression, checksums, byte order. */
#ifndef FORMATS_ZARR_ZARR_DECODE_H
#define FORMATS_ZARR_ZARR_DECODE_H

#include "formats/zarr/zarr_array.h"

/* Bytes that a byte of deflated data stands for at most, and those that any encoder may add to what it
 * packs, beside an eighth. */
enum { CWI_ZARR_DEFLATE_RATIO = 1032, CWI_ZARR_SLACK_BYTES = 1024 };

/* Returns CW_ERR_UNSUPPORTED for a codec that is not in this build, with its package. */
CW_NODISCARD cw_status cwi_zarr_codec_check(cwi_zarr_codec codec, cw_error *err);

/* Returns the bytes that an encoded chunk of `size` decoded bytes takes at most. No encoder
 * adds more than an eighth. Returns the exact number where no codec compresses. */
size_t cwi_zarr_packed_max(const cwi_zarr_chain *chain, size_t size, bool *exact);

/* Refuses an encoded size that cannot stand for `size` decoded bytes: too long, or shorter than
 * its codecs can pack. Called before anything is allocated. Returns CW_ERR_FORMAT */
CW_NODISCARD cw_status cwi_zarr_packed_check(const cwi_zarr_chain *chain, uint64_t packed,
                                             size_t size, cw_error *err);

/* Decodes a chunk to exactly `size` bytes, and no byte more. Numbers of `number` bytes get the
 * order of this machine.
 * packed   may be `to` where there are no codecs
 * Returns  CW_ERR_FORMAT: damaged, another size, or a wrong checksum; CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_zarr_decode(const cwi_zarr_chain *chain, const unsigned char *packed,
                                       size_t packed_size, void *to, size_t size, size_t number,
                                       cw_error *err);

/* Decodes one codec to at most `capacity` bytes; *got is their number. As cwi_zarr_decode(). */
CW_NODISCARD cw_status cwi_zarr_unpack(cwi_zarr_codec codec, const unsigned char *packed,
                                       size_t packed_size, void *to, size_t capacity,
                                       size_t *got, cw_error *err);

/* Computes the CRC-32C (Castagnoli) of bytes. */
uint32_t cwi_crc32c(const void *bytes, size_t size);

/* Decode one codec: at most `capacity` bytes, and *got is their number. Return false for
 * damaged data, and for more bytes; *starved is set when memory ran out. */
bool cwi_zarr_zstd_present(void);
bool cwi_zarr_zstd_decode(const unsigned char *packed, size_t packed_size, void *to,
                          size_t capacity, size_t *got, bool *starved);
bool cwi_zarr_blosc_present(void);
bool cwi_zarr_blosc_decode(const unsigned char *packed, size_t packed_size, void *to,
                           size_t capacity, size_t *got, bool *starved);

/* Decodes what lz4-java writes: frames of a block each. */
bool cwi_zarr_lz4_frames_decode(const unsigned char *packed, size_t packed_size, void *to,
                                size_t capacity, size_t *got);

#endif
