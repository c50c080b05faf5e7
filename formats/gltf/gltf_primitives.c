/* Adds the primitives of a glTF mesh: vertices and triangles, placed by a node. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/affine.h"
#include "formats/gltf/gltf_reader.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

/* --- vertices ---------------------------------------------------------------------------- */

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

static cw_status open_attribute(const cwi_gltf_reader *r, int accessor, const char *what,
                                size_t count, int min, int max, cwi_gltf_numbers *numbers,
                                cw_error *err)
{
    cw_status st = cwi_gltf_open_numbers(&r->bytes, &r->scene, accessor, what, numbers, err);
    if (st != CW_OK)
        return st;
    if (numbers->numbers < min || numbers->numbers > max)
        return cwi_fail(err, CW_ERR_FORMAT, "%s (accessor %d) has elements of %d numbers", what,
                        accessor, numbers->numbers);
    if (numbers->count != count)
        return cwi_fail(err, CW_ERR_FORMAT,
                        "%s (accessor %d) has %zu elements; POSITION has %zu", what, accessor,
                        numbers->count, count);
    return CW_OK;
}

static cw_status add_points(cwi_gltf_reader *r, const cwi_gltf_instance *at,
                            const cwi_gltf_numbers *numbers, cw_error *err)
{
    cw_status st = cwi_gltf_limit(r, (uint64_t)r->build.point_count + numbers->count, err);
    if (st == CW_OK)
        st = cwi_build_reserve(&r->build, (uint64_t)r->build.point_count + numbers->count, 0,
                               err);
    for (size_t i = 0; i < numbers->count && st == CW_OK; i++) {
        double p[3], moved[3];
        for (int a = 0; a < 3; a++)
            p[a] = cwi_gltf_number(numbers, i, a);
        cwi_affine_apply(at->transform[0], p, moved);
        st = cwi_build_point(&r->build, r->shifted ? p : moved, err);
    }
    return st;
}

enum { FLOAT = 5126 };

/* Turns a normal by the inverse transpose, which keeps it outward in a mirror, too. */
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

static cw_status add_normals(cwi_gltf_reader *r, const cwi_gltf_instance *at, int accessor,
                             size_t first, cw_error *err)
{
    cwi_gltf_numbers numbers = {0};
    double cofactor[3][3];
    r->no_normals = r->no_normals || accessor < 0;
    if (r->no_normals)
        return CW_OK;
    cw_status st = open_attribute(r, accessor, "NORMAL", r->build.point_count - first, 3, 3,
                                  &numbers, err);
    if (st == CW_OK)
        st = cwi_mesh_grow(r->in, &r->normals, &r->normal_capacity, r->build.point_count,
                           3 * sizeof *r->normals, err);
    cwi_affine_cofactor(at->transform[0], cofactor);
    const double sign = cwi_affine_determinant(at->transform[0]) < 0 ? -1 : 1;
    const bool exact = at->unturned && numbers.component == FLOAT; /* integers are rounded */
    for (size_t i = 0; i < numbers.count && st == CW_OK; i++) {
        double n[3];
        float *to = r->normals + 3 * (first + i);
        for (int a = 0; a < 3; a++)
            n[a] = cwi_gltf_number(&numbers, i, a);
        for (int a = 0; a < 3 && exact; a++)
            to[a] = (float)n[a];
        if (!exact)
            turn_normal(cofactor, sign, n, to);
    }
    cwi_free(numbers.bytes);
    return st;
}

/* Converts linear light from 0 to 1 into sRGB from 0 to 255; alpha is linear in both. */
static uint8_t to_srgb(double linear, bool is_alpha)
{
    const double c = linear > 0 ? fmin(linear, 1) : 0;
    const double s = is_alpha         ? c
                     : c <= 0.0031308 ? 12.92 * c
                                      : 1.055 * pow(c, 1 / 2.4) - 0.055;
    return (uint8_t)lround(255 * s);
}

const cwi_gltf_material *cwi_gltf_material_of(const cwi_gltf_reader *r,
                                              const cwi_gltf_primitive *p)
{
    return p->material >= 0 && (size_t)p->material < r->scene.material_count
               ? &r->scene.materials[p->material]
               : NULL;
}

void cwi_gltf_base_color(const cwi_gltf_material *m, uint8_t color[4])
{
    for (int c = 0; c < 4; c++)
        color[c] = m ? to_srgb(m->base[c], c == 3) : 255;
}

