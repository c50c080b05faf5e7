/* Triangles on a screen: projected points, rows and columns of samples, and edge functions.
 *
 * Coordinates are rounded to 1/256 of a sample, as GPUs do. Within a range of 2^17 samples the
 * edge functions of such points are exact in double, and with the top-left rule every sample of
 * a surface belongs to exactly one of its triangles: no cracks, no double hits. */
#ifndef VIEWER_RASTER_FACET_H
#define VIEWER_RASTER_FACET_H

#include <cubewright/camera.h>

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* A camera and the samples of its picture. */
typedef struct cwi_screen {
    double eye[3], right[3], up[3], forward[3]; /* in the world; axes of length 1 */
    bool perspective;
    double scale;      /* samples per mm, or per unit of slope in perspective */
    double near_mm;    /* surfaces nearer than this are not drawn */
    int width, height; /* in samples */
} cwi_screen;

/* A projected point: sample coordinates (y down) and depth along the line of sight. Behind the
 * near plane, where nothing can be divided by depth, x and y are still multiplied by it. */
typedef struct cwi_screen_point {
    double x, y, z;
} cwi_screen_point;

/* The rows or columns of samples that a triangle may cover; none when last < first. */
typedef struct cwi_sample_span {
    int32_t first, last;
} cwi_sample_span;

/* A triangle ready to be drawn: edge i is opposite corner i, and its function
 * edge[i] . (x, y, 1) is positive inside. Weighted, the three are barycentric coordinates up to
 * a common factor, right in perspective. */
typedef struct cwi_screen_facet {
    double edge[3][3], weight[3], z[3];
    double determinant; /* of the corners; positive for a triangle seen from its back */
    bool owns[3];       /* the top-left rule: samples on this edge are its own */
    bool is_back;
} cwi_screen_facet;

/* Sets up the screen of a camera. The near plane is a millionth of the target's distance away.
 * Returns  CW_ERR_ARGUMENT as cw_camera_axes() */
CW_NODISCARD cw_status cwi_screen_set_up(const cw_camera *camera, int width, int height,
                                         cwi_screen *screen, cw_error *err);

/* Projects a point, given relative to the eye. */
cwi_screen_point cwi_screen_project(const cwi_screen *screen, const double from_eye[3]);

/* Returns the rows or columns of a triangle. A triangle that crosses the near plane may be anywhere.
 * reach  of samples from the middles of their rows or columns, 0 to 0.5 */
cwi_sample_span cwi_screen_rows(const cwi_screen *screen, const cwi_screen_point p[3],
                                double reach);
cwi_sample_span cwi_screen_columns(const cwi_screen *screen, const cwi_screen_point p[3],
                                   double reach);

/* Sets up a facet; returns false for a triangle seen edge-on. */
bool cwi_facet_set_up(const cwi_screen *screen, const cwi_screen_point p[3],
                      cwi_screen_facet *facet);

/* Computes the direction from a surface at a sample to the eye, of length 1. */
void cwi_screen_to_eye(const cwi_screen *screen, double x, double y, double direction[3]);

static inline void cwi_facet_edges(const cwi_screen_facet *f, double x, double y, double e[3])
{
    for (int c = 0; c < 3; c++)
        e[c] = f->edge[c][0] * x + (f->edge[c][1] * y + f->edge[c][2]);
}

static inline bool cwi_facet_is_inside(const cwi_screen_facet *f, const double e[3])
{
    for (int c = 0; c < 3; c++)
        if (!(e[c] > 0 || (e[c] == 0 && f->owns[c])))
            return false;
    return true;
}

/* Converts edge functions at a sample to weights of the corners, which sum to 1. */
static inline void cwi_facet_weights(const cwi_screen_facet *f, const double e[3],
                                     double weights[3])
{
    const double b[3] = {e[0] * f->weight[0], e[1] * f->weight[1], e[2] * f->weight[2]};
    for (int c = 0; c < 3; c++)
        weights[c] = b[c] / (b[0] + b[1] + b[2]);
}

#ifdef __cplusplus
}
#endif

#endif
