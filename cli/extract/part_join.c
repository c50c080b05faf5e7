/* Joins fragments: appends them to a spool in order, and writes its file. */
#include "cli/extract/part_join.h"

#include "cli/extract/small_components.h"
#include "cli/framework/console.h"
#include "core/base/memory.h"
#include "core/base/status.h"

#include <cubewright/spool.h>

#include <sys/stat.h>

/* Appends the fragments of all parts in order. `is_crossed`: they have samples on both sides. */
static cw_status append_parts(const char *folder, const cli_manifest *m, cw_mesh_spool *spool,
                              bool *is_crossed, cw_error *err)
{
    bool in = false, out = false;
    cw_status st = CW_OK;
    for (size_t part = 0; part < m->parts && st == CW_OK; part++) {
        char path[CLI_FRAGMENT_PATH];
        struct stat info;
        cw_fragment f;
        st = cli_name_fragment(folder, part, m->parts, path, err);
        if (st == CW_OK && stat(path, &info) != 0)
            st = cwi_fail(err, CW_ERR_IO,
                          "%s: part %zu of %zu is missing; 'extract --part %zu/%zu' makes it",
                          path, part + 1, m->parts, part + 1, m->parts);
        if (st == CW_OK)
            st = cw_fragment_read(path, &f, err);
        if (st == CW_OK && (f.job != m->job || f.part != part || f.parts != m->parts))
            st =
                cwi_fail(err, CW_ERR_FORMAT,
                         "%s: it is of another job than the manifest, or another part; extract "
                         "it again",
                         path);
        if (st == CW_OK)
            st = cw_fragment_append(path, spool, err);
        in = in || (st == CW_OK && f.counts.has_inside);
        out = out || (st == CW_OK && f.counts.has_outside);
    }
    *is_crossed = in && out;
    return st;
}

/* Moves the components that enclose enough into another spool beside the output. */
static cw_status drop_components(const char *folder, const cli_manifest *m, const char *output,
                                 cw_mesh_spool **spool, cw_error *err)
{
    cw_mesh_spool *whole = *spool;
    cw_drop_counts counts;
    cw_status st = cw_mesh_spool_new(output, spool, err);
    if (st == CW_OK)
        st = cli_drop_small_components(folder, whole, m->least_mm3, cwi_memory_left(),
                                       cw_mesh_spool_sink(*spool), &counts, err);
    cw_mesh_spool_free(whole);
    return st;
}

static cw_status write_file(const char *path, const cw_write_desc *desc, const cli_manifest *m,
                            const cw_mesh_spool *spool, double start, cw_error *err)
{
    cw_provenance lines[CLI_EXTRACT_PROVENANCE];
    const cw_mesh *frame = cw_mesh_spool_frame(spool);
    const cw_part part = {.mesh = frame, .spool = spool};
    struct stat info = {0};
    for (size_t n = 0; n < m->line_count; n++)
        lines[n] = (cw_provenance){m->lines[n][0], m->lines[n][1]};
    cw_write_desc d = *desc;
    d.provenance = lines;
    d.provenance_count = m->line_count;
    d.progress = cli_progress((double)frame->triangle_count / 1e6, "Mtriangle");
    cw_status st = cw_parts_write(path, &part, 1, &d, err);
    if (st != CW_OK)
        return st;
    cli_result("%s: %s triangles, %s vertices, from %zu part%s", path,
               cli_count(frame->triangle_count), cli_count(frame->vertex_count), m->parts,
               m->parts == 1 ? "" : "s");
    if (stat(path, &info) == 0)
        cli_result("; %s", cli_bytes((double)info.st_size));
    cli_result("; %.2f s\n", cli_seconds() - start);
    return CW_OK;
}

cw_status cli_join_parts(const char *folder, const cli_manifest *m, const char *output,
                         const cw_write_desc *desc, double start, cw_error *err)
{
    cw_mesh_spool *spool = NULL;
    bool is_crossed = false;
    cw_status st = cw_mesh_spool_new(output, &spool, err);
    if (st == CW_OK)
        st = append_parts(folder, m, spool, &is_crossed, err);
    if (st == CW_OK && (!is_crossed || !cw_mesh_spool_frame(spool)->triangle_count))
        st = cwi_fail(err, CW_ERR_EMPTY, "%s: the parts have no surface", folder);
    if (st == CW_OK && m->least_mm3 > 0)
        st = drop_components(folder, m, output, &spool, err);
    if (st == CW_OK)
        st = write_file(output, desc, m, spool, start, err);
    cw_mesh_spool_free(spool);
    return st;
}
