/* The command check: measures the defects of a mesh and its distances to a field or another
 * mesh, and holds them against a profile. */
#include "cli/check/check_labels.h"
#include "cli/check/check_run.h"
#include "cli/framework/commands.h"
#include "cli/framework/console.h"
#include "cli/framework/quantity.h"
#include "cli/inputs/extract_surface.h"
#include "cli/inputs/level_choice.h"
#include "cli/inputs/mesh_input.h"
#include "cli/inputs/volume_prepare.h"
#include "cli/results/check_verdicts.h"
#include "cli/results/output_names.h"
#include "cli/results/printability.h"
#include "cli/results/run_report.h"
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/box.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char *const profiles[] = {"basic", "print", "web", "fem", "game", "mobile"};

static const cli_option options[] = {
    {"profile", 'p', CLI_CHOICE, "basic/print/web/fem/game/mobile",
     "What the mesh must be fit for (basic)", offsetof(cli_check_args, profile)},
    {"deep", 0, CLI_FLAG, NULL,
     "Look for self-intersections in every profile, and ask CGAL, too (off)",
     offsetof(cli_check_args, deep)},
    {"histogram", 0, CLI_FLAG, NULL,
     "Print histograms of angles, aspect ratios and edge lengths (off)",
     offsetof(cli_check_args, histogram)},
    {"defects", 0, CLI_TEXT, "FILE",
     "File to write the mesh to, with defects and distances painted: .ply, .glb or .gltf",
     offsetof(cli_check_args, defects), CLI_VALUES_DEFECTS},
    CLI_JSON_OPTION(cli_check_args),
    CLI_PRINTER_OPTIONS(cli_check_args),
    CLI_HEADED("Distance to a source or a reference"),
    {"source", 's', CLI_TEXT, "VOLUME",
     "Volume to compare with at --iso; for a file of labels the label map, label by label",
     offsetof(cli_check_args, source), CLI_VALUES_VOLUME},
    {"iso", 'i', CLI_LEVEL, "V",
     "Isovalue of the source's surface: a number, or a name as for 'extract'",
     offsetof(cli_check_args, iso)},
    {"inside", 0, CLI_CHOICE, "above/below", "Which values of the source are inside (above)",
     offsetof(cli_check_args, inside)},
    {"open", 0, CLI_FLAG, NULL,
     "Leave the source's surface open at the border of the volume (off: capped)",
     offsetof(cli_check_args, open)},
    {"min-volume", 0, CLI_VOLUME, "V",
     "Leave out components of the source's surface that enclose less: 500mm3, 30vox (none)",
     offsetof(cli_check_args, min_volume)},
    {"largest", 0, CLI_COUNT, "N",
     "Keep the N components of the source's surface that enclose the most (all)",
     offsetof(cli_check_args, largest)},
    {"fill-voids", 0, CLI_FLAG, NULL,
     "Leave out the cavities of the source's surface, and all inside them (off)",
     offsetof(cli_check_args, fill_voids)},
    {"reference", 0, CLI_TEXT, "MESH", "Mesh to measure the distance to, both ways",
     offsetof(cli_check_args, reference), CLI_VALUES_MESH},
    {"tolerance", 0, CLI_LENGTH, "L",
     "Largest distance allowed: 0.1mm, 0.05% of the diagonal, 0.5vox of the source (none)",
     offsetof(cli_check_args, tolerance)},
    {"looks", 0, CLI_TEXT, "none/N/NdB",
     "Compare the looks with the reference, too; limits: mean CIEDE2000 of N, PSNR of NdB",
     offsetof(cli_check_args, looks)},
    CLI_HEADED("Reading the source"),
    CLI_CLAIM_OPTIONS("source", "the source", CLI_INPUT_ROW(cli_check_args, source_claim)),
    CLI_PREPARING_OPTIONS(cli_check_args),
    CLI_INSIDE_OPTIONS(cli_check_args),
    CLI_READING_OPTIONS(cli_check_args),
    {"mesh-reader", 0, CLI_TEXT, "NAME",
     "Read meshes as this format; names as in 'formats' (by content)",
     offsetof(cli_check_args, mesh_reader), CLI_VALUES_MESH_READER},
    CLI_PROGRESS_OPTION(cli_check_args),
};

