/* Interpolates opacities over the triangles of projected cells. */
#include "viewer/projection/linear_cell.h"

#include "core/geometry/affine.h"
#include "core/geometry/vec3.h"

#include <math.h>

/* Computes the position in a box, 0 to 1, of a point of the picture at a depth. */
static cwi_lanes fractions_in_box(const cwi_frame *f, const double at[2], double depth,
                                  const double low[3], const cwi_projected_cell *c)
{
    const double scale = f->perspective ? depth : 1;
    const double p[3] = {at[0] * scale, at[1] * scale, -depth};
    double index[3];
    cwi_lanes fractions = {0};
    cwi_affine_apply(f->index_from_eye, p, index);
    for (int a = 0; a < 3; a++) {
        const double fraction = (index[a] - low[a]) / (double)c->size[a];
        fractions[a] = (float)cwi_lesser(cwi_greater(fraction, 0), 1);
    }
    return fractions;
}

/* Makes the pieces of a box of the cell's size. */
static void make_pieces(cwi_linear_cell *l, const double low[3], const cwi_projected_cell *c)
{
    const double high[3] = {low[0] + (double)c->size[0], low[1] + (double)c->size[1],
                            low[2] + (double)c->size[2]};
    cwi_pieces_make(l->frame, low, high, &l->pieces);
    for (size_t n = 0; n < l->pieces.vertex_count; n++) {
        const cwi_piece_vertex *v = &l->pieces.vertices[n];
        l->front[n] = fractions_in_box(l->frame, v->at, v->front, low, c);
        l->back[n] = fractions_in_box(l->frame, v->at, v->back, low, c);
    }
}

/* Returns the opacity, and the colour times it, of the way through the cell at a vertex, by the
 * mean of both ends. */
static cwi_lanes color_of_vertex(const cwi_linear_cell *l, const cwi_projected_cell *c,
                                 size_t n)
{
    const cwi_piece_vertex *v = &l->pieces.vertices[n];
    const double slant =
        l->frame->perspective ? sqrt(v->at[0] * v->at[0] + v->at[1] * v->at[1] + 1) : 1;
    const cwi_lanes front = cwi_cell_classify(l->tables, cwi_cell_value(c, l->front[n]));
    const cwi_lanes back = cwi_cell_classify(l->tables, cwi_cell_value(c, l->back[n]));
    cwi_lanes row = 0.5f * (front + back);
    const float depth = row[3] * (float)((v->back - v->front) * slant);
    row[3] = 1;
    return row * (1 - cwi_lanes_fade(cwi_lanes_spread(depth))[0]);
}

static void add_triangle(cwi_linear_cell *l, const float at[3][2], const cwi_lanes color[3])
{
    const float b[2] = {at[1][0] - at[0][0], at[1][1] - at[0][1]};
    const float c[2] = {at[2][0] - at[0][0], at[2][1] - at[0][1]};
    const float area = b[0] * c[1] - b[1] * c[0];
    cwi_linear_triangle *t = &l->triangles[l->count];
    if (!(fabsf(area) > 0x1p-40f))
        return;
    *t = (cwi_linear_triangle){{at[0][0], at[0][1]},        {c[1] / area, -c[0] / area},
                               {-b[1] / area, b[0] / area}, color[0],
                               color[1] - color[0],         color[2] - color[0]};
    l->count++;
}

void cwi_linear_make(cwi_linear_cell *l, const cwi_projected_cell *c)
{
    const cwi_frame *f = l->frame;
    double low[3] = {(double)c->low[0], (double)c->low[1], (double)c->low[2]}, shift[2] = {0};
    float corners[CWI_PIECE_VERTICES][2];
    cwi_lanes colors[CWI_PIECE_VERTICES];
    if (!f->perspective) {
        for (int r = 0; r < 2; r++)
            shift[r] = cwi_dot(f->eye_from_index + (ptrdiff_t)4 * r, low);
        memset(low, 0, sizeof low);
    }
    if (f->perspective || !l->is_made || memcmp(&l->size, &c->size, sizeof l->size) != 0)
        make_pieces(l, low, c);
    l->is_made = true;
    l->size = c->size;
    for (size_t n = 0; n < l->pieces.vertex_count; n++) {
        const double *at = l->pieces.vertices[n].at;
        const double x = ((at[0] + shift[0]) / f->half[0] + 1) / 2 * (double)f->scene.width;
        const double y = (1 - (at[1] + shift[1]) / f->half[1]) / 2 * (double)f->scene.height;
        corners[n][0] = (float)(x - (double)l->tile[0]);
        corners[n][1] = (float)(y - (double)l->tile[1]);
        colors[n] = color_of_vertex(l, c, n);
    }
    l->count = 0;
    for (size_t n = 0; n + 3 <= l->pieces.index_count; n += 3) {
        const uint8_t *i = l->pieces.indices + n;
        float at[3][2];
        for (int corner = 0; corner < 3; corner++)
            memcpy(at[corner], corners[i[corner]], sizeof at[corner]);
        add_triangle(l, (const float(*)[2])at,
                     (cwi_lanes[]){colors[i[0]], colors[i[1]], colors[i[2]]});
    }
}

/* A position in no triangle, by rounding, takes the nearest one's colour. */
cwi_lanes cwi_linear_at(const cwi_linear_cell *l, float x, float y)
{
    cwi_lanes color = {0};
    float best = -INFINITY;
    for (size_t n = 0; n < l->count && best < 0; n++) {
        const cwi_linear_triangle *t = &l->triangles[n];
        const float dx = x - t->at[0], dy = y - t->at[1];
        float b = dx * t->second[0] + dy * t->second[1];
        float c = dx * t->third[0] + dy * t->third[1];
        const float a = 1 - b - c;
        const float min = a < b ? (a < c ? a : c) : (b < c ? b : c);
        if (!(min > best))
            continue;
        best = min;
        b = b > 0 ? b : 0;
        c = c > 0 ? c : 0;
        const float sum = (a > 0 ? a : 0) + b + c;
        color = t->color + (b * t->to_second + c * t->to_third) / sum;
    }
    return color;
}
