/* Tells what was wrong with a mesh and what the repair did, in lines and in JSON. */
#include "cli/commands/repair_facts.h"

#include "cli/framework/console.h"
#include "cli/framework/quantity.h"

#include <math.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>

/* Counts that add up over parts, in the order of the report. */
static const struct repair_count {
    const char *name; /* in JSON */
    size_t offset;
} counts[] = {
    {"welded_vertices", offsetof(cw_repair_facts, welded)},
    {"split_edges", offsetof(cw_repair_facts, split_edges)},
    {"duplicate_triangles", offsetof(cw_repair_facts, duplicates)},
    {"degenerate_triangles", offsetof(cw_repair_facts, degenerate)},
    {"flipped_triangles", offsetof(cw_repair_facts, flipped_triangles)},
    {"flipped_shells", offsetof(cw_repair_facts, flipped_shells)},
    {"nonmanifold_edges", offsetof(cw_repair_facts, nonmanifold_edges)},
    {"twisted_edges", offsetof(cw_repair_facts, twisted_edges)},
    {"one_sided", offsetof(cw_repair_facts, one_sided)},
    {"nonmanifold_vertices", offsetof(cw_repair_facts, nonmanifold_vertices)},
    {"sheets", offsetof(cw_repair_facts, sheets)},
    {"sheet_triangles", offsetof(cw_repair_facts, sheet_triangles)},
    {"holes_filled", offsetof(cw_repair_facts, holes_filled)},
    {"holes_left", offsetof(cw_repair_facts, holes_left)},
    {"added_triangles", offsetof(cw_repair_facts, added_triangles)},
    {"intersections_before", offsetof(cw_repair_facts, crossings_before)},
    {"intersections_after", offsetof(cw_repair_facts, crossings_after)},
    {"touching_vertices", offsetof(cw_repair_facts, touching_vertices)},
    {"united_shells", offsetof(cw_repair_facts, united_shells)},
    {"removed_triangles", offsetof(cw_repair_facts, removed_triangles)},
    {"inner_shells", offsetof(cw_repair_facts, inner_shells)},
};

enum { COUNTS = sizeof counts / sizeof *counts };

static size_t get_count(const cw_repair_facts *f, size_t n)
{
    return *(const size_t *)(const void *)((const char *)f + counts[n].offset);
}

void cli_add_repair(cw_repair_facts *sum, const cw_repair_facts *f, bool is_first)
{
    for (size_t n = 0; n < COUNTS; n++)
        *(size_t *)(void *)((char *)sum + counts[n].offset) += get_count(f, n);
    sum->weld_mm = fmax(sum->weld_mm, f->weld_mm);
    sum->parted_mm = fmax(sum->parted_mm, f->parted_mm);
    sum->moved_mm = fmax(sum->moved_mm, f->moved_mm);
    sum->beyond_mm = fmax(sum->beyond_mm, f->beyond_mm);
    sum->max_move_mm = fmax(sum->max_move_mm, f->max_move_mm);
    sum->volume_changed = fmax(sum->volume_changed, f->volume_changed);
    sum->volume_before_mm3 +=
        f->volume_before_mm3 > 0 || f->is_wrapped ? f->volume_before_mm3 : f->volume_after_mm3;
    sum->volume_after_mm3 += f->volume_after_mm3;
    sum->inner_mm3 += f->inner_mm3;
    sum->is_refused = sum->is_refused || f->is_refused;
    if (f->largest_hole_mm > sum->largest_hole_mm) {
        sum->largest_hole_mm = f->largest_hole_mm;
        sum->largest_rim_mm = f->largest_rim_mm;
        sum->largest_fill_mm2 = f->largest_fill_mm2;
    }
    sum->is_wrapped = sum->is_wrapped || f->is_wrapped;
    sum->is_union_lacking = sum->is_union_lacking || f->is_union_lacking;
    sum->is_undecided = sum->is_undecided || f->is_undecided;
    sum->is_needed = sum->is_needed || f->is_needed;
    sum->is_sound = f->is_sound && (is_first || sum->is_sound);
}

/* --- lines -------------------------------------------------------------------------------- */

typedef struct line_writer {
    const char *path;
    bool is_report;
} line_writer;

static void put_line(const line_writer *w, const char *format, ...) CW_PRINTF(2, 3);
static void put_line(const line_writer *w, const char *format, ...)
{
    char text[320];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    if (w->is_report)
        cli_result("%s: %s\n", w->path, text);
    else
        cli_say("%s: %s", w->path, text);
}

/* Prints a count above 0, and the step that deals with it. */
static void put_count(const line_writer *w, size_t count, const char *one, const char *many,
                      const char *done)
{
    if (count)
        put_line(w, "%s %s: %s", cli_count(count), count == 1 ? one : many, done);
}

static void put_weld(const line_writer *w, const cw_repair_facts *f)
{
    if (f->weld_mm > 0)
        put_line(w, "borders within %.3g mm of each other: welded", f->weld_mm);
    put_count(w, f->split_edges, "open edge with vertices of others on it",
              "open edges with vertices of others on them", "split there");
}

