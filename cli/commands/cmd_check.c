/* The command check: measures the defects of a mesh and its distances to a field or another
 * mesh, and holds them against a profile. */
#include "cli/commands/command_rows.h"
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
#include <sys/stat.h>

typedef struct check_args {
    cli_common common;
    cli_input input; /* of the source volume */
    const char *source, *reference, *defects, *json, *mesh_reader;
    cli_number iso;
    cli_length tolerance;
    cli_amount min_volume;
    size_t largest;
    bool fill_voids;
    cli_printer printer;
    int profile, inside, progress;
    bool deep, open, histogram;
} check_args;

static const char *const profiles[] = {"basic", "print", "web", "fem", "game", "mobile"};

static const cli_option options[] = {
    {"profile", 'p', CLI_CHOICE, "basic/print/web/fem/game/mobile",
     "What the mesh must be fit for (basic)", offsetof(check_args, profile)},
    {"deep", 0, CLI_FLAG, NULL,
     "Look for self-intersections in every profile, and ask CGAL, too (off)",
     offsetof(check_args, deep)},
    {"histogram", 0, CLI_FLAG, NULL,
     "Print histograms of angles, aspect ratios and edge lengths (off)",
     offsetof(check_args, histogram)},
    {"defects", 0, CLI_TEXT, "FILE",
     "File to write the mesh to, with defects and distances painted: .ply, .glb or .gltf",
     offsetof(check_args, defects), CLI_VALUES_DEFECTS},
    CLI_JSON_OPTION(check_args),
    CLI_PRINTER_OPTIONS(check_args),
    CLI_HEADED("Distance to a source or a reference"),
    {"source", 's', CLI_TEXT, "VOLUME",
     "Volume to measure the distance to, and to compare the topology with",
     offsetof(check_args, source), CLI_VALUES_VOLUME},
    {"iso", 'i', CLI_LEVEL, "V",
     "Isovalue of the source's surface: a number, or a name as for 'extract'",
     offsetof(check_args, iso)},
    {"inside", 0, CLI_CHOICE, "above/below", "Which values of the source are inside (above)",
     offsetof(check_args, inside)},
    {"open", 0, CLI_FLAG, NULL,
     "Leave the source's surface open at the border of the volume (off: capped)",
     offsetof(check_args, open)},
    {"min-volume", 0, CLI_VOLUME, "V",
     "Leave out components of the source's surface that enclose less: 500mm3, 30vox (none)",
     offsetof(check_args, min_volume)},
    {"largest", 0, CLI_COUNT, "N",
     "Keep the N components of the source's surface that enclose the most (all)",
     offsetof(check_args, largest)},
    {"fill-voids", 0, CLI_FLAG, NULL,
     "Leave out the cavities of the source's surface, and all inside them (off)",
     offsetof(check_args, fill_voids)},
    {"reference", 0, CLI_TEXT, "MESH", "Mesh to measure the distance to, both ways",
     offsetof(check_args, reference), CLI_VALUES_MESH},
    {"tolerance", 0, CLI_LENGTH, "L",
     "Largest distance allowed: 0.1mm, 0.05% of the diagonal, 0.5vox of the source (none)",
     offsetof(check_args, tolerance)},
    CLI_HEADED("Reading the source"),
    CLI_CLAIM_OPTIONS("source", "the source", CLI_INPUT_ROW(check_args, source_claim)),
    CLI_PREPARING_OPTIONS(check_args),
    CLI_INSIDE_OPTIONS(check_args),
    CLI_READING_OPTIONS(check_args),
    {"mesh-reader", 0, CLI_TEXT, "NAME",
     "Read meshes as this format; names as in 'formats' (by content)",
     offsetof(check_args, mesh_reader), CLI_VALUES_MESH_READER},
    CLI_PROGRESS_OPTION(check_args),
};

static const cli_rule rules[] = {
    {"source", CLI_NEEDS, "iso"},
    {"iso min-volume largest fill-voids", CLI_NEEDS, "source"},
    {"tolerance", CLI_NEEDS, "source reference"},
    CLI_PRINTER_RULES,
};

/* State of the command: inputs and measurements; findings point into it. */
typedef struct run_state {
    const check_args *args;
    cli_number iso; /* of args, as a number */
    cli_mesh mesh, reference;
    cli_volume volume;
    uint8_t *defects; /* of each triangle; NULL unless they are painted */
    float *distances; /* largest around each vertex, or how much walls and gaps lack of their
                         limits; NULL: nothing to measure from */
    cw_quality quality, field;
    cw_crossings crossings;
    cw_cgal_facts cgal;
    cw_print_facts print;
    cw_distance to_field, from_field, to_reference, from_reference;
    cw_findings findings;
    cw_verdict verdicts[CW_MAX_VERDICTS];
    size_t verdict_count;
    cli_report report;
    double start;
} run_state;

