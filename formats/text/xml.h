/* Streaming XML reader: a table of elements, without document types; and escaping of text. */
#ifndef FORMATS_TEXT_XML_H
#define FORMATS_TEXT_XML_H

#include "formats/bytes/input_file.h"

/* The attributes of an element: names and values alternate, then NULL. */
typedef const char *const *cwi_attributes;

/* Returns the value of an attribute, with any prefix of its name; NULL when there is none. */
const char *cwi_attribute(cwi_attributes a, const char *name);

typedef struct cwi_xml cwi_xml;

enum { CWI_XML_ROOT = -1 };

/* An element that is read: its name without prefix, and the row of its parent. Other elements
 * are skipped, with everything in them. */
typedef struct cwi_xml_element {
    const char *name;
    int parent;
    cw_status (*start)(void *user, cwi_xml *x, cwi_attributes a, cw_error *err);
    cw_status (*end)(void *user, cwi_xml *x, cw_error *err);
} cwi_xml_element;

typedef struct cwi_xml_rules {
    const cwi_xml_element *elements;
    int element_count;
    uint64_t max_elements; /* of any name; 0: no limit */
    const char *
        doctype; /* name of a document type that may be stated, without any content; NULL: none */
    int nests;   /* row of elements that may hold others of their row; 0: none */
    /* Callbacks: text of the row's element (CWI_XML_ROOT: of another one), possibly in several
     * pieces; a comment; any tag, before its element. NULL: not needed. */
    cw_status (*text)(void *user, int row, const char *text, size_t size, cw_error *err);
    cw_status (*comment)(void *user, const char *text, cw_error *err);
    cw_status (*tag)(void *user, cwi_xml *x, cw_error *err);
} cwi_xml_rules;

/* Reads the next bytes, up to size; *got is 0 only at the end. */
typedef cw_status cwi_xml_source(void *from, void *to, size_t size, size_t *got, cw_error *err);

/* Reads a document; its first element must be the row whose parent is CWI_XML_ROOT.
 * Returns  CW_ERR_FORMAT  no XML, elements nested deeper than 64, too many of them, a tag of
 *          more than 1 MiB; CW_ERR_UNSAFE a document type; CW_ERR_NO_MEMORY or the errors of
 *          source and rules */
CW_NODISCARD cw_status cwi_xml_read(const cwi_xml_rules *rules, void *user,
                                    cwi_xml_source *source, void *from, cw_error *err);

/* Reads a file from its start. */
CW_NODISCARD cw_status cwi_xml_read_file(const cwi_xml_rules *rules, void *user,
                                         const cwi_input *in, cw_error *err);

/* Return the start, and the end, of the current tag, in bytes from the start. */
uint64_t cwi_xml_tag_start(const cwi_xml *x);
uint64_t cwi_xml_tag_end(const cwi_xml *x);

/* Returns the current line, from 1; for messages. */
unsigned long cwi_xml_line(const cwi_xml *x);

/* Stops after the current tag, when called within start; the rest need not be XML. */
void cwi_xml_stop(cwi_xml *x);

/* Returns the number of elements around the current one. */
size_t cwi_xml_depth(const cwi_xml *x);

/* The capacity for `bytes` bytes of text when escaped. */
#define CWI_XML_BYTES(bytes) (6 * (bytes))

/* Escapes text for an element or for double quotes; text beyond the capacity is cut. */
void cwi_xml_escape(const char *text, char *escaped, size_t capacity);

#endif
