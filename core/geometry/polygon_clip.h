/* Clipping of triangles by planes across the axes. */
#ifndef CORE_GEOMETRY_POLYGON_CLIP_H
#define CORE_GEOMETRY_POLYGON_CLIP_H

enum { CWI_POLYGON_MAX = 24 };

/* A convex polygon. A plane adds one corner at most; corners beyond the capacity are left
 * out. */
typedef struct cwi_polygon {
    int count;
    double p[CWI_POLYGON_MAX][3];
} cwi_polygon;

/* Clips a polygon to the part with by * (x[a] - at) <= 0. */
void cwi_polygon_clip(const cwi_polygon *in, int a, double at, int by, cwi_polygon *out);

#endif
