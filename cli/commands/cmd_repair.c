/* The command repair: its options, the work part by part, and what is printed and reported. */
#include "cli/commands/command_rows.h"
#include "cli/commands/mesh_command.h"
#include "cli/commands/repair_facts.h"
#include "cli/framework/console.h"
#include "cli/framework/quantity.h"
#include "core/base/status.h"
#include "core/geometry/box.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

typedef struct repair_args {
    cli_mesh_args mesh;
    cli_length fill, wrap, max_move;
    cli_length weld; /* not given: found */
    bool flat, keep_intersections, outer, report_only;
} repair_args;

enum { WAY_SIZE = 160 }; /* of a text that names a way on */

typedef struct repair_state {
    cw_repair_desc desc;
    cw_repair_facts facts;
    cw_error refusal;   /* of the first part whose repair was refused, and what leads on */
    char way[WAY_SIZE]; /* on, where nothing is left */
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
    {"weld", 0, CLI_LENGTH, "off/L",
     "Merge vertices this near to each other: 0.01mm, 0.001% of the diagonal (of borders, within a "
     "distance that is found)",
     offsetof(repair_args, weld)},
    {"fill", 0, CLI_LENGTH, "L", "Largest hole to fill, across: 5mm, 2% of the diagonal (all)",
     offsetof(repair_args, fill)},
    {"flat", 0, CLI_FLAG, NULL,
     "Fill all holes by the least area (off: smoothly, but where a plane or the box cut much off)",
     offsetof(repair_args, flat)},
    {"keep-intersections", 0, CLI_FLAG, NULL,
     "Leave triangles that intersect each other as they are (off)",
     offsetof(repair_args, keep_intersections)},
    {"outer", 0, CLI_FLAG, NULL,
     "Keep the outer boundary of the solid alone: drop inner walls, closed cavities, and parts "
     "inside of others; merges all parts (off)",
     offsetof(repair_args, outer)},
    {"wrap", 0, CLI_LENGTH, "L",
     "Wrap the mesh after its repair, also a sound one; closes gaps narrower than this; needs "
     "CGAL (GPL)",
     offsetof(repair_args, wrap)},
    {"max-move", 0, CLI_LENGTH, "L",
     "Refuse a result that lies farther from the input, patches of holes left out, or that "
     "changes the volume by twice that share: 0.1mm, 5% (1% of the diagonal)",
     offsetof(repair_args, max_move)},
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
    cli_json_bool(j, "keep_cracks", s->desc.keep_cracks);
    cli_json_number(j, "fill_mm", s->desc.max_hole_mm);
    cli_json_number(j, "max_move_mm", s->desc.max_move_mm);
    cli_json_bool(j, "flat", args->flat);
    cli_json_bool(j, "keep_intersections", args->keep_intersections);
    cli_json_bool(j, "outer", args->outer);
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
    r->reads_parts = r->reads_parts && !args->outer; /* parts may be inside of each other */
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
                               .outer_only = args->outer,
                               .keep_cracks = args->weld.is_word,
                               .threads = r->threads};
    cw_status st = cli_find_length(&r->pieces, "--weld", &args->weld, &s->desc.weld_mm, err);
    if (st == CW_OK)
        st = cli_find_length(&r->pieces, "--fill", &args->fill, &s->desc.max_hole_mm, err);
    if (st == CW_OK)
        st = cli_find_length(&r->pieces, "--wrap", &args->wrap, &s->desc.wrap_mm, err);
    return st == CW_OK ? cli_find_length(&r->pieces, "--max-move", &args->max_move,
                                         &s->desc.max_move_mm, err)
                       : st;
}

/* Returns true if all parts become sound with these settings, and one of them has a volume.
 * lost  set to the triangles that are dropped for that, or replaced */
static bool makes_sound(const cli_mesh_run *r, cw_repair_desc desc, size_t *lost)
{
    bool has_volume = false;
    *lost = 0;
    desc.progress = (cw_progress){0};
    for (size_t n = 0; n < r->pieces.count; n++) {
        cw_repair_facts facts = {0};
        cw_error err = {0};
        const cw_status st =
            cw_mesh_repair(&r->pieces.piece[n].input, &desc, NULL, &facts, &err);
        if (st != CW_ERR_EMPTY && (st != CW_OK || !facts.is_sound))
            return false;
        has_volume = has_volume || st == CW_OK;
        *lost += facts.sheet_triangles + facts.removed_triangles;
    }
    return has_volume;
}

