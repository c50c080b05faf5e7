/* ParaView's list of the files of a time series, beside them. */
#ifndef CLI_EXTRACT_PVD_LIST_H
#define CLI_EXTRACT_PVD_LIST_H

#include "cli/results/output_names.h"
#include "cli/results/run_report.h"

/* Fails when a list could not be written there, is an input or an output, or the outputs are
 * not what ParaView reads. */
CW_NODISCARD cw_status cli_check_pvd(const char *path, const cli_outputs *outputs,
                                     const char *const *inputs, size_t input_count,
                                     const cw_write_desc *desc, cw_error *err);

/* Lists what was written of a series, each at its time or, where the input names none, at the
 * number of its step. The report gets it as its next entry. Writes nothing when nothing was
 * written. */
CW_NODISCARD cw_status cli_write_pvd(cli_report *report, const char *path,
                                     const cw_write_desc *desc, cw_error *err);

#endif
