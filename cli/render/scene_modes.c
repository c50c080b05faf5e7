/* Which option is for which mode: none is taken that does nothing. */
#include "cli/render/scene_options.h"

#include "core/base/status.h"

#include <string.h>

#define ONE(mode) (1u << CW_MODE_##mode)

enum {
    PLAIN_RAYS = ONE(MIP) | ONE(MINIP) | ONE(AVERAGE) | ONE(LOCAL_MIP),
    RAYS = ONE(COMPOSITE) | PLAIN_RAYS,
    TEXTURES = ONE(TEXTURE) | ONE(SHADED_TEXTURE),
    CPU = ONE(VBUFFER) | ONE(REFERENCE),
    SHADED = ONE(COMPOSITE) | ONE(PROJECTION) | ONE(SPLAT) | ONE(SPLAT_TREE) | TEXTURES | CPU,
    VOLUMES = (1u << CW_MODE_COUNT) - 1 - ONE(MESH),
    ANY = VOLUMES | ONE(MESH),
};

static const struct {
    const char *name;
    unsigned modes;
    bool mesh;    /* it is for whatever has a mesh */
    bool only_gl; /* the CPU draws meshes without */
} rows[] = {
    {"tf", VOLUMES, false, false},
    {"shift", VOLUMES, false, false},
    {"opacity", VOLUMES, false, false},
    {"gradient-opacity", SHADED, false, false},
    {"surface-width", SHADED, false, false},
    {"shadow", ONE(COMPOSITE) | ONE(TEXTURE) | CPU, false, false},
    {"gradient-smoothing", SHADED, false, false},
    {"save-tf", VOLUMES, false, false},
    {"lit", SHADED & ~ONE(SHADED_TEXTURE), false, false},
    {"lambert", SHADED, true, true},
    {"ambient", SHADED, true, true},
    {"diffuse", SHADED, true, true},
    {"specular", SHADED, true, true},
    {"shininess", SHADED, true, true},
    {"light", SHADED, true, true},
    {"depth-cue", ANY & ~PLAIN_RAYS, true, true},
    {"depth-cue-range", ANY & ~PLAIN_RAYS, true, true},
    {"depth-cue-form", ANY & ~PLAIN_RAYS, true, true},
    {"clip-box", ANY, true, true},
    {"clip", ANY, true, true},
    {"cut-away", ANY, true, true},
    {"step-length", RAYS | TEXTURES, false, false},
    {"slices", TEXTURES, false, false},
    {"planes", ONE(SLICES), false, false},
    {"cell-steps", RAYS, false, false},
    {"preintegration", ONE(COMPOSITE) | ONE(PROJECTION) | TEXTURES, false, false},
    {"jitter", ONE(COMPOSITE), false, false},
    {"exact-filter", RAYS | TEXTURES | ONE(SLICES), false, false},
    {"skipping", ONE(COMPOSITE) | TEXTURES, false, false},
    {"stop-opacity", ONE(COMPOSITE) | ONE(PROJECTION) | ONE(VBUFFER), false, false},
    {"threshold", ONE(MINIP) | ONE(LOCAL_MIP), false, false},
    {"minip-inside", ONE(MINIP), false, false},
    {"texture-edge", RAYS | TEXTURES | ONE(SLICES), false, false},
    {"target", TEXTURES, false, false},
    {"colors-first", TEXTURES | ONE(REFERENCE), false, false},
    {"normals", ONE(SHADED_TEXTURE), false, false},
    {"direction-filter", ONE(SHADED_TEXTURE), false, false},
    {"material-table", ONE(SHADED_TEXTURE), false, false},
    {"boundary", ONE(SHADED_TEXTURE), false, false},
    {"pixel-area", ONE(VBUFFER), false, false},
    {"linear-opacity", ONE(PROJECTION), false, false},
    {"tree-error", ONE(SPLAT_TREE) | ONE(PROJECTION), false, false},
    {"splat-budget", ONE(SPLAT_TREE), false, false},
    {"splat-kernel", ONE(SPLAT) | ONE(SPLAT_TREE), false, false},
    {"splat-width", ONE(SPLAT) | ONE(SPLAT_TREE), false, false},
    {"smooth-labels", ONE(MESH), false, false},
    {"tint", 0, true, true},
    {"tint-range", 0, true, true},
    {"wireframe", 0, true, true},
    {"cap", 0, true, true},
    {"color", 0, true, false},
};

enum { ROWS = sizeof rows / sizeof *rows };

/* "composite, mip" */
static void list_modes(unsigned modes, char *text, size_t size)
{
    size_t used = 0;
    *text = '\0';
    for (int m = 0; m < CW_MODE_COUNT && used < size; m++)
        if (modes >> m & 1)
            used += (size_t)snprintf(text + used, size - used, "%s%s", used ? ", " : "",
                                     cw_mode_name((cw_mode)m));
}

static cw_status refuse_option(int row, cw_mode mode, cw_error *err)
{
    char list[256];
    list_modes(rows[row].modes, list, sizeof list);
    if (!rows[row].modes)
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "--%s is for meshes, and there is none: --iso V or --mesh FILE",
                        rows[row].name);
    if (mode == CW_MODE_MESH)
        return cwi_fail(err, CW_ERR_ARGUMENT, "--%s does nothing to a mesh; it is for %s",
                        rows[row].name, rows[row].modes == VOLUMES ? "volumes" : list);
    return cwi_fail(err, CW_ERR_ARGUMENT, "--%s does nothing in the mode %s; it is for %s",
                    rows[row].name, cw_mode_name(mode), list);
}

cw_status cli_check_scene(const cli_command *command, const cli_common *common, cw_mode mode,
                          bool has_mesh, cw_error *err)
{
    for (int n = 0; n < ROWS; n++) {
        const bool is_used = rows[n].modes >> mode & 1 || (rows[n].mesh && has_mesh);
        if (!is_used && cli_is_given(command, common, rows[n].name))
            return refuse_option(n, mode, err);
    }
    return CW_OK;
}

bool cli_setting_fits(const char *name, cw_mode mode, bool has_mesh)
{
    for (int n = 0; n < ROWS; n++)
        if (strcmp(rows[n].name, name) == 0)
            return rows[n].modes >> mode & 1 || (rows[n].mesh && has_mesh);
    return true;
}

bool cli_is_setting(const char *name)
{
    for (int n = 0; n < ROWS; n++)
        if (strcmp(rows[n].name, name) == 0)
            return strcmp(name, "save-tf") != 0;
    return strcmp(name, "mode") == 0 || strcmp(name, "samples") == 0;
}

const char *cli_needs_gl(const cli_command *command, const cli_common *common,
                         const cli_scene *args)
{
    uint8_t rgba[4];
    for (int n = 0; n < ROWS; n++)
        if (rows[n].only_gl && cli_is_given(command, common, rows[n].name))
            return rows[n].name;
    return args->color && cli_parse_color(args->color, rgba) && rgba[3] < 255 ? "color" : NULL;
}
