/* Compression of the plain surface's file: written, read back, and measured as it came back. */
#include "cli/framework/console.h"
#include "cli/results/compress_options.h"
#include "cli/study/study.h"
#include "core/base/status.h"

#include <string.h>

void cli_plan_compression(cli_study *s)
{
    static const struct {
        int rank;
        cw_compression kind;
        int bits;
    } rows[] = {
        {1, CW_COMPRESS_NONE, 0},      {1, CW_COMPRESS_MESHOPT, 14},
        {1, CW_COMPRESS_DRACO, 14},    {2, CW_COMPRESS_MESHOPT, 12},
        {2, CW_COMPRESS_DRACO, 12},    {2, CW_COMPRESS_QUANTIZE, 14},
        {2, CW_COMPRESS_DRACO, 10},    {2, CW_COMPRESS_MESHOPT, 10},
        {2, CW_COMPRESS_QUANTIZE, 12}, {2, CW_COMPRESS_DRACO, 16},
        {2, CW_COMPRESS_MESHOPT, 16},  {2, CW_COMPRESS_QUANTIZE, 16},
        {2, CW_COMPRESS_QUANTIZE, 10},
    };
    const bool gltf = strcmp(s->suffix, ".glb") == 0;
    for (size_t n = 0; n < sizeof rows / sizeof *rows; n++) {
        const char *group = cli_compression_name(rows[n].kind);
        cli_point *p =
            rows[n].bits ? cli_add_point(s, CLI_COMPRESSION, rows[n].rank, group, "%s, %d bits",
                                         group, rows[n].bits)
                         : cli_add_point(s, CLI_COMPRESSION, rows[n].rank, group, "%s", group);
        p->tried.compression = rows[n].kind;
        p->tried.bits = rows[n].bits;
        if (rows[n].bits && !gltf)
            snprintf(p->why, sizeof p->why, "this build writes no glTF");
    }
}

cw_status cli_run_compression(cli_study *s, cli_point *p, const char **path, cw_error *err)
{
    const cw_write_desc desc = {
        .compression = p->tried.compression,
        .bits = p->tried.bits,
        .progress = cli_progress((double)cli_part_mesh(s)->triangle_count / 1e6, "Mtriangle")};
    *path = NULL;
    cw_status st = cli_need_part(s, err);
    const cli_watch watch = cli_watch_memory();
    const double start = cli_seconds();
    if (st == CW_OK)
        st = cli_weigh_mesh(s, cli_part_mesh(s), &desc, &p->file_bytes, path, err);
    if (st != CW_OK)
        return st;
    cli_add_run(p, cli_seconds() - start);
    if (p->runs == 1)
        p->peak_bytes = cli_watched_bytes(&watch);
    return CW_OK;
}

cw_status cli_try_compression(cli_study *s, cli_point *p, cw_error *err)
{
    const char *path;
    cw_mesh mesh = {0};
    cw_status st = cli_run_compression(s, p, &path, err);
    if (st == CW_OK)
        st = cw_mesh_read(path, NULL, &mesh, NULL, err);
    if (path)
        remove(path);
    if (st == CW_OK)
        st = cli_measure_mesh(s, p, &mesh, err);
    cw_mesh_free(&mesh);
    return st;
}
