/* The table of all commands, in the order of the help. */
#include "cli/command_table.h"

#include "cli/check/check_run.h"
#include "cli/commands/command_rows.h"
#include "cli/cut/cut_facts.h"
#include "cli/extract/extract_run.h"
#include "cli/extract/part_join.h"
#include "cli/help/help_search.h"
#include "cli/info/cmd_info.h"
#include "cli/render/render_run.h"
#include "cli/report/report_run.h"
#include "cli/voxels/cmd_voxelize.h"
#include "cli/window/panels.h"

const cli_command *const cli_command_table[] = {
    &cli_extract, &cli_join,     &cli_simplify, &cli_smooth, &cli_remesh,  &cli_boolean,
    &cli_cut,     &cli_engrave,  &cli_repair,   &cli_uv,     &cli_convert, &cli_hollow,
    &cli_offset,  &cli_voxelize, &cli_check,    &cli_info,   &cli_render,  &cli_report_command,
    &cli_view,    &cli_make,     &cli_formats,  &cli_help,   &cli_version, NULL};
