/* VTK's XML image data (.vti). Expat reads the elements, as a stream: the text of arrays only
 * passes through it, and it stops where appended data start, which need be no XML at all. */
#include "core/memory.h"
#include "core/status.h"
#include "formats/readers.h"
#include "formats/vti.h"

#include <ctype.h>
#include <expat.h>
#include <string.h>

enum { CHUNK = 1 << 16, MOST_DEPTH = 64, MOST_ELEMENTS = 10000, LONGEST_TAG = 1 << 20 };

/* The first element is VTKFile: of image data or of something else, which is then refused. */
bool cwi_vti_sniff(const unsigned char *head, size_t size)
{
    static const char tag[] = "<VTKFile";
    for (size_t i = 0; i + sizeof tag - 1 <= size; i++)
        if (memcmp(head + i, tag, sizeof tag - 1) == 0)
            return true;
    return false;
}

/* --- elements ---------------------------------------------------------------------------- */

typedef enum element {
    E_FILE,
    E_IMAGE,
    E_PIECE,
    E_POINT_DATA,
    E_CELL_DATA,
    E_ARRAY,
    E_APPENDED,
    ELEMENT_COUNT,
    E_OTHER = ELEMENT_COUNT
} element;

/* Where each must stand, and what its attributes do. */
static const struct {
    const char *name;
    element parent;
    cw_status (*read)(cwi_vti *v, cwi_attributes a, cw_error *err);
} elements[ELEMENT_COUNT] = {
    [E_FILE] = {"VTKFile", E_OTHER, cwi_vti_file},
    [E_IMAGE] = {"ImageData", E_FILE, cwi_vti_image},
    [E_PIECE] = {"Piece", E_IMAGE, cwi_vti_piece},
    [E_POINT_DATA] = {"PointData", E_PIECE, cwi_vti_point_data},
    [E_CELL_DATA] = {"CellData", E_PIECE, NULL},
    [E_ARRAY] = {"DataArray", E_POINT_DATA, NULL},
    [E_APPENDED] = {"AppendedData", E_FILE, cwi_vti_appended},
};

typedef struct parsing {
    XML_Parser expat;
    cwi_vti *vti;
    element path[MOST_DEPTH];
    size_t depth, count;
    bool in_array; /* the best one: the next tag ends its text */
    cw_status status;
    cw_error *err;
} parsing;

static void stop(parsing *p, cw_status status)
{
    p->status = status;
    XML_StopParser(p->expat, XML_FALSE);
}

static void end_text(parsing *p)
{
    if (p->in_array)
        p->vti->best.end = (uint64_t)XML_GetCurrentByteIndex(p->expat);
    p->in_array = false;
}

static element find_element(const parsing *p, const char *name)
{
    const element parent = p->depth ? p->path[p->depth - 1] : E_OTHER;
    for (element e = 0; e < ELEMENT_COUNT; e++)
        if (strcmp(elements[e].name, name) == 0 && elements[e].parent == parent &&
            (p->depth > 0) == (e != E_FILE))
            return e;
    return E_OTHER;
}

static cw_status open_element(parsing *p, element e, cwi_attributes a)
{
    const uint64_t behind =
        (uint64_t)(XML_GetCurrentByteIndex(p->expat) + XML_GetCurrentByteCount(p->expat));
    cw_status st = CW_OK;
    if (p->depth == 0 && e != E_FILE)
        return cw_fail(p->err, CW_ERR_FORMAT, "the first element is not VTKFile");
    if (e == E_ARRAY) {
        st = cwi_vti_data_array(p->vti, a, &p->in_array, p->err);
        if (p->in_array)
            p->vti->best.start = behind;
    } else if (e != E_OTHER && elements[e].read) {
        st = elements[e].read(p->vti, a, p->err);
    }
    p->vti->cell_arrays += e == E_OTHER && p->depth && p->path[p->depth - 1] == E_CELL_DATA;
    if (e == E_APPENDED)
        p->vti->appended = behind;
    return st;
}

static void XMLCALL on_start(void *user, const XML_Char *name, const XML_Char **attributes)
{
    parsing *p = user;
    const element e = find_element(p, name);
    end_text(p);
    cw_status st = CW_OK;
    if (p->depth == MOST_DEPTH || p->count++ == MOST_ELEMENTS)
        st = cw_fail(p->err, CW_ERR_FORMAT, "more than %d elements, or %d inside each other",
                     MOST_ELEMENTS, MOST_DEPTH);
    else
        st = open_element(p, e, (cwi_attributes)attributes);
    if (st == CW_OK)
        p->path[p->depth++] = e;
    if (st != CW_OK || e == E_APPENDED)
        stop(p, st);
}

static void XMLCALL on_end(void *user, const XML_Char *name)
{
    parsing *p = user;
    (void)name;
    end_text(p);
    p->depth -= p->depth > 0;
}

