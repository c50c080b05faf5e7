// Gives the materials of a glTF file their pictures, by tinygltf.
#include "formats/gltf/gltf_module.hpp"

#include <algorithm>
#include <cstring>

namespace
{

using Object = tinygltf::Value::Object;

// The kind of a picture's file: its name in glTF, and the extension that it needs.
struct Kind {
    const char *mime, *extension, *start;
    size_t size, at;
};

const Kind kinds[] = {{"image/png", nullptr, "\x89PNG", 4, 0},
                      {"image/jpeg", nullptr, "\xff\xd8", 2, 0},
                      {"image/webp", "EXT_texture_webp", "WEBP", 4, 8},
                      {"image/ktx2", "KHR_texture_basisu", "\xabKTX 20", 7, 0}};

const Kind &kind_of(const cw_texture &file)
{
    for (const Kind &k : kinds)
        if (file.size >= k.at + k.size && std::memcmp(file.bytes + k.at, k.start, k.size) == 0)
            return k;
    return kinds[0];
}

void use_extension(tinygltf::Model &model, const std::string &name)
{
    if (std::find(model.extensionsUsed.begin(), model.extensionsUsed.end(), name) !=
        model.extensionsUsed.end())
        return;
    model.extensionsUsed.push_back(name);
    model.extensionsRequired.push_back(name);
}

int find_sampler(tinygltf::Model &model, bool repeats)
{
    const int wrap =
        repeats ? TINYGLTF_TEXTURE_WRAP_REPEAT : TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE;
    for (size_t n = 0; n < model.samplers.size(); n++)
        if (model.samplers[n].wrapS == wrap)
            return int(n);
    tinygltf::Sampler sampler;
    sampler.minFilter = TINYGLTF_TEXTURE_FILTER_LINEAR_MIPMAP_LINEAR;
    sampler.magFilter = TINYGLTF_TEXTURE_FILTER_LINEAR;
    sampler.wrapS = sampler.wrapT = wrap;
    model.samplers.push_back(sampler);
    return int(model.samplers.size()) - 1;
}

// Finds the texture of a picture, from 1 on, with its sampler; 0: -1.
int find_texture(tinygltf::Model &model, const cwi_gltf_document &document, size_t image,
                 bool repeats)
{
    if (!image)
        return -1;
    const Kind &kind = kind_of(document.images[image - 1].file);
    const int sampler = find_sampler(model, repeats);
    const int source = int(image) - 1;
    for (size_t n = 0; n < model.textures.size(); n++)
        if (model.textures[n].extras.GetNumberAsInt() == source &&
            model.textures[n].sampler == sampler)
            return int(n);
    tinygltf::Texture texture;
    texture.sampler = sampler;
    texture.extras = tinygltf::Value(source); // removed by cwi_gltf_add_images()
    if (kind.extension) {
        texture.extensions[kind.extension] =
            tinygltf::Value(Object{{"source", tinygltf::Value(source)}});
        use_extension(model, kind.extension);
    } else {
        texture.source = source;
    }
    model.textures.push_back(texture);
    return int(model.textures.size()) - 1;
}

void set_factors(tinygltf::Material &material, const cw_textures &set, bool has_color)
{
    tinygltf::PbrMetallicRoughness &pbr = material.pbrMetallicRoughness;
    if (set.has_factors) {
        for (size_t c = 0; c < 4 && !has_color; c++)
            pbr.baseColorFactor[c] = double(set.color_factor[c]);
        pbr.metallicFactor = double(set.metallic_factor);
        pbr.roughnessFactor = double(set.roughness_factor);
        material.emissiveFactor.assign(set.emissive_factor, set.emissive_factor + 3);
        if (pbr.baseColorFactor[3] < 1)
            material.alphaMode = "BLEND";
        return;
    }
    if (set.color.bytes && !has_color)
        pbr.baseColorFactor = {1, 1, 1, 1};
    if (set.metallic_roughness.bytes)
        pbr.metallicFactor = pbr.roughnessFactor = 1;
    if (set.emissive.bytes)
        material.emissiveFactor = {1, 1, 1};
}

} // namespace

void cwi_gltf_add_pictures(tinygltf::Model &model, const cwi_gltf_document &document,
                           const cwi_gltf_piece &piece, int index)
{
    const cw_textures *set = piece.part->textures;
    if (!set || !piece.has_pictures)
        return;
    tinygltf::Material &material = model.materials[size_t(index)];
    tinygltf::PbrMetallicRoughness &pbr = material.pbrMetallicRoughness;
    set_factors(material, *set, piece.groups.count > 0 || piece.part->has_color);
    const auto texture = [&](int which) {
        return find_texture(model, document, piece.images[which], set->repeats);
    };
    pbr.baseColorTexture.index = texture(CWI_GLTF_COLOR_PICTURE);
    pbr.metallicRoughnessTexture.index = texture(CWI_GLTF_METALLIC_PICTURE);
    material.normalTexture.index = texture(CWI_GLTF_NORMAL_PICTURE);
    material.occlusionTexture.index = texture(CWI_GLTF_OCCLUSION_PICTURE);
    material.emissiveTexture.index = texture(CWI_GLTF_EMISSIVE_PICTURE);
    if (set->normal_scale > 0)
        material.normalTexture.scale = double(set->normal_scale);
    if (set->has_factors && set->occlusion_strength != 0)
        material.occlusionTexture.strength = double(set->occlusion_strength);
}

void cwi_gltf_add_images(tinygltf::Model &model, const cwi_gltf_document &document)
{
    for (tinygltf::Texture &texture : model.textures)
        texture.extras = tinygltf::Value();
    for (size_t n = 0; n < document.image_count; n++) {
        const cwi_gltf_image &image = document.images[n];
        tinygltf::BufferView view;
        view.buffer = 0;
        view.byteOffset = size_t(image.at);
        view.byteLength = image.file.size;
        model.bufferViews.push_back(view);
        tinygltf::Image picture;
        picture.bufferView = int(model.bufferViews.size()) - 1;
        picture.mimeType = kind_of(image.file).mime;
        model.images.push_back(picture);
    }
}
