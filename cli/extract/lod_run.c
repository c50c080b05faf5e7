/* Makes the levels of detail of a surface for `extract --lod`: extracts it, simplifies it level
 * by level, measures each against it, and writes them. */
#include "cli/extract/extract_run.h"

#include "cli/assets/taken_levels.h"
#include "cli/framework/console.h"
#include "cli/inputs/extract_surface.h"
#include "cli/results/detail_levels.h"
#include "core/base/status.h"

#include <stdio.h>
#include <string.h>

/* The levels, and the run that makes them. */
typedef struct lod_run {
    cli_extract_run *run;
    cli_taken_levels taken;
    double moved[3];   /* to the pivot */
    cli_pieces pieces; /* the full surface is the only one */
} lod_run;

static cw_status make_levels(void *state, cw_mesh *levels, cw_error *err)
{
    lod_run *r = state;
    cli_extract_run *s = r->run;
    const char *path = s->input.volume.path;
    cli_made *made = s->output.report.made;
    made->iso = s->args->iso.value[0];
    r->taken.levels = levels;
    cw_status st = cli_extract_run_pipeline(s, NULL, made, cli_level_sink(&r->taken), err);
    if (st == CW_OK)
        st = cli_move_taken(&r->taken, s->args->pivot, r->moved, err);
    if (st != CW_OK)
        return st;
    cli_report_end(&s->output.report, "simplify", r->taken.full.triangle_count,
                   r->taken.triangles);
    cli_say("%s: %s triangles were extracted", path, cli_count(r->taken.full.triangle_count));
    st = cli_take_surface(&r->pieces, path, &r->taken.full, err);
    r->pieces.closed_mm = made->facts.handles.length_mm;
    return st == CW_OK && s->args->check
               ? cli_measure_pieces(&r->pieces, (int)s->args->input.threads, err)
               : st;
}

/* Measures how far a level is from the full surface, both ways. The distance to the field takes
 * minutes where a level is far from it. */
static cw_status measure_level(lod_run *r, cli_made *made, const cw_mesh *level, cw_error *err)
{
    cli_report *report = &r->run->output.report;
    made->compared.other = "the full surface";
    cli_report_begin(report);
    cw_status st =
        cli_compare_pieces(&r->pieces, (int)r->run->args->input.threads, &made->compared, err);
    if (st == CW_OK)
        cli_report_end(report, "measure", r->taken.full.triangle_count, level->triangle_count);
    return st;
}

static cw_status hold_level(lod_run *r, cli_made *made, cw_mesh *level, cw_error *err)
{
    const cli_extract_args *args = r->run->args;
    r->pieces.piece->out = *level;
    cw_status st = cli_hold_pieces(&r->pieces, (int)args->input.threads, err);
    if (st == CW_OK && args->measure)
        st = measure_level(r, made, level, err);
    r->pieces.piece->out = (cw_mesh){0};
    return st;
}

static cw_status finish_level(void *state, cli_made *made, cw_mesh *level, cw_error *err)
{
    lod_run *r = state;
    made->iso = r->run->args->iso.value[0];
    made->facts = r->taken.facts[level - r->taken.levels];
    memcpy(made->pivot, r->moved, sizeof made->pivot);
    made->least_mm3 = r->run->output.report.made->least_mm3;
    return r->run->args->check ? hold_level(r, made, level, err) : CW_OK;
}

/* Writes "to 50000, 12000 triangles", for the record of a file. */
static void print_counts(const cli_counts *lod, size_t first, size_t end, char *text,
                         size_t size)
{
    size_t used = (size_t)snprintf(text, size, "to ");
    for (size_t n = first; n < end && used < size; n++)
        used += (size_t)snprintf(text + used, size - used, "%s%zu", n > first ? ", " : "",
                                 lod->n[n]);
    if (used < size)
        snprintf(text + used, size - used, " triangles");
}

static cw_status deliver_levels(void *state, size_t file, const cw_part *parts, size_t count,
                                cw_error *err)
{
    lod_run *r = state;
    cli_extract_run *s = r->run;
    const cli_counts *lod = &r->taken.lod;
    const bool all = file == r->taken.lod.count;
    cli_making making;
    char simplified[CLI_MAX_COUNTS * 24];
    cw_provenance lines[CLI_EXTRACT_PROVENANCE];
    cli_delivery how = cli_extract_describe_delivery(s);
    const size_t line_count = cli_extract_provenance(s, 0, &making, lines);
    print_counts(lod, all ? 0 : file, all ? file : file + 1, simplified, sizeof simplified);
    lines[line_count] = (cw_provenance){"simplified", simplified};
    how.write.provenance = lines;
    how.write.provenance_count = line_count + 1;
    how.unchecked = how.unchecked || all; /* each was by itself */
    how.parts = all ? "levels" : NULL;
    const cli_made *made = &s->output.report.made[s->output.report.made_count - 1];
    cw_status st =
        !made->path ? cli_deliver_step(&s->output.report, &how, parts->mesh,
                                       made->facts.extracted.border_loops, s->output.start, err)
                    : cli_deliver(&s->output.report, &how, parts, count,
                                  s->output.report.made->facts.extracted.border_loops,
                                  s->output.start, err);
    s->output.start = cli_seconds();
    return st;
}

cw_status cli_extract_make_lod(cli_extract_run *s, cw_error *err)
{
    lod_run r = {.run = s,
                 .taken = {.lod = s->args->lod, .drops_equal = s->args->fills_levels}};
    cli_detail_levels levels = {.lod = &r.taken.lod,
                                .name = s->args->name,
                                .files = &s->output.files,
                                .report = &s->output.report,
                                .pieces = &r.pieces,
                                .is_budget = cli_extract_asset(s->args),
                                .maps = &r.taken.maps,
                                .make = make_levels,
                                .finish = finish_level,
                                .deliver = deliver_levels,
                                .user = &r};
    cw_status st = cli_make_detail_levels(&levels, err);
    if (st == CW_OK)
        st = cli_write_maps(&r.taken.maps, s->output.files.path[s->output.files.count - 1],
                            s->args->no_clobber, err);
    cli_free_detail_levels(&levels);
    cli_free_pieces(&r.pieces);
    cli_free_taken(&r.taken);
    return st;
}
