/* Wavefront OBJ: text, so the one plain format that keeps places far from zero exact. */
#include "formats/mesh_writers.h"

#include "core/text.h"

#include <math.h>
#include <stdio.h>

static unsigned char *put_place(const cwi_part *part, size_t v, int digits, unsigned char *to)
{
    return to + snprintf((char *)to, CWI_RECORD_BYTES, "v %.*g %.*g %.*g\n", digits,
                         cwi_world_coordinate(part, v, 0), digits,
                         cwi_world_coordinate(part, v, 1), digits,
                         cwi_world_coordinate(part, v, 2));
}

/* Nine digits give a float back to the bit, the tenth is room for the origin. */
static unsigned char *encode_near_place(const cwi_part *part, size_t v, unsigned char *to)
{
    return put_place(part, v, 10, to);
}

/* A double to the bit. */
static unsigned char *encode_far_place(const cwi_part *part, size_t v, unsigned char *to)
{
    return put_place(part, v, 17, to);
}

/* Whether the mesh stands more than ten times its own size from zero. */
static bool is_far(const cw_mesh *mesh)
{
    double low[3], high[3], distance = 0, size = 0;
    cw_mesh_bounds(mesh, low, high);
    for (int a = 0; a < 3; a++) {
        distance = fmax(distance, fmax(fabs(low[a]), fabs(high[a])));
        size = fmax(size, high[a] - low[a]);
    }
    return distance > 10 * size;
}

static unsigned char *encode_normal(const cwi_part *part, size_t v, unsigned char *to)
{
    const float *n = part->mesh.normals + 3 * v;
    return to + snprintf((char *)to, CWI_RECORD_BYTES, "vn %.9g %.9g %.9g\n", (double)n[0],
                         (double)n[1], (double)n[2]);
}

/* Numbers start at 1; a vertex and its normal share one, as all parts have normals or none. */
static unsigned char *encode_face(const cwi_part *part, size_t t, unsigned char *to)
{
    uint64_t n[3];
    for (int c = 0; c < 3; c++)
        n[c] = cwi_corner_number(part, t, c) + 1;
    const int length =
        part->mesh.normals
            ? snprintf((char *)to, CWI_RECORD_BYTES, "f %ju//%ju %ju//%ju %ju//%ju\n",
                       (uintmax_t)n[0], (uintmax_t)n[0], (uintmax_t)n[1], (uintmax_t)n[1],
                       (uintmax_t)n[2], (uintmax_t)n[2])
            : snprintf((char *)to, CWI_RECORD_BYTES, "f %ju %ju %ju\n", (uintmax_t)n[0],
                       (uintmax_t)n[1], (uintmax_t)n[2]);
    return to + length;
}

static cw_status write_object(const cwi_part *part, cwi_mesh_output *out, cw_error *err)
{
    const cw_mesh *mesh = &part->mesh;
    cwi_record_encoder *encode_place = is_far(mesh) ? encode_far_place : encode_near_place;
    cw_status st = cwi_outfile_printf(out->file, err, "o %s\n", part->name);
    if (st == CW_OK)
        st = cwi_write_records(part, out, encode_place, mesh->vertex_count, err);
    if (st == CW_OK && mesh->normals)
        st = cwi_write_records(part, out, encode_normal, mesh->vertex_count, err);
    if (st == CW_OK)
        st = cwi_write_records(part, out, encode_face, mesh->triangle_count, err);
    return st;
}

static cw_status write_objects(const cwi_parts *parts, cwi_mesh_output *out, cw_error *err)
{
    char origin[CWI_ORIGIN_BYTES];
    cwi_print_origin(out, "# origin", "\n", origin);
    cw_status st =
        cwi_outfile_printf(out->file, err, "# cubewright %s, LPS, mm\n%s", CW_VERSION, origin);
    for (size_t i = 0; i < parts->count && st == CW_OK; i++)
        st = write_object(&parts->items[i], out, err);
    return st;
}

cw_status cwi_obj_write(const cwi_parts *parts, cwi_mesh_output *out, cw_error *err)
{
    const uint64_t normals = parts->items[0].mesh.normals ? parts->vertices : 0;
    out->total = (size_t)(parts->vertices + normals + parts->triangles);
    void *before = cwi_locale_c();
    cw_status st = write_objects(parts, out, err);
    cwi_locale_restore(before);
    return st;
}