static void XMLCALL on_doctype(void *user, const XML_Char *name, const XML_Char *system,
                               const XML_Char *public_id, int internal)
{
    parsing *p = user;
    (void)name, (void)system, (void)public_id, (void)internal;
    stop(p, cw_fail(p->err, CW_ERR_UNSAFE,
                    "the file has a document type (<!DOCTYPE>); VTK files have none, and none "
                    "is read"));
}

/* --- the walk through the file ----------------------------------------------------------- */

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
        return cw_fail(p->err, CW_ERR_NO_MEMORY, "no memory to read XML with");
    return cw_fail(p->err, CW_ERR_FORMAT, "line %lu is no XML: %s",
                   (unsigned long)XML_GetCurrentLineNumber(p->expat), XML_ErrorString(code));
}

/* Feeds the file to expat until it ends or appended data start. Expat keeps a tag until it is
 * whole: so its length has a limit. */
static cw_status walk(parsing *p, const cwi_input *in)
{
    uint64_t fed = 0;
    cw_status st = CW_OK;
    for (bool last = false; st == CW_OK && !last && !p->vti->has_appended;) {
        size_t got = 0;
        void *buffer = XML_GetBuffer(p->expat, CHUNK);
        if (!buffer)
            return fail_xml(p);
        st = cwi_input_read_at(in->fd, fed, buffer, CHUNK, &got, p->err);
        last = got < CHUNK;
        fed += got;
        if (st == CW_OK && XML_ParseBuffer(p->expat, (int)got, last) != XML_STATUS_OK &&
            (p->status != CW_OK || !p->vti->has_appended))
            st = fail_xml(p);
        const XML_Index at = XML_GetCurrentByteIndex(p->expat);
        if (st == CW_OK && at >= 0 && fed - (uint64_t)at > LONGEST_TAG)
            st = cw_fail(p->err, CW_ERR_FORMAT, "line %lu has a tag longer than 1 MiB",
                         (unsigned long)XML_GetCurrentLineNumber(p->expat));
    }
    return st;
}

static cw_status read_elements(const cwi_input *in, cwi_vti *v, cw_error *err)
{
    const XML_Memory_Handling_Suite memory = {give_memory, resize_memory, cwi_free};
    parsing p = {.vti = v, .err = err, .expat = XML_ParserCreate_MM("UTF-8", &memory, NULL)};
    if (!p.expat)
        return cw_fail(err, CW_ERR_NO_MEMORY, "no memory to read XML with");
    XML_SetUserData(p.expat, &p);
    XML_SetElementHandler(p.expat, on_start, on_end);
    XML_SetStartDoctypeDeclHandler(p.expat, on_doctype);
    cw_status st = walk(&p, in);
    XML_ParserFree(p.expat);
    return st;
}

/* --- appended data ----------------------------------------------------------------------- */

/* Behind them the file must go on to its last tag: expat has not seen whether it does. */
static cw_status check_end(const cwi_input *in, cw_error *err)
{
    static const char tag[] = "</VTKFile>";
    char text[256];
    const size_t length = sizeof tag - 1;
    const uint64_t start = in->size > sizeof text ? in->size - sizeof text : 0;
    size_t size;
    cw_status st = cwi_input_read_at(in->fd, start, text, sizeof text, &size, err);
    while (size > 0 && isspace((unsigned char)text[size - 1]))
        size--;
    if (st != CW_OK || (size >= length && memcmp(text + size - length, tag, length) == 0))
        return st;
    return cw_fail(err, CW_ERR_FORMAT, "the file does not end with %s: it is cut off", tag);
}

/* They start with an underscore. */
static cw_status find_appended(const cwi_input *in, cwi_vti *v, cw_error *err)
{
    char text[256];
    size_t size = 0, i = 0;
    if (!v->has_appended)
        return CW_OK;
    cw_status st = cwi_input_read_at(in->fd, v->appended, text, sizeof text, &size, err);
    while (i < size && isspace((unsigned char)text[i]))
        i++;
    if (st == CW_OK && (i == size || text[i] != '_'))
        return cw_fail(err, CW_ERR_FORMAT, "the appended data do not start with '_'");
    v->appended += i + 1;
    return st == CW_OK ? check_end(in, err) : st;
}

/* --- to a source ------------------------------------------------------------------------- */

