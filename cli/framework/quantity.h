/* Quantities as people type them, and numbers as people read them. */
#ifndef CLI_FRAMEWORK_QUANTITY_H
#define CLI_FRAMEWORK_QUANTITY_H

#include "cli/framework/options.h"

bool cli_parse_number(const char *text, cli_number *out);
bool cli_parse_numbers(const char *text, cli_numbers *out);

/* Isovalues: numbers, and names that wait for a volume. half:100:300 is the number between. */
bool cli_parse_level(const char *text, cli_number *out);
bool cli_parse_levels(const char *text, cli_numbers *out);

/* Returns a level as it is typed, in static memory as of cli_number_text(). */
const char *cli_level_text(cli_level level, double value);
bool cli_parse_lengths(const char *text, cli_lengths *out);

/* A length in one of some units, as CLI_IN_ bits. */
bool cli_parse_length(const char *text, unsigned units, cli_length *out);

bool cli_parse_amount(const char *text, cli_amount *out);

/* A length in mm or voxels, or a count above 0 with k, M or G. */
bool cli_parse_reduction(const char *text, cli_reduction *out);

/* In millimetres, shares of a diagonal and voxels resolved. */
double cli_length_mm(const cli_length *length, double diagonal_mm, double voxel_mm);

/* Fails for an error limit that leaves little of a shape: above 5 % of the diagonal of its box.
 * option  for the message;  why  what may be wrong, or NULL
 * Returns  CW_ERR_ARGUMENT, which names --force */
CW_NODISCARD cw_status cli_check_error_limit(const char *option, double error_mm,
                                             double diagonal_mm, const char *why,
                                             cw_error *err);

bool cli_parse_sizes(const char *text, cli_sizes *out);

bool cli_parse_ranges(const char *text, cli_ranges *out);

/* Ranges, or auto with a margin: auto:3. */
bool cli_parse_crop(const char *text, cli_ranges *out);

bool cli_parse_steps(const char *text, cli_steps *out);

/* A count with an optional k, M, G or T of the given thousand: 1000, or 1024 for bytes. */
bool cli_parse_count(const char *text, double thousand, size_t *out);

/* A number from 0, or mag. */
bool cli_parse_component(const char *text, cli_component *out);

/* A name, also with a component behind a colon; without one out->component stays as it is. */
bool cli_parse_array(const char *text, cli_array *out);

bool cli_parse_counts(const char *text, cli_counts *out);

/* Returns a length as it is typed, in static memory as of cli_number_text(). */
const char *cli_length_text(const cli_length *length);

/* "12.3 MB", "1 234 567", and a number as people would type it: the shortest text that reads
 * back the same, whole numbers without an exponent. In static memory; the last eight results
 * are kept. */
const char *cli_bytes(double bytes);
const char *cli_count(size_t count);
const char *cli_number_text(double value);

#endif
