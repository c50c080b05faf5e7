/* Colours of STL facets: 15 bits in the word behind each facet, in one of two conventions. */
#ifndef FORMATS_STL_STL_COLORS_H
#define FORMATS_STL_STL_COLORS_H

#include "formats/mesh/mesh_reader.h"

enum { CWI_STL_HEADER = 80 };

/* The words of facets. Zero it, except for `in`; free it with cwi_stl_colors_free(). */
typedef struct cwi_stl_colors {
    cwi_mesh_input *in; /* borrowed */
    uint16_t *words;    /* of all facets; NULL: all are 0 */
    size_t capacity;
    bool has_object; /* the header has the colour of the object, as Magics writes it */
    uint8_t object[4];
} cwi_stl_colors;

/* Looks for the object's colour in the header of a binary file. */
void cwi_stl_find_object_color(cwi_stl_colors *c, const unsigned char header[CWI_STL_HEADER]);

/* Keeps the word of facet t out of `count`. Returns as cwi_mesh_grow() */
CW_NODISCARD cw_status cwi_stl_keep_word(cwi_stl_colors *c, size_t t, size_t count,
                                         uint16_t word, cw_error *err);

/* Gives a mesh the colours of its facets, if the words are colours; else says that they are left
 * out. Returns CW_ERR_NO_MEMORY, CW_ERR_LIMIT */
CW_NODISCARD cw_status cwi_stl_color_mesh(const cwi_stl_colors *c, cw_mesh *mesh,
                                          cw_mesh_file *metadata, cw_error *err);

void cwi_stl_colors_free(cwi_stl_colors *c);

/* Packs a colour for VisCAM: bit 15, then 5 bits each of red, green and blue. */
uint16_t cwi_stl_pack_color(const uint8_t color[4]);

#endif
