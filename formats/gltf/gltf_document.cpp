// Makes the JSON of a glTF file from plain numbers, by tinygltf, without the bytes of buffers.
#include "formats/gltf/gltf_module.hpp"

#include "core/base/guard.hpp"
#include "core/base/memory.h"

#include <cmath>
#include <cstdio>
#include <sstream>
#include <string>

namespace
{

using Object = tinygltf::Value::Object;
using Array = tinygltf::Value::Array;

tinygltf::Value whole(uint64_t number)
{
    return tinygltf::Value(int(number));
}

tinygltf::Value text(const std::string &words)
{
    return tinygltf::Value(words);
}

const char *const attributes[CWI_GLTF_USES] = {"",        "POSITION",   "NORMAL",
                                               "COLOR_0", "TEXCOORD_0", "TANGENT"};

tinygltf::Value meshopt_extension(const cwi_gltf_array &a)
{
    Object extension = {{"buffer", whole(0)},
                        {"byteOffset", whole(a.packed_at)},
                        {"byteLength", whole(a.packed)},
                        {"byteStride", whole(a.stride)},
                        {"count", whole(a.count)},
                        {"mode", text(a.use == CWI_GLTF_INDICES ? "TRIANGLES" : "ATTRIBUTES")}};
    if (a.exponential)
        extension["filter"] = text("EXPONENTIAL");
    return tinygltf::Value(extension);
}

// Adds an array's view. The view of meshopt data is in a buffer that no file has.
int add_view(tinygltf::Model &model, const cwi_gltf_array &a)
{
    const bool indices = a.use == CWI_GLTF_INDICES;
    const size_t element =
        size_t(a.numbers) * size_t(tinygltf::GetComponentSizeInBytes(uint32_t(a.component)));
    tinygltf::BufferView view;
    view.buffer = a.packed ? 1 : 0;
    view.byteOffset = size_t(a.at);
    view.byteLength = size_t(a.count * a.stride);
    view.byteStride = !indices && element != a.stride ? size_t(a.stride) : 0;
    view.target = indices ? TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER : TINYGLTF_TARGET_ARRAY_BUFFER;
    if (a.packed) // see name_extensions()
        view.extras = tinygltf::Value(Object{{GLTF_MESHOPT, meshopt_extension(a)}});
    model.bufferViews.push_back(view);
    return int(model.bufferViews.size()) - 1;
}

// Adds an accessor. For Draco it describes the decoded data, and has no view.
int add_accessor(tinygltf::Model &model, const cwi_gltf_piece &piece, const cwi_gltf_array &a)
{
    tinygltf::Accessor accessor;
    accessor.bufferView = piece.draco ? -1 : add_view(model, a);
    accessor.componentType = a.component;
    accessor.type = a.numbers == 1   ? TINYGLTF_TYPE_SCALAR
                    : a.numbers == 2 ? TINYGLTF_TYPE_VEC2
                    : a.numbers == 3 ? TINYGLTF_TYPE_VEC3
                                     : TINYGLTF_TYPE_VEC4;
    accessor.count = size_t(a.count);
    accessor.normalized = a.normalized;
    if (a.use == CWI_GLTF_POSITION) {
        accessor.minValues.assign(piece.low, piece.low + 3);
        accessor.maxValues.assign(piece.high, piece.high + 3);
    }
    model.accessors.push_back(accessor);
    return int(model.accessors.size()) - 1;
}

tinygltf::Value draco_extension(tinygltf::Model &model, const cwi_gltf_piece &piece)
{
    tinygltf::BufferView view;
    view.buffer = 0;
    view.byteOffset = size_t(piece.draco_at);
    view.byteLength = size_t(piece.draco);
    model.bufferViews.push_back(view);
    Object ids = {{"POSITION", tinygltf::Value(piece.ids.position)}};
    if (piece.ids.normal >= 0)
        ids["NORMAL"] = tinygltf::Value(piece.ids.normal);
    if (piece.ids.color >= 0)
        ids["COLOR_0"] = tinygltf::Value(piece.ids.color);
    if (piece.ids.texture >= 0)
        ids["TEXCOORD_0"] = tinygltf::Value(piece.ids.texture);
    if (piece.ids.tangent >= 0)
        ids["TANGENT"] = tinygltf::Value(piece.ids.tangent);
    return tinygltf::Value(Object{{"bufferView", whole(model.bufferViews.size() - 1)},
                                  {"attributes", tinygltf::Value(ids)}});
}

// Converts a component of an sRGB colour to glTF's linear one, in double precision: it becomes
// the same byte again.
double linear(uint8_t component)
{
    const double c = component / 255.0;
    return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
}

int add_material(tinygltf::Model &model, const std::string &name,
                 const std::vector<double> &color, const std::string &mode)
{
    tinygltf::Material material;
    material.name = name;
    material.pbrMetallicRoughness.baseColorFactor = color;
    material.pbrMetallicRoughness.metallicFactor = 0.0;
    material.pbrMetallicRoughness.roughnessFactor = 0.8;
    material.alphaMode = mode;
    model.materials.push_back(material);
    return int(model.materials.size()) - 1;
}

int add_color(tinygltf::Model &model, const std::string &name, const uint8_t *c)
{
    return add_material(model, name, {linear(c[0]), linear(c[1]), linear(c[2]), c[3] / 255.0},
                        c[3] < 255 ? "BLEND" : "OPAQUE");
}

// Prints a colour, and its opacity if it has one: "#FF8000".
std::string print_color(const uint8_t *c)
{
    char hex[16];
    const int end = std::snprintf(hex, sizeof hex, "#%02X%02X%02X", c[0], c[1], c[2]);
    if (c[3] < 255)
        std::snprintf(hex + end, sizeof hex - size_t(end), "%02X", c[3]);
    return hex;
}

// Finds the material of a piece. One of a single colour has its own. Vertex colours are multiplied with
// the base colour, so the base colour is white with them. Other similar pieces share a material.
int find_material(tinygltf::Model &model, const cwi_gltf_piece &piece)
{
    if (piece.part->has_color)
        return add_color(model, piece.part->name, piece.part->color);
    const double grey = piece.part->mesh.colors ? 1.0 : 0.8;
    const std::string mode = piece.translucent ? "BLEND" : "OPAQUE";
    if (piece.has_pictures)
        return add_material(model, piece.part->name, {grey, grey, grey, 1.0}, mode);
    for (size_t i = 0; i < model.materials.size(); i++)
        if (model.materials[i].alphaMode == mode && model.materials[i].name == "surface" &&
            model.materials[i].pbrMetallicRoughness.baseColorFactor[0] == grey)
            return int(i);
    return add_material(model, "surface", {grey, grey, grey, 1.0}, mode);
}

// Tells a label in the extras of its node: its value, colour and codes.
tinygltf::Value describe_code(const cw_code &code)
{
    Object words;
    if (code.scheme)
        words["scheme"] = text(code.scheme);
    if (code.value)
        words["value"] = text(code.value);
    if (code.meaning)
        words["meaning"] = text(code.meaning);
    return tinygltf::Value(words);
}

// Returns the number of a label; one that no double has becomes text.
tinygltf::Value label_number(const cw_label &label)
{
    char number[CW_LABEL_NUMBER];
    const uint64_t size = label.id ? label.id : label.value;
    if (size > uint64_t(1) << 53)
        return text(cw_label_number(&label, number));
    if (size > INT32_MAX)
        return tinygltf::Value(label.is_negative ? -double(size) : double(size));
    return tinygltf::Value(label.is_negative ? -int(size) : int(size));
}

void tell_label(const cw_label &label, Object &extras)
{
    extras["label"] = label_number(label);
    if (label.layer > 0)
        extras["layer"] = whole(label.layer);
    if (label.has_color) {
        const uint8_t opaque[4] = {label.color[0], label.color[1], label.color[2], 255};
        extras["color"] = text(print_color(opaque));
    }
    if (label.category.value || label.category.meaning)
        extras["category"] = describe_code(label.category);
    if (label.type.value || label.type.meaning)
        extras["type"] = describe_code(label.type);
}

Object make_extras(const cw_mesh &mesh, const double *origin)
{
    Object extras = {{"frame", text("LPS")}, {"unit", text("mm")}};
    Array affine;
    bool has_affine = false;
    for (const double(&row)[4] : mesh.affine)
        for (double number : row) {
            affine.push_back(tinygltf::Value(number));
            has_affine = has_affine || number != 0;
        }
    if (has_affine)
        extras["affine"] = tinygltf::Value(affine);
    if (origin)
        extras["origin"] =
            tinygltf::Value(Array{tinygltf::Value(origin[0]), tinygltf::Value(origin[1]),
                                  tinygltf::Value(origin[2])});
    return extras;
}

void tell_level(const cwi_part &part, Object &extras)
{
    extras["triangles"] = whole(part.mesh.triangle_count);
    if (part.max_error_mm > 0) {
        extras["max_error_mm"] = tinygltf::Value(part.max_error_mm);
        extras["rms_error_mm"] = tinygltf::Value(part.rms_error_mm);
    }
}

// Makes the node of a piece. It turns LPS millimetres to glTF's metres, +Y up, front towards
// +Z: (x, y, z) goes to 0.001 (x, z, -y). So the vertices stay as they are. Adding 0.0 turns -0
// into 0. In a local scene the origin is stated, not applied.
tinygltf::Node make_node(const cwi_gltf_piece &piece, const double *local_origin)
{
    const double half = std::sqrt(0.5), scale = 0.001 * piece.step, *t = piece.translation;
    tinygltf::Node node;
    node.name = piece.part->name;
    node.rotation = {-half, 0, 0, half};
    node.scale = {scale, scale, scale};
    if (!local_origin || t[0] != 0 || t[1] != 0 || t[2] != 0)
        node.translation = {0.001 * t[0] + 0.0, 0.001 * t[2] + 0.0, -0.001 * t[1] + 0.0};
    return node;
}

// Names the levels of a node to tinygltf itself. From 2.9 on it has a member for them, and writes
// them from there alone; before, it writes the extension that the node has.
template <typename Node>
auto name_levels(Node &node, int first, size_t count) -> decltype(node.lods.clear())
{
    for (size_t n = 1; n < count; n++)
        node.lods.push_back(first + int(n));
}

template <typename Node, typename... None> void name_levels(Node &, int, size_t, None...)
{
}

// Returns the share of the screen below which a level is enough for the ball around level 0: its error
// is then less than a pixel of 1920 x 1080. Without an error it has as many triangles to an area there
// as level 0 has on all of the screen.
double find_coverage(const cwi_part &first, const cwi_part &level)
{
    double low[3], high[3], square = 0;
    if (!(level.max_error_mm > 0) || !cw_mesh_bounds(&first.mesh, low, high))
        return double(level.mesh.triangle_count) / double(first.mesh.triangle_count);
    for (int a = 0; a < 3; a++)
        square += (high[a] - low[a]) * (high[a] - low[a]) / 4;
    const double pixels = std::acos(-1.0) * square / (level.max_error_mm * level.max_error_mm);
    return std::min(1.0, pixels / (1920.0 * 1080));
}

// Adds levels to the node of level 0. It names the other nodes, and the shares of the screen
// down to which each is shown. The last level is shown at any smaller share.
void add_levels(tinygltf::Node &node, const cwi_gltf_piece *levels, size_t count, int first,
                Object &extras)
{
    Array ids, coverage;
    for (size_t n = 1; n < count; n++) {
        ids.push_back(tinygltf::Value(first + int(n)));
        coverage.push_back(tinygltf::Value(find_coverage(*levels[0].part, *levels[n].part)));
    }
    coverage.push_back(tinygltf::Value(0.0));
    node.extensions[GLTF_LOD] = tinygltf::Value(Object{{"ids", tinygltf::Value(ids)}});
    name_levels(node, first, count);
    extras["MSFT_screencoverage"] = tinygltf::Value(coverage);
}

// Returns the number of pieces that are levels of the first one, including it.
size_t count_levels(const cwi_gltf_piece *pieces, size_t count)
{
    size_t n = 1;
    while (n < count && pieces[n].part->level > 0)
        n++;
    return n;
}

tinygltf::Primitive make_primitive(tinygltf::Model &model, const cwi_gltf_piece &piece)
{
    tinygltf::Primitive primitive;
    for (size_t n = 0; n < piece.array_count; n++) {
        const cwi_gltf_array &a = piece.arrays[n];
        const int accessor = add_accessor(model, piece, a);
        if (a.use == CWI_GLTF_INDICES)
            primitive.indices = accessor;
        else
            primitive.attributes[attributes[a.use]] = accessor;
    }
    if (piece.draco)
        primitive.extensions[GLTF_DRACO] = draco_extension(model, piece);
    primitive.mode = TINYGLTF_MODE_TRIANGLES;
    return primitive;
}

// Adds a primitive for each colour. All have the same vertices, and their indices are one view.
void add_groups(tinygltf::Model &model, const cwi_gltf_document &document,
                const cwi_gltf_piece &piece, const tinygltf::Primitive &whole,
                tinygltf::Mesh &mesh)
{
    const size_t stride = size_t(piece.arrays[0].stride);
    for (size_t n = 0; n < piece.groups.count; n++) {
        const cwi_color_group &group = piece.groups.items[n];
        tinygltf::Primitive primitive = whole;
        tinygltf::Accessor indices = model.accessors[size_t(whole.indices)];
        indices.byteOffset = 3 * group.first * stride;
        indices.count = 3 * group.count;
        if (n == 0) {
            model.accessors[size_t(whole.indices)] = indices;
        } else {
            model.accessors.push_back(indices);
            primitive.indices = int(model.accessors.size()) - 1;
        }
        primitive.material = add_color(model, print_color(group.color), group.color);
        cwi_gltf_add_pictures(model, document, piece, primitive.material);
        mesh.primitives.push_back(primitive);
    }
}

// Adds a piece of the document. Those before it are there.
void add_piece(tinygltf::Model &model, const cwi_gltf_document &document, size_t index_of)
{
    const cwi_gltf_piece &piece = document.pieces[index_of];
    const size_t left = document.count - index_of;
    const double *local_origin = document.local_origin;
    tinygltf::Mesh mesh;
    tinygltf::Primitive primitive = make_primitive(model, piece);
    mesh.name = piece.part->name;
    if (piece.groups.count) {
        add_groups(model, document, piece, primitive, mesh);
    } else {
        primitive.material = find_material(model, piece);
        cwi_gltf_add_pictures(model, document, piece, primitive.material);
        mesh.primitives.push_back(primitive);
    }
    model.meshes.push_back(mesh);
    tinygltf::Node node = make_node(piece, local_origin);
    node.mesh = int(model.meshes.size()) - 1;
    const bool is_level = piece.part->level > 0;
    const size_t levels = is_level ? 1 : count_levels(&piece, left);
    const int index = int(model.nodes.size());
    Object extras = make_extras(piece.part->mesh, local_origin);
    if (piece.part->label)
        tell_label(*piece.part->label, extras);
    if (is_level || levels > 1)
        tell_level(*piece.part, extras);
    if (levels > 1)
        add_levels(node, &piece, levels, index, extras);
    node.extras = tinygltf::Value(extras);
    model.nodes.push_back(node);
    if (!is_level)
        model.scenes[0].nodes.push_back(index);
}

// Adds a view of floats that are not attributes.
int add_key_view(tinygltf::Model &model, uint64_t at, uint64_t floats)
{
    tinygltf::BufferView view;
    view.buffer = 0;
    view.byteOffset = size_t(at);
    view.byteLength = size_t(floats * sizeof(float));
    model.bufferViews.push_back(view);
    return int(model.bufferViews.size()) - 1;
}

int add_key_accessor(tinygltf::Model &model, int view, size_t first, size_t count, int numbers)
{
    tinygltf::Accessor accessor;
    accessor.bufferView = view;
    accessor.byteOffset = first * size_t(numbers) * sizeof(float);
    accessor.componentType = TINYGLTF_COMPONENT_TYPE_FLOAT;
    accessor.type = numbers == 1 ? TINYGLTF_TYPE_SCALAR : TINYGLTF_TYPE_VEC3;
    accessor.count = count;
    model.accessors.push_back(accessor);
    return int(model.accessors.size()) - 1;
}

// Finds the accessor of a piece's scales; pieces that begin and end alike share it.
int find_scales(tinygltf::Model &model, int view, const cwi_gltf_piece &piece)
{
    const size_t offset = piece.first_scale * 3 * sizeof(float);
    for (size_t i = 0; i < model.accessors.size(); i++)
        if (model.accessors[i].bufferView == view && model.accessors[i].byteOffset == offset)
            return int(i);
    return add_key_accessor(model, view, piece.first_scale, piece.time_count, 3);
}

// Adds a parent node, which the animation scales, so that the piece's own node stays exact.
// Readers that play no animation show the first piece.
void add_step(tinygltf::Model &model, const cwi_gltf_piece &piece, int child)
{
    tinygltf::Node node;
    node.name = piece.part->name;
    node.children = {child};
    if (child > 0)
        node.scale = {0, 0, 0};
    node.extras = tinygltf::Value(Object{{"time_s", tinygltf::Value(piece.part->time_s)}});
    model.nodes.push_back(node);
    model.scenes[0].nodes.push_back(int(model.nodes.size()) - 1);
}

void add_channel(tinygltf::Animation &animation, int times, int scales, int node)
{
    tinygltf::AnimationSampler sampler;
    sampler.input = times;
    sampler.output = scales;
    sampler.interpolation = "STEP";
    animation.samplers.push_back(sampler);
    tinygltf::AnimationChannel channel;
    channel.sampler = int(animation.samplers.size()) - 1;
    channel.target_node = node;
    channel.target_path = "scale";
    animation.channels.push_back(channel);
}

void add_animation(tinygltf::Model &model, const cwi_gltf_document &document)
{
    const size_t scales = document.scale_count * 3;
    const int scale_view = add_key_view(model, document.keys_at, scales);
    size_t first = 0, total = 0;
    for (size_t p = 0; p < document.count; p++)
        total += document.pieces[p].time_count;
    const int time_view = add_key_view(model, document.keys_at + scales * sizeof(float), total);
    tinygltf::Animation animation;
    animation.name = "steps";
    model.scenes[0].nodes.clear();
    for (size_t p = 0; p < document.count; p++) {
        const cwi_gltf_piece &piece = document.pieces[p];
        const int times = add_key_accessor(model, time_view, first, piece.time_count, 1);
        model.accessors.back().minValues = {double(piece.times[0])};
        model.accessors.back().maxValues = {double(piece.times[piece.time_count - 1])};
        add_step(model, piece, int(p));
        add_channel(animation, times, find_scales(model, scale_view, piece),
                    int(model.nodes.size()) - 1);
        first += piece.time_count;
    }
    model.animations.push_back(animation);
}

void use_extension(tinygltf::Model &model, const char *name)
{
    model.extensionsUsed.push_back(name);
    model.extensionsRequired.push_back(name);
}

void set_asset(tinygltf::Model &model, const cwi_gltf_document &document)
{
    Object provenance;
    model.asset.version = "2.0";
    model.asset.generator = std::string("cubewright ") + CW_VERSION;
    for (size_t i = 0; i < document.provenance_count; i++)
        provenance[document.provenance[i].key] = text(document.provenance[i].value);
    if (!provenance.empty())
        model.asset.extras = tinygltf::Value(provenance);
}

bool has_levels(const cwi_gltf_document &document)
{
    for (size_t p = 0; p < document.count; p++)
        if (document.pieces[p].part->level > 0)
            return true;
    return false;
}

tinygltf::Model make_model(const cwi_gltf_document &document)
{
    tinygltf::Model model;
    set_asset(model, document);
    model.scenes.resize(1);
    model.defaultScene = 0;
    for (size_t p = 0; p < document.count; p++)
        add_piece(model, document, p);
    if (document.end_s > 0)
        add_animation(model, document);
    cwi_gltf_add_images(model, document);
    if (has_levels(document))
        model.extensionsUsed.push_back(GLTF_LOD); // optional for readers
    if (document.quantized)
        use_extension(model, "KHR_mesh_quantization");
    if (document.unpacked)
        use_extension(model, GLTF_MESHOPT);
    if (document.count && document.pieces[0].draco)
        use_extension(model, GLTF_DRACO);
    return model;
}

// Renames extras of views. tinygltf writes extras but no extensions of views; meshopt's are
// written as extras.
void name_extensions(std::string &json)
{
    const std::string from = std::string("\"extras\":{\"") + GLTF_MESHOPT;
    const std::string to = std::string("\"extensions\":{\"") + GLTF_MESHOPT;
    for (size_t at = json.find(from); at != std::string::npos; at = json.find(from, at))
        json.replace(at, from.size(), to);
}

// Checks the offsets of extensions, which tinygltf keeps in 31 bits.
cw_status check_packed(const cwi_gltf_document &document, cw_error *err)
{
    if (document.unpacked && document.bytes > INT32_MAX)
        return cwi_fail(err, CW_ERR_LIMIT, "meshopt's bytes are more than 2 GiB");
    return CW_OK;
}

// Checks that the JSON names the levels of each piece. A quote within a string is escaped, so that
// no name looks like the extension.
cw_status check_levels(const cwi_gltf_document &document, const std::string &json,
                       cw_error *err)
{
    size_t at = 0;
    for (size_t p = 0; p < document.count; p++) {
        if (document.pieces[p].part->level > 0)
            continue;
        const size_t levels = count_levels(document.pieces + p, document.count - p);
        if (levels == 1)
            continue;
        std::string expected = std::string("\"") + GLTF_LOD + "\":{\"ids\":[";
        for (size_t n = 1; n < levels; n++)
            expected += std::to_string(p + n) + (n + 1 < levels ? "," : "]}");
        at = json.find(expected, at);
        if (at == std::string::npos)
            return cwi_fail(err, CW_ERR_BACKEND,
                            "tinygltf left out the %zu levels of detail of '%s'", levels - 1,
                            document.pieces[p].part->name);
        at += expected.size();
    }
    return CW_OK;
}

} // namespace

cw_status cwi_gltf_document_make(const cwi_gltf_document *document, char **json, size_t *size,
                                 cw_error *err)
{
    return cw::guard(err, "tinygltf", [&] {
        cw_status st = check_packed(*document, err);
        if (st != CW_OK)
            return st;
        const tinygltf::Model model = make_model(*document);
        std::ostringstream stream;
        if (!tinygltf::TinyGLTF().WriteGltfSceneToStream(&model, stream, false, false))
            return cwi_fail(err, CW_ERR_BACKEND, "tinygltf could not write the scene");
        std::string words = stream.str();
        while (!words.empty() && words.back() != '}')
            words.pop_back();
        name_extensions(words);
        st = check_levels(*document, words, err);
        if (st != CW_OK)
            return st;
        *size = words.size();
        *json = cwi_strdup(words.c_str());
        return *json ? CW_OK : cwi_fail_memory(err);
    });
}
