#include "cli/commands.h"
#include "cli/console.h"
#include "cli/picture_run.h"
#include "core/status.h"

#include <stdint.h>
#include <string.h>

static const render_args defaults = {
    .scene = {.camera = "front", .lit = true, .preintegration = true, .skipping = true},
    .size = {.count = 2, .n = {1280, 720, 0}}};

#define SCENE(field) offsetof(render_args, scene) + offsetof(cli_scene, field)
#define MARKS(field) offsetof(render_args, marks) + offsetof(cli_marks, field)
#define HEADING(name)                                                                          \
    {                                                                                          \
        name, 0, CLI_HEADING, NULL, "", 0                                                      \
    }

static const cli_option options[] = {
    {"output", 'o', CLI_TEXT, "FILE",
     "the picture, a .png; may hold {turn}, {step} (or {step:04d}) and {stem}",
     offsetof(render_args, output)},
    {"mode", 'm', CLI_CHOICE, CLI_MODE_CHOICES,
     "how to draw (mesh for meshes and with --iso, else composite)", SCENE(mode)},
    {"iso", 'i', CLI_NUMBER, "V",
     "the surface at an isovalue, by itself or with a --mode beside the volume",
     offsetof(render_args, iso)},
    {"inside", 0, CLI_CHOICE, CLI_INSIDE_CHOICES,
     "which values are inside the solid (auto: above, of level sets below)",
     offsetof(render_args, inside)},
    {"mesh", 0, CLI_TEXT, "FILE", "a mesh to be seen beside the volume (none)",
     offsetof(render_args, mesh)},
    {"hide", 0, CLI_CHOICE, "none/mesh/volume", "what not to draw (none)", SCENE(hide)},
    {"size", 0, CLI_SIZES, "WxH", "of the picture, in pixels (1280x720)",
     offsetof(render_args, size)},
    {"samples", 0, CLI_COUNT, "N", "N x N samples a pixel, 1 to 4 (of meshes 2, else 1)",
     offsetof(render_args, samples)},
    {"background", 0, CLI_TEXT, "C[,C]|none",
     "a colour such as #203040, two from top to bottom, or none (by mode)", SCENE(background)},
    {"backend", 0, CLI_CHOICE, "auto/egl/cpu",
     "OpenGL without a display, or the CPU: meshes, vbuffer, reference (auto)",
     offsetof(render_args, backend)},
    {"compare", 0, CLI_TEXT, "A|B",
     "two pictures in one: settings such as 'texture,step-length=2|reference'",
     offsetof(render_args, compare)},
    {"difference", 0, CLI_NUMBER, "F",
     "of --compare: side by side, and how they differ, F times as strong",
     offsetof(render_args, difference)},
    {"json", 0, CLI_TEXT, "FILE", "write a report; - is the standard output",
     offsetof(render_args, json)},
    HEADING("Camera"),
    {"camera", 0, CLI_TEXT, "VIEW|A,E|FILE",
     "front, back, left, right, top, bottom or iso; azimuth,elevation from the front in "
     "degrees; a .json file or its text, {...} (front)",
     SCENE(camera)},
    {"save-camera", 0, CLI_TEXT, "FILE", "write the camera as a .json file",
     offsetof(render_args, save_camera)},
    {"ortho", 0, CLI_FLAG, NULL, "parallel lines stay parallel (perspective)", SCENE(ortho)},
    {"fov", 0, CLI_NUMBER, "DEG", "how far the camera opens, from top to bottom (30)",
     SCENE(fov)},
    {"zoom", 0, CLI_NUMBER, "F", "show the middle so many times as large (1)", SCENE(zoom)},
    {"turntable", 0, CLI_COUNT, "N", "N pictures around the up axis (1)",
     offsetof(render_args, turns) + offsetof(cli_turns, count)},
    {"orbit", 0, CLI_NUMBER, "DEG", "how far round they go (360)",
     offsetof(render_args, turns) + offsetof(cli_turns, orbit)},
    {"steps", 0, CLI_STEPS, "A:B:S/N,.../all", "steps of a time series, from 0, each drawn",
     offsetof(render_args, steps)},
    HEADING("On the picture"),
    {"axes", 0, CLI_FLAG, NULL, "the edges of the volume's box, and L, P, S (off)",
     MARKS(axes)},
    {"scale-bar", 0, CLI_FLAG, NULL, "a length in mm (off)", MARKS(scale_bar)},
    {"letters", 0, CLI_FLAG, NULL, "where the edges lead: R L A P S I (off)", MARKS(letters)},
    {"color-bar", 0, CLI_FLAG, NULL, "the colours of values, or of a mesh's tint (off)",
     MARKS(color_bar)},
    {"histogram", 0, CLI_FLAG, NULL, "how often values are, under their opacity (off)",
     MARKS(histogram)},
    {"caption", 0, CLI_TEXT, "TEXT", "a line on top (none)", MARKS(caption)},
    {"layout", 0, CLI_CHOICE, "single/quad",
     "quad: with axial, coronal and sagittal slices beside it (single)", MARKS(layout)},
    HEADING("Colours and opacities of a volume"),
    {"tf", 0, CLI_TEXT, "NAME|FILE",
     "auto, ct-bone, ct-soft, ct-skin, mr, mip, grey, xray, fog, level-set; a .json file or "
     "its text, {...} (by mode)",
     SCENE(transfer)},
    {"shift", 0, CLI_NUMBER, "V", "add to all its values (0)", SCENE(shift)},
    {"opacity", 0, CLI_NUMBER, "F", "multiply its opacities (1)", SCENE(opacity)},
    {"save-tf", 0, CLI_TEXT, "FILE", "write it as a .json file",
     offsetof(render_args, save_transfer)},
    HEADING("Light"),
    {"lit", 0, CLI_FLAG, NULL, "shade volumes by their gradient (on; --no-lit)", SCENE(lit)},
    {"light", 0, CLI_TEXT, "X,Y,Z[,R,G,B][;...]",
     "towards up to 4 lights: x right, y up, z to the eye (0,0,1)", SCENE(lights)},
    {"ambient", 0, CLI_NUMBER, "K", "light from everywhere, 0 to 1 (0.25)", SCENE(ambient)},
    {"diffuse", 0, CLI_NUMBER, "K", "light that goes everywhere, 0 to 1 (0.75)",
     SCENE(diffuse)},
    {"specular", 0, CLI_NUMBER, "K", "light that is mirrored, 0 to 1 (0.2)", SCENE(specular)},
    {"shininess", 0, CLI_NUMBER, "N", "how small highlights are, to 1000 (32)",
     SCENE(shininess)},
    {"depth-cue", 0, CLI_NUMBER, "S", "how much of the far end is background, 0 to 1 (0)",
     SCENE(depth_cue)},
    HEADING("What is cut"),
    {"clip-box", 0, CLI_RANGES, "X:X,Y:Y,Z:Z",
     "show what is between these voxels; with units, in a box of LPS mm", SCENE(clip_box)},
    {"clip", 0, CLI_TEXT, "NX,NY,NZ,D[;...]",
     "show all points p with n . p >= d, in mm; up to 12 planes", SCENE(clips)},
    {"cut-away", 0, CLI_FLAG, NULL, "leave that out instead, and show the rest (off)",
     SCENE(cut_away)},
    HEADING("Rays, slices, splats (the help says which is for which mode)"),
    {"step-length", 0, CLI_NUMBER, "V",
     "of rays, or from slice to slice, in voxels (0.5; of lit rays 0.25)", SCENE(step)},
    {"cell-steps", 0, CLI_FLAG, NULL, "samples where rays leave cells, too (off)",
     SCENE(cell_steps)},
    {"preintegration", 0, CLI_FLAG, NULL,
     "integrate the transfer function over each step (on; --no-preintegration)",
     SCENE(preintegration)},
    {"jitter", 0, CLI_FLAG, NULL, "shift each ray's samples by part of a step (off)",
     SCENE(jitter)},
    {"exact-filter", 0, CLI_FLAG, NULL,
     "interpolate in single precision, not by the texture unit (off)", SCENE(exact_filter)},
    {"skipping", 0, CLI_FLAG, NULL, "pass over what is empty (on; --no-skipping)",
     SCENE(skipping)},
    {"stop-opacity", 0, CLI_NUMBER, "S", "where rays end, to 1 (0.9999)", SCENE(stop_opacity)},
    {"threshold", 0, CLI_NUMBER, "V", "what a maximum of local-mip has to reach (0)",
     SCENE(threshold)},
    {"planes", 0, CLI_TEXT, "NX,NY,NZ,D[;...]",
     "slices: all points p with n . p = d, in mm; up to 4 (three through the middle)",
     SCENE(planes)},
    {"slices", 0, CLI_COUNT, "N", "through a texture, in place of a --step-length",
     SCENE(slices)},
    {"texture-edge", 0, CLI_COUNT, "N", "the largest edge of a 3D texture (what OpenGL can)",
     SCENE(texture_edge)},
    {"target", 0, CLI_CHOICE, "32f/16/16f/8", "the numbers that slices are blended in (32f)",
     SCENE(target)},
    {"colors-first", 0, CLI_FLAG, NULL, "interpolate colours, not data (off)",
     SCENE(colors_first)},
    {"normals", 0, CLI_COUNT, "N", "directions that gradients are rounded to (1024)",
     SCENE(normals)},
    {"boundary", 0, CLI_FLAG, NULL, "only cells where materials meet (off)", SCENE(boundary)},
    {"linear-opacity", 0, CLI_FLAG, NULL,
     "opacity, not depth, is linear over a polygon, as in 1991 (off)", SCENE(linear_opacity)},
    {"tree-error", 0, CLI_NUMBER, "S",
     "largest error of a node that is drawn whole, 0 to 1 (0)", SCENE(tree_error)},
    {"splat-budget", 0, CLI_COUNT, "N",
     "splats at most, as exact as they can be, in place of a --tree-error",
     SCENE(splat_budget)},
    HEADING("Meshes"),
    {"color", 0, CLI_TEXT, "C", "of a mesh without colours, such as #ffeedd or #ffeedd80",
     SCENE(color)},
    {"tint", 0, CLI_CHOICE, "colors/scalars/quality",
     "its colours, its scalars from dark to bright, or the shapes of triangles (colors)",
     SCENE(tint)},
    {"tint-range", 0, CLI_NUMBERS, "LOW,HIGH", "of the scalars (all)", SCENE(tint_range)},
    {"wireframe", 0, CLI_FLAG, NULL, "draw the edges, too (off)", SCENE(wireframe)},
    {"cap", 0, CLI_FLAG, NULL, "fill the cut through a clipped mesh (off)", SCENE(cap)},
    HEADING("Reading"),
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
