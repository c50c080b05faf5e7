/* Writes VTK's XML PolyData: arrays as appended raw data, each in blocks compressed by zlib. */
#include "core/volume/label_ids.h"
#include "core/volume/label_table.h"
#include "formats/bytes/block_writer.h"
#include "formats/mesh/place_parts.h"
#include "formats/vtk/vtk_formats.h"

#include <stdio.h>

/* --- records ----------------------------------------------------------------------------- */

static unsigned char *encode_place(const cwi_part *part, size_t v, unsigned char *to)
{
    for (int a = 0; a < 3; a++)
        to = cwi_put_f32(to, (float)cwi_file_coordinate(part, v, a));
    return to;
}

static unsigned char *encode_normal(const cwi_part *part, size_t v, unsigned char *to)
{
    float normal[3];
    cwi_normal(part, v, normal);
    return cwi_put_f32x3(to, normal);
}

static unsigned char *encode_color(const cwi_part *part, size_t v, unsigned char *to)
{
    memcpy(to, cwi_vertex_color(part, v), 4);
    return to + 4;
}

static unsigned char *encode_scalar(const cwi_part *part, size_t v, unsigned char *to)
{
    return cwi_put_f32(to, part->mesh.scalars[v]);
}

static unsigned char *encode_label(const cwi_part *part, size_t v, unsigned char *to)
{
    return cwi_put_u32(to, cwi_vertex_label(part, v));
}

static unsigned char *put_number(unsigned char *to, const cw_label *label)
{
    const uint64_t size = cwi_label_size(label);
    return cwi_put_u64(to, label->is_negative ? 0 - size : size);
}

static unsigned char *encode_wide_label(const cwi_part *part, size_t v, unsigned char *to)
{
    (void)v;
    return put_number(to, part->label);
}

static unsigned char *encode_corners(const cwi_part *part, size_t t, unsigned char *to)
{
    for (int c = 0; c < 3; c++)
        to = cwi_put_u32(to, (uint32_t)cwi_corner_number(part, t, c));
    return to;
}

static unsigned char *encode_wide_corners(const cwi_part *part, size_t t, unsigned char *to)
{
    for (int c = 0; c < 3; c++)
        to = cwi_put_u64(to, cwi_corner_number(part, t, c));
    return to;
}

static unsigned char *encode_wide_sides(const cwi_part *part, size_t t, unsigned char *to)
{
    for (int s = 0; s < 2; s++) {
        const uint32_t value = part->sides[2 * t + (size_t)s];
        const cw_label *label = cw_label_find(part->side_labels, 0, value);
        to = put_number(to, label ? label : &(cw_label){.value = value});
    }
    return to;
}

static unsigned char *encode_sides(const cwi_part *part, size_t t, unsigned char *to)
{
    return cwi_put_u32(cwi_put_u32(to, part->sides[2 * t]), part->sides[2 * t + 1]);
}

static unsigned char *encode_face_color(const cwi_part *part, size_t t, unsigned char *to)
{
    memcpy(to, part->face_colors + 4 * t, 4);
    return to + 4;
}

/* Encodes the end of a polygon's corners among all corners. */
static unsigned char *encode_end(const cwi_part *part, size_t t, unsigned char *to)
{
    return cwi_put_u32(to, (uint32_t)(3 * (part->first_triangle + t + 1)));
}

static unsigned char *encode_wide_end(const cwi_part *part, size_t t, unsigned char *to)
{
    return cwi_put_u64(to, 3 * (part->first_triangle + t + 1));
}

/* --- arrays ------------------------------------------------------------------------------ */

/* An array is written when the file needs its width of numbers. */
typedef enum width {
    ANY,
    NARROW, /* corners of 32 bits */
    WIDE,   /* or of 64 */
    VALUES, /* labels whose numbers are their values */
    SIGNED, /* labels whose numbers have 64 bits and a sign */
    UNSIGNED
} width;

/* Beside the cw_keeps flags: the labels on both sides of triangles. */
enum { SIDES = CW_KEEPS_ALL + 1 };

/* An array of the file. */
typedef struct array {
    unsigned keeps; /* written when the mesh has it; 0: always; SIDES */
    width width;
    const char *type, *name;
    size_t numbers, bytes; /* of a vertex or triangle */
    bool of_triangles;     /* else of vertices */
    cwi_record_encoder *encode;
    const char *before, *behind; /* tags of the elements around it */
} array;

