/* Preparation of the voxels of a volume before its surface is made: other distances between them,
 * less noise. In this order, whatever the order of the options. */
#ifndef CLI_INPUTS_VOLUME_PREPARE_H
#define CLI_INPUTS_VOLUME_PREPARE_H

#include "cli/inputs/volume_input.h"

#include <cubewright/filter.h>

/* Returns the option that changes voxels, such as "--denoise"; NULL: none was given. */
const char *cli_find_preparation(const cli_input *input);

/* The same without those that are made slice by slice, too: a Gaussian, a median. */
const char *cli_find_unstreamed_preparation(const cli_input *input);

/* Adds to an error of too little memory that an option needs all voxels there, and the way on.
 * option  such as "--denoise"; NULL: the command itself does */
cw_status cli_fail_whole(cw_status st, const char *option, cw_error *err);

/* Returns the type that --denoise gives to the values of a volume. */
cw_type cli_denoised_type(const cli_input *input, const cw_volume *volume);

/* Says what is made slice by slice, of a volume that streams. */
void cli_print_slice_filter(const cli_input *input, cli_volume *volume);

/* Returns the least bytes that --denoise takes slice by slice; 0: none was given.
 * source  the slices before the filter */
size_t cli_slice_filter_bytes(const cli_input *input, const cw_volume *source);

/* Visits filtered slices, if a filter was given.
 * visit  hands a visitor the slices of the volume */
typedef cw_status cli_visit_all(const void *user, const cw_slice_visitor *visitor,
                                cw_error *err);
CW_NODISCARD cw_status cli_visit_filtered(const cli_input *input,
                                          const cw_slice_visitor *visitor, cli_visit_all *visit,
                                          const void *user, cw_error *err);

/* Finds the distances of voxels before and after --resample. */
void cli_resample_spacing(const cli_resample *resample, const cw_volume *volume, double old[3],
                          double mm[3]);

/* Describes a filter of the view: threads, memory and progress. */
cw_filter_desc cli_describe_filter(const cli_input *input, const cli_volume *volume);

/* Sets the width of a filter along each axis in voxels. */
void cli_width_in_voxels(const cli_length *width, const cw_volume *volume, double sigma[3]);

/* Keeps how long a change to the view took, for the report. start: cli_seconds() before */
void cli_note_change(cli_volume *volume, const char *name, double start);

/* Makes a filtered volume the view, and frees the one before. */
void cli_take_filtered(cli_volume *volume, cw_volume *made);

/* Prepares the view of a volume that was read, and says what it did. A view that was made before
 * is freed. Errors do not name the file. */
CW_NODISCARD cw_status cli_prepare_volume(const cli_input *input, cli_volume *volume,
                                          cw_error *err);

/* Changes what is inside, as --mask, --mask-open and --mask-close say, and crops the view as --crop auto
 * does: after cli_prepare_volume(), once the isovalues are known.
 * levels   isovalues, at least one
 * Returns  CW_ERR_ARGUMENT for several isovalues where one is expected; as the filters. Errors name
 *          the file */
CW_NODISCARD cw_status cli_prepare_inside(const cli_input *input, cli_volume *volume,
                                          const double *levels, size_t count,
                                          bool inside_is_low, cw_error *err);

/* Fails for options that change what is inside in a command that makes no surface, and for kernels of labels
 * where values are sampled. */
CW_NODISCARD cw_status cli_check_preparation(const cli_input *input, cw_error *err);

/* Writes the options as text, such as "median:1", into reports: those that were given. */
void cli_json_preparation(cli_json *j, const cli_input *input);

#endif
