/* Reads Wavefront OBJ: vertices, normals and faces, in objects or groups, with colours of vertices, and of
 * faces by their materials. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/base/text.h"
#include "formats/obj/obj_format.h"
#include "formats/obj/obj_materials.h"
#include "formats/obj/obj_places.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const uint32_t NONE = UINT32_MAX;

typedef struct obj {
    cwi_mesh_build build;
    float *normals;      /* normal_count x 3 */
    uint32_t *normal_of; /* a vertex's normal, or NONE; for the first normal_of_count
                            vertices */
    size_t normal_count, normal_capacity, named, named_capacity;
    bool mixed;       /* some vertex has two normals, or a corner none: then none are kept */
    bool ours;        /* a comment of our writer was found */
    bool has_objects; /* then groups are not parts */
    float *colors;    /* of the first color_count vertices x 3; negative: none */
    size_t color_count, color_capacity;
    bool is_bright; /* some number is above 1: they go to 255 */
    cwi_obj_materials materials;
    cwi_face_colors faces;
    const cwi_obj_material *material; /* of the next faces; valid until more are read */
    cwi_obj_places places;
} obj;

/* --- normals ----------------------------------------------------------------------------- */

static cw_status read_normal(obj *o, cwi_scan *s, cw_error *err)
{
    if (o->normal_count == UINT32_MAX - 1)
        return cwi_fail(err, CW_ERR_LIMIT, "more than %u normals", UINT32_MAX - 1);
    cw_status st = cwi_mesh_grow(o->build.in, &o->normals, &o->normal_capacity,
                                 o->normal_count + 1, 3 * sizeof *o->normals, err);
    for (size_t a = 0; a < 3 && st == CW_OK; a++) {
        double number = 0;
        st = cwi_scan_double(s, "a normal's coordinate", &number, err);
        if (st == CW_OK) /* numbers beyond single precision make no normal */
            o->normals[3 * o->normal_count + a] = fabs(number) < 1e30 ? (float)number : NAN;
    }
    o->normal_count += st == CW_OK;
    return st;
}

static bool same_normal(const obj *o, uint32_t m, uint32_t n)
{
    return m == n || (m < o->normal_count && n < o->normal_count &&
                      memcmp(o->normals + 3 * (size_t)m, o->normals + 3 * (size_t)n,
                             3 * sizeof *o->normals) == 0);
}

/* Gives a vertex the normal of a corner. Once any vertex has two, none are kept. Nor are they
 * kept where a face precedes its vertices, since their number could be anything. */
static cw_status name_normal(obj *o, uint32_t vertex, int64_t normal, cw_error *err)
{
    o->mixed = o->mixed || normal < 0 || normal >= NONE || vertex >= o->build.point_count;
    if (o->mixed)
        return CW_OK;
    cw_status st = cwi_mesh_grow(o->build.in, &o->normal_of, &o->named_capacity,
                                 (size_t)vertex + 1, sizeof *o->normal_of, err);
    if (st != CW_OK)
        return st;
    while (o->named <= vertex)
        o->normal_of[o->named++] = NONE;
    uint32_t *n = &o->normal_of[vertex];
    o->mixed = *n != NONE && !same_normal(o, *n, (uint32_t)normal);
    *n = (uint32_t)normal;
    return CW_OK;
}

static bool every_vertex_has_a_normal(const obj *o, size_t vertices)
{
    if (o->mixed || o->named < vertices || vertices == 0)
        return false;
    for (size_t v = 0; v < vertices; v++)
        if (o->normal_of[v] >= o->normal_count)
            return false;
    return true;
}

static cw_status keep_normals(obj *o, cw_mesh *mesh, cw_error *err)
{
    size_t capacity = 0;
    if (!every_vertex_has_a_normal(o, mesh->vertex_count))
        return CW_OK;
    cw_status st = cwi_mesh_grow(o->build.in, &mesh->normals, &capacity, mesh->vertex_count,
                                 3 * sizeof *mesh->normals, err);
    for (size_t v = 0; v < mesh->vertex_count && st == CW_OK; v++)
        memcpy(mesh->normals + 3 * v, o->normals + 3 * (size_t)o->normal_of[v],
               3 * sizeof *mesh->normals);
    return st;
}

/* --- faces ------------------------------------------------------------------------------- */

/* Converts a number to an index. The file counts from 1, or with negative numbers back from the
 * last one. */
static int64_t to_index(int64_t number, size_t count)
{
    return number < 0 ? (int64_t)count + number : number - 1;
}

/* Parses "v", "v/t", "v//n" or "v/t/n"; a place or normal of 0 means none. */
static bool parse_corner(const cwi_word *word, int64_t *vertex, int64_t *place, int64_t *normal)
{
    const char *at = word->text, *end = word->text + word->size;
    *place = *normal = 0;
    if (!cwi_parse_int(&at, vertex))
        return false;
    if (*at == '/' && *++at != '/' && at < end && !cwi_parse_int(&at, place))
        return false;
    if (at < end && *at == '/' && ++at < end && !cwi_parse_int(&at, normal))
        return false;
    return at == end;
}

