/* Numbers in text, always with a point for the decimals, whatever the program's locale. */
#ifndef CORE_TEXT_H
#define CORE_TEXT_H

#include <cubewright/core.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Reads one number at *text and moves *text behind it; leading blanks are skipped. False, and
 * *text unmoved, when there is none. Accepts what strtod does, "nan" and "inf" too; the integer
 * form takes decimal digits with an optional sign and refuses what does not fit. */
CW_API bool cwi_parse_double(const char **text, double *value);
CW_API bool cwi_parse_int(const char **text, int64_t *value);

/* The next item of a list on a command line, parted by commas, as in "0.5mm,0.5mm,1mm", or by
 * 'x', as in "512x512x300": copied, and *text moves behind it and what parts it from the next.
 * *separator is 0 in front of the first item and then what parts them; it is 0 again where the
 * list is over, at a ';' or the text's end. False for an item of CWI_ITEM_BYTES or more, and
 * for a list that is parted by both. */
enum { CWI_ITEM_BYTES = 64 };
CW_API bool cwi_next_item(const char **text, char *separator, char item[CWI_ITEM_BYTES]);

/* Makes printf and friends of this thread write points; hand the result to the second call. */
CW_API void *cwi_locale_c(void);
CW_API void cwi_locale_restore(void *before);

/* Bytes of the UTF-8 character at text; 0 when there is none such: stray bytes, overlong forms,
 * surrogates, codes past the last. The terminating zero counts as a character of one byte. */
CW_API size_t cwi_utf8_length(const char *text);

#ifdef __cplusplus
}
#endif

#endif
