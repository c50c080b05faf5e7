/* Text headers: lines of fields, and the numbers and words in them. */
#ifndef FORMATS_TEXT_TEXT_HEADER_H
#define FORMATS_TEXT_TEXT_HEADER_H

#include "formats/bytes/input_file.h"

enum { CWI_WORD_BYTES = 64 };

/* The lines at the start of a file. A zeroed one is closed. */
typedef struct cwi_lines {
    char *text;
    size_t size;   /* bytes in memory: the file's first MiB at most */
    size_t next;   /* start of the next line, in the file too */
    size_t number; /* of the line returned last, from 1 */
    char end;      /* the character that ends a line */
    bool cut;      /* the file continues behind these bytes */
} cwi_lines;

CW_NODISCARD cw_status cwi_lines_open(cwi_lines *lines, const cwi_input *in, cw_error *err);

/* Returns the next line without its end and trailing blanks; NULL behind the last. It stays
 * valid, and may be written to, until the lines are closed.
 * Returns CW_ERR_FORMAT for a line over 64 KiB, a header over 1 MiB, a zero byte. */
CW_NODISCARD cw_status cwi_lines_next(cwi_lines *lines, char **line, cw_error *err);
void cwi_lines_close(cwi_lines *lines);

/* Adds the remaining lines as names, without empty ones. */
CW_NODISCARD cw_status cwi_lines_names(cwi_lines *lines, cwi_names *names, cw_error *err);

/* Returns the index of a key among rows of "name|other name" in lower case without blanks; the
 * key may have capitals and blanks. -1 when there is none. */
int cwi_field_find(const char *const *rows, int count, const char *key, size_t length);

/* Reads the next blank-separated word, or the text between double quotes, and moves *text
 * behind it. Returns false at the end; words too long are cut. */
bool cwi_next_text_word(const char **text, char word[CWI_WORD_BYTES]);

/* Reads exactly `expected` numbers, the count that the field `by` states. The message names both
 * fields. Sizes are whole numbers from 1 to 2^31 - 1. */
CW_NODISCARD cw_status cwi_field_doubles(const char *field, const char *text, size_t expected,
                                         const char *by, double *out, cw_error *err);
CW_NODISCARD cw_status cwi_field_sizes(const char *field, const char *text, size_t expected,
                                       const char *by, size_t *out, cw_error *err);

/* Reads one whole number from low to high. */
CW_NODISCARD cw_status cwi_field_integer(const char *field, const char *text, int64_t low,
                                         int64_t high, int64_t *out, cw_error *err);

#endif
