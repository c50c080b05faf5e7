/* Checks a mesh and writes it to its file, at the same time where memory allows. */
#include "cli/results/write_result.h"

#include "cli/framework/console.h"
#include "cli/framework/quantity.h"
#include "cli/framework/standard_streams.h"
#include "cli/results/summary_line.h"
#include "core/base/status.h"
#include "core/base/task_pair.h"
#include "core/geometry/box.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static cli_load count_load(const cw_part *parts, size_t part_count)
{
    cli_load l = {.parts = parts, .part_count = part_count};
    for (size_t p = 0; p < part_count; p++) {
        l.vertices += parts[p].mesh->vertex_count;
        l.triangles += parts[p].mesh->triangle_count;
    }
    return l;
}

/* --- checking ---------------------------------------------------------------------------- */

cw_status cli_hold_to_promise(const char *input, const char *what, const cw_quality *q,
                              bool open, cw_error *err)
{
    if (!q->nonmanifold_edges && !q->nonmanifold_vertices && !q->misoriented_edges &&
        !q->degenerate && (!q->open_edges || open))
        return CW_OK;
    return cwi_fail(err, CW_ERR_CHECK,
                    "%s: the surface %s is not as promised: %zu open, %zu non-manifold, %zu "
                    "misoriented edges, %zu non-manifold vertices, %zu degenerate triangles; "
                    "nothing is written (--no-check writes it)",
                    input, what, q->open_edges, q->nonmanifold_edges, q->misoriented_edges,
                    q->nonmanifold_vertices, q->degenerate);
}

static cw_status hold_to_promise(const cli_delivery *how, const cli_made *made, cw_error *err)
{
    char what[32];
    snprintf(what, sizeof what, "at %g", made->iso);
    return how->unpromised
               ? CW_OK
               : cli_hold_to_promise(how->input, what, &made->quality, how->open, err);
}

void cli_add_quality(cw_quality *sum, const cw_quality *q)
{
#define COUNT(field) offsetof(cw_quality, field)
    static const size_t counts[] = {COUNT(vertices),
                                    COUNT(triangles),
                                    COUNT(edges),
                                    COUNT(components),
                                    COUNT(unused_vertices),
                                    COUNT(merged_vertices),
                                    COUNT(open_edges),
                                    COUNT(border_loops),
                                    COUNT(nonmanifold_edges),
                                    COUNT(contact_edges),
                                    COUNT(contact_vertices),
                                    COUNT(misoriented_edges),
                                    COUNT(nonmanifold_vertices),
                                    COUNT(duplicates),
                                    COUNT(degenerate),
                                    COUNT(cavities),
                                    COUNT(inside_out),
                                    COUNT(nested),
                                    COUNT(open_inward),
                                    COUNT(one_sided),
                                    COUNT(to_turn),
                                    COUNT(needles),
                                    COUNT(caps)};
#undef COUNT
    for (size_t i = 0; i < sizeof counts / sizeof *counts; i++)
        *(size_t *)((char *)sum + counts[i]) += *(const size_t *)((const char *)q + counts[i]);
    sum->euler += q->euler;
    sum->genus = sum->genus < 0 || q->genus < 0 ? -1 : sum->genus + q->genus;
    sum->area_mm2 += q->area_mm2;
    sum->volume_mm3 += q->volume_mm3;
    cwi_box_join(sum->min, sum->max, q->min, q->max);
}

/* Which way shells face. Those that are open as indexed may be closed once vertices at the same
 * place are one. */
static cw_status find_facing(const cw_mesh *mesh, int threads, cw_quality *q, cw_error *err)
{
    const cw_quality_desc desc = {.weld = CW_WELD_LOCAL, .shells = true, .threads = threads};
    cw_quality welded;
    if (!q->open_edges)
        return CW_OK;
    cw_status st = cw_quality_measure(mesh, &desc, &welded, err);
    if (st != CW_OK || welded.open_edges == q->open_edges)
        return st;
    q->cavities = welded.cavities;
    q->inside_out = welded.inside_out;
    q->nested = welded.nested;
    q->one_sided = welded.one_sided;
    q->to_turn = welded.to_turn;
    return CW_OK;
}

static cw_status check_mesh(cli_report *report, const cli_delivery *how, const cli_load *l,
                            cli_made *made, cw_error *err)
{
    const cw_quality_desc desc = {.threads = how->threads,
                                  .shells = how->unpromised,
                                  .progress =
                                      cli_progress((double)l->triangles / 1e6, "Mtriangle")};
    cw_status st = CW_OK;
    cli_report_begin(report);
    for (size_t p = 0; p < l->part_count && st == CW_OK; p++) {
        cw_quality q;
        st = cw_quality_measure(l->parts[p].mesh, &desc, &q, err);
        if (st == CW_OK && desc.shells)
            st = find_facing(l->parts[p].mesh, how->threads, &q, err);
        if (st == CW_OK && p == 0)
            made->quality = q;
        else if (st == CW_OK)
            cli_add_quality(&made->quality, &q);
    }
    if (st != CW_OK)
        return st;
    cli_report_end(report, "check", l->triangles, l->triangles);
    made->measured = true;
    made->shells = how->unpromised;
    return hold_to_promise(how, made, err);
}

