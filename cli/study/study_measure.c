/* Measures a mesh: its distance from the truth, and the size of its file. */
#include "cli/framework/console.h"
#include "cli/study/study.h"
#include "cli/study/triangle_sample.h"
#include "core/base/memory.h"
#include "core/base/status.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static cli_gap gap_of(const cw_distance *d)
{
    return (cli_gap){d->triangles > 0 || d->samples > 0, d->max_mm, d->rms_mm, d->p99_mm};
}

static cw_progress progress_of(const cw_mesh *mesh)
{
    return cli_progress((double)mesh->triangle_count / 1e6, "Mtriangle");
}

/* Extraction is of all there is, the rest of a part. */
static const cli_volume *volume_of(const cli_study *s, const cli_point *p)
{
    return p->family == CLI_EXTRACTION ? s->volume : &s->part;
}

static const cw_mesh *plain_of(const cli_study *s, const cli_point *p)
{
    return p->family == CLI_EXTRACTION ? &s->full : cli_part_mesh(s);
}

/* Grids whose field the library measures no distance to have none. */
static cw_status measure_field(cli_study *s, cli_point *p, const cw_mesh *mesh, float *worst,
                               cw_error *err)
{
    const cw_field_distance_desc desc = {.isovalue = s->iso,
                                         .inside_is_low = s->inside_is_low,
                                         .leave_open = s->is_field,
                                         .worst = worst,
                                         .threads = s->threads,
                                         .progress = progress_of(mesh)};
    cw_distance d;
    cw_status st = cw_distance_to_field(mesh, &volume_of(s, p)->view, &desc, &d, NULL, err);
    if (st == CW_OK)
        p->to_field = gap_of(&d);
    return st == CW_ERR_UNSUPPORTED ? CW_OK : st;
}

/* From the vertices of the plain surface, so that what a mesh has lost is seen, too. */
static cw_status measure_back(cli_study *s, cli_point *p, const cw_mesh *mesh, cw_error *err)
{
    const cw_mesh_distance_desc desc = {
        .vertices_only = true, .threads = s->threads, .progress = progress_of(mesh)};
    cw_distance d;
    cli_sample full;
    const cw_mesh *plain = plain_of(s, p);
    if (mesh == plain)
        return CW_OK;
    cw_status st = cli_take_sample(plain, CLI_STUDY_SAMPLE, s->voxel_mm, &full, err);
    if (st == CW_OK)
        st = cw_distance_to_mesh(cli_sampled(&full, plain), mesh, &desc, &d, NULL, err);
    if (st == CW_OK)
        p->back = gap_of(&d);
    cli_free_sample(&full);
    return st;
}

cw_status cli_weigh_mesh(cli_study *s, const cw_mesh *mesh, const cw_write_desc *desc,
                         size_t *bytes, const char **path, cw_error *err)
{
    static char name[4096];
    struct stat facts;
    snprintf(name, sizeof name, "%s/mesh%s", s->folder, s->suffix);
    cw_status st = cw_mesh_write(name, mesh, desc, err);
    *bytes = st == CW_OK && stat(name, &facts) == 0 ? (size_t)facts.st_size : 0;
    if (path)
        *path = name;
    else
        remove(name);
    return st;
}

static cw_status show_errors(cli_study *s, cli_point *p, const cw_mesh *mesh,
                             const float *worst, cw_error *err)
{
    const cw_quality_desc desc = {.threads = s->threads};
    cw_quality quality;
    cw_status st = cw_quality_measure(mesh, &desc, &quality, err);
    if (st != CW_OK)
        return st;
    p->shapes = quality.shapes;
    const float *mm = p->to_field.known ? worst : NULL;
    if (mm)
        st = cli_draw_mesh(s, plain_of(s, p), mesh, mm, &p->drawn, err);
    if (st == CW_OK && p->turned)
        st = cli_pack_errors(s, mesh, mm, &p->packed, err);
    return st;
}

