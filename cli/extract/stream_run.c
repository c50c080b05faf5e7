/* Extracts a surface slice by slice: the slices are read while their file is open, and the
 * surface goes to temporary files beside its own. */
#include "cli/extract/stream_run.h"

#include "cli/extract/small_components.h"
#include "cli/framework/console.h"
#include "cli/inputs/volume_prepare.h"
#include "core/base/memory.h"
#include "core/base/status.h"

#include <cubewright/spool.h>

#include <stdio.h>

static bool has_simplify(const cli_extract_args *args)
{
    return args->simplify.error.given || args->simplify.triangles;
}

const char *cli_find_unstreamed(const cli_extract_args *args)
{
    const struct {
        const char *name;
        bool given;
    } options[] = {
        {"--max-error", args->pixel.most.given},
        {"--camera", args->pixel.camera != NULL},
        {"--min-volume beside --simplify", args->least.given && has_simplify(args)},
        {"--largest", args->largest > 0},
        {"--fill-voids", args->fill_voids},
        {"--smooth", args->smooth.given},
        {"--cut-plane", args->cut.given},
        {"--color-by", args->color.by != NULL},
        {"--profile print", args->profile == CLI_PROFILE_PRINT},
        {"--snap", args->snap.value > 0},
        {"--animate", args->animate},
        {"--lod", args->lod.count > 0},
        {"--prove-crop", args->prove_crop},
        {"--compress", args->compress.kind != 0 && !has_simplify(args)},
        {"--component mag", args->input.component.magnitude},
    };
    for (size_t n = 0; n < sizeof options / sizeof *options; n++)
        if (options[n].given)
            return options[n].name;
    return cli_find_unstreamed_preparation(&args->input);
}

/* Returns true for errors of too low a --memory. */
static bool exceeds_memory(cw_status st)
{
    size_t left;
    return st == CW_ERR_LIMIT || (st == CW_ERR_NO_MEMORY && cwi_memory_refused(&left));
}

bool cli_turn_to_slices(cli_extract_run *run, cw_status st)
{
    const cli_extract_args *args = run->args;
    cli_volume *v = &run->input.volume;
    if (!exceeds_memory(st) || args->stream == CLI_STREAM_NEVER || args->max_triangles ||
        v->view.cells || v->view.sparse || cli_find_unstreamed(args))
        return false;
    cw_extractor_free(run->input.extractor);
    run->input.extractor = NULL;
    cw_volume_free(&v->voxels);
    cw_volume_free(&v->prepared);
    v->view.data = NULL;
    v->streams = true;
    run->input.turned = true;
    return true;
}

cw_status cli_visit_moment(const cli_extract_run *run, const cli_moment *moment,
                           const cw_slice_visitor *visitor, cw_error *err)
{
    const cli_volume *v = &run->input.volume;
    cli_input input = run->args->input;
    input.step = moment->step;
    input.step_chosen = run->input.series.given;
    if (run->args->stream == CLI_STREAM_AUTO)
        cli_say("%s: voxels and surface exceed --memory: read and extracted slice by slice",
                v->path);
    return cli_visit_slices(v, &input, visitor, err);
}

cw_status cli_expect_surface(const cli_extract_run *run, const cli_made *made, size_t triangles,
                             cw_error *err)
{
    return triangles
               ? CW_OK
               : cwi_fail(
                     err, CW_ERR_EMPTY,
                     "%s: no surface at isovalue %g: it must be above the lowest value and "
                     "at most the highest ('cubewright info' tells them)",
                     run->input.volume.path, made->iso);
}

/* A surface on its way. */
typedef struct streaming {
    const cli_extract_run *run;
    const cli_made *made;
    cw_mesh_spool *spool;
    cw_quality_stream *check; /* NULL: it is not measured, or not yet */
    double least_mm3; /* above 0: small components are left out when all is in the spool */
    size_t left;      /* memory for slices or their surface */
    cw_extract_counts counts;
} streaming;

/* Passes a chunk on to the spool, and to the measurement. */
static cw_status take_chunk(void *user, const cw_mesh_chunk *chunk, cw_error *err)
{
    const streaming *s = user;
    const cw_chunk_sink spool = cw_mesh_spool_sink(s->spool),
                        check = cw_quality_stream_sink(s->check);
    cw_status st = spool.take(spool.user, chunk, err);
    if (st != CW_OK || !s->check)
        return st;
    st = check.take(check.user, chunk, err);
    if (st == CW_ERR_LIMIT) {
        const cw_error why = *err;
        return cwi_fail(err, st, "%s: %s (--memory); --no-check leaves it out",
                        s->run->input.volume.path, why.message);
    }
    return st;
}

