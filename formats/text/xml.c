/* Parses XML as a stream by Expat, by a table of elements, within limits, and escapes text. */
#include "formats/text/xml.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "formats/text/expat_position.h"

#include <string.h>

enum { CHUNK = 1 << 16, MAX_DEPTH = 64, LONGEST_TAG = 1 << 20, OTHER = -2 };

struct cwi_xml {
    XML_Parser expat;
    const cwi_xml_rules *rules;
    void *user;
    int path[MAX_DEPTH]; /* rows; OTHER for elements outside of the table */
    size_t depth;
    uint64_t count, fed;
    bool stopped;
    cw_status status;
    cw_error *err;
};

/* Returns the name without its prefix. */
static const char *local_name(const char *name)
{
    const char *colon = strrchr(name, ':');
    return colon ? colon + 1 : name;
}

const char *cwi_attribute(cwi_attributes a, const char *name)
{
    for (; *a; a += 2)
        if (strcmp(local_name(a[0]), name) == 0)
            return a[1];
    return NULL;
}

uint64_t cwi_xml_tag_start(const cwi_xml *x)
{
    return (uint64_t)XML_GetCurrentByteIndex64(x->expat);
}

uint64_t cwi_xml_tag_end(const cwi_xml *x)
{
    return (uint64_t)XML_GetCurrentByteIndex64(x->expat) +
           (uint64_t)XML_GetCurrentByteCount64(x->expat);
}

unsigned long cwi_xml_line(const cwi_xml *x)
{
    return (unsigned long)XML_GetCurrentLineNumber64(x->expat);
}

void cwi_xml_stop(cwi_xml *x)
{
    x->stopped = true;
}

size_t cwi_xml_depth(const cwi_xml *x)
{
    return x->depth;
}

/* --- events ------------------------------------------------------------------------------ */

/* Ends the parsing after the current event, with a status or because enough was read. */
static void settle_status(cwi_xml *x, cw_status status)
{
    x->status = status;
    if (status != CW_OK || x->stopped)
        XML_StopParser(x->expat, XML_FALSE);
}

/* Returns true after a stop: Expat may deliver an event or two more. */
static bool is_over(const cwi_xml *x)
{
    return x->status != CW_OK || x->stopped;
}

static int row_at(const cwi_xml *x)
{
    return x->depth ? x->path[x->depth - 1] : CWI_XML_ROOT;
}

static int find_row(const cwi_xml *x, const char *name)
{
    const cwi_xml_element *elements = x->rules->elements;
    const int parent = row_at(x);
    name = local_name(name);
    for (int i = 0; i < x->rules->element_count; i++)
        if ((elements[i].parent == parent || (i > 0 && i == parent && i == x->rules->nests)) &&
            strcmp(elements[i].name, name) == 0)
            return i;
    return OTHER;
}

static cw_status start_element(cwi_xml *x, const char *name, cwi_attributes a)
{
    const cwi_xml_rules *rules = x->rules;
    if (rules->max_elements && x->count == rules->max_elements)
        return cwi_fail(x->err, CW_ERR_FORMAT, "more than %llu elements",
                        (unsigned long long)x->count);
    if (x->depth == MAX_DEPTH)
        return cwi_fail(x->err, CW_ERR_FORMAT, "more than %d elements inside each other",
                        MAX_DEPTH);
    const int row = find_row(x, name);
    if (x->depth == 0 && row == OTHER)
        return cwi_fail(x->err, CW_ERR_FORMAT, "the first element is not %s",
                        rules->elements[0].name);
    cw_status st = rules->tag ? rules->tag(x->user, x, x->err) : CW_OK;
    if (st == CW_OK && row != OTHER && rules->elements[row].start)
        st = rules->elements[row].start(x->user, x, a, x->err);
    x->count++;
    x->path[x->depth++] = row;
    return st;
}

static void XMLCALL on_start(void *user, const XML_Char *name, const XML_Char **attributes)
{
    cwi_xml *x = user;
    if (is_over(x))
        return;
    settle_status(x, start_element(x, name, (cwi_attributes)attributes));
}

static void XMLCALL on_end(void *user, const XML_Char *name)
{
    cwi_xml *x = user;
    (void)name;
    if (is_over(x))
        return;
    const int row = row_at(x);
    cw_status st = x->rules->tag ? x->rules->tag(x->user, x, x->err) : CW_OK;
    x->depth--;
    if (st == CW_OK && row >= 0 && x->rules->elements[row].end)
        st = x->rules->elements[row].end(x->user, x, x->err);
    settle_status(x, st);
}

static void XMLCALL on_text(void *user, const XML_Char *text, int size)
{
    cwi_xml *x = user;
    if (is_over(x))
        return;
    const int row = row_at(x) == OTHER ? CWI_XML_ROOT : row_at(x);
    settle_status(x, x->rules->text(x->user, row, text, (size_t)size, x->err));
}