/* The arrays, in the order of the file. */
static const array arrays[] = {
    {CW_KEEPS_NORMALS, ANY, "Float32", "Normals", 3, 12, false, encode_normal, "", ""},
    {CW_KEEPS_COLORS, ANY, "UInt8", "RGBA", 4, 4, false, encode_color, "", ""},
    {CW_KEEPS_SCALARS, ANY, "Float32", "scalar", 1, 4, false, encode_scalar, "", ""},
    {CW_KEEPS_LABELS, VALUES, "UInt32", "label", 1, 4, false, encode_label, "", ""},
    {CW_KEEPS_LABELS, SIGNED, "Int64", "label", 1, 8, false, encode_wide_label, "", ""},
    {CW_KEEPS_LABELS, UNSIGNED, "UInt64", "label", 1, 8, false, encode_wide_label, "", ""},
    {0, ANY, "Float32", "Points", 3, 12, false, encode_place, "</PointData>\n<Points>\n",
     "</Points>\n"},
    {0, NARROW, "Int32", "connectivity", 1, 12, true, encode_corners, "<Polys>\n", ""},
    {0, NARROW, "Int32", "offsets", 1, 4, true, encode_end, "", "</Polys>\n"},
    {0, WIDE, "Int64", "connectivity", 1, 24, true, encode_wide_corners, "<Polys>\n", ""},
    {0, WIDE, "Int64", "offsets", 1, 8, true, encode_wide_end, "", "</Polys>\n"},
    {SIDES, VALUES, "UInt32", "BoundaryLabels", 2, 8, true, encode_sides, "", ""},
    {SIDES, SIGNED, "Int64", "BoundaryLabels", 2, 16, true, encode_wide_sides, "", ""},
    {SIDES, UNSIGNED, "UInt64", "BoundaryLabels", 2, 16, true, encode_wide_sides, "", ""},
    {CW_KEEPS_FACE_COLORS, ANY, "UInt8", "RGBA", 4, 4, true, encode_face_color, "", ""},
};
enum {
    ARRAY_COUNT = sizeof arrays / sizeof *arrays,
    FIRST_OF_CELLS = ARRAY_COUNT - 4,
    OFFSET_DIGITS = 20
};

typedef struct vtp {
    cwi_mesh_output *out;
    const cwi_parts *parts;
    cwi_block_sink blocks;
    bool has[ARRAY_COUNT];
    uint64_t offset_at[ARRAY_COUNT]; /* places in the file of the arrays' offsets */
} vtp;

static width widen_labels(width labels, const cw_label *label)
{
    return !label || !label->id              ? labels
           : label->id > (uint64_t)INT64_MAX ? UNSIGNED
           : labels == UNSIGNED              ? UNSIGNED
                                             : SIGNED;
}

/* Returns the width of the labels of all parts, or of the sides of triangles. */
static width width_of_labels(const cwi_parts *parts)
{
    const cw_label_table *sides = parts->items[0].side_labels;
    width labels = VALUES;
    for (size_t n = 0; n < parts->count; n++)
        labels =
            parts->items[n].mesh.labels ? labels : widen_labels(labels, parts->items[n].label);
    for (size_t n = 0; sides && n < sides->count; n++)
        labels = widen_labels(labels, &sides->labels[n]);
    return labels;
}

static void choose_arrays(vtp *f, bool wide)
{
    const width labels = width_of_labels(f->parts);
    const cwi_part *first = &f->parts->items[0]; /* all parts have the same arrays */
    const unsigned has = first->arrays | (first->sides ? SIDES : 0u);
    for (int i = 0; i < ARRAY_COUNT; i++)
        f->has[i] = (!arrays[i].keeps || arrays[i].keeps & has) &&
                    (arrays[i].width == ANY || arrays[i].width == labels ||
                     arrays[i].width == (wide ? WIDE : NARROW));
}

