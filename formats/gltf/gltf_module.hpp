// The interface between the parts of the module "gltf", the only files that use tinygltf.
#ifndef FORMATS_GLTF_GLTF_MODULE_HPP
#define FORMATS_GLTF_GLTF_MODULE_HPP

#include "core/base/memory.h"
#include "core/base/status.h"
#include "formats/gltf/gltf_wrap.h"

#include <tiny_gltf.h>

constexpr const char *GLTF_MESHOPT = "EXT_meshopt_compression";
constexpr const char *GLTF_LOD = "MSFT_lod";
constexpr const char *GLTF_DRACO = "KHR_draco_mesh_compression";
constexpr const char *GLTF_INSTANCING = "EXT_mesh_gpu_instancing";
constexpr const char *GLTF_VISIBILITY = "KHR_node_visibility";

// Allocates an array for C, which frees all arrays, even those of an incomplete scene.
template <typename T>
cw_status allocate(T *&array, size_t &count, size_t expected, cw_error *err)
{
    array = static_cast<T *>(cwi_alloc_zeroed(expected, sizeof(T)));
    count = array ? expected : 0;
    return array ? CW_OK : cwi_fail_memory(err);
}

// Returns a member of a value, which may not be an object.
inline const tinygltf::Value &member(const tinygltf::Value &from, const char *key)
{
    static const tinygltf::Value none;
    return from.IsObject() ? from.Get(key) : none;
}

// Returns a whole number from 0 on; anything else becomes a number that is too large.
inline uint64_t number_of(const tinygltf::Value &value)
{
    const double number = value.IsNumber() ? value.GetNumberAsDouble() : -1;
    return number >= 0 && number < 9e15 ? uint64_t(number) : UINT64_MAX / 2;
}

inline int id_of(const tinygltf::Value &value)
{
    const uint64_t id = number_of(value);
    return id < INT32_MAX ? int(id) : -1;
}

// Returns the accessor of an attribute, or -1.
inline int find_attribute(const std::map<std::string, int> &attributes, const char *name)
{
    const auto found = attributes.find(name);
    return found == attributes.end() ? -1 : found->second;
}

// Gives a material, which no other piece has, the pictures of its piece.
void cwi_gltf_add_pictures(tinygltf::Model &model, const cwi_gltf_document &document,
                           const cwi_gltf_piece &piece, int material);

// Adds the pictures of all pieces, when all materials are there.
void cwi_gltf_add_images(tinygltf::Model &model, const cwi_gltf_document &document);

// Makes the JSON of a document; stored as cwi_gltf_functions.document.
CW_NODISCARD cw_status cwi_gltf_document_make(const cwi_gltf_document *document, char **json,
                                              size_t *size, cw_error *err);

// Copies morph targets, weights and skins, behind meshes, primitives and nodes, which it
// completes: how a scene is posed.
CW_NODISCARD cw_status cwi_gltf_copy_poses(const tinygltf::Model &model, cwi_gltf_scene &scene,
                                           cw_error *err);

#endif
