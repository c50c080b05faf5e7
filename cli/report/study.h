/* Settings tried on one volume: what each costs, how far it is from the truth, and which are
 * worth choosing. */
#ifndef CLI_REPORT_STUDY_H
#define CLI_REPORT_STUDY_H

#include "cli/render/scene_options.h"
#include "cli/results/printability.h"

#include <cubewright/distance.h>
#include <cubewright/extract.h>
#include <cubewright/field.h>
#include <cubewright/quality.h>

typedef enum cli_family {
    CLI_EXTRACTION,
    CLI_SIMPLIFICATION,
    CLI_COMPRESSION,
    CLI_RENDERING,
    CLI_FAMILY_COUNT
} cli_family;

extern const char *const cli_family_names[CLI_FAMILY_COUNT];

/* How far a surface is from another, in mm. */
typedef struct cli_gap {
    bool known;
    double max_mm, rms_mm, p99_mm;
} cli_gap;

/* Settings of a point; those of other families are zero. */
typedef struct cli_tried {
    size_t coarsen; /* extraction: every n-th voxel along each axis; 0: all */
    bool cubic;
    double snap;
    double error_vox; /* simplification: to that error, */
    double share;     /* or that share of the triangles */
    cw_compression compression;
    int bits;
    cw_mode mode; /* rendering */
    cli_scene scene;
} cli_tried;

enum { CLI_NAME_CAPACITY = 64, CLI_WHY_CAPACITY = 512 };

/* One setting: what it is, and what came of it. */
typedef struct cli_point {
    cli_family family;
    int rank;                     /* the lower, the sooner it is tried */
    const char *group;            /* of its kind in the family */
    char name[CLI_NAME_CAPACITY]; /* of the setting */
    cli_tried tried;
    bool shown; /* its mesh is drawn, its triangles' shapes are kept */

    bool done;
    char why[CLI_WHY_CAPACITY]; /* if not: why it was left out */
    const char *aside;          /* why it is not compared with the others; NULL: it is */
    char *command;              /* that does it; owned */
    double seconds;
    size_t peak_bytes; /* beyond what the process had before; 0: unknown */
    size_t triangles, file_bytes;
    size_t measured_one_of; /* one of n triangles was measured */
    cli_gap to_field;       /* from its vertices and triangles to the field's surface */
    cli_gap back;           /* from the plain surface's vertices to it */
    cli_gap truth;          /* to the surface that is known on paper */
    cw_comparison picture;
    cw_shapes shapes;
    char *png; /* owned; NULL: none */
    size_t png_size;
    bool front; /* no other is both cheaper and closer */
} cli_point;

/* Which number of a point is its cost, which its error; and what they are called. */
typedef struct cli_axis {
    const char *cost, *cost_unit, *error, *error_unit;
} cli_axis;

/* Limits of a study: the size of pictures, and the number of triangles that are sampled for
 * errors where a mesh has more. */
enum {
    CLI_STUDY_SAMPLE = 25000,
    CLI_MAX_POINTS = 64,
    CLI_STUDY_WIDTH = 320,
    CLI_STUDY_HEIGHT = 240
};

/* The plain surface as a print. */
typedef struct cli_print_study {
    char why[CLI_WHY_CAPACITY]; /* it was not measured; empty: it was */
    cli_printed seen;
} cli_print_study;

typedef struct cli_study {
    /* what is studied: set before cli_study_run() */
    cli_volume *volume;
    bool is_field; /* one whose surface is known on paper: */
    cw_field field;
    double iso;
    const char *level; /* how that was found: "otsu", "as asked", ... */
    bool inside_is_low;
    const char *input_words; /* of commands: the file, and how to read it */
    const char *make_words;  /* the command that makes a field's file; NULL: none is needed */
    const char *title;
    size_t coarsen;  /* every n-th voxel along each axis is studied; 1: all */
    bool is_cropped; /* by who asks: no smaller part is chosen */
    int threads;
    double budget_s;

    /* what came of it */
    cli_point points[CLI_MAX_POINTS];
    size_t point_count;
    double voxel_mm;
    const char *suffix; /* of meshes: ".glb", or ".stl" in builds without */
    double start, deadline, seconds;
    cli_print_study print;
    cw_mesh full; /* the plain surface, of all voxels */
    bool part_chosen;
    cli_volume part;     /* borrowed: what is simplified and compressed, the volume or a box */
    cw_mesh part_mesh;   /* its plain surface; of no box: empty */
    char part_words[96]; /* of commands: that box */
    char *folder;        /* for files that are measured; owned */
    cw_renderer *renderer;    /* NULL: not yet, or none */
    cw_renderer *cpu;         /* the same, on the CPU */
    char backend[256];        /* its name */
    cw_volume drawn;          /* borrowed */
    cw_transfer transfer;     /* of drawn */
    cw_picture reference;     /* of the rendering integral */
    double reference_seconds; /* 0: there is none */
} cli_study;

