/* Lays pieces flat, and puts them beside each other on plates: rows from front to back. */
#include "core/base/memory.h"
#include "core/base/status.h"
#include "core/geometry/affine.h"
#include "core/geometry/box.h"
#include "core/geometry/vec3.h"
#include "simplify/pieces/flat_sides.h"

#include <cubewright/boolean.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double DEFAULT_GAP_MM = 5;

/* Sides may be longer than the plate by this fraction, for rounding. */
static const double SLACK = 1e-5;

/* A piece on its way to a plate. */
typedef struct laid_piece {
    size_t number;
    double turn[9]; /* row by row */
    double low[3];  /* of the turned piece */
    double size[3];
    double foot_mm2;
    size_t plate; /* from 1 */
    double at[2]; /* on it */
} laid_piece;

/* A row of pieces on a plate. */
typedef struct plate_row {
    size_t plate;
    double y, depth, used; /* used: width */
} plate_row;

/* --- turning ------------------------------------------------------------------------------ */

/* Makes the shortest turn that takes a direction of length 1 to -z. */
static void make_turn(const double d[3], double turn[9])
{
    const double c = -d[2], x = -d[1], y = d[0]; /* cosine; axis times sine: d x (0, 0, -1) */
    if (c < -1 + 1e-12) {
        const double half_turn[9] = {1, 0, 0, 0, -1, 0, 0, 0, -1};
        memcpy(turn, half_turn, sizeof half_turn);
        return;
    }
    const double k = 1 / (1 + c);
    const double out[9] = {1 - k * y * y, k * x * y, y, k * x * y, 1 - k * x * x, -x, -y, x, c};
    memcpy(turn, out, sizeof out);
}

/* Turns once more by a quarter about z. */
static void make_quarter(double turn[9])
{
    double out[9];
    for (int k = 0; k < 3; k++) {
        out[k] = -turn[3 + k];
        out[3 + k] = turn[k];
        out[6 + k] = turn[6 + k];
    }
    memcpy(turn, out, sizeof out);
}

static void measure_turned(const cw_mesh *m, laid_piece *p)
{
    double high[3];
    cwi_box_clear(p->low, high);
    for (size_t v = 0; v < m->vertex_count; v++) {
        double x[3], y[3];
        for (int k = 0; k < 3; k++)
            x[k] = m->origin[k] + (double)m->positions[3 * v + (size_t)k];
        for (int r = 0; r < 3; r++)
            y[r] = cwi_dot(p->turn + 3 * r, x);
        cwi_box_add(p->low, high, y);
    }
    cwi_sub(high, p->low, p->size);
}

static bool fits(const laid_piece *p, const double plate[3])
{
    for (int k = 0; k < 3; k++)
        if (p->size[k] > plate[k] * (1 + SLACK))
            return false;
    return true;
}

/* Turns a piece to lie on the first of its flat sides with which it fits; else as it is. */
static cw_status turn_piece(const cw_piece *piece, const double plate[3], laid_piece *p,
                            cw_error *err)
{
    cwi_flat_side sides[CWI_MAX_SIDES];
    size_t count = 0;
    cw_status st = cwi_find_flat_sides(&piece->mesh, sides, &count, err);
    for (size_t n = 0; n <= count && st == CW_OK; n++) {
        const double as_it_is[3] = {0, 0, -1};
        make_turn(n < count ? sides[n].normal : as_it_is, p->turn);
        p->foot_mm2 = n < count ? sides[n].area_mm2 : 0;
        for (int quarter = 0; quarter < 2; quarter++) {
            measure_turned(&piece->mesh, p);
            if (fits(p, plate))
                return CW_OK;
            make_quarter(p->turn);
        }
    }
    if (st != CW_OK)
        return st;
    return cwi_fail(
        err, CW_ERR_CHECK,
        "%s is %.6g x %.6g x %.6g mm, and fits on the plate of %.6g x %.6g x %.6g mm on none of its "
        "flat sides: cut it smaller",
        piece->name, p->size[1], p->size[0], p->size[2], plate[0], plate[1], plate[2]);
}

