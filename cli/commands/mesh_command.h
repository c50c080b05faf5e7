/* Commands that turn one mesh into another: the runner owns what they have in common, a command says
 * what is its own. */
#ifndef CLI_COMMANDS_MESH_COMMAND_H
#define CLI_COMMANDS_MESH_COMMAND_H

#include "cli/results/mesh_parts.h"
#include "cli/results/mesh_write_options.h"
#include "cli/results/output_names.h"
#include "cli/results/write_result.h"

/* First member of the structs of these commands. */
typedef struct cli_mesh_args {
    cli_common common;
    cli_input input;
    cli_compress compress;
    cli_written written;
    const char *output, *json;
    const char *source; /* another input, which no output may be; NULL: none */
    int progress;
    bool merge, orient, measure;
} cli_mesh_args;

/* Rows of their tables. */
#define CLI_MESH_OUTPUT(about)                                                                 \
    {                                                                                          \
        "output", 'o', CLI_TEXT, "FILE",                                                       \
            "Mesh to write, in the format of its extension; - is the standard output (with "   \
            "--format); may hold {stem}" about,                                                \
            offsetof(cli_mesh_args, output), CLI_VALUES_MESH_OUTPUT                            \
    }
#define CLI_MESH_MERGE                                                                         \
    {                                                                                          \
        "merge", 0, CLI_FLAG, NULL,                                                            \
            "Join all parts to one mesh (off: each by itself, where the format has parts)",    \
            offsetof(cli_mesh_args, merge)                                                     \
    }
#define CLI_MESH_ORIENT                                                                        \
    {                                                                                          \
        "orient", 0, CLI_FLAG, NULL,                                                           \
            "Flip shells that face the wrong way: outer ones outward, cavities inward (off)",  \
            offsetof(cli_mesh_args, orient)                                                    \
    }
#define CLI_MESH_MEASURE(about)                                                                \
    {                                                                                          \
        "measure", 0, CLI_FLAG, NULL, about, offsetof(cli_mesh_args, measure)                  \
    }
#define CLI_MESH_WRITING                                                                       \
    CLI_JSON_OPTION(cli_mesh_args), CLI_WRITTEN_OPTIONS(cli_mesh_args),                        \
        CLI_COMPRESS_OPTIONS(cli_mesh_args, CLI_MESH_LENGTH)
#define CLI_MESH_COMMON                                                                        \
    CLI_MESH_WRITING, CLI_MESH_INPUT_OPTIONS(cli_mesh_args), CLI_PROGRESS_OPTION(cli_mesh_args)

/* How pieces are made of the parts that are read. */
typedef enum cli_piecing {
    CLI_PIECES_WELDED, /* vertices at equal positions become one */
    CLI_PIECES_AS_READ,
    CLI_PIECES_NONE,
} cli_piecing;

typedef struct cli_mesh_run {
    const struct cli_mesh_command *command;
    const cli_mesh_args *args; /* the command's own struct begins with it */
    void *state;               /* the command's settings and facts */
    int threads;
    const char *reader; /* of the mesh: the input's, unless check() chooses another */
    bool reads_parts;   /* where the format has parts, unless check() decides otherwise */
    cli_mesh mesh;      /* as it was read */
    cli_pieces pieces;  /* what work() turns into something */
    double promised_mm; /* the largest distance to the input; 0: none is promised */
    const char *blamed; /* the file that an error of work() is about; NULL: the input */
    bool is_made;       /* work() is done */
    char found[640];    /* for the line */
    cli_outputs
        outputs; /* one, unless name_outputs() names others; or none, for a report alone */
    cli_report report;
    double start; /* of the work on the file that is written next */
} cli_mesh_run;

/* Steps of a command. A step that is NULL is left out, or is the usual one. */
typedef struct cli_mesh_command {
    const char *name;
    const char *main_step; /* of the report, with the settings; default: the name */
    cli_piecing piecing;
    bool holds_topology; /* what is made has to have the topology of the input */
    bool loses_texture;  /* what is made does not lie on the input's texture */
    /* Checks values, before anything is read. */
    cw_status (*check)(cli_mesh_run *run, cw_error *err);
    /* Names the outputs; default: that of -o. */
    cw_status (*name_outputs)(cli_mesh_run *run, cw_error *err);
    /* Reads or changes more, when the mesh is read and oriented. */
    cw_status (*prepare)(cli_mesh_run *run, cw_error *err);
    /* Finds lengths in mm, when there are pieces. */
    cw_status (*resolve)(cli_mesh_run *run, cw_error *err);
    /* Makes all that is asked for; default: cli_make_mesh(), which runs the steps below. */
    cw_status (*make)(cli_mesh_run *run, cw_error *err);
    /* Makes `out` of each piece. Errors get the file's name. */
    cw_status (*work)(cli_mesh_run *run, cw_error *err);
    /* Tells the facts, and prints those for the line into `found`. Fails if nothing is left. */
    cw_status (*report)(cli_mesh_run *run, cw_error *err);
    /* Checks and measures the result; default: cli_compare_made(). */
    cw_status (*measure)(cli_mesh_run *run, cli_made *made, cw_error *err);
    /* Judges what was written, or a report alone. */
    cw_status (*judge)(cli_mesh_run *run, cw_error *err);
    /* Write the settings, and the facts behind the input. */
    void (*put_params)(cli_json *j, const cli_mesh_run *run, const cli_made *made);
    void (*put_facts)(cli_json *j, const cli_mesh_run *run);
} cli_mesh_command;

/* Runs a command. meshes: the report begins with capacity for these */
CW_NODISCARD cw_status cli_run_mesh_command(const cli_mesh_command *command,
                                            const cli_mesh_args *args, void *state,
                                            size_t meshes, cw_error *err);

/* Makes the mesh of the only output: work, tell, measure, deliver, judge. */
CW_NODISCARD cw_status cli_make_mesh(cli_mesh_run *run, cw_error *err);

/* Checks the topology if the command holds it, and measures the distance both ways. */
CW_NODISCARD cw_status cli_compare_made(cli_mesh_run *run, cli_made *made, cw_error *err);

/* Checks that all outputs can be written, and the report beside them. */
CW_NODISCARD cw_status cli_check_mesh_outputs(cli_mesh_run *run, cw_error *err);

/* Returns how the run writes a mesh. */
cli_delivery cli_mesh_delivery(const cli_mesh_run *run);

/* Returns the triangles of what was made. */
size_t cli_made_triangles(const cli_mesh_run *run);

#endif
