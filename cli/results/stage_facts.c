/* The table of what stages tell: a row a stage, for people and for the report. */
#include "cli/results/stage_facts.h"

#include "cli/assets/texture_options.h"
#include "cli/framework/console.h"
#include "cli/framework/quantity.h"
#include "cli/inputs/cut_options.h"
#include "cli/letters/engraved_text.h"

#include <math.h>
#include <stdio.h>

/* Smaller changes of the volume are rounding to single precision. */
static const double UNCHANGED_PERCENT = 1e-4;

void cli_json_smoothed(cli_json *j, const cw_smooth_facts *f)
{
    cli_json_open(j, "smooth", '{');
    cli_json_number(j, "max_mm", f->max_mm);
    cli_json_number(j, "mean_mm", f->mean_mm);
    cli_json_number(j, "volume_before_mm3", f->volume_before_mm3);
    cli_json_number(j, "volume_after_mm3", f->volume_after_mm3);
    cli_json_count(j, "flipped", f->flipped);
    cli_json_count(j, "border_vertices", f->border);
    cli_json_count(j, "junction_vertices", f->junction);
    cli_json_count(j, "put_back", f->put_back);
    cli_json_close(j, '}');
}

void cli_smoothed_text(const cw_smooth_facts *f, char text[CLI_SMOOTHED_TEXT])
{
    const double change = 100 * (f->volume_after_mm3 / f->volume_before_mm3 - 1);
    size_t used = (size_t)snprintf(text, CLI_SMOOTHED_TEXT,
                                   "vertices moved by at most %.3g mm, mean %.3g mm", f->max_mm,
                                   f->mean_mm);
    if (!f->border && f->volume_before_mm3 != 0)
        used += (size_t)snprintf(text + used, CLI_SMOOTHED_TEXT - used,
                                 "; volume %.6g mm3, changed by %.2g %%", f->volume_after_mm3,
                                 fabs(change) < UNCHANGED_PERCENT ? 0 : change);
    snprintf(text + used, CLI_SMOOTHED_TEXT - used, "; %s triangle%s flipped",
             cli_count(f->flipped), f->flipped == 1 ? "" : "s");
}

/* --- handles -------------------------------------------------------------------------------- */

void cli_json_handles(cli_json *j, const cw_close_handles_facts *f)
{
    cli_json_open(j, "handles", '{');
    cli_json_number(j, "length_mm", f->length_mm);
    cli_json_count(j, "before", f->genus_before);
    cli_json_count(j, "after", f->genus_after);
    cli_json_count(j, "cut", f->cut);
    cli_json_count(j, "filled", f->filled);
    cli_json_count(j, "left_long", f->left_long);
    cli_json_count(j, "left_crossing", f->left_crossing);
    cli_json_number(j, "max_change_mm", f->change_mm);
    cli_json_close(j, '}');
}

void cli_handles_text(const cw_close_handles_facts *f, char text[CLI_HANDLES_TEXT])
{
    const size_t closed = f->cut + f->filled;
    if (!f->genus_before) {
        snprintf(text, CLI_HANDLES_TEXT, "has no handles to close");
        return;
    }
    size_t used = (size_t)snprintf(text, CLI_HANDLES_TEXT,
                                   "closed %s of %s handle%s by loops up to %.3g mm",
                                   cli_count(closed), cli_count(f->genus_before),
                                   f->genus_before == 1 ? "" : "s", f->length_mm);
    if (closed)
        used += (size_t)snprintf(text + used, CLI_HANDLES_TEXT - used,
                                 ": %s cut, %s tunnel%s filled, largest change %.3g mm",
                                 cli_count(f->cut), cli_count(f->filled),
                                 f->filled == 1 ? "" : "s", f->change_mm);
    if (f->genus_after)
        used += (size_t)snprintf(text + used, CLI_HANDLES_TEXT - used, "; %s left: %s longer",
                                 cli_count(f->genus_after), cli_count(f->left_long));
    if (f->left_crossing)
        snprintf(text + used, CLI_HANDLES_TEXT - used,
                 ", %s whose caps would cross the surface", cli_count(f->left_crossing));
}

/* --- components ----------------------------------------------------------------------------- */

