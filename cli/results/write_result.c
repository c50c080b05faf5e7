/* Checks a mesh, writes it to its file, and prints its summary line. */
#include "cli/results/write_result.h"

#include "cli/framework/console.h"
#include "cli/framework/quantity.h"
#include "cli/results/mesh_comparison.h"
#include "core/base/status.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

/* Parts of the mesh that is delivered, and their counts. */
typedef struct load {
    const cw_part *parts;
    size_t part_count, vertices, triangles;
} load;

static load count_load(const cw_part *parts, size_t part_count)
{
    load l = {.parts = parts, .part_count = part_count};
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
                                    COUNT(misoriented_edges),
                                    COUNT(nonmanifold_vertices),
                                    COUNT(duplicates),
                                    COUNT(degenerate),
                                    COUNT(cavities),
                                    COUNT(inside_out),
                                    COUNT(nested),
                                    COUNT(open_inward),
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
    for (int a = 0; a < 3; a++) {
        sum->min[a] = fmin(sum->min[a], q->min[a]);
        sum->max[a] = fmax(sum->max[a], q->max[a]);
    }
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
    q->to_turn = welded.to_turn;
    return CW_OK;
}

static cw_status check_mesh(cli_report *report, const cli_delivery *how, const load *l,
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

static void warn_of_loss(cli_report *report, const cli_made *made, const load *l,
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

static void tell_dropped(const cli_made *made)
{
    char list[128] = "";
    size_t used = 0;
    for (size_t i = 0; i < cli_kept_count; i++)
        if (made->dropped & cli_kept[i].flag)
            used += (size_t)snprintf(list + used, sizeof list - used, "%s%s", used ? ", " : "",
                                     cli_kept[i].name);
    if (used)
        cli_say("%s: left out, because the format cannot hold them: %s", made->path, list);
}

static cw_status write_mesh(cli_report *report, const cli_delivery *how, const load *l,
                            cli_made *made, cw_error *err)
{
    cw_write_desc desc = how->write;
    cw_write_loss loss;
    desc.progress = cli_progress((double)l->triangles / 1e6, "Mtriangle");
    desc.compressed = &made->compressed;
    cli_set_compress(how->compress, l->parts, l->part_count, how->voxel_mm, &desc);
    cli_report_begin(report);
    cw_status st = cw_parts_write_loss(made->path, l->parts, l->part_count, &desc, &loss, err);
    if (st == CW_OK)
        st = cw_parts_write(made->path, l->parts, l->part_count, &desc, err);
    if (st != CW_OK)
        return st;
    made->written = true;
    made->local = desc.local;
    made->compression = desc.compression        ? desc.compression
                        : made->compressed.bits ? CW_COMPRESS_DRACO /* a format of that alone */
                                                : CW_COMPRESS_NONE;
    memcpy(made->origin, l->parts->mesh->origin, sizeof made->origin);
    made->dropped = how->tell_dropped ? loss.dropped : 0;
    warn_of_loss(report, made, l, &loss);
    tell_dropped(made);
    cli_report_end(report, "write", l->triangles, l->triangles);
    return CW_OK;
}

/* --- the line ---------------------------------------------------------------------------- */

/* "1 472 302 triangles" */
static void print_count(size_t count, const char *noun)
{
    cli_result("%s %s%s", cli_count(count), noun, count == 1 ? "" : "s");
}

/* " (2 non-manifold edges, 1 non-manifold vertex)", without the zero counts. */
static void print_defects(size_t edges, const char *edge, size_t vertices)
{
    cli_result(" (");
    if (edges)
        print_count(edges, edge);
    if (vertices)
        cli_result("%s%s non-manifold %s", edges ? ", " : "", cli_count(vertices),
                   vertices == 1 ? "vertex" : "vertices");
    cli_result(")");
}

static void print_facing(const cw_quality *q)
{
    if (q->to_turn && q->to_turn == q->components)
        cli_result("; inside out (--orient flips it)");
    else if (q->to_turn)
        cli_result("; %s shell%s the wrong way (--orient flips %s)", cli_count(q->to_turn),
                   q->to_turn == 1 ? " faces" : "s face", q->to_turn == 1 ? "it" : "them");
}

/* The topology of a mesh that need not be closed or manifold. */
static void print_findings(const cw_quality *q)
{
    cli_result("%s", q->open_edges ? "open" : "closed");
    if (q->open_edges)
        print_defects(q->open_edges, "open edge", 0);
    if (q->nonmanifold_edges || q->nonmanifold_vertices) {
        cli_result(", not manifold");
        print_defects(q->nonmanifold_edges, "non-manifold edge", q->nonmanifold_vertices);
    } else {
        cli_result(", manifold");
    }
    if (q->misoriented_edges) {
        cli_result(", not consistently oriented");
        print_defects(q->misoriented_edges, "misoriented edge", 0);
    }
    if (q->degenerate) {
        cli_result(", ");
        print_count(q->degenerate, "triangle");
        cli_result(" without area");
    }
    print_facing(q);
}

static void print_topology(const cli_delivery *how, const cw_quality *q)
{
    if (how->unpromised)
        print_findings(q);
    else if (how->open)
        cli_result("%s, manifold", q->open_edges ? "open at the volume's border" : "closed");
    else
        cli_result("closed, manifold");
    cli_result("; ");
}

/* Triangles, vertices and components, then the parts that hold them. */
static void print_counts(const cli_delivery *how, const cli_made *made, const load *l)
{
    print_count(l->triangles, "triangle");
    cli_result(", %s %s", cli_count(l->vertices), l->vertices == 1 ? "vertex" : "vertices");
    if (made->measured) {
        cli_result(", ");
        print_count(made->quality.components, "component");
    }
    if (l->part_count > 1)
        cli_result(" in %zu %s", l->part_count, how->parts ? how->parts : "parts");
}

static void print_box(const cli_delivery *how, const cw_quality *q, size_t border_loops)
{
    cli_result("; box %.6g x %.6g x %.6g mm", q->max[0] - q->min[0], q->max[1] - q->min[1],
               q->max[2] - q->min[2]);
    if (border_loops && !how->open && !how->unpromised)
        cli_result("; capped at %s opening%s on the volume's border", cli_count(border_loops),
                   border_loops == 1 ? "" : "s");
}

static void print_compressed(const cli_made *made)
{
    const cw_compressed *c = &made->compressed;
    cli_result("; compressed by %s", cli_compression_name(made->compression));
    if (c->bits)
        cli_result(" to %d bits, error at most %.3g mm", c->bits, c->error_mm);
    else
        cli_result(", positions unchanged");
    if (c->fragments)
        cli_result(", in steps of %.3g mm, %s fragment%s", c->step_mm, cli_count(c->fragments),
                   c->fragments == 1 ? "" : "s");
    if (c->dropped) {
        cli_result(", ");
        print_count(c->dropped, "triangle");
        cli_result(c->fragments ? " smaller than a step left out"
                                : " with a repeated vertex left out");
    }
    cli_result(", verified by decoding");
}

/* The larger distance of both directions; the root mean square of both. */
static void print_distance(const cli_comparison *c)
{
    const cw_distance *to = &c->with_input.to_reference, *from = &c->with_input.from_reference;
    const double percent = c->diagonal_mm > 0 ? 100 / c->diagonal_mm : 0;
    const double most = fmax(to->max_mm, from->max_mm), p99 = fmax(to->p99_mm, from->p99_mm);
    const double rms = cw_mesh_comparison_rms(&c->with_input);
    cli_result("; distance to %s, both ways, at most %.3g mm (%.2g %% of the diagonal), "
               "RMS %.3g mm (%.2g %%), 99 %% within %.3g mm (%.2g %%)",
               c->other ? c->other : "the input", most, percent * most, rms, percent * rms, p99,
               percent * p99);
    if (c->promised_mm > 0)
        cli_result(", within the limit of %.6g mm", c->promised_mm);
}

static void print_comparison(const cli_comparison *c)
{
    if (c->made)
        print_distance(c);
    if (c->has_field)
        cli_result("; distance to the volume's isosurface at most %.3g mm, RMS %.3g mm",
                   c->to_field.max_mm, c->to_field.rms_mm);
    if (c->has_full_field)
        cli_result(" (full surface: at most %.3g mm, RMS %.3g mm)", c->full_to_field.max_mm,
                   c->full_to_field.rms_mm);
}

/* The last step is shown as long as the one before it. */
static void print_times(const load *l)
{
    const cw_part *first = l->parts, *last = first + l->part_count - 1;
    cli_result("; animation of %.6g s", 2 * last->time_s - last[-1].time_s - first->time_s);
}

/* Facts of the command, in words. */
static void print_facts(const cli_delivery *how, const cli_made *made)
{
    if (made->timed)
        cli_result("; at time %.6g s", made->moment->time_s);
    if (made->snapped)
        cli_result("; %s %s merged by --snap, error at most %.3g mm (%.2g voxels)",
                   cli_count(made->snap.vertices),
                   made->snap.vertices == 1 ? "vertex" : "vertices", made->snap.max_error_mm,
                   made->snap.max_error_voxels);
    print_comparison(&made->compared);
    if (made->local)
        cli_result("; coordinates relative to %.15g, %.15g, %.15g mm", made->origin[0],
                   made->origin[1], made->origin[2]);
    if (made->compression)
        print_compressed(made);
    if (how->found)
        cli_result("%s", how->found);
    if (how->preview)
        cli_result("; a preview");
}

/* "NAME: topology; counts; box; further facts; size; time": the time stands alone. */
static void print_summary(const cli_delivery *how, const cli_made *made, const load *l,
                          size_t border_loops, double start)
{
    struct stat info = {0};
    if (made->written)
        cli_result("%s: ", made->path);
    else
        cli_result("step %zu: ", made->moment->number);
    if (made->measured)
        print_topology(how, &made->quality);
    print_counts(how, made, l);
    if (made->measured)
        print_box(how, &made->quality, border_loops);
    if (how->write.animated && made->written)
        print_times(l);
    print_facts(how, made);
    if (made->written && stat(made->path, &info) == 0)
        cli_result("; %s", cli_bytes(S_ISDIR(info.st_mode) ? (double)made->compressed.bytes
                                                           : (double)info.st_size));
    cli_result("; %.2f s\n", cli_seconds() - start);
}

/* Fails when compression merged vertices or flattened triangles. Bits that were given are used
 * all the same, so the file is already written. */
static cw_status hold_to_shape(const cli_made *made, cw_error *err)
{
    const cw_compressed *c = &made->compressed;
    if (!c->merged && !c->flat)
        return CW_OK;
    return cwi_fail(err, CW_ERR_CHECK,
                    "%s: with %d bits %s vertices fall onto others and %s triangles lose their "
                    "area; without --bits enough bits are chosen",
                    cli_shown_path(made->path), c->bits, cli_count(c->merged),
                    cli_count(c->flat));
}

cw_status cli_deliver(cli_report *report, const cli_delivery *how, const cw_part *parts,
                      size_t part_count, size_t border_loops, double start, cw_error *err)
{
    const load l = count_load(parts, part_count);
    cli_made *made = &report->made[report->made_count - 1];
    cw_status st = how->unchecked ? CW_OK : check_mesh(report, how, &l, made, err);
    if (st == CW_OK)
        st = write_mesh(report, how, &l, made, err);
    if (st == CW_OK)
        print_summary(how, made, &l, border_loops, start);
    return st == CW_OK ? hold_to_shape(made, err) : st;
}

cw_status cli_deliver_step(cli_report *report, const cli_delivery *how, const cw_mesh *mesh,
                           size_t border_loops, double start, cw_error *err)
{
    const cw_part part = {.mesh = mesh};
    const load l = count_load(&part, 1);
    cli_made *made = &report->made[report->made_count - 1];
    cw_status st = how->unchecked ? CW_OK : check_mesh(report, how, &l, made, err);
    if (st == CW_OK)
        print_summary(how, made, &l, border_loops, start);
    return st;
}
