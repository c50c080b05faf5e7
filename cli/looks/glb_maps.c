/* Finds the normal map and the texture coordinates in a binary glTF file. Whatever is not as expected leaves the
 * parts without: the mesh itself was read before, and checked. */
#include "cli/looks/glb_maps.h"

#include "core/base/memory.h"
#include "core/base/status.h"

#include <cubewright/atlas.h>

#include <jansson.h>
#include <stdio.h>
#include <string.h>

enum { HEADER = 12, CHUNK = 8, FLOAT = 5126, MAX_JSON = 64 << 20 };

/* A file in memory: its JSON, and the bytes of its buffer. */
typedef struct glb {
    json_t *json;
    const uint8_t *bytes;
    size_t size;
} glb;

static size_t number_at(const uint8_t *from)
{
    return from[0] | (size_t)from[1] << 8 | (size_t)from[2] << 16 | (size_t)from[3] << 24;
}

static cw_status load_file(const char *path, uint8_t **bytes, size_t *size, cw_error *err)
{
    FILE *in = fopen(path, "rb");
    size_t capacity = 1 << 16, got;
    *size = 0;
    if (!in)
        return cwi_fail(err, CW_ERR_IO, "%s: cannot be opened", path);
    cw_status st = (*bytes = cwi_alloc_array(capacity, 1)) ? CW_OK : cwi_fail_memory(err);
    while (st == CW_OK && (got = fread(*bytes + *size, 1, capacity - *size, in)) > 0) {
        *size += got;
        uint8_t *more = *size < capacity ? *bytes : cwi_realloc_array(*bytes, capacity *= 2, 1);
        st = more ? CW_OK : cwi_fail_memory(err);
        *bytes = more ? more : *bytes;
    }
    if (st == CW_OK && ferror(in))
        st = cwi_fail(err, CW_ERR_IO, "%s: cannot be read", path);
    fclose(in);
    return st;
}

/* Opens the chunks; false where they are not those of a GLB. */
static bool open_chunks(const uint8_t *file, size_t size, glb *g)
{
    const size_t first = HEADER + CHUNK;
    if (size < first + CHUNK || memcmp(file, "glTF", 4) != 0)
        return false;
    const size_t json = number_at(file + HEADER);
    if (json > MAX_JSON || json > size - first - CHUNK)
        return false;
    g->size = number_at(file + first + json);
    g->bytes = file + first + json + CHUNK;
    if (g->size > size - first - json - CHUNK)
        return false;
    g->json = json_loadb((const char *)file + first, json, JSON_REJECT_DUPLICATES, NULL);
    return g->json;
}

/* Returns element `index` of a list of the document; NULL: there is none. */
static json_t *element(const glb *g, const char *list, const json_t *index)
{
    const json_int_t n = json_is_integer(index) ? json_integer_value(index) : -1;
    return n >= 0 ? json_array_get(json_object_get(g->json, list), (size_t)n) : NULL;
}

static size_t size_of(const json_t *object, const char *key)
{
    const json_int_t n = json_integer_value(json_object_get(object, key));
    return n > 0 ? (size_t)n : 0;
}

/* Returns the bytes of a buffer view of the file's own buffer; NULL: they are not there. */
static const uint8_t *view_bytes(const glb *g, const json_t *index, size_t *size)
{
    const json_t *view = element(g, "bufferViews", index);
    const size_t offset = size_of(view, "byteOffset");
    *size = size_of(view, "byteLength");
    const bool is_plain = view && !size_of(view, "buffer") &&
                          !json_object_get(view, "extensions") &&
                          size_of(view, "byteStride") <= 2 * sizeof(float);
    return is_plain && offset <= g->size && *size <= g->size - offset ? g->bytes + offset
                                                                      : NULL;
}

