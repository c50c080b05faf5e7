/* Draws a volume by coherent projection: cells, and nodes of similar cells, as polygons from
 * back to front. */
#include "viewer/proxy/projected_cells.h"
#include "viewer/scene/cell_lattice.h"

#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/affine.h"
#include "core/geometry/vec3.h"
#include "viewer/modes/gl_draw.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

extern const char cwi_glsl_projection[];

enum {
    EDGE = CWI_RANGE_EDGE, /* cells along a side of a node at the top */
    SIDE = EDGE + 1,
    CHUNK_VERTICES = 1 << 16,
    CHUNK_INDICES = 3 << 16
};

/* A vertex as shaders/projection.glsl reads it. */
typedef struct vertex {
    float position[4], values[3];
} vertex;

/* The pieces of one cell in an orthographic view; those of all cells are the same but for a
 * shift. */
typedef struct pattern {
    bool is_made;
    double size[3];
    cwi_pieces pieces;
    float front[CWI_PIECE_VERTICES][8], back[CWI_PIECE_VERTICES][8]; /* weights of corners */
} pattern;

typedef struct job {
    cwi_gl *gl;
    cw_status status; /* once it is not CW_OK nothing more is drawn */
    cw_error *err;
    const cwi_frame *frame;
    cwi_visible visible;
    double eye[3];
    float tolerance; /* half the range of values within a node drawn whole; below 0: none is */
    GLuint array, buffers[2];
    vertex *vertices;
    uint32_t *indices;
    size_t vertex_count, index_count;
    pattern pattern;
    /* The block that is being drawn: coordinates of its samples. */
    size_t first[3];
    float samples[SIDE * SIDE * SIDE];
} job;

/* A node: cells from first to first + count of the block. */
typedef struct node {
    size_t first[3], count[3], edge;
} node;

static void flush_triangles(job *j)
{
    if (j->index_count > 0 && j->status == CW_OK) {
        glBufferData(GL_ARRAY_BUFFER, (GLsizeiptr)(j->vertex_count * sizeof *j->vertices),
                     j->vertices, GL_STREAM_DRAW);
        glBufferData(GL_ELEMENT_ARRAY_BUFFER, (GLsizeiptr)(j->index_count * sizeof *j->indices),
                     j->indices, GL_STREAM_DRAW);
        j->status = cwi_gl_draw_triangles(j->gl, j->index_count / 3, true, j->err);
    }
    j->vertex_count = j->index_count = 0;
}

/* Computes the weight of each corner of a box at a point, from 0 to 1 along each axis. */
static void corner_weights(const double at[3], float w[8])
{
    for (int n = 0; n < 8; n++) {
        double product = 1;
        for (int a = 0; a < 3; a++) {
            const double t = cwi_lesser(cwi_greater(at[a], 0), 1);
            product *= n >> a & 1 ? t : 1 - t;
        }
        w[n] = (float)product;
    }
}

/* Computes the position in a box of a point of the picture at a depth. */
static void place_in_box(const cwi_frame *f, const double at[2], double depth,
                         const double low[3], const double size[3], double fraction[3])
{
    const double scale = f->perspective ? depth : 1;
    const double p[3] = {at[0] * scale, at[1] * scale, -depth};
    cwi_affine_apply(f->index_from_eye, p, fraction);
    for (int a = 0; a < 3; a++)
        fraction[a] = (fraction[a] - low[a]) / size[a];
}

static void weigh_vertex(const cwi_frame *f, const cwi_piece_vertex *v, const double low[3],
                         const double size[3], float front[8], float back[8])
{
    double fraction[3];
    place_in_box(f, v->at, v->front, low, size, fraction);
    corner_weights(fraction, front);
    place_in_box(f, v->at, v->back, low, size, fraction);
    corner_weights(fraction, back);
}

static double sum_eight(const float w[8], const float values[8])
{
    float sum = 0;
    for (int n = 0; n < 8; n++)
        sum += w[n] * values[n];
    return (double)sum;
}

