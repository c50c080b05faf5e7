/* Extraction: where vertices are placed, which are merged, how many voxels are looked at. */
#include "cli/framework/console.h"
#include "cli/inputs/extract_surface.h"
#include "cli/study/study.h"

void cli_plan_extraction(cli_study *s)
{
    static const struct {
        int rank;
        size_t coarsen;
        bool cubic;
        double snap;
        const char *group, *name;
    } rows[] = {
        {0, 1, false, 0, "linear", "linear"},
        {1, 1, false, 0.3, "snapped", "linear, snap 0.3"},
        {1, 2, false, 0, "linear", "linear, every 2nd voxel"},
        {1, 1, true, 0, "cubic", "cubic"},
        {1, 2, true, 0, "cubic", "cubic, every 2nd voxel"},
        {2, 4, false, 0, "linear", "linear, every 4th voxel"},
        {2, 4, true, 0, "cubic", "cubic, every 4th voxel"},
        {3, 2, false, 0.3, "snapped", "linear, every 2nd voxel, snap 0.3"},
        {4, 1, false, 0.1, "snapped", "linear, snap 0.1"},
    };
    for (size_t n = 0; n < sizeof rows / sizeof *rows; n++) {
        cli_point *p =
            cli_add_point(s, CLI_EXTRACTION, rows[n].rank, rows[n].group, "%s", rows[n].name);
        p->tried.coarsen = rows[n].coarsen;
        p->tried.cubic = rows[n].cubic;
        p->tried.snap = rows[n].snap;
        p->shown = n < 3 || (n == 3 && s->is_field);
        p->turned = n == 0;
        if (rows[n].cubic && rows[n].coarsen == 1 && !s->is_field)
            p->aside = "its vertices lie where a cubic has the isovalue, but the error is "
                       "measured to a field that is linear between voxels, and would count the "
                       "gain as a loss. The previews show the gain: they are measured against "
                       "voxels that they did not use";
    }
}

cw_status cli_run_extraction(cli_study *s, cli_point *p, cw_mesh *mesh, cw_error *err)
{
    const size_t step[3] = {p->tried.coarsen, p->tried.coarsen, p->tried.coarsen};
    const cw_extract_desc desc = {.isovalue = s->iso,
                                  .inside_is_low = s->inside_is_low,
                                  .leave_open = s->is_field,
                                  .cubic_placement = p->tried.cubic,
                                  .snap = p->tried.snap,
                                  .threads = s->threads};
    cli_volume volume = *s->volume; /* borrowed */
    cw_extract_counts counts;
    cw_status st = cw_volume_coarsen(&s->volume->view, step, &volume.view, err);
    const cli_watch watch = cli_watch_memory();
    const double start = cli_seconds();
    if (st == CW_OK)
        st = cli_extract_surface(&volume, &desc, mesh, &counts, err);
    if (st != CW_OK)
        return st;
    cli_add_run(p, cli_seconds() - start);
    if (p->runs == 1)
        p->peak_bytes = cli_watched_bytes(&watch);
    return CW_OK;
}

cw_status cli_try_extraction(cli_study *s, cli_point *p, cw_error *err)
{
    const bool plain = p->tried.coarsen == 1 && !p->tried.cubic && p->tried.snap == 0;
    cw_mesh mesh = {0};
    cw_status st = cli_run_extraction(s, p, &mesh, err);
    if (st != CW_OK)
        return st;
    if (plain) {
        s->full = mesh;
        return cli_measure_mesh(s, p, &s->full, err);
    }
    st = cli_measure_mesh(s, p, &mesh, err);
    cw_mesh_free(&mesh);
    return st;
}
