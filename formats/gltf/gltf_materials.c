/* Reads the pictures of glTF's materials: which they are, how they lie on the surface, and their bytes. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "formats/gltf/gltf_reader.h"
#include "formats/mesh/picture_store.h"

#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

enum { MAX_NAME = 64, REPEAT = 10497, CLAMP = 33071 };

/* Bytes of the JSON beyond which materials are not looked at: its strings are pictures then. */
static const size_t MAX_JSON = (size_t)1 << 30;

/* A material's pictures while they are collected. */
typedef struct material_reading {
    cwi_gltf_reader *r;
    const json_t *root;
    cwi_gltf_look *look;
    bool has_transform; /* some picture's was taken */
} material_reading;

static const json_t *find(const json_t *object, const char *first, const char *second)
{
    const json_t *found = json_object_get(object, first);
    return second ? json_object_get(found, second) : found;
}

static double number_or(const json_t *value, double otherwise)
{
    const double number = json_is_number(value) ? json_number_value(value) : otherwise;
    return isfinite(number) ? number : otherwise;
}

static const json_t *element(const json_t *root, const char *list, const json_t *index)
{
    return json_is_integer(index) && json_integer_value(index) >= 0
               ? json_array_get(json_object_get(root, list), (size_t)json_integer_value(index))
               : NULL;
}

/* --- bytes -------------------------------------------------------------------------------- */

/* Copies the bytes of a picture that lies in a view. */
static cw_status load_view(cwi_gltf_reader *r, int64_t view, const char *name,
                           cw_texture *picture, cw_error *err)
{
    unsigned char *bytes = NULL;
    if (view < 0 || (uint64_t)view >= r->scene.view_count)
        return cwi_fail(err, CW_ERR_FORMAT, "a picture names bufferView %lld; there are %zu",
                        (long long)view, r->scene.view_count);
    const cwi_gltf_view *v = &r->scene.views[view];
    if (v->bytes == 0 || v->packed_buffer >= 0) {
        r->in->pictures.is_missing = true;
        return CW_OK;
    }
    cw_status st = cwi_gltf_load(&r->bytes, &r->scene, (uint64_t)v->buffer, v->offset, v->bytes,
                                 &bytes, err);
    return st == CW_OK ? cwi_picture_add(r->in, name, bytes, (size_t)v->bytes, picture, err)
                       : st;
}

/* Loads the picture of an image, once for all materials. */
static cw_status load_image(cwi_gltf_reader *r, const json_t *image, const json_t *index,
                            cw_texture *picture, cw_error *err)
{
    const json_t *uri = json_object_get(image, "uri"),
                 *view = json_object_get(image, "bufferView");
    char name[MAX_NAME], file[1024];
    unsigned char *bytes = NULL;
    size_t size = 0;
    snprintf(name, sizeof name, "images[%lld]", (long long)json_integer_value(index));
    const cw_texture *known = cwi_picture_find(&r->in->pictures, name);
    if (known) {
        *picture = *known;
        return CW_OK;
    }
    if (json_is_integer(view))
        return load_view(r, json_integer_value(view), name, picture, err);
    if (!json_is_string(uri)) {
        r->in->pictures.is_missing = true;
        return CW_OK;
    }
    if (!cwi_gltf_is_data(json_string_value(uri))) {
        cw_error why = {0};
        if (cwi_gltf_decode_name(json_string_value(uri), file, &why) == CW_OK)
            return cwi_picture_read(r->in, file, picture, err);
        r->in->pictures.is_missing = true;
        return CW_OK;
    }
    cw_status st = cwi_gltf_load_data(json_string_value(uri), &bytes, &size, err);
    return st == CW_OK ? cwi_picture_add(r->in, name, bytes, size, picture, err) : st;
}

/* --- how they lie -------------------------------------------------------------------------- */

/* Reads KHR_texture_transform: scale, then turn, then shift. */
static void read_transform(const json_t *transform, double m[2][3])
{
    const json_t *offset = json_object_get(transform, "offset"),
                 *scale = json_object_get(transform, "scale");
    const double angle = number_or(json_object_get(transform, "rotation"), 0),
                 u = number_or(json_array_get(scale, 0), 1),
                 v = number_or(json_array_get(scale, 1), 1);
    m[0][0] = cos(angle) * u;
    m[0][1] = sin(angle) * v;
    m[0][2] = number_or(json_array_get(offset, 0), 0);
    m[1][0] = -sin(angle) * u;
    m[1][1] = cos(angle) * v;
    m[1][2] = number_or(json_array_get(offset, 1), 0);
}

/* Reads how a picture is placed. All pictures of a material should be placed alike; the first one counts. */
static void take_transform(material_reading *m, const json_t *info)
{
    static const double identity[2][3] = {{1, 0, 0}, {0, 1, 0}};
    const json_t *transform = find(info, "extensions", "KHR_texture_transform");
    double here[2][3];
    memcpy(here, identity, sizeof here);
    if (transform)
        read_transform(transform, here);
    if (m->has_transform && memcmp(here, m->look->transform, sizeof here) != 0)
        m->r->not_applied |= CWI_GLTF_OTHER_TRANSFORMS;
    if (!m->has_transform) {
        memcpy(m->look->transform, here, sizeof here);
        m->look->moves = memcmp(here, identity, sizeof here) != 0;
    }
    m->has_transform = true;
}

/* Returns the number of a picture's set of texture coordinates. */
static int64_t set_of(const json_t *info)
{
    const json_t *other = json_object_get(find(info, "extensions", "KHR_texture_transform"),
                                          "texCoord"),
                 *set = other ? other : json_object_get(info, "texCoord");
    return json_is_integer(set) ? json_integer_value(set) : 0;
}

