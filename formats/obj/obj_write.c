/* Writes Wavefront OBJ: text, so the only plain format that keeps places far from zero
 * exact. */

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/mesh/corner_table.h"
#include "core/texture/split_seams.h"
#include "formats/obj/obj_format.h"
#include "formats/obj/obj_pictures.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    MATERIAL_BYTES = CWI_NAME_BYTES + 32,
    COLOR_NAME_BYTES = 24,
    SINGLE_DIGITS = 9,
    DOUBLE_DIGITS = 17
};

static unsigned char *encode_place(const cwi_part *part, size_t v, unsigned char *to)
{
    to = cwi_put_place(cwi_put_text(to, "v "), part, v);
    for (size_t c = 0; part->mesh.colors && c < 3; c++) /* four digits give the byte back */
        to = cwi_put_decimal(cwi_put_text(to, " "), part->mesh.colors[4 * v + c] / 255.0, 4);
    return cwi_put_text(to, "\n");
}

/* Returns where the values of a place stand: of corners, or of the vertices they are at. */
static size_t value_of(const cwi_part *part, const cw_attribute *row, uint32_t corner)
{
    return row->components *
           (size_t)(row->on == CW_ON_CORNERS ? corner : part->mesh.triangles[corner]);
}

static unsigned char *encode_normal(const cwi_part *part, size_t v, unsigned char *to)
{
    return cwi_put_text(cwi_put_normal(cwi_put_text(to, "vn "), part, v), "\n");
}

static uint32_t pack_color(const uint8_t c[4])
{
    return (uint32_t)c[0] << 24 | (uint32_t)c[1] << 16 | (uint32_t)c[2] << 8 | c[3];
}

static void print_color_name(uint32_t color, char text[COLOR_NAME_BYTES])
{
    snprintf(text, COLOR_NAME_BYTES, "color_%08X", color);
}

/* Names the material of a face where it is another than that of the face before it. */
static unsigned char *encode_material(const cwi_part *part, size_t t, unsigned char *to)
{
    const uint8_t *color = part->face_colors + 4 * t;
    char name[COLOR_NAME_BYTES];
    if (t > 0 && memcmp(color, color - 4, 4) == 0)
        return to;
    print_color_name(pack_color(color), name);
    return cwi_put_text(cwi_put_text(cwi_put_text(to, "usemtl "), name), "\n");
}

/* Returns the number of a corner's texture coordinate in the file, from 0 on. */
static uint64_t place_of(const cwi_part *part, size_t t, int c)
{
    const size_t corner = 3 * t + (size_t)c;
    return part->first_place +
           (part->places ? part->places[corner] : part->mesh.triangles[corner]);
}

/* Returns the number of a corner's normal in the file, from 0 on. vertex: that of its vertex */
static uint64_t normal_of(const cwi_part *part, size_t t, int c, uint64_t vertex)
{
    return part->first_normal +
           (part->corner_normals ? part->places[3 * t + (size_t)c] : vertex - part->first);
}

/* Encodes a face. Numbers start at 1, and continue from object to object. */
static unsigned char *encode_face(const cwi_part *part, size_t t, unsigned char *to)
{
    if (part->face_colors && !part->textures)
        to = encode_material(part, t, to);
    *to++ = 'f';
    for (int c = 0; c < 3; c++) {
        const uint64_t number = cwi_corner_number(part, t, c);
        to = cwi_put_integer(cwi_put_text(to, " "), number + 1);
        if (part->texture)
            to = cwi_put_integer(cwi_put_text(to, "/"), place_of(part, t, c) + 1);
        if (part->arrays & CW_KEEPS_NORMALS)
            to = cwi_put_integer(cwi_put_text(to, part->texture ? "/" : "//"),
                                 normal_of(part, t, c, number) + 1);
    }
    return cwi_put_text(to, "\n");
}

static bool has_material(const cwi_part *part)
{
    return part->has_color && !part->face_colors && !part->textures;
}

/* Prints the name of a part's material: one word that no other label or colour has. */
static void print_material(const cwi_part *part, char text[MATERIAL_BYTES])
{
    const cw_label *label = part->label;
    const int length =
        label ? snprintf(text, MATERIAL_BYTES, "%s_%s", part->name,
                         cw_label_number(label, (char[CW_LABEL_NUMBER]){0}))
              : snprintf(text, MATERIAL_BYTES, "%s_%08X", part->name, pack_color(part->color));
    for (char *c = text; *c; c++)
        *c = *c == ' ' ? '_' : *c;
    if (label && label->layer > 0)
        snprintf(text + length, MATERIAL_BYTES - (size_t)length, "_%u", label->layer);
}

