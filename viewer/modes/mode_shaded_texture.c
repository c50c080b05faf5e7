/* Draws slices through textures of values and quantised gradients [VanGelder1996]. A small
 * table has the shaded colour of every direction and value: another light changes the table
 * alone. */
#include "viewer/modes/slab_textures.h"

#include "viewer/proxy/quantized_normals.h"
#include "viewer/scene/cell_lattice.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/affine.h"
#include "core/geometry/vec3.h"
#include "core/volume/volume.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* A voxel's direction: its row of the table, and flags. A gradient may be opposite to the
 * direction of its row, which is in a half sphere. */
enum { SHADE_COLUMNS = 256, OPPOSITE = 1 << 14, BOUNDARY = 1 << 15 };

/* Settings that the textures of directions depend on, beside the volume. */
typedef struct normals_key {
    size_t count;
    bool mark_boundary;
    cw_transfer transfer; /* zeroed unless boundaries are marked */
} normals_key;

/* Settings that the table of colours depends on. */
typedef struct shades_key {
    size_t count, light_count;
    cw_light lights[CW_MAX_LIGHTS];
    cw_material material;
    bool one_sided; /* the table has a second half, for opposite gradients */
    double axes[3][3], to_eye[3];
    cw_transfer transfer;
    double low, high; /* values of the first column and the last */
} shades_key;

