/* Measures a mesh for the command check: its defects, and how far and how different it is from a field or from
 * another mesh. */
#include "cli/check/check_run.h"

#include "cli/framework/console.h"
#include "cli/framework/standard_streams.h"
#include "cli/inputs/extract_surface.h"
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/box.h"
#include "core/geometry/vec3.h"

#include <math.h>
#include <stdlib.h>

/* Between the middles of two boxes, as a share of the diagonal: then a mesh was moved. */
static const double FAR_APART = 0.05;

double cli_check_least_mm3(const cli_check_run *s)
{
    const cli_amount *min_volume = &s->args->min_volume;
    const double *spacing = s->volume.spacing;
    return !min_volume->given   ? 0
           : min_volume->voxels ? min_volume->value * spacing[0] * spacing[1] * spacing[2]
                                : min_volume->value;
}

/* Errors about the mesh name its file; those about the volume or reference name theirs. */
static cw_status in_mesh(const cli_check_run *s, cw_status st, cw_error *err)
{
    return st == CW_OK ? st : cwi_fail_in(err, st, s->mesh.path);
}

static cw_status measure_mesh(cli_check_run *s, cw_error *err)
{
    const cli_check_args *args = s->args;
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

static cw_status ask_cgal(cli_check_run *s, cw_error *err)
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
static cw_status part_missing(cli_check_run *s, cw_mesh *surface,
                              const cw_mesh_distance_desc *back, cw_error *err)
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

static cw_status measure_from_field(cli_check_run *s, cw_mesh *surface, cw_error *err)
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
static cw_status compare_with_field(cli_check_run *s, cw_error *err)
{
    const cli_check_args *args = s->args;
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
                                       .min_volume_mm3 = cli_check_least_mm3(s),
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

static cw_status compare_with_reference(cli_check_run *s, cw_error *err)
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

/* Says when the mesh lies elsewhere than the reference, as after a change of its pivot. */
static void say_apart(const cli_check_run *s)
{
    double low[2][3], high[2][3], middle[2][3];
    cw_mesh_bounds(&s->mesh.mesh, low[0], high[0]);
    cw_mesh_bounds(&s->reference.mesh, low[1], high[1]);
    for (int n = 0; n < 2; n++)
        cwi_lerp(low[n], high[n], 0.5, middle[n]);
    const double apart = cwi_distance(middle[0], middle[1]);
    if (apart > FAR_APART * cwi_box_diagonal(low[1], high[1]))
        cli_say("%s: the middle of its box is %.3g mm from that of %s: --looks compares them "
                "where they lie",
                s->mesh.path, apart, s->reference.path);
}

/* Compares pictures of the mesh and of the reference. */
static cw_status compare_looks(cli_check_run *s, cw_error *err)
{
    const cli_check_args *args = s->args;
    const cw_appearance_desc desc = {.threads = (int)args->input.threads,
                                     .progress = cli_progress(8, "view")};
    cli_looks mesh = {0}, reference = {0};
    say_apart(s);
    cli_report_begin(&s->report);
    cw_status st = cli_looks_find(&s->mesh, false, args->mesh_reader, &args->input, &mesh, err);
    if (st == CW_OK)
        st = cli_looks_find(&s->reference, true, args->mesh_reader, &args->input, &reference,
                            err);
    if (st == CW_OK)
        st = cw_appearance_measure(reference.surfaces, reference.count, mesh.surfaces,
                                   mesh.count, &desc, &s->looks, &s->bare_looks, err);
    s->has_maps = mesh.has_maps;
    cli_looks_free(&mesh);
    cli_looks_free(&reference);
    if (st != CW_OK)
        return st;
    s->findings.looks = &s->looks;
    s->findings.bare_looks = s->has_maps ? &s->bare_looks : NULL;
    s->findings.max_delta_e = s->looks_limit.max_delta_e;
    s->findings.min_psnr_db = s->looks_limit.min_psnr_db;
    cli_report_end(&s->report, "looks", s->mesh.mesh.triangle_count, s->looks.all.pixels);
    return CW_OK;
}

/* The diagonal is that of the mesh's box, a voxel the cube root of its volume. */
double cli_check_tolerance_mm(const cli_check_run *s)
{
    const double *spacing = s->volume.spacing;
    double low[3], high[3];
    cw_mesh_bounds(&s->mesh.mesh, low, high);
    const double diagonal = cwi_box_diagonal(low, high);
    const double voxel = cbrt(spacing[0] * spacing[1] * spacing[2]);
    return cli_length_mm(&s->args->tolerance, diagonal, voxel);
}

bool cli_check_paints_walls(const cli_check_args *args)
{
    return args->defects && args->profile == CW_PROFILE_PRINT && !args->source &&
           !args->reference;
}

/* Finds how much walls and gaps lack of their limits, at each vertex. */
static cw_status measure_walls(cli_check_run *s, cw_print_desc *desc, cw_error *err)
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
static cw_status measure_print(cli_check_run *s, cw_error *err)
{
    const cw_mesh *mesh = &s->mesh.mesh;
    cw_print_desc desc =
        cli_printer_desc(&s->args->printer, (int)s->args->input.threads, mesh->triangle_count);
    if (s->args->profile != CW_PROFILE_PRINT || !cw_quality_is_closed_manifold(&s->quality))
        return CW_OK;
    cli_report_begin(&s->report);
    cw_status st = cli_check_paints_walls(s->args)
                       ? measure_walls(s, &desc, err)
                       : cw_print_measure(mesh, &desc, &s->print, err);
    s->findings.print = st == CW_OK ? &s->print : NULL;
    desc.wall = desc.gap = NULL;
    if (st == CW_OK && mesh->triangle_count)
        st = cw_orient_print(mesh, &desc, &s->orient, err);
    s->findings.orient = st == CW_OK && s->orient.poses ? &s->orient : NULL;
    if (st == CW_OK)
        cli_report_end(&s->report, "print", mesh->triangle_count, 0);
    return in_mesh(s, st, err);
}

/* Returns the bytes of a file; 0: it is none that can be told. */
static size_t find_file_bytes(const char *path)
{
    double bytes;
    return cli_find_input_size(path, &bytes) ? (size_t)bytes : 0;
}

/* Without triangles there is nothing to measure from or to: the verdict says so. */
cw_status cli_check_measure(cli_check_run *s, cw_error *err)
{
    const cli_check_args *args = s->args;
    const cw_mesh *mesh = &s->mesh.mesh;
    const bool has_distances = args->source || args->reference || cli_check_paints_walls(args);
    if (args->defects) {
        s->defects = cwi_alloc_zeroed(mesh->triangle_count + 1, 1);
        if (has_distances)
            s->distances = cwi_alloc_zeroed(mesh->vertex_count + 1, sizeof *s->distances);
        if (!s->defects || (has_distances && !s->distances))
            return cwi_fail_memory(err);
    }
    s->findings.quality = &s->quality;
    s->findings.tolerance_mm = cli_check_tolerance_mm(s);
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
    if (st == CW_OK && mesh->triangle_count && args->looks)
        st = compare_looks(s, err);
    return st;
}
