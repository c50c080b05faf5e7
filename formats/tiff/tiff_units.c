/* Units of length and time, as descriptions of TIFF files name them. */
#include "formats/tiff/tiff_file.h"

#include <string.h>

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
 * as Java escapes it. */
double cwi_tiff_length(const char *name, size_t length)
{
    static const unit units[] = {
        {"mm", 1},           {"millimeter", 1},    {"millimetre", 1},
        {"cm", 10},          {"centimeter", 10},   {"m", 1000},
        {"meter", 1000},     {"um", 1e-3},         {"micron", 1e-3},
        {"microns", 1e-3},   {"micrometer", 1e-3}, {"\xc2\xb5m", 1e-3},
        {"\xce\xbcm", 1e-3}, {"\xb5m", 1e-3},      {"\\u00B5m", 1e-3},
        {"\\u00b5m", 1e-3},  {"nm", 1e-6},         {"nanometer", 1e-6},
        {"pm", 1e-9},        {"\xc3\x85", 1e-7},   {"\xe2\x84\xab", 1e-7},
        {"angstrom", 1e-7},  {"in", 25.4},         {"inch", 25.4},
        {"inches", 25.4}};
    return find_unit(units, sizeof units / sizeof *units, name, length);
}

double cwi_tiff_time(const char *name, size_t length)
{
    static const unit units[] = {{"s", 1},     {"sec", 1},     {"second", 1}, {"seconds", 1},
                                 {"ms", 1e-3}, {"msec", 1e-3}, {"min", 60},   {"h", 3600}};
    return find_unit(units, sizeof units / sizeof *units, name, length);
}
