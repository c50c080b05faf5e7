/* Chooses a backend for each scene, OpenGL or CPU, and averages samples to pixels. */
#include <cubewright/render.h>

#include "core/base/memory.h"
#include "core/base/module.h"
#include "core/base/status.h"
#include "core/geometry/affine.h"
#include "core/volume/volume.h"
#include "viewer/cpu/cpu_draw.h"
#include "viewer/cpu/cpu_mesh.h"
#include "viewer/gl/gl.h"
#include "viewer/scene/gradient_volume.h"
#include "viewer/scene/shadow_volume.h"

#include <string.h>

struct cw_renderer {
    cw_backend backend;
    const cwi_gl_functions *functions; /* NULL: not loaded yet */
    cwi_gl *gl;                        /* opened by the first scene that needs it */
    bool has_no_gl;                    /* it could not be opened */
    bool drew_on_cpu;                  /* the last picture */
    cwi_cpu cpu;
    cwi_gradient_volume gradients;
    cwi_shadow_volume shadows;
};

/* Loads the module and opens a context, once. */
static cw_status need_gl(cw_renderer *r, cw_error *err)
{
    const void *functions;
    if (r->gl)
        return CW_OK;
    cw_status st = cwi_module_load("gl", &functions, err);
    if (st != CW_OK)
        return st;
    r->functions = functions;
    return r->functions->open(&r->gl, err);
}

cw_status cw_renderer_new(cw_backend backend, cw_renderer **renderer, cw_error *err)
{
    CWI_REQUIRE(err, renderer);
    *renderer = NULL;
    if ((unsigned)backend >= CW_BACKEND_COUNT)
        return cwi_fail(err, CW_ERR_ARGUMENT, "%d is not a backend (0 to %d)", (int)backend,
                        CW_BACKEND_COUNT - 1);
    cw_renderer *r = cwi_alloc_zeroed(1, sizeof *r);
    if (!r)
        return cwi_fail_memory(err);
    r->backend = backend;
    cw_status st = backend == CW_BACKEND_EGL ? need_gl(r, err) : CW_OK;
    if (st == CW_OK)
        *renderer = r;
    else
        cw_renderer_free(r);
    return st;
}

void cw_renderer_free(cw_renderer *r)
{
    if (r)
        cw_renderer_forget(r);
    if (r && r->gl)
        r->functions->close(r->gl);
    cwi_free(r);
}

const char *cw_renderer_name(const cw_renderer *r)
{
    if (!r)
        return "CPU";
    return r->gl && !r->drew_on_cpu ? r->functions->name(r->gl) : "CPU";
}

void cw_renderer_forget(cw_renderer *r)
{
    if (!r)
        return;
    if (r->gl)
        r->functions->forget(r->gl);
    cwi_cpu_forget(&r->cpu);
    cwi_gradient_volume_free(&r->gradients);
    cwi_shadow_volume_free(&r->shadows);
}

/* Returns true if the CPU draws a frame's cells faster than GL: where GL runs on the CPU, too,
 * small triangles take it ten times as long. A mesh with settings of GL's alone stays there. */
static bool is_faster_on_cpu(cw_renderer *r, const cwi_frame *frame)
{
    cw_error ignored;
    if (!r->gl && !r->has_no_gl)
        r->has_no_gl = need_gl(r, &ignored) != CW_OK;
    if (!r->gl)
        return true;
    return cwi_gl_is_software(r->functions->name(r->gl)) &&
           (!frame->scene.mesh || !cwi_cpu_mesh_refusal(frame));
}

/* Returns true for frames that are left to the CPU. */
static bool is_for_cpu(cw_renderer *r, const cwi_frame *frame)
{
    const cw_mode mode = frame->scene.mode;
    if (r->backend != CW_BACKEND_AUTO)
        return r->backend == CW_BACKEND_CPU;
    return mode == CW_MODE_VBUFFER || frame->is_reference || cwi_volume_kind(&frame->volume) ||
           (mode == CW_MODE_PROJECTION && is_faster_on_cpu(r, frame));
}

/* Draws every sample of the picture. */
static cw_status draw_frame(cw_renderer *r, const cwi_frame *frame, cw_picture *picture,
                            cw_error *err)
{
    const char *kind = cwi_volume_kind(&frame->volume);
    r->drew_on_cpu = is_for_cpu(r, frame);
    if (r->drew_on_cpu && frame->scene.mesh_look.live)
        return cwi_fail(err, CW_ERR_UNSUPPORTED, "a live surface is drawn by OpenGL alone");
    if (r->drew_on_cpu)
        return cwi_cpu_draw(&r->cpu, frame, picture, err);
    if (kind)
        return cwi_fail(err, CW_ERR_UNSUPPORTED,
                        "OpenGL draws evenly spaced volumes; the CPU draws %s", kind);
    if (frame->is_reference)
        return cwi_fail(err, CW_ERR_UNSUPPORTED, "the mode %s is not drawn by OpenGL",
                        cw_mode_name(CW_MODE_REFERENCE));
    cw_status st = need_gl(r, err);
    return st == CW_OK ? r->functions->draw(r->gl, frame, picture, err) : st;
}

