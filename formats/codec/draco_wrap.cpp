// Wraps Draco's encoder and decoder; this is the only file that uses Draco.
#include "formats/codec/draco_wrap.h"

#include "core/base/guard.hpp"
#include "core/base/memory.h"

#include <draco/attributes/attribute_quantization_transform.h>
#include <draco/compression/decode.h>
#include <draco/compression/encode.h>

#include <cmath>
#include <cstdio>
#include <cstring>
#include <memory>
#include <string>

namespace
{

// The maximum memory that Draco allocates by itself, per triangle.
enum { TRIANGLE_BYTES = 100 };

enum { COLOR_BITS = 8 };

// Returns the maximum memory of its table of symbols, which has an entry for each number that a
// coordinate can differ from its prediction.
size_t table_bytes(const cwi_quantization_grid &grid)
{
    return grid.bits ? sizeof(int) << grid.bits : 0;
}

// The key of a comment in the metadata.
const char COMMENT[] = "cubewright";

cw_status fail_draco(cw_error *err, cw_status status, const char *what,
                     const draco::Status &said)
{
    return cwi_fail(err, status, "Draco could not %s: %.200s", what, said.error_msg());
}

// --- encoding ------------------------------------------------------------------------------

// Adds an attribute with one value per point, in their order.
int add_attribute(draco::Mesh &mesh, draco::GeometryAttribute::Type type, draco::DataType kind,
                  int numbers, bool normalized, const void *values, size_t count)
{
    const size_t size = size_t(numbers) * size_t(draco::DataTypeLength(kind));
    draco::GeometryAttribute attribute;
    attribute.Init(type, nullptr, int8_t(numbers), kind, normalized, int64_t(size), 0);
    const int id = mesh.AddAttribute(attribute, true, uint32_t(count));
    for (size_t i = 0; i < count; i++)
        mesh.attribute(id)->SetAttributeValue(draco::AttributeValueIndex(uint32_t(i)),
                                              static_cast<const char *>(values) + i * size);
    return int(mesh.attribute(id)->unique_id());
}

void add_faces(draco::Mesh &mesh, const cwi_arrays &from)
{
    mesh.SetNumFaces(from.triangle_count);
    for (size_t t = 0; t < from.triangle_count; t++) {
        const uint32_t *c = from.triangles + 3 * t;
        mesh.SetFace(
            draco::FaceIndex(uint32_t(t)),
            {{draco::PointIndex(c[0]), draco::PointIndex(c[1]), draco::PointIndex(c[2])}});
    }
}

// Prints all digits of a number in any locale: as an integer times a power of two.
std::string print_exactly(float value)
{
    int exponent;
    const float mantissa = std::frexp(value, &exponent);
    char text[40];
    snprintf(text, sizeof text, "%s0x%lxp%d", value < 0 ? "-" : "",
             std::lround(std::ldexp(std::fabs(mantissa), 24)), exponent - 24);
    return text;
}

// Builds the options of the grid. Draco's own SetAttributeExplicitQuantization() passes it on
// as text of six decimals, so the encoder would round to a different grid.
draco::Options position_options(const cwi_quantization_grid &grid)
{
    draco::Options options;
    options.SetInt("quantization_bits", grid.bits);
    options.SetString("quantization_origin", print_exactly(grid.origin[0]) + ' ' +
                                                 print_exactly(grid.origin[1]) + ' ' +
                                                 print_exactly(grid.origin[2]));
    options.SetString("quantization_range", print_exactly(grid.range));
    return options;
}

void set_options(draco::Encoder &encoder, const cwi_draco_settings &s, bool on_grid)
{
    encoder.SetSpeedOptions(10 - s.level, 10 - s.level);
    encoder.SetEncodingMethod(draco::MESH_EDGEBREAKER_ENCODING);
    if (on_grid)
        encoder.options().SetAttributeOptions(draco::GeometryAttribute::POSITION,
                                              position_options(s.grid));
    encoder.SetAttributeQuantization(draco::GeometryAttribute::NORMAL, s.normal_bits);
    encoder.SetAttributeQuantization(draco::GeometryAttribute::COLOR, COLOR_BITS);
    if (s.texture_bits)
        encoder.SetAttributeQuantization(draco::GeometryAttribute::TEX_COORD, s.texture_bits);
    if (s.tangent_bits)
        encoder.SetAttributeQuantization(draco::GeometryAttribute::GENERIC, s.tangent_bits);
}

cw_status encode(const cwi_arrays *from, const cwi_draco_settings *settings,
                 unsigned char **bytes, size_t *size, cwi_draco_ids *ids,
                 cw_error *err) noexcept
{
    return cw::guard(err, "Draco", [&] {
        const cw::Taken taken(TRIANGLE_BYTES * from->triangle_count +
                              table_bytes(settings->grid));
        draco::Mesh mesh;
        draco::Encoder encoder;
        draco::EncoderBuffer buffer;
        const size_t count = from->vertex_count;
        *ids = {-1, -1, -1, -1, -1};
        mesh.set_num_points(uint32_t(count));
        add_faces(mesh, *from);
        // Neuroglancer takes no other integers than signed ones of 32 bits.
        ids->position =
            from->positions
                ? add_attribute(mesh, draco::GeometryAttribute::POSITION, draco::DT_FLOAT32, 3,
                                false, from->positions, count)
                : add_attribute(mesh, draco::GeometryAttribute::POSITION, draco::DT_INT32, 3,
                                false, from->grid_points, count);
        if (from->normals)
            ids->normal = add_attribute(mesh, draco::GeometryAttribute::NORMAL,
                                        draco::DT_FLOAT32, 3, false, from->normals, count);
        if (from->colors)
            ids->color = add_attribute(mesh, draco::GeometryAttribute::COLOR, draco::DT_UINT8,
                                       4, true, from->colors, count);
        if (from->texture)
            ids->texture = add_attribute(mesh, draco::GeometryAttribute::TEX_COORD,
                                         draco::DT_FLOAT32, 2, false, from->texture, count);
        if (from->tangents)
            ids->tangent = add_attribute(mesh, draco::GeometryAttribute::GENERIC,
                                         draco::DT_FLOAT32, 4, false, from->tangents, count);
        if (settings->comment) {
            auto metadata = std::make_unique<draco::GeometryMetadata>();
            metadata->AddEntryString(COMMENT, settings->comment);
            mesh.AddMetadata(std::move(metadata));
        }
        set_options(encoder, *settings, settings->grid.bits > 0);
        const draco::Status done = encoder.EncodeMeshToBuffer(mesh, &buffer);
        if (!done.ok())
            return fail_draco(err, CW_ERR_BACKEND, "encode the mesh", done);
        *size = buffer.size();
        *bytes = static_cast<unsigned char *>(cwi_alloc_array(buffer.size(), 1));
        if (!*bytes)
            return cwi_fail_memory(err);
        std::memcpy(*bytes, buffer.data(), buffer.size());
        return CW_OK;
    });
}

// --- decoding ------------------------------------------------------------------------------

template <typename T> bool allocate(T *&array, size_t count, size_t numbers)
{
    array = static_cast<T *>(cwi_alloc_array(count, numbers * sizeof(T)));
    return array != nullptr;
}

const draco::PointAttribute *find(const draco::Mesh &mesh, int id, int numbers)
{
    const draco::PointAttribute *found =
        id >= 0 ? mesh.GetAttributeByUniqueId(uint32_t(id)) : nullptr;
    return found && found->num_components() >= numbers ? found : nullptr;
}

// Finds the first attribute of a kind, where the caller names none.
int find_first(const draco::Mesh &mesh, draco::GeometryAttribute::Type type, int numbers)
{
    const draco::PointAttribute *found = mesh.GetNamedAttribute(type);
    return found && found->num_components() >= numbers && found->num_components() <= 4
               ? int(found->unique_id())
               : -1;
}

cwi_draco_ids find_all(const draco::Mesh &mesh)
{
    return {find_first(mesh, draco::GeometryAttribute::POSITION, 3),
            find_first(mesh, draco::GeometryAttribute::NORMAL, 3),
            find_first(mesh, draco::GeometryAttribute::COLOR, 3),
            find_first(mesh, draco::GeometryAttribute::TEX_COORD, 2), -1};
}

// Copies some numbers of each point; returns false where one has no value.
template <int numbers, typename T>
bool copy_numbers(const draco::PointAttribute &from, size_t count, T *to)
{
    for (size_t i = 0; i < count; i++) {
        const draco::AttributeValueIndex at = from.mapped_index(draco::PointIndex(uint32_t(i)));
        if (at.value() >= from.size() || !from.ConvertValue<T, numbers>(at, to + numbers * i))
            return false;
    }
    return true;
}

// Returns true if integer positions are on this grid.
bool is_on_grid(const draco::PointAttribute &positions, const cwi_quantization_grid &grid)
{
    draco::AttributeQuantizationTransform is;
    return is.InitFromAttribute(positions) && is.quantization_bits() == grid.bits &&
           is.range() == grid.range && is.min_value(0) == grid.origin[0] &&
           is.min_value(1) == grid.origin[1] && is.min_value(2) == grid.origin[2];
}

// Copies colours as fractions of the maximum, from integers or floats.
bool copy_colors(const draco::PointAttribute &from, size_t count, uint8_t *to)
{
    const bool real = from.data_type() == draco::DT_FLOAT32;
    const double max = real ? 1 : from.data_type() == draco::DT_UINT16 ? 65535 : 255;
    for (size_t i = 0; i < count; i++) {
        const draco::AttributeValueIndex at = from.mapped_index(draco::PointIndex(uint32_t(i)));
        uint32_t whole[4] = {0, 0, 0, uint32_t(max)};
        float scaled[4] = {0, 0, 0, 1};
        if (at.value() >= from.size() ||
            !(real ? from.ConvertValue<float>(at, int8_t(from.num_components()), scaled)
                   : from.ConvertValue<uint32_t>(at, int8_t(from.num_components()), whole)))
            return false;
        for (int c = 0; c < 4; c++) {
            const double value = (real ? double(scaled[c]) : double(whole[c])) / max;
            to[4 * i + size_t(c)] = value >= 1  ? 255
                                    : value > 0 ? uint8_t(std::lround(255 * value))
                                                : 0;
        }
    }
    return true;
}

// Copies the faces. Draco 1.5.5 was seen to accept meshes that name points they do not have.
bool copy_faces(const draco::Mesh &mesh, uint32_t *to)
{
    for (uint32_t t = 0; t < mesh.num_faces(); t++)
        for (size_t c = 0; c < 3; c++) {
            const uint32_t point = mesh.face(draco::FaceIndex(t))[c].value();
            if (point >= mesh.num_points())
                return false;
            *to++ = point;
        }
    return true;
}

cw_status copy_mesh(const draco::Mesh &mesh, const cwi_draco_ids &ids,
                    const cwi_quantization_grid *grid, cwi_arrays &to, cw_error *err)
{
    const draco::PointAttribute *positions = find(mesh, ids.position, 3),
                                *normals = find(mesh, ids.normal, 3),
                                *colors = find(mesh, ids.color, 3),
                                *texture = find(mesh, ids.texture, 2),
                                *tangents = find(mesh, ids.tangent, 4);
    const size_t count = mesh.num_points();
    if (!positions || (ids.normal >= 0 && !normals) || (ids.color >= 0 && !colors) ||
        (ids.texture >= 0 && !texture) || (ids.tangent >= 0 && !tangents) ||
        (colors && colors->num_components() > 4))
        return cwi_fail(err, CW_ERR_FORMAT, "the Draco data lack an attribute that is named");
    if (grid && !is_on_grid(*positions, *grid))
        return cwi_fail(err, CW_ERR_CHECK,
                        "Draco encoded positions on another grid than asked");
    std::string comment;
    if (mesh.GetMetadata() && mesh.GetMetadata()->GetEntryString(COMMENT, &comment))
        snprintf(to.comment, sizeof to.comment, "%s", comment.c_str());
    to.vertex_count = count;
    to.triangle_count = mesh.num_faces();
    if (!(grid ? allocate(to.grid_points, count, 3) : allocate(to.positions, count, 3)) ||
        !allocate(to.triangles, to.triangle_count, 3) ||
        (normals && !allocate(to.normals, count, 3)) ||
        (colors && !allocate(to.colors, count, 4)) ||
        (texture && !allocate(to.texture, count, 2)) ||
        (tangents && !allocate(to.tangents, count, 4)))
        return cwi_fail_memory(err);
    if (!(grid ? copy_numbers<3>(*positions, count, to.grid_points)
               : copy_numbers<3>(*positions, count, to.positions)) ||
        !copy_faces(mesh, to.triangles) ||
        (normals && !copy_numbers<3>(*normals, count, to.normals)) ||
        (colors && !copy_colors(*colors, count, to.colors)) ||
        (texture && !copy_numbers<2>(*texture, count, to.texture)) ||
        (tangents && !copy_numbers<4>(*tangents, count, to.tangents)))
        return cwi_fail(err, CW_ERR_FORMAT, "the Draco data name points that are not there");
    return CW_OK;
}

cw_status decode(const void *bytes, size_t size, const cwi_draco_ids *ids, size_t max,
                 const cwi_quantization_grid *grid, cwi_arrays *arrays, cw_error *err) noexcept
{
    return cw::guard(err, "Draco", [&] {
        draco::DecoderBuffer buffer;
        buffer.Init(static_cast<const char *>(bytes), size);
        const auto kind = draco::Decoder::GetEncodedGeometryType(&buffer);
        if (kind.ok() && kind.value() == draco::POINT_CLOUD)
            return cwi_fail(err, CW_ERR_FORMAT, "the Draco data are a point cloud, not a mesh");
        draco::Decoder decoder;
        if (grid)
            decoder.SetSkipAttributeTransform(draco::GeometryAttribute::POSITION);
        auto decoded = decoder.DecodeMeshFromBuffer(&buffer);
        if (!decoded.ok())
            return fail_draco(err, CW_ERR_FORMAT, "decode the data", decoded.status());
        const std::unique_ptr<draco::Mesh> mesh = std::move(decoded).value();
        if (mesh->num_points() > max || mesh->num_faces() > max)
            return cwi_fail(err, CW_ERR_LIMIT, "the Draco data hold %u triangles",
                            mesh->num_faces());
        return copy_mesh(*mesh, ids ? *ids : find_all(*mesh), grid, *arrays, err);
    });
}

} // namespace

const cwi_draco_functions cwi_module_draco = {encode, decode};
