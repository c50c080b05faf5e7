/* Finds the place of a text: looks at all places for one size after the other, and takes the best one that fits. */
#include "simplify/engrave/find_place.h"

#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/status.h"
#include "core/geometry/closest_point.h"
#include "core/geometry/vec3.h"
#include "core/mesh/mesh_triangle.h"

#include <stdio.h>
#include <string.h>

/* Defaults: the size by the diagonal, depth and stroke by the size, and the wall in mm, or by the depth. */
static const double SIZE = 0.1, DEPTH = 1.0 / 8, STROKE = 1.0 / 7, WALL_MM = 0.8, WALLS = 2;

/* The widest strokes that can be read, by the size. */
static const double MAX_STROKE = 0.25;

/* Margin around the text, by the size. */
static const double MARGIN = 0.25;

/* Factor from one size that is tried to the next, and sizes: on flat places, then on curved ones. Steps are halved in the end. */
static const double SMALLER = 0.85;
enum { FLAT_SIZES = 5, CURVED_SIZES = 20, HALVINGS = 3 };

/* Flat places are off their plane by up to this much of the depth. Those up to a half of it are equal. */
static const double FLAT = 0.25;

/* Angles that the surface may lean by: noise on flat places, and curved ones. */
static const double FLAT_LEAN_DEG = 60, LEAN_DEG = 50;

/* Points that are looked at, by the size: first, and before the letters are made. */
static const double COARSE = 0.5, FINE = 1.0 / 6;

/* Cosine of the largest angle between a place and the direction that was asked for. */
static const double TOWARD = 0.866;

/* Differences of cosines to that direction, and of deviations and areas in proportion, that make no place better. */
static const double SAME_FACING = 0.005, SAME_DEVIATION = 0.1, SAME_AREA = 1e-3;

/* Places that are tried for letters before a smaller size is. */
enum { TRIES = 12 };

typedef struct place_search {
    const cwi_ray_target *target;
    const cwi_text_lines *lines;
    const cw_engrave_desc *desc;
    cwi_text_place *places, *fitted; /* fitted: as looking at them left them */
    cwi_place_look *looks;
    size_t count;
    cwi_text_size size;
    cwi_room_for_text room;
} place_search;

/* --- sizes -------------------------------------------------------------------------------- */

static cwi_text_size find_sizes(const place_search *s, double size)
{
    const cw_engrave_desc *d = s->desc;
    cwi_text_size t = {.size = size};
    t.depth = d->depth_mm > 0 ? d->depth_mm : DEPTH * size;
    t.stroke = d->stroke_mm > 0 ? d->stroke_mm : STROKE * size;
    t.wall = d->wall_mm > 0 ? d->wall_mm : cwi_lesser(WALL_MM, WALLS * t.depth);
    t.unit = (size - t.stroke) / CWI_GLYPH_HEIGHT;
    t.width = s->lines->width * t.unit + t.stroke;
    t.height = s->lines->height * t.unit + t.stroke;
    return t;
}

/* Sets the size that is tried next. Returns false for one that the strokes are too wide for. */
static bool set_size(place_search *s, double size, bool is_flat)
{
    const cwi_text_size t = s->size = find_sizes(s, size);
    s->room = (cwi_room_for_text){
        .half_width = t.width / 2 + MARGIN * size,
        .half_height = t.height / 2 + MARGIN * size,
        .max_deviation = is_flat ? FLAT * t.depth : t.width + t.height,
        .max_lean_deg = is_flat ? FLAT_LEAN_DEG : LEAN_DEG,
        .front = 1.5 * cwi_greater(t.depth, t.stroke / 2),
        .thickness = s->desc->emboss ? 0 : t.depth + t.wall,
    };
    return t.stroke <= MAX_STROKE * size * (1 + 1e-9);
}

/* --- places ------------------------------------------------------------------------------- */

/* Finds the point of the surface next to a point, and the normal there. */
static void find_nearest(const cwi_ray_target *target, const double at[3],
                         cwi_text_place *place)
{
    const cwi_closest found = cwi_closest_find(target->mesh, &target->tree, at);
    cwi_mesh_normal(target->mesh, found.triangle, place->normal);
    if (!cwi_normalise(place->normal))
        place->normal[2] = 1; /* a triangle without area: the plane is fitted anyway */
    memcpy(place->center, found.point, sizeof place->center);
}

