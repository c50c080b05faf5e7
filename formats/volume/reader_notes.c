/* Passes readers' notes to the caller, and applies the spacing that a caller states. */
#include "formats/volume/volume_reader.h"

#include <stdarg.h>
#include <stdio.h>

void cwi_note(const cw_read_desc *desc, const char *format, ...)
{
    char text[512];
    va_list arguments;
    if (!desc->note)
        return;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    desc->note(desc->note_user, text);
}

void cwi_note_links(const cw_read_desc *desc, size_t links)
{
    if (links)
        cwi_note(desc, "left out: %zu links; desc->allow_external follows them", links);
}

void cwi_set_spacing(cw_volume *v, const cw_read_desc *desc)
{
    double spacing[3];
    if (desc->spacing_mm[0] == 0)
        return;
    cw_volume_spacing(v, spacing);
    for (int c = 0; c < 3; c++)
        for (int r = 0; r < 3; r++)
            v->affine[r][c] *= desc->spacing_mm[c] / spacing[c];
    v->known |= CW_KNOWN_UNIT;
}
