/* glTF: a scene's triangles, placed by its nodes, merged into one mesh of LPS millimetres. */
#include "core/affine.h"
#include "core/memory.h"
#include "core/status.h"
#include "core/text.h"
#include "formats/gltf_wrap.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { GLB_HEADER = 12, CHUNK_HEADER = 8, DEEPEST_NODE = 1024, FREE_COUNT = 1 << 26 };

/* A node of the scene that has a mesh. */
typedef struct instance {
    int mesh;
    const cwi_gltf_node *node;
    double place[3][4]; /* to LPS millimetres */
    bool unturned;      /* nothing but a translation */
} instance;

typedef struct reader {
    cwi_mesh_input *in;
    cwi_gltf_bytes bytes;
    cwi_gltf_scene scene;
    double (*world)[12]; /* of each node */
    instance *instances;
    size_t instance_count;
    bool shifted;  /* every instance is moved by the mesh's origin, and nothing else */
    uint64_t most; /* vertices, and triangles, that the scene may be drawn with */
    cwi_mesh_build build;
    float *normals; /* a place for each point; NULL: none so far */
    uint8_t *colors;
    size_t normal_room, color_room;
    bool no_normals; /* some primitive has none: then none are kept */
} reader;

void cwi_gltf_scene_free(cwi_gltf_scene *scene)
{
    for (size_t i = 0; scene->buffers && i < scene->buffer_count; i++)
        cwi_free(scene->buffers[i].uri);
    cwi_free(scene->buffers);
    cwi_free(scene->views);
    cwi_free(scene->accessors);
    cwi_free(scene->primitives);
    cwi_free(scene->meshes);
    cwi_free(scene->nodes);
    cwi_free(scene->children);
    cwi_free(scene->roots);
    *scene = (cwi_gltf_scene){0};
}

/* --- the file ---------------------------------------------------------------------------- */

static uint32_t u32_at(const unsigned char *b)
{
    return b[0] | (uint32_t)b[1] << 8 | (uint32_t)b[2] << 16 | (uint32_t)b[3] << 24;
}

bool cwi_glb_sniff(const unsigned char *head, size_t size, uint64_t file_size)
{
    (void)file_size;
    return size >= 4 && memcmp(head, "glTF", 4) == 0;
}

bool cwi_gltf_sniff(const unsigned char *head, size_t size, uint64_t file_size)
{
    size_t i = 0;
    (void)file_size;
    while (i < size && (head[i] == ' ' || (head[i] >= '\t' && head[i] <= '\r')))
        i++;
    return i < size && head[i] == '{';
}

/* A chunk's size and where its bytes are; false where the file has no more. */
static cw_status find_chunk(const cwi_input *in, uint64_t at, uint64_t end, const char *kind,
                            uint64_t *size, cw_error *err)
{
    unsigned char head[CHUNK_HEADER];
    size_t got;
    cw_status st = cwi_input_read_at(in->fd, at, head, sizeof head, &got, err);
    if (st != CW_OK)
        return st;
    *size = got == sizeof head ? u32_at(head) : 0;
    if (got < sizeof head || memcmp(head + 4, kind, 4) != 0 || *size > end - at - CHUNK_HEADER)
        return cw_fail(err, CW_ERR_FORMAT,
                       "the chunk at byte %llu is not a whole one of kind %.4s",
                       (unsigned long long)at, kind);
    return CW_OK;
}

/* The header, a chunk of JSON, and as a rule one of bytes. */
static cw_status find_chunks(reader *r, uint64_t *json, uint64_t *json_size, cw_error *err)
{
    const cwi_input *in = &r->in->file;
    unsigned char head[GLB_HEADER];
    size_t got;
    cw_status st = cwi_input_read_at(in->fd, 0, head, sizeof head, &got, err);
    if (st != CW_OK)
        return st;
    if (got < sizeof head || memcmp(head, "glTF", 4) != 0)
        return cw_fail(err, CW_ERR_FORMAT, "the file does not begin with 'glTF'");
    const uint64_t end = u32_at(head + 8);
    if (u32_at(head + 4) != 2)
        return cw_fail(err, CW_ERR_FORMAT, "it is of version %u; version 2 is read",
                       u32_at(head + 4));
    if (end > in->size || end < GLB_HEADER + CHUNK_HEADER)
        return cw_fail(err, CW_ERR_FORMAT, "the header says %llu bytes; the file has %llu",
                       (unsigned long long)end, (unsigned long long)in->size);
    st = find_chunk(in, GLB_HEADER, end, "JSON", json_size, err);
    *json = GLB_HEADER + CHUNK_HEADER;
    if (st != CW_OK || *json + *json_size + CHUNK_HEADER > end)
        return st;
    r->bytes.chunk = *json + *json_size + CHUNK_HEADER;
    return find_chunk(in, *json + *json_size, end, "BIN\0", &r->bytes.chunk_size, err);
}

