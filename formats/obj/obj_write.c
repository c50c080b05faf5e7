/* Writes Wavefront OBJ: text, so the only plain format that keeps places far from zero
 * exact. */

#include "core/base/memory.h"
#include "core/base/status.h"
#include "formats/obj/obj_format.h"

#include <stdio.h>

enum { MATERIAL_BYTES = CWI_NAME_BYTES + 32 };

static unsigned char *encode_place(const cwi_part *part, size_t v, unsigned char *to)
{
    return cwi_put_text(cwi_put_place(cwi_put_text(to, "v "), part, v), "\n");
}

static unsigned char *encode_normal(const cwi_part *part, size_t v, unsigned char *to)
{
    return cwi_put_text(cwi_put_normal(cwi_put_text(to, "vn "), part, v), "\n");
}

/* Encodes a face. Numbers start at 1, and continue from object to object. */
static unsigned char *encode_face(const cwi_part *part, size_t t, unsigned char *to)
{
    *to++ = 'f';
    for (int c = 0; c < 3; c++) {
        const uint64_t number = cwi_corner_number(part, t, c) + 1;
        to = cwi_put_integer(cwi_put_text(to, " "), number);
        if (part->arrays & CW_KEEPS_NORMALS)
            to = cwi_put_integer(cwi_put_text(to, "//"),
                                 number - part->first + part->first_normal);
    }
    return cwi_put_text(to, "\n");
}

static bool has_material(const cwi_part *part)
{
    return part->label && part->label->has_color;
}

/* Prints the name of a part's material: one word that no other label has. */
static void print_material(const cwi_part *part, char text[MATERIAL_BYTES])
{
    const int length = snprintf(text, MATERIAL_BYTES, "%s_%u", part->name, part->label->value);
    for (char *c = text; *c; c++)
        *c = *c == ' ' ? '_' : *c;
    if (part->label->layer > 0)
        snprintf(text + length, MATERIAL_BYTES - (size_t)length, "_%u", part->label->layer);
}

/* Writes the materials of labels into a file of the same name that ends in .mtl. Colours are
 * those of sRGB, as readers expect them, with digits that give the byte again. */
static cw_status write_materials(const cwi_parts *parts, cwi_mesh_output *out, cw_error *err)
{
    const char *slash = strrchr(out->path, '/');
    const char *name = slash ? slash + 1 : out->path, *dot = strrchr(name, '.');
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
        const uint8_t *c = parts->items[i].label->color;
        print_material(&parts->items[i], material);
        st = cwi_outfile_printf(out->side, err, "newmtl %s\nKd %.4f %.4f %.4f\nd %.4f\n",
                                material, c[0] / 255.0, c[1] / 255.0, c[2] / 255.0,
                                c[3] / 255.0);
    }
    cwi_free(path);
    return st;
}

static cw_status write_object(const cwi_part *part, cwi_mesh_output *out, cw_error *err)
{
    char material[MATERIAL_BYTES];
    cw_status st = cwi_outfile_printf(out->file, err, "o %s\n", part->name);
    if (st == CW_OK && has_material(part)) {
        print_material(part, material);
        st = cwi_outfile_printf(out->file, err, "usemtl %s\n", material);
    }
    if (st == CW_OK)
        st = cwi_write_records(part, CWI_VERTICES, out, encode_place, err);
    if (st == CW_OK && part->arrays & CW_KEEPS_NORMALS)
        st = cwi_write_records(part, CWI_VERTICES, out, encode_normal, err);
    if (st == CW_OK)
        st = cwi_write_records(part, CWI_TRIANGLES, out, encode_face, err);
    return st;
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
    bool has_materials = false;
    for (size_t i = 0; i < parts->count; i++)
        has_materials = has_materials || has_material(&parts->items[i]);
    if (st == CW_OK && has_materials)
        st = write_materials(parts, out, err);
    for (size_t i = 0; i < parts->count && st == CW_OK; i++)
        st = write_object(&parts->items[i], out, err);
    return st;
}
