/* XML: elements in a table, read as a stream without document types; and text on its way into
 * it. */
#ifndef FORMATS_TEXT_XML_H
#define FORMATS_TEXT_XML_H

#include "formats/bytes/input_file.h"

/* Attributes of an element: names and values by turns, then NULL. */
typedef const char *const *cwi_attributes;

/* The value of an attribute, whatever prefix its name has; NULL when there is none. */
const char *cwi_attribute(cwi_attributes a, const char *name);

typedef struct cwi_xml cwi_xml;

enum { CWI_XML_ROOT = -1 };

/* An element that means something: its name without prefix, and the row of the one that it
 * stands in. Others are passed over, with all that is in them. */
typedef struct cwi_xml_element {
    const char *name;
    int parent;
    cw_status (*start)(void *user, cwi_xml *x, cwi_attributes a, cw_error *err);
    cw_status (*end)(void *user, cwi_xml *x, cw_error *err);
} cwi_xml_element;

typedef struct cwi_xml_rules {
    const cwi_xml_element *elements;
    int element_count;
    uint64_t most_elements; /* of any name; 0: no limit */
    /* Text of the row's element (CWI_XML_ROOT: of another), perhaps not all of it at once; a
     * comment; any tag, before its element. NULL: does not matter. */
    cw_status (*text)(void *user, int row, const char *text, size_t size, cw_error *err);
    cw_status (*comment)(void *user, const char *text, cw_error *err);
    cw_status (*tag)(void *user, cwi_xml *x, cw_error *err);
} cwi_xml_rules;

/* Gives the next bytes, up to size; *got is 0 only at the end. */
typedef cw_status cwi_xml_source(void *from, void *to, size_t size, size_t *got, cw_error *err);

/* Reads a document; the first element must be the row that has CWI_XML_ROOT for its parent.
 * Returns  CW_ERR_FORMAT  no XML, elements nested deeper than 64, too many of them, a tag of
 * more than 1 MiB; CW_ERR_UNSAFE a document type; CW_ERR_NO_MEMORY or what source and rules
 * return */
CW_NODISCARD cw_status cwi_xml_read(const cwi_xml_rules *rules, void *user,
                                    cwi_xml_source *source, void *from, cw_error *err);

/* Reads a file from its start. */
CW_NODISCARD cw_status cwi_xml_read_file(const cwi_xml_rules *rules, void *user,
                                         const cwi_input *in, cw_error *err);

/* Where the tag at hand begins, and where it ends, counted in bytes from the start. */
uint64_t cwi_xml_tag_start(const cwi_xml *x);
uint64_t cwi_xml_tag_end(const cwi_xml *x);

/* The line that reading has come to, from 1; for messages. */
unsigned long cwi_xml_line(const cwi_xml *x);

/* Within start: nothing behind this tag is read, which need be no XML. */
void cwi_xml_stop(cwi_xml *x);

/* How many elements the one at hand stands in. */
size_t cwi_xml_depth(const cwi_xml *x);

/* Room for text of so many bytes, escaped. */
#define CWI_XML_BYTES(bytes) (6 * (bytes))

/* Text as it may stand in an element or between double quotes; what does not fit is cut. */
void cwi_xml_escape(const char *text, char *escaped, size_t room);

#endif
