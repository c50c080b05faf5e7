/* Walks over the nodes of a glTF scene, and finds the transforms of its meshes, and of the instances of
 * EXT_mesh_gpu_instancing. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/base/text.h"
#include "formats/gltf/gltf_reader.h"
#include "formats/mesh/place_parts.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { DEEPEST_NODE = 1024 };

void cwi_gltf_multiply(const double *a, const double *b, double *out)
{
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 4; c++)
            out[4 * r + c] = a[4 * r] * b[c] + a[4 * r + 1] * b[4 + c] +
                             a[4 * r + 2] * b[8 + c] + (c == 3 ? a[4 * r + 3] : 0);
}

const double cwi_gltf_to_lps[12] = {1000, 0, 0, 0, 0, 0, -1000, 0, 0, 1000, 0, 0};

static bool is_unturned(const double *transform)
{
    for (int i = 0; i < 12; i++)
        if (i % 4 != 3 && !(fabs(transform[i] - (i % 5 == 0)) < 1e-9))
            return false;
    return true;
}

/* Converts metres to millimetres. Our writer's 0.001 times an origin may result from several
 * numbers: the one with the fewest digits is taken. */
static double from_metres(double metres)
{
    const double millimetres = 1000 * metres;
    const double near[] = {millimetres, nextafter(millimetres, INFINITY),
                           nextafter(millimetres, -INFINITY)};
    void *locale = cwi_locale_c();
    double found = millimetres;
    bool same = false;
    for (int digits = 1; digits <= 15 && !same; digits++) {
        char text[32];
        snprintf(text, sizeof text, "%.*e", digits - 1, millimetres);
        found = strtod(text, NULL);
        same = 0.001 * found == metres;
    }
    for (int i = 0; i < 3 && !same; i++) {
        found = near[i];
        same = 0.001 * found == metres;
    }
    cwi_locale_restore(locale);
    return same ? found : millimetres;
}

/* Sets the transform of a node's mesh. Where our writer left out the origin of a local file, it is
 * added. */
static cw_status set_transform(cwi_gltf_instance *at, const double *world,
                               cw_mesh_file *metadata, cw_error *err)
{
    double *transform = at->transform[0];
    cwi_gltf_multiply(cwi_gltf_to_lps, world, transform);
    for (int i = 0; i < 12; i++)
        if (!isfinite(transform[i]))
            return cwi_fail(err, CW_ERR_FORMAT, "a node's matrix is not finite");
    at->unturned = is_unturned(transform);
    if (!at->unturned)
        return CW_OK;
    at->transform[0][3] = from_metres(world[3]);
    at->transform[1][3] = from_metres(-world[11]);
    at->transform[2][3] = from_metres(world[7]);
    for (int a = 0; at->node->has_origin && a < 3; a++)
        at->transform[a][3] +=
            at->node->origin[a]; /* a local file: the scene is relative to it */
    metadata->local = metadata->local || at->node->has_origin;
    return CW_OK;
}

/* Returns true for a scale of 0 along all axes, by which animations hide nodes. */
static bool is_hidden(const double *world)
{
    for (int i = 0; i < 12; i++)
        if (i % 4 != 3 && world[i] != 0)
            return false;
    return true;
}

cw_status cwi_gltf_place(cwi_gltf_reader *r, const cwi_gltf_node *node, const double *world,
                         size_t number, cw_mesh_file *metadata, cw_error *err)
{
    const bool is_skinned = !number && cwi_gltf_is_skinned(r, node); /* its joints place it */
    if (!is_skinned && is_hidden(world)) {
        metadata->hidden++;
        return CW_OK;
    }
    cw_status st = cwi_gltf_count_drawing(r, node, err);
    if (st == CW_OK)
        st = cwi_mesh_grow(r->in, &r->instances, &r->instance_capacity, r->instance_count + 1,
                           sizeof *r->instances, err);
    if (st != CW_OK)
        return st;
    cwi_gltf_instance *at = &r->instances[r->instance_count++];
    *at = (cwi_gltf_instance){.mesh = node->mesh, .node = node, .number = number};
    return set_transform(at, world, metadata, err);
}

