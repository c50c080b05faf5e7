/* Poses the skinned meshes of a glTF scene at rest: each vertex is placed by the weighted maps of
 * its joints, and not by its own node. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "formats/gltf/gltf_reader.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { MATRIX = 16, INFLUENCES = 4, FLOAT = 5126, DEEPEST_JOINT = 1024 };

static bool has_joints(const cwi_gltf_primitive *p)
{
    return p->joints[0] >= 0 && p->weights[0] >= 0;
}

bool cwi_gltf_is_skinned(const cwi_gltf_reader *r, const cwi_gltf_node *node)
{
    const cwi_gltf_mesh *mesh = &r->scene.meshes[node->mesh];
    bool has = false;
    for (size_t i = mesh->first; i < mesh->end && node->skin >= 0 && !has; i++)
        has = has_joints(&r->scene.primitives[i]);
    return has;
}

/* --- joints ------------------------------------------------------------------------------ */

/* Sets the parent of each node; a root has -1. */
static int *find_parents(const cwi_gltf_scene *scene)
{
    int *parents = cwi_alloc_array(scene->node_count, sizeof *parents);
    for (size_t i = 0; i < scene->node_count && parents; i++)
        parents[i] = -1;
    for (size_t i = 0; i < scene->node_count && parents; i++)
        for (size_t c = scene->nodes[i].first; c < scene->nodes[i].end; c++) {
            const int child = scene->children[c];
            if (child >= 0 && (size_t)child < scene->node_count)
                parents[child] = (int)i;
        }
    return parents;
}

/* Places a joint that the scene does not reach, and the nodes above it that have no place yet. */
static cw_status place_joint(cwi_gltf_reader *r, const int *parents, int joint, cw_error *err)
{
    int chain[DEEPEST_JOINT];
    size_t depth = 0;
    int node = joint;
    for (; node >= 0 && !r->visited[node] && depth < DEEPEST_JOINT; node = parents[node])
        chain[depth++] = node;
    if (node >= 0 && !r->visited[node])
        return cwi_fail(err, CW_ERR_FORMAT,
                        "node %d, a joint, is nested deeper than %d, or holds itself", joint,
                        DEEPEST_JOINT);
    while (depth > 0) {
        const int at = chain[--depth], parent = parents[at];
        if (parent < 0)
            memcpy(r->world[at], r->scene.nodes[at].local, sizeof r->world[at]);
        else
            cwi_gltf_multiply(r->world[parent], r->scene.nodes[at].local[0], r->world[at]);
        r->visited[at] = true;
    }
    return CW_OK;
}

static cw_status open_inverse_bind(const cwi_gltf_reader *r, const cwi_gltf_skin *skin,
                                   cwi_gltf_numbers *matrices, cw_error *err)
{
    const size_t skin_index = (size_t)(skin - r->scene.skins), count = skin->end - skin->first;
    if (skin->inverse_bind < 0)
        return CW_OK;
    cw_status st = cwi_gltf_open_numbers(&r->bytes, &r->scene, skin->inverse_bind,
                                         "inverseBindMatrices", matrices, err);
    if (st == CW_OK && (matrices->numbers != MATRIX || matrices->component != FLOAT))
        return cwi_fail(err, CW_ERR_FORMAT,
                        "skins[%zu].inverseBindMatrices: accessors[%d] is not MAT4 of floats",
                        skin_index, skin->inverse_bind);
    if (st == CW_OK && matrices->count < count)
        return cwi_fail(err, CW_ERR_FORMAT,
                        "skins[%zu].inverseBindMatrices: accessors[%d] has %zu matrices; there "
                        "are %zu joints",
                        skin_index, skin->inverse_bind, matrices->count, count);
    return st;
}

/* Computes the map of a joint: that of its node behind the inverse of the one it was bound in. */
static void map_joint(const double *world, const cwi_gltf_numbers *matrices, size_t joint,
                      double out[12])
{
    double in_scene[12], inverse[12];
    cwi_gltf_multiply(cwi_gltf_to_lps, world, matrices->bytes ? in_scene : out);
    if (!matrices->bytes)
        return;
    for (int i = 0; i < 12; i++) /* the file has columns */
        inverse[i] = cwi_gltf_number(matrices, joint, 4 * (i % 4) + i / 4);
    cwi_gltf_multiply(in_scene, inverse, out);
}

