/* The bytes of a mesh file from one end to the other: words and numbers of text, or records. */
#ifndef FORMATS_TEXT_TEXT_SCANNER_H
#define FORMATS_TEXT_TEXT_SCANNER_H

#include "formats/bytes/input_file.h"

/* Words are shorter than this, and records taken at once not longer. */
enum { CWI_SCAN_AHEAD = 256, CWI_REST_BYTES = 512 };

/* A zeroed scan is closed. */
typedef struct cwi_scan {
    const cwi_input *in;         /* borrowed */
    const cw_progress *progress; /* borrowed; told and asked every 256 KiB */
    uint64_t offset;             /* in the file, of the byte behind those held */
    char *text;                  /* held: from next to end, where a zero follows */
    size_t next, end;
    size_t line;   /* of text, from 1 */
    bool by_line;  /* words end with their line, unless a backslash ends it; else lines are
                      blanks */
    bool cr_lines; /* lines end with carriage returns alone, as on an old Macintosh: they are
                      turned into line feeds */
    bool comments; /* a word that starts with '#' and what follows on its line is blank */
} cwi_scan;

/* Starts at an offset. by_line and comments may be set at any time.
 * Returns CW_ERR_NO_MEMORY. */
CW_NODISCARD cw_status cwi_scan_open(cwi_scan *s, const cwi_input *in, uint64_t offset,
                                     const cw_progress *progress, cw_error *err);

/* The same for text, of which the first line's end tells how lines end. */
CW_NODISCARD cw_status cwi_scan_open_text(cwi_scan *s, const cwi_input *in, uint64_t offset,
                                          const cw_progress *progress, cw_error *err);
void cwi_scan_close(cwi_scan *s);

/* Bytes of the file behind the place of reading. */
uint64_t cwi_scan_left(const cwi_scan *s);

/* Exactly size bytes, at most CWI_SCAN_AHEAD; valid until the next call. what names them.
 * Returns CW_ERR_FORMAT where the file ends first. */
CW_NODISCARD cw_status cwi_scan_take(cwi_scan *s, size_t size, const char *what,
                                     const unsigned char **bytes, cw_error *err);

/* A word in place: blank, line end or zero behind it. Valid until the next call. */
typedef struct cwi_word {
    const char *text;
    size_t size; /* 0: the line or the file ends here */
} cwi_word;

CW_NODISCARD cw_status cwi_scan_word(cwi_scan *s, cwi_word *word, cw_error *err);
bool cwi_word_is(const cwi_word *word, const char *text);

/* Whether the whole word is a number, and which. */
bool cwi_word_double(const cwi_word *word, double *value);
bool cwi_word_integer(const cwi_word *word, int64_t *value);

/* The rest of the line, without blanks around it and as far as it fits, and a zero. */
CW_NODISCARD cw_status cwi_scan_rest(cwi_scan *s, char text[CWI_REST_BYTES], cw_error *err);

/* Leaves out the rest of the line. */
CW_NODISCARD cw_status cwi_scan_end_line(cwi_scan *s, cw_error *err);

/* Goes on to the next line with a word in it; false at the end of the file. */
CW_NODISCARD cw_status cwi_scan_next_line(cwi_scan *s, bool *found, cw_error *err);

/* The next word as a number; what names it in the message. */
CW_NODISCARD cw_status cwi_scan_double(cwi_scan *s, const char *what, double *value,
                                       cw_error *err);
CW_NODISCARD cw_status cwi_scan_integer(cwi_scan *s, const char *what, int64_t *value,
                                        cw_error *err);

/* "line 5: x is 'abc', a number was expected", or that the line or file ends instead. */
CW_NODISCARD cw_status cwi_scan_fail(const cwi_scan *s, const cwi_word *word, const char *what,
                                     const char *expected, cw_error *err);

#endif