static void put_vertex(const job *j, const double at[2], double front, double back, double x,
                       double y, vertex *to)
{
    const cwi_frame *f = j->frame;
    const double a = f->perspective ? 1 / front : front;
    const double thick = f->perspective ? (back - front) / (front * back) : back - front;
    to->position[0] = (float)(at[0] / f->half[0]);
    to->position[1] = (float)(at[1] / f->half[1]);
    to->position[2] = (float)a;
    to->position[3] = (float)thick;
    to->values[0] = (float)(f->perspective ? x / front : x);
    to->values[1] = (float)(f->perspective ? y / back : y);
}

static void make_pattern(job *j, const double size[3])
{
    const double low[3] = {0};
    pattern *p = &j->pattern;
    if (p->is_made && memcmp(p->size, size, sizeof p->size) == 0)
        return;
    p->is_made = true;
    memcpy(p->size, size, sizeof p->size);
    cwi_pieces_make(j->frame, low, size, &p->pieces);
    for (size_t n = 0; n < p->pieces.vertex_count; n++)
        weigh_vertex(j->frame, &p->pieces.vertices[n], low, size, p->front[n], p->back[n]);
}

/* Returns true if all of the vertices from a number on are beyond one side of the picture. */
static bool is_outside(const job *j, size_t from)
{
    bool out[4] = {true, true, true, true};
    for (size_t n = from; n < j->vertex_count; n++)
        for (int c = 0; c < 4; c++)
            out[c] = out[c] && (c & 2 ? -1 : 1) * j->vertices[n].position[c & 1] > 1;
    return out[0] || out[1] || out[2] || out[3];
}

static void put_pieces(job *j, const cwi_pieces *pieces, size_t from)
{
    double max = 0;
    for (size_t n = 0; n < pieces->vertex_count; n++)
        max = cwi_greater(max, pieces->vertices[n].back - pieces->vertices[n].front);
    for (size_t n = 0; n < pieces->vertex_count; n++)
        j->vertices[from + n].values[2] = (float)max;
    j->vertex_count = from + pieces->vertex_count;
    if (is_outside(j, from)) {
        j->vertex_count = from;
        return;
    }
    for (size_t n = 0; n < pieces->index_count; n++)
        j->indices[j->index_count++] = (uint32_t)(from + pieces->indices[n]);
}

static void draw_shifted(job *j, const double low[3], const double size[3], const float v[8])
{
    const size_t from = j->vertex_count;
    const double *m = j->frame->eye_from_index;
    double shift[3];
    make_pattern(j, size);
    for (int r = 0; r < 3; r++)
        shift[r] = cwi_dot(m + (ptrdiff_t)4 * r, low);
    const cwi_pieces *p = &j->pattern.pieces;
    for (size_t n = 0; n < p->vertex_count; n++) {
        const cwi_piece_vertex *u = &p->vertices[n];
        const double at[2] = {u->at[0] + shift[0], u->at[1] + shift[1]};
        put_vertex(j, at, u->front - shift[2], u->back - shift[2],
                   sum_eight(j->pattern.front[n], v), sum_eight(j->pattern.back[n], v),
                   &j->vertices[from + n]);
    }
    put_pieces(j, p, from);
}

static void draw_single(job *j, const double low[3], const double size[3], const float v[8])
{
    cwi_pieces pieces;
    float front[8], back[8];
    const size_t from = j->vertex_count;
    const double high[3] = {low[0] + size[0], low[1] + size[1], low[2] + size[2]};
    cwi_pieces_make(j->frame, low, high, &pieces);
    for (size_t n = 0; n < pieces.vertex_count; n++) {
        const cwi_piece_vertex *u = &pieces.vertices[n];
        weigh_vertex(j->frame, u, low, size, front, back);
        put_vertex(j, u->at, u->front, u->back, sum_eight(front, v), sum_eight(back, v),
                   &j->vertices[from + n]);
    }
    put_pieces(j, &pieces, from);
}

/* Returns the last of the samples along an axis of a node's cells: there is one where the
 * volume is a single layer. */
