/* Checks the options of texture coordinates and baked maps, and prints the facts on both. */
#include "cli/assets/texture_options.h"

#include "cli/framework/console.h"
#include "cli/framework/quantity.h"
#include "core/base/status.h"
#include "core/files/atomic_file.h"

#include <stdio.h>
#include <string.h>

/* Texels that find nothing, in percent, from which on it is worth a warning. */
static const double MANY_MISSED = 1;

/* --- as typed ------------------------------------------------------------------------------- */

/* Returns the bit of a name with `length` characters; 0: it is none. */
static unsigned find_map(const char *name, size_t length)
{
    for (int m = 0; m < CW_MAP_COUNT; m++) {
        const char *known = cw_map_name((cw_map)m);
        if (strlen(known) == length && memcmp(known, name, length) == 0)
            return 1u << m;
    }
    return 0;
}

/* Reads the names of maps. Returns false at one that is none, which *bad then points to. */
static bool parse_maps(const char *text, unsigned *maps, const char **bad)
{
    *maps = 0;
    if (!text || strcmp(text, "none") == 0)
        return true;
    for (const char *at = text;; at++) {
        const size_t length = strcspn(at, ",");
        const unsigned map = find_map(at, length);
        *bad = at;
        if (!map)
            return false;
        *maps |= map;
        at += length;
        if (!*at)
            return true;
    }
}

cw_status cli_check_crease(const cli_number *crease, cw_error *err)
{
    if (!crease->given || crease->is_word || (crease->value > 0 && crease->value <= 180))
        return CW_OK;
    return cwi_fail(err, CW_ERR_ARGUMENT,
                    "--crease-angle %g: expected more than 0, up to 180, or off",
                    crease->value);
}

double cli_crease_degrees(const cli_number *crease)
{
    return crease->is_word ? 0 : crease->value;
}

unsigned cli_find_maps(const cli_texture_args *args)
{
    unsigned maps;
    const char *bad;
    return parse_maps(args->maps, &maps, &bad) ? maps : 0;
}

/* Returns the place of a map in the textures of a mesh; NULL: it has none. */
static cw_texture *find_texture(cw_textures *textures, int map)
{
    switch (map) {
    case CW_MAP_NORMALS:
        return &textures->normal;
    case CW_MAP_OCCLUSION:
        return &textures->occlusion;
    case CW_MAP_COLORS:
        return &textures->color;
    default:
        return NULL;
    }
}

/* Returns those of some maps that a file holds. */
static unsigned find_held(unsigned maps)
{
    cw_textures textures = {0};
    unsigned held = 0;
    for (int m = 0; m < CW_MAP_COUNT; m++)
        held |= find_texture(&textures, m) ? maps & 1u << m : 0;
    return held;
}

static cw_status check_maps(const cli_texture_args *args, const char *output,
                            const char *format, cw_error *err)
{
    const cw_format *f = cw_mesh_format(output, format);
    const char *bad;
    unsigned maps;
    char names[256] = "none";
    for (int m = 0; m < CW_MAP_COUNT; m++) {
        const size_t used = strlen(names);
        snprintf(names + used, sizeof names - used, ", %s", cw_map_name((cw_map)m));
    }
    if (!parse_maps(args->maps, &maps, &bad))
        return cwi_fail(err, CW_ERR_ARGUMENT, "--maps %s: '%.*s' is no map: expected %s",
                        args->maps, (int)strcspn(bad, ","), bad, names);
    if (find_held(maps) && f && !(f->keeps & CW_KEEPS_PICTURES))
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "%s holds no maps; .glb, .gltf and .obj do, and --maps none makes none",
                        f->name);
    return CW_OK;
}

static bool is_given(size_t texels)
{
    return texels != SIZE_MAX;
}

static uint32_t texels_of(size_t texels)
{
    return is_given(texels) ? (uint32_t)texels : 0;
}

cw_status cli_check_texture(const cli_texture_args *args, const char *output,
                            const char *format, cw_error *err)
{
    if (is_given(args->atlas) && (args->atlas < 64 || args->atlas > CW_ATLAS_MAX_SIZE))
        return cwi_fail(err, CW_ERR_ARGUMENT, "--atlas %zu: expected 64 to %u", args->atlas,
                        CW_ATLAS_MAX_SIZE);
    if (is_given(args->margin) && (args->margin < 1 || args->margin > 64))
        return cwi_fail(err, CW_ERR_ARGUMENT, "--margin %zu: expected 1 to 64", args->margin);
    if (args->density.given && !(args->density.value > 0))
        return cwi_fail(err, CW_ERR_ARGUMENT, "--texel-density %g: expected more than 0",
                        args->density.value);
    return check_maps(args, output, format, err);
}

cw_atlas_desc cli_atlas_desc(const cli_texture_args *args)
{
    return (cw_atlas_desc){.size = texels_of(args->atlas),
                           .margin = texels_of(args->margin),
                           .texels_per_mm = args->density.given ? args->density.value : 0};
}

cw_bake_desc cli_bake_desc(const cli_texture_args *args, double reach_mm)
{
    return (cw_bake_desc){.size = texels_of(args->atlas),
                          .margin = texels_of(args->margin),
                          .reach_mm = reach_mm,
                          .maps = cli_find_maps(args),
                          .deep = args->map_bits};
}

/* --- images --------------------------------------------------------------------------------- */

cw_status cli_encode_maps(const cw_image *images, cli_maps *maps, cw_error *err)
{
    cw_status st = CW_OK;
    for (int m = 0; m < CW_MAP_COUNT && st == CW_OK; m++) {
        cw_texture *texture = find_texture(&maps->textures, m);
        if (!images[m].pixels)
            continue;
        st = cw_image_encode(&images[m], m == CW_MAP_COLORS, &maps->bytes[m], &maps->size[m],
                             err);
        if (texture)
            *texture = (cw_texture){.bytes = maps->bytes[m], .size = maps->size[m]};
    }
    return st;
}

