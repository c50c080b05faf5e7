/* Makes the levels of detail of one mesh: finishes each, orders it for drawing, and delivers a
 * file a level and one with all. */
#include "cli/results/detail_levels.h"

#include "cli/assets/asset_profile.h"
#include "cli/framework/console.h"
#include "cli/framework/name_template.h"
#include "cli/framework/quantity.h"
#include "core/base/memory.h"
#include "core/base/status.h"

#include <cubewright/simplify.h>

#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

/* Triangles that a handle keeps, about, and the part of all from which on that is worth a word. */
enum { HANDLE_TRIANGLES = 13, HANDLES_PART = 4 };

/* Names in the report, which outlives the levels. */
static const char *const level_names[CLI_MAX_COUNTS] = {
    "lod0", "lod1", "lod2",  "lod3",  "lod4",  "lod5",  "lod6",  "lod7",
    "lod8", "lod9", "lod10", "lod11", "lod12", "lod13", "lod14", "lod15"};

cw_status cli_name_detail_levels(cli_outputs *files, const char *output, const char *format,
                                 const char *input, const cli_counts *lod, bool together,
                                 cw_error *err)
{
    const bool apart = cli_lod_files_of(output, format) == CLI_LOD_APART ||
                       (together && cli_holds_lod(output));
    return cli_name_lod_outputs(files, output, input, lod->count,
                                apart      ? CLI_LOD_APART
                                : together ? CLI_LOD_TOGETHER
                                           : CLI_LOD_BOTH,
                                err);
}

static cli_handles_left handles_of(const cli_pieces *p)
{
    return (cli_handles_left){cli_count_handles(p), p->closed_mm};
}

/* Prints how many handles keep triangles that were to go; nothing where they are few. */
static const char *handles_text(cli_handles_left handles, size_t triangles)
{
    static char text[160];
    const bool is_one = handles.count == 1;
    size_t used = 0;
    *text = '\0';
    if (handles.count * HANDLE_TRIANGLES <= triangles / HANDLES_PART)
        return text;
    used = (size_t)snprintf(
        text, sizeof text, "; its %s handle%s keep%s about %d each: ", cli_count(handles.count),
        is_one ? "" : "s", is_one ? "s" : "", HANDLE_TRIANGLES);
    if (handles.closed_mm > 0)
        snprintf(text + used, sizeof text - used,
                 "--close-handles with more than %.3gmm may close more", handles.closed_mm);
    else
        snprintf(text + used, sizeof text - used, "--close-handles auto closes small ones");
    return text;
}

void cli_report_left(cli_report *report, size_t target, size_t triangles,
                     cli_handles_left handles, bool keeps_border)
{
    cli_report_warn(report,
                    "%s triangles were requested, %s are left: removing more would tear "
                    "the surface%s, flip it or make it intersect itself%s",
                    cli_count(target), cli_count(triangles),
                    keeps_border ? ", move its border" : "", handles_text(handles, triangles));
}

void cli_report_missed(cli_report *report, const cli_pieces *pieces, size_t target,
                       size_t triangles, bool keeps_border)
{
    if (target && pieces->triangles <= target)
        cli_say("%s: already has no more than the %s triangles requested", pieces->path,
                cli_count(target));
    if (target && triangles > target)
        cli_report_left(report, target, triangles, handles_of(pieces), keeps_border);
}

void cli_json_lod(cli_json *j, const cli_counts *lod)
{
    cli_json_open(j, "lod", '[');
    for (size_t n = 0; n < lod->count; n++)
        cli_json_count(j, NULL, lod->n[n]);
    cli_json_close(j, ']');
}

/* Levels are for drawing: their triangles and vertices are put in the order that is fast. */
static cw_status order_for_drawing(cli_detail_levels *d, cw_mesh *level, cw_error *err)
{
    cw_error why = {0};
    const cw_status st = cw_mesh_optimize(level, &why);
    if (st == CW_ERR_UNSUPPORTED) {
        if (!d->is_unordered)
            cli_say("levels are not optimised for fast drawing: %s", why.message);
        d->is_unordered = true;
        return CW_OK;
    }
    return st == CW_OK ? CW_OK : cwi_fail(err, st, "%s: %s", d->pieces->path, why.message);
}

/* Refuses levels with as many triangles as the one before: they are the same mesh. */
static cw_status check_levels(const cli_detail_levels *d, cw_error *err)
{
    for (size_t n = 1; n < d->lod->count; n++) {
        const size_t triangles = d->mesh[n].triangle_count;
        const char *hint = handles_text(handles_of(d->pieces), triangles);
        if (triangles != d->mesh[n - 1].triangle_count)
            continue;
        if (triangles <= d->lod->n[n])
            return cwi_fail(
                err, CW_ERR_CHECK,
                "%s: --lod: level %zu would be level %zu again, as the mesh has no more than "
                "%s triangles: leave %zu out",
                d->pieces->path, n, n - 1, cli_count(triangles), d->lod->n[n - 1]);
        return cwi_fail(
            err, CW_ERR_CHECK,
            "%s: --lod: level %zu would be level %zu again: %s triangles were requested, "
            "%s are left%s",
            d->pieces->path, n, n - 1, cli_count(d->lod->n[n]), cli_count(triangles),
            *hint ? hint : "; leave it out");
    }
    return CW_OK;
}

