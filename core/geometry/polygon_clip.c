/* Clips a convex polygon by a plane across an axis (Sutherland-Hodgman). */
#include "core/geometry/polygon_clip.h"

#include "core/geometry/vec3.h"

#include <string.h>

void cwi_polygon_clip(const cwi_polygon *in, int a, double at, int by, cwi_polygon *out)
{
    out->count = 0;
    for (int n = 0; n < in->count; n++) {
        const double *p = in->p[n], *q = in->p[(n + 1) % in->count];
        const double u = by * (p[a] - at), v = by * (q[a] - at);
        if (u <= 0 && out->count < CWI_POLYGON_MAX)
            memcpy(out->p[out->count++], p, sizeof out->p[0]);
        if (!((u < 0 && v > 0) || (u > 0 && v < 0)) || out->count == CWI_POLYGON_MAX)
            continue;
        cwi_lerp(p, q, u / (u - v), out->p[out->count]);
        out->count++;
    }
}
