/* Runs the cases of the benchmark: opens each case, times its rows alternately, and measures
 * the meshes that they made. */
#define _GNU_SOURCE /* getloadavg */
#include "cli/bench/bench.h"
#include "cli/inputs/level_choice.h"

#include "cli/framework/console.h"
#include "cli/framework/temp_folder.h"
#include "cli/inputs/extract_surface.h"
#include "cli/inputs/synthetic_input.h"
#include "cli/study/triangle_sample.h"
#include "core/base/memory.h"
#include "core/base/status.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

const char *const cli_bench_status_names[] = {"done", "left-out", "missing", "failed"};

/* --- what is measured of a result --------------------------------------------------------- */

enum { MAX_VERTICES = 100000 }; /* of larger meshes, only every n-th vertex */

/* Of a file the truth is the field between its voxels. */
static cw_status measure_by_field(const cli_bench *b, const cw_mesh *mesh, cli_bench_row *row,
                                  cw_error *err)
{
    const cw_field_distance_desc desc = {
        .isovalue = b->now->iso,
        .inside_is_low = b->now->inside_is_low,
        .leave_open = true,
        .threads = b->threads,
        .progress = cli_progress((double)mesh->vertex_count / 1e6, "Mvertex")};
    cw_field_vertex_error *at = &row->at_vertices;
    float *mm = cwi_alloc_array(mesh->vertex_count, sizeof *mm);
    cw_distance d;
    if (!mm)
        return cwi_fail(err, CW_ERR_NO_MEMORY, "no memory for the errors of vertices");
    cw_status st = cw_distance_to_field(mesh, &b->volume.view, &desc, &d, mm, err);
    for (size_t v = 0; v < mesh->vertex_count && st == CW_OK; v++) {
        const double off = fabs((double)mm[v]);
        at->count++;
        at->mean_mm += (off - at->mean_mm) / (double)at->count;
        at->max_mm = fmax(at->max_mm, off);
    }
    if (st == CW_OK)
        row->surface = (cli_gap){true, d.max_mm, d.rms_mm, d.p99_mm};
    cwi_free(mm);
    return st;
}

static cw_status measure_truth(const cli_bench *b, const cw_mesh *mesh, cli_bench_row *row,
                               cw_error *err)
{
    const cli_bench_case *c = b->now;
    const size_t one_of = mesh->vertex_count / MAX_VERTICES + 1;
    cli_sample sample;
    cw_status st = cli_take_sample(mesh, CLI_STUDY_SAMPLE, c->voxel_mm, &sample, err);
    if (st == CW_OK && c->path) {
        st = measure_by_field(b, cli_sampled(&sample, mesh), row, err);
    } else if (st == CW_OK) {
        cw_field_error e;
        st = cw_field_measure_vertices(c->field, c->iso, c->voxel_mm, mesh, one_of,
                                       &row->at_vertices, err);
        if (st == CW_OK)
            st = cw_field_measure(c->field, c->iso, c->voxel_mm, cli_sampled(&sample, mesh), &e,
                                  err);
        if (st == CW_OK)
            row->surface = (cli_gap){e.samples > 0, e.max_mm, e.rms_mm, e.p99_mm};
    }
    cli_free_sample(&sample);
    return st;
}

static cw_status measure_move(const cli_bench *b, const cw_mesh *mesh, cli_bench_row *row,
                              cw_error *err)
{
    const cw_mesh_distance_desc desc = {
        .vertices_only = true,
        .threads = b->threads,
        .progress = cli_progress((double)mesh->vertex_count / 1e6, "Mvertex")};
    cw_distance d;
    cw_status st = cw_distance_to_mesh(mesh, &b->surface, &desc, &d, NULL, err);
    row->moved = st == CW_OK;
    row->moved_mean_mm = d.mean_mm;
    row->moved_max_mm = d.max_mm;
    return st;
}

