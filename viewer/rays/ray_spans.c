/* Goes along rays through rectilinear and irregular grids: finds the cells that a ray meets,
 * sorts them by entry, and fits cubics to the field in each. */
#include "viewer/rays/ray_spans.h"

#include "core/base/memory.h"
#include "core/geometry/cubic.h"
#include "core/geometry/vec3.h"
#include "core/volume/cell_shapes.h"
#include "core/volume/volume.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A gap between spans that is more than rounding, in units of eye space. */
static const double MIN_GAP = 1e-6;

void cwi_field_make(const cwi_frame *frame, const cwi_cell_tree *tree, const cwi_knots *knots,
                    bool is_exact, cwi_field *field)
{
    double m[3][3];
    *field = (cwi_field){.frame = frame,
                         .tree = tree,
                         .knots = knots,
                         .has_gradients = cwi_frame_needs_gradients(frame),
                         .tolerance = is_exact ? 1e-8 : 1e-4};
    cwi_frame_gradient_matrix(frame, m);
    for (int n = 0; n < 9;
         n++) /* gradients at the samples of irregular grids are in the world */
        field->gradient_to_eye[n] =
            frame->volume.cells ? frame->axes[n / 3][n % 3] * frame->unit_mm : m[n / 3][n % 3];
}

static void to_eye(const cwi_field *f, const double cubics[3][4], double eye[3][4])
{
    const double *m = f->gradient_to_eye;
    for (int r = 0; r < 3; r++)
        for (int n = 0; n < 4; n++)
            eye[r][n] = m[3 * r] * cubics[0][n] + m[3 * r + 1] * cubics[1][n] +
                        m[3 * r + 2] * cubics[2][n];
}

/* Finds the range of values at corners. Returns false if one of them has no value, or nothing
 * in the range is visible. */
static bool find_range(const cwi_field *f, const double *values, int count, double *range)
{
    double low = values[0], high = values[0], gaps = 0;
    for (int c = 0; c < count; c++) {
        gaps += values[c] - values[c];
        low = cwi_lesser(low, values[c]);
        high = cwi_greater(high, values[c]);
    }
    *range = high - low;
    return gaps == 0 && (!f->knots || cwi_knots_is_visible(f->knots, low, high));
}

/* --- rectilinear grids --------------------------------------------------------------------- */

/* Returns where the ray leaves the box along an axis. */
static double next_plane(const cwi_spans *s, int axis)
{
    const cw_volume *v = &s->field->frame->volume;
    const cwi_ray *ray = s->ray;
    if (ray->slope[axis] == 0 || v->dim[axis] == 1)
        return INFINITY;
    const double plane = v->coordinates[axis][s->cell[axis] + (ray->slope[axis] > 0)];
    return (plane - ray->index[axis]) / ray->slope[axis];
}

static void start_boxes(cwi_spans *s)
{
    const cw_volume *v = &s->field->frame->volume;
    const cwi_ray *ray = s->ray;
    s->walk = (cwi_walk){.volume = v,
                         .gradient_volume = &s->field->frame->gradient_volume,
                         .t = ray->parts[s->part][0]};
    s->walk.stop = ray->parts[s->part][1];
    for (int a = 0; a < 3; a++) {
        const double at = ray->index[a] + s->walk.t * ray->slope[a];
        const ptrdiff_t last = (ptrdiff_t)v->dim[a] - 2;
        const double cell = last < 0 ? 0 : floor(cwi_coordinate_index(v, a, at));
        s->cell[a] = (ptrdiff_t)fmin(fmax(cell, 0), fmax((double)last, 0));
        s->next[a] = next_plane(s, a);
    }
}

