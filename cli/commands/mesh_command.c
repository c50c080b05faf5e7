/* Runs the commands that turn one mesh into another: checks arguments, reads, measures, delivers and
 * reports. */
#include "cli/commands/mesh_command.h"

#include "cli/framework/console.h"
#include "cli/results/mesh_comparison.h"
#include "core/base/status.h"

#include <cubewright/atlas.h>

#include <stdlib.h>

/* --- before the input is read ------------------------------------------------------------- */

/* Lists the files that no output may be, in `two` where they are no list yet. Returns how many there are. */
static size_t list_inputs(const cli_mesh_run *r, const char *two[2], const char *const **inputs)
{
    two[0] = r->args->common.inputs[0];
    two[1] = r->args->source;
    *inputs = two[1] ? two : r->args->common.inputs;
    return two[1] ? 2 : r->args->common.input_count;
}

/* The report is an output, too: none is written when it is an input or a mesh. */
cw_status cli_check_mesh_outputs(cli_mesh_run *r, cw_error *err)
{
    const char *two[2], *json = r->args->json, *const * inputs;
    const size_t count = list_inputs(r, two, &inputs);
    const cw_write_desc desc =
        cli_written_desc(&r->args->written, &r->args->compress, &r->mesh);
    cw_status st = CW_OK;
    for (size_t n = 0; n < r->outputs.count && json && st == CW_OK; n++)
        st = cli_check_apart(json, r->outputs.path[n], err);
    r->report.path = st == CW_OK ? json : NULL;
    return st == CW_OK && r->outputs.count
               ? cli_check_outputs(&r->outputs, inputs, count, &desc, err)
               : st;
}

static cw_status name_outputs(cli_mesh_run *r, cw_error *err)
{
    if (r->command->name_outputs)
        return r->command->name_outputs(r, err);
    return r->args->output
               ? cli_name_output(&r->outputs, r->args->output, r->args->common.inputs[0], err)
               : CW_OK;
}

static cw_status check_args(cli_mesh_run *r, cw_error *err)
{
    const char *two[2], *const *inputs;
    const size_t count = list_inputs(r, two, &inputs);
    cw_status st = r->args->json ? cli_check_output(r->args->json, inputs, count, err) : CW_OK;
    if (st != CW_OK)
        return st;
    r->report.path = r->args->json;
    if (r->command->check)
        st = r->command->check(r, err);
    if (st == CW_OK)
        st = cli_check_compress(&r->args->compress, err);
    if (st == CW_OK)
        st = name_outputs(r, err);
    return st == CW_OK ? cli_check_mesh_outputs(r, err) : st;
}

/* --- work --------------------------------------------------------------------------------- */

static cw_status make_pieces(cli_mesh_run *r, cw_error *err)
{
    const cli_mesh_command *c = r->command;
    cw_status st = c->piecing == CLI_PIECES_NONE ? CW_OK
                   : c->piecing == CLI_PIECES_AS_READ
                       ? cli_take_pieces(&r->pieces, &r->mesh, err)
                       : cli_weld_pieces(&r->pieces, &r->mesh, err);
    if (st == CW_OK && c->resolve)
        st = c->resolve(r, err);
    return st == CW_OK && c->holds_topology ? cli_measure_pieces(&r->pieces, r->threads, err)
                                            : st;
}

static cw_status read_mesh(cli_mesh_run *r, cw_error *err)
{
    const cli_mesh_args *args = r->args;
    const char *path = args->common.inputs[0];
    cli_report_begin(&r->report);
    cw_status st = r->reads_parts ? cli_read_parts(path, r->reader, &args->input, &r->mesh, err)
                                  : cli_read_mesh(path, r->reader, &args->input, &r->mesh, err);
    if (st == CW_OK && args->orient)
        st = cli_orient_mesh(&r->mesh, r->threads, err);
    if (st == CW_OK && r->command->prepare)
        st = r->command->prepare(r, err);
    if (st == CW_OK)
        st = make_pieces(r, err);
    if (st == CW_OK)
        cli_report_end(&r->report, "read", 1,
                       r->pieces.count ? r->pieces.triangles : cli_mesh_triangles(&r->mesh));
    return st;
}

size_t cli_made_triangles(const cli_mesh_run *r)
{
    size_t triangles = 0;
    for (size_t n = 0; n < r->pieces.count; n++)
        triangles += r->pieces.piece[n].out.triangle_count;
    return triangles;
}

/* Drops texture coordinates that are not right any more, and says if the texture is lost. Pictures without
 * coordinates are of no use. */
static void settle_texture(cli_mesh_run *r)
{
    bool is_lost = false;
    for (size_t n = 0; n < r->pieces.count; n++) {
        cli_piece *piece = &r->pieces.piece[n];
        if (r->command->loses_texture)
            cw_mesh_attribute_remove(&piece->out, CW_TEXTURE_COORDINATES);
        if (!piece->out.triangle_count ||
            cw_mesh_attribute_find(&piece->out, CW_TEXTURE_COORDINATES))
            continue;
        is_lost = true;
        piece->textures = NULL;
    }
    if (is_lost && r->outputs.count && cli_is_textured(&r->mesh))
        cli_say(
            "%s: texture lost: %s makes other triangles; 'cubewright uv %s --rebake %s -o FILE' "
            "carries it over",
            r->mesh.path, r->command->name, r->outputs.path[0], r->mesh.path);
}