static size_t last_of(const job *j, int axis, size_t n)
{
    return j->frame->volume.dim[axis] > 1 ? n : 0;
}

static float sample_at(const job *j, size_t x, size_t y, size_t z)
{
    return j->samples[(z * SIDE + y) * SIDE + x];
}

static void draw_node(job *j, const node *n)
{
    double low[3], size[3];
    float v[8];
    if (j->vertex_count + CWI_PIECE_VERTICES > CHUNK_VERTICES ||
        j->index_count + CWI_PIECE_INDICES > CHUNK_INDICES)
        flush_triangles(j);
    for (int a = 0; a < 3; a++) {
        low[a] = j->frame->low[a] + (double)(j->first[a] + n->first[a]);
        size[a] = (double)n->count[a];
    }
    for (size_t c = 0; c < 8; c++) {
        size_t at[3];
        for (int a = 0; a < 3; a++)
            at[a] = n->first[a] + (c >> a & 1 ? last_of(j, a, n->count[a]) : 0);
        v[c] = sample_at(j, at[0], at[1], at[2]);
    }
    if (j->frame->perspective)
        draw_single(j, low, size, v);
    else
        draw_shifted(j, low, size, v);
}

/* Finds the range of a node's samples; returns false if some have no value. */
static bool find_range(const job *j, const node *n, float range[2])
{
    size_t last[3];
    bool is_whole = true;
    range[0] = INFINITY;
    range[1] = -INFINITY;
    for (int a = 0; a < 3; a++)
        last[a] = n->first[a] + last_of(j, a, n->count[a]);
    for (size_t z = n->first[2]; z <= last[2]; z++)
        for (size_t y = n->first[1]; y <= last[1]; y++)
            for (size_t x = n->first[0]; x <= last[0]; x++) {
                const float s = sample_at(j, x, y, z);
                is_whole = is_whole && s == s;
                range[0] = s < range[0] ? s : range[0];
                range[1] = s > range[1] ? s : range[1];
            }
    return is_whole;
}

static float clamp_unit(float x)
{
    return x < 0 ? 0 : x > 1 ? 1 : x;
}

static void visit_node(job *j, const node *n);

/* Finds the two halves along an axis, if both exist, the farther first. */
static int split_node(const job *j, const node *n, int axis, size_t order[2])
{
    const size_t half = n->edge / 2;
    const double middle =
        j->frame->low[axis] + (double)(j->first[axis] + n->first[axis] + half);
    const bool high_first = j->eye[axis] < middle;
    order[0] = high_first;
    order[1] = !high_first;
    if (n->count[axis] > half)
        return 2;
    order[0] = 0;
    return 1;
}

static void visit_parts(job *j, const node *n)
{
    const size_t half = n->edge / 2;
    size_t order[3][2];
    int parts[3];
    for (int a = 0; a < 3; a++)
        parts[a] = split_node(j, n, a, order[a]);
    for (int p = 0; p < parts[0] * parts[1] * parts[2]; p++) {
        const int at[3] = {p % parts[0], p / parts[0] % parts[1], p / parts[0] / parts[1]};
        node part = {.edge = half};
        for (int a = 0; a < 3; a++) {
            const size_t skip = order[a][at[a]] * half, left = n->count[a] - skip;
            part.first[a] = n->first[a] + skip;
            part.count[a] = left < half ? left : half;
        }
        visit_node(j, &part);
    }
}

/* Visits a node: skips it if it shows nothing; draws it as one if its values are similar. */
static void visit_node(job *j, const node *n)
{
    float range[2];
    const bool is_whole = find_range(j, n, range);
    if (!cwi_visible_any(&j->visible, range[0], range[1]))
        return;
    const bool is_alike =
        is_whole && clamp_unit(range[1]) - clamp_unit(range[0]) <= 2 * j->tolerance;
    if (n->edge > 1 && !is_alike)
        visit_parts(j, n);
    else if (is_whole)
        draw_node(j, n);
}

