/* The content of a file of labels, and the formats in which it may be. */
#ifndef FORMATS_LABELS_LABEL_FILE_H
#define FORMATS_LABELS_LABEL_FILE_H

#include <cubewright/label_table.h>

struct json_t;

enum { CWI_LABEL_LINE_BYTES = 4096 };

/* The text of a file. A zeroed one is empty. */
typedef struct cwi_label_file {
    char *bytes, *text; /* text starts behind a byte order mark, and ends with a zero */
    size_t size;        /* of text, without the zero */
    char first[CWI_LABEL_LINE_BYTES]; /* copy of the start of the first line that is neither
                                         empty nor a comment; "" where the text is no list of
                                         lines */
    bool is_slicer;      /* the comments in front of that line are those of 3D Slicer */
    struct json_t *json; /* the document, if it is JSON; else NULL */
} cwi_label_file;

/* A format of tables of labels. */
typedef struct cwi_label_format {
    const char *name;
    const char *extensions; /* that mean this format where the content is of none */
    bool (*recognise)(const cwi_label_file *file);
    /* Appends the labels to a zeroed table, and sorts it; may write to the text. */
    cw_status (*read)(cwi_label_file *file, cw_label_table *table, cw_error *err);
} cwi_label_format;

extern const cwi_label_format cwi_label_xml, cwi_label_niivue, cwi_label_nnunet,
    cwi_label_ome_zarr, cwi_label_csv, cwi_label_bids, cwi_label_itksnap, cwi_label_slicer,
    cwi_label_freesurfer, cwi_label_text;

/* Reads an open file into memory, and parses JSON. Close the file in any case.
 * Returns CW_ERR_LIMIT for more than 64 MiB, or 16 MiB of JSON; CW_ERR_FORMAT for zero bytes,
 * damaged JSON, and what is known to be something else; CW_ERR_IO; CW_ERR_NO_MEMORY */
CW_NODISCARD cw_status cwi_label_file_open(cwi_label_file *file, int fd, uint64_t size,
                                           cw_error *err);
void cwi_label_file_close(cwi_label_file *file);

/* Returns the format by the content; NULL if there is none. */
const cwi_label_format *cwi_label_format_of(const cwi_label_file *file);

/* --- lines ------------------------------------------------------------------------------- */

/* A place in a text of lines. */
typedef struct cwi_label_lines {
    char *next;
    size_t number; /* of the line returned last, from 1 */
} cwi_label_lines;

/* Returns the next line that is neither empty nor a comment, without blanks around it; NULL
 * behind the last. The text is written to. */
char *cwi_label_line(cwi_label_lines *lines);

/* Splits a line at blanks, in place. Returns the number of words; those behind the capacity are
 * left out. */
size_t cwi_label_words(char *line, char **words, size_t capacity);

/* Returns true if a word consists of digits. */
bool cwi_label_is_whole(const char *word);

/* Reads a whole number from 0 to max. The message names the line and the field. CW_ERR_FORMAT */
CW_NODISCARD cw_status cwi_label_whole(const char *word, uint32_t max, size_t line,
                                       const char *field, uint32_t *value, cw_error *err);

/* Parses the number of a label. Returns CW_ERR_FORMAT, naming the field. */
CW_NODISCARD cw_status cwi_label_read_number(const char *word, size_t line, const char *field,
                                             cw_label *label, cw_error *err);

/* Reads three numbers from 0 to 255 into the colour of a label, and makes it opaque. */
CW_NODISCARD cw_status cwi_label_rgb(char *const words[3], size_t line, cw_label *label,
                                     cw_error *err);

#endif