/* Makes the place that the settings name. Where it lies flat the text runs along x, or else along y. */
static cw_status find_given_place(place_search *s, const double direction[3], cw_error *err)
{
    const cw_engrave_desc *d = s->desc;
    cwi_text_place p = {.hint = {1, 0, 0}};
    double at[3], height, lean;
    cwi_sub(d->at, s->target->mesh->origin, at);
    if (direction) {
        p.is_directed = true;
        memcpy(p.center, at, sizeof at);
        memcpy(p.normal, direction, sizeof p.normal);
        cwi_set_frame(&p);
        if (!cwi_find_height(s->target, &p, 0, 0, 2 * s->target->diagonal + cwi_length(at),
                             &height, &lean))
            return cwi_fail(
                err, CW_ERR_CHECK,
                "no surface that faces %.4g, %.4g, %.4g is along that direction from %.6g, "
                "%.6g, %.6g",
                direction[0], direction[1], direction[2], d->at[0], d->at[1], d->at[2]);
        cwi_add_scaled(p.center, height, p.normal, p.center);
    } else {
        find_nearest(s->target, at, &p);
        cwi_set_frame(&p);
    }
    s->places = cwi_alloc_array(1, sizeof *s->places);
    if (!s->places)
        return cwi_fail_memory(err);
    s->places[0] = p;
    s->count = 1;
    return CW_OK;
}

static cw_status find_places(place_search *s, cw_error *err)
{
    double direction[3];
    memcpy(direction, s->desc->direction, sizeof direction);
    const bool is_directed = cwi_normalise(direction);
    cw_status st = s->desc->has_at ? find_given_place(s, is_directed ? direction : NULL, err)
                                   : cwi_list_places(s->target, is_directed ? direction : NULL,
                                                     &s->places, &s->count, err);
    if (st == CW_OK && is_directed && !s->desc->has_at) {
        size_t kept = 0;
        for (size_t n = 0; n < s->count; n++)
            if (cwi_dot(s->places[n].normal, direction) >= TOWARD)
                s->places[kept++] = s->places[n];
        s->count = kept;
    }
    s->fitted = st == CW_OK ? cwi_alloc_array(s->count, sizeof *s->fitted) : NULL;
    s->looks = st == CW_OK ? cwi_alloc_zeroed(s->count, sizeof *s->looks) : NULL;
    return st == CW_OK && (!s->fitted || !s->looks) ? cwi_fail_memory(err) : st;
}

static void look_at_one(void *context, size_t n)
{
    place_search *s = context;
    s->fitted[n] = s->places[n];
    s->looks[n] = cwi_look_at_place(s->target, &s->fitted[n], &s->room, COARSE * s->size.size);
}

/* Looks at all places for a size. Returns CW_ERR_CANCELLED */
static cw_status look_at_places(place_search *s, cw_error *err)
{
    return cwi_parallel_for(s->count, 20000, s->desc->threads, &s->desc->progress,
                            "find the place", look_at_one, s, err);
}

/* Returns the cosine of a place's angle to the direction that was asked for; 0 without one. */
static double facing_of(const place_search *s, size_t n)
{
    double direction[3];
    memcpy(direction, s->desc->direction, sizeof direction);
    return cwi_normalise(direction) ? cwi_dot(direction, s->fitted[n].normal) : 0;
}

/* Returns true if place a is clearly better than b: flat, facing the direction that was asked for, flatter, not facing
 * down, the middle of a plane face, of a larger one. */
static bool is_better(const place_search *s, size_t a, size_t b)
{
    const cwi_text_place *p = &s->fitted[a], *q = &s->fitted[b];
    const double level = FLAT / 2 * s->size.depth, da = s->looks[a].deviation,
                 db = s->looks[b].deviation;
    const bool flat_a = da <= level, flat_b = db <= level;
    const double toward = facing_of(s, a) - facing_of(s, b);
    const bool down_a = p->normal[2] < -0.5, down_b = q->normal[2] < -0.5;
    if (flat_a != flat_b)
        return flat_a;
    if (fabs(toward) > SAME_FACING)
        return toward > 0;
    if (fabs(da - db) > cwi_greater(level, SAME_DEVIATION * cwi_greater(da, db)))
        return da < db;
    if (down_a != down_b)
        return down_b;
    return flat_a && p->area - q->area > SAME_AREA * p->area;
}