static cw_status measure_row(const cli_bench *b, const cw_mesh *mesh, cli_bench_row *row,
                             cw_error *err)
{
    const cw_quality_desc desc = {.threads = b->threads};
    cw_quality q;
    cw_status st = cw_quality_measure(mesh, &desc, &q, err);
    if (st != CW_OK)
        return st;
    row->vertices = mesh->vertex_count;
    row->triangles = mesh->triangle_count;
    row->worked_on = row->work == CLI_BENCH_SIMPLIFICATION ? b->surface.triangle_count
                                                           : mesh->triangle_count;
    row->open_edges = q.open_edges;
    row->nonmanifold_edges = q.nonmanifold_edges;
    row->nonmanifold_vertices = q.nonmanifold_vertices;
    row->zero_area = q.degenerate;
    st = measure_truth(b, mesh, row, err);
    if (st == CW_OK && row->work == CLI_BENCH_COMPRESSION)
        st = measure_move(b, mesh, row, err);
    return st;
}

/* --- the runs ----------------------------------------------------------------------------- */

/* Records the failure of a row, so that the other rows go on; a cancelled run is passed on. The
 * reason is stored without the name of the scratch folder, which is soon deleted. */
static cw_status pass_over(const cli_bench *b, cli_bench_row *row, cw_status st,
                           const cw_error *err)
{
    const size_t folder = strlen(b->folder);
    const bool named = strncmp(err->message, b->folder, folder) == 0;
    if (st == CW_OK || st == CW_ERR_CANCELLED)
        return st;
    row->status =
        !row->is_peer && st == CW_ERR_UNSUPPORTED ? CLI_BENCH_LEFT_OUT : CLI_BENCH_FAILED;
    row->at_vertices = (cw_field_vertex_error){0};
    row->surface = (cli_gap){0};
    row->moved = false;
    snprintf(row->why, sizeof row->why, "%s", err->message + (named ? folder + 1 : 0));
    return CW_OK;
}

/* Not counted: with it memory and libraries are at hand, and its result is what is measured. */
static cw_status first_run(cli_bench *b, cli_bench_row *row, cw_error *err)
{
    cw_mesh mesh = {0};
    cli_spent spent;
    cw_status st = cli_bench_prepare(b, row->kind, err);
    if (st == CW_OK)
        st = cli_bench_once(b, row->kind, &spent, err);
    if (st == CW_OK)
        st = cli_bench_take(b, row->kind, &mesh, &row->file_bytes, err);
    if (st == CW_OK)
        st = measure_row(b, &mesh, row, err);
    if (st == CW_OK && !b->surface.vertex_count) {
        b->surface = mesh;
        return CW_OK;
    }
    cw_mesh_free(&mesh);
    return st;
}

static cw_status timed_run(cli_bench *b, cli_bench_row *row, cw_error *err)
{
    cli_spent spent;
    cw_status st = cli_bench_once(b, row->kind, &spent, err);
    if (st != CW_OK)
        return st;
    row->times[row->runs++] = spent.seconds;
    row->peak_bytes = spent.peak_bytes > row->peak_bytes ? spent.peak_bytes : row->peak_bytes;
    return CW_OK;
}

