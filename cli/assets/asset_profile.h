/* The profiles of meshes that are drawn: --profile game, web and mobile fill in what was not given. */
#ifndef CLI_ASSETS_ASSET_PROFILE_H
#define CLI_ASSETS_ASSET_PROFILE_H

#include "cli/assets/texture_options.h"

#include <cubewright/check.h>

/* The choices of an option --profile behind its own: "none/print/" CLI_ASSET_CHOICES */
#define CLI_ASSET_CHOICES "game/web/mobile"

/* A profile: its name, its budget, and how its file is compressed. */
typedef struct cli_asset {
    const char *name;
    cw_profile profile;
    cw_compression compression;
} cli_asset;

/* Returns the n-th profile of CLI_ASSET_CHOICES; NULL: there is none. n: from 0, or less */
const cli_asset *cli_find_asset(int n);

/* Sets the levels of detail. */
void cli_fill_levels(const cli_asset *asset, cli_counts *lod);

/* Sets the atlas, the maps and the closing of handles that were not given. */
void cli_fill_texture(const cli_asset *asset, cli_texture_args *texture, cli_length *handles);

/* Returns the distance in metres from which on an error is less than a pixel of 1080 rows over 60
 * degrees. */
double cli_find_switch_m(double error_mm);

#endif
