/* Reads OME-TIFF. The first description is a document in XML that assigns pages to the planes
 * of an image, and states the sizes of voxels. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/base/text.h"
#include "formats/text/expat_position.h"
#include "formats/tiff/tiff_file.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MAX_DEPTH = 64, MAX_ELEMENTS = 1 << 20, LONGEST = 64 << 20, CHUNK = 1 << 20 };
static const uint32_t NONE = UINT32_MAX;

typedef enum axis { AXIS_Z, AXIS_C, AXIS_T, AXIS_COUNT } axis;

typedef struct parsing {
    XML_Parser expat;
    const cwi_tiff_file *file;
    cwi_tiff_facts *facts;
    uint32_t *order;
    uint32_t size[AXIS_COUNT]; /* number of pages; C: of pages that hold all their samples */
    axis axes[AXIS_COUNT];     /* the fastest first */
    size_t depth, elements, images;
    uint32_t wanted;    /* number of the image that is read */
    bool is_listing;    /* images are named, and the first page of the wanted one is found */
    uint32_t directory; /* of that; NONE: not stated */
    bool placed;        /* some planes were assigned */
    char name[256];     /* of the file that contains planes; empty: not stated */
    cw_status status;
    cw_error *err;
} parsing;

typedef const XML_Char *const *attributes;

static const char *find_attribute(attributes a, const char *name)
{
    for (; a[0]; a += 2)
        if (strcmp(a[0], name) == 0)
            return a[1];
    return NULL;
}

/* Parses a whole number from 0 on; returns false for anything else. */
static bool parse_whole(attributes a, const char *name, uint32_t otherwise, uint32_t *value)
{
    const char *text = find_attribute(a, name);
    int64_t n;
    *value = otherwise;
    if (!text)
        return true;
    if (!cwi_parse_int(&text, &n) || *text || n < 0 || n > INT32_MAX)
        return false;
    *value = (uint32_t)n;
    return true;
}

/* --- sizes -------------------------------------------------------------------------------- */

static cw_status read_order(parsing *p, const char *text)
{
    static const char letters[] = "ZCT";
    unsigned seen = 0;
    for (int i = 0; text && strlen(text) == 5 && i < AXIS_COUNT; i++) {
        const char *letter = strchr(letters, text[2 + i]);
        p->axes[i] = letter ? (axis)(letter - letters) : AXIS_Z;
        seen |= letter ? 1u << p->axes[i] : 0;
    }
    if (seen == 7 && strncmp(text, "XY", 2) == 0)
        return CW_OK;
    return cwi_fail(p->err, CW_ERR_FORMAT, "'DimensionOrder' of the OME-XML is '%.16s'",
                    text ? text : "");
}

static cw_status read_sizes(parsing *p, attributes a)
{
    const cwi_tiff_facts *f = p->facts;
    uint32_t x, y, z, c, t;
    if (!parse_whole(a, "SizeX", 0, &x) || !parse_whole(a, "SizeY", 0, &y) ||
        !parse_whole(a, "SizeZ", 0, &z) || !parse_whole(a, "SizeC", 0, &c) ||
        !parse_whole(a, "SizeT", 0, &t))
        return cwi_fail(p->err, CW_ERR_FORMAT, "the OME-XML has a size that is not a number");
    if (x != f->columns || y != f->rows)
        return cwi_fail(
            p->err, CW_ERR_FORMAT,
            "'SizeX' and 'SizeY' of the OME-XML are %u x %u; the first page is %u x "
            "%u",
            x, y, f->columns, f->rows);
    if (c % f->samples || z < 1 || c < 1 || t < 1 || z > CWI_TIFF_MAX_PAGES ||
        c > CWI_TIFF_MAX_PAGES || t > CWI_TIFF_MAX_PAGES ||
        (uint64_t)z * (c / f->samples) * t > CWI_TIFF_MAX_PAGES)
        return cwi_fail(
            p->err, CW_ERR_FORMAT,
            "'SizeZ', 'SizeC' and 'SizeT' of the OME-XML are %u, %u and %u, pages of "
            "%u samples; at most %d pages are read",
            z, c, t, f->samples, CWI_TIFF_MAX_PAGES);
    p->facts->slices = p->size[AXIS_Z] = z;
    p->facts->channels = p->size[AXIS_C] = c / f->samples;
    p->facts->steps = p->size[AXIS_T] = t;
    return CW_OK;
}

