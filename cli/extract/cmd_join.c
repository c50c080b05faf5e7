/* The command join: makes one file of the fragments that 'extract --part' made. */
#include "cli/extract/part_manifest.h"
#include "cli/framework/commands.h"
#include "cli/framework/console.h"
#include "core/base/status.h"

#include <cubewright/spool.h>

#include <sys/stat.h>

typedef struct join_args {
    cli_common common;
    cli_input input;
    const char *output, *format, *name;
    bool local, no_clobber;
    int progress;
} join_args;

static const join_args defaults = {0};

static const cli_option options[] = {
    {"output", 'o', CLI_TEXT, "FILE", "Mesh to write, in the format of its extension",
     offsetof(join_args, output)},
    {"format", 0, CLI_TEXT, "NAME", "Format to write; names as in 'formats' (by extension)",
     offsetof(join_args, format)},
    {"name", 0, CLI_TEXT, "TEXT", "Name of the object inside the file (the file's)",
     offsetof(join_args, name)},
    {"local", 0, CLI_FLAG, NULL,
     "Write coordinates relative to the mesh's origin, which is printed (off: world)",
     offsetof(join_args, local)},
    {"no-clobber", 0, CLI_FLAG, NULL, "Fail if the output exists (off: replace it)",
     offsetof(join_args, no_clobber)},
    CLI_HEADED(CLI_LIMITS),
    CLI_MEMORY_OPTION(join_args),
    CLI_PROGRESS_OPTION(join_args),
};

/* Appends the fragments of all parts in order. `is_crossed`: they have samples on both sides. */
static cw_status append_parts(const char *folder, const cli_manifest *m, cw_mesh_spool *spool,
                              bool *is_crossed, cw_error *err)
{
    bool in = false, out = false;
    cw_status st = CW_OK;
    for (size_t part = 0; part < m->parts && st == CW_OK; part++) {
        char path[CLI_FRAGMENT_PATH];
        struct stat info;
        cw_fragment f;
        st = cli_name_fragment(folder, part, m->parts, path, err);
        if (st == CW_OK && stat(path, &info) != 0)
            st = cwi_fail(err, CW_ERR_IO,
                          "%s: part %zu of %zu is missing; 'extract --part %zu/%zu' makes it",
                          path, part + 1, m->parts, part + 1, m->parts);
        if (st == CW_OK)
            st = cw_fragment_read(path, &f, err);
        if (st == CW_OK && (f.job != m->job || f.part != part || f.parts != m->parts))
            st =
                cwi_fail(err, CW_ERR_FORMAT,
                         "%s: it is of another job than the manifest, or another part; extract "
                         "it again",
                         path);
        if (st == CW_OK)
            st = cw_fragment_append(path, spool, err);
        in = in || (st == CW_OK && f.counts.has_inside);
        out = out || (st == CW_OK && f.counts.has_outside);
    }
    *is_crossed = in && out;
    return st;
}

static cw_status write_file(const join_args *args, const cli_manifest *m,
                            const cw_mesh_spool *spool, double start, cw_error *err)
{
    cw_provenance lines[CLI_EXTRACT_PROVENANCE];
    const cw_mesh *frame = cw_mesh_spool_frame(spool);
    const cw_part part = {.mesh = frame, .spool = spool};
    struct stat info = {0};
    for (size_t n = 0; n < m->line_count; n++)
        lines[n] = (cw_provenance){m->lines[n][0], m->lines[n][1]};
    const cw_write_desc desc = {
        .format = args->format,
        .name = args->name,
        .local = args->local,
        .no_clobber = args->no_clobber,
        .provenance = lines,
        .provenance_count = m->line_count,
        .progress = cli_progress((double)frame->triangle_count / 1e6, "Mtriangle")};
    cw_status st = cw_parts_write(args->output, &part, 1, &desc, err);
    if (st != CW_OK)
        return st;
    cli_result("%s: %s triangles, %s vertices, from %zu part%s", args->output,
               cli_count(frame->triangle_count), cli_count(frame->vertex_count), m->parts,
               m->parts == 1 ? "" : "s");
    if (stat(args->output, &info) == 0)
        cli_result("; %s", cli_bytes((double)info.st_size));
    cli_result("; %.2f s\n", cli_seconds() - start);
    return CW_OK;
}

static cw_status run_join(void *p, cw_error *err)
{
    const join_args *args = p;
    const char *folder = args->common.inputs[0];
    const double start = cli_seconds();
    cw_mesh_spool *spool = NULL;
    cli_manifest m = {0};
    bool is_crossed;
    if (!args->output)
        return cwi_fail(err, CW_ERR_ARGUMENT, "join needs an output: -o FILE");
    cli_console_start(&args->common, (cli_progress_mode)args->progress);
    const cw_write_desc desc = {.format = args->format, .no_clobber = args->no_clobber};
    cw_status st = cw_mesh_write_check(args->output, &desc, err);
    if (st == CW_OK)
        st = cli_read_manifest(folder, &m, err);
    if (st == CW_OK)
        st = cw_mesh_spool_new(args->output, &spool, err);
    if (st == CW_OK)
        st = append_parts(folder, &m, spool, &is_crossed, err);
    if (st == CW_OK && (!is_crossed || !cw_mesh_spool_frame(spool)->triangle_count))
        st = cwi_fail(err, CW_ERR_EMPTY, "%s: the parts have no surface", folder);
    if (st == CW_OK)
        st = write_file(args, &m, spool, start, err);
    cw_mesh_spool_free(spool);
    cli_free_manifest(&m);
    return st;
}

const cli_command cli_join = {
    .name = "join",
    .usage = "DIR -o MESH [options]",
    .about = "Join the parts of a surface that 'extract --part' made to one file",
    .page = cli_page_join,
    .options = options,
    .option_count = sizeof options / sizeof *options,
    .min_inputs = 1,
    .max_inputs = 1,
    .size = sizeof(join_args),
    .defaults = &defaults,
    .run = run_join,
};
