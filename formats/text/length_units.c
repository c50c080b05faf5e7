/* The names and millimetres of the units of length that files may state. */
#include <cubewright/formats.h>

static const struct {
    const char *name;
    double mm;
} units[CW_UNIT_COUNT] = {
#define ROW(constant, name, mm) [constant] = {name, mm},
    CW_UNIT_TABLE(ROW)
#undef ROW
};

const char *cw_unit_name(cw_unit unit)
{
    return units[unit < CW_UNIT_COUNT ? unit : CW_UNIT_MM].name;
}

double cw_unit_mm(cw_unit unit)
{
    return units[unit < CW_UNIT_COUNT ? unit : CW_UNIT_MM].mm;
}
