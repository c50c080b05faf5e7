/* Leaves small components out of a surface in a spool, within --memory, and reports them. */
#include "cli/extract/small_components.h"

#include "cli/framework/console.h"
#include "cli/results/stage_facts.h"
#include "core/base/status.h"

/* A sink, and whether it failed: its errors are complete. */
typedef struct watched_sink {
    cw_chunk_sink to;
    bool failed;
} watched_sink;

static cw_status pass_chunk(void *user, const cw_mesh_chunk *chunk, cw_error *err)
{
    watched_sink *w = user;
    cw_status st = w->to.take(w->to.user, chunk, err);
    w->failed = st != CW_OK;
    return st;
}

cw_status cli_drop_small_components(const char *name, const cw_mesh_spool *spool,
                                    double least_mm3, size_t max_bytes, cw_chunk_sink kept,
                                    cw_drop_counts *counts, cw_error *err)
{
    watched_sink watched = {.to = kept};
    const cw_spool_drop_desc desc = {
        .least_mm3 = least_mm3,
        .max_bytes = max_bytes,
        .progress = cli_progress((double)cw_mesh_spool_frame(spool)->triangle_count / 1e6,
                                 "Mtriangle")};
    cw_status st = cw_mesh_spool_drop_volumes(
        spool, &desc, (cw_chunk_sink){pass_chunk, &watched}, counts, err);
    if (watched.failed)
        return st;
    if (st == CW_ERR_LIMIT) {
        const cw_error why = *err;
        return cwi_fail(err, st, "%s: %s (--memory)", name, why.message);
    }
    if (st == CW_OK && !counts->kept)
        st = cwi_fail(err, CW_ERR_EMPTY,
                      "no component encloses %.6g mm3: the largest of %zu encloses %.6g",
                      least_mm3, counts->dropped, counts->largest_mm3);
    if (st != CW_OK)
        return cwi_fail_in(err, st, name);
    cli_tell_components(name, least_mm3, counts, false);
    return CW_OK;
}