static cw_status read_length(parsing *p, attributes a, int n)
{
    static const char *const names[3][2] = {{"PhysicalSizeX", "PhysicalSizeXUnit"},
                                            {"PhysicalSizeY", "PhysicalSizeYUnit"},
                                            {"PhysicalSizeZ", "PhysicalSizeZUnit"}};
    const char *text = find_attribute(a, names[n][0]), *unit = find_attribute(a, names[n][1]);
    double value;
    if (!text)
        return CW_OK;
    const char *at = text;
    if (!cwi_parse_double(&at, &value) || *at || !(value > 0))
        return cwi_fail(p->err, CW_ERR_FORMAT, "'%s' of the OME-XML is '%.32s'", names[n][0],
                        text);
    p->facts->spacing[n] = value;
    cwi_tiff_set_unit(p->facts, n, unit ? unit : "um", unit ? strlen(unit) : 2);
    return CW_OK;
}

static cw_status read_pixels(parsing *p, attributes a)
{
    const char *step = find_attribute(a, "TimeIncrement"),
               *unit = find_attribute(a, "TimeIncrementUnit");
    double value;
    cw_status st = read_order(p, find_attribute(a, "DimensionOrder"));
    if (st == CW_OK)
        st = read_sizes(p, a);
    for (int n = 0; st == CW_OK && n < 3; n++)
        st = read_length(p, a, n);
    if (st == CW_OK && step && cwi_parse_double(&step, &value) && value > 0)
        p->facts->step_seconds = value * (unit ? cwi_tiff_time(unit, strlen(unit)) : 1);
    for (size_t i = 0; st == CW_OK && i < CWI_TIFF_MAX_PAGES; i++)
        p->order[i] = NONE;
    return st;
}

/* --- planes ------------------------------------------------------------------------------- */

static uint32_t plane_count(const parsing *p)
{
    return p->size[AXIS_Z] * p->size[AXIS_C] * p->size[AXIS_T];
}

static int compare_places(const void *a, const void *b)
{
    const uint32_t x = *(const uint32_t *)a, y = ((const cwi_tiff_page *)b)->directory;
    return (x > y) - (x < y);
}

static const cwi_tiff_page *find_page(const cwi_tiff_file *f, uint32_t directory)
{
    return bsearch(&directory, f->pages, f->page_count, sizeof *f->pages, compare_places);
}

static cw_status place_page(parsing *p, uint32_t directory, const uint32_t at[AXIS_COUNT])
{
    const cwi_tiff_file *f = p->file;
    const cwi_tiff_page *page = find_page(f, directory);
    if (!page)
        return cwi_fail(
            p->err, CW_ERR_FORMAT,
            "the OME-XML has a plane in directory %u; of the file's %u there is none "
            "such of full resolution",
            directory + 1, f->offset_count);
    uint32_t *to =
        &p->order[(at[AXIS_T] * p->size[AXIS_C] + at[AXIS_C]) * p->size[AXIS_Z] + at[AXIS_Z]];
    if (*to != NONE)
        return cwi_fail(p->err, CW_ERR_FORMAT,
                        "the OME-XML has two pages for slice %u, channel %u, step %u",
                        at[AXIS_Z], at[AXIS_C], at[AXIS_T]);
    *to = (uint32_t)(page - f->pages);
    return CW_OK;
}

/* Assigns directories from one on to planes from one on. */
static cw_status place_all(parsing *p, uint32_t directory, uint32_t at[AXIS_COUNT],
                           uint32_t count)
{
    cw_status st = CW_OK;
    p->placed = true;
    for (uint32_t i = 0; st == CW_OK && i < count; i++) {
        if (at[AXIS_Z] >= p->size[AXIS_Z] || at[AXIS_C] >= p->size[AXIS_C] ||
            at[AXIS_T] >= p->size[AXIS_T])
            return cwi_fail(p->err, CW_ERR_FORMAT,
                            "the OME-XML has a plane for slice %u, channel %u, step %u, and "
                            "sizes of %u, %u, %u",
                            at[AXIS_Z], at[AXIS_C], at[AXIS_T], p->size[AXIS_Z],
                            p->size[AXIS_C], p->size[AXIS_T]);
        st = place_page(p, directory + i, at);
        for (int n = 0; n < AXIS_COUNT && ++at[p->axes[n]] == p->size[p->axes[n]]; n++)
            if (n < AXIS_COUNT - 1)
                at[p->axes[n]] = 0;
    }
    return st;
}