static cw_status check_found(const cwi_vti *v, cw_error *err)
{
    const cwi_vti_array *best = &v->best;
    if (best->rank == CWI_VTI_NONE && v->cell_arrays && !*v->others)
        return cw_fail(err, CW_ERR_FORMAT,
                       "the arrays are CellData; only values at points (PointData) are read");
    if (best->rank == CWI_VTI_NONE)
        return cw_fail(err, CW_ERR_FORMAT, "PointData holds no array that is read%s%s",
                       *v->others ? "; there are " : "", v->others);
    if (best->form == CWI_VTI_APPENDED && !v->has_appended)
        return cw_fail(err, CW_ERR_FORMAT,
                       "the array '%s' is appended; AppendedData is missing", best->name);
    if (best->form != CWI_VTI_ASCII && !v->has_order)
        return cw_fail(err, CW_ERR_FORMAT, "'byte_order' is missing; the array '%s' needs it",
                       best->name);
    return CW_OK;
}

static cw_status set_sizes(const cwi_vti *v, cwi_source *src, cw_error *err)
{
    cwi_axis axes[] = {{CWI_AXIS_COMPONENT, v->best.components},
                       {CWI_AXIS_X, 0},
                       {CWI_AXIS_Y, 0},
                       {CWI_AXIS_Z, 0}};
    for (int a = 0; a < 3; a++)
        axes[1 + a].size = (size_t)(v->extent[2 * a + 1] - v->extent[2 * a] + 1);
    src->shape.type = v->best.type;
    src->shape.slope = 1;
    return cwi_source_set_axes(src, axes, 4, err);
}

/* World = Origin + Direction (Spacing * index), the index counted from the extent's. */
static void set_frame(const cwi_vti *v, cw_volume *shape)
{
    for (int r = 0; r < 3; r++)
        shape->affine[r][3] = v->origin[r];
    for (int c = 0; c < 3; c++) {
        const double spacing = shape->dim[c] == 1 && v->spacing[c] == 0 ? 1 : v->spacing[c];
        for (int r = 0; r < 3; r++) {
            shape->affine[r][c] = v->direction[3 * r + c] * spacing;
            shape->affine[r][3] += shape->affine[r][c] * (double)v->extent[2 * c];
        }
    }
}

static void set_place(const cwi_vti *v, cwi_source *src)
{
    static const cwi_codec codecs[] = {
        [CWI_VTI_ZLIB] = CWI_CODEC_ZLIB, [CWI_VTI_LZ4] = CWI_CODEC_LZ4};
    const cwi_vti_array *a = &v->best;
    src->offset = a->start;
    src->span = a->end - a->start;
    src->big_endian = v->big_endian;
    src->base64 = a->form == CWI_VTI_BINARY || (a->form == CWI_VTI_APPENDED && v->base64);
    if (a->form == CWI_VTI_APPENDED) {
        src->span = 0;
        if (__builtin_add_overflow(v->appended, a->offset, &src->offset))
            src->offset = UINT64_MAX;
    }
    if (a->form == CWI_VTI_ASCII) {
        src->encoding = CWI_ASCII;
    } else if (v->compressor != CWI_VTI_PLAIN) {
        src->encoding = CWI_BLOCKS;
        src->blocks = (cwi_block_form){codecs[v->compressor], v->word_bytes, v->big_endian};
    } else {
        src->skip = v->word_bytes;
    }
}

/* In front of data that are not compressed stands the count of their bytes. */
static cw_status check_count(const cwi_input *in, const cwi_vti *v, const cwi_source *src,
                             cw_error *err)
{
    unsigned char word[8];
    uint64_t count = 0;
    cwi_stream stream = {0};
    if (src->encoding != CWI_RAW)
        return CW_OK;
    cw_status st = cwi_stream_open(&stream, in->fd, src->offset, false, err);
    if (st == CW_OK && src->base64)
        st = cwi_stream_from_base64(&stream, err);
    if (st == CW_OK)
        st = cwi_stream_read(&stream, word, v->word_bytes, err);
    cwi_stream_close(&stream);
    if (st != CW_OK)
        return st;
    for (size_t i = 0; i < v->word_bytes; i++)
        count = count << 8 | word[v->big_endian ? i : v->word_bytes - 1 - i];
    if (count == src->bytes)
        return CW_OK;
    return cw_fail(err, CW_ERR_FORMAT,
                   "the array '%s' has %llu bytes; 'Extent' and 'type' ask for %zu",
                   v->best.name, (unsigned long long)count, src->bytes);
}

cw_status cwi_vti_parse(const cwi_input *in, cwi_source *src, cw_error *err)
{
    cwi_vti v = {0};
    src->size_field = "Extent";
    src->frame_field = "Direction, Spacing, Origin";
    cw_status st = read_elements(in, &v, err);
    if (st == CW_OK)
        st = find_appended(in, &v, err);
    if (st == CW_OK)
        st = check_found(&v, err);
    if (st == CW_OK)
        st = set_sizes(&v, src, err);
    if (st != CW_OK)
        return st;
    set_frame(&v, &src->shape);
    set_place(&v, src);
    return check_count(in, &v, src, err);
}
