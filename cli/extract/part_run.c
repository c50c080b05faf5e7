/* Extracts a surface in parts. Parts need nothing of each other: any scheduler can run them, in any
 * order, and again. */
#include "cli/extract/part_run.h"

#include "cli/extract/part_join.h"
#include "cli/extract/part_manifest.h"
#include "cli/extract/stream_run.h"
#include "cli/framework/console.h"
#include "cli/framework/quantity.h"
#include "cli/framework/standard_streams.h"
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/base/thread_pool.h"

#include <cubewright/spool.h>

#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* A part on its way. */
typedef struct part_run {
    cli_extract_run run;
    cli_manifest manifest;
    const char *folder;
    size_t part, parts;
    char path[CLI_FRAGMENT_PATH];
    cw_mesh_spool *spool;
    cw_part_counts counts;
    double start; /* of the part */
} part_run;

static cw_status parse_part(const char *text, size_t *part, size_t *parts, cw_error *err)
{
    char *end;
    const unsigned long long k = strtoull(text, &end, 10);
    const char *slash = end;
    const unsigned long long n = *slash == '/' ? strtoull(slash + 1, &end, 10) : 0;
    if (*slash != '/' || *end || end == slash + 1 || k < 1 || k > n || n > 1000000 ||
        text[0] == '-' || slash[1] == '-')
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "--part %s: K/N was expected, with K from 1 to N, such as 3/8", text);
    *part = (size_t)k - 1;
    *parts = (size_t)n;
    return CW_OK;
}

/* Refuses what is not made in parts. how: the option, or launcher, that asks for parts */
static cw_status check_job(const cli_extract_args *args, const char *how, cw_error *err)
{
    const char *unstreamed = cli_find_unstreamed(args, CW_SOURCE_PARTS);
    if (args->simplify.error.given || args->simplify.triangles)
        return cwi_fail(
            err, CW_ERR_ARGUMENT,
            "%s cannot be combined with --simplify: join the parts, then 'cubewright "
            "simplify' reduces the file",
            how);
    if (args->labels || unstreamed || args->json || args->pvd)
        return cwi_fail(err, CW_ERR_ARGUMENT, "%s cannot be combined with %s", how,
                        args->labels ? "--labels"
                        : unstreamed ? unstreamed
                        : args->json ? "--json"
                                     : "--pvd");
    if (args->iso.count != 1 || args->common.input_count != 1 || args->steps.given)
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "%s is for one volume, one step and one isovalue (--iso V)", how);
    if (args->iso.level[0] != CLI_LEVEL_NUMBER)
        return cwi_fail(
            err, CW_ERR_ARGUMENT,
            "%s: each part reads a part of the voxels, and --iso %s is of all; give "
            "its number, which 'cubewright extract' says without %s",
            how, cli_level_text(args->iso.level[0], args->iso.value[0]), how);
    const cw_write_desc desc = cli_extract_write_desc(args);
    return args->output ? cli_check_writable(args->output, &desc, err) : CW_OK;
}

static cw_status check_args(const cli_extract_args *args, cw_error *err)
{
    if (args->parts)
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "--parts is for mpirun with --manifest; --part K/N states both");
    if (!args->part || !args->manifest)
        return cwi_fail(err, CW_ERR_ARGUMENT, "--part K/N and --manifest DIR belong together");
    if (args->output)
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "--part writes into --manifest, not -o; 'cubewright join DIR -o FILE' "
                        "makes the file of all parts");
    return check_job(args, "--part", err);
}

static cw_status extract_slices(void *user, const cw_slice_source *source, cw_error *err)
{
    part_run *p = user;
    cli_surface_settings set;
    cw_status st = cli_plan_slices(&p->run, p->run.args->iso.value[0], source, &set, err);
    const size_t *dim = source->shape.dim;
    cw_stream_desc d = {.extract = set.desc.extract, .layers = set.desc.layers};
    d.extract.extra_bytes = 0;
    d.extract.progress =
        cli_stage_progress(NULL, CW_STAGE_EXTRACT, dim[0] * dim[1] * dim[2], "voxel");
    return st == CW_OK ? cw_extract_stream_part(source, &d, p->part, p->parts,
                                                cw_mesh_spool_sink(p->spool), &p->counts, err)
                       : st;
}

