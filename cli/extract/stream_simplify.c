/* Simplifies a surface slab by slab while slices are read, then reads them again for normals. */
#include "cli/extract/stream_simplify.h"

#include "cli/extract/stream_run.h"
#include "cli/framework/console.h"
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/base/text.h"

#include <cubewright/stream.h>

/* A surface on its way. */
typedef struct reduction {
    const cli_extract_run *run;
    const cli_made *made;
    cw_mesh *mesh;
    cw_extract_counts counts; /* of the full surface */
} reduction;

static cw_status simplify_slabs(reduction *r, const cw_slice_source *source,
                                const cw_stream_desc *desc, cw_error *err)
{
    const cli_extract_args *args = r->run->args;
    const cw_simplify_desc simplify = {
        .error_mm = args->simplify.error.given ? cli_extract_error_mm(r->run) : 0,
        .triangles = args->simplify.triangles,
        .threads = (int)args->input.threads,
        .progress = desc->extract.progress};
    cw_simplifier *simplifier;
    cw_status st = cw_simplifier_new(&simplify, &simplifier, err);
    if (st == CW_OK)
        st = cw_extract_stream_slabs(source, desc, CW_SIMPLIFIER_SLAB,
                                     (cw_slab_sink){cw_simplifier_take, simplifier}, &r->counts,
                                     err);
    if (st == CW_OK)
        st = cw_simplifier_finish(simplifier, r->mesh, NULL, err);
    cw_simplifier_free(simplifier);
    return st;
}

static cw_status add_normals(reduction *r, const cw_slice_source *source,
                             const cw_extract_desc *desc, cw_error *err)
{
    const cw_normals_desc normals = {.inside_is_low = desc->inside_is_low,
                                     .threads = desc->threads,
                                     .progress = desc->progress};
    const size_t left = cwi_memory_left();
    return desc->no_normals || !r->mesh->triangle_count
               ? CW_OK
               : cw_extract_stream_normals(source, &normals, left ? left : 1, r->mesh, err);
}

static cw_status simplify_slices(void *user, const cw_slice_source *source, cw_error *err)
{
    reduction *r = user;
    cw_stream_desc d;
    cw_status st = cli_plan_slices(r->run, r->made->iso, source, &d, err);
    if (st == CW_OK)
        st = simplify_slabs(r, source, &d, err);
    return st == CW_OK ? add_normals(r, source, &d.extract, err) : st;
}

/* Turns a lack of memory that --memory causes into an error of that limit. */
static cw_status explain_limit(const cli_extract_run *run, cw_status st, cw_error *err)
{
    char needed_text[CWI_MEMORY_TEXT], left_text[CWI_MEMORY_TEXT];
    size_t left;
    const size_t needed = cwi_memory_refused(&left);
    if (st != CW_ERR_NO_MEMORY || !needed)
        return st;
    cwi_print_memory(needed, needed_text);
    cwi_print_memory(left, left_text);
    return cwi_fail(err, CW_ERR_LIMIT,
                    "%s: simplified slice by slice, the surface does not fit: %s more were "
                    "needed, %s are left (--memory)",
                    run->input.volume.path, needed_text, left_text);
}

cw_status cli_simplify_streamed(cli_extract_run *run, const cli_moment *moment, cli_made *made,
                                cw_mesh *mesh, cw_extract_counts *counts, cw_error *err)
{
    const size_t *dim = run->input.volume.view.dim;
    reduction r = {.run = run, .made = made, .mesh = mesh};
    const cw_slice_visitor visitor = {simplify_slices, &r};
    *mesh = (cw_mesh){0};
    cli_report_begin(&run->output.report);
    cw_status st = explain_limit(run, cli_visit_moment(run, moment, &visitor, err), err);
    if (st == CW_OK)
        st = cli_expect_surface(run, made, mesh->triangle_count, err);
    if (st != CW_OK) {
        cw_mesh_free(mesh);
        return st;
    }
    *counts = r.counts;
    cli_report_end(&run->output.report, "extract", dim[0] * dim[1] * dim[2],
                   mesh->triangle_count);
    return cli_extract_judge(run, made, mesh, &r.counts, err);
}
