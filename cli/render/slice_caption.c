/* Names slices as radiologists do, with their number along the grid's axis. */
#include "cli/render/slice_caption.h"

#include <math.h>
#include <stdio.h>

static const double ASKEW = 1e-3; /* of a step: about 0.06 degrees */

/* Finds the axis of the grid that runs along an axis of the world; false: none does. */
static bool find_grid_axis(const cw_volume *volume, int axis, int *along, double *step)
{
    double corner[3], largest = 0, others = 0;
    cw_volume_to_world(volume, (const double[3]){0}, corner);
    for (int a = 0; a < 3; a++) {
        double index[3] = {0}, world[3];
        index[a] = 1;
        cw_volume_to_world(volume, index, world);
        const double d = world[axis] - corner[axis];
        if (fabs(d) > fabs(largest)) {
            others = fmax(others, fabs(largest));
            largest = d;
            *along = a;
        } else {
            others = fmax(others, fabs(d));
        }
    }
    *step = fabs(largest);
    return others <= ASKEW * fabs(largest) && !volume->coordinates[0];
}

void cli_caption_slice(const cw_volume *volume, int axis, double mm, const char *between,
                       char *text, size_t size)
{
    static const char *const names[] = {"sagittal", "coronal", "axial"};
    double index[3] = {0}, step = 1;
    const double world[3] = {axis == 0 ? mm : 0, axis == 1 ? mm : 0, axis == 2 ? mm : 0};
    int along = 0, digits = 1;
    char number[48] = "";
    if (find_grid_axis(volume, axis, &along, &step) &&
        cw_volume_to_index(volume, world, index, NULL) == CW_OK) {
        const double last = (double)volume->dim[along] - 1;
        snprintf(number, sizeof number, " %.0f/%zu",
                 1 + fmin(fmax(round(index[along]), 0), last), volume->dim[along]);
    }
    for (double s = step; s < 0.2 && digits < 6; s *= 10)
        digits++;
    if (fabs(mm) < 0.5 * pow(10, -digits))
        mm = 0; /* not -0.0 */
    snprintf(text, size, "%s%s%s%c = %.*f mm", names[axis], number, between, 'x' + axis, digits,
             mm);
}
