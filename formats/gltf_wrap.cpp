// The only file that knows tinygltf. A mesh becomes a model of one scene, one node, one mesh;
// and JSON becomes plain numbers.
#include "formats/gltf_wrap.h"

#include "core/guard.hpp"
#include "core/memory.h"

#include <algorithm>
#include <cmath>
#include <ostream>
#include <streambuf>
#include <string>
#include <tiny_gltf.h>
#include <vector>

namespace
{

// Hands bytes to the outfile, a megabyte at a time so that a cancel is heard. Stops at the
// first error and keeps it: a stream only knows that something went wrong.
class OutfileBuffer : public std::streambuf
{
public:
    OutfileBuffer(cwi_mesh_output *out, cw_error *err) : out_(out), err_(err)
    {
    }
    cw_status status() const
    {
        return status_;
    }

protected:
    std::streamsize xsputn(const char *bytes, std::streamsize size) override
    {
        std::streamsize written = 0;
        while (written < size && status_ == CW_OK) {
            const std::streamsize step = std::min(size - written, std::streamsize(1 << 20));
            write(bytes + written, static_cast<size_t>(step));
            written += status_ == CW_OK ? step : 0;
        }
        return written;
    }

    int_type overflow(int_type c) override
    {
        const char byte = traits_type::to_char_type(c);
        return xsputn(&byte, 1) == 1 ? c : traits_type::eof();
    }

private:
    void write(const char *bytes, size_t size)
    {
        status_ = cwi_outfile_write(out_->file, bytes, size, err_);
        out_->done = std::min(out_->done + size, out_->total);
        if (status_ == CW_OK)
            status_ = cwi_progress(out_->progress, "writing",
                                   double(out_->done) / double(out_->total), err_);
    }

    cwi_mesh_output *out_;
    cw_error *err_;
    cw_status status_ = CW_OK;
};

// One array of the buffer; every one starts at a multiple of 4 bytes, as accessors demand.
struct Part {
    const char *attribute; // nullptr for the indices
    size_t count, element_bytes;
    int component, type;
    size_t offset = 0;

    size_t bytes() const
    {
        return count * element_bytes;
    }
};

// 65535 as a 16-bit index means "restart" and must not name a vertex.
bool has_short_indices(const cw_mesh &mesh)
{
    return mesh.vertex_count <= 65535;
}

std::vector<Part> plan_parts(const cw_mesh &mesh)
{
    const bool is_short = has_short_indices(mesh);
    std::vector<Part> parts = {
        {nullptr, 3 * mesh.triangle_count, is_short ? size_t(2) : size_t(4),
         is_short ? TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT
                  : TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT,
         TINYGLTF_TYPE_SCALAR},
        {"POSITION", mesh.vertex_count, 12, TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_VEC3}};
    if (mesh.normals)
        parts.push_back({"NORMAL", mesh.vertex_count, 12, TINYGLTF_COMPONENT_TYPE_FLOAT,
                         TINYGLTF_TYPE_VEC3});
    if (mesh.colors)
        parts.push_back({"COLOR_0", mesh.vertex_count, 4, TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE,
                         TINYGLTF_TYPE_VEC4});
    size_t offset = 0;
    for (Part &part : parts) {
        part.offset = offset;
        offset += (part.bytes() + 3) / 4 * 4;
    }
    return parts;
}

// GLB says its lengths in 32 bits; the JSON in front takes a few kilobytes of that.
cw_status check_size(const cw_mesh &mesh, cw_error *err)
{
    const double limit = 4294967295.0 - 65536.0;
    const double bytes =
        12.0 * double(mesh.triangle_count) +
        (12.0 + (mesh.normals ? 12 : 0) + (mesh.colors ? 4 : 0)) * double(mesh.vertex_count);
    if (mesh.vertex_count >= UINT32_MAX || bytes > limit)
        return cw_fail(err, CW_ERR_LIMIT, "glTF holds at most 4 GiB; the mesh needs %.1f GiB",
                       bytes / 1073741824.0);
    return CW_OK;
}

unsigned char *put_indices(unsigned char *to, const cw_mesh &mesh)
{
    const bool is_short = has_short_indices(mesh);
    for (size_t i = 0; i < 3 * mesh.triangle_count; i++)
        to = is_short ? cwi_put_u16(to, uint16_t(mesh.triangles[i]))
                      : cwi_put_u32(to, mesh.triangles[i]);
    return to;
}

void put_floats(unsigned char *to, const float *values, size_t count)
{
    for (size_t i = 0; i < count; i++)
        to = cwi_put_f32(to, values[i]);
}

// COLOR_0 is linear; alpha is linear already.
void put_colors(unsigned char *to, const cw_mesh &mesh)
{
    unsigned char linear[256];
    for (int i = 0; i < 256; i++) {
        const double c = i / 255.0;
        linear[i] = static_cast<unsigned char>(
            std::lround(255 * (c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4))));
    }
    for (size_t i = 0; i < 4 * mesh.vertex_count; i++)
        to[i] = i % 4 == 3 ? mesh.colors[i] : linear[mesh.colors[i]];
}

