/* Adds the vertices of a glTF primitive: positions, normals and colours, placed by a node or by the
 * joints of a skin. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/affine.h"
#include "formats/gltf/gltf_reader.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

cw_status cwi_gltf_open_attribute(const cwi_gltf_reader *r, int accessor, const char *what,
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

/* Closes arrays, unless the next instance needs them. */
static void close_numbers(const cwi_gltf_reader *r, cwi_gltf_numbers *numbers)
{
    if (r->keeps_shapes)
        return;
    cwi_free(numbers->bytes);
    numbers->bytes = NULL;
}

/* Returns vector i: of the morphed ones, or else as it is in the file. */
static void take_vector(const cwi_gltf_numbers *numbers, const double *morphed, size_t i,
                        double v[3])
{
    for (int a = 0; a < 3; a++)
        v[a] = morphed ? morphed[3 * i + (size_t)a] : cwi_gltf_number(numbers, i, a);
}

/* Finds the map of vertex i to LPS millimetres: that of its joints, or of the node. */
static cw_status find_map(const cwi_gltf_instance *at, const cwi_gltf_shape *shape, size_t i,
                          double blended[12], const double **map, cw_error *err)
{
    *map = at->transform[0];
    if (!shape->sets)
        return CW_OK;
    *map = blended;
    return cwi_gltf_blend_joints(at->pose, shape, i, blended, err);
}

/* Adds the points of a primitive. A skin mirrors its triangles if it mirrors most of its
 * vertices. */