/* --- writing ----------------------------------------------------------------------------- */

static void warn_of_loss(cli_report *report, const cli_made *made, const cli_load *l,
                         const cw_write_loss *loss)
{
    if (loss->merged_vertices || loss->flat_triangles)
        cli_report_warn(
            report,
            "%s: this far from zero, single precision has steps of %.3g mm; %s of %s vertices "
            "coincide, and %s of %s triangles lose their area; --local or .glb keeps them",
            cli_shown_path(made->path), loss->step_mm, cli_count(loss->merged_vertices),
            cli_count(l->vertices), cli_count(loss->flat_triangles), cli_count(l->triangles));
}

static void report_split(const cli_made *made, const cw_write_loss *loss)
{
    if (loss->split_vertices)
        cli_say("%s: colours of faces became those of vertices, with %s vertices more, so that "
                "each has one colour; %s",
                made->path, cli_count(loss->split_vertices),
                made->compression ? "without --compress, up to 128 colours add none"
                                  : "up to 128 colours add none");
}

static void report_rounded(const cli_made *made, const cw_write_loss *loss)
{
    if (loss->rounded_colors)
        cli_say("%s: colours of %s faces rounded to 5 bits a channel", made->path,
                cli_count(loss->rounded_colors));
}

static void report_dropped(const cli_made *made, const cw_write_loss *loss)
{
    char list[256] = "";
    size_t used = 0;
    for (size_t i = 0; i < cli_kept_count; i++)
        if (made->dropped & cli_kept[i].flag)
            used += (size_t)snprintf(list + used, sizeof list - used, "%s%s", used ? ", " : "",
                                     cli_kept[i].name);
    if (used)
        cli_say("%s: left out, because the format cannot hold them: %s%s%s", made->path, list,
                *loss->attributes ? " " : "", loss->attributes);
}

/* A mesh that is written, perhaps while another thread checks it. */
typedef struct writing {
    cli_report *report;
    const cli_delivery *how;
    const cli_load *load;
    cli_made *made;
    cw_write_desc desc;
    cw_write_loss loss;
    cw_status status;
    cw_error error;
} writing;

/* A check on the calling thread beside the writing on another one. */
typedef struct delivery {
    cwi_task_pair pair;
    writing writing;
    cw_status checked;
    cw_error error; /* of the check */
    bool refused;   /* atomic: the writing is in vain */
} delivery;

static writing plan_writing(cli_report *report, const cli_delivery *how, const cli_load *l,
                            cli_made *made)
{
    return (writing){.report = report, .how = how, .load = l, .made = made, .desc = how->write};
}

static void write_bytes(writing *w, const cw_write_consent *consent)
{
    const cli_load *l = w->load;
    w->desc.compressed = &w->made->compressed;
    w->desc.sink = cli_output_sink(w->made->path);
    if (w->desc.sink && !w->desc.name && !l->parts->name)
        w->desc.name = "mesh"; /* there is no stem of a path */
    cli_set_compress(w->how->compress, l->parts, l->part_count, w->how->voxel_mm, &w->desc);
    w->status = cw_parts_write_loss(w->made->path, l->parts, l->part_count, &w->desc, &w->loss,
                                    &w->error);
    if (w->status == CW_OK)
        w->status = cw_parts_write_with_consent(w->made->path, l->parts, l->part_count,
                                                &w->desc, consent, &w->error);
}

/* Reports what was written. */
static cw_status end_writing(const writing *w, cw_error *err)
{
    cli_made *made = w->made;
    const cli_load *l = w->load;
    if (w->status != CW_OK) {
        if (err)
            *err = w->error;
        return w->status;
    }
    made->written = true;
    made->local = w->desc.local;
    made->compression = w->desc.compression ? w->desc.compression
                        : made->compressed.bytes
                            ? CW_COMPRESS_DRACO /* a format of that alone */
                            : CW_COMPRESS_NONE;
    memcpy(made->origin, l->parts->mesh->origin, sizeof made->origin);
    made->dropped = w->how->report_dropped ? w->loss.dropped : 0;
    warn_of_loss(w->report, made, l, &w->loss);
    report_dropped(made, &w->loss);
    report_split(made, &w->loss);
    report_rounded(made, &w->loss);
    cli_report_end(w->report, "write", l->triangles, l->triangles);
    return CW_OK;
}