/* Adds a node to those that KHR_node_visibility hides, by its name or that of its mesh. Names that
 * have no place become "...". */
static void note_invisible(const cwi_gltf_scene *scene, const cwi_gltf_node *node,
                           cw_mesh_file *metadata)
{
    static const char more[] = ", ...";
    char *names = metadata->invisible_names, name[CWI_NAME_BYTES] = "";
    const char *given = node->name ? node->name : scene->meshes[node->mesh].name;
    size_t used = strlen(names);
    metadata->invisible++;
    if (!given || (used > strlen(more) && strcmp(names + used - strlen(more), more) == 0))
        return;
    cwi_clean_name(given, strlen(given), name);
    const bool fits = used + strlen(name) + 2 * strlen(more) < sizeof metadata->invisible_names;
    const char *added = fits ? name : more + 2;
    for (const char *c = used ? ", " : ""; *c; c++)
        names[used++] = *c;
    memcpy(names + used, added, strlen(added) + 1);
}

/* A node whose children are to be visited. */
typedef struct visit {
    int node, parent;
    size_t depth;
    bool is_hidden; /* by KHR_node_visibility of a parent */
} visit;

static bool has_instances(const cwi_gltf_node *n)
{
    return n->placings[0] >= 0 || n->placings[1] >= 0 || n->placings[2] >= 0;
}

