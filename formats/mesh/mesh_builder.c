/* Builds a mesh from the points and faces of a file, within the limits of memory. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/base/text.h"
#include "core/geometry/vec3.h"
#include "formats/mesh/mesh_axes.h"
#include "formats/mesh/mesh_reader.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

/* The first value of labels whose numbers have more than 32 bits. */
#define FIRST_REPLACED 0x80000000u

/* --- memory within limits ---------------------------------------------------------------- */

/* Returns twice the capacity, or the requested one, or (near the limit) the maximum. */
static size_t next_capacity(const cwi_mesh_input *in, size_t capacity, size_t count,
                            size_t size)
{
    const uint64_t limit = in->desc.max_bytes;
    size_t more = capacity < SIZE_MAX / 2 && 2 * capacity > count ? 2 * capacity : count;
    if (limit && (limit - in->bytes) / size < more - capacity)
        more = capacity + (size_t)((limit - in->bytes) / size);
    return more;
}

static cw_status fail_limit(const cwi_mesh_input *in, cw_error *err)
{
    char limit[CWI_MEMORY_TEXT];
    cwi_print_memory(in->desc.max_bytes, limit);
    return cwi_fail(err, CW_ERR_LIMIT,
                    "the mesh needs more memory than the %s allowed (desc->max_bytes)", limit);
}

cw_status cwi_mesh_take_bytes(cwi_mesh_input *in, uint64_t bytes, cw_error *err)
{
    if (in->desc.max_bytes && bytes > in->desc.max_bytes - in->bytes)
        return fail_limit(in, err);
    in->bytes += bytes;
    return CW_OK;
}

cw_status cwi_mesh_grow(cwi_mesh_input *in, void *array, size_t *capacity, size_t count,
                        size_t size, cw_error *err)
{
    void *memory;
    if (count <= *capacity)
        return CW_OK;
    const size_t next = next_capacity(in, *capacity, count, size);
    if (next < count)
        return fail_limit(in, err);
    memcpy(&memory, array, sizeof memory);
    memory = cwi_realloc_array(memory, next, size);
    if (!memory)
        return cwi_fail_memory(err);
    memcpy(array, &memory, sizeof memory);
    in->bytes += (next - *capacity) * size;
    *capacity = next;
    return CW_OK;
}

cw_status cwi_mesh_begin_textures(cwi_mesh_input *in, uint32_t textures, size_t triangle,
                                  cw_error *err)
{
    cwi_marks *m = &in->marks;
    cw_status st = m->count ? CW_OK : cwi_mesh_begin_part(in, "", triangle, err);
    cwi_mark *last = st == CW_OK ? &m->items[m->count - 1] : NULL;
    if (!last || last->textures == textures)
        return st;
    if (last->triangle == triangle) {
        last->textures = textures;
        return CW_OK;
    }
    st = cwi_mesh_grow(in, &m->items, &m->capacity, m->count + 1, sizeof *m->items, err);
    if (st != CW_OK)
        return st;
    cwi_mark mark = m->items[m->count - 1];
    mark.triangle = triangle;
    mark.textures = textures;
    m->items[m->count++] = mark;
    return CW_OK;
}

cw_status cwi_mesh_begin_part(cwi_mesh_input *in, const char *name, size_t triangle,
                              cw_error *err)
{
    cwi_marks *m = &in->marks;
    const uint32_t object = m->count ? m->items[m->count - 1].object + 1 : 0;
    const uint32_t textures = m->count ? m->items[m->count - 1].textures : 0;
    const size_t length = strlen(name);
    while (m->count && m->items[m->count - 1].triangle == triangle) {
        m->count--;
        if (m->count == 0 || m->items[m->count - 1].name != m->items[m->count].name)
            m->name_bytes = m->items[m->count].name;
    }
    const bool untitled = m->count == 0 && triangle > 0; /* triangles without a part */
    cw_status st =
        cwi_mesh_grow(in, &m->items, &m->capacity, m->count + 2, sizeof *m->items, err);
    if (st == CW_OK)
        st =
            cwi_mesh_grow(in, &m->names, &m->name_capacity, m->name_bytes + length + 2, 1, err);
    if (st != CW_OK)
        return st;
    if (untitled) {
        m->items[m->count++] = (cwi_mark){.name = m->name_bytes};
        m->names[m->name_bytes++] = '\0';
    }
    m->items[m->count++] = (cwi_mark){.triangle = triangle,
                                      .name = m->name_bytes,
                                      .object = object + untitled,
                                      .textures = textures};
    memcpy(m->names + m->name_bytes, name, length + 1);
    m->name_bytes += length + 1;
    return CW_OK;
}

