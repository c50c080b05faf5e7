/* Makes convex solids of cells: cuts irregular ones into tetrahedra [Shirley1990] that fit
 * together, and takes boxes of rectilinear grids as they are. */
#include "viewer/projection/projected_solids.h"

#include "core/geometry/affine.h"
#include "core/geometry/vec3.h"
#include "core/volume/volume.h"
#include "viewer/scene/cell_lattice.h"

#include <math.h>
#include <string.h>

void cwi_solids_init(cwi_solids *s, const cwi_frame *f, const cwi_cell_tree *tree)
{
    const cw_volume *v = &f->volume;
    *s = (cwi_solids){.frame = f,
                      .tree = v->cells ? tree : NULL,
                      .count = v->cells ? v->cells->count : 1,
                      .has_gradients = cwi_frame_needs_gradients(f)};
    cwi_frame_gradient_matrix(f, s->gradient_to_eye);
    for (int a = 0; a < 3; a++) {
        s->count *= !v->cells && v->dim[a] > 1 ? v->dim[a] - 1 : 1;
        for (int b = 0; b < 3 && v->cells; b++) /* gradients of samples are in the world */
            s->gradient_to_eye[a][b] = f->axes[a][b] * f->unit_mm;
    }
}

/* A cell's corners: samples, values and points in eye space. */
typedef struct corners {
    uint8_t shape;
    int count;
    size_t samples[8][3]; /* of an irregular grid: {number, 0, 0} */
    double values[8], points[8][3];
} corners;

static void load_irregular(const cwi_solids *s, size_t cell, corners *c)
{
    const cw_cells *cells = s->frame->volume.cells;
    const uint32_t *list = cells->corners + s->tree->starts[cell];
    c->shape = cells->shapes[cell];
    c->count = cwi_cell_shapes[c->shape].corner_count;
    for (int n = 0; n < c->count; n++) {
        c->samples[n][0] = list[n];
        c->samples[n][1] = c->samples[n][2] = 0;
        cwi_affine_apply(s->frame->eye_from_index, cells->points + 3 * (size_t)list[n],
                         c->points[n]);
    }
}

/* Loads the box of a number; corner n is high along axis a where n >> a & 1. */
static void load_box(const cwi_solids *s, size_t cell, corners *c, double ends[2][3])
{
    const cw_volume *v = &s->frame->volume;
    size_t at[3];
    for (int a = 0; a < 3; a++) {
        const size_t cells = v->dim[a] > 1 ? v->dim[a] - 1 : 1;
        at[a] = cell % cells;
        cell /= cells;
        const double *x = v->coordinates[a] + at[a];
        ends[0][a] = v->dim[a] > 1 ? x[0] : x[0] - 0.5;
        ends[1][a] = v->dim[a] > 1 ? x[1] : x[0] + 0.5;
    }
    c->count = 8;
    for (int n = 0; n < 8; n++) {
        double p[3];
        for (int a = 0; a < 3; a++) {
            c->samples[n][a] = at[a] + (v->dim[a] > 1 && (n >> a & 1));
            p[a] = ends[n >> a & 1][a];
        }
        cwi_affine_apply(s->frame->eye_from_index, p, c->points[n]);
    }
}

/* Loads the values of the corners; returns false if one of them has none. */
static bool load_values(const cwi_solids *s, corners *c)
{
    const cw_volume *v = &s->frame->volume;
    bool is_whole = true;
    for (int n = 0; n < c->count; n++) {
        const size_t *at = c->samples[n];
        const double x = cwi_voxel_at(v->type, cwi_voxel_address(v, at[0], at[1], at[2]));
        is_whole = is_whole && isfinite(x) && !(v->has_nodata && x == v->nodata);
        c->values[n] = v->slope * x + v->intercept;
    }
    return is_whole;
}

/* Returns false for an empty cell. ends: of a box */
static bool load_corners(const cwi_solids *s, size_t cell, corners *c, double ends[2][3])
{
    if (s->tree && s->tree->kinds[cell] == CWI_MAP_EMPTY)
        return false;
    if (s->tree)
        load_irregular(s, cell, c);
    else
        load_box(s, cell, c, ends);
    return load_values(s, c);
}

/* Finds the samples of the picture that points may cover: all of them, where a point is not in
 * front of the eye. */
static void find_cover(const cwi_frame *f, const double (*points)[3], int count, double low[2],
                       double high[2])
{
    const double size[2] = {(double)f->scene.width, (double)f->scene.height};
    low[0] = low[1] = INFINITY;
    high[0] = high[1] = -INFINITY;
    for (int n = 0; n < count; n++) {
        const double *p = points[n];
        const double scale = f->perspective ? -1 / p[2] : 1;
        const bool is_behind = f->perspective && -p[2] < f->near;
        const double at[2] = {(p[0] * scale / f->half[0] + 1) / 2 * size[0],
                              (1 - p[1] * scale / f->half[1]) / 2 * size[1]};
        for (int a = 0; a < 2; a++) {
            low[a] = fmin(low[a], is_behind ? 0 : at[a]);
            high[a] = fmax(high[a], is_behind ? size[a] : at[a]);
        }
    }
}

bool cwi_solids_measure(const cwi_solids *s, size_t cell, double range[2], double low[2],
                        double high[2], double *depth)
{
    corners c;
    double ends[2][3];
    if (!load_corners(s, cell, &c, ends))
        return false;
    find_cover(s->frame, (const double(*)[3])c.points, c.count, low, high);
    range[0] = range[1] = c.values[0];
    *depth = 0;
    for (int n = 0; n < c.count; n++) {
        range[0] = fmin(range[0], c.values[n]);
        range[1] = fmax(range[1], c.values[n]);
        *depth -= c.points[n][2] / c.count;
    }
    return isfinite(*depth);
}

