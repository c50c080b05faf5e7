/* Stores of Zarr that a test makes: any version, type, order, codec and grid of shards. */
#ifndef TESTS_ZARR_STORE_H
#define TESTS_ZARR_STORE_H

#include <cubewright/volume.h>

enum { ZARR_MAX_RANK = 5 };

/* An array to be written. Lists are in the order of its dimensions. */
typedef struct zarr_made {
    const char *name; /* of its folder in the test's folder */
    int version;      /* 2 or 3 */
    const char *kind; /* "u1", "i2", "f4", "u8" ... as NumPy, "b1" */
    bool big_endian;
    size_t rank;
    size_t shape[ZARR_MAX_RANK], chunk[ZARR_MAX_RANK];
    size_t inner[ZARR_MAX_RANK]; /* of shards; 0: no shards */
    size_t
        order[ZARR_MAX_RANK]; /* transposition, version 3; version 2 has C, or F if it falls */
    const char *codec;        /* "zlib", "gzip", "zstd", "lz4", "blosc"; NULL: none */
    bool has_crc;             /* behind it, and behind the index */
    bool index_at_start;
    char separator;    /* '.' or '/' */
    bool keys_of_v2;   /* version 3: no "c" in front */
    unsigned left_out; /* 3: every third chunk is left out; 0: no chunk is */
    const char *fill;  /* as JSON; NULL: 0 */
    double fill_value; /* the same as a number */
    const char *names; /* of dimensions, as a JSON list; NULL: none */
    double (*value)(const struct zarr_made *made, const size_t at[ZARR_MAX_RANK]);
} zarr_made;

/* Returns true if this build of the tests can write a codec. */
bool zarr_can_write(const char *codec);

/* Writes a file below the test's folder, and the folders that it needs. */
void zarr_put(const char *path, const void *bytes, size_t size);
void zarr_put_text(const char *path, const char *text);

/* Writes the metadata and all chunks. */
void zarr_write(const zarr_made *made);

/* Returns the number that the store holds at a place: of the array, or the fill value where its
 * chunk is left out. */
double zarr_value(const zarr_made *made, const size_t at[ZARR_MAX_RANK]);

/* A value that differs from its neighbours, and that every type can hold. */
double zarr_mixed(const zarr_made *made, const size_t at[ZARR_MAX_RANK]);

/* Encodes bytes; free them. */
void *zarr_pack(const char *codec, const void *bytes, size_t size, size_t number,
                size_t *packed);

#endif
