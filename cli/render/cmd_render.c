/* The command render: its table of options, and the run that checks, makes and reports the
 * pictures. */
#include "cli/framework/batch.h"
#include "cli/framework/commands.h"
#include "cli/framework/console.h"
#include "cli/render/render_run.h"
#include "core/base/status.h"

#include <stdint.h>
#include <string.h>

static const render_args defaults = {.scene = CLI_SCENE_DEFAULTS,
                                     .size = {.count = 2, .n = {1280, 720, 0}}};

static const cli_option options[] = {
    {"output", 'o', CLI_TEXT, "FILE",
     "Picture to write, a .png file; - is the standard output; may hold {turn}, {step} or {step:04d}, {stem} and {parent}",
     offsetof(render_args, output), CLI_VALUES_PNG},
#include "cli/render/options_what.inc"
    {"size", 0, CLI_SIZES, "WxH", "Size of the picture in pixels (1280x720)",
     offsetof(render_args, size)},
    {"backend", 0, CLI_CHOICE, "auto/egl/cpu",
     "OpenGL without a display, or the CPU for meshes, projection, vbuffer and reference "
     "(auto)",
     offsetof(render_args, backend)},
    CLI_JSON_OPTION(render_args),
    {"save-tf", 0, CLI_TEXT, "FILE", "File to write the transfer function to, as .json",
     offsetof(render_args, save_transfer), CLI_VALUES_JSON},
    CLI_COLOR_OPTIONS(render_args),
    CLI_HEADED("Camera"),
#include "cli/render/options_camera.inc"
    {"save-camera", 0, CLI_TEXT, "FILE", "File to write the camera to, as .json",
     offsetof(render_args, save_camera), CLI_VALUES_JSON},
    {"turntable", 0, CLI_COUNT, "N", "Number of pictures around the up axis (1)",
     offsetof(render_args, turns) + offsetof(cli_turns, count)},
    {"orbit", 0, CLI_NUMBER, "DEG", "Angle of the turntable in degrees (360)",
     offsetof(render_args, turns) + offsetof(cli_turns, orbit)},
#include "cli/render/options_labels.inc"
#include "cli/render/options_look.inc"
    CLI_BATCH_OPTIONS(render_args),
    CLI_INPUT_OPTIONS(render_args),
};

static const cli_rule rules[] = {
    {NULL, CLI_NEEDS, "output"},
    {"mesh", CLI_EXCLUDES, "iso"},
    {"difference", CLI_NEEDS, "compare"},
    {"compare", CLI_EXCLUDES, "layout=quad overlay"},
    {"colormap range", CLI_NEEDS, "color-by"},
    {"color-by", CLI_EXCLUDES, "color overlay"},
    {"isolines", CLI_NEEDS, "iso"},
    {"isolines", CLI_NEEDS, "mode=slices layout=quad"},
    {"overlay-opacity overlay-map overlay-range", CLI_NEEDS, "overlay"},
    CLI_SCENE_RULES,
};

_Static_assert(sizeof options / sizeof *options <= CLI_MAX_OPTIONS, "rows of options");

static cw_status run_render(void *p, cw_error *err)
{
    const render_args *args = p;
    const double start = cli_seconds();
    cli_pictures pictures = {
        .command = &cli_render, .args = args, .coloring.args = &args->color, .start = start};
    cli_console_reserve_stdout(args->json);
    cw_status st = cli_check_pictures(args, err);
    const bool writable = st == CW_OK; /* a report, too, is checked before it is written */
    if (st == CW_OK)
        st = cli_make_pictures(&pictures, err);
    cli_render_report report = cli_report_pictures(&pictures);
    report.seconds = cli_seconds() - start;
    st = cli_render_report_write(writable ? args->json : NULL, &report, st, err);
    cli_end_pictures(&pictures);
    return st;
}

const cli_command cli_render = {
    .name = "render",
    .usage = "VOLUME|MESH -o PNG [options]",
    .about = "Draw a volume, a mesh or an isosurface to a picture, without a display",
    .page = cli_page_render,
    .options = options,
    .option_count = sizeof options / sizeof *options,
    .rules = rules,
    .rule_count = sizeof rules / sizeof *rules,
    .min_inputs = 1,
    .max_inputs = SIZE_MAX,
    .inputs = CLI_VALUES_SCENE,
    .size = sizeof(render_args),
    .defaults = &defaults,
    .run = run_render,
};
