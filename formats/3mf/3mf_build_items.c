/* Places the objects of a 3MF package as its build items and components state. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/affine.h"
#include "formats/3mf/3mf.h"
#include "formats/mesh/face_colors.h"

#include <math.h>
#include <string.h>

/* Maximums: the depth of nested components, the number of placings, and the number of triangles
 * and points that may be drawn in any case. */
enum { DEEPEST = 64, MAX_PLACINGS = 1 << 20, FREE_COUNT = 1 << 26 };

/* A placed mesh of an object. */
typedef struct instance {
    size_t object;
    double transform[12];
    bool starts_part; /* it is the first of a build item */
    size_t name;
} instance;

typedef struct placing {
    cwi_3mf *m;
    instance *instances;
    size_t count, capacity;
    size_t visits;
    uint64_t drawn, max; /* points and triangles */
} placing;

/* --- instances ------------------------------------------------------------------------- */

static void multiply_transforms(const double *a, const double *b, double *out)
{
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 4; c++)
            out[4 * r + c] = a[4 * r] * b[c] + a[4 * r + 1] * b[4 + c] +
                             a[4 * r + 2] * b[8 + c] + (c == 3 ? a[4 * r + 3] : 0);
}

static cw_status add_instance(placing *p, size_t index, const double *transform, cw_error *err)
{
    const cwi_3mf_object *o = &p->m->objects[index];
    p->drawn += o->end_point - o->first_point + o->end_triangle - o->first_triangle;
    if (p->drawn > p->max)
        return cwi_fail(
            err, CW_ERR_LIMIT,
            "objects are placed so often that their points and triangles are more than "
            "%llu; state a limit if that is meant (desc->max_triangles)",
            (unsigned long long)p->max);
    cw_status st = cwi_mesh_grow(p->m->in, &p->instances, &p->capacity, p->count + 1,
                                 sizeof *p->instances, err);
    if (st == CW_OK) {
        instance *i = &p->instances[p->count++];
        *i = (instance){.object = index};
        memcpy(i->transform, transform, sizeof i->transform);
    }
    return st;
}

/* Counts the triangles of an object that is left out, or of its components. */
static void count_left_out(const placing *p, cwi_3mf_type type, const cwi_3mf_object *o)
{
    cw_mesh_file *metadata = p->m->metadata;
    const size_t triangles = o->end_triangle - o->first_triangle;
    if (type == CWI_3MF_SUPPORT)
        metadata->support_triangles += triangles;
    if (type == CWI_3MF_OTHER)
        metadata->other_triangles += triangles;
}

/* Visits a component. Components nest no deeper than DEEPEST, so this recursion goes no deeper,
 * either. A left-out object leaves out its components: `type` is that of the outermost such
 * object. */
static cw_status visit_component(placing *p, const cwi_3mf_component *c, const double *parent,
                                 int depth, cwi_3mf_type type, cw_error *err)
{
    double transform[12];
    const cwi_3mf_resource *r = cwi_3mf_find(p->m, c->model, c->id);
    if (!r || r->is_group)
        return cwi_fail(err, CW_ERR_FORMAT, "'%s' places object %u, which is not there",
                        p->m->models[c->model], c->id);
    if (depth == DEEPEST)
        return cwi_fail(err, CW_ERR_FORMAT,
                        "components are nested deeper than %d, or hold themselves", DEEPEST);
    if (p->visits++ == MAX_PLACINGS)
        return cwi_fail(err, CW_ERR_LIMIT, "objects are placed more than %d times",
                        MAX_PLACINGS);
    multiply_transforms(parent, c->transform, transform);
    for (int i = 0; i < 12; i++)
        if (!isfinite(transform[i]))
            return cwi_fail(err, CW_ERR_FORMAT, "a transform is not finite");
    const cwi_3mf_object *o = &p->m->objects[r->object];
    cw_status st = CW_OK;
    if (type == CWI_3MF_SHAPE) {
        type = o->type;
        p->m->metadata->supports += type == CWI_3MF_SUPPORT;
        p->m->metadata->others += type == CWI_3MF_OTHER;
    }
    if (type != CWI_3MF_SHAPE)
        count_left_out(p, type, o);
    else if (o->end_triangle > o->first_triangle)
        st = add_instance(p, r->object, transform, err);
    for (size_t i = o->first_component; i < o->end_component && st == CW_OK; i++)
        st = visit_component(p, &p->m->components[i], transform, depth + 1, type, err);
    return st;
}

/* Reports a file whose objects are all left out; otherwise it would be an empty mesh without a
 * message. */
static cw_status check_left_out(const placing *p, cw_error *err)
{
    const cw_mesh_file *metadata = p->m->metadata;
    if (p->count || !(metadata->supports + metadata->others))
        return CW_OK;
    return cwi_fail(err, CW_ERR_FORMAT,
                    "it builds only what is left out: %zu objects for support (%zu triangles) "
                    "and %zu of type 'other' (%zu triangles)",
                    metadata->supports, metadata->support_triangles, metadata->others,
                    metadata->other_triangles);
}

