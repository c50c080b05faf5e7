/* Joins parts: appends their fragments to a spool in order, checks the surface and writes its
 * file. */
#include "cli/extract/part_join.h"

#include "cli/extract/small_components.h"
#include "cli/framework/console.h"
#include "cli/framework/standard_streams.h"
#include "core/base/memory.h"
#include "core/base/status.h"

#include <stdio.h>
#include <sys/stat.h>

cw_status cli_append_parts(const char *folder, const cli_manifest *m, size_t first, size_t end,
                           cw_mesh_spool *spool, cw_part_counts *sides, cw_error *err)
{
    cw_status st = CW_OK;
    for (size_t part = first; part < end && st == CW_OK; part++) {
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
        sides->has_inside = sides->has_inside || (st == CW_OK && f.counts.has_inside);
        sides->has_outside = sides->has_outside || (st == CW_OK && f.counts.has_outside);
    }
    return st;
}

/* Moves the components that enclose enough into another spool beside the output. */
static cw_status drop_components(const cli_joined *j, const cw_mesh_spool *whole,
                                 cw_mesh_spool **kept, cw_error *err)
{
    cw_drop_counts counts;
    cw_status st = cw_mesh_spool_new(cli_temporary_beside(j->output), kept, err);
    return st == CW_OK ? cli_drop_small_components(j->output, whole, j->manifest->least_mm3,
                                                   cwi_memory_left(), cw_mesh_spool_sink(*kept),
                                                   &counts, err)
                       : st;
}

/* Measures the surface, and holds it to the promise of the command extract. */
static cw_status check_surface(const cli_joined *j, const cw_mesh_spool *spool, cw_error *err)
{
    enum { BESIDE_BYTES = 10 << 20 };
    const size_t limit = cli_memory_limit(j->input), beside = cli_peak_bytes() + BESIDE_BYTES;
    const cw_quality_stream_desc desc = {.threads = (int)j->input->threads,
                                         .max_bytes = limit > beside ? limit - beside : 1};
    cw_quality_stream *check = NULL;
    cw_quality q;
    char what[32];
    snprintf(what, sizeof what, "at %g", j->manifest->iso);
    cw_status st = cw_quality_stream_new(&desc, &check, err);
    if (st == CW_OK)
        st = cw_mesh_spool_read(spool, cw_quality_stream_sink(check), err);
    if (st == CW_OK)
        st = cw_quality_stream_finish(check, &q, err);
    cw_quality_stream_free(check);
    if (st == CW_ERR_LIMIT) {
        const cw_error why = *err;
        return cwi_fail(err, st, "%s: %s (--memory); --no-check leaves it out", j->output,
                        why.message);
    }
    return st == CW_OK ? cli_hold_to_promise(j->output, what, &q, j->manifest->open, err) : st;
}

static cw_status write_file(const cli_joined *j, const cw_mesh_spool *spool, cw_error *err)
{
    cw_provenance lines[CLI_EXTRACT_PROVENANCE];
    const cli_manifest *m = j->manifest;
    const cw_mesh *frame = cw_mesh_spool_frame(spool);
    const cw_part part = {.mesh = frame, .spool = spool};
    double bytes;
    for (size_t n = 0; n < m->line_count; n++)
        lines[n] = (cw_provenance){m->lines[n][0], m->lines[n][1]};
    cw_write_desc d = *j->desc;
    d.sink = cli_output_sink(j->output);
    if (d.sink && !d.name)
        d.name = "mesh"; /* there is no stem of a path */
    d.provenance = lines;
    d.provenance_count = m->line_count;
    d.progress = cli_progress((double)frame->triangle_count / 1e6, "Mtriangle");
    cw_status st = cw_parts_write(j->output, &part, 1, &d, err);
    if (st != CW_OK)
        return st;
    cli_result("%s: %s triangles, %s vertices, from %s%s", j->output,
               cli_count(frame->triangle_count), cli_count(frame->vertex_count), j->from,
               j->check ? "; checked" : "");
    if (cli_find_output_size(j->output, &bytes))
        cli_result("; %s", cli_bytes(bytes));
    cli_result("; %.2f s\n", cli_seconds() - j->start);
    return CW_OK;
}

cw_status cli_write_joined(const cli_joined *j, const cw_mesh_spool *spool,
                           const cw_part_counts *sides, const cw_team *team, cw_error *err)
{
    const bool is_crossed = sides->has_inside && sides->has_outside;
    const bool leads = team->rank == 0, drops = j->manifest->least_mm3 > 0;
    cw_mesh_spool *kept = NULL;
    cw_status st = CW_OK;
    if (!is_crossed || !cw_mesh_spool_frame(spool)->triangle_count)
        return cwi_fail(err, CW_ERR_EMPTY,
                        "%s: the parts have no surface at isovalue %g: it must be above the "
                        "lowest value and at most the highest ('cubewright info' tells them)",
                        j->output, j->manifest->iso);
    if (drops && leads)
        st = drop_components(j, spool, &kept, err);
    if (st == CW_OK && j->check && leads)
        st = check_surface(j, drops ? kept : spool, err);
    st = cw_team_agree(team, st, err);
    if (st == CW_OK && !drops)
        st = write_file(j, spool, err);
    else if (st == CW_OK) /* what rank 0 kept is its own */
        st = cw_team_agree(team, leads ? write_file(j, kept, err) : CW_OK, err);
    cw_mesh_spool_free(kept);
    return st;
}

cw_status cli_join_parts(const char *folder, const cli_joined *j, cw_error *err)
{
    cw_mesh_spool *spool = NULL;
    cw_part_counts sides = {0};
    cw_status st = cw_mesh_spool_new(cli_temporary_beside(j->output), &spool, err);
    if (st == CW_OK)
        st = cli_append_parts(folder, j->manifest, 0, j->manifest->parts, spool, &sides, err);
    if (st == CW_OK)
        st = cli_write_joined(j, spool, &sides, &(cw_team){0}, err);
    cw_mesh_spool_free(spool);
    return st;
}
