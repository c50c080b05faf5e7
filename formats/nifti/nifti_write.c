/* Writes NIfTI-1, or NIfTI-2 when a size needs more than 16 bits. The frame goes into the
 * sform. */
#include "formats/nifti/nifti.h"
#include "formats/nifti/nifti_format.h"
#include "formats/volume/voxel_source.h"

#include <string.h>

enum { MAX_BYTES = 544, SPACE_MM = 2, TIME_SECONDS = 8, INTENT_VECTOR = 1007 };

/* A header that is being filled in. */
typedef struct header {
    unsigned char bytes[MAX_BYTES];
    const cwi_nifti_layout *layout;
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

/* Fills the header. The four bytes between header and voxels are zero: no extensions. */
static void fill_header(header *h, const cwi_save *save)
{
    *h = (header){.layout = choose_layout(save->volume)};
    put_field(h, CWI_NIFTI_SIZEOF_HDR, 0, (double)h->layout->bytes);
    put_field(h, CWI_NIFTI_VOX_OFFSET, 0, (double)h->layout->voxels);
    memcpy(h->bytes + h->layout->magic, h->layout->one_file, h->layout->magic_bytes);
    memcpy(h->bytes + h->layout->descrip, save->name, strlen(save->name));
    put_shape(h, save->volume);
    put_frame(h, save->volume);
}

cw_status cwi_nifti_save(const cwi_save *save, cw_error *err)
{
    header h;
    cwi_sink sink = {0};
    fill_header(&h, save);
    cw_status st = cwi_sink_open(&sink, save->file, save->gzip ? CWI_GZIP : CWI_STORED, err);
    if (st == CW_OK)
        st = cwi_sink_write(&sink, h.bytes, h.layout->voxels, err);
    if (st == CW_OK)
        st = cwi_save_voxels(save, true, &sink, err);
    cwi_sink_close(&sink);
    return st;
}