/* Returns a value for a label: its number, or one for a number beyond 32 bits. The levels of such a label
 * follow each other. */
static uint32_t find_value(const cw_label_table *table, const cw_label *label)
{
    const cw_label *last = table->count ? &table->labels[table->count - 1] : NULL;
    if (!label->id)
        return label->value;
    if (last && last->id == label->id && last->is_negative == label->is_negative)
        return last->value;
    return FIRST_REPLACED + (uint32_t)table->count;
}

cw_status cwi_mesh_label_part(cwi_mesh_input *in, const cw_label *label, cw_error *err)
{
    cwi_mark *mark = &in->marks.items[in->marks.count - 1];
    cw_label added = *label;
    added.value = find_value(&in->labels, label);
    cw_status st = cw_label_table_add(&in->labels, &added, err);
    mark->labelled = st == CW_OK;
    mark->layer = label->layer;
    mark->value = added.value;
    return st;
}

cw_status cwi_mesh_limit_triangles(const cwi_mesh_input *in, uint64_t count, cw_error *err)
{
    if (count <= in->desc.max_triangles)
        return CW_OK;
    return cwi_fail(err, CW_ERR_LIMIT, "more than %llu triangles, the most allowed",
                    (unsigned long long)in->desc.max_triangles);
}

/* --- points and faces -------------------------------------------------------------------- */

static cw_status limit_points(uint64_t count, cw_error *err)
{
    if (count <= UINT32_MAX)
        return CW_OK;
    return cwi_fail(err, CW_ERR_LIMIT, "more than %u vertices, the most a mesh can have",
                    UINT32_MAX);
}

cw_status cwi_build_reserve(cwi_mesh_build *b, uint64_t points, uint64_t triangles,
                            cw_error *err)
{
    cw_status st = limit_points(points, err);
    if (st == CW_OK)
        st = cwi_mesh_limit_triangles(b->in, triangles, err);
    if (st == CW_OK)
        st = cwi_mesh_grow(b->in, &b->points, &b->point_capacity, (size_t)points,
                           3 * sizeof *b->points, err);
    if (st == CW_OK)
        st = cwi_mesh_grow(b->in, &b->triangles, &b->triangle_capacity, (size_t)triangles,
                           3 * sizeof *b->triangles, err);
    return st;
}

cw_status cwi_build_point(cwi_mesh_build *b, const double point[3], cw_error *err)
{
    if (b->point_count == b->point_capacity) {
        cw_status st = cwi_build_reserve(b, (uint64_t)b->point_count + 1, 0, err);
        if (st != CW_OK)
            return st;
    }
    memcpy(b->points + 3 * b->point_count++, point, 3 * sizeof *point);
    return CW_OK;
}

static cw_status add_triangle(cwi_mesh_build *b, uint32_t corner, cw_error *err)
{
    if (b->triangle_count == b->triangle_capacity ||
        b->triangle_count >= b->in->desc.max_triangles) {
        cw_status st = cwi_build_reserve(b, 0, (uint64_t)b->triangle_count + 1, err);
        if (st != CW_OK)
            return st;
    }
    uint32_t *t = b->triangles + 3 * b->triangle_count++;
    t[0] = b->first;
    t[1] = b->last;
    t[2] = corner;
    return CW_OK;
}

