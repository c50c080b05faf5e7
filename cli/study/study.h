/* Settings tried on one volume: what each costs, how far it is from the truth, and which are
 * worth choosing. */
#ifndef CLI_STUDY_STUDY_H
#define CLI_STUDY_STUDY_H

#include "cli/render/scene_options.h"
#include "cli/results/printability.h"
#include "cli/study/packed_mesh.h"

#include <cubewright/distance.h>
#include <cubewright/extract.h>
#include <cubewright/field.h>
#include <cubewright/quality.h>

typedef enum cli_family {
    CLI_EXTRACTION,
    CLI_SIMPLIFICATION,
    CLI_COMPRESSION,
    CLI_RENDERING,   /* unlit, against the rendering integral */
    CLI_SHADING,     /* lit, against the lit integral */
    CLI_PROJECTIONS, /* of intensities, each against its own exact one */
    CLI_FAMILY_COUNT
} cli_family;

extern const char *const cli_family_names[CLI_FAMILY_COUNT];

/* Whether points of a family are pictures of the volume; else they are meshes. */
static inline bool cli_is_drawn(cli_family family)
{
    return family >= CLI_RENDERING;
}

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
    double fraction;  /* or that share of the triangles */
    cw_compression compression;
    int bits;
    cw_mode mode; /* rendering */
    cli_scene scene;
    size_t reference; /* which of the study's */
} cli_tried;

enum { CLI_NAME_CAPACITY = 64, CLI_WHY_CAPACITY = 512, CLI_MAX_RUNS = 3 };

/* A PNG in memory; zeroed: none. */
typedef struct cli_png {
    char *bytes; /* owned; free() */
    size_t size;
} cli_png;

/* One setting: what it is, and what came of it. */
typedef struct cli_point {
    cli_family family;
    int rank;                     /* the lower, the sooner it is tried */
    const char *group;            /* of its kind in the family */
    char name[CLI_NAME_CAPACITY]; /* of the setting */
    cli_tried tried;
    bool shown;  /* its mesh is drawn, its triangles' shapes are kept */
    bool turned; /* its mesh is for the view of three dimensions, too */

    bool done;
    char why[CLI_WHY_CAPACITY]; /* if not: why it was left out */
    const char *aside;          /* why it is not compared with the others; NULL: it is */
    char *command;              /* that does it; owned */
    double seconds;             /* the median of the runs */
    size_t runs;
    double times[CLI_MAX_RUNS];
    size_t peak_bytes; /* beyond what the process had before; 0: unknown */
    size_t triangles, file_bytes;
    size_t measured_one_of; /* one of n triangles was measured */
    cli_gap to_field;       /* from its vertices and triangles to the field's surface */
    cli_gap back;           /* from the plain surface's vertices to it */
    cli_gap truth;          /* to the surface that is known on paper */
    cw_comparison picture;
    cw_shapes shapes;
    cli_png drawn;      /* the mesh in colours of its error; of rendering: the picture */
    cli_png difference; /* of rendering: to the reference, amplified */
    cli_packed packed;  /* of a turned mesh */
    bool front;         /* no other is both cheaper and closer */
    size_t number;      /* in its family, by rising cost; 0: not done */
} cli_point;

/* Which number of a point is its cost, which its error; and what they are called. */
typedef struct cli_axis {
    const char *cost, *cost_unit, *error, *error_unit;
} cli_axis;

/* Limits of a study: the size of pictures, the factor of the differences that are shown, and
 * the number of triangles that are sampled for errors where a mesh has more. */
enum {
    CLI_STUDY_SAMPLE = 25000,
    CLI_MAX_POINTS = 96,
    CLI_STUDY_WIDTH = 320,
    CLI_STUDY_HEIGHT = 240,
    CLI_STUDY_AMPLIFY = 16
};

/* The picture that others are compared with: exact, and of their kind. */
typedef struct cli_reference {
    cw_transfer transfer;
    double box[2][3];   /* that the camera sees */
    cw_picture picture; /* empty: not yet */
    double seconds;
    cli_png drawn;
} cli_reference;

enum { CLI_REFERENCES = 6 }; /* unlit, lit, and those of four projections */

/* The plain surface as a print. */
typedef struct cli_print_study {
    char why[CLI_WHY_CAPACITY]; /* it was not measured; empty: it was */
    cli_printed seen;
} cli_print_study;

/* Pictures of the object of a study. */
typedef struct cli_overview {
    char why[CLI_WHY_CAPACITY]; /* something was not drawn; empty: all was */
    cli_png object;             /* the plain surface in the colour of bone */
    cli_png slice;              /* through the middle of the object, with its contour */
    char slice_words[96];       /* which slice that is */
    cw_statistics values;       /* with bins; zeroed: none */
} cli_overview;