/* Returns true if the fragment is there already, complete and of this job. */
static bool is_made(const part_run *p)
{
    cw_fragment there;
    return cw_fragment_read(p->path, &there, NULL) == CW_OK && there.job == p->manifest.job &&
           there.part == p->part && there.parts == p->parts;
}

/* Extracts the part into a new spool beside a path. */
static cw_status fill_spool(part_run *p, const char *path, cw_error *err)
{
    const cw_slice_visitor visitor = {extract_slices, p};
    cw_status st = cw_mesh_spool_new(cli_temporary_beside(path), &p->spool, err);
    return st == CW_OK
               ? cli_visit_slices(&p->run.input.volume, &p->run.args->input, &visitor, err)
               : st;
}

static cw_status make_fragment(part_run *p, cw_error *err)
{
    struct stat info = {0};
    p->start = cli_seconds();
    cw_status st = fill_spool(p, p->path, err);
    const cw_fragment fragment = {
        .part = p->part, .parts = p->parts, .counts = p->counts, .job = p->manifest.job};
    if (st == CW_OK)
        st = cw_fragment_write(p->path, &fragment, p->spool, err);
    cw_mesh_spool_free(p->spool);
    p->spool = NULL;
    if (st != CW_OK)
        return st;
    cli_result("%s: %s triangles, %s vertices", p->path, cli_count(p->counts.triangles),
               cli_count(p->counts.vertices));
    if (stat(p->path, &info) == 0)
        cli_result("; %s", cli_bytes((double)info.st_size));
    cli_result("; %.2f s\n", cli_seconds() - p->start);
    return CW_OK;
}

static cw_status make_part(part_run *p, cw_error *err)
{
    cw_status st = cli_name_fragment(p->folder, p->part, p->parts, p->path, err);
    if (st != CW_OK || !is_made(p))
        return st == CW_OK ? make_fragment(p, err) : st;
    cli_say("%s: it is there already", p->path);
    return CW_OK;
}

/* Layers of a part, if the number of parts is not stated: parts of a size that is soon made. */
enum { PART_LAYERS = 64 };

/* Opens the volume and describes the job. parts: 0: of PART_LAYERS */
static cw_status begin_job(part_run *p, size_t parts, cw_error *err)
{
    const cli_extract_args *args = p->run.args;
    cli_input input = args->input;
    input.stream = CLI_STREAM_ALWAYS;
    input.may_stream = true;
    cw_status st =
        cli_read_volume(args->common.inputs[0], &input, false, &p->run.input.volume, err);
    p->parts = parts ? parts : p->run.input.volume.view.dim[2] / PART_LAYERS + 1;
    return st == CW_OK ? cli_describe_job(&p->run, p->parts, &p->manifest, err) : st;
}

static void end_job(part_run *p)
{
    cw_mesh_spool_free(p->spool);
    cli_free_manifest(&p->manifest);
    cli_free_volume(&p->run.input.volume);
}

cw_status cli_extract_part(const cli_extract_args *args, cw_error *err)
{
    part_run p = {.run.args = args, .folder = args->manifest};
    cli_console_start(&args->common, (cli_progress_mode)args->progress);
    cw_status st = check_args(args, err);
    if (st == CW_OK)
        st = parse_part(args->part, &p.part, &p.parts, err);
    if (st == CW_OK)
        st = begin_job(&p, p.parts, err);
    if (st == CW_OK)
        st = cli_settle_manifest(p.folder, &p.manifest, err);
    if (st == CW_OK)
        st = make_part(&p, err);
    end_job(&p);
    return st;
}

/* --- ranks ---------------------------------------------------------------------------------- */

/* Refuses what the processes of a team cannot do together. */
static cw_status check_team(const cli_extract_args *args, cw_error *err)
{
    if (args->parts && !args->manifest)
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "--parts is for --manifest, where parts are kept");
    if (!args->output)
        return cwi_fail(err, CW_ERR_ARGUMENT, "mpirun needs an output: -o FILE");
    return check_job(args, "mpirun", err);
}

/* Shares the processors and the memory of this machine among the ranks on it. */
static void share_machine(cli_input *input, const cw_team *team)
{
    const long ranks = team->on_this_host, online = sysconf(_SC_NPROCESSORS_ONLN);
    const int bound = cwi_threads(0); /* the launcher may have bound the rank to some */
    const long fair = online / ranks > 1 ? online / ranks : 1;
    if (!input->threads)
        input->threads = (size_t)(bound < fair ? bound : fair);
    if (!input->memory)
        input->memory = cli_memory_limit(input) / (size_t)ranks;
}