cw_status cwi_build_corner(cwi_mesh_build *b, int64_t point, cw_error *err)
{
    if (point < 0 || point >= UINT32_MAX)
        return cwi_fail(err, CW_ERR_FORMAT, "triangle %zu names vertex %lld, which cannot be",
                        b->triangle_count, (long long)point);
    const uint32_t corner = (uint32_t)point;
    cw_status st = b->corners >= 2 ? add_triangle(b, corner, err) : CW_OK;
    if (b->corners == 0)
        b->first = corner;
    b->last = corner;
    b->corners++;
    return st;
}

cw_status cwi_build_end_face(cwi_mesh_build *b, cw_mesh_file *metadata, cw_error *err)
{
    const size_t triangles = b->corners > 3 ? b->corners - 2 : 0;
    cw_status st = CW_OK;
    metadata->skipped += b->corners < 3;
    metadata->polygons += b->corners > 3;
    b->corners = 0;
    if (triangles)
        st = cwi_mesh_grow(b->in, &b->polygons, &b->polygon_capacity, b->polygon_count + 1,
                           sizeof *b->polygons, err);
    if (triangles && st == CW_OK)
        b->polygons[b->polygon_count++] =
            (cwi_face_polygon){(uint32_t)(b->triangle_count - triangles), (uint32_t)triangles};
    return st;
}

/* --- the mesh ---------------------------------------------------------------------------- */

static cw_status check_points(const cwi_mesh_build *b, cw_error *err)
{
    for (size_t i = 0; i < 3 * b->point_count; i++)
        if (!isfinite(b->points[i]))
            return cwi_fail(err, CW_ERR_FORMAT, "'%c' of vertex %zu is %g; it must be finite",
                            "xyz"[i % 3], i / 3 + (size_t)b->base, b->points[i]);
    return CW_OK;
}

static cw_status check_triangles(const cwi_mesh_build *b, cw_error *err)
{
    for (size_t i = 0; i < 3 * b->triangle_count; i++)
        if (b->triangles[i] >= b->point_count)
            return cwi_fail(err, CW_ERR_FORMAT, "triangle %zu names vertex %llu of %zu", i / 3,
                            (unsigned long long)b->triangles[i] + (unsigned)b->base,
                            b->point_count);
    return CW_OK;
}

static bool all_single(const cwi_mesh_build *b)
{
    for (size_t i = 0; i < 3 * b->point_count; i++)
        if (fabs(b->points[i]) > (double)FLT_MAX || (double)(float)b->points[i] != b->points[i])
            return false;
    return true;
}

/* Chooses the origin. It is 0 where single precision holds the places exactly, or nearly as
 * well as relative to another origin. The rule is that of the OBJ writer: far is ten times the
 * size. Halves are added, so that the largest doubles have a middle, too. */
static void choose_origin(const cwi_mesh_build *b, double origin[3])
{
    double middle[3], size = 0, distance = 0;
    for (int a = 0; a < 3; a++) {
        double low = INFINITY, high = -INFINITY;
        for (size_t v = 0; v < b->point_count; v++) {
            low = cwi_lesser(low, b->points[3 * v + (size_t)a]);
            high = cwi_greater(high, b->points[3 * v + (size_t)a]);
        }
        middle[a] = low / 2 + high / 2;
        size = fmax(size, high - low);
        distance = fmax(distance, fmax(fabs(low), fabs(high)));
    }
    const bool far = b->point_count && distance > 10 * size && !all_single(b);
    for (int a = 0; a < 3; a++)
        origin[a] = far ? middle[a] : 0;
}

/* Rounds doubles to floats in the same memory: float i lies before every double still to
 * come. */