static cw_status read_data(parsing *p, attributes a)
{
    uint32_t directory, count, at[AXIS_COUNT];
    const uint32_t usual = find_attribute(a, "IFD") ? 1 : plane_count(p);
    if (!parse_whole(a, "IFD", 0, &directory) || !parse_whole(a, "PlaneCount", usual, &count) ||
        !parse_whole(a, "FirstZ", 0, &at[AXIS_Z]) ||
        !parse_whole(a, "FirstC", 0, &at[AXIS_C]) || !parse_whole(a, "FirstT", 0, &at[AXIS_T]))
        return cwi_fail(p->err, CW_ERR_FORMAT, "a 'TiffData' of the OME-XML has no numbers");
    at[AXIS_C] /= p->facts->samples;
    return place_all(p, directory, at, count);
}

static cw_status read_name(parsing *p, attributes a)
{
    const char *name = find_attribute(a, "FileName");
    if (!name)
        return CW_OK;
    if (!p->name[0])
        snprintf(p->name, sizeof p->name, "%s", name);
    if (strncmp(p->name, name, sizeof p->name - 1) == 0)
        return CW_OK;
    return cwi_fail(
        p->err, CW_ERR_FORMAT,
        "the OME-XML spreads its planes over several files; only those are read that "
        "hold all of theirs");
}

/* --- elements ----------------------------------------------------------------------------- */

static cw_status fail_elsewhere(parsing *p)
{
    return cwi_fail(p->err, CW_ERR_FORMAT, "the OME-XML is in another file ('BinaryOnly')");
}

/* Returns true if a name is among those of the images so far. */
static bool is_named(const cwi_tiff_facts *facts, const char *name)
{
    const size_t length = strlen(name);
    for (const char *line = facts->names; *line; line = cwi_tiff_next_line(line))
        if (strncmp(line, name, length) == 0 && line[length] == '\n')
            return true;
    return false;
}

/* Keeps the name of an image, else its number from 1 on. */
static void add_image(parsing *p, attributes a)
{
    const char *name = find_attribute(a, "Name");
    const size_t used = strlen(p->facts->names), left = sizeof p->facts->names - used;
    char number[32];
    snprintf(number, sizeof number, "image %zu", p->images);
    if (!name || !*name || strchr(name, '\n') || is_named(p->facts, name))
        name = number;
    if (strlen(name) + 2 < left)
        snprintf(p->facts->names + used, left, "%s\n", name);
    p->facts->image_count++;
}

/* Keeps the place of the first page of the wanted image. */
static cw_status list_element(parsing *p, const char *name, attributes a)
{
    if (strcmp(name, "Image") == 0)
        add_image(p, a);
    if (strcmp(name, "TiffData") == 0 && p->images == p->wanted + 1 && p->directory == NONE &&
        !parse_whole(a, "IFD", 0, &p->directory))
        p->directory = NONE; /* told when it is read */
    return CW_OK;
}

static cw_status open_element(parsing *p, const char *name, attributes a)
{
    const bool inside = p->size[AXIS_Z] > 0;
    if (strcmp(name, "BinaryOnly") == 0)
        return fail_elsewhere(p);
    if (strcmp(name, "Image") == 0)
        p->images++;
    if (p->is_listing)
        return list_element(p, name, a);
    if (p->images > 0 && p->images != p->wanted + 1)
        return CW_OK;
    if (strcmp(name, "Pixels") == 0 && !inside)
        return read_pixels(p, a);
    if (strcmp(name, "TiffData") == 0 && inside)
        return read_data(p, a);
    return strcmp(name, "UUID") == 0 && inside ? read_name(p, a) : CW_OK;
}

static void stop_parsing(parsing *p, cw_status status)
{
    p->status = status;
    XML_StopParser(p->expat, XML_FALSE);
}

static void XMLCALL on_start(void *user, const XML_Char *name, const XML_Char **a)
{
    parsing *p = user;
    const char *colon = strrchr(name, ':');
    cw_status st = CW_OK;
    if (p->depth++ == MAX_DEPTH || p->elements++ == MAX_ELEMENTS)
        st = cwi_fail(p->err, CW_ERR_FORMAT,
                      "the OME-XML has more than %d elements, or %d inside each other",
                      MAX_ELEMENTS, MAX_DEPTH);
    else
        st = open_element(p, colon ? colon + 1 : name, (attributes)a);
    if (st != CW_OK)
        stop_parsing(p, st);
}

static void XMLCALL on_end(void *user, const XML_Char *name)
{
    parsing *p = user;
    (void)name;
    p->depth--;
}

static void XMLCALL on_doctype(void *user, const XML_Char *name, const XML_Char *system,
                               const XML_Char *public_id, int internal)
{
    parsing *p = user;
    (void)name, (void)system, (void)public_id, (void)internal;
    stop_parsing(p, cwi_fail(p->err, CW_ERR_UNSAFE,
                             "the OME-XML has a document type (<!DOCTYPE>); none is read"));
}

