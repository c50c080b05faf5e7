/* Declares the arguments, state and steps that the files of the command extract share. */
#ifndef CLI_EXTRACT_EXTRACT_RUN_H
#define CLI_EXTRACT_EXTRACT_RUN_H

#include "cli/assets/asset_profile.h"
#include "cli/extract/pixel_proof.h"
#include "cli/framework/quantity.h"
#include "cli/inputs/place_options.h"
#include "cli/results/animation_frames.h"
#include "cli/results/color_by.h"
#include "cli/results/output_names.h"
#include "cli/results/write_result.h"

/* The command (cmd_extract.c). */
extern const cli_command cli_extract;

typedef struct cli_extract_args {
    cli_common common;
    cli_input input;
    cli_compress compress;
    const char *output, *name, *format, *json, *pvd;
    const char *labels, *names, *table, *probabilities;
    cli_length smooth_labels;
    bool require_labels, shared_faces, per_label;
    cli_numbers iso;
    cli_steps steps;
    cli_number snap, fps;
    cli_reduction simplify;
    cli_counts lod;
    cli_amount least;
    size_t largest; /* components to keep; 0: all */
    bool fill_voids;
    cli_length handles;
    cli_number crease, orient_print;
    cli_smoothing smooth;
    cli_plane cut;
    const char *engrave;
    cli_length max_move;
    cli_color_args color;
    int profile; /* CLI_PROFILE_... */
    cli_texture_args texture;
    bool fills_levels; /* the profile has set lod */
    int pivot;         /* as of cli_placing */
    cli_printer printer;
    cli_pixel_args pixel;
    int inside, normals, progress, topology, placement, accel;
    bool open, no_clobber, local, check, measure, animate, prove_crop;
    const char *part, *manifest;
    size_t parts;
    int stream;
    size_t max_triangles, slab;
} cli_extract_args;

/* Choices of --profile. */
enum { CLI_PROFILE_NONE, CLI_PROFILE_PRINT, CLI_PROFILE_ASSETS };

/* Decisions made before a surface is extracted. */
typedef struct cli_extract_plan {
    cw_simplify_view views[CLI_MAX_VIEWS];
    size_t view_count;
    double fps; /* of --animate; 0: as the file times its steps */
} cli_extract_plan;

/* The volume at hand, and the series that it is a step of. */
typedef struct cli_extract_input {
    cli_series series;
    cli_volume first;        /* of a series of files, without voxels: shown in the report */
    cli_volume volume;       /* of the step at hand */
    size_t memory;           /* left when its voxels were read */
    cw_extractor *extractor; /* NULL: every surface by itself */
    bool turned;             /* voxels were read, and freed again: they come slice by slice */
} cli_extract_input;

/* Files to write, and the record of what was made. */
typedef struct cli_extract_output {
    cli_outputs files;
    cli_frames frames; /* of --animate */
    cli_report report;
    cli_maps maps; /* of the surface at hand */
    double start;  /* the same */
} cli_extract_output;

/* A run of the command. */
typedef struct cli_extract_run {
    const cli_extract_args *args;
    cli_numbers *iso; /* of args: names become numbers when a volume is read */
    cli_extract_plan plan;
    cli_extract_input input;
    cli_coloring coloring; /* of --color-by */
    cli_extract_output output;
} cli_extract_run;

enum { CLI_EXTRACT_PROVENANCE = 9 };

/* ---- arguments --------------------------------------------------------------------------- */

/* Everything about them that can be refused before the input is touched. */
CW_NODISCARD cw_status cli_extract_check_args(cli_extract_run *s, cw_error *err);

/* Returns the profile of a mesh that is drawn; NULL: none was chosen. */
const cli_asset *cli_extract_asset(const cli_extract_args *args);

/* Sets what a profile asks for and was not given. */
void cli_extract_fill_profile(cli_extract_args *args);

/* Refuses stages that exclude each other, or that a source excludes: labels, or the volume. */
CW_NODISCARD cw_status cli_check_stages(const cli_extract_args *args, cw_surface_source source,
                                        cw_error *err);

/* Returns an option that needs the whole volume or surface in memory; NULL: slices, or parts of
 * them, suffice. In static memory. */
const char *cli_find_unstreamed(const cli_extract_args *args, cw_surface_source source);

/* Names and checks the outputs, once it is known of which steps there will be one. */
CW_NODISCARD cw_status cli_extract_check_outputs(cli_extract_run *s, cw_error *err);

/* Fails for several steps beside --lod. */
CW_NODISCARD cw_status cli_extract_check_lod_steps(const cli_extract_run *s, cw_error *err);

cw_write_desc cli_extract_write_desc(const cli_extract_args *args);

/* ---- facts ------------------------------------------------------------------------------- */

/* Returns the edge of a cube of a voxel's volume, and a length in millimetres: shares are of the
 * diagonal of the volume's box. */
double cli_volume_voxel_mm(const cli_volume *volume);
double cli_volume_length_mm(const cli_volume *volume, const cli_length *length);