/* Returns the best place that fits, or count. */
static size_t find_best(const place_search *s)
{
    size_t best = s->count;
    for (size_t n = 0; n < s->count; n++)
        if (s->looks[n].result == CWI_PLACE_FITS && (best == s->count || is_better(s, n, best)))
            best = n;
    return best;
}

/* --- letters ------------------------------------------------------------------------------ */

/* Makes the letters at a place that a closer look finds fit. Returns CW_ERR_CHECK if it is not. */
static cw_status try_place(place_search *s, size_t n, cwi_placed_text *placed, cw_error *err)
{
    const cwi_text_size *t = &s->size;
    cwi_text_place place = s->fitted[n];
    const cwi_place_look look = cwi_look_at_place(s->target, &place, &s->room, FINE * t->size);
    s->looks[n] = look;
    if (look.result != CWI_PLACE_FITS)
        return cwi_fail(err, CW_ERR_CHECK, "the place does not fit");
    const double cell = placed->region.cell;
    const double under = cwi_lesser(cwi_greater(t->depth / 2, cell), look.thickness / 2);
    const double over = cwi_greater(t->depth, 2 * cell);
    cw_mesh_free(&placed->tool);
    cw_status st =
        cwi_make_letters(s->target, &place, &placed->region, s->desc->emboss ? under : t->depth,
                         s->desc->emboss ? t->depth : over,
                         s->room.half_width + s->room.half_height, &placed->tool, err);
    if (st == CW_ERR_CHECK)
        s->looks[n].result = CWI_PLACE_BENDS;
    placed->size = *t;
    placed->place = place;
    placed->look = look;
    return st;
}

/* Looks for a place at a size, and makes the letters there. Returns CW_ERR_CHECK if there is none. */
static cw_status try_size(place_search *s, double size, bool is_flat, cwi_placed_text *placed,
                          cw_error *err)
{
    if (!set_size(s, size, is_flat))
        return cwi_fail(
            err, CW_ERR_ARGUMENT,
            "strokes of %.3g mm need a size of %.3g mm or more to be read; it is %.3g mm",
            s->size.stroke, s->size.stroke / MAX_STROKE, size);
    cw_status st = look_at_places(s, err);
    size_t best = st == CW_OK ? find_best(s) : s->count;
    if (best == s->count)
        return st == CW_OK ? cwi_fail(err, CW_ERR_CHECK, "no place fits") : st;
    cwi_free_stroke_region(&placed->region);
    st = cwi_fill_strokes(s->lines, s->size.unit, s->size.stroke, &placed->region, err);
    if (st != CW_OK)
        return st;
    for (int n = 0; n < TRIES && best < s->count; n++, best = find_best(s)) {
        st = try_place(s, best, placed, err);
        if (st != CW_ERR_CHECK)
            return st;
    }
    return cwi_fail(err, CW_ERR_CHECK, "no place fits");
}

/* Halves the steps between a size that fits and the next larger one, which does not. */
static cw_status widen_size(place_search *s, double size, bool is_flat, cwi_placed_text *placed,
                            cw_error *err)
{
    double fits = size, fails = size / SMALLER;
    cw_status st = CW_OK;
    for (int n = 0; n < HALVINGS && (st == CW_OK || st == CW_ERR_CHECK); n++) {
        const double middle = sqrt(fits * fails);
        st = try_size(s, middle, is_flat, placed, err);
        if (st == CW_OK)
            fits = middle;
        else
            fails = middle;
    }
    return st == CW_ERR_CHECK ? try_size(s, fits, is_flat, placed, err) : st;
}

/* Finds the largest size up to one that fits: on a flat place if that is not much smaller.
 * first  0; 1: the largest is known not to fit */
