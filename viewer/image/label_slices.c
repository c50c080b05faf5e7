/* Draws labels over a picture of slices: for each sample the label of the voxel that is nearest
 * to its point, without interpolation between labels. */
#include <cubewright/overlay.h>

#include "core/base/status.h"
#include "core/volume/volume.h"
#include "viewer/image/slice_paint.h"

#include <math.h>

typedef struct label_source {
    const cw_label_slices *o;
    cw_volume labels; /* resolved */
} label_source;

/* Finds the label at a point of the world; NULL where there is none to be drawn. */
static const cw_label *label_at(const label_source *p, const double world[3])
{
    double index[3];
    size_t at[3];
    if (cw_volume_to_index(&p->labels, world, index, NULL) != CW_OK)
        return NULL;
    for (int a = 0; a < 3; a++) {
        const double nearest = floor(index[a] + 0.5);
        if (!(nearest >= 0 && nearest < (double)p->labels.dim[a]))
            return NULL;
        at[a] = (size_t)nearest;
    }
    const double value = cwi_whole_value(cw_volume_value(&p->labels, at[0], at[1], at[2]));
    if (!(value >= 0 && value <= UINT32_MAX && value == floor(value)))
        return NULL;
    return cw_label_find(p->o->table, p->o->layer, (uint32_t)value);
}

static bool label_color(const void *context, const double world[3], double rgba[4])
{
    const cw_label *label = label_at(context, world);
    for (int c = 0; c < 4 && label; c++)
        rgba[c] = label->color[c] / 255.0;
    return label;
}

cw_status cw_label_slices_draw(const cw_label_slices *labels, const cw_scene *scene,
                               cw_picture *picture, cw_error *err)
{
    CWI_REQUIRE(err, labels, scene, picture);
    label_source s = {.o = labels};
    const double opacity = labels->opacity != 0 ? (double)labels->opacity : 1;
    cw_status st = cw_volume_resolve(labels->labels, &s.labels, err);
    if (st == CW_OK)
        st = cwi_volume_expect_dense(&s.labels, "drawing labels", err);
    const cwi_slice_paint paint = {"labels", &s.labels, opacity, label_color, &s};
    return st == CW_OK ? cwi_slice_paint_draw(&paint, scene, picture, err) : st;
}
