/* Draws slices through textures of values and quantised gradients [VanGelder1996]. A small
 * table has the shaded colour of every direction, and value or material: another light changes
 * the table alone. Interpolated directions are lit in the shader. */
#include "viewer/modes/slab_textures.h"

#include "viewer/proxy/quantized_normals.h"
#include "viewer/scene/cell_lattice.h"

#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/geometry/affine.h"
#include "core/geometry/vec3.h"
#include "core/volume/volume.h"
#include "viewer/modes/gl_draw.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* A voxel's direction: its row of the table, and flags. A gradient may be opposite to the
 * direction of its row, which is in a half sphere. */
enum {
    VALUE_COLUMNS = 256,
    MATERIAL_ROWS = 4096,
    MEANS = 64,
    OPPOSITE = 1 << 14,
    BOUNDARY = 1 << 15
};

/* Settings that the textures of directions depend on, beside the volume. */
typedef struct normals_key {
    size_t count;
    bool mark_boundary;
    bool has_lengths; /* of the gradients, so that they can be interpolated */
    size_t gradient_version;
    cw_transfer transfer; /* zeroed unless boundaries are marked */
} normals_key;

/* Settings that the table of colours depends on. */
typedef struct shades_key {
    size_t count, light_count;
    bool is_unlit; /* the shader lights directions, and colours are as they are: one row */
    bool by_material;
    cw_light lights[CW_MAX_LIGHTS];
    cw_material material;
    bool one_sided; /* the table has a second half, for opposite gradients */
    double axes[3][3], to_eye[3];
    double longest; /* length of the longest gradient, as shaders have it */
    cw_transfer transfer;
    double low, high; /* values at both ends of the table */
    double opacity_units;
} shades_key;

typedef struct shaded_state {
    cwi_gl_slabs slices;
    cwi_directions directions;
    size_t brick_count;
    GLuint *normals, shades, directions_table, materials;
    normals_key normals_key;
    shades_key shades_key;
} shaded_state;

static void drop_normals(shaded_state *t)
{
    if (t->brick_count)
        glDeleteTextures((GLsizei)t->brick_count, t->normals);
    cwi_free(t->normals);
    cwi_directions_free(&t->directions);
    t->normals = NULL;
    t->brick_count = 0;
}

static void drop_shaded_texture(void *state)
{
    shaded_state *t = state;
    cwi_gl_drop_slices(&t->slices);
    drop_normals(t);
    glDeleteTextures(1, &t->shades);
    glDeleteTextures(1, &t->directions_table);
    glDeleteTextures(1, &t->materials);
    cwi_free(t);
}

/* Returns the material of a value, a range between two points of the opacity: the number of
 * points that are not above the value. */
static size_t material_of(const cw_transfer *t, double value)
{
    size_t n = 0;
    while (n < t->opacity_count && t->opacities[n].value <= value)
        n++;
    return n;
}

/* Widens a range by the values of samples that are left of `end` along each axis. */
static void widen_range(const cw_volume *v, const size_t first[3], const size_t end[3],
                        double range[2])
{
    for (size_t k = first[2]; k < end[2]; k++)
        for (size_t j = first[1]; j < end[1]; j++)
            for (size_t i = first[0]; i < end[0]; i++) {
                const double x =
                    v->slope * cwi_voxel_at(v->type, cwi_voxel_address(v, i, j, k));
                range[0] = fmin(range[0], x);
                range[1] = fmax(range[1], x);
            }
}

static bool has_two_materials(const cw_transfer *t, double low, double high)
{
    return low < high && material_of(t, low) != material_of(t, high);
}

/* Returns true if a cell or one around it is at a boundary: their samples are of more than one
 * material. The ranges of the blocks of these cells exclude most cells quickly. A ray may
 * pass a boundary in the corner of a cell: the cells around it close the hole. */
