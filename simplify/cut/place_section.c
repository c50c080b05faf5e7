/* Places the vertices of a cut: those of the section lie in the plane but for rounding. */
#include "core/base/memory.h"
#include "core/geometry/vec3.h"
#include "simplify/cut/cut_state.h"

#include <math.h>
#include <string.h>

/* Moves a point into the plane along the axis nearest to its normal. Its other coordinates are
 * rounded before, so only the rounding of one is left. */
static void round_into_plane(const cwi_cut *c, const double point[3], float position[3])
{
    double height = c->offset;
    for (int a = 0; a < 3; a++) {
        position[a] = (float)point[a];
        if (a != c->axis)
            height -= c->normal[a] * (double)position[a];
    }
    position[c->axis] = (float)(height / c->normal[c->axis]);
}

/* Finds the position of a vertex on its edge; above the plane, if the section passes around a
 * vertex, and then it is moved down along the normal. */
static void find_point(const cwi_cut *c, size_t n, double point[3])
{
    const cwi_cut_source *s = c->sources + n;
    const float *a = c->mesh->positions + 3 * (size_t)s->a,
                *b = c->mesh->positions + 3 * (size_t)s->b;
    double height = -c->offset;
    for (int k = 0; k < 3; k++) {
        point[k] = (double)a[k] + s->t * ((double)b[k] - (double)a[k]);
        height += c->normal[k] * point[k];
    }
    for (int k = 0; k < 3 && s->a != s->b; k++)
        point[k] -= height * c->normal[k];
}

void cwi_cut_measure_moves(cwi_cut *c)
{
    for (size_t n = 0; n < c->vertex_count; n++) {
        const cwi_cut_source *s = c->sources + n;
        if (!c->is_section[n] || s->a != s->b)
            continue;
        const double move_sq =
            cwi_point_distance_sq(c->positions + 3 * n, c->mesh->positions + 3 * (size_t)s->a);
        c->facts.moved_mm = fmax(c->facts.moved_mm, sqrt(move_sq));
    }
}

bool cwi_cut_place_vertices(cwi_cut *c)
{
    c->positions = cwi_alloc_array(3 * c->vertex_count, sizeof *c->positions);
    c->is_section = cwi_alloc_array(c->vertex_count, sizeof *c->is_section);
    if (!c->positions || !c->is_section)
        return false;
    for (size_t n = 0; n < c->vertex_count; n++) {
        const cwi_cut_source *s = c->sources + n;
        double point[3];
        c->is_section[n] = s->a != s->b || c->side[s->a] == CWI_CUT_ON;
        if (!c->is_section[n]) {
            memcpy(c->positions + 3 * n, c->mesh->positions + 3 * (size_t)s->a,
                   3 * sizeof *c->positions);
            continue;
        }
        find_point(c, n, point);
        round_into_plane(c, point, c->positions + 3 * n);
    }
    cwi_cut_measure_moves(c);
    return true;
}

void cwi_cut_place_apart(cwi_cut *c, size_t n, const double shift[2], int lowered)
{
    float *position = c->positions + 3 * n;
    double point[3];
    find_point(c, n, point);
    for (int k = 0; k < 2; k++)
        point[(c->axis + k + 1) % 3] += shift[k] * c->step;
    round_into_plane(c, point, position);
    if (lowered)
        position[c->axis] = (float)((double)position[c->axis] -
                                    copysign(lowered * c->step, c->normal[c->axis]));
}
