/* Base64: text to bytes in portions of any size, and bytes to text. */
#ifndef FORMATS_BYTES_BASE64_H
#define FORMATS_BYTES_BASE64_H

#include <cubewright/core.h>

/* The state of decoding. Zeroed at the start. */
typedef struct cwi_base64 {
    uint32_t bits;     /* of the current group of four characters */
    unsigned in_group; /* characters of it so far */
    bool padded;       /* ... and only '=' may follow in it */
    bool ended;        /* at a '<': an XML tag follows */
    bool wrong;        /* at any other character */
} cwi_base64;

/* Decodes until `capacity` bytes are written, the text is used up, or an end is reached. Blanks are
 * skipped, and a new group starts behind padding. Returns the bytes written; *used counts
 * characters. */
size_t cwi_base64_decode(cwi_base64 *b, const char *text, size_t size, size_t *used,
                         unsigned char *to, size_t capacity);

/* Encodes bytes; only the last portion of a text may be no multiple of 3. Returns the
 * characters written: 4 for each 3 bytes begun. */
size_t cwi_base64_encode(const unsigned char *bytes, size_t size, char *text);

#endif