tinygltf::Buffer make_buffer(const cw_mesh &mesh, const std::vector<Part> &parts)
{
    tinygltf::Buffer buffer;
    buffer.data.resize(parts.back().offset + parts.back().bytes());
    for (const Part &part : parts) {
        unsigned char *to = buffer.data.data() + part.offset;
        const std::string attribute = part.attribute ? part.attribute : "";
        if (attribute == "POSITION")
            put_floats(to, mesh.positions, 3 * part.count);
        else if (attribute == "NORMAL")
            put_floats(to, mesh.normals, 3 * part.count);
        else if (attribute == "COLOR_0")
            put_colors(to, mesh);
        else
            put_indices(to, mesh);
    }
    return buffer;
}

// The format wants the box of the stored floats, to the bit; doubles hold them and the JSON
// writer gives each the digits that bring it back.
void set_bounds(tinygltf::Accessor &accessor, const cw_mesh &mesh)
{
    for (size_t a = 0; a < 3; a++) {
        float low = mesh.positions[a], high = low;
        for (size_t v = 1; v < mesh.vertex_count; v++) {
            low = std::min(low, mesh.positions[3 * v + a]);
            high = std::max(high, mesh.positions[3 * v + a]);
        }
        accessor.minValues.push_back(double(low));
        accessor.maxValues.push_back(double(high));
    }
}

int add_accessor(tinygltf::Model &model, const cw_mesh &mesh, const Part &part)
{
    tinygltf::BufferView view;
    view.buffer = 0;
    view.byteOffset = part.offset;
    view.byteLength = part.bytes();
    view.target =
        part.attribute ? TINYGLTF_TARGET_ARRAY_BUFFER : TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER;
    model.bufferViews.push_back(view);

    tinygltf::Accessor accessor;
    accessor.bufferView = int(model.bufferViews.size()) - 1;
    accessor.componentType = part.component;
    accessor.type = part.type;
    accessor.count = part.count;
    accessor.normalized = part.component == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE;
    if (part.attribute && std::string(part.attribute) == "POSITION")
        set_bounds(accessor, mesh);
    model.accessors.push_back(accessor);
    return int(model.accessors.size()) - 1;
}

bool is_translucent(const cw_mesh &mesh)
{
    for (size_t v = 0; mesh.colors && v < mesh.vertex_count; v++)
        if (mesh.colors[4 * v + 3] != 255)
            return true;
    return false;
}

// Vertex colours are multiplied with the base colour, so with them it is white.
tinygltf::Material make_material(const cw_mesh &mesh)
{
    const double grey = mesh.colors ? 1.0 : 0.8;
    tinygltf::Material material;
    material.name = "surface";
    material.pbrMetallicRoughness.baseColorFactor = {grey, grey, grey, 1.0};
    material.pbrMetallicRoughness.metallicFactor = 0.0;
    material.pbrMetallicRoughness.roughnessFactor = 0.8;
    material.alphaMode = is_translucent(mesh) ? "BLEND" : "OPAQUE";
    return material;
}

tinygltf::Value make_extras(const cw_mesh &mesh, const double *origin)
{
    tinygltf::Value::Object extras = {{"frame", tinygltf::Value(std::string("LPS"))},
                                      {"unit", tinygltf::Value(std::string("mm"))}};
    tinygltf::Value::Array affine;
    bool has_affine = false;
    for (const double(&row)[4] : mesh.affine)
        for (double number : row) {
            affine.push_back(tinygltf::Value(number));
            has_affine = has_affine || number != 0;
        }
    if (has_affine)
        extras["affine"] = tinygltf::Value(affine);
    if (origin)
        extras["origin"] = tinygltf::Value(tinygltf::Value::Array{tinygltf::Value(origin[0]),
                                                                  tinygltf::Value(origin[1]),
                                                                  tinygltf::Value(origin[2])});
    return tinygltf::Value(extras);
}

