/* Holds a mesh against a volume: finds the level that fits, measures both ways, checks,
 * draws. */
#include "cli/study/mesh_study.h"

#include "cli/framework/console.h"
#include "cli/framework/quantity.h"
#include "cli/framework/run_config.h"
#include "cli/framework/temp_folder.h"
#include "cli/inputs/extract_surface.h"
#include "cli/inputs/level_choice.h"
#include "cli/looks/looks_facts.h"
#include "cli/results/check_verdicts.h"
#include "cli/results/mesh_comparison.h"
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/base/text.h"
#include "core/mesh/mesh_triangle.h"
#include "core/volume/named_level.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* Vertices whose values are looked at to fit a level. */
enum { FIT_VERTICES = 50000 };
/* Pixels along each side of pictures of looks. */
enum { LOOKS_PIXELS = 512 };
/* Values at the vertices of an extracted surface differ by rounding, less than this fraction of the
 * range of all values. */
static const double SURE_FRACTION = 1e-3;

static int compare_values(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* The field at every n-th vertex; those outside of the volume have no value. */
static size_t sample_field(const cli_mesh_study *m, size_t every, double *values)
{
    const cw_mesh *mesh = &m->study.full;
    size_t count = 0;
    for (size_t v = 0; v < mesh->vertex_count; v += every) {
        double world[3];
        cwi_mesh_world(mesh, v, world);
        values[count] = cw_volume_sample(&m->study.volume->view, world);
        count += isfinite(values[count]);
    }
    return count;
}

/* Says when the vertices are at various values, as filters of voxels or of the mesh leave them. */
static cw_status judge_fit(cli_mesh_study *m, cw_error *err)
{
    cw_statistics s;
    cw_status st = cw_volume_statistics(&m->study.volume->view, 0, m->study.threads, &s, err);
    if (st != CW_OK)
        return cwi_fail_in(err, st, m->study.volume->path);
    m->is_unsure = m->fit_high - m->fit_low > SURE_FRACTION * (s.max - s.min);
    if (m->is_unsure)
        cli_say(
            "%s: the level %s is unsure: half of the vertices have values from %.6g to %.6g. "
            "A mesh of filtered voxels needs the filters here, too (--denoise, --resample); "
            "--iso V states the level of a smoothed or simplified one",
            m->mesh.path, cli_number_text(m->study.iso), m->fit_low, m->fit_high);
    return CW_OK;
}

cw_status cli_fit_level(cli_mesh_study *m, cw_error *err)
{
    const size_t vertices = m->study.full.vertex_count, every = vertices / FIT_VERTICES + 1,
                 looked_at = (vertices + every - 1) / every;
    double *values = cwi_alloc_array(looked_at + 1, sizeof *values);
    if (!values)
        return cwi_fail_memory(err);
    const size_t count = sample_field(m, every, values);
    m->fit_count = looked_at;
    m->fit_outside = looked_at - count;
    if (count > 0 && 2 * count >= looked_at) {
        qsort(values, count, sizeof *values, compare_values);
        m->is_fitted = true;
        m->fit_low = values[count / 4];
        m->fit_high = values[count - 1 - count / 4];
        m->study.iso = cwi_round_level(values[count / 2]);
        m->study.level = "fitted to the vertices";
    }
    cwi_free(values);
    return m->is_fitted
               ? judge_fit(m, err)
               : cwi_fail(
                     err, CW_ERR_ARGUMENT,
                     "%s: no level can be fitted: of %zu vertices that were looked at only "
                     "%zu are in %s",
                     m->mesh.path, looked_at, count, m->study.volume->path);
}

static cw_progress progress_of(const cw_mesh *mesh)
{
    return cli_progress((double)mesh->triangle_count / 1e6, "Mtriangle");
}

static cw_status measure_quality(cli_mesh_study *m, cw_error *err)
{
    const cw_mesh *mesh = &m->study.full;
    const cw_quality_desc desc = {.weld = CW_WELD_LOCAL,
                                  .shells = true,
                                  .threads = m->study.threads,
                                  .progress = progress_of(mesh)};
    cli_say_v("check");
    cw_status st = cw_quality_measure(mesh, &desc, &m->quality, err);
    m->findings.quality = &m->quality;
    m->findings.has_normals = mesh->normals;
    m->study.points[0].shapes = m->quality.shapes;
    m->is_open = m->quality.open_edges > 0;
    return st;
}

static cw_status measure_to_field(cli_mesh_study *m, float *worst, cw_error *err)
{
    cli_point *p = &m->study.points[0];
    const cw_mesh *mesh = &m->study.full;
    const cw_field_distance_desc desc = {.isovalue = m->study.iso,
                                         .inside_is_low = m->study.inside_is_low,
                                         .leave_open = m->is_open,
                                         .worst = worst,
                                         .threads = m->study.threads,
                                         .progress = progress_of(mesh)};
    cli_say_v("distance to the surface");
    cw_status st =
        cw_distance_to_field(mesh, &m->study.volume->view, &desc, &m->to_field, NULL, err);
    if (st == CW_ERR_UNSUPPORTED) /* it is the volume that is of no such kind */
        return cwi_fail_in(err, st, m->study.volume->path);
    p->to_field = (cli_gap){true, m->to_field.max_mm, m->to_field.rms_mm, m->to_field.p99_mm};
    m->findings.to_field = &m->to_field;
    return st;
}

/* Divides the colours at outlines by their opacity, as files have them. */
static void divide_by_opacity(cw_image *image)
{
    for (size_t n = 0; n < image->width * image->height; n++) {
        uint8_t *pixel = image->pixels + 4 * n;
        for (int c = 0; c < 3 && pixel[3]; c++) {
            const int full = (255 * pixel[c] + pixel[3] / 2) / pixel[3];
            pixel[c] = (uint8_t)(full < 255 ? full : 255);
        }
    }
}

static cw_status draw_looks(const cli_mesh_study *m, const cw_surface_look *surfaces,
                            size_t count, cli_png *png, cw_error *err)
{
    const cw_appearance_desc desc = {.size = LOOKS_PIXELS, .threads = m->study.threads};
    cw_image image = {0};
    cw_status st = cw_appearance_draw(surfaces, count, &m->looks.place[m->looks.worst].camera,
                                      &desc, &image, err);
    if (st == CW_OK) {
        divide_by_opacity(&image);
        st = cli_make_png(&m->study, &image, png, err);
    }
    cw_image_free(&image);
    return st;
}

static cw_status draw_worst_view(cli_mesh_study *m, const cw_surface_look *reference,
                                 cli_looks *looks, cw_error *err)
{
    cw_status st = draw_looks(m, reference, 1, &m->drawn_source, err);
    if (st == CW_OK)
        st = draw_looks(m, looks->surfaces, looks->count, &m->drawn, err);
    if (st != CW_OK || !looks->has_maps)
        return st;
    for (size_t n = 0; n < looks->count; n++)
        looks->surfaces[n] = (cw_surface_look){.mesh = looks->surfaces[n].mesh};
    return draw_looks(m, looks->surfaces, looks->count, &m->drawn_bare, err);
}

/* Compares how the mesh and the surface of its volume look, and draws both from the worst view. */
static cw_status compare_looks(cli_mesh_study *m, const cw_mesh *surface, cw_error *err)
{
    const cw_surface_look reference = {.mesh = surface};
    const cw_appearance_desc desc = {.threads = m->study.threads,
                                     .progress = cli_progress(8, "view")};
    cli_looks looks = {0};
    cli_mesh whole = m->mesh; /* with the triangles, which the study has */
    whole.mesh = m->study.full;
    cli_say_v("looks");
    cw_status st = cli_looks_find(&whole, false, m->reader, m->input, &looks, err);
    if (st == CW_OK)
        st = cw_appearance_measure(&reference, 1, looks.surfaces, looks.count, &desc, &m->looks,
                                   &m->bare_looks, err);
    m->has_maps = looks.has_maps;
    if (st == CW_OK)
        st = draw_worst_view(m, &reference, &looks, err);
    cli_looks_free(&looks);
    return st;
}

/* From the vertices of the surface as we extract it, which shows what the mesh has not; and how both
 * look. */
static cw_status measure_from_field(cli_mesh_study *m, cw_error *err)
{
    cli_point *p = &m->study.points[0];
    const cw_extract_desc extract = {.isovalue = m->study.iso,
                                     .inside_is_low = m->study.inside_is_low,
                                     .leave_open = m->is_open,
                                     .threads = m->study.threads};
    cw_mesh surface = {0};
    cw_extract_counts counts;
    cli_say_v("distance from the surface");
    cw_status st = cli_extract_surface(m->study.volume, &extract, &surface, &counts, err);
    const cw_mesh_distance_desc back = {
        .vertices_only = true, .threads = m->study.threads, .progress = progress_of(&surface)};
    if (st == CW_OK)
        st = cw_distance_to_mesh(&surface, &m->study.full, &back, &m->from_field, NULL, err);
    if (st == CW_OK)
        st = compare_looks(m, &surface, err);
    cw_mesh_free(&surface);
    p->back = (cli_gap){true, m->from_field.max_mm, m->from_field.rms_mm, m->from_field.p99_mm};
    m->findings.from_field = &m->from_field;
    return st;
}

static cw_status draw_all(cli_mesh_study *m, const float *worst, cw_error *err)
{
    cli_study *s = &m->study;
    cli_point *p = &s->points[0];
    cw_status st = cli_study_overview(s, err);
    if (st == CW_OK)
        st = cli_draw_mesh(s, &s->full, &s->full, worst, &p->drawn, err);
    return st == CW_OK ? cli_pack_errors(s, &s->full, worst, &p->packed, err) : st;
}

static void prepare_study(cli_mesh_study *m)
{
    cli_study *s = &m->study;
    const double *mm = s->volume->spacing;
    struct stat facts;
    s->voxel_mm = cbrt(mm[0] * mm[1] * mm[2]);
    s->start = cli_seconds();
    s->deadline = INFINITY;
    cli_point *p = cli_add_point(s, CLI_EXTRACTION, 0, "mesh", "%s", "the mesh");
    p->done = p->shown = p->turned = true;
    p->number = 1;
    p->triangles = s->full.triangle_count;
    p->file_bytes = m->file_bytes = stat(m->mesh.path, &facts) == 0 ? (size_t)facts.st_size : 0;
}

cw_status cli_study_mesh(cli_mesh_study *m, cw_error *err)
{
    cli_study *s = &m->study;
    prepare_study(m);
    if (!s->full.triangle_count)
        return cwi_fail(err, CW_ERR_EMPTY, "%s: the mesh has no triangles", m->mesh.path);
    float *worst = cwi_alloc_zeroed(s->full.vertex_count, sizeof *worst);
    cw_status st = worst ? cli_check_overlap(s->volume, &s->full, err) : cwi_fail_memory(err);
    if (st == CW_OK)
        st = cli_scratch_make(&s->folder, err);
    if (st == CW_OK)
        st = measure_quality(m, err);
    if (st == CW_OK)
        st = measure_to_field(m, worst, err);
    if (st == CW_OK)
        st = measure_from_field(m, err);
    if (st == CW_OK)
        st = draw_all(m, worst, err);
    if (st == CW_OK)
        m->verdict_count = cw_check_judge(&m->findings, CW_PROFILE_BASIC, m->verdicts);
    cwi_free(worst);
    s->seconds = cli_seconds() - s->start;
    return st;
}

void cli_free_mesh_study(cli_mesh_study *m)
{
    cli_study_free(&m->study);
    cli_free_mesh(&m->mesh);
    free(m->drawn_source.bytes);
    free(m->drawn.bytes);
    free(m->drawn_bare.bytes);
}

char *cli_check_command(const cli_mesh_study *m)
{
    char *text;
    size_t size;
    FILE *out = cwi_text_open(&text, &size);
    if (out) {
        fputs("cubewright check ", out);
        cli_put_word(out, m->mesh.path);
        fprintf(out, " --source %s --iso %s", m->study.input_words,
                cli_number_text(m->study.iso));
        if (m->study.inside_is_low)
            fputs(" --inside below", out);
        if (m->is_open)
            fputs(" --open", out);
    }
    return cwi_text_close(out, &text) ? text : NULL;
}

static void json_fit(cli_json *j, const cli_mesh_study *m)
{
    cli_json_open(j, "fit", '{');
    cli_json_count(j, "vertices", m->fit_count);
    cli_json_count(j, "outside", m->fit_outside);
    cli_json_number(j, "quarter_below", m->fit_low);
    cli_json_number(j, "quarter_above", m->fit_high);
    cli_json_bool(j, "unsure", m->is_unsure);
    cli_json_close(j, '}');
}

void cli_put_mesh_json(FILE *out, const void *study)
{
    const cli_mesh_study *m = study;
    cli_json j = {.out = out};
    char *command = cli_check_command(m);
    cli_json_begin(&j, "cubewright-provenance-1");
    cli_json_mesh_file(&j, "input", &m->mesh);
    cli_json_count(&j, "file_bytes", m->file_bytes);
    cli_json_input(&j, "source", m->study.volume);
    cli_json_number(&j, "iso", m->study.iso);
    cli_json_text(&j, "level", m->study.level);
    if (m->is_fitted)
        json_fit(&j, m);
    cli_json_text(&j, "inside", m->study.inside_is_low ? "below" : "above");
    cli_json_count(&j, "vertices", m->study.full.vertex_count);
    cli_json_count(&j, "triangles", m->study.full.triangle_count);
    cli_json_bool(&j, "open", m->is_open);
    cli_json_bool(&j, "closed", cw_quality_is_closed_manifold(&m->quality));
    cli_json_number(&j, "area_mm2", m->quality.area_mm2);
    if (cw_quality_is_closed_manifold(&m->quality))
        cli_json_number(&j, "volume_mm3", m->quality.volume_mm3);
    cli_json_numbers(&j, "min_mm", m->quality.min, 3);
    cli_json_numbers(&j, "max_mm", m->quality.max, 3);
    cli_json_number(&j, "voxel_mm", m->study.voxel_mm);
    cli_json_verdicts(&j, m->verdicts, m->verdict_count);
    cli_json_errors(&j, &m->findings);
    cli_looks_json(&j, &m->looks, m->has_maps ? &m->bare_looks : NULL);
    cli_json_shapes(&j, &m->quality.shapes);
    cli_json_text(&j, "command", command ? command : "");
    cli_json_number(&j, "seconds", m->study.seconds);
    cli_json_close(&j, '}');
    free(command);
}