static int by_value(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double find_median(const double *times, size_t count)
{
    double sorted[CLI_BENCH_MAX_RUNS];
    memcpy(sorted, times, count * sizeof *times);
    qsort(sorted, count, sizeof *sorted, by_value);
    return count % 2 ? sorted[count / 2] : 0.5 * (sorted[count / 2 - 1] + sorted[count / 2]);
}

/* Runs the rows alternately, so that other load of the machine affects all of them equally. */
static cw_status run_work(cli_bench *b, cli_bench_work work, cw_error *err)
{
    cli_bench_case *c = b->now;
    for (size_t turn = 0; turn <= b->repeat; turn++)
        for (size_t n = 0; n < c->row_count; n++) {
            cli_bench_row *row = &c->rows[n];
            if (row->work != work || row->status != CLI_BENCH_DONE)
                continue;
            cli_say_v("%s: %s, %s", c->name, row->who, row->setting);
            cw_status st = turn ? timed_run(b, row, err) : first_run(b, row, err);
            if (n > 0) /* without the first there is nothing to go on with */
                st = pass_over(b, row, st, err);
            if (st != CW_OK)
                return st;
        }
    cw_mesh_free(&b->made);
    return CW_OK;
}

static const cli_bench_row *row_of(const cli_bench_case *c, cli_bench_work work,
                                   const char *setting)
{
    for (size_t n = 0; n < c->row_count; n++)
        if (c->rows[n].work == work && strcmp(c->rows[n].setting, setting) == 0)
            return &c->rows[n];
    return NULL;
}

static void compare_with_peers(cli_bench_case *c)
{
    for (size_t n = 0; n < c->row_count; n++)
        if (c->rows[n].status == CLI_BENCH_DONE)
            c->rows[n].seconds = find_median(c->rows[n].times, c->rows[n].runs);
    for (size_t n = 0; n < c->row_count; n++) {
        cli_bench_row *row = &c->rows[n];
        const cli_bench_row *ours = row->against ? row_of(c, row->work, row->against) : NULL;
        if (ours && ours->status == CLI_BENCH_DONE && row->status == CLI_BENCH_DONE)
            row->ratio = row->seconds / ours->seconds;
    }
}

/* --- the cases ---------------------------------------------------------------------------- */

static cw_status open_file(cli_bench *b, cw_error *err)
{
    cli_bench_case *c = b->now;
    cw_status st = cli_read_volume(c->path, b->input, false, &b->volume, err);
    if (st != CW_OK)
        return st;
    c->inside_is_low = cli_inside_is_low(b->inside, &b->volume.whole);
    if (!b->iso.given)
        return cli_find_level(&b->volume, b->input, &c->iso, &c->level, err);
    cli_number iso = b->iso; /* a name is another number for each file */
    st = cli_choose_level(&b->volume, b->input, &iso, err);
    c->level = "as asked for";
    c->iso = iso.value;
    return st;
}

static cw_status open_case(cli_bench *b, cw_error *err)
{
    cli_bench_case *c = b->now;
    cw_status st = c->path ? open_file(b, err)
                           : cli_make_field(c->field, c->dim, b->input, &b->volume, err);
    if (st != CW_OK)
        return st;
    if (!c->path) {
        b->volume.path = c->name;
        c->iso = cw_field_isovalue(c->field);
        c->level = "the field's own";
    }
    const double *mm = b->volume.spacing;
    c->voxel_mm = cbrt(mm[0] * mm[1] * mm[2]);
    c->type = b->volume.view.type;
    memcpy(c->dim, b->volume.view.dim, sizeof c->dim);
    return b->with_peers ? cli_peers_put_volume(&b->peers, &b->volume.view, err) : CW_OK;
}

static cw_status run_case(cli_bench *b, cw_error *err)
{
    cw_status st = open_case(b, err);
    cli_bench_plan(b, b->now);
    for (int work = 0; work < CLI_BENCH_WORKS && st == CW_OK; work++) {
        if (work == CLI_BENCH_SIMPLIFICATION && b->with_peers)
            st = cli_peers_put_mesh(&b->peers, &b->surface, err);
        if (st == CW_OK)
            st = run_work(b, (cli_bench_work)work, err);
    }
    if (st == CW_OK)
        compare_with_peers(b->now);
    cw_mesh_free(&b->made);
    cw_mesh_free(&b->surface);
    cli_free_volume(&b->volume);
    return st;
}

cw_status cli_bench_run(cli_bench *b, cw_error *err)
{
    cw_status st = cli_scratch_make(&b->folder, err);
    if (getloadavg(&b->load, 1) != 1)
        b->load = NAN;
    if (st == CW_OK && b->with_peers)
        st = cli_peers_start(&b->peers, b->folder, b->threads, b->limit_s, err);
    if (st == CW_OK)
        cli_bench_tell_start(b);
    for (size_t n = 0; n < b->case_count && st == CW_OK; n++) {
        b->now = &b->cases[n];
        st = run_case(b, err);
        if (st == CW_OK)
            cli_bench_tell(b->now);
    }
    return st;
}

void cli_bench_free(cli_bench *b)
{
    cli_peers_stop(&b->peers);
    cli_scratch_remove(b->folder);
    free(b->cases);
}