static const cli_rule rules[] = {
    {"iso min-volume largest fill-voids", CLI_NEEDS, "source"},
    {"tolerance", CLI_NEEDS, "source reference"},
    {"looks", CLI_NEEDS, "reference"},
    CLI_PRINTER_RULES,
};

static void put_params(cli_json *j, const void *p, const cli_made *made)
{
    const cli_check_run *s = p;
    const cli_check_args *args = s->args;
    (void)made;
    cli_json_text(j, "profile", profiles[args->profile]);
    cli_json_bool(j, "deep", args->deep);
    if (args->source && s->iso.given) {
        cli_json_number(j, "iso", s->iso.value);
        cli_json_text(j, "inside", args->inside ? "below" : "above");
        cli_json_bool(j, "open", args->open);
        if (args->min_volume.given)
            cli_json_number(j, "min_volume_mm3", cli_check_least_mm3(s));
        if (args->largest)
            cli_json_count(j, "largest", args->largest);
        if (args->fill_voids)
            cli_json_bool(j, "fill_voids", true);
    }
    if (args->tolerance.given)
        cli_json_number(j, "tolerance_mm", s->findings.tolerance_mm);
    if (args->looks)
        cli_json_text(j, "looks", args->looks);
    if (s->findings.print)
        cli_json_printer(j, &s->print.limits);
}

static void put_facts(cli_json *j, const void *p)
{
    const cli_check_run *s = p;
    if (s->mesh.file.format)
        cli_json_mesh_file(j, "input", &s->mesh);
    if (s->volume.format)
        cli_json_input(j, "source", &s->volume);
    if (s->reference.file.format)
        cli_json_mesh_file(j, "reference", &s->reference);
    if (!s->verdict_count)
        return;
    cli_json_text(j, "profile", profiles[s->args->profile]);
    cli_json_verdicts(j, s->verdicts, s->verdict_count);
    if (s->solids)
        cli_json_part_checks(j, s->solids);
    if (s->findings.print)
        cli_json_print(j, &s->print);
    cli_json_errors(j, &s->findings);
    if (s->findings.looks)
        cli_looks_json(j, s->findings.looks, s->findings.bare_looks);
    if (s->findings.missing) {
        cli_json_open(j, "missing", '{');
        cli_json_count(j, "components", s->findings.missing);
        cli_json_number(j, "largest_mm3", s->findings.missing_mm3);
        cli_json_number(j, "max_mm", s->findings.missing_mm);
        cli_json_close(j, '}');
    }
    cli_json_shapes(j, &s->quality.shapes);
}

/* An output must be none of the inputs. */
static cw_status check_against_inputs(const cli_check_args *args, const char *output,
                                      cw_error *err)
{
    const char *inputs[3] = {args->common.inputs[0]};
    size_t count = 1;
    if (args->source)
        inputs[count++] = args->source;
    if (args->reference)
        inputs[count++] = args->reference;
    return cli_check_output(output, inputs, count, err);
}

static cw_status check_defects_path(const cli_check_args *args, cw_error *err)
{
    const char *dot = strrchr(args->defects, '.');
    const bool colored = dot && (strcmp(dot, ".ply") == 0 || strcmp(dot, ".glb") == 0 ||
                                 strcmp(dot, ".gltf") == 0);
    if (!colored)
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "%s: --defects needs colours, which .ply, .glb and .gltf hold",
                        args->defects);
    cw_status st = check_against_inputs(args, args->defects, err);
    if (st == CW_OK && args->json)
        st = cli_check_apart(args->json, args->defects, err);
    if (st != CW_OK)
        return st;
    st = cw_mesh_write_check(args->defects, NULL, err);
    return st == CW_OK ? st : cwi_fail_in(err, st, args->defects);
}

static cw_status check_args_of(cli_check_run *s, cw_error *err)
{
    const cli_check_args *args = s->args;
    cw_status st = args->json ? check_against_inputs(args, args->json, err) : CW_OK;
    if (st != CW_OK)
        return st;
    s->report.path = args->json;
    if (args->tolerance.unit == CLI_VOXELS && !args->source)
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "--tolerance in voxels needs a volume: --source VOLUME");
    st = cli_check_printer(&args->printer, err);
    if (st == CW_OK && args->looks)
        st = cli_looks_parse(args->looks, &s->looks_limit, err);
    if (st != CW_OK)
        return st;
    return args->defects ? check_defects_path(args, err) : CW_OK;
}