static void XMLCALL on_comment(void *user, const XML_Char *text)
{
    cwi_xml *x = user;
    if (!is_over(x))
        settle_status(x, x->rules->comment(x->user, text, x->err));
}

static void XMLCALL on_doctype(void *user, const XML_Char *name, const XML_Char *system,
                               const XML_Char *public_id, int internal)
{
    cwi_xml *x = user;
    const char *known = x->rules->doctype;
    (void)system, (void)public_id;
    if (known && strcmp(name, known) == 0 && !internal)
        return;
    if (!is_over(x))
        settle_status(
            x, cwi_fail(x->err, CW_ERR_UNSAFE,
                        "the file has a document type (<!DOCTYPE>); it needs none, and none is "
                        "read"));
}

/* --- the document ------------------------------------------------------------------------ */

static void *give_memory(size_t size)
{
    return cwi_alloc_array(size, 1);
}

static void *resize_memory(void *memory, size_t size)
{
    return cwi_realloc_array(memory, size, 1);
}

static cw_status fail_xml(const cwi_xml *x)
{
    const enum XML_Error code = XML_GetErrorCode(x->expat);
    if (x->status != CW_OK)
        return x->status;
    if (code == XML_ERROR_NO_MEMORY)
        return cwi_fail_memory(x->err);
    return cwi_fail(x->err, CW_ERR_FORMAT, "line %lu is not XML: %s",
                    (unsigned long)XML_GetCurrentLineNumber64(x->expat), XML_ErrorString(code));
}

/* Checks the length of a tag, which Expat keeps in memory until it is complete. */
static cw_status check_tag(const cwi_xml *x)
{
    const int64_t at = XML_GetCurrentByteIndex64(x->expat);
    if (at < 0 || x->fed - (uint64_t)at <= LONGEST_TAG)
        return CW_OK;
    return cwi_fail(x->err, CW_ERR_FORMAT, "line %lu has a tag longer than 1 MiB",
                    (unsigned long)XML_GetCurrentLineNumber64(x->expat));
}

static cw_status feed_parser(cwi_xml *x, cwi_xml_source *source, void *from)
{
    cw_status st = CW_OK;
    for (bool last = false; st == CW_OK && !last && !x->stopped;) {
        size_t got = 0;
        void *buffer = XML_GetBuffer(x->expat, CHUNK);
        if (!buffer)
            return fail_xml(x);
        st = source(from, buffer, CHUNK, &got, x->err);
        last = got == 0;
        x->fed += got;
        if (st == CW_OK && XML_ParseBuffer(x->expat, (int)got, last) != XML_STATUS_OK &&
            (x->status != CW_OK || !x->stopped))
            st = fail_xml(x);
        if (st == CW_OK)
            st = check_tag(x);
    }
    return st;
}

cw_status cwi_xml_read(const cwi_xml_rules *rules, void *user, cwi_xml_source *source,
                       void *from, cw_error *err)
{
    const XML_Memory_Handling_Suite memory = {give_memory, resize_memory, cwi_free};
    cwi_xml x = {.rules = rules,
                 .user = user,
                 .err = err,
                 .expat = XML_ParserCreate_MM("UTF-8", &memory, NULL)};
    if (!x.expat)
        return cwi_fail_memory(err);
    XML_SetUserData(x.expat, &x);
    XML_SetElementHandler(x.expat, on_start, on_end);
    XML_SetStartDoctypeDeclHandler(x.expat, on_doctype);
    if (rules->text)
        XML_SetCharacterDataHandler(x.expat, on_text);
    if (rules->comment)
        XML_SetCommentHandler(x.expat, on_comment);
    cw_status st = feed_parser(&x, source, from);
    XML_ParserFree(x.expat);
    return st;
}

typedef struct file_position {
    const cwi_input *in;
    uint64_t at;
} file_position;

static cw_status read_on(void *from, void *to, size_t size, size_t *got, cw_error *err)
{
    file_position *p = from;
    cw_status st = cwi_input_read_at(p->in->fd, p->at, to, size, got, err);
    p->at += *got;
    return st;
}

cw_status cwi_xml_read_file(const cwi_xml_rules *rules, void *user, const cwi_input *in,
                            cw_error *err)
{
    return cwi_xml_read(rules, user, read_on, &(file_position){.in = in}, err);
}

/* --- text -------------------------------------------------------------------------------- */

static const char *escape_of(char c)
{
    switch (c) {
    case '&':
        return "&amp;";
    case '<':
        return "&lt;";
    case '>':
        return "&gt;";
    case '"':
        return "&quot;";
    default:
        return NULL;
    }
}

void cwi_xml_escape(const char *text, char *escaped, size_t capacity)
{
    size_t used = 0;
    for (; *text; text++) {
        const char *as = escape_of(*text);
        const size_t length = as ? strlen(as) : 1;
        if (used + length >= capacity)
            break;
        memcpy(escaped + used, as ? as : text, length);
        used += length;
    }
    escaped[used] = '\0';
}
