/* Names outputs before the work is done, and checks that they can be written. */
#ifndef CLI_RESULTS_OUTPUT_NAMES_H
#define CLI_RESULTS_OUTPUT_NAMES_H

#include "cli/framework/options.h"
#include "cli/inputs/time_series.h"

#include <cubewright/formats.h>

/* Fails when the output is one of the inputs, by any name. */
CW_NODISCARD cw_status cli_check_output(const char *output, const char *const *inputs,
                                        size_t input_count, cw_error *err);

/* Fails when two outputs are the same file, by name or by a link. */
CW_NODISCARD cw_status cli_check_apart(const char *a, const char *b, cw_error *err);

/* The files of a run. */
typedef struct cli_outputs {
    size_t count;
    char **path;
} cli_outputs;

/* Names them, all levels of a step and then those of the next: {level}, {step}, {stem} and
 * {parent} (of the step's file, and its folder) of the text are filled in. Free, also after failure, with
 * cli_free_outputs(). Returns CW_ERR_ARGUMENT for a level that is there twice, an unknown
 * {part}, and when several levels or steps come without a part that tells them apart;
 * CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cli_name_outputs(cli_outputs *outputs, const char *text,
                                        const cli_series *series, const cli_numbers *levels,
                                        cw_error *err);

/* Names one output a part: {name} (that of the part, with what no file name may hold as '_'),
 * {part} (its number, from 1), {stem} and, of labels, {label}, {layer} and {parent} (the input's
 * folder) of the text are filled in. Free it with
 * cli_free_outputs(). Returns CW_ERR_ARGUMENT for an unknown {part}, and when several parts
 * come without {name} or {part}; CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cli_name_part_outputs(cli_outputs *outputs, const char *text,
                                             const char *input, const cw_part *parts,
                                             size_t count, cw_error *err);

/* Returns true if a mesh is written as glTF, which holds levels of detail in one file. format: of
 * --format, or NULL. */
bool cli_is_gltf(const char *output, const char *format);

/* The files of levels of detail. */
typedef enum cli_lod_files {
    CLI_LOD_APART, /* a file a level */
    CLI_LOD_BOTH,  /* and one more with all of them */
    CLI_LOD_TOGETHER
} cli_lod_files;

/* Returns the files of levels: glTF has both kinds, a mesh of neuroglancer is all
 * levels together. */
cli_lod_files cli_lod_files_of(const char *output, const char *format);

/* Checks the counts of --lod: each at least 1, and fewer than the one before. */
CW_NODISCARD cw_status cli_check_lod(const cli_counts *lod, cw_error *err);

/* Names one output a level of detail: {lod} (its number, from 0), {stem} and {parent} are filled in. A
 * text without {lod} gets "-lod0" and so on in front of its extension, and, with both kinds of
 * files, is itself the name of one more output, the last. Together there is that one alone.
 * Free it with cli_free_outputs(). */
/* Returns true if a name holds {lod}. */
bool cli_holds_lod(const char *text);

CW_NODISCARD cw_status cli_name_lod_outputs(cli_outputs *outputs, const char *text,
                                            const char *input, size_t levels,
                                            cli_lod_files files, cw_error *err);

/* Names the only output of a run: {stem} and {parent} are filled in. Free it with cli_free_outputs(). */
CW_NODISCARD cw_status cli_name_output(cli_outputs *outputs, const char *text,
                                       const char *input, cw_error *err);
void cli_free_outputs(cli_outputs *outputs);

/* Checks that a mesh can be written to a path, or to standard output. Returns as cw_mesh_write_check() */
CW_NODISCARD cw_status cli_check_writable(const char *path, const cw_write_desc *desc,
                                          cw_error *err);

/* Fails when one of them could not be written, is an input or another of them. */
CW_NODISCARD cw_status cli_check_outputs(const cli_outputs *outputs, const char *const *inputs,
                                         size_t input_count, const cw_write_desc *desc,
                                         cw_error *err);

#endif