/* Refuses an error limit that leaves little of the shape, but with --force. Hidden parts of a camera's
 * scene may be simplified as far as one likes. */
CW_NODISCARD cw_status cli_extract_check_error(const cli_extract_args *args,
                                               const cli_volume *volume, cw_error *err);

double cli_extract_voxel_mm(const cli_extract_run *s);

/* Shares are of the diagonal of the volume's box. */
double cli_extract_length_mm(const cli_extract_run *s, const cli_length *length);
double cli_extract_error_mm(const cli_extract_run *s);

/* Returns the settings of --close-handles. */
cw_close_handles_desc cli_extract_handles(const cli_extract_args *args,
                                          const cli_volume *volume);

/* Returns the settings of --smooth. */
cw_smooth_desc cli_extract_smoothing(const cli_extract_args *args, const cli_volume *volume);

/* Returns the minimum volume that a component encloses; 0: no minimum. */
double cli_extract_least_mm3(const cli_extract_args *args, const cli_volume *volume);

bool cli_extract_is_low(const cli_extract_run *s);
bool cli_extract_is_simplified(const cli_extract_args *args);

/* Returns true if levels of detail get normals of the field; else they keep those of the surface. */
bool cli_extract_shades_levels(const cli_extract_run *s);

/* How far normals may turn, in degrees. */
double cli_extract_shading(const cli_extract_args *args);

/* Of the report: settings, and the files of a series. p is the run. */
void cli_extract_put_params(cli_json *j, const void *p, const cli_made *made);
void cli_extract_put_series(cli_json *j, const void *p);

/* Texts that the lines of a record point to. */
typedef struct cli_making {
    char level[32], handles[48], smooth[96], simplify[64];
} cli_making;

/* Writes how the surface of level n was made, for the record in its file; returns the number of lines.
 * Names of files are left out: they may be names of patients. */
size_t cli_extract_provenance(const cli_extract_run *s, size_t n, cli_making *making,
                              cw_provenance lines[CLI_EXTRACT_PROVENANCE]);

/* ---- a surface --------------------------------------------------------------------------- */

/* Sets the stages that options ask for, of surfaces and of labels. Those that simplify follow. */
void cli_extract_describe_stages(const cli_extract_args *args, const cli_volume *volume,
                                 cli_surface_settings *settings);

/* Says what the stages did. */
void cli_extract_tell_stages(cli_extract_run *s, cli_made *made);

/* Computes the settings of the surface at an isovalue. They point into each other. */
CW_NODISCARD cw_status cli_extract_describe(const cli_extract_run *run, double iso,
                                            cli_surface_settings *settings, cw_error *err);

/* Runs the pipeline on the volume at hand, fills made->facts, and says what the stages did.
 * moment: of a series; NULL: the only step */
CW_NODISCARD cw_status cli_extract_run_pipeline(cli_extract_run *s, const cli_moment *moment,
                                                cli_made *made, cw_pipeline_sink sink,
                                                cw_error *err);

/* Encodes the maps that come with a surface, or with level 0. */
CW_NODISCARD cw_status cli_extract_take_maps(cli_extract_run *s,
                                             const cw_pipeline_surface *surface, cw_error *err);

/* Does the same for one surface. */
CW_NODISCARD cw_status cli_extract_make(cli_extract_run *s, const cli_moment *moment,
                                        cli_made *made, cw_mesh *mesh, cw_error *err);

/* Reports how many triangles a simplified surface had before, and measures the distance of a
 * simplified or smoothed one from the field if the voxels are in memory. */
CW_NODISCARD cw_status cli_extract_judge(cli_extract_run *s, cli_made *made,
                                         const cw_mesh *mesh, cw_error *err);

/* Turns the finished surface for printing, if that was asked for, and then moves it to its pivot. */
CW_NODISCARD cw_status cli_extract_place(cli_extract_run *s, cli_made *made, cw_mesh *mesh,
                                         cw_error *err);

/* Judges the surface of --profile print once it is written. */
CW_NODISCARD cw_status cli_extract_judge_print(cli_extract_run *s, cli_made *made,
                                               const cw_mesh *mesh, cw_error *err);

/* Returns the number of components to keep; 0: all. A print is the largest one, unless it is said
 * otherwise. */
size_t cli_extract_largest(const cli_extract_args *args);

/* Measures what --camera and --max-error promise. */
CW_NODISCARD cw_status cli_extract_prove(cli_extract_run *s, cli_made *made,
                                         const cw_mesh *mesh, cw_error *err);

/* Measures what --crop saved, if that is asked for. */
CW_NODISCARD cw_status cli_extract_prove_crop(cli_extract_run *s, const cli_moment *moment,
                                              cli_made *made, cw_error *err);

/* Returns how the surfaces of the run are written, without the record of their making. */
cli_delivery cli_extract_describe_delivery(const cli_extract_run *s);

/* Makes and writes the levels of detail of the surface: --lod. */
CW_NODISCARD cw_status cli_extract_make_lod(cli_extract_run *s, cw_error *err);

#endif