static bool has_solids(const cli_check_run *s)
{
    return s->solids && s->solids->count > 0;
}

/* Returns true if the mesh is compared as a whole with something, or painted. */
static bool compares_whole(const cli_check_args *args)
{
    return args->iso.given || args->reference || args->defects;
}

/* Finds the solids of a file that has several. Only those of labels have a source without --iso. */
static cw_status find_solids(cli_check_run *s, cw_error *err)
{
    s->solids = calloc(1, sizeof *s->solids);
    cw_status st = s->solids ? cli_find_part_checks(s, s->solids, err) : cwi_fail_memory(err);
    if (st == CW_OK && has_solids(s))
        cli_say("%s: its %zu %s are judged each by itself", s->mesh.path, s->solids->count,
                s->solids->of_labels ? "labels" : "parts");
    if (st == CW_OK && s->args->source && !s->solids->of_labels)
        st = cwi_fail(err, CW_ERR_ARGUMENT,
                      "%s: no surfaces of labels; --source then needs --iso V, the isovalue",
                      s->mesh.path);
    return st;
}

static cw_status read_inputs(cli_check_run *s, cw_error *err)
{
    const cli_check_args *args = s->args;
    cli_report_begin(&s->report);
    cw_status st =
        cli_read_mesh(args->common.inputs[0], args->mesh_reader, &args->input, &s->mesh, err);
    if (st == CW_OK && !compares_whole(args))
        st = find_solids(s, err);
    else if (st == CW_OK && args->source && !args->iso.given)
        st = cwi_fail(err, CW_ERR_ARGUMENT,
                      "--source needs --iso V with --reference and --defects");
    if (st == CW_OK && args->reference)
        st = cli_read_reference(args->reference, args->mesh_reader, &args->input, &s->reference,
                                err);
    cli_input source = cli_source_input(&args->input);
    source.makes_surface = args->iso.given;
    source.of_labels = !args->iso.given;
    if (st == CW_OK && args->source) {
        st = cli_read_volume(args->source, &source, false, &s->volume, err);
        if (st == CW_ERR_LIMIT)
            st = cli_fail_whole(st, cli_find_unstreamed_preparation(&source), err);
    }
    if (st == CW_OK && args->source && args->iso.given)
        st = cli_choose_level(&s->volume, &source, &s->iso, err);
    if (st == CW_OK && args->source && args->iso.given)
        st = cli_prepare_inside(&source, &s->volume, &s->iso.value, 1, args->inside, err);
    if (st == CW_OK)
        cli_report_end(&s->report, "read", 1, s->mesh.mesh.triangle_count);
    return st;
}

static void name_paints(const cli_check_run *s)
{
    size_t count, used = 0;
    const cw_paint *paints = cw_check_paints(&count);
    for (size_t t = 0; t < s->mesh.mesh.triangle_count; t++)
        used |= s->defects[t];
    for (size_t n = 0; n < count; n++)
        if (used & paints[n].defect)
            cli_result("  %-8s%s\n", paints[n].color, paints[n].name);
}

static cw_status paint_defects(cli_check_run *s, cw_error *err)
{
    const cw_distance *to = s->args->source ? &s->to_field : &s->to_reference;
    const double tolerance = s->findings.tolerance_mm;
    const double full = cli_check_paints_walls(s->args) ? s->print.limits.min_wall_mm
                        : tolerance > 0                 ? tolerance
                                                        : to->max_mm;
    cw_mesh painted;
    cli_made *made = &s->report.made[0];
    cw_status st = cw_check_paint(&s->mesh.mesh, s->defects, s->distances, full, &painted, err);
    if (st == CW_OK)
        st = cw_mesh_write(s->args->defects, &painted, NULL, err);
    cw_mesh_free(&painted);
    if (st != CW_OK)
        return st;
    made->written = true;
    cli_result("%s: the mesh with its defects painted", s->args->defects);
    if (cli_check_paints_walls(s->args))
        cli_result(", thin walls and narrow gaps from grey at their limits to red at 0");
    else if (s->distances)
        cli_result(", distances from grey at 0 to red at %.4g mm", full);
    cli_result("\n");
    name_paints(s);
    return CW_OK;
}

