/* Looks at places for text: fits their plane to the surface, and measures how flat, free and thick they are. */
#include "core/geometry/vec3.h"
#include "simplify/engrave/engrave_state.h"

#include <string.h>

/* Places whose normal is within about 25 degrees of the vertical lie flat. */
static const double FLAT = 0.906;

/* Points along a side when a plane is fitted, and at most when a place is measured. */
enum { FITTED = 5, MAX_SIDE = 161 };

void cwi_set_frame(cwi_text_place *place)
{
    const double *n = place->normal;
    if (fabs(n[2]) < FLAT) {
        const double z[3] = {0, 0, 1};
        cwi_add_scaled(z, -n[2], n, place->up);
        cwi_normalise(place->up);
        cwi_cross(place->up, n, place->right);
        return;
    }
    cwi_add_scaled(place->hint, -cwi_dot(place->hint, n), n, place->right);
    if (!cwi_normalise(place->right)) {
        const double x[3] = {1, 0, 0};
        cwi_add_scaled(x, -n[0], n, place->right);
        cwi_normalise(place->right);
    }
    cwi_cross(n, place->right, place->up);
}

/* Turns and moves the plane so that it fits the heights of a few points within a box. Returns false where the surface
 * does not cover them. */
static bool fit_plane(const cwi_ray_target *target, cwi_text_place *place, double half_width,
                      double half_height, double reach)
{
    double sum = 0, tilt[2] = {0}, square[2] = {0};
    for (int n = 0; n < FITTED * FITTED; n++) {
        const double x = half_width * (2.0 * (n % FITTED) / (FITTED - 1) - 1);
        const double y = half_height * (2.0 * (n / FITTED) / (FITTED - 1) - 1);
        double height, lean;
        if (!cwi_find_height(target, place, x, y, reach, &height, &lean))
            return false;
        sum += height;
        tilt[0] += x * height;
        tilt[1] += y * height;
        square[0] += x * x;
        square[1] += y * y;
    }
    cwi_add_scaled(place->center, sum / (FITTED * FITTED), place->normal, place->center);
    if (place->is_directed)
        return true;
    for (int a = 0; a < 3; a++)
        place->normal[a] -=
            tilt[0] / square[0] * place->right[a] + tilt[1] / square[1] * place->up[a];
    cwi_normalise(place->normal);
    cwi_set_frame(place);
    return true;
}

/* Visits the points of a grid over the box. Returns false when one stops it. */
static bool visit_points(const cwi_room_for_text *room, double step,
                         bool (*visit)(void *context, double x, double y), void *context)
{
    const double width = 2 * room->half_width, height = 2 * room->half_height;
    const int columns = (int)cwi_lesser(ceil(width / step), MAX_SIDE - 1);
    const int rows = (int)cwi_lesser(ceil(height / step), MAX_SIDE - 1);
    for (int row = 0; row <= rows; row++)
        for (int column = 0; column <= columns; column++)
            if (!visit(context, width * column / columns - room->half_width,
                       height * row / rows - room->half_height))
                return false;
    return true;
}

typedef struct look_state {
    const cwi_ray_target *target;
    const cwi_text_place *place;
    const cwi_room_for_text *room;
    cwi_place_look *look;
    double reach, low, high, least_cosine;
} look_state;

static bool measure_height(void *context, double x, double y)
{
    look_state *s = context;
    double height, lean;
    if (!cwi_find_height(s->target, s->place, x, y, s->reach, &height, &lean)) {
        s->look->result = CWI_PLACE_ENDS;
        return false;
    }
    s->low = cwi_lesser(s->low, height);
    s->high = cwi_greater(s->high, height);
    s->least_cosine = cwi_lesser(s->least_cosine, lean);
    if (s->high - s->low > 2 * s->room->max_deviation ||
        s->least_cosine < cos(s->room->max_lean_deg * CWI_PI / 180)) {
        s->look->result = CWI_PLACE_BENDS;
        return false;
    }
    return true;
}

static bool measure_space(void *context, double x, double y)
{
    look_state *s = context;
    const cwi_text_place *p = s->place;
    double at[3], height, lean, inward[3];
    if (!cwi_find_height(s->target, p, x, y, s->reach, &height, &lean))
        return false;
    for (int a = 0; a < 3; a++) {
        at[a] = p->center[a] + x * p->right[a] + y * p->up[a] + height * p->normal[a];
        inward[a] = -p->normal[a];
    }
    if (isfinite(cwi_cast_along(s->target, at, p->normal, s->room->front))) {
        s->look->result = CWI_PLACE_COVERED;
        return false;
    }
    const double far = cwi_greater(4 * s->room->thickness, 0.01 * s->target->diagonal);
    s->look->thickness =
        cwi_lesser(s->look->thickness, cwi_cast_along(s->target, at, inward, far));
    return true;
}

/* Moves the plane to the middle of the heights, so that they are below and above it alike. */
static void center_plane(look_state *s, cwi_text_place *place)
{
    cwi_add_scaled(place->center, (s->low + s->high) / 2, place->normal, place->center);
    s->look->deviation = (s->high - s->low) / 2;
    s->look->lean_deg = acos(cwi_lesser(s->least_cosine, 1)) * 180 / CWI_PI;
    s->low = s->high = 0;
}

cwi_place_look cwi_look_at_place(const cwi_ray_target *target, cwi_text_place *place,
                                 const cwi_room_for_text *room, double step)
{
    cwi_place_look look = {.result = CWI_PLACE_ENDS, .thickness = INFINITY};
    const double reach = cwi_greater(room->half_width, room->half_height);
    if (!(place->area > 0) &&
        (!fit_plane(target, place, room->half_height / 2, room->half_height / 2, reach) ||
         !fit_plane(target, place, room->half_width, room->half_height, reach)))
        return look;
    look_state s = {target, place, room, &look, reach, INFINITY, -INFINITY, 1};
    if (!visit_points(room, step, measure_height, &s))
        return look;
    center_plane(&s, place);
    look.result = CWI_PLACE_FITS;
    if (visit_points(room, step, measure_space, &s) && look.thickness < room->thickness)
        look.result = CWI_PLACE_THIN;
    return look;
}