static bool is_boundary(const cw_volume *v, const cwi_ranges *blocks, const cw_transfer *t,
                        const size_t at[3])
{
    size_t first[3], end[3], low[3], high[3];
    double range[2] = {INFINITY, -INFINITY};
    for (int a = 0; a < 3; a++) {
        first[a] = at[a] > 0 ? at[a] - 1 : 0;
        end[a] = at[a] + 3 < v->dim[a] ? at[a] + 3 : v->dim[a];
        low[a] = first[a] / CWI_RANGE_EDGE;
        high[a] = (at[a] + 1) / CWI_RANGE_EDGE;
        if (low[a] >= blocks->dim[a])
            low[a] = blocks->dim[a] - 1;
        if (high[a] >= blocks->dim[a])
            high[a] = blocks->dim[a] - 1;
    }
    for (size_t k = low[2]; k <= high[2]; k++)
        for (size_t j = low[1]; j <= high[1]; j++)
            for (size_t i = low[0]; i <= high[0]; i++) {
                const float *block =
                    blocks->blocks[(k * blocks->dim[1] + j) * blocks->dim[0] + i];
                range[0] = fmin(range[0], (double)block[0]);
                range[1] = fmax(range[1], (double)block[1]);
            }
    if (!has_two_materials(t, range[0], range[1]))
        return false;
    range[0] = INFINITY, range[1] = -INFINITY;
    widen_range(v, first, end, range);
    return has_two_materials(t, range[0] + v->intercept, range[1] + v->intercept);
}

/* The layer of voxels that is being quantised. */
typedef struct layer_job {
    const cw_volume *volume, *gradients;
    const cwi_ranges *blocks;
    const shaded_state *state;
    double to_world[3][3]; /* gradients, but for a factor */
    double longest;        /* no gradient is longer */
} layer_job;

/* Returns the range of the field whose gradients are quantised. */
static double find_range(const cwi_gl *gl)
{
    const cw_transfer *t = &gl->frame->transfer;
    double low = INFINITY, high = -INFINITY;
    for (size_t n = 0; n < t->index_count; n++) {
        low = fmin(low, (double)t->indices[n].index);
        high = fmax(high, (double)t->indices[n].index);
    }
    return low < high ? high - low : gl->volume.range;
}

static layer_job start_layers(const cwi_gl *gl, const shaded_state *t)
{
    const cw_volume *v = &gl->frame->gradient_volume;
    layer_job job = {
        .volume = &gl->frame->volume, .gradients = v, .blocks = &gl->volume.ranges, .state = t};
    double sum = 0;
    cwi_affine_cofactor(v->affine[0], job.to_world);
    const double sign = cwi_affine_determinant(v->affine[0]) * v->slope < 0 ? -1 : 1;
    for (int n = 0; n < 9; n++) {
        job.to_world[n / 3][n % 3] *= sign;
        sum += job.to_world[n / 3][n % 3] * job.to_world[n / 3][n % 3];
    }
    job.longest = sqrt(3 * sum) * find_range(gl) / fabs(v->slope);
    return job;
}

/* Puts the number of a voxel's direction, or of the row after all where there is none; whether
 * the gradient is opposite to it; whether the cell above the voxel is at a boundary; and, if it is
 * asked for, the root of the gradient's length. */
static void put_normal(const layer_job *job, const size_t at[3], uint16_t *out)
{
    const shaded_state *t = job->state;
    double gradient[3], world[3];
    cwi_lattice_gradient(job->gradients, at, gradient);
    for (int r = 0; r < 3; r++)
        world[r] = cwi_dot(job->to_world[r], gradient);
    const size_t n = cwi_directions_nearest(&t->directions, world);
    const bool marked = t->normals_key.mark_boundary &&
                        is_boundary(job->volume, job->blocks, &t->normals_key.transfer, at);
    const bool is_opposite =
        n < t->directions.count && cwi_dot(t->directions.all[n], world) < 0;
    out[0] = (uint16_t)(n | (is_opposite ? OPPOSITE : 0) | (marked ? BOUNDARY : 0));
    if (t->normals_key.has_lengths)
        out[1] = (uint16_t)lround(UINT16_MAX * sqrt(fmin(cwi_length(world) / job->longest, 1)));
}

