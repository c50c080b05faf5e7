/* Writes JSON objects: keys, indentation, escaped strings and numbers. */
#include "cli/framework/json_writer.h"

#include "cli/framework/field_names.h"

#include "core/base/text.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static void print_text(FILE *out, const char *text)
{
    fputc('"', out);
    for (const char *s = text; *s;) {
        const size_t n = cwi_utf8_length(s);
        const unsigned char byte = (unsigned char)*s;
        if (n == 0)
            fputs("\\ufffd", out);
        else if (byte == '"' || byte == '\\')
            fprintf(out, "\\%c", byte);
        else if (byte < 0x20 || byte == 0x7f)
            fprintf(out, "\\u%04x", byte);
        else
            fwrite(s, 1, n, out);
        s += n ? n : 1;
    }
    fputc('"', out);
}

static void begin_value(cli_json *j, const char *key)
{
    if (!j->first)
        fputc(',', j->out);
    if (j->depth > 0)
        fprintf(j->out, "\n%*s", 2 * j->depth, "");
    j->first = false;
    if (key) {
        print_text(j->out, key);
        fputs(": ", j->out);
    }
}

void cli_json_open(cli_json *j, const char *key, char bracket)
{
    if (j->depth == 0)
        j->first = true;
    begin_value(j, key);
    fputc(bracket, j->out);
    j->depth++;
    j->first = true;
}

void cli_json_close(cli_json *j, char bracket)
{
    j->depth--;
    if (!j->first)
        fprintf(j->out, "\n%*s", 2 * j->depth, "");
    fputc(bracket, j->out);
    if (j->depth == 0)
        fputc('\n', j->out);
    j->first = false;
}

void cli_json_text(cli_json *j, const char *key, const char *value)
{
    begin_value(j, key);
    print_text(j->out, value);
}

void cli_json_message(cli_json *j, const char *key, const char *message)
{
    char text[CLI_MESSAGE];
    cli_json_text(j, key, cli_name_options(message, text));
}

static void print_number(FILE *out, double value)
{
    char text[40];
    if (!isfinite(value)) {
        fputs("null", out);
        return;
    }
    for (int digits = 6; digits <= 17; digits++) {
        snprintf(text, sizeof text, "%.*g", digits, value);
        if (strtod(text, NULL) == value)
            break;
    }
    fputs(text, out);
}

void cli_json_number(cli_json *j, const char *key, double value)
{
    begin_value(j, key);
    print_number(j->out, value);
}

void cli_json_count(cli_json *j, const char *key, size_t value)
{
    begin_value(j, key);
    fprintf(j->out, "%zu", value);
}

void cli_json_label(cli_json *j, const char *key, const cw_label *label)
{
    char number[CW_LABEL_NUMBER];
    begin_value(j, key);
    fputs(cw_label_number(label, number), j->out);
}

void cli_json_int(cli_json *j, const char *key, int64_t value)
{
    begin_value(j, key);
    fprintf(j->out, "%" PRId64, value);
}

void cli_json_bool(cli_json *j, const char *key, bool value)
{
    begin_value(j, key);
    fputs(value ? "true" : "false", j->out);
}

void cli_json_numbers(cli_json *j, const char *key, const double *values, size_t count)
{
    begin_value(j, key);
    fputc('[', j->out);
    for (size_t i = 0; i < count; i++) {
        fputs(i ? ", " : "", j->out);
        print_number(j->out, values[i]);
    }
    fputc(']', j->out);
}
