/* Turns the segments of a DICOM segmentation into a table of labels. */
#include "formats/dicom/dicom_segments.h"

#include "core/base/status.h"
#include "formats/dicom/dicom_overlap.h"

#include <math.h>
#include <string.h>

/* Of XYZ relative to the white D50 to linear sRGB, whose white is D65: Bradford's adaptation and
 * the primaries of IEC 61966-2-1, multiplied out. */
static const double TO_LINEAR[3][3] = {
    {3.1338561, -1.6168667, -0.4906146},
    {-0.9787684, 1.9161415, 0.0334540},
    {0.0719453, -0.2289914, 1.4052427},
};
static const double WHITE_D50[3] = {0.96422, 1, 0.82521};

/* The inverse of CIELab's curve. */
static double lab_inverse(double f)
{
    const double LAB_KNEE = 6.0 / 29;
    return f > LAB_KNEE ? f * f * f : 3 * LAB_KNEE * LAB_KNEE * (f - 4.0 / 29);
}

static uint8_t to_srgb(double linear)
{
    const double c =
        linear <= 0.0031308 ? 12.92 * linear : 1.055 * pow(linear, 1 / 2.4) - 0.055;
    return (uint8_t)lround(255 * fmin(fmax(c, 0), 1));
}

void cwi_dicom_lab_to_srgb(const uint16_t lab[3], uint8_t srgb[3])
{
    const double l = lab[0] / 65535.0 * 100, a = lab[1] / 65535.0 * 255 - 128,
                 b = lab[2] / 65535.0 * 255 - 128;
    const double y = (l + 16) / 116;
    const double xyz[3] = {WHITE_D50[0] * lab_inverse(y + a / 500),
                           WHITE_D50[1] * lab_inverse(y),
                           WHITE_D50[2] * lab_inverse(y - b / 200)};
    for (int c = 0; c < 3; c++)
        srgb[c] = to_srgb(TO_LINEAR[c][0] * xyz[0] + TO_LINEAR[c][1] * xyz[1] +
                          TO_LINEAR[c][2] * xyz[2]);
}

#define IS_TERMINATED(text) (memchr((text), '\0', sizeof(text)) != NULL)

static bool is_valid_code(const cwi_dicom_code *code)
{
    return IS_TERMINATED(code->scheme) && IS_TERMINATED(code->value) &&
           IS_TERMINATED(code->meaning);
}

static char *text_or_null(const char *text)
{
    return *text ? (char *)(uintptr_t)text : NULL;
}

static cw_code borrow_code(const cwi_dicom_code *code)
{
    return (cw_code){.scheme = text_or_null(code->scheme),
                     .value = text_or_null(code->value),
                     .meaning = text_or_null(code->meaning)};
}

/* Adds a segment, whose facts are untrusted. */
static cw_status add_segment(const cwi_dicom_segment *s, const uint8_t *layer_of,
                             cw_label_table *table, cw_error *err)
{
    if (!IS_TERMINATED(s->label) || !is_valid_code(&s->category) || !is_valid_code(&s->type))
        return cwi_fail(err, CW_ERR_BACKEND, "DCMTK's answer is not valid");
    cw_label label = {.value = s->number,
                      .layer = s->number < CWI_DICOM_SEGMENTS ? layer_of[s->number] : 0,
                      .name = text_or_null(s->label),
                      .has_color = s->has_color != 0,
                      .color = {0, 0, 0, 255},
                      .category = borrow_code(&s->category),
                      .type = borrow_code(&s->type)};
    if (label.has_color)
        cwi_dicom_lab_to_srgb(s->lab, label.color);
    return cw_label_table_add(table, &label, err);
}

cw_status cwi_dicom_add_segments(const cwi_dicom_scan *scan, size_t series,
                                 const uint8_t *layer_of, cw_label_table *table, cw_error *err)
{
    cw_status st = CW_OK;
    for (size_t p = 0; p < scan->plane_count && st == CW_OK; p++) {
        const cwi_dicom_plane *plane = &scan->planes[p];
        if (plane->series != series || plane->number > 0)
            continue;
        for (uint32_t n = 0; n < plane->file->segment_count && st == CW_OK; n++)
            st = add_segment(&scan->segments[plane->index][n], layer_of, table, err);
    }
    return st;
}