typedef struct shaded_state {
    cwi_gl_slabs slices;
    cwi_directions directions;
    size_t brick_count;
    GLuint *normals, shades;
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

/* Returns true if a cell is at a boundary: its samples are of more than one material. */
static bool is_boundary(const cw_volume *v, const cw_transfer *t, const size_t at[3])
{
    double range[2] = {INFINITY, -INFINITY};
    for (size_t n = 0; n < 8; n++) {
        size_t p[3];
        for (size_t a = 0; a < 3; a++)
            p[a] = at[a] + (n >> a & 1) < v->dim[a] ? at[a] + (n >> a & 1) : at[a];
        const double x =
            v->slope * cwi_voxel_at(v->type, cwi_voxel_address(v, p[0], p[1], p[2]));
        range[0] = fmin(range[0], x);
        range[1] = fmax(range[1], x);
    }
    return material_of(t, range[0] + v->intercept) != material_of(t, range[1] + v->intercept);
}

/* Returns the number of a voxel's direction, or of the row after all where there is none; whether
 * the gradient is opposite to it; and whether the cell above the voxel is at a boundary. */
static uint16_t normal_of(const cw_volume *v, const cw_volume *gradients, const shaded_state *t,
                          const double to_world[3][3], const size_t at[3])
{
    double gradient[3], world[3];
    cwi_lattice_gradient(gradients, at, gradient);
    for (int r = 0; r < 3; r++)
        world[r] = cwi_dot(to_world[r], gradient);
    const size_t n = cwi_directions_nearest(&t->directions, world);
    const bool marked =
        t->normals_key.mark_boundary && is_boundary(v, &t->normals_key.transfer, at);
    const bool is_opposite =
        n < t->directions.count && cwi_dot(t->directions.all[n], world) < 0;
    return (uint16_t)(n | (is_opposite ? OPPOSITE : 0) | (marked ? BOUNDARY : 0));
}

static void put_layer(const cwi_gl *gl, const shaded_state *t, const cwi_gl_brick *b, size_t k,
                      uint16_t *out)
{
    const cw_volume *v = &gl->frame->volume;
    double to_world[3][3];
    cwi_affine_cofactor(v->affine[0], to_world);
    const double sign = cwi_affine_determinant(v->affine[0]) * v->slope < 0 ? -1 : 1;
    for (int n = 0; n < 9; n++)
        to_world[n / 3][n % 3] *= sign;
#pragma omp parallel for num_threads(cwi_threads(gl->frame->scene.threads))
    for (size_t j = 0; j < b->count[1]; j++)
        for (size_t i = 0; i < b->count[0]; i++) {
            const size_t at[3] = {b->first[0] + i, b->first[1] + j, b->first[2] + k};
            out[j * b->count[0] + i] =
                normal_of(v, &gl->frame->gradient_volume, t, (const double(*)[3])to_world, at);
        }
}

static cw_status upload_normals(cwi_gl *gl, shaded_state *t, size_t brick, cw_error *err)
{
    const cwi_gl_brick *b = &gl->volume.bricks[brick];
    const GLsizei w = (GLsizei)b->count[0], h = (GLsizei)b->count[1], d = (GLsizei)b->count[2];
    uint16_t *layer = cwi_alloc_array(b->count[0] * b->count[1], sizeof *layer);
    if (!layer)
        return cwi_fail(err, CW_ERR_NO_MEMORY, "no memory for directions of gradients");
    t->normals[brick] = cwi_gl_texture(GL_TEXTURE_3D, CWI_UNIT_NORMALS, false);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    glTexImage3D(GL_TEXTURE_3D, 0, GL_R16UI, w, h, d, 0, GL_RED_INTEGER, GL_UNSIGNED_SHORT,
                 NULL);
    cw_status st = CW_OK;
    for (GLint k = 0; k < d && st == CW_OK; k++) {
        put_layer(gl, t, b, (size_t)k, layer);
        glTexSubImage3D(GL_TEXTURE_3D, 0, 0, 0, k, w, h, 1, GL_RED_INTEGER, GL_UNSIGNED_SHORT,
                        layer);
        st = cwi_gl_report_soon(gl, "uploading", (double)k / (double)d, err);
    }
    cwi_free(layer);
    return st;
}

static cw_status need_normals(cwi_gl *gl, shaded_state *t, cw_error *err)
{
    const cw_scene *s = &gl->frame->scene;
    normals_key key;
    memset(&key, 0, sizeof key); /* keys are compared by their bytes */
    key.count = s->normals;
    key.mark_boundary = s->mark_boundary;
    if (s->mark_boundary)
        memcpy(&key.transfer, &gl->frame->transfer, sizeof key.transfer);
    if (t->normals && memcmp(&key, &t->normals_key, sizeof key) == 0)
        return CW_OK;
    drop_normals(t);
    memcpy(&t->normals_key, &key, sizeof key);
    cw_status st = cwi_directions_make(s->normals, &t->directions, err);
    if (st != CW_OK)
        return st;
    t->normals = cwi_alloc_zeroed(gl->volume.brick_count, sizeof *t->normals);
    if (!t->normals)
        return cwi_fail(err, CW_ERR_NO_MEMORY, "no memory for directions of gradients");
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
    for (int a = 0; a < 3; a++)
        middle[a] = (f->low[a] + f->high[a]) / 2;
    cwi_affine_apply(f->eye_from_index, middle, eye);
    const double length = sqrt(cwi_dot(eye, eye));
    for (int a = 0; a < 3; a++)
        to_eye[a] = f->perspective && length > 0 ? -eye[a] / length : a == 2;
}

static void fill_key(const cwi_gl *gl, shades_key *key)
{
    const cwi_frame *f = gl->frame;
    memset(key, 0, sizeof *key);
    key->count = f->scene.normals;
    key->light_count = f->scene.light_count;
    memcpy(key->lights, f->scene.lights, key->light_count * sizeof *key->lights);
    key->material = f->scene.material;
    key->one_sided = f->scene.one_sided;
    memcpy(key->axes, f->axes, sizeof key->axes);
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
    const double length = sqrt(cwi_dot(light->direction, light->direction));
    double to_light[3], half[3];
    for (int a = 0; a < 3; a++) {
        to_light[a] = length > 0 ? light->direction[a] / length : 0;
        half[a] = to_light[a] + key->to_eye[a];
    }
    const double facing = -cwi_dot(n, to_light);
    if (key->one_sided && !(facing > 0))
        return;
    const double diffuse = (double)key->material.diffuse * fabs(facing);
    const double size = sqrt(cwi_dot(half, half));
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
    return (d->count + 1) * (key->one_sided ? 2 : 1);
}

static void put_shades(const shades_key *key, const cwi_directions *d,
                       float (*out)[SHADE_COLUMNS][4])
{
    double colors[SHADE_COLUMNS][3], opacity;
    for (int m = 0; m < SHADE_COLUMNS; m++)
        cw_transfer_at(&key->transfer,
                       key->low + (key->high - key->low) * m / (SHADE_COLUMNS - 1), colors[m],
                       &opacity);
    for (size_t n = 0; n < count_rows(key, d); n++) {
        const size_t row = n % (d->count + 1);
        const reflection r =
            reflect_light(key, row < d->count ? d->all[row] : NULL, row < n ? -1 : 1);
        for (int m = 0; m < SHADE_COLUMNS; m++)
            for (int c = 0; c < 4; c++)
                out[n][m][c] = c < 3 ? (float)(r.gain[c] * colors[m][c] + r.shine[c]) : 1;
    }
}

static cw_status need_shades(const cwi_gl *gl, shaded_state *t, cw_error *err)
{
    shades_key key;
    fill_key(gl, &key);
    if (t->shades && memcmp(&key, &t->shades_key, sizeof key) == 0)
        return CW_OK;
    float(*all)[SHADE_COLUMNS][4] =
        cwi_alloc_array(count_rows(&key, &t->directions), sizeof *all);
    if (!all)
        return cwi_fail(err, CW_ERR_NO_MEMORY, "no memory for shaded colours");
    put_shades(&key, &t->directions, all);
    glDeleteTextures(1, &t->shades);
    t->shades = cwi_gl_texture(GL_TEXTURE_2D, CWI_UNIT_SHADES, true);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, SHADE_COLUMNS,
                 (GLsizei)count_rows(&key, &t->directions), 0, GL_RGBA, GL_FLOAT, all);
    memcpy(&t->shades_key, &key, sizeof key);
    cwi_free(all);
    return CW_OK;
}

