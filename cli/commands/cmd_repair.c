/* The command repair: its options, the work part by part, and what is printed and reported. */
#include "cli/commands/command_rows.h"
#include "cli/commands/mesh_command.h"
#include "cli/commands/repair_facts.h"
#include "cli/framework/console.h"
#include "core/base/status.h"

#include <stdio.h>

typedef struct repair_args {
    cli_mesh_args mesh;
    cli_length weld, fill, wrap;
    bool flat, keep_intersections, report_only;
} repair_args;

typedef struct repair_state {
    cw_repair_desc desc;
    cw_repair_facts facts;
} repair_state;

static const repair_args *args_of(const cli_mesh_run *r)
{
    return (const repair_args *)r->args;
}

static const repair_args defaults = {.mesh.measure = true};

static const cli_option options[] = {
    CLI_MESH_OUTPUT(""),
    {"report-only", 0, CLI_FLAG, NULL,
     "Write no mesh; tell what is wrong and what would be done; exit 1 if anything is (off)",
     offsetof(repair_args, report_only)},
    CLI_HEADED("Repair"),
    {"weld", 0, CLI_LENGTH, "L",
     "Merge vertices this near to each other: 0.01mm, 0.001% of the diagonal (equal positions)",
     offsetof(repair_args, weld)},
    {"fill", 0, CLI_LENGTH, "L", "Largest hole to fill, across: 5mm, 2% of the diagonal (all)",
     offsetof(repair_args, fill)},
    {"flat", 0, CLI_FLAG, NULL,
     "Fill holes by the least area (off: smoothly, so that an open tube gets domes)",
     offsetof(repair_args, flat)},
    {"keep-intersections", 0, CLI_FLAG, NULL,
     "Leave triangles that intersect each other as they are (off)",
     offsetof(repair_args, keep_intersections)},
    {"wrap", 0, CLI_LENGTH, "L",
     "Last resort: if defects are left, wrap the mesh; closes gaps narrower than this; needs "
     "CGAL (GPL)",
     offsetof(repair_args, wrap)},
    CLI_HEADED("What is read and reported"),
    CLI_MESH_MERGE,
    CLI_MESH_MEASURE("Measure the distance to the input (on; --no-measure)"),
    CLI_MESH_COMMON,
};

static const cli_rule rules[] = {
    {NULL, CLI_NEEDS, "output report-only"},
    {"output", CLI_EXCLUDES, "report-only"},
    CLI_COMPRESS_RULES,
};

/* --- the report --------------------------------------------------------------------------- */

static void put_params(cli_json *j, const cli_mesh_run *r, const cli_made *made)
{
    const repair_args *args = args_of(r);
    const repair_state *s = r->state;
    cli_json_number(j, "weld_mm", s->desc.weld_mm);
    cli_json_number(j, "fill_mm", s->desc.max_hole_mm);
    cli_json_bool(j, "flat", args->flat);
    cli_json_bool(j, "keep_intersections", args->keep_intersections);
    cli_json_number(j, "wrap_mm", s->desc.wrap_mm);
    cli_json_bool(j, "report_only", args->report_only);
    cli_json_bool(j, "merge", r->args->merge);
    if (made->path)
        cli_json_written(j, &r->args->written, made->path);
}

static void put_facts(cli_json *j, const cli_mesh_run *r)
{
    const repair_state *s = r->state;
    if (!r->is_made)
        return;
    cli_json_open(j, "repair", '{');
    cli_json_repair(j, &s->facts);
    cli_json_close(j, '}');
}

/* Fails before any work when a wrap is asked for that this build cannot make. */
static cw_status check_values(cli_mesh_run *r, cw_error *err)
{
    const repair_args *args = args_of(r);
    if (args->report_only)
        r->reads_parts = !r->args->merge;
    if (!args->wrap.given || cw_repair_has_cgal())
        return CW_OK;
    return cwi_fail(err, CW_ERR_UNSUPPORTED,
                    "--wrap needs CGAL, which this build has not: package libcgal-dev, or "
                    "cubewright-cgal");
}

/* --- work --------------------------------------------------------------------------------- */

static cw_status resolve_lengths(cli_mesh_run *r, cw_error *err)
{
    const repair_args *args = args_of(r);
    repair_state *s = r->state;
    s->desc = (cw_repair_desc){.flat_holes = args->flat,
                               .keep_crossings = args->keep_intersections,
                               .threads = r->threads};
    cw_status st = cli_find_length(&r->pieces, "--weld", &args->weld, &s->desc.weld_mm, err);
    if (st == CW_OK)
        st = cli_find_length(&r->pieces, "--fill", &args->fill, &s->desc.max_hole_mm, err);
    return st == CW_OK
               ? cli_find_length(&r->pieces, "--wrap", &args->wrap, &s->desc.wrap_mm, err)
               : st;
}