/* Fails when compression merged vertices or flattened triangles: then no file appears. */
static cw_status hold_to_shape(void *user, cw_error *err)
{
    const cli_made *made = user;
    const cw_compressed *c = &made->compressed;
    if (!c->merged && !c->flat)
        return CW_OK;
    return cwi_fail(
        err, CW_ERR_CHECK,
        "with %d bits %s vertices fall onto others and %s triangles lose their area, so "
        "it was not written; without --bits enough bits are chosen",
        c->bits, cli_count(c->merged), cli_count(c->flat));
}

static cw_status write_mesh(cli_report *report, const cli_delivery *how, const cli_load *l,
                            cli_made *made, cw_error *err)
{
    writing w = plan_writing(report, how, l, made);
    w.desc.progress = cli_progress((double)l->triangles / 1e6, "Mtriangle");
    cli_report_begin(report);
    write_bytes(&w, &(cw_write_consent){hold_to_shape, made});
    return end_writing(&w, err);
}

static void check_own(void *context)
{
    delivery *d = context;
    const writing *w = &d->writing;
    d->checked = check_mesh(w->report, w->how, w->load, w->made, &d->error);
    cli_report_begin(w->report);
    if (d->checked != CW_OK)
        __atomic_store_n(&d->refused, true, __ATOMIC_RELAXED);
}

/* The file appears once the check holds. */
static cw_status await_check(void *user, cw_error *err)
{
    delivery *d = user;
    cwi_task_pair_wait(&d->pair);
    return d->checked == CW_OK ? CW_OK : cwi_fail(err, d->checked, "the check does not hold");
}

static void write_aside(void *context)
{
    delivery *d = context;
    write_bytes(&d->writing, &(cw_write_consent){await_check, d});
}

/* Draws no bar, as the check does. */
static bool is_wanted(void *user, const char *step, double done)
{
    const delivery *d = user;
    (void)step, (void)done;
    return !__atomic_load_n(&d->refused, __ATOMIC_RELAXED) && !cli_interrupted();
}

static cw_status check_then_write(cli_report *report, const cli_delivery *how,
                                  const cli_load *l, cli_made *made, cw_error *err)
{
    cw_status st = how->unchecked ? CW_OK : check_mesh(report, how, l, made, err);
    return st == CW_OK ? write_mesh(report, how, l, made, err) : st;
}

/* Writes the mesh while it is checked. One after the other takes less memory: that is tried
 * where memory runs out. */
static cw_status check_and_write(cli_report *report, const cli_delivery *how, const cli_load *l,
                                 cli_made *made, cw_error *err)
{
    delivery d = {.writing = plan_writing(report, how, l, made)};
    d.writing.desc.progress = (cw_progress){.report = is_wanted, .user = &d};
    cwi_task_pair_run(&d.pair, check_own, write_aside, &d);
    if (d.checked == CW_ERR_NO_MEMORY)
        return check_then_write(report, how, l, made, err);
    if (d.checked == CW_OK && d.writing.status == CW_ERR_NO_MEMORY)
        return write_mesh(report, how, l, made, err);
    if (d.checked == CW_OK)
        return end_writing(&d.writing, err);
    if (err)
        *err = d.error;
    return d.checked;
}

/* Whether the writer takes as little memory as the check, so that both may run at a time. */
static bool writes_in_passing(const cli_delivery *how, const cli_made *made)
{
    static const char *const formats[] = {"glb", "gltf", "stl", "ply", "obj", "off"};
    const cw_format *f = cw_mesh_format(made->path, how->write.format);
    if (!f || how->write.compression || (how->compress && how->compress->kind))
        return false;
    for (size_t n = 0; n < sizeof formats / sizeof *formats; n++)
        if (strcmp(f->name, formats[n]) == 0)
            return true;
    return false;
}

/* --- delivery ---------------------------------------------------------------------------- */

cw_status cli_deliver(cli_report *report, const cli_delivery *how, const cw_part *parts,
                      size_t part_count, size_t border_loops, double start, cw_error *err)
{
    const cli_load l = count_load(parts, part_count);
    cli_made *made = &report->made[report->made_count - 1];
    const bool together = !how->unchecked && writes_in_passing(how, made);
    cw_status st = together ? check_and_write(report, how, &l, made, err)
                            : check_then_write(report, how, &l, made, err);
    if (st == CW_OK)
        cli_print_summary(how, made, &l, border_loops, start);
    return st;
}

cw_status cli_deliver_step(cli_report *report, const cli_delivery *how, const cw_mesh *mesh,
                           size_t border_loops, double start, cw_error *err)
{
    const cw_part part = {.mesh = mesh};
    const cli_load l = count_load(&part, 1);
    cli_made *made = &report->made[report->made_count - 1];
    cw_status st = how->unchecked ? CW_OK : check_mesh(report, how, &l, made, err);
    if (st == CW_OK)
        cli_print_summary(how, made, &l, border_loops, start);
    return st;
}
