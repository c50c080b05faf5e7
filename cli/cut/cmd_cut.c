/* The command cut: cuts a solid to pieces for a printer, with pegs, and lays them on plates. */
#include "cli/cut/cut_facts.h"
#include "cli/cut/cut_preview.h"
#include "cli/framework/console.h"
#include "cli/framework/name_template.h"
#include "cli/framework/quantity.h"
#include "cli/inputs/cut_options.h"
#include "core/base/memory.h"
#include "core/base/status.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define PEG_KINDS "peg/dowel"

/* Length of a plate kept free for pegs whose length is not given: in mm, and of its shortest side. Then the length of
 * such pegs, in diameters. */
static const double PEG_RESERVE_MM = 12, PEG_RESERVE = 0.1, PEG_LENGTHS = 1.5;

static const cli_cut_args defaults = {.measure = true};

static const cli_option options[] = {
    CLI_MESH_OUTPUT(", {name} and {part}"),
    CLI_HEADED("Cuts"),
    {"plane", 0, &cli_kind_planes, "PLANE[,...]",
     "Cut by planes: z=5mm, z=50% of the box, or x,y,z:nx,ny,nz; up to 32 (none)",
     offsetof(cli_cut_args, planes)},
    {"plate", 0, CLI_LENGTHS, "WxDxH",
     "Cut to equal parts that fit a plate, such as 220x220x250mm (no limit)",
     offsetof(cli_cut_args, plate)},
    CLI_HEADED("Pegs"),
    {"pegs", 0, CLI_COUNT, "N", "Pegs for each region of a section (0)",
     offsetof(cli_cut_args, pegs)},
    {"peg-kind", 0, CLI_CHOICE, PEG_KINDS,
     "Pegs of one piece, or dowels that go into both (peg)", offsetof(cli_cut_args, peg_kind)},
    {"peg-diameter", 0, CLI_MESH_LENGTH, "L", "Diameter (8mm, or less where there is no room)",
     offsetof(cli_cut_args, diameter)},
    {"peg-length", 0, CLI_MESH_LENGTH, "L",
     "Length of a peg beyond the section (1.5 diameters), or of a whole dowel (3)",
     offsetof(cli_cut_args, length)},
    {"clearance", 0, CLI_MESH_LENGTH, "L", "Gap between a peg and its hole (0.2mm)",
     offsetof(cli_cut_args, clearance)},
    {"wall", 0, CLI_MESH_LENGTH, "L", "Least material around holes (a quarter of the diameter)",
     offsetof(cli_cut_args, wall)},
    CLI_HEADED("Result"),
    {"lay", 0, CLI_FLAG, NULL,
     "Lay each piece flat on z = 0, beside the others on plates (off: they stay in place)",
     offsetof(cli_cut_args, lay)},
    {"preview", 0, CLI_TEXT, "PNG",
     "Draw the pieces pulled apart, with planes and pegs, before anything is written (none)",
     offsetof(cli_cut_args, preview), CLI_VALUES_PNG},
    {"measure", 0, CLI_FLAG, NULL,
     "Put the pieces together again, and measure them beside the whole (on; --no-measure)",
     offsetof(cli_cut_args, measure)},
    CLI_MESH_ORIENT,
    CLI_MESH_COMMON,
};

static const cli_rule rules[] = {
    {NULL, CLI_NEEDS, "output preview"},
    {NULL, CLI_NEEDS, "plane plate"},
    {"peg-kind peg-diameter peg-length clearance wall", CLI_NEEDS, "pegs"},
    CLI_COMPRESS_RULES,
};

static const cli_cut_args *args_of(const cli_mesh_run *r)
{
    return (const cli_cut_args *)r->args;
}

/* --- what is asked for -------------------------------------------------------------------- */

/* Returns true if each piece goes to a file of its own. */
static bool is_apart(const cli_mesh_run *r)
{
    const char *output = r->args->output;
    return output && (strstr(output, "{name}") || strstr(output, "{part}"));
}

