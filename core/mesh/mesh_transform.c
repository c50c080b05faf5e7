/* Moves, scales, mirrors and turns meshes by an affine map. */
#include "core/base/status.h"
#include "core/geometry/affine.h"
#include "core/geometry/vec3.h"
#include "core/mesh/mesh_attributes.h"

#include <cubewright/mesh.h>

#include <float.h>
#include <math.h>
#include <string.h>

static bool is_finite(const double *numbers, size_t count)
{
    for (size_t n = 0; n < count; n++)
        if (!isfinite(numbers[n]))
            return false;
    return true;
}

/* The linear part alone. */
static void turn(const double *map, const float *from, double to[3])
{
    for (int r = 0; r < 3; r++)
        to[r] = map[4 * r] * (double)from[0] + map[4 * r + 1] * (double)from[1] +
                map[4 * r + 2] * (double)from[2];
}

/* Checks the map, and that all positions stay finite in single precision. */
static cw_status check_map(const cw_mesh *mesh, const double *map, cw_error *err)
{
    const double determinant = cwi_affine_determinant(map);
    if (!is_finite(map, 12) || !isfinite(determinant) || determinant == 0)
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "the matrix has the determinant %g; one that is finite and not 0 was "
                        "expected, of 12 finite numbers",
                        determinant);
    double origin[3];
    cwi_affine_apply(map, mesh->origin, origin);
    bool fits = is_finite(origin, 3);
    for (size_t v = 0; v < mesh->vertex_count && fits; v++) {
        double p[3];
        turn(map, mesh->positions + 3 * v, p);
        fits = fabs(p[0]) <= (double)FLT_MAX && fabs(p[1]) <= (double)FLT_MAX &&
               fabs(p[2]) <= (double)FLT_MAX;
    }
    return fits ? CW_OK
                : cwi_fail(err, CW_ERR_ARGUMENT,
                           "the matrix takes vertices beyond single precision, 3.4e38 mm");
}

/* Directions become of length 1 again; one that vanishes stays. */
static void turn_direction(const double *map, float *direction)
{
    double d[3];
    turn(map, direction, d);
    const double length = sqrt(cwi_dot(d, d));
    for (int a = 0; a < 3 && length > 0 && isfinite(length); a++)
        direction[a] = (float)(d[a] / length);
}

/* Normals stand on the surface: they take the cofactors, whose sign the determinant gives. */
static void turn_normals(const double *map, cw_mesh *mesh)
{
    double cofactor[3][3], normal_map[12] = {0};
    const double sign = cwi_affine_determinant(map) < 0 ? -1 : 1;
    cwi_affine_cofactor(map, cofactor);
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++)
            normal_map[4 * r + c] = sign * cofactor[r][c];
    for (size_t v = 0; v < mesh->vertex_count && mesh->normals; v++)
        turn_direction(normal_map, mesh->normals + 3 * v);
}

static void turn_attributes(const double *map, cw_mesh *mesh)
{
    for (size_t n = 0; n < mesh->attribute_count; n++) {
        const cw_attribute *a = &mesh->attributes[n];
        const size_t count = cwi_attribute_elements(mesh, a->on);
        if (a->interpolation != CW_INTERPOLATE_DIRECTION || a->type != CW_F32 ||
            a->components < 3 || a->components > 4)
            continue;
        for (size_t i = 0; i < count; i++)
            turn_direction(map, (float *)a->data + i * a->components);
    }
}

static void move_affine(const double *map, cw_mesh *mesh)
{
    double moved[3][4];
    for (int c = 0; c < 4; c++) {
        const double column[3] = {mesh->affine[0][c], mesh->affine[1][c], mesh->affine[2][c]};
        for (int r = 0; r < 3; r++)
            moved[r][c] = cwi_dot(map + 4 * r, column) + (c == 3 ? map[4 * r + 3] : 0);
    }
    memcpy(mesh->affine, moved, sizeof moved);
}

cw_status cw_mesh_transform(cw_mesh *mesh, const double matrix[12], cw_error *err)
{
    CWI_REQUIRE(err, mesh, matrix);
    cw_status st = cw_mesh_check(mesh, err);
    if (st == CW_OK)
        st = check_map(mesh, matrix, err);
    if (st != CW_OK)
        return st;
    double origin[3];
    cwi_affine_apply(matrix, mesh->origin, origin);
    memcpy(mesh->origin, origin, sizeof origin);
    for (size_t v = 0; v < mesh->vertex_count; v++) {
        double p[3];
        turn(matrix, mesh->positions + 3 * v, p);
        for (size_t a = 0; a < 3; a++)
            mesh->positions[3 * v + a] = (float)p[a];
    }
    turn_normals(matrix, mesh);
    turn_attributes(matrix, mesh);
    for (size_t t = 0; t < mesh->triangle_count && cwi_affine_determinant(matrix) < 0; t++)
        cwi_mesh_swap_corners(mesh, t, 1, 2);
    if (cwi_affine_determinant(mesh->affine[0]) != 0)
        move_affine(matrix, mesh);
    return CW_OK;
}
