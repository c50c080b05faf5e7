/* Numbers and text in memory, with a decimal point in any locale. */
#ifndef CORE_BASE_TEXT_H
#define CORE_BASE_TEXT_H

#include <cubewright/core.h>

#include <stdio.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Reads one number at *text and moves *text behind it; leading blanks are skipped. Returns
 * false, and leaves *text unmoved, when there is none. The first function accepts the same text
 * as strtod, including "nan" and "inf". The integer form takes decimal digits with an optional
 * sign and refuses numbers that do not fit. */
bool cwi_parse_double(const char **text, double *value);
bool cwi_parse_int(const char **text, int64_t *value);

/* Copies the next item of a list on a command line. Items are separated by commas, as in
 * "0.5mm,0.5mm,1mm", or by 'x', as in "512x512x300". *text moves behind the item and its
 * separator. *separator is 0 before the first item, and then the separator. It is 0 again at
 * the end of the list, at a ';' or the text's end. Returns false for an item of CWI_ITEM_BYTES
 * or more, and for a list with both separators. */
enum { CWI_ITEM_BYTES = 64 };
bool cwi_next_item(const char **text, char *separator, char item[CWI_ITEM_BYTES]);

/* Reads a length such as 0.5mm or 12um, in millimetres, and moves *text behind it; *unit: whether it
 * has one of mm, um, nm, cm, m, in and ft. Without one the number stands as it is. Returns false, as
 * cwi_parse_double() does, when there is no number, or one that is not finite. */
bool cwi_parse_length(const char **text, double *mm, bool *unit);

/* Reads a text of three lengths by comma or x, each above 0, or of one that stands for all. A unit counts for
 * those before it that have none: 1x1x2mm. Returns false for other texts, and without a unit at the end. */
bool cwi_parse_lengths(const char *text, double mm[3]);

/* Makes printf and friends of this thread write points; pass the first result to the second
 * call. */
void *cwi_locale_c(void);
void cwi_locale_restore(void *before);

/* Opens a stream into growing memory, for printing text; returns NULL without memory. *text and
 * *size are valid once it is closed; free the text with free(). */
FILE *cwi_text_open(char **text, size_t *size);

/* Closes the stream, which may be NULL. Returns false, with *text NULL, when memory ran out: a
 * stream into memory may lose text, or all of it, and still be closed without an error. */
bool cwi_text_close(FILE *stream, char **text);

enum { CWI_MEMORY_TEXT = 24 };

/* Prints a number of bytes in the unit that --memory takes: "1.5 GiB". */
void cwi_print_memory(uint64_t bytes, char text[CWI_MEMORY_TEXT]);

/* Returns the number of bytes of the UTF-8 character at text. Returns 0 for invalid text: stray
 * bytes, overlong forms, surrogates, codes beyond the last. The terminating zero is a character
 * of one byte. */
size_t cwi_utf8_length(const char *text);

#ifdef __cplusplus
}
#endif

#endif
