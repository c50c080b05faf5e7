/* Reads the LabelTable of Connectome Workbench and GIFTI, which NIfTI files hold, too. */
#ifndef FORMATS_TEXT_LABEL_XML_H
#define FORMATS_TEXT_LABEL_XML_H

#include "formats/text/xml.h"

#include <cubewright/label_table.h>

/* Returns true if bytes are XML with a LabelTable. They end with a zero, which does not
 * count. */
bool cwi_label_xml_sniff(const char *text);

/* Reads the attributes of a Label: its key and colour. Returns CW_ERR_FORMAT. */
CW_NODISCARD cw_status cwi_label_xml_label(const cwi_xml *x, cwi_attributes a, cw_label *label,
                                           cw_error *err);

/* Fills a zeroed table from an XML document: a LabelTable by itself, or the first one of a
 * CaretExtension or GIFTI. The caller frees the table, on failure too.
 * Returns CW_ERR_FORMAT, which names line and attribute; CW_ERR_UNSAFE for a document type other than a mere GIFTI;
 * CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_label_xml_read(const char *bytes, size_t size, cw_label_table *table,
                                          cw_error *err);

#endif
