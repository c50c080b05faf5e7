/* Extracts one part of a surface into a fragment. Parts need nothing of each other: any scheduler
 * can run them, in any order, and again. */
#define _GNU_SOURCE /* nanosleep */
#include "cli/extract/part_run.h"

#include "cli/extract/part_join.h"
#include "cli/extract/part_lease.h"
#include "cli/extract/stream_run.h"
#include "cli/framework/console.h"
#include "core/base/memory.h"
#include "core/base/status.h"

#include <cubewright/spool.h>

#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>

/* A part on its way. */
typedef struct part_run {
    cli_extract_run run;
    cli_manifest manifest;
    const char *folder;
    size_t part, parts;
    char path[CLI_FRAGMENT_PATH];
    cw_mesh_spool *spool;
    cw_part_counts counts;
    cli_lease lease; /* of --queue */
    cw_progress bar;
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

static cw_status check_args(const cli_extract_args *args, cw_error *err)
{
    const char *unstreamed = cli_find_unstreamed(args);
    if (args->queue && (args->part || args->manifest))
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "--queue makes all parts; --part and --manifest make one");
    if (args->parts && !args->queue)
        return cwi_fail(err, CW_ERR_ARGUMENT, "--parts is for --queue; --part K/N states both");
    if (!args->queue && (!args->part || !args->manifest))
        return cwi_fail(err, CW_ERR_ARGUMENT, "--part K/N and --manifest DIR belong together");
    if (args->output && !args->queue)
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "--part writes into --manifest, not -o; 'cubewright join DIR -o FILE' "
                        "makes the file of all parts");
    if (cli_extract_is_simplified(args) && !args->pixel.pixels.given && !args->pixel.most.given)
        return cwi_fail(
            err, CW_ERR_ARGUMENT,
            "%s cannot be combined with --simplify: join the parts, then 'cubewright "
            "simplify' reduces the file",
            args->queue ? "--queue" : "--part");
    if (args->labels || unstreamed || args->json || args->pvd)
        return cwi_fail(err, CW_ERR_ARGUMENT, "%s cannot be combined with %s",
                        args->queue ? "--queue" : "--part",
                        args->labels ? "--labels"
                        : unstreamed ? unstreamed
                        : args->json ? "--json"
                                     : "--pvd");
    if (args->iso.count != 1 || args->common.input_count != 1 || args->steps.given)
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "%s is for one volume, one step and one isovalue (--iso V)",
                        args->queue ? "--queue" : "--part");
    const cw_write_desc desc = cli_extract_write_desc(args);
    return args->output ? cw_mesh_write_check(args->output, &desc, err) : CW_OK;
}

/* Shows progress, and renews the lease. */
static bool report_progress(void *user, const char *step, double done)
{
    part_run *p = user;
    cli_renew_lease(&p->lease);
    return !p->bar.report || p->bar.report(p->bar.user, step, done);
}

static cw_status extract_slices(void *user, const cw_slice_source *source, cw_error *err)
{
    part_run *p = user;
    cw_stream_desc d;
    cw_status st = cli_plan_slices(&p->run, p->run.args->iso.value[0], source, &d, err);
    p->bar = d.extract.progress;
    d.extract.progress = (cw_progress){.report = report_progress, .user = p};
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
    p->start = cli_seconds();
    cw_status st = cw_mesh_spool_new(p->path, &p->spool, err);
    if (st == CW_OK)
        st = cli_visit_slices(&p->run.input.volume, &p->run.args->input, &visitor, err);
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

/* Makes the parts that are neither there nor leased. *left: those that others are making */
static cw_status make_free_parts(part_run *p, size_t *left, cw_error *err)
{
    cw_status st = CW_OK;
    *left = 0;
    for (p->part = 0; p->part < p->parts && st == CW_OK; p->part++) {
        st = cli_name_fragment(p->folder, p->part, p->parts, p->path, err);
        if (st == CW_OK && is_made(p)) {
            cli_clear_lease(p->folder, p->part, p->parts);
            continue;
        }
        if (st != CW_OK)
            continue;
        if (!cli_take_lease(p->folder, p->part, p->parts, &p->lease)) {
            ++*left;
            continue;
        }
        if (!is_made(p)) /* it was not made in between */
            st = make_fragment(p, err);
        cli_drop_lease(&p->lease);
    }
    return st;
}

/* Makes parts until all are there, whoever makes them. */
static cw_status run_queue(part_run *p, cw_error *err)
{
    const cw_progress wait = cli_progress(0, "");
    size_t left = 0;
    cw_status st = make_free_parts(p, &left, err);
    while (st == CW_OK && left) {
        nanosleep(&(struct timespec){.tv_nsec = 200000000}, NULL);
        st = cwi_progress(&wait, "waiting", 0, err);
        if (st == CW_OK)
            st = make_free_parts(p, &left, err);
    }
    return st;
}

/* Layers of a part, if the number of parts is not stated: parts of a size that is soon made. */
enum { PART_LAYERS = 64 };

cw_status cli_extract_part(const cli_extract_args *args, cw_error *err)
{
    part_run p = {.run.args = args, .folder = args->queue ? args->queue : args->manifest};
    const double start = cli_seconds();
    cli_input input = args->input;
    input.stream = CLI_STREAM_ALWAYS;
    input.may_stream = true;
    cli_console_start(&args->common, (cli_progress_mode)args->progress);
    cw_status st = check_args(args, err);
    if (st == CW_OK && args->part)
        st = parse_part(args->part, &p.part, &p.parts, err);
    if (st == CW_OK)
        st = cli_read_volume(args->common.inputs[0], &input, false, &p.run.input.volume, err);
    if (args->queue)
        p.parts = args->parts ? args->parts : p.run.input.volume.view.dim[2] / PART_LAYERS + 1;
    if (st == CW_OK)
        st = cli_describe_job(&p.run, p.parts, &p.manifest, err);
    if (st == CW_OK)
        st = cli_settle_manifest(p.folder, &p.manifest, err);
    if (st == CW_OK)
        st = args->queue ? run_queue(&p, err) : make_part(&p, err);
    if (st == CW_OK && args->queue && args->output) {
        const cw_write_desc desc = cli_extract_write_desc(args);
        cli_manifest there = {0};
        st = cli_read_manifest(p.folder, &there, err);
        if (st == CW_OK)
            st = cli_join_parts(p.folder, &there, args->output, &desc, start, err);
        cli_free_manifest(&there);
    }
    cli_free_manifest(&p.manifest);
    cli_free_volume(&p.run.input.volume);
    return st;
}
