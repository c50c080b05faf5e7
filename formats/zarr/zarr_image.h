/* Images of OME-Zarr: their axes, their levels, and the frame of each level. */
#ifndef FORMATS_ZARR_ZARR_IMAGE_H
#define FORMATS_ZARR_ZARR_IMAGE_H

#include "formats/volume/voxel_source.h"
#include "formats/zarr/zarr_node.h"

enum { CWI_ZARR_LEVELS = 64 };

/* An axis. */
typedef struct cwi_zarr_axis {
    char name[CWI_ZARR_NAME_BYTES];
    cwi_role role; /* CWI_ROLE_COUNT: none of a volume's; its size must be 1 */
    bool has_unit;
    double unit; /* millimetres, or seconds */
} cwi_zarr_axis;

/* The axes of an image, and its frame: a matrix from indices to places, in the axes' units. */
typedef struct cwi_zarr_frame {
    size_t rank;
    cwi_zarr_axis axes[CWI_ZARR_RANK];
    double matrix[CWI_ZARR_RANK][CWI_ZARR_RANK + 1];
} cwi_zarr_frame;

/* Returns the number of levels of an image, 0 where a node is no image. */
size_t cwi_zarr_level_count(const cwi_zarr_node *node);

/* Finds the array of a level: its path below the store.
 * Returns CW_ERR_FORMAT, naming file and key; CW_ERR_LIMIT */
CW_NODISCARD cw_status cwi_zarr_level_path(const cwi_zarr_node *node, size_t level,
                                           char path[CWI_ZARR_KEY_BYTES], cw_error *err);

/* Reads the axes of an image and the frame of a level, whose array is known. */
CW_NODISCARD cw_status cwi_zarr_level_frame(const cwi_zarr_node *node, size_t level,
                                            const cwi_zarr_node *level_node,
                                            const cwi_zarr_array *array, cwi_zarr_frame *frame,
                                            cw_error *err);

/* Makes a frame of units whose axes have no names or roles. */
void cwi_zarr_start_frame(const cwi_zarr_array *array, cwi_zarr_frame *frame);

/* Sets the unit of an axis, whose role is set, from its name, such as "nm"; names that are not known
 * leave the axis without one. */
void cwi_zarr_read_unit(const char *text, cwi_zarr_axis *axis);

/* Checks that no role occurs twice, and that all other axes have one entry. CW_ERR_FORMAT */
CW_NODISCARD cw_status cwi_zarr_check_roles(const cwi_zarr_frame *frame,
                                            const cwi_zarr_array *array, cw_error *err);

/* Makes the frame of an array by itself, from the names of its dimensions. Without names the
 * last three are z, y, x, and those before them components and steps. */
void cwi_zarr_plain_frame(const cwi_zarr_array *array, cwi_zarr_frame *frame);

/* Gives the axes roles by their names and types; returns false where they do not suffice. */
bool cwi_zarr_name_role(const char *name, cwi_role *role);

/* Applies a list of coordinateTransformations to a frame. CW_ERR_FORMAT */
CW_NODISCARD cw_status cwi_zarr_transform(const json_t *object, cwi_zarr_frame *frame,
                                          cw_error *err);

#endif
