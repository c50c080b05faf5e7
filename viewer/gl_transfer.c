/* A transfer function as textures, and what it leaves empty. */
#include "viewer/gl_work.h"

#include "core/memory.h"
#include "core/status.h"

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

/* Each byte becomes at most one more than the least of its neighbours before it, in an order of
 * the lattice from one corner to the opposite: forward, then backward, that is the distance
 * along the longest axis to the next 0, up to 255. */
static void relax(uint8_t *d, const size_t dim[3], bool backward)
{
    const ptrdiff_t count = (ptrdiff_t)(dim[0] * dim[1] * dim[2]);
    for (ptrdiff_t m = 0; m < count; m++) {
        const ptrdiff_t n = backward ? count - 1 - m : m;
        const ptrdiff_t x = n % (ptrdiff_t)dim[0],
                        y = n / (ptrdiff_t)dim[0] % (ptrdiff_t)dim[1],
                        z = n / (ptrdiff_t)(dim[0] * dim[1]);
        for (int o = 0; o < 13; o++) { /* the half of the 27 in front of the middle */
            const ptrdiff_t s = backward ? -1 : 1;
            const ptrdiff_t i = x + s * (o % 3 - 1), j = y + s * (o / 3 % 3 - 1),
                            k = z + s * (o / 9 - 1);
            if (i < 0 || j < 0 || k < 0 || i >= (ptrdiff_t)dim[0] || j >= (ptrdiff_t)dim[1] ||
                k >= (ptrdiff_t)dim[2])
                continue;
            const uint8_t near = d[(k * (ptrdiff_t)dim[1] + j) * (ptrdiff_t)dim[0] + i];
            if (near < 255 && near + 1 < d[n])
                d[n] = (uint8_t)(near + 1);
        }
    }
}

static cw_status make_skip(cwi_gl *gl, cw_error *err)
{
    const cwi_ranges *r = &gl->volume.ranges;
    const size_t count = r->dim[0] * r->dim[1] * r->dim[2];
    uint8_t *d = cwi_alloc_array(count, 1);
    if (!d)
        return cw_fail(err, CW_ERR_NO_MEMORY, "no memory for what is empty");
    for (size_t n = 0; n < count; n++) {
        const double low = (double)r->blocks[n][0], high = (double)r->blocks[n][1];
        d[n] = low <= high && cwi_table_is_visible(&gl->transfer.table, low, high) ? 0 : 255;
    }
    relax(d, r->dim, false);
    relax(d, r->dim, true);
    gl->transfer.skip = cwi_gl_texture(GL_TEXTURE_3D, CWI_UNIT_SKIP, false);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    glTexImage3D(GL_TEXTURE_3D, 0, GL_R8UI, (GLsizei)r->dim[0], (GLsizei)r->dim[1],
                 (GLsizei)r->dim[2], 0, GL_RED_INTEGER, GL_UNSIGNED_BYTE, d);
    gl->transfer.away = d;
    return CW_OK;
}

/* Factors up to the last point; the value there is in the unit of the gradients' texture. */
static void make_factor(cwi_gl *gl)
{
    const cw_transfer *t = &gl->transfer.key;
    float rows[CWI_FACTOR_ROWS];
    double end = t->gradient_count ? t->gradients[t->gradient_count - 1].value : 0;
    if (!(end > 0))
        end = 1;
    for (int n = 0; n < CWI_FACTOR_ROWS; n++)
        rows[n] = (float)cw_transfer_gradient_factor(t, end * n / (CWI_FACTOR_ROWS - 1));
    gl->transfer.factor_end = end * gl->frame->unit_mm / gl->volume.range;
    gl->transfer.factor = cwi_gl_texture(GL_TEXTURE_2D, CWI_UNIT_FACTOR, true);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_R32F, CWI_FACTOR_ROWS, 1, 0, GL_RED, GL_FLOAT, rows);
}

static void bind(const cwi_gl_transfer *t)
{
    glActiveTexture(GL_TEXTURE0 + CWI_UNIT_TABLE);
    glBindTexture(GL_TEXTURE_2D, t->rows);
    glActiveTexture(GL_TEXTURE0 + CWI_UNIT_SKIP);
    glBindTexture(GL_TEXTURE_3D, t->skip);
    glActiveTexture(GL_TEXTURE0 + CWI_UNIT_FACTOR);
    glBindTexture(GL_TEXTURE_2D, t->factor);
    glActiveTexture(GL_TEXTURE0 + CWI_UNIT_SEGMENTS);
    glBindTexture(GL_TEXTURE_2D, t->segments);
}

static cw_status make(cwi_gl *gl, cw_error *err)
{
    cwi_gl_transfer *t = &gl->transfer;
    t->key = gl->frame->transfer;
    t->opacity_units = gl->frame->opacity_units;
    cw_status st = cwi_table_make(gl->frame, &t->table, err);
    if (st != CW_OK)
        return st;
    t->rows = cwi_gl_texture(GL_TEXTURE_2D, CWI_UNIT_TABLE, true);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, CWI_TABLE_ROWS, 1, 0, GL_RGBA, GL_FLOAT,
                 t->table.rows);
    make_factor(gl);
    st = make_skip(gl, err);
    t->is_made = st == CW_OK;
    return st;
}

cw_status cwi_gl_take_transfer(cwi_gl *gl, cw_error *err)
{
    cwi_gl_transfer *t = &gl->transfer;
    cw_status st = CW_OK;
    if (!t->is_made || memcmp(&t->key, &gl->frame->transfer, sizeof t->key) != 0 ||
        t->opacity_units != gl->frame->opacity_units) {
        cwi_gl_drop_transfer(gl);
        st = make(gl, err);
    }
    if (st == CW_OK)
        bind(t);
    return st;
}

cw_status cwi_gl_need_segments(cwi_gl *gl, double length, cw_error *err)
{
    cwi_gl_transfer *t = &gl->transfer;
    if (t->segment_length == length)
        return CW_OK;
    float *all = cwi_alloc_array((size_t)CWI_SEGMENT_ROWS * CWI_SEGMENT_ROWS, 4 * sizeof *all);
    if (!all)
        return cw_fail(err, CW_ERR_NO_MEMORY,
                       "no memory for a pre-integrated transfer function");
    cw_status st = cwi_table_preintegrate(&t->table, length, CWI_SEGMENT_ROWS,
                                          gl->frame->scene.threads, all, err);
    if (st == CW_OK) {
        glDeleteTextures(1, &t->segments);
        t->segments = cwi_gl_texture(GL_TEXTURE_2D, CWI_UNIT_SEGMENTS, true);
        glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, CWI_SEGMENT_ROWS, CWI_SEGMENT_ROWS, 0,
                     GL_RGBA, GL_FLOAT, all);
        t->segment_length = length;
    }
    cwi_free(all);
    return st;
}
