/* Reports progress, and asks whether to continue. Without a callback everything is drawn at
 * once. Bands and ranges give the same picture, as fragments are the same, and in the same
 * order. */
#include "viewer/gl/gl_internal.h"

#include "core/base/clock.h"
#include "core/base/status.h"

/* Minimum and maximum seconds between two reports. */
static const double MIN_INTERVAL_S = 0.005, MAX_INTERVAL_S = 0.012;

enum { FIRST_ROWS = 8, MAX_ROWS = 16, MIN_ROWS = 4, FIRST_TRIANGLES = 4096 };

/* Calls the caller, which finds its own context, and may make another current. */
static bool ask_caller(void *user, const char *step, double done)
{
    cwi_gl *gl = user;
    const cw_progress *p = &gl->frame->scene.progress;
    glFinish();
    cwi_gl_leave(gl);
    const bool goes_on = p->report(p->user, step, done);
    gl->watch.is_astray = !cwi_gl_enter(gl);
    gl->watch.last = cwi_now_s();
    return goes_on && !gl->watch.is_astray;
}

void cwi_gl_start_watch(cwi_gl *gl)
{
    gl->watch = (cwi_gl_watch){.rows = FIRST_ROWS,
                               .layer_rows = FIRST_ROWS,
                               .triangles = FIRST_TRIANGLES,
                               .last = cwi_now_s(),
                               .to = 1};
    if (gl->frame->scene.progress.report)
        gl->watch.progress = (cw_progress){ask_caller, gl};
}

static bool is_watched(const cwi_gl *gl)
{
    return gl->watch.progress.report != NULL;
}

cw_status cwi_gl_report(cwi_gl *gl, const char *step, double done, cw_error *err)
{
    return cwi_progress(&gl->watch.progress, step, done, err);
}

cw_status cwi_gl_report_soon(cwi_gl *gl, const char *step, double done, cw_error *err)
{
    return is_watched(gl) && cwi_now_s() - gl->watch.last > MIN_INTERVAL_S
               ? cwi_gl_report(gl, step, done, err)
               : CW_OK;
}

void cwi_gl_part(cwi_gl *gl, size_t n, size_t count)
{
    gl->watch.from = (double)n / (double)count;
    gl->watch.to = (double)(n + 1) / (double)count;
}

/* Reports after a fraction of a part was drawn. */
static cw_status report_fraction(cwi_gl *gl, size_t n, size_t count, cw_error *err)
{
    const cwi_gl_watch *w = &gl->watch;
    const double fraction = n < count ? (double)n / (double)count : 1;
    return cwi_gl_report(gl, "drawing", w->from + fraction * (w->to - w->from), err);
}

/* Adapts the size: more if drawing was fast, less if it was slow. */
static size_t adapt_size(size_t drawn, double since, size_t min, size_t max)
{
    glFinish();
    const double seconds = cwi_now_s() - since;
    const size_t next = seconds < MIN_INTERVAL_S   ? 2 * drawn
                        : seconds > MAX_INTERVAL_S ? drawn / 2
                                                   : drawn;
    return next < min ? min : next > max ? max : next;
}

/* Draws bands. They start at even rows: values that shaders take from neighbours stay the
 * same. */
static cw_status draw_bands(cwi_gl *gl, void (*draw)(void *), void *context, size_t *rows,
                            size_t max, cw_error *err)
{
    const size_t height = (size_t)gl->target.height;
    cw_status st = CW_OK;
    glEnable(GL_SCISSOR_TEST);
    for (size_t y = 0; y < height && st == CW_OK;) {
        const double start = cwi_now_s();
        glScissor(0, (GLint)y, gl->target.width, (GLsizei)*rows);
        draw(context);
        y += *rows;
        *rows = adapt_size(*rows, start, MIN_ROWS, max);
        st = report_fraction(gl, y, height, err);
    }
    glDisable(GL_SCISSOR_TEST);
    return st;
}

static void draw_screen(void *gl)
{
    cwi_gl_draw_screen(gl);
}

/* Draws along rays. The next rows may be much slower than the last, so bands stay narrow. */
cw_status cwi_gl_draw_rays(cwi_gl *gl, cw_error *err)
{
    if (is_watched(gl))
        return draw_bands(gl, draw_screen, gl, &gl->watch.rows, MAX_ROWS, err);
    cwi_gl_draw_screen(gl);
    return CW_OK;
}

cw_status cwi_gl_draw_layer(cwi_gl *gl, void (*draw)(void *), void *context, cw_error *err)
{
    if (is_watched(gl))
        return draw_bands(gl, draw, context, &gl->watch.layer_rows,
                          (size_t)gl->target.height + 1, err);
    draw(context);
    return CW_OK;
}

static void draw_range(size_t first, size_t count, bool indexed)
{
    if (indexed)
        glDrawElements(GL_TRIANGLES, (GLsizei)(3 * count), GL_UNSIGNED_INT,
                       (const void *)(3 * first * sizeof(uint32_t)));
    else
        glDrawArrays(GL_TRIANGLES, (GLint)(3 * first), (GLsizei)(3 * count));
}

cw_status cwi_gl_draw_triangles(cwi_gl *gl, size_t count, bool indexed, cw_error *err)
{
    cw_status st = CW_OK;
    if (!is_watched(gl))
        draw_range(0, count, indexed);
    for (size_t n = 0; is_watched(gl) && n < count && st == CW_OK;) {
        const size_t requested = gl->watch.triangles, left = count - n;
        const double start = cwi_now_s();
        draw_range(n, requested < left ? requested : left, indexed);
        n += requested;
        gl->watch.triangles = adapt_size(requested, start, 64, (size_t)1 << 20);
        st = report_fraction(gl, n, count, err);
    }
    return st;
}
