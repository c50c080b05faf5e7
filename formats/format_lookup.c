/* Finds the reader of a volume or a mesh: by name, by content or by extension. */
#include "formats/format_lookup.h"

#include "core/base/status.h"
#include "formats/bytes/file_pattern.h"
#include "formats/bytes/inflate_stream.h"
#include "formats/foreign_files.h"
#include "formats/raw/raw_format.h"
#include "formats/vtk/pvd.h"
#include "formats/vtk/vtk_formats.h"

/* --- by content and extension ------------------------------------------------------------- */

static const cwi_format_driver *find_mesh_by_content(const unsigned char *head, size_t size,
                                                     uint64_t file_size)
{
    for (int last = 0; last < 2; last++)
        for (size_t n = 0; cwi_format_at(n); n++) {
            const cwi_mesh_reading *mesh = &cwi_format_at(n)->mesh;
            if (mesh->sniff && mesh->sniffs_last == last && mesh->sniff(head, size, file_size))
                return cwi_format_at(n);
        }
    return NULL;
}

static const cwi_format_driver *find_mesh_by_extension(const char *path)
{
    for (size_t n = 0; cwi_format_at(n); n++)
        if (cwi_format_at(n)->mesh.read &&
            cwi_has_extension(path, cwi_format_at(n)->extensions))
            return cwi_format_at(n);
    return NULL;
}

/* --- volumes ------------------------------------------------------------------------------ */

static const char *volume_reader_name(const cwi_format_driver *f)
{
    return cwi_reads_volume(f) ? f->name : NULL;
}

static const char *list_volume_readers(char list[CWI_FORMAT_LIST])
{
    return cwi_list_formats(volume_reader_name, ", ", list);
}

cw_status cwi_volume_reader_by_name(const char *name, const cwi_format_driver **found,
                                    cw_error *err)
{
    char names[CWI_FORMAT_LIST];
    *found = cwi_find_format(name);
    if (*found == &cwi_format_raw)
        return cwi_fail(err, CW_ERR_ARGUMENT, "the reader 'raw' needs a layout");
    if (*found && cwi_reads_volume(*found))
        return CW_OK;
    return cwi_fail(err, CW_ERR_ARGUMENT, "there is no reader '%s'; there are %s", name,
                    list_volume_readers(names));
}

/* Reads the first bytes of a file. A gzip file that is damaged from the start has no content to
 * recognise. */
static cw_status read_head(const cwi_input *in, unsigned char *head, size_t *size,
                           bool *gzipped, cw_error *err)
{
    cw_status st = cwi_stream_head(in->fd, head, CWI_SNIFF_BYTES, size, gzipped, err);
    if (st != CW_ERR_FORMAT)
        return st;
    *size = 0;
    return CW_OK;
}

static bool sniffs_volume(const cwi_format_driver *f, const unsigned char *head, size_t size)
{
    return f->volume.sniff && f->volume.sniff(head, size);
}

/* Finds a reader by the content, or returns NULL. The meshes of VTK are no volumes, nor are lists. */
static const cwi_format_driver *find_volume_by_content(const unsigned char *head, size_t size,
                                                       bool gzipped)
{
    if (cwi_vtp_sniff(head, size, 0) || cwi_vtk_poly_sniff(head, size, 0) ||
        cwi_pvd_sniff(head, size))
        return NULL;
    for (size_t n = 0; cwi_format_at(n); n++)
        if ((cwi_format_at(n)->volume.gzipped || !gzipped) &&
            sniffs_volume(cwi_format_at(n), head, size))
            return cwi_format_at(n);
    return NULL;
}

static const cwi_format_driver *find_volume_by_extension(const char *path)
{
    for (size_t n = 0; cwi_format_at(n); n++)
        if (cwi_reads_volume(cwi_format_at(n)) &&
            cwi_has_extension(path, cwi_volume_extensions(cwi_format_at(n))))
            return cwi_format_at(n);
    return NULL;
}

static const char *volume_format_of(const cwi_input *in)
{
    unsigned char head[CWI_SNIFF_BYTES];
    size_t size;
    bool gzipped;
    const cwi_format_driver *found = NULL;
    if (read_head(in, head, &size, &gzipped, NULL) == CW_OK)
        found = find_volume_by_content(head, size, gzipped);
    if (!found)
        found = find_volume_by_extension(in->path);
    return found ? found->name : NULL;
}

static cw_status fail_mesh(const char *format, cw_error *err)
{
    return cwi_fail(err, CW_ERR_FORMAT,
                    "this is a mesh (%s), not a volume; use check, convert or simplify",
                    format);
}

