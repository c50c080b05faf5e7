#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/volume/volume.h"
#include "formats/bytes/file_pattern.h"
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
