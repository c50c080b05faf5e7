/* Simplification while extracting: to an error, to a share of the triangles. */
#include "cli/framework/console.h"
#include "cli/inputs/extract_surface.h"
#include "cli/study/study.h"

void cli_plan_simplification(cli_study *s)
{
    static const struct {
        int rank;
        double error_vox, fraction;
        const char *name;
    } rows[] = {
        {1, 0.25, 0, "error 0.25 voxels"},
        {2, 0, 0.1, "10 % of the triangles"},
        {2, 1, 0, "error 1 voxel"},
        {3, 0.5, 0, "error 0.5 voxels"},
        {3, 0, 0.25, "25 % of the triangles"},
        {4, 0, 0.02, "2 % of the triangles"},
        {4, 0.1, 0, "error 0.1 voxels"},
        {5, 0, 0.5, "50 % of the triangles"},
    };
    for (size_t n = 0; n < sizeof rows / sizeof *rows; n++) {
        cli_point *p = cli_add_point(s, CLI_SIMPLIFICATION, rows[n].rank,
                                     rows[n].fraction > 0 ? "to a number" : "to an error", "%s",
                                     rows[n].name);
        p->tried.error_vox = rows[n].error_vox;
        p->tried.fraction = rows[n].fraction;
        p->shown = n < 3;
        p->turned = n < 2;
    }
}

size_t cli_share_of(const cw_mesh *mesh, double fraction)
{
    const size_t count = (size_t)(fraction * (double)mesh->triangle_count);
    return count ? count : 1;
}

cw_status cli_run_simplification(cli_study *s, cli_point *p, cw_mesh *mesh, cw_error *err)
{
    cw_status st = cli_need_part(s, err);
    const cw_simplify_desc simplify = {
        .error_mm = p->tried.error_vox * s->voxel_mm,
        .triangles =
            p->tried.fraction > 0 ? cli_share_of(cli_part_mesh(s), p->tried.fraction) : 0,
        .threads = s->threads};
    const cw_pipeline_desc pipeline = {.extract = {.isovalue = s->iso,
                                                   .inside_is_low = s->inside_is_low,
                                                   .leave_open = s->is_field,
                                                   .threads = s->threads},
                                       .simplify = &simplify};
    const cli_watch watch = cli_watch_memory();
    const double start = cli_seconds();
    if (st == CW_OK)
        st = cli_make_surface(&s->part, NULL, &pipeline, mesh, NULL, err);
    if (st != CW_OK)
        return st;
    cli_add_run(p, cli_seconds() - start);
    if (p->runs == 1)
        p->peak_bytes = cli_watched_bytes(&watch);
    return CW_OK;
}

cw_status cli_try_simplification(cli_study *s, cli_point *p, cw_error *err)
{
    cw_mesh mesh = {0};
    cw_status st = cli_run_simplification(s, p, &mesh, err);
    if (st == CW_OK)
        st = cli_measure_mesh(s, p, &mesh, err);
    cw_mesh_free(&mesh);
    return st;
}