/* Goes to the next box of which more than a point is met. */
static bool next_box(cwi_spans *s)
{
    cwi_walk *w = &s->walk;
    const cw_volume *v = w->volume;
    while (w->t < w->stop) {
        const int a = s->next[0] < s->next[1] ? (s->next[0] < s->next[2] ? 0 : 2)
                                              : (s->next[1] < s->next[2] ? 1 : 2);
        const ptrdiff_t step = s->ray->slope[a] > 0 ? 1 : -1;
        for (int i = 0; i < 3; i++)
            w->at[i] = s->cell[i];
        w->from = w->t;
        w->to = cwi_lesser(cwi_greater(s->next[a], w->t), w->stop);
        w->t = w->to;
        s->cell[a] += step;
        if (s->cell[a] < 0 || s->cell[a] > (ptrdiff_t)v->dim[a] - 2)
            w->t = w->stop;
        else
            s->next[a] = next_plane(s, a);
        if (w->to > w->from)
            return true;
    }
    return false;
}

/* Describes the ray in the box's own units, as the walk through an even grid has it. */
static void scale_box(cwi_spans *s)
{
    cwi_walk *w = &s->walk;
    for (int a = 0; a < 3; a++) {
        const double *x = w->volume->coordinates[a] + w->at[a];
        const double inverse = w->volume->dim[a] > 1 ? 1 / (x[1] - x[0]) : 0;
        w->index[a] = (s->ray->index[a] - x[0]) * inverse + (double)w->at[a];
        w->slope[a] = s->ray->slope[a] * inverse;
    }
}

static bool next_in_boxes(cwi_spans *s, cwi_span *span)
{
    const cwi_field *f = s->field;
    double v[8], range, g[3][8], cubics[3][4];
    while (s->part < s->ray->part_count) {
        if (!next_box(s)) {
            if (++s->part < s->ray->part_count)
                start_boxes(s);
            continue;
        }
        if (!cwi_walk_values(&s->walk, v) || !find_range(f, v, 8, &range))
            continue;
        scale_box(s);
        span->from = s->walk.from;
        span->to = s->walk.to;
        cwi_walk_cubic(&s->walk, v, span->value);
        if (!f->has_gradients)
            return true;
        cwi_walk_gradients(&s->walk, g);
        for (int a = 0; a < 3; a++)
            cwi_walk_cubic(&s->walk, g[a], cubics[a]);
        to_eye(f, (const double(*)[4])cubics, span->gradient);
        return true;
    }
    return false;
}

/* --- irregular grids: the cells of a ray --------------------------------------------------- */

static void load_values(const cw_volume *v, const cwi_mapped_cell *cell, double *values)
{
    for (int c = 0; c < cell->count; c++) {
        const double x = cwi_voxel_at(v->type, cwi_voxel_address(v, cell->corners[c], 0, 0));
        values[c] = v->has_nodata && x == v->nodata ? NAN : v->slope * x + v->intercept;
    }
}

/* Loads a cell, its points relative to the ray's start. */
static void load_cell(const cwi_spans *s, uint32_t cell, cwi_mapped_cell *mapped)
{
    const cw_cells *cells = s->field->frame->volume.cells;
    cwi_cell_load(cells, cells->shapes[cell], cells->corners + s->field->tree->starts[cell],
                  s->origin, mapped);
}

static bool is_linear(const cwi_field *f, uint32_t cell)
{
    const uint8_t kind = f->tree->kinds[cell];
    return kind == CWI_MAP_LINEAR || (kind == CWI_MAP_NEARLY && f->tolerance >= 1e-4);
}

static void add_hit(cwi_spans *s, uint32_t cell, int part, double from, double to)
{
    if (!(to > from))
        return;
    void *grown = cwi_grow_array(s->hits, s->hit_count, &s->hit_capacity, sizeof *s->hits);
    s->is_starved |= !grown;
    if (!grown)
        return;
    s->hits = grown;
    s->hits[s->hit_count++] = (cwi_cell_hit){from, to, cell, part};
}

/* The ray's start is the origin of cells. */
static const double nowhere[3] = {0};

static void hit_linear(cwi_spans *s, const cwi_mapped_cell *mapped, uint32_t cell, int part,
                       double length)
{
    double start[3], slope[3], t[2] = {0, length};
    if (!cwi_cell_line(mapped, nowhere, s->slope, start, slope))
        return;
    cwi_cell_clip(mapped->shape, start, slope, t);
    add_hit(s, cell, part, t[0], t[1]);
}