static cw_status add_points(cwi_gltf_reader *r, const cwi_gltf_instance *at,
                            const cwi_gltf_shape *shape, cw_error *err)
{
    const size_t count = shape->position.count;
    size_t mirrored = 0;
    cw_status st = cwi_gltf_limit(r, (uint64_t)r->build.point_count + count, err);
    if (st == CW_OK)
        st = cwi_build_reserve(&r->build, (uint64_t)r->build.point_count + count, 0, err);
    for (size_t i = 0; i < count && st == CW_OK; i++) {
        double p[3], moved[3], blended[12];
        const double *map;
        take_vector(&shape->position, shape->morphed[0], i, p);
        st = find_map(at, shape, i, blended, &map, err);
        if (st != CW_OK)
            break;
        cwi_affine_apply(map, p, moved);
        if (shape->sets)
            mirrored += cwi_affine_determinant(map) < 0;
        st = cwi_build_point(&r->build, r->shifted ? p : moved, err);
    }
    r->is_mirrored =
        shape->sets ? mirrored > count / 2 : cwi_affine_determinant(at->transform[0]) < 0;
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

/* Opens the normals of a primitive, with those that morph targets displace. */
static cw_status open_normals(cwi_gltf_reader *r, const cwi_gltf_instance *at,
                              const cwi_gltf_primitive *p, size_t count, cwi_gltf_shape *shape,
                              cw_mesh_file *metadata, cw_error *err)
{
    if (shape->normal.bytes)
        return CW_OK;
    cw_status st =
        cwi_gltf_open_attribute(r, p->normal, "NORMAL", count, 3, 3, &shape->normal, err);
    return st == CW_OK ? cwi_gltf_morph(r, at->node, p, true, &shape->normal,
                                        &shape->morphed[1], metadata, err)
                       : st;
}

static cw_status put_normal(const cwi_gltf_instance *at, const cwi_gltf_shape *shape, size_t i,
                            float *to, cw_error *err)
{
    double n[3], blended[12], cofactor[3][3];
    const double *map;
    take_vector(&shape->normal, shape->morphed[1], i, n);
    if (at->unturned && !shape->morphed[1] &&
        shape->normal.component == FLOAT) { /* integers are rounded */
        for (int a = 0; a < 3; a++)
            to[a] = (float)n[a];
        return CW_OK;
    }
    cw_status st = find_map(at, shape, i, blended, &map, err);
    if (st != CW_OK)
        return st;
    cwi_affine_cofactor(map, cofactor);
    turn_normal(cofactor, cwi_affine_determinant(map) < 0 ? -1 : 1, n, to);
    return CW_OK;
}

static cw_status add_normals(cwi_gltf_reader *r, const cwi_gltf_instance *at,
                             const cwi_gltf_primitive *p, size_t first, cwi_gltf_shape *shape,
                             cw_mesh_file *metadata, cw_error *err)
{
    const size_t count = r->build.point_count - first;
    r->no_normals = r->no_normals || p->normal < 0;
    if (r->no_normals)
        return CW_OK;
    cw_status st = open_normals(r, at, p, count, shape, metadata, err);
    if (st == CW_OK)
        st = cwi_mesh_grow(r->in, &r->normals, &r->normal_capacity, r->build.point_count,
                           3 * sizeof *r->normals, err);
    for (size_t i = 0; i < count && st == CW_OK; i++)
        st = put_normal(at, shape, i, r->normals + 3 * (first + i), err);
    close_numbers(r, &shape->normal);
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
    for (size_t i = 0; f->colors && i < 3 * f->count; i++)
        if (r->build.triangles[i] < first)
            memcpy(r->colors + 4 * (size_t)r->build.triangles[i], f->colors + 4 * (i / 3), 4);
}

/* Adds colours of vertices: those of COLOR_0 times the base colour. A primitive without COLOR_0 among
 * others that have some has its base colour everywhere. */
static cw_status add_colors(cwi_gltf_reader *r, const cwi_gltf_primitive *p, size_t first,
                            cwi_gltf_shape *shape, cw_mesh_file *metadata, cw_error *err)
{
    static const double white[4] = {1, 1, 1, 1};
    const size_t count = r->build.point_count;
    const cwi_gltf_material *m = cwi_gltf_material_of(r, p);
    cwi_gltf_numbers *numbers = &shape->color;
    uint8_t base[4];
    cw_status st = CW_OK;
    if (p->color < 0 && !r->colors)
        return CW_OK;
    const bool is_first = !r->colors;
    if (p->color >= 0 && !numbers->bytes)
        st = cwi_gltf_open_attribute(r, p->color, "COLOR_0", count - first, 3, 4, numbers, err);
    if (st == CW_OK && numbers->count && numbers->component != FLOAT && !numbers->normalized) {
        numbers->normalized = true; /* as it was meant: 1 of 65535 is no colour */
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
        convert_colors(numbers, m ? m->base : white, r->colors + 4 * first);
    }
    close_numbers(r, numbers);
    return st;
}

const cwi_gltf_look *cwi_gltf_look_of(const cwi_gltf_reader *r, const cwi_gltf_primitive *p)
{
    return r->looks && cwi_gltf_material_of(r, p) ? &r->looks[p->material] : NULL;
}

/* Adds the texture coordinates of vertices, moved as the material says; 0 where there are none. */
static cw_status add_places(cwi_gltf_reader *r, const cwi_gltf_primitive *p, size_t first,
                            cwi_gltf_shape *shape, cw_error *err)
{
    const size_t count = r->build.point_count;
    const cwi_gltf_look *look = cwi_gltf_look_of(r, p);
    cwi_gltf_numbers *numbers = &shape->place;
    const bool is_first = !r->places;
    cw_status st = CW_OK;
    if (p->texture < 0 && is_first)
        return CW_OK;
    if (p->texture >= 0 && !numbers->bytes)
        st = cwi_gltf_open_attribute(r, p->texture, "TEXCOORD_0", count - first, 2, 2, numbers,
                                     err);
    if (st == CW_OK)
        st = cwi_mesh_grow(r->in, &r->places, &r->place_capacity, count, 2 * sizeof *r->places,
                           err);
    if (st == CW_OK)
        memset(r->places + (is_first ? 0 : 2 * first), 0,
               2 * (is_first ? count : count - first) * sizeof *r->places);
    for (size_t i = 0; st == CW_OK && i < numbers->count; i++) {
        const double u = cwi_gltf_number(numbers, i, 0), v = cwi_gltf_number(numbers, i, 1);
        for (size_t k = 0; k < 2; k++) {
            const double *m = look ? look->transform[k] : NULL;
            const double place = look && look->moves ? m[0] * u + m[1] * v + m[2] : k ? v : u;
            r->places[2 * (first + i) + k] = isfinite(place) ? (float)place : 0;
        }
    }
    close_numbers(r, numbers);
    return st;
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

/* Opens the positions of a primitive, with those that morph targets displace. */
static cw_status open_positions(cwi_gltf_reader *r, const cwi_gltf_instance *at,
                                const cwi_gltf_primitive *p, cwi_gltf_shape *shape,
                                cw_mesh_file *metadata, cw_error *err)
{
    cwi_gltf_numbers *numbers = &shape->position;
    if (numbers->bytes)
        return CW_OK;
    cw_status st =
        cwi_gltf_open_numbers(&r->bytes, &r->scene, p->position, "POSITION", numbers, err);
    if (st == CW_OK && numbers->numbers != 3)
        st = cwi_fail(err, CW_ERR_FORMAT, "POSITION (accessor %d) has elements of %d numbers",
                      p->position, numbers->numbers);
    if (st == CW_OK)
        check_bounds(r, p, numbers, metadata);
    return st == CW_OK ? cwi_gltf_morph(r, at->node, p, false, numbers, &shape->morphed[0],
                                        metadata, err)
                       : st;
}

cw_status cwi_gltf_add_vertices(cwi_gltf_reader *r, const cwi_gltf_instance *at,
                                const cwi_gltf_primitive *p, cwi_gltf_shape *shape,
                                cw_mesh_file *metadata, cw_error *err)
{
    const size_t first = r->build.point_count;
    cw_status st = open_positions(r, at, p, shape, metadata, err);
    if (st == CW_OK)
        st = cwi_gltf_open_influences(r, at, p, shape->position.count, shape, err);
    if (st == CW_OK)
        st = add_points(r, at, shape, err);
    close_numbers(r, &shape->position);
    if (st == CW_OK)
        st = add_normals(r, at, p, first, shape, metadata, err);
    if (st == CW_OK)
        st = add_places(r, p, first, shape, err);
    return st == CW_OK ? add_colors(r, p, first, shape, metadata, err) : st;
}
