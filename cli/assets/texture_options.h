/* Texture coordinates and baked maps: options, settings, and facts for people and the report. */
#ifndef CLI_ASSETS_TEXTURE_OPTIONS_H
#define CLI_ASSETS_TEXTURE_OPTIONS_H

#include "cli/framework/json_writer.h"
#include "cli/framework/options.h"

#include <cubewright/atlas.h>
#include <cubewright/bake.h>
#include <cubewright/formats.h>

typedef struct cli_texture_args {
    bool uv;              /* texture coordinates are asked for */
    size_t atlas, margin; /* texels; SIZE_MAX: none was given */
    cli_number density;
    const char *maps; /* names by comma, or "none"; NULL: none was given */
    int map_bits;     /* of a channel: 0: 8, 1: 16 */
    cli_length reach;
} cli_texture_args;

/* Values of a cli_texture_args before any is given. */
#define CLI_TEXTURE_DEFAULTS                                                                   \
    {                                                                                          \
        .atlas = SIZE_MAX, .margin = SIZE_MAX                                                  \
    }

/* Rows of a command whose struct has a cli_texture_args at `row`. */
#define CLI_ATLAS_OPTIONS(row)                                                                 \
    {"atlas",                                                                                  \
     0,                                                                                        \
     CLI_COUNT,                                                                                \
     "N",                                                                                      \
     "Texels along each side of the texture (2048)",                                           \
     row + offsetof(cli_texture_args, atlas)},                                                 \
        {"margin",                                                                             \
         0,                                                                                    \
         CLI_COUNT,                                                                            \
         "N",                                                                                  \
         "Texels that stay free around each chart (2)",                                        \
         row + offsetof(cli_texture_args, margin)},                                            \
        {"map-bits",                                                                           \
         0,                                                                                    \
         CLI_CHOICE,                                                                           \
         "8/16",                                                                               \
         "Bits of a channel in the PNG of a map (8)",                                          \
         row + offsetof(cli_texture_args, map_bits)},                                          \
    {                                                                                          \
        "texel-density", 0, CLI_NUMBER, "D", "Texels for each mm (as many as fit)",            \
            row + offsetof(cli_texture_args, density)                                          \
    }

/* Refuses values out of range, and maps that the output cannot hold.
 * output, format  of the file; format: of --format, or NULL */
CW_NODISCARD cw_status cli_check_texture(const cli_texture_args *args, const char *output,
                                         const char *format, cw_error *err);

/* --crease-angle: "off/DEG". Refuses a value out of range. */
CW_NODISCARD cw_status cli_check_crease(const cli_number *crease, cw_error *err);

/* Returns the angle; 0: normals do not part. */
double cli_crease_degrees(const cli_number *crease);

/* Returns the maps that are asked for, a bit 1u << cw_map for each; cli_check_texture() has checked them. */
unsigned cli_find_maps(const cli_texture_args *args);

/* Return the settings, but for threads and progress. reach_mm: 0: the default */
cw_atlas_desc cli_atlas_desc(const cli_texture_args *args);
cw_bake_desc cli_bake_desc(const cli_texture_args *args, double reach_mm);

/* Baked maps as the bytes of images. Zero it; free it with cli_free_maps(). */
typedef struct cli_maps {
    cw_textures textures;         /* points into bytes */
    uint8_t *bytes[CW_MAP_COUNT]; /* PNG; NULL: was not baked */
    size_t size[CW_MAP_COUNT];
} cli_maps;

/* Encodes those of CW_MAP_COUNT images that have pixels. */
CW_NODISCARD cw_status cli_encode_maps(const cw_image *images, cli_maps *maps, cw_error *err);
void cli_free_maps(cli_maps *maps);

/* Returns the maps that a mesh holds as its textures; NULL: it holds none of them. */
const cw_textures *cli_find_textures(const cli_maps *maps);

/* Writes the maps that the output has no place for beside it, as "head-curvature.png", and says so.
 * output  path of the mesh, as it was written */
CW_NODISCARD cw_status cli_write_maps(const cli_maps *maps, const char *output, bool no_clobber,
                                      cw_error *err);

/* Write the settings into the open object. */
void cli_json_texture(cli_json *j, const cli_texture_args *args);

/* Write the objects "atlas", and `key` of maps. */
void cli_json_atlas(cli_json *j, const cw_atlas_facts *facts);
void cli_json_maps(cli_json *j, const char *key, const cw_bake_facts *facts);

enum { CLI_TEXTURE_TEXT = 320 };

/* Print the facts in words. what: "maps" or "pictures"; source: the surface that was baked, such as a file */
void cli_atlas_text(const cw_atlas_facts *facts, char text[CLI_TEXTURE_TEXT]);
void cli_maps_text(const cw_bake_facts *facts, const char *what, const char *source,
                   char text[CLI_TEXTURE_TEXT]);

/* Returns the share of texels that found nothing, in percent, where it is worth a warning; else 0. */
double cli_find_missed(const cw_bake_facts *facts);

#endif