static double least_mm3(const run_state *s)
{
    const cli_amount *min_volume = &s->args->min_volume;
    const double *spacing = s->volume.spacing;
    return !min_volume->given   ? 0
           : min_volume->voxels ? min_volume->value * spacing[0] * spacing[1] * spacing[2]
                                : min_volume->value;
}

static void put_params(cli_json *j, const void *p, const cli_made *made)
{
    const run_state *s = p;
    const check_args *args = s->args;
    (void)made;
    cli_json_text(j, "profile", profiles[args->profile]);
    cli_json_bool(j, "deep", args->deep);
    if (args->source) {
        cli_json_number(j, "iso", s->iso.value);
        cli_json_text(j, "inside", args->inside ? "below" : "above");
        cli_json_bool(j, "open", args->open);
        if (args->min_volume.given)
            cli_json_number(j, "min_volume_mm3", least_mm3(s));
        if (args->largest)
            cli_json_count(j, "largest", args->largest);
        if (args->fill_voids)
            cli_json_bool(j, "fill_voids", true);
    }
    if (args->tolerance.given)
        cli_json_number(j, "tolerance_mm", s->findings.tolerance_mm);
    if (s->findings.print)
        cli_json_printer(j, &s->print.limits);
}

static void put_facts(cli_json *j, const void *p)
{
    const run_state *s = p;
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
    if (s->findings.print)
        cli_json_print(j, &s->print);
    cli_json_errors(j, &s->findings);
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
static cw_status check_against_inputs(const check_args *args, const char *output, cw_error *err)
{
    const char *inputs[3] = {args->common.inputs[0]};
    size_t count = 1;
    if (args->source)
        inputs[count++] = args->source;
    if (args->reference)
        inputs[count++] = args->reference;
    return cli_check_output(output, inputs, count, err);
}

static cw_status check_defects_path(const check_args *args, cw_error *err)
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

static cw_status check_args_of(run_state *s, cw_error *err)
{
    const check_args *args = s->args;
    cw_status st = args->json ? check_against_inputs(args, args->json, err) : CW_OK;
    if (st != CW_OK)
        return st;
    s->report.path = args->json;
    if (args->tolerance.unit == CLI_VOXELS && !args->source)
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "--tolerance in voxels needs a volume: --source VOLUME");
    st = cli_check_printer(&args->printer, err);
    if (st != CW_OK)
        return st;
    return args->defects ? check_defects_path(args, err) : CW_OK;
}

static cw_status read_inputs(run_state *s, cw_error *err)
{
    const check_args *args = s->args;
    cli_report_begin(&s->report);
    cw_status st =
        cli_read_mesh(args->common.inputs[0], args->mesh_reader, &args->input, &s->mesh, err);
    if (st == CW_OK && args->reference)
        st = cli_read_reference(args->reference, args->mesh_reader, &args->input, &s->reference,
                                err);
    cli_input source = cli_source_input(&args->input);
    source.makes_surface = true;
    if (st == CW_OK && args->source) {
        st = cli_read_volume(args->source, &source, false, &s->volume, err);
        if (st == CW_ERR_LIMIT)
            st = cli_fail_whole(st, cli_find_unstreamed_preparation(&source), err);
    }
    if (st == CW_OK && args->source)
        st = cli_choose_level(&s->volume, &source, &s->iso, err);
    if (st == CW_OK && args->source)
        st = cli_prepare_inside(&source, &s->volume, &s->iso.value, 1, args->inside, err);
    if (st == CW_OK)
        cli_report_end(&s->report, "read", 1, s->mesh.mesh.triangle_count);
    return st;
}

/* Errors about the mesh name its file; those about the volume or reference name theirs. */
static cw_status in_mesh(const run_state *s, cw_status st, cw_error *err)
{
    return st == CW_OK ? st : cwi_fail_in(err, st, s->mesh.path);
}