/* --- plates ------------------------------------------------------------------------------- */

static int compare_depths(const void *x, const void *y)
{
    const laid_piece *a = x, *b = y;
    if (a->size[1] != b->size[1])
        return a->size[1] > b->size[1] ? -1 : 1;
    return a->number < b->number ? -1 : a->number > b->number;
}

static bool ends_before(double end, double limit)
{
    return end <= limit * (1 + SLACK);
}

/* Gives each piece a place in the first row with room, or in a new row, on a new plate if need be. They come by
 * falling depth, so that each row is as deep as its first.
 * rows  as many as pieces. Returns the number of plates */
static size_t fill_plates(laid_piece *list, size_t count, const double plate[2], double gap,
                          plate_row *rows)
{
    size_t row_count = 0, plates = 0;
    for (size_t n = 0; n < count; n++) {
        laid_piece *p = &list[n];
        size_t r = 0;
        while (r < row_count && !ends_before(rows[r].used + gap + p->size[0], plate[0]))
            r++;
        if (r == row_count) {
            plate_row row = {.plate = plates, .depth = p->size[1], .used = -gap};
            const plate_row *last = row_count ? &rows[row_count - 1] : NULL;
            if (last && ends_before(last->y + last->depth + gap + p->size[1], plate[1]))
                row.y = last->y + last->depth + gap;
            else
                row.plate = ++plates;
            rows[row_count++] = row;
        }
        p->plate = rows[r].plate;
        p->at[0] = rows[r].used + gap;
        p->at[1] = rows[r].y;
        rows[r].used += gap + p->size[0];
    }
    return plates;
}

/* Chooses a width for a plate of any size: about a square. */
static void choose_plate(const laid_piece *list, size_t count, double gap, double plate[2])
{
    double area = 0, widest = 0;
    for (size_t n = 0; n < count; n++) {
        area += (list[n].size[0] + gap) * (list[n].size[1] + gap);
        widest = fmax(widest, list[n].size[0]);
    }
    plate[0] = fmax(widest, 1.2 * sqrt(area));
    plate[1] = INFINITY;
}

/* Rounds places in the world to floats, as files hold them, and makes the piece sound again: triangles of sections
 * may be as thin as what is rounded. */
static cw_status round_piece(cw_mesh *mesh, int threads, cw_error *err)
{
    cw_mesh out = {0};
    const cw_mesh *list = mesh;
    const cw_boolean_desc desc = {.threads = threads};
    for (size_t n = 0; n < 3 * mesh->vertex_count; n++)
        mesh->positions[n] = (float)((double)mesh->positions[n] + mesh->origin[n % 3]);
    memset(mesh->origin, 0, sizeof mesh->origin);
    const cw_status st = cw_mesh_boolean(&list, 1, &desc, &out, NULL, err);
    if (st != CW_OK)
        return st;
    cw_mesh_attribute_remove(&out, "input");
    cw_mesh_free(mesh);
    *mesh = out;
    return CW_OK;
}

/* Moves a piece to its place, and keeps the map. */
static cw_status move_piece(cw_piece *piece, const laid_piece *p, double plate_step,
                            int threads, cw_error *err)
{
    double map[12], placed[12];
    const double to[3] = {p->at[0] + plate_step * (double)(p->plate - 1), p->at[1], 0};
    for (int r = 0; r < 3; r++) {
        memcpy(map + 4 * r, p->turn + 3 * r, 3 * sizeof *map);
        map[4 * r + 3] = to[r] - p->low[r];
    }
    for (int r = 0; r < 3; r++)
        for (int k = 0; k < 4; k++)
            placed[4 * r + k] =
                map[4 * r] * piece->placed[k] + map[4 * r + 1] * piece->placed[4 + k] +
                map[4 * r + 2] * piece->placed[8 + k] + (k == 3 ? map[4 * r + 3] : 0);
    cw_status st = cw_mesh_transform(&piece->mesh, map, err);
    if (st == CW_OK)
        st = round_piece(&piece->mesh, threads, err);
    if (st != CW_OK)
        return st;
    memcpy(piece->placed, placed, sizeof placed);
    piece->plate = p->plate;
    piece->foot_mm2 = p->foot_mm2;
    return CW_OK;
}

