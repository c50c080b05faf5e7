/* Draws marks of points of the world on pictures: lines between them, and a text on a plate. */
#include <cubewright/overlay.h>

#include "core/base/memory.h"
#include "core/base/status.h"
#include "viewer/image/strokes.h"

#include <math.h>
#include <string.h>

static const double YELLOW[4] = {1, 0.85, 0.25, 1}, PLATE[4] = {0.04, 0.05, 0.07, 0.78};

static void draw_pass(cw_image *image, double width, const double color[4], double opacity,
                      const cwi_stroke *strokes, size_t count)
{
    cwi_pen pen = {.image = image, .width = width};
    memcpy(pen.color, color, sizeof pen.color);
    pen.color[3] *= opacity;
    cwi_pen_draw(&pen, strokes, count);
}

/* Writes a text to the right of a point and above it, beside the lines that go through it. */
static void write_plate(cw_image *image, const double at[2], double height, const char *text)
{
    static const double no_halo[4] = {0, 0, 0, 0};
    const double gap = 0.6 * height, left = at[0] + 0.5 * height;
    const double foot = at[1] - 1.2 * height; /* of the letters */
    cwi_pen pen = {.image = image};
    memcpy(pen.color, PLATE, sizeof pen.color);
    cwi_pen_fill(&pen, left, foot - height - gap, left + cwi_text_width(height, text) + 2 * gap,
                 foot + gap);
    cwi_text_write(image, (const double[2]){left + gap, foot}, height, 0, YELLOW, no_halo,
                   text);
}

/* Projects the points; false: one is behind the eye. */
static bool project_points(const cw_world_mark *mark, const cw_scene *scene,
                           const cw_image *image, double (*pixels)[2])
{
    for (size_t n = 0; n < mark->count; n++)
        if (!cw_camera_project(&scene->camera, image->width, image->height, mark->points[n],
                               pixels[n], NULL))
            return false;
    return true;
}

static void draw_mark(const cw_world_mark *mark, const double (*pixels)[2], cwi_stroke *strokes,
                      double height, cw_image *image)
{
    const double opacity = mark->opacity > 0 ? (double)mark->opacity : 1;
    const double black[4] = {0, 0, 0, 0.6}, width = fmax(height / 6, 1.2);
    const size_t lines = mark->is_closed && mark->count > 2 ? mark->count : mark->count - 1;
    double middle[2] = {0, 0};
    for (size_t n = 0; n < mark->count; n++) {
        memcpy(strokes[n].from, pixels[n], sizeof pixels[n]);
        memcpy(strokes[n].to, pixels[(n + 1) % mark->count], sizeof pixels[n]);
        middle[0] += pixels[n][0] / (double)mark->count;
        middle[1] += pixels[n][1] / (double)mark->count;
    }
    draw_pass(image, width + 2, black, opacity, strokes, lines);
    draw_pass(image, width, YELLOW, opacity, strokes, lines);
    for (size_t n = 0; n < mark->count; n++)
        memcpy(strokes[n].to, strokes[n].from, sizeof strokes[n].to); /* dots */
    draw_pass(image, 3 * width, YELLOW, opacity, strokes, mark->count);
    if (mark->text && *mark->text)
        write_plate(image, mark->text_point < mark->count ? pixels[mark->text_point] : middle,
                    height, mark->text);
}

cw_status cw_world_marks_draw(const cw_world_mark *marks, size_t count, double text_px,
                              const cw_scene *scene, cw_image *image, cw_error *err)
{
    CWI_REQUIRE(err, scene, image);
    size_t largest = 0;
    if (!image->pixels || (count && !marks))
        return cwi_fail(err, CW_ERR_ARGUMENT, "no marks, or an empty image");
    if (!(text_px >= 0 && text_px <= 1000))
        return cwi_fail(err, CW_ERR_ARGUMENT, "letters %g pixels high: expected up to 1000",
                        text_px);
    for (size_t n = 0; n < count; n++)
        largest = marks[n].count > largest ? marks[n].count : largest;
    double(*pixels)[2] = cwi_alloc_array(largest + 1, sizeof *pixels);
    cwi_stroke *strokes = cwi_alloc_array(largest + 1, sizeof *strokes);
    cw_status st = pixels && strokes ? CW_OK : cwi_fail_memory(err);
    const double height = text_px > 0 ? text_px : fmax(round((double)image->height / 48), 7);
    for (size_t n = 0; n < count && st == CW_OK; n++)
        if (marks[n].count && project_points(&marks[n], scene, image, pixels))
            draw_mark(&marks[n], (const double(*)[2])pixels, strokes, height, image);
    cwi_free(pixels);
    cwi_free(strokes);
    return st;
}
