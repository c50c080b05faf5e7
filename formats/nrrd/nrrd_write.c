/* Writes NRRD: one gzipped file; doubles are written so that they read back to the bit. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/base/text.h"
#include "formats/bytes/byte_order.h"
#include "formats/nrrd/nrrd_format.h"

#include <stdlib.h>

static const char *const types[CW_TYPE_COUNT] = {
    [CW_U8] = "uint8",   [CW_I8] = "int8",   [CW_U16] = "uint16", [CW_I16] = "int16",
    [CW_U32] = "uint32", [CW_I32] = "int32", [CW_F32] = "float",  [CW_F64] = "double",
};

/* Starts a line with a word per axis: one for the values, where voxels have several, then one
 * for each axis of space. The caller adds the word for time. */
static cw_status start_axes(const cwi_save *save, const char *field, const char *values,
                            const char *space, cw_error *err)
{
    const bool several = save->volume->components > 1;
    return cwi_outfile_printf(save->file, err, "%s:%s%s %s %s %s", field, several ? " " : "",
                              several ? values : "", space, space, space);
}

static cw_status write_sizes(const cwi_save *save, cw_error *err)
{
    const cw_volume *v = save->volume;
    const int dimension = 3 + (v->components > 1) + (v->steps > 1);
    cw_status st = cwi_outfile_printf(save->file, err, "dimension: %d\nsizes:", dimension);
    if (st == CW_OK && v->components > 1)
        st = cwi_outfile_printf(save->file, err, " %zu", v->components);
    if (st == CW_OK)
        st = cwi_outfile_printf(save->file, err, " %zu %zu %zu", v->dim[0], v->dim[1],
                                v->dim[2]);
    if (st == CW_OK && v->steps > 1)
        st = cwi_outfile_printf(save->file, err, " %zu", v->steps);
    return st == CW_OK ? cwi_outfile_printf(save->file, err, "\n") : st;
}

static cw_status write_vector(const cwi_save *save, int column, cw_error *err)
{
    const cw_volume *v = save->volume;
    return cwi_outfile_printf(save->file, err, " (%.17g,%.17g,%.17g)", v->affine[0][column],
                              v->affine[1][column], v->affine[2][column]);
}

static cw_status write_directions(const cwi_save *save, cw_error *err)
{
    const cw_volume *v = save->volume;
    cw_status st = cwi_outfile_printf(save->file, err, "space directions:%s",
                                      v->components > 1 ? " none" : "");
    for (int c = 0; st == CW_OK && c < 3; c++)
        st = write_vector(save, c, err);
    if (st == CW_OK)
        st = cwi_outfile_printf(save->file, err,
                                "%s\nspace origin:", v->steps > 1 ? " none" : "");
    if (st == CW_OK)
        st = write_vector(save, 3, err);
    return st == CW_OK ? cwi_outfile_printf(save->file, err, "\n") : st;
}

static cw_status write_frame(const cwi_save *save, cw_error *err)
{
    const cw_volume *v = save->volume;
    cw_status st = cwi_outfile_printf(
        save->file, err, "%s\n",
        v->known & CW_KNOWN_FRAME ? "space: left-posterior-superior" : "space dimension: 3");
    if (st == CW_OK)
        st = write_directions(save, err);
    if (st == CW_OK && v->known & CW_KNOWN_UNIT)
        st = cwi_outfile_printf(save->file, err, "space units: \"mm\" \"mm\" \"mm\"\n");
    return st;
}

/* Writes spacings and units of time. They are allowed for axes that have no direction. */
static cw_status write_time(const cwi_save *save, cw_error *err)
{
    const cw_volume *v = save->volume;
    if (v->steps < 2 || !(v->step_seconds > 0))
        return CW_OK;
    cw_status st = start_axes(save, "spacings", "nan", "nan", err);
    if (st == CW_OK)
        st = cwi_outfile_printf(save->file, err, " %.17g\n", v->step_seconds);
    if (st == CW_OK)
        st = start_axes(save, "units", "\"\"", "\"\"", err);
    return st == CW_OK ? cwi_outfile_printf(save->file, err, " \"s\"\n") : st;
}

/* Writes a name; a backslash and what would end the line are escaped. */
static cw_status write_name(const cwi_save *save, uint32_t number, const cw_label *label,
                            cw_error *err)
{
    char *text;
    size_t size;
    FILE *out = cwi_text_open(&text, &size);
    for (const char *s = label->name; out && *s; s++)
        if (*s == '\\')
            fputs("\\\\", out);
        else
            fputc((unsigned char)*s < ' ' ? ' ' : *s, out);
    if (!cwi_text_close(out, &text))
        return cwi_fail_memory(err);
    const cw_status st =
        cwi_outfile_printf(save->file, err, "Segment%u_Name:=%s\n", (unsigned)number, text);
    free(text);
    return st;
}

/* Writes the names and colours of labels as 3D Slicer does, in the order of the table. */
static cw_status write_segments(const cwi_save *save, cw_error *err)
{
    cw_status st = CW_OK;
    for (uint32_t n = 0; save->labels && n < save->labels->count && st == CW_OK; n++) {
        const cw_label *label = &save->labels->labels[n];
        const uint8_t *c = label->color;
        st = cwi_outfile_printf(save->file, err,
                                "Segment%u_ID:=Segment_%u\nSegment%u_LabelValue:=%u\n"
                                "Segment%u_Layer:=%u\n",
                                n, label->value, n, label->value, n, label->layer);
        if (st == CW_OK && label->name)
            st = write_name(save, n, label, err);
        if (st == CW_OK && label->has_color)
            st = cwi_outfile_printf(save->file, err, "Segment%u_Color:=%.6g %.6g %.6g\n", n,
                                    c[0] / 255.0, c[1] / 255.0, c[2] / 255.0);
    }
    return st;
}

static cw_status write_header(const cwi_save *save, cw_error *err)
{
    cw_status st = cwi_outfile_printf(save->file, err, "NRRD0005\ncontent: %s\ntype: %s\n",
                                      save->name, types[save->volume->type]);
    if (st == CW_OK)
        st = write_sizes(save, err);
    if (st == CW_OK)
        st = write_frame(save, err);
    if (st == CW_OK)
        st = start_axes(save, "kinds", "vector", "domain", err);
    if (st == CW_OK)
        st =
            cwi_outfile_printf(save->file, err, "%s\n", save->volume->steps > 1 ? " time" : "");
    if (st == CW_OK)
        st = write_time(save, err);
    if (st == CW_OK)
        st = cwi_outfile_printf(save->file, err, "endian: %s\nencoding: gzip\n",
                                cwi_machine_is_big_endian() ? "big" : "little");
    if (st == CW_OK)
        st = write_segments(save, err);
    return st == CW_OK ? cwi_outfile_printf(save->file, err, "\n") : st;
}

cw_status cwi_nrrd_save(const cwi_save *save, cw_error *err)
{
    cwi_sink sink = {0};
    cw_status st = write_header(save, err);
    if (st == CW_OK)
        st = cwi_sink_open(&sink, save->file, CWI_GZIP, err);
    if (st == CW_OK)
        st = cwi_save_voxels(save, false, &sink, err);
    cwi_sink_close(&sink);
    return st;
}