static cw_status measure_mesh(run_state *s, cw_error *err)
{
    const check_args *args = s->args;
    const cw_mesh *mesh = &s->mesh.mesh;
    const int threads = (int)args->input.threads;
    const cw_quality_desc desc = {
        .weld = CW_WELD_LOCAL,
        .shells = true,
        .threads = threads,
        .defects = s->defects,
        .progress = cli_progress((double)mesh->triangle_count / 1e6, "Mtriangle")};
    const cw_crossings_desc crossings = {
        .weld = CW_WELD_LOCAL,
        .threads = threads,
        .defects = s->defects,
        .progress = cli_progress((double)mesh->triangle_count / 1e6, "Mtriangle")};
    const bool checks_crossings =
        args->deep || cw_check_wants_crossings((cw_profile)args->profile);
    cli_report_begin(&s->report);
    cw_status st = cw_quality_measure(mesh, &desc, &s->quality, err);
    if (st == CW_OK)
        cli_report_end(&s->report, "check", mesh->triangle_count, 0);
    if (st != CW_OK || !checks_crossings)
        return in_mesh(s, st, err);
    cli_report_begin(&s->report);
    st = cw_self_intersections(mesh, &crossings, &s->crossings, err);
    s->findings.crossings = st == CW_OK ? &s->crossings : NULL;
    if (st == CW_OK)
        cli_report_end(&s->report, "intersections", mesh->triangle_count, s->crossings.count);
    return in_mesh(s, st, err);
}

static cw_status ask_cgal(run_state *s, cw_error *err)
{
    if (!s->args->deep)
        return CW_OK;
    if (!cw_quality_has_cgal()) {
        cli_say("CGAL is not asked: it is not in this build");
        return CW_OK;
    }
    cli_report_begin(&s->report);
    cw_status st = cw_quality_ask_cgal(&s->mesh.mesh, CW_WELD_LOCAL, &s->cgal, err);
    s->findings.cgal = st == CW_OK ? &s->cgal : NULL;
    if (st == CW_OK)
        cli_report_end(&s->report, "cgal", s->mesh.mesh.triangle_count, 0);
    return in_mesh(s, st, err);
}

/* Separates components that the mesh lacks from the distance of the others. A component counts
 * as missing when the mesh is nowhere within a quarter of a voxel, or the tolerance if larger.
 * A component that is present, if only coarser, has some vertices on the mesh, or nearly so. */
static cw_status part_missing(run_state *s, cw_mesh *surface, const cw_mesh_distance_desc *back,
                              cw_error *err)
{
    const double *spacing = s->volume.spacing;
    const double near = 0.25 * cbrt(spacing[0] * spacing[1] * spacing[2]);
    float *distance = calloc(surface->vertex_count + 1, sizeof *distance);
    cw_drop_counts missing = {0};
    cw_status st = distance ? CW_OK : cwi_fail_memory(err);
    if (st == CW_OK)
        st = cw_distance_to_mesh(surface, &s->mesh.mesh, back, &s->from_field, distance, err);
    for (size_t v = 0; st == CW_OK && v < surface->vertex_count; v++)
        distance[v] = fabsf(distance[v]);
    if (st == CW_OK)
        st = cw_mesh_drop_distant(surface, distance, fmax(near, s->findings.tolerance_mm),
                                  &missing, &s->findings.missing_mm, err);
    free(distance);
    s->findings.missing = missing.dropped;
    s->findings.missing_mm3 = missing.largest_mm3;
    return st;
}

static cw_status measure_from_field(run_state *s, cw_mesh *surface, cw_error *err)
{
    const cw_mesh_distance_desc back = {
        .vertices_only = true, /* those are on the field's surface */
        .threads = (int)s->args->input.threads,
        .progress = cli_progress((double)surface->triangle_count / 1e6, "Mtriangle")};
    cw_status st = cw_quality_measure(surface, &(cw_quality_desc){.threads = back.threads},
                                      &s->field, err);
    if (st == CW_OK)
        st = part_missing(s, surface, &back, err);
    if (st == CW_OK && s->findings.missing)
        st = cw_distance_to_mesh(surface, &s->mesh.mesh, &back, &s->from_field, NULL, err);
    if (st == CW_OK) {
        s->findings.field = &s->field;
        s->findings.from_field = &s->from_field;
    }
    return in_mesh(s, st, err);
}

