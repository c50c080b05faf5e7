/* Options of a printer, and the report of what it makes hard: of check and extract. */
#ifndef CLI_RESULTS_PRINTABILITY_H
#define CLI_RESULTS_PRINTABILITY_H

#include "cli/framework/json_writer.h"
#include "cli/framework/options.h"

#include <cubewright/check.h>

typedef struct cli_printer {
    cli_length wall, gap, layer;
    cli_number overhang;
    cli_lengths plate;
} cli_printer;

/* Their rows; `type` has a cli_printer as `printer`. */
#define CLI_PRINTER_OPTIONS(type)                                                              \
    CLI_HEADED("Printing, with --profile print"),                                              \
        {"wall",                                                                               \
         0,                                                                                    \
         CLI_PRINT_LENGTH,                                                                     \
         "L",                                                                                  \
         "Walls below this are thin (0.8mm)",                                                  \
         offsetof(type, printer.wall)},                                                        \
        {"gap",                                                                                \
         0,                                                                                    \
         CLI_PRINT_LENGTH,                                                                     \
         "L",                                                                                  \
         "Gaps below this are narrow (0.4mm)",                                                 \
         offsetof(type, printer.gap)},                                                         \
        {"overhang",                                                                           \
         0,                                                                                    \
         CLI_NUMBER,                                                                           \
         "DEG",                                                                                \
         "Surfaces that lean more from the vertical need support (45)",                        \
         offsetof(type, printer.overhang)},                                                    \
        {"layer",                                                                              \
         0,                                                                                    \
         CLI_PRINT_LENGTH,                                                                     \
         "L",                                                                                  \
         "Height of a layer (0.2mm)",                                                          \
         offsetof(type, printer.layer)},                                                       \
    {                                                                                          \
        "plate", 0, CLI_LENGTHS, "WxDxH",                                                      \
            "Size that can be printed, such as 220x220x250mm (not looked at)",                 \
            offsetof(type, printer.plate)                                                      \
    }

#define CLI_PRINTER_RULES                                                                      \
    {                                                                                          \
        "wall gap overhang layer plate", CLI_NEEDS, "profile=print"                            \
    }

/* The judgement of a print. Zeroed: none yet. */
typedef struct cli_printed {
    cw_print_facts facts;
    cw_verdict verdicts[CW_MAX_VERDICTS];
    size_t count;
} cli_printed;

/* Fails for values out of range. */
CW_NODISCARD cw_status cli_check_printer(const cli_printer *printer, cw_error *err);

/* Returns the limits. */
cw_print_desc cli_printer_desc(const cli_printer *printer, int threads, size_t triangles);

/* Measures a mesh as a print, and what it is besides. Open ones have verdicts alone.
 * Returns  as the measurements */
CW_NODISCARD cw_status cli_measure_printed(const cw_mesh *mesh, const cli_printer *printer,
                                           int threads, cli_printed *out, cw_error *err);

/* Judges a mesh that is to be printed: prints what is to be looked at, and keeps all of it for the
 * report.
 * Returns  CW_ERR_CHECK  the profile does not hold; or as the measurements */
CW_NODISCARD cw_status cli_judge_print(const char *name, const cw_mesh *mesh,
                                       const cli_printer *printer, int threads,
                                       cli_printed *out, cw_error *err);

/* Writes the limits into the settings of a step, and the object "print". */
void cli_json_printer(cli_json *j, const cw_print_desc *limits);
void cli_json_print(cli_json *j, const cw_print_facts *facts);

#endif
