/* Writes FreeSurfer's surfaces of triangles, with the geometry of a volume around them that keeps them
 * where they are in the scanner. */
#include "core/base/status.h"
#include "formats/freesurfer/freesurfer_format.h"

static unsigned char *put_number(unsigned char *to, uint32_t number)
{
    for (int shift = 24; shift >= 0; shift -= 8)
        *to++ = (unsigned char)(number >> shift);
    return to;
}

static unsigned char *encode_vertex(const cwi_part *part, size_t v, unsigned char *to)
{
    for (int a = 0; a < 3; a++) {
        const float place = (float)cwi_file_coordinate(part, v, a);
        uint32_t bits;
        memcpy(&bits, &place, sizeof bits);
        to = put_number(to, bits);
    }
    return to;
}

static unsigned char *encode_face(const cwi_part *part, size_t t, unsigned char *to)
{
    for (int c = 0; c < 3; c++)
        to = put_number(to, (uint32_t)cwi_corner_number(part, t, c));
    return to;
}

static cw_status write_head(const cwi_parts *parts, const cwi_mesh_output *out, cw_error *err)
{
    static const unsigned char magic[] = {0xFF, 0xFF, 0xFE};
    unsigned char counts[8];
    put_number(put_number(counts, (uint32_t)parts->vertices), (uint32_t)parts->triangles);
    cw_status st = cwi_outfile_write(out->file, magic, sizeof magic, err);
    if (st == CW_OK)
        st = cwi_outfile_printf(out->file, err, "created by cubewright %s\n\n", CW_VERSION);
    return st == CW_OK ? cwi_outfile_write(out->file, counts, sizeof counts, err) : st;
}

/* Writes the geometry of a coronal volume, whose centre is the origin of a local file. */
static cw_status write_geometry(const cwi_mesh_output *out, cw_error *err)
{
    static const unsigned char tags[] = {0, 0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 20};
    const double *o = out->local_origin;
    cw_status st = cwi_outfile_write(out->file, tags, sizeof tags, err);
    return st == CW_OK
               ? cwi_outfile_printf(
                     out->file, err,
                     "valid = 1  # volume info valid\nfilename = none\nvolume = 256 256 256\n"
                     "voxelsize = 1 1 1\nxras   = -1 0 0\nyras   = 0 0 -1\nzras   = 0 1 0\n"
                     "cras   = %.17g %.17g %.17g\n",
                     o ? o[0] : 0, o ? o[1] : 0, o ? o[2] : 0)
               : st;
}

cw_status cwi_freesurfer_write(const cwi_parts *parts, cwi_mesh_output *out, cw_error *err)
{
    if (parts->vertices > INT32_MAX || parts->triangles > INT32_MAX)
        return cwi_fail(
            err, CW_ERR_LIMIT,
            "FreeSurfer numbers at most %d vertices and triangles; the mesh has %llu "
            "and %llu",
            INT32_MAX, (unsigned long long)parts->vertices,
            (unsigned long long)parts->triangles);
    out->total = (size_t)(parts->vertices + parts->triangles);
    cw_status st = cwi_check_single(parts, err);
    if (st == CW_OK)
        st = write_head(parts, out, err);
    if (st == CW_OK)
        st = cwi_write_part_vertices(parts, out, encode_vertex, err);
    if (st == CW_OK)
        st = cwi_write_triangles(parts, out, encode_face, err);
    return st == CW_OK ? write_geometry(out, err) : st;
}
