/* The work of render: from inputs to pictures. */
#ifndef CLI_RENDER_RENDER_RUN_H
#define CLI_RENDER_RENDER_RUN_H

#include "cli/inputs/label_scene.h"
#include "cli/inputs/scene_source.h"
#include "cli/render/camera_options.h"
#include "cli/render/overlay_options.h"
#include "cli/render/render_report.h"
#include "cli/render/slice_labels.h"
#include "cli/render/value_overlay.h"
#include "cli/results/color_by.h"

/* The command (cmd_render.c). */
extern const cli_command cli_render;

typedef struct render_args {
    cli_common common;
    cli_input input;
    cli_scene scene;
    cli_turns turns;
    cli_marks marks;
    cli_label_look look;
    cli_value_look values; /* of overlay */
    cli_color_args color;
    const char *exec, *run, *config, *recent, *film; /* of view alone, */
    bool hidden, light_theme;                        /* and these, */
    cli_number fps;                                  /* and these */
    int live_surface;
    const char *output, *json, *mesh, *save_transfer, *save_camera, *compare, *overlay;
    cli_number iso, difference, overlay_opacity;
    int inside, backend;
    cli_sizes size;
    size_t samples;
    cli_steps steps;
} render_args;

#define CLI_SCENE_DEFAULTS                                                                     \
    {                                                                                          \
        .lit = true, .minip_inside = true, .preintegration = true, .skipping = true            \
    }

/* For the rows of options_what.inc, options_camera.inc, options_look.inc and
 * options_labels.inc. */
#define CLI_SCENE_AT(field) offsetof(render_args, scene) + offsetof(cli_scene, field)
#define CLI_MARKS_AT(field) offsetof(render_args, marks) + offsetof(cli_marks, field)
#define CLI_LOOK_AT(field)  offsetof(render_args, look) + offsetof(cli_label_look, field)

/* One side of --compare: the run's arguments, changed. */
typedef struct cli_side {
    render_args args;
    cw_mode mode;
    cw_transfer transfer;
    char *words[32];
    int word_count;
} cli_side;

typedef struct cli_split {
    cli_side sides[2];
} cli_split;

/* A run as far as it has come. Free with cli_end_pictures(). */
typedef struct cli_pictures {
    const cli_command *command;
    const render_args *args;
    cli_number iso;    /* of args, as a number */
    cli_source source; /* its mesh: what is seen beside the volume, or by itself */
    cw_mode mode;
    cli_label_look look; /* labels: NULL where none are drawn */
    cli_label_scene labels;
    cli_volume overlay; /* another volume, with labels */
    cli_slice_labels on_slices;
    cli_coloring coloring;
    cw_transfer transfer;
    double level;      /* between two classes of values */
    bool has_transfer; /* of all steps */
    double box[2][3];  /* box that the cameras see: of the first step, kept as well */
    bool has_box;
    cw_scene scene;        /* the latest */
    cw_renderer *renderer; /* NULL: none was needed */
    cli_shot *shots;
    size_t shot_count;
    double start;
    cli_split *split; /* NULL: nothing is compared */
} cli_pictures;

/* Checks everything that can be refused before the input is touched. */
CW_NODISCARD cw_status cli_check_pictures(const render_args *args, cw_error *err);

/* Reads what there is to see, draws and writes all pictures. */
CW_NODISCARD cw_status cli_make_pictures(cli_pictures *p, cw_error *err);
void cli_end_pictures(cli_pictures *p);

/* Returns the content of the report of a run. */
cli_render_report cli_report_pictures(const cli_pictures *p);

#endif