/* To the field itself; and back from its surface as we extract it. */
static cw_status compare_with_field(run_state *s, cw_error *err)
{
    const check_args *args = s->args;
    const cw_mesh *mesh = &s->mesh.mesh;
    cw_mesh surface = {0};
    const cw_field_distance_desc desc = {
        .isovalue = s->iso.value,
        .inside_is_low = args->inside,
        .leave_open = args->open,
        .worst = s->distances,
        .threads = (int)args->input.threads,
        .progress = cli_progress((double)mesh->triangle_count / 1e6, "Mtriangle")};
    cli_report_begin(&s->report);
    cw_status st = cw_distance_to_field(mesh, &s->volume.view, &desc, &s->to_field, NULL, err);
    if (st == CW_ERR_UNSUPPORTED) /* it is the volume that is of no such kind */
        return cwi_fail_in(err, st, s->volume.path);
    if (st != CW_OK)
        return in_mesh(s, st, err);
    s->findings.to_field = &s->to_field;
    const cw_pipeline_desc pipeline = {.extract = {.isovalue = s->iso.value,
                                                   .inside_is_low = args->inside,
                                                   .leave_open = args->open,
                                                   .no_normals = true,
                                                   .threads = desc.threads},
                                       .min_volume_mm3 = least_mm3(s),
                                       .largest = args->largest,
                                       .fill_voids = args->fill_voids};
    st = cli_make_surface(&s->volume, NULL, &pipeline, &surface, NULL, err);
    if (st == CW_OK)
        st = measure_from_field(s, &surface, err);
    cw_mesh_free(&surface);
    if (st == CW_OK)
        cli_report_end(&s->report, "field", mesh->triangle_count, s->to_field.samples);
    return st;
}

static cw_status compare_with_reference(run_state *s, cw_error *err)
{
    const cw_mesh *mesh = &s->mesh.mesh, *other = &s->reference.mesh;
    cw_mesh_distance_desc desc = {
        .worst = s->args->source ? NULL : s->distances,
        .threads = (int)s->args->input.threads,
        .tolerance_mm = s->findings.tolerance_mm / 100,
        .progress = cli_progress((double)mesh->triangle_count / 1e6, "Mtriangle")};
    cli_report_begin(&s->report);
    cw_status st = cw_distance_to_mesh(mesh, other, &desc, &s->to_reference, NULL, err);
    desc.worst = NULL;
    if (st == CW_OK)
        st = cw_distance_to_mesh(other, mesh, &desc, &s->from_reference, NULL, err);
    if (st != CW_OK)
        return cwi_fail_in(err, st, s->reference.path);
    s->findings.to_reference = &s->to_reference;
    s->findings.from_reference = &s->from_reference;
    cli_report_end(&s->report, "reference", mesh->triangle_count, s->to_reference.samples);
    return CW_OK;
}

/* The diagonal is that of the mesh's box, a voxel the cube root of its volume. */
static double tolerance_mm(const run_state *s)
{
    const double *spacing = s->volume.spacing;
    double low[3], high[3];
    cw_mesh_bounds(&s->mesh.mesh, low, high);
    const double diagonal = cwi_box_diagonal(low, high);
    const double voxel = cbrt(spacing[0] * spacing[1] * spacing[2]);
    return cli_length_mm(&s->args->tolerance, diagonal, voxel);
}

/* Returns true if walls and gaps are painted: distances from something have precedence. */
static bool paints_walls(const check_args *args)
{
    return args->defects && args->profile == CW_PROFILE_PRINT && !args->source &&
           !args->reference;
}

/* Finds how much walls and gaps lack of their limits, at each vertex. */
static cw_status measure_walls(run_state *s, cw_print_desc *desc, cw_error *err)
{
    const size_t count = s->mesh.mesh.vertex_count;
    desc->wall = s->distances;
    desc->gap = cwi_alloc_array(count, sizeof *desc->gap);
    cw_status st = desc->gap ? cw_print_measure(&s->mesh.mesh, desc, &s->print, err)
                             : cwi_fail_memory(err);
    const double wall = s->print.limits.min_wall_mm, gap = s->print.limits.min_gap_mm;
    for (size_t v = 0; v < count && st == CW_OK; v++)
        s->distances[v] =
            (float)fmax(0, fmax(wall - (double)desc->wall[v], gap - (double)desc->gap[v]));
    cwi_free(desc->gap);
    return st;
}

/* Open meshes have no walls, and do not meet the profile. */
static cw_status measure_print(run_state *s, cw_error *err)
{
    const cw_mesh *mesh = &s->mesh.mesh;
    cw_print_desc desc =
        cli_printer_desc(&s->args->printer, (int)s->args->input.threads, mesh->triangle_count);
    if (s->args->profile != CW_PROFILE_PRINT || !cw_quality_is_closed_manifold(&s->quality))
        return CW_OK;
    cli_report_begin(&s->report);
    cw_status st = paints_walls(s->args) ? measure_walls(s, &desc, err)
                                         : cw_print_measure(mesh, &desc, &s->print, err);
    s->findings.print = st == CW_OK ? &s->print : NULL;
    if (st == CW_OK)
        cli_report_end(&s->report, "print", mesh->triangle_count, 0);
    return in_mesh(s, st, err);
}

/* Returns the bytes of a file; 0: it is none that can be told. */
static size_t find_file_bytes(const char *path)
{
    struct stat info;
    return stat(path, &info) == 0 && S_ISREG(info.st_mode) ? (size_t)info.st_size : 0;
}