cw_status cli_plan_slices(const cli_extract_run *run, double iso, const cw_slice_source *source,
                          cw_stream_desc *desc, cw_error *err)
{
    const size_t *dim = source->shape.dim;
    const cli_slices slices = {.path = run->input.volume.path,
                               .limit = cli_memory_limit(&run->args->input),
                               .turned = run->input.turned};
    *desc = (cw_stream_desc){.extract = cli_extract_wants(run, iso).extract,
                             .layers = run->args->slab};
    desc->extract.extra_bytes = 0;
    cw_status st = cli_limit_slices(&slices, &source->shape, desc, err);
    desc->extract.progress =
        cli_progress((double)dim[0] * (double)dim[1] * (double)dim[2] / 1e6, "Mvoxel");
    return st;
}

/* Begins the measurement. A quarter of its bytes is for the work on the front. */
static cw_status begin_check(streaming *s, size_t bytes, cw_error *err)
{
    const cw_quality_stream_desc check = {.threads = (int)s->run->args->input.threads,
                                          .max_bytes = bytes / 4 * 3};
    return cw_quality_stream_new(&check, &s->check, err);
}

/* Divides the memory that is left. Slices take a third of it at most, or what a single layer needs.
 * The front of the surface may have the rest, and half of that beside: the file is written later. */
static cw_status share_memory(streaming *s, const cw_slice_source *source, cw_stream_desc *desc,
                              cw_error *err)
{
    const size_t least = cw_extract_stream_bytes(&source->shape, desc, true),
                 left = desc->extract.max_bytes;
    s->left = left;
    if (!s->run->args->check || s->least_mm3 > 0)
        return CW_OK;
    desc->extract.max_bytes = left / 3 > least ? left / 3 : least;
    const size_t slices = cw_extract_stream_bytes(&source->shape, desc, false),
                 rest = (left > slices ? left - slices : 0) + CLI_BESIDE_SLICES / 2;
    return begin_check(s, rest, err);
}

static cw_status extract_slices(void *user, const cw_slice_source *source, cw_error *err)
{
    streaming *s = user;
    cw_stream_desc d;
    cw_status st = cli_plan_slices(s->run, s->made->iso, source, &d, err);
    if (st == CW_OK)
        st = share_memory(s, source, &d, err);
    return st == CW_OK
               ? cw_extract_stream(source, &d, (cw_chunk_sink){take_chunk, s}, &s->counts, err)
               : st;
}

/* Moves what is kept into another spool, and measures it on the way. The slices have gone: a
 * third of the memory is for the components, and the rest for the measurement. */
static cw_status drop_components(streaming *s, cli_made *made, cw_error *err)
{
    cw_mesh_spool *whole = s->spool;
    const size_t bytes = s->run->args->check ? s->left / 3 : s->left;
    cw_status st = CW_OK;
    s->spool = NULL;
    if (s->run->args->check)
        st = begin_check(s, s->left - bytes + CLI_BESIDE_SLICES / 2, err);
    if (st == CW_OK)
        st = cw_mesh_spool_new(made->path, &s->spool, err);
    if (st == CW_OK)
        st = cli_drop_small_components(s->run->input.volume.path, whole, s->least_mm3, bytes,
                                       (cw_chunk_sink){take_chunk, s}, &made->components, err);
    cw_mesh_spool_free(whole);
    if (st == CW_OK)
        made->least_mm3 = s->least_mm3;
    return st;
}

/* Ends the measurement, and holds the surface to the promise. */
static cw_status end_check(const streaming *s, cli_made *made, cw_error *err)
{
    char what[32];
    snprintf(what, sizeof what, "at %g", made->iso);
    if (!s->check)
        return CW_OK;
    cw_status st = cw_quality_stream_finish(s->check, &made->quality, err);
    made->measured = st == CW_OK;
    return st == CW_OK ? cli_hold_to_promise(s->run->input.volume.path, what, &made->quality,
                                             s->run->args->open, err)
                       : st;
}

cw_status cli_extract_streamed(cli_extract_run *run, const cli_moment *moment, cli_made *made,
                               cw_mesh_spool **spool, cw_extract_counts *counts, cw_error *err)
{
    const size_t *dim = run->input.volume.view.dim;
    streaming s = {.run = run, .made = made, .least_mm3 = cli_extract_least_mm3(run)};
    const cw_slice_visitor visitor = {extract_slices, &s};
    cli_report_begin(&run->output.report);
    cw_status st = cw_mesh_spool_new(made->path, &s.spool, err);
    if (st == CW_OK)
        st = cli_visit_moment(run, moment, &visitor, err);
    if (st == CW_OK)
        st = cli_expect_surface(run, made, s.counts.triangles, err);
    if (st == CW_OK && s.least_mm3 > 0)
        st = drop_components(&s, made, err);
    if (st == CW_OK)
        st = end_check(&s, made, err);
    cw_quality_stream_free(s.check);
    if (st != CW_OK) {
        cw_mesh_spool_free(s.spool);
        return st;
    }
    *spool = s.spool;
    *counts = s.counts;
    cli_report_end(&run->output.report, "extract", dim[0] * dim[1] * dim[2],
                   cw_mesh_spool_frame(*spool)->triangle_count);
    return CW_OK;
}