static cw_status declare_array(vtp *f, int i, cw_error *err)
{
    const array *a = &arrays[i];
    cwi_outfile *file = f->out->file;
    cw_status st =
        cwi_outfile_printf(file, err,
                           "%s<DataArray type=\"%s\" Name=\"%s\" "
                           "NumberOfComponents=\"%zu\" format=\"appended\" offset=\"",
                           a->before, a->type, a->name, a->numbers);
    f->offset_at[i] = cwi_outfile_size(file);
    return st == CW_OK
               ? cwi_outfile_printf(file, err, "%0*d\"/>\n%s", OFFSET_DIGITS, 0, a->behind)
               : st;
}

/* Returns the array that viewers show at first: scalars, else colours. */
static const char *shown_array(const vtp *f)
{
    const unsigned has = f->parts->items[0].arrays;
    return has & CW_KEEPS_SCALARS  ? " Scalars=\"scalar\""
           : has & CW_KEEPS_COLORS ? " Scalars=\"RGBA\""
                                   : "";
}

static bool has_cell_data(const vtp *f)
{
    bool has = false;
    for (int i = FIRST_OF_CELLS; i < ARRAY_COUNT; i++)
        has = has || f->has[i];
    return has;
}

/* --- names and colours of labels --------------------------------------------------------- */

static const cw_label *label_at(const cwi_parts *parts, size_t n)
{
    const cw_label_table *sides = parts->items[0].side_labels;
    return sides ? &sides->labels[n] : parts->items[n].label;
}

static size_t count_labels(const cwi_parts *parts)
{
    const cw_label_table *sides = parts->items[0].side_labels;
    size_t count = 0;
    for (size_t n = 0; !sides && n < parts->count; n++)
        count += parts->items[n].label != NULL;
    return sides ? sides->count : count == parts->count ? count : 0;
}

/* Writes a text as the codes of its bytes, and its end. */
static cw_status write_codes(cwi_outfile *file, const char *text, cw_error *err)
{
    cw_status st = CW_OK;
    for (const char *c = text ? text : ""; st == CW_OK; c++) {
        st = cwi_outfile_printf(file, err, *c ? "%d " : "%d\n", (unsigned char)*c);
        if (!*c)
            break;
    }
    return st;
}

static cw_status write_color(cwi_outfile *file, const cw_label *label, cw_error *err)
{
    uint8_t c[4];
    cwi_label_color(label, c);
    return cwi_outfile_printf(file, err, "%d %d %d %d\n", c[0], c[1], c[2], c[3]);
}

/* Writes what is known of the labels, as arrays of the field: numbers, names and colours. */
static cw_status write_labels(const vtp *f, cw_error *err)
{
    enum { NUMBER, NAME, COLOR, KINDS };
    static const char *const names[KINDS] = {"number", "name",
                                             "color\" NumberOfComponents=\"4"};
    const size_t count = count_labels(f->parts);
    const char *types[KINDS] = {width_of_labels(f->parts) == UNSIGNED ? "UInt64" : "Int64",
                                "String", "UInt8"};
    cwi_outfile *file = f->out->file;
    cw_status st = count ? cwi_outfile_printf(file, err, "<FieldData>\n") : CW_OK;
    for (int kind = 0; kind < KINDS && count && st == CW_OK; kind++) {
        st = cwi_outfile_printf(file, err,
                                "<DataArray type=\"%s\" Name=\"label_%s\" "
                                "NumberOfTuples=\"%zu\" format=\"ascii\">\n",
                                types[kind], names[kind], count);
        for (size_t n = 0; n < count && st == CW_OK; n++) {
            const cw_label *label = label_at(f->parts, n);
            char number[CW_LABEL_NUMBER];
            st = kind == NAME ? write_codes(file, label->name, err)
                 : kind == COLOR
                     ? write_color(file, label, err)
                     : cwi_outfile_printf(file, err, "%s\n", cw_label_number(label, number));
        }
        if (st == CW_OK)
            st = cwi_outfile_printf(file, err, "</DataArray>\n");
    }
    return st == CW_OK && count ? cwi_outfile_printf(file, err, "</FieldData>\n") : st;
}

