/* Names the options of the command line in messages of the library, which name fields in C. */
#ifndef CLI_FRAMEWORK_FIELD_NAMES_H
#define CLI_FRAMEWORK_FIELD_NAMES_H

#include <stddef.h>

enum { CLI_MESSAGE = 768 };

/* Copies a message to `to` (of CLI_MESSAGE bytes), and returns it: "desc->series" becomes "--series". */
const char *cli_name_options(const char *message, char to[CLI_MESSAGE]);

#endif
