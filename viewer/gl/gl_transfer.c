/* Uploads a transfer function as textures, and the blocks that it leaves empty. */
#include "viewer/gl/gl_internal.h"

#include "core/base/memory.h"
#include "core/base/status.h"

#include <math.h>
#include <string.h>

void cwi_gl_drop_transfer(cwi_gl *gl)
{
    cwi_gl_transfer *t = &gl->transfer;
    glDeleteTextures(1, &t->rows);
    glDeleteTextures(1, &t->skip);
    glDeleteTextures(1, &t->segments);
    glDeleteTextures(1, &t->factor);
    cwi_table_free(&t->table);
    cwi_free(t->away);
    *t = (cwi_gl_transfer){0};
}

/* Factors up to the last point; the value there is in the unit of the gradients' texture. */
static void make_factor(cwi_gl *gl)
{
    const cw_transfer *t = &gl->transfer.key;
    float rows[CWI_FACTOR_ROWS];
    double end = t->gradient_count ? t->gradients[t->gradient_count - 1].value : 0;
    if (gl->frame->surface > 0) /* strengths go to 1 */
        end = 1;
    if (!(end > 0))
        end = 1;
    for (int n = 0; n < CWI_FACTOR_ROWS; n++)
        rows[n] = (float)cw_transfer_gradient_factor(t, end * n / (CWI_FACTOR_ROWS - 1));
    gl->transfer.factor_end = gl->frame->surface > 0
                                  ? end / (gl->frame->surface * gl->volume.gradient_unit)
                                  : end * gl->frame->unit_mm / gl->volume.gradient_unit;
    gl->transfer.factor = cwi_gl_texture(GL_TEXTURE_1D, CWI_UNIT_FACTOR, true);
    glTexImage1D(GL_TEXTURE_1D, 0, GL_R32F, CWI_FACTOR_ROWS, 0, GL_RED, GL_FLOAT, rows);
}

static void bind_textures(const cwi_gl_transfer *t)
{
    glActiveTexture(GL_TEXTURE0 + CWI_UNIT_TABLE);
    glBindTexture(GL_TEXTURE_1D, t->rows);
    glActiveTexture(GL_TEXTURE0 + CWI_UNIT_SKIP);
    glBindTexture(GL_TEXTURE_3D, t->skip);
    glActiveTexture(GL_TEXTURE0 + CWI_UNIT_FACTOR);
    glBindTexture(GL_TEXTURE_1D, t->factor);
    glActiveTexture(GL_TEXTURE0 + CWI_UNIT_SEGMENTS);
    glBindTexture(GL_TEXTURE_2D, t->segments);
}

static cw_status make_textures(cwi_gl *gl, cw_error *err)
{
    cwi_gl_transfer *t = &gl->transfer;
    t->key = gl->frame->transfer;
    t->opacity_units = gl->frame->opacity_units;
    t->surface = gl->frame->surface;
    t->gradient_unit = gl->volume.gradient_unit;
    cw_status st = cwi_table_make(gl->frame, &t->table, err);
    if (st != CW_OK)
        return st;
    t->rows = cwi_gl_texture(GL_TEXTURE_1D, CWI_UNIT_TABLE, true);
    glTexImage1D(GL_TEXTURE_1D, 0, GL_RGBA32F, CWI_TABLE_ROWS, 0, GL_RGBA, GL_FLOAT,
                 t->table.rows);
    t->segment_rows = cwi_table_segment_rows(&t->table, &t->key);
    make_factor(gl);
    t->is_made = true;
    return CW_OK;
}

cw_status cwi_gl_take_transfer(cwi_gl *gl, cw_error *err)
{
    cwi_gl_transfer *t = &gl->transfer;
    cw_status st = CW_OK;
    if (!t->is_made || memcmp(&t->key, &gl->frame->transfer, sizeof t->key) != 0 ||
        t->opacity_units != gl->frame->opacity_units || t->surface != gl->frame->surface ||
        t->gradient_unit != gl->volume.gradient_unit) {
        cwi_gl_drop_transfer(gl);
        st = make_textures(gl, err);
    }
    if (st == CW_OK)
        bind_textures(t);
    return st;
}

static bool is_visible(const void *table, double low, double high)
{
    return cwi_table_is_visible(table, low, high);
}

cw_status cwi_gl_need_skip(cwi_gl *gl, cw_error *err)
{
    const cwi_ranges *r = &gl->volume.ranges;
    uint8_t *d;
    if (gl->transfer.away)
        return CW_OK;
    cw_status st = cwi_ranges_distances(r, is_visible, &gl->transfer.table, &d, err);
    if (st != CW_OK)
        return st;
    gl->transfer.skip = cwi_gl_texture(GL_TEXTURE_3D, CWI_UNIT_SKIP, false);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    glTexImage3D(GL_TEXTURE_3D, 0, GL_R8UI, (GLsizei)r->dim[0], (GLsizei)r->dim[1],
                 (GLsizei)r->dim[2], 0, GL_RED_INTEGER, GL_UNSIGNED_BYTE, d);
    gl->transfer.away = d;
    return CW_OK;
}

cw_status cwi_gl_need_segments(cwi_gl *gl, double length, cw_error *err)
{
    cwi_gl_transfer *t = &gl->transfer;
    if (t->segment_length == length)
        return CW_OK;
    const size_t rows = t->segment_rows;
    float *all = cwi_alloc_array(rows * rows, 4 * sizeof *all);
    if (!all)
        return cwi_fail_memory(err);
    cw_status st = cwi_table_preintegrate(&t->table, length, rows, gl->frame->scene.threads,
                                          &gl->watch.progress, all, err);
    if (st == CW_OK) {
        glDeleteTextures(1, &t->segments);
        t->segments = cwi_gl_texture(GL_TEXTURE_2D, CWI_UNIT_SEGMENTS, true);
        glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, (GLsizei)rows, (GLsizei)rows, 0, GL_RGBA,
                     GL_FLOAT, all);
        t->segment_length = length;
    }
    cwi_free(all);
    return st;
}
