/* The fields and calls that messages of the library name, and the options that stand for them. */
#include "cli/framework/field_names.h"

#include <string.h>

static const struct {
    const char *in_c, *option;
} names[] = {
    {"desc->gaps = CW_GAPS_INTERPOLATE", "--gaps interpolate"},
    {"desc->gaps = CW_GAPS_ALLOW", "--gaps allow"},
    {"desc->tilt = CW_TILT_KEEP", "--tilt keep"},
    {"desc->nodata = CW_NODATA_NONE", "--nodata none"},
    {"desc->nodata", "--nodata"},
    {"desc->skip_damaged", "--skip-damaged"},
    {"desc->claim.rule = CW_CLAIM_OVERRIDE", "--input-override"},
    {"desc->claim.unit", "--input-unit"},
    {"desc->max_bytes", "--memory"},
    {"cw_memory_limit()", "--memory"},
    {"(max_bytes)", "(--memory)"},
    {"desc->max_triangles", "--max-triangles"},
    {"desc->max_voxels", "--max-voxels"},
    {"desc->no_sandbox", "--no-sandbox"},
    {"desc->timeout_s", "--timeout"},
    {"desc->spacing_mm", "--spacing"},
    {"desc->voxel_mm", "--voxel"},
    {"desc->round_labels", "--round"},
    {"desc->series", "--series"},
    {"(desc->array names one)", "(--grid)"},
    {"desc->array", "--array"},
    {"desc->points", "--points"},
    {"desc->raw", "--raw"},
    {"desc->sink", "-o -"},
    {"desc->allow_external", "--allow-external"},
    {"desc->truncated", "'repair --truncated'"},
    {"desc->snap = 0.5", "--snap 0.5"},
    {"sigma_voxels[0]", "the width along x in voxels"},
    {"sigma_voxels[1]", "the width along y in voxels"},
    {"sigma_voxels[2]", "the width along z in voxels"},
    {"radius_voxels[0]", "the radius along x in voxels"},
    {"radius_voxels[1]", "the radius along y in voxels"},
    {"radius_voxels[2]", "the radius along z in voxels"},
    {"inside->level", "the isovalue"},
    {"spacing_mm[0]", "the distance along x"},
    {"spacing_mm[1]", "the distance along y"},
    {"spacing_mm[2]", "the distance along z"},
    {"cw_extract_label_scores()", "'extract --probabilities'"},
    {"cw_self_intersections()", "--deep"},
    {"cw_check_paint()", "--defects"},
    {"cw_mesh_drop_volumes()", "--min-volume"},
    {"cw_mesh_offset()", "'offset'"},
    {"cw_mesh_fill_voids()", "'repair --outer'"},
    {"cw_mesh_repair() with wrap_mm", "'repair --wrap 2%', which needs CGAL,"},
    {"cw_mesh_repair() with outer_only", "'repair --outer'"},
    {"cw_mesh_repair()", "'repair'"},
    {"cw_orient_print()", "'convert --orient-print auto'"},
    {"cw_volume_read() takes one of them", "--batch takes each by itself"},
    {"min_wall_mm", "--wall"},
    {"min_gap_mm", "--gap"},
    {"overhang_deg", "--overhang"},
    {"layer_mm", "--layer"},
    {"plate_mm", "--plate"},
};

const char *cli_name_options(const char *message, char to[CLI_MESSAGE])
{
    size_t used = 0;
    while (*message && used + 1 < CLI_MESSAGE) {
        size_t n = 0;
        while (n < sizeof names / sizeof *names &&
               strncmp(message, names[n].in_c, strlen(names[n].in_c)) != 0)
            n++;
        const char *option = n < sizeof names / sizeof *names ? names[n].option : NULL;
        const size_t length = option ? strlen(option) : 1;
        if (used + length >= CLI_MESSAGE)
            break;
        memcpy(to + used, option ? option : message, length);
        used += length;
        message += option ? strlen(names[n].in_c) : 1;
    }
    to[used] = '\0';
    return to;
}
