/* Draws the values of another volume over a picture of slices, in the colours of a map. */
#include <cubewright/overlay.h>

#include "core/base/status.h"
#include "core/volume/volume.h"
#include "viewer/image/slice_paint.h"

#include <math.h>

typedef struct value_source {
    const cw_value_slices *o;
    cw_volume values; /* resolved */
} value_source;

/* Takes the field's own colour at each point: values are interpolated, not colours. */
static bool value_color(const void *context, const double world[3], double rgba[4])
{
    const value_source *s = context;
    uint8_t rgb[3];
    const double value = cw_volume_sample(&s->values, world);
    if (!(value >= s->o->low))
        return false;
    cw_colormap_color(s->o->map, (value - s->o->low) / (s->o->high - s->o->low), rgb);
    for (int c = 0; c < 3; c++)
        rgba[c] = rgb[c] / 255.0;
    rgba[3] = 1;
    return true;
}

cw_status cw_value_slices_draw(const cw_value_slices *values, const cw_scene *scene,
                               cw_picture *picture, cw_error *err)
{
    CWI_REQUIRE(err, values, scene, picture);
    value_source s = {.o = values};
    const double opacity = values->opacity != 0 ? (double)values->opacity : 1;
    if (!(values->low < values->high) || !isfinite(values->low) || !isfinite(values->high))
        return cwi_fail(err, CW_ERR_ARGUMENT,
                        "the colours are from %g to %g: finite, rising values were expected",
                        values->low, values->high);
    if (!cw_colormap_name(values->map))
        return cwi_fail(err, CW_ERR_ARGUMENT, "%d is not a colour map", (int)values->map);
    cw_status st = cw_volume_resolve(values->values, &s.values, err);
    if (st == CW_OK)
        st = cwi_volume_expect_dense(&s.values, "drawing values over slices", err);
    const cwi_slice_paint paint = {"values", &s.values, opacity, value_color, &s};
    return st == CW_OK ? cwi_slice_paint_draw(&paint, scene, picture, err) : st;
}
