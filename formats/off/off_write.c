/* Writes OFF as text; the keyword is COFF with colours, NOFF with normals, CNOFF with both. */
#include "formats/off/off_format.h"

static unsigned char *encode_vertex(const cwi_part *part, size_t v, unsigned char *to)
{
    const cw_mesh *mesh = &part->mesh;
    to = cwi_put_place(to, part, v);
    if (mesh->normals)
        to = cwi_put_normal(cwi_put_text(to, " "), part, v);
    for (size_t c = 0; part->arrays & CW_KEEPS_COLORS && c < 4; c++)
        to = cwi_put_integer(cwi_put_text(to, " "), cwi_vertex_color(part, v)[c]);
    return cwi_put_text(to, "\n");
}

static unsigned char *encode_face(const cwi_part *part, size_t t, unsigned char *to)
{
    to = cwi_put_face_line(part, t, to) - 1; /* without the line end */
    for (size_t c = 0; part->face_colors && c < 4; c++)
        to = cwi_put_integer(cwi_put_text(to, " "), part->face_colors[4 * t + c]);
    return cwi_put_text(to, "\n");
}

cw_status cwi_off_write(const cwi_parts *parts, cwi_mesh_output *out, cw_error *err)
{
    const unsigned has = parts->items[0].arrays; /* all have the same */
    char axes[CWI_AXES_BYTES], origin[CWI_ORIGIN_BYTES];
    cwi_print_axes(out->axes, axes);
    cwi_print_origin(out, "# origin ", "\n", origin);
    out->total = (size_t)(parts->vertices + parts->triangles);
    cw_status st = cwi_outfile_printf(
        out->file, err, "%s%sOFF\n# cubewright %s, %s\n%s# object %s\n%ju %ju 0\n",
        has & CW_KEEPS_COLORS ? "C" : "", has & CW_KEEPS_NORMALS ? "N" : "", CW_VERSION, axes,
        origin, out->name, (uintmax_t)parts->vertices, (uintmax_t)parts->triangles);
    if (st == CW_OK)
        st = cwi_write_part_vertices(parts, out, encode_vertex, err);
    if (st == CW_OK)
        st = cwi_write_triangles(parts, out, encode_face, err);
    return st;
}
