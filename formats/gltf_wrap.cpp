// The only file that knows tinygltf: JSON is made of plain numbers, and becomes plain numbers.
// The bytes of buffers pass it by.
#include "formats/gltf_wrap.h"

#include "core/guard.hpp"
#include "core/memory.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>
#include <tiny_gltf.h>
#include <vector>

namespace
{

// --- numbers to JSON ----------------------------------------------------------------------

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

const char *const MESHOPT = "EXT_meshopt_compression";
const char *const DRACO = "KHR_draco_mesh_compression";
const char *const attributes[CWI_GLTF_USES] = {"", "POSITION", "NORMAL", "COLOR_0"};

// Where an array's bytes are. meshopt's are packed; its view is of a buffer that no file has.
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
        view.extras = tinygltf::Value(Object{
            {MESHOPT,
             tinygltf::Value(Object{{"buffer", whole(0)},
                                    {"byteOffset", whole(a.packed_at)},
                                    {"byteLength", whole(a.packed)},
                                    {"byteStride", whole(a.stride)},
                                    {"count", whole(a.count)},
                                    {"mode", text(indices ? "TRIANGLES" : "ATTRIBUTES")}})}});
    model.bufferViews.push_back(view);
    return int(model.bufferViews.size()) - 1;
}

// Draco's accessors say what comes out, and have no view.
int add_accessor(tinygltf::Model &model, const cwi_gltf_piece &piece, const cwi_gltf_array &a)
{
    tinygltf::Accessor accessor;
    accessor.bufferView = piece.draco ? -1 : add_view(model, a);
    accessor.componentType = a.component;
    accessor.type = a.numbers == 1   ? TINYGLTF_TYPE_SCALAR
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
    return tinygltf::Value(Object{{"bufferView", whole(model.bufferViews.size() - 1)},
                                  {"attributes", tinygltf::Value(ids)}});
}

// Vertex colours are multiplied with the base colour, so with them it is white. Pieces that
// look alike share a material.
int find_material(tinygltf::Model &model, const cwi_gltf_piece &piece)
{
    const double grey = piece.part->mesh.colors ? 1.0 : 0.8;
    const std::string mode = piece.translucent ? "BLEND" : "OPAQUE";
    for (size_t i = 0; i < model.materials.size(); i++)
        if (model.materials[i].alphaMode == mode &&
            model.materials[i].pbrMetallicRoughness.baseColorFactor[0] == grey)
            return int(i);
    tinygltf::Material material;
    material.name = "surface";
    material.pbrMetallicRoughness.baseColorFactor = {grey, grey, grey, 1.0};
    material.pbrMetallicRoughness.metallicFactor = 0.0;
    material.pbrMetallicRoughness.roughnessFactor = 0.8;
    material.alphaMode = mode;
    model.materials.push_back(material);
    return int(model.materials.size()) - 1;
}

tinygltf::Value make_extras(const cw_mesh &mesh, const double *origin)
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
    return tinygltf::Value(extras);
}

// LPS millimetres to glTF's metres, +Y up, front towards +Z: (x, y, z) goes to 0.001 (x, z,
// -y). The node does it, so that the vertices stay as they are. Adding 0.0 turns -0 into 0. Of
// a local scene the origin is told, not applied.
tinygltf::Node make_node(const cwi_gltf_piece &piece, const double *local_origin)
{
    const double half = std::sqrt(0.5), scale = 0.001 * piece.step, *t = piece.translation;
    tinygltf::Node node;
    node.name = piece.part->name;
    node.rotation = {-half, 0, 0, half};
    node.scale = {scale, scale, scale};
    if (!local_origin || t[0] != 0 || t[1] != 0 || t[2] != 0)
        node.translation = {0.001 * t[0] + 0.0, 0.001 * t[2] + 0.0, -0.001 * t[1] + 0.0};
    node.extras = make_extras(piece.part->mesh, local_origin);
    return node;
}

void add_piece(tinygltf::Model &model, const cwi_gltf_piece &piece, const double *local_origin)
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
        primitive.extensions[DRACO] = draco_extension(model, piece);
    primitive.material = find_material(model, piece);
    primitive.mode = TINYGLTF_MODE_TRIANGLES;

    tinygltf::Mesh mesh;
    mesh.name = piece.part->name;
    mesh.primitives.push_back(primitive);
    model.meshes.push_back(mesh);
    tinygltf::Node node = make_node(piece, local_origin);
    node.mesh = int(model.meshes.size()) - 1;
    model.nodes.push_back(node);
    model.scenes[0].nodes.push_back(int(model.nodes.size()) - 1);
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

