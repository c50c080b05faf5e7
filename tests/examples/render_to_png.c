/* Draws a volume into a PNG file, without a window.
 *
 *     render_to_png VOLUME OUTPUT.png
 *
 * Casts rays with OpenGL where there is a driver, and on the processor where there is none. */
#include <cubewright/cubewright.h>
#include <stdio.h>

/* Draws a scene with OpenGL, else with a mode of the processor. */
static cw_status draw_scene(cw_scene *scene, cw_picture *picture, cw_error *err)
{
    cw_renderer *renderer = NULL;
    scene->mode = CW_MODE_COMPOSITE;
    cw_status st = cw_renderer_new(CW_BACKEND_EGL, &renderer, err);
    if (st == CW_ERR_UNSUPPORTED) {
        scene->mode = CW_MODE_VBUFFER;
        st = cw_renderer_new(CW_BACKEND_CPU, &renderer, err);
    }
    if (st == CW_OK)
        st = cw_render(renderer, scene, picture, err);
    if (st == CW_OK)
        printf("mode %s, drawn by %s\n", cw_mode_name(scene->mode), cw_renderer_name(renderer));
    cw_renderer_free(renderer);
    return st;
}

int main(int argc, char **argv)
{
    if (argc != 3) {
        fprintf(stderr, "usage: render_to_png VOLUME OUTPUT.png\n");
        return 2;
    }
    const uint8_t background[2][4] = {{255, 255, 255, 255}, {200, 210, 220, 255}};
    cw_volume volume = {0};
    cw_statistics statistics = {0};
    cw_transfer transfer = {0};
    cw_picture picture = {0};
    cw_image image = {0};
    cw_error err = {0};
    cw_status st = cw_volume_read(argv[1], NULL, &volume, NULL, &err);
    if (st == CW_OK) /* a preset is fitted to the histogram of the values */
        st = cw_volume_statistics(&volume, 256, 0, &statistics, &err);
    if (st == CW_OK)
        st = cw_transfer_preset("auto", &statistics, &transfer, &err);
    cw_scene scene = {.volume = &volume, .transfer = &transfer, .width = 320, .height = 240};
    if (st == CW_OK)
        st = draw_scene(&scene, &picture, &err);
    if (st == CW_OK) /* the picture is translucent: show it over a background */
        st = cw_picture_show(&picture, background, &image, &err);
    if (st == CW_OK)
        st = cw_image_write(argv[2], &image, &err);
    if (st != CW_OK)
        fprintf(stderr, "render_to_png: %s\n", err.message);
    cw_image_free(&image);
    cw_picture_free(&picture);
    cw_statistics_free(&statistics);
    cw_volume_free(&volume);
    return cw_status_exit_code(st);
}
