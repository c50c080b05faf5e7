#include "cli/commands.h"
#include "cli/console.h"
#include "cli/picture_run.h"
#include "core/status.h"

#include <stdint.h>
#include <string.h>

static const render_args defaults = {.scene = CLI_SCENE_DEFAULTS,
                                     .size = {.count = 2, .n = {1280, 720, 0}}};

static const cli_option options[] = {
    {"output", 'o', CLI_TEXT, "FILE",
     "the picture, a .png; may hold {turn}, {step} (or {step:04d}) and {stem}",
     offsetof(render_args, output)},
#include "cli/options_what.inc"
    {"size", 0, CLI_SIZES, "WxH", "of the picture, in pixels (1280x720)",
     offsetof(render_args, size)},
    {"backend", 0, CLI_CHOICE, "auto/egl/cpu",
     "OpenGL without a display, or the CPU: meshes, vbuffer, reference (auto)",
     offsetof(render_args, backend)},
    {"json", 0, CLI_TEXT, "FILE", "write a report; - is the standard output",
     offsetof(render_args, json)},
    {"save-tf", 0, CLI_TEXT, "FILE", "write the transfer function as a .json file",
     offsetof(render_args, save_transfer)},
    CLI_HEADED("Camera"),
#include "cli/options_camera.inc"
    {"save-camera", 0, CLI_TEXT, "FILE", "write the camera as a .json file",
     offsetof(render_args, save_camera)},
    {"turntable", 0, CLI_COUNT, "N", "N pictures around the up axis (1)",
     offsetof(render_args, turns) + offsetof(cli_turns, count)},
    {"orbit", 0, CLI_NUMBER, "DEG", "how far round they go (360)",
     offsetof(render_args, turns) + offsetof(cli_turns, orbit)},
#include "cli/options_look.inc"
    CLI_HEADED("Reading"),
    CLI_INPUT_OPTIONS(render_args),
};

static cw_status run(void *p, cw_error *err)
{
    const render_args *args = p;
    const double start = cli_seconds();
    cli_pictures pictures = {.command = &cli_render, .args = args, .start = start};
    if (args->json && strcmp(args->json, "-") == 0)
        cli_results_to_stderr();
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
    .about = "a picture of a volume, a mesh, or the surface at an isovalue; needs no display",
    .more =
        "Draws a volume in one of the classic modes, a mesh in its colours if it has some, or\n"
        "the surface that extract makes of a volume. A mesh by itself is drawn on the CPU in\n"
        "double precision, lit from the camera, its inside red; volumes, and meshes that are\n"
        "cut, tinted or see-through, by OpenGL off-screen. Several volumes are a time series.\n"
        "Without --tf a transfer function is fitted to the histogram: air goes, the rest "
        "fades\n"
        "in. That of mip, minip, average and slices is grey.\n\n"
        "Modes\n"
        "  mesh            triangles, lit\n"
        "  composite       ray casting: emission and absorption\n"
        "  mip, minip      the highest, the lowest value along each ray\n"
        "  average         the mean along each ray, as an X-ray\n"
        "  local-mip       the first maximum above --threshold\n"
        "  projection      cells as polygons, back to front   --linear-opacity\n"
        "  splat           footprints, sheet by sheet\n"
        "  splat-tree      footprints of an octree's nodes    --tree-error\n"
        "  texture         slices through a 3D texture        --slices, --target\n"
        "  shaded-texture  ... of quantised gradients         --normals, --boundary\n"
        "  slices          axial, coronal, sagittal, oblique  --planes\n"
        "  vbuffer         ray casting cell by cell, on the CPU\n"
        "  reference       the rendering integral itself, on the CPU\n"
        "--compare draws a scene twice, left and right, and prints how far they are apart "
        "(RMSE\n"
        "in 1/255, CIEDE2000). A side is options by comma without their dashes, the first a\n"
        "mode; what holds for both sides stands outside.\n"
        "An option that does nothing in the mode at hand is an error that names its modes.\n\n"
        "Cameras are named in the patient's frame: front looks at the face, heads are up, and\n"
        "the patient's left is on the right of the picture. 90,0 is left, 0,90 from above.\n\n"
        "Examples\n"
        "  cubewright render head.nii.gz -o head.png\n"
        "  cubewright render ct.nrrd --tf ct-bone --camera iso -o bone.png\n"
        "  cubewright render angio.nrrd --mode mip --turntable 36 -o 'a-{turn:02d}.png'\n"
        "  cubewright render ct.nrrd --mode composite --iso 300 --clip 0,1,0,0 -o cut.png\n"
        "  cubewright render head.nii.gz --iso 50 --camera 30,20 -o head.png\n"
        "  cubewright render ct.nrrd --compare 'composite,step-length=2|reference' -o two.png\n"
        "  cubewright render run.nii.gz --steps all -o 'run-{step:04d}.png'\n"
        "  cubewright render defects.ply -o defects.png\n",
    .options = options,
    .option_count = sizeof options / sizeof *options,
    .min_inputs = 1,
    .max_inputs = SIZE_MAX,
    .size = sizeof(render_args),
    .defaults = &defaults,
    .run = run,
};