typedef struct cli_study {
    /* what is studied: set before cli_study_run() */
    cli_volume *volume;
    bool is_of_mesh; /* the volume is the source of a mesh, which is full */
    bool is_field;   /* one whose surface is known on paper: */
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
    double extra_deadline; /* of work for the page alone, while it runs; else 0 */
    cli_print_study print;
    cli_overview overview;
    cw_mesh full; /* the plain surface, of all voxels */
    bool part_chosen;
    cli_volume part;     /* borrowed: what is simplified and compressed, the volume or a box */
    cw_mesh part_mesh;   /* its plain surface; of no box: empty */
    char part_words[96]; /* of commands: that box */
    cli_png part_drawn;  /* its plain surface in colours of its error; of no box: none */
    char *folder;        /* for files that are measured; owned */
    cw_renderer *renderer; /* NULL: not yet, or none */
    cw_renderer *cpu;      /* the same, on the CPU */
    char backend[256];     /* its name */
    cw_volume drawn;       /* borrowed */
    double drawn_level;    /* between two classes of its values */
    cli_reference references[CLI_REFERENCES];
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

/* The work of a point that is timed, which adds a run to it. */
CW_NODISCARD cw_status cli_run_extraction(cli_study *study, cli_point *point, cw_mesh *mesh,
                                          cw_error *err);
CW_NODISCARD cw_status cli_run_simplification(cli_study *study, cli_point *point, cw_mesh *mesh,
                                              cw_error *err);
CW_NODISCARD cw_status cli_run_compression(cli_study *study, cli_point *point,
                                           const char **path, cw_error *err);
CW_NODISCARD cw_status cli_try_rendering(cli_study *study, cli_point *point, cw_error *err);

/* Chooses the part that is simplified and compressed, and extracts it. */
CW_NODISCARD cw_status cli_need_part(cli_study *study, cw_error *err);
const cw_mesh *cli_part_mesh(const cli_study *study);
double cli_part_ratio(const cli_study *study); /* of the longest sides of all and the part */

/* Measures a mesh for any family: field, back, truth, and bytes of its file unless these are
 * known. For a shown point, adds its picture and the shapes of its triangles. */
CW_NODISCARD cw_status cli_measure_mesh(cli_study *study, cli_point *point, const cw_mesh *mesh,
                                        cw_error *err);

/* Writes a mesh and tells how large the file is; path (NULL: nobody wants it) is in static
 * memory, and the caller's to remove. */
CW_NODISCARD cw_status cli_weigh_mesh(cli_study *study, const cw_mesh *mesh,
                                      const cw_write_desc *desc, size_t *bytes,
                                      const char **path, cw_error *err);

/* Draws a mesh (from where all of another is seen), in colours of the distance at each vertex:
 * from 0.001 to 1 voxel, by the logarithm. mm: NULL for its own colours. */
CW_NODISCARD cw_status cli_draw_mesh(cli_study *study, const cw_mesh *around,
                                     const cw_mesh *mesh, const float *mm, cli_png *png,
                                     cw_error *err);

/* Packs a mesh for the view of three dimensions, with the distance at each vertex. One of more
 * than CLI_PACKED_TRIANGLES is simplified to as many, if the time allows. */
CW_NODISCARD cw_status cli_pack_errors(cli_study *study, const cw_mesh *mesh, const float *mm,
                                       cli_packed *packed, cw_error *err);
double cli_error_share(double mm, double voxel_mm); /* along the scale of colours */

/* Makes a PNG in memory. */
CW_NODISCARD cw_status cli_make_png(const cli_study *study, const cw_image *image, cli_png *png,
                                    cw_error *err);

/* Draws what is studied. What keeps it from that is kept, too.
 * Returns  CW_ERR_CANCELLED  by who waits for it */
CW_NODISCARD cw_status cli_study_overview(cli_study *study, cw_error *err);

/* Repeats what was timed once, the fastest first, until there are CLI_MAX_RUNS of all, or the
 * budget is spent. */
CW_NODISCARD cw_status cli_time_again(cli_study *study, cw_error *err);
void cli_add_run(cli_point *point, double seconds);
size_t cli_share_of(const cw_mesh *mesh, double fraction); /* of its triangles, at least 1 */
void cli_error_color(double fraction, uint8_t rgb[3]);     /* 0 to 1 along that scale */

/* The most memory that was taken since. */
typedef struct cli_watch {
    size_t before;
    bool works;
} cli_watch;
cli_watch cli_watch_memory(void);
size_t cli_watched_bytes(const cli_watch *watch);

/* Returns the distance that counts as a point's error: to the true surface of a field, else to
 * the field's, else from the plain surface. NULL: none was measured. */
const cli_gap *cli_main_gap(const cli_study *study, const cli_point *point);

/* Whether the time is up, Ctrl-C aside. */
bool cli_time_is_up(const cli_study *study);

/* Advice: a setting for each purpose, by the measurements. */
typedef struct cli_advice {
    const char *purpose;    /* "For print" */
    const cli_point *point; /* the setting */
    char why[512];          /* with measured numbers */
    char *command;          /* owned; NULL: no memory */
} cli_advice;
enum { CLI_MAX_ADVICE = 4 };
size_t cli_find_advice(const cli_study *study, cli_advice advice[CLI_MAX_ADVICE]);
void cli_free_advice(cli_advice *advice, size_t count);

/* The same facts for programs. */
void cli_put_study_json(FILE *out, const void *study);
void cli_put_study_csv(FILE *out, const void *study);

/* The points of a family that are done, by their number. Returns how many there are. */
size_t cli_points_of(const cli_study *study, cli_family family,
                     const cli_point *points[CLI_MAX_POINTS]);

/* Costs of a point that plots may have along their axis. */
typedef enum cli_cost {
    CLI_COST_TIME,
    CLI_COST_TRIANGLES,
    CLI_COST_BYTES,
    CLI_COST_MEMORY,
    CLI_COST_COUNT
} cli_cost;
cli_cost cli_main_cost(cli_family family);
double cli_cost_of(const cli_point *point, cli_cost cost); /* NaN: not known */

#endif
