/* Reads colours as they are typed: #ffeedd, #fed, white. */
#include "cli/render/scene_options.h"

#include <stdlib.h>
#include <string.h>

static bool parse_hex(const char *hex, uint8_t rgba[4])
{
    const size_t n = strlen(hex), size = n < 6 ? 1 : 2;
    if ((n != 3 && n != 6 && n != 8) || strspn(hex, "0123456789abcdefABCDEF") != n)
        return false;
    rgba[3] = 255;
    for (size_t c = 0; c < n / size; c++) {
        const char digits[3] = {hex[size * c], hex[size * c + size - 1], '\0'};
        rgba[c] = (uint8_t)strtoul(digits, NULL, 16);
    }
    return true;
}

bool cli_parse_color(const char *text, uint8_t rgba[4])
{
    static const struct {
        const char *name, *hex;
    } names[] = {{"white", "fff"}, {"black", "000"}, {"grey", "808080"}, {"gray", "808080"}};
    for (size_t n = 0; n < sizeof names / sizeof *names; n++)
        if (strcmp(text, names[n].name) == 0)
            text = names[n].hex;
    return parse_hex(*text == '#' ? text + 1 : text, rgba);
}
