/* Names of slices. */
#ifndef CLI_RENDER_SLICE_CAPTION_H
#define CLI_RENDER_SLICE_CAPTION_H

#include <cubewright/volume.h>

/* Writes the name, number and position of a slice across an axis of the world, with a text between
 * them: "axial 34/120, z = 12.5 mm". On a grid that lies askew slices have no numbers. */
void cli_caption_slice(const cw_volume *volume, int axis, double mm, const char *between,
                       char *text, size_t size);

#endif