/* A layer of a brick whose normals are put. */
typedef struct layer_copy {
    const layer_job *job;
    const cwi_gl_brick *brick;
    size_t k, channels;
    uint16_t *to;
} layer_copy;

static void put_normal_row(void *context, size_t j)
{
    const layer_copy *c = context;
    const cwi_gl_brick *b = c->brick;
    for (size_t i = 0; i < b->count[0]; i++) {
        const size_t at[3] = {b->first[0] + i, b->first[1] + j, b->first[2] + c->k};
        put_normal(c->job, at, c->to + c->channels * (j * b->count[0] + i));
    }
}

enum { WORK = 16 }; /* of a voxel, in samples that are read */

static cw_status upload_normals(cwi_gl *gl, shaded_state *t, size_t brick, cw_error *err)
{
    const cwi_gl_brick *b = &gl->volume.bricks[brick];
    const GLsizei w = (GLsizei)b->count[0], h = (GLsizei)b->count[1], d = (GLsizei)b->count[2];
    const size_t channels = t->normals_key.has_lengths ? 2 : 1;
    const GLenum format = channels == 2 ? GL_RG_INTEGER : GL_RED_INTEGER;
    const layer_job job = start_layers(gl, t);
    uint16_t *layer = cwi_alloc_array(b->count[0] * b->count[1], channels * sizeof *layer);
    if (!layer)
        return cwi_fail_memory(err);
    t->normals[brick] = cwi_gl_texture(GL_TEXTURE_3D, CWI_UNIT_NORMALS, false);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    glTexImage3D(GL_TEXTURE_3D, 0, channels == 2 ? GL_RG16UI : GL_R16UI, w, h, d, 0, format,
                 GL_UNSIGNED_SHORT, NULL);
    cw_status st = CW_OK;
    for (GLint k = 0; k < d && st == CW_OK; k++) {
        layer_copy copy = {&job, b, (size_t)k, channels, layer};
        cwi_parallel_for_all(b->count[1], WORK * b->count[0], gl->frame->scene.threads,
                             put_normal_row, &copy);
        glTexSubImage3D(GL_TEXTURE_3D, 0, 0, 0, k, w, h, 1, format, GL_UNSIGNED_SHORT, layer);
        st = cwi_gl_report_soon(gl, "uploading", (double)k / (double)d, err);
    }
    cwi_free(layer);
    return st;
}

/* Returns true if directions are interpolated, and lit in the shader. */
static bool is_interpolated(const cw_scene *s)
{
    return s->texture.direction_filter == CW_DIRECTIONS_LINEAR && !s->texture.colors_first;
}

static cw_status need_normals(cwi_gl *gl, shaded_state *t, cw_error *err)
{
    const cw_scene *s = &gl->frame->scene;
    normals_key key;
    memset(&key, 0, sizeof key); /* keys are compared by their bytes */
    key.count = s->texture.normals;
    key.mark_boundary = s->texture.mark_boundary;
    key.has_lengths = is_interpolated(s);
    key.gradient_version = gl->frame->gradient_version;
    if (s->texture.mark_boundary)
        memcpy(&key.transfer, &gl->frame->transfer, sizeof key.transfer);
    if (t->normals && memcmp(&key, &t->normals_key, sizeof key) == 0)
        return CW_OK;
    drop_normals(t);
    memcpy(&t->normals_key, &key, sizeof key);
    cw_status st = cwi_directions_make(s->texture.normals, &t->directions, err);
    if (st != CW_OK)
        return st;
    t->normals = cwi_alloc_zeroed(gl->volume.brick_count, sizeof *t->normals);
    if (!t->normals)
        return cwi_fail_memory(err);
    t->brick_count = gl->volume.brick_count;
    for (size_t n = 0; n < t->brick_count && st == CW_OK; n++)
        st = upload_normals(gl, t, n, err);
    if (st != CW_OK)
        drop_normals(t);
    return st;
}

