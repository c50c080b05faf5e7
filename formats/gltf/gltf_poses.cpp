// Copies how a glTF scene is posed: morph targets with their weights, skins, instances and
// hidden nodes.
#include "formats/gltf/gltf_module.hpp"

#include <algorithm>
#include <iterator>
#include <vector>

namespace
{

void copy_influences(const tinygltf::Primitive &from, cwi_gltf_primitive &to)
{
    static const char *const joints[CWI_GLTF_SETS] = {"JOINTS_0", "JOINTS_1"};
    static const char *const weights[CWI_GLTF_SETS] = {"WEIGHTS_0", "WEIGHTS_1"};
    for (size_t n = 0; n < CWI_GLTF_SETS; n++) {
        to.joints[n] = find_attribute(from.attributes, joints[n]);
        to.weights[n] = find_attribute(from.attributes, weights[n]);
    }
}

cwi_gltf_target copy_target(const std::map<std::string, int> &from)
{
    return {find_attribute(from, "POSITION"), find_attribute(from, "NORMAL"),
            from.count("COLOR_0") > 0};
}

cw_status copy_targets(const tinygltf::Model &model, cwi_gltf_scene &scene, cw_error *err)
{
    size_t count = 0;
    cwi_gltf_primitive *to = scene.primitives;
    for (const tinygltf::Mesh &mesh : model.meshes)
        for (const tinygltf::Primitive &from : mesh.primitives) {
            copy_influences(from, *to);
            to->first_target = count;
            count += from.targets.size();
            to->end_target = count;
            to++;
        }
    const cw_status st = allocate(scene.targets, scene.target_count, count, err);
    cwi_gltf_target *target = scene.targets;
    for (size_t m = 0; m < model.meshes.size() && st == CW_OK; m++)
        for (const tinygltf::Primitive &from : model.meshes[m].primitives)
            target =
                std::transform(from.targets.begin(), from.targets.end(), target, copy_target);
    return st;
}

// Copies the weights of meshes and nodes into one array.
cw_status copy_weights(const tinygltf::Model &model, cwi_gltf_scene &scene, cw_error *err)
{
    std::vector<double> all;
    const auto add = [&](const std::vector<double> &from, size_t &first, size_t &end) {
        first = all.size();
        all.insert(all.end(), from.begin(), from.end());
        end = all.size();
    };
    for (size_t i = 0; i < scene.mesh_count; i++)
        add(model.meshes[i].weights, scene.meshes[i].first_weight, scene.meshes[i].end_weight);
    for (size_t i = 0; i < scene.node_count; i++)
        add(model.nodes[i].weights, scene.nodes[i].first_weight, scene.nodes[i].end_weight);
    const cw_status st = allocate(scene.weights, scene.weight_count, all.size(), err);
    if (st == CW_OK)
        std::copy(all.begin(), all.end(), scene.weights);
    return st;
}

cw_status copy_skins(const tinygltf::Model &model, cwi_gltf_scene &scene, cw_error *err)
{
    std::vector<int> joints;
    cw_status st = allocate(scene.skins, scene.skin_count, model.skins.size(), err);
    for (size_t i = 0; i < scene.skin_count; i++) {
        const tinygltf::Skin &from = model.skins[i];
        const size_t first = joints.size();
        joints.insert(joints.end(), from.joints.begin(), from.joints.end());
        scene.skins[i] = {first, joints.size(), from.inverseBindMatrices};
    }
    if (st == CW_OK)
        st = allocate(scene.joints, scene.joint_count, joints.size(), err);
    if (st == CW_OK)
        std::copy(joints.begin(), joints.end(), scene.joints);
    return st;
}

void copy_extensions(const tinygltf::Node &from, cwi_gltf_node &to)
{
    static const char *const names[CWI_GLTF_PLACINGS] = {"TRANSLATION", "ROTATION", "SCALE"};
    const auto instances = from.extensions.find(GLTF_INSTANCING);
    const auto visibility = from.extensions.find(GLTF_VISIBILITY);
    std::fill(std::begin(to.placings), std::end(to.placings), -1);
    for (size_t n = 0; n < CWI_GLTF_PLACINGS && instances != from.extensions.end(); n++) {
        const tinygltf::Value &accessor =
            member(member(instances->second, "attributes"), names[n]);
        to.placings[n] = accessor.IsNumber() ? id_of(accessor) : -1;
    }
    if (visibility == from.extensions.end())
        return;
    const tinygltf::Value &visible = member(visibility->second, "visible");
    to.is_hidden = visible.IsBool() && !visible.Get<bool>();
}

} // namespace

cw_status cwi_gltf_copy_poses(const tinygltf::Model &model, cwi_gltf_scene &scene,
                              cw_error *err)
{
    for (size_t i = 0; i < scene.node_count; i++) {
        scene.nodes[i].skin = model.nodes[i].skin;
        copy_extensions(model.nodes[i], scene.nodes[i]);
    }
    cw_status st = copy_targets(model, scene, err);
    if (st == CW_OK)
        st = copy_weights(model, scene, err);
    return st == CW_OK ? copy_skins(model, scene, err) : st;
}