/* --- all pieces --------------------------------------------------------------------------- */

static cw_status check_lay(const cw_lay_desc *d, cw_error *err)
{
    int given = 0;
    for (int k = 0; k < 3; k++) {
        if (!(d->plate_mm[k] >= 0) || !isfinite(d->plate_mm[k]))
            return cwi_fail(err, CW_ERR_ARGUMENT, "plate_mm[%d] is %g; it must be above 0", k,
                            d->plate_mm[k]);
        given += d->plate_mm[k] > 0;
    }
    if (given % 3)
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "plate_mm is %g, %g, %g; either all sides must be above 0, or none",
                        d->plate_mm[0], d->plate_mm[1], d->plate_mm[2]);
    if (!(d->gap_mm >= 0) || !isfinite(d->gap_mm))
        return cwi_fail(err, CW_ERR_ARGUMENT, "gap_mm is %g; it must be 0 or more", d->gap_mm);
    return CW_OK;
}

static double find_gap(const cw_lay_desc *d, const laid_piece *list, size_t count)
{
    double longest = 0;
    if (d->gap_mm > 0)
        return d->gap_mm;
    if (d->plate_mm[0] > 0)
        return fmin(DEFAULT_GAP_MM, fmin(d->plate_mm[0], d->plate_mm[1]) / 10);
    for (size_t n = 0; n < count; n++)
        longest = fmax(longest, fmax(list[n].size[0], list[n].size[1]));
    return longest / 20;
}

static cw_status lay_list(cw_pieces *pieces, const cw_lay_desc *d, laid_piece *list,
                          plate_row *rows, size_t *plates, cw_error *err)
{
    const bool has_plate = d->plate_mm[0] > 0;
    double plate[3] = {INFINITY, INFINITY, INFINITY};
    cw_status st = CW_OK;
    if (has_plate)
        memcpy(plate, d->plate_mm, sizeof plate);
    for (size_t n = 0; n < pieces->count && st == CW_OK; n++) {
        list[n].number = n;
        st = turn_piece(&pieces->pieces[n], plate, &list[n], err);
    }
    if (st != CW_OK)
        return st;
    const double gap = find_gap(d, list, pieces->count);
    if (!has_plate)
        choose_plate(list, pieces->count, gap, plate);
    qsort(list, pieces->count, sizeof *list, compare_depths);
    *plates = fill_plates(list, pieces->count, plate, gap, rows);
    for (size_t n = 0; n < pieces->count && st == CW_OK; n++)
        st = move_piece(&pieces->pieces[list[n].number], &list[n], plate[0] + gap,
                        pieces->settings.threads, err);
    return st;
}

cw_status cw_pieces_lay(cw_pieces *pieces, const cw_lay_desc *desc, size_t *plates,
                        cw_error *err)
{
    CWI_REQUIRE(err, pieces);
    CWI_REQUIRE_VERSION(err, desc, 0);
    const cw_lay_desc d = desc ? *desc : (cw_lay_desc){0};
    size_t found = 0;
    if (plates)
        *plates = 0;
    cw_status st = check_lay(&d, err);
    if (st != CW_OK || !pieces->count)
        return st;
    laid_piece *list = cwi_alloc_zeroed(pieces->count, sizeof *list);
    plate_row *rows = cwi_alloc_array(pieces->count, sizeof *rows);
    st = list && rows ? lay_list(pieces, &d, list, rows, &found, err) : cwi_fail_memory(err);
    cwi_free(list);
    cwi_free(rows);
    if (st == CW_OK && plates)
        *plates = found;
    return st;
}
