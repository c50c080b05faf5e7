/* The metadata of one Zarr array: its type, its grid of chunks, and their codecs. */
#ifndef FORMATS_ZARR_ZARR_ARRAY_H
#define FORMATS_ZARR_ZARR_ARRAY_H

#include "formats/bytes/stored_numbers.h"
#include "formats/zarr/zarr_json.h"

enum {
    CWI_ZARR_RANK = 8,        /* dimensions at most; those beyond 5 must have size 1 */
    CWI_ZARR_CODECS = 8,      /* codecs in a row at most */
    CWI_ZARR_NAME_BYTES = 32, /* of a dimension */
    CWI_ZARR_KEY_BYTES = 1024 /* of the path of a node or a chunk */
};

/* The codecs of bytes to bytes: constant, and the names of versions 2 and 3. */
#define CWI_ZARR_CODEC_TABLE(X)                                                                \
    X(CWI_ZARR_ZLIB, "zlib")                                                                   \
    X(CWI_ZARR_GZIP, "gzip")                                                                   \
    X(CWI_ZARR_ZSTD, "zstd")                                                                   \
    X(CWI_ZARR_LZ4, "lz4")                                                                     \
    X(CWI_ZARR_BLOSC, "blosc")                                                                 \
    X(CWI_ZARR_CRC32C, "crc32c")                                                               \
    X(CWI_ZARR_BZ2, "bz2")                                                                     \
    X(CWI_ZARR_LZ4_FRAMES, "lz4-java")

typedef enum cwi_zarr_codec {
#define CWI_ZARR_ENUM(constant, name) constant,
    CWI_ZARR_CODEC_TABLE(CWI_ZARR_ENUM)
#undef CWI_ZARR_ENUM
        CWI_ZARR_CODEC_COUNT
} cwi_zarr_codec;

/* The codecs from numbers to stored bytes, in the order of encoding. */
typedef struct cwi_zarr_chain {
    bool big_endian;
    size_t count;
    cwi_zarr_codec codecs[CWI_ZARR_CODECS];
} cwi_zarr_chain;

/* The names that messages have for the metadata of an array. */
typedef struct cwi_zarr_words {
    const char *file;       /* "zarr.json" */
    const char *attributes; /* the file of attributes */
    const char *type;       /* key of the type of numbers */
    const char *shape;      /* ... of the sizes */
    const char *frame;      /* ... of the places of voxels */
    bool at_root;           /* one file in the store's folder tells of all arrays */
} cwi_zarr_words;

/* An array. Sizes are in elements, and dimensions in the order of `shape`. */
typedef struct cwi_zarr_array {
    char
        path[CWI_ZARR_KEY_BYTES]; /* of its folder below the store's; "" for the store itself */
    const cwi_zarr_words *words;
    size_t rank;
    size_t shape[CWI_ZARR_RANK];
    cw_type type;        /* of the voxels that are read */
    char type_name[32];  /* as the metadata say */
    size_t stored_bytes; /* of a stored number: 8 for the integers of 64 bits */
    cwi_stored stored;   /* of those, and of floats of 16 bits; the type has 32 bits */
    bool is_signed, is_bool;
    uint64_t fill; /* of missing chunks: begins with a stored number in this machine's order */

    size_t chunk[CWI_ZARR_RANK]; /* of one file; a shard, where there are any */
    char separator;              /* between the numbers of a chunk's key: '.' or '/' */
    bool has_prefix;             /* keys begin with "c" */

    size_t inner[CWI_ZARR_RANK]; /* the chunk that is decoded at once; without shards `chunk` */
    size_t order[CWI_ZARR_RANK]; /* dimension of each axis of its numbers, the slowest first */
    size_t chunk_bytes;          /* of its numbers */
    cwi_zarr_chain chain;        /* of it */

    bool is_sharded;
    bool index_at_start;
    size_t shard_order[CWI_ZARR_RANK]; /* dimension of each axis of the index, slowest first */
    size_t shard_count;                /* inner chunks of a shard */
    cwi_zarr_chain index_chain;

    bool has_names;
    char names[CWI_ZARR_RANK][CWI_ZARR_NAME_BYTES]; /* of the dimensions; "" where unnamed */
} cwi_zarr_array;

/* Fill an array from the metadata of version 2 (.zarray) or 3 (zarr.json); attributes of
 * version 2 (.zattrs) may be NULL. Messages name the key.
 * Returns CW_ERR_FORMAT, CW_ERR_LIMIT, CW_ERR_UNSUPPORTED for a codec that is not in this
 * build */
CW_NODISCARD cw_status cwi_zarr_parse_v2(const json_t *meta, const json_t *attributes,
                                         cwi_zarr_array *array, cw_error *err);
CW_NODISCARD cw_status cwi_zarr_parse_v3(const json_t *meta, cwi_zarr_array *array,
                                         cw_error *err);

/* --- parts that both versions share -------------------------------------------------------- */

/* Sets rank and shape. */
CW_NODISCARD cw_status cwi_zarr_set_shape(const json_t *meta, cwi_zarr_array *array,
                                          cw_error *err);

/* Sets the type from a letter of NumPy (b, i, u, f) and its bytes; returns false for others. */
bool cwi_zarr_set_type(cwi_zarr_array *array, char kind, size_t bytes);

/* Reads fill_value; a missing one, or null, is 0. */
CW_NODISCARD cw_status cwi_zarr_set_fill(const json_t *meta, cwi_zarr_array *array,
                                         cw_error *err);

/* Sets chunk_bytes, and checks that a chunk can be held. */
CW_NODISCARD cw_status cwi_zarr_set_chunk_bytes(cwi_zarr_array *array, const char *key,
                                                cw_error *err);

/* Adds a codec by its name; it must be in this build. Returns CW_ERR_FORMAT for others, as not
 * known at `key`. */
CW_NODISCARD cw_status cwi_zarr_add_codec(cwi_zarr_chain *chain, const char *key,
                                          const char *name, cw_error *err);

/* Copies the names of dimensions from a list of texts, if it has one a dimension. */
void cwi_zarr_set_names(cwi_zarr_array *array, const json_t *list);

#endif
