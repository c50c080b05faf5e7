/* Allocates and reads the framebuffer that widgets are drawn into, and uploads the pictures
 * they show. */
#include "viewer/gl/gl_context.h"
#include "viewer/window/ui_internal.h"

#include <string.h>

static const float empty[4] = {0.075f, 0.08f, 0.09f, 1};

static void make_target(cwi_ui_target *t, size_t width, size_t height)
{
    glGenFramebuffers(1, &t->framebuffer);
    glGenRenderbuffers(1, &t->color);
    glBindRenderbuffer(GL_RENDERBUFFER, t->color);
    glRenderbufferStorage(GL_RENDERBUFFER, GL_RGBA8, (GLsizei)width, (GLsizei)height);
    glBindFramebuffer(GL_FRAMEBUFFER, t->framebuffer);
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, t->color);
    t->width = width;
    t->height = height;
}

static void drop_target(cwi_ui_target *t)
{
    glDeleteFramebuffers(1, &t->framebuffer);
    glDeleteRenderbuffers(1, &t->color);
    *t = (cwi_ui_target){0};
}

void cwi_ui_target_begin(cwi_ui *ui)
{
    cwi_ui_target *t = &ui->target;
    if (t->width != ui->input.width || t->height != ui->input.height) {
        drop_target(t);
        make_target(t, ui->input.width, ui->input.height);
    }
    glBindFramebuffer(GL_FRAMEBUFFER, t->framebuffer);
    glViewport(0, 0, (GLsizei)t->width, (GLsizei)t->height);
    glDisable(GL_SCISSOR_TEST);
    glClearBufferfv(GL_COLOR, 0, empty);
}

void cwi_ui_target_free(cwi_ui *ui)
{
    drop_target(&ui->target);
    for (int n = 0; n < CWI_UI_SLOTS; n++)
        glDeleteTextures(1, &ui->pictures[n].texture);
}

cw_status cwi_ui_target_check(cw_error *err)
{
    return cwi_gl_check(err);
}

/* Turns an image over, as GL's rows go up, and makes it opaque. */
static void turn_over(cw_image *image)
{
    const size_t row = 4 * image->width;
    for (size_t y = 0; y < image->height / 2; y++) {
        uint8_t *a = image->pixels + y * row;
        uint8_t *b = image->pixels + (image->height - 1 - y) * row;
        for (size_t n = 0; n < row; n++) {
            const uint8_t keep = a[n];
            a[n] = b[n];
            b[n] = keep;
        }
    }
    for (size_t n = 0; n < image->width * image->height; n++)
        image->pixels[4 * n + 3] = 255;
}

cw_status cwi_ui_target_grab(cwi_ui *ui, cw_image *image, cw_error *err)
{
    const cwi_ui_target *t = &ui->target;
    if (t->width == 0)
        return cwi_fail(err, CW_ERR_ARGUMENT, "the window has shown nothing yet");
    cw_status st = cw_image_alloc(image, t->width, t->height, err);
    if (st != CW_OK)
        return st;
    glBindFramebuffer(GL_FRAMEBUFFER, t->framebuffer);
    glReadPixels(0, 0, (GLsizei)t->width, (GLsizei)t->height, GL_RGBA, GL_UNSIGNED_BYTE,
                 image->pixels);
    turn_over(image);
    st = cwi_gl_check(err);
    if (st != CW_OK)
        cw_image_free(image);
    return st;
}

static void set_up(GLuint texture)
{
    glBindTexture(GL_TEXTURE_2D, texture);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
}

static void upload_picture(cwi_ui_picture *p, const cw_image *image)
{
    const GLsizei width = (GLsizei)image->width, height = (GLsizei)image->height;
    const bool fits = p->texture && p->width == image->width && p->height == image->height;
    if (!p->texture)
        glGenTextures(1, &p->texture);
    set_up(p->texture);
    if (fits)
        glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE,
                        image->pixels);
    else
        glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, width, height, 0, GL_RGBA, GL_UNSIGNED_BYTE,
                     image->pixels);
    p->width = image->width;
    p->height = image->height;
}

static cw_status check_size(const cw_image *image, cw_error *err)
{
    GLint max = 0;
    glGetIntegerv(GL_MAX_TEXTURE_SIZE, &max);
    if (image->width > (size_t)max || image->height > (size_t)max)
        return cwi_fail(err, CW_ERR_LIMIT,
                        "a picture of %zu x %zu pixels; OpenGL here takes up to %d x %d",
                        image->width, image->height, max, max);
    return CW_OK;
}

cw_status cwi_ui_target_keep(cwi_ui *ui, int slot, const cw_image *image, cw_error *err)
{
    cwi_ui_picture *p = &ui->pictures[slot];
    cw_status st = CW_OK;
    if (image && image->pixels) {
        st = check_size(image, err);
        if (st != CW_OK)
            return st;
        upload_picture(p, image);
        st = cwi_gl_check(err);
        if (st == CW_OK)
            return st;
    }
    glDeleteTextures(1, &p->texture);
    *p = (cwi_ui_picture){0};
    return st;
}
