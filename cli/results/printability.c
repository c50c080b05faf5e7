/* Reads the limits of a printer, and writes what they mean for a mesh. */
#include "cli/results/printability.h"

#include "cli/framework/console.h"
#include "cli/framework/field_names.h"
#include "cli/results/check_verdicts.h"
#include "core/base/status.h"

#include <math.h>

cw_status cli_check_printer(const cli_printer *printer, cw_error *err)
{
    const double lean = printer->overhang.value;
    if (printer->overhang.given && !(lean > 0 && lean < 90))
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "--overhang %g: expected degrees above 0 and below 90", lean);
    return CW_OK;
}

cw_print_desc cli_printer_desc(const cli_printer *printer, int threads, size_t triangles)
{
    cw_print_desc desc = {
        .min_wall_mm = printer->wall.value,
        .min_gap_mm = printer->gap.value,
        .layer_mm = printer->layer.value,
        .overhang_deg = printer->overhang.value,
        .threads = threads,
        .progress = cli_progress((double)triangles / 1e6, "Mtriangle"),
    };
    for (int a = 0; a < 3 && printer->plate.given; a++)
        desc.plate_mm[a] = printer->plate.mm[a];
    return desc;
}

static void say_verdict(const char *name, const cw_verdict *v)
{
    const bool advises = v->advice && v->grade < CW_GRADE_OK;
    if (v->grade < CW_GRADE_OK)
        cli_say("%s: %s: %s: %s%s%s", name, cw_grade_name(v->grade), v->name, v->text,
                advises ? "; " : "",
                advises ? cli_name_options(v->advice, (char[CLI_MESSAGE]){0}) : "");
}

cw_status cli_measure_printed(const cw_mesh *mesh, const cli_printer *printer, int threads,
                              cli_printed *out, cw_error *err)
{
    const cw_print_desc print = cli_printer_desc(printer, threads, mesh->triangle_count);
    const cw_quality_desc look = {
        .weld = CW_WELD_LOCAL, .shells = true, .threads = threads, .progress = print.progress};
    const cw_crossings_desc meet = {
        .weld = CW_WELD_LOCAL, .threads = threads, .progress = print.progress};
    cw_quality quality;
    cw_crossings crossings = {0};
    cw_status st = cw_quality_measure(mesh, &look, &quality, err);
    if (st == CW_OK)
        st = cw_self_intersections(mesh, &meet, &crossings, err);
    const bool is_solid = st == CW_OK && cw_quality_is_closed_manifold(&quality);
    if (is_solid)
        st = cw_print_measure(mesh, &print, &out->facts, err);
    const cw_findings findings = {
        .quality = &quality, .crossings = &crossings, .print = is_solid ? &out->facts : NULL};
    out->count = st == CW_OK ? cw_check_judge(&findings, CW_PROFILE_PRINT, out->verdicts) : 0;
    cw_crossings_free(&crossings);
    return st;
}

cw_status cli_judge_print(const char *name, const cw_mesh *mesh, const cli_printer *printer,
                          int threads, cli_printed *out, cw_error *err)
{
    cw_status st = cli_measure_printed(mesh, printer, threads, out, err);
    for (size_t n = 0; n < out->count && st == CW_OK; n++)
        say_verdict(name, &out->verdicts[n]);
    return st == CW_OK ? cli_check_verdicts(name, "print", out->verdicts, out->count, err) : st;
}

void cli_json_printer(cli_json *j, const cw_print_desc *limits)
{
    cli_json_number(j, "min_wall_mm", limits->min_wall_mm);
    cli_json_number(j, "min_gap_mm", limits->min_gap_mm);
    cli_json_number(j, "overhang_deg", limits->overhang_deg);
    cli_json_number(j, "layer_mm", limits->layer_mm);
    if (limits->plate_mm[0] > 0)
        cli_json_numbers(j, "plate_mm", limits->plate_mm, 3);
}

static void put_width(cli_json *j, const char *key, double min_mm, const double at[3],
                      double below)
{
    cli_json_open(j, key, '{');
    if (isfinite(min_mm)) {
        cli_json_number(j, "least_mm", min_mm);
        cli_json_numbers(j, "at", at, 3);
    }
    cli_json_number(j, "below_limit_mm2", below);
    cli_json_close(j, '}');
}

void cli_json_print(cli_json *j, const cw_print_facts *f)
{
    cli_json_open(j, "print", '{');
    put_width(j, "walls", f->wall_mm, f->wall_at, f->thin_mm2);
    put_width(j, "gaps", f->gap_mm, f->gap_at, f->narrow_mm2);
    cli_json_number(j, "area_mm2", f->area_mm2);
    cli_json_number(j, "overhang_mm2", f->overhang_mm2);
    cli_json_count(j, "islands", f->islands);
    if (f->islands)
        cli_json_numbers(j, "island_at", f->island_at, 3);
    cli_json_count(j, "trapped", f->trapped);
    cli_json_number(j, "trapped_mm3", f->trapped_mm3);
    cli_json_number(j, "volume_mm3", f->volume_mm3);
    cli_json_numbers(j, "center_of_mass", f->center, 3);
    cli_json_number(j, "foot_mm2", f->foot_mm2);
    cli_json_number(j, "margin_mm", f->margin_mm);
    cli_json_number(j, "tip_deg", f->tip_deg);
    if (f->limits.plate_mm[0] > 0)
        cli_json_bool(j, "fits", f->fits);
    cli_json_close(j, '}');
}
