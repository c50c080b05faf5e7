/* Text as roff, the language of manual pages: escaped words, and pages of the help. */
#ifndef CLI_HELP_ROFF_TEXT_H
#define CLI_HELP_ROFF_TEXT_H

#include <stdbool.h>
#include <stddef.h>

/* Prints a text such that roff shows it letter for letter. begins_line protects a '.' at its
 * start. */
void cli_roff_text(const char *text, size_t length, bool begins_line);

/* Prints ".SH HEADING" in capitals, or ".SS Heading" of a part of it. */
void cli_roff_heading(const char *text, size_t length, bool is_part);

typedef enum cli_roff_part {
    CLI_ROFF_TEXT,    /* all but the examples */
    CLI_ROFF_EXAMPLES /* the examples alone */
} cli_roff_part;

/* Prints a page of the help: paragraphs, headings, lists and literal blocks.
 * has_parts  its headings are parts of a section; else they are sections */
void cli_roff_page(const char *page, cli_roff_part part, bool has_parts);

#endif
