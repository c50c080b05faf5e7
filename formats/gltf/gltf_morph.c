/* Displaces the vertices of a glTF primitive by its morph targets, with the weights of the node,
 * else of the mesh. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "formats/gltf/gltf_reader.h"

#include <stdio.h>

typedef struct weight_list {
    const double *items;
    size_t count;
} weight_list;

static weight_list weights_of(const cwi_gltf_scene *scene, const cwi_gltf_node *node)
{
    const cwi_gltf_mesh *mesh = &scene->meshes[node->mesh];
    const bool has_own = node->first_weight < node->end_weight;
    const size_t first = has_own ? node->first_weight : mesh->first_weight;
    const size_t end = has_own ? node->end_weight : mesh->end_weight;
    return (weight_list){scene->weights + first, end - first};
}

/* Notes weights without a target, as glTF forbids. */
static void note_count(const cwi_gltf_scene *scene, const cwi_gltf_node *node,
                       const weight_list *weights, size_t targets, cw_mesh_file *metadata)
{
    if (weights->count > targets && !*metadata->fault)
        snprintf(metadata->fault, sizeof metadata->fault,
                 "nodes[%zu] has %zu weights for the %zu morph targets of meshes[%d]",
                 (size_t)(node - scene->nodes), weights->count, targets, node->mesh);
}

static bool is_displacement(const cwi_gltf_numbers *n)
{
    return n->component == 5126 || n->component == 5120 || n->component == 5122;
}

/* Copies the numbers of vertices before the first target displaces them. */
static cw_status copy_numbers(const cwi_gltf_reader *r, const cwi_gltf_numbers *numbers,
                              double **morphed, cw_error *err)
{
    if (*morphed)
        return CW_OK;
    cw_status st = cwi_mesh_take_bytes(r->in, 24 * (uint64_t)numbers->count, err);
    if (st != CW_OK)
        return st;
    r->in->bytes -= 24 * (uint64_t)numbers->count; /* they go before the next primitive */
    *morphed = cwi_alloc_array(numbers->count, 3 * sizeof **morphed);
    if (!*morphed)
        return cwi_fail_memory(err);
    for (size_t i = 0; i < 3 * numbers->count; i++)
        (*morphed)[i] = cwi_gltf_number(numbers, i / 3, (int)(i % 3));
    return CW_OK;
}

static cw_status add_target(const cwi_gltf_reader *r, int accessor, const char *what,
                            double weight, size_t count, double *morphed, cw_error *err)
{
    cwi_gltf_numbers by = {0};
    cw_status st = cwi_gltf_open_attribute(r, accessor, what, count, 3, 3, &by, err);
    if (st == CW_OK && !is_displacement(&by))
        st = cwi_fail(err, CW_ERR_FORMAT,
                      "%s (accessor %d) is not of floats, or of 8 or 16 bits, signed", what,
                      accessor);
    for (size_t i = 0; i < 3 * count && st == CW_OK; i++)
        morphed[i] += weight * cwi_gltf_number(&by, i / 3, (int)(i % 3));
    cwi_free(by.bytes);
    return st;
}

/* Returns true for an accessor without bytes: all its numbers are 0. */
static bool is_zero(const cwi_gltf_scene *scene, int accessor)
{
    return accessor < 0 ||
           ((size_t)accessor < scene->accessor_count && scene->accessors[accessor].view < 0 &&
            !scene->accessors[accessor].sparse.count);
}

cw_status cwi_gltf_morph(cwi_gltf_reader *r, const cwi_gltf_node *node,
                         const cwi_gltf_primitive *p, bool normals,
                         const cwi_gltf_numbers *numbers, double **morphed,
                         cw_mesh_file *metadata, cw_error *err)
{
    const cwi_gltf_scene *scene = &r->scene;
    const weight_list weights = weights_of(scene, node);
    const size_t targets = p->end_target - p->first_target;
    cw_status st = CW_OK;
    note_count(scene, node, &weights, targets, metadata);
    for (size_t t = 0; t < targets && t < weights.count && st == CW_OK; t++) {
        const cwi_gltf_target *target = &scene->targets[p->first_target + t];
        const int accessor = normals ? target->normal : target->position;
        if (weights.items[t] == 0)
            continue;
        if (target->has_color)
            r->not_applied |= CWI_GLTF_MORPHED_COLORS;
        if (is_zero(scene, accessor))
            continue;
        st = copy_numbers(r, numbers, morphed, err);
        if (st == CW_OK)
            st = add_target(r, accessor, normals ? "a target's NORMAL" : "a target's POSITION",
                            weights.items[t], numbers->count, *morphed, err);
    }
    return st;
}
