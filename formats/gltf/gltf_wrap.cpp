// Turns glTF's JSON into plain numbers by tinygltf, without the bytes of buffers.
#include "formats/gltf/gltf_module.hpp"

#include "core/base/guard.hpp"
#include "core/base/memory.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

namespace
{

cw_status fail_model(cw_error *err, std::string words)
{
    std::replace(words.begin(), words.end(), '\n', ' ');
    return cwi_fail(err, CW_ERR_FORMAT, "the glTF is not valid: %.400s", words.c_str());
}

cw_status copy_string(const std::string &from, char *&to, cw_error *err)
{
    to = from.empty() ? nullptr : cwi_strdup(from.c_str());
    return from.empty() || to ? CW_OK : cwi_fail_memory(err);
}

// Copies the buffers: a list of objects, which cwi_gltf_blind() has renamed to "extras".
// tinygltf makes an int of 'byteLength'; cwi_gltf_check() has limited it to 32 bits.
cw_status copy_buffers(const tinygltf::Value &list, cwi_gltf_scene &scene, cw_error *err)
{
    const size_t count = list.IsArray() ? list.ArrayLen() : 0;
    cw_status st = allocate(scene.buffers, scene.buffer_count, count, err);
    for (size_t i = 0; i < scene.buffer_count && st == CW_OK; i++) {
        const tinygltf::Value &uri = member(list.Get(int(i)), "uri");
        const tinygltf::Value &bytes = member(list.Get(int(i)), "byteLength");
        scene.buffers[i].bytes = bytes.IsInt() ? uint32_t(bytes.GetNumberAsInt()) : 0;
        if (!uri.IsString())
            continue;
        scene.buffers[i].uri = cwi_strdup(uri.Get<std::string>().c_str());
        if (!scene.buffers[i].uri)
            st = cwi_fail_memory(err);
    }
    return st;
}

int choice_of(const tinygltf::Value &value, const std::vector<std::string> &names)
{
    const std::string name = value.IsString() ? value.Get<std::string>() : names[0];
    const auto found = std::find(names.begin(), names.end(), name);
    return found == names.end() ? -1 : int(found - names.begin());
}

void copy_packed(const tinygltf::BufferView &from, cwi_gltf_view &to)
{
    const auto found = from.extensions.find(GLTF_MESHOPT);
    to.packed_buffer = -1;
    if (found == from.extensions.end())
        return;
    const tinygltf::Value &ext = found->second, &offset = member(ext, "byteOffset");
    to.packed_buffer = id_of(member(ext, "buffer"));
    to.packed_offset = offset.IsNumber() ? number_of(offset) : 0;
    to.packed_bytes = number_of(member(ext, "byteLength"));
    to.packed_stride = number_of(member(ext, "byteStride"));
    to.packed_count = number_of(member(ext, "count"));
    to.packed_mode = choice_of(member(ext, "mode"), {"ATTRIBUTES", "TRIANGLES", "INDICES"});
    to.packed_filter =
        choice_of(member(ext, "filter"), {"NONE", "OCTAHEDRAL", "QUATERNION", "EXPONENTIAL"});
}

cw_status copy_views(const tinygltf::Model &model, cwi_gltf_scene &scene, cw_error *err)
{
    const cw_status st = allocate(scene.views, scene.view_count, model.bufferViews.size(), err);
    for (size_t i = 0; i < scene.view_count; i++) {
        const tinygltf::BufferView &from = model.bufferViews[i];
        scene.views[i].buffer = from.buffer;
        scene.views[i].offset = from.byteOffset;
        scene.views[i].bytes = from.byteLength;
        scene.views[i].stride = from.byteStride;
        copy_packed(from, scene.views[i]);
    }
    return st;
}

// Returns the count of numbers in an element; of matrices those of skins are used.
int numbers_of(const tinygltf::Accessor &from)
{
    if (from.type == TINYGLTF_TYPE_SCALAR)
        return 1;
    if (from.type == TINYGLTF_TYPE_MAT4 && from.componentType == TINYGLTF_COMPONENT_TYPE_FLOAT)
        return 16;
    return from.type >= TINYGLTF_TYPE_VEC2 && from.type <= TINYGLTF_TYPE_VEC4 ? from.type : 0;
}

cwi_gltf_sparse copy_sparse(const tinygltf::Accessor &from)
{
    const auto &s = from.sparse;
    cwi_gltf_sparse to = {};
    if (s.isSparse)
        to = {uint64_t(s.count),
              s.indices.bufferView,
              s.values.bufferView,
              uint64_t(s.indices.byteOffset),
              uint64_t(s.values.byteOffset),
              s.indices.componentType};
    return to;
}

cw_status copy_accessors(const tinygltf::Model &model, cwi_gltf_scene &scene, cw_error *err)
{
    const cw_status st =
        allocate(scene.accessors, scene.accessor_count, model.accessors.size(), err);
    for (size_t i = 0; i < scene.accessor_count; i++) {
        const tinygltf::Accessor &from = model.accessors[i];
        cwi_gltf_accessor &to = scene.accessors[i];
        to = {from.bufferView,
              from.byteOffset,
              from.count,
              from.componentType,
              numbers_of(from),
              from.normalized,
              copy_sparse(from),
              from.minValues.size() == 3 && from.maxValues.size() == 3,
              {},
              {}};
        for (size_t a = 0; a < 3 && to.has_bounds; a++) {
            to.min[a] = from.minValues[a];
            to.max[a] = from.maxValues[a];
        }
    }
    return st;
}

void copy_primitive(const tinygltf::Primitive &from, cwi_gltf_primitive &to)
{
    to.mode = from.mode < 0 ? TINYGLTF_MODE_TRIANGLES : from.mode;
    to.indices =
        from.extras.IsNumber() ? id_of(from.extras) : -1; // renamed by cwi_gltf_blind()
    to.position = find_attribute(from.attributes, "POSITION");
    to.normal = find_attribute(from.attributes, "NORMAL");
    to.color = find_attribute(from.attributes, "COLOR_0");
    to.material = from.material;
    to.texture = find_attribute(from.attributes, "TEXCOORD_0");
    to.draco = -1;
    const auto found = from.extensions.find(GLTF_DRACO);
    if (found == from.extensions.end())
        return;
    const tinygltf::Value &ids = member(found->second, "attributes");
    to.draco = id_of(member(found->second, "bufferView"));
    to.draco_position = id_of(member(ids, "POSITION"));
    to.draco_normal = id_of(member(ids, "NORMAL"));
    to.draco_color = id_of(member(ids, "COLOR_0"));
    to.draco_texture = id_of(member(ids, "TEXCOORD_0"));
}

cw_status copy_meshes(const tinygltf::Model &model, cwi_gltf_scene &scene, cw_error *err)
{
    size_t count = 0;
    cw_status st = allocate(scene.meshes, scene.mesh_count, model.meshes.size(), err);
    for (size_t i = 0; i < scene.mesh_count; i++) {
        scene.meshes[i].first = count;
        count += model.meshes[i].primitives.size();
        scene.meshes[i].end = count;
    }
    for (size_t i = 0; i < scene.mesh_count && st == CW_OK; i++)
        st = copy_string(model.meshes[i].name, scene.meshes[i].name, err);
    if (st == CW_OK)
        st = allocate(scene.primitives, scene.primitive_count, count, err);
    if (st != CW_OK)
        return st;
    cwi_gltf_primitive *to = scene.primitives;
    for (const tinygltf::Mesh &mesh : model.meshes)
        for (const tinygltf::Primitive &from : mesh.primitives)
            copy_primitive(from, *to++);
    return CW_OK;
}

// Copies the base colours of materials. White is that of none, and this grey that of our writer and others.
cw_status copy_materials(const tinygltf::Model &model, cwi_gltf_scene &scene, cw_error *err)
{
    const cw_status st =
        allocate(scene.materials, scene.material_count, model.materials.size(), err);
    for (size_t i = 0; i < scene.material_count; i++) {
        const tinygltf::Material &from = model.materials[i];
        const auto &base = from.pbrMetallicRoughness.baseColorFactor;
        const std::vector<double> white(4, 1.0), grey = {0.8, 0.8, 0.8, 1.0};
        const std::vector<double> color = base.size() == 4 ? base : white;
        std::copy(color.begin(), color.end(), scene.materials[i].base);
        scene.materials[i].is_plain = color == white || color == grey;
    }
    return st;
}

// Copies the numbers of an array of that count; for anything else returns false and keeps the
// old ones.
bool copy_numbers(const tinygltf::Value &from, double *to, size_t count)
{
    if (!from.IsArray() || from.ArrayLen() != count)
        return false;
    for (size_t i = 0; i < count; i++)
        if (!from.Get(int(i)).IsNumber() ||
            !std::isfinite(from.Get(int(i)).GetNumberAsDouble()))
            return false;
    for (size_t i = 0; i < count; i++)
        to[i] = from.Get(int(i)).GetNumberAsDouble();
    return true;
}

// Reads the extras that make_extras() wrote.
void copy_extras(const tinygltf::Value &extras, cwi_gltf_node &node)
{
    const tinygltf::Value &frame = member(extras, "frame"), &unit = member(extras, "unit");
    node.lps = frame.IsString() && frame.Get<std::string>() == "LPS" && unit.IsString() &&
               unit.Get<std::string>() == "mm";
    node.has_origin = node.lps && copy_numbers(member(extras, "origin"), node.origin, 3);
    node.has_affine = node.lps && copy_numbers(member(extras, "affine"), node.affine[0], 12);
}

// Reads the words of a code that describe_code() wrote.
cw_status copy_code(const tinygltf::Value &code, char **to, cw_error *err)
{
    static const char *const keys[] = {"scheme", "value", "meaning"};
    cw_status st = CW_OK;
    for (size_t n = 0; n < 3 && st == CW_OK; n++) {
        const tinygltf::Value &word = member(code, keys[n]);
        if (word.IsString())
            st = copy_string(word.Get<std::string>(), to[n], err);
    }
    return st;
}

// Reads the label that tell_label() wrote.
cw_status copy_label(const tinygltf::Value &extras, cwi_gltf_node &node, cw_error *err)
{
    const tinygltf::Value &label = member(extras, "label"), &layer = member(extras, "layer"),
                          &color = member(extras, "color");
    char number[CW_LABEL_NUMBER] = "";
    cw_label read = {};
    if (label.IsNumber())
        snprintf(number, sizeof number, "%.0f", label.GetNumberAsDouble());
    else if (label.IsString())
        snprintf(number, sizeof number, "%.23s", label.Get<std::string>().c_str());
    if (!node.lps || !cw_label_parse(number, &read))
        return CW_OK;
    node.has_label = true;
    node.label = read.value;
    node.label_id = read.id;
    node.label_is_negative = read.is_negative;
    node.layer =
        layer.IsNumber() && number_of(layer) <= UINT32_MAX ? uint32_t(number_of(layer)) : 0;
    unsigned rgb[3];
    const std::string hex = color.IsString() ? color.Get<std::string>() : "";
    if (hex.size() == 7 &&
        std::sscanf(hex.c_str(), "#%2x%2x%2x", &rgb[0], &rgb[1], &rgb[2]) == 3) {
        node.has_color = true;
        for (size_t c = 0; c < 3; c++)
            node.color[c] = uint8_t(rgb[c]);
        node.color[3] = 255;
    }
    cw_status st = copy_code(member(extras, "category"), node.codes, err);
    return st == CW_OK ? copy_code(member(extras, "type"), node.codes + 3, err) : st;
}

size_t count_levels(const tinygltf::Node &node)
{
    const auto found = node.extensions.find(CWI_GLTF_HIDDEN_LOD);
    if (found == node.extensions.end())
        return 0;
    const tinygltf::Value &ids = member(found->second, "ids");
    return ids.IsArray() ? ids.ArrayLen() : 0;
}

// Sets the map of a node. One that is left out is the identity.
void set_matrix(const tinygltf::Node &from, double to[3][4])
{
    static const double origin[3] = {0, 0, 0}, unturned[4] = {0, 0, 0, 1}, unit[3] = {1, 1, 1};
    const std::vector<double> &m = from.matrix, &t = from.translation, &q = from.rotation,
                              &s = from.scale;
    cwi_gltf_compose(t.empty() ? origin : t.data(), q.empty() ? unturned : q.data(),
                     s.empty() ? unit : s.data(), to[0]);
    for (size_t i = 0; i < 12 && !m.empty(); i++)
        to[i / 4][i % 4] = m[4 * (i % 4) + i / 4];
}

bool has_length(const std::vector<double> &numbers, size_t length)
{
    return numbers.empty() || numbers.size() == length;
}

cw_status copy_node(const tinygltf::Node &from, size_t index, cwi_gltf_node &to, cw_error *err)
{
    const bool is_plain = has_length(from.matrix, 16) && has_length(from.translation, 3) &&
                          has_length(from.rotation, 4) && has_length(from.scale, 3);
    if (!is_plain)
        return cwi_fail(err, CW_ERR_FORMAT,
                        "'matrix', 'translation', 'rotation' or 'scale' of node %zu has not as "
                        "many numbers as it must",
                        index);
    if (!from.matrix.empty() && (from.matrix[3] != 0 || from.matrix[7] != 0 ||
                                 from.matrix[11] != 0 || from.matrix[15] != 1))
        return cwi_fail(err, CW_ERR_FORMAT, "nodes[%zu].matrix is not affine", index);
    to.mesh = from.mesh;
    set_matrix(from, to.local);
    to.levels = count_levels(from);
    copy_extras(from.extras, to);
    cw_status st = copy_label(from.extras, to, err);
    return st == CW_OK ? copy_string(from.name, to.name, err) : st;
}

cw_status copy_nodes(const tinygltf::Model &model, cwi_gltf_scene &scene, cw_error *err)
{
    size_t count = 0;
    cw_status st = allocate(scene.nodes, scene.node_count, model.nodes.size(), err);
    for (size_t i = 0; i < scene.node_count && st == CW_OK; i++) {
        st = copy_node(model.nodes[i], i, scene.nodes[i], err);
        scene.nodes[i].first = count;
        count += model.nodes[i].children.size();
        scene.nodes[i].end = count;
    }
    if (st == CW_OK)
        st = allocate(scene.children, scene.child_count, count, err);
    if (st != CW_OK)
        return st;
    int *to = scene.children;
    for (const tinygltf::Node &node : model.nodes)
        to = std::copy(node.children.begin(), node.children.end(), to);
    return CW_OK;
}

// Copies the roots of the scene to show; without any scene, all nodes without a parent.
cw_status copy_roots(const tinygltf::Model &model, cwi_gltf_scene &scene, cw_error *err)
{
    std::vector<int> roots;
    const int shown = std::max(model.defaultScene, 0);
    if (size_t(shown) < model.scenes.size()) {
        roots = model.scenes[size_t(shown)].nodes;
    } else if (model.defaultScene >= 0 || !model.scenes.empty()) {
        return cwi_fail(err, CW_ERR_FORMAT, "'scene' is %d; there are %zu scenes", shown,
                        model.scenes.size());
    } else {
        std::vector<bool> is_child(model.nodes.size());
        for (size_t i = 0; i < scene.child_count; i++)
            if (scene.children[i] >= 0 && size_t(scene.children[i]) < is_child.size())
                is_child[size_t(scene.children[i])] = true;
        for (size_t i = 0; i < is_child.size(); i++)
            if (!is_child[i])
                roots.push_back(int(i));
    }
    const cw_status st = allocate(scene.roots, scene.root_count, roots.size(), err);
    if (st == CW_OK)
        std::copy(roots.begin(), roots.end(), scene.roots);
    return st;
}

// Checks required extensions. Those that are read, or change only the look of a scene, are accepted.
cw_status check_extensions(const tinygltf::Model &model, cw_error *err)
{
    const std::vector<std::string> harmless = {
        "KHR_mesh_quantization", GLTF_MESHOPT,         GLTF_DRACO,
        "KHR_texture_transform", "KHR_texture_basisu", "KHR_lights_punctual",
        "EXT_texture_webp",      GLTF_INSTANCING,      GLTF_VISIBILITY};
    for (const std::string &name : model.extensionsRequired)
        if (name.compare(0, 14, "KHR_materials_") != 0 &&
            std::find(harmless.begin(), harmless.end(), name) == harmless.end())
            return cwi_fail(err, CW_ERR_UNSUPPORTED,
                            "the file requires the extension '%.100s', which is not read",
                            name.c_str());
    return CW_OK;
}

// The use of an accessor in a primitive, and the types that glTF allows for it.
struct Usage {
    const char *name, *expected;
    bool (*fits)(const tinygltf::Accessor &accessor, bool quantized);
};

bool is_float(const tinygltf::Accessor &a)
{
    return a.componentType == TINYGLTF_COMPONENT_TYPE_FLOAT;
}

bool is_small(const tinygltf::Accessor &a) // 8 or 16 bits
{
    return a.componentType <= TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT;
}

bool is_unsigned(const tinygltf::Accessor &a)
{
    return a.componentType == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE ||
           a.componentType == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ||
           a.componentType == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
}

bool fits_position(const tinygltf::Accessor &a, bool quantized)
{
    return a.type == TINYGLTF_TYPE_VEC3 && (is_float(a) || (quantized && is_small(a)));
}

bool fits_normal(const tinygltf::Accessor &a, bool quantized)
{
    const bool is_fraction = quantized && is_small(a) && !is_unsigned(a) && a.normalized;
    return a.type == TINYGLTF_TYPE_VEC3 && (is_float(a) || is_fraction);
}

bool fits_color(const tinygltf::Accessor &a, bool)
{
    const bool is_fraction =
        is_small(a) && is_unsigned(a); // if not normalized, it was forgotten
    return (a.type == TINYGLTF_TYPE_VEC3 || a.type == TINYGLTF_TYPE_VEC4) &&
           (is_float(a) || is_fraction);
}

bool fits_texture(const tinygltf::Accessor &a, bool quantized)
{
    return a.type == TINYGLTF_TYPE_VEC2 &&
           (is_float(a) || (is_small(a) && (quantized || (is_unsigned(a) && a.normalized))));
}

bool fits_indices(const tinygltf::Accessor &a, bool)
{
    return a.type == TINYGLTF_TYPE_SCALAR && is_unsigned(a);
}

const Usage usages[] = {
    {"attributes.POSITION",
     "VEC3 of floats, or with KHR_mesh_quantization required of 8 or 16 bits", fits_position},
    {"attributes.NORMAL",
     "VEC3 of floats, or with KHR_mesh_quantization required of 8 or 16 bits, signed and "
     "normalized",
     fits_normal},
    {"attributes.COLOR_0",
     "VEC3 or VEC4 of floats, or of 8 or 16 bits, unsigned and normalized", fits_color},
    {"attributes.TEXCOORD_0",
     "VEC2 of floats, or of 8 or 16 bits, unsigned and normalized; with KHR_mesh_quantization "
     "required of any 8 or 16 bits",
     fits_texture},
    {"indices", "SCALAR of 8, 16 or 32 bits, unsigned", fits_indices}};

cw_status check_usage(const tinygltf::Model &model, const std::string &path, int accessor,
                      const Usage &usage, bool quantized, cw_error *err)
{
    if (accessor < 0 || size_t(accessor) >= model.accessors.size() ||
        usage.fits(model.accessors[size_t(accessor)], quantized))
        return CW_OK;
    return cwi_fail(err, CW_ERR_FORMAT, "%s.%s: accessors[%d] is not %s", path.c_str(),
                    usage.name, accessor, usage.expected);
}

// Checks the types of accessors. Points and lines are left out, with any content.
cw_status check_usages(const tinygltf::Model &model, const cwi_gltf_scene &scene, cw_error *err)
{
    const auto &names = model.extensionsRequired;
    const bool quantized =
        std::find(names.begin(), names.end(), "KHR_mesh_quantization") != names.end();
    for (size_t m = 0; m < scene.mesh_count; m++)
        for (size_t i = scene.meshes[m].first; i < scene.meshes[m].end; i++) {
            const cwi_gltf_primitive &p = scene.primitives[i];
            const int accessors[] = {p.position, p.normal, p.color, p.texture, p.indices};
            const std::string path = "meshes[" + std::to_string(m) + "].primitives[" +
                                     std::to_string(i - scene.meshes[m].first) + "]";
            if (p.mode >= TINYGLTF_MODE_TRIANGLES && p.position < 0)
                return cwi_fail(err, CW_ERR_FORMAT, "%s.attributes: there is no POSITION",
                                path.c_str());
            for (size_t n = 0; n < 5 && p.mode >= TINYGLTF_MODE_TRIANGLES; n++) {
                const cw_status st =
                    check_usage(model, path, accessors[n], usages[n], quantized, err);
                if (st != CW_OK)
                    return st;
            }
        }
    return CW_OK;
}

bool ignore_image(tinygltf::Image *, int, std::string *, std::string *, int, int,
                  const unsigned char *, int, void *)
{
    return true;
}

// Removes complaints about skins without inverseBindMatrices, which glTF allows.
void forgive_skins(std::string &words)
{
    const std::string complaint = "'inverseBindMatrices' property is missing in Skin.\n";
    for (size_t at = words.find(complaint); at != std::string::npos; at = words.find(complaint))
        words.erase(at, complaint.size());
}

cw_status parse_scene(const char *json, size_t size, cwi_gltf_scene *scene,
                      cw_error *err) noexcept
{
    return cw::guard(err, "tinygltf", [&] {
        tinygltf::TinyGLTF loader;
        tinygltf::Model model;
        std::string words, warning;
        loader.SetImageLoader(ignore_image, nullptr);
        loader.SetFsCallbacks({});   // it must open no file
        model.asset.version.clear(); // no default
        const bool done =
            loader.LoadASCIIFromString(&model, &words, &warning, json, unsigned(size), "", 0);
        forgive_skins(words);
        if (!done || !words.empty()) // it may omit broken parts and go on
            return fail_model(err, words);
        if (model.asset.version.compare(0, 2, "2.") != 0)
            return cwi_fail(err, CW_ERR_FORMAT, "'asset.version' is '%.20s'; 2.0 was expected",
                            model.asset.version.c_str());
        cw_status st = check_extensions(model, err);
        if (st == CW_OK)
            st = copy_nodes(model, *scene, err);
        if (st == CW_OK)
            st = copy_roots(model, *scene, err);
        if (st == CW_OK)
            st = copy_buffers(model.extras, *scene, err);
        if (st == CW_OK)
            st = copy_views(model, *scene, err);
        if (st == CW_OK)
            st = copy_accessors(model, *scene, err);
        if (st == CW_OK)
            st = copy_meshes(model, *scene, err);
        if (st == CW_OK)
            st = copy_materials(model, *scene, err);
        if (st == CW_OK)
            st = cwi_gltf_copy_poses(model, *scene, err);
        if (st == CW_OK)
            st = check_usages(model, *scene, err);
        return st;
    });
}

} // namespace

extern "C" const cwi_gltf_functions cwi_module_gltf = {cwi_gltf_document_make, parse_scene};
