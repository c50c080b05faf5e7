/* Writes STL. Binary: an 80-byte header, a count, then 50 bytes per triangle, the
 * last two of which are its colour or 0. Text: one solid. */

#include "core/base/status.h"
#include "formats/stl/stl_colors.h"
#include "formats/stl/stl_format.h"

#include <math.h>
#include <stdio.h>

/* Computes the normal of the corners as written, so that normal and winding agree for every
 * reader. Far from zero, rounding may leave a facet without area: its normal is 0 0 0. */
static void facet_normal(float corner[3][3], float normal[3])
{
    double edge[2][3], n[3];
    for (int e = 0; e < 2; e++)
        for (int a = 0; a < 3; a++)
            edge[e][a] = (double)corner[e + 1][a] - (double)corner[0][a];
    for (int a = 0; a < 3; a++)
        n[a] = edge[0][(a + 1) % 3] * edge[1][(a + 2) % 3] -
               edge[0][(a + 2) % 3] * edge[1][(a + 1) % 3];
    const double length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    for (int a = 0; a < 3; a++)
        normal[a] = length > 0 ? (float)(n[a] / length) : 0;
}

/* Computes a facet's normal and its corners. */
static void find_facet(const cwi_part *part, size_t i, float normal[3], float corner[3][3])
{
    const uint32_t *vertex = part->mesh.triangles + 3 * i;
    for (int c = 0; c < 3; c++)
        for (int a = 0; a < 3; a++)
            corner[c][a] = (float)cwi_file_coordinate(part, vertex[c], a);
    facet_normal(corner, normal);
}

static unsigned char *encode_facet(const cwi_part *part, size_t i, unsigned char *to)
{
    float corner[3][3], normal[3];
    find_facet(part, i, normal, corner);
    to = cwi_put_f32x3(to, normal);
    for (int c = 0; c < 3; c++)
        to = cwi_put_f32x3(to, corner[c]);
    return cwi_put_u16(to,
                       part->face_colors ? cwi_stl_pack_color(part->face_colors + 4 * i) : 0);
}

static unsigned char *encode_text_facet(const cwi_part *part, size_t i, unsigned char *to)
{
    float corner[3][3], normal[3];
    find_facet(part, i, normal, corner);
    to = cwi_put_singles(cwi_put_text(to, "facet normal "), normal);
    to = cwi_put_text(to, "\nouter loop\n");
    for (int c = 0; c < 3; c++)
        to = cwi_put_text(cwi_put_singles(cwi_put_text(to, "vertex "), corner[c]), "\n");
    return cwi_put_text(to, "endloop\nendfacet\n");
}

/* Fills the header. It must not begin with "solid": readers take that for the text form. */
static void fill_header(const cwi_mesh_output *out, uint32_t count, unsigned char header[84])
{
    char axes[CWI_AXES_BYTES], origin[CWI_ORIGIN_BYTES], text[80 + CWI_ORIGIN_BYTES];
    cwi_print_axes(out->axes, axes);
    cwi_print_origin(out, " from ", "", origin);
    int length = snprintf(text, sizeof text, "cubewright, %s%s", axes, origin);
    if (length >= 80)
        length = snprintf(text, sizeof text, "cubewright, %s from an origin of its own", axes);
    memset(header, 0, 84);
    memcpy(header, text, (size_t)length);
    cwi_put_u32(header + 80, count);
}

static cw_status write_text(const cwi_parts *parts, cwi_mesh_output *out, cw_error *err)
{
    char axes[CWI_AXES_BYTES], origin[CWI_ORIGIN_BYTES];
    cwi_print_axes(out->axes, axes);
    cwi_print_origin(out, " from ", "", origin);
    cw_status st = cwi_outfile_printf(out->file, err, "solid %s cubewright, %s%s\n", out->name,
                                      axes, origin);
    if (st == CW_OK)
        st = cwi_write_facets(parts, out, encode_text_facet, err);
    if (st == CW_OK)
        st = cwi_outfile_printf(out->file, err, "endsolid %s\n", out->name);
    return st;
}

static cw_status write_binary(const cwi_parts *parts, cwi_mesh_output *out, cw_error *err)
{
    unsigned char header[84];
    if (parts->triangles > UINT32_MAX)
        return cwi_fail(err, CW_ERR_LIMIT, "STL counts at most %u triangles; the mesh has %llu",
                        UINT32_MAX, (unsigned long long)parts->triangles);
    fill_header(out, (uint32_t)parts->triangles, header);
    cw_status st = cwi_outfile_write(out->file, header, sizeof header, err);
    return st == CW_OK ? cwi_write_facets(parts, out, encode_facet, err) : st;
}

cw_status cwi_stl_write(const cwi_parts *parts, cwi_mesh_output *out, cw_error *err)
{
    out->total = (size_t)parts->triangles;
    cw_status st = cwi_check_single(parts, err);
    if (st != CW_OK)
        return st;
    return out->text ? write_text(parts, out, err) : write_binary(parts, out, err);
}
