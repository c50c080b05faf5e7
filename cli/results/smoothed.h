/* Describes what smoothing did: for people, and for the report. */
#ifndef CLI_RESULTS_SMOOTHED_H
#define CLI_RESULTS_SMOOTHED_H

#include "cli/framework/json_writer.h"

#include <cubewright/smooth.h>

enum { CLI_SMOOTHED_TEXT = 256 };

/* Writes the object "smooth". */
void cli_json_smoothed(cli_json *j, const cw_smooth_facts *facts);

/* Prints moves, and what they did to volume and triangles. An open surface encloses no volume. */
void cli_smoothed_text(const cw_smooth_facts *facts, char text[CLI_SMOOTHED_TEXT]);

#endif
