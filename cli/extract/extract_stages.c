/* Which stages of the pipeline the options ask for, and what these exclude. */
#include "cli/extract/extract_run.h"
#include "cli/framework/commands.h"
#include "cli/framework/option_rules.h"
#include "cli/inputs/volume_prepare.h"
#include "core/base/status.h"

#include <stdio.h>
#include <string.h>

/* Options that are no stages, and need the whole surface or all voxels. */
static const char UNSTREAMED[] =
    "max-error profile=print snap animate prove-crop pivot orient-print component=mag";

bool cli_extract_is_simplified(const cli_extract_args *args)
{
    return args->simplify.error.given || args->simplify.triangles || args->pixel.pixels.given ||
           args->pixel.most.given;
}

/* Returns the stages that options of their names ask for, as cw_pipeline_stages(). */
static unsigned find_stages(const cli_extract_args *args)
{
    char name[CLI_STAGE_BYTES];
    unsigned stages = 0;
    for (int s = 0; s < CW_STAGE_COUNT; s++) {
        cli_name_stage((cw_stage)s, name);
        if (s != CW_STAGE_NORMALS && s != CW_STAGE_CHECK &&
            cli_find_given(&cli_extract, args, name + 2))
            stages |= 1u << s;
    }
    return cli_extract_is_simplified(args) ? stages | 1u << CW_STAGE_SIMPLIFY : stages;
}

/* Names the options of stages that exclude each other, or one twice that the source excludes. Returns
 * false if there are none. */
static bool name_excluded(const cli_extract_args *args, cw_surface_source source,
                          char first_name[CLI_STAGE_BYTES], char second_name[CLI_STAGE_BYTES])
{
    cw_stage first, second;
    if (cw_pipeline_check(source, find_stages(args), &first, &second, NULL) == CW_OK)
        return false;
    cli_name_stage(first, first_name);
    cli_name_stage(second, second_name);
    return true;
}

/* Returns what a source excludes: "--largest", or "--min-volume beside --simplify". NULL: nothing */
static const char *find_excluded(const cli_extract_args *args, cw_surface_source source)
{
    static char text[2 * CLI_STAGE_BYTES + 16];
    char first[CLI_STAGE_BYTES], second[CLI_STAGE_BYTES];
    if (!name_excluded(args, source, first, second))
        return NULL;
    snprintf(text, sizeof text, strcmp(first, second) == 0 ? "%s" : "%s beside %s", first,
             second);
    return text;
}

cw_status cli_check_stages(const cli_extract_args *args, cw_surface_source source,
                           cw_error *err)
{
    char first[CLI_STAGE_BYTES], second[CLI_STAGE_BYTES];
    if (!name_excluded(args, source, first, second))
        return CW_OK;
    return cwi_fail(err, CW_ERR_ARGUMENT, "%s cannot be combined with %s",
                    strcmp(first, second) == 0 ? "--labels" : first, second);
}

const char *cli_find_unstreamed(const cli_extract_args *args, cw_surface_source source)
{
    const char *option = find_excluded(args, source);
    if (!option)
        option = cli_find_given(&cli_extract, args, UNSTREAMED);
    if (!option && args->compress.kind && !cli_extract_is_simplified(args))
        option = "--compress";
    return option ? option : cli_find_unstreamed_preparation(&args->input);
}