static void point_at(const cwi_spans *s, double t, double point[3])
{
    for (int a = 0; a < 3; a++)
        point[a] = t * s->slope[a];
}

/* Sorts the few positions where a ray may cross a cell's faces. */
static void sort_distances(double *t, int count)
{
    for (int n = 1; n < count; n++) {
        const double x = t[n];
        int m = n;
        for (; m > 0 && t[m - 1] > x; m--)
            t[m] = t[m - 1];
        t[m] = x;
    }
}

/* Returns true if a point lies in the box around a cell. */
static bool is_in_box(const cwi_mapped_cell *mapped, const double point[3])
{
    for (int a = 0; a < 3; a++) {
        bool is_above = false, is_below = false;
        for (int c = 0; c < mapped->count; c++) {
            is_below = is_below || mapped->points[c][a] <= point[a];
            is_above = is_above || mapped->points[c][a] >= point[a];
        }
        if (!is_below || !is_above)
            return false;
    }
    return true;
}

/* Adds the parts of the ray in a curved cell: of those between two crossings, the ones whose
 * middle lies inside. */
static void hit_curved(cwi_spans *s, const cwi_mapped_cell *mapped, uint32_t cell,
                       double length)
{
    double t[CWI_CELL_CROSSINGS + 2], point[3];
    int count = cwi_cell_crossings(mapped, nowhere, s->slope, t);
    t[count++] = 0;
    t[count++] = length;
    sort_distances(t, count);
    for (int n = 1; n < count; n++) {
        const double from = fmax(t[n - 1], 0), to = fmin(t[n], length);
        double u[3] = {0.4, 0.4, 0.4};
        if (!(to > from))
            continue;
        point_at(s, (from + to) / 2, point);
        if (is_in_box(mapped, point) && cwi_cell_invert(mapped, point, 1e-4, u) &&
            cwi_cell_contains(mapped->shape, u))
            add_hit(s, cell, -1, from, to);
    }
}

static void hit_folded(cwi_spans *s, const cwi_mapped_cell *mapped, uint32_t cell,
                       double length)
{
    for (int n = 0; n < cwi_cell_part_count(mapped->shape); n++) {
        cwi_mapped_cell part;
        cwi_cell_part(mapped, n, &part);
        if (cwi_cell_map_of(&part) != CWI_MAP_EMPTY)
            hit_linear(s, &part, cell, n, length);
    }
}

typedef struct collection {
    cwi_spans *spans;
    double length;
} collection;

static bool collect_cell(void *context, size_t slot)
{
    const collection *c = context;
    cwi_spans *s = c->spans;
    const cwi_field *f = s->field;
    const uint32_t cell = f->tree->boxes.order[slot];
    cwi_mapped_cell mapped;
    double values[8], range;
    load_cell(s, cell, &mapped);
    load_values(&f->frame->volume, &mapped, values);
    if (!find_range(f, values, mapped.count, &range))
        return true;
    if (is_linear(f, cell))
        hit_linear(s, &mapped, cell, -1, c->length);
    else if (f->tree->kinds[cell] == CWI_MAP_FOLDED)
        hit_folded(s, &mapped, cell, c->length);
    else
        hit_curved(s, &mapped, cell, c->length);
    return !s->is_starved;
}

static int compare_hits(const void *a, const void *b)
{
    const cwi_cell_hit *x = a, *y = b;
    if (x->from != y->from)
        return x->from < y->from ? -1 : 1;
    if (x->to != y->to)
        return x->to < y->to ? -1 : 1;
    return x->cell != y->cell ? (x->cell < y->cell ? -1 : 1) : x->part - y->part;
}

