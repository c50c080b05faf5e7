/* Joins the types of pixels of a series' files, which may differ in sign and bits. */
#include "formats/dicom/dicom_pixel_types.h"

#include <math.h>

static bool is_signed(cw_type type)
{
    return type == CW_I8 || type == CW_I16 || type == CW_I32;
}

static bool is_real(cw_type type)
{
    return type == CW_F32 || type == CW_F64;
}

/* Returns the smallest type of whole numbers with a number of bits; doubles where there is none. */
static cw_type find_type(bool with_sign, uint32_t bits)
{
    static const cw_type types[2][3] = {{CW_U8, CW_U16, CW_U32}, {CW_I8, CW_I16, CW_I32}};
    return bits > 32 ? CW_F64 : types[with_sign][bits > 16 ? 2 : bits > 8 ? 1 : 0];
}

/* Returns the type of planes of different types. */
static cw_type join_types(const cwi_dicom_sorting *s)
{
    bool has_sign = false, has_real = false;
    uint32_t bits = 1;
    for (size_t i = 0; i < s->count; i++) {
        has_sign = has_sign || is_signed(s->planes[i].file->type);
        has_real = has_real || is_real(s->planes[i].file->type);
    }
    for (size_t i = 0; i < s->count; i++) {
        const cwi_dicom_facts *f = s->planes[i].file;
        const uint32_t own = f->value_bits + (has_sign && !is_signed(f->type));
        bits = own > bits ? own : bits;
    }
    return has_real ? CW_F64 : find_type(has_sign, bits);
}

static bool same_padding(const cwi_dicom_facts *f, const cwi_dicom_facts *g)
{
    return f->has_padding == g->has_padding &&
           (!f->has_padding ||
            (f->padding[0] == g->padding[0] && f->padding[1] == g->padding[1]));
}

cwi_dicom_pixels cwi_dicom_join_pixels(const cwi_dicom_sorting *s)
{
    const cwi_dicom_facts *first = s->planes[0].file;
    cwi_dicom_pixels p = {.type = first->type, .same_padding = true, .padded = first};
    bool same_type = true;
    for (size_t i = 0; i < s->count; i++) {
        const cwi_dicom_facts *f = s->planes[i].file;
        same_type = same_type && f->type == first->type;
        p.same_padding = p.same_padding && same_padding(f, first);
        p.is_long = p.is_long || cw_type_size(f->type) > 2;
        if (f->has_padding && !p.padded->has_padding)
            p.padded = f;
    }
    p.mixed = !same_type || !p.same_padding;
    if (!same_type)
        p.type = join_types(s);
    return p;
}