static bool has_size(const double *map)
{
    for (int i = 0; i < 12; i++)
        if (i % 4 != 3 && map[i] != 0)
            return true;
    return false;
}

static cw_status map_joints(cwi_gltf_reader *r, const cwi_gltf_skin *skin, const int *parents,
                            cwi_gltf_pose *pose, cw_error *err)
{
    cwi_gltf_numbers matrices = {0};
    const size_t count = skin->end - skin->first;
    cw_status st = open_inverse_bind(r, skin, &matrices, err);
    pose->is_hidden = true;
    for (size_t i = 0; i < count && st == CW_OK; i++) {
        const int joint = r->scene.joints[skin->first + i];
        if (joint < 0 || (size_t)joint >= r->scene.node_count)
            st =
                cwi_fail(err, CW_ERR_FORMAT, "skins[%zu].joints[%zu] is node %d; there are %zu",
                         (size_t)(skin - r->scene.skins), i, joint, r->scene.node_count);
        if (st == CW_OK && !r->visited[joint])
            st = place_joint(r, parents, joint, err);
        if (st != CW_OK)
            break;
        map_joint(r->world[joint], &matrices, i, pose->joints[i]);
        pose->is_hidden = pose->is_hidden && !has_size(pose->joints[i]);
    }
    cwi_free(matrices.bytes);
    return st;
}

static cw_status load_pose(cwi_gltf_reader *r, int skin, const int *parents, cw_error *err)
{
    if (skin < 0 || (size_t)skin >= r->scene.skin_count)
        return cwi_fail(err, CW_ERR_FORMAT, "skin %d is named; there are %zu", skin,
                        r->scene.skin_count);
    cwi_gltf_pose *pose = &r->poses[skin];
    const cwi_gltf_skin *s = &r->scene.skins[skin];
    if (pose->joints)
        return CW_OK;
    pose->count = s->end - s->first;
    cw_status st =
        cwi_mesh_take_bytes(r->in, (uint64_t)pose->count * sizeof *pose->joints, err);
    if (st != CW_OK)
        return st;
    pose->joints = cwi_alloc_array(pose->count, sizeof *pose->joints);
    return pose->joints ? map_joints(r, s, parents, pose, err) : cwi_fail_memory(err);
}

/* Notes a node with a skin whose mesh has no joints, as glTF demands. */
static void note_unskinned(const cwi_gltf_reader *r, const cwi_gltf_node *node,
                           cw_mesh_file *metadata)
{
    if (!*metadata->fault)
        snprintf(metadata->fault, sizeof metadata->fault,
                 "nodes[%zu] has a skin, and meshes[%d] no JOINTS_0 and WEIGHTS_0",
                 (size_t)(node - r->scene.nodes), node->mesh);
}

cw_status cwi_gltf_pose_skins(cwi_gltf_reader *r, cw_mesh_file *metadata, cw_error *err)
{
    size_t kept = 0;
    int *parents = find_parents(&r->scene);
    r->poses = cwi_alloc_zeroed(r->scene.skin_count, sizeof *r->poses);
    cw_status st = r->poses && parents ? CW_OK : cwi_fail_memory(err);
    for (size_t i = 0; i < r->instance_count && st == CW_OK; i++) {
        cwi_gltf_instance at = r->instances[i];
        const bool is_skinned = !at.number && cwi_gltf_is_skinned(r, at.node);
        if (is_skinned)
            st = load_pose(r, at.node->skin, parents, err);
        else if (at.node->skin >= 0 && !at.number)
            note_unskinned(r, at.node, metadata);
        if (is_skinned && st == CW_OK) {
            at.pose = &r->poses[at.node->skin];
            at.unturned = false;
        }
        const bool is_hidden = at.pose && at.pose->is_hidden;
        metadata->hidden += is_hidden;
        if (!is_hidden)
            r->instances[kept++] = at;
    }
    r->instance_count = kept;
    cwi_free(parents);
    return st;
}

void cwi_gltf_free_poses(cwi_gltf_reader *r)
{
    for (size_t i = 0; r->poses && i < r->scene.skin_count; i++)
        cwi_free(r->poses[i].joints);
    cwi_free(r->poses);
    r->poses = NULL;
}

/* --- vertices ---------------------------------------------------------------------------- */

