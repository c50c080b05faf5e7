/* Writes a volume: finds the writer, and gives it a file that appears when it is complete. */
#include "core/base/status.h"
#include "core/files/stored_file.h"
#include "core/volume/volume.h"
#include "formats/bytes/file_pattern.h"
#include "formats/format_registry.h"
#include "formats/volume/volume_writer.h"

#include <string.h>

typedef cwi_format_driver driver;

static bool is_wanted(const driver *f, const char *path, const char *format)
{
    return f->save.save && (format ? strcmp(f->name, format) == 0
                                   : cwi_has_extension(path, f->save.extensions));
}

const cw_format *cw_volume_format(const char *path, const char *name)
{
    size_t count;
    const cw_format *all = cw_formats(&count);
    for (size_t n = 0; (path || name) && cwi_format_at(n); n++)
        if (is_wanted(cwi_format_at(n), path, name))
            return n < count ? &all[n] : NULL;
    return NULL;
}

static const char *writer_name(const driver *f)
{
    return f->save.save ? f->name : NULL;
}

static const char *writer_extensions(const driver *f)
{
    return f->save.save ? f->save.extensions : NULL;
}

static cw_status find_writer(const char *path, const char *format, const driver **found,
                             cw_error *err)
{
    char list[CWI_FORMAT_LIST];
    for (size_t n = 0; (*found = cwi_format_at(n)) != NULL; n++)
        if (is_wanted(*found, path, format))
            return CW_OK;
    return format ? cwi_fail(err, CW_ERR_ARGUMENT,
                             "there is no writer '%s' of volumes; there are %s", format,
                             cwi_list_formats(writer_name, " ", list))
                  : cwi_fail(err, CW_ERR_ARGUMENT,
                             "no writer of volumes has this extension; there are %s",
                             cwi_list_formats(writer_extensions, " ", list));
}

static cw_status check_scaling(const driver *f, const cw_volume *v, cw_error *err)
{
    if (f->save.has_scaling || (v->slope == 1 && v->intercept == 0))
        return CW_OK;
    return cwi_fail(err, CW_ERR_ARGUMENT,
                    "%s has no place for slope %g and intercept %g; .nii has", f->name,
                    v->slope, v->intercept);
}

/* Makes the name one short line; without a name from the caller it is the stem of the path. */
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

static cw_status write_file(const char *path, const driver *f, const cw_write_desc *desc,
                            cwi_save *save, cw_error *err)
{
    char name[80];
    cwi_byte_output output = {.fd = -1};
    make_name(path, desc->name, name);
    save->name = name;
    save->gzip = cwi_has_extension(path, ".gz");
    save->progress = &desc->progress;
    save->labels = desc->labels && desc->labels->count ? desc->labels : NULL;
    cw_status st = desc->sink ? cwi_byte_output_open(&output, desc->sink, &save->file, err)
                              : cwi_outfile_open(&save->file, path, desc->no_clobber, err);
    if (st == CW_OK)
        st = f->save.save(save, err);
    if (st == CW_OK)
        st = cwi_progress(save->progress, "writing", 1, err);
    if (st == CW_OK)
        st = cwi_outfile_commit(&save->file, err);
    if (st == CW_OK && desc->sink)
        st = cwi_byte_output_deliver(&output, err);
    cwi_outfile_abort(&save->file);
    cwi_byte_output_close(&output);
    return st;
}

cw_status cw_volume_write(const char *path, const cw_volume *volume, const cw_write_desc *desc,
                          cw_error *err)
{
    const bool has_path = path || !desc || !desc->sink;
    const char *shown = has_path ? path : "(memory)";
    path = has_path ? path : "volume";
    CWI_REQUIRE(err, path, volume);
    CWI_REQUIRE_VERSION(err, desc, 0);
    const cw_write_desc defaults = {0};
    const driver *f;
    cw_volume v;
    cwi_save save = {.volume = &v};
    if (!desc)
        desc = &defaults;
    cw_status st = find_writer(path, desc->format, &f, err);
    if (st == CW_OK && desc->local)
        st = cwi_fail(err, CW_ERR_ARGUMENT, "a volume has no local form: its frame stays");
    if (st == CW_OK && (desc->text || desc->axes.unit || desc->axes.ras || desc->axes.y_up))
        st = cwi_fail(err, CW_ERR_ARGUMENT, "text, unit and frame are chosen for meshes only");
    if (st == CW_OK)
        st = cw_volume_resolve(volume, &v, err);
    if (st == CW_OK)
        st = cwi_volume_expect_even(&v, "writing a volume", err);
    if (st == CW_OK)
        st = check_scaling(f, &v, err);
    if (st == CW_OK)
        st = write_file(path, f, desc, &save, err);
    return st == CW_OK ? CW_OK : cwi_fail_in(err, st, shown);
}
