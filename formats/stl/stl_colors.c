/* Decides if the words behind STL facets are colours, and unpacks them. VisCAM and SolidView set bit
 * 15 of a colour, and red has the high bits. Materialise Magics states the object's colour in the
 * header, clears bit 15 of a facet with another one, and red has the low bits. */
#include "formats/stl/stl_colors.h"

#include "core/base/memory.h"
#include "formats/mesh/face_colors.h"

#include <string.h>

enum { IS_SET = 0x8000, LEVELS = 31 };

void cwi_stl_find_object_color(cwi_stl_colors *c, const unsigned char header[CWI_STL_HEADER])
{
    static const char key[] = "COLOR=";
    const size_t length = sizeof key - 1;
    for (size_t i = 0; i + length + 4 <= CWI_STL_HEADER && !c->has_object; i++)
        if (memcmp(header + i, key, length) == 0) {
            memcpy(c->object, header + i + length, 4);
            c->has_object = true;
        }
    if (c->object[3] == 0) /* nobody saves what is invisible */
        c->object[3] = 255;
}

cw_status cwi_stl_keep_word(cwi_stl_colors *c, size_t t, size_t count, uint16_t word,
                            cw_error *err)
{
    if (!c->words && word) {
        cw_status st =
            cwi_mesh_grow(c->in, &c->words, &c->capacity, count, sizeof *c->words, err);
        if (st != CW_OK)
            return st;
        memset(c->words, 0, c->capacity * sizeof *c->words);
    }
    if (c->words)
        c->words[t] = word;
    return CW_OK;
}

/* Returns true if the words are colours of VisCAM. Numbers of another meaning have no bit 15, or
 * have others where that is clear. */
static bool are_viscam(const cwi_stl_colors *c, size_t count)
{
    for (size_t t = 0; t < count; t++)
        if (c->words[t] && !(c->words[t] & IS_SET))
            return false;
    return true;
}

static uint8_t unpack_level(unsigned level)
{
    return (uint8_t)((level * 255 + LEVELS / 2) / LEVELS);
}

/* Unpacks a word. Returns NULL for a facet without a colour. */
static const uint8_t *unpack_word(const cwi_stl_colors *c, unsigned word, uint8_t color[4])
{
    if (c->has_object && (word & IS_SET || !c->words))
        return c->object;
    if (!c->has_object && !(word & IS_SET))
        return NULL;
    const uint8_t low = unpack_level(word & LEVELS), high = unpack_level(word >> 10 & LEVELS);
    color[0] = c->has_object ? low : high;
    color[1] = unpack_level(word >> 5 & LEVELS);
    color[2] = c->has_object ? high : low;
    color[3] = c->has_object ? c->object[3] : 255;
    return color;
}

static bool are_white(const cwi_face_colors *faces)
{
    for (size_t i = 0; i < 4 * faces->count; i++)
        if (faces->colors[i] != 255)
            return false;
    return true;
}

cw_status cwi_stl_color_mesh(const cwi_stl_colors *c, cw_mesh *mesh, cw_mesh_file *metadata,
                             cw_error *err)
{
    const size_t count = mesh->triangle_count;
    cwi_face_colors faces = {.in = c->in};
    cw_status st = CW_OK;
    if (!c->has_object && (!c->words || !are_viscam(c, count))) {
        cwi_say_left_out(metadata, c->words != NULL, "attributes of facets");
        return CW_OK;
    }
    for (size_t t = 0; t < count && st == CW_OK; t++) {
        uint8_t color[4];
        st = cwi_color_faces(&faces, t + 1, unpack_word(c, c->words ? c->words[t] : 0, color),
                             err);
    }
    if (st == CW_OK && faces.colors &&
        !are_white(&faces)) /* white is what has no colour, too */
        st = cwi_color_mesh(&faces, false, mesh, err);
    cwi_face_colors_free(&faces);
    return st;
}

void cwi_stl_colors_free(cwi_stl_colors *c)
{
    cwi_free(c->words);
    *c = (cwi_stl_colors){.in = c->in};
}

static unsigned pack_level(uint8_t value)
{
    return (value * LEVELS + 127u) / 255;
}

uint16_t cwi_stl_pack_color(const uint8_t color[4])
{
    return (uint16_t)(IS_SET | pack_level(color[0]) << 10 | pack_level(color[1]) << 5 |
                      pack_level(color[2]));
}
