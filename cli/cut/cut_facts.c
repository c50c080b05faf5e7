/* The report of the command cut: in the line, in notes and as JSON. */
#include "cli/cut/cut_facts.h"

#include "cli/framework/console.h"
#include "cli/framework/quantity.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const cli_cut_args *args_of(const cli_mesh_run *r)
{
    return (const cli_cut_args *)r->args;
}

/* --- JSON --------------------------------------------------------------------------------- */

void cli_put_cut_params(cli_json *j, const cli_mesh_run *r, const cli_made *made)
{
    const cli_cut_state *s = r->state;
    const cli_cut_args *args = args_of(r);
    const cw_pieces_desc *d = &s->cut.settings;
    char text[CLI_MAX_PLANES * 100];
    cli_kind_planes.print(NULL, &args->planes, text, sizeof text);
    if (args->planes.count)
        cli_json_text(j, "plane", text);
    if (args->plate.given)
        cli_json_numbers(j, "plate_mm", args->plate.mm, 3);
    cli_json_count(j, "pegs", args->pegs);
    if (s->cut.peg_count) {
        cli_json_text(j, "peg_kind", d->dowels ? "dowel" : "peg");
        cli_json_number(j, "peg_diameter_mm", d->peg_diameter_mm);
        cli_json_number(j, "peg_length_mm", d->peg_length_mm);
        cli_json_number(j, "clearance_mm", d->clearance_mm);
        cli_json_number(j, "wall_mm", d->wall_mm);
    }
    cli_json_bool(j, "lay", args->lay);
    cli_json_written(j, &r->args->written, made->path);
}

static void put_pieces(cli_json *j, const cw_pieces *p, bool are_laid)
{
    cli_json_open(j, "pieces", '[');
    for (size_t n = 0; n < p->count; n++) {
        const cw_piece *piece = &p->pieces[n];
        cli_json_open(j, NULL, '{');
        cli_json_text(j, "name", piece->name);
        cli_json_number(j, "volume_mm3", piece->volume_mm3);
        cli_json_count(j, "pegs", piece->pegs);
        cli_json_count(j, "holes", piece->holes);
        if (are_laid) {
            cli_json_count(j, "plate", piece->plate);
            cli_json_number(j, "foot_mm2", piece->foot_mm2);
            cli_json_numbers(j, "placed", piece->placed, 12);
        }
        cli_json_close(j, '}');
    }
    cli_json_close(j, ']');
}

static void put_sections(cli_json *j, const cw_pieces *p)
{
    cli_json_open(j, "sections", '[');
    for (size_t n = 0; n < p->section_count; n++) {
        const cw_piece_section *s = &p->sections[n];
        cli_json_open(j, NULL, '{');
        cli_json_count(j, "plane", s->plane + 1);
        cli_json_text(j, "below", p->pieces[s->below].name);
        cli_json_text(j, "above", p->pieces[s->above].name);
        cli_json_number(j, "area_mm2", s->area_mm2);
        if (p->settings.pegs) {
            cli_json_count(j, "regions", s->regions);
            cli_json_count(j, "pegs", s->pegs);
            cli_json_number(j, "widest_peg_mm", s->widest_mm);
        }
        cli_json_close(j, '}');
    }
    cli_json_close(j, ']');
}

static void put_pegs(cli_json *j, const cw_pieces *p)
{
    cli_json_open(j, "pegs", '[');
    for (size_t n = 0; n < p->peg_count; n++) {
        const cw_peg *peg = &p->pegs[n];
        cli_json_open(j, NULL, '{');
        cli_json_count(j, "section", peg->section + 1);
        cli_json_numbers(j, "center", peg->center, 3);
        cli_json_numbers(j, "direction", peg->direction, 3);
        cli_json_number(j, "diameter_mm", peg->diameter_mm);
        cli_json_number(j, "length_mm", peg->length_mm);
        cli_json_close(j, '}');
    }
    cli_json_close(j, ']');
}

static void put_assembled(cli_json *j, const cw_assembled *a)
{
    cli_json_open(j, "assembled", '{');
    cli_json_number(j, "whole_mm3", a->whole_mm3);
    cli_json_number(j, "assembled_mm3", a->assembled_mm3);
    cli_json_number(j, "overlap_mm3", a->overlap_mm3);
    cli_json_number(j, "missing_mm3", a->missing_mm3);
    cli_json_number(j, "beyond_mm3", a->beyond_mm3);
    cli_json_number(j, "farthest_mm", a->farthest_mm);
    cli_json_count(j, "lines", a->lines);
    cli_json_close(j, '}');
}

