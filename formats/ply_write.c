/* Binary little-endian PLY: everything a mesh holds but its affine. */
#include "formats/mesh_writers.h"

#include <cubewright/core.h>

static unsigned char *encode_vertex(const cw_mesh *mesh, size_t v, unsigned char *to)
{
    for (int a = 0; a < 3; a++)
        to = cwi_put_f32(to, (float)cwi_world_coordinate(mesh, v, a));
    if (mesh->normals)
        to = cwi_put_f32x3(to, mesh->normals + 3 * v);
    if (mesh->colors) {
        memcpy(to, mesh->colors + 4 * v, 4);
        to += 4;
    }
    if (mesh->scalars)
        to = cwi_put_f32(to, mesh->scalars[v]);
    if (mesh->labels)
        to = cwi_put_u32(to, mesh->labels[v]);
    return to;
}

static unsigned char *encode_face(const cw_mesh *mesh, size_t t, unsigned char *to)
{
    *to++ = 3;
    for (size_t c = 0; c < 3; c++)
        to = cwi_put_u32(to, mesh->triangles[3 * t + c]);
    return to;
}

static cw_status write_header(const cw_mesh *mesh, const cwi_mesh_output *out, cw_error *err)
{
    /* int is what readers expect; uint only when the numbers need it */
    const char *index = mesh->vertex_count > INT32_MAX ? "uint" : "int";
    char origin[CWI_ORIGIN_BYTES];
    cwi_print_origin(out, "comment origin", "\n", origin);
    return cwi_outfile_printf(
        out->file, err,
        "ply\nformat binary_little_endian 1.0\n"
        "comment cubewright %s\ncomment object %s\ncomment unit mm\ncomment frame LPS\n%s"
        "element vertex %zu\nproperty float x\nproperty float y\nproperty float z\n%s%s%s%s"
        "element face %zu\nproperty list uchar %s vertex_indices\nend_header\n",
        CW_VERSION, out->name, origin, mesh->vertex_count,
        mesh->normals ? "property float nx\nproperty float ny\nproperty float nz\n" : "",
        mesh->colors ? "property uchar red\nproperty uchar green\nproperty uchar blue\n"
                       "property uchar alpha\n"
                     : "",
        mesh->scalars ? "property float scalar\n" : "",
        mesh->labels ? "property uint label\n" : "", mesh->triangle_count, index);
}

cw_status cwi_ply_write(const cw_mesh *mesh, cwi_mesh_output *out, cw_error *err)
{
    out->total = mesh->vertex_count + mesh->triangle_count;
    cw_status st = cwi_check_single(mesh, err);
    if (st == CW_OK)
        st = write_header(mesh, out, err);
    if (st == CW_OK)
        st = cwi_write_records(mesh, out, encode_vertex, mesh->vertex_count, err);
    if (st == CW_OK)
        st = cwi_write_records(mesh, out, encode_face, mesh->triangle_count, err);
    return st;
}