static cw_status try_sizes(place_search *s, double largest, int first, cwi_placed_text *placed,
                           cw_error *err)
{
    cw_status st = CW_ERR_CHECK;
    for (int n = 0; n < FLAT_SIZES + CURVED_SIZES && st == CW_ERR_CHECK; n++) {
        const bool is_flat = n < FLAT_SIZES;
        const int step = first + (is_flat ? n : n - FLAT_SIZES);
        const double size = largest * pow(SMALLER, step);
        if (s->desc->stroke_mm > MAX_STROKE * size)
            n = is_flat ? FLAT_SIZES - 1 : FLAT_SIZES + CURVED_SIZES;
        else
            st = try_size(s, size, is_flat, placed, err);
        if (st == CW_OK && step > 0)
            st = widen_size(s, size, is_flat, placed, err);
    }
    return st;
}

/* --- failure ------------------------------------------------------------------------------ */

/* Describes why no place fits: the last of the requirements that some place meets. */
static void describe_failure(const place_search *s, char *why, size_t size)
{
    cwi_place_result farthest = CWI_PLACE_ENDS;
    double thickness = 0;
    for (size_t n = 0; n < s->count; n++) {
        farthest = s->looks[n].result > farthest ? s->looks[n].result : farthest;
        if (s->looks[n].result == CWI_PLACE_THIN)
            thickness = cwi_greater(thickness, s->looks[n].thickness);
    }
    const char *where = s->desc->has_at ? "at that point" : "where the text has room";
    if (farthest == CWI_PLACE_THIN)
        snprintf(
            why, size,
            "the material is %.3g mm thick at most %s; a depth of %.3g mm and a wall of %.3g "
            "mm need %.3g mm",
            thickness, where, s->size.depth, s->size.wall, s->room.thickness);
    else if (farthest == CWI_PLACE_COVERED)
        snprintf(why, size, "something is less than %.3g mm in front of the surface %s",
                 s->room.front, where);
    else if (farthest == CWI_PLACE_BENDS)
        snprintf(why, size, "the surface %s leans by more than %.0f degrees, or has steps",
                 where, LEAN_DEG);
    else
        snprintf(why, size, "%s",
                 s->desc->has_at ? "the surface ends within that box around the point"
                                 : "no place of the surface is that large");
}

/* Fails with the reason, and with the size that fits. */
static cw_status refuse_size(place_search *s, double size, cwi_placed_text *placed,
                             cw_error *err)
{
    char why[256], fits[96] = "";
    const cwi_text_size t = find_sizes(s, size);
    (void)set_size(s, size, false);
    describe_failure(s, why, sizeof why);
    if (s->desc->size_mm > 0) {
        const cw_status st = try_sizes(s, size, 1, placed, err);
        if (st == CW_OK)
            snprintf(fits, sizeof fits, "; a size of %.3g mm fits",
                     0.999 * placed->size.size); /* three digits do not round it up */
        else if (st != CW_ERR_CHECK && st != CW_ERR_ARGUMENT)
            return st;
    }
    return cwi_fail(
        err, CW_ERR_CHECK,
        "the text is %.3g x %.3g mm at a size of %.3g mm, with a margin of %.3g mm: %s%s",
        t.width, t.height, size, MARGIN * size, why, fits);
}

cw_status cwi_place_text(const cwi_ray_target *target, const cwi_text_lines *lines,
                         const cw_engrave_desc *desc, cwi_placed_text *placed, cw_error *err)
{
    place_search s = {.target = target, .lines = lines, .desc = desc};
    *placed = (cwi_placed_text){0};
    double size = desc->size_mm;
    cw_status st = find_places(&s, err);
    if (st == CW_OK && size > 0) {
        st = try_size(&s, size, true, placed, err);
        if (st == CW_ERR_CHECK)
            st = try_size(&s, size, false, placed, err);
    } else if (st == CW_OK) {
        size = cwi_greater(SIZE * target->diagonal, desc->stroke_mm / MAX_STROKE);
        st = try_sizes(&s, size, 0, placed, err);
        size = s.size.size;
    }
    if (st == CW_ERR_CHECK && s.looks)
        st = refuse_size(&s, size, placed, err);
    cwi_free(s.places);
    cwi_free(s.fitted);
    cwi_free(s.looks);
    return st;
}

void cwi_free_placed(cwi_placed_text *placed)
{
    cwi_free_stroke_region(&placed->region);
    cw_mesh_free(&placed->tool);
}
