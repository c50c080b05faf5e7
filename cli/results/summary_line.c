/* Prints the line about a mesh that was delivered: topology, counts, box, facts, size, time. */
#include "cli/results/summary_line.h"

#include "cli/framework/console.h"
#include "cli/framework/quantity.h"
#include "cli/framework/standard_streams.h"
#include "cli/results/mesh_comparison.h"

#include <math.h>

/* "1 472 302 triangles" */
static void print_count(size_t count, const char *noun)
{
    cli_result("%s %s%s", cli_count(count), noun, count == 1 ? "" : "s");
}

/* " (2 non-manifold edges, 1 non-manifold vertex)", without the zero counts. */
static void print_defects(const char *kind, size_t edges, size_t vertices)
{
    cli_result(" (");
    if (edges)
        cli_result("%s %s edge%s", cli_count(edges), kind, edges == 1 ? "" : "s");
    if (vertices)
        cli_result("%s%s %s %s", edges ? ", " : "", cli_count(vertices), kind,
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
        print_defects("open", q->open_edges, 0);
    const size_t edges = q->nonmanifold_edges - q->contact_edges,
                 vertices = q->nonmanifold_vertices - q->contact_vertices;
    if (edges || vertices) {
        cli_result(", not manifold");
        print_defects("non-manifold", edges, vertices);
    } else if (q->contact_edges || q->contact_vertices) {
        cli_result(", manifold but for contacts");
        print_defects("contact", q->contact_edges, q->contact_vertices);
    } else {
        cli_result(", manifold");
    }
    if (q->misoriented_edges) {
        cli_result(", not consistently oriented");
        print_defects("misoriented", q->misoriented_edges, 0);
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
static void print_counts(const cli_delivery *how, const cli_made *made, const cli_load *l)
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
    const double max = fmax(to->max_mm, from->max_mm), p99 = fmax(to->p99_mm, from->p99_mm);
    const double rms = cw_mesh_comparison_rms(&c->with_input);
    cli_result("; distance to %s, both ways, at most %.3g mm (%.2g %% of the diagonal), "
               "RMS %.3g mm (%.2g %%), 99 %% within %.3g mm (%.2g %%)",
               c->other ? c->other : "the input", max, percent * max, rms, percent * rms, p99,
               percent * p99);
    if (c->promised_mm > 0)
        cli_result(", within the limit of %.6g mm", c->promised_mm);
}

/* From which distance on a level of detail will do. */
static void print_switch(const cli_made *made)
{
    if (made->switch_m > 0)
        cli_result("; less than a pixel from %.3g m on (1080 rows over 60 degrees)",
                   made->switch_m);
}

/* Texels along the side of a texture, for distances in texels. */
enum { TEXELS = 2048 };

static void print_comparison(const cli_comparison *c)
{
    if (c->made)
        print_distance(c);
    if (c->has_texture)
        cli_result(
            "; texture moved by at most %.3g mm, mean %.2g mm (%.2g and %.2g texels of %d)",
            c->texture.max_mm, c->texture.mean_mm,
            c->texture.max_mm / c->texture.side_mm * TEXELS,
            c->texture.mean_mm / c->texture.side_mm * TEXELS, TEXELS);
    if (c->has_field)
        cli_result("; distance to the volume's isosurface at most %.3g mm, RMS %.3g mm",
                   c->to_field.max_mm, c->to_field.rms_mm);
    if (c->has_full_field)
        cli_result(" (full surface: at most %.3g mm, RMS %.3g mm)", c->full_to_field.max_mm,
                   c->full_to_field.rms_mm);
}

/* The last step is shown as long as the one before it. */
static void print_times(const cli_load *l)
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
    print_switch(made);
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

void cli_print_summary(const cli_delivery *how, const cli_made *made, const cli_load *l,
                       size_t border_loops, double start)
{
    double bytes;
    if (made->written)
        cli_result("%s: ", made->path);
    else if (made->moment)
        cli_result("step %zu: ", made->moment->number);
    else
        cli_result("%s: ", made->name);
    if (made->measured)
        print_topology(how, &made->quality);
    print_counts(how, made, l);
    if (made->measured)
        print_box(how, &made->quality, border_loops);
    if (how->write.animated && made->written)
        print_times(l);
    print_facts(how, made);
    if (made->written)
        cli_result("; %s", cli_bytes(cli_find_output_size(made->path, &bytes)
                                         ? bytes
                                         : (double)made->compressed.bytes));
    cli_result("; %.2f s\n", cli_seconds() - start);
}
