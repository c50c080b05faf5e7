/* Fills in the settings of the profiles game, web and mobile. */
#include "cli/assets/asset_profile.h"

#include <math.h>

static const double ROWS = 1080, VIEW_DEG = 60;

const cli_asset *cli_find_asset(int n)
{
    static const cli_asset assets[] = {
        {"game", CW_PROFILE_GAME, CW_COMPRESS_NONE},
        {"web", CW_PROFILE_WEB, CW_COMPRESS_DRACO},
        {"mobile", CW_PROFILE_MOBILE, CW_COMPRESS_MESHOPT},
    };
    return n >= 0 && n < (int)(sizeof assets / sizeof *assets) ? &assets[n] : NULL;
}

void cli_fill_levels(const cli_asset *asset, cli_counts *lod)
{
    const cw_budget *budget = cw_check_budget(asset->profile);
    lod->count = 0;
    while (lod->count < CW_BUDGET_LEVELS && budget->triangles[lod->count]) {
        lod->n[lod->count] = budget->triangles[lod->count];
        lod->count++;
    }
}

void cli_fill_texture(const cli_asset *asset, cli_texture_args *texture, cli_length *handles)
{
    texture->uv = true;
    if (texture->atlas == SIZE_MAX)
        texture->atlas = cw_check_budget(asset->profile)->texture_size;
    if (!texture->maps)
        texture->maps = "normals";
    if (!handles->given)
        *handles = (cli_length){.given = true, .is_word = true};
}

double cli_find_switch_m(double error_mm)
{
    const double half = VIEW_DEG / 2 * acos(-1) / 180;
    return error_mm / 1000 * ROWS / (2 * tan(half));
}
