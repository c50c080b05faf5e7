#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/volume/volume.h"
#include "formats/format_registry.h"
#include "formats/volume/volume_writer.h"

#include <string.h>

/* One row per writer. has_scaling: slope and intercept have a place in the header. */
typedef struct writer {
    const char *name, *extensions;
    bool has_scaling;
    cw_status (*save)(const cwi_save *save, cw_error *err);
} writer;

static const writer writers[] = {
    {"nrrd", ".nrrd", false, cwi_nrrd_save},
    {"nifti", ".nii .nii.gz", true, cwi_nifti_save},
    {"metaimage", ".mha", false, cwi_metaimage_save},
};
enum { WRITER_COUNT = sizeof writers / sizeof *writers };

/* --- voxels ------------------------------------------------------------------------------ */

/* One row of voxels without gaps: where it stands already, or gathered into a buffer. */
typedef struct rows {
    const cw_volume *volume;
    size_t components; /* per voxel of the row */
    size_t bytes;
    unsigned char *buffer; /* NULL: rows stand packed in the volume */
} rows;

static cw_status rows_open(rows *r, const cw_volume *v, bool components_last, cw_error *err)
{
    const size_t size = cw_type_size(v->type);
    *r = (rows){.volume = v, .components = components_last ? 1 : v->components};
    r->bytes = v->dim[0] * r->components * size;
    if (v->stride[0] == (ptrdiff_t)(r->components * size) &&
        (r->components == 1 || v->component_stride == (ptrdiff_t)size))
        return CW_OK;
    r->buffer = cwi_alloc_array(r->bytes, 1);
    return r->buffer
               ? CW_OK
               : cw_fail(err, CW_ERR_NO_MEMORY, "no memory for %zu bytes of voxels", r->bytes);
}

static const void *gather_row(const rows *r, const char *first)
{
    const cw_volume *v = r->volume;
    const size_t size = cw_type_size(v->type);
    unsigned char *to = r->buffer;
    if (!to)
        return first;
    for (size_t i = 0; i < v->dim[0]; i++)
        for (size_t c = 0; c < r->components; c++, to += size)
            memcpy(to, first + (ptrdiff_t)i * v->stride[0] + (ptrdiff_t)c * v->component_stride,
                   size);
    return r->buffer;
}

static cw_status save_slice(const rows *r, const char *first, cwi_sink *sink, cw_error *err)
{
    cw_status st = CW_OK;
    for (size_t j = 0; st == CW_OK && j < r->volume->dim[1]; j++)
        st = cwi_sink_write(sink, gather_row(r, first + (ptrdiff_t)j * r->volume->stride[1]),
                            r->bytes, err);
    return st;
}

cw_status cwi_save_voxels(const cwi_save *save, bool components_last, cwi_sink *sink,
                          cw_error *err)
{
    const cw_volume *v = save->volume;
    const char *step = sink->file ? "writing" : "measuring";
    const size_t outer = components_last ? v->components : 1;
    const size_t slices = outer * v->steps * v->dim[2];
    rows r;
    cw_status st = rows_open(&r, v, components_last, err);
    for (size_t s = 0; st == CW_OK && s < slices; s++) {
        const size_t k = s % v->dim[2], t = s / v->dim[2] % v->steps,
                     c = s / v->dim[2] / v->steps;
        const char *first = (const char *)v->data + (ptrdiff_t)k * v->stride[2] +
                            (ptrdiff_t)t * v->step_stride + (ptrdiff_t)c * v->component_stride;
        st = cwi_progress(save->progress, step, (double)s / (double)slices, err);
        if (st == CW_OK)
            st = save_slice(&r, first, sink, err);
    }
    if (st == CW_OK)
        st = cwi_sink_finish(sink, err);
    cwi_free(r.buffer);
    return st;
}

/* --- which writer ------------------------------------------------------------------------ */

static cw_status find_writer(const char *path, const char *format, const writer **found,
                             cw_error *err)
{
    *found = NULL;
    for (size_t i = 0; i < WRITER_COUNT; i++)
        if (format ? strcmp(writers[i].name, format) == 0
                   : cwi_has_extension(path, writers[i].extensions))
            *found = &writers[i];
    if (*found)
        return CW_OK;
    if (format)
        return cw_fail(err, CW_ERR_ARGUMENT,
                       "there is no writer '%s' of volumes; there are nrrd, nifti, metaimage",
                       format);
    return cw_fail(
        err, CW_ERR_ARGUMENT,
        "no writer of volumes has this extension; there are .nrrd, .nii, .nii.gz, .mha");
}

static cw_status check_scaling(const writer *w, const cw_volume *v, cw_error *err)
{
    if (w->has_scaling || (v->slope == 1 && v->intercept == 0))
        return CW_OK;
    return cw_fail(err, CW_ERR_ARGUMENT,
                   "%s has no place for slope %g and intercept %g; .nii has", w->name, v->slope,
                   v->intercept);
}

/* The name as one short line: the stem of the path when the caller has none. */
static void make_name(const char *path, const char *name, char out[80])
{
    const char *slash = strrchr(path, '/');
    const char *text = name ? name : slash ? slash + 1 : path;
    const char *dot = name ? NULL : strchr(text + (*text == '.'), '.');
    const size_t length = dot ? (size_t)(dot - text) : strlen(text);
    const size_t kept = length < 79 ? length : 79;
    for (size_t i = 0; i < kept; i++)
        out[i] = text[i];
    for (size_t i = 0; i < kept; i++)
        if ((unsigned char)out[i] < ' ')
            out[i] = ' ';
    out[kept] = '\0';
}

static cw_status write_file(const char *path, const writer *w, const cw_write_desc *desc,
                            cwi_save *save, cw_error *err)
{
    char name[80];
    make_name(path, desc->name, name);
    save->name = name;
    save->gzip = cwi_has_extension(path, ".gz");
    save->progress = &desc->progress;
    cw_status st = cwi_outfile_open(&save->file, path, desc->no_clobber, err);
    if (st == CW_OK)
        st = w->save(save, err);
    if (st == CW_OK)
        st = cwi_progress(save->progress, "writing", 1, err);
    if (st == CW_OK)
        st = cwi_outfile_commit(&save->file, err);
    cwi_outfile_abort(&save->file);
    return st;
}

cw_status cw_volume_write(const char *path, const cw_volume *volume, const cw_write_desc *desc,
                          cw_error *err)
{
    const cw_write_desc defaults = {0};
    const writer *w;
    cw_volume v;
    cwi_save save = {.volume = &v};
    if (!desc)
        desc = &defaults;
    cw_status st = find_writer(path, desc->format, &w, err);
    if (st == CW_OK && desc->local)
        st = cw_fail(err, CW_ERR_ARGUMENT, "a volume has no local form: its frame stays");
    if (st == CW_OK && (desc->text || desc->axes.unit || desc->axes.ras || desc->axes.y_up))
        st = cw_fail(err, CW_ERR_ARGUMENT, "text, unit and frame are chosen for meshes only");
    if (st == CW_OK)
        st = cw_volume_resolve(volume, &v, err);
    if (st == CW_OK)
        st = cwi_volume_expect_even(&v, "writing a volume", err);
    if (st == CW_OK)
        st = check_scaling(w, &v, err);
    if (st == CW_OK)
        st = write_file(path, w, desc, &save, err);
    return st == CW_OK ? CW_OK : cwi_fail_in(err, st, path);
}
