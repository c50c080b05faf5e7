/* Reads meshes: finds the reader by name, content or extension. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "formats/bytes/file_pattern.h"
#include "formats/format_lookup.h"
#include "formats/mesh/picture_store.h"
#include "formats/mesh/place_parts.h"
#include "formats/volume/frame_claim.h"
#include "formats/volume/volume_reader.h"
#include "formats/vtk/pvd.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

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

/* Returns the number of objects; the last one may have no triangles. */
static size_t count_marks(const cwi_marks *marks, const cw_mesh *mesh)
{
    size_t count = 0;
    for (size_t n = 0; n < marks->count; n++)
        count += marks->items[n].triangle < mesh->triangle_count &&
                 (n == 0 || marks->items[n].object != marks->items[n - 1].object);
    return count;
}

static cw_status read_open_file(cwi_mesh_input *in, cw_mesh *mesh, cw_mesh_file *metadata,
                                cw_error *err)
{
    const cwi_format_driver *found = NULL;
    cw_status st = in->desc.reader ? cwi_mesh_reader_by_name(in->desc.reader, &found, err)
                                   : cwi_mesh_reader_of(&in->file, &found, err);
    if (st != CW_OK)
        return st;
    *metadata = (cw_mesh_file){.format = found->name, .parts = 1};
    st = found->mesh.read(in, mesh, metadata, err);
    if (st == CW_OK)
        drop_broken_normals(mesh);
    if (st == CW_OK)
        st = cwi_claim_mesh(&in->desc.claim, metadata, mesh, err);
    if (st == CW_OK)
        st = cwi_turn_back(mesh, &metadata->axes, err);
    const size_t parts = count_marks(&in->marks, mesh);
    if (metadata->parts < parts)
        metadata->parts = parts;
    return st;
}

/* Reads the mesh, and leaves the marks of its parts for the caller to free. */
static cw_status read_file(const char *path, cwi_mesh_input *in, cw_mesh *mesh,
                           cw_mesh_file *metadata, cw_error *err)
{
    memset(mesh, 0, sizeof *mesh);
    const cw_stored_file *stored = in->desc.stored;
    cw_status st = stored ? cwi_input_open_stored(&in->file, stored, err)
                          : cwi_input_open(&in->file, path, err);
    in->file.allow_external = in->desc.allow_external;
    if (st == CW_OK)
        st = read_open_file(in, mesh, metadata, err);
    cwi_input_close(&in->file);
    cwi_say_left_out(metadata, in->pictures.is_missing,
                     "pictures of missing files or outside the folder");
    if (st != CW_OK)
        cw_mesh_free(mesh);
    return st;
}

static void free_marks(cwi_mesh_input *in)
{
    cwi_free(in->marks.items);
    cwi_free(in->marks.names);
    cw_label_table_free(&in->labels);
    cwi_pictures_free(&in->pictures);
}

cw_status cw_mesh_read(const char *path, const cw_mesh_read_desc *desc, cw_mesh *mesh,
                       cw_mesh_file *file, cw_error *err)
{
    path = cwi_input_name(path, desc ? desc->stored : NULL);
    CWI_REQUIRE(err, path, mesh);
    CWI_REQUIRE_VERSION(err, desc, 0);
    cwi_mesh_input in = {.desc = resolve_desc(desc)};
    cw_mesh_file metadata = {0};
    cw_status st = read_file(path, &in, mesh, &metadata, err);
    if (st == CW_OK)
        st = cwi_parts_label(&in, mesh, err);
    free_marks(&in);
    if (file)
        *file = metadata;
    return st == CW_OK ? CW_OK : cwi_fail_in(err, st, path);
}

cw_status cw_parts_read(const char *path, const cw_mesh_read_desc *desc, cw_part **parts,
                        size_t *count, cw_mesh_file *file, cw_error *err)
{
    path = cwi_input_name(path, desc ? desc->stored : NULL);
    CWI_REQUIRE(err, path, parts, count);
    CWI_REQUIRE_VERSION(err, desc, 0);
    cwi_mesh_input in = {.desc = resolve_desc(desc), .pictures.is_wanted = true};
    cw_mesh_file metadata = {0};
    cw_mesh mesh;
    *parts = NULL;
    *count = 0;
    cw_status st = read_file(path, &in, &mesh, &metadata, err);
    if (st == CW_OK)
        st = cwi_parts_split(&in, &mesh, parts, count, err);
    cw_mesh_free(&mesh);
    free_marks(&in);
    if (file)
        *file = metadata;
    return st == CW_OK ? CW_OK : cwi_fail_in(err, st, path);
}
