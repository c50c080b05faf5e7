/* Compares a caller's claim on unit and frame with the file's statement, and turns volumes and
 * meshes. */
#include "formats/volume/frame_claim.h"

#include "core/base/status.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Axes whose unit may be another one than ours. */
typedef struct axes {
    double unit_mm;
    bool ras, y_up;
} axes;

/* The file's statement; unknown parts are as the reader assumed. */
typedef struct saying {
    axes axes;
    bool has_unit, has_frame, has_up;
} saying;

static const char *unit_text(double mm, char text[32])
{
    for (int u = 0; u < CW_UNIT_COUNT; u++)
        if (fabs(cw_unit_mm((cw_unit)u) - mm) <= 1e-9 * mm)
            return cw_unit_name((cw_unit)u);
    snprintf(text, 32, "%g mm", mm);
    return text;
}

static bool is_unit(double mm, cw_unit unit)
{
    return fabs(cw_unit_mm(unit) - mm) <= 1e-9 * mm;
}

/* Computes the matrix from coordinates of the file to LPS millimetres: the inverse of
 * cwi_turn_to(). */
static void set_matrix(const axes *x, double m[3][3])
{
    const double ras = x->ras ? -1 : 1;
    memset(m, 0, 9 * sizeof(double));
    m[0][0] = ras * x->unit_mm;
    m[1][x->y_up ? 2 : 1] = (x->y_up ? -ras : ras) * x->unit_mm;
    m[2][x->y_up ? 1 : 2] = x->unit_mm;
}

/* Computes the matrix that turns coordinates read with the axes `from` into those with the axes
 * `to`. Both matrices have perpendicular columns of equal length. */
static void set_change(const axes *from, const axes *to, double m[3][3])
{
    double was[3][3], is[3][3];
    set_matrix(from, was);
    set_matrix(to, is);
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++) {
            double sum = 0;
            for (int k = 0; k < 3; k++)
                sum += is[r][k] * was[c][k];
            m[r][c] = sum / (from->unit_mm * from->unit_mm) + 0.0; /* no -0 */
        }
}

static cw_status check_agreement(const cw_claim *claim, const saying *s, cw_error *err)
{
    static const char hint[] =
        "to be read so all the same, say desc->claim.rule = CW_CLAIM_OVERRIDE";
    char text[32];
    if (claim->rule != CW_CLAIM_AGREE)
        return CW_OK;
    if (claim->has_unit && s->has_unit && !is_unit(s->axes.unit_mm, claim->axes.unit))
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "the file says that its unit is %s, and not %s; %s",
                        unit_text(s->axes.unit_mm, text), cw_unit_name(claim->axes.unit), hint);
    if (claim->has_frame && s->has_frame && s->axes.ras != claim->axes.ras)
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "the file says that its frame is %s, and not %s; %s",
                        s->axes.ras ? "ras" : "lps", claim->axes.ras ? "ras" : "lps", hint);
    if (claim->has_up && s->has_up && s->axes.y_up != claim->axes.y_up)
        return cwi_fail(err, CW_ERR_ARGUMENT, "the file says that %s is up, and not %s; %s",
                        s->axes.y_up ? "y" : "z", claim->axes.y_up ? "y" : "z", hint);
    return CW_OK;
}

/* Chooses the axes that count, by the rule. */
static axes choose_axes(const cw_claim *claim, const saying *s)
{
    const bool fills = claim->rule == CW_CLAIM_FILL;
    axes x = s->axes;
    if (claim->has_unit && !(fills && s->has_unit))
        x.unit_mm = cw_unit_mm(claim->axes.unit);
    if (claim->has_frame && !(fills && s->has_frame))
        x.ras = claim->axes.ras;
    if (claim->has_up && !(fills && s->has_up))
        x.y_up = claim->axes.y_up;
    return x;
}

static bool is_silent(const cw_claim *claim)
{
    return !claim->has_unit && !claim->has_frame && !claim->has_up;
}

/* --- volumes ------------------------------------------------------------------------------ */

static void turn_points(double m[3][3], double *points, size_t count)
{
    for (size_t n = 0; n < count; n++) {
        double *p = points + 3 * n;
        const double q[3] = {p[0], p[1], p[2]};
        for (int r = 0; r < 3; r++)
            p[r] = m[r][0] * q[0] + m[r][1] * q[1] + m[r][2] * q[2] + 0.0;
    }
}

