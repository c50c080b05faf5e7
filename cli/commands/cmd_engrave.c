/* The command engrave: cuts text into a solid, or raises it. */
#include "cli/commands/command_rows.h"
#include "cli/commands/mesh_command.h"
#include "cli/framework/console.h"
#include "cli/framework/quantity.h"
#include "cli/letters/engraved_text.h"
#include "core/base/memory.h"
#include "core/base/status.h"

#include <stdio.h>
#include <stdlib.h>

typedef struct engrave_args {
    cli_mesh_args mesh;
    const char *text;
    cli_length size, depth, stroke, wall;
    cli_numbers at, direction;
    bool emboss;
} engrave_args;

/* The text of a piece, and what became of it. */
typedef struct engraved_piece {
    char *text;
    cw_engrave_facts facts;
} engraved_piece;

typedef struct engrave_state {
    engraved_piece *pieces;
    size_t count;
} engrave_state;

static const engrave_args defaults = {0};

static const cli_option options[] = {
    CLI_MESH_OUTPUT(""),
    {"text", 0, CLI_TEXT, "TEXT",
     "Text in one line; may hold {stem}, {parent}, and of parts {name} and {label}",
     offsetof(engrave_args, text)},
    {"emboss", 0, CLI_FLAG, NULL, "Raise the text (off: it is cut in)",
     offsetof(engrave_args, emboss)},
    {"size", 0, CLI_MESH_LENGTH, "L",
     "Height of capitals: 5mm (as large as fits, up to 10% of the diagonal)",
     offsetof(engrave_args, size)},
    {"depth", 0, CLI_MESH_LENGTH, "L", "Depth, or height with --emboss (an eighth of the size)",
     offsetof(engrave_args, depth)},
    {"stroke", 0, CLI_MESH_LENGTH, "L", "Width of strokes (a seventh of the size)",
     offsetof(engrave_args, stroke)},
    {"wall", 0, CLI_MESH_LENGTH, "L",
     "Least material behind the text (0.8mm, or twice the depth if that is less)",
     offsetof(engrave_args, wall)},
    CLI_HEADED("Place"),
    {"at", 0, CLI_NUMBERS, "X,Y,Z",
     "Point in mm next to the middle of the text (the flattest place that is large enough)",
     offsetof(engrave_args, at)},
    {"direction", 0, CLI_NUMBERS, "X,Y,Z",
     "Direction out of the solid that the text faces, such as 0,-1,0 (that of the surface)",
     offsetof(engrave_args, direction)},
    CLI_MESH_MERGE,
    CLI_MESH_ORIENT,
    CLI_MESH_COMMON,
};

static const cli_rule rules[] = {
    {NULL, CLI_NEEDS, "output"},
    {NULL, CLI_NEEDS, "text"},
    CLI_COMPRESS_RULES,
};

static const engrave_args *args_of(const cli_mesh_run *r)
{
    return (const engrave_args *)r->args;
}

/* --- the report --------------------------------------------------------------------------- */

static void put_params(cli_json *j, const cli_mesh_run *r, const cli_made *made)
{
    const engrave_args *args = args_of(r);
    cli_json_text(j, "text", args->text);
    cli_json_bool(j, "emboss", args->emboss);
    if (args->at.count)
        cli_json_numbers(j, "at", args->at.value, 3);
    if (args->direction.count)
        cli_json_numbers(j, "direction", args->direction.value, 3);
    cli_json_written(j, &r->args->written, made->path);
}

static void put_facts(cli_json *j, const cli_mesh_run *r)
{
    const engrave_state *s = r->state;
    if (!r->is_made)
        return;
    cli_json_open(j, "engraved", '[');
    for (size_t n = 0; n < s->count; n++) {
        cli_json_open(j, NULL, '{');
        cli_json_text(j, "text", s->pieces[n].text);
        cli_json_engraved(j, &s->pieces[n].facts);
        cli_json_close(j, '}');
    }
    cli_json_close(j, ']');
}

static cw_status report_facts(cli_mesh_run *r, cw_error *err)
{
    const engrave_state *s = r->state;
    (void)err;
    for (size_t n = 0; n < s->count; n++) {
        char name[128];
        snprintf(name, sizeof name, "'%.100s'", s->pieces[n].text);
        cli_tell_engraved(name, &s->pieces[n].facts);
    }
    return CW_OK;
}

/* --- work --------------------------------------------------------------------------------- */

