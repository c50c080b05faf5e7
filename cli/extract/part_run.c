/* Extracts one part of a surface into a fragment. Parts need nothing of each other: any scheduler
 * can run them, in any order, and again. */
#include "cli/extract/part_run.h"

#include "cli/extract/part_manifest.h"
#include "cli/extract/stream_run.h"
#include "cli/framework/console.h"
#include "core/base/memory.h"
#include "core/base/status.h"

#include <cubewright/spool.h>

#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* A part on its way. */
typedef struct part_run {
    cli_extract_run run;
    cli_manifest manifest;
    size_t part, parts;
    char path[CLI_FRAGMENT_PATH];
    cw_mesh_spool *spool;
    cw_part_counts counts;
    double start;
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

static cw_status check_args(const cli_extract_args *args, cw_error *err)
{
    const char *unstreamed = cli_find_unstreamed(args);
    if (!args->part || !args->manifest)
        return cwi_fail(err, CW_ERR_ARGUMENT, "--part K/N and --manifest DIR belong together");
    if (args->output)
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "--part writes into --manifest, not -o; 'cubewright join DIR -o FILE' "
                        "makes the file of all parts");
    if (args->labels || unstreamed || args->json || args->pvd)
        return cwi_fail(err, CW_ERR_ARGUMENT, "--part cannot be combined with %s",
                        args->labels ? "--labels"
                        : unstreamed ? unstreamed
                        : args->json ? "--json"
                                     : "--pvd");
    if (args->iso.count != 1 || args->common.input_count != 1 || args->steps.given)
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "--part is for one volume, one step and one isovalue (--iso V)");
    return CW_OK;
}

static cw_status extract_slices(void *user, const cw_slice_source *source, cw_error *err)
{
    part_run *p = user;
    cw_stream_desc d;
    cw_status st = cli_plan_slices(&p->run, p->run.args->iso.value[0], source, &d, err);
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

static cw_status make_fragment(part_run *p, cw_error *err)
{
    const cw_slice_visitor visitor = {extract_slices, p};
    struct stat info = {0};
    cw_status st = cw_mesh_spool_new(p->path, &p->spool, err);
    if (st == CW_OK)
        st = cli_visit_slices(&p->run.input.volume, &p->run.args->input, &visitor, err);
    const cw_fragment fragment = {
        .part = p->part, .parts = p->parts, .counts = p->counts, .job = p->manifest.job};
    if (st == CW_OK)
        st = cw_fragment_write(p->path, &fragment, p->spool, err);
    if (st != CW_OK)
        return st;
    cli_result("%s: %s triangles, %s vertices", p->path, cli_count(p->counts.triangles),
               cli_count(p->counts.vertices));
    if (stat(p->path, &info) == 0)
        cli_result("; %s", cli_bytes((double)info.st_size));
    cli_result("; %.2f s\n", cli_seconds() - p->start);
    return CW_OK;
}

cw_status cli_extract_part(const cli_extract_args *args, cw_error *err)
{
    part_run p = {.run.args = args, .start = cli_seconds()};
    cli_input input = args->input;
    input.stream = CLI_STREAM_ALWAYS;
    input.may_stream = true;
    cli_console_start(&args->common, (cli_progress_mode)args->progress);
    cw_status st = check_args(args, err);
    if (st == CW_OK)
        st = parse_part(args->part, &p.part, &p.parts, err);
    if (st == CW_OK)
        st = cli_read_volume(args->common.inputs[0], &input, false, &p.run.input.volume, err);
    if (st == CW_OK)
        st = cli_describe_job(&p.run, p.parts, &p.manifest, err);
    if (st == CW_OK)
        st = cli_settle_manifest(args->manifest, &p.manifest, err);
    if (st == CW_OK)
        st = cli_name_fragment(args->manifest, p.part, p.parts, p.path, err);
    if (st == CW_OK && is_made(&p))
        cli_say("%s: it is there already", p.path);
    else if (st == CW_OK)
        st = make_fragment(&p, err);
    cw_mesh_spool_free(p.spool);
    cli_free_manifest(&p.manifest);
    cli_free_volume(&p.run.input.volume);
    return st;
}