static cw_status find_instances(placing *p, cw_error *err)
{
    static const double unit[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
    cw_status st = CW_OK;
    for (size_t i = 0; i < p->m->item_count && st == CW_OK; i++) {
        const cwi_3mf_component *item = &p->m->items[i];
        const size_t first = p->count;
        st = visit_component(p, item, unit, 0, CWI_3MF_SHAPE, err);
        if (st != CW_OK || p->count == first)
            continue;
        const cwi_3mf_resource *r = cwi_3mf_find(p->m, item->model, item->id);
        p->instances[first].starts_part = true;
        p->instances[first].name = p->m->objects[r->object].name;
    }
    return st;
}

/* --- placing ----------------------------------------------------------------------------- */

/* Uses a common move as the mesh's origin, so that positions keep their bits. Requires that all
 * objects are moved alike and not turned. */
static bool take_origin(placing *p)
{
    double *origin = p->m->mesh->origin;
    for (size_t i = 0; i < p->count; i++)
        for (int k = 0; k < 12; k++) {
            const double *transform = p->instances[i].transform;
            if (k % 4 == 3 ? transform[k] != p->instances[0].transform[k]
                           : transform[k] != (k % 5 == 0))
                return false;
        }
    for (int a = 0; a < 3 && p->count; a++)
        origin[a] += p->instances[0].transform[4 * a + 3];
    return p->count > 0;
}

static bool is_mirrored(const instance *i)
{
    return cwi_affine_determinant(i->transform) < 0;
}

/* Returns true if the objects that are read are those that are built, each once and in that
 * order. */
static bool is_in_order(const placing *p)
{
    size_t next = 0;
    for (size_t o = 0; o < p->m->object_count; o++) {
        const cwi_3mf_object *object = &p->m->objects[o];
        if (object->end_point == object->first_point)
            continue;
        if (next == p->count || p->instances[next++].object != o)
            return false;
    }
    return next == p->count;
}

static void swap_corners(uint32_t *triangle)
{
    const uint32_t second = triangle[1];
    triangle[1] = triangle[2];
    triangle[2] = second;
}

/* Moves the object's points to their position. */
static void move_object(cwi_mesh_build *b, const cwi_3mf_object *o, const instance *i,
                        bool origin_taken)
{
    for (size_t v = o->first_point; v < o->end_point && !origin_taken; v++) {
        const double at[3] = {b->points[3 * v], b->points[3 * v + 1], b->points[3 * v + 2]};
        cwi_affine_apply(i->transform, at, b->points + 3 * v);
    }
    for (size_t t = o->first_triangle; t < o->end_triangle && is_mirrored(i); t++)
        swap_corners(b->triangles + 3 * t);
}

/* Colours of the copies; NULL: none. */
typedef struct copied_colors {
    uint32_t *points, *faces;
    size_t point_capacity, face_capacity;
} copied_colors;

/* Adds a copy of the object's points and triangles, and of their colours. */
static cw_status copy_object(cwi_3mf *m, cwi_mesh_build *to, copied_colors *colors,
                             const cwi_3mf_object *o, cw_error *err)
{
    const size_t first = to->point_count, count = o->end_point - o->first_point;
    const size_t triangles = o->end_triangle - o->first_triangle;
    cw_status st = cwi_build_reserve(to, (uint64_t)first + count,
                                     (uint64_t)to->triangle_count + triangles, err);
    if (st == CW_OK && m->point_colors)
        st = cwi_mesh_grow(m->in, &colors->points, &colors->point_capacity, first + count,
                           sizeof *colors->points, err);
    if (st == CW_OK && m->face_colors)
        st = cwi_mesh_grow(m->in, &colors->faces, &colors->face_capacity,
                           to->triangle_count + triangles, sizeof *colors->faces, err);
    if (st != CW_OK)
        return st;
    memcpy(to->points + 3 * first, m->build.points + 3 * o->first_point,
           3 * count * sizeof *to->points);
    for (size_t v = 0; v < count && m->point_colors; v++) {
        const size_t from = o->first_point + v;
        colors->points[first + v] =
            from < m->point_color_count ? m->point_colors[from] : cwi_3mf_none;
    }
    for (size_t t = 0; t < triangles && m->face_colors; t++) {
        const size_t from = o->first_triangle + t;
        colors->faces[to->triangle_count + t] =
            from < m->face_color_count ? m->face_colors[from] : cwi_3mf_none;
    }
    for (size_t i = 0; i < 3 * triangles; i++)
        to->triangles[3 * to->triangle_count + i] =
            m->build.triangles[3 * o->first_triangle + i] - (uint32_t)o->first_point +
            (uint32_t)first;
    to->point_count += count;
    to->triangle_count += triangles;
    return CW_OK;
}

/* Rebuilds the mesh from the instances in their order, each with points of its own. */
static cw_status copy_objects(placing *p, cw_error *err)
{
    cwi_3mf *m = p->m;
    cwi_mesh_build to = {.in = m->in};
    copied_colors colors = {0};
    cw_status st = CW_OK;
    for (size_t i = 0; i < p->count && st == CW_OK; i++) {
        const cwi_3mf_object *o = &m->objects[p->instances[i].object];
        st = copy_object(m, &to, &colors, o, err);
    }
    if (st != CW_OK) {
        cwi_build_free(&to);
        cwi_free(colors.points);
        cwi_free(colors.faces);
        return st;
    }
    cwi_build_free(&m->build);
    cwi_free(m->point_colors);
    cwi_free(m->face_colors);
    m->build = to;
    m->point_colors = colors.points;
    m->point_color_count = colors.points ? to.point_count : 0;
    m->face_colors = colors.faces;
    m->face_color_count = colors.faces ? to.triangle_count : 0;
    return CW_OK;
}

/* Moves the points of every instance, stored in their order, and marks the parts. */
static cw_status move_instances(placing *p, cw_error *err)
{
    cwi_3mf *m = p->m;
    const bool origin_taken = take_origin(p);
    size_t point = 0, triangle = 0;
    cw_status st = CW_OK;
    for (size_t i = 0; i < p->count && st == CW_OK; i++) {
        const instance *at = &p->instances[i];
        const cwi_3mf_object *o = &m->objects[at->object];
        const cwi_3mf_object here = {.first_point = point,
                                     .end_point = point + o->end_point - o->first_point,
                                     .first_triangle = triangle,
                                     .end_triangle =
                                         triangle + o->end_triangle - o->first_triangle};
        if (at->starts_part)
            st = cwi_mesh_begin_part(m->in, m->names + at->name, triangle, err);
        move_object(&m->build, &here, at, origin_taken);
        point = here.end_point;
        triangle = here.end_triangle;
    }
    return st;
}

static void unpack_color(const cwi_3mf *m, uint32_t index, uint8_t color[4])
{
    const uint32_t packed = index == cwi_3mf_none ? UINT32_MAX : m->colors[index]; /* white */
    for (int c = 0; c < 4; c++)
        color[c] = (uint8_t)(packed >> (24 - 8 * c));
}

/* Colours points; those without a colour are white, as they are drawn. */
static cw_status color_points(cwi_3mf *m, size_t count, cw_error *err)
{
    size_t capacity = 0;
    if (!m->point_colors || m->mixed_colors)
        return CW_OK;
    cw_status st = cwi_mesh_grow(m->in, &m->mesh->colors, &capacity, count, 4, err);
    for (size_t v = 0; v < count && st == CW_OK; v++)
        unpack_color(m, v < m->point_color_count ? m->point_colors[v] : cwi_3mf_none,
                     m->mesh->colors + 4 * v);
    return st;
}

/* Colours triangles where points have two colours. */
static cw_status color_faces(cwi_3mf *m, cw_error *err)
{
    cwi_face_colors faces = {.in = m->in};
    uint8_t color[4];
    cw_status st = CW_OK;
    if (!m->mixed_colors)
        return CW_OK;
    for (size_t t = 0; t < m->face_color_count && st == CW_OK; t++) {
        unpack_color(m, m->face_colors[t], color);
        st = cwi_color_faces(&faces, t + 1, color, err);
    }
    if (st == CW_OK)
        st = cwi_color_mesh(&faces, true, m->mesh, err);
    cwi_face_colors_free(&faces);
    cwi_say_left_out(m->metadata, m->is_graded, "gradients of colours within triangles");
    return st;
}

static cw_status build_mesh(placing *p, cw_error *err)
{
    cwi_3mf *m = p->m;
    cw_status st = is_in_order(p) ? CW_OK : copy_objects(p, err);
    if (st == CW_OK)
        st = move_instances(p, err);
    if (st == CW_OK)
        st = color_points(m, m->build.point_count, err);
    if (st == CW_OK)
        st = cwi_build_finish(&m->build, m->mesh, m->metadata, err);
    return st == CW_OK ? color_faces(m, err) : st;
}

cw_status cwi_3mf_place(cwi_3mf *m, cw_error *err)
{
    const bool stated = m->in->desc.max_triangles < UINT32_MAX;
    placing p = {.m = m, .max = stated ? UINT64_MAX : FREE_COUNT + m->in->file.size};
    cw_status st = m->has_build
                       ? find_instances(&p, err)
                       : cwi_fail(err, CW_ERR_FORMAT, "'%s' has no 'build'", m->models[0]);
    if (st == CW_OK)
        st = check_left_out(&p, err);
    if (st == CW_OK)
        st = build_mesh(&p, err);
    cwi_free(p.instances);
    return st;
}