static cw_status write_material(cwi_mesh_output *out, const char *name, uint32_t color,
                                cw_error *err)
{
    return cwi_outfile_printf(out->side, err, "newmtl %s\nKd %.4f %.4f %.4f\nd %.4f\n", name,
                              (color >> 24) / 255.0, (color >> 16 & 255) / 255.0,
                              (color >> 8 & 255) / 255.0, (color & 255) / 255.0);
}

static int compare_colors(const void *a, const void *b)
{
    const uint32_t *x = a, *y = b;
    return (*x > *y) - (*x < *y);
}

static bool has_face_colors(const cwi_parts *parts)
{
    for (size_t i = 0; i < parts->count; i++)
        if (parts->items[i].face_colors && !parts->items[i].textures)
            return true;
    return false;
}

/* Writes a material for each colour of faces. */
static cw_status write_face_materials(const cwi_parts *parts, cwi_mesh_output *out,
                                      cw_error *err)
{
    char name[COLOR_NAME_BYTES];
    size_t count = 0;
    uint32_t *colors = cwi_alloc_array((size_t)parts->triangles, sizeof *colors);
    cw_status st = colors ? CW_OK : cwi_fail_memory(err);
    for (size_t i = 0; i < parts->count && st == CW_OK; i++)
        for (size_t t = 0;
             parts->items[i].face_colors && t < parts->items[i].mesh.triangle_count; t++)
            colors[count++] = pack_color(parts->items[i].face_colors + 4 * t);
    if (count)
        qsort(colors, count, sizeof *colors, compare_colors);
    for (size_t n = 0; n < count && st == CW_OK; n++) {
        if (n > 0 && colors[n] == colors[n - 1])
            continue;
        print_color_name(colors[n], name);
        st = write_material(out, name, colors[n], err);
    }
    cwi_free(colors);
    return st;
}

/* Writes the materials of parts and faces into a file of the same name that ends in .mtl. Colours are
 * those of sRGB, as readers expect them, with digits that give the byte again. */
static cw_status write_materials(const cwi_parts *parts, cwi_mesh_output *out, cw_error *err)
{
    const char *slash = strrchr(out->path, '/');
    const char *name = slash ? slash + 1 : out->path, *dot = strrchr(name, '.');
    if (out->desc->sink)
        return cwi_fail(err, CW_ERR_UNSUPPORTED,
                        "OBJ keeps materials and pictures in files of their own, which no sink "
                        "takes (desc->sink); ply and glb are one file with colours");
    const size_t length = dot && dot != name ? (size_t)(dot - out->path) : strlen(out->path);
    char *path = cwi_alloc_array(length + sizeof ".mtl", 1), material[MATERIAL_BYTES];
    if (!path)
        return cwi_fail_memory(err);
    memcpy(path, out->path, length);
    memcpy(path + length, ".mtl", sizeof ".mtl");
    cw_status st = cwi_outfile_open(&out->side, path, out->desc->no_clobber, err);
    if (st == CW_OK)
        st = cwi_outfile_printf(out->file, err, "mtllib %s\n", path + (name - out->path));
    if (st == CW_OK)
        st = cwi_outfile_printf(out->side, err, "# cubewright %s\n", CW_VERSION);
    for (size_t i = 0; i < parts->count && st == CW_OK; i++) {
        if (!has_material(&parts->items[i]))
            continue;
        print_material(&parts->items[i], material);
        st = write_material(out, material, pack_color(parts->items[i].color), err);
    }
    if (st == CW_OK && has_face_colors(parts))
        st = write_face_materials(parts, out, err);
    path[length] = '\0';
    if (st == CW_OK)
        st = cwi_obj_write_textures(parts, out, path, err);
    cwi_free(path);
    return st;
}

/* Returns the digits that give a coordinate back to the bit when it is taken from 1 again: near 1 those of a
 * double. */
static int digits_of_place(double v)
{
    return v > 0.5 || v < -0.5 ? DOUBLE_DIGITS : SINGLE_DIGITS + 1;
}

/* Writes normals: those of vertices, or where these part those of places. */
static cw_status write_normals(cwi_part *part, const cwi_texture_seams *seams,
                               cwi_mesh_output *out, uint64_t *normals, cw_error *err)
{
    cwi_part places = *part;
    cw_status st = CW_OK;
    part->first_normal = *normals;
    *normals += part->corner_normals ? seams->count : part->mesh.vertex_count;
    if (!part->corner_normals)
        return cwi_write_records(part, CWI_VERTICES, out, encode_normal, err);
    places.mesh.vertex_count = seams->count;
    places.mesh.normals = cwi_alloc_zeroed(seams->count, 3 * sizeof *places.mesh.normals);
    if (!places.mesh.normals)
        return cwi_fail_memory(err);
    for (size_t n = 0; n < seams->count; n++)
        if (seams->corner[n] != CWI_NO_CORNER)
            memcpy(places.mesh.normals + 3 * n,
                   (const float *)part->corner_normals->data +
                       value_of(part, part->corner_normals, seams->corner[n]),
                   3 * sizeof(float));
    st = cwi_write_records(&places, CWI_VERTICES, out, encode_normal, err);
    cwi_free(places.mesh.normals);
    return st;
}

