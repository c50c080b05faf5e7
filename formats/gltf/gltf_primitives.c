/* Adds the primitives of a glTF mesh: their vertices, and the triangles between them. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "formats/gltf/gltf_reader.h"

#include <string.h>

/* --- triangles --------------------------------------------------------------------------- */

enum { POINTS, LINES, LINE_LOOP, LINE_STRIP, TRIANGLES, STRIP, FAN };

/* Returns the corners of triangle t; the winding of a strip's triangles alternates. */
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

/* Indices relative to the primitive's first vertex; without an accessor every vertex once. */
typedef struct corners {
    cwi_gltf_numbers numbers;
    bool listed;
    size_t count, vertices, first;
} corners;

static cw_status corner_vertex(const corners *c, size_t i, int64_t *vertex, cw_error *err)
{
    const double index = c->listed ? cwi_gltf_number(&c->numbers, i, 0) : (double)i;
    if (!(index < (double)c->vertices))
        return cwi_fail(err, CW_ERR_FORMAT, "index %zu of a primitive names vertex %.0f of %zu",
                        i, index, c->vertices);
    *vertex = (int64_t)(c->first + (size_t)index);
    return CW_OK;
}

static cw_status add_triangles(cwi_gltf_reader *r, const corners *c, int mode, bool mirrored,
                               cw_error *err)
{
    const size_t count = mode == TRIANGLES ? c->count / 3 : c->count < 3 ? 0 : c->count - 2;
    const uint64_t total = (uint64_t)r->build.triangle_count + count;
    cw_status st = cwi_gltf_limit(r, total, err);
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

static cw_status open_corners(const cwi_gltf_reader *r, const cwi_gltf_primitive *p,
                              size_t first, cwi_gltf_numbers *indices, corners *c,
                              cw_error *err)
{
    *c = (corners){
        .first = first, .vertices = r->build.point_count - first, .listed = p->indices >= 0};
    c->count = c->vertices;
    if (!c->listed)
        return CW_OK;
    cw_status st = indices->bytes ? CW_OK
                                  : cwi_gltf_open_numbers(&r->bytes, &r->scene, p->indices,
                                                          "indices", indices, err);
    c->numbers = *indices;
    c->count = c->numbers.count;
    c->numbers.normalized = false;
    const int component = c->numbers.component;
    if (st == CW_OK && (c->numbers.numbers != 1 ||
                        (component != 5121 && component != 5123 && component != 5125)))
        return cwi_fail(err, CW_ERR_FORMAT,
                        "indices (accessor %d) are of a type that is not read", p->indices);
    return st;
}

/* Counts the points or lines of a primitive that is not read. */
static size_t count_skipped(const cwi_gltf_scene *scene, const cwi_gltf_primitive *p)
{
    const int accessor = p->indices >= 0 ? p->indices : p->position;
    if (accessor < 0 || (size_t)accessor >= scene->accessor_count)
        return 0;
    const size_t count = (size_t)scene->accessors[accessor].count;
    return p->mode == LINES ? count / 2 : p->mode == LINE_STRIP && count ? count - 1 : count;
}

/* Adds the triangles of a primitive. first: index of its first vertex; its vertices are the
 * last ones. */
static cw_status add_corners(cwi_gltf_reader *r, const cwi_gltf_primitive *p, size_t first,
                             cwi_gltf_numbers *indices, cw_error *err)
{
    corners c;
    cw_status st = open_corners(r, p, first, indices, &c, err);
    if (st == CW_OK && p->mode == TRIANGLES && c.count % 3)
        st = cwi_fail(err, CW_ERR_FORMAT, "a primitive of triangles has %zu corners", c.count);
    if (st == CW_OK)
        st = add_triangles(r, &c, p->mode, r->is_mirrored, err);
    if (!r->keeps_shapes) {
        cwi_free(indices->bytes);
        indices->bytes = NULL;
    }
    return st;
}

/* --- meshes ------------------------------------------------------------------------------ */

static bool same_vertices(const cwi_gltf_primitive *p, const cwi_gltf_primitive *q)
{
    return p->position == q->position && p->normal == q->normal && p->color == q->color &&
           p->texture == q->texture && (p->color < 0 || p->material == q->material) &&
           p->end_target == p->first_target && q->end_target == q->first_target &&
           memcmp(p->joints, q->joints, sizeof p->joints) == 0 &&
           memcmp(p->weights, q->weights, sizeof p->weights) == 0;
}

/* Returns true if the materials of two primitives place texture coordinates alike. */
static bool same_look(const cwi_gltf_reader *r, const cwi_gltf_primitive *p,
                      const cwi_gltf_primitive *q)
{
    const cwi_gltf_look *a = cwi_gltf_look_of(r, p), *b = cwi_gltf_look_of(r, q);
    const bool a_moves = a && a->moves, b_moves = b && b->moves;
    return a_moves == b_moves &&
           (!a_moves || memcmp(a->transform, b->transform, sizeof a->transform) == 0);
}

static uint64_t count_of(const cwi_gltf_scene *scene, int accessor)
{
    return accessor >= 0 && (size_t)accessor < scene->accessor_count
               ? scene->accessors[accessor].count
               : 0;
}

/* Decodes a primitive that Draco compressed, unless the file also has it uncompressed. */
static cw_status unpack_primitive(cwi_gltf_reader *r, const cwi_gltf_primitive *p,
                                  cw_error *err)
{
    const cwi_gltf_scene *scene = &r->scene;
    const cwi_draco_ids ids = {p->draco_position, p->draco_normal, p->draco_color,
                               p->draco_texture, -1};
    const uint64_t points = count_of(scene, p->position), indices = count_of(scene, p->indices);
    unsigned char *packed = NULL;
    r->bytes.unpacked = NULL;
    cwi_arrays_free(&r->arrays);
    if (p->draco < 0 || (size_t)p->position >= scene->accessor_count ||
        scene->accessors[p->position].view >= 0)
        return CW_OK;
    if ((size_t)p->draco >= scene->view_count)
        return cwi_fail(err, CW_ERR_FORMAT, "a primitive names bufferView %d; there are %zu",
                        p->draco, scene->view_count);
    const cwi_gltf_view *v = &scene->views[p->draco];
    cw_status st =
        cwi_gltf_load(&r->bytes, scene, (uint64_t)v->buffer, v->offset, v->bytes, &packed, err);
    if (st == CW_OK)
        st = cwi_gltf_unpack_draco(&r->unpacker, &ids, packed, (size_t)v->bytes, points,
                                   indices, &r->arrays, err);
    cwi_free(packed);
    r->bytes.unpacked = st == CW_OK ? p : NULL;
    r->bytes.arrays = &r->arrays;
    return st;
}

/* Gives the triangles of a primitive the colour of its material. */
static cw_status color_triangles(cwi_gltf_reader *r, const cwi_gltf_primitive *p, cw_error *err)
{
    const cwi_gltf_material *m = cwi_gltf_material_of(r, p);
    uint8_t color[4];
    r->has_colors = r->has_colors || p->color >= 0 || (m && !m->is_plain);
    if (!r->any_base)
        return CW_OK;
    cwi_gltf_base_color(m, color);
    return cwi_color_faces(&r->materials, r->build.triangle_count, color, err);
}

static void close_shape(cwi_gltf_shape *shape)
{
    cwi_gltf_numbers *const all[] = {&shape->position, &shape->normal, &shape->color,
                                     &shape->place, &shape->indices};
    for (size_t n = 0; n < sizeof all / sizeof *all; n++)
        cwi_free(all[n]->bytes);
    for (size_t n = 0; n < CWI_GLTF_SETS; n++) {
        cwi_free(shape->joints[n].bytes);
        cwi_free(shape->weights[n].bytes);
    }
    cwi_free(shape->morphed[0]);
    cwi_free(shape->morphed[1]);
    *shape = (cwi_gltf_shape){0};
}

void cwi_gltf_free_shapes(cwi_gltf_reader *r)
{
    for (size_t i = 0; i < r->shape_count; i++)
        close_shape(&r->shapes[i]);
    cwi_free(r->shapes);
    r->shapes = NULL;
    r->shape_count = 0;
}

/* Makes shapes for the primitives of a mesh that the next instance draws, too. */
static cw_status keep_shapes(cwi_gltf_reader *r, const cwi_gltf_mesh *mesh, cw_error *err)
{
    if (r->shapes || !r->keeps_shapes)
        return CW_OK;
    r->shapes = cwi_alloc_zeroed(mesh->end - mesh->first, sizeof *r->shapes);
    r->shape_count = r->shapes ? mesh->end - mesh->first : 0;
    return r->shapes ? CW_OK : cwi_fail_memory(err);
}

/* The vertices that the primitives of a mesh added last. */
typedef struct last_vertices {
    const cwi_gltf_primitive *of; /* NULL: none */
    size_t first;
} last_vertices;

static cw_status add_primitive(cwi_gltf_reader *r, const cwi_gltf_instance *at,
                               const cwi_gltf_primitive *p, last_vertices *last,
                               cwi_gltf_shape *shape, cw_mesh_file *metadata, cw_error *err)
{
    const cwi_gltf_look *look = cwi_gltf_look_of(r, p);
    cw_status st = shape->is_loaded ? CW_OK : unpack_primitive(r, p, err);
    if (st == CW_OK && r->in->pictures.set_count)
        st = cwi_mesh_begin_textures(r->in, look ? look->textures : 0, r->build.triangle_count,
                                     err);
    if (st == CW_OK && (!last->of || p->draco >= 0 || !same_vertices(last->of, p) ||
                        !same_look(r, last->of, p))) {
        last->first = r->build.point_count;
        st = cwi_gltf_add_vertices(r, at, p, shape, metadata, err);
    }
    if (st == CW_OK)
        st = add_corners(r, p, last->first, &shape->indices, err);
    shape->is_loaded = true;
    last->of = p;
    return st == CW_OK ? color_triangles(r, p, err) : st;
}

/* Adds an instance of a mesh. The primitives of a mesh often share their vertices. Then the
 * vertices of the one before are used again, so that closed surfaces stay closed. */
cw_status cwi_gltf_add_instance(cwi_gltf_reader *r, const cwi_gltf_instance *at,
                                cw_mesh_file *metadata, cw_error *err)
{
    const cwi_gltf_mesh *mesh = &r->scene.meshes[at->mesh];
    last_vertices last = {0};
    bool is_drawn = false;
    cw_status st = keep_shapes(r, mesh, err);
    for (size_t i = mesh->first; i < mesh->end && st == CW_OK; i++) {
        const cwi_gltf_primitive *p = &r->scene.primitives[i];
        cwi_gltf_shape own = {0};
        if (p->mode < POINTS || p->mode > FAN)
            return cwi_fail(err, CW_ERR_FORMAT, "a primitive has the mode %d", p->mode);
        if (p->mode < TRIANGLES) {
            metadata->skipped += count_skipped(&r->scene, p);
            continue;
        }
        if (p->position < 0)
            return cwi_fail(err, CW_ERR_FORMAT, "a primitive has no POSITION");
        st = add_primitive(r, at, p, &last, r->shapes ? &r->shapes[i - mesh->first] : &own,
                           metadata, err);
        close_shape(&own);
        is_drawn = true;
    }
    metadata->parts += is_drawn;
    if (!r->keeps_shapes)
        cwi_gltf_free_shapes(r);
    return st;
}