static void put_holes(const line_writer *w, const cw_repair_facts *f, double max_hole_mm)
{
    char largest[96] = "";
    if (f->largest_hole_mm > 0)
        snprintf(largest, sizeof largest, ", the largest %.3g mm across and %.3g mm around",
                 f->largest_hole_mm, f->largest_rim_mm);
    if (f->holes_filled)
        put_line(w, "%s hole%s%s: filled", cli_count(f->holes_filled),
                 f->holes_filled == 1 ? "" : "s", f->holes_left ? "" : largest);
    if (f->holes_left)
        put_line(w, "%s hole%s larger than %.6g mm%s: left open", cli_count(f->holes_left),
                 f->holes_left == 1 ? "" : "s", max_hole_mm, largest);
}

static void put_crossings(const line_writer *w, const cw_repair_facts *f)
{
    put_count(w, f->crossings_before, "pair of triangles that intersect",
              "pairs of triangles that intersect",
              f->crossings_after == f->crossings_before ? "left" : "removed");
    put_count(w, f->touching_vertices, "vertex of surfaces that touch",
              "vertices of surfaces that touch", "moved inward");
    put_count(w, f->united_shells, "shell that intersects itself",
              "shells that intersect or touch each other, or themselves", "united");
    put_count(w, f->removed_triangles, "triangle around intersections",
              "triangles around intersections", "replaced");
}

void cli_print_repair(const char *path, const cw_repair_facts *f, double max_hole_mm,
                      bool is_report)
{
    const line_writer w = {path, is_report};
    put_weld(&w, f);
    put_count(&w, f->duplicates, "triangle with the vertices of another one",
              "triangles with the vertices of another one", "dropped");
    put_count(&w, f->degenerate, "triangle without area", "triangles without area",
              "dropped, or its longest edge flipped");
    put_count(&w, f->flipped_triangles, "triangle that disagrees with its neighbours",
              "triangles that disagree with their neighbours", "flipped");
    put_count(&w, f->nonmanifold_edges, "edge of more than two triangles",
              "edges of more than two triangles", "parted");
    put_count(&w, f->twisted_edges, "edge at which a one-sided surface meets itself",
              "edges at which a one-sided surface meets itself", "cut open");
    put_count(&w, f->one_sided, "one-sided component, like a Moebius strip",
              "one-sided components, like Moebius strips", "dropped, without volume");
    put_count(&w, f->nonmanifold_vertices, "vertex of several fans of triangles",
              "vertices of several fans of triangles", "parted");
    put_count(&w, f->sheets, "open component without volume", "open components without volume",
              "dropped");
    put_holes(&w, f, max_hole_mm);
    put_crossings(&w, f);
    put_count(&w, f->flipped_shells, "shell that faces the wrong way",
              "shells that face the wrong way", "flipped");
    if (f->inner_shells)
        put_line(&w, "%s shell%s inside of others: dropped; the solid gains %.6g mm3",
                 cli_count(f->inner_shells), f->inner_shells == 1 ? "" : "s", f->inner_mm3);
    if (f->is_wrapped)
        put_line(&w, "wrapped: the result is a new surface around it");
}

void cli_name_left_defects(const cw_repair_facts *f, char *text, size_t size)
{
    text[0] = 0;
    if (f->is_sound)
        return;
    if (f->holes_left)
        snprintf(text, size, "%s hole%s left open", cli_count(f->holes_left),
                 f->holes_left == 1 ? " is" : "s are");
    else if (f->crossings_after)
        snprintf(text, size, "%s pair%s of triangles still intersect%s",
                 cli_count(f->crossings_after), f->crossings_after == 1 ? "" : "s",
                 f->crossings_after == 1 ? "s" : "");
    else if (f->is_undecided)
        snprintf(text, size, "too many triangles are in one place to look for intersections");
    else
        snprintf(text, size, "it is still not closed, or no manifold");
}

void cli_json_repair(cli_json *j, const cw_repair_facts *f)
{
    for (size_t n = 0; n < COUNTS; n++)
        cli_json_count(j, counts[n].name, get_count(f, n));
    cli_json_number(j, "weld_mm", f->weld_mm);
    cli_json_number(j, "parted_mm", f->parted_mm);
    cli_json_number(j, "moved_mm", f->moved_mm);
    cli_json_number(j, "beyond_box_mm", f->beyond_mm);
    cli_json_number(j, "volume_before_mm3", f->volume_before_mm3);
    cli_json_number(j, "volume_after_mm3", f->volume_after_mm3);
    cli_json_number(j, "inner_mm3", f->inner_mm3);
    cli_json_number(j, "volume_changed", f->volume_changed);
    cli_json_bool(j, "refused", f->is_refused);
    cli_json_number(j, "largest_hole_mm", f->largest_hole_mm);
    cli_json_number(j, "largest_rim_mm", f->largest_rim_mm);
    cli_json_number(j, "largest_fill_mm2", f->largest_fill_mm2);
    cli_json_bool(j, "wrapped", f->is_wrapped);
    cli_json_bool(j, "needed", f->is_needed);
    cli_json_bool(j, "sound", f->is_sound);
}