static cw_status do_work(cli_mesh_run *r, cw_error *err)
{
    const size_t before = r->pieces.triangles;
    cli_report_begin(&r->report);
    cw_status st = r->command->work(r, err);
    if (st != CW_OK)
        return cwi_fail_in(err, st, r->blamed ? r->blamed : r->mesh.path);
    r->is_made = true;
    settle_texture(r);
    cli_report_end(&r->report, r->command->name, before,
                   r->outputs.count ? cli_made_triangles(r) : before);
    return r->command->report ? r->command->report(r, err) : CW_OK;
}

cw_status cli_compare_made(cli_mesh_run *r, cli_made *made, cw_error *err)
{
    cw_status st =
        r->command->holds_topology ? cli_hold_pieces(&r->pieces, r->threads, err) : CW_OK;
    if (st != CW_OK || !r->args->measure)
        return st;
    cli_report_begin(&r->report);
    made->compared.promised_mm = r->promised_mm;
    st = cli_compare_pieces(&r->pieces, r->threads, &made->compared, err);
    if (st == CW_OK)
        cli_report_end(&r->report, "measure", r->pieces.triangles, cli_made_triangles(r));
    return st;
}

cli_delivery cli_mesh_delivery(const cli_mesh_run *r)
{
    return (cli_delivery){.input = r->mesh.path,
                          .write =
                              cli_written_desc(&r->args->written, &r->args->compress, &r->mesh),
                          .compress = &r->args->compress,
                          .threads = r->threads,
                          .unpromised = true,
                          .found = r->found,
                          .report_dropped = true};
}

static cw_status deliver_pieces(cli_mesh_run *r, cw_error *err)
{
    const cli_delivery how = cli_mesh_delivery(r);
    cw_part *parts = NULL;
    cw_status st = cli_list_parts(&r->pieces, &parts, err);
    if (st == CW_OK)
        st = cli_deliver(&r->report, &how, parts, r->pieces.count, 0, r->start, err);
    free(parts);
    return st;
}

cw_status cli_make_mesh(cli_mesh_run *r, cw_error *err)
{
    const cli_mesh_command *c = r->command;
    const bool is_written = r->outputs.count > 0;
    cli_made *made = cli_report_next(&r->report, is_written ? r->outputs.path[0] : NULL, 0);
    cw_status st = do_work(r, err);
    if (st == CW_OK && is_written)
        st = c->measure ? c->measure(r, made, err) : cli_compare_made(r, made, err);
    if (st == CW_OK && is_written)
        st = deliver_pieces(r, err);
    if (st == CW_OK && c->judge)
        st = c->judge(r, err);
    if (st != CW_OK)
        made->error = *err;
    return st;
}

static cw_status run_steps(void *state, cw_error *err)
{
    cli_mesh_run *r = state;
    cw_status st = check_args(r, err);
    if (st == CW_OK)
        st = read_mesh(r, err);
    if (st != CW_OK)
        return st;
    return r->command->make ? r->command->make(r, err) : cli_make_mesh(r, err);
}

/* --- the report --------------------------------------------------------------------------- */

static void put_params(cli_json *j, const void *run, const cli_made *made)
{
    const cli_mesh_run *r = run;
    r->command->put_params(j, r, made);
}

static void put_facts(cli_json *j, const void *run)
{
    const cli_mesh_run *r = run;
    if (r->mesh.file.format)
        cli_json_mesh_file(j, "input", &r->mesh);
    if (r->command->put_facts)
        r->command->put_facts(j, r);
}

cw_status cli_run_mesh_command(const cli_mesh_command *command, const cli_mesh_args *args,
                               void *state, size_t meshes, cw_error *err)
{
    const cw_format *format =
        args->output ? cw_mesh_format(args->output, args->written.format) : NULL;
    cli_mesh_run r = {.command = command,
                      .args = args,
                      .state = state,
                      .threads = (int)args->input.threads,
                      .reader = args->input.reader,
                      .reads_parts = !args->merge && format && format->keeps & CW_KEEPS_PARTS,
                      .report = {.command = command->name,
                                 .main_step = command->main_step,
                                 .params = put_params,
                                 .facts = put_facts},
                      .start = cli_seconds()};
    r.report.args = &r;
    const cli_run run = {.common = &args->common,
                         .progress = args->progress,
                         .json = args->json,
                         .meshes = meshes,
                         .body = run_steps,
                         .state = &r};
    cw_status st = cli_run_reported(&run, &r.report, err);
    cli_free_pieces(&r.pieces);
    cli_free_mesh(&r.mesh);
    cli_free_outputs(&r.outputs);
    return st;
}