// LPS millimetres to glTF's metres, +Y up, front towards +Z: (x, y, z) goes to 0.001 (x, z,
// -y). The node does it, so that the vertices stay as they are. Adding 0.0 turns -0 into 0. A
// local scene is not moved: its origin is told, not applied.
tinygltf::Node make_node(const cw_mesh &mesh, const cwi_mesh_output &out)
{
    const double half = std::sqrt(0.5);
    tinygltf::Node node;
    node.name = out.name;
    node.mesh = 0;
    node.rotation = {-half, 0, 0, half};
    node.scale = {0.001, 0.001, 0.001};
    if (!out.local_origin)
        node.translation = {0.001 * mesh.origin[0] + 0.0, 0.001 * mesh.origin[2] + 0.0,
                            -0.001 * mesh.origin[1] + 0.0};
    node.extras = make_extras(mesh, out.local_origin);
    return node;
}

tinygltf::Model make_model(const cw_mesh &mesh, const cwi_mesh_output &out)
{
    tinygltf::Model model;
    tinygltf::Primitive primitive;
    const std::vector<Part> parts = plan_parts(mesh);
    model.asset.version = "2.0";
    model.asset.generator = std::string("cubewright ") + CW_VERSION;
    for (const Part &part : parts) {
        const int accessor = add_accessor(model, mesh, part);
        if (part.attribute)
            primitive.attributes[part.attribute] = accessor;
        else
            primitive.indices = accessor;
    }
    primitive.material = 0;
    primitive.mode = TINYGLTF_MODE_TRIANGLES;

    tinygltf::Mesh named;
    named.name = out.name;
    named.primitives.push_back(primitive);
    tinygltf::Scene scene;
    scene.nodes.push_back(0);
    model.meshes.push_back(named);
    model.materials.push_back(make_material(mesh));
    model.nodes.push_back(make_node(mesh, out));
    model.scenes.push_back(scene);
    model.defaultScene = 0;
    model.buffers.push_back(make_buffer(mesh, parts));
    return model;
}

cw_status write_scene(const cw_mesh *mesh, cwi_mesh_output *out, bool binary,
                      cw_error *err) noexcept
{
    return cw::guard(err, "tinygltf", [&] {
        const cw_status st = check_size(*mesh, err);
        if (st != CW_OK)
            return st;
        const tinygltf::Model model = make_model(*mesh, *out);
        const size_t bytes = model.buffers[0].data.size();
        out->total = binary ? bytes : bytes + bytes / 3;
        OutfileBuffer buffer(out, err);
        std::ostream stream(&buffer);
        const bool done =
            tinygltf::TinyGLTF().WriteGltfSceneToStream(&model, stream, !binary, binary);
        if (buffer.status() != CW_OK)
            return buffer.status();
        if (!done || !stream)
            return cw_fail(err, CW_ERR_BACKEND, "tinygltf could not write the scene");
        return CW_OK;
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

cw_status copy_views(const tinygltf::Model &model, cwi_gltf_scene &scene, cw_error *err)
{
    const cw_status st = allocate(scene.views, scene.view_count, model.bufferViews.size(), err);
    for (size_t i = 0; i < scene.view_count; i++) {
        const tinygltf::BufferView &from = model.bufferViews[i];
        scene.views[i] = {from.buffer, from.byteOffset, from.byteLength, from.byteStride};
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
            *to++ = {from.mode < 0 ? TINYGLTF_MODE_TRIANGLES : from.mode, from.indices,
                     find_attribute(from, "POSITION"), find_attribute(from, "NORMAL"),
                     find_attribute(from, "COLOR_0")};
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
    const std::vector<std::string> harmless = {"KHR_mesh_quantization", "KHR_texture_transform",
                                               "KHR_texture_basisu", "KHR_lights_punctual",
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

extern "C" const cwi_gltf_functions cwi_module_gltf = {write_scene, parse_scene};