static cw_status check_values(cli_mesh_run *r, cw_error *err)
{
    const cli_cut_args *args = args_of(r);
    const char *output = r->args->output;
    const cw_format *format = output ? cw_mesh_format(output, r->args->written.format) : NULL;
    r->reads_parts = false;
    if (format && !(format->keeps & CW_KEEPS_PARTS) && !is_apart(r))
        return cwi_fail(
            err, CW_ERR_ARGUMENT,
            "%s has no parts: put {name} into the name, such as '{stem}-{name}', for a file for "
            "each piece, or choose 3MF, OBJ or glTF",
            format->name);
    r->report.several = is_apart(r) ? "parts" : NULL;
    cw_status st = CW_OK;
    if (args->preview)
        st = cli_check_output(args->preview, r->args->common.inputs,
                              r->args->common.input_count, err);
    if (st == CW_OK && args->preview && output)
        st = cli_check_apart(args->preview, output, err);
    return st;
}

/* The names of pieces are known only when they are cut. */
static cw_status name_outputs(cli_mesh_run *r, cw_error *err)
{
    return r->args->output && !is_apart(r)
               ? cli_name_output(&r->outputs, r->args->output, r->args->common.inputs[0], err)
               : CW_OK;
}

static double length_mm(const cli_mesh_run *r, const cli_length *length)
{
    return length->given ? cli_length_mm(length, r->pieces.diagonal_mm, 0) : 0;
}

/* --- work --------------------------------------------------------------------------------- */

static void tell_plane(const cli_mesh_run *r, const cw_cut_desc *plane)
{
    for (int a = 0; a < 3; a++)
        if (plane->normal[a] != 0)
            cli_say("%s: cut at %c=%.6gmm", r->mesh.path, 'x' + a, plane->point[a]);
}

/* Lists the planes that were given, then those that the plate needs. */
static cw_status list_planes(cli_mesh_run *r, double reserve_mm, cw_error *err)
{
    cli_cut_state *s = r->state;
    const cli_cut_args *args = args_of(r);
    cw_cut_desc *more = NULL;
    size_t count = 0;
    cw_status st = CW_OK;
    cw_plate_desc plate = {.reserve_mm = reserve_mm};
    memcpy(plate.plate_mm, args->plate.mm, sizeof plate.plate_mm);
    if (args->plate.given)
        st = cw_plate_planes(&r->mesh.mesh, &plate, &more, &count, err);
    s->planes = st == CW_OK ? calloc(args->planes.count + count + 1, sizeof *s->planes) : NULL;
    if (st == CW_OK && !s->planes)
        st = cwi_fail_memory(err);
    for (size_t n = 0; n < args->planes.count && st == CW_OK; n++)
        s->planes[s->plane_count++] = cli_cut_desc(&args->planes.plane[n]);
    for (size_t n = 0; n < count && st == CW_OK; n++) {
        tell_plane(r, &more[n]);
        s->planes[s->plane_count++] = more[n];
    }
    cw_planes_free(more);
    if (st == CW_OK && !s->plane_count)
        cli_say("%s: fits on the plate as it is: nothing is cut", r->mesh.path);
    return st;
}

static cw_pieces_desc find_settings(const cli_mesh_run *r, double *reserve_mm)
{
    const cli_cut_args *args = args_of(r);
    cw_pieces_desc d = {.pegs = args->pegs,
                        .dowels = args->peg_kind == 1,
                        .peg_diameter_mm = length_mm(r, &args->diameter),
                        .peg_length_mm = length_mm(r, &args->length),
                        .clearance_mm = length_mm(r, &args->clearance),
                        .wall_mm = length_mm(r, &args->wall),
                        .threads = r->threads,
                        .progress =
                            cli_progress((double)r->pieces.triangles / 1e6, "Mtriangle")};
    *reserve_mm = d.peg_length_mm > 0 ? d.peg_length_mm : PEG_LENGTHS * d.peg_diameter_mm;
    if (args->plate.given && *reserve_mm == 0) {
        const double *plate = args->plate.mm;
        *reserve_mm =
            fmin(PEG_RESERVE_MM, PEG_RESERVE * fmin(plate[0], fmin(plate[1], plate[2])));
        d.max_automatic_mm = *reserve_mm / PEG_LENGTHS;
    }
    if (!d.pegs || d.dowels)
        *reserve_mm = 0;
    return d;
}