static void load_gradient(const cwi_solids *s, const size_t at[3], double eye[3])
{
    const cw_volume *v = &s->frame->gradient_volume;
    double g[3];
    for (int a = 0; a < 3 && s->tree; a++)
        g[a] = (double)s->tree->gradients[at[0]][a];
    if (!s->tree)
        cwi_lattice_gradient(v, at, g);
    for (int a = 0; a < 3 && !s->tree; a++) {
        g[a] *= v->slope;
        g[a] = isfinite(g[a]) ? g[a] : 0;
    }
    for (int a = 0; a < 3; a++)
        eye[a] = cwi_dot(s->gradient_to_eye[a], g);
}

static void take_corner(const cwi_solids *s, const corners *c, int from, cwi_solid *to, int n)
{
    to->values[n] = c->values[from];
    if (s->has_gradients)
        load_gradient(s, c->samples[from], to->gradients[n]);
}

static bool make_tetrahedron(const cwi_solids *s, const corners *c, const int from[4],
                             cwi_solid *t)
{
    double points[4][3], edges[3][3], across[3][3], size = 0;
    *t = (cwi_solid){.plane_count = 4, .corner_count = 4};
    for (int n = 0; n < 4; n++) {
        memcpy(points[n], c->points[from[n]], sizeof points[n]);
        take_corner(s, c, from[n], t, n);
    }
    for (int n = 0; n < 3; n++)
        for (int a = 0; a < 3; a++) {
            edges[n][a] = points[n + 1][a] - points[0][a];
            size = fmax(size, fabs(edges[n][a]));
        }
    for (int n = 0; n < 3; n++)
        cwi_cross(edges[(n + 1) % 3], edges[(n + 2) % 3], across[n]);
    const double volume = cwi_dot(edges[0], across[0]);
    if (!(fabs(volume) > 1e-13 * size * size * size))
        return false;
    t->planes[0][3] = 1;
    for (int n = 0; n < 3; n++) {
        double *plane = t->planes[n + 1];
        for (int a = 0; a < 3; a++)
            plane[a] = across[n][a] / volume;
        plane[3] = -cwi_dot(plane, points[0]);
        for (int a = 0; a < 4; a++)
            t->planes[0][a] -= plane[a];
    }
    find_cover(s->frame, (const double(*)[3])points, 4, t->low, t->high);
    return true;
}

/* Cuts a cell into the tetrahedra between its corner of the least number and the triangles of
 * the faces that do not have it. */
static int cut_cell(const cwi_solids *s, const corners *c, cwi_solid out[CWI_SOLIDS_OF_CELL])
{
    const cwi_cell_shape *shape = &cwi_cell_shapes[c->shape];
    int tip = 0, count = 0;
    for (int n = 1; n < c->count; n++)
        tip = c->samples[n][0] < c->samples[tip][0] ? n : tip;
    for (int f = 0; f < shape->face_count; f++) {
        const int size = shape->face_size[f];
        const uint8_t *face = shape->faces[f];
        int lowest = 0;
        bool has_tip = false;
        for (int n = 0; n < size; n++) {
            has_tip = has_tip || face[n] == tip;
            lowest = c->samples[face[n]][0] < c->samples[face[lowest]][0] ? n : lowest;
        }
        for (int n = 2; n < size && !has_tip; n++) {
            const int from[4] = {tip, face[lowest], face[(lowest + n - 1) % size],
                                 face[(lowest + n) % size]};
            count += make_tetrahedron(s, c, from, &out[count]);
        }
    }
    return count;
}

static int make_box(const cwi_solids *s, const corners *c, const double ends[2][3],
                    cwi_solid *box)
{
    const double *m = s->frame->index_from_eye;
    *box = (cwi_solid){.is_box = true, .plane_count = 6, .corner_count = 8};
    for (int n = 0; n < 8; n++)
        take_corner(s, c, n, box, n);
    for (int a = 0; a < 3; a++) {
        const double width = ends[1][a] - ends[0][a];
        for (int k = 0; k < 4; k++) {
            box->planes[a][k] = (m[4 * a + k] - (k == 3 ? ends[0][a] : 0)) / width;
            box->planes[a + 3][k] = (k == 3) - box->planes[a][k];
        }
    }
    find_cover(s->frame, c->points, 8, box->low, box->high);
    return 1;
}

int cwi_solids_of(const cwi_solids *s, size_t cell, cwi_solid out[CWI_SOLIDS_OF_CELL])
{
    corners c;
    double ends[2][3];
    if (!load_corners(s, cell, &c, ends))
        return 0;
    return s->tree ? cut_cell(s, &c, out) : make_box(s, &c, (const double(*)[3])ends, out);
}

double cwi_solid_sample(const cwi_solid *s, const double p[3], double gradient[3])
{
    double w[8], at[4], value = 0;
    for (int n = 0; n < (s->is_box ? 3 : 4); n++)
        at[n] = fmin(fmax(cwi_dot(s->planes[n], p) + s->planes[n][3], 0), 1);
    for (int n = 0; n < s->corner_count; n++)
        w[n] = s->is_box ? (n & 1 ? at[0] : 1 - at[0]) * (n & 2 ? at[1] : 1 - at[1]) *
                               (n & 4 ? at[2] : 1 - at[2])
                         : at[n];
    for (int n = 0; n < s->corner_count; n++)
        value += w[n] * s->values[n];
    for (int a = 0; a < 3 && gradient; a++) {
        gradient[a] = 0;
        for (int n = 0; n < s->corner_count; n++)
            gradient[a] += w[n] * s->gradients[n][a];
    }
    return value;
}
