/* The command boolean: reads several meshes, unites, subtracts or intersects them, and says what happened. */
#include "cli/commands/command_rows.h"
#include "cli/commands/mesh_command.h"
#include "cli/framework/console.h"
#include "cli/framework/name_template.h"
#include "cli/framework/quantity.h"
#include "core/base/memory.h"
#include "core/base/status.h"

#include <cubewright/boolean.h>

#include <stdio.h>
#include <stdlib.h>

typedef struct boolean_args {
    cli_mesh_args mesh;
    int op; /* a cw_boolean_op */
} boolean_args;

typedef struct boolean_state {
    cli_mesh *others; /* the meshes but the first */
    size_t count;
    uint8_t *inputs; /* of each mesh: flags of cw_boolean_input */
    cw_boolean_facts facts;
    char names[2][256]; /* of the parts of a split */
} boolean_state;

static const boolean_args defaults = {.op = CW_BOOLEAN_UNION};

#define OPERATIONS "union/difference/intersection/xor/split"
static const char *const operations[] = {"union", "difference", "intersection", "xor", "split"};

static const cli_option options[] = {
    CLI_MESH_OUTPUT(""),
    {"op", 0, CLI_CHOICE, OPERATIONS,
     "What is kept: inside of any mesh, of the first one alone, of all, of an odd number; or the first one "
     "in two parts, outside of the others and inside (union)",
     offsetof(boolean_args, op)},
    CLI_MESH_COMMON,
};

static const cli_rule rules[] = {
    {NULL, CLI_NEEDS, "output"},
    CLI_COMPRESS_RULES,
};

static int op_of(const cli_mesh_run *r)
{
    return ((const boolean_args *)r->args)->op;
}

static size_t results_of(const cli_mesh_run *r)
{
    return op_of(r) == CW_BOOLEAN_SPLIT ? 2 : 1;
}

/* --- the report --------------------------------------------------------------------------- */

static const char *path_of(const cli_mesh_run *r, size_t n)
{
    return n ? ((const boolean_state *)r->state)->others[n - 1].path : r->mesh.path;
}

static size_t count_inputs(const cli_mesh_run *r, cw_boolean_input flag)
{
    const boolean_state *s = r->state;
    size_t count = 0;
    for (size_t n = 0; n <= s->count; n++)
        count += (s->inputs[n] & flag) != 0;
    return count;
}

/* Warns of the files that have a flag, by their names. */
static void warn_of_inputs(cli_mesh_run *r, cw_boolean_input flag, const char *what)
{
    enum { MAX_NAMED = 3 };
    const boolean_state *s = r->state;
    const size_t count = count_inputs(r, flag);
    size_t named = 0, used = 0;
    char names[160] = "";
    for (size_t n = 0; n <= s->count && named < MAX_NAMED && used < sizeof names; n++)
        if (s->inputs[n] & flag)
            used += (size_t)snprintf(names + used, sizeof names - used, "%s%s",
                                     named++ ? ", " : "", path_of(r, n));
    if (count > named)
        cli_report_warn(&r->report, "%s and %s more: %s", names, cli_count(count - named),
                        what);
    else if (count)
        cli_report_warn(&r->report, "%s: %s", names, what);
}

/* Warns of shells whose volume is lost; what is less than a millionth comes from surfaces that cross themselves. */
static void warn_of_negative(cli_mesh_run *r, const cw_boolean_facts *f)
{
    char what[160];
    if (f->negative_mm3 <= 1e-6 * (f->volume_mm3[0] + f->volume_mm3[1]))
        return;
    snprintf(what, sizeof what,
             "%s shell%s inside out, with %.6g mm3 that count as outside; 'convert --orient' "
             "turns %s",
             cli_count(f->negative_regions), f->negative_regions == 1 ? " is" : "s are",
             f->negative_mm3, f->negative_regions == 1 ? "it" : "them");
    warn_of_inputs(r, CW_BOOLEAN_NEGATIVE, what);
}

static void put_params(cli_json *j, const cli_mesh_run *r, const cli_made *made)
{
    cli_json_text(j, "op", operations[op_of(r)]);
    cli_json_written(j, &r->args->written, made->path);
}