static void collect_cells(cwi_spans *s)
{
    static const double shift[3] = {0.531e-11, 0.733e-11, 0.426e-11};
    const cwi_cell_tree *tree = s->field->tree;
    const cwi_ray *ray = s->ray;
    const double end = ray->parts[ray->part_count - 1][1];
    collection c = {s, end - ray->parts[0][0]};
    s->start = ray->parts[0][0];
    s->hit_count = s->hit = 0;
    s->piece_count = 0;
    for (int a = 0; a < 3; a++) {
        s->slope[a] = ray->slope[a];
        s->origin[a] = ray->index[a] + s->start * ray->slope[a] + shift[a] * tree->scale;
    }
    const cwi_boxes_segment segment = cwi_cell_tree_segment(tree, ray);
    cwi_boxes_pierce(&tree->boxes, &segment, collect_cell, &c);
    if (s->hit_count > 1)
        qsort(s->hits, s->hit_count, sizeof *s->hits, compare_hits);
}

/* --- irregular grids: the field in a cell ------------------------------------------------- */

/* Places in a span where its cubic is fitted, and where it is checked. */
enum { FITTED = 4, FIT_POINT_COUNT = 6 };
static const double FIT_POINTS[FIT_POINT_COUNT] = {0, 0.25, 0.75, 1, 0.5, 0.9};

/* Fits a cubic through values at the first four positions. */
static void fit_cubic(const double v[FITTED], double c[4])
{
    c[0] = v[0];
    c[1] = (-19 * v[0] + 24 * v[1] - 8 * v[2] + 3 * v[3]) / 3;
    c[2] = (32 * v[0] - 56 * v[1] + 40 * v[2] - 16 * v[3]) / 3;
    c[3] = (-16 * v[0] + 32 * v[1] - 32 * v[2] + 16 * v[3]) / 3;
}

/* Finds u at a position on the ray; guess: the last one found. */
static void place_in_cell(const cwi_spans *s, double t, double u[3])
{
    double point[3], found[3] = {u[0], u[1], u[2]};
    if (s->is_linear) {
        cwi_add_scaled(s->line[0], t, s->line[1], u);
        return;
    }
    point_at(s, t, point);
    if (cwi_cell_invert(&s->mapped, point, s->field->tolerance < 1e-4 ? 1e-7 : 1e-4, found))
        memcpy(u, found, sizeof found);
}

/* Computes value and world gradient at a position of the ray. */
static double sample_cell(const cwi_spans *s, const double u[3], double gradient[3])
{
    double w[8], value = 0;
    cwi_cell_weights(s->mapped.shape, u, w);
    memset(gradient, 0, 3 * sizeof *gradient);
    for (int c = 0; c < s->mapped.count; c++)
        value += w[c] * s->values[c];
    for (int c = 0; c < s->mapped.count && s->field->has_gradients; c++) {
        const float *g = s->field->tree->gradients[s->mapped.corners[c]];
        for (int a = 0; a < 3; a++)
            gradient[a] += w[c] * (double)g[a];
    }
    return value;
}

/* Fits the span's cubics. Returns false if they are not within the tolerance where they are
 * checked. */
static bool fit_span(cwi_spans *s, double from, double to, cwi_span *span)
{
    const bool is_exact = s->is_linear && s->mapped.shape != CW_PYRAMID;
    double u[3] = {0.4, 0.4, 0.4}, values[FIT_POINT_COUNT], gradients[FIT_POINT_COUNT][3],
           cubics[3][4];
    double worst = 0, steepest = 0, first[2][3];
    for (int n = 0; n < (is_exact ? FITTED : FIT_POINT_COUNT); n++) {
        for (int a = 0; a < 3 && n > 1; a++) /* a straight line is a good guess */
            u[a] = first[0][a] + FIT_POINTS[n] / FIT_POINTS[1] * (first[1][a] - first[0][a]);
        place_in_cell(s, from + FIT_POINTS[n] * (to - from), u);
        values[n] = sample_cell(s, u, gradients[n]);
        if (n < 2)
            memcpy(first[n], u, sizeof u);
    }
    fit_cubic(values, span->value);
    for (int n = FITTED; n < FIT_POINT_COUNT && !is_exact; n++)
        worst = fmax(worst, fabs(cwi_cubic_at(span->value, FIT_POINTS[n]) - values[n]));
    if (!s->field->has_gradients)
        return worst <= s->tolerance;
    for (int a = 0; a < 3; a++) {
        double v[FITTED];
        for (int n = 0; n < FITTED; n++)
            v[n] = gradients[n][a];
        fit_cubic(v, cubics[a]);
    }
    to_eye(s->field, (const double(*)[4])cubics, span->gradient);
    if (is_exact)
        return true;
    double off = 0;
    for (int n = 0; n < FIT_POINT_COUNT; n++)
        for (int a = 0; a < 3; a++) {
            steepest = fmax(steepest, fabs(gradients[n][a]));
            if (n >= FITTED)
                off = fmax(off, fabs(cwi_cubic_at(cubics[a], FIT_POINTS[n]) - gradients[n][a]));
        }
    return worst <= s->tolerance && off <= 10 * s->field->tolerance * steepest;
}