/* Checks that pieces fit where they stand, when they are not laid. */
static cw_status check_plate(const cli_mesh_run *r, const cw_pieces *pieces, cw_error *err)
{
    const cli_lengths *plate = &args_of(r)->plate;
    for (size_t n = 0; n < pieces->count && plate->given; n++) {
        double low[3], high[3];
        cw_mesh_bounds(&pieces->pieces[n].mesh, low, high);
        for (int a = 0; a < 3; a++)
            if (high[a] - low[a] > plate->mm[a] * (1 + 1e-5))
                return cwi_fail(
                    err, CW_ERR_CHECK,
                    "%s is %.6g mm along %c, and the plate %.6g mm: shorter pegs, dowels or a "
                    "smaller --plate make it fit",
                    pieces->pieces[n].name, high[a] - low[a], 'x' + a, plate->mm[a]);
    }
    return CW_OK;
}

static cw_status lay_pieces(cli_mesh_run *r, cw_error *err)
{
    cli_cut_state *s = r->state;
    cw_lay_desc lay = {0};
    if (args_of(r)->plate.given)
        memcpy(lay.plate_mm, args_of(r)->plate.mm, sizeof lay.plate_mm);
    return cw_pieces_lay(&s->cut, &lay, &s->plates, err);
}

/* Hands the meshes over to the runner. Each is named. */
static cw_status take_meshes(cli_mesh_run *r, cw_error *err)
{
    cli_cut_state *s = r->state;
    r->pieces.piece = calloc(s->cut.count, sizeof *r->pieces.piece);
    if (!r->pieces.piece)
        return cwi_fail_memory(err);
    r->pieces.count = s->cut.count;
    for (size_t n = 0; n < s->cut.count; n++) {
        cw_mesh_attribute_remove(&s->cut.pieces[n].mesh, CW_SECTION_ATTRIBUTE);
        r->pieces.piece[n].name = s->cut.pieces[n].name;
        r->pieces.piece[n].out = s->cut.pieces[n].mesh;
        s->cut.pieces[n].mesh = (cw_mesh){0};
    }
    return CW_OK;
}

cw_status cli_cut_solid(cli_mesh_run *r, cw_error *err)
{
    cli_cut_state *s = r->state;
    double reserve_mm, low[3] = {0}, high[3] = {0};
    r->pieces.path = r->mesh.path;
    r->pieces.triangles = cli_mesh_triangles(&r->mesh);
    if (cw_mesh_bounds(&r->mesh.mesh, low, high))
        r->pieces.diagonal_mm =
            hypot(hypot(high[0] - low[0], high[1] - low[1]), high[2] - low[2]);
    const cw_pieces_desc desc = find_settings(r, &reserve_mm);
    cw_status st = list_planes(r, reserve_mm, err);
    return st == CW_OK
               ? cw_pieces_cut(&r->mesh.mesh, s->planes, s->plane_count, &desc, &s->cut, err)
               : st;
}

void cli_free_cut(cli_cut_state *state)
{
    cw_pieces_free(&state->cut);
    free(state->planes);
}

