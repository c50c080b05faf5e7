/* Wavefront OBJ: text, so the one plain format that keeps places far from zero exact. */
#include "formats/mesh_writers.h"

#include "core/text.h"

#include <stdio.h>

/* Ten digits: nine give a float back to the bit, the tenth is room for the origin. */
static unsigned char *encode_place(const cw_mesh *mesh, size_t v, unsigned char *to)
{
    return to + snprintf((char *)to, CWI_RECORD_BYTES, "v %.10g %.10g %.10g\n",
                         cwi_world_coordinate(mesh, v, 0), cwi_world_coordinate(mesh, v, 1),
                         cwi_world_coordinate(mesh, v, 2));
}

static unsigned char *encode_normal(const cw_mesh *mesh, size_t v, unsigned char *to)
{
    const float *n = mesh->normals + 3 * v;
    return to + snprintf((char *)to, CWI_RECORD_BYTES, "vn %.9g %.9g %.9g\n", (double)n[0],
                         (double)n[1], (double)n[2]);
}

/* Numbers start at 1; a vertex and its normal share one. */
static unsigned char *encode_face(const cw_mesh *mesh, size_t t, unsigned char *to)
{
    uint64_t n[3];
    for (size_t c = 0; c < 3; c++)
        n[c] = (uint64_t)mesh->triangles[3 * t + c] + 1;
    const int length =
        mesh->normals ? snprintf((char *)to, CWI_RECORD_BYTES, "f %ju//%ju %ju//%ju %ju//%ju\n",
                                 (uintmax_t)n[0], (uintmax_t)n[0], (uintmax_t)n[1],
                                 (uintmax_t)n[1], (uintmax_t)n[2], (uintmax_t)n[2])
                      : snprintf((char *)to, CWI_RECORD_BYTES, "f %ju %ju %ju\n",
                                 (uintmax_t)n[0], (uintmax_t)n[1], (uintmax_t)n[2]);
    return to + length;
}

static cw_status write_lines(const cw_mesh *mesh, cwi_mesh_output *out, cw_error *err)
{
    const size_t normal_count = mesh->normals ? mesh->vertex_count : 0;
    out->total = mesh->vertex_count + normal_count + mesh->triangle_count;
    cw_status st = cwi_outfile_printf(out->file, err, "# cubewright %s, LPS, mm\no %s\n",
                                      CW_VERSION, out->name);
    if (st == CW_OK)
        st = cwi_write_records(mesh, out, encode_place, mesh->vertex_count, err);
    if (st == CW_OK)
        st = cwi_write_records(mesh, out, encode_normal, normal_count, err);
    if (st == CW_OK)
        st = cwi_write_records(mesh, out, encode_face, mesh->triangle_count, err);
    return st;
}

cw_status cwi_obj_write(const cw_mesh *mesh, cwi_mesh_output *out, cw_error *err)
{
    void *before = cwi_locale_c();
    cw_status st = write_lines(mesh, out, err);
    cwi_locale_restore(before);
    return st;
}
