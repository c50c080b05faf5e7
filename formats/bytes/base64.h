/* Base64 text to bytes, in portions of any size. */
#ifndef FORMATS_BYTES_BASE64_H
#define FORMATS_BYTES_BASE64_H

#include <cubewright/core.h>

/* Where decoding stands. Zeroed at the start. */
typedef struct cwi_base64 {
    uint32_t bits;     /* of the group of four characters that is under way */
    unsigned in_group; /* characters of it so far */
    bool padded;       /* ... and only '=' may follow in it */
    bool ended;        /* at a '<': an XML tag follows */
    bool wrong;        /* at a character that is neither */
} cwi_base64;

/* Decodes until the room is full, the text is used up, or an end; blanks are passed over, and
 * behind padding a new group starts. Returns the bytes written; *used counts characters. */
size_t cwi_base64_decode(cwi_base64 *b, const char *text, size_t size, size_t *used,
                         unsigned char *to, size_t room);

/* Encodes bytes; only the last portion of a text may be no multiple of 3. Returns the
 * characters written: 4 for each 3 bytes begun. */
size_t cwi_base64_encode(const unsigned char *bytes, size_t size, char *text);

#endif
