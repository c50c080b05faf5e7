/* Triangles cut by planes across the axes. */
#ifndef CORE_GEOMETRY_POLYGON_CLIP_H
#define CORE_GEOMETRY_POLYGON_CLIP_H

enum { CWI_POLYGON_MOST = 24 };

/* Convex; a plane adds a corner at most, and what would be too many are left out. */
typedef struct cwi_polygon {
    int count;
    double p[CWI_POLYGON_MOST][3];
} cwi_polygon;

/* What of a polygon has by * (x[a] - at) <= 0. */
void cwi_polygon_clip(const cwi_polygon *in, int a, double at, int by, cwi_polygon *out);

#endif
