/* Options of a printer, and the report of what it makes hard: of check and extract. */
#ifndef CLI_RESULTS_PRINTABILITY_H
#define CLI_RESULTS_PRINTABILITY_H

#include "cli/framework/json_writer.h"
#include "cli/framework/options.h"

#include <cubewright/print.h>

typedef struct cli_printer {
    cli_length wall, gap, layer;
    cli_number overhang;
    cli_lengths plate;
} cli_printer;

/* Their rows; `type` has a cli_printer as `printer`. */
#define CLI_PRINTER_OPTIONS(type)                                                              \
    CLI_HEADED("Printing, with --profile print"), {"wall",                                     \
                                                   0,                                          \
                                                   CLI_LENGTH,                                 \
                                                   "L",                                        \
                                                   "Walls below this are thin (0.8mm)",        \
                                                   offsetof(type, printer.wall)},              \
        {"gap",                                                                                \
         0,                                                                                    \
         CLI_LENGTH,                                                                           \
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
         CLI_LENGTH,                                                                           \
         "L",                                                                                  \
         "Height of a layer (0.2mm)",                                                          \
         offsetof(type, printer.layer)},                                                       \
    {                                                                                          \
        "plate", 0, CLI_LENGTHS, "WxDxH",                                                      \
            "Size that can be printed, such as 220x220x250mm (not looked at)",                 \
            offsetof(type, printer.plate)                                                      \
    }

/* Fails for options without --profile print, and for lengths in voxels or shares. */
CW_NODISCARD cw_status cli_check_printer(const cli_printer *printer, bool prints,
                                         cw_error *err);

/* Returns the limits. */
cw_print_desc cli_printer_desc(const cli_printer *printer, int threads, size_t triangles);

/* Writes the limits into the settings of a step, and the object "print". */
void cli_json_printer(cli_json *j, const cw_print_desc *limits);
void cli_json_print(cli_json *j, const cw_print_facts *facts);

#endif