/* Rank 0 makes the folder and its manifest. */
static cw_status settle_together(const part_run *p, const cw_team *team, cw_error *err)
{
    cw_status st = team->rank == 0 ? cli_settle_manifest(p->folder, &p->manifest, err) : CW_OK;
    st = cw_team_agree(team, st, err);
    return st == CW_OK && team->rank > 0 ? cli_settle_manifest(p->folder, &p->manifest, err)
                                         : st;
}

/* Makes the parts of this rank: fragments that are kept, which it then reads back. */
static cw_status make_kept_parts(part_run *p, const cw_team *team, cw_error *err)
{
    const size_t rank = (size_t)team->rank, size = (size_t)team->size,
                 first = p->parts * rank / size, end = p->parts * (rank + 1) / size;
    cw_status st = settle_together(p, team, err);
    for (p->part = first; p->part < end && st == CW_OK; p->part++)
        st = make_part(p, err);
    if (st == CW_OK)
        st = cw_mesh_spool_new(cli_temporary_beside(p->run.args->output), &p->spool, err);
    p->counts = (cw_part_counts){0};
    return st == CW_OK ? cli_append_parts(p->folder, &p->manifest, first, end, p->spool,
                                          &p->counts, err)
                       : st;
}

/* Finds out whether the parts of all ranks have samples on each side. */
static cw_status gather_sides(const cw_team *team, cw_part_counts *sides, cw_error *err)
{
    const unsigned char mine[2] = {sides->has_inside, sides->has_outside};
    unsigned char *all = cwi_alloc_array((size_t)team->size, sizeof mine);
    cw_status st = all ? CW_OK : cwi_fail_memory(err);
    st = cw_team_agree(team, st, err);
    if (st == CW_OK)
        st = cw_team_gather(team, mine, sizeof mine, all, err);
    for (int r = 0; r < team->size && st == CW_OK; r++) {
        sides->has_inside = sides->has_inside || all[2 * r];
        sides->has_outside = sides->has_outside || all[2 * r + 1];
    }
    cwi_free(all);
    return st;
}

/* Makes the parts of this rank, and with the others the file. */
static cw_status work_together(part_run *p, const cw_team *team, double start, cw_error *err)
{
    const cli_extract_args *args = p->run.args;
    const cw_write_desc desc = cli_extract_write_desc(args);
    char text[CLI_PARTS_TEXT];
    cw_status st = check_team(args, err);
    if (st == CW_OK)
        st = begin_job(p, args->manifest ? args->parts : (size_t)team->size, err);
    st = cw_team_agree(team, st, err);
    if (st == CW_OK && args->manifest)
        st = make_kept_parts(p, team, err);
    else if (st == CW_OK) {
        p->part = (size_t)team->rank;
        st = fill_spool(p, args->output, err);
    }
    st = cw_team_agree(team, st, err);
    if (st == CW_OK)
        st = gather_sides(team, &p->counts, err);
    if (st == CW_OK)
        st = cw_mesh_spool_share(p->spool, team, err);
    const cli_joined joined = {.output = args->output,
                               .from = text,
                               .desc = &desc,
                               .manifest = &p->manifest,
                               .input = &args->input,
                               .check = args->check,
                               .start = start};
    snprintf(text, sizeof text, "%d processes", team->size);
    return st == CW_OK ? cli_write_joined(&joined, p->spool, &p->counts, team, err) : st;
}

cw_status cli_extract_ranks(const cli_extract_args *args, cw_error *err)
{
    const double start = cli_seconds();
    cli_extract_args mine = *args;
    part_run p = {.run.args = &mine, .folder = args->manifest};
    cw_team team;
    cw_status st = cw_team_join(&team, err);
    if (st != CW_OK)
        return st;
    mine.common.quiet = args->common.quiet || team.rank > 0;
    cli_console_start(&mine.common,
                      team.rank > 0 ? CLI_PROGRESS_NONE : (cli_progress_mode)args->progress);
    share_machine(&mine.input, &team);
    st = work_together(&p, &team, start, err);
    const bool speaks = team.rank == 0;
    end_job(&p);
    cw_team_leave(&team);
    return speaks ? st : CW_OK; /* all failed alike; one tells */
}
