/* Limits what a glTF scene draws. A small file that draws its meshes again and again must not take
 * all memory or time, so elements are added up before they are made. */
#include "core/base/status.h"
#include "core/base/text.h"
#include "formats/gltf/gltf_reader.h"

enum { TRIANGLES_MODE = 4, DISPLACED_EACH = 16 };

cw_status cwi_gltf_limit(const cwi_gltf_reader *r, uint64_t count, cw_error *err)
{
    if (count <= r->max)
        return CW_OK;
    return cwi_fail(
        err, CW_ERR_LIMIT,
        "the scene draws its triangles so often that they are more than %llu; state "
        "a limit if that is meant (desc->max_triangles)",
        (unsigned long long)r->max);
}

static uint64_t claimed_count(const cwi_gltf_scene *scene, int accessor)
{
    const bool known = accessor >= 0 && (size_t)accessor < scene->accessor_count;
    const uint64_t count = known ? scene->accessors[accessor].count : 0;
    return count < UINT32_MAX ? count : UINT32_MAX;
}

/* Counts a drawing. An empty primitive counts as a triangle, since it takes time, too. */
static cwi_gltf_drawing count_elements(const cwi_gltf_scene *scene, const cwi_gltf_mesh *mesh)
{
    cwi_gltf_drawing sum = {.counted = true};
    for (size_t i = mesh->first; i < mesh->end; i++) {
        const cwi_gltf_primitive *p = &scene->primitives[i];
        const uint64_t vertices = claimed_count(scene, p->position);
        const uint64_t corners = p->indices >= 0 ? claimed_count(scene, p->indices) : vertices;
        const bool shared = i > mesh->first && p->position == p[-1].position;
        sum.vertices += shared ? 0 : vertices;
        sum.triangles += 1 + (p->mode > TRIANGLES_MODE ? corners : corners / 3);
    }
    return sum;
}

/* Counts the vertices that the targets of a primitive displace by some weights. */
static uint64_t count_displaced(const cwi_gltf_scene *scene, const cwi_gltf_primitive *p,
                                size_t first, size_t end)
{
    const size_t targets = p->end_target - p->first_target;
    uint64_t active = 0;
    for (size_t t = 0; t < targets && t < end - first; t++)
        active += scene->weights[first + t] != 0;
    return active * claimed_count(scene, p->position);
}

static uint64_t count_mesh_displaced(const cwi_gltf_scene *scene, const cwi_gltf_mesh *mesh,
                                     size_t first, size_t end)
{
    uint64_t sum = 0;
    for (size_t i = mesh->first; i < mesh->end && first < end; i++)
        sum += count_displaced(scene, &scene->primitives[i], first, end);
    return sum;
}

static cw_status limit_displaced(const cwi_gltf_reader *r, uint64_t count, cw_error *err)
{
    if (count / DISPLACED_EACH <= r->max)
        return CW_OK;
    return cwi_fail(
        err, CW_ERR_LIMIT,
        "morph targets displace vertices so often that they are more than %llu; state "
        "a limit if that is meant (desc->max_triangles)",
        (unsigned long long)r->max * DISPLACED_EACH);
}

/* Checks the memory of the arrays while a mesh is built: points are doubles until the end. */
static cw_status check_memory(const cwi_gltf_reader *r, const cwi_gltf_drawing *sum,
                              cw_error *err)
{
    const uint64_t limit = r->in->desc.max_bytes;
    const uint64_t bytes =
        3 * sizeof(double) * sum->vertices + 3 * sizeof(uint32_t) * sum->triangles;
    if (!limit || bytes <= limit)
        return CW_OK;
    char text[CWI_MEMORY_TEXT];
    cwi_print_memory(limit, text);
    return cwi_fail(
        err, CW_ERR_LIMIT,
        "the scene draws its triangles so often that they need more memory than the "
        "%s allowed (desc->max_bytes)",
        text);
}

/* The first drawing of a mesh is not counted: the bytes of the file limit it. Displaced vertices
 * are, since targets may share their bytes. */
cw_status cwi_gltf_count_drawing(cwi_gltf_reader *r, const cwi_gltf_node *node, cw_error *err)
{
    const cwi_gltf_scene *scene = &r->scene;
    const cwi_gltf_mesh *mesh = &scene->meshes[node->mesh];
    cwi_gltf_drawing *each = &r->drawings[node->mesh], *sum = &r->drawn;
    const bool has_own = node->first_weight < node->end_weight;
    sum->vertices += each->vertices;
    sum->triangles += each->triangles;
    if (!each->counted) {
        *each = count_elements(scene, mesh);
        each->displaced =
            count_mesh_displaced(scene, mesh, mesh->first_weight, mesh->end_weight);
    }
    sum->displaced +=
        has_own ? count_mesh_displaced(scene, mesh, node->first_weight, node->end_weight)
                : each->displaced;
    cw_status st =
        cwi_gltf_limit(r, sum->vertices > sum->triangles ? sum->vertices : sum->triangles, err);
    if (st == CW_OK)
        st = limit_displaced(r, sum->displaced, err);
    if (st == CW_OK)
        st = cwi_mesh_limit_triangles(r->in, sum->triangles, err);
    return st == CW_OK ? check_memory(r, sum, err) : st;
}
