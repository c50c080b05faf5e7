/* Names Expat's functions for positions alike in every version: 2.9 has new ones of 64 bits,
 * and deprecates those that have the type long. */
#ifndef FORMATS_TEXT_EXPAT_POSITION_H
#define FORMATS_TEXT_EXPAT_POSITION_H

#include <expat.h>

#if XML_MAJOR_VERSION == 2 && XML_MINOR_VERSION < 9
#define XML_GetCurrentLineNumber64 XML_GetCurrentLineNumber
#define XML_GetCurrentByteIndex64  XML_GetCurrentByteIndex
#define XML_GetCurrentByteCount64  XML_GetCurrentByteCount
#endif

#endif
