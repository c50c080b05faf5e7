/* Scaling, mirroring, turning and the pivot of meshes: as typed, done, and for the report. */
#ifndef CLI_INPUTS_PLACE_OPTIONS_H
#define CLI_INPUTS_PLACE_OPTIONS_H

#include "cli/framework/json_writer.h"
#include "cli/framework/options.h"
#include "cli/inputs/mesh_input.h"

extern const cli_kind cli_kind_rotation;
#define CLI_ROTATION (&cli_kind_rotation) /* cli_rotation: z:90 or x:90,z:-45 */

enum { CLI_MAX_ROTATIONS = 8 };

/* Choices of --pivot. */
enum { CLI_PIVOT_FILE, CLI_PIVOT_BASE, CLI_PIVOT_CENTRE };

/* Rotations about axes of the world, one after the other. */
typedef struct cli_rotation {
    size_t count; /* 0: none given */
    int axis[CLI_MAX_ROTATIONS];
    double degrees[CLI_MAX_ROTATIONS];
    char text[96]; /* as it was typed */
} cli_rotation;

/* How a mesh is placed: scaled, mirrored, turned, then moved to its pivot. */
typedef struct cli_placing {
    cli_numbers scale; /* one factor, or three */
    int mirror;        /* 0: off, else 1 + axis */
    cli_rotation rotation;
    int pivot;
} cli_placing;

/* Rows of a command whose struct has a cli_placing at `row`. */
#define CLI_PLACING_OPTIONS(row)                                                               \
    CLI_HEADED("Place"),                                                                       \
        {"scale",                                                                              \
         0,                                                                                    \
         CLI_NUMBERS,                                                                          \
         "F|X,Y,Z",                                                                            \
         "Scale by a factor, or one along each axis, such as 2 or 1,1,0.5 (off)",              \
         row + offsetof(cli_placing, scale)},                                                  \
        {"mirror",                                                                             \
         0,                                                                                    \
         CLI_CHOICE,                                                                           \
         "off/x/y/z",                                                                          \
         "Swap the sides along an axis; the outside stays outside (off)",                      \
         row + offsetof(cli_placing, mirror)},                                                 \
        {"rotate",                                                                             \
         0,                                                                                    \
         CLI_ROTATION,                                                                         \
         "AXIS:DEG",                                                                           \
         "Turn about an axis, counter-clockwise seen from its end: z:90, or x:90,z:45 one "    \
         "after the other (off)",                                                              \
         row + offsetof(cli_placing, rotation)},                                               \
    {                                                                                          \
        "pivot", 0, CLI_CHOICE, "file/base/centre",                                            \
            "Then move to 0,0,0 the middle of the box, or that of its lower side (the file's " \
            "zero stays)",                                                                     \
            row + offsetof(cli_placing, pivot)                                                 \
    }

/* Returns true if something is to be done. */
bool cli_places(const cli_placing *placing);

/* Checks the factors. CW_ERR_ARGUMENT */
CW_NODISCARD cw_status cli_check_placing(const cli_placing *placing, cw_error *err);

/* Places all parts of a mesh that was read, as one, and says so. */
CW_NODISCARD cw_status cli_place_parts(const cli_placing *placing, cli_mesh *mesh,
                                       cw_error *err);

/* Moves meshes, as one, so that 0,0,0 is where a pivot of cli_placing has it.
 * moved  mm by which they were moved along each axis: 0 for the file's zero
 * Returns as cw_mesh_transform() */
CW_NODISCARD cw_status cli_move_to_pivot(int pivot, cw_mesh *meshes, size_t count,
                                         double moved[3], cw_error *err);

/* Writes the field pivot if it is not the file's. */
void cli_json_pivot(cli_json *j, int pivot);

/* Writes the fields scale, mirror, rotate and pivot, as far as they were given. */
void cli_json_placing(cli_json *j, const cli_placing *placing);

#endif
