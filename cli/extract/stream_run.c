/* Extracts a surface slice by slice: the slices are read while their file is open, and the
 * surface goes to temporary files beside its own. */
#include "cli/extract/stream_run.h"

#include "cli/framework/console.h"
#include "core/base/memory.h"
#include "core/base/status.h"

#include <cubewright/spool.h>

/* What writers of files take, beside the slices. */
enum { WRITER_BYTES = 4 << 20 };

const char *cli_find_unstreamed(const cli_extract_args *args)
{
    const struct {
        const char *name;
        bool given;
    } options[] = {
        {"--simplify", args->simplify.error.given || args->simplify.triangles},
        {"--max-error", args->pixel.most.given},
        {"--camera", args->pixel.camera != NULL},
        {"--min-volume", args->least.given},
        {"--snap", args->snap.value > 0},
        {"--animate", args->animate},
        {"--prove-crop", args->prove_crop},
        {"--compress", args->compress.kind != 0},
        {"--component mag", args->input.component.magnitude},
    };
    for (size_t n = 0; n < sizeof options / sizeof *options; n++)
        if (options[n].given)
            return options[n].name;
    return NULL;
}

/* A surface on its way. */
typedef struct streaming {
    const cli_extract_run *run;
    const cli_made *made;
    cw_mesh_spool *spool;
    cw_extract_counts counts;
} streaming;

static cw_status extract_slices(void *user, const cw_slice_source *source, cw_error *err)
{
    streaming *s = user;
    const size_t *dim = source->shape.dim, left = cwi_memory_left();
    cw_stream_desc d = {.extract = cli_extract_wants(s->run, s->made->iso).extract,
                        .layers = s->run->args->slab};
    d.extract.extra_bytes = 0;
    d.extract.max_bytes = left > WRITER_BYTES ? left - WRITER_BYTES : 1;
    d.extract.progress =
        cli_progress((double)dim[0] * (double)dim[1] * (double)dim[2] / 1e6, "Mvoxel");
    return cw_extract_stream(source, &d, cw_mesh_spool_sink(s->spool), &s->counts, err);
}

cw_status cli_extract_streamed(cli_extract_run *run, const cli_moment *moment, cli_made *made,
                               cw_mesh_spool **spool, cw_error *err)
{
    const cli_volume *v = &run->input.volume;
    const size_t *dim = v->view.dim;
    cli_input input = run->args->input;
    input.step = moment->step;
    input.step_chosen = run->input.series.given;
    streaming s = {.run = run, .made = made};
    const cw_slice_visitor visitor = {extract_slices, &s};
    cli_report_begin(&run->output.report);
    cw_status st = cw_mesh_spool_new(made->path, spool, err);
    s.spool = *spool;
    if (st == CW_OK)
        st = cli_visit_slices(v, &input, &visitor, err);
    if (st == CW_OK && !s.counts.triangles)
        st = cwi_fail(err, CW_ERR_EMPTY,
                      "%s: no surface at isovalue %g: it must be above the lowest value and at "
                      "most the highest ('cubewright info' tells them)",
                      v->path, made->iso);
    if (st != CW_OK) {
        cw_mesh_spool_free(*spool);
        *spool = NULL;
        return st;
    }
    cli_report_end(&run->output.report, "extract", dim[0] * dim[1] * dim[2],
                   s.counts.triangles);
    return CW_OK;
}