static void find_middles(const cw_mesh *mesh, float *middles)
{
    for (size_t t = 0; t < mesh->triangle_count; t++)
        for (size_t a = 0; a < 3; a++) {
            const uint32_t *c = mesh->triangles + 3 * t;
            middles[3 * t + a] =
                (mesh->positions[3 * (size_t)c[0] + a] + mesh->positions[3 * (size_t)c[1] + a] +
                 mesh->positions[3 * (size_t)c[2] + a]) /
                3;
        }
}

/* For pictures of large meshes: one point a triangle, and for vertices the worst around. */
static cw_status measure_middles(cli_study *s, cli_point *p, const cw_mesh *mesh, float *worst,
                                 cw_error *err)
{
    const size_t count = mesh->triangle_count;
    const cw_field_distance_desc desc = {.isovalue = s->iso,
                                         .inside_is_low = s->inside_is_low,
                                         .leave_open = s->is_field,
                                         .threads = s->threads,
                                         .progress = progress_of(mesh)};
    cw_mesh points = {.vertex_count = count,
                      .positions = cwi_alloc_array(count, 3 * sizeof(float))};
    float *mm = cwi_alloc_array(count, sizeof *mm);
    cw_distance d;
    cw_status st = CW_ERR_NO_MEMORY;
    memcpy(points.origin, mesh->origin, sizeof points.origin);
    if (points.positions && mm) {
        find_middles(mesh, points.positions);
        st = cw_distance_to_field(&points, &volume_of(s, p)->view, &desc, &d, mm, err);
    } else {
        cwi_fail(err, st, "no memory for the errors of triangles");
    }
    for (size_t n = 0; n < 3 * count && st == CW_OK; n++) {
        float *at = &worst[mesh->triangles[n]];
        *at = fmaxf(*at, fabsf(mm[n / 3]));
    }
    cw_mesh_free(&points);
    cwi_free(mm);
    return st == CW_ERR_UNSUPPORTED ? CW_OK : st;
}

/* The errors of a sample, or of all. */
static cw_status measure_sample(cli_study *s, cli_point *p, const cw_mesh *mesh,
                                const cli_sample *sample, float *worst, cw_error *err)
{
    const cw_mesh *measured = cli_sampled(sample, mesh);
    cw_status st = measure_field(s, p, measured, measured == mesh ? worst : NULL, err);
    if (st == CW_OK && s->is_field) {
        cw_field_error e;
        st = cw_field_measure(s->field, s->iso, s->voxel_mm, measured, &e, err);
        p->truth = (cli_gap){e.samples > 0, e.max_mm, e.rms_mm, e.p99_mm};
    }
    return st == CW_OK && worst && measured != mesh ? measure_middles(s, p, mesh, worst, err)
                                                    : st;
}

cw_status cli_measure_mesh(cli_study *s, cli_point *p, const cw_mesh *mesh, cw_error *err)
{
    float *worst = p->shown ? cwi_alloc_zeroed(mesh->vertex_count, sizeof *worst) : NULL;
    cli_sample sample = {0};
    cw_status st = CW_OK;
    if (p->shown && !worst)
        return cwi_fail_memory(err);
    p->triangles = mesh->triangle_count;
    if (!p->file_bytes)
        st = cli_weigh_mesh(s, mesh, NULL, &p->file_bytes, NULL, err);
    if (st == CW_OK)
        st = cli_take_sample(mesh, CLI_STUDY_SAMPLE, s->voxel_mm, &sample, err);
    p->measured_one_of = sample.one_of;
    if (st == CW_OK)
        st = measure_sample(s, p, mesh, &sample, worst, err);
    if (st == CW_OK)
        st = measure_back(s, p, mesh, err);
    if (st == CW_OK && p->shown)
        st = show_errors(s, p, mesh, worst, err);
    cli_free_sample(&sample);
    cwi_free(worst);
    return st;
}
