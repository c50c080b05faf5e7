/* The drivers of PNG and BMP: their names and their readers. */
#include "formats/picture/picture_format.h"

const cwi_format_driver cwi_format_png = {
    .name = "png",
    .extensions = ".png",
    .about = "PNG slices: a folder or a pattern of numbered files",
    .feature = "pictures",
    .volume = {.sniff = cwi_png_sniff, .read_slices = cwi_png_read},
};

const cwi_format_driver cwi_format_bmp = {
    .name = "bmp",
    .extensions = ".bmp",
    .about = "BMP slices: a folder or a pattern of numbered files",
    .feature = "pictures",
    .volume = {.sniff = cwi_bmp_sniff, .read_slices = cwi_bmp_read},
};