/* Finds the direction from the middle of the volume to the eye: in perspective, one direction
 * for the whole volume. */
static void find_to_eye(const cwi_frame *f, double to_eye[3])
{
    double middle[3], eye[3];
    cwi_midpoint(f->low, f->high, middle);
    cwi_affine_apply(f->eye_from_index, middle, eye);
    const double length = cwi_length(eye);
    for (int a = 0; a < 3; a++)
        to_eye[a] = f->perspective && length > 0 ? -eye[a] / length : a == 2;
}

static void fill_key(const cwi_gl *gl, shades_key *key)
{
    const cwi_frame *f = gl->frame;
    const layer_job job = start_layers(gl, NULL);
    memset(key, 0, sizeof *key);
    key->count = f->scene.texture.normals;
    key->is_unlit = is_interpolated(&f->scene);
    key->by_material = f->scene.texture.material_table;
    key->opacity_units = f->opacity_units;
    key->light_count = f->scene.light_count;
    memcpy(key->lights, f->scene.lights, key->light_count * sizeof *key->lights);
    key->material = f->scene.material;
    key->one_sided = f->scene.one_sided;
    memcpy(key->axes, f->axes, sizeof key->axes);
    key->longest =
        job.longest * job.gradients->slope * f->unit_mm /
        (cwi_affine_determinant(job.gradients->affine[0]) * gl->volume.gradient_unit);
    key->longest = fabs(key->longest);
    find_to_eye(f, key->to_eye);
    memcpy(&key->transfer, &f->transfer, sizeof key->transfer);
    key->low = gl->transfer.table.low;
    key->high = gl->transfer.table.high;
}

/* Light of a direction of the table, as shade() of common.glsl computes it: gain x colour +
 * shine. */
typedef struct reflection {
    double gain[3], shine[3];
} reflection;

static void add_light(const shades_key *key, const cw_light *light, const double n[3],
                      reflection *r)
{
    const double length = cwi_length(light->direction);
    double to_light[3], half[3];
    for (int a = 0; a < 3; a++) {
        to_light[a] = length > 0 ? light->direction[a] / length : 0;
        half[a] = to_light[a] + key->to_eye[a];
    }
    const double facing = -cwi_dot(n, to_light);
    if (key->one_sided && !(facing > 0))
        return;
    const double diffuse = (double)key->material.diffuse * fabs(facing);
    const double size = cwi_length(half);
    const double specular = size > 0 ? fmin(fabs(cwi_dot(n, half)) / size, 1) : 0;
    const double shine =
        (double)key->material.specular * pow(specular, (double)key->material.shininess);
    for (int c = 0; c < 3; c++) {
        r->gain[c] += diffuse * (double)light->color[c];
        r->shine[c] += shine * (double)light->color[c];
    }
}

/* direction: of the gradient in the world, times sign; NULL where there is none */
static reflection reflect_light(const shades_key *key, const double *direction, double sign)
{
    const double ambient = (double)key->material.ambient;
    reflection r = {{ambient, ambient, ambient}, {0}};
    double n[3];
    for (int a = 0; direction && a < 3; a++)
        n[a] = sign * cwi_dot(key->axes[a], direction);
    for (size_t l = 0; direction && l < key->light_count; l++)
        add_light(key, &key->lights[l], n, &r);
    return r;
}

/* Returns the number of rows: one for each direction and one for none; twice that if opposite
 * gradients are lit otherwise. */
static size_t count_rows(const shades_key *key, const cwi_directions *d)
{
    return key->is_unlit ? 1 : (d->count + 1) * (key->one_sided ? 2 : 1);
}

/* Returns the number of columns: values, or materials after one for what is invisible. */
static size_t count_columns(const shades_key *key)
{
    return key->by_material ? key->transfer.opacity_count + 2 : VALUE_COLUMNS;
}

