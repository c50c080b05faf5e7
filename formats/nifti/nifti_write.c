/* Writes NIfTI-1, or NIfTI-2 when a size needs more than 16 bits. The frame goes into the
 * sform. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/base/text.h"
#include "formats/nifti/nifti.h"
#include "formats/nifti/nifti_format.h"
#include "formats/text/xml.h"
#include "formats/volume/voxel_source.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    MAX_BYTES = 544,
    SPACE_MM = 2,
    TIME_SECONDS = 8,
    INTENT_LABEL = 1002,
    INTENT_VECTOR = 1007,
    CODE_CARET = 30 /* of an extension: Connectome Workbench */
};

/* A header that is being filled in. */
typedef struct header {
    unsigned char bytes[MAX_BYTES];
    const cwi_nifti_layout *layout;
    char *labels;         /* an extension with names of labels, for free(); NULL: none */
    size_t labels_length; /* of the text */
} header;

static void put_field(header *h, cwi_nifti_field field, int index, double value)
{
    cwi_nifti_put(h->layout, h->bytes, field, index, value);
}

static const cwi_nifti_layout *choose_layout(const cw_volume *v)
{
    const size_t max = INT16_MAX;
    const bool large = v->dim[0] > max || v->dim[1] > max || v->dim[2] > max || v->steps > max;
    return &cwi_nifti_layouts[large];
}

static void put_shape(header *h, const cw_volume *v)
{
    const double dim[8] = {v->components > 1 ? 5
                           : v->steps > 1    ? 4
                                             : 3,
                           (double)v->dim[0],
                           (double)v->dim[1],
                           (double)v->dim[2],
                           (double)v->steps,
                           (double)v->components,
                           1,
                           1};
    put_field(h, CWI_NIFTI_DATATYPE, 0, cwi_nifti_datatype(v->type));
    put_field(h, CWI_NIFTI_BITPIX, 0, 8.0 * (double)cw_type_size(v->type));
    for (int d = 0; d < 8; d++)
        put_field(h, CWI_NIFTI_DIM, d, dim[d]);
    if (v->components > 1)
        put_field(h, CWI_NIFTI_INTENT_CODE, 0, INTENT_VECTOR);
    else if (v->known & CW_KNOWN_LABELS)
        put_field(h, CWI_NIFTI_INTENT_CODE, 0, INTENT_LABEL);
    put_field(h, CWI_NIFTI_SCL_SLOPE, 0, v->slope);
    put_field(h, CWI_NIFTI_SCL_INTER, 0, v->intercept);
}

/* Stores the frame. Code 1 is the scanner's frame, 2 a frame aligned to something. Code 2 is
 * used for an unknown frame, as NIfTI has no other way to keep it. */
static void put_frame(header *h, const cw_volume *v)
{
    double spacing[3], ras[3][4];
    memcpy(ras, v->affine, sizeof ras);
    cwi_flip_ras(ras);
    cw_volume_spacing(v, spacing);
    put_field(h, CWI_NIFTI_SFORM_CODE, 0, v->known & CW_KNOWN_FRAME ? 1 : 2);
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 4; c++)
            put_field(h, CWI_NIFTI_SROW, 4 * r + c, ras[r][c]);
    put_field(h, CWI_NIFTI_PIXDIM, 0, 1);
    for (int a = 0; a < 3; a++)
        put_field(h, CWI_NIFTI_PIXDIM, a + 1, spacing[a]);
    put_field(h, CWI_NIFTI_PIXDIM, 4, v->step_seconds);
    put_field(h, CWI_NIFTI_XYZT_UNITS, 0,
              (v->known & CW_KNOWN_UNIT ? SPACE_MM : 0) +
                  (v->step_seconds > 0 ? TIME_SECONDS : 0));
}

/* --- names of labels ---------------------------------------------------------------------- */