/* Without triangles there is nothing to measure from or to: the verdict says so. */
static cw_status measure_all(run_state *s, cw_error *err)
{
    const check_args *args = s->args;
    const cw_mesh *mesh = &s->mesh.mesh;
    const bool has_distances = args->source || args->reference || paints_walls(args);
    if (args->defects) {
        s->defects = cwi_alloc_zeroed(mesh->triangle_count + 1, 1);
        if (has_distances)
            s->distances = cwi_alloc_zeroed(mesh->vertex_count + 1, sizeof *s->distances);
        if (!s->defects || (has_distances && !s->distances))
            return cwi_fail_memory(err);
    }
    s->findings.quality = &s->quality;
    s->findings.tolerance_mm = tolerance_mm(s);
    s->findings.has_normals = mesh->normals;
    s->findings.file_fault = s->mesh.file.fault;
    s->findings.file_bytes = find_file_bytes(s->mesh.path);
    cw_status st = measure_mesh(s, err);
    if (st == CW_OK && mesh->triangle_count)
        st = ask_cgal(s, err);
    if (st == CW_OK && mesh->triangle_count)
        st = measure_print(s, err);
    if (st == CW_OK && mesh->triangle_count && args->source)
        st = compare_with_field(s, err);
    if (st == CW_OK && mesh->triangle_count && args->reference)
        st = compare_with_reference(s, err);
    return st;
}

static void name_paints(const run_state *s)
{
    size_t count, used = 0;
    const cw_paint *paints = cw_check_paints(&count);
    for (size_t t = 0; t < s->mesh.mesh.triangle_count; t++)
        used |= s->defects[t];
    for (size_t n = 0; n < count; n++)
        if (used & paints[n].defect)
            cli_result("  %-8s%s\n", paints[n].color, paints[n].name);
}

static cw_status paint_defects(run_state *s, cw_error *err)
{
    const cw_distance *to = s->args->source ? &s->to_field : &s->to_reference;
    const double tolerance = s->findings.tolerance_mm;
    const double full = paints_walls(s->args) ? s->print.limits.min_wall_mm
                        : tolerance > 0       ? tolerance
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
    if (paints_walls(s->args))
        cli_result(", thin walls and narrow gaps from grey at their limits to red at 0");
    else if (s->distances)
        cli_result(", distances from grey at 0 to red at %.4g mm", full);
    cli_result("\n");
    name_paints(s);
    return CW_OK;
}

static void print_facts(const run_state *s)
{
    const cw_quality *q = &s->quality;
    cli_result("%s: %s component%s", s->mesh.path, cli_count(q->components),
               q->components == 1 ? "" : "s");
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

static cw_status judge_mesh(run_state *s, cw_error *err)
{
    const check_args *args = s->args;
    s->verdict_count = cw_check_judge(&s->findings, (cw_profile)args->profile, s->verdicts);
    cli_made *made = &s->report.made[0];
    made->quality = s->quality;
    made->measured = made->shells = true;
    made->crossings = s->findings.crossings;
    print_facts(s);
    cli_print_verdicts(s->verdicts, s->verdict_count);
    if (args->histogram && s->quality.degenerate < s->quality.triangles)
        cli_print_shapes(&s->quality.shapes);
    cw_status st = args->defects ? paint_defects(s, err) : CW_OK;
    if (st == CW_OK)
        st = cli_check_verdicts(s->mesh.path, profiles[args->profile], s->verdicts,
                                s->verdict_count, err);
    if (st == CW_OK)
        cli_result("%s: meets profile %s; %.2f s\n", s->mesh.path, profiles[args->profile],
                   cli_seconds() - s->start);
    return st;
}

static void free_state(run_state *s)
{
    cw_crossings_free(&s->crossings);
    cli_free_mesh(&s->mesh);
    cli_free_mesh(&s->reference);
    cli_free_volume(&s->volume);
    cwi_free(s->defects);
    cwi_free(s->distances);
}

static cw_status check_mesh(void *state, cw_error *err)
{
    run_state *s = state;
    cli_report_next(&s->report, s->args->defects, s->iso.value);
    cw_status st = check_args_of(s, err);
    if (st == CW_OK)
        st = read_inputs(s, err);
    if (st == CW_OK)
        st = measure_all(s, err);
    return st == CW_OK ? judge_mesh(s, err) : st;
}

static cw_status run_check(void *p, cw_error *err)
{
    const check_args *args = p;
    run_state s = {.args = args, .iso = args->iso, .start = cli_seconds()};
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
    .size = sizeof(check_args),
    .run = run_check,
};
