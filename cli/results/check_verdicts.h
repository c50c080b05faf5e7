/* Verdicts on a mesh as people and programs read them. */
#ifndef CLI_RESULTS_CHECK_VERDICTS_H
#define CLI_RESULTS_CHECK_VERDICTS_H

#include "cli/framework/json_writer.h"

#include <cubewright/check.h>

/* A verdict a line, what to do about it under it. */
void cli_print_verdicts(const cw_verdict *verdicts, size_t count);

/* Fails where verdicts do not hold, and names them. */
CW_NODISCARD cw_status cli_check_verdicts(const char *name, const char *profile,
                                          const cw_verdict *verdicts, size_t count,
                                          cw_error *err);

/* Angles, aspect ratios and lengths of edges, a bar a bin. */
void cli_print_shapes(const cw_shapes *shapes);

/* "verdicts", "quality" and "error": NULL findings are left out. */
void cli_json_verdicts(cli_json *j, const cw_verdict *verdicts, size_t count);
void cli_json_shapes(cli_json *j, const cw_shapes *shapes);
void cli_json_errors(cli_json *j, const cw_findings *findings);

#endif
