/* Reads the pictures on the surfaces of a file. */
#include "cli/looks/looks_input.h"

#include "cli/framework/console.h"
#include "core/base/memory.h"
#include "core/base/status.h"

#include <cubewright/atlas.h>

/* Decodes a picture; NULL in *shown: there is none. One that cannot be decoded is left out, and told. */
static cw_status decode_map(const cli_mesh *file, const cw_texture *texture, const char *what,
                            const cli_input *input, cw_image *map, const cw_image **shown,
                            cw_error *err)
{
    const cw_mesh_read_desc desc = {.max_bytes = cli_memory_limit(input),
                                    .no_sandbox = input->no_sandbox,
                                    .timeout_s = (double)input->timeout_s};
    if (!texture->bytes)
        return CW_OK;
    const cw_status st = cw_texture_decode(texture, &desc, map, err);
    if (st == CW_ERR_UNSUPPORTED) {
        cli_say("%s: looked at without its %s: %s", file->path, what, err->message);
        *err = (cw_error){0};
        return CW_OK;
    }
    *shown = st == CW_OK ? map : NULL;
    return st == CW_OK ? st : cwi_fail_in(err, st, file->path);
}

static cw_status decode_maps(const cli_mesh *file, const cw_part *part, const cli_input *input,
                             cw_image maps[CLI_LOOKS_MAPS], cw_surface_look *surface,
                             cw_error *err)
{
    const cw_textures *t = part->textures;
    cw_status st = CW_OK;
    if (part->mesh->normals)
        st = decode_map(file, &t->normal, "normal map", input, &maps[0], &surface->normal_map,
                        err);
    if (st == CW_OK)
        st = decode_map(file, &t->color, "colour picture", input, &maps[1], &surface->color_map,
                        err);
    if (st == CW_OK)
        st = decode_map(file, &t->occlusion, "occlusion map", input, &maps[2],
                        &surface->occlusion_map, err);
    return st;
}

static bool has_maps(const cw_surface_look *s)
{
    return s->normal_map || s->color_map || s->occlusion_map;
}

/* Adds a part; pictures that an earlier one has, too, are decoded once. */
static cw_status add_surface(const cli_mesh *file, const cw_part *parts, const cli_input *input,
                             cli_looks *looks, cw_error *err)
{
    const size_t n = looks->count++;
    const cw_part *part = &parts[n];
    cw_surface_look *surface = &looks->surfaces[n];
    cw_status st = CW_OK;
    if (part->textures && cw_mesh_attribute_find(part->mesh, CW_TEXTURE_COORDINATES)) {
        size_t first = 0;
        while (first < n &&
               !(parts[first].textures == part->textures && has_maps(&looks->surfaces[first])))
            first++;
        if (first < n)
            *surface = looks->surfaces[first];
        else
            st = decode_maps(file, part, input, looks->maps[n], surface, err);
    }
    surface->mesh = part->mesh;
    if (!part->mesh->normals)
        surface->normal_map = NULL;
    looks->has_maps =
        looks->has_maps || surface->normal_map || surface->color_map || surface->occlusion_map;
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

/* Finds the parts of a textured file: those that were read with it, or read now. */
static cw_status find_parts(const cli_mesh *mesh, bool is_reference, const char *reader,
                            const cli_input *input, cli_looks *looks, const cw_part **parts,
                            size_t *count, cw_error *err)
{
    *parts = mesh->pictured;
    *count = mesh->pictured_count;
    if (*count || !cli_is_textured(mesh))
        return CW_OK;
    cw_status st = cli_read_parts_again(mesh, is_reference, reader, input, &looks->parts, err);
    *parts = looks->parts.parts;
    *count = looks->parts.part_count;
    return st;
}

cw_status cli_looks_find(const cli_mesh *mesh, bool is_reference, const char *reader,
                         const cli_input *input, cli_looks *looks, cw_error *err)
{
    const cw_part whole = {.mesh = &mesh->mesh}, *parts;
    size_t count;
    *looks = (cli_looks){0};
    cw_status st = find_parts(mesh, is_reference, reader, input, looks, &parts, &count, err);
    if (st != CW_OK)
        return st;
    parts = count ? parts : &whole;
    count = count ? count : 1;
    looks->surfaces = cwi_alloc_zeroed(count, sizeof *looks->surfaces);
    looks->maps = cwi_alloc_zeroed(count, sizeof *looks->maps);
    if (!looks->surfaces || !looks->maps)
        return cwi_fail_memory(err);
    for (size_t n = 0; n < count && st == CW_OK; n++)
        st = add_surface(mesh, parts, input, looks, err);
    say_flat(mesh, looks);
    return st;
}

void cli_looks_free(cli_looks *looks)
{
    for (size_t n = 0; n < looks->count; n++)
        for (int k = 0; k < CLI_LOOKS_MAPS; k++)
            cw_image_free(&looks->maps[n][k]);
    cwi_free(looks->maps);
    cwi_free(looks->surfaces);
    cli_free_mesh(&looks->parts);
    *looks = (cli_looks){0};
}