void cli_put_cut_facts(cli_json *j, const cli_mesh_run *r)
{
    const cli_cut_state *s = r->state;
    const cw_pieces *p = &s->cut;
    if (!r->is_made)
        return;
    cli_json_open(j, "cut", '{');
    cli_json_number(j, "whole_mm3", p->whole_mm3);
    cli_json_number(j, "pieces_mm3", p->pieces_mm3);
    cli_json_number(j, "gaps_mm3", p->gaps_mm3);
    if (args_of(r)->lay)
        cli_json_count(j, "plates", s->plates);
    put_pieces(j, p, args_of(r)->lay);
    put_sections(j, p);
    if (p->settings.pegs) {
        cli_json_count(j, "shortened_pegs", p->shortened);
        cli_json_count(j, "missing_pegs", p->missing);
        put_pegs(j, p);
    }
    if (args_of(r)->measure)
        put_assembled(j, &s->assembled);
    cli_json_close(j, '}');
}

/* --- the line and notes ------------------------------------------------------------------- */

/* Says which sections have fewer pegs than requested, and what would fit. */
static void tell_missing(cli_mesh_run *r, const cw_pieces *p)
{
    enum { MAX_TOLD = 3 };
    size_t told = 0, more = 0;
    for (size_t n = 0; n < p->section_count && p->missing; n++) {
        const cw_piece_section *s = &p->sections[n];
        const size_t asked = s->regions * p->settings.pegs;
        if (s->pegs == asked)
            continue;
        if (told++ >= MAX_TOLD) {
            more++;
            continue;
        }
        cli_say("%s: %s to %s: %s of %s pegs have room; the section is wide enough for %.3g mm",
                r->mesh.path, p->pieces[s->below].name, p->pieces[s->above].name,
                cli_count(s->pegs), cli_count(asked), s->widest_mm > 0 ? s->widest_mm : 0);
    }
    if (more)
        cli_say("%s: %s more sections have fewer pegs than requested", r->mesh.path,
                cli_count(more));
}

/* Says which pieces lie on little: less than a fraction of a side of a cube of their volume. */
static void tell_lying(const cli_mesh_run *r, const cw_pieces *p)
{
    static const double LITTLE = 0.05;
    for (size_t n = 0; n < p->count; n++) {
        const cw_piece *piece = &p->pieces[n];
        const double side = cbrt(piece->volume_mm3);
        if (piece->foot_mm2 < LITTLE * side * side)
            cli_say("%s: %s lies on %.2g mm2 alone: it has no large flat side without pegs%s",
                    r->mesh.path, piece->name, piece->foot_mm2,
                    piece->pegs ? "; --peg-kind dowel leaves its sections flat" : "");
    }
}

cw_status cli_report_cut(cli_mesh_run *r, cw_error *err)
{
    const cli_cut_state *s = r->state;
    const cw_pieces *p = &s->cut;
    const cw_assembled *a = &s->assembled;
    size_t used = 0;
    (void)err;
    used += (size_t)snprintf(r->found, sizeof r->found, "; sections %s",
                             cli_count(p->section_count));
    if (p->peg_count)
        used += (size_t)snprintf(
            r->found + used, sizeof r->found - used, ", %s %s of %.3g mm, %.3g mm long",
            p->settings.dowels ? "dowels" : "pegs", cli_count(p->peg_count),
            p->settings.peg_diameter_mm, p->settings.peg_length_mm);
    if (p->shortened)
        used += (size_t)snprintf(r->found + used, sizeof r->found - used, " (%s shorter)",
                                 cli_count(p->shortened));
    if (args_of(r)->lay)
        used += (size_t)snprintf(r->found + used, sizeof r->found - used, ", plates %s",
                                 cli_count(s->plates));
    if (args_of(r)->measure)
        snprintf(r->found + used, sizeof r->found - used,
                 "; together: gaps %.3g mm3 of %.6g, overlap %.2g mm3, surface within %.2g mm",
                 p->peg_count ? a->missing_mm3 : 0, p->whole_mm3,
                 a->overlap_mm3 > 1e-9 * p->whole_mm3 ? a->overlap_mm3 : 0, a->farthest_mm);
    tell_missing(r, p);
    if (args_of(r)->lay)
        tell_lying(r, p);
    return CW_OK;
}