static cw_status add_corner(obj *o, const cwi_scan *s, const cwi_word *word, cw_error *err)
{
    int64_t vertex, place, normal;
    if (!parse_corner(word, &vertex, &place, &normal))
        return cwi_scan_fail(s, word, "a corner", "numbers as in 1/2/3", err);
    const int64_t index = to_index(vertex, o->build.point_count);
    if (vertex == 0 || index < 0 || index >= UINT32_MAX)
        return cwi_fail(err, CW_ERR_FORMAT,
                        "line %zu: a corner names vertex %lld; there are %zu so far, from 1",
                        s->line, (long long)vertex, o->build.point_count);
    cw_status st = cwi_build_corner(&o->build, index, err);
    if (st == CW_OK)
        st = cwi_obj_name_place(&o->places, &o->build, place, err);
    if (st == CW_OK && o->normal_count)
        st = name_normal(o, (uint32_t)index, normal ? to_index(normal, o->normal_count) : -1,
                         err);
    return st;
}

static cw_status read_face(obj *o, cwi_scan *s, cw_mesh_file *metadata, cw_error *err)
{
    cwi_word word;
    cw_status st = cwi_scan_word(s, &word, err);
    while (st == CW_OK && word.size && word.text[0] != '#') {
        st = add_corner(o, s, &word, err);
        if (st == CW_OK)
            st = cwi_scan_word(s, &word, err);
    }
    if (st == CW_OK)
        st = cwi_build_end_face(&o->build, metadata, err);
    return st == CW_OK ? cwi_scan_end_line(s, err) : st;
}

/* --- lines ------------------------------------------------------------------------------- */

/* Keeps the colour of the next vertex. Those before it that have none are marked. */
static cw_status keep_color(obj *o, const double color[3], cw_error *err)
{
    const size_t count = o->build.point_count + 1;
    cw_status st = cwi_mesh_grow(o->build.in, &o->colors, &o->color_capacity, count,
                                 3 * sizeof *o->colors, err);
    if (st != CW_OK)
        return st;
    for (; o->color_count + 1 < count; o->color_count++)
        o->colors[3 * o->color_count] = -1;
    for (size_t c = 0; c < 3; c++) {
        const double value = fmin(fmax(isnan(color[c]) ? 0 : color[c], 0), 255);
        o->colors[3 * o->color_count + c] = (float)value;
        o->is_bright = o->is_bright || value > 1.001; /* allows for rounding */
    }
    o->color_count = count;
    return CW_OK;
}

/* Reads x y z of a vertex. Three or more numbers behind it are its colour; one is a weight, and ignored. */
static cw_status read_vertex(obj *o, cwi_scan *s, cw_error *err)
{
    double point[3] = {0}, color[3] = {0};
    cwi_word word = {0};
    int count = 0;
    cw_status st = CW_OK;
    for (int a = 0; a < 3 && st == CW_OK; a++)
        st = cwi_scan_double(s, "a coordinate", &point[a], err);
    if (st == CW_OK)
        st = cwi_scan_word(s, &word, err);
    while (st == CW_OK && count < 3 && word.size && cwi_word_double(&word, &color[count])) {
        count++;
        st = cwi_scan_word(s, &word, err);
    }
    if (st == CW_OK && count == 3)
        st = keep_color(o, color, err);
    if (st == CW_OK)
        st = cwi_build_point(&o->build, point, err);
    return st == CW_OK ? cwi_scan_end_line(s, err) : st;
}

static cw_status read_comment(obj *o, cwi_scan *s, cw_mesh *mesh, cw_mesh_file *metadata,
                              cw_error *err)
{
    char text[CWI_REST_BYTES];
    cw_status st = cwi_scan_rest(s, text, err);
    if (st == CW_OK)
        cwi_take_comment(text, &o->ours, mesh, metadata);
    return st == CW_OK ? cwi_scan_end_line(s, err) : st;
}

/* Colours the faces so far by the material that counts for them. */
static cw_status color_faces(obj *o, cw_error *err)
{
    const cwi_obj_material *m = o->material;
    return cwi_color_faces(&o->faces, o->build.triangle_count,
                           m && m->has_color && !m->textures ? m->color : NULL, err);
}

static cw_status read_material(obj *o, cwi_scan *s, bool is_file, cw_error *err)
{
    char name[CWI_REST_BYTES];
    cw_status st = cwi_scan_rest(s, name, err);
    if (st == CW_OK)
        st = color_faces(o, err);
    if (st == CW_OK && is_file)
        st = cwi_obj_read_materials(&o->materials, name, err);
    o->material = is_file ? NULL : cwi_obj_find_material(&o->materials, name);
    if (st == CW_OK && o->materials.in->pictures.set_count)
        st = cwi_mesh_begin_textures(o->build.in, o->material ? o->material->textures : 0,
                                     o->build.triangle_count, err);
    return st == CW_OK ? cwi_scan_end_line(s, err) : st;
}

