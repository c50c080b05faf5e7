/* Reading a mesh, for every command that takes one. */
#ifndef CLI_INPUTS_MESH_INPUT_H
#define CLI_INPUTS_MESH_INPUT_H

#include "cli/inputs/volume_input.h"

#include <cubewright/formats.h>

/* Rows for a command that reads meshes and no volumes; its struct has the field `input`. */
#define CLI_MESH_INPUT_OPTIONS(args)                                                           \
    CLI_HEADED(CLI_READING),                                                                   \
        {"reader",                                                                             \
         0,                                                                                    \
         CLI_TEXT,                                                                             \
         "NAME",                                                                               \
         "Read the file as this format; names as in 'formats' (by content)",                   \
         CLI_INPUT_ROW(args, reader),                                                          \
         CLI_VALUES_MESH_READER},                                                              \
        CLI_CLAIM_OPTIONS("input", "the input", CLI_INPUT_ROW(args, claim)),                   \
        {"allow-external",                                                                     \
         0,                                                                                    \
         CLI_FLAG,                                                                             \
         NULL,                                                                                 \
         "Follow a .gltf file to buffers outside its folder (off)",                            \
         CLI_INPUT_ROW(args, allow_external)},                                                 \
        {"truncated",                                                                          \
         0,                                                                                    \
         CLI_FLAG,                                                                             \
         NULL,                                                                                 \
         "Take the whole facets of an STL file that breaks off (off: it is refused)",          \
         CLI_INPUT_ROW(args, truncated)},                                                      \
        CLI_SANDBOX_OPTION(args), CLI_HEADED(CLI_LIMITS), CLI_TIME_OPTIONS(args),              \
        {"max-triangles",                                                                      \
         0,                                                                                    \
         CLI_COUNT,                                                                            \
         "N",                                                                                  \
         "Stop before reading more triangles than this, such as 100M (no limit)",              \
         CLI_INPUT_ROW(args, max_triangles)},                                                  \
        CLI_MEMORY_OPTION(args)

/* A mesh file: merged, or its parts. */
typedef struct cli_mesh {
    const char *path;
    cw_mesh mesh;   /* of all parts; owned */
    cw_part *parts; /* owned; NULL when they are merged */
    size_t part_count;
    cw_mesh_file file;
    cw_part *pictured; /* the parts of a textured mesh that is merged; owned; or NULL */
    size_t pictured_count;
    const cw_textures *textures; /* of the merged mesh, if all parts have the same; else NULL */
} cli_mesh;

/* Reads a mesh, all parts merged, and says what was found. Errors name the file.
 * reader  a name of 'formats'; NULL: by content        input  for its memory and safety */
CW_NODISCARD cw_status cli_read_mesh(const char *path, const char *reader,
                                     const cli_input *input, cli_mesh *mesh, cw_error *err);

/* Reads a mesh to compare the input with. The claims about the input fill in only what this
 * file does not state. */
CW_NODISCARD cw_status cli_read_reference(const char *path, const char *reader,
                                          const cli_input *input, cli_mesh *mesh,
                                          cw_error *err);

/* Reads the parts of a file, each as a mesh, and says what was found. */
CW_NODISCARD cw_status cli_read_parts(const char *path, const char *reader,
                                      const cli_input *input, cli_mesh *mesh, cw_error *err);

/* Reads the parts of a file that was read as one mesh, and says nothing.
 * is_reference  it was read by cli_read_reference() */
CW_NODISCARD cw_status cli_read_parts_again(const cli_mesh *whole, bool is_reference,
                                            const char *reader, const cli_input *input,
                                            cli_mesh *parts, cw_error *err);

/* Turns shells round that face the wrong way, of each part by itself, and says how many. */
CW_NODISCARD cw_status cli_orient_mesh(cli_mesh *mesh, int threads, cw_error *err);

/* Counts the triangles of all parts. */
size_t cli_mesh_triangles(const cli_mesh *mesh);

/* Returns true if some of it has texture coordinates. */
bool cli_is_textured(const cli_mesh *mesh);

/* Frees a mesh that was read; a zeroed one is allowed. */
void cli_free_mesh(cli_mesh *mesh);

/* An object of reports; sha256 of the file, when it can be read again. */
void cli_json_mesh_file(cli_json *j, const char *key, const cli_mesh *mesh);

#endif
