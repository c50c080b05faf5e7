/* Parses and prints lists of planes. */
#include "cli/cut/cut_planes.h"

#include <stdio.h>
#include <string.h>

/* Returns the length of the first plane of a list: a place on an axis ends at the first comma, a point with its
 * normal at the fifth. */
static size_t find_end(const char *text)
{
    const char first = *text == '-' ? text[1] : *text;
    size_t commas = first >= 'x' && first <= 'z' ? 1 : 5, n = 0;
    for (; text[n]; n++)
        if (text[n] == ',' && --commas == 0)
            break;
    return n;
}

static bool parse_planes(const cli_option *o, const char *text, void *field)
{
    cli_planes *out = field;
    *out = (cli_planes){0};
    for (;; text++) {
        char item[sizeof out->plane->text];
        const size_t length = find_end(text), n = out->count++;
        if (n == CLI_MAX_PLANES || length >= sizeof item)
            return false;
        memcpy(item, text, length);
        item[length] = '\0';
        if (!cli_kind_plane.parse(o, item, &out->plane[n]))
            return false;
        text += length;
        if (!*text)
            return true;
    }
}

static void print_planes(const cli_option *o, const void *field, char *text, size_t size)
{
    const cli_planes *planes = field;
    size_t used = 0;
    (void)o;
    for (size_t n = 0; n < planes->count && used < size; n++)
        used += (size_t)snprintf(text + used, size - used, "%s%s", n ? "," : "",
                                 cli_plane_text(&planes->plane[n]));
}

const cli_kind cli_kind_planes = {
    .size = sizeof(cli_planes),
    .parse = parse_planes,
    .print = print_planes,
    .expected =
        "up to 32 planes, such as z=5mm or z=50%,x=10mm, or points with normals such as "
        "0,0,5:0,0.1,1",
    .unit_rule =
        "a place on an axis has " CLI_UNITS_MM " or % of the box; a point is in LPS mm",
    .units = CLI_IN_MM | CLI_IN_PERCENT | CLI_SIGNED,
};