static void bind_brick(const void *state, size_t brick)
{
    const shaded_state *t = state;
    glActiveTexture(GL_TEXTURE0 + CWI_UNIT_NORMALS);
    glBindTexture(GL_TEXTURE_3D, t->normals[brick]);
    glActiveTexture(GL_TEXTURE0 + CWI_UNIT_SHADES);
    glBindTexture(GL_TEXTURE_2D, t->shades);
}

static cw_status draw_shaded_texture(cwi_gl *gl, void **state, cw_error *err)
{
    char defines[80];
    const char *gradients = "";
    const cw_scene *s = &gl->frame->scene;
    cw_status st = CW_OK;
    if (!*state)
        *state = cwi_alloc_zeroed(1, sizeof(shaded_state));
    shaded_state *t = *state;
    if (!t)
        return cwi_fail(err, CW_ERR_NO_MEMORY, "no memory for slices");
    if (gl->frame->transfer.gradient_count > 0)
        st = cwi_gl_need_gradients(gl, &gradients, err);
    if (st == CW_OK)
        st = need_normals(gl, t, err);
    if (st == CW_OK)
        st = need_shades(gl, t, err);
    if (st != CW_OK)
        return st;
    snprintf(defines, sizeof defines, "%s#define SHADES\n%s%s", gradients,
             s->colors_first ? "#define COLORS\n" : "",
             s->mark_boundary ? "#define BOUNDARY\n" : "");
    return cwi_gl_draw_slices(gl, &t->slices, defines, bind_brick, t, err);
}

const cwi_gl_mode cwi_gl_shaded_texture = {CW_MODE_SHADED_TEXTURE, true, draw_shaded_texture,
                                           drop_shaded_texture, true};