static cw_status read_part(obj *o, cwi_scan *s, bool is_object, cw_error *err)
{
    char name[CWI_REST_BYTES];
    if (!is_object && o->has_objects)
        return cwi_scan_end_line(s, err);
    o->has_objects = is_object;
    cw_status st = cwi_scan_rest(s, name, err);
    if (st == CW_OK)
        st = cwi_mesh_begin_part(o->build.in, name, o->build.triangle_count, err);
    return st == CW_OK ? cwi_scan_end_line(s, err) : st;
}

static cw_status read_line(obj *o, cwi_scan *s, cw_mesh *mesh, cw_mesh_file *metadata,
                           cw_error *err)
{
    cwi_word word;
    cw_status st = cwi_scan_word(s, &word, err);
    if (st != CW_OK)
        return st;
    if (cwi_word_is(&word, "v"))
        return read_vertex(o, s, err);
    if (cwi_word_is(&word, "vn"))
        st = read_normal(o, s, err);
    else if (cwi_word_is(&word, "f"))
        return read_face(o, s, metadata, err);
    else if (cwi_word_is(&word, "#"))
        return read_comment(o, s, mesh, metadata, err);
    else if (cwi_word_is(&word, "o") || cwi_word_is(&word, "g"))
        return read_part(o, s, word.text[0] == 'o', err);
    else if (cwi_word_is(&word, "usemtl") || cwi_word_is(&word, "mtllib"))
        return read_material(o, s, word.text[0] == 'm', err);
    else if (cwi_word_is(&word, "vt"))
        st = cwi_obj_read_place(&o->places, s, err);
    else if (cwi_word_is(&word, "l") || cwi_word_is(&word, "p"))
        metadata->skipped++;
    return st == CW_OK ? cwi_scan_end_line(s, err) : st;
}

static cw_status read_lines(obj *o, cwi_scan *s, cw_mesh *mesh, cw_mesh_file *metadata,
                            cw_error *err)
{
    bool found;
    cw_status st = cwi_scan_next_line(s, &found, err);
    while (st == CW_OK && found) {
        st = read_line(o, s, mesh, metadata, err);
        if (st == CW_OK)
            st = cwi_scan_next_line(s, &found, err);
    }
    return st;
}

/* Moves the colours of vertices to the mesh; without them, those of faces. Programs that write both mean
 * the vertices. */
static cw_status keep_colors(obj *o, cw_mesh *mesh, cw_error *err)
{
    size_t capacity = 0;
    const double scale = o->is_bright ? 1.0 / 255 : 1;
    if (!o->color_count)
        return cwi_color_mesh(&o->faces, true, mesh, err);
    cw_status st =
        cwi_mesh_grow(o->build.in, &mesh->colors, &capacity, mesh->vertex_count, 4, err);
    if (st != CW_OK)
        return st;
    memset(mesh->colors, 255, 4 * mesh->vertex_count);
    for (size_t v = 0; v < o->color_count; v++)
        for (size_t c = 0; c < 3 && o->colors[3 * v] >= 0; c++)
            mesh->colors[4 * v + c] = cwi_obj_color((double)o->colors[3 * v + c], scale);
    return CW_OK;
}

static void free_obj(obj *o)
{
    cwi_build_free(&o->build);
    cwi_free(o->normals);
    cwi_free(o->normal_of);
    cwi_free(o->colors);
    cwi_obj_materials_free(&o->materials);
    cwi_face_colors_free(&o->faces);
    cwi_obj_places_free(&o->places);
}

cw_status cwi_obj_read(cwi_mesh_input *in, cw_mesh *mesh, cw_mesh_file *metadata, cw_error *err)
{
    obj o = {.build = {.in = in, .base = 1},
             .materials = {.in = in},
             .faces = {.in = in},
             .places = {.in = in}};
    cwi_scan s = {0};
    cw_status st = cwi_scan_open_text(&s, &in->file, 0, &in->desc.progress, err);
    s.by_line = true;
    if (st == CW_OK)
        st = read_lines(&o, &s, mesh, metadata, err);
    if (st == CW_OK)
        st = color_faces(&o, err);
    if (st == CW_OK)
        st = cwi_obj_keep_fans(&o.places, &o.build, err);
    if (st == CW_OK)
        st = cwi_build_finish(&o.build, mesh, metadata, err);
    if (st == CW_OK)
        st = cwi_obj_keep_places(&o.places, &o.build, mesh, err);
    if (st == CW_OK)
        st = keep_normals(&o, mesh, err);
    if (st == CW_OK)
        st = keep_colors(&o, mesh, err);
    cwi_say_left_out(metadata, o.places.is_broken, "texture coordinates that are not there");
    cwi_say_left_out(metadata, o.materials.has_options, "-o, -s and -t of textures");
    cwi_say_left_out(metadata, o.materials.has_others, "other pictures of materials");
    cwi_say_left_out(metadata, o.materials.is_missing,
                     "materials of a missing or damaged file");
    cwi_scan_close(&s);
    free_obj(&o);
    return st;
}
