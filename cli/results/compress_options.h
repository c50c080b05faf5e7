/* The options that say how a mesh is compressed, for every command that writes one. */
#ifndef CLI_RESULTS_COMPRESS_OPTIONS_H
#define CLI_RESULTS_COMPRESS_OPTIONS_H

#include "cli/framework/options.h"

#include <cubewright/formats.h>

typedef struct cli_compress {
    int kind; /* cw_compression */
    cli_length tolerance;
    size_t bits, effort; /* effort: Draco's, from 1 to 10; 0: its own */
} cli_compress;

/* Rows for a command whose struct has the field `compress`. length: the kind of a tolerance, as voxels
 * are known or not */
#define CLI_COMPRESS_ROW(args, field) offsetof(args, compress) + offsetof(cli_compress, field)
#define CLI_COMPRESS_OPTIONS(args, length)                                                     \
    CLI_HEADED("Compression"),                                                                 \
        {"compress",                                                                           \
         0,                                                                                    \
         CLI_CHOICE,                                                                           \
         "none/quantize/draco/meshopt",                                                        \
         "Compression of a glTF file; viewers need its extension; verified by decoding "       \
         "(none)",                                                                             \
         CLI_COMPRESS_ROW(args, kind)},                                                        \
        {"tolerance",                                                                          \
         0,                                                                                    \
         length,                                                                               \
         "L",                                                                                  \
         "Largest movement of a vertex by compression, such as 0.05mm (0.005% of the box's "   \
         "diagonal)",                                                                          \
         CLI_COMPRESS_ROW(args, tolerance)},                                                   \
        {"bits",                                                                               \
         0,                                                                                    \
         CLI_COUNT,                                                                            \
         "N",                                                                                  \
         "Bits of a coordinate in place of a tolerance: up to 16, meshopt 24, draco 30, "      \
         "which takes 4 GiB (by tolerance)",                                                   \
         CLI_COMPRESS_ROW(args, bits)},                                                        \
    {                                                                                          \
        "effort", 0, CLI_COUNT, "N", "Effort of Draco, from 1 (fast) to 10 (small) (7)",       \
            CLI_COMPRESS_ROW(args, effort)                                                     \
    }

#define CLI_COMPRESS_RULES                                                                     \
    {"tolerance bits", CLI_NEEDS, "compress"}, {"effort", CLI_NEEDS, "compress=draco"},        \
    {                                                                                          \
        "bits", CLI_EXCLUDES, "tolerance"                                                      \
    }

/* Refuses values out of range. */
CW_NODISCARD cw_status cli_check_compress(const cli_compress *compress, cw_error *err);

/* Fills in what a mesh is to be written with. */
void cli_set_compress(const cli_compress *compress, const cw_part *parts, size_t count,
                      double voxel_mm, cw_write_desc *desc);

const char *cli_compression_name(cw_compression kind);

#endif
