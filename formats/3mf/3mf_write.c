/* Writes 3MF: a zip archive with one model in XML. Each part becomes an object, placed by its
 * build item; vertex colours use the materials extension, which slicers read. */

#include "core/base/memory.h"
#include "core/base/status.h"
#include "formats/3mf/3mf_format.h"
#include "formats/bytes/zip_write.h"
#include "formats/text/xml.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

static const char content_types[] =
    "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
    "<Types xmlns=\"http://schemas.openxmlformats.org/package/2006/content-types\">\n"
    "<Default Extension=\"rels\" "
    "ContentType=\"application/vnd.openxmlformats-package.relationships+xml\"/>\n"
    "<Default Extension=\"model\" "
    "ContentType=\"application/vnd.ms-package.3dmanufacturing-3dmodel+xml\"/>\n"
    "</Types>\n";

static const char relationships[] =
    "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
    "<Relationships xmlns=\"http://schemas.openxmlformats.org/package/2006/relationships\">\n"
    "<Relationship Target=\"/3D/3dmodel.model\" Id=\"rel0\" "
    "Type=\"http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel\"/>\n"
    "</Relationships>\n";

/* The format's names of units. */
static const char *const units[CW_UNIT_COUNT] = {
    [CW_UNIT_MM] = "millimeter", [CW_UNIT_UM] = "micron", [CW_UNIT_CM] = "centimeter",
    [CW_UNIT_M] = "meter",       [CW_UNIT_IN] = "inch",   [CW_UNIT_FT] = "foot"};

typedef struct model {
    cwi_mesh_output *out;
    cwi_zip zip;
} model;

CW_PRINTF(3, 4)
static cw_status print_model(model *m, cw_error *err, const char *format, ...)
{
    char text[CWI_XML_BYTES(CWI_NAME_BYTES) + 1024];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    return cwi_zip_put(&m->zip, text, strlen(text), err);
}

/* --- colours ----------------------------------------------------------------------------- */

static uint32_t pack_color(const uint8_t c[4])
{
    return (uint32_t)c[0] << 24 | (uint32_t)c[1] << 16 | (uint32_t)c[2] << 8 | c[3];
}

static int compare_colors(const void *a, const void *b)
{
    const uint32_t *x = a, *y = b;
    return (*x > *y) - (*x < *y);
}

/* Lists the existing colours, each once and in order. bytes: 4 of each element */
static size_t list_colors(const uint8_t *bytes, size_t elements, uint32_t *colors)
{
    size_t count = 0;
    for (size_t i = 0; i < elements; i++)
        colors[i] = pack_color(bytes + 4 * i);
    qsort(colors, elements, sizeof *colors, compare_colors);
    for (size_t i = 0; i < elements; i++)
        if (count == 0 || colors[count - 1] != colors[i])
            colors[count++] = colors[i];
    return count;
}

static cw_status write_group(model *m, size_t id, const uint32_t *colors, size_t count,
                             cw_error *err)
{
    cw_status st = print_model(m, err, "<m:colorgroup id=\"%zu\">\n", id);
    for (size_t i = 0; i < count && st == CW_OK; i++)
        st = print_model(m, err, "<m:color color=\"#%08X\"/>\n", colors[i]);
    return st == CW_OK ? print_model(m, err, "</m:colorgroup>\n") : st;
}

/* Writes the group of the colours of a part's elements, and numbers these by them. */
static cw_status write_colors(model *m, const uint8_t *bytes, size_t elements, size_t id,
                              uint32_t *numbers, cw_error *err)
{
    uint32_t *colors = cwi_alloc_array(elements, sizeof *colors);
    if (!colors)
        return cwi_fail_memory(err);
    const size_t count = list_colors(bytes, elements, colors);
    for (size_t i = 0; i < elements; i++) {
        const uint32_t color = pack_color(bytes + 4 * i);
        const uint32_t *at = bsearch(&color, colors, count, sizeof color, compare_colors);
        numbers[i] = (uint32_t)(at - colors);
    }
    cw_status st = write_group(m, id, colors, count, err);
    cwi_free(colors);
    return st;
}

/* --- objects ----------------------------------------------------------------------------- */