/* Returns the option that leads to a sound result where a repair was refused, found by trying; NULL: none does. */
static const char *find_way(const cli_mesh_run *r)
{
    static const struct way {
        const char *options;
        bool flat, keep_crossings, keep_cracks;
    } ways[] = {
        {"--weld off", false, false, true},
        {"--flat", true, false, false},
        {"--keep-intersections", false, true, false},
        {"--flat --keep-intersections", true, true, false},
    };
    const repair_state *s = r->state;
    size_t lost;
    for (size_t n = 0; n < sizeof ways / sizeof *ways; n++) {
        cw_repair_desc desc = s->desc;
        desc.flat_holes |= ways[n].flat;
        desc.keep_crossings |= ways[n].keep_crossings;
        desc.keep_cracks |= ways[n].keep_cracks && !(desc.weld_mm > 0);
        if ((desc.flat_holes != s->desc.flat_holes ||
             desc.keep_crossings != s->desc.keep_crossings ||
             desc.keep_cracks != s->desc.keep_cracks) &&
            makes_sound(r, desc, &lost))
            return ways[n].options;
    }
    return NULL;
}

/* Names the smallest weld that makes a solid of facets that lie apart, found by trying: alone, or with vertices that move
 * twice as far as usual. Returns false where no weld does, or the mesh is too large to try. */
static bool name_weld(const cli_mesh_run *r, char text[WAY_SIZE])
{
    enum { MAX_TRIANGLES = 200000 }; /* 18 repairs of as many take half a minute */
    static const double percents[] = {0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5};
    static const double MAX_LOST = 0.05; /* of all triangles: more is another shape */
    enum { PERCENTS = sizeof percents / sizeof *percents };
    const repair_state *s = r->state;
    if (r->pieces.triangles > MAX_TRIANGLES || s->facts.one_sided || s->desc.weld_mm > 0)
        return false;
    for (size_t n = 0; n < 2 * PERCENTS; n++) {
        const bool is_wide = n >= PERCENTS && !(s->desc.max_move_mm > 0);
        cw_repair_desc desc = s->desc;
        size_t lost;
        desc.weld_mm = percents[n % PERCENTS] / 100 * r->pieces.diagonal_mm;
        desc.max_move_mm = is_wide ? 0.02 * r->pieces.diagonal_mm : s->desc.max_move_mm;
        desc.keep_cracks = false;
        if (!makes_sound(r, desc, &lost) || !(lost < MAX_LOST * (double)r->pieces.triangles))
            continue;
        snprintf(text, WAY_SIZE, "--weld %g%%%s joins triangles that lie apart",
                 percents[n % PERCENTS], is_wide ? " --max-move 2%" : "");
        return true;
    }
    return false;
}

/* Names the wrap as a way on, at a size that fits any mesh, if this build has it. */
static const char *name_wrap(const char *what, char text[WAY_SIZE])
{
    if (cw_repair_has_cgal())
        snprintf(text, WAY_SIZE, "--wrap 2%% makes a solid %s", what);
    else
        snprintf(text, WAY_SIZE,
                 "a build with CGAL could wrap it: package libcgal-dev, or cubewright-cgal");
    return text;
}

/* The largest --max-move that is advised, as a fraction of the diagonal: beyond that the result is another shape. */
static const double MAX_EXCESS = 0.2;

/* Completes why a repair was refused by what leads on. share: of the diagonal, by which it went too far */
static void name_ways(cli_mesh_run *r, double share, bool is_sound)
{
    repair_state *s = r->state;
    const char *way = find_way(r);
    char other[WAY_SIZE] = "", accept[64] = "";
    const cw_error why = s->refusal;
    is_sound = is_sound && share < MAX_EXCESS;
    if (is_sound)
        snprintf(accept, sizeof accept, "%s--max-move %.0f%% accepts it", way ? ", " : "",
                 ceil(110 * share));
    else if (!way && !name_weld(r, other))
        name_wrap("around it", other);
    snprintf(s->refusal.message, sizeof s->refusal.message,
             "%.200s: nothing is written; %s%s%s%s", why.message, way ? way : "",
             way ? " leads to a sound mesh" : "", accept, other);
}