/* Computes the mean colour and extinction of a range of values. */
static void mean_of(const cwi_frame *f, double from, double to, double mean[4])
{
    double plain[3] = {0};
    memset(mean, 0, 4 * sizeof *mean);
    for (int n = 0; n < MEANS; n++) {
        double color[3], opacity;
        cw_transfer_at(&f->transfer, from + (to - from) * (n + 0.5) / MEANS, color, &opacity);
        const double extinction = cwi_frame_extinction(f, opacity);
        for (int c = 0; c < 3; c++) {
            mean[c] += extinction * color[c];
            plain[c] += color[c] / MEANS;
        }
        mean[3] += extinction / MEANS;
    }
    for (int c = 0; c < 3; c++)
        mean[c] = mean[3] > 0 ? mean[c] / MEANS / mean[3] : plain[c];
}

/* Computes the unlit colour and the extinction of a column. */
static void put_column(const cwi_frame *f, const shades_key *key, size_t column, double out[4])
{
    const cw_transfer *t = &key->transfer;
    const double fraction = (double)column / (VALUE_COLUMNS - 1);
    double opacity;
    memset(out, 0, 4 * sizeof *out);
    if (!key->by_material) {
        cw_transfer_at(t, key->low + (key->high - key->low) * fraction, out, &opacity);
        out[3] = 1;
    } else if (column > 0) {
        const size_t n = column - 1; /* points that are not above */
        const double from =
            n > 0 ? t->opacities[n - 1].value : fmin(key->low, t->opacities[0].value);
        const double to = n < t->opacity_count ? t->opacities[n].value : fmax(key->high, from);
        mean_of(f, from, to, out);
    }
}

static void put_shades(const cwi_frame *f, const shades_key *key, const cwi_directions *d,
                       float *out)
{
    const size_t rows = count_rows(key, d), columns = count_columns(key);
    for (size_t m = 0; m < columns; m++) {
        double color[4];
        put_column(f, key, m, color);
        for (size_t n = 0; n < rows; n++)
            for (size_t c = 0; c < 4; c++)
                out[4 * (n * columns + m) + c] = (float)color[c];
    }
    for (size_t n = 0; n < rows && !key->is_unlit; n++) {
        const size_t row = n % (d->count + 1);
        const reflection r =
            reflect_light(key, row < d->count ? d->all[row] : NULL, row < n ? -1 : 1);
        for (size_t m = 0; m < 4 * columns; m++)
            if (m % 4 < 3)
                out[4 * n * columns + m] =
                    (float)(r.gain[m % 4] * (double)out[4 * n * columns + m] + r.shine[m % 4]);
    }
}

/* Puts the column of each value, and 0 where it is invisible. */
static void make_materials(const shades_key *key, shaded_state *t)
{
    float columns[MATERIAL_ROWS];
    for (int n = 0; n < MATERIAL_ROWS; n++) {
        const double value = key->low + (key->high - key->low) * n / (MATERIAL_ROWS - 1);
        double color[3], opacity;
        cw_transfer_at(&key->transfer, value, color, &opacity);
        columns[n] = opacity > 0 ? 1 + (float)material_of(&key->transfer, value) : 0;
    }
    glDeleteTextures(1, &t->materials);
    t->materials = cwi_gl_texture(GL_TEXTURE_1D, CWI_UNIT_MATERIALS, false);
    glTexImage1D(GL_TEXTURE_1D, 0, GL_R32F, MATERIAL_ROWS, 0, GL_RED, GL_FLOAT, columns);
}