static cw_status enter_node(cwi_gltf_reader *r, visit v, cw_mesh_file *metadata, cw_error *err)
{
    static const double unit[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
    const cwi_gltf_scene *scene = &r->scene;
    if (v.node < 0 || (size_t)v.node >= scene->node_count)
        return cwi_fail(err, CW_ERR_FORMAT, "node %d is named; there are %zu", v.node,
                        scene->node_count);
    if (r->visited[v.node])
        return cwi_fail(err, CW_ERR_FORMAT, "node %d is reached in two ways, or holds itself",
                        v.node);
    if (v.depth > DEEPEST_NODE)
        return cwi_fail(err, CW_ERR_FORMAT, "nodes are nested deeper than %d", DEEPEST_NODE);
    r->visited[v.node] = true;
    const cwi_gltf_node *n = &scene->nodes[v.node];
    metadata->levels = n->levels > metadata->levels ? n->levels : metadata->levels;
    cwi_gltf_multiply(v.parent < 0 ? unit : r->world[v.parent], n->local[0], r->world[v.node]);
    if (n->mesh < 0)
        return CW_OK;
    if ((size_t)n->mesh >= scene->mesh_count)
        return cwi_fail(err, CW_ERR_FORMAT, "node %d names mesh %d; there are %zu", v.node,
                        n->mesh, scene->mesh_count);
    const double *world = r->world[v.node];
    if (v.is_hidden || n->is_hidden) {
        note_invisible(scene, n, metadata);
        return CW_OK;
    }
    return has_instances(n) ? cwi_gltf_place_instances(r, n, world, metadata, err)
                            : cwi_gltf_place(r, n, world, 0, metadata, err);
}

/* Walks depth first, in the order of the file. The stack cannot overflow: every node is pushed
 * by its only parent or is a root. A node that is reached in two ways is an error. */
static cw_status walk_nodes(cwi_gltf_reader *r, visit *stack, size_t capacity,
                            cw_mesh_file *metadata, cw_error *err)
{
    const cwi_gltf_scene *scene = &r->scene;
    size_t count = 0;
    for (size_t i = scene->root_count; i > 0; i--)
        stack[count++] = (visit){.node = scene->roots[i - 1], .parent = -1, .depth = 1};
    cw_status st = CW_OK;
    while (st == CW_OK && count > 0) {
        const visit v = stack[--count];
        st = enter_node(r, v, metadata, err);
        if (st != CW_OK)
            break;
        const cwi_gltf_node *n = &scene->nodes[v.node];
        if (n->end - n->first > capacity - count)
            return cwi_fail(err, CW_ERR_FORMAT, "the nodes are no tree");
        for (size_t i = n->end; i > n->first; i--)
            stack[count++] = (visit){scene->children[i - 1], v.node, v.depth + 1,
                                     v.is_hidden || n->is_hidden};
    }
    return st;
}

cw_status cwi_gltf_find_instances(cwi_gltf_reader *r, cw_mesh_file *metadata, cw_error *err)
{
    const size_t count = r->scene.node_count,
                 capacity = r->scene.root_count + r->scene.child_count;
    visit *stack = cwi_alloc_array(capacity, sizeof *stack);
    r->visited = cwi_alloc_zeroed(count, sizeof *r->visited);
    r->world = cwi_alloc_array(count, sizeof *r->world);
    r->drawings = cwi_alloc_zeroed(r->scene.mesh_count, sizeof *r->drawings);
    cw_status st = stack && r->visited && r->world && r->drawings
                       ? walk_nodes(r, stack, capacity, metadata, err)
                       : cwi_fail_memory(err);
    cwi_free(stack);
    return st == CW_OK ? cwi_gltf_pose_skins(r, metadata, err) : st;
}

/* --- instances --------------------------------------------------------------------------- */

enum { TRANSLATION, ROTATION, SCALE, FLOAT = 5126 };

/* Returns true for a type that the extension allows: floats, and of rotations signed fractions, too. */
static bool is_allowed(const cwi_gltf_numbers *n, int use)
{
    const bool is_fraction = (n->component == 5120 || n->component == 5122) && n->normalized;
    return n->component == FLOAT || (use == ROTATION && is_fraction);
}

/* Opens the accessors that there are; all have one count. */
static cw_status open_placings(const cwi_gltf_reader *r, const cwi_gltf_node *node,
                               cwi_gltf_numbers *numbers, size_t *count, cw_error *err)
{
    static const char *const names[] = {"TRANSLATION", "ROTATION", "SCALE"};
    cw_status st = CW_OK;
    *count = 0;
    for (int n = 0; n < CWI_GLTF_PLACINGS && st == CW_OK; n++) {
        const int accessor = node->placings[n], size = n == ROTATION ? 4 : 3;
        if (accessor < 0)
            continue;
        st = cwi_gltf_open_numbers(&r->bytes, &r->scene, accessor, names[n], &numbers[n], err);
        if (st == CW_OK && (numbers[n].numbers != size || !is_allowed(&numbers[n], n)))
            st = cwi_fail(err, CW_ERR_FORMAT,
                          "%s of instances (accessor %d) is not VEC%d of floats%s", names[n],
                          accessor, size,
                          n == ROTATION ? ", or of 8 or 16 bits, signed and normalized" : "");
        if (st == CW_OK && *count && numbers[n].count != *count)
            st = cwi_fail(err, CW_ERR_FORMAT,
                          "%s of instances (accessor %d) has %zu elements; the other has %zu",
                          names[n], accessor, numbers[n].count, *count);
        *count = numbers[n].count;
    }
    return st;
}

static void take_numbers(const cwi_gltf_numbers *numbers, size_t i, int count, double *to)
{
    for (int c = 0; c < count && numbers->bytes; c++)
        to[c] = cwi_gltf_number(numbers, i, c);
}

cw_status cwi_gltf_place_instances(cwi_gltf_reader *r, const cwi_gltf_node *node,
                                   const double *world, cw_mesh_file *metadata, cw_error *err)
{
    cwi_gltf_numbers numbers[CWI_GLTF_PLACINGS] = {0};
    size_t count;
    cw_status st = open_placings(r, node, numbers, &count, err);
    if (cwi_gltf_is_skinned(r, node))
        r->not_applied |= CWI_GLTF_INSTANCED_SKINS;
    for (size_t i = 0; i < count && st == CW_OK; i++) {
        double t[3] = {0, 0, 0}, q[4] = {0, 0, 0, 1}, s[3] = {1, 1, 1}, local[12], placed[12];
        take_numbers(&numbers[TRANSLATION], i, 3, t);
        take_numbers(&numbers[ROTATION], i, 4, q);
        take_numbers(&numbers[SCALE], i, 3, s);
        cwi_gltf_compose(t, q, s, local);
        cwi_gltf_multiply(world, local, placed);
        st = cwi_gltf_place(r, node, placed, i + 1, metadata, err);
    }
    for (int n = 0; n < CWI_GLTF_PLACINGS; n++)
        cwi_free(numbers[n].bytes);
    return st;
}
