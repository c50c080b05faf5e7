/* Numbers in text, always with a point for the decimals, whatever the program's locale. */
#ifndef CORE_BASE_TEXT_H
#define CORE_BASE_TEXT_H

#include <cubewright/core.h>

#include <stdio.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Reads one number at *text and moves *text behind it; leading blanks are skipped. False, and
 * *text unmoved, when there is none. Accepts what strtod does, "nan" and "inf" too; the integer
 * form takes decimal digits with an optional sign and refuses what does not fit. */
bool cwi_parse_double(const char **text, double *value);
bool cwi_parse_int(const char **text, int64_t *value);

/* The next item of a list on a command line, parted by commas, as in "0.5mm,0.5mm,1mm", or by
 * 'x', as in "512x512x300": copied, and *text moves behind it and what parts it from the next.
 * *separator is 0 in front of the first item and then what parts them; it is 0 again where the
 * list is over, at a ';' or the text's end. False for an item of CWI_ITEM_BYTES or more, and
 * for a list that is parted by both. */
enum { CWI_ITEM_BYTES = 64 };
bool cwi_next_item(const char **text, char *separator, char item[CWI_ITEM_BYTES]);

/* Makes printf and friends of this thread write points; hand the result to the second call. */
void *cwi_locale_c(void);
void cwi_locale_restore(void *before);

/* Opens a stream into memory that grows, for text to print; NULL without memory. *text and
 * *size are good once it is closed; free the text with free(). */
FILE *cwi_text_open(char **text, size_t *size);

/* Closes the stream, NULL too. False, and *text is NULL, when memory ran out on the way: a
 * stream into memory may lose text, or all of it, and still be closed without an error. */
bool cwi_text_close(FILE *stream, char **text);

enum { CWI_MEMORY_TEXT = 24 };

/* Bytes of memory in the unit that --memory takes: "1.5 GiB". */
void cwi_print_memory(uint64_t bytes, char text[CWI_MEMORY_TEXT]);

/* Bytes of the UTF-8 character at text; 0 when there is none such: stray bytes, overlong forms,
 * surrogates, codes past the last. The terminating zero counts as a character of one byte. */
size_t cwi_utf8_length(const char *text);

#ifdef __cplusplus
}
#endif

#endif