/* Writes texture coordinates; in OBJ the second one goes up. seams: zeroed if vertices have them */
static cw_status write_places(const cwi_part *part, const cwi_texture_seams *seams,
                              cwi_mesh_output *out, cw_error *err)
{
    unsigned char line[CWI_RECORD_BYTES];
    const float *uv = part->texture->data;
    const size_t count = seams->number ? seams->count : part->mesh.vertex_count;
    cw_status st = CW_OK;
    for (size_t n = 0; n < count && st == CW_OK; n++) {
        const bool is_none = seams->number && seams->corner[n] == CWI_NO_CORNER;
        const size_t at = is_none         ? 0
                          : seams->number ? value_of(part, part->texture, seams->corner[n])
                                          : 2 * n;
        const double u = is_none ? 0 : (double)uv[at], v = is_none ? 0 : 1 - (double)uv[at + 1];
        unsigned char *to = cwi_put_decimal(cwi_put_text(line, "vt "), u, SINGLE_DIGITS);
        to = cwi_put_text(cwi_put_decimal(cwi_put_text(to, " "), v, digits_of_place(v)), "\n");
        st = cwi_outfile_write(out->file, line, (size_t)(to - line), err);
    }
    return st;
}

/* The numbers that the elements of the next object begin with. */
typedef struct next_numbers {
    uint64_t place, normal;
} next_numbers;

/* Writes what vertices have at several values, and the faces that name it. */
static cw_status write_faces(cwi_part *part, cwi_mesh_output *out, next_numbers *next,
                             cw_error *err)
{
    cwi_texture_seams seams = {0};
    const bool has_seams =
        part->corner_normals || (part->texture && part->texture->on == CW_ON_CORNERS);
    cw_status st = has_seams ? cwi_seams_find(&part->mesh, &seams, err) : CW_OK;
    part->first_place = next->place;
    part->places = seams.number;
    if (st == CW_OK && part->arrays & CW_KEEPS_NORMALS)
        st = write_normals(part, &seams, out, &next->normal, err);
    if (st == CW_OK && part->texture) {
        next->place += has_seams ? seams.count : part->mesh.vertex_count;
        st = write_places(part, &seams, out, err);
    }
    if (st == CW_OK)
        st = cwi_write_records(part, CWI_TRIANGLES, out, encode_face, err);
    cwi_seams_free(&seams);
    part->places = NULL;
    return st;
}

static cw_status write_object(const cwi_parts *parts, cwi_part *part, cwi_mesh_output *out,
                              next_numbers *next, cw_error *err)
{
    char material[MATERIAL_BYTES];
    cw_status st = cwi_outfile_printf(out->file, err, "o %s\n", part->name);
    if (st == CW_OK && part->textures)
        st = cwi_outfile_printf(out->file, err, "usemtl texture_%zu\n",
                                cwi_obj_textures(parts, part));
    if (st == CW_OK && has_material(part)) {
        print_material(part, material);
        st = cwi_outfile_printf(out->file, err, "usemtl %s\n", material);
    }
    if (st == CW_OK)
        st = cwi_write_records(part, CWI_VERTICES, out, encode_place, err);
    return st == CW_OK ? write_faces(part, out, next, err) : st;
}

cw_status cwi_obj_write(const cwi_parts *parts, cwi_mesh_output *out, cw_error *err)
{
    const cwi_part *last = &parts->items[parts->count - 1];
    char axes[CWI_AXES_BYTES], origin[CWI_ORIGIN_BYTES];
    cwi_print_axes(out->axes, axes);
    cwi_print_origin(out, "# origin ", "\n", origin);
    out->total = (size_t)(parts->vertices + last->first_normal + parts->triangles);
    out->total += last->arrays & CW_KEEPS_NORMALS ? last->mesh.vertex_count : 0;
    cw_status st =
        cwi_outfile_printf(out->file, err, "# cubewright %s, %s\n%s", CW_VERSION, axes, origin);
    next_numbers next = {0, 0};
    bool has_materials = has_face_colors(parts);
    for (size_t i = 0; i < parts->count; i++)
        has_materials =
            has_materials || has_material(&parts->items[i]) || parts->items[i].textures;
    if (st == CW_OK && has_materials)
        st = write_materials(parts, out, err);
    for (size_t i = 0; i < parts->count && st == CW_OK; i++)
        st = write_object(parts, &parts->items[i], out, &next, err);
    return st;
}