static unsigned char *encode_vertex(const cwi_part *part, size_t v, unsigned char *to)
{
    static const char *const before[3] = {"<vertex x=\"", "\" y=\"", "\" z=\""};
    for (int a = 0; a < 3; a++)
        to = cwi_put_decimal(cwi_put_text(to, before[a]), cwi_file_coordinate(part, v, a), 9);
    return cwi_put_text(to, "\"/>\n");
}

/* Encodes a triangle. The format requires three vertices, so triangles that name one twice,
 * which have no area, are left out. */
static unsigned char *encode_triangle(const cwi_part *part, size_t t, unsigned char *to)
{
    static const char *const vertices[3] = {"<triangle v1=\"", "\" v2=\"", "\" v3=\""};
    static const char *const colors[3] = {"\" p1=\"", "\" p2=\"", "\" p3=\""};
    const uint32_t *v = part->mesh.triangles + 3 * t;
    if (v[0] == v[1] || v[1] == v[2] || v[2] == v[0])
        return to;
    for (int c = 0; c < 3; c++)
        to = cwi_put_integer(cwi_put_text(to, vertices[c]), v[c]);
    if (part->numbers)
        to = cwi_put_integer(cwi_put_text(to, "\" pid=\""), part->group);
    for (int c = 0; c < (part->face_colors ? 1 : 3) && part->numbers; c++)
        to = cwi_put_integer(cwi_put_text(to, colors[c]),
                             part->numbers[part->face_colors ? t : v[c]]);
    return cwi_put_text(to, "\"/>\n");
}

static cw_status write_mesh(model *m, const cwi_part *part, cw_error *err)
{
    cw_status st = print_model(m, err, "<mesh>\n<vertices>\n");
    if (st == CW_OK)
        st = cwi_write_records(part, CWI_VERTICES, m->out, encode_vertex, err);
    if (st == CW_OK)
        st = print_model(m, err, "</vertices>\n<triangles>\n");
    if (st == CW_OK)
        st = cwi_write_records(part, CWI_TRIANGLES, m->out, encode_triangle, err);
    return st == CW_OK ? print_model(m, err, "</triangles>\n</mesh>\n</object>\n") : st;
}

/* Returns the object's number. Every part has two numbers: for its colours and for itself. */
static size_t object_id(size_t part)
{
    return 2 * part + 2;
}

/* Writes the group of the one colour that a part has. */
static cw_status write_one_color(model *m, const cwi_part *part, size_t id, cw_error *err)
{
    const uint32_t color = pack_color(part->color);
    return write_group(m, id, &color, 1, err);
}

/* Writes an object. Vertices stay where they are: the build item holds the origin. An object
 * whose triangles or vertices have colours must name one for itself, too. */
static cw_status write_object(model *m, const cwi_part *given, size_t id, cw_error *err)
{
    char name[CWI_XML_BYTES(CWI_NAME_BYTES)], group[64] = "";
    cwi_part part = *given;
    uint32_t *numbers = NULL;
    cw_status st = CW_OK;
    memset(part.mesh.origin, 0, sizeof part.mesh.origin);
    const uint8_t *colors = part.face_colors ? part.face_colors : part.mesh.colors;
    const size_t count = part.face_colors ? part.mesh.triangle_count : part.mesh.vertex_count;
    if (colors || part.has_color)
        snprintf(group, sizeof group, " pid=\"%zu\" pindex=\"0\"", id - 1);
    if (!colors && part.has_color)
        st = write_one_color(m, &part, id - 1, err);
    if (colors) {
        part.group = id - 1;
        part.numbers = numbers = cwi_alloc_array(count, sizeof *numbers);
        st = numbers ? write_colors(m, colors, count, id - 1, numbers, err)
                     : cwi_fail_memory(err);
    }
    cwi_xml_escape(part.name, name, sizeof name);
    if (st == CW_OK)
        st = print_model(m, err, "<object id=\"%zu\" type=\"model\" name=\"%s\"%s>\n", id, name,
                         group);
    if (st == CW_OK)
        st = write_mesh(m, &part, err);
    cwi_free(numbers);
    return st;
}

/* --- the model --------------------------------------------------------------------------- */

/* Writes the place of the part. In a local file all parts count from the same origin, which is
 * stated and not applied. */
