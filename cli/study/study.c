/* Runs a study: tries its settings by rank until the budget is spent, and marks the Pareto
 * front of each family. */
#include "cli/study/study.h"

#include "cli/framework/console.h"
#include "cli/framework/field_names.h"
#include "cli/framework/temp_folder.h"
#include "cli/study/point_command.h"
#include "core/base/memory.h"
#include "core/base/status.h"

#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

const char *const cli_family_names[CLI_FAMILY_COUNT] = {
    "extraction", "simplification", "compression", "rendering", "shading", "projections"};

/* The plain surface is not held to the budget: without it there is nothing to tell. Work for the
 * page alone is, even that on the plain surface. */
static bool keep_going(void *user, const char *step, double done)
{
    const cli_study *s = user;
    (void)step;
    (void)done;
    if (s->extra_deadline > 0 && cli_seconds() >= s->extra_deadline)
        return false;
    return !s->points[0].done || !cli_time_is_up(s);
}

static cw_status try_point(cli_study *s, cli_point *p, cw_error *err)
{
    switch (p->family) {
    case CLI_EXTRACTION:
        return cli_try_extraction(s, p, err);
    case CLI_SIMPLIFICATION:
        return cli_try_simplification(s, p, err);
    case CLI_COMPRESSION:
        return cli_try_compression(s, p, err);
    default:
        return cli_try_rendering(s, p, err);
    }
}

static void free_pictures(cli_point *p)
{
    free(p->drawn.bytes);
    free(p->difference.bytes);
    p->drawn = p->difference = (cli_png){0};
    cli_free_packed(&p->packed);
}

static void leave_out(cli_point *p, const char *why)
{
    snprintf(p->why, sizeof p->why, "%s", why);
    p->to_field = p->back = p->truth = (cli_gap){0};
    p->seconds = 0;
    p->peak_bytes = p->triangles = p->file_bytes = 0;
    p->runs = 0;
    free_pictures(p);
}

/* Tries one setting. A failure is stored in its point, and the others go on. */
static cw_status run_point(cli_study *s, cli_point *p, cw_error *err)
{
    cw_error why = {0};
    const bool first = !s->points[0].done;
    if (!first && cli_time_is_up(s)) {
        leave_out(p, "the budget was spent before it was tried");
        return CW_OK;
    }
    cli_say_v("%s: %s", cli_family_names[p->family], p->name);
    cw_status st = try_point(s, p, &why);
    p->done = st == CW_OK;
    if (st == CW_OK)
        return CW_OK;
    if (first || cli_interrupted()) {
        *err = why;
        return st;
    }
    leave_out(p, st == CW_ERR_CANCELLED
                     ? "it was still running when the budget was spent"
                     : cli_name_options(why.message, (char[CLI_MESSAGE]){0}));
    return CW_OK;
}

static cw_status run_points(cli_study *s, cw_error *err)
{
    cw_status st = CW_OK;
    int last = 0;
    for (size_t n = 0; n < s->point_count; n++)
        last = s->points[n].rank > last ? s->points[n].rank : last;
    for (int rank = 0; rank <= last && st == CW_OK; rank++) {
        for (size_t n = 0; n < s->point_count && st == CW_OK; n++)
            if (s->points[n].rank == rank && !*s->points[n].why)
                st = run_point(s, &s->points[n], err);
        if (rank == 0 && st == CW_OK) /* of the plain surface, which is there now */
            st = cli_study_overview(s, err);
    }
    return st;
}

static cw_status tell_commands(cli_study *s, cw_error *err)
{
    for (size_t n = 0; n < s->point_count; n++) {
        s->points[n].command = cli_point_command(s, &s->points[n]);
        if (!s->points[n].command)
            return cwi_fail_memory(err);
    }
    return CW_OK;
}

double cli_point_cost(const cli_point *p)
{
    switch (p->family) {
    case CLI_SIMPLIFICATION:
        return (double)p->triangles;
    case CLI_COMPRESSION:
        return (double)p->file_bytes;
    case CLI_RENDERING:
    case CLI_SHADING:
    case CLI_PROJECTIONS:
        return 1e3 * p->seconds;
    default:
        return p->seconds;
    }
}

const cli_gap *cli_main_gap(const cli_study *s, const cli_point *p)
{
    if (s->is_field && p->truth.known)
        return &p->truth;
    if (p->to_field.known)
        return &p->to_field;
    return p->back.known ? &p->back : NULL;
}

double cli_point_error(const cli_study *s, const cli_point *p)
{
    if (!p->done)
        return NAN;
    if (cli_is_drawn(p->family))
        return p->picture.pixels ? p->picture.rmse : NAN;
    if (p->family == CLI_COMPRESSION) /* its own: beside that of the surface it is lost */
        return p->back.known ? p->back.rms_mm : NAN;
    const cli_gap *gap = cli_main_gap(s, p);
    return gap ? gap->rms_mm : NAN;
}

cli_axis cli_study_axis(const cli_study *s, cli_family family)
{
    static const cli_axis axes[CLI_FAMILY_COUNT] = {
        {"time", "s", NULL, "mm"},
        {"triangles", "", NULL, "mm"},
        {"size of the file", "bytes", "RMS distance from the plain surface", "mm"},
        {"time of a picture", "ms", "RMSE of the picture", "of 255"},
        {"time of a picture", "ms", "RMSE of the lit picture", "of 255"},
        {"time of a picture", "ms", "RMSE of the projection", "of 255"}};
    cli_axis axis = axes[family];
    if (!axis.error)
        axis.error = s->is_field                   ? "RMS distance to the true surface"
                     : s->points[0].to_field.known ? "RMS distance to the field's surface"
                                                   : "RMS distance from the plain surface";
    return axis;
}