/* Makes a hit the cell at hand, if the current part of the ray has some of it. */
static void take_hit(cwi_spans *s, const cwi_cell_hit *h)
{
    const double *part = s->ray->parts[s->part];
    const double from = fmax(h->from, part[0] - s->start), to = fmin(h->to, part[1] - s->start);
    double range, largest = 0;
    if (!(to > from))
        return;
    load_cell(s, h->cell, &s->mapped);
    if (h->part >= 0) {
        const cwi_mapped_cell whole = s->mapped;
        cwi_cell_part(&whole, h->part, &s->mapped);
    }
    load_values(&s->field->frame->volume, &s->mapped, s->values);
    find_range(s->field, s->values, s->mapped.count, &range);
    for (int c = 0; c < s->mapped.count; c++)
        largest = fmax(largest, fabs(s->values[c]));
    s->tolerance = fmax(s->field->tolerance * range, 1e-14 * largest);
    s->is_linear = (h->part >= 0 || is_linear(s->field, h->cell)) &&
                   cwi_cell_line(&s->mapped, nowhere, s->slope, s->line[0], s->line[1]);
    s->pieces[0][0] = from;
    s->pieces[0][1] = to;
    s->piece_count = 1;
}

/* Replaces the last piece by its halves, the nearer one last. */
static void halve_piece(cwi_spans *s)
{
    double *whole = s->pieces[s->piece_count - 1], *half = s->pieces[s->piece_count];
    const double middle = (whole[0] + whole[1]) / 2;
    half[0] = whole[0];
    half[1] = whole[0] = middle;
    s->piece_count++;
}

static bool next_in_cells(cwi_spans *s, cwi_span *span)
{
    enum { MAX_PIECES = 12 };
    while (s->part < s->ray->part_count) {
        if (s->piece_count == 0 && s->hit == s->hit_count) {
            s->part++;
            s->hit = 0;
            continue;
        }
        if (s->piece_count == 0) {
            take_hit(s, &s->hits[s->hit++]);
            continue;
        }
        const double *piece = s->pieces[s->piece_count - 1];
        if (!fit_span(s, piece[0], piece[1], span) && s->piece_count < MAX_PIECES) {
            halve_piece(s);
            continue;
        }
        span->from = s->start + piece[0];
        span->to = s->start + piece[1];
        s->piece_count--;
        return true;
    }
    return false;
}

/* ----------------------------------------------------------------------------------------- */

bool cwi_spans_start(cwi_spans *s, const cwi_field *field, const cwi_ray *ray)
{
    s->field = field;
    s->ray = ray;
    s->part = 0;
    s->last = -INFINITY;
    s->is_starved = false;
    if (ray->part_count > 0 && field->frame->volume.cells)
        collect_cells(s);
    else if (ray->part_count > 0)
        start_boxes(s);
    return !s->is_starved;
}

bool cwi_spans_next(cwi_spans *s, cwi_span *span)
{
    const bool is_there =
        s->field->frame->volume.cells ? next_in_cells(s, span) : next_in_boxes(s, span);
    if (!is_there)
        return false;
    span->follows = span->from - s->last <= MIN_GAP;
    s->last = span->to;
    return true;
}

void cwi_spans_free(cwi_spans *s)
{
    cwi_free(s->hits);
    *s = (cwi_spans){0};
}
