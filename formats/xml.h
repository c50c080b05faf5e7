/* XML: text on its way into it. */
#ifndef FORMATS_XML_H
#define FORMATS_XML_H

#include <cubewright/core.h>

/* Room for text of so many bytes, escaped. */
#define CWI_XML_BYTES(bytes) (6 * (bytes))

/* Text as it may stand in an element or between double quotes; what does not fit is cut. */
void cwi_xml_escape(const char *text, char *escaped, size_t room);

#endif