static cw_status write_head(vtp *f, cw_error *err)
{
    const cwi_mesh_output *out = f->out;
    char axes[CWI_AXES_BYTES], origin[CWI_ORIGIN_BYTES];
    cwi_print_axes(out->axes, axes);
    cwi_print_origin(out, "<!-- origin ", " -->\n", origin);
    cw_status st = cwi_outfile_printf(
        out->file, err,
        "<?xml version=\"1.0\"?>\n<!-- cubewright %s, %s -->\n%s"
        "<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" "
        "header_type=\"UInt64\" compressor=\"vtkZLibDataCompressor\">\n<PolyData>\n",
        CW_VERSION, axes, origin);
    if (st == CW_OK)
        st = write_labels(f, err);
    if (st == CW_OK)
        st = cwi_outfile_printf(
            out->file, err,
            "<Piece NumberOfPoints=\"%ju\" NumberOfVerts=\"0\" NumberOfLines=\"0\" "
            "NumberOfStrips=\"0\" NumberOfPolys=\"%ju\">\n<PointData%s%s>\n",
            (uintmax_t)f->parts->vertices, (uintmax_t)f->parts->triangles,
            f->has[0] ? " Normals=\"Normals\"" : "", shown_array(f));
    for (int i = 0; i < ARRAY_COUNT && st == CW_OK; i++) {
        if (i == FIRST_OF_CELLS && has_cell_data(f))
            st = cwi_outfile_printf(out->file, err, "<CellData>\n");
        if (st == CW_OK && f->has[i])
            st = declare_array(f, i, err);
    }
    if (st == CW_OK && has_cell_data(f))
        st = cwi_outfile_printf(out->file, err, "</CellData>\n");
    return st == CW_OK ? cwi_outfile_printf(out->file, err,
                                            "</Piece>\n</PolyData>\n"
                                            "<AppendedData encoding=\"raw\">\n_")
                       : st;
}

/* Writes the bytes of an array; offset: their distance from the underscore. */
static cw_status write_array(vtp *f, int i, uint64_t offset, cw_error *err)
{
    const array *a = &arrays[i];
    char digits[OFFSET_DIGITS + 1];
    const uint64_t count = a->of_triangles ? f->parts->triangles : f->parts->vertices;
    snprintf(digits, sizeof digits, "%0*ju", OFFSET_DIGITS, (uintmax_t)offset);
    cw_status st = cwi_outfile_patch(f->out->file, f->offset_at[i], digits, OFFSET_DIGITS, err);
    if (st == CW_OK)
        st = cwi_block_sink_begin(&f->blocks, count * a->bytes, err);
    if (st == CW_OK && a->of_triangles)
        st = cwi_write_triangles(f->parts, f->out, a->encode, err);
    else if (st == CW_OK)
        st = cwi_write_part_vertices(f->parts, f->out, a->encode, err);
    return st == CW_OK ? cwi_block_sink_end(&f->blocks, err) : st;
}

static cw_status write_arrays(vtp *f, cw_error *err)
{
    const uint64_t start = cwi_outfile_size(f->out->file);
    cw_status st = cwi_block_sink_open(&f->blocks, f->out->file, err);
    f->out->drain = cwi_block_sink_put;
    f->out->drain_to = &f->blocks;
    for (int i = 0; i < ARRAY_COUNT && st == CW_OK; i++)
        if (f->has[i])
            st = write_array(f, i, cwi_outfile_size(f->out->file) - start, err);
    cwi_block_sink_close(&f->blocks);
    return st;
}

static cw_status write_file(const cwi_parts *parts, cwi_mesh_output *out, bool wide,
                            cw_error *err)
{
    vtp f = {.out = out, .parts = parts};
    choose_arrays(&f, wide);
    for (int i = 0; i < ARRAY_COUNT; i++)
        if (f.has[i])
            out->total += (size_t)(arrays[i].of_triangles ? parts->triangles : parts->vertices);
    cw_status st = cwi_check_single(parts, err);
    if (st == CW_OK)
        st = write_head(&f, err);
    if (st == CW_OK)
        st = write_arrays(&f, err);
    return st == CW_OK ? cwi_outfile_printf(out->file, err, "\n</AppendedData>\n</VTKFile>\n")
                       : st;
}

cw_status cwi_vtp_write_wide(const cwi_parts *parts, cwi_mesh_output *out, cw_error *err)
{
    return write_file(parts, out, true, err);
}

cw_status cwi_vtp_write(const cwi_parts *parts, cwi_mesh_output *out, cw_error *err)
{
    const bool wide = 3 * parts->triangles > INT32_MAX || parts->vertices > INT32_MAX;
    return write_file(parts, out, wide, err);
}
