/* Puts vertices of triangles that cross back, and looks again around them. */
#include "extract/labels/label_untangle.h"

/* Puts the vertices that were hit back to their positions before smoothing. Returns false if there
 * are none. */
static bool put_back(const cwi_label_crossings *c, cw_mesh *mesh)
{
    bool is_any = false;
    for (size_t v = 0; v < mesh->vertex_count; v++) {
        double index[3], point[3];
        if (!c->hits[v])
            continue;
        for (int a = 0; a < 3; a++)
            index[a] = (double)c->originals[3 * v + (size_t)a];
        c->to_point(c->context, index, point);
        for (int a = 0; a < 3; a++)
            mesh->positions[3 * v + (size_t)a] = (float)point[a];
        c->net->kinds[v] |= CWI_NET_BACK;
        is_any = true;
    }
    return is_any;
}

cw_status cwi_labels_untangle(cw_label_surfaces *surfaces, cwi_label_net *net,
                              const float *originals, cwi_label_to_point *to_point,
                              const void *context, const cw_labels_desc *desc, cw_error *err)
{
    cwi_label_crossings crossings = {.mesh = &surfaces->mesh,
                                     .originals = originals,
                                     .net = net,
                                     .to_point = to_point,
                                     .context = context};
    cw_status st = cwi_label_crossings_init(&crossings, desc, err);
    while (st == CW_OK && crossings.queued > 0) {
        st = cwi_label_crossings_find(&crossings, desc, err);
        if (st != CW_OK || !put_back(&crossings, &surfaces->mesh))
            break;
        cwi_label_crossings_renew(&crossings);
    }
    cwi_label_crossings_free(&crossings);
    return st;
}