/* Averages n x n samples. */
static cw_status average_samples(const cw_picture *fine, size_t n, cw_picture *out,
                                 cw_error *err)
{
    cw_status st = cw_picture_alloc(out, fine->width / n, fine->height / n, err);
    for (size_t p = 0; st == CW_OK && p < out->width * out->height * 4; p++) {
        const size_t c = p % 4, x = p / 4 % out->width, y = p / 4 / out->width;
        double sum = 0;
        for (size_t j = 0; j < n; j++)
            for (size_t i = 0; i < n; i++)
                sum += (double)fine->pixels[4 * ((y * n + j) * fine->width + x * n + i) + c];
        out->pixels[p] = (float)(sum / (double)(n * n));
    }
    return st;
}

cw_status cw_renderer_prepare(cw_renderer *r, const cw_live_surface *live, bool *ready,
                              cw_error *err)
{
    CWI_REQUIRE(err, r, live, ready);
    *ready = false;
    if (!live->volume)
        return cwi_fail(err, CW_ERR_ARGUMENT, "a live surface needs a volume");
    if (r->backend == CW_BACKEND_CPU)
        return cwi_fail(err, CW_ERR_UNSUPPORTED, "a live surface is drawn by OpenGL alone");
    cw_status st = need_gl(r, err);
    return st == CW_OK ? r->functions->prepare(r->gl, live, ready, err) : st;
}

/* A stand-in for a live surface, as a mesh that the rest of the scene knows: the box around the
 * volume and its caps, with the origin of the surface's vertices. */
typedef struct live_box {
    cw_scene scene;
    cw_mesh mesh;
    float positions[8][3];
    uint32_t triangles[12][3];
} live_box;

/* Caps stand this far beyond the last samples, in voxels, or less. */
#define CAP_REACH (1.0 / 512)

static cw_status make_live_box(const cw_scene *scene, live_box *box, cw_error *err)
{
    static const uint32_t sides[12][3] = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6},
                                          {0, 1, 4}, {1, 5, 4}, {2, 6, 3}, {3, 6, 7},
                                          {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
    cw_volume v;
    double center[3];
    if (scene->mesh)
        return cwi_fail(err, CW_ERR_ARGUMENT, "a scene has a mesh or a live surface, not both");
    if (!scene->mesh_look.live->volume)
        return cwi_fail(err, CW_ERR_ARGUMENT, "a live surface needs a volume");
    cw_status st = cw_volume_select(scene->mesh_look.live->volume, 0, 0, &v, err);
    if (st == CW_OK && cwi_volume_kind(&v))
        st = cwi_fail(err, CW_ERR_UNSUPPORTED,
                      "OpenGL extracts from evenly spaced volumes, not from %s",
                      cwi_volume_kind(&v));
    if (st != CW_OK)
        return st;
    for (int a = 0; a < 3; a++)
        center[a] = 0.5 * (double)(v.dim[a] - 1);
    for (int n = 0; n < 8; n++)
        for (int r = 0; r < 3; r++) {
            double sum = 0;
            for (int a = 0; a < 3; a++)
                sum += v.affine[r][a] * (n >> a & 1 ? 1 : -1) * (center[a] + CAP_REACH);
            box->positions[n][r] = (float)sum;
        }
    memcpy(box->triangles, sides, sizeof sides);
    box->mesh = (cw_mesh){.positions = box->positions[0],
                          .vertex_count = 8,
                          .triangles = box->triangles[0],
                          .triangle_count = 12};
    cwi_affine_apply(v.affine[0], center, box->mesh.origin);
    box->scene = *scene;
    box->scene.mesh = &box->mesh;
    return CW_OK;
}

cw_status cw_render(cw_renderer *renderer, const cw_scene *scene, cw_picture *picture,
                    cw_error *err)
{
    CWI_REQUIRE(err, renderer, scene, picture);
    cwi_frame frame;
    cw_picture fine = {0};
    live_box box;
    *picture = (cw_picture){0};
    cw_status st = scene->mesh_look.live ? make_live_box(scene, &box, err) : CW_OK;
    if (st == CW_OK)
        st = cwi_frame_init(&frame, scene->mesh_look.live ? &box.scene : scene, err);
    if (st == CW_OK)
        st = cwi_gradient_volume_take(&renderer->gradients, &frame, err);
    if (st == CW_OK)
        st = cwi_shadow_volume_take(&renderer->shadows, &frame, err);
    if (st == CW_OK)
        st = cw_picture_alloc(&fine, frame.scene.width, frame.scene.height, err);
    if (st == CW_OK)
        st = draw_frame(renderer, &frame, &fine, err);
    if (st == CW_OK && frame.scene.samples > 1)
        st = average_samples(&fine, (size_t)frame.scene.samples, picture, err);
    else if (st == CW_OK) {
        *picture = fine;
        fine = (cw_picture){0};
    }
    cw_picture_free(&fine);
    return st;
}
