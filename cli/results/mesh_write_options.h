/* The options that say how a mesh is written, for every command that turns meshes
 * into meshes. */
#ifndef CLI_RESULTS_MESH_WRITE_OPTIONS_H
#define CLI_RESULTS_MESH_WRITE_OPTIONS_H

#include "cli/framework/json_writer.h"
#include "cli/inputs/mesh_input.h"
#include "cli/results/compress_options.h"

typedef struct cli_written {
    const char *name, *format;
    int unit, up, frame; /* cw_unit; z, y; keep, lps, ras */
    bool ascii, local, no_clobber;
} cli_written;

/* Rows for a command whose struct has the field `written`. */
#define CLI_WRITTEN_ROW(args, field) offsetof(args, written) + offsetof(cli_written, field)
#define CLI_WRITTEN_OPTIONS(args)                                                              \
    CLI_HEADED("Output file"),                                                                 \
        {"format",                                                                             \
         0,                                                                                    \
         CLI_TEXT,                                                                             \
         "NAME",                                                                               \
         "Format to write; names as in 'formats' (by extension)",                              \
         CLI_WRITTEN_ROW(args, format),                                                        \
         CLI_VALUES_MESH_WRITER},                                                              \
        {"ascii",                                                                              \
         0,                                                                                    \
         CLI_FLAG,                                                                             \
         NULL,                                                                                 \
         "Write STL and PLY as text (off: binary)",                                            \
         CLI_WRITTEN_ROW(args, ascii)},                                                        \
        {"unit",                                                                               \
         0,                                                                                    \
         CLI_CHOICE,                                                                           \
         "mm/um/cm/m/in/ft",                                                                   \
         "Unit of the coordinates in the file (mm)",                                           \
         CLI_WRITTEN_ROW(args, unit)},                                                         \
        {"up",                                                                                 \
         0,                                                                                    \
         CLI_CHOICE,                                                                           \
         "z/y",                                                                                \
         "Axis that points to the head (z; glTF: always y)",                                   \
         CLI_WRITTEN_ROW(args, up)},                                                           \
        {"frame",                                                                              \
         0,                                                                                    \
         CLI_CHOICE,                                                                           \
         "keep/lps/ras",                                                                       \
         "Directions of x and y: LPS or RAS (the input's, else lps)",                          \
         CLI_WRITTEN_ROW(args, frame)},                                                        \
        {"local",                                                                              \
         0,                                                                                    \
         CLI_FLAG,                                                                             \
         NULL,                                                                                 \
         "Write coordinates relative to the mesh's origin, which is printed (off: world)",     \
         CLI_WRITTEN_ROW(args, local)},                                                        \
        {"name",                                                                               \
         0,                                                                                    \
         CLI_TEXT,                                                                             \
         "TEXT",                                                                               \
         "Name of the object inside the file (the part's, else the file's)",                   \
         CLI_WRITTEN_ROW(args, name)},                                                         \
    {                                                                                          \
        "no-clobber", 0, CLI_FLAG, NULL, "Fail if the output exists (off: replace it)",        \
            CLI_WRITTEN_ROW(args, no_clobber)                                                  \
    }

/* How to write: with --frame keep the axes are those of the input, as far as it was read. */
cw_write_desc cli_written_desc(const cli_written *w, const cli_compress *compress,
                               const cli_mesh *input);

/* Keys of a report's params, for the mesh at a path. */
void cli_json_written(cli_json *j, const cli_written *w, const char *path);

#endif
