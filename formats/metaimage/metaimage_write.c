/* Writes MetaImage: one file, compressed by zlib. */
#include "formats/bytes/byte_order.h"
#include "formats/metaimage/metaimage_format.h"

static const char *const types[CW_TYPE_COUNT] = {
    [CW_U8] = "MET_UCHAR",  [CW_I8] = "MET_CHAR",    [CW_U16] = "MET_USHORT",
    [CW_I16] = "MET_SHORT", [CW_U32] = "MET_UINT",   [CW_I32] = "MET_INT",
    [CW_F32] = "MET_FLOAT", [CW_F64] = "MET_DOUBLE",
};

/* Measures the compressed size, which the header states before the data. Files are written
 * front to back, so the voxels are compressed twice, the first time only for counting. */
static cw_status measure_deflated(const cwi_save *save, uint64_t *bytes, cw_error *err)
{
    cwi_sink sink = {0};
    cw_status st = cwi_sink_open(&sink, NULL, CWI_ZLIB, err);
    if (st == CW_OK)
        st = cwi_save_voxels(save, false, &sink, err);
    *bytes = sink.written;
    cwi_sink_close(&sink);
    return st;
}

/* Writes the numbers of a key for each axis; time has its own after the three of space. */
static cw_status write_numbers(const cwi_save *save, const char *key, const double space[3],
                               double time, cw_error *err)
{
    cw_status st = cwi_outfile_printf(save->file, err, "%s = %.17g %.17g %.17g", key, space[0],
                                      space[1], space[2]);
    if (st == CW_OK && save->volume->steps > 1)
        st = cwi_outfile_printf(save->file, err, " %.17g", time);
    return st == CW_OK ? cwi_outfile_printf(save->file, err, "\n") : st;
}

/* Writes the matrix: one row per axis, its direction. */
static cw_status write_matrix(const cwi_save *save, const double spacing[3], cw_error *err)
{
    const cw_volume *v = save->volume;
    const bool time = v->steps > 1;
    cw_status st = cwi_outfile_printf(save->file, err, "TransformMatrix =");
    for (int c = 0; st == CW_OK && c < 3; c++)
        st = cwi_outfile_printf(save->file, err, " %.17g %.17g %.17g%s",
                                v->affine[0][c] / spacing[c], v->affine[1][c] / spacing[c],
                                v->affine[2][c] / spacing[c], time ? " 0" : "");
    return st == CW_OK ? cwi_outfile_printf(save->file, err, "%s\n", time ? " 0 0 0 1" : "")
                       : st;
}

static cw_status write_frame(const cwi_save *save, cw_error *err)
{
    const cw_volume *v = save->volume;
    const double origin[3] = {v->affine[0][3], v->affine[1][3], v->affine[2][3]};
    double spacing[3];
    cw_volume_spacing(v, spacing);
    cw_status st = write_matrix(save, spacing, err);
    if (st == CW_OK)
        st = write_numbers(save, "Offset", origin, 0, err);
    if (st == CW_OK)
        st = write_numbers(save, "ElementSpacing", spacing,
                           v->step_seconds > 0 ? v->step_seconds : 1, err);
    return st;
}

static cw_status write_header(const cwi_save *save, uint64_t compressed, cw_error *err)
{
    const cw_volume *v = save->volume;
    cw_status st = cwi_outfile_printf(
        save->file, err,
        "ObjectType = Image\nNDims = %d\nName = %s\nBinaryData = True\n"
        "BinaryDataByteOrderMSB = %s\nCompressedData = True\nCompressedDataSize = %llu\n",
        v->steps > 1 ? 4 : 3, save->name, cwi_machine_is_big_endian() ? "True" : "False",
        (unsigned long long)compressed);
    if (st == CW_OK)
        st = write_frame(save, err);
    if (st == CW_OK)
        st = cwi_outfile_printf(save->file, err, "DimSize = %zu %zu %zu", v->dim[0], v->dim[1],
                                v->dim[2]);
    if (st == CW_OK && v->steps > 1)
        st = cwi_outfile_printf(save->file, err, " %zu", v->steps);
    if (st == CW_OK && v->components > 1)
        st = cwi_outfile_printf(save->file, err, "\nElementNumberOfChannels = %zu",
                                v->components);
    if (st == CW_OK)
        st = cwi_outfile_printf(
            save->file, err, "\nElementType = %s\nElementDataFile = LOCAL\n", types[v->type]);
    return st;
}

cw_status cwi_metaimage_save(const cwi_save *save, cw_error *err)
{
    cwi_sink sink = {0};
    uint64_t compressed = 0;
    cw_status st = measure_deflated(save, &compressed, err);
    if (st == CW_OK)
        st = write_header(save, compressed, err);
    if (st == CW_OK)
        st = cwi_sink_open(&sink, save->file, CWI_ZLIB, err);
    if (st == CW_OK)
        st = cwi_save_voxels(save, false, &sink, err);
    cwi_sink_close(&sink);
    return st;
}
