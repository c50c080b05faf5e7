/* Copies images onto others, and tiles images of any sizes into a sheet of equal cells. */
#include <cubewright/overlay.h>

#include "core/base/status.h"

#include <math.h>
#include <string.h>

enum { MAX_SIZE = 16384 };

void cw_image_place(cw_image *onto, const cw_image *image, ptrdiff_t x, ptrdiff_t y)
{
    const ptrdiff_t w = (ptrdiff_t)onto->width, h = (ptrdiff_t)onto->height;
    const ptrdiff_t first = x < 0 ? -x : 0;
    const ptrdiff_t last = x + (ptrdiff_t)image->width > w ? w - x : (ptrdiff_t)image->width;
    for (ptrdiff_t row = 0; row < (ptrdiff_t)image->height && first < last; row++)
        if (y + row >= 0 && y + row < h)
            memcpy(onto->pixels + 4 * ((y + row) * w + x + first),
                   image->pixels + 4 * (row * (ptrdiff_t)image->width + first),
                   4 * (size_t)(last - first));
}

static cw_status find_cell(const cw_image *images, size_t count, size_t cell[2], cw_error *err)
{
    cell[0] = cell[1] = 0;
    for (size_t n = 0; n < count; n++) {
        if (!images[n].pixels)
            return cwi_fail(err, CW_ERR_ARGUMENT, "image %zu of a sheet is empty", n);
        cell[0] = images[n].width > cell[0] ? images[n].width : cell[0];
        cell[1] = images[n].height > cell[1] ? images[n].height : cell[1];
    }
    return count > 0 ? CW_OK
                     : cwi_fail(err, CW_ERR_ARGUMENT, "a sheet needs at least one image");
}

/* Returns the fewest columns that make the sheet at least as wide as high. */
static size_t square_columns(size_t count, const size_t cell[2])
{
    size_t columns = 1;
    while (columns * cell[0] < (count + columns - 1) / columns * cell[1])
        columns++;
    return columns;
}

/* Returns the extent of `cells` cells of a size with gaps between; 0 when that is too large. */
static size_t sheet_extent(size_t cells, size_t size, size_t gap)
{
    const double all = (double)cells * (double)size + ((double)cells - 1) * (double)gap;
    return all <= MAX_SIZE ? (size_t)all : 0;
}

cw_status cw_image_tile(const cw_image *images, size_t count, size_t columns, size_t gap_px,
                        const uint8_t background[4], cw_image *sheet, cw_error *err)
{
    CWI_REQUIRE(err, background, sheet);
    CWI_REQUIRE_ARRAY(err, images, count);
    size_t cell[2];
    *sheet = (cw_image){0};
    cw_status st = find_cell(images, count, cell, err);
    if (st != CW_OK)
        return st;
    if (columns == 0)
        columns = square_columns(count, cell);
    const size_t rows = (count - 1) / columns + 1;
    const size_t width = sheet_extent(columns, cell[0], gap_px),
                 height = sheet_extent(rows, cell[1], gap_px);
    if (!width || !height)
        return cwi_fail(err, CW_ERR_LIMIT, "a sheet of %zu x %zu images is above %d pixels",
                        columns, rows, MAX_SIZE);
    st = cw_image_alloc(sheet, width, height, err);
    if (st != CW_OK)
        return st;
    for (size_t p = 0; p < width * height; p++)
        memcpy(sheet->pixels + 4 * p, background, 4);
    for (size_t n = 0; n < count; n++) {
        const size_t x = n % columns * (cell[0] + gap_px) + (cell[0] - images[n].width) / 2;
        const size_t y = n / columns * (cell[1] + gap_px) + (cell[1] - images[n].height) / 2;
        cw_image_place(sheet, &images[n], (ptrdiff_t)x, (ptrdiff_t)y);
    }
    return CW_OK;
}
