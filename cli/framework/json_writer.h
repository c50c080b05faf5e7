/* Writing JSON: one object, keys in the order of the calls. */
#ifndef CLI_FRAMEWORK_JSON_WRITER_H
#define CLI_FRAMEWORK_JSON_WRITER_H

#include <cubewright/label_table.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

typedef struct cli_json {
    FILE *out;
    int depth;
    bool first; /* nothing written yet at this depth */
} cli_json;

/* A key of NULL is for elements of a list. Text is escaped; bytes that are not UTF-8 become
 * U+FFFD. Numbers are the shortest that read back the same; NaN and infinities become null. */
void cli_json_open(cli_json *j, const char *key, char bracket); /* '{' or '[' */
void cli_json_close(cli_json *j, char bracket);                 /* '}' or ']' */
void cli_json_text(cli_json *j, const char *key, const char *value);
void cli_json_message(cli_json *j, const char *key, const char *message); /* of the library */
void cli_json_number(cli_json *j, const char *key, double value);
void cli_json_count(cli_json *j, const char *key, size_t value);
void cli_json_label(cli_json *j, const char *key, const cw_label *label); /* its number */
void cli_json_int(cli_json *j, const char *key, int64_t value);
void cli_json_bool(cli_json *j, const char *key, bool value);
void cli_json_numbers(cli_json *j, const char *key, const double *values, size_t count);

#endif
