/* Applies the transform of a file from a surface's coordinates to those of the scanner. */
#include "formats/mesh/scanner_frame.h"

#include "core/base/status.h"

#include <math.h>
#include <stdio.h>

/* Rotations are written with six digits, and by sums of single precision. */
static const double NO_TURN = 1e-6;

static double determinant(double m[3][4])
{
    return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
           m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
           m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
}

static bool is_shift(double m[3][4])
{
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++)
            if (!(fabs(m[r][c] - (r == c)) <= NO_TURN))
                return false;
    return true;
}

static cw_status check_map(double m[3][4], const char *name, cw_error *err)
{
    bool finite = true;
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 4; c++)
            finite = finite && isfinite(m[r][c]);
    if (!finite)
        return cwi_fail(err, CW_ERR_FORMAT, "%s has a number that is not finite", name);
    if (fabs(determinant(m)) < 1e-12)
        return cwi_fail(err, CW_ERR_FORMAT, "%s maps everything onto a plane", name);
    return CW_OK;
}

static void move_points(double m[3][4], cwi_mesh_build *b)
{
    for (size_t i = 0; i < b->point_count; i++) {
        double *p = b->points + 3 * i;
        const double x = p[0], y = p[1], z = p[2];
        for (int r = 0; r < 3; r++)
            p[r] = m[r][0] * x + m[r][1] * y + m[r][2] * z + m[r][3];
    }
}

static void turn_windings(cwi_mesh_build *b)
{
    for (size_t t = 0; t < b->triangle_count; t++) {
        uint32_t *corner = b->triangles + 3 * t, first = corner[1];
        corner[1] = corner[2];
        corner[2] = first;
    }
}

cw_status cwi_place_in_scanner(double m[3][4], const char *name, cwi_mesh_build *build,
                               cw_mesh *mesh, cw_mesh_file *metadata, cw_error *err)
{
    const bool shifts = m[0][3] != 0 || m[1][3] != 0 || m[2][3] != 0;
    cw_status st = check_map(m, name, err);
    if (st != CW_OK || (is_shift(m) && !shifts))
        return st;
    snprintf(metadata->placed, sizeof metadata->placed, "%s: %s (%g, %g, %g) mm, RAS", name,
             is_shift(m) ? "a shift by" : "a turn and a shift by", m[0][3], m[1][3], m[2][3]);
    metadata->local = is_shift(m);
    if (is_shift(m)) {
        for (int a = 0; a < 3; a++)
            mesh->origin[a] += m[a][3];
        return CW_OK;
    }
    move_points(m, build);
    if (determinant(m) < 0)
        turn_windings(build);
    return CW_OK;
}
