/* Reading a mesh, for every command that takes one. */
#ifndef CLI_MESH_H
#define CLI_MESH_H

#include "cli/input.h"

#include <cubewright/formats.h>

typedef struct cli_mesh {
    const char *path;
    cw_mesh mesh; /* owned */
    cw_mesh_file file;
} cli_mesh;

/* Reads a mesh and says what was found. Errors name the file.
 * reader  a name of 'formats'; NULL: by content        input  for its memory and safety */
cw_status cli_read_mesh(const char *path, const char *reader, const cli_input *input,
                        cli_mesh *mesh, cw_error *err);

/* An object of reports; sha256 of the file, when it can be read again. */
void cli_json_mesh_file(cli_json *j, const char *key, const cli_mesh *mesh);

#endif
