/* Extracts a surface slice by slice: the slices are read while their file is open, and the
 * surface goes to temporary files beside its own. */
#include "cli/extract/stream_run.h"

#include "cli/framework/console.h"
#include "cli/inputs/volume_prepare.h"
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/base/text.h"

#include <stdio.h>
#include <string.h>

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
        v->view.cells || v->view.sparse || cli_find_unstreamed(args, CW_SOURCE_SLICES))
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

cw_status cli_plan_slices(const cli_extract_run *run, double iso, const cw_slice_source *source,
                          cli_surface_settings *set, cw_error *err)
{
    const cli_slices slices = {.path = run->input.volume.path,
                               .limit = cli_memory_limit(&run->args->input),
                               .turned = run->input.turned};
    cw_status st = cli_extract_describe(run, iso, set, err);
    if (st != CW_OK)
        return st;
    cw_stream_desc desc = {.extract = set->desc.extract, .layers = set->desc.layers};
    desc.extract.extra_bytes = 0;
    st = cli_limit_slices(&slices, &source->shape, &desc, err);
    set->desc.extract.max_bytes = desc.extract.max_bytes;
    set->desc.watch.begin = cli_stage_progress;
    return st;
}

/* A surface on its way. */
typedef struct streaming {
    const cli_extract_run *run;
    cli_made *made;
    cli_streamed *out;
} streaming;

static cw_status take_surface(void *user, cw_pipeline_surface *surface,
                              const cw_pipeline_facts *facts, cw_error *err)
{
    cli_streamed *out = user;
    (void)facts;
    (void)err;
    out->spool = surface->spool;
    surface->spool = NULL;
    if (!surface->mesh)
        return CW_OK;
    out->mesh = *surface->mesh;
    *surface->mesh = (cw_mesh){0};
    return CW_OK;
}

/* Names the options that help when --memory is too low. */
static cw_status explain_limit(const cli_extract_run *run, cw_status st, cw_error *err)
{
    char needed_text[CWI_MEMORY_TEXT], left_text[CWI_MEMORY_TEXT];
    const cw_error why = *err;
    size_t left;
    const size_t needed = cwi_memory_refused(&left);
    if (st == CW_ERR_LIMIT && strncmp(why.message, "check: ", 7) == 0)
        return cwi_fail(err, st, "%s (--memory); --no-check leaves it out", why.message + 7);
    if (st == CW_ERR_LIMIT && !strstr(why.message, "cw_memory_limit()"))
        return cwi_fail(err, st, "%s (--memory)", why.message);
    if (st != CW_ERR_NO_MEMORY || !needed || !cli_extract_is_simplified(run->args))
        return st;
    cwi_print_memory(needed, needed_text);
    cwi_print_memory(left, left_text);
    return cwi_fail(
        err, CW_ERR_LIMIT,
        "simplified slice by slice, the surface does not fit: %s more were needed, %s "
        "are left (--memory); slabs take up to 300 MB beside the simplified surface",
        needed_text, left_text);
}

static cw_status extract_slices(void *user, const cw_slice_source *source, cw_error *err)
{
    const streaming *s = user;
    cli_surface_settings set;
    cw_status st = cli_plan_slices(s->run, s->made->iso, source, &set, err);
    if (st != CW_OK)
        return st;
    set.desc.check = s->run->args->check && !set.desc.simplify; /* in memory it is, later */
    set.desc.spool_path = s->made->path;
    s->made->least_mm3 = set.desc.min_volume_mm3;
    cw_error why;
    st = cw_pipeline_run_slices(source, &set.desc, (cw_pipeline_sink){take_surface, s->out},
                                &s->made->facts, err);
    why = *err;
    if (st == CW_ERR_EMPTY && !s->made->facts.extracted.triangles)
        cwi_fail(err, st, "%s ('cubewright info' tells them)", why.message);
    return cli_explain_stages(s->run->input.volume.path, explain_limit(s->run, st, err), err);
}

/* Says what the stages did, and holds the surface to the promise. */
static cw_status judge_surface(cli_extract_run *run, cli_made *made, const cw_mesh *mesh,
                               cw_error *err)
{
    const char *path = run->input.volume.path;
    char what[32];
    cli_extract_tell_stages(run, made);
    if (cli_extract_is_simplified(run->args))
        return cli_extract_judge(run, made, mesh, err);
    if (!run->args->check)
        return CW_OK;
    snprintf(what, sizeof what, "at %g", made->iso);
    made->quality = made->facts.quality;
    made->measured = true;
    return cli_hold_to_promise(path, what, &made->quality, run->args->open, err);
}

cw_status cli_extract_streamed(cli_extract_run *run, const cli_moment *moment, cli_made *made,
                               cli_streamed *out, cw_error *err)
{
    const size_t *dim = run->input.volume.view.dim;
    streaming s = {.run = run, .made = made, .out = out};
    const cw_slice_visitor visitor = {extract_slices, &s};
    *out = (cli_streamed){0};
    cli_report_begin(&run->output.report);
    cw_status st = cli_visit_moment(run, moment, &visitor, err);
    if (st != CW_OK)
        return st;
    const cw_mesh *mesh = out->spool ? cw_mesh_spool_frame(out->spool) : &out->mesh;
    cli_report_end(&run->output.report, "extract", dim[0] * dim[1] * dim[2],
                   mesh->triangle_count);
    return judge_surface(run, made, mesh, err);
}

void cli_free_streamed(cli_streamed *surface)
{
    cw_mesh_spool_free(surface->spool);
    cw_mesh_free(&surface->mesh);
    *surface = (cli_streamed){0};
}