/* Returns the texture coordinates of a primitive; NULL: it has none, or not `count`. */
static const uint8_t *coordinates_of(const glb *g, const json_t *primitive, size_t count)
{
    size_t size;
    const json_t *attributes = json_object_get(primitive, "attributes"),
                 *accessor = element(g, "accessors", json_object_get(attributes, "TEXCOORD_0"));
    const uint8_t *bytes = view_bytes(g, json_object_get(accessor, "bufferView"), &size);
    const size_t offset = size_of(accessor, "byteOffset"), need = count * 2 * sizeof(float);
    const bool fits = bytes && size_of(accessor, "componentType") == FLOAT &&
                      size_of(accessor, "count") == count &&
                      !json_object_get(accessor, "sparse") && offset <= size &&
                      need <= size - offset;
    return fits ? bytes + offset : NULL;
}

static cw_status give_coordinates(cw_mesh *mesh, const uint8_t *from, cw_error *err)
{
    const cw_attribute uv = {.name = CW_TEXTURE_COORDINATES,
                             .on = CW_ON_VERTICES,
                             .type = CW_F32,
                             .components = 2,
                             .interpolation = CW_INTERPOLATE_LINEAR};
    cw_attribute *added;
    if (cw_mesh_attribute_find(mesh, CW_TEXTURE_COORDINATES))
        return CW_OK;
    cw_status st = cw_mesh_attribute_add(mesh, &uv, &added, err);
    if (st == CW_OK)
        memcpy(added->data, from, mesh->vertex_count * 2 * sizeof(float));
    return st;
}

/* Returns the bytes of the normal map of a primitive's material. */
static const uint8_t *normal_map_of(const glb *g, const json_t *primitive, size_t *size)
{
    const json_t *material = element(g, "materials", json_object_get(primitive, "material")),
                 *normal = json_object_get(material, "normalTexture"),
                 *texture = element(g, "textures", json_object_get(normal, "index")),
                 *image = element(g, "images", json_object_get(texture, "source"));
    return view_bytes(g, json_object_get(image, "bufferView"), size);
}

/* Goes through the nodes, whose order is that of the parts. */
static cw_status match_parts(const glb *g, cli_mesh *parts, cli_glb_maps *maps, cw_error *err)
{
    size_t n = 0, at;
    json_t *node;
    cw_status st = CW_OK;
    json_array_foreach(json_object_get(g->json, "nodes"), at, node)
    {
        const json_t *index = json_object_get(node, "mesh"),
                     *primitives = json_object_get(element(g, "meshes", index), "primitives"),
                     *primitive = json_array_get(primitives, 0);
        if (!index)
            continue;
        if (n == parts->part_count || json_array_size(primitives) != 1)
            return st;
        cw_part *part = &parts->parts[n++];
        cw_mesh *mesh = (cw_mesh *)(uintptr_t)part->mesh; /* the part owns it */
        size_t size;
        const uint8_t *uv = coordinates_of(g, primitive, mesh->vertex_count),
                      *map = normal_map_of(g, primitive, &size);
        if (!uv || !map || (maps->textures.normal.bytes && maps->textures.normal.bytes != map))
            continue;
        st = give_coordinates(mesh, uv, err);
        if (st != CW_OK)
            return st;
        maps->textures.normal = (cw_texture){.bytes = map, .size = size};
        part->textures = &maps->textures;
    }
    return st;
}

cw_status cli_glb_maps_read(cli_mesh *parts, cli_glb_maps *maps, cw_error *err)
{
    size_t size = 0;
    glb g = {0};
    *maps = (cli_glb_maps){0};
    if (strcmp(parts->file.format, "glb") != 0)
        return CW_OK;
    cw_status st = load_file(parts->path, &maps->file, &size, err);
    if (st == CW_OK && open_chunks(maps->file, size, &g))
        st = match_parts(&g, parts, maps, err);
    json_decref(g.json);
    return st;
}

void cli_glb_maps_free(cli_glb_maps *maps)
{
    cwi_free(maps->file);
    *maps = (cli_glb_maps){0};
}