/* Projections have a front for each mode: their pictures are different ones. */
static void mark_front(cli_study *s, cli_family family, size_t reference)
{
    double cost[CLI_MAX_POINTS], error[CLI_MAX_POINTS];
    bool front[CLI_MAX_POINTS];
    for (size_t n = 0; n < s->point_count; n++) {
        const cli_point *p = &s->points[n];
        const bool counts =
            p->family == family && p->tried.reference == reference && p->done && !p->aside;
        cost[n] = counts ? cli_point_cost(p) : NAN;
        error[n] = counts ? cli_point_error(s, p) : NAN;
    }
    cli_pareto(cost, error, s->point_count, front);
    for (size_t n = 0; n < s->point_count; n++)
        s->points[n].front |= front[n];
}

/* The least cost first; of equal ones the first that was tried. */
static int compare_costs(const void *a, const void *b)
{
    const cli_point *x = *(const cli_point *const *)a, *y = *(const cli_point *const *)b;
    const double left = cli_point_cost(x), right = cli_point_cost(y);
    return left != right ? (left > right) - (left < right) : (x > y) - (x < y);
}

static void number_points(cli_study *s, cli_family family)
{
    cli_point *sorted[CLI_MAX_POINTS];
    size_t count = 0;
    for (size_t n = 0; n < s->point_count; n++)
        if (s->points[n].family == family && s->points[n].done)
            sorted[count++] = &s->points[n];
    qsort(sorted, count, sizeof *sorted, compare_costs);
    for (size_t n = 0; n < count; n++)
        sorted[n]->number = n + 1;
}

size_t cli_points_of(const cli_study *s, cli_family family,
                     const cli_point *points[CLI_MAX_POINTS])
{
    size_t count = 0;
    for (size_t n = 0; n < s->point_count; n++) {
        const cli_point *p = &s->points[n];
        if (p->family != family || !p->number)
            continue;
        points[p->number - 1] = p;
        count++;
    }
    return count;
}

cli_cost cli_main_cost(cli_family family)
{
    return family == CLI_SIMPLIFICATION ? CLI_COST_TRIANGLES
           : family == CLI_COMPRESSION  ? CLI_COST_BYTES
                                        : CLI_COST_TIME;
}

double cli_cost_of(const cli_point *p, cli_cost cost)
{
    const bool mesh = !cli_is_drawn(p->family);
    switch (cost) {
    case CLI_COST_TIME:
        return mesh ? p->seconds : 1e3 * p->seconds;
    case CLI_COST_TRIANGLES:
        return mesh ? (double)p->triangles : NAN;
    case CLI_COST_BYTES:
        return mesh ? (double)p->file_bytes : NAN;
    default:
        return p->peak_bytes ? (double)p->peak_bytes : NAN;
    }
}

static void plan_points(cli_study *s)
{
    const cw_format *glb = cw_mesh_format("mesh.glb", NULL);
    const double *mm = s->volume->spacing;
    s->suffix = glb && glb->in_this_build ? ".glb" : ".stl";
    s->voxel_mm = cbrt(mm[0] * mm[1] * mm[2]);
    cli_plan_extraction(s);
    cli_plan_simplification(s);
    cli_plan_compression(s);
    cli_plan_rendering(s);
}

cw_status cli_study_run(cli_study *s, cw_error *err)
{
    const cli_listener listener = {.user = s, .progress = keep_going};
    plan_points(s);
    s->start = cli_seconds();
    s->deadline = s->start + s->budget_s;
    cw_status st = cli_scratch_make(&s->folder, err);
    cli_console_listen(&listener);
    if (st == CW_OK)
        st = run_points(s, err);
    if (st == CW_OK)
        st = cli_study_print(s, err);
    if (st == CW_OK)
        st = cli_time_again(s, err);
    cli_console_listen(NULL);
    if (st == CW_OK)
        st = tell_commands(s, err);
    for (int f = 0; f < CLI_FAMILY_COUNT && st == CW_OK; f++) {
        for (size_t n = 0; n < CLI_REFERENCES; n++)
            mark_front(s, (cli_family)f, n);
        number_points(s, (cli_family)f);
    }
    s->seconds = cli_seconds() - s->start;
    return st;
}

void cli_study_free(cli_study *s)
{
    for (size_t n = 0; n < s->point_count; n++) {
        free(s->points[n].command);
        free_pictures(&s->points[n]);
    }
    for (size_t n = 0; n < CLI_REFERENCES; n++) {
        free(s->references[n].drawn.bytes);
        cw_picture_free(&s->references[n].picture);
    }
    free(s->part_drawn.bytes);
    free(s->overview.object.bytes);
    free(s->overview.slice.bytes);
    cw_statistics_free(&s->overview.values);
    cw_renderer_free(s->renderer);
    cw_renderer_free(s->cpu);
    cw_mesh_free(&s->part_mesh);
    cw_mesh_free(&s->full);
    cli_scratch_remove(s->folder);
}