/* Writes how many of the components left out were cavities, and that a cut follows. */
static const char *cavities_text(const cw_drop_counts *c, bool is_cut)
{
    static char text[96];
    size_t used = 0;
    *text = '\0';
    if (c->cavities)
        used = (size_t)snprintf(text, sizeof text, "; %s cavit%s among them filled",
                                cli_count(c->cavities), c->cavities == 1 ? "y" : "ies");
    if (is_cut)
        snprintf(text + used, sizeof text - used, "; counted before the cut");
    return text;
}

void cli_tell_components(const char *name, double least_mm3, const cw_drop_counts *c,
                         bool is_cut)
{
    cli_say("%s: %s component%s kept, the smallest of %.6g mm3; %s dropped (< %.6g mm3), the "
            "largest of %.6g mm3%s; %s triangles fewer",
            name, cli_count(c->kept), c->kept == 1 ? "" : "s", c->least_kept_mm3,
            cli_count(c->dropped), least_mm3, c->largest_mm3, cavities_text(c, is_cut),
            cli_count(c->triangles));
}

static bool is_cut(const cw_pipeline_facts *f)
{
    return f->ran >> CW_STAGE_CUT & 1;
}

static void tell_dropped(const cli_staged *s)
{
    cli_tell_components(s->subject, s->least_mm3, &s->facts->small, is_cut(s->facts));
}

static void put_dropped(cli_json *j, const cw_pipeline_facts *f, double least_mm3)
{
    cli_json_open(j, "components_dropped", '{');
    cli_json_number(j, "least_mm3", least_mm3);
    cli_json_count(j, "dropped", f->small.dropped);
    cli_json_count(j, "dropped_cavities", f->small.cavities);
    cli_json_count(j, "kept", f->small.kept);
    cli_json_count(j, "dropped_triangles", f->small.triangles);
    cli_json_number(j, "dropped_mm3", f->small.dropped_mm3);
    cli_json_number(j, "largest_dropped_mm3", f->small.largest_mm3);
    cli_json_number(j, "least_kept_mm3", f->small.least_kept_mm3);
    cli_json_close(j, '}');
}

static void tell_largest(const cli_staged *s)
{
    const cw_drop_counts *c = &s->facts->others;
    cli_say("%s: %s of %s components kept, of %.6g mm3 or more; the largest of the others "
            "has %.6g mm3%s",
            s->subject, cli_count(c->kept), cli_count(c->kept + c->dropped), c->least_kept_mm3,
            c->largest_mm3, cavities_text(c, is_cut(s->facts)));
}

static void tell_voids(const cli_staged *s)
{
    const cw_drop_counts *c = &s->facts->voids;
    cli_say("%s: %s void%s filled, %.6g mm3", s->subject, cli_count(c->dropped),
            c->dropped == 1 ? "" : "s", c->dropped_mm3);
}

static void put_voids(cli_json *j, const cw_pipeline_facts *f, double least_mm3)
{
    (void)least_mm3;
    cli_json_open(j, "voids_filled", '{');
    cli_json_count(j, "count", f->voids.dropped);
    cli_json_count(j, "dropped_triangles", f->voids.triangles);
    cli_json_number(j, "filled_mm3", f->voids.dropped_mm3);
    cli_json_close(j, '}');
}

static void tell_handles(const cli_staged *s)
{
    char text[CLI_HANDLES_TEXT];
    cli_handles_text(&s->facts->handles, text);
    cli_say("%s: %s", s->subject, text);
}

static void put_handles(cli_json *j, const cw_pipeline_facts *f, double least_mm3)
{
    (void)least_mm3;
    cli_json_handles(j, &f->handles);
}

/* --- shape and colours ---------------------------------------------------------------------- */

static void tell_smoothing(const cli_staged *s)
{
    char text[CLI_SMOOTHED_TEXT];
    cli_smoothed_text(&s->facts->smoothed, text);
    cli_say("%s: smoothed by %s: %s", s->subject, cli_smoothing_text(s->smooth), text);
    if (s->facts->smoothed.undecided)
        cli_report_warn(s->report, "too many triangles are in one place: new "
                                   "intersections there were not looked for");
}