/* Converts colours, times the base colour. Those of bytes are looked up, in four tables of 256. */
static void convert_colors(const cwi_gltf_numbers *numbers, const double base[4], uint8_t *to)
{
    uint8_t table[4][256];
    const bool bytes = numbers->component == 5121 && numbers->normalized;
    for (int i = 0; i < 256 && bytes; i++)
        for (int c = 0; c < 4; c++)
            table[c][i] = to_srgb(base[c] * i / 255, c == 3);
    for (size_t i = 0; i < numbers->count; i++)
        for (int c = 0; c < numbers->numbers; c++)
            to[4 * i + (size_t)c] =
                bytes ? table[c][numbers->bytes[i * numbers->stride + (size_t)c]]
                      : to_srgb(base[c] * cwi_gltf_number(numbers, i, c), c == 3);
}

/* Gives the vertices before `first` the colours of their triangles' materials. */
static void color_earlier(cwi_gltf_reader *r, size_t first)
{
    const cwi_face_colors *f = &r->materials;
    memset(r->colors, 255, 4 * first);
    for (size_t i = 0; i < 3 * f->count; i++)
        if (r->build.triangles[i] < first)
            memcpy(r->colors + 4 * (size_t)r->build.triangles[i], f->colors + 4 * (i / 3), 4);
}

/* Adds colours of vertices: those of COLOR_0 times the base colour. A primitive without COLOR_0 among
 * others that have some has its base colour everywhere. */
static cw_status add_colors(cwi_gltf_reader *r, const cwi_gltf_primitive *p, size_t first,
                            cw_mesh_file *metadata, cw_error *err)
{
    static const double white[4] = {1, 1, 1, 1};
    const size_t count = r->build.point_count;
    const cwi_gltf_material *m = cwi_gltf_material_of(r, p);
    cwi_gltf_numbers numbers = {0};
    uint8_t base[4];
    cw_status st = CW_OK;
    if (p->color < 0 && !r->colors)
        return CW_OK;
    const bool is_first = !r->colors;
    if (p->color >= 0)
        st = open_attribute(r, p->color, "COLOR_0", count - first, 3, 4, &numbers, err);
    if (st == CW_OK && numbers.count && numbers.component != FLOAT && !numbers.normalized) {
        numbers.normalized = true; /* as it was meant: 1 of 65535 is no colour */
        if (!*metadata->fault)
            snprintf(metadata->fault, sizeof metadata->fault,
                     "accessors[%d].normalized is not true, as COLOR_0 of whole numbers needs",
                     p->color);
    }
    if (st == CW_OK)
        st = cwi_mesh_grow(r->in, &r->colors, &r->color_capacity, count, 4, err);
    if (st == CW_OK) {
        if (is_first)
            color_earlier(r, first);
        cwi_gltf_base_color(m, base);
        for (size_t v = first; v < count; v++)
            memcpy(r->colors + 4 * v, base, 4);
        convert_colors(&numbers, m ? m->base : white, r->colors + 4 * first);
    }
    cwi_free(numbers.bytes);
    return st;
}

/* Gives the triangles of a primitive the colour of its material. */
static cw_status color_triangles(cwi_gltf_reader *r, const cwi_gltf_primitive *p, cw_error *err)
{
    const cwi_gltf_material *m = cwi_gltf_material_of(r, p);
    uint8_t color[4];
    r->has_colors = r->has_colors || p->color >= 0 || (m && !m->is_plain);
    r->has_texture = r->has_texture || (m && m->has_texture);
    r->has_texcoords = r->has_texcoords || p->has_texcoords;
    if (!r->any_base)
        return CW_OK;
    cwi_gltf_base_color(m, color);
    return cwi_color_faces(&r->materials, r->build.triangle_count, color, err);
}

/* Compares the stated bounds of an accessor with its numbers, where they are as they were written.
 * Bounds may have gone through single precision, or be written with as many digits. */