static cw_status parse_json(reader *r, uint64_t at, uint64_t size, cw_error *err)
{
    const cwi_gltf_functions *functions;
    size_t got;
    if (size > UINT32_MAX)
        return cw_fail(err, CW_ERR_LIMIT, "the JSON has more than 4 GiB");
    cw_status st = cwi_gltf_functions_load(&functions, err);
    if (st != CW_OK)
        return st;
    char *json = cwi_alloc_array((size_t)size + 1, 1);
    if (!json)
        return cw_fail(err, CW_ERR_NO_MEMORY, "no memory for the JSON");
    st = cwi_input_read_at(r->in->file.fd, at, json, (size_t)size, &got, err);
    if (st == CW_OK)
        st = cwi_gltf_blind(json, got, err);
    if (st == CW_OK)
        st = functions->parse(json, got, &r->scene, err);
    cwi_free(json);
    return st;
}

/* --- nodes ------------------------------------------------------------------------------- */

static void multiply(const double *a, const double *b, double *out)
{
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 4; c++)
            out[4 * r + c] = a[4 * r] * b[c] + a[4 * r + 1] * b[4 + c] +
                             a[4 * r + 2] * b[8 + c] + (c == 3 ? a[4 * r + 3] : 0);
}

static const double to_lps[12] = {1000, 0, 0, 0, 0, 0, -1000, 0, 0, 1000, 0, 0};

static bool is_unturned(const double *place)
{
    for (int i = 0; i < 12; i++)
        if (i % 4 != 3 && !(fabs(place[i] - (i % 5 == 0)) < 1e-9))
            return false;
    return true;
}

/* The millimetres that were meant by metres. Our writer's 0.001 times an origin may have come
 * from several: the one with the fewest digits is taken. */
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

/* Where a node's mesh stands. Where our writer left the origin of a local file, it is added. */
static cw_status set_place(instance *at, const double *world, cw_mesh_file *said, cw_error *err)
{
    double *place = at->place[0];
    multiply(to_lps, world, place);
    for (int i = 0; i < 12; i++)
        if (!isfinite(place[i]))
            return cw_fail(err, CW_ERR_FORMAT, "a node's matrix is not finite");
    at->unturned = is_unturned(place);
    const bool moved = place[3] != 0 || place[7] != 0 || place[11] != 0;
    if (at->unturned && !moved && at->node->has_origin) {
        for (int a = 0; a < 3; a++)
            at->place[a][3] = at->node->origin[a];
        said->local = true;
    } else if (at->unturned) {
        at->place[0][3] = from_metres(world[3]);
        at->place[1][3] = from_metres(-world[11]);
        at->place[2][3] = from_metres(world[7]);
    }
    return CW_OK;
}

/* A node with its children to be visited. */
typedef struct visit {
    int node, parent;
    size_t depth;
} visit;

