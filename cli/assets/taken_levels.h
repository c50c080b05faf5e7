/* Levels of detail as a pipeline gives them away, with the surface and the maps that they share. */
#ifndef CLI_ASSETS_TAKEN_LEVELS_H
#define CLI_ASSETS_TAKEN_LEVELS_H

#include "cli/assets/texture_options.h"

#include <cubewright/pipeline.h>

/* Levels on their way. Zero it, set lod and levels, and free it with cli_free_taken(). */
typedef struct cli_taken_levels {
    cli_counts lod;   /* triangles asked for; afterwards of the levels that were taken */
    bool drops_equal; /* a level with as many triangles as the one before is left out */
    cw_mesh *levels;  /* CLI_MAX_COUNTS; owned by the caller */
    cw_mesh full;     /* the surface that they were made of */
    cw_pipeline_facts facts[CLI_MAX_COUNTS]; /* of each level */
    cli_maps maps;                           /* of all levels */
    size_t count;                            /* of levels taken so far */
    size_t triangles;                        /* of all of them */
} cli_taken_levels;

/* Returns the sink that takes the levels, the maps with the first and the full surface with the last. */
cw_pipeline_sink cli_level_sink(cli_taken_levels *taken);

/* Moves level 0 to a pivot, and everything else with it. moved: mm along each axis */
CW_NODISCARD cw_status cli_move_taken(cli_taken_levels *taken, int pivot, double moved[3],
                                      cw_error *err);

/* Frees all but the levels. */
void cli_free_taken(cli_taken_levels *taken);

#endif