static cw_status write_item(model *m, const cwi_part *part, size_t id, cw_error *err)
{
    double origin[3];
    char translation[CWI_POINT_BYTES], transform[CWI_POINT_BYTES + 64] = "";
    cwi_turn_point(&part->turn, part->mesh.origin, origin);
    if (origin[0] != 0 || origin[1] != 0 || origin[2] != 0) {
        cwi_print_point(origin, translation);
        snprintf(transform, sizeof transform, " transform=\"1 0 0 0 1 0 0 0 1 %s\"",
                 translation);
    }
    return print_model(m, err, "<item objectid=\"%zu\"%s/>\n", id, transform);
}

/* Writes the head. Metadata for cubewright's reader have a prefix, as the format requires for
 * such names. */
static cw_status write_head(model *m, cw_error *err)
{
    const cw_axes *axes = m->out->axes;
    char title[CWI_XML_BYTES(CWI_NAME_BYTES)], origin[CWI_ORIGIN_BYTES];
    cwi_xml_escape(m->out->name, title, sizeof title);
    cw_status st = print_model(
        m, err,
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<model unit=\"%s\" xml:lang=\"en-US\" "
        "xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\" "
        "xmlns:m=\"http://schemas.microsoft.com/3dmanufacturing/material/2015/02\" "
        "xmlns:cw=\"urn:cubewright\">\n"
        "<metadata name=\"Title\">%s</metadata>\n"
        "<metadata name=\"Application\">cubewright %s</metadata>\n"
        "<metadata name=\"cw:frame\">%s</metadata>\n",
        units[axes->unit], title, CW_VERSION, axes->ras ? "RAS" : "LPS");
    if (st == CW_OK && axes->y_up)
        st = print_model(m, err, "<metadata name=\"cw:up\">Y</metadata>\n");
    cwi_print_origin(m->out, "<metadata name=\"cw:origin\">", "</metadata>\n", origin);
    if (st == CW_OK)
        st = print_model(m, err, "%s<resources>\n", origin);
    return st;
}

static cw_status write_model(model *m, const cwi_parts *parts, cw_error *err)
{
    cw_status st = write_head(m, err);
    for (size_t i = 0; i < parts->count && st == CW_OK; i++)
        st = write_object(m, &parts->items[i], object_id(i), err);
    if (st == CW_OK)
        st = print_model(m, err, "</resources>\n<build>\n");
    for (size_t i = 0; i < parts->count && st == CW_OK; i++)
        st = write_item(m, &parts->items[i], object_id(i), err);
    return st == CW_OK ? print_model(m, err, "</build>\n</model>\n") : st;
}

/* Returns true if the model may reach 4 GiB, by upper bounds for vertices, colours and
 * triangles. That must be known before the model is written. */
static bool is_huge(const cwi_parts *parts)
{
    const uint64_t vertex = 120, triangle = 140, object = 2 * CWI_XML_BYTES(CWI_NAME_BYTES);
    return parts->vertices * vertex + parts->triangles * triangle + parts->count * object >=
           UINT32_MAX;
}

static cw_status check_numbers(const cwi_parts *parts, cw_error *err)
{
    for (size_t i = 0; i < parts->count; i++)
        if (parts->items[i].mesh.vertex_count > INT32_MAX)
            return cwi_fail(err, CW_ERR_LIMIT,
                            "3MF counts at most %d vertices in an object; '%s' has %zu",
                            INT32_MAX, parts->items[i].name, parts->items[i].mesh.vertex_count);
    return CW_OK;
}

cw_status cwi_3mf_write(const cwi_parts *parts, cwi_mesh_output *out, cw_error *err)
{
    model m = {.out = out, .zip = {.file = out->file}};
    out->drain = cwi_zip_put;
    out->drain_to = &m.zip;
    out->total = (size_t)(parts->vertices + parts->triangles);
    cw_status st = check_numbers(parts, err);
    if (st == CW_OK)
        st = cwi_zip_text(&m.zip, "[Content_Types].xml", content_types, err);
    if (st == CW_OK)
        st = cwi_zip_text(&m.zip, "_rels/.rels", relationships, err);
    if (st == CW_OK)
        st = cwi_zip_begin(&m.zip, "3D/3dmodel.model", is_huge(parts), err);
    if (st == CW_OK)
        st = write_model(&m, parts, err);
    if (st == CW_OK)
        st = cwi_zip_end(&m.zip, err);
    if (st == CW_OK)
        st = cwi_zip_finish(&m.zip, err);
    cwi_zip_close(&m.zip);
    return st;
}
