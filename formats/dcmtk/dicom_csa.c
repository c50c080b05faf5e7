/* Reads numbers from the CSA header of Siemens scanners. */
#include "formats/dcmtk/dicom_csa.h"

#include "core/base/text.h"

#include <stdint.h>
#include <string.h>

/* Sizes in the header. A tag is a name of 64 bytes, three numbers (count of values, their kind,
 * its number), the count of items that follow, and a mark. An item is four numbers with its
 * length, then a text. */
enum { TAG_BYTES = 84, TAG_ITEMS = 76, ITEM_BYTES = 16, NAME_BYTES = 64, MAX_TAGS = 1000 };

typedef struct reader {
    const unsigned char *bytes;
    size_t size, at;
    bool first_version;
    uint32_t first_items; /* of the first tag: the first version adds it to every length */
} reader;

static uint32_t number_at(const reader *r, size_t at)
{
    const unsigned char *b = r->bytes + at;
    return (uint32_t)b[0] | (uint32_t)b[1] << 8 | (uint32_t)b[2] << 16 | (uint32_t)b[3] << 24;
}

static bool has_bytes(const reader *r, size_t count)
{
    return r->at <= r->size && count <= r->size - r->at;
}

/* Goes to the text of the next item and sets its length; returns false where the header is
 * damaged. */
static bool next_item(reader *r, size_t *length)
{
    if (!has_bytes(r, ITEM_BYTES))
        return false;
    const uint32_t stated = number_at(r, r->at + (r->first_version ? 0 : 4));
    const uint32_t more = r->first_version ? r->first_items : 0;
    *length = stated - more;
    r->at += ITEM_BYTES;
    return stated >= more && has_bytes(r, *length);
}

static bool parse_item(const reader *r, size_t length, double *number)
{
    char text[64];
    const size_t kept = length < sizeof text ? length : sizeof text - 1;
    memcpy(text, r->bytes + r->at, kept);
    text[kept] = '\0';
    const char *from = text + strspn(text, " ");
    return cwi_parse_double(&from, number);
}

/* Passes the items of a tag; reads the first `expected` ones. */
static bool pass_items(reader *r, uint32_t items, int expected, double *numbers, int *found)
{
    *found = 0;
    for (uint32_t n = 0; n < items; n++) {
        size_t length;
        if (!next_item(r, &length))
            return false;
        if (*found < expected && (uint32_t)*found == n && parse_item(r, length, numbers + n))
            ++*found;
        r->at += (length + 3) / 4 * 4; /* items begin at multiples of four */
    }
    return true;
}

bool cwi_csa_numbers(const unsigned char *header, size_t size, const char *tag, int count,
                     double *numbers)
{
    const bool newer = size >= 8 && memcmp(header, "SV10", 4) == 0;
    reader r = {.bytes = header, .size = size, .at = newer ? 8 : 0, .first_version = !newer};
    if (!has_bytes(&r, 8))
        return false;
    const uint32_t tags = number_at(&r, r.at);
    r.at += 8;
    for (uint32_t t = 0; t < tags && t < MAX_TAGS && has_bytes(&r, TAG_BYTES); t++) {
        const char *name = (const char *)r.bytes + r.at;
        const bool is_it = strncmp(name, tag, NAME_BYTES) == 0;
        const uint32_t items = number_at(&r, r.at + TAG_ITEMS);
        int found;
        if (t == 0)
            r.first_items = items;
        r.at += TAG_BYTES;
        if (!pass_items(&r, items, is_it ? count : 0, numbers, &found))
            return is_it && found == count;
        if (is_it)
            return found == count;
    }
    return false;
}
