/* The open file of the module "tiff", and the functions that its parts share. All of it runs in
 * a sandboxed process. */
#ifndef FORMATS_TIFF_TIFF_FILE_H
#define FORMATS_TIFF_TIFF_FILE_H

#include "formats/bytes/stored_numbers.h"
#include "formats/tiff/tiff.h"

#include <tiffio.h>

/* The storage of a page's pixels, and their form as returned. */
typedef struct cwi_tiff_layout {
    uint32_t columns, rows;
    uint16_t samples, bits, format;
    uint16_t compression, photometric, orientation, predictor;
    cw_type type;
    cwi_stored stored; /* the form of samples in the file, if not that type */
    bool tiled, turned, low_bit_first;
    uint16_t planes;     /* stored one after another: 1, or one per sample */
    uint32_t tile_width; /* strips: columns */
    uint32_t band_rows;  /* of a strip or a row of tiles */
    uint32_t bands;
    size_t stored_row; /* bytes of a row of a plane as libtiff returns it */
    size_t row;        /* ... and of a row as the module returns it */
} cwi_tiff_layout;

/* A page, by what all pages of an image have in common. */
typedef struct cwi_tiff_page {
    uint32_t directory;
    uint32_t columns, rows;
    uint16_t samples, bits;
    cw_type type;
    bool good; /* it can be read */
    bool compressed, turned;
} cwi_tiff_page;

typedef struct cwi_tiff_file {
    int fd;
    uint64_t size, at;
    bool big, high_first; /* BigTIFF; the high byte of a number comes first */
    TIFF *tiff;
    uint64_t *offsets; /* of the directories in the file's chain */
    uint32_t offset_count;
    cwi_tiff_page *pages; /* of full resolution */
    uint32_t page_count;
    uint64_t behind; /* not 0: there is one directory, and the pixels of page_count pages start
                        here, one after another */
    int64_t page;    /* page of the layout; -1: none */
    cwi_tiff_layout layout;
    int64_t band; /* the band in `pixels`; -1: none */
    unsigned char *pixels, *tile, *line;
    size_t pixel_capacity, tile_capacity, line_capacity;
    bool guessed;   /* libtiff has guessed the bytes of the directory's strips */
    int complained; /* libtiff's complaint since cwi_tiff_listen(): 1, a warning; 2, an error */
    char complaint[200];
} cwi_tiff_file;

/* Finds the directories of the file, and checks everything that they point to against its size.
 * A loop, or a tag's value beyond the end, is an error. */
CW_NODISCARD cw_status cwi_tiff_walk(cwi_tiff_file *f, cw_error *err);

/* Opens a directory of the chain; finds the layout of the open one. */
CW_NODISCARD cw_status cwi_tiff_open_directory(cwi_tiff_file *f, uint32_t n, cw_error *err);
CW_NODISCARD cw_status cwi_tiff_find_layout(cwi_tiff_file *f, cw_error *err);

/* Collects the facts of the open file, and behind them the order of its pages. image: which one of
 * several */
CW_NODISCARD cw_status cwi_tiff_take_facts(cwi_tiff_file *f, uint32_t image,
                                           cwi_tiff_facts *facts, cw_error *err);

/* Adds a decision to those that are reported. */
void cwi_tiff_note(cwi_tiff_facts *facts, const char *format, ...) CW_PRINTF(2, 3);

/* Clears libtiff's complaints so far. */
static inline void cwi_tiff_listen(cwi_tiff_file *f)
{
    f->complained = 0;
    f->complaint[0] = '\0';
}

/* Opens a page and finds its layout. */
CW_NODISCARD cw_status cwi_tiff_turn_to(cwi_tiff_file *f, uint32_t page, cw_error *err);

/* Reads rows of the open page. */
CW_NODISCARD cw_status cwi_tiff_rows(cwi_tiff_file *f, uint32_t first, uint32_t count,
                                     unsigned char *to, cw_error *err);

static inline bool cwi_tiff_is_deflated(const cwi_tiff_layout *l)
{
    return l->compression == COMPRESSION_DEFLATE || l->compression == COMPRESSION_ADOBE_DEFLATE;
}

/* Decodes a deflated strip or tile to rows of numbers of this machine. */
CW_NODISCARD cw_status cwi_tiff_inflate(cwi_tiff_file *f, uint32_t strile, unsigned char *to,
                                        size_t bytes, size_t row_bytes, cw_error *err);

/* Makes a buffer large enough; its content is lost. */
CW_NODISCARD cw_status cwi_tiff_ensure_capacity(unsigned char **buffer, size_t *capacity,
                                                uint64_t bytes, cw_error *err);

/* Read values that libtiff does not return. The first is a short of a directory, 0 where there
 * is none. The second is a rational number of the first directory, which libtiff rounds to
 * single precision; false where there is none. */
uint16_t cwi_tiff_short(const cwi_tiff_file *f, uint32_t directory, uint16_t tag);
bool cwi_tiff_rational(const cwi_tiff_file *f, uint16_t tag, double *value);

/* Reads a text of the first directory, as much as there is room for; false where there is none. */
bool cwi_tiff_text(const cwi_tiff_file *f, uint16_t tag, char *text, size_t size);

/* Interprets the first directory's description of the pages: ImageJ's, OME's, tifffile's or none.
 * Fills in the facts behind page_count, and the order of pages. The first directory must be open, and
 * the layout that of the first page. image: which one of several that OME describes */
CW_NODISCARD cw_status cwi_tiff_describe(cwi_tiff_file *f, const char *description,
                                         uint32_t image, cwi_tiff_facts *facts, uint32_t *order,
                                         cw_error *err);
CW_NODISCARD cw_status cwi_tiff_ome(const cwi_tiff_file *f, const char *xml, uint32_t image,
                                    cwi_tiff_facts *facts, uint32_t *order, cw_error *err);
CW_NODISCARD cw_status cwi_tiff_shaped(cwi_tiff_file *f, const char *json,
                                       cwi_tiff_facts *facts, uint32_t *order, cw_error *err);

/* Finds the images of a file that has one directory, and all others right after its pixels. */
CW_NODISCARD cw_status cwi_tiff_find_images(cwi_tiff_file *f, uint32_t images, cw_error *err);

/* Sets the millimetres of an axis, and notes a unit that is not known. */
void cwi_tiff_set_unit(cwi_tiff_facts *facts, int axis, const char *name, size_t length);

/* Returns the millimetres of a unit of length, and the seconds of one of time; 0: unknown
 * unit. */
double cwi_tiff_length(const char *name, size_t length);
double cwi_tiff_time(const char *name, size_t length);

#endif
