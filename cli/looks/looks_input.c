/* Reads the pictures on the surfaces of a file. */
#include "cli/looks/looks_input.h"

#include "cli/framework/console.h"
#include "core/base/memory.h"
#include "core/base/status.h"

#include <cubewright/atlas.h>

#include <string.h>

static bool format_keeps_pictures(const char *name)
{
    size_t count;
    const cw_format *formats = cw_formats(&count);
    for (size_t n = 0; n < count; n++)
        if (strcmp(formats[n].name, name) == 0)
            return formats[n].keeps & CW_KEEPS_PICTURES;
    return false;
}

static bool has_pictures(const cli_mesh *parts)
{
    for (size_t n = 0; n < parts->part_count; n++)
        if (parts->parts[n].textures)
            return true;
    return false;
}

/* Decodes a normal map. One that cannot be decoded is left out, and told. */
static cw_status decode_map(const cli_mesh *file, const cw_part *part, const cli_input *input,
                            cw_image *map, cw_error *err)
{
    const cw_mesh_read_desc desc = {.max_bytes = cli_memory_limit(input),
                                    .no_sandbox = input->no_sandbox,
                                    .timeout_s = (double)input->timeout_s};
    const cw_status st = cw_texture_decode(&part->textures->normal, &desc, map, err);
    if (st == CW_ERR_UNSUPPORTED) {
        cli_say("%s: looked at without its normal map: %s", file->path, err->message);
        *err = (cw_error){0};
        return CW_OK;
    }
    return st == CW_OK ? st : cwi_fail_in(err, st, file->path);
}

static cw_status add_surface(const cli_mesh *file, const cw_part *part, const cli_input *input,
                             cli_looks *looks, cw_error *err)
{
    cw_surface_look *surface = &looks->surfaces[looks->count];
    cw_image *map = &looks->maps[looks->count++];
    surface->mesh = part->mesh;
    if (!part->textures || !part->textures->normal.bytes)
        return CW_OK;
    if (!part->mesh->normals || !cw_mesh_attribute_find(part->mesh, CW_TEXTURE_COORDINATES)) {
        cli_say("%s: looked at without its normal map: there are no %s", file->path,
                part->mesh->normals ? "texture coordinates" : "normals");
        return CW_OK;
    }
    cw_status st = decode_map(file, part, input, map, err);
    if (st == CW_OK && map->pixels) {
        surface->normal_map = map;
        looks->has_maps = true;
    }
    return st;
}

static void say_flat(const cli_mesh *file, const cli_looks *looks)
{
    for (size_t n = 0; n < looks->count; n++)
        if (!looks->surfaces[n].mesh->normals) {
            cli_say("%s: no normals: looked at flat, as viewers show it", file->path);
            return;
        }
}

cw_status cli_looks_find(const cli_mesh *mesh, bool is_reference, const char *reader,
                         const cli_input *input, cli_looks *looks, cw_error *err)
{
    const cw_part whole = {.mesh = &mesh->mesh};
    *looks = (cli_looks){0};
    cw_status st = CW_OK;
    if (format_keeps_pictures(mesh->file.format))
        st = cli_read_parts_again(mesh, is_reference, reader, input, &looks->parts, err);
    if (st == CW_OK && looks->parts.parts && !has_pictures(&looks->parts))
        st = cli_glb_maps_read(&looks->parts, &looks->glb, err);
    if (st == CW_OK && !has_pictures(&looks->parts))
        cli_free_mesh(&looks->parts);
    const cw_part *parts = looks->parts.parts ? looks->parts.parts : &whole;
    const size_t count = looks->parts.parts ? looks->parts.part_count : 1;
    if (st != CW_OK)
        return st;
    looks->surfaces = cwi_alloc_zeroed(count, sizeof *looks->surfaces);
    looks->maps = cwi_alloc_zeroed(count, sizeof *looks->maps);
    if (!looks->surfaces || !looks->maps)
        return cwi_fail_memory(err);
    for (size_t n = 0; n < count && st == CW_OK; n++)
        st = add_surface(mesh, &parts[n], input, looks, err);
    say_flat(mesh, looks);
    return st;
}

void cli_looks_free(cli_looks *looks)
{
    for (size_t n = 0; n < looks->count; n++)
        cw_image_free(&looks->maps[n]);
    cwi_free(looks->maps);
    cwi_free(looks->surfaces);
    cli_free_mesh(&looks->parts);
    cli_glb_maps_free(&looks->glb);
    *looks = (cli_looks){0};
}