/* Refuses a first level that keeps more triangles than its budget. */
static cw_status check_budget(const cli_detail_levels *d, cw_error *err)
{
    const size_t triangles = d->mesh->triangle_count;
    const char *hint = handles_text(handles_of(d->pieces), triangles);
    return d->is_budget && triangles > *d->lod->n
               ? cwi_fail(err, CW_ERR_CHECK,
                          "%s: %s triangles were asked for, %s are left: removing more would "
                          "tear the surface%s; or --lod with more",
                          d->pieces->path, cli_count(*d->lod->n), cli_count(triangles), hint)
               : CW_OK;
}

/* Finds from which distance on the level will do. */
static void find_switch(cli_made *made)
{
    if (made->compared.made)
        made->switch_m = cli_find_switch_m(cw_mesh_comparison_max(&made->compared.with_input));
}

static const cw_textures *find_textures(const cli_detail_levels *d)
{
    return d->maps ? cli_find_textures(d->maps) : d->pieces->piece->textures;
}

static cw_status make_level(cli_detail_levels *d, size_t n, cli_made *made, cw_error *err)
{
    cw_mesh *level = &d->mesh[n];
    cw_status st = n == 0 ? d->make(d->user, d->mesh, err) : CW_OK;
    if (st == CW_OK && n == 0)
        st = check_budget(d, err);
    if (st == CW_OK && n == 0)
        st = check_levels(d, err);
    if (st != CW_OK)
        return st;
    if (d->is_budget && level->triangle_count > d->lod->n[n])
        cli_say("%s: %s has %s triangles in place of %s: its topology and its seams need them",
                d->pieces->path, level_names[n], cli_count(level->triangle_count),
                cli_count(d->lod->n[n]));
    else
        cli_report_missed(d->report, d->pieces, d->lod->n[n], level->triangle_count,
                          d->keeps_border);
    st = d->finish(d->user, made, level, err);
    find_switch(made);
    if (st == CW_OK)
        st = order_for_drawing(d, level, err);
    const cw_part part = {
        .mesh = level, .name = d->pieces->piece->name, .textures = find_textures(d)};
    return st == CW_OK ? d->deliver(d->user, n, &part, 1, err) : st;
}

/* Writes one file with all levels. Names of nodes are as those of the files. */
static cw_status deliver_together(cli_detail_levels *d, const char *path, cw_error *err)
{
    char names[CLI_MAX_COUNTS][256], *stem = cli_stem(d->name ? d->name : path);
    cw_part parts[CLI_MAX_COUNTS];
    if (!stem)
        return cwi_fail_memory(err);
    for (size_t n = 0; n < d->lod->count; n++) {
        const cw_mesh_comparison *c = &d->report->made[n].compared.with_input;
        snprintf(names[n], sizeof names[n], "%.200s-lod%zu", stem, n);
        parts[n] = (cw_part){
            .mesh = &d->mesh[n],
            .name = names[n],
            .level = n,
            .max_error_mm = cw_mesh_comparison_max(c),
            .rms_error_mm = cw_mesh_comparison_rms(c),
            .textures = find_textures(d),
        };
    }
    cw_status st = d->deliver(d->user, d->lod->count, parts, d->lod->count, err);
    free(stem);
    return st;
}

/* Removes the files of levels before the one that failed: they are no whole result. */
static void remove_written(const cli_detail_levels *d, size_t count)
{
    for (size_t n = 0; n < count; n++) {
        if (d->report->made[n].written)
            unlink(d->files->path[n]);
        d->report->made[n].written = false;
    }
}

cw_status cli_make_detail_levels(cli_detail_levels *d, cw_error *err)
{
    const size_t files = d->files->count;
    const bool together = files < d->lod->count; /* levels have no file of their own */
    const char *all = files == d->lod->count ? NULL : d->files->path[files - 1];
    cw_status st = CW_OK;
    for (size_t n = 0; n < d->lod->count + (all ? 1 : 0) && st == CW_OK; n++) {
        const bool is_level = n < d->lod->count;
        const char *path = !is_level ? all : together ? NULL : d->files->path[n];
        cli_made *made = cli_report_next(d->report, path, 0);
        made->name = is_level ? level_names[n] : "all";
        st = is_level ? make_level(d, n, made, err) : deliver_together(d, path, err);
        if (st != CW_OK) {
            made->error = *err;
            if (!made->written) /* else it is whole, but less exact than asked for */
                remove_written(d, n);
        }
    }
    return st;
}

void cli_free_detail_levels(cli_detail_levels *d)
{
    for (size_t n = 0; n < CLI_MAX_COUNTS; n++)
        cw_mesh_free(&d->mesh[n]);
}