/* Draws the cells of a block that are in a brick as well. */
static void draw_block(job *j, const cwi_gl_brick *brick, const size_t block[3])
{
    const cwi_table *t = &j->gl->transfer.table;
    const cwi_ranges *r = &j->gl->volume.ranges;
    const float *range = r->blocks[(block[2] * r->dim[1] + block[1]) * r->dim[0] + block[0]];
    const double scale = 1 / (t->high - t->low);
    if (!cwi_visible_any(&j->visible, (float)(((double)range[0] - t->low) * scale),
                         (float)(((double)range[1] - t->low) * scale)))
        return;
    node whole = {.edge = EDGE};
    size_t samples[3];
    for (int a = 0; a < 3; a++) {
        const size_t cells = brick->count[a] > 1 ? brick->count[a] - 1 : 1;
        const size_t from = EDGE * block[a], to = from + EDGE;
        const size_t end = brick->first[a] + cells;
        j->first[a] = from > brick->first[a] ? from : brick->first[a];
        whole.count[a] = (to < end ? to : end) - j->first[a];
        samples[a] = last_of(j, a, whole.count[a]) + 1;
    }
    float rows[SIDE * SIDE * SIDE];
    cwi_lattice_load(&j->frame->volume, t, j->first, samples, rows);
    for (size_t n = 0, z = 0; z < samples[2]; z++)
        for (size_t y = 0; y < samples[1]; y++, n += samples[0])
            memcpy(j->samples + (z * SIDE + y) * SIDE, rows + n, samples[0] * sizeof *rows);
    visit_node(j, &whole);
}

/* Orders the blocks of which a brick has cells, along an axis, from the farthest to the
 * nearest. */
static size_t *order_blocks(const job *j, const cwi_gl_brick *brick, int axis, size_t *count)
{
    const size_t cells = brick->count[axis] > 1 ? brick->count[axis] - 1 : 1;
    const size_t first = brick->first[axis] / EDGE;
    *count = (brick->first[axis] + cells - 1) / EDGE - first + 1;
    size_t *order = cwi_alloc_array(*count, sizeof *order);
    if (!order)
        return NULL;
    cwi_lattice_order(*count, (double)first * EDGE + EDGE / 2.0, EDGE, j->eye[axis], order);
    for (size_t n = 0; n < *count; n++)
        order[n] += first;
    return order;
}

/* Draws a layer of blocks, row by row: between rows drawing can be stopped. */
static void draw_row(job *j, const cwi_gl_brick *brick, size_t *const order[3], size_t count,
                     size_t y, size_t z)
{
    for (size_t x = 0; x < count; x++)
        draw_block(j, brick, (size_t[]){order[0][x], order[1][y], order[2][z]});
    if (j->status == CW_OK)
        j->status = cwi_gl_report_soon(j->gl, "cells", j->gl->watch.from, j->err);
}

static cw_status draw_brick(job *j, const cwi_gl_brick *brick, cw_error *err)
{
    size_t *order[3], count[3] = {0};
    cw_status st = CW_OK;
    for (int a = 0; a < 3; a++) {
        order[a] = order_blocks(j, brick, a, &count[a]);
        if (!order[a])
            st = cwi_fail_memory(err);
    }
    for (size_t z = 0; st == CW_OK && z < count[2]; z++) {
        cwi_gl_part(j->gl, z, count[2]);
        for (size_t y = 0; y < count[1] && j->status == CW_OK; y++)
            draw_row(j, brick, order, count[0], y, z);
        if (j->status == CW_OK)
            j->status = cwi_gl_report(j->gl, "cells", j->gl->watch.to, err);
        st = j->status;
    }
    flush_triangles(j);
    for (int a = 0; a < 3; a++)
        cwi_free(order[a]);
    return st == CW_OK ? j->status : st;
}