static void turn_affine(double m[3][3], double affine[3][4])
{
    double turned[3][4];
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 4; c++)
            turned[r][c] =
                m[r][0] * affine[0][c] + m[r][1] * affine[1][c] + m[r][2] * affine[2][c] + 0.0;
    memcpy(affine, turned, sizeof turned);
}

cw_status cwi_claim_volume(const cw_claim *claim, cw_volume *v, cw_error *err)
{
    const double unit = v->known & CW_KNOWN_UNIT && v->said_unit_mm > 0 ? v->said_unit_mm : 1;
    const bool framed = v->known & CW_KNOWN_FRAME;
    const saying metadata = {.axes = {.unit_mm = unit, .ras = framed && v->said_ras},
                             .has_unit = v->known & CW_KNOWN_UNIT,
                             .has_frame = framed,
                             .has_up = framed};
    double m[3][3];
    if (is_silent(claim))
        return CW_OK;
    cw_status st = check_agreement(claim, &metadata, err);
    if (st != CW_OK)
        return st;
    const axes x = choose_axes(claim, &metadata);
    set_change(&metadata.axes, &x, m);
    if (v->cells && v->cells->points) /* owned by the volume */
        turn_points(m, (double *)(uintptr_t)v->cells->points, v->dim[0]);
    else if (!v->cells)
        turn_affine(m, v->affine);
    for (int r = 0; r < 3; r++)
        if (!isfinite(v->affine[r][3]))
            return cwi_fail(err, CW_ERR_FORMAT, "its coordinates in mm are out of range");
    v->known |=
        (claim->has_unit ? CW_KNOWN_UNIT : 0u) | (claim->has_frame ? CW_KNOWN_FRAME : 0u);
    v->said_unit_mm = x.unit_mm;
    v->said_ras = x.ras;
    return CW_OK;
}

/* --- meshes ------------------------------------------------------------------------------- */

static bool turn_floats(double m[3][3], float *points, size_t count, double scale)
{
    bool finite = true;
    for (size_t n = 0; n < count; n++) {
        double p[3];
        for (size_t a = 0; a < 3; a++)
            p[a] = (double)points[3 * n + a];
        turn_points(m, p, 1);
        for (size_t a = 0; a < 3; a++) {
            points[3 * n + a] = (float)(p[a] * scale);
            finite = finite && isfinite(points[3 * n + a]);
        }
    }
    return finite;
}

static cw_status turn_mesh(const axes *from, const axes *to, cw_mesh *mesh, cw_error *err)
{
    double m[3][3];
    set_change(from, to, m);
    turn_points(m, mesh->origin, 1);
    if (!turn_floats(m, mesh->positions, mesh->vertex_count, 1))
        return cwi_fail(err, CW_ERR_FORMAT,
                        "single precision cannot hold its coordinates in mm");
    if (mesh->normals)
        turn_floats(m, mesh->normals, mesh->vertex_count, from->unit_mm / to->unit_mm);
    return CW_OK;
}

cw_status cwi_claim_mesh(const cw_claim *claim, cw_mesh_file *file, cw_mesh *mesh,
                         cw_error *err)
{
    const bool gltf = strcmp(file->format, "glb") == 0 || strcmp(file->format, "gltf") == 0;
    const bool framed = file->known & CW_KNOWN_FRAME;
    const saying metadata = {
        .axes = {.unit_mm = gltf ? cw_unit_mm(CW_UNIT_M) : cw_unit_mm(file->axes.unit),
                 .ras = file->axes.ras,
                 .y_up = gltf || file->axes.y_up},
        .has_unit = file->known & CW_KNOWN_UNIT,
        .has_frame = framed,
        .has_up = gltf || framed || file->axes.y_up};
    if (is_silent(claim))
        return CW_OK;
    cw_status st = check_agreement(claim, &metadata, err);
    if (st != CW_OK)
        return st;
    const axes x = choose_axes(claim, &metadata);
    if (gltf)
        return turn_mesh(&metadata.axes, &x, mesh, err);
    if (claim->has_unit && x.unit_mm != metadata.axes.unit_mm)
        file->axes.unit = claim->axes.unit;
    file->axes.ras = x.ras;
    file->axes.y_up = x.y_up;
    file->known |=
        (claim->has_unit ? CW_KNOWN_UNIT : 0u) | (claim->has_frame ? CW_KNOWN_FRAME : 0u);
    return CW_OK;
}
