/* The options that say what a picture shows and how, and the scene they make. */
#ifndef CLI_RENDER_SCENE_OPTIONS_H
#define CLI_RENDER_SCENE_OPTIONS_H

#include "cli/inputs/volume_input.h"

#include <cubewright/render.h>

typedef struct cli_scene {
    int mode;             /* 0: by what there is to see; else 1 + cw_mode */
    cw_mode reference_of; /* of a side of --compare; no option */
    const char *transfer, *gradient_opacity, *camera, *lights, *background, *color, *clips,
        *planes;
    cli_number shift, opacity, surface_width, gradient_smoothing, fov, zoom;
    bool ortho;
    bool lit;
    cli_number ambient, diffuse, specular, shininess, depth_cue;
    int lambert;
    cli_numbers cue_range;
    int cue_form;
    cli_ranges clip_box;
    bool cut_away;
    int hide;
    cli_number step, stop_opacity, threshold;
    size_t slices, texture_edge, normals;
    bool minip_inside, cell_steps, preintegration, jitter, exact_filter, skipping;
    int target;
    int direction_filter;
    bool material_table, colors_first, boundary, linear_opacity, pixel_area;
    cli_number tree_error;
    size_t splat_budget;
    int shadow;
    int splat_kernel;
    cli_number splat_width;
    int tint;
    cli_numbers tint_range;
    bool wireframe, cap;
} cli_scene;

enum { CLI_HIDE_NONE, CLI_HIDE_MESH, CLI_HIDE_VOLUME };

#define CLI_MODE_CHOICE(name, text, about, source) "/" text
#define CLI_MODE_CHOICES                           "auto" CW_MODE_TABLE(CLI_MODE_CHOICE)

/* Subject of a picture. */
typedef struct cli_subject {
    const cw_volume *volume; /* evenly spaced; NULL: none */
    const cw_volume *whole;  /* the file's, whose voxels --clip-box counts; NULL: none */
    const cw_mesh *mesh;     /* NULL: none */
    double level;            /* between two classes of values: the threshold by default */
    int threads;
} cli_subject;

/* Fails with the modes that an option is for, or what it needs, when one was given that does
 * nothing: to this mode, without a volume, without a mesh. */
CW_NODISCARD cw_status cli_check_scene(const cli_command *command, const cli_common *common,
                                       cw_mode mode, bool has_mesh, cw_error *err);

/* Whether an option of that name sets how one picture looks. */
bool cli_is_setting(const char *name);

/* Whether an option of that name does something in a mode, with or without a mesh. */
bool cli_setting_fits(const char *name, cw_mode mode, bool has_mesh);

/* The first option given of those that only OpenGL draws of a mesh; NULL: none. */
const char *cli_needs_gl(const cli_command *command, const cli_common *common,
                         const cli_scene *args);

/* A colour such as #ffeedd, #fed, #ffeedd80 or a name. */
bool cli_parse_color(const char *text, uint8_t rgba[4]);

/* Top and bottom colours: as requested, else dark, the same in all modes. CW_ERR_ARGUMENT */
CW_NODISCARD cw_status cli_background(const cli_scene *args, uint8_t background[2][4],
                                      cw_error *err);

/* Finds the level that separates the values into two classes [Otsu1979], else their middle. */
double cli_class_level(const cw_statistics *statistics);

/* Bins of the histograms that transfer functions are fitted to. */
enum { CLI_TRANSFER_BINS = 1024 };

/* The transfer function for a volume: a preset, a file or JSON text, shifted and scaled. What
 * looks wrong is said.
 * Returns CW_ERR_ARGUMENT for an unknown preset; as cw_transfer_read() */
CW_NODISCARD cw_status cli_make_transfer(const cli_scene *args, const cw_volume *volume,
                                         cw_mode mode, int threads, cw_transfer *transfer,
                                         cw_error *err);

/* The same, when the statistics of its values are there. */
CW_NODISCARD cw_status cli_fit_transfer(const cli_scene *args, const cw_volume *volume,
                                        cw_mode mode, const cw_statistics *statistics,
                                        cw_transfer *transfer, cw_error *err);

/* Shifts and scales one. CW_ERR_ARGUMENT */
CW_NODISCARD cw_status cli_change_transfer(const cli_scene *args, cw_transfer *transfer,
                                           cw_error *err);

/* The whole scene but camera, size and samples, which are there before: slices are counted
 * along the line of sight. What it points to is borrowed.
 * Returns CW_ERR_ARGUMENT for texts that are not understood, naming the option */
CW_NODISCARD cw_status cli_make_scene(const cli_scene *args, const cli_subject *subject,
                                      cw_mode mode, const cw_transfer *transfer,
                                      cw_scene *scene, cw_error *err);

/* Rules of commands with the options of scenes. */
#define CLI_SCENE_RULES                                                                        \
    {"ortho", CLI_EXCLUDES, "fov"}, {"cut-away", CLI_NEEDS, "clip-box clip"},                  \
        {"depth-cue-range depth-cue-form", CLI_NEEDS, "depth-cue"},                            \
    {                                                                                          \
        "tint-range", CLI_NEEDS, "tint=scalars"                                                \
    }

#endif