cw_status cwi_volume_reader_of(const cwi_input *in, const cwi_format_driver **found,
                               cw_error *err)
{
    unsigned char head[CWI_SNIFF_BYTES];
    char names[CWI_FORMAT_LIST];
    size_t size;
    bool gzipped;
    cw_status st = read_head(in, head, &size, &gzipped, err);
    if (st == CW_OK)
        st = cwi_refuse_content(in, head, size, err);
    if (st != CW_OK)
        return st;
    *found = find_volume_by_extension(in->path);
    if (!*found || !(*found)->volume.is_store) /* files of stores are known by name alone */
        *found = find_volume_by_content(head, size, gzipped);
    const cwi_format_driver *mesh = *found ? NULL : find_mesh_by_content(head, size, in->size);
    if (!*found && !mesh)
        *found = find_volume_by_extension(in->path);
    if (*found)
        return CW_OK;
    if (cwi_pvd_sniff(head, size))
        return cwi_fail(err, CW_ERR_FORMAT,
                        "this is a list of the files of a time series (pvd); here one of the "
                        "volumes that it lists is expected");
    if (mesh || (mesh = find_mesh_by_extension(in->path)))
        return fail_mesh(mesh->name, err);
    const char *foreign = cwi_name_foreign(in->path, head, size);
    if (foreign)
        return cwi_fail(err, CW_ERR_UNSUPPORTED, "this is %s", foreign);
    return cwi_fail(
        err, CW_ERR_FORMAT,
        "neither content nor extension is of a format that is read (%s); a headerless "
        "file needs its layout stated (desc->raw)",
        list_volume_readers(names));
}

/* --- meshes ------------------------------------------------------------------------------- */

static const char *mesh_reader_name(const cwi_format_driver *f)
{
    return f->mesh.read ? f->name : NULL;
}

static const char *list_mesh_readers(char list[CWI_FORMAT_LIST])
{
    return cwi_list_formats(mesh_reader_name, ", ", list);
}

cw_status cwi_mesh_reader_by_name(const char *name, const cwi_format_driver **found,
                                  cw_error *err)
{
    char names[CWI_FORMAT_LIST];
    *found = cwi_find_format(name);
    if (*found && (*found)->mesh.read)
        return CW_OK;
    return cwi_fail(err, CW_ERR_ARGUMENT, "there is no mesh reader '%s'; there are %s", name,
                    list_mesh_readers(names));
}

cw_status cwi_mesh_reader_of(const cwi_input *in, const cwi_format_driver **found,
                             cw_error *err)
{
    unsigned char head[CWI_SNIFF_BYTES];
    char names[CWI_FORMAT_LIST];
    size_t size;
    cw_status st = cwi_input_read_at(in->fd, 0, head, sizeof head, &size, err);
    if (st == CW_OK)
        st = cwi_refuse_content(in, head, size, err);
    if (st != CW_OK)
        return st;
    *found = find_mesh_by_content(head, size, in->size);
    if (!*found)
        *found = find_mesh_by_extension(in->path);
    if (*found)
        return CW_OK;
    if (cwi_pvd_sniff(head, size))
        return cwi_fail(err, CW_ERR_FORMAT,
                        "this is a list of the files of a time series (pvd); here one of the "
                        "meshes that it lists is expected");
    const char *volume = volume_format_of(in);
    if (volume)
        return cwi_fail(err, CW_ERR_FORMAT,
                        "this is a volume (%s), not a mesh; 'extract' makes a mesh of it",
                        volume);
    const char *foreign = cwi_name_foreign(in->path, head, size);
    if (foreign)
        return cwi_fail(err, CW_ERR_UNSUPPORTED, "this is %s", foreign);
    return cwi_fail(err, CW_ERR_FORMAT,
                    "neither content nor extension is of a mesh format that is read (%s)",
                    list_mesh_readers(names));
}

const char *cwi_mesh_format_of(const char *path)
{
    unsigned char head[CWI_SNIFF_BYTES];
    cwi_input in;
    size_t size;
    const cwi_format_driver *found = NULL;
    if (cwi_input_open(&in, path, NULL) != CW_OK)
        return NULL;
    if (cwi_input_read_at(in.fd, 0, head, sizeof head, &size, NULL) == CW_OK &&
        !find_volume_by_content(head, size, false))
        found = find_mesh_by_content(head, size, in.size);
    cwi_input_close(&in);
    return found ? found->name : NULL;
}