static void open_stream(job *j)
{
    glGenVertexArrays(1, &j->array);
    glGenBuffers(2, j->buffers);
    glBindVertexArray(j->array);
    glBindBuffer(GL_ARRAY_BUFFER, j->buffers[0]);
    glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, j->buffers[1]);
    glEnableVertexAttribArray(0);
    glEnableVertexAttribArray(1);
    glVertexAttribPointer(0, 4, GL_FLOAT, GL_FALSE, sizeof(vertex), NULL);
    glVertexAttribPointer(1, 3, GL_FLOAT, GL_FALSE, sizeof(vertex),
                          (const void *)offsetof(vertex, values));
    glDisable(GL_DEPTH_TEST); /* the shader ends rays at the mesh */
    glEnable(GL_BLEND);
    glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
}

static void close_stream(job *j)
{
    glDisable(GL_BLEND);
    glBindVertexArray(0);
    glDeleteVertexArrays(1, &j->array);
    glDeleteBuffers(2, j->buffers);
    cwi_free(j->vertices);
    cwi_free(j->indices);
    cwi_visible_free(&j->visible);
}

static cw_status open_job(cwi_gl *gl, job *j, const char **gradients, cw_error *err)
{
    const cw_scene *s = &gl->frame->scene;
    const bool needs_gradients = cwi_frame_needs_gradients(gl->frame);
    j->gl = gl;
    j->err = err;
    j->frame = gl->frame;
    j->tolerance = needs_gradients ? -1 : (float)s->projection.tree_error;
    cwi_lattice_eye(j->frame, j->eye);
    j->vertices = cwi_alloc_array(CHUNK_VERTICES, sizeof *j->vertices);
    j->indices = cwi_alloc_array(CHUNK_INDICES, sizeof *j->indices);
    if (!j->vertices || !j->indices)
        return cwi_fail_memory(err);
    cw_status st = cwi_visible_make(&gl->transfer.table, &j->visible, err);
    if (st == CW_OK && needs_gradients)
        st = cwi_gl_need_gradients(gl, gradients, err);
    if (st == CW_OK && !s->sampling.no_preintegration && !s->projection.linear_opacity)
        st = cwi_gl_need_segments(gl, s->sampling.step_vox, err);
    return st;
}

static void describe_shader(const cw_scene *s, const cw_transfer *t, const char *gradients,
                            char *defines, size_t size)
{
    snprintf(defines, size, "#define RAYS\n%s%s%s%s%s%s", gradients,
             s->clip_count ? "#define CLIPS\n" : "",
             s->sampling.no_preintegration ? "" : "#define SEGMENTS\n",
             s->projection.linear_opacity ? "#define LINEAR\n" : "",
             s->lit ? "#define LIT\n" : "", t->gradient_count ? "#define FACTOR\n" : "");
}

static cw_status draw_bricks(job *j, GLuint program, cw_error *err)
{
    cw_status st = CW_OK;
    size_t *order = cwi_gl_order_bricks(j->gl);
    if (!order)
        return cwi_fail_memory(err);
    for (size_t n = 0; n < j->gl->volume.brick_count && st == CW_OK; n++) {
        const cwi_gl_brick *brick = &j->gl->volume.bricks[order[n]];
        cwi_gl_bind_brick(program, brick);
        st = draw_brick(j, brick, err);
    }
    cwi_free(order);
    return st;
}

static cw_status draw_projection_mode(cwi_gl *gl, void **state, cw_error *err)
{
    char defines[256];
    const char *gradients = "";
    GLuint program;
    (void)state;
    job *j = cwi_alloc_zeroed(1, sizeof *j);
    if (!j)
        return cwi_fail_memory(err);
    cw_status st = open_job(gl, j, &gradients, err);
    describe_shader(&gl->frame->scene, &gl->frame->transfer, gradients, defines,
                    sizeof defines);
    if (st == CW_OK)
        st = cwi_gl_use(gl, cwi_glsl_projection, cwi_glsl_projection, defines, &program, err);
    open_stream(j);
    if (st == CW_OK) {
        cwi_gl_set(program, "step_length", (float)gl->frame->scene.sampling.step_vox);
        st = draw_bricks(j, program, err);
    }
    close_stream(j);
    cwi_free(j);
    return st;
}

const cwi_gl_mode cwi_gl_projection = {CW_MODE_PROJECTION, true, draw_projection_mode, NULL,
                                       false};
