/* Wavefront OBJ: text, so the one plain format that keeps places far from zero exact. */
#include "formats/mesh_writers.h"

static unsigned char *encode_place(const cwi_part *part, size_t v, unsigned char *to)
{
    to = cwi_put_place(cwi_put_text(to, "v"), part, v);
    return cwi_put_text(to, "\n");
}

static unsigned char *encode_normal(const cwi_part *part, size_t v, unsigned char *to)
{
    float normal[3];
    cwi_normal(part, v, normal);
    to = cwi_put_floats(cwi_put_text(to, "vn"), normal, 3);
    return cwi_put_text(to, "\n");
}

/* Numbers start at 1; a vertex and its normal share one, as all parts have normals or none. */
static unsigned char *encode_face(const cwi_part *part, size_t t, unsigned char *to)
{
    *to++ = 'f';
    for (int c = 0; c < 3; c++) {
        const uint64_t number = cwi_corner_number(part, t, c) + 1;
        *to++ = ' ';
        to = cwi_put_integer(to, number);
        if (part->mesh.normals)
            to = cwi_put_integer(cwi_put_text(to, "//"), number);
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
    const uint64_t normals = parts->items[0].mesh.normals ? parts->vertices : 0;
    char axes[CWI_AXES_BYTES], origin[CWI_ORIGIN_BYTES];
    cwi_print_axes(out->axes, axes);
    cwi_print_origin(out, "# origin", "\n", origin);
    out->total = (size_t)(parts->vertices + normals + parts->triangles);
    cw_status st =
        cwi_outfile_printf(out->file, err, "# cubewright %s, %s\n%s", CW_VERSION, axes, origin);
    for (size_t i = 0; i < parts->count && st == CW_OK; i++)
        st = write_object(&parts->items[i], out, err);
    return st;
}