/* Repairs all parts. Those without volume are left out, unless there is no other. */
static cw_status repair_pieces(cli_mesh_run *r, cw_error *err)
{
    repair_state *s = r->state;
    const size_t count = r->pieces.count;
    size_t kept = 0;
    cw_status st = CW_OK;
    for (size_t n = 0; n < count && st == CW_OK; n++) {
        cli_piece *p = &r->pieces.piece[n];
        cw_repair_facts facts = {0};
        s->desc.progress = cli_progress((double)p->input.triangle_count / 1e6, "Mtriangle");
        st = cw_mesh_repair(&p->input, &s->desc, args_of(r)->report_only ? NULL : &p->out,
                            &facts, err);
        const bool is_empty = st == CW_ERR_EMPTY;
        if (is_empty) {
            facts.is_sound = true;
            st = CW_OK;
        }
        cli_add_repair(&s->facts, &facts, n == 0);
        if (st == CW_OK && !is_empty)
            r->pieces.piece[kept++] = *p;
        if (st == CW_OK && (is_empty || kept - 1 != n))
            p->out = (cw_mesh){0};
    }
    r->pieces.count = st == CW_OK ? kept : count;
    return st;
}

static cw_status report_facts(cli_mesh_run *r, cw_error *err)
{
    const repair_state *s = r->state;
    const cw_repair_facts *f = &s->facts;
    cli_print_repair(r->mesh.path, f, s->desc.max_hole_mm, args_of(r)->report_only);
    if (!r->pieces.count)
        return cwi_fail(
            err, CW_ERR_EMPTY,
            "%s: it encloses no volume: nothing is left; --wrap 0.5mm makes a solid "
            "of its sheets",
            r->mesh.path);
    snprintf(r->found, sizeof r->found, "; %s",
             !f->crossings_after && !f->is_undecided ? "no triangles intersect"
                                                     : "triangles intersect");
    if (f->lacks_cgal)
        cli_report_warn(&r->report, "shells that intersect were not united, which needs CGAL "
                                    "(libcgal-dev): triangles around were replaced");
    return CW_OK;
}

/* Ends a report: fails if a repair is needed. left: defects that stay */
static cw_status judge_input(const cli_mesh_run *r, const char *left, cw_error *err)
{
    const repair_state *s = r->state;
    const char *path = r->mesh.path;
    if (!s->facts.is_needed) {
        cli_result("%s: closed, manifold, and no triangles intersect: nothing to repair\n",
                   path);
        return CW_OK;
    }
    return *left ? cwi_fail(err, CW_ERR_CHECK, "%s: needs repair, and then %s", path, left)
                 : cwi_fail(err, CW_ERR_CHECK, "%s: needs repair, which makes it sound", path);
}

/* Tells what is left in the mesh that was written, and what may help. */
static cw_status judge_result(cli_mesh_run *r, cw_error *err)
{
    char left[128];
    const repair_state *s = r->state;
    cli_name_left_defects(&s->facts, left, sizeof left);
    if (args_of(r)->report_only)
        return judge_input(r, left, err);
    if (!left[0])
        return CW_OK;
    const char *advice = s->facts.holes_left      ? "a larger --fill closes more"
                         : args_of(r)->wrap.given ? "try another --wrap"
                                                  : "--wrap 0.5mm makes a solid around it";
    return cwi_fail(err, CW_ERR_CHECK, "%s: %s; %s", r->outputs.path[0], left, advice);
}

static const cli_mesh_command repair = {
    .name = "repair",
    .piecing = CLI_PIECES_AS_READ,
    .check = check_values,
    .resolve = resolve_lengths,
    .work = repair_pieces,
    .report = report_facts,
    .judge = judge_result,
    .put_params = put_params,
    .put_facts = put_facts,
};

static cw_status run_repair(void *args, cw_error *err)
{
    repair_state state = {0};
    return cli_run_mesh_command(&repair, args, &state, 1, err);
}

const cli_command cli_repair = {
    .name = "repair",
    .usage = "MESH -o MESH [--fill L] [--wrap L] [options]",
    .about = "Repair a broken mesh: a closed manifold without intersections",
    .page = cli_page_repair,
    .options = options,
    .option_count = sizeof options / sizeof *options,
    .rules = rules,
    .rule_count = sizeof rules / sizeof *rules,
    .min_inputs = 1,
    .max_inputs = 1,
    .inputs = CLI_VALUES_MESH,
    .size = sizeof(repair_args),
    .defaults = &defaults,
    .run = run_repair,
};
