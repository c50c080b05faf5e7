/* Standard input and output in the place of files: the name `-`. */
#ifndef CLI_FRAMEWORK_STANDARD_STREAMS_H
#define CLI_FRAMEWORK_STANDARD_STREAMS_H

#include "cli/framework/options.h"

#include <cubewright/stored_file.h>

/* Returns true for the name "-"; a file of that name is "./-". */
bool cli_is_standard(const char *path);

/* Checks each `-` among the inputs and the given options, and keeps the bytes of standard input: as they
 * are where it is a file, else in a temporary file in TMPDIR.
 * Returns CW_ERR_ARGUMENT  several of one stream, no --format, a terminal; CW_ERR_IO, CW_ERR_OUTPUT,
 *                          CW_ERR_CANCELLED */
CW_NODISCARD cw_status cli_streams_open(const cli_command *command, const cli_common *args,
                                        const cli_given_option *options, cw_error *err);
void cli_streams_close(void);

/* Returns the bytes of standard input for "-", else NULL: for cw_read_desc.stored. */
const cw_stored_file *cli_stored_input(const char *path);

/* Returns a path by which other libraries open the bytes: the path itself or, for "-", that of the kept
 * file. Valid until the next call. */
const char *cli_bytes_path(const char *path);

/* Returns the sink of standard output for "-", else NULL: for cw_write_desc.sink. */
const cw_byte_sink *cli_output_sink(const char *path);

/* Set *bytes to the size of a file, or to what went through the stream. Return false, and 0, if there is
 * none, or it is a folder. */
bool cli_find_input_size(const char *path, double *bytes);
bool cli_find_output_size(const char *path, double *bytes);

/* Writes all bytes to standard output. Returns CW_ERR_OUTPUT */
CW_NODISCARD cw_status cli_write_standard(const void *bytes, size_t size, cw_error *err);

/* Fails with what errno says of standard output. A closed pipe is remembered. */
cw_status cli_fail_standard(cw_error *err);

/* Returns true if the reader of standard output has closed it: nobody wants to hear of that. */
bool cli_pipe_is_closed(void);

/* Returns the path beside which temporary files of an output stand: itself, or one in TMPDIR for
 * "-". */
const char *cli_temporary_beside(const char *output);

#endif
