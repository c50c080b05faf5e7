/* Writes PLY, binary little-endian or text: everything of a mesh except its affine. */

#include "core/base/status.h"
#include "core/volume/label_table.h"
#include "formats/ply/ply_format.h"

#define COLOR_PROPERTIES                                                                       \
    "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty uchar alpha\n"

static unsigned char *encode_vertex(const cwi_part *part, size_t v, unsigned char *to)
{
    const cw_mesh *mesh = &part->mesh;
    for (int a = 0; a < 3; a++)
        to = cwi_put_f32(to, (float)cwi_file_coordinate(part, v, a));
    if (mesh->normals) {
        float normal[3];
        cwi_normal(part, v, normal);
        to = cwi_put_f32x3(to, normal);
    }
    if (part->arrays & CW_KEEPS_COLORS) {
        memcpy(to, cwi_vertex_color(part, v), 4);
        to += 4;
    }
    if (mesh->scalars)
        to = cwi_put_f32(to, mesh->scalars[v]);
    if (part->arrays & CW_KEEPS_LABELS)
        to = cwi_put_u32(to, cwi_vertex_label(part, v));
    return to;
}

static unsigned char *encode_face(const cwi_part *part, size_t t, unsigned char *to)
{
    *to++ = 3;
    for (int c = 0; c < 3; c++)
        to = cwi_put_u32(to, (uint32_t)cwi_corner_number(part, t, c));
    if (part->face_colors) {
        memcpy(to, part->face_colors + 4 * t, 4);
        to += 4;
    }
    for (size_t s = 0; part->sides && s < 2; s++)
        to = cwi_put_u32(to, part->sides[2 * t + s]);
    return to;
}

static unsigned char *encode_text_face(const cwi_part *part, size_t t, unsigned char *to)
{
    to = cwi_put_face_line(part, t, to) - 1; /* without the line end */
    for (size_t c = 0; part->face_colors && c < 4; c++)
        to = cwi_put_integer(cwi_put_text(to, " "), part->face_colors[4 * t + c]);
    for (size_t s = 0; part->sides && s < 2; s++)
        to = cwi_put_integer(cwi_put_text(to, " "), part->sides[2 * t + s]);
    return cwi_put_text(to, "\n");
}

static unsigned char *encode_text_vertex(const cwi_part *part, size_t v, unsigned char *to)
{
    const cw_mesh *mesh = &part->mesh;
    float position[3];
    for (int a = 0; a < 3; a++)
        position[a] = (float)cwi_file_coordinate(part, v, a);
    to = cwi_put_singles(to, position);
    if (mesh->normals)
        to = cwi_put_normal(cwi_put_text(to, " "), part, v);
    for (size_t c = 0; part->arrays & CW_KEEPS_COLORS && c < 4; c++)
        to = cwi_put_integer(cwi_put_text(to, " "), cwi_vertex_color(part, v)[c]);
    if (mesh->scalars)
        to = cwi_put_decimal(cwi_put_text(to, " "), (double)mesh->scalars[v], 9);
    if (part->arrays & CW_KEEPS_LABELS)
        to = cwi_put_integer(cwi_put_text(to, " "), cwi_vertex_label(part, v));
    return cwi_put_text(to, "\n");
}

/* Writes a label's colour and name, and its number where that is not the value in the file. */
static cw_status write_label(const cw_label *label, cwi_outfile *file, cw_error *err)
{
    uint8_t c[4];
    char number[CW_LABEL_NUMBER];
    cwi_label_color(label, c);
    cw_status st =
        cwi_outfile_printf(file, err, "comment label %u #%02X%02X%02X%02X %s\n", label->value,
                           c[0], c[1], c[2], c[3], label->name ? label->name : "");
    return st == CW_OK && label->id
               ? cwi_outfile_printf(file, err, "comment label_number %u %s\n", label->value,
                                    cw_label_number(label, number))
               : st;
}

/* Writes comments about the labels of the vertices, or of the sides of triangles. */
static cw_status write_labels(const cwi_parts *parts, cwi_outfile *file, cw_error *err)
{
    const cw_label_table *sides = parts->items[0].side_labels;
    cw_status st = CW_OK;
    for (size_t n = 0; sides && n < sides->count && st == CW_OK; n++)
        st = write_label(&sides->labels[n], file, err);
    for (size_t n = 0; !sides && n < parts->count && st == CW_OK; n++)
        if (parts->items[n].label)
            st = write_label(parts->items[n].label, file, err);
    return st;
}

static cw_status write_header(const cwi_parts *parts, const cwi_mesh_output *out, cw_error *err)
{
    const unsigned has = parts->items[0].arrays; /* all have the same */
    /* readers expect int; uint is used only when the numbers need it */
    const char *index = parts->vertices > INT32_MAX ? "uint" : "int";
    char origin[CWI_ORIGIN_BYTES];
    cwi_print_origin(out, "comment origin ", "\n", origin);
    cw_status st = cwi_outfile_printf(
        out->file, err,
        "ply\nformat %s 1.0\n"
        "comment cubewright %s\ncomment object %s\ncomment unit %s\ncomment frame %s\n%s%s",
        out->text ? "ascii" : "binary_little_endian", CW_VERSION, out->name,
        cw_unit_name(out->axes->unit), out->axes->ras ? "RAS" : "LPS",
        out->axes->y_up ? "comment up Y\n" : "", origin);
    if (st == CW_OK)
        st = write_labels(parts, out->file, err);
    if (st != CW_OK)
        return st;
    return cwi_outfile_printf(
        out->file, err,
        "element vertex %ju\nproperty float x\nproperty float y\nproperty float z\n%s%s%s%s"
        "element face %ju\nproperty list uchar %s vertex_indices\n%s%send_header\n",
        (uintmax_t)parts->vertices,
        has & CW_KEEPS_NORMALS ? "property float nx\nproperty float ny\nproperty float nz\n"
                               : "",
        has & CW_KEEPS_COLORS ? COLOR_PROPERTIES : "",
        has & CW_KEEPS_SCALARS ? "property float scalar\n" : "",
        has & CW_KEEPS_LABELS ? "property uint label\n" : "", (uintmax_t)parts->triangles,
        index, has & CW_KEEPS_FACE_COLORS ? COLOR_PROPERTIES : "",
        parts->items[0].sides ? "property uint label_0\nproperty uint label_1\n" : "");
}

cw_status cwi_ply_write(const cwi_parts *parts, cwi_mesh_output *out, cw_error *err)
{
    if (parts->vertices > UINT32_MAX)
        return cwi_fail(err, CW_ERR_LIMIT, "PLY counts at most %u vertices; the mesh has %llu",
                        UINT32_MAX, (unsigned long long)parts->vertices);
    out->total = (size_t)(parts->vertices + parts->triangles);
    cw_status st = cwi_check_single(parts, err);
    if (st == CW_OK)
        st = write_header(parts, out, err);
    if (st == CW_OK)
        st = cwi_write_part_vertices(parts, out, out->text ? encode_text_vertex : encode_vertex,
                                     err);
    if (st == CW_OK)
        st = cwi_write_triangles(parts, out, out->text ? encode_text_face : encode_face, err);
    return st;
}