static void put_facts(cli_json *j, const cli_mesh_run *r)
{
    const boolean_state *s = r->state;
    const cw_boolean_facts *f = &s->facts;
    cli_json_open(j, "others", '[');
    for (size_t n = 0; n < s->count; n++)
        if (s->others[n].file.format)
            cli_json_mesh_file(j, NULL, &s->others[n]);
    cli_json_close(j, ']');
    if (!r->is_made)
        return;
    cli_json_open(j, "boolean", '{');
    cli_json_open(j, "volumes_mm3", '[');
    for (size_t n = 0; n < results_of(r); n++)
        cli_json_number(j, NULL, f->volume_mm3[n]);
    cli_json_close(j, ']');
    cli_json_count(j, "split_triangles", f->split_triangles);
    cli_json_count(j, "new_points", f->new_points);
    cli_json_count(j, "contact_edges", f->contact_edges);
    cli_json_count(j, "contact_vertices", f->contact_vertices);
    cli_json_count(j, "triangles_without_area", f->dropped);
    cli_json_count(j, "turned_inputs", f->turned);
    cli_json_count(j, "empty_inputs", count_inputs(r, CW_BOOLEAN_EMPTY));
    cli_json_count(j, "negative_regions", f->negative_regions);
    cli_json_number(j, "negative_mm3", f->negative_mm3);
    cli_json_count(j, "rounds", f->rounds);
    cli_json_number(j, "moved_mm", f->moved_mm);
    cli_json_close(j, '}');
}

/* Prints facts for the line: doubled vertices as well where the format cannot keep them apart. */
static void print_found(cli_mesh_run *r, const cw_boolean_facts *f)
{
    const cw_format *format = cw_mesh_format(r->args->output, r->args->written.format);
    size_t used = 0;
    if (f->contact_vertices && format && !(format->keeps & CW_KEEPS_SHARING))
        used = (size_t)snprintf(
            r->found, sizeof r->found,
            "; manifold but for contacts once read, as %s joins the doubled vertices",
            format->name);
    if (f->split_triangles)
        snprintf(r->found + used, sizeof r->found - used,
                 "; triangles split %s, points new %s, moved by up to %.2g mm",
                 cli_count(f->split_triangles), cli_count(f->new_points), f->moved_mm);
}

static cw_status report_facts(cli_mesh_run *r, cw_error *err)
{
    const cw_boolean_facts *f = &((const boolean_state *)r->state)->facts;
    warn_of_inputs(r, CW_BOOLEAN_TURNED, "inside out, and turned");
    warn_of_inputs(r, CW_BOOLEAN_EMPTY, "no triangle has an area: taken as empty");
    warn_of_negative(r, f);
    if (f->contact_vertices)
        cli_say("%s: the result touches itself: contact edges %s, doubled vertices %s",
                r->outputs.path[0], cli_count(f->contact_edges),
                cli_count(f->contact_vertices));
    if (!cli_made_triangles(r))
        return cwi_fail(
            err, CW_ERR_EMPTY,
            f->split_triangles
                ? "nothing is left: the meshes touch, and no volume is inside of the %s"
                : "nothing is left: no volume is inside of the %s",
            operations[op_of(r)]);
    print_found(r, f);
    return CW_OK;
}

/* --- work --------------------------------------------------------------------------------- */

static cw_status check_values(cli_mesh_run *r, cw_error *err)
{
    const cw_format *format = cw_mesh_format(r->args->output, r->args->written.format);
    r->reads_parts = false;
    if (op_of(r) == CW_BOOLEAN_SPLIT && format && !(format->keeps & CW_KEEPS_PARTS))
        return cwi_fail(
            err, CW_ERR_ARGUMENT,
            "--op split gives two parts, and %s has none: choose 3MF, OBJ or glTF, or run "
            "--op difference and --op intersection",
            format->name);
    return CW_OK;
}

static cw_status read_others(cli_mesh_run *r, cw_error *err)
{
    boolean_state *s = r->state;
    const size_t count = r->args->common.input_count - 1;
    s->others = calloc(count ? count : 1, sizeof *s->others);
    s->inputs = calloc(count + 1, sizeof *s->inputs);
    if (!s->others || !s->inputs)
        return cwi_fail_memory(err);
    for (; s->count < count; s->count++) {
        const char *path = r->args->common.inputs[s->count + 1];
        const cw_status st =
            cli_read_mesh(path, r->reader, &r->args->input, &s->others[s->count], err);
        if (st != CW_OK)
            return st;
    }
    return CW_OK;
}

