/* Writes Wavefront OBJ: text, so the only plain format that keeps places far from zero
 * exact. */
#include "formats/mesh/mesh_writer.h"

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
        if (part->mesh.normals)
            to = cwi_put_integer(cwi_put_text(to, "//"),
                                 number - part->first + part->first_normal);
    }
    return cwi_put_text(to, "\n");
}

static cw_status write_object(const cwi_part *part, cwi_mesh_output *out, cw_error *err)
{
    const cw_mesh *mesh = &part->mesh;
    cw_status st = cwi_outfile_printf(out->file, err, "o %s\n", part->name);
    if (st == CW_OK)
        st = cwi_write_records(part, out, encode_place, mesh->vertex_count, err);
    if (st == CW_OK && mesh->normals)
        st = cwi_write_records(part, out, encode_normal, mesh->vertex_count, err);
    if (st == CW_OK)
        st = cwi_write_records(part, out, encode_face, mesh->triangle_count, err);
    return st;
}

cw_status cwi_obj_write(const cwi_parts *parts, cwi_mesh_output *out, cw_error *err)
{
    const cwi_part *last = &parts->items[parts->count - 1];
    char axes[CWI_AXES_BYTES], origin[CWI_ORIGIN_BYTES];
    cwi_print_axes(out->axes, axes);
    cwi_print_origin(out, "# origin ", "\n", origin);
    out->total = (size_t)(parts->vertices + last->first_normal + parts->triangles);
    out->total += last->mesh.normals ? last->mesh.vertex_count : 0;
    cw_status st =
        cwi_outfile_printf(out->file, err, "# cubewright %s, %s\n%s", CW_VERSION, axes, origin);
    for (size_t i = 0; i < parts->count && st == CW_OK; i++)
        st = write_object(&parts->items[i], out, err);
    return st;
}
