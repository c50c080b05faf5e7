/* Units of length and time, as descriptions of TIFF files name them. */
#include "formats/tiff/tiff_file.h"

#include <string.h>
#include <strings.h>

typedef struct unit {
    const char *name;
    double value;
} unit;

static double find_unit(const unit *units, size_t count, const char *name, size_t length)
{
    for (size_t i = 0; i < count; i++)
        if (strlen(units[i].name) == length && memcmp(units[i].name, name, length) == 0)
            return units[i].value;
    return 0;
}

/* Returns the millimetres of a unit. The micro sign is Unicode's, a Greek letter, Latin-1's, or
 * as Java escapes it. The ring of an Angstrom is so, too. */
double cwi_tiff_length(const char *name, size_t length)
{
    static const unit units[] = {
        {"mm", 1},           {"cm", 10},          {"dm", 100},
        {"m", 1000},         {"km", 1e6},         {"um", 1e-3},
        {"\xc2\xb5m", 1e-3}, {"\xce\xbcm", 1e-3}, {"\xb5m", 1e-3},
        {"\\u00B5m", 1e-3},  {"\\u00b5m", 1e-3},  {"\\u03BCm", 1e-3},
        {"\\u03bcm", 1e-3},  {"nm", 1e-6},        {"pm", 1e-9},
        {"fm", 1e-12},       {"\xc3\x85", 1e-7},  {"\xe2\x84\xab", 1e-7},
        {"A\xcc\x8a", 1e-7}, {"\xc5", 1e-7},      {"\\u00C5", 1e-7},
        {"\\u00c5", 1e-7},   {"\\u212B", 1e-7},   {"\\u212b", 1e-7},
        {"A", 1e-7},         {"in", 25.4},        {"\"", 25.4},
        {"ft", 304.8},       {"yd", 914.4},       {"mil", 0.0254},
        {"thou", 0.0254},    {"pt", 25.4 / 72}};
    static const unit words[] = {{"millimeter", 1},
                                 {"millimetre", 1},
                                 {"centimeter", 10},
                                 {"centimetre", 10},
                                 {"meter", 1000},
                                 {"metre", 1000},
                                 {"micron", 1e-3},
                                 {"mu", 1e-3},
                                 {"micrometer", 1e-3},
                                 {"micrometre", 1e-3},
                                 {"nanometer", 1e-6},
                                 {"nanometre", 1e-6},
                                 {"picometer", 1e-9},
                                 {"picometre", 1e-9},
                                 {"angstrom", 1e-7},
                                 {"angstroem", 1e-7},
                                 {"\xc3\xa5ngstr\xc3\xb6m", 1e-7},
                                 {"\xc3\x85ngstr\xc3\xb6m", 1e-7},
                                 {"inch", 25.4},
                                 {"inche", 25.4},
                                 {"foot", 304.8},
                                 {"feet", 304.8}};
    while (length && name[0] == ' ')
        name++, length--;
    while (length && name[length - 1] == ' ')
        length--;
    const double value = find_unit(units, sizeof units / sizeof *units, name, length);
    if (value > 0)
        return value;
    const size_t singular =
        length > 1 && (name[length - 1] | 0x20) == 's' ? length - 1 : length;
    for (size_t i = 0; i < sizeof words / sizeof *words; i++)
        if ((strlen(words[i].name) == singular || strlen(words[i].name) == length) &&
            strncasecmp(words[i].name, name, strlen(words[i].name)) == 0)
            return words[i].value;
    return 0;
}

/* Returns true for words that stand for no unit. */
static bool is_no_unit(const char *name, size_t length)
{
    static const char *const words[] = {"",        "pixel",          "pixels", "px",
                                        "voxel",   "voxels",         "none",   "null",
                                        "unknown", "reference frame"};
    for (size_t i = 0; i < sizeof words / sizeof *words; i++)
        if (strlen(words[i]) == length && strncasecmp(words[i], name, length) == 0)
            return true;
    return false;
}

void cwi_tiff_set_unit(cwi_tiff_facts *facts, int axis, const char *name, size_t length)
{
    facts->unit_mm[axis] = cwi_tiff_length(name, length);
    if (facts->unit_mm[axis] > 0 || is_no_unit(name, length) || strstr(facts->note, "unit '"))
        return;
    cwi_tiff_note(facts, "the unit '%.*s' is not known: none is taken",
                  (int)(length < 24 ? length : 24), name);
}

double cwi_tiff_time(const char *name, size_t length)
{
    static const unit units[] = {{"s", 1},     {"sec", 1},     {"second", 1}, {"seconds", 1},
                                 {"ms", 1e-3}, {"msec", 1e-3}, {"min", 60},   {"h", 3600}};
    return find_unit(units, sizeof units / sizeof *units, name, length);
}
