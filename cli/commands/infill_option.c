/* Parses and resolves the options of a lattice, for hollow. */
#include "cli/commands/offset_hollow.h"

#include "cli/framework/console.h"
#include "cli/framework/quantity.h"
#include "core/base/status.h"
#include "core/base/text.h"

#include <stdio.h>
#include <string.h>

static const char DEPTH[] = "depth:";

/* Takes the part of a text up to the next colon, and moves behind it. Returns false for none. */
static bool take_part(const char **text, char part[CWI_ITEM_BYTES])
{
    const size_t length = *text ? strcspn(*text, ":") : 0;
    if (!length || length >= CWI_ITEM_BYTES)
        return false;
    memcpy(part, *text, length);
    part[length] = '\0';
    *text = (*text)[length] ? *text + length + 1 : NULL;
    return true;
}

static bool take_length(const char **text, cli_length *length)
{
    char part[CWI_ITEM_BYTES];
    return take_part(text, part) &&
           cli_parse_length(part, CLI_IN_MM | CLI_IN_PERCENT, length) && length->value > 0;
}

/* "gyroid:8mm:0.8mm", or with a second wall */
static bool parse_infill(const cli_option *o, const char *text, void *field)
{
    cli_infill *out = field;
    char part[CWI_ITEM_BYTES];
    (void)o;
    *out = (cli_infill){.given = true};
    if (!take_part(&text, part))
        return false;
    while (out->kind < CW_INFILL_COUNT &&
           strcmp(part, cw_infill_name((cw_infill_kind)out->kind)) != 0)
        out->kind++;
    return out->kind < CW_INFILL_COUNT && take_length(&text, &out->cell) &&
           take_length(&text, &out->walls[0]) &&
           (!text || take_length(&text, &out->walls[1])) && !text;
}

const cli_kind cli_kind_infill = {
    .size = sizeof(cli_infill),
    .parse = parse_infill,
    .expected =
        "gyroid, schwarz-p or diamond, the edge of a cell and the thickness of its walls, "
        "such as gyroid:8mm:0.8mm, or two of them with --infill-by: "
        "gyroid:8mm:1.2mm:0.6mm",
    .unit_rule = CLI_UNITS_MM " or % of the box's diagonal",
};

cw_status cli_check_infill_by(const char *by, bool *is_file, cw_error *err)
{
    cli_length depth;
    const char *text = by ? by + strlen(DEPTH) : NULL;
    *is_file = by && strncmp(by, DEPTH, strlen(DEPTH)) != 0;
    if (!by || *is_file || (take_length(&text, &depth) && !text))
        return CW_OK;
    return cwi_fail(err, CW_ERR_ARGUMENT,
                    "--infill-by '%s': expected a depth above 0 with its unit, such as "
                    "depth:10mm, or a volume to read",
                    by);
}

cw_status cli_open_lattice(const cli_infill *infill, const char *by, const cli_input *input,
                           double diagonal_mm, cli_lattice *lattice, cw_error *err)
{
    cw_infill_desc *d = &lattice->desc;
    bool is_file;
    cw_status st = cli_check_infill_by(by, &is_file, err);
    if (st != CW_OK || !infill->given)
        return st;
    d->kind = (cw_infill_kind)infill->kind;
    d->cell_mm = cli_length_mm(&infill->cell, diagonal_mm, 0);
    d->wall_mm = cli_length_mm(&infill->walls[0], diagonal_mm, 0);
    d->end_wall_mm =
        infill->walls[1].given ? cli_length_mm(&infill->walls[1], diagonal_mm, 0) : 0;
    if (infill->walls[1].given != (by != NULL))
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        by ? "--infill-by needs a second wall to end at: --infill "
                             "gyroid:8mm:1.2mm:0.6mm"
                           : "--infill with two walls needs --infill-by depth:L or a volume");
    if (!by)
        return CW_OK;
    if (is_file) {
        const cli_input source = cli_source_input(input);
        st = cli_read_volume(by, &source, false, &lattice->volume, err);
        d->by = &lattice->volume.view;
        return st;
    }
    cli_length depth;
    const char *text = by + strlen(DEPTH);
    if (take_length(&text, &depth)) /* checked above */
        d->depth_mm = cli_length_mm(&depth, diagonal_mm, 0);
    return CW_OK;
}

void cli_free_lattice(cli_lattice *lattice)
{
    cli_free_volume(&lattice->volume);
}

void cli_json_lattice(cli_json *j, const cli_lattice *lattice, const char *by)
{
    const cw_infill_desc *d = &lattice->desc;
    if (!(d->cell_mm > 0))
        return;
    cli_json_open(j, "infill", '{');
    cli_json_text(j, "kind", cw_infill_name(d->kind));
    cli_json_number(j, "cell_mm", d->cell_mm);
    cli_json_number(j, "wall_mm", d->wall_mm);
    if (d->end_wall_mm > 0)
        cli_json_number(j, "end_wall_mm", d->end_wall_mm);
    if (d->depth_mm > 0)
        cli_json_number(j, "depth_mm", d->depth_mm);
    if (d->by)
        cli_json_text(j, "by", cli_shown_path(by));
    cli_json_close(j, '}');
}

void cli_json_lattice_facts(cli_json *j, const cw_hollow_facts *f, bool measured)
{
    cli_json_count(j, "drains", f->drains);
    cli_json_count(j, "loose", f->loose);
    if (!measured)
        return;
    cli_json_count(j, "infill_samples", f->infill_samples);
    cli_json_number(j, "infill_min_mm", f->infill_min_mm);
    cli_json_number(j, "infill_median_mm", f->infill_median_mm);
    cli_json_number(j, "infill_max_mm", f->infill_max_mm);
}

void cli_describe_lattice(const cw_infill_desc *d, const cw_hollow_facts *f, char *text,
                          size_t size)
{
    if (f->infill_samples)
        snprintf(text, size, "; %s walls %.4g to %.4g mm thick, median %.4g mm",
                 cw_infill_name(d->kind), f->infill_min_mm, f->infill_max_mm,
                 f->infill_median_mm);
    else
        snprintf(text, size, "; no %s wall is far enough from the outer one to be measured",
                 cw_infill_name(d->kind));
}