/* Puts the directions in eye space, as long as the longest gradient, and 0 for none. */
static cw_status make_directions(const shades_key *key, shaded_state *t, cw_error *err)
{
    const cwi_directions *d = &t->directions;
    float(*all)[4] = cwi_alloc_zeroed(d->count + 1, sizeof *all);
    if (!all)
        return cwi_fail_memory(err);
    for (size_t n = 0; n < d->count; n++)
        for (int a = 0; a < 3; a++)
            all[n][a] = (float)(key->longest * cwi_dot(key->axes[a], d->all[n]));
    glDeleteTextures(1, &t->directions_table);
    t->directions_table = cwi_gl_texture(GL_TEXTURE_2D, CWI_UNIT_DIRECTIONS, false);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, (GLsizei)(d->count + 1), 1, 0, GL_RGBA, GL_FLOAT,
                 all);
    cwi_free(all);
    return CW_OK;
}

static cw_status need_shades(const cwi_gl *gl, shaded_state *t, cw_error *err)
{
    shades_key key;
    fill_key(gl, &key);
    if (t->shades && memcmp(&key, &t->shades_key, sizeof key) == 0)
        return CW_OK;
    const size_t rows = count_rows(&key, &t->directions), columns = count_columns(&key);
    float *all = cwi_alloc_array(rows * columns, 4 * sizeof *all);
    if (!all)
        return cwi_fail_memory(err);
    put_shades(gl->frame, &key, &t->directions, all);
    glDeleteTextures(1, &t->shades);
    t->shades = cwi_gl_texture(GL_TEXTURE_2D, CWI_UNIT_SHADES, true);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, (GLsizei)columns, (GLsizei)rows, 0, GL_RGBA,
                 GL_FLOAT, all);
    cwi_free(all);
    if (key.by_material)
        make_materials(&key, t);
    memset(&t->shades_key, 0, sizeof t->shades_key);
    cw_status st = key.is_unlit ? make_directions(&key, t, err) : CW_OK;
    if (st == CW_OK)
        memcpy(&t->shades_key, &key, sizeof key);
    return st;
}

static void bind_brick(const void *state, size_t brick)
{
    const shaded_state *t = state;
    glActiveTexture(GL_TEXTURE0 + CWI_UNIT_NORMALS);
    glBindTexture(GL_TEXTURE_3D, t->normals[brick]);
    glActiveTexture(GL_TEXTURE0 + CWI_UNIT_SHADES);
    glBindTexture(GL_TEXTURE_2D, t->shades);
    glActiveTexture(GL_TEXTURE0 + CWI_UNIT_DIRECTIONS);
    glBindTexture(GL_TEXTURE_2D, t->directions_table);
    glActiveTexture(GL_TEXTURE0 + CWI_UNIT_MATERIALS);
    glBindTexture(GL_TEXTURE_1D, t->materials);
}

static cw_status draw_shaded_texture(cwi_gl *gl, void **state, cw_error *err)
{
    char defines[128];
    const char *gradients = "";
    const cw_scene *s = &gl->frame->scene;
    cw_status st = CW_OK;
    if (!*state)
        *state = cwi_alloc_zeroed(1, sizeof(shaded_state));
    shaded_state *t = *state;
    if (!t)
        return cwi_fail_memory(err);
    if (gl->frame->transfer.gradient_count > 0)
        st = cwi_gl_need_gradients(gl, &gradients, err);
    if (st == CW_OK)
        st = need_normals(gl, t, err);
    if (st == CW_OK)
        st = need_shades(gl, t, err);
    if (st != CW_OK)
        return st;
    snprintf(defines, sizeof defines, "%s#define SHADES\n%s%s%s%s", gradients,
             s->texture.colors_first ? "#define COLORS\n" : "",
             is_interpolated(s) ? "#define DIRECTIONS\n" : "",
             s->texture.material_table ? "#define MATERIALS\n" : "",
             s->texture.mark_boundary ? "#define BOUNDARY\n" : "");
    return cwi_gl_draw_slices(gl, &t->slices, defines, bind_brick, t, err);
}

const cwi_gl_mode cwi_gl_shaded_texture = {CW_MODE_SHADED_TEXTURE, true, draw_shaded_texture,
                                           drop_shaded_texture, true};