const cw_textures *cli_find_textures(const cli_maps *maps)
{
    for (int m = 0; m < CW_MAP_COUNT; m++)
        if (maps->bytes[m] && find_held(1u << m))
            return &maps->textures;
    return NULL;
}

static cw_status write_map(const char *path, const uint8_t *bytes, size_t size, bool no_clobber,
                           cw_error *err)
{
    cwi_outfile *file = NULL;
    cw_status st = cwi_outfile_open(&file, path, no_clobber, err);
    if (st == CW_OK)
        st = cwi_outfile_write(file, bytes, size, err);
    if (st == CW_OK)
        st = cwi_outfile_commit(&file, err);
    cwi_outfile_abort(&file);
    return st == CW_OK ? CW_OK : cwi_fail_in(err, st, path);
}

cw_status cli_write_maps(const cli_maps *maps, const char *output, bool no_clobber,
                         cw_error *err)
{
    const char *slash = strrchr(output, '/'), *dot = strrchr(slash ? slash : output, '.');
    const int stem = (int)(dot ? (size_t)(dot - output) : strlen(output));
    cw_status st = CW_OK;
    for (int m = 0; m < CW_MAP_COUNT && st == CW_OK; m++) {
        char path[4096];
        if (!maps->bytes[m] || find_held(1u << m))
            continue;
        if (snprintf(path, sizeof path, "%.*s-%s.png", stem, output, cw_map_name((cw_map)m)) >=
            (int)sizeof path)
            return cwi_fail(err, CW_ERR_ARGUMENT, "%s: the name of its map is too long",
                            output);
        st = write_map(path, maps->bytes[m], maps->size[m], no_clobber, err);
        if (st == CW_OK)
            cli_say("%s: the map of %s, %s", path, cw_map_name((cw_map)m),
                    cli_bytes((double)maps->size[m]));
    }
    return st;
}

void cli_free_maps(cli_maps *maps)
{
    for (int m = 0; m < CW_MAP_COUNT; m++)
        cw_bytes_free(maps->bytes[m]);
    *maps = (cli_maps){0};
}

/* --- facts ---------------------------------------------------------------------------------- */

void cli_json_texture(cli_json *j, const cli_texture_args *args)
{
    if (is_given(args->atlas))
        cli_json_count(j, "atlas", args->atlas);
    if (is_given(args->margin))
        cli_json_count(j, "margin", args->margin);
    if (args->density.given)
        cli_json_number(j, "texels_per_mm", args->density.value);
    if (args->maps)
        cli_json_text(j, "maps", args->maps);
    if (args->map_bits)
        cli_json_count(j, "map_bits", 16);
}

void cli_json_atlas(cli_json *j, const cw_atlas_facts *f)
{
    cli_json_open(j, "atlas", '{');
    cli_json_count(j, "size", f->size);
    cli_json_count(j, "margin", f->margin);
    cli_json_count(j, "charts", f->charts);
    cli_json_count(j, "seams", f->seams);
    cli_json_count(j, "vertices", f->vertices);
    cli_json_number(j, "texels_per_mm", f->texels_per_mm);
    cli_json_number(j, "stretch", f->stretch);
    cli_json_number(j, "coverage", f->coverage);
    cli_json_count(j, "flipped", f->flipped);
    cli_json_close(j, '}');
}

void cli_json_maps(cli_json *j, const char *key, const cw_bake_facts *f)
{
    cli_json_open(j, key, '{');
    cli_json_number(j, "reach_mm", f->reach_mm);
    if (f->occlusion_mm > 0) {
        cli_json_number(j, "occlusion_mm", f->occlusion_mm);
        cli_json_number(j, "thickness_mm", f->thickness_mm);
    }
    if (f->curvature_max > 0)
        cli_json_number(j, "curvature_max", f->curvature_max);
    cli_json_count(j, "texels", f->texels);
    cli_json_count(j, "missed", f->missed);
    cli_json_number(j, "max_mm", f->max_mm);
    cli_json_number(j, "mean_mm", f->mean_mm);
    if (f->occlusion_mm > 0) /* maps, no pictures */
        cli_json_number(j, "mean_deg", f->mean_deg);
    cli_json_close(j, '}');
}

void cli_atlas_text(const cw_atlas_facts *f, char text[CLI_TEXTURE_TEXT])
{
    snprintf(
        text, CLI_TEXTURE_TEXT,
        "%s chart%s, %s edges of seams, %s vertices with one coordinate each; %u x %u texels, "
        "%.0f %% covered, %.3g for a mm; stretch %.3f",
        cli_count(f->charts), f->charts == 1 ? "" : "s", cli_count(f->seams),
        cli_count(f->vertices), f->size, f->size, 100 * f->coverage, f->texels_per_mm,
        f->stretch);
}

static double missed_percent(const cw_bake_facts *f)
{
    return f->texels ? 100 * (double)f->missed / (double)f->texels : 0;
}

void cli_maps_text(const cw_bake_facts *f, const char *what, const char *source,
                   char text[CLI_TEXTURE_TEXT])
{
    snprintf(text, CLI_TEXTURE_TEXT,
             "%s of %s, at most %.3g mm away, mean %.2g mm; %.2g %% of the texels missed", what,
             source, f->max_mm, f->mean_mm, missed_percent(f));
}

double cli_find_missed(const cw_bake_facts *f)
{
    const double percent = missed_percent(f);
    return percent > MANY_MISSED ? percent : 0;
}