tinygltf::Model make_model(const cwi_gltf_document &document)
{
    tinygltf::Model model;
    set_asset(model, document);
    model.scenes.resize(1);
    model.defaultScene = 0;
    for (size_t p = 0; p < document.count; p++)
        add_piece(model, document.pieces[p], document.local_origin);
    if (document.quantized)
        use_extension(model, "KHR_mesh_quantization");
    if (document.unpacked)
        use_extension(model, MESHOPT);
    if (document.count && document.pieces[0].draco)
        use_extension(model, DRACO);
    return model;
}

// tinygltf writes no extensions of views, but extras: those of meshopt are renamed.
void name_extensions(std::string &json)
{
    const std::string from = std::string("\"extras\":{\"") + MESHOPT;
    const std::string to = std::string("\"extensions\":{\"") + MESHOPT;
    for (size_t at = json.find(from); at != std::string::npos; at = json.find(from, at))
        json.replace(at, from.size(), to);
}

// tinygltf keeps offsets of extensions in 31 bits.
cw_status check_packed(const cwi_gltf_document &document, cw_error *err)
{
    if (document.unpacked && document.bytes > INT32_MAX)
        return cw_fail(err, CW_ERR_LIMIT, "meshopt's bytes are more than 2 GiB");
    return CW_OK;
}

cw_status make_document(const cwi_gltf_document *document, char **json, size_t *size,
                        cw_error *err) noexcept
{
    return cw::guard(err, "tinygltf", [&] {
        const cw_status st = check_packed(*document, err);
        if (st != CW_OK)
            return st;
        const tinygltf::Model model = make_model(*document);
        std::ostringstream stream;
        if (!tinygltf::TinyGLTF().WriteGltfSceneToStream(&model, stream, false, false))
            return cw_fail(err, CW_ERR_BACKEND, "tinygltf could not write the scene");
        std::string words = stream.str();
        while (!words.empty() && words.back() != '}')
            words.pop_back();
        name_extensions(words);
        *size = words.size();
        *json = cwi_strdup(words.c_str());
        return *json ? CW_OK : cw_fail(err, CW_ERR_NO_MEMORY, "no memory for the JSON");
    });
}

// --- JSON to numbers ----------------------------------------------------------------------

// Arrays go to C: ours frees them, even those of a scene that was not finished.
template <typename T> cw_status allocate(T *&array, size_t &count, size_t wanted, cw_error *err)
{
    array = static_cast<T *>(cwi_alloc_zeroed(wanted, sizeof(T)));
    count = array ? wanted : 0;
    return array ? CW_OK : cw_fail(err, CW_ERR_NO_MEMORY, "no memory for the scene");
}

cw_status fail_model(cw_error *err, std::string words)
{
    std::replace(words.begin(), words.end(), '\n', ' ');
    return cw_fail(err, CW_ERR_FORMAT, "the glTF is not valid: %.400s", words.c_str());
}

// A member of what may be no object.
const tinygltf::Value &member(const tinygltf::Value &from, const char *key)
{
    static const tinygltf::Value none;
    return from.IsObject() ? from.Get(key) : none;
}

// What cwi_gltf_blind() left of "buffers": a list of objects, in "extras". Their 'byteLength'
// is not looked at: what counts is how long they are.
cw_status copy_buffers(const tinygltf::Value &list, cwi_gltf_scene &scene, cw_error *err)
{
    const size_t count = list.IsArray() ? list.ArrayLen() : 0;
    cw_status st = allocate(scene.buffers, scene.buffer_count, count, err);
    for (size_t i = 0; i < scene.buffer_count && st == CW_OK; i++) {
        const tinygltf::Value &uri = member(list.Get(int(i)), "uri");
        if (!uri.IsString())
            continue;
        scene.buffers[i].uri = cwi_strdup(uri.Get<std::string>().c_str());
        if (!scene.buffers[i].uri)
            st = cw_fail(err, CW_ERR_NO_MEMORY, "no memory for the scene");
    }
    return st;
}