/* Returns by how much a repair went too far, as a fraction of the diagonal. */
static double measure_excess(const cw_mesh *mesh, const cw_repair_facts *f)
{
    double low[3], high[3];
    cw_mesh_bounds(mesh, low, high);
    return fmax(fmax(f->moved_mm, f->beyond_mm) / cwi_box_diagonal(low, high),
                f->volume_changed / 2);
}

/* Repairs all parts. Those without volume are left out, unless there is no other. */
static cw_status repair_pieces(cli_mesh_run *r, cw_error *err)
{
    repair_state *s = r->state;
    const size_t count = r->pieces.count;
    size_t kept = 0;
    double excess = 0;
    bool is_sound = true; /* what was refused */
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
        if (facts.is_refused) {
            if (!s->refusal.message[0])
                s->refusal = *err;
            excess = fmax(excess, measure_excess(&p->input, &facts));
            is_sound = is_sound && facts.is_sound;
            st = CW_OK;
        }
        if (st == CW_OK && !is_empty)
            r->pieces.piece[kept++] = *p;
        if (st == CW_OK && (is_empty || kept - 1 != n))
            p->out = (cw_mesh){0};
    }
    if (st == CW_OK && !kept && !name_weld(r, s->way))
        name_wrap("of its sheets", s->way);
    r->pieces.count = st == CW_OK ? kept : count;
    if (st == CW_OK && s->refusal.message[0])
        name_ways(r, excess, is_sound);
    return st;
}

/* Returns a volume rounded to the three digits that are known of a surface with holes. */
static double round_volume(double volume_mm3)
{
    const double step = pow(10, floor(log10(volume_mm3)) - 2);
    return round(volume_mm3 / step) * step;
}

static cw_status report_facts(cli_mesh_run *r, cw_error *err)
{
    const repair_state *s = r->state;
    const cw_repair_facts *f = &s->facts;
    cli_print_repair(r->mesh.path, f, s->desc.max_hole_mm, args_of(r)->report_only);
    if (f->is_refused)
        return cwi_fail(err, CW_ERR_CHECK, "%s: %s", r->mesh.path, s->refusal.message);
    if (!r->pieces.count)
        return cwi_fail(err, CW_ERR_EMPTY, "%s: it %s: nothing is left; %s", r->mesh.path,
                        f->one_sided
                            ? "is one-sided (like a Moebius strip), and encloses no volume"
                            : "encloses no volume",
                        s->way);
    const char *crossings = !f->crossings_after && !f->is_undecided ? "no triangles intersect"
                                                                    : "triangles intersect";
    if (f->is_sound && f->volume_before_mm3 > 0)
        snprintf(r->found, sizeof r->found, "; %s; volume %.6g mm3, before about %.6g",
                 crossings, f->volume_after_mm3, round_volume(f->volume_before_mm3));
    else
        snprintf(r->found, sizeof r->found, "; %s", crossings);
    if (f->is_union_lacking)
        cli_report_warn(&r->report,
                        "shells that intersect were not united: rounding found no union");
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

/* Names what helps where defects are left. */
static const char *name_better(const cli_mesh_run *r, char text[WAY_SIZE])
{
    const cw_repair_facts *f = &((const repair_state *)r->state)->facts;
    const double digit = pow(10, floor(log10(f->largest_hole_mm)) - 2);
    if (f->holes_left)
        snprintf(text, WAY_SIZE, "--fill %.10gmm closes %s",
                 (floor(f->largest_hole_mm / digit) + 1) * digit,
                 f->holes_left == 1 ? "it" : "all");
    else if (args_of(r)->wrap.given)
        snprintf(text, WAY_SIZE, "another --wrap may do");
    else if (args_of(r)->keep_intersections && f->crossings_after)
        snprintf(text, WAY_SIZE, "without --keep-intersections they are removed");
    else
        return name_wrap("around it", text);
    return text;
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
    char way[WAY_SIZE];
    return cwi_fail(err, CW_ERR_CHECK, "%s: %s; %s", r->outputs.path[0], left,
                    name_better(r, way));
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
