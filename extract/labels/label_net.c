/* Lists the corners of polygons, and the polygons around vertices. */
#include "extract/labels/label_net.h"

#include "core/base/memory.h"

int cwi_polygon_corners(const cwi_label_net *net, const cw_mesh *mesh, size_t polygon,
                        uint32_t corners[CWI_POLYGON_CORNERS])
{
    const size_t end = cwi_polygon_end(net, mesh, polygon);
    const uint32_t *v = mesh->triangles + 3 * polygon;
    const bool flips = end > polygon + 1 && v[4] != v[2];
    int count = 0;
    corners[count++] = v[0];
    corners[count++] = v[flips ? 2 : 1];
    for (size_t t = polygon; t < end && count < CWI_POLYGON_CORNERS; t++)
        corners[count++] = mesh->triangles[3 * t + (flips ? 1 : 2)];
    return count;
}

/* Counts polygons of vertices, then fills them in from behind. */
bool cwi_label_net_finish(cwi_label_net *net, const cw_mesh *mesh)
{
    uint32_t v[CWI_POLYGON_CORNERS];
    size_t total = 0;
    net->firsts = cwi_alloc_zeroed(mesh->vertex_count + 1, sizeof *net->firsts);
    if (!net->firsts)
        return false;
    for (size_t t = 0; t < mesh->triangle_count; t++) {
        for (int n = net->polygons[t] ? cwi_polygon_corners(net, mesh, t, v) : 0; n-- > 0;)
            net->firsts[v[n]]++;
        cwi_label_trim(t);
    }
    for (size_t n = 0; n <= mesh->vertex_count; n++) {
        total += net->firsts[n];
        net->firsts[n] = (uint32_t)total;
        cwi_memory_trim_at(n);
    }
    net->around = cwi_alloc_large(total, sizeof *net->around);
    if (!net->around)
        return false;
    for (size_t t = mesh->triangle_count; t-- > 0;) {
        for (int n = net->polygons[t] ? cwi_polygon_corners(net, mesh, t, v) : 0; n-- > 0;)
            net->around[--net->firsts[v[n]]] = (uint32_t)t;
        cwi_label_trim(t);
    }
    return true;
}

void cwi_label_net_free(cwi_label_net *net)
{
    cwi_free(net->neighbours);
    cwi_free(net->kinds);
    cwi_free(net->polygons);
    cwi_free(net->firsts);
    cwi_free(net->around);
    *net = (cwi_label_net){0};
}
