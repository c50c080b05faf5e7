/* Delivers a mesh: checks it against the promise, writes it, and reports it in one line. */
#ifndef CLI_RESULTS_WRITE_RESULT_H
#define CLI_RESULTS_WRITE_RESULT_H

#include "cli/results/compress_options.h"
#include "cli/results/run_report.h"

typedef struct cli_delivery {
    const char *input;   /* named in errors */
    cw_write_desc write; /* but for the progress and compression */
    const cli_compress *compress;
    double voxel_mm;     /* for a tolerance in voxels */
    int threads;         /* to measure with; default: all */
    bool unchecked;      /* default: measured, and refused when not as promised */
    bool unpromised;     /* measured, and written whatever it is: the line says what */
    bool report_dropped; /* report the properties of the mesh that the file does not hold */
    bool open;           /* the surface may end at the volume's border */
    const char *parts;   /* what the parts are: "levels" of detail, "steps"; default: "parts" */
    const char *found;   /* what else is said in the line, from "; " on; default: nothing */
    bool preview;        /* not of all voxels: the line says so */
} cli_delivery;

/* Delivers the report's latest mesh, of one or several parts, to its path. The report gets the
 * steps and what was found.
 *
 * border_loops  that were capped
 * start         when work on it began: for the line
 * Returns  CW_ERR_CHECK  it is not closed (unless open) or no manifold, or compression cannot
 *                        keep what was asked for, and nothing is written; or it could not with
 *                        the bits stated, and the file is as these make it
 *          or as cw_quality_measure(), cw_parts_write() */
CW_NODISCARD cw_status cli_deliver(cli_report *report, const cli_delivery *how,
                                   const cw_part *parts, size_t part_count, size_t border_loops,
                                   double start, cw_error *err);

/* Holds a surface to the promise: closed unless it may be open, and a manifold without zero-area
 * triangles in any case. what: names it, such as "at 300".
 * Returns CW_ERR_CHECK with what was found. */
CW_NODISCARD cw_status cli_hold_to_promise(const char *input, const char *what,
                                           const cw_quality *quality, bool open, cw_error *err);

/* Adds what was measured of a part to the sum of others, with which it shares no vertices: what
 * is counted adds up. */
void cli_add_quality(cw_quality *sum, const cw_quality *q);

/* Checks the report's latest mesh, a step of an animation that has no file of its own, and
 * tells of it in a line: the first half of cli_deliver(). */
CW_NODISCARD cw_status cli_deliver_step(cli_report *report, const cli_delivery *how,
                                        const cw_mesh *mesh, size_t border_loops, double start,
                                        cw_error *err);

#endif
