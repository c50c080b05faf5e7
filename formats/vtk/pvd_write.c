/* Writes ParaView's list of the files of a time series (.pvd), with relative names. */
#define _GNU_SOURCE /* realpath */
#include <cubewright/formats.h>

#include "core/base/status.h"
#include "core/files/atomic_file.h"
#include "formats/text/number_format.h"
#include "formats/text/xml.h"

#include <limits.h>
#include <math.h>
#include <stdlib.h>

/* Resolves a path to an absolute one; its folder must exist. */
static cw_status resolve_path(const char *path, char full[PATH_MAX], cw_error *err)
{
    char folder[PATH_MAX];
    const char *slash = strrchr(path, '/'), *name = slash ? slash + 1 : path;
    const size_t length = (size_t)(name - path);
    if (length >= sizeof folder || !*name)
        return cwi_fail(err, CW_ERR_ARGUMENT, "'%.200s' is not a file name", path);
    memcpy(folder, path, length);
    strcpy(folder + length, length ? "" : ".");
    const bool found = realpath(folder, full);
    const size_t used = found ? strlen(full) : 0;
    if (!found || used + strlen(name) + 2 > PATH_MAX)
        return cwi_fail(err, CW_ERR_ARGUMENT, "the folder of '%.200s' is not there", path);
    strcpy(full + used, used > 1 ? "/" : "");
    strcat(full, name);
    return CW_OK;
}

/* Computes the path of a file relative to the folder of another one; both paths are
 * absolute. */
static cw_status relate_path(const char *from, const char *file, char related[PATH_MAX],
                             cw_error *err)
{
    size_t shared = 0, used = 0;
    for (size_t i = 0; from[i] && from[i] == file[i]; i++)
        shared = from[i] == '/' ? i + 1 : shared;
    for (const char *slash = strchr(from + shared, '/'); slash;
         slash = strchr(slash + 1, '/')) {
        if (used + 4 > PATH_MAX)
            return cwi_fail(err, CW_ERR_ARGUMENT, "it is too far from '%.200s'", file);
        memcpy(related + used, "../", 3);
        used += 3;
    }
    if (used + strlen(file + shared) >= PATH_MAX)
        return cwi_fail(err, CW_ERR_ARGUMENT, "it is too far from '%.200s'", file);
    strcpy(related + used, file + shared);
    return CW_OK;
}

static cw_status write_entry(cwi_outfile *file, const char *path, const cw_pvd_entry *e,
                             size_t part, cw_error *err)
{
    char full[PATH_MAX], related[PATH_MAX], escaped[CWI_XML_BYTES(PATH_MAX)];
    char time[CWI_NUMBER_BYTES];
    if (!isfinite(e->time))
        return cwi_fail(err, CW_ERR_ARGUMENT, "the time of '%.200s' is not finite", e->path);
    cw_status st = resolve_path(e->path, full, err);
    if (st == CW_OK)
        st = relate_path(path, full, related, err);
    if (st != CW_OK)
        return st;
    cwi_xml_escape(related, escaped, sizeof escaped);
    cwi_print_number(e->time, time);
    return cwi_outfile_printf(
        file, err, "<DataSet timestep=\"%s\" group=\"\" part=\"%zu\" file=\"%s\"/>\n", time,
        part, escaped);
}

static cw_status write_entries(cwi_outfile *file, const char *path, const cw_pvd_entry *entries,
                               size_t count, cw_error *err)
{
    char full[PATH_MAX];
    size_t part = 0;
    cw_status st = resolve_path(path, full, err);
    if (st == CW_OK)
        st = cwi_outfile_printf(file, err,
                                "<?xml version=\"1.0\"?>\n<!-- cubewright %s -->\n"
                                "<VTKFile type=\"Collection\" version=\"0.1\" "
                                "byte_order=\"LittleEndian\">\n<Collection>\n",
                                CW_VERSION);
    for (size_t i = 0; i < count && st == CW_OK; i++) {
        part = i > 0 && entries[i].time == entries[i - 1].time ? part + 1 : 0;
        st = write_entry(file, full, &entries[i], part, err);
    }
    return st == CW_OK ? cwi_outfile_printf(file, err, "</Collection>\n</VTKFile>\n") : st;
}

cw_status cw_pvd_write(const char *path, const cw_pvd_entry *entries, size_t count,
                       const cw_write_desc *desc, cw_error *err)
{
    CWI_REQUIRE(err, path);
    CWI_REQUIRE_VERSION(err, desc, 0);
    CWI_REQUIRE_ARRAY(err, entries, count);
    cwi_outfile *file = NULL;
    cw_status st = count ? CW_OK : cwi_fail(err, CW_ERR_ARGUMENT, "the series has no files");
    if (st == CW_OK)
        st = cwi_outfile_open(&file, path, desc && desc->no_clobber, err);
    if (st == CW_OK)
        st = write_entries(file, path, entries, count, err);
    if (st == CW_OK)
        st = cwi_outfile_commit(&file, err);
    cwi_outfile_abort(&file);
    return st == CW_OK ? CW_OK : cwi_fail_in(err, st, path);
}