/* Tries the settings, those that matter most first, until the budget is spent; what is left out
 * says why. Free with cli_study_free(), also after failure.
 * Returns  CW_ERR_EMPTY  there is no surface at that level
 *          CW_ERR_CANCELLED; and whatever keeps the plain surface from being made */
CW_NODISCARD cw_status cli_study_run(cli_study *study, cw_error *err);
void cli_study_free(cli_study *study);

/* The axes of a family, as far as it was measured. */
cli_axis cli_study_axis(const cli_study *study, cli_family family);
double cli_point_cost(const cli_point *point);
double cli_point_error(const cli_study *study, const cli_point *point); /* NaN: none */

/* Marks those of the points that no other one beats: no cost above its own, no error above its
 * own, and one of them below. What is not finite is beaten. */
void cli_pareto(const double *cost, const double *error, size_t count, bool *front);

/* Judges the plain surface as a print. What keeps it from that is kept, too.
 * Returns  CW_ERR_CANCELLED  by who waits for it */
CW_NODISCARD cw_status cli_study_print(cli_study *study, cw_error *err);

/* For the runs of families. */
cli_point *cli_add_point(cli_study *study, cli_family family, int rank, const char *group,
                         const char *format, ...) CW_PRINTF(5, 6);
void cli_plan_extraction(cli_study *study);
void cli_plan_simplification(cli_study *study);
void cli_plan_compression(cli_study *study);
void cli_plan_rendering(cli_study *study);
CW_NODISCARD cw_status cli_try_extraction(cli_study *study, cli_point *point, cw_error *err);
CW_NODISCARD cw_status cli_try_simplification(cli_study *study, cli_point *point,
                                              cw_error *err);
CW_NODISCARD cw_status cli_try_compression(cli_study *study, cli_point *point, cw_error *err);
CW_NODISCARD cw_status cli_try_rendering(cli_study *study, cli_point *point, cw_error *err);

/* Chooses the part that is simplified and compressed, and extracts it. */
CW_NODISCARD cw_status cli_need_part(cli_study *study, cw_error *err);
const cw_mesh *cli_part_mesh(const cli_study *study);

/* Measures a mesh for any family: field, back, truth, and bytes of its file unless these are
 * known. For a shown point, adds its picture and the shapes of its triangles. */
CW_NODISCARD cw_status cli_measure_mesh(cli_study *study, cli_point *point, const cw_mesh *mesh,
                                        cw_error *err);

/* Writes a mesh and tells how large the file is; path (NULL: nobody wants it) is in static
 * memory, and the caller's to remove. */
CW_NODISCARD cw_status cli_weigh_mesh(cli_study *study, const cw_mesh *mesh,
                                      const cw_write_desc *desc, size_t *bytes,
                                      const char **path, cw_error *err);

/* A picture of a mesh (from where all of another is seen), as a PNG in memory, in colours of
 * the distance at each vertex: from 0.001 to 1 voxel, by the logarithm. */
CW_NODISCARD cw_status cli_draw_errors(cli_study *study, const cw_mesh *around,
                                       const cw_mesh *mesh, const float *mm, char **png,
                                       size_t *size, cw_error *err);
size_t cli_share_of(const cli_study *study, double share); /* of the plain triangles */
void cli_error_color(double share, uint8_t rgb[3]);        /* 0 to 1 along that scale */

/* The most memory that was taken since. */
typedef struct cli_watch {
    size_t before;
    bool works;
} cli_watch;
cli_watch cli_watch_memory(void);
size_t cli_watched_bytes(const cli_watch *watch);

/* Whether the time is up, Ctrl-C aside. */
bool cli_time_is_up(const cli_study *study);

/* A word as a shell takes it, in quotes where needed. */
void cli_put_word(FILE *out, const char *word);

/* The page, and the same facts for programs. */
void cli_put_page(FILE *out, const void *study);
void cli_put_study_json(FILE *out, const void *study);
void cli_put_study_csv(FILE *out, const void *study);

/* Cells of CSV: text in quotes; a comma and a number, or nothing if it is not known. */
void cli_put_cell(FILE *out, const char *text);
void cli_put_number(FILE *out, bool known, double value);

/* Parts of the page. */
extern const char *const cli_page_style[]; /* pieces; the last is NULL */
extern const char cli_page_script[];
void cli_put_html(FILE *out, const char *text); /* escaped */
void cli_put_plot(FILE *out, const cli_study *study, cli_family family);
void cli_put_shapes(FILE *out, const cw_shapes *shapes);
size_t cli_point_number(const cli_study *study, const cli_point *point); /* in its family */
size_t cli_family_groups(const cli_study *study, cli_family family, const char **groups,
                         size_t most);

#endif