static cw_status check_types(const cwi_gltf_primitive *p, int set, const cwi_gltf_shape *shape,
                             cw_error *err)
{
    const cwi_gltf_numbers *j = &shape->joints[set], *w = &shape->weights[set];
    const bool is_index = j->component == 5121 || j->component == 5123;
    const bool is_fraction = (w->component == 5121 || w->component == 5123) && w->normalized;
    if (!is_index || j->normalized)
        return cwi_fail(err, CW_ERR_FORMAT,
                        "JOINTS_%d (accessor %d) is not VEC4 of 8 or 16 bits, unsigned", set,
                        p->joints[set]);
    if (w->component != FLOAT && !is_fraction)
        return cwi_fail(
            err, CW_ERR_FORMAT,
            "WEIGHTS_%d (accessor %d) is not VEC4 of floats, or of 8 or 16 bits, unsigned and "
            "normalized",
            set, p->weights[set]);
    return CW_OK;
}

/* Returns true for an accessor whose numbers only Draco has. */
static bool is_packed(const cwi_gltf_reader *r, int accessor)
{
    return r->bytes.unpacked && accessor >= 0 && (size_t)accessor < r->scene.accessor_count &&
           r->scene.accessors[accessor].view < 0 && !r->scene.accessors[accessor].sparse.count;
}

cw_status cwi_gltf_open_influences(cwi_gltf_reader *r, const cwi_gltf_instance *at,
                                   const cwi_gltf_primitive *p, size_t count,
                                   cwi_gltf_shape *shape, cw_error *err)
{
    static const char *const joints[] = {"JOINTS_0", "JOINTS_1"};
    static const char *const weights[] = {"WEIGHTS_0", "WEIGHTS_1"};
    cw_status st = CW_OK;
    if (!at->pose || !has_joints(p) || shape->sets)
        return CW_OK;
    if (is_packed(r, p->joints[0]) || is_packed(r, p->weights[0])) {
        r->not_applied |= CWI_GLTF_PACKED_SKINS;
        return CW_OK;
    }
    for (int set = 0; set < CWI_GLTF_SETS && st == CW_OK; set++) {
        if (p->joints[set] < 0 || p->weights[set] < 0)
            break;
        st = cwi_gltf_open_attribute(r, p->joints[set], joints[set], count, INFLUENCES,
                                     INFLUENCES, &shape->joints[set], err);
        if (st == CW_OK)
            st = cwi_gltf_open_attribute(r, p->weights[set], weights[set], count, INFLUENCES,
                                         INFLUENCES, &shape->weights[set], err);
        if (st == CW_OK)
            st = check_types(p, set, shape, err);
        shape->sets++;
    }
    return st;
}

/* Adds a joint's map by its weight. */
static cw_status add_joint(const cwi_gltf_pose *pose, size_t v, double joint, double weight,
                           double out[12], cw_error *err)
{
    if (weight == 0)
        return CW_OK;
    if (!(weight > 0))
        return cwi_fail(err, CW_ERR_FORMAT,
                        "a weight of vertex %zu is %g; it must be 0 or more", v, weight);
    if (!(joint < (double)pose->count))
        return cwi_fail(err, CW_ERR_FORMAT, "vertex %zu names joint %.0f; the skin has %zu", v,
                        joint, pose->count);
    for (int k = 0; k < 12; k++)
        out[k] += weight * pose->joints[(size_t)joint][k];
    return CW_OK;
}

/* Weights count relative to their sum, which bytes miss by rounding. Where all are 0, the first
 * joint has the vertex. */
cw_status cwi_gltf_blend_joints(const cwi_gltf_pose *pose, const cwi_gltf_shape *shape,
                                size_t v, double out[12], cw_error *err)
{
    double sum = 0;
    cw_status st = CW_OK;
    memset(out, 0, 12 * sizeof *out);
    for (size_t i = 0; i < INFLUENCES * shape->sets && st == CW_OK; i++) {
        const size_t set = i / INFLUENCES;
        const int c = (int)(i % INFLUENCES);
        const double weight = cwi_gltf_number(&shape->weights[set], v, c);
        st = add_joint(pose, v, cwi_gltf_number(&shape->joints[set], v, c), weight, out, err);
        sum += weight;
    }
    if (st == CW_OK && sum == 0) {
        sum = 1;
        st = add_joint(pose, v, cwi_gltf_number(&shape->joints[0], v, 0), 1, out, err);
    }
    for (int k = 0; k < 12; k++)
        out[k] /= sum;
    return st;
}
