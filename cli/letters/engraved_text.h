/* Text for solids: templates as they are typed, filled in, and the facts for the line and the report. */
#ifndef CLI_LETTERS_ENGRAVED_TEXT_H
#define CLI_LETTERS_ENGRAVED_TEXT_H

#include "cli/framework/json_writer.h"

#include <cubewright/engrave.h>
#include <cubewright/label_table.h>

/* Fills {stem}, {parent}, {name} and {label} of a text. Free it with free().
 * input  path of the file
 * name   of the part; NULL: the stem stands for it
 * label  of the part; NULL: there is none
 * Returns  CW_ERR_ARGUMENT for {label} without one, and as cli_fill_template() */
CW_NODISCARD cw_status cli_fill_engraved_text(const char *text, const char *input,
                                              const char *name, const cw_label *label,
                                              char **out, cw_error *err);

/* Tells how large the text is and where, how far that is from flat, and strokes that are finer than printers make
 * them.
 * path  of the file, or the name of a part */
void cli_tell_engraved(const char *path, const cw_engrave_facts *facts);

/* Writes the members of an object with the facts. */
void cli_json_engraved(cli_json *j, const cw_engrave_facts *facts);

#endif
