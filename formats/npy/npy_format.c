/* The driver of NumPy's files: its names and its reader. */
#include "formats/npy/npy_format.h"

const cwi_format_driver cwi_format_npy = {
    .name = "npy",
    .extensions = ".npy",
    .about = "NumPy array of 2 to 4 dimensions, z y x",
    .volume = {.sniff = cwi_npy_sniff, .parse = cwi_npy_parse},
};