static cw_status enter_node(reader *r, visit v, bool *visited, cw_mesh_file *said,
                            cw_error *err)
{
    static const double unit[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
    const cwi_gltf_scene *scene = &r->scene;
    if (v.node < 0 || (size_t)v.node >= scene->node_count)
        return cw_fail(err, CW_ERR_FORMAT, "node %d is named; there are %zu", v.node,
                       scene->node_count);
    if (visited[v.node])
        return cw_fail(err, CW_ERR_FORMAT, "node %d is reached in two ways, or holds itself",
                       v.node);
    if (v.depth > DEEPEST_NODE)
        return cw_fail(err, CW_ERR_FORMAT, "nodes are nested deeper than %d", DEEPEST_NODE);
    visited[v.node] = true;
    const cwi_gltf_node *n = &scene->nodes[v.node];
    multiply(v.parent < 0 ? unit : r->world[v.parent], n->local[0], r->world[v.node]);
    if (n->mesh < 0)
        return CW_OK;
    if ((size_t)n->mesh >= scene->mesh_count)
        return cw_fail(err, CW_ERR_FORMAT, "node %d names mesh %d; there are %zu", v.node,
                       n->mesh, scene->mesh_count);
    instance *at = &r->instances[r->instance_count++];
    *at = (instance){.mesh = n->mesh, .node = n};
    return set_place(at, r->world[v.node], said, err);
}

/* Depth first, in the order of the file. The stack cannot overflow: every node is pushed by its
 * one parent or is a root, else there is one that is reached in two ways. */
static cw_status walk(reader *r, visit *stack, size_t room, bool *visited, cw_mesh_file *said,
                      cw_error *err)
{
    const cwi_gltf_scene *scene = &r->scene;
    size_t count = 0;
    for (size_t i = scene->root_count; i > 0; i--)
        stack[count++] = (visit){scene->roots[i - 1], -1, 1};
    cw_status st = CW_OK;
    while (st == CW_OK && count > 0) {
        const visit v = stack[--count];
        st = enter_node(r, v, visited, said, err);
        if (st != CW_OK)
            break;
        const cwi_gltf_node *n = &scene->nodes[v.node];
        if (n->end - n->first > room - count)
            return cw_fail(err, CW_ERR_FORMAT, "the nodes are no tree");
        for (size_t i = n->end; i > n->first; i--)
            stack[count++] = (visit){scene->children[i - 1], v.node, v.depth + 1};
    }
    return st;
}

static cw_status find_instances(reader *r, cw_mesh_file *said, cw_error *err)
{
    const size_t count = r->scene.node_count, room = r->scene.root_count + r->scene.child_count;
    visit *stack = cwi_alloc_array(room, sizeof *stack);
    bool *visited = cwi_alloc_zeroed(count, sizeof *visited);
    r->world = cwi_alloc_array(count, sizeof *r->world);
    r->instances = cwi_alloc_array(count, sizeof *r->instances);
    cw_status st = stack && visited && r->world && r->instances
                       ? walk(r, stack, room, visited, said, err)
                       : cw_fail(err, CW_ERR_NO_MEMORY, "no memory for %zu nodes", count);
    cwi_free(stack);
    cwi_free(visited);
    return st;
}

/* --- primitives -------------------------------------------------------------------------- */

static cw_status limit_scene(const reader *r, uint64_t count, cw_error *err)
{
    if (count <= r->most)
        return CW_OK;
    return cw_fail(err, CW_ERR_LIMIT,
                   "the scene draws its triangles so often that they are more than %llu; state "
                   "a limit if that is meant",
                   (unsigned long long)r->most);
}

static cw_status open_attribute(const reader *r, int accessor, const char *what, size_t count,
                                int least, int most, cwi_gltf_numbers *numbers, cw_error *err)
{
    cw_status st = cwi_gltf_open_numbers(&r->bytes, &r->scene, accessor, what, numbers, err);
    if (st != CW_OK)
        return st;
    if (numbers->numbers < least || numbers->numbers > most)
        return cw_fail(err, CW_ERR_FORMAT, "%s (accessor %d) has elements of %d numbers", what,
                       accessor, numbers->numbers);
    if (numbers->count != count)
        return cw_fail(err, CW_ERR_FORMAT,
                       "%s (accessor %d) has %zu elements; POSITION has %zu", what, accessor,
                       numbers->count, count);
    return CW_OK;
}

static cw_status add_points(reader *r, const instance *at, const cwi_gltf_numbers *numbers,
                            cw_error *err)
{
    cw_status st = limit_scene(r, (uint64_t)r->build.point_count + numbers->count, err);
    if (st == CW_OK)
        st = cwi_build_reserve(&r->build, (uint64_t)r->build.point_count + numbers->count, 0,
                               err);
    for (size_t i = 0; i < numbers->count && st == CW_OK; i++) {
        double p[3], moved[3];
        for (int a = 0; a < 3; a++)
            p[a] = cwi_gltf_number(numbers, i, a);
        cwi_affine_apply(at->place[0], p, moved);
        st = cwi_build_point(&r->build, r->shifted ? p : moved, err);
    }
    return st;
}

/* Normals turn by the inverse transpose, which keeps them outward in a mirror, too. */
static void turn_normal(double cofactor[3][3], double sign, const double n[3], float out[3])
{
    double turned[3], length = 0;
    for (int a = 0; a < 3; a++) {
        turned[a] =
            sign * (cofactor[a][0] * n[0] + cofactor[a][1] * n[1] + cofactor[a][2] * n[2]);
        length += turned[a] * turned[a];
    }
    length = sqrt(length);
    for (int a = 0; a < 3; a++)
        out[a] = length > 0 && length <= DBL_MAX ? (float)(turned[a] / length) : NAN;
}

static cw_status add_normals(reader *r, const instance *at, int accessor, size_t first,
                             cw_error *err)
{
    cwi_gltf_numbers numbers = {0};
    double cofactor[3][3];
    r->no_normals = r->no_normals || accessor < 0;
    if (r->no_normals)
        return CW_OK;
    cw_status st = open_attribute(r, accessor, "NORMAL", r->build.point_count - first, 3, 3,
                                  &numbers, err);
    if (st == CW_OK)
        st = cwi_mesh_grow(r->in, &r->normals, &r->normal_room, r->build.point_count,
                           3 * sizeof *r->normals, err);
    cwi_affine_cofactor(at->place[0], cofactor);
    const double sign = cwi_affine_determinant(at->place[0]) < 0 ? -1 : 1;
    for (size_t i = 0; i < numbers.count && st == CW_OK; i++) {
        double n[3];
        float *to = r->normals + 3 * (first + i);
        for (int a = 0; a < 3; a++)
            n[a] = cwi_gltf_number(&numbers, i, a);
        for (int a = 0; a < 3 && at->unturned; a++)
            to[a] = (float)n[a];
        if (!at->unturned)
            turn_normal(cofactor, sign, n, to);
    }
    cwi_free(numbers.bytes);
    return st;
}

/* Linear light to sRGB, 0 to 1 to 0 to 255; alpha is linear in both. */
static uint8_t to_srgb(double linear, bool is_alpha)
{
    const double c = linear > 0 ? fmin(linear, 1) : 0;
    const double s = is_alpha         ? c
                     : c <= 0.0031308 ? 12.92 * c
                                      : 1.055 * pow(c, 1 / 2.4) - 0.055;
    return (uint8_t)lround(255 * s);
}

/* Colours of bytes are looked up: there are two tables of 256. */
static void convert_colors(const cwi_gltf_numbers *numbers, uint8_t *to)
{
    uint8_t table[2][256];
    const bool bytes = numbers->component == 5121 && numbers->normalized;
    for (int i = 0; i < 256; i++)
        for (int alpha = 0; alpha < 2; alpha++)
            table[alpha][i] = to_srgb(i / 255.0, alpha);
    for (size_t i = 0; i < numbers->count; i++)
        for (int c = 0; c < numbers->numbers; c++)
            to[4 * i + (size_t)c] =
                bytes ? table[c == 3][numbers->bytes[i * numbers->stride + (size_t)c]]
                      : to_srgb(cwi_gltf_number(numbers, i, c), c == 3);
}

/* A primitive without colours among others that have some is white, as when it is drawn. */
static cw_status add_colors(reader *r, int accessor, size_t first, cw_error *err)
{
    const size_t count = r->build.point_count;
    cwi_gltf_numbers numbers = {0};
    cw_status st = CW_OK;
    if (accessor < 0 && !r->colors)
        return CW_OK;
    const size_t from = r->colors ? first : 0;
    if (accessor >= 0)
        st = open_attribute(r, accessor, "COLOR_0", count - first, 3, 4, &numbers, err);
    if (st == CW_OK)
        st = cwi_mesh_grow(r->in, &r->colors, &r->color_room, count, 4, err);
    if (st == CW_OK) {
        memset(r->colors + 4 * from, 255, 4 * (count - from));
        convert_colors(&numbers, r->colors + 4 * first);
    }
    cwi_free(numbers.bytes);
    return st;
}

static cw_status add_vertices(reader *r, const instance *at, const cwi_gltf_primitive *p,
                              cw_error *err)
{
    const size_t first = r->build.point_count;
    cwi_gltf_numbers numbers = {0};
    cw_status st =
        cwi_gltf_open_numbers(&r->bytes, &r->scene, p->position, "POSITION", &numbers, err);
    if (st == CW_OK && numbers.numbers != 3)
        st = cw_fail(err, CW_ERR_FORMAT, "POSITION (accessor %d) has elements of %d numbers",
                     p->position, numbers.numbers);
    if (st == CW_OK)
        st = add_points(r, at, &numbers, err);
    cwi_free(numbers.bytes);
    if (st == CW_OK)
        st = add_normals(r, at, p->normal, first, err);
    return st == CW_OK ? add_colors(r, p->color, first, err) : st;
}

/* --- triangles --------------------------------------------------------------------------- */

enum { POINTS, LINES, LINE_LOOP, LINE_STRIP, TRIANGLES, STRIP, FAN };

/* The corners of triangle t; those of a strip are wound by turns. */
static void corners_of(int mode, size_t t, size_t corner[3])
{
    const size_t odd = t % 2;
    for (size_t c = 0; c < 3; c++)
        corner[c] = mode == TRIANGLES ? 3 * t + c
                    : mode == STRIP   ? t + (c == 0   ? 0
                                             : c == 1 ? 1 + odd
                                                      : 2 - odd)
                    : c == 2          ? 0
                                      : t + 1 + c;
}

/* Indices counted from the primitive's first vertex; without an accessor every vertex once. */
typedef struct corners {
    cwi_gltf_numbers numbers;
    bool listed;
    size_t count, vertices, first;
} corners;

static cw_status corner_vertex(const corners *c, size_t i, int64_t *vertex, cw_error *err)
{
    const double index = c->listed ? cwi_gltf_number(&c->numbers, i, 0) : (double)i;
    if (!(index < (double)c->vertices))
        return cw_fail(err, CW_ERR_FORMAT, "index %zu of a primitive names vertex %.0f of %zu",
                       i, index, c->vertices);
    *vertex = (int64_t)(c->first + (size_t)index);
    return CW_OK;
}

static cw_status add_triangles(reader *r, const corners *c, int mode, bool mirrored,
                               cw_error *err)
{
    const size_t count = mode == TRIANGLES ? c->count / 3 : c->count < 3 ? 0 : c->count - 2;
    const uint64_t total = (uint64_t)r->build.triangle_count + count;
    cw_status st = limit_scene(r, total, err);
    if (st == CW_OK)
        st = cwi_build_reserve(&r->build, 0, total, err);
    for (size_t t = 0; t < count && st == CW_OK; t++) {
        size_t corner[3];
        int64_t vertex = 0;
        corners_of(mode, t, corner);
        for (int k = 0; k < 3 && st == CW_OK; k++) {
            st = corner_vertex(c, corner[mirrored ? 2 - k : k], &vertex, err);
            if (st == CW_OK)
                st = cwi_build_corner(&r->build, vertex, err);
        }
        r->build.corners = 0;
    }
    return st;
}

static cw_status open_corners(const reader *r, const cwi_gltf_primitive *p, size_t first,
                              corners *c, cw_error *err)
{
    *c = (corners){
        .first = first, .vertices = r->build.point_count - first, .listed = p->indices >= 0};
    c->count = c->vertices;
    if (!c->listed)
        return CW_OK;
    cw_status st =
        cwi_gltf_open_numbers(&r->bytes, &r->scene, p->indices, "indices", &c->numbers, err);
    c->count = c->numbers.count;
    c->numbers.normalized = false;
    const int component = c->numbers.component;
    if (st == CW_OK && (c->numbers.numbers != 1 ||
                        (component != 5121 && component != 5123 && component != 5125)))
        return cw_fail(err, CW_ERR_FORMAT,
                       "indices (accessor %d) are of a type that is not read", p->indices);
    return st;
}

/* How many points or lines a primitive has that is not read. */
static size_t count_skipped(const cwi_gltf_scene *scene, const cwi_gltf_primitive *p)
{
    const int accessor = p->indices >= 0 ? p->indices : p->position;
    if (accessor < 0 || (size_t)accessor >= scene->accessor_count)
        return 0;
    const size_t count = (size_t)scene->accessors[accessor].count;
    return p->mode == LINES ? count / 2 : p->mode == LINE_STRIP && count ? count - 1 : count;
}

/* first: of the primitive's vertices, which are the last ones. */
static cw_status add_corners(reader *r, const instance *at, const cwi_gltf_primitive *p,
                             size_t first, cw_error *err)
{
    const bool mirrored = cwi_affine_determinant(at->place[0]) < 0;
    corners c;
    cw_status st = open_corners(r, p, first, &c, err);
    if (st == CW_OK && p->mode == TRIANGLES && c.count % 3)
        st = cw_fail(err, CW_ERR_FORMAT, "a primitive of triangles has %zu corners", c.count);
    if (st == CW_OK)
        st = add_triangles(r, &c, p->mode, mirrored, err);
    cwi_free(c.numbers.bytes);
    return st;
}

/* --- the scene --------------------------------------------------------------------------- */

static bool same_vertices(const cwi_gltf_primitive *p, const cwi_gltf_primitive *q)
{
    return p->position == q->position && p->normal == q->normal && p->color == q->color;
}

/* The primitives of a mesh often share their vertices: those of the one before are used again,
 * so that what is closed stays closed. */
static cw_status add_instance(reader *r, const instance *at, cw_mesh_file *said, cw_error *err)
{
    const cwi_gltf_mesh *mesh = &r->scene.meshes[at->mesh];
    const cwi_gltf_primitive *before = NULL;
    size_t first = 0;
    cw_status st = CW_OK;
    for (size_t i = mesh->first; i < mesh->end && st == CW_OK; i++) {
        const cwi_gltf_primitive *p = &r->scene.primitives[i];
        if (p->mode < POINTS || p->mode > FAN)
            return cw_fail(err, CW_ERR_FORMAT, "a primitive has the mode %d", p->mode);
        if (p->mode < TRIANGLES) {
            said->skipped += count_skipped(&r->scene, p);
            continue;
        }
        if (p->position < 0)
            return cw_fail(err, CW_ERR_FORMAT, "a primitive has no POSITION");
        if (!before || !same_vertices(before, p)) {
            first = r->build.point_count;
            st = add_vertices(r, at, p, err);
        }
        if (st == CW_OK)
            st = add_corners(r, at, p, first, err);
        said->parts++;
        before = p;
    }
    return st;
}

/* Where all instances are moved alike and not turned, their positions stay to the bit. */
static bool is_shifted(const reader *r)
{
    for (size_t i = 0; i < r->instance_count; i++)
        for (int a = 0; a < 3; a++)
            if (!r->instances[i].unturned ||
                r->instances[i].place[a][3] != r->instances[0].place[a][3])
                return false;
    return r->instance_count > 0;
}

/* The frame is known where each node says so and none has been turned since. */
static void describe(const reader *r, cw_mesh *mesh, cw_mesh_file *said)
{
    const instance *one = r->instances;
    bool lps = r->instance_count > 0;
    for (size_t i = 0; i < r->instance_count; i++)
        lps = lps && r->instances[i].unturned && r->instances[i].node->lps;
    said->known = CW_KNOWN_UNIT | (lps ? CW_KNOWN_FRAME : 0u);
    if (lps && r->instance_count == 1 && one->node->has_affine)
        memcpy(mesh->affine, one->node->affine, sizeof mesh->affine);
    for (int a = 0; a < 3 && r->shifted; a++)
        mesh->origin[a] = one->place[a][3];
}

/* As many as there are bytes in truth: a small file that draws itself over and over must not
 * take all memory. */
static uint64_t most_elements(const reader *r)
{
    uint64_t largest = 0;
    if (r->in->desc.max_triangles < UINT32_MAX) /* the caller knows */
        return 3 * r->in->desc.max_triangles + FREE_COUNT;
    for (size_t i = 0; i < r->scene.buffer_count; i++) {
        const uint64_t bytes = cwi_gltf_file_bytes(&r->bytes, &r->scene.buffers[i]);
        largest = bytes > largest ? bytes : largest;
    }
    return FREE_COUNT + r->in->file.size + largest;
}

static uint64_t claimed_count(const cwi_gltf_scene *scene, int accessor)
{
    const bool known = accessor >= 0 && (size_t)accessor < scene->accessor_count;
    const uint64_t count = known ? scene->accessors[accessor].count : 0;
    return count < UINT32_MAX ? count : UINT32_MAX;
}

/* What drawing a mesh once more adds, by its own words. */
static uint64_t claimed_size(const cwi_gltf_scene *scene, const cwi_gltf_mesh *mesh)
{
    uint64_t sum = 0;
    for (size_t i = mesh->first; i < mesh->end; i++) {
        const cwi_gltf_primitive *p = &scene->primitives[i];
        sum += (claimed_count(scene, p->position) + claimed_count(scene, p->indices)) / 3;
    }
    return sum;
}

/* Meshes that are drawn again and again are added up before the first one is. */
static cw_status check_repeats(const reader *r, cw_error *err)
{
    const size_t count = r->scene.mesh_count;
    uint64_t *sizes = cwi_alloc_zeroed(count, sizeof *sizes), sum = 0;
    cw_status st =
        sizes ? CW_OK : cw_fail(err, CW_ERR_NO_MEMORY, "no memory for %zu meshes", count);
    for (size_t i = 0; i < r->instance_count && st == CW_OK; i++) {
        const int mesh = r->instances[i].mesh;
        sum += sizes[mesh];
        st = limit_scene(r, sum, err);
        if (!sizes[mesh])
            sizes[mesh] = claimed_size(&r->scene, &r->scene.meshes[mesh]);
    }
    cwi_free(sizes);
    return st;
}

static cw_status build_scene(reader *r, cw_mesh *mesh, cw_mesh_file *said, cw_error *err)
{
    cw_status st = find_instances(r, said, err);
    r->shifted = st == CW_OK && is_shifted(r);
    r->most = most_elements(r);
    said->parts = 0;
    if (st == CW_OK)
        st = check_repeats(r, err);
    for (size_t i = 0; i < r->instance_count && st == CW_OK; i++) {
        st = cwi_progress(&r->in->desc.progress, "reading",
                          (double)i / (double)r->instance_count, err);
        if (st == CW_OK)
            st = add_instance(r, &r->instances[i], said, err);
    }
    if (st != CW_OK)
        return st;
    describe(r, mesh, said);
    mesh->colors = r->colors;
    r->colors = NULL;
    if (!r->no_normals) {
        mesh->normals = r->normals;
        r->normals = NULL;
    }
    return cwi_build_finish(&r->build, mesh, err);
}

static cw_status read_scene(cwi_mesh_input *in, bool binary, cw_mesh *mesh, cw_mesh_file *said,
                            cw_error *err)
{
    reader r = {.in = in, .build = {.in = in}, .bytes = {.in = &in->file}};
    uint64_t json = 0, json_size = in->file.size;
    cw_status st = binary ? find_chunks(&r, &json, &json_size, err) : CW_OK;
    if (st == CW_OK)
        st = parse_json(&r, json, json_size, err);
    if (st == CW_OK)
        st = build_scene(&r, mesh, said, err);
    cwi_build_free(&r.build);
    cwi_free(r.world);
    cwi_free(r.instances);
    cwi_free(r.normals);
    cwi_free(r.colors);
    cwi_gltf_scene_free(&r.scene);
    return st;
}

cw_status cwi_glb_read(cwi_mesh_input *in, cw_mesh *mesh, cw_mesh_file *said, cw_error *err)
{
    return read_scene(in, true, mesh, said, err);
}

cw_status cwi_gltf_read(cwi_mesh_input *in, cw_mesh *mesh, cw_mesh_file *said, cw_error *err)
{
    return read_scene(in, false, mesh, said, err);
}
