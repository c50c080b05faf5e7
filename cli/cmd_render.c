#include "cli/commands.h"
#include "cli/console.h"
#include "cli/mesh.h"
#include "cli/output.h"
#include "cli/quantity.h"
#include "cli/surface.h"
#include "core/status.h"
#include "viewer/reference_mesh.h"

#include <string.h>

typedef struct render_args {
    cli_common common;
    cli_input input;
    const char *output, *camera;
    cli_number iso;
    int inside;
    cli_sizes size;
    size_t samples;
} render_args;

static const render_args defaults = {
    .camera = "front", .size = {.count = 2, .n = {1280, 720, 0}}, .samples = 2};

static const cli_option options[] = {
    {"output", 'o', CLI_TEXT, "FILE", "the picture, a .png", offsetof(render_args, output)},
    {"iso", 'i', CLI_NUMBER, "V", "the isovalue of a volume's surface (required for one)",
     offsetof(render_args, iso)},
    {"inside", 0, CLI_CHOICE, CLI_INSIDE_CHOICES,
     "which values are inside the solid (auto: above, of level sets below)",
     offsetof(render_args, inside)},
    {"size", 0, CLI_SIZES, "WxH", "of the picture, in pixels (1280x720)",
     offsetof(render_args, size)},
    {"camera", 0, CLI_TEXT, "VIEW", "front, back, left, right, top, bottom or iso (front)",
     offsetof(render_args, camera)},
    {"samples", 0, CLI_COUNT, "N", "N x N samples a pixel, 1 to 4 (2)",
     offsetof(render_args, samples)},
    CLI_INPUT_OPTIONS(render_args),
};

static cw_status check_camera(const char *name, cw_error *err)
{
    const cw_fit_desc fit = {.view = name, .max = {1, 1, 1}};
    cw_camera camera;
    return cw_camera_fit(&fit, &camera, err);
}

static cw_status check_args(const render_args *args, cw_error *err)
{
    const char *dot = args->output ? strrchr(args->output, '.') : NULL;
    if (!args->output)
        return cw_fail(err, CW_ERR_ARGUMENT, "render needs an output: -o FILE");
    if (!dot || strcmp(dot, ".png") != 0)
        return cw_fail(err, CW_ERR_ARGUMENT, "%s: render writes .png", args->output);
    if (args->size.count != 2)
        return cw_fail(err, CW_ERR_ARGUMENT, "--size takes two numbers, such as 1280x720");
    if (args->samples < 1 || args->samples > 4)
        return cw_fail(err, CW_ERR_ARGUMENT, "--samples %zu: expected 1 to 4", args->samples);
    cw_status st = check_camera(args->camera, err);
    return st == CW_OK ? cli_check_output(args->output, args->common.inputs, 1, err) : st;
}

static cw_status draw(const render_args *args, const cw_mesh *mesh, cw_image *image,
                      cw_error *err)
{
    cw_fit_desc fit = {
        .view = args->camera,
        .aspect = (double)args->size.n[0] / (double)args->size.n[1],
        .fov_deg = 30,
        .margin = 0.04,
    };
    cwi_render_desc desc = {
        .width = args->size.n[0],
        .height = args->size.n[1],
        .samples = (int)args->samples,
        .threads = (int)args->input.threads,
        .progress = cli_progress((double)mesh->triangle_count / 1e6, "Mtriangle"),
    };
    cw_mesh_bounds(mesh, fit.min, fit.max);
    cw_status st = cw_camera_fit(&fit, &desc.camera, err);
    return st == CW_OK ? cwi_render_mesh(mesh, &desc, image, err) : st;
}

/* With an isovalue the input is a volume, without a mesh. */
static cw_status get_mesh(const render_args *args, cw_mesh *mesh, cw_error *err)
{
    const char *path = args->common.inputs[0];
    cli_volume volume = {0};
    if (!args->iso.given && !cli_is_level_set(path, &args->input)) {
        cli_mesh file;
        cw_status st = cli_read_mesh(path, args->input.reader, &args->input, &file, err);
        *mesh = file.mesh;
        if (st == CW_ERR_FORMAT)
            cli_say("a volume needs a level: --iso V; 'cubewright info %s' suggests some",
                    path);
        return st;
    }
    cw_status st = cli_read_volume(path, &args->input, false, &volume, err);
    if (st == CW_OK)
        st = cli_extract_surface(
            &volume, NULL,
            &(cw_extract_desc){.isovalue = args->iso.value,
                               .inside_is_low = cli_inside_is_low(args->inside, &volume.whole),
                               .threads = (int)args->input.threads},
            mesh, NULL, err);
    cli_free_volume(&volume);
    return st;
}

static cw_status run(void *p, cw_error *err)
{
    const render_args *args = p;
    const double start = cli_seconds();
    cw_mesh mesh = {0};
    cw_image image = {0};
    cw_status st = check_args(args, err);
    if (st == CW_OK)
        st = get_mesh(args, &mesh, err);
    if (st == CW_OK)
        st = draw(args, &mesh, &image, err);
    if (st == CW_OK)
        st = cw_image_write(args->output, &image, err);
    if (st == CW_OK)
        cli_result("%s: %zu x %zu, %s triangles seen from %s; %.2f s\n", args->output,
                   image.width, image.height, cli_count(mesh.triangle_count), args->camera,
                   cli_seconds() - start);
    cw_image_free(&image);
    cw_mesh_free(&mesh);
    return st;
}

const cli_command cli_render = {
    .name = "render",
    .usage = "VOLUME --iso V -o PNG [options], or MESH -o PNG [options]",
    .about = "a picture of a mesh, or of the surface at an isovalue; needs no display",
    .more =
        "Draws a mesh, in its colours if it has some, or the surface that extract makes of a\n"
        "volume, lit from the camera, on the CPU in double precision; the inside is red. "
        "Cameras\n"
        "are named in the patient's frame: front looks at the face, heads\n"
        "are up, and the patient's left is on the right of the picture.\n\n"
        "Examples\n"
        "  cubewright render head.nii.gz --iso 50 --camera iso -o head.png\n"
        "  cubewright render defects.ply -o defects.png\n",
    .options = options,
    .option_count = sizeof options / sizeof *options,
    .min_inputs = 1,
    .max_inputs = 1,
    .slices = true,
    .size = sizeof(render_args),
    .defaults = &defaults,
    .run = run,
};