static cw_status check_values(cli_mesh_run *r, cw_error *err)
{
    const engrave_args *args = args_of(r);
    const struct {
        const char *name;
        const cli_numbers *numbers;
    } points[] = {{"at", &args->at}, {"direction", &args->direction}};
    const struct {
        const char *name;
        const cli_length *length;
    } lengths[] = {{"size", &args->size},
                   {"depth", &args->depth},
                   {"stroke", &args->stroke},
                   {"wall", &args->wall}};
    for (size_t n = 0; n < sizeof points / sizeof *points; n++)
        if (points[n].numbers->count && points[n].numbers->count != 3)
            return cwi_fail(err, CW_ERR_ARGUMENT, "--%s has %zu numbers; it takes three: x,y,z",
                            points[n].name, points[n].numbers->count);
    if (args->direction.count && args->direction.value[0] == 0 &&
        args->direction.value[1] == 0 && args->direction.value[2] == 0)
        return cwi_fail(err, CW_ERR_ARGUMENT, "--direction is 0,0,0; it needs a length");
    for (size_t n = 0; n < sizeof lengths / sizeof *lengths; n++)
        if (lengths[n].length->given && !(lengths[n].length->value > 0))
            return cwi_fail(err, CW_ERR_ARGUMENT, "--%s is %s; it must be above 0",
                            lengths[n].name, cli_length_text(lengths[n].length));
    return CW_OK;
}

static cw_status engrave_piece(cli_mesh_run *r, cw_engrave_desc desc, size_t n, cw_error *err)
{
    engrave_state *s = r->state;
    cli_piece *piece = &r->pieces.piece[n];
    engraved_piece *made = &s->pieces[s->count++];
    cw_status st = cli_fill_engraved_text(args_of(r)->text, r->args->common.inputs[0],
                                          piece->name, piece->label, &made->text, err);
    if (st != CW_OK)
        return cwi_fail_in(err, st, "--text");
    desc.text = made->text;
    st = cw_mesh_engrave(&piece->input, &desc, &piece->out, &made->facts, err);
    return st != CW_OK && piece->name && r->pieces.count > 1 ? cwi_fail_in(err, st, piece->name)
                                                             : st;
}

static cw_status engrave_pieces(cli_mesh_run *r, cw_error *err)
{
    const engrave_args *args = args_of(r);
    engrave_state *s = r->state;
    cw_engrave_desc desc = {.emboss = args->emboss,
                            .has_at = args->at.count > 0,
                            .threads = r->threads,
                            .progress =
                                cli_progress((double)r->pieces.triangles / 1e6, "Mtriangle")};
    const struct {
        const char *option;
        const cli_length *length;
        double *mm;
    } lengths[] = {{"size", &args->size, &desc.size_mm},
                   {"depth", &args->depth, &desc.depth_mm},
                   {"stroke", &args->stroke, &desc.stroke_mm},
                   {"wall", &args->wall, &desc.wall_mm}};
    for (size_t n = 0; n < sizeof lengths / sizeof *lengths; n++) {
        const cw_status st = cli_find_length(&r->pieces, lengths[n].option, lengths[n].length,
                                             lengths[n].mm, err);
        if (st != CW_OK)
            return st;
    }
    for (int a = 0; a < 3; a++) {
        desc.at[a] = desc.has_at ? args->at.value[a] : 0;
        desc.direction[a] = args->direction.count ? args->direction.value[a] : 0;
    }
    if (desc.has_at && r->pieces.count > 1)
        return cwi_fail(
            err, CW_ERR_ARGUMENT,
            "--at is one point, and there are %zu parts: --merge makes them one mesh",
            r->pieces.count);
    s->pieces = calloc(r->pieces.count, sizeof *s->pieces);
    if (!s->pieces)
        return cwi_fail_memory(err);
    for (size_t n = 0; n < r->pieces.count; n++) {
        const cw_status st = engrave_piece(r, desc, n, err);
        if (st != CW_OK)
            return st;
    }
    return CW_OK;
}

static const cli_mesh_command engrave = {
    .name = "engrave",
    .check = check_values,
    .work = engrave_pieces,
    .loses_texture = true,
    .report = report_facts,
    .put_params = put_params,
    .put_facts = put_facts,
};

static cw_status run_engrave(void *args, cw_error *err)
{
    engrave_state state = {0};
    const cw_status st = cli_run_mesh_command(&engrave, args, &state, 1, err);
    for (size_t n = 0; n < state.count; n++)
        free(state.pieces[n].text);
    free(state.pieces);
    return st;
}

const cli_command cli_engrave = {
    .name = "engrave",
    .usage = "MESH -o MESH --text TEXT [--size L] [--depth L] [--emboss] [options]",
    .about = "Engrave text into a solid, or raise it",
    .page = cli_page_engrave,
    .options = options,
    .option_count = sizeof options / sizeof *options,
    .rules = rules,
    .rule_count = sizeof rules / sizeof *rules,
    .min_inputs = 1,
    .max_inputs = 1,
    .inputs = CLI_VALUES_MESH,
    .size = sizeof(engrave_args),
    .defaults = &defaults,
    .run = run_engrave,
};
