/* Reads meshes: finds the reader by name, content or extension. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "formats/bytes/file_pattern.h"
#include "formats/format_registry.h"
#include "formats/mesh/place_parts.h"
#include "formats/volume/frame_claim.h"
#include "formats/volume/volume_reader.h"
#include "formats/vtk/pvd.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const char *reader_name(const cwi_format_driver *f)
{
    return f->mesh.read ? f->name : NULL;
}

static const char *list_readers(char list[CWI_FORMAT_LIST])
{
    return cwi_list_formats(reader_name, ", ", list);
}

static cw_status find_by_name(const char *name, const cwi_format_driver **found, cw_error *err)
{
    char names[CWI_FORMAT_LIST];
    *found = cwi_find_format(name);
    if (*found && (*found)->mesh.read)
        return CW_OK;
    return cwi_fail(err, CW_ERR_ARGUMENT, "there is no mesh reader '%s'; there are %s", name,
                    list_readers(names));
}

static const cwi_format_driver *find_by_content(const unsigned char *head, size_t size,
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

static const cwi_format_driver *find_by_extension(const char *path)
{
    for (size_t n = 0; cwi_format_at(n); n++)
        if (cwi_format_at(n)->mesh.read &&
            cwi_has_extension(path, cwi_format_at(n)->extensions))
            return cwi_format_at(n);
    return NULL;
}

const char *cwi_mesh_format_by_content(const unsigned char *head, size_t size,
                                       uint64_t file_size)
{
    const cwi_format_driver *found = find_by_content(head, size, file_size);
    return found ? found->name : NULL;
}

const char *cwi_mesh_format_by_extension(const char *path)
{
    const cwi_format_driver *found = find_by_extension(path);
    return found ? found->name : NULL;
}

static cw_status find_by_file(const cwi_input *in, const cwi_format_driver **found,
                              cw_error *err)
{
    unsigned char head[CWI_SNIFF_BYTES];
    char names[CWI_FORMAT_LIST];
    size_t size;
    cw_status st = cwi_input_read_at(in->fd, 0, head, sizeof head, &size, err);
    if (st != CW_OK)
        return st;
    *found = find_by_content(head, size, in->size);
    if (!*found)
        *found = find_by_extension(in->path);
    if (*found)
        return CW_OK;
    if (cwi_pvd_sniff(head, size))
        return cwi_fail(err, CW_ERR_FORMAT,
                        "this is a list of the files of a time series (pvd); here one of the "
                        "meshes that it lists is expected");
    const char *volume = cwi_volume_format_of(in);
    if (volume)
        return cwi_fail(err, CW_ERR_FORMAT,
                        "this is a volume (%s), not a mesh; 'extract' makes a mesh of it",
                        volume);
    return cwi_fail(err, CW_ERR_FORMAT,
                    "neither content nor extension is of a mesh format that is read (%s)",
                    list_readers(names));
}

static cw_mesh_read_desc resolve_desc(const cw_mesh_read_desc *desc)
{
    cw_mesh_read_desc d = desc ? *desc : (cw_mesh_read_desc){0};
    if (d.max_triangles == 0 || d.max_triangles > UINT32_MAX)
        d.max_triangles = UINT32_MAX;
    return d;
}

/* Drops incomplete normals. Those of degenerate triangles are NaN in some files; half a set is
 * of no use. */
static void drop_broken_normals(cw_mesh *mesh)
{
    bool ok = true;
    for (size_t i = 0; mesh->normals && ok && i < 3 * mesh->vertex_count; i++)
        ok = isfinite(mesh->normals[i]);
    if (ok)
        return;
    cwi_free(mesh->normals);
    mesh->normals = NULL;
}

/* Returns the number of marks; the last one may have no triangles. */
static size_t count_marks(const cwi_marks *marks, const cw_mesh *mesh)
{
    const size_t n = marks->count;
    return n && marks->items[n - 1].triangle == mesh->triangle_count ? n - 1 : n;
}

static cw_status read_open_file(cwi_mesh_input *in, cw_mesh *mesh, cw_mesh_file *said,
                                cw_error *err)
{
    const cwi_format_driver *found = NULL;
    cw_status st = in->desc.reader ? find_by_name(in->desc.reader, &found, err)
                                   : find_by_file(&in->file, &found, err);
    if (st != CW_OK)
        return st;
    *said = (cw_mesh_file){.format = found->name, .parts = 1};
    st = found->mesh.read(in, mesh, said, err);
    if (st == CW_OK)
        drop_broken_normals(mesh);
    if (st == CW_OK)
        st = cwi_claim_mesh(&in->desc.claim, said, mesh, err);
    if (st == CW_OK)
        st = cwi_turn_back(mesh, &said->axes, err);
    const size_t parts = count_marks(&in->marks, mesh);
    if (said->parts < parts)
        said->parts = parts;
    return st;
}

/* Reads the mesh, and leaves the marks of its parts for the caller to free. */
static cw_status read_file(const char *path, cwi_mesh_input *in, cw_mesh *mesh,
                           cw_mesh_file *said, cw_error *err)
{
    memset(mesh, 0, sizeof *mesh);
    cw_status st = cwi_input_open(&in->file, path, err);
    in->file.allow_external = in->desc.allow_external;
    if (st == CW_OK)
        st = read_open_file(in, mesh, said, err);
    cwi_input_close(&in->file);
    if (st != CW_OK)
        cw_mesh_free(mesh);
    return st;
}

static void free_marks(cwi_marks *marks)
{
    cwi_free(marks->items);
    cwi_free(marks->names);
}

cw_status cw_mesh_read(const char *path, const cw_mesh_read_desc *desc, cw_mesh *mesh,
                       cw_mesh_file *file, cw_error *err)
{
    CWI_REQUIRE(err, path, mesh);
    CWI_REQUIRE_VERSION(err, desc, 0);
    cwi_mesh_input in = {.desc = resolve_desc(desc)};
    cw_mesh_file said = {0};
    cw_status st = read_file(path, &in, mesh, &said, err);
    free_marks(&in.marks);
    if (file)
        *file = said;
    return st == CW_OK ? CW_OK : cwi_fail_in(err, st, path);
}

cw_status cw_parts_read(const char *path, const cw_mesh_read_desc *desc, cw_part **parts,
                        size_t *count, cw_mesh_file *file, cw_error *err)
{
    CWI_REQUIRE(err, path, parts, count);
    CWI_REQUIRE_VERSION(err, desc, 0);
    cwi_mesh_input in = {.desc = resolve_desc(desc)};
    cw_mesh_file said = {0};
    cw_mesh mesh;
    *parts = NULL;
    *count = 0;
    cw_status st = read_file(path, &in, &mesh, &said, err);
    if (st == CW_OK)
        st = cwi_parts_split(&in, &mesh, parts, count, err);
    cw_mesh_free(&mesh);
    free_marks(&in.marks);
    if (file)
        *file = said;
    return st == CW_OK ? CW_OK : cwi_fail_in(err, st, path);
}
