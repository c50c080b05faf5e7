#include "formats/xml.h"

#include <string.h>

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

void cwi_xml_escape(const char *text, char *escaped, size_t room)
{
    size_t used = 0;
    for (; *text; text++) {
        const char *as = escape_of(*text);
        const size_t length = as ? strlen(as) : 1;
        if (used + length >= room)
            break;
        memcpy(escaped + used, as ? as : text, length);
        used += length;
    }
    escaped[used] = '\0';
}
