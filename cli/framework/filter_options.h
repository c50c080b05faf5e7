/* How volumes are filtered and surfaces smoothed, as people type it. */
#ifndef CLI_FRAMEWORK_FILTER_OPTIONS_H
#define CLI_FRAMEWORK_FILTER_OPTIONS_H

#include "cli/framework/options.h"

bool cli_parse_resample(const char *text, cli_resample *out);
bool cli_parse_denoise(const char *text, cli_denoise *out);

/* The name of a method; then a colon and iterations, or the width of fair. */
bool cli_parse_smoothing(const char *text, cli_smoothing *out);

/* An axis with a place along it, z=5mm or z=10%, with a minus to keep what is below; or a point and a
 * normal, 0,0,5:0,0.1,1. */
bool cli_parse_plane(const char *text, cli_plane *out);

/* Return these as they are typed, in static memory. */
const char *cli_resample_text(const cli_resample *resample);
const char *cli_denoise_text(const cli_denoise *denoise);
const char *cli_smoothing_text(const cli_smoothing *smoothing);
const char *cli_plane_text(const cli_plane *plane);

#endif