// A whole number from 0 on; anything else becomes more than there can be.
uint64_t number_of(const tinygltf::Value &value)
{
    const double number = value.IsNumber() ? value.GetNumberAsDouble() : -1;
    return number >= 0 && number < 9e15 ? uint64_t(number) : UINT64_MAX / 2;
}

int id_of(const tinygltf::Value &value)
{
    const uint64_t id = number_of(value);
    return id < INT32_MAX ? int(id) : -1;
}

int choice_of(const tinygltf::Value &value, const std::vector<std::string> &names)
{
    const std::string name = value.IsString() ? value.Get<std::string>() : names[0];
    const auto found = std::find(names.begin(), names.end(), name);
    return found == names.end() ? -1 : int(found - names.begin());
}

void copy_packed(const tinygltf::BufferView &from, cwi_gltf_view &to)
{
    const auto found = from.extensions.find(MESHOPT);
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

// Numbers of an element; matrices are of no use.
int numbers_of(int type)
{
    if (type == TINYGLTF_TYPE_SCALAR)
        return 1;
    return type >= TINYGLTF_TYPE_VEC2 && type <= TINYGLTF_TYPE_VEC4 ? type : 0;
}

cw_status copy_accessors(const tinygltf::Model &model, cwi_gltf_scene &scene, cw_error *err)
{
    const cw_status st =
        allocate(scene.accessors, scene.accessor_count, model.accessors.size(), err);
    for (size_t i = 0; i < scene.accessor_count; i++) {
        const tinygltf::Accessor &from = model.accessors[i];
        scene.accessors[i] = {from.bufferView,     from.byteOffset,       from.count,
                              from.componentType,  numbers_of(from.type), from.normalized,
                              from.sparse.isSparse};
    }
    return st;
}

int find_attribute(const tinygltf::Primitive &primitive, const char *name)
{
    const auto found = primitive.attributes.find(name);
    return found == primitive.attributes.end() ? -1 : found->second;
}

void copy_primitive(const tinygltf::Primitive &from, cwi_gltf_primitive &to)
{
    to.mode = from.mode < 0 ? TINYGLTF_MODE_TRIANGLES : from.mode;
    to.indices = from.extras.IsNumber() ? id_of(from.extras) : -1; // see cwi_gltf_blind()
    to.position = find_attribute(from, "POSITION");
    to.normal = find_attribute(from, "NORMAL");
    to.color = find_attribute(from, "COLOR_0");
    to.draco = -1;
    const auto found = from.extensions.find(DRACO);
    if (found == from.extensions.end())
        return;
    const tinygltf::Value &ids = member(found->second, "attributes");
    to.draco = id_of(member(found->second, "bufferView"));
    to.draco_position = id_of(member(ids, "POSITION"));
    to.draco_normal = id_of(member(ids, "NORMAL"));
    to.draco_color = id_of(member(ids, "COLOR_0"));
}

cw_status copy_meshes(const tinygltf::Model &model, cwi_gltf_scene &scene, cw_error *err)
{
    size_t count = 0;
    cw_status st = allocate(scene.meshes, scene.mesh_count, model.meshes.size(), err);
    for (size_t i = 0; i < scene.mesh_count; i++) {
        scene.meshes[i] = {count, count + model.meshes[i].primitives.size()};
        count = scene.meshes[i].end;
    }
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

// The numbers of an array of that many; false, and the old ones left, for anything else.
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

// What make_extras() wrote.
void copy_extras(const tinygltf::Value &extras, cwi_gltf_node &node)
{
    const tinygltf::Value &frame = member(extras, "frame"), &unit = member(extras, "unit");
    node.lps = frame.IsString() && frame.Get<std::string>() == "LPS" && unit.IsString() &&
               unit.Get<std::string>() == "mm";
    node.has_origin = node.lps && copy_numbers(member(extras, "origin"), node.origin, 3);
    node.has_affine = node.lps && copy_numbers(member(extras, "affine"), node.affine[0], 12);
}

// Translation times rotation times scale. The quaternion need not have unit length.
void set_matrix(const tinygltf::Node &from, double to[3][4])
{
    const std::vector<double> &m = from.matrix, &t = from.translation, &s = from.scale;
    const std::vector<double> q =
        from.rotation.empty() ? std::vector<double>{0, 0, 0, 1} : from.rotation;
    const double f = 2 / (q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    const double rotation[3][3] = {
        {1 - f * (q[1] * q[1] + q[2] * q[2]), f * (q[0] * q[1] - q[2] * q[3]),
         f * (q[0] * q[2] + q[1] * q[3])},
        {f * (q[0] * q[1] + q[2] * q[3]), 1 - f * (q[0] * q[0] + q[2] * q[2]),
         f * (q[1] * q[2] - q[0] * q[3])},
        {f * (q[0] * q[2] - q[1] * q[3]), f * (q[1] * q[2] + q[0] * q[3]),
         1 - f * (q[0] * q[0] + q[1] * q[1])}};
    for (size_t r = 0; r < 3; r++)
        for (size_t c = 0; c < 4; c++)
            to[r][c] = !m.empty()  ? m[4 * c + r]
                       : c < 3     ? rotation[r][c] * (s.empty() ? 1 : s[c])
                       : t.empty() ? 0
                                   : t[r];
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
        return cw_fail(err, CW_ERR_FORMAT,
                       "'matrix', 'translation', 'rotation' or 'scale' of node %zu has not as "
                       "many numbers as it must",
                       index);
    if (!from.matrix.empty() && (from.matrix[3] != 0 || from.matrix[7] != 0 ||
                                 from.matrix[11] != 0 || from.matrix[15] != 1))
        return cw_fail(err, CW_ERR_FORMAT, "'matrix' of node %zu is not affine", index);
    to.mesh = from.mesh;
    set_matrix(from, to.local);
    copy_extras(from.extras, to);
    return CW_OK;
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

// The scene to show; without any scene, every node that is no other's child.
cw_status copy_roots(const tinygltf::Model &model, cwi_gltf_scene &scene, cw_error *err)
{
    std::vector<int> roots;
    const int shown = std::max(model.defaultScene, 0);
    if (size_t(shown) < model.scenes.size()) {
        roots = model.scenes[size_t(shown)].nodes;
    } else if (model.defaultScene >= 0 || !model.scenes.empty()) {
        return cw_fail(err, CW_ERR_FORMAT, "'scene' is %d; there are %zu scenes", shown,
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

// Extensions that change how a scene looks, but not where its triangles are, do no harm.
cw_status check_extensions(const tinygltf::Model &model, cw_error *err)
{
    const std::vector<std::string> harmless = {"KHR_mesh_quantization",
                                               MESHOPT,
                                               DRACO,
                                               "KHR_texture_transform",
                                               "KHR_texture_basisu",
                                               "KHR_lights_punctual",
                                               "EXT_texture_webp"};
    for (const std::string &name : model.extensionsRequired)
        if (name.compare(0, 14, "KHR_materials_") != 0 &&
            std::find(harmless.begin(), harmless.end(), name) == harmless.end())
            return cw_fail(err, CW_ERR_UNSUPPORTED,
                           "the file requires the extension '%.100s', which is not read",
                           name.c_str());
    return CW_OK;
}

bool ignore_image(tinygltf::Image *, int, std::string *, std::string *, int, int,
                  const unsigned char *, int, void *)
{
    return true;
}

cw_status parse_scene(const char *json, size_t size, cwi_gltf_scene *scene,
                      cw_error *err) noexcept
{
    return cw::guard(err, "tinygltf", [&] {
        tinygltf::TinyGLTF loader;
        tinygltf::Model model;
        std::string words, warning;
        loader.SetImageLoader(ignore_image, nullptr);
        loader.SetFsCallbacks({});   // it opens no file
        model.asset.version.clear(); // not what it takes for granted
        const bool done =
            loader.LoadASCIIFromString(&model, &words, &warning, json, unsigned(size), "", 0);
        if (!done || !words.empty()) // what is broken it may leave out, and go on
            return fail_model(err, words);
        if (model.asset.version.compare(0, 2, "2.") != 0)
            return cw_fail(err, CW_ERR_FORMAT, "'asset.version' is '%.20s'; 2.0 was expected",
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
        return st;
    });
}

} // namespace

extern "C" const cwi_gltf_functions cwi_module_gltf = {make_document, parse_scene};
