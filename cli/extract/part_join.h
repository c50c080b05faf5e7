/* Joining the fragments of all parts to one file. */
#ifndef CLI_EXTRACT_PART_JOIN_H
#define CLI_EXTRACT_PART_JOIN_H

#include "cli/extract/part_manifest.h"

/* Writes the file of all parts of a folder, and prints its line.
 * desc   without provenance, which is the manifest's
 * start  time that the line counts from, by cli_seconds()
 * Returns CW_ERR_EMPTY when the parts have no surface; CW_ERR_IO for a part that is missing;
 *         CW_ERR_FORMAT for a damaged one or one of another job; as cw_parts_write() */
CW_NODISCARD cw_status cli_join_parts(const char *folder, const cli_manifest *manifest,
                                      const char *output, const cw_write_desc *desc,
                                      double start, cw_error *err);

#endif
