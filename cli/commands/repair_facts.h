/* The facts of a repair in words and in the report. */
#ifndef CLI_COMMANDS_REPAIR_FACTS_H
#define CLI_COMMANDS_REPAIR_FACTS_H

#include "cli/framework/json_writer.h"

#include <cubewright/repair.h>

/* Adds the facts of a part to those of others. The first one is added to a zeroed sum. */
void cli_add_repair(cw_repair_facts *sum, const cw_repair_facts *facts, bool is_first);

/* Prints a line for each kind of defect that was found, and what is done about it. The lines go to
 * stdout for a report only, else to stderr.
 * max_hole_mm  0: all holes are filled */
void cli_print_repair(const char *path, const cw_repair_facts *facts, double max_hole_mm,
                      bool is_report);

/* Writes what is left of defects in words; the text is empty if nothing is. */
void cli_name_left_defects(const cw_repair_facts *facts, char *text, size_t size);

/* Writes the facts as members of an object. */
void cli_json_repair(cli_json *j, const cw_repair_facts *facts);

#endif
