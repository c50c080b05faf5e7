/* Writes GIfTI surfaces: one array of points and one of triangles, each deflated, as base64. */
#include "core/base/status.h"
#include "formats/bytes/base64.h"
#include "formats/bytes/inflate_stream.h"
#include "formats/gifti/gifti_format.h"

#include "core/base/memory.h"
#include "formats/text/xml.h"

#include <stdio.h>

enum { PACKED_BYTES = 48 * 1024, TEXT_BYTES = PACKED_BYTES / 3 * 4 + 4 };

/* Deflates bytes, and writes them as base64. The packed bytes fill whole groups of three until the
 * end. */
typedef struct text_sink {
    cwi_outfile *file; /* borrowed */
    z_stream z;
    unsigned char *packed;
    char *text;
} text_sink;

static cw_status write_packed(text_sink *s, cw_error *err)
{
    const size_t size = PACKED_BYTES - s->z.avail_out;
    s->z.next_out = s->packed;
    s->z.avail_out = PACKED_BYTES;
    return cwi_outfile_write(s->file, s->text, cwi_base64_encode(s->packed, size, s->text),
                             err);
}

static cw_status put_bytes(void *to, const void *bytes, size_t size, cw_error *err)
{
    text_sink *s = to;
    cw_status st = CW_OK;
    s->z.next_in = bytes;
    s->z.avail_in = (uInt)size;
    while (st == CW_OK && s->z.avail_in > 0) {
        deflate(&s->z, Z_NO_FLUSH);
        if (s->z.avail_out == 0)
            st = write_packed(s, err);
    }
    return st;
}

static cw_status finish_text(text_sink *s, cw_error *err)
{
    cw_status st = CW_OK;
    while (st == CW_OK && deflate(&s->z, Z_FINISH) != Z_STREAM_END)
        st = write_packed(s, err);
    return st == CW_OK ? write_packed(s, err) : st;
}

static cw_status open_text(text_sink *s, cwi_outfile *file, cw_error *err)
{
    *s = (text_sink){.file = file,
                     .packed = cwi_alloc_array(PACKED_BYTES, 1),
                     .text = cwi_alloc_array(TEXT_BYTES, 1)};
    cwi_zlib_use_memory(&s->z);
    if (!s->packed || !s->text || deflateInit(&s->z, Z_BEST_SPEED) != Z_OK)
        return cwi_fail_memory(err);
    s->z.next_out = s->packed;
    s->z.avail_out = PACKED_BYTES;
    return CW_OK;
}

static void close_text(text_sink *s)
{
    deflateEnd(&s->z); /* refuses one that was never opened */
    cwi_free(s->packed);
    cwi_free(s->text);
}

/* --- arrays ------------------------------------------------------------------------------- */

static unsigned char *encode_place(const cwi_part *part, size_t v, unsigned char *to)
{
    for (int a = 0; a < 3; a++)
        to = cwi_put_f32(to, (float)cwi_file_coordinate(part, v, a));
    return to;
}

static unsigned char *encode_corners(const cwi_part *part, size_t t, unsigned char *to)
{
    for (int c = 0; c < 3; c++)
        to = cwi_put_u32(to, (uint32_t)cwi_corner_number(part, t, c));
    return to;
}

static cw_status begin_array(const cwi_mesh_output *out, const char *intent, const char *type,
                             uint64_t count, cw_error *err)
{
    return cwi_outfile_printf(
        out->file, err,
        "<DataArray Intent=\"NIFTI_INTENT_%s\" DataType=\"NIFTI_TYPE_%s\" "
        "ArrayIndexingOrder=\"RowMajorOrder\" Dimensionality=\"2\" Dim0=\"%ju\" Dim1=\"3\" "
        "Encoding=\"GZipBase64Binary\" Endian=\"LittleEndian\" ExternalFileName=\"\" "
        "ExternalFileOffset=\"\">\n<MetaData/>\n",
        intent, type, (uintmax_t)count);
}

/* Writes how the points lie in the scanner: those of a local file are shifted to there. */
static cw_status write_frame(const cwi_mesh_output *out, cw_error *err)
{
    const double *o = out->local_origin;
    return cwi_outfile_printf(
        out->file, err,
        "<CoordinateSystemTransformMatrix>\n<DataSpace><![CDATA[NIFTI_XFORM_%s]]></DataSpace>\n"
        "<TransformedSpace><![CDATA[NIFTI_XFORM_SCANNER_ANAT]]></TransformedSpace>\n"
        "<MatrixData>1 0 0 %.17g 0 1 0 %.17g 0 0 1 %.17g 0 0 0 1</MatrixData>\n"
        "</CoordinateSystemTransformMatrix>\n",
        o ? "UNKNOWN" : "SCANNER_ANAT", o ? o[0] : 0, o ? o[1] : 0, o ? o[2] : 0);
}

static cw_status write_numbers(const cwi_parts *parts, cwi_mesh_output *out, bool of_triangles,
                               cw_error *err)
{
    text_sink sink;
    cw_status st = open_text(&sink, out->file, err);
    out->drain = put_bytes;
    out->drain_to = &sink;
    if (st == CW_OK)
        st = cwi_outfile_printf(out->file, err, "<Data>");
    if (st == CW_OK)
        st = of_triangles ? cwi_write_triangles(parts, out, encode_corners, err)
                          : cwi_write_part_vertices(parts, out, encode_place, err);
    if (st == CW_OK)
        st = finish_text(&sink, err);
    close_text(&sink);
    return st == CW_OK ? cwi_outfile_printf(out->file, err, "</Data>\n</DataArray>\n") : st;
}

cw_status cwi_gifti_write(const cwi_parts *parts, cwi_mesh_output *out, cw_error *err)
{
    char name[CWI_XML_BYTES(CWI_NAME_BYTES)];
    if (parts->vertices > INT32_MAX || parts->triangles > INT32_MAX)
        return cwi_fail(
            err, CW_ERR_LIMIT,
            "GIfTI numbers at most %d vertices and triangles; the mesh has %llu and "
            "%llu",
            INT32_MAX, (unsigned long long)parts->vertices,
            (unsigned long long)parts->triangles);
    cwi_xml_escape(out->name, name, sizeof name);
    out->total = (size_t)(parts->vertices + parts->triangles);
    cw_status st = cwi_check_single(parts, err);
    if (st == CW_OK)
        st = cwi_outfile_printf(
            out->file, err,
            "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
            "<GIFTI Version=\"1.0\" NumberOfDataArrays=\"2\">\n"
            "<MetaData>\n<MD><Name>Name</Name><Value>%s</Value></MD>\n"
            "<MD><Name>Provenance</Name><Value>cubewright %s</Value></MD>\n</MetaData>\n"
            "<LabelTable/>\n",
            name, CW_VERSION);
    if (st == CW_OK)
        st = begin_array(out, "POINTSET", "FLOAT32", parts->vertices, err);
    if (st == CW_OK)
        st = write_frame(out, err);
    if (st == CW_OK)
        st = write_numbers(parts, out, false, err);
    if (st == CW_OK)
        st = begin_array(out, "TRIANGLE", "INT32", parts->triangles, err);
    if (st == CW_OK)
        st = write_numbers(parts, out, true, err);
    return st == CW_OK ? cwi_outfile_printf(out->file, err, "</GIFTI>\n") : st;
}