static void take_sampler(material_reading *m, const json_t *texture, cw_textures *set)
{
    const json_t *sampler = element(m->root, "samplers", json_object_get(texture, "sampler"));
    const int s = (int)number_or(json_object_get(sampler, "wrapS"), REPEAT),
              t = (int)number_or(json_object_get(sampler, "wrapT"), REPEAT);
    set->repeats = set->repeats || s != CLAMP || t != CLAMP;
    if ((s != REPEAT && s != CLAMP) || s != t)
        m->r->not_applied |= CWI_GLTF_OTHER_WRAPS;
}

/* Reads the picture of a material's member, if it lies by the first set of texture coordinates. */
static cw_status read_picture(material_reading *m, const json_t *info, cw_textures *set,
                              cw_texture *picture, cw_error *err)
{
    const json_t *texture = element(m->root, "textures", json_object_get(info, "index"));
    if (!texture)
        return CW_OK;
    if (set_of(info) != 0) {
        m->r->not_applied |= CWI_GLTF_OTHER_SETS;
        return CW_OK;
    }
    take_transform(m, info);
    if (!m->r->in->pictures.is_wanted)
        return CW_OK;
    take_sampler(m, texture, set);
    const json_t *extensions = json_object_get(texture, "extensions"),
                 *index = json_object_get(texture, "source");
    if (!element(m->root, "images", index))
        index = find(extensions, "KHR_texture_basisu", "source");
    if (!element(m->root, "images", index))
        index = find(extensions, "EXT_texture_webp", "source");
    const json_t *image = element(m->root, "images", index);
    return image ? load_image(m->r, image, index, picture, err) : CW_OK;
}

static void read_numbers(const json_t *list, size_t count, float otherwise, float *to)
{
    for (size_t n = 0; n < count; n++)
        to[n] = (float)number_or(json_array_get(list, n), (double)otherwise);
}

static void read_factors(const json_t *material, cw_textures *set)
{
    const json_t *pbr = json_object_get(material, "pbrMetallicRoughness");
    set->has_factors = true;
    read_numbers(json_object_get(pbr, "baseColorFactor"), 4, 1, set->color_factor);
    set->metallic_factor = (float)number_or(json_object_get(pbr, "metallicFactor"), 1);
    set->roughness_factor = (float)number_or(json_object_get(pbr, "roughnessFactor"), 1);
    read_numbers(json_object_get(material, "emissiveFactor"), 3, 0, set->emissive_factor);
    set->normal_scale = (float)number_or(find(material, "normalTexture", "scale"), 1);
    set->occlusion_strength =
        (float)number_or(find(material, "occlusionTexture", "strength"), 1);
}

/* Reads the pictures of one material. Its base colour is then that of its textures, not of vertices. */
static cw_status read_material(cwi_gltf_reader *r, const json_t *root, size_t index,
                               cw_error *err)
{
    const json_t *material = json_array_get(json_object_get(root, "materials"), index),
                 *pbr = json_object_get(material, "pbrMetallicRoughness");
    material_reading m = {.r = r, .root = root, .look = &r->looks[index]};
    cw_textures set = {0};
    const struct {
        const json_t *info;
        cw_texture *picture;
    } rows[] = {{json_object_get(pbr, "baseColorTexture"), &set.color},
                {json_object_get(pbr, "metallicRoughnessTexture"), &set.metallic_roughness},
                {json_object_get(material, "normalTexture"), &set.normal},
                {json_object_get(material, "occlusionTexture"), &set.occlusion},
                {json_object_get(material, "emissiveTexture"), &set.emissive}};
    cw_status st = CW_OK;
    for (size_t n = 0; n < sizeof rows / sizeof *rows && st == CW_OK; n++)
        st = read_picture(&m, rows[n].info, &set, rows[n].picture, err);
    read_factors(material, &set);
    if (st == CW_OK)
        st = cwi_textures_add(r->in, &set, &m.look->textures, err);
    if (st == CW_OK && m.look->textures) {
        r->scene.materials[index].is_plain = true;
        for (int c = 0; c < 4; c++)
            r->scene.materials[index].base[c] = 1;
    }
    return st;
}

/* --- the file ------------------------------------------------------------------------------ */

struct json_t *cwi_gltf_keep_materials(const char *json, size_t size)
{
    static const char textures[] = "\"textures\"";
    bool is_found = false;
    for (size_t at = 0; at + sizeof textures <= size && size <= MAX_JSON && !is_found; at++) {
        const char *next = memchr(json + at, '"', size - at);
        if (!next || (size_t)(next - json) + sizeof textures > size)
            break;
        at = (size_t)(next - json);
        is_found = memcmp(next, textures, sizeof textures - 1) == 0;
    }
    return is_found ? json_loadb(json, size, JSON_DISABLE_EOF_CHECK, NULL) : NULL;
}

cw_status cwi_gltf_read_materials(cwi_gltf_reader *r, struct json_t *root, cw_error *err)
{
    const size_t count = r->scene.material_count;
    cw_status st = CW_OK;
    if (!root || !count)
        return CW_OK;
    r->looks = cwi_alloc_zeroed(count, sizeof *r->looks);
    if (!r->looks)
        return cwi_fail_memory(err);
    for (size_t n = 0; n < count && st == CW_OK; n++)
        st = read_material(r, root, n, err);
    return st;
}

void cwi_gltf_free_materials(struct json_t *root)
{
    json_decref(root);
}