/* --- the document ------------------------------------------------------------------------- */

static void *give_memory(size_t size)
{
    return cwi_alloc_array(size, 1);
}

static void *resize_memory(void *memory, size_t size)
{
    return cwi_realloc_array(memory, size, 1);
}

static cw_status fail_xml(const parsing *p)
{
    const enum XML_Error code = XML_GetErrorCode(p->expat);
    if (p->status != CW_OK)
        return p->status;
    if (code == XML_ERROR_NO_MEMORY)
        return cwi_fail_memory(p->err);
    return cwi_fail(p->err, CW_ERR_FORMAT, "line %lu of the OME-XML is not XML: %s",
                    (unsigned long)XML_GetCurrentLineNumber64(p->expat), XML_ErrorString(code));
}

/* Checks that every plane has its page. */
static cw_status finish_parsing(parsing *p)
{
    uint32_t first[AXIS_COUNT] = {0, 0, 0};
    cw_status st = CW_OK;
    if (p->size[AXIS_Z] == 0)
        return cwi_fail(p->err, CW_ERR_FORMAT, "the OME-XML describes no image");
    if (!p->placed)
        st = place_all(p, 0, first, plane_count(p));
    for (uint32_t i = 0; st == CW_OK && i < plane_count(p); i++)
        if (p->order[i] == NONE)
            st = cwi_fail(p->err, CW_ERR_FORMAT,
                          "the OME-XML names no page for slice %u, channel %u, step %u",
                          i % p->size[AXIS_Z], i / p->size[AXIS_Z] % p->size[AXIS_C],
                          i / p->size[AXIS_Z] / p->size[AXIS_C]);
    if (st == CW_OK && plane_count(p) < p->file->page_count && p->facts->image_count < 2)
        cwi_tiff_note(p->facts, "left out, as the OME-XML has no place for them: %u pages",
                      p->file->page_count - plane_count(p));
    return st;
}

/* Takes the sizes of the first page of the image for those of all. */
static cw_status take_first_page(const parsing *p)
{
    const cwi_tiff_page *page = find_page(p->file, p->directory == NONE ? 0 : p->directory);
    if (p->wanted >= p->facts->image_count && p->wanted > 0)
        return cwi_fail(p->err, CW_ERR_FORMAT, "the OME-XML describes %u images",
                        p->facts->image_count);
    if (!page || !page->good)
        return CW_OK; /* told when the page is placed or read */
    p->facts->columns = page->columns;
    p->facts->rows = page->rows;
    p->facts->samples = page->samples;
    return CW_OK;
}

static cw_status parse_document(parsing *p, const char *xml)
{
    const XML_Memory_Handling_Suite memory = {give_memory, resize_memory, cwi_free};
    const size_t size = strlen(xml);
    cw_status st = CW_OK;
    p->depth = p->elements = p->images = 0;
    p->expat = XML_ParserCreate_MM(NULL, &memory, NULL);
    if (!p->expat)
        return cwi_fail_memory(p->err);
    XML_SetUserData(p->expat, p);
    XML_SetElementHandler(p->expat, on_start, on_end);
    XML_SetStartDoctypeDeclHandler(p->expat, on_doctype);
    for (size_t at = 0, n; st == CW_OK && at < size; at += n) {
        n = size - at < CHUNK ? size - at : CHUNK;
        if (XML_Parse(p->expat, xml + at, (int)n, at + n == size) != XML_STATUS_OK)
            st = fail_xml(p);
    }
    XML_ParserFree(p->expat);
    return st;
}

/* Reads the document twice: the first time for the page that the image starts with. */
cw_status cwi_tiff_ome(const cwi_tiff_file *f, const char *xml, uint32_t image,
                       cwi_tiff_facts *facts, uint32_t *order, cw_error *err)
{
    const size_t size = strlen(xml);
    parsing p = {.file = f,
                 .facts = facts,
                 .order = order,
                 .wanted = image,
                 .is_listing = true,
                 .directory = NONE,
                 .err = err};
    if (size > LONGEST)
        return cwi_fail(err, CW_ERR_FORMAT, "the OME-XML has %zu bytes; the most are %d", size,
                        LONGEST);
    p.err = NULL; /* the second pass reports errors */
    const bool is_listed = parse_document(&p, xml) == CW_OK;
    p.err = err;
    p.status = CW_OK;
    p.is_listing = false;
    cw_status st = is_listed ? take_first_page(&p) : CW_OK;
    if (st == CW_OK)
        st = parse_document(&p, xml);
    return st == CW_OK ? finish_parsing(&p) : st;
}