static cw_status round_points(cwi_mesh_build *b, const double origin[3], cw_error *err)
{
    char *memory = (char *)b->points;
    for (size_t i = 0; i < 3 * b->point_count; i++) {
        double exact;
        memcpy(&exact, memory + i * sizeof exact, sizeof exact);
        exact -= origin[i % 3];
        if (fabs(exact) > (double)FLT_MAX)
            return cwi_fail(err, CW_ERR_FORMAT,
                            "'%c' of vertex %zu is %g, which is beyond single precision",
                            "xyz"[i % 3], i / 3 + (size_t)b->base, exact);
        const float rounded = (float)exact;
        memcpy(memory + i * sizeof rounded, &rounded, sizeof rounded);
    }
    return CW_OK;
}

static cw_status shrink_array(void *array, size_t count, size_t size, cw_error *err)
{
    void *memory;
    memcpy(&memory, array, sizeof memory);
    memory = cwi_realloc_array(memory, count, size);
    if (!memory)
        return cwi_fail_memory(err);
    memcpy(array, &memory, sizeof memory);
    return CW_OK;
}

cw_status cwi_mesh_shrink(cw_mesh *mesh, cw_error *err)
{
    cw_status st =
        shrink_array(&mesh->positions, mesh->vertex_count, 3 * sizeof *mesh->positions, err);
    if (st == CW_OK)
        st = shrink_array(&mesh->triangles, mesh->triangle_count, 3 * sizeof *mesh->triangles,
                          err);
    return st;
}

/* Moves the floats that round_points() left in the doubles' memory. */
static cw_status move_arrays(cwi_mesh_build *b, cw_mesh *mesh, cw_error *err)
{
    void *memory = b->points;
    mesh->positions = memory;
    mesh->vertex_count = b->point_count;
    mesh->triangles = b->triangles;
    mesh->triangle_count = b->triangle_count;
    b->points = NULL;
    b->triangles = NULL;
    return cwi_mesh_shrink(mesh, err);
}

cw_status cwi_build_finish(cwi_mesh_build *b, cw_mesh *mesh, cw_mesh_file *metadata,
                           cw_error *err)
{
    double origin[3];
    cw_status st = check_points(b, err);
    if (st == CW_OK)
        st = check_triangles(b, err);
    if (st != CW_OK)
        return st;
    choose_origin(b, origin);
    for (int a = 0; a < 3; a++)
        mesh->origin[a] += origin[a];
    st = round_points(b, origin, err);
    if (st == CW_OK)
        st = move_arrays(b, mesh, err);
    return st == CW_OK
               ? cwi_cut_polygons(b->polygons, b->polygon_count, mesh, &metadata->crossing, err)
               : st;
}

void cwi_build_free(cwi_mesh_build *b)
{
    cwi_free(b->points);
    cwi_free(b->triangles);
    cwi_free(b->polygons);
    *b = (cwi_mesh_build){0};
}

void cwi_say_left_out(cw_mesh_file *metadata, bool is_there, const char *name)
{
    const size_t used = strlen(metadata->left_out);
    if (is_there)
        snprintf(metadata->left_out + used, sizeof metadata->left_out - used, "%s%s",
                 used ? ", " : "", name);
}

void cwi_take_comment(const char *text, bool *ours, cw_mesh *mesh, cw_mesh_file *metadata)
{
    static const char name[] = "cubewright ", origin[] = "origin ";
    if (strncmp(text, name, strlen(name)) == 0) {
        const char *comma = strchr(text, ',');
        const char *axes = comma ? comma + 1 + strspn(comma + 1, " ") : "";
        *ours = cwi_parse_axes(&axes, metadata) || *ours;
    } else if (*ours && strncmp(text, origin, strlen(origin)) == 0) {
        metadata->local =
            cwi_parse_origin(text + strlen(origin), mesh->origin) || metadata->local;
    }
}

bool cwi_parse_origin(const char *text, double origin[3])
{
    double number[3];
    for (int a = 0; a < 3; a++)
        if (!cwi_parse_double(&text, &number[a]) || !isfinite(number[a]))
            return false;
    memcpy(origin, number, sizeof number);
    return true;
}
