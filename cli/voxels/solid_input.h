/* Solids of one or more mesh files, each with a name and a label: parts of files, welded. */
#ifndef CLI_VOXELS_SOLID_INPUT_H
#define CLI_VOXELS_SOLID_INPUT_H

#include "cli/inputs/mesh_input.h"

#include <cubewright/voxelize.h>

/* A part of a file. */
typedef struct cli_solid {
    const char *path; /* of the file */
    const cw_mesh *mesh;
    char *name;     /* that of the part, else the file's stem and a number; owned */
    cw_label label; /* value, name and colour; borrows them */
} cli_solid;

typedef struct cli_solids {
    cli_mesh *files;
    size_t file_count;
    cli_solid *solid;
    size_t count, triangles;
    const cw_mesh **meshes;  /* count: those of the solids */
    cw_voxelize_part *parts; /* count: for facts */
    uint32_t *labels;        /* count: their values */
} cli_solids;

/* Reads the parts of all files, with vertices at equal positions as one. Labels have the values of the files
 * where all parts have some that differ; else they are numbered from 1. Errors name the file. Free them, also
 * after failure, with cli_free_solids().
 * Returns  as cw_parts_read(); CW_ERR_EMPTY for a file without triangles */
CW_NODISCARD cw_status cli_read_solids(const char *const *paths, size_t count,
                                       const char *reader, const cli_input *input,
                                       cli_solids *solids, cw_error *err);
void cli_free_solids(cli_solids *solids);

/* Puts the file and the part, if there are several, in front of an error of cw_voxelize(). */
cw_status cli_fail_solids(const cli_solids *solids, cw_status status, cw_error *err);

/* Says what is lost, or was done to a mesh, when it was voxelized. partial: fractions are kept */
void cli_tell_solids(const cli_solids *solids, bool partial);

#endif