static void put_smoothing(cli_json *j, const cw_pipeline_facts *f, double least_mm3)
{
    (void)least_mm3;
    cli_json_smoothed(j, &f->smoothed);
}

static void tell_cut(const cli_staged *s)
{
    cli_tell_cut(s->subject, s->cut, &s->facts->cut);
}

static void put_cut(cli_json *j, const cw_pipeline_facts *f, double least_mm3)
{
    (void)least_mm3;
    cli_json_cut(j, &f->cut);
}

static void tell_text(const cli_staged *s)
{
    cli_tell_engraved(s->subject, &s->facts->engraved);
}

static void put_text(cli_json *j, const cw_pipeline_facts *f, double least_mm3)
{
    (void)least_mm3;
    cli_json_open(j, "engraved", '{');
    cli_json_engraved(j, &f->engraved);
    cli_json_close(j, '}');
}

static void tell_culling(const cli_staged *s)
{
    const cw_pipeline_facts *f = s->facts;
    cli_say("%s: %.3g %% of the voxels are in bricks that cameras see; %s triangles in "
            "them that no camera sees are left out",
            s->subject, 100 * (double)f->seen_voxels / (double)f->voxels, cli_count(f->culled));
}

static void tell_colors(const cli_staged *s)
{
    cli_tell_coloring(s->coloring, s->facts);
}

/* --- textures --------------------------------------------------------------------------------- */

static void tell_atlas(const cli_staged *s)
{
    char text[CLI_TEXTURE_TEXT];
    cli_atlas_text(&s->facts->atlas, text);
    cli_say("%s: %s", s->subject, text);
}

static void put_atlas(cli_json *j, const cw_pipeline_facts *f, double least_mm3)
{
    (void)least_mm3;
    cli_json_atlas(j, &f->atlas);
}

static void tell_maps(const cli_staged *s)
{
    char text[CLI_TEXTURE_TEXT];
    const double missed = cli_find_missed(&s->facts->baked);
    cli_maps_text(&s->facts->baked, "maps", "the full surface", text);
    cli_say("%s: %s", s->subject, text);
    if (missed > 0)
        cli_report_warn(
            s->report,
            "%.2g %% of the texels found nothing of the full surface within %.3g mm "
            "that faces the same way: they are flat",
            missed, s->facts->baked.reach_mm);
}

static void put_maps(cli_json *j, const cw_pipeline_facts *f, double least_mm3)
{
    (void)least_mm3;
    cli_json_maps(j, "maps", &f->baked);
}

/* --- the table ------------------------------------------------------------------------------ */

/* In the order in which keys stand in the report. put: NULL: nothing, or another part of it tells */
static const struct row {
    cw_stage stage;
    void (*tell)(const cli_staged *surface);
    void (*put)(cli_json *j, const cw_pipeline_facts *facts, double least_mm3);
} ROWS[] = {
    {CW_STAGE_MIN_VOLUME, tell_dropped, put_dropped},
    {CW_STAGE_LARGEST, tell_largest, NULL},
    {CW_STAGE_FILL_VOIDS, tell_voids, put_voids},
    {CW_STAGE_HANDLES, tell_handles, put_handles},
    {CW_STAGE_SMOOTH, tell_smoothing, put_smoothing},
    {CW_STAGE_CUT, tell_cut, put_cut},
    {CW_STAGE_ENGRAVE, tell_text, put_text},
    {CW_STAGE_CULL, tell_culling, NULL},
    {CW_STAGE_COLOR, tell_colors, NULL},
    {CW_STAGE_ATLAS, tell_atlas, put_atlas},
    {CW_STAGE_MAPS, tell_maps, put_maps},
};

void cli_tell_stages(const cli_staged *s)
{
    for (const struct row *r = ROWS; r < ROWS + sizeof ROWS / sizeof *ROWS; r++)
        if (s->facts->ran >> r->stage & 1)
            r->tell(s);
}

void cli_json_stages(cli_json *j, const cw_pipeline_facts *f, double least_mm3)
{
    for (const struct row *r = ROWS; r < ROWS + sizeof ROWS / sizeof *ROWS; r++)
        if (r->put && f->ran >> r->stage & 1)
            r->put(j, f, least_mm3);
}