static bool print_label(const cw_label *label, FILE *out)
{
    uint8_t color[4];
    char name[32];
    snprintf(name, sizeof name, "%u", (unsigned)label->value);
    const char *text = label->name ? label->name : name;
    const size_t capacity = CWI_XML_BYTES(strlen(text)) + 1;
    char *escaped = cwi_alloc_array(capacity, 1);
    if (!escaped)
        return false;
    cwi_xml_escape(text, escaped, capacity);
    cw_label_color(label->value, color);
    const uint8_t *c = label->has_color ? label->color : color;
    fprintf(
        out,
        "<Label Key=\"%u\" Red=\"%.6g\" Green=\"%.6g\" Blue=\"%.6g\" Alpha=\"%.6g\">%s</Label>\n",
        (unsigned)label->value, c[0] / 255.0, c[1] / 255.0, c[2] / 255.0, c[3] / 255.0,
        escaped);
    cwi_free(escaped);
    return true;
}

/* Prints the table as Connectome Workbench does. */
static cw_status print_labels(header *h, const cw_label_table *table, cw_error *err)
{
    bool ok = true;
    if (!table)
        return CW_OK;
    FILE *out = cwi_text_open(&h->labels, &h->labels_length);
    if (out) {
        fputs("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<CaretExtension>\n"
              "<VolumeInformation Index=\"0\">\n<LabelTable>\n",
              out);
        for (size_t n = 0; n < table->count && ok; n++)
            ok = print_label(&table->labels[n], out);
        fputs("</LabelTable>\n<VolumeType>Label</VolumeType>\n</VolumeInformation>\n"
              "</CaretExtension>\n",
              out);
    }
    return cwi_text_close(out, &h->labels) && ok ? CW_OK : cwi_fail_memory(err);
}

/* Returns the bytes of the extension: its size, its code and the text, to a multiple of 16; 0: none. */
static size_t extension_bytes(const header *h)
{
    return h->labels ? (8 + h->labels_length + 15) / 16 * 16 : 0;
}

static cw_status write_labels(const header *h, cwi_sink *sink, cw_error *err)
{
    static const char zeros[16];
    const int32_t head[2] = {(int32_t)extension_bytes(h), CODE_CARET};
    if (!h->labels)
        return CW_OK;
    cw_status st = cwi_sink_write(sink, head, sizeof head, err);
    if (st == CW_OK)
        st = cwi_sink_write(sink, h->labels, h->labels_length, err);
    return st == CW_OK
               ? cwi_sink_write(sink, zeros,
                                extension_bytes(h) - sizeof head - h->labels_length, err)
               : st;
}

/* --- the file ----------------------------------------------------------------------------- */

/* Fills the header. Of the four bytes behind it the first tells if an extension follows. */
static void fill_header(header *h, const cwi_save *save)
{
    put_field(h, CWI_NIFTI_SIZEOF_HDR, 0, (double)h->layout->bytes);
    put_field(h, CWI_NIFTI_VOX_OFFSET, 0, (double)(h->layout->voxels + extension_bytes(h)));
    memcpy(h->bytes + h->layout->magic, h->layout->one_file, h->layout->magic_bytes);
    memcpy(h->bytes + h->layout->descrip, save->name, strlen(save->name));
    h->bytes[h->layout->voxels - 4] = h->labels != NULL;
    put_shape(h, save->volume);
    put_frame(h, save->volume);
}

cw_status cwi_nifti_save(const cwi_save *save, cw_error *err)
{
    header h = {.layout = choose_layout(save->volume)};
    cwi_sink sink = {0};
    cw_status st = print_labels(&h, save->labels, err);
    if (st == CW_OK) {
        fill_header(&h, save);
        st = cwi_sink_open(&sink, save->file, save->gzip ? CWI_GZIP : CWI_STORED, err);
    }
    if (st == CW_OK)
        st = cwi_sink_write(&sink, h.bytes, h.layout->voxels, err);
    if (st == CW_OK)
        st = write_labels(&h, &sink, err);
    if (st == CW_OK)
        st = cwi_save_voxels(save, true, &sink, err);
    cwi_sink_close(&sink);
    free(h.labels);
    return st;
}