static void check_bounds(const cwi_gltf_reader *r, const cwi_gltf_primitive *p,
                         const cwi_gltf_numbers *numbers, cw_mesh_file *metadata)
{
    const cwi_gltf_accessor *stated = &r->scene.accessors[p->position];
    const bool is_packed =
        r->bytes.unpacked == p ||
        (stated->view >= 0 && r->scene.views[stated->view].packed_buffer >= 0);
    if (*metadata->fault || !stated->has_bounds || numbers->normalized || is_packed)
        return;
    for (int a = 0; a < 3; a++) {
        double min = INFINITY, max = -INFINITY;
        for (size_t i = 0; i < numbers->count; i++) {
            min = fmin(min, cwi_gltf_number(numbers, i, a));
            max = fmax(max, cwi_gltf_number(numbers, i, a));
        }
        const double rounding = 1e-6 * fmax(fabs(min), fabs(max));
        const bool is_max = !(fabs(stated->max[a] - max) <= rounding);
        if (!is_max && fabs(stated->min[a] - min) <= rounding)
            continue;
        snprintf(metadata->fault, sizeof metadata->fault,
                 "accessors[%d].%s[%d] is %.9g; its positions %s %.9g", p->position,
                 is_max ? "max" : "min", a, is_max ? stated->max[a] : stated->min[a],
                 is_max ? "reach" : "begin at", is_max ? max : min);
        return;
    }
}

static cw_status add_vertices(cwi_gltf_reader *r, const cwi_gltf_instance *at,
                              const cwi_gltf_primitive *p, cw_mesh_file *metadata,
                              cw_error *err)
{
    const size_t first = r->build.point_count;
    cwi_gltf_numbers numbers = {0};
    cw_status st =
        cwi_gltf_open_numbers(&r->bytes, &r->scene, p->position, "POSITION", &numbers, err);
    if (st == CW_OK && numbers.numbers != 3)
        st = cwi_fail(err, CW_ERR_FORMAT, "POSITION (accessor %d) has elements of %d numbers",
                      p->position, numbers.numbers);
    if (st == CW_OK)
        st = add_points(r, at, &numbers, err);
    if (st == CW_OK)
        check_bounds(r, p, &numbers, metadata);
    cwi_free(numbers.bytes);
    if (st == CW_OK)
        st = add_normals(r, at, p->normal, first, err);
    return st == CW_OK ? add_colors(r, p, first, metadata, err) : st;
}

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
                              size_t first, corners *c, cw_error *err)
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
static cw_status add_corners(cwi_gltf_reader *r, const cwi_gltf_instance *at,
                             const cwi_gltf_primitive *p, size_t first, cw_error *err)
{
    const bool mirrored = cwi_affine_determinant(at->transform[0]) < 0;
    corners c;
    cw_status st = open_corners(r, p, first, &c, err);
    if (st == CW_OK && p->mode == TRIANGLES && c.count % 3)
        st = cwi_fail(err, CW_ERR_FORMAT, "a primitive of triangles has %zu corners", c.count);
    if (st == CW_OK)
        st = add_triangles(r, &c, p->mode, mirrored, err);
    cwi_free(c.numbers.bytes);
    return st;
}

/* --- meshes ------------------------------------------------------------------------------ */

static bool same_vertices(const cwi_gltf_primitive *p, const cwi_gltf_primitive *q)
{
    return p->position == q->position && p->normal == q->normal && p->color == q->color &&
           (p->color < 0 || p->material == q->material);
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
    const cwi_draco_ids ids = {p->draco_position, p->draco_normal, p->draco_color};
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

/* Adds an instance of a mesh. The primitives of a mesh often share their vertices. Then the
 * vertices of the one before are used again, so that closed surfaces stay closed. */
cw_status cwi_gltf_add_instance(cwi_gltf_reader *r, const cwi_gltf_instance *at,
                                cw_mesh_file *metadata, cw_error *err)
{
    const cwi_gltf_mesh *mesh = &r->scene.meshes[at->mesh];
    const cwi_gltf_primitive *before = NULL;
    size_t first = 0;
    cw_status st = CW_OK;
    for (size_t i = mesh->first; i < mesh->end && st == CW_OK; i++) {
        const cwi_gltf_primitive *p = &r->scene.primitives[i];
        if (p->mode < POINTS || p->mode > FAN)
            return cwi_fail(err, CW_ERR_FORMAT, "a primitive has the mode %d", p->mode);
        if (p->mode < TRIANGLES) {
            metadata->skipped += count_skipped(&r->scene, p);
            continue;
        }
        if (p->position < 0)
            return cwi_fail(err, CW_ERR_FORMAT, "a primitive has no POSITION");
        st = unpack_primitive(r, p, err);
        if (st == CW_OK && (!before || p->draco >= 0 || !same_vertices(before, p))) {
            first = r->build.point_count;
            st = add_vertices(r, at, p, metadata, err);
        }
        if (st == CW_OK)
            st = add_corners(r, at, p, first, err);
        if (st == CW_OK)
            st = color_triangles(r, p, err);
        metadata->parts++;
        before = p;
    }
    return st;
}
