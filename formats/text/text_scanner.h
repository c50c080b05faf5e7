/* Scanning of a mesh file from start to end: words and numbers of text, or records. */
#ifndef FORMATS_TEXT_TEXT_SCANNER_H
#define FORMATS_TEXT_TEXT_SCANNER_H

#include "formats/bytes/input_file.h"

/* The maximum lengths. Words are shorter than this, and records are no longer. */
enum { CWI_SCAN_AHEAD = 256, CWI_REST_BYTES = 512 };

/* A zeroed scan is closed. */
typedef struct cwi_scan {
    const cwi_input *in;         /* borrowed */
    const cw_progress *progress; /* borrowed; reported and polled every 256 KiB */
    uint64_t offset;             /* in the file, of the byte behind those in memory */
    char *text;                  /* bytes in memory: from next to end, where a zero follows */
    size_t next, end;
    size_t line;   /* of text, from 1 */
    bool by_line;  /* words end with their line, unless a backslash ends it; otherwise line ends
                      are blanks */
    bool cr_lines; /* lines end with carriage returns alone, as on an old Macintosh: they become
                      line feeds */
    bool comments; /* a word that starts with '#' and the rest of its line are blanks */
} cwi_scan;

/* Starts at an offset. by_line and comments may be set at any time.
 * Returns CW_ERR_NO_MEMORY. */
CW_NODISCARD cw_status cwi_scan_open(cwi_scan *s, const cwi_input *in, uint64_t offset,
                                     const cw_progress *progress, cw_error *err);

/* Starts a scan of text. The end of its first line decides how all lines end. */
CW_NODISCARD cw_status cwi_scan_open_text(cwi_scan *s, const cwi_input *in, uint64_t offset,
                                          const cw_progress *progress, cw_error *err);
void cwi_scan_close(cwi_scan *s);

/* Returns the bytes of the file behind the current place. */
uint64_t cwi_scan_left(const cwi_scan *s);

/* Reads exactly size bytes, at most CWI_SCAN_AHEAD; valid until the next call. what: their
 * name.
 * Returns CW_ERR_FORMAT where the file ends first. */
CW_NODISCARD cw_status cwi_scan_take(cwi_scan *s, size_t size, const char *what,
                                     const unsigned char **bytes, cw_error *err);

/* A word in the buffer: a blank, line end or zero follows. Valid until the next call. */
typedef struct cwi_word {
    const char *text;
    size_t size; /* 0: the line or the file ends here */
} cwi_word;

CW_NODISCARD cw_status cwi_scan_word(cwi_scan *s, cwi_word *word, cw_error *err);
bool cwi_word_is(const cwi_word *word, const char *text);

/* Parses the whole word as a number; returns false if it is none. */
bool cwi_word_double(const cwi_word *word, double *value);
bool cwi_word_integer(const cwi_word *word, int64_t *value);

/* Copies the rest of the line, without blanks around it, cut to the buffer and
 * zero-terminated. */
CW_NODISCARD cw_status cwi_scan_rest(cwi_scan *s, char text[CWI_REST_BYTES], cw_error *err);

/* Leaves out the rest of the line. */
CW_NODISCARD cw_status cwi_scan_end_line(cwi_scan *s, cw_error *err);

/* Goes to the next line with a word in it; *found is false at the end of the file. */
CW_NODISCARD cw_status cwi_scan_next_line(cwi_scan *s, bool *found, cw_error *err);

/* Reads the next word as a number; what: its name, for the message. */
CW_NODISCARD cw_status cwi_scan_double(cwi_scan *s, const char *what, double *value,
                                       cw_error *err);
CW_NODISCARD cw_status cwi_scan_integer(cwi_scan *s, const char *what, int64_t *value,
                                        cw_error *err);

/* Reports "line 5: x is 'abc', a number was expected", or an early end of line or file. */
CW_NODISCARD cw_status cwi_scan_fail(const cwi_scan *s, const cwi_word *word, const char *what,
                                     const char *expected, cw_error *err);

#endif