static cw_status cut_mesh(cli_mesh_run *r, cw_error *err)
{
    cli_cut_state *s = r->state;
    const cli_cut_args *args = args_of(r);
    cw_status st = cli_cut_solid(r, err);
    if (st == CW_OK && args->measure)
        st = cw_pieces_assemble(&s->cut, &r->mesh.mesh, r->threads, NULL, &s->assembled, err);
    if (st == CW_OK && args->preview)
        st = cli_write_cut_preview(args->preview, &s->cut, s->planes, s->plane_count,
                                   r->threads, err);
    if (st == CW_OK)
        st = args->lay ? lay_pieces(r, err) : check_plate(r, &s->cut, err);
    return st == CW_OK ? take_meshes(r, err) : st;
}

/* Writes a file for each piece. */
static cw_status write_apart(cli_mesh_run *r, cw_error *err)
{
    cw_part *parts = NULL;
    cw_status st = cli_list_parts(&r->pieces, &parts, err);
    if (st == CW_OK)
        st = cli_report_reserve(&r->report, r->pieces.count, err);
    if (st == CW_OK)
        st = cli_name_part_outputs(&r->outputs, r->args->output, r->mesh.path, parts,
                                   r->pieces.count, err);
    if (st == CW_OK)
        st = cli_check_mesh_outputs(r, err);
    for (size_t n = 0; n < r->pieces.count && st == CW_OK; n++) {
        const cli_delivery how = cli_mesh_delivery(r);
        cli_made *made = cli_report_next(&r->report, r->outputs.path[n], 0);
        made->name = parts[n].name;
        if (n == 0)
            cli_report_end(&r->report, "cut", r->pieces.triangles, cli_made_triangles(r));
        st = cli_deliver(&r->report, &how, &parts[n], 1, 0, r->start, err);
        r->start = cli_seconds();
        r->found[0] = '\0'; /* the first line has it all */
        if (st != CW_OK)
            made->error = *err;
    }
    free(parts);
    return st;
}

/* Cuts, and writes the pieces together, apart, or not at all. */
static cw_status make_pieces(cli_mesh_run *r, cw_error *err)
{
    if (r->outputs.count)
        return cli_make_mesh(r, err);
    cli_report_begin(&r->report);
    cw_status st = cut_mesh(r, err);
    if (st != CW_OK)
        return cwi_fail_in(err, st, r->mesh.path);
    r->is_made = true;
    st = cli_report_cut(r, err);
    if (st != CW_OK || r->args->output)
        return st == CW_OK ? write_apart(r, err) : st;
    cli_report_next(&r->report, NULL, 0);
    cli_report_end(&r->report, "cut", r->pieces.triangles, cli_made_triangles(r));
    cli_say("%s: %s shows %zu pieces%s", r->mesh.path, args_of(r)->preview, r->pieces.count,
            r->found);
    return st;
}

static const cli_mesh_command cut = {
    .name = "cut",
    .piecing = CLI_PIECES_NONE,
    .check = check_values,
    .name_outputs = name_outputs,
    .make = make_pieces,
    .work = cut_mesh,
    .loses_texture = true,
    .report = cli_report_cut,
    .put_params = cli_put_cut_params,
    .put_facts = cli_put_cut_facts,
};

static cw_status run_cut(void *args, cw_error *err)
{
    cli_cut_state state = {0};
    const cw_status st = cli_run_mesh_command(&cut, args, &state, 2, err);
    cli_free_cut(&state);
    return st;
}

const cli_command cli_cut = {
    .name = "cut",
    .usage = "MESH -o MESH --plane PLANE[,...] [--pegs N] [options]",
    .about = "Cut a solid to pieces for a printer, with pegs between them",
    .page = cli_page_cut,
    .options = options,
    .option_count = sizeof options / sizeof *options,
    .rules = rules,
    .rule_count = sizeof rules / sizeof *rules,
    .min_inputs = 1,
    .max_inputs = 1,
    .inputs = CLI_VALUES_MESH,
    .size = sizeof(cli_cut_args),
    .defaults = &defaults,
    .run = run_cut,
};