static void print_facts(const cli_check_run *s)
{
    const cw_quality *q = &s->quality;
    cli_result("%s: ", s->mesh.path);
    if (has_solids(s))
        cli_result("%zu %s, ", s->solids->count, s->solids->of_labels ? "labels" : "parts");
    cli_result("%s component%s", cli_count(q->components), q->components == 1 ? "" : "s");
    if (q->cavities)
        cli_result(", %s of them cavities", cli_count(q->cavities));
    if (q->genus >= 0)
        cli_result(", %lld handle%s", (long long)q->genus, q->genus == 1 ? "" : "s");
    cli_result("; box %.6g x %.6g x %.6g mm, area %.6g mm2", q->max[0] - q->min[0],
               q->max[1] - q->min[1], q->max[2] - q->min[2], q->area_mm2);
    if (cw_quality_is_closed_manifold(q) && q->triangles)
        cli_result(", volume %.6g mm3", q->volume_mm3);
    cli_result("\n");
}

static cw_status judge_mesh(cli_check_run *s, cw_error *err)
{
    const cli_check_args *args = s->args;
    if (!has_solids(s))
        s->verdict_count = cw_check_judge(&s->findings, (cw_profile)args->profile, s->verdicts);
    cli_made *made = &s->report.made[0];
    made->quality = s->quality;
    made->measured = made->shells = true;
    made->crossings = s->findings.crossings;
    print_facts(s);
    cli_print_verdicts(s->verdicts, s->verdict_count);
    if (args->histogram && s->quality.degenerate < s->quality.triangles)
        cli_print_shapes(&s->quality.shapes);
    if (s->findings.looks)
        cli_looks_print(s->findings.looks, s->findings.bare_looks);
    cw_status st = args->defects ? paint_defects(s, err) : CW_OK;
    if (st == CW_OK)
        st = cli_check_verdicts(s->mesh.path, profiles[args->profile], s->verdicts,
                                s->verdict_count, err);
    if (st == CW_OK)
        cli_result("%s: meets profile %s; %.2f s\n", s->mesh.path, profiles[args->profile],
                   cli_seconds() - s->start);
    return st;
}

static void free_state(cli_check_run *s)
{
    if (s->solids)
        cli_free_part_checks(s->solids);
    free(s->solids);
    cw_crossings_free(&s->crossings);
    cli_free_mesh(&s->mesh);
    cli_free_mesh(&s->reference);
    cli_free_volume(&s->volume);
    cwi_free(s->defects);
    cwi_free(s->distances);
}

static cw_status check_mesh(void *state, cw_error *err)
{
    cli_check_run *s = state;
    cli_report_next(&s->report, s->args->defects, s->iso.value);
    cw_status st = check_args_of(s, err);
    if (st == CW_OK)
        st = read_inputs(s, err);
    if (st == CW_OK)
        st = has_solids(s) ? cli_check_parts(s, s->solids, err) : cli_check_measure(s, err);
    return st == CW_OK ? judge_mesh(s, err) : st;
}

static cw_status run_check(void *p, cw_error *err)
{
    const cli_check_args *args = p;
    cli_check_run s = {.args = args, .iso = args->iso, .start = cli_seconds()};
    s.report.command = "check";
    s.report.params = put_params;
    s.report.facts = put_facts;
    s.report.args = &s;
    const cli_run run = {.common = &args->common,
                         .progress = args->progress,
                         .json = args->json,
                         .body = check_mesh,
                         .state = &s};
    cw_status st = cli_run_reported(&run, &s.report, err);
    free_state(&s);
    return st;
}

const cli_command cli_check = {
    .name = "check",
    .usage = "MESH [--profile NAME] [--source VOLUME --iso V] [options]",
    .about = "Check a mesh: closed, manifold, without intersections, close to its source",
    .page = cli_page_check,
    .options = options,
    .option_count = sizeof options / sizeof *options,
    .rules = rules,
    .rule_count = sizeof rules / sizeof *rules,
    .min_inputs = 1,
    .max_inputs = 1,
    .inputs = CLI_VALUES_MESH,
    .size = sizeof(cli_check_args),
    .run = run_check,
};