static cw_status make_pieces(cli_mesh_run *r, cw_error *err)
{
    static const char *const places[2] = {"outside", "inside"};
    boolean_state *s = r->state;
    char *stem = cli_stem(r->mesh.path);
    r->pieces = (cli_pieces){.path = r->mesh.path, .piece = calloc(2, sizeof *r->pieces.piece)};
    for (int n = 0; n < 2 && stem; n++)
        snprintf(s->names[n], sizeof s->names[n], "%s %s", stem, places[n]);
    free(stem);
    if (!r->pieces.piece || !stem)
        return cwi_fail_memory(err);
    r->pieces.count = results_of(r);
    r->pieces.triangles = cli_mesh_triangles(&r->mesh);
    for (size_t n = 0; n < s->count; n++)
        r->pieces.triangles += cli_mesh_triangles(&s->others[n]);
    for (size_t n = 0; n < 2 && r->pieces.count == 2; n++)
        r->pieces.piece[n].name = s->names[n];
    return CW_OK;
}

static cw_status run_operation(cli_mesh_run *r, cw_error *err)
{
    boolean_state *s = r->state;
    cw_mesh out[2] = {{0}, {0}};
    const cw_mesh **meshes = calloc(s->count + 1, sizeof *meshes);
    if (!meshes)
        return cwi_fail_memory(err);
    meshes[0] = &r->mesh.mesh;
    for (size_t n = 0; n < s->count; n++)
        meshes[n + 1] = &s->others[n].mesh;
    const cw_boolean_desc desc = {
        .op = (cw_boolean_op)op_of(r),
        .threads = r->threads,
        .inputs = s->inputs,
        .progress = cli_progress((double)r->pieces.triangles / 1e6, "Mtriangle")};
    const cw_status st = cw_mesh_boolean(meshes, s->count + 1, &desc, out, &s->facts, err);
    free(meshes);
    if (s->facts.open_mesh > 1)
        r->blamed = s->others[s->facts.open_mesh - 2].path;
    for (size_t n = 0; n < r->pieces.count; n++) {
        cw_mesh_attribute_remove(&out[n], "input"); /* which no format holds */
        r->pieces.piece[n].out = out[n];
    }
    if (st == CW_OK && r->pieces.count == 2) /* a part that is empty is none */
        for (size_t n = 2; n-- > 0;)
            if (!r->pieces.piece[n].out.triangle_count &&
                r->pieces.piece[1 - n].out.triangle_count) {
                cw_mesh_free(&r->pieces.piece[n].out);
                r->pieces.piece[0] = r->pieces.piece[1 - n];
                r->pieces.count = 1;
                cli_report_warn(&r->report, "one part is empty: all is %s the other meshes",
                                n ? "outside of" : "inside of");
                break;
            }
    return st;
}

static const cli_mesh_command boolean = {
    .name = "boolean",
    .piecing = CLI_PIECES_NONE,
    .check = check_values,
    .prepare = read_others,
    .resolve = make_pieces,
    .work = run_operation,
    .loses_texture = true,
    .report = report_facts,
    .put_params = put_params,
    .put_facts = put_facts,
};

static cw_status run_boolean(void *args, cw_error *err)
{
    boolean_state state = {0};
    const cw_status st = cli_run_mesh_command(&boolean, args, &state, 2, err);
    for (size_t n = 0; n < state.count; n++)
        cli_free_mesh(&state.others[n]);
    free(state.others);
    free(state.inputs);
    return st;
}

const cli_command cli_boolean = {
    .name = "boolean",
    .usage = "MESH... -o MESH [--op " OPERATIONS "] [options]",
    .about = "Unite, subtract or intersect solids",
    .page = cli_page_boolean,
    .options = options,
    .option_count = sizeof options / sizeof *options,
    .rules = rules,
    .rule_count = sizeof rules / sizeof *rules,
    .min_inputs = 1,
    .max_inputs = SIZE_MAX,
    .inputs = CLI_VALUES_MESH,
    .size = sizeof(boolean_args),
    .defaults = &defaults,
    .run = run_boolean,
};
