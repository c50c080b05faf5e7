/* Compares the library with others at the same work, alternately: time, memory, and how close
 * the result is. */
#ifndef CLI_BENCH_BENCH_H
#define CLI_BENCH_BENCH_H

#include "cli/bench/bench_peers.h"
#include "cli/study/study.h"

#include <stdio.h>

typedef enum cli_bench_work {
    CLI_BENCH_EXTRACTION,
    CLI_BENCH_SIMPLIFICATION,
    CLI_BENCH_COMPRESSION,
    CLI_BENCH_WORKS
} cli_bench_work;

typedef enum cli_bench_status {
    CLI_BENCH_DONE,
    CLI_BENCH_LEFT_OUT, /* this build cannot */
    CLI_BENCH_MISSING,  /* the peer is not installed */
    CLI_BENCH_FAILED
} cli_bench_status;

extern const char *const cli_bench_status_names[];

enum {
    CLI_BENCH_MAX_RUNS = 99,
    CLI_BENCH_BITS = 14,    /* of compressed coordinates */
    CLI_BENCH_SHARE = 10,   /* of the triangles, in %, that simplification leaves */
    CLI_BENCH_MAX_ROWS = 16 /* of a case */
};

/* Who does which work, and how; a table in bench_work.c. */
typedef struct cli_bench_kind cli_bench_kind;

typedef struct cli_bench_row {
    const cli_bench_kind *kind;
    cli_bench_work work;
    const char *who, *setting;
    bool is_peer;
    int threads; /* that it may use */
    cli_bench_status status;
    char why[CLI_WHY_CAPACITY]; /* unless it is done */

    double times[CLI_BENCH_MAX_RUNS];
    size_t runs;
    double seconds; /* the median */
    double ratio;   /* of a peer: its median by that of our row `against`; 0: none */
    const char *against;
    size_t peak_bytes, vertices, triangles, file_bytes;
    size_t worked_on;                  /* triangles: of the result, or of what was simplified */
    cw_field_vertex_error at_vertices; /* to the case's surface; of a file without angles */
    cli_gap surface;                   /* the same, at points all over the triangles */
    bool moved;                        /* of compression: how far vertices were */
    double moved_mean_mm, moved_max_mm;
    size_t open_edges, nonmanifold_edges, nonmanifold_vertices, zero_area;
} cli_bench_row;

/* A field of some size, or a file. */
typedef struct cli_bench_case {
    const char *name; /* of the field or file */
    const char *path; /* NULL: a field: */
    cw_field field;
    size_t dim[3];
    cw_type type;
    double iso, voxel_mm;
    const char *level; /* how that was found */
    bool inside_is_low;
    cli_bench_row rows[CLI_BENCH_MAX_ROWS];
    size_t row_count;
} cli_bench_case;

typedef struct cli_bench {
    /* what is to be done: set before cli_bench_run() */
    const cli_input *input;
    cli_number iso;
    int inside; /* CLI_INSIDE_AUTO, ... */
    bool with_peers;
    size_t repeat;
    double limit_s; /* for one run of a peer */
    int threads;
    cli_bench_case *cases; /* name, path, field, dim of fields */
    size_t case_count;

    cli_peers peers;
    double load; /* of the machine before it began, in processors at work; NaN: unknown */
    char *folder;
    /* of the case at work */
    cli_bench_case *now;
    cli_volume volume;
    cw_mesh surface; /* what is simplified and compressed: our own, linear */
    cw_mesh made;    /* by the last run of ours */
} cli_bench;

/* Measures one case after the other, and reports each when it is done. Free with
 * cli_bench_free(), also after failure. Rows store why a peer or a setting failed.
 * Returns  CW_ERR_EMPTY  there is no surface at that level
 *          CW_ERR_CANCELLED; and whatever keeps a case from being read, or extracted */
CW_NODISCARD cw_status cli_bench_run(cli_bench *bench, cw_error *err);
void cli_bench_free(cli_bench *bench);

/* The rows of a case, and their runs. bench_work.c */
void cli_bench_plan(const cli_bench *bench, cli_bench_case *c);
CW_NODISCARD cw_status cli_bench_prepare(cli_bench *bench, const cli_bench_kind *kind,
                                         cw_error *err);
CW_NODISCARD cw_status cli_bench_once(cli_bench *bench, const cli_bench_kind *kind,
                                      cli_spent *spent, cw_error *err);

/* Returns the mesh that the last run made, and the size of its file (0: it made no file). */
CW_NODISCARD cw_status cli_bench_take(cli_bench *bench, const cli_bench_kind *kind,
                                      cw_mesh *mesh, size_t *file_bytes, cw_error *err);

/* For people, and for programs. study_table.c */
void cli_bench_tell_start(const cli_bench *bench);
void cli_bench_tell(const cli_bench_case *c);
void cli_bench_put_csv(FILE *out, const void *bench);
void cli_bench_put_json(FILE *out, const void *bench);

#endif
