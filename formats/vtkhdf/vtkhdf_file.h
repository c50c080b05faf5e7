/* An open VTKHDF file: its arrays, and the VTK file that is made of it in memory. That has the elements of
 * VTK's XML with appended data, so its readers choose arrays, join pieces and check cells for both. */
#ifndef FORMATS_VTKHDF_VTKHDF_FILE_H
#define FORMATS_VTKHDF_VTKHDF_FILE_H

#include "formats/bytes/input_file.h"
#include "formats/vtkhdf/vtkhdf.h"

#include <stdio.h>

/* The numbers of an array, or of a piece of one, in the appended data. */
typedef struct cwi_vtkhdf_item {
    const cwi_vtkhdf_array *array;
    uint64_t first, count; /* numbers along its slowest dimension */
    uint64_t at, bytes;    /* at: of a word with the count of bytes, which precedes them */
    bool is_value;         /* in PointData or CellData, and no mark of hidden cells */
    uint64_t kept, filled; /* those from byte kept to byte filled are in memory */
} cwi_vtkhdf_item;

typedef struct cwi_vtkhdf {
    const cwi_input *in;      /* borrowed */
    const cw_read_desc *desc; /* borrowed */
    cwi_planes planes;
    cwi_vtkhdf_facts facts;

    FILE *xml; /* the elements while they are written, at `text` */
    char *text;
    size_t text_size;
    cwi_vtkhdf_item *items;
    size_t item_count, item_capacity;
    uint64_t appended_bytes;

    cwi_input made; /* the file in memory, after cwi_vtkhdf_make() */
    bool is_made;
    uint64_t filled_bytes;
} cwi_vtkhdf;

/* Opens the file in a sandboxed process, and checks its facts. Close it also after a failure.
 * Returns  CW_ERR_UNSUPPORTED  not in this build; CW_ERR_FORMAT, also for a type that is not read */
CW_NODISCARD cw_status cwi_vtkhdf_open(cwi_vtkhdf *h, const cwi_input *in,
                                       const cw_read_desc *desc, cw_error *err);
void cwi_vtkhdf_close(cwi_vtkhdf *h);

bool cwi_vtkhdf_is(const cwi_vtkhdf *h, const char *type);

/* Finds an array by its name below VTKHDF; NULL when there is none. */
const cwi_vtkhdf_array *cwi_vtkhdf_find(const cwi_vtkhdf *h, const char *name);

/* Finds an array that is needed: with `components` numbers in each row, real or whole ones.
 * Returns CW_ERR_FORMAT */
CW_NODISCARD cw_status cwi_vtkhdf_need(const cwi_vtkhdf *h, const char *name,
                                       uint64_t components, bool real,
                                       const cwi_vtkhdf_array **array, cw_error *err);

/* Reads rows of an array to memory: `count` from `first` on along its slowest dimension. */
CW_NODISCARD cw_status cwi_vtkhdf_fetch(cwi_vtkhdf *h, const cwi_vtkhdf_array *array,
                                        uint64_t first, uint64_t count, void *to,
                                        cw_error *err);

/* Reads rows as requests number them. */
CW_NODISCARD cw_status cwi_vtkhdf_fetch_rows(cwi_vtkhdf *h, const cwi_vtkhdf_array *array,
                                             uint64_t first, uint64_t count, void *to,
                                             cw_error *err);

/* Returns how many of these rows an index along the slowest dimension has; 0: there are no numbers. */
uint64_t cwi_vtkhdf_rows(const cwi_vtkhdf_array *array);

/* Reads whole numbers, none of them below 0, of a column of an array that has enough rows. */
CW_NODISCARD cw_status cwi_vtkhdf_counts(cwi_vtkhdf *h, const char *name, uint32_t column,
                                         uint64_t first, uint64_t count, uint64_t *to,
                                         cw_error *err);

/* Returns the bytes of an index along the slowest dimension. */
uint64_t cwi_vtkhdf_row_bytes(const cwi_vtkhdf_array *array);

/* Writes the elements of an image, of a grid of cells, or of a surface. */
CW_NODISCARD cw_status cwi_vtkhdf_put_image(cwi_vtkhdf *h, cw_error *err);
CW_NODISCARD cw_status cwi_vtkhdf_put_grid(cwi_vtkhdf *h, cw_error *err);
CW_NODISCARD cw_status cwi_vtkhdf_put_surface(cwi_vtkhdf *h, cw_error *err);

/* Reads the row of the first time step in an array of Steps: a number where its rows start in
 * another array. Sets *to to 0 where there is no such array. */
CW_NODISCARD cw_status cwi_vtkhdf_start(cwi_vtkhdf *h, const char *name, uint32_t column,
                                        uint64_t *to, cw_error *err);

/* Writes the element DataArray of rows of an array. */
CW_NODISCARD cw_status cwi_vtkhdf_put_array(cwi_vtkhdf *h, const cwi_vtkhdf_array *array,
                                            const char *name, uint64_t components,
                                            uint64_t first, uint64_t count, cw_error *err);

/* Opens or closes the element of PointData or CellData. */
void cwi_vtkhdf_put_data(cwi_vtkhdf *h, bool of_cells, bool opens);

/* Returns the name of an array in PointData or CellData; NULL for others. */
const char *cwi_vtkhdf_value_name(const cwi_vtkhdf_array *array, bool of_cells);

/* Makes the file in memory: all elements, and room for the arrays. */
CW_NODISCARD cw_status cwi_vtkhdf_make(cwi_vtkhdf *h, cw_error *err);

/* Reads bytes of an item into the file in memory, unless they are there. Those before them may be
 * dropped. */
CW_NODISCARD cw_status cwi_vtkhdf_fill_range(cwi_vtkhdf *h, cwi_vtkhdf_item *item,
                                             uint64_t first, uint64_t end, cw_error *err);

/* Reads all of an item. */
CW_NODISCARD cw_status cwi_vtkhdf_fill(cwi_vtkhdf *h, cwi_vtkhdf_item *item, cw_error *err);

/* Fills all items but values. */
CW_NODISCARD cw_status cwi_vtkhdf_fill_structure(cwi_vtkhdf *h, cw_error *err);

#endif
