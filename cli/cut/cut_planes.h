/* The planes of the command cut: how they are typed. */
#ifndef CLI_CUT_CUT_PLANES_H
#define CLI_CUT_CUT_PLANES_H

#include "cli/inputs/filter_options.h"

enum { CLI_MAX_PLANES = 32 };

/* Planes by comma: z=5mm,x=50% or 0,0,5:0,0.1,1 */
typedef struct cli_planes {
    size_t count;
    cli_plane plane[CLI_MAX_PLANES];
} cli_planes;

extern const cli_kind cli_kind_planes;

#endif
